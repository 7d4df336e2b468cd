//! The model's unit of length, for what must be said in metres or millimetres.

use moldloft_document::Document;
use moldloft_registry::Value;

/// Standard gravity in metres per second squared (ISO 80000-3).
pub const GRAVITY: f64 = 9.80665;

/// The model's unit of length and its size in millimetres; metres when it names none that is known.
pub fn length_unit(document: &Document) -> (String, f64) {
    const KNOWN: [(&str, f64); 5] =
        [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("ft", 304.8), ("in", 25.4)];
    let header = document.graph().objects().find(|o| o.row.name == "Model");
    let units = header.and_then(|o| match o.args.get(o.row.field("units")?) {
        Some(Value::Text(units)) => Some(units.to_lowercase()),
        _ => None,
    });
    let length = units.as_deref().and_then(|units| units.split_whitespace().next());
    let known = KNOWN.into_iter().find(|(name, _)| Some(*name) == length);
    let (name, size) = known.unwrap_or(KNOWN[0]);
    (name.into(), size)
}

/// The unit of a 3MF file that is so many metres long; metres where it has none.
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
