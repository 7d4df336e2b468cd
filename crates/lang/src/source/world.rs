//! Source of texts: files of the host, or none.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Access of a run to files. The core opens none: the host does, in the permitted folders.
pub trait World: Send + Sync {
    /// The text at `path`, named in the text of `from` (or by the user when `None`).
    ///
    /// # Errors
    /// Why it cannot be read.
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError>;
}

/// A text and its origin.
#[derive(Clone, Debug)]
pub struct ReadText {
    /// The displayed name, the same for each spelling of a path.
    pub name: String,
    /// The bytes.
    pub bytes: Arc<[u8]>,
}

/// Reason why a text cannot be read.
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

impl<W: World + ?Sized> World for Box<W> {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError> {
        (**self).read(path, from)
    }
}

/// A file that was read: the path as requested, the requesting text, and the content.
pub type ReadAs = (String, Option<String>, ReadText);

/// Texts that replace the files of their names, such as unsaved texts of an editor; and the files
/// that were read.
#[derive(Debug, Default)]
pub struct OpenTexts {
    texts: RwLock<HashMap<String, Arc<[u8]>>>,
    read: Mutex<Vec<ReadAs>>,
}

impl OpenTexts {
    /// Replaces the file by a text; `None` ends the replacement.
    pub fn put(&self, name: &str, text: Option<&str>) {
        let mut texts = self.texts.write().unwrap_or_else(PoisonError::into_inner);
        match text {
            Some(text) => texts.insert(name.into(), text.as_bytes().into()),
            None => texts.remove(name),
        };
    }

    /// The files that were read since [`Self::forget`], once for each path and requesting text.
    pub fn files(&self) -> Vec<ReadAs> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Forgets which files were read.
    pub fn forget(&self) {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

/// A world in which open texts replace files, and which records the files read.
pub struct OpenFiles<W> {
    world: W,
    texts: Arc<OpenTexts>,
}

impl<W: World> OpenFiles<W> {
    /// The files of `world`, except those with open texts.
    pub fn new(world: W, texts: Arc<OpenTexts>) -> Self {
        Self { world, texts }
    }
}

impl<W: World> World for OpenFiles<W> {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError> {
        let mut found = self.world.read(path, from)?;
        let texts = self.texts.texts.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(text) = texts.get(&found.name) {
            found.bytes = text.clone();
        }
        drop(texts);
        let mut read = self.texts.read.lock().unwrap_or_else(PoisonError::into_inner);
        match read.iter_mut().find(|(p, f, _)| p == path && f.as_deref() == from) {
            Some((_, _, known)) => *known = found.clone(),
            None => read.push((path.into(), from.map(str::to_owned), found.clone())),
        }
        Ok(found)
    }
}
