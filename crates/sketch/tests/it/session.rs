//! The command language: the cases as scripts, edits, errors, merging, files (T2, T7, T13-T16, T18, T19).

use crate::common::*;
use moldloft_sketch::json::Json;
use moldloft_sketch::*;

fn run(s: &mut SketchSession, text: &str) -> Vec<CommandReply> {
    let replies = s.run_text(text);
    let errors: Vec<&CommandReply> = replies.iter().filter(|r| r.is_error()).collect();
    assert!(errors.is_empty(), "{text}: {errors:?}");
    replies
}

/// The error of a line, which must have changed nothing.
fn refused(s: &mut SketchSession, line: &str) -> CommandReply {
    let before: Vec<String> =
        s.objects().iter().map(|o| script(s.object(&o.name).unwrap())).collect();
    let reply = s.run_line(line).into_iter().find(CommandReply::is_error);
    let after: Vec<String> =
        s.objects().iter().map(|o| script(s.object(&o.name).unwrap())).collect();
    assert_eq!(before, after, "{line}");
    let reply = reply.unwrap_or_else(|| panic!("{line} was accepted"));
    assert!(!reply.text.is_empty() && reply.next.as_ref().is_some_and(|n| !n.is_empty()));
    reply
}

fn code(s: &mut SketchSession, line: &str, code: u16) -> String {
    let reply = refused(s, line);
    assert_eq!(reply.code, Some(code), "{line}: {}", reply.text);
    reply.text
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-6 * b.abs().max(1.0), "{a} for {b}");
}

fn with(object: SketchObject) -> SketchSession {
    let mut s = SketchSession::new();
    s.insert(object);
    s
}

fn volume(s: &mut SketchSession, name: &str) -> f64 {
    s.objects().into_iter().find(|o| o.name == name).unwrap().volume.unwrap()
}

/// T19: SAVE, INPUT, the same object, through both forms.
#[test]
fn every_case_survives_its_file() {
    struct Disk(Vec<OutFile>);
    impl Files for Disk {
        fn read(&self, name: &str) -> Result<String, String> {
            let file = self.0.iter().find(|f| f.name == name).ok_or("no such file")?;
            String::from_utf8(file.bytes.clone()).map_err(|e| e.to_string())
        }
    }
    for case in cases() {
        let mut s = with(case.object);
        run(&mut s, "CONVERT; GENERATE FACES");
        let original = s.object("A").unwrap().clone();
        assert_eq!(original.faces.len(), case.faces.len());
        let mut disk = Vec::new();
        for line in ["SAVE A AS a.skt", "SAVE A AS a.json"] {
            disk.extend(run(&mut s, line).into_iter().filter_map(|r| r.file));
        }
        assert_eq!(disk.len(), 2);
        let mut t = SketchSession::with_files(Box::new(Disk(disk)));
        for line in ["INPUT a.skt", "DELETE A", "INPUT \"a.json\""] {
            run(&mut t, line);
            if let Some(read) = t.object("A") {
                assert_eq!(*read, original, "{} {line}", case.id);
                assert_eq!(t.objects_json(), s.objects_json());
                close(volume(&mut t, "A"), case.volume);
            }
        }
        run(&mut t, "RENAME A TO B; INPUT a.skt INTO C");
        assert!(t.object("C").is_some() && t.object("A").is_none());
        assert_eq!(refused(&mut t, "INPUT nowhere.skt").code, Some(600));
        // The journal restores the session; so does a copy of it cut anywhere, up to there.
        let mut again = SketchSession::new();
        let journal = t.journal().join("\n");
        run(&mut again, &journal);
        assert_eq!(again.objects_json(), t.objects_json());
    }
}

#[test]
fn settings_and_curves_survive_the_file() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH 'my part'\nSET UP Y; SET NAMES SEED; SET UNITS FT\nAXES CABINET\n\
         POINT 1 0 0; POINT 2 100 3; POINT 3 100 100.5; POINT 5 7 100\nPOLYLINE 1 2 3 5 CLOSE\n\
         TYPE 1 AS XY; TYPE 2 NONE\nDIM w X 1 2 = 3.25; VARIABLE r \"2*w + 1\" IN 1 9",
    );
    let error = refused(&mut s, "VARIABLE q nothing");
    assert!(error.text.contains("nothing"));
    run(
        &mut s,
        "SET POINT 2 Y 4in; ALIGN Y 1 2; REFERENCE 2 1 2 3; ARC a1 CORNER 2 1 3 RADIUS r KEEP STEPS 9\n\
         QUADRATIC q POINTS 1 2 3; CUBIC c1 LINES 1 2 3 CENTRIPETAL; ELLIPSE e ARC LINES 1 2 SEMI 2 w; ERASE 'my part'\n\
         DIM s1 SLOPE 3 2 IN 1 3; UNSET s1; FACE 1 2 3 5",
    );
    let one = s.active_object().unwrap().clone();
    assert_eq!(one.curves.len(), 4);
    assert!(!one.display && one.units.as_deref() == Some("FT"));
    let mut t = SketchSession::new();
    run(&mut t, &script(&one));
    assert_eq!(t.active_object().unwrap(), &one);
    let twin =
        moldloft_sketch::json_format::to_json(&one, &moldloft_sketch::script(&one)).to_string();
    let mut t = SketchSession::new();
    run(&mut t, &moldloft_sketch::json_format::from_json(&twin).unwrap());
    assert_eq!(t.active_object().unwrap(), &one);
}

/// T15, by commands.
#[test]
fn edits_of_a_live_object() {
    let mut s = with(case_named("T1 ").object);
    run(&mut s, "GENERATE FACES");
    run(&mut s, "SET D1 2");
    close(volume(&mut s, "A"), 39.0);
    run(&mut s, "SET D1 = 8");
    run(&mut s, "SET d1 1; DIM r X 1 2 6");
    let r = &s.object("A").unwrap().dimensions["r"];
    assert_eq!(r.role, DimensionRole::Reference);
    run(&mut s, "DELETE DIMENSION R");
    let text = code(&mut s, "DIM X 1 2 7", 396);
    assert!(text.contains("differs by 1") && text.contains("1>4>2"), "{text}");
    let replies = run(&mut s, "DELETE DIMENSION D2; CHECK");
    let free = replies.iter().find(|r| r.text.contains("X: 1 of 2"));
    assert!(free.unwrap().text.contains("points 2,3,8,9 is free"), "{free:?}");
    assert!(free.unwrap().text.contains("DIMENSION X"));
    run(&mut s, "UNDO");
    close(volume(&mut s, "A"), 27.0);
    run(&mut s, "UNDO 100; REDO 100");
    assert_eq!(s.objects()[0].missing, [1, 0, 0]);

    let mut s = with(case_named("T3").object);
    run(&mut s, "GEN FACES; SET d1 20");
    close(volume(&mut s, "A"), 187_200.0);
    let mut s = with(case_named("T8").object);
    run(&mut s, "GEN FACES; SET d5 8");
    close(volume(&mut s, "A"), 64.0);
    // A plane that passes another is reported.
    let replies = run(&mut s, "SET d5 -8");
    assert!(replies.iter().any(|r| r.text.contains("complete")));
    let mut s = with(case_named("T10").object);
    let replies = run(&mut s, "GEN FACES; SET d2 -1");
    assert!(volume(&mut s, "A") < 90.0, "{replies:?}");
}

/// T2 with extrusion.
#[test]
fn a_section_is_extruded() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH DAM 2D XZ; AXES 0 90");
    let points = "2 0 330 2 328 61 259 58 259 118 150 121 149 231 97 328 97 379 -2 379";
    let n: Vec<&str> = points.split(' ').collect();
    for k in 0..10 {
        run(&mut s, &format!("POINT {} AT {} {}", k + 1, n[2 * k], n[2 * k + 1]));
    }
    run(&mut s, "POLYLINE 1 2 3 4 5 6 7 8 9 10 CLOSE");
    let text = code(&mut s, "CONVERT", 404);
    assert!(text.contains("X: 4, Y: 0, Z: 5"), "{text}");
    run(&mut s, "DIM X 1 8 12; DIM X 8 6 8; DIM X 6 4 10; DIM X 4 2 10");
    run(
        &mut s,
        "DIM Z 1 3 5; DIM Z 3 5 10; DIM Z 5 7 15; DIM Z 7 8 15; DIM Z 8 9 5; CONVERT; GENERATE FACES",
    );
    let flat = s.objects().remove(0);
    close(flat.area.unwrap(), 1100.0);
    let c = flat.centroid.unwrap();
    close(c.x, 12.563_636);
    close(c.z, 19.954_545);
    let solid = flat.solid.unwrap();
    let around: f64 = (0..solid.edges.len()).map(|e| solid.length(e)).sum();
    close(around, 174.0);
    run(&mut s, "EXTRUDE Y 20");
    let o = s.objects().remove(0);
    assert_eq!((o.points.len(), o.lines.len(), o.faces.len()), (20, 30, 12));
    close(o.volume.unwrap(), 22_000.0);
    close(o.area.unwrap(), 5680.0);
    // Still parametric.
    let name = o.dimensions.last().unwrap().0.clone();
    run(&mut s, &format!("SET {name} 10"));
    close(volume(&mut s, "DAM"), 11_000.0);
}

#[test]
fn a_section_is_revolved() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH ROD 2D XZ; POINT 1 0 0; POINT 2 30 0; POINT 3 30 50; POINT 4 0 50; POLYLINE 1 2 3 4 CLOSE",
    );
    run(&mut s, "DIM X 1 2 3; DIM Z 1 4 5; REVOLVE 4 360");
    close(volume(&mut s, "ROD"), 45.0 * std::f64::consts::PI);
    let mesh = s.objects()[0].solid.as_ref().unwrap().mesh(1.0).report();
    assert!(mesh.closed && mesh.manifold && mesh.outward == Some(true));
    run(&mut s, "UNDO; REVOLVE 4 90");
    close(volume(&mut s, "ROD"), 45.0 * std::f64::consts::FRAC_PI_4);
    code(&mut s, "REVOLVE 1 90", 102);
}

/// T7, by commands.
#[test]
fn fillets_by_commands() {
    let mut s = with(cuboid([10.0, 6.0, 4.0]));
    run(
        &mut s,
        "GEN FACES; VARIABLE R 2; ARC F1 LINES 3 10 RADIUS R; ARC F2 CORNER 7 8 3 RADIUS R",
    );
    close(volume(&mut s, "A"), 234.849_556);
    let o = s.objects().remove(0);
    assert_eq!((o.points.len(), o.solid.unwrap().faces.len()), (12, 7));
    code(&mut s, "ARC CORNER 1 2 4 RADIUS 50", 310);
    code(&mut s, "ARC CORNER 1 2 2 RADIUS 5", 300);
    let replies = run(&mut s, "SET R 5");
    assert!(
        replies
            .iter()
            .any(|r| r.code == Some(310) && r.next.as_ref().unwrap().contains("at most 4"))
    );
    run(&mut s, "UNDO; DELETE CURVE F1; DELETE CURVE F2");
    close(volume(&mut s, "A"), 240.0);
}

fn two_boxes() -> SketchSession {
    let mut a = cuboid([4.0, 3.0, 2.0]);
    a.name = "A".into();
    let mut b = cuboid([3.0, 3.0, 2.0]);
    b.name = "B".into();
    let mut s = with(a);
    s.insert(b);
    run(&mut s, "MOVE B 4 0 0");
    s
}

/// T13.
#[test]
fn merging() {
    let mut s = two_boxes();
    let replies = run(&mut s, "MERGE A B INTO C");
    assert!(
        replies
            .iter()
            .any(|r| r.text.contains("8+8 points, 4 shared: 12; 12+12 lines, 4 shared: 20")),
        "{replies:?}"
    );
    let c = s.objects().into_iter().find(|o| o.name == "C").unwrap();
    assert_eq!((c.points.len(), c.lines.len(), c.faces.len()), (12, 20, 10));
    let at = |k: usize| c.points[k].1.map(Option::unwrap);
    for (k, xyz) in
        [[7.0, 0.0, 0.0], [7.0, 3.0, 0.0], [7.0, 0.0, 2.0], [7.0, 3.0, 2.0]].into_iter().enumerate()
    {
        assert_eq!(at(8 + k), xyz);
    }
    close(c.volume.unwrap(), 42.0);
    close(c.area.unwrap(), 82.0);
    assert!(replies.iter().any(|r| r.text.contains("11 candidates")));
    // Dimensions of both still drive.
    run(&mut s, "SET A.D1 6; SET B.D1 1");
    close(volume(&mut s, "C"), 42.0);
    run(&mut s, "SET B.D1 3");
    close(volume(&mut s, "C"), 54.0);
    run(&mut s, "SET A.D1 4; CLEAN C");
    let c = s.objects().into_iter().find(|o| o.name == "C").unwrap();
    assert_eq!((c.points.len(), c.lines.len(), c.faces.len()), (8, 12, 6));
    close(c.volume.unwrap(), 42.0);
    run(&mut s, "SET A.D1 10");
    close(volume(&mut s, "C"), 78.0);
    code(&mut s, "MERGE A B INT C", 192);
    code(&mut s, "MERGE A", 191);
    code(&mut s, "MERGE A INTO", 191);
    assert!(code(&mut s, "MERGE Q C", 110).contains('Q'));
    let before = s.object("A").unwrap().clone();
    run(&mut s, "MERGE A A");
    assert_eq!(s.object("A"), Some(&before));
    // Into an existing one: its names stay.
    run(&mut s, "MERGE B A");
    let a = s.object("A").unwrap();
    assert!(a.dimensions.contains_key("d1") && a.dimensions.contains_key("b.d1"));
    close(volume(&mut s, "A"), 42.0);
    // Separate: each keeps its position.
    run(&mut s, "MOVE B 20 1 1; MERGE B C INTO D");
    close(volume(&mut s, "D"), 18.0 + 78.0);
    run(&mut s, "SKETCH F 2D XY; POINT 1 0 0; POINT 2 1 0; LINE 1 1 2");
    code(&mut s, "MERGE F A INTO G", 114);
}

/// T14 and CHOOSE; the interactive mode.
#[test]
fn ambiguous_and_by_hand() {
    let mut inner = cuboid([2.0; 3]);
    inner.name = "I".into();
    let mut s = with(cuboid([6.0; 3]));
    s.insert(inner);
    run(&mut s, "MOVE I 2 2 2; MERGE A I INTO C");
    close(volume(&mut s, "C"), 208.0);
    for k in 1..=8 {
        run(&mut s, &format!("LINE FROM {k} TO {} TYPE O", k + 8));
    }
    let replies = run(&mut s, "GENERATE FACES");
    let several = replies.iter().find(|r| r.code == Some(702)).unwrap();
    assert!(several.text.contains("3"), "{}", several.text);
    let first = s.object("C").unwrap().faces.clone();
    run(&mut s, "CHOOSE 3");
    assert_ne!(first, s.object("C").unwrap().faces);
    close(volume(&mut s, "C"), 416.0 / 3.0);
    code(&mut s, "CHOOSE 4", 702);

    let mut s = with(case_named("T5").object);
    let mut reply = run(&mut s, "GENERATE FACES ASK").pop().unwrap();
    code_of_reverse(&mut s);
    run(&mut s, "REPEAT");
    let mut asked = 0;
    while reply.text.contains("is this a face") {
        asked += 1;
        let neck = reply.text.contains(": 5 6 7 8?") || reply.text.contains(": 5 8 7 6?");
        reply = run(&mut s, if neck { "REJECT" } else { "ACCEPT" }).pop().unwrap();
    }
    assert_eq!(asked, 11);
    close(volume(&mut s, "A").abs(), 56.0);
    let word = refused(&mut s, "ACCEPT");
    assert!(word.text.contains("no question"));
}

/// The first face may be reversed, its neighbours not once it is accepted (700).
fn code_of_reverse(s: &mut SketchSession) {
    run(s, "REVERSE; ACCEPT");
    for _ in 0..11 {
        let reply = s.run_line("REVERSE").pop().unwrap();
        if reply.code == Some(700) {
            run(s, "GENERATE FACES ASK");
            return;
        }
        run(s, "REJECT");
    }
    panic!("no neighbour was offered");
}

/// T16 and every other error that a user can cause.
#[test]
fn errors_say_what_where_and_next() {
    let mut s = SketchSession::new();
    code(&mut s, "LIST POINTS", 112);
    code(&mut s, "USING WAL", 110);
    run(&mut s, "SKETCH WALL");
    assert_eq!(refused(&mut s, "USING WAL").next.unwrap(), "did you mean WALL?");
    code(&mut s, "CONVERT", 101);
    code(&mut s, "LINE 1 2", 101);
    run(&mut s, "POINT 1 0 0; POINT 2 100 0; POINT 3 100 100; POINT 4 0 100");
    code(&mut s, "CONVERT", 102);
    code(&mut s, "TYPE 1 AS X", 102);
    code(&mut s, "LINE 1 1", 300);
    run(&mut s, "LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Z; LINE 3 3 4 TYPE Z; LINE 4 4 1 TYPE Z");
    let text = code(&mut s, "CONVERT", 400);
    assert!(
        text.contains("1-2 (X) cannot run along X")
            && text.contains("2-3 (Z)")
            && text.contains("3-4 (Z)")
            && text.contains("4-1 (Z)"),
        "{text}"
    );
    run(&mut s, "TYPE 3 AS X; POINT 5 50 50");
    assert!(code(&mut s, "CONVERT", 401).contains("point 5"));
    run(&mut s, "LINE 5 4 5 TYPE NONE");
    assert!(code(&mut s, "CONVERT", 402).contains("4-5"));
    run(&mut s, "TYPE 5 AS F");
    assert!(code(&mut s, "CONVERT", 404).contains("points"));
    code(&mut s, "GENERATE FACES", 404);
    code(&mut s, "EXPORT STL", 404);
    code(&mut s, "MEASURE", 404);
    code(&mut s, "DIM 1 3 5", 105);
    code(&mut s, "DIM Z 1 2 5", 396);
    code(&mut s, "EXTRUDE 5", 113);
    code(&mut s, "TYPE 1 AS Q", 406);
    code(&mut s, "AXES 0 1 2 SCALE 0 1 1", 405);
    code(&mut s, "EXPORT STEPP", 600);
    code(&mut s, "SAVE AS ''", 600);
    code(&mut s, "CHOOSE 1", 702);
    run(&mut s, "WELD 5 3; DIM X 1 2 4; DIM Z 1 3 2");
    code(&mut s, "SET D1 \"1/0\"", 300);
    // The square closes, but bounds no solid.
    code(&mut s, "GENERATE FACES", 701);
    run(&mut s, "DIM L LENGTH 2 2");
    assert_eq!(s.active_object().unwrap().dimensions["l"].role, DimensionRole::Reference);
    code(&mut s, "DIM M LENGTH 2 3", 396);
    run(&mut s, "UNSET D2");
    code(&mut s, "DIM M SLOPE 2 -7", 411);
    run(&mut s, "SKETCH FLAT 2D XY; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2");
    code(&mut s, "SKETCH FLAT 2D XZ", 113);
    code(&mut s, "TYPE 1 AS Z", 406);
    run(&mut s, "ERASE ALL");
    code(&mut s, "EXPORT SVG", 112);
    for (line, says) in [
        ("DIM W X 1.2.3 4", "two decimal points in 1.2.3"),
        ("DIM W X 12-3 4", "misplaced hyphen"),
        ("DIM W X 1A2 4", "letter A inside"),
        ("SAVE \"x", "no partner"),
        ("DI", "DIMENSION or DISPLAY"),
        ("XYZZY", "no command"),
        ("POINT 1", "expected"),
        ("DIM pi X 1 2 3", "means something"),
        ("DIM X 1 2 3ft", "the object has none"),
        ("DIM X 1 2 \"2*\"", "in `2*`"),
        ("SET nothing 3", "unknown dimension or variable"),
        ("WHY nothing", "no dimension"),
        ("UNDO 5 6", "expected the end"),
        ("VARIABLE v 3 IN 5 1", "empty"),
        ("FACE 1 2 77", "no point 77"),
        ("FACE 1 2", "expected"),
        ("ROTATE FLAT X 45", "cross section"),
        ("COPY FLAT FLAT", "exists already"),
        ("RENAME FLAT TO WALL", "exists already"),
        ("ZOOM -1", "positive"),
        ("VIEW INSIDE", "no view"),
        ("AXES FISHEYE", "no projection"),
        ("SPLIT 1 7", "not inside"),
        ("CUBIC LINES 1 1 1", "does not continue"),
    ] {
        let reply = refused(&mut s, line);
        assert!(reply.text.contains(says), "{line}: {}", reply.text);
    }
}

/// T18.
#[test]
fn lines_may_be_written_freely() {
    let mut s = SketchSession::new();
    run(&mut s, "sketch wall ! comment\nAXES CAVALIER");
    run(&mut s, "POINT,1,0,0; point 2 at = 16 0 # and so on");
    run(&mut s, "LINE 1 FROM &");
    run(&mut s, "1 TO 2");
    assert_eq!(s.active_object().unwrap().drawing.lines.len(), 1);
    for line in
        ["DIM W1 X 1 3=16", "dim w1,x,1,3,16", "DIMENSION W1 X 1 TO 3 = 16", "DIMENSON W1 1 3 16"]
    {
        run(&mut s, "POINT 3 16 0.1; POINT 4 32 0; LINE 2 FROM 1 TO 3");
        let replies = run(&mut s, line);
        assert_eq!(
            replies.iter().any(|r| r.text.contains("read DIMENSON as DIMENSION")),
            line.contains("SON")
        );
        assert_eq!(
            s.active_object().unwrap().dimensions["w1"].value.as_ref().unwrap().literal(),
            Some(16.0)
        );
        run(&mut s, "DELETE DIMENSION w1; DELETE POINT 3");
    }
    run(&mut s, "SET UNITS IN; DIM W X 1 2 1FT");
    assert_eq!(
        s.active_object().unwrap().dimensions["w"].value.as_ref().unwrap().literal(),
        Some(12.0)
    );
    run(&mut s, "SET W \"3'-6\"");
    assert_eq!(
        s.active_object().unwrap().dimensions["w"].value.as_ref().unwrap().literal(),
        Some(42.0)
    );
    run(&mut s, "us,wall; SAVE \"my file.skt\"");
    run(&mut s, "SET SKETCH83 ON");
    let long = "a".repeat(32);
    run(&mut s, &format!("SKETCH {long}zz; USING {long}; SET SKETCH83 OFF"));
    assert!(s.complete("DIS").contains(&"DISPLAY".to_owned()));
    assert_eq!(s.complete("USING wa"), ["wall"]);
    for line in [
        "HELP",
        "HELP MERGE",
        "HISTORY",
        "LIST",
        "LIST wall",
        "CHECK",
        "ESTIMATE",
        "EXTENSIONS",
        "WHY 1",
        "WHY X 1 2",
        "WHY W",
        "DUMP",
        "SHOW LABELS OFF",
        "ZOOM 2",
        "PAN 1 1",
        "ZOOM FIT",
        "VIEW TOP",
        "DISPLAY",
        "ERASE wall",
        "MODIFY wall",
        "QUIT",
    ] {
        let run = run(&mut s, line);
        let silent = ["DISPLAY", "ERASE", "SHOW", "ZOOM", "PAN", "VIEW", "MODIFY", "QUIT"];
        assert_eq!(run.is_empty(), silent.iter().any(|v| line.starts_with(v)), "{line}");
    }
    assert!(s.over());
}

#[test]
fn a_dimension_without_value_asks() {
    let mut s = with(case_named("T1 ").object);
    run(&mut s, "DELETE DIMENSION D1; DELETE DIMENSION D2");
    let reply = run(&mut s, "DIM NEW X 1 4").pop().unwrap();
    assert!(reply.text.contains("is about") && reply.next.is_some());
    run(&mut s, "YES");
    assert!(
        s.object("A").unwrap().dimensions["new"].value.as_ref().unwrap().literal().unwrap() > 0.0
    );
    // Against the picture: it holds as typed, with a warning.
    let replies = run(&mut s, "DIM BACK X 2 1 = 6");
    assert!(replies.iter().any(|r| r.text.contains("as typed")), "{replies:?}");
    let d = &s.object("A").unwrap().dimensions["back"];
    assert_eq!(
        d.measure,
        MeasuredQuantity::Along { axis: CoordinateAxis::X, p: PointId(2), q: PointId(1) }
    );
    assert_eq!(s.objects()[0].points[1].1[0], Some(-6.0));
    run(&mut s, "REVERSE BACK");
    assert_eq!(s.objects()[0].points[1].1[0], Some(6.0));
}

#[test]
fn transformed_objects_stay_parametric() {
    let mut s = with(case_named("T9").object);
    run(&mut s, "GENERATE FACES; COPY A TO B; ROTATE B Z 90; MIRROR B X; SCALE B 2; MOVE B 1 2 3");
    let o = s.objects().into_iter().find(|o| o.name == "B").unwrap();
    close(o.volume.unwrap(), 8.0 * 49_840.0);
    // (x, y, z) to (-y, x, z), mirrored to (y, x, z), doubled and moved.
    let c = o.centroid.unwrap();
    close(c.x, 1.0 + 2.0 * 17.5);
    close(c.y, 2.0 + 2.0 * 14.945_693);
    close(c.z, 3.0 + 2.0 * 26.102_996);
    let report = o.solid.unwrap().mesh(1.0).report();
    assert!(report.closed && report.outward == Some(true));
    let replies = run(&mut s, "USING B; GENERATE FACES; SET D6 35");
    close(volume(&mut s, "B"), 4.0 * 49_840.0);
    assert!(!replies.iter().any(|r| r.text.contains("passed")), "{replies:?}");
}

#[test]
fn exports_are_whole() {
    let mut s = with(case_named("T1 ").object);
    run(&mut s, "GENERATE FACES");
    let mut get = |format: &str| {
        let reply = run(&mut s, &format!("EXPORT {format} A out")).pop().unwrap();
        reply.file.unwrap().bytes
    };
    let stl = String::from_utf8(get("STL")).unwrap();
    assert_eq!(stl.matches("facet normal").count(), 20);
    let obj = String::from_utf8(get("OBJ")).unwrap();
    assert_eq!((obj.matches("\nv ").count(), obj.matches("\nf ").count()), (12, 20));
    let gltf = Json::parse(&String::from_utf8(get("GLTF")).unwrap()).unwrap();
    let accessor =
        |k: usize| gltf.get("accessors").unwrap().items()[k].get("count").unwrap().number();
    assert_eq!((accessor(0), accessor(1)), (Some(12.0), Some(60.0)));
    let archive = get("3MF");
    assert!(archive.starts_with(b"PK\x03\x04") && archive.windows(4).any(|w| w == b"PK\x05\x06"));
    let text = String::from_utf8_lossy(&archive).into_owned();
    assert_eq!((text.matches("<vertex ").count(), text.matches("<triangle ").count()), (12, 20));
    let dxf = String::from_utf8(get("DXF")).unwrap();
    assert_eq!((dxf.matches("3DFACE").count(), dxf.matches("\nLINE\n").count()), (20, 18));
    for view in ["SKETCH", "TOP", "ISO"] {
        run_view(&mut get, view);
    }
    let json = Json::parse(&String::from_utf8(get("JSON")).unwrap()).unwrap();
    assert_eq!(json.get("volume").unwrap().number().map(f64::round), Some(27.0));
    assert!(String::from_utf8(get("SKETCH83")).unwrap().starts_with("SKETCH A"));
}

fn run_view(get: &mut impl FnMut(&str) -> Vec<u8>, view: &str) {
    let svg = String::from_utf8(get("SVG")).unwrap();
    assert_eq!(svg.matches("<line").count(), 18, "{view}");
    assert!(svg.ends_with("</svg>\n"));
}

/// The scripts of `examples/sketch`, with their numbers.
#[test]
fn examples() {
    for (text, name, volume_, faces) in [
        (include_str!("../../../../examples/sketch/dam.skt"), "DAM", 169_200.0, 7),
        (include_str!("../../../../examples/sketch/lock_wall.skt"), "WALL", 49_840.0, 14),
        (include_str!("../../../../examples/sketch/shed.skt"), "SHED", 240.0, 7),
        // The bracket gains the fillet: (1 - π/4) r² over its width.
        (
            include_str!("../../../../examples/sketch/bracket.skt"),
            "BRACKET",
            27.0 + 3.0 * 0.25 * (1.0 - std::f64::consts::PI / 4.0),
            8,
        ),
    ] {
        let mut s = SketchSession::new();
        let replies = run(&mut s, text);
        assert!(replies.iter().all(|r| r.severity == moldloft_diag::Severity::Note), "{replies:?}");
        let o = s.objects().remove(0);
        assert_eq!((o.name.as_str(), o.faces.len(), o.state), (name, faces, "solid"));
        close(o.volume.unwrap(), volume_);
        assert_eq!(o.missing, [0; 3]);
        let report = o.solid.unwrap().mesh(1e-2).report();
        assert!(report.closed && report.manifold && report.outward == Some(true), "{name}");
    }
    let mut s = SketchSession::new();
    run(&mut s, include_str!("../../../../examples/sketch/dam.skt"));
    // The slope is kept by an expression.
    run(&mut s, "SET HEIGHT 60; SET CREST 20");
    close(volume(&mut s, "DAM"), 50.0 * (20.0 * 78.0 + 45.0 * 60.0 / 2.0));
}

/// No line panics or hangs: random commands of plausible words in one session. `MOLDLOFT_SOAK=1`
/// runs ten million lines.
#[test]
fn any_line_is_answered() {
    let rounds = moldloft_testing::rounds(30_000, 10_000_000);
    let verbs: Vec<&str> = command::verbs::VERBS.iter().map(|v| v.name).collect();
    let words = [
        "A",
        "B",
        "C",
        "X",
        "Y",
        "Z",
        "O",
        "F",
        "H",
        "P",
        "XY",
        "TO",
        "INTO",
        "FROM",
        "AT",
        "TYPE",
        "AUTO",
        "FACES",
        "ASK",
        "POINT",
        "LINES",
        "CORNER",
        "RADIUS",
        "POINTS",
        "SEMI",
        "LENGTH",
        "SLOPE",
        "ANGLE",
        "EQUAL",
        "REVERSED",
        "IN",
        "ALL",
        "2D",
        "3D",
        "HOLE",
        "KEEP",
        "CLOSE",
        "D1",
        "D2",
        "W",
        "'2*D1'",
        "\"D1/0\"",
        "\"W+W\"",
        "1",
        "2",
        "3",
        "4",
        "5",
        "6",
        "7",
        "8",
        "9",
        "0",
        "-1",
        "0.5",
        "1e9",
        "1e-9",
        "90",
        "12.5",
        "1.2.3",
        "1ft",
        "=",
        ",",
        ";",
        "&",
        "!",
        "\"",
        "'",
        "é",
        "STL",
        "SVG",
        "JSON",
        "GLTF",
        "3MF",
        "ON",
        "OFF",
        "UP",
        "SCALE",
        "ARC",
        "FULL",
        "CENTRIPETAL",
        "DIMENSION",
        "LINE",
        "FACE",
        "CURVE",
        "INERTIA",
        "(",
        "\u{0}",
    ];
    let mut random = moldloft_testing::Random::new(18);
    let mut s = SketchSession::new();
    for round in 0..rounds {
        if round % 400 == 0 {
            s = with(cuboid([4.0, 3.0, 2.0]));
            if round % 800 == 0 {
                s.run_line("GEN FACES; COPY A B; MOVE B 4 0 0");
            }
        }
        let mut line = String::new();
        let verb = verbs[random.below(verbs.len())];
        let cut = if random.below(8) == 0 { 1 + random.below(verb.len()) } else { verb.len() };
        line.push_str(&verb[..cut]);
        for _ in 0..random.below(8) {
            line.push(' ');
            line.push_str(words[random.below(words.len())]);
        }
        for reply in s.run_line(&line) {
            assert!(!reply.text.contains("Internal"), "{line}");
        }
    }
    assert!(!s.history().is_empty());
}

/// A command that invalidates a body reports that at once, with the position.
#[test]
fn what_takes_a_body_away_is_said() {
    for (command, code, kind) in [
        ("DELETE FACE 1", 701, "open-body"),
        ("DELETE LINE 12", 701, "open-body"),
        ("DELETE DIMENSION D1", 404, "no-faces"),
        ("WELD 1 7", 701, "open-body"),
    ] {
        let mut s = with(with_faces(cuboid([4.0, 3.0, 2.0])));
        assert!(s.objects()[0].volume.is_some());
        let replies = s.run_line(command);
        assert!(s.objects()[0].volume.is_none(), "{command}");
        let said = replies.iter().find(|r| r.about.kind == kind);
        let said = said.unwrap_or_else(|| panic!("{command}: {replies:?}"));
        assert_eq!((said.code, said.is_error()), (Some(code), false), "{command}");
        s.run_line("UNDO");
        assert!(s.objects()[0].volume.is_some(), "{command}");
    }
    // The loss of a body is reported only if there was one.
    let mut s = with(cuboid([4.0, 3.0, 2.0]));
    assert!(s.run_line("DELETE DIMENSION D1").iter().all(|r| r.about.kind != "no-faces"));
}

/// Points that are far apart on the page are welded with a warning.
#[test]
fn a_weld_across_the_page() {
    let mut s = SketchSession::new();
    s.run_text("SKETCH A 2D XZ\nPOINT 1 0 0; POINT 2 100 0; POINT 3 101 1; POINT 4 100 80\nLINE 1 2; LINE 3 4");
    let far = |replies: Vec<CommandReply>| {
        replies.into_iter().find(|r| r.about.kind == "far-weld").map(|r| r.text)
    };
    assert_eq!(far(s.run_line("WELD 2 3")), None);
    let said = far(s.run_line("WELD 1 4"));
    assert_eq!(said.as_deref(), Some("points 1 and 4 were 128 apart on the page"));
}

/// Coordinates whose volumes are no numbers leave no body, by that name.
#[test]
fn coordinates_beyond_all_bounds() {
    let mut s = with(with_faces(cuboid([4.0, 3.0, 2.0])));
    let replies = s.run_text("SET D1 1e308\nSET D2 1e308");
    assert_eq!(s.objects()[0].volume, None);
    let last = replies.iter().rfind(|r| r.about.kind == "not-finite");
    assert!(last.is_some_and(|r| r.text.contains("beyond 1e60")), "{replies:?}");
    s.run_text("SET D1 1e40\nSET D2 1e40\nSET D3 1e40");
    assert!((s.objects()[0].volume.unwrap() / 1e120 - 1.0).abs() < 1e-12);
}
