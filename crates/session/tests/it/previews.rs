//! Bodies of sets are coarser while a number moves, and exact for whoever asks.

use crate::viewer::{Viewer, ask, session};
use serde_json::{Value, json};

const BODY: &str = "param float r = 1 in [0.5, 2];
set part = set(sphere({0, 0, 0}, r)) - cuboid({0, 0, 0}, {2, 2, 2});
SetBody b(part, depth = 6);
SetBody c(set(sphere({5, 0, 0}, 1)) | part, depth = 5);";

fn triangles(viewer: &Viewer) -> usize {
    viewer.items.values().map(|item| item.parts.get("triangle").map_or(0, Vec::len) / 3).sum()
}

/// The viewer after some requests.
fn seen(requests: &[Value]) -> (Viewer, Vec<Value>) {
    let mut session = session(BODY);
    let mut viewer = Viewer::default();
    viewer.take(&ask(&mut session, json!({"kind": "open", "tab": 1})));
    assert_eq!(viewer.facts["diagnostics"], json!([]));
    let mut values = Vec::new();
    for request in requests {
        let mut request = request.clone();
        request["tab"] = json!(1);
        let reply = ask(&mut session, request);
        assert!(reply.head.get("error").is_none(), "{}", reply.head);
        values.push(reply.head.get("values").cloned().unwrap_or_default());
        viewer.take(&reply);
    }
    (viewer, values)
}

fn set(r: f64, coarser: u32) -> Value {
    json!({"kind": "set", "values": {"r": r}, "coarser": coarser})
}

#[test]
fn a_body_is_coarser_while_a_number_moves_and_exact_when_it_rests() {
    let (exact, _) = seen(&[set(1.3, 0)]);
    let (coarse, _) = seen(&[set(1.1, 2), set(1.3, 2)]);
    let (few, many) = (triangles(&coarse), triangles(&exact));
    assert!(8 * few < many && few > 100, "{few} {many}");
    let (settled, _) = seen(&[set(1.1, 2), set(1.3, 1), json!({"kind": "settle"})]);
    assert_eq!(settled, exact);
    // A change without halvings, an end of the move, settles as well.
    let (set_again, _) = seen(&[set(1.1, 2), set(1.3, 0)]);
    assert_eq!(set_again, exact);
    // Another viewer's look does not.
    let (looked, _) = seen(&[set(1.1, 2), set(1.3, 2), json!({"kind": "sync"})]);
    assert_eq!(triangles(&looked), triangles(&coarse));
}

#[test]
fn figures_are_those_of_the_stated_cells() {
    let figure =
        json!({"kind": "evaluate", "expressions": ["volume(b)", "area(b)", "mesh.volume"]});
    let (_, exact) = seen(&[set(1.3, 0), figure.clone()]);
    let (_, moved) = seen(&[set(1.1, 3), set(1.3, 3), figure]);
    assert_eq!(exact.last(), moved.last());
    assert_ne!(exact.last(), Some(&Value::Null));
}

#[test]
fn parts_that_coarser_cells_lose_are_shown_as_stated() {
    let thin = "param float t = 0.05 in [0.01, 1];
        SetBody b(cuboid({-2, -2, 0}, {2, 2, t}), {-3, -3, -1}, {3, 3, 1}, depth = 6);";
    let mut session = session(thin);
    let mut viewer = Viewer::default();
    viewer.take(&ask(&mut session, json!({"kind": "open", "tab": 1})));
    for coarser in [0, 3, 4, 90] {
        let t = 0.05 + 1e-3 * f64::from(coarser);
        let reply = ask(
            &mut session,
            json!({"kind": "set", "tab": 1, "values": {"t": t}, "coarser": coarser}),
        );
        viewer.take(&reply);
        assert_eq!(viewer.facts["diagnostics"], json!([]), "{coarser}");
        assert!(triangles(&viewer) > 0, "{coarser}");
    }
}
