//! Types, planes and dimensions: cases T1-T6, T8-T11, T14-T17.

use crate::common::*;
use moldloft_num::{Dual, Real, Vec3};
use moldloft_sketch::*;
use moldloft_testing::Random;

fn text(points: &[PointId]) -> String {
    points.iter().map(|p| p.to_string()).collect::<Vec<_>>().join(" ")
}

#[test]
fn planes_and_coordinates_of_every_case() {
    for case in cases() {
        let (planes, layout) = layout(&case.object);
        assert_eq!(planes.counts(), case.counts, "{}", case.id);
        assert!(planes.faults(&case.object.drawing).is_empty(), "{}", case.id);
        assert!(layout.complete() && layout.faults.is_empty(), "{}", case.id);
        for (k, count) in layout.counts.iter().enumerate() {
            assert_eq!(
                *count,
                Count { required: case.counts[k] - 1, given: case.counts[k] - 1, missing: 0 }
            );
        }
        let positions = layout.positions(&planes).unwrap();
        assert_eq!(positions, case.xyz, "{}", case.id);
    }
}

/// Principal lines are named by their slope; inclined ones by the planes their ends share, but for
/// the P lines of T11, which only P lines tie.
#[test]
fn every_case_types_itself() {
    for case in cases() {
        let mut drawing = (*case.object.drawing).clone();
        for line in drawing.lines.values_mut() {
            (line.free, line.source) = (None, LineTypeSource::Auto);
        }
        let proposed = drawing.type_all();
        for (id, truth) in &case.object.drawing.lines {
            let line = drawing.lines[id];
            let truth = truth.free.unwrap();
            if case.id.starts_with("T11") && line.proposed() {
                // Nothing says which coordinate stays: it is listed by CHECK.
                assert!(proposed.contains(id) && truth == Free::across(CoordinateAxis::X));
            } else {
                assert_eq!(line.free, Some(truth), "{} {}", case.id, drawing.line_text(*id));
                assert_eq!(proposed.contains(id), truth == Free::OBLIQUE);
            }
        }
    }
}

#[test]
fn wrong_names_degrade_their_neighbours() {
    let mut object = case_named("T5").object;
    let z = Some(Free::along(CoordinateAxis::Z));
    for (p, q) in [(4, 8), (8, 12)] {
        let id = object.drawing.line_between(PointId(p), PointId(q)).unwrap();
        object.draw().lines.get_mut(&id).unwrap().free = z;
    }
    let planes = Planes::of(&object.drawing);
    assert_eq!(planes.counts(), [4, 4, 3]);
    let mut degraded = Vec::new();
    for fault in planes.faults(&object.drawing) {
        let TypeFault::Degraded { line, named, really, path } = fault else { panic!("{fault:?}") };
        assert!(named == Free::OBLIQUE && !path.is_empty());
        let l = object.drawing.lines[&line];
        degraded.push(format!("{}-{} {}", l.p, l.q, really.spelling()));
    }
    degraded.sort();
    assert_eq!(degraded, ["1-5 YZ", "3-7 XZ", "5-9 YZ", "7-11 XZ"]);
}

#[test]
fn unaligned_counts_and_depths() {
    let counts = |id: &str, aligns: &[&str]| {
        let mut object = case_named(id).object;
        object.draw().aligns.clear();
        aligns.iter().for_each(|a| align(&mut object, a));
        Planes::of(&object.drawing).counts()
    };
    assert_eq!(counts("T6", &[]), [6, 6, 6]);
    assert_eq!(counts("T9", &[]), [6, 4, 7]);
    assert_eq!(counts("T5", &["X 1 9", "X 2 10", "Y 1 9", "Y 4 12"]), [4, 4, 3]);
}

/// The picture of the exact solid, estimated: visible quantities are recovered, open depths are
/// counted.
#[test]
fn the_estimate_recovers_what_the_picture_shows() {
    let depths = [
        ("T1", true, 0),
        ("T3", true, 0),
        ("T4", true, 0),
        ("T5", true, 2),
        ("T6", true, 0),
        ("T6", false, 2),
        ("T8", true, 1),
        ("T9", true, 0),
        ("T9", false, 1),
        ("T10", true, 0),
        ("T11", true, 0),
    ];
    for (id, aligned, deficiency) in depths {
        let case = case_named(&format!("{id} "));
        let mut object = case.object;
        let drawing = object.draw();
        if !aligned {
            drawing.aligns.clear();
        }
        for (k, xyz) in case.xyz.iter().enumerate() {
            let [u, v] = drawing.projection.project(*xyz);
            drawing.points.insert(PointId(k as u32 + 1), DrawnPoint { u: u + 7.0, v: v - 3.0 });
        }
        let planes = Planes::of(&object.drawing);
        let estimate = Estimate::of(&object.drawing, &planes, PointId(1)).unwrap();
        assert_eq!(estimate.depths.len(), deficiency, "{id}");
        if deficiency == 0 {
            for (k, xyz) in case.xyz.iter().enumerate() {
                let p = estimate.point(&planes, PointId(k as u32 + 1));
                assert!(p.distance(*xyz) < 1e-8, "{id} {p:?} {xyz:?}");
            }
        }
        for depth in &estimate.depths {
            // Moving the planes along a null vector leaves the picture as it is.
            for &point in &depth.points {
                let mut d = Vec3::zero();
                for &(axis, plane, m) in &depth.planes {
                    if planes.plane(axis, point) == Some(plane) {
                        d += Vec3::of(
                            if axis == CoordinateAxis::X { m } else { 0.0 },
                            if axis == CoordinateAxis::Y { m } else { 0.0 },
                            if axis == CoordinateAxis::Z { m } else { 0.0 },
                        );
                    }
                }
                let [u, v] = object.drawing.projection.project(d);
                assert!(u.abs() < 1e-7 && v.abs() < 1e-7 && d.norm() > 1e-6, "{id} {point}");
            }
        }
        if id == "T8" {
            assert_eq!(text(&estimate.depths[0].points), "5");
        }
        if id == "T9" && !aligned {
            assert_eq!(text(&estimate.depths[0].points), "17 18 19 20 21 22 23 24");
        }
    }
}

#[test]
fn a_wobbly_sketch_is_still_estimated_well() {
    // The lock wall as drawn by hand, 400 pixels wide: within a few per cent once scaled.
    let case = case_named("T9");
    let planes = Planes::of(&case.object.drawing);
    let estimate = Estimate::of(&case.object.drawing, &planes, PointId(1)).unwrap();
    assert_eq!(estimate.depths.len(), 0);
    assert!(estimate.extent() > 200.0 && estimate.extent() < 500.0);
    for line in case.object.drawing.lines.values() {
        let (a, b) = (estimate.point(&planes, line.p), estimate.point(&planes, line.q));
        let drawn = case.object.drawing.stroke(line);
        let [u, v] = case.object.drawing.projection.project(b - a);
        assert!(Real::abs(u - drawn[0]) < 5.0 && Real::abs(v - drawn[1]) < 5.0);
    }
}

#[test]
fn axes_from_an_untyped_picture() {
    let drawing = case_named("T9").object.drawing;
    let found = drawing.axes_of_lines().unwrap();
    // As it was drawn, by hand.
    for (angle, expected) in found.angle_deg.iter().zip([345.0, 40.0, 90.0]) {
        assert!((angle - expected).abs() < 0.5, "{angle} for {expected}");
    }
}

#[test]
fn a_cross_section_types_itself() {
    let rough = [
        (2.0, 0.0),
        (330.0, 2.0),
        (328.0, 61.0),
        (259.0, 58.0),
        (259.0, 118.0),
        (150.0, 121.0),
        (149.0, 231.0),
        (97.0, 328.0),
        (97.0, 379.0),
        (-2.0, 379.0),
    ];
    let mut object = drawn([0.0, 45.0, 90.0], &rough);
    object.draw().section = Some(CoordinateAxis::Y);
    add_lines(&mut object, "?", "1-2 2-3 3-4 4-5 5-6 6-7 7-8 8-9 9-10 10-1");
    object.draw().type_all();
    let drawing = &object.drawing;
    let letters: String = (drawing.lines.values())
        .map(|l| drawing.letters.letter(l.free.unwrap(), drawing.section))
        .collect();
    assert_eq!(letters, "XZXZXZFZXZ");
    // By its slope alone: 1 less the part of 5 % that it leans.
    let lean = 1.0 - drawing.slope_type(&drawing.lines[&LineId(3)]).unwrap().1;
    assert!((lean * NAMING_TOLERANCE - 0.0435).abs() < 5e-5);
    assert_eq!(Planes::of(drawing).counts(), [5, 1, 6]);
    for d in [
        "X 1 8 12", "X 8 6 8", "X 6 4 10", "X 4 2 10", "Z 1 3 5", "Z 3 5 10", "Z 5 7 15",
        "Z 7 8 15", "Z 8 9 5",
    ] {
        add_dimension(&mut object, d);
    }
    let (planes, layout) = layout(&object);
    assert_eq!(layout.counts.map(|c| c.required), [4, 0, 5]);
    let expected = [
        (0.0, 0.0),
        (40.0, 0.0),
        (40.0, 5.0),
        (30.0, 5.0),
        (30.0, 15.0),
        (20.0, 15.0),
        (20.0, 30.0),
        (12.0, 45.0),
        (12.0, 50.0),
        (0.0, 50.0),
    ];
    let expected: Vec<Vec3> = expected.iter().map(|&(x, z)| Vec3::new(x, 0.0, z)).collect();
    assert_eq!(layout.positions(&planes).unwrap(), expected);
}

fn set(object: &mut SketchObject, name: &str, value: &str) {
    object.dimensions.get_mut(name).unwrap().value = Some(DimensionExpr::parse(value).unwrap());
}

#[test]
fn redimensioning_moves_the_far_side_and_never_flips() {
    let planes_of = |object: &SketchObject, axis: CoordinateAxis| {
        let (_, layout) = layout(object);
        let mut at: Vec<f64> =
            layout.coordinates[axis.index()].iter().map(|c| c.unwrap()).collect();
        at.sort_by(f64::total_cmp);
        at
    };
    let mut object = case_named("T1 ").object;
    set(&mut object, "d1", "2");
    assert_eq!(planes_of(&object, CoordinateAxis::X), [0.0, 2.0, 7.0]);
    set(&mut object, "d1", "8");
    assert_eq!(planes_of(&object, CoordinateAxis::X), [0.0, 8.0, 13.0]);
    let mut dam = case_named("T3").object;
    set(&mut dam, "d1", "20");
    assert_eq!(planes_of(&dam, CoordinateAxis::X), [0.0, 20.0, 74.0]);
}

#[test]
fn redundant_contradictory_and_missing_are_told_apart() {
    let mut object = case_named("T1 ").object;
    let planes = Planes::of(&object.drawing);
    let (points, names) =
        chain(&object, &planes, CoordinateAxis::X, PointId(1), PointId(2)).unwrap();
    assert_eq!((chain_text(&points).as_str(), names), ("1>4>2", vec!["D1".into(), "D2".into()]));
    add_dimension(&mut object, "X 1 2 6");
    let faults = layout(&object).1.faults;
    let path = vec!["D1".to_owned(), "D2".to_owned()];
    assert_eq!(faults, [DimensionFault::Redundant { name: "D6".into(), path: path.clone() }]);
    set(&mut object, "d6", "7");
    let faults = layout(&object).1.faults;
    let wrong =
        DimensionFault::Contradictory { name: "D6".into(), asked: 7.0, measured: 6.0, path };
    assert_eq!(faults, [wrong]);
    object.dimensions.shift_remove("d6");
    object.dimensions.shift_remove("d2");
    let (_, layout) = layout(&object);
    assert_eq!(layout.counts[0], Count { required: 2, given: 1, missing: 1 });
    assert_eq!(layout.loose.len(), 1);
    assert_eq!(
        (layout.loose[0].axis, text(&layout.loose[0].points)),
        (CoordinateAxis::X, "2 3 8 9".into())
    );
    assert!(chain(&object, &planes, CoordinateAxis::X, PointId(1), PointId(2)).is_none());
}

#[test]
fn types_that_contradict_name_their_path() {
    let mut object = drawn([0.0, 45.0, 90.0], &[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]);
    add_lines(&mut object, "X", "1-2");
    add_lines(&mut object, "Z", "2-3 3-4 4-1");
    let planes = Planes::of(&object.drawing);
    assert_eq!(planes.counts(), [1, 1, 3]);
    let faults = planes.faults(&object.drawing);
    let TypeFault::Contradiction { line, axis, path } = &faults[0] else { panic!("{faults:?}") };
    assert_eq!((*line, *axis), (LineId(1), CoordinateAxis::X));
    let path: Vec<String> = path.iter().map(|r| r.text(&object.drawing)).collect();
    assert_eq!(path, ["4-1 (Z)", "3-4 (Z)", "2-3 (Z)"]);
    object.draw().points.insert(PointId(9), DrawnPoint { u: 0.0, v: 0.0 });
    let faults = Planes::of(&object.drawing).faults(&object.drawing);
    assert!(faults.contains(&TypeFault::Loose { point: PointId(9) }));
}

#[test]
fn expressions_follow_each_other_and_cycles_are_named() {
    let mut object = case_named("T1 ").object;
    let variable = |value: &str| Variable {
        name: "t".into(),
        value: DimensionExpr::parse(value).unwrap(),
        range: None,
    };
    object.variables.insert("t".into(), variable("D2/5"));
    set(&mut object, "d1", "T + 1");
    set(&mut object, "d4", "2*D1");
    let (planes, layout_) = layout(&object);
    assert_eq!(layout_.values["d4"], 4.0);
    assert_eq!(layout_.coordinate(&planes, CoordinateAxis::Z, PointId(5)), Some(7.0));
    object.variables.insert("t".into(), variable("D4"));
    let faults = layout(&object).1.faults;
    let names = vec!["d1".to_owned(), "d4".to_owned(), "t".to_owned()];
    assert!(faults.contains(&DimensionFault::Cycle { names }), "{faults:?}");
    object.variables.insert("t".into(), variable("nothing"));
    let faults = layout(&object).1.faults;
    let none = DimensionFault::NoValue { name: "t".into(), reads: "nothing".into() };
    assert!(faults.contains(&none), "{faults:?}");
    object.variables.insert("t".into(), variable("1/0"));
    let faults = layout(&object).1.faults;
    assert!(faults.iter().any(|f| matches!(f, DimensionFault::NotFinite { .. })));
}

#[test]
fn derivatives_by_dimensions_are_exact() {
    let mut object = case_named("T9").object;
    set(&mut object, "d2", "2*D1 - 4");
    let planes = Planes::of(&object.drawing);
    let seed = Dual::<1>::seeded(6.0, 0);
    let overrides = [("d1".to_owned(), seed)].into_iter().collect();
    let layout = solve(&object, &planes, &overrides, &|| None);
    let x = |p| layout.coordinate(&planes, CoordinateAxis::X, PointId(p)).unwrap();
    assert_eq!((x(17).re, x(17).eps, x(6).re, x(6).eps), (6.0, [1.0], 14.0, [3.0]));
    assert_eq!(layout.coordinate(&planes, CoordinateAxis::Z, PointId(8)).unwrap().eps, [0.0]);
}

#[test]
fn length_slope_angle_and_equal_take_the_place_of_axis_dimensions() {
    let line = |o: &SketchObject, p, q| o.drawing.line_between(PointId(p), PointId(q)).unwrap();
    let with = |object: &mut SketchObject, name: &str, measure: MeasuredQuantity, value: &str| {
        object.dimensions.insert(
            name.into(),
            Dimension {
                name: name.into(),
                measure,
                value: Some(DimensionExpr::parse(value).unwrap()),
                role: DimensionRole::Driving,
                range: None,
            },
        );
    };
    let dam = case_named("T3").object;
    let face = line(&dam, 2, 3);
    let (_, truth) = layout(&dam);
    for (name, measure, value) in [
        ("length", MeasuredQuantity::Length(face), "90"),
        ("slope", MeasuredQuantity::Slope(face), "0.75"),
        ("angle", MeasuredQuantity::Angle(line(&dam, 1, 2), face), "atan(72/54)"),
        ("equal", MeasuredQuantity::Equal(line(&dam, 4, 5), face), "90/16"),
    ] {
        let mut object = dam.clone();
        object.dimensions.shift_remove("d2");
        with(&mut object, name, measure, value);
        let (planes, layout) = layout(&object);
        assert!(layout.faults.is_empty() && layout.complete(), "{name} {:?}", layout.faults);
        assert_eq!(layout.counts[0].given, 2);
        let x = layout.coordinate(&planes, CoordinateAxis::X, PointId(2)).unwrap();
        assert!((x - 70.0).abs() < 1e-9, "{name} {x}");
        assert_eq!(truth.coordinates[0].len(), layout.coordinates[0].len());
    }
    // Derivative of the toe by the length of the face: L / run.
    let mut object = dam.clone();
    object.dimensions.shift_remove("d2");
    with(&mut object, "length", MeasuredQuantity::Length(face), "90");
    let planes = Planes::of(&object.drawing);
    let guess = || Estimate::of(&object.drawing, &planes, PointId(1));
    let overrides = [("length".to_owned(), Dual::<1>::seeded(90.0, 0))].into_iter().collect();
    let dual = solve(&object, &planes, &overrides, &guess);
    let toe = dual.coordinate(&planes, CoordinateAxis::X, PointId(2)).unwrap();
    assert!((toe.eps[0] - 90.0 / 54.0).abs() < 1e-9);
    // Two at once: the run and the rise from length and slope.
    let mut object = dam.clone();
    object.dimensions.shift_remove("d2");
    object.dimensions.shift_remove("d4");
    with(&mut object, "length", MeasuredQuantity::Length(face), "90");
    with(&mut object, "slope", MeasuredQuantity::Slope(face), "0.75");
    let (planes, both) = layout(&object);
    let p = both.point(&planes, PointId(2)).unwrap() - both.point(&planes, PointId(3)).unwrap();
    assert!(both.complete() && (p.x - 54.0).abs() < 1e-8 && (p.z + 72.0).abs() < 1e-8);
    // One too many only has to agree.
    let mut object = dam.clone();
    with(&mut object, "slope", MeasuredQuantity::Slope(face), "0.75");
    assert!(matches!(layout(&object).1.faults[..], [DimensionFault::Redundant { .. }]));
    with(&mut object, "slope", MeasuredQuantity::Slope(face), "0.8");
    assert!(matches!(layout(&object).1.faults[..], [DimensionFault::Contradictory { .. }]));
    // Impossible: shorter than its rise.
    let mut object = dam;
    object.dimensions.shift_remove("d2");
    with(&mut object, "length", MeasuredQuantity::Length(face), "60");
    let (_, bad) = layout(&object);
    assert!(matches!(bad.faults[..], [DimensionFault::Unsolved { .. }]) && !bad.complete());
}

/// The lock wall without alignments and the pyramid, from pictures with noise, in parts of 400: the
/// hole is flush with the ends of the wall, the apex is over the middle of its base.
#[test]
fn open_depths_have_their_likeliest_values() {
    let mut random = Random::new(7);
    for (id, noise) in [("T9 ", 0.0), ("T9 ", 1.0), ("T9 ", 2.5), ("T8 ", 0.0), ("T8 ", 2.5)] {
        let case = case_named(id);
        let mut object = case.object;
        let drawing = object.draw();
        drawing.aligns.clear();
        let drawn: Vec<[f64; 2]> =
            case.xyz.iter().map(|p| drawing.projection.project(*p)).collect();
        let width = drawn.iter().map(|p| p[0].abs()).fold(0.0, f64::max);
        for (k, [u, v]) in drawn.into_iter().enumerate() {
            let mut off = || noise / 400.0 * width * random.between(-1.0, 1.0);
            drawing.points.insert(PointId(k as u32 + 1), DrawnPoint { u: u + off(), v: v + off() });
        }
        let planes = Planes::of(&object.drawing);
        let estimate = Estimate::of(&object.drawing, &planes, PointId(1)).unwrap();
        let [depth] = &estimate.depths[..] else { panic!("{id} {noise}") };
        assert_eq!(depth.aligns.len(), if id == "T9 " { 2 } else { 0 }, "{noise} {depth:?}");
        for align in &depth.aligns {
            let gap = case.xyz[align.p.0 as usize - 1] - case.xyz[align.q.0 as usize - 1];
            assert_eq!(gap.to_array()[align.axis.index()], 0.0, "{noise} {align:?}");
        }
        for (k, xyz) in case.xyz.iter().enumerate() {
            let p = estimate.point(&planes, PointId(k as u32 + 1));
            assert!(
                p.distance(*xyz) < 1e-8 + 0.03 * noise * width / 10.0,
                "{id} {noise} {p:?} {xyz:?}"
            );
        }
    }
}

/// ACCEPT ALL takes what the picture suggests as if each dimension were accepted before the next.
#[test]
fn all_at_once_is_one_after_the_other() {
    let mut random = Random::new(7);
    let (mut compared, mut most) = (0, 0);
    for case in cases() {
        for _ in 0..12 {
            let mut object = case.object.clone();
            let share = random.between(0.0, 0.6);
            object.dimensions.retain(|_, d| d.name == "E1" || random.between(0.0, 1.0) < share);
            for p in object.draw().points.values_mut() {
                (p.u, p.v) = (p.u + random.signed(), p.v + random.signed());
            }
            let mut all = SketchSession::new();
            all.insert(object.clone());
            all.run_line("ACCEPT ALL");
            let at_once = all.active_object().unwrap();
            if at_once.drawing.aligns != object.drawing.aligns {
                continue;
            }
            let mut one = SketchSession::new();
            one.insert(object);
            let mut taken = 0;
            while let Some(s) = one.suggestions(&case.object.name).unwrap().iter().flatten().next()
            {
                let mut names = (1..).map(|k| format!("E{k}"));
                let name = names.find(|n| !one.active_object().unwrap().has_name(n));
                let Suggestion { axis, p, q, value, .. } = s;
                one.run_line(&format!("DIMENSION {} {axis} {p} TO {q} = {value}", name.unwrap()));
                taken += 1;
                assert!(taken < 200, "{}", case.id);
            }
            assert_eq!(at_once.dimensions, one.active_object().unwrap().dimensions, "{}", case.id);
            compared += 1;
            most = most.max(taken);
        }
    }
    assert!(compared > 40 && most > 8, "{compared} of at most {most}");
}
