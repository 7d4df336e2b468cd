//! Curves that continue others with continuous curvature.

use crate::fixtures::*;
use moldloft_fair::rows;
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{
    CallError, Class, Context, CurveRef, Given, Registry, Scalar, Value, bind_arguments,
};

fn call<T: Scalar>(
    positional: Vec<Value<T>>,
    named: Vec<(&str, Value<T>)>,
) -> Result<CurveRef<T>, CallError> {
    let registry = Registry::new(rows());
    let row = registry.get("FairCurve").unwrap();
    let (args, _) = bind_arguments(row, Given { positional, named }, |_| Class::Any)?;
    match T::call(row, &args, &Context::default())? {
        Value::Curve(curve) => Ok(curve),
        other => panic!("{other:?}"),
    }
}

fn list<T: Real>(points: &[Vec3<T>]) -> Value<T> {
    Value::list(points.iter().map(|&p| Value::Vector(p)))
}

/// One long noisy line cut in three: the middle one meets both others.
fn three() -> [Vec<Vec3<f64>>; 3] {
    let mut random = Lcg::new(8);
    let all: Vec<_> = (0..31)
        .map(|i| {
            let t = f64::from(i) / 15.0;
            let y = 0.4 * (2.0 * t).sin() + 1e-3 * random.centred();
            Vec3::of(t, y, 0.1 * t * t + 1e-3 * random.centred())
        })
        .collect();
    [all[..=9].to_vec(), all[9..=21].to_vec(), all[21..].to_vec()]
}

const TOLERANCE: f64 = 0.02;

fn neighbour<T: Scalar>(points: &[Vec3<T>], turned: bool) -> Value<T> {
    let mut points = points.to_vec();
    if turned {
        points.reverse();
    }
    Value::Curve(call(vec![list(&points), Value::Number(T::zero())], vec![]).unwrap())
}

/// Unit tangent and curvature vector of a jet.
fn bend([_, d1, d2]: [Vec3<f64>; 3]) -> (Vec3<f64>, Vec3<f64>) {
    let tangent = d1.normalized().unwrap();
    (tangent, (d2 - tangent * d2.dot(tangent)) * (1.0 / d1.norm_sq()))
}

#[test]
fn curvature_runs_on_at_both_ends() {
    let [fore, middle, aft] = three();
    for role in ["fit", "control"] {
        for turned in [false, true] {
            let joins = Value::list([neighbour(&aft, turned), neighbour(&fore, turned)]);
            // Control points are ends on knots that say so.
            let inner = middle.len() - 2;
            let knots = (0..inner).map(|k| k as f64 / (inner - 1) as f64);
            let knots = [0.0; 3].into_iter().chain(knots).chain([1.0; 3]).map(Value::Number);
            let clamped = ("knots", Value::list(knots.collect::<Vec<_>>()));
            let mut named = vec![("joins", joins), ("as", Value::text(role))];
            if role == "control" {
                named.extend([clamped, ("bound", Value::text("curve"))]);
            }
            let curve = call(vec![list(&middle), Value::Number(TOLERANCE)], named).unwrap();
            let [a, b] = [&fore, &aft].map(|p| {
                let Value::Curve(c) = neighbour(p, false) else { panic!() };
                c
            });
            for (own, other) in [(0.0, a.jet(1.0, Order::Second)), (1.0, b.jet(0.0, Order::Second))]
            {
                let here = curve.jet(own, Order::Second);
                assert!((here[0] - other[0]).norm() < 1e-14);
                let ((t, k), (s, l)) = (bend(here), bend(other));
                assert!((t - s).norm() < 1e-9, "{role} {own} {t:?} {s:?}");
                assert!((k - l).norm() < 1e-7 * (1.0 + l.norm()), "{role} {own} {k:?} {l:?}");
            }
            // Without the joins nothing makes the curvatures agree.
            let named = vec![("as", Value::text(role))];
            let free = call(vec![list(&middle), Value::Number(TOLERANCE)], named).unwrap();
            let (k, l) = (bend(free.jet(0.0, Order::Second)).1, bend(a.jet(1.0, Order::Second)).1);
            assert!((k - l).norm() > 1e-2);
        }
    }
}

/// The curve answers to its own points, to its neighbour's and to the tolerance.
#[test]
fn derivatives_run_through_the_join() {
    let [fore, middle, _] = three();
    // High differences have fewer digits, and need longer steps.
    for (measure, band, h) in [("second", 1e-5, 1e-6), ("third", 1e-4, 1e-6), ("jumps", 1e-3, 1e-5)]
    {
        let make = |fore: &[Vec3<f64>], middle: &[Vec3<f64>], tolerance: f64| {
            let named = vec![
                ("joins", Value::list([neighbour(fore, false)])),
                ("measure", Value::text(measure)),
            ];
            call(vec![list(middle), Value::Number(tolerance)], named).unwrap()
        };
        let lifted = |points: &[Vec3<f64>]| -> Vec<Vec3<Dual4>> {
            points.iter().map(|&p| Vec3::lifted(p)).collect()
        };
        let (mut near, mut own) = (lifted(&fore), lifted(&middle));
        near[7].y = Dual4::seeded(fore[7].y, 0);
        own[3].y = Dual4::seeded(middle[3].y, 1);
        let named = vec![
            ("joins", Value::list([neighbour(&near, false)])),
            ("measure", Value::text(measure)),
        ];
        let tolerance = Value::Number(Dual4::seeded(TOLERANCE, 2));
        let dual = call(vec![list(&own), tolerance], named).unwrap();
        for t in [0.0, 0.1, 0.45, 0.8] {
            let exact = dual.jet(Dual4::from(t), Order::Zero)[0];
            let at = |d: usize, by: f64| {
                let (mut fore, mut middle) = (fore.clone(), middle.clone());
                match d {
                    0 => fore[7].y += by,
                    1 => middle[3].y += by,
                    _ => {}
                }
                let tolerance = TOLERANCE + if d == 2 { by } else { 0.0 };
                make(&fore, &middle, tolerance).jet(t, Order::Zero)[0]
            };
            assert!(exact.re().bits_eq(at(0, 0.0)));
            for d in 0..3 {
                let wanted = (at(d, h) - at(d, -h)) * (0.5 / h);
                let off = (exact.map(|x| x.eps[d]) - wanted).norm();
                assert!(
                    off < band * (1.0 + wanted.norm()),
                    "{measure} {t} {d} {exact:?} {wanted:?}"
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_joined_is_refused() {
    let [fore, middle, aft] = three();
    let fault = |points: &[Vec3<f64>], tolerance: f64, named: Vec<(&str, Value<f64>)>| {
        let Err(f) = call(vec![list(points), Value::Number(tolerance)], named) else { panic!() };
        let text = f.message.clone();
        (f.id, f.field().map(|field| (field, f.item())), text)
    };
    let joins = |all: Vec<Value<f64>>| ("joins", Value::list(all));
    let one = || joins(vec![neighbour(&fore, false)]);
    let (id, place, _) = fault(&aft, 0.1, vec![one()]);
    assert_eq!((id, place), ("no-common-end", Some((9, Some(0)))));
    let twice = joins(vec![neighbour(&fore, false), neighbour(&fore, true)]);
    let (id, place, _) = fault(&middle, 0.1, vec![twice]);
    assert_eq!((id, place), ("joined-twice", Some((9, Some(1)))));
    for words in [("closed", Value::Number(1.0)), ("mode", Value::text("faithful"))] {
        assert_eq!(fault(&middle, 0.1, vec![one(), words]).0, "not-joined");
    }
    // Control points of a uniform spline are not its ends.
    for words in [("as", "control"), ("bound", "curve")] {
        let mut named = vec![one(), (words.0, Value::text(words.1))];
        named.extend((words.0 == "bound").then_some(("as", Value::text("points"))));
        assert_eq!(fault(&middle, 0.1, named).0, "no-common-end");
    }
    // An end with another curvature, and a tolerance far too small for it.
    let all = joins(vec![neighbour(&aft, false), neighbour(&fore, false)]);
    let (id, place, text) = fault(&middle, 1e-7, vec![all]);
    assert_eq!(id, "contradiction", "{text}");
    assert!(place.is_some_and(|p| p.0 == 9) && text.contains("tolerance"));
    // A neighbour in the opposite direction.
    let back: Vec<_> = middle.iter().map(|p| *p + Vec3::of(0.0, 0.0, 0.01 * (p.x - 0.6))).collect();
    let back: Vec<_> = back.iter().map(|p| if *p == back[0] { middle[0] } else { *p }).collect();
    let (id, ..) = fault(&middle, 0.1, vec![joins(vec![neighbour(&back, false)])]);
    assert_eq!(id, "turns-back");
}
