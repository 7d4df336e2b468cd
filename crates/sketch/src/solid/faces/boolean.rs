//! Union, cut and common part of two bodies of plane faces.
//!
//! Both wireframes together are divided into cells as a drawing is; a cell is in a body when a way
//! from outside crosses its faces an odd number of times. So no point is classified by rounding: a
//! candidate lies on a face or it does not.

use super::cells::Cells;
use super::regions::{self, Region, Sheet};
use super::wire::Wire;
use super::{Build, Fit, MAX_EDGES, Polygon};
use moldloft_num::Vec3;

/// What to make of two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// In one of them.
    Union,
    /// In the first and not in the second.
    Cut,
    /// In both.
    Common,
}

impl Operation {
    fn holds(self, a: bool, b: bool) -> bool {
        match self {
            Operation::Union => a || b,
            Operation::Cut => a && !b,
            Operation::Common => a && b,
        }
    }
}

/// The faces of two bodies as triangles, to tell which candidates lie on them.
#[derive(Clone, Debug, Default)]
pub struct Walls {
    /// Corners of the triangles.
    pub triangles: Vec<[Vec3; 3]>,
}

impl Walls {
    /// Whether the candidate around `p` in the plane of `normal` is part of a wall.
    fn hold(&self, p: Vec3, normal: Vec3, tolerance: f64) -> bool {
        self.triangles.iter().any(|&[a, b, c]| {
            let n = (b - a).cross(c - a);
            let Some(unit) = n.normalized() else { return false };
            if unit.cross(normal).norm() > 1e-6 || (p - a).dot(unit).abs() > tolerance {
                return false;
            }
            // On an edge between two triangles it is in both: the border counts.
            let side = |p: Vec3, q: Vec3, x: Vec3| (q - p).cross(x - p).dot(unit) / (q - p).norm();
            [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| side(s, t, p) >= -tolerance)
        })
    }
}

/// Combines two bodies. `edges` are those of both; the positions that come back begin with the given
/// ones. `None` when there would be too many pieces; a body of no faces when nothing is left.
pub fn combine(
    positions: &[Vec3],
    edges: &[[usize; 2]],
    walls: [&Walls; 2],
    operation: Operation,
) -> Option<(Vec<Vec3>, Fit)> {
    let mut wire = Wire::new(positions, edges);
    wire.prune();
    let sheets = regions::sheets(&wire);
    let regions = loop {
        let mut found: Vec<Region> = (sheets.iter().enumerate())
            .flat_map(|(k, sheet)| regions::regions(&wire, k, sheet))
            .collect();
        regions::drop_unshared(&wire, &mut found);
        let before = wire.edges.len();
        for [p, q] in regions::cuts(&wire, &sheets, &found) {
            let (a, b) = (wire.vertex(p), wire.vertex(q));
            wire.insert(a, b, true);
            if wire.edges.len() > MAX_EDGES {
                return None;
            }
        }
        if wire.edges.len() == before {
            break found;
        }
    };
    let cells = Cells::build(&wire, &sheets, &regions);
    let on: Vec<[bool; 2]> = regions
        .iter()
        .map(|r| {
            let normal = sheets[r.sheet].normal;
            let p = inner_point(&wire, &sheets[r.sheet], r);
            walls.map(|w| p.is_some_and(|p| w.hold(p, normal, 10.0 * wire.tolerance)))
        })
        .collect();
    // From outside through all candidates: a wall changes what one is in.
    let count = cells.volume.len();
    let mut inside: Vec<Option<[bool; 2]>> = vec![None; count];
    let mut waiting: Vec<Option<usize>> = vec![None];
    while let Some(from) = waiting.pop() {
        let here = from.map_or(Some([false; 2]), |c| inside[c]).unwrap_or_default();
        for (r, on) in on.iter().enumerate() {
            let sides = [cells.side[2 * r], cells.side[2 * r + 1]];
            for (one, other) in [(sides[0], sides[1]), (sides[1], sides[0])] {
                let Some(next) = other.filter(|&c| one == from && inside[c].is_none()) else {
                    continue;
                };
                inside[next] = Some([here[0] != on[0], here[1] != on[1]]);
                waiting.push(other);
            }
        }
    }
    let solid: Vec<bool> =
        inside.iter().map(|i| i.is_some_and(|[a, b]| operation.holds(a, b))).collect();
    let volume = (0..count).filter(|&c| solid[c]).map(|c| cells.volume[c]).sum();
    // Faces of one plane become one face, drawn edge between them or not.
    for (edge, wings) in wire.edges.iter_mut().zip(&cells.wings) {
        let is = |side: usize| cells.side[side].is_some_and(|c| solid[c]);
        let faces: Vec<usize> =
            wings.iter().map(|w| w.region).filter(|&r| is(2 * r) != is(2 * r + 1)).collect();
        edge.cut = match faces[..] {
            [a, b] => regions[a].sheet == regions[b].sheet,
            _ => edge.cut && faces.is_empty(),
        };
    }
    let drawn = usize::MAX;
    let build = Build { wire: &wire, sheets: &sheets, regions: &regions, cells: &cells, drawn };
    let mut fit = build.solid(&solid, volume);
    drop_straight(&wire, &mut fit.faces);
    Some((wire.vertices.clone(), fit))
}

/// Leaves out vertices inside straight edges of all their faces.
fn drop_straight(wire: &Wire, faces: &mut [Polygon]) {
    let mut corners = std::collections::BTreeSet::new();
    for cycle in faces.iter().flat_map(|f| std::iter::once(&f.outer).chain(&f.holes)) {
        let n = cycle.len();
        for k in 0..n {
            let at = |k: usize| wire.vertices[cycle[k % n]];
            let (a, b) = (at(k + n) - at(k + n - 1), at(k + 1) - at(k));
            let bent = a.cross(b).norm() > wire.tolerance * a.norm().max(b.norm());
            if bent || a.dot(b) < 0.0 {
                corners.insert(cycle[k]);
            }
        }
    }
    for cycle in faces.iter_mut().flat_map(|f| std::iter::once(&mut f.outer).chain(&mut f.holes)) {
        cycle.retain(|v| corners.contains(v));
    }
}

/// A point inside a region: the centre of its largest triangle.
fn inner_point(wire: &Wire, sheet: &Sheet, region: &Region) -> Option<Vec3> {
    let mut points = Vec::new();
    let mut loops = Vec::new();
    for cycle in &region.loops {
        let start = points.len();
        points.extend(cycle.iter().map(|&h| wire.vertices[wire.tail(h)]));
        loops.push((start..points.len()).collect::<Vec<usize>>());
    }
    let triangles = crate::triangulate(&points, &loops, sheet.normal);
    let corners = triangles.into_iter().map(|t| t.map(|k| points[k]));
    let size = |t: &[Vec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).norm_sq();
    let [a, b, c] = corners.max_by(|s, t| size(s).total_cmp(&size(t)))?;
    Some((a + b + c) / 3.0)
}
