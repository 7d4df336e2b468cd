//! The pieces of moved sides that bound a margin, linked to loops.

use super::edges::TreatmentFault;
use super::outline_sides::BorderSide;
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

/// Distance within which points are one, relative to the size of the outline and the distance.
const SAME: f64 = 1e-9;

/// Depth in the margin within which a point is on its border, relative as [`SAME`].
const DEPTH: f64 = 1e-12;

/// Fractions of a piece at which it is compared with the margin.
const SAMPLES: [f64; 3] = [0.5, 0.23, 0.79];

/// A margin beside the border of a region.
#[derive(Clone)]
pub(super) struct Margin {
    /// Its width: outside if positive, inside if negative.
    pub by: f64,
    /// True if it contains the mitres of its corners.
    pub mitred: bool,
    pub loops: Vec<Vec<BorderSide<f64>>>,
    pub plane: Vec3,
}

/// A part of a moved side.
#[derive(Clone, Copy, Debug)]
pub(super) struct BorderPiece {
    pub side: usize,
    pub from: Vec3,
    middle: Vec3,
    /// Directions at its ends.
    ahead: [Vec3; 2],
    nodes: [usize; 2],
}

impl Margin {
    /// Depth of a point in the margin, or on the wrong side of it; negative outside of it.
    fn depth(&self, p: Vec3, mitres: &[[Vec3; 4]]) -> f64 {
        let width = self.by.abs();
        let sides = self.loops.iter().flatten();
        let away = sides.map(|s| s.distance(p, self.plane)).fold(f64::INFINITY, f64::min);
        let turns = self.loops.iter().map(|l| BorderSide::winding(l, p, self.plane));
        let inside = turns.sum::<i64>() > 0;
        if inside == (self.by > 0.0) {
            return width.max(away);
        }
        let in_mitre = |corners: &[Vec3; 4]| {
            let turn = self.plane.dot((corners[2] - corners[0]).cross(corners[3] - corners[0]));
            let off = |k: usize| {
                let along = corners[(k + 1) % 4] - corners[k];
                self.plane.dot(along.cross(p - corners[k])) * turn.signum() / along.norm()
            };
            (0..4).map(off).fold(f64::INFINITY, f64::min)
        };
        mitres.iter().map(in_mitre).fold(width - away, f64::max)
    }

    /// Corner, ends of the moved sides and tip of each mitre.
    fn mitres(&self) -> Vec<[Vec3; 4]> {
        if !self.mitred {
            return Vec::new();
        }
        let mut all = Vec::new();
        for sides in &self.loops {
            for k in 0..sides.len() {
                let (a, b) = (&sides[k], &sides[(k + 1) % sides.len()]);
                let (m, q) = (a.normal(1, self.plane), b.normal(0, self.plane));
                let turn = self.plane.dot(m.cross(q));
                if turn.abs() > super::outline_offset::SMOOTH && turn * self.by > 0.0 {
                    let (at, by) = (a.ends[1], self.by);
                    let tip = at + (m + q) * (by / (m.dot(q) + 1.0));
                    all.push([at, at + m * by, tip, at + q * by]);
                }
            }
        }
        all
    }
}

/// Points within a tolerance as one.
struct BorderNodes {
    at: Vec<Vec3>,
    tolerance: f64,
    // Only for look-ups.
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl BorderNodes {
    fn number(&mut self, p: Vec3) -> usize {
        let cell = p.to_array().map(|x| (x / (4.0 * self.tolerance)).floor() as i64);
        for i in -1..=1 {
            for j in -1..=1 {
                for k in -1..=1 {
                    let near = self.cells.get(&[cell[0] + i, cell[1] + j, cell[2] + k]);
                    let known = near.into_iter().flatten();
                    let found =
                        known.copied().find(|n| self.at[*n].distance(p) <= 2.0 * self.tolerance);
                    if let Some(n) = found {
                        return n;
                    }
                }
            }
        }
        self.cells.entry(cell).or_default().push(self.at.len());
        self.at.push(p);
        self.at.len() - 1
    }
}

/// The loops of pieces of moved sides that bound a margin on its other side than the border.
pub(super) fn border(
    moved: &[BorderSide<f64>],
    margin: &Margin,
    size: f64,
) -> Result<Vec<Vec<BorderPiece>>, TreatmentFault> {
    let [tolerance, depth] = [SAME, DEPTH].map(|part| part * (size + margin.by.abs()));
    let mut nodes = BorderNodes { at: Vec::new(), tolerance, cells: HashMap::new() };
    let mut pieces = divided(moved, margin.plane, tolerance, &mut nodes);
    let mitres = margin.mitres();
    pieces.retain(|piece| {
        let side = &moved[piece.0.side];
        let at = |s: f64| side.at(piece.1[0] + (piece.1[1] - piece.1[0]) * s, margin.plane);
        SAMPLES.iter().all(|s| margin.depth(at(*s), &mitres) <= depth)
    });
    let pieces = single(pieces.into_iter().map(|p| p.0).collect(), 16.0 * tolerance);
    linked(pieces, &nodes.at, margin.plane)
}

/// All sides divided at their crossings, with the fractions of the ends of the pieces.
fn divided(
    moved: &[BorderSide<f64>],
    plane: Vec3,
    tolerance: f64,
    nodes: &mut BorderNodes,
) -> Vec<(BorderPiece, [f64; 2])> {
    let mut cuts: Vec<Vec<f64>> = vec![vec![0.0, 1.0]; moved.len()];
    let boxes: Vec<[Vec3; 2]> = moved.iter().map(bounds).collect();
    for i in 0..moved.len() {
        for j in i + 1..moved.len() {
            let apart = (0..3).any(|k| {
                boxes[i][0][k] > boxes[j][1][k] + tolerance
                    || boxes[j][0][k] > boxes[i][1][k] + tolerance
            });
            if apart {
                continue;
            }
            let (a, b) = (&moved[i], &moved[j]);
            let ends = a.ends.into_iter().chain(b.ends);
            for p in crossings(a, b, plane, tolerance).into_iter().chain(ends) {
                let on = [a, b].map(|s| s.fraction(p, plane, tolerance));
                if let [Some(s), Some(t)] = on {
                    cuts[i].push(s);
                    cuts[j].push(t);
                }
            }
        }
    }
    let mut all = Vec::new();
    for (k, (side, own)) in moved.iter().zip(&mut cuts).enumerate() {
        own.sort_by(f64::total_cmp);
        let mut from = (0.0, nodes.number(side.ends[0]));
        for &s in own.iter().skip(1) {
            let p = if s == 1.0 { side.ends[1] } else { side.at(s, plane) };
            let to = (s, nodes.number(p));
            if to.1 == from.1 && (s - from.0) * side.length() <= 8.0 * tolerance {
                continue;
            }
            let piece = BorderPiece {
                side: k,
                from: nodes.at[from.1],
                middle: side.at(0.5 * (from.0 + s), plane),
                ahead: [from.0, s].map(|s| side.direction(s, plane)),
                nodes: [from.1, to.1],
            };
            all.push((piece, [from.0, s]));
            from = to;
        }
    }
    all
}

fn bounds(side: &BorderSide<f64>) -> [Vec3; 2] {
    let [p, q] = side.ends;
    match &side.arc {
        None => [
            Vec3::new(p.x.min(q.x), p.y.min(q.y), p.z.min(q.z)),
            Vec3::new(p.x.max(q.x), p.y.max(q.y), p.z.max(q.z)),
        ],
        Some(arc) => {
            let reach = Vec3::of(arc.radius, arc.radius, arc.radius);
            [arc.centre - reach, arc.centre + reach]
        }
    }
}

/// Common points of the lines and circles of two sides.
fn crossings(a: &BorderSide<f64>, b: &BorderSide<f64>, plane: Vec3, tolerance: f64) -> Vec<Vec3> {
    // Points of a circle at a distance from a foot, both ways along a direction.
    let around = |foot: Vec3, along: Vec3, square: f64, radius: f64| {
        if square < -4.0 * radius * tolerance {
            return vec![];
        }
        let half = Real::sqrt(square.max(0.0));
        vec![foot - along * half, foot + along * half]
    };
    match (&a.arc, &b.arc) {
        (None, None) => {
            let (d, e) = (a.direction(0.0, plane), b.direction(0.0, plane));
            let det = plane.dot(d.cross(e));
            if det.abs() < 1e-12 {
                return vec![];
            }
            let s = plane.dot((b.ends[0] - a.ends[0]).cross(e)) / det;
            vec![a.ends[0] + d * s]
        }
        (None, Some(arc)) | (Some(arc), None) => {
            let line = if a.arc.is_none() { a } else { b };
            let d = line.direction(0.0, plane);
            let foot = line.ends[0] + d * d.dot(arc.centre - line.ends[0]);
            let away = foot.distance(arc.centre);
            around(foot, d, (arc.radius - away) * (arc.radius + away), arc.radius)
        }
        (Some(p), Some(q)) => {
            let between = q.centre - p.centre;
            let away = between.norm();
            if away <= tolerance {
                return vec![];
            }
            let d = between / away;
            let s = 0.5 * (away + (p.radius - q.radius) * (p.radius + q.radius) / away);
            let square = (p.radius - s) * (p.radius + s);
            around(p.centre + d * s, plane.cross(d), square, p.radius)
        }
    }
}

/// Pieces that coincide: of one direction one, of opposite directions none.
fn single(pieces: Vec<BorderPiece>, tolerance: f64) -> Vec<BorderPiece> {
    let mut out: Vec<BorderPiece> = Vec::new();
    let mut at: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
    let mut gone = Vec::new();
    for piece in pieces {
        let [p, q] = piece.nodes;
        let same = at.entry([p.min(q), p.max(q)]).or_default();
        let known = same.iter().copied().find(|k| {
            let other: &BorderPiece = &out[*k];
            other.middle.distance(piece.middle) <= tolerance
        });
        match known {
            Some(k) => {
                if out[k].nodes != piece.nodes
                    || (p == q && out[k].ahead[0].dot(piece.ahead[0]) < 0.0)
                {
                    gone.push(k);
                }
            }
            None => {
                same.push(out.len());
                out.push(piece);
            }
        }
    }
    let mut k = 0;
    out.retain(|_| {
        k += 1;
        !gone.contains(&(k - 1))
    });
    out
}

/// Pieces as loops; neighbours of one side are one piece.
fn linked(
    pieces: Vec<BorderPiece>,
    nodes: &[Vec3],
    plane: Vec3,
) -> Result<Vec<Vec<BorderPiece>>, TreatmentFault> {
    let mut out: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    let mut balance = vec![0i64; nodes.len()];
    for (k, piece) in pieces.iter().enumerate() {
        out[piece.nodes[0]].push(k);
        balance[piece.nodes[0]] += 1;
        balance[piece.nodes[1]] -= 1;
    }
    if let Some(n) = balance.iter().position(|b| *b != 0) {
        return Err(TreatmentFault::new(
            "moved sides touch, or nearly so",
            Some(nodes[n]),
            "change the distance a little",
        ));
    }
    let shared: Vec<bool> = out.iter().map(|o| o.len() > 1).collect();
    let mut loops = Vec::new();
    for first in 0..pieces.len() {
        if !out[pieces[first].nodes[0]].contains(&first) {
            continue;
        }
        let (mut cycle, mut k) = (Vec::new(), first);
        loop {
            out[pieces[k].nodes[0]].retain(|o| *o != k);
            cycle.push(pieces[k]);
            if pieces[k].nodes[1] == pieces[first].nodes[0] {
                break;
            }
            let ahead = pieces[k].ahead[1];
            // The region is to the left: the leftmost piece bounds it.
            let turn = |o: &usize| {
                let next = pieces[*o].ahead[0];
                Real::atan2(plane.dot(ahead.cross(next)), ahead.dot(next))
            };
            let ways = out[pieces[k].nodes[1]].iter().copied();
            let Some(next) = ways.max_by(|a, b| turn(a).total_cmp(&turn(b))) else { break };
            k = next;
        }
        loops.push(joined(cycle, &shared));
    }
    Ok(loops)
}

/// Neighbours of one side as one piece.
fn joined(mut cycle: Vec<BorderPiece>, shared: &[bool]) -> Vec<BorderPiece> {
    let continues = |a: &BorderPiece, b: &BorderPiece| {
        a.side == b.side && a.nodes[1] == b.nodes[0] && !shared[b.nodes[0]]
    };
    let n = cycle.len();
    if let Some(start) = (0..n).find(|&k| !continues(&cycle[(k + n - 1) % n], &cycle[k])) {
        cycle.rotate_left(start);
    }
    let mut out: Vec<BorderPiece> = Vec::new();
    for piece in cycle {
        match out.last_mut() {
            Some(last) if continues(last, &piece) => {
                last.nodes[1] = piece.nodes[1];
                last.ahead[1] = piece.ahead[1];
            }
            _ => out.push(piece),
        }
    }
    out
}
