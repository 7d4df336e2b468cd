//! UNION, CUT, COMMON: closed forms, parameters kept, refusals.

use crate::common::*;
use moldloft_sketch::*;

fn run(s: &mut SketchSession, text: &str) -> Vec<CommandReply> {
    let replies = s.run_text(text);
    let errors: Vec<&CommandReply> = replies.iter().filter(|r| r.is_error()).collect();
    assert!(errors.is_empty(), "{text}: {errors:?}");
    replies
}

fn boxes(places: &[(&str, [f64; 3], [f64; 3])]) -> SketchSession {
    let mut s = SketchSession::new();
    for &(name, size, at) in places {
        s.insert(with_faces(cuboid(size)));
        run(&mut s, &format!("RENAME A TO {name}; MOVE {name} {} {} {}", at[0], at[1], at[2]));
    }
    s
}

fn check(s: &mut SketchSession, name: &str, volume: f64, area: f64) {
    let o = s.objects().into_iter().find(|o| o.name == name).unwrap();
    assert!((o.volume.unwrap() - volume).abs() < 1e-9 * volume, "{:?} for {volume}", o.volume);
    assert!((o.area.unwrap() - area).abs() < 1e-9 * area, "{:?} for {area}", o.area);
    let report = o.solid.unwrap().mesh(1.0).report();
    assert!(report.closed && report.outward == Some(true), "{report:?}");
}

#[test]
fn overlapping_boxes() {
    let two =
        || boxes(&[("B1", [4.0, 3.0, 2.0], [0.0; 3]), ("B2", [4.0, 3.0, 2.0], [2.0, 1.0, 1.0])]);
    let mut s = two();
    run(&mut s, "UNION B1 B2 INTO U; CUT B1 B2 INTO D; COMMON B1 B2 INTO K");
    // Common part 2 x 2 x 1.
    check(&mut s, "K", 4.0, 16.0);
    check(&mut s, "U", 44.0, 2.0 * 52.0 - 16.0);
    check(&mut s, "D", 20.0, 52.0);
    // The operands are as they were.
    check(&mut s, "B1", 24.0, 52.0);
    // The result is parametric: every dimension of both drives it.
    let dims: Vec<String> = s.numbers("U").unwrap().into_iter().map(|row| row.0).collect();
    assert_eq!(dims, ["B1.D1", "B1.D2", "B1.D3", "B2.D1", "B2.D2", "B2.D3"]);
    let mut s = two();
    run(&mut s, "UNION B1 B2");
    check(&mut s, "B1", 44.0, 88.0);
}

#[test]
fn a_hole_a_pocket_and_a_cavity() {
    let mut s = boxes(&[
        ("BLOCK", [6.0, 6.0, 2.0], [0.0; 3]),
        ("DRILL", [2.0, 2.0, 6.0], [2.0, 2.0, -2.0]),
        ("SUNK", [2.0, 2.0, 6.0], [2.0, 2.0, 1.0]),
        ("INNER", [1.0, 1.0, 1.0], [2.5, 2.5, 0.5]),
    ]);
    run(&mut s, "CUT BLOCK DRILL INTO H; CUT BLOCK SUNK INTO P; CUT BLOCK INNER INTO C");
    check(&mut s, "H", 64.0, 120.0 - 8.0 + 16.0);
    check(&mut s, "P", 68.0, 120.0 + 8.0);
    check(&mut s, "C", 71.0, 126.0);
    assert_eq!(s.solid("H").unwrap().faces.len(), 10);
    // The hole follows the drill's own dimensions, though the drill's corners are gone.
    run(&mut s, "USING H; SET DRILL.D1 1");
    check(&mut s, "H", 68.0, 120.0 - 4.0 + 12.0);
    run(&mut s, "SET BLOCK.D3 3");
    check(&mut s, "H", 102.0, 2.0 * 36.0 + 72.0 - 4.0 + 18.0);
}

#[test]
fn touching_and_oblique_bodies() {
    // Coincident faces: the wall between them disappears.
    let mut s = boxes(&[("L", [2.0, 3.0, 2.0], [0.0; 3]), ("R", [2.0, 3.0, 2.0], [2.0, 0.0, 0.0])]);
    run(&mut s, "UNION L R INTO U");
    check(&mut s, "U", 24.0, 2.0 * (12.0 + 8.0 + 6.0));
    assert_eq!(s.solid("U").unwrap().faces.len(), 6);
    // A pyramid through a plate: oblique lines, closed form by similar sections.
    let mut s = SketchSession::new();
    let mut pyramid = case_named("T8").object;
    pyramid.name = "PYR".into();
    s.insert(with_faces(pyramid));
    s.insert(with_faces(cuboid([6.0, 4.0, 2.5])));
    run(&mut s, "COMMON PYR A INTO F; CUT PYR A INTO TIP; UNION PYR A INTO ALL");
    let volume = |s: &mut SketchSession, n: &str| {
        s.objects().into_iter().find(|o| o.name == n).unwrap().volume
    };
    let close = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 1e-9, "{a:?} for {b}");
    close(volume(&mut s, "F"), 35.0);
    close(volume(&mut s, "TIP"), 5.0);
    close(volume(&mut s, "ALL"), 65.0);
}

#[test]
fn what_cannot_be_combined_is_refused() {
    let mut s = boxes(&[("L", [2.0, 3.0, 2.0], [0.0; 3]), ("R", [2.0, 3.0, 2.0], [9.0, 0.0, 0.0])]);
    let mut code = |line: &str, code: Option<u16>| {
        let before = s.objects().len();
        let reply = s.run_line(line).into_iter().find(CommandReply::is_error);
        let reply = reply.unwrap_or_else(|| panic!("{line} was accepted"));
        assert_eq!(reply.code, code, "{line}: {}", reply.text);
        assert_eq!(s.objects().len(), before);
    };
    code("COMMON L R INTO K", Some(701));
    code("UNION L Q", Some(110));
    code("UNION L L", None);
    code("UNION L", None);
    run(&mut s, "SKETCH FLAT 2D XY; POINT 1 0 0; POINT 2 1 0; LINE 1 2");
    assert_eq!(s.run_line("CUT L FLAT").pop().unwrap().code, Some(114));
}
