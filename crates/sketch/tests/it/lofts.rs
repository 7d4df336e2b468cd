//! LOFT of convex sections against the prismatoid formula.

use crate::common::all_commands;
use crate::treatments::{derivatives, near, refused, run, volume};
use moldloft_sketch::SketchSession;
use std::f64::consts::PI;

/// The volume between areas at the ends and in the middle.
fn prismatoid(height: f64, areas: [f64; 3]) -> f64 {
    height / 6.0 * (areas[0] + 4.0 * areas[1] + areas[2])
}

fn lofted(first: &str, second: &str, height: f64) -> SketchSession {
    let mut s = SketchSession::new();
    run(
        &mut s,
        &format!(
            "SKETCH A 2D XY\n{first}\nSKETCH B 2D XY\n{second}\nMOVE B 0 0 {height}\nLOFT A B INTO C"
        ),
    );
    s
}

#[test]
fn two_sections_make_a_prismatoid() {
    let square = "RECTANGLE 20 20 AT -10 -10";
    for (first, second, areas) in [
        (square, "RECTANGLE 8 12 AT -4 -6", [400.0, 14.0 * 16.0, 96.0]),
        ("CIRCLE DIAMETER 20", "CIRCLE DIAMETER 12", [100.0 * PI, 64.0 * PI, 36.0 * PI]),
        ("CIRCLE DIAMETER 20", "CIRCLE DIAMETER 12 AT 7 3", [100.0 * PI, 64.0 * PI, 36.0 * PI]),
        // The middle of a square and a circle is a square of half the side, rounded by half the radius.
        (square, "CIRCLE DIAMETER 12", [400.0, 100.0 + 4.0 * 10.0 * 3.0 + 9.0 * PI, 36.0 * PI]),
        ("CIRCLE DIAMETER 12", square, [400.0, 100.0 + 4.0 * 10.0 * 3.0 + 9.0 * PI, 36.0 * PI]),
        // A square and one turned by an eighth: an antiprism.
        (
            square,
            "POLYGON 4 20",
            [400.0, 100.0 + 50.0 + 2.0 * 10.0 * 10.0 * 0.5f64.sqrt() * 2f64.sqrt(), 200.0],
        ),
        ("SLOT 40 10", "SLOT 20 10", [300.0 + 25.0 * PI, 200.0 + 25.0 * PI, 100.0 + 25.0 * PI]),
    ] {
        for height in [15.0, -15.0] {
            let mut s = lofted(first, second, height);
            near(volume(&mut s, "C"), prismatoid(15.0, areas));
        }
    }
}

#[test]
fn lofts_follow_their_sections() {
    let mut s = lofted("RECTANGLE 20 20 AT -10 -10", "CIRCLE DIAMETER 12", 15.0);
    run(&mut s, "SKETCH D 2D XY\nRECTANGLE 9 9 AT -4.5 -4.5\nMOVE D 0 0 25\nLOFT A B D INTO E");
    let upper = |d: f64| {
        let r = d / 2.0;
        prismatoid(10.0, [PI * r * r, 4.5 * 4.5 + 9.0 * r + PI * r * r / 4.0, 81.0])
    };
    let lower = |d: f64| {
        let r = d / 2.0;
        prismatoid(15.0, [400.0, 100.0 + 20.0 * r + PI * r * r / 4.0, PI * r * r])
    };
    near(volume(&mut s, "E"), lower(12.0) + upper(12.0));
    run(&mut s, "USING B; SET DIAMETER1 18");
    near(volume(&mut s, "E"), lower(18.0) + upper(18.0));
    let mut again = SketchSession::new();
    run(&mut again, &all_commands(&s));
    assert_eq!(volume(&mut again, "E").to_bits(), volume(&mut s, "E").to_bits());
    assert_eq!(all_commands(&again), all_commands(&s));
    derivatives(&mut s, "C", &["A.WIDTH1", "B.DIAMETER1"]);
    // With other bodies.
    run(&mut s, "USING E; HOLE E 5 AT 0 0 INTO F");
    near(volume(&mut s, "F"), lower(18.0) + upper(18.0) - 6.25 * PI * 25.0);
}

#[test]
fn lofts_that_cannot_be_are_refused_with_a_remedy() {
    for (second, command, expected) in [
        ("RECTANGLE 9 9", "LOFT A B INTO C", "section 2 is not beyond section 1"),
        (
            "RECTANGLE 9 9; CIRCLE DIAMETER 2 AT 4 4; MOVE B 0 0 9",
            "LOFT A B INTO C",
            "section 2 has 2 outlines",
        ),
        ("RECTANGLE 9 9", "LOFT A A INTO C", "not A twice"),
        ("SKETCH C 2D XZ; RECTANGLE 9 9", "LOFT A C INTO D", "section 2 is not parallel"),
        (
            "POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; POINT 4 5 9; POINT 5 5 4; POINT 6 0 4; POLYLINE 1 2 3 4 5 6 CLOSE; \
             DIM X 1 2 9; DIM Y 2 3 9; DIM X 1 4 5; DIM Y 1 6 4; MOVE B 0 0 9",
            "LOFT A B INTO C",
            "section 2 is not convex",
        ),
    ] {
        let mut s = SketchSession::new();
        run(&mut s, &format!("SKETCH A 2D XY; RECTANGLE 20 20; SKETCH B 2D XY\n{second}"));
        let text = refused(&mut s, command);
        assert!(text.contains(expected), "{text}");
    }
}
