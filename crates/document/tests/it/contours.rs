//! Contours of all families, and lists of objects.

use crate::common::{ids, number, open, reported, sound};
use moldloft_document::ContourSection;
use std::f64::consts::PI;

/// A cone about an oblique axis (r = 1 - s/4 at the distance s from its base), and a box beside it.
const BODY: &str = "
AbsPoint O(1, 0, 0); AbsPoint X(1, 0, 4); Line axis(O, X); AbsPoint A(2, 0, 0); Line m(A, X);
RevSurf cone(m, axis, divisions = {8, 16});
AbsPoint P(-3, 0, 0); AbsPoint Q(-2, 0, 0); AbsPoint R(-3, 0, 2); AbsPoint S(-2, 0, 2);
Line l(P, Q); Line k(R, S); RuledSurf wall(l, k); RuledSurf hidden(l, k, visible = 0);
";

fn sections(text: &str) -> Vec<ContourSection> {
    sound(&format!("{BODY}{text}")).sections()
}

fn points(section: &ContourSection) -> Vec<moldloft_num::Vec3> {
    section.lines.iter().flat_map(|(_, lines)| lines).flat_map(|l| l.points.clone()).collect()
}

#[test]
fn cylinders_about_the_axis_cut_circles() {
    let found = sections("CylinderContours c(axis, 1, 3, 0, 0.25, surfaces = {cone});");
    assert_eq!(found.len(), 3);
    for (section, r) in found.iter().zip([0.25, 0.5, 0.75]) {
        assert_eq!((section.value, section.axis), (r, 3));
        assert!(section.lines.len() == 1 && section.lines[0].1.len() == 1, "one circle");
        for p in points(section) {
            assert!(((p.x - 1.0).hypot(p.y) - r).abs() < 1e-12);
            assert!((p.z - 4.0 * (1.0 - r)).abs() < 1e-11);
        }
    }
    // Without a list the wall is cut as well: it is in the plane y = 0, 3 to 4 off the axis.
    let all = sections("CylinderContours c(axis, 0, 0, 3.5, 1);");
    assert_eq!(all[0].lines[0].0, "wall");
    assert!(points(&all[0]).iter().all(|p| (p.x + 2.5).abs() < 1e-12));
}

#[test]
fn angles_about_the_axis_cut_meridians() {
    let found = sections("AngleContours a(axis, 0, 3, 0.25, 1.5);");
    let cone = found.iter().filter(|s| s.lines.iter().any(|(name, _)| name == "cone"));
    let mut count = 0;
    for section in cone {
        count += 1;
        let line = &section.lines.iter().find(|(name, _)| name == "cone").unwrap().1;
        assert_eq!(line.len(), 1, "one meridian, not two");
        for p in &line[0].points {
            let r = 1.0 - p.z / 4.0;
            // The axis is upright, so angle 0 is toward x.
            let at = [1.0 + r * section.value.cos(), r * section.value.sin()];
            assert!((p.x - at[0]).hypot(p.y - at[1]) < 1e-11, "{p:?} {at:?}");
        }
        let low = line[0].points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        assert!(low < 1e-12, "it reaches the base");
    }
    assert_eq!(count, 4);
    // The wall lies opposite to x, at the angle pi; another zero turns all.
    let wall = sections("AbsPoint up(1, 5, 1); AngleContours a(axis, 0, 0, 0.5, 1, zero = up);");
    assert_eq!(wall.len(), 1);
    let p = points(&wall[0]).into_iter().find(|p| p.z < 3.9).unwrap();
    assert!((p.y.atan2(p.x - 1.0) - (0.5 + PI / 2.0)).abs() < 1e-11);
}

#[test]
fn oblique_planes_cut_at_their_distances() {
    let found = sections(
        "AbsPoint N(2, 1, 1); TwoPointPlane p(O, N); PlaneContours c(p, -1, 1, 0.25, 0.5);",
    );
    assert_eq!(found.len(), 3);
    for section in &found {
        for p in points(section) {
            let d = ((p.x - 1.0) + p.y + p.z) / 3f64.sqrt();
            assert!((d - section.value).abs() < 1e-12, "{d} {}", section.value);
        }
    }
}

#[test]
fn lists_limit_what_is_cut() {
    let text = "EntityList wet({cone, hidden}); ZContours z(1, 1, 0, 1, surfaces = wet);
                ZContours y(1, 1, 0, 1);";
    let found = sections(text);
    let names = |k: usize| found[k].lines.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>();
    assert_eq!((names(0), names(1)), (vec!["cone", "hidden"], vec!["cone", "wall"]));
    // Members, loops and arguments see the objects of a list.
    let mut document = sound(&format!(
        "{BODY} EntityList row({{O, X}}); EntityList more({{row, A}}); BCurve c(more, degree = 2);
         float z = 0; foreach (p in more) {{ z += p.z; }} float x = more[3].x;
         AbsPoint last(x, z, 0); RealList law({{0, 0.125, 1}}); Relabel r(law, degree = 2);
         KnotList knots({{0, 0, 0.5, 1, 1}}); float knot = knots[3];"
    ));
    assert_eq!((number(&mut document, "last.x"), number(&mut document, "last.y")), (2.0, 4.0));
    assert_eq!((number(&mut document, "r(0.5)"), number(&mut document, "knot")), (0.3125, 0.5));
    // An edit of a member goes through the list, an edit of a list to what takes it.
    document.set(&[("A.x".into(), 6.0), ("law.values[2]".into(), 0.25)]).unwrap();
    assert_eq!(number(&mut document, "c(1).x"), 6.0);
    assert_eq!(number(&mut document, "r(0.5)"), 0.375);
    let exact = document.derivatives(&["r(0.5)".into()], &["law.values[2]".into()]).unwrap();
    assert_eq!(exact[0][0].class(), moldloft_registry::Class::Number);
    let moldloft_registry::Value::Number(d) = exact[0][0] else { panic!() };
    assert_eq!(d, 0.5);
}

#[test]
fn lists_and_contours_that_are_none() {
    for (text, id, says) in [
        ("CylinderContours c(axis, 0, 3, 0, 1);", "out-of-range", "radius 0 for i = 0"),
        ("CylinderContours c(cone, 0, 3, 1, 1);", "wrong-class", "a surface"),
        ("Line dot(O, O); AngleContours c(dot, 0, 3, 1, 1);", "zero-length-axis", "no direction"),
        ("AngleContours c(axis, 0, 3, 0, 1, zero = O);", "coincident-points", "on the axis"),
        ("PlaneContours c(\"x=0\", 3, 1, 0, 1);", "empty-range", "from 3 to 1"),
        ("PlaneContours c(\"x=0\", 0, 20000, 0, 1);", "out-of-range", "too many"),
        ("ZContours c(0, 1, 0, 1, surfaces = {axis});", "wrong-class", "surfaces and bodies"),
        ("ZContours c(0, 1, 0, 1, surfaces = cone);", "not-a-list", "a list"),
        ("EntityList e({O, A}); RevSurf x(e, axis);", "wrong-class", "a list"),
        ("EntityList e({O, axis}); BCurve x(e);", "wrong-class", "expected a point, found a curve"),
        ("EntityList e({O}); BCurve x(e);", "too-few-items", "at least 2 items, found 1"),
        ("RealList e({1, O});", "wrong-class", "a number"),
        ("KnotList e({0, 1, 0.5});", "not-monotone", "at least 1"),
        ("RealList e({0.5, 1}); BCurve x(e);", "not-a-list", "points"),
    ] {
        let document = open(&format!("{BODY}{text}"));
        assert_eq!(ids(&document), [id], "{text}: {:?}", reported(&document));
        assert!(reported(&document)[0].contains(says), "{text}: {:?}", reported(&document));
    }
}

#[test]
fn bodies_are_cut_like_surfaces() {
    let found = sound(
        "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);
         set ring = set(torus(axis, 2, 0.5)); SetBody body(ring, depth = 6);
         ZContours z(0, 0, 0.1, 1); CylinderContours c(axis, 1, 1, 0, 2);",
    )
    .sections();
    // Two circles at a height, and the same again where a cylinder passes through the tube.
    let radius = |p: &moldloft_num::Vec3| p.x.hypot(p.y);
    assert_eq!(found.iter().map(|s| s.lines[0].0.as_str()).collect::<Vec<_>>(), ["body"; 2]);
    let circles = &found[0].lines[0].1;
    assert!(circles.len() == 2 && circles.iter().all(|l| l.closed));
    let half = (0.25f64 - 0.01).sqrt();
    for p in points(&found[0]) {
        assert!(p.z == 0.1 || (p.z - 0.1).abs() < 1e-12);
        assert!(((radius(&p) - 2.0).abs() - half).abs() < 5e-3, "{p:?}");
    }
    for p in points(&found[1]) {
        assert!((radius(&p) - 2.0).abs() < 1e-11 && (p.z.abs() - 0.5).abs() < 5e-3, "{p:?}");
    }
}

#[test]
fn what_sections_do_not_measure_is_reported() {
    let ridge = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 1); AbsPoint C(2, 0, 0); AbsPoint D(0, 2, 0); \
                 AbsPoint E(1, 2, 1); AbsPoint F(2, 2, 0); BCurve a({A, B, C}, 2); BCurve b({D, E, F}, 2); \
                 RuledSurf s(a, b); AbsPoint O(0, 0, -1); AbsPoint P(0, 0, 3); Line axis(O, P);";
    for (text, id) in [
        // Along its ridge the surface touches the plane.
        ("ZContours z(0, 0, 0.5, 1); print(z.lengths);", "no-contour"),
        ("ZContours z(0, 0, 0.2, 1); print(z.areas);", "open-contour"),
        ("CylinderContours c(axis, 1, 1, 0, 1); print(c.areas);", "not-planar"),
    ] {
        let document = open(&format!("{ridge}{text}"));
        assert_eq!(ids(&document), [id], "{text}: {:?}", reported(&document));
    }
}
