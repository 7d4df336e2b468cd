//! Conditions on a curve at a parameter, and quantities that it preserves.

use crate::curve::condition::{AXES, joined};
use crate::curve::moving::{MapReal, MovingSpace};
use crate::{Condition, FairError, Space};
use moldloft_num::{Real, Vec3};

/// A condition at a parameter or on the whole curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand<T = f64> {
    /// The curve passes through a point.
    Through(Vec3<T>),
    /// Tangent direction.
    Tangent(Vec3<T>),
    /// Continuation of another curve at the start or end: its first and second derivative, with
    /// respect to a parameter of the same direction.
    Join([Vec3<T>; 2]),
    /// The area swept about the origin in the plane of x and y is preserved, to first order.
    Area,
    /// The volume of revolution about x is preserved, to first order.
    Volume,
    /// The mean of the control points is preserved.
    Centroid,
}

/// A condition whose value and factors carry derivatives.
pub(crate) struct MovingCondition<T> {
    pub entries: Vec<(usize, Vec3<T>)>,
    pub value: T,
}

impl<T: Real> Demand<T> {
    /// Quantity to preserve, by name.
    pub fn kept(name: &str) -> Option<Self> {
        Some(match name {
            "area" => Self::Area,
            "volume" => Self::Volume,
            "centroid" => Self::Centroid,
            _ => return None,
        })
    }

    /// Its real part.
    pub fn re(self) -> Demand {
        match self {
            Self::Through(p) => Demand::Through(p.re()),
            Self::Tangent(d) => Demand::Tangent(d.re()),
            Self::Join(neighbour) => Demand::Join(neighbour.map(|v| v.re())),
            Self::Area => Demand::Area,
            Self::Volume => Demand::Volume,
            Self::Centroid => Demand::Centroid,
        }
    }

    /// True if it carries no derivative.
    pub(crate) fn is_constant(&self) -> bool {
        let constant = |v: &Vec3<T>| v.to_array().iter().all(|x| x.is_constant());
        match self {
            Self::Through(v) | Self::Tangent(v) => constant(v),
            Self::Join(neighbour) => neighbour.iter().all(constant),
            Self::Area | Self::Volume | Self::Centroid => true,
        }
    }

    /// The conditions of a join, as [`Demand::conditions`] has them, on knots and about control points
    /// that carry derivatives; `None` for other demands.
    pub(crate) fn moving(
        self,
        space: MovingSpace<'_, T>,
        control: &[Vec3<T>],
        share: f64,
    ) -> Option<Result<Vec<MovingCondition<T>>, FairError>> {
        let Self::Join(neighbour) = self else { return None };
        let (start, end) = space.space.domain();
        let (k, t) = space.space.locate(if share > 0.5 { end } else { start });
        let columns: Vec<usize> = space.space.columns(k).collect();
        let rows = [1, 2].map(|order| space.derivative(k, T::from(t), order));
        let own = rows.each_ref().map(|row| {
            let entries = columns.iter().zip(row);
            entries.fold(Vec3::zero(), |s: Vec3<T>, (&c, &b)| s + control[c].map(|x| x * b))
        });
        let wanted = match joined(own, neighbour) {
            Ok(wanted) => wanted,
            Err(error) => return Some(Err(error)),
        };
        let mut out = Vec::new();
        for (row, wanted) in rows.iter().zip(wanted) {
            for (axis, value) in AXES.into_iter().zip(wanted.to_array()) {
                let entry = |(&c, &b): (&usize, &T)| (c, axis.map_real(|x| b * x));
                out.push(MovingCondition {
                    entries: columns.iter().zip(row).map(entry).collect(),
                    value,
                });
            }
        }
        Some(Ok(out))
    }
}

impl Demand {
    /// Linear conditions on control points, linearised at `control`; `share` is the parameter as a
    /// fraction of the domain.
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
