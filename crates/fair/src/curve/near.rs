//! The curve near its data: residuals up to the level of noise that fills the tolerance, no more
//! inflections than the fairest curve, and at most two more monotone pieces of curvature.
//!
//! Third derivatives may trade smoothness for a turn, parameters by curvature may follow the
//! curvature of noise, and a budget leaves ripples of the data. These disappear along a path from
//! the goal's curve to the fairest: the budget rises to what the fairest takes, then the parameters
//! return to chord lengths. The position on the path is an integral of counts in which a ripple
//! counts by its persistence (Edelsbrunner, Letscher and Zomorodian 2002); it is therefore a
//! continuous function of the data.

use crate::curve::bends::{BendCounter, BendCounts, HELD};
use crate::curve::data::{Data, DataFit, DataOptions, fair_data};
use crate::curve::job::Job;
use crate::interrogate::shape::{self, Sample};
use crate::interrogate::soft_counts::{EARLY, LATE, SoftCounts};
use crate::optimum::goal::Goal;
use crate::optimum::{Optimum, Parts};
use crate::{FairError, InterpolationSpace, SparseRows};
use moldloft_num::Vec3;

/// Steps of the integral from the goal's budget to that of the fairest, and back to chord lengths.
const BUDGET_STEPS: usize = 10;
const PARAMETER_STEPS: usize = 4;

/// Excess of the fairest curve from which it has more bends than allowed: from [`HELD`] to this the
/// path goes on beyond it.
const EXCEEDS: f64 = 0.9;

/// Monotone pieces that the curve of a budget may have more than the fairest.
const MORE_PIECES: f64 = 2.0;

/// Minimum ratio of the fairest curve's squares to the goal's budget, so that the path has a
/// length.
const LEAST_WAY: f64 = 1.05;

/// Fraction of the distance from the data below which the budget is taken from the goal and not
/// from the curve.
const LEAST_SHARE: f64 = 1e-3;

/// Steps of the same integral under a shape, where each curve is a search of its own, and on few
/// knots.
const SHAPED_STEPS: usize = 5;

/// A curve with the spline that it is on, where that is not the data's own.
pub(super) type Relaid = (Option<InterpolationSpace>, DataFit);

/// Limits of a curve: the counts of the fairest, with [`MORE_PIECES`].
struct CountLimits(SoftCounts);

impl CountLimits {
    /// Limits from counts of fairest curves.
    fn of(fairest: &[SoftCounts]) -> Self {
        let least =
            |of: fn(&SoftCounts) -> f64| fairest.iter().map(of).fold(f64::INFINITY, f64::min);
        let (inflections, pieces) = (least(|c| c.inflections), least(|c| c.pieces) + MORE_PIECES);
        Self(SoftCounts { inflections, pieces })
    }

    /// Excess of a curve over the limits, from 0 to 1.
    fn beyond(&self, counter: &BendCounter<'_>, points: &[Vec3<f64>]) -> f64 {
        let own = counter.soft(points, EARLY);
        let signs = own.inflections - self.0.inflections;
        signs.max(own.pieces - self.0.pieces).clamp(0.0, 1.0)
    }
}

/// The same data at the lengths, where their parameters follow the turns; both lists of parameters,
/// in the order of the data.
pub(super) struct TurnedFrom<'a> {
    pub lengths: &'a Data,
    pub own: &'a [f64],
    pub at: &'a [f64],
}

/// The path from the goal's curve to the fairest.
struct FairingPath<'a> {
    data: &'a Data,
    job: &'a Job,
    /// The options of the goal's curve, whatever it bends.
    plain: DataOptions,
    parts: Parts<'a>,
    pull: SparseRows,
    goal: DataFit,
    fairest: Optimum,
    /// Minimum of the measure, and the optimality gap of the goal's curve.
    least: f64,
    share: f64,
    /// The budgets of the goal's curve and of the fairest.
    budgets: [f64; 2],
    /// The squares of a budget of 1.
    mean: f64,
    /// The fairest curve with no more bends than that of least bending, at the lengths.
    calm: DataFit,
    turned: Option<TurnedFrom<'a>>,
    counter: BendCounter<'a>,
}

impl FairingPath<'_> {
    fn budget(&self, x: f64) -> f64 {
        self.budgets[0] * libm::pow(self.budgets[1] / self.budgets[0], x)
    }

    /// Interpolation between the data's own curve and `points`, at the goal's fraction and beyond,
    /// along the path.
    fn towards(&self, points: &[Vec3<f64>], x: f64) -> Vec<Vec3<f64>> {
        let share = self.share + (1.0 - self.share) * x;
        if share >= 1.0 {
            return points.to_vec();
        }
        let both = self.job.points.iter().zip(points);
        both.map(|(from, to)| *from + (*to - *from) * share).collect()
    }

    /// The curve on the path to the fairest, accurate enough for counts.
    fn rough(&mut self, x: f64) -> Result<Vec<Vec3<f64>>, FairError> {
        if x == 0.0 {
            return Ok(self.goal.points.clone());
        }
        if x >= 1.0 || self.goal.weight == 0.0 {
            return Ok(self.towards(&self.fairest.points, x.min(1.0)));
        }
        self.parts.pull = None;
        let found = self.parts.within(&self.pull, self.budget(x) * self.mean)?;
        let points = match found {
            Some(found) => found.optimum.points,
            None => self.exact(x)?.points,
        };
        Ok(self.towards(&points, x))
    }

    /// The optimum of a budget on the path.
    fn exact(&mut self, x: f64) -> Result<DataFit, FairError> {
        let goal = if x < 1.0 && self.goal.weight > 0.0 {
            Goal::Budget(self.budget(x))
        } else {
            Goal::Fairest
        };
        let options = DataOptions { goal, ..self.plain.clone() };
        let known = Some(self.fairest.clone());
        let found = self.data.found(&options, self.job, &mut self.parts, known)?;
        Ok(self.data.fit(found, self.job))
    }

    /// The data at parameters between their own and the lengths.
    fn between(&self, y: f64) -> Result<Option<Data>, FairError> {
        let Some(turned) = &self.turned else { return Ok(None) };
        let at: Vec<f64> = turned.own.iter().zip(turned.at).map(|(a, b)| a + (b - a) * y).collect();
        let layout = &self.data.layout;
        let space = &layout.space;
        let closed = space.is_closed() || layout.owner.first() == layout.owner.last();
        let layout = InterpolationSpace::new(space.degree(), &at, &layout.break_data(), closed)?;
        Ok(Some(Data { layout, ..self.data.clone() }))
    }

    /// The curve at a position of the path, with its layout if that differs.
    fn made(&mut self, x: f64) -> Result<Relaid, FairError> {
        if x == 0.0 {
            return Ok((None, self.goal.clone()));
        }
        if x >= 2.0 {
            let layout = self.turned.as_ref().map(|t| t.lengths.layout.clone());
            return Ok((layout, self.calm.clone()));
        }
        if x <= 1.0 {
            let fit = self.exact(x)?;
            if self.share >= 1.0 {
                return Ok((None, fit));
            }
            let points = self.towards(&fit.points, x);
            return Ok((None, self.measured(points)?));
        }
        let y = x - 1.0;
        match self.between(y)? {
            Some(data) => {
                let options = DataOptions { goal: Goal::Fairest, ..self.plain.clone() };
                let job = data.job()?;
                let mut parts = data.parts(&options, &job)?;
                let fit = data.along(&options, &job, &mut parts)?;
                Ok((Some(data.layout), fit))
            }
            None => {
                let both = self.fairest.points.iter().zip(&self.calm.points);
                let points = both.map(|(p, q)| *p + (*q - *p) * y).collect();
                Ok((None, self.measured(points)?))
            }
        }
    }

    /// The position from which on no curve of the path has more bends than allowed: an integral of
    /// the largest excess from each position on.
    fn position(&mut self, limits: &CountLimits) -> Result<f64, FairError> {
        // Few knots have few ripples, and many data take long.
        let steps = if self.data.layout.interpolates() { BUDGET_STEPS } else { SHAPED_STEPS };
        let fairest = limits.beyond(&self.counter, &self.fairest.points);
        let (mut x, mut over) = (0.0, fairest);
        for k in (0..steps).rev() {
            if over < HELD {
                let points = self.rough(k as f64 / steps as f64)?;
                over = over.max(limits.beyond(&self.counter, &points));
            }
            x += (over / HELD).min(1.0);
        }
        // Whole steps add up to the end of the path, to the bit.
        x /= steps as f64;
        let on = ((fairest - HELD) / (EXCEEDS - HELD)).clamp(0.0, 1.0);
        if on == 0.0 {
            return Ok(x);
        }
        let (mut y, mut over) = (0.0, 0.0_f64);
        for k in (0..PARAMETER_STEPS).rev() {
            if over < HELD {
                let (layout, fit) = self.made(1.0 + k as f64 / PARAMETER_STEPS as f64)?;
                let beyond = match &layout {
                    Some(layout) => limits.beyond(&BendCounter::new(&layout.space), &fit.points),
                    None => limits.beyond(&self.counter, &fit.points),
                };
                over = over.max(beyond);
            }
            y += (over / HELD).min(1.0);
        }
        Ok(x + on * (y / PARAMETER_STEPS as f64))
    }

    /// A curve between optima; its gap is its excess over the minimum.
    fn measured(&self, points: Vec<Vec3<f64>>) -> Result<DataFit, FairError> {
        let options = &self.plain;
        let rows = options.measure.rows(&self.data.layout.space)?;
        let value = crate::measure::value(&rows, options.measure.norm(), &points);
        let mut fit = self.data.between_optima(points, value, self.job);
        fit.certificate.gap = (value - self.least).max(0.0);
        Ok(fit)
    }
}

impl Data {
    /// The curve of the goal `near` or `budget`, or one on the path from it to the fairest.
    /// `turned` is the source of the parameters if they follow the turns.
    pub(super) fn gated<'a>(
        &'a self,
        options: &DataOptions,
        job: &'a Job,
        turned: Option<TurnedFrom<'a>>,
    ) -> Result<Relaid, FairError> {
        let plain = DataOptions { bends: true, ..options.clone() };
        let mut parts = self.parts(&plain, job)?;
        let found = self.found(&plain, job, &mut parts, None)?;
        let (fairest, least, share) = (found.fairest.clone(), found.least, found.share);
        let (used, fairest_used) = (found.used, found.fairest_used);
        let goal = self.fit(found, job);
        let counter = BendCounter::new(&self.layout.space);
        let plane = || shape::plane_normal(&counter.samples(&goal.points)).is_some();
        let Some(fairest) = fairest.filter(|_| plane()) else { return Ok((None, goal)) };
        let calm = {
            let options = DataOptions { goal: Goal::Fairest, ..options.clone() };
            fair_data(turned.as_ref().map_or(self, |t| t.lengths), &options)?
        };
        let least_bent = match &turned {
            Some(t) => BendCounter::new(&t.lengths.layout.space).soft(&calm.points, LATE),
            None => counter.soft(&calm.points, LATE),
        };
        let both = [least_bent, counter.soft(&fairest.points, LATE)];
        let limits = CountLimits::of(&both);
        let pull = self.pull(&parts);
        let mean = (pull.len() as f64 / 3.0).max(f64::MIN_POSITIVE);
        let own = match options.goal {
            _ if share > LEAST_SHARE => used / (share * share),
            Goal::Near(b) | Goal::Budget(b) => b.min(fairest_used),
            _ => used,
        };
        let top = fairest_used.max(LEAST_WAY * own);
        let mut path = FairingPath {
            data: self,
            job,
            plain,
            parts,
            pull,
            goal,
            fairest,
            least,
            share,
            budgets: [own, top],
            mean,
            calm,
            turned,
            counter,
        };
        let x = path.position(&limits)?;
        let (layout, fit) = path.made(x)?;
        Ok((layout, DataFit { fairest_used, fairer: x, ..fit }))
    }
}

/// Fairs data as [`fair_data`] does; where their parameters follow the turns it may do so with
/// others, nearer to the lengths.
///
/// # Errors
/// As [`fair_data`].
pub(super) fn fair_turned<'a>(
    data: &'a Data,
    options: &DataOptions,
    turned: Option<TurnedFrom<'a>>,
) -> Result<Relaid, FairError> {
    if turned.is_none() || !options.is_gated() || !options.shape.is_empty() {
        return Ok((None, fair_data(data, options)?));
    }
    let job = data.job()?;
    data.gated(options, &job, turned)
}

impl Data {
    /// The same under a shape: the budget rises until the curve has no more inflections than the
    /// fairest of that shape and as many pieces as it may have.
    pub(super) fn gated_shape(
        &self,
        options: &DataOptions,
        job: &Job,
    ) -> Result<DataFit, FairError> {
        let loose = DataOptions { shape: options.shape.without_pieces(), ..options.clone() };
        let goal = self.under_shape(&loose, job)?;
        let counter = BendCounter::new(&self.layout.space);
        let samples = counter.samples(&goal.points);
        let asked = options.shape.most_pieces();
        let allowed = |pieces: usize| asked.is_none_or(|most| pieces <= most);
        let own = BendCounts::of(&samples).pieces;
        let stays = goal.points == job.points && allowed(own);
        if stays || shape::plane_normal(&samples).is_none() {
            return if allowed(own) { Ok(goal) } else { self.under_shape(options, job) };
        }
        let fairest =
            self.under_shape(&DataOptions { goal: Goal::Fairest, ..loose.clone() }, job)?;
        let calm = counter.samples(&fairest.points);
        if !allowed(BendCounts::of(&calm).pieces) {
            return self.under_shape(options, job);
        }
        let mut limits = CountLimits::of(&[counter.soft(&fairest.points, LATE)]);
        let counts = BendCounts::of(&calm);
        let mut most = counts.pieces as f64 + MORE_PIECES;
        if let Some(asked) = asked.map(|asked| asked as f64) {
            most = most.min(asked);
            limits.0.pieces = limits.0.pieces.min(asked);
        }
        let held = |samples: &[Sample]| {
            let own = BendCounts::of(samples);
            own.signs <= counts.signs && own.pieces as f64 <= most
        };
        if limits.beyond(&counter, &goal.points) == 0.0 && held(&samples) {
            return Ok(goal);
        }
        let begin = goal.used.max(f64::MIN_POSITIVE);
        let end = fairest.used.max(LEAST_WAY * begin);
        let made = |x: f64| {
            let goal = Goal::Budget(begin * libm::pow(end / begin, x));
            self.under_shape(&DataOptions { goal, ..loose.clone() }, job)
        };
        let (mut x, mut over) = (0.0, limits.beyond(&counter, &goal.points));
        for k in 0..SHAPED_STEPS {
            if k > 0 {
                let fit = made(k as f64 / SHAPED_STEPS as f64)?;
                over = over.min(limits.beyond(&counter, &fit.points));
            }
            if over == 0.0 {
                break;
            }
            x += over / SHAPED_STEPS as f64;
        }
        while x < 1.0 {
            let fit = made(x)?;
            if held(&counter.samples(&fit.points)) {
                return Ok(DataFit { fairer: x, fairest_used: fairest.used, ..fit });
            }
            x += 1.0 / SHAPED_STEPS as f64;
        }
        Ok(DataFit { fairer: 1.0, ..fairest })
    }
}
