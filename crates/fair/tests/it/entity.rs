//! The kinds: values, derivatives, bits and faults.

use crate::fixtures::*;
use moldloft_fair::rows;
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{
    Array, CallError, Class, Context, CurveRef, Given, Registry, Scalar, SurfaceRef, Value,
    Vectors, bind_arguments,
};
use std::sync::Arc;

pub fn call<T: Scalar>(
    name: &str,
    positional: Vec<Value<T>>,
    named: Vec<(&str, Value<T>)>,
) -> Result<Value<T>, CallError> {
    let registry = Registry::new(rows());
    let row = registry.get(name).unwrap();
    let (args, _) = bind_arguments(row, Given { positional, named }, |_| Class::Any)?;
    T::call(row, &args, &Context::default())
}

fn list<T: Real>(points: &[Vec3<T>]) -> Value<T> {
    Value::list(points.iter().map(|&p| Value::Vector(p)))
}

fn curve<T: Scalar>(value: Value<T>) -> CurveRef<T> {
    let Value::Curve(curve) = value else { panic!("{value:?}") };
    curve
}

fn noisy(n: usize, seed: u64) -> Vec<Vec3<f64>> {
    let mut random = Lcg::new(seed);
    (0..n)
        .map(|i| {
            let t = i as f64 / (n - 1) as f64;
            Vec3::of(
                t,
                0.2 * t * (1.0 - t) + 2e-3 * random.centred(),
                0.1 * t * t + 2e-3 * random.centred(),
            )
        })
        .collect()
}

/// Dual numbers that move point k along a direction, and the tolerance in another.
fn seeded(points: &[Vec3<f64>], k: usize) -> Vec<Vec3<Dual4>> {
    let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
    dual[k].y = Dual4::seeded(points[k].y, 0);
    dual[k].z = Dual4::seeded(points[k].z, 1);
    dual
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    let points = noisy(25, 5);
    let (k, mut compared) = (11, 0);
    for measure in ["second", "third", "jumps", "bending", "variation"] {
        for role in ["fit", "control", "points"] {
            for mode in ["optimum", "faithful"] {
                if mode == "faithful" && measure != "second" {
                    continue;
                }
                // Steps of fits have derivatives where parameters do not follow the points.
                let spacing = if mode == "faithful" { "index" } else { "auto" };
                let words =
                    [("measure", measure), ("as", role), ("mode", mode), ("spacing", spacing)];
                let plain = |points: &[Vec3<f64>], tolerance: f64| {
                    let named = words.iter().map(|(a, b)| (*a, Value::text(b))).collect();
                    curve(
                        call("FairCurve", vec![list(points), Value::Number(tolerance)], named)
                            .unwrap(),
                    )
                };
                let named = words.iter().map(|(a, b)| (*a, Value::text(b))).collect();
                let tolerance = Dual4::seeded(8e-4, 2);
                let args = vec![list(&seeded(&points, k)), Value::Number(tolerance)];
                let dual = curve(call("FairCurve", args, named).unwrap());
                let base = plain(&points, 8e-4);
                let h = if mode == "faithful" { 1e-7 } else { 1e-6 };
                for t in [0.31, 0.48, 0.7] {
                    let exact = dual.jet(Dual4::from(t), Order::Zero)[0];
                    let here = base.jet(t, Order::Zero)[0];
                    assert!(exact.re().bits_eq(here), "{measure} {role} {mode}");
                    for direction in 0..3 {
                        let moved = |by: f64| {
                            let mut p = points.clone();
                            let mut tolerance = 8e-4;
                            match direction {
                                0 => p[k].y += by,
                                1 => p[k].z += by,
                                _ => tolerance += by,
                            }
                            plain(&p, tolerance).jet(t, Order::Zero)[0]
                        };
                        let centred = (moved(h) - moved(-h)) * (0.5 / h);
                        let wider = (moved(3.0 * h) - moved(-3.0 * h)) * (0.5 / (3.0 * h));
                        let got = exact.map(|x| x.eps[direction]);
                        let off = (got - centred).norm();
                        // Ranked steps jump where the order of knots changes, and along an almost
                        // straight curve the solver's last digits are inaccurate.
                        let flips = (wider - centred).norm() > 3e-3 * (centred.norm() + 0.1);
                        if flips {
                            continue;
                        }
                        compared += 1;
                        // High differences leave barely touched limits undecided for longer.
                        let band = if measure == "second" { 2e-3 } else { 1e-2 };
                        assert!(
                            off < band * (centred.norm() + 0.1),
                            "{measure} {role} {mode} {t} {direction}: {got:?} {centred:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn the_curve_keeps_its_ends_and_its_tolerance() {
    let points = noisy(30, 2);
    let line = |tolerance: f64, ends: &str| {
        let named = vec![("ends", Value::text(ends))];
        curve(call("FairCurve", vec![list(&points), Value::Number(tolerance)], named).unwrap())
    };
    let through = line(0.0, "tangent");
    let near = |of: &CurveRef<f64>, p: Vec3<f64>| {
        (0..=4000)
            .map(|k| (of.jet(f64::from(k) / 4000.0, Order::Zero)[0] - p).norm())
            .fold(f64::INFINITY, f64::min)
    };
    for p in &points {
        assert!(near(&through, *p) < 1e-3);
    }
    for ends in ["free", "position", "tangent", "curvature"] {
        let faired = line(1e-2, ends);
        for p in &points {
            // Samples are up to 1.25e-4 from the nearest point.
            assert!(near(&faired, *p) <= 1e-2 * (1.0 + 1e-3));
        }
        let kept = ["position", "tangent", "curvature"].iter().position(|e| *e == ends);
        for order in 0..3 {
            let off = (faired.jet(0.0, Order::Second)[order]
                - through.jet(0.0, Order::Second)[order])
                .norm();
            assert_eq!(off < 1e-9, kept.is_some_and(|k| order <= k), "{ends} {order} {off}");
        }
    }
}

#[test]
fn closed_curves_breaks_and_snakes() {
    let f = f3();
    let args = vec![list(&f.points), Value::Number(f.tolerance)];
    let closed = curve(call("FairCurve", args, vec![("closed", Value::Number(1.0))]).unwrap());
    let [a, b] = [0.0, 1.0].map(|t| closed.jet(t, Order::Second));
    for k in 0..3 {
        assert!((a[k] - b[k]).norm() < 1e-9 * (1.0 + a[k].norm()));
    }
    let mut points = noisy(21, 4);
    points[10].y += 0.4;
    let breaks = Value::list([Value::Number(11.0)]);
    let args = vec![list(&points), Value::Number(1e-3)];
    let named = vec![("breaks", breaks), ("as", Value::text("control"))];
    assert!(call::<f64>("FairCurve", args, named).is_ok());

    struct Flat;
    impl moldloft_num::SurfaceFormula for Flat {
        type Scalar = f64;
        fn at<J: moldloft_num::Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
            Vec3::new(u * 4.0, v * 3.0, u * v)
        }

        moldloft_num::surface_facts!(smooth, open, not_rational);
    }
    let surface = SurfaceRef::new(Flat, 0);
    let magnets = Value::list(points.iter().map(|p| {
        let at = moldloft_registry::Point::on_surface(surface.clone(), p.x, 0.3 + p.y);
        Value::Point(Box::new(at))
    }));
    let snake = curve(call("FairSnake", vec![magnets, Value::Number(1e-3)], vec![]).unwrap());
    assert!(snake.surface.is_some());
    let [w, ..] = snake.on_surface(0.4, Order::Zero).unwrap();
    let p = snake.jet(0.4, Order::Zero)[0];
    assert!((p - Vec3::of(4.0 * w.x, 3.0 * w.y, w.x * w.y)).norm() < 1e-15);
}

#[test]
fn surfaces_are_fair_and_have_derivatives() {
    let (m, n) = (12, 9);
    let mut random = Lcg::new(6);
    let points: Vec<_> = (0..m * n)
        .map(|k| {
            let (u, v) = ((k / n) as f64 / 11.0, (k % n) as f64 / 8.0);
            Vec3::of(u, v, 0.2 * u * v + 2e-3 * random.centred())
        })
        .collect();
    for role in ["fit", "control"] {
        let make = |points: Vec<Vec3<f64>>| {
            let grid = Value::Vectors(Arc::new(Vectors::grid(m, n, points)));
            let args = vec![grid, Value::Number(8e-4)];
            let value = call("FairSurf", args, vec![("as", Value::text(role))]).unwrap();
            let Value::Surface(s) = value else { panic!() };
            s.jet(0.43, 0.61, Order::Zero).p
        };
        let k = 5 * n + 5;
        let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
        dual[k].z = Dual4::seeded(points[k].z, 1);
        let args =
            vec![Value::Vectors(Arc::new(Vectors::grid(m, n, dual))), Value::Number(8e-4.into())];
        let value = call("FairSurf", args, vec![("as", Value::text(role))]).unwrap();
        let Value::Surface(s) = value else { panic!() };
        let got = s.jet(Dual4::from(0.43), Dual4::from(0.61), Order::Zero).p;
        assert!(got.re().bits_eq(make(points.clone())));
        let moved = |by: f64| {
            let mut p = points.clone();
            p[k].z += by;
            make(p)
        };
        let centred = (moved(1e-7) - moved(-1e-7)) * 0.5e7;
        assert!(
            (got.map(|x| x.eps[1]) - centred).norm() < 2e-4 * (0.1 + centred.norm()),
            "{role} {got:?} {centred:?}"
        );
    }
}

#[test]
fn functions_of_rows_and_curves() {
    let f = f2b();
    let jumps = call("jumps", vec![list(&f.points)], vec![]).unwrap();
    let Value::Numbers(e) = jumps else { panic!() };
    assert_eq!(e.items.len(), f.points.len() - 4);
    near("largest jump", e.items.iter().copied().fold(0.0, f64::max), 1.291809e-3, 1e-6);
    let faired = call("fair", vec![list(&f.points), Value::Number(f.tolerance)], vec![]).unwrap();
    let Value::Vectors(q) = faired else { panic!() };
    let second: f64 = q.points().windows(3).map(|w| (w[0] - w[1] * 2.0 + w[2]).norm_sq()).sum();
    near("optimum", second, 1.93909366e-6, 1e-6);

    let circle: Vec<_> = (0..40)
        .map(|i| std::f64::consts::TAU * f64::from(i) / 40.0)
        .map(|a| Vec3::of(2.0 * a.cos(), 2.0 * a.sin(), 0.0))
        .collect();
    let args = vec![list(&circle), Value::Number(0.0)];
    let c = call("FairCurve", args, vec![("closed", Value::Number(1.0))]).unwrap();
    let Value::Number(k) = call("curvature", vec![c.clone(), Value::Number(0.3)], vec![]).unwrap()
    else {
        panic!()
    };
    near("curvature", k, 0.5, 3e-3);
    let ts = Value::Numbers(Arc::new(Array::row(vec![0.1, 0.5])));
    let Value::Numbers(ks) = call("curvature", vec![c, ts], vec![]).unwrap() else { panic!() };
    assert_eq!(ks.items.len(), 2);
}

#[test]
fn faults_name_their_argument() {
    let points = noisy(12, 1);
    let fault = |points: &[Vec3<f64>], tolerance: f64, named: Vec<(&str, Value<f64>)>| {
        let f = call::<f64>("FairCurve", vec![list(points), Value::Number(tolerance)], named)
            .unwrap_err();
        (f.id, f.field())
    };
    assert_eq!(fault(&points[..4], 0.1, vec![]), ("too-few-items", Some(0)));
    assert_eq!(fault(&points, -0.1, vec![]), ("out-of-range", Some(1)));
    assert_eq!(
        fault(&points, 0.1, vec![("measure", Value::text("fast"))]),
        ("unknown-name", Some(2))
    );
    assert_eq!(fault(&points, 0.1, vec![("as", Value::text("x"))]), ("unknown-name", Some(3)));
    let breaks = |x: f64| vec![("breaks", Value::list([Value::Number(x)]))];
    assert_eq!(fault(&points, 0.1, breaks(13.0)), ("out-of-range", Some(4)));
    assert_eq!(fault(&points, 0.1, breaks(0.0)), ("out-of-range", Some(4)));
    assert_eq!(fault(&points, 0.1, vec![("ends", Value::text("x"))]), ("unknown-name", Some(5)));
    assert_eq!(fault(&points, 0.1, vec![("mode", Value::text("x"))]), ("unknown-name", Some(6)));
    let low = vec![("degree", Value::Number(2.0)), ("measure", Value::text("third"))];
    assert_eq!(fault(&points, 0.1, low), ("out-of-range", Some(7)));
    let row = Value::Vectors(Arc::new(Vectors::row(points)));
    let f = call::<f64>("FairSurf", vec![row, Value::Number(0.1)], vec![]).unwrap_err();
    assert_eq!(f.id, "wrong-shape");
}
