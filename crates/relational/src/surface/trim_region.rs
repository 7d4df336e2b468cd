//! A region of the parameter plane within polygons, and triangles in it.

use crate::surface::trim::{MEETING, TrimSurf};
use crate::surface::trim_density::{Stretch, stretched};
use crate::surface::trim_kinks::KinkPlane;
use moldloft_mesh::{planar_triangles, planar_triangles_along};
use moldloft_num::period::breaks_between;
use moldloft_num::{Fineness, Order, Real};
use moldloft_registry::{CallError, SurfaceRef};
use std::collections::HashMap;

/// A point of the parameter plane.
pub(crate) type Place<T> = [T; 2];

/// Minimum distance of inner points from the rim, relative to the smallest step of the net.
const NET_MARGIN: f64 = 0.35;

/// Points inside keep this distance from the rim where the plane is stretched by curvature.
const MARGIN: f64 = 0.55;

/// A loop folds back by at most this much, in parameters: its snakes meet within [`MEETING`], and curves that were fitted
/// pass their ends by as much.
const FOLD: f64 = 8.0 * MEETING;

/// The most folds of a loop that are unfolded.
const MAX_FOLDS: usize = 32;

/// Fraction of the sides at an unfolded corner that its vertices occupy.
const UNFOLDED: f64 = 1e-3;

/// The parameter plane for triangulation, and the lines of points of the interior.
pub(crate) struct TrimPlane {
    stretch: Stretching,
    lines: [Vec<f64>; 2],
    kinks: [Vec<f64>; 2],
    margin: f64,
}

enum Stretching {
    Scaled([f64; 2]),
    ByCurvature(Stretch),
}

impl TrimPlane {
    /// Parameters scaled to lengths, with the points of the surface's net.
    pub fn of_net<T: Real>(
        surface: &SurfaceRef<T>,
        cycles: &[Vec<Place<T>>],
        net: [usize; 2],
    ) -> Self {
        let scale = scale(surface);
        let line = |n: usize| (0..=n).map(|i| i as f64 / n as f64).collect();
        let margin = NET_MARGIN * (scale[0] / net[0] as f64).min(scale[1] / net[1] as f64);
        let kinks = kinks(surface, cycles);
        Self { stretch: Stretching::Scaled(scale), lines: net.map(line), kinks, margin }
    }

    /// Parameters stretched by curvature, with at most `most` points in the box of the loops.
    pub fn by_curvature<T: Real>(
        surface: &SurfaceRef<T>,
        cycles: &[Vec<Place<T>>],
        fineness: &Fineness,
        most: usize,
    ) -> Self {
        let stretch = Self::stretch(surface, cycles, fineness);
        let lines = stretch.lines(most);
        let kinks = kinks(surface, cycles);
        Self { stretch: Stretching::ByCurvature(stretch), lines, kinks, margin: MARGIN }
    }

    /// The number of points that this fineness takes in the box of the loops.
    pub fn points<T: Real>(
        surface: &SurfaceRef<T>,
        cycles: &[Vec<Place<T>>],
        fineness: &Fineness,
    ) -> f64 {
        Self::stretch(surface, cycles, fineness).points()
    }

    fn stretch<T: Real>(
        surface: &SurfaceRef<T>,
        cycles: &[Vec<Place<T>>],
        fineness: &Fineness,
    ) -> Stretch {
        let polygons: Vec<Vec<[f64; 2]>> =
            cycles.iter().map(|c| c.iter().map(|p| p.map(T::re)).collect()).collect();
        stretched(fineness, surface, extent(cycles), |us, v| rows(&polygons, us, v))
    }

    fn forward(&self, p: [f64; 2]) -> [f64; 2] {
        match &self.stretch {
            Stretching::Scaled(s) => [p[0] * s[0], p[1] * s[1]],
            Stretching::ByCurvature(stretch) => stretch.forward(p),
        }
    }

    fn back(&self, k: usize, x: f64) -> f64 {
        match &self.stretch {
            Stretching::Scaled(s) => x / s[k],
            Stretching::ByCurvature(stretch) => stretch.back(k, x),
        }
    }
}

/// The corners of the box of loops.
fn extent<T: Real>(cycles: &[Vec<Place<T>>]) -> [[f64; 2]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in cycles.iter().flatten() {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(p[k].re()), high[k].max(p[k].re()));
        }
    }
    [low, high]
}

/// Parameters u and v within loops at which the surface may have a kink.
fn kinks<T: Real>(surface: &SurfaceRef<T>, cycles: &[Vec<Place<T>>]) -> [Vec<f64>; 2] {
    let ([low, high], closed) = (extent(cycles), surface.closed());
    let mut kinks = surface.kinks();
    for k in 0..2 {
        kinks[k] = breaks_between(&kinks[k], closed[k], low[k], high[k]);
    }
    kinks
}

/// True for a point inside polygons.
pub(crate) fn within(polygons: &[Vec<[f64; 2]>], [x, y]: [f64; 2]) -> bool {
    rows(polygons, &[x], y)[0]
}

/// Flags of ascending points of a line v = const that are inside polygons, by the rule of odd
/// crossings.
fn rows(polygons: &[Vec<[f64; 2]>], us: &[f64], v: f64) -> Vec<bool> {
    let mut at = Vec::new();
    for polygon in polygons {
        for k in 0..polygon.len() {
            let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            if (a[1] > v) != (b[1] > v) {
                at.push(a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
        }
    }
    at.sort_by(f64::total_cmp);
    us.iter().map(|u| at.partition_point(|x| x < u) % 2 == 1).collect()
}

/// The mean lengths of S_u and S_v.
fn scale<T: Real>(surface: &SurfaceRef<T>) -> [f64; 2] {
    let at = [0.1, 0.3, 0.5, 0.7, 0.9];
    let mut sums = [0.0f64; 2];
    for (u, v) in at.into_iter().flat_map(|u| at.map(|v| (u, v))) {
        let jet = surface.jet(T::from(u), T::from(v), Order::First);
        sums[0] += jet.u.re().norm();
        sums[1] += jet.v.re().norm();
    }
    // A surface without extent in one direction is not stretched.
    sums.map(|s| if s > 0.0 && s.is_finite() { s / 25.0 } else { 1.0 })
}

/// Twice the area of a triangle.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The distance of a point from a segment.
fn distance(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let size = dx * dx + dy * dy;
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = if size > 0.0 { (along / size).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
    (x * x + y * y).sqrt()
}

/// A side of a polygon: its loop, the number of its first vertex, and its ends.
#[derive(Clone, Copy)]
struct LoopSide {
    polygon: usize,
    at: usize,
    ends: [[f64; 2]; 2],
}

/// Moves the vertices between two sides of a loop that cross to the crossing, in their order along the loop, where the
/// loop folds back by no more than [`FOLD`]; false where it does not.
fn unfold<T: Real>(
    polygons: &mut [Vec<[f64; 2]>],
    cycles: &[Vec<Place<T>>],
    [a, b]: [LoopSide; 2],
) -> bool {
    if a.polygon != b.polygon {
        return false;
    }
    let (polygon, places) = (&mut polygons[a.polygon], &cycles[a.polygon]);
    let count = polygon.len();
    // The vertices from the end of one side to the start of the other, in either direction.
    let between = |from: LoopSide, to: LoopSide| (from.at, (to.at + count - from.at) % count);
    let extent = |(from, steps): (usize, usize)| {
        let first = places[(from + 1) % count].map(T::re);
        let away = (1..=steps).map(|k| {
            let p = places[(from + k) % count].map(T::re);
            (p[0] - first[0]).abs().max((p[1] - first[1]).abs())
        });
        away.fold(0.0, f64::max)
    };
    let ways = [between(a, b), between(b, a)];
    let (from, steps) = if extent(ways[0]) <= extent(ways[1]) { ways[0] } else { ways[1] };
    if extent((from, steps)) > FOLD {
        return false;
    }
    let ([p, q], [r, s]) = (a.ends, b.ends);
    let (over, under) = (cross(r, s, p), cross(r, s, q));
    let share = over / (over - under);
    let middle = [0, 1].map(|k| p[k] + share * (q[k] - p[k]));
    let (before, after) = (polygon[from], polygon[(from + steps + 1) % count]);
    for k in 1..=steps {
        let off = (2.0 * k as f64 - 1.0 - steps as f64) / steps as f64;
        let toward = if off < 0.0 { before } else { after };
        let by = UNFOLDED * off.abs();
        polygon[(from + k) % count] = [0, 1].map(|i| middle[i] + by * (toward[i] - middle[i]));
    }
    true
}

/// Sides by the cells of a square grid that they pass.
struct SideGrid {
    sides: Vec<LoopSide>,
    cell: f64,
    cells: HashMap<(i64, i64), Vec<u32>>,
}

impl SideGrid {
    fn new(polygons: &[Vec<[f64; 2]>], margin: f64) -> Self {
        let sides: Vec<LoopSide> = polygons
            .iter()
            .enumerate()
            .flat_map(|(polygon, p)| {
                let ends = move |k: usize| [p[k], p[(k + 1) % p.len()]];
                (0..p.len()).map(move |at| LoopSide { polygon, at, ends: ends(at) })
            })
            .collect();
        let length: f64 = sides
            .iter()
            .map(|LoopSide { ends: [a, b], .. }| {
                ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)).sqrt()
            })
            .sum();
        let cell = (length / sides.len() as f64).max(margin).max(f64::MIN_POSITIVE);
        let mut cells: HashMap<(i64, i64), Vec<u32>> = HashMap::new();
        for (k, &LoopSide { ends: [a, b], .. }) in sides.iter().enumerate() {
            // In steps of a cell along the side, with a cell on each side.
            let steps =
                ((b[0] - a[0]).abs().max((b[1] - a[1]).abs()) / cell).ceil().max(1.0) as usize;
            for i in 0..steps {
                let end = |s: f64| [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s];
                let (p, q) = (end(i as f64 / steps as f64), end((i + 1) as f64 / steps as f64));
                let index = |x: f64| (x / cell).floor() as i64;
                for x in index(p[0].min(q[0]))..=index(p[0].max(q[0])) {
                    for y in index(p[1].min(q[1]))..=index(p[1].max(q[1])) {
                        let slot = cells.entry((x, y)).or_default();
                        if slot.last() != Some(&(k as u32)) {
                            slot.push(k as u32);
                        }
                    }
                }
            }
        }
        Self { sides, cell, cells }
    }

    /// The first two sides that cross.
    fn crossing(&self) -> Option<[LoopSide; 2]> {
        let mut found: Option<(u32, u32)> = None;
        for slot in self.cells.values() {
            // A cell may hold many short sides: those that overlap along one axis are compared.
            let extent = |k: u32, axis: usize| {
                let [a, b] = self.sides[k as usize].ends.map(|p| p[axis]);
                [a.min(b), a.max(b)]
            };
            let spread = |axis: usize| {
                let all = slot.iter().map(|&k| extent(k, axis));
                let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], [a, b]| {
                    [l.min(a), h.max(b)]
                });
                high - low
            };
            let axis = usize::from(spread(1) > spread(0));
            let mut sorted: Vec<([f64; 2], u32)> =
                slot.iter().map(|&k| (extent(k, axis), k)).collect();
            sorted.sort_by(|x, y| x.0[0].total_cmp(&y.0[0]));
            for (i, &([_, high], k)) in sorted.iter().enumerate() {
                let near = sorted[i + 1..].iter().take_while(|([low, _], _)| *low <= high);
                for &(_, l) in near {
                    let pair = (k.min(l), k.max(l));
                    if found.is_none_or(|f| pair < f) && self.crosses(k, l) {
                        found = Some(pair);
                    }
                }
            }
        }
        found.map(|(k, l)| [k, l].map(|k| self.sides[k as usize]))
    }

    fn crosses(&self, k: u32, l: u32) -> bool {
        let ([a, b], [p, q]) = (self.sides[k as usize].ends, self.sides[l as usize].ends);
        cross(a, b, p) * cross(a, b, q) < 0.0 && cross(p, q, a) * cross(p, q, b) < 0.0
    }

    /// True if all sides are at least `margin`, at most a cell, away.
    fn far(&self, p: [f64; 2], margin: f64) -> bool {
        let [x, y] = p.map(|x| (x / self.cell).floor() as i64);
        let near = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
        near.filter_map(|key| self.cells.get(&key)).flatten().all(|&k| {
            let [a, b] = self.sides[k as usize].ends;
            distance(a, b, p) >= margin
        })
    }
}

/// A region of the parameter plane within polygons.
pub(crate) struct TrimRegion {
    plane: TrimPlane,
    /// The outer polygon counter-clockwise, the holes clockwise, in the stretched plane.
    polygons: Vec<Vec<[f64; 2]>>,
    grid: SideGrid,
}

impl TrimRegion {
    /// The region within loops, the outer one counter-clockwise and the holes clockwise.
    pub fn new<T: Real>(cycles: &[Vec<Place<T>>], plane: TrimPlane) -> Result<Self, CallError> {
        let mut polygons: Vec<Vec<[f64; 2]>> = cycles
            .iter()
            .map(|c| c.iter().map(|p| plane.forward(p.map(T::re))).collect())
            .collect();
        let mut grid = SideGrid::new(&polygons, plane.margin);
        for _ in 0..MAX_FOLDS {
            let Some(sides) = grid.crossing() else { break };
            if !unfold(&mut polygons, cycles, sides) {
                break;
            }
            grid = SideGrid::new(&polygons, plane.margin);
        }
        let region = Self { plane, polygons, grid };
        for (k, polygon) in region.polygons.iter().enumerate().skip(1) {
            if !within(&region.polygons[..1], polygon[0]) {
                let [u, v] = cycles[k][0].map(T::re);
                let what = format!("loop {} is not inside the outer one", k + 1);
                return Err(region.crossed(what, format!("(u, v) = ({u}, {v})")));
            }
        }
        if let Some([a, b]) = region.grid.crossing() {
            let (c, d) = (a.polygon, b.polygon);
            let [u, v] = cycles[c][a.at].map(T::re);
            let what = if c == d { "itself".into() } else { format!("loop {}", d + 1) };
            let what = format!("loop {} crosses {what}", c + 1);
            return Err(region.crossed(what, format!("near (u, v) = ({u}, {v})")));
        }
        Ok(region)
    }

    /// The fault of loops that cross.
    pub fn crossed(&self, message: String, found: String) -> CallError {
        CallError::new("crossed-loops", message)
            .expected("loops that neither cross themselves nor others, all inside the first")
            .found(found)
            .help("move the snakes apart; give the outer loop first, or whole = 1 for holes only")
            .in_field(TrimSurf::<f64>::LOOPS)
    }

    /// Inner points, in parameters, and triangles between them and the vertices of the loops.
    pub fn net(&self) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
        let mut points: Vec<[f64; 2]> = self.polygons.iter().flatten().copied().collect();
        let rim = points.len();
        let mut loops: Vec<Vec<usize>> = Vec::new();
        let mut first = 0;
        for polygon in &self.polygons {
            loops.push((first..first + polygon.len()).collect());
            first += polygon.len();
        }
        let kinks = KinkPlane {
            polygons: &self.polygons,
            kinks: &self.plane.kinks,
            lines: &self.plane.lines,
            margin: self.plane.margin,
            forward: &|k, x| self.plane.forward([x; 2])[k],
            back: &|k, x| self.plane.back(k, x),
        };
        let broken = kinks.lines();
        let mut places = broken.places;
        points.extend(broken.points);
        let [us, vs] = &self.plane.lines;
        let xs: Vec<f64> = us.iter().map(|&u| self.plane.forward([u, vs[0]])[0]).collect();
        let clear: Vec<bool> = xs.iter().map(|&x| !kinks.near(0, x)).collect();
        for &v in vs {
            let y = self.plane.forward([us[0], v])[1];
            if kinks.near(1, y) {
                continue;
            }
            for (i, inside) in rows(&self.polygons, &xs, y).into_iter().enumerate() {
                let p = [xs[i], y];
                if inside && clear[i] && self.grid.far(p, self.plane.margin) {
                    places.push([us[i], v]);
                    points.push(p);
                }
            }
        }
        let inner: Vec<usize> = (rim..points.len()).collect();
        let mut triangles = planar_triangles_along(&points, &loops, &broken.edges, &inner);
        if triangles.is_empty() && !broken.edges.is_empty() {
            triangles = planar_triangles(&points, &loops, &inner);
        }
        (places, triangles.into_iter().map(|t| t.map(|k| k as u32)).collect())
    }
}
