//! Models that several tests use.
#![allow(dead_code, reason = "the example that measures times uses some of them")]

use moldloft_field::{FacetOptions, Facets, Primitive, Resolution, Set, facet};
use moldloft_mesh::{TopologyReport, measure};
use moldloft_num::{Axis, Box3, Vec3};
use std::f64::consts::SQRT_2;

pub fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::of(x, y, z)
}

pub fn axis(point: Vec3, direction: Vec3) -> Axis<f64> {
    Axis { point, direction: direction.normalized().unwrap() }
}

pub fn cube(half: f64) -> Box3 {
    Box3 { low: v(-half, -half, -half), high: v(half, half, half) }
}

pub fn at_depth(depth: u32) -> FacetOptions {
    FacetOptions::new(Resolution::Depth(depth))
}

/// The T-piece: two pipes and Liming's blend with the rail of a cone of 17 degrees.
pub fn t_piece() -> Set {
    let [x, y, z] = Primitive::<f64>::axes();
    let s = (&x + &z) / SQRT_2;
    let u = (&x - &z) / SQRT_2;
    let c1 = y.power(2) + z.power(2) - 1.0;
    let c2 = u.power(2) + y.power(2) - 0.36;
    let k = u.power(2) + y.power(2) - ((&s - 4.5 * SQRT_2) * 8.5f64.to_radians().tan()).power(2);
    let q = &c1 * &c2 * 0.6 - k.power(2) * 0.4;
    let set = Set::new;
    let along = set(&-&s).named("foot") & set(&(&s - 4.0)).named("end");
    let run =
        set(&c1).named("run") & set(&(&x - 3.5)).named("right") & set(&(-&x - 3.5)).named("left");
    let branch = set(&c2).named("branch") & along.clone();
    let fillet = set(&q).named("fillet") & set(&k).named("rail") & along;
    run | branch | fillet
}

pub fn volume(f: &Facets) -> f64 {
    measure(&f.mesh).volume
}

/// Asserts that the facets are closed, manifold and oriented, and returns the report.
pub fn sound(f: &Facets) -> TopologyReport {
    let report = f.mesh.report();
    assert!(report.closed, "open: {} loops", report.open_loops.len());
    assert!(
        report.manifold,
        "{} branches, {} pinches",
        report.branching_edges, report.pinched_vertices
    );
    assert!(report.oriented, "{} misoriented", report.misoriented_edges);
    report
}

pub fn facets(set: &Set, over: &Box3, depth: u32) -> Facets {
    facet(set, over, &at_depth(depth)).unwrap()
}
