//! What a model asks of a curve near its points besides the tolerance.

use super::figures::FairFigures;
use super::{ACCURACY, Intent};
use crate::{
    Condition, Data, DataFinding, DataOptions, FairError, InterpolationSpace, Limit,
    ShapeCondition, Space, curvature_parameters, data_findings, fair_data_with, near_budget,
    parameters_across,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use moldloft_spline::SplineWithKnotDerivatives;
use std::sync::Arc;

/// A condition at a parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Demand {
    Through(Vec3<f64>),
    Tangent(Vec3<f64>),
    Area,
    Volume,
    Centroid,
}

impl Demand {
    /// What it asks of control points that are at `control` before; the parameter is a share of the domain.
    pub fn conditions(self, space: &Space, control: &[Vec3<f64>], share: f64) -> Vec<Condition> {
        let (a, b) = space.domain();
        let t = a + (b - a) * share;
        match self {
            Demand::Through(p) => Condition::point(space, t, p),
            Demand::Tangent(d) => Condition::tangent(space, t, d),
            Demand::Area => vec![Condition::area(space, control, Vec3::of(0.0, 0.0, 1.0))],
            Demand::Volume => vec![Condition::revolution(space, control, Vec3::of(1.0, 0.0, 0.0))],
            Demand::Centroid => Condition::centroid(control),
        }
    }
}

/// All that is asked.
pub(crate) struct Demands<T> {
    pub shape: Vec<ShapeCondition>,
    /// Conditions with their parameters in [0, 1].
    pub conditions: Vec<(f64, Demand)>,
    pub tolerances: Option<Vec<T>>,
    /// Points, from 1.
    pub fixed: Vec<usize>,
    pub release: Vec<usize>,
    pub bends: bool,
    /// Parameters of the points, given one by one.
    pub at: Option<Vec<T>>,
}

/// The shapes that texts ask for, of `count` points; the field of the texts.
pub(crate) fn shapes_of(
    texts: Option<&[Arc<str>]>,
    count: usize,
    field: FieldId,
) -> Result<Vec<ShapeCondition>, CallError> {
    let shape = |(k, text): (usize, &Arc<str>)| {
        ShapeCondition::read(text, count).map_err(|why| {
            CallError::new("no-shape", why).found(text.to_string()).in_item(k).in_field(field)
        })
    };
    texts.unwrap_or_default().iter().enumerate().map(shape).collect()
}

/// Refuses a list that has not one item for each of `count` points.
pub(crate) fn one_each<T>(
    what: &str,
    list: Option<&[T]>,
    count: usize,
    field: FieldId,
) -> Result<(), CallError> {
    let Some(actual) = list.map(<[T]>::len).filter(|&actual| actual != count) else {
        return Ok(());
    };
    Err(CallError::new("wrong-count", format!("too many or too few {what}"))
        .expected(format!("{count}, one for each point"))
        .found(actual.to_string())
        .in_field(field))
}

impl<T: Real> Intent<T> {
    /// The faired spline within the tolerances of the points themselves, which it passes through
    /// before it is faired, and what is to be said of it.
    pub fn near(
        &self,
        points: &[Vec3<T>],
        demands: &Demands<T>,
    ) -> Result<(SplineWithKnotDerivatives<T>, FairFigures), FairError> {
        let n = points.len();
        let marks = super::indices(&self.breaks, n)?;
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        crate::error::check_finite(&plain)?;
        let least = if self.closed { 2 * self.degree + 2 } else { self.degree + 2 };
        if n < least {
            return Err(FairError::TooFew { expected: least, actual: n });
        }
        let mut tolerances = match &demands.tolerances {
            Some(all) => all.clone(),
            None => vec![self.tolerance; n],
        };
        for k in super::indices(&demands.fixed, n)? {
            tolerances[k] = T::zero();
        }
        // As far as the extent of the points is no limit.
        let size = plain.iter().map(|p| (*p - plain[0]).norm()).fold(0.0, f64::max);
        for k in super::indices(&demands.release, n)? {
            tolerances[k] += T::from(size);
        }
        let radii: Vec<f64> = tolerances.iter().map(|t| t.re()).collect();
        let mut at = match &demands.at {
            Some(at) => at.clone(),
            None => parameters_across(points, self.spacing, self.closed, (self.motion, &radii))?,
        };
        let laid = |at: &[T]| {
            let real: Vec<f64> = at.iter().map(|t| t.re()).collect();
            InterpolationSpace::new(self.degree, &real, &marks, self.closed)
        };
        let mut data = Data {
            layout: laid(&at)?,
            limit: Limit::new(self.motion, radii)?,
            ends: self.ends,
            points: plain,
        };
        if self.turning && demands.at.is_none() {
            let budget = near_budget(&data.points, self.motion);
            at = curvature_parameters(&data, points, &tolerances, &at, budget)?;
            data.layout = laid(&at)?;
        }
        let (data, shape) = data.shaped(&demands.shape)?;
        let mut options = DataOptions::of(self.measure, self.goal);
        // Exact derivatives need to know which limits are reached; signs are not that exact.
        options.accuracy = if shape.is_empty() { ACCURACY } else { options.accuracy };
        options.shape = shape;
        options.bends = demands.bends;
        if !demands.conditions.is_empty() {
            let space = &data.layout.space;
            let control = data.layout.through(&data.layout.data(&data.points))?;
            for &(t, demand) in &demands.conditions {
                options.conditions.extend(demand.conditions(space, &control, t));
            }
        }
        let (made, fit) = fair_data_with(&data, &options, points, &tolerances, &at)?;
        let (knots, control) = data.layout.space.open_form(&made.knots, &made.points);
        let curve = SplineWithKnotDerivatives::new(self.degree, Some(knots), control, None)
            .map_err(|_| FairError::Singular)?;
        let known = |f: &DataFinding| {
            let at = f.index() + 1;
            self.breaks.contains(&at) || demands.release.contains(&at)
        };
        let findings = data_findings(&data.points, self.closed);
        let findings = findings.iter().filter(|f| !known(f)).count();
        Ok((curve, FairFigures::of_curve(&fit, &data.limit.radii, findings)))
    }
}
