//! Sheets, wires and points: right dimension, right boundary, right area or length.

use crate::common::{at_depth, axis, cube, v};
use moldloft_field::{Mixed, Primitive, Set, around, facet_mixed};
use moldloft_mesh::measure;
use moldloft_num::{Vec3, integrate};
use std::f64::consts::PI;

fn mixed(set: &Set) -> Mixed {
    facet_mixed(set, &cube(2.0), &at_depth(7)).unwrap()
}

fn area(m: &Mixed) -> f64 {
    m.sheets.iter().map(|s| measure(&s.mesh).area).sum()
}

fn ball() -> Primitive {
    Primitive::sphere(v(0.02, 0.01, 0.03), 1.0).unwrap()
}

fn wave() -> Primitive {
    let [x, _, z] = Primitive::axes();
    z + (x * 3.0).sin() * 0.3
}

fn close(found: f64, exact: f64) {
    assert!((found - exact).abs() < 1e-3 * exact, "{found} {exact}");
}

#[test]
fn a_sphere_without_inside() {
    let m = mixed(&Set::new(&ball().abs()).named("skin"));
    assert!(m.solid.mesh.faces().is_empty() && m.wires.is_empty() && m.points.is_empty());
    close(area(&m), 4.0 * PI);
    let report = m.sheets[0].mesh.report();
    assert!(report.closed && report.manifold && report.oriented && report.outward == Some(true));
    assert_eq!(m.sheets[0].mesh.patches()[0].info.name, "skin");
}

#[test]
fn a_wavy_sheet_with_and_without_the_sphere() {
    let exact =
        4.0 * integrate(-2.0, 2.0, 1e-9, |x: f64| (1.0 + (0.9 * (3.0 * x).cos()).powi(2)).sqrt());
    let m = mixed(&Set::new(&wave().abs()));
    close(area(&m), exact);
    let report = m.sheets[0].mesh.report();
    assert!(report.manifold && report.oriented && report.euler == 1);
    assert_eq!(report.open_loops.len(), 1);
    // With a solid sphere: the sheet continues outside only, and the sphere is solid.
    let (sheet, solid) = (Set::new(&wave().abs()), Set::new(&ball()));
    let both = mixed(&(&sheet | &solid));
    assert!(both.solid.mesh.report().closed);
    let inside = mixed(&(&sheet & &solid));
    assert!(inside.solid.mesh.faces().is_empty());
    close(area(&both) + area(&inside), exact);
    let report = both.sheets[0].mesh.report();
    assert_eq!((report.open_loops.len(), report.euler), (2, 0));
    let without = mixed(&(&sheet - &solid));
    assert!(without.solid.mesh.faces().is_empty());
    assert!((area(&without) - area(&both)).abs() < 1e-12);
}

#[test]
fn two_sheet_cylinders_and_their_wires() {
    let pipe = |d: Vec3, r: f64| Primitive::cylinder(axis(v(0.02, 0.01, 0.03), d), r).unwrap();
    let (a, b) = (pipe(v(1.0, 0.0, 0.0), 1.0), pipe(v(0.0, 1.0, 0.0), 0.8));
    let wires = mixed(&(Set::new(&a.abs()) & Set::new(&b.abs())));
    assert!(wires.sheets.is_empty() && wires.solid.mesh.faces().is_empty());
    assert!(wires.wires.len() == 2 && wires.wires.iter().all(|w| w.closed && w.leaves == [0, 1]));
    // x = 0.8 cos t, z = 0.8 sin t, y = sqrt(1 - z^2).
    let speed = |t: f64| {
        let (x, z) = (0.8 * t.cos(), 0.8 * t.sin());
        (0.64 + (z * x).powi(2) / (1.0 - z * z)).sqrt()
    };
    let ring = integrate(0.0, 2.0 * PI, 1e-9, speed);
    let length = |m: &Mixed| m.wires.iter().map(|w| w.length()).sum::<f64>();
    close(length(&wires), 2.0 * ring);
    for p in wires.wires.iter().flat_map(|w| &w.points) {
        assert!(a.value(*p).abs() < 1e-11 && b.value(*p).abs() < 1e-11);
    }
    // Equal radii: two ellipses with half axes 1 and sqrt 2, which cross where the cylinders touch.
    // There they are lost for about a cell.
    let c = pipe(v(0.0, 1.0, 0.0), 1.0);
    let crossed = mixed(&(Set::new(&a.abs()) & Set::new(&c.abs())));
    let ellipse =
        integrate(0.0, 2.0 * PI, 1e-9, |t: f64| (2.0 * t.sin().powi(2) + t.cos().powi(2)).sqrt());
    assert!((length(&crossed) - 2.0 * ellipse).abs() < 5e-3 * ellipse * 2.0);
    // Beside a solid the wires stop at it.
    let plane = Set::new(&Primitive::plane(v(0.3, 0.2, 1.0), v(0.02, 0.01, 0.03)).unwrap());
    let cut = mixed(&((Set::new(&a.abs()) & Set::new(&b.abs())) | plane));
    assert!(cut.solid.mesh.report().closed && cut.wires.iter().all(|w| !w.closed));
    // The plane passes through the centre of symmetry.
    close(length(&cut), ring);
}

#[test]
fn two_spheres_meet_in_a_circle_and_three_sheets_in_points() {
    let other = Primitive::sphere(v(0.92, 0.01, 0.03), 1.0).unwrap();
    let (a, b) = (Set::new(&ball().abs()), Set::new(&other.abs()));
    let m = mixed(&(&a & &b));
    assert_eq!(m.wires.len(), 1);
    assert!(m.wires[0].closed);
    close(m.wires[0].length(), 2.0 * PI * (1.0f64 - 0.45 * 0.45).sqrt());
    let plane = Primitive::plane(v(0.1, 1.0, 0.2), v(0.0, 0.1, 0.0)).unwrap();
    let m = mixed(&(&(&a & &b) & &Set::new(&plane.abs())));
    assert!(m.wires.is_empty() && m.sheets.is_empty());
    assert_eq!(m.points.len(), 2);
    for moldloft_field::TriplePoint { point: p, leaves, .. } in &m.points {
        assert_eq!(*leaves, [0, 1, 2]);
        for f in [&ball(), &other, &plane] {
            assert!(f.value(*p).abs() < 1e-11);
        }
    }
    // Sheets in a union stay sheets, and meet in no wire.
    let m = mixed(&(&a | &b));
    assert!(m.sheets.len() == 2 && m.wires.is_empty());
    close(area(&m), 8.0 * PI);
}

#[test]
fn wires_and_points_beside_a_solid() {
    let (from, to) = (v(-1.7, 0.1, 0.2), v(1.8, -0.2, 0.3));
    let wire = Set::segment(from, to).unwrap();
    let alone = mixed(&wire);
    assert!(alone.solid.mesh.faces().is_empty() && alone.sheets.is_empty());
    assert!(alone.points.is_empty() && alone.wires.len() == 1 && !alone.wires[0].closed);
    let ends = [alone.wires[0].points[0], *alone.wires[0].points.last().unwrap()];
    assert!((alone.wires[0].length() - from.distance(to)).abs() < 1e-9, "{ends:?}");
    // Through a ball: two pieces that end on it.
    let both = mixed(&(&wire | &Set::new(&ball())));
    assert!(both.solid.mesh.report().closed && both.sheets.is_empty() && both.wires.len() == 2);
    let d = (to - from) / from.distance(to);
    let centre = v(0.02, 0.01, 0.03) - from;
    let half = (1.0 - (centre.norm_sq() - centre.dot(d).powi(2))).sqrt();
    let length = |m: &Mixed| m.wires.iter().map(|w| w.length()).sum::<f64>();
    assert!((length(&both) - (from.distance(to) - 2.0 * half)).abs() < 1e-9);
    let ended = |w: &moldloft_field::FacetWire| {
        [w.points[0], w.points[w.points.len() - 1]].iter().any(|p| ball().value(*p).abs() < 1e-9)
    };
    assert!(both.wires.iter().all(ended));
    // The part inside, and the part outside.
    let (inside, outside) =
        (mixed(&(&wire & &Set::new(&ball()))), mixed(&(&wire - &Set::new(&ball()))));
    assert!((length(&inside) - 2.0 * half).abs() < 1e-9);
    assert!((length(&outside) - length(&both)).abs() < 1e-9);
    let at = v(0.3, 1.5, -0.4);
    let dots = mixed(&(&Set::point(at).unwrap() | &Set::new(&ball())));
    assert!(dots.points.len() == 1 && dots.points[0].point.distance(at) < 1e-12);
    assert!(dots.wires.is_empty() && dots.sheets.is_empty());
    // A point in the solid is of it.
    let inner = mixed(&(&Set::point(v(0.3, 0.2, 0.1)).unwrap() | &Set::new(&ball())));
    assert!(inner.points.is_empty());
    assert!(Set::segment(at, at).is_err());
}

/// The box around a wire is as thick as the cells that it passes through.
#[test]
fn wires_in_boxes_of_their_own() {
    for to in [v(3.0, 4.0, 0.0), v(0.0, 0.0, 7.0), v(-1.0, 2.0, 5.0)] {
        let wire = Set::segment(Vec3::zero(), to).unwrap();
        let over = around(&wire).unwrap().unwrap();
        for depth in 4..7 {
            let m = facet_mixed(&wire, &over, &at_depth(depth)).unwrap();
            assert_eq!(m.wires.len(), 1, "{to:?} at depth {depth}");
            assert!(
                (m.wires[0].length() - to.norm()).abs() < 1e-9,
                "{to:?} {depth} {over:?} {:?}",
                m.wires[0].points
            );
            let off = |p: &Vec3| (p.cross(to)).norm() / to.norm();
            assert!(m.wires[0].points.iter().all(|p| off(p) < 1e-12));
        }
    }
}

#[test]
fn thin_solids_have_the_area_of_their_faces() {
    let m = mixed(&Set::thin_cuboid(v(-1.0, -0.7, -0.5), v(0.9, 0.8, 0.6)).unwrap());
    assert!(m.solid.mesh.faces().is_empty() && m.sheets.len() == 6);
    close(area(&m), 2.0 * (1.9 * 1.5 + 1.5 * 1.1 + 1.9 * 1.1));
}

/// A face between two parts, or inside one, is no boundary.
#[test]
fn the_boundary_of_a_union_has_no_inner_sheets() {
    let block = |low: [f64; 3], high: [f64; 3]| Set::cuboid(low.into(), high.into()).unwrap();
    let left = block([-1.0, -0.5, -0.5], [0.0, 0.5, 0.5]);
    let beside = left.clone() | block([0.0, -0.5, -0.5], [1.0, 0.5, 0.5]);
    let within = left.clone() | block([-0.3, -0.5, -0.5], [1.0, 0.5, 0.5]);
    for set in [beside, within] {
        close(area(&mixed(&set.skin())), 10.0);
    }
    let hollow = left - block([-0.7, -0.2, -0.2], [-0.3, 0.2, 0.2]);
    close(area(&mixed(&hollow.skin())), 6.0 + 6.0 * 0.16);
}
