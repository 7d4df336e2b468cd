//! The model as a MultiSurf model file.

use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_document::ModelFormat as Form;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "ms2",
    suffix: "ms2",
    about: "the model as a MultiSurf model file",
    holds: Holds::Model,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let (text, remarks) = export.document.convert_with_remarks(Form::ModelFile)?;
    export.document.set_export_remarks(remarks);
    Ok(export.main_file(text.into_bytes()))
}
