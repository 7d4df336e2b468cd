//! Spline spaces of a shape, its control points in them, and a bound of the error.

use super::Nurbs;
use super::axis::{Interpolation, SplineSpace, apply, basis_rows};
use super::chebyshev::{Chebyshev, derivative_at_end, series_derivative};
use super::data::{HomogeneousGrid, Value, gap, point};
use moldloft_num::{Rational, Vec3};
use std::fmt;

/// Coefficients below this are rounding, relative to the largest coordinate.
const ROUNDING: f64 = 2e-13;

/// The highest degrees tried: with few samples, and with many where the coefficients end abruptly.
const FEW: usize = 8;
const MANY: usize = 22;

/// Degrees up to this are taken for exact without an abrupt end of the coefficients.
const USUAL: usize = 5;

/// Ratio of the last coefficient to rounding at which a polynomial of high degree is not resolved.
const ABRUPT: f64 = 1e4;

/// Joints nearer than this are one.
const ONE_JOINT: f64 = 1e-11;

/// The shortest span that is halved.
const SHORTEST: f64 = 1e-8;

/// The most spans of one parameter, the most points of a grid, and the most rounds.
const MOST_SPANS: usize = 2000;
const MOST_POINTS: usize = 12_000_000;
const MOST_ROUNDS: usize = 30;

/// Degree of the Chebyshev interpolants by which the error of fits is bounded.
const BOUND_DEGREE: usize = 8;

/// Options of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The largest error.
    pub accuracy: f64,
    /// The degree for a shape that is not a polynomial.
    pub degree: usize,
}

impl FitOptions {
    /// Cubics within an accuracy.
    pub fn within(accuracy: f64) -> Self {
        Self { accuracy, degree: 3 }
    }
}

/// A shape that can be sampled.
pub struct SampledShape<'a, const D: usize> {
    /// Positions on a grid of its parameters, the last one fastest.
    pub sample: &'a dyn Fn(&[Vec<f64>; D]) -> Vec<Vec3>,
    /// The parameters between different formulas.
    pub joints: [Vec<f64>; D],
    /// Its rational form.
    pub rational: Rational<D>,
}

/// Reason why a shape has no sufficiently accurate NURBS.
#[derive(Clone, Debug, PartialEq)]
pub enum NotFitted {
    /// A position is not finite.
    NotFinite,
    /// The accuracy is not a positive number.
    Accuracy(f64),
    /// The error bound reached, and the parameters near its maximum.
    Error {
        /// The bound.
        reached: f64,
        /// Parameters.
        at: Vec<f64>,
    },
}

impl fmt::Display for NotFitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => write!(f, "a position is not a finite number"),
            Self::Accuracy(x) => write!(f, "the accuracy is {x}, expected a positive number"),
            Self::Error { reached, at } => {
                let at: Vec<String> = at.iter().map(|x| format!("{x:.4}")).collect();
                write!(
                    f,
                    "the best fit has an error bound of {reached:.2e}, near parameters ({})",
                    at.join(", ")
                )
            }
        }
    }
}

impl std::error::Error for NotFitted {}

/// The NURBS of a shape: exact if it is piecewise polynomial or rational, otherwise within the
/// accuracy.
///
/// # Errors
/// [`NotFitted`].
pub fn fit<const D: usize>(
    source: &SampledShape<'_, D>,
    options: &FitOptions,
) -> Result<Nurbs<D>, NotFitted> {
    if options.accuracy.is_nan() || options.accuracy <= 0.0 {
        return Err(NotFitted::Accuracy(options.accuracy));
    }
    let fitter = Fitter::new(source, options)?;
    let found: [SplineSpace; D] =
        std::array::from_fn(|d| fitter.exact(d).unwrap_or_else(|| fitter.free(d)));
    let exact = found.iter().all(|axis| !axis.fitted);
    let done = fitter.refined(found);
    if exact && !matches!(&done, Ok(n) if n.error <= fitter.rounding()) {
        // The lines on which the degrees were found do not speak for all of the shape.
        return fitter.refined(std::array::from_fn(|d| fitter.free(d)));
    }
    done
}

struct Fitter<'a, 's, const D: usize> {
    source: &'a SampledShape<'s, D>,
    options: &'a FitOptions,
    /// Ends of the spans between joints, in the parameters of the NURBS.
    ends: [Vec<f64>; D],
    /// The largest coordinate.
    scale: f64,
}

impl<'a, 's, const D: usize> Fitter<'a, 's, D> {
    fn new(source: &'a SampledShape<'s, D>, options: &'a FitOptions) -> Result<Self, NotFitted> {
        let ends = std::array::from_fn(|d| {
            let pace = source.rational.paces[d];
            let mut all: Vec<f64> = source.joints[d].iter().map(|&t| pace.inverse(t)).collect();
            all.extend(pace.joints());
            all.extend([0.0, 1.0]);
            all.sort_by(f64::total_cmp);
            let mut kept = vec![0.0];
            for s in all {
                if s - kept[kept.len() - 1] > ONE_JOINT && s < 1.0 - ONE_JOINT {
                    kept.push(s);
                }
            }
            kept.push(1.0);
            kept
        });
        let mut fitter = Self { source, options, ends, scale: 0.0 };
        let some = fitter.sampled(&std::array::from_fn(|d| fitter.probes(d)));
        for value in &some.values {
            for x in value {
                if !x.is_finite() {
                    return Err(NotFitted::NotFinite);
                }
                fitter.scale = fitter.scale.max(x.abs());
            }
        }
        Ok(fitter)
    }

    /// Error below which a fit is exact within rounding.
    fn rounding(&self) -> f64 {
        40.0 * ROUNDING * self.scale
    }

    /// A few parameters of an axis: its ends, and others inside each span.
    fn probes(&self, d: usize) -> Vec<f64> {
        let mut all = vec![0.0];
        // Many spans are distinguished from few of them.
        let step = (self.ends[d].len() / 12).max(1);
        for span in self.ends[d].windows(2).step_by(step) {
            all.extend([0.137, 0.521, 0.874].map(|x| span[0] + x * (span[1] - span[0])));
        }
        all.push(1.0);
        all
    }

    /// Homogeneous values on a grid of the parameters of the NURBS.
    fn sampled(&self, axes: &[Vec<f64>; D]) -> HomogeneousGrid<D> {
        let rational = &self.source.rational;
        let own: [Vec<f64>; D] = std::array::from_fn(|d| {
            axes[d].iter().map(|&s| rational.paces[d].parameter(s)).collect()
        });
        let points = (self.source.sample)(&own);
        let dims: [usize; D] = std::array::from_fn(|d| axes[d].len());
        let plain = rational.weight.is_none()
            && rational.paces.iter().all(|p| *p == moldloft_num::Pace::Even);
        let value = |(k, p): (usize, Vec3)| {
            if plain {
                return [p.x, p.y, p.z, 1.0];
            }
            let mut rest = k;
            let mut s = [0.0; D];
            for d in (0..D).rev() {
                s[d] = axes[d][rest % dims[d]];
                rest /= dims[d];
            }
            let w = rational.weight_at(s);
            [p.x * w, p.y * w, p.z * w, w]
        };
        HomogeneousGrid { dims, values: points.into_iter().enumerate().map(value).collect() }
    }

    /// The values on lines along an axis, at the Chebyshev nodes of spans.
    fn on_lines(&self, d: usize, at: Vec<f64>) -> HomogeneousGrid<D> {
        let mut axes: [Vec<f64>; D] = std::array::from_fn(|other| self.probes(other));
        axes[d] = at;
        self.sampled(&axes)
    }

    /// The space of an axis along which the shape is polynomial between joints.
    fn exact(&self, d: usize) -> Option<SplineSpace> {
        let few = self.polynomial(d, FEW + 2, FEW);
        let tries = self.ends[d].len() <= 40;
        few.or_else(|| if tries { self.polynomial(d, MANY + 2, MANY) } else { None })
    }

    fn polynomial(&self, d: usize, nodes: usize, highest: usize) -> Option<SplineSpace> {
        let chebyshev = Chebyshev::new(nodes);
        let ends = &self.ends[d];
        let spans = ends.len() - 1;
        let data = self.on_lines(d, chebyshev.nodes_of(ends));
        let tolerance = ROUNDING * self.scale;
        let mut most = vec![0.0f64; nodes + 1];
        let mut lines = Vec::new();
        data.lines(d, |line| {
            let mut series = vec![[0.0; 4]; spans * (nodes + 1)];
            for (k, out) in series.chunks_exact_mut(nodes + 1).enumerate() {
                chebyshev.coefficients(&line[k * nodes..=(k + 1) * nodes], out);
                for (most, c) in most.iter_mut().zip(&*out) {
                    *most = most.max(gap(c, &[0.0; 4]));
                }
            }
            lines.push(series);
        });
        let degree = most.iter().rposition(|c| *c > tolerance).unwrap_or(0).max(1);
        let abrupt = most[degree] > ABRUPT * tolerance;
        if degree > highest || degree > USUAL && !abrupt {
            return None;
        }
        // Multiplicity of a joint, from the order of the first derivative with a jump.
        let repeats = |joint: usize| {
            let widths = [ends[joint] - ends[joint - 1], ends[joint + 1] - ends[joint]];
            for k in 1..=degree {
                let scale = widths.map(|h| (2.0 / h).powi(k as i32));
                let noise: f64 = (0..=degree).map(|n| derivative_at_end(n, k)).sum();
                let allowed = 20.0 * tolerance * noise * scale[0].max(scale[1]);
                let jumps = |series: &Vec<Value>| {
                    let part = |span: usize| &series[span * (nodes + 1)..][..=degree];
                    let left = series_derivative(part(joint - 1), k, true).map(|x| x * scale[0]);
                    let right = series_derivative(part(joint), k, false).map(|x| x * scale[1]);
                    gap(&left, &right) > allowed
                };
                if lines.iter().any(jumps) {
                    return degree + 1 - k;
                }
            }
            0
        };
        let times: Vec<usize> = (1..spans).map(repeats).collect();
        let mut axis = SplineSpace { degree, ends: vec![0.0], repeats: Vec::new(), fitted: false };
        for (k, &n) in times.iter().enumerate() {
            if n > 0 {
                axis.ends.push(ends[k + 1]);
                axis.repeats.push(n);
            }
        }
        axis.ends.push(1.0);
        Some(axis)
    }

    /// The space of an axis along which the shape is not polynomial.
    fn free(&self, d: usize) -> SplineSpace {
        let degree = self.options.degree;
        let ends = &self.ends[d];
        let repeats = (1..ends.len() - 1).map(|k| self.repeats(d, k)).collect();
        SplineSpace { degree, ends: ends.clone(), repeats, fitted: true }
    }

    /// Multiplicity of a joint in a fit, from jumps of tangents and curvatures.
    fn repeats(&self, d: usize, joint: usize) -> usize {
        const NODES: usize = 6;
        let degree = self.options.degree;
        let ends = &self.ends[d];
        let h = 0.05 * (ends[joint] - ends[joint - 1]).min(ends[joint + 1] - ends[joint]);
        let chebyshev = Chebyshev::new(NODES);
        let data =
            self.on_lines(d, chebyshev.nodes_of(&[ends[joint] - h, ends[joint], ends[joint] + h]));
        let mut worst = [0.0f64; 2];
        let mut series = [vec![[0.0; 4]; NODES + 1], vec![[0.0; 4]; NODES + 1]];
        data.lines(d, |line| {
            chebyshev.coefficients(&line[..=NODES], &mut series[0]);
            chebyshev.coefficients(&line[NODES..], &mut series[1]);
            for (k, worst) in worst.iter_mut().enumerate() {
                let scale = (2.0 / h).powi(k as i32 + 1);
                let jump = gap(
                    &series_derivative(&series[0], k + 1, true).map(|x| x * scale),
                    &series_derivative(&series[1], k + 1, false).map(|x| x * scale),
                );
                *worst = worst.max(jump);
            }
        });
        // Rounding of the samples, as derivatives of such series enlarge it.
        let noise = |k: usize| {
            let sum: f64 = (0..=NODES).map(|n| derivative_at_end(n, k)).sum();
            ROUNDING * self.scale * sum * (2.0 / h).powi(k as i32)
        };
        let bound = [1e-6 * self.scale, 1e-3 * self.scale];
        match degree {
            1 => 1,
            _ if worst[0] > bound[0].max(10.0 * noise(1)) => degree,
            2 => 1,
            _ if worst[1] > bound[1].max(10.0 * noise(2)) => degree - 1,
            _ => degree - 2,
        }
    }

    /// The NURBS in these spaces, those of fits with knots added until the error is small enough.
    fn refined(&self, mut axes: [SplineSpace; D]) -> Result<Nurbs<D>, NotFitted> {
        for d in 0..D {
            if axes[d].fitted {
                self.along(d, &mut axes[d])?;
            }
        }
        let accuracy = self.options.accuracy.max(self.rounding());
        for _ in 0..MOST_ROUNDS {
            let data = self.interpolated(&axes);
            let bound = self.bound(&axes, &data)?;
            let fitted = axes.iter().any(|a| a.fitted);
            let limit = if fitted { accuracy } else { self.rounding() };
            if bound.error <= limit || !fitted {
                return self.assembled(&axes, data, bound.error, !fitted);
            }
            let mut halved = false;
            for d in 0..D {
                if axes[d].fitted {
                    let wide = |&k: &usize| axes[d].ends[k + 1] - axes[d].ends[k] > SHORTEST;
                    let spans: Vec<usize> = bound.spans[d].iter().copied().filter(wide).collect();
                    halved |= !spans.is_empty();
                    axes[d].halve(&spans);
                }
            }
            if !halved || axes.iter().any(|a| a.ends.len() > MOST_SPANS) {
                return Err(NotFitted::Error { reached: bound.error, at: bound.at.to_vec() });
            }
        }
        let data = self.interpolated(&axes);
        let bound = self.bound(&axes, &data)?;
        Err(NotFitted::Error { reached: bound.error, at: bound.at.to_vec() })
    }

    /// Halves the spans of one axis until the splines along lines are near enough.
    fn along(&self, d: usize, axis: &mut SplineSpace) -> Result<(), NotFitted> {
        let aim = 0.3 * self.options.accuracy.max(self.rounding());
        for _ in 0..MOST_ROUNDS {
            let solver = Interpolation::new(axis);
            let given = self.on_lines(d, axis.means());
            let inside = [0.07, 0.25, 0.5, 0.75, 0.93];
            let tests: Vec<f64> = axis
                .ends
                .windows(2)
                .flat_map(|w| inside.map(|x| w[0] + x * (w[1] - w[0])))
                .collect();
            let rows = basis_rows(axis.degree, &axis.knots(), &tests);
            let control = given.along(d, given.dims[d], |line, out| solver.solve(line, out));
            let made = control.along(d, tests.len(), |line, out| apply(&rows, line, out));
            let truth = self.on_lines(d, tests);
            let mut off = vec![0.0f64; axis.ends.len() - 1];
            let inner: usize = made.dims[d + 1..].iter().product();
            for (k, (a, b)) in made.values.iter().zip(&truth.values).enumerate() {
                let span = k / inner % made.dims[d] / inside.len();
                let distance = (point(*a) - point(*b)).norm();
                off[span] = off[span].max(if distance.is_nan() { f64::INFINITY } else { distance });
            }
            let spans: Vec<usize> = (0..off.len())
                .filter(|&k| off[k] > aim && axis.ends[k + 1] - axis.ends[k] > SHORTEST)
                .collect();
            if spans.is_empty() || axis.ends.len() + spans.len() > MOST_SPANS {
                return Ok(());
            }
            axis.halve(&spans);
        }
        Ok(())
    }

    /// The homogeneous control points.
    fn interpolated(&self, axes: &[SplineSpace; D]) -> HomogeneousGrid<D> {
        let mut data = self.sampled(&std::array::from_fn(|d| axes[d].means()));
        for d in 0..D {
            let solver = Interpolation::new(&axes[d]);
            data = data.along(d, data.dims[d], |line, out| solver.solve(line, out));
        }
        data
    }

    fn bound(
        &self,
        axes: &[SplineSpace; D],
        control: &HomogeneousGrid<D>,
    ) -> Result<FitErrorBound<D>, NotFitted> {
        let transforms: [Chebyshev; D] = std::array::from_fn(|d| {
            Chebyshev::new(if axes[d].fitted { BOUND_DEGREE } else { axes[d].degree + 2 })
        });
        // Between joints that are no knots the shape may still change its formula.
        let ends: [Vec<f64>; D] = std::array::from_fn(|d| merged(&axes[d].ends, &self.ends[d]));
        let nodes: [Vec<f64>; D] = std::array::from_fn(|d| transforms[d].nodes_of(&ends[d]));
        let far = |at: Vec<f64>| Err(NotFitted::Error { reached: f64::INFINITY, at });
        if nodes.iter().map(Vec::len).product::<usize>() > MOST_POINTS {
            return far(vec![0.5; D]);
        }
        let mut made = control.clone();
        for d in 0..D {
            let rows = basis_rows(axes[d].degree, &axes[d].knots(), &nodes[d]);
            made = made.along(d, nodes[d].len(), |line, out| apply(&rows, line, out));
        }
        let mut off = self.sampled(&nodes);
        for (truth, made) in off.values.iter_mut().zip(&made.values) {
            let d = point(*truth) - point(*made);
            *truth = [d.x, d.y, d.z, 0.0];
        }
        let cells: [usize; D] = std::array::from_fn(|d| ends[d].len() - 1);
        for d in 0..D {
            let n = transforms[d].degree;
            off = off.along(d, cells[d] * (n + 1), |line, out| {
                for (k, out) in out.chunks_exact_mut(n + 1).enumerate() {
                    transforms[d].coefficients(&line[k * n..=(k + 1) * n], out);
                }
            });
        }
        Ok(FitErrorBound::of(&off, axes, &ends, &transforms, self.options.accuracy))
    }

    fn assembled(
        &self,
        axes: &[SplineSpace; D],
        data: HomogeneousGrid<D>,
        error: f64,
        exact: bool,
    ) -> Result<Nurbs<D>, NotFitted> {
        let all_one = data.values.iter().all(|v| (v[3] - 1.0).abs() <= 1e-14);
        if data.values.iter().any(|v| v.iter().any(|x| !x.is_finite()) || v[3] <= 0.0) {
            return Err(NotFitted::NotFinite);
        }
        let position = |v: &Value| if all_one { Vec3::of(v[0], v[1], v[2]) } else { point(*v) };
        Ok(Nurbs {
            degrees: std::array::from_fn(|d| axes[d].degree),
            knots: std::array::from_fn(|d| axes[d].knots()),
            points: data.values.iter().map(position).collect(),
            weights: (!all_one).then(|| data.values.iter().map(|v| v[3]).collect()),
            error: error + 8.0 * f64::EPSILON * self.scale,
            exact,
            paces: self.source.rational.paces,
        })
    }
}

/// Ascending numbers of two ascending lists, those that are equal but for rounding once.
fn merged(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = a.to_vec();
    all.extend(b.iter().filter(|x| a.iter().all(|y| (**x - y).abs() > ONE_JOINT)));
    all.sort_by(f64::total_cmp);
    all
}

/// The bound of an error, and where it is too large.
struct FitErrorBound<const D: usize> {
    error: f64,
    at: [f64; D],
    /// The spans of each axis that should be halved.
    spans: [Vec<usize>; D],
}

impl<const D: usize> FitErrorBound<D> {
    /// The bound from the coefficients of the difference on all cells.
    fn of(
        off: &HomogeneousGrid<D>,
        axes: &[SplineSpace; D],
        ends: &[Vec<f64>; D],
        transforms: &[Chebyshev; D],
        accuracy: f64,
    ) -> Self {
        let cells: [usize; D] = std::array::from_fn(|d| ends[d].len() - 1);
        let count: usize = cells.iter().product();
        let mut sums = vec![0.0f64; count];
        // The last two orders of each axis, and the part that no space of that axis can represent.
        let mut tails = vec![0.0f64; count];
        let mut high = vec![[0.0f64; D]; count];
        for (k, v) in off.values.iter().enumerate() {
            let size = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            let size = if size.is_nan() { f64::INFINITY } else { size };
            let mut rest = k;
            let (mut cell, mut stride) = (0, 1);
            let mut orders = [0; D];
            for d in (0..D).rev() {
                let place = rest % off.dims[d];
                rest /= off.dims[d];
                orders[d] = place % (transforms[d].degree + 1);
                cell += place / (transforms[d].degree + 1) * stride;
                stride *= cells[d];
            }
            sums[cell] += size;
            if (0..D).any(|d| axes[d].fitted && orders[d] + 1 >= transforms[d].degree) {
                tails[cell] += size;
            }
            for d in 0..D {
                if orders[d] > 1 {
                    high[cell][d] += size;
                }
            }
        }
        let mut bound =
            Self { error: 0.0, at: [0.0; D], spans: std::array::from_fn(|_| Vec::new()) };
        for cell in 0..count {
            // Coefficients of analytic shapes fall geometrically: those that were not computed are
            // less in sum than twice the last.
            let error = sums[cell] + 2.0 * tails[cell];
            let mut rest = cell;
            let mut places = [0; D];
            for d in (0..D).rev() {
                places[d] = rest % cells[d];
                rest /= cells[d];
            }
            let middle = |d: usize| 0.5 * (ends[d][places[d]] + ends[d][places[d] + 1]);
            if error > bound.error {
                (bound.error, bound.at) = (error, std::array::from_fn(middle));
            }
            if error > accuracy {
                let most =
                    (0..D).filter(|&d| axes[d].fitted).map(|d| high[cell][d]).fold(0.0, f64::max);
                for d in (0..D).filter(|&d| axes[d].fitted && high[cell][d] >= 0.3 * most) {
                    let span = axes[d].ends.partition_point(|&e| e <= middle(d)) - 1;
                    bound.spans[d].push(span);
                }
            }
        }
        for spans in &mut bound.spans {
            spans.sort_unstable();
            spans.dedup();
        }
        bound
    }
}
