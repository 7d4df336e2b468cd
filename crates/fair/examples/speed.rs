//! Times of fairing by size: `cargo run --release -p moldloft-fair --example speed [points]`; of
//! data under tolerances alone with `data` before the size; of the default of points on known shapes,
//! report and all, with `near` (and of one of them with its name after the size); at each tolerance of
//! a slider with `slide`; of points that move along one direction with `along`; of a hull's 30 lines with `hull`.

use moldloft_fair::{
    Bound, CurveRequest, Data, DataOptions, EndContinuity, Goal, InterpolationSpace, Job,
    KnotRemovalOptions, Limit, Measure, Motion, NETWORK_BUDGET, Network, NetworkCurve, NetworkMode,
    OptimumOptions, ParameterSpacing, Space, certified, curvature_parameters, data_report,
    fair_data, knot_removal, near_budget, optimum, parameters, parameters_across, shape, sweeps,
    thinned,
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

/// Six known shapes over [0, 1].
const SHAPES: [(&str, fn(f64) -> [f64; 3]); 6] = [
    ("hollow", |u| [10.0 * u, 1.2 * (6.0 * u.powi(5) - 15.0 * u.powi(4) + 10.0 * u.powi(3)), 0.0]),
    ("aerofoil", |u| {
        let s: f64 = 2.0 * u - 1.0;
        let (a, x) = (s.abs(), s * s);
        let half =
            0.2969 * a - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1015 * x.powi(4);
        [x, if s < 0.0 { -0.6 * half } else { 0.6 * half }, 0.0]
    }),
    ("helix", |u| [(4.0 * u).cos(), (4.0 * u).sin(), 0.9 * u]),
    ("ellipse", |u| [1.5 * (0.2 + 2.9 * u).cos(), 0.6 * (0.2 + 2.9 * u).sin(), 0.0]),
    ("sectional areas", |u| {
        let w = 2.0 * u - 1.0;
        [5.0 * u, (1.0 - w * w).powi(2) * (1.0 + 0.3 * w), 0.0]
    }),
    ("clothoid", |u| {
        // Its integral by Simpson's rule, fine enough for any noise here.
        let f = |t: f64| [(2.2 * t * t).cos(), (2.2 * t * t).sin()];
        let (mut sum, h) = ([0.0; 2], u / 64.0);
        for k in 0..64 {
            let at = [0.0, 0.5, 1.0].map(|s| f((f64::from(k) + s) * h));
            for c in 0..2 {
                sum[c] += h / 6.0 * (at[0][c] + 4.0 * at[1][c] + at[2][c]);
            }
        }
        [sum[0], sum[1], 0.0]
    }),
];

/// The root mean square distance of a curve from a known shape.
fn off(space: &Space, control: &[Vec3<f64>], of: fn(f64) -> [f64; 3]) -> f64 {
    const DENSE: usize = 20_000;
    let line: Vec<Vec3<f64>> =
        (0..=DENSE).map(|k| Vec3::from(of(k as f64 / DENSE as f64))).collect();
    let (start, end) = space.domain();
    let mut near = 0;
    let samples = 2000;
    let squares: f64 = (0..=samples)
        .map(|k| {
            let t = start + (end - start) * f64::from(k) / f64::from(samples);
            let p = shape::sample_at(space, control, None, t).point;
            while near < DENSE && (line[near + 1] - p).norm() < (line[near] - p).norm() {
                near += 1;
            }
            let side = |k: usize| {
                let (a, b) = (line[k], line[k + 1]);
                let along = b - a;
                let s = ((p - a).dot(along) / along.norm_sq()).clamp(0.0, 1.0);
                (a + along * s - p).norm_sq()
            };
            side(near.min(DENSE - 1)).min(side(near.saturating_sub(1)))
        })
        .sum();
    (squares / f64::from(samples + 1)).sqrt()
}

/// The default of points: parameters by curvature and a budget by what noise has across the curve.
/// Places are even or jittered, noise is a fifth of the mean step or a given share of the length.
fn near(n: usize) {
    let roughness = [
        ("noise of a fifth of a step", 0.2 / n as f64),
        ("noise of 2e-5", 2e-5),
        ("noise of 2e-4", 2e-4),
    ];
    let only = std::env::args().nth(3).unwrap_or_default();
    for (name, shape) in SHAPES.into_iter().filter(|s| s.0.starts_with(&only)) {
        for (jitter, (noisy, share)) in
            [0.0, 0.7].into_iter().flat_map(|j| roughness.map(|r| (j, r)))
        {
            let mut unit = random();
            let place = |i: usize, by: f64| (i as f64 + jitter * by) / (n - 1) as f64;
            let inner = |i: usize| i > 0 && i + 1 < n;
            let at: Vec<f64> =
                (0..n).map(|i| place(i, unit() * f64::from(u8::from(inner(i))))).collect();
            let exact: Vec<[f64; 3]> = at.iter().map(|&u| shape(u)).collect();
            let plane = exact.iter().all(|p| p[2] == 0.0);
            let step =
                |w: &[[f64; 3]]| (0..3).map(|c| (w[1][c] - w[0][c]).powi(2)).sum::<f64>().sqrt();
            let noise = share * exact.windows(2).map(step).sum::<f64>();
            let scale = 2.0 * noise / if plane { 2f64 } else { 3f64 }.sqrt();
            let points: Vec<Vec3<f64>> = exact
                .iter()
                .map(|p| {
                    let z = if plane { 0.0 } else { p[2] + scale * unit() };
                    Vec3::of(p[0] + scale * unit(), p[1] + scale * unit(), z)
                })
                .collect();
            let start = Clock::start();
            let limit = Limit::ball(n, noise).expect("the tolerance is good");
            let ends = [EndContinuity::Free; 2];
            let budget = near_budget(&points, Motion::Ball);
            let thin = thinned(&points, &limit, ends, 3, false, true).expect("the data are good");
            let layout = thin.unwrap_or_else(|| {
                let chords = parameters(&points, ParameterSpacing::Chord, false);
                let chords = chords.expect("no two in one place");
                let space = |at: &[f64]| InterpolationSpace::new(3, at, &[], false);
                let layout = space(&chords).expect("parameters rise");
                let data = Data { limit: limit.clone(), layout, ends, points: points.clone() };
                let own = curvature_parameters(&data, &points, &limit.radii, &chords);
                space(&own.expect("the data are good")).expect("parameters rise")
            });
            let data = Data { limit, layout, ends, points };
            let placed = start.elapsed();
            let plain = DataOptions::of(Measure::Variation, Goal::Near(budget));
            let options = DataOptions { bends: false, ..plain };
            let begun = Clock::start();
            let (made, told) = data_report(&data, &options).expect("the data are good");
            let took = begun.elapsed();
            println!(
                "{n} {name}, {}, {noisy}: {} control points, {:.3} of the noise off, worst datum {:.6}, gap \
                 {:.1e}, used {:.3}, pieces {}, inflections {}; parameters {:.1?}, in all {:.1?}",
                if jitter > 0.0 { "jittered" } else { "even" },
                made.points.len(),
                off(&data.layout.space, &made.points, shape) / noise,
                made.residuals.iter().copied().fold(0.0, f64::max) / noise,
                made.certificate.relative(),
                made.used,
                told.after.pieces,
                told.after.inflections,
                placed,
                placed + took
            );
        }
    }
}

/// Runs of which the mean is taken: the clock is coarse.
const REPEATS: u32 = 4;

/// Points of a slider: every tolerance from 0.3 to 3 noises, of the default and of the fairest, finished and as
/// drafts, the report apart; and how many inflections there are.
fn slide(n: usize) {
    for (name, shape) in SHAPES {
        let mut unit = random();
        let exact: Vec<Vec3<f64>> =
            (0..n).map(|i| Vec3::from(shape(i as f64 / (n - 1) as f64))).collect();
        let noise = 0.2 * exact.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>() / n as f64;
        let plane = exact.iter().all(|p| p.z == 0.0);
        let mut off = || noise * 1.4 * unit();
        let noisy = |p: &Vec3<f64>| *p + Vec3::of(off(), off(), if plane { 0.0 } else { off() });
        let points: Vec<_> = exact.iter().map(noisy).collect();
        for (word, goal, draft) in [
            ("near", None, false),
            ("near, draft", None, true),
            ("fairest", Some(Goal::Fairest), false),
            ("fairest, draft", Some(Goal::Fairest), true),
        ] {
            let times = [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0].map(|share| {
                let mut request = CurveRequest::of(&points, share * noise);
                request.goal = goal.unwrap_or(request.goal);
                request.draft = draft;
                let start = Clock::start();
                for _ in 1..REPEATS {
                    request.curve(&points).expect("the points are good");
                }
                let made = request.curve(&points).expect("the points are good");
                let fair = start.elapsed();
                for _ in 1..REPEATS {
                    made.report().expect("the curve is good");
                }
                let told = made.report().expect("the curve is good");
                let of = |time: Duration| 1e3 * time.as_secs_f64() / f64::from(REPEATS);
                let report = start.elapsed() - fair;
                format!(
                    "{share}: {:.1} + {:.1} ms, {}",
                    of(fair),
                    of(report),
                    told.after.inflections
                )
            });
            println!("{n} {name}, {word}: {}", times.join("; "));
        }
    }
}

/// A half sine whose ordinates have noise, and its default where points move along y.
fn along(n: usize) {
    for noise in [1e-2, 1e-4] {
        let mut unit = random();
        let exact = |x: f64| 2.0 * (std::f64::consts::PI * x / 10.0).sin();
        let points: Vec<Vec3<f64>> = (0..n)
            .map(|i| 10.0 * i as f64 / (n - 1) as f64)
            .map(|x| Vec3::of(x, exact(x) + 2.0 * noise * unit(), 0.0))
            .collect();
        let mut request = CurveRequest::of(&points, noise);
        request.motion = Motion::Along(Vec3::of(0.0, 1.0, 0.0));
        let start = Clock::start();
        let made = request.curve(&points).expect("the points are good");
        let fair = start.elapsed();
        let told = made.report().expect("the curve is good");
        let space = &made.data.layout.space;
        let (from, to) = space.domain();
        let square = |k: u32| {
            let t = from + (to - from) * f64::from(k) / 2000.0;
            let p = shape::sample_at(space, &made.fit.points, None, t).point;
            (p.y - exact(p.x)).powi(2)
        };
        let off = ((0..=2000).map(square).sum::<f64>() / 2001.0).sqrt() / noise;
        println!(
            "{n} along y, noise {noise}: {} control points, {off:.3} of the noise off, inflections {}, pieces {}, \
             gap {:.1e}; {fair:.1?}, with its report {:.1?}",
            made.fit.points.len(),
            told.after.inflections,
            told.after.pieces,
            made.fit.certificate.relative(),
            start.elapsed()
        );
    }
}

/// A round hull of 20 stations and 10 waterlines, read to 0.02, at tolerances from 0.3 to 3 noises.
fn hull() {
    const NOISE: f64 = 0.02;
    let mut unit = random();
    let (m, n) = (20, 10);
    let mut points = Vec::new();
    for (i, j) in (0..m).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let (x, z) = (i as f64 / (m - 1) as f64, j as f64 / (n - 1) as f64);
        let y = (1.0 - (2.0 * x - 1.0).abs().powi(3)) * (1.0 - (1.0 - z).powi(2)).powf(0.75);
        points.push(Vec3::of(20.0 * x, 2.0 * y + 2.0 * NOISE * unit(), 2.0 * z));
    }
    let stations = (0..m).map(|i| (0..n).map(|j| i * n + j).collect::<Vec<_>>());
    let lists: Vec<_> =
        stations.chain((0..n).map(|j| (0..m).map(|i| i * n + j).collect())).collect();
    let way = Motion::Along(Vec3::of(0.0, 1.0, 0.0));
    for share in [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0] {
        let radius = share * NOISE;
        let line = |own: &Vec<usize>| {
            let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
            let moved = (way, &vec![radius; own.len()][..]);
            let at = parameters_across(&list, ParameterSpacing::Chord, false, moved);
            NetworkCurve {
                space: Space::floating(3, own.len()).expect("the line is long enough"),
                points: own.clone(),
                weights: None,
                marks: Vec::new(),
                runs: Vec::new(),
                ends: [EndContinuity::Points(1); 2],
                at: Some(at.expect("no two in one place")),
            }
        };
        let limit = Limit::new(way, vec![radius; points.len()]).expect("the tolerance is good");
        let lines = lists.iter().map(line).collect();
        let network = Network::new(points.clone(), lines, limit).expect("the net is good");
        for (word, goal) in [("near", Goal::Near(NETWORK_BUDGET)), ("fairest", Goal::Fairest)] {
            let start = Clock::start();
            let made = network.report(Measure::Third, NetworkMode::Toward(goal));
            made.expect("the net is good");
            println!("hull of 30 lines, {share} noises, {word}: {:.1?}", start.elapsed());
        }
    }
}

fn main() {
    let word = std::env::args().nth(1);
    let sizes = || {
        let one = std::env::args().nth(2).and_then(|a| a.parse().ok());
        one.map_or(vec![1_000, 10_000, 30_000, 100_000], |n| vec![n])
    };
    if word.as_deref() == Some("slide") {
        return slide(std::env::args().nth(2).and_then(|a| a.parse().ok()).unwrap_or(200));
    }
    if word.as_deref() == Some("hull") {
        return hull();
    }
    if word.as_deref() == Some("along") {
        let one = std::env::args().nth(2).and_then(|a| a.parse().ok());
        let sizes = one.map_or(vec![1_000, 10_000, 100_000, 1_000_000], |n| vec![n]);
        return sizes.into_iter().for_each(along);
    }
    if word.as_deref() == Some("near") {
        return sizes().into_iter().for_each(near);
    }
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
