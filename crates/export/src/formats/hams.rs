//! HAMS's panels, and the lids that it reads from a file of their own.

use crate::format::{Format, Lids, SymmetryPlanes};
use crate::{Export, ExportFailure};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{PanelFileOptions, hams};

pub const FORMAT: Format = Format {
    name: "hams",
    aliases: &["pnl"],
    suffix: "pnl",
    about: "HAMS panels (.pnl)",
    symmetry: SymmetryPlanes::Either,
    lids: Lids::OwnFile,
    write,
    ..Format::PANEL_CODE
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (mesh, options) = export.panels_of_code()?;
    let hull = PanelFileOptions { lids: false, ..options };
    let mut files = export.main_file(hams::write(&mesh, hull)?);
    if let Some(bytes) = hams::write_lids(&mesh, hull)?.filter(|_| options.lids) {
        files.push(NamedFile { name: format!("{}.waterplane.pnl", export.stem()), bytes });
    }
    Ok(files)
}
