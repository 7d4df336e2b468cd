//! Corners of convex and concave edges: order in which the chosen edges are blended.
//!
//! One of three such edges is the only one of its kind. If it is blended first, the other two are
//! joined by an edge of the blend, an arc that continues them. Then these are filleted with it, as
//! edges of one kind. All edges of one kind that meet in corners are filleted together. Chamfers of
//! such corners are refused.

use super::SketchSolid;
use super::edges::{EdgeFrame, EdgeSide, TreatmentFault};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeMap, BTreeSet};

#[derive(Clone, Copy, Debug)]
pub(crate) enum BlendSize<T> {
    /// The distances from the edge in its first face and its second.
    Chamfer([T; 2]),
    Fillet(T),
}

/// Chosen edges, each with the face that a first distance is measured in.
pub(super) type ChosenEdges = BTreeMap<usize, Option<usize>>;

const IN_TURN: &str =
    "CHAMFER the edge that is alone of its kind there, then the others by another command";
const WHOLE: &str =
    "FILLET all three edges of the corner, or choose only edges that do not meet there";

/// Edges of a body that are blended together, after others.
pub(super) struct BlendStep<T> {
    edges: Vec<EdgeFrame<T>>,
    /// Polylines of the edges.
    ways: Vec<Vec<Vec3>>,
}

/// The edges to begin with, and those to be found in the body that results, in their order.
///
/// # Errors
/// A corner of both kinds that is not one of three straight chosen edges, or that requires another
/// order than others.
pub(super) fn ordered<T: Real>(
    body: &SketchSolid<T>,
    sides: &[Vec<EdgeSide>],
    chosen: &ChosenEdges,
    size: BlendSize<T>,
) -> Result<(ChosenEdges, Vec<BlendStep<T>>), TreatmentFault> {
    let numbers: Vec<usize> = chosen.keys().copied().collect();
    let mut frames = Vec::new();
    for (&e, &first) in chosen {
        frames.push(body.edge_frame(e, &sides[e], first)?);
    }
    let mut at: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (k, frame) in frames.iter().enumerate() {
        for v in frame.ends {
            at.entry(v).or_default().insert(k);
        }
    }
    let mut degree = vec![0usize; body.vertices.len()];
    body.edges.iter().flat_map(|e| e.ends).for_each(|v| degree[v] += 1);
    let mut groups = UnionFind::new(frames.len());
    // The edge that is alone of its kind, and the other two.
    let mut mixed: Vec<(usize, [usize; 2], Vec3)> = Vec::new();
    for (&v, own) in &at {
        let own: Vec<usize> = own.iter().copied().collect();
        let of = |convex: bool| -> Vec<usize> {
            own.iter().copied().filter(|&k| frames[k].convex == convex).collect()
        };
        let [out, inward] = [of(true), of(false)];
        for same in [&out, &inward] {
            same.windows(2).for_each(|w| {
                groups.join(w[0], w[1]);
            });
        }
        if out.is_empty() || inward.is_empty() {
            continue;
        }
        let place = body.vertices[v].at.re();
        let (alone, others) = match (&out[..], &inward[..]) {
            (&[m], &[a, b]) | (&[a, b], &[m]) => (m, [a, b]),
            _ => return Err(refused(place)),
        };
        let straight = own.iter().all(|&k| frames[k].axis.is_none());
        // The end of a rolling-ball blend is unique; for chamfers it depends on the order of the
        // edges.
        let bevel = matches!(size, BlendSize::Chamfer(_));
        if bevel {
            let text = "edges that stand out and edges that stand in meet, where the order of chamfers decides their shape";
            return Err(TreatmentFault::new(text, Some(place), IN_TURN));
        }
        if degree[v] != 3 || !straight {
            return Err(refused(place));
        }
        mixed.push((alone, others, place));
    }
    // Steps by group: after all that must come before.
    let roots: Vec<usize> = (0..frames.len()).map(|k| groups.find(k)).collect();
    let mut step = vec![0usize; frames.len()];
    for round in 0..=frames.len() {
        let mut late = None;
        for &(alone, others, place) in &mixed {
            let (before, after) = (roots[alone], roots[others[0]]);
            if step[after] <= step[before] {
                step[after] = step[before] + 1;
                late = Some(place);
            }
        }
        match late {
            None => break,
            Some(place) if round == frames.len() => {
                return Err(refused(place));
            }
            Some(_) => {}
        }
    }
    let step: Vec<usize> = roots.iter().map(|r| step[*r]).collect();
    let count = step.iter().max().map_or(0, |m| m + 1);
    let begin = (numbers.iter().zip(&step)).filter(|(_, s)| **s == 0).map(|(e, _)| (*e, chosen[e]));
    let begin: ChosenEdges = begin.collect();
    let mut later = Vec::new();
    for s in 1..count {
        let own: Vec<usize> = (0..frames.len()).filter(|k| step[*k] == s).collect();
        later.push(BlendStep {
            ways: own.iter().map(|&k| way(body, numbers[k])).collect(),
            edges: own.iter().map(|&k| frames[k].clone()).collect(),
        });
    }
    Ok((begin, later))
}

fn refused(place: Vec3) -> TreatmentFault {
    let text = "edges that stand out and edges that stand in meet";
    TreatmentFault::new(text, Some(place), WHOLE)
}

/// Points along an edge, enough to tell it from others.
fn way<T: Real>(body: &SketchSolid<T>, edge: usize) -> Vec<Vec3> {
    body.polyline(edge, 24).iter().map(|p| p.re()).collect()
}

impl<T: Real> BlendStep<T> {
    /// The edges of a later body that are parts of these.
    ///
    /// # Errors
    /// An edge that does not exist in the body.
    pub(super) fn found_in(&self, body: &SketchSolid<T>) -> Result<ChosenEdges, TreatmentFault> {
        let sides = body.edge_sides();
        let first = body.vertices.first().map_or(Vec3::zero(), |v| v.at.re());
        let size = body.vertices.iter().map(|v| v.at.re().distance(first)).fold(0.0, f64::max);
        let ways: Vec<Vec<Vec3>> = (0..body.edges.len()).map(|e| way(body, e)).collect();
        let mut found = ChosenEdges::new();
        for (frame, old) in self.edges.iter().zip(&self.ways) {
            let mut own = false;
            for (e, way) in ways.iter().enumerate() {
                if way.iter().all(|p| on_edge(frame, old, *p, size)) && !body.is_smooth(&sides[e]) {
                    found.insert(e, None);
                    own = true;
                }
            }
            if !own {
                return Err(TreatmentFault::new(
                    "an edge vanishes when the other edges of its corner are blended",
                    Some(old[old.len() / 2]),
                    "make it smaller, or choose other edges",
                ));
            }
        }
        Ok(found)
    }
}

/// True if a point is on an edge.
fn on_edge<T: Real>(frame: &EdgeFrame<T>, way: &[Vec3], p: Vec3, size: f64) -> bool {
    let near = 1e-9 * size;
    let [start, finish] = [frame.start, frame.finish].map(Vec3::re);
    match &frame.axis {
        None => {
            let d = finish - start;
            let s = d.dot(p - start) / d.norm_sq();
            (start + d * s.clamp(0.0, 1.0)).distance(p) <= near
        }
        Some(axis) => {
            let arm = |x: Vec3| {
                let off = x - axis.point.re();
                let level = off.dot(axis.direction.re());
                (level, (off - axis.direction.re() * level).norm())
            };
            let ((h, r), (level, radius)) = (arm(p), arm(start));
            let longest = way.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f64::max);
            (h - level).abs() <= near
                && (r - radius).abs() <= near
                && way.windows(2).any(|w| {
                    let d = w[1] - w[0];
                    let s = (d.dot(p - w[0]) / d.norm_sq()).clamp(0.0, 1.0);
                    (w[0] + d * s).distance(p) <= 0.2 * longest
                })
        }
    }
}
