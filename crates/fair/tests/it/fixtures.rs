//! The data of the figures: bodies and sections, rounded or with noise.

use moldloft_num::Vec3;
pub use moldloft_testing::Lcg;

/// Rounding to `digits` decimals as array programs do it: the scaled number, halves to even.
pub fn round(x: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (x * scale).round_ties_even() / scale
}

pub fn rounded(points: &[Vec3<f64>], digits: i32) -> Vec<Vec3<f64>> {
    points.iter().map(|p| p.map(|x| round(x, digits))).collect()
}

/// NACA 0012 with an open trailing edge, 81 points at x = s^2 (Abbott and von Doenhoff 1959).
pub fn naca() -> Vec<Vec3<f64>> {
    (-40..=40)
        .map(|i| {
            let s = f64::from(i) / 40.0;
            let x = s * s;
            let half = 0.2969 * s.abs() - 0.1260 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3)
                - 0.1015 * x.powi(4);
            Vec3::of(x, s.signum() * 0.6 * half, 0.0)
        })
        .collect()
}

/// A body with a waist, 61 points.
pub fn waisted() -> Vec<Vec3<f64>> {
    (0..=60)
        .map(|i| {
            let x = f64::from(i) / 60.0;
            let waist = (-((x - 0.55) / 0.15f64).powi(2)).exp();
            Vec3::of(x, 0.05 - 0.02 * waist + 0.01 * (1.0 - (2.0 * x - 1.0).powi(2)), 0.0)
        })
        .collect()
}

pub struct Fixture {
    pub name: &'static str,
    pub truth: Vec<Vec3<f64>>,
    pub points: Vec<Vec3<f64>>,
    pub tolerance: f64,
    pub closed: bool,
}

pub fn f1a() -> Fixture {
    let truth = naca();
    let points = rounded(&truth, 4);
    Fixture { name: "F1a", truth, points, tolerance: 1e-4, closed: false }
}

pub fn f1b() -> Fixture {
    let truth = naca();
    let points = rounded(&truth, 3);
    Fixture { name: "F1b", truth, points, tolerance: 1e-3, closed: false }
}

pub fn f2a() -> Fixture {
    let truth = waisted();
    let points = rounded(&truth, 4);
    Fixture { name: "F2a", truth, points, tolerance: 1e-4, closed: false }
}

pub fn f2b() -> Fixture {
    let truth = waisted();
    let mut random = Lcg::new(1);
    let noisy = |p: &Vec3<f64>| {
        random.centred();
        Vec3::of(p.x, p.y + 2e-4 * random.centred(), 0.0)
    };
    let points = truth.iter().map(noisy).collect();
    Fixture { name: "F2b", truth, points, tolerance: 2e-4, closed: false }
}

pub fn f3() -> Fixture {
    let turn = |i: usize| std::f64::consts::TAU * i as f64 / 64.0;
    let truth: Vec<_> = (0..64).map(|i| Vec3::of(turn(i).cos(), turn(i).sin(), 0.0)).collect();
    let mut random = Lcg::new(1);
    let mut draw = || 2e-3 * random.centred();
    let points = truth
        .iter()
        .map(|p| {
            let x = p.x + draw();
            Vec3::of(x, p.y + draw(), 0.0)
        })
        .collect();
    Fixture { name: "F3", truth, points, tolerance: 2e-3, closed: true }
}

pub fn all() -> Vec<Fixture> {
    vec![f1a(), f1b(), f2a(), f2b(), f3()]
}

/// Root mean square distance of corresponding points.
pub fn rms(a: &[Vec3<f64>], b: &[Vec3<f64>]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(p, q)| (*p - *q).norm_sq()).sum();
    (sum / a.len() as f64).sqrt()
}

/// Asserts that `got` is within a relative `band` of `wanted`.
#[track_caller]
pub fn near(what: &str, got: f64, wanted: f64, band: f64) {
    let off = (got - wanted).abs() / wanted.abs();
    assert!(off <= band, "{what}: {got:e}, expected {wanted:e} (off by {off:.1e})");
}
