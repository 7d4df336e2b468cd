//! Files of a program: read from the host's world, written into a set that the host commits.
//!
//! A file is a unit number, as in FORTRAN. Texts only: a point on each line, numbers with all their
//! digits, the first index of a grid fastest. Whatever is written can be read again in the same run.

use crate::source::world::World;
use indexmap::IndexMap;
use moldloft_diag::Diagnostic;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The units of the terminal.
const STANDARD_ERROR: u32 = 0;
const STANDARD_INPUT: u32 = 5;
/// Unit 6, FORTRAN's standard output.
pub const STANDARD_OUTPUT: u32 = 6;

/// Units that `open` gives out begin here.
const FIRST_FREE: u32 = 10;

/// The most bytes of all files that a run writes, and the most files open at a time.
const MOST_BYTES: usize = 256 << 20;
const MOST_OPEN: usize = 1_000;

/// The number of a predeclared name: a unit, or PI.
pub fn predeclared(name: &str) -> Option<f64> {
    match name {
        "PI" => Some(std::f64::consts::PI),
        "stdin" => Some(f64::from(STANDARD_INPUT)),
        "stdout" => Some(f64::from(STANDARD_OUTPUT)),
        "stderr" => Some(f64::from(STANDARD_ERROR)),
        _ => None,
    }
}

/// Files opened and written by a run.
#[derive(Debug, Default)]
pub struct RunFiles {
    open: BTreeMap<u32, OpenFile>,
    written: IndexMap<String, Vec<u8>>,
    bytes: usize,
}

#[derive(Debug)]
enum OpenFile {
    Read { name: String, text: Arc<str>, at: usize },
    Write { name: String },
}

/// Mode of opening a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenMode {
    /// An existing file, read from its beginning.
    Read,
    /// A new file, or an existing one emptied.
    Write,
    /// An existing file, written at its end.
    Append,
}

impl OpenMode {
    /// The mode of the word `read`, `write` or `append`.
    pub fn parse(word: &str) -> Result<Self, Diagnostic> {
        match word {
            "r" => Ok(OpenMode::Read),
            "w" => Ok(OpenMode::Write),
            "a" => Ok(OpenMode::Append),
            _ => Err(Diagnostic::error("unknown-mode", format!("unknown mode \"{word}\""))
                .expected("\"r\" to read, \"w\" to write or \"a\" to append")
                .found(format!("\"{word}\""))),
        }
    }
}

/// The name of a file inside the program's folder, with `/` between its parts.
pub fn inside(path: &str) -> Result<String, Diagnostic> {
    let outside = |why: &str| {
        Diagnostic::error("outside-folder", format!("cannot write `{path}`: {why}"))
            .expected("the name of a file in the program's own folder")
            .found(path.to_string())
            .help("the folder for results is chosen by `moldloft run -o FOLDER`")
    };
    let spelled = path.replace('\\', "/");
    let drive = spelled.as_bytes().get(1) == Some(&b':');
    if spelled.starts_with('/') || drive {
        return Err(outside("it is an absolute path"));
    }
    let mut parts = Vec::new();
    for part in spelled.split('/') {
        match part {
            "" | "." => {}
            ".." => return Err(outside("it leaves the folder")),
            part if part.contains(|c: char| c.is_control()) => {
                return Err(outside("it contains invalid characters"));
            }
            part => parts.push(part),
        }
    }
    if parts.is_empty() || spelled.ends_with('/') {
        return Err(outside("it names no file"));
    }
    Ok(parts.join("/"))
}

impl RunFiles {
    /// Opens a file; `unit` when the program chose one.
    pub fn open(
        &mut self,
        world: &dyn World,
        from: &str,
        path: &str,
        mode: OpenMode,
        unit: Option<u32>,
    ) -> Result<u32, Diagnostic> {
        let unit = unit.unwrap_or_else(|| {
            (FIRST_FREE..).find(|u| !self.open.contains_key(u)).expect("there are enough numbers")
        });
        if self.open.len() >= MOST_OPEN {
            return Err(Diagnostic::error("too-many-files", "too many files are open")
                .expected(format!("at most {MOST_OPEN} at a time"))
                .help("close() them"));
        }
        if predeclared_unit(unit) || self.open.contains_key(&unit) {
            return Err(Diagnostic::error("unit-in-use", format!("unit {unit} is open already"))
                .help("close it first, or let open(\"name\", \"w\") choose a unit"));
        }
        let open = match mode {
            OpenMode::Read => {
                // Files written by this run take precedence over those on disk.
                let own = inside(path).ok().and_then(|name| self.written.get(&name));
                let text = match own {
                    Some(bytes) => moldloft_syntax::decode(bytes, path)?.to_string(),
                    None => {
                        let read = world.read(path, Some(from)).map_err(|e| {
                            Diagnostic::error("cannot-read", e.message).maybe_help(e.help)
                        })?;
                        moldloft_syntax::decode(&read.bytes, &read.name)?.to_string()
                    }
                };
                OpenFile::Read { name: path.into(), text: text.into(), at: 0 }
            }
            OpenMode::Write | OpenMode::Append => {
                let name = inside(path)?;
                let busy = |o: &OpenFile| matches!(o, OpenFile::Write { name: n } if *n == name);
                if self.open.values().any(busy) {
                    return Err(Diagnostic::error(
                        "unit-in-use",
                        format!("`{name}` is open for writing already"),
                    )
                    .help("close it first"));
                }
                let file = self.written.entry(name.clone()).or_default();
                if mode == OpenMode::Write {
                    self.bytes -= file.len();
                    file.clear();
                }
                OpenFile::Write { name }
            }
        };
        self.open.insert(unit, open);
        Ok(unit)
    }

    /// The content of a file, from this run or from disk.
    pub fn bytes(&self, world: &dyn World, from: &str, path: &str) -> Result<Vec<u8>, Diagnostic> {
        if let Some(bytes) = inside(path).ok().and_then(|name| self.written.get(&name)) {
            return Ok(bytes.clone());
        }
        let read = world.read(path, Some(from));
        let read =
            read.map_err(|e| Diagnostic::error("cannot-read", e.message).maybe_help(e.help))?;
        Ok(read.bytes.to_vec())
    }

    /// A whole file.
    pub fn put(&mut self, path: &str, bytes: Vec<u8>) -> Result<(), Diagnostic> {
        let name = inside(path)?;
        if self.open.values().any(|o| matches!(o, OpenFile::Write { name: n } if *n == name)) {
            let message = format!("`{name}` is open for writing already");
            return Err(Diagnostic::error("unit-in-use", message).help("close it first"));
        }
        let replaced = self.written.get(&name).map_or(0, Vec::len);
        self.bytes = self.bytes - replaced + bytes.len();
        if self.bytes > MOST_BYTES {
            return Err(too_much());
        }
        self.written.insert(name, bytes);
        Ok(())
    }

    /// Closes a unit; a unit that is not open is an error.
    pub fn close(&mut self, unit: u32) -> Result<(), Diagnostic> {
        self.open.remove(&unit).map(drop).ok_or_else(|| not_open(unit))
    }

    /// Adds to a file.
    pub fn write(&mut self, unit: u32, text: &str) -> Result<(), Diagnostic> {
        let Some(open) = self.open.get(&unit) else { return Err(not_open(unit)) };
        let OpenFile::Write { name } = open else {
            return Err(Diagnostic::error(
                "wrong-mode",
                format!("unit {unit} is open for reading"),
            )
            .help("open it with \"w\" to write"));
        };
        self.bytes += text.len();
        if self.bytes > MOST_BYTES {
            return Err(too_much());
        }
        let file = self.written.get_mut(name).expect("entered by open");
        file.extend_from_slice(text.as_bytes());
        Ok(())
    }

    fn reading(&mut self, unit: u32) -> Result<(&str, &str, &mut usize), Diagnostic> {
        if unit == STANDARD_INPUT {
            return Err(Diagnostic::error("cannot-read", "a program has no standard input")
                .help("read from a file: open(\"name\", \"r\")"));
        }
        match self.open.get_mut(&unit) {
            Some(OpenFile::Read { name, text, at }) => Ok((name, text, at)),
            Some(OpenFile::Write { .. }) => {
                Err(Diagnostic::error("wrong-mode", format!("unit {unit} is open for writing"))
                    .help("close it and open it with \"r\" to read"))
            }
            None => Err(not_open(unit)),
        }
    }

    /// The next number.
    pub fn number(&mut self, unit: u32) -> Result<f64, Diagnostic> {
        let (name, text, at) = self.reading(unit)?;
        let blank = |c: char| c.is_whitespace() || c == ',';
        let rest = &text[*at..];
        let start = *at + rest.find(|c| !blank(c)).unwrap_or(rest.len());
        let end = start + text[start..].find(blank).unwrap_or(text.len() - start);
        *at = end;
        let word = &text[start..end];
        if word.is_empty() {
            return Err(Diagnostic::error("end-of-file", format!("`{name}` has no more numbers"))
                .help("more(f) reports whether there is more to read"));
        }
        // FORTRAN writes exponents with d as well.
        let spelled = word.replace(['d', 'D'], "e");
        spelled.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
            let line = text[..start].matches('\n').count() + 1;
            Diagnostic::error("not-a-number", format!("`{name}`, line {line}: no number"))
                .expected("a finite number")
                .found(word.chars().take(40).collect::<String>())
        })
    }

    /// The rest of the line.
    pub fn line(&mut self, unit: u32) -> Result<String, Diagnostic> {
        let (name, text, at) = self.reading(unit)?;
        if *at >= text.len() {
            return Err(Diagnostic::error("end-of-file", format!("`{name}` has no more lines"))
                .help("more(f) reports whether there is more to read"));
        }
        let rest = &text[*at..];
        let end = rest.find('\n').unwrap_or(rest.len());
        *at += (end + 1).min(rest.len());
        Ok(rest[..end].trim_end_matches('\r').to_string())
    }

    /// True when something other than blanks is left to read.
    pub fn more(&mut self, unit: u32) -> Result<bool, Diagnostic> {
        let (_, text, at) = self.reading(unit)?;
        Ok(!text[*at..].trim().is_empty())
    }

    /// Goes back to the beginning.
    pub fn rewind(&mut self, unit: u32) -> Result<(), Diagnostic> {
        let (_, _, at) = self.reading(unit)?;
        *at = 0;
        Ok(())
    }

    /// Written files, by name.
    pub fn written(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.written.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()))
    }
}

fn too_much() -> Diagnostic {
    Diagnostic::error("too-much-output", "the program writes too much")
        .expected(format!("at most {MOST_BYTES} bytes in all files"))
}

fn predeclared_unit(unit: u32) -> bool {
    [STANDARD_ERROR, STANDARD_INPUT, STANDARD_OUTPUT].contains(&unit)
}

fn not_open(unit: u32) -> Diagnostic {
    Diagnostic::error("not-open", format!("unit {unit} is not open"))
        .expected("a file that open() gave")
        .found(format!("unit {unit}"))
}
