//! Fitting before fairing.

use crate::fixtures::*;
use moldloft_fair::*;
use moldloft_num::Vec3;

#[test]
fn interpolation_meets_every_point() {
    let circle: Vec<_> = (0..24)
        .map(|i| f64::from(i) * 0.26 + 0.01 * f64::from(i * i % 7))
        .map(|a| Vec3::of(a.cos(), a.sin(), 0.1 * a))
        .collect();
    for points in [naca(), waisted(), circle] {
        for spacing in
            [ParameterSpacing::Uniform, ParameterSpacing::Chord, ParameterSpacing::Centripetal]
        {
            for degree in [1, 2, 3, 5] {
                let fit = interpolate(degree, &points, spacing, false).unwrap();
                assert!(fit.largest < 1e-12, "{degree} {spacing:?} {}", fit.largest);
                assert!(fit.points[0].bits_eq(points[0]));
            }
        }
    }
    let f = f3();
    for degree in [2, 3, 4, 5] {
        let fit = interpolate(degree, &f.points, ParameterSpacing::Chord, true).unwrap();
        assert!(fit.largest < 1e-12 && fit.space.is_closed(), "{degree} {}", fit.largest);
    }
}

/// Exact data of a cubic are met by any fit; noise shrinks as the root of the ratio of counts.
#[test]
fn least_squares_reproduces_and_averages() {
    let cubic = |i: i32| {
        let t = f64::from(i) / 99.0;
        Vec3::of(t, t * t * t - 0.3 * t, 2.0 * t)
    };
    let points: Vec<_> = (0..100).map(cubic).collect();
    let fit = least_squares(3, &points, 12, ParameterSpacing::Uniform, false).unwrap();
    assert!(fit.largest < 1e-13, "{}", fit.largest);

    let f = f3();
    let smooth = least_squares(3, &f.points, 16, ParameterSpacing::Uniform, true).unwrap();
    let radius = |p: Vec3<f64>| (p.norm() - 1.0).abs();
    let samples = shape::samples(&smooth.space, &smooth.points, None, 10);
    assert!(samples.iter().all(|s| radius(s.point) < 1.5e-3));
    assert!(smooth.rms < 0.8e-3 && smooth.rms > 0.5e-3, "{}", smooth.rms);
}

/// The trace of the notes: a noisy section interpolated, then faired.
#[test]
fn interpolated_then_faired() {
    let mut random = Lcg::new(1);
    let points: Vec<_> =
        naca().iter().map(|p| *p + Vec3::of(0.0, 3e-4 * random.centred(), 0.0)).collect();
    let fit = interpolate(3, &points, ParameterSpacing::Centripetal, false).unwrap();
    let job = Job::new(fit.space, fit.points.clone(), 3e-4).unwrap();
    let before = job.value(Measure::Jumps, &fit.points).unwrap();
    let faithful = knot_removal(&job, &KnotRemovalOptions::faithful(fit.points.len())).unwrap();
    assert!(job.value(Measure::Jumps, &faithful.points).unwrap() < 0.1 * before);
    let best = optimum(&job, &OptimumOptions::of(Measure::Jumps)).unwrap();
    assert!(job.value(Measure::Jumps, &best.points).unwrap() < 1e-3 * before);
    assert!(deviation(&job, &best.points).certified <= 3e-4);
}

#[test]
fn bad_data_are_refused() {
    let line: Vec<_> = (0..9).map(|i| Vec3::of(f64::from(i), 0.0, 0.0)).collect();
    let mut twice = line.clone();
    twice[4] = twice[3];
    let refused = interpolate(3, &twice, ParameterSpacing::Chord, false);
    assert_eq!(refused, Err(FairError::Coincident { first: 3 }));
    assert!(interpolate(3, &twice, ParameterSpacing::Uniform, false).is_ok());
    let few = interpolate(3, &line[..4], ParameterSpacing::Chord, false);
    assert_eq!(few, Err(FairError::TooFew { expected: 5, actual: 4 }));
    let more = least_squares(3, &line, 10, ParameterSpacing::Chord, false);
    assert_eq!(more, Err(FairError::TooFew { expected: 10, actual: 9 }));
    let mut nan = line.clone();
    nan[2].z = f64::INFINITY;
    assert_eq!(
        parameters(&nan, ParameterSpacing::Chord, true),
        Err(FairError::NotFinite { index: 2 })
    );
    let gap = fit(
        Space::clamped(3, 9).unwrap(),
        &line,
        vec![0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 1.0],
        &[1.0; 9],
    );
    assert_eq!(gap, Err(FairError::Singular));
    let weight = fit(
        Space::clamped(3, 5).unwrap(),
        &line,
        parameters(&line, ParameterSpacing::Chord, false).unwrap(),
        &[0.0; 9],
    );
    assert_eq!(weight, Err(FairError::Weight { index: 0, weight: 0.0 }));
}

/// A circle from its own points: with the weights of the rational quadratic circle the fit is exact.
#[test]
fn rational_fits_keep_their_weights() {
    let knots = [0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0].to_vec();
    let space = Space::open(moldloft_spline::KnotVector::new(2, knots).unwrap()).unwrap();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let weights = [1.0, half, 1.0, half, 1.0];
    let exact = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)]
        .map(|(x, y)| Vec3::of(x, y, 0.0));
    for count in [5, 40] {
        let at: Vec<f64> = (0..count).map(|k| k as f64 / (count - 1) as f64).collect();
        let data: Vec<_> =
            at.iter().map(|&t| shape::sample_at(&space, &exact, Some(&weights), t).point).collect();
        let fit = fit_rational(space.clone(), &data, at, &weights).unwrap();
        assert!(fit.largest < 1e-14, "{}", fit.largest);
        for (p, q) in fit.points.iter().zip(&exact) {
            assert!((*p - *q).norm() < 1e-12);
        }
        let refused = fit_rational(space.clone(), &data, fit.parameters.clone(), &[1.0; 4]);
        assert_eq!(
            refused.unwrap_err(),
            FairError::Count { what: "weights", expected: 5, actual: 4 }
        );
        let refused =
            fit_rational(space.clone(), &data, fit.parameters, &[1.0, 1.0, 0.0, 1.0, 1.0]);
        assert_eq!(refused.unwrap_err(), FairError::Weight { index: 2, weight: 0.0 });
    }
}
