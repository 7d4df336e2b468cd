//! Meanings of a pointer position on the page.

use moldloft_sketch::*;

#[test]
fn snaps_are_in_order_of_strength() {
    let mut s = SketchSession::new();
    s.run_text("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 100 0; POINT 3 160 80; LINE 1 2; LINE 2 3");
    let drawing = &s.active_object().unwrap().drawing;
    let kinds = |at, start, awake: &[PointId]| -> Vec<SnapKind> {
        drawing.snaps(at, 5.0, start, awake).iter().map(|s| s.kind).collect()
    };
    assert_eq!(kinds([1.0, 1.0], None, &[])[0], SnapKind::Point);
    let middle = &drawing.snaps([50.5, 2.0], 5.0, None, &[])[0];
    assert_eq!((middle.kind, middle.at), (SnapKind::Middle, [50.0, 0.0]));
    assert_eq!(kinds([30.0, 2.0], None, &[])[0], SnapKind::Line);
    // The corner that closes a parallelogram: from (60, 80) along x, over the axis through point 2.
    let cross = &drawing.snaps([101.0, 79.0], 5.0, Some([60.0, 80.0]), &[])[0];
    assert_eq!((cross.kind, cross.at), (SnapKind::Cross, [100.0, 80.0]));
    assert_eq!(cross.of, [PointId(2)]);
    // Extension of line 2 beyond point 3, and its parallel through the start.
    let beyond = [160.0 + 48.0, 80.0 + 64.0];
    let found = &drawing.snaps(beyond, 2.0, None, &[PointId(3)])[0];
    assert_eq!((found.kind, &found.of[..]), (SnapKind::Extension, &[PointId(3)][..]));
    assert!(matches!(found.directions[..], [SnapDirection::Line(LineId(2))]));
    let parallel = drawing.snaps([-140.0, 80.0], 2.0, Some([-200.0, 0.0]), &[PointId(3)]);
    assert!(parallel.iter().any(|s| s.kind == SnapKind::Parallel), "{parallel:?}");
    // An axis of a point that sleeps is the last of all; nothing is far from everything.
    assert_eq!(kinds([300.0, 81.0], None, &[]), [SnapKind::Axis]);
    assert_eq!(kinds([1e6, 1e5], None, &[]), []);
    for at in [[f64::NAN, 0.0], [f64::INFINITY, 0.0]] {
        drawing.snaps(at, 5.0, Some([0.0, 0.0]), &[PointId(9)]);
    }
}
