//! Sides of faces cut into runs between common vertices; runs that are one become one edge.

use super::faces::{not_fitted, plane};
use crate::ExportFailure;
use moldloft_brep::{Brep, BrepEdge, BrepFace, Coedge, SurfaceShape};
use moldloft_num::{Order, Rational, Vec3};
use moldloft_panel::{FaceOutline, OutlineCurve, OutlineSide};
use moldloft_parallel::prelude::*;
use moldloft_picture::PALETTE;
use moldloft_registry::CurveRef;
use moldloft_spline::nurbs::{FitOptions, Nurbs, SampledShape, fit, of_curve};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Distance, in accuracies, beyond which curves through the same vertices are two edges.
const PARTED: f64 = 50.0;

/// The same relative to their length: the tolerance of declared joins is seldom larger.
const JOINED: f64 = 1e-4;

/// Curves are alike if they differ by less than this at equal parameters, relative to the size.
const ALIKE: f64 = 1e-9;

/// A side of a loop with derived data.
struct Sided<'a> {
    face: usize,
    side: &'a OutlineSide,
    /// Its curve in space and, for snakes, in the parameters of the surface's NURBS.
    curve: Option<(Nurbs<1>, Option<Nurbs<1>>)>,
}

/// A stretch of a side between two vertices at which edges end.
struct SideInterval {
    side: usize,
    from: usize,
    to: usize,
}

/// State of sewing faces.
pub struct Sewing<'a> {
    outlines: &'a [FaceOutline],
    surfaces: &'a [Arc<Nurbs<2>>],
    positions: &'a [Vec3],
    accuracy: f64,
    size: f64,
    sides: Vec<Sided<'a>>,
    /// The first side of each loop of each face.
    loops: Vec<Vec<Vec<usize>>>,
    ends: HashSet<u32>,
    vertices: HashMap<u32, usize>,
    edges: HashMap<Vec<u32>, Vec<usize>>,
    brep: Brep,
}

impl<'a> Sewing<'a> {
    pub fn new(
        outlines: &'a [FaceOutline],
        surfaces: &'a [Arc<Nurbs<2>>],
        positions: &'a [Vec3],
        accuracy: f64,
        size: f64,
    ) -> Self {
        let mut sides = Vec::new();
        let mut loops = Vec::new();
        for (face, outline) in outlines.iter().enumerate() {
            let mut own = Vec::new();
            for cycle in &outline.loops {
                let first = sides.len();
                sides.extend(cycle.iter().map(|side| Sided { face, side, curve: None }));
                own.push((first..sides.len()).collect());
            }
            loops.push(own);
        }
        let mut sewing = Self {
            outlines,
            surfaces,
            positions,
            accuracy,
            size,
            sides,
            loops,
            ends: HashSet::new(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            brep: Brep::default(),
        };
        sewing.find_ends();
        sewing
    }

    /// The vertices at which edges end: ends of sides, and those where other sides come or go.
    fn find_ends(&mut self) {
        let mut users: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        for (k, sided) in self.sides.iter().enumerate() {
            for pair in sided.side.vertices.windows(2).filter(|w| w[0] != w[1]) {
                let pair = (pair[0].min(pair[1]), pair[0].max(pair[1]));
                let all = users.entry(pair).or_default();
                if all.last() != Some(&k) {
                    all.push(k);
                }
            }
        }
        let of = |a: u32, b: u32| users.get(&(a.min(b), a.max(b)));
        for sided in &self.sides {
            let vertices = &sided.side.vertices;
            let [Some(first), Some(last)] = [vertices.first(), vertices.last()] else { continue };
            if vertices.iter().any(|v| v != first) {
                self.ends.extend([*first, *last]);
            }
            for w in vertices.windows(3).filter(|w| w[0] != w[1] && w[1] != w[2]) {
                if of(w[0], w[1]) != of(w[1], w[2]) {
                    self.ends.insert(w[1]);
                }
            }
        }
    }

    pub fn finish(mut self) -> Result<Brep, ExportFailure> {
        self.fit_snakes();
        for face in 0..self.outlines.len() {
            self.face(face)?;
        }
        Ok(self.brep)
    }

    fn face(&mut self, face: usize) -> Result<(), ExportFailure> {
        let outline = &self.outlines[face];
        let mut loops = Vec::new();
        for (l, cycle) in self.loops[face].clone().into_iter().enumerate() {
            let mut sides = Vec::new();
            for side in cycle {
                let mut own = self.side(side)?;
                if self.sides[side].side.backwards {
                    own.reverse();
                    own.iter_mut().for_each(|s| s.forward = !s.forward);
                }
                sides.extend(own);
            }
            if sides.is_empty() {
                continue;
            }
            // Round the outer loop the parameters run counter-clockwise, round holes clockwise.
            if outline.reversed != (self.clockwise(&outline.loops[l]) == (l == 0)) {
                sides.reverse();
                sides.iter_mut().for_each(|s| s.forward = !s.forward);
            }
            loops.push(sides);
        }
        let surface = &self.surfaces[face];
        let seam = |cycle: &Vec<Coedge>| {
            cycle.iter().enumerate().any(|(k, a)| cycle[..k].iter().any(|b| a.edge == b.edge))
        };
        let flat = if loops.iter().any(seam) { None } else { plane(surface) };
        if flat.is_some() {
            loops.iter_mut().flatten().for_each(|side| side.trace = None);
        }
        self.brep.gap = self.brep.gap.max(surface.error);
        self.brep.faces.push(BrepFace {
            name: outline.name.to_string(),
            colour: Some(PALETTE[(outline.colour & 15) as usize]),
            layers: outline.tags.iter().map(|t| t.to_string()).collect(),
            surface: flat.unwrap_or_else(|| SurfaceShape::Nurbs(Box::new((**surface).clone()))),
            reversed: outline.reversed,
            loops,
            error: surface.error,
            exact: surface.exact,
            extent: None,
        });
        Ok(())
    }

    /// True when the loop runs clockwise in the parameters.
    fn clockwise(&self, cycle: &[OutlineSide]) -> bool {
        let mut polygon = Vec::new();
        // A side that is one point has no length there.
        for side in cycle.iter().filter(|s| s.vertices.iter().any(|v| *v != s.vertices[0])) {
            let mut own: Vec<[f64; 2]> = side.at.iter().map(|&t| place(&side.along, t)).collect();
            if side.backwards {
                own.reverse();
            }
            polygon.extend(own);
        }
        let next = |k: usize| polygon[(k + 1) % polygon.len()];
        let cross = |k: usize| polygon[k][0] * next(k)[1] - polygon[k][1] * next(k)[0];
        (0..polygon.len()).map(cross).sum::<f64>() < 0.0
    }

    /// The sides of edges that a side of an outline consists of, by increasing parameter.
    fn side(&mut self, side: usize) -> Result<Vec<Coedge>, ExportFailure> {
        let vertices = &self.sides[side].side.vertices;
        let mut runs = Vec::new();
        let mut from = 0;
        for to in 1..vertices.len() {
            if self.ends.contains(&vertices[to]) || to + 1 == vertices.len() {
                if vertices[from..=to].iter().any(|v| *v != vertices[from]) {
                    runs.push(SideInterval { side, from, to });
                }
                from = to;
            }
        }
        runs.iter().map(|run| self.edge(run)).collect()
    }

    /// Makes the curves of snakes in parallel; errors are reported on use.
    fn fit_snakes(&mut self) {
        let long = |s: &Sided<'_>| s.side.vertices.iter().any(|v| *v != s.side.vertices[0]);
        let snakes: Vec<usize> = (0..self.sides.len())
            .filter(|&k| matches!(self.sides[k].side.along, OutlineCurve::Snake(_)))
            .filter(|&k| long(&self.sides[k]))
            .collect();
        let made: Vec<_> = snakes.par_iter().map(|&k| self.fitted(k).ok()).collect();
        for (k, curve) in snakes.into_iter().zip(made) {
            self.sides[k].curve = curve;
        }
    }

    /// The curve of a side, and its trace where it is a snake; made once.
    fn curve(&mut self, side: usize) -> Result<(), ExportFailure> {
        if self.sides[side].curve.is_some() {
            return Ok(());
        }
        self.sides[side].curve = Some(self.fitted(side)?);
        Ok(())
    }

    fn fitted(&self, side: usize) -> Result<(Nurbs<1>, Option<Nurbs<1>>), ExportFailure> {
        let face = self.sides[side].face;
        let surface = &self.surfaces[face];
        Ok(match &self.sides[side].side.along {
            OutlineCurve::Edge(k) => (surface.edge(usize::from(*k)), None),
            OutlineCurve::Snake(snake) => {
                let name = &self.outlines[face].name;
                let fault = |e| not_fitted(name, &e, self.accuracy);
                let options = FitOptions::within(self.accuracy);
                let curve = of_curve(&**snake, &options).map_err(fault)?;
                let trace = trace(snake, surface, self.accuracy).map_err(fault)?;
                (curve, Some(trace))
            }
        })
    }

    /// The edge of a run, new or known.
    fn edge(&mut self, run: &SideInterval) -> Result<Coedge, ExportFailure> {
        self.curve(run.side)?;
        let sided = &self.sides[run.side];
        let surface = &self.surfaces[sided.face];
        let at = [run.from, run.to].map(|k| sided.side.at[k]);
        let Some((whole, path)) = &sided.curve else { unreachable!("made above") };
        let pace = whole.paces[0];
        let [a, b] = at.map(|t| pace.inverse(t));
        let curve = whole.part(a, b);
        let trace = match (&sided.side.along, path) {
            (OutlineCurve::Edge(k), _) => line(*k, a, b),
            (_, Some(path)) => {
                let [a, b] = at.map(|t| path.paces[0].inverse(t));
                path.part(a, b)
            }
            _ => unreachable!("snakes have traces"),
        };
        let error = curve.error.max(surface.error);
        let mut key: Vec<u32> = sided.side.vertices[run.from..=run.to].to_vec();
        key.dedup();
        let ends = [key[0], key[key.len() - 1]];
        let mut back = key.clone();
        back.reverse();
        if back < key {
            key = back;
        }
        let ends = ends.map(|v| self.vertex(v));
        let known = self.edges.get(&key).cloned().unwrap_or_default();
        for edge in known {
            if let Some((forward, alike, gap)) = self.same(edge, ends, &curve) {
                self.brep.gap = self.brep.gap.max(gap.max(error));
                let trace = if forward { trace } else { trace.reversed() };
                return Ok(Coedge { edge, forward, trace: Some(trace), alike });
            }
        }
        let far = |k: usize, t: f64| curve.at([t]).distance(self.brep.vertices[ends[k]]);
        self.brep.gap = self.brep.gap.max(far(0, 0.0)).max(far(1, 1.0)).max(error);
        let edge = self.brep.edges.len();
        self.brep.edges.push(BrepEdge { ends, curve, ellipse: None });
        self.edges.entry(key).or_default().push(edge);
        Ok(Coedge { edge, forward: true, trace: Some(trace), alike: true })
    }

    fn vertex(&mut self, v: u32) -> usize {
        *self.vertices.entry(v).or_insert_with(|| {
            self.brep.vertices.push(self.positions[v as usize]);
            self.brep.vertices.len() - 1
        })
    }

    /// Comparison of a curve through the vertices of an edge with that edge: same direction, equal
    /// parameters, and distance.
    fn same(&self, edge: usize, ends: [usize; 2], curve: &Nurbs<1>) -> Option<(bool, bool, f64)> {
        const PLACES: usize = 12;
        let known = &self.brep.edges[edge];
        let parameters: Vec<f64> = (0..=PLACES).map(|k| k as f64 / PLACES as f64).collect();
        let parameters = [parameters];
        let theirs = known.curve.grid(&parameters);
        let mut own = curve.grid(&parameters);
        let apart =
            |own: &[Vec3]| own.iter().zip(&theirs).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        // A closed edge may have either direction.
        let straight = apart(&own);
        own.reverse();
        let turned = apart(&own);
        let forward = match known.ends == ends {
            true if ends[0] == ends[1] => straight <= turned,
            same => same,
        };
        let off = if forward { straight } else { turned };
        if off <= ALIKE * self.size + self.accuracy.min(1e-6 * self.size) {
            return Some((forward, true, off));
        }
        // Different parameters: distance of each point from the curve.
        const FINE: usize = 64;
        let fine: Vec<f64> = (0..=FINE).map(|k| k as f64 / FINE as f64).collect();
        let fine = [fine];
        let own = curve.grid(&fine);
        let places = known.curve.grid(&fine);
        let off = own.iter().map(|p| to_curve(*p, &known.curve, &places)).fold(0.0, f64::max);
        let length: f64 = places.windows(2).map(|w| w[0].distance(w[1])).sum();
        // Joined edges may be this far apart; the file states the distance.
        let allowed = PARTED * self.accuracy + JOINED * length;
        (off <= allowed).then_some((forward, false, off))
    }
}

/// The distance of a point from a curve with known points at even parameters: the least near the
/// nearest chord, by golden sections. It is never less than the true distance.
fn to_curve(p: Vec3, curve: &Nurbs<1>, places: &[Vec3]) -> f64 {
    /// Sections that leave 1e-7 of two chords.
    const SECTIONS: usize = 32;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let chords = places.len() - 1;
    let distances = places.windows(2).map(|w| to_segment(p, w[0], w[1]));
    let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k);
    let far = |t: f64| p.distance(curve.at([t]));
    let mut low = nearest.saturating_sub(1) as f64 / chords as f64;
    let mut high = (nearest + 2).min(chords) as f64 / chords as f64;
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = inner.map(far);
    for _ in 0..SECTIONS {
        if values[0] < values[1] {
            (high, inner[1], values[1]) = (inner[1], inner[0], values[0]);
            inner[0] = high - GOLDEN * (high - low);
            values[0] = far(inner[0]);
        } else {
            (low, inner[0], values[0]) = (inner[0], inner[1], values[1]);
            inner[1] = low + GOLDEN * (high - low);
            values[1] = far(inner[1]);
        }
    }
    values[0].min(values[1]).min(far(low)).min(far(high))
}

fn to_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let d = b - a;
    let size = d.norm_sq();
    let t = if size > 0.0 { ((p - a).dot(d) / size).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + d * t)
}

/// The parameters of the surface at `t`.
fn place(along: &OutlineCurve, t: f64) -> [f64; 2] {
    match along {
        OutlineCurve::Edge(k) => [[t, 0.0], [1.0, t], [t, 1.0], [0.0, t]][usize::from(*k)],
        OutlineCurve::Snake(snake) => {
            let [w, ..] = snake.on_surface(t, Order::Zero).unwrap_or_default();
            [w.x, w.y]
        }
    }
}

/// A straight trace along an edge of the surface.
fn line(k: u8, a: f64, b: f64) -> Nurbs<1> {
    let at = |t: f64| {
        let [u, v] = [[t, 0.0], [1.0, t], [t, 1.0], [0.0, t]][usize::from(k)];
        Vec3::of(u, v, 0.0)
    };
    Nurbs {
        degrees: [1],
        knots: [vec![0.0, 0.0, 1.0, 1.0]],
        points: vec![at(a), at(b)],
        weights: None,
        error: 0.0,
        exact: true,
        paces: [moldloft_num::Pace::Even],
    }
}

/// The path of a snake in the parameters of the surface's NURBS.
fn trace(
    snake: &CurveRef<f64>,
    surface: &Nurbs<2>,
    accuracy: f64,
) -> Result<Nurbs<1>, moldloft_spline::nurbs::NotFitted> {
    let [u_pace, v_pace] = surface.paces;
    let sample = |[ts]: &[Vec<f64>; 1]| {
        let at = |&t: &f64| {
            let [w, ..] = snake.on_surface(t, Order::Zero).unwrap_or_default();
            Vec3::of(u_pace.inverse(w.x), v_pace.inverse(w.y), 0.0)
        };
        ts.iter().map(at).collect()
    };
    // A step in parameters is so much in space.
    let [nu, nv] = surface.counts();
    let long = |a: usize, b: usize| surface.points[a].distance(surface.points[b]);
    let u_size = (0..nv).map(|j| (1..nu).map(|i| long((i - 1) * nv + j, i * nv + j)).sum::<f64>());
    let v_size = (0..nu).map(|i| (1..nv).map(|j| long(i * nv + j - 1, i * nv + j)).sum::<f64>());
    let slope = 2.0 * u_size.chain(v_size).fold(0.0, f64::max);
    let options =
        FitOptions::within(if slope > 0.0 { (accuracy / slope).max(1e-13) } else { 1e-9 });
    fit(
        &SampledShape { sample: &sample, joints: [snake.joints()], rational: Rational::none() },
        &options,
    )
}
