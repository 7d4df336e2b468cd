//! The libraries that come with the program, written in the language.

use crate::source::world::ReadText;
use moldloft_diag::nearest;

/// Begins the names of built-in libraries in messages.
pub(crate) const FOLDER: &str = "moldloft:";

/// Name and text of each library.
pub const LIBRARIES: [(&str, &str); 6] = [
    ("stdsubs.sdl", include_str!("../../sdl/stdsubs.sdl")),
    ("mslbody.sdl", include_str!("../../sdl/mslbody.sdl")),
    ("attach.sdl", include_str!("../../sdl/attach.sdl")),
    ("topologies.sdl", include_str!("../../sdl/topologies.sdl")),
    ("solids.sdl", include_str!("../../sdl/solids.sdl")),
    ("naca.sdl", include_str!("../../sdl/naca.sdl")),
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

/// A hint when a library that was not loaded defines a routine or variable of that name.
pub(crate) fn defining(word: &str) -> Option<String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let defines = |line: &str| {
        let line = line.split('#').next().unwrap_or("");
        let mut words = line.split(|c: char| !is_word(c)).filter(|w| !w.is_empty());
        match words.next() {
            Some("subroutine") => words.next() == Some(word),
            Some("function") => words.nth(1) == Some(word),
            Some("global") => words.any(|w| w == word),
            _ => false,
        }
    };
    let (file, _) = LIBRARIES.iter().find(|(_, text)| text.lines().any(defines))?;
    Some(format!("`{word}` comes with a library: load \"{file}\""))
}
