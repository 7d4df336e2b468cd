//! Invalid shapes are refused with an id and a position.

use crate::common::{attempt, fault};
use moldloft_num::trace::Key;

const POINTS: &str = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(2, 0, 0);
    AbsPoint D(0, 1, 0); AbsPoint E(1, 1, 0); AbsPoint Z(1, 0, 0); Line l(A, B); Line m(D, E);
    RuledSurf S(l, m); RuledSurf T(m, l); AbsMagnet p(S, 0.2, 0.2); AbsMagnet q(S, 0.8, 0.2);
    AbsMagnet r(S, 0.8, 0.8); AbsMagnet s(S, 0.2, 0.8); AbsMagnet x(T, 0.5, 0.5);
    AbsBead b(l, 0.5); AbsBead c(m, 0.5); Line dot(B, Z); LineSnake pq(p, q); LineSnake qr(q, r);
    LineSnake sr(s, r); LineSnake rs(r, s); LineSnake ps(p, s); UVSnake k(T, \"u\", 0.5);";

#[test]
fn each_fault_has_its_id_and_its_place() {
    attempt(POINTS).unwrap();
    for (text, id, field, item) in [
        ("BCurve c({A, B, C}, 0);", "out-of-range", 1, None),
        ("BCurve c({A, B, C}, 26);", "out-of-range", 1, None),
        ("BCurve c({A});", "too-few-items", 0, None),
        ("BCurve c({A, B, S});", "wrong-class", 0, Some(2)),
        ("BCurve c({A, B}, 1.5);", "not-whole", 1, None),
        ("BLoftSurf c({l, m}, 0);", "out-of-range", 1, None),
        ("BSnake c({p, q}, 0);", "out-of-range", 1, None),
        ("CCurve c({A, B, Z, C});", "coincident-points", 0, Some(2)),
        ("CCurve c({A, B, C}, ends = \"free\");", "unknown-ends", 2, None),
        ("CCurve c({A, B, C, D}, 2);", "out-of-range", 1, None),
        ("CCurve c({A, B, C}, ends = \"clamped\");", "missing-argument", 3, None),
        ("CCurve c({A, B, C}, end = {1, 0, 0});", "unused-argument", 4, None),
        ("CCurve c({A, B, D, C}, ends = \"periodic\");", "not-closed", 2, None),
        ("CLoftSurf c({l, l, m});", "coincident-points", 0, Some(1)),
        ("CLoftSurf c({l, m}, ends = \"clamped\");", "missing-argument", 3, None),
        ("CLoftSurf c({l, S});", "wrong-class", 0, Some(1)),
        ("Arc c(A, B, C, 6);", "collinear-points", 0, None),
        ("Arc c(A, A, C, 2);", "coincident-points", 0, None),
        ("Arc c(A, B, C, 7);", "out-of-range", 3, None),
        ("SubCurve c(b, c);", "wrong-curve", 1, None),
        (
            "Line e(A, B); RuledSurf F(l, e); AbsMagnet n(F, 0.5, 0.5); OffsetPoint o(n, 1);",
            "no-normal",
            0,
            None,
        ),
        (
            "Line e(A, B); RuledSurf F(l, e); AbsMagnet n(F, 0.5, 0.5); TanMagnet o(n, 0.1);",
            "singular-normal",
            0,
            None,
        ),
        // Sweeps need the model, which is not available here.
        ("ProcCurve o(b, D);", "no-model", 1, None),
        ("ProcSurf o(b, m);", "no-model", 1, None),
        ("LineSnake c(p, x);", "wrong-surface", 1, None),
        ("BSnake c({p, q, x});", "wrong-surface", 0, Some(2)),
        ("LineSnake c(p, B);", "wrong-class", 1, None),
        ("AbsRing c(l, 0.5);", "wrong-class", 0, None),
        ("RelRing c(b, 0.5);", "wrong-class", 0, None),
        ("EdgeSnake c(5, S);", "out-of-range", 0, None),
        ("UVSnake c(S, \"w\", 0.5);", "unknown-parameter", 1, None),
        ("RevSurf c(l, dot);", "zero-length-axis", 1, None),
        ("MirrPoint c(A, dot);", "zero-length-axis", 1, None),
        ("MirrPoint c(A, \"w=0\");", "unknown-plane", 1, None),
        ("SubSurf c({pq});", "too-few-items", 0, None),
        ("SubSurf c({p, r});", "no-area", 0, None),
        ("SubSurf c({pq, k});", "wrong-surface", 0, Some(1)),
        ("SubSurf c({pq, l});", "wrong-class", 0, Some(1)),
        ("SubSurf c({pq, qr, rs, ps});", "open-corner", 0, Some(2)),
        ("SubSurf c({pq, qr, sr, ps, p});", "wrong-length", 0, None),
        ("ThreePointPlane c(A, B, C);", "collinear-points", 2, None),
        ("TwoPointPlane c(B, Z);", "coincident-points", 1, None),
        ("XContours c(3, 2, 0, 1);", "empty-range", 1, None),
        ("XContours c(0, 1000000000, 0, 1);", "out-of-range", 1, None),
        ("AbsPoint c(NaN, 0, 0);", "not-finite", 0, None),
        ("AbsPoint c(0, inf, 0);", "not-finite", 1, None),
        ("float c = length(S);", "wrong-class", 0, None),
        ("farray c = uniform(0, 1, 1);", "out-of-range", 2, None),
        ("farray t = uniform(0, 1.5, 4); curve c = distc(l, t);", "out-of-range", 1, Some(3)),
        ("farray c = d_tanh(1, 1, 0.1, 0.1, 5);", "no-distribution", 0, None),
    ] {
        let fault = fault(&format!("{POINTS} {text}"));
        let place = fault.field().map(|field| (field, fault.item()));
        assert_eq!((fault.id, place), (id, Some((field, item))), "{text}\n{fault:?}");
        assert!(!fault.message.ends_with('.'), "{text}: {}", fault.message);
    }
}

#[test]
fn messages_name_the_items() {
    let coincide = fault(&format!("{POINTS} CCurve c({{A, B, Z, C}});"));
    assert_eq!(coincide.message, "points 2 and 3 coincide");
    let loft = fault(&format!("{POINTS} CLoftSurf c({{m, l, l}});"));
    assert_eq!(loft.message, "curves 2 and 3 coincide");
    let flipped = fault(&format!("{POINTS} SubSurf c({{pq, qr, rs, ps}});"));
    assert_eq!(flipped.help[0], "they do when these sides are reversed: 3");
    let surfaces = fault(&format!("{POINTS} LineSnake c(p, x);"));
    let keys: Vec<Key> = surfaces.related.iter().map(|(key, _)| *key).collect();
    // Objects are numbered in order: S and T, p and x.
    assert_eq!(keys, [Key(14), Key(9), Key(10), Key(8)]);
}

#[test]
fn lofts_may_end_in_a_point() {
    let scene = crate::common::scene(
        "AbsPoint O(0, 0, 0); AbsPoint A(3, 0, 0); AbsPoint B(3, 2, 0); AbsPoint C(2, 3, 1);
         Line a(O, A); Line b(O, B); Line c(O, C); CLoftSurf fan({a, b, c}); float u = length(a);",
    );
    let fan = scene.surface("fan");
    let (us, vs) = ([0.0, 0.5], [0.0, 0.3, 1.0]);
    let mut points = [moldloft_num::Vec3::zero(); 6];
    let mut normals = points;
    fan.grid(&us, &vs, &mut points, Some(&mut normals));
    assert!(points[..3].iter().all(|p| p.norm() == 0.0));
    assert!(normals[..3].iter().all(|n| n.norm() == 0.0));
    assert!((normals[4].norm() - 1.0).abs() < 1e-15);
}

#[test]
fn a_parameter_that_is_no_number_gives_no_panic() {
    let hull = crate::common::scene(crate::common::HULL);
    let surface = hull.surface("hull");
    let p = surface.jet(f64::NAN, 0.5, moldloft_num::Order::First).p;
    assert!(p.x.is_nan());
    let mut points = [moldloft_num::Vec3::zero(); 2];
    surface.grid(&[f64::NAN, 0.5], &[f64::NAN], &mut points, None);
    assert!(points[0].x.is_nan() && points[1].x.is_nan());
}
