//! Knuckles of short lists, and neighbours in the wrong order.

use moldloft_fair::{DataFinding, data_findings};
use moldloft_num::Vec3;

/// A shallow arc with a knuckle of an angle in degrees in its middle.
fn list(n: usize, degrees: f64, noise: f64, seed: u64) -> Vec<Vec3<f64>> {
    let mut state = 7 * seed + 11;
    let mut unit = move || {
        state = (1_103_515_245 * state + 12_345) % (1 << 31);
        2.0 * (state as f64 / f64::from(1u32 << 31)) - 1.0
    };
    let radius = 12.0 + 24.0 * (1.0 + unit());
    let step = 10.0 / (n - 1) as f64;
    let slope = degrees.to_radians().tan();
    (0..n)
        .map(|k| {
            let x = -5.0 + step * k as f64;
            let y = x * x / (2.0 * radius) + slope * x.max(0.0);
            Vec3::of(x + noise * step * unit(), y + noise * step * unit(), 0.0)
        })
        .collect()
}

#[test]
fn knuckles_of_short_lists() {
    let soak = std::env::var_os("MOLDLOFT_SOAK").is_some();
    let draws = if soak { 400 } else { 40 };
    for n in [9, 11, 13, 15, 19, 25, 41] {
        for (degrees, noise) in [(0.0, 6e-3), (0.0, 0.0), (10.0, 6e-3), (10.0, 0.0), (45.0, 6e-3)] {
            let (mut found, mut wrong) = (0, 0);
            for seed in 0..draws {
                let all = data_findings(&list(n, degrees, noise, seed), false);
                let here = |f: &DataFinding| matches!(f, DataFinding::Knuckle { index, .. } if *index == n / 2);
                found += usize::from(all.iter().any(here));
                wrong += usize::from(all.iter().any(|f| !(degrees > 0.0 && here(f))));
            }
            let draws = draws as usize;
            println!(
                "{n} points, {degrees} degrees, noise {noise}: {found} found, {wrong} wrong of {draws}"
            );
            if degrees > 0.0 {
                assert!(100 * found >= 95 * draws, "{n} {degrees} {noise}: {found} of {draws}");
            }
            assert!(100 * wrong <= 3 * draws, "{n} {degrees} {noise}: {wrong} wrong of {draws}");
        }
    }
}

#[test]
fn smooth_curves_of_few_points_have_no_knuckle() {
    let ellipse = |n: usize| -> Vec<Vec3<f64>> {
        let at = |k: usize| 0.05 + 1.5 * k as f64 / (n - 1) as f64;
        (0..n).map(|k| Vec3::of(3.0 * at(k).cos(), at(k).sin(), 0.0)).collect()
    };
    for n in 7..45 {
        let all = data_findings(&ellipse(n), false);
        assert!(all.is_empty(), "{n}: {all:?}");
    }
}

#[test]
fn neighbours_in_the_wrong_order() {
    for seed in 0..30 {
        let exact = list(31, 0.0, 6e-3, seed);
        assert!(data_findings(&exact, false).is_empty());
        let at = 4 + seed as usize % 22;
        let mut points = exact.clone();
        points.swap(at, at + 1);
        let found = data_findings(&points, false);
        let here = |f: &DataFinding| matches!(f, DataFinding::Swapped { index } if *index == at);
        assert!(found.len() == 1 && here(&found[0]), "{seed}: {found:?}");
    }
}
