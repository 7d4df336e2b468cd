//! Sets: operators as logic, winners, pruning, regularisation, attributes.

use moldloft_field::{FieldError, Membership, Primitive, Set, SetAttributes};
use moldloft_num::{Axis, Box3, Vec3};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::of(x, y, z)
}

fn ball(x: f64, r: f64) -> Set {
    Set::new(&Primitive::sphere(v(x, 0.0, 0.0), r).unwrap())
}

fn points() -> impl Iterator<Item = Vec3> {
    (1..400).map(|k| {
        let part = |a: f64| 4.0 * (f64::from(k) * a).fract() - 2.0;
        v(part(0.819_172_513), part(0.671_043_607), part(0.549_700_478))
    })
}

#[test]
fn operators_are_logic() {
    let (a, b) = (ball(-0.5, 1.2), ball(0.6, 1.0));
    let inside = |s: &Set, p| s.member(p, 0.0) == Membership::Solid;
    for p in points() {
        let (x, y) = (inside(&a, p), inside(&b, p));
        assert_eq!(inside(&(&a | &b), p), x || y);
        assert_eq!(inside(&(&a & &b), p), x && y);
        assert_eq!(inside(&(&a - &b), p), x && !y);
        assert_eq!(inside(&(&a ^ &b), p), x != y);
        assert_eq!(inside(&-&a, p), !x);
        assert_eq!(inside(&-(-&a | b.clone()), p), x && !y);
    }
}

#[test]
fn membership_has_three_values_and_takes_hints() {
    let s = ball(0.0, 1.0) & Set::new(&Primitive::plane(v(0.0, 0.0, 1.0), Vec3::zero()).unwrap());
    assert_eq!(s.member(v(0.0, 0.0, -0.5), 1e-9), Membership::Solid);
    assert_eq!(s.member(v(0.0, 0.0, 0.0), 1e-9), Membership::Surface);
    assert_eq!(s.member(v(0.0, 0.0, 0.5), 1e-9), Membership::Air);
    // A point of the sphere by rounding only: the hint makes it certain.
    let p = v(0.6, 0.5, -(1.0f64 - 0.61).sqrt());
    let off = v(p.x, p.y, p.z * (1.0 + 1e-9));
    assert_eq!(s.member(off, 0.0), Membership::Air);
    let sphere = Primitive::sphere(Vec3::zero(), 1.0).unwrap();
    assert_eq!(s.as_body().member(off, 0.0, &[sphere]), Membership::Surface);
}

#[test]
fn the_winner_is_the_primitive_that_decides() {
    let s = ball(-1.0, 0.9).named("left") | ball(1.0, 0.9).named("right");
    for (x, name) in [(-0.7, "left"), (0.4, "right")] {
        let (value, leaf) = s.winner(v(x, 0.0, 0.0));
        let leaf = &s.leaves()[leaf.unwrap()];
        assert_eq!(leaf.attributes.name.as_deref(), Some(name));
        assert_eq!(value, leaf.primitive.value(v(x, 0.0, 0.0)));
    }
    assert_eq!(Set::<f64>::everything().winner(Vec3::zero()), (-1.0, None));
    assert_eq!(Set::<f64>::nothing().winner(Vec3::zero()), (1.0, None));
}

#[test]
fn pruning_keeps_the_inside_of_the_box_as_it_was() {
    let s = ((ball(-1.0, 0.9) | ball(1.0, 0.9)) - ball(0.0, 0.3)) & -ball(9.0, 1.0);
    let b = Box3 { low: v(0.5, -0.5, -0.5), high: v(1.5, 0.5, 0.5) };
    let pruned = s.pruned(&b);
    assert!(s.contents() == 4 && pruned.is_everything(), "{pruned:?}");
    let b = Box3 { low: v(0.5, 0.2, -0.5), high: v(2.5, 0.5, 0.5) };
    let pruned = s.pruned(&b);
    assert_eq!(pruned.contents(), 1);
    for q in points() {
        let p = b.centre() + v(q.x * 0.49, q.y * 0.07, q.z * 0.24);
        assert_eq!(pruned.member(p, 0.0), s.member(p, 0.0));
    }
    assert!(s.pruned(&Box3 { low: v(4.0, 4.0, 4.0), high: v(5.0, 5.0, 5.0) }).is_nothing());
}

#[test]
fn constants_and_repetitions_simplify() {
    let (a, b) = (ball(0.0, 1.0), ball(0.5, 1.0));
    assert!((&a | &Set::everything()).is_everything());
    assert!((&a & &Set::nothing()).is_nothing());
    assert!((&a & &Set::everything()).is(&a));
    assert!(Set::new(&Primitive::real(-2.0)).is_everything());
    assert!(Set::new(&Primitive::real(2.0)).is_nothing());
    assert!((&a | &ball(0.0, 1.0)).regularized().contents() == 1);
    assert!((&a | &-&a).regularized().is_everything());
    assert!((&a & &-&a).regularized().is_nothing());
    assert!((&a | &(&a & &b)).regularized().contents() == 1);
    assert!((&(&a | &b) & &a).regularized().contents() == 1);
    assert_eq!((&a - &b).regularized().contents(), 2);
    // A maximum of primitives is an intersection, so its edge is an edge.
    let [x, y, _] = Primitive::<f64>::axes();
    assert_eq!(Set::new(&-(x.max(&y))).leaves().len(), 2);
}

#[test]
fn attributes_come_from_the_nearest_handle() {
    let red = SetAttributes { colour: Some(4), ..SetAttributes::default() };
    let a = ball(0.0, 1.0).named("a");
    let both = (&a | &ball(3.0, 1.0)).with(red).named("both");
    let leaves = both.leaves();
    let said = |k: usize| (leaves[k].attributes.name.as_deref(), leaves[k].attributes.colour);
    assert_eq!((said(0), said(1)), ((Some("a"), Some(4)), (Some("both"), Some(4))));
    // The geometry is shared, the handles differ.
    let blue = a.with(SetAttributes { colour: Some(1), ..SetAttributes::default() });
    assert!(blue.is(&a) && a.attributes().unwrap().colour.is_none());
    assert_eq!((-both).leaves()[0].attributes.name.as_deref(), Some("a"));
}

#[test]
fn a_name_that_was_asked_for_is_told_from_others() {
    let asked =
        SetAttributes { name: Some("hull".into()), given: true, ..SetAttributes::default() };
    let a = ball(0.0, 1.0).named("field").with(asked);
    assert!(a.attributes().is_some_and(|a| a.given && a.name.as_deref() == Some("hull")));
    let b = a.with(SetAttributes { colour: Some(3), ..SetAttributes::default() });
    assert!(b.attributes().is_some_and(|b| b.given && b.colour == Some(3)));
    assert!(ball(0.0, 1.0).named("field").attributes().is_some_and(|a| !a.given));
}

#[test]
fn solids_from_planes() {
    let box_ = Set::cuboid(v(0.0, 0.0, 0.0), v(1.0, 2.0, 3.0)).unwrap();
    assert_eq!((box_.contents(), box_.degree()), (6, 1));
    assert_eq!(box_.member(v(0.5, 1.9, 2.9), 0.0), Membership::Solid);
    assert_eq!(box_.member(v(0.5, 2.1, 2.9), 0.0), Membership::Air);
    let corners = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)];
    let mut turned = corners;
    turned.swap(0, 1);
    for points in [corners, turned] {
        let tetrahedron = Set::tetrahedron(points).unwrap();
        assert_eq!(tetrahedron.member(v(0.2, 0.2, 0.2), 0.0), Membership::Solid);
        assert_eq!(tetrahedron.member(v(0.4, 0.4, 0.4), 0.0), Membership::Air);
    }
    let flat = [corners[0], corners[1], corners[2], v(1.0, 1.0, 0.0)];
    assert_eq!(Set::tetrahedron(flat).unwrap_err(), FieldError::Degenerate { what: "tetrahedron" });
    assert!(matches!(
        Set::cuboid(v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0)),
        Err(FieldError::EmptyBox { .. })
    ));
    let thin = Set::thin_cuboid(v(0.0, 0.0, 0.0), v(1.0, 2.0, 3.0)).unwrap();
    assert_eq!(thin.member(v(0.5, 1.0, 1.0), 1e-9), Membership::Air);
    assert_eq!(thin.member(v(0.5, 1.0, 3.0), 1e-9), Membership::Surface);
}

#[test]
fn long_chains_neither_overflow_nor_crawl() {
    let axis = Axis { point: Vec3::zero(), direction: v(0.0, 0.0, 1.0) };
    let one = Set::new(&Primitive::cylinder(axis, 1.0).unwrap());
    let mut s = one.clone();
    for _ in 0..100_000 {
        s = s | one.clone();
    }
    assert_eq!(s.complement().contents(), 100_001);
    assert_eq!(s.leaves().len(), 1);
}

/// Sets that double in each step share their parts: queries take time proportional to the number of
/// parts, not to the leaves of the tree (2^60 here).
#[test]
fn what_is_shared_is_looked_at_once() {
    let mut same = ball(0.0, 1.0);
    let (mut shared, mut plain) = (ball(0.0, 0.7), ball(0.0, 0.7));
    for k in 1..=60 {
        let at = f64::from(k) / 60.0;
        let (a, b) = (ball(at, 0.9), ball(-at, 0.8 + 0.2 * at));
        // A & (A | B) = A, and (A | B) & (A | C) = A | (B & C).
        same = &same & &(&same | &a);
        shared = (&shared | &a) & (&shared | &b);
        plain = &plain | &(&a & &b);
    }
    assert!(shared.contents() > 1 << 60);
    assert_eq!(shared.leaves().len(), 121);
    assert_eq!(same.leaves().len(), 61);
    let by_points: Vec<Vec3> = points().collect();
    let values = |s: &Set| {
        let mut out = vec![0.0; by_points.len()];
        s.values(&by_points, &mut out);
        out
    };
    assert_eq!(values(&same), values(&ball(0.0, 1.0)));
    assert_eq!(values(&shared), values(&plain));
    for p in points() {
        assert_eq!(shared.member(p, 0.0), plain.member(p, 0.0));
        assert_eq!((-&shared).value(p), -plain.value(p));
        assert_eq!(shared.regularized().value(p), plain.value(p));
    }
    let over = Box3 { low: v(-0.2, 0.5, 0.5), high: v(0.2, 0.9, 0.9) };
    let pruned = shared.pruned(&over);
    let held = |p: &Vec3| (0..3).all(|k| over.low[k] <= p[k] && p[k] <= over.high[k]);
    assert!(points().filter(held).all(|p| pruned.value(p) == plain.value(p)));
    // Names reach shared parts as they reach others.
    let named = (&same | &ball(5.0, 1.0)).named("whole");
    assert!(named.leaves().iter().all(|l| l.attributes.name.as_deref() == Some("whole")));
}
