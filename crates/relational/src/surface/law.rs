//! Numbers that change along a surface.

use crate::faults;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use moldloft_spline::BSplineCurve;

/// A law along a parameter: the first coordinate of the clamped uniform B-spline of degree 3 or less
/// with these coefficients, which are those of field `field`.
///
/// # Errors
/// `too-few-items` for an empty list.
pub fn law<T: Real>(
    values: Option<Vec<T>>,
    field: FieldId,
) -> Result<Option<BSplineCurve<T>>, CallError> {
    let Some(mut values) = values else { return Ok(None) };
    match values[..] {
        [] => {
            return Err(CallError::new("too-few-items", "a law needs at least 1 number")
                .expected("at least 1 number")
                .found("0")
                .in_field(field));
        }
        [constant] => values.push(constant),
        _ => {}
    }
    let degree = 3.min(values.len() - 1);
    let points = values.iter().map(|&x| Vec3::new(x, T::zero(), T::zero())).collect();
    BSplineCurve::uniform(degree, points)
        .map(Some)
        .map_err(|error| faults::of_spline(error, field, field))
}
