//! Curves that bend no more often than they have to, and turn their curvature hardly more often than the
//! fairest.

use crate::curve::data::{Data, DataFit, DataOptions, SignSearch};
use crate::curve::job::Job;
use crate::interrogate::shape::{self, Sample};
use crate::interrogate::spans::SpanBasis;
use crate::optimum::Parts;
use crate::optimum::goal::{Goal, GoalOptimum};
use crate::optimum::problem::CertifiedSolution;
use crate::{FairError, Measure, ShapeConstraints, Space};
use moldloft_num::Vec3;

/// The same where the weight of the data is not yet that of the goal.
const COARSE: f64 = 1e-3;

/// Times that signs are made linear again once the curve has them.
const FEW: usize = 4;

/// Times that signs are made linear at most where a turn fewer is all that they are for.
const SOME: usize = 12;

/// So many monotone pieces any curve may have, and so many more than the fairest the one that is near.
const LEAST_PIECES: usize = 2;
const MORE_PIECES: usize = 2;

/// The pieces that a turn less takes away: on its two sides.
const PIECES_OF_A_TURN: usize = 2;

/// Where a turn was the curvature touches zero, or comes near it: of so many times the pieces that it may have a
/// curve has too many left.
const TOUCHES: usize = 4;

/// Of more points than this a fairest curve with more turns than these owes them to rounding: sixth differences of
/// so short steps have no digits left, and its signs say nothing.
const MANY: usize = 2000;
const ROUNDED_TURNS: usize = 32;

/// A curve under signs that has so many pieces more than it may have, or twice as many, is not looked for to its
/// end.
const CROWD: usize = 6;

/// Steps of the logarithm of the data's weight, how many of them, and halvings of the last; the logarithm of the
/// ratio of pieces that a step takes away, about.
const STEP: f64 = 1.4;
const LIGHTER: usize = 8;
const HALVES: usize = 1;
const PIECES_OF_A_STEP: f64 = 0.4;

/// Steps, and halvings of one of them, on the way between two curves.
const SHARES: usize = 32;
const HALVINGS: usize = 6;

/// What is counted of a curve, on the same samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct BendCounts {
    /// Reversals of the tangent's turning.
    turns: usize,
    /// Changes of the curvature's sign.
    signs: usize,
    /// Monotone pieces of the curvature.
    pub pieces: usize,
}

impl BendCounts {
    pub fn of(samples: &[Sample]) -> Self {
        Self {
            turns: shape::reversals(samples),
            signs: shape::inflections(samples),
            pieces: shape::monotone_pieces(samples, shape::UNCOUNTED),
        }
    }
}

/// Counts the bends of the curves of one space.
pub(super) struct BendCounter<'a> {
    space: &'a Space,
    basis: std::cell::OnceCell<SpanBasis>,
}

impl<'a> BendCounter<'a> {
    pub fn new(space: &'a Space) -> Self {
        Self { space, basis: std::cell::OnceCell::new() }
    }

    pub fn samples(&self, points: &[Vec3<f64>]) -> Vec<Sample> {
        let basis = self.basis.get_or_init(|| shape::counting_basis(self.space));
        basis.samples(self.space, points)
    }

    pub fn of(&self, points: &[Vec3<f64>]) -> BendCounts {
        BendCounts::of(&self.samples(points))
    }
}

/// A curve under signs at a weight of the data.
enum UnderSigns {
    Found(DataFit, BendCounts),
    /// None was found that bends no more often than it may.
    None,
    /// None was looked for, or to its end: it has more pieces than signs take away.
    TooManyPieces,
}

/// What is known of a curve that was found without regard to its bends.
pub(super) struct SolvedFit {
    /// The fairest curve; none where it was not looked for.
    pub fairest: Vec<Vec3<f64>>,
    pub counts: BendCounts,
    /// The solution that the curve is.
    pub solution: Option<CertifiedSolution>,
    /// The pieces that it may have, where these were counted.
    pub bounds: Option<PieceBounds>,
}

/// How many monotone pieces a curve near its data may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceBounds {
    /// Those of the data's own curve and of the fairest.
    data: BendCounts,
    fairest: BendCounts,
}

impl PieceBounds {
    pub fn of(data: BendCounts, fairest: BendCounts) -> Self {
        Self { data, fairest }
    }

    /// So many are few for any data.
    fn few(&self) -> usize {
        self.data.pieces.min(LEAST_PIECES + MORE_PIECES)
    }

    /// So many are few beside those of the fairest.
    fn allowed(&self) -> usize {
        let least = self.fairest.pieces;
        (least.max(LEAST_PIECES) + MORE_PIECES).min(self.data.pieces.max(least))
    }

    /// More than this is too many in any case.
    pub fn most(&self) -> usize {
        self.few().max(self.allowed())
    }
}

/// The search for a curve of few bends and pieces, from one start.
struct BendSearch<'a> {
    data: &'a Data,
    counter: &'a BendCounter<'a>,
    options: &'a DataOptions,
    job: &'a Job,
    /// The goal's own curve.
    plain: &'a DataFit,
    counts: BendCounts,
    near: bool,
    /// Turns, signs and pieces at most.
    most: usize,
    signs: usize,
    allowed: usize,
    /// Whether the turns of the starts are those of the curve.
    known: bool,
    /// The problem without signs.
    parts: Parts<'a>,
    /// The last curve without signs: near its weight the next begins.
    last: Option<CertifiedSolution>,
}

impl BendSearch<'_> {
    fn counted(&self, points: &[Vec3<f64>]) -> BendCounts {
        self.counter.of(points)
    }

    fn well(&self, counts: &BendCounts) -> bool {
        counts.turns <= self.most && counts.signs <= self.signs
    }

    /// Signs take turns away, and pieces with these.
    fn hopeless(&self, counts: &BendCounts) -> bool {
        let turns = counts.turns.saturating_sub(self.most);
        let gone = turns + counts.signs.saturating_sub(self.signs);
        let left = counts.pieces > self.allowed.saturating_add(PIECES_OF_A_TURN * gone);
        left || gone > self.allowed.saturating_mul(TOUCHES)
    }

    /// The curve at a weight of the data, under the signs of `shape` where it bends too often without; with
    /// `anyway` however many pieces it has.
    fn under(
        &mut self,
        shape: &ShapeConstraints,
        weight: f64,
        from: &[Vec3<f64>],
        anyway: bool,
    ) -> Result<UnderSigns, FairError> {
        let (data, job) = (self.data, self.job);
        let mut lower = (self.plain.clone(), self.counts);
        if weight != self.plain.weight {
            let (made, solved) = data.weighed(job, &mut self.parts, weight, self.last.as_ref())?;
            self.last = Some(solved);
            let counts = self.counted(&made.points);
            lower = (made, counts);
        }
        if self.well(&lower.1) {
            return Ok(UnderSigns::Found(lower.0, lower.1));
        }
        if !self.known {
            return Ok(UnderSigns::TooManyPieces);
        }
        let rejects = !anyway && self.near && weight > 0.0;
        if rejects && self.hopeless(&lower.1) {
            return Ok(UnderSigns::TooManyPieces);
        }
        // No curve under signs is better than that without by its measure and its squares.
        let least = data.weighed_value(&lower.0);
        let search = SignSearch { weight: Some(weight), settled: COARSE, rounds: SOME, least };
        // The first curve under signs has nearly the pieces of the last.
        let crowd = self.allowed.saturating_add(self.allowed.min(CROWD));
        let crowded = |points: &[Vec3<f64>]| rejects && self.counted(points).pieces > crowd;
        let signed = DataOptions { shape: shape.clone(), ..self.options.clone() };
        match data.with_signs_unless(&signed, job, shape.clone(), from, search, &crowded) {
            Ok(None) => Ok(UnderSigns::TooManyPieces),
            Ok(Some(made)) => {
                let counts = self.counted(&made.points);
                let good = self.well(&counts);
                Ok(if good { UnderSigns::Found(made, counts) } else { UnderSigns::None })
            }
            Err(FairError::Shape { .. }) => Ok(UnderSigns::None),
            Err(other) => Err(other),
        }
    }

    /// The curve at the largest weight, of steps below the goal's own, that has few pieces, and the weight's
    /// logarithm; without one the curve at the least weight that has no bend too many. `made` is that at the
    /// goal's own weight.
    fn lighter(
        &mut self,
        shape: &ShapeConstraints,
        start: &[Vec3<f64>],
        mut made: Option<DataFit>,
    ) -> Result<(Option<(f64, DataFit)>, Option<DataFit>), FairError> {
        let own = libm::log(self.plain.weight);
        let at = |step: usize| own - STEP * step as f64;
        // Pieces fall with the weight, so the first step at which they are few is between two others; about
        // where it is shows in how many they are too many.
        let ratio = self.counts.pieces as f64 / self.allowed.max(1) as f64;
        let guess = libm::log(ratio.max(1.0)) / PIECES_OF_A_STEP;
        let mut step = (guess.round() as usize).clamp(1, LIGHTER);
        let (mut many, mut stride) = (0, 1);
        let mut few: Option<(usize, DataFit)> = None;
        loop {
            let from = made.as_ref().map_or(start, |made| &made.points).to_vec();
            match self.under(shape, libm::exp(at(step)), &from, false)? {
                UnderSigns::Found(tried, counts) if counts.pieces <= self.allowed => {
                    few = Some((step, tried));
                }
                UnderSigns::Found(tried, _) => {
                    (many, made) = (step, Some(tried));
                }
                UnderSigns::None | UnderSigns::TooManyPieces => many = step,
            }
            let above = few.as_ref().map_or(LIGHTER + 1, |few| few.0);
            if many + 1 >= above {
                break;
            }
            step = match few {
                Some(_) => above.saturating_sub(stride).max(many + 1),
                None => (many + stride).min(LIGHTER),
            };
            stride *= 2;
        }
        Ok((few.map(|(step, fit)| (at(step), fit)), made))
    }

    /// The same back half-way to the step before, as long as the pieces are few.
    fn heavier(
        &mut self,
        shape: &ShapeConstraints,
        (mut weight, mut made): (f64, DataFit),
    ) -> Result<DataFit, FairError> {
        let mut high = weight + STEP;
        for _ in 0..HALVES {
            let middle = 0.5 * (weight + high);
            match self.under(shape, libm::exp(middle), &made.points.clone(), false)? {
                UnderSigns::Found(tried, counts) if counts.pieces <= self.allowed => {
                    (weight, made) = (middle, tried);
                }
                _ => high = middle,
            }
        }
        Ok(made)
    }
}

impl Data {
    /// The curve of a goal, or one near it that bends no more often than it has to and, under the goal
    /// `near`, has hardly more monotone pieces than the fairest, and none more than the data's. Third
    /// derivatives may buy smoothness with a bend, and budgets leave some of the data's: the signs of the fairest curve, or of that of
    /// least bending, are conditions then, and the weight of the data falls until the pieces are few.
    /// Where no such curve is found, one between it and the fairest is taken, which is within the
    /// tolerances as both are.
    pub(super) fn without_bends(
        &self,
        options: &DataOptions,
        job: &Job,
        plain: DataFit,
        before: SolvedFit,
        counter: &BendCounter<'_>,
    ) -> Result<DataFit, FairError> {
        let space = &self.layout.space;
        let near = matches!(options.goal, Goal::Near(_));
        let counted = |points: &[Vec3<f64>]| counter.of(points);
        let SolvedFit { fairest, counts: own_counts, solution, bounds } = before;
        let data = bounds.map_or_else(|| counted(&job.points), |bounds| bounds.data);
        let own = data.signs;
        let bent = own_counts.turns > 0 || own_counts.signs > own;
        if !bent && (!near || own_counts.pieces <= data.pieces.min(LEAST_PIECES + MORE_PIECES)) {
            return Ok(plain);
        }
        let fairest = if fairest.is_empty() { self.fairest(options, job)? } else { fairest };
        let bounds = bounds.unwrap_or_else(|| PieceBounds::of(data, counted(&fairest)));
        let allowed = if near { bounds.allowed() } else { usize::MAX };
        let mut starts = vec![(bounds.fairest.turns, fairest)];
        if bent {
            let stiffest = self.least_bending(options, job)?;
            let count = counted(&stiffest).turns;
            let at = usize::from(count >= starts[0].0);
            starts.insert(at, (count, stiffest));
        }
        let most = starts[0].0;
        let parts = self.unshaped_parts(options, job)?;
        let mut search = BendSearch {
            data: self,
            counter,
            options,
            job,
            plain: &plain,
            counts: own_counts,
            near,
            most,
            signs: own,
            allowed,
            known: job.points.len() <= MANY || most <= ROUNDED_TURNS,
            parts,
            last: solution,
        };
        if search.well(&own_counts) && own_counts.pieces <= allowed {
            return Ok(plain);
        }
        let least = plain.least;
        // What the form costs is part of the gap.
        let priced = |mut made: DataFit| {
            made.certificate.gap = made.certificate.gap.max(made.certificate.value - least);
            made.least = least;
            made.fairest_used = plain.fairest_used;
            made
        };
        let mut found: Option<DataFit> = None;
        for (_, start) in starts.iter().filter(|s| s.0 <= most) {
            let Some(shape) = ShapeConstraints::pattern(space, start) else { continue };
            // First under the weight of the goal's own curve.
            let mut made = None;
            match search.under(&shape, plain.weight, start, false)? {
                UnderSigns::None => continue,
                UnderSigns::TooManyPieces => {}
                UnderSigns::Found(first, counts) if counts.pieces > allowed => made = Some(first),
                UnderSigns::Found(first, _) if options.goal == Goal::Fairest || near => {
                    return Ok(priced(first));
                }
                UnderSigns::Found(first, _) => {
                    let then =
                        SignSearch { settled: f64::INFINITY, rounds: FEW, ..SignSearch::WHOLE };
                    let signed = DataOptions { shape: shape.clone(), ..options.clone() };
                    return match self.with_signs(&signed, job, shape, &first.points, then) {
                        Ok(more) if search.well(&counted(&more.points)) => Ok(priced(more)),
                        Ok(_) | Err(FairError::Shape { .. }) => Ok(priced(first)),
                        Err(other) => Err(other),
                    };
                }
            }
            // Then less of it.
            let mut few = None;
            if plain.weight > 0.0 {
                (few, made) = search.lighter(&shape, start, made)?;
            }
            if let Some(few) = few {
                return Ok(priced(search.heavier(&shape, few)?));
            }
            if made.is_none()
                && let UnderSigns::Found(first, _) =
                    search.under(&shape, plain.weight, start, true)?
            {
                made = Some(first);
            }
            if found.is_none() {
                found = made;
            }
        }
        if let Some(made) = found {
            return Ok(priced(made));
        }
        let good = |points: &[Vec3<f64>]| search.well(&counted(points));
        let norm = options.measure.norm();
        let rows = options.measure.rows(space)?;
        // As much bending beside the measure as keeps the turns.
        let stiff = Measure::Bending.rows(space)?;
        let (low, high) = (plain.certificate.value, stiff.sum_sq(&plain.points));
        let ratio = low.max(f64::MIN_POSITIVE) / high.max(f64::MIN_POSITIVE);
        let mut parts = self.parts(options, job)?;
        for factor in [0.1, 1.0, 10.0, 100.0].into_iter().filter(|_| search.known) {
            parts.measure = rows.clone().joined(&stiff.clone().scaled(factor * ratio.sqrt()));
            let mut made = self.along(options, job, &mut parts)?;
            if good(&made.points) {
                made.certificate.value = crate::measure::value(&rows, norm, &made.points);
                return Ok(priced(made));
            }
        }
        let (_, start) = &starts[0];
        let between = |share: f64| -> Vec<Vec3<f64>> {
            let both = start.iter().zip(&plain.points);
            both.map(|(p, q)| *p + (*q - *p) * share).collect()
        };
        let shares = (0..SHARES).rev().map(|k| k as f64 / SHARES as f64);
        if let Some(mut low) = shares.into_iter().find(|&s| good(&between(s))) {
            let mut high = low + 1.0 / SHARES as f64;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                *(if good(&between(middle)) { &mut low } else { &mut high }) = middle;
            }
            let points = between(low);
            let value = crate::measure::value(&rows, norm, &points);
            let mut made = self.fit(GoalOptimum::unmoved(&points, value, false), job);
            let radii = &self.limit.radii;
            made.active = made.residuals.iter().zip(radii).filter(|(r, a)| r >= a).count();
            made.used = self.used(&made.residuals);
            made.certificate.gap = value;
            return Ok(priced(made));
        }
        let bends = own_counts.signs.saturating_sub(own);
        if bends == 0 || !options.conditions.is_empty() || !self.layout.interpolates() {
            return Ok(DataFit { bends, ..plain });
        }
        // The curve through the data bends no more often than itself.
        let value = crate::measure::value(&rows, norm, &job.points);
        let mut kept = self.fit(GoalOptimum::unmoved(&job.points, value, false), job);
        kept.least = least;
        kept.bends = bends;
        Ok(kept)
    }

    /// Whether data that did not move are to stay: they are exact, or as fair as asked. Under the goal
    /// `near` others move for a turn that the fairest does not have.
    pub(super) fn stays(&self, options: &DataOptions, job: &Job, plain: &DataFit) -> bool {
        let near = matches!(options.goal, Goal::Near(_));
        let still = self.limit.radii.iter().all(|&r| r == 0.0);
        plain.points == job.points && (!near || still || self.exact_parts())
    }
}
