//! Pairs of points of two curves joined by the rulings of a developable surface.

use super::develop::Phase;
use moldloft_num::{Order, Real, Vec3, find_root};
use moldloft_registry::{CallError, CurveRef};

/// Steps of each curve's parameter in which pairs are searched for.
const STEPS: usize = 128;

/// Determinant relative to its factors below which it is rounding and the three vectors are
/// coplanar.
const FLAT: f64 = 1e-11;

/// Pairs (s, t) from (0, 0) to (1, 1).
pub struct Pairing {
    /// The pair at which a phase begins, and the phase.
    pub phases: Vec<([f64; 2], Phase)>,
    /// Pairs of rulings, ascending.
    pub stations: Vec<[f64; 2]>,
}

/// A candidate on a level s + t = const: w = (s - t) / 2 and its type.
#[derive(Clone, Copy)]
struct RulingCandidate {
    w: f64,
    kind: RulingKind,
    /// Length of the shortest path to it, and its predecessor on the level before.
    cost: f64,
    from: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum RulingKind {
    /// The first and the last pair, which are there in any case.
    End,
    Root,
    /// s = 0, or t = 1.
    Low,
    /// t = 0, or s = 1.
    High,
}

/// Position, first derivative.
type Place = [Vec3<f64>; 2];

/// The determinant of a pair, relative to its factors, and true if the surface crosses the ruling
/// without a fold between the curves.
fn determinant([p, d]: Place, [q, e]: Place) -> (f64, bool) {
    let ruling = q - p;
    let size = d.norm() * e.norm() * ruling.norm();
    let det = d.cross(e).dot(ruling);
    let value = if size > 0.0 { det / size } else { 0.0 };
    (value, d.cross(ruling).dot(e.cross(ruling)) > 0.0)
}

struct RulingSearch<'c, T: Real> {
    curves: [&'c CurveRef<T>; 2],
    places: [Vec<Place>; 2],
}

/// Pairs between two curves: rulings, and fans at ends without rulings.
///
/// On each of the lines s + t = const the determinant is searched for changes of sign. The chain of
/// such roots that is monotonic along both curves, completed by fans of least length, is the
/// shortest path through the levels (Bellman).
///
/// # Errors
/// `no-rulings` and `rulings-cross`.
pub fn pair<T: Real>(curves: [&CurveRef<T>; 2]) -> Result<Pairing, CallError> {
    let places = curves.map(|curve| {
        let at = |k: usize| {
            let [p, d, _] = curve.jet(T::from(k as f64 / STEPS as f64), Order::First);
            [p.re(), d.re()]
        };
        (0..=STEPS).map(at).collect::<Vec<_>>()
    });
    let search = RulingSearch { curves, places };
    if search.is_flat() {
        let stations = vec![[0.0; 2], [1.0; 2]];
        return Ok(Pairing { phases: vec![([0.0; 2], Phase::Flat)], stations });
    }
    let mut crossed = None;
    let mut levels =
        vec![vec![RulingCandidate { w: 0.0, kind: RulingKind::End, cost: 0.0, from: 0 }]];
    for level in 1..=2 * STEPS {
        let mut nodes = if level < 2 * STEPS {
            search.candidates(level, &mut crossed)
        } else {
            vec![RulingCandidate { w: 0.0, kind: RulingKind::End, cost: 0.0, from: 0 }]
        };
        connect(&levels[level - 1], &mut nodes);
        if nodes.is_empty() {
            return Err(search.broken(level, crossed));
        }
        levels.push(nodes);
    }
    let mut way = vec![levels[2 * STEPS][0]];
    for level in (0..2 * STEPS).rev() {
        way.push(levels[level][way[way.len() - 1].from]);
    }
    way.reverse();
    if !way.iter().any(|n| n.kind == RulingKind::Root) {
        return Err(search.broken(0, crossed));
    }
    Ok(search.phases(&way))
}

/// Step of u between levels.
const RISE: f64 = 0.5 / STEPS as f64;

/// Assigns each candidate its shortest path from the level before, and drops unreachable ones.
fn connect(before: &[RulingCandidate], nodes: &mut Vec<RulingCandidate>) {
    for node in nodes.iter_mut() {
        node.cost = f64::INFINITY;
        for (k, from) in before.iter().enumerate() {
            let step = (node.w - from.w).abs();
            // Neither curve may be run backwards; located roots are exact to rounding.
            if step > RISE * (1.0 + 1e-9) {
                continue;
            }
            // The cost of a fan is its length; corners of the path have a small cost.
            let fan = f64::from(u8::from(matches!(node.kind, RulingKind::Low | RulingKind::High)));
            let turn = f64::from(u8::from(node.kind != from.kind));
            let cost = from.cost + fan + 0.25 * turn + 0.01 * (step / RISE).powi(2);
            if cost < node.cost {
                (node.cost, node.from) = (cost, k);
            }
        }
    }
    nodes.retain(|n| n.cost.is_finite());
}

impl<T: Real> RulingSearch<'_, T> {
    fn is_flat(&self) -> bool {
        let each = |p: &Place| self.places[1].iter().all(|q| determinant(*p, *q).0.abs() <= FLAT);
        self.places[0].iter().all(each)
    }

    fn at(&self, s: f64, t: f64) -> (f64, bool) {
        let [p, q] = [(0, s), (1, t)].map(|(k, t)| {
            let [p, d, _] = self.curves[k].jet(T::from(t), Order::First);
            [p.re(), d.re()]
        });
        determinant(p, q)
    }

    /// The candidates on a level: roots and both ends. Roots at which the surface would fold are
    /// recorded.
    fn candidates(&self, level: usize, crossed: &mut Option<[f64; 2]>) -> Vec<RulingCandidate> {
        let u = level as f64 * RISE;
        let (first, last) = (level.saturating_sub(STEPS), level.min(STEPS));
        let reach = u.min(1.0 - u);
        let node = |w: f64, kind: RulingKind| RulingCandidate { w, kind, cost: 0.0, from: 0 };
        let mut nodes = vec![node(-reach, RulingKind::Low)];
        let value = |i: usize| determinant(self.places[0][i], self.places[1][level - i]).0;
        for i in first..last {
            let (a, b) = (value(i), value(i + 1));
            if a == 0.0 || a.signum() != b.signum() {
                let s = |i: usize| i as f64 / STEPS as f64;
                let at = |s: f64| self.at(s, 2.0 * u - s).0;
                let Ok(s) = find_root(at, s(i), s(i + 1)) else { continue };
                let t = 2.0 * u - s;
                if self.at(s, t).1 {
                    nodes.push(node(0.5 * (s - t), RulingKind::Root));
                } else {
                    *crossed = Some([s, t]);
                }
            }
        }
        nodes.push(node(reach, RulingKind::High));
        nodes
    }

    /// Error of a path that ends at a level (0: fans only).
    fn broken(&self, level: usize, crossed: Option<[f64; 2]>) -> CallError {
        let [a, b] = self.curves;
        let fault = match crossed {
            Some([s, t]) => CallError::new("rulings-cross", "the rulings cross between the curves")
                .expected("curves that a plate can connect without folding back")
                .found(format!(
                    "a ruling from s = {s:.4} to t = {t:.4} past the edge of regression"
                ))
                .help("bring the curves nearer together, or bend them less"),
            None => {
                let at = if level == 0 {
                    "no pair of points with a common tangent plane".to_owned()
                } else {
                    format!("none that continue from u = {:.4}", (level as f64 - 1.0) * RISE)
                };
                CallError::new("no-rulings", "no rulings of a developable surface")
                    .expected("points of both curves with a common tangent plane")
                    .found(at)
                    .help(
                        "make one of the curves free to follow: a RuledSurf needs no such rulings",
                    )
            }
        };
        fault.related(a.key, "is the first curve").related(b.key, "is the second curve")
    }

    /// Phases and stations of a path through the levels.
    fn phases(&self, way: &[RulingCandidate]) -> Pairing {
        let pair_of = |level: usize, w: f64| {
            let u = level as f64 * RISE;
            [u + w, u - w]
        };
        let phase_of = |level: usize, node: &RulingCandidate| {
            let early = 2 * level <= 2 * STEPS;
            match (node.kind, early) {
                (RulingKind::Low, true) => Phase::Fan { first: true, end: 0.0 },
                (RulingKind::Low, false) => Phase::Fan { first: false, end: 1.0 },
                (RulingKind::High, true) => Phase::Fan { first: false, end: 0.0 },
                (RulingKind::High, false) => Phase::Fan { first: true, end: 1.0 },
                _ => Phase::Rulings,
            }
        };
        let mut phases: Vec<([f64; 2], Phase)> = Vec::new();
        let mut stations = Vec::new();
        let inner = 1..way.len() - 1;
        for level in inner.clone() {
            let phase = phase_of(level, &way[level]);
            if phases.last().map(|(_, p)| *p) != Some(phase) {
                let begin = match phases.last() {
                    None => [0.0, 0.0],
                    Some((_, before)) => {
                        let (low, high) = (level - 1, level);
                        self.corner(
                            pair_of(low, way[low].w),
                            pair_of(high, way[high].w),
                            *before,
                            phase,
                        )
                    }
                };
                if !phases.is_empty() {
                    stations.push(begin);
                }
                phases.push((begin, phase));
            }
            if phase == Phase::Rulings {
                stations.push(pair_of(level, way[level].w));
            }
        }
        stations.insert(0, [0.0; 2]);
        stations.push([1.0; 2]);
        Pairing { phases, stations }
    }

    /// The pair between two levels at which a fan changes to rulings or rulings to a fan: the zero
    /// of the determinant on the line of the fan.
    fn corner(&self, low: [f64; 2], high: [f64; 2], before: Phase, after: Phase) -> [f64; 2] {
        let (first, end) = match (before, after) {
            (Phase::Fan { first, end }, _) | (_, Phase::Fan { first, end }) => (first, end),
            _ => return low,
        };
        let place = |x: f64| if first { [end, x] } else { [x, end] };
        let moving = usize::from(first);
        let near = [low[moving], high[moving]];
        let value = |x: f64| {
            let [s, t] = place(x);
            self.at(s, t).0
        };
        // One level of margin on either side.
        let (a, b) = (near[0].min(near[1]) - 2.0 * RISE, near[0].max(near[1]) + 2.0 * RISE);
        let root = find_root(value, a.max(0.0), b.min(1.0));
        place(root.unwrap_or(0.5 * (near[0] + near[1])))
    }
}
