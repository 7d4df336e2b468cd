//! Faces of a body as they are painted from a side: those that look at the viewer, far ones first.

use crate::{Projection, SketchSolid};
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use std::collections::BTreeSet;

/// Bodies of more facets are painted by the mean depth of their faces: comparing all pairs takes too long.
const MOST_COMPARED: usize = 4000;

/// A face that looks at the viewer.
pub(super) struct PaintedFace {
    pub face: usize,
    /// Areas with the cosine of the angle between their normal and the line of sight.
    pub areas: Vec<(Vec<Vec<[f64; 2]>>, f64)>,
}

/// A facet on the page, with its depths.
struct PaintedFacet {
    corners: [[f64; 2]; 3],
    depths: [f64; 3],
    facing: f64,
}

/// The faces that look at the viewer; `loops` gives the borders of a plane face on the page.
pub(super) fn painted_faces(
    solid: &SketchSolid<f64>,
    mesh: &Mesh<f64>,
    view: &Projection,
    sight: Vec3,
    loops: &dyn Fn(usize) -> Vec<Vec<[f64; 2]>>,
) -> Vec<PaintedFace> {
    let facets = facets(solid, mesh, view, sight);
    let front: Vec<usize> = (0..facets.len()).filter(|&f| !facets[f].is_empty()).collect();
    let mean = |f: usize| {
        let all = facets[f].iter().flat_map(|t| t.depths);
        all.sum::<f64>() / (3 * facets[f].len()) as f64
    };
    let mut out = Vec::with_capacity(front.len());
    for f in order(&front, &facets, &mean) {
        let own = &solid.faces[f];
        let areas = if own.ruled || own.trim.is_some() {
            facets[f].iter().map(|t| (vec![t.corners.to_vec()], t.facing)).collect()
        } else {
            vec![(loops(f), facets[f][0].facing)]
        };
        out.push(PaintedFace { face: f, areas });
    }
    out
}

/// By face, the facets that look at the viewer.
fn facets(
    solid: &SketchSolid<f64>,
    mesh: &Mesh<f64>,
    view: &Projection,
    sight: Vec3,
) -> Vec<Vec<PaintedFacet>> {
    let at = |v: u32| mesh.positions()[v as usize];
    let mut out: Vec<Vec<PaintedFacet>> = (0..solid.faces.len()).map(|_| Vec::new()).collect();
    for (f, patch) in mesh.patches().iter().enumerate() {
        let Some(own) = out.get_mut(f) else { break };
        for &[a, b, c, d] in &mesh.faces()[patch.faces.clone()] {
            for t in [[a, b, c], [a, c, d]] {
                let [p, q, r] = t.map(at);
                let normal = (q - p).cross(r - p);
                let Some(normal) = normal.normalized() else { continue };
                let facing = normal.dot(sight);
                let facing = if solid.flat { facing.abs() } else { facing };
                if facing > 1e-6 {
                    let corners = [p, q, r].map(|p| view.project(p));
                    own.push(PaintedFacet {
                        corners,
                        depths: [p, q, r].map(|p| p.dot(sight)),
                        facing,
                    });
                }
            }
        }
    }
    out
}

/// Faces from far to near: one that another one covers somewhere comes before it.
fn order(front: &[usize], facets: &[Vec<PaintedFacet>], mean: &dyn Fn(usize) -> f64) -> Vec<usize> {
    let mut left: Vec<usize> = front.to_vec();
    left.sort_by(|&a, &b| mean(a).total_cmp(&mean(b)).then(a.cmp(&b)));
    let count: usize = front.iter().map(|&f| facets[f].len()).sum();
    if count > MOST_COMPARED {
        return left;
    }
    let bounds = |t: &PaintedFacet| {
        let [p, q, r] = t.corners;
        [0, 1].map(|k| [p[k].min(q[k]).min(r[k]), p[k].max(q[k]).max(r[k])])
    };
    let boxes: Vec<Vec<[[f64; 2]; 2]>> =
        facets.iter().map(|own| own.iter().map(bounds).collect()).collect();
    // By face: the faces that must be painted before it.
    let mut behind: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); facets.len()];
    for (k, &a) in front.iter().enumerate() {
        for &b in &front[..k] {
            match covers(&facets[a], &boxes[a], &facets[b], &boxes[b]) {
                Some(true) => behind[a].insert(b),
                Some(false) => behind[b].insert(a),
                None => false,
            };
        }
    }
    let mut out: Vec<usize> = Vec::with_capacity(left.len());
    let mut done = vec![false; facets.len()];
    while !left.is_empty() {
        let ready = left.iter().position(|&f| behind[f].iter().all(|&b| done[b]));
        // In a cycle of mutual covering, the farthest is first.
        let f = left.remove(ready.unwrap_or(0));
        done[f] = true;
        out.push(f);
    }
    out
}

/// True if the first face is nearer than the second where both are visible, at the position with
/// the largest difference.
fn covers(
    a: &[PaintedFacet],
    boxes_a: &[[[f64; 2]; 2]],
    b: &[PaintedFacet],
    boxes_b: &[[[f64; 2]; 2]],
) -> Option<bool> {
    let mut most = 0.0f64;
    let mut size = 0.0f64;
    for (s, own) in a.iter().zip(boxes_a) {
        for (t, other) in b.iter().zip(boxes_b) {
            let apart = |k: usize| own[k][1] <= other[k][0] || own[k][0] >= other[k][1];
            if apart(0) || apart(1) {
                continue;
            }
            let common = clipped(&s.corners, &t.corners);
            let n = common.len() as f64;
            if n < 3.0 {
                continue;
            }
            let at = common.iter().fold([0.0; 2], |m, p| [m[0] + p[0] / n, m[1] + p[1] / n]);
            let (Some(x), Some(y)) = (depth(s, at), depth(t, at)) else { continue };
            size = size.max(x.abs()).max(y.abs());
            if (x - y).abs() > most.abs() {
                most = x - y;
            }
        }
    }
    (most.abs() > 1e-9 * size.max(1e-300)).then_some(most > 0.0)
}

fn cross(o: [f64; 2], p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
}

/// The part of a triangle within another one (Sutherland and Hodgman 1974); empty for a line.
fn clipped(a: &[[f64; 2]; 3], b: &[[f64; 2]; 3]) -> Vec<[f64; 2]> {
    let turn = cross(b[0], b[1], b[2]).signum();
    let mut rest: Vec<[f64; 2]> = a.to_vec();
    for k in 0..3 {
        let (o, e) = (b[k], b[(k + 1) % 3]);
        let inside = |p: [f64; 2]| turn * cross(o, e, p);
        let mut next = Vec::with_capacity(rest.len() + 1);
        for (n, &p) in rest.iter().enumerate() {
            let q = rest[(n + 1) % rest.len()];
            let (x, y) = (inside(p), inside(q));
            if x >= 0.0 {
                next.push(p);
            }
            if (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0) {
                let t = x / (x - y);
                next.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
            }
        }
        rest = next;
        if rest.len() < 3 {
            return vec![];
        }
    }
    let area: f64 = (1..rest.len() - 1).map(|k| cross(rest[0], rest[k], rest[k + 1])).sum();
    let whole = cross(a[0], a[1], a[2]).abs().min(cross(b[0], b[1], b[2]).abs());
    if area.abs() > 1e-6 * whole { rest } else { vec![] }
}

fn depth(t: &PaintedFacet, at: [f64; 2]) -> Option<f64> {
    let [p, q, r] = t.corners;
    let area = cross(p, q, r);
    if area == 0.0 {
        return None;
    }
    let shares = [cross(q, r, at) / area, cross(r, p, at) / area, cross(p, q, at) / area];
    Some(shares.iter().zip(t.depths).map(|(s, d)| s * d).sum())
}
