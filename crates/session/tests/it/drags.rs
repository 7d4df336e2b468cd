//! Where drags end, against closed forms.

use crate::viewer::{Viewer, ask, edited, example, examples, opened, session};
use moldloft_session::Reply;
use serde_json::{Value, json};

fn number(reply: &Reply, name: &str) -> f64 {
    reply.head["values"][name].as_f64().unwrap_or_else(|| panic!("{name}: {}", reply.head))
}

#[test]
fn a_point_goes_where_the_hand_is_and_the_text_says_it_briefly() {
    let text = "# ü𝛼\nAbsPoint P(1, 2, 3);\nAbsPoint Q(0, 0, 0);\nLine l(P, Q);\n";
    let mut s = session(text);
    let begin = ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
    assert_eq!(begin.head["own"], json!(["P.x", "P.y", "P.z"]));
    // Looking along -z, 50 picture points a unit, 10 to the right and 5 up.
    let drag = json!({"kind": "drag_to", "target": [1.2000000000000002, 2.1, 3.0],
        "basis": [[1, 0, 0], [0, 1, 0]], "grain": 0.02});
    let to = ask(&mut s, drag);
    assert_eq!((number(&to, "P.x"), number(&to, "P.y")), (1.2, 2.1));
    assert!(to.head["values"].get("P.z").is_none(), "the view does not show it");
    let end = ask(&mut s, json!({"kind": "drag_end", "commit": true}));
    let new = edited(text, &end);
    assert_eq!(new, text.replace("(1, 2, 3)", "(1.2, 2.1, 3)"));
    // The text that comes back changes nothing.
    let back = ask(&mut s, json!({"kind": "text", "text": new, "version": 7}));
    assert!(back.head.get("items").is_none() && back.head["version"] == 7);
}

#[test]
fn a_drag_of_nothing_leaves_the_text_as_it_is() {
    let text = "AbsPoint P(1.50, 2e0, 3);";
    let mut s = session(text);
    ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
    ask(
        &mut s,
        json!({"kind": "drag_to", "target": [1.501, 2, 3], "basis": [[1, 0, 0]], "grain": 0.02}),
    );
    let end = ask(&mut s, json!({"kind": "drag_end", "commit": true}));
    assert_eq!(end.head["edits"], json!([]), "{}", edited(text, &end));
    // One that is taken back neither.
    ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
    let drag = json!({"kind": "drag_to", "target": [9, 9, 9], "basis": [[1, 0, 0]]});
    assert!((number(&ask(&mut s, drag), "P.x") - 9.0).abs() < 1e-9);
    ask(&mut s, json!({"kind": "drag_end", "commit": false}));
    let value = ask(&mut s, json!({"kind": "evaluate", "expressions": ["P.x"]}));
    assert_eq!(value.head["values"][0]["value"], 1.5);
    assert_eq!(s.text(), text);
}

#[test]
fn a_bead_follows_along_its_curve() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); Line l(A, B); AbsBead b(l, 0.25);";
    let mut s = session(text);
    let begin = ask(&mut s, json!({"kind": "drag_begin", "object": "b"}));
    assert_eq!(begin.head["own"], json!(["b.t"]));
    let drag = json!({"kind": "drag_to", "target": [3, 5, 1], "basis": [[1, 0, 0], [0, 1, 0]], "grain": 0.01});
    let to = ask(&mut s, drag);
    assert!((number(&to, "b.t") - 0.75).abs() < 1e-9);
    assert!((to.head["left"].as_f64().unwrap() - 5.0).abs() < 1e-9);
}

#[test]
fn where_the_number_is_an_expression_a_parameter_is_solved_for() {
    let text = "param float w = 2 in [1, 9]; param float d = 1 in [0, 2];\n\
                AbsPoint P(w * w, d, 0);";
    let mut s = session(text);
    let begin = ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
    let own = &begin.head["own"];
    assert_eq!(*own, json!(["P.z"]));
    let handle = |name: &str| -> Value {
        let all = begin.head["handles"].as_array().unwrap();
        all.iter().find(|h| h["name"] == name).unwrap().clone()
    };
    assert_eq!(handle("w")["direction"], json!([4.0, 0.0, 0.0]));
    assert_eq!(handle("d")["range"], json!([0.0, 2.0]));
    let drag = json!({"kind": "drag_to", "target": [6.25, 1, 0], "names": ["w"],
        "basis": [[1, 0, 0], [0, 1, 0]], "grain": 1e-9});
    let mut to = ask(&mut s, drag.clone());
    for _ in 0..3 {
        to = ask(&mut s, drag.clone());
    }
    assert!((number(&to, "w") - 2.5).abs() < 1e-8, "{}", to.head["values"]);
    let end = ask(&mut s, json!({"kind": "drag_end", "commit": true}));
    assert_eq!(edited(text, &end), text.replace("w = 2", "w = 2.5"));
    // Out of its range it stays at its end.
    ask(&mut s, json!({"kind": "text", "text": text}));
    ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
    let drag =
        json!({"kind": "drag_to", "target": [4, 7, 0], "names": ["d"], "basis": [[0, 1, 0]]});
    let to = ask(&mut s, drag);
    assert_eq!(number(&to, "d"), 2.0);
    assert!((to.head["left"].as_f64().unwrap() - 5.0).abs() < 1e-9);
}

#[test]
fn the_wing_s_tip_by_its_sweep() {
    // Newton's steps on the sweep for x + 1.5 were computed by an independent program.
    let mut s = session(&example("wing/wing.sdl"));
    let start = ask(&mut s, json!({"kind": "evaluate", "expressions": ["tip.tail"]}));
    let name = if start.head["values"][0].get("error").is_some() { return } else { "tip.tail" };
    let p: [f64; 3] = serde_json::from_value(start.head["values"][0]["value"].clone()).unwrap();
    ask(&mut s, json!({"kind": "drag_begin", "object": name}));
    let drag = json!({"kind": "drag_to", "target": [p[0] + 1.5, p[1], p[2]], "names": ["sweep"],
        "basis": [[1, 0, 0]]});
    let mut to = ask(&mut s, drag.clone());
    for _ in 0..3 {
        to = ask(&mut s, drag.clone());
    }
    assert!((number(&to, "sweep") - 0.592_232_08).abs() < 1e-7);
}

#[test]
fn what_cannot_be_dragged_says_so() {
    let mut s = session("AbsPoint P(1, 2, 3); XPlane p(1);");
    for (request, part) in [
        (json!({"kind": "drag_begin", "object": "nothing"}), "nothing"),
        (json!({"kind": "drag_begin", "object": "p"}), "not a position"),
        (json!({"kind": "drag_to", "target": [0, 0, 0], "basis": []}), "nothing is dragged"),
        (json!({"kind": "nonsense"}), "unknown variant"),
        (json!({"kind": "set", "values": {"Q.x": 1}}), "Q.x"),
        (json!({"kind": "export", "format": "exe", "stem": "../../x"}), "exe"),
    ] {
        let reply = ask(&mut s, request.clone());
        let said = reply.head["error"].as_str().unwrap_or_default();
        assert!(said.contains(part), "{request}: {said}");
    }
}

#[test]
fn a_file_comes_with_remarks_about_it() {
    let file = json!({"kind": "export", "format": "ms2", "stem": "points"});
    let mut s = session("AbsPoint P(2, 0, 0); assert(P.x > 1);");
    let reply = ask(&mut s, file.clone());
    assert_eq!(reply.head["files"][0]["name"], "points.ms2");
    let [remark] = &reply.head["remarks"].as_array().unwrap()[..] else {
        panic!("{}", reply.head["remarks"])
    };
    assert_eq!(remark["message"], "a model file cannot hold an assertion");
    assert!(remark["help"][0].as_str().unwrap().contains("in the program"), "{remark}");
    assert_eq!(remark["severity"], "warning");
    let mut s = session("AbsPoint P(2, 0, 0);");
    assert_eq!(ask(&mut s, file).head["remarks"], json!([]));
}

#[test]
fn a_coefficient_follows_before_a_parameter_and_a_whole_one_after_it() {
    let text = "param float beam = 4 in [2, 6];\n\
                AbsPoint P(1, 5.046 * beam, 3);\nAbsPoint Q(1, 0, beam / 2);\n\
                AbsPoint R(1, P.y / 2, -0.5 * Q.x);";
    let mut s = session(text);
    let kinds = |begin: &Reply| -> Vec<(String, bool)> {
        let handles = begin.head["handles"].as_array().unwrap().iter();
        let one = |h: &Value| (h["name"].as_str().unwrap().to_string(), h["parameter"] == true);
        handles.map(one).collect()
    };
    // Looking along x: x is not touched although it is a number of its own.
    let mut drag = |object: &str, y: f64, z: f64| {
        let begin = ask(&mut s, json!({"kind": "drag_begin", "object": object}));
        let to = ask(
            &mut s,
            json!({"kind": "drag_to", "target": [1, y, z],
            "basis": [[0, 1, 0], [0, 0, 1]], "grain": 1e-6}),
        );
        assert!(to.head["left"].as_f64().is_some_and(|x| x < 1e-5), "{}", to.head);
        let end = ask(&mut s, json!({"kind": "drag_end", "commit": true}));
        let new = edited(text, &end);
        // The text itself has the place that was shown.
        let mut again = session(&new);
        let value = ask(&mut again, json!({"kind": "evaluate", "expressions": [object]}));
        assert_eq!(value.head["values"][0]["value"], to.head["reached"], "{new}");
        ask(&mut s, json!({"kind": "text", "text": text}));
        (kinds(&begin), new)
    };
    let (handles, new) = drag("P", 24.184, 2.5);
    let named = |(name, is): (&str, bool)| (name.to_string(), is);
    let all = [("P.x", false), ("P.z", false), ("P.y#1", false), ("beam", true)];
    assert!(all.map(named).iter().all(|h| handles.contains(h)), "{handles:?}");
    assert_eq!(new, text.replace("5.046", "6.046").replace(", 3)", ", 2.5)"));
    let (_, new) = drag("Q", 0.25, 2.5);
    assert_eq!(new, text.replace("beam = 4", "beam = 5").replace("Q(1, 0,", "Q(1, 0.25,"));
    // A coefficient that changes its sign is spelled so that the text means it.
    let (_, new) = drag("R", 5.046 * 2.0, 0.75);
    assert!(new.contains("0.75"), "{new}");
}

/// Numbers of a linear congruence, from -1 to 1.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// The objects of a model that can be dragged.
fn draggable(open: &Reply) -> Vec<String> {
    let all = open.head["objects"].as_array().unwrap().iter();
    let class = |o: &Value| o["class"].as_str().unwrap_or_default().to_string();
    all.filter(|o| o["state"] == "ok")
        .filter(|o| ["point", "bead", "magnet", "ring"].contains(&class(o).as_str()))
        .map(|o| o["name"].as_str().unwrap().to_string())
        .collect()
}

#[test]
fn every_drag_of_the_examples_arrives_or_has_a_reason() {
    let soak = std::env::var("MOLDLOFT_SOAK").is_ok_and(|v| v == "1");
    let mut seed = 3;
    let (mut arrived, mut reasons, mut fixed) = (0, 0, 0);
    let quick = ["hull.sdl", "yacht.sdl", "wing.sdl", "canoe.sdl"];
    for (path, text) in examples() {
        if !soak && !quick.iter().any(|name| path.ends_with(&format!("/{name}"))) {
            continue;
        }
        let mut s = session(&text);
        let items = ask(&mut s, json!({"kind": "open"}));
        let objects = draggable(&items);
        let step = if soak { 1 } else { objects.len().div_ceil(4).max(1) };
        for object in objects.iter().step_by(step) {
            let begin = ask(&mut s, json!({"kind": "drag_begin", "object": object}));
            if let Some(why) = begin.head["error"].as_str() {
                assert!(why.contains("cannot be dragged"), "{path} {object}: {why}");
                fixed += 1;
                continue;
            }
            let at = ask(&mut s, json!({"kind": "evaluate", "expressions": [object]}));
            let at: [f64; 3] =
                serde_json::from_value(at.head["values"][0]["value"].clone()).unwrap();
            for view in 0..3 {
                let basis: Vec<[f64; 3]> = (0..3)
                    .filter(|k| *k != view)
                    .map(|k| std::array::from_fn(|c| if c == k { 1.0 } else { 0.0 }))
                    .collect();
                let size = 0.02 * (1.0 + at.iter().map(|x| x.abs()).fold(0.0, f64::max));
                let target: [f64; 3] = std::array::from_fn(|c| at[c] + size * noise(&mut seed));
                let grain = size / 50.0;
                let to = ask(
                    &mut s,
                    json!({"kind": "drag_to", "target": target, "basis": basis, "grain": grain}),
                );
                if let Some(why) = to.head["error"].as_str() {
                    assert!(!why.is_empty());
                    reasons += 1;
                    continue;
                }
                // What is said to be left is what is left, of the place that the model has.
                let now = ask(&mut s, json!({"kind": "evaluate", "expressions": [object]}));
                let now: [f64; 3] =
                    serde_json::from_value(now.head["values"][0]["value"].clone()).unwrap();
                let left = basis
                    .iter()
                    .map(|b| (0..3).map(|c| b[c] * (target[c] - now[c])).sum::<f64>().powi(2))
                    .sum::<f64>()
                    .sqrt();
                let said = to.head["left"].as_f64().unwrap();
                assert!(
                    (left - said).abs() <= 1e-9 * (1.0 + said),
                    "{path} {object}: {left} {said}"
                );
                assert!(!to.head["values"].as_object().unwrap().is_empty());
                if left < 2.0 * grain { arrived += 1 } else { reasons += 1 }
            }
            let back = ask(&mut s, json!({"kind": "drag_end", "commit": false}));
            assert!(back.head.get("error").is_none() && s.text() == text, "{path} {object}");
        }
    }
    println!("{arrived} arrived, {reasons} with a reason, {fixed} objects that nothing moves");
    assert!(arrived > 2 * reasons, "{arrived} arrived, {reasons} did not");
}

#[test]
fn numbers_that_are_given_are_reached_and_written() {
    let text = "param float l = 10 in [5, 20];\nparam float b = 4 in [2, 6];\n\
                param float t = 2 in [1, 3];\nAbsPoint P(l * b * t, l / b, t);";
    let mut s = session(text);
    let given = json!({"kind": "solve_for", "targets": {"P.x": 90, "P.y": 2.5},
        "by": {"l": {}, "b": {"weight": 2.0}, "t": {"home": 2.0}}});
    let reply = ask(&mut s, given);
    assert!(reply.head.get("error").is_none(), "{}", reply.head);
    let shares = reply.head["adjustments"].as_array().unwrap().iter();
    let shares: f64 = shares.map(|a| a["share"].as_f64().unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-9);
    let end = ask(&mut s, json!({"kind": "commit"}));
    let mut again = session(&edited(text, &end));
    let value = ask(&mut again, json!({"kind": "evaluate", "expressions": ["P.x", "P.y"]}));
    for (row, want) in value.head["values"].as_array().unwrap().iter().zip([90.0, 2.5]) {
        assert!((row["value"].as_f64().unwrap() / want - 1.0).abs() < 1e-8, "{row}");
    }
    let far = json!({"kind": "solve_for", "targets": {"P.x": 900}, "by": {"l": {}}});
    let said = ask(&mut s, far).head["error"].to_string();
    assert!(said.contains("out of reach"), "{said}");
}

/// Views along an axis but for rounding, or for a hair, and a hand that is not on the point's line.
#[test]
fn a_view_nearly_along_an_axis_takes_the_point_to_the_hand() {
    let text = "param float w = 2 in [1, 9];\nAbsPoint P(w * w, 0 * w, 0 * w);\n";
    for tilt in [0.0, 6e-17, 1e-9, 1e-3_f64] {
        for (steps, y) in [(1, 0.0), (10, 0.0), (10, 0.4)] {
            let mut s = session(text);
            ask(&mut s, json!({"kind": "drag_begin", "object": "P"}));
            let mut w = 0.0;
            for k in 1..=steps {
                let part = f64::from(k) / f64::from(steps);
                let drag = json!({"kind": "drag_to", "target": [4.0 + 4.125 * part, y * part, 0.0],
                    "basis": [[1, tilt, 0], [-tilt, 1, tilt]], "grain": 0.05});
                w = number(&ask(&mut s, drag), "w");
            }
            assert!((w * w - 8.125).abs() < 0.06, "{tilt} {steps} {y}: {w}");
        }
    }
}

/// Where each drag ends, whether it arrives or is refused, the picture is that of the text.
#[test]
fn a_drag_that_ends_leaves_the_picture_of_its_text() {
    let soak = std::env::var("MOLDLOFT_SOAK").is_ok_and(|v| v == "1");
    let mut seed = 11;
    let (mut moved, mut held) = (0, 0);
    for (path, text) in examples() {
        if !soak && !path.ends_with("/naca_duct.sdl") {
            continue;
        }
        let mut s = session(&text);
        let mut viewer = Viewer::default();
        let open = ask(&mut s, json!({"kind": "open"}));
        viewer.take(&open);
        let objects = draggable(&open);
        let step = if soak { 1 } else { objects.len().div_ceil(6).max(1) };
        for object in objects.iter().step_by(step) {
            // From within the ranges to far beyond them.
            for size in [0.05, 0.5, 5.0] {
                let at = ask(&mut s, json!({"kind": "evaluate", "expressions": [object]}));
                let at = at.head["values"][0]["value"].clone();
                let Ok(at) = serde_json::from_value::<[f64; 3]>(at) else { continue };
                let begin = ask(&mut s, json!({"kind": "drag_begin", "object": object}));
                viewer.take(&begin);
                if begin.head.get("error").is_some() {
                    continue;
                }
                let size = size * (0.1 + at.iter().map(|x| x.abs()).fold(0.0, f64::max));
                let mut any = || noise(&mut seed);
                let basis = [[any(), any(), 0.1], [0.0, 0.1, any()]];
                for _ in 0..3 {
                    let target: [f64; 3] = std::array::from_fn(|c| at[c] + size * any());
                    let to = json!({"kind": "drag_to", "target": target, "basis": basis,
                        "grain": size / 100.0});
                    viewer.take(&ask(&mut s, to));
                }
                let end = ask(&mut s, json!({"kind": "drag_end", "commit": true}));
                viewer.take(&end);
                let refused = end.head.get("error").is_some();
                let new = if refused { s.text().to_string() } else { edited(s.text(), &end) };
                if new == text {
                    held += 1
                } else {
                    moved += 1
                }
                let fresh = opened(&mut session(&new), 0);
                assert_eq!(viewer.items.len(), fresh.items.len(), "{path} {object} {size}\n{new}");
                for (key, drawn) in &fresh.items {
                    let same = viewer.items.get(key) == Some(drawn);
                    assert!(same, "{path} {object} {size}: {key}\n{new}");
                }
                viewer.take(&ask(&mut s, json!({"kind": "text", "text": text})));
            }
        }
        println!("{path}: {moved} moved, {held} held");
    }
    assert!(moved > held);
}
