//! The libraries that come with the program, written in the language.

use crate::world::ReadText;
use moldloft_diag::nearest;

/// Begins the names of built-in libraries in messages.
pub(crate) const FOLDER: &str = "moldloft:";

/// Name and text of each library.
pub const LIBRARIES: [(&str, &str); 3] = [
    ("stdsubs.sdl", include_str!("../sdl/stdsubs.sdl")),
    ("mslbody.sdl", include_str!("../sdl/mslbody.sdl")),
    ("naca.sdl", include_str!("../sdl/naca.sdl")),
];

/// The library that `load "path"` means when no file of the user does.
pub(crate) fn text(path: &str) -> Option<ReadText> {
    let (name, text) = LIBRARIES.iter().find(|(name, _)| *name == path)?;
    Some(ReadText { name: format!("{FOLDER}{name}"), bytes: text.as_bytes().into() })
}

/// A hint when a library may have been meant.
pub(crate) fn near(path: &str) -> Option<String> {
    let near = nearest(path, LIBRARIES.iter().map(|(name, _)| *name))?;
    Some(format!("a built-in library has a similar name: `{near}`"))
}
