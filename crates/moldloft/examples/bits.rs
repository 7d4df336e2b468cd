//! Hashes of results, bit for bit: all examples, every kind's and function's own example, the
//! programs of the corpus. Run `cargo run -p moldloft --example bits > there.txt` on another
//! processor or system, and compare with `tests/bits.txt`, which `make bits` updates after a change
//! of results. The two must be equal: no result depends on the width of registers, the optimisation
//! level, threads or the C library.

use moldloft::{Document, FileWorld, Value, WriteOptions, format_named, registry, write};
use std::path::{Path, PathBuf};

/// FNV-1a of 64 bits (Fowler, Noll, Vo 1991).
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
        self
    }

    /// Bits of numbers; processors differ in the sign and the rest of a NaN, which means nothing.
    fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) -> &mut Self {
        for x in numbers {
            let x = if x.is_nan() { f64::NAN } else { x };
            self.bytes(&x.to_bits().to_le_bytes());
        }
        self
    }
}

/// Formats whose bytes name no version of the program.
const FORMATS: [&str; 6] = ["gdf", "svg", "p3d", "volume-p3d", "sdl", "ms2"];

/// All results of a document under one hash, and its number of vertices, if any.
fn of(mut document: Document, formats: &[&str]) -> String {
    let mut hash = Hash::new();
    let mut reported = String::new();
    for fault in document.diagnostics() {
        // Ids and spans: words may be improved.
        hash.bytes(fault.id.as_bytes());
        if let Some(label) = &fault.primary {
            hash.bytes(&label.span.start.to_le_bytes()).bytes(&label.span.end.to_le_bytes());
        }
    }
    for line in document.printed() {
        hash.bytes(line.as_bytes());
    }
    for (name, bytes) in document.written() {
        hash.bytes(name.as_bytes()).bytes(bytes);
    }
    for (name, _, value) in document.variables() {
        hash.bytes(name.as_bytes());
        match value {
            Value::Number(x) => hash.numbers([x]),
            Value::Vector(v) => hash.numbers([v.x, v.y, v.z]),
            Value::Numbers(array) => hash.numbers(array.items.iter().copied()),
            Value::Vectors(all) => hash.numbers(all.iter().flat_map(|v| [v.x, v.y, v.z])),
            _ => &mut hash,
        };
    }
    let parameters: Vec<String> =
        document.params().iter().map(|p| p.name.clone()).take(2).collect();
    match document.panelled() {
        Ok(panelled) => {
            let mesh = &panelled.mesh;
            if !mesh.positions().is_empty() {
                reported = format!("{} vertices", mesh.positions().len());
            }
            hash.numbers(mesh.positions().iter().flat_map(|p| [p.x, p.y, p.z]));
            for corner in mesh.faces().iter().flatten() {
                hash.bytes(&corner.to_le_bytes());
            }
        }
        Err(fault) => {
            hash.bytes(fault.id.as_bytes());
        }
    }
    if let Ok(columns) = document.jacobian(&parameters) {
        hash.numbers(columns.iter().flatten().flat_map(|v| [v.x, v.y, v.z]));
    }
    for format in formats {
        let Ok(row) = format_named(format) else { continue };
        match write(&mut document, row, "x", &WriteOptions::default()) {
            Ok(files) => {
                for file in files {
                    hash.bytes(&file.bytes);
                }
            }
            Err(faults) => {
                for fault in faults {
                    hash.bytes(fault.id.as_bytes());
                }
            }
        }
    }
    format!("{:016x} {reported}", hash.0)
}

/// Root folder of the repository.
pub fn root() -> PathBuf {
    // Elsewhere than where it was built it is given.
    std::env::var_os("MOLDLOFT_ROOT")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."), PathBuf::from)
}

fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![root().join(folder)]);
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let named = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_owned();
            if path.is_dir() {
                open.push(path);
            } else if endings.contains(&named.as_str()) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The programs of a file of the corpus, by their names; lines that begin with `#` and a sign are expectations.
fn programs(text: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("#### ") {
            found.push((name.trim().to_owned(), String::new()));
        } else if let Some((_, body)) = found.last_mut()
            && !["#<", "#>", "#?"].iter().any(|sign| line.starts_with(sign))
        {
            body.push_str(line);
            body.push('\n');
        }
    }
    found
}

/// One line for each result: a hash, its name, and its size.
pub fn lines(examples: bool) -> Vec<String> {
    let mut found = Vec::new();
    if examples {
        for path in files("examples", &["sdl", "ms2", "skt"]) {
            let name = path.strip_prefix(root().join("examples")).unwrap_or(&path);
            let name = name.to_string_lossy().replace('\\', "/");
            let path = path.to_string_lossy();
            let document =
                Document::open(registry(), Box::new(FileWorld::around(&path, &[])), &path);
            found.push(format!("example {name} {}", of(document, &FORMATS)));
        }
    }
    // The examples read a font of a few letters.
    let letters = FileWorld::new(Some(&root().join("crates/font/tests")), &[]);
    let text = |name: &str, text: &str| {
        Document::from_text(registry(), Box::new(letters.clone()), name, text)
    };
    for row in registry().rows() {
        if !row.example.is_empty() {
            let document = text("row.sdl", &row.example);
            found.push(format!("row {} {}", row.name, of(document, &["sdl"])));
        }
    }
    for path in files("tests/corpus/run", &["sdl"]) {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let all = std::fs::read_to_string(&path).unwrap_or_default();
        for (name, body) in programs(&all) {
            found.push(format!("corpus {stem}/{name} {}", of(text("corpus.sdl", &body), &[])));
        }
    }
    found.iter_mut().for_each(|line| line.truncate(line.trim_end().len()));
    found
}

/// Prints the hashes: of all, or with `quick` without the examples of `examples/`.
pub fn main() {
    let quick = std::env::args().nth(1).is_some_and(|word| word == "quick");
    for line in lines(!quick) {
        println!("{line}");
    }
}
