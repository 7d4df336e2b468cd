//! The model as a program.

use super::{Format, Holds};
use crate::{Export, Failure};
use moldloft_document::Format as Form;
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

fn write(export: &mut Export<'_>) -> Result<Vec<NamedFile>, Failure> {
    let text = export.document.convert(Form::Sdl)?;
    Ok(export.main_file(text.into_bytes()))
}
