//! Bodies made valid and combined: the arrangement of oriented plane facets.
//!
//! Facets of one or more closed surfaces divide each other into regions; every cell of space
//! between regions has a winding number per operand, counted across the regions (a facet passed
//! against its outward normal adds one). A rule on these numbers defines the solid: `a > 0 || b >
//! 0` is the union, `a > 0` alone makes one body of a self-intersecting surface, where a hole
//! outside the body has the winding -1 and so encloses nothing.
//!
//! `facets -> sheets -> segments -> split edges -> regions -> windings -> faces`
//!
//! Nothing here depends on the order of facets, and neighbours share vertices by number.

mod cells;
mod plane;
mod pool;
mod regions;

use moldloft_num::Vec3;
use moldloft_num::union_find::UnionFind;
use plane::{PlaneCoordinates, common_segments, facet_winding};
pub(super) use pool::overlapping;
use pool::{PointCells, Pool, bounds};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Tag of an edge that is not part of an edge of the body.
pub const INNER: u32 = u32::MAX;

/// An oriented plane polygon of an operand.
#[derive(Clone, Debug)]
pub struct Facet {
    /// Its body: 0 or 1.
    pub operand: usize,
    /// Its face in that body.
    pub tag: u32,
    /// True if the face is plane, so that its parts may be merged with others in the same plane.
    pub plane: bool,
    /// The outward unit normal.
    pub normal: Vec3,
    /// Cycles of points, counter-clockwise about the normal; holes clockwise.
    pub loops: Vec<Vec<u32>>,
    /// The edge of the body that each side is part of, or [`INNER`].
    pub edges: Vec<Vec<u32>>,
    /// The surface that its face shares with others, so that their parts may be merged.
    pub side: Option<SurfaceSide>,
    bounds: [Vec3; 2],
}

/// A side of a surface that several faces share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SurfaceSide {
    /// Its number.
    pub surface: usize,
    /// True if it is the surface's positive side.
    pub positive: bool,
}

impl Facet {
    /// A facet of a face that shares its surface with no other.
    pub fn new(
        operand: usize,
        tag: u32,
        plane: bool,
        normal: Vec3,
        loops: Vec<Vec<u32>>,
        edges: Vec<Vec<u32>>,
    ) -> Facet {
        Facet { operand, tag, plane, normal, loops, edges, side: None, bounds: [Vec3::zero(); 2] }
    }
}

fn edges_of(facet: &Facet) -> impl Iterator<Item = [u32; 2]> + '_ {
    facet.loops.iter().flat_map(|c| (0..c.len()).map(|k| [c[k], c[(k + 1) % c.len()]]))
}

/// A face of the result.
#[derive(Clone, Debug)]
pub struct ArrangedFace {
    /// The faces that cover it: operand and tag; the surface is that of the first.
    pub sources: Vec<(usize, u32)>,
    /// True if its outward side is the inner side of the first source.
    pub reversed: bool,
    /// True if it is plane.
    pub plane: bool,
    /// The outward normal of a plane one.
    pub normal: Vec3,
    /// Cycles of points, with the face to their left seen from outside; the outer cycle of a plane
    /// face comes first.
    pub loops: Vec<Vec<u32>>,
    /// Its plane parts with equal orientation, each with its holes.
    pub parts: Vec<Vec<Vec<u32>>>,
    /// Face of each part.
    pub owners: Vec<(usize, u32)>,
    /// Outward normal of each part's facet.
    pub normals: Vec<Vec3>,
}

/// The body that satisfies a rule.
#[derive(Clone, Debug)]
pub struct Arrangement {
    /// All points, the given ones first.
    pub points: Vec<Vec3>,
    /// The number of each given point.
    pub given: Vec<u32>,
    /// Its faces.
    pub faces: Vec<ArrangedFace>,
    /// The edges of the operands that each side is part of: operand and tag, by points in order.
    pub edges: HashMap<(u32, u32), Vec<(usize, u32)>>,
    /// True if facets are omitted, or a cell has windings other than 0 and 1.
    pub changed: bool,
    /// Coincident surfaces; also lines, if requested.
    pub shared: Vec<SurfaceCoincidence>,
}

/// A region covered by several faces, or a line common to more than two.
#[derive(Clone, Debug)]
pub struct SurfaceCoincidence {
    /// The corners of the region, or the ends of the line.
    pub points: Vec<u32>,
    /// The faces: operand and tag.
    pub sources: Vec<(usize, u32)>,
    /// True for a region.
    pub region: bool,
}

/// Reason why there is no body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArrangeError {
    /// Winding numbers depend on the path: a surface is open or nearly coincides with another at
    /// this position.
    Inconsistent(Vec3),
    /// The number of pieces exceeds the limit.
    TooLarge,
}

/// A region between segments.
struct ArrangedRegion {
    sheet: usize,
    loops: regions::Loops,
    /// Number of facets that cover it, by operand, signed by the side of their normal.
    turns: cells::Turns,
    inner: Vec3,
    /// The facets that cover it.
    covers: Vec<usize>,
}

/// More regions than this are refused.
const MAX_REGIONS: usize = 400_000;

/// Makes the body of the region where `solid` holds for the winding numbers. Facets of one operand
/// are assumed not to cross each other unless `crossing`. Lines in which more than two surfaces
/// meet are listed if `sharing`. Faces end at `seams`, edges by operand and tag, although their
/// surface continues.
///
/// # Errors
/// [`ArrangeError`], with the position.
pub fn arrange(
    points: &[Vec3],
    mut facets: Vec<Facet>,
    [crossing, sharing]: [bool; 2],
    seams: &BTreeSet<(usize, u32)>,
    solid: &dyn Fn([i32; 2]) -> bool,
) -> Result<Arrangement, ArrangeError> {
    let [low, high] = bounds(points.iter().copied());
    let size = (high - low).norm();
    let mut pool = Pool::new((1e-9 * size).max(f64::MIN_POSITIVE));
    let given: Vec<u32> = points.iter().map(|&p| pool.add(p)).collect();
    for facet in &mut facets {
        renumber(facet, &given);
        facet.bounds = bounds(facet.loops.iter().flatten().map(|&v| pool.at(v)));
    }
    facets.retain(|f| !f.loops.is_empty());
    let frames: Vec<PlaneCoordinates> =
        facets.iter().map(|f| PlaneCoordinates::new(f.normal, pool.at(f.loops[0][0]))).collect();
    let (sheet_of, cuts) = meet(&pool, &facets, &frames, crossing);
    // Sheets: facets of one plane that touch.
    let mut sheets: Vec<PlaneCoordinates> = Vec::new();
    let mut members: Vec<Vec<usize>> = Vec::new();
    let mut number: BTreeMap<usize, usize> = BTreeMap::new();
    for (k, &root) in sheet_of.iter().enumerate() {
        let s = *number.entry(root).or_insert_with(|| {
            sheets.push(frames[k]);
            members.push(Vec::new());
            sheets.len() - 1
        });
        members[s].push(k);
    }
    // All segments of each sheet, with their intersections.
    let mut segments: Vec<BTreeSet<(u32, u32)>> = Vec::with_capacity(sheets.len());
    for own in &members {
        let mut set: BTreeSet<(u32, u32)> = BTreeSet::new();
        let mut alone = own.len() == 1 && !crossing;
        for &f in own {
            set.extend(edges_of(&facets[f]).map(|[a, b]| (a.min(b), a.max(b))));
            for [p, q] in cuts.get(&f).into_iter().flatten() {
                let (a, b) = (pool.add(*p), pool.add(*q));
                if a != b {
                    alone = false;
                    set.insert((a.min(b), a.max(b)));
                }
            }
        }
        if !alone {
            cross(&mut pool, &set);
        }
        segments.push(set);
    }
    let chains = split(&pool, segments.iter().flatten().copied());
    let mut edges: HashMap<(u32, u32), Vec<(usize, u32)>> = HashMap::new();
    for facet in &facets {
        for (cycle, tags) in facet.loops.iter().zip(&facet.edges) {
            for k in 0..cycle.len() {
                if tags[k] == INNER {
                    continue;
                }
                let (a, b) = (cycle[k], cycle[(k + 1) % cycle.len()]);
                for pair in chain_of(&chains, a, b).windows(2) {
                    let list =
                        edges.entry((pair[0].min(pair[1]), pair[0].max(pair[1]))).or_default();
                    if !list.contains(&(facet.operand, tags[k])) {
                        list.push((facet.operand, tags[k]));
                    }
                }
            }
        }
    }
    let lines = if sharing { shared_lines(&mut pool, &facets, &cuts, &chains) } else { Vec::new() };
    let (found, mut changed, mut shared) =
        all_regions(&pool, &facets, &frames, &sheets, &members, &segments, &chains)?;
    shared.extend(lines);
    let turns = cells::windings(&pool, &facets, &frames, &sheets, &found)?;
    let kept: Vec<(usize, bool)> = (turns.iter().enumerate())
        .filter_map(|(r, [front, back])| {
            changed |= front.iter().chain(back).any(|w| !(0..=1).contains(w));
            match (solid(*front), solid(*back)) {
                (false, true) => Some((r, true)),
                (true, false) => Some((r, false)),
                _ => {
                    changed = true;
                    None
                }
            }
        })
        .collect();
    let ends = |a: u32, b: u32| {
        let own = edges.get(&(a.min(b), a.max(b)));
        own.is_some_and(|own| own.iter().any(|edge| seams.contains(edge)))
    };
    let faces = join(&pool, &facets, &frames, &sheets, &found, &kept, &ends);
    Ok(Arrangement { points: pool.points, given, faces, edges, changed, shared })
}

/// Numbers of the pool in place of those given; sides of no length are left out.
fn renumber(facet: &mut Facet, given: &[u32]) {
    for (cycle, tags) in facet.loops.iter_mut().zip(&mut facet.edges) {
        cycle.iter_mut().for_each(|v| *v = given[*v as usize]);
        let mut k = 0;
        while k < cycle.len() && cycle.len() > 1 {
            if cycle[k] == cycle[(k + 1) % cycle.len()] {
                cycle.remove(k);
                tags.remove(k);
            } else {
                k += 1;
            }
        }
    }
    let fine: Vec<bool> = facet.loops.iter().map(|c| c.len() >= 3).collect();
    let mut keep = fine.iter();
    facet.loops.retain(|_| *keep.next().unwrap_or(&false));
    let mut keep = fine.iter();
    facet.edges.retain(|_| *keep.next().unwrap_or(&false));
}

/// The lines in which more than two surfaces meet.
fn shared_lines(
    pool: &mut Pool,
    facets: &[Facet],
    cuts: &Cuts,
    chains: &Chains,
) -> Vec<SurfaceCoincidence> {
    let mut through: BTreeMap<(u32, u32), BTreeSet<(usize, u32)>> = BTreeMap::new();
    for (f, facet) in facets.iter().enumerate() {
        let cut = cuts.get(&f).into_iter().flatten().map(|[p, q]| [pool.add(*p), pool.add(*q)]);
        let cut: Vec<[u32; 2]> = cut.collect();
        for [a, b] in edges_of(facet).chain(cut).filter(|[a, b]| a != b) {
            for pair in chain_of(chains, a, b).windows(2) {
                let key = (pair[0].min(pair[1]), pair[0].max(pair[1]));
                through.entry(key).or_default().insert((facet.operand, facet.tag));
            }
        }
    }
    (through.into_iter().filter(|(_, sources)| sources.len() > 2))
        .map(|((a, b), sources)| SurfaceCoincidence {
            points: vec![a, b],
            sources: sources.into_iter().collect(),
            region: false,
        })
        .collect()
}

type Cuts = BTreeMap<usize, Vec<[Vec3; 2]>>;

/// Facets that are coplanar and touch (by the lowest of them), and the segments of intersection
/// with others.
fn meet(
    pool: &Pool,
    facets: &[Facet],
    frames: &[PlaneCoordinates],
    crossing: bool,
) -> (Vec<usize>, Cuts) {
    let boxes: Vec<[Vec3; 2]> = facets.iter().map(|f| f.bounds).collect();
    let mut sheet = UnionFind::new(facets.len());
    let mut cuts = Cuts::new();
    let wide = 4.0 * pool.tolerance;
    overlapping(&boxes, pool.tolerance, usize::MAX, |i, j| {
        let (a, b) = (&facets[i], &facets[j]);
        if a.operand == b.operand && !crossing {
            return;
        }
        let flat = |f: &Facet, frame: &PlaneCoordinates| {
            f.loops.iter().flatten().all(|&v| frame.height(pool.at(v)).abs() <= wide)
        };
        if flat(a, &frames[j]) && flat(b, &frames[i]) {
            sheet.join(i, j);
            return;
        }
        // Two triangles or convex quads of one surface meet in the edge they share and nowhere else.
        let side = |f: &Facet, frame: &PlaneCoordinates| {
            let heights = f.loops.iter().flatten().map(|&v| frame.height(pool.at(v)));
            let (low, high) = heights.fold((0.0f64, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
            low >= -pool.tolerance || high <= pool.tolerance
        };
        if a.operand == b.operand && side(a, &frames[j]) && side(b, &frames[i]) && shares(a, b) {
            return;
        }
        for [p, q] in common_segments(pool, [a, b], [&frames[i], &frames[j]]) {
            cuts.entry(i).or_default().push([p, q]);
            cuts.entry(j).or_default().push([p, q]);
        }
    });
    let sheet = (0..facets.len()).map(|k| sheet.find(k)).collect();
    (sheet, cuts)
}

fn shares(a: &Facet, b: &Facet) -> bool {
    edges_of(a).any(|[p, q]| edges_of(b).any(|e| e == [q, p]))
}

/// Adds the points at which segments of a plane cross inside both.
fn cross(pool: &mut Pool, set: &BTreeSet<(u32, u32)>) {
    let list: Vec<(u32, u32)> = set.iter().copied().collect();
    let boxes: Vec<[Vec3; 2]> =
        list.iter().map(|&(a, b)| bounds([pool.at(a), pool.at(b)].into_iter())).collect();
    let mut found = Vec::new();
    overlapping(&boxes, pool.tolerance, usize::MAX, |i, j| {
        let ((a, b), (c, d)) = (list[i], list[j]);
        if a == c || a == d || b == c || b == d {
            return;
        }
        let (p, r) = (pool.at(a), pool.at(c));
        let (d, e, w) = (pool.at(b) - p, pool.at(d) - r, p - r);
        let (dd, de, ee) = (d.norm_sq(), d.dot(e), e.norm_sq());
        let det = dd * ee - de * de;
        if det <= 1e-20 * dd * ee {
            return;
        }
        let t = (de * e.dot(w) - ee * d.dot(w)) / det;
        let u = (dd * e.dot(w) - de * d.dot(w)) / det;
        let (x, y) = (p + d * t, r + e * u);
        if (0.0..=1.0).contains(&t)
            && (0.0..=1.0).contains(&u)
            && x.distance(y) <= 4.0 * pool.tolerance
        {
            found.push(x);
        }
    });
    for x in found {
        pool.add(x);
    }
}

type Chains = HashMap<(u32, u32), Vec<u32>>;

/// Segments with other points on them, as chains of points.
fn split(pool: &Pool, segments: impl Iterator<Item = (u32, u32)>) -> Chains {
    let near = PointCells::new(&pool.points);
    let mut chains = Chains::new();
    for (a, b) in segments {
        if chains.contains_key(&(a, b)) {
            continue;
        }
        let (p, q) = (pool.at(a), pool.at(b));
        let margin = 2.0 * pool.tolerance;
        let wide = Vec3::new(margin, margin, margin);
        let [low, high] = bounds([p, q].into_iter());
        let d = q - p;
        let length = d.norm();
        let mut inner: Vec<(f64, u32)> = Vec::new();
        near.each([low - wide, high + wide], |v| {
            if v == a || v == b {
                return;
            }
            let x = pool.at(v);
            if (0..3).any(|k| x[k] < low[k] - margin || x[k] > high[k] + margin) {
                return;
            }
            let t = (x - p).dot(d) / length;
            if t > 0.0 && t < length && (p + d * (t / length)).distance(x) <= margin {
                inner.push((t, v));
            }
        });
        if !inner.is_empty() {
            inner.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            let chain = std::iter::once(a).chain(inner.into_iter().map(|i| i.1)).chain([b]);
            chains.insert((a, b), chain.collect());
        }
    }
    chains
}

fn chain_of(chains: &Chains, a: u32, b: u32) -> Vec<u32> {
    match chains.get(&(a.min(b), a.max(b))) {
        None => vec![a, b],
        Some(chain) if a < b => chain.clone(),
        Some(chain) => chain.iter().rev().copied().collect(),
    }
}

/// The regions of all sheets, whether facets cancel anywhere, and the regions covered by several
/// faces.
#[allow(clippy::type_complexity)]
fn all_regions(
    pool: &Pool,
    facets: &[Facet],
    frames: &[PlaneCoordinates],
    sheets: &[PlaneCoordinates],
    members: &[Vec<usize>],
    segments: &[BTreeSet<(u32, u32)>],
    chains: &Chains,
) -> Result<(Vec<ArrangedRegion>, bool, Vec<SurfaceCoincidence>), ArrangeError> {
    let (mut found, mut shared) = (Vec::new(), Vec::new());
    let mut other = false;
    for (s, own) in members.iter().enumerate() {
        let sheet = &sheets[s];
        let lonely = alone(facets, own, &segments[s], chains).filter(|ring| {
            let flat: Vec<[f64; 2]> = ring.iter().map(|&v| sheet.flat(pool.at(v))).collect();
            regions::area(&flat) > pool.tolerance * pool.tolerance
        });
        if let Some(ring) = lonely {
            let loops = vec![ring];
            let Some(inner) = regions::inner_point(pool, sheet, &loops) else { continue };
            let mut turns = [0; 2];
            turns[facets[own[0]].operand] = 1;
            let (inner, covers) = (sheet.lift(inner), own.clone());
            found.push(ArrangedRegion { sheet: s, loops, turns, inner, covers });
            continue;
        }
        let mut graph: BTreeSet<(u32, u32)> = BTreeSet::new();
        for &(a, b) in &segments[s] {
            for pair in chain_of(chains, a, b).windows(2) {
                graph.insert((pair[0].min(pair[1]), pair[0].max(pair[1])));
            }
        }
        for loops in regions::regions(pool, sheet, &graph) {
            let Some(inner) = regions::inner_point(pool, sheet, &loops) else { continue };
            let inner = sheet.lift(inner);
            let mut turns = [0; 2];
            let mut covers = Vec::new();
            for &f in own {
                let facet = &facets[f];
                let count = facet_winding(pool, facet, &frames[f], inner);
                if count != 0 {
                    let along = frames[f].normal.dot(sheet.normal) > 0.0;
                    turns[facet.operand] += if along { count } else { -count };
                    covers.push(f);
                    // Beyond its border a face has the opposite orientation, as below an
                    // overhanging boss.
                    other |= count < 0;
                }
            }
            let mut sources: Vec<(usize, u32)> =
                covers.iter().map(|&f| (facets[f].operand, facets[f].tag)).collect();
            sources.sort_unstable();
            sources.dedup();
            if sources.len() > 1 {
                shared.push(SurfaceCoincidence { points: loops.concat(), sources, region: true });
            }
            if turns == [0, 0] {
                other |= !covers.is_empty();
            } else {
                found.push(ArrangedRegion { sheet: s, loops, turns, inner, covers });
            }
        }
        if found.len() > MAX_REGIONS {
            return Err(ArrangeError::TooLarge);
        }
    }
    Ok((found, other, shared))
}

/// The border of a triangle that is alone in its sheet, which nothing divides: from the end of its lowest side.
fn alone(
    facets: &[Facet],
    own: &[usize],
    segments: &BTreeSet<(u32, u32)>,
    chains: &Chains,
) -> Option<Vec<u32>> {
    let [f] = own else { return None };
    let [ring] = &facets[*f].loops[..] else { return None };
    let n = ring.len();
    if n > 4 || segments.len() != n || segments.iter().any(|side| chains.contains_key(side)) {
        return None;
    }
    let &(a, b) = segments.first()?;
    let first = (0..n).find(|&k| {
        let side = (ring[k], ring[(k + 1) % n]);
        side == (a, b) || side == (b, a)
    })?;
    Some((0..n).map(|k| ring[(first + k) % n]).collect())
}

/// The common property of pieces that join.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum JoinKey {
    /// A face, and whether the side outward is its own.
    Face(usize, u32, bool),
    /// The side outward of a surface that several faces share.
    Shared(SurfaceSide),
    /// A plane, and whether the side outward is that of its normal.
    Plane(usize, bool),
}

/// Joins kept regions of one surface to faces, which end at sides that are on seams. `kept` are regions with whether
/// their outward side is that of their sheet's normal.
fn join(
    pool: &Pool,
    facets: &[Facet],
    frames: &[PlaneCoordinates],
    sheets: &[PlaneCoordinates],
    regions: &[ArrangedRegion],
    kept: &[(usize, bool)],
    ends: &dyn Fn(u32, u32) -> bool,
) -> Vec<ArrangedFace> {
    // Plane pieces join within their sheet, others within their face or the surface that it shares.
    let mut groups: BTreeMap<JoinKey, Vec<usize>> = BTreeMap::new();
    for (k, &(r, up)) in kept.iter().enumerate() {
        let leader = leader(facets, &regions[r]);
        let facet = &facets[leader];
        let along = frames[leader].normal.dot(sheets[regions[r].sheet].normal) > 0.0;
        let own = along == up;
        let key = match facet.side {
            _ if facet.plane => JoinKey::Plane(regions[r].sheet, up),
            Some(side) => JoinKey::Shared(SurfaceSide { positive: side.positive == own, ..side }),
            None => JoinKey::Face(facet.operand, facet.tag, own),
        };
        groups.entry(key).or_default().push(k);
    }
    let mut faces = Vec::new();
    for (key, own) in groups {
        let plane = matches!(key, JoinKey::Plane(..));
        // Half-edges of all pieces, oriented outward.
        let mut halves: Vec<(u32, u32, usize)> = Vec::new();
        let mut next: Vec<usize> = Vec::new();
        let mut pieces: Vec<Vec<Vec<u32>>> = Vec::new();
        for (piece, &k) in own.iter().enumerate() {
            let (r, up) = kept[k];
            let mut loops = regions[r].loops.clone();
            if !up {
                loops.iter_mut().for_each(|c| c.reverse());
            }
            for cycle in &loops {
                let (first, n) = (halves.len(), cycle.len());
                for i in 0..n {
                    halves.push((cycle[i], cycle[(i + 1) % n], piece));
                    next.push(first + (i + 1) % n);
                }
            }
            pieces.push(loops);
        }
        let mut at: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        halves.iter().enumerate().for_each(|(h, e)| at.entry((e.0, e.1)).or_default().push(h));
        let twin: Vec<Option<usize>> = halves
            .iter()
            .map(|&(a, b, _)| match (at[&(a, b)].as_slice(), at.get(&(b, a)).map(Vec::as_slice)) {
                ([_], Some([t])) if plane || !ends(a, b) => Some(*t),
                _ => None,
            })
            .collect();
        let mut part = UnionFind::new(pieces.len());
        for (h, t) in twin.iter().enumerate() {
            if let Some(t) = *t {
                part.join(halves[h].2, halves[t].2);
            }
        }
        let mut loops: BTreeMap<usize, Vec<Vec<u32>>> = BTreeMap::new();
        let mut used = vec![false; halves.len()];
        for start in 0..halves.len() {
            if used[start] || twin[start].is_some() {
                continue;
            }
            let (mut cycle, mut h) = (Vec::new(), start);
            while !used[h] {
                used[h] = true;
                cycle.push(halves[h].0);
                h = next[h];
                while let Some(t) = twin[h] {
                    h = next[t];
                }
            }
            loops.entry(part.find(halves[start].2)).or_default().push(cycle);
        }
        for (top, mut cycles) in loops {
            let members: Vec<usize> = (0..pieces.len()).filter(|&p| part.find(p) == top).collect();
            let mut sources: Vec<(usize, u32)> = Vec::new();
            for &p in &members {
                let region = &regions[kept[own[p]].0];
                let first = leader(facets, region);
                for &f in std::iter::once(&first).chain(&region.covers) {
                    let source = (facets[f].operand, facets[f].tag);
                    if !sources.contains(&source) {
                        sources.push(source);
                    }
                }
            }
            let (r, up) = kept[own[members[0]]];
            let sheet = &sheets[regions[r].sheet];
            let normal = if up { sheet.normal } else { -sheet.normal };
            let first = leader(facets, &regions[r]);
            let reversed = frames[first].normal.dot(normal) < 0.0;
            if plane {
                let frame = PlaneCoordinates::new(normal, sheet.origin);
                let size = |c: &Vec<u32>| {
                    regions::area(&c.iter().map(|&v| frame.flat(pool.at(v))).collect::<Vec<_>>())
                };
                cycles.sort_by(|a, b| size(b).total_cmp(&size(a)));
            }
            let parts = members.iter().map(|&p| pieces[p].clone()).collect();
            let owner = |&p: &usize| {
                let leader = &facets[leader(facets, &regions[kept[own[p]].0])];
                (leader.operand, leader.tag)
            };
            let owners = members.iter().map(owner).collect();
            let outward = |&p: &usize| {
                let (r, up) = kept[own[p]];
                let own = frames[leader(facets, &regions[r])].normal;
                let along = own.dot(sheets[regions[r].sheet].normal) > 0.0;
                if along == up { own } else { -own }
            };
            let normals = members.iter().map(outward).collect();
            faces.push(ArrangedFace {
                sources,
                reversed,
                plane,
                normal,
                loops: cycles,
                parts,
                owners,
                normals,
            });
        }
    }
    faces
}

/// The facet that gives a region its surface: of the first operand if there is one.
fn leader(facets: &[Facet], region: &ArrangedRegion) -> usize {
    let key = |f: &&usize| (facets[**f].operand, facets[**f].tag);
    region.covers.iter().min_by_key(key).copied().unwrap_or(0)
}
