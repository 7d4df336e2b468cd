//! Folded surfaces are found, sound ones are not accused.

use crate::{Body, HullSide};
use moldloft_num::{Jet, Order, Surface, SurfaceFormula, Vec3};
use moldloft_testing::{Random, rounds};

/// A surface between two curves of polynomials in u.
struct CubicRulings([[[f64; 4]; 3]; 2]);

impl SurfaceFormula for CubicRulings {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let at = |c: &[f64; 4]| ((u * c[3] + c[2]) * u + c[1]) * u + c[0];
        let curve = |k: usize| self.0[k].each_ref().map(at);
        let (a, b) = (curve(0), curve(1));
        let across = |k: usize| a[k] + (b[k] - a[k]) * v;
        Vec3::new(across(0), across(1), across(2))
    }
    moldloft_num::surface_facts!(smooth, open, not_rational);
}

fn folds(surface: &CubicRulings) -> Option<Vec3> {
    let side = HullSide { surface, reversed: false, open_edges: [false; 4], loops: None };
    Body::new(&[side], [], Vec::new(), 2.0, 1e-6).unwrap().folds().first().map(|fold| fold.1)
}

#[test]
fn rulings_that_cross() {
    let mut random = Random::new(3);
    let (mut found, mut missed) = (0, 0);
    for round in 0..rounds(100, 5000) {
        let mut any = || std::array::from_fn(|_| random.signed());
        let (a, b): ([f64; 4], [f64; 4]) = (any(), any());
        // Both over the plane z = 0: the normal along z is that of the map of (u, v).
        let one = [[0.0, 1.0, 0.0, 0.0], a.map(|x| 0.3 * x), [0.0; 4]];
        let other = [[0.0, 1.0, 0.4 * b[0], 0.4 * b[1]], [1.0, b[2], b[3], 0.3 * a[0]], [0.0; 4]];
        let plane = CubicRulings([one, other]);
        let step = |k: usize| k as f64 / 200.0;
        let normal = |u: f64, v: f64| plane.jet(u, v, Order::First);
        let signs = (0..=200).flat_map(|i| (0..=200).map(move |j| (step(i), step(j))));
        let signs: Vec<f64> = signs
            .map(|(u, v)| {
                let j = normal(u, v);
                j.u.cross(j.v).z
            })
            .collect();
        let (low, high) = signs.iter().fold((0.0f64, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
        let share = -low.max(-high) / (high - low);
        match folds(&plane) {
            Some(at) => {
                assert!(share > 0.0 || low.min(-high).abs() < 1e-2, "{round}: accused at {at:?}");
                found += 1;
            }
            // A fold of less than a sample.
            None if share > 0.02 => panic!("{round}: missed, {low} {high}"),
            None => missed += usize::from(share > 0.0),
        }
    }
    assert!(found > 10 * missed && found > 10, "{found} {missed}");
}

/// TurnedWaves of any height over a plane, turned; sound.
struct TurnedWaves([f64; 6]);

impl SurfaceFormula for TurnedWaves {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let [a, b, c, d, height, turn] = self.0;
        let z = ((u * a + v * b).sin() + (u * c + v * d).cos()) * height;
        let (s, t) = (turn.sin(), turn.cos());
        Vec3::new(u * t - z * s, v * 2.0, u * s + z * t)
    }
    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn sound_surfaces_are_not_accused() {
    let mut random = Random::new(4);
    for round in 0..rounds(60, 1000) {
        let waves = TurnedWaves(std::array::from_fn(|k| match k {
            4 => random.between(0.0, 3.0),
            _ => random.between(-12.0, 12.0),
        }));
        let side =
            HullSide { surface: &waves, reversed: false, open_edges: [false; 4], loops: None };
        let body = Body::new(&[side], [], Vec::new(), 2.0, 1e-6).unwrap();
        assert!(body.folds().is_empty(), "{round}: {:?} {:?}", waves.0, body.folds());
    }
}
