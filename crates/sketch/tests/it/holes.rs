//! HOLE against closed forms, its copies, its numbers and its text.

use crate::treatments::{cuboid_session, derivatives, near, refused, run, volume};
use moldloft_brep::Brep;
use moldloft_sketch::{Files, SketchSession, script};
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

fn disc(diameter: f64) -> f64 {
    PI * diameter * diameter / 4.0
}

#[test]
fn every_form_of_a_hole() {
    let plate = [80.0, 50.0, 8.0];
    let whole: f64 = plate.iter().product();
    let cone = PI / 3.0 * 3.0 * (7.5 * 7.5 + 7.5 * 4.5 + 4.5 * 4.5);
    let cases = [
        ("HOLE A 9 AT 10 12 INTO B", disc(9.0) * 8.0),
        ("HOLE A 9 AT 10 12 FROM BOTTOM Z INTO B", disc(9.0) * 8.0),
        ("HOLE A 9 AT 10 12 DEPTH 5 INTO B", disc(9.0) * 5.0),
        ("HOLE A 4 AT 10 4 FROM TOP X DEPTH 30 INTO B", disc(4.0) * 30.0),
        ("HOLE A 4 AT 10 4 FROM BOTTOM Y INTO B", disc(4.0) * 50.0),
        ("HOLE A 9 AT 20 12 COUNTERBORE 15 3 INTO B", disc(9.0) * 5.0 + disc(15.0) * 3.0),
        (
            "HOLE A 9 AT 20 12 FROM BOTTOM Z COUNTERBORE 15 3 INTO B",
            disc(9.0) * 5.0 + disc(15.0) * 3.0,
        ),
        ("HOLE A 9 AT 20 12 COUNTERSINK 15 90 INTO B", disc(9.0) * 5.0 + cone),
        ("HOLE A 9 AT 20 12 FROM BOTTOM Z COUNTERSINK 15 90 INTO B", disc(9.0) * 5.0 + cone),
        ("HOLE A 9 AT 20 12 DEPTH 6 COUNTERBORE 15 3 INTO B", disc(9.0) * 3.0 + disc(15.0) * 3.0),
        ("HOLE A 5 AT 10 10 LINEAR 4 20 0 LINEAR 3 0 15 INTO B", 12.0 * disc(5.0) * 8.0),
        ("HOLE A 5 AT 60 25 POLAR 6 60 THROUGH 40 25 INTO B", 6.0 * disc(5.0) * 8.0),
        // An axis in a corner of the plate, and one in a side.
        ("HOLE A 9 AT 0 0 INTO B", disc(9.0) * 8.0 / 4.0),
        ("HOLE A 9 AT 40 0 INTO B", disc(9.0) * 8.0 / 2.0),
    ];
    for (command, removed) in cases {
        let mut s = cuboid_session(plate);
        run(&mut s, command);
        near(volume(&mut s, "B"), whole - removed);
        // The same from its text.
        let text = script(s.object("B").unwrap());
        let mut again = SketchSession::new();
        run(&mut again, &text);
        assert_eq!(volume(&mut again, "B").to_bits(), volume(&mut s, "B").to_bits(), "{text}");
    }
}

#[test]
fn holes_in_a_row_on_one_line_and_level() {
    let mut random = Random::new(9);
    for _ in 0..rounds(12, 1_000) {
        let number = |random: &mut Random, low: usize, high: usize| {
            (low + random.below(high - low + 1)) as f64
        };
        let size =
            [number(&mut random, 60, 120), number(&mut random, 40, 80), number(&mut random, 4, 20)];
        let mut s = cuboid_session(size);
        let (d, y) = (number(&mut random, 4, 12), number(&mut random, 10, 30));
        let count = 2 + random.below(3);
        let step = d + number(&mut random, 1, 4);
        run(&mut s, &format!("HOLE A {d} AT 10 {y} INTO B"));
        // One after another at the same level, whole numbers.
        for k in 1..count {
            run(&mut s, &format!("HOLE B {d} AT {} {y} INTO B", 10.0 + step * k as f64));
        }
        let whole: f64 = size.iter().product();
        near(volume(&mut s, "B"), whole - count as f64 * disc(d) * size[2]);
        // As a pattern it is the same body.
        run(&mut s, &format!("HOLE A {d} AT 10 {y} LINEAR {count} {step} 0 INTO C"));
        near(volume(&mut s, "C"), whole - count as f64 * disc(d) * size[2]);
    }
}

#[test]
fn its_numbers_are_numbers_of_the_part() {
    let mut s = cuboid_session([80.0, 50.0, 8.0]);
    run(&mut s, "HOLE A 9 AT 20 12 COUNTERBORE 15 3 INTO B");
    let names: Vec<String> = s.numbers("B").unwrap().into_iter().map(|n| n.0).collect();
    let named = |stem: &str| names.iter().find(|n| n.starts_with(stem)).unwrap().clone();
    let (hole, bore, seat) = (named("HOLE"), named("BORE"), named("SEAT"));
    derivatives(&mut s, "B", &[&hole, &bore, &seat, "D3"]);
    // The drill follows the plate: it is through at any thickness.
    run(&mut s, "USING B; SET D3 200");
    near(volume(&mut s, "B"), 80.0 * 50.0 * 200.0 - disc(9.0) * 197.0 - disc(15.0) * 3.0);
    run(&mut s, &format!("SET {hole} 12"));
    near(volume(&mut s, "B"), 80.0 * 50.0 * 200.0 - disc(12.0) * 197.0 - disc(15.0) * 3.0);
}

#[test]
fn what_is_no_hole_is_refused() {
    let mut s = cuboid_session([80.0, 50.0, 8.0]);
    for (command, why) in [
        ("HOLE A 0 AT 10 10", "diameter of a hole is 0"),
        ("HOLE A 9 AT 10 10 DEPTH -1", "depth of a hole is -1"),
        ("HOLE A 9 AT 10 10 COUNTERBORE 9 3", "no wider than the hole"),
        ("HOLE A 9 AT 10 10 COUNTERSINK 15 180", "below 180 degrees"),
        ("HOLE A 9 AT 10 10 DEPTH 2 COUNTERBORE 15 3", "deeper than the hole"),
        ("HOLE A 9 AT 200 10", "beside the body"),
        ("HOLE A 9 AT 10 10 LINEAR 2.5 20 0", "2.5 copies"),
        ("HOLE A 9 10 10", "expected AT"),
        ("HOLE A 9 AT 10 10 FROM L1", "TOP axis or BOTTOM axis"),
        ("HOLE Q 9 AT 10 10", "no object Q"),
    ] {
        let text = refused(&mut s, command);
        assert!(text.contains(why), "{command}: {text}");
    }
    assert_eq!(s.names(), ["A"]);
}

/// A host whose STEP files hold the volume of the boundary alone.
struct VolumeOnly;

impl Files for VolumeOnly {
    fn read(&self, _: &str) -> Result<String, String> {
        Err("no files".into())
    }
    fn step(&self, brep: &Brep, _: &str, _: f64) -> Result<Vec<u8>, String> {
        let volume = brep.volume().ok_or("no volume")?;
        Ok(format!("{} {}", volume.volume, brep.faces.len()).into_bytes())
    }
}

/// A blind hole in a disc whose edge is in far longer pieces: the written boundary has its floor.
#[test]
fn small_features_of_large_parts_are_written() {
    let mut random = Random::new(71);
    for _ in 0..rounds(10, 400) {
        let (outer, thick) = (random.between(50.0, 500.0), random.between(5.0, 50.0));
        let d = outer * 10f64.powf(random.between(-3.0, -0.8));
        let depth = (d * 10f64.powf(random.between(-2.5, 0.0))).min(0.8 * thick);
        let [x, y] = [0, 1].map(|_| random.between(-0.3, 0.3) * (outer - d));
        let wide = 1.5 * d;
        let sunk = PI / 3.0 * 0.25 * d * (0.75 * 0.75 + 0.75 * 0.5 + 0.25) * d * d;
        let forms = [
            (format!("DEPTH {depth}"), disc(d) * depth, 5),
            (
                format!("COUNTERBORE {wide} {depth}"),
                disc(d) * thick + (disc(wide) - disc(d)) * depth,
                6,
            ),
            (format!("COUNTERSINK {wide} 90"), disc(d) * (thick - 0.25 * d) + sunk, 5),
        ];
        for (form, removed, faces) in forms {
            if form.starts_with("COUNTERSINK") && 0.25 * d >= thick {
                continue;
            }
            let mut s = SketchSession::with_files(Box::new(VolumeOnly));
            run(
                &mut s,
                &format!(
                    "SKETCH A 2D XY; SET UNITS MM; CIRCLE DIAMETER {outer} AT 0 0; GENERATE FACES; \
                     EXTRUDE {thick}; HOLE A {d} AT {x} {y} {form} INTO B"
                ),
            );
            let whole = disc(outer) * thick - removed;
            near(volume(&mut s, "B"), whole);
            let replies = s.run_line("EXPORT STEP B b.step");
            let file = replies.iter().find_map(|r| r.file.clone());
            let file = file.unwrap_or_else(|| {
                panic!("{outer} {thick} {d} {depth} {x} {y} {form}: {replies:?}")
            });
            let text = String::from_utf8(file.bytes).unwrap();
            let (found, count) = text.split_once(' ').unwrap();
            near(found.parse().unwrap(), whole);
            assert_eq!(count.parse::<usize>(), Ok(faces), "{form}");
        }
    }
}

/// The volume of a body, which may touch itself.
fn measured(s: &mut SketchSession, name: &str) -> f64 {
    s.objects().into_iter().find(|o| o.name == name).and_then(|o| o.volume).unwrap()
}

/// Holes in a step, also across its edges, from above and below.
#[test]
fn holes_are_cuts_by_cylinders() {
    let mut random = Random::new(41);
    for round in 0..rounds(20, 1_000) {
        let mut whole = |low: usize, high: usize| (low + random.below(high - low + 1)) as f64;
        let (w, h, depth) = (whole(30, 60), whole(10, 30), whole(20, 40));
        let (step, low) = (whole(8, 20), whole(3, 8));
        let body = format!(
            "SKETCH A 2D XZ; POINT 1 0 0; POINT 2 60 0; POINT 3 60 9; POINT 4 20 9; POINT 5 20 30; POINT 6 0 30\n\
             POLYLINE 1 2 3 4 5 6 CLOSE; DIM X 1 2 {w}; DIM X 1 4 {step}; DIM Z 2 3 {low}; DIM Z 1 6 {h}\n\
             EXTRUDE A {depth}\n"
        );
        let (d, x, y) = (whole(2, 9), whole(0, 60), whole(0, 40));
        let (dx, dy) = (whole(0, 15), whole(0, 15));
        let top = whole(0, 1) > 0.0;
        let deep = if whole(0, 1) > 0.0 { Some(whole(1, 30)) } else { None };
        let text = deep.map_or(String::new(), |t| format!("DEPTH {t} "));
        let side = if top { "TOP" } else { "BOTTOM" };
        let long = deep.unwrap_or(h + 2.0);
        let z = match (top, deep) {
            (true, Some(t)) => h - t,
            (false, Some(_)) => 0.0,
            _ => -1.0,
        };
        let mut cut = SketchSession::new();
        run(&mut cut, &body);
        for (k, name) in ["P", "Q"].iter().enumerate() {
            let (x, y) = (x + k as f64 * dx, y + k as f64 * dy);
            let from = ["A", "P"][k];
            let tool = format!(
                "SKETCH C{k} 2D XY; CIRCLE DIAMETER {d} AT {x} {y}; EXTRUDE C{k} {long}\n\
                 MOVE C{k} 0 0 {z}; CUT {from} C{k} INTO {name}"
            );
            run(&mut cut, &tool);
        }
        let expected = measured(&mut cut, "Q");
        let mut s = SketchSession::new();
        run(&mut s, &body);
        let whole = measured(&mut s, "A");
        let hole = format!("HOLE A {d} AT {x} {y} FROM {side} Z {text}LINEAR 2 {dx} {dy} INTO B");
        if (whole - expected).abs() < 1e-9 * whole {
            assert!(refused(&mut s, &hole).contains("beside the body"), "{round}: {body}{hole}");
            continue;
        }
        run(&mut s, &hole);
        let found = measured(&mut s, "B");
        assert!(
            (found - expected).abs() < 1e-10 * whole,
            "{round}: {found} {expected}\n{body}{hole}"
        );
    }
}
