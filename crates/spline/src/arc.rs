//! Circular arcs by three points, uniform in angle.

use crate::even_functions::{atanc_of_sq, cos_of_sq, sinc_of_sq};
use moldloft_num::{Curve, CurveJet, Jet, Order, Pace, Rational, Real, Vec3, curve_jet_of};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// Reason why three points determine no arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcError {
    /// The three points are on a line and do not determine the plane of a semicircle or circle.
    Collinear,
    /// The centre coincides with the start or with the point that gives the end's direction.
    AtCentre,
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Number of the point, from 0.
        index: usize,
    },
}

impl fmt::Display for ArcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Collinear => write!(f, "the three points of the arc are collinear"),
            Self::AtCentre => write!(f, "a point of the arc is at its centre"),
            Self::NotFinite { index } => write!(f, "point {} of the arc is not finite", index + 1),
        }
    }
}

impl std::error::Error for ArcError {}

/// A circular arc, uniform in angle over [0, 1].
///
/// An arc that its points make straight is a straight line at constant speed, and is approached
/// smoothly, derivatives included: all formulas are entire functions of the squared half angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircularArc<T> {
    form: ArcForm<T>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ArcForm<T> {
    /// The arc from `from` to `to`; `bulge` is perpendicular to the chord, on the arc's side, as
    /// long as half the angle times the chord. With h half the angle, d the chord: C = P + sin(h
    /// t)/sin h (d cos(h (1-t)) + (bulge/h) sin(h (1-t))). `whole` is sin h / h.
    Chord { from: Vec3<T>, to: Vec3<T>, bulge: Vec3<T>, half_sq: T, whole: T },
    /// About `centre` from the radius `spoke`; `turn` is perpendicular to it and as long as the
    /// angle times the radius: C = M + spoke cos(a t) + (turn/a) sin(a t).
    Sector { centre: Vec3<T>, spoke: Vec3<T>, turn: Vec3<T>, angle_sq: T },
    /// About `centre` over `quarters` right angles, `side` being perpendicular to `spoke` and as long.
    Quarters { centre: Vec3<T>, spoke: Vec3<T>, side: Vec3<T>, quarters: f64 },
}

impl<T: Real> CircularArc<T> {
    /// Type 1: from `p1` through `p2` to `p3`. Collinear points give the line from `p1` to `p3`.
    ///
    /// # Errors
    /// [`ArcError::NotFinite`].
    ///
    /// # Example
    /// ```
    /// use moldloft_num::{Curve, Order, Vec3};
    /// use moldloft_spline::CircularArc;
    /// let [a, b, c] = [[1., 0.], [0., 1.], [-1., 0.]].map(|[x, y]| Vec3::of(x, y, 0.));
    /// let arc = CircularArc::<f64>::through(a, b, c).unwrap();
    /// assert!((arc.jet(0.25, Order::Zero)[0].x - 0.5f64.sqrt()).abs() < 1e-15);
    /// ```
    pub fn through(p1: Vec3<T>, p2: Vec3<T>, p3: Vec3<T>) -> Result<Self, ArcError> {
        finite([p1, p2, p3])?;
        // The angle by which the path p1 p2 p3 turns is half the angle of the arc (Euclid III.32).
        Ok(Self::bulging(p1, p3, p2 - p1, (p2 - p1).dot(p3 - p2)))
    }

    /// Type 2: the shorter arc about `centre` from `start` to the direction of `toward`. Opposite
    /// directions give the line to the opposite point of the circle.
    ///
    /// # Errors
    /// [`ArcError::AtCentre`], [`ArcError::NotFinite`].
    pub fn about(start: Vec3<T>, centre: Vec3<T>, toward: Vec3<T>) -> Result<Self, ArcError> {
        finite([start, centre, toward])?;
        let (a, b) = (start - centre, toward - centre);
        if a.norm_sq().re() == 0.0 || b.norm_sq().re() == 0.0 {
            return Err(ArcError::AtCentre);
        }
        let normal = a.cross(b);
        let cosine = a.dot(b);
        if normal.norm_sq().re() == 0.0 && cosine.re() < 0.0 {
            let end = centre + b * (a.norm() / b.norm());
            return Ok(Self::bulging(start, end, end - start, cosine));
        }
        let rate = angle_over_sine(normal.norm_sq(), cosine);
        let turn = normal.cross(a) * rate;
        let angle_sq = rate * rate * normal.norm_sq();
        Ok(Self { form: ArcForm::Sector { centre, spoke: a, turn, angle_sq } })
    }

    /// Type 3: from `start`, tangent there to the line toward `toward`, to `end`.
    ///
    /// # Errors
    /// [`ArcError::NotFinite`].
    pub fn tangent_at_start(
        start: Vec3<T>,
        toward: Vec3<T>,
        end: Vec3<T>,
    ) -> Result<Self, ArcError> {
        finite([start, toward, end])?;
        let tangent = toward - start;
        Ok(Self::bulging(start, end, tangent, tangent.dot(end - start)))
    }

    /// Type 4: from `start` to `end`, tangent there to the line from `from`.
    ///
    /// # Errors
    /// [`ArcError::NotFinite`].
    pub fn tangent_at_end(start: Vec3<T>, from: Vec3<T>, end: Vec3<T>) -> Result<Self, ArcError> {
        finite([start, from, end])?;
        let tangent = end - from;
        Ok(Self::bulging(start, end, -tangent, tangent.dot(end - start)))
    }

    /// Type 5: the semicircle from `p1` to `p2` on the side of `p3`.
    ///
    /// # Errors
    /// [`ArcError::Collinear`], [`ArcError::NotFinite`].
    pub fn semicircle(p1: Vec3<T>, p2: Vec3<T>, p3: Vec3<T>) -> Result<Self, ArcError> {
        finite([p1, p2, p3])?;
        let centre = (p1 + p2).map(|x| x * 0.5);
        Self::quarters(centre, p1, p3, 2.0)
    }

    /// Type 6: the full circle from `p1` about `centre`, starting toward the side of `p3`.
    ///
    /// # Errors
    /// [`ArcError::Collinear`], [`ArcError::NotFinite`].
    pub fn circle(p1: Vec3<T>, centre: Vec3<T>, p3: Vec3<T>) -> Result<Self, ArcError> {
        finite([p1, centre, p3])?;
        Self::quarters(centre, p1, p3, 4.0)
    }

    /// The arc of `kind` 1 to 6 by its three points, in the order of the constructors above;
    /// `None` for another number.
    ///
    /// # Errors
    /// As the constructor of that kind.
    pub fn of_type(kind: u32, p: [Vec3<T>; 3]) -> Option<Result<Self, ArcError>> {
        let build = match kind {
            1 => Self::through,
            2 => Self::about,
            3 => Self::tangent_at_start,
            4 => Self::tangent_at_end,
            5 => Self::semicircle,
            6 => Self::circle,
            _ => return None,
        };
        Some(build(p[0], p[1], p[2]))
    }

    /// The chord form: the arc bulges to the side of `side`, and half its angle has the sine
    /// |side x chord| and the cosine `cosine` up to a common factor.
    fn bulging(from: Vec3<T>, to: Vec3<T>, side: Vec3<T>, cosine: T) -> Self {
        let chord = to - from;
        let normal = side.cross(chord);
        let sine_sq = normal.norm_sq();
        // Rounding of collinear points must not turn the line into a circle of huge radius.
        let epsilon = (8.0 * f64::EPSILON).powi(2) * side.norm_sq().re() * chord.norm_sq().re();
        if cosine.re() <= 0.0 && sine_sq.re() <= epsilon {
            return Self::chord(from, to, Vec3::zero(), T::zero());
        }
        let rate = angle_over_sine(sine_sq, cosine);
        Self::chord(from, to, chord.cross(normal) * rate, rate * rate * sine_sq)
    }

    fn chord(from: Vec3<T>, to: Vec3<T>, bulge: Vec3<T>, half_sq: T) -> Self {
        let whole = sinc_of_sq(half_sq);
        Self { form: ArcForm::Chord { from, to, bulge, half_sq, whole } }
    }

    fn quarters(
        centre: Vec3<T>,
        from: Vec3<T>,
        side: Vec3<T>,
        quarters: f64,
    ) -> Result<Self, ArcError> {
        let (spoke, beside) = (from - centre, side - centre);
        let side = spoke.cross(beside).cross(spoke);
        let epsilon = 8.0 * f64::EPSILON * spoke.norm_sq().re() * beside.norm().re();
        if side.norm().re() <= epsilon {
            return Err(ArcError::Collinear);
        }
        let side = side * (spoke.norm() / side.norm());
        Ok(Self { form: ArcForm::Quarters { centre, spoke, side, quarters } })
    }

    /// The position at a parameter that may be a jet.
    #[inline]
    pub fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let rest = -t + 1.0;
        match self.form {
            ArcForm::Chord { from, to, bulge, half_sq, whole } => {
                // A quotient, so that it is exactly 1 at the end.
                let rise = t * sinc_of_sq((t * t).scaled(half_sq));
                let rise = rise / J::fixed(whole);
                let left = (rest * rest).scaled(half_sq);
                let along = rise * cos_of_sq(left);
                let (back, up) = (-along + 1.0, rise * rest * sinc_of_sq(left));
                from.map(|x| back.scaled(x))
                    + to.map(|x| along.scaled(x))
                    + bulge.map(|x| up.scaled(x))
            }
            ArcForm::Sector { centre, spoke, turn, angle_sq } => {
                let q = (t * t).scaled(angle_sq);
                let (c, s) = (cos_of_sq(q), t * sinc_of_sq(q));
                // Less than the spoke by 1 - c, so that the start is exact.
                let lost = c - 1.0;
                (centre + spoke).map(J::fixed)
                    + spoke.map(|x| lost.scaled(x))
                    + turn.map(|x| s.scaled(x))
            }
            ArcForm::Quarters { centre, spoke, side, quarters } => {
                let turns = t * quarters;
                let whole = turns.re().round();
                let angle = (turns - whole) * FRAC_PI_2;
                let (c, s) = (angle.cos(), angle.sin());
                let (c, s) = match whole.rem_euclid(4.0) as u8 {
                    0 => (c, s),
                    1 => (-s, c),
                    2 => (-c, -s),
                    _ => (s, -c),
                };
                centre.map(J::fixed) + spoke.map(|x| c.scaled(x)) + side.map(|x| s.scaled(x))
            }
        }
    }

    /// The angle of the arc, 0 for a straight line.
    pub fn angle(&self) -> T {
        let root = |q: T| if q.re() > 0.0 { q.sqrt() } else { T::zero() };
        match self.form {
            ArcForm::Chord { half_sq, .. } => root(half_sq) * 2.0,
            ArcForm::Sector { angle_sq, .. } => root(angle_sq),
            ArcForm::Quarters { quarters, .. } => T::from(quarters * FRAC_PI_2),
        }
    }
}

/// The angle of a direction (cosine, sine) up to a common factor, divided by that sine: smooth
/// where the sine vanishes and the cosine is positive.
fn angle_over_sine<T: Real>(sine_sq: T, cosine: T) -> T {
    if cosine.re() > 0.0 {
        return atanc_of_sq(sine_sq / (cosine * cosine)) / cosine;
    }
    if sine_sq.re() == 0.0 {
        return T::zero();
    }
    let sine = sine_sq.sqrt();
    (-(cosine / sine).atan() + PI / 2.0) / sine
}

fn finite<T: Real>(points: [Vec3<T>; 3]) -> Result<(), ArcError> {
    match points.iter().position(|p| !p.is_finite()) {
        Some(index) => Err(ArcError::NotFinite { index }),
        None => Ok(()),
    }
}

impl<T: Real> Curve<T> for CircularArc<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        curve_jet_of!(self, Self::at, t, order)
    }

    fn rational(&self) -> Rational<1> {
        Rational::paced([Pace::Angle(self.angle().re())])
    }

    moldloft_num::curve_facts!(smooth, open);
    moldloft_num::curve_one_by_one!(T);
}
