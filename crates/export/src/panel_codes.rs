//! Panels for panel codes: cut at the water on request, and with images for symmetries that the
//! code has no flag for.

use crate::{Export, ExportFailure};
use moldloft_diag::Diagnostic;
use moldloft_io::{PanelFileOptions, WriteError};
use moldloft_mesh::{Mesh, MeshError};

impl Export<'_> {
    /// Refuses a skin that is open below the water, z = 0; a warning if partial figures are
    /// allowed.
    ///
    /// # Errors
    /// Which edges are open.
    pub fn require_closed_skin(&mut self) -> Result<(), Diagnostic> {
        let warning = self.document.closed_below(0.0)?;
        let remarks = self.document.export_remarks().iter().cloned().chain(warning).collect();
        self.document.set_export_remarks(remarks);
        Ok(())
    }

    /// The panels, and the options for the file.
    ///
    /// # Errors
    /// As [`Export::panels`]; a skin that is open below the water z = 0, unless patches are chosen by
    /// tags; more vertices than can be counted.
    pub fn panels_of_code(&mut self) -> Result<(Mesh, PanelFileOptions), ExportFailure> {
        let symmetry = self.document.symmetry();
        let (mirror_x, mirror_y) = (symmetry.contains('x'), symmetry.contains('y'));
        let mut mesh: Mesh = self.panels()?.clone();
        if self.options.tags.is_empty() {
            self.require_closed_skin()?;
        }
        let count = mesh.positions().len();
        let large = |_: MeshError| WriteError::TooLarge { what: "vertices", count };
        if self.options.immersed {
            mesh = mesh.immersed(0.0).map_err(large)?;
            if mesh.faces().is_empty() {
                let name = self.format.name;
                let message = format!("cannot write {name}: no panel is below z = 0");
                return Err(Diagnostic::error("cannot-write", message).into());
            }
        }
        let flag_x = self.format.symmetry.names_x(mirror_y);
        if mirror_x && !flag_x {
            mesh = mesh.with_mirror_image(0, ".mirror").map_err(large)?;
        }
        let options =
            PanelFileOptions { mirror_x: mirror_x && flag_x, mirror_y, lids: self.options.lids };
        Ok((mesh, options))
    }
}
