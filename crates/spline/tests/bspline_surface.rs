//! Laws of B-spline surfaces.

mod common;

use common::{Random, close, point_derivative_law, surface_laws};
use moldloft_num::{Dual, Order, Surface, Vec3};
use moldloft_spline::{BSplineSurface, KnotVector, SplineError};

/// Polynomial and rational surfaces of several pairs of degrees, with a double knot.
fn surfaces() -> Vec<BSplineSurface<f64>> {
    let mut random = Random(20);
    let mut all = Vec::new();
    for degrees in [[1, 1], [2, 2], [3, 3], [3, 1], [2, 5], [9, 3]] {
        for rational in [false, true] {
            let mut knots = degrees.map(|p| KnotVector::clamped_uniform(p, p + 4).unwrap());
            if degrees[0] > 1 {
                knots[0] = knots[0].with_knot(0.4, 2).unwrap();
            }
            let n = knots[0].points() * knots[1].points();
            let weights = rational.then(|| (0..n).map(|_| 1.5 + random.next()).collect());
            let [u, v] = knots;
            all.push(BSplineSurface::new(u, v, random.points(n), weights).unwrap());
        }
    }
    all
}

#[test]
fn derivatives_are_central_differences() {
    let uv = [[0.12, 0.37], [0.55, 0.9], [0.31, 0.62], [1.01, -0.01]];
    for s in surfaces() {
        surface_laws(&s, &uv, 1e3);
    }
}

#[test]
fn corners_meet_the_corner_points() {
    for s in surfaces() {
        let (n, points) = (s.knots()[1].points(), s.control_points());
        close(s.jet(0.0, 1.0, Order::Zero).p, points[n - 1], 1e-15);
        close(s.jet(1.0, 0.0, Order::Zero).p, points[points.len() - n], 1e-15);
    }
}

#[test]
fn moves_with_points_and_parameters() {
    let mut random = Random(21);
    let knots = KnotVector::clamped_uniform(2, 4).unwrap();
    let (points, directions) = (random.points(16), random.points(16));
    point_derivative_law(
        &points,
        &directions,
        |p| {
            let s = BSplineSurface::new(knots.clone(), knots.clone(), p.to_vec(), None);
            s.unwrap().jet(0.3, 0.8, Order::Zero).p
        },
        |p| {
            let s = BSplineSurface::new(knots.clone(), knots.clone(), p.to_vec(), None);
            s.unwrap().jet(Dual::from(0.3), Dual::from(0.8), Order::Zero).p
        },
        1e-10,
    );
    let fixed = common::seeded(&points, &[Vec3::zero(); 16]);
    let dual = BSplineSurface::new(knots.clone(), knots.clone(), fixed, None).unwrap();
    let plain = BSplineSurface::new(knots.clone(), knots, points, None).unwrap();
    let (u, v) = (Dual::<1> { re: 0.3, eps: [2.0] }, Dual::<1> { re: 0.8, eps: [-1.0] });
    let jet = plain.jet(0.3, 0.8, Order::First);
    let along = dual.jet(u, v, Order::Zero).p.map(|x| x.eps[0]);
    close(along, jet.u * 2.0 - jet.v, 1e-13);
}

#[test]
fn refuses_a_net_of_the_wrong_size() {
    let knots = KnotVector::clamped_uniform(2, 4).unwrap();
    let refused = BSplineSurface::<f64>::new(knots.clone(), knots, vec![Vec3::zero(); 12], None);
    assert_eq!(refused.unwrap_err(), SplineError::Count { expected: 16, actual: 12 });
}
