//! Curves that a point describes when a bead sweeps another curve.

use crate::common::{line, number, open, sound};

/// The middle between a point of a circle and its foot on an axis describes an ellipse.
const TRAMMEL: &str = "AbsPoint O(0, 0, 0); AbsPoint A(2, 0, 0); AbsPoint B(0, 2, 0); Arc c(A, O, B, 6); \
    AbsBead b(c, 0.3); Line axis(O, A); ProjPoint foot(b, axis); param float w = 0.5; \
    BlendPoint m({b, foot}, {w, 1 - w}); ProcCurve way(b, m); ProcCurve half(b, m, 0.25, 0.75);";

#[test]
fn the_trammel_describes_an_ellipse() {
    let mut document = sound(TRAMMEL);
    for t in [0.0, 0.13, 0.5, 0.77, 1.0] {
        let x = number(&mut document, &format!("way({t}).x"));
        let y = number(&mut document, &format!("way({t}).y"));
        let angle = 2.0 * std::f64::consts::PI * t;
        assert!((x - 2.0 * angle.cos()).abs() < 1e-11, "{t} {x}");
        assert!((y - angle.sin()).abs() < 1e-11, "{t} {y}");
    }
    assert!((number(&mut document, "half(0.5).x") + 2.0).abs() < 1e-11);
    // Derivatives by what the point depends on, besides the bead.
    let exact = document.derivatives(&["way(0.2).y".into()], &["w".into()]).unwrap();
    let moldloft_registry::Value::Number(exact) = exact[0][0] else { panic!("a number") };
    assert!((exact - 2.0 * (0.4 * std::f64::consts::PI).sin()).abs() < 1e-10, "{exact}");
    // Where the bead itself is does not matter.
    let before = number(&mut document, "way(0.2).y");
    document.set(&[("b.t".into(), 0.9)]).unwrap();
    assert_eq!(number(&mut document, "way(0.2).y"), before);
    document.set(&[("A.x".into(), 3.0)]).unwrap();
    assert!((number(&mut document, "way(0).x") - 3.0).abs() < 1e-11);
}

/// The point stays where it is, but what lies between bead and point has changed elsewhere.
#[test]
fn a_change_that_the_point_does_not_see_reaches_the_curve() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(2, 0, 0); Line l(A, C); \
        AbsBead b(l, 0); RelPoint up(b, 0, 1, 0); Line m(A, up); AbsPoint P(0, 0, 1); \
        BCurve k({A, B, P}, degree = 2); AbsBead d(k, 0); BlendPoint q({b, d}); ProcCurve way(b, q); \
        ProcCurve other(d, q); BlendPoint r({up, d});";
    let mut document = sound(text);
    // q is at A whatever P is, but the way of d depends on P.
    let before = number(&mut document, "other(1).z");
    assert!((before - 0.5).abs() < 1e-12);
    document.set(&[("P.z".into(), 3.0)]).unwrap();
    assert!((number(&mut document, "other(1).z") - 1.5).abs() < 1e-12);
    // The same from scratch.
    let mut again = sound(&text.replace("P(0, 0, 1)", "P(0, 0, 3)"));
    for t in [0.1, 0.6] {
        let expression = format!("other({t}).z");
        assert_eq!(number(&mut document, &expression), number(&mut again, &expression));
    }
}

/// Ribs between a circle and its foot on an axis, swept: the ruled surface between them.
#[test]
fn a_rib_describes_a_surface() {
    let text = format!(
        "{TRAMMEL} RelPoint top(m, 0, 0, 1); Line rib(foot, top); ProcSurf skin(b, rib); \
         ProcSurf part(b, rib, 0.25, 0.5);"
    );
    let mut document = sound(&text);
    for (u, v) in [(0.0, 0.1), (0.4, 0.77), (1.0, 1.0), (0.3, 0.0)] {
        let angle = 2.0 * std::f64::consts::PI * v;
        let x = number(&mut document, &format!("skin({u}, {v}).x"));
        let y = number(&mut document, &format!("skin({u}, {v}).y"));
        let z = number(&mut document, &format!("skin({u}, {v}).z"));
        assert!((x - 2.0 * angle.cos()).abs() < 1e-11, "{u} {v}");
        assert!((y - u * angle.sin()).abs() < 1e-11 && (z - u).abs() < 1e-11, "{u} {v}");
        let same = number(&mut document, &format!("skin({u}, {}).x", 0.25 + 0.25 * v));
        assert!((number(&mut document, &format!("part({u}, {v}).x")) - same).abs() < 1e-10);
    }
    let exact = document.derivatives(&["skin(0.5, 0.2).y".into()], &["w".into()]).unwrap();
    let moldloft_registry::Value::Number(exact) = exact[0][0] else { panic!("a number") };
    assert!((exact - (0.4 * std::f64::consts::PI).sin()).abs() < 1e-10, "{exact}");
    assert!(document.panelled().is_ok());
    document.set(&[("B.y".into(), 2.5), ("A.x".into(), 3.0)]).unwrap();
    assert!((number(&mut document, "skin(0.5, 0).x") - 3.0).abs() < 1e-11);
}

#[test]
fn a_point_that_stays_or_has_no_place_is_refused() {
    for (text, id) in [
        ("AbsPoint P(1, 1, 1); ProcCurve k(b, P);", "constant-point"),
        ("ProcCurve k(b, b);", "constant-point"),
        ("Line rib(O, A); ProcSurf k(b, rib);", "constant-point"),
        // The plane through O, A and b has no normal where b meets the axis.
        ("ThreePointPlane p(O, A, b); ProjPoint f(B, p); ProcCurve k(b, f);", "no-locus"),
        (
            "ProcCurve k(b, m); AbsBead d(k, 0.5); RelPoint e(d, 0, 0, 1); ProcCurve g(b, e);",
            "nested-sweep",
        ),
    ] {
        let document = open(&format!("{TRAMMEL} {text}"));
        let found = crate::common::ids(&document);
        let lines: Vec<String> =
            document.diagnostics().iter().map(|d| line(&document, d)).collect();
        assert_eq!(found, [id], "{text}: {lines:?}");
    }
}
