//! The units of a model: of length, mass, force and angle, each a word of one table.

/// Physical dimension of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhysicalDimension {
    /// In metres.
    Length,
    /// In kilograms.
    Mass,
    /// In newtons.
    Force,
    /// In radians.
    Angle,
}

/// The known units: word, dimension, size in metres, kilograms, newtons or radians. Exact by
/// definition (BIPM 2019, The International System of Units; NIST SP 811, appendix B), except for
/// the angle.
pub const UNITS: [(&str, PhysicalDimension, f64); 21] = [
    ("m", PhysicalDimension::Length, 1.0),
    ("cm", PhysicalDimension::Length, 0.01),
    ("mm", PhysicalDimension::Length, 0.001),
    ("km", PhysicalDimension::Length, 1000.0),
    ("ft", PhysicalDimension::Length, 0.3048),
    ("in", PhysicalDimension::Length, 0.0254),
    ("yd", PhysicalDimension::Length, 0.9144),
    ("kg", PhysicalDimension::Mass, 1.0),
    ("t", PhysicalDimension::Mass, 1000.0),
    ("g", PhysicalDimension::Mass, 0.001),
    ("lb", PhysicalDimension::Mass, 0.453_592_37),
    ("slug", PhysicalDimension::Mass, 14.593_902_937_206_364),
    ("LT", PhysicalDimension::Mass, 1_016.046_908_8),
    ("N", PhysicalDimension::Force, 1.0),
    ("kN", PhysicalDimension::Force, 1e3),
    ("MN", PhysicalDimension::Force, 1e6),
    ("lbf", PhysicalDimension::Force, 4.448_221_615_260_5),
    ("kgf", PhysicalDimension::Force, 9.806_65),
    ("tf", PhysicalDimension::Force, 9_806.65),
    ("rad", PhysicalDimension::Angle, 1.0),
    ("deg", PhysicalDimension::Angle, std::f64::consts::PI / 180.0),
];

/// The unit of that word, ignoring case if unambiguous.
pub fn unit(word: &str) -> Option<(&'static str, PhysicalDimension, f64)> {
    let same = UNITS.into_iter().find(|u| u.0 == word);
    same.or_else(|| UNITS.into_iter().find(|u| u.0.eq_ignore_ascii_case(word)))
}

/// The units stated by a text such as "m t kN", at most one per dimension.
///
/// # Errors
/// The word that is not a unit, or the second of a dimension.
pub fn parsed(text: &str) -> Result<Vec<(&'static str, PhysicalDimension, f64)>, String> {
    let mut found: Vec<(&'static str, PhysicalDimension, f64)> = Vec::new();
    for word in text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
        // Time is in seconds everywhere.
        if matches!(word, "s" | "sec") {
            continue;
        }
        let known = unit(word).ok_or_else(|| word.to_string())?;
        if found.iter().any(|f| f.1 == known.1) {
            return Err(word.to_string());
        }
        found.push(known);
    }
    Ok(found)
}
