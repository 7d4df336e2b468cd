//! Wrong digits and knuckles among data at any spacing: found where they are, and nowhere else.

use crate::truth::{Lcg, SHAPES, SPACINGS, case, places, shape_at};
use moldloft_fair::*;
use moldloft_num::Vec3;

#[test]
fn spacing_is_no_finding() {
    // An exact sine, spaced by 0.05 and then 0.1; stations of an aerofoil; random spacing.
    let sine: Vec<f64> =
        (0..40).map(|k| 0.05 * f64::from(k)).chain((20..50).map(|k| 0.1 * f64::from(k))).collect();
    let sine: Vec<_> = sine.iter().map(|&x| Vec3::of(x, x.sin(), 0.0)).collect();
    assert_eq!(data_findings(&sine, false), []);
    for shape in SHAPES {
        for kind in SPACINGS {
            let mut g = Lcg::new(4);
            let exact: Vec<_> =
                places(kind, &mut g, 49).iter().map(|&u| shape_at(shape, u)).collect();
            let found = data_findings(&exact, false);
            if !(shape == "naca0012" && kind == "random") {
                assert_eq!(found, [], "{shape} {kind}");
            }
        }
    }
}

/// Gaussian noise, from the sum of twelve even numbers.
fn gaussian(g: &mut Lcg) -> f64 {
    (0..12).map(|_| g.unit()).sum()
}

#[test]
fn wrong_digits_are_found_at_their_place() {
    let seeds = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 1..60 } else { 1..6 };
    let (mut planted, mut clean, mut found) = (0, 0, [0; 2]);
    for seed in seeds {
        let mut g = Lcg::new(100 + seed);
        for shape in ["clothoid", "hollow", "ellipse", "sac", "helix"] {
            for (kind, even) in [("even", true), ("half", true), ("jitter", true), ("even", false)]
            {
                let (_, mut points, radius) = case(shape, kind, seed);
                if !even {
                    let size = radius / 3.0;
                    let mut slip = || size * gaussian(&mut g);
                    let exact = (0..49).map(|k| shape_at(shape, f64::from(k) / 48.0));
                    points = exact.map(|p| p + Vec3::of(slip(), slip(), 0.0)).collect();
                }
                clean += usize::from(data_findings(&points, false).is_empty());
                let deviations = predicted(&points, false);
                let at = 6 + (seed as usize * 7) % 36;
                let along = points[at + 1] - points[at - 1];
                let normal = Vec3::of(-along.y, along.x, 0.0).normalized().unwrap();
                planted += 1;
                for (found, times) in found.iter_mut().zip([5.0, 10.0]) {
                    let mut points = points.clone();
                    points[at] += normal * (deviations[at] * times);
                    let first = data_findings(&points, false);
                    *found += usize::from(first.first().is_some_and(
                        |f| matches!(f, DataFinding::WrongDigit { index, .. } if *index == at),
                    ));
                }
            }
        }
    }
    // A detector that knows the deviation finds four of five errors of five deviations: the
    // threshold of the score is 4.1 for this number of points, and the noise of the point itself
    // adds one.
    assert!(100 * found[0] >= 55 * planted, "{found:?} of {planted}");
    assert!(100 * found[1] >= 98 * planted, "{found:?} of {planted}");
    assert!(100 * clean >= 98 * planted, "{clean} of {planted} without a false finding");
}

/// Aerofoils of few points: a nose that these do not resolve is neither a knuckle nor a wrong
/// digit; the same holds for the straight end of a trailing edge.
#[test]
fn unresolved_noses_are_no_findings() {
    for thickness in [0.02, 0.06, 0.12, 0.2] {
        for half in 8..40 {
            for power in [1.0, 1.5, 2.0] {
                let side = |k: i32| {
                    let u = f64::from(k.abs()) / f64::from(half);
                    let x = u.powf(power);
                    let y = 5.0
                        * thickness
                        * (0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
                            - 0.1036 * x.powi(4));
                    Vec3::of(x, (1e5 * y * f64::from(-k.signum())).round() / 1e5, 0.0)
                };
                let points: Vec<_> = (-half..=half).map(side).collect();
                let found = data_findings(&points, false);
                let nose = |f: &&DataFinding| matches!(f, DataFinding::Knuckle { .. });
                assert_eq!(found.iter().find(nose), None, "{thickness} {half} {power}");
            }
        }
    }
}

#[test]
fn a_knuckle_is_no_wrong_digit() {
    let mut g = Lcg::new(3);
    for angle in [10.0f64, 20.0, 40.0] {
        let (s, c) = (angle.to_radians() / 2.0).sin_cos();
        let points: Vec<_> = (0..41)
            .map(|i| {
                let t = f64::from(i) - 20.0;
                Vec3::of(c * t, -s * t.abs() + 0.002 * g.unit(), 0.0)
            })
            .collect();
        let found = data_findings(&points, false);
        let [DataFinding::Knuckle { index, angle: turn, .. }] = found[..] else {
            panic!("{angle}: {found:?}")
        };
        assert_eq!(index, 20);
        assert!((turn.to_degrees() - angle).abs() < 0.1 * angle, "{}", turn.to_degrees());
    }
}

/// Two published tables (Block Island Boat, Chapelle 1952, in feet-inches-eighths) with one wrong
/// reading each: the half-breadth of the sheer at station 8 and its height at station 13.
#[test]
fn wrong_readings_of_a_straight_frame() {
    // A row of eighths with a slip of an inch, as from a copied neighbour.
    let row: Vec<_> = (0..17)
        .map(|k| {
            let x = f64::from(k);
            let y = 40.0 + 0.09 * (x - 9.0) * (x - 9.0);
            let y = (8.0 * y).round() / 8.0 + if k == 12 { 1.0 } else { 0.0 };
            Vec3::of(12.0 * x, y, 0.0)
        })
        .collect();
    let found = data_findings(&row, false);
    assert!(
        matches!(found[..], [DataFinding::WrongDigit { index: 12, expected, .. }]
            if (expected.y - row[12].y + 1.0).abs() < 0.2),
        "{found:?}"
    );
}

/// In a short list a wrong digit is among the neighbours of all the others: it is set against the scale
/// that they have without it, wherever it is.
#[test]
fn a_wrong_digit_is_found_wherever_it_is() {
    let mut g = Lcg::new(12);
    for noise in [0.0, 1e-6, 1e-3, 1e-2] {
        for at in 1..14 {
            let height = |k: usize| noise * 2.0 * g.unit() + if k == at { 0.5 } else { 0.0 };
            let heights: Vec<f64> = (0..15).map(height).collect();
            let points: Vec<_> =
                heights.iter().enumerate().map(|(k, &y)| Vec3::of(k as f64, y, 0.0)).collect();
            let found = data_findings(&points, false);
            assert!(
                matches!(found.first(), Some(DataFinding::WrongDigit { index, .. }) if *index == at),
                "{noise} {at}: {found:?}"
            );
        }
    }
}

/// Few points of ordinary curves at ordinary spacings, with one off by ten predicted deviations at any
/// place but the two outermost.
#[test]
fn wrong_digits_of_short_lists() {
    let draws = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 200 } else { 6 };
    let mut g = Lcg::new(77);
    let (mut all, mut found, mut stray, mut clean) = (0, 0, 0, 0);
    for draw in 0..draws {
        for shape in 0..4 {
            for spacing in 0..4 {
                let n = [12, 15, 20, 30, 40][draw % 5];
                let last = (n - 1) as f64;
                let us: Vec<f64> = match spacing {
                    0 => (0..n).map(|k| k as f64 / last).collect(),
                    1 => {
                        let inner = |k: usize| if k.is_multiple_of(n - 1) { 0.0 } else { 0.7 };
                        (0..n).map(|k| (k as f64 + inner(k) * g.unit()) / last).collect()
                    }
                    2 => {
                        let quarter = n / 4;
                        let step = |k: usize| {
                            if k < quarter || k + quarter >= n - 1 { 0.5 } else { 1.0 }
                        };
                        let whole: f64 = (0..n - 1).map(step).sum();
                        (0..n).map(|k| (0..k).map(step).sum::<f64>() / whole).collect()
                    }
                    _ => {
                        let steps: Vec<f64> = (1..n).map(|_| 1.0 + 1.2 * g.unit()).collect();
                        let whole: f64 = steps.iter().sum();
                        (0..n).map(|k| steps[..k].iter().sum::<f64>() / whole).collect()
                    }
                };
                let size = [0.0, 1e-4, 1e-3][draw % 3];
                let mut points: Vec<_> = us
                    .iter()
                    .map(|&u| {
                        let (x, y) = match shape {
                            0 => (10.0 * u, 3.0 * u + 1.0),
                            1 => (10.0 * u, 4.0 * (u - 0.4) * (u - 0.4)),
                            2 => (5.0 * (1.5 * u).cos(), 5.0 * (1.5 * u).sin()),
                            _ => (5.0 * u, (4.0 * u * (1.0 - u)).powi(2) * (0.7 + 0.6 * u)),
                        };
                        Vec3::of(x + size * g.unit(), y + size * g.unit(), 0.0)
                    })
                    .collect();
                clean += usize::from(data_findings(&points, false).is_empty());
                let deviations = predicted(&points, false);
                let at = 2 + ((g.unit() + 0.5) * (n - 4) as f64) as usize;
                let along = points[at + 1] - points[at - 1];
                let normal = Vec3::of(-along.y, along.x, 0.0).normalized().unwrap();
                let sign = if draw % 2 == 0 { 10.0 } else { -10.0 };
                points[at] += normal * (deviations[at] * sign);
                let findings = data_findings(&points, false);
                let right = findings.iter().filter(|f| f.index() == at).count();
                all += 1;
                found += right;
                stray += findings.len() - right;
            }
        }
    }
    assert!(100 * found >= 95 * all, "{found} of {all}");
    assert!(100 * clean >= 99 * all, "{clean} of {all} without a false finding");
    assert!(100 * stray <= 2 * all, "{stray} false ones in {all}");
}

/// An error of the detectable size is found, a third of it is not, and the size is the same with
/// such an error present.
#[test]
fn what_is_detectable_is_found() {
    let (mut asked, mut found, mut early, mut same) = (0, 0, 0, 0);
    for (seed, n) in [(1, 14), (2, 20), (3, 31), (4, 48)] {
        let mut g = Lcg::new(300 + seed);
        for shape in ["sac", "ellipse", "hollow"] {
            let exact = (0..n).map(|k| shape_at(shape, f64::from(k) / f64::from(n - 1)));
            let size = 1e-4;
            let points: Vec<_> =
                exact.map(|p| p + Vec3::of(0.0, size * (g.unit() - 0.5), 0.0)).collect();
            let least = detectable(&points, false);
            for at in (3..n as usize - 3).step_by(3) {
                let along = points[at + 1] - points[at - 1];
                let normal = Vec3::of(-along.y, along.x, 0.0).normalized().unwrap();
                let with = |times: f64| {
                    let mut points = points.clone();
                    points[at] += normal * (times * least[at]);
                    points
                };
                let says = |points: &[Vec3<f64>]| {
                    data_findings(points, false).first().is_some_and(
                        |f| matches!(f, DataFinding::WrongDigit { index, .. } if *index == at),
                    )
                };
                asked += 1;
                found += usize::from(says(&with(1.5)));
                early += usize::from(says(&with(0.3)));
                let then = detectable(&with(3.0), false)[at];
                same += usize::from((then / least[at] - 1.0).abs() < 0.25);
            }
        }
    }
    assert!(100 * found >= 90 * asked, "{found} of {asked}");
    assert!(100 * early <= 3 * asked, "{early} of {asked}");
    assert!(100 * same >= 95 * asked, "{same} of {asked}");
}

/// Readings of a signal that are nearer to each other than their noise is wide: its turns are no corners, and a
/// spike is found.
#[test]
fn dense_noise_is_no_finding() {
    let n = 4_000;
    for (noise, seed) in [(0.01, 1), (0.05, 2), (0.3, 3)] {
        let mut g = Lcg::new(seed);
        let mut points: Vec<Vec3<f64>> = (0..n)
            .map(|i| 10.0 * i as f64 / (n - 1) as f64)
            .map(|x| Vec3::of(x, 2.0 * (0.7 * x).sin() + noise * gaussian(&mut g), 0.0))
            .collect();
        assert_eq!(data_findings(&points, false), [], "{noise}");
        points[1_234].y += 12.0 * noise;
        let found = data_findings(&points, false);
        assert!(
            matches!(found[..], [DataFinding::WrongDigit { index: 1_234, .. }]),
            "{noise}: {found:?}"
        );
    }
}
