//! RECTANGLE, SLOT, POLYGON and CIRCLE DIAMETER against closed forms.

use crate::treatments::{near, refused, run, volume};
use moldloft_sketch::{SketchSession, script};
use moldloft_testing::{Random, rounds};
use std::f64::consts::{PI, TAU};

fn area(s: &mut SketchSession) -> f64 {
    let object = s.objects().into_iter().next().unwrap();
    object.area.unwrap()
}

fn disc(diameter: f64) -> f64 {
    PI * diameter * diameter / 4.0
}

fn slot(length: f64, width: f64) -> f64 {
    (length - width) * width + disc(width)
}

fn polygon(n: f64, diameter: f64) -> f64 {
    n / 8.0 * diameter * diameter * (TAU / n).sin()
}

#[test]
fn outlines_and_what_they_leave_out() {
    for (plane, commands, expected) in [
        ("XY", "RECTANGLE 80 50", 4000.0),
        ("XZ", "RECTANGLE 80 50 AT -5 7", 4000.0),
        ("YZ", "CIRCLE DIAMETER 30 AT 0 0", disc(30.0)),
        ("XY", "SLOT 40 10", slot(40.0, 10.0)),
        ("XY", "POLYGON 6 30", polygon(6.0, 30.0)),
        ("XZ", "POLYGON 5 30 AT 20 20", polygon(5.0, 30.0)),
        ("XY", "RECTANGLE 80 50; CIRCLE DIAMETER 9 AT 10 12", 4000.0 - disc(9.0)),
        ("XY", "RECTANGLE 80 50; SLOT 20 6 AT 10 12", 4000.0 - slot(20.0, 6.0)),
        ("XZ", "RECTANGLE 80 50 AT -40 -25; POLYGON 7 20 AT 0 0", 4000.0 - polygon(7.0, 20.0)),
        (
            "YZ",
            "CIRCLE DIAMETER 60 AT 0 0; CIRCLE DIAMETER 20 AT 0 0; SLOT 10 4 AT 14 -2",
            disc(60.0) - disc(20.0) - slot(10.0, 4.0),
        ),
    ] {
        let mut s = SketchSession::new();
        run(&mut s, &format!("SKETCH P 2D {plane}\n{commands}\nGENERATE FACES"));
        near(area(&mut s), expected);
        run(&mut s, "EXTRUDE 8");
        near(volume(&mut s, "P"), 8.0 * expected);
        let mut again = SketchSession::new();
        run(&mut again, &script(s.object("P").unwrap()));
        assert_eq!(volume(&mut again, "P").to_bits(), volume(&mut s, "P").to_bits());
    }
}

#[test]
fn their_numbers_move_them() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH P 2D XY\nRECTANGLE 80 50\nVARIABLE D 9\nCIRCLE DIAMETER D AT \"WIDTH1/2\" 25\nGENERATE FACES\nEXTRUDE 8",
    );
    near(volume(&mut s, "P"), 8.0 * (4000.0 - disc(9.0)));
    let centroid = |s: &mut SketchSession| s.objects()[0].centroid.unwrap();
    near(centroid(&mut s).x, 40.0);
    run(&mut s, "SET D 20; SET WIDTH1 100");
    near(volume(&mut s, "P"), 8.0 * (5000.0 - disc(20.0)));
    // The circle stays in the middle.
    near(centroid(&mut s).x, 50.0);
    near(centroid(&mut s).y, 25.0);
    run(&mut s, "UNDO 2");
    near(volume(&mut s, "P"), 8.0 * (4000.0 - disc(9.0)));
}

#[test]
fn a_flange_in_six_statements() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH F 2D XY\nCIRCLE DIAMETER 120 AT 0 0\nGENERATE FACES\nEXTRUDE 12\n\
         HOLE F 40 AT 0 0 INTO G\nHOLE G 11 AT 45 0 COUNTERBORE 18 6 POLAR 8 45 INTO H",
    );
    let drilled = disc(40.0) * 12.0 + 8.0 * (disc(11.0) * 6.0 + disc(18.0) * 6.0);
    near(volume(&mut s, "H"), disc(120.0) * 12.0 - drilled);
    run(&mut s, "USING H");
    let count = s.numbers("H").unwrap().into_iter().find(|n| n.0.starts_with("COUNT")).unwrap().0;
    run(&mut s, &format!("SET {count} 4"));
    let drilled = disc(40.0) * 12.0 + 4.0 * (disc(11.0) * 6.0 + disc(18.0) * 6.0);
    near(volume(&mut s, "H"), disc(120.0) * 12.0 - drilled);
}

#[test]
fn random_plates() {
    let mut random = Random::new(21);
    for _ in 0..rounds(12, 1_000) {
        let whole = |random: &mut Random, low: usize, high: usize| {
            (low + random.below(high - low + 1)) as f64
        };
        let (w, h) = (whole(&mut random, 60, 120), whole(&mut random, 40, 80));
        let (d, n) = (whole(&mut random, 4, 16), whole(&mut random, 3, 12));
        let (l, b) = (whole(&mut random, 14, 30), whole(&mut random, 4, 12));
        let x0 = whole(&mut random, 0, 60) - 30.0;
        let mut s = SketchSession::new();
        run(
            &mut s,
            &format!(
                "SKETCH P 2D XY\nRECTANGLE {w} {h} AT {x0} 0\nCIRCLE DIAMETER {d} AT {} 10\n\
                 POLYGON {n} {d} AT {} 28\nSLOT {l} {b} AT {} 4\nGENERATE FACES\nEXTRUDE 5",
                x0 + 10.0,
                x0 + 10.0,
                x0 + 25.0,
            ),
        );
        near(volume(&mut s, "P"), 5.0 * (w * h - disc(d) - polygon(n, d) - slot(l, b)));
    }
}

#[test]
fn what_is_no_shape_is_refused() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XY\nRECTANGLE 80 50\nSKETCH Q");
    for (command, why) in [
        ("RECTANGLE 80 50", "not a cross section"),
        ("USING P; RECTANGLE 0 5", "a width of 0"),
        ("USING P; SLOT 5", "expected a value"),
        ("USING P; POLYGON 2 30", "2 corners"),
        ("USING P; POLYGON 6 30 AT \"NOPE\" 0", "which has no value"),
        ("USING P; CIRCLE DIAMETER 5 AT 1", "expected a value"),
    ] {
        let text = refused(&mut s, command);
        assert!(text.contains(why), "{command}: {text}");
    }
    assert_eq!(s.object("P").unwrap().drawing.points.len(), 4);
}
