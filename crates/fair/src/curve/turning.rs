//! Parameters that run faster where a curve turns, and how much of what the tolerances allow the curve
//! nearest to the truth takes.
//!
//! With arc lengths for parameters a nose is a short place where third derivatives are large, and a fair
//! curve pays for it in the gaps beside. With steps ds (1 + (k / 2m)^2)^(1/4), k the curvature and m its
//! mean, it has more room: these lie between the arc length and, to the power of a half, the angle of the
//! tangent. The curvature is that of a smoothing spline (Reinsch 1967), so noise hardly shows in them.

use crate::curve::data::Data;
use crate::curve::fit::released;
use crate::curve::moving::{MovingRows, MovingSpace};
use crate::measure::gauss;
use crate::{FairError, Measure, Motion, Space};
use moldloft_num::{Banded, Real, Vec3};

/// The curvature, in means, from which on parameters run faster.
const SHARP: f64 = 2.0;

/// What noise has across a curve where it is as large along it, of which parameters take that along: the budget
/// of the goal `near` for plane curves, and for others.
const PLANE_BUDGET: f64 = 0.5;
const SPACE_BUDGET: f64 = 0.8;

/// Flat to this share of the extent is plane.
const FLAT: f64 = 1e-9;

/// Steps of the search for the weight of the smoothing spline, factor by factor, and what it is off at most.
const MOST_STEPS: usize = 60;
const FACTOR: f64 = 4.0;
const CLOSE: f64 = 1e-9;

/// The largest and the smallest weight of a datum, in those of the mean.
const HEAVY: f64 = 1e4;

/// A turn of the tangent, in radians, below which a curve is straight.
const NO_TURN: f64 = 1e-6;

/// The budget of the goal `near` in thirds of the squared tolerances: noise that fills these evenly has 1
/// across a curve if points move along one direction, two thirds of it in space and half of it in a plane,
/// where the rest is along the curve.
///
/// # Example
/// ```
/// use moldloft_fair::{Motion, near_budget};
/// use moldloft_num::Vec3;
/// let arc: Vec<_> = (0..9).map(|k| 0.2 * k as f64).map(|t| Vec3::of(t.cos(), t.sin(), 0.0)).collect();
/// assert_eq!(near_budget(&arc, Motion::Ball), 0.5);
/// assert_eq!(near_budget(&arc, Motion::Along(Vec3::of(0.0, 1.0, 0.0))), 0.8);
/// ```
pub fn near_budget(points: &[Vec3<f64>], motion: Motion) -> f64 {
    if matches!(motion, Motion::Along(_)) || !is_plane(points) {
        return SPACE_BUDGET;
    }
    PLANE_BUDGET
}

/// Whether points are in one plane.
fn is_plane(points: &[Vec3<f64>]) -> bool {
    let Some(&first) = points.first() else { return true };
    let far = |of: &dyn Fn(Vec3<f64>) -> Vec3<f64>| {
        let all = points.iter().map(|&p| of(p - first));
        all.fold(Vec3::zero(), |a, b| if b.norm_sq() > a.norm_sq() { b } else { a })
    };
    let longest = far(&|v| v);
    let size = longest.norm();
    let Some(a) = longest.normalized() else { return true };
    let across = far(&|v| v - a * a.dot(v));
    let Some(b) = across.normalized().filter(|_| across.norm() > FLAT * size) else { return true };
    let normal = a.cross(b);
    points.iter().all(|&p| (p - first).dot(normal).abs() <= FLAT * size)
}

/// Parameters of data that run faster where their curve turns, for data with any parameters, points
/// and `tolerances` and parameters `at` that may carry derivatives; `budget` is what the smoothing spline takes of the
/// squared tolerances' thirds. Exact points, and points without tolerances, have the parameters that they had.
///
/// # Errors
/// [`FairError`] of the spaces of splines.
///
/// # Example
/// ```
/// use moldloft_fair::{Data, EndContinuity, InterpolationSpace, Limit, ParameterSpacing, curvature_parameters,
///     parameters};
/// use moldloft_num::Vec3;
/// // A catenary: its vertex gets more of the range than of the length. (Conics and cubics would be exact.)
/// let y = |x: f64| (2.0 * x).cosh();
/// let points: Vec<_> = (-10..11).map(|k| 0.2 * k as f64).map(|x| Vec3::of(x, y(x), 0.0)).collect();
/// let at = parameters(&points, ParameterSpacing::Chord, false).unwrap();
/// let data = Data {
///     limit: Limit::ball(points.len(), 1e-3).unwrap(),
///     layout: InterpolationSpace::new(3, &at, &[], false).unwrap(),
///     ends: [EndContinuity::Free; 2],
///     points: points.clone(),
/// };
/// let own = curvature_parameters(&data, &points, &[1e-3; 21], &at, 0.5).unwrap();
/// assert!(own[11] - own[9] > 2.0 * (at[11] - at[9]));
/// ```
pub fn curvature_parameters<T: Real>(
    data: &Data,
    points: &[Vec3<T>],
    tolerances: &[T],
    at: &[T],
    budget: f64,
) -> Result<Vec<T>, FairError> {
    let degree = data.layout.space.degree();
    if degree < 2 || data.exact_parts() || data.limit.radii.iter().all(|&r| r == 0.0) {
        return Ok(at.to_vec());
    }
    let real = |all: &[T]| all.iter().map(|t| t.re()).collect::<Vec<f64>>();
    let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
    let (own, times) = (real(tolerances), real(at));
    let of_reals = Smoothing::<f64>::new(data, &plain, &own, &times, budget)?;
    let weight = of_reals.balanced();
    let constant = points.iter().flat_map(|p| p.to_array()).chain(at.iter().copied());
    let mut constant = constant.chain(tolerances.iter().copied());
    let steps: Option<Vec<T>> = if constant.all(|x| x.is_constant()) {
        let steps = of_reals.solved(weight).and_then(|c| of_reals.steps(&c));
        steps.map(|all| all.into_iter().map(T::from).collect())
    } else {
        let moving = Smoothing::<T>::new(data, points, tolerances, at, budget)?;
        moving.answered(&of_reals, weight).and_then(|control| moving.steps(&control))
    };
    // Where the smoothing spline has no length somewhere the parameters stay.
    Ok(steps.map_or_else(|| at.to_vec(), |steps| numbered(data, &steps, at.len())))
}

/// The parameters of the data, in their order, by the lengths between the sites.
fn numbered<T: Real>(data: &Data, steps: &[T], count: usize) -> Vec<T> {
    let layout = &data.layout;
    let mut run = vec![T::zero()];
    for &step in steps {
        run.push(*run.last().unwrap_or(&T::zero()) + step);
    }
    let total = *run.last().unwrap_or(&T::one());
    let closed = layout.space.is_closed() || layout.owner.first() == layout.owner.last();
    let mut out = vec![T::zero(); count];
    for (site, owner) in layout.owner.iter().enumerate().rev() {
        if let Some(i) = *owner {
            out[i] = run[site] / total;
        }
    }
    let start = out[0];
    for t in &mut out {
        *t -= start;
        if closed && t.re() < 0.0 {
            *t += T::one();
        }
    }
    if !closed {
        out[count - 1] = T::one();
    }
    out
}

/// A spline through data whose measure counts beside the residuals.
struct Smoothing<'a, T> {
    space: MovingSpaceOf<'a, T>,
    sites: Vec<T>,
    wanted: Vec<Vec3<T>>,
    values: MovingRows<T>,
    weights: Vec<T>,
    /// The squares of the measure and of the residuals, as bands of matrices.
    energy: Bands<T>,
    squares: Bands<T>,
    /// The sites that count in the budget.
    counted: Vec<bool>,
    target: T,
}

/// A space with its own moving knots.
struct MovingSpaceOf<'a, T> {
    space: &'a Space,
    knots: Vec<T>,
}

impl<T: Real> MovingSpaceOf<'_, T> {
    fn moving(&self) -> MovingSpace<'_, T> {
        MovingSpace { space: self.space, knots: &self.knots }
    }
}

/// A symmetric matrix of few bands.
struct Bands<T> {
    count: usize,
    width: usize,
    entries: Vec<T>,
}

impl<T: Real> Bands<T> {
    /// The sum of the squares of rows, each times its weight.
    fn of(space: &Space, rows: &MovingRows<T>, weight: impl Fn(usize) -> T) -> Self {
        let count = space.count();
        let p = space.degree();
        let width = (if space.is_closed() { 2 * p } else { p }).min(count.saturating_sub(1));
        let mut entries = vec![T::zero(); count * (2 * width + 1)];
        for (k, row) in rows.rows.iter().enumerate() {
            let by = weight(k);
            for &(i, x) in row {
                for &(j, y) in row {
                    let (i, j) = (folded(space, i), folded(space, j));
                    entries[i * (2 * width + 1) + j + width - i] += x * y * by;
                }
            }
        }
        Self { count, width, entries }
    }
}

impl Bands<f64> {
    /// The matrix times control points.
    fn times(&self, space: &Space, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let n = self.count;
        let mut folds = vec![Vec3::zero(); n];
        for (c, &p) in points.iter().enumerate() {
            folds[folded(space, c)] = p;
        }
        let row = |r: usize| {
            let own = &self.entries[r * (2 * self.width + 1)..][..2 * self.width + 1];
            let columns = r.saturating_sub(self.width)..(r + self.width + 1).min(n);
            columns.fold(Vec3::zero(), |s, c| s + folds[c] * own[c + self.width - r])
        };
        (0..n).map(|c| row(folded(space, c))).collect()
    }
}

/// Where a control point stands in the matrix: those of closed curves alternate from both sides of the first,
/// so that neighbours are near each other.
fn folded(space: &Space, c: usize) -> usize {
    let n = space.count();
    match space.is_closed() {
        false => c,
        true if 2 * c < n => 2 * c,
        true => 2 * (n - 1 - c) + 1,
    }
}

impl<'a, T: Real> Smoothing<'a, T> {
    fn new(
        data: &'a Data,
        points: &[Vec3<T>],
        tolerances: &[T],
        at: &[T],
        budget: f64,
    ) -> Result<Self, FairError> {
        let layout = &data.layout;
        let (sites, knots) = layout.moving(at);
        let space = MovingSpaceOf { space: &layout.space, knots };
        let measure = if layout.space.degree() > 2 { Measure::Variation } else { Measure::Bending };
        let energy = space.moving().measure(measure)?;
        let values = MovingRows { rows: sites.iter().map(|&t| space.moving().value(t)).collect() };
        let wanted = layout.data(points);
        let open = released(&data.points, &data.limit.radii);
        let pulls = |i: usize| {
            let own = tolerances[i].re();
            own > 0.0 && own.is_finite() && !open[i]
        };
        let pulling: Vec<usize> = (0..points.len()).filter(|&i| pulls(i)).collect();
        // Weights are shares of the mean, which moves with the tolerances, too.
        let squared = pulling.iter().map(|&i| tolerances[i] * tolerances[i]);
        let whole = squared.fold(T::zero(), |s, x| s + x) / pulling.len().max(1) as f64;
        let mean = whole.re();
        let weights: Vec<T> = layout
            .owner
            .iter()
            .enumerate()
            .map(|(k, owner)| {
                let own = |i: usize| {
                    if open[i] || !tolerances[i].re().is_finite() {
                        return T::from(1.0 / HEAVY);
                    }
                    let square = tolerances[i] * tolerances[i];
                    if square.re() * HEAVY < mean {
                        T::from(HEAVY)
                    } else if square.re() > mean * HEAVY || mean == 0.0 {
                        T::from(if mean == 0.0 { 1.0 } else { 1.0 / HEAVY })
                    } else {
                        whole / square
                    }
                };
                match owner {
                    Some(i) => own(*i),
                    None => layout
                        .sources_of(k)
                        .map(own)
                        .fold(T::one(), |a, b| if b.re() < a.re() { b } else { a }),
                }
            })
            .collect();
        let counted = layout.owner.iter().map(|o| o.is_some_and(pulls)).collect::<Vec<_>>();
        let count = counted.iter().filter(|c| **c).count();
        let target = whole * budget * count as f64 / 3.0;
        let energy = Bands::of(space.space, &energy, |_| T::one());
        let squares = Bands::of(space.space, &values, |k| weights[k]);
        Ok(Self { space, sites, wanted, values, weights, energy, squares, counted, target })
    }

    /// The control points at a weight of the measure, for values at the sites.
    fn through(&self, weight: T, right: Vec<Vec3<T>>) -> Option<Vec<Vec3<T>>> {
        let (n, width) = (self.energy.count, self.energy.width);
        let mut matrix = Banded::<T>::zero(n, width);
        let both = self.energy.entries.iter().zip(&self.squares.entries);
        for (k, (&e, &s)) in both.enumerate() {
            let (row, column) = (k / (2 * width + 1), k % (2 * width + 1));
            if row + column >= width && row + column - width < n {
                *matrix.entry(row, row + column - width) = e * weight + s;
            }
        }
        let mut folds = vec![Vec3::zero(); n];
        for (c, v) in right.into_iter().enumerate() {
            folds[folded(self.space.space, c)] = v;
        }
        matrix.solve(&mut folds).ok()?;
        let out: Vec<_> = (0..n).map(|c| folds[folded(self.space.space, c)]).collect();
        out.iter().all(|c| c.is_finite()).then_some(out)
    }

    fn solved(&self, weight: T) -> Option<Vec<Vec3<T>>> {
        let mut right = vec![Vec3::zero(); self.energy.count];
        for (k, row) in self.values.rows.iter().enumerate() {
            for &(c, f) in row {
                right[c] += self.wanted[k].map(|x| x * f * self.weights[k]);
            }
        }
        self.through(weight, right)
    }

    /// The weighted squares of what the data are off, and the residuals.
    fn off(&self, control: &[Vec3<T>]) -> (T, Vec<Vec3<T>>) {
        let all: Vec<Vec3<T>> = (0..self.values.rows.len())
            .map(|k| self.values.apply(k, control) - self.wanted[k])
            .collect();
        let counted = all.iter().zip(&self.weights).zip(&self.counted).filter(|x| *x.1);
        (counted.fold(T::zero(), |s, ((r, &w), _)| s + r.norm_sq() * w), all)
    }

    /// The steps of the parameter from site to site: lengths, longer where the curve turns.
    fn steps(&self, control: &[Vec3<T>]) -> Option<Vec<T>> {
        let space = self.space.moving();
        let own = self.space.space;
        let m = self.sites.len();
        let last = if own.is_closed() { m } else { m - 1 };
        let (start, end) = own.domain();
        let rule = gauss(3);
        // Lengths and angles of parts.
        let mut parts: Vec<(usize, T, T)> = Vec::new();
        for j in 0..last {
            let (a, mut b) = (self.sites[j], self.sites[(j + 1) % m]);
            if j + 1 == m {
                b += T::from(end - start);
            }
            let h = b - a;
            for &(x, w) in &rule {
                let t = a + h * (0.5 * (1.0 + x));
                let (k, moved) = own.locate(t.re());
                let t = t + T::from(moved - t.re());
                let at = |order: usize| {
                    let factors = space.derivative(k, t, order);
                    let both = own.columns(k).zip(factors);
                    both.fold(Vec3::zero(), |s: Vec3<T>, (c, f)| s + control[c].map(|x| x * f))
                };
                let (speed, bend) = (at(1), at(2));
                let square = speed.norm_sq();
                if square.re() <= 0.0 || !square.re().is_finite() {
                    return None;
                }
                let length = square.sqrt() * h * (0.5 * w);
                let cross = speed.cross(bend).norm_sq() / (square * square);
                let floor = NO_TURN / (end - start);
                let turn = (cross + T::from(floor * floor)).sqrt() * h * (0.5 * w);
                parts.push((j, length, turn));
            }
        }
        let sum = |of: fn(&(usize, T, T)) -> T| parts.iter().fold(T::zero(), |s, p| s + of(p));
        let mean = sum(|p| p.2) / sum(|p| p.1) * SHARP;
        let mut out = vec![T::zero(); last];
        for (j, length, turn) in parts {
            let ratio = turn / (length * mean);
            out[j] += length * (T::one() + ratio * ratio).sqrt().sqrt();
        }
        out.iter().all(|s| s.re() > 0.0 && s.is_finite()).then_some(out)
    }

    /// The control points as they answer to what moves: the weight does, too, so that the budget is kept.
    fn answered(&self, reals: &Smoothing<'_, f64>, weight: f64) -> Option<Vec<Vec3<T>>> {
        let fixed = self.solved(T::from(weight))?;
        if weight == 0.0 {
            return Some(fixed);
        }
        let control = reals.solved(weight)?;
        // How the curve and its squares change with the weight.
        let right =
            reals.energy.times(reals.space.space, &control).into_iter().map(|v| -v).collect();
        let by_weight = reals.through(weight, right)?;
        let (squares, residuals) = reals.off(&control);
        let rate: f64 = (0..residuals.len())
            .filter(|&k| reals.counted[k])
            .map(|k| 2.0 * reals.weights[k] * residuals[k].dot(reals.values.apply(k, &by_weight)))
            .sum();
        if rate <= 0.0 || (squares / reals.target - 1.0).abs() > 1e3 * CLOSE {
            // At an end of the range the weight stays.
            return Some(fixed);
        }
        let short = self.target - self.off(&fixed).0;
        let change = (short - T::from(short.re())) / rate;
        let both = fixed.into_iter().zip(by_weight);
        Some(both.map(|(p, d)| p + Vec3::<T>::lifted(d).map(|x| x * change)).collect())
    }
}

impl Smoothing<'_, f64> {
    /// The weight of the measure at which the data take the budget, or 0 if there is none to take.
    fn balanced(&self) -> f64 {
        if self.target <= 0.0 {
            return 0.0;
        }
        let trace = |b: &Bands<f64>| -> f64 {
            (0..b.count).map(|k| b.entries[k * (2 * b.width + 1) + b.width]).sum()
        };
        let unit = trace(&self.squares) / trace(&self.energy).max(f64::MIN_POSITIVE);
        let beyond = |weight: f64| {
            let control = self.solved(weight)?;
            Some(libm::log(self.off(&control).0 / self.target))
        };
        let (mut low, mut high): (Option<(f64, f64)>, Option<(f64, f64)>) = (None, None);
        let (mut trial, mut side) = (0.0, 0);
        for _ in 0..MOST_STEPS {
            let Some(value) = beyond(unit * libm::exp(trial)) else { break };
            if value.abs() <= CLOSE {
                return unit * libm::exp(trial);
            }
            if value < 0.0 {
                if side == -1
                    && let Some(h) = &mut high
                {
                    h.1 *= 0.5;
                }
                (low, side) = (Some((trial, value)), -1);
            } else {
                if side == 1
                    && let Some(l) = &mut low
                {
                    l.1 *= 0.5;
                }
                (high, side) = (Some((trial, value)), 1);
            }
            trial = match (low, high) {
                (Some(l), Some(h)) => l.0 + (h.0 - l.0) * (l.1 / (l.1 - h.1)).clamp(0.01, 0.99),
                (Some(l), None) => l.0 + FACTOR,
                (None, Some(h)) => h.0 - FACTOR,
                (None, None) => break,
            };
        }
        unit * libm::exp(trial)
    }
}
