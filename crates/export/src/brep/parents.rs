//! Sub-surfaces as trimmed faces of the surfaces that they are parts of: their kinks and fits are then the parent's.

use moldloft_document::Document;
use moldloft_num::Order;
use moldloft_panel::{FaceOutline, OutlineCurve};
use moldloft_registry::{CurveRef, Value};

/// Maximum excess of a path beyond [0, 1] by rounding.
const BEYOND: f64 = 1e-9;

/// Puts the outline of a sub-surface between snakes on its parent; others stay as they are.
pub fn on_parent(document: &Document, outline: &mut FaceOutline) {
    let graph = document.graph();
    let Some(object) = graph.find(&outline.name).and_then(|key| graph.get(key)) else { return };
    if object.row.name != "SubSurf" || outline.loops.len() != 1 || outline.loops[0].len() != 4 {
        return;
    }
    let field = object.row.field("sides");
    let Some(Value::List(sides)) = field.and_then(|f| object.args.get(f)) else { return };
    let resolved = |value: &Value<f64>| match value {
        Value::Object(key) => graph.get(*key).and_then(|o| o.value()).cloned(),
        other => Some(other.clone()),
    };
    let Some(sides) = sides.iter().map(resolved).collect::<Option<Vec<_>>>() else { return };
    let places: &[usize] = match sides.len() {
        2 => &[0, 2],
        3 => &[0, 1, 2],
        4 => &[0, 1, 2, 3],
        _ => return,
    };
    let mut curves: [Option<CurveRef<f64>>; 4] = [None, None, None, None];
    for (side, &k) in sides.iter().zip(places) {
        if let Value::Curve(curve) = side {
            curves[k] = Some(curve.clone());
        }
    }
    let Some(parent) = curves.iter().flatten().find_map(|c| c.surface.clone()) else { return };
    // Every side with a length has to be a snake whose path stays on the parent.
    for (side, curve) in outline.loops[0].iter().zip(&curves) {
        let point = side.vertices.iter().all(|v| *v == side.vertices[0]);
        match curve {
            None if point => {}
            None => return,
            Some(curve) => {
                let inside = |t: &f64| match curve.on_surface(*t, Order::Zero) {
                    Some([w, ..]) => {
                        let within = |x: f64| (-BEYOND..=1.0 + BEYOND).contains(&x);
                        within(w.x) && within(w.y)
                    }
                    None => false,
                };
                if !side.at.iter().all(inside) {
                    return;
                }
            }
        }
    }
    let mut polygon = Vec::new();
    for (side, curve) in outline.loops[0].iter_mut().zip(curves) {
        let Some(curve) = curve else { continue };
        let mut own: Vec<[f64; 2]> = (0..=32)
            .filter_map(|k| curve.on_surface(f64::from(k) / 32.0, Order::Zero))
            .map(|[w, ..]| [w.x, w.y])
            .collect();
        if side.backwards {
            own.reverse();
        }
        polygon.extend(own);
        side.along = OutlineCurve::Snake(curve);
    }
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    let cross = |k: usize| polygon[k][0] * next(k)[1] - polygon[k][1] * next(k)[0];
    if (0..polygon.len()).map(cross).sum::<f64>() < 0.0 {
        // The walk round the sub-surface runs clockwise on the parent: the normals are opposite.
        outline.reversed = !outline.reversed;
    }
    outline.surface = *parent;
}
