//! Measures of one surface with bounds of their errors, and derivatives with theirs.

use crate::document::Document;
use crate::measures::floating::COARSER;
use moldloft_diag::Diagnostic;
use moldloft_hydro::BodyMeasures;
use moldloft_lang::run::whole::not_finite;
use moldloft_num::{Dual4, Real};
use moldloft_panel::object_measures;
use moldloft_registry::Value;

/// Area and centroid of a surface or of a part of one, with bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMeasures {
    /// Area, and x, y and z of its centroid.
    pub figures: [f64; 4],
    /// Estimates of the errors of these.
    pub bounds: [f64; 4],
    /// Derivatives of each figure with respect to the requested parameters.
    pub derivatives: [Vec<f64>; 4],
    /// Estimates of the errors of the derivatives.
    pub derivative_bounds: [Vec<f64>; 4],
}

fn figures<T: Real>(of: &BodyMeasures<T>) -> [T; 4] {
    let c = of.area_centre;
    [of.area, c.x, c.y, c.z]
}

impl Document {
    /// The measures of an object, with derivatives with respect to the parameters or literals `by`.
    ///
    /// # Errors
    /// If the object is no surface and no part of one, and unknown names.
    pub fn part_measures(
        &mut self,
        name: &str,
        accuracy: f64,
        by: &[String],
    ) -> Result<PartMeasures, Vec<Diagnostic>> {
        self.complete()?;
        let graph = self.graph();
        let value = graph.find(name).and_then(|key| graph.get(key)).and_then(|o| o.value());
        if !matches!(value, Some(Value::Surface(_)))
            && !matches!(value, Some(Value::Body(body)) if body.border.is_some())
        {
            let found = value.map_or("an object without a value", |v| v.class().with_article());
            return Err(vec![
                Diagnostic::error("wrong-class", format!("`{name}` has no measures of a surface"))
                    .expected("a surface, or a part of one")
                    .found(found),
            ]);
        }
        let missing = || vec![not_finite()];
        let fine = object_measures(graph, name, accuracy).ok_or_else(missing)?;
        let rough = object_measures(graph, name, COARSER * accuracy).ok_or_else(missing)?;
        let (values, others) = (figures(&fine), figures(&rough));
        // The centroid moves with the errors of the moments and of the area.
        let reach = fine.area.sqrt();
        let mut bounds: [f64; 4] =
            std::array::from_fn(|k| (values[k] - others[k]).abs() + accuracy * reach);
        bounds[0] = fine.bounds[0];
        let mut found = PartMeasures {
            figures: values,
            bounds,
            derivatives: Default::default(),
            derivative_bounds: Default::default(),
        };
        self.passes(by, |_, evaluation, count| {
            let all = |accuracy: f64| {
                let measures = object_measures::<Dual4>(&evaluation.graph, name, accuracy);
                Ok::<_, Vec<Diagnostic>>(figures(&measures.ok_or_else(missing)?))
            };
            let (fine, rough) = (all(accuracy)?, all(COARSER * accuracy)?);
            for (k, (x, y)) in fine.iter().zip(rough).enumerate() {
                let slopes = &x.eps[..count];
                let error = |(a, b): (&f64, &f64)| (a - b).abs() + accuracy * a.abs();
                found.derivative_bounds[k].extend(slopes.iter().zip(&y.eps).map(error));
                found.derivatives[k].extend(slopes);
            }
            Ok(())
        })?;
        Ok(found)
    }
}
