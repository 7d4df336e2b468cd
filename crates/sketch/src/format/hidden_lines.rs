//! Edges of a body as they are seen from a side: cut where faces before them begin and end, with the outlines of
//! round faces.

use crate::{Projection, SketchSolid};
use moldloft_mesh::Mesh;
use moldloft_num::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Points along a curve.
const CHORDS: usize = 24;

/// Maximum distance of a mesh chord from its face, relative to the body.
const CHORD: f64 = 5e-4;

/// Minimum distance in front, relative to the body, at which a facet of a round face hides an edge
/// of another face, and of its own: chords are off the face's own border. Facets of plane faces are
/// exact.
const BEFORE: [f64; 2] = [2e-3, 2e-2];
const BEFORE_PLANE: f64 = 1e-7;

/// A part of an edge on the page, and whether a face is before it.
pub(super) struct SeenStroke {
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub hidden: bool,
}

/// A facet as it covers the page.
struct Cover {
    face: usize,
    round: bool,
    corners: [[f64; 2]; 3],
    depths: [f64; 3],
    low: [f64; 2],
    high: [f64; 2],
}

/// A piece of an edge or outline: its ends, and the faces beside it.
type Piece = ([Vec3; 2], BTreeSet<usize>);

fn size(solid: &SketchSolid<f64>) -> f64 {
    let far = solid.vertices.iter().map(|v| v.at.distance(solid.vertices[0].at));
    far.fold(0.0, f64::max)
}

/// The facets of a body, fine enough for a picture.
pub(super) fn mesh(solid: &SketchSolid<f64>) -> Mesh<f64> {
    solid.mesh(CHORD * size(solid))
}

/// The edges of a body and the outlines of its round faces, hidden parts apart. Depth grows along `sight`, towards the
/// viewer.
pub(super) fn seen_strokes(
    solid: &SketchSolid<f64>,
    mesh: &Mesh<f64>,
    view: &Projection,
    sight: Vec3,
) -> Vec<SeenStroke> {
    let size = size(solid);
    let covers = covers(solid, mesh, view, sight);
    let mut beside: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for (f, face) in solid.faces.iter().enumerate() {
        for &(e, _) in face.loops.iter().flatten() {
            beside.entry(e).or_default().insert(f);
        }
    }
    let mut pieces: Vec<Piece> = Vec::new();
    for e in 0..solid.edges.len() {
        let own = beside.get(&e).cloned().unwrap_or_default();
        if smooth(solid, e, &own) {
            continue;
        }
        let way = solid.polyline(e, CHORDS);
        pieces.extend(way.windows(2).map(|w| ([w[0], w[1]], own.clone())));
    }
    if !solid.flat {
        pieces.extend(outlines(solid, mesh, sight));
    }
    let mut out = Vec::new();
    for (ends, own) in &pieces {
        cut(ends, own, &covers, view, sight, size, &mut out);
    }
    // Hidden lines are drawn first, so that they do not interrupt visible ones at the same
    // position.
    out.sort_by_key(|s| !s.hidden);
    out
}

/// True for an edge within a smooth round surface, as the seams of a full turn: its faces have one
/// name and a common tangent.
fn smooth(solid: &SketchSolid<f64>, e: usize, own: &BTreeSet<usize>) -> bool {
    let faces: Vec<usize> = own.iter().copied().collect();
    let [a, b] = faces[..] else { return false };
    if !(round(solid, a) && round(solid, b)) {
        return false;
    }
    let way = solid.polyline(e, CHORDS);
    let middle = (way.len() / 2).max(1);
    let at = (way[middle - 1] + way[middle]) * 0.5;
    let normal = |f: usize| {
        let surface = solid.surface(f)?;
        let [u, v] = surface.parameters(at);
        let [_, du, dv] = surface.jet(u, v);
        du.cross(dv).normalized()
    };
    match (normal(a), normal(b)) {
        (Some(m), Some(n)) => m.cross(n).norm() < 1e-3,
        _ => false,
    }
}

fn round(solid: &SketchSolid<f64>, face: usize) -> bool {
    solid.faces.get(face).is_some_and(|f| f.ruled || f.trim.is_some())
}

fn triangles(mesh: &Mesh<f64>) -> impl Iterator<Item = (usize, [u32; 3])> + '_ {
    mesh.patches().iter().enumerate().flat_map(move |(f, patch)| {
        mesh.faces()[patch.faces.clone()].iter().flat_map(move |&[a, b, c, d]| {
            let second = (c != d).then_some((f, [a, c, d]));
            std::iter::once((f, [a, b, c])).chain(second)
        })
    })
}

fn covers(
    solid: &SketchSolid<f64>,
    mesh: &Mesh<f64>,
    view: &Projection,
    sight: Vec3,
) -> Vec<Cover> {
    let at = |v: u32| mesh.positions()[v as usize];
    triangles(mesh)
        .map(|(face, t)| {
            let corners = t.map(|v| view.project(at(v)));
            let reach = |k: usize, by: fn(f64, f64) -> f64| {
                by(by(corners[0][k], corners[1][k]), corners[2][k])
            };
            Cover {
                face,
                round: round(solid, face),
                corners,
                depths: t.map(|v| at(v).dot(sight)),
                low: [reach(0, f64::min), reach(1, f64::min)],
                high: [reach(0, f64::max), reach(1, f64::max)],
            }
        })
        .collect()
}

/// Sides of facets of round faces between one that looks at the viewer and one that looks away.
fn outlines(solid: &SketchSolid<f64>, mesh: &Mesh<f64>, sight: Vec3) -> Vec<Piece> {
    let at = |v: u32| mesh.positions()[v as usize];
    let mut sides: BTreeMap<(u32, u32), Vec<(usize, bool)>> = BTreeMap::new();
    for (face, t) in triangles(mesh) {
        let normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let facing = normal.dot(sight) > 0.0;
            sides.entry((a.min(b), a.max(b))).or_default().push((face, facing));
        }
    }
    // Edges of plane faces are drawn already.
    let turning = |found: &&[(usize, bool)]| matches!(found, [a, b] if a.1 != b.1 && round(solid, a.0) && round(solid, b.0));
    sides
        .iter()
        .filter(|(_, found)| turning(&found.as_slice()))
        .map(|(&(a, b), found)| ([at(a), at(b)], found.iter().map(|f| f.0).collect()))
        .collect()
}

/// Cuts a piece where facets before it begin and end.
fn cut(
    ends: &[Vec3; 2],
    own: &BTreeSet<usize>,
    covers: &[Cover],
    view: &Projection,
    sight: Vec3,
    size: f64,
    out: &mut Vec<SeenStroke>,
) {
    let [a, b] = ends.map(|p| view.project(p));
    let [da, db] = ends.map(|p| p.dot(sight));
    let low = [a[0].min(b[0]), a[1].min(b[1])];
    let high = [a[0].max(b[0]), a[1].max(b[1])];
    let mut hidden: Vec<[f64; 2]> = Vec::new();
    for cover in covers {
        let apart = |k: usize| cover.high[k] < low[k] || cover.low[k] > high[k];
        if apart(0) || apart(1) {
            continue;
        }
        let before = match cover.round {
            true => BEFORE[usize::from(own.contains(&cover.face))] * size,
            false => BEFORE_PLANE * size,
        };
        hidden.extend(cover.hides([a, b], [da, db], before));
    }
    hidden.sort_by(|x, y| x[0].total_cmp(&y[0]));
    let point = |t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    let mut put = |from: f64, to: f64, hidden: bool| {
        // Shorter than can be seen: where a face that hides the piece ends in it.
        if to - from > 1e-4 {
            out.push(SeenStroke { from: point(from), to: point(to), hidden });
        }
    };
    let mut done = 0.0;
    let mut k = 0;
    while k < hidden.len() {
        let [from, mut to] = hidden[k];
        k += 1;
        // Neighbouring facets leave no gap.
        while k < hidden.len() && hidden[k][0] <= to + 1e-6 {
            to = to.max(hidden[k][1]);
            k += 1;
        }
        put(done, from, false);
        put(from.max(done), to, true);
        done = to.max(done);
    }
    put(done, 1.0, false);
}

impl Cover {
    /// The part of a piece that this facet hides, as parts of its length.
    fn hides(&self, [a, b]: [[f64; 2]; 2], [da, db]: [f64; 2], before: f64) -> Option<[f64; 2]> {
        let cross = |o: [f64; 2], p: [f64; 2], q: [f64; 2]| {
            (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
        };
        let [p, q, r] = self.corners;
        let area = cross(p, q, r);
        let wide = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]);
        if area.abs() <= 1e-9 * wide * wide {
            return None;
        }
        let mut span = [0.0f64, 1.0f64];
        let mut depth = [-da, -db];
        for (o, e, d) in [(q, r, self.depths[0]), (r, p, self.depths[1]), (p, q, self.depths[2])] {
            // Barycentric coordinate of the corner opposite the side, linear along the piece.
            let share = [cross(o, e, a) / area, cross(o, e, b) / area];
            depth = [depth[0] + share[0] * d, depth[1] + share[1] * d];
            clip(&mut span, share);
        }
        clip(&mut span, [depth[0] - before, depth[1] - before]);
        (span[1] - span[0] > 1e-12).then_some(span)
    }
}

/// Keeps the part of a span where a linear function is positive.
fn clip(span: &mut [f64; 2], [at_0, at_1]: [f64; 2]) {
    match (at_0 > 0.0, at_1 > 0.0) {
        (true, true) => {}
        (false, false) => *span = [1.0, 0.0],
        (rising, _) => {
            let t = at_0 / (at_0 - at_1);
            if rising {
                span[1] = span[1].min(t);
            } else {
                span[0] = span[0].max(t);
            }
        }
    }
}
