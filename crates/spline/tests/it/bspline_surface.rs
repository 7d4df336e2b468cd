//! Laws of B-spline surfaces.

use crate::common::{Random, close, point_derivative_law, surface_laws};
use moldloft_num::{Dual, Order, SurfJet, Surface, Vec3};
use moldloft_spline::{BSplineSurface, KnotVector, SplineError};

/// Polynomial and rational surfaces of several pairs of degrees, with a double knot.
fn surfaces() -> Vec<BSplineSurface<f64>> {
    let mut random = Random::new(20);
    let mut all = Vec::new();
    for degrees in [[1, 1], [2, 2], [3, 3], [3, 1], [2, 5], [9, 3]] {
        for rational in [false, true] {
            let mut knots = degrees.map(|p| KnotVector::clamped_uniform(p, p + 4).unwrap());
            if degrees[0] > 1 {
                knots[0] = knots[0].with_knot(0.4, 2).unwrap();
            }
            let n = knots[0].points() * knots[1].points();
            let weights = rational.then(|| (0..n).map(|_| 1.5 + random.signed()).collect());
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
    let mut random = Random::new(21);
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
    let fixed = crate::common::seeded(&points, &[Vec3::zero(); 16]);
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

#[test]
fn grids_are_the_points_one_by_one() {
    let mut random = Random::new(22);
    for s in surfaces() {
        let us: Vec<f64> = (0..23).map(|_| 0.5 + 0.52 * random.signed()).collect();
        let mut vs: Vec<f64> = (0..300).map(|_| 0.5 + 0.52 * random.signed()).collect();
        (vs[0], vs[7], vs[299]) = (0.0, 0.5, 1.0);
        let mut points = vec![Vec3::zero(); us.len() * vs.len()];
        let (mut normals, mut alone) = (points.clone(), points.clone());
        s.grid(&us, &vs, &mut points, Some(&mut normals));
        s.grid(&us, &vs, &mut alone, None);
        assert_eq!(points, alone);
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let (jet, k) = (s.jet(u, v, Order::First), i * vs.len() + j);
                close(points[k], jet.p, 1e-13 * (1.0 + jet.p.norm()));
                let condition = jet.u.norm() * jet.v.norm() / jet.u.cross(jet.v).norm();
                close(normals[k], jet.normal(), 1e-13 * condition.max(1.0) * 10.0);
            }
        }
    }
}

#[test]
fn scattered_points_are_the_points_one_by_one() {
    let mut random = Random::new(23);
    for s in surfaces() {
        let mut uv: Vec<[f64; 2]> = (0..2000)
            .map(|_| [0.5 + 0.51 * random.signed(), 0.5 + 0.5 * random.signed()])
            .collect();
        for k in 0..=20 {
            uv.push([k as f64 / 20.0, 1.0]);
            uv.push([0.4, k as f64 / 20.0]);
        }
        let mut points = vec![Vec3::zero(); uv.len()];
        let mut jets = vec![SurfJet::default(); uv.len()];
        s.scattered(&uv, &mut points);
        s.scattered_first(&uv, &mut jets);
        for (k, &[u, v]) in uv.iter().enumerate() {
            let jet = s.jet(u, v, Order::First);
            close(points[k], jet.p, 1e-13 * (1.0 + jet.p.norm()));
            close(jets[k].p, jet.p, 1e-13 * (1.0 + jet.p.norm()));
            close(jets[k].u, jet.u, 2e-12 * (1.0 + jet.u.norm()));
            close(jets[k].v, jet.v, 2e-12 * (1.0 + jet.v.norm()));
        }
    }
}

#[test]
fn batches_carry_the_derivatives_by_the_points() {
    let mut random = Random::new(24);
    let knots = KnotVector::clamped_uniform(3, 6).unwrap();
    let (points, directions) = (random.points(36), random.points(36));
    let net = crate::common::seeded(&points, &directions);
    let s = BSplineSurface::new(knots.clone(), knots, net, None).unwrap();
    let (us, vs) = ([0.1, 0.62], [0.2, 0.5, 0.95]);
    let mut grid = [Vec3::zero(); 6];
    s.grid(&us, &vs, &mut grid, None);
    let uv: Vec<[f64; 2]> = us.iter().flat_map(|&u| vs.map(|v| [u, v])).collect();
    let mut scattered = [Vec3::zero(); 6];
    s.scattered(&uv, &mut scattered);
    for (k, &[u, v]) in uv.iter().enumerate() {
        let p = s.jet(u.into(), v.into(), Order::Zero).p;
        for batch in [grid[k], scattered[k]] {
            close(batch.re(), p.re(), 1e-14);
            close(batch.map(|x| x.eps[0]), p.map(|x| x.eps[0]), 1e-14);
        }
    }
}
