//! Projections and intersections: closed forms, reports, faults, derivatives.

use crate::common::{attempt, fault, run, scene};
use moldloft_num::{Dual4, Order, Vec3};
use moldloft_registry::{Point, Scalar, SearchStatus, Value};

/// A quarter of a cylinder of radius 2 about the x axis, from x = 0 to 4: S(u, v).
const TUBE: &str = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(0, 2, 0);
    AbsPoint B(4, 2, 0); Line m(A, B); RevSurf S(m, axis, 0, 3.141592653589793);";

fn point(text: &str, name: &str) -> Point<f64> {
    let scene = scene(text);
    let object = scene.0.iter().find(|o| o.name == name).unwrap();
    match &object.value {
        Value::Point(p) => (**p).clone(),
        other => panic!("{other:?}"),
    }
}

fn status(p: &Point<f64>) -> SearchStatus {
    p.found.as_ref().unwrap().status
}

fn near(p: Vec3, x: f64, y: f64, z: f64) {
    assert!(p.distance(Vec3::of(x, y, z)) < 1e-11, "{p:?} is not ({x}, {y}, {z})");
}

#[test]
fn projections_onto_a_cylinder() {
    let p = point(&format!("{TUBE} AbsPoint P(1, 3, 4); ProjMagnet q(P, S);"), "q");
    near(p.xyz, 1.0, 1.2, 1.6);
    assert_eq!(status(&p), SearchStatus::Ok);
    let p = point(&format!("{TUBE} AbsPoint P(1, 1, 4); ProjMagnet q(P, S, \"z=0\");"), "q");
    near(p.xyz, 1.0, 1.0, 3f64.sqrt());
    let p = point(
        &format!("{TUBE} AbsPoint E(1, 0, 0); AbsPoint P(1, 3, 4); ProjMagnet q(P, S, E);"),
        "q",
    );
    near(p.xyz, 1.0, 1.2, 1.6);
    let p = point(&format!("{TUBE} AbsPoint P(1, 3, 4); ProjPoint q(P, S);"), "q");
    near(p.xyz, 1.0, 1.2, 1.6);
    // Beyond the edge x = 4.
    let p = point(&format!("{TUBE} AbsPoint P(5, 3, 4); ProjMagnet q(P, S);"), "q");
    near(p.xyz, 4.0, 1.2, 1.6);
    assert_eq!(status(&p), SearchStatus::EdgeClamped);
    let p = point(&format!("{TUBE} AbsPoint P(5, 3, 4); ProxMagnet q(P, S);"), "q");
    assert_eq!(status(&p), SearchStatus::Ok);
    // The line along y meets both sides: the nearer is the result, the other is reported.
    let p = point(&format!("{TUBE} AbsPoint P(1, 9, 1); ProjMagnet q(P, S, \"y=0\");"), "q");
    near(p.xyz, 1.0, 3f64.sqrt(), 1.0);
    assert!(matches!(status(&p), SearchStatus::Multiple { count: 2, .. }), "{p:?}");
    assert_eq!(p.found.as_ref().unwrap().alternatives.len(), 1);
    let far = format!(
        "{TUBE} AbsPoint P(1, 9, 1); AbsMagnet k(S, 0.2, 0.9); ProjMagnet q(P, k, \"y=0\");"
    );
    near(point(&far, "q").xyz, 1.0, -(3f64.sqrt()), 1.0);
}

#[test]
fn beads_on_an_arc() {
    let arc = "AbsPoint A(2, 0, 0); AbsPoint B(0, 2, 0); AbsPoint C(-2, 0, 0); Arc c(A, B, C);";
    let p = point(&format!("{arc} YPlane y(1); IntBead b(c, y);"), "b");
    assert!(matches!(status(&p), SearchStatus::Multiple { count: 2, .. }), "{p:?}");
    let p = point(&format!("{arc} YPlane y(1); AbsBead a(c, 0.9); IntBead b(a, y);"), "b");
    near(p.xyz, -(3f64.sqrt()), 1.0, 0.0);
    assert_eq!(status(&p), SearchStatus::Ok);
    let p = point(&format!("{arc} AbsBead a(c, 0.1); IntBead b(a, \"y=0\", {{0, 1, 7}});"), "b");
    near(p.xyz, 3f64.sqrt(), 1.0, 0.0);
    let p = point(&format!("{arc} XYZBead b(c, \"x\", 1);"), "b");
    near(p.xyz, 1.0, 3f64.sqrt(), 0.0);
    let p = point(&format!("{arc} AbsPoint P(3, 3, 8); ProjBead b(c, P);"), "b");
    near(p.xyz, 2f64.sqrt(), 2f64.sqrt(), 0.0);
    let p =
        point(&format!("{arc} AbsPoint M(2, 0, 0); AbsPoint N(0, 0, 0); IntBead b(c, M, N);"), "b");
    near(p.xyz, 1.0, 3f64.sqrt(), 0.0);
    let p = point(
        &format!("{arc} AbsPoint D(0, -1, 0); AbsPoint E(0, 5, 0); Line l(D, E); IntBead b(c, l);"),
        "b",
    );
    near(p.xyz, 0.0, 2.0, 0.0);
    // A plane that touches.
    let p = point(&format!("{arc} YPlane y(2); IntBead b(c, y);"), "b");
    assert_eq!(status(&p), SearchStatus::Tangent);
}

#[test]
fn curves_through_surfaces() {
    let text = format!(
        "{TUBE} AbsPoint P(1, 1, 0); AbsPoint Q(1, 1, 5); Line l(P, Q); IntBead b(l, S); IntMagnet k(l, S);
         XYZMagnet x(S, \"x\", 1, \"y\", 1);"
    );
    for name in ["b", "k", "x"] {
        let p = point(&text, name);
        near(p.xyz, 1.0, 1.0, 3f64.sqrt());
        assert_eq!(status(&p), SearchStatus::Ok);
    }
    let p = point(&format!("{TUBE} AbsMagnet k(S, 0.25, 0.5); TanMagnet q(k, 0.5, 0);"), "q");
    near(p.xyz, 1.5, 0.0, 2.0);
    let ring = format!(
        "{TUBE} UVSnake s(S, \"u\", 0.25); ZPlane z(1); AbsRing r(s, 0.1); IntRing i(r, z);"
    );
    let p = point(&ring, "i");
    near(p.xyz, 1.0, 3f64.sqrt(), 1.0);
    assert!(p.on_surface.is_some() && p.on_curve.is_some());
}

#[test]
fn what_does_not_meet_is_told() {
    let line = "AbsPoint P(1, 3, 1); AbsPoint Q(1, 3, 5); Line l(P, Q);";
    for (text, id) in [
        (format!("{TUBE} {line} IntMagnet k(l, S);"), "no-intersection"),
        (format!("{TUBE} {line} XPlane x(9); IntBead k(l, x);"), "no-intersection"),
        (format!("{TUBE} {line} IntBead k(l, m);"), "no-intersection"),
        (format!("{TUBE} {line} IntBead k(l, P);"), "missing-argument"),
        (format!("{TUBE} {line} IntBead k(l, P, P);"), "coincident-points"),
        (format!("{TUBE} {line} XYZBead k(l, \"w\", 2);"), "unknown-axis"),
        (format!("{TUBE} XYZMagnet k(S, \"x\", 1, \"x\", 2);"), "same-axis"),
        (format!("{TUBE} AbsPoint P(1, 2.5, 4); ProjMagnet q(P, S, \"z=0\");"), "no-intersection"),
        // From y = 1 the downward projection extends to the silhouette at y = 2.
        (
            format!(
                "{TUBE} AbsPoint P(1, 1, 4); AbsPoint Q(1, 2.5, 4); Line l(P, Q); ProjSnake s(l, S, \"z=0\");"
            ),
            "leaves-surface",
        ),
        (
            format!(
                "{TUBE} AbsPoint P(1, 1, 4); AbsPoint Q(6, 1, 4); Line l(P, Q); ProjSnake s(l, S);"
            ),
            "leaves-surface",
        ),
    ] {
        assert_eq!(fault(&text).id, id, "{text}");
    }
    // A silhouette inside the surface: a full tube seen from above.
    let full = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(0, 0, -2);
        AbsPoint B(4, 0, -2); Line m(A, B); RevSurf S(m, axis, 0, 6.283185307179586);";
    let text = format!(
        "{full} AbsPoint P(1, 1, 4); AbsPoint Q(1, 2.5, 4); Line l(P, Q); AbsMagnet k(S, 0.25, 0.4); ProjSnake s(l, k, \"z=0\");"
    );
    assert_eq!(fault(&text).id, "grazing-projection");
    let text = format!(
        "{TUBE} AbsPoint P(1, 1, 4); AbsPoint Q(3, 1, 4); Line l(P, Q); AbsMagnet a(S, 0.1, 0.1); AbsMagnet b(S, 0.9, 0.1); ProjSnake s(l, S, ends = {{a, b}});"
    );
    assert_eq!(fault(&text).id, "open-end");
}

#[test]
fn projected_snakes_lie_on_the_surface_and_have_their_jets() {
    let text = format!(
        "{TUBE} AbsPoint P(0.5, 1.5, 3); AbsPoint Q(2, -1, 4); AbsPoint R(3.5, 1, 2.5); BCurve c({{P, Q, R}});
         ProjSnake s(c, S); ProjSnake d(c, S, \"z=0\"); AbsPoint E(2, 0, -1); ProjSnake e(c, S, E); ProjCurve f(c, S);"
    );
    let scene = scene(&text);
    let get = |name: &str| match &scene.0.iter().find(|o| o.name == name).unwrap().value {
        Value::Curve(c) => c.clone(),
        other => panic!("{other:?}"),
    };
    let c = get("c");
    for name in ["s", "d", "e", "f"] {
        let snake = get(name);
        for k in 0..=20 {
            let t = f64::from(k) / 20.0;
            let [x, d, dd] = snake.jet(t, Order::Second);
            let p = c.jet(t, Order::Zero)[0];
            assert!(((x.y * x.y + x.z * x.z).sqrt() - 2.0).abs() < 1e-13);
            match name {
                "s" | "f" => {
                    let r = (p.y * p.y + p.z * p.z).sqrt();
                    near(x, p.x, 2.0 * p.y / r, 2.0 * p.z / r);
                }
                "d" => near(x, p.x, p.y, (4.0 - p.y * p.y).sqrt()),
                _ => {
                    let e = Vec3::of(2.0, 0.0, -1.0);
                    assert!((x - e).cross(p - e).norm() < 1e-11);
                }
            }
            let h = 1e-5;
            let at = |s: f64| snake.jet(s, Order::First);
            let (a, b) = (at(t + h), at(t - h));
            assert!(((a[0] - b[0]) / (2.0 * h) - d).norm() < 1e-7 * (1.0 + d.norm()), "{name} {t}");
            assert!(
                ((a[1] - b[1]) / (2.0 * h) - dd).norm() < 1e-6 * (1.0 + dd.norm()),
                "{name} {t}"
            );
        }
    }
}

/// Compared values of the objects called `names`: points, and positions and tangents of curves.
fn measured<T: Scalar>(
    text: &str,
    names: &[&str],
    literals: &mut dyn FnMut(usize, f64) -> T,
) -> Vec<Vec3<T>> {
    let scene = run::<T>(text, literals).unwrap();
    let value = |name: &&str| &scene.0.iter().find(|o| o.name == *name).unwrap().value;
    let of = |value: &Value<T>| match value {
        Value::Point(p) => vec![p.xyz],
        Value::Curve(c) => [0.0, 0.3, 0.7, 1.0]
            .into_iter()
            .flat_map(|t| c.jet(T::from(t), Order::First).into_iter().take(2))
            .collect(),
        other => panic!("{other:?}"),
    };
    names.iter().map(value).flat_map(of).collect()
}

/// Every literal of a text: derivatives of all points, four at a time, against differences.
fn check_derivatives(text: &str, names: &[&str], h: f64) {
    check_closely(text, names, h, 1e-6);
}

fn check_closely(text: &str, names: &[&str], h: f64, tolerance: f64) {
    let mut count = 0;
    measured::<f64>(text, names, &mut |k, x| {
        count = count.max(k + 1);
        x
    });
    for first in (0..count).step_by(4) {
        let seeded =
            |i: usize, x: f64| if i / 4 * 4 == first { Dual4::seeded(x, i % 4) } else { x.into() };
        let exact = measured::<Dual4>(text, names, &mut |i, x| seeded(i, x));
        for k in first..count.min(first + 4) {
            let mut moved =
                |d: f64| measured::<f64>(text, names, &mut |i, x| if i == k { x + d } else { x });
            // Fourth order: the bends at sharp points must not affect the result.
            let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(&mut moved);
            for (n, e) in exact.iter().enumerate() {
                let near = (a[n] - b[n]) * (8.0 / (12.0 * h));
                let difference = near - (c[n] - d[n]) * (1.0 / (12.0 * h));
                let e = e.map(|x| x.eps[k - first]);
                assert!(
                    e.distance(difference) < tolerance * (1.0 + difference.norm()),
                    "literal {k}, value {n}: {e:?} but {difference:?}\n{text}"
                );
            }
        }
    }
    assert!(count > 10);
}

#[test]
fn derivatives_are_exact() {
    let text = "AbsPoint A(0, 0, 0.1); AbsPoint B(2, 0.3, 1); AbsPoint C(4, 0, 0.3); AbsPoint D(0, 3, 0.2);
        AbsPoint E(2, 3.2, 1.2); AbsPoint F(4, 3, 0.1); BCurve k({A, B, C}); BCurve l({D, E, F}); RuledSurf S(k, l);
        AbsPoint P(1, 1, 3); AbsPoint Q(2.2, 1.7, 2.5); AbsPoint R(3, 2, 3.2); BCurve c({P, Q, R});
        ProjMagnet m1(P, S); ProjMagnet m2(Q, S, \"z=0\"); AbsPoint eye(2, 1.5, 9); ProjMagnet m3(R, S, eye);
        AbsPoint G(2.1, 1.4, -1); Line n(Q, G); IntMagnet i(n, S); IntBead j(n, S); AbsPoint H(7, 1, 0.5);
        ProjMagnet m4(H, S); XYZMagnet x(S, \"x\", 1.25, \"y\", 1.5); AbsMagnet q(S, 0.4, 0.6); TanMagnet t(q, 0.3, 0.2);
        XPlane p(2.3); IntBead b(c, p); ProjBead f(c, G); ProxBead g(c, eye); IntBead o(c, A, Q);
        ProjSnake s(c, S); ProjSnake u(c, S, \"z=0\"); ProjSnake v(c, S, eye); ProjPoint w(R, S);";
    check_derivatives(
        text,
        &["m1", "m2", "m3", "m4", "i", "j", "x", "t", "b", "f", "g", "o", "s", "u", "v", "w"],
        1e-5,
    );
    attempt(text).unwrap();
}

fn curve(scene: &crate::common::Scene<f64>, name: &str) -> moldloft_registry::CurveRef<f64> {
    match &scene.0.iter().find(|o| o.name == name).unwrap().value {
        Value::Curve(c) => c.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn intersections_of_a_cylinder() {
    // A plane across is half a circle of radius 2; a slanted one half an ellipse; another tube of
    // radius 1 about the line x = 2, y = 0 makes a closed curve.
    let text = format!(
        "{TUBE} XPlane x(1.5); IntSnake c(S, x); AbsPoint N(1, 0, 1); TwoPointPlane n(O, N); AbsPoint M(2, 0, 0);
         AbsMagnet k(S, 0.5, 0.5); IntSnake e(k, n, point = M); AbsPoint U(2, 0, 9); Line post(M, U);
         AbsPoint V(3, 0, 0); AbsPoint W(3, 0, 4); Line v(V, W); RevSurf P(v, post, 0, 6.283185307179586);
         AbsMagnet g(S, 0.74, 0.5); IntSnake o(g, P);"
    );
    let scene = scene(&text);
    let c = curve(&scene, "c");
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        let [x, d, dd] = c.jet(t, Order::Second);
        let a = std::f64::consts::PI * t;
        let (ends, sign) = ((c.end(0.0), c.end(1.0)), c.end(0.0).y.signum());
        assert!((ends.0.y.abs() - 2.0).abs() < 1e-12 && ends.1.z.abs() < 1e-12);
        near(x, 1.5, sign * 2.0 * a.cos(), 2.0 * a.sin());
        assert!((d.norm() - std::f64::consts::TAU).abs() < 1e-11, "{}", d.norm());
        assert!(d.dot(dd).abs() < 1e-9, "{}", d.dot(dd));
    }
    for name in ["e", "o"] {
        let e = curve(&scene, name);
        let length = e.jet(0.3, Order::First)[1].norm();
        for k in 0..=60 {
            let t = f64::from(k) / 60.0;
            let [x, d, _] = e.jet(t, Order::First);
            assert!(((x.y * x.y + x.z * x.z).sqrt() - 2.0).abs() < 1e-12, "{name}: {x:?}");
            let other = if name == "e" {
                x.x - 2.0 + x.z
            } else {
                ((x.x - 2.0).powi(2) + x.y * x.y).sqrt() - 1.0
            };
            assert!(other.abs() < 1e-12, "{name}: {other}");
            assert!(
                (d.norm() - length).abs() < 1e-11 * length,
                "{name} {t}: {} {length}",
                d.norm()
            );
        }
    }
    let nothing = format!("{TUBE} XPlane x(5); IntSnake c(S, x);");
    assert_eq!(fault(&nothing).id, "no-intersection");
    let elsewhere =
        format!("{TUBE} XPlane x(1); AbsMagnet k(S, 0.5, 0.5); IntSnake c(S, x, start = k);");
    assert_eq!(fault(&elsewhere).id, "open-end");
    let other = format!(
        "{TUBE} XPlane x(1); RuledSurf R(m, axis); AbsMagnet k(R, 0.5, 0.5); IntSnake c(S, x, start = k);"
    );
    assert_eq!(fault(&other).id, "wrong-surface");
    // A plane that touches the tube along a line.
    let touch = format!("{TUBE} ZPlane z(2); AbsMagnet k(S, 0.5, 0.45); IntSnake c(k, z);");
    assert!(matches!(fault(&touch).id, "tangent-contact" | "no-intersection"));
}

#[test]
fn derivatives_of_intersection_snakes_are_exact() {
    let text = "AbsPoint A(0, 0, 0.1); AbsPoint B(2, 0.3, 1); AbsPoint C(4, 0, 0.3); AbsPoint D(0, 3, 0.2);
        AbsPoint E(2, 3.2, 1.2); AbsPoint F(4, 3, 0.1); BCurve k({A, B, C}); BCurve l({D, E, F}); RuledSurf S(k, l);
        XPlane x(1.7); IntSnake p(S, x); AbsPoint G(1, -1, -2); AbsPoint H(1.5, 4, -2); AbsPoint I(2, -1, 3);
        AbsPoint J(1.2, 4, 3); Line m(G, H); Line n(I, J); RuledSurf W(m, n); IntSnake q(S, W);
        YPlane y(1.2); IntRing r(q, y); IntSnake s(S, W, start = r); AbsPoint K(2, 1.5, -2); AbsPoint L(2, 1.5, 5);
        Line post(K, L); AbsPoint M(2.8, 1.5, -2); AbsPoint N(2.8, 1.6, 5); Line v(M, N);
        RevSurf T(v, post, 0.2, 6.3); AbsMagnet z(S, 0.3, 0.5); IntSnake o(z, T);";
    check_derivatives(text, &["p", "q", "s", "o"], 1e-6);
}

/// At strong curvature the length of an intersection is not that of a polynomial between stations;
/// the derivatives with respect to length must not depend on the stations. Also, a crease that the
/// cut crosses moves.
#[test]
fn derivatives_of_intersections_are_exact_at_sharp_bends_and_creases() {
    // A saddle, and planes just above and below its middle; a hill, and one under its top.
    for (edge, side, middle, level) in
        [(-1.0, 1.0, 0.02, 0.032), (-1.0, 1.0, 0.02, -0.01), (0.3, 0.4, 2.6, 0.7)]
    {
        let text = format!(
            "AbsPoint A(0, 0, 0); AbsPoint B(2, 0.1, {edge}); AbsPoint C(4, 0, 0.05); AbsPoint D(0.1, 1, {side});
             AbsPoint E(2, 1.1, {middle}); AbsPoint F(4, 1, {side}); AbsPoint G(0, 2, 0); AbsPoint H(2, 2.1, {edge});
             AbsPoint I(4, 2, 0); BCurve k({{A, B, C}}); BCurve l({{D, E, F}}); BCurve n({{G, H, I}});
             BLoftSurf S({{k, l, n}}); AbsPoint N(2, 1, {level}); AbsPoint P(2.05, 1.1, {top});
             TwoPointPlane p(N, P); IntSnake c(S, p);",
            top = level + 9.0
        );
        check_closely(&text, &["c"], 1e-4, 1e-8);
    }
    let ridge = "AbsPoint M(0, -1, 0.3); AbsPoint N(2, -0.9, 0.5); AbsPoint O(4, -1, 0.6); Line a(M, N); Line b(N, O);
        PolyCurve o({a, b}); AbsPoint P(0, 3, 0.5); AbsPoint Q(2.2, 2.9, 0.8); AbsPoint R(4, 3, 0.8); Line c(P, Q);
        Line d(Q, R); PolyCurve q({c, d}); RuledSurf T(o, q); YPlane y(1.3); IntSnake t(T, y);
        AbsPoint E(-1, 0.3, -2); AbsPoint F(5, 2.1, -2); AbsPoint G(-1, 0.2, 3); AbsPoint H(5, 2.4, 3); Line e(E, F);
        Line f(G, H); RuledSurf W(e, f); IntSnake x(T, W);";
    check_closely(ridge, &["t", "x"], 1e-4, 1e-8);
    // A ridge over which they turn by more than 70 degrees.
    let sharp =
        ridge.replace("2, -0.9, 0.5", "2, -0.9, 2.5").replace("2.2, 2.9, 0.8", "2.2, 2.9, 2.7");
    for name in ["t", "x"] {
        let c = curve(&scene(&sharp), name);
        let [x, d, _] = c.jet(0.0, Order::First);
        let [y, e, _] = c.jet(1.0, Order::First);
        assert!(x.distance(y) > 3.9 && c.breaks().len() == 1, "{name}");
        assert!(d.dot(e) < 0.3 * d.norm() * e.norm(), "{name}");
    }
    check_closely(&sharp, &["t", "x"], 1e-4, 1e-8);
}

/// A whole tube of radius 2 about the x axis, closed at a seam below y = 2.
const PIPE: &str = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(0, 2, 0);
    AbsPoint B(4, 2, 0); Line m(A, B); RevSurf S(m, axis, 0, 6.283185307179586);";

#[test]
fn closed_intersections_need_no_magnet_and_run_across_seams() {
    let text = format!("{PIPE} XPlane x(1.5); IntSnake c(S, x); Intersection d(S, x);");
    let s = scene(&text);
    for name in ["c", "d"] {
        let c = curve(&s, name);
        let [start, _, _] = c.jet(0.0, Order::Zero);
        let end = c.end(1.0);
        assert!(start.distance(end) < 1e-11);
        // It begins at the point nearest to S(0.3, 0.4): straight across from it.
        let a = 0.4 * std::f64::consts::TAU;
        let (y, z) = (2.0 * a.cos(), 2.0 * a.sin());
        assert!(start.distance(Vec3::of(1.5, y, z)) < 1e-9, "{start:?}");
        for k in 0..=50 {
            let [x, d, dd] = c.jet(f64::from(k) / 50.0, Order::Second);
            assert!(
                (x.x - 1.5).abs() < 1e-12 && ((x.y * x.y + x.z * x.z).sqrt() - 2.0).abs() < 1e-12
            );
            assert!((d.norm() - 2.0 * std::f64::consts::TAU).abs() < 1e-10);
            assert!((dd.norm() - 2.0 * std::f64::consts::TAU.powi(2)).abs() < 1e-8);
        }
        let ts: Vec<f64> = (0..=30).map(|k| f64::from(k) / 30.0).collect();
        let mut grid = vec![Vec3::zero(); ts.len()];
        c.grid(&ts, &mut grid);
        for (t, x) in ts.iter().zip(grid) {
            assert!(x.bits_eq(c.jet(*t, Order::Zero)[0]), "{name} {t}");
        }
    }
    // Derivatives by everything, the closed ones' start included.
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0.1, 1.8); AbsPoint C(4, 0, 0.2); AbsPoint D(0.1, 2, 1.9);
        AbsPoint E(2, 2.1, 4.5); AbsPoint F(4, 2, 2); AbsPoint G(0, 4, 0.1); AbsPoint H(2, 4.1, 2);
        AbsPoint I(4, 4, 0); BCurve k({A, B, C}); BCurve l({D, E, F}); BCurve n({G, H, I});
        BLoftSurf S({k, l, n}); AbsPoint N(2, 2.1, 1.9); AbsPoint P(2.1, 2.3, 3.5); TwoPointPlane p(N, P);
        IntSnake e(S, p); Intersection f(S, p); AbsPoint J(-1, -1, 1.8); AbsPoint K(5, -1, 2); AbsPoint L(-1, 5, 1.9);
        AbsPoint M(5, 5, 2.1); Line a(J, K); Line b(L, M); RuledSurf T(a, b); IntSnake o(S, T);
        IntSnake against(T, S); Intersection x(S, T); IntSnake low(S, x); IntSnake high(T, x);
        AbsRing r(o, 0.3); AbsRing q(o, 0.7); Intersection near(S, T, start = r, end = q);
        IntSnake far(T, S, start = r, end = q);";
    let names = ["e", "f", "o", "against", "x", "low", "high"];
    let s = scene(text);
    for name in names {
        let c = curve(&s, name);
        assert!(c.end(0.0).distance(c.end(1.0)) < 1e-10, "{name} is closed");
    }
    check_derivatives(text, &names, 1e-6);
    // One curve, whichever surface it is on.
    let o = curve(&s, "o");
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        let [p, d, dd] = o.jet(t, Order::Second);
        for (name, t, sign) in
            [("x", t, 1.0), ("low", t, 1.0), ("high", t, 1.0), ("against", 1.0 - t, -1.0)]
        {
            let [q, e, ee] = curve(&s, name).jet(t, Order::Second);
            assert!(p.distance(q) < 1e-12, "{name} {t}: {p:?} {q:?}");
            assert!(d.distance(e * sign) < 1e-9 && dd.distance(ee) < 1e-7, "{name} {t}");
        }
    }
    // Ends on one surface hold for both; each direction takes its own way between them.
    let [near, far] = ["near", "far"].map(|name| curve(&s, name));
    for c in [&near, &far] {
        assert!(c.end(0.0).distance(o.end(0.3)) < 1e-11 && c.end(1.0).distance(o.end(0.7)) < 1e-11);
    }
    assert!(near.end(0.5).distance(o.end(0.5)) < 1e-10);
    assert!(far.end(0.5).distance(o.end(0.0)) < 1e-10);
}

#[test]
fn several_branches_are_told_and_another_can_be_chosen() {
    // A plane along the axis of a tube cuts it in two lines.
    let both = format!("{PIPE} ZPlane z(1); IntSnake c(S, z);");
    let c = curve(&scene(&both), "c");
    let found = c.found.as_ref().unwrap();
    assert!(matches!(found.status, SearchStatus::Multiple { count: 2, .. }), "{found:?}");
    assert!(found.advice.contains("magnet near it"));
    let [u, v] = found.alternatives[0].0[..] else { panic!("{found:?}") };
    let other = format!("{PIPE} ZPlane z(1); AbsMagnet k(S, {u}, {v}); IntSnake c(k, z);");
    let other = curve(&scene(&other), "c");
    assert_eq!(other.found.as_ref().unwrap().status, SearchStatus::Ok);
    let (p, q) = (c.end(0.5), other.end(0.5));
    assert!((p.y + q.y).abs() < 1e-11 && (p.y - q.y).abs() > 3.0, "{p:?} {q:?}");
    // A touch is not an intersection, and is reported.
    let touch = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 2); AbsPoint C(4, 0, 0); AbsPoint D(0, 2, 2); AbsPoint E(2, 2, 4);
        AbsPoint F(4, 2, 2); AbsPoint G(0, 4, 0); AbsPoint H(2, 4, 2); AbsPoint I(4, 4, 0);
        BCurve k({A, B, C}, 2); BCurve l({D, E, F}, 2); BCurve n({G, H, I}, 2); BLoftSurf S({k, l, n}, 2);
        ZPlane z(2); IntSnake c(S, z);";
    let found = fault(touch);
    assert_eq!(found.id, "tangent-contact", "{found:?}");
    assert!(found.found.as_ref().unwrap().contains("(2.000000, 2.000000, 2.000000)"), "{found:?}");
}

#[test]
fn three_shapes_have_common_points() {
    let p = point("XPlane x(1.5); YPlane y(-2); ZPlane z(3); IntPoint q(x, y, z);", "q");
    near(p.xyz, 1.5, -2.0, 3.0);
    let p = point(&format!("{TUBE} XPlane x(1.5); YPlane y(1); IntPoint q(S, x, y);"), "q");
    near(p.xyz, 1.5, 1.0, 3f64.sqrt());
    assert_eq!(status(&p), SearchStatus::Ok);
    // The whole tube: two branches, one of which a magnet or a point selects.
    let two = format!("{PIPE} XPlane x(1.5); YPlane y(1);");
    let p = point(&format!("{two} IntPoint q(x, S, y);"), "q");
    assert!(matches!(status(&p), SearchStatus::Multiple { count: 2, .. }), "{p:?}");
    let p = point(&format!("{two} AbsPoint n(0, 0, -5); IntPoint q(x, S, y, n);"), "q");
    near(p.xyz, 1.5, 1.0, -(3f64.sqrt()));
    let p = point(&format!("{two} AbsMagnet n(S, 0.4, 0.2); IntPoint q(x, n, y);"), "q");
    near(p.xyz, 1.5, 1.0, 3f64.sqrt());
    // Three tubes of radius 2 about the axes: where x^2 = y^2 = z^2 = 2.
    let third = "AbsPoint C(2, -4, 0); AbsPoint D(2, 4, 0); Line n(C, D); AbsPoint Y(0, 1, 0); Line second(O, Y);
        RevSurf T(n, second, 0, 6.283185307179586); AbsPoint E(2, 0, -4); AbsPoint F(2, 0, 4); Line k(E, F);
        AbsPoint Z(0, 0, 1); Line third(O, Z); RevSurf R(k, third, 0, 6.283185307179586);";
    let p = point(&format!("{PIPE} {third} AbsPoint e(1, 1, 1); IntPoint q(S, T, R, e);"), "q");
    let h = 2f64.sqrt();
    near(p.xyz, h, h, h);
    // Only x > 0 is on the first tube: four common points.
    assert!(matches!(status(&p), SearchStatus::Multiple { count: 4, .. }), "{:?}", p.found);
    assert_eq!(
        fault("XPlane x(1); XPlane y(2); ZPlane z(3); IntPoint q(x, y, z);").id,
        "parallel-planes"
    );
    assert_eq!(
        fault(&format!("{TUBE} XPlane x(9); YPlane y(1); IntPoint q(S, x, y);")).id,
        "no-intersection"
    );
    let line = fault(&format!("{TUBE} XPlane x(1); IntPoint q(S, x, m);"));
    assert_eq!((line.id, line.help.is_empty()), ("wrong-class", false));
    check_derivatives(
        "AbsPoint A(0, 0, 0.1); AbsPoint B(2, 0.3, 1); AbsPoint C(4, 0, 0.3); AbsPoint D(0, 3, 0.2);
         AbsPoint E(2, 3.2, 1.2); AbsPoint F(4, 3, 0.1); BCurve k({A, B, C}); BCurve l({D, E, F}); RuledSurf S(k, l);
         AbsPoint G(1, -1, -2); AbsPoint H(1.5, 4, -2); AbsPoint I(2, -1, 3); AbsPoint J(1.2, 4, 3); Line m(G, H);
         Line n(I, J); RuledSurf W(m, n); AbsPoint K(0, 1, 0); AbsPoint L(0.2, 2, 0.1); TwoPointPlane p(K, L);
         AbsPoint M(4, 1.7, -2); AbsPoint N(0, 1.2, -2); AbsPoint P(4, 1.3, 3); AbsPoint Q(0, 1.6, 3); Line q(M, N);
         Line r(P, Q); RuledSurf T(q, r); XPlane x(1.4); ZPlane z(0.3); IntPoint a(S, W, p); IntPoint b(S, W, T);
         IntPoint c(x, S, p); IntPoint d(x, p, z);",
        &["a", "b", "c", "d"],
        1e-6,
    );
}

#[test]
fn geodesics_are_straight_on_what_unrolls_and_great_circles_on_spheres() {
    // On a tube a geodesic is a helix: its length is that on the unrolled sheet.
    let text =
        format!("{TUBE} AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.8, 0.9); GeoSnake g(p, q);");
    let s = scene(&text);
    let g = curve(&s, "g");
    let (along, round) = (0.7 * 4.0, 0.7 * std::f64::consts::PI * 2.0);
    let length = f64::hypot(along, round);
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        let [x, d, _] = g.jet(t, Order::First);
        assert!((d.norm() - length).abs() < 1e-9, "{} {length}", d.norm());
        let a = std::f64::consts::PI * (0.2 + 0.7 * t);
        assert!(x.distance(Vec3::of(0.4 + 2.8 * t, 2.0 * a.cos(), 2.0 * a.sin())) < 1e-10);
    }
    let [p, q] = ["p", "q"].map(|n| match &s.0.iter().find(|o| o.name == n).unwrap().value {
        Value::Point(p) => p.xyz,
        other => panic!("{other:?}"),
    });
    assert!(g.end(0.0).bits_eq(p) && g.end(1.0).bits_eq(q));
    // On a sphere of radius 3 (half a circle turned) it is the great circle's arc.
    let ball = "AbsPoint O(0, 0, 0); AbsPoint X(3, 0, 0); AbsPoint Y(-3, 0, 0); AbsPoint Z(0, 3, 0); Line axis(O, X);
        Arc half(X, Z, Y); RevSurf S(half, axis, 0, 6.283185307179586); AbsMagnet p(S, 0.3, 0.2);
        AbsMagnet q(S, 0.6, 0.5); GeoSnake g(p, q);";
    let s = scene(ball);
    let g = curve(&s, "g");
    let (a, b) = (g.end(0.0), g.end(1.0));
    let length = 3.0 * (a.dot(b) / 9.0).acos();
    let n = a.cross(b).normalized().unwrap();
    for k in 0..=20 {
        let [x, d, dd] = g.jet(f64::from(k) / 20.0, Order::Second);
        assert!((x.norm() - 3.0).abs() < 1e-12 && x.dot(n).abs() < 1e-9, "{x:?}");
        assert!((d.norm() - length).abs() < 1e-8, "{} {length}", d.norm());
        assert!((dd + x * (length * length / 9.0)).norm() < 1e-5, "{dd:?}");
    }
    let text = "AbsPoint A(0, 0, 0.1); AbsPoint B(2, 0.3, 1); AbsPoint C(4, 0, 0.3); AbsPoint D(0, 3, 0.2);
        AbsPoint E(2, 3.2, 1.2); AbsPoint F(4, 3, 0.1); BCurve k({A, B, C}); BCurve l({D, E, F}); RuledSurf S(k, l);
        AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.7); GeoSnake g(p, q);";
    check_derivatives(text, &["g"], 1e-6);
    let same =
        format!("{TUBE} AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.1, 0.2); GeoSnake g(p, q);");
    assert_eq!(fault(&same).id, "coincident-points");
    let two = format!(
        "{TUBE} RuledSurf R(m, axis); AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(R, 0.1, 0.2); GeoSnake g(p, q);"
    );
    assert_eq!(fault(&two).id, "wrong-surface");
    // Turns are of a seam that is there.
    let turned = format!(
        "{TUBE} AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.8, 0.9); GeoSnake g(p, q, turns_u = 1);"
    );
    assert_eq!(fault(&turned).id, "no-seam");
    // At the rim of a cup the path leaves it.
    let cup = "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint A(1, 0, 0); AbsPoint B(3, 0, 2);
        Line m(A, B); RevSurf S(m, axis, 0, 3); AbsMagnet p(S, 0.001, 0.1); AbsMagnet q(S, 0.001, 0.9); GeoSnake g(p, q);";
    assert_eq!(fault(cup).id, "leaves-surface");
    // Opposite points of three quarters of a sphere have infinitely many great circles.
    let opposite = "AbsPoint O(0, 0, 0); AbsPoint X(3, 0, 0); AbsPoint Y(-3, 0, 0); AbsPoint Z(0, 3, 0); Line axis(O, X);
        Arc half(X, Z, Y); RevSurf S(half, axis, 0, 4.71238898038469); AbsMagnet p(S, 0.3, 0.1);
        AbsMagnet q(S, 0.7, 0.766666666666666667); GeoSnake g(p, q);";
    let found = fault(opposite);
    assert_eq!(found.id, "no-convergence");
    assert!(found.help.iter().any(|text| text.contains("put magnets between them")), "{found:?}");
}

#[test]
fn geodesics_run_over_the_seams_of_what_is_closed() {
    use std::f64::consts::TAU;
    // A whole pipe of radius 2 and length 4: helices, of each number of turns.
    let pipe = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(0, 2, 0); AbsPoint B(4, 2, 0);
        Line m(A, B); RevSurf S(m, axis); AbsMagnet p(S, 0.1, 0.9); AbsMagnet q(S, 0.8, 0.15);
        GeoSnake g(p, q); GeoSnake back(q, p); GeoSnake within(p, q, turns_v = 0);
        GeoSnake twice(p, q, turns_v = 2); GeoSnake other(q, p, turns_v = -3); GeoSnake ring(p, p, turns_v = 1); GeoSnake many(p, q, turns_v = 8);";
    let s = scene(pipe);
    let check = |name: &str, [u, v]: [f64; 2], [du, dv]: [f64; 2]| {
        let g = curve(&s, name);
        let length = f64::hypot(4.0 * du, 2.0 * TAU * dv);
        for k in 0..=40 {
            let t = f64::from(k) / 40.0;
            let [x, d, _] = g.jet(t, Order::First);
            assert!((d.norm() - length).abs() < 1e-9 * length, "{name} {t} {} {length}", d.norm());
            let a = TAU * (v + dv * t);
            let helix = Vec3::of(4.0 * (u + du * t), 2.0 * a.cos(), 2.0 * a.sin());
            assert!(x.distance(helix) < 1e-9, "{name} {t} {x:?} {helix:?}");
            let w = g.on_surface(t, Order::Zero).unwrap()[0];
            assert!((0.0..=1.0).contains(&w.y), "{name} {w:?}");
        }
    };
    check("g", [0.1, 0.9], [0.7, 0.25]);
    check("back", [0.8, 0.15], [-0.7, -0.25]);
    check("within", [0.1, 0.9], [0.7, -0.75]);
    check("twice", [0.1, 0.9], [0.7, 1.25]);
    check("other", [0.8, 0.15], [-0.7, -2.25]);
    check("ring", [0.1, 0.9], [0.0, 1.0]);
    check("many", [0.1, 0.9], [0.7, 7.25]);
    let [p, q] = ["p", "q"].map(|n| match &s.0.iter().find(|o| o.name == n).unwrap().value {
        Value::Point(p) => p.xyz,
        other => panic!("{other:?}"),
    });
    for (name, ends) in [("g", [p, q]), ("back", [q, p]), ("twice", [p, q])] {
        let g = curve(&s, name);
        assert!(g.end(0.0).bits_eq(ends[0]) && g.end(1.0).bits_eq(ends[1]), "{name}");
    }
    let one = pipe.split(" GeoSnake back").next().unwrap();
    check_derivatives(one, &["g"], 1e-6);
    // A cone with its top cut off, unrolled: radius r' = slant, angle a sin(alpha), a straight line.
    let cone = "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint A(0.6, 0, 0.8); AbsPoint B(3, 0, 4);
        Line m(A, B); RevSurf S(m, axis); AbsMagnet p(S, 0.5, 0.8); AbsMagnet q(S, 0.9, 0.05); GeoSnake g(p, q);";
    let s = scene(cone);
    let g = curve(&s, "g");
    let sine = 0.6;
    let slant = |u: f64| 1.0 + 4.0 * u;
    let flat = |u: f64, v: f64| -> Vec3 {
        let a = TAU * v * sine;
        Vec3::of(slant(u) * a.cos(), slant(u) * a.sin(), 0.0)
    };
    let (a, b) = (flat(0.5, -0.2), flat(0.9, 0.05));
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        let [x, d, _] = g.jet(t, Order::First);
        assert!((d.norm() - a.distance(b)).abs() < 1e-9, "{} {}", d.norm(), a.distance(b));
        let on = a + (b - a) * t;
        let (r, angle) = (on.x.hypot(on.y), on.y.atan2(on.x) / sine);
        let place = Vec3::of(0.6 * r * angle.cos(), 0.6 * r * angle.sin(), 0.8 * r);
        assert!(x.distance(place) < 1e-9, "{t} {x:?} {place:?}");
    }
    // Closed in both directions: the shortest across both seams of a ring, normal to it all along.
    let ring = "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint A(4, 0, 0); AbsPoint C(3, 0, 0);
        AbsPoint D(3, 0, 1); Arc c(A, C, D, type = 6); RevSurf S(c, axis); AbsMagnet p(S, 0.95, 0.95);
        AbsMagnet q(S, 0.07, 0.08); GeoSnake g(p, q);";
    let s = scene(ring);
    let g = curve(&s, "g");
    let [_, d, _] = g.jet(0.0, Order::First);
    assert!(d.norm() < 4.0, "{}", d.norm());
    for k in 1..20 {
        let t = f64::from(k) / 20.0;
        let [x, e, dd] = g.jet(t, Order::Second);
        assert!((e.norm() - d.norm()).abs() < 1e-8);
        let out = Vec3::of(x.x, x.y, 0.0).normalized().unwrap() * 3.0;
        let n = (x - out).normalized().unwrap();
        assert!(dd.cross(n).norm() < 1e-5 * dd.norm(), "{t} {dd:?} {n:?}");
    }
}
