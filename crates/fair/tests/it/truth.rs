//! Known shapes under bounded noise: energies against a conic solver's, and how near to the truth
//! the goals come.

use moldloft_fair::*;
use moldloft_num::Vec3;

pub struct Lcg(u64);

impl Lcg {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// In [-1/2, 1/2).
    pub fn unit(&mut self) -> f64 {
        self.0 = (1_103_515_245 * self.0 + 12_345) % (1 << 31);
        self.0 as f64 / (1u64 << 31) as f64 - 0.5
    }
}

pub const SHAPES: [&str; 6] = ["clothoid", "naca0012", "hollow", "helix", "ellipse", "sac"];
pub const SPACINGS: [&str; 4] = ["even", "half", "jitter", "random"];

/// A clothoid by the trapezoidal rule on a fine grid, linear between its points.
struct Clothoid(Vec<[f64; 2]>);

impl Clothoid {
    fn new() -> Self {
        let n = 40_000;
        let g = |t: f64| [(2.2 * t * t).cos(), (2.2 * t * t).sin()];
        let h = 1.0 / n as f64;
        let mut all = vec![[0.0; 2]];
        for k in 0..n {
            let (a, b) = (g(k as f64 * h), g((k + 1) as f64 * h));
            let last = all[k];
            all.push([last[0] + 0.5 * h * (a[0] + b[0]), last[1] + 0.5 * h * (a[1] + b[1])]);
        }
        Self(all)
    }

    fn at(&self, u: f64) -> Vec3<f64> {
        let x = u * (self.0.len() - 1) as f64;
        let k = (x.floor() as usize).min(self.0.len() - 2);
        let s = x - k as f64;
        let mix = |c: usize| self.0[k][c] * (1.0 - s) + self.0[k + 1][c] * s;
        Vec3::of(mix(0), mix(1), 0.0)
    }
}

thread_local! {
    static CLOTHOID: Clothoid = Clothoid::new();
}

pub fn shape_at(name: &str, u: f64) -> Vec3<f64> {
    match name {
        "clothoid" => CLOTHOID.with(|c| c.at(u)),
        "naca0012" => {
            let s: f64 = 2.0 * u - 1.0;
            let (a, x) = (s.abs(), s * s);
            let half = 0.2969 * a - 0.1260 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3)
                - 0.1015 * x.powi(4);
            Vec3::of(x, if s == 0.0 { 0.0 } else { s.signum() * 0.6 * half }, 0.0)
        }
        "hollow" => {
            let y = 6.0 * u.powi(5) - 15.0 * u.powi(4) + 10.0 * u.powi(3);
            Vec3::of(10.0 * u, 1.2 * y, 0.0)
        }
        "helix" => Vec3::of((4.0 * u).cos(), (4.0 * u).sin(), 0.9 * u),
        "ellipse" => {
            let t = 0.2 + 2.9 * u;
            Vec3::of(1.5 * t.cos(), 0.6 * t.sin(), 0.0)
        }
        _ => {
            let w = 2.0 * u - 1.0;
            Vec3::of(5.0 * u, (1.0 - w * w).powi(2) * (1.0 + 0.3 * w), 0.0)
        }
    }
}

pub fn places(kind: &str, g: &mut Lcg, n: usize) -> Vec<f64> {
    let last = (n - 1) as f64;
    match kind {
        "even" => (0..n).map(|k| k as f64 / last).collect(),
        "half" => {
            let mut u: Vec<f64> = (0..16).map(|k| 0.5 * f64::from(k)).collect();
            u.extend((8..24).map(f64::from));
            u.extend((0..17).map(|k| 24.0 + 0.5 * f64::from(k)));
            u.iter().map(|x| x / 32.0).collect()
        }
        "jitter" => {
            let mut u: Vec<f64> = (0..n).map(|k| k as f64 + 0.7 * g.unit()).collect();
            (u[0], u[n - 1]) = (0.0, last);
            u.iter().map(|x| x / last).collect()
        }
        _ => {
            let mut u = vec![0.0, 1.0];
            while u.len() < n {
                let x = g.unit() + 0.5;
                if u.iter().all(|y: &f64| (x - y).abs() > 2e-3) {
                    u.push(x);
                }
            }
            u.sort_by(f64::total_cmp);
            u
        }
    }
}

/// The truth (finely), the data and the bound of their noise.
pub fn case(shape: &str, kind: &str, seed: u64) -> (Vec<Vec3<f64>>, Vec<Vec3<f64>>, f64) {
    let mut g = Lcg::new(seed);
    let u = places(kind, &mut g, 49);
    let truth: Vec<_> = (0..=20_000).map(|k| shape_at(shape, f64::from(k) / 20_000.0)).collect();
    let length: f64 = truth.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let a = 2e-4 * length;
    let dimensions = if shape == "helix" { 3 } else { 2 };
    let scale = 2.0 * a / f64::from(dimensions).sqrt();
    let data = u
        .iter()
        .map(|&u| {
            let p = shape_at(shape, u);
            let (x, y) = (g.unit() * scale, g.unit() * scale);
            let z = if dimensions == 3 { g.unit() * scale } else { 0.0 };
            p + Vec3::of(x, y, z)
        })
        .collect();
    (truth, data, a)
}

pub fn data_of(points: &[Vec3<f64>], tolerance: f64, spacing: ParameterSpacing) -> Data {
    let at = parameters(points, spacing, false).unwrap();
    Data {
        limit: Limit::ball(points.len(), tolerance).unwrap(),
        layout: InterpolationSpace::new(3, &at, &[], false).unwrap(),
        ends: [EndContinuity::Free; 2],
        points: points.to_vec(),
    }
}

/// The same as the goal `near` has them: parameters by the turn of the curve, and its budget.
fn data_near(points: &[Vec3<f64>], tolerance: f64) -> (Data, f64) {
    let mut data = data_of(points, tolerance, ParameterSpacing::Chord);
    let budget = near_budget(points, Motion::Ball);
    let tolerances = vec![tolerance; points.len()];
    let at = curvature_parameters(&data, points, &tolerances, &data.layout.at).unwrap();
    data.layout = InterpolationSpace::new(3, &at, &[], false).unwrap();
    (data, budget)
}

pub fn options(measure: Measure, goal: Goal) -> DataOptions {
    DataOptions::of(measure, goal)
}

/// Root mean square distance of a curve from a fine polyline.
pub fn rms(fit: &DataFit, space: &Space, truth: &[Vec3<f64>]) -> f64 {
    let mut near = 0usize;
    let mut sum = 0.0;
    let count = 3000;
    for k in 0..=count {
        let p = shape::sample_at(space, &fit.points, None, f64::from(k) / f64::from(count)).point;
        let away = |i: usize| (truth[i] - p).norm_sq();
        if k == 0 {
            near = (0..truth.len()).min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap();
        }
        while near + 1 < truth.len() && away(near + 1) < away(near) {
            near += 1;
        }
        let mut best = f64::INFINITY;
        for i in near.saturating_sub(1)..(near + 1).min(truth.len() - 1) {
            let v = truth[i + 1] - truth[i];
            let s = ((p - truth[i]).dot(v) / v.norm_sq()).clamp(0.0, 1.0);
            best = best.min((p - truth[i] - v * s).norm_sq());
        }
        sum += best;
    }
    (sum / f64::from(count + 1)).sqrt()
}

/// Curvature at 3001 points evenly spaced in arc length, inner 98 %: pieces with hysteresis of
/// max(1 % of the range, 2 % of the largest), and sign changes above 1 % of the largest.
pub fn counted(space: &Space, control: &[Vec3<f64>], plane: bool) -> (usize, usize) {
    let all = shape::samples(space, control, None, 60);
    let mut s = vec![0.0];
    for w in all.windows(2) {
        s.push(s.last().unwrap() + (w[1].point - w[0].point).norm());
    }
    let total = *s.last().unwrap();
    let k: Vec<f64> = all
        .iter()
        .map(|q| if plane { q.signed_curvature(Vec3::of(0.0, 0.0, 1.0)) } else { q.curvature() })
        .collect();
    let mut values = Vec::new();
    let mut j = 0;
    for i in 0..3001 {
        let want = total * (0.01 + 0.98 * f64::from(i) / 3000.0);
        while j + 2 < s.len() && s[j + 1] < want {
            j += 1;
        }
        let width = s[j + 1] - s[j];
        let share = if width > 0.0 { (want - s[j]) / width } else { 0.0 };
        values.push(k[j] + (k[j + 1] - k[j]) * share);
    }
    let (lo, hi) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), &v| (l.min(v), h.max(v)));
    let most = lo.abs().max(hi.abs());
    let h = (0.01 * (hi - lo)).max(0.02 * most);
    let (mut n, mut low, mut high, mut d) = (1, values[0], values[0], 0);
    for &x in &values {
        high = f64::max(high, x);
        low = f64::min(low, x);
        if d >= 0 && x < high - h {
            n += usize::from(d > 0);
            (d, low, high) = (-1, x, x);
        } else if d <= 0 && x > low + h {
            n += usize::from(d < 0);
            (d, low, high) = (1, x, x);
        }
    }
    let signs: Vec<f64> =
        values.iter().filter(|v| v.abs() > 0.01 * most).map(|v| v.signum()).collect();
    (n, signs.windows(2).filter(|w| w[0] != w[1]).count())
}

/// True pieces and inflections, by the counts of [`counted`].
const TRUE: [(usize, usize); 6] = [(1, 0), (2, 0), (3, 1), (1, 0), (2, 0), (2, 2)];

/// Least energies within balls of the noise, third and second derivative, by Clarabel with knots at
/// the data and chord parameters; rows are the shapes, columns the spacings.
const ENERGIES: [[[f64; 2]; 4]; 6] = [
    [[69.51544, 6.204213], [69.26585, 6.187779], [69.02088, 6.137183], [69.96103, 6.159218]],
    [[7790393.0, 708.9028], [9221769.0, 723.4860], [9237700.0, 731.6531], [8918137.0, 718.7070]],
    [[423.0651, 23.48517], [421.3289, 23.56360], [397.2883, 23.80752], [431.0769, 23.58304]],
    [[3536.803, 247.6767], [3541.926, 247.1310], [3553.532, 246.5813], [3548.896, 247.7250]],
    [[11325.61, 121.7483], [11369.47, 120.3432], [11518.77, 118.4063], [13673.11, 129.4561]],
    [[13841.13, 192.9825], [14289.78, 192.8606], [15822.52, 203.1288], [13981.55, 196.0297]],
];

#[test]
fn least_energies_are_a_conic_solvers() {
    for (shape, row) in SHAPES.iter().zip(&ENERGIES) {
        for (kind, wanted) in SPACINGS.iter().zip(row) {
            let (_, points, a) = case(shape, kind, 1);
            let data = data_of(&points, a, ParameterSpacing::Chord);
            let mean = data.layout.space.mean_span();
            for (k, measure) in [Measure::Variation, Measure::Bending].into_iter().enumerate() {
                let fit = fair_data(&data, &options(measure, Goal::Fairest)).unwrap();
                let energy = fit.certificate.value / mean.powi(if k == 0 { 5 } else { 3 });
                let off = (energy / wanted[k] - 1.0).abs();
                assert!(off < 1e-5, "{shape} {kind} {measure:?}: {energy:e} for {:e}", wanted[k]);
                assert!(fit.certificate.gap <= 1e-8 * fit.certificate.value, "{shape} {kind}");
                assert!(fit.residuals.iter().all(|&r| r <= a), "{shape} {kind}");
            }
        }
    }
}

#[test]
fn near_is_nearer_to_the_truth_at_any_spacing() {
    let seeds = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 1..41 } else { 1..4 };
    let (mut all, mut more) = (Vec::new(), 0);
    for seed in seeds {
        for (shape, (pieces, inflections)) in SHAPES.iter().zip(TRUE) {
            for kind in SPACINGS {
                let (truth, points, a) = case(shape, kind, seed);
                let made = CurveRequest::of(&points, a).curve(&points).unwrap();
                let (fit, space) = (&made.fit, &made.data.layout.space);
                let (p, i) = counted(space, &fit.points, *shape != "helix");
                let off = rms(fit, space, &truth) / a;
                let here = format!("{shape} {kind} seed {seed}");
                assert!(fit.residuals.iter().all(|&r| r <= a * (1.0 + 1e-12)), "{here}");
                assert!(i <= inflections, "{here}: {i} inflections");
                // Random points may miss the part beside a nose, which then cannot be
                // reconstructed.
                let known = *shape != "naca0012" || kind != "random";
                assert!(!known || off <= 0.5, "{here}: rms {off} of the noise");
                more += usize::from(p > pieces + 2);
                all.push(off);
            }
        }
    }
    all.sort_by(f64::total_cmp);
    let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
    // Over 960 draws: 0.24 and 0.43.
    assert!(at(0.5) < 0.27 && at(0.95) < 0.48, "median {}, 95 % {}", at(0.5), at(0.95));
    // More than two pieces beyond the truth are rare.
    assert!(20 * more <= all.len(), "{more} of {}", all.len());
}

#[test]
fn parameters_by_curvature_turn_scale_and_are_the_datas() {
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9);
    for closed in [false, true] {
        for seed in 1..9 {
            let mut g = Lcg::new(seed);
            let n = 24;
            let points: Vec<Vec3<f64>> = (0..n)
                .map(|k| {
                    let t = 6.0 * (k as f64 + 0.4 * g.unit()) / f64::from(n);
                    let noise = Vec3::of(g.unit(), g.unit(), 0.0) * 2e-3;
                    Vec3::of(3.0 * t.cos(), t.sin(), 0.0) + noise
                })
                .collect();
            let own = |points: &[Vec3<f64>], tolerance: f64| {
                let at = parameters(points, ParameterSpacing::Chord, closed).unwrap();
                let data = Data {
                    limit: Limit::ball(points.len(), tolerance).unwrap(),
                    layout: InterpolationSpace::new(3, &at, &[], closed).unwrap(),
                    ends: [EndContinuity::Free; 2],
                    points: points.to_vec(),
                };
                let all = vec![tolerance; points.len()];
                curvature_parameters(&data, points, &all, &at).unwrap()
            };
            let at = own(&points, 2e-3);
            assert!(at[0] == 0.0 && at.windows(2).all(|w| w[0] < w[1]), "{at:?}");
            let moved = |p: Vec3<f64>| Vec3::of(0.6 * p.x - 0.8 * p.y, 0.8 * p.x + 0.6 * p.y, p.z);
            let place = |&p: &Vec3<f64>| moved(p) * 1e6 + Vec3::of(5e5, -7e5, 3e5);
            let turned: Vec<_> = points.iter().map(place).collect();
            assert!(close(&own(&turned, 2e3), &at));
            if closed {
                // Starting at another point, and in reverse order.
                let first = 7;
                let from: Vec<_> =
                    (0..n as usize).map(|k| points[(k + first) % n as usize]).collect();
                let other = own(&from, 2e-3);
                let wanted: Vec<f64> = (0..n as usize)
                    .map(|k| (at[(k + first) % n as usize] - at[first]).rem_euclid(1.0))
                    .collect();
                assert!(close(&other, &wanted), "{other:?} {wanted:?}");
            } else {
                let back: Vec<_> = points.iter().rev().copied().collect();
                let other: Vec<f64> = own(&back, 2e-3).iter().rev().map(|t| 1.0 - t).collect();
                assert!(close(&other, &at), "{other:?} {at:?}");
            }
        }
    }
    // Exact points, and those that may not move, keep their curve.
    let circle: Vec<_> =
        (0..20).map(|k| 0.2 * f64::from(k)).map(|t| Vec3::of(t.cos(), t.sin(), 0.0)).collect();
    let (data, _) = data_near(&circle, 1e-3);
    assert_eq!(data.layout.at, parameters(&circle, ParameterSpacing::Chord, false).unwrap());
}

/// Steps of a random spacing whose largest is 100 times the smallest.
fn stations(g: &mut Lcg, n: usize) -> Vec<f64> {
    let mut t = vec![0.0];
    for _ in 1..n {
        t.push(t.last().unwrap() + 100f64.powf(g.unit() + 0.5));
    }
    let last = t[n - 1];
    t.iter().map(|x| x / last).collect()
}

/// The largest move of a datum's own curve.
fn moved(fit: &DataFit) -> f64 {
    fit.points.iter().zip(&fit.original).map(|(p, q)| (*p - *q).norm()).fold(0.0, f64::max)
}

#[test]
fn exact_shapes_do_not_move() {
    let mut g = Lcg::new(7);
    let rounds = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 300 } else { 12 };
    let x = ParameterSpacing::Along(Vec3::of(1.0, 0.0, 0.0));
    let measures =
        [Measure::Second, Measure::Third, Measure::Jumps, Measure::Bending, Measure::Variation];
    for round in 0..rounds {
        let t = stations(&mut g, 12 + round % 30);
        let line: Vec<_> = t.iter().map(|&t| Vec3::of(t, 0.1 * t - 0.3, 0.7 * t)).collect();
        for spacing in [x, ParameterSpacing::Chord] {
            for measure in measures {
                for goal in [Goal::Fairest, Goal::Near(0.8), Goal::Budget(0.8)] {
                    let data = data_of(&line, 0.01, spacing);
                    let fit = fair_data(&data, &options(measure, goal)).unwrap();
                    assert_eq!(moved(&fit), 0.0, "{measure:?} {goal:?} {spacing:?}");
                }
            }
        }
        // Polynomials below the order of the measure are in its null space; others are as fair as
        // it gets.
        for power in [2, 3] {
            let curve: Vec<_> = t.iter().map(|&t| Vec3::of(t, t.powi(power), 0.0)).collect();
            for measure in measures {
                let data = data_of(&curve, 1e-4, x);
                let fit = fair_data(&data, &options(measure, Goal::Near(0.8))).unwrap();
                assert!(moved(&fit) <= 1e-12, "{measure:?} {power}: {}", moved(&fit));
            }
        }
        let dense = stations(&mut g, 60 + round % 30);
        let turn = 5.0;
        let circle: Vec<_> =
            dense.iter().map(|&t| Vec3::of((turn * t).cos(), (turn * t).sin(), 0.0)).collect();
        let helix: Vec<_> =
            dense.iter().map(|&t| Vec3::of((turn * t).cos(), (turn * t).sin(), 0.9 * t)).collect();
        let all = [Measure::Second, Measure::Bending, Measure::Third, Measure::Variation];
        for (shape, measures) in [(circle, &all[..]), (helix, &all[..2])] {
            for &measure in measures {
                let data = data_of(&shape, 1e-4, ParameterSpacing::Chord);
                let fit = fair_data(&data, &options(measure, Goal::Near(0.8))).unwrap();
                assert!(moved(&fit) <= 1e-12, "{measure:?}: {}", moved(&fit));
            }
        }
    }
}

#[test]
fn results_turn_and_scale_with_the_data() {
    let (_, points, a) = case("sac", "random", 3);
    let place = |points: &[Vec3<f64>], a: f64| -> Vec<Vec3<f64>> {
        let data = data_of(points, a, ParameterSpacing::Chord);
        let fit = fair_data(&data, &options(Measure::Variation, Goal::Near(0.8))).unwrap();
        (0..points.len())
            .map(|k| {
                let t = data.layout.at[k];
                shape::sample_at(&data.layout.space, &fit.points, None, t).point
            })
            .collect()
    };
    let plain = place(&points, a);
    let (s, c) = (0.6, 0.8);
    let turned = |p: Vec3<f64>| {
        Vec3::of(c * p.x - s * p.y, s * p.x + c * p.y, p.z) * 1000.0 + Vec3::of(5.0, -7.0, 3.0)
    };
    let moved = place(&points.iter().map(|&p| turned(p)).collect::<Vec<_>>(), 1000.0 * a);
    let backwards = place(&points.iter().rev().copied().collect::<Vec<_>>(), a);
    for k in 0..points.len() {
        assert!((moved[k] - turned(plain[k])).norm() < 1e-3 * 1000.0 * a, "{k}");
        assert!((backwards[points.len() - 1 - k] - plain[k]).norm() < 1e-3 * a, "{k}");
    }
}

#[test]
fn third_derivatives_add_no_bends() {
    // Two straight lines joined by a rounding, read with noise: prone to false bends.
    let mut g = Lcg::new(11);
    for round in 0..6 {
        let t = stations(&mut g, 40);
        let points: Vec<_> = t
            .iter()
            .map(|&t| {
                let x = 4.0 * t - 2.0;
                Vec3::of(x, (0.02 + x * x).sqrt() + 6e-3 * g.unit(), 0.0)
            })
            .collect();
        let data = data_of(&points, 6e-3, ParameterSpacing::Chord);
        let count = |measure, bends| {
            let options = DataOptions { bends, ..options(measure, Goal::Fairest) };
            let fit = fair_data(&data, &options).unwrap();
            assert!(fit.residuals.iter().all(|&r| r <= 6e-3));
            // Signs of what is more than rounding beside the rounding's curvature.
            let samples = shape::samples(&data.layout.space, &fit.points, None, 16);
            let all = shape::curvatures(&samples);
            let largest = all.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
            let seen: Vec<f64> = all.into_iter().filter(|k| k.abs() > 1e-5 * largest).collect();
            seen.windows(2).filter(|w| w[0] * w[1] < 0.0).count()
        };
        let (held, least) = (count(Measure::Variation, false), count(Measure::Bending, true));
        assert!(held <= least, "round {round}: {held} against {least}");
    }
}

/// Tolerances of a range of points alone: the others stay on the curve, whose control points about them are the same to
/// the bit.
#[test]
fn a_range_is_faired_alone() {
    let mut g = Lcg::new(3);
    let at = |k: usize| 100.0 * k as f64 / 59.0;
    let height = |x: f64| 10.0 * (std::f64::consts::PI * x / 100.0).sin();
    let points: Vec<_> =
        (0..60).map(|k| Vec3::of(at(k), height(at(k)) + 0.04 * g.unit(), 0.0)).collect();
    for (from, to) in [(20, 40), (0, 20), (33, 60), (5, 9)] {
        let mut request = CurveRequest::of(&points, 0.02);
        (0..60).filter(|k| !(from..to).contains(k)).for_each(|k| request.tolerances[k] = 0.0);
        for goal in [request.goal, Goal::Fairest] {
            let made = CurveRequest { goal, ..request.clone() }.curve(&points).unwrap();
            let fit = &made.fit;
            for k in 0..60 {
                let most = if (from..to).contains(&k) { 0.02 * (1.0 + 1e-9) } else { 1e-13 };
                assert!(fit.residuals[k] <= most, "{from} {to} {k}: {:e}", fit.residuals[k]);
            }
            let kept = (0..60).filter(|&c| c + 3 < from || c > to + 3);
            kept.for_each(|c| assert_eq!(fit.points[c], fit.original[c], "{from} {to} {c}"));
            assert!(goal != Goal::Fairest || moved(fit) > 1e-3);
        }
    }
}

#[test]
fn data_without_tolerance_and_repeated_data() {
    let (_, points, a) = case("sac", "jitter", 1);
    let mut radii = vec![a; points.len()];
    (radii[10], radii[30]) = (0.0, f64::INFINITY);
    let data = Data {
        limit: Limit::new(Motion::Ball, radii).unwrap(),
        ..data_of(&points, a, ParameterSpacing::Chord)
    };
    for goal in [Goal::Fairest, Goal::Near(0.8), Goal::Nearest(0.1)] {
        let fit = fair_data(&data, &options(Measure::Variation, goal)).unwrap();
        assert!(fit.residuals[10] <= 1e-7 * a, "{goal:?} {}", fit.residuals[10]);
        assert!((0..points.len()).all(|k| k == 30 || fit.residuals[k] <= a * (1.0 + 1e-9)));
    }
    // A repeated point is one datum; points too far apart are not.
    let mut twice = points.clone();
    twice.insert(5, points[5]);
    let one = merged(&twice, &vec![a; twice.len()], false).unwrap();
    assert_eq!((one.points.len(), one.of[5], one.of[6]), (points.len(), 5, 5));
    let same = vec![points[0]; 9];
    let all = merged(&same, &[a; 9], false).unwrap();
    assert_eq!(all.points.len(), 1);
    let apart = [points[0], points[0] + Vec3::of(1e-9, 0.0, 0.0), points[40]];
    assert_eq!(merged(&apart, &[0.0; 3], false), Err(FairError::Coincident { first: 0 }));
}
