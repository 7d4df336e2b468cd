//! Networks line by line: each curve weighed by itself, with no more changes of curvature than its
//! points ask for.
//!
//! The sum of a measure over all curves is nearly all that of a few hard spots, so that these would
//! decide for all. Each curve counts by what it has left of its own measure instead. And third
//! differences buy smoothness with a bend: where a curve bends more often than the fewest changes
//! that fit within the tolerance, the signs of its second divided differences are held.

use super::between::LimitsBetween;
use super::line_patterns::ValueTube;
use super::shapes::EquationSpan;
use super::sign_room::SignRoom;
use crate::curve::moving::MovingRows;
use crate::optimum::goal::{
    Adaptation, Goal, GoalOptimum, GoalVariation, RegularizationPath, check_decided, check_unique,
    moved, rounding,
};
use crate::optimum::{Bend, BudgetOptimum, ControlInequality, Parts};
use crate::{Certificate, Condition, FairError, Measure, Motion, Network, RowNorm, SparseRows};
use moldloft_num::{Real, Vec3};

/// The fewest points of a line that has changes of curvature.
const FEWEST_POINTS: usize = 4;

/// Fraction of the measure of noise that fills the tolerances, below which lines are alike.
const ALIKE: f64 = 1e-3;

/// Rounds of weights.
const ROUNDS: usize = 3;

/// The budget where signs leave no network within the goal's own, in the squares of the nearest network that has
/// them.
const BESIDE: f64 = 1.2;

/// Accuracy of the squares of the nearest network.
const NEAREST: f64 = 1e-6;

/// Allowed violation of a sign, relative to the variation that the tolerances allow.
const LEFT: f64 = 1e-9;

/// Minimum distance of a second difference with a held sign from zero, relative to the same
/// variation: at zero rounding would decide its sign.
const SIGN_MARGIN: f64 = 1e-6;

/// The same share below which a second difference has no sign.
const STRAIGHT: f64 = 1e-8;

/// Rounding of second differences, relative to the size of the points.
const SIGN_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Difference of the factors of two signs, of size 1, that are the same.
const SAME: f64 = 1e-9;

/// Fraction of a tolerance below which conditions leave a point a range of its own.
const NARROWED: f64 = 0.999;

/// The sign of the second difference of three neighbours on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeldSign {
    line: usize,
    /// The place of the first of the three on the line.
    first: usize,
    /// The place at which its part of the line begins, between breaks and runs.
    part: usize,
    sign: f64,
    /// True if it must differ from zero; false if the other conditions do not allow this.
    strict: bool,
}

/// The signs of a line with the fewest changes.
struct LineSigns {
    /// All of them.
    fewest: Vec<HeldSign>,
    /// The signs that are still held.
    left: Vec<HeldSign>,
    /// True once the line has bent more than that.
    held: bool,
}

/// Cost of giving up a sign, by the changes that this may add: next to a change it moves that; at the
/// end of a line it adds one; else two.
const COSTS: [f64; 3] = [0.25, 0.6, 1.0];

/// Cost of giving up each sign of a line.
fn costs(signs: &[HeldSign]) -> Vec<f64> {
    let cost = |k: usize| {
        let beside = |other: Option<&HeldSign>| match other {
            Some(other) if other.part != signs[k].part => 1,
            Some(other) if other.sign == signs[k].sign => 2,
            Some(_) => 0,
            None => 1,
        };
        let before = beside(k.checked_sub(1).and_then(|k| signs.get(k)));
        COSTS[before.min(beside(signs.get(k + 1)))]
    };
    (0..signs.len()).map(cost).collect()
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
    /// True if it is known which signs are reached, and they leave a network within the goal's own budget.
    decided: bool,
    /// Limits between points.
    between: LimitsBetween,
    /// Lines with more changes of curvature than required within their tolerances, because
    /// conditions or crossing lines do not allow their signs.
    pub bent: Vec<usize>,
}

/// Data of all rounds.
struct LineFairing<'a> {
    network: &'a Network,
    pull: &'a SparseRows,
    /// The budget of squares; none for the fairest.
    share: Option<f64>,
    /// The signs of the lines.
    signs: Vec<LineSigns>,
    /// The half-spaces of the network's own conditions, whose owners come after the lines.
    asked: Vec<ControlInequality>,
    /// The squares that ties require, and how many points have no displacement of their own.
    ties: (f64, usize),
    /// Start of the searches, if signs have shown that they need one.
    begin: Vec<Vec3<f64>>,
    /// Limits between points that the results reach; none where these are not limited.
    between: Option<LimitsBetween>,
    /// The budget that these signs and limits leave, where it is known: the same for all weights.
    wider: Option<f64>,
}

impl Network {
    /// True for curves through points, which have measures of their own.
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

    /// The measure below which lines are alike: a fraction of the squares of noise of the
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
                let own = self.strands[k].divided(measure, at, &self.arcs_of(k)).into_iter();
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

    /// The signs of the fewest changes of line `k` between its breaks, within the ranges that the
    /// conditions leave its points.
    fn line_signs(
        &self,
        k: usize,
        frozen: &[bool],
        (span, ranges): (&EquationSpan, &[Vec<[f64; 2]>]),
    ) -> Vec<HeldSign> {
        let (strand, Some(way)) = (&self.strands[k], self.way(k)) else { return Vec::new() };
        let Some(at) = strand.at.as_ref().filter(|_| !strand.space.is_closed()) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut bounds = vec![0];
        let arcs = self.arcs_of(k);
        let shapes = strand.runs.iter().chain(&arcs);
        bounds.extend(strand.marks.iter().chain(shapes.clone().flatten()).copied());
        bounds.push(strand.points.len() - 1);
        bounds.sort_unstable();
        bounds.dedup();
        for pair in bounds.windows(2) {
            // Runs and arcs have the signs of their shape.
            if shapes.clone().any(|run| run[0] <= pair[0] && pair[1] <= run[1]) {
                continue;
            }
            // A curve does not bend back where it leaves a run.
            let smooth = |end: usize| !strand.marks.contains(&end);
            let after = strand.runs.iter().any(|run| run[1] == pair[0] && smooth(run[1]));
            let before = strand.runs.iter().any(|run| run[0] == pair[1] && smooth(run[0]));
            let (from, to) = (pair[0] - usize::from(after), pair[1] + usize::from(before));
            if to - from + 1 < FEWEST_POINTS {
                continue;
            }
            let own = &strand.points[from..=to];
            let extent = self.extent();
            // Conditions may leave a part of a tolerance, equal for points that move together.
            let room = |&i: &usize| -> [f64; 2] {
                let (value, room) = (way.dot(self.points[i]), self.limit.radii[i].min(extent));
                match span.along(&ranges[i], way) {
                    _ if frozen[i] => [value, 0.0],
                    Some([low, high]) if (high - low) < 2.0 * NARROWED * room => {
                        [value + 0.5 * (low + high), 0.5 * (high - low)]
                    }
                    _ => [value, room],
                }
            };
            let (values, rooms): (Vec<f64>, Vec<f64>) =
                own.iter().map(room).map(|r| (r[0], r[1])).unzip();
            if rooms.iter().all(|&r| r == 0.0 || r == extent) {
                continue;
            }
            let tube = ValueTube { at: &at[from..=to], values: &values, rooms: &rooms };
            for (j, sign) in tube.fewest().into_iter().flatten().enumerate() {
                let held = HeldSign { line: k, first: from + j, part: pair[0], sign, strict: true };
                let moves = own[j..j + 3].iter().any(|&i| !frozen[i]);
                if sign != 0.0 && moves {
                    out.push(held);
                }
            }
        }
        out
    }

    /// The direction to which a part of line `k` bends that turns one way: that of the two which is nearer to
    /// its points. None where these move in more directions than one.
    pub(super) fn bulge(&self, k: usize, between: [usize; 2]) -> Option<Vec3<f64>> {
        let (strand, way) = (&self.strands[k], self.way(k)?);
        let at = strand.at.as_ref().filter(|_| !strand.space.is_closed())?;
        let (own, extent) = (&strand.points[between[0]..=between[1]], self.extent());
        let values: Vec<f64> = own.iter().map(|&i| way.dot(self.points[i])).collect();
        let frozen = self.frozen();
        let room = |&i: &usize| if frozen[i] { 0.0 } else { self.limit.radii[i].min(extent) };
        let rooms: Vec<f64> = own.iter().map(room).collect();
        let tube = ValueTube { at: &at[between[0]..=between[1]], values: &values, rooms: &rooms };
        tube.bulge().map(|sign| way * sign)
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

    /// The factors of a sign by the points that lead its own.
    fn tied_factors(&self, held: &HeldSign, parts: &Parts<'_>) -> [(usize, f64); 3] {
        let strand = &self.strands[held.line];
        let at = strand.at.as_deref().unwrap_or_default();
        let factors = sign_factors(held.sign, &at[held.first..held.first + 3]);
        std::array::from_fn(|k| (parts.ties.leader(strand.points[held.first + k]), factors[k]))
    }

    /// The variation of a second difference that the tolerances allow.
    fn sign_range<T: Real>(&self, held: &HeldSign, at: &[T], tolerances: &[T]) -> T {
        let extent = self.extent();
        let places = held.first..held.first + 3;
        let ids = &self.strands[held.line].points[places.clone()];
        let factors = sign_factors(held.sign, &at[places]);
        let room =
            |i: usize| if tolerances[i].re() < extent { tolerances[i] } else { extent.into() };
        let size = |f: T| if f.re() < 0.0 { -f } else { f };
        ids.iter().zip(factors).fold(T::zero(), |sum, (&i, f)| sum + size(f) * room(i))
    }

    /// The limit of a sign's half-space.
    fn sign_limit<T: Real>(&self, held: &HeldSign, at: &[T], tolerances: &[T]) -> T {
        let strand = &self.strands[held.line];
        let size = strand.points.iter().map(|&i| self.points[i].norm()).fold(0.0, f64::max);
        let rounding = SIGN_ROUNDING * size;
        if !held.strict {
            return T::from(rounding);
        }
        let margin = self.sign_range(held, at, tolerances) * SIGN_MARGIN;
        if margin.re() < 2.0 * rounding { T::from(-2.0 * rounding) } else { -margin }
    }

    /// A sign as a half-space.
    fn sign_half(&self, held: &HeldSign) -> ControlInequality {
        let at = self.strands[held.line].at.as_deref().unwrap_or_default();
        let most = self.sign_limit(held, at, &self.limit.radii);
        ControlInequality { entries: self.sign_entries(held, at), most, owner: held.line }
    }

    /// Violation of zero curvature and of a sign's half-space, relative to the variation of the
    /// second difference that the tolerances allow.
    fn off(&self, held: &HeldSign, points: &[Vec3<f64>]) -> [f64; 2] {
        let half = self.sign_half(held);
        let sum: f64 = half.entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
        let at = self.strands[held.line].at.as_deref().unwrap_or_default();
        let varies = self.sign_range(held, at, &self.limit.radii).max(f64::MIN_POSITIVE);
        [sum / varies, (sum - half.most) / varies]
    }

    /// True if a line of these signs has more changes at these points than the signs have.
    fn bends_more(&self, signs: &[HeldSign], points: &[Vec3<f64>]) -> bool {
        let parts = signs.chunk_by(|a, b| a.part == b.part);
        let changes = |signs: Vec<f64>| signs.windows(2).filter(|w| w[0] != w[1]).count();
        let mut more = false;
        for part in parts {
            let own = changes(part.iter().map(|s| s.sign).collect());
            let off = part.iter().map(|s| (s.sign, self.off(s, points)[0]));
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
        let equations = parts.equations();
        let span = EquationSpan::of(self, &equations);
        let ranges = span.move_ranges(self, &equations);
        let frozen = self.frozen();
        let signs_of = |k: usize| {
            let mut signs = self.line_signs(k, &frozen, (&span, &ranges));
            signs.retain(|held| !span.determines(&self.sign_half(held).entries));
            LineSigns { left: signs.clone(), fewest: signs, held: false }
        };
        let mut signs: Vec<LineSigns> = (0..count).map(signs_of).collect();
        // Lines that move together have the same half-spaces: one of each.
        let mut seen: Vec<[(usize, f64); 3]> = Vec::new();
        for line in signs.iter_mut().filter(|_| !parts.ties.is_empty()) {
            line.left.retain(|held| {
                let own = self.tied_factors(held, parts);
                let same = |other: &[(usize, f64); 3]| {
                    own.iter().zip(other).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= SAME)
                };
                let new = !seen.iter().any(same);
                if new {
                    seen.push(own);
                }
                new
            });
        }
        let asked = parts.halves.clone();
        let (begin, ties) = (Vec::new(), (parts.ties.forced, parts.ties.removed));
        let between = self.limits_between().then(LimitsBetween::default);
        let mut fairing = LineFairing {
            network: self,
            pull,
            share,
            ties,
            signs,
            asked,
            begin,
            between,
            wider: None,
        };
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

    /// The values of conditions, the last of them those of signs, whose margins follow the tolerances.
    fn sign_values<T: Real>(
        &self,
        others: &[Condition],
        reached: &[HeldSign],
        numbers: &LineNumbers<'_, T>,
    ) -> Vec<T> {
        let limit = |held: &HeldSign| {
            let plain: Vec<T>;
            let at = match numbers.ats.get(held.line).and_then(Option::as_ref) {
                Some(at) => at,
                None => {
                    let own = self.strands[held.line].at.iter().flatten();
                    plain = own.map(|&t| T::from(t)).collect();
                    &plain
                }
            };
            self.sign_limit(held, at, numbers.tolerances)
        };
        let values = others.iter().map(|condition| T::from(condition.value));
        values.chain(reached.iter().map(limit)).collect()
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
                    "the inflections that the network avoids are undecided within rounding, or \
                    leave no network within the goal's budget, so no derivatives are available: \
                    use the goal \"budget\"",
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
                // The weight of a line without a measure is constant.
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
            round.between.check(&solved, &parts.bounded, &parts.frozen, ats)?;
            let own = round.between.tolerances(tolerances);
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
            let targets = self.sign_values(&parts.conditions[..first], &round.reached, numbers);
            let moving = GoalVariation {
                originals: points.to_vec(),
                tolerances: &own,
                pulled: owners.iter().map(|&i| tolerances[i]).collect(),
                targets: &targets,
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

    /// The optimum at weights, where no line has more changes of curvature than the fewest, and none swings
    /// beyond its limits.
    fn round<'a>(&mut self, parts: &Parts<'a>) -> Result<LineRound<'a>, FairError> {
        loop {
            let mut limited = parts.clone();
            if let Some(between) = self.between.as_ref().filter(|between| !between.is_empty()) {
                limited.bounded = between.bounded(self.network);
            }
            let round = self.under_signs(&limited)?;
            let points = &round.found.optimum.points;
            let mut more = false;
            for line in self.signs.iter_mut().filter(|line| !line.held) {
                if self.network.bends_more(&line.fewest, points) {
                    (line.held, more) = (true, true);
                }
            }
            if let Some(between) = &mut self.between
                && !more
                && between.extend(self.network, points)?
            {
                // A start within the other limits may be beyond these.
                self.begin = Vec::new();
                more = true;
            }
            if !more {
                let between = self.between.clone().unwrap_or_default();
                return Ok(LineRound { between, ..self.reported(round) });
            }
            self.wider = None;
        }
    }

    /// The round with the lines that bend more than the fewest changes.
    fn reported<'a>(&self, mut round: LineRound<'a>) -> LineRound<'a> {
        let points = &round.found.optimum.points;
        let bends = |k: &usize| self.network.bends_more(&self.signs[*k].fewest, points);
        round.bent = (0..self.signs.len()).filter(bends).collect();
        round
    }

    /// The optimum under the held signs. Signs that the conditions and other lines do not allow are
    /// given up; before that the budget is widened.
    fn under_signs<'a>(&mut self, parts: &Parts<'a>) -> Result<LineRound<'a>, FairError> {
        loop {
            let held: Vec<HeldSign> = self.held().flat_map(|line| &line.left).copied().collect();
            if held.is_empty() {
                return self.followed(parts, Vec::new(), None, 1.0);
            }
            let mut halves = self.asked.clone();
            halves.extend(held.iter().map(|s| self.network.sign_half(s)));
            let mut parts = Parts { halves, ..parts.clone() };
            if !self.begin.is_empty() {
                parts.begin.clone_from(&self.begin);
            }
            if self.wider.is_none()
                && let Some((found, wider)) = self.within_budget(&parts, 1.0)?
            {
                return Ok(self.settled(&parts, &held, found, wider));
            }
            if self.wider.is_none() {
                self.wider = self.least_budget(&parts)?;
            }
            if let Some(wider) = self.wider
                && let Some((found, wider)) = self.within_budget(&parts, wider)?
            {
                let round = self.settled(&parts, &held, found, wider);
                // The budget follows the squares of the nearest network.
                return Ok(LineRound { decided: false, ..round });
            }
            let costs: Vec<f64> = self.held().flat_map(|line| costs(&line.left)).collect();
            let room = SignRoom::of(&parts, self.asked.len(), &costs)?;
            let any = |all: &[bool]| all.iter().any(|&x| x);
            let hopeless = any(&room.missed);
            let given_up = if hopeless {
                room.missed
            } else if self.begin.is_empty() && !room.moves.is_empty() {
                // There is a network with these signs: the search begins there.
                vec![false; held.len()]
            } else if any(&room.tight) {
                room.tight
            } else {
                vec![true; held.len()]
            };
            (self.begin, self.wider) = (room.moves, None);
            let mut given_up = given_up.into_iter();
            for line in self.signs.iter_mut().filter(|line| line.held) {
                line.left.retain_mut(|sign| {
                    let up = given_up.next() != Some(false);
                    // If the conditions allow nothing beyond zero, the second difference may be
                    // zero.
                    let relaxed = up && sign.strict && !hopeless;
                    sign.strict &= !up;
                    !up || relaxed
                });
            }
        }
    }

    /// The bound on the sum of squares at a multiple of the goal's own budget: beyond the squares that
    /// ties require those of points with a displacement of their own.
    fn most(&self, wider: f64) -> f64 {
        let (forced, removed) = self.ties;
        let free = self.pull.len().saturating_sub(removed) as f64 / 3.0;
        self.share.map_or(f64::INFINITY, |share| forced + wider * share * free)
    }

    /// The budget, in the goal's own, that the nearest network under half-spaces leaves, and none where there
    /// is no such network.
    fn least_budget(&self, parts: &Parts<'_>) -> Result<Option<f64>, FairError> {
        let Some(share) = self.share else { return Ok(None) };
        let (forced, removed) = self.ties;
        let own = share * self.pull.len().saturating_sub(removed) as f64 / 3.0;
        let nearest = Parts {
            measure: SparseRows::new(),
            pull: Some(self.pull.clone()),
            accuracy: NEAREST,
            ..parts.clone()
        };
        match nearest.solve() {
            Ok(found) => {
                let squares = (self.squares(&found.points) - forced).max(0.0);
                Ok(Some((BESIDE * squares / own).max(1.0)).filter(|wider| wider.is_finite()))
            }
            Err(FairError::Shape { .. } | FairError::Contradiction { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn held(&self) -> impl Iterator<Item = &LineSigns> {
        self.signs.iter().filter(|line| line.held)
    }

    /// The optimum under half-spaces and a budget of the goal's own times `wider`, with the budget that
    /// it has then; none where there is no such network.
    fn within_budget(
        &self,
        parts: &Parts<'_>,
        wider: f64,
    ) -> Result<Option<(BudgetOptimum, f64)>, FairError> {
        let most = self.most(wider);
        let none = |error| match error {
            FairError::Shape { .. } | FairError::Contradiction { .. } => Ok(None),
            other => Err(other),
        };
        if most.is_finite() {
            // A search under a budget begins within it.
            let begin = parts.ties.shifted(&self.network.points).into_iter().enumerate();
            let begin: Vec<Vec3<f64>> = begin
                .map(|(i, p)| {
                    p + parts.begin.get(parts.ties.leader(i)).copied().unwrap_or_default()
                })
                .collect();
            let mut own = parts.clone();
            if self.squares(&begin) >= most {
                own.begin = Vec::new();
            }
            match own.within(self.pull, most) {
                Ok(Some(found)) => return Ok(Some((found, wider))),
                Ok(None) => {}
                Err(error) => return none(error),
            }
        }
        match parts.solve_after(None) {
            Ok((optimum, solution)) if self.squares(&optimum.points) <= most => {
                let pressed = solution.pressed;
                let found = BudgetOptimum { weight: 0.0, optimum, good: true, pressed };
                Ok(Some((found, f64::INFINITY)))
            }
            Ok(_) => Ok(None),
            Err(error) => none(error),
        }
    }

    /// The optimum to rounding where the signs that are reached are conditions: `near` is the one
    /// of an interior point, which remains if that shows other signs.
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
            let kept = held.iter().all(|s| self.network.off(s, &optimum.points)[1] <= LEFT);
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
        let (reached, bent) = (Vec::new(), Vec::new());
        let between = LimitsBetween::default();
        LineRound { parts, scales, found, reached, wider, decided: false, between, bent }
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
            nearest: None,
            fairest: None,
        };
        let goal = match self.share {
            Some(share) if wider.is_finite() && self.ties == (0.0, 0) => {
                Goal::Budget(share * wider)
            }
            Some(_) if wider.is_finite() => {
                Goal::Budget(self.most(wider) * 3.0 / self.pull.len() as f64)
            }
            _ => Goal::Fairest,
        };
        let held = !self.network.conditions.is_empty();
        let found = path.follow(goal, norm, held, &mut parts, self.pull)?;
        parts.pull = None;
        let (scales, bent, between) = (Vec::new(), Vec::new(), LimitsBetween::default());
        Ok(LineRound { parts, scales, found, reached, wider, decided: true, between, bent })
    }
}
