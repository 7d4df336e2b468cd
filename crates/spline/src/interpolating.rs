//! Interpolating splines: twice differentiable piecewise cubics through points, open or closed, with end conditions.

use crate::{Parametrization, PiecewiseCubic};
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use smallvec::{SmallVec, smallvec};
use std::fmt;

/// Reason why there is no spline through these points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InterpolationError {
    /// Too few points.
    TooFew {
        /// The minimum for this kind of spline.
        expected: usize,
        /// The number given.
        actual: usize,
    },
    /// Two neighbouring points or their knots coincide, so there is no parameter range between
    /// them.
    Coincident {
        /// Index of the first of the two, from 0.
        first: usize,
        /// Index of the second.
        second: usize,
    },
    /// A point or knot is NaN or infinite.
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// The first and last point of a periodic spline differ.
    NotClosed {
        /// Their distance.
        gap: f64,
    },
    /// The number of knots differs from the number of points.
    Knots {
        /// The number of points.
        expected: usize,
        /// The number of knots.
        actual: usize,
    },
    /// There is no interpolating spline of this type: 1 is a polyline, 3 cubic.
    Type {
        /// The given type.
        actual: usize,
    },
}

impl fmt::Display for InterpolationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFew { expected, actual } => {
                write!(f, "expected at least {expected} points, found {actual}")
            }
            Self::Coincident { first, second } => {
                write!(f, "points {} and {} coincide", first + 1, second + 1)
            }
            Self::NotFinite { index } => write!(f, "point {} is not finite", index + 1),
            Self::NotClosed { gap } => {
                write!(f, "the first and last point of a closed spline are {gap} apart")
            }
            Self::Knots { expected, actual } => {
                write!(f, "expected {expected} knots, one per point, found {actual}")
            }
            Self::Type { actual } => {
                write!(f, "expected spline type 1 (polyline) or 3 (cubic), found {actual}")
            }
        }
    }
}

impl std::error::Error for InterpolationError {}

/// Condition at an end of an open interpolating spline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum End<T> {
    /// The first two pieces are one polynomial.
    #[default]
    NotAKnot,
    /// The second derivative vanishes.
    Natural,
    /// The slope is that of the parabola through the three nearest points.
    Bessel,
    /// The end piece is a parabola.
    Quadratic,
    /// The slope dC/dt is given.
    Clamped(Vec3<T>),
}

/// The end conditions of an interpolating spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends<T> {
    /// Conditions at the start and at the end.
    Open(End<T>, End<T>),
    /// The last point equals the first, with the same slope and curvature.
    Periodic,
}

impl<T> Default for Ends<T> {
    fn default() -> Self {
        Self::Open(End::NotAKnot, End::NotAKnot)
    }
}

/// The interpolating ("C-") spline: a twice differentiable piecewise cubic through points, with
/// knots at the cumulative chord lengths divided by their total.
///
/// With the default ends two points give a line, three a parabola and four one cubic. The knots are
/// scalars and move with the points, so derivatives by the points include that motion. On [0, 1];
/// outside, the end pieces continue.
///
/// # Example
/// ```
/// use moldloft_num::{Curve, Order, Vec3};
/// use moldloft_spline::InterpolatingSpline;
/// let points = [[0., 0.], [1., 1.], [2., 0.]].map(|[x, y]| Vec3::of(x, y, 0.));
/// let spline = InterpolatingSpline::<f64>::through(&points).unwrap();
/// assert_eq!(spline.knots(), [0.0, 0.5, 1.0]);
/// assert_eq!(spline.jet(0.25, Order::Zero)[0], Vec3::of(0.5, 0.75, 0.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct InterpolatingSpline<T: Real> {
    curve: PiecewiseCubic<T>,
    breaks: SmallVec<[f64; 2]>,
}

/// Short lists of scalars: those of lofts through a few masters stay on the stack.
type Short<X> = SmallVec<[X; 5]>;

impl<T: Real> InterpolatingSpline<T> {
    /// The cubic spline with chord-length knots and not-a-knot ends.
    ///
    /// # Errors
    /// [`InterpolationError`] for fewer than two, coincident neighbouring or not finite points.
    pub fn through(points: &[Vec3<T>]) -> Result<Self, InterpolationError> {
        Self::with_ends(points, Ends::default())
    }

    /// The cubic spline with chord-length knots and these ends.
    ///
    /// # Errors
    /// As [`InterpolatingSpline::through`]; [`InterpolationError::NotClosed`] for periodic ends.
    pub fn with_ends(points: &[Vec3<T>], ends: Ends<T>) -> Result<Self, InterpolationError> {
        Self::with_knots(&Parametrization::Chord.knots(points)?, points, ends)
    }

    /// The spline of a C-curve's type: 1 the polyline, 3 the cubic with not-a-knot ends. A type
    /// larger than the number of points less one is reduced to it, so that 2 is allowed for three
    /// points.
    ///
    /// # Errors
    /// [`InterpolationError::Type`] for another type, and as [`InterpolatingSpline::through`].
    pub fn of_type(kind: usize, points: &[Vec3<T>]) -> Result<Self, InterpolationError> {
        match kind {
            1 => Self::polyline(points),
            2 if points.len() <= 3 => Self::through(points),
            3 => Self::through(points),
            actual => Err(InterpolationError::Type { actual }),
        }
    }

    /// The polyline with chord-length knots.
    ///
    /// # Errors
    /// As [`InterpolatingSpline::through`].
    pub fn polyline(points: &[Vec3<T>]) -> Result<Self, InterpolationError> {
        let knots = Parametrization::Chord.knots(points)?;
        let pieces = knots
            .windows(2)
            .zip(points.windows(2))
            .map(|(s, p)| [p[0], (p[1] - p[0]) / (s[1] - s[0]), Vec3::zero(), Vec3::zero()]);
        let curve = PiecewiseCubic::closed_off(&knots, pieces.collect(), points[points.len() - 1]);
        let breaks = knots[1..knots.len() - 1].iter().map(|k| k.re()).collect();
        Ok(Self { curve, breaks })
    }

    /// The cubic spline with given ascending `knots`.
    ///
    /// # Errors
    /// As [`InterpolatingSpline::with_ends`]; [`InterpolationError::Knots`] when there are not as
    /// many knots as points.
    pub fn with_knots(
        knots: &[T],
        points: &[Vec3<T>],
        ends: Ends<T>,
    ) -> Result<Self, InterpolationError> {
        let n = points.len();
        let expected = if ends == Ends::Periodic { 4 } else { 2 };
        if n < expected {
            return Err(InterpolationError::TooFew { expected, actual: n });
        }
        if knots.len() != n {
            return Err(InterpolationError::Knots { expected: n, actual: knots.len() });
        }
        let sound = |k: usize| points[k].is_finite() && knots[k].is_finite();
        if let Some(index) = (0..n).find(|&k| !sound(k)) {
            return Err(InterpolationError::NotFinite { index });
        }
        let mut gaps: Short<T> = SmallVec::with_capacity(n - 1);
        for k in 0..n - 1 {
            let gap = knots[k + 1] - knots[k];
            if gap.re() <= 0.0 {
                return Err(InterpolationError::Coincident { first: k, second: k + 1 });
            }
            gaps.push(gap);
        }
        if ends == Ends::Periodic {
            let gap = points[0].re().distance(points[n - 1].re());
            let size = points.iter().fold(0.0f64, |m, p| m.max(p.re().norm()));
            if gap > 4.0 * f64::EPSILON * size {
                return Err(InterpolationError::NotClosed { gap });
            }
        }
        let inner = |from: usize, to: usize| knots[from..to].iter().map(|k| k.re()).collect();
        let (curve, breaks) = match ends {
            Ends::Open(a, b) if n == 2 => (two_points(knots, points, a, b), SmallVec::new()),
            Ends::Open(a, b) if n == 3 && parabolic(a) && parabolic(b) => {
                (parabola(knots, points, &gaps), SmallVec::new())
            }
            Ends::Open(a, b) => {
                let slopes = open_slopes(&gaps, points, a, b);
                let active_from = 1 + usize::from(a == End::NotAKnot);
                let active_to = n - 1 - usize::from(b == End::NotAKnot);
                let breaks = inner(active_from.min(active_to), active_to);
                (PiecewiseCubic::hermite(knots, points, &slopes), breaks)
            }
            Ends::Periodic => {
                let slopes = periodic_slopes(&gaps, points);
                (PiecewiseCubic::hermite(knots, points, &slopes), inner(1, n - 1))
            }
        };
        Ok(Self { curve, breaks })
    }

    /// The knots, one per point.
    pub fn knots(&self) -> &[T] {
        self.curve.knots()
    }

    /// The polynomials.
    pub fn pieces(&self) -> &PiecewiseCubic<T> {
        &self.curve
    }
}

impl<T: Real> Curve<T> for InterpolatingSpline<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.jet(t, order)
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.eval_many(ts, out);
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.to_vec()
    }

    fn joints(&self) -> Vec<f64> {
        let knots = self.curve.knots();
        knots[1..knots.len() - 1].iter().map(|k| k.re()).collect()
    }

    moldloft_num::curve_facts!(kinks_at_breaks, open, not_rational);
}

fn parabolic<T>(end: End<T>) -> bool {
    matches!(end, End::NotAKnot | End::Bessel | End::Quadratic)
}

/// A line, or with given end slopes the polynomial of the lowest degree.
fn two_points<T: Real>(
    knots: &[T],
    points: &[Vec3<T>],
    start: End<T>,
    end: End<T>,
) -> PiecewiseCubic<T> {
    let chord = (points[1] - points[0]) / (knots[1] - knots[0]);
    let opposite = |slope: Vec3<T>| chord.map(|x| x * 2.0) - slope;
    let slopes = match (start, end) {
        (End::Clamped(a), End::Clamped(b)) => [a, b],
        (End::Clamped(a), _) => [a, opposite(a)],
        (_, End::Clamped(b)) => [opposite(b), b],
        _ => {
            let line = smallvec![[points[0], chord, Vec3::zero(), Vec3::zero()]];
            return PiecewiseCubic::closed_off(knots, line, points[1]);
        }
    };
    PiecewiseCubic::hermite(knots, points, &slopes)
}

/// The parabola through three points, by divided differences.
fn parabola<T: Real>(knots: &[T], points: &[Vec3<T>], gaps: &[T]) -> PiecewiseCubic<T> {
    let before = (points[1] - points[0]) / gaps[0];
    let after = (points[2] - points[1]) / gaps[1];
    let bend = (after - before) / (gaps[0] + gaps[1]);
    let pieces = smallvec![
        [points[0], before - bend * gaps[0], bend, Vec3::zero()],
        [points[1], before + bend * gaps[0], bend, Vec3::zero()]
    ];
    PiecewiseCubic::closed_off(knots, pieces, points[2])
}

/// The slopes at the knots of an open cubic spline: continuity of the second derivative at inner
/// knots (de Boor 1978, ch. IV eq. 4), one condition at each end, solved as a tridiagonal system
/// in O(n). Rows are written (below, diagonal, above | right-hand side).
fn open_slopes<T: Real>(h: &[T], points: &[Vec3<T>], start: End<T>, end: End<T>) -> Short<Vec3<T>> {
    let n = points.len();
    let chord: Short<Vec3<T>> = (0..n - 1).map(|k| (points[k + 1] - points[k]) / h[k]).collect();
    // The condition at the far end has the same form, with the order of intervals and chords
    // reversed.
    let (m, p) = (h.len() - 1, h.len() - 2);
    let (d0, e0, r0) = end_row(start, [h[0], h[1]], [chord[0], chord[1]]);
    let (d1, e1, r1) = end_row(end, [h[m], h[p]], [chord[m], chord[p]]);
    let (mut above, mut slopes): (Short<T>, Short<Vec3<T>>) =
        (SmallVec::with_capacity(n), SmallVec::with_capacity(n));
    let first = T::one() / d0;
    above.push(e0 * first);
    slopes.push(r0 * first);
    for k in 1..n {
        let (below, diagonal, over, right) = if k < n - 1 {
            let right = (chord[k - 1] * h[k] + chord[k] * h[k - 1]).map(|x| x * 3.0);
            (h[k], (h[k - 1] + h[k]) * 2.0, h[k - 1], right)
        } else {
            (e1, d1, T::zero(), r1)
        };
        let pivot = T::one() / (diagonal - below * above[k - 1]);
        above.push(over * pivot);
        slopes.push((right - slopes[k - 1] * below) * pivot);
    }
    for k in (0..n - 1).rev() {
        let next = slopes[k + 1] * above[k];
        slopes[k] -= next;
    }
    slopes
}

/// The equation `diagonal m0 + beside m1 = right` of an end; `h` and `chord` are the widths and
/// mean slopes of the two intervals nearest to it.
fn end_row<T: Real>(end: End<T>, h: [T; 2], chord: [Vec3<T>; 2]) -> (T, T, Vec3<T>) {
    let (one, zero) = (T::one(), T::zero());
    let sum = h[0] + h[1];
    match end {
        // de Boor 1978, ch. IV eq. 11: the third derivative is continuous at the next knot.
        End::NotAKnot => {
            let near = chord[0] * ((h[0] + sum * 2.0) * h[1]);
            let far = chord[1] * (h[0] * h[0]);
            (h[1], sum, (near + far) / sum)
        }
        End::Natural => (one * 2.0, one, chord[0].map(|x| x * 3.0)),
        End::Bessel => {
            let slope = chord[0] + (chord[0] - chord[1]) * (h[0] / sum);
            (one, zero, slope)
        }
        End::Quadratic => (one, one, chord[0].map(|x| x * 2.0)),
        End::Clamped(slope) => (one, zero, slope),
    }
}

/// The slopes of a periodic cubic spline: the cyclic tridiagonal system is split into two plain
/// ones by Sherman and Morrison's formula (Press et al. 2007, section 2.7.2).
fn periodic_slopes<T: Real>(h: &[T], points: &[Vec3<T>]) -> Short<Vec3<T>> {
    let n = h.len();
    let before = |k: usize| if k == 0 { n - 1 } else { k - 1 };
    let chord: Short<Vec3<T>> = (0..n).map(|k| (points[k + 1] - points[k]) / h[k]).collect();
    let diagonal = |k: usize| (h[before(k)] + h[k]) * 2.0;
    // Corner entries: row 0, column n - 1 is h[0]; row n - 1, column 0 is h[n - 2].
    let (upper, lower) = (h[0], h[n - 2]);
    let gamma = -diagonal(0);
    let mut above: Short<T> = SmallVec::with_capacity(n);
    let mut slopes: Short<Vec3<T>> = SmallVec::with_capacity(n);
    let mut helper: Short<T> = SmallVec::with_capacity(n);
    for k in 0..n {
        let mut d = diagonal(k);
        if k == 0 {
            d -= gamma;
        }
        if k == n - 1 {
            d -= upper * lower / gamma;
        }
        let right = (chord[before(k)] * h[k] + chord[k] * h[before(k)]).map(|x| x * 3.0);
        let extra = match k {
            0 => gamma,
            _ if k == n - 1 => lower,
            _ => T::zero(),
        };
        if k == 0 {
            above.push(h[before(0)] / d);
            slopes.push(right / d);
            helper.push(extra / d);
        } else {
            let pivot = T::one() / (d - h[k] * above[k - 1]);
            above.push(h[before(k)] * pivot);
            slopes.push((right - slopes[k - 1] * h[k]) * pivot);
            helper.push((extra - helper[k - 1] * h[k]) * pivot);
        }
    }
    for k in (0..n - 1).rev() {
        let (slope, help) = (slopes[k + 1] * above[k], helper[k + 1] * above[k]);
        slopes[k] -= slope;
        helper[k] -= help;
    }
    let ratio = upper / gamma;
    let scale = T::one() / (helper[0] + helper[n - 1] * ratio + 1.0);
    let share = (slopes[0] + slopes[n - 1] * ratio) * scale;
    for k in 0..n {
        slopes[k] -= share * helper[k];
    }
    slopes.push(slopes[0]);
    slopes
}
