//! Export of a document: the table of formats and their writers.
//!
//! `Document -> Export -> row of FORMATS -> encoder of moldloft-io -> named bytes`
//!
//! [`FORMATS`] is all that the command, Python, the language server and the docs know about
//! formats. A format is one module under `formats/`, with its row, and one line of the table; the
//! bytes are encoded by `moldloft-io`.
//!
//! ```
//! use moldloft_document::{Document, NoFiles, registry};
//! use moldloft_export::{WriteOptions, format_named, write};
//!
//! let text = "AbsPoint A(0, 0, 0); AbsPoint B(0, 0, -1); AbsPoint C(2, 0, 0); AbsPoint D(2, 0, -1);
//!     Line a(A, B); Line b(C, D); RuledSurf side(a, b, divisions = {2, 2});";
//! let mut model = Document::from_text(registry(), Box::new(NoFiles), "side.sdl", text);
//! let obj = format_named("obj").unwrap();
//! let files = write(&mut model, obj, &obj.file_name("side"), &WriteOptions::default()).unwrap();
//! assert_eq!(files[0].name, "side.obj");
//! assert_eq!(files[0].bytes.split(|b| *b == b'\n').filter(|line| line.starts_with(b"f ")).count(), 4);
//! ```
//!
//! Invariant: no file is opened here; the caller writes the bytes, all of them or none.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod brep;
mod export;
mod format;
mod formats;
mod kind_picture;
mod lines_drawing;
mod panel_codes;
mod picture;
mod spline_patches;
mod units;

pub use brep::brep;
pub use export::{
    Export, ExportFailure, FileName, Panels, WriteOptions, panels, tagged, write, write_blocks,
    write_grids,
};
pub use format::{CellsEncoder, Format, GridsEncoder, Holds, Lids, SolidCells, SymmetryPlanes};
pub use formats::{FORMATS, format_named};
pub use kind_picture::kind_picture;
pub use lines_drawing::lines_sheet;
pub use moldloft_io::vtk::NamedFile;
pub use picture::picture;
pub use spline_patches::{SplinePatch, spline_patches};
pub use units::{GRAVITY, length_unit, stated_length};
