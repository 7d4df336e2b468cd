//! Faces and solids from a wireframe.
//!
//! A cell decomposition after G. Markowsky and M. A. Wesley, *Fleshing Out Wire Frames* (IBM J. Res.
//! Dev. 24, 1980): edges span planes, planes are divided into candidate faces, candidates divide space
//! into cells, and cells are labelled solid or void so that every drawn edge is an edge of the solid.
//! Internal polygons drop out by themselves (solid on both sides), holes and cavities are void cells,
//! orientation is free, and an ambiguous wireframe gives all its solids.
//!
//! `edges -> sheets -> regions (cut where they cross) -> cells -> labels -> faces`

mod cells;
mod label;
mod regions;
mod wire;

use cells::CellComplex;
use moldloft_num::Vec3;
use moldloft_num::union_find::UnionFind;
use regions::{Half, SheetRegion, SpannedPlane};
use wire::Wireframe;

/// Maximum number of edges after cutting.
pub const MAX_EDGES: usize = 20_000;

/// A face as cycles of vertices, counter-clockwise from outside; holes clockwise.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Polygon {
    /// The outer cycle, from its lowest vertex.
    pub outer: Vec<usize>,
    /// Holes, each from its lowest vertex.
    pub holes: Vec<Vec<usize>>,
}

/// A solid that fits the wireframe.
#[derive(Clone, Debug, PartialEq)]
pub struct WireframeFit {
    /// Its faces, in the order of their cycles.
    pub faces: Vec<Polygon>,
    /// Candidates that are not faces (solid or void on both sides), as outer cycles.
    pub internal: Vec<Vec<usize>>,
    /// Edges with more than two faces.
    pub branching: Vec<[usize; 2]>,
    /// Edges between two faces in one plane.
    pub scribed: Vec<[usize; 2]>,
    /// Its volume.
    pub volume: f64,
}

/// Results of the search for solids of a wireframe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fitted {
    /// Candidate faces.
    pub candidates: usize,
    /// The candidates as polygons, oriented against the normals of their sheets; for manual choice.
    pub polygons: Vec<Polygon>,
    /// Cells between them.
    pub cells: usize,
    /// The solids, the likeliest first.
    pub fits: Vec<WireframeFit>,
    /// True if there are no others.
    pub complete: bool,
    /// Omitted edges with a loose end.
    pub dangling: Vec<[usize; 2]>,
    /// Edges of fewer than two candidates, at which the faces do not close.
    pub open: Vec<[usize; 2]>,
    /// The first of them: edges of fewer than two candidates before any candidate was dropped.
    pub first_open: Vec<[usize; 2]>,
    /// Crossings of edges without a vertex.
    pub crossings: Vec<Vec3>,
    /// True if the search was abandoned as too large.
    pub too_large: bool,
}

/// Finds the solids of a wireframe. Vertices are numbered as given.
pub fn fit(positions: &[Vec3], edges: &[[usize; 2]]) -> Fitted {
    let mut fitted = Fitted { complete: true, ..Fitted::default() };
    let mut wire = Wireframe::new(positions, edges);
    fitted.dangling = wire.prune();
    let drawn = wire.vertices.len();
    fitted.crossings = wire.vertices[positions.len()..].to_vec();
    let sheets = regions::sheets(&wire);
    let regions = loop {
        let mut regions: Vec<SheetRegion> = (sheets.iter().enumerate())
            .flat_map(|(k, sheet)| regions::regions(&wire, k, sheet))
            .collect();
        if fitted.first_open.is_empty() {
            let mut wings = vec![0; wire.edges.len()];
            regions.iter().flat_map(|r| r.loops.iter().flatten()).for_each(|h| wings[h.0] += 1);
            let few = wire.edges.iter().zip(&wings).filter(|(e, n)| !e.cut && **n < 2);
            fitted.first_open = few.map(|(e, _)| e.ends).collect();
        }
        regions::drop_unshared(&wire, &mut regions);
        let cuts = regions::cuts(&wire, &sheets, &regions);
        let before = wire.edges.len();
        for [p, q] in cuts {
            let (a, b) = (wire.vertex(p), wire.vertex(q));
            wire.insert(a, b, true);
            if wire.edges.len() > MAX_EDGES {
                fitted.too_large = true;
                return fitted;
            }
        }
        if wire.edges.len() == before {
            break regions;
        }
    };
    fitted.candidates = regions.len();
    let cells = CellComplex::build(&wire, &sheets, &regions);
    fitted.cells = cells.volume.len();
    let build =
        FitBuilder { wire: &wire, sheets: &sheets, regions: &regions, cells: &cells, drawn };
    fitted.polygons = regions.iter().map(|r| build.polygon(&r.loops, true)).collect();
    fitted.open = (wire.edges.iter().zip(&cells.wings))
        .filter(|(e, wings)| !e.cut && wings.len() < 2)
        .map(|(e, _)| e.ends)
        .collect();
    if !fitted.open.is_empty() || regions.is_empty() {
        return fitted;
    }
    let (answers, complete) = label::label(&wire, &regions, &cells);
    fitted.complete = complete;
    fitted.fits = answers.iter().map(|a| build.solid(&a.solid, a.volume)).collect();
    fitted
}

/// The regions of a plane wireframe, counter-clockwise against `normal`: the faces of a cross
/// section. A closed figure inside another is a hole, a figure inside a hole is material. Edges
/// with a loose end are omitted. A crossing of edges without a vertex is an error.
pub fn fit_plane(positions: &[Vec3], edges: &[[usize; 2]], normal: Vec3) -> Fitted {
    let mut fitted = Fitted { complete: true, ..Fitted::default() };
    let mut wire = Wireframe::new(positions, edges);
    fitted.dangling = wire.prune();
    let drawn = wire.vertices.len();
    fitted.crossings = wire.vertices[positions.len()..].to_vec();
    if !fitted.crossings.is_empty() {
        return fitted;
    }
    let sheets = regions::sheets(&wire);
    let mut regions: Vec<SheetRegion> = (sheets.iter().enumerate())
        .flat_map(|(k, sheet)| regions::regions(&wire, k, sheet))
        .collect();
    let mut figure = UnionFind::new(wire.vertices.len());
    wire.edges.iter().for_each(|e| figure.join(e.ends[0], e.ends[1]));
    let own: Vec<usize> = regions.iter().map(|r| figure.find(wire.tail(r.loops[0][0]))).collect();
    let around = |k: usize| {
        let sheet = &sheets[regions[k].sheet];
        let p = sheet.flat(wire.vertices[wire.tail(regions[k].loops[0][0])]);
        let encloses = |j: &usize| regions::encloses(&wire, sheet, &regions[*j].loops[0], p);
        (0..regions.len()).filter(|&j| own[j] != own[k]).filter(encloses).count()
    };
    let material: Vec<bool> = (0..regions.len()).map(|k| around(k) % 2 == 0).collect();
    let mut keep = material.iter();
    regions.retain(|_| *keep.next().unwrap_or(&true));
    let cells = CellComplex { side: vec![], volume: vec![], wings: vec![] };
    let build =
        FitBuilder { wire: &wire, sheets: &sheets, regions: &regions, cells: &cells, drawn };
    let up = |r: &SheetRegion| sheets[r.sheet].normal.dot(normal) > 0.0;
    let mut faces: Vec<Polygon> = regions.iter().map(|r| build.polygon(&r.loops, up(r))).collect();
    faces.sort();
    fitted.candidates = faces.len();
    fitted.polygons.clone_from(&faces);
    if !faces.is_empty() {
        let (internal, branching, scribed) = (vec![], vec![], vec![]);
        fitted.fits = vec![WireframeFit { faces, internal, branching, scribed, volume: 0.0 }];
    }
    fitted
}

struct FitBuilder<'a> {
    wire: &'a Wireframe,
    sheets: &'a [SpannedPlane],
    regions: &'a [SheetRegion],
    cells: &'a CellComplex,
    /// Vertices from here on were made by cutting.
    drawn: usize,
}

impl FitBuilder<'_> {
    fn solid(&self, solid: &[bool], volume: f64) -> WireframeFit {
        let is = |side: usize| self.cells.side[side].is_some_and(|c| solid[c]);
        // Per region: whether its outward normal is that of its sheet.
        let outward: Vec<Option<bool>> = (0..self.regions.len())
            .map(|r| match (is(2 * r), is(2 * r + 1)) {
                (false, true) => Some(true),
                (true, false) => Some(false),
                _ => None,
            })
            .collect();
        let mut joined = UnionFind::new(self.regions.len());
        let (mut branching, mut scribed) = (Vec::new(), Vec::new());
        for (edge, around) in self.wire.edges.iter().zip(&self.cells.wings) {
            let faces: Vec<usize> =
                around.iter().map(|w| w.region).filter(|&r| outward[r].is_some()).collect();
            match faces[..] {
                [a, b] if edge.cut => joined.join(a, b),
                [a, b] if self.regions[a].sheet == self.regions[b].sheet => scribed.push(edge.ends),
                [] | [_, _] => {}
                _ => branching.push(edge.ends),
            }
        }
        let mut faces = Vec::new();
        for first in 0..self.regions.len() {
            let Some(up) = outward[first].filter(|_| joined.find(first) == first) else { continue };
            let mut halves: Vec<Half> = (first..self.regions.len())
                .filter(|&r| outward[r].is_some() && joined.find(r) == first)
                .flat_map(|r| self.regions[r].loops.iter().flatten().copied())
                .collect();
            // Both sides of an edge: the joint of two parts, or a line scribed on the face.
            halves.sort_unstable();
            let both = |h: &Half| halves.binary_search(&(h.0, !h.1)).is_ok();
            let single: Vec<Half> = halves.iter().filter(|h| !both(h)).copied().collect();
            let sheet = &self.sheets[self.regions[first].sheet];
            let loops = regions::walk(self.wire, sheet, &single);
            for face in regions::nested(self.wire, sheet, loops) {
                faces.push(self.polygon(&face, up));
            }
        }
        faces.sort();
        let internal = (self.regions.iter().zip(&outward))
            .filter(|(_, up)| up.is_none())
            .map(|(r, _)| self.cycle(&r.loops[0], true))
            .collect();
        WireframeFit { faces, internal, branching, scribed, volume }
    }

    fn polygon(&self, loops: &[Vec<Half>], up: bool) -> Polygon {
        let mut cycles = loops.iter().map(|cycle| self.cycle(cycle, up));
        let outer = cycles.next().unwrap_or_default();
        let mut holes: Vec<Vec<usize>> = cycles.collect();
        holes.sort();
        Polygon { outer, holes }
    }

    /// The vertices of a loop, turned over if `up` is false, without those that cutting left inside
    /// straight edges, from the lowest one.
    fn cycle(&self, halves: &[Half], up: bool) -> Vec<usize> {
        let mut all: Vec<usize> = halves.iter().map(|&h| self.wire.tail(h)).collect();
        let n = all.len();
        let straight = |k: usize| {
            let at = |k: usize| self.wire.vertices[all[k % n]];
            let (a, b) = (at(k) - at(k + n - 1), at(k + 1) - at(k));
            a.cross(b).norm() <= self.wire.tolerance * a.norm().max(b.norm()) && a.dot(b) > 0.0
        };
        let keep: Vec<usize> =
            (0..n).filter(|&k| all[k] < self.drawn || !straight(k)).map(|k| all[k]).collect();
        all = keep;
        if !up {
            all.reverse();
        }
        let lowest = (0..all.len()).min_by_key(|&k| all[k]).unwrap_or(0);
        all.rotate_left(lowest);
        all
    }
}

/// Maximum distance of points from the plane that fits their polygon (Newell's normal through their
/// centre).
pub fn flatness(points: &[Vec3]) -> f64 {
    let n = points.len();
    if n < 4 {
        return 0.0;
    }
    let centre = points.iter().fold(Vec3::zero(), |s, p| s + *p) / n as f64;
    let normal = (0..n)
        .fold(Vec3::zero(), |s, k| s + (points[k] - centre).cross(points[(k + 1) % n] - centre));
    let Some(normal) = normal.normalized() else { return 0.0 };
    points.iter().map(|p| (*p - centre).dot(normal).abs()).fold(0.0, f64::max)
}
