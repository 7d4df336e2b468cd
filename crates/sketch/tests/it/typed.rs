//! Commands as data, change sets, drags, candidates.

use crate::common::*;
use moldloft_sketch::*;

fn ok(report: CommandReport) -> Vec<ObjectChange> {
    assert!(report.replies.iter().all(|r| !r.is_error()), "{:?}", report.replies);
    report.changes
}

#[test]
fn typed_commands_are_their_texts() {
    let number = DimensionExpr::number;
    let along = |axis, p, q| MeasuredQuantity::Along { axis, p: PointId(p), q: PointId(q) };
    let point = |id, u, v| SketchCommand::Point { id: Some(PointId(id)), at: [u, v] };
    let line = |p, q| SketchCommand::Line { p: PointId(p), q: PointId(q), free: None };
    let dim = |name: &str, measure, x| SketchCommand::Dimension {
        name: Some(name.into()),
        measure,
        value: number(x),
    };
    use CoordinateAxis::{X, Z};
    let commands = [
        SketchCommand::Sketch { name: "PLATE 2".into(), section: Some(CoordinateAxis::Y) },
        point(1, 0.0, 0.0),
        point(2, 90.5, 1.0),
        point(3, 91.0, 30.0),
        point(4, 1.0, 29.25),
        line(1, 2),
        line(2, 3),
        line(3, 4),
        line(4, 1),
        dim("W", along(X, 1, 2), 8.0),
        SketchCommand::Variable { name: "R".into(), value: number(2.0) },
        SketchCommand::Dimension {
            name: None,
            measure: along(Z, 1, 4),
            value: DimensionExpr::parse("R*2").unwrap(),
        },
        SketchCommand::Extrude(number(5.0)),
    ];
    let mut typed = SketchSession::new();
    let mut text = SketchSession::new();
    for command in &commands {
        ok(typed.edit(command));
        text.run_line(&command.to_string());
    }
    assert_eq!(typed.object("PLATE 2"), text.object("PLATE 2"));
    assert_eq!(typed.objects()[0].volume, Some(160.0));
    let changes = ok(typed.edit(&SketchCommand::Set { name: "R".into(), value: number(3.0) }));
    let [change] = &changes[..] else { panic!("{changes:?}") };
    assert_eq!(change.numbers, ["R"]);
    // The upper points and those of their copies move; every face but the lower one.
    assert_eq!(change.moved.len(), 4);
    assert_eq!(change.faces.len(), 5);
    assert!(change.body && change.drawn.is_empty() && !change.added);
    assert!(ok(typed.report("CHECK")).is_empty());
    assert!(ok(typed.edit(&SketchCommand::Undo))[0].body);
    let gone = ok(typed.report("DELETE \"PLATE 2\""));
    assert!(gone[0].removed);
}

#[test]
fn a_drag_is_one_step() {
    let mut s = SketchSession::new();
    s.insert(with_faces(cuboid([4.0, 3.0, 2.0])));
    let at_first = s.object("A").unwrap().clone();
    let (undone, before) = (s.history().len(), s.journal().len());
    s.begin().unwrap();
    assert!(s.begin().is_err());
    for k in 0..700 {
        let at = [f64::from(k), 0.5 * f64::from(k)];
        ok(s.edit(&SketchCommand::Point { id: Some(PointId(7)), at }));
        // Nothing of it is settled yet.
        assert_eq!(s.journal().len(), before);
    }
    assert!(s.run_line("UNDO")[0].is_error());
    let changes = s.commit().changes;
    assert_eq!((changes.len(), &changes[0].drawn[..]), (1, &[PointId(7)][..]));
    assert_eq!(&s.journal()[before..], ["POINT 7 AT 699 349.5"]);
    assert!(s.history().len() > undone);
    let moved = s.object("A").unwrap().clone();
    s.run_line("UNDO");
    assert_eq!(*s.object("A").unwrap(), at_first);
    s.run_line("REDO");
    assert_eq!(*s.object("A").unwrap(), moved);
    // The line of the journal does it again.
    let mut other = SketchSession::new();
    other.insert(at_first.clone());
    other.run_line("POINT 7 AT 699 349.5");
    assert_eq!(*other.object("A").unwrap(), moved);
    // A drag that is given up leaves nothing.
    let settled = s.journal().len();
    s.begin().unwrap();
    s.run_line("POINT 1 5 5; POINT 2 6 6");
    s.rollback();
    assert_eq!((s.object("A").unwrap(), s.journal().len()), (&moved, settled));
    assert!(s.commit().changes.is_empty());
    // A move and back is no step.
    s.begin().unwrap();
    let p = moved.drawing.points[&PointId(7)];
    s.run_line("POINT 7 0 0");
    s.run_line(&format!("POINT 7 {} {}", p.u, p.v));
    assert!(s.commit().changes.is_empty() && s.journal().len() == settled);
}

#[test]
fn what_is_missing_and_what_fits_are_data() {
    let mut s = SketchSession::new();
    s.run_text(
        "SKETCH A 2D XZ\nPOINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
         POLYLINE 1 2 3 4 CLOSE; DIM W X 1 2 = 8",
    );
    let missing = s.suggestions("A").unwrap();
    let found = missing[0].unwrap();
    assert_eq!((missing.len(), found.axis), (1, CoordinateAxis::Z));
    assert!((found.value - 2.5).abs() < 0.1, "{found:?}");
    assert!(s.suggestions("B").is_none());
    // A cube in a cube, corners joined: each of three directions may be a tunnel.
    let mut s = SketchSession::new();
    s.insert(cuboid([6.0; 3]));
    let mut inner = cuboid([2.0; 3]);
    inner.name = "I".into();
    s.insert(inner);
    s.run_text("MOVE I 2 2 2; MERGE A I INTO C");
    for k in 1..=8 {
        s.run_line(&format!("LINE FROM {k} TO {} TYPE O", k + 8));
    }
    let name = "C".to_owned();
    let all = s.candidates(&name).unwrap();
    assert_eq!(all.len(), 3);
    assert!(all.iter().all(|c| c.mesh(1.0).report().closed));
    assert!(s.candidates("NONE").is_err());
}

/// A rounded plate with a round hole, as another program draws it.
#[test]
fn arcs_and_circles_are_imported() {
    struct Shelf(&'static str);
    impl Files for Shelf {
        fn read(&self, _: &str) -> Result<String, String> {
            Ok(self.0.to_owned())
        }
    }
    const DXF: &str = "0\nSECTION\n2\nENTITIES\n\
        0\nLINE\n10\n10\n20\n0\n11\n80\n21\n0\n0\nARC\n10\n80\n20\n10\n40\n10\n50\n270\n51\n0\n\
        0\nLINE\n10\n90\n20\n10\n11\n90\n21\n40\n0\nLINE\n10\n90\n20\n40\n11\n0\n21\n40\n\
        0\nLINE\n10\n0\n20\n40\n11\n0\n21\n10\n0\nARC\n10\n10\n20\n10\n40\n10\n50\n180\n51\n270\n\
        0\nCIRCLE\n10\n45\n20\n20\n40\n8\n0\nTEXT\n1\nplan\n0\nENDSEC\n0\nEOF\n";
    const BULGES: &str = "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n70\n1\n10\n10\n20\n0\n10\n80\n20\n0\n\
        42\n0.41421356237309503\n10\n90\n20\n10\n10\n90\n20\n40\n10\n0\n20\n40\n10\n0\n20\n10\n42\n0.41421356237309503\n\
        0\nCIRCLE\n10\n45\n20\n20\n40\n8\n0\nINSERT\n0\nENDSEC\n0\nEOF\n";
    const SVG: &str = "<svg><path d='M10-0H80A10 10 0 0 0 90-10V-40H0V-10a10 10 0 0 0 10 10'/>\
        <circle cx='45' cy='-20' r='8'/><text>plan</text></svg>";
    let truth = 90.0 * 40.0
        - 2.0 * (1.0 - std::f64::consts::PI / 4.0) * 100.0
        - 64.0 * std::f64::consts::PI;
    for (file, text) in [("a.dxf", DXF), ("b.dxf", BULGES), ("c.svg", SVG)] {
        let mut s = SketchSession::with_files(Box::new(Shelf(text)));
        let replies = s.run_text(&format!("SKETCH P 2D XY\nIMPORT \"{file}\""));
        assert!(replies.iter().all(|r| !r.is_error()), "{file}: {replies:?}");
        let reported = replies.iter().find(|r| r.text.contains("not drawn"));
        assert!(reported.is_some(), "{file}: {replies:?}");
        let object = s.object("P").unwrap();
        assert_eq!((object.drawing.points.len(), object.drawing.lines.len()), (8, 8), "{file}");
        assert_eq!((object.curves.len(), object.variables.len()), (3, 1), "{file}");
        let journal = s.journal().join("\n");
        let p = object.drawing.points.iter();
        let at = |u: f64, v: f64| {
            let near = |q: &DrawnPoint| (q.u - u).abs() < 1e-6 && (q.v - v).abs() < 1e-6;
            p.clone().find(|(_, q)| near(q)).map(|(id, _)| *id).unwrap()
        };
        let (a, b, d) = (at(0.0, 0.0), at(90.0, 0.0), at(0.0, 40.0));
        let (c, e, f) = (at(37.0, 12.0), at(53.0, 12.0), at(37.0, 28.0));
        let replies = s.run_text(&format!(
            "DIM X {a} {b} 90; DIM Y {a} {d} 40; DIM X {a} {c} 37; DIM Y {a} {c} 12
             DIM X {c} {e} 16; DIM Y {c} {f} 16; GENERATE FACES"
        ));
        assert!(replies.iter().all(|r| !r.is_error()), "{file}: {replies:?}");
        let area = s.objects()[0].area.unwrap();
        assert!((area - truth).abs() < 1e-9 * truth, "{file}: {area} for {truth}");
        // The journal needs no file.
        let mut again = SketchSession::new();
        again.run_text(&journal);
        let imported = |o: &SketchObject| (o.drawing.points.clone(), o.curves.clone());
        assert_eq!(imported(again.object("P").unwrap()), imported(s.object("P").unwrap()));
    }
}

/// Random commands as data, in and out of drags, with unusual numbers and names: no panic, queries
/// between them are answered, and the journal reproduces the objects.
#[test]
fn any_typed_commands() {
    use moldloft_testing::{Random, rounds};
    let mut random = Random::new(31);
    for round in 0..rounds(4, 5_000) {
        let mut s = SketchSession::new();
        let mut dragging = false;
        for _ in 0..40 {
            let number = |r: &mut Random| match r.below(12) {
                0 => f64::NAN,
                1 => f64::INFINITY,
                2 => -1e308,
                3 => 0.0,
                4 => 1e-300,
                _ => (r.below(9) as f64 - 2.0) * 10.0,
            };
            let expression = |r: &mut Random| {
                let odd = ["W*2", "R+W", "1/0", "W", "sqrt(-1)"];
                let parsed = DimensionExpr::parse(odd[r.below(odd.len())]);
                match (r.chance(30), parsed) {
                    (true, Ok(e)) => e,
                    _ => DimensionExpr::number((r.below(9) + 1) as f64),
                }
            };
            let names = ["W", "R", "A B", "\"", "", "W;QUIT", "µ", "a.b"];
            let name = |r: &mut Random| names[r.below(names.len())].to_owned();
            let point = |r: &mut Random| PointId(*r.pick(&[0, 1, 2, 3, 4, 5, 6, u32::MAX]));
            let line = |r: &mut Random| LineId(*r.pick(&[0, 1, 2, 3, 4, 5, u32::MAX]));
            let axis = |r: &mut Random| *r.pick(&CoordinateAxis::ALL);
            let command = match random.below(16) {
                0 => SketchCommand::Sketch {
                    name: name(&mut random),
                    section: random.chance(70).then_some(CoordinateAxis::Y),
                },
                1..=4 => SketchCommand::Point {
                    id: random.chance(80).then(|| point(&mut random)),
                    at: [number(&mut random), number(&mut random)],
                },
                5..=7 => SketchCommand::Line {
                    p: point(&mut random),
                    q: point(&mut random),
                    free: random.chance(30).then(|| Free::along(axis(&mut random))),
                },
                8 => SketchCommand::Type { line: line(&mut random), free: Free::OBLIQUE },
                9 | 10 => SketchCommand::Dimension {
                    name: random.chance(50).then(|| name(&mut random)),
                    measure: match random.below(4) {
                        0 => MeasuredQuantity::Length(line(&mut random)),
                        1 => MeasuredQuantity::Angle(line(&mut random), line(&mut random)),
                        _ => MeasuredQuantity::Along {
                            axis: axis(&mut random),
                            p: point(&mut random),
                            q: point(&mut random),
                        },
                    },
                    value: expression(&mut random),
                },
                11 => SketchCommand::Variable {
                    name: name(&mut random),
                    value: expression(&mut random),
                },
                12 => {
                    SketchCommand::Set { name: name(&mut random), value: expression(&mut random) }
                }
                13 => match random.below(3) {
                    0 => SketchCommand::DeletePoint(point(&mut random)),
                    1 => SketchCommand::DeleteLine(line(&mut random)),
                    _ => SketchCommand::DeleteDimension(name(&mut random)),
                },
                14 => match random.below(2) {
                    0 => SketchCommand::GenerateFaces,
                    _ => SketchCommand::Extrude(expression(&mut random)),
                },
                _ => match random.below(2) {
                    0 => SketchCommand::Undo,
                    _ => SketchCommand::Redo,
                },
            };
            s.edit(&command);
            match random.below(12) {
                0 => dragging = s.begin().is_ok() || dragging,
                1 if dragging => {
                    s.commit();
                    dragging = false;
                }
                2 if dragging => {
                    s.rollback();
                    dragging = false;
                }
                3 => {
                    for name in s.names() {
                        s.suggestions(&name);
                        let _ = s.candidates(&name);
                        s.preview(&name);
                        s.dimension_marks(&name, None);
                        s.dimension_marks(&name, Some("iso"));
                        let object = s.object(&name).unwrap();
                        object.drawing.snaps(
                            [number(&mut random), 0.0],
                            number(&mut random),
                            None,
                            &[],
                        );
                    }
                    s.report("CHECK");
                }
                _ => {}
            }
        }
        if dragging {
            s.commit();
        }
        let mut again = SketchSession::new();
        for line in s.journal() {
            again.run_line(line);
        }
        let texts = |s: &SketchSession| -> Vec<String> {
            s.names().iter().filter_map(|n| s.object(n)).map(script).collect()
        };
        assert_eq!(texts(&s), texts(&again), "round {round}: {:#?}", s.journal());
    }
}
