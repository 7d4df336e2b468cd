//! The model's unit of length, for formats in metres or millimetres.

use moldloft_document::Document;
use moldloft_lang::model_file::units::{self, PhysicalDimension};

/// Standard gravity in metres per second squared (ISO 80000-3).
pub const GRAVITY: f64 = 9.80665;

/// The unit of length that the model states, and its size in metres.
fn stated(document: &Document) -> Option<(String, f64)> {
    let stated = units::parsed(&document.units()).unwrap_or_default();
    let length = stated.into_iter().find(|u| u.1 == PhysicalDimension::Length);
    length.map(|(word, _, metres)| (word.into(), metres))
}

/// The word for the unit of length that the model states.
pub fn stated_length(document: &Document) -> Option<String> {
    stated(document).map(|(word, _)| word)
}

/// The model's unit of length and its size in millimetres; metres without a known unit.
pub fn length_unit(document: &Document) -> (String, f64) {
    let (word, metres) = stated(document).unwrap_or(("m".into(), 1.0));
    (word, MILLIMETRES * metres)
}

/// Millimetres in a metre.
const MILLIMETRES: f64 = 1000.0;

/// The unit of a 3MF file with this length in metres; metres if there is none.
pub(crate) fn threemf_unit(metres: f64) -> &'static str {
    const UNITS: [(f64, &str); 5] = [
        (1e-3, "millimeter"),
        (1e-2, "centimeter"),
        (0.0254, "inch"),
        (0.3048, "foot"),
        (1.0, "meter"),
    ];
    let found = UNITS.into_iter().find(|(size, _)| (size - metres).abs() < 1e-9 * metres);
    found.map_or("meter", |(_, name)| name)
}
