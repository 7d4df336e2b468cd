//! The fairest curve within the limits, with a proof.

pub(crate) mod band;
pub(crate) mod certificate;
mod dual;
pub(crate) mod goal;
pub(crate) mod held;
mod interior_point;
mod polish;
pub(crate) mod problem;
mod schur;
mod second_order_cone;
mod squares_bound;
pub(crate) mod ties;

use crate::curve::condition::{AXES, across};
use crate::curve::job::EndContinuity;
use crate::{Certificate, Condition, FairError, Job, Limit, Measure, Motion, RowNorm, SparseRows};
pub(crate) use held::HeldDirections;
use moldloft_num::{Order, Real, Vec3};
use problem::{NormBounds, Problem, V};
use ties::Ties;

/// The quantity that the tolerance bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Each control point stays near its original place.
    ControlPoints,
    /// Each Bézier point of the displacement is bounded, which bounds the displacement of the curve
    /// everywhere and allows larger moves of control points.
    Bezier,
}

/// Options of the optimum.
#[derive(Clone, Debug, PartialEq)]
pub struct OptimumOptions {
    /// The measure to minimise.
    pub measure: Measure,
    /// The quantity that the tolerance bounds.
    pub bound: Bound,
    /// Conditions besides the ends.
    pub conditions: Vec<Condition>,
    /// The certified gap to reach, relative to the measure.
    pub accuracy: f64,
}

impl OptimumOptions {
    /// The defaults: the minimum of a measure with a ball round each control point, to a relative
    /// gap of 1e-9.
    pub fn of(measure: Measure) -> Self {
        Self { measure, bound: Bound::ControlPoints, conditions: Vec::new(), accuracy: 1e-9 }
    }
}

/// The fairest curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// The control points; fixed ones are unchanged to the bit.
    pub points: Vec<Vec3<f64>>,
    /// The measure, with the proven bound on the optimality gap.
    pub certificate: Certificate,
    /// Newton steps taken.
    pub iterations: usize,
    /// Number of limits reached.
    pub active: usize,
}

/// Reach of points without a tolerance, in extents.
pub(crate) const FAR: f64 = 10.0;

/// Relative gap to which the weight of a budget is determined.
const WEIGHED: f64 = 1e-8;

/// Relative gap that rounding may leave of very many conditions.
const NEARLY: f64 = 1e-4;

/// The frame that points move in: the directions that matter.
pub(crate) struct MotionAxes {
    pub axes: Vec<Vec3<f64>>,
    pub separate: bool,
}

impl MotionAxes {
    /// The frame of a motion; coordinates in which nothing varies are left out.
    pub fn of(motion: Motion, points: &[Vec3<f64>], conditions: &[Condition]) -> Self {
        let axes: Vec<Vec3<f64>> = match motion {
            Motion::Along(d) => vec![d],
            Motion::Across(d) => {
                let (a, b) = across(d);
                vec![a, b]
            }
            Motion::Ball | Motion::Box => AXES.to_vec(),
        };
        let varies = |a: &Vec3<f64>| {
            points.iter().any(|p| p.dot(*a) != points[0].dot(*a))
                || conditions.iter().any(|c| c.entries.iter().any(|(_, f)| f.dot(*a) != 0.0))
        };
        Self { axes: axes.into_iter().filter(varies).collect(), separate: motion == Motion::Box }
    }

    pub fn down(&self, v: Vec3<f64>) -> V {
        let mut out = [0.0; 3];
        for (o, a) in out.iter_mut().zip(&self.axes) {
            *o = v.dot(*a);
        }
        out
    }

    /// Directions in which points do not move, in the coordinates of the frame.
    pub fn held(&self, directions: &[(usize, Vec3<f64>)]) -> HeldDirections {
        HeldDirections::of(directions.iter().map(|&(i, d)| (i, self.down(d))).collect())
    }

    pub fn up(&self, v: V) -> Vec3<f64> {
        self.axes.iter().zip(v).fold(Vec3::zero(), |s, (a, c)| s + *a * c)
    }
}

/// The fairest curve within the limits of a job.
///
/// The result is a continuous function of the input, and the same bits whatever was computed
/// before. The certificate does not trust the solver: any curve within the limits, met conditions
/// included, measures at least `value - gap`.
///
/// # Errors
/// [`FairError::Contradiction`] when the conditions cannot hold within the limits; others as for
/// [`Job::check`].
///
/// # Example
/// ```
/// use moldloft_fair::{Job, Measure, OptimumOptions, optimum};
/// use moldloft_num::Vec3;
/// let bent = |i: i32| Vec3::of(f64::from(i), if i == 5 { 0.01 } else { 0.0 }, 0.0);
/// let job = Job::of_points(3, (0..11).map(bent).collect(), false, 0.02).unwrap();
/// let faired = optimum(&job, &OptimumOptions::of(Measure::Second)).unwrap();
/// assert!(faired.points[5].y.abs() < 1e-6);
/// ```
pub fn optimum(job: &Job, options: &OptimumOptions) -> Result<Optimum, FairError> {
    Parts::of(job, options)?.solve()
}

/// As `optimum`, for numbers that carry derivatives: `points` and `tolerances` (per control point)
/// have the real parts of the job, whose weights are constant, `targets` those of the values of the
/// options' conditions (empty when these are constant). Derivatives follow from the conditions of
/// optimality by the implicit function theorem; real parts are the bits of [`optimum`]. Factors of
/// conditions are taken as constant.
///
/// # Errors
/// As [`optimum`].
pub fn optimum_with<T: Real>(
    job: &Job,
    options: &OptimumOptions,
    points: &[Vec3<T>],
    tolerances: &[T],
    targets: &[T],
) -> Result<(Vec<Vec3<T>>, Optimum), FairError> {
    Parts::of(job, options)?.solve_with(points, tolerances, targets)
}

/// An optimum with all that its derivatives need.
pub(crate) struct Solved {
    pub frame: MotionAxes,
    pub problem: Problem,
    pub optimum: Optimum,
    pub solution: problem::CertifiedSolution,
}

impl Solved {
    /// True if it is known which limits are reached.
    pub fn is_decided(&self) -> bool {
        self.solution.active.is_some()
    }

    /// The limits of the problem that are reached; none where it is not known which.
    pub fn reached(&self) -> Option<Vec<usize>> {
        let groups = if self.problem.bounds.separate { self.problem.dimension } else { 1 };
        let active = self.solution.active.as_ref()?;
        Some(active.cones.iter().map(|&c| c as usize / groups).collect())
    }

    /// The forces of the limits on what they limit, one per limit of the problem.
    pub fn forces(&self) -> Vec<Vec3<f64>> {
        let groups = if self.problem.bounds.separate { self.problem.dimension } else { 1 };
        let force = |k: usize| {
            let own = &self.solution.cones[k * groups..(k + 1) * groups];
            own.iter().fold(Vec3::zero(), |s, (_, y)| s - self.frame.up(y.1))
        };
        (0..self.problem.bounds.rows.len()).map(force).collect()
    }
}

/// A half-space that control points stay in: the sum of factor . point is at most `most`.
#[derive(Clone, Debug)]
pub(crate) struct ControlInequality {
    pub entries: Vec<(usize, Vec3<f64>)>,
    pub most: f64,
    /// Index of the caller's shape condition.
    pub owner: usize,
}

/// The number of a condition, and by how much its factors change, point by point.
pub(crate) type Bend<T> = (usize, Vec<(usize, Vec3<T>)>);

/// The quantity that is limited.
#[derive(Clone)]
pub(crate) enum Bounded {
    /// Control points.
    ControlPoints,
    /// Bézier points of the displacement, and how far control points can move under them.
    Bezier(SparseRows, Vec<f64>),
    /// Data on the curve.
    Data(DataLimits),
}

/// Limits of the distances of data from the curve at their parameters.
#[derive(Clone)]
pub(crate) struct DataLimits {
    /// The values at the data's parameters over the control points.
    pub rows: SparseRows,
    /// A radius per row.
    pub radii: Vec<f64>,
    /// Distances of the original from the data; empty if it interpolates them.
    pub offsets: Vec<Vec3<f64>>,
    /// By how much each control point can move under these limits.
    pub reach: Vec<f64>,
}

/// The least of a measure under a bound on a sum of squares.
#[derive(Clone)]
pub(crate) struct BudgetOptimum {
    /// The weight of the squares beside the measure at which it is the least, too, nearly.
    pub weight: f64,
    pub optimum: Optimum,
    /// True if it is the optimum to rounding; else it is within the limits and near it.
    pub good: bool,
    /// True for half-spaces that are reached.
    pub pressed: Vec<bool>,
}

/// Data of the optimum of curves, nets and networks.
#[derive(Clone)]
pub(crate) struct Parts<'a> {
    pub points: &'a [Vec3<f64>],
    /// The points as the measure sees them.
    pub relative: Vec<Vec3<f64>>,
    pub limit: &'a Limit,
    pub measure: SparseRows,
    pub norm: RowNorm,
    pub frozen: Vec<bool>,
    /// Directions in which single points do not move.
    pub held: &'a [(usize, Vec3<f64>)],
    /// Points that move together.
    pub ties: Ties,
    pub conditions: Vec<Condition>,
    /// The number of the first conditions whose values are the same wherever the points move.
    pub rigid: usize,
    /// True if the measure is relative to the mean of the points, as of rational splines.
    pub centred: bool,
    /// The number of conditions that are not the caller's.
    pub own: usize,
    pub bounded: Bounded,
    pub halves: Vec<ControlInequality>,
    /// A pull towards the data, beside the measure: rows that measure displacements.
    pub pull: Option<SparseRows>,
    pub accuracy: f64,
    /// Start of a search, as displacements strictly inside the limits, from the positions of ties; these
    /// positions when empty.
    pub begin: Vec<Vec3<f64>>,
}

impl DataLimits {
    /// The limits that say something: neither infinite nor on points that do not move.
    pub fn used<'a>(&'a self, frozen: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
        (0..self.rows.len()).filter(|&k| {
            self.radii[k].is_finite() && self.rows.row(k).0.iter().any(|&c| !frozen[c as usize])
        })
    }
}

impl<'a> Parts<'a> {
    /// The parts of a curve.
    pub fn of(job: &'a Job, options: &OptimumOptions) -> Result<Self, FairError> {
        job.check()?;
        let (frozen, mut conditions) = kept(job);
        let own = conditions.len();
        conditions.extend(options.conditions.iter().cloned());
        let weights = job.weights.as_deref();
        Ok(Parts {
            points: &job.points,
            relative: job.relative(&job.points),
            centred: job.weights.is_some(),
            limit: &job.limit,
            measure: job.measure_rows(options.measure)?,
            norm: options.measure.norm(),
            frozen,
            held: &[],
            ties: Ties::default(),
            conditions,
            rigid: 0,
            own,
            bounded: match options.bound {
                Bound::ControlPoints => Bounded::ControlPoints,
                Bound::Bezier => {
                    Bounded::Bezier(job.space.bezier(weights), job.space.reach(weights))
                }
            },
            halves: Vec::new(),
            pull: None,
            accuracy: options.accuracy,
            begin: Vec::new(),
        })
    }

    /// The optimum.
    pub fn solve(&self) -> Result<Optimum, FairError> {
        let frame = MotionAxes::of(self.limit.motion, self.points, &self.conditions);
        let problem = self.problem(&frame);
        Ok(self.solved(&frame, &problem, None)?.0)
    }

    /// All equations, those of ties first.
    pub fn equations(&self) -> Vec<Condition> {
        self.ties.equations.iter().chain(&self.conditions).cloned().collect()
    }

    /// The optimum beginning at the solution of a problem that differs little, and its own solution.
    pub fn solve_after(
        &self,
        before: Option<&problem::CertifiedSolution>,
    ) -> Result<(Optimum, problem::CertifiedSolution), FairError> {
        let frame = MotionAxes::of(self.limit.motion, self.points, &self.conditions);
        let problem = self.problem(&frame);
        self.solved(&frame, &problem, before)
    }

    /// The least of the measure where the squares of `pull` are at most `most` in sum; none where the search does
    /// not end there.
    pub fn within(&self, pull: &SparseRows, most: f64) -> Result<Option<BudgetOptimum>, FairError> {
        let frame = MotionAxes::of(self.limit.motion, self.points, &self.conditions);
        let mut problem = self.problem(&frame);
        problem.squares = Some((self.ties.rows(pull.clone()), self.pulled(pull, &frame), most));
        let solution = problem::solve(&problem, WEIGHED, 0.0, 0.0, None)?;
        let (weight, met) = (solution.weight, solution.misses.iter().all(|&miss| miss <= 1e-7));
        if !(weight.is_normal() && weight > 0.0 && met) {
            return Ok(None);
        }
        let good = solution.gap <= NEARLY * solution.value;
        // Squares are solved as halves.
        let certificate = Certificate { value: 2.0 * solution.value, gap: 2.0 * solution.gap };
        let points = self.moved(&frame, &solution.x);
        self.check_halves(&solution, &points)?;
        let active = active(&problem, &solution);
        let optimum = Optimum { points, certificate, iterations: solution.iterations, active };
        Ok(Some(BudgetOptimum { weight, optimum, good, pressed: solution.pressed }))
    }

    /// The optimum with the numbers or their derivatives of `points`, `tolerances` (per control
    /// point) and `targets` (per condition of the caller's; empty when constant), whose real parts are those of the job. The real parts of the result are the bits of
    /// [`Parts::solve`].
    pub fn solve_with<T: Real>(
        &self,
        points: &[Vec3<T>],
        tolerances: &[T],
        targets: &[T],
    ) -> Result<(Vec<Vec3<T>>, Optimum), FairError> {
        self.solve_bent(points, tolerances, targets, &[])
    }

    /// The same where factors of conditions follow the points, too: `bends` are what they change by, for
    /// conditions of the caller's, with zero real parts.
    pub fn solve_bent<T: Real>(
        &self,
        points: &[Vec3<T>],
        tolerances: &[T],
        targets: &[T],
        bends: &[Bend<T>],
    ) -> Result<(Vec<Vec3<T>>, Optimum), FairError> {
        let frame = MotionAxes::of(self.limit.motion, self.points, &self.conditions);
        let problem = self.problem(&frame);
        let (optimum, solution) = self.solved(&frame, &problem, None)?;
        let solved = Solved { frame, problem, optimum, solution };
        let points = self.answer(&solved, points, tolerances, targets, bends, &[])?;
        Ok((points, solved.optimum))
    }

    /// The optimum with all that its derivatives need.
    pub fn whole(&self) -> Result<Solved, FairError> {
        let frame = MotionAxes::of(self.limit.motion, self.points, &self.conditions);
        let problem = self.problem(&frame);
        let (optimum, solution) = self.solved(&frame, &problem, None)?;
        Ok(Solved { frame, problem, optimum, solution })
    }

    /// How the optimum answers to changes; `forces` are changes of the slope of half the measure, with zero
    /// real parts (none when empty).
    pub fn answer<T: Real>(
        &self,
        solved: &Solved,
        points: &[Vec3<T>],
        tolerances: &[T],
        targets: &[T],
        bends: &[Bend<T>],
        forces: &[Vec3<T>],
    ) -> Result<Vec<Vec3<T>>, FairError> {
        let Solved { frame, problem, optimum, solution } = solved;
        let constant = |p: &Vec3<T>| p.to_array().iter().all(|c| c.is_constant());
        let fixed = |all: &[T]| all.iter().all(|t| t.is_constant());
        let still =
            points.iter().chain(forces).all(constant) && fixed(tolerances) && fixed(targets);
        if still {
            return Ok(optimum.points.iter().map(|&p| Vec3::lifted(p)).collect());
        }
        let change = |p: &Vec3<T>| *p - Vec3::lifted(p.re());
        let changes: Vec<Vec3<T>> = points.iter().map(change).collect();
        let middle = if self.centred {
            let sum = changes.iter().fold(Vec3::zero(), |s: Vec3<T>, c| s + *c);
            sum / T::from(points.len() as f64)
        } else {
            Vec3::zero()
        };
        let rows = &self.measure;
        let down = |v: Vec3<T>| {
            let mut out = [T::zero(); 3];
            for (o, a) in out.iter_mut().zip(&frame.axes) {
                *o = v.x * a.x + v.y * a.y + v.z * a.z;
            }
            out
        };
        let mut offsets: Vec<_> = (0..rows.len())
            .map(|k| {
                let (columns, factors) = rows.row(k);
                let entries = columns.iter().zip(factors);
                down(entries.fold(Vec3::zero(), |s, (&c, &f)| {
                    s + (changes[c as usize] - middle).map(|x| x * f)
                }))
            })
            .collect();
        offsets.resize(problem.measure.len(), [T::zero(); 3]);
        let limits = &problem.bounds.rows;
        let used: Vec<usize> = match &self.bounded {
            Bounded::Data(data) => data.used(&self.frozen).collect(),
            _ => Vec::new(),
        };
        let radii: Vec<T> = (0..limits.len())
            .map(|k| {
                if let Some(&own) = used.get(k) {
                    return tolerances[own] - T::from(tolerances[own].re());
                }
                // The tolerance that set this limit's radius: the first of the smallest.
                let near = limits.row(k).0.iter().map(|&c| c as usize);
                let set = near
                    .filter(|&c| self.limit.radii[c] > 0.0)
                    .reduce(|a, b| if self.limit.radii[b] < self.limit.radii[a] { b } else { a });
                set.map_or(T::zero(), |c| tolerances[c] - T::from(tolerances[c].re()))
            })
            .collect();
        // Kept values move with the points; targets do not.
        let value = |(k, condition): (usize, &Condition)| {
            if (self.rigid..self.own).contains(&k) {
                return T::zero();
            }
            let target = k.checked_sub(self.own).and_then(|k| targets.get(k));
            let aim = target.map_or(T::zero(), |&t| t - T::from(t.re()));
            condition.entries.iter().fold(aim, |aim, (i, f)| {
                let c = changes[*i];
                aim - (c.x * f.x + c.y * f.y + c.z * f.z)
            })
        };
        let mut values: Vec<T> = self.conditions.iter().enumerate().map(value).collect();
        // d(A x) = 0 and d(slope + nu A) = 0: both contain dA.
        let none = bends.is_empty() && forces.is_empty();
        let mut pushes = vec![[T::zero(); 3]; if none { 0 } else { points.len() }];
        for (push, force) in pushes.iter_mut().zip(forces) {
            *push = down(*force);
        }
        for (k, entries) in bends {
            let k = k + self.own;
            for (i, f) in entries {
                let p = optimum.points[*i];
                values[k] -= f.x * p.x + f.y * p.y + f.z * p.z;
                for (push, x) in pushes[*i].iter_mut().zip(down(*f)) {
                    *push += x * solution.nu[k];
                }
            }
        }
        let answers = problem::respond(problem, solution, &offsets, &radii, &values, &pushes)?;
        let faired = (0..points.len()).map(|i| {
            let mut p = Vec3::lifted(optimum.points[i]) + changes[i];
            for (a, x) in frame.axes.iter().zip(answers[i]) {
                p += Vec3::new(x * a.x, x * a.y, x * a.z);
            }
            // The answer's real part is zero; adding it must not touch a bit.
            p - Vec3::lifted(p.re() - optimum.points[i])
        });
        Ok(faired.collect())
    }

    fn solved(
        &self,
        frame: &MotionAxes,
        problem: &Problem,
        before: Option<&problem::CertifiedSolution>,
    ) -> Result<(Optimum, problem::CertifiedSolution), FairError> {
        // Gaps below the rounding of the measure are no gaps.
        let size = self.relative.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let noise = 4.0 * f64::EPSILON * size;
        let rows = problem.measure.len() as f64;
        let floor = match self.norm {
            RowNorm::Square => noise * noise * rows,
            RowNorm::Length => noise * rows,
        };
        // Positions round by half a unit in the last place of the largest coordinate, moves too.
        let margin = 4.0 * f64::EPSILON * self.points.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let solution = problem::solve(problem, self.accuracy, floor, margin, before)?;
        let points = self.moved(frame, &solution.x);
        let count = self.conditions.len();
        // NaN is missed.
        let met = |k: usize| solution.misses[k] <= 1e-7;
        let missed: Vec<usize> = (0..count).filter(|&k| !met(k)).collect();
        if !missed.is_empty() {
            let off = |k: &usize| {
                let condition = &self.conditions[*k];
                (condition.at(&points) - condition.value).abs()
            };
            let miss = missed.iter().map(off).fold(0.0, f64::max);
            let ends = missed.iter().any(|&k| k < self.own);
            let conditions = missed.into_iter().filter_map(|k| k.checked_sub(self.own)).collect();
            return Err(FairError::Contradiction { conditions, ends, miss });
        }
        self.check_halves(&solution, &points)?;
        // Squares are solved as halves.
        let unit = if self.norm == RowNorm::Square { 2.0 } else { 1.0 };
        let certificate = Certificate { value: unit * solution.value, gap: unit * solution.gap };
        let active = active(problem, &solution);
        let iterations = solution.iterations;
        Ok((Optimum { points, certificate, iterations, active }, solution))
    }

    /// Refuses a solution outside of a half-space.
    fn check_halves(
        &self,
        solution: &problem::CertifiedSolution,
        points: &[Vec3<f64>],
    ) -> Result<(), FairError> {
        let left: Vec<usize> = (0..self.halves.len())
            .filter(|&k| solution.outside[k].is_nan() || solution.outside[k] > 1e-9)
            .collect();
        if !left.is_empty() {
            let off = |k: &usize| {
                let half = &self.halves[*k];
                let sum: f64 = half.entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
                (*k, (sum - half.most) / half.entries.iter().map(|(_, f)| f.norm()).sum::<f64>())
            };
            let (_, miss) =
                left.iter().map(off).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
            let mut shapes: Vec<usize> = left.iter().map(|&k| self.halves[k].owner).collect();
            shapes.sort_unstable();
            shapes.dedup();
            return Err(FairError::Shape { shapes, miss });
        }
        Ok(())
    }

    fn moved(&self, frame: &MotionAxes, x: &[V]) -> Vec<Vec3<f64>> {
        let zero = |v: &V| v.iter().all(|&c| c == 0.0);
        let place = |(p, v): (Vec3<f64>, &V)| if zero(v) { p } else { p + frame.up(*v) };
        let begin = self.ties.shifted(self.points);
        let each = begin.into_iter().enumerate();
        each.map(|(i, p)| place((p, &x[self.ties.leader(i)]))).collect()
    }

    /// Values of rows that pull without a displacement; none without ties.
    fn pulled(&self, pull: &SparseRows, frame: &MotionAxes) -> Vec<V> {
        if self.ties.is_empty() {
            return Vec::new();
        }
        (0..pull.len()).map(|k| frame.down(pull.apply(k, &self.ties.shift))).collect()
    }

    /// The problem in the frame of its motion.
    pub fn problem(&self, frame: &MotionAxes) -> Problem {
        let (n, radii, frozen) = (self.points.len(), &self.limit.radii, &self.frozen);
        let (rows, ties) = (&self.measure, &self.ties);
        let (points, relative) = (ties.shifted(self.points), ties.shifted(&self.relative));
        let mut offsets: Vec<V> =
            (0..rows.len()).map(|k| frame.down(rows.apply(k, &relative))).collect();
        let mut measure = rows.clone();
        if let Some(pull) = &self.pull {
            // Displacements begin at zero.
            offsets.extend(self.pulled(pull, frame));
            offsets.resize(rows.len() + pull.len(), [0.0; 3]);
            measure = measure.joined(pull);
        }
        let corner = if frame.separate { (frame.axes.len() as f64).sqrt() } else { 1.0 };
        let mut reach: Vec<f64> = radii.iter().map(|r| r * corner).collect();
        let mut bounds = NormBounds { separate: frame.separate, ..NormBounds::none() };
        match &self.bounded {
            Bounded::ControlPoints => {
                bounds.direct = ties.is_empty();
                for i in (0..n).filter(|&i| !frozen[i] && radii[i].is_finite()) {
                    bounds.rows.push([(ties.leader(i), 1.0)]);
                    bounds.radii.push(radii[i]);
                    if !ties.is_empty() {
                        bounds.offsets.push(frame.down(ties.shift(i)));
                    }
                }
                if !bounds.radii.is_empty() {
                    // Without a bound on some there is no certificate.
                    let extent =
                        FAR * points.iter().map(|p| (*p - points[0]).norm()).fold(0.0, f64::max);
                    reach.iter_mut().filter(|r| r.is_infinite()).for_each(|r| *r = extent);
                }
                // From the positions of ties the moves of leaders are twice their tolerances at most.
                (0..ties.leader.len()).for_each(|i| reach[i] *= 2.0);
            }
            Bounded::Bezier(all, most) => {
                bounds.direct = false;
                for k in 0..all.len() {
                    let (columns, factors) = all.row(k);
                    let columns = || columns.iter().map(|&c| c as usize);
                    let near = columns().map(|c| radii[c]).filter(|&r| r > 0.0);
                    let radius = near.fold(f64::INFINITY, f64::min);
                    if radius.is_finite() && columns().any(|c| !frozen[c]) {
                        bounds.rows.push(columns().zip(factors.iter().copied()));
                        bounds.radii.push(radius);
                    }
                }
                let largest = radii.iter().copied().fold(0.0, f64::max);
                reach = most.iter().map(|r| r * largest * corner).collect();
            }
            Bounded::Data(data) => {
                bounds.direct = false;
                for k in data.used(frozen) {
                    let (columns, factors) = data.rows.row(k);
                    bounds
                        .rows
                        .push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()));
                    bounds.radii.push(data.radii[k]);
                    bounds.offsets.extend(data.offsets.get(k).map(|&o| frame.down(o)));
                }
                reach = data.reach.iter().map(|r| r * corner).collect();
            }
        }
        let held = frame.held(self.held);
        let moving = |entries: &[(usize, Vec3<f64>)]| -> Vec<(usize, V)> {
            let free = entries.iter().filter(|(i, _)| !frozen[*i]);
            ties.entries(free.map(|(i, f)| (*i, held.project(*i, frame.down(*f)))).collect())
        };
        let conditions = self
            .conditions
            .iter()
            .map(|c| problem::EqualityConstraint {
                entries: moving(&c.entries),
                value: c.value - c.at(&points),
            })
            .collect();
        let mean = {
            let finite = || bounds.radii.iter().filter(|r| r.is_finite());
            let count = finite().count();
            if count == 0 {
                1e-3 * self.points.iter().map(|p| (*p - self.points[0]).norm()).fold(0.0, f64::max)
            } else {
                finite().sum::<f64>() / count as f64
            }
        };
        let halves = self
            .halves
            .iter()
            .map(|h| {
                let entries = moving(&h.entries);
                let sum: f64 = h.entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
                let size = |v: &V| v.iter().map(|c| c * c).sum::<f64>().sqrt();
                let scale = mean * entries.iter().map(|(_, f)| size(f)).sum::<f64>();
                problem::InequalityConstraint { entries, room: h.most - sum, scale }
            })
            .collect();
        Problem {
            halves,
            squares: None,
            dimension: frame.axes.len(),
            measure: ties.rows(measure),
            norm: self.norm,
            offsets,
            bounds,
            frozen: (0..n).map(|i| frozen[i] || ties.leader(i) != i).collect(),
            held,
            conditions,
            refined: matches!(self.bounded, Bounded::Data(_)),
            reach,
            begin: self.begin.iter().map(|&v| frame.down(v)).collect(),
        }
    }
}

/// The limits that are reached.
fn active(p: &Problem, s: &problem::CertifiedSolution) -> usize {
    let groups = if p.bounds.separate { p.dimension } else { 1 };
    let mut count = 0;
    for k in 0..p.bounds.rows.len() {
        let (columns, factors) = p.bounds.rows.row(k);
        let mut sum = p.bounds.offset(k);
        for (&c, &a) in columns.iter().zip(factors) {
            for (q, x) in sum.iter_mut().zip(s.x[c as usize]) {
                *q += a * x;
            }
        }
        let r = p.bounds.radii[k];
        for g in 0..groups {
            let length = if p.bounds.separate {
                sum[g].abs()
            } else {
                sum.map(|q| q * q).iter().sum::<f64>().sqrt()
            };
            count += usize::from(length > r * (1.0 - 1e-4));
        }
    }
    count
}

/// Frozen points, and the conditions that keep the ends of a spline that is not clamped.
pub(crate) fn kept(job: &Job) -> (Vec<bool>, Vec<Condition>) {
    let mut conditions = Vec::new();
    let mut freer = job.clone();
    if !job.space.is_closed() && !job.space.is_clamped() {
        let (start, end) = job.space.domain();
        for (at, t) in [start, end].into_iter().enumerate() {
            for order in
                [Order::Zero, Order::First, Order::Second].into_iter().take(job.ends[at].kept())
            {
                let mut three = Condition::derivative(&job.space, t, order, Vec3::zero());
                for c in &mut three {
                    c.value = c.at(&job.points);
                }
                conditions.extend(three);
                freer.ends[at] = EndContinuity::Free;
            }
        }
    }
    (freer.frozen(), conditions)
}
