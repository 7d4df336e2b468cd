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
    let changes = s.commit();
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
    assert!(s.commit().is_empty());
    // A move and back is no step.
    s.begin().unwrap();
    let p = moved.drawing.points[&PointId(7)];
    s.run_line("POINT 7 0 0");
    s.run_line(&format!("POINT 7 {} {}", p.u, p.v));
    assert!(s.commit().is_empty() && s.journal().len() == settled);
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
    let case = case_named("T14");
    let count = case.object.clone();
    s.insert(count);
    let name = s.active_object().unwrap().name.clone();
    let all = s.candidates(&name).unwrap();
    assert_eq!(all.len(), 3);
    assert!(all.iter().all(|c| c.mesh(1.0).report().closed));
    assert!(s.candidates("NONE").is_err());
}
