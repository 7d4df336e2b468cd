//! RECTANGLE, SLOT, POLYGON and CIRCLE DIAMETER against closed forms.

use crate::treatments::{near, refused, run, volume};
use moldloft_sketch::{CoordinateAxis, SketchSession, script};
use moldloft_testing::{Random, rounds};
use std::f64::consts::{PI, TAU};

fn area(s: &mut SketchSession) -> f64 {
    let object = s.objects().into_iter().next().unwrap();
    object.area.unwrap()
}

fn disc(diameter: f64) -> f64 {
    PI * diameter * diameter / 4.0
}

fn slot(length: f64, width: f64) -> f64 {
    (length - width) * width + disc(width)
}

fn polygon(n: f64, diameter: f64) -> f64 {
    n / 8.0 * diameter * diameter * (TAU / n).sin()
}

#[test]
fn outlines_and_what_they_leave_out() {
    for (plane, commands, expected) in [
        ("XY", "RECTANGLE 80 50", 4000.0),
        ("XZ", "RECTANGLE 80 50 AT -5 7", 4000.0),
        ("YZ", "CIRCLE DIAMETER 30 AT 0 0", disc(30.0)),
        ("XY", "SLOT 40 10", slot(40.0, 10.0)),
        ("XY", "POLYGON 6 30", polygon(6.0, 30.0)),
        ("XZ", "POLYGON 5 30 AT 20 20", polygon(5.0, 30.0)),
        ("XY", "RECTANGLE 80 50; CIRCLE DIAMETER 9 AT 10 12", 4000.0 - disc(9.0)),
        ("XY", "RECTANGLE 80 50; SLOT 20 6 AT 10 12", 4000.0 - slot(20.0, 6.0)),
        ("XZ", "RECTANGLE 80 50 AT -40 -25; POLYGON 7 20 AT 0 0", 4000.0 - polygon(7.0, 20.0)),
        (
            "YZ",
            "CIRCLE DIAMETER 60 AT 0 0; CIRCLE DIAMETER 20 AT 0 0; SLOT 10 4 AT 14 -2",
            disc(60.0) - disc(20.0) - slot(10.0, 4.0),
        ),
    ] {
        let mut s = SketchSession::new();
        run(&mut s, &format!("SKETCH P 2D {plane}\n{commands}\nGENERATE FACES"));
        near(area(&mut s), expected);
        run(&mut s, "EXTRUDE 8");
        near(volume(&mut s, "P"), 8.0 * expected);
        let mut again = SketchSession::new();
        run(&mut again, &script(s.object("P").unwrap()));
        assert_eq!(volume(&mut again, "P").to_bits(), volume(&mut s, "P").to_bits());
    }
}

#[test]
fn their_numbers_move_them() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH P 2D XY\nRECTANGLE 80 50\nVARIABLE D 9\nCIRCLE DIAMETER D AT \"WIDTH1/2\" 25\nGENERATE FACES\nEXTRUDE 8",
    );
    near(volume(&mut s, "P"), 8.0 * (4000.0 - disc(9.0)));
    let centroid = |s: &mut SketchSession| s.objects()[0].centroid.unwrap();
    near(centroid(&mut s).x, 40.0);
    run(&mut s, "SET D 20; SET WIDTH1 100");
    near(volume(&mut s, "P"), 8.0 * (5000.0 - disc(20.0)));
    // The circle stays in the middle.
    near(centroid(&mut s).x, 50.0);
    near(centroid(&mut s).y, 25.0);
    run(&mut s, "UNDO 2");
    near(volume(&mut s, "P"), 8.0 * (4000.0 - disc(9.0)));
}

#[test]
fn a_flange_in_six_statements() {
    let mut s = SketchSession::new();
    run(
        &mut s,
        "SKETCH F 2D XY\nCIRCLE DIAMETER 120 AT 0 0\nGENERATE FACES\nEXTRUDE 12\n\
         HOLE F 40 AT 0 0 INTO G\nHOLE G 11 AT 45 0 COUNTERBORE 18 6 POLAR 8 45 INTO H",
    );
    let drilled = disc(40.0) * 12.0 + 8.0 * (disc(11.0) * 6.0 + disc(18.0) * 6.0);
    near(volume(&mut s, "H"), disc(120.0) * 12.0 - drilled);
    run(&mut s, "USING H");
    let count = s.numbers("H").unwrap().into_iter().find(|n| n.0.starts_with("COUNT")).unwrap().0;
    run(&mut s, &format!("SET {count} 4"));
    let drilled = disc(40.0) * 12.0 + 4.0 * (disc(11.0) * 6.0 + disc(18.0) * 6.0);
    near(volume(&mut s, "H"), disc(120.0) * 12.0 - drilled);
}

#[test]
fn random_plates() {
    let mut random = Random::new(21);
    for _ in 0..rounds(12, 1_000) {
        let whole = |random: &mut Random, low: usize, high: usize| {
            (low + random.below(high - low + 1)) as f64
        };
        let (w, h) = (whole(&mut random, 60, 120), whole(&mut random, 40, 80));
        let (d, n) = (whole(&mut random, 4, 16), whole(&mut random, 3, 12));
        let (l, b) = (whole(&mut random, 14, 30), whole(&mut random, 4, 12));
        let x0 = whole(&mut random, 0, 60) - 30.0;
        let mut s = SketchSession::new();
        run(
            &mut s,
            &format!(
                "SKETCH P 2D XY\nRECTANGLE {w} {h} AT {x0} 0\nCIRCLE DIAMETER {d} AT {} 10\n\
                 POLYGON {n} {d} AT {} 28\nSLOT {l} {b} AT {} 4\nGENERATE FACES\nEXTRUDE 5",
                x0 + 10.0,
                x0 + 10.0,
                x0 + 25.0,
            ),
        );
        near(volume(&mut s, "P"), 5.0 * (w * h - disc(d) - polygon(n, d) - slot(l, b)));
    }
}

/// An outline of a random part, with numbers that the object G has.
struct Shape {
    kind: &'static str,
    /// Of a polygon.
    corners: f64,
    /// Names in G.
    size: [String; 2],
    /// Its centre from (U, V) of G.
    centre: [f64; 2],
}

impl Shape {
    fn command(&self) -> String {
        let [a, b] = &self.size;
        let [x, y] = self.centre;
        let half = |n: &str| format!("G.{n}/2");
        match self.kind {
            "CIRCLE" => format!("CIRCLE DIAMETER \"G.{a}\" AT \"G.U+({x})\" \"G.V+({y})\""),
            "POLYGON" => {
                let n = self.corners;
                format!("POLYGON {n} \"G.{a}\" AT \"G.U+({x})\" \"G.V+({y})\"")
            }
            kind => format!(
                "{kind} \"G.{a}\" \"G.{b}\" AT \"G.U+({x})-{}\" \"G.V+({y})-{}\"",
                half(a),
                half(b)
            ),
        }
    }

    fn area(&self, number: &dyn Fn(&str) -> f64) -> f64 {
        let [a, b] = [0, 1].map(|k| number(&self.size[k]));
        match self.kind {
            "CIRCLE" => disc(a),
            "POLYGON" => polygon(self.corners, a),
            "SLOT" => slot(a, b),
            _ => a * b,
        }
    }
}

/// Volume and centroid of an outline with holes, extruded to a depth along `normal`.
fn figures(
    shapes: &[Shape],
    number: &dyn Fn(&str) -> f64,
    normal: CoordinateAxis,
    depth: f64,
) -> (f64, [f64; 3]) {
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for (k, shape) in shapes.iter().enumerate() {
        let own = if k == 0 { shape.area(number) } else { -shape.area(number) };
        area += own;
        for (j, n) in ["U", "V"].into_iter().enumerate() {
            moment[j] += own * (number(n) + shape.centre[j]);
        }
    }
    let mut centre = [depth / 2.0; 3];
    for (axis, m) in normal.others().into_iter().zip(moment) {
        centre[axis.index()] = m / area;
    }
    (area * depth, centre)
}

#[test]
fn centres_stay_where_they_are_put() {
    let mut random = Random::new(44);
    for case in 0..rounds(12, 500) {
        let normal = *random.pick(&CoordinateAxis::ALL);
        let plane = normal.others().map(CoordinateAxis::letter).concat();
        let kinds = ["CIRCLE", "POLYGON", "SLOT", "RECTANGLE"];
        let mut shapes: Vec<Shape> = Vec::new();
        for (k, [x, y]) in [[0.0; 2], [9.0, 8.0], [-9.0, 7.0], [-8.0, -9.0]].into_iter().enumerate()
        {
            if k > 0 && random.chance(40) {
                continue;
            }
            let kind = *random.pick(&kinds);
            shapes.push(Shape {
                kind,
                corners: (5 + random.below(8)) as f64,
                size: [format!("A{k}"), format!("B{k}")],
                centre: [x, y],
            });
        }
        // Places across the origin and at it, sizes of which the second is the smaller.
        let draw = |random: &mut Random| -> Vec<(String, f64)> {
            let place = |random: &mut Random| match random.below(4) {
                0 => 0.0,
                1 => random.signed() * 50.0,
                _ => random.below(61) as f64 - 30.0,
            };
            let mut all = vec![("U".to_owned(), place(random)), ("V".to_owned(), place(random))];
            for (k, shape) in shapes.iter().enumerate() {
                let (low, high) = if k == 0 { (70.0, 110.0) } else { (4.0, 10.0) };
                let a = random.decimal(low, high);
                all.push((shape.size[0].clone(), a));
                all.push((shape.size[1].clone(), a * random.between(0.75, 0.95)));
            }
            all
        };
        let mut numbers = draw(&mut random);
        let mut s = SketchSession::new();
        let mut text = "SKETCH G 2D XY\n".to_owned();
        for (name, x) in &numbers {
            text += &format!("VARIABLE {name} {x:?}\n");
        }
        text += &format!("SKETCH P 2D {plane}\n");
        for shape in &shapes {
            text += &(shape.command() + "\n");
        }
        run(&mut s, &(text + "GENERATE FACES\nEXTRUDE 6"));
        for _ in 0..4 {
            let number = |n: &str| numbers.iter().find(|x| x.0 == n).unwrap().1;
            let (volume, centre) = figures(&shapes, &number, normal, 6.0);
            let found = s.objects().into_iter().find(|o| o.name == "P").unwrap();
            near(found.volume.unwrap(), volume);
            for (x, want) in found.centroid.unwrap().to_array().into_iter().zip(centre) {
                assert!((x - want).abs() < 1e-9, "{case}: {x} for {want}");
            }
            let mut again = SketchSession::new();
            for name in ["G", "P"] {
                run(&mut again, &script(s.object(name).unwrap()));
            }
            let same = again.objects().into_iter().find(|o| o.name == "P").unwrap();
            assert_eq!(same.volume.unwrap().to_bits(), found.volume.unwrap().to_bits());
            numbers = draw(&mut random);
            for (name, x) in &numbers {
                run(&mut s, &format!("SET G.{name} {x:?}"));
            }
        }
    }
}

/// The centroid of the first object.
fn centred(s: &mut SketchSession, want: [f64; 3]) {
    let found = s.objects()[0].centroid.unwrap();
    assert!(found.distance(want.into()) < 1e-9, "{found:?} for {want:?}");
}

#[test]
fn a_place_by_expressions_is_moved_with_its_body() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XY\nCIRCLE DIAMETER 10 AT 3 4\nGENERATE FACES\nEXTRUDE 8");
    centred(&mut s, [3.0, 4.0, 4.0]);
    run(&mut s, "MOVE P 1 2 3; SET DIAMETER1 20");
    centred(&mut s, [4.0, 6.0, 7.0]);
    run(&mut s, "ROTATE P Z 90; SET DIAMETER1 12");
    centred(&mut s, [-6.0, 4.0, 7.0]);
    run(&mut s, "MIRROR P X; SET DIAMETER1 14");
    centred(&mut s, [6.0, 4.0, 7.0]);
    run(&mut s, "SCALE P 2; SET DIAMETER1 15");
    centred(&mut s, [12.0, 8.0, 14.0]);
}

#[test]
fn a_reference_is_an_expression() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XZ\nRECTANGLE 8 4\nGENERATE FACES\nEXTRUDE 6");
    run(&mut s, "VARIABLE D 5; REFERENCE 1 \"-WIDTH1/2\" D \"HEIGHT1\"");
    centred(&mut s, [0.0, 8.0, 6.0]);
    run(&mut s, "SET WIDTH1 20; SET D 1; SET HEIGHT1 2");
    centred(&mut s, [0.0, 4.0, 3.0]);
    let exact = s.gradient("P", &["WIDTH1".to_owned(), "HEIGHT1".to_owned()]).unwrap();
    near(exact.volume[0], 12.0);
    near(exact.volume[1], 120.0);
    for (found, want) in exact.centroid.iter().zip([0.0, 1.5]) {
        assert!(found.distance([0.0, 0.0, want].into()) < 1e-12, "{found:?}");
    }
    let text = refused(&mut s, "REFERENCE 1 NOPE 0 0");
    assert!(text.contains("REFERENCE reads nope"), "{text}");
    let text = refused(&mut s, "REFERENCE 1 \"1/0\" 0 0");
    assert!(text.contains("value of REFERENCE is not a finite number"), "{text}");
    centred(&mut s, [0.0, 4.0, 3.0]);
}

#[test]
fn what_is_no_shape_is_refused() {
    let mut s = SketchSession::new();
    run(&mut s, "SKETCH P 2D XY\nRECTANGLE 80 50\nSKETCH Q");
    for (command, why) in [
        ("RECTANGLE 80 50", "not a cross section"),
        ("USING P; RECTANGLE 0 5", "a width of 0"),
        ("USING P; SLOT 5", "expected a value"),
        ("USING P; POLYGON 2 30", "2 corners"),
        ("USING P; POLYGON 6 30 AT \"NOPE\" 0", "which has no value"),
        ("USING P; CIRCLE DIAMETER 5 AT 1", "expected a value"),
    ] {
        let text = refused(&mut s, command);
        assert!(text.contains(why), "{command}: {text}");
    }
    assert_eq!(s.object("P").unwrap().drawing.points.len(), 4);
}
