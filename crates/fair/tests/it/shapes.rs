//! Shape as a condition: signs, runs, arcs and limits of data under noise.

use crate::truth::{Lcg, data_of};
use moldloft_fair::*;
use moldloft_num::Vec3;

const HALF: f64 = 4.6;
const BILGE: f64 = 1.4;
const DEPTH: f64 = 6.2;

/// Flat bottom, bilge and side with noise within a ball, and the number of points on the first two.
fn section(count: usize, seed: u64, noise: f64) -> (Vec<Vec3<f64>>, usize, usize) {
    let (flat, arc) = (HALF - BILGE, BILGE * std::f64::consts::FRAC_PI_2);
    let total = flat + arc + DEPTH - BILGE;
    let mut g = Lcg::new(seed);
    let (mut on_flat, mut on_arc) = (0, 0);
    let points = (0..count)
        .map(|k| {
            let s = total * k as f64 / (count - 1) as f64;
            on_flat += usize::from(s <= flat);
            on_arc += usize::from(s <= flat + arc);
            let (x, y) = if s <= flat {
                (s, 0.0)
            } else if s <= flat + arc {
                let angle = (s - flat) / BILGE;
                (flat + BILGE * angle.sin(), BILGE * (1.0 - angle.cos()))
            } else {
                (HALF, BILGE + s - flat - arc)
            };
            let scale = 2.0 * noise / 2f64.sqrt();
            Vec3::of(x + g.unit() * scale, y + g.unit() * scale, 0.0)
        })
        .collect();
    (points, on_flat, on_arc)
}

fn shaped(data: Data, wanted: &[ShapeCondition], goal: Goal) -> Result<(Data, DataFit), FairError> {
    let (data, shape) = data.shaped(wanted)?;
    let options = DataOptions { shape, bends: false, ..DataOptions::of(Measure::Variation, goal) };
    let fit = fair_data(&data, &options)?;
    Ok((data, fit))
}

/// The least and the largest curvature times the sign of +z between two parameters.
fn bends(data: &Data, fit: &DataFit, from: f64, to: f64) -> (f64, f64) {
    let z = Vec3::of(0.0, 0.0, 1.0);
    let all = shape::samples(&data.layout.space, &fit.points, None, 40);
    let inner = all.iter().filter(|s| s.t > from + 1e-9 && s.t < to - 1e-9);
    inner
        .map(|s| s.signed_curvature(z))
        .fold((f64::MAX, f64::MIN), |(l, h), k| (l.min(k), h.max(k)))
}

#[test]
fn a_midship_section_has_flats_and_an_arc() {
    let noise = 2e-3;
    for seed in 1..=5 {
        let (points, a, b) = section(30, seed, noise);
        let data = data_of(&points, noise, ParameterSpacing::Chord);
        let wanted = [
            ShapeCondition::Straight { between: [0, a - 1], along: None },
            ShapeCondition::Arc { between: [a, b - 1] },
            ShapeCondition::Straight { between: [b, 29], along: None },
        ];
        let (data, fit) = shaped(data, &wanted, Goal::Near(0.8)).unwrap();
        assert!(fit.residuals.iter().all(|&r| r <= noise));
        let at = &data.layout.at;
        let place = |t: f64| shape::sample_at(&data.layout.space, &fit.points, None, t).point;
        for (from, to) in [(at[0], at[a - 1]), (at[b], at[29])] {
            let (p, q) = (place(from), place(to));
            let across = (q - p).cross(Vec3::of(0.0, 0.0, 1.0)).normalized().unwrap();
            for k in 0..=100 {
                let x = place(from + (to - from) * f64::from(k) / 100.0);
                assert!((x - p).dot(across).abs() < 1e-9);
            }
        }
        let arc = &fit.arcs[0];
        assert!((arc.radius - BILGE).abs() < 0.01 * BILGE, "{arc:?}");
        let (low, high) = bends(&data, &fit, at[a], at[b - 1]);
        assert!((low * arc.radius - 1.0).abs() < 0.01 && (high * arc.radius - 1.0).abs() < 0.01);
        assert!(bends(&data, &fit, at[0], at[29]).0 > -1e-7);
    }
}

#[test]
fn turns_pieces_and_limits_hold() {
    let noise = 3e-3;
    let mut found = 0;
    for seed in 1..=6 {
        let mut g = Lcg::new(seed);
        let points: Vec<Vec3<f64>> = (0..36)
            .map(|k| {
                let u = f64::from(k) / 35.0;
                let (x, y) = ((2.6 * u).cos(), 0.7 * (2.6 * u).sin());
                let scale = 2.0 * noise / 2f64.sqrt();
                Vec3::of(x + g.unit() * scale, y + g.unit() * scale, 0.0)
            })
            .collect();
        let own = || data_of(&points, noise, ParameterSpacing::Chord);
        let all = [0, 35];
        for goal in [Goal::Near(0.8), Goal::Fairest, Goal::Closest] {
            let turn = ShapeCondition::Turn { between: all, left: true };
            let made = shaped(own(), &[turn], goal);
            let (data, fit) = made.unwrap_or_else(|e| panic!("seed {seed}, {goal:?}: {e:?}"));
            assert!(fit.residuals.iter().all(|&r| r <= noise), "{goal:?}");
            assert!(bends(&data, &fit, -1.0, 2.0).0 >= 0.0, "{goal:?}");
            let one = ShapeCondition::OneWay { between: all };
            let (data, fit) = shaped(own(), &[one], goal).unwrap();
            assert!(bends(&data, &fit, -1.0, 2.0).0 >= 0.0, "{goal:?}");
        }
        let turn = ShapeCondition::Turn { between: all, left: false };
        let refused = shaped(own(), &[turn], Goal::Fairest).map(|_| ());
        assert!(matches!(refused, Err(FairError::Shape { .. })), "{refused:?}");
        // A search that may end without one, and says so.
        match shaped(own(), &[ShapeCondition::Pieces(2)], Goal::Near(0.8)) {
            Ok((data, fit)) => {
                assert!(shape::pieces(&data.layout.space, &fit.points) <= 2);
                assert!(fit.residuals.iter().all(|&r| r <= noise));
                found += 1;
            }
            Err(FairError::Shapeless { why, .. }) => println!("seed {seed}: {why}"),
            Err(other) => panic!("seed {seed}: {other:?}"),
        }
        let up = Vec3::of(0.0, 1.0, 0.0);
        let within = ShapeCondition::Within { direction: up, most: 0.7 };
        let (data, fit) = shaped(own(), &[within], Goal::Fairest).unwrap();
        let all = shape::samples(&data.layout.space, &fit.points, None, 40);
        assert!(all.iter().all(|s| s.point.y <= 0.7));
        let side = ShapeCondition::OneSided { direction: up };
        let (data, fit) = shaped(own(), &[side], Goal::Near(0.8)).unwrap();
        let at =
            |k: usize| shape::sample_at(&data.layout.space, &fit.points, None, data.layout.at[k]);
        assert!((0..36).all(|k| at(k).point.y <= points[k].y + 1e-15));
    }
    println!("two monotone pieces were found in {found} of 6");
    assert!(found >= 3, "{found}");
}

#[test]
fn the_nearest_of_a_measure_is_between_the_data_and_the_fairest() {
    let (points, ..) = section(30, 1, 2e-3);
    let data = data_of(&points, 2e-3, ParameterSpacing::Chord);
    let run = |goal| fair_data(&data, &DataOptions::of(Measure::Variation, goal));
    let least = run(Goal::Fairest).unwrap();
    let most = 1.5 * least.certificate.value;
    let near = run(Goal::Energy(most)).unwrap();
    assert!((near.certificate.value / most - 1.0).abs() < 1e-6);
    assert!(near.used < least.used);
    let shares = run(Goal::Nearest(0.5)).unwrap();
    let apart = near.points.iter().zip(&shares.points).map(|(p, q)| (*p - *q).norm());
    assert!(apart.fold(0.0, f64::max) < 1e-6 * 2e-3 * 1e3);
    assert!(matches!(run(Goal::Energy(0.5 * most / 1.5)), Err(FairError::Energy { .. })));
    assert_eq!(run(Goal::Closest).unwrap().points, near.original);
}

/// Flats and a bilge of random sizes with points at random parameters, some so near each other that noise puts
/// them in the wrong order.
#[test]
fn midship_sections_at_random_places() {
    let mut g = moldloft_testing::Random::new(77);
    let count = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 600 } else { 60 };
    let mut crossed = 0;
    for _ in 0..count {
        let (radius, half, depth) =
            (g.between(0.5, 3.0), g.between(3.5, 10.0), g.between(3.5, 8.0));
        let [on_flat, on_arc, on_side] = [0; 3].map(|_| 6 + g.below(8));
        let mut along = |from: f64, to: f64, n: usize| {
            let mut all: Vec<f64> = (2..n).map(|_| g.between(from, to)).collect();
            all.extend([from, to]);
            all.sort_by(f64::total_cmp);
            all
        };
        let flat = along(0.0, half - radius, on_flat);
        let side = along(radius, depth, on_side);
        let bilge = (1..=on_arc).map(|k| {
            let angle = std::f64::consts::FRAC_PI_2 * k as f64 / (on_arc + 1) as f64;
            (half - radius + radius * angle.sin(), radius - radius * angle.cos())
        });
        let exact =
            flat.iter().map(|&x| (x, 0.0)).chain(bilge).chain(side.iter().map(|&y| (half, y)));
        let noise = 1e-3 * radius;
        let points: Vec<Vec3<f64>> = exact
            .collect::<Vec<_>>()
            .into_iter()
            .map(|(x, y)| {
                let slip = noise / 2f64.sqrt();
                Vec3::of(x + slip * g.between(-1.0, 1.0), y + slip * g.between(-1.0, 1.0), 0.0)
            })
            .collect();
        let n = points.len();
        let (i, j) = (on_flat - 1, on_flat + on_arc);
        crossed += (0..i).filter(|&k| points[k + 1].x <= points[k].x).count();
        crossed += (j..n - 1).filter(|&k| points[k + 1].y <= points[k].y).count();
        let wanted = [
            ShapeCondition::Straight { between: [0, i], along: None },
            ShapeCondition::Arc { between: [i, j] },
            ShapeCondition::Straight { between: [j, n - 1], along: None },
        ];
        let tolerance = 1.5 * noise;
        let data = data_of(&points, tolerance, ParameterSpacing::Chord);
        let (_, fit) = shaped(data, &wanted, Goal::Near(0.8)).unwrap();
        assert!(fit.residuals.iter().all(|&r| r <= tolerance * (1.0 + 1e-9)));
        assert!((fit.arcs[0].radius / radius - 1.0).abs() < 0.01, "{:?}", fit.arcs);
    }
    assert!(crossed > 0);
}

/// Straight runs and arcs beside breaks, before them, after them and across: the curve, or a reason.
#[test]
fn runs_beside_breaks() {
    let mut g = Lcg::new(5);
    let noise = 2e-3;
    let points: Vec<Vec3<f64>> = (0..18)
        .map(|k| {
            let x = f64::from(k) / 17.0;
            Vec3::of(x, 0.2 * x * x + 2.0 * noise * g.unit(), 0.0)
        })
        .collect();
    let (mut made, mut refused) = (0, 0);
    for first in 0..8 {
        for length in [3, 5] {
            for mark in 1..14 {
                for arc in [false, true] {
                    let between = [first, first + length];
                    let wanted = if arc {
                        ShapeCondition::Arc { between }
                    } else {
                        ShapeCondition::Straight { between, along: None }
                    };
                    let mut data = data_of(&points, 0.02, ParameterSpacing::Chord);
                    let at = data.layout.at.clone();
                    data.layout = InterpolationSpace::new(3, &at, &[mark], false).unwrap();
                    match shaped(data, &[wanted], Goal::Fairest) {
                        Ok((_, fit)) => {
                            made += 1;
                            let most = fit.residuals.iter().copied().fold(0.0, f64::max);
                            assert!(most <= 0.02 * (1.0 + 1e-9), "{between:?} {mark} {arc}");
                        }
                        Err(FairError::Shapeless { .. } | FairError::Shape { .. }) => refused += 1,
                        Err(FairError::Contradiction { .. }) => refused += 1,
                        Err(other) => panic!("{between:?} {mark} {arc}: {other:?}"),
                    }
                }
            }
        }
    }
    assert!(made > 100 && refused > 100, "{made} {refused}");
}
