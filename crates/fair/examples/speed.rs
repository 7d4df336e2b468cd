//! Times of fairing by size: `cargo run --release -p moldloft-fair --example speed [points]`; of
//! data under tolerances alone with `data` before the size.

use moldloft_fair::{
    Bound, Data, DataOptions, EndContinuity, Goal, InterpolationSpace, Job, KnotRemovalOptions,
    Limit, Measure, Network, OptimumOptions, ParameterSpacing, Space, certified, fair_data,
    knot_removal, optimum, parameters, sweeps,
};
use moldloft_num::Vec3;
use std::time::{Duration, Instant};

/// The processor time of this thread, where the system tells it (other programs do not count), else
/// the clock.
struct Clock(Instant, Option<Duration>);

fn own_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(text.split(' ').next()?.parse().ok()?))
}

impl Clock {
    fn start() -> Self {
        Self(Instant::now(), own_time())
    }
    fn elapsed(&self) -> Duration {
        let own = self.1.and_then(|start| Some(own_time()? - start));
        own.unwrap_or_else(|| self.0.elapsed())
    }
}

/// Numbers in [-1/2, 1/2) of a linear congruential generator.
fn random() -> impl FnMut() -> f64 {
    let mut seed = 1u64;
    move || {
        seed = (1_103_515_245 * seed + 12_345) % (1 << 31);
        seed as f64 / (1u64 << 31) as f64 - 0.5
    }
}

fn wavy(n: usize, depth: f64) -> Vec<Vec3<f64>> {
    let mut unit = random();
    (0..n)
        .map(|i| {
            let x = i as f64 * 0.02;
            Vec3::of(
                x,
                0.1 * (0.5 * x).sin() + 1e-4 * unit(),
                depth * ((0.3 * x).cos() + 1e-4 * unit()),
            )
        })
        .collect()
}

/// One pass over a square net of this many points a side.
fn net(side: usize) {
    let mut unit = random();
    let points: Vec<_> = (0..side * side)
        .map(|k| (0.02 * (k / side) as f64, 0.02 * (k % side) as f64))
        .map(|(x, y)| Vec3::of(x, y, 0.1 * (x * y).sin() + 1e-4 * unit()))
        .collect();
    let spaces = [(); 2].map(|()| Space::floating(3, side).expect("the net is large enough"));
    let limit = Limit::ball(points.len(), 1e-4).expect("the tolerance is good");
    let net = Network::net(spaces, points, None, limit).expect("the net is good");
    let start = Clock::start();
    net.passes(1, 3).expect("the net is good");
    println!("net {side} x {side}: one pass of 3 steps per point {:?}", start.elapsed());
    let start = Clock::start();
    let (_, gap) = net.sweeps(Measure::Second, 10).expect("the net is good");
    println!(
        "net {side} x {side}: ten joint sweeps, gap {:.1e} {:?}",
        gap.relative(),
        start.elapsed()
    );
}

/// Curves of n points, a name, and the noise that they have: half the tolerance each way.
fn curves(n: usize) -> Vec<(&'static str, Vec<Vec3<f64>>, f64)> {
    let mut unit = random();
    let mut made = |name, tolerance: f64, shape: &dyn Fn(f64) -> (f64, f64)| {
        let points = (0..n).map(|i| shape(i as f64 / (n - 1) as f64)).map(|(x, y)| {
            Vec3::of(x + 1.4 * tolerance * unit(), y + 1.4 * tolerance * unit(), 0.0)
        });
        (name, points.collect(), tolerance)
    };
    let steep = |u: f64| {
        let x = (2.0 * u - 1.0).powi(2);
        let y = 0.6
            * (0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
                - 0.1036 * x.powi(4));
        (x, if u < 0.5 { y } else { -y })
    };
    let spacing = 1.0 / n as f64;
    vec![
        (
            "exact ellipse",
            1e-4,
            &(|u: f64| ((2.5 * u).cos(), 0.5 * (2.5 * u).sin())) as &dyn Fn(f64) -> (f64, f64),
        ),
        ("smooth waterline", 0.02 * spacing, &|u| (10.0 * u, (3.0 * u).sin())),
        ("rough waterline", 0.3 * spacing, &|u| (10.0 * u, (3.0 * u).sin())),
        ("rough wave", 0.3 * spacing, &|u| (10.0 * u, (30.0 * u).sin())),
        ("rough aerofoil", 0.3 * spacing, &steep),
    ]
    .into_iter()
    .map(|(name, tolerance, shape)| {
        let (name, mut points, tolerance): (_, Vec<Vec3<f64>>, _) = made(name, tolerance, shape);
        if name.starts_with("exact") {
            points = (0..n)
                .map(|i| shape(i as f64 / (n - 1) as f64))
                .map(|(x, y)| Vec3::of(x, y, 0.0))
                .collect();
        }
        (name, points, tolerance)
    })
    .collect()
}

/// Data under tolerances, with and without inflections held back.
fn data(n: usize) {
    for (name, points, tolerance) in curves(n) {
        let at = parameters(&points, ParameterSpacing::Chord, false).expect("no two in one place");
        let data = Data {
            limit: Limit::ball(n, tolerance).expect("the tolerance is good"),
            layout: InterpolationSpace::new(3, &at, &[], false).expect("parameters rise"),
            ends: [EndContinuity::Free; 2],
            points,
        };
        for (word, goal) in [("fairest", Goal::Fairest), ("near", Goal::Near(0.8))] {
            for bends in [true, false] {
                let options = DataOptions { bends, ..DataOptions::of(Measure::Variation, goal) };
                let start = Clock::start();
                let made = fair_data(&data, &options).expect("the data are good");
                println!(
                    "{n} {name}: {word}{}, gap {:.1e}, used {:.3}, {} iterations {:?}",
                    if bends { "" } else { ", no bends added" },
                    made.certificate.relative(),
                    made.used,
                    made.iterations,
                    start.elapsed()
                );
            }
        }
    }
}

fn main() {
    if std::env::args().nth(1).as_deref() == Some("data") {
        let sizes = std::env::args().nth(2).and_then(|a| a.parse().ok());
        return sizes.map_or(vec![1_000, 10_000, 100_000], |n| vec![n]).into_iter().for_each(data);
    }
    let sizes: Vec<usize> = match std::env::args().nth(1).and_then(|a| a.parse().ok()) {
        Some(n) => vec![n],
        None => vec![1_000, 10_000, 100_000],
    };
    net(sizes[0].min(1_000));
    for n in sizes {
        for (name, depth) in [("plane", 0.0), ("space", 0.1)] {
            let job = Job::of_points(3, wavy(n, depth), false, 1e-4).expect("the data is good");
            let start = Clock::start();
            let faired =
                knot_removal(&job, &KnotRemovalOptions::faithful(n)).expect("the job is good");
            println!("{n} {name}: faithful, {} steps {:?}", faired.steps, start.elapsed());
            let start = Clock::start();
            sweeps(&job, Measure::Second, 10).expect("the job is good");
            println!("{n} {name}: ten sweeps {:?}", start.elapsed());
            let start = Clock::start();
            let moved: Vec<_> =
                faired.points.iter().zip(&job.points).map(|(p, q)| *p - *q).collect();
            println!("{n} {name}: certified {:.3e} {:?}", certified(&job, &moved), start.elapsed());
            // A million points: one optimum is enough to see.
            let (bounds, measures) = if n < 1_000_000 { (2, 3) } else { (1, 1) };
            for bound in &[Bound::ControlPoints, Bound::Bezier][..bounds] {
                for measure in &[Measure::Second, Measure::Jumps, Measure::JumpLengths][..measures]
                {
                    let (bound, measure) = (*bound, *measure);
                    let start = Clock::start();
                    let options = OptimumOptions { bound, ..OptimumOptions::of(measure) };
                    let best = optimum(&job, &options).expect("the job is good");
                    println!(
                        "{n} {name}: optimum of {} under {bound:?}, gap {:.1e} in {} iterations {:?}",
                        measure.name(),
                        best.certificate.relative(),
                        best.iterations,
                        start.elapsed()
                    );
                }
            }
        }
    }
}
