//! A parametric box as WAMIT's panels: `cargo run -p moldloft-export --example gdf > box.gdf`.

use moldloft_document::{Document, NoFiles, registry};
use moldloft_export::{WriteOptions, format_named, write};
use std::io::Write;

const BOX: &str = "
    param float beam = 2 in [1, 3];
    Model info(symmetry = \"y\", units = \"m\");
    AbsPoint A(0, beam / 2, 0); AbsPoint B(0, beam / 2, -1);
    AbsPoint C(4, beam / 2, 0); AbsPoint D(4, beam / 2, -1);
    Line a(A, B); Line b(C, D); RuledSurf side(a, b, divisions = {2, 4});
";

fn main() -> std::io::Result<()> {
    let mut model = Document::from_text(registry(), Box::new(NoFiles), "box.sdl", BOX);
    model.set(&[("beam".into(), 2.5)]).expect("the range holds it");
    let format = format_named("gdf").expect("there is one");
    let files = write(&mut model, format, "box.gdf", &WriteOptions::default());
    match files {
        Ok(files) => std::io::stdout().write_all(&files[0].bytes),
        Err(errors) => Err(std::io::Error::other(errors[0].message.to_string())),
    }
}
