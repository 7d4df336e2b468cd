//! Coincident, collinear and coplanar points: every kind's example is finite or refused by name.

use crate::common::{Scene, attempt};
use moldloft_num::{Curve, Order, Surface, Vec3};
use moldloft_registry::Value;
use moldloft_testing::{Random, soak};
use std::fmt::Write;

/// A degeneration of points.
type Degeneration = fn(&mut Vec<Vec3>, &mut Random);

/// Replaces the first `count` points by the first of them.
fn gathered(points: &mut [Vec3], count: usize) {
    let count = count.min(points.len());
    let first = points[0];
    points[1..count].fill(first);
}

fn from_end(points: &mut [Vec3], degenerate: impl Fn(&mut [Vec3])) {
    points.reverse();
    degenerate(points);
    points.reverse();
}

/// The same point but for so much.
fn nearly(points: &mut [Vec3], aside: f64) {
    let n = points.len();
    if n > 1 {
        points[n - 1] = points[n - 2] + Vec3::new(aside, -aside, 0.5 * aside);
    }
}

const DEGENERATIONS: [(&str, Degeneration); 20] = [
    ("double end", |p, _| from_end(p, |p| gathered(p, 2))),
    ("double begin", |p, _| gathered(p, 2)),
    ("triple end", |p, _| from_end(p, |p| gathered(p, 3))),
    ("triple begin", |p, _| gathered(p, 3)),
    ("quadruple begin", |p, _| gathered(p, 4)),
    ("double ends", |p, _| {
        gathered(p, 2);
        from_end(p, |p| gathered(p, 2));
    }),
    ("double in the middle", |p, _| {
        let k = p.len() / 2;
        gathered(&mut p[k.saturating_sub(1)..], 2);
    }),
    ("triple in the middle", |p, _| {
        let k = p.len() / 2;
        gathered(&mut p[k.saturating_sub(1)..], 3);
    }),
    ("all in one place", |p, _| gathered(p, usize::MAX)),
    ("two by two", |p, _| p.chunks_mut(2).for_each(|pair| gathered(pair, 2))),
    ("there and back", |p, _| {
        for k in 2..p.len() {
            p[k] = p[k - 2];
        }
    }),
    ("end at begin", |p, _| {
        let n = p.len();
        p[n - 1] = p[0];
    }),
    ("on a line", |p, _| p.iter_mut().for_each(|p| *p = Vec3::new(p.x, 0.0, 0.0))),
    ("on a line, double end", |p, _| {
        p.iter_mut().for_each(|p| *p = Vec3::new(0.0, p.y + p.x, 0.0));
        from_end(p, |p| gathered(p, 2));
    }),
    ("in the plane z = 0", |p, _| p.iter_mut().for_each(|p| p.z = 0.0)),
    ("in the plane y = 0", |p, _| p.iter_mut().for_each(|p| p.y = 0.0)),
    ("1e-9 apart at the end", |p, _| nearly(p, 1e-9)),
    ("1e-14 apart at the end", |p, _| nearly(p, 1e-14)),
    ("small", |p, _| p.iter_mut().for_each(|p| *p = *p * 1e-9)),
    ("any two", |p, random| {
        let (a, b) = (random.below(p.len()), random.below(p.len()));
        p[a] = p[b];
    }),
];

/// The source ranges of the points that a program states, and their coordinates.
fn points(text: &str) -> Vec<(std::ops::Range<usize>, Vec3)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("AbsPoint ") {
        let open = at + text[at..].find('(').expect("arguments");
        let close = open + text[open..].find(')').expect("their end");
        let numbers: Option<Vec<f64>> =
            text[open + 1..close].split(',').map(|x| x.trim().parse().ok()).collect();
        if let Some([x, y, z]) = numbers.as_deref() {
            found.push((open + 1..close, Vec3::new(*x, *y, *z)));
        }
    }
    found
}

/// A program with other points.
fn moved(text: &str, places: &[(std::ops::Range<usize>, Vec3)], points: &[Vec3]) -> String {
    let (mut made, mut at) = (String::new(), 0);
    for ((range, _), p) in places.iter().zip(points) {
        let _ = write!(made, "{}{:?}, {:?}, {:?}", &text[at..range.start], p.x, p.y, p.z);
        at = range.end;
    }
    made + &text[at..]
}

/// Both ends of (0, 1), values next to them, breaks and values between.
fn parameters(breaks: &[f64]) -> Vec<f64> {
    let mut all =
        vec![0.0, f64::EPSILON, 1e-9, 0.31, 0.5, 0.77, 1.0 - 1e-9, 1.0_f64.next_down(), 1.0];
    all.extend(breaks.iter().take(6));
    all
}

/// The objects of a scene with positions, or slopes, that are not finite.
fn not_finite(scene: &Scene<f64>) -> Vec<String> {
    let mut wrong = Vec::new();
    for object in &scene.0 {
        let mut report = |what: &str| wrong.push(format!("{}: {what}", object.name));
        match &object.value {
            Value::Curve(curve) => {
                for t in parameters(&curve.breaks()) {
                    let jet = curve.jet(t, Order::First);
                    if !jet[0].is_finite() || !curve.jet(t, Order::Zero)[0].is_finite() {
                        report(&format!("place at {t:?}"));
                    } else if !jet[1].is_finite() {
                        report(&format!("slope at {t:?}"));
                    }
                }
            }
            Value::Surface(surface) => {
                let [us, vs] = surface.breaks().map(|breaks| parameters(&breaks));
                for (u, v) in us.iter().flat_map(|u| vs.iter().map(move |v| (*u, *v))) {
                    let jet = surface.jet(u, v, Order::First);
                    if !jet.p.is_finite() || !surface.jet(u, v, Order::Zero).p.is_finite() {
                        report(&format!("place at {u:?}, {v:?}"));
                    } else if !jet.u.is_finite() || !jet.v.is_finite() {
                        report(&format!("slope at {u:?}, {v:?}"));
                    }
                }
            }
            Value::Solid(solid) => {
                for k in 0..27 {
                    let [u, v, w] = [k / 9, k / 3 % 3, k % 3].map(|k| [0.0, 0.43, 1.0][k]);
                    if !solid.eval(u, v, w).is_finite() {
                        report(&format!("place at {u}, {v}, {w}"));
                    }
                }
            }
            _ => {}
        }
    }
    wrong
}

#[test]
fn degenerate_examples_are_finite_or_refused() {
    let mut random = Random::new(17);
    let (mut cases, mut refused, mut wrong) = (0, 0, Vec::new());
    for (r, row) in
        moldloft_relational::rows().into_iter().filter(|row| row.sweep.is_none()).enumerate()
    {
        let places = points(&row.example);
        if places.is_empty() {
            continue;
        }
        for (d, (name, degenerate)) in DEGENERATIONS.iter().enumerate() {
            if !soak() && (r + d) % 10 != 0 {
                continue;
            }
            let mut points: Vec<Vec3> = places.iter().map(|(_, p)| *p).collect();
            degenerate(&mut points, &mut random);
            let text = moved(&row.example, &places, &points);
            cases += 1;
            let Ok(scene) = attempt(&text) else {
                refused += 1;
                continue;
            };
            let found = not_finite(&scene);
            if let Some(first) = found.first() {
                wrong.push(format!(
                    "{} ({name}): {first}, {} in all\n{text}",
                    row.name,
                    found.len()
                ));
            }
        }
    }
    println!("{cases} cases, {refused} refused");
    assert!(wrong.is_empty(), "{} of {cases}:\n{}", wrong.len(), wrong.join("\n"));
}
