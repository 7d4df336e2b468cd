//! Times of the sketch library, as listed in `docs/performance.md`: the best of many repetitions.
//!
//! `cargo run --release -p moldloft-sketch --example timing`

use moldloft_num::Vec3;
use moldloft_sketch::{Estimate, Planes, PointId, SketchSession, faces, solid, solve};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

/// The best time of `n` runs, in milliseconds.
fn best(n: usize, mut f: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..n {
        let start = Instant::now();
        f();
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    best
}

/// A stair of `steps` steps as a section, extruded: `2 (2 steps + 2)` points.
fn stair(steps: usize) -> String {
    let mut text = String::from("SKETCH STAIR 2D XZ\nPOINT 1 0 0\n");
    let mut corners = vec![(0, 0), (10 * steps, 0)];
    for k in (0..steps).rev() {
        corners.push((10 * (k + 1), 10 * (steps - k)));
        corners.push((10 * k, 10 * (steps - k)));
    }
    for (k, (u, v)) in corners.iter().enumerate() {
        let _ = writeln!(text, "POINT {} {u} {v}", k + 1);
    }
    let all: Vec<String> = (1..=corners.len()).map(|k| k.to_string()).collect();
    let _ = writeln!(text, "POLYLINE {} CLOSE", all.join(" "));
    // Each step depends on the one before: a change of the first moves all.
    for k in 0..steps {
        let (low, high) = (2 * k + 3, 2 * k + 4);
        let _ = writeln!(text, "DIM W{k} X {high} {low} = 1");
        let below = if k == 0 { 2 } else { 2 * k + 1 };
        let _ = writeln!(text, "DIM H{k} Z {below} {low} = 1");
    }
    text + "EXTRUDE 5\n"
}

/// The drawing of a plate with square holes, 8 points each, placed by dimensions of their own.
fn drawn_plate(holes: usize) -> String {
    let (points, edges) = plate(holes);
    let mut text = String::from("SKETCH PLATE\nAXES 345 40 90\n");
    let angles = [345.0f64, 40.0, 90.0].map(f64::to_radians);
    for (k, p) in points.iter().enumerate() {
        let at = [p.x, p.y, p.z];
        let u: f64 = at.iter().zip(angles).map(|(x, a)| 20.0 * x * a.cos()).sum();
        let v: f64 = at.iter().zip(angles).map(|(x, a)| 20.0 * x * a.sin()).sum();
        let _ = writeln!(text, "POINT {} AT {u:.3} {v:.3}", k + 1);
    }
    for [a, b] in &edges {
        let axis = (0..3).find(|&k| (points[*a][k] - points[*b][k]).abs() > 1e-9).unwrap_or(0);
        let _ = writeln!(text, "LINE {} {} TYPE {}", a + 1, b + 1, ["X", "Y", "Z"][axis]);
    }
    let side = points[2].x;
    let _ = writeln!(text, "DIM X 1 2 {side}; DIM Y 1 4 {side}; DIM Z 1 5 1");
    for k in 0..holes {
        let first = 8 * (k + 1);
        let (p, n) = (points[first], first + 1);
        let _ = writeln!(text, "DIM PX{k} X 1 {n} {}; DIM PY{k} Y 1 {n} {}", p.x, p.y);
        let _ = writeln!(text, "DIM W{k} X {n} {} 0.6; DIM E{k} Y {n} {} 0.6", n + 1, n + 3);
        let _ = writeln!(text, "ALIGN Z 1 {n}; ALIGN Z 5 {}", n + 4);
    }
    text + "GENERATE FACES\n"
}

/// Queries of a canvas to a plate of 1 000 points.
fn canvas() {
    let mut session = SketchSession::new();
    for reply in session.run_text(&drawn_plate(124)) {
        assert!(!reply.is_error(), "{}", reply.text);
    }
    let object = session.object("plate").expect("the plate").clone();
    let count = object.drawing.points.len();
    println!("a plate of {count} points, {} lines, 124 holes", object.drawing.lines.len());
    let planes = Planes::of(&object.drawing);
    let mut width = 0.6;
    let t = best(100, || {
        width += 1e-4;
        let values = BTreeMap::from([("w3".to_owned(), width)]);
        let layout = solve(&object, &planes, &values, &|| None);
        assert!(solid(&object, &planes, &layout).is_some());
    });
    println!("a dimension changed, to the valid solid{t:8.3} ms");
    let t = best(30, || {
        width += 1e-4;
        session.run_line(&format!("SET W3 {width}"));
        assert!(session.solid("plate").is_some());
    });
    println!("SET as a command, to the solid         {t:8.3} ms");
    let mut drawing = (*object.drawing).clone();
    let t = best(10, || {
        drawing.points.values_mut().take(1).for_each(|p| p.u += 0.01);
        let planes = Planes::of(&drawing);
        assert!(Estimate::of(&drawing, &planes, PointId(1)).is_some());
    });
    println!("the estimate after a moved point       {t:8.3} ms");
    let mut at = 0.0;
    let t = best(300, || {
        at += 1.7;
        std::hint::black_box(drawing.hit([at, 0.3 * at], 2.0));
    });
    println!("hit test                               {t:8.4} ms");
    let t = best(300, || {
        at -= 1.7;
        std::hint::black_box(drawing.snaps([at, 0.3 * at], 2.0, None, &[]));
    });
    println!("snap                                   {t:8.4} ms");
}

/// A plate with `holes` square holes: 12 + 12 holes edges.
fn plate(holes: usize) -> (Vec<Vec3>, Vec<[usize; 2]>) {
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
    let side = (holes as f64).sqrt().ceil() as usize;
    prism(0.0, 0.0, 2.0 * side as f64 + 1.0, 2.0 * side as f64 + 1.0);
    for k in 0..holes {
        let (i, j) = ((k % side) as f64, (k / side) as f64);
        // No two holes in one line, as a drawing by hand would have them.
        let shift = 0.3 * ((k * 37 % 101) as f64 / 101.0);
        prism(2.0 * i + 1.0 + shift, 2.0 * j + 1.0 + shift, 0.6, 0.6);
    }
    (points, edges)
}

fn main() {
    let mut session = SketchSession::new();
    for reply in session.run_text(&stair(249)) {
        assert!(!reply.is_error(), "{}", reply.text);
    }
    let object = session.object("stair").expect("the stair").clone();
    let n = object.drawing.points.len();
    let planes = Planes::of(&object.drawing);
    let mut width = 1.0;
    let mut values = || {
        width += 1e-3;
        BTreeMap::from([("w3".to_owned(), width)])
    };
    let layout = solve(&object, &planes, &values(), &|| None);
    println!("{n} points, {} lines, {} faces", object.drawing.lines.len(), object.faces.len());
    let t = best(300, || drop(solve(&object, &planes, &values(), &|| None)));
    println!("coordinates from the dimensions        {t:8.3} ms");
    let t = best(300, || drop(solid(&object, &planes, &layout)));
    println!("solid from the coordinates             {t:8.3} ms");
    let t = best(300, || {
        let layout = solve(&object, &planes, &values(), &|| None);
        assert!(solid(&object, &planes, &layout).is_some());
    });
    println!("a dimension changed, to the solid      {t:8.3} ms");
    let t = best(300, || {
        let layout = solve(&object, &planes, &values(), &|| None);
        let mass = solid(&object, &planes, &layout).map(|s| s.mass());
        assert!(mass.is_some_and(|m| m.volume > 0.0));
    });
    println!("… to volume, area, centroid, inertia   {t:8.3} ms");
    let mut width = 1.0;
    let t = best(100, || {
        width += 1e-3;
        let replies = session.run_line(&format!("SET W3 {width}"));
        assert!(replies.iter().all(|r| !r.is_error()));
    });
    println!("SET as a command, with all its checks  {t:8.3} ms");
    let t = best(100, || {
        width += 1e-3;
        session.run_line(&format!("SET W3 {width}"));
        assert!(session.solid("stair").is_some_and(|s| !s.faces.is_empty()));
    });
    println!("SET as a command, to the solid         {t:8.3} ms");
    canvas();
    for holes in [4, 14, 40] {
        let (points, edges) = plate(holes);
        let mut cells = 0;
        let t = best(5, || {
            let fitted = faces::fit(&points, &edges);
            assert_eq!((fitted.fits.len(), fitted.complete), (1, true));
            cells = fitted.cells;
        });
        println!("faces of {:4} edges, {cells:3} cells            {t:8.3} ms", edges.len());
    }
}
