//! Shown curves of models that show no surface.

use super::faces::not_fitted;
use crate::ExportFailure;
use moldloft_brep::{Brep, Part, Wire};
use moldloft_document::Document;
use moldloft_picture::PALETTE;
use moldloft_registry::Value;
use moldloft_spline::nurbs::{FitOptions, of_curve};

/// Adds the shown curves as a part, when there are no faces.
pub fn add(brep: &mut Brep, document: &Document, accuracy: f64) -> Result<(), ExportFailure> {
    if !brep.faces.is_empty() {
        return Ok(());
    }
    let mut part = Part { name: "curves".into(), ..Part::default() };
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        let Some(Value::Curve(curve)) = object.value() else { continue };
        let made = of_curve(&**curve, &FitOptions::within(accuracy))
            .map_err(|e| not_fitted(&object.name, &e, accuracy))?;
        brep.gap = brep.gap.max(made.error);
        part.wires.push(Wire {
            name: object.name.to_string(),
            colour: Some(PALETTE[(object.head.colour & 15) as usize]),
            layers: Vec::new(),
            curve: made,
        });
    }
    if !part.wires.is_empty() {
        brep.parts.push(part);
    }
    Ok(())
}
