//! Bodies follow the objects that they are made of: after any changes of numbers and places, a session has the bodies of
//! its commands run afresh, of its text read back, and of the same part drawn with the final numbers.

use crate::treatments::{derivatives, near, refused, run, volume};
use moldloft_sketch::{SketchSession, script};
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;
use std::fmt::Write;

/// A part: its commands, with `{k}` for its numbers, their ranges, the changes of each number, and its name.
struct Family {
    name: &'static str,
    text: &'static str,
    /// Objects and names of the numbers in order, each with a range.
    numbers: &'static [(&'static str, f64, f64)],
}

const FAMILIES: [Family; 6] = [
    Family {
        name: "plate with a drill, a slot and a row of holes",
        text: "SKETCH A 2D XY; RECTANGLE {0} {1}; EXTRUDE A {2}\n\
               SKETCH D 2D XY; CIRCLE DIAMETER {3} AT 0 0; EXTRUDE D 60; MOVE D 15 14 -5\n\
               SKETCH S 2D XY; SLOT {4} {5}; EXTRUDE S 60; MOVE S 30 25 -5\n\
               CUT A D INTO B; CUT B S INTO C; HOLE C {6} AT 60 8 LINEAR 2 14 0 INTO P\n",
        numbers: &[
            ("A.WIDTH1", 90.0, 120.0),
            ("A.HEIGHT1", 50.0, 70.0),
            ("A.D3", 5.0, 20.0),
            ("D.DIAMETER1", 4.0, 9.0),
            ("S.LENGTH1", 20.0, 30.0),
            ("S.WIDTH1", 5.0, 12.0),
            ("P.HOLE1", 3.0, 7.0),
        ],
    },
    Family {
        name: "lug",
        text: "SKETCH M 2D XZ; RECTANGLE {0} {1}; EXTRUDE M {2}\n\
               SKETCH R 2D XZ; CIRCLE DIAMETER 18 AT 0 0; EXTRUDE R \"M.D3\"\n\
               MOVE R \"M.WIDTH1/2\" 0 \"M.HEIGHT1\"\n\
               SKETCH D 2D XZ; CIRCLE DIAMETER {3} AT 0 0; EXTRUDE D 50\n\
               UNION M R INTO L; MOVE D \"M.WIDTH1/2\" -5 \"M.HEIGHT1\"; CUT L D INTO P\n",
        numbers: &[
            ("M.WIDTH1", 20.0, 40.0),
            ("M.HEIGHT1", 25.0, 60.0),
            ("M.D3", 5.0, 30.0),
            ("D.DIAMETER1", 4.0, 15.0),
        ],
    },
    Family {
        name: "flange",
        text: "SKETCH F 2D XY; CIRCLE DIAMETER {0} AT 0 0; EXTRUDE F {1}\n\
               SKETCH H 2D XY; CIRCLE DIAMETER {2} AT 0 0; EXTRUDE H {3}\n\
               UNION F H INTO U; HOLE U {4} AT 0 0 INTO V; HOLE V {5} AT 45 0 POLAR 6 60 INTO P\n",
        numbers: &[
            ("F.DIAMETER1", 110.0, 140.0),
            ("F.D3", 8.0, 20.0),
            ("H.DIAMETER1", 40.0, 60.0),
            ("H.D3", 25.0, 50.0),
            ("V.HOLE1", 15.0, 30.0),
            ("P.HOLE1", 4.0, 10.0),
        ],
    },
    Family {
        name: "turned bush with a keyway",
        text: "SKETCH S 2D XZ; RECTANGLE {0} {1} AT 10 0; REVOLVE S 4 INTO T\n\
               SKETCH K 2D XY; RECTANGLE {2} 40; EXTRUDE K 90; MOVE K 0 0 -1\n\
               CUT T K INTO P\n",
        numbers: &[("S.WIDTH1", 8.0, 20.0), ("S.HEIGHT1", 20.0, 60.0), ("K.WIDTH1", 2.0, 6.0)],
    },
    Family {
        name: "bracket with fillets",
        text: "SKETCH A 2D XY; RECTANGLE {0} {1}; EXTRUDE A {2}\n\
               SKETCH B 2D XY; RECTANGLE {3} 8; SET B.HEIGHT1 \"A.HEIGHT1\"; EXTRUDE B {4}\n\
               UNION A B INTO L; FILLET L {5} EDGES ALONG Y INTO P\n",
        numbers: &[
            ("A.WIDTH1", 50.0, 90.0),
            ("A.HEIGHT1", 20.0, 50.0),
            ("A.D3", 6.0, 12.0),
            ("B.WIDTH1", 6.0, 12.0),
            ("B.D3", 30.0, 60.0),
            ("P.FILLET1", 1.0, 2.5),
        ],
    },
    Family {
        name: "box with a boss",
        text: "SKETCH A 2D XY; RECTANGLE {0} {1}; EXTRUDE A {2}; SHELL A {3} OPEN TOP Z INTO B\n\
               SKETCH C 2D XY; CIRCLE DIAMETER {4} AT 25 22; EXTRUDE C {5}\n\
               UNION B C INTO U; HOLE U {6} AT 25 22 INTO P\n",
        numbers: &[
            ("A.WIDTH1", 50.0, 90.0),
            ("A.HEIGHT1", 44.0, 70.0),
            ("A.D3", 20.0, 40.0),
            ("B.SHELL1", 1.5, 3.0),
            ("C.DIAMETER1", 9.0, 16.0),
            ("C.D3", 8.0, 18.0),
            ("P.HOLE1", 3.0, 8.0),
        ],
    },
];

impl Family {
    fn drawn(&self, values: &[f64]) -> SketchSession {
        let mut text = self.text.to_owned();
        for (k, x) in values.iter().enumerate() {
            text = text.replace(&format!("{{{k}}}"), &x.to_string());
        }
        let mut s = SketchSession::new();
        run(&mut s, &text);
        s
    }

    fn random(&self, random: &mut Random) -> Vec<f64> {
        let within = |r: &mut Random, low: f64, high: f64| {
            let x = low + (high - low) * r.below(1001) as f64 / 1000.0;
            // Whole numbers often: surfaces touch, edges are level.
            if r.below(2) == 0 { x.round() } else { (x * 100.0).round() / 100.0 }
        };
        self.numbers.iter().map(|&(_, low, high)| within(random, low, high)).collect()
    }
}

/// Measures are compared with their own size; centroids are within a hundred of the origin.
fn scale_of(x: f64) -> f64 {
    x.abs().max(100.0)
}

fn bits(s: &mut SketchSession, name: &str) -> Vec<u64> {
    let all = s.objects();
    let data = all.iter().find(|o| o.name == name).unwrap();
    let mass = data.mass.unwrap_or_else(|| panic!("{name} has no body"));
    let centroid = mass.centroid.to_array();
    [mass.volume, mass.area].iter().chain(&centroid).map(|x| x.to_bits()).collect()
}

#[test]
fn a_part_follows_its_tools() {
    let mut random = Random::new(4403);
    for round in 0..rounds(1, 7) {
        for family in &FAMILIES {
            let mut values = family.random(&mut random);
            let mut s = family.drawn(&values);
            // Computed before the changes, so that what is kept would be noticed.
            let first = bits(&mut s, "P");
            for _ in 0..rounds(2, 6) {
                let new = family.random(&mut random);
                for (k, (name, _, _)) in family.numbers.iter().enumerate() {
                    if new[k] != values[k] {
                        run(&mut s, &format!("SET {name} {}", new[k]));
                    }
                }
                values = new;
                let found = bits(&mut s, "P");
                let what = format!("{} {round} {values:?}", family.name);
                assert_ne!(found, first, "{what}");
                let mut journal = SketchSession::new();
                run(&mut journal, &s.journal().join("\n"));
                assert_eq!(bits(&mut journal, "P"), found, "journal: {what}");
                let mut text = SketchSession::new();
                run(&mut text, &script(s.object("P").unwrap()));
                assert_eq!(bits(&mut text, "P"), found, "text: {what}");
                assert_eq!(script(text.object("P").unwrap()), script(s.object("P").unwrap()));
                // A circle alone keeps the corner of the square around it: its centre depends on its first
                // diameter.
                if family.text.contains("CIRCLE") {
                    continue;
                }
                let mut afresh = family.drawn(&values);
                // Drawn at other numbers: other sums of the same, to rounding.
                for (x, y) in bits(&mut afresh, "P").into_iter().zip(found) {
                    let (x, y) = (f64::from_bits(x), f64::from_bits(y));
                    assert!((x - y).abs() <= 1e-12 * scale_of(x), "afresh: {what}: {x} {y}");
                }
            }
        }
    }
}

fn plate() -> SketchSession {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH A 2D XY; RECTANGLE 60 40; EXTRUDE A 8\n\
         SKETCH D 2D XY; CIRCLE DIAMETER 10 AT 0 0; EXTRUDE D 12; MOVE D 20 15 -2\n\
         CUT A D INTO P",
    );
    s
}

const PLATE: f64 = 60.0 * 40.0 * 8.0;

#[test]
fn changes_of_a_tool_reach_the_part() {
    let removed = |s: &mut SketchSession| PLATE - volume(s, "P");
    let mut s = plate();
    near(removed(&mut s), PI * 25.0 * 8.0);
    // The number, by its own name, with the part or the tool active, and a part that follows this part.
    run(&mut s, "SET D.DIAMETER1 12");
    near(removed(&mut s), PI * 36.0 * 8.0);
    run(
        &mut s,
        "USING D; SET DIAMETER1 8; USING P; FILLET P 1 EDGES ALONG Z INTO Q; SET FILLET1 2",
    );
    near(removed(&mut s), PI * 16.0 * 8.0);
    near(volume(&mut s, "Q"), PLATE - PI * 16.0 * 8.0 - 8.0 * (4.0 - PI) * 4.0);
    run(&mut s, "SET A.WIDTH1 70; SET D.DIAMETER1 10");
    near(volume(&mut s, "Q"), 70.0 * 320.0 - PI * 25.0 * 8.0 - 8.0 * (4.0 - PI) * 4.0);
    derivatives(&mut s, "Q", &["D.DIAMETER1", "A.WIDTH1", "FILLET1"]);
    run(&mut s, "SET A.WIDTH1 60");
    // Its place: half of it beside the plate, then inclined.
    run(&mut s, "MOVE D -20 0 0");
    near(removed(&mut s), PI * 25.0 * 8.0 / 2.0);
    run(
        &mut s,
        "MOVE D 20 0 0; ROTATE D X 30 THROUGH 20 15 4; MOVE D 0 10 -20; USING D; SET D3 60",
    );
    let inclined = removed(&mut s);
    near(inclined, PI * 25.0 * 8.0 / (PI / 6.0).cos());
    // Steps of the session.
    run(&mut s, "UNDO 4");
    near(removed(&mut s), PI * 25.0 * 8.0 / 2.0);
    run(&mut s, "REDO 4");
    near(removed(&mut s), inclined);
}

#[test]
fn renamed_copied_and_deleted_tools() {
    let mut s = plate();
    run(&mut s, "COPY D E; RENAME D BIT; SET BIT.DIAMETER1 12; SET E.DIAMETER1 30");
    near(volume(&mut s, "P"), PLATE - PI * 36.0 * 8.0);
    let text = script(s.object("P").unwrap());
    let mut again = SketchSession::new();
    run(&mut again, &text);
    assert_eq!(script(again.object("P").unwrap()), text);
    run(&mut s, "COPY BIT F; MOVE F 20 0 0; CUT P F; RENAME P Q");
    assert!(refused(&mut s, "RENAME F P").contains("a part of Q is called P"));
    run(&mut s, "RENAME Q P; UNDO 5");
    // A part keeps a tool that is no more, with its numbers.
    run(&mut s, "DELETE BIT; USING P; SET BIT.DIAMETER1 6");
    near(volume(&mut s, "P"), PLATE - PI * 9.0 * 8.0);
    run(&mut s, "SKETCH BIT 2D XY; RECTANGLE 5 5; EXTRUDE BIT 50");
    near(volume(&mut s, "P"), PLATE - PI * 9.0 * 8.0);
    let text = script(s.object("P").unwrap());
    let mut again = SketchSession::new();
    run(&mut again, &text);
    near(volume(&mut again, "P"), PLATE - PI * 9.0 * 8.0);
    assert_eq!(script(again.object("P").unwrap()), text);
}

#[test]
fn a_tool_that_was_treated_is_followed() {
    let mut s = plate();
    run(&mut s, "CHAMFER A 2 EDGES ALONG Z");
    near(volume(&mut s, "P"), PLATE - PI * 25.0 * 8.0 - 4.0 * 2.0 * 8.0);
    // The same object several times in place: its own former states are its parts.
    run(&mut s, "COPY D E; MOVE E 20 0 0; CUT P E; CUT P E; SET E.DIAMETER1 4; SET A.CHAMFER1 1");
    near(volume(&mut s, "P"), PLATE - (PI * 25.0 + PI * 4.0) * 8.0 - 4.0 * 0.5 * 8.0);
}

#[test]
fn circles_of_followers_are_refused() {
    let mut s = plate();
    run(&mut s, "COPY D E; MOVE E 20 0 0");
    assert!(refused(&mut s, "CUT P E INTO A").contains("would be made of A"));
    run(&mut s, "CUT P E INTO Q");
    assert!(refused(&mut s, "UNION Q E INTO D").contains("made of D"));
    assert!(refused(&mut s, "USING D; SET UNITS CM; SET UNITS MM CONVERT").contains("made of D"));
}

#[test]
fn a_part_that_loses_its_body_is_reported() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH S 2D XZ; RECTANGLE 10 20 AT 5 0; REVOLVE S 4 90 INTO T\n\
         SKETCH C 2D XZ; RECTANGLE 9 9; EXTRUDE C 9; UNION T C INTO P",
    );
    let before = volume(&mut s, "P");
    let replies = run(&mut s, "MEASURE T; EXTRUDE S 4");
    let mut said = String::new();
    replies.iter().for_each(|r| writeln!(said, "{}", r.text).unwrap());
    assert!(said.contains("T is made of S, which is no cross section now"), "{said}");
    run(&mut s, "UNDO");
    near(volume(&mut s, "P"), before);
}

#[test]
fn a_boss_moves_with_the_face_that_it_is_on() {
    let mut s = plate();
    run(
        &mut s,
        "SKETCH BOSS 2D XY; CIRCLE DIAMETER 12 AT 45 20; EXTRUDE BOSS 10; MOVE BOSS ON A TOP Z\n\
         UNION P BOSS INTO Q; HOLE Q 5 AT 45 20 INTO R",
    );
    let exact = |t: f64, h: f64| 2400.0 * t - PI * 25.0 * t + PI * (36.0 * h - 6.25 * (h + t));
    near(volume(&mut s, "R"), exact(8.0, 10.0));
    run(&mut s, "SET A.D3 9.5; SET BOSS.D3 4");
    near(volume(&mut s, "R"), exact(9.5, 4.0));
    derivatives(&mut s, "R", &["A.D3", "BOSS.D3", "D.DIAMETER1"]);
    assert!(refused(&mut s, "MOVE BOSS ON P \"D.C1\" INTO T").contains("is round"));
    // Across another axis, and on a shell.
    run(
        &mut s,
        "MOVE BOSS ON A BOTTOM X INTO SIDE; SKETCH LID 2D XY; RECTANGLE 20 20; EXTRUDE LID 3",
    );
    run(&mut s, "SHELL A 2 OPEN TOP Z INTO BIN; MOVE LID ON BIN TOP Z INTO SHUT; MOVE A 0 0 30");
    let low = s.objects().into_iter().find(|o| o.name == "SHUT").unwrap();
    near(low.centroid.unwrap().z, 30.0 + 9.5 + 1.5);
    let text = script(s.object("SHUT").unwrap());
    let mut again = SketchSession::new();
    run(&mut again, &text);
    assert_eq!(bits(&mut again, "SHUT"), bits(&mut s, "SHUT"));
    assert_eq!(script(again.object("SHUT").unwrap()), text);
    run(&mut s, "ROTATE A X 10 INTO TILTED; LIST FACES P");
    assert!(refused(&mut s, "MOVE LID ON TILTED TOP Z INTO T").contains("no face TOP Z"));
    assert!(refused(&mut s, "MOVE LID ON LID TOP Z").contains("on itself"));
}

/// Several changes are checked as one: after a line, a run of lines or a drag, in its last state.
#[test]
fn followers_are_checked_after_the_last_change() {
    let lost = |replies: &[moldloft_sketch::CommandReply]| {
        replies.iter().filter(|r| r.text.contains("beside the body")).count()
    };
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH S 2D XY; RECTANGLE 30 20; EXTRUDE S 5 INTO T; HOLE T 4 AT 25 10 INTO P; HOLE P 2 AT 5 5 INTO Q",
    );
    let before = volume(&mut s, "Q");
    // A state between two lines of a run, and between two commands of a line, is not looked at.
    assert_eq!(lost(&s.run_text("SET S.WIDTH1 20\nSET S.WIDTH1 30")), 0);
    assert_eq!(lost(&s.run_line("SET S.WIDTH1 20; SET S.WIDTH1 30")), 0);
    near(volume(&mut s, "Q"), before);
    // Both bodies are gone in the end.
    assert_eq!(lost(&s.run_line("SET S.WIDTH1 20; SET S.HEIGHT1 21")), 2);
    run(&mut s, "UNDO 2");
    near(volume(&mut s, "Q"), before);
    s.begin().unwrap();
    assert_eq!(lost(&s.run_line("SET S.WIDTH1 20")), 0);
    assert_eq!(lost(&s.run_line("SET T.EXTRUDE1 6")), 0);
    assert_eq!(lost(&s.commit().replies), 2);
    run(&mut s, "UNDO");
    s.begin().unwrap();
    s.run_line("SET S.WIDTH1 20");
    s.rollback();
    assert_eq!(lost(&s.run_line("SET S.HEIGHT1 22")), 0);
}

#[test]
fn a_name_answers_a_question() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH G; VARIABLE L 7; SKETCH A 2D XY; RECTANGLE 9 8; VARIABLE W 5");
    run(&mut s, "POINT 5 30 30; POINT 6 60 30; POINT 7 60 60; LINE 5 6; LINE 6 7");
    for (answer, value) in [("W", 5.0), ("G.L", 7.0), ("\"W+G.L\"", 12.0), ("4.5", 4.5)] {
        run(&mut s, "DIM Q X 5 6");
        assert!(s.asks(), "{answer}");
        run(&mut s, answer);
        let q = s.numbers("A").unwrap().into_iter().find(|n| n.0 == "Q").unwrap();
        assert_eq!(q.1, Some(value), "{answer}");
        run(&mut s, "DELETE DIMENSION Q");
    }
    // A verb stays a verb.
    run(&mut s, "VARIABLE CHECK 3; DIM Q X 5 6; CHECK");
    assert!(s.asks());
}
