//! Rational splines and given knots in the kinds: meaning, derivatives, refusals.

use crate::fixtures::*;
use moldloft_fair::rows;
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{
    Array, ArrayShape, CallError, Class, Context, Given, Registry, Scalar, Value, Vectors,
    bind_arguments,
};
use std::sync::Arc;

type Named<T> = Vec<(&'static str, Value<T>)>;

fn call<T: Scalar>(
    name: &str,
    positional: Vec<Value<T>>,
    named: Named<T>,
) -> Result<Value<T>, CallError> {
    let registry = Registry::new(rows());
    let row = registry.get(name).unwrap();
    let (args, _) = bind_arguments(row, Given { positional, named }, |_| Class::Any)?;
    T::call(row, &args, &Context::default())
}

fn numbers<T: Real>(all: &[f64]) -> Value<T> {
    Value::list(all.iter().map(|&x| Value::Number(T::from(x))))
}

/// A wavy row, its weights and its knots.
fn row() -> (Vec<Vec3<f64>>, Vec<f64>, Vec<f64>) {
    let mut random = Lcg::new(4);
    let points = (0..12)
        .map(|i| {
            let t = f64::from(i) / 11.0;
            Vec3::of(3.0 * t, (2.0 * t).sin() + 0.02 * random.centred(), 0.3 * t * t + 1.0)
        })
        .collect();
    let weights = (0..12).map(|i| 1.0 + 0.4 * f64::from(i % 3)).collect();
    let inner = (1..=8).map(|k| (f64::from(k) / 9.0).powf(1.3));
    let knots = [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect();
    (points, weights, knots)
}

fn words<T: Real>(weights: &[f64], knots: &[f64]) -> Named<T> {
    vec![("as", Value::text("control")), ("weights", numbers(weights)), ("knots", numbers(knots))]
}

fn curve_at<T: Scalar>(points: &[Vec3<T>], tolerance: T, named: Named<T>) -> Vec3<T> {
    let list = Value::list(points.iter().map(|&p| Value::Vector(p)));
    match call("FairCurve", vec![list, Value::Number(tolerance)], named) {
        Ok(Value::Curve(c)) => c.jet(T::from(0.37), Order::Zero)[0],
        other => panic!("{other:?}"),
    }
}

#[test]
fn rational_curves_stay_within_the_tolerance_and_have_derivatives() {
    let (points, weights, knots) = row();
    for measure in ["second", "third", "bending"] {
        let named = |w: &[f64]| -> Named<f64> {
            words(w, &knots).into_iter().chain([("measure", Value::text(measure))]).collect()
        };
        let before = curve_at(&points, 0.0, named(&weights));
        let after = curve_at(&points, 0.01, named(&weights));
        assert!((1e-5..=0.01).contains(&before.distance(after)), "{measure}");
        // Equal weights make it polynomial.
        let plain: Named<f64> = vec![
            ("as", Value::text("control")),
            ("knots", numbers(&knots)),
            ("measure", Value::text(measure)),
        ];
        let equal = curve_at(&points, 0.01, named(&[2.0; 12]));
        assert!(equal.distance(curve_at(&points, 0.01, plain)) < 1e-9, "{measure}");
        let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
        dual[4].y = Dual4::seeded(points[4].y, 0);
        let with: Named<Dual4> = words(&weights, &knots)
            .into_iter()
            .chain([("measure", Value::text(measure))])
            .collect();
        let exact = curve_at(&dual, Dual4::seeded(0.01, 1), with);
        assert!(exact.re().bits_eq(after));
        let h = 1e-7;
        let moved = |by: f64| {
            let mut p = points.clone();
            p[4].y += by;
            curve_at(&p, 0.01, named(&weights))
        };
        let by_point = (moved(h) - moved(-h)) * (0.5 / h);
        let wide = |by: f64| curve_at(&points, 0.01 + by, named(&weights));
        let by_tolerance = (wide(h) - wide(-h)) * (0.5 / h);
        for (k, wanted) in [(0, by_point), (1, by_tolerance)] {
            let got = exact.map(|x| x.eps[k]);
            assert!(
                got.distance(wanted) < 1e-5 * (1.0 + wanted.norm()),
                "{measure} {k} {got:?} {wanted:?}"
            );
        }
    }
}

#[test]
fn rational_surfaces_have_derivatives() {
    let mut random = Lcg::new(6);
    let points: Vec<Vec3<f64>> = (0..48)
        .map(|k| {
            let (x, y) = (f64::from(k / 6), f64::from(k % 6));
            Vec3::of(x, y, 0.1 * x * y + 0.05 * random.centred())
        })
        .collect();
    let weights: Vec<f64> = (0..48).map(|k| 1.0 + 0.1 * f64::from(k % 5)).collect();
    let knots = [0.0, 0.0, 0.0, 0.0, 0.3, 0.7, 1.0, 1.0, 1.0, 1.0];
    fn at<T: Scalar>(points: Vec<Vec3<T>>, weights: &[f64], knots: &[f64]) -> Vec3<T> {
        let items = weights.iter().map(|&w| T::from(w)).collect();
        let named = vec![
            ("as", Value::text("control")),
            ("weights", Value::Numbers(Arc::new(Array { shape: ArrayShape::Grid(8, 6), items }))),
            ("knots_v", numbers(knots)),
        ];
        let grid = Value::Vectors(Arc::new(Vectors::grid(8, 6, points)));
        match call("FairSurf", vec![grid, Value::Number(T::from(0.02))], named) {
            Ok(Value::Surface(s)) => s.jet(T::from(0.4), T::from(0.55), Order::Zero).p,
            other => panic!("{other:?}"),
        }
    }
    let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
    dual[20].z = Dual4::seeded(points[20].z, 0);
    let exact = at(dual, &weights, &knots);
    assert!(exact.re().bits_eq(at(points.clone(), &weights, &knots)));
    let h = 1e-7;
    let moved = |by: f64| {
        let mut p = points.clone();
        p[20].z += by;
        at(p, &weights, &knots)
    };
    let difference = (moved(h) - moved(-h)) * (0.5 / h);
    let got = exact.map(|x| x.eps[0]);
    assert!(got.distance(difference) < 1e-5, "{got:?} {difference:?}");
}

#[test]
fn wrong_weights_and_knots_are_refused() {
    let (points, weights, knots) = row();
    let refused = |named: Named<f64>| {
        let list = Value::list(points.iter().map(|&p| Value::Vector(p)));
        let fault = call("FairCurve", vec![list, Value::Number(0.01)], named).unwrap_err();
        (fault.id, fault.field())
    };
    let control = || ("as", Value::text("control"));
    let points_move = || ("as", Value::text("points"));
    let own = vec![points_move(), ("weights", numbers(&weights))];
    assert_eq!(refused(own), ("not-control", Some(10)));
    let own = vec![points_move(), ("knots", numbers(&knots))];
    assert_eq!(refused(own), ("not-control", Some(11)));
    let some = |w: &[f64]| refused(vec![control(), ("weights", numbers(w))]);
    assert_eq!(some(&weights[1..]), ("bad-weight", Some(10)));
    let mut zero = weights.clone();
    zero[3] = 0.0;
    assert_eq!(some(&zero), ("bad-weight", Some(10)));
    let short = vec![control(), ("weights", numbers(&weights)), ("mode", Value::text("slow"))];
    assert_eq!(refused(short), ("unknown-name", Some(6)));
    let some = |k: &[f64]| refused(vec![control(), ("knots", numbers(k))]);
    assert_eq!(some(&knots[1..]), ("bad-knots", Some(11)));
    let mut falling = knots.clone();
    falling.swap(5, 6);
    assert_eq!(some(&falling), ("bad-knots", Some(11)));
    let closed = vec![control(), ("knots", numbers(&knots)), ("closed", Value::Number(1.0))];
    assert_eq!(refused(closed), ("bad-knots", Some(11)));
}
