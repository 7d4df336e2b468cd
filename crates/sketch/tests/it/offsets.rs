//! OFFSET of sections and EXTRUDE of what it makes, against closed forms.

use crate::common::all_commands;
use crate::treatments::{derivatives, near, refused, run, volume};
use moldloft_sketch::SketchSession;
use std::f64::consts::PI;

fn area(s: &mut SketchSession, name: &str) -> f64 {
    s.objects().into_iter().find(|o| o.name == name).unwrap().area.unwrap()
}

#[test]
fn outlines_move_by_a_distance() {
    let root = 2f64.sqrt();
    for (outline, command, expected) in [
        ("RECTANGLE 80 50", "OFFSET P 5", 4000.0 + 2.0 * 130.0 * 5.0 + 25.0 * PI),
        ("RECTANGLE 80 50", "OFFSET P 5 MITRED", 90.0 * 60.0),
        ("RECTANGLE 80 50", "OFFSET P -5", 70.0 * 40.0),
        ("RECTANGLE 80 50", "OFFSET P -5 MITRED", 70.0 * 40.0),
        ("CIRCLE DIAMETER 30", "OFFSET P 5", 400.0 * PI),
        ("CIRCLE DIAMETER 30", "OFFSET P -5 MITRED", 100.0 * PI),
        ("SLOT 40 10", "OFFSET P 3", 30.0 * 16.0 + 64.0 * PI),
        ("SLOT 40 10", "OFFSET P -3", 30.0 * 4.0 + 4.0 * PI),
        ("POLYGON 4 20", "OFFSET P 1", 200.0 + 40.0 * root + PI),
        // A hole becomes smaller, and disappears.
        (
            "RECTANGLE 80 50; CIRCLE DIAMETER 9 AT 40 25",
            "OFFSET P 2 MITRED",
            84.0 * 54.0 - 6.25 * PI,
        ),
        ("RECTANGLE 80 50; CIRCLE DIAMETER 9 AT 40 25", "OFFSET P 5 MITRED", 90.0 * 60.0),
        ("RECTANGLE 80 50; CIRCLE DIAMETER 9 AT 40 25", "OFFSET P -2", 76.0 * 46.0 - 42.25 * PI),
        // A rectangular hole of exactly twice the distance closes.
        ("RECTANGLE 80 50; RECTANGLE 20 4 AT 30 23", "OFFSET P 2 MITRED", 84.0 * 54.0),
        (
            "RECTANGLE 80 50; RECTANGLE 20 4 AT 30 23",
            "OFFSET P -1 MITRED",
            78.0 * 48.0 - 22.0 * 6.0,
        ),
        // A hole that reaches the border divides the section.
        ("RECTANGLE 80 50; RECTANGLE 10 40 AT 35 5", "OFFSET P -6 MITRED", 2.0 * 23.0 * 38.0),
    ] {
        for plane in ["XY", "XZ", "YZ"] {
            let mut s = SketchSession::new();
            let text = format!("SKETCH P 2D {plane}\n{outline}\n{command} INTO Q");
            run(&mut s, &text);
            near(area(&mut s, "Q"), expected);
            run(&mut s, "EXTRUDE Q 3 INTO B");
            near(volume(&mut s, "B"), 3.0 * expected);
            run(&mut s, "EXTRUDE Q -2");
            near(volume(&mut s, "Q"), 2.0 * expected);
        }
    }
}

#[test]
fn offsets_follow_their_section_and_come_back_from_their_text() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH P 2D XY\nRECTANGLE 80 50\nCIRCLE DIAMETER 10 AT 20 20\nVARIABLE WALL 4\n\
         OFFSET P \"WALL/2\" INTO Q\nEXTRUDE Q 3 INTO B",
    );
    let expected = |w: f64, h: f64, d: f64, by: f64| {
        let hole = PI * (d / 2.0 - by).powi(2);
        w * h + 2.0 * (w + h) * by + PI * by * by - hole
    };
    near(volume(&mut s, "B"), 3.0 * expected(80.0, 50.0, 10.0, 2.0));
    run(&mut s, "USING P; SET WIDTH1 100; SET WALL 6; SET DIAMETER1 20; SET B.EXTRUDE1 7");
    near(volume(&mut s, "B"), 7.0 * expected(100.0, 50.0, 20.0, 3.0));
    let mut again = SketchSession::new();
    run(&mut again, &all_commands(&s));
    assert_eq!(volume(&mut again, "B").to_bits(), volume(&mut s, "B").to_bits());
    assert_eq!(all_commands(&again), all_commands(&s));
    run(&mut again, "USING P; SET WALL 2");
    near(volume(&mut again, "B"), 7.0 * expected(100.0, 50.0, 20.0, 1.0));
    derivatives(&mut s, "B", &["WIDTH1", "WALL", "DIAMETER1", "EXTRUDE1"]);
}

#[test]
fn faces_of_an_extruded_offset_have_names() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XY\nRECTANGLE 80 50\nOFFSET P 2 INTO Q\nEXTRUDE Q 10 INTO B");
    run(&mut s, "FILLET B 1 EDGES OF END INTO C");
    assert!(volume(&mut s, "C") < volume(&mut s, "B"));
    run(&mut s, "SHELL B 1 OPEN END INTO D; HOLE B 10 AT 40 25 INTO E");
    let expected = volume(&mut s, "B") - 250.0 * PI;
    near(volume(&mut s, "E"), expected);
    run(&mut s, "OFFSET P -2 MITRED INTO R; EXTRUDE R 10 INTO F; CUT B F INTO TUBE");
    let outer = 4000.0 + 520.0 + 4.0 * PI;
    near(volume(&mut s, "TUBE"), 10.0 * (outer - 76.0 * 46.0));
}

#[test]
fn offsets_that_cannot_be_are_refused_with_a_remedy() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XY\nRECTANGLE 80 50\nGENERATE FACES");
    let replies = s.run_text("OFFSET P -25 INTO Q");
    let error = replies.iter().find(|r| r.is_error()).unwrap();
    assert!(error.text.contains("an inward offset of 25 leaves nothing"), "{}", error.text);
    assert_eq!(error.next.as_deref(), Some("the largest distance is below 25"));
    assert!(refused(&mut s, "OFFSET P 0").contains("an offset of 0"));
    run(&mut s, "EXTRUDE P 5 INTO B");
    assert!(refused(&mut s, "OFFSET B 3").contains("not a cross section"));
    run(&mut s, "OFFSET P 3 INTO Q");
    assert!(refused(&mut s, "REVOLVE Q 1").contains("no lines to turn about"));
    assert!(refused(&mut s, "EXTRUDE Q 0 INTO Z").contains("length 0"));
    assert!(refused(&mut s, "FILLET Q 1 EDGES ALL").contains("cross section"));
    run(
        &mut s,
        "SKETCH E 2D XY\nPOINT 1 0 0; POINT 2 10 0; POINT 3 10 10; POINT 4 0 10\n\
         POLYLINE 1 2 3 4 CLOSE\nDIM X 1 2 10; DIM Y 1 4 10\nELLIPSE C ARC CORNER 3 2 4 SEMI 4 2",
    );
    assert!(refused(&mut s, "OFFSET E 1").contains("C is neither straight nor an arc"));
}

/// A star of many corners with slight turns both ways, moved by distances of all sizes.
#[test]
fn slight_turns_and_small_distances() {
    let mut s = SketchSession::new();
    let n = 120;
    let at = |k: usize| {
        let turn = 2.0 * PI * k as f64 / n as f64;
        let r = 50.0 + 2.0 * (5.0 * turn).sin();
        [r * turn.cos(), r * turn.sin()]
    };
    let mut text = "SKETCH P 2D XY\nSET EXACT ON\n".to_owned();
    for k in 0..n {
        text += &format!("POINT {} {:?} {:?}\n", k + 1, at(k)[0], at(k)[1]);
    }
    let ids: Vec<String> = (1..=n).map(|k| k.to_string()).collect();
    run(&mut s, &format!("{text}POLYLINE {} CLOSE\nACCEPT ALL\nGENERATE FACES", ids.join(" ")));
    let whole = area(&mut s, "P");
    let side = |k: usize| [0, 1].map(|i| at((k + 1) % n)[i] - at(k)[i]);
    let length: f64 = (0..n).map(|k| side(k)[0].hypot(side(k)[1])).sum();
    let turns: Vec<f64> = (0..n)
        .map(|k| {
            let (a, b) = (side(k), side((k + 1) % n));
            (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
        })
        .collect();
    for by in [1e-3, 1e-2, 0.1, 1.0, -1e-3, -1e-2, -0.1, -1.0f64] {
        run(&mut s, &format!("OFFSET P {by} INTO Q"));
        // Arcs where the sides separate, cut corners where they cross.
        let corner = |t: &f64| match t * by > 0.0 {
            true => t.abs() / 2.0,
            false => -(t.abs() / 2.0).tan(),
        };
        let corners = turns.iter().map(corner).sum::<f64>();
        near(area(&mut s, "Q"), whole + length * by + corners * by * by.abs());
    }
}
