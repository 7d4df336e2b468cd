//! Smooth unions, intersections and differences of functions: minima and maxima that are rounded where their operands differ by
//! less than a width.
//!
//! With h = max(w - |a - b|, 0) / w the smooth minimum is min(a, b) - w g(h), where g(1) is the depth by which it falls below its
//! operands where these are equal (I. Quilez, Smooth minimum, 2008, in the normalised form in which the operands stay as they
//! are beyond the width).

use crate::{FieldError, Primitive};
use moldloft_num::Real;

/// Shape of a smooth minimum: how far it is below its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmoothShape {
    /// g = h^2 / 4: common tangents at the ends of the blend.
    Quadratic,
    /// g = h^3 / 6: common curvature at the ends of the blend.
    Cubic,
    /// g = (1 + h - sqrt(1 - h (h - 2))) / 2: an arc of a circle between planes at right angles, for distances.
    Circular,
}

impl SmoothShape {
    /// The shape of that name.
    pub fn of_name(name: &str) -> Option<Self> {
        match name {
            "quadratic" => Some(Self::Quadratic),
            "cubic" => Some(Self::Cubic),
            "circular" => Some(Self::Circular),
            _ => None,
        }
    }

    /// The names of all shapes.
    pub const NAMES: [&'static str; 3] = ["quadratic", "cubic", "circular"];
}

/// The smooth minimum of two functions: the union of their solid sides with filled edges, where the
/// functions differ by less than `width`.
///
/// # Errors
/// A width that is not above zero.
///
/// # Example
/// ```
/// use moldloft_field::{Primitive, SmoothShape, smooth_minimum};
/// use moldloft_num::Vec3;
///
/// let [x, y, _] = Primitive::<f64>::axes();
/// let both = smooth_minimum([&x, &y], 0.4, SmoothShape::Quadratic)?;
/// // Where they are equal it is a quarter of the width lower; beyond the width it is the smaller.
/// assert!((both.value(Vec3::zero()) + 0.1).abs() < 1e-15);
/// assert_eq!(both.value(Vec3::of(0.1, 0.6, 0.0)), 0.1);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn smooth_minimum<T: Real>(
    [a, b]: [&Primitive<T>; 2],
    width: T,
    shape: SmoothShape,
) -> Result<Primitive<T>, FieldError> {
    let width = crate::error::positive("width", width)?;
    let zero = Primitive::real(T::zero());
    let h = (-(a - b).abs() + width).max(&zero) / width;
    let depth = match shape {
        SmoothShape::Quadratic => h.power(2) * T::from(0.25),
        SmoothShape::Cubic => h.power(3) / T::from(6.0),
        SmoothShape::Circular => {
            let root = (-h.power(2) + &h * T::from(2.0) + T::one()).sqrt();
            (h - root + T::one()) * T::from(0.5)
        }
    };
    Ok(a.min(b) - depth * width)
}
