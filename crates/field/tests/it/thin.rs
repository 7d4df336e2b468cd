//! Boxes that are thinner than their cells: sheets, wires and points are complete, bodies are
//! refused.

use crate::common::{at_depth, v};
use moldloft_field::{
    FacetOptions, FieldError, IntegralOptions, Primitive, Resolution, Set, facet, facet_mixed, mass,
};
use moldloft_num::Box3;

fn thin() -> Box3 {
    Box3 { low: v(-5.0, -4.0, -0.02), high: v(5.0, 4.0, 0.03) }
}

#[test]
fn a_wire_along_a_thin_box_is_one_polyline() {
    let (from, to) = (v(-4.2, -3.0, 0.005), v(4.1, 3.3, 0.011));
    let m = facet_mixed(&Set::segment(from, to).unwrap(), &thin(), &at_depth(5)).unwrap();
    assert_eq!(m.wires.len(), 1);
    assert!((m.wires[0].length() - from.distance(to)).abs() < 1e-9);
    let away = |p: &moldloft_num::Vec3| {
        let d = (to - from) / from.distance(to);
        (*p - from).cross(d).norm()
    };
    assert!(m.wires[0].points.iter().all(|p| away(p) < 1e-10));
}

#[test]
fn a_sheet_along_a_thin_box_has_its_area() {
    // z = 0.01 sin x keeps within the box: 8 times the length of the curve.
    let [x, _, z] = Primitive::axes();
    let sheet = Set::new(&(z - x.sin() * 0.01).abs());
    let m = facet_mixed(&sheet, &thin(), &at_depth(5)).unwrap();
    let area: f64 = m.sheets.iter().map(|s| moldloft_mesh::measure(&s.mesh).area).sum();
    let length = |t: f64| (1.0 + (0.01 * t.cos()).powi(2)).sqrt();
    let exact = 8.0 * moldloft_num::integrate(-5.0, 5.0, 1e-12, length);
    assert!((area - exact).abs() < 1e-5 * exact, "{area} {exact}");
    assert_eq!(m.sheets[0].mesh.report().open_loops.len(), 1);
}

#[test]
fn what_the_box_cuts_is_refused_or_finer() {
    // The ball is cut by both faces of the box, and so is the wave.
    let [x, _, z] = Primitive::axes();
    let wave = Set::new(&(z - x.sin() * 0.5).abs());
    let ball = Set::new(&Primitive::sphere(v(0.1, 0.2, 0.0), 2.0).unwrap());
    let refused = |e: FieldError| match e {
        FieldError::ThinBox { axis: 2, depth, .. } => assert_eq!(depth, 8),
        other => panic!("{other}"),
    };
    refused(facet_mixed(&wave, &thin(), &at_depth(5)).unwrap_err());
    refused(facet(&ball, &thin(), &at_depth(7)).unwrap_err());
    let level = FacetOptions::new(Resolution::Level(6));
    for options in [at_depth(8), level.clone()] {
        let f = facet(&ball, &thin(), &options).unwrap();
        crate::common::sound(&f);
        // Within the slab: pi times the integral of 4 - z^2.
        let cubes = (0.03f64.powi(3) + 0.02f64.powi(3)) / 3.0;
        let exact = std::f64::consts::PI * (4.0 * 0.05 - cubes);
        let found = f.moments().volume();
        assert!((found - exact).abs() < 1e-6 * exact, "{found} {exact}");
    }
    let strips = facet_mixed(&wave, &thin(), &level).unwrap();
    assert_eq!(strips.sheets[0].mesh.report().open_loops.len(), 3);
    let found = mass(&ball, &thin(), &IntegralOptions::to_depth(5)).unwrap();
    assert!((found.best.volume() - 0.6283).abs() < 1e-4);
    // An accuracy finds its own cells.
    let fine = facet(&ball, &thin(), &FacetOptions::new(Resolution::Accuracy(1e-3))).unwrap();
    crate::common::sound(&fine);
}
