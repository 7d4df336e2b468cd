//! One language of numbers in all commands, answers to questions, results and tools.

use moldloft_sketch::*;
use std::f64::consts::PI;

const PLATE: &str = "SKETCH G 2D XY\nVARIABLE L 5; VARIABLE N 3\n\
    SKETCH B 2D XY\nPOINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90\nPOLYLINE 1 2 3 4 CLOSE\n\
    DIM X 1 2 80; DIM Y 1 4 50\nEXTRUDE B 8\n\
    SKETCH H 2D XY\nPOINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90\nPOLYLINE 1 2 3 4 CLOSE\n\
    DIM X 1 2 4; DIM Y 1 4 4\nCIRCLE C CORNER 1 2 4\nEXTRUDE H 10\n";

fn run(s: &mut SketchSession, text: &str) -> Vec<CommandReply> {
    let replies = s.run_text(text);
    let errors: Vec<&CommandReply> = replies.iter().filter(|r| r.is_error()).collect();
    assert!(errors.is_empty(), "{text}: {errors:?}");
    replies
}

/// All objects as commands.
fn text(s: &SketchSession) -> String {
    crate::common::all_commands(s)
}

fn volume(s: &mut SketchSession, name: &str) -> f64 {
    s.objects().into_iter().find(|o| o.name == name).unwrap().volume.unwrap()
}

#[test]
fn numbers_of_other_objects_in_every_command() {
    let mut s = SketchSession::new();
    run(&mut s, PLATE);
    run(
        &mut s,
        "MOVE H \"2*G.L\" G.L -1\nPATTERN H LINEAR G.N \"4*G.L\" 0 0 INTO ROW\nCUT B ROW INTO P",
    );
    let want = |n: f64| 80.0 * 50.0 * 8.0 - n * PI * 4.0 * 8.0;
    assert!((volume(&mut s, "P") - want(3.0)).abs() < 1e-9);
    // A number of another object, by its name; dependent values follow.
    run(&mut s, "SET G.N 2");
    assert_eq!(s.active_object().unwrap().name, "P");
    assert!((volume(&mut s, "P") - want(2.0)).abs() < 1e-9);
    for bad in ["2.5", "0", "1000"] {
        run(&mut s, &format!("SET G.N {bad}"));
        let o = s.objects().into_iter().find(|o| o.name == "P").unwrap();
        assert_eq!(o.volume, None, "{bad}");
    }
    run(&mut s, "SET G.N 1");
    assert!((volume(&mut s, "P") - want(1.0)).abs() < 1e-9);
    // The file says the same.
    let mut again = SketchSession::new();
    run(&mut again, &text(&s));
    assert!((volume(&mut again, "P") - want(1.0)).abs() < 1e-9);
    // The size of a curve.
    run(
        &mut s,
        "SKETCH R 2D XY\nPOINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90\nPOLYLINE 1 2 3 4 CLOSE",
    );
    run(&mut s, "DIM X 1 2 80; DIM Y 1 4 50\nARC A CORNER 1 2 4 RADIUS G.L\nGENERATE FACES");
    let area =
        |s: &mut SketchSession| s.objects().into_iter().find(|o| o.name == "R").unwrap().area;
    let corner = |r: f64| 4000.0 - (4.0 - PI) / 4.0 * r * r;
    assert!((area(&mut s).unwrap() - corner(5.0)).abs() < 1e-9);
    run(&mut s, "SET G.L 7");
    assert!((area(&mut s).unwrap() - corner(7.0)).abs() < 1e-9);
}

#[test]
fn a_question_takes_the_value() {
    let drawn = "SKETCH A 2D XY\nVARIABLE W 3\nPOINT 1 0 0; POINT 2 90 0; LINE 1 2\nDIM X 1 2\n";
    for (answer, value) in [("9", 9.0), ("\"3*W\"", 9.0), ("9 IN 1 20", 9.0)] {
        let mut s = SketchSession::new();
        run(&mut s, drawn);
        assert!(s.asks());
        run(&mut s, answer);
        assert!(!s.asks());
        assert_eq!(s.numbers("A").unwrap()[1].1, Some(value));
        let mut again = SketchSession::new();
        run(&mut again, &s.journal().join("\n"));
        assert_eq!(again.active_object(), s.active_object());
    }
    // Without a question a number is no command.
    let mut s = SketchSession::new();
    assert!(s.run_line("9")[0].is_error());
}

#[test]
fn other_words_are_no_misspellings() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH A 2D XY\nPOINT 1 0 0; POINT 2 90 0; LINE 1 2");
    for other in ["SPLINE 1 0.5", "HELIX", "OCTAGON 1 2"] {
        let replies = s.run_line(other);
        assert!(replies[0].is_error() && replies[0].text.contains("no command"), "{replies:?}");
    }
    assert_eq!(s.active_object().unwrap().drawing.lines.len(), 1);
}

#[test]
fn tools_are_no_results() {
    let mut s = SketchSession::new();
    run(&mut s, PLATE);
    run(&mut s, "CUT B H INTO P");
    let flags = |s: &SketchSession| {
        let names = s.names();
        let all: Vec<&SketchObject> = names.iter().map(|n| s.object(n).unwrap()).collect();
        let flags = results(&all);
        names.into_iter().zip(flags).filter(|f| f.1).map(|f| f.0).collect::<Vec<_>>()
    };
    assert_eq!(flags(&s), ["G", "P"]);
    run(&mut s, "KEEP B H; KEEP H OFF");
    assert_eq!(flags(&s), ["G", "B", "P"]);
    let mut again = SketchSession::new();
    run(&mut again, &text(&s));
    assert_eq!(flags(&again), ["G", "B", "P"]);
    // An object that is changed in place is an operand of itself.
    run(&mut s, "CUT P H");
    assert_eq!(flags(&s), ["G", "B", "P"]);
}

/// Files without a unit are in millimetres, which is reported once.
#[test]
fn files_without_a_unit_are_in_millimetres() {
    let mut s = SketchSession::new();
    run(&mut s, PLATE);
    let replies = run(&mut s, "EXPORT GLTF B b.gltf");
    assert_eq!(replies.iter().filter(|r| r.text.contains("millimetres")).count(), 1);
    let file = replies.iter().find_map(|r| r.file.clone()).unwrap();
    assert!(String::from_utf8(file.bytes).unwrap().contains("\"scale\":[0.001,0.001,0.001]"));
    let replies = run(&mut s, "SET UNITS CM; EXPORT GLTF B b.gltf");
    assert!(replies.iter().all(|r| !r.text.contains("millimetres")));
}
