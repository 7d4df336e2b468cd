//! Bodies of planes alone: their faces exactly, in the fewest triangles.
//!
//! `formula -> the part of every plane on which the body ends, by splitting polygons -> edges by intervals on lines -> loops ->
//! triangles`
//!
//! On a polygon of one plane the formula is reduced to what decides there. If both sides of the
//! plane are known, the polygon is a face or not; otherwise it is split by the plane nearest to its
//! own in the formula. A corner is the point of three planes, with the same bits from all of its
//! faces. Bodies with distances near rounding are left to cells.

use super::types::FacetOptions;
use super::{Facets, Grid, Memory, capped, info, own_leaves};
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF};
use crate::set::Membership;
use crate::set::body::SurfacedSet;
use crate::{FieldError, Form, Set};
use moldloft_mesh::{Mesh, TopologyBuilder, planar_triangles};
use moldloft_num::{Box3, Vec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance from a plane, relative to the box, of points on it.
const ON: f64 = 1e-11;
/// Distance relative to the box below which two planes cannot be distinguished over a polygon.
const NEAR: f64 = 1e-8;
/// Distance of corners, relative to the box, within which they coincide.
const ONE_POINT: f64 = 1e-10;
/// Distance of the probes beside each triangle that check whether it is a face of the body,
/// relative to the box.
const BESIDE: f64 = 2e-9;
/// Bodies of more planes than this are left to cells.
const MOST_PLANES: usize = 20_000;
/// Polygons that a body may be split into for each of its planes.
const MOST_POLYGONS: usize = 2_000;

enum PlaneFormula {
    /// The plane, and whether the side to which its normal points is solid.
    Side(u32, bool),
    /// A union, or else an intersection.
    Join(bool, Vec<Arc<PlaneFormula>>),
}

enum Pruned {
    Known(Membership),
    Open(Arc<PlaneFormula>),
}

#[derive(Clone, Copy)]
struct PlaneEquation {
    normal: Vec3,
    offset: f64,
}

impl PlaneEquation {
    fn at(&self, p: Vec3) -> f64 {
        self.normal.dot(p) + self.offset
    }
}

/// Corners, each with the plane along which the edge from it to the next one runs.
type PlanePolygon = Vec<(Vec3, u32)>;

/// The formula of a tape, whose leaves are planes.
fn formula(body: &SurfacedSet, tape: &ExprTape<f64>) -> Option<Arc<PlaneFormula>> {
    let mut made: Vec<Option<Arc<PlaneFormula>>> = Vec::with_capacity(tape.code.len());
    for (code, &leaf) in tape.code.iter().zip(&tape.leaf) {
        let join = |union: bool, a: u32, b: u32| {
            let mut parts = Vec::new();
            for k in [a, b] {
                let part = made[k as usize].clone()?;
                match &*part {
                    PlaneFormula::Join(own, inner) if *own == union => {
                        parts.extend(inner.iter().cloned());
                    }
                    _ => parts.push(part),
                }
            }
            Some(Arc::new(PlaneFormula::Join(union, parts)))
        };
        let node = match *code {
            _ if leaf != NO_LEAF => {
                let own = body.sides[leaf as usize];
                Some(Arc::new(PlaneFormula::Side(own.surface, own.flipped)))
            }
            ExprInstruction::Union(a, b) => join(true, a, b),
            ExprInstruction::Common(a, b) => join(false, a, b),
            _ => None,
        };
        made.push(node);
    }
    made.pop().flatten()
}

/// Splits the planes of a body.
struct PlaneSplitter {
    planes: Vec<PlaneEquation>,
    corners: FxHashMap<[u32; 3], Vec3>,
    on: f64,
    near: f64,
    /// True if some planes could not be distinguished.
    doubtful: bool,
}

impl PlaneSplitter {
    /// The point of three planes, the same in whatever order they are named.
    fn corner(&mut self, of: [u32; 3]) -> Vec3 {
        let mut key = of;
        key.sort_unstable();
        let planes = &self.planes;
        *self.corners.entry(key).or_insert_with(|| {
            let [p, q, r] = key.map(|k| planes[k as usize]);
            let qr = q.normal.cross(r.normal);
            let sum = qr * p.offset
                + r.normal.cross(p.normal) * q.offset
                + p.normal.cross(q.normal) * r.offset;
            sum / -p.normal.dot(qr)
        })
    }

    /// The formula as it is on a polygon of plane `own`, whose sides stay open.
    fn prune(&mut self, formula: &Arc<PlaneFormula>, own: u32, outline: &PlanePolygon) -> Pruned {
        match &**formula {
            PlaneFormula::Side(k, flipped) => {
                if *k == own {
                    return Pruned::Open(formula.clone());
                }
                let plane = self.planes[*k as usize];
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                for (p, _) in outline {
                    let value = plane.at(*p);
                    (low, high) = (low.min(value), high.max(value));
                }
                self.doubtful |= low >= -self.near && high <= self.near;
                let (low, high) = if *flipped { (-high, -low) } else { (low, high) };
                match () {
                    () if high <= self.on => Pruned::Known(Membership::Solid),
                    () if low >= -self.on => Pruned::Known(Membership::Air),
                    () => Pruned::Open(formula.clone()),
                }
            }
            PlaneFormula::Join(union, parts) => {
                let ends = if *union { Membership::Solid } else { Membership::Air };
                let mut kept = Vec::new();
                for part in parts {
                    match self.prune(part, own, outline) {
                        Pruned::Known(state) if state == ends => return Pruned::Known(ends),
                        Pruned::Known(_) => {}
                        Pruned::Open(rest) => kept.push(rest),
                    }
                }
                match kept.len() {
                    0 if *union => Pruned::Known(Membership::Air),
                    0 => Pruned::Known(Membership::Solid),
                    1 => Pruned::Open(kept.swap_remove(0)),
                    _ => Pruned::Open(Arc::new(PlaneFormula::Join(*union, kept))),
                }
            }
        }
    }

    /// Both parts of a polygon of plane `own`, behind plane `by` and before it.
    fn split(&mut self, own: u32, outline: &PlanePolygon, by: u32) -> [PlanePolygon; 2] {
        let plane = self.planes[by as usize];
        let values: Vec<f64> = outline.iter().map(|(p, _)| plane.at(*p)).collect();
        let mut out = [Vec::new(), Vec::new()];
        for (i, &(p, along)) in outline.iter().enumerate() {
            let j = (i + 1) % outline.len();
            for (side, part) in out.iter_mut().enumerate() {
                let [here, next] =
                    if side == 0 { [values[i], values[j]] } else { [-values[i], -values[j]] };
                let (inside, stays) = (here <= self.on, next <= self.on);
                let (on, ends_on) = (here.abs() <= self.on, next.abs() <= self.on);
                if inside && (!on || stays) {
                    part.push((p, along));
                }
                if on && !stays {
                    part.push((p, by));
                } else if inside != stays && !ends_on && !on {
                    let x = self.corner([own, along, by]);
                    part.push((x, if inside { by } else { along }));
                }
            }
        }
        out
    }
}

fn has(formula: &PlaneFormula, own: u32) -> bool {
    match formula {
        PlaneFormula::Side(k, _) => *k == own,
        PlaneFormula::Join(_, parts) => parts.iter().any(|p| has(p, own)),
    }
}

/// State of a formula on one side of plane `own`; surface if other planes decide.
fn state(formula: &PlaneFormula, own: u32, front: bool) -> Membership {
    match formula {
        PlaneFormula::Side(k, flipped) if *k == own => match front == *flipped {
            true => Membership::Solid,
            false => Membership::Air,
        },
        PlaneFormula::Side(..) => Membership::Surface,
        PlaneFormula::Join(union, parts) => {
            let states = parts.iter().map(|p| state(p, own, front));
            let found = if *union { states.min() } else { states.max() };
            found.unwrap_or(Membership::Surface)
        }
    }
}

/// The plane to split by: the nearest in the formula to a side of plane `own`.
fn nearest_plane(formula: &PlaneFormula, own: u32) -> Option<u32> {
    match formula {
        PlaneFormula::Side(k, _) => (*k != own).then_some(*k),
        PlaneFormula::Join(_, parts) => {
            let first = parts.iter().position(|p| has(p, own));
            let others = (0..parts.len()).filter(|k| Some(*k) != first);
            first.into_iter().chain(others).find_map(|k| nearest_plane(&parts[k], own))
        }
    }
}

/// A face of the body: its plane, whether the solid is behind it, and its edges as numbers of corners.
type PlaneFaces = BTreeMap<(u32, bool), Vec<[usize; 2]>>;
/// Starts and ends of edges on the line of a face with another plane: position, +1 or -1, and
/// corner.
type LineEnds = BTreeMap<(u32, bool, u32), Vec<(f64, i32, Vec3)>>;

/// The ends of all pieces of face on the lines of intersection of planes; `None` if some cannot be
/// distinguished.
fn line_ends(
    splitter: &mut PlaneSplitter,
    root: &Arc<PlaneFormula>,
    over: &Box3,
) -> Option<LineEnds> {
    let count = splitter.planes.len();
    let (centre, reach) = (over.centre(), 0.75 * over.diagonal());
    let mut ends = LineEnds::new();
    let mut polygons = 0;
    for own in 0..count as u32 {
        let plane = splitter.planes[own as usize];
        let away = plane.at(centre);
        if away.abs() > reach {
            continue;
        }
        let u = plane.normal.perpendicular().normalized()?;
        let v = plane.normal.cross(u);
        let middle = centre - plane.normal * away;
        splitter.planes.truncate(count);
        let mut outline = PlanePolygon::new();
        // A square that reaches beyond the box, with helping planes for its sides.
        let corners: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        for [i, j] in corners {
            let corner = middle + u * (i * reach) + v * (j * reach);
            let normal = if i * j > 0.0 { v * j } else { u * i };
            splitter.planes.push(PlaneEquation { normal, offset: -normal.dot(corner) });
            outline.push((corner, splitter.planes.len() as u32 - 1));
        }
        splitter.corners.retain(|key, _| (key[2] as usize) < count);
        let mut open = vec![(outline, root.clone())];
        while let Some((outline, rest)) = open.pop() {
            polygons += 1;
            if splitter.doubtful || polygons > MOST_POLYGONS * count {
                return None;
            }
            let Pruned::Open(rest) = splitter.prune(&rest, own, &outline) else { continue };
            if !has(&rest, own) {
                continue;
            }
            let [behind, front] = [false, true].map(|front| state(&rest, own, front));
            if behind == Membership::Surface || front == Membership::Surface {
                let by = nearest_plane(&rest, own)?;
                let halves = splitter.split(own, &outline, by);
                open.extend(halves.into_iter().filter(|h| h.len() > 2).map(|h| (h, rest.clone())));
                continue;
            }
            if behind == front {
                continue;
            }
            for (i, &(a, along)) in outline.iter().enumerate() {
                let b = outline[(i + 1) % outline.len()].0;
                let direction = plane.normal.cross(splitter.planes[along as usize].normal);
                let list = ends.entry((own, behind == Membership::Solid, along)).or_default();
                let (from, to) = (direction.dot(a), direction.dot(b));
                let sign = if from < to { 1 } else { -1 };
                let [low, high] =
                    if from < to { [(from, a), (to, b)] } else { [(to, b), (from, a)] };
                list.extend([(low.0, sign, low.1), (high.0, -sign, high.1)]);
            }
        }
    }
    (!splitter.doubtful).then_some(ends)
}

/// Corners, those within rounding of each other once.
struct CornerIndex {
    cell: f64,
    points: Vec<Vec3>,
    bins: FxHashMap<[i64; 3], Vec<usize>>,
}

impl CornerIndex {
    fn number(&mut self, p: Vec3) -> usize {
        let bin = p.to_array().map(|x| (x / self.cell).floor() as i64);
        for k in 0..27 {
            let beside = [bin[0] + k % 3 - 1, bin[1] + k / 3 % 3 - 1, bin[2] + k / 9 - 1];
            let known = self.bins.get(&beside).into_iter().flatten();
            let mut near = known.filter(|j| self.points[**j].distance(p) <= self.cell);
            if let Some(found) = near.next() {
                return *found;
            }
        }
        self.points.push(p);
        self.bins.entry(bin).or_default().push(self.points.len() - 1);
        self.points.len() - 1
    }
}

/// Edges of all faces, split at every corner on them.
fn faces_of(ends: LineEnds, size: f64) -> (Vec<Vec3>, PlaneFaces) {
    let mut index =
        CornerIndex { cell: ONE_POINT * size, points: Vec::new(), bins: FxHashMap::default() };
    let mut edges: Vec<((u32, bool), [usize; 2])> = Vec::new();
    for ((own, behind, _), mut list) in ends {
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut sum, mut from) = (0, Vec3::zero());
        let mut k = 0;
        while k < list.len() {
            let (place, point) = (list[k].0, list[k].2);
            let before = sum;
            while k < list.len() && list[k].0 - place <= ONE_POINT * size {
                sum += list[k].1;
                k += 1;
            }
            if sum == before {
                continue;
            }
            if before != 0 {
                let [a, b] = [from, point].map(|p| index.number(p));
                if a != b {
                    edges.push(((own, behind), if before > 0 { [a, b] } else { [b, a] }));
                }
            }
            from = point;
        }
    }
    let points = index.points;
    let mut by_x: Vec<usize> = (0..points.len()).collect();
    by_x.sort_by(|a, b| points[*a].x.total_cmp(&points[*b].x));
    let near = ONE_POINT * size;
    let mut faces = PlaneFaces::new();
    for (face, [a, b]) in edges {
        let (p, along) = (points[a], points[b] - points[a]);
        let square = along.norm_sq();
        let (low, high) = (p.x.min(points[b].x) - near, p.x.max(points[b].x) + near);
        let first = by_x.partition_point(|k| points[*k].x < low);
        let within = by_x[first..].iter().take_while(|k| points[**k].x <= high);
        let mut inner: Vec<(f64, usize)> = within
            .filter(|k| **k != a && **k != b)
            .filter_map(|&k| {
                let to = points[k] - p;
                let share = to.dot(along) / square;
                let beside = (to - along * share).norm() <= near;
                (beside && share > 0.0 && share < 1.0).then_some((share, k))
            })
            .collect();
        inner.sort_by(|a, b| a.0.total_cmp(&b.0));
        let list = faces.entry(face).or_default();
        let mut from = a;
        for k in inner.into_iter().map(|x| x.1).chain([b]) {
            list.push([from, k]);
            from = k;
        }
    }
    (points, faces)
}

/// Closed loops of a face's edges; at a corner with several edges, the one that turns inward most
/// continues.
fn loops_of(edges: &[[usize; 2]], flat: &dyn Fn(usize) -> [f64; 2]) -> Option<Vec<Vec<usize>>> {
    let mut next: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for [a, b] in edges {
        next.entry(*a).or_default().push(*b);
    }
    let mut loops = Vec::new();
    for [start, _] in edges {
        let mut line: Vec<usize> = Vec::new();
        let mut at = *start;
        while let Some(list) = next.get_mut(&at) {
            if list.is_empty() {
                break;
            }
            let turn = |to: usize| {
                let Some(&before) = line.last() else { return 0.0 };
                let ([x, y], [px, py], [qx, qy]) = (flat(at), flat(before), flat(to));
                let (a, b) = ([px - x, py - y], [qx - x, qy - y]);
                let angle = libm::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
                angle.rem_euclid(std::f64::consts::TAU)
            };
            let best = (0..list.len()).max_by(|i, j| turn(list[*i]).total_cmp(&turn(list[*j])))?;
            let to = list.swap_remove(best);
            line.push(at);
            at = to;
            if at == *start {
                break;
            }
        }
        if line.is_empty() {
            continue;
        }
        if line.len() < 3 || at != *start {
            return None;
        }
        loops.push(line);
    }
    Some(loops)
}

fn area(line: &[usize], flat: &dyn Fn(usize) -> [f64; 2]) -> f64 {
    let [ox, oy] = flat(line[0]);
    let corner = |k: usize| {
        let [x, y] = flat(line[k % line.len()]);
        [x - ox, y - oy]
    };
    let twice = |k: usize| {
        let ([a, b], [c, d]) = (corner(k), corner(k + 1));
        a * d - b * c
    };
    0.5 * (0..line.len()).map(twice).sum::<f64>()
}

fn holds(line: &[usize], flat: &dyn Fn(usize) -> [f64; 2], [x, y]: [f64; 2]) -> bool {
    let crosses = |k: &usize| {
        let ([a, b], [c, d]) = (flat(line[*k]), flat(line[(k + 1) % line.len()]));
        (b > y) != (d > y) && x < a + (y - b) / (d - b) * (c - a)
    };
    (0..line.len()).filter(crosses).count() % 2 == 1
}

/// The triangles of a face, counter-clockwise about its plane's normal.
fn triangles_of(
    plane: &PlaneEquation,
    edges: &[[usize; 2]],
    points: &[Vec3],
) -> Option<Vec<[usize; 3]>> {
    let u = plane.normal.perpendicular().normalized()?;
    let v = plane.normal.cross(u);
    let flat = |k: usize| [points[k].dot(u), points[k].dot(v)];
    let loops = loops_of(edges, &flat)?;
    let (outer, holes): (Vec<_>, Vec<_>) = loops.into_iter().partition(|l| area(l, &flat) > 0.0);
    let mut groups: Vec<Vec<Vec<usize>>> = outer.into_iter().map(|l| vec![l]).collect();
    for hole in holes {
        // A point just inside the solid beside the hole is as good; a corner may be on a
        // surrounding loop.
        let [[a, b], [c, d]] = [flat(hole[0]), flat(hole[1])];
        let middle = [0.5 * (a + c), 0.5 * (b + d)];
        let round = (0..groups.len()).filter(|g| holds(&groups[*g][0], &flat, middle));
        let size = |g: &usize| area(&groups[*g][0], &flat);
        let own = round.min_by(|a, b| size(a).total_cmp(&size(b)))?;
        groups[own].push(hole);
    }
    let mut out = Vec::new();
    for group in groups {
        let mut number: BTreeMap<usize, usize> = BTreeMap::new();
        let mut corners: Vec<usize> = Vec::new();
        let local: Vec<Vec<usize>> = group
            .iter()
            .map(|line| {
                let each = line.iter().map(|&k| {
                    *number.entry(k).or_insert_with(|| {
                        corners.push(k);
                        corners.len() - 1
                    })
                });
                each.collect()
            })
            .collect();
        let places: Vec<[f64; 2]> = corners.iter().map(|&k| flat(k)).collect();
        out.extend(
            planar_triangles(&places, &local, &[]).into_iter().map(|t| t.map(|k| corners[k])),
        );
    }
    Some(out)
}

/// True if every edge has one triangle on each side, and the triangles at each corner are
/// connected.
fn is_manifold(triangles: &[(u32, [usize; 3])], corners: usize) -> bool {
    let mut sides: FxHashMap<[usize; 2], usize> = FxHashMap::default();
    let mut round = vec![0usize; corners];
    for (t, (_, c)) in triangles.iter().enumerate() {
        for k in 0..3 {
            round[c[k]] += 1;
            if sides.insert([c[k], c[(k + 1) % 3]], t).is_some() {
                return false;
            }
        }
    }
    if !sides.keys().all(|[a, b]| sides.contains_key(&[*b, *a])) {
        return false;
    }
    // Once round every corner.
    let mut seen = vec![false; corners];
    triangles.iter().all(|(_, c)| {
        c.iter().all(|&corner| {
            if std::mem::replace(&mut seen[corner], true) {
                return true;
            }
            let (mut count, mut at) = (0, *c);
            loop {
                let k = at.iter().position(|x| *x == corner).unwrap_or(0);
                count += 1;
                let next = triangles[sides[&[corner, at[(k + 2) % 3]]]].1;
                if next == *c || count > round[corner] {
                    break;
                }
                at = next;
            }
            count == round[corner]
        })
    })
}

/// True if the body is solid behind every triangle and air in front of it.
fn are_faces(set: &Set, triangles: &[(u32, [usize; 3])], points: &[Vec3], size: f64) -> bool {
    let mut beside = Vec::with_capacity(2 * triangles.len());
    for (_, c) in triangles {
        let [a, b, c] = c.map(|k| points[k]);
        let Some(normal) = (b - a).cross(c - a).normalized() else { return false };
        let centre = (a + b + c) / 3.0;
        beside.extend([-1.0, 1.0].map(|side| centre + normal * (side * BESIDE * size)));
    }
    let mut values = vec![0.0; beside.len()];
    set.values(&beside, &mut values);
    values.chunks(2).all(|pair| pair[0] < 0.0 && pair[1] > 0.0)
}

/// The leaves that say where a corner is: three whose planes meet in a point, where there are.
fn independent(on: &[u32], normal: impl Fn(u32) -> Vec3) -> SmallVec<[u32; 3]> {
    let mut out: SmallVec<[u32; 3]> = SmallVec::new();
    for &leaf in on {
        let n = normal(leaf);
        let new = match out[..] {
            [] => true,
            [a] => normal(a).cross(n).norm() > 1e-6,
            [a, b] => normal(a).cross(normal(b)).dot(n).abs() > 1e-6,
            _ => false,
        };
        if new {
            out.push(leaf);
        }
    }
    out
}

/// The facets of a set of planes within a box; `None` for other sets, for contacts along edges, and
/// for distances at which rounding decides.
pub(super) fn facets(
    set: &Set,
    over: &Box3,
    options: &FacetOptions,
) -> Result<Option<Facets>, FieldError> {
    let own = set.leaves();
    let planes = |p: &crate::Primitive| matches!(p.form(), Form::Plane(_)) && !p.is_sheet();
    if own.is_empty() || own.len() > MOST_PLANES || !own.iter().all(|l| planes(&l.primitive)) {
        return Ok(None);
    }
    let capped = capped(set, over)?;
    let body = capped.as_body();
    let plane_of = |p: &crate::Primitive| match p.form() {
        Form::Plane(q) => Some(PlaneEquation { normal: q.normal, offset: -q.normal.dot(q.point) }),
        _ => None,
    };
    let Some(all) = body.surfaces.iter().map(plane_of).collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let Some(root) = formula(&body, &body.compiled.tape) else { return Ok(None) };
    let size = over.diagonal();
    let mut splitter = PlaneSplitter {
        planes: all,
        corners: FxHashMap::default(),
        on: ON * size,
        near: NEAR * size,
        doubtful: false,
    };
    let Some(ends) = line_ends(&mut splitter, &root, over) else { return Ok(None) };
    options.budget.poll()?;
    let (points, faces) = faces_of(ends, size);
    // The first leaf of each surface and side: the set's own before the box's.
    let mut leaf_of: FxHashMap<(u32, bool), u32> = FxHashMap::default();
    for (k, side) in body.sides.iter().enumerate() {
        leaf_of.entry((side.surface, !side.flipped)).or_insert(k as u32);
    }
    let mut triangles: Vec<(u32, [usize; 3])> = Vec::new();
    for ((plane, behind), edges) in &faces {
        let known = leaf_of.get(&(*plane, *behind)).or_else(|| leaf_of.get(&(*plane, !*behind)));
        let made = triangles_of(&splitter.planes[*plane as usize], edges, &points);
        let (Some(&leaf), Some(made)) = (known, made) else { return Ok(None) };
        let turned = |[a, b, c]: [usize; 3]| if *behind { [a, b, c] } else { [a, c, b] };
        triangles.extend(made.into_iter().map(|t| (leaf, turned(t))));
    }
    if !is_manifold(&triangles, points.len()) || !are_faces(&capped, &triangles, &points, size) {
        return Ok(None);
    }
    finished(&body, over, &points, triangles, options).map(Some)
}

fn finished(
    body: &SurfacedSet,
    over: &Box3,
    points: &[Vec3],
    mut triangles: Vec<(u32, [usize; 3])>,
    options: &FacetOptions,
) -> Result<Facets, FieldError> {
    let leaves = body.compiled.leaves.clone();
    triangles.sort_by_key(|t| t.0);
    let broken = |_| FieldError::TooFine { boxes: triangles.len() as f64, limit: options.limit };
    let mut on: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    for (leaf, corners) in &triangles {
        for &k in corners {
            if !on[k].contains(leaf) {
                on[k].push(*leaf);
            }
        }
    }
    let normal = |leaf: u32| match leaves[leaf as usize].primitive.form() {
        Form::Plane(p) => p.normal,
        _ => Vec3::zero(),
    };
    // Unused corners are left out.
    let mut number = vec![0u32; points.len()];
    let (mut positions, mut surfaces) = (Vec::new(), Vec::new());
    for (k, own) in on.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
        number[k] = positions.len() as u32;
        positions.push(points[k]);
        surfaces.push(independent(own, normal));
    }
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(positions.len()).map_err(broken)?;
    let mut patch_leaves = Vec::new();
    for run in triangles.chunk_by(|a, b| a.0 == b.0) {
        let leaf = run[0].0 as usize;
        let face = |t: &(u32, [usize; 3])| {
            let [a, b, c] = t.1.map(|k| number[k]);
            [a, b, c, c]
        };
        patch_leaves.push(leaf);
        builder
            .add_faces(info(&leaves[leaf]), run.iter().map(face).collect::<Vec<_>>())
            .map_err(broken)?;
    }
    let mesh = Mesh::new(builder.build().into(), positions).map_err(broken)?;
    let side = super::shortest(over).1;
    let points = mesh.positions();
    let edges = mesh.faces().iter().flat_map(|f| [0, 1, 2].map(|k| [f[k], f[(k + 1) % 3]]));
    let step =
        edges.map(|[a, b]| points[a as usize].distance(points[b as usize])).fold(side, f64::min);
    Ok(Facets {
        mesh,
        own_leaves: own_leaves(&body.compiled),
        leaves,
        patch_leaves,
        surfaces,
        undecided: Vec::new(),
        blunt: Vec::new(),
        unresolved: Vec::new(),
        contacts: Vec::new(),
        about: over.centre(),
        cells: 0,
        step,
        blocks: 0,
        computed: 0,
        memory: Memory { grid: Grid::new(over, side)?, blocks: Arc::default() },
    })
}
