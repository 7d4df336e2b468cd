//! Linear conditions that an optimum keeps: points, tangents, areas, volumes, seams.

use crate::{FairError, Space};
use moldloft_num::{Order, Real, Vec3};

/// A linear condition on the control points: the sum of factor . point over the entries is `value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Control points and factors.
    pub entries: Vec<(usize, Vec3<f64>)>,
    /// Required value of the sum.
    pub value: f64,
}

pub(crate) const AXES: [Vec3<f64>; 3] = [
    Vec3 { x: 1.0, y: 0.0, z: 0.0 },
    Vec3 { x: 0.0, y: 1.0, z: 0.0 },
    Vec3 { x: 0.0, y: 0.0, z: 1.0 },
];

impl Condition {
    /// The left side of the equation at `points`.
    pub fn at(&self, points: &[Vec3<f64>]) -> f64 {
        self.entries.iter().map(|(i, f)| f.dot(points[*i])).sum()
    }

    /// A derivative (order 0 to 2) of the polynomial curve at `t` takes a value: three conditions.
    pub fn derivative(space: &Space, t: f64, order: Order, value: Vec3<f64>) -> Vec<Self> {
        let (k, t) = space.locate(t);
        let basis = space.basis(k, t);
        let row = &basis.rows[order as usize];
        let entry = |axis: Vec3<f64>| -> Vec<_> {
            space.columns(k).zip(row.iter()).map(|(c, &b)| (c, axis * b)).collect()
        };
        AXES.iter().map(|&a| Self { entries: entry(a), value: a.dot(value) }).collect()
    }

    /// The curve passes through a point at `t`.
    pub fn point(space: &Space, t: f64, through: Vec3<f64>) -> Vec<Self> {
        Self::derivative(space, t, Order::Zero, through)
    }

    /// The curve's tangent at `t` is parallel to a direction: two conditions.
    pub fn tangent(space: &Space, t: f64, direction: Vec3<f64>) -> Vec<Self> {
        let (k, t) = space.locate(t);
        let basis = space.basis(k, t);
        let (a, b) = across(direction);
        let entry = |axis: Vec3<f64>| -> Vec<_> {
            space.columns(k).zip(basis.rows[1].iter()).map(|(c, &x)| (c, axis * x)).collect()
        };
        [a, b].into_iter().map(|axis| Self { entries: entry(axis), value: 0.0 }).collect()
    }

    /// The sum of all control points is preserved: the centroid of a closed uniform curve.
    pub fn centroid(points: &[Vec3<f64>]) -> Vec<Self> {
        AXES.iter()
            .map(|&a| {
                let entries: Vec<_> = (0..points.len()).map(|i| (i, a)).collect();
                let mut condition = Self { entries, value: 0.0 };
                condition.value = condition.at(points);
                condition
            })
            .collect()
    }

    /// The area that the curve sweeps round the origin in the plane of `normal` keeps its value to
    /// first order: area is quadratic in the control points, its gradient is taken at `points`.
    pub fn area(space: &Space, points: &[Vec3<f64>], normal: Vec3<f64>) -> Self {
        // d/dp and d/dp' of (n . (p x p')) / 2.
        Self::integral(space, points, |p, d| (d.cross(normal) * 0.5, normal.cross(p) * 0.5))
    }

    /// The volume of revolution of the curve about an axis through the origin is preserved to first
    /// order: pi times the integral of r^2 along the axis, with r the distance from it.
    pub fn revolution(space: &Space, points: &[Vec3<f64>], axis: Vec3<f64>) -> Self {
        let axis = axis.normalized().unwrap_or(Vec3::of(1.0, 0.0, 0.0));
        Self::integral(space, points, |p, d| {
            let across = p - axis * p.dot(axis);
            let pi = std::f64::consts::PI;
            (across * (2.0 * pi * d.dot(axis)), axis * (pi * across.norm_sq()))
        })
    }

    /// The integral over the parameter of something that depends on position and first derivative
    /// keeps its value to first order; `slopes` are its derivatives by both. Exact for polynomials of
    /// degree 15 in the parameter.
    fn integral(
        space: &Space,
        points: &[Vec3<f64>],
        slopes: impl Fn(Vec3<f64>, Vec3<f64>) -> (Vec3<f64>, Vec3<f64>),
    ) -> Self {
        let mut slope = vec![Vec3::zero(); points.len()];
        for k in space.spans() {
            let (a, b) = (space.knot(k), space.knot(k + 1));
            // The 8-point rule is exact to degree 15; x x x' has degree 2p - 1.
            let (half, mid) = (0.5 * (b - a), 0.5 * (a + b));
            let mut nodes = Vec::with_capacity(8);
            moldloft_num::gauss_legendre(-1.0, 1.0, |x: f64| {
                nodes.push(x);
                0.0
            });
            for (at, &x) in nodes.iter().enumerate() {
                // The weight of a node is the rule applied to its own unit function.
                let mut seen = 0;
                let w = moldloft_num::gauss_legendre(-1.0, 1.0, |_: f64| {
                    seen += 1;
                    if seen == at + 1 { 1.0 } else { 0.0 }
                }) * half;
                let basis = space.basis(k, mid + half * x);
                let mut p = [Vec3::zero(); 2];
                for (j, c) in space.columns(k).enumerate() {
                    p[0] += points[c] * basis.rows[0][j];
                    p[1] += points[c] * basis.rows[1][j];
                }
                let (by_value, by_slope) = slopes(p[0], p[1]);
                for (j, c) in space.columns(k).enumerate() {
                    slope[c] +=
                        by_value * (w * basis.rows[0][j]) + by_slope * (w * basis.rows[1][j]);
                }
            }
        }
        let entries: Vec<_> = slope.into_iter().enumerate().collect();
        let mut condition = Self { entries, value: 0.0 };
        condition.value = condition.at(points);
        condition
    }

    /// Continuous tangent direction and curvature with a neighbour at the end (`at_end`) or the
    /// start: six conditions on the first and second derivative at the end, none on its position.
    /// `other` are the neighbour's first and second derivative at the common point, with respect to
    /// a parameter of the same direction. See [`joined`].
    ///
    /// # Errors
    /// As [`joined`].
    pub fn join(
        space: &Space,
        points: &[Vec3<f64>],
        at_end: bool,
        other: [Vec3<f64>; 2],
    ) -> Result<Vec<Self>, FairError> {
        let (start, end) = space.domain();
        let t = if at_end { end } else { start };
        let [first, second] = joined(end_jet(space, points, at_end), other)?;
        let mut all = Self::derivative(space, t, Order::First, first);
        all.extend(Self::derivative(space, t, Order::Second, second));
        Ok(all)
    }

    /// The curve meets a neighbour with continuous curvature at its clamped end: `rows` are the
    /// neighbour's last three Bézier points, from far to near (the near one is the common point),
    /// and the conditions are b1 = p + beta (p - a1), b2 - 2 b1 + p = beta^2 (p - 2 a1 + a2) +
    /// gamma (b1 - p), where p, b1, b2 are the curve's first three Bézier points. The conditions
    /// are linear for fixed beta and gamma, which are taken from the original. `at_end` says at
    /// which end of the own curve.
    ///
    /// # Errors
    /// [`FairError::Singular`] when the neighbour's Bézier points give no direction.
    pub fn seam(
        space: &Space,
        points: &[Vec3<f64>],
        [a2, a1, p]: [Vec3<f64>; 3],
        at_end: bool,
    ) -> Result<Vec<Self>, FairError> {
        let rows = space.bezier(None);
        let row = |k: usize| -> Vec<(usize, f64)> {
            let k = if at_end { rows.len() - 1 - k } else { k };
            let (c, f) = rows.row(k);
            c.iter().map(|&c| c as usize).zip(f.iter().copied()).collect()
        };
        let own = |k: usize| row(k).iter().fold(Vec3::zero(), |s, &(c, f)| s + points[c] * f);
        let back = p - a1;
        if back.norm_sq() == 0.0 {
            return Err(FairError::Singular);
        }
        let (b1, b2) = (own(1), own(2));
        let beta = (b1 - p).dot(back) / back.norm_sq();
        let curve = (p - a1 * 2.0 + a2) * (beta * beta);
        let first = back * beta;
        let rest = (b2 - b1 * 2.0 + p) - curve;
        let gamma = if first.norm_sq() > 0.0 { rest.dot(first) / first.norm_sq() } else { 0.0 };
        let wanted = [p, p + first, curve + first * gamma + (p + first) * 2.0 - p];
        let mut out = Vec::new();
        for (k, target) in wanted.into_iter().enumerate() {
            for axis in AXES {
                let entries = row(k).into_iter().map(|(c, f)| (c, axis * f)).collect();
                out.push(Self { entries, value: axis.dot(target) });
            }
        }
        Ok(out)
    }
}

/// Two unit vectors across a direction.
pub(crate) fn across(direction: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>) {
    let d = direction.normalized().unwrap_or(Vec3::of(0.0, 0.0, 1.0));
    let a = d.perpendicular();
    let a = a.normalized().unwrap_or(Vec3::of(1.0, 0.0, 0.0));
    (a, d.cross(a))
}

/// First and second derivative of a spline at its end or its start, by its own knots.
pub(crate) fn end_jet<T: Real>(space: &Space, points: &[Vec3<T>], at_end: bool) -> [Vec3<T>; 2] {
    let (start, end) = space.domain();
    let (k, t) = space.locate(if at_end { end } else { start });
    // The end of a closed space is its start.
    let basis = space.basis(k, t);
    [1, 2].map(|order| {
        let entries = space.columns(k).zip(basis.rows[order].iter());
        entries.fold(Vec3::zero(), |s, (c, &b)| s + points[c].map(|x| x * b))
    })
}

/// The derivatives x' and x'' nearest to the `own` ones that continue a neighbour's n' and n'' with
/// the same tangent direction and curvature: x' = beta n' and x'' = beta^2 n'' + gamma n', with
/// beta and gamma taken from the `own` ones, so that speed and its rate of change are preserved.
///
/// # Errors
/// [`FairError::Singular`] if the neighbour has a zero tangent there, [`FairError::TurnsBack`] if
/// its direction is opposite.
pub fn joined<T: Real>(own: [Vec3<T>; 2], other: [Vec3<T>; 2]) -> Result<[Vec3<T>; 2], FairError> {
    let ([d1, d2], [n1, n2]) = (own, other);
    let square = n1.norm_sq();
    if square.re() == 0.0 {
        return Err(FairError::Singular);
    }
    let beta = d1.dot(n1) / square;
    if beta.re() <= 0.0 || beta.re().is_nan() {
        return Err(FairError::TurnsBack);
    }
    let bend = n2 * (beta * beta);
    let gamma = (d2 - bend).dot(n1) / square;
    Ok([n1 * beta, bend + n1 * gamma])
}
