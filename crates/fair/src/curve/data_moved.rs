//! Curves near data with derivatives: how they answer to the data, tolerances, parameters and joins.

use crate::curve::data::{Data, DataFit, DataOptions, fair_data};
use crate::curve::demand::Demand;
use crate::curve::moving::{MovingRows, MovingSites, MovingSpace};
use crate::optimum::Bend;
use crate::optimum::goal::{GoalVariation, check_single, check_unique, moved};
use crate::{FairError, InterpolationSpace, Measure};
use moldloft_num::{Real, Vec3};

/// A faired curve whose control points and knots carry derivatives.
#[derive(Clone, Debug)]
pub struct MovingFit<T> {
    /// The control points on the layout's space.
    pub points: Vec<Vec3<T>>,
    /// The space's knots.
    pub knots: Vec<T>,
}

impl<T: Real> MovingFit<T> {
    /// A curve that stays as it is.
    pub(super) fn still(layout: &InterpolationSpace, fit: &DataFit) -> Self {
        let points = fit.points.iter().map(|&p| Vec3::lifted(p)).collect();
        let knots = layout.space.knots().iter().map(|&k| T::from(k)).collect();
        Self { points, knots }
    }
}

/// Numbers of data that carry derivatives.
#[derive(Clone, Copy)]
pub(super) struct DataNumbers<'a, T> {
    pub points: &'a [Vec3<T>],
    /// One per datum.
    pub tolerances: &'a [T],
    /// Parameters.
    pub at: &'a [T],
    /// The demands behind the options' conditions.
    pub demands: &'a [(f64, Demand<T>)],
}

impl<T: Real> DataNumbers<'_, T> {
    /// True if nothing carries a derivative.
    fn are_constant(&self) -> bool {
        let mut numbers = self.points.iter().flat_map(|p| p.to_array());
        let mut others = self.at.iter().chain(self.tolerances);
        numbers.all(|x| x.is_constant())
            && others.all(|x| x.is_constant())
            && self.demands.iter().all(|(_, demand)| demand.is_constant())
    }
}

/// As `fair_data`, for data, tolerances (one per datum) and parameters that carry derivatives,
/// whose real parts are those of the data. Derivatives follow from the optimality conditions by the
/// implicit function theorem, including those of knots and parameters, provided that the only
/// conditions are those of the ends and inflections are not limited (`bends`).
///
/// # Errors
/// As [`fair_data`]; [`FairError::NoDerivative`] for the goal `nearest`, and for sums of lengths on knots
/// that move.
pub fn fair_data_with<T: Real>(
    data: &Data,
    options: &DataOptions,
    points: &[Vec3<T>],
    tolerances: &[T],
    at: &[T],
) -> Result<(MovingFit<T>, DataFit), FairError> {
    fair_data_under(data, options, DataNumbers { points, tolerances, at, demands: &[] })
}

/// `fair_data` with derivatives and the demands behind the conditions: derivatives include those of joins.
pub(super) fn fair_data_under<T: Real>(
    data: &Data,
    options: &DataOptions,
    numbers: DataNumbers<'_, T>,
) -> Result<(MovingFit<T>, DataFit), FairError> {
    let still = numbers.are_constant();
    if let Some(why) = without_derivatives(data, options, numbers.demands) {
        if !still {
            return Err(FairError::NoDerivative(why));
        }
        let made = fair_data(data, options)?;
        return Ok((MovingFit::still(&data.layout, &made), made));
    }
    let job = data.job()?;
    let mut parts = data.parts(options, &job)?;
    let found = data.found(options, &job, &mut parts, None)?;
    let layout = &data.layout;
    let (at, knots) = layout.moving(numbers.at);
    if still {
        let points = found.optimum.points.iter().map(|&p| Vec3::lifted(p)).collect();
        return Ok((MovingFit { points, knots }, data.fit(found, &job)));
    }
    let space = MovingSpace { space: &layout.space, knots: &knots };
    let sites = MovingSites {
        values: MovingRows { rows: at.iter().map(|&t| space.value(t)).collect() },
        wanted: layout.moving_data(numbers.points, numbers.at, &at),
    };
    let through =
        |of: &[Vec3<f64>]| sites.through(of, &job.points, |values| layout.through(values));
    let start = through(&job.points)?;
    if found.share == 0.0 {
        return Ok((MovingFit { points: start, knots }, data.fit(found, &job)));
    }
    if !knots.iter().all(|t| t.is_constant()) {
        check_single(&found, crate::measure::value(&parts.measure, parts.norm, &job.points))?;
    }
    if parts.norm != crate::RowNorm::Square {
        return Err(FairError::NoDerivative(
            "no derivatives are available for a sum of lengths with moving knots: use another \
            measure, or spacing \"index\"",
        ));
    }
    // The optimum for the weight found, with the factors that derivatives need.
    let weight = found.weight;
    let pull = data.pull(&parts);
    check_unique(&mut parts, &found, &pull)?;
    parts.pull = (weight > 0.0).then(|| pull.clone().scaled(weight.sqrt()));
    let solved = parts.whole()?;
    // Jumps have too few digits, and a softened problem gives approximate derivatives only.
    if weight > 0.0 && options.measure != Measure::Jumps && !solved.is_decided() {
        return Err(FairError::NoDerivative(
            "the set of reached tolerances is undecided within rounding, so no derivatives are \
            available: use another tolerance",
        ));
    }
    let control = &solved.optimum.points;
    let rows = space.measure(options.measure)?;
    let mut forces = rows.forces(control);
    // Forces at the sites act through rows that move.
    let radii = layout.radii(&data.limit.radii);
    let held = |k: &usize| layout.rows.row(*k).0.iter().all(|&c| parts.frozen[c as usize]);
    let limited: Vec<usize> =
        (0..radii.len()).filter(|k| radii[*k] > 0.0 && radii[*k].is_finite() && !held(k)).collect();
    let away: Vec<Vec3<f64>> = control.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
    let pulls = data.pulls();
    let pulled = |k: &usize| layout.owner[*k].filter(|&i| pulls[i]).map(|i| numbers.tolerances[i]);
    for (&k, force) in limited.iter().zip(&solved.forces()) {
        let mut force = *force;
        if pulled(&k).is_some() {
            force += layout.rows.apply(k, &away) * (weight / (radii[k] * radii[k]));
        }
        sites.act(k, force, &mut forces);
    }
    let (targets, bends) = moving_conditions(data, space, &start, numbers.demands)?;
    let moving = GoalVariation {
        originals: through(control)?,
        tolerances: &site_tolerances(layout, &radii, numbers.tolerances),
        pulled: limited.iter().filter_map(pulled).collect(),
        targets: &targets,
        forces,
        rows: &rows,
        bends: &bends,
        budget: T::zero(),
        start: &start,
    };
    let points = moved(&parts, &solved, options.goal, &found, &pull, moving)?;
    Ok((MovingFit { points, knots }, data.fit(found, &job)))
}

/// The reason for which a curve has no derivatives.
fn without_derivatives<T: Real>(
    data: &Data,
    options: &DataOptions,
    demands: &[(f64, Demand<T>)],
) -> Option<&'static str> {
    let joins = demands.iter().all(|(_, demand)| matches!(demand, Demand::Join(_)));
    let known = options.conditions.is_empty() || (joins && !demands.is_empty());
    if !options.shape.is_empty() || !known || !options.bends {
        Some(
            "no derivatives are available for curves with conditions on shape, points or \
            inflections: remove the conditions",
        )
    } else if !data.layout.interpolates() {
        Some(
            "no derivatives are available for curves with fewer knots than points: name a \
            spacing",
        )
    } else {
        None
    }
}

/// Tolerances of the sites with limits: those of the data, and at other sites the largest near them.
fn site_tolerances<T: Real>(
    layout: &InterpolationSpace,
    radii: &[f64],
    tolerances: &[T],
) -> Vec<T> {
    let largest = |k: usize| {
        let near = layout.sources_of(k).map(|i| tolerances[i]);
        near.reduce(|a, b| if b.re() > a.re() { b } else { a }).unwrap_or_else(T::zero)
    };
    let own = |k: usize| layout.owner[k].map_or_else(|| largest(k), |i| tolerances[i]);
    (0..radii.len()).filter(|&k| radii[k] > 0.0).map(own).collect()
}

/// Values of the conditions of held points and demands, and the changes of the demands' factors.
fn moving_conditions<T: Real>(
    data: &Data,
    space: MovingSpace<'_, T>,
    start: &[Vec3<T>],
    demands: &[(f64, Demand<T>)],
) -> Result<(Vec<T>, Vec<Bend<T>>), FairError> {
    let mut targets: Vec<T> = data.held().into_iter().flat_map(|c| start[c].to_array()).collect();
    let mut bends: Vec<Bend<T>> = Vec::new();
    for (place, demand) in demands {
        let space = MovingSpace { ..space };
        for condition in demand.moving(space, start, *place).transpose()?.into_iter().flatten() {
            let change = |(c, f): (usize, Vec3<T>)| (c, f - Vec3::lifted(f.re()));
            bends.push((targets.len(), condition.entries.into_iter().map(change).collect()));
            targets.push(condition.value);
        }
    }
    Ok((targets, bends))
}
