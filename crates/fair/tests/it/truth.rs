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

/// A clothoid by the trapezoidal rule on a fine grid, linear between its places.
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

pub fn data_of(points: &[Vec3<f64>], tolerance: f64, spacing: Spacing) -> Data {
    let at = parameters(points, spacing, false).unwrap();
    Data {
        limit: Limit::ball(points.len(), tolerance).unwrap(),
        layout: Layout::new(3, &at, &[], false).unwrap(),
        ends: [End::Free; 2],
        points: points.to_vec(),
    }
}

pub fn options(measure: Measure, goal: Goal) -> DataOptions {
    DataOptions { measure, goal, conditions: Vec::new(), bends: true, accuracy: 1e-9 }
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

/// Curvature at 3001 places even in arc length, inner 98 %: pieces with hysteresis of
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

#[test]
fn survey() {
    for (measure, goal) in [
        (Measure::Variation, Goal::Fairest),
        (Measure::Variation, Goal::Budget(0.8)),
        (Measure::Variation, Goal::Nearest(0.1)),
        (Measure::Variation, Goal::Nearest(0.25)),
        (Measure::Variation, Goal::Nearest(0.5)),
        (Measure::Variation, Goal::Nearest(1.0)),
        (Measure::Bending, Goal::Budget(0.8)),
        (Measure::Bending, Goal::Nearest(0.1)),
    ] {
        for kind in SPACINGS {
            let mut out = Vec::new();
            let (mut worst, mut pieces, mut bends, mut used): (
                Vec<f64>,
                Vec<i64>,
                Vec<i64>,
                Vec<f64>,
            ) = Default::default();
            for seed in [1, 2] {
                for (shape, (pt, it)) in
                    SHAPES.iter().zip([(1, 0), (2, 0), (3, 1), (1, 0), (2, 0), (2, 2)])
                {
                    let (truth, points, a) = case(shape, kind, seed);
                    let data = data_of(&points, a, Spacing::Chord);
                    let t = std::time::Instant::now();
                    let fit = fair_data(&data, &options(measure, goal)).unwrap();
                    let ms = t.elapsed().as_secs_f64() * 1e3;
                    let (p, i) = counted(&data.layout.space, &fit.points, *shape != "helix");
                    worst.push(rms(&fit, &data.layout.space, &truth) / a);
                    pieces.push(p as i64 - pt);
                    bends.push(i as i64 - it);
                    used.push(fit.used);
                    out.push(format!(
                        "{shape} E {:.6e} rms {:.2} p{p} i{i} used {:.2} {ms:.1}ms",
                        fit.certificate.value
                            / data
                                .layout
                                .space
                                .mean_span()
                                .powi(if measure == Measure::Variation { 5 } else { 3 }),
                        worst.last().unwrap(),
                        fit.used
                    ));
                }
            }
            worst.sort_by(f64::total_cmp);
            used.sort_by(f64::total_cmp);
            println!(
                "{measure:?} {goal:?} {kind}: rms median {:.2} worst {:.2} pieces +{} bends +{} used {:.2}..{:.2}",
                worst[6],
                worst[11],
                pieces.iter().max().unwrap(),
                bends.iter().max().unwrap(),
                used[0],
                used[11]
            );
            if goal == Goal::Fairest {
                println!("   {}", out.join("\n   "));
            }
        }
    }
}
