//! Curves that bend no more often than they have to, and turn their curvature hardly more often than the
//! fairest.

use crate::curve::data::{Data, DataFit, DataOptions, SignSearch};
use crate::curve::job::Job;
use crate::interrogate::shape::{self, Sample};
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

/// Steps of the logarithm of the data's weight, how many of them, and halvings of the last.
const STEP: f64 = 1.4;
const LIGHTER: usize = 8;
const HALVES: usize = 1;

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
    pieces: usize,
}

impl BendCounts {
    pub fn samples(space: &Space, points: &[Vec3<f64>]) -> Vec<Sample> {
        shape::bends(space, points)
    }

    pub fn of(samples: &[Sample]) -> Self {
        Self {
            turns: shape::reversals(samples),
            signs: shape::inflections(samples),
            pieces: shape::monotone_pieces(samples, shape::UNCOUNTED),
        }
    }
}

/// A curve under signs at a weight of the data.
enum UnderSigns {
    Found(DataFit, BendCounts),
    /// None was found that bends no more often than it may.
    None,
    /// None was looked for: without signs it has more pieces than these take away.
    TooManyPieces,
}

/// What is known of a curve that was found without regard to its bends.
pub(super) struct SolvedFit {
    /// The fairest curve; none where it was not looked for.
    pub fairest: Vec<Vec3<f64>>,
    pub counts: BendCounts,
    /// The solution that the curve is.
    pub solution: Option<CertifiedSolution>,
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
    ) -> Result<DataFit, FairError> {
        let space = &self.layout.space;
        let near = matches!(options.goal, Goal::Near(_));
        let counted = |points: &[Vec3<f64>]| BendCounts::of(&BendCounts::samples(space, points));
        let SolvedFit { fairest, counts: own_counts, solution } = before;
        let BendCounts { signs: own, pieces: before, .. } = counted(&job.points);
        let bent = own_counts.turns > 0 || own_counts.signs > own;
        let few = before.min(LEAST_PIECES + MORE_PIECES);
        if !bent && (!near || own_counts.pieces <= few) {
            return Ok(plain);
        }
        let fairest = if fairest.is_empty() { self.fairest(options, job)? } else { fairest };
        let allowed = if near {
            let least = counted(&fairest).pieces;
            (least.max(LEAST_PIECES) + MORE_PIECES).min(before.max(least))
        } else {
            usize::MAX
        };
        let mut starts = vec![(counted(&fairest).turns, fairest)];
        if bent {
            let stiffest = self.least_bending(options, job)?;
            let count = counted(&stiffest).turns;
            let at = usize::from(count >= starts[0].0);
            starts.insert(at, (count, stiffest));
        }
        let most = starts[0].0;
        let well = |counts: &BendCounts| counts.turns <= most && counts.signs <= own;
        let good = |points: &[Vec3<f64>]| well(&counted(points));
        // Signs take turns away, and pieces with these.
        let hopeless = |counts: &BendCounts| {
            let gone = counts.turns.saturating_sub(most) + counts.signs.saturating_sub(own);
            counts.pieces > allowed.saturating_add(PIECES_OF_A_TURN * gone)
        };
        if well(&own_counts) && own_counts.pieces <= allowed {
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
            let signed = DataOptions { shape: shape.clone(), ..options.clone() };
            // The last curve without signs: near its weight the next begins.
            let mut last = solution.clone();
            let mut under = |weight: f64,
                             from: &[Vec3<f64>],
                             anyway: bool|
             -> Result<_, FairError> {
                let mut lower = (plain.clone(), own_counts);
                if weight != plain.weight {
                    let mut parts = self.parts(options, job)?;
                    let (made, solved) = self.weighed(job, &mut parts, weight, last.as_ref())?;
                    last = Some(solved);
                    let counts = counted(&made.points);
                    lower = (made, counts);
                }
                if well(&lower.1) {
                    return Ok(UnderSigns::Found(lower.0, lower.1));
                }
                if !anyway && near && weight > 0.0 && hopeless(&lower.1) {
                    return Ok(UnderSigns::TooManyPieces);
                }
                // No curve under signs is better than that without by its measure and its squares.
                let least = self.weighed_value(&lower.0);
                let search =
                    SignSearch { weight: Some(weight), settled: COARSE, rounds: SOME, least };
                match self.with_signs(&signed, job, shape.clone(), from, search) {
                    Ok(made) => {
                        let counts = counted(&made.points);
                        let good = well(&counts);
                        Ok(if good { UnderSigns::Found(made, counts) } else { UnderSigns::None })
                    }
                    Err(FairError::Shape { .. }) => Ok(UnderSigns::None),
                    Err(other) => Err(other),
                }
            };
            // First under the weight of the goal's own curve.
            let mut made = None;
            match under(plain.weight, start, false)? {
                UnderSigns::None => continue,
                UnderSigns::TooManyPieces => {}
                UnderSigns::Found(first, counts) if counts.pieces > allowed => made = Some(first),
                UnderSigns::Found(first, _) if options.goal == Goal::Fairest || near => {
                    return Ok(priced(first));
                }
                UnderSigns::Found(first, _) => {
                    let then =
                        SignSearch { settled: f64::INFINITY, rounds: FEW, ..SignSearch::WHOLE };
                    return match self.with_signs(&signed, job, shape, &first.points, then) {
                        Ok(more) if good(&more.points) => Ok(priced(more)),
                        Ok(_) | Err(FairError::Shape { .. }) => Ok(priced(first)),
                        Err(other) => Err(other),
                    };
                }
            }
            // Then less and less of it, and back half-way as long as the pieces are few.
            let (mut high, mut low) = (libm::log(plain.weight), None);
            let steps = if plain.weight > 0.0 { LIGHTER } else { 0 };
            for _ in 0..steps {
                let weight = high - STEP;
                let from = made.as_ref().map_or(start, |made| &made.points);
                let (tried, counts) = match under(libm::exp(weight), from, false)? {
                    UnderSigns::None => break,
                    UnderSigns::TooManyPieces => {
                        high = weight;
                        continue;
                    }
                    UnderSigns::Found(tried, counts) => (tried, counts),
                };
                (high, made) = (weight, Some(tried));
                if counts.pieces <= allowed {
                    low = Some(weight);
                    break;
                }
            }
            if made.is_none()
                && let UnderSigns::Found(first, _) = under(plain.weight, start, true)?
            {
                made = Some(first);
            }
            let Some(mut made) = made else { continue };
            let Some(mut weight) = low else {
                found.get_or_insert(made);
                continue;
            };
            high = weight + STEP;
            for _ in 0..HALVES {
                let middle = 0.5 * (weight + high);
                match under(libm::exp(middle), &made.points, false)? {
                    UnderSigns::Found(tried, counts) if counts.pieces <= allowed => {
                        (weight, made) = (middle, tried);
                    }
                    _ => high = middle,
                }
            }
            return Ok(priced(made));
        }
        if let Some(made) = found {
            return Ok(priced(made));
        }
        let norm = options.measure.norm();
        let rows = options.measure.rows(space)?;
        // As much bending beside the measure as keeps the turns.
        let stiff = Measure::Bending.rows(space)?;
        let (low, high) = (plain.certificate.value, stiff.sum_sq(&plain.points));
        let ratio = low.max(f64::MIN_POSITIVE) / high.max(f64::MIN_POSITIVE);
        let mut parts = self.parts(options, job)?;
        for factor in [0.1, 1.0, 10.0, 100.0] {
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
        if bends == 0 || !options.conditions.is_empty() {
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
