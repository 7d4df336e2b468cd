//! What viewers are sent.

use crate::viewer::{Drawn, Viewer, ask, edited, example, opened, session};
use moldloft_testing::{Random, rounds};
use serde_json::json;
use std::collections::BTreeMap;

const EXAMPLES: [&str; 5] = [
    "sailboat/hull.sdl",
    "sailboat/yacht.sdl",
    "wing/wing.sdl",
    "propeller/propeller.sdl",
    "implicit/tee.sdl",
];

/// The same items on a session that begins with the text, but for what a failure has left behind.
fn agrees_with_a_fresh_start(text: &str, follower: &Viewer) {
    let mut fresh = session(text);
    let late = opened(&mut fresh, 1);
    same(&follower.fresh(), &late.fresh());
    assert_eq!(follower.facts.get("params"), late.facts.get("params"));
    assert_eq!(follower.facts.get("objects"), late.facts.get("objects"));
}

/// Names the first item that differs.
fn same(a: &BTreeMap<&String, &Drawn>, b: &BTreeMap<&String, &Drawn>) {
    assert!(a.keys().eq(b.keys()), "{:?}\n{:?}", a.keys(), b.keys());
    for (name, drawn) in a {
        assert!(*drawn == b[name], "{name} differs");
    }
}

#[test]
fn one_that_follows_has_what_one_that_comes_late_is_sent() {
    let mut random = Random::new(17);
    for name in EXAMPLES {
        let text = example(name);
        let mut s = session(&text);
        let mut follower = opened(&mut s, 1);
        for k in 0..rounds(6, 200) {
            let params = follower.facts["params"].as_array().unwrap().clone();
            let ranged: Vec<_> = params.iter().filter(|p| !p["range"].is_null()).collect();
            if ranged.is_empty() {
                break;
            }
            let p = random.pick(&ranged);
            let range = |k: usize| p["range"][k].as_f64().unwrap();
            let mut x = random.between(range(0), range(1));
            if p["whole"] == true {
                x = x.round();
            }
            let name = p["name"].as_str().unwrap();
            follower.take(&ask(&mut s, json!({"kind": "set", "tab": 1, "values": {name: x}})));
            let late = opened(&mut s, 2);
            same(&follower.fresh(), &late.fresh());
            assert!(follower == late, "{name} = {x}, round {k}");
        }
        let commit = ask(&mut s, json!({"kind": "commit", "tab": 1}));
        let new = edited(&text, &commit);
        follower.take(&commit);
        follower.take(&ask(&mut s, json!({"kind": "text", "tab": 1, "text": new})));
        agrees_with_a_fresh_start(&new, &follower);
    }
}

#[test]
fn random_edits_lose_neither_the_text_nor_the_last_good_scene() {
    let mut random = Random::new(3);
    let base = example("sailboat/hull.sdl");
    let mut s = session(&base);
    let mut follower = opened(&mut s, 1);
    let good = follower.items.len();
    let mut text = base.clone();
    for _ in 0..rounds(25, 1000) {
        // Broken texts included: a few characters are taken out or put in anywhere.
        let at = random.below(text.len());
        let broken = match random.below(3) {
            0 => format!("{}{}", &text[..at], &text[(at + 3).min(text.len())..]),
            1 => format!(
                "{}{}{}",
                &text[..at],
                random.pick(&["{", ";", "7", "é𝄞", "\n", "hull"]),
                &text[at..]
            ),
            _ => base.clone(),
        };
        text = if broken.is_char_boundary(at.min(broken.len())) { broken } else { base.clone() };
        let before = follower.items.len();
        let reply = ask(&mut s, json!({"kind": "text", "tab": 1, "text": text}));
        assert!(reply.head.get("internal").is_none(), "{text}");
        follower.take(&reply);
        assert_eq!(s.text(), text);
        let errors = follower.facts["diagnostics"].as_array().unwrap();
        if errors.iter().any(|d| d["severity"] == "error") {
            // Nothing leaves the picture while something is wrong.
            assert!(follower.items.len() >= before, "{text}");
        }
        agrees_with_a_fresh_start(&text, &follower);
    }
    follower.take(&ask(&mut s, json!({"kind": "text", "tab": 1, "text": base})));
    assert_eq!(follower.fresh().len(), good);
    agrees_with_a_fresh_start(&base, &follower);
}

#[test]
fn what_fails_stays_as_it_was_and_says_why() {
    let good = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); Line l(A, B);";
    let mut s = session(good);
    let mut v = opened(&mut s, 1);
    let was = v.items.clone();
    // The point goes onto the other: no arc; and then the text breaks off.
    for text in ["AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); Line l(A, C);", "AbsPoint A(0, 0,"] {
        v.take(&ask(&mut s, json!({"kind": "text", "tab": 1, "text": text})));
        let line = v.items.iter().find(|(k, _)| k.contains("\"l\"")).unwrap();
        assert!(!line.1.stale.is_empty());
        assert_eq!(line.1.parts, was[line.0].parts);
    }
    v.take(&ask(&mut s, json!({"kind": "text", "tab": 1, "text": good})));
    assert_eq!(v.items, was);
    // Without errors what is gone is gone.
    v.take(&ask(&mut s, json!({"kind": "text", "tab": 1, "text": "AbsPoint A(0, 0, 0);"})));
    assert_eq!(v.items.len(), 1);
}

#[test]
fn surfaces_of_too_many_panels_stay_as_they_were_and_say_why() {
    let text = |n: u32| {
        format!(
            "Line l({{0, 0, 0}}, {{1, 0, 0}}); Line m({{0, 1, 0}}, {{1, 1, 0.5}}); \
             RuledSurf s(l, m, divisions = {{{n}, {n}}});"
        )
    };
    let put = |s: &mut _, n: u32| ask(s, json!({"kind": "text", "tab": 1, "text": text(n)}));
    let mut s = session(&text(4));
    let mut page = opened(&mut s, 1);
    let before = page.clone();
    let reply = put(&mut s, 30_000);
    assert_eq!(reply.head["diagnostics"][0]["id"], "too-many-panels");
    page.take(&reply);
    let stale: Vec<_> = page.items.iter().filter(|(_, d)| !d.stale.is_empty()).collect();
    let [(key, drawn)] = stale[..] else { panic!("{stale:?}") };
    assert_eq!(
        (&*drawn.stale, &*drawn.kind),
        ("900000000 panels are too many, 900000000 of them of `s`", "patch")
    );
    assert_eq!(drawn.parts, before.items[key].parts);
    page.take(&put(&mut s, 4));
    assert_eq!(page.items, before.items);
    assert_eq!(page.facts["diagnostics"], json!([]));
}

#[test]
fn only_what_changed_is_sent() {
    let mut s = session(&example("sailboat/yacht.sdl"));
    let v = opened(&mut s, 1);
    let sync = ask(&mut s, json!({"kind": "sync", "tab": 1}));
    for key in ["items", "params", "objects", "diagnostics"] {
        assert!(sync.head.get(key).is_none(), "{key}");
    }
    let params = v.facts["params"].as_array().unwrap();
    let name = params[0]["name"].as_str().unwrap();
    let x = 0.5 * (params[0]["value"].as_f64().unwrap() + params[0]["range"][1].as_f64().unwrap());
    let set = ask(&mut s, json!({"kind": "set", "tab": 1, "values": {name: x}}));
    let items = set.head["items"].as_array().unwrap();
    assert!(!items.is_empty() && items.len() < v.items.len());
    // Triangles stay where they are.
    assert!(items.iter().all(|i| i["parts"].as_array().unwrap().len() <= 2));
    assert!(set.head.get("objects").is_none());
}

#[test]
fn far_from_the_origin_positions_keep_their_digits() {
    let text = "AbsPoint A(4500000.125, 5200000.5, 10); AbsPoint B(4500001.375, 5200000.5, 10);\n\
                Line l(A, B);";
    let mut s = session(text);
    let v = opened(&mut s, 1);
    let (_, line) = v.items.iter().find(|(k, _)| k.contains("\"l\"")).unwrap();
    let x = |k: usize| line.origin[0] + f64::from(f32::from_bits(line.parts["position"][3 * k]));
    let last = line.parts["position"].len() / 3 - 1;
    assert!((x(0) - 4_500_000.125).abs() < 1e-6 && (x(last) - 4_500_001.375).abs() < 1e-6);
}

#[test]
fn fields_fit_the_vertices_of_patches() {
    let mut s = session(&example("sailboat/yacht.sdl"));
    let v = opened(&mut s, 1);
    let param = v.facts["params"][0]["name"].clone();
    for field in moldloft_session::FIELDS {
        let reply = ask(&mut s, json!({"kind": "field", "field": field, "by": param}));
        let parts = reply.head["field"].as_array().unwrap_or_else(|| panic!("{}", reply.head));
        assert!(!parts.is_empty(), "{field}");
        for part in parts {
            let vertices = v.items[&part["key"].to_string()].parts["position"].len() / 3;
            let values = reply.floats(part);
            assert_eq!(values.len(), vertices * part["components"].as_u64().unwrap() as usize);
            if field == "aspect" {
                assert!(values.iter().all(|x| x.is_nan() || *x >= 1.0));
            }
        }
    }
    let wrong = ask(&mut s, json!({"kind": "field", "field": "colour"}));
    assert!(wrong.head["error"].as_str().unwrap().contains("colour"));
}

#[test]
fn names_come_back_as_they_are() {
    // Model files allow almost anything in a name.
    let text = "AbsPoint P(1, 2, 3); print(\"<img src=x onerror=alert(1)>\");";
    let mut s = session(text);
    let reply = ask(&mut s, json!({"kind": "open", "tab": 1}));
    assert!(reply.head["printed"][0].as_str().unwrap().contains("<img"));
}

#[test]
fn an_inspector_knows_what_texts_may_be_and_what_may_not_be_written_here() {
    let text = "# é
AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 1); AbsPoint C(0, 2, 0); AbsPoint D(1, 2, 2);
Line l(A, B); Line m(C, D);
CLoftSurf s({l, m}, ends = \"natural\"); for (k = 1:2) { AbsPoint rib(k, 0, 0); }";
    let mut s = session(text);
    let mut field = |object: &str, name: &str| {
        let found = ask(&mut s, json!({"kind": "inspect", "name": object})).head["object"].clone();
        let fields = found["fields"].as_array().unwrap_or_else(|| panic!("{object}: {found}"));
        fields.iter().find(|f| f["name"] == name).unwrap().clone()
    };
    let ends = field("s", "ends");
    assert_eq!(ends["written"]["text"], "\"natural\"");
    assert!(ends["words"].as_array().unwrap().contains(&json!("periodic")));
    assert_eq!(field("s", "curves")["written"]["text"], "{l, m}");
    // Places count UTF-16 units, not bytes.
    let place = field("s", "curves")["written"]["place"].clone();
    let at = text[..text.find("{l, m}").unwrap()].encode_utf16().count();
    assert_eq!(place, json!([at, at + 6]));
    assert!(field("s", "degree")["written"]["text"].is_null());
    let ribs = ask(&mut s, json!({"kind": "open"})).head["objects"].clone();
    let rib = ribs.as_array().unwrap().last().unwrap()["name"].as_str().unwrap().to_string();
    // Both ribs have one statement.
    let rib = ask(&mut s, json!({"kind": "inspect", "name": rib})).head["object"].clone();
    assert_eq!(rib["fields"][0]["written"], json!(null));
}

#[test]
fn an_inspector_sees_fields_parents_children_values_and_derivatives() {
    let text =
        "param float w = 2 in [1, 3]; AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); Line l(A, B);";
    let mut s = session(text);
    let about = |s: &mut _, name: &str| {
        ask(s, json!({"kind": "inspect", "name": name, "by": "w"})).head["object"].clone()
    };
    let l = about(&mut s, "l");
    assert_eq!((&l["parents"], &l["class"]), (&json!(["A", "B"]), &json!("curve")));
    assert_eq!(l["values"][0]["value"], 2.0);
    assert_eq!(l["values"][0]["derivative"], 1.0);
    let a = about(&mut s, "A");
    assert_eq!(a["children"], json!(["l"]));
    assert_eq!(a["fields"][0]["numbers"][0]["path"], "A.x");
    let b = about(&mut s, "B");
    // x is an expression: not a number that can be typed over.
    assert_eq!(b["fields"][0]["numbers"], json!([]));
    let at = text.find("l(").unwrap();
    assert_eq!(about(&mut s, "l")["declared"], json!([at, at + 1]));
    // Every argument by its spelling, and those that are not given by where they can be.
    assert_eq!(b["fields"][0]["written"]["text"], "w");
    let p = text.find("w, 0, 0").unwrap();
    assert_eq!(b["fields"][0]["written"]["place"], json!([p, p + 1]));
    let relabel = l["fields"].as_array().unwrap().iter().find(|f| f["name"] == "relabel").unwrap();
    let end = text.find("B);").unwrap() + 1;
    assert_eq!(relabel["written"], json!({"place": [end, end], "text": null}));
    let missing = ask(&mut s, json!({"kind": "inspect", "name": "Z"}));
    assert!(missing.head["error"].as_str().unwrap().contains("`Z`"));
}

#[test]
fn arrays_of_a_program_are_lines_and_its_blocks_have_planes() {
    let text = "record holder { surface skin[3, 4]; curve keel[5]; }
        surface s[3, 4];
        for (i = 1:3) { for (j = 1:4) s[i, j] = {i, j, 0}; }
        curve c[3] = s[, 2];
        block b = {s, s + {0, 0, 1}, s + {0, 0, 3}};
        surface parts[2]; parts[1] = s; parts[2] = s + {0, 0, 5};
        block stack[1]; stack[1] = b[, , 1:2];
        holder h; h.skin = s;
        float plain[4];";
    let mut s = session(text);
    let viewer = opened(&mut s, 1);
    let vertices = |name: &str| {
        let (_, drawn) =
            viewer.items.iter().find(|(key, _)| key.contains(&format!("\"{name}\"")))?;
        assert_eq!(drawn.kind, "grid");
        Some(drawn.parts["position"].len() / 3)
    };
    // Lines along both indices; a block's are those on its faces.
    let surface = Some(3 * 4 + 4 * 3);
    assert_eq!(
        (vertices("s"), vertices("parts[1]"), vertices("parts[2]")),
        (surface, surface, surface)
    );
    assert_eq!((vertices("h.skin"), vertices("c")), (surface, Some(3)));
    assert!(vertices("b") > surface && vertices("stack[1]") > surface);
    // Points that were never set have no extent.
    assert_eq!((vertices("h.keel"), vertices("plain"), viewer.items.len()), (None, None, 7));
    let found = ask(&mut s, json!({"kind": "blocks", "block": "b", "axis": 2, "index": 1}));
    let blocks = found.head["blocks"].as_array().unwrap();
    let rows: Vec<_> = blocks.iter().map(|b| (&b["name"], &b["cells"], &b["volume"])).collect();
    assert_eq!(rows[0], (&json!("b"), &json!(12), &json!(18.0)));
    assert_eq!(rows[1], (&json!("stack[1]"), &json!(6), &json!(6.0)));
    assert_eq!(rows.len(), 2);
    assert!(found.head.get("plane").is_some());
}
