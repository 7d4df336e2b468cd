//! Curves over the points of an object: arc, circle, quadratic, cubic, elliptical arc, ellipse, Bézier curve.
//!
//! The 1983 products of matrices (align, rotate by 5°, align back) drift and, for the ellipse, lack a
//! scale; here every curve has its closed form. The printed matrix of the quadratic has a wrong sign:
//! the third entry of its second row must be -1, or the curve misses its last point.

use crate::{DimensionExpr, PointId};
use moldloft_num::GAUSS_8_UNIT;
use moldloft_num::{Real, Vec3};
use std::collections::BTreeMap;

/// The kinds, the first six numbered as in 1983.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// 1: circular arc tangent to two lines with a common end.
    Arc,
    /// 2: full circle tangent to the two lines.
    Circle,
    /// 3: parametric quadratic through three points.
    Quadratic,
    /// 4: Overhauser cubics through a chain of points, from the second to the last but one.
    Cubic,
    /// 5: elliptical arc tangent to two lines at given distances from their common end.
    EllipticalArc,
    /// 6: the full ellipse.
    Ellipse,
    /// A parabola, a conic or a cubic from the end of one line to that of another, tangent to both.
    Bezier,
}

impl CurveKind {
    /// The command word, with `ARC` after it for the elliptical arc.
    pub fn word(self) -> &'static str {
        match self {
            CurveKind::Arc => "ARC",
            CurveKind::Circle => "CIRCLE",
            CurveKind::Quadratic => "QUADRATIC",
            CurveKind::Cubic => "CUBIC",
            CurveKind::EllipticalArc => "ELLIPSE ARC",
            CurveKind::Ellipse => "ELLIPSE",
            CurveKind::Bezier => "BEZIER",
        }
    }

    /// True if it rounds the corner of two lines.
    pub fn at_corner(self) -> bool {
        !matches!(self, CurveKind::Quadratic | CurveKind::Cubic)
    }
}

/// A curve of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchCurve {
    /// As the user wrote it.
    pub name: String,
    /// Kind.
    pub kind: CurveKind,
    /// Its defining points: for a corner, the corner between the ends of its lines.
    pub points: Vec<PointId>,
    /// Radius of an arc or circle.
    pub radius: Option<DimensionExpr>,
    /// Distances along the two lines of an ellipse.
    pub semi: Option<[DimensionExpr; 2]>,
    /// Of a Bézier curve: none for a parabola, the weight of the corner for a conic, or for a cubic the distances of
    /// its control points from the ends as fractions of the lines.
    pub shape: Vec<DimensionExpr>,
    /// Number of chords for drawing; `None` to derive it from the tolerance.
    pub steps: Option<u32>,
    /// True if it replaces lines in the solid.
    pub replaces: bool,
    /// Cubic: knots by the square root of the chord instead of uniform.
    pub centripetal: bool,
}

impl SketchCurve {
    /// All its numbers.
    pub fn sizes(&self) -> impl Iterator<Item = &DimensionExpr> {
        self.radius.iter().chain(self.semi.iter().flatten()).chain(&self.shape)
    }

    /// All its numbers, to change.
    pub fn sizes_mut(&mut self) -> impl Iterator<Item = &mut DimensionExpr> {
        self.radius.iter_mut().chain(self.semi.iter_mut().flatten()).chain(&mut self.shape)
    }
}

/// A smooth piece with parameter s in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SmoothPiece<T> {
    /// `centre + a cos(s sweep) + b sin(s sweep)`
    Conic {
        /// Centre.
        centre: Vec3<T>,
        /// Vector from the centre to the start.
        a: Vec3<T>,
        /// Conjugate to `a`.
        b: Vec3<T>,
        /// Angle in radians.
        sweep: T,
    },
    /// A cubic in Bézier form.
    Cubic([Vec3<T>; 4]),
}

impl<T: Real> SmoothPiece<T> {
    /// The straight piece.
    pub fn straight(p: Vec3<T>, q: Vec3<T>) -> SmoothPiece<T> {
        let third = T::from(1.0 / 3.0);
        SmoothPiece::Cubic([p, p.lerp(q, third), q.lerp(p, third), q])
    }

    /// The point at `s`.
    pub fn at(&self, s: T) -> Vec3<T> {
        match *self {
            SmoothPiece::Conic { centre, a, b, sweep } => {
                centre + a * (s * sweep).cos() + b * (s * sweep).sin()
            }
            SmoothPiece::Cubic([p, q, r, e]) => {
                let w = -s + 1.0;
                p * (w * w * w) + q * (w * w * s * 3.0) + r * (w * s * s * 3.0) + e * (s * s * s)
            }
        }
    }

    /// The derivative by `s`.
    pub fn velocity(&self, s: T) -> Vec3<T> {
        match *self {
            SmoothPiece::Conic { a, b, sweep, .. } => {
                (b * (s * sweep).cos() - a * (s * sweep).sin()) * sweep
            }
            SmoothPiece::Cubic([p, q, r, e]) => {
                let w = -s + 1.0;
                ((q - p) * (w * w) + (r - q) * (w * s * 2.0) + (e - r) * (s * s)) * T::from(3.0)
            }
        }
    }

    /// The same piece from its other end.
    #[must_use]
    pub fn reversed(&self) -> SmoothPiece<T> {
        match *self {
            SmoothPiece::Conic { centre, a, b, sweep } => {
                let (c, s) = (sweep.cos(), sweep.sin());
                SmoothPiece::Conic { centre, a: a * c + b * s, b: a * s - b * c, sweep }
            }
            SmoothPiece::Cubic([p, q, r, e]) => SmoothPiece::Cubic([e, r, q, p]),
        }
    }

    /// The image by an affine map.
    #[must_use]
    pub(crate) fn mapped(&self, map: &dyn Fn(Vec3<T>) -> Vec3<T>) -> SmoothPiece<T> {
        match *self {
            SmoothPiece::Conic { centre, a, b, sweep } => {
                let c = map(centre);
                SmoothPiece::Conic {
                    centre: c,
                    a: map(centre + a) - c,
                    b: map(centre + b) - c,
                    sweep,
                }
            }
            SmoothPiece::Cubic(points) => SmoothPiece::Cubic(points.map(map)),
        }
    }

    /// Its length, by Gauss's rule (to rounding for arcs, to about nine digits for cubics).
    pub fn length(&self) -> T {
        let mut sum = T::zero();
        for k in 0..4 {
            for (x, w) in GAUSS_8_UNIT {
                let s = (k as f64 + x) / 4.0;
                sum += self.velocity(T::from(s)).norm() * (w / 4.0);
            }
        }
        sum
    }

    /// Number of chords within `tolerance` of the curve.
    pub fn chords(&self, tolerance: f64) -> usize {
        // A chord over ds misses by |p''| ds² / 8.
        let bend = match self {
            SmoothPiece::Conic { a, b, sweep, .. } => {
                let radius = a.re().norm().max(b.re().norm());
                radius * sweep.re() * sweep.re()
            }
            SmoothPiece::Cubic([p, q, r, e]) => {
                let (p, q, r, e) = (p.re(), q.re(), r.re(), e.re());
                6.0 * (p - q * 2.0 + r).norm().max((q - r * 2.0 + e).norm())
            }
        };
        let n = Real::sqrt(bend / (8.0 * tolerance.max(f64::MIN_POSITIVE))).ceil();
        if n.is_finite() { (n as usize).clamp(1, 720) } else { 1 }
    }
}

/// Reason why a curve cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveFault {
    /// A size has no value.
    NoValue {
        /// Missing name.
        reads: String,
    },
    /// A size is not positive.
    NotPositive {
        /// The size.
        value: f64,
    },
    /// 300: the lines of the corner are parallel, or two of its points coincide.
    Degenerate,
    /// 310: the tangent point is beyond the end of a line.
    TooLarge {
        /// The greatest radius or distance that fits.
        largest: f64,
    },
    /// The weight of a conic is not below 1.
    NoEllipse {
        /// The weight.
        value: f64,
    },
    /// A point is not determined yet.
    Undetermined,
}

/// A curve in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced<T> {
    /// Its pieces in order, joined end to start.
    pub pieces: Vec<SmoothPiece<T>>,
    /// For a corner: the tangent points on the first and on the second line.
    pub tangents: Option<[Vec3<T>; 2]>,
    /// For a conic: its centre.
    pub centre: Option<Vec3<T>>,
}

/// Traces a curve; `at` gives positions, `value` evaluates names.
///
/// # Errors
/// A fault of its sizes or points.
pub fn trace<T: Real>(
    curve: &SketchCurve,
    at: &dyn Fn(PointId) -> Option<Vec3<T>>,
    values: &BTreeMap<String, T>,
) -> Result<Traced<T>, CurveFault> {
    let p: Vec<Vec3<T>> = (curve.points.iter())
        .map(|&id| at(id))
        .collect::<Option<_>>()
        .ok_or(CurveFault::Undetermined)?;
    let size = |e: &DimensionExpr| -> Result<T, CurveFault> {
        let value = e.eval(&|n| values.get(n).copied());
        let value = value.map_err(|no| CurveFault::NoValue { reads: no.name })?;
        if value.re() > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            Err(CurveFault::NotPositive { value: value.re() })
        }
    };
    match (curve.kind, p.as_slice()) {
        (CurveKind::Quadratic, &[a, m, b]) => {
            // p(t) = (2t²-3t+1) P1 + (-4t²+4t) P2 + (2t²-t) P3, as a Bézier curve, cut at P2.
            let q = m * T::from(2.0) - (a + b) * T::from(0.5);
            let two = |x: Vec3<T>, y: Vec3<T>| x.lerp(y, T::from(0.5));
            let half = |s: Vec3<T>, c: Vec3<T>, e: Vec3<T>| {
                let third = T::from(2.0 / 3.0);
                SmoothPiece::Cubic([s, s.lerp(c, third), e.lerp(c, third), e])
            };
            let pieces = vec![half(a, two(a, q), m), half(m, two(q, b), b)];
            Ok(Traced { pieces, tangents: None, centre: None })
        }
        (CurveKind::Cubic, p) if p.len() >= 4 => {
            let piece = |w: &[Vec3<T>]| overhauser([w[0], w[1], w[2], w[3]], curve.centripetal);
            let pieces = p.windows(4).map(piece).collect::<Option<Vec<_>>>();
            let pieces = pieces.ok_or(CurveFault::Degenerate)?;
            Ok(Traced { pieces, tangents: None, centre: None })
        }
        (CurveKind::Bezier, &[first, corner, second]) => {
            let shape = curve.shape.iter().map(size).collect::<Result<Vec<T>, _>>()?;
            bezier([first, corner, second], &shape)
        }
        (_, &[first, corner, second]) => {
            let (to_a, to_b) = (first - corner, second - corner);
            let (long_a, long_b) = (to_a.norm(), to_b.norm());
            let unit = |v: Vec3<T>| v.normalized().ok_or(CurveFault::Degenerate);
            let (a, b) = (unit(to_a)?, unit(to_b)?);
            let sine = a.cross(b).norm();
            if sine.re() < 1e-9 {
                return Err(CurveFault::Degenerate);
            }
            let phi = sine.atan2(a.dot(b));
            if matches!(curve.kind, CurveKind::Arc | CurveKind::Circle) {
                let half = phi * 0.5;
                let radius = match &curve.radius {
                    Some(e) => size(e)?,
                    None => long_a * 0.5,
                };
                let reach = long_a.min(long_b).re();
                let d = radius / half.tan();
                // Short arcs of large radii, as drawings have them, reach to their ends only within rounding.
                if d.re() > reach * (1.0 + 1e-9) {
                    return Err(CurveFault::TooLarge { largest: reach * Real::tan(half.re()) });
                }
                let bisector = unit(a + b)?;
                let centre = corner + bisector * (radius / half.sin());
                let (t1, t2) = (corner + a * d, corner + b * d);
                let start = t1 - centre;
                // Perpendicular to the start within the plane, towards the second tangent point.
                let side =
                    unit((t2 - centre) - start * (start.dot(t2 - centre) / start.norm_sq()))?;
                let full = curve.kind == CurveKind::Circle;
                let sweep = if full {
                    T::from(2.0 * std::f64::consts::PI)
                } else {
                    -phi + std::f64::consts::PI
                };
                let pieces = vec![SmoothPiece::Conic { centre, a: start, b: side * radius, sweep }];
                Ok(Traced { pieces, tangents: Some([t1, t2]), centre: Some(centre) })
            } else {
                let [m, n] = match &curve.semi {
                    Some([m, n]) => [size(m)?, size(n)?],
                    None => [long_a * 0.5, long_b * 0.5],
                };
                for (length, line) in [(m, long_a), (n, long_b)] {
                    if length.re() > line.re() * (1.0 + 1e-12) {
                        return Err(CurveFault::TooLarge { largest: line.re() });
                    }
                }
                // p(θ) = C - m a sin θ - n b cos θ, a quarter from P2 + m a to P2 + n b.
                let centre = corner + a * m + b * n;
                let turns = if curve.kind == CurveKind::Ellipse { 2.0 } else { 0.5 };
                let sweep = T::from(turns * std::f64::consts::PI);
                let pieces = vec![SmoothPiece::Conic { centre, a: -(b * n), b: -(a * m), sweep }];
                let tangents = Some([corner + a * m, corner + b * n]);
                Ok(Traced { pieces, tangents, centre: Some(centre) })
            }
        }
        _ => Err(CurveFault::Degenerate),
    }
}

/// The Bézier curve in a corner from one end to the other, of the shape of [`SketchCurve::shape`].
fn bezier<T: Real>(
    [first, corner, second]: [Vec3<T>; 3],
    shape: &[T],
) -> Result<Traced<T>, CurveFault> {
    let (to_a, to_b) = (first - corner, second - corner);
    if to_a.cross(to_b).norm().re() <= 1e-9 * to_a.norm().re() * to_b.norm().re() {
        return Err(CurveFault::Degenerate);
    }
    let tangents = Some([first, second]);
    if let &[weight] = shape {
        if weight.re() >= 1.0 {
            return Err(CurveFault::NoEllipse { value: weight.re() });
        }
        // The affine image of an arc of the unit circle, of the angle whose half has the cosine of the weight.
        let square = -(weight * weight) + 1.0;
        let sine = square.sqrt();
        let centre = corner + (to_a + to_b) / (square * 2.0);
        let (a, b) = (first - centre, -(to_a * (weight / sine)));
        let sweep = sine.atan2(weight) * 2.0;
        let pieces = vec![SmoothPiece::Conic { centre, a, b, sweep }];
        return Ok(Traced { pieces, tangents, centre: Some(centre) });
    }
    let handles = match *shape {
        [x, y] => [x, y],
        _ => [T::from(2.0 / 3.0); 2],
    };
    if handles.iter().any(|h| h.re() > 1.0) {
        return Err(CurveFault::TooLarge { largest: 1.0 });
    }
    let [p, q] = [first.lerp(corner, handles[0]), second.lerp(corner, handles[1])];
    let pieces = vec![SmoothPiece::Cubic([first, p, q, second])];
    Ok(Traced { pieces, tangents, centre: None })
}

/// The cubic between the second and third of four points with tangents (P3 - P1)/2 and (P4 - P2)/2
/// (Brewer and Anderson, SIGGRAPH 1977), in Bézier form; with centripetal knots the non-uniform
/// Catmull-Rom form of it. `None` when neighbouring points coincide (centripetal only).
fn overhauser<T: Real>(p: [Vec3<T>; 4], centripetal: bool) -> Option<SmoothPiece<T>> {
    let third = T::from(1.0 / 3.0);
    let (m1, m2) = if centripetal {
        let [d1, d2, d3] = [0, 1, 2].map(|k| p[k].distance(p[k + 1]).sqrt());
        if [d1, d2, d3].iter().any(|d| d.re() <= 0.0) {
            return None;
        }
        let slope = |a: usize, da: T, db: T| {
            (p[a + 1] - p[a]) / da - (p[a + 2] - p[a]) / (da + db) + (p[a + 2] - p[a + 1]) / db
        };
        (slope(0, d1, d2) * d2, slope(1, d2, d3) * d2)
    } else {
        let half = T::from(0.5);
        ((p[2] - p[0]) * half, (p[3] - p[1]) * half)
    };
    Some(SmoothPiece::Cubic([p[1], p[1] + m1 * third, p[2] - m2 * third, p[2]]))
}

/// The semi-axes of an ellipse with conjugate half-diameters `a` and `b`, longer first: the
/// singular values of [a b].
pub fn semi_axes(a: Vec3, b: Vec3) -> [f64; 2] {
    let (trace, area) = (a.norm_sq() + b.norm_sq(), a.cross(b).norm());
    let (sum, difference) =
        (Real::sqrt(trace + 2.0 * area), Real::sqrt((trace - 2.0 * area).max(0.0)));
    [(sum + difference) / 2.0, (sum - difference) / 2.0]
}
