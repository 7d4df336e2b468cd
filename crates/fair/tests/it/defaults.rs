//! The default of a curve near its points: never more inflections than the fairest of the same points, nor more than
//! two monotone pieces more, and continuous in the points.

use crate::truth::Lcg;
use moldloft_fair::*;
use moldloft_num::Vec3;

/// Slender shapes, noses and ship curves: a point for a parameter, and the noise relative to the
/// length.
type Form = (&'static str, fn(f64) -> [f64; 2], f64);

fn nose(u: f64) -> [f64; 2] {
    let s = 2.0 * u - 1.0;
    let (a, x) = (s.abs(), s * s);
    let y = 0.2969 * a - 0.1260 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3) - 0.1015 * x.powi(4);
    [x, if s < 0.0 { -0.6 * y } else { 0.6 * y }]
}

fn bezier(t: f64) -> [f64; 2] {
    let s = 1.0 - t;
    let at = |p: [f64; 4]| {
        s.powi(3) * p[0] + 3.0 * t * s * s * p[1] + 3.0 * t * t * s * p[2] + t.powi(3) * p[3]
    };
    [at([0.0, 1.0, 7.0, 10.0]), at([0.0, 4.0, 5.0, 1.0])]
}

const FORMS: [Form; 15] = [
    ("line", |t| [10.0 * t, t], 1e-3),
    ("parabola", |t| [10.0 * t, 4.0 * t * (1.0 - t)], 1e-3),
    ("arc", |t| [5.0 * (2.0 * t).cos(), 5.0 * (2.0 * t).sin()], 1e-3),
    ("catenary", |t| [10.0 * t - 5.0, 2.0 * ((10.0 * t - 5.0) / 2.5).cosh()], 1e-3),
    ("sheer", |t| [10.0 * t, 1.2 - 0.9 * t + 1.1 * t * t + 0.35 * t.powi(4)], 1e-3),
    ("tanh", |t| [10.0 * t, (4.0 * (t - 0.5)).tanh()], 1e-3),
    (
        "spiral",
        |t| [3.0 * (1.2 * t).exp() * (2.6 * t).cos(), 3.0 * (1.2 * t).exp() * (2.6 * t).sin()],
        1e-3,
    ),
    ("bezier", bezier, 1e-3),
    ("aerofoil", nose, 2e-4),
    ("ellipse 3:1", |t| [3.0 * (0.05 + 3.04 * t).cos(), (0.05 + 3.04 * t).sin()], 2e-4),
    ("ellipse 8:1", |t| [8.0 * (0.05 + 3.04 * t).cos(), (0.05 + 3.04 * t).sin()], 2e-4),
    (
        "bulb",
        |t| {
            let z = 10.0 * t;
            [1.6 * (-((z - 2.2) / 1.3).powi(2)).exp() + 0.25 + 0.012 * z * z, z]
        },
        1e-3,
    ),
    ("half sine", |t| [100.0 * t, 10.0 * (std::f64::consts::PI * t).sin()], 1e-3),
    (
        "areas",
        |u| {
            let w = 2.0 * u - 1.0;
            [5.0 * u, (1.0 - w * w).powi(2) * (1.0 + 0.3 * w)]
        },
        1e-3,
    ),
    ("hollow", |u| [10.0 * u, 1.2 * (6.0 * u.powi(5) - 15.0 * u.powi(4) + 10.0 * u.powi(3))], 1e-3),
];

fn at(form: &Form, u: f64) -> Vec3<f64> {
    let [x, y] = form.1(u);
    Vec3::of(x, y, 0.0)
}

/// Points with noise in discs, and the radius of these.
fn noisy(form: &Form, n: usize, g: &mut Lcg) -> (Vec<Vec3<f64>>, f64) {
    let dense: Vec<_> = (0..=2000).map(|k| at(form, f64::from(k) / 2000.0)).collect();
    let length: f64 = dense.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let a = form.2 * length;
    let mut noise = || loop {
        let p = Vec3::of(2.0 * g.unit(), 2.0 * g.unit(), 0.0);
        if p.norm() <= 1.0 {
            return p * a;
        }
    };
    ((0..n).map(|k| at(form, k as f64 / (n - 1) as f64) + noise()).collect(), a)
}

fn counted(curve: &NearCurve<f64>) -> [usize; 2] {
    let samples = shape::samples(&curve.data.layout.space, &curve.fit.points, None, 16);
    [shape::inflections(&samples), shape::monotone_pieces(&samples, 1e-3)]
}

/// The root mean square distance from the form, over the noise.
fn off(form: &Form, curve: &NearCurve<f64>, a: f64) -> f64 {
    let dense: Vec<_> = (-20..=2020).map(|k| at(form, f64::from(k) / 2000.0)).collect();
    let space = &curve.data.layout.space;
    let (from, to) = space.domain();
    let mut sum = 0.0;
    let mut near = 0usize;
    for k in 0..=400 {
        let t = from + (to - from) * f64::from(k) / 400.0;
        let p = shape::sample_at(space, &curve.fit.points, None, t).point;
        let window = near.saturating_sub(60)..(near + 120).min(dense.len() - 1);
        let far = |i: usize| {
            let (q, d) = (dense[i], dense[i + 1] - dense[i]);
            let s = ((p - q).dot(d) / d.norm_sq()).clamp(0.0, 1.0);
            (p - q - d * s).norm()
        };
        let best = window.clone().min_by(|&i, &j| far(i).total_cmp(&far(j))).unwrap();
        near = best;
        sum += far(best).powi(2);
    }
    (sum / 401.0).sqrt() / a
}

#[test]
fn the_default_never_adds_a_bend() {
    let soak = std::env::var_os("MOLDLOFT_SOAK").is_some();
    let draws: u64 = if soak { 30 } else { 2 };
    for form in &FORMS {
        let (mut counts, mut offs) = ([0.0; 6], Vec::new());
        let mut all = 0.0;
        let slender = form.2 > 5e-4 && !matches!(form.0, "bulb" | "half sine" | "areas" | "hollow");
        for n in if slender { [21, 41, 61] } else { [31, 49, 81] } {
            for seed in 0..draws {
                let mut g = Lcg::new(7001 + 13 * seed + n as u64);
                let (points, a) = noisy(form, n, &mut g);
                let request = CurveRequest::of(&points, a);
                let near = request.curve(&points).unwrap();
                let fairest = CurveRequest { goal: Goal::Fairest, ..request };
                let fairest = fairest.curve(&points).unwrap();
                let (own, least) = (counted(&near), counted(&fairest));
                let here =
                    format!("{} of {n} points, draw {seed}: {own:?} beside {least:?}", form.0);
                assert!(own[0] <= least[0] && own[1] <= least[1] + 2, "{here}");
                assert!(near.fit.residuals.iter().all(|&r| r <= a * (1.0 + 1e-12)), "{here}");
                if form.0 == "line" {
                    assert_eq!(own[0], 0, "{here}");
                }
                for (sum, x) in counts.iter_mut().zip([own[0], own[1], least[0], least[1]]) {
                    *sum += x as f64;
                }
                counts[4] += near.fit.fairer;
                all += 1.0;
                offs.push(off(form, &near, a));
            }
        }
        offs.sort_by(f64::total_cmp);
        let mean = counts.map(|c| c / all);
        let median = offs[offs.len() / 2];
        println!(
            "{:12} inflections {:.2} of {:.2}, pieces {:.2} of {:.2}, rms {median:.3}, fairer {:.2}",
            form.0, mean[0], mean[2], mean[1], mean[3], mean[4]
        );
        // The worst median of a long run is 0.43, of the ellipse 8:1.
        assert!(median < 0.55, "{}: {median}", form.0);
    }
}

/// Closed curves: a circle, ovals, and one with two inflections.
const RINGS: [Form; 4] = [
    ("circle", |t| [(TURN * t).cos(), (TURN * t).sin()], 1e-3),
    ("oval", |t| [2.0 * (TURN * t).cos(), (TURN * t).sin()], 1e-3),
    ("egg", |t| [2.0 * (TURN * t).cos(), (TURN * t).sin() * (1.0 + 0.3 * (TURN * t).cos())], 1e-3),
    ("bean", |t| [2.0 * (TURN * t).cos(), (TURN * t).sin() - 0.9 * (TURN * t).cos().powi(2)], 1e-3),
];
const TURN: f64 = std::f64::consts::TAU;

/// True of forms whose points may move along y.
fn is_graph(form: &Form) -> bool {
    let all: Vec<f64> = (0..=50).map(|k| form.1(f64::from(k) / 50.0)[0]).collect();
    all.windows(2).all(|w| w[0] < w[1])
}

#[test]
fn budgets_motions_and_rings_add_no_bend() {
    let soak = std::env::var_os("MOLDLOFT_SOAK").is_some();
    let (mut all, mut more) = (0, Vec::new());
    let mut compare = |form: &Form, n: usize, seed: u64, motion: Motion, closed: bool| {
        let mut g = Lcg::new(9_001 + 17 * seed + n as u64);
        let (mut points, a) = noisy(form, n + usize::from(closed), &mut g);
        points.truncate(n);
        if motion != Motion::Ball {
            for (k, p) in points.iter_mut().enumerate() {
                p.x = form.1(k as f64 / (n - 1) as f64)[0];
            }
        }
        let request = CurveRequest { motion, closed, ..CurveRequest::of(&points, a) };
        let made = |goal: Goal| {
            let request = CurveRequest { goal, ..request.clone() };
            counted(&request.curve(&points).unwrap())
        };
        let least = made(Goal::Fairest);
        for goal in [request.goal, Goal::Budget(0.2), Goal::Budget(0.5), Goal::Budget(0.8)] {
            let own = made(goal);
            let here = format!("{} of {n}, draw {seed}, {goal:?}, {motion:?}", form.0);
            assert!(own[0] <= least[0], "{here}: {own:?} beside {least:?}");
            all += 1;
            if own[1] > least[1] + 2 {
                more.push(format!("{here}: {own:?} beside {least:?}"));
            }
        }
    };
    for (k, form) in FORMS.iter().enumerate() {
        for seed in 0..if soak { 10 } else { 1 } {
            let n = [15, 31, 49][(k + seed as usize) % 3];
            compare(form, n, seed, Motion::Ball, false);
            if is_graph(form) {
                compare(form, n, seed, Motion::Along(Vec3::of(0.0, 1.0, 0.0)), false);
            }
        }
    }
    for (k, form) in RINGS.iter().enumerate() {
        for seed in 0..if soak { 10 } else { 2 } {
            compare(form, [16, 24, 48][(k + seed as usize) % 3], seed, Motion::Ball, true);
        }
    }
    println!("{} of {all} with more than two pieces more: {more:#?}", more.len());
    // A circle of few points is one piece, however the curvature between these ripples; the curve
    // near its points is not that circle.
    more.retain(|line| !line.starts_with("circle"));
    assert!(50 * more.len() <= all, "{more:#?}");
}

#[test]
fn one_draw_turns_into_another_without_jumps() {
    let steps = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 41 } else { 9 };
    for form in FORMS.iter().filter(|f| matches!(f.0, "line" | "sheer" | "parabola" | "hollow")) {
        let (first, a) = noisy(form, 41, &mut Lcg::new(99));
        let (second, _) = noisy(form, 41, &mut Lcg::new(123));
        let sampled = |share: f64| -> Vec<shape::Sample> {
            let both = first.iter().zip(&second);
            let points: Vec<_> = both.map(|(p, q)| *p + (*q - *p) * share).collect();
            let curve = CurveRequest::of(&points, a).curve(&points).unwrap();
            let space = &curve.data.layout.space;
            (0..=100)
                .map(|k| shape::sample_at(space, &curve.fit.points, None, f64::from(k) / 100.0))
                .collect()
        };
        let mut before = sampled(0.0);
        let mut worst = 0.0f64;
        for k in 1..=steps {
            let now = sampled(f64::from(k) / f64::from(steps));
            // Across the curve; motion along it is a change of parameter.
            let across = |i: usize| {
                let off = now[i].point - before[i].point;
                let along = before[i].derivatives[0].normalized().unwrap_or_default();
                (off - along * off.dot(along)).norm() / a
            };
            worst = (1..100).map(across).fold(worst, f64::max);
            before = now;
        }
        println!("{}: largest step {worst:.2} of the noise in {steps} steps", form.0);
        // The points themselves move by 2 / 9 of it at most, or 2 / 41.
        assert!(worst < if steps > 9 { 0.4 } else { 0.8 }, "{}: {worst}", form.0);
    }
}

/// A hull of half-breadths at half stations, and its lines: waterlines and stations.
fn hull(of: &dyn Fn(f64, f64) -> f64, noise: f64, seed: u64) -> (Vec<Vec3<f64>>, Network) {
    let stations = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0, 9.5, 10.0];
    let heights = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.25];
    let (m, n) = (stations.len(), heights.len());
    let mut g = Lcg::new(seed);
    let mut points = Vec::new();
    for x in stations {
        for z in heights {
            points.push(Vec3::of(x, of(x, z) + 2.0 * noise * g.unit(), z));
        }
    }
    let way = Motion::Along(Vec3::of(0.0, 1.0, 0.0));
    let limit = Limit::new(way, vec![noise; m * n]).unwrap();
    let line = |own: Vec<usize>| {
        let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let radii = vec![noise; own.len()];
        let at = parameters_across(&list, ParameterSpacing::Chord, false, (way, &radii)).unwrap();
        NetworkCurve {
            space: Space::floating(3, own.len()).unwrap(),
            points: own,
            weights: None,
            marks: Vec::new(),
            runs: Vec::new(),
            ends: [EndContinuity::Points(1); 2],
            at: Some(at),
        }
    };
    let mut lines: Vec<NetworkCurve> =
        (0..n).map(|j| line((0..m).map(|i| i * n + j).collect())).collect();
    lines.extend((0..m).map(|i| line((0..n).map(|j| i * n + j).collect())));
    let network = Network::new(points.clone(), lines, limit).unwrap();
    (points, network)
}

/// Changes of the second differences' sign along waterlines.
fn waves(points: &[Vec3<f64>]) -> usize {
    let (m, n) = (15, 7);
    let mut count = 0;
    for j in 0..n {
        let line: Vec<Vec3<f64>> = (0..m).map(|i| points[i * n + j]).collect();
        let second: Vec<f64> = line
            .windows(3)
            .map(|w| (w[2].y - w[1].y) / (w[2].x - w[1].x) - (w[1].y - w[0].y) / (w[1].x - w[0].x))
            .collect();
        // Every one, however small: a second difference of zero is a change, too.
        count +=
            second.windows(2).filter(|s| s[0].signum() != s[1].signum() || s[1] == 0.0).count();
    }
    count
}

#[test]
fn waterlines_of_a_hull_keep_no_waves_of_the_noise() {
    let draws: u64 = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 20 } else { 6 };
    let round = |x: f64, z: f64| {
        0.9 * (1.0 - (x / 5.0 - 1.0).abs().powi(3)) * (1.0 - ((1.25 - z) / 1.25).powi(2)).powf(0.75)
    };
    let wigley = |x: f64, z: f64| {
        0.9 * (1.0 - (x / 5.0 - 1.0).powi(2)) * (1.0 - ((1.25 - z) / 1.25).powi(2))
    };
    let hulls: [(&str, &dyn Fn(f64, f64) -> f64); 2] = [("round", &round), ("Wigley", &wigley)];
    for (name, of) in hulls {
        let (exact, _) = hull(of, 0.0, 1);
        let (mut before, mut after, mut rms) = (0, 0, [0.0, 0.0]);
        for seed in 0..draws {
            let (data, network) = hull(of, 0.02, 311 + seed);
            let goal = NetworkMode::Toward(Goal::Near(moldloft_fair::NETWORK_BUDGET));
            let made = network.report(Measure::Third, goal).unwrap();
            let off = |points: &[Vec3<f64>]| {
                let all = points.iter().zip(&exact).map(|(p, q)| (*p - *q).norm_sq());
                (all.sum::<f64>() / exact.len() as f64).sqrt() / 0.02
            };
            assert!(made.certified <= 0.02 * (1.0 + 1e-9), "{name}: {}", made.certified);
            before += waves(&data);
            after += waves(&made.points);
            rms = [rms[0] + off(&data) / draws as f64, rms[1] + off(&made.points) / draws as f64];
        }
        println!("{name}: waves {before} -> {after} of {draws} draws, rms {rms:.2?} of the noise");
        assert!(after as u64 <= draws && rms[1] < 0.85 * rms[0], "{name}: {after}, {rms:?}");
    }
}

/// A draft is the curve of its goal before bends are counted: within the tolerances and under the same budget. What it
/// measures more than the finished one with bends as they come is within its certified gap, which is wide only where
/// the measure is next to nothing.
#[test]
fn a_draft_is_the_curve_before_bends_are_counted() {
    let soak = std::env::var_os("MOLDLOFT_SOAK").is_some();
    for form in &FORMS {
        for seed in 0..if soak { 20 } else { 1 } {
            let mut g = Lcg::new(911 + seed);
            let (points, a) = noisy(form, 51, &mut g);
            for share in [0.3, 1.0, 3.0] {
                let request = CurveRequest::of(&points, share * a);
                let drafts = [Goal::Near(0.5), Goal::Budget(0.7), Goal::Fairest].map(|goal| {
                    let open = CurveRequest { goal, bends: true, ..request.clone() };
                    let draft = CurveRequest { draft: true, bends: false, ..open.clone() };
                    (open.curve(&points).unwrap(), draft.curve(&points).unwrap())
                });
                for (done, draft) in drafts {
                    let here = format!("{} at {share} of the noise", form.0);
                    let most = share * a;
                    let within = draft.fit.residuals.iter().all(|&r| r <= most * (1.0 + 1e-9));
                    assert!(within, "{here}");
                    assert!(draft.fit.used <= done.fit.used * (1.0 + 1e-4) + 1e-9, "{here}");
                    let ends = [&done, &draft].map(|c| {
                        let space = &c.data.layout.space;
                        shape::samples(space, &c.fit.points, None, 4)
                    });
                    let apart =
                        ends[0].iter().zip(&ends[1]).map(|(p, q)| (p.point - q.point).norm());
                    let apart = apart.fold(0.0, f64::max) / most;
                    let (value, gap) = (draft.fit.certificate.value, draft.fit.certificate.gap);
                    let same = done.data.layout.at == draft.data.layout.at;
                    assert!(!same || value - done.fit.certificate.value <= gap * 1.01, "{here}");
                    let most = if form.0 == "line" { 0.3 } else { 0.02 };
                    assert!(apart < most, "{here}: {apart} tolerances apart");
                }
            }
        }
    }
}
