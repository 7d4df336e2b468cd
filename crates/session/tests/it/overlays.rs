//! What is laid over a model, and curves of its section areas, against closed forms.

use crate::viewer::{ask, session};
use moldloft_testing::{Random, rounds};
use serde_json::json;

/// A square of side 2 in z = 0, normal up.
const PLATE: &str =
    "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0);
Line l(A, B); Line m(C, D); RuledSurf s(l, m);";

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let word =
            three.iter().fold(0u32, |w, &b| w << 8 | u32::from(b)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k)) as usize & 63] as char;
            text.push(if k <= three.len() { digit } else { '=' });
        }
    }
    text
}

#[test]
fn distances_from_a_plate_are_those_of_a_box() {
    let mut random = Random::new(5);
    let mut s = session(PLATE);
    for round in 0..rounds(20, 1000) {
        let points: Vec<[f64; 3]> = (0..1 + round % 40)
            .map(|_| {
                [random.between(-1.0, 3.0), random.between(-1.0, 3.0), random.between(-1.0, 1.0)]
            })
            .collect();
        let rows: Vec<String> =
            points.iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}")).collect();
        let data = base64(rows.join("\n").as_bytes());
        let reply = ask(&mut s, json!({"kind": "overlay", "name": "p.xyz", "data": data}));
        let part = &reply.head["overlays"][0];
        let found = reply.floats(&part["deviation"]);
        assert_eq!(found.len(), points.len());
        let mut largest = 0.0_f64;
        for (d, [x, y, z]) in found.iter().zip(points) {
            let out = |t: f64| (-t).max(t - 2.0).max(0.0);
            let expected = (out(x).powi(2) + out(y).powi(2) + z * z).sqrt();
            assert!((f64::from(d.abs()) - expected).abs() < 1e-6, "{d} {expected}");
            // On one side of the plate all have one sign.
            assert!(z.abs() < 1e-3 || (*d > 0.0) == (z > 0.0), "{d} at {x} {y} {z}");
            largest = largest.max(expected);
        }
        assert!((part["largest"].as_f64().unwrap() - largest).abs() < 1e-9);
    }
}

#[test]
fn a_mirrored_model_is_compared_with_both_sides() {
    let mut s = session(&format!("Model info(symmetry = \"y\");\n{PLATE}"));
    let data = base64(b"1 1 0.5\n1 -1 0.25\n");
    let reply = ask(&mut s, json!({"kind": "overlay", "name": "p.csv", "data": data}));
    let found = reply.floats(&reply.head["overlays"][0]["deviation"]);
    assert!((found[0] - 0.5).abs() < 1e-6 && (found[1] - 0.25).abs() < 1e-6, "{found:?}");
}

#[test]
fn overlays_follow_the_model_and_go() {
    let text = PLATE.replace("(0, 0, 0)", "(0, 0, h)").replace(", 0);", ", h);");
    let mut s = session(&format!("param float h = 0 in [-1, 1];\n{text}"));
    let cube = b"v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 3 4\n";
    let reply = ask(&mut s, json!({"kind": "overlay", "name": "m.obj", "data": base64(cube)}));
    let part = &reply.head["overlays"][0];
    assert_eq!(reply.numbers(&part["triangle"]).len(), 6);
    assert_eq!(reply.numbers(&part["edge"]).len(), 8);
    assert!((part["rms"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    ask(&mut s, json!({"kind": "set", "values": {"h": 0.25}}));
    let reply = ask(&mut s, json!({"kind": "deviation"}));
    let part = &reply.head["overlays"][0];
    assert!(part["position"].is_null(), "shapes are sent once");
    assert!((part["rms"].as_f64().unwrap() - 0.75).abs() < 1e-9);
    let reply = ask(&mut s, json!({"kind": "remove_overlay"}));
    assert_eq!(reply.head["overlays"].as_array().unwrap().len(), 0);
}

#[test]
fn what_cannot_be_laid_over_is_refused() {
    let mut s = session("AbsPoint A(0, 0, 0);");
    for (name, data, expected) in [
        ("x.obj", base64(b"f 1 2 3\n"), "x.obj"),
        ("x.csv", base64(b"words\n"), "x.csv"),
        ("x.csv", "§".into(), "damaged"),
    ] {
        let reply = ask(&mut s, json!({"kind": "overlay", "name": name, "data": data}));
        let error = reply.head["error"].as_str().unwrap_or_default();
        assert!(error.contains(expected), "{name}: {error}");
    }
    // Without surfaces there is nothing to compare with.
    let data = base64(b"1 2 3\n");
    let reply = ask(&mut s, json!({"kind": "overlay", "name": "p.csv", "data": data}));
    assert!(reply.head["overlays"][0]["deviation"].is_null());
}

#[test]
fn section_areas_of_a_wedge_grow_evenly() {
    // Half of a wedge of length 4, half-breadth x / 4, depth 1; the section at x is 2 (x / 4) 1.
    let text = "Model info(symmetry = \"y\");
AbsPoint a(0, 0, -1); AbsPoint b(0, 0, 1); AbsPoint c(4, 1, -1); AbsPoint d(4, 1, 1); AbsPoint e(4, 0, -1); AbsPoint f(4, 0, 1);
Line ab(a, b); Line cd(c, d); Line ef(e, f); Line ac(a, c); Line ae(a, e); Line bd(b, d); Line bf(b, f);
RuledSurf side(ab, cd); RuledSurf end(cd, ef); RuledSurf bottom(ac, ae); RuledSurf top(bd, bf);";
    let mut s = session(text);
    let reply = ask(&mut s, json!({"kind": "section_areas", "count": 9}));
    assert!(reply.head["error"].is_null(), "{}", reply.head["error"]);
    let x = reply.floats(&reply.head["areas"]["place"]);
    let y = reply.floats(&reply.head["areas"]["area"]);
    assert_eq!((x.len(), x[0], x[8]), (9, 0.0, 4.0));
    for (x, y) in x.iter().zip(y).take(8) {
        assert!((y - x / 2.0).abs() < 1e-5, "{y} at {x}");
    }
}
