//! Blends: contact and orientation on the rails, the checks, degrees, the chapter's examples.

use crate::common::{axis, cube, facets, sound, v};
use moldloft_field::{
    CIRCULAR, FieldError, Primitive, Set, check_rail, check_rails, fillet, liming, liming_on_rail,
    round, setback_rail, transition, zhang,
};
use moldloft_num::{Box3, Vec3};
use std::f64::consts::PI;

fn pipe(direction: Vec3, r: f64) -> Primitive {
    Primitive::cylinder(axis(Vec3::zero(), direction), r).unwrap()
}

/// Points where both are zero, by Newton from a spread of starts.
fn on_both(f: &Primitive, g: &Primitive) -> Vec<Vec3> {
    let mut found = Vec::new();
    for k in 1..200 {
        let part = |a: f64| 6.0 * (f64::from(k) * a).fract() - 3.0;
        let mut p = v(part(0.819_172_513), part(0.671_043_607), part(0.549_700_478));
        for _ in 0..1500 {
            for h in [f, g] {
                let j = h.gradient(p);
                p -= j.slope * (j.value / j.slope.norm_sq().max(1e-9));
            }
        }
        if f.value(p).abs() < 1e-13 && g.value(p).abs() < 1e-13 && p.norm() < 4.0 {
            found.push(p);
        }
    }
    assert!(found.len() > 20, "only {} points of the rail", found.len());
    found
}

#[test]
fn limings_blend_touches_where_the_rail_meets_the_bodies() {
    let (l1, l2) = (pipe(v(1.0, 0.0, 0.0), 1.0), pipe(v(0.0, 0.0, 1.0), 0.6));
    let rail = pipe(v(0.0, 0.0, 1.0), 0.9);
    let q = liming_on_rail([&l1, &l2], &rail, 0.6, 1).unwrap();
    assert_eq!(q.degree(), 4);
    for p in on_both(&l1, &rail) {
        let (g, b) = (q.gradient(p), l1.gradient(p));
        assert!(g.value.abs() < 1e-12);
        // lambda L2 times the gradient of L1.
        let expected = b.slope * (0.6 * l2.value(p));
        assert!(l2.value(p) > 0.0 && g.slope.distance(expected) < 1e-6);
    }
    let general = liming([&l1, &l2], [&rail, &rail], 0.6).unwrap();
    let p = v(0.3, 0.4, 0.5);
    assert!((general.value(p) - q.value(p)).abs() < 1e-15);
}

#[test]
fn limings_quadric_passes_through_four_intersections_of_planes() {
    let [x, y, _] = Primitive::<f64>::axes();
    let (l1, l2, l3, l4) = (&x - 1.0, &y - 1.0, &x + &y * 0.5 - 0.25, &y - &x * 0.3 + 0.4);
    for k in 1..10 {
        let q = liming([&l1, &l2], [&l3, &l4], f64::from(k) / 10.0).unwrap();
        assert_eq!(q.degree(), 2);
        for p in [v(1.0, -1.5, 0.0), v(1.0, -0.1, 2.0), v(-0.25, 1.0, 0.0), v(14.0 / 3.0, 1.0, 5.0)]
        {
            assert!(q.value(p).abs() < 1e-12, "{p:?}: {}", q.value(p));
        }
    }
}

#[test]
fn zhangs_transition_touches_with_the_right_side_out() {
    // The bottle neck of the chapter.
    let l1 = pipe(v(1.0, 0.0, 0.0), 1.0);
    let l2 = Primitive::cylinder(axis(v(0.0, 0.0, 0.2), v(1.0, 1.0, 0.0)), 0.5).unwrap();
    let l3 = Primitive::plane(v(1.0, 0.3, -0.2), v(-1.0, 0.0, 0.0)).unwrap();
    let l4 = Primitive::plane(v(-1.0, -1.0, 0.25), v(1.0, 1.0, 0.2)).unwrap();
    let c = zhang([&l1, &l2], [&l3, &l4], 0.4, 1).unwrap();
    assert_eq!(c.degree(), 4);
    for (body, rail, weight, other) in [(&l1, &l3, 0.6, &l4), (&l2, &l4, 0.4, &l3)] {
        for p in on_both(body, rail) {
            let g = c.gradient(p);
            let expected = body.gradient(p).slope * (weight * other.value(p).powi(2));
            assert!(
                g.value.abs() < 1e-11
                    && g.slope.distance(expected) < 1e-5 * (1.0 + expected.norm())
            );
        }
    }
    let over = Box3 { low: v(-2.5, -1.5, -1.5), high: v(2.2, 2.2, 1.5) };
    check_rails([&l1, &l2], [&l3, &l4], &over).unwrap();
    let duct = transition([&l1, &l2], [&l3, &l4], 0.4, 1).unwrap();
    let f = facets(&duct.set, &over, 5);
    let report = sound(&f);
    assert_eq!((report.components, report.euler), (1, 2));
    // Rails that meet inside the box.
    let across = Primitive::plane(v(0.0, 1.0, 0.0), Vec3::zero()).unwrap();
    let met = check_rails([&l1, &l2], [&l3, &across], &over);
    let Err(FieldError::RailsMeet { place }) = met else { panic!("{met:?}") };
    assert!(l3.value(place.centre()).abs() < 0.05 && place.centre().y.abs() < 0.05);
}

#[test]
fn checks_prove_rails_and_say_where_they_fail() {
    let (l1, l2) = (pipe(v(1.0, 0.0, 0.0), 1.0), pipe(v(0.0, 0.0, 1.0), 0.6));
    let over = cube(2.0);
    check_rail([&l1, &l2], &pipe(v(0.0, 0.0, 1.0), 0.9), &over).unwrap();
    // Inside the second body the blend would be inside out on the first.
    let inside = check_rail([&l1, &l2], &pipe(v(0.0, 0.0, 1.0), 0.4), &over);
    let Err(FieldError::RailInside { body: 2, place }) = inside else { panic!("{inside:?}") };
    assert!(l2.value(place.centre()) < 0.05 && l1.value(place.centre()).abs() < 0.1);
    // A cone has no normal at its apex.
    let cone = Primitive::cone(axis(Vec3::zero(), v(0.0, 0.0, 1.0)), 1.0).unwrap();
    let plane = Primitive::plane(v(0.3, 0.0, 1.0), Vec3::zero()).unwrap();
    let far = Primitive::plane(v(1.0, 0.0, 0.0), v(-5.0, 0.0, 0.0)).unwrap();
    let singular = check_rail([&cone, &far], &plane, &cube(1.0));
    assert!(matches!(singular, Err(FieldError::RailSingular { body: 1, .. })), "{singular:?}");
}

#[test]
fn fillets_and_rounds_are_arcs_between_perpendicular_planes() {
    let [_, y, z] = Primitive::<f64>::axes();
    let over = Box3 { low: v(0.0, -1.0, -1.0), high: v(1.0, 1.5, 1.5) };
    // Three quarters of the box less a square and plus the corner of the arc of radius 0.8.
    let corner = 0.64 * (1.0 - PI / 4.0);
    for (set, exact) in [
        (fillet([&y, &z], [0.8, 0.8], CIRCULAR).unwrap().set, 6.25 - 2.25 + corner),
        (round([&(-&y), &(-&z)], [0.8, 0.8], CIRCULAR).unwrap().set, 2.25 - corner),
    ] {
        let f = facets(&set, &over, 6);
        sound(&f);
        let volume = f.moments().volume();
        assert!((volume - exact).abs() < 1e-4, "{volume} {exact}");
    }
}

#[test]
fn setbacks_are_kept_between_curved_bodies() {
    // True distances: contact at the given distance from the other body.
    let run = Primitive::cylinder_distance(axis(Vec3::zero(), v(1.0, 0.0, 0.0)), 1.0).unwrap();
    let branch = Primitive::cylinder_distance(axis(Vec3::zero(), v(0.0, 0.0, 1.0)), 0.6).unwrap();
    let rail = setback_rail([&run, &branch], [0.3, 0.2]).unwrap();
    for p in on_both(&run, &rail) {
        assert!((branch.value(p) - 0.2).abs() < 1e-12);
    }
    for p in on_both(&branch, &rail) {
        assert!((run.value(p) - 0.3).abs() < 1e-12);
    }
    let over = Box3 { low: v(-2.0, -1.5, 0.0), high: v(2.0, 1.5, 2.5) };
    check_rail([&run, &branch], &rail, &over).unwrap();
    let joint = fillet([&run, &branch], [0.3, 0.2], 0.5).unwrap();
    let f = facets(&joint.set, &over, 6);
    assert_eq!(sound(&f).euler, 2);
    // It adds material to the union, and is on the solid side of the rail.
    let plain = facets(&(Set::new(&run) | Set::new(&branch)), &over, 6);
    assert!(f.moments().volume() > plain.moments().volume() + 0.01);
}

#[test]
fn higher_contact_and_blends_on_blends() {
    let (l1, l2) = (pipe(v(1.0, 0.0, 0.0), 1.0), pipe(v(0.0, 0.0, 1.0), 0.6));
    let rail = pipe(v(0.0, 0.0, 1.0), 0.9);
    // With contact G^n, Q / (lambda L2) - L1 vanishes with L3^(n + 1): halving the distance from the
    // rail divides it by 2^(n + 1).
    for n in 1..4 {
        let q = liming_on_rail([&l1, &l2], &rail, 0.6, n).unwrap();
        let gap = |d: f64| {
            let x = 0.9 + d;
            let p = v(x, 0.0, 1.0);
            (q.value(p) / (0.6 * l2.value(p)) - l1.value(p)).abs()
        };
        let rate = (gap(0.002) / gap(0.001)).log2();
        assert!((rate - f64::from(n + 1)).abs() < 0.02, "{n}: {rate}");
    }
    let q = liming_on_rail([&l1, &l2], &rail, 0.6, 1).unwrap();
    let third = pipe(v(0.0, 1.0, 0.0), 0.3);
    let twice = liming_on_rail([&q, &third], &pipe(v(0.0, 1.0, 0.0), 0.5), 0.5, 1).unwrap();
    assert_eq!(twice.degree(), 6);
    assert_eq!(liming_on_rail([&twice, &q], &third, 0.5, 1).unwrap().degree(), 10);
}

#[test]
fn bad_blends_are_refused() {
    let [x, y, z] = Primitive::<f64>::axes();
    for bad in [0.0, 1.0, -0.5, f64::NAN] {
        let refused = |e: FieldError| assert!(matches!(e, FieldError::Lambda { .. }), "{e:?}");
        refused(liming([&x, &y], [&z, &z], bad).unwrap_err());
        refused(zhang([&x, &y], [&z, &z], bad, 1).unwrap_err());
        refused(fillet([&x, &y], [1.0, 1.0], bad).unwrap_err());
    }
    assert!(matches!(fillet([&x, &y], [1.0, 0.0], 0.5), Err(FieldError::NotPositive { .. })));
    assert!(matches!(zhang([&x, &y], [&z, &z], 0.5, 0), Err(FieldError::Exponent { .. })));
    let flat = Box3 { low: Vec3::zero(), high: Vec3::zero() };
    assert!(matches!(check_rail([&x, &y], &z, &flat), Err(FieldError::EmptyBox { .. })));
}
