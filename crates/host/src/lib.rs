//! Files, as far as a model may see them: the world of the extension, the command and the language
//! server.
//!
//! Invariant: nothing outside the given folders is read for a model, links resolved; nothing whose name begins with a
//! dot; regular files only. Of the system's folders of fonts a model gets the font that it names, and no list of them.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod fonts;

pub use fonts::system_font;

use moldloft_font::SYSTEM_FONT;
use moldloft_lang::{ReadText, TextReadError, World};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum size of a file, in bytes.
pub const LARGEST: u64 = 256 << 20;

/// The most bytes of the files that one model reads.
const MOST_READ: u64 = 1 << 30;

/// Reads files inside the model's folder and the library path, and nowhere else.
#[derive(Clone, Debug)]
pub struct FileWorld {
    /// Folders that may be read, links resolved; the model's own first.
    roots: Vec<PathBuf>,
    /// Number of bytes of each file that was read.
    read: Arc<Mutex<HashMap<PathBuf, u64>>>,
}

impl FileWorld {
    /// A world for a model in `folder` (`None` for a model without a file).
    pub fn new(folder: Option<&Path>, library: &[String]) -> Self {
        let folders = folder.into_iter().chain(library.iter().map(Path::new));
        let roots = folders.filter_map(|folder| folder.canonicalize().ok()).collect();
        Self { roots, read: Arc::default() }
    }

    /// A world for the model file at `path`: its folder, and that of its link target.
    pub fn around(path: &str, library: &[String]) -> Self {
        let path = Path::new(path);
        let folder = match path.parent() {
            Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
            Some(parent) => parent,
            None => Path::new("."),
        };
        Self::new(Some(folder), library)
    }

    fn find(&self, path: &str, from: Option<&str>) -> Result<PathBuf, std::io::Error> {
        let asked = Path::new(path);
        let Some(from) = from else { return asked.canonicalize() };
        let beside = Path::new(from).parent().unwrap_or(Path::new("")).join(asked);
        let mut first = None;
        let candidates = std::iter::once(beside).chain(self.roots.iter().map(|r| r.join(asked)));
        for candidate in candidates {
            match candidate.canonicalize() {
                Ok(found) => return Ok(found),
                Err(error) => {
                    first.get_or_insert(error);
                }
            }
        }
        Err(first.expect("there is always a candidate"))
    }
}

impl World for FileWorld {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError> {
        let refused = |reason: &str, help: Option<String>| TextReadError {
            message: format!("cannot read `{path}`: {reason}"),
            help,
        };
        if let Some(font) = path.strip_prefix(SYSTEM_FONT) {
            let bytes = system_font(font).map_err(|reason| {
                let help = "name the file of a font in the model's folder";
                refused(&reason, Some(help.into()))
            })?;
            return Ok(ReadText { name: path.into(), bytes });
        }
        let found = self.find(path, from).map_err(|error| failed(path, &error))?;
        // A path given by the user may be a link to anywhere; one in a model must stay inside.
        if from.is_some() {
            let inside = self.roots.iter().find_map(|root| found.strip_prefix(root).ok());
            let Some(inside) = inside else {
                let help = "a model reads files in its own folder and in the folders given by \
                            `--library`";
                return Err(refused("it is outside the model's folders", Some(help.into())));
            };
            if hidden(inside) || hidden(Path::new(path)) {
                let help = "a model reads no file or folder whose name begins with a dot";
                return Err(refused("its name is hidden", Some(help.into())));
            }
        }
        let bytes = match read_regular(&found) {
            Ok(bytes) => bytes,
            Err(ReadFault::System(error)) => return Err(failed(path, &error)),
            Err(fault) => return Err(refused(&fault.to_string(), None)),
        };
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.insert(found.clone(), bytes.len() as u64);
        if read.values().sum::<u64>() > MOST_READ {
            return Err(refused("the model reads more than 1 GiB", None));
        }
        drop(read);
        let name = if from.is_none() { path.into() } else { found.display().to_string() };
        Ok(ReadText { name, bytes: bytes.into() })
    }
}

/// True when a folder or file on the path has a name that begins with a dot.
fn hidden(path: &Path) -> bool {
    path.components().any(|part| match part {
        Component::Normal(name) => name.as_encoded_bytes().first() == Some(&b'.'),
        _ => false,
    })
}

/// Reason why a file is not read.
#[derive(Debug)]
pub enum ReadFault {
    /// It cannot be opened or read.
    System(std::io::Error),
    /// It is a folder.
    Folder,
    /// It is a pipe, a socket or a device.
    Special,
    /// It is larger than [`LARGEST`].
    Large,
}

impl std::fmt::Display for ReadFault {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::System(error) => write!(f, "{error}"),
            Self::Folder => write!(f, "it is a folder"),
            Self::Special => write!(f, "it is not a regular file"),
            Self::Large => write!(f, "it is larger than {} MiB", LARGEST >> 20),
        }
    }
}

/// The bytes of a regular file.
///
/// # Errors
/// [`ReadFault`]; a pipe is refused at once, not waited for.
pub fn read_regular(path: &Path) -> Result<Vec<u8>, ReadFault> {
    let file = open(path).map_err(ReadFault::System)?;
    let kind = file.metadata().map_err(ReadFault::System)?;
    if kind.is_dir() {
        return Err(ReadFault::Folder);
    }
    if !kind.is_file() {
        return Err(ReadFault::Special);
    }
    let mut bytes = Vec::new();
    // One byte more than allowed shows that a file is too large, whatever its length claims.
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(ReadFault::System)?;
    if bytes.len() as u64 > LARGEST { Err(ReadFault::Large) } else { Ok(bytes) }
}

#[cfg(unix)]
fn open(path: &Path) -> std::io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    // Without waiting: a pipe that nobody writes to would be waited for.
    const NONBLOCK: i32 = if cfg!(target_os = "linux") { 0o4000 } else { 4 };
    OpenOptions::new().read(true).custom_flags(NONBLOCK).open(path)
}

#[cfg(not(unix))]
fn open(path: &Path) -> std::io::Result<File> {
    OpenOptions::new().read(true).open(path)
}

fn failed(path: &str, error: &std::io::Error) -> TextReadError {
    let (reason, help) = match error.kind() {
        ErrorKind::NotFound => ("no such file".into(), near(path)),
        ErrorKind::PermissionDenied => ("permission denied".into(), None),
        _ => (error.to_string(), None),
    };
    TextReadError { message: format!("cannot read `{path}`: {reason}"), help }
}

/// A file of a similar name in the same folder.
fn near(path: &str) -> Option<String> {
    let path = Path::new(path);
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    let name = path.file_name()?.to_str()?;
    let near = moldloft_diag::nearest(name, names.iter().map(String::as_str))?;
    Some(format!("a similar name exists: `{near}`"))
}
