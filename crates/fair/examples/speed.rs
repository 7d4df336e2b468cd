//! Times of fairing by size: `cargo run --release -p moldloft-fair --example speed [points]`.

use moldloft_fair::{
    Bound, Job, KnotRemovalOptions, Limit, Measure, Network, OptimumOptions, Space, certified,
    knot_removal, optimum, sweeps,
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

fn main() {
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
