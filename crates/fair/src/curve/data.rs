//! Data under tolerances: the fairest spline that stays within each datum's tolerance at the
//! datum's own parameter.
//!
//! minimise E(x) subject to |x(t_i) - p_i| <= a_i
//!
//! Knots are at the data ([`InterpolationSpace`]), so that the interpolating spline is a feasible
//! start for any tolerance, 0 included. The distance at a datum's parameter is at least its
//! distance from the curve: the tolerance is guaranteed. The minimum of the measure is at the
//! limits of the tolerances, fair but no nearer to the truth than the data; [`Goal`] selects
//! another curve.

use crate::curve::bends::BendCounter;
use crate::curve::exact::is_exact;
use crate::curve::fit::released;
use crate::curve::job::EndContinuity;
use crate::curve::thinning::CurvesBesideData;
use crate::optimum::goal::{Adaptation, Goal, GoalOptimum, RegularizationPath, rounding};
use crate::optimum::ties::Ties;
use crate::optimum::{Bounded, DataLimits, Optimum, Parts, kept};
use crate::{
    Certificate, Condition, FairError, FoundArc, InterpolationSpace, Job, Limit, Measure,
    ShapeConstraints, SparseRows, shape,
};
use moldloft_num::Vec3;

/// Data with their limits.
#[derive(Clone, Debug)]
pub struct Data {
    /// The data.
    pub points: Vec<Vec3<f64>>,
    /// Maximum distance and directions of motion for each datum.
    pub limit: Limit,
    /// Parameters of the data, and the space of splines.
    pub layout: InterpolationSpace,
    /// Conditions at open ends, relative to the curve through the data.
    pub ends: [EndContinuity; 2],
}

/// Options of a curve near data.
#[derive(Clone, Debug)]
pub struct DataOptions {
    /// The measure to minimise.
    pub measure: Measure,
    /// Selection among the curves within the tolerances.
    pub goal: Goal,
    /// Linear conditions on the control points.
    pub conditions: Vec<Condition>,
    /// Shape conditions, resolved for these data by [`Data::shaped`].
    pub shape: ShapeConstraints,
    /// True to allow inflections beyond those of the curve of least bending within the same
    /// tolerances.
    pub bends: bool,
    /// Certified gap, relative to the measure.
    pub accuracy: f64,
}

impl DataOptions {
    /// The defaults for a measure and a goal: no conditions, a relative gap of 1e-9, inflections
    /// not limited.
    pub fn of(measure: Measure, goal: Goal) -> Self {
        let (conditions, shape) = (Vec::new(), ShapeConstraints::default());
        Self { measure, goal, conditions, shape, bends: true, accuracy: 1e-9 }
    }

    /// True if counts of turns decide how far the result is moved towards the fairest curve.
    pub(super) fn is_gated(&self) -> bool {
        let jumps = matches!(self.measure, Measure::Jumps | Measure::JumpLengths);
        !self.bends && !jumps && matches!(self.goal, Goal::Near(_) | Goal::Budget(_))
    }
}

/// A faired curve.
#[derive(Clone, Debug)]
pub struct DataFit {
    /// Its control points, on the layout's space.
    pub points: Vec<Vec3<f64>>,
    /// Control points of the interpolating curve.
    pub original: Vec<Vec3<f64>>,
    /// The distance of each datum from the curve at its parameter.
    pub residuals: Vec<f64>,
    /// Three times the mean of the squared residuals over the tolerances; 1 for noise that fills
    /// the tolerances evenly.
    pub used: f64,
    /// The measure of the curve and its optimality gap, among the curves within the tolerances
    /// whose sum of squared residuals is no larger.
    pub certificate: Certificate,
    /// The minimum of the measure within the tolerances.
    pub least: f64,
    /// Squares taken by the fairest curve, counted as in [`Self::used`]; 3 if all its tolerances
    /// are reached, 0 if it was not computed.
    pub fairest_used: f64,
    /// The weight of the data relative to the measure.
    pub weight: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Tolerances that are reached.
    pub active: usize,
    /// Arcs among the shape conditions.
    pub arcs: Vec<FoundArc>,
    /// Distance that the curve was moved from the goal's own curve (0) towards the fairest (1; up
    /// to 2 with chord lengths as parameters) to avoid additional turns.
    pub fairer: f64,
}

/// Data in which coincident neighbours are merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The remaining data.
    pub points: Vec<Vec3<f64>>,
    /// Their tolerances.
    pub radii: Vec<f64>,
    /// Index of the merged datum for each given one.
    pub of: Vec<usize>,
}

/// Distance of neighbours, relative to the extent, within which they coincide.
const TOGETHER: f64 = 1e-6;

/// Replaces coincident neighbours by their mean, with a tolerance within all of theirs.
///
/// # Errors
/// [`FairError::Coincident`] when no point is within the tolerances of both.
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

impl Data {
    /// The parts of the optimum that are the same for all weights of the data.
    pub(super) fn parts<'a>(
        &self,
        options: &DataOptions,
        job: &'a Job,
    ) -> Result<Parts<'a>, FairError> {
        self.parts_at(options, job, &job.points)
    }

    /// `parts_at` with the shape made linear at a curve.
    fn parts_at<'a>(
        &self,
        options: &DataOptions,
        job: &'a Job,
        control: &[Vec3<f64>],
    ) -> Result<Parts<'a>, FairError> {
        let mut parts = self.unshaped_parts(options, job)?;
        self.shape_parts(&mut parts, options, control);
        Ok(parts)
    }

    /// Adds the shape to parts without one.
    fn shape_parts(&self, parts: &mut Parts<'_>, options: &DataOptions, control: &[Vec3<f64>]) {
        parts.conditions.extend(options.shape.conditions(control).into_iter().map(|(c, _)| c));
        parts.halves = options.shape.halves(self, &parts.frozen, control);
    }

    /// The parts but for the shape.
    pub(super) fn unshaped_parts<'a>(
        &self,
        options: &DataOptions,
        job: &'a Job,
    ) -> Result<Parts<'a>, FairError> {
        let layout = &self.layout;
        let radii = layout.radii(&self.limit.radii);
        let (mut frozen, mut conditions) = kept(job);
        // The position of an end is a datum; the other derivatives are conditions, so that they
        // follow the curve through the data when these change.
        let n = frozen.len();
        let held: Vec<usize> = self.held();
        for &c in &held {
            frozen[c] = false;
        }
        if !layout.space.is_closed() {
            for (end, c) in self.ends.into_iter().zip([0, n - 1]) {
                frozen[c] |= end != EndContinuity::Free && end != EndContinuity::Points(0);
            }
        }
        for &m in &layout.marks {
            frozen[layout.control_of(m)] = true;
        }
        for c in self.fixed_control(&radii) {
            frozen[c] = true;
        }
        let mut short = layout.short_conditions(&mut frozen);
        let rigid = short.len();
        short.append(&mut conditions);
        let mut conditions = short;
        // A datum without tolerance stays on the curve.
        for k in (0..radii.len()).filter(|&k| radii[k] == 0.0) {
            let (columns, factors) = layout.rows.row(k);
            // At an end all but one of the factors are zero: that control point is the datum.
            let parts = || columns.iter().zip(factors).filter(|(_, f)| **f != 0.0);
            if parts().all(|(&c, _)| frozen[c as usize]) {
                continue;
            }
            if parts().count() == 1 {
                parts().for_each(|(&c, _)| frozen[c as usize] = true);
                continue;
            }
            for axis in crate::curve::condition::AXES {
                let entries: Vec<_> = parts().map(|(&c, &f)| (c as usize, axis * f)).collect();
                let mut condition = Condition { entries, value: 0.0 };
                condition.value = condition.at(&job.points);
                conditions.push(condition);
            }
        }
        let own = conditions.len();
        for &c in &held {
            for axis in crate::curve::condition::AXES {
                let entries = vec![(c, axis)];
                conditions.push(Condition { entries, value: axis.dot(job.points[c]) });
            }
        }
        conditions.extend(options.conditions.iter().cloned());
        let mut rows = SparseRows::new();
        let mut own_radii = Vec::new();
        for k in (0..radii.len()).filter(|&k| radii[k] > 0.0 && !layout.free[k]) {
            let (columns, factors) = layout.rows.row(k);
            rows.push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()));
            own_radii.push(radii[k]);
        }
        // Where the curve is free it is within the extent of the data.
        let extent = self.points.iter().map(|p| (*p - self.points[0]).norm()).fold(0.0, f64::max);
        let most = |k: usize| match radii[k] {
            _ if layout.free[k] => extent,
            r if r.is_finite() => r,
            _ => 0.0,
        };
        let mut finite: Vec<f64> = (0..radii.len()).map(most).collect();
        let (mut offsets, mut begin) = (Vec::new(), Vec::new());
        if let Some(thin) = &layout.thin {
            offsets = (0..finite.len())
                .map(|k| layout.rows.apply(k, &job.points) - self.points[k])
                .collect();
            for (most, off) in finite.iter_mut().zip(&offsets) {
                *most += off.norm();
            }
            begin = thin.centre.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
        }
        let bounded = |k: usize| layout.free[k] || radii[k].is_finite();
        let reach = if (0..radii.len()).all(bounded) {
            layout.reach(&finite)?
        } else {
            vec![f64::INFINITY; job.points.len()]
        };
        Ok(Parts {
            held: &[],
            ties: Ties::default(),
            points: &job.points,
            relative: job.points.clone(),
            centred: false,
            limit: &job.limit,
            measure: options.measure.rows(&layout.space)?,
            norm: options.measure.norm(),
            frozen,
            conditions,
            rigid,
            own,
            bounded: Bounded::Data(DataLimits { rows, radii: own_radii, offsets, reach }),
            halves: Vec::new(),
            pull: None,
            accuracy: options.accuracy,
            begin,
        })
    }

    /// The control points about which all data are without tolerance: between these the curve stays as it is, to the
    /// bit.
    fn fixed_control(&self, radii: &[f64]) -> Vec<usize> {
        if radii.iter().all(|&r| r > 0.0) {
            return Vec::new();
        }
        let mut fixed = vec![true; self.layout.space.count()];
        for k in (0..radii.len()).filter(|&k| radii[k] > 0.0) {
            let (columns, factors) = self.layout.rows.row(k);
            let near = columns.iter().zip(factors).filter(|(_, f)| **f != 0.0);
            near.for_each(|(&c, _)| fixed[c as usize] = false);
        }
        (0..fixed.len()).filter(|&c| fixed[c]).collect()
    }

    /// The control points beside the ends that these keep.
    pub(super) fn held(&self) -> Vec<usize> {
        if self.layout.space.is_closed() {
            return Vec::new();
        }
        let n = self.layout.space.count();
        let [first, last] = self.ends.map(|e| match e {
            EndContinuity::Points(k) => k.min(n),
            e => e.kept(),
        });
        (1..first).chain((n - last.max(1)..n - 1).filter(move |&c| c >= first.max(1))).collect()
    }

    /// True if the data are exact between breaks.
    pub(super) fn exact_parts(&self) -> bool {
        let layout = &self.layout;
        let closed = layout.space.is_closed() || layout.owner.first() == layout.owner.last();
        is_exact(&self.points, &layout.break_data(), closed)
    }

    /// Data that attract the curve: those with a positive, finite tolerance that were not released.
    pub(super) fn pulls(&self) -> Vec<bool> {
        let open = released(&self.points, &self.limit.radii);
        let given = self.limit.radii.iter().map(|r| *r > 0.0 && r.is_finite());
        given.zip(open).map(|(given, open)| given && !open).collect()
    }

    /// The data that pull, as rows of displacements over tolerances.
    pub(super) fn pull(&self, parts: &Parts<'_>) -> SparseRows {
        let mut pull = SparseRows::new();
        let pulls = self.pulls();
        for (k, owner) in self.layout.owner.iter().enumerate() {
            let Some(i) = owner.filter(|&i| pulls[i]) else { continue };
            let radius = self.limit.radii[i];
            let (columns, factors) = self.layout.rows.row(k);
            let free = columns.iter().any(|&c| !parts.frozen[c as usize]);
            if free {
                let entries = columns.iter().zip(factors);
                pull.push(entries.map(|(&c, &f)| (c as usize, f / radius)));
            }
        }
        pull
    }

    /// The distances of the data from a curve at the data's parameters.
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

    /// The curve through the data, or of few control points the nearest to them, as a job with these limits' motion.
    pub(super) fn job(&self) -> Result<Job, FairError> {
        let points = match &self.layout.thin {
            Some(thin) => thin.nearest.clone(),
            None => self.layout.through(&self.layout.data(&self.points))?,
        };
        let limit = Limit { motion: self.limit.motion, radii: vec![f64::INFINITY; points.len()] };
        let (space, ends) = (self.layout.space.clone(), self.ends);
        Ok(Job { space, points, weights: None, limit, marks: Vec::new(), ends })
    }
}

impl InterpolationSpace {
    /// The control point of a mark.
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
/// use moldloft_fair::{Data, DataOptions, EndContinuity, Goal, InterpolationSpace, Limit, Measure, ParameterSpacing, fair_data,
///     parameters};
/// use moldloft_num::Vec3;
/// // A straight line at uneven stations, with one reading off by 0.01.
/// let stations = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0];
/// let off = |x: f64| if x == 4.0 { 0.01 } else { 0.0 };
/// let points: Vec<_> = stations.map(|x| Vec3::of(x, 0.1 * x + off(x), 0.0)).to_vec();
/// let at = parameters(&points, ParameterSpacing::Along(Vec3::of(1.0, 0.0, 0.0)), false).unwrap();
/// let data = Data {
///     limit: Limit::ball(points.len(), 0.02).unwrap(),
///     layout: InterpolationSpace::new(3, &at, &[], false).unwrap(),
///     ends: [EndContinuity::Free; 2],
///     points,
/// };
/// let options = DataOptions::of(Measure::Variation, Goal::Fairest);
/// let faired = fair_data(&data, &options).unwrap();
/// assert!(faired.residuals.iter().all(|&r| r <= 0.02));
/// assert!(faired.certificate.value < 1e-12);
/// ```
pub fn fair_data(data: &Data, options: &DataOptions) -> Result<DataFit, FairError> {
    let job = data.job()?;
    if !options.shape.is_empty() {
        if options.is_gated() {
            return data.budgeted_shape(options, &job);
        }
        return data.under_shape(options, &job);
    }
    if options.is_gated() {
        return Ok(data.gated(options, &job, None)?.1);
    }
    let jumps = matches!(options.measure, Measure::Jumps | Measure::JumpLengths);
    let mut parts = data.parts(options, &job)?;
    let found = data.found(options, &job, &mut parts, None)?;
    let plain = data.fit(found, &job);
    if options.bends || jumps || plain.points == job.points {
        return Ok(plain);
    }
    let counter = BendCounter::new(&data.layout.space);
    if shape::plane_normal(&counter.samples(&plain.points)).is_none() {
        return Ok(plain);
    }
    data.without_bends(options, &job, plain, &counter)
}

/// Times that signs and lines are made linear again at most.
const ROUNDS: usize = 40;

/// Number of iterations after which half steps are taken.
const WHOLE: usize = 12;

/// Number of failed rounds after which signs are required with a margin of the amount missed, and
/// its maximum relative to the mean tolerance.
const PATIENT: usize = 5;
const INSIDE: f64 = 1e-2;

/// Relative change of the measure at which the search for the minimum under signs ends.
const SETTLED: f64 = 1e-8;

/// Minimum budget, relative to the squares of the curve in the middle of the tolerances, counted
/// from the minimum.
const ROOM: f64 = 1.5;

/// The root mean square residual of the nearest curve, over the tolerance, up to which data have no noise, and from
/// which on they have.
const QUIET: f64 = 1e-3;
const NOISE: f64 = 1e-2;

impl Data {
    /// The mean of squared residuals over tolerances, over 1/3.
    pub(super) fn used(&self, residuals: &[f64]) -> f64 {
        let each = residuals.iter().zip(&self.limit.radii).zip(self.pulls());
        let all: Vec<f64> =
            each.filter(|each| each.1).map(|((r, a), _)| (r / a) * (r / a)).collect();
        all.iter().sum::<f64>() * 3.0 / all.len().max(1) as f64
    }

    /// The control points of the curve of least bending within the tolerances.
    pub(super) fn least_bending(
        &self,
        options: &DataOptions,
        job: &Job,
    ) -> Result<Vec<Vec3<f64>>, FairError> {
        let (measure, goal) = (Measure::Bending, Goal::Fairest);
        let least =
            DataOptions { measure, goal, shape: ShapeConstraints::default(), ..options.clone() };
        let mut own = self.parts(&least, job)?;
        Ok(self.along(&least, job, &mut own)?.points)
    }

    /// True if the data's own curve has the shape but for its count of pieces.
    pub(super) fn meets(&self, shape: &ShapeConstraints, job: &Job) -> bool {
        let own = shape.by(&self.layout.space, &job.points);
        own.miss(self, &job.points, self.slack()).0 <= 0.0
    }

    /// The curve of a goal with the required shape.
    pub(super) fn under_shape(
        &self,
        options: &DataOptions,
        job: &Job,
    ) -> Result<DataFit, FairError> {
        let space = &self.layout.space;
        // Data whose own curve has the shape need not move for it.
        if self.meets(&options.shape, job) && options.shape.counted(space, &job.points).is_none() {
            let plain = DataOptions { shape: ShapeConstraints::default(), ..options.clone() };
            let mut parts = self.parts(&plain, job)?;
            let made = self.along(&plain, job, &mut parts)?;
            if made.points == job.points {
                return Ok(DataFit { arcs: options.shape.arcs.clone(), ..made });
            }
        }
        let stiffest = self.least_bending(options, job)?;
        let plain = options.shape.without_pieces().by(space, &stiffest);
        let mut made = match self.with_signs(options, job, plain, &stiffest) {
            // Signs may be too far from those of the first start.
            Err(e @ FairError::Shape { .. }) => {
                let start = self.fairest(options, job)?;
                let again = options.shape.without_pieces().by(space, &start);
                self.with_signs(options, job, again, &start).map_err(|_| e)?
            }
            other => other?,
        };
        let Some((owner, mut fewest)) = options.shape.counted(space, &made.points) else {
            made.arcs.clone_from(&options.shape.arcs);
            return Ok(made);
        };
        // The pattern of curvature extrema is taken from fairer and fairer curves.
        for start in [made.points.clone(), self.fairest(options, job)?, stiffest] {
            let shape = options.shape.by(space, &start);
            match self.with_signs(options, job, shape, &start) {
                Ok(tried) => match options.shape.counted(space, &tried.points) {
                    None => return Ok(DataFit { arcs: options.shape.arcs.clone(), ..tried }),
                    Some((_, count)) => fewest = fewest.min(count),
                },
                Err(FairError::Shape { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        let why = format!(
            "no curve of so few monotone pieces was found within the tolerance; the fewest found: \
             {fewest}"
        );
        Err(FairError::Shapeless { shape: owner, why })
    }

    /// The control points of the fairest curve by the measure, whatever its shape.
    pub(super) fn fairest(
        &self,
        options: &DataOptions,
        job: &Job,
    ) -> Result<Vec<Vec3<f64>>, FairError> {
        let (goal, shape) = (Goal::Fairest, ShapeConstraints::default());
        let plain = DataOptions { goal, shape, bends: true, ..options.clone() };
        let mut parts = self.parts(&plain, job)?;
        Ok(self.along(&plain, job, &mut parts)?.points)
    }

    /// The curve with the control points of lines and arcs exact to rounding, if all data stay
    /// within their tolerances.
    fn exact(&self, shape: &ShapeConstraints, made: DataFit) -> DataFit {
        let points = shape.projected(&made.points);
        let residuals = self.residuals(&points);
        let within = |(r, most): (&f64, &f64)| *r <= most * (1.0 + 1e-9);
        if residuals.iter().zip(&self.limit.radii).all(within) {
            DataFit { points, residuals, ..made }
        } else {
            made
        }
    }

    /// Residual of equations below which control points may be set exactly: a fraction of the mean
    /// tolerance, at least rounding.
    fn slack(&self) -> f64 {
        let finite = || self.limit.radii.iter().filter(|r| r.is_finite());
        let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
        self.rounding().max(1e-8 * mean)
    }

    fn rounding(&self) -> f64 {
        let first = self.points.first().copied().unwrap_or_default();
        let size =
            self.points.iter().map(|p| p.norm().max((*p - first).norm())).fold(0.0, f64::max);
        64.0 * f64::EPSILON * size
    }

    /// The curve of a goal under signs, which are linearised at a curve, then at the result, until
    /// the result has them and has converged.
    pub(super) fn with_signs(
        &self,
        options: &DataOptions,
        job: &Job,
        shape: ShapeConstraints,
        start: &[Vec3<f64>],
    ) -> Result<DataFit, FairError> {
        let mut control = shape.projected(start);
        let slack = self.slack();
        let asked = options.conditions.len();
        let mut options = DataOptions { shape, ..options.clone() };
        let finite = || self.limit.radii.iter().filter(|r| r.is_finite());
        let most = INSIDE * finite().sum::<f64>() / finite().count().max(1) as f64;
        let mut best: Option<DataFit> = None;
        let mut missed = (f64::INFINITY, 0);
        let unshaped = self.unshaped_parts(&options, job)?;
        for round in 0..ROUNDS {
            let mut parts = unshaped.clone();
            self.shape_parts(&mut parts, &options, &control);
            let tried = self.along(&options, job, &mut parts);
            let made = match tried {
                Err(FairError::Contradiction { conditions, ends, miss }) => {
                    // The shape's own equations come after the caller's.
                    let owners = options.shape.conditions(&control);
                    let mut shapes: Vec<usize> = conditions
                        .iter()
                        .filter_map(|&c| owners.get(c.checked_sub(asked)?).map(|o| o.1))
                        .collect();
                    shapes.dedup();
                    if shapes.is_empty() {
                        return Err(FairError::Contradiction { conditions, ends, miss });
                    }
                    return Err(FairError::Shape { shapes, miss });
                }
                Err(FairError::Shape { .. }) if best.is_some() => break,
                other => other?,
            };
            missed = options.shape.miss(self, &made.points, slack);
            let settled = best.as_ref().is_some_and(|b| {
                let (was, now) = (b.certificate.value, made.certificate.value);
                (was - now).abs() <= SETTLED * now.abs()
            });
            let far = if round < WHOLE { 1.0 } else { 0.5 };
            for (c, p) in control.iter_mut().zip(&made.points) {
                *c += (*p - *c) * far;
            }
            if round >= PATIENT && best.is_none() && missed.0 > 0.0 {
                options.shape.margin = (options.shape.margin + 2.0 * missed.0).min(most);
            }
            if missed.0 <= 0.0 {
                best = Some(self.exact(&options.shape, made));
                if settled {
                    break;
                }
            }
        }
        best.ok_or(FairError::Shape { shapes: vec![missed.1], miss: missed.0 })
    }

    /// The optimum of a goal.
    pub(super) fn along(
        &self,
        options: &DataOptions,
        job: &Job,
        parts: &mut Parts<'_>,
    ) -> Result<DataFit, FairError> {
        Ok(self.fit(self.found(options, job, parts, None)?, job))
    }

    pub(super) fn fit(&self, found: GoalOptimum, job: &Job) -> DataFit {
        let residuals = self.residuals(&found.optimum.points);
        DataFit {
            used: if self.layout.interpolates() { found.used } else { self.used(&residuals) },
            residuals,
            least: found.least,
            fairest_used: found.fairest_used,
            weight: found.weight,
            certificate: found.optimum.certificate,
            iterations: found.optimum.iterations,
            active: found.optimum.active,
            points: found.optimum.points,
            original: job.points.clone(),
            arcs: Vec::new(),
            fairer: 0.0,
        }
    }

    /// Fraction by which data on few control points leave their nearest curve: 0 for data without
    /// noise, 1 with noise.
    fn moves(&self, thin: &CurvesBesideData) -> f64 {
        let residuals = self.residuals(&thin.nearest);
        let within = residuals.iter().zip(&self.limit.radii).all(|(r, most)| r <= most);
        let noise = (self.used(&residuals) / 3.0).sqrt();
        let share = ((noise - QUIET) / (NOISE - QUIET)).clamp(0.0, 1.0);
        if within { share * share * (3.0 - 2.0 * share) } else { 1.0 }
    }

    /// On a spline with few control points squares are counted from their minimum, and so is the
    /// budget of `near`: that of the goal for noise that fills the tolerances, and at least the
    /// part of the actual noise that these control points absorb. The true curve is within it about
    /// half of the time.
    fn goal_beside_nearest<E, S>(
        &self,
        goal: Goal,
        path: &RegularizationPath<'_, E, S>,
        parts: &Parts<'_>,
        pull: &SparseRows,
    ) -> Goal {
        let (Some(thin), Goal::Near(share)) = (&self.layout.thin, goal) else { return goal };
        let mean = path.count.max(1) as f64 / 3.0;
        let least = self.used(&self.residuals(&thin.nearest)) * mean;
        let free = parts.frozen.iter().filter(|f| !**f).count();
        let taken = least * free as f64 / path.count.saturating_sub(free).max(1) as f64;
        let most = (share * mean - least).max(taken).max(ROOM * pull.sum_sq(&parts.begin));
        Goal::Near(most / mean)
    }

    /// As `along`; `fairest` is the fairest curve of these parts, where it is known.
    pub(super) fn found(
        &self,
        options: &DataOptions,
        job: &Job,
        parts: &mut Parts<'_>,
        fairest: Option<Optimum>,
    ) -> Result<GoalOptimum, FairError> {
        let pull = self.pull(parts);
        let (rows, norm) = (parts.measure.clone(), parts.norm);
        let still = self.limit.radii.iter().all(|&r| r == 0.0);
        let fair = matches!(options.goal, Goal::Near(_)) && self.exact_parts();
        let conditioned = !options.conditions.is_empty() || !options.shape.is_empty();
        if !conditioned && (still || fair) {
            let value = crate::measure::value(&rows, norm, &job.points);
            return Ok(GoalOptimum::unmoved(&job.points, value, still));
        }
        let order = options.measure.derivative_order();
        let order = order.filter(|_| !conditioned && parts.halves.is_empty());
        let frozen = parts.frozen.clone();
        let nearest = order.map(|order| {
            let frozen = &frozen;
            move |fairest: Optimum| self.nearest_fairest(order, frozen, fairest)
        });
        let path = RegularizationPath {
            energy: |points: &[Vec3<f64>]| crate::measure::value(&rows, norm, points),
            squares: |points: &[Vec3<f64>]| {
                let moved: Vec<_> = points.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
                pull.sum_sq(&moved)
            },
            count: pull.len(),
            noise: rounding(&rows, norm, &job.points),
            original: &job.points,
            adapts: Adaptation::None,
            known: None,
            moves: self.layout.thin.as_ref().map(|thin| self.moves(thin)),
            nearest: nearest.as_ref().map(|nearest| nearest as &dyn Fn(Optimum) -> _),
            fairest,
        };
        let goal = self.goal_beside_nearest(options.goal, &path, parts, &pull);
        path.follow(goal, norm, conditioned, parts, &pull)
    }
}
