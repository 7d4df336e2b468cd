//! Spline patches: exact forms, fits within their tolerance, the side they face.

use crate::model;
use moldloft_document::Document;
use moldloft_export::{SplinePatch, spline_patches};
use moldloft_num::Order;
use moldloft_registry::Value;

/// The largest distance of patches of one whole surface from it, on a grid that the fit never saw.
fn distance(model: &Document, patch: &SplinePatch, turned: bool) -> f64 {
    let graph = model.graph();
    let object = graph.find(&patch.name).and_then(|key| graph.get(key)).unwrap();
    let Some(Value::Surface(surface)) = object.value() else { panic!("{} is none", patch.name) };
    let t: Vec<f64> = (0..=40).map(|k| f64::from(k) / 20.0 - 1.0).collect();
    let found = patch.grid(&t, &t);
    let mut most = 0.0_f64;
    for (i, u) in t.iter().enumerate() {
        for (j, v) in t.iter().enumerate() {
            let u = if turned { -u } else { *u };
            let p = surface.jet((u + 1.0) / 2.0, (v + 1.0) / 2.0, Order::Zero).p;
            most = most.max((p - found[i * t.len() + j]).norm());
        }
    }
    most
}

#[test]
fn splines_are_exact_with_the_fewest_points() {
    let text = "
        AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 2); AbsPoint C(2, 0, -1); AbsPoint D(3, 0, 0);
        AbsPoint E(0, 3, 0); AbsPoint F(1, 3, 1); AbsPoint G(2, 3, 2); AbsPoint H(3, 3, 0);
        AbsPoint I(4, 3, 0);
        BCurve low({A, B, C, D}, degree = 3); BCurve high({E, F, G, H, I}, degree = 3);
        RuledSurf sheet(low, high, divisions = {4, 4});
    ";
    let mut model = model(text);
    let patches = spline_patches(&mut model, None, false).unwrap();
    // Cubics of one span and of two: both are cubics of two even spans.
    assert_eq!(patches.len(), 1);
    assert_eq!((patches[0].degree, patches[0].spans), ([3, 1], [2, 1]));
    let off = [true, false].map(|turned| distance(&model, &patches[0], turned));
    assert!(off[0].min(off[1]) < 1e-12, "{off:?}");
    assert!(patches[0].deviation < 1e-12);
    let knots = patches[0].knots(0);
    assert_eq!(knots.as_slice(), [-1.0, -1.0, -1.0, -1.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn others_are_within_the_tolerance() {
    let text = "
        AbsPoint A(1, 0, 0); AbsPoint B(1, 0, 2); AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1);
        Line a(A, B); Line axis(O, Z);
        RevSurf drum(a, axis, a2 = 1.5707963267948966, divisions = {4, 4});
    ";
    let mut model = model(text);
    let mut last = usize::MAX;
    for tolerance in [1e-6, 1e-4, 1e-2] {
        let patches = spline_patches(&mut model, Some(tolerance), false).unwrap();
        let points: usize = patches.iter().map(|p| p.points.len()).sum();
        assert!(patches.iter().all(|p| p.deviation <= tolerance));
        if let [one] = &patches[..] {
            let off = distance(&model, one, true).min(distance(&model, one, false));
            assert!(off <= 1.05 * tolerance, "{off} {tolerance}");
        }
        assert!(points <= last);
        last = points;
    }
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(spline_patches(&mut model, Some(bad), false).is_err());
    }
}

#[test]
fn patches_face_out_of_the_water() {
    let mut model = model(crate::BOX);
    let mesh = model.panelled().unwrap();
    for patch in spline_patches(&mut model, None, true).unwrap() {
        let [a, b, c] =
            [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]].map(|[u, v]| patch.grid(&[u], &[v])[0]);
        let outward = (b - a).cross(c - a);
        // Panels face the water, counter-clockwise seen from it.
        let own = mesh.mesh.patches().iter().find(|p| p.info.name == patch.name).unwrap();
        let [p, q, r, _] =
            mesh.mesh.faces()[own.faces.start].map(|v| mesh.mesh.positions()[v as usize]);
        assert!((q - p).cross(r - p).dot(outward) < 0.0, "{}", patch.name);
    }
    assert_eq!(spline_patches(&mut model, None, false).unwrap().len(), 4);
    let crossing = crate::BOX.replace("AbsPoint G(0, 0, 0)", "AbsPoint G(0, -1, 0)");
    let mut crossing = crate::model(&crossing);
    let error = format!("{:?}", spline_patches(&mut crossing, None, true).unwrap_err());
    assert!(error.contains("must stay on one side"), "{error}");
}
