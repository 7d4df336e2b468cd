//! Conditions on a curve at a parameter, and quantities that it preserves.

use crate::{Condition, FairError, Space};
use moldloft_num::Vec3;

/// A condition at a parameter, or on the whole curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// It passes through a point.
    Through(Vec3<f64>),
    /// Tangent direction.
    Tangent(Vec3<f64>),
    /// Continuation of another curve at the start or end: its first and second derivative, with
    /// respect to a parameter of the same direction.
    Join([Vec3<f64>; 2]),
    /// It keeps the area swept about the origin in the plane of x and y, to first order.
    Area,
    /// It keeps the volume of revolution about x, to first order.
    Volume,
    /// It keeps the mean of its control points.
    Centroid,
}

impl Demand {
    /// Quantity to preserve, by name.
    pub fn kept(name: &str) -> Option<Self> {
        Some(match name {
            "area" => Self::Area,
            "volume" => Self::Volume,
            "centroid" => Self::Centroid,
            _ => return None,
        })
    }

    /// Linear conditions on control points, linearised at `control`; `share` is the parameter
    /// relative to the domain.
    ///
    /// # Errors
    /// As [`Condition::join`].
    pub fn conditions(
        self,
        space: &Space,
        control: &[Vec3<f64>],
        share: f64,
    ) -> Result<Vec<Condition>, FairError> {
        let (a, b) = space.domain();
        let t = a + (b - a) * share;
        Ok(match self {
            Self::Through(p) => Condition::point(space, t, p),
            Self::Tangent(d) => Condition::tangent(space, t, d),
            Self::Join(neighbour) => Condition::join(space, control, share > 0.5, neighbour)?,
            Self::Area => vec![Condition::area(space, control, Vec3::of(0.0, 0.0, 1.0))],
            Self::Volume => vec![Condition::revolution(space, control, Vec3::of(1.0, 0.0, 0.0))],
            Self::Centroid => Condition::centroid(control),
        })
    }
}
