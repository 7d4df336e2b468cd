//! Many data on a spline of few knots: near to the truth, of its form, within every tolerance.

use crate::truth::{Lcg, SHAPES, shape_at};
use moldloft_fair::*;
use moldloft_num::Vec3;
use moldloft_testing::{rounds, soak};

/// Noise over the length.
const ROUGH: [f64; 3] = [2e-5, 2e-4, 1e-3];

struct Case {
    points: Vec<Vec3<f64>>,
    truth: Vec<Vec3<f64>>,
    noise: f64,
    plane: bool,
}

fn length(line: &[Vec3<f64>]) -> f64 {
    line.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

fn dense(at: &dyn Fn(f64) -> Vec3<f64>) -> Vec<Vec3<f64>> {
    (0..=20_000).map(|k| at(f64::from(k) / 20_000.0)).collect()
}

/// A shape at even, jittered or random parameters, with noise in each coordinate that stays within
/// the tolerance.
fn case(name: &str, n: usize, kind: usize, rough: f64, seed: u64) -> Case {
    let mut random = Lcg::new(seed);
    let mut at: Vec<f64> = (0..n)
        .map(|i| match kind {
            0 => i as f64 / (n - 1) as f64,
            1 if i > 0 && i + 1 < n => (i as f64 + 0.7 * random.unit()) / (n - 1) as f64,
            1 => i as f64 / (n - 1) as f64,
            _ => random.unit() + 0.5,
        })
        .collect();
    at.sort_by(f64::total_cmp);
    (at[0], at[n - 1]) = (0.0, 1.0);
    let truth = dense(&|u| shape_at(name, u));
    let plane = name != "helix";
    let noise = rough * length(&truth);
    let scale = 2.0 * noise / if plane { 2f64 } else { 3f64 }.sqrt();
    let off = |r: &mut Lcg| {
        let z = if plane { 0.0 } else { scale * r.unit() };
        Vec3::of(scale * r.unit(), scale * r.unit(), z)
    };
    let points = at.iter().map(|&u| shape_at(name, u) + off(&mut random)).collect();
    Case { points, truth, noise, plane }
}

fn layout(points: &[Vec3<f64>], limit: &Limit, closed: bool) -> Option<InterpolationSpace> {
    thinned(points, limit, [EndContinuity::Free; 2], 3, closed, true).unwrap()
}

fn faired(data: &Data) -> (DataFit, FairingReport) {
    let budget = near_budget(&data.points, Motion::Ball);
    let plain = DataOptions::of(Measure::Variation, Goal::Near(budget));
    data_report(data, &DataOptions { bends: false, ..plain }).unwrap()
}

fn data(points: &[Vec3<f64>], noise: f64, closed: bool) -> Option<Data> {
    let limit = Limit::ball(points.len(), noise).unwrap();
    let layout = layout(points, &limit, closed)?;
    Some(Data { points: points.to_vec(), limit, layout, ends: [EndContinuity::Free; 2] })
}

/// The root mean square distance of a curve from a fine polyline.
fn off(space: &Space, control: &[Vec3<f64>], truth: &[Vec3<f64>]) -> f64 {
    let (start, end) = space.domain();
    let squares: f64 = (0..=500)
        .map(|k| {
            let p = shape::sample_at(
                space,
                control,
                None,
                start + (end - start) * f64::from(k) / 500.0,
            )
            .point;
            let side = |w: &[Vec3<f64>]| {
                let along = w[1] - w[0];
                let s = ((p - w[0]).dot(along) / along.norm_sq()).clamp(0.0, 1.0);
                (w[0] + along * s - p).norm_sq()
            };
            let near = (0..truth.len())
                .min_by(|&a, &b| (truth[a] - p).norm_sq().total_cmp(&(truth[b] - p).norm_sq()))
                .unwrap();
            let from = near.saturating_sub(1);
            truth[from..(near + 2).min(truth.len())]
                .windows(2)
                .map(side)
                .fold(f64::INFINITY, f64::min)
        })
        .sum();
    (squares / 501.0).sqrt()
}

fn within(made: &DataFit, limit: &Limit) -> bool {
    made.residuals.iter().zip(&limit.radii).all(|(r, a)| *r <= a * (1.0 + 1e-9))
}

/// Inflections and monotone pieces of the shapes.
fn form(name: &str) -> [usize; 2] {
    match name {
        "clothoid" | "helix" => [0, 1],
        "hollow" => [1, 3],
        "sac" => [2, 2],
        _ => [0, 2],
    }
}

#[test]
fn shapes_of_many_data() {
    let sizes: &[usize] = if soak() { &[500, 1000, 3000] } else { &[500, 2000] };
    let (mut worst, mut bent, mut pieces, mut all) = (0.0f64, 0, [0; 2], [0; 2]);
    for &n in sizes {
        for name in SHAPES {
            for (kind, (k, rough)) in
                (0..3).flat_map(|i| ROUGH.into_iter().enumerate().map(move |r| (i, r)))
            {
                if !soak() && k != kind {
                    continue;
                }
                for seed in 1..=rounds(1, 3) as u64 {
                    let what = format!("{n} {name} {kind} {rough} {seed}");
                    let case = case(name, n, kind, rough, seed);
                    let data = data(&case.points, case.noise, false).expect("knots can be few");
                    assert!(8 * data.layout.space.count() < n, "{what}");
                    let (made, told) = faired(&data);
                    assert!(within(&made, &data.limit), "{what}");
                    let far = off(&data.layout.space, &made.points, &case.truth) / case.noise;
                    let [inflections, most] = form(name);
                    worst = worst.max(far);
                    let many = told.after.pieces > most + 2;
                    let bends = case.plane && told.after.inflections > inflections;
                    all[usize::from(case.plane)] += 1;
                    pieces[usize::from(case.plane)] += usize::from(many);
                    bent += usize::from(bends);
                    if many || bends || far > 0.2 {
                        println!(
                            "{what}: {} control points, {far:.3} off, {} pieces, {} inflections, gap {:.1e}",
                            made.points.len(),
                            told.after.pieces,
                            told.after.inflections,
                            made.certificate.relative()
                        );
                    }
                }
            }
        }
    }
    println!(
        "{all:?} in space and plane: worst {worst:.3}, {bent} with more inflections, {pieces:?} with more pieces"
    );
    assert!(worst < 0.25, "{worst}");
    // An inflection more is one at an end without curvature.
    assert!(20 * bent <= all[1] + 20, "{bent}");
    assert!(10 * pieces[1] <= all[1] + 10, "{pieces:?}");
}

fn wave(u: f64) -> Vec3<f64> {
    Vec3::of(10.0 * u, (6.0 * u).sin(), 0.0)
}

fn waves(n: usize) -> Vec<Vec3<f64>> {
    (0..n).map(|i| wave(i as f64 / (n - 1) as f64)).collect()
}

/// Distance of the curve of data from a shape, relative to a length.
fn far(data: &Data, unit: f64, of: &dyn Fn(f64) -> Vec3<f64>) -> (f64, FairingReport, DataFit) {
    let (made, told) = faired(data);
    assert!(within(&made, &data.limit));
    (off(&data.layout.space, &made.points, &dense(of)) / unit, told, made)
}

#[test]
fn many_data_without_noise_stay() {
    let points = waves(2000);
    let data = data(&points, 1e-3, false).unwrap();
    let (off, told, made) = far(&data, 1e-3, &wave);
    let most = made.residuals.iter().copied().fold(0.0, f64::max);
    assert!(off < 1e-3 && most < 1e-6, "{off} {most}");
    assert_eq!((told.after.pieces, told.after.inflections), (3, 1));
}

#[test]
fn many_data_with_normal_noise() {
    // At a tolerance of two and a half deviations some data are beyond; knots follow them.
    let mut random = Lcg::new(3);
    let mut normal = || (0..12).map(|_| random.unit()).sum::<f64>() * 1e-3;
    let mut points = waves(2000);
    for p in &mut points {
        *p += Vec3::of(normal(), normal(), 0.0);
    }
    for share in [2.5, 3.0, 4.0] {
        let data = data(&points, share * 1e-3, false).unwrap();
        let (off, ..) = far(&data, 1e-3, &wave);
        assert!(off < 1.0, "{share}: {off}");
    }
    assert!(data(&points, 2e-3, false).is_none());
}

#[test]
fn many_data_of_a_ring_and_backwards() {
    let n = 2000;
    let ring = |u: f64| {
        let a = 2.0 * std::f64::consts::PI * u;
        Vec3::of(3.0 * a.cos() + 0.3 * (2.0 * a).cos(), a.sin(), 0.0)
    };
    let mut random = Lcg::new(5);
    let mut noise = || Vec3::of(random.unit(), random.unit(), 0.0) * 2e-3;
    let points: Vec<_> = (0..n).map(|i| ring(i as f64 / n as f64) + noise()).collect();
    for first in [0, 1, 777] {
        let turned: Vec<_> = (0..n).map(|i| points[(i + first) % n]).collect();
        let (off, told, _) = far(&data(&turned, 1.5e-3, true).unwrap(), 1e-3, &ring);
        assert!(off < 0.2, "{off}");
        assert_eq!(told.after.inflections, 0);
    }
    let mut line = waves(n);
    line.iter_mut().for_each(|p| *p += noise() * 0.5);
    let there = data(&line, 1e-3, false).unwrap();
    line.reverse();
    let back = data(&line, 1e-3, false).unwrap();
    let [a, b] = [&there, &back].map(|d| (far(d, 1e-3, &wave).2.points, d.layout.space.clone()));
    for k in 0..=100 {
        let t = f64::from(k) / 100.0;
        let p = shape::sample_at(&a.1, &a.0, None, t).point;
        // The same curve, at other knots.
        let near = (0..=4000)
            .map(|j| (shape::sample_at(&b.1, &b.0, None, f64::from(j) / 4000.0).point - p).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(near < 2e-3, "{t}: {near}");
    }
}

#[test]
fn few_or_other_data_have_a_knot_each() {
    let mut points = waves(2000);
    let limit = Limit::ball(2000, 1e-3).unwrap();
    let thin = |points: &[Vec3<f64>], limit: &Limit, end| {
        thinned(points, limit, [end; 2], 3, false, true).unwrap().is_some()
    };
    assert!(thin(&points, &limit, EndContinuity::Position));
    assert!(!thin(&points, &limit, EndContinuity::Tangent));
    assert!(!thin(&points[..499], &Limit::ball(499, 1e-3).unwrap(), EndContinuity::Free));
    let along = Limit::new(Motion::Along(Vec3::of(0.0, 1.0, 0.0)), vec![1e-3; 2000]).unwrap();
    // Stations on a line are parameters; without these there is no such spline.
    assert!(thin(&points, &along, EndContinuity::Free));
    let mut aside = points.clone();
    aside[900].z += 1e-3;
    assert!(!thin(&aside, &along, EndContinuity::Free));
    let mut fixed = limit.clone();
    fixed.radii[700] = 0.0;
    assert!(!thin(&points, &fixed, EndContinuity::Free));
    // A wrong digit that nobody released is kept by knots at its neighbours.
    points[700].y += 0.05;
    assert!(!thin(&points, &limit, EndContinuity::Free));
    // Exact points stay whatever their number.
    let arc: Vec<_> =
        (0..2000).map(|i| f64::from(i) * 1e-3).map(|a| Vec3::of(a.cos(), a.sin(), 0.0)).collect();
    assert!(!thin(&arc, &limit, EndContinuity::Free));
}
