//! The command language: lines in, replies out.

mod args;
mod curves;
mod digits;
mod dims;
mod draw;
mod error;
mod features;
mod files;
mod follow;
mod info;
mod no_body;
mod objects;
mod on_faces;
mod others;
mod question;
mod sections;
mod sensitivity;
mod session;
mod shapes;
mod solids;
mod strokes;
mod subject;
mod text;
mod treatments;
mod typed;
pub mod verbs;
pub mod words;

pub use crate::solid::feature::foreign;
pub use error::CommandError;
pub use no_body::no_body;
pub use on_faces::{SectionFrame, drawable_faces};
pub(crate) use session::Picture;
pub use session::{CommandReply, Files, NullFiles, OutFile, SketchSession};
pub use subject::{ReplySubject, Suggestion};
pub use typed::{CommandReport, ObjectChange, SketchCommand};
