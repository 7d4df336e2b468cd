//! Laws of interpolating splines, and the hull of Letcher and Shook 1995.

use crate::common::{Random, close, curve_laws, point_derivative_law};
use moldloft_num::{Curve, Dual, Order, Uni2, Vec3};
use moldloft_spline::{BSplineCurve, End, Ends, InterpolatingSpline, InterpolationError};

type Spline = InterpolatingSpline<f64>;

fn at(curve: &Spline, t: f64) -> Vec3<f64> {
    curve.jet(t, Order::Zero)[0]
}

fn all_ends() -> Vec<Ends<f64>> {
    let slope = Vec3::of(1.0, -2.0, 0.5);
    let kinds = [End::NotAKnot, End::Natural, End::Bessel, End::Quadratic, End::Clamped(slope)];
    kinds.iter().flat_map(|&a| kinds.iter().map(move |&b| Ends::Open(a, b))).collect()
}

#[test]
fn passes_through_its_points_to_the_bit() {
    let mut random = Random::new(3);
    for n in [2, 3, 4, 5, 9, 40] {
        let points = random.points(n);
        for ends in all_ends() {
            let spline = Spline::with_ends(&points, ends).unwrap();
            for (&t, &p) in spline.knots().iter().zip(&points) {
                assert_eq!(at(&spline, t), p, "{n} {ends:?}");
            }
        }
    }
}

#[test]
fn is_twice_smooth_and_keeps_its_end_conditions() {
    let mut random = Random::new(4);
    for n in [3, 4, 5, 9] {
        let points = random.points(n);
        for ends in all_ends() {
            let spline = Spline::with_ends(&points, ends).unwrap();
            let knots = spline.knots().to_vec();
            for &t in &knots[1..] {
                let (low, high) = (t - 1e-9, t + 1e-9);
                let (a, b) = (spline.jet(low, Order::Second), spline.jet(high, Order::Second));
                let size = 1.0 + b[2].norm();
                close(a[1], b[1], 1e-8 * size);
                close(a[2], b[2], 1e-5 * size);
            }
            let Ends::Open(start, end) = ends else { continue };
            let third = |k: usize| spline.pieces().coefficients()[k][3];
            for (condition, t, near, next) in [(start, 0.0, 0, 1), (end, 1.0, n - 2, n - 3)] {
                let jet = spline.jet(t, Order::Second);
                match condition {
                    End::Natural => close(jet[2], Vec3::zero(), 1e-9),
                    End::NotAKnot => close(third(near), third(next), 1e-6),
                    End::Quadratic => close(third(near), Vec3::zero(), 1e-6),
                    End::Clamped(slope) => close(jet[1], slope, 1e-11),
                    End::Bessel => {
                        let three = if near == 0 { 0..3 } else { n - 3..n };
                        let knots = &knots[three.clone()];
                        let parabola = Spline::with_knots(knots, &points[three], Ends::default());
                        close(jet[1], parabola.unwrap().jet(t, Order::First)[1], 1e-11);
                    }
                }
            }
            curve_laws(&spline, &[0.02, 0.98], 1e4);
        }
    }
}

#[test]
fn four_points_give_one_cubic_without_breaks() {
    let points = Random::new(5).points(4);
    let spline = Spline::through(&points).unwrap();
    let third: Vec<_> = spline.pieces().coefficients().iter().map(|c| c[3]).collect();
    close(third[0], third[1], 1e-10);
    close(third[0], third[2], 1e-10);
    assert!(spline.breaks().is_empty());
    assert_eq!(Spline::through(&Random::new(5).points(6)).unwrap().breaks().len(), 2);
}

#[test]
fn clamped_splines_reproduce_cubics() {
    let cubic = |t: f64| Vec3::of(t, 1.0 - 3.0 * t * t + t * t * t, t * t * t);
    let slope = |t: f64| Vec3::of(1.0, -6.0 * t + 3.0 * t * t, 3.0 * t * t);
    let knots = [0.0, 0.1, 0.45, 0.7, 1.0];
    let points = knots.map(cubic);
    let clamped = Ends::Open(End::Clamped(slope(0.0)), End::Clamped(slope(1.0)));
    for ends in [clamped, Ends::default()] {
        let spline = Spline::with_knots(&knots, &points, ends).unwrap();
        for k in 0..=30 {
            let t = k as f64 / 30.0;
            close(at(&spline, t), cubic(t), 2e-15);
            close(spline.jet(t, Order::First)[1], slope(t), 3e-14);
        }
    }
}

#[test]
fn error_on_a_quarter_circle_falls_with_the_fourth_power() {
    let error = |n: usize| {
        let angle = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / (n - 1) as f64;
        let points: Vec<_> =
            (0..n).map(|k| Vec3::of(angle(k).cos(), angle(k).sin(), 0.0)).collect();
        let spline = Spline::through(&points).unwrap();
        (0..1000).map(|k| (at(&spline, k as f64 / 999.0).norm() - 1.0).abs()).fold(0.0, f64::max)
    };
    let rate = (error(20) / error(39)).log2();
    assert!((3.7..4.3).contains(&rate), "{rate}");
}

#[test]
fn periodic_splines_close_smoothly() {
    let mut random = Random::new(6);
    for n in [3, 4, 7, 20] {
        let mut points = random.points(n);
        points.push(points[0]);
        let spline = Spline::with_ends(&points, Ends::Periodic).unwrap();
        let (a, b) = (spline.jet(0.0, Order::Second), spline.jet(1.0, Order::Second));
        for (a, b) in a.iter().zip(b) {
            close(*a, b, 1e-10 * (1.0 + b.norm()));
        }
        for w in spline.knots().windows(3) {
            let (low, high) = (w[1] - 1e-10, w[1] + 1e-10);
            let (a, b) = (spline.jet(low, Order::Second)[2], spline.jet(high, Order::Second)[2]);
            close(a, b, 1e-6 * (1.0 + b.norm()));
        }
    }
}

#[test]
fn moving_points_move_the_knots_too() {
    let mut random = Random::new(7);
    let mut cases: Vec<(usize, Ends<f64>, Ends<Dual<1>>)> = vec![
        (5, Ends::Open(End::Natural, End::Bessel), Ends::Open(End::Natural, End::Bessel)),
        (5, Ends::Open(End::Quadratic, End::NotAKnot), Ends::Open(End::Quadratic, End::NotAKnot)),
    ];
    cases.extend([2, 3, 4, 8].map(|n| (n, Ends::default(), Ends::default())));
    for (n, plain, dual) in cases {
        let (points, directions) = (random.points(n), random.points(n));
        for t in [0.21, 0.6, 0.93] {
            point_derivative_law(
                &points,
                &directions,
                |p| at(&Spline::with_ends(p, plain).unwrap(), t),
                |p| {
                    let spline = InterpolatingSpline::with_ends(p, dual).unwrap();
                    spline.jet(Dual::from(t), Order::Zero)[0]
                },
                1e-7,
            );
        }
    }
}

/// The three master curves of the hull of Letcher and Shook 1995, table 2.
fn masters() -> [BSplineCurve<f64>; 3] {
    [
        [[0.0, 0.0, 3.6], [1.367, 0.0, 0.602], [2.324, 0.0, -0.8], [3.0, 0.0, -0.9]],
        [[15.0, 4.815, 2.56], [15.0, 5.046, 0.628], [15.0, 3.603, -0.87], [15.0, 0.0, -1.175]],
        [[30.0, 3.5, 2.76], [30.0, 3.5, 1.32], [30.0, 2.5, 0.12], [30.0, 0.0, 0.12]],
    ]
    .map(|points| BSplineCurve::uniform(2, points.map(Vec3::from).to_vec()).unwrap())
}

#[test]
fn lofts_the_hull_of_the_paper() {
    let masters = masters();
    let hull = |u: f64, v: f64| {
        let points = masters.each_ref().map(|m| m.jet(u, Order::Zero)[0]);
        at(&Spline::through(&points).unwrap(), v)
    };
    for ([u, v], expected) in [
        ([0.5, 0.25], [8.6422, 2.9203, -0.2053]),
        ([0.5, 0.5], [15.6002, 4.3938, -0.1043]),
        ([0.5, 0.75], [22.7195, 4.4203, 0.2042]),
        ([0.0, 0.25], [7.2339, 3.1440, 2.9322]),
        ([1.0, 0.25], [9.7675, 0.0, -1.1976]),
    ] {
        close(hull(u, v), Vec3::from(expected), 1e-4);
    }
    let breadth = (0..=2000).map(|k| hull(0.0, k as f64 / 2000.0).y).fold(0.0, f64::max);
    assert!((breadth - 5.0284).abs() < 1e-4);
}

#[test]
fn a_loft_carries_the_derivatives_of_its_masters() {
    // Q_i(u) as Taylor numbers in u give S_u and S_uu through the moving knots.
    let masters = masters();
    let loft = |u: f64| {
        let points = masters.each_ref().map(|m| {
            let [p, d, dd] = m.jet(u, Order::Second);
            let part = |k: usize| Uni2 { f: p[k], t: d[k], tt: dd[k] };
            Vec3::new(part(0), part(1), part(2))
        });
        InterpolatingSpline::through(&points).unwrap()
    };
    let (u, vs) = (0.3, [0.2, 0.5, 0.8]);
    let mut jets = vec![Default::default(); 3];
    loft(u).pieces().jets_many(&vs, Order::First, &mut jets);
    let mut points = vec![Vec3::zero(); 3];
    loft(u).pieces().eval_many(&vs, &mut points);
    for ((&v, jet), &point) in vs.iter().zip(&jets).zip(&points) {
        assert_eq!(point, jet[0]);
        let alone = loft(u).jet(v.into(), Order::First);
        for k in 0..2 {
            close(jet[k].map(|x| x.f), alone[k].map(|x| x.f), 1e-13);
            close(jet[k].map(|x| x.t), alone[k].map(|x| x.t), 1e-12);
            close(jet[k].map(|x| x.tt), alone[k].map(|x| x.tt), 1e-11);
        }
        let value = |u: f64| loft(u).pieces().eval(v.into());
        let su = crate::common::ridders_vector(|u| value(u).map(|x| x.f), u, 0.01);
        let suu = crate::common::ridders_vector(|u| value(u).map(|x| x.t), u, 0.01);
        let v_slope = |u: f64| loft(u).jet(v.into(), Order::First)[1].map(|x| x.f);
        close(jet[0].map(|x| x.t), su, 1e-9);
        close(jet[0].map(|x| x.tt), suu, 1e-8);
        close(jet[1].map(|x| x.t), crate::common::ridders_vector(v_slope, u, 0.01), 1e-8);
    }
}

#[test]
fn polylines_and_types() {
    let points = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]].map(|[x, y]| Vec3::of(x, y, 0.0));
    let line = Spline::of_type(1, &points).unwrap();
    assert_eq!(line.knots(), [0.0, 0.75, 1.0]);
    assert_eq!(at(&line, 0.375), Vec3::of(1.5, 0.0, 0.0));
    assert_eq!((at(&line, 0.75), at(&line, 1.0)), (points[1], points[2]));
    assert_eq!(line.breaks(), [0.75]);
    assert_eq!(Spline::of_type(2, &points), Spline::of_type(3, &points));
    let four = Random::new(8).points(4);
    assert_eq!(Spline::of_type(2, &four), Err(InterpolationError::Type { actual: 2 }));
}

#[test]
fn refuses_bad_points_with_their_indices() {
    let mut points = Random::new(9).points(5);
    points[3] = points[2];
    let refused = |p: &[Vec3<f64>], ends| Spline::with_ends(p, ends).unwrap_err();
    let coincident = InterpolationError::Coincident { first: 2, second: 3 };
    assert_eq!(refused(&points, Ends::default()), coincident);
    assert_eq!(coincident.to_string(), "points 3 and 4 coincide");
    let few = InterpolationError::TooFew { expected: 2, actual: 1 };
    assert_eq!(refused(&points[..1], Ends::default()), few);
    let few = InterpolationError::TooFew { expected: 4, actual: 3 };
    assert_eq!(refused(&points[..3], Ends::Periodic), few);
    points[3].z = f64::INFINITY;
    assert_eq!(refused(&points, Ends::default()), InterpolationError::NotFinite { index: 3 });
    let open = Random::new(9).points(5);
    assert!(matches!(refused(&open, Ends::Periodic), InterpolationError::NotClosed { .. }));
}
