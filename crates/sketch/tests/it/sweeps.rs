//! SWEEP of sections along chains of lines and arcs, against Pappus's theorem and closed forms.

use crate::common::all_commands;
use crate::treatments::{derivatives, near, refused, run, volume};
use moldloft_sketch::SketchSession;
use std::f64::consts::PI;

/// A disc of diameter 6 around the start of an L of a line of 40 up and one of 30 to the right.
const ELBOW: &str = "SKETCH DISC 2D XY\nCIRCLE DIAMETER 6 AT 0 0\nSKETCH WAY 2D XZ\nPOINT 1 0 0; POINT 2 0 40; \
    POINT 3 30 40\nPOLYLINE 1 2 3\nDIM TALL Z 1 2 40; DIM OUT X 2 3 30\n";

#[test]
fn pipes_have_the_volume_of_section_times_way_of_its_centroid() {
    for (more, length) in [
        ("", 70.0),
        ("ARC BEND CORNER 2 RADIUS 10\n", 50.0 + 5.0 * PI),
        ("ARC BEND CORNER 2 RADIUS 30\n", 10.0 + 15.0 * PI),
    ] {
        let mut s = SketchSession::new();
        run(&mut s, &format!("{ELBOW}{more}SWEEP DISC ALONG WAY INTO PIPE"));
        near(volume(&mut s, "PIPE"), 9.0 * PI * length);
        // A pipe of an outline with a hole, and one beside its path.
        run(
            &mut s,
            "OFFSET DISC -1 INTO BORE; SWEEP BORE ALONG WAY INTO CORE; CUT PIPE CORE INTO TUBE",
        );
        near(volume(&mut s, "TUBE"), 5.0 * PI * length);
        let mut again = SketchSession::new();
        run(&mut again, &all_commands(&s));
        assert_eq!(volume(&mut again, "TUBE").to_bits(), volume(&mut s, "TUBE").to_bits());
        assert_eq!(all_commands(&again), all_commands(&s));
    }
}

#[test]
fn sweeps_follow_section_and_path() {
    let mut s = SketchSession::new();
    run(&mut s, &format!("{ELBOW}ARC BEND CORNER 2 RADIUS 10\nSWEEP DISC ALONG WAY INTO PIPE"));
    run(&mut s, "USING DISC; SET DIAMETER1 4; SET WAY.TALL 60");
    near(volume(&mut s, "PIPE"), 4.0 * PI * (70.0 + 5.0 * PI));
    derivatives(&mut s, "PIPE", &["DIAMETER1", "WAY.TALL", "WAY.OUT"]);
}

#[test]
fn closed_paths_are_rings() {
    let mut s = SketchSession::new();
    // A square of 3 across a closed path around 60 x 40, with round and with mitred corners.
    run(
        &mut s,
        "SKETCH BAR 2D YZ\nRECTANGLE 3 3 AT -1.5 -1.5\nSKETCH R 2D XY\nRECTANGLE 60 40 AT -30 0",
    );
    run(&mut s, "SWEEP BAR ALONG R INTO FRAME");
    near(volume(&mut s, "FRAME"), 9.0 * 200.0);
    run(
        &mut s,
        "USING R; ARC A CORNER 1 RADIUS 8; ARC B CORNER 2 RADIUS 8; ARC C CORNER 3 RADIUS 8",
    );
    near(volume(&mut s, "FRAME"), 9.0 * (200.0 - 3.0 * 16.0 + 3.0 * 4.0 * PI));
    // Around a circle: the ring of a revolution.
    run(&mut s, "SKETCH O 2D XY\nCIRCLE DIAMETER 50 AT 0 25\nSWEEP BAR ALONG O INTO RING");
    near(volume(&mut s, "RING"), 9.0 * PI * 50.0);
    // Along the border of an offset.
    run(&mut s, "OFFSET R 2 INTO Q; MOVE BAR 0 -2 0; SWEEP BAR ALONG Q INTO SEAM");
    let border = 200.0 - 3.0 * 16.0 + 3.0 * 4.0 * PI + 4.0 * PI;
    near(volume(&mut s, "SEAM"), 9.0 * border);
}

#[test]
fn paths_in_space_turn_as_little_as_possible() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH DISC 2D XY\nCIRCLE DIAMETER 4 AT 0 0\nSKETCH WAY 3D\nAXES 345 40 90\nPOINT 1 0 0; POINT 2 0 50; \
         POINT 3 80 30; POINT 4 120 65\nLINE 1 2 TYPE Z; LINE 2 3 TYPE X; LINE 3 4 TYPE Y\n\
         DIM Z 1 2 30; DIM X 2 3 40; DIM Y 3 4 20\nSWEEP DISC ALONG WAY INTO BENT",
    );
    near(volume(&mut s, "BENT"), 4.0 * PI * 90.0);
    run(&mut s, "USING WAY; ARC A CORNER 2 RADIUS 5; ARC B CORNER 3 RADIUS 6");
    near(volume(&mut s, "BENT"), 4.0 * PI * (90.0 - 22.0 + 5.5 * PI));
}

#[test]
fn sweeps_that_cannot_be_are_refused_with_a_remedy() {
    for (commands, expected) in [
        (
            "USING WAY; ARC B CORNER 2 RADIUS 2; SWEEP DISC ALONG WAY INTO P",
            "too small for the section",
        ),
        ("SWEEP DISC ALONG DISC INTO P", "along itself"),
        ("SWEEP DISC ALONG WAY INTO WAY", "along itself"),
        ("SWEEP WAY ALONG DISC INTO P", "no solid fits these lines"),
        ("SWEEP DISC WAY", "ALONG"),
        ("EXTRUDE DISC 3 INTO E; SWEEP DISC ALONG E INTO P", "no path"),
        ("USING WAY; REFERENCE 1 0 0 5; SWEEP DISC ALONG WAY INTO P", "start across the section"),
        (
            "USING WAY; POINT 4 0 80; LINE 2 4; DIM Z 2 4 20; SWEEP DISC ALONG WAY INTO P",
            "branches at 0 0 40",
        ),
        ("USING WAY; SET TALL 2; SWEEP DISC ALONG WAY INTO P", "wider than a side"),
    ] {
        let mut s = SketchSession::new();
        run(&mut s, ELBOW);
        let text = refused(&mut s, commands);
        assert!(text.contains(expected), "{commands}: {text}");
    }
}
