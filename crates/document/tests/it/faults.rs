//! Refusals that need more than a program: files, floating, solids, models too large; and the bad
//! input of which designers are most often guilty, each with what was expected and how to fix it.

use crate::common::{WATER, ids, open, reported, sound};
use moldloft_document::{Document, FloatRequest, FlotationOptions, Immersion, registry};

#[test]
fn sketches_that_cannot_be_met_and_that_read_too_much() {
    let sketch = "SKETCH A 2D XY\nPOINT 1 0 0\nPOINT 2 9 3\nLINE 1 1 2 TYPE F\nDIM X 1 2 5\nDIM L LENGTH 1 6\n";
    let text = "Sketch a(\"a.skt\", L = 3);";
    let files = crate::common::Files(vec![("a.skt", sketch)]);
    let document = Document::from_text(registry(), Box::new(files), "m.sdl", text);
    let found = document.diagnostics();
    let unsolved = found.iter().find(|d| d.id == "sketch-unsolved");
    let unsolved = unsolved.unwrap_or_else(|| panic!("{:?}", reported(&document)));
    assert!(unsolved.message.contains("`a`") && !unsolved.help.is_empty(), "{unsolved:?}");
    assert_eq!(document.sources().slice(unsolved.span()), text);

    let mut many = vec![("f0.skt".to_string(), "SKETCH A\n".to_string())];
    for k in 1..=40 {
        many[0].1 += &format!("RUN \"f{k}.skt\"\n");
        many.push((format!("f{k}.skt"), format!("POINT {k} {k} 0\n")));
    }
    let files = many.into_iter().map(|(name, text)| (&*name.leak(), &*text.leak())).collect();
    let files = Box::new(crate::common::Files(files));
    let document = Document::from_text(registry(), files, "m.sdl", "load \"f0.skt\";");
    assert!(ids(&document).contains(&"too-many-files".to_string()), "{:?}", reported(&document));
}

/// A sloping side.
const SIDE: &str =
    "AbsPoint A(0, 0, -1); AbsPoint B(4, 0, -1); AbsPoint C(0, 1, 1); AbsPoint D(4, 1, 1);
                    Line l(A, B); Line m(C, D); RuledSurf S(l, m);";

#[test]
fn weights_that_are_asked_for_must_be_there() {
    let mut document = sound(SIDE);
    let immersion = Immersion::Mass { mass: 1.0, free_trim: false, free_heel: false };
    let options = FlotationOptions { of_weights: true, ..WATER };
    let request = FloatRequest { immersion, trim: 0.0, heel: 0.0 };
    let faults = document.floating(&[request], options, &[]).unwrap_err();
    assert_eq!(faults[0].id, "no-weights");
    assert!(faults[0].expectation().unwrap().contains("Weight"), "{faults:?}");
}

#[test]
fn a_symmetric_model_that_shows_both_halves_has_no_hydrostatics() {
    let text = format!("Model info(symmetry = \"y\");\n{SIDE} MirrSurf port(S, \"y=0\");");
    let mut document = open(&text);
    let faults = document.eval("hydrostatics.volume").unwrap_err();
    assert_eq!(faults[0].id, "mirrored-twice");
    assert!(faults[0].message.contains("y = 0"), "{faults:?}");
    let place = document.sources().slice(faults[0].span());
    assert!(["S", "port"].contains(&place), "{place}: {faults:?}");
}

/// A path with corners that no halving of the solid meets, and its volume by Cavalieri.
#[test]
fn a_weight_of_a_solid_with_kinks_inside() {
    let mut document = sound(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);
         Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint E(0, 0, 1); AbsPoint F(0.3, 0, 1.4);
         AbsPoint G(0, 0.5, 3.7); CCurve path({A, E, F, G}, degree = 1);
         TranSolid T(S, path); Weight w(T, per = 2);",
    );
    let mass = crate::common::number(&mut document, "w.mass");
    assert!((mass - 2.0 * 3.7).abs() < 1e-8, "{mass}");
    let height = crate::common::number(&mut document, "w.z");
    assert!((height - 0.5 * 3.7).abs() < 1e-8, "{height}");
    // What passes over a corner that moves is not known.
    let faults = document.derivatives(&["w.mass".into()], &["F.z".into()]).unwrap_err();
    assert!(faults.iter().any(|d| d.message.contains("`w`")), "{faults:?}");
}

#[test]
fn a_surface_with_places_beyond_all_numbers_has_no_area() {
    let mut document = open(
        "AbsPoint A(-1.7e308, 0, 0); AbsPoint B(1.7e308, 0, 0); AbsPoint C(0, 1.7e308, 0);
         AbsPoint D(0, -1.7e308, 1); Line a(A, B); Line b(C, D); RuledSurf S(a, b);",
    );
    assert!(document.diagnostics().iter().all(|d| d.id == "number-too-large"));
    assert_eq!(document.diagnostics().len(), 4);
    let faults = document.eval("S.area").unwrap_err();
    assert_eq!(faults[0].id, "blocked");
}

#[test]
fn a_plate_with_a_ruling_of_no_length_is_refused() {
    let mut document = open(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, -1.28, 0); AbsPoint C(100, 0.25, 0.25);
         Line apex(B, B); BCurve c({B, A, C}, degree = 2); RuledSurf cone(apex, c);
         ExpandedSurf flat(cone);",
    );
    assert!(ids(&document).contains(&"no-normal".to_string()), "{:?}", reported(&document));
    assert_eq!(document.eval("flat.area").unwrap_err()[0].id, "blocked");
}

#[test]
fn numbers_up_to_the_limit_are_computed_with() {
    let mut document = sound(
        "AbsPoint A(-1e50, 0, 0); AbsPoint B(1e50, 0, 0); AbsPoint C(0, 1e50, 0);
         AbsPoint D(0, 0, 1e50); Line a(A, B); Line b(C, D); RuledSurf S(a, b);",
    );
    let area = crate::common::number(&mut document, "S.area");
    assert!(area.is_finite() && area > 1e100, "{area:e}");
    let mut beyond = open("AbsPoint A(9e49, 0, 0); RelPoint B(A, 9e49, 0, 0);");
    assert_eq!(beyond.diagnostics()[0].id, "number-too-large");
    assert!(beyond.eval("B.x").is_err());
}

#[test]
fn the_weight_of_one_side_says_whether_the_other_counts() {
    let model = |images: &str| {
        format!(
            "Model info(symmetry = \"y\"); AbsPoint A(0, 0, 0); AbsPoint B(3, 0, 0); AbsPoint C(0, 2, 0);
             AbsPoint D(3, 2, 0); Line a(A, B); Line b(C, D); RuledSurf deck(a, b);
             Weight planks(deck, per = 0.5{images});"
        )
    };
    let document = open(&model(""));
    assert_eq!(document.diagnostics()[0].id, "half-weight");
    let mut both = sound(&model(", images = \"y\""));
    assert!((crate::common::number(&mut both, "planks.mass") - 6.0).abs() < 1e-12);
    assert_eq!(crate::common::number(&mut both, "planks.y"), 0.0);
    let mut once = sound(&model(", images = \"\""));
    assert!((crate::common::number(&mut once, "planks.mass") - 3.0).abs() < 1e-12);
}

#[test]
fn what_has_no_centre_cannot_float_freely() {
    let mut document = sound(SIDE);
    let immersion = Immersion::Mass { mass: 1.0, free_trim: true, free_heel: false };
    let options = WATER;
    let faults = document
        .floating(&[FloatRequest { immersion, trim: 0.0, heel: 0.0 }], options, &[])
        .unwrap_err();
    assert_eq!(faults[0].id, "cannot-float");
    assert!(faults[0].help[0].contains("centre of gravity"), "{faults:?}");
}

#[test]
fn a_solid_of_too_many_cells_has_a_volume_and_no_blocks() {
    let mut document = open(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0); AbsPoint E(0, 0, 1);
         Line l(A, B); Line m(C, D); RuledSurf S(l, m); Line up(A, E);
         TranSolid T(S, up, divisions = {1000, 1000, 1000});",
    );
    assert!((crate::common::number(&mut document, "T.volume") - 1.0).abs() < 1e-12);
    let fault = document.blocked().err().unwrap();
    assert_eq!(fault.id, "too-many-cells");
    assert!(fault.expectation().unwrap().contains("at most"), "{fault:?}");
}

/// The one diagnostic of a program, which says what was expected, what was found and what to do.
fn whole(text: &str, id: &str) {
    let document = open(text);
    let found = document.diagnostics();
    let own: Vec<_> = found.iter().filter(|d| d.id == id).collect();
    assert_eq!(own.len(), 1, "{id}: {:?}", reported(&document));
    let expectation = own[0].expectation().unwrap_or_default();
    assert!(
        expectation.contains("expected") && expectation.contains("found"),
        "{id}: {expectation}"
    );
    assert!(!own[0].help.is_empty(), "{id} says no help");
    assert!(!own[0].span().is_empty(), "{id} has no place");
}

/// The list of bad input of a designer's day, but for intersections, which have their own tests.
#[test]
fn bad_input_is_told_clearly() {
    let plane = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 4, 0); AbsPoint D(4, 4, 0); Line l(A, B);
        Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.2); AbsMagnet q(S, 0.8, 0.7);";
    for (text, id) in [
        // Magnets on different surfaces.
        ("RuledSurf T(m, l); AbsMagnet r(T, 0.5, 0.5); LineSnake s(p, r);", "wrong-surface"),
        // A gap in a chain of curves, and of surfaces.
        ("AbsPoint E(5, 0, 0); AbsPoint F(6, 0, 0); Line n(E, F); PolyCurve c({l, n});", "gap"),
        (
            "AbsPoint E(0, 9, 0); AbsPoint F(4, 9, 0); Line n(E, F); AbsPoint G(0, 5, 0); AbsPoint H(4, 5, 0);
             Line o(G, H); RuledSurf T(o, n); PolySurf U({S, T}, \"v\");",
            "gap",
        ),
        // Rulings that do not exist.
        ("AbsPoint E(0, 0, 2); AbsPoint F(0, 4, 2); Line n(E, F); DevSurf T(l, n);", "no-rulings"),
        // Offset beyond the radius of curvature.
        (
            "AbsPoint E(1, 0, 0); AbsPoint F(-1, 0, 0); AbsPoint G(0, 1, 0); Arc a(E, F, G, 5); AbsPoint H(0, 0, 3);
             AbsPoint I(0, 0, 0); Line up(I, H); TranSurf T(a, up); OffsetSurf U(T, 1.5); OffsetSurf V(T, -1.5);",
            "cusp",
        ),
        (
            "AbsPoint E(1, 0, 0); AbsPoint F(-1, 0, 0); AbsPoint G(0, 1, 0); Arc a(E, F, G, 5);
             OffsetCurve c(a, -1.5, \"z=0\"); OffsetCurve d(a, 1.5, \"z=0\");",
            "cusp",
        ),
        // An axis without length.
        ("Line n(A, A); RevSurf T(l, n);", "zero-length-axis"),
        // A fillet from a snake to itself.
        ("LineSnake s(p, q); FilletSurf T(s, s);", "coincident-points"),
        // A fillet of a ball larger than a hollow.
        (
            "AbsPoint E(0, 0, 3); AbsPoint F(1.5, 0, -3); AbsPoint G(3, 0, 3); AbsPoint H(0, 4, 3);
             AbsPoint I(1.5, 4, -3); AbsPoint J(3, 4, 3); BCurve a({E, F, G}, 2); BCurve b({H, I, J}, 2);
             RuledSurf T(a, b); AbsPoint K(-1, 3, -2); AbsPoint L(4, 3, -2); AbsPoint M(-1, 3, 5);
             AbsPoint N(4, 3, 5); Line c(K, L); Line d(M, N); RuledSurf U(c, d); RollFillet V(T, U, 0.6);",
            "fillet-turns-back",
        ),
    ] {
        whole(&format!("{plane}\n{text}"), id);
    }
}

/// What is refused with derivatives alone is known in their evaluation only: its reason goes along.
#[test]
fn a_derivative_that_is_refused_says_why() {
    let mut text = "param float b = 1 in [0.5, 2];\n".to_string();
    let rough = [0.0, 0.02, -0.01, 0.03, -0.02, 0.01, 0.03, -0.03, 0.02, 0.0];
    for (k, off) in rough.into_iter().enumerate() {
        text += &format!("AbsPoint P{k}({k}, b*{}, 0);\n", 0.1 * (k as f64).powi(2) + off);
    }
    let points: Vec<String> = (0..rough.len()).map(|k| format!("P{k}")).collect();
    let points = points.join(", ");
    text += &format!("FairCurve c({{{points}}}, 0.02, measure = \"jump-lengths\");\n");
    let mut document = open(&text);
    let faults = document.derivatives(&["c(0.3)".into()], &["b".into()]).unwrap_err();
    assert!(faults.iter().any(|d| d.id == "no-derivative"), "{faults:?}");
    let reason = faults.iter().find(|d| d.message.contains("are available for a sum of lengths"));
    let reason = reason.unwrap_or_else(|| panic!("{faults:?}"));
    assert!(reason.message.starts_with("`c`"), "{reason:?}");
    // The points that change are where it is refused.
    assert!(document.sources().slice(reason.span()).contains("P0, P1"), "{reason:?}");
}
