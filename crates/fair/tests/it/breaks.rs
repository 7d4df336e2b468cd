//! Corners and wrong digits are distinguished, reported, and kept out of the fairing.

use crate::fixtures::*;
use moldloft_fair::*;
use moldloft_num::Vec3;

/// A roof with a 60 degree knuckle and noise.
fn knuckle(random: &mut Lcg) -> (Vec<Vec3<f64>>, usize) {
    let (s, c) = (std::f64::consts::FRAC_PI_6.sin(), std::f64::consts::FRAC_PI_6.cos());
    let points = (0..41)
        .map(|i| {
            let t = f64::from(i) - 20.0;
            Vec3::of(c * t, -s * t.abs(), 0.0) + Vec3::of(0.0, 0.03 * random.centred(), 0.0)
        })
        .collect();
    (points, 20)
}

#[test]
fn a_knuckle_is_found_and_kept_to_the_bit() {
    let (points, at) = knuckle(&mut Lcg::new(1));
    let plain = Job::of_points(3, points.clone(), false, 0.02).unwrap();
    let found = findings(&plain);
    let [Finding::Corner { index, turn }] = found[..] else { panic!("{found:?}") };
    assert_eq!(index, at);
    assert!((turn.y + 1.0).abs() < 0.1, "{turn:?}");
    // Without a mark it is rounded first; with it, it stays and the noise is removed.
    let first = KnotRemovalOptions { log: true, ..KnotRemovalOptions::faithful(1) };
    let smeared = knot_removal(&plain, &first).unwrap();
    assert!((smeared.log[0].index as usize).abs_diff(at) <= 1);
    let job = with_findings(&plain, &found);
    for points_after in [
        knot_removal(&job, &KnotRemovalOptions::faithful(410)).unwrap().points,
        optimum(&job, &OptimumOptions::of(Measure::Second)).unwrap().points,
        optimum(&job, &OptimumOptions::of(Measure::Jumps)).unwrap().points,
    ] {
        assert!(points_after[at].bits_eq(points[at]));
        let before = job.value(Measure::Jumps, &points).unwrap();
        let after = job.value(Measure::Jumps, &points_after).unwrap();
        assert!(after < 0.02 * before, "{before} {after}");
    }
}

#[test]
fn a_wrong_digit_is_reported_and_not_smeared() {
    for closed in [false, true] {
        let f = if closed { f3() } else { f2b() };
        let mut points = f.points.clone();
        let error = Vec3::of(0.0, 60.0 * f.tolerance, 0.0);
        points[23] += error;
        let job = Job::of_points(3, points.clone(), f.closed, f.tolerance).unwrap();
        let found = findings(&job);
        let [Finding::Outlier { index: 23, error: e }] = found[..] else { panic!("{found:?}") };
        assert!((e - error).norm() < 2.0 * f.tolerance, "{e:?}");
        let best = |job: &Job| optimum(job, &OptimumOptions::of(Measure::Second)).unwrap().points;
        let faired = best(&with_findings(&job, &found));
        let clean = best(&Job::of_points(3, f.points.clone(), f.closed, f.tolerance).unwrap());
        let smeared = best(&job);
        // The neighbours end where they would without the error.
        let off = |p: &[Vec3<f64>]| rms(&p[20..23], &clean[20..23]);
        assert!(off(&faired) < 0.6 * f.tolerance && off(&smeared) > 0.9 * f.tolerance);
        assert!((faired[23] - f.truth[23]).norm() < 2.5 * f.tolerance);
    }
}

#[test]
fn several_are_found_and_noise_is_not() {
    for f in all() {
        let job = Job::of_points(3, f.points.clone(), f.closed, f.tolerance).unwrap();
        assert_eq!(findings(&job), [], "{}", f.name);
    }
    let (mut points, at) = knuckle(&mut Lcg::new(3));
    points[9].y += 2.0;
    points[31].x -= 1.5;
    let job = Job::of_points(3, points, false, 0.02).unwrap();
    let mut found: Vec<_> = findings(&job)
        .into_iter()
        .map(|f| match f {
            Finding::Corner { index, .. } => (index, true),
            Finding::Outlier { index, .. } => (index, false),
        })
        .collect();
    found.sort_unstable();
    assert_eq!(found, [(9, false), (at, true), (31, false)]);
}
