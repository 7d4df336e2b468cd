//! The kinds of nets and networks: common points, conditions, refusals.

use crate::fixtures::*;
use moldloft_fair::rows;
use moldloft_num::trace::{Key, Trace};
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{
    CallError, Class, Context, CurveRef, Given, Point, Registry, Scalar, Value, Vectors,
    bind_arguments,
};
use std::sync::Arc;

fn call<T: Scalar>(
    name: &str,
    positional: Vec<Value<T>>,
    named: Vec<(&str, Value<T>)>,
) -> Result<Value<T>, CallError> {
    let registry = Registry::new(rows());
    let row = registry.get(name).unwrap();
    let (args, _) = bind_arguments(row, Given { positional, named }, |_| Class::Any)?;
    T::call(row, &args, &Context::default())
}

/// Point objects of a hull: station i, waterline j has the key 7 i + j.
fn hull() -> Vec<Vec3<f64>> {
    let mut random = Lcg::new(3);
    (0..9 * 7)
        .map(|k| {
            let (x, z) = (f64::from(k / 7) / 4.0 - 1.0, f64::from(k % 7) / 6.0);
            let y = (1.0 - x * x) * (0.3 + z - 0.4 * z * z) + 4e-3 * random.centred();
            Vec3::of(x, y, z)
        })
        .collect()
}

fn object<T: Real>(points: &[Vec3<T>], k: usize) -> Value<T> {
    let mut point = Point::free(points[k]);
    point.key = Some(Key(k as u32));
    Value::Point(Box::new(point))
}

/// Stations, then waterlines.
fn lists<T: Real>(points: &[Vec3<T>]) -> Value<T> {
    let stations = (0..9).map(|i| Value::list((0..7).map(|j| object(points, 7 * i + j))));
    let lines = (0..7).map(|j| Value::list((0..9).map(|i| object(points, 7 * i + j))));
    Value::list(stations.chain(lines).collect::<Vec<_>>())
}

fn curves<T: Real>(value: Value<T>) -> Vec<CurveRef<T>> {
    let Value::List(items) = value else { panic!("{value:?}") };
    items
        .iter()
        .map(|v| match v {
            Value::Curve(c) => c.clone(),
            other => panic!("{other:?}"),
        })
        .collect()
}

fn number<T: Real>(x: f64) -> Value<T> {
    Value::Number(T::from(x))
}

#[test]
fn curves_still_meet_in_their_points() {
    let points = hull();
    // By index, so that parameters of the points are known.
    let index = ("spacing", Value::text("index"));
    let made = call("FairNet", vec![lists(&points), number(2e-3)], vec![index]).unwrap();
    let net = curves(made);
    assert_eq!(net.len(), 16);
    let at = |c: &CurveRef<f64>, t: f64| c.jet(t, Order::Zero)[0];
    for i in 0..9 {
        for j in 0..7 {
            let on_station = at(&net[i], j as f64 / 6.0);
            let on_line = at(&net[9 + j], i as f64 / 8.0);
            assert!((on_station - on_line).norm() < 1e-13);
            assert!((on_station - points[7 * i + j]).norm() <= 2e-3 * (1.0 + 1e-12));
        }
    }
    // Corners stay, and only they are still ends at point objects.
    for (i, j) in [(0, 0), (0, 6), (8, 0), (8, 6)] {
        assert!((at(&net[i], j as f64 / 6.0) - points[7 * i + j]).norm() < 1e-14);
    }
    assert_eq!(net[0].trace(), Trace::Own([Some(Key(0)), Some(Key(6))]));
    assert_eq!(net[3].trace(), Trace::Own([None, None]));
    let kept = vec![("kept_ends", Value::text("ends"))];
    let net = curves(call("FairNet", vec![lists(&points), number(2e-3)], kept).unwrap());
    assert_eq!(net[3].trace(), Trace::Own([Some(Key(21)), Some(Key(27))]));
}

#[test]
fn one_direction_breaks_and_one_curve_of_a_network() {
    let points = hull();
    let named = vec![
        ("along", Value::Vector(Vec3::of(0.0, 2.0, 0.0))),
        ("breaks", Value::list([object(&points, 7 * 4 + 3)])),
        ("spacing", Value::text("index")),
    ];
    let value = call("FairNet", vec![lists(&points), number(2e-3)], named).unwrap();
    let net = curves(value.clone());
    for (i, station) in net.iter().take(9).enumerate() {
        for j in 0..7 {
            let p = station.jet(j as f64 / 6.0, Order::Zero)[0];
            let q = points[7 * i + j];
            assert!((p.x - q.x).abs() < 1e-14 && (p.z - q.z).abs() < 1e-14);
        }
    }
    assert!((net[4].jet(0.5, Order::Zero)[0] - points[7 * 4 + 3]).norm() < 1e-14);
    // The station has a corner there.
    let sides = [0.5 - 1e-9, 0.5 + 1e-9].map(|t| net[4].jet(t, Order::First)[1]);
    assert!((sides[0] - sides[1]).norm() > 1e-4);
    let one = call("NetCurve", vec![value.clone(), number(5.0)], vec![]).unwrap();
    let Value::Curve(one) = one else { panic!() };
    assert!(one.jet(0.3, Order::Zero)[0].bits_eq(net[4].jet(0.3, Order::Zero)[0]));
    let fault = call::<f64>("NetCurve", vec![value, number(17.0)], vec![]).unwrap_err();
    assert_eq!((fault.id, fault.field()), ("out-of-range", Some(1)));
}

#[test]
fn a_list_that_ends_with_its_first_point_is_closed() {
    let ring: Vec<Vec3<f64>> = (0..12)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 12.0)
        .map(|a| Vec3::of(a.cos(), a.sin(), 0.0))
        .collect();
    let list = Value::list((0..13).map(|k| object(&ring, k % 12)));
    let net = curves(call("FairNet", vec![Value::list([list]), number(1e-3)], vec![]).unwrap());
    let [a, b] = [0.0, 1.0].map(|t| net[0].jet(t, Order::Second));
    assert!((0..3).all(|k| (a[k] - b[k]).norm() < 1e-9 * (1.0 + a[k].norm())));
}

#[test]
fn derivatives_of_networks_and_of_passes() {
    let points = hull();
    let k = 7 * 4 + 2;
    let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
    dual[k].y = Dual4::seeded(points[k].y, 0);
    let tolerance = |by: f64| number(2e-3 + by);
    let seeded = Value::Number(Dual4::seeded(2e-3, 1));
    let named = || vec![("goal", Value::text("budget"))];
    let exact = curves(call("FairNet", vec![lists(&dual), seeded], named()).unwrap());
    let plain = |points: &[Vec3<f64>], by: f64| {
        let budget = vec![("goal", Value::text("budget"))];
        let net = curves(call("FairNet", vec![lists(points), tolerance(by)], budget).unwrap());
        net[3].jet(0.4, Order::Zero)[0]
    };
    let got = exact[3].jet(Dual4::from(0.4), Order::Zero)[0];
    assert!(got.re().bits_eq(plain(&points, 0.0)));
    let h = 1e-7;
    let moved = |by: f64| {
        let mut p = points.clone();
        p[k].y += by;
        plain(&p, 0.0)
    };
    let by_point = (moved(h) - moved(-h)) * (0.5 / h);
    let by_tolerance = (plain(&points, h) - plain(&points, -h)) * (0.5 / h);
    for (direction, wanted) in [(0, by_point), (1, by_tolerance)] {
        let off = got.map(|x| x.eps[direction]) - wanted;
        assert!(off.norm() < 1e-6 * (1.0 + wanted.norm()), "{direction}: {off:?} {wanted:?}");
    }

    // Passes of a surface: which knots are chosen stays, where they go follows.
    let named = || vec![("mode", Value::text("faithful")), ("passes", Value::Number(2.0))];
    let surface = |points: &[Vec3<f64>]| {
        let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points.to_vec())));
        let value = call("FairSurf", vec![grid, number(2e-3)], named()).unwrap();
        let Value::Surface(s) = value else { panic!() };
        s.jet(0.43, 0.61, Order::Zero).p
    };
    let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, dual)));
    let words = vec![("mode", Value::text("faithful")), ("passes", number(2.0))];
    let Value::Surface(s) = call("FairSurf", vec![grid, number(2e-3)], words).unwrap() else {
        panic!()
    };
    let got = s.jet(Dual4::from(0.43), Dual4::from(0.61), Order::Zero).p;
    assert!(got.re().bits_eq(surface(&points)));
    let moved = |by: f64| {
        let mut p = points.clone();
        p[k].y += by;
        surface(&p)
    };
    let centred = (moved(1e-9) - moved(-1e-9)) * 0.5e9;
    let off = (got.map(|x| x.eps[0]) - centred).norm();
    assert!(off < 1e-4 * (1.0 + centred.norm()), "{got:?} {centred:?}");
}

#[test]
fn knuckle_lines_stay_and_are_sharp() {
    let mut points = hull();
    for (k, p) in points.iter_mut().enumerate() {
        p.z += 0.3 * (k as f64 / 7.0).floor().max(4.0);
    }
    let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points.clone())));
    // By index, so that parameters of the points are known.
    let index = ("spacing", Value::text("index"));
    let named = vec![("breaks_u", Value::list([Value::Number(5.0)])), index];
    let Value::Surface(s) = call("FairSurf", vec![grid, number(2e-3)], named).unwrap() else {
        panic!()
    };
    for j in 0..7 {
        let p = s.jet(0.5, j as f64 / 6.0, Order::Zero).p;
        assert!((p - points[7 * 4 + j]).norm() < 1e-12, "{j} {p:?}");
    }
    let sides = [0.5 - 1e-9, 0.5 + 1e-9].map(|u| s.jet(u, 0.5, Order::First).u);
    assert!((sides[1] - sides[0]).norm() > 1.0, "{sides:?}");
    let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points)));
    let named = vec![("breaks_v", Value::list([Value::Number(8.0)]))];
    let fault = call::<f64>("FairSurf", vec![grid, number(2e-3)], named).unwrap_err();
    assert_eq!((fault.id, fault.field()), ("out-of-range", Some(6)));
}

/// Rims that keep curvature are those of the surface before, to the bit; corners alone are not.
#[test]
fn rims_keep_what_they_are_asked_to() {
    let points = hull();
    let make = |tolerance: f64, rims: Value<f64>, mode: &str| {
        let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points.clone())));
        let goal = ("goal", Value::text("fairest"));
        let named = vec![("rims", rims), ("mode", Value::text(mode)), goal];
        match call("FairSurf", vec![grid, number(tolerance)], named) {
            Ok(Value::Surface(s)) => s,
            other => panic!("{other:?}"),
        }
    };
    let before = make(0.0, Value::text("corners"), "optimum");
    // A point on each of the edges v = 0, u = 1, v = 1, u = 0, and the derivative across.
    let sides = |s: &moldloft_registry::SurfaceRef<f64>| {
        [(0.4, 0.0), (1.0, 0.4), (0.4, 1.0), (0.0, 0.4)].map(|(u, v)| {
            let j = s.jet(u, v, Order::Second);
            if v == 0.0 || v == 1.0 { [j.p, j.v, j.vv] } else { [j.p, j.u, j.uu] }
        })
    };
    for mode in ["optimum", "faithful"] {
        let before = make(0.0, Value::text("corners"), mode);
        let was = sides(&before);
        for (word, kept) in [("corners", 0), ("position", 1), ("tangent", 2), ("curvature", 3)] {
            let after = make(2e-2, Value::text(word), mode);
            let is = sides(&after);
            for (a, b) in is.iter().zip(&was) {
                for k in 0..3 {
                    assert_eq!(a[k].bits_eq(b[k]), k < kept, "{mode} {word} {k}");
                }
            }
            let inner = |s: &moldloft_registry::SurfaceRef<f64>| s.jet(0.5, 0.5, Order::Zero).p;
            assert!((inner(&after) - inner(&before)).norm() > 1e-5, "{mode} {word}");
        }
    }
    let was = sides(&before);
    let words = ["position", "corners", "corners", "curvature"].map(Value::text);
    let is = sides(&make(2e-2, Value::list(words), "optimum"));
    let same = |e: usize, k: usize| is[e][k].bits_eq(was[e][k]);
    assert!(same(0, 0) && !same(0, 1) && !same(1, 0) && !same(2, 0));
    assert!((0..3).all(|k| same(3, k)));
    for rims in [Value::text("loose"), Value::list([Value::text("position")]), number(1.0)] {
        let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points.clone())));
        let fault = call("FairSurf", vec![grid, number(0.1)], vec![("rims", rims)]).unwrap_err();
        assert_eq!(fault.field(), Some(9), "{fault:?}");
    }
}

/// The faithful mode of a network: within the tolerance, in one direction, with derivatives, and
/// other than the optimum.
#[test]
fn networks_can_be_faired_curve_by_curve() {
    let points = hull();
    let words = |up: bool| {
        let along = ("along", Value::Vector(Vec3::of(0.0, 1.0, 0.0)));
        let mode = vec![("mode", Value::text("faithful")), ("passes", Value::Number(2.0))];
        if up { mode.into_iter().chain([along]).collect() } else { mode }
    };
    for up in [false, true] {
        let make = |points: &[Vec3<f64>]| {
            curves(call("FairNet", vec![lists(points), number(2e-3)], words(up)).unwrap())
        };
        let net = make(&points);
        for i in 0..9 {
            for j in 0..7 {
                let (a, b) = (j as f64 / 6.0, i as f64 / 8.0);
                let p = net[i].jet(a, Order::Zero)[0];
                assert!((p - net[9 + j].jet(b, Order::Zero)[0]).norm() < 1e-12);
                let moved = p - points[7 * i + j];
                assert!(moved.norm() <= 2e-3 * (1.0 + 1e-9));
                assert!(!up || (moved.x.abs() < 1e-12 && moved.z.abs() < 1e-12));
            }
        }
        let best = curves(call("FairNet", vec![lists(&points), number(2e-3)], vec![]).unwrap());
        let at = |n: &[CurveRef<f64>]| n[4].jet(0.4, Order::Zero)[0];
        assert!((at(&net) - at(&best)).norm() > 1e-6);
        let k = 7 * 4 + 2;
        let mut dual: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
        dual[k].y = Dual4::seeded(points[k].y, 0);
        let mut named = vec![("mode", Value::text("faithful")), ("passes", number(2.0))];
        if up {
            named.push(("along", Value::Vector(Vec3::lifted(Vec3::of(0.0, 1.0, 0.0)))));
        }
        let exact = curves(call("FairNet", vec![lists(&dual), number(2e-3)], named).unwrap());
        let got = exact[4].jet(Dual4::from(0.4), Order::Zero)[0];
        assert!(got.re().bits_eq(at(&net)));
        let moved = |by: f64| {
            let mut p = points.clone();
            p[k].y += by;
            at(&make(&p))
        };
        let wanted = (moved(1e-9) - moved(-1e-9)) * 0.5e9;
        let off = (got.map(|x| x.eps[0]) - wanted).norm();
        assert!(off < 1e-4 * (1.0 + wanted.norm()), "{up} {got:?} {wanted:?}");
    }
}

#[test]
fn faults_of_networks_name_their_argument() {
    let points = hull();
    let fault = |curves: Value<f64>, named: Vec<(&str, Value<f64>)>| {
        let f = call("FairNet", vec![curves, number(2e-3)], named).unwrap_err();
        (f.id, f.field(), f.item())
    };
    let list = |keys: &[usize]| Value::list(keys.iter().map(|&k| object(&points, k)));
    let good = list(&[0, 1, 2, 3, 4]);
    let short = Value::list([good.clone(), list(&[0, 1, 2])]);
    assert_eq!(fault(short, vec![]), ("too-few-items", Some(0), Some(1)));
    let twice = Value::list([list(&[0, 1, 2, 1, 4])]);
    assert_eq!(fault(twice, vec![]), ("point-twice", Some(0), Some(0)));
    let stranger = vec![("breaks", list(&[60]))];
    assert_eq!(fault(Value::list([good.clone()]), stranger), ("not-a-parent", Some(3), Some(0)));
    let keep = vec![("kept_ends", Value::text("all"))];
    assert_eq!(fault(Value::list([good.clone()]), keep).0, "unknown-name");
    let along = vec![("along", Value::Vector(Vec3::zero()))];
    assert_eq!(fault(Value::list([good.clone()]), along), ("zero-direction", Some(5), None));
    let mode = vec![("mode", Value::text("slow"))];
    assert_eq!(fault(Value::list([good]), mode), ("unknown-name", Some(8), None));
}

/// An option that a method of a surface does not read is refused by its name.
#[test]
fn options_of_other_methods_are_refused() {
    let points = hull();
    let text = |word: &str| Value::text(word);
    let near = "is for surfaces near their points";
    let other = "is for another mode";
    let cases = [
        (vec![("passes", number(2.0))], "passes", other),
        (vec![("mode", text("sweeps")), ("passes", number(2.0))], "passes", other),
        (vec![("mode", text("sweeps")), ("share", number(0.3))], "share", near),
        (vec![("as", text("control")), ("share", number(0.3))], "share", near),
        (vec![("bound", text("curve")), ("spacing", text("centripetal"))], "spacing", near),
        (vec![("mode", text("faithful")), ("spacing", text("centripetal"))], "spacing", near),
    ];
    for (named, option, why) in cases {
        let grid = Value::Vectors(Arc::new(Vectors::grid(9, 7, points.clone())));
        let fault = call::<f64>("FairSurf", vec![grid, number(2e-3)], named).unwrap_err();
        assert_eq!(fault.message, format!("`{option}` {why}"), "{fault:?}");
    }
}
