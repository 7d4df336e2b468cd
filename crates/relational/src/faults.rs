//! Errors of the mathematical crates, with the argument at fault.

use moldloft_registry::{CallError, FieldId};
use moldloft_spline::{ArcError, InterpolationError, KnotError, SplineError};

/// The error of a B-spline whose control points are the list in field `items` and whose degree is
/// the number in field `degree`.
pub fn of_spline(error: SplineError, items: FieldId, degree: FieldId) -> CallError {
    match error {
        SplineError::Knots(KnotError::Degree { degree: found }) => {
            CallError::new("out-of-range", format!("degree = {found} is out of range"))
                .expected("a degree from 1 to 25")
                .found(found.to_string())
                .in_field(degree)
        }
        SplineError::NotFinite { index } => {
            CallError::new("not-finite", error.to_string()).in_item(index).in_field(items)
        }
        _ => CallError::new("no-spline", error.to_string()).in_field(items),
    }
}

/// The error of an interpolating spline through the list in field `items`, of the type in field
/// `degree`, with the end conditions in field `ends`; `noun` names the items.
pub fn of_interpolation(
    error: InterpolationError,
    noun: &str,
    [items, degree, ends]: [FieldId; 3],
) -> CallError {
    match error {
        InterpolationError::Coincident { first, second } => {
            let message = format!("{noun}s {} and {} coincide", first + 1, second + 1);
            CallError::new("coincident-points", message)
                .expected("distinct neighbouring points")
                .found(format!("no distance between {noun}s {} and {}", first + 1, second + 1))
                .help(format!("move one of the two, or leave {noun} {} out", second + 1))
                .in_item(second)
                .in_field(items)
        }
        InterpolationError::NotFinite { index } => {
            CallError::new("not-finite", error.to_string()).in_item(index).in_field(items)
        }
        InterpolationError::TooFew { expected, actual } => {
            CallError::new("too-few-items", error.to_string())
                .expected(format!("at least {expected} {noun}s"))
                .found(actual.to_string())
                .in_field(items)
        }
        InterpolationError::NotClosed { gap } => CallError::new("not-closed", error.to_string())
            .expected(format!("the first {noun} again as the last"))
            .found(format!("a gap of {gap}"))
            .help(format!("repeat the first {noun} at the end of the list"))
            .in_field(ends),
        InterpolationError::Type { actual } => CallError::new("out-of-range", error.to_string())
            .expected("1 (polyline) or 3 (cubic)")
            .found(actual.to_string())
            .in_field(degree),
        InterpolationError::Knots { .. } => CallError::new("no-spline", error.to_string()),
    }
}

/// The fault of an arc; `field` is its first point.
pub fn of_arc(error: ArcError, field: FieldId) -> CallError {
    let fault = match error {
        ArcError::Collinear => CallError::new("collinear-points", error.to_string())
            .expected("three points that span a plane")
            .found("three points in line")
            .help("move the third point off the line through the others"),
        ArcError::AtCentre => CallError::new("coincident-points", error.to_string())
            .expected("points away from the centre")
            .found("a point at the centre"),
        ArcError::NotFinite { .. } => CallError::new("not-finite", error.to_string()),
    };
    fault.in_field(field)
}

/// A number to nine digits, as shown in messages.
pub fn digits(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

/// A parameter from 0 to 1 to nine digits.
pub fn parameter(t: f64) -> f64 {
    (t * 1e9).round() / 1e9
}
