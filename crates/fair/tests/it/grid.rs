//! Grids of data at any spacing: exact data do not move, tolerances hold, derivatives agree with
//! differences.

use moldloft_fair::*;
use moldloft_num::{Dual4, Real, Vec3};
use moldloft_testing::Lcg;

fn uneven(random: &mut Lcg, n: usize, ratio: f64) -> Vec<f64> {
    let mut at = vec![0.0];
    for _ in 1..n {
        let step = ratio.powf(random.centred());
        at.push(at[at.len() - 1] + step);
    }
    let last = at[n - 1];
    at.into_iter().map(|t| t / last).collect()
}

fn data(points: &[Vec3<f64>], shape: [usize; 2], tolerance: f64, motion: Motion) -> GridData {
    spaced(
        points,
        shape,
        tolerance,
        motion,
        grid_spacing(
            points,
            shape,
            ParameterSpacing::Chord,
            [false; 2],
            &vec![tolerance; points.len()],
        ),
    )
}

fn spaced(
    points: &[Vec3<f64>],
    shape: [usize; 2],
    tolerance: f64,
    motion: Motion,
    spacing: [ParameterSpacing; 2],
) -> GridData {
    let radii = vec![tolerance; points.len()];
    let at = grid_parameters(points, shape, spacing, [false; 2], (motion, &radii)).unwrap();
    GridData {
        limit: Limit::new(motion, vec![tolerance; points.len()]).unwrap(),
        layouts: at.map(|at| InterpolationSpace::new(3, &at, &[], false).unwrap()),
        rims: [[EndContinuity::Free; 2]; 2],
        points: points.to_vec(),
    }
}

fn along_y() -> Motion {
    Motion::Along(Vec3::of(0.0, 1.0, 0.0))
}

/// Offsets over stations and waterlines; chords across the offsets are the stations themselves.
fn offsets(xs: &[f64], zs: &[f64], y: impl Fn(f64, f64) -> f64) -> Vec<Vec3<f64>> {
    xs.iter()
        .flat_map(|&x| zs.iter().map(move |&z| (x, z)))
        .map(|(x, z)| Vec3::of(x, y(x, z), z))
        .collect()
}

#[test]
fn what_is_fair_does_not_move() {
    let mut random = Lcg::new(5);
    for ratio in [1.0, 4.0, 100.0] {
        let (xs, zs) = (uneven(&mut random, 12, ratio), uneven(&mut random, 8, ratio));
        for goal in [Goal::Near(0.8), Goal::Fairest] {
            for measure in [Measure::Variation, Measure::Third] {
                // No more than quadratic in either direction: nothing to gain.
                let points = offsets(&xs, &zs, |x, z| (1.0 - x * x) * (0.3 + z - 0.5 * z * z));
                for motion in [along_y(), Motion::Ball] {
                    let data = data(&points, [12, 8], 0.01, motion);
                    let made = fair_grid(&data, measure, goal, &[], 1e-9).unwrap();
                    let moved = made.residuals.iter().copied().fold(0.0, f64::max);
                    assert!(moved < 1e-12, "{ratio} {goal:?} {measure:?} {motion:?} {moved:e}");
                }
            }
        }
        // A tilted plane, in any direction of motion.
        let points = offsets(&xs, &zs, |x, z| 0.2 + 0.5 * x - 0.3 * z);
        let data = data(&points, [12, 8], 0.01, Motion::Ball);
        let made = fair_grid(&data, Measure::Bending, Goal::Fairest, &[], 1e-9).unwrap();
        let moved = made.residuals.iter().copied().fold(0.0, f64::max);
        assert!(moved < 1e-12, "{ratio} {moved:e}");
    }
}

#[test]
fn noise_goes_and_tolerances_hold() {
    let xs: Vec<f64> = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0, 9.5, 10.0]
        .iter()
        .map(|s| s / 5.0 - 1.0)
        .collect();
    let zs: Vec<f64> = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.25].iter().map(|z| z / 1.25).collect();
    let wigley = |x: f64, z: f64| 0.9 * (1.0 - x * x) * (1.0 - (1.0 - z) * (1.0 - z));
    let round =
        |x: f64, z: f64| 0.9 * (1.0 - x.abs().powi(3)) * (1.0 - 0.55 * (1.0 - z) * (1.0 - z));
    // Read to 0.01, as in tables of offsets: ratio of the errors of data and surface.
    for (hull, least) in [(&wigley as &dyn Fn(f64, f64) -> f64, 3.0), (&round, 1.0)] {
        let exact = offsets(&xs, &zs, hull);
        let read: Vec<_> =
            exact.iter().map(|p| Vec3::of(p.x, (100.0 * p.y).round() / 100.0, p.z)).collect();
        let data = data(&read, [15, 7], 0.005 * (1.0 + 1e-9), along_y());
        let made = fair_grid(&data, Measure::Variation, Goal::Budget(0.8), &[], 1e-9).unwrap();
        assert!(made.residuals.iter().all(|&r| r <= 0.005 * (1.0 + 2e-9)));
        assert!(made.used < 0.8 + 1e-6 && made.certificate.relative() < 1e-6);
        let network = data.network(made.original.clone()).unwrap();
        let surface = network.surface(&made.points).unwrap();
        let rms = |f: &dyn Fn(usize, usize) -> f64| {
            let all = (0..15).flat_map(|i| (0..7).map(move |j| (i, j)));
            (all.map(|(i, j)| f(i, j).powi(2)).sum::<f64>() / 105.0).sqrt()
        };
        let (us, vs) = (&data.layouts[0].at, &data.layouts[1].at);
        let off = |i: usize, j: usize| {
            use moldloft_num::{Order, Surface};
            let p = surface.jet(us[i], vs[j], Order::Zero).p;
            p.y - exact[7 * i + j].y
        };
        let before = rms(&|i, j| read[7 * i + j].y - exact[7 * i + j].y);
        let after = rms(&off);
        assert!(before > least * after, "{before:e} {after:e}");
    }
}

#[test]
fn rims_and_fixed_points_stay() {
    let mut random = Lcg::new(2);
    let (xs, zs) = (uneven(&mut random, 9, 3.0), uneven(&mut random, 8, 3.0));
    let mut points = offsets(&xs, &zs, |x, z| (1.0 - x * x) * (1.0 - z * z));
    points.iter_mut().for_each(|p| p.y += 0.01 * random.centred());
    let mut data = data(&points, [9, 8], 0.01, Motion::Ball);
    data.rims = [
        [EndContinuity::Curvature, EndContinuity::Free],
        [EndContinuity::Position, EndContinuity::Tangent],
    ];
    data.limit.radii[8 * 4 + 3] = 0.0;
    let made = fair_grid(&data, Measure::Variation, Goal::Fairest, &[], 1e-9).unwrap();
    let same = |i: usize, j: usize| made.points[8 * i + j] == made.original[8 * i + j];
    for i in 0..9 {
        for j in 0..8 {
            let kept = i < 3 || !(1..6).contains(&j) || (i == 8 && (j == 0 || j == 7));
            assert!(!kept || same(i, j), "{i} {j}");
        }
    }
    assert!(made.residuals[8 * 4 + 3] < 1e-12);
    assert!(made.residuals.iter().any(|&r| r > 0.005));
    // Nothing may move at all, and everything coincides.
    data.limit.radii.fill(0.0);
    let made = fair_grid(&data, Measure::Variation, Goal::Fairest, &[], 1e-9).unwrap();
    assert_eq!((made.points == made.original, made.certificate.gap), (true, 0.0));
    let none = self::data(&[Vec3::zero(); 72], [9, 8], 0.01, Motion::Ball);
    let made = fair_grid(&none, Measure::Variation, Goal::Near(0.8), &[], 1e-9).unwrap();
    assert!(made.points.iter().all(|p| *p == Vec3::zero()));
}

#[test]
fn derivatives_go_through_the_knots() {
    let mut random = Lcg::new(7);
    let (xs, zs) = (uneven(&mut random, 7, 3.0), uneven(&mut random, 6, 2.0));
    let mut points = offsets(&xs, &zs, |x, z| (1.0 - x * x) * (1.0 - z * z));
    points.iter_mut().for_each(|p| *p += Vec3::of(0.0, 0.02 * random.centred(), 0.0));
    for (measure, goal) in [
        (Measure::Variation, Goal::Fairest),
        (Measure::Bending, Goal::Budget(0.8)),
        (Measure::Third, Goal::Budget(0.8)),
    ] {
        let found = derivatives_are_differences(&points, [7, 6], 0.008, measure, (goal, 1e-5));
        assert!(found, "{measure:?} {goal:?}");
    }
}

/// A hull with a parallel body, which no least third derivatives have, read with noise.
fn foreign(random: &mut Lcg, m: usize, n: usize, noise: f64) -> Vec<Vec3<f64>> {
    let (xs, zs) = (uneven(random, m, 2.0), uneven(random, n, 2.0));
    let body = |x: f64| (((2.0 * x - 1.0).abs() - 0.4).max(0.0) / 0.6).powf(2.2);
    let mut points = offsets(&xs, &zs, |x, z| (1.0 - body(x)) * (1.0 - (1.0 - z).powi(6)));
    points.iter_mut().for_each(|p| p.y += noise * random.centred());
    points
}

#[test]
fn surfaces_keep_near_data_that_the_measure_does_not_have() {
    // The fairest takes less and less of the squares as tolerances grow, and the budget follows. 63 data pull:
    // noise may take 1.169, and from 0.25 more on they speak against the measure.
    let noise = 1.0 + 1.5 * (0.8f64 / 63.0).sqrt();
    let chords = [ParameterSpacing::Chord; 2];
    let mut met = [0; 3];
    let mut moving = [Vec::new(), Vec::new()];
    for seed in 12..15 {
        let points = foreign(&mut Lcg::new(seed), 9, 7, 0.01);
        for k in -4..12 {
            let tolerance = 0.09 * 1.05f64.powi(k);
            let data = spaced(&points, [9, 7], tolerance, Motion::Ball, chords);
            let near = Goal::Near(0.8);
            let made = fair_grid(&data, Measure::Variation, near, &[], 1e-12).unwrap();
            let GridFit { fairest_used, used, .. } = made;
            let beyond = fairest_used - noise;
            // From 0.8 to 0.3, and then to 0.05.
            let foreign = ((beyond - 0.25) / 0.3).clamp(0.0, 1.0);
            let strange = ((beyond - 0.55) / 0.4).clamp(0.0, 1.0);
            let budget = fairest_used.min(0.8 - 0.5 * foreign - 0.25 * strange);
            let here = format!("{seed}, tolerance {tolerance}: {used} of {fairest_used}");
            assert!((used - budget).abs() < 1e-6, "{here}");
            met[usize::from(foreign > 0.0) + usize::from(strange > 0.0)] += 1;
            for (moving, share) in moving.iter_mut().zip([foreign, strange]) {
                moving.extend((share > 0.1 && share < 0.9).then(|| (points.clone(), tolerance)));
            }
        }
    }
    assert!(met.iter().all(|&m| m > 2), "{met:?}");
    // Between these the budget depends on the squares of the fairest.
    let (measure, goal) = (Measure::Variation, Goal::Near(0.8));
    for cases in moving {
        let by = |(points, t): &(Vec<_>, _)| {
            derivatives_are_differences(points, [9, 7], *t, measure, (goal, 1e-4))
        };
        assert!(cases.iter().any(by), "none of {} is decided", cases.len());
    }
}

/// Derivatives of a surface by two coordinates of data and the tolerance, against differences; false where they
/// are refused because it is not decided which limits the fairest reaches.
fn derivatives_are_differences(
    points: &[Vec3<f64>],
    shape: [usize; 2],
    tolerance: f64,
    measure: Measure,
    (goal, h): (Goal, f64),
) -> bool {
    let chords = [ParameterSpacing::Chord; 2];
    let surface = |points: &[Vec3<f64>], tolerance: f64| {
        let data = spaced(points, shape, tolerance, Motion::Ball, chords);
        let made = fair_grid(&data, measure, goal, &[], 1e-13).unwrap();
        (data.network(made.original).unwrap().surface(&made.points).unwrap(), data)
    };
    let mut moving: Vec<Vec3<Dual4>> = points.iter().map(|&p| Vec3::lifted(p)).collect();
    moving[15].y = Dual4::seeded(points[15].y, 0);
    moving[20].x = Dual4::seeded(points[20].x, 1);
    let radii = vec![tolerance; points.len()];
    let ball = (Motion::Ball, radii.as_slice());
    let at = grid_parameters(&moving, shape, chords, [false; 2], ball).unwrap();
    let data = spaced(points, shape, tolerance, Motion::Ball, chords);
    let at = [at[0].as_slice(), at[1].as_slice()];
    let tolerances = vec![Dual4::seeded(tolerance, 2); points.len()];
    let made = match fair_grid_with(&data, measure, goal, 1e-13, &moving, &tolerances, at) {
        Err(FairError::Goal(why)) if why.contains("undecided") => return false,
        made => made.unwrap().0,
    };
    // The corners of the net are the data's, and the curve along a rim is a spline: compare the
    // control points where their knots' derivatives are known, by the surface at the data.
    for (u, v) in [(0.31, 0.62), (0.77, 0.4)] {
        let exact = tensor(&made.knots, &made.points, u, v);
        for d in 0..3 {
            let at = |by: f64| {
                use moldloft_num::{Order, Surface};
                let mut points = points.to_vec();
                match d {
                    0 => points[15].y += by,
                    1 => points[20].x += by,
                    _ => {}
                }
                let tolerance = tolerance + if d == 2 { by } else { 0.0 };
                surface(&points, tolerance).0.jet(u, v, Order::Zero).p
            };
            let wanted = (at(h) - at(-h)) * (0.5 / h);
            let off = (exact.map(|x| x.eps[d]) - wanted).norm();
            assert!(
                off < 2e-4 * (1.0 + wanted.norm()),
                "{measure:?} {goal:?} {d} {off:e} {wanted:?}"
            );
        }
    }
    true
}

/// De Boor's algorithm in both directions.
fn tensor(knots: &[Vec<Dual4>; 2], points: &[Vec3<Dual4>], u: f64, v: f64) -> Vec3<Dual4> {
    let n = knots[1].len() - 4;
    let curve = |knots: &[Dual4], t: f64, c: &dyn Fn(usize) -> Vec3<Dual4>| {
        let last = knots.len() - 4;
        let k = 3 + knots[4..last].iter().filter(|k| k.re() <= t).count();
        let mut d: Vec<Vec3<Dual4>> = (k - 3..=k).map(c).collect();
        for level in 1..=3 {
            for j in (level..=3).rev() {
                let (low, high) = (knots[k - 3 + j], knots[k + 1 + j - level]);
                let share = (Dual4::from(t) - low) / (high - low);
                d[j] = d[j - 1] * (Dual4::from(1.0) - share) + d[j] * share;
            }
        }
        d[3]
    };
    curve(&knots[0], u, &|i| curve(&knots[1], v, &|j| points[i * n + j]))
}
