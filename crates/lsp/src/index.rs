//! The names of a workspace: those of open texts as the editor shows them, those of other files as they are saved.

use crate::places::path_of;
use moldloft::document::Workspace;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The most files that are followed.
pub const MOST_FILES: usize = 5_000;
/// The most folders and files searched.
const MOST_ENTRIES: usize = 100_000;

/// An open text: address, number of changes, text.
pub type OpenText<'a> = (&'a str, u64, &'a str);

/// Source of a file's content.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stamp {
    /// The open text, after a number of changes.
    Open(u64),
    /// The file of that time and length.
    Saved(Option<SystemTime>, u64),
}

/// The names of all programs of a workspace.
#[derive(Default)]
pub struct Index {
    workspace: Workspace,
    stamps: HashMap<String, Stamp>,
    /// False when there are more files than are followed.
    pub complete: bool,
}

/// The name of a file in the index: its path with links resolved, or its address.
fn name_of(uri: &str) -> String {
    match path_of(uri) {
        Some(path) => path.canonicalize().unwrap_or(path).display().to_string(),
        None => uri.to_string(),
    }
}

impl Index {
    /// The names as of the last [`Self::refresh`].
    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    /// Takes the names as they are now; `folders` are those of the workspace.
    pub fn refresh(&mut self, folders: &[PathBuf], open: &[OpenText<'_>]) {
        let mut wanted: BTreeMap<String, Stamp> = BTreeMap::new();
        let mut inside: Vec<PathBuf> = folders.to_vec();
        self.complete = true;
        let mut seen = 0;
        for folder in folders {
            self.complete &= list(folder, &mut seen, &mut wanted);
        }
        let mut texts: HashMap<String, &str> = HashMap::new();
        for (uri, changes, text) in open {
            let name = name_of(uri);
            inside.extend(Path::new(&name).parent().map(Path::to_path_buf));
            wanted.insert(name.clone(), Stamp::Open(*changes));
            texts.insert(name, text);
        }
        let resolve = |from: &str, path: &str| -> Option<String> {
            let beside = Path::new(from).parent().map(|folder| folder.join(path));
            let others = inside.iter().map(|folder| folder.join(path));
            let found = beside.into_iter().chain(others).find_map(|p| p.canonicalize().ok())?;
            inside.iter().any(|f| found.starts_with(f)).then(|| found.display().to_string())
        };
        let gone: Vec<String> =
            self.workspace.files().filter(|f| !wanted.contains_key(*f)).map(String::from).collect();
        let mut left: BTreeSet<String> = gone.into_iter().collect();
        let mut queue: Vec<(String, Stamp)> = wanted.into_iter().collect();
        let mut done = BTreeSet::new();
        while let Some((name, stamp)) = queue.pop() {
            left.remove(&name);
            if !done.insert(name.clone()) {
                continue;
            }
            if self.stamps.get(&name) != Some(&stamp) {
                let saved;
                let text = match texts.get(&name) {
                    Some(text) => *text,
                    None => match moldloft::host::read_regular(Path::new(&name)) {
                        Ok(bytes) => {
                            saved = String::from_utf8_lossy(&bytes).into_owned();
                            &saved
                        }
                        Err(_) => continue,
                    },
                };
                self.workspace.set(&name, text, |path| resolve(&name, path));
                self.stamps.insert(name.clone(), stamp);
            }
            // A loaded file may be outside the listed folders.
            for load in self.workspace.loads(&name) {
                if !done.contains(load)
                    && let Some(stamp) = saved_stamp(Path::new(load))
                {
                    queue.push((load.to_string(), stamp));
                }
            }
        }
        for name in left {
            self.workspace.remove(&name);
            self.stamps.remove(&name);
        }
    }

    /// The name under which a text is known.
    pub fn name_of(uri: &str) -> String {
        name_of(uri)
    }
}

fn saved_stamp(path: &Path) -> Option<Stamp> {
    let data = path.metadata().ok().filter(std::fs::Metadata::is_file)?;
    Some(Stamp::Saved(data.modified().ok(), data.len()))
}

/// The programs in a folder and those below it; false when there are too many.
fn list(folder: &Path, seen: &mut usize, found: &mut BTreeMap<String, Stamp>) -> bool {
    let Ok(entries) = std::fs::read_dir(folder) else { return true };
    for entry in entries.flatten() {
        *seen += 1;
        if *seen > MOST_ENTRIES || found.len() > MOST_FILES {
            return false;
        }
        let name = entry.file_name();
        let name = name.to_string_lossy();
        // Links are not followed: a folder may be in itself.
        let Ok(kind) = entry.file_type() else { continue };
        if name.starts_with('.') || name == "node_modules" {
            continue;
        }
        let path = entry.path();
        if kind.is_dir() && !list(&path, seen, found) {
            return false;
        }
        if kind.is_file()
            && name.ends_with(".sdl")
            && let Some(stamp) = saved_stamp(&path)
        {
            found.insert(path.display().to_string(), stamp);
        }
    }
    true
}
