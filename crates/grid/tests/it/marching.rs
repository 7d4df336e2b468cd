//! Grids marched off surfaces.

use moldloft_grid::*;
use moldloft_num::{Dual4, Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

fn heights(n: usize, last: f64) -> Vec<f64> {
    (0..n).map(|k| last * (k as f64 / (n - 1) as f64)).collect()
}

#[test]
fn planes_and_spheres_are_left_at_right_angles() {
    let flat = SurfaceGrid::<f64>::from_fn(6, 5, |i, j| Vec3::of(i as f64, j as f64, 0.0));
    let options = Hyperbolic { heights: heights(5, 2.0), sides: [Side::Free; 4], smoothing: 0.3 };
    let layers = hyperbolic(&flat, &options).unwrap();
    for (k, layer) in layers.iter().enumerate() {
        for i in 0..6 {
            for j in 0..5 {
                let exact = flat.at(i, j) + Vec3::of(0.0, 0.0, 0.5 * k as f64);
                assert!(layer.at(i, j).distance(exact) < 1e-12);
            }
        }
    }
    // A quarter ring of a sphere between two planes of symmetry: radii grow with the heights.
    let error = |n: usize| {
        let ball = SurfaceGrid::<f64>::from_fn(n + 1, n + 1, |i, j| {
            let (a, b) = (0.8 + 1.2 * i as f64 / n as f64, 0.5 * PI * j as f64 / n as f64);
            let (y, z) = (a.sin() * b.cos(), a.sin() * b.sin());
            // Exactly in the planes.
            Vec3::of(a.cos(), if j == n { 0.0 } else { y }, if j == 0 { 0.0 } else { z })
        });
        let sides = [Side::Free, Side::Free, Side::Symmetry(2), Side::Symmetry(1)];
        let options = Hyperbolic { heights: heights(n / 2 + 1, 0.2), sides, smoothing: 0.05 };
        let layers = hyperbolic(&ball, &options).unwrap();
        let last = &layers[n / 2];
        assert!((0..=n).all(|i| last.at(i, 0).z == 0.0 && last.at(i, n).y == 0.0));
        let inner = (n / 4..=3 * n / 4).flat_map(|i| (0..=n).map(move |j| (i, j)));
        inner.map(|(i, j)| (last.at(i, j).norm() - 1.2).abs()).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(12), error(24));
    println!("{coarse:e} {fine:e}");
    assert!(fine < 0.02 && fine < coarse);
}

#[test]
fn noses_stay_one_point_on_the_axis() {
    let (m, n) = (16, 13);
    let body = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let (x, a) = ((i as f64 / (m - 1) as f64).powi(2), PI * j as f64 / (n - 1) as f64);
        let r = 0.4 * x.sqrt();
        let z = if j == 0 || j == n - 1 { 0.0 } else { r * a.sin() };
        Vec3::of(2.0 * x, r * a.cos(), z)
    });
    // s_i x s_j points inward on such a half body: march off its swapped image.
    let turned = SurfaceGrid::from_fn(n, m, |j, i| body.at(i, j));
    let sides = [Side::Symmetry(2), Side::Symmetry(2), Side::Pole, Side::Free];
    let options = Hyperbolic { heights: heights(9, 0.15), sides, smoothing: 0.3 };
    let layers = hyperbolic(&turned, &options).unwrap();
    for layer in &layers[1..] {
        let nose = layer.at(0, 0);
        assert!((0..n).all(|j| layer.at(j, 0) == nose));
        assert!(nose.x < 0.0 && nose.y.abs() < 1e-9 && nose.z == 0.0, "{nose:?}");
        assert!((0..m).all(|i| layer.at(0, i).z == 0.0 && layer.at(n - 1, i).z == 0.0));
    }
    let last = &layers[8];
    assert!((0..n).all(|j| (1..m).all(|i| {
        let off = last.at(j, i).distance(turned.at(j, i));
        (0.05..0.3).contains(&off)
    })));
}

#[test]
fn curves_march_in_their_plane_and_concave_ones_open() {
    let circle: Vec<Vec3> = (0..=40)
        .map(|k| {
            let a = -2.0 * PI * f64::from(k % 40) / 40.0;
            Vec3::of(a.cos(), a.sin(), 0.0)
        })
        .collect();
    // Clockwise: the left of it is outside.
    let grid = hyperbolic_curve(
        &circle,
        Vec3::of(0.0, 0.0, 1.0),
        &heights(11, 1.0),
        [Side::Periodic; 2],
        0.1,
    )
    .unwrap();
    assert_eq!((grid.m, grid.n), (11, 41));
    assert!((0..41).all(|j| grid.at(10, j).z.abs() < 1e-12));
    let radii: Vec<f64> = (0..41).map(|j| grid.at(10, j).norm()).collect();
    assert!(radii.iter().all(|r| (r - 2.0).abs() < 0.08));
    // Nothing shows where the curve closes.
    assert!(radii.iter().all(|r| (r - radii[0]).abs() < 1e-9), "{radii:?}");
    assert_eq!(grid.at(5, 0), grid.at(5, 40));
    let valley: Vec<Vec3> = (0..33)
        .map(|k| {
            let x = 2.0 - f64::from(k) / 8.0;
            Vec3::of(x, 0.5 * x * x, 0.0)
        })
        .collect();
    // Leftward of a curve that runs to -x is down; turn it round for the inside of the valley.
    let inside: Vec<Vec3> = valley.into_iter().rev().collect();
    let grid =
        hyperbolic_curve(&inside, Vec3::of(0.0, 0.0, 1.0), &heights(15, 0.7), [Side::Free; 2], 1.0);
    let grid = grid.unwrap();
    assert!(grid.at(14, 16).y > 0.3 && folded_cells(&grid).is_empty());
}

#[test]
fn derivatives_and_refusals() {
    fn last<T: Real>(h: T) -> SurfaceGrid<T> {
        let hill = SurfaceGrid::from_fn(7, 6, |i, j| {
            let (u, v) = (i as f64 / 6.0, j as f64 / 5.0);
            Vec3::new(T::from(u), T::from(v), h * (3.0 * u).sin() * (1.0 + v))
        });
        let options = Hyperbolic {
            heights: vec![T::zero(), h * 0.2, h * 0.5],
            sides: [Side::Free; 4],
            smoothing: 0.2,
        };
        hyperbolic(&hill, &options).unwrap().remove(2)
    }
    let dual = last(Dual4::from_parts(|k| [0.2, 1.0, 0.0, 0.0, 0.0][k]));
    let (high, low) = (last(0.2 + 1e-5), last(0.2 - 1e-5));
    for (c, plane) in dual.planes.iter().enumerate() {
        for (k, x) in plane.iter().enumerate() {
            let difference = (high.planes[c][k] - low.planes[c][k]) / 2e-5;
            assert!((x.part(1) - difference).abs() < 1e-7, "{} {difference}", x.part(1));
        }
    }
    let flat = SurfaceGrid::<f64>::from_fn(4, 4, |i, j| Vec3::of(i as f64, j as f64, 0.0));
    let with = |heights: Vec<f64>| Hyperbolic { heights, sides: [Side::Free; 4], smoothing: 0.2 };
    let error = hyperbolic(&flat, &with(vec![0.0, 1.0, 0.5])).unwrap_err();
    assert_eq!(error, GridError::Heights { at: 3, value: 0.5 });
    let error = hyperbolic(&flat, &with(vec![0.5, 1.0])).unwrap_err();
    assert_eq!(error, GridError::Heights { at: 1, value: 0.5 });
    let fan = SurfaceGrid::<f64>::from_fn(4, 4, |i, j| {
        let a = 0.3 * j as f64;
        Vec3::of(i as f64 * a.cos(), i as f64 * a.sin(), 0.0)
    });
    let error = hyperbolic(&fan, &with(heights(3, 0.1))).unwrap_err();
    assert!(matches!(error, GridError::NoNormal { at: [1, 1] }));
}

/// Half a ball from its nose: the layers are halves of larger balls, at the pole as elsewhere.
#[test]
fn a_half_ball_with_a_pole_stays_one() {
    for (m, n, tall) in [(21, 25, 0.5), (41, 61, 2.0), (11, 9, 0.1)] {
        let ball = SurfaceGrid::from_fn(m, n, |i, j| {
            let a = FRAC_PI_2 * i as f64 / (m - 1) as f64;
            let b = FRAC_PI_2 - PI * j as f64 / (n - 1) as f64;
            Vec3::of(-a.cos(), a.sin() * b.cos(), a.sin() * b.sin())
        });
        for smoothing in [0.1, 0.3, 1.0] {
            let sides = [Side::Pole, Side::Free, Side::Symmetry(1), Side::Symmetry(1)];
            let heights = vec![0.0, 0.1 * tall, 0.3 * tall, 0.6 * tall, tall];
            let options = Hyperbolic { heights, sides, smoothing };
            let layers = hyperbolic(&ball, &options).unwrap();
            let last = &layers[layers.len() - 1];
            // On what is convex layers are a little nearer than their heights, everywhere alike.
            let radius = |i: usize, j: usize| last.at(i, j).norm();
            let away = radius(m / 2, n / 2) - 1.0;
            assert!(away > 0.8 * tall && away < 1.01 * tall, "{away} of {tall}");
            for j in 0..n {
                for i in 0..m {
                    let off = (radius(i, j) - 1.0 - away).abs();
                    assert!(off < 0.1 * tall, "{m} {n} {tall} {smoothing}: {off} at {i}, {j}");
                }
                assert!(last.at(0, j) == last.at(0, 0));
            }
        }
    }
}
