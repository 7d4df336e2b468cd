//! KnotRemoval steps: knots are removed and re-inserted one at a time, the worst first.

use crate::indexed_heap::IndexedHeap;
use crate::optimum::certificate::ball_gap;
use crate::{FairError, Job, KnotJumps, Measure, RowNorm, SparseRows, shape};
use moldloft_num::{Real, Vec3};

/// Selection of the next knot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The knot whose point can make the longest move within its limit. Points at their limit are
    /// skipped, so the steps converge to the optimum.
    Achievable,
    /// The knot with the largest jump, as in the report of 1991. Once its point is at its limit,
    /// nothing moves any more: the loop stalls, usually long before the optimum.
    Literal,
}

/// Action of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemovalStep {
    /// Makes the knot's jump zero (Farin, Rein, Sapidis and Worsey 1987). On non-uniform knots a
    /// step is taken only if it lowers the measure.
    Knot,
    /// The measure is minimised over one control point. For [`Measure::Second`] on uniform cubics
    /// this is the same step.
    Vertex,
}

/// Conditions that end the steps. The first to hold is reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// Maximum number of steps.
    pub steps: usize,
    /// No move is longer than this fraction of the largest finite limit.
    pub least_move: f64,
    /// A step lowers the measure by less than this fraction of it.
    pub least_drop: f64,
    /// The certified gap, computed every n steps, is below this fraction of the measure.
    pub gap: f64,
    /// The number of pieces of monotone curvature, counted every n steps, does not decrease.
    pub pieces: bool,
}

impl Stops {
    /// At most `steps` steps.
    pub fn after(steps: usize) -> Self {
        Self { steps, least_move: 0.0, least_drop: 0.0, gap: 0.0, pieces: false }
    }
}

/// Reason why the steps ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// All allowed steps were made.
    Steps,
    /// The longest remaining move is short.
    Move,
    /// The measure decreases by less than `least_drop`.
    Drop,
    /// The certified gap is small.
    Gap,
    /// The number of monotone curvature pieces has not decreased for n steps.
    Pieces,
    /// The literal rule has chosen a point at its limit.
    Stalled,
    /// No point has a step left to make.
    Done,
}

impl Stopped {
    /// A word for reports.
    pub fn name(self) -> &'static str {
        match self {
            Stopped::Steps => "steps",
            Stopped::Move => "move",
            Stopped::Drop => "drop",
            Stopped::Gap => "gap",
            Stopped::Pieces => "pieces",
            Stopped::Stalled => "stalled",
            Stopped::Done => "done",
        }
    }
}

/// Options of local steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnotRemovalOptions {
    /// Selection of the next knot.
    pub rule: Rule,
    /// Action of one step.
    pub step: RemovalStep,
    /// The measure that [`RemovalStep::Vertex`] lowers and that the stop conditions use; a measure
    /// of squares.
    pub measure: Measure,
    /// When to end.
    pub stops: Stops,
    /// True to record the steps.
    pub log: bool,
}

impl KnotRemovalOptions {
    /// The faithful algorithm with `steps` steps.
    pub fn faithful(steps: usize) -> Self {
        Self {
            rule: Rule::Achievable,
            step: RemovalStep::Knot,
            measure: Measure::Second,
            stops: Stops::after(steps),
            log: false,
        }
    }
}

/// One step: a control point and its new position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The control point.
    pub index: u32,
    /// New position.
    pub to: Vec3<f64>,
}

/// Result of local steps.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotRemoval {
    /// The control points. Those not moved by any step are unchanged to the bit.
    pub points: Vec<Vec3<f64>>,
    /// The number of steps made.
    pub steps: usize,
    /// Why they ended.
    pub stopped: Stopped,
    /// Steps in order, if recorded; see [`replay`].
    pub log: Vec<Move>,
}

/// The points after the steps of a log: the same bits as [`KnotRemoval::points`].
pub fn replay(original: &[Vec3<f64>], log: &[Move]) -> Vec<Vec3<f64>> {
    let mut points = original.to_vec();
    for step in log {
        points[step.index as usize] = step.to;
    }
    points
}

/// One linear form per control point whose zero is the point's step, and who listens to whom.
pub(crate) struct PointSteps {
    /// Empty where a point has no step.
    pub rows: SparseRows,
    /// The factor of the point itself in its row.
    pub own: Vec<f64>,
    /// Row j: the points whose form contains point j.
    pub listeners: SparseRows,
}

impl PointSteps {
    /// The steps of `job` by `step`; frozen points have none.
    pub fn of(job: &Job, step: RemovalStep, measure: &SparseRows) -> Self {
        let n = job.points.len();
        let frozen = job.frozen();
        let mut rows = SparseRows::new();
        let mut own = vec![0.0; n];
        match step {
            RemovalStep::Vertex => {
                let gram = measure.gram(n);
                for (j, own) in own.iter_mut().enumerate() {
                    let (columns, factors) = gram.row(j);
                    let at = columns.iter().position(|&c| c as usize == j);
                    match at.filter(|&at| !frozen[j] && factors[at] > 0.0) {
                        Some(at) => {
                            *own = factors[at];
                            rows.push(
                                columns.iter().map(|&c| c as usize).zip(factors.iter().copied()),
                            );
                        }
                        None => rows.push([]),
                    }
                }
            }
            RemovalStep::Knot => {
                let jumps = KnotJumps::of(&job.space);
                let jump_rows = job.own_rows(&jumps.rows);
                let mut of_point = vec![usize::MAX; n];
                for (k, &j) in jumps.moved.iter().enumerate() {
                    if !frozen[j] && !job.crosses_mark(jumps.rows.row(k)) {
                        of_point[j] = k;
                    }
                }
                for j in 0..n {
                    if of_point[j] == usize::MAX {
                        rows.push([]);
                        continue;
                    }
                    let (columns, factors) = jump_rows.row(of_point[j]);
                    let at = columns.iter().position(|&c| c as usize == j);
                    own[j] = at.map_or(0.0, |at| factors[at]);
                    rows.push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()));
                }
            }
        }
        let listeners = rows.transposed(n);
        Self { rows, own, listeners }
    }

    /// Unconstrained target of point `j`, and the length of its form.
    #[inline(always)]
    fn wanted(&self, j: usize, points: &[Vec3<f64>], origin: Vec3<f64>) -> (Vec3<f64>, f64) {
        if self.own[j] == 0.0 {
            return (points[j], 0.0);
        }
        let (columns, factors) = self.rows.row(j);
        let mut form = Vec3::zero();
        for (&c, &a) in columns.iter().zip(factors) {
            let p = points[c as usize] - origin;
            form += Vec3::of(a * p.x, a * p.y, a * p.z);
        }
        (points[j] - form * (1.0 / self.own[j]), form.norm())
    }
}

/// Weight of the unconstrained move in the comparison of almost equal moves.
const TIE: f64 = 1e-6;

/// Makes local steps.
///
/// Cost: O(log n) per step. The result is reproducible but jumps where two knots tie: a small
/// change of the input may change which knot comes first. [`crate::optimum`] is continuous.
///
/// # Errors
/// [`FairError`] when the measure does not exist for the degree.
pub fn knot_removal(job: &Job, options: &KnotRemovalOptions) -> Result<KnotRemoval, FairError> {
    knot_removal_from(job, job.points.clone(), options)
}

/// Makes local steps from points that may have moved before: limits are measured from the original
/// of the job, across all passes.
///
/// # Errors
/// As [`knot_removal`].
pub fn knot_removal_from(
    job: &Job,
    from: Vec<Vec3<f64>>,
    options: &KnotRemovalOptions,
) -> Result<KnotRemoval, FairError> {
    job.check()?;
    if from.len() != job.points.len() {
        let (expected, actual) = (job.points.len(), from.len());
        return Err(FairError::Count { what: "control points", expected, actual });
    }
    let n = job.points.len();
    let rows = job.measure_rows(options.measure)?;
    let steps = PointSteps::of(job, options.step, &rows);
    // If the step is not the minimiser of the measure, each step is checked to decrease it.
    let check = match options.step {
        RemovalStep::Knot if !job.space.is_uniform() || job.weights.is_some() => {
            Some(PointSteps::of(job, RemovalStep::Vertex, &rows))
        }
        _ => None,
    };
    let origin = job.origin();
    let mut points = from;
    let place = |j: usize, points: &[Vec3<f64>]| {
        let (wanted, form) = steps.wanted(j, points, origin);
        (job.limit.nearest(j, job.points[j], points[j], wanted), form)
    };
    let drop = |j: usize, points: &[Vec3<f64>], to: Vec3<f64>| {
        let by = check.as_ref().unwrap_or(&steps);
        if by.own[j] == 0.0 {
            return 0.0;
        }
        let (free, _) = by.wanted(j, points, origin);
        by.own[j] * ((points[j] - free).norm_sq() - (to - free).norm_sq())
    };
    let key = |j: usize, points: &[Vec3<f64>]| {
        if steps.own[j] == 0.0 {
            return 0.0;
        }
        let (to, form) = place(j, points);
        match options.rule {
            Rule::Literal => form,
            Rule::Achievable if check.is_some() && drop(j, points, to) <= 0.0 => 0.0,
            // Points that are wanted beyond their limits tie: the one comes first that wants to go farther,
            // and not the one that rounding prefers.
            Rule::Achievable => {
                let length = (to - points[j]).norm();
                let free = form / steps.own[j].abs();
                if length == 0.0 { 0.0 } else { length * (1.0 + TIE * free / (free + length)) }
            }
        }
    };
    let mut heap = IndexedHeap::new((0..n).map(|j| key(j, &points)).collect());
    let stops = &options.stops;
    // Moves below the rounding of the coordinates are no moves.
    let size = job.points.iter().map(|p| (*p - origin).norm()).fold(0.0, f64::max);
    let radius = job.limit.radii.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    let least = (stops.least_move * radius).max(4.0 * f64::EPSILON * size);
    let watch = stops.gap > 0.0 || stops.pieces;
    let relative = |p: &[Vec3<f64>]| job.relative(p);
    let mut total = if stops.least_drop > 0.0 { rows.sum_sq(&relative(&points)) } else { 0.0 };
    let mut pieces = if stops.pieces { shape::pieces(&job.space, &points) } else { 0 };
    let mut log = Vec::new();
    let mut done = 0;
    let stopped = loop {
        if done == stops.steps {
            break Stopped::Steps;
        }
        let Some((j, top)) = heap.top() else { break Stopped::Done };
        if top == 0.0 {
            break Stopped::Done;
        }
        if watch && done > 0 && done % n == 0 {
            if stops.gap > 0.0 {
                let gap = ball_gap(job, &rows, RowNorm::Square, &points);
                if gap.gap <= stops.gap * gap.value {
                    break Stopped::Gap;
                }
            }
            if stops.pieces {
                let now = shape::pieces(&job.space, &points);
                if now >= pieces {
                    break Stopped::Pieces;
                }
                pieces = now;
            }
        }
        let (to, _) = place(j, &points);
        let length = (to - points[j]).norm();
        if length <= least {
            break match options.rule {
                Rule::Literal => Stopped::Stalled,
                Rule::Achievable => Stopped::Move,
            };
        }
        if options.rule == Rule::Literal && check.is_some() && drop(j, &points, to) <= 0.0 {
            break Stopped::Stalled;
        }
        if stops.least_drop > 0.0 {
            let lower = drop(j, &points, to);
            if lower < stops.least_drop * total {
                break Stopped::Drop;
            }
            total -= lower;
        }
        points[j] = to;
        done += 1;
        if options.log {
            log.push(Move { index: j as u32, to });
        }
        let (listeners, _) = steps.listeners.row(j);
        for &i in listeners {
            heap.set(i as usize, key(i as usize, &points));
        }
        if let Some(check) = &check {
            // A knot that may not move now may move when the measure's slope there has changed.
            for &i in check.listeners.row(j).0 {
                heap.set(i as usize, key(i as usize, &points));
            }
        }
    };
    Ok(KnotRemoval { points, steps: done, stopped, log })
}

/// A fixed number of sweeps over all points in order; each point moves to its constrained
/// minimiser. Continuous in the input, and faster than ranked steps for bulk work. Points at least
/// a stencil width apart are independent, so the sweep runs colour by colour and could use threads
/// with the same bits.
///
/// # Errors
/// [`FairError`] when the measure does not exist for the degree.
pub fn sweeps(job: &Job, measure: Measure, count: usize) -> Result<Vec<Vec3<f64>>, FairError> {
    job.check()?;
    let n = job.points.len();
    let rows = job.measure_rows(measure)?;
    let steps = PointSteps::of(job, RemovalStep::Vertex, &rows);
    let origin = job.origin();
    let mut points = job.points.clone();
    let widest = (0..n).map(|j| steps.rows.row(j).0.len()).max().unwrap_or(1);
    let colours = widest.div_ceil(2).max(1);
    for _ in 0..count {
        for colour in 0..colours {
            for j in (colour..n).step_by(colours) {
                if steps.own[j] != 0.0 {
                    let (wanted, _) = steps.wanted(j, &points, origin);
                    points[j] = job.limit.nearest(j, job.points[j], points[j], wanted);
                }
            }
        }
    }
    Ok(points)
}

/// The points after the steps of a log, for numbers that carry derivatives: the same points move in
/// the same order, and their moves follow the input. Real parts are the bits of the log.
///
/// # Errors
/// [`FairError`] as for [`knot_removal`].
pub fn replay_with<T: Real>(
    job: &Job,
    options: &KnotRemovalOptions,
    log: &[Move],
    points: &[Vec3<T>],
    tolerances: &[T],
) -> Result<Vec<Vec3<T>>, FairError> {
    replay_from_with(job, options, log, points, points, tolerances)
}

/// As `replay_with`, for steps that began at `from`; see [`knot_removal_from`].
///
/// # Errors
/// As [`replay_with`].
pub fn replay_from_with<T: Real>(
    job: &Job,
    options: &KnotRemovalOptions,
    log: &[Move],
    from: &[Vec3<T>],
    points: &[Vec3<T>],
    tolerances: &[T],
) -> Result<Vec<Vec3<T>>, FairError> {
    let rows = job.measure_rows(options.measure)?;
    let steps = PointSteps::of(job, options.step, &rows);
    let mut now = from.to_vec();
    for step in log {
        let j = step.index as usize;
        let (columns, factors) = steps.rows.row(j);
        let entries = columns.iter().zip(factors);
        let form: Vec3<T> =
            entries.fold(Vec3::zero(), |s, (&c, &a)| s + now[c as usize].map(|x| x * a));
        let wanted = now[j] - form.map(|x| x / steps.own[j]);
        let moved = points[j] + job.limit.motion.allowed(wanted - points[j], tolerances[j]);
        now[j] = moved + Vec3::lifted(step.to - moved.re());
        // The sum may round in the last bit: the log decides.
        let off = step.to - now[j].re();
        now[j] += Vec3::lifted(off);
    }
    Ok(now)
}
