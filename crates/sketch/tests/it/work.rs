//! Growth of the work with the size of a drawing, by counts; times are in `examples/timing.rs`.

use moldloft_num::Vec3;
use moldloft_sketch::{Planes, SketchSession, faces, solid, solve};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A stair of 249 steps, extruded: 1000 points, 498 dimensions.
fn stair() -> SketchSession {
    let mut text = String::from("SKETCH STAIR 2D XZ\n");
    let mut corners = vec![(0, 0), (2490, 0)];
    for k in (0..249).rev() {
        corners.push((10 * (k + 1), 10 * (249 - k)));
        corners.push((10 * k, 10 * (249 - k)));
    }
    for (k, (u, v)) in corners.iter().enumerate() {
        let _ = writeln!(text, "POINT {} {u} {v}", k + 1);
    }
    let all: Vec<String> = (1..=corners.len()).map(|k| k.to_string()).collect();
    let _ = writeln!(text, "POLYLINE {} CLOSE", all.join(" "));
    for k in 0..249 {
        let (low, high, below) = (2 * k + 3, 2 * k + 4, if k == 0 { 2 } else { 2 * k + 1 });
        let _ = writeln!(text, "DIM W{k} X {high} {low} = 1\nDIM H{k} Z {below} {low} = 1");
    }
    let mut s = SketchSession::new();
    for reply in s.run_text(&(text + "EXTRUDE 5\n")) {
        assert!(!reply.is_error(), "{}", reply.text);
    }
    s
}

/// A dimension of a 1000-point sketch changes: each vertex, edge and face is made once, with the bits
/// of a solid made from scratch.
#[test]
fn a_dimension_of_a_thousand_points() {
    let mut s = stair();
    let object = s.object("STAIR").unwrap().clone();
    assert_eq!(object.drawing.points.len(), 1000);
    let planes = Planes::of(&object.drawing);
    let width = 1.2;
    let layout = solve(&object, &planes, &BTreeMap::from([("w3".to_owned(), width)]), &|| None);
    let body = solid(&object, &planes, &layout).unwrap();
    assert_eq!((body.vertices.len(), body.edges.len(), body.faces.len()), (1000, 1500, 502));
    s.run_line(&format!("SET W3 {width}"));
    let edited = s.objects().remove(0);
    let mut fresh = SketchSession::new();
    fresh.run_text(&moldloft_sketch::script(s.object("STAIR").unwrap()));
    let made = fresh.objects().remove(0);
    assert_eq!(edited.solid, made.solid);
    assert_eq!(edited.volume.map(f64::to_bits), made.volume.map(f64::to_bits));
    // 249 steps of 1; the fourth from below, of height 4, is wider by the added length.
    let expected = 5.0 * (249.0 * 250.0 / 2.0 + 4.0 * (width - 1.0));
    assert!((made.volume.unwrap() - expected).abs() < 1e-6, "{:?} {expected}", made.volume);
}

/// Candidates and cells of a plate grow with its holes, not with their square.
#[test]
fn faces_of_five_hundred_edges() {
    let small = plate(10);
    let large = plate(40);
    assert_eq!((small.cells, large.cells), (11, 41));
    assert_eq!((small.candidates, large.candidates), (6 + 6 * 10, 6 + 6 * 40));
}

fn plate(holes: usize) -> faces::Fitted {
    let (mut points, mut edges) = (Vec::new(), Vec::new());
    let mut prism = |x: f64, y: f64, w: f64, d: f64| {
        let start = points.len();
        for z in [0.0, 1.0] {
            for (a, b) in [(0.0, 0.0), (w, 0.0), (w, d), (0.0, d)] {
                points.push(Vec3::of(x + a, y + b, z));
            }
        }
        for k in 0..4 {
            let next = (k + 1) % 4;
            edges.push([start + k, start + next]);
            edges.push([start + 4 + k, start + 4 + next]);
            edges.push([start + k, start + 4 + k]);
        }
    };
    prism(0.0, 0.0, 15.0, 15.0);
    for k in 0..holes as u32 {
        let shift = 0.3 * f64::from(k * 37 % 101) / 101.0;
        prism(2.0 * f64::from(k % 7) + 1.0 + shift, 2.0 * f64::from(k / 7) + 1.0 + shift, 0.6, 0.6);
    }
    let found = faces::fit(&points, &edges);
    assert!(found.complete && found.fits.len() == 1);
    assert!((found.fits[0].volume - (225.0 - holes as f64 * 0.36)).abs() < 1e-9);
    assert_eq!(found.fits[0].faces.len(), 6 + 4 * holes);
    found
}
