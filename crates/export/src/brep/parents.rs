//! Sub-surfaces as trimmed faces of the surfaces that they are parts of: their kinks and fits are then the parent's.

use moldloft_num::Order;
use moldloft_panel::{FaceOutline, OutlineCurve};
use moldloft_registry::CurveRef;

/// Maximum excess of a path beyond [0, 1] by rounding.
const BEYOND: f64 = 1e-9;

/// Points of a side by which its direction round the part is found.
const STEPS_OF_A_SIDE: u32 = 32;

/// Puts the outline of a part of a surface on that surface; others stay as they are.
pub fn on_parent(outline: &mut FaceOutline) {
    let Some(part) = outline.surface.part_of.clone() else { return };
    let [sides] = &mut outline.loops[..] else { return };
    if sides.len() != 4 {
        return;
    }
    // A closed band has a seam of its own, which is no edge of the surface.
    let point = |vertices: &[u32]| vertices.iter().all(|v| *v == vertices[0]);
    if !point(&sides[1].vertices) && sides[1].vertices == sides[3].vertices {
        return;
    }
    let inside = |curve: &CurveRef<f64>, t: f64| {
        let within = |x: f64| (-BEYOND..=1.0 + BEYOND).contains(&x);
        curve.on_surface(t, Order::Zero).is_some_and(|[w, ..]| within(w.x) && within(w.y))
    };
    for (side, curve) in sides.iter().zip(&part.sides) {
        let stays = match curve {
            None => point(&side.vertices),
            Some(curve) => side.at.iter().all(|&t| inside(curve, t)),
        };
        if !stays {
            return;
        }
    }
    let mut polygon = Vec::new();
    for (side, curve) in sides.iter_mut().zip(&part.sides) {
        let Some(curve) = curve else { continue };
        let mut own: Vec<[f64; 2]> = (0..=STEPS_OF_A_SIDE)
            .filter_map(|k| {
                curve.on_surface(f64::from(k) / f64::from(STEPS_OF_A_SIDE), Order::Zero)
            })
            .map(|[w, ..]| [w.x, w.y])
            .collect();
        if side.backwards {
            own.reverse();
        }
        polygon.extend(own);
        side.along = OutlineCurve::Snake(curve.clone());
    }
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    let cross = |k: usize| polygon[k][0] * next(k)[1] - polygon[k][1] * next(k)[0];
    if (0..polygon.len()).map(cross).sum::<f64>() < 0.0 {
        // The walk round the part runs clockwise on the surface: the normals are opposite.
        outline.reversed = !outline.reversed;
    }
    outline.surface = part.surface.clone();
}
