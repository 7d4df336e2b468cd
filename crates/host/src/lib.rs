//! Files, as far as a model may see them: the world of the extension, the command and the language
//! server.
//!
//! Invariant: nothing outside the given folders is read for a model, links resolved.

use moldloft_lang::{ReadError, ReadText, World};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The most bytes of one file.
const LARGEST: u64 = 256 << 20;

/// Reads files inside the model's folder and the library path, and nowhere else.
#[derive(Clone, Debug)]
pub struct FileWorld {
    /// Folders that may be read, links resolved; the model's own first.
    roots: Vec<PathBuf>,
}

impl FileWorld {
    /// A world for a model in `folder` (`None` for a model without a file).
    pub fn new(folder: Option<&Path>, library: &[String]) -> Self {
        let folders = folder.into_iter().chain(library.iter().map(Path::new));
        Self { roots: folders.filter_map(|folder| folder.canonicalize().ok()).collect() }
    }

    /// A world for the model file at `path`: its folder, and that of what it links to.
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
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, ReadError> {
        let refused = |reason: &str, help: Option<String>| ReadError {
            message: format!("cannot read `{path}`: {reason}"),
            help,
        };
        let found = self.find(path, from).map_err(|error| failed(path, &error))?;
        // What the user names may be a link to anywhere; what a model names must stay inside.
        if from.is_some() && !self.roots.iter().any(|root| found.starts_with(root)) {
            let help = "a model reads files in its own folder and in the folders given by \
                        `--library`";
            return Err(refused("it is outside the model's folders", Some(help.into())));
        }
        if found.is_dir() {
            return Err(refused("it is a folder", None));
        }
        let file = std::fs::File::open(&found).map_err(|error| failed(path, &error))?;
        let mut bytes = Vec::new();
        // One byte more than allowed tells a file that is too large, whatever its length claims.
        file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(|error| failed(path, &error))?;
        if bytes.len() as u64 > LARGEST {
            return Err(refused("it is larger than 256 MiB", None));
        }
        let name = if from.is_none() { path.into() } else { found.display().to_string() };
        Ok(ReadText { name, bytes: bytes.into() })
    }
}

/// A text that was read: as it was asked for, by which text, and what it was.
pub type ReadAs = (String, Option<String>, ReadText);

/// A world that notes what is read, so that a page can carry it.
pub struct Noted<W> {
    world: W,
    read: Arc<Mutex<Vec<ReadAs>>>,
}

impl<W: World> Noted<W> {
    /// That world; what is read is noted in `read`, each asking once.
    pub fn new(world: W, read: Arc<Mutex<Vec<ReadAs>>>) -> Self {
        Self { world, read }
    }
}

impl<W: World> World for Noted<W> {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, ReadError> {
        let found = self.world.read(path, from)?;
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if !read.iter().any(|(p, f, _)| p == path && f.as_deref() == from) {
            read.push((path.into(), from.map(str::to_owned), found.clone()));
        }
        Ok(found)
    }
}

fn failed(path: &str, error: &std::io::Error) -> ReadError {
    let (reason, help) = match error.kind() {
        ErrorKind::NotFound => ("no such file".into(), near(path)),
        ErrorKind::PermissionDenied => ("permission denied".into(), None),
        _ => (error.to_string(), None),
    };
    ReadError { message: format!("cannot read `{path}`: {reason}"), help }
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
