//! Data under tolerances: the fairest spline that stays within each datum's tolerance at the
//! datum's own parameter.
//!
//! minimise E(x) subject to |x(t_i) - p_i| <= a_i
//!
//! Knots stand at the data ([`Layout`]), so the spline through them is the start and any tolerance
//! can be kept, 0 too. The distance at a datum's parameter is at least its distance from the curve:
//! what is kept is a proof about the data. The least energy sits at the edge of what is allowed,
//! which is fair but no nearer to the truth than the data; [`Goal`] says what is wanted.

use crate::curve::job::End;
use crate::optimum::{Bounded, DataLimits, Optimum, Parts, kept};
use crate::{
    Certificate, Condition, FairError, Job, Layout, Limit, Measure, Norm, SparseRows, shape,
};
use moldloft_num::Vec3;

/// Which of the curves within the tolerances is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The fairest: the least of the measure.
    Fairest,
    /// The fairest of those whose squared residuals, each over its tolerance, have a mean of at
    /// most this share of 1/3, which is what noise has that fills the tolerance evenly.
    Budget(f64),
    /// The same, as far as it is worth a move: data whose own curve measures less than one and a
    /// half times as much do not move at all, and from three times on they move all the way.
    /// Exact data stay, and so does what was faired before.
    Near(f64),
    /// The one nearest to the data (in the sum of the same squares) whose measure exceeds the least
    /// by at most this share. Data that are as fair as that do not move.
    Nearest(f64),
}

/// Data with what they allow.
#[derive(Clone, Debug)]
pub struct Data {
    /// The data.
    pub points: Vec<Vec3<f64>>,
    /// How far the curve may be from each, and in which directions it may leave them.
    pub limit: Limit,
    /// Where they are on the curve, and the splines.
    pub layout: Layout,
    /// What open ends keep of the curve through the data.
    pub ends: [End; 2],
}

/// What is wanted.
#[derive(Clone, Debug)]
pub struct DataOptions {
    /// What there is to be little of.
    pub measure: Measure,
    /// Which of the curves.
    pub goal: Goal,
    /// Linear conditions on the control points.
    pub conditions: Vec<Condition>,
    /// Whether the curve may have more inflections than the one of least bending within the same
    /// tolerances.
    pub bends: bool,
    /// The certified gap, as a share of the measure.
    pub accuracy: f64,
}

/// A faired curve.
#[derive(Clone, Debug)]
pub struct DataFit {
    /// Its control points, on the layout's space.
    pub points: Vec<Vec3<f64>>,
    /// Those of the curve through the data.
    pub original: Vec<Vec3<f64>>,
    /// The distance of each datum from the curve at its parameter.
    pub residuals: Vec<f64>,
    /// The mean of the squared residuals over the tolerances, over 1/3.
    pub used: f64,
    /// The measure of the curve, and what is left to gain among the curves within the tolerances
    /// whose residuals are no larger in the sum of squares.
    pub certificate: Certificate,
    /// The least of the measure within the tolerances.
    pub least: f64,
    /// The weight of the data beside the measure.
    pub weight: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Tolerances that are reached.
    pub active: usize,
}

/// Data of which neighbours in one place are one datum.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The data that are left.
    pub points: Vec<Vec3<f64>>,
    /// Their tolerances.
    pub radii: Vec<f64>,
    /// Which of them each datum became.
    pub of: Vec<usize>,
}

/// Neighbours nearer than this share of the extent are in one place.
const TOGETHER: f64 = 1e-6;

/// Joins neighbours that are in one place: their mean, as far from it as all their tolerances allow.
///
/// # Errors
/// [`FairError::Coincident`] when no place is within the tolerances of both.
pub fn merged(points: &[Vec3<f64>], radii: &[f64], closed: bool) -> Result<Merged, FairError> {
    let first = points.first().copied().unwrap_or_default();
    let extent = points.iter().map(|p| (*p - first).norm()).fold(0.0, f64::max);
    let near = |a: usize, b: usize| (points[a] - points[b]).norm() <= TOGETHER * extent;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in 0..points.len() {
        match groups.last_mut() {
            Some(group) if near(group[0], k) => group.push(k),
            _ => groups.push(vec![k]),
        }
    }
    if closed && groups.len() > 1 && near(groups[0][0], points.len() - 1) {
        let last = groups.pop().expect("there are two");
        groups[0].extend(last);
    }
    let mut out = Merged { points: Vec::new(), radii: Vec::new(), of: vec![0; points.len()] };
    for (at, group) in groups.iter().enumerate() {
        let sum = group.iter().fold(Vec3::zero(), |s, &k| s + points[k]);
        let same = group.iter().all(|&k| points[k] == points[group[0]]);
        let middle = if same { points[group[0]] } else { sum * (1.0 / group.len() as f64) };
        let left = |&k: &usize| radii[k] - (points[k] - middle).norm();
        let radius = group.iter().map(left).fold(f64::INFINITY, f64::min);
        if radius < 0.0 {
            return Err(FairError::Coincident { first: group[0] });
        }
        group.iter().for_each(|&k| out.of[k] = at);
        out.points.push(middle);
        out.radii.push(radius);
    }
    Ok(out)
}

/// Solutions at most on the way to a goal.
const MOST_SOLUTIONS: usize = 60;

/// How many times the optimum's measure the data's own curve must have before anything moves, and
/// before it moves all the way.
const STAYS: f64 = 1.5;
const MOVES: f64 = 3.0;

/// How exactly budgets and shares are kept.
const GOAL_ACCURACY: f64 = 1e-7;

impl Data {
    /// The parts of the optimum that are the same for all weights of the data.
    fn parts<'a>(&self, options: &DataOptions, job: &'a Job) -> Result<Parts<'a>, FairError> {
        let layout = &self.layout;
        let radii = layout.radii(&self.limit.radii);
        let (mut frozen, mut conditions) = kept(job);
        for &m in &layout.marks {
            frozen[layout.control_of(m)] = true;
        }
        // A datum without tolerance stays on the curve.
        for k in (0..radii.len()).filter(|&k| radii[k] == 0.0) {
            let (columns, factors) = layout.rows.row(k);
            if columns.iter().all(|&c| frozen[c as usize]) {
                continue;
            }
            if let (&[c], &[_]) = (columns, factors) {
                frozen[c as usize] = true;
                continue;
            }
            for axis in crate::curve::condition::AXES {
                let entries: Vec<_> =
                    columns.iter().zip(factors).map(|(&c, &f)| (c as usize, axis * f)).collect();
                let mut condition = Condition { entries, value: 0.0 };
                condition.value = condition.at(&job.points);
                conditions.push(condition);
            }
        }
        let own = conditions.len();
        conditions.extend(options.conditions.iter().cloned());
        let mut rows = SparseRows::new();
        let mut own_radii = Vec::new();
        for k in (0..radii.len()).filter(|&k| radii[k] > 0.0) {
            let (columns, factors) = layout.rows.row(k);
            rows.push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()));
            own_radii.push(radii[k]);
        }
        let finite: Vec<f64> = radii.iter().map(|r| if r.is_finite() { *r } else { 0.0 }).collect();
        let reach = if radii.iter().all(|r| r.is_finite()) {
            layout.reach(&finite)?
        } else {
            vec![f64::INFINITY; job.points.len()]
        };
        Ok(Parts {
            points: &job.points,
            relative: job.points.clone(),
            centred: false,
            limit: &job.limit,
            measure: options.measure.rows(&layout.space)?,
            norm: options.measure.norm(),
            frozen,
            conditions,
            own,
            bounded: Bounded::Data(DataLimits {
                rows,
                radii: own_radii,
                offsets: Vec::new(),
                reach,
            }),
            pull: None,
            accuracy: options.accuracy,
        })
    }

    /// The data that pull, as rows of displacements over tolerances.
    fn pull(&self, parts: &Parts<'_>) -> SparseRows {
        let mut pull = SparseRows::new();
        for (k, owner) in self.layout.owner.iter().enumerate() {
            let Some(radius) = owner.map(|i| self.limit.radii[i]) else { continue };
            let (columns, factors) = self.layout.rows.row(k);
            let free = columns.iter().any(|&c| !parts.frozen[c as usize]);
            if free && radius > 0.0 && radius.is_finite() {
                let entries = columns.iter().zip(factors);
                pull.push(entries.map(|(&c, &f)| (c as usize, f / radius)));
            }
        }
        pull
    }

    /// The distances of the data from a curve at their parameters.
    pub fn residuals(&self, control: &[Vec3<f64>]) -> Vec<f64> {
        let mut out = vec![0.0; self.points.len()];
        for (k, owner) in self.layout.owner.iter().enumerate() {
            if let Some(i) = *owner {
                let off = (self.layout.rows.apply(k, control) - self.points[i]).norm();
                out[i] = f64::max(out[i], off);
            }
        }
        out
    }

    /// The curve through the data as a job with these limits' motion.
    fn job(&self) -> Result<Job, FairError> {
        let points = self.layout.through(&self.layout.data(&self.points))?;
        let limit = Limit { motion: self.limit.motion, radii: vec![f64::INFINITY; points.len()] };
        let (space, ends) = (self.layout.space.clone(), self.ends);
        Ok(Job { space, points, weights: None, limit, marks: Vec::new(), ends })
    }
}

impl Layout {
    /// The control point that a mark is.
    pub fn control_of(&self, site: usize) -> usize {
        let (columns, factors) = self.rows.row(site);
        let largest = (0..factors.len()).max_by(|&a, &b| factors[a].total_cmp(&factors[b]));
        columns[largest.expect("a row has entries")] as usize
    }
}

/// Fairs data.
///
/// # Errors
/// [`FairError`] when conditions contradict each other, or the goal does not go with the measure.
///
/// # Example
/// ```
/// use moldloft_fair::{Data, DataOptions, End, Goal, Layout, Limit, Measure, Spacing, fair_data,
///     parameters};
/// use moldloft_num::Vec3;
/// // A straight line at uneven stations, with one reading off by 0.01.
/// let stations = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0];
/// let off = |x: f64| if x == 4.0 { 0.01 } else { 0.0 };
/// let points: Vec<_> = stations.map(|x| Vec3::of(x, 0.1 * x + off(x), 0.0)).to_vec();
/// let at = parameters(&points, Spacing::Along(Vec3::of(1.0, 0.0, 0.0)), false).unwrap();
/// let data = Data {
///     limit: Limit::ball(points.len(), 0.02).unwrap(),
///     layout: Layout::new(3, &at, &[], false).unwrap(),
///     ends: [End::Free; 2],
///     points,
/// };
/// let options = DataOptions {
///     measure: Measure::Variation, goal: Goal::Fairest, conditions: Vec::new(), bends: true,
///     accuracy: 1e-9,
/// };
/// let faired = fair_data(&data, &options).unwrap();
/// assert!(faired.residuals.iter().all(|&r| r <= 0.02));
/// assert!(faired.certificate.value < 1e-12);
/// ```
pub fn fair_data(data: &Data, options: &DataOptions) -> Result<DataFit, FairError> {
    let job = data.job()?;
    let mut parts = data.parts(options, &job)?;
    let plain = data.along(options, &job, &mut parts, None)?;
    let higher = matches!(options.measure, Measure::Third | Measure::Variation);
    if options.bends || !higher {
        return Ok(plain);
    }
    // Third derivatives alone may buy smoothness with a bend; second derivatives do not. As much
    // of them is added as keeps the count.
    let bends = |points: &[Vec3<f64>]| shape::turns_back(&data.layout.space, points);
    let most = {
        let least =
            DataOptions { measure: Measure::Bending, goal: Goal::Fairest, ..options.clone() };
        let mut own = data.parts(&least, &job)?;
        bends(&data.along(&least, &job, &mut own, None)?.points)
    };
    if bends(&plain.points) <= most {
        return Ok(plain);
    }
    let stiff = Measure::Bending.rows(&data.layout.space)?;
    let third = parts.measure.clone();
    let (low, high) = (plain.certificate.value, stiff.sum_sq(&plain.points));
    let mut attempt = |log: f64| -> Result<DataFit, FairError> {
        let factor = (log.exp() * low.max(f64::MIN_POSITIVE) / high.max(f64::MIN_POSITIVE)).sqrt();
        parts.measure = third.clone().joined(&stiff.clone().scaled(factor));
        data.along(options, &job, &mut parts, Some(&third))
    };
    // From little to much, then back half-way as long as the count is kept.
    let step = 10f64.ln();
    let mut good: Option<(f64, DataFit)> = None;
    for k in -3..=5 {
        let log = f64::from(k) * step;
        let made = attempt(log)?;
        if bends(&made.points) <= most {
            good = Some((log, made));
            break;
        }
    }
    let Some((mut log, mut made)) = good else { return Ok(plain) };
    let mut low = log - step;
    for _ in 0..3 {
        let middle = 0.5 * (low + log);
        let trial = attempt(middle)?;
        if bends(&trial.points) <= most {
            (log, made) = (middle, trial);
        } else {
            low = middle;
        }
    }
    // What the count costs is part of the gap.
    made.certificate.gap = made.certificate.gap.max(made.certificate.value - plain.least);
    made.least = plain.least;
    Ok(made)
}

impl Data {
    /// The optimum of a goal by the rows of `parts`; its value by those of `counted`, where these are others.
    fn along(
        &self,
        options: &DataOptions,
        job: &Job,
        parts: &mut Parts<'_>,
        counted: Option<&SparseRows>,
    ) -> Result<DataFit, FairError> {
        let pull = self.pull(parts);
        let (rows, norm) = (parts.measure.clone(), parts.norm);
        let conditioned = !options.conditions.is_empty();
        let path = Path {
            energy: |points: &[Vec3<f64>]| crate::measure::value(&rows, norm, points),
            squares: |points: &[Vec3<f64>]| {
                let moved: Vec<_> = points.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
                pull.sum_sq(&moved)
            },
            count: pull.len(),
            noise: rounding(&rows, norm, &job.points),
            original: &job.points,
        };
        let found = path.follow(options.goal, norm, conditioned, |weight| {
            parts.pull = (weight > 0.0).then(|| pull.clone().scaled(weight.sqrt()));
            parts.solve()
        })?;
        let mut certificate = found.optimum.certificate;
        if let Some(rows) = counted {
            certificate.value = rows.sum_sq(&found.optimum.points);
        }
        Ok(DataFit {
            residuals: self.residuals(&found.optimum.points),
            used: found.used,
            least: found.least,
            weight: found.weight,
            certificate,
            iterations: found.optimum.iterations,
            active: found.optimum.active,
            points: found.optimum.points,
            original: job.points.clone(),
        })
    }
}

/// The measure that rounding of the points alone may leave.
pub(crate) fn rounding(rows: &SparseRows, norm: Norm, points: &[Vec3<f64>]) -> f64 {
    let of = |k: usize| {
        let (columns, factors) = rows.row(k);
        let size: f64 =
            columns.iter().zip(factors).map(|(&c, f)| f.abs() * points[c as usize].norm()).sum();
        let noise = 64.0 * f64::EPSILON * size;
        if norm == Norm::Square { noise * noise } else { noise }
    };
    (0..rows.len()).map(of).sum()
}

/// The way from the fairest curve to the data as their weight grows.
pub(crate) struct Path<'a, E, S> {
    /// The measure at points.
    pub energy: E,
    /// The sum of squared residuals over tolerances.
    pub squares: S,
    /// How many residuals these are.
    pub count: usize,
    /// What rounding leaves of the measure.
    pub noise: f64,
    pub original: &'a [Vec3<f64>],
}

/// Where the way ended.
pub(crate) struct Found {
    pub optimum: Optimum,
    pub used: f64,
    pub least: f64,
    pub weight: f64,
}

impl<E, S> Path<'_, E, S>
where
    E: Fn(&[Vec3<f64>]) -> f64,
    S: Fn(&[Vec3<f64>]) -> f64,
{
    /// The optimum of a goal. The sum of squares falls and the measure rises with the weight, both
    /// continuously, so the goal is found between two weights.
    pub fn follow(
        &self,
        goal: Goal,
        norm: Norm,
        conditioned: bool,
        mut solve: impl FnMut(f64) -> Result<Optimum, FairError>,
    ) -> Result<Found, FairError> {
        let mean = (self.count as f64 / 3.0).max(f64::MIN_POSITIVE);
        let begin = (self.energy)(self.original);
        if !conditioned && begin <= self.noise {
            // Nothing is left but rounding: not a bit moves.
            let certificate = Certificate { value: begin, gap: begin };
            let points = self.original.to_vec();
            let optimum = Optimum { points, certificate, iterations: 0, active: 0 };
            return Ok(Found { optimum, used: 0.0, least: begin, weight: f64::INFINITY });
        }
        let fairest = solve(0.0)?;
        let least = (self.energy)(&fairest.points);
        let squares = (self.squares)(&fairest.points);
        let ended = |optimum: Optimum, weight: f64| {
            let used = (self.squares)(&optimum.points) / mean;
            let value = (self.energy)(&optimum.points);
            let certificate = Certificate { value, ..optimum.certificate };
            Ok(Found { optimum: Optimum { certificate, ..optimum }, used, least, weight })
        };
        // Between the data's own curve and the optimum, by what there is to gain: both are within
        // the tolerances, and so is all between them.
        let settle = |optimum: Optimum, weight: f64| {
            let Goal::Near(_) = goal else { return ended(optimum, weight) };
            if conditioned {
                return ended(optimum, weight);
            }
            let value = (self.energy)(&optimum.points);
            let gain = begin / value.max(f64::MIN_POSITIVE);
            let share = ((gain - STAYS) / (MOVES - STAYS)).clamp(0.0, 1.0);
            let share = share * share * (3.0 - 2.0 * share);
            if share >= 1.0 {
                return ended(optimum, weight);
            }
            let between = |(p, q): (&Vec3<f64>, &Vec3<f64>)| {
                if share == 0.0 { *q } else { *q + (*p - *q) * share }
            };
            let points: Vec<_> = optimum.points.iter().zip(self.original).map(between).collect();
            let now = (self.energy)(&points);
            let gap = optimum.certificate.gap + (now - value).max(0.0);
            let certificate = Certificate { value: now, gap };
            let active = if share == 0.0 { 0 } else { optimum.active };
            ended(Optimum { points, certificate, active, ..optimum }, weight)
        };
        // What should be met: a falling function of the weight's logarithm, negative when met.
        let measured = |optimum: &Optimum| match goal {
            Goal::Fairest => -1.0,
            Goal::Budget(share) | Goal::Near(share) => {
                ((self.squares)(&optimum.points) / (share * mean)).ln()
            }
            Goal::Nearest(share) => {
                // Of curves near enough to the least the one nearest to the data: towards the data
                // the measure rises.
                (((1.0 + share) * least + self.noise) / (self.energy)(&optimum.points)).ln()
            }
        };
        match goal {
            Goal::Fairest => return ended(fairest, 0.0),
            Goal::Budget(share) | Goal::Near(share) => {
                if share.is_nan() || share <= 0.0 {
                    return Err(FairError::Goal("a budget is a positive share"));
                }
                if squares <= share * mean || norm != Norm::Square {
                    return settle(fairest, 0.0);
                }
            }
            Goal::Nearest(share) => {
                if share.is_nan() || share < 0.0 {
                    return Err(FairError::Goal("a share of the measure is 0 or more"));
                }
                if share == 0.0 || squares == 0.0 {
                    return ended(fairest, 0.0);
                }
                if !conditioned && begin <= (1.0 + share) * least + self.noise {
                    let certificate =
                        Certificate { value: begin, gap: begin - least + fairest.certificate.gap };
                    let optimum = Optimum {
                        points: self.original.to_vec(),
                        certificate,
                        active: 0,
                        ..fairest
                    };
                    return Ok(Found { optimum, used: 0.0, least, weight: f64::INFINITY });
                }
            }
        }
        if norm != Norm::Square {
            return Err(FairError::Goal(
                "a sum of lengths has neither budget nor share: take `fairest`",
            ));
        }
        // Between two weights by regula falsi on logarithms, the stale end halved (Illinois).
        let mut low = (f64::NEG_INFINITY, measured(&fairest));
        let mut high: Option<(f64, f64, Optimum)> = None;
        let mut trial = (least.max(1e-6 * begin) / squares).ln();
        let mut side = 0;
        let mut best: Option<(f64, f64, Optimum)> = None;
        for _ in 0..MOST_SOLUTIONS {
            let optimum = solve(trial.exp())?;
            let value = measured(&optimum);
            let better = best.as_ref().is_none_or(|b| value.abs() < b.1.abs());
            if better {
                best = Some((trial, value, optimum.clone()));
            }
            if value.abs() <= GOAL_ACCURACY {
                break;
            }
            if value > 0.0 {
                if side == 1
                    && let Some(h) = &mut high
                {
                    h.1 *= 0.5;
                }
                low = (trial, value);
                side = 1;
            } else {
                if side == -1 {
                    low.1 *= 0.5;
                }
                high = Some((trial, value, optimum));
                side = -1;
            }
            trial = match (&high, low.0.is_finite()) {
                (Some(h), true) => {
                    if h.0 - low.0 < 1e-12 {
                        break;
                    }
                    let share = low.1 / (low.1 - h.1);
                    low.0 + (h.0 - low.0) * share.clamp(0.01, 0.99)
                }
                (Some(h), false) => h.0 - 3.0,
                (None, _) => low.0 + 3.0,
            };
        }
        let (weight, _, optimum) = best.expect("one solution at least");
        settle(optimum, weight.exp())
    }
}
