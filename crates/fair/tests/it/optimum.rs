//! The optimum against the figures of the fixtures, and its laws.

use crate::fixtures::*;
use moldloft_fair::*;
use moldloft_num::{Order, Vec3};

fn job(f: &Fixture) -> Job {
    Job::of_points(3, f.points.clone(), f.closed, f.tolerance).unwrap()
}

fn best(job: &Job, measure: Measure) -> Optimum {
    optimum(job, &OptimumOptions::of(measure)).unwrap()
}

#[test]
fn the_optimum_row_of_the_table() {
    // Second differences, squared jumps, jump lengths (and the number of non-zero ones), rms error.
    let table: [(Fixture, f64, usize, Option<[f64; 2]>, usize, f64); 5] = [
        (f1a(), 1.30816311e-4, 14, Some([3.2333e-10, 9.830e-5]), 10, 7.26e-5),
        (f1b(), 1.29637452e-4, 12, Some([6.8630e-9, 3.078e-4]), 14, 4.82e-4),
        (f2a(), 1.98586493e-6, 23, Some([9.3875e-9, 4.182e-4]), 11, 8.16e-5),
        (f2b(), 1.93909366e-6, 11, Some([8.4941e-9, 4.048e-4]), 8, 13.5e-5),
        (f3(), 5.92044830e-3, 19, None, 0, 1.47e-3),
    ];
    for (f, second, active, others, corners, truth) in table {
        let job = job(&f);
        let result = best(&job, Measure::Second);
        near(f.name, result.certificate.value, second, 1e-6);
        near(f.name, job.value(Measure::Second, &result.points).unwrap(), second, 1e-6);
        assert!(result.certificate.relative() <= 1e-9, "{:?}", result.certificate);
        // The rounded sections have limits that are touched without a force.
        assert!(result.active.abs_diff(active) <= 2, "{} {}", f.name, result.active);
        near(f.name, rms(&result.points, &f.truth), truth, 0.1);
        let far = deviation(&job, &result.points);
        assert!(far.control <= f.tolerance && far.certified <= f.tolerance);
        assert!((0.86..=1.0).contains(&(far.sampled / f.tolerance)), "{far:?}");
        let Some([squares, lengths]) = others else { continue };
        near(f.name, best(&job, Measure::Jumps).certificate.value, squares, 1e-3);
        let few = best(&job, Measure::JumpLengths);
        near(f.name, few.certificate.value, lengths, 1e-3);
        let jumps = KnotJumps::of(&job.space).lengths(&few.points);
        let largest = jumps.iter().copied().fold(0.0, f64::max);
        let kept = jumps.iter().filter(|&&j| j > 1e-3 * largest).count();
        assert!(kept.abs_diff(corners) <= 1, "{} {kept}", f.name);
    }
}

/// Long sequences of ranked steps and the solver have the same result.
#[test]
fn steps_converge_to_the_optimum() {
    for f in [f2a(), f2b(), f3()] {
        let job = job(&f);
        let stepped = knot_removal(&job, &KnotRemovalOptions::faithful(200_000)).unwrap();
        let solved = best(&job, Measure::Second);
        assert!(rms(&stepped.points, &solved.points) < 1e-3 * f.tolerance);
        let value = job.value(Measure::Second, &stepped.points).unwrap();
        near(f.name, value, solved.certificate.value, 1e-8);
    }
}

/// The certificate is a bound: no better curve lowers the measure by more.
#[test]
fn the_certificate_bounds_the_true_gap() {
    for f in all() {
        let job = job(&f);
        let least = best(&job, Measure::Second).certificate.value;
        let rows = job.measure_rows(Measure::Second).unwrap();
        for steps in [0, 1, 3, 10] {
            let result =
                knot_removal(&job, &KnotRemovalOptions::faithful(steps * f.points.len())).unwrap();
            let gap = ball_gap(&job, &rows, RowNorm::Square, &result.points);
            assert!(gap.gap >= gap.value - least - 1e-12 * least, "{}", f.name);
        }
        let done = best(&job, Measure::Second);
        let own = ball_gap(&job, &rows, RowNorm::Square, &done.points);
        assert!(own.relative() < 1e-8, "{} {own:?}", f.name);
    }
}

/// Optimality by its definition: at free points the slope vanishes, on a sphere it points outward.
#[test]
fn the_slope_is_against_the_displacement_on_active_spheres() {
    for f in all() {
        let job = job(&f);
        let result = optimum(
            &job,
            &OptimumOptions { accuracy: 1e-12, ..OptimumOptions::of(Measure::Second) },
        );
        let points = result.unwrap().points;
        let rows = job.measure_rows(Measure::Second).unwrap();
        let mut slope = vec![Vec3::zero(); points.len()];
        rows.add_transposed(|k| rows.apply(k, &points), &mut slope);
        let frozen = job.frozen();
        let largest = slope.iter().map(|g| g.norm()).fold(0.0, f64::max);
        for i in (0..points.len()).filter(|&i| !frozen[i]) {
            let moved = points[i] - f.points[i];
            if slope[i].norm() > 1e-3 * largest {
                assert!(moved.norm() > f.tolerance * (1.0 - 1e-6), "{} {i}", f.name);
                let cosine = slope[i].dot(moved) / (slope[i].norm() * moved.norm());
                assert!(cosine < -1.0 + 1e-5, "{} {i} {cosine}", f.name);
            }
        }
    }
}

#[test]
fn a_bound_on_bezier_points_uses_the_tolerance_better() {
    let f = f1b();
    let job = job(&f);
    for measure in Measure::ALL {
        let options = OptimumOptions { bound: Bound::Bezier, ..OptimumOptions::of(measure) };
        let result = optimum(&job, &options).unwrap();
        assert!(result.certificate.value < best(&job, measure).certificate.value);
        assert!(result.certificate.relative() < 1e-7, "{measure:?} {:?}", result.certificate);
        let far = deviation(&job, &result.points);
        assert!(far.certified <= f.tolerance * (1.0 + 1e-12) && far.control > 1.1 * f.tolerance);
        assert!(far.sampled > 0.95 * f.tolerance);
    }
}

#[test]
fn cubics_and_lines_are_fixed_points() {
    let cubic = |i: i32| {
        let t = f64::from(i) * 0.1;
        Vec3::of(t, t * t * t - t * t, 0.3 * t)
    };
    let points: Vec<_> = (0..20).map(cubic).collect();
    let job = Job::of_points(3, points.clone(), false, 0.01).unwrap();
    for measure in [Measure::Jumps, Measure::JumpLengths] {
        let result = best(&job, measure);
        assert!(rms(&result.points, &points) < 1e-4, "{measure:?}");
        assert!(result.certificate.value < 1e-13, "{measure:?} {:?}", result.certificate);
    }
    let stepped = knot_removal(&job, &KnotRemovalOptions::faithful(100)).unwrap();
    assert!(rms(&stepped.points, &points) < 1e-14);
    let line: Vec<_> = (0..20).map(|i| Vec3::of(f64::from(i), 2.0 * f64::from(i), 1.0)).collect();
    let job = Job::of_points(3, line.clone(), false, 0.01).unwrap();
    for measure in Measure::ALL {
        assert_eq!(job.value(measure, &best(&job, measure).points).unwrap().round(), 0.0);
    }
}

#[test]
fn results_turn_scale_and_reverse_with_the_curve() {
    let f = f2b();
    let result = best(&job(&f), Measure::Second).points;
    let (s, c) = (0.6, 0.8);
    let turned = |p: &Vec3<f64>| {
        Vec3::of(5.0 * (c * p.x - s * p.y) + 3.0, 5.0 * (s * p.x + c * p.y) - 1.0, 5.0 * p.z + 2.0)
    };
    let points: Vec<_> = f.points.iter().map(turned).collect();
    let other =
        best(&Job::of_points(3, points, false, 5.0 * f.tolerance).unwrap(), Measure::Second);
    let wanted: Vec<_> = result.iter().map(turned).collect();
    assert!(rms(&other.points, &wanted) < 1e-6 * f.tolerance * 5.0 * 100.0);

    let back: Vec<_> = f.points.iter().rev().copied().collect();
    let mut other =
        best(&Job::of_points(3, back, false, f.tolerance).unwrap(), Measure::Second).points;
    other.reverse();
    assert!(rms(&other, &result) < 1e-4 * f.tolerance);

    let f = f3();
    let result = best(&job(&f), Measure::Second).points;
    let mut shifted = f.points.clone();
    shifted.rotate_left(9);
    let job = Job::of_points(3, shifted, true, f.tolerance).unwrap();
    let mut other = best(&job, Measure::Second).points;
    other.rotate_right(9);
    assert!(rms(&other, &result) < 1e-4 * f.tolerance);
}

#[test]
fn boxes_stations_and_planes_limit_the_motion() {
    let f = f2b();
    let mut job = job(&f);
    let radii = vec![f.tolerance; f.points.len()];
    let moved = |job: &Job| {
        let points = best(job, Measure::Second).points;
        points.iter().zip(&f.points).map(|(p, q)| *p - *q).collect::<Vec<_>>()
    };
    job.limit = Limit::new(Motion::Along(Vec3::of(0.0, 2.0, 0.0)), radii.clone()).unwrap();
    let along = moved(&job);
    assert!(along.iter().all(|m| m.x == 0.0 && m.z == 0.0 && m.y.abs() <= f.tolerance));
    assert!(along.iter().any(|m| m.y.abs() > 0.99 * f.tolerance));
    job.limit = Limit::new(Motion::Across(Vec3::of(0.0, 0.0, 1.0)), radii.clone()).unwrap();
    assert!(moved(&job).iter().all(|m| m.norm() <= f.tolerance));
    job.limit = Limit::new(Motion::Box, radii).unwrap();
    let boxed = best(&job, Measure::Second);
    assert!(boxed.certificate.relative() < 1e-9);
    let ball = Job::of_points(3, f.points.clone(), false, f.tolerance).unwrap();
    assert!(boxed.certificate.value <= best(&ball, Measure::Second).certificate.value);
    // Ranked steps agree in each kind of motion.
    for motion in [Motion::Box, Motion::Along(Vec3::of(0.0, 1.0, 0.0))] {
        job.limit.motion = motion;
        let stepped = knot_removal(&job, &KnotRemovalOptions::faithful(200_000)).unwrap().points;
        assert!(rms(&stepped, &best(&job, Measure::Second).points) < 1e-3 * f.tolerance);
    }
}

#[test]
fn conditions_hold_and_contradictions_are_named() {
    let f = f2b();
    let job = job(&f);
    let at = shape::sample_at(&job.space, &f.points, None, 28.5);
    let target = at.point + Vec3::of(0.0, 0.5 * f.tolerance, 0.0);
    let mut options = OptimumOptions::of(Measure::Second);
    options.conditions = Condition::point(&job.space, 28.5, target);
    options.conditions.extend(Condition::tangent(&job.space, 10.25, Vec3::of(1.0, 0.1, 0.0)));
    let result = optimum(&job, &options);
    // The given tangent is far from the curve's: those conditions are named.
    let Err(FairError::Contradiction { conditions, .. }) = result else { panic!("{result:?}") };
    assert!(conditions.iter().all(|&c| c < 5), "{conditions:?}");
    assert!(!conditions.is_empty());

    options.conditions = Condition::point(&job.space, 28.5, target);
    let result = optimum(&job, &options).unwrap();
    let now = shape::sample_at(&job.space, &result.points, None, 28.5);
    assert!((now.point - target).norm() < 1e-9 * f.tolerance.max(1.0));
    assert!(result.certificate.relative() < 1e-8);
    assert!(result.certificate.value > best(&job, Measure::Second).certificate.value);
}

/// Two different points at one parameter of the curve are a contradiction, however close they are,
/// and give no result.
#[test]
fn no_contradiction_passes() {
    for f in [f2a(), f2b(), f3()] {
        let job = job(&f);
        for (t, apart) in [(28.5, 1e-1), (20.0, 1e-4), (7.25, 1e-5), (28.5, 1e-3)] {
            let at = shape::sample_at(&job.space, &f.points, None, t).point;
            for bound in [Bound::ControlPoints, Bound::Bezier] {
                let mut options = OptimumOptions { bound, ..OptimumOptions::of(Measure::Second) };
                for y in [0.0, apart] {
                    let there = at + Vec3::of(0.0, y, 0.0);
                    options.conditions.extend(Condition::point(&job.space, t, there));
                }
                let result = optimum(&job, &options);
                let Err(FairError::Contradiction { conditions, .. }) = result else {
                    panic!("{} {t} {apart} {bound:?}: {result:?}", f.name)
                };
                assert!(conditions.contains(&1) || conditions.contains(&4), "{conditions:?}");
            }
        }
    }
}

/// Free, position, tangent and curvature ends of a spline with simple end knots.
#[test]
fn ends_are_kept_as_asked() {
    let f = f2b();
    let mut last = 0.0;
    for (end, kept) in [
        (EndContinuity::Free, 0),
        (EndContinuity::Position, 1),
        (EndContinuity::Tangent, 2),
        (EndContinuity::Curvature, 3),
    ] {
        let mut job = job(&f);
        job.ends = [end, end];
        let result = best(&job, Measure::Second);
        let (start, stop) = job.space.domain();
        for t in [start, stop] {
            for (k, order) in [Order::Zero, Order::First, Order::Second].into_iter().enumerate() {
                let at = |p: &[Vec3<f64>]| -> Vec3<f64> {
                    let three = Condition::derivative(&job.space, t, order, Vec3::zero());
                    Vec3::of(three[0].at(p), three[1].at(p), three[2].at(p))
                };
                let off = (at(&result.points) - at(&f.points)).norm();
                assert_eq!(off < 1e-12, k < kept, "{end:?} {k} {off}");
            }
        }
        assert!(result.certificate.value > last);
        last = result.certificate.value;
        let stepped = knot_removal(&job, &KnotRemovalOptions::faithful(50)).unwrap();
        let fixed = if kept == 0 { 0 } else { 3 };
        for i in 0..fixed {
            assert!(stepped.points[i].bits_eq(f.points[i]));
        }
    }
}

#[test]
fn a_closed_curve_can_keep_centroid_and_area() {
    let f = f3();
    let job = job(&f);
    let normal = Vec3::of(0.0, 0.0, 1.0);
    let area = |p: &[Vec3<f64>]| 0.5 * Condition::area(&job.space, p, normal).at(p);
    near("area of a circle", area(&f.truth), std::f64::consts::PI, 0.01);
    let mut options = OptimumOptions::of(Measure::Second);
    options.conditions = Condition::centroid(&f.points);
    options.conditions.push(Condition::area(&job.space, &f.points, normal));
    let kept = optimum(&job, &options).unwrap();
    let free = best(&job, Measure::Second);
    let lost = |p: &[Vec3<f64>]| (area(p) / area(&f.points) - 1.0).abs();
    assert!(lost(&free.points) > 1e-3 && lost(&kept.points) < 1e-5);
    for c in Condition::centroid(&f.points) {
        assert!((c.at(&kept.points) - c.value).abs() < 1e-10);
    }
    // The figures of a faired circle without that condition.
    for (k, wanted) in [(1, 0.99979), (3, 0.99959), (10, 0.99909), (100, 0.99712)] {
        let steps = knot_removal(&job, &KnotRemovalOptions::faithful(64 * k)).unwrap();
        let ratio = area(&steps.points) / area(&f.points);
        assert!((ratio - wanted).abs() < 2e-4, "{k} {ratio}");
    }
}

#[test]
fn all_degrees_knots_and_weights() {
    let mut random = Lcg::new(33);
    for degree in [2, 3, 4, 5, 7] {
        let mut knots = vec![0.0; degree + 1];
        for k in 1..20 {
            knots.push(f64::from(k) + 0.8 * random.centred());
        }
        knots.extend(vec![20.0; degree + 1]);
        let space = Space::open(moldloft_spline::KnotVector::new(degree, knots).unwrap()).unwrap();
        let n = space.count();
        let points: Vec<_> = (0..n)
            .map(|i| {
                Vec3::of(
                    i as f64 + 0.1 * random.centred(),
                    0.1 * random.centred(),
                    0.1 * random.centred(),
                )
            })
            .collect();
        let weights: Vec<_> = (0..n).map(|_| 1.0 + 0.5 * random.centred()).collect();
        for weights in [None, Some(weights)] {
            let mut job = Job::new(space.clone(), points.clone(), 0.03).unwrap();
            job.weights = weights;
            for bound in [Bound::ControlPoints, Bound::Bezier] {
                for measure in Measure::ALL {
                    if degree < 3 && matches!(measure, Measure::Third | Measure::Variation) {
                        continue;
                    }
                    let options = OptimumOptions { bound, ..OptimumOptions::of(measure) };
                    let result = optimum(&job, &options).unwrap();
                    let relative = result.certificate.relative();
                    assert!(relative < 1e-5, "{degree} {bound:?} {measure:?} {relative}");
                    let far = deviation(&job, &result.points);
                    assert!(far.certified <= 0.03 * (1.0 + 1e-9), "{degree} {far:?}");
                    assert!(far.sampled <= far.certified);
                    assert!(result.points[0].bits_eq(points[0]));
                }
            }
        }
    }
}

/// Dense sampling never finds more than the certified distance: random curves of all kinds.
#[test]
fn the_certified_deviation_is_never_exceeded() {
    let mut random = Lcg::new(77);
    let count = moldloft_testing::rounds(1_000, 10_000);
    for round in 0..count {
        let degree = 2 + round % 4;
        let n = 12 + round % 9;
        let point =
            |random: &mut Lcg| Vec3::of(random.centred(), random.centred(), random.centred());
        let points: Vec<_> = (0..n).map(|_| point(&mut random)).collect();
        let tolerance = 0.3 * (random.centred() + 0.5);
        let mut job = Job::of_points(degree, points, round % 3 == 0, tolerance).unwrap();
        if round % 5 == 0 {
            job.weights = Some((0..n).map(|_| 1.0 + random.centred()).collect());
        }
        let result = if round % 2 == 0 {
            knot_removal(&job, &KnotRemovalOptions::faithful(3 * n)).unwrap().points
        } else {
            let options = OptimumOptions {
                bound: Bound::Bezier,
                accuracy: 1e-4,
                ..OptimumOptions::of(Measure::Second)
            };
            optimum(&job, &options).unwrap().points
        };
        let far = deviation(&job, &result);
        assert!(far.sampled <= far.certified, "{round} {far:?}");
        assert!(far.certified <= tolerance * (1.0 + 1e-9), "{round} {far:?} {tolerance}");
    }
}

#[test]
fn no_tolerance_gives_the_polynomial_of_the_ends() {
    let f = f2b();
    let job = Job::of_points(3, f.points, false, f64::INFINITY).unwrap();
    let result = best(&job, Measure::Second);
    assert!(job.value(Measure::Jumps, &result.points).unwrap() < 1e-18);
    assert_eq!(shape::inflections(&shape::samples(&job.space, &result.points, None, 16)) / 2, 0);
}

/// A neighbour's last Bézier points, and the curvature vector at a common end.
fn bend(first: Vec3<f64>, second: Vec3<f64>) -> Vec3<f64> {
    first.cross(second) * first.norm().powi(-3)
}

#[test]
fn a_seam_gets_continuous_curvature_at_either_end() {
    let f = f2b();
    let space = Space::clamped(3, f.points.len()).unwrap();
    for at_end in [false, true] {
        let mut job = Job::new(space.clone(), f.points.clone(), 2e-3).unwrap();
        job.ends = [EndContinuity::Free, EndContinuity::Free];
        let n = f.points.len();
        let (p, inner) =
            if at_end { (f.points[n - 1], f.points[n - 2]) } else { (f.points[0], f.points[1]) };
        // The neighbour continues at an angle and with another curvature.
        let step = p - inner;
        let a1 = p + step * 1.3 + Vec3::of(0.0, 2e-4, 0.0);
        let a2 = a1 + step * 1.2 + Vec3::of(0.0, -3e-4, 1e-4);
        let mut options = OptimumOptions::of(Measure::Second);
        options.conditions = Condition::seam(&space, &f.points, [a2, a1, p], at_end).unwrap();
        let result = optimum(&job, &options).unwrap();
        let (start, end) = space.domain();
        let t = if at_end { end } else { start };
        let s = shape::sample_at(&space, &result.points, None, t);
        assert!((s.point - p).norm() < 1e-12);
        // The neighbour runs towards p; at the own end the own curve runs towards p too.
        let toward = if at_end { -1.0 } else { 1.0 };
        let (first, second) = ((p - a1) * (3.0 * toward), (p - a1 * 2.0 + a2) * 6.0);
        let (own, other) = (bend(s.derivatives[0], s.derivatives[1]), bend(first, second));
        assert!((own - other).norm() < 1e-6 * other.norm(), "{own:?} {other:?}");
        let cosine = s.derivatives[0].dot(first) / (s.derivatives[0].norm() * first.norm());
        assert!(cosine > 1.0 - 1e-12, "{cosine}");
        let none = Condition::seam(&space, &f.points, [a2, p, p], at_end);
        assert_eq!(none, Err(FairError::Singular));
    }
}

/// A small change of the input is a small change of the result, however the limits interact.
#[test]
fn the_optimum_is_continuous() {
    let f = f1b();
    let base = best(&job(&f), Measure::Second).points;
    let mut random = Lcg::new(9);
    for _ in 0..20 {
        let by = 1e-8;
        let shaken: Vec<_> = f
            .points
            .iter()
            .map(|p| *p + Vec3::of(by * random.centred(), by * random.centred(), 0.0))
            .collect();
        let job = Job::of_points(3, shaken, false, f.tolerance).unwrap();
        let other = best(&job, Measure::Second).points;
        assert!(rms(&base, &other) < 3e-3 * f.tolerance, "{}", rms(&base, &other));
    }
}

#[test]
fn no_scale_is_special_and_no_tolerance_is_the_identity() {
    let f = f2b();
    for scale in [1e-12, 1e-6, 1e6, 1e12] {
        let points: Vec<_> = f.points.iter().map(|p| *p * scale).collect();
        let job = Job::of_points(3, points.clone(), false, f.tolerance * scale).unwrap();
        let result = best(&job, Measure::Second);
        near("scaled", result.certificate.value, 1.93909366e-6 * scale * scale, 1e-6);
        assert!(result.certificate.relative() < 1e-8);
        let steps = knot_removal(&job, &KnotRemovalOptions::faithful(610)).unwrap();
        near(
            "scaled",
            job.value(Measure::Second, &steps.points).unwrap(),
            1.967644e-6 * scale * scale,
            1e-3,
        );
        let still = Job::of_points(3, points.clone(), false, 0.0).unwrap();
        for measure in Measure::ALL {
            assert_eq!(best(&still, measure).points, points);
        }
    }
    // Far from the origin only the rounding of the coordinates is lost.
    let far: Vec<_> = f.points.iter().map(|p| *p + Vec3::of(1e4, -1e4, 0.0)).collect();
    let job = Job::of_points(3, far, false, f.tolerance).unwrap();
    near("far", best(&job, Measure::Second).certificate.value, 1.93909366e-6, 1e-5);
}
