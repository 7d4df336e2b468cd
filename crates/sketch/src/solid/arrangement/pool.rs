//! Points of an arrangement, without duplicates.

use moldloft_num::Vec3;
use std::collections::HashMap;

/// The size of a cell of points, in tolerances: few points are near the border of theirs.
const CELL: f64 = 64.0;

/// Points that are equal within a tolerance share a number.
pub(super) struct Pool {
    pub points: Vec<Vec3>,
    pub tolerance: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Pool {
    pub fn new(tolerance: f64) -> Pool {
        Pool { points: Vec::new(), tolerance, cells: HashMap::new() }
    }

    fn cell(&self, p: Vec3) -> [i64; 3] {
        let size = CELL * self.tolerance;
        p.to_array().map(|x| (x / size).floor().clamp(-9e15, 9e15) as i64)
    }

    /// Number of the point at `p`, a new one if necessary.
    pub fn add(&mut self, p: Vec3) -> u32 {
        let reach = Vec3::new(self.tolerance, self.tolerance, self.tolerance);
        let (low, high) = (self.cell(p - reach), self.cell(p + reach));
        let mut best: Option<(f64, u32)> = None;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    for &v in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        let distance = self.points[v as usize].distance(p);
                        if distance <= self.tolerance && best.is_none_or(|b| distance < b.0) {
                            best = Some((distance, v));
                        }
                    }
                }
            }
        }
        if let Some((_, v)) = best {
            return v;
        }
        let v = self.points.len() as u32;
        self.points.push(p);
        let own = self.cell(p);
        self.cells.entry(own).or_default().push(v);
        v
    }

    pub fn at(&self, v: u32) -> Vec3 {
        self.points[v as usize]
    }
}

/// The most cells along an axis.
const MOST_ALONG: usize = 32;

/// Points by the cells of a grid over all of them.
pub(super) struct PointCells {
    low: Vec3,
    /// Cells for a unit of length, by axis.
    rate: [f64; 3],
    along: usize,
    /// The first of each cell's points.
    first: Vec<u32>,
    points: Vec<u32>,
}

impl PointCells {
    pub fn new(points: &[Vec3]) -> PointCells {
        let [low, high] = bounds(points.iter().copied());
        let enough = |n: &usize| n.pow(3) >= points.len();
        let along = (1..MOST_ALONG).find(enough).unwrap_or(MOST_ALONG);
        let rate = [0, 1, 2].map(|k| {
            let wide = high[k] - low[k];
            if wide > 0.0 { along as f64 / wide } else { 0.0 }
        });
        let mut out = PointCells { low, rate, along, first: Vec::new(), points: Vec::new() };
        let cells: Vec<usize> = points.iter().map(|p| out.number(out.cell(*p))).collect();
        let mut first = vec![0; along.pow(3) + 1];
        cells.iter().for_each(|c| first[c + 1] += 1);
        (0..along.pow(3)).for_each(|c| first[c + 1] += first[c]);
        let mut next = first.clone();
        out.points = vec![0; points.len()];
        for (v, c) in cells.into_iter().enumerate() {
            out.points[next[c] as usize] = v as u32;
            next[c] += 1;
        }
        out.first = first;
        out
    }

    fn cell(&self, p: Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| (((p[k] - self.low[k]) * self.rate[k]) as usize).min(self.along - 1))
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.along + y) * self.along + x
    }

    /// The points of all cells that a box overlaps.
    pub fn each(&self, [low, high]: [Vec3; 2], mut found: impl FnMut(u32)) {
        let (low, high) = (self.cell(low), self.cell(high));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let [from, to] = [low[0], high[0]].map(|x| self.number([x, y, z]));
                let row = self.first[from] as usize..self.first[to + 1] as usize;
                self.points[row].iter().for_each(|v| found(*v));
            }
        }
    }
}

/// A box that overlaps more cells than this is kept apart from them.
const MOST_CELLS: usize = 8;

/// Pairs of boxes that overlap, each pair once, by a sweep along one axis with cells along another. With `first`
/// boxes of one kind before those of another, only pairs of both kinds. The order is that of the sweep.
pub(in crate::solid) fn overlapping(
    boxes: &[[Vec3; 2]],
    margin: f64,
    first: usize,
    mut pair: impl FnMut(usize, usize),
) {
    let mixed = first < boxes.len();
    let spreads = [0, 1, 2].map(|k| spread(boxes, k));
    let widest = |axes: &[usize]| {
        let best = axes.iter().max_by(|&&a, &&b| spreads[a].total_cmp(&spreads[b]));
        best.copied().unwrap_or(0)
    };
    let axis = widest(&[0, 1, 2]);
    let across = widest(&[(axis + 1) % 3, (axis + 2) % 3]);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a][0][axis].total_cmp(&boxes[b][0][axis]).then(a.cmp(&b)));
    let (low, high) = boxes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), b| {
        (l.min(b[0][across]), h.max(b[1][across]))
    });
    let wide = high - low;
    let count = if wide > 0.0 && wide.is_finite() { boxes.len().isqrt().clamp(1, 256) } else { 1 };
    let cell = |x: f64| (((x - low) / wide * count as f64) as usize).min(count - 1);
    // By cell and kind, the boxes at the present position of the sweep, by their index in the
    // order; the last row has the wide ones.
    let mut active: Vec<[Vec<usize>; 2]> = vec![[Vec::new(), Vec::new()]; count + 1];
    let mut hits: Vec<usize> = Vec::new();
    for (place, &k) in order.iter().enumerate() {
        let [own_low, own_high] = boxes[k];
        let kind = usize::from(mixed && k >= first);
        let passed = own_low[axis] - margin;
        // Wide enough for rounding: the exact test follows.
        let (from, to) =
            (cell(own_low[across] - 2.0 * margin), cell(own_high[across] + 2.0 * margin));
        hits.clear();
        for row in (from..=to).chain([count]) {
            active[row][if mixed { 1 - kind } else { 0 }].retain(|&other| {
                let [low, high] = boxes[order[other]];
                if high[axis] < passed {
                    return false;
                }
                let apart =
                    (0..3).any(|a| own_low[a] > high[a] + margin || low[a] > own_high[a] + margin);
                // In the first cell that both are in.
                if !apart && (row == count || row == from.max(cell(low[across]))) {
                    hits.push(other);
                }
                true
            });
        }
        hits.sort_unstable();
        for &other in &hits {
            pair(order[other].min(k), order[other].max(k));
        }
        let (from, to) = (cell(own_low[across]), cell(own_high[across]));
        let rows = if to.saturating_sub(from) < MOST_CELLS { from..=to } else { count..=count };
        for row in rows {
            active[row][kind].push(place);
        }
    }
}

/// Mean gap between neighbouring middles: an axis along which boxes are strewn separates them best.
fn spread(boxes: &[[Vec3; 2]], axis: usize) -> f64 {
    let middle = |b: &[Vec3; 2]| 0.5 * (b[0][axis] + b[1][axis]);
    let n = boxes.len().max(1) as f64;
    let mean = boxes.iter().map(middle).sum::<f64>() / n;
    boxes.iter().map(|b| (middle(b) - mean).powi(2)).sum::<f64>()
}

/// The box around points.
pub(super) fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    let mut low: Vec3 = Vec3::of(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for p in points {
        low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    [low, high]
}
