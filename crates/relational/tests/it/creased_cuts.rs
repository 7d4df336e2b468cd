//! Cuts of surfaces with creases: no fold, on both shapes, of the length of level lines on a grid.

use crate::common::{Scene, attempt, scene};
use moldloft_num::Curve as _;
use moldloft_num::{Order, Vec3};
use moldloft_registry::{CurveRef, SearchStatus};
use moldloft_testing::{Random, soak};
use std::fmt::Write;

/// A hull of hard chines, lofted over poly-lines.
const CHINES: &str = "AbsPoint S1(0, 0, 1.5); AbsPoint S2(0.4, 0, 0.6); AbsPoint S3(1, 0, -0.4);
    AbsPoint M1(5, 1.6, 1.2); AbsPoint M2(5, 1.4, 0.1); AbsPoint M3(5, 0, -0.6);
    AbsPoint T1(10, 1.5, 1); AbsPoint T2(10, 1.3, -0.25); AbsPoint T3(10, 0, -0.5);
    Line a1(S1, S2); Line a2(S2, S3); PolyCurve a({a1, a2}); Line b1(M1, M2); Line b2(M2, M3);
    PolyCurve b({b1, b2}); Line c1(T1, T2); Line c2(T2, T3); PolyCurve c({c1, c2});
    CLoftSurf hull({a, b, c});";

/// Length of the chords between `count` equal steps of the parameter, each in the direction of the
/// tangents at its ends, corrected for curvature.
fn unfolded_length(curve: &CurveRef<f64>, count: usize, what: &str) -> f64 {
    let jets: Vec<_> =
        (0..=count).map(|k| curve.jet(k as f64 / count as f64, Order::First)).collect();
    let mut sum = 0.0;
    for pair in jets.windows(2) {
        let chord = pair[1][0] - pair[0][0];
        for jet in pair {
            let cosine = chord.dot(jet[1]) / (chord.norm() * jet[1].norm());
            // A crease turns by less than a right angle.
            assert!(cosine > 0.0, "{what}: a fold at {:?}: {cosine}", jet[0]);
        }
        sum += chord.norm();
    }
    sum
}

#[test]
fn a_waterline_from_the_bow_crosses_the_chine_once() {
    let scene = scene(&format!(
        "{CHINES} EdgeSnake stem(1, hull); EdgeSnake tran(3, hull); XYZRing bow(stem, \"z\", 0);
         XYZRing stern(tran, \"z\", 0); IntSnake w(hull, \"z=0\", bow, stern);
         IntSnake all(hull, \"z=0\");"
    ));
    let [w, all] = ["w", "all"].map(|name| scene.curve(name));
    assert_eq!(w.breaks().len(), 1);
    unfolded_length(w, 4000, "waterline");
    let (a, b) = (w.jet(0.0, Order::First), all.jet(1.0, Order::First));
    assert!(a[0].distance(b[0]) < 1e-12 && (a[1] + b[1]).norm() < 1e-11, "{a:?} {b:?}");
    // For the upper and the lower strake, each a parabola loft by chords: from dense bisection.
    let mut length = 0.0;
    let hull = scene.surface("hull");
    let mut last: Option<Vec3> = None;
    let steps = 20_000;
    for k in 0..=steps {
        let v = f64::from(k) / f64::from(steps);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let u = 0.5 * (low + high);
            if hull.jet(u, v, Order::Zero).p.z > 0.0 { low = u } else { high = u }
        }
        let x = hull.jet(low, v, Order::Zero).p;
        length += last.map_or(0.0, |l| l.distance(x));
        last = Some(x);
    }
    let own = w.jet(0.3, Order::First)[1].norm();
    assert!((own - length).abs() < 1e-6 * length, "{own} and {length}");
}

/// A surface over poly-lines whose strakes meet at creases, sharp ones and weak ones.
fn creased(random: &mut Random, text: &mut String, name: &str) {
    let strakes = 2 + random.below(2);
    let mut sections = Vec::new();
    let bend = if random.below(2) == 0 { 1.0 } else { 0.2 };
    for (s, x) in ["a", "b", "c"].iter().zip([0.0_f64, 5.0, 10.0]) {
        let mut lines = Vec::new();
        for k in 0..=strakes {
            let down = k as f64 / strakes as f64;
            let y = 0.4 * x.min(6.0) * (1.0 - down * down) + random.between(-0.4, 0.4) * bend;
            let z = 1.5 - 3.0 * down + random.between(-0.3, 0.3);
            let aft = x + random.between(-0.5, 0.5);
            write!(text, "AbsPoint {name}{s}{k}({aft}, {y}, {z}); ").unwrap();
            if k > 0 {
                let before = k - 1;
                write!(text, "Line {name}{s}l{k}({name}{s}{before}, {name}{s}{k}); ").unwrap();
                lines.push(format!("{name}{s}l{k}"));
            }
        }
        write!(text, "PolyCurve {name}{s}({{{}}}); ", lines.join(", ")).unwrap();
        sections.push(format!("{name}{s}"));
    }
    let [a, b, c] = [0, 1, 2].map(|k| sections[k].clone());
    let kind = match random.below(4) {
        0 | 1 => format!("CLoftSurf {name}({{{a}, {b}, {c}}}); "),
        2 => format!("BLoftSurf {name}({{{a}, {b}, {c}}}, 2); "),
        _ => format!("RuledSurf {name}({a}, {c}); "),
    };
    text.push_str(&kind);
}

/// A plane or surface `cutter` across the surface.
fn cutter(random: &mut Random, text: &mut String) {
    let mut p = |low: f64, high: f64| random.between(low, high);
    let (z, tilt, lean) = (p(-0.9, 0.9), p(-0.6, 0.6), p(-0.5, 0.5));
    let bow = p(-0.5, 0.5);
    let corners = [
        ("A", -2.0, -4.0, z - tilt - lean),
        ("B", 12.0, -4.0, z + tilt - lean),
        ("C", -2.0, 6.0, z - tilt + lean),
        ("D", 12.0, 6.0, z + tilt + lean + bow),
        ("E", 5.0, -4.0, z + bow - lean),
    ];
    match random.below(5) {
        0 => write!(text, "ZPlane cutter({z}); ").unwrap(),
        1 => {
            for (name, x, y, z) in &corners[..3] {
                write!(text, "AbsPoint {name}({x}, {y}, {z}); ").unwrap();
            }
            text.push_str("ThreePointPlane cutter(A, B, C); ");
        }
        kind => {
            for (name, x, y, z) in corners {
                write!(text, "AbsPoint {name}({x}, {y}, {z}); ").unwrap();
            }
            text.push_str(match kind {
                2 => "Line m(A, B); Line n(C, D); RuledSurf cutter(m, n); ",
                3 => "BCurve m({A, E, B}, 2); Line n(C, D); RuledSurf cutter(m, n); ",
                // Creased itself.
                _ => {
                    "Line m1(A, E); Line m2(E, B); PolyCurve m({m1, m2}); Line n(C, D);
                     RuledSurf cutter(m, n); "
                }
            });
        }
    }
}

/// Signed distance from a plane, or along z from a surface given by its graph.
fn height(scene: &Scene<f64>, x: Vec3) -> f64 {
    match scene.value("cutter") {
        moldloft_registry::Value::Plane(p) => p.distance(x),
        moldloft_registry::Value::Surface(s) => {
            let near = moldloft_locate::nearest_on_surface(&**s, x, None);
            let jet = s.jet(near.at[0], near.at[1], Order::First);
            (x - jet.p).dot(jet.u.cross(jet.v).normalized().unwrap_or_default())
        }
        other => panic!("{other:?}"),
    }
}

/// Total length of the level lines of `height` on a grid of the surface, whose lines are in the
/// creases.
fn level_length(scene: &Scene<f64>, steps: usize) -> f64 {
    let surface = scene.surface("s");
    let xs: Vec<Vec<Vec3>> = (0..=steps)
        .map(|i| {
            let at = |j: usize| {
                let [u, v] = [i, j].map(|k| k as f64 / steps as f64);
                surface.jet(u, v, Order::Zero).p
            };
            (0..=steps).map(at).collect()
        })
        .collect();
    let hs: Vec<Vec<f64>> =
        xs.iter().map(|row| row.iter().map(|x| height(scene, *x)).collect()).collect();
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            for corners in
                [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]]
            {
                let mut ends = Vec::new();
                for k in 0..3 {
                    let ((a, b), (c, d)) = (corners[k], corners[(k + 1) % 3]);
                    let (f, g) = (hs[a][b], hs[c][d]);
                    if (f < 0.0) != (g < 0.0) {
                        ends.push(xs[a][b] + (xs[c][d] - xs[a][b]) * (f / (f - g)));
                    }
                }
                if let [p, q] = ends[..] {
                    sum += p.distance(q);
                }
            }
        }
    }
    sum
}

#[test]
fn cuts_of_creased_surfaces_do_not_fold() {
    let mut random = Random::new(4211);
    let rounds = if soak() { 2000 } else { 24 };
    let (mut made, mut whole) = (0, 0);
    for round in 0..rounds {
        let mut text = String::new();
        creased(&mut random, &mut text, "s");
        cutter(&mut random, &mut text);
        let [p, q] = [random.between(0.05, 0.45), random.between(0.55, 0.95)];
        text.push_str("IntSnake w(s, cutter); ");
        let first = match attempt(&text) {
            Ok(first) => first,
            Err(fault) if fault.id == "no-intersection" => continue,
            Err(fault) => panic!("round {round}\n{text}\n{fault:?}"),
        };
        write!(
            text,
            "AbsRing p(w, {p}); AbsRing q(w, {q}); IntSnake part(s, cutter, p, q);
             AbsRing r0(w, 0); AbsRing r1(w, 1); "
        )
        .unwrap();
        let open = !first.curve("w").closed();
        if open {
            text.push_str("IntSnake back(s, cutter, r1, r0); IntSnake on(s, cutter, r0, r1); ");
        }
        let on_both = matches!(first.value("cutter"), moldloft_registry::Value::Surface(_));
        if on_both {
            text.push_str("IntSnake other(cutter, s); ");
        }
        let scene = attempt(&text).unwrap_or_else(|f| panic!("round {round}\n{text}\n{f:?}"));
        made += 1;
        let length = |name: &str| {
            let curve = scene.curve(name);
            let length = curve.jet(0.37, Order::First)[1].norm();
            let chords = unfolded_length(curve, 2000, &format!("round {round}, {name}\n{text}"));
            let known = (chords - length).abs() < 1e-3 * length;
            assert!(known, "round {round}, {name}: {length} and {chords}\n{text}");
            for k in 0..=40 {
                let x = curve.jet(f64::from(k) / 40.0, Order::Zero)[0];
                let off = height(&scene, x).abs();
                assert!(off < 1e-9, "round {round}, {name}: {off:e} off\n{text}");
            }
            length
        };
        let all = length("w");
        let near = |x: f64, y: f64, what: &str| {
            assert!((x - y).abs() < 1e-8 * all, "round {round}, {what}: {x} and {y}\n{text}");
        };
        // For a closed one the shorter path may be the result.
        if open {
            near(length("part"), all * (q - p), "part");
            near(length("back"), all, "back");
            near(length("on"), all, "on");
        }
        let found = scene.curve("w").found.as_ref().unwrap();
        if found.status == SearchStatus::Ok && round % 4 == 0 {
            whole += 1;
            let level = level_length(&scene, 96);
            assert!((level - all).abs() < 5e-3 * all, "round {round}: {all} and {level}\n{text}");
        }
        if on_both {
            near(length("other"), all, "other");
        }
    }
    assert!(made * 2 > rounds && whole > 0, "{made} of {rounds}, {whole} whole");
}
