//! Laws of B-spline curves.

use crate::common::{Random, close, curve_laws, point_derivative_law};
use moldloft_num::{Curve, Dual, Order, Vec3};
use moldloft_spline::{BSplineCurve, KnotError, KnotVector, SplineError};

/// Polynomial and rational curves of several degrees, with simple and double knots.
fn curves() -> Vec<BSplineCurve<f64>> {
    let mut random = Random::new(1);
    let mut all = Vec::new();
    for degree in 1..=6 {
        for rational in [false, true] {
            let mut knots = KnotVector::clamped_uniform(degree, degree + 4).unwrap();
            if degree > 1 {
                knots = knots.with_knot(0.4, 1).unwrap();
            }
            let n = knots.points();
            let weights = rational.then(|| (0..n).map(|_| 1.5 + random.signed()).collect());
            all.push(BSplineCurve::new(knots, random.points(n), weights).unwrap());
        }
    }
    all
}

fn at(curve: &BSplineCurve<f64>, t: f64) -> Vec3<f64> {
    curve.jet(t, Order::Zero)[0]
}

#[test]
fn derivatives_are_central_differences() {
    for curve in curves() {
        curve_laws(&curve, &[0.12, 0.37, 0.55, 0.9, 1.02], 1e3);
    }
}

#[test]
fn clamped_ends_meet_the_end_points() {
    for curve in curves() {
        let points = curve.control_points();
        close(at(&curve, 0.0), points[0], 1e-15);
        close(at(&curve, 1.0), points[points.len() - 1], 1e-15);
    }
}

#[test]
fn moves_with_points_and_parameter() {
    let mut random = Random::new(2);
    let (points, directions) = (random.points(6), random.points(6));
    let t = Dual::<1> { re: 0.37, eps: [0.8] };
    let plain = BSplineCurve::uniform(3, points.clone()).unwrap();
    point_derivative_law(
        &points,
        &directions,
        |p| at(&BSplineCurve::uniform(3, p.to_vec()).unwrap(), 0.37),
        |p| BSplineCurve::uniform(3, p.to_vec()).unwrap().jet(Dual::from(0.37), Order::Zero)[0],
        1e-10,
    );
    let dual = crate::common::seeded(&points, &[Vec3::zero(); 6]);
    let along = BSplineCurve::uniform(3, dual).unwrap().jet(t, Order::Zero)[0];
    let jet = plain.jet(0.37, Order::First);
    close(along.map(|x| x.eps[0]), jet[1] * 0.8, 1e-14);
}

#[test]
fn a_quadratic_rational_circle_is_round() {
    let points = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::of(x, y, 0.0));
    let knots = KnotVector::clamped_uniform(2, 3).unwrap();
    let weights = vec![1.0, 0.5f64.sqrt(), 1.0];
    let arc = BSplineCurve::new(knots, points.to_vec(), Some(weights)).unwrap();
    for k in 0..=20 {
        let jet = arc.jet(k as f64 / 20.0, Order::Second);
        assert!((jet[0].norm() - 1.0).abs() < 1e-15);
        let curvature = jet[1].cross(jet[2]).norm() / jet[1].norm().powi(3);
        assert!((curvature - 1.0).abs() < 1e-13);
    }
}

#[test]
fn knots_degree_and_parts_keep_the_shape() {
    for curve in curves() {
        let p = curve.degree();
        let refined = curve.insert_knot(0.3, p).unwrap();
        let raised = curve.elevate_degree().unwrap();
        let twice = raised.elevate_degree().unwrap();
        assert_eq!((raised.degree(), twice.degree()), (p + 1, p + 2));
        let (left, right) = curve.split_at(0.4).unwrap();
        let back = curve.reversed();
        for k in -2..=22 {
            let t = k as f64 / 20.0;
            let x = at(&curve, t);
            let size = 1e-12 * (1.0 + x.norm());
            close(at(&refined, t), x, size);
            close(at(&raised, t), x, size * 10.0);
            close(at(&twice, t), x, size * 100.0);
            close(at(&back, 1.0 - t), x, size);
            if t <= 0.4 {
                close(at(&left, t / 0.4), x, size);
            } else {
                close(at(&right, (t - 0.4) / 0.6), x, size);
            }
        }
        assert_eq!(left.control_points().last(), right.control_points().first());
    }
}

#[test]
fn refuses_bad_input_with_numbers() {
    let points = |n: usize| vec![Vec3::<f64>::zero(); n];
    let knots = KnotVector::clamped_uniform(2, 4).unwrap();
    let new = |points, weights| BSplineCurve::new(knots.clone(), points, weights).unwrap_err();
    assert_eq!(new(points(3), None), SplineError::Count { expected: 4, actual: 3 });
    let short = new(points(4), Some(vec![1.0; 3]));
    assert_eq!(short, SplineError::Count { expected: 4, actual: 3 });
    let weights = Some(vec![1.0, 1.0, 0.0, 1.0]);
    assert_eq!(new(points(4), weights), SplineError::Weight { index: 2, weight: 0.0 });
    // The third, as people count.
    let message = SplineError::Weight { index: 2, weight: 0.0 }.to_string();
    assert_eq!(message, "weight 3 is 0, expected a positive number");
    let mut bad = points(4);
    bad[1].y = f64::NAN;
    assert_eq!(new(bad, None), SplineError::NotFinite { index: 1 });
    let wide = KnotVector::new(1, vec![0.0, 0.0, 2.0, 2.0]).unwrap();
    let domain = BSplineCurve::new(wide, points(2), None).unwrap_err();
    assert_eq!(domain, SplineError::Domain { start: 0.0, end: 2.0 });
    let curve = BSplineCurve::uniform(2, points(4)).unwrap();
    assert_eq!(curve.split_at(1.0).unwrap_err(), SplineError::Outside { t: 1.0 });
    let many = KnotError::Multiplicity { knot: 0.5, actual: 3, allowed: 2 };
    assert_eq!(curve.insert_knot(0.5, 2).unwrap_err(), SplineError::Knots(many));
}
