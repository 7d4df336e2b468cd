//! Prisms: one layer of cells between the planes across an axis, however thin or long, beside
//! closed forms and beside the same bodies turned out of the grid. `MOLDLOFT_SOAK` makes the number
//! of random bodies 300.

use crate::common::{at_depth, axis, facets, sound, v};
use moldloft_field::{
    Affine, FacetOptions, Facets, Primitive, Resolution, Set, around, bracket, crossing_faces,
    facet,
};
use moldloft_num::Vec3;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

fn block(low: [f64; 3], high: [f64; 3]) -> Set {
    Set::cuboid(low.into(), high.into()).unwrap()
}

fn pole(k: usize, at: Vec3, radius: f64) -> Set {
    let along = Vec3::from([0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }));
    Set::new(&Primitive::cylinder(axis(at, along), radius).unwrap())
}

fn by_default(set: &Set) -> Facets {
    let over = around(set).unwrap().unwrap();
    facet(set, &over, &FacetOptions::new(Resolution::Level(6))).unwrap()
}

#[test]
fn plates_of_any_thickness_have_few_triangles() {
    for thickness in [1.0, 0.1, 0.002, 1e-5] {
        let mut plate = block([0.0; 3], [10.0, 10.0, thickness]);
        for k in 0..4 {
            plate = plate - pole(2, v(2.0 + 2.0 * k as f64, 5.0, 0.0), 0.7);
        }
        let f = by_default(&plate);
        sound(&f);
        let exact = thickness * (100.0 - 4.0 * 0.49 * PI);
        assert!((f.moments().volume() / exact - 1.0).abs() < 1e-7, "{thickness}");
        assert!(f.blunt.is_empty() && f.undecided.is_empty() && f.unresolved.is_empty());
        assert!(f.mesh.faces().len() < 2000 && crossing_faces(&f.mesh, None).is_empty());
        assert!(f.worst_vertex() < 1e-11);
    }
}

#[test]
fn tubes_thinner_than_cells_are_whole() {
    let mut tubes = Set::nothing();
    for k in 0..7 {
        let turn = k as f64 * PI / 3.0;
        let at = if k == 6 { Vec3::zero() } else { v(turn.cos(), turn.sin(), 0.0) * 0.7 };
        tubes = tubes | (pole(2, at, 0.3) - pole(2, at, 0.28));
    }
    let f = by_default(&(tubes & block([-5.0, -5.0, 0.0], [5.0, 5.0, 40.0])));
    sound(&f);
    let exact = 7.0 * 40.0 * PI * (0.09 - 0.0784);
    assert!((f.moments().volume() / exact - 1.0).abs() < 1e-6);
    assert_eq!(f.bodies(), 7);
}

#[test]
fn ends_that_are_no_planes_keep_their_cells() {
    let rod = pole(2, Vec3::zero(), 1.0) & block([-2.0, -2.0, 0.0], [2.0, 2.0, 20.0]);
    let rod = rod | Set::new(&Primitive::sphere(v(0.0, 0.0, 20.0), 1.0).unwrap());
    let over = around(&rod).unwrap().unwrap();
    let f = facets(&rod, &over, 7);
    sound(&f);
    let exact = 20.0 * PI + 2.0 / 3.0 * PI;
    assert!((f.moments().volume() - exact).abs() < 1e-6);
    assert!(f.mesh.faces().len() < 3000);
}

#[test]
fn every_axis_is_alike() {
    let spool = |k: usize| {
        let part = |r: f64, low: f64, high: f64| {
            let (mut a, mut b) = ([-9.0; 3], [9.0; 3]);
            (a[k], b[k]) = (low, high);
            pole(k, Vec3::zero(), r) & block(a, b)
        };
        (part(3.0, 0.0, 0.5) | part(1.0, 0.0, 6.0) | part(3.0, 5.5, 6.0))
            - pole(k, Vec3::zero(), 0.5)
    };
    let exact = PI * (9.0 + 5.0 - 6.0 * 0.25);
    for k in 0..3 {
        let f = by_default(&spool(k));
        sound(&f);
        assert!((f.moments().volume() - exact).abs() < 1e-6, "{k}");
        assert_eq!(f.bodies(), 1);
    }
}

#[test]
fn random_prisms_are_those_turned_out_of_the_grid() {
    let mut random = Random::new(50);
    let turn = Affine::rotation(&axis(Vec3::zero(), v(0.3, -0.5, 0.8)), 0.7);
    for n in 0..rounds(4, 300) {
        let whole = n % 2 == 0;
        let mut place = |low: f64, high: f64| {
            let x = random.between(low, high);
            if whole { (2.0 * x).round() / 2.0 } else { x }
        };
        let mut set = Set::nothing();
        for k in 0..4 {
            let (z, h) = (place(0.0, 2.0), place(0.5, 3.0).max(0.5));
            let (x, y, r) = (place(0.0, 4.0), place(0.0, 4.0), place(0.5, 1.5).max(0.5));
            let slab = block([-9.0, -9.0, z], [9.0, 9.0, z + h]);
            let part = match k % 2 {
                0 => pole(2, v(x, y, 0.0), r) & slab,
                _ => block([x, y, z], [x + 2.0 * r, y + r, z + h]),
            };
            set = if k == 2 { set - part } else { set | part };
        }
        let turned = set.mapped(&turn).unwrap();
        let [a, b] = [&set, &turned].map(|s| {
            let over = around(s).unwrap().unwrap();
            let f = facet(s, &over, &at_depth(6)).unwrap();
            sound(&f);
            f
        });
        let clean =
            |f: &Facets| f.blunt.is_empty() && f.undecided.is_empty() && f.unresolved.is_empty();
        let (p, q) = (a.moments().volume(), b.moments().volume());
        let over = around(&set).unwrap().unwrap();
        let proved = bracket(&set, &over, 6).unwrap().volume();
        let slack = if clean(&a) { 1e-6 } else { 1e-3 };
        assert!(p > proved.low - slack * p && p < proved.high + slack * p, "{n}: {p} {proved:?}");
        assert_eq!(crossing_faces(&a.mesh, None).len(), 0, "{n}");
        if clean(&a) && clean(&b) {
            assert!((p - q).abs() < 2e-5 * q, "{n}: {p} {q}");
            assert!((a.area() - b.area()).abs() < 2e-4 * b.area(), "{n}");
            assert_eq!(a.bodies(), b.bodies(), "{n}");
        }
    }
}
