//! Density of the divisions of a trimmed face along its rims and in its interior, by curvature.

use moldloft_num::{Fineness, Order, Real, SurfJet, Vec3, unit_normal};
use moldloft_registry::{CurveRef, DivisionDensity, SurfaceRef};

/// Intervals of the first and of the finest sampling of a rim between two breaks.
const SAMPLES: [usize; 2] = [16, 8192];

/// Maximum relative difference of the divisions by two samplings of a rim that agree.
const AGREEMENT: f64 = 0.02;

/// Samples of the interior along u and along v, at least.
const CELLS: usize = 24;

/// A curve on a surface at a parameter: its first and second derivative, the unit normal of the
/// surface and its derivative.
struct RimJet {
    d: Vec3,
    dd: Vec3,
    turn: f64,
}

fn real(jet: &SurfJet<impl Real>) -> SurfJet<f64> {
    SurfJet {
        p: jet.p.re(),
        u: jet.u.re(),
        v: jet.v.re(),
        uu: jet.uu.re(),
        uv: jet.uv.re(),
        vv: jet.vv.re(),
    }
}

fn rim_jet<T: Real>(surface: &SurfaceRef<T>, curve: &CurveRef<T>, t: f64) -> Option<RimJet> {
    let [w, dw, ddw] = curve.on_surface(T::from(t), Order::Second)?;
    let s = real(&surface.jet(w.x, w.y, Order::Second));
    let (du, dv) = (dw.x.re(), dw.y.re());
    let d = s.u * du + s.v * dv;
    let (along_u, along_v) = (s.uu * du + s.uv * dv, s.uv * du + s.vv * dv);
    let dd = along_u * du + along_v * dv + s.u * ddw.x.re() + s.v * ddw.y.re();
    let turn = unit_normal(&s).map_or(0.0, |(n, size)| {
        let dn = along_u.cross(s.v) + s.u.cross(along_v);
        (dn - n * n.dot(dn)).norm() / size
    });
    Some(RimJet { d, dd, turn })
}

/// Speed of a curve, relative to its largest and to a side of the face, up to which it rests at a
/// point: its turn is noise.
const RESTING: f64 = 1e-9;

/// Spacing of the divisions of a rim: equal parts of the integral of their density between breaks.
pub(crate) fn rim_density<T: Real>(
    fineness: &Fineness,
    surface: &SurfaceRef<T>,
    curve: &CurveRef<T>,
) -> DivisionDensity {
    let mut stops = vec![0.0];
    stops.extend(breaks_of(surface, curve));
    stops.push(1.0);
    let speed = |t: f64| rim_jet(surface, curve, t).map_or(0.0, |j| j.d.norm());
    let middles = stops.windows(2).map(|w| speed(0.5 * (w[0] + w[1])));
    let side = if fineness.side.is_finite() { fineness.side } else { 0.0 };
    let resting = RESTING * middles.fold(side, f64::max);
    let mut density = DivisionDensity::default();
    for w in stops.windows(2) {
        let (from, to) = (w[0], w[1]);
        let sampled = |m: usize| -> Vec<f64> {
            let step = (to - from) / m as f64;
            let at = (0..m).map(|i| from + (i as f64 + 0.5) * step);
            at.map(|t| {
                let moving = rim_jet(surface, curve, t).filter(|j| j.d.norm() > resting);
                moving.map_or(0.0, |j| fineness.along(j.d, j.dd, j.turn)) * step
            })
            .collect()
        };
        let mut parts = sampled(SAMPLES[0]);
        let mut sum: f64 = parts.iter().sum();
        while parts.len() < SAMPLES[1] {
            let finer = sampled(2 * parts.len());
            let next: f64 = finer.iter().sum();
            let agree = (next - sum).abs() <= AGREEMENT * next.max(2.0);
            (parts, sum) = (finer, next);
            if agree {
                break;
            }
        }
        density.extend(to, &parts);
    }
    density
}

/// The plane of parameters, scaled to panels with sides of about 1. `inside` selects the parameters
/// of a line v = const; `low` and `high` are the corners of their box.
pub(crate) fn stretched<T: Real>(
    fineness: &Fineness,
    surface: &SurfaceRef<T>,
    [low, high]: [[f64; 2]; 2],
    inside: impl Fn(&[f64], f64) -> Vec<bool>,
) -> Stretch {
    let kinks = surface.breaks();
    let stops: [Vec<f64>; 2] = std::array::from_fn(|k| {
        let within = kinks[k].iter().copied().filter(|b| *b > low[k] && *b < high[k]);
        std::iter::once(low[k]).chain(within).chain([high[k]]).collect()
    });
    let grid: [Vec<f64>; 2] = std::array::from_fn(|k| {
        let parts = CELLS.div_ceil(stops[k].len() - 1).max(2);
        let mut at: Vec<f64> = stops[k]
            .windows(2)
            .flat_map(|w| (0..parts).map(move |i| w[0] + (w[1] - w[0]) * (i as f64 / parts as f64)))
            .collect();
        at.push(high[k]);
        at
    });
    let middles = |k: usize| grid[k].windows(2).map(|w| 0.5 * (w[0] + w[1])).collect::<Vec<f64>>();
    let (us, vs) = (middles(0), middles(1));
    let mut most: [Vec<f64>; 2] = [vec![0.0; us.len()], vec![0.0; vs.len()]];
    let within: Vec<Vec<bool>> = vs.iter().map(|&v| inside(&us, v)).collect();
    for (i, &u) in us.iter().enumerate() {
        let held: Vec<usize> = (0..vs.len()).filter(|&j| within[j][i]).collect();
        let at: Vec<f64> = held.iter().map(|&j| vs[j]).collect();
        for (&j, jet) in held.iter().zip(surface.line(T::from(u), &at, Order::Second)) {
            if let Some([a, b]) = fineness.metric(&real(&jet)) {
                most[0][i] = most[0][i].max(a);
                most[1][j] = most[1][j].max(b);
            }
        }
    }
    let sum = std::array::from_fn(|k| {
        fill(&mut most[k]);
        let mut sum = vec![0.0];
        for (w, m) in grid[k].windows(2).zip(&most[k]) {
            sum.push(sum[sum.len() - 1] + m.sqrt() * (w[1] - w[0]));
        }
        // A direction without extent is not stretched.
        if sum[sum.len() - 1] > 0.0 { sum } else { grid[k].iter().map(|x| x - low[k]).collect() }
    });
    Stretch { at: grid, sum, stops }
}

/// Gives entries without a value that of the nearest which has one.
fn fill(values: &mut [f64]) {
    let known: Vec<usize> = (0..values.len()).filter(|&k| values[k] > 0.0).collect();
    for k in 0..values.len() {
        if values[k] > 0.0 {
            continue;
        }
        if let Some(&near) = known.iter().min_by_key(|&&j| j.abs_diff(k)) {
            values[k] = values[near];
        }
    }
}

/// The parameters at which a curve on a surface may bend: its own breaks, and where it crosses those of the surface.
pub(crate) fn breaks_of<T: Real>(surface: &SurfaceRef<T>, curve: &CurveRef<T>) -> Vec<f64> {
    let mut found = curve.breaks();
    let place =
        |t: f64| curve.on_surface(T::from(t), Order::Zero).map(|[w, ..]| [w.x.re(), w.y.re()]);
    for crossing in crossings(&surface.breaks(), &found, place) {
        found.push(crossing.0);
    }
    found.retain(|t| *t > 1e-9 && *t < 1.0 - 1e-9);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    found
}

/// Steps between two breaks of a curve within which one crossing of each line is found.
const CROSSING_STEPS: usize = 48;

/// Parameters t at which a path crosses lines u = const (axis 0) or v = const (axis 1), with axis
/// and line.
pub(crate) fn crossings(
    lines: &[Vec<f64>; 2],
    breaks: &[f64],
    place: impl Fn(f64) -> Option<[f64; 2]>,
) -> Vec<(f64, usize, f64)> {
    let mut found = Vec::new();
    if lines.iter().all(Vec::is_empty) {
        return found;
    }
    let mut stops = vec![0.0];
    stops.extend(breaks.iter().filter(|t| **t > 0.0 && **t < 1.0));
    stops.push(1.0);
    let mut ts = Vec::new();
    for w in stops.windows(2) {
        ts.extend(
            (0..CROSSING_STEPS).map(|i| w[0] + (w[1] - w[0]) * (i as f64 / CROSSING_STEPS as f64)),
        );
    }
    ts.push(1.0);
    let Some(places) = ts.iter().map(|&t| place(t)).collect::<Option<Vec<_>>>() else {
        return found;
    };
    for (axis, lines) in lines.iter().enumerate() {
        for k in 1..ts.len() {
            let (a, b) = (places[k - 1][axis], places[k][axis]);
            for &line in lines.iter().filter(|&&x| (a - x) * (b - x) < 0.0 || (b == x && a != x)) {
                let (mut low, mut high) = (ts[k - 1], ts[k]);
                let rising = b > a;
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if middle <= low || middle >= high {
                        break;
                    }
                    let Some(p) = place(middle) else { break };
                    if (p[axis] < line) == rising { low = middle } else { high = middle }
                }
                found.push((high, axis, line));
            }
        }
    }
    found
}

/// The plane of parameters, stretched along u and along v.
#[derive(Debug)]
pub(crate) struct Stretch {
    /// Parameters, ascending, between which it is linear.
    at: [Vec<f64>; 2],
    /// Images of these parameters.
    sum: [Vec<f64>; 2],
    /// The ends of the box and the breaks of the surface in it.
    stops: [Vec<f64>; 2],
}

impl Stretch {
    /// Image of a point of the parameter plane.
    pub fn forward(&self, p: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| between(&self.at[k], &self.sum[k], p[k]))
    }

    /// The parameter of a coordinate along an axis.
    pub fn back(&self, k: usize, x: f64) -> f64 {
        between(&self.sum[k], &self.at[k], x)
    }

    /// Number of points of a net with lines 1 apart.
    pub fn points(&self) -> f64 {
        let [m, n] = self.extents();
        m * n
    }

    fn extents(&self) -> [f64; 2] {
        [0, 1].map(|k| self.sum[k][self.sum[k].len() - 1].max(1.0))
    }

    /// Parameter lines in u and v whose intersections are the points of the interior: at the breaks
    /// and about 1 apart between them, wider if there were more than `most` intersections, since
    /// the curvature at a fold is unbounded.
    pub fn lines(&self, most: usize) -> [Vec<f64>; 2] {
        let reach = self.extents();
        let coarser = (reach[0] * reach[1] / most as f64).sqrt().max(1.0);
        // The shorter direction keeps at least one line.
        let shorter = reach[0].min(reach[1]);
        let coarser =
            if coarser > shorter { reach[0].max(reach[1]) / most as f64 } else { coarser };
        [0, 1].map(|k| self.lines_along(k, coarser))
    }

    fn lines_along(&self, k: usize, coarser: f64) -> Vec<f64> {
        let ends: Vec<f64> =
            self.stops[k].iter().map(|&x| between(&self.at[k], &self.sum[k], x)).collect();
        let mut lines = Vec::new();
        for w in ends.windows(2) {
            let n = ((w[1] - w[0]) / coarser - 1e-9).ceil().max(1.0) as usize;
            lines.extend((0..n).map(|i| w[0] + (w[1] - w[0]) * (i as f64 / n as f64)));
        }
        lines.push(ends[ends.len() - 1]);
        lines.into_iter().map(|x| self.back(k, x)).collect()
    }
}

/// Linear between the entries of a table, and beyond it.
fn between(from: &[f64], to: &[f64], x: f64) -> f64 {
    let k = from.partition_point(|a| *a <= x).clamp(1, from.len() - 1);
    let step = from[k] - from[k - 1];
    let share = if step > 0.0 { (x - from[k - 1]) / step } else { 0.0 };
    to[k - 1] + (to[k] - to[k - 1]) * share
}
