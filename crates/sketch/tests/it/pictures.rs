//! Views of bodies: hidden lines are dashed.

use moldloft_sketch::*;

const BLOCK: &str = "SKETCH B; AXES 345 40 90
POINT 1 0 0; POINT 2 100 -27; POINT 3 177 37; POINT 4 77 64
POINT 5 0 100; POINT 6 100 73; POINT 7 177 137; POINT 8 77 164
POLYLINE 1 2 3 4 CLOSE; POLYLINE 5 6 7 8 CLOSE; LINE 1 5; LINE 2 6; LINE 3 7; LINE 4 8
DIM W X 1 2 10; DIM D Y 2 3 6; DIM H Z 1 5 4; GENERATE FACES
VIEW ISO
SHOW LABELS OFF";

fn picture(s: &mut SketchSession) -> String {
    let file = s.run_line("EXPORT SVG a.svg").into_iter().find_map(|r| r.file);
    String::from_utf8(file.unwrap().bytes).unwrap()
}

#[test]
fn a_block_has_nine_edges_before_and_three_behind() {
    let mut s = SketchSession::new();
    s.run_text(BLOCK);
    let text = picture(&mut s);
    assert_eq!((text.matches("<line").count(), text.matches("dasharray").count()), (12, 3));
    s.run_line("SHOW DIMENSIONS ON");
    let text = picture(&mut s);
    // Three dimension lines with two arrows each, and two witness lines for each.
    assert_eq!((text.matches("<line").count(), text.matches("<polygon").count()), (21, 6));
    assert!(text.contains(">W 10</text>") && !text.contains("paint-order"));
}

#[test]
fn a_bar_from_the_front_has_its_outlines() {
    let mut s = SketchSession::new();
    s.run_text(
        "SKETCH D 2D XZ\nPOINT 1 0 0; POINT 2 40 0; POINT 3 40 90; POINT 4 0 90\nPOLYLINE 1 2 3 4 CLOSE
DIM R X 1 2 2; DIM H Z 1 4 7; GENERATE FACES; REVOLVE 4\nVIEW FRONT\nSHOW LABELS OFF",
    );
    let mut solid: Vec<[f64; 4]> = Vec::new();
    for line in picture(&mut s).lines().filter(|l| l.starts_with("<line") && !l.contains("dash")) {
        let number = |name: &str| -> f64 {
            let rest = &line[line.find(&format!("{name}=\"")).unwrap() + name.len() + 2..];
            rest[..rest.find('"').unwrap()].parse().unwrap()
        };
        solid.push(["x1", "y1", "x2", "y2"].map(number));
    }
    // Height 7 and width 4 on 800 units of paper: the two sides are at the full width.
    let width = 800.0 * 4.0 / 7.0;
    let left = solid.iter().map(|l| l[0].min(l[2])).fold(f64::INFINITY, f64::min);
    for x in [left, left + width] {
        let covered: f64 = solid
            .iter()
            .filter(|l| (l[0] - x).abs() < 1.0 && (l[2] - x).abs() < 1.0)
            .map(|l| (l[3] - l[1]).abs())
            .sum();
        assert!(covered > 790.0, "{x}: {covered}");
    }
}
