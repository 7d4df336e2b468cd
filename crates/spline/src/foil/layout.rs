//! Position of a foil in space: chord, thickness and mean-line directions from points.

use super::error::FoilError;
use super::station::Station;
use moldloft_num::{Jet, Real, Vec3};

/// Direction of thickness from the mean line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Offset {
    /// Along the direction of the thickness point, independent of the camber: an affine map of the
    /// section, linear in the points.
    #[default]
    Affine,
    /// Normal to the mean line, as the NACA define their cambered sections.
    Normal,
}

/// The metric of the plane or space of a foil: the scalar product.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Metric<T> {
    /// The Euclidean metric of space.
    #[default]
    Space,
    /// The metric of a plane of parameters (u, v): its entries uu, uv and vv.
    Plane([T; 3]),
}

impl<T: Real> Metric<T> {
    /// The scalar product of two vectors that may be jets.
    fn dot<J: Jet<T>>(&self, a: Vec3<J>, b: Vec3<J>) -> J {
        match *self {
            Metric::Space => a.dot(b),
            Metric::Plane([uu, uv, vv]) => {
                (a.x * b.x).scaled(uu) + (a.x * b.y + a.y * b.x).scaled(uv) + (a.y * b.y).scaled(vv)
            }
        }
    }

    fn is_positive(&self) -> bool {
        match self {
            Metric::Space => true,
            Metric::Plane([uu, uv, vv]) => {
                let (uu, uv, vv) = (uu.re(), uv.re(), vv.re());
                uu > 0.0 && uu * vv > uv * uv
            }
        }
    }
}

/// Position of a section, determined by its points.
///
/// Three points are nose, thickness point and tail of a half section. Four are upper tail,
/// thickness point, nose and lower tail of a symmetric one; five have a lower thickness point
/// before the lower tail. Of a thickness point only the distance vector from the chord counts, the
/// chord being the line from the nose to the middle of the tails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout<T> {
    nose: Vec3<T>,
    /// Upper and lower tail.
    tails: [Vec3<T>; 2],
    /// The vector from the nose to the middle of the tails.
    chord: Vec3<T>,
    /// The greatest camber, as a vector perpendicular to the chord.
    camber: Vec3<T>,
    /// Half the greatest thickness, likewise.
    thickness: Vec3<T>,
    half: bool,
    metric: Metric<T>,
}

impl<T: Real> Layout<T> {
    /// The layout of three, four or five points.
    ///
    /// # Errors
    /// [`FoilError`] for another number of points, no chord, or a metric that is not positive.
    pub fn new(points: &[Vec3<T>], metric: Metric<T>) -> Result<Self, FoilError> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(FoilError::NotFinite { index });
        }
        if !metric.is_positive() {
            return Err(FoilError::Metric);
        }
        let (nose, tails, above, below) = match *points {
            [nose, above, tail] => (nose, [tail, tail], above, None),
            [upper, above, nose, lower] => (nose, [upper, lower], above, None),
            [upper, above, nose, below, lower] => (nose, [upper, lower], above, Some(below)),
            _ => return Err(FoilError::Points { actual: points.len() }),
        };
        let chord = (tails[0] + tails[1]) * T::from(0.5) - nose;
        let square = metric.dot(chord, chord);
        let size = points.iter().fold(0.0f64, |m, p| m.max(p.re().norm()));
        if chord.re().norm() <= 8.0 * f64::EPSILON * size || square.re() <= 0.0 {
            return Err(FoilError::NoChord);
        }
        let across = |p: Vec3<T>| {
            let d = p - nose;
            d - chord * (metric.dot(d, chord) / square)
        };
        let above = across(above);
        let below = below.map_or(-above, across);
        let half = T::from(0.5);
        Ok(Self {
            nose,
            tails,
            chord,
            camber: (above + below) * half,
            thickness: (above - below) * half,
            half: points.len() == 3,
            metric,
        })
    }

    /// A foil of zero size whose points coincide, such as the tip of a loft, with the derivatives
    /// of the points.
    ///
    /// # Errors
    /// [`FoilError::Points`] for another number of points than 3, 4 or 5.
    pub fn vanishing(points: &[Vec3<T>]) -> Result<Self, FoilError> {
        let (nose, tails, above, below) = match *points {
            [nose, above, tail] => (nose, [tail, tail], above, None),
            [upper, above, nose, lower] => (nose, [upper, lower], above, None),
            [upper, above, nose, below, lower] => (nose, [upper, lower], above, Some(below)),
            _ => return Err(FoilError::Points { actual: points.len() }),
        };
        let half = T::from(0.5);
        let chord = (tails[0] + tails[1]) * half - nose;
        let above = above - nose;
        let below = below.map_or(-above, |p| p - nose);
        Ok(Self {
            nose,
            tails,
            chord,
            camber: (above + below) * half,
            thickness: (above - below) * half,
            half: points.len() == 3,
            metric: Metric::Space,
        })
    }

    /// True for a half section.
    pub fn is_half(&self) -> bool {
        self.half
    }

    /// The greatest thickness in chords.
    pub fn ratio(&self) -> T {
        let square = |v| self.metric.dot::<T>(v, v);
        let thickness = square(self.thickness);
        if thickness.re() <= 0.0 {
            return T::zero();
        }
        (thickness / square(self.chord)).sqrt() * 2.0
    }

    /// The position of a station.
    pub fn place<J: Jet<T>>(&self, station: Station<J>, offset: Offset) -> Vec3<J> {
        let Station { x, thickness, camber, slope, lower } = station;
        let times = |v: Vec3<T>, j: J| v.map(|a| j.scaled(a));
        // Exact at both ends.
        let tail = self.tails[usize::from(lower)];
        let mean = times(self.nose, -x + 1.0) + times(tail, x) + times(self.camber, camber);
        let straight = self.thickness.map(J::fixed);
        let size = self.thickness.re().norm();
        if offset == Offset::Affine || size == 0.0 || self.camber.re().norm() == 0.0 {
            return mean + straight * thickness;
        }
        // The thickness vector turned until it is perpendicular to the mean line, at its length.
        let along = self.chord.map(J::fixed) + times(self.camber, slope);
        let dot = |a, b| self.metric.dot(a, b);
        let upright = straight - along * (dot(straight, along) / dot(along, along));
        let stretch = (dot(straight, straight) / dot(upright, upright)).sqrt();
        mean + upright * (stretch * thickness)
    }
}
