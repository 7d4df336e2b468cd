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

#[test]
fn wrong_digits_are_found_at_their_place() {
    let seeds = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 1..30 } else { 1..5 };
    let (mut planted, mut found, mut clean, mut cases) = (0, 0, 0, 0);
    for seed in seeds {
        for shape in ["clothoid", "hollow", "ellipse", "sac", "helix"] {
            for kind in ["even", "half", "jitter"] {
                let (_, mut points, _) = case(shape, kind, seed);
                cases += 1;
                clean += usize::from(data_findings(&points, false).is_empty());
                let least = detectable(&points, false);
                let at = 6 + (seed as usize * 7) % 36;
                // Ten predicted deviations, across the curve; SCORE of them are proposed.
                let along = points[at + 1] - points[at - 1];
                let normal = Vec3::of(-along.y, along.x, 0.0).normalized().unwrap();
                points[at] += normal * (least[at] * 10.0 / 6.0);
                planted += 1;
                let first = data_findings(&points, false);
                found += usize::from(first.first().is_some_and(
                    |f| matches!(f, DataFinding::WrongDigit { index, .. } if *index == at),
                ));
            }
        }
    }
    assert!(100 * found >= 95 * planted, "{found} of {planted}");
    assert!(100 * clean >= 97 * cases, "{clean} of {cases} without a false finding");
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
    // A row of eighths with a slip of an inch: what a copied neighbour looks like.
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
