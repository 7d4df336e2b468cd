//! Bodies of revolution: a section turned about a line in its plane.

use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use super::{SketchSolid, SolidEdge, SolidFace, Trim, Vertex};
use crate::PointId;
use moldloft_num::{Axis as Line, Real, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// A directed side of the section: its ends as numbers, and its curve.
struct SectionSide<T> {
    ends: [usize; 2],
    piece: SmoothPiece<T>,
    straight: bool,
    name: Option<Arc<str>>,
}

/// Turns a flat body about a line by an angle in radians; a full turn when it is 2π or more. `None` when
/// the line has no length or the section nothing on its side.
/// `name` names the faces that edges of the section become.
pub fn turned<T: Real>(
    section: &SketchSolid<T>,
    line: [Vec3<T>; 2],
    angle: T,
    name: &dyn Fn(usize) -> Option<Arc<str>>,
) -> Option<SketchSolid<T>> {
    const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
    let axis = Line::through(line[0], line[1])?;
    let full = angle.re().abs() >= 4.0 * QUARTER * (1.0 - 1e-12);
    let angle = if full { T::from(4.0 * QUARTER * angle.re().signum()) } else { angle };
    let steps = (angle.re().abs() / QUARTER - 1e-9).ceil().max(1.0) as usize;
    let step = angle * (1.0 / steps as f64);
    let size = section.vertices.iter().map(|v| v.at.re().distance(line[0].re()));
    let size = size.fold(0.0, f64::max);
    let mut at: Vec<Vec3<T>> = section.vertices.iter().map(|v| v.at).collect();
    let on_axis = |p: Vec3<T>| axis.foot(p).re().distance(p.re()) <= 1e-9 * size;
    // Sides that have the section on one side only.
    let mut uses = vec![0; section.edges.len()];
    section.faces.iter().flat_map(|f| f.loops.iter().flatten()).for_each(|h| uses[h.0] += 1);
    let mut sides: Vec<SectionSide<T>> = Vec::new();
    for &(e, forward) in section.faces.iter().flat_map(|f| f.loops.iter().flatten()) {
        if uses[e] != 1 {
            continue;
        }
        let edge = &section.edges[e];
        let name = name(e);
        let ends = if forward { edge.ends } else { [edge.ends[1], edge.ends[0]] };
        let (piece, straight) = (section.piece((e, forward)), edge.piece.is_none());
        if !straight && ends.iter().all(|&v| on_axis(at[v])) {
            // With a pole at both ends: as two.
            let [first, second] = halves(&piece);
            at.push(piece.at(T::from(0.5)));
            let middle = at.len() - 1;
            let half = name.clone();
            sides.push(SectionSide { ends: [ends[0], middle], piece: first, straight, name: half });
            sides.push(SectionSide { ends: [middle, ends[1]], piece: second, straight, name });
        } else {
            sides.push(SectionSide { ends, piece, straight, name });
        }
    }
    let rings = if full { steps } else { steps + 1 };
    let mut out = SketchSolid::<T>::default();
    let mut vertex: HashMap<(usize, usize), usize> = HashMap::new();
    let turn = |k: usize, p: Vec3<T>| axis.rotated(p, step * k as f64);
    for ring in 0..rings {
        for (v, &p) in at.iter().enumerate() {
            let number = match vertex.get(&(v, 0)).filter(|_| on_axis(p)) {
                Some(&first) => first,
                None => {
                    let id = PointId(out.vertices.len() as u32 + 1);
                    out.vertices.push(Vertex { id, at: turn(ring, p) });
                    out.vertices.len() - 1
                }
            };
            vertex.insert((v, ring), number);
        }
    }
    let mut copy: HashMap<(usize, usize), usize> = HashMap::new();
    let mut arc: HashMap<(usize, usize), usize> = HashMap::new();
    let turned_piece = |piece: &SmoothPiece<T>, k: usize| piece.mapped(&|p| turn(k, p));
    for ring in 0..rings {
        for (s, side) in sides.iter().enumerate() {
            let ends = side.ends.map(|v| vertex[&(v, ring)]);
            if ends[0] == ends[1] {
                continue;
            }
            let both = side.ends.iter().all(|&v| on_axis(at[v]));
            if both && ring > 0 {
                continue;
            }
            copy.insert((s, ring), out.edges.len());
            let piece = (!side.straight).then(|| turned_piece(&side.piece, ring));
            out.edges.push(SolidEdge { ends, piece, ..SolidEdge::default() });
        }
    }
    for k in 0..steps {
        let next = (k + 1) % rings;
        for (v, &p) in at.iter().enumerate() {
            if on_axis(p) {
                continue;
            }
            let from = turn(k, p);
            let centre = axis.foot(p);
            let a = from - centre;
            arc.insert((v, k), out.edges.len());
            let piece = SmoothPiece::Conic { centre, a, b: axis.direction.cross(a), sweep: step };
            let piece = if step.re() < 0.0 {
                SmoothPiece::Conic { centre, a, b: -axis.direction.cross(a), sweep: -step }
            } else {
                piece
            };
            let ends = [vertex[&(v, k)], vertex[&(v, next)]];
            out.edges.push(SolidEdge { ends, piece: Some(piece), ..SolidEdge::default() });
        }
    }
    for (s, side) in sides.iter().enumerate() {
        let [p, q] = side.ends;
        let poles = side.ends.map(|v| on_axis(at[v]));
        if poles == [true, true] {
            continue;
        }
        let across = (at[q] - at[p]).re().dot(axis.direction.re()).abs() <= 1e-12 * size;
        for k in 0..steps {
            let next = (k + 1) % rings;
            let (here, there) = ((copy[&(s, k)], true), (copy[&(s, next)], false));
            // From an arc on: a cylinder or cone is a ruled patch between its arcs.
            let cycle = match poles {
                [true, _] => vec![(arc[&(q, k)], true), there, here],
                [_, true] => vec![(arc[&(p, k)], false), here, there],
                _ => vec![(arc[&(q, k)], true), there, (arc[&(p, k)], false), here],
            };
            let trim = (!side.straight).then(|| {
                let surface = FaceSurface::Turned {
                    centre: axis.point,
                    axis: axis.direction,
                    profile: turned_piece(&side.piece, k),
                    sweep: step,
                };
                out.trims.push(Trim { surface, face: out.faces.len() });
                out.trims.len() - 1
            });
            let ruled = side.straight && !across;
            let (loops, names) = (vec![cycle], side.name.iter().cloned().collect());
            out.faces.push(SolidFace { id: None, ruled, loops, trim, names });
        }
    }
    if !full {
        caps(section, &sides, &copy, steps, &mut out);
    }
    // Edges on the axis belong to caps only; of a full turn they bound nothing.
    let mut used = vec![false; out.edges.len()];
    out.faces.iter().flat_map(|f| f.loops.iter().flatten()).for_each(|h| used[h.0] = true);
    if out.faces.is_empty() {
        return None;
    }
    out.drop_unused(&used);
    if out.mass().volume.re() < 0.0 {
        out.turn_over();
    }
    Some(out)
}

/// The section at both ends of a part of a turn.
fn caps<T: Real>(
    section: &SketchSolid<T>,
    sides: &[SectionSide<T>],
    copy: &HashMap<(usize, usize), usize>,
    steps: usize,
    out: &mut SketchSolid<T>,
) {
    // All faces of the section as one: its sides in the order of their ends.
    let _ = section;
    let mut left: Vec<usize> = (0..sides.len()).collect();
    let mut cycles: Vec<Vec<usize>> = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut cycle = vec![first];
        left.retain(|s| *s != first);
        while let Some(next) = {
            let end = sides[cycle[cycle.len() - 1]].ends[1];
            left.iter().copied().find(|s| sides[*s].ends[0] == end)
        } {
            cycle.push(next);
            left.retain(|s| *s != next);
        }
        cycles.push(cycle);
    }
    let edge = |s: usize, ring: usize| copy.get(&(s, ring)).or(copy.get(&(s, 0))).copied();
    // The cycle around most comes first: the others are its holes.
    let reach = |c: &Vec<usize>| {
        let points = c.iter().map(|s| sides[*s].piece.at(T::zero()).re());
        let all: Vec<Vec3> = points.collect();
        super::facet_source::newell(&all).norm()
    };
    cycles.sort_by(|a, b| reach(b).total_cmp(&reach(a)));
    let start = cycles
        .iter()
        .map(|c| c.iter().rev().filter_map(|&s| Some((edge(s, 0)?, false))).collect::<Vec<_>>());
    let start: Vec<_> = start.collect();
    let end = cycles
        .iter()
        .map(|c| c.iter().filter_map(|&s| Some((edge(s, steps)?, true))).collect::<Vec<_>>());
    let end: Vec<_> = end.collect();
    for (loops, name) in [(start, "START"), (end, "END")] {
        out.faces.push(SolidFace {
            id: None,
            ruled: false,
            loops,
            trim: None,
            names: vec![name.into()],
        });
    }
}

/// A piece as two of equal ranges.
fn halves<T: Real>(piece: &SmoothPiece<T>) -> [SmoothPiece<T>; 2] {
    match *piece {
        SmoothPiece::Conic { centre, a, b, sweep } => {
            let half = sweep * 0.5;
            let (c, s) = (half.cos(), half.sin());
            let second =
                SmoothPiece::Conic { centre, a: a * c + b * s, b: b * c - a * s, sweep: half };
            [SmoothPiece::Conic { centre, a, b, sweep: half }, second]
        }
        SmoothPiece::Cubic([p, q, r, e]) => {
            let half = T::from(0.5);
            let (x, y, z) = (p.lerp(q, half), q.lerp(r, half), r.lerp(e, half));
            let (u, v) = (x.lerp(y, half), y.lerp(z, half));
            let m = u.lerp(v, half);
            [SmoothPiece::Cubic([p, x, u, m]), SmoothPiece::Cubic([m, v, z, e])]
        }
    }
}

impl<T: Real> SketchSolid<T> {
    /// Leaves out edges, and the vertices that only they have.
    fn drop_unused(&mut self, used: &[bool]) {
        let mut number = vec![usize::MAX; used.len()];
        let mut kept = Vec::new();
        for (e, edge) in std::mem::take(&mut self.edges).into_iter().enumerate() {
            if used[e] {
                number[e] = kept.len();
                kept.push(edge);
            }
        }
        self.edges = kept;
        self.faces
            .iter_mut()
            .flat_map(|f| f.loops.iter_mut().flatten())
            .for_each(|h| h.0 = number[h.0]);
        let mut place = vec![usize::MAX; self.vertices.len()];
        let mut vertices = Vec::new();
        for edge in &mut self.edges {
            for end in &mut edge.ends {
                if place[*end] == usize::MAX {
                    place[*end] = vertices.len();
                    let id = PointId(vertices.len() as u32 + 1);
                    vertices.push(Vertex { id, ..self.vertices[*end] });
                }
                *end = place[*end];
            }
        }
        self.vertices = vertices;
    }
}
