//! CHAMFER, FILLET, SHELL, DRAFT against closed forms, and their derivatives against differences.

use crate::common::*;
use moldloft_sketch::*;
use std::f64::consts::PI;

pub fn run(s: &mut SketchSession, text: &str) -> Vec<CommandReply> {
    let replies = s.run_text(text);
    let errors: Vec<&CommandReply> = replies.iter().filter(|r| r.is_error()).collect();
    assert!(errors.is_empty(), "{text}: {errors:?}");
    replies
}

pub fn refused(s: &mut SketchSession, text: &str) -> String {
    let replies = s.run_text(text);
    let error = replies.iter().find(|r| r.is_error());
    error.unwrap_or_else(|| panic!("{text}: not refused: {replies:?}")).text.clone()
}

pub fn cuboid_session(size: [f64; 3]) -> SketchSession {
    let mut s = SketchSession::new();
    s.insert(with_faces(cuboid(size)));
    s
}

pub fn volume(s: &mut SketchSession, name: &str) -> f64 {
    let o = s.objects().into_iter().find(|o| o.name == name).unwrap();
    let report = o.solid.unwrap().mesh(1e-2).report();
    assert!(report.closed && report.outward == Some(true), "{report:?}");
    o.volume.unwrap()
}

fn area(s: &mut SketchSession, name: &str) -> f64 {
    s.objects().into_iter().find(|o| o.name == name).unwrap().area.unwrap()
}

pub fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs(), "{found} for {expected}");
}

/// Exact derivatives against central differences.
pub fn derivatives(s: &mut SketchSession, name: &str, by: &[&str]) {
    run(s, &format!("USING {name}"));
    let names: Vec<String> = by.iter().map(|n| (*n).to_owned()).collect();
    let exact = s.gradient(name, &names).unwrap();
    for (k, n) in by.iter().enumerate() {
        let rows = s.numbers(name).unwrap();
        let x = rows.iter().find(|r| r.0 == *n).unwrap().1.unwrap();
        let h = 1e-5 * x.abs().max(1.0);
        let mut at = |x: f64| {
            run(s, &format!("SET {n} {x}"));
            volume(s, name)
        };
        let difference = (at(x + h) - at(x - h)) / (2.0 * h);
        at(x);
        let size = difference.abs().max(1.0);
        assert!(
            (exact.volume[k] - difference).abs() < 1e-6 * size,
            "{n}: {} for {difference}",
            exact.volume[k]
        );
    }
}

#[test]
fn edges_of_a_box() {
    let made = |command: &str| {
        let mut s = cuboid_session([10.0, 6.0, 4.0]);
        run(&mut s, command);
        s
    };
    let mut s = made("FILLET A 1 EDGES ALONG Z INTO B");
    near(volume(&mut s, "B"), 236.566_370_614_359);
    near(area(&mut s, "B"), 239.415_926_535_898);
    derivatives(&mut s, "B", &["FILLET1", "D1"]);
    let mut s = made("FILLET A 1 EDGES ALL INTO B");
    near(volume(&mut s, "B"), 224.171_087_355_043);
    near(area(&mut s, "B"), 212.530_964_914_873);
    derivatives(&mut s, "B", &["FILLET1"]);
    let mut s = made("CHAMFER A 1 EDGES ALL INTO B");
    near(volume(&mut s, "B"), 206.0);
    derivatives(&mut s, "B", &["CHAMFER1", "D2"]);
    let mut s = made("CHAMFER A 1 2 EDGES OF TOP Z INTO B");
    // One along the top, two down: the top is a frustum of height 2.
    near(volume(&mut s, "B"), 240.0 - (2.0 * 60.0 - (60.0 + 32.0 + 4.0 * 45.0) / 6.0 * 2.0));
    // Two of the three edges of a corner meet in a mitre.
    let mut s = made("FILLET A 1 EDGES OF TOP Z INTO B");
    let (first, second) = (1.0 - PI / 4.0, 1.0 - PI / 2.0 + 2.0 / 3.0);
    near(volume(&mut s, "B"), 240.0 - (32.0 * first - 4.0 * second));
    let text = refused(&mut s, "FILLET A 3.5 EDGES ALL INTO C");
    assert!(text.contains("meet within a face"), "{text}");
    let text = refused(&mut s, "FILLET A 5 EDGES ALONG Y INTO C");
    assert!(text.contains("leaves the face"), "{text}");
    refused(&mut s, "FILLET A -1 EDGES ALL INTO C");
    refused(&mut s, "CHAMFER A 1 2 EDGES ALL INTO C");
    refused(&mut s, "FILLET A 1 EDGES OF nothing INTO C");
    // The refusals changed nothing.
    assert!(s.object("C").is_none());
}

const ELL: &str = "SKETCH ELL 2D XY
POINT 1 0 0; POINT 2 90 0; POINT 3 90 30; POINT 4 30 30; POINT 5 30 90; POINT 6 0 90
POLYLINE 1 2 3 4 5 6 CLOSE
DIM L X 1 2 9; DIM T X 1 4 3; DIM M Y 1 6 9; DIM S Y 1 3 3; EXTRUDE 5";

#[test]
fn a_corner_that_stands_in() {
    let mut s = SketchSession::new();
    run(&mut s, ELL);
    let whole = volume(&mut s, "ELL");
    near(whole, 225.0);
    run(&mut s, "CHAMFER ELL 1 EDGES OF TOP Z INTO B; FILLET ELL 1 EDGES OF TOP Z INTO C");
    near(volume(&mut s, "B"), 225.0 - (36.0 / 2.0 - 4.0 / 3.0));
    let (first, second) = (1.0 - PI / 4.0, 1.0 - PI / 2.0 + 2.0 / 3.0);
    near(volume(&mut s, "C"), 225.0 - (36.0 * first - 4.0 * second));
    derivatives(&mut s, "C", &["FILLET1", "T"]);
    // The inner edge is filled, the outer ones are cut: by the line of each in the section.
    run(&mut s, "USING ELL");
    run(&mut s, "FILLET ELL 1 EDGES ALONG Z INTO D");
    near(volume(&mut s, "D"), 225.0 - 5.0 * first * 4.0);
}

#[test]
fn round_edges() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH DISC 2D XY
         POINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90
         POLYLINE 1 2 3 4 CLOSE
         DIM D X 1 2 8; DIM E Y 1 4 8; EXTRUDE 3",
    );
    run(&mut s, "CIRCLE C1 CORNER 1 4 2; CIRCLE C2 CORNER 5 8 6");
    near(volume(&mut s, "DISC"), 48.0 * PI);
    run(&mut s, "FILLET DISC 1 EDGES OF TOP Z INTO B; CHAMFER DISC 1 EDGES OF TOP Z INTO C");
    // Pappus: the triangle of the chamfer, and the part of the square outside the quarter circle.
    let square = 1.0 - PI / 4.0;
    // The square's centroid is 1/2 from the corner; that of the rest (10 - 3 pi) / (12 - 3 pi).
    let off = (10.0 - 3.0 * PI) / (12.0 - 3.0 * PI);
    near(volume(&mut s, "B"), 48.0 * PI - 2.0 * PI * (4.0 - off) * square);
    near(volume(&mut s, "C"), 48.0 * PI - 2.0 * PI * (4.0 - 1.0 / 3.0) * 0.5);
    derivatives(&mut s, "B", &["FILLET1"]);
}

#[test]
fn walls_and_drafts() {
    let mut s = cuboid_session([10.0, 6.0, 4.0]);
    run(&mut s, "SHELL A 0.5 OPEN TOP Z INTO B; SHELL A 0.5 INTO C; SHELL A -0.5 INTO D");
    near(volume(&mut s, "B"), 240.0 - 9.0 * 5.0 * 3.5);
    near(volume(&mut s, "C"), 240.0 - 9.0 * 5.0 * 3.0);
    near(volume(&mut s, "D"), 11.0 * 7.0 * 5.0 - 240.0);
    derivatives(&mut s, "B", &["SHELL1", "D1", "D3"]);
    derivatives(&mut s, "C", &["SHELL1"]);
    refused(&mut s, "SHELL A 3.5 INTO E");
    run(&mut s, "DRAFT A Z 10 INTO E");
    let t = (10.0f64).to_radians().tan() * 4.0;
    let (top, middle) = ((10.0 - 2.0 * t) * (6.0 - 2.0 * t), (10.0 - t) * (6.0 - t));
    near(volume(&mut s, "E"), (60.0 + 4.0 * middle + top) * 4.0 / 6.0);
    derivatives(&mut s, "E", &["DRAFT1", "NEUTRAL1", "D2"]);
    refused(&mut s, "DRAFT A Z 60 INTO F");
    // A rounded box is hollowed after its edges are rounded.
    run(&mut s, "FILLET A 1 EDGES ALONG Z INTO R; SHELL R 0.5 OPEN TOP Z INTO G");
    let rounded = |x: f64, y: f64, r: f64| x * y - (4.0 - PI) * r * r;
    near(volume(&mut s, "G"), rounded(10.0, 6.0, 1.0) * 4.0 - rounded(9.0, 5.0, 0.5) * 3.5);
    derivatives(&mut s, "G", &["SHELL1", "FILLET1"]);
}

#[test]
fn a_treatment_is_saved_and_read() {
    let mut s = cuboid_session([10.0, 6.0, 4.0]);
    run(
        &mut s,
        "FILLET A 1 EDGES ALONG Z INTO B; SHELL B 0.5 OPEN TOP Z; USING B; SET FILLET1 1.5",
    );
    let text = script(s.object("B").unwrap());
    let mut other = SketchSession::new();
    run(&mut other, &text);
    assert_eq!(s.object("B"), other.object("B"), "{text}");
    near(volume(&mut other, "B"), volume(&mut s, "B"));
}
