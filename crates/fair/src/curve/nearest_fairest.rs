//! Of several fairest curves the nearest to the data.
//!
//! A measure of derivatives is zero for polynomials of low degree. Where such a polynomial is within
//! the tolerances of a smooth piece, many are: which of them a solver ends at says nothing, and may
//! change with the last digit of the data. The one with the least squares is a continuous function
//! of the data.

use crate::curve::data::Data;
use crate::optimum::held::HeldDirections;
use crate::optimum::problem::{NormBounds, Problem, V, solve};
use crate::optimum::{MotionAxes, Optimum};
use crate::{FairError, Motion, RowNorm, SparseRows};
use moldloft_num::Vec3;

/// Fraction of a tolerance from which it counts as reached.
const REACHED: f64 = 1.0 - 1e-4;

/// Part of a tolerance that the start of the search keeps from it.
const STRICT: f64 = 1e-9;

/// Fraction of the way to the middle of the tolerances by which a polynomial first moves; it is
/// quadrupled until the polynomial is within them.
const PULL: f64 = 1e-15;
const MOST_PULLS: i32 = 25;

/// Rounds of the search for a polynomial within the tolerances.
const ROUNDS: usize = 2000;

/// A smooth piece of a curve: its sites, and its control points.
struct PieceBetweenBreaks {
    sites: Vec<usize>,
    control: std::ops::RangeInclusive<usize>,
    ends: [f64; 2],
}

/// A polynomial by its Bernstein coefficients on an interval.
#[derive(Clone)]
struct Polynomial {
    coefficients: Vec<Vec3<f64>>,
    ends: [f64; 2],
}

impl Polynomial {
    fn place(&self, t: f64) -> f64 {
        (t - self.ends[0]) / (self.ends[1] - self.ends[0])
    }

    /// The polynomial moved by a fraction of the way to another.
    fn towards(&self, other: &Self, by: f64) -> Self {
        let both = self.coefficients.iter().zip(&other.coefficients);
        let coefficients = both.map(|(p, q)| *p + (*q - *p) * by).collect();
        Self { coefficients, ends: self.ends }
    }

    /// The blossom of the polynomial: its multi-affine form at as many parameters as its degree
    /// (Ramshaw 1989).
    fn blossom(&self, at: &[f64]) -> Vec3<f64> {
        let mut c = self.coefficients.clone();
        for &t in at {
            let s = self.place(t);
            c = c.windows(2).map(|w| w[0] + (w[1] - w[0]) * s).collect();
        }
        c[0]
    }

    /// The control point of a spline of any degree at least its own, by the knots of that point.
    fn control(&self, knots: &[f64]) -> Vec3<f64> {
        let degree = self.coefficients.len() - 1;
        let mut all = vec![Vec::new()];
        for _ in 0..degree {
            let longer = |own: &Vec<usize>| {
                let from = own.last().map_or(0, |l| l + 1);
                let own = own.clone();
                (from..knots.len()).map(move |k| own.iter().copied().chain([k]).collect())
            };
            all = all.iter().flat_map(longer).collect();
        }
        let of =
            |own: &Vec<usize>| self.blossom(&own.iter().map(|&k| knots[k]).collect::<Vec<_>>());
        let sum = all.iter().map(of).fold(Vec3::zero(), |s, p| s + p);
        sum * (1.0 / all.len() as f64)
    }
}

/// Values of the Bernstein polynomials of a degree.
fn bernstein(degree: usize, s: f64) -> Vec<f64> {
    let mut out = vec![1.0];
    for _ in 0..degree {
        let up = out.iter().map(|b| b * (1.0 - s)).chain([0.0]);
        let down = [0.0].into_iter().chain(out.iter().map(|b| b * s));
        out = up.zip(down).map(|(a, b)| a + b).collect();
    }
    out
}

/// The coefficients of a polynomial strictly inside of limits, each by the values of the Bernstein
/// polynomials, the place and the radius; `free` coefficients move. Weighted least squares, the weights
/// multiplied by the residuals again and again, tend to the smallest largest residual (Lawson 1961).
fn inside(
    limited: &[(Vec<f64>, Vec3<f64>, f64)],
    mut coefficients: Vec<Vec3<f64>>,
    free: &[usize],
) -> Option<Vec<Vec3<f64>>> {
    let m = free.len();
    let mut weights: Vec<f64> =
        limited.iter().map(|(_, _, radius)| 1.0 / (radius * radius)).collect();
    for _ in 0..ROUNDS {
        let mut normal = vec![0.0; m * m];
        let mut right = vec![Vec3::zero(); m];
        for ((b, place, _), w) in limited.iter().zip(&weights) {
            let known = (0..b.len()).filter(|j| !free.contains(j));
            let rest = known.fold(*place, |s, j| s - coefficients[j] * b[j]);
            for (r, &i) in free.iter().enumerate() {
                right[r] += rest * (w * b[i]);
                for (c, &j) in free.iter().enumerate() {
                    normal[r * m + c] += w * b[i] * b[j];
                }
            }
        }
        for axis in crate::curve::condition::AXES {
            let mut own: Vec<f64> = right.iter().map(|v| v.dot(axis)).collect();
            moldloft_num::solve_dense(&mut normal.clone(), &mut own).ok()?;
            for (&k, x) in free.iter().zip(own) {
                let by = x - coefficients[k].dot(axis);
                coefficients[k] += axis * by;
            }
        }
        let shares: Vec<f64> = limited
            .iter()
            .map(|(b, place, radius)| {
                let value = coefficients.iter().zip(b).fold(-*place, |s, (c, b)| s + *c * *b);
                value.norm() / radius
            })
            .collect();
        if shares.iter().all(|&s| s < 1.0 - STRICT) {
            return Some(coefficients);
        }
        // Over the radii the weighted mean of the squares is less than the square of the smallest largest one.
        let own = || limited.iter().zip(&weights).map(|((_, _, radius), w)| w * radius * radius);
        let mean = own().zip(&shares).map(|(w, s)| w * s * s).sum::<f64>();
        let total: f64 = own().sum();
        if mean >= total {
            return None;
        }
        for (w, s) in weights.iter_mut().zip(&shares) {
            *w *= s / total;
        }
    }
    None
}

impl Data {
    /// Replaces pieces of a fairest curve that a polynomial below degree `order` could have by the
    /// nearest such polynomial. `frozen` are control points that do not move.
    ///
    /// # Errors
    /// Those of the solver.
    pub(super) fn nearest_fairest(
        &self,
        order: usize,
        frozen: &[bool],
        fairest: Optimum,
    ) -> Result<Optimum, FairError> {
        let held = self.held();
        let mut out = fairest;
        if self.limit.motion == Motion::Box || self.layout.space.is_closed() {
            return Ok(out);
        }
        let frame = MotionAxes::of(self.limit.motion, &self.points, &[]);
        let mut changed = false;
        for piece in self.pieces() {
            let inner = piece.control.clone().skip(1).take(piece.control.clone().count() - 2);
            if inner.clone().any(|c| held.contains(&c)) || inner.clone().all(|c| frozen[c]) {
                continue;
            }
            let found = self.nearest_polynomial(order - 1, frozen, &frame, &piece, &out)?;
            let Some([nearest, middle]) = found else { continue };
            // What is at its limits may be beyond them by rounding: it moves towards the middle.
            let mut steps =
                (0..MOST_PULLS).map(|k| if k == 0 { 0.0 } else { libm::ldexp(PULL, 2 * k) });
            let place =
                |by: f64| self.placed(&nearest.towards(&middle, by), frozen, &frame, &piece, &out);
            if let Some(points) = steps.find_map(place) {
                (out.points, changed) = (points, true);
            }
        }
        if changed {
            let residuals = self.residuals(&out.points);
            let reached = residuals.iter().zip(&self.limit.radii);
            out.active = reached.filter(|(r, a)| **a > 0.0 && **r >= **a * REACHED).count();
        }
        Ok(out)
    }

    /// The curve with a polynomial on a piece; none where that leaves a tolerance.
    fn placed(
        &self,
        polynomial: &Polynomial,
        frozen: &[bool],
        frame: &MotionAxes,
        piece: &PieceBetweenBreaks,
        curve: &Optimum,
    ) -> Option<Vec<Vec3<f64>>> {
        let space = &self.layout.space;
        let mut points = curve.points.clone();
        for c in piece.control.clone().filter(|&c| !frozen[c]) {
            let knots = &space.knots()[c + 1..=c + space.degree()];
            let to = frame.down(polynomial.control(knots) - points[c]);
            points[c] += frame.up(to);
        }
        let within = piece.sites.iter().all(|&k| {
            let Some(i) = self.layout.owner[k] else { return true };
            let off = (self.layout.rows.apply(k, &points) - self.points[i]).norm();
            off <= self.limit.radii[i]
        });
        within.then_some(points)
    }

    /// The pieces between breaks.
    fn pieces(&self) -> Vec<PieceBetweenBreaks> {
        let layout = &self.layout;
        let (start, end) = layout.space.domain();
        if !layout.interpolates() {
            let control = 0..=layout.space.count() - 1;
            return vec![PieceBetweenBreaks {
                sites: (0..layout.sites.len()).collect(),
                control,
                ends: [start, end],
            }];
        }
        let last = layout.sites.len() - 1;
        let inner = layout.marks.iter().copied().filter(|&m| 0 < m && m < last);
        let bounds: Vec<usize> = [0].into_iter().chain(inner).chain([last]).collect();
        let piece = |w: &[usize]| PieceBetweenBreaks {
            sites: (w[0]..=w[1]).collect(),
            control: w[0]..=w[1],
            ends: [layout.sites[w[0]], layout.sites[w[1]]],
        };
        bounds.windows(2).map(piece).collect()
    }

    /// The polynomial of a degree at most that is the nearest to the data of a piece, and one strictly
    /// within the tolerances; none where there is no such polynomial.
    fn nearest_polynomial(
        &self,
        most: usize,
        frozen: &[bool],
        frame: &MotionAxes,
        piece: &PieceBetweenBreaks,
        curve: &Optimum,
    ) -> Result<Option<[Polynomial; 2]>, FairError> {
        let layout = &self.layout;
        let data: Vec<(usize, usize)> =
            piece.sites.iter().filter_map(|&k| layout.owner[k].map(|i| (k, i))).collect();
        let degree = most.min(data.len() - 1);
        let fixed = [*piece.control.start(), *piece.control.end()].map(|c| frozen[c]);
        let ends = piece.ends;
        let at = |k: usize| bernstein(degree, (layout.sites[k] - ends[0]) / (ends[1] - ends[0]));
        let still = |at: usize| (at == 0 && fixed[0]) || (at == degree && fixed[1]);
        let points = &curve.points;
        let mut coefficients = vec![Vec3::zero(); degree + 1];
        coefficients[0] = points[*piece.control.start()];
        coefficients[degree] = points[*piece.control.end()];
        let free: Vec<usize> = (0..=degree).filter(|&k| !still(k)).collect();
        if free.is_empty() || (degree == 0 && fixed != [false; 2]) {
            return Ok(None);
        }
        let m = free.len();
        let limited: Vec<(Vec<f64>, Vec3<f64>, f64)> = data
            .iter()
            .map(|&(k, i)| (at(k), self.points[i], self.limit.radii[i]))
            .filter(|(_, _, radius)| *radius > 0.0 && radius.is_finite())
            .collect();
        let Some(coefficients) = inside(&limited, coefficients, &free) else { return Ok(None) };
        let middle = Polynomial { coefficients, ends };
        let mut found = middle.clone();
        let pulls = self.pulls();
        let (mut measure, mut offsets) = (SparseRows::new(), Vec::new());
        let mut bounds = NormBounds { direct: false, ..NormBounds::none() };
        for &(k, i) in &data {
            let radius = self.limit.radii[i];
            let end = k == piece.sites[0] || k == piece.sites[piece.sites.len() - 1];
            if radius == 0.0 && end {
                continue;
            }
            let b = at(k);
            let value =
                found.coefficients.iter().zip(&b).fold(Vec3::zero(), |s, (c, b)| s + *c * *b);
            let off = value - self.points[i];
            if off.norm() >= radius * (1.0 - STRICT) {
                return Ok(None);
            }
            let off = frame.down(off);
            if radius.is_finite() {
                bounds.rows.push(b.iter().copied().enumerate());
                bounds.radii.push(radius);
                bounds.offsets.push(off);
            }
            if pulls[i] {
                measure.push(b.iter().map(|f| f / radius).enumerate());
                offsets.push(off.map(|x| x / radius));
            }
        }
        let finite = || bounds.radii.iter().copied();
        let reach = 1e3 * finite().fold(0.0, f64::max);
        if measure.len() < m || frame.axes.is_empty() {
            return Ok(None);
        }
        let problem = Problem {
            dimension: frame.axes.len(),
            measure,
            norm: RowNorm::Square,
            offsets,
            bounds,
            frozen: (0..=degree).map(still).collect(),
            held: HeldDirections::default(),
            conditions: Vec::new(),
            refined: false,
            halves: Vec::new(),
            squares: None,
            reach: vec![reach; degree + 1],
            begin: Vec::new(),
        };
        let size = self.points.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let margin = 4.0 * f64::EPSILON * size;
        let solution = solve(&problem, 1e-13, 0.0, margin, None)?;
        for (c, x) in found.coefficients.iter_mut().zip(&solution.x) {
            *c += frame.up(*x as V);
        }
        Ok(Some([found, middle]))
    }
}
