//! Points of an arrangement: each place once.

use moldloft_num::Vec3;
use std::collections::HashMap;

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
        let size = 4.0 * self.tolerance;
        p.to_array().map(|x| (x / size).floor().clamp(-9e15, 9e15) as i64)
    }

    /// The number of the point at `p`, a new one if there is none.
    pub fn add(&mut self, p: Vec3) -> u32 {
        let own = self.cell(p);
        let mut best: Option<(f64, u32)> = None;
        for k in 0..27i64 {
            let near = [own[0] + k % 3 - 1, own[1] + k / 3 % 3 - 1, own[2] + k / 9 - 1];
            for &v in self.cells.get(&near).into_iter().flatten() {
                let distance = self.points[v as usize].distance(p);
                if distance <= self.tolerance && best.is_none_or(|b| distance < b.0) {
                    best = Some((distance, v));
                }
            }
        }
        if let Some((_, v)) = best {
            return v;
        }
        let v = self.points.len() as u32;
        self.points.push(p);
        self.cells.entry(own).or_default().push(v);
        v
    }

    pub fn at(&self, v: u32) -> Vec3 {
        self.points[v as usize]
    }
}

/// Pairs of boxes that overlap, each pair once, by a sweep along one axis. With `first` boxes of one
/// kind before those of another, only pairs of both kinds.
pub(in crate::solid) fn overlapping(
    boxes: &[[Vec3; 2]],
    margin: f64,
    first: usize,
    mut pair: impl FnMut(usize, usize),
) {
    let mixed = first < boxes.len();
    let axis = (0..3).max_by(|&a, &b| spread(boxes, a).total_cmp(&spread(boxes, b))).unwrap_or(0);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a][0][axis].total_cmp(&boxes[b][0][axis]).then(a.cmp(&b)));
    let mut active: Vec<usize> = Vec::new();
    for &k in &order {
        let low = boxes[k][0][axis] - margin;
        active.retain(|&other| boxes[other][1][axis] >= low);
        for &other in &active {
            if mixed && (other < first) == (k < first) {
                continue;
            }
            let apart = (0..3).any(|a| {
                boxes[k][0][a] > boxes[other][1][a] + margin
                    || boxes[other][0][a] > boxes[k][1][a] + margin
            });
            if !apart {
                pair(other.min(k), other.max(k));
            }
        }
        active.push(k);
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
