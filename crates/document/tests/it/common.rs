//! What the tests of documents share: opening texts, values.

use moldloft_diag::Diagnostic;
use moldloft_document::{
    Document, FlotationOptions, NoFiles, ReadText, TextReadError, World, registry,
};
use moldloft_num::Vec3;
use moldloft_registry::Value;
pub use moldloft_testing::{Random, soak};

/// How many rounds to run: two per cent of a long run, or all of it with `MOLDLOFT_SOAK=1`.
pub fn rounds(long: usize) -> usize {
    moldloft_testing::rounds(long / 50, long)
}

/// A document of a program.
pub fn open(text: &str) -> Document {
    Document::from_text(registry(), Box::new(OneFont), "model.sdl", text)
}

/// The file that examples of functions read: a font of a few letters.
pub struct OneFont;

impl World for OneFont {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError> {
        const LETTERS: &[u8] = include_bytes!("../../../font/tests/letters.ttf");
        match path {
            "letters.ttf" => Ok(ReadText { name: path.to_owned(), bytes: LETTERS.into() }),
            _ => NoFiles.read(path, from),
        }
    }
}

/// A document of a program without faults.
pub fn sound(text: &str) -> Document {
    let document = open(text);
    assert!(document.diagnostics().is_empty(), "{}\n{text}", reported(&document).join("\n"));
    document
}

/// A line for each diagnostic: severity, id, place, message.
pub fn reported(document: &Document) -> Vec<String> {
    document.diagnostics().iter().map(|d| line(document, d)).collect()
}

/// A diagnostic in one line.
pub fn line(document: &Document, d: &Diagnostic) -> String {
    let span = d.span();
    let place = match document.sources().locate(span.file, span.start) {
        Some(at) => format!("{}:{}", at.line, at.column),
        None => "-".into(),
    };
    let rest = d.expectation().map(|text| format!(" ({text})")).unwrap_or_default();
    format!("{}[{}] {place} {}{rest}", d.severity, d.id, d.message)
}

/// The ids of all diagnostics.
pub fn ids(document: &Document) -> Vec<String> {
    document.diagnostics().iter().map(|d| d.id.to_string()).collect()
}

/// The number that an expression is.
pub fn number(document: &mut Document, text: &str) -> f64 {
    match document.eval(text) {
        Ok(Value::Number(x)) => x,
        other => panic!("{text}: {other:?}"),
    }
}

/// The vector or position that an expression is.
pub fn vector(document: &mut Document, text: &str) -> Vec3 {
    match document.eval(text) {
        Ok(Value::Vector(v)) => v,
        Ok(Value::Point(p)) => p.xyz,
        other => panic!("{text}: {other:?}"),
    }
}

/// Files in memory.
pub struct Files(pub Vec<(&'static str, &'static str)>);

impl World for Files {
    fn read(&self, path: &str, _from: Option<&str>) -> Result<ReadText, TextReadError> {
        let found = self.0.iter().find(|(name, _)| *name == path);
        found
            .map(|(name, text)| ReadText { name: name.to_string(), bytes: text.as_bytes().into() })
            .ok_or_else(|| TextReadError { message: format!("unknown file `{path}`"), help: None })
    }
}

/// A document of a program that may load files from memory.
pub fn with_files(text: &str, files: &[(&'static str, &'static str)]) -> Document {
    Document::from_text(registry(), Box::new(Files(files.to_vec())), "model.sdl", text)
}

/// Water of density 1 on the whole body.
pub const WATER: FlotationOptions = FlotationOptions {
    density: 1.0,
    gravity: 9.81,
    centimetre: 0.01,
    centre: None,
    one_side: false,
    of_weights: false,
    flooded: false,
    accuracy: 1e-6,
};
