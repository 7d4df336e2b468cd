//! Drawings of other programs as sections: coordinates to rounding, lines that cross, blocks, units.

use moldloft_sketch::page_spline::spline_curves;
use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;
use std::fmt::Write as _;

struct OneFile(&'static str, String);

impl Files for OneFile {
    fn read(&self, name: &str) -> Result<String, String> {
        if name == self.0 { Ok(self.1.clone()) } else { Err("there is no such file".to_owned()) }
    }
}

fn groups(text: &str) -> String {
    text.split_whitespace().fold(String::new(), |out, word| out + word + "\n")
}

fn line([x, y]: [f64; 2], [u, v]: [f64; 2]) -> String {
    groups(&format!("0 LINE 10 {x:?} 20 {y:?} 11 {u:?} 21 {v:?}"))
}

fn circle([x, y]: [f64; 2], r: f64) -> String {
    groups(&format!("0 CIRCLE 10 {x:?} 20 {y:?} 40 {r:?}"))
}

fn polygon(corners: &[[f64; 2]]) -> String {
    (0..corners.len()).map(|k| line(corners[k], corners[(k + 1) % corners.len()])).collect()
}

fn file(before: &str, entities: &str) -> String {
    groups(before) + &groups("0 SECTION 2 ENTITIES") + entities + &groups("0 ENDSEC 0 EOF")
}

fn imported(text: String) -> SketchSession {
    let mut s = SketchSession::with_files(Box::new(OneFile("plate.dxf", text)));
    for command in ["IMPORT \"plate.dxf\"", "ACCEPT ALL", "GENERATE FACES"] {
        let replies = s.run_line(command);
        assert!(replies.iter().all(|r| !r.is_error()), "{command}: {replies:?}");
    }
    s
}

fn area(s: &mut SketchSession) -> f64 {
    s.objects()[0].area.unwrap()
}

#[test]
fn a_plate_with_a_hole_keeps_its_coordinates() {
    let corners = [[1.25, -3.0], [124.706, -3.0], [124.706, 75.9], [1.25, 75.9]];
    let units = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC";
    let mut s = imported(file(units, &(polygon(&corners) + &circle([20.25, 20.125], 3.3))));
    let want = 123.456 * 78.9 - PI * 3.3 * 3.3;
    assert!((area(&mut s) - want).abs() < 1e-12 * want, "{}", area(&mut s));
    let object = s.active_object().unwrap().clone();
    assert_eq!(object.units.as_deref(), Some("MM"));
    assert_eq!(object.drawing.section, Some(CoordinateAxis::Z));
    let data = s.objects().remove(0);
    for (id, [x, y, _]) in &data.points {
        let Some(page) = data.page.iter().find(|p| p.0 == *id) else { continue };
        assert!((x.unwrap() - page.1[0]).abs() < 1e-12 * 124.0);
        assert!((y.unwrap() - page.1[1]).abs() < 1e-12 * 124.0);
    }
    // The commands make the same object, and the journal does without the file.
    let mut again = SketchSession::new();
    assert!(again.run_text(&script(&object)).iter().all(|r| !r.is_error()));
    assert_eq!(again.active_object(), Some(&object));
    let mut replayed = SketchSession::new();
    assert!(replayed.run_text(&s.journal().join("\n")).iter().all(|r| !r.is_error()));
    assert_eq!(replayed.active_object(), Some(&object));
}

/// Leaning lines stay as they lean, whatever their slope.
#[test]
fn polygons_of_any_slopes() {
    let mut random = Random::new(21);
    for _ in 0..rounds(5, 400) {
        // A star about the origin is simple.
        let n = 3 + random.below(9);
        let corners: Vec<[f64; 2]> = (0..n)
            .map(|k| {
                let angle = (k as f64 + 0.2 * random.unit()) * 2.0 * PI / n as f64;
                let r = random.decimal(10.0, 90.0);
                [r * libm::cos(angle), r * libm::sin(angle)].map(|x| (x * 1e4).round() / 1e4)
            })
            .collect();
        let twice: f64 = (0..n)
            .map(|k| {
                let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % n]);
                a * d - b * c
            })
            .sum();
        let mut s = imported(file("", &polygon(&corners)));
        let got = area(&mut s);
        assert!((got - 0.5 * twice).abs() < 1e-11 * twice, "{got} {corners:?}");
    }
}

#[test]
fn lines_that_cross_and_blocks() {
    // A square with both middle lines drawn through: four faces.
    let mut lines = polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
    lines += &line([5.0, 0.0], [5.0, 10.0]);
    lines += &line([0.0, 4.0], [10.0, 4.0]);
    let mut s = imported(file("", &lines));
    assert_eq!(s.active_object().unwrap().faces.len(), 4);
    assert!((area(&mut s) - 100.0).abs() < 1e-12);
    // A block with a base point, inserted twice: as it is, and turned, stretched and moved.
    let mut blocks = groups("0 SECTION 2 BLOCKS 0 BLOCK 2 TRIANGLE 10 1 20 1");
    blocks += &polygon(&[[1.0, 1.0], [4.0, 1.0], [1.0, 3.0]]);
    blocks += &groups("0 ENDBLK 0 ENDSEC");
    let inserts =
        groups("0 INSERT 2 TRIANGLE 10 0 20 0 0 INSERT 2 TRIANGLE 10 20 20 5 41 2 42 3 50 90");
    let mut text = blocks;
    write!(text, "{}", file("", &inserts)).unwrap();
    let mut s = imported(text);
    assert!((area(&mut s) - (3.0 + 18.0)).abs() < 1e-12, "{}", area(&mut s));
    let places: Vec<[f64; 2]> = s.objects()[0].page.iter().map(|p| p.1).collect();
    for corner in [[20.0, 5.0], [20.0, 11.0], [14.0, 5.0]] {
        assert!(places.contains(&corner), "{places:?}");
    }
}

/// A picture of a solid needs an object of its own.
#[test]
fn pictorials_stay_pictorials() {
    let text = file("", &polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 7.0], [0.0, 7.0]]));
    let mut s = SketchSession::with_files(Box::new(OneFile("plate.dxf", text)));
    s.run_line("SKETCH A 3D");
    assert!(s.run_line("IMPORT \"plate.dxf\"").iter().all(|r| !r.is_error()));
    let drawing = &s.active_object().unwrap().drawing;
    assert_eq!((drawing.section, drawing.exact), (None, false));
}

/// Text of an entity by group codes and numbers.
fn entity(kind: &str, groups_: &[(i32, f64)]) -> String {
    let mut text = format!("0\n{kind}\n");
    for (code, x) in groups_ {
        let whole = (70..80).contains(code);
        let number = if whole { format!("{}", *x as i64) } else { format!("{x:?}") };
        writeln!(text, "{code}\n{number}").unwrap();
    }
    text
}

fn sector(r: f64, half: f64) -> f64 {
    r * r * (half - libm::sin(half) * libm::cos(half))
}

#[test]
fn parts_of_ellipses() {
    // The parameter from 30 to 250 degrees, and the chord: an affine image of a segment of a circle.
    let (from, to) = (30.0_f64.to_radians(), 250.0_f64.to_radians());
    for (turn, ratio, behind) in [(0.0, 0.4, false), (0.7, 0.9, false), (2.0, 0.25, true)] {
        let a = [9.0 * libm::cos(turn), 9.0 * libm::sin(turn)];
        let side = if behind { -ratio } else { ratio };
        let at = |t: f64| {
            let (c, s) = (libm::cos(t), side * libm::sin(t));
            [4.0 + c * a[0] - s * a[1], 2.0 + c * a[1] + s * a[0]]
        };
        let normal = if behind { -1.0 } else { 1.0 };
        let arc = [
            (10, 4.0),
            (20, 2.0),
            (11, a[0]),
            (21, a[1]),
            (40, ratio),
            (41, from),
            (42, to),
            (230, normal),
        ];
        let mut s = imported(file("", &(entity("ELLIPSE", &arc) + &line(at(from), at(to)))));
        let want = 81.0 * ratio * sector(1.0, 0.5 * (to - from));
        assert!((area(&mut s) - want).abs() < 1e-11 * want, "{} {want}", area(&mut s));
    }
}

/// De Boor's values of a spline, integrated by Gauss's rule in each span: twice the area between it and the origin.
fn twice_area(degree: usize, knots: &[f64], points: &[[f64; 2]], weights: &[f64]) -> f64 {
    let basis = |x: f64| {
        let mut n: Vec<f64> = (0..knots.len() - 1)
            .map(|k| f64::from(u8::from(knots[k] <= x && x < knots[k + 1])))
            .collect();
        for p in 1..=degree {
            for k in 0..knots.len() - 1 - p {
                let part = |a: f64, b: f64, c: f64| if b > a { c / (b - a) } else { 0.0 };
                n[k] = part(knots[k], knots[k + p], x - knots[k]) * n[k]
                    + part(knots[k + 1], knots[k + p + 1], knots[k + p + 1] - x) * n[k + 1];
            }
        }
        let w: Vec<f64> = (0..points.len()).map(|k| n[k] * weights[k]).collect();
        let sum: f64 = w.iter().sum();
        [0, 1].map(|c| (0..points.len()).map(|k| w[k] * points[k][c]).sum::<f64>() / sum)
    };
    // Romberg's rule of the trapezium sums of cross products of chords.
    let last = knots.len() - 1 - degree;
    let mut total = 0.0;
    for k in degree..last {
        let (from, to) = (knots[k], knots[k + 1]);
        if to <= from {
            continue;
        }
        let sum = |n: usize| -> f64 {
            let at = |j: usize| {
                basis((from + (to - from) * j as f64 / n as f64).min(to - 1e-14 * (to - from)))
            };
            (0..n).map(|j| at(j)[0] * at(j + 1)[1] - at(j)[1] * at(j + 1)[0]).sum()
        };
        let mut rows: Vec<f64> = (3..9).map(|e| sum(1 << e)).collect();
        for m in 1..6 {
            let power = f64::from(1 << (2 * m));
            for j in 0..6 - m {
                rows[j] = (power * rows[j + 1] - rows[j]) / (power - 1.0);
            }
        }
        total += rows[0];
    }
    total
}

#[test]
fn splines_are_exact() {
    let mut random = Random::new(5);
    for k in 0..rounds(6, 200) {
        // A closed outline about the origin: clamped at its start, or periodic.
        let degree = [3, 3, 2, 1, 2][k % 5];
        let n = 6 + random.below(8);
        let spread = if k % 2 == 0 { 0.15 } else { 0.5 };
        let mut points: Vec<[f64; 2]> = (0..n)
            .map(|j| {
                let angle = (j as f64 + 0.3 * random.unit()) * 2.0 * PI / n as f64;
                let r = 50.0 * (1.0 + spread * (random.unit() - 0.5));
                [r * libm::cos(angle), r * libm::sin(angle)]
            })
            .collect();
        let knots: Vec<f64> = if random.chance(50) {
            points.push(points[0]);
            let inner = points.len() - degree;
            let mut x = 0.0;
            let mut all = vec![0.0; degree + 1];
            for _ in 1..inner {
                x += random.between(0.3, 2.0);
                all.push(x);
            }
            all.extend(vec![x + 1.0; degree + 1]);
            all
        } else {
            points.extend_from_within(..degree);
            (0..points.len() + degree + 1).map(|j| j as f64).collect()
        };
        let rational = degree == 2 && k % 5 == 4;
        let weights: Vec<f64> =
            points.iter().map(|_| if rational { random.between(0.4, 0.9) } else { 1.0 }).collect();
        // The weights of a periodic spline repeat as its points do.
        let weights: Vec<f64> = (0..points.len())
            .map(|j| points.iter().position(|p| *p == points[j]).map_or(1.0, |i| weights[i]))
            .collect();
        let mut data = vec![(70, 0.0), (71, degree as f64), (72, knots.len() as f64)];
        data.push((73, points.len() as f64));
        data.extend(knots.iter().map(|x| (40, *x)));
        if rational {
            data.extend(weights.iter().map(|w| (41, *w)));
        }
        data.extend(points.iter().flat_map(|p| [(10, p[0]), (20, p[1]), (30, 0.0)]));
        let text = file("", &entity("SPLINE", &data));
        let spans = spline_curves(degree, &knots, &points, if rational { &weights } else { &[] });
        if spans.is_err() {
            // A part of a hyperbola, named.
            assert!(rational, "{spans:?}");
            continue;
        }
        let mut s = imported(text);
        let want = 0.5 * twice_area(degree, &knots, &points, &weights);
        assert!((area(&mut s) - want).abs() < 1e-9 * want, "{k}: {} {want}", area(&mut s));
    }
}

/// Holes beside walls and beside each other, closer than the corners that they are drawn in.
#[test]
fn holes_close_to_others() {
    let mut random = Random::new(8);
    for k in 0..rounds(6, 300) {
        let gap = *random.pick(&[2.0, 0.3, 0.05]);
        let r = random.decimal(2.0, 9.0);
        let q = random.decimal(2.0, 9.0);
        let mut shapes = polygon(&[[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]]);
        let first = [r + gap, r + gap];
        let angle = random.between(0.2, 1.2);
        let far = r + q + gap;
        let second = [first[0] + far * libm::cos(angle), first[1] + far * libm::sin(angle)];
        shapes += &circle(first, r);
        shapes += &circle(second, q);
        if second[1] + q > 39.9 || second[1] - q < 0.1 || second[0] - q < 0.1 {
            continue;
        }
        let mut s = imported(file("", &shapes));
        let want = 2400.0 - PI * (r * r + q * q);
        assert!((area(&mut s) - want).abs() < 1e-10 * want, "{k}: {} {want}", area(&mut s));
    }
}

/// A disc over the side of a rectangle, and discs over each other: all that they cover.
#[test]
fn curves_that_cross() {
    let mut random = Random::new(9);
    for k in 0..rounds(6, 300) {
        let r = random.decimal(3.0, 12.0);
        let off = random.between(-0.8, 0.8) * r;
        let mut shapes = polygon(&[[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]]);
        shapes += &circle([60.0 + off, 20.0], r);
        let outside = PI * r * r - sector(r, libm::acos(off / r));
        let mut s = imported(file("", &shapes));
        let want = 2400.0 + outside;
        assert!((area(&mut s) - want).abs() < 1e-10 * want, "{k}: {} {want}", area(&mut s));
        let q = random.decimal(3.0, 12.0);
        let d = random.between((r - q).abs() + 0.4, r + q - 0.4);
        let lens = sector(r, libm::acos((d * d + r * r - q * q) / (2.0 * d * r)))
            + sector(q, libm::acos((d * d + q * q - r * r) / (2.0 * d * q)));
        let t = random.between(0.0, 6.0);
        let shapes =
            circle([1.0, 2.0], r) + &circle([1.0 + d * libm::cos(t), 2.0 + d * libm::sin(t)], q);
        let mut s = imported(file("", &shapes));
        let want = PI * (r * r + q * q) - lens;
        assert!((area(&mut s) - want).abs() < 1e-10 * want, "{k}: {} {want}", area(&mut s));
    }
}

#[test]
fn rows_of_blocks_and_planes_from_behind() {
    let mut blocks = groups("0 SECTION 2 BLOCKS 0 BLOCK 2 DISC 10 0 20 0");
    blocks += &circle([1.0, 0.0], 2.0);
    blocks += &groups("0 ENDBLK 0 ENDSEC");
    let row = groups("0 INSERT 2 DISC 10 5 20 5 70 3 71 2 44 7 45 6 50 90");
    let mut s = imported(blocks.clone() + &file("", &row));
    assert!((area(&mut s) - 6.0 * 4.0 * PI).abs() < 1e-11, "{}", area(&mut s));
    let behind = groups("0 INSERT 2 DISC 10 5 20 5 41 3 230 -1");
    let mut s = imported(blocks + &file("", &behind));
    assert!((area(&mut s) - 12.0 * PI).abs() < 1e-11);
    let centre = s.objects()[0].centroid.unwrap();
    assert!((centre[0] + 8.0).abs() < 1e-12 && (centre[1] - 5.0).abs() < 1e-12, "{centre:?}");
}

#[test]
fn paths_of_a_picture() {
    let curves = [
        // A quarter of an ellipse, a cubic back, and a smooth one after it.
        ("M 0 0 C 10 -10 30 -10 40 0 S 60 20 80 0 L 80 -40 L 0 -40 Z", None),
        ("M 10 0 A 10 4 0 0 1 -10 0 A 10 4 0 0 1 10 0 Z", Some(40.0 * PI)),
        ("M 0 0 Q 10 -20 20 0 T 40 0 L 40 30 L 0 30 Z", Some(1200.0)),
        ("M 5 5 h 20 a 6 3 30 1 1 0 1 v 20 h -20 Z", None),
    ];
    for (path, want) in curves {
        let text = format!("<svg><path transform=\"scale(2 3)\" d=\"{path}\"/></svg>");
        let mut s = SketchSession::with_files(Box::new(OneFile("plate.svg", text)));
        for command in ["IMPORT \"plate.svg\"", "ACCEPT ALL", "GENERATE FACES"] {
            let replies = s.run_line(command);
            assert!(replies.iter().all(|r| !r.is_error()), "{path} {command}: {replies:?}");
            assert!(replies.iter().all(|r| !r.text.contains("not drawn")), "{replies:?}");
        }
        let got = area(&mut s);
        let want = want.map_or(6.0 * outline_area(path), |w| 6.0 * w);
        assert!((got - want).abs() < 1e-9 * want, "{path}: {got} {want}");
        let object = s.active_object().unwrap().clone();
        let mut again = SketchSession::new();
        assert!(again.run_text(&script(&object)).iter().all(|r| !r.is_error()));
        assert_eq!(again.active_object(), Some(&object));
    }
}

/// The areas of two of the paths above, by the integrals of their pieces.
fn outline_area(path: &str) -> f64 {
    if path.starts_with("M 0 0 C") {
        // Of a cubic over its chord along u: the mean of the heights of its control points, weighed by their steps.
        let cubic = |p: [[f64; 2]; 4]| -> f64 {
            let n = 4000;
            let at = |k: i32| {
                let s = f64::from(k) / f64::from(n);
                let w = 1.0 - s;
                let b = [w * w * w, 3.0 * w * w * s, 3.0 * w * s * s, s * s * s];
                [0, 1].map(|c| (0..4).map(|i| b[i] * p[i][c]).sum::<f64>())
            };
            let trapezium = |step: i32| -> f64 {
                (0..n / step)
                    .map(|k| {
                        let (a, b) = (at(k * step), at((k + 1) * step));
                        0.5 * (a[1] + b[1]) * (b[0] - a[0])
                    })
                    .sum()
            };
            (4.0 * trapezium(1) - trapezium(2)) / 3.0
        };
        let first = cubic([[0.0, 0.0], [10.0, -10.0], [30.0, -10.0], [40.0, 0.0]]);
        let second = cubic([[40.0, 0.0], [50.0, 10.0], [60.0, 20.0], [80.0, 0.0]]);
        // v runs down: the curve is the lower border.
        return 3200.0 + first + second;
    }
    // An arc of an ellipse of half-axes 6 and 3, turned by 30 degrees, scaled up until it reaches.
    let (c, s) = (libm::cos(PI / 6.0), libm::sin(PI / 6.0));
    // The chord (0, 1) in the coordinates of the ellipse.
    let half = 0.5 * libm::hypot(s / 6.0, c / 3.0);
    let angle = libm::asin(half);
    let large = PI - angle;
    400.0 + 20.0 + 18.0 * (large + libm::sin(angle) * libm::cos(angle))
}
