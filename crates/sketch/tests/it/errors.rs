//! Every error of the table (manual, appendix E) that a user can cause: its code, its text with
//! fault, position and next step, and that it changes nothing.

use crate::common::*;
use moldloft_sketch::*;
use std::collections::BTreeMap;

struct Shelf(BTreeMap<&'static str, String>);

impl Files for Shelf {
    fn read(&self, name: &str) -> Result<String, String> {
        self.0.get(name).cloned().ok_or_else(|| "no such file".to_owned())
    }
}

/// A disc that another one touches from inside.
fn touching_discs() -> String {
    "0\nSECTION\n0\nCIRCLE\n10\n0\n20\n0\n40\n4\n0\nCIRCLE\n10\n2\n20\n0\n40\n2\n0\nEOF\n"
        .to_owned()
}

fn many_lines() -> String {
    let mut text = String::from("0\nSECTION\n");
    for k in 0..6_000 {
        let (a, b) = (2 * k, 2 * k + 1);
        text.push_str(&format!("0\nLINE\n10\n{a}\n20\n0\n11\n{b}\n21\n{}\n", k % 7));
    }
    text + "0\nEOF\n"
}

pub fn session() -> SketchSession {
    let files = Shelf(BTreeMap::from([
        ("broken.json", "{\"format\": \"sketch\"".to_owned()),
        ("broken.dxf", "LINE\n".to_owned()),
        ("empty.dxf", "0\nSECTION\n0\nEOF\n".to_owned()),
        ("large.dxf", many_lines()),
        ("touching.dxf", touching_discs()),
        ("far.dxf", "0\nSECTION\n0\nLINE\n10\n0\n20\n0\n11\n3e9\n21\n0\n0\nEOF\n".to_owned()),
        ("again.skt", "RUN \"again.skt\"\n".to_owned()),
        ("two.skt", "SKETCH P\nSKETCH Q\n".to_owned()),
    ]));
    SketchSession::with_files(Box::new(files))
}

fn image(s: &mut SketchSession) -> (String, Option<String>) {
    (crate::common::all_commands(s), s.active_object().map(|o| o.name.clone()))
}

pub const SQUARE: &str = "SKETCH A 2D XY; POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; POINT 4 0 9
    POLYLINE 1 2 3 4 CLOSE";

/// A box whose top is drawn oblique, so that each of its corners has its own height.
pub const PRISM: &str = "SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
POLYLINE 1 2 3 4 CLOSE; DIM W X 1 2 8; DIM H Z 1 4 2; EXTRUDE 5";

pub const LOOSE_TOP: &str = "SKETCH A
    POINT 1 0 0; POINT 2 97 -26; POINT 3 173 38; POINT 4 77 64
    POINT 5 0 100; POINT 6 97 74; POINT 7 173 138; POINT 8 77 164
    LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Y; LINE 3 3 4 TYPE X; LINE 4 4 1 TYPE Y
    LINE 5 1 5 TYPE Z; LINE 6 2 6 TYPE Z; LINE 7 3 7 TYPE Z; LINE 8 4 8 TYPE Z
    LINE 9 5 6 TYPE O; LINE 10 6 7 TYPE O; LINE 11 7 8 TYPE O; LINE 12 8 5 TYPE O
    DIM W X 1 2 = 4; DIM D Y 1 4 = 3
    DIM H5 Z 1 5 = 2; DIM H6 Z 2 6 = 2; DIM H7 Z 3 7 = 2; DIM H8 Z 4 8 = 2
    GENERATE FACES";

/// Code, preparation, command, and a part of the reply.
pub const TABLE: &[(u16, &str, &str, &str)] = &[
    (101, "SKETCH A", "CONVERT", "A has no points"),
    (101, "SKETCH A", "LINE 1 2", "points"),
    (102, "SKETCH A; POINT 1 0 0", "CONVERT", "A has no lines"),
    (102, "SKETCH A", "IMPORT \"empty.dxf\"", "no lines"),
    (105, SQUARE, "DIM 1 3 5", "axis is unknown"),
    (105, SQUARE, "DELETE CURVE C1", "A has no curves"),
    (110, "SKETCH WALL", "USING WAL", "WAL"),
    (110, "SKETCH WALL", "DELETE WAL", "WAL"),
    (110, "", "INPUT \"two.skt\" INTO R", "2 objects"),
    (112, "", "LIST POINTS", "no object is active"),
    (112, "SKETCH A; ERASE ALL", "EXPORT SVG", "nothing is displayed"),
    (113, SQUARE, "SKETCH A 2D XZ", "cannot change"),
    (113, "SKETCH A; POINT 1 0 0", "EXTRUDE 5", "not a cross section"),
    (114, SQUARE, "MERGE A C", "cross section"),
    (191, "SKETCH A", "MERGE A", "usage: MERGE"),
    (192, "SKETCH A; SKETCH B", "MERGE A B INT C", "misspelt"),
    (200, "SKETCH A 2D XY; IMPORT \"large.dxf\"", "EXTRUDE 5", "at most"),
    (300, SQUARE, "LINE 1 1", "no length"),
    (300, SQUARE, "WELD 1 1", "point 1"),
    (310, LOOSE_TOP, "ARC R CORNER 1 2 4 RADIUS 9", "too large"),
    (
        396,
        "SKETCH A 2D XY; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2; DIM X 1 2 5",
        "DIM X 1 2 6",
        "differs by 1",
    ),
    (398, "SKETCH A; POINT 1 0 0; POINT 2 9 0", "DIM X 1 2 5", "no planes on axis X"),
    (399, "", "INPUT \"broken.json\"", "not a sketch"),
    (399, "", "IMPORT \"broken.dxf\"", "not a DXF"),
    (
        400,
        "SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; POINT 4 0 9; LINE 1 1 2 TYPE X
         LINE 2 2 3 TYPE Z; LINE 3 3 4 TYPE Z; LINE 4 4 1 TYPE Z",
        "CONVERT",
        "1-2 (X) cannot run along X",
    ),
    (
        401,
        "SKETCH A; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2 TYPE X; POINT 3 5 5",
        "CONVERT",
        "point 3",
    ),
    (402, "SKETCH A; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2 TYPE NONE", "CONVERT", "1-2"),
    (404, SQUARE, "CONVERT", "X: 1, Y: 1, Z: 0"),
    (404, SQUARE, "MEASURE", "not fully dimensioned"),
    (405, "SKETCH A", "AXES 0 1 2 SCALE 0 1 1", "scale"),
    (406, SQUARE, "TYPE 1 AS Q", "Q"),
    (
        411,
        "SKETCH A 2D XY; POINT 1 0 0; POINT 2 9 3; LINE 1 1 2 TYPE F; DIM X 1 2 5",
        "DIM L LENGTH 1 3",
        "cannot be satisfied",
    ),
    (600, "SKETCH A", "SAVE AS ''", "cannot write"),
    (600, "SKETCH A", "INPUT \"none.skt\"", "no such file"),
    (600, PRISM, "EXPORT STEP", "not written here"),
    (600, PRISM, "EXPORT STL a.obj", "would not be OBJ"),
    (701, PRISM, "FILLET A 9 EDGES ALL", "leaves the face"),
    (701, PRISM, "SHELL A 0", "a wall of 0 is none"),
    (701, PRISM, "DRAFT A X 1 FACES TOP X", "square to X"),
    (114, "SKETCH A 2D XY; POINT 1 0 0; POINT 2 9 3; LINE 1 1 2", "SHELL A 1", "cross section"),
    (
        701,
        "SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Z
           DIM X 1 2 3; DIM Z 2 3 3; REFERENCE 1 0 0 0",
        "GENERATE FACES",
        "no solid",
    ),
    (702, SQUARE, "CHOOSE 1", "nothing to choose"),
];

#[test]
fn every_error_of_the_table() {
    for &(code, before, command, says) in TABLE {
        let mut s = session();
        for reply in s.run_text(before) {
            assert!(!reply.is_error(), "{code}, before {command}: {}", reply.text);
        }
        let was = image(&mut s);
        let replies = s.run_line(command);
        let reply = replies.iter().find(|r| r.is_error());
        let reply = reply.unwrap_or_else(|| panic!("{code}: {command} was accepted: {replies:?}"));
        assert_eq!(reply.code, Some(code), "{command}: {}", reply.text);
        assert!(reply.text.contains(says), "{command}: {}", reply.text);
        assert!(reply.next.as_ref().is_some_and(|n| !n.is_empty()), "{command}");
        assert!(!reply.text.ends_with('.') && !reply.text.contains("invalid"), "{}", reply.text);
        assert_eq!(was, image(&mut s), "{command} changed something");
    }
}

/// 700 and 703 need a state of their own; 702 offers a choice.
#[test]
fn errors_about_faces() {
    let mut s = session();
    s.run_text(LOOSE_TOP);
    assert!((s.objects()[0].volume.unwrap() - 24.0).abs() < 1e-9);
    let replies = s.run_line("SET H7 3");
    let reply = replies.iter().find(|r| r.code == Some(703)).expect("a face that is bent");
    assert!(reply.text.contains("no longer plane (off by"), "{}", reply.text);
    assert!(reply.next.is_some());
    // It is measured as the triangles that are written.
    let o = s.objects().remove(0);
    let mesh = o.solid.as_ref().unwrap().mesh(1.0);
    assert!(mesh.report().closed);
    assert!((o.volume.unwrap() - 26.0).abs() <= 2.0 + 1e-9, "{:?}", o.volume);
    s.run_line("SET H7 2");
    let mut s = session();
    s.insert(case_named("T1 ").object);
    s.run_line("GENERATE FACES ASK");
    s.run_line("ACCEPT");
    let refused = (0..12).any(|_| {
        let reversed = s.run_line("REVERSE").into_iter().any(|r| r.code == Some(700));
        s.run_line("REJECT");
        reversed
    });
    assert!(refused);
}

/// Numbers in lines (T16d) and words.
#[test]
fn faults_of_the_text() {
    for (line, says) in [
        ("DIM W X 1.2.3 4", "two decimal points in 1.2.3"),
        ("DIM W X 12-3 4", "misplaced hyphen"),
        ("DIM W X 1A2 4", "letter A inside"),
        ("SAVE \"x", "no partner"),
        ("SET W 99", "outside its range"),
    ] {
        let mut s = session();
        s.run_text(SQUARE);
        s.run_line("DIM W X 1 2 = 5 IN 1 9");
        let was = image(&mut s);
        let reply = s.run_line(line).into_iter().find(CommandReply::is_error).expect(line);
        assert!(reply.text.contains(says) && reply.next.is_some(), "{}", reply.text);
        assert_eq!(was, image(&mut s));
    }
}

/// Changes by a file before its refusal are undone, in the journal too.
#[test]
fn a_refused_file_leaves_nothing() {
    let mut s = session();
    s.run_line("SKETCH KEEP");
    let was = (image(&mut s), s.journal().to_vec());
    let replies = s.run_line("INPUT \"two.skt\" INTO R");
    assert!(replies.iter().any(CommandReply::is_error));
    assert_eq!((image(&mut s), s.journal().to_vec()), was);
    assert!(s.run_line("UNDO; UNDO").iter().any(CommandReply::is_error), "one step only");
}

/// The journal of any session makes its state again: questions, answers, steps back and files included.
#[test]
fn journals_restore_sessions() {
    let scripts = [
        "SKETCH A; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2; DIM W X 1 2\nYES\nUNDO\nREDO",
        "RUN \"two.skt\"\nUSING P\nPOINT 1 1 1\nUNDO 2\nREDO",
        "SKETCH A 2D XY; IMPORT \"large.dxf\"; SET SKETCH83 ON; SHOW LABELS OFF",
    ];
    let replay = |from: &SketchSession| {
        let mut s = SketchSession::new();
        for line in from.journal() {
            let bad = s.run_line(line).into_iter().find(CommandReply::is_error);
            assert!(bad.is_none(), "{line}: {bad:?}");
        }
        s
    };
    for text in scripts {
        let mut s = session();
        s.run_text(text);
        let mut again = replay(&s);
        assert_eq!(image(&mut s), image(&mut again), "{text}");
    }
    let mut s = session();
    s.run_text(LOOSE_TOP);
    s.run_text(
        "GENERATE FACES ASK\nACCEPT\nREJECT\nREPEAT\nACCEPT\nACCEPT\nACCEPT\nACCEPT\nACCEPT",
    );
    let mut again = replay(&s);
    assert_eq!(image(&mut s), image(&mut again));
    assert_eq!(s.asks(), again.asks());
}

/// The reference in the documentation is the one of the table of verbs.
#[test]
fn the_command_reference_is_documented() {
    let docs = include_str!("../../../../docs/sketch.md");
    let reference = command::verbs::reference();
    assert!(docs.contains(reference.trim()), "paste this into docs/sketch.md:\n{reference}");
}

/// The tutorial runs as written.
#[test]
fn the_tutorial_runs() {
    let docs = include_str!("../../../../docs/sketch.md");
    let mut s = SketchSession::new();
    let mut blocks = 0;
    for block in docs.split("```sketch\n").skip(1) {
        blocks += 1;
        for line in block.split("```").next().unwrap_or("").lines() {
            for reply in s.run_line(line) {
                assert!(!reply.is_error(), "{line}: {}", reply.text);
            }
        }
    }
    assert!(blocks >= 6);
    let volume = |s: &mut SketchSession, name: &str| {
        s.objects().into_iter().find(|o| o.name == name).and_then(|o| o.volume)
    };
    // 1.6 * 6 wide at the foot, 6 high, 4 long.
    assert!((volume(&mut s, "WEDGE").unwrap() - 0.5 * 9.6 * 6.0 * 4.0).abs() < 1e-9);
    let whole = volume(&mut s, "FLOOR").unwrap();
    let left = volume(&mut s, "PIECE").unwrap();
    assert!(left < whole && left > 0.5 * whole, "{left} of {whole}");
    // Each object is made again, bit for bit, by its own file; and the same script gives the same bits.
    let text = crate::common::all_commands(&s);
    let mut again = SketchSession::new();
    assert!(again.run_text(&text).iter().all(|r| !r.is_error()));
    assert_eq!(image(&mut s).0, image(&mut again).0);
    assert_eq!(s.objects_json(), again.objects_json());
}
