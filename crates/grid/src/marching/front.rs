//! The march of curves and surfaces: layers, sub-steps, and retries if cells fold.

use super::outcome::{FailureCause, MarchFailure, MarchPlace};
use super::report::Worst;
use super::settings::Hyperbolic;
use crate::GridError;
use moldloft_budget::Budget;
use moldloft_num::{Real, Vec3};

pub(super) struct MarchStep<'a, T> {
    /// The points, and those of the step before.
    pub r: &'a [Vec3<T>],
    pub before: &'a [Vec3<T>],
    /// The height of the step, that reached with it, and the last one.
    pub d: T,
    pub s: T,
    pub last: T,
    /// Smoothed relative to plain volumes, which may differ by at most the factor `cap`.
    pub smoothed: &'a mut [T],
    pub cap: Option<f64>,
    pub dissipation: f64,
    /// The step leaves the wall itself.
    pub first: bool,
}

/// The marched front: the unique points of a curve or a surface, with their neighbours.
pub(super) trait Front<T: Real> {
    fn wall(&self) -> &[Vec3<T>];
    /// The first layer along the bisecting normals, or `None` where corners are so tight that it has to be
    /// approached by steps.
    fn first_layer(&self, height: T) -> Result<Option<Vec<Vec3<T>>>, MarchFailure>;
    /// The largest step, and the node that limits it; `tight` is half the shortest edge anywhere.
    fn step_limit(&self, r: &[Vec3<T>], tight: bool) -> (f64, usize);
    /// True if steps can be longer than the tight limit.
    fn has_long_steps(&self) -> bool;
    fn mean_edge(&self, r: &[Vec3<T>]) -> f64;
    /// The points after a step.
    fn step(&self, step: MarchStep<'_, T>, budget: &Budget) -> Vec<Vec3<T>>;
    /// The least scaled Jacobian, and its cell, between two layers.
    fn worst_cell(&self, below: &[Vec3<T>], above: &[Vec3<T>]) -> Worst;
    fn place(&self, node: usize) -> MarchPlace;
    /// The place of a cell, and its first node.
    fn cell_place(&self, cell: usize) -> (MarchPlace, usize);
    /// Two nodes of the wall above which the boundary of these layers crosses itself.
    fn crossing(&self, layers: &[Vec<Vec3<T>>]) -> Option<[usize; 2]>;
}

/// The largest step, relative to the shortest edge: beyond it some corners of 45 to 60 degrees
/// fail.
pub(super) const EDGE_SHARE: f64 = 0.5;

/// The largest step, relative to the height reached.
const HEIGHT_SHARE: f64 = 0.15;

/// Between layers smoothed volumes change at most by this factor where lines do not converge.
const CAP: f64 = 1.15;

/// No march makes more steps.
const MOST_STEPS: usize = 40_000;

/// Settings of an attempt.
#[derive(Clone, Copy)]
struct Rung {
    /// Reported number.
    number: usize,
    tight: bool,
    cap: Option<f64>,
    dissipation: f64,
}

/// Successive settings: the standard ones, with long steps where lines do not converge; with short steps; without
/// the cap on volumes, as acute corners with clustered points need; and with more dissipation.
const LADDER: [Rung; 4] = [
    Rung { number: 1, tight: false, cap: Some(CAP), dissipation: 1.0 },
    Rung { number: 1, tight: true, cap: Some(CAP), dissipation: 1.0 },
    Rung { number: 2, tight: true, cap: None, dissipation: 1.0 },
    Rung { number: 3, tight: true, cap: None, dissipation: 3.0 },
];

pub(super) struct MarchOutcome<T> {
    pub layers: Vec<Vec<Vec3<T>>>,
    pub steps: usize,
    /// The rung of the ladder, from 1.
    pub rung: usize,
    /// Why it ended before the last height.
    pub failure: Option<MarchFailure>,
}

/// Marches on the rungs of the ladder until one reaches the last height; the farthest otherwise.
pub(super) fn march<T: Real>(
    front: &impl Front<T>,
    options: &Hyperbolic<T>,
    budget: &Budget,
) -> Result<MarchOutcome<T>, GridError> {
    let mut farthest: Option<MarchOutcome<T>> = None;
    for rung in LADDER.into_iter().filter(|rung| rung.tight || front.has_long_steps()) {
        let outcome = attempt(front, options, rung, budget)?;
        let first_fails = matches!(
            outcome.failure,
            Some(MarchFailure { cause: FailureCause::CornerTooTight { .. }, .. })
        );
        if outcome.failure.is_none() || first_fails {
            return below_crossing(front, outcome, budget);
        }
        if farthest.as_ref().is_none_or(|best| outcome.layers.len() > best.layers.len()) {
            farthest = Some(outcome);
        }
    }
    below_crossing(front, farthest.expect("the ladder has rungs"), budget)
}

/// The layers below the first one that meets another part of the grid.
fn below_crossing<T: Real>(
    front: &impl Front<T>,
    mut outcome: MarchOutcome<T>,
    budget: &Budget,
) -> Result<MarchOutcome<T>, GridError> {
    // Layers above one that crosses cross, too: the first is found by bisection.
    let (mut free, mut crossing) = (1, outcome.layers.len());
    let mut nodes = None;
    if crossing > 1 {
        nodes = front.crossing(&outcome.layers);
    }
    let Some(mut nodes) = nodes else { return Ok(outcome) };
    while crossing - free > 1 {
        budget.poll()?;
        let middle = usize::midpoint(free, crossing);
        match front.crossing(&outcome.layers[..middle]) {
            Some(found) => (crossing, nodes) = (middle, found),
            None => free = middle,
        }
    }
    outcome.layers.truncate(free);
    let [node, other] = nodes;
    let cause =
        FailureCause::LayersMeet { other: front.place(other), wall: front.wall()[other].re() };
    outcome.failure = Some(MarchFailure {
        layer: crossing,
        at: front.place(node),
        wall: front.wall()[node].re(),
        cause,
    });
    Ok(outcome)
}

fn attempt<T: Real>(
    front: &impl Front<T>,
    options: &Hyperbolic<T>,
    rung: Rung,
    budget: &Budget,
) -> Result<MarchOutcome<T>, GridError> {
    let heights = &options.heights;
    let mut outcome = MarchOutcome {
        layers: vec![front.wall().to_vec()],
        steps: 0,
        rung: rung.number,
        failure: None,
    };
    let mut r = front.wall().to_vec();
    let mut before = r.clone();
    let mut smoothed = vec![T::one(); r.len()];
    for k in 1..heights.len() {
        let failure = |node: usize, cause: FailureCause| MarchFailure {
            layer: k + 1,
            at: front.place(node),
            wall: front.wall()[node].re(),
            cause,
        };
        let folded = |worst: Worst| {
            let (at, node) = front.cell_place(worst.cell);
            let wall = front.wall()[node].re();
            MarchFailure { layer: k + 1, at, wall, cause: FailureCause::Folded(worst.jacobian) }
        };
        let target = heights[k] - heights[k - 1];
        if k == 1 {
            match front.first_layer(target) {
                Err(failure) => {
                    outcome.failure = Some(failure);
                    return Ok(outcome);
                }
                Ok(Some(layer)) => {
                    let worst = front.worst_cell(&r, &layer);
                    if !(worst.jacobian > 0.0) {
                        outcome.failure = Some(folded(worst));
                        return Ok(outcome);
                    }
                    before = std::mem::replace(&mut r, layer);
                    outcome.layers.push(r.clone());
                    outcome.steps += 1;
                    continue;
                }
                Ok(None) => {}
            }
        }
        let mut done = T::zero();
        while done.re() < target.re() * (1.0 - 1e-12) {
            budget.poll()?;
            let rest = target - done;
            let reached = heights[k - 1] + done;
            let (limit, node) = front.step_limit(&r, rung.tight);
            let mut most = limit.min(rest.re());
            let is_long = !rung.tight && front.step_limit(&r, true).0 < rest.re();
            if reached.re() > 0.0 && (most < rest.re() || is_long) {
                most = most.min(HEIGHT_SHARE * reached.re());
            }
            if !(most > 1e-9 * target.re()) {
                outcome.failure = Some(failure(node, FailureCause::LinesMeet));
                return Ok(outcome);
            }
            if outcome.steps >= MOST_STEPS {
                outcome.failure = Some(failure(node, FailureCause::TooManySteps(MOST_STEPS)));
                return Ok(outcome);
            }
            // The rest of the layer in equal steps; only their number depends on the lengths.
            let d = rest * (1.0 / (rest.re() / most - 1e-9).ceil());
            let share = (d.re() / target.re()).min(1.0);
            let step = MarchStep {
                r: &r,
                before: &before,
                d,
                s: reached + d,
                last: heights[heights.len() - 1],
                smoothed: &mut smoothed,
                cap: rung.cap.map(|cap| moldloft_num::Real::powf(cap, share)),
                dissipation: rung.dissipation * options.smoothing,
                first: reached.re() == 0.0,
            };
            let next = front.step(step, budget);
            budget.poll()?;
            if let Some(node) = next.iter().position(|p| !p.re().is_finite()) {
                outcome.failure = Some(failure(node, FailureCause::NotFinite));
                return Ok(outcome);
            }
            let worst = front.worst_cell(&r, &next);
            if !(worst.jacobian > 0.0) {
                outcome.failure = Some(folded(worst));
                return Ok(outcome);
            }
            before = std::mem::replace(&mut r, next);
            done += d;
            outcome.steps += 1;
        }
        let worst = front.worst_cell(&outcome.layers[k - 1], &r);
        if !(worst.jacobian > 0.0) {
            outcome.failure = Some(folded(worst));
            return Ok(outcome);
        }
        outcome.layers.push(r.clone());
    }
    Ok(outcome)
}
