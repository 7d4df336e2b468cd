//! Relabels: the published curve is C(t) = c(R(t)), and everything that asks it follows.

use crate::common::{ids, number, open, sound, vector};
use moldloft_document::{Document, ModelFormat, NoFiles, registry};
use moldloft_num::Vec3;
use std::f64::consts::PI;

const WING: &str = "
AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 1); AbsPoint D(0, 0, 5); AbsPoint E(5, 1, 5);
AbsPoint F(0, -3, 0); AbsPoint G(4, -3, 1);
CosRelabel cosine(); TanhRelabel dense(2.5, \"start\");
BCurve c({A, B, C}); BCurve r({A, B, C}, relabel = cosine); Line l(D, E); Line k(F, G);
Line s(D, E, relabel = cosine);
";

fn cosine(t: f64) -> f64 {
    0.5 - 0.5 * (PI * t).cos()
}

#[test]
fn beads_snakes_and_parts_follow() {
    let mut document = sound(&format!(
        "{WING} AbsBead b(r, 0.3); AbsBead d(r, 0.8); SubCurve p(b, d); MirrCurve m(r, \"y=0\");
         RuledSurf S(r, l, relabel = dense); AbsMagnet q(S, 0.3, 0.6); AbsMagnet w(S, 0.9, 0.1);
         LineSnake z(q, w, relabel = cosine); AbsRing g(z, 0.2);"
    ));
    for (a, b) in [("b", cosine(0.3)), ("p(0.5)", cosine(0.55))] {
        let b = vector(&mut document, &format!("c({b})"));
        assert!(vector(&mut document, a).distance(b) < 1e-14, "{a}");
    }
    let image = vector(&mut document, "m(0.3)");
    let original = vector(&mut document, &format!("c({})", cosine(0.3)));
    assert_eq!(image, Vec3::of(original.x, -original.y, original.z));
    let (along, across) = (cosine(0.3), number(&mut document, "dense(0.6)"));
    let tanh = 1.0 + (2.5_f64 * (0.6 - 1.0)).tanh() / 2.5_f64.tanh();
    assert!((across - tanh).abs() < 1e-15);
    let ruled = vector(&mut document, &format!("c({along}) + {across}*(l(0.3) - c({along}))"));
    assert!(vector(&mut document, "q").distance(ruled) < 1e-14);
    let path = cosine(0.2);
    let place = vector(&mut document, &format!("S(0.3 + 0.6*{path}, 0.6 - 0.5*{path})"));
    assert!(vector(&mut document, "g").distance(place) < 1e-14);
    assert!((number(&mut document, "r.length") - number(&mut document, "c.length")).abs() < 1e-11);
}

/// Section 5, E2 of the fact sheet: the mesh is the law's, the shape is the same.
#[test]
fn meshes_follow_the_laws() {
    for (law, at) in [
        ("CosRelabel law();", (|t| cosine(t)) as fn(f64) -> f64),
        ("CosRelabel law(\"start\");", |t| 1.0 - (PI * t / 2.0).cos()),
        ("CosRelabel law(\"end\", 0.5);", |t| 0.5 * t + 0.5 * (PI * t / 2.0).sin()),
        ("GeoRelabel law(4);", |t| (4.0_f64.powf(t) - 1.0) / 3.0),
        ("TanhRelabel law(3);", |t| 0.5 + 0.5 * (3.0 * (t - 0.5)).tanh() / 1.5_f64.tanh()),
        ("Relabel law({0, 0.2, 1}, degree = 2);", |t| 0.4 * t * (1.0 - t) + t * t),
        ("Relabel law({0, 0.2, 1}, degree = 1);", |t| (0.4 * t).max(1.6 * t - 0.6)),
    ] {
        let mut document = sound(&format!(
            "{WING} {law} BCurve a({{A, B, C}}, relabel = law, visible = 0);
             RuledSurf S(a, l, relabel = law, divisions = {{8, 6}});"
        ));
        let panels = document.panelled().unwrap();
        let points = panels.mesh.positions().to_vec();
        for i in 0..=8 {
            let t = f64::from(i) / 8.0;
            let (r, first) = (at(t), points[7 * i as usize]);
            assert!(first.distance(vector(&mut document, &format!("c({r})"))) < 1e-14, "{law} {t}");
            let last = points[7 * i as usize + 6];
            for j in 1..6 {
                let share = at(f64::from(j) / 6.0);
                let p = points[7 * i as usize + j as usize];
                let away = p.distance(first + (last - first) * share);
                assert!(away < 4e-15, "{law} {i} {j}: {away:e}");
            }
        }
    }
}

fn open_edges(document: &mut Document) -> usize {
    document.panelled().unwrap().mesh.report().open_loops.iter().map(|l| l.edge_count()).sum()
}

#[test]
fn neighbours_along_a_relabelled_curve_share_its_vertices() {
    // Two ruled surfaces on one relabelled curve: 8 divisions of it are inner edges.
    let pair = |first: &str, second: &str, reported: usize| {
        let text = format!(
            "{WING} AbsBead b(r, 0.25); AbsBead d(r, 0.75); SubCurve whole(b, d);
             Relabel bent({{0, 0.3, 1}}, degree = 1); SubCurve part(b, d, relabel = bent);
             RuledSurf S({first}, l, divisions = {{8, 3}}, relabel = dense);
             RuledSurf T({second}, k, divisions = {{8, 3}});"
        );
        let mut document = sound(&text);
        let panels = document.panelled().unwrap();
        let remarks = panels.panelling.remarks();
        assert_eq!(remarks.len(), reported, "{remarks:?}");
        open_edges(&mut document)
    };
    let all = 2 * 2 * (8 + 3);
    assert_eq!(pair("r", "r", 0), all - 16);
    assert_eq!(pair("part", "part", 0), all - 16);
    // The same shape with other divisions is not a neighbour.
    assert_eq!(pair("r", "c", 0), all);
    // A part with as many divisions as the whole contradicts it, and is reported.
    assert_eq!(pair("whole", "r", 1), all);
}

#[test]
fn straight_laws_keep_parts_parts() {
    // A chain in halves, redistributed so that its break falls on other divisions, stays joined to
    // what runs along its halves: the relabelled snake below is the edge from 0 to 1 in two parts.
    let mut document = sound(
        "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(4, 2, 0);
         AbsPoint E(0, -1, 0); AbsPoint F(4, -1, 0); Line l(A, B); Line m(C, D); Line n(E, F);
         AbsBead b(l, 0); AbsBead d(l, 1); AbsBead e(l, 0.25);
         Relabel bent({0, 0.25, 1}, degree = 1); SubCurve whole(b, d, relabel = bent);
         SubCurve left(b, e); SubCurve right(e, d); Line o(E, F);
         RuledSurf S(whole, m, divisions = {8, 3});",
    );
    let curve = document.graph().find("whole").and_then(|k| document.graph().get(k)).unwrap();
    let Some(moldloft_registry::Value::Curve(curve)) = curve.value() else { panic!() };
    let pieces = curve.pieces();
    assert_eq!(pieces.len(), 2);
    assert!((pieces[0].until - 0.5).abs() < 1e-15 && pieces[1].until == 1.0);
    assert!((pieces[0].to.t - 0.25).abs() < 1e-15 && pieces[1].to.t == 1.0);
    let middle = vector(&mut document, "whole(0.5)");
    assert!(middle.distance(Vec3::of(1.0, 0.0, 0.0)) < 1e-14);
}

#[test]
fn laws_are_copied_undone_and_composed() {
    let mut document = sound(&format!(
        "{WING} MirrCurve m(r, \"y=0\"); CopyRelabel copy(m); CopyRelabel none(c);
         CosRelabel soft(\"both\", 0.8); InvRelabel back(soft); ComposeRelabel nothing({{soft, back}});
         GeoRelabel growth(3); ComposeRelabel two({{growth, soft}});
         ArcLenRelabel even(c); BCurve e({{A, B, C}}, relabel = even);
         AbsBead h(e, 0.5); AbsBead z(e, 0); SubCurve half(z, h);"
    ));
    for k in 0..=10 {
        let t = f64::from(k) / 10.0;
        let mut at = |law: &str, t: f64| number(&mut document, &format!("{law}({t})"));
        assert_eq!(at("copy", t), at("cosine", t));
        assert_eq!(at("none", t), t);
        assert!((at("nothing", t) - t).abs() < 1e-14);
        let first = at("growth", t);
        assert_eq!(at("two", t), at("soft", first));
    }
    let (half, all) = (number(&mut document, "half.length"), number(&mut document, "c.length"));
    assert!((half / all - 0.5).abs() < 1e-12, "{half} {all}");
}

#[test]
fn laws_that_are_none_are_refused() {
    for (statement, id, says) in [
        ("Relabel x({0, 0.5, 0.4, 1});", "not-monotone", "value 3 is 0.4"),
        ("Relabel x({0, 0.5, 0.9});", "wrong-ends", "found 0 to 0.9"),
        ("Relabel x({0.1, 0.5, 1});", "wrong-ends", "found 0.1 to 1"),
        ("Relabel x({0, 0.5, 0.5, 1}, degree = 1);", "zero-slope", "t = 0.5"),
        ("Relabel x({0});", "too-few-items", "at least 2"),
        ("CosRelabel x(\"middle\");", "unknown-end", "\"middle\""),
        ("CosRelabel x(\"both\", 1.5);", "out-of-range", "weight"),
        ("GeoRelabel x(0);", "out-of-range", "`ratio`"),
        ("GeoRelabel x(-1);", "out-of-range", "`ratio`"),
        ("TanhRelabel x(101);", "out-of-range", "strength"),
        ("TableRelabel x({0, 0.5, 1}, {0, 1});", "wrong-length", "3 parameters"),
        ("TableRelabel x({0, 0.5, 0.5, 1}, {0, 0.1, 0.2, 1});", "not-monotone", "number 3"),
        ("TableRelabel x({0, 0.5, 1}, {0, 0, 1});", "zero-slope", "t = 0.5"),
        ("TableRelabel x({0, 0.5, 1}, {0, 2, 1});", "not-monotone", "value 3"),
        ("InvRelabel x(cosine);", "zero-slope", "undone"),
        ("ArcLenRelabel x(r);", "zero-slope", "zero tangent"),
        ("Line x(A, B, relabel = c);", "wrong-class", "expected a relabel"),
        ("Line x(A, B, relabel = 0.5);", "wrong-class", "expected a relabel"),
        ("AbsPoint x(0, 0, 0, relabel = cosine);", "unknown-argument", "relabel"),
        ("BSurf x({A, B, C, D}, nu = 2, nv = 2, relabel = cosine);", "unknown-argument", "relabel"),
    ] {
        let document = open(&format!("{WING} {statement}"));
        assert_eq!(ids(&document), [id], "{statement}: {:?}", crate::common::reported(&document));
        assert!(
            crate::common::reported(&document)[0].contains(says),
            "{:?}",
            crate::common::reported(&document)
        );
    }
    // What a failed law blocks says so; repaired, it comes back.
    let mut document =
        open(&format!("{WING} Relabel x({{0, 0.5, 0.4, 1}}); Line y(A, B, relabel = x);"));
    assert_eq!(ids(&document).len(), 1);
    document.set(&[("x.values[3]".into(), 0.6)]).unwrap();
    assert!(ids(&document).is_empty());
    assert!((number(&mut document, "y(0.5).x") - 0.5375).abs() < 1e-15);
}

const MODEL_FILE: &str = "\
MultiSurf 1.44
BeginModel;
AbsPoint A 14 1 / 0 0 0;
AbsPoint B 14 1 / 1 2 0;
AbsPoint C 14 1 / 4 2 1;
AbsPoint D 14 1 / 0 0 5;
BCurve c 11 1 8x4 / bend 2 { A B C };
Relabel bend 12 1 / 2 { 0 0.25 1 };
CosRelabel cosine 12 1 / both 0.5;
Line l 11 1 8x4 / cosine A D;
Line k 11 1 8x4 / * A D;
RuledSurf S 10 1 8x1 8x1 0 / cosine c l;
CLoftSurf T 10 1 8x1 8x1 0 / cosine 3 { c l };
CLoftSurf U 10 1 8x1 8x1 0 / 3 { c l };
EndModel;
";

fn open_file(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "model.ms2", text)
}

#[test]
fn model_files_have_the_column() {
    let mut document = open_file(MODEL_FILE);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    let at = |text: &str, document: &mut Document| vector(document, text);
    let half = 0.5 * 0.25 + 0.25;
    assert!(at("l(0.5)", &mut document).distance(Vec3::of(0.0, 0.0, 2.5)) < 1e-15);
    assert!((number(&mut document, "bend(0.5)") - half).abs() < 1e-16);
    let program = document.convert(ModelFormat::Sdl).unwrap();
    assert!(program.contains("relabel = cosine"), "{program}");
    let mut converted = crate::common::sound(&program);
    for text in ["c(0.3)", "S(0.3, 0.2)", "T(0.3, 0.2)", "U(0.3, 0.2)", "k(0.2)"] {
        assert_eq!(at(text, &mut document), at(text, &mut converted), "{text}");
    }
    assert_ne!(at("T(0.3, 0.2)", &mut document), at("U(0.3, 0.2)", &mut document));
    let back = converted.convert(ModelFormat::ModelFile).unwrap();
    assert_eq!(back, open_file(&back).convert(ModelFormat::ModelFile).unwrap());
    assert!(back.contains("CLoftSurf T 10 1 8x1 8x1 0 / cosine 3 { c l };"), "{back}");
    // The law is a number of the model like any other.
    document.set(&[("bend.values[2]".into(), 0.5)]).unwrap();
    assert!(document.text().contains("{ 0 0.5 1 }"), "{}", document.text());
    assert!((number(&mut document, "bend(0.5)") - 0.5).abs() < 1e-16);
    // Something else than a relabel in its column.
    let wrong = open_file(&MODEL_FILE.replace("/ cosine c l", "/ A c l"));
    let found = wrong.diagnostics();
    assert!(found[0].id == "wrong-class" && found[0].message.contains("relabel"), "{found:?}");
}
