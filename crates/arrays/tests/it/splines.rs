//! Splines of the language against closed forms and the figures of the array language.

use crate::common::*;
use moldloft_num::Vec3;
use moldloft_registry::{Scalar, Value};
use std::f64::consts::{FRAC_PI_2, PI};

fn distc(pcurve: &Value<f64>, fa: &[f64]) -> Vec<Vec3> {
    points(&ok("distc", &[pcurve.clone(), farray(fa)]))
}

fn makecc(points: &[[f64; 3]], words: &[&str]) -> Value<f64> {
    let mut args = vec![curve(points)];
    args.extend(words.iter().map(|w| text(w)));
    ok("makecc", &args)
}

/// The outer profile of the missile's second program, before it is redistributed: 45 points of a
/// quarter circle from the upstream axis, then 16 more along a line.
fn outer_profile() -> (Vec<[f64; 3]>, f64, f64) {
    let base = 6.9375f64.sqrt() + 7.5;
    let radius = 1.2 * base;
    let mut all: Vec<[f64; 3]> = (0..45)
        .map(|k| {
            let a = PI - FRAC_PI_2 * f64::from(k) / 44.0;
            [radius * libm::cos(a), radius * libm::sin(a), 0.0]
        })
        .collect();
    (all[0][1], all[44][0]) = (0.0, all[44][0]);
    let from = all[44][0];
    for k in 1..16 {
        let share = f64::from(k) / 15.0;
        all.push([from + share * (base - from), radius, 0.0]);
    }
    (all, radius, base)
}

fn profile_spacings() -> Vec<f64> {
    numbers(&ok("d_tanh", &[0.0, 1.0, 0.07, 0.01, 60.0].map(number)))
}

/// True positions at the fraction `s` of the length of the quarter circle and the line.
fn exact(share: f64, radius: f64, base: f64) -> Vec3 {
    let s = share * (radius * FRAC_PI_2 + base);
    if s < radius * FRAC_PI_2 {
        let a = PI - s / radius;
        return Vec3::of(radius * a.cos(), radius * a.sin(), 0.0);
    }
    Vec3::of(s - radius * FRAC_PI_2, radius, 0.0)
}

#[test]
fn the_outer_profile_of_the_second_program() {
    let (profile, radius, base) = outer_profile();
    assert_eq!(profile.len(), 60);
    close(radius, 12.160696125855821, 1e-14);
    let fa = profile_spacings();
    let plain = distc(&makecc(&profile, &["quadratic", "arc"]), &fa);
    for (index, x, y) in [
        (2, -12.0104531, Some(1.9056613)),
        (10, -7.1571302, Some(9.8314809)),
        (20, -1.7319379, Some(12.0367321)),
        (30, 1.9585845, Some(12.1607056)),
        (40, 4.8168312, None),
        (50, 7.4117200, None),
        (59, 9.8443174, None),
    ] {
        // The grid cuts digits off rather than rounding them.
        close(plain[index - 1].x, x, 1.01e-7);
        if let Some(y) = y {
            close(plain[index - 1].y, y, 1.01e-7);
        }
    }
    close(plain[0].distance(plain[1]), 1.91157, 1e-5);
    close(plain[58].distance(plain[59]), 0.28960, 1e-5);
    assert_eq!(plain.iter().filter(|p| p.x < 0.0).count(), 24);
    let ends = [plain[0], plain[59]].map(|p| p.to_array());
    assert_eq!(ends, [profile[0], profile[59]]);
    let natural = distc(&makecc(&profile, &["natural", "arc"]), &fa);
    close(natural[1].x, -12.0104492, 1.01e-7);
    let deviation = |points: &[Vec3]| {
        let each = points.iter().zip(&fa).map(|(p, s)| p.distance(exact(*s, radius, base)));
        each.fold(0.0, f64::max)
    };
    close(deviation(&plain), 8.0e-4, 0.05e-4);
    // The true arc length on the same spline, and on splines that end where the curvature jumps.
    close(deviation(&distc(&makecc(&profile, &["quadratic", "arclen"]), &fa)), 7.2e-4, 0.05e-4);
    let split = distc(&makecc(&profile, &["quadratic", "arclen+breaks"]), &fa);
    let best = deviation(&split);
    assert!((1.5e-7..2.5e-7).contains(&best), "{best:e}");
    let given = ok(
        "makecc",
        &[
            curve(&profile),
            text("quadratic"),
            text("arclen+breaks"),
            Value::Unset,
            Value::Unset,
            farray(&[45.0]),
        ],
    );
    assert_eq!(distc(&given, &fa), split);
    let length = numbers(&ok("lengthc", &[makecc(&profile, &["quadratic", "arclen+breaks"])]))[0];
    close(length, 29.235890243976, 1e-6);
}

/// Upper half of a 0012 section, from the nose.
fn naca0012(n: usize) -> Vec<[f64; 3]> {
    let at = |k: usize| {
        let x = 0.5 * (1.0 - libm::cos(PI * k as f64 / (n - 1) as f64));
        let y = 0.6
            * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
                - 0.1015 * x.powi(4));
        [x, y, 0.0]
    };
    (0..n).map(at).collect()
}

#[test]
fn the_fin_root_of_the_third_program() {
    let fa = numbers(&ok("d_tanh", &[0.0, 1.0, 0.05, 0.0, 20.0].map(number)));
    let figures = [
        (2, 0.0371249903, 0.0312349460),
        (3, 0.0869137065, 0.0444619381),
        (5, 0.1903538252, 0.0567834956),
        (10, 0.4562811355, 0.0554803827),
        (15, 0.7272183074, 0.0339398599),
        (19, 0.9454560075, 0.0086640125),
        (20, 1.0, 0.00126),
    ];
    let root = distc(&makecc(&naca0012(200), &["quadratic", "arc"]), &fa);
    for (index, x, y) in figures {
        close(root[index - 1].x, x, 4.9e-6);
        close(root[index - 1].y, y, 4.9e-6);
    }
    // True arc length of a spline through many points: exact to the digits given.
    let root = distc(&makecc(&naca0012(4000), &["quadratic", "arclen"]), &fa);
    for (index, x, y) in figures {
        close(root[index - 1].x, x, 2e-9);
        close(root[index - 1].y, y, 2e-9);
    }
    let length = numbers(&ok("lengthc", &[makecc(&naca0012(4000), &["quadratic", "arclen"])]))[0];
    close(length, 1.019635816521586, 2e-9);
}

#[test]
fn cubics_and_parabolas_are_reproduced() {
    // By index, a cubic in the index with its slopes; and a parabola with quadratic ends.
    let cubic = |x: f64| [x, 0.5 * x - x * x + 0.1 * x.powi(3), 1.0 - x.powi(3)];
    let knots: Vec<[f64; 3]> = (0..7).map(|k| cubic(f64::from(k))).collect();
    let slope = |x: f64| Value::Vector(Vec3::of(1.0, 0.5 - 2.0 * x + 0.3 * x * x, -3.0 * x * x));
    let p =
        ok("makecc", &[curve(&knots), text("specified"), text("index"), slope(0.0), slope(6.0)]);
    for u in [0.03, 0.5, 0.77, 0.99] {
        let q = points(&ok("evalc", &[p.clone(), number(u)]))[0];
        assert!(q.distance(Vec3::from(cubic(6.0 * u))) < 1e-14 * 216.0, "{u}");
    }
    let parabola = |x: f64| [x, 2.0 * x * x - x, 0.0];
    let knots: Vec<[f64; 3]> = (0..5).map(|k| parabola(f64::from(k))).collect();
    let p = makecc(&knots, &["quadratic", "index"]);
    let q = points(&ok("evalc", &[p.clone(), farray(&[0.1, 0.6])]));
    assert!(q[0].distance(Vec3::from(parabola(0.4))) < 1e-14);
    let bend = points(&ok("derivc", &[p, number(0.3), number(2.0)]))[0];
    assert!((bend - Vec3::of(0.0, 64.0, 0.0)).norm() < 1e-12);
    // Along the arc: the tangent of a straight line is its direction.
    let line = [[0.0; 3], [3.0, 4.0, 0.0], [6.0, 8.0, 0.0], [9.0, 12.0, 0.0]];
    let t = Value::Vector(Vec3::of(0.6, 0.8, 0.0));
    let p = ok("makecc", &[curve(&line), text("clamped"), text("arc"), t.clone(), t]);
    let d = points(&ok("derivc", &[p, farray(&[0.0, 0.4, 1.0])]));
    assert!(d.iter().all(|d| d.distance(Vec3::of(9.0, 12.0, 0.0)) < 1e-12));
}

#[test]
fn quarter_circles_converge_with_the_fourth_power() {
    let error = |n: usize, ends: &str, basis: &str| {
        let at = |k: usize| {
            let a = FRAC_PI_2 * k as f64 / (n - 1) as f64;
            [a.cos(), a.sin(), 0.0]
        };
        let p = makecc(&(0..n).map(at).collect::<Vec<_>>(), &[ends, basis]);
        let fa: Vec<f64> = (0..=400).map(|k| f64::from(k) / 400.0).collect();
        // The middle, where the ends do not matter.
        distc(&p, &fa)[150..250].iter().fold(0.0f64, |m, p| m.max((p.norm() - 1.0).abs()))
    };
    for basis in ["arc", "index", "centripetal", "arclen"] {
        let (coarse, fine) = (error(9, "notaknot", basis), error(17, "notaknot", basis));
        let rate = (coarse / fine).log2();
        assert!((3.5..6.5).contains(&rate), "{basis}: {coarse:e} {fine:e} {rate}");
        assert!(fine < 1e-6);
    }
}

#[test]
fn knots_and_ends_are_the_points_to_the_bit() {
    let wave: Vec<[f64; 3]> = (0..12)
        .map(|k| [0.3 * f64::from(k), (0.7 * f64::from(k)).sin(), 0.1 / (1.0 + f64::from(k))])
        .collect();
    let index: Vec<f64> = (0..12).map(|k| f64::from(k) / 11.0).collect();
    for ends in ["natural", "quadratic", "notaknot", "bessel", "natural,quadratic"] {
        let through = distc(&makecc(&wave, &[ends, "index"]), &index);
        assert!(through.iter().zip(&wave).all(|(p, q)| p.to_array() == *q), "{ends}");
        for basis in ["arc", "centripetal", "arclen", "arclen+breaks", "arc+breaks"] {
            let p = distc(&makecc(&wave, &[ends, basis]), &[0.0, 1.0]);
            assert_eq!([p[0].to_array(), p[1].to_array()], [wave[0], wave[11]], "{ends} {basis}");
        }
    }
    let straight = ok("makelc", &[curve(&wave), text("index")]);
    assert!(distc(&straight, &index).iter().zip(&wave).all(|(p, q)| p.to_array() == *q));
}

#[test]
fn periodic_splines_close_smoothly() {
    let ring: Vec<[f64; 3]> = (0..=16)
        .map(|k| {
            let a = PI * f64::from(k % 16) / 8.0;
            [a.cos(), 2.0 * a.sin(), 0.0]
        })
        .collect();
    let p = makecc(&ring, &["periodic", "arc"]);
    for k in 0..3 {
        let ends = points(&ok("derivc", &[p.clone(), farray(&[0.0, 1.0]), number(f64::from(k))]));
        assert!(ends[0].distance(ends[1]) < 1e-11, "{k}");
    }
    let even = makecc(&ring, &["periodic", "arclen"]);
    let speeds = points(&ok("derivc", &[even, farray(&[0.0, 0.21, 0.5, 0.9])]));
    assert!(speeds.iter().all(|d| (d.norm() - speeds[0].norm()).abs() < 1e-12));
    let mut open = ring.clone();
    open[16][0] += 0.1;
    assert_eq!(refused("makecc", &[curve(&open), text("periodic")]), ("not-closed", Some(1), None));
}

#[test]
fn curvature_of_splines() {
    let at = |k: i32| {
        let a = 0.05 * f64::from(k);
        [2.0 * a.cos(), 2.0 * a.sin(), 0.0]
    };
    let p = makecc(&(0..40).map(at).collect::<Vec<_>>(), &["notaknot", "arclen"]);
    for k in numbers(&ok("curvc", &[p, farray(&[0.31, 0.5, 0.7])])) {
        close(k, 0.5, 1e-4);
    }
}

/// A surface that is not a product of curves.
fn wavy(i: usize, j: usize) -> [f64; 3] {
    let (u, v) = (i as f64 / 6.0, j as f64 / 4.0);
    [u + 0.1 * v * v, v * (1.0 + 0.3 * u), (2.0 * u).sin() * v]
}

#[test]
fn surfaces_pass_through_their_points() {
    let s = surface(7, 5, wavy);
    let u: Vec<f64> = (0..7).map(|k| f64::from(k) / 6.0).collect();
    let v: Vec<f64> = (0..5).map(|k| f64::from(k) / 4.0).collect();
    for (name, words) in [("makecs", vec!["natural", "index"]), ("makels", vec!["index"])] {
        let mut args = vec![s.clone()];
        args.extend(words.iter().map(|w| text(w)));
        let p = ok(name, &args);
        let back = ok("dists", &[p.clone(), farray(&u), farray(&v)]);
        assert_eq!(points(&back), points(&s), "{name}");
        // Parameters that are arrays give the same.
        let grid = |f: &dyn Fn(usize) -> f64| {
            let items = (0..35).map(f).collect();
            Value::Numbers(std::sync::Arc::new(moldloft_registry::Array::grid(7, 5, items)))
        };
        let (us, vs) = (grid(&|k| u[k / 5]), grid(&|k| v[k % 5]));
        assert_eq!(points(&ok("dists", &[p.clone(), us, vs])), points(&s));
        let one = points(&ok("evals", &[p, number(0.25), number(0.5)]))[0];
        assert!(one.distance(Vec3::of(0.275, 0.5375, 0.2397)) < 5e-3, "{one:?}");
    }
    // A nose: the first line is one point; arcs are averaged over the others.
    let nose = |i: usize, j: usize| {
        let (r, a) = (0.2 * i as f64, 0.5 * j as f64);
        [i as f64, r * a.cos(), r * a.sin()]
    };
    let p = ok("makecs", &[surface(6, 5, nose), text("quadratic"), text("arc")]);
    let tip = points(&ok("evals", &[p, farray(&[0.0, 0.0]), farray(&[0.1, 0.9])]));
    assert!(tip.iter().all(|p| p.norm() < 1e-15));
}

fn pipeline<T: Scalar>(args: &[Value<T>], words: &[&str], ask: &str) -> Value<T> {
    let mut made = vec![args[0].clone()];
    made.extend(words.iter().map(|w| Value::text(w)));
    made.extend(args[2..].iter().cloned());
    let p = call("makecc", &made).unwrap();
    call(ask, &[p, args[1].clone()]).unwrap()
}

#[test]
fn derivatives_by_points_parameters_and_tangents() {
    let wave: Vec<[f64; 3]> = (0..9)
        .map(|k| [0.3 * f64::from(k * k + k), (0.7 * f64::from(k)).sin(), 0.1 * f64::from(k)])
        .collect();
    let fa = farray(&[0.1, 0.37, 0.52, 0.93]);
    for basis in ["arc", "index", "centripetal", "arclen", "arclen+breaks", "arc+breaks"] {
        for ends in ["natural", "quadratic", "notaknot"] {
            for ask in ["distc", "derivc", "curvc"] {
                let words = [ends, basis];
                law(
                    &[curve(&wave), fa.clone()],
                    &[0, 1],
                    2e-7,
                    |a| pipeline(a, &words, ask),
                    |a| pipeline(a, &words, ask),
                );
            }
        }
    }
    let t = |x: f64| Value::Vector(Vec3::of(x, 0.4, -0.2));
    law(
        &[curve(&wave), fa, t(1.0), t(0.3)],
        &[0, 1, 2, 3],
        1e-7,
        |a| pipeline(a, &["specified", "arc"], "evalc"),
        |a| pipeline(a, &["specified", "arc"], "evalc"),
    );
}

#[test]
fn derivatives_of_surfaces() {
    fn at<T: Scalar>(args: &[Value<T>]) -> Value<T> {
        let p = call("makecs", &[args[0].clone(), Value::text("natural"), Value::text("arc")]);
        call("dists", &[p.unwrap(), args[1].clone(), args[2].clone()]).unwrap()
    }
    let (u, v) = (farray(&[0.2, 0.5]), farray(&[0.1, 0.7, 0.8]));
    law(&[surface(7, 5, wavy), u, v], &[0, 1, 2], 1e-7, at, at);
}

#[test]
fn faults_say_where() {
    let c = curve(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    assert_eq!(
        refused("makecc", std::slice::from_ref(&c)),
        ("coincident-points", Some(0), Some(2))
    );
    let good = curve(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [2.0, 1.0, 0.0]]);
    let with = |words: &[Value<f64>]| {
        let mut args = vec![good.clone()];
        args.extend(words.iter().cloned());
        refused("makecc", &args)
    };
    assert_eq!(with(&[text("cubic")]), ("unknown-word", Some(1), None));
    assert_eq!(with(&[text("natural,periodic")]), ("unknown-word", Some(1), None));
    assert_eq!(with(&[text("natural"), text("length")]), ("unknown-word", Some(2), None));
    assert_eq!(with(&[text("specified"), text("arc")]), ("missing-argument", Some(3), None));
    let t = Value::Vector(Vec3::of(1.0, 0.0, 0.0));
    let one = [text("specified,natural"), text("arc"), t.clone(), t.clone()];
    assert_eq!(with(&one), ("unused-argument", Some(4), None));
    let breaks = [text("natural"), text("arc"), Value::Unset, Value::Unset, farray(&[2.0])];
    assert_eq!(with(&breaks), ("unused-argument", Some(5), None));
    let breaks =
        [text("natural"), text("arclen+breaks"), Value::Unset, Value::Unset, farray(&[4.0])];
    assert_eq!(with(&breaks), ("out-of-range", Some(5), Some(0)));
    assert_eq!(refused("makecc", &[surface(3, 3, wavy)]).0, "wrong-shape");
    assert_eq!(refused("makecs", std::slice::from_ref(&good)).0, "wrong-shape");
    assert_eq!(refused("makecc", &[curve(&[[0.0; 3]])]), ("too-few-items", Some(0), None));
    let p = ok("makecc", std::slice::from_ref(&good));
    assert_eq!(
        refused("distc", &[p.clone(), farray(&[0.0, 1.5])]),
        ("out-of-range", Some(1), Some(1))
    );
    // An array instead of a pcurve, and vice versa: the fault says how to fix it.
    let fault = call("distc", &[good, farray(&[0.0])]).unwrap_err();
    assert_eq!((fault.id, fault.help.is_empty()), ("wrong-class", false));
    let fault = call("makecc", &[p]).unwrap_err();
    assert_eq!((fault.id, fault.help.is_empty()), ("wrong-class", false));
    let s = ok("makels", &[surface(3, 3, wavy)]);
    let rows = [s, number(0.1), farray(&[0.2])];
    assert_eq!(refused("evals", &rows), ("shapes-differ", Some(2), None));
    let flat = surface(3, 3, |i, _| [i as f64, 0.0, 0.0]);
    assert_eq!(refused("makels", &[flat]).0, "coincident-points");
    let doubled = [[1.0, 0.0], [0.5, 0.1], [0.0, 0.0], [0.0, 0.0], [0.5, -0.1], [1.0, 0.0]];
    let doubled = curve(&doubled.map(|[x, y]| [x, y, 0.0]));
    let heights = farray(&[0.0, 0.01, 0.03]);
    for name in ["o_grid", "hyperbolic", "tangents"] {
        let args = [doubled.clone(), heights.clone()];
        let args = &args[..if name == "tangents" { 1 } else { 2 }];
        assert_eq!(refused(name, args), ("coincident-points", Some(0), Some(3)), "{name}");
    }
    assert_eq!(
        refused("makels", &[surface(3, 3, wavy), text("arclen")]),
        ("unknown-word", Some(1), None)
    );
}

#[test]
fn inverse_questions_of_distributions() {
    let growth = |ds: [f64; 2], n: f64| {
        let s = ok("d_tanhx", &[0.0, 1.0, ds[0], ds[1], n].map(number));
        numbers(&ok("growth", &[s]))[0]
    };
    for (ds, most) in
        [([0.001, 0.02], 1.15), ([0.07, 0.01], 1.2), ([1e-5, 0.0], 1.25), ([0.0, 0.03], 1.02)]
    {
        let n = numbers(&ok("count_for", &[1.0, ds[0], ds[1], most].map(number)))[0];
        assert!(growth(ds, n) <= most && growth(ds, n - 1.0) > most, "{ds:?} {n}");
    }
    let none = refused("count_for", &[1.0, 0.4, 1e-4, 1.0001].map(number));
    assert_eq!(none, ("no-distribution", Some(3), None));
    for (g, n) in [(1.1085107373725, 25.0), (1.0, 25.0), (1.02, 200.0)] {
        let ds = numbers(&ok("first_for", &[1.0, g, n].map(number)))[0];
        let s = ok("geometric", &[0.0, 1.0, ds, n].map(number));
        close(numbers(&ok("growth", &[s]))[0], g, 1e-10);
        if n == 25.0 && g > 1.0 {
            close(ds, 0.01, 1e-14);
        }
    }
    let c = curve(&[[0.0; 3], [3.0, 4.0, 0.0], [3.0, 4.0, 2.0]]);
    let cells = [ok("first_cell", std::slice::from_ref(&c)), ok("last_cell", &[c])];
    assert_eq!(cells.map(|c| numbers(&c)[0]), [5.0, 2.0]);
    assert_eq!(refused("growth", &[number(3.0)]).0, "wrong-class");
}

#[test]
fn derivatives_of_distributions() {
    for (name, args) in [
        ("geometric", vec![0.1, 1.2, 0.01]),
        ("geometric2", vec![0.1, 1.2, 0.01, 0.03]),
        ("d_sinh", vec![0.1, 1.2, 0.01, 0.0]),
        ("d_tanh", vec![0.1, 1.2, 0.07, 0.01]),
        ("d_tanhx", vec![0.1, 1.2, 0.07, 0.01]),
    ] {
        let mut active: Vec<usize> = (0..args.len()).collect();
        active.retain(|&k| args[k] != 0.0);
        let mut args: Vec<Value<f64>> = args.into_iter().map(number).collect();
        args.push(number(25.0));
        law(&args, &active, 2e-6, |a| call(name, a).unwrap(), |a| call(name, a).unwrap());
    }
}
