//! Bodies: mass of every case with its derivatives, curves and the lines that they replace (T7,
//! T12).

use crate::common::*;
use moldloft_mesh::measure;
use moldloft_num::{Dual, Vec3};
use moldloft_sketch::curve::{CurveFault, CurveKind, SketchCurve, SmoothPiece, semi_axes, trace};
use moldloft_sketch::solid::UnbuiltReason;
use moldloft_sketch::*;
use std::f64::consts::PI;

fn close(a: f64, b: f64, accuracy: f64) {
    assert!((a - b).abs() <= accuracy, "{a} for {b}");
}

fn near(a: Vec3, b: [f64; 3]) {
    assert!(a.distance(b.into()) < 1e-6, "{a:?} for {b:?}");
}

/// Closed, outward, and of the volume that the formulas give.
fn check_mesh(solid: &SketchSolid<f64>, accuracy: f64) {
    let mesh = solid.mesh(1e-4);
    let report = mesh.report();
    assert!(report.closed && report.manifold && report.oriented, "{report:?}");
    assert_eq!(report.outward, Some(true));
    let (m, exact) = (measure(&mesh), solid.mass());
    close(m.volume, exact.volume, accuracy * exact.volume);
    close(m.area, exact.area, accuracy * exact.area);
}

#[test]
fn mass_of_every_case() {
    for case in cases() {
        let solid = built(&with_faces(case.object));
        let mass = solid.mass();
        close(mass.volume, case.volume, 1e-9 * case.volume);
        close(mass.area, case.area, 1e-6);
        assert!(mass.centroid.distance(case.centroid) < 2e-6, "{}", case.id);
        check_mesh(&solid, 1e-12);
    }
}

#[test]
fn inertia_of_a_box_is_the_textbook_one() {
    let mut object = with_faces(cuboid([10.0, 6.0, 4.0]));
    object.reference = Some(Reference::number(PointId(1), [100.0, -20.0, 3.0]));
    let mass = built(&object).mass();
    let expected = [240.0 * 52.0 / 12.0, 240.0 * 116.0 / 12.0, 240.0 * 136.0 / 12.0, 0.0, 0.0, 0.0];
    for (a, b) in mass.inertia.iter().zip(expected) {
        close(*a, b, 1e-8);
    }
}

/// The derivative of the volume by each dimension, against central differences.
#[test]
fn volume_by_every_dimension() {
    for case in cases() {
        let object = with_faces(case.object);
        let planes = Planes::of(&object.drawing);
        for (key, d) in &object.dimensions {
            let value = d.value.as_ref().unwrap().literal().unwrap();
            let volume = |v: f64| {
                let one = [(key.clone(), v)].into_iter().collect();
                let layout = solve::<f64>(&object, &planes, &one, &|| None);
                solid(&object, &planes, &layout).unwrap().mass().volume
            };
            let seeded = [(key.clone(), Dual::<1>::seeded(value, 0))].into_iter().collect();
            let layout = solve(&object, &planes, &seeded, &|| None);
            let exact = solid(&object, &planes, &layout).unwrap().mass().volume;
            let h = 1e-5;
            let slope = (volume(value + h) - volume(value - h)) / (2.0 * h);
            close(exact.eps[0], slope, 1e-5 * slope.abs().max(1.0));
            assert_eq!(exact.re, volume(value), "{} {key}", case.id);
        }
    }
}

/// Crossing the corner of two boxes' fillets: T7.
#[test]
fn a_box_with_a_fillet() {
    let mut object = with_faces(cuboid([10.0, 6.0, 4.0]));
    add_curve(&mut object, curve("C1", CurveKind::Arc, &[5, 6, 2], &["R"]));
    add_curve(&mut object, curve("C2", CurveKind::Arc, &[8, 7, 3], &["R"]));
    let radius = |value: &str| Variable {
        name: "R".into(),
        value: DimensionExpr::parse(value).unwrap(),
        range: None,
    };
    object.variables.insert("r".into(), radius("2"));
    let body = built(&object);
    assert!(body.unbuilt.is_empty(), "{:?}", body.unbuilt);
    let [t1, t2] = body.curves[&0].tangents.unwrap();
    near(t1, [8.0, 0.0, 4.0]);
    near(t2, [10.0, 0.0, 2.0]);
    near(body.curves[&0].centre.unwrap(), [8.0, 0.0, 2.0]);
    let piece = body.curves[&0].pieces[0];
    near(piece.at(0.5), [9.414_213_562, 0.0, 3.414_213_562]);
    close(piece.length(), PI, 1e-12);
    near(body.curves[&1].tangents.unwrap()[0], [8.0, 6.0, 4.0]);
    near(body.curves[&1].centre.unwrap(), [8.0, 6.0, 2.0]);
    assert_eq!((body.vertices.len(), body.edges.len(), body.faces.len()), (10, 15, 7));
    let ids: Vec<u32> = body.vertices.iter().map(|v| v.id.0).collect();
    assert!(!ids.contains(&6) && !ids.contains(&7) && ids.contains(&12));
    let mass = body.mass();
    close(mass.volume, 240.0 - 6.0 * (4.0 - PI), 1e-9);
    close(mass.area, 241.132_741, 1e-6);
    check_mesh(&body, 1e-4);
    // 18 chords of 5°.
    for c in object.curves.values_mut() {
        c.steps = Some(18);
    }
    close(measure(&built(&object).mesh(1.0)).volume, 234.825_640, 1e-6);
    // The volume by the radius: -2 R (2 - π/2)·6 / ... = -12 (2 - π/2) at R = 2.
    let planes = Planes::of(&object.drawing);
    let seeded = [("r".to_owned(), Dual::<1>::seeded(2.0, 0))].into_iter().collect();
    let layout = solve(&object, &planes, &seeded, &|| None);
    let volume = solid(&object, &planes, &layout).unwrap().mass().volume;
    close(volume.eps[0], -6.0 * 2.0 * 2.0 * (1.0 - PI / 4.0), 1e-9);
    object.variables.insert("r".into(), radius("5"));
    let body = built(&object);
    let UnbuiltReason::Curve(CurveFault::TooLarge { largest }) = body.unbuilt[0].why else {
        panic!("{:?}", body.unbuilt)
    };
    close(largest, 4.0, 1e-12);
    close(body.mass().volume, 240.0, 1e-9);
}

#[test]
fn one_fillet_alone_runs_out_in_a_cone() {
    let mut object = with_faces(cuboid([10.0, 6.0, 4.0]));
    add_curve(&mut object, curve("C1", CurveKind::Arc, &[5, 6, 2], &["2"]));
    let body = built(&object);
    assert!(body.unbuilt.is_empty());
    assert_eq!((body.vertices.len(), body.faces.len()), (9, 7));
    // A third of the prism is lost.
    close(body.mass().volume, 240.0 - 6.0 * (4.0 - PI) / 3.0, 1e-9);
    check_mesh(&body, 1e-3);
}

#[test]
fn four_fillets_and_their_limits() {
    let mut object = with_faces(cuboid([10.0, 6.0, 4.0]));
    for (k, [a, m, b]) in
        [[4, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 1], [8, 5, 6], [5, 6, 7], [6, 7, 8], [7, 8, 5]]
            .into_iter()
            .enumerate()
    {
        add_curve(&mut object, curve(&format!("C{k}"), CurveKind::Arc, &[a, m, b], &["3"]));
    }
    // Radius 3 uses up the short sides: a slab with round ends, its tangent points shared.
    let body = built(&object);
    assert!(body.unbuilt.is_empty(), "{:?}", body.unbuilt);
    assert_eq!((body.vertices.len(), body.faces.len()), (12, 8));
    close(body.mass().volume, 4.0 * (4.0 * 6.0 + 9.0 * PI), 1e-9);
    check_mesh(&body, 1e-3);
    // A little more and the tangent points pass each other.
    for c in object.curves.values_mut() {
        c.radius = Some(DimensionExpr::number(3.5));
    }
    let body = built(&object);
    assert!(body.unbuilt.iter().any(|t| matches!(t.why, UnbuiltReason::Overlap(..))));
}

#[test]
fn circles_and_ellipses_make_cylinders() {
    for (size, area) in [([6.0, 6.0], 9.0 * PI), ([10.0, 6.0], 15.0 * PI)] {
        let mut object = with_faces(cuboid([size[0], size[1], 4.0]));
        let kind = if size[0] == size[1] { CurveKind::Circle } else { CurveKind::Ellipse };
        add_curve(&mut object, curve("E1", kind, &[1, 2, 3], &[]));
        add_curve(&mut object, curve("E2", kind, &[5, 6, 7], &[]));
        let body = built(&object);
        assert!(body.unbuilt.is_empty(), "{:?}", body.unbuilt);
        assert_eq!((body.vertices.len(), body.edges.len(), body.faces.len()), (8, 12, 6));
        close(body.mass().volume, 4.0 * area, 1e-9);
        check_mesh(&body, 1e-3);
    }
}

#[test]
fn quadratics_bend_two_faces() {
    // A parabola over two lines at both ends of a prism.
    let p = Projection::default();
    let mut points = Vec::new();
    for y in [0.0, 5.0] {
        for (x, z) in [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 4.0), (0.0, 3.0)] {
            let [u, v] = p.project(Vec3::new(x, y, z));
            points.push((u, v));
        }
    }
    let mut object = drawn(p.angle_deg, &points);
    add_lines(&mut object, "X", "1-2 6-7");
    add_lines(&mut object, "Z", "2-3 7-8 1-5 6-10");
    add_lines(&mut object, "F", "3-4 8-9 4-5 9-10");
    add_lines(&mut object, "Y", "1-6 2-7 3-8 4-9 5-10");
    for d in ["X 1 4 2", "X 4 2 2", "Y 1 6 5", "Z 1 3 3", "Z 3 5 0", "Z 3 4 1"] {
        add_dimension(&mut object, d);
    }
    let mut object = with_faces(object);
    add_curve(&mut object, curve("Q1", CurveKind::Quadratic, &[3, 4, 5], &[]));
    add_curve(&mut object, curve("Q2", CurveKind::Quadratic, &[8, 9, 10], &[]));
    let body = built(&object);
    assert!(body.unbuilt.is_empty(), "{:?}", body.unbuilt);
    // Under the parabola of height 1 and width 4 there are 8/3.
    close(body.mass().volume, 5.0 * (12.0 + 8.0 / 3.0), 1e-9);
    assert_eq!(body.faces.iter().filter(|f| f.ruled).count(), 2);
    check_mesh(&body, 1e-3);
    // One end only: ruled patches between the parabola and straight lines.
    object.curves.shift_remove("q2");
    let body = built(&object);
    close(body.mass().volume, 5.0 * (12.0 + (8.0 / 3.0 + 2.0) / 2.0), 1e-9);
    check_mesh(&body, 1e-3);
}

fn traced(curve: &SketchCurve, points: &[[f64; 3]]) -> Result<curve::Traced<f64>, CurveFault> {
    let at = |p: PointId| points.get(p.0 as usize - 1).map(|&p| p.into());
    trace(curve, &at, &Default::default())
}

#[test]
fn closed_forms_of_the_curves() {
    let arc = |r| curve("A", CurveKind::Arc, &[1, 2, 3], &[r]);
    let t = traced(&arc("2"), &[[10.0, 0.0, 0.0], [0.0; 3], [5.0, 8.660_254_037_844_386, 0.0]])
        .unwrap();
    let SmoothPiece::Conic { sweep, .. } = t.pieces[0] else { panic!("an arc is a conic") };
    close(sweep, 2.0 * PI / 3.0, 1e-12);
    close(t.tangents.unwrap()[0].x, 3.464_102, 1e-6);
    near(t.tangents.unwrap()[1], [1.732_051, 3.0, 0.0]);
    near(t.centre.unwrap(), [3.464_102, 2.0, 0.0]);
    near(t.pieces[0].at(0.5), [1.732_051, 1.0, 0.0]);
    let t = traced(&arc("1"), &[[3.0, 0.0, 4.0], [0.0; 3], [0.0, 5.0, 0.0]]).unwrap();
    near(t.centre.unwrap(), [0.6, 1.0, 0.8]);
    near(t.tangents.unwrap()[0], [0.6, 0.0, 0.8]);
    near(t.tangents.unwrap()[1], [0.0, 1.0, 0.0]);
    let line = [[3.0, 0.0, 0.0], [0.0; 3], [-5.0, 0.0, 0.0]];
    assert_eq!(traced(&arc("1"), &line), Err(CurveFault::Degenerate));
    assert_eq!(traced(&arc("0"), &line[..2]), Err(CurveFault::Undetermined));
    let corner = [[3.0, 0.0, 0.0], [0.0; 3], [0.0, 5.0, 0.0]];
    assert_eq!(traced(&arc("-1"), &corner), Err(CurveFault::NotPositive { value: -1.0 }));
    assert_eq!(traced(&arc("w"), &corner), Err(CurveFault::NoValue { reads: "w".into() }));
    let circle = curve("C", CurveKind::Circle, &[1, 2, 3], &[]);
    let t = traced(&circle, &[[3.0, 0.0, 0.0], [0.0; 3], [0.0, 3.0, 0.0]]).unwrap();
    near(t.centre.unwrap(), [1.5, 1.5, 0.0]);
    close(t.pieces[0].length(), 3.0 * PI, 1e-9);

    let quadratic = curve("Q", CurveKind::Quadratic, &[1, 2, 3], &[]);
    let t = traced(&quadratic, &[[0.0; 3], [1.0, 2.0, 0.0], [4.0, 0.0, 0.0]]).unwrap();
    near(t.pieces[0].at(0.5), [0.25, 1.5, 0.0]);
    near(t.pieces[0].at(1.0), [1.0, 2.0, 0.0]);
    near(t.pieces[1].at(0.5), [2.25, 1.5, 0.0]);
    near(t.pieces[1].at(1.0), [4.0, 0.0, 0.0]);

    let mut cubic = curve("O", CurveKind::Cubic, &[1, 2, 3, 4, 5], &[]);
    let p = [[0.0; 3], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 1.0]];
    let t = traced(&cubic, &p).unwrap();
    for (s, at) in
        [(0.0, [1.0, 1.0]), (0.25, [1.25, 1.09375]), (0.5, [1.5, 1.125]), (1.0, [2.0, 1.0])]
    {
        near(t.pieces[0].at(s), [at[0], at[1], 0.0]);
    }
    // Pieces of a chain meet smoothly, whatever the knots.
    for centripetal in [false, true] {
        cubic.centripetal = centripetal;
        let t = traced(&cubic, &p).unwrap();
        assert_eq!(t.pieces.len(), 2);
        near(t.pieces[1].at(0.0), p[2]);
        let (a, b) = (t.pieces[0].velocity(1.0), t.pieces[1].velocity(0.0));
        assert!(a.cross(b).norm() < 1e-12 && a.dot(b) > 0.0);
    }

    let sixty = [5.0 * 0.5, 5.0 * 0.866_025_403_784_438_6, 0.0];
    let mut ellipse = curve("E", CurveKind::EllipticalArc, &[1, 2, 3], &["4", "2"]);
    let t = traced(&ellipse, &[[9.0, 0.0, 0.0], [0.0; 3], sixty]).unwrap();
    near(t.centre.unwrap(), [5.0, 1.732_051, 0.0]);
    near(t.pieces[0].at(0.0), [4.0, 0.0, 0.0]);
    near(t.pieces[0].at(0.5), [1.464_466, 0.507_306, 0.0]);
    near(t.pieces[0].at(1.0), [1.0, 1.732_051, 0.0]);
    let SmoothPiece::Conic { a, b, .. } = t.pieces[0] else { panic!("an ellipse is a conic") };
    let [long, short] = semi_axes(a, b);
    close(long, 4.148_627, 1e-6);
    close(short, 1.669_999, 1e-6);
    close(PI * long * short, 21.765_592, 1e-6);
    ellipse.semi = Some([DimensionExpr::number(5.0), DimensionExpr::number(3.0)]);
    let t = traced(&ellipse, &[[9.0, 0.0, 0.0], [0.0; 3], [0.0, 4.0, 0.0]]).unwrap();
    near(t.centre.unwrap(), [5.0, 3.0, 0.0]);
    near(t.pieces[0].at(0.5), [1.464_466, 0.878_680, 0.0]);
    let SmoothPiece::Conic { a, b, .. } = t.pieces[0] else { panic!("an ellipse is a conic") };
    assert_eq!(semi_axes(a, b), [5.0, 3.0]);
    ellipse.semi = Some([DimensionExpr::number(50.0), DimensionExpr::number(3.0)]);
    let t = traced(&ellipse, &[[9.0, 0.0, 0.0], [0.0; 3], [0.0, 4.0, 0.0]]);
    assert_eq!(t, Err(CurveFault::TooLarge { largest: 9.0 }));
    // Laws: reversal, and the number of chords keeps the tolerance.
    for piece in [t_piece(&traced(&arc("2"), &corner)), t_piece(&traced(&cubic, &p))] {
        let back = piece.reversed();
        for k in 0..=10 {
            let s = f64::from(k) / 10.0;
            assert!(piece.at(s).distance(back.at(1.0 - s)) < 1e-12);
            let h = 1e-6;
            let slope = (piece.at(s + h) - piece.at(s - h)) / (2.0 * h);
            assert!(slope.distance(piece.velocity(s)) < 1e-8);
        }
        let n = piece.chords(1e-3);
        for k in 0..n {
            let at = |x: f64| piece.at((k as f64 + x) / n as f64);
            let off = (at(0.0) + at(1.0)) * 0.5 - at(0.5);
            assert!(off.norm() <= 1.01e-3);
        }
    }
}

fn t_piece(t: &Result<curve::Traced<f64>, CurveFault>) -> SmoothPiece<f64> {
    t.as_ref().unwrap().pieces[0]
}

#[test]
fn a_change_of_one_dimension_of_a_large_sketch_is_quick() {
    // A stepped prism of 1000 points.
    let n = 500;
    let p = Projection::default();
    let mut profile = vec![(0.0, 0.0)];
    let steps = (n - 2) / 2;
    for k in 0..steps {
        profile.push(((steps - k) as f64, k as f64));
        profile.push(((steps - k) as f64, k as f64 + 1.0));
    }
    profile.push((0.0, steps as f64));
    let mut points = Vec::new();
    for y in [0.0, 5.0] {
        for &(x, z) in &profile {
            let [u, v] = p.project(Vec3::new(x, y, z));
            points.push((u, v));
        }
    }
    let mut object = drawn(p.angle_deg, &points);
    let n = profile.len();
    assert_eq!(2 * n, 1000);
    for at in [0, n] {
        for k in 0..n {
            let (a, b) = (at + k + 1, at + (k + 1) % n + 1);
            let (da, db) = (profile[k], profile[(k + 1) % n]);
            let kind = if da.0 == db.0 { "Z" } else { "X" };
            add_lines(&mut object, kind, &format!("{a}-{b}"));
        }
    }
    for k in 1..=n {
        add_lines(&mut object, "Y", &format!("{k}-{}", k + n));
    }
    add_dimension(&mut object, &format!("Y 1 {} 5", n + 1));
    for k in 0..steps {
        let from = if k + 1 == steps { 1 } else { 2 * k + 4 };
        add_dimension(&mut object, &format!("X {from} {} 1", 2 * k + 2));
        add_dimension(&mut object, &format!("Z {} {} 1", 2 * k + 2, 2 * k + 3));
    }
    let turn = |c: Vec<PointId>| c.into_iter().rev().collect::<Vec<_>>();
    let ids = |from: usize| (0..n).map(|k| PointId((from + k) as u32)).collect::<Vec<_>>();
    object.faces.insert(FaceId(1), SketchFace { outer: ids(1), holes: vec![] });
    object.faces.insert(FaceId(2), SketchFace { outer: turn(ids(n + 1)), holes: vec![] });
    for k in 0..n {
        let (a, b) = (k + 1, (k + 1) % n + 1);
        let outer = [a, a + n, b + n, b].map(|x| PointId(x as u32)).to_vec();
        object.faces.insert(FaceId(3 + k as u32), SketchFace { outer, holes: vec![] });
    }
    let planes = Planes::of(&object.drawing);
    let run = |d: f64| {
        let one = [("d1".to_owned(), d)].into_iter().collect();
        let layout = solve::<f64>(&object, &planes, &one, &|| None);
        assert!(layout.complete(), "{:?}", layout.counts);
        solid(&object, &planes, &layout).unwrap().mass().volume
    };
    let area = (steps * (steps + 1) / 2) as f64;
    close(run(5.0), 5.0 * area, 1e-6 * area);
    for k in 1..20 {
        close(run(f64::from(k)), f64::from(k) * area, 1e-6 * area);
    }
}
