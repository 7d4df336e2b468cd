//! Nearest points and plane sections.

use crate::common::{axis, cube, facets, t_piece, v};
use moldloft_field::{FieldError, Primitive, Set, nearest};
use moldloft_num::{Plane, Vec3};
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

#[test]
fn nearest_points_are_feet_edges_and_corners() {
    let block = Set::cuboid(v(-1.0, -0.7, -0.5), v(0.9, 0.8, 0.6)).unwrap();
    let found = |p: Vec3| nearest(&block, p, &cube(2.0), 1e-7).unwrap().unwrap();
    for (p, foot) in [
        (v(1.5, 0.1, 0.2), v(0.9, 0.1, 0.2)),
        (v(1.5, 1.5, 0.2), v(0.9, 0.8, 0.2)),
        (v(1.5, 1.5, 1.9), v(0.9, 0.8, 0.6)),
        (v(0.3, 0.1, 0.4), v(0.3, 0.1, 0.6)),
    ] {
        let n = found(p);
        assert!((n.distance - p.distance(foot)).abs() <= 1e-7, "{p:?}: {n:?}");
        assert!(n.at_least <= n.distance && n.distance - n.at_least <= 1.01e-7);
        assert!(n.point.distance(foot) < 1e-3, "{p:?}: {n:?}");
    }
}

#[test]
fn nearest_points_of_curved_surfaces() {
    let a = axis(v(0.1, 0.0, 0.2), v(0.3, 0.2, 1.0));
    let torus = Set::new(&Primitive::torus(a, 1.0, 0.3).unwrap());
    for p in [v(1.4, 0.3, 0.9), v(-0.3, 0.8, -0.4), v(0.9, 0.9, 0.1)] {
        let n = nearest(&torus, p, &cube(2.0), 1e-6).unwrap().unwrap();
        let d = p - a.point;
        let h = d.dot(a.direction);
        let r = (d - a.direction * h).norm();
        let exact = ((r - 1.0).hypot(h) - 0.3).abs();
        assert!((n.distance - exact).abs() < 1e-6, "{p:?}: {n:?} {exact}");
    }
    let none = nearest(&Set::everything(), Vec3::zero(), &cube(1.0), 1e-3).unwrap();
    assert!(none.is_none());
    let ball = Set::new(&Primitive::sphere(Vec3::<f64>::zero(), 1.0).unwrap());
    let centre = nearest(&ball, Vec3::zero(), &cube(2.0), 1e-12).unwrap().unwrap();
    assert!((centre.distance - 1.0).abs() < 1e-12 && centre.at_least > 1.0 - 1e-12, "{centre:?}");
}

/// The foot of a point many radii away is found, and the bound holds.
#[test]
fn far_points_find_their_feet_on_small_bodies() {
    let mut random = Random::new(3);
    for _ in 0..rounds(20, 3000) {
        let [c, p, d] = [3.0, 12.0, 1.0]
            .map(|size| Vec3::from([0; 3].map(|_| random.between(-0.5 * size, 0.5 * size))));
        let (r, minor) = (random.between(0.1, 0.6), random.between(0.02, 0.09));
        let line = axis(c, d.normalized().unwrap());
        let along = (p - c).dot(line.direction);
        let aside = (p - c - line.direction * along).norm();
        let ball = Primitive::sphere(c, r).unwrap();
        let ring = Primitive::torus(line, r, minor).unwrap();
        let caps = [-0.5, 0.5].map(|h| {
            let n = line.direction * f64::signum(h);
            Set::new(&Primitive::plane(n, c + line.direction * h).unwrap())
        });
        let [low, high] = caps;
        let pole = Set::new(&Primitive::cylinder(line, r).unwrap()) & low & high;
        let beyond = along.abs() - 0.5;
        let from_pole = match (beyond > 0.0, aside > r) {
            (true, true) => beyond.hypot(aside - r),
            (true, false) => beyond,
            (false, true) => aside - r,
            (false, false) => (-beyond).min(r - aside),
        };
        for (set, exact) in [
            (Set::new(&ball), (p.distance(c) - r).abs()),
            (Set::new(&ring), ((aside - r).hypot(along) - minor).abs()),
            (pole, from_pole),
        ] {
            let n = nearest(&set, p, &cube(7.0), 1e-6).unwrap().unwrap();
            assert!((n.distance - exact).abs() < 1e-6, "{c:?} {r} {p:?}: {n:?} {exact}");
            assert!(n.at_least <= exact + 1e-12, "{n:?} {exact}");
        }
    }
}

#[test]
fn sections_are_closed_contours_on_the_surface() {
    let f = facets(&t_piece(), &cube(4.0), 6);
    let length = |points: &[Vec3]| -> f64 {
        (0..points.len()).map(|k| points[k].distance(points[(k + 1) % points.len()])).sum()
    };
    // Across the run: a unit circle.
    let across = f.section(&Plane { point: v(-3.0, 0.0, 0.0), normal: v(1.0, 0.0, 0.0) }).unwrap();
    assert!(across.len() == 1 && across[0].closed);
    assert!((length(&across[0].points) - 2.0 * PI).abs() < 8e-3);
    for p in &across[0].points {
        assert!((p.y.hypot(p.z) - 1.0).abs() < 1e-12 && (p.x + 3.0).abs() < 1e-12);
    }
    // Across the branch beyond the fillet: a circle of radius 0.6.
    let s = v(1.0, 0.0, 1.0) / 2f64.sqrt();
    let branch = f.section(&Plane { point: s * 3.8, normal: s }).unwrap();
    assert!(branch.len() == 1 && branch[0].closed);
    assert!((length(&branch[0].points) - 1.2 * PI).abs() < 8e-3);
    // Along both axes: one contour.
    let along = f.section(&Plane { point: Vec3::zero(), normal: v(0.0, 1.0, 0.0) }).unwrap();
    assert!(along.len() == 1 && along[0].closed);
    let bad = f.section(&Plane { point: Vec3::zero(), normal: Vec3::zero() });
    assert!(matches!(bad, Err(FieldError::Degenerate { .. })));
}
