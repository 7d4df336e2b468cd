//! Source of texts: files of the host, or none.

use std::sync::Arc;

/// Access of a run to the outside. The core opens no files: the host does, in the permitted
/// folders.
pub trait World: Send + Sync {
    /// The text at `path`, named in the text of `from` (or by the user when `None`).
    ///
    /// # Errors
    /// Why it cannot be read.
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError>;
}

/// A text and where it came from.
#[derive(Clone, Debug)]
pub struct ReadText {
    /// The displayed name, the same for each spelling of a path.
    pub name: String,
    /// The bytes.
    pub bytes: Arc<[u8]>,
}

/// Why a text cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextReadError {
    /// The error, in one line.
    pub message: String,
    /// The remedy.
    pub help: Option<String>,
}

/// A world without files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl World for NoFiles {
    fn read(&self, path: &str, _from: Option<&str>) -> Result<ReadText, TextReadError> {
        Err(TextReadError { message: format!("cannot read `{path}`: no files here"), help: None })
    }
}
