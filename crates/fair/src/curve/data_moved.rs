//! Curves near data with derivatives: how they answer to the data, tolerances, parameters and joins.

use crate::curve::data::{Data, DataFit, DataOptions, fair_data};
use crate::curve::demand::Demand;
use crate::curve::moving::{MapReal, MovingRows, MovingSpace};
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

/// The same with the demands behind the conditions: derivatives include those of joins.
pub(super) fn fair_data_under<T: Real>(
    data: &Data,
    options: &DataOptions,
    numbers: DataNumbers<'_, T>,
) -> Result<(MovingFit<T>, DataFit), FairError> {
    let DataNumbers { points, tolerances, at, demands } = numbers;
    let still = numbers.are_constant();
    let joins = demands.iter().all(|(_, demand)| matches!(demand, Demand::Join(_)));
    let known = options.conditions.is_empty() || (joins && !demands.is_empty());
    if !options.shape.is_empty() || !known || !options.bends {
        if !still {
            return Err(FairError::NoDerivative(
                "no derivatives are available for curves with conditions on shape, points or \
                inflections: remove the conditions",
            ));
        }
        let made = fair_data(data, options)?;
        return Ok((MovingFit::still(&data.layout, &made), made));
    }
    if !data.layout.interpolates() {
        if !still {
            return Err(FairError::NoDerivative(
                "no derivatives are available for curves with fewer knots than points: name a \
                spacing",
            ));
        }
        let made = fair_data(data, options)?;
        return Ok((MovingFit::still(&data.layout, &made), made));
    }
    let job = data.job()?;
    let mut parts = data.parts(options, &job)?;
    let found = data.found(options, &job, &mut parts)?;
    let (share, weight) = (found.share, found.weight);
    let layout = &data.layout;
    let (sites, knots) = layout.moving(at);
    if still {
        let points = found.optimum.points.iter().map(|&p| Vec3::lifted(p)).collect();
        return Ok((MovingFit { points, knots }, data.fit(found, &job)));
    }
    let space = MovingSpace { space: &layout.space, knots: &knots };
    let values = MovingRows { rows: sites.iter().map(|&t| space.value(t)).collect() };
    let wanted = layout.moving_data(points, at, &sites);
    // Change of the control points for which the curve of `of` follows the data at the sites while
    // knots and sites move.
    let through = |of: &[Vec3<f64>], real: &[Vec3<f64>]| -> Result<Vec<Vec3<T>>, FairError> {
        let lifted: Vec<Vec3<T>> = of.iter().map(|&p| Vec3::lifted(p)).collect();
        let change: Vec<Vec3<T>> = (0..wanted.len())
            .map(|k| {
                let off = wanted[k] - values.apply(k, &lifted);
                off - Vec3::lifted(off.re())
            })
            .collect();
        let change = layout.through(&change)?;
        Ok(real.iter().zip(change).map(|(&p, c)| Vec3::lifted(p) + c).collect())
    };
    let start = through(&job.points, &job.points)?;
    if share == 0.0 {
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
    let mut forces: Vec<Vec3<T>> =
        rows.slope(control).into_iter().map(|v| v - Vec3::lifted(v.re())).collect();
    // Forces at the sites act through rows that move.
    let radii = layout.radii(&data.limit.radii);
    let held = |k: &usize| layout.rows.row(*k).0.iter().all(|&c| parts.frozen[c as usize]);
    let limited: Vec<usize> =
        (0..radii.len()).filter(|k| radii[*k] > 0.0 && radii[*k].is_finite() && !held(k)).collect();
    let away: Vec<Vec3<f64>> = control.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
    let pulls = data.pulls();
    let pulled = |k: &usize| layout.owner[*k].filter(|&i| pulls[i]).map(|i| tolerances[i]);
    for (&k, force) in limited.iter().zip(&solved.forces()) {
        let mut force = *force;
        if pulled(&k).is_some() {
            force += layout.rows.apply(k, &away) * (weight / (radii[k] * radii[k]));
        }
        for &(c, f) in &values.rows[k] {
            let change = f - T::from(f.re());
            forces[c] += force.map_real(|x| change * x);
        }
    }
    let owner = |k: &usize| layout.owner[*k].map(|i| tolerances[i]);
    // A site that is no datum has the largest tolerance near it.
    let largest = |k: usize| {
        let near = layout.sources_of(k).map(|i| tolerances[i]);
        near.reduce(|a, b| if b.re() > a.re() { b } else { a }).unwrap_or_else(T::zero)
    };
    let own: Vec<T> = (0..radii.len())
        .filter(|&k| radii[k] > 0.0)
        .map(|k| owner(&k).unwrap_or_else(|| largest(k)))
        .collect();
    let mut targets: Vec<T> = data.held().into_iter().flat_map(|c| start[c].to_array()).collect();
    let mut bends: Vec<Bend<T>> = Vec::new();
    for (place, demand) in demands {
        let space = MovingSpace { space: &layout.space, knots: &knots };
        for condition in demand.moving(space, &start, *place).transpose()?.into_iter().flatten() {
            let change = |(c, f): (usize, Vec3<T>)| (c, f - Vec3::lifted(f.re()));
            bends.push((targets.len(), condition.entries.into_iter().map(change).collect()));
            targets.push(condition.value);
        }
    }
    let moving = GoalVariation {
        originals: through(control, &job.points)?,
        tolerances: &own,
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
