//! Networks line by line: each curve weighed by itself, with no more changes of curvature than its
//! points ask for.
//!
//! The sum of a measure over all curves is nearly all that of a few hard spots, so that these would
//! decide for all. Each curve counts by what it has left of its own measure instead. And third
//! differences buy smoothness with a bend: where a curve bends more often than the fewest changes
//! that fit within the tolerance, the signs of its second divided differences are held.

use super::line_patterns::ValueTube;
use super::shapes::EquationSpan;
use crate::curve::moving::MovingRows;
use crate::optimum::goal::{
    Adaptation, Goal, GoalOptimum, GoalVariation, RegularizationPath, check_decided, check_unique,
    moved, rounding,
};
use crate::optimum::{Bend, BudgetOptimum, ControlInequality, Parts};
use crate::{Certificate, Condition, FairError, Measure, Motion, Network, RowNorm, SparseRows};
use moldloft_num::{Real, Vec3};

/// The fewest points of a line that has changes of curvature.
const FEWEST_POINTS: usize = 5;

/// The share of the measure that noise of the tolerances has below which lines are alike.
const ALIKE: f64 = 1e-3;

/// Rounds of weights.
const ROUNDS: usize = 3;

/// Budgets, in the goal's own, that are tried where signs leave none within it.
const WIDER: [f64; 3] = [1.0, 1.5, f64::INFINITY];

/// By how much a sign may be left, as a share of what the tolerances let it vary.
const LEFT: f64 = 1e-9;

/// The same share below which a second difference has no sign.
const STRAIGHT: f64 = 1e-6;

/// The sign of the second difference of three neighbours on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeldSign {
    line: usize,
    /// The place of the first of the three on the line.
    first: usize,
    sign: f64,
}

/// The factors of three points whose sum a sign keeps from being positive.
fn sign_factors<T: Real>(sign: f64, at: &[T]) -> [T; 3] {
    let (h, g) = (at[1] - at[0], at[2] - at[1]);
    let unit = if h.re() < g.re() { h } else { g };
    [T::one() / h, -T::one() / h - T::one() / g, T::one() / g].map(|f| f * unit * -sign)
}

/// The optimum at one set of weights.
pub(super) struct LineRound<'a> {
    /// The weighed problem, with the signs that are reached as conditions.
    parts: Parts<'a>,
    pub found: GoalOptimum,
    /// The signs that are reached, in the order of their conditions.
    reached: Vec<HeldSign>,
    /// The roots of the lines' weights.
    scales: Vec<f64>,
    /// The budget of squares in the goal's own; infinite for the fairest.
    wider: f64,
    /// Whether it is known which signs are reached.
    decided: bool,
}

/// What all rounds have in common.
struct LineFairing<'a> {
    network: &'a Network,
    pull: &'a SparseRows,
    /// The budget of squares; none for the fairest.
    share: Option<f64>,
    /// The signs of the fewest changes of each line, and whether they are held.
    signs: Vec<(Vec<HeldSign>, bool)>,
    /// The half-spaces of the network's own conditions, whose owners come after the lines.
    asked: Vec<ControlInequality>,
}

impl Network {
    /// Whether it is one of curves through points, which have measures of their own.
    pub(super) fn has_lines(&self, norm: RowNorm) -> bool {
        self.patches.is_empty()
            && norm == RowNorm::Square
            && self.strands.iter().all(|s| s.at.is_some() && s.weights.is_none())
    }

    /// The direction in which the points of line `k` move, where it is one.
    fn way(&self, k: usize) -> Option<Vec3<f64>> {
        match self.limit.motion {
            Motion::Along(d) => Some(d),
            _ => self.ways.get(k).copied().flatten(),
        }
    }

    /// The measure of line `k`, in the directions in which its points move.
    fn line_value<T: Real>(&self, k: usize, rows: &MovingRows<T>, points: &[Vec3<T>]) -> T {
        let way = self.way(k);
        let square = |r: usize| {
            let e = rows.apply(r, points);
            way.map_or_else(
                || e.norm_sq(),
                |d| {
                    let along = e.x * d.x + e.y * d.y + e.z * d.z;
                    along * along
                },
            )
        };
        (0..rows.rows.len()).fold(T::zero(), |sum, r| sum + square(r))
    }

    /// What lines that are alike have of their measure: a share of the squares of noise of the
    /// tolerances.
    fn line_floor<T: Real>(&self, rows: &MovingRows<T>, frozen: &[bool], tolerances: &[T]) -> T {
        let moves = |c: usize| !frozen[c] && tolerances[c].re().is_finite();
        let entries = rows.rows.iter().flatten().filter(|&&(c, _)| moves(c));
        let squares = entries.fold(T::zero(), |sum, &(c, f)| {
            let x = f * tolerances[c];
            sum + x * x
        });
        squares * (ALIKE / 3.0)
    }

    /// The rows of line `k` at parameters that may carry derivatives, or at its own.
    fn moving_rows<T: Real>(
        &self,
        k: usize,
        measure: Measure,
        at: Option<&Vec<T>>,
    ) -> Result<MovingRows<T>, FairError> {
        let rows = match at {
            Some(at) => {
                let own = self.strands[k].divided(measure, at).into_iter();
                let placed = |(c, f)| (self.strands[k].points[c], f);
                own.map(|row| row.into_iter().map(placed).collect()).collect()
            }
            None => {
                let own = self.own_rows(k, measure)?;
                let row = |r| {
                    let (c, f) = own.row(r);
                    c.iter().zip(f).map(|(&c, &f)| (c as usize, T::from(f))).collect()
                };
                (0..own.len()).map(row).collect()
            }
        };
        Ok(MovingRows { rows })
    }

    /// The rows of all lines; see [`Network::moving_rows`].
    pub(super) fn all_moving_rows<T: Real>(
        &self,
        measure: Measure,
        ats: &[Option<Vec<T>>],
    ) -> Result<Vec<MovingRows<T>>, FairError> {
        let of = |k: usize| self.moving_rows(k, measure, ats.get(k).and_then(Option::as_ref));
        (0..self.strands.len()).map(of).collect()
    }

    /// The signs of the fewest changes of line `k` between its breaks.
    fn line_signs(&self, k: usize, frozen: &[bool]) -> Vec<HeldSign> {
        let (strand, Some(way)) = (&self.strands[k], self.way(k)) else { return Vec::new() };
        let Some(at) = strand.at.as_ref().filter(|_| !strand.space.is_closed()) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut bounds = vec![0];
        bounds.extend(strand.marks.iter().chain(strand.runs.iter().flatten()).copied());
        bounds.push(strand.points.len() - 1);
        bounds.sort_unstable();
        bounds.dedup();
        for pair in bounds.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let straight = strand.runs.iter().any(|run| run[0] <= from && to <= run[1]);
            if straight || to - from + 1 < FEWEST_POINTS {
                continue;
            }
            let own = &strand.points[from..=to];
            let values: Vec<f64> = own.iter().map(|&i| way.dot(self.points[i])).collect();
            let extent = self.extent();
            let room = |&i: &usize| if frozen[i] { 0.0 } else { self.limit.radii[i].min(extent) };
            let rooms: Vec<f64> = own.iter().map(room).collect();
            if rooms.iter().all(|&r| r == 0.0 || r == extent) {
                continue;
            }
            let tube = ValueTube { at: &at[from..=to], values: &values, rooms: &rooms };
            for (j, sign) in tube.fewest().into_iter().flatten().enumerate() {
                let held = HeldSign { line: k, first: from + j, sign };
                let moves = own[j..j + 3].iter().any(|&i| !frozen[i]);
                if sign != 0.0 && moves {
                    out.push(held);
                }
            }
        }
        out
    }

    /// The entries of a sign over the network's points, at parameters that may carry derivatives.
    fn sign_entries<T: Real>(&self, held: &HeldSign, at: &[T]) -> Vec<(usize, Vec3<T>)> {
        let way = self.way(held.line).unwrap_or_default();
        let places = held.first..held.first + 3;
        let ids = &self.strands[held.line].points[places.clone()];
        let factors = sign_factors(held.sign, &at[places]);
        let along = |f: T| Vec3::new(f * way.x, f * way.y, f * way.z);
        ids.iter().zip(factors).map(|(&i, f)| (i, along(f))).collect()
    }

    /// A sign as a half-space.
    fn sign_half(&self, held: &HeldSign) -> ControlInequality {
        let strand = &self.strands[held.line];
        let at = strand.at.as_deref().unwrap_or_default();
        // Against rounding of exact runs.
        let size = strand.points.iter().map(|&i| self.points[i].norm()).fold(0.0, f64::max);
        let most = 16.0 * f64::EPSILON * size;
        ControlInequality { entries: self.sign_entries(held, at), most, owner: held.line }
    }

    /// By how much points leave a sign, as a share of what the tolerances let it vary.
    fn off(&self, held: &HeldSign, points: &[Vec3<f64>]) -> f64 {
        let half = self.sign_half(held);
        let sum: f64 = half.entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
        let extent = self.extent();
        let room = |i: usize| self.limit.radii[i].min(extent);
        let varies: f64 = half.entries.iter().map(|(i, f)| f.norm() * room(*i)).sum();
        (sum - half.most) / varies.max(f64::MIN_POSITIVE)
    }

    /// Whether line of these signs has more changes at points than they have.
    fn bends_more(&self, signs: &[HeldSign], points: &[Vec3<f64>]) -> bool {
        let parts = signs.chunk_by(|a, b| b.first <= a.first + 2);
        let changes = |signs: Vec<f64>| signs.windows(2).filter(|w| w[0] != w[1]).count();
        let mut more = false;
        for part in parts {
            let own = changes(part.iter().map(|s| s.sign).collect());
            let off = part.iter().map(|s| (s.sign, self.off(s, points)));
            let bent = off.filter(|(_, off)| off.abs() > STRAIGHT);
            more |= changes(bent.map(|(sign, off)| -sign * off.signum()).collect()) > own;
        }
        more
    }

    /// The rounds of weights, the last of which is the result: the fairest within the limits, or under
    /// a budget, a share of what noise of the tolerances has of the squares.
    pub(super) fn by_lines<'a>(
        &'a self,
        parts: &Parts<'a>,
        measure: Measure,
        pull: &SparseRows,
        share: Option<f64>,
    ) -> Result<Vec<LineRound<'a>>, FairError> {
        let count = self.strands.len();
        let own = self.all_moving_rows::<f64>(measure, &[])?;
        let floor = |rows| self.line_floor(rows, &parts.frozen, &self.limit.radii);
        let floors: Vec<f64> = own.iter().map(floor).collect();
        let span = EquationSpan::of(self, &parts.conditions);
        let signs_of = |k: usize| {
            let mut signs = self.line_signs(k, &parts.frozen);
            signs.retain(|held| !span.determines(&self.sign_half(held).entries));
            (signs, false)
        };
        let signs = (0..count).map(signs_of).collect();
        let asked = parts.halves.clone();
        let mut fairing = LineFairing { network: self, pull, share, signs, asked };
        let value = |(k, rows)| self.line_value(k, rows, &self.points);
        let whole: f64 = own.iter().enumerate().map(value).sum();
        let mut rounds: Vec<LineRound<'a>> = Vec::new();
        for _ in 0..ROUNDS {
            let points = rounds.last().map_or(&self.points, |r| &r.found.optimum.points);
            let weight = |k: usize| {
                let left = self.line_value(k, &own[k], points).max(floors[k]);
                whole / (count as f64 * left.max(f64::MIN_POSITIVE))
            };
            let scales: Vec<f64> = (0..count).map(|k| weight(k).sqrt()).collect();
            let mut measure = SparseRows::new();
            for (own, scale) in own.iter().zip(&scales) {
                for row in &own.rows {
                    measure.push(row.iter().map(|&(c, f)| (c, f * scale)));
                }
            }
            let round = fairing.round(&Parts { measure, ..parts.clone() })?;
            rounds.push(LineRound { scales, ..round });
        }
        Ok(rounds)
    }

    /// The result of the rounds with derivatives; `allowed` is the budget in what noise has of the
    /// squares, as it changes.
    pub(super) fn lines_moved<T: Real>(
        &self,
        rounds: &[LineRound<'_>],
        (pull, owners): (&SparseRows, &[usize]),
        allowed: T,
        numbers: &LineNumbers<'_, T>,
    ) -> Result<Vec<Vec3<T>>, FairError> {
        let LineNumbers { points, tolerances, rows, ats } = *numbers;
        let frozen = self.frozen();
        let floors: Vec<T> =
            rows.iter().map(|rows| self.line_floor(rows, &frozen, tolerances)).collect();
        let mean = owners.len() as f64 / 3.0;
        let mut now = points.to_vec();
        for round in rounds {
            if !round.decided {
                return Err(FairError::NoDerivative(
                    "which changes of curvature the network keeps from is not decided to rounding, so \
                     its derivatives are not known: take the goal \"budget\"",
                ));
            }
            if round.found.share == 0.0 {
                now = points.to_vec();
                continue;
            }
            let mut weighed = MovingRows { rows: Vec::new() };
            for (k, (own, floor)) in rows.iter().zip(&floors).enumerate() {
                let left = self.line_value(k, own, &now);
                let left = if left.re() < floor.re() { *floor } else { left };
                // What is next to nothing weighs what it does.
                let change = if left.re() > 0.0 { left / left.re() } else { T::one() };
                let scale = T::from(round.scales[k]) / change.sqrt();
                let scaled =
                    own.rows.iter().map(|r| r.iter().map(|&(c, f)| (c, f * scale)).collect());
                weighed.rows.extend(scaled);
            }
            let mut parts = round.parts.clone();
            check_unique(&mut parts, &round.found, pull)?;
            parts.pull =
                (round.found.weight > 0.0).then(|| pull.clone().scaled(round.found.weight.sqrt()));
            let solved = parts.whole()?;
            check_decided(&round.found, &solved)?;
            let slope = weighed.slope(&solved.optimum.points);
            let forces = slope.into_iter().map(|v| v - Vec3::lifted(v.re())).collect();
            let first = parts.conditions.len() - round.reached.len();
            let bend = |(j, held): (usize, &HeldSign)| -> Bend<T> {
                let Some(at) = ats.get(held.line).and_then(Option::as_ref) else {
                    return (first + j, Vec::new());
                };
                let change = |(i, f): (usize, Vec3<T>)| (i, f - Vec3::lifted(f.re()));
                (first + j, self.sign_entries(held, at).into_iter().map(change).collect())
            };
            let bends: Vec<Bend<T>> = round.reached.iter().enumerate().map(bend).collect();
            let moving = GoalVariation {
                originals: points.to_vec(),
                tolerances,
                pulled: owners.iter().map(|&i| tolerances[i]).collect(),
                targets: &[],
                forces,
                rows: &weighed,
                bends: &bends,
                budget: allowed * (round.wider * mean),
                start: points,
            };
            now = moved(&parts, &solved, Goal::Budget(allowed.re()), &round.found, pull, moving)?;
        }
        Ok(now)
    }
}

/// The numbers of a network that carry derivatives.
pub(super) struct LineNumbers<'a, T> {
    pub points: &'a [Vec3<T>],
    pub tolerances: &'a [T],
    /// The rows of each line.
    pub rows: &'a [MovingRows<T>],
    pub ats: &'a [Option<Vec<T>>],
}

impl LineFairing<'_> {
    fn squares(&self, points: &[Vec3<f64>]) -> f64 {
        let original = &self.network.points;
        let moved: Vec<_> = points.iter().zip(original).map(|(p, q)| *p - *q).collect();
        self.pull.sum_sq(&moved)
    }

    /// The optimum at weights, where no line has more changes of curvature than the fewest.
    fn round<'a>(&mut self, parts: &Parts<'a>) -> Result<LineRound<'a>, FairError> {
        loop {
            let round = self.under_signs(parts)?;
            let points = &round.found.optimum.points;
            let mut more = false;
            for (signs, held) in &mut self.signs {
                if !*held && self.network.bends_more(signs, points) {
                    (*held, more) = (true, true);
                }
            }
            if !more {
                return Ok(round);
            }
        }
    }

    /// The same under the signs that are held: those of lines that contradict others are given up,
    /// and then the budget.
    fn under_signs<'a>(&mut self, parts: &Parts<'a>) -> Result<LineRound<'a>, FairError> {
        let mean = self.pull.len() as f64 / 3.0;
        loop {
            let held = self.signs.iter().filter(|(_, held)| *held);
            let held: Vec<HeldSign> = held.flat_map(|(signs, _)| signs).copied().collect();
            if held.is_empty() {
                return self.followed(parts, Vec::new(), None, 1.0);
            }
            let mut halves = self.asked.clone();
            halves.extend(held.iter().map(|s| self.network.sign_half(s)));
            let parts = Parts { halves, ..parts.clone() };
            let mut refused = Vec::new();
            for wider in WIDER {
                let most = self.share.map_or(f64::INFINITY, |share| wider * share * mean);
                let made = if most.is_finite() { parts.within(self.pull, most) } else { Ok(None) };
                match made {
                    Ok(Some(found)) => return Ok(self.settled(&parts, &held, found, wider)),
                    Ok(None) => match parts.solve_after(None) {
                        Ok((optimum, solution)) => {
                            if self.squares(&optimum.points) <= most {
                                let pressed = solution.pressed;
                                let found =
                                    BudgetOptimum { weight: 0.0, optimum, good: true, pressed };
                                return Ok(self.settled(&parts, &held, found, f64::INFINITY));
                            }
                        }
                        Err(FairError::Shape { shapes, .. }) => refused = shapes,
                        // The network's own conditions may leave signs no room.
                        Err(FairError::Contradiction { .. }) => break,
                        Err(other) => return Err(other),
                    },
                    Err(FairError::Shape { .. } | FairError::Contradiction { .. }) => {}
                    Err(other) => return Err(other),
                }
                if !refused.is_empty() {
                    break;
                }
            }
            refused.retain(|&k| k < self.signs.len());
            if refused.is_empty() {
                // What contradicts what is not known: none is held.
                self.signs.iter_mut().for_each(|(signs, _)| signs.clear());
            }
            for k in refused {
                self.signs[k].0.clear();
            }
        }
    }

    /// The optimum to rounding where the signs that are reached are conditions: `near` is the one of an
    /// interior point, which stands where that shows other signs.
    fn settled<'a>(
        &self,
        parts: &Parts<'a>,
        held: &[HeldSign],
        near: BudgetOptimum,
        wider: f64,
    ) -> LineRound<'a> {
        let pressed = near.pressed.iter().skip(self.asked.len());
        let reached = held.iter().zip(pressed).filter(|(_, pressed)| **pressed);
        let reached: Vec<HeldSign> = reached.map(|(sign, _)| *sign).collect();
        let Certificate { value, gap } = near.optimum.certificate;
        let found = self.followed(parts, reached, Some(near.clone()), wider);
        if let Ok(mut round) = found {
            let optimum = &mut round.found.optimum;
            let more = optimum.certificate.value - value;
            let kept = held.iter().all(|s| self.network.off(s, &optimum.points) <= LEFT);
            if kept && more <= gap {
                // Conditions are stricter than half-spaces, so that the gap is that of these.
                optimum.certificate.gap = (gap + more).max(0.0);
                return round;
            }
        }
        let mut found = GoalOptimum::unmoved(&near.optimum.points, value, false);
        let mean = self.pull.len() as f64 / 3.0;
        found.used = self.squares(&near.optimum.points) / mean;
        (found.share, found.weight, found.least) = (1.0, near.weight, value);
        found.optimum = near.optimum;
        let (parts, scales) = (parts.clone(), Vec::new());
        LineRound { parts, scales, found, reached: Vec::new(), wider, decided: false }
    }

    /// The optimum where these signs are conditions.
    fn followed<'a>(
        &self,
        parts: &Parts<'a>,
        reached: Vec<HeldSign>,
        known: Option<BudgetOptimum>,
        wider: f64,
    ) -> Result<LineRound<'a>, FairError> {
        let mut parts = Parts { halves: self.asked.clone(), ..parts.clone() };
        parts.conditions.extend(reached.iter().map(|held| {
            let half = self.network.sign_half(held);
            Condition { entries: half.entries, value: half.most }
        }));
        let (rows, norm) = (parts.measure.clone(), parts.norm);
        let path = RegularizationPath {
            energy: |points: &[Vec3<f64>]| crate::measure::value(&rows, norm, points),
            squares: |points: &[Vec3<f64>]| self.squares(points),
            count: self.pull.len(),
            noise: rounding(&rows, norm, &self.network.points),
            original: &self.network.points,
            adapts: Adaptation::None,
            known: known.filter(|known| known.weight > 0.0),
            moves: None,
        };
        let goal = match self.share {
            Some(share) if wider.is_finite() => Goal::Budget(share * wider),
            _ => Goal::Fairest,
        };
        let held = !self.network.conditions.is_empty();
        let found = path.follow(goal, norm, held, &mut parts, self.pull)?;
        parts.pull = None;
        Ok(LineRound { parts, scales: Vec::new(), found, reached, wider, decided: true })
    }
}
