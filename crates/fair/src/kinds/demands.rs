//! Conditions on a curve near its points, besides the tolerance.

use super::Intent;
use super::figures::FairFigures;
use crate::EndContinuity;
use crate::{
    CurveRequest, DataFinding, Demand, FairError, PointSpacing, ShapeCondition, data_findings,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{CallError, FieldId};
use moldloft_spline::SplineWithKnotDerivatives;
use std::sync::Arc;

pub(crate) struct Demands<T> {
    pub shape: Vec<ShapeCondition>,
    /// Conditions with their parameters in [0, 1].
    pub conditions: Vec<(f64, Demand<T>)>,
    pub tolerances: Option<Vec<T>>,
    /// Points, from 1.
    pub fixed: Vec<usize>,
    pub release: Vec<usize>,
    pub bends: bool,
    /// Parameters of the points.
    pub at: Option<Vec<T>>,
}

/// Parses the shape conditions of `count` points.
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

/// Refuses a list whose length is not `count`.
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
    /// The faired spline within individual tolerances, and its figures.
    pub fn near(
        &self,
        points: &[Vec3<T>],
        demands: Demands<T>,
        spacing: PointSpacing,
    ) -> Result<(SplineWithKnotDerivatives<T>, FairFigures), FairError> {
        let n = points.len();
        let request = CurveRequest {
            tolerances: demands.tolerances.unwrap_or_else(|| vec![self.tolerance; n]),
            fixed: super::indices(&demands.fixed, n)?,
            release: super::indices(&demands.release, n)?,
            breaks: super::indices(&self.breaks, n)?,
            degree: self.degree,
            closed: self.closed,
            measure: self.measure,
            goal: self.goal,
            spacing,
            at: demands.at,
            ends: self.ends.map(|e| e.unwrap_or(EndContinuity::Free)),
            motion: self.motion,
            shape: demands.shape,
            conditions: demands.conditions,
            bends: demands.bends,
            accuracy: None,
            draft: false,
        };
        let made = request.curve(points)?;
        let curve = made.curve().ok_or(FairError::Singular)?;
        let (breaks, released) = (&request.breaks, &request.release);
        let known = |f: &DataFinding| breaks.contains(&f.index()) || released.contains(&f.index());
        let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
        let findings = data_findings(&plain, self.closed);
        let findings = findings.iter().filter(|f| !known(f)).count();
        Ok((curve, FairFigures::of_curve(&made.fit, &made.data.limit.radii, findings)))
    }
}
