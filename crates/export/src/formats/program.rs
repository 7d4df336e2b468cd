//! The model as a program.

use crate::format::{Format, Holds};
use crate::{Export, ExportFailure};
use moldloft_document::ModelFormat as Form;
use moldloft_io::vtk::NamedFile;

pub const FORMAT: Format = Format {
    name: "sdl",
    suffix: "sdl",
    about: "the model as a program",
    holds: Holds::Model,
    text: true,
    write,
    ..Format::PANELS
};

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure> {
    let text = export.document.convert(Form::Sdl)?;
    Ok(export.main_file(text.into_bytes()))
}
