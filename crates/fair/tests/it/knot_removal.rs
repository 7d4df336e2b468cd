//! KnotRemoval steps against the figures of the fixtures, and their laws.

use crate::fixtures::*;
use moldloft_fair::*;
use moldloft_num::Vec3;

struct Row {
    fixture: Fixture,
    /// Largest jump, squared jumps and measure of the input.
    input: [f64; 3],
    /// The measure and the squared jumps after n and 10 n steps.
    steps: [[f64; 2]; 2],
    stall: usize,
    /// Monotone pieces and inflections before and after 10 n steps.
    pieces: [usize; 2],
    inflections: [usize; 2],
    /// Distance to the truth before and after n steps.
    truth: [f64; 2],
}

fn rows() -> Vec<Row> {
    vec![
        Row {
            fixture: f1a(),
            input: [5.385165e-4, 5.700000e-6, 1.313000e-4],
            steps: [[1.308567e-4, 3.89e-8], [1.308287e-4, 1.18e-9]],
            stall: 1165,
            pieces: [19, 2],
            inflections: [0, 0],
            truth: [3.36e-5, 2.79e-5],
        },
        Row {
            fixture: f1b(),
            input: [6.403124e-3, 1.684000e-3, 2.580000e-4],
            steps: [[1.314760e-4, 3.65e-6], [1.298344e-4, 1.16e-7]],
            stall: 221,
            pieces: [56, 4],
            inflections: [44, 0],
            truth: [4.61e-4, 4.13e-4],
        },
        Row {
            fixture: f2a(),
            input: [5.830952e-4, 5.660000e-6, 2.660000e-6],
            steps: [[2.077217e-6, 5.17e-8], [2.000237e-6, 1.89e-8]],
            stall: 126,
            pieces: [36, 6],
            inflections: [15, 2],
            truth: [3.84e-5, 3.34e-5],
        },
        Row {
            fixture: f2b(),
            input: [1.291809e-3, 1.866561e-5, 3.519791e-6],
            steps: [[2.094699e-6, 5.36e-8], [1.967644e-6, 2.10e-8]],
            stall: 161,
            pieces: [48, 8],
            inflections: [32, 2],
            truth: [5.69e-5, 5.21e-5],
        },
        Row {
            fixture: f3(),
            input: [1.315213e-2, 2.879147e-3, 6.174782e-3],
            steps: [[5.941748e-3, 1.41e-5], [5.931647e-3, 7.1e-7]],
            stall: 1040,
            pieces: [53, 15],
            inflections: [0, 0],
            truth: [0.797e-3, 0.675e-3],
        },
    ]
}

fn job(f: &Fixture) -> Job {
    Job::of_points(3, f.points.clone(), f.closed, f.tolerance).unwrap()
}

fn faithful(job: &Job, steps: usize) -> KnotRemoval {
    knot_removal(job, &KnotRemovalOptions::faithful(steps)).unwrap()
}

#[test]
fn the_inputs_are_those_of_the_table() {
    for row in rows() {
        let (f, job) = (&row.fixture, job(&row.fixture));
        let largest = KnotJumps::of(&job.space).lengths(&f.points).into_iter().fold(0.0, f64::max);
        near(f.name, largest, row.input[0], 1e-6);
        near(f.name, job.value(Measure::Jumps, &f.points).unwrap(), row.input[1], 1e-6);
        near(f.name, job.value(Measure::Second, &f.points).unwrap(), row.input[2], 1e-6);
        near(f.name, rms(&f.points, &f.truth), row.truth[0], 0.02);
    }
}

#[test]
fn steps_reach_the_figures_of_the_table() {
    for row in rows() {
        let (f, job) = (&row.fixture, job(&row.fixture));
        for (k, wanted) in [1, 10].into_iter().zip(row.steps) {
            let result = faithful(&job, k * f.points.len());
            near(f.name, job.value(Measure::Second, &result.points).unwrap(), wanted[0], 0.05);
            near(f.name, job.value(Measure::Jumps, &result.points).unwrap(), wanted[1], 0.30);
            if k == 1 {
                near(f.name, rms(&result.points, &f.truth), row.truth[1], 0.10);
            }
        }
    }
}

/// Curvature counts of the table; a closed curve's are of this program.
#[test]
fn monotone_pieces_and_inflections() {
    for row in rows() {
        let (f, job) = (&row.fixture, job(&row.fixture));
        let result = faithful(&job, 10 * f.points.len());
        for (k, points) in [&f.points, &result.points].into_iter().enumerate() {
            let pieces = shape::pieces(&job.space, points);
            assert!(pieces.abs_diff(row.pieces[k]) <= 1, "{} {k}: {pieces}", f.name);
            let samples = shape::samples(&job.space, points, None, 16);
            let changes = shape::inflections(&samples);
            assert!(changes.abs_diff(row.inflections[k]) <= 1, "{} {k}: {changes}", f.name);
        }
    }
}

#[test]
fn the_literal_rule_stalls() {
    for row in rows() {
        let job = job(&row.fixture);
        let options =
            KnotRemovalOptions { rule: Rule::Literal, ..KnotRemovalOptions::faithful(1_000_000) };
        let result = knot_removal(&job, &options).unwrap();
        assert_eq!(result.stopped, Stopped::Stalled);
        let ratio = result.steps as f64 / row.stall as f64;
        assert!((0.3..3.0).contains(&ratio), "{} {}", row.fixture.name, result.steps);
    }
}

/// The jumps fall by orders of magnitude within n steps at a deviation below 7.5e-4.
#[test]
fn rounded_section_is_fair_within_n_steps() {
    let f = f1b();
    let job = job(&f);
    let result = faithful(&job, f.points.len());
    let before = job.value(Measure::Jumps, &f.points).unwrap();
    let after = job.value(Measure::Jumps, &result.points).unwrap();
    assert!(before / after > 300.0, "{}", before / after);
    let far = deviation(&job, &result.points);
    assert!(far.certified <= 7.5e-4 && far.sampled <= far.certified, "{far:?}");
}

#[test]
fn the_measure_never_rises_and_the_limit_holds() {
    for f in all() {
        let job = job(&f);
        let options = KnotRemovalOptions { log: true, ..KnotRemovalOptions::faithful(500) };
        let result = knot_removal(&job, &options).unwrap();
        let mut points = f.points.clone();
        let mut before = job.value(Measure::Second, &points).unwrap();
        for step in &result.log {
            points[step.index as usize] = step.to;
            let now = job.value(Measure::Second, &points).unwrap();
            assert!(now <= before * (1.0 + 1e-14), "{}", f.name);
            before = now;
            let moved = step.to - f.points[step.index as usize];
            assert!(moved.norm_sq() <= f.tolerance * f.tolerance);
        }
        assert_eq!(replay(&f.points, &result.log), result.points);
        assert_eq!(points, result.points);
    }
}

/// An unlimited step lowers half the measure by the jump squared over 12, and zeroes the jump.
#[test]
fn a_free_step_removes_its_knot() {
    let f = f2b();
    let job = Job::of_points(3, f.points.clone(), false, f64::INFINITY).unwrap();
    let result =
        knot_removal(&job, &KnotRemovalOptions { log: true, ..KnotRemovalOptions::faithful(1) })
            .unwrap();
    let moved = result.log[0].index as usize;
    let jumps = KnotJumps::of(&job.space);
    let row = jumps.moved.iter().position(|&m| m == moved).unwrap();
    let jump = jumps.rows.apply(row, &f.points).norm();
    assert!(jumps.rows.apply(row, &result.points).norm() < 1e-15);
    let value = |p: &[Vec3<f64>]| 0.5 * job.value(Measure::Second, p).unwrap();
    near("drop", value(&f.points) - value(&result.points), jump * jump / 12.0, 1e-9);
}

#[test]
fn far_points_keep_their_bits_and_marks_do_not_move() {
    let f = f1b();
    let mut job = job(&f);
    job.marks = vec![30, 55];
    let result =
        knot_removal(&job, &KnotRemovalOptions { log: true, ..KnotRemovalOptions::faithful(400) })
            .unwrap();
    let touched: Vec<usize> = result.log.iter().map(|m| m.index as usize).collect();
    for (i, (p, q)) in result.points.iter().zip(&f.points).enumerate() {
        if !touched.contains(&i) {
            assert!(p.bits_eq(*q));
        }
        if [0, 1, 30, 55, 79, 80].contains(&i) {
            assert!(!touched.contains(&i));
        }
    }
    // Both sides are faired as curves of their own.
    let right = &f.points[55..];
    let alone = Job::of_points(3, right.to_vec(), false, f.tolerance).unwrap();
    let steps = knot_removal(&alone, &KnotRemovalOptions::faithful(100_000)).unwrap();
    let all = knot_removal(&job, &KnotRemovalOptions::faithful(400_000)).unwrap();
    let apart = rms(&all.points[55..], &steps.points);
    assert!(apart < 1e-2 * f.tolerance, "{apart}");
}

#[test]
fn stops_say_which_one_fired() {
    let job = job(&f2b());
    let run = |stops: Stops| {
        knot_removal(&job, &KnotRemovalOptions { stops, ..KnotRemovalOptions::faithful(0) })
            .unwrap()
            .stopped
    };
    let many = Stops::after(1_000_000);
    assert_eq!(run(Stops::after(3)), Stopped::Steps);
    assert_eq!(run(Stops { least_move: 1e-3, ..many }), Stopped::Move);
    assert_eq!(run(Stops { least_drop: 1e-6, ..many }), Stopped::Drop);
    assert_eq!(run(Stops { gap: 1e-2, ..many }), Stopped::Gap);
    assert_eq!(run(Stops { pieces: true, ..many }), Stopped::Pieces);
    let zero = Job::of_points(3, f2b().points, false, 0.0).unwrap();
    let still = knot_removal(&zero, &KnotRemovalOptions::faithful(10)).unwrap();
    assert_eq!((still.stopped, still.points), (Stopped::Done, f2b().points));
}

#[test]
fn closed_curves_shift_and_open_ones_turn_round() {
    let f = f3();
    let result = faithful(&job(&f), 200);
    let mut shifted = f.points.clone();
    shifted.rotate_left(17);
    let mut other = faithful(&Job::of_points(3, shifted, true, f.tolerance).unwrap(), 200).points;
    other.rotate_right(17);
    assert!(rms(&other, &result.points) < 1e-13);

    let f = f2b();
    let result = faithful(&job(&f), 150);
    let back: Vec<_> = f.points.iter().rev().copied().collect();
    let mut other = faithful(&Job::of_points(3, back, false, f.tolerance).unwrap(), 150).points;
    other.reverse();
    assert!(rms(&other, &result.points) < 1e-13);
}

#[test]
fn uneven_knots_never_raise_the_measure() {
    let mut random = Lcg::new(21);
    for degree in [2, 3, 4, 5] {
        let mut knots = vec![0.0; degree + 1];
        for k in 1..30 {
            knots.push(f64::from(k) + 0.9 * random.centred());
        }
        knots.extend(vec![30.0; degree + 1]);
        let space = Space::open(moldloft_spline::KnotVector::new(degree, knots).unwrap()).unwrap();
        let points: Vec<_> = (0..space.count())
            .map(|i| Vec3::of(i as f64, 0.1 * random.centred(), 0.1 * random.centred()))
            .collect();
        let job = Job::new(space, points.clone(), 0.05).unwrap();
        let result = knot_removal(
            &job,
            &KnotRemovalOptions { log: true, ..KnotRemovalOptions::faithful(500) },
        )
        .unwrap();
        assert!(result.steps > 20, "{degree} {} {:?}", result.steps, result.stopped);
        let mut now = points;
        let mut before = job.value(Measure::Second, &now).unwrap();
        for step in &result.log {
            now[step.index as usize] = step.to;
            let value = job.value(Measure::Second, &now).unwrap();
            assert!(value <= before * (1.0 + 1e-13));
            before = value;
        }
    }
}

#[test]
fn sweeps_come_near_and_never_rise() {
    let f = f2b();
    let job = job(&f);
    let mut before = job.value(Measure::Second, &f.points).unwrap();
    for count in 1..=10 {
        let now = job.value(Measure::Second, &sweeps(&job, Measure::Second, count).unwrap());
        assert!(now.clone().unwrap() < before);
        before = now.unwrap();
    }
    near("ten sweeps", before, 1.967644e-6, 0.26);
}

#[test]
fn bad_input_is_refused() {
    let line: Vec<_> = (0..9).map(|i| Vec3::of(f64::from(i), 0.0, 0.0)).collect();
    let of = |points: Vec<Vec3<f64>>, closed, tolerance| {
        Job::of_points(3, points, closed, tolerance).map(|_| ())
    };
    assert_eq!(
        of(line[..4].to_vec(), false, 0.1),
        Err(FairError::TooFew { expected: 5, actual: 4 })
    );
    assert_eq!(
        of(line[..7].to_vec(), true, 0.1),
        Err(FairError::TooFew { expected: 8, actual: 7 })
    );
    assert_eq!(of(line.clone(), false, -1.0), Err(FairError::Tolerance { value: -1.0 }));
    assert!(matches!(of(line.clone(), false, f64::NAN), Err(FairError::Tolerance { .. })));
    assert_eq!(of(line.clone(), true, f64::INFINITY), Err(FairError::ClosedWithoutTolerance));
    let mut bad = line.clone();
    bad[4].y = f64::NAN;
    assert_eq!(of(bad, false, 0.1), Err(FairError::NotFinite { index: 4 }));
    let mut job = Job::of_points(3, line.clone(), false, 0.1).unwrap();
    job.marks = vec![9];
    assert_eq!(job.check(), Err(FairError::Mark { index: 9, count: 9 }));
    job.marks.clear();
    job.weights = Some(vec![1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(job.check(), Err(FairError::Weight { index: 2, weight: 0.0 }));
    let uneven = Space::periodic(3, vec![0., 1., 2., 3., 3., 5., 6., 7., 8.], 9.0);
    assert_eq!(uneven, Err(FairError::Unsorted { index: 4 }));
    // Coincident control points are nothing special.
    let still = vec![Vec3::of(1.0, 2.0, 3.0); 12];
    let job = Job::of_points(3, still.clone(), false, 0.1).unwrap();
    assert_eq!(faithful(&job, 100).points, still);
}

/// Noise correlated over some 20 points defeats single points and not bumps.
#[test]
fn coarser_levels_damp_long_waves() {
    let points: Vec<_> = (0..200)
        .map(f64::from)
        .map(|x| Vec3::of(0.1 * x, 1e-3 * (x * std::f64::consts::TAU / 20.0).sin(), 0.0))
        .collect();
    let long = Job::of_points(3, points, false, 2e-3).unwrap();
    let value = |p: Vec<Vec3<f64>>| long.value(Measure::Second, &p).unwrap();
    let fine = value(sweeps(&long, Measure::Second, 40).unwrap());
    let coarse = value(multilevel(&long, Measure::Second, 40, 3).unwrap());
    let least = optimum(&long, &OptimumOptions::of(Measure::Second)).unwrap().certificate.value;
    assert!(fine > 20.0 * least, "{fine} {least}");
    assert!((least..1.02 * least).contains(&coarse), "{coarse} {least}");
    for f in all() {
        let job = job(&f);
        let mut before = f64::INFINITY;
        for cycles in 0..6 {
            let now = multilevel(&job, Measure::Second, cycles, 3).unwrap();
            let value = job.value(Measure::Second, &now).unwrap();
            assert!(value <= before * (1.0 + 1e-14));
            before = value;
            for (i, (p, q)) in now.iter().zip(&f.points).enumerate() {
                assert!((*p - *q).norm() <= f.tolerance);
                assert!(!job.frozen()[i] || p.bits_eq(*q));
            }
        }
    }
}
