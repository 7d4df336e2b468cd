//! Bodies that only touch: each is meshed separately, so that both stay manifold and the contact
//! needs no fine cells.
//!
//! `operands of a union -> pairs that may meet -> share volume | touch | are apart -> bodies`
//!
//! The box is halved where two operands may be solid; operands with a solid point in common are one body. Of the pairs
//! that are left, certified integrals tell which share volume after all, and where those that do not are in contact.

use super::crossing::crossing_faces;
use super::{Facets, Memory, at_step, capped, info, own_leaves};
use crate::expr::interval::{Interval, sides};
use crate::expr::tape::ExprTape;
use crate::measure::certified::{Effort, certified};
use crate::set::Leaf;
use crate::{FacetOptions, FieldError, Primitive, Set};
use moldloft_budget::Budget;
use moldloft_mesh::{Mesh, TopologyBuilder};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Box3, Vec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A union of more sets than this is taken as one.
const MOST: usize = 1000;
/// The box is halved this often in the search for pairs, …
const DEPTH: u32 = 5;
/// … in at most this many parts.
const PARTS: usize = 20_000;
/// With more pairs that may touch, contact is not proved.
const PAIRS: usize = 400;
/// The cells by which it is proved that two sets share no volume.
const CELLS: usize = 3000;
/// Maximum number of points at which the contact of two sets is examined.
const PLACES: usize = 64;
/// Maximum number of steps to a common point, and its accuracy relative to the box.
const STEPS: usize = 100;
const SAME: f64 = 1e-10;
/// Points round a common one that are on both surfaces show a shared face if they are not on one line: their
/// parallelogram is this part of the square of the radius.
const AROUND: usize = 64;
const WIDE: f64 = 0.1;
/// Bound, relative to the box, below which sets without a common point on their surfaces are proved
/// to share no volume.
const SHARED: f64 = 1e-9;
/// Triangles that are through others by this part of a cell are on them, to rounding.
const TOUCH: f64 = 1e-9;
/// Number of rounds of withdrawal, and the fraction of the box per round.
const ROUNDS: usize = 6;
const BACK: f64 = 1e-13;
/// The sine of the angle between surfaces below which they touch, and do not cross.
const TANGENT: f64 = 0.05;

/// The operands of a chain of unions, or of intersections, each with the attributes that reach it.
fn operands(set: &Set, union: bool) -> Vec<Set> {
    let mut out = Vec::new();
    let mut stack = vec![set.clone()];
    while let Some(set) = stack.pop() {
        if set.operands().len() == 2 && set.is_union() == union {
            let outer = set.attributes().cloned();
            for o in set.operands().iter().rev() {
                stack.push(match &outer {
                    Some(a) => o.within(a.clone()),
                    None => o.clone(),
                });
            }
        } else {
            out.push(set);
        }
    }
    out
}

/// A set as an intersection, one of whose factors is a union: a view of it as a union.
struct UnionView {
    factors: Vec<Set>,
    /// Index of the factor that is the union.
    at: usize,
    parts: Vec<Set>,
}

impl UnionView {
    fn all(set: &Set) -> Vec<Self> {
        let factors = match set.is_union() {
            true => vec![set.clone()],
            false => operands(set, false),
        };
        let unions = (0..factors.len()).filter(|&k| factors[k].is_union());
        let view = |at: usize| {
            let parts = operands(&factors[at], true);
            Self { factors: factors.clone(), at, parts }
        };
        unions.map(view).filter(|v| (2..=MOST).contains(&v.parts.len())).collect()
    }

    /// The set with one part of the union, or several, instead of the union.
    fn with(&self, part: Set) -> Set {
        let mut part = Some(part);
        let factor = |(k, f): (usize, &Set)| match k == self.at {
            true => part.take().unwrap_or_else(Set::nothing),
            false => f.clone(),
        };
        let all = self.factors.iter().enumerate().map(factor);
        all.reduce(|a, b| a & b).unwrap_or_else(Set::nothing)
    }
}

/// A part of the box with the sets that may be solid in it.
type SearchPart = ([Interval; 3], Vec<(usize, Arc<ExprTape<f64>>)>, u32);

fn halves(sides: &[Interval; 3]) -> impl Iterator<Item = [Interval; 3]> + '_ {
    (0..8).map(|c| {
        [0, 1, 2].map(|k| {
            let middle = sides[k].middle();
            match c >> k & 1 {
                0 => Interval { low: sides[k].low, high: middle },
                _ => Interval { low: middle, high: sides[k].high },
            }
        })
    })
}

/// Joins sets that have solid points in common, and gives the pairs of others that may meet.
fn pairs(
    sets: &[Set],
    over: &Box3,
    groups: &mut UnionFind,
    budget: &Budget,
) -> Result<Vec<[usize; 2]>, FieldError> {
    let tapes = sets.iter().map(|s| s.compiled().tape).enumerate().collect();
    let mut found = BTreeSet::new();
    let mut ranges = Vec::new();
    let mut front: Vec<SearchPart> = vec![(sides(over), tapes, 0)];
    let mut count = 0;
    while !front.is_empty() {
        let mut next: Vec<SearchPart> = Vec::new();
        for (place, sets, depth) in front {
            budget.poll()?;
            count += 1;
            let mut here = Vec::new();
            for (k, tape) in sets {
                if tape.range(&place, &mut ranges).low <= 0.0 {
                    let pruned = tape.pruned(&ranges);
                    here.push((k, pruned.map_or(tape, Arc::new)));
                }
            }
            let several = |groups: &mut UnionFind| {
                here.iter().any(|(k, _)| groups.find(*k) != groups.find(here[0].0))
            };
            if here.len() < 2 || !several(groups) {
                continue;
            }
            let middle = place.map(|s| Interval::point(s.middle()));
            let solid = here.iter().filter(|(_, t)| t.range(&middle, &mut ranges).high < 0.0);
            let solid: Vec<usize> = solid.map(|(k, _)| *k).collect();
            solid.windows(2).for_each(|w| groups.join(w[0], w[1]));
            if !several(groups) {
                continue;
            }
            if depth < DEPTH && count + next.len() < PARTS {
                next.extend(halves(&place).map(|half| (half, here.clone(), depth + 1)));
                continue;
            }
            for (n, (i, _)) in here.iter().enumerate() {
                for (j, _) in &here[n + 1..] {
                    if groups.find(*i) != groups.find(*j) {
                        found.insert([*i.min(j), *i.max(j)]);
                    }
                }
            }
        }
        front = next;
    }
    Ok(found.into_iter().collect())
}

/// Parts of the box in which two sets may have a common point; none if they are proved to be apart.
fn common_places(both: &Set, over: &Box3) -> Vec<Vec3> {
    let mut ranges = Vec::new();
    let mut front = vec![(sides(over), both.compiled().tape)];
    let mut left = CELLS;
    while !front.is_empty() && 8 * front.len() <= left {
        left -= 8 * front.len();
        let mut next = Vec::new();
        for (place, tape) in &front {
            for half in halves(place) {
                if tape.range(&half, &mut ranges).low <= 0.0 {
                    next.push((half, tape.pruned(&ranges).map_or_else(|| tape.clone(), Arc::new)));
                }
            }
        }
        front = next;
    }
    front.into_iter().map(|(place, _)| Vec3::from(place.map(|s| s.middle()))).collect()
}

/// A set with its evaluators at points.
struct SetSurface {
    tape: Arc<ExprTape<f64>>,
    leaves: Vec<Leaf>,
}

impl SetSurface {
    fn of(set: &Set) -> Self {
        let compiled = set.compiled();
        Self { tape: compiled.tape, leaves: compiled.leaves }
    }

    /// The distance, to first order, and the normal of the leaf that decides at a point.
    fn height(&self, p: Vec3) -> Option<(f64, Vec3)> {
        let leaf = self.tape.winners(&[p], &mut Vec::new())[0] as usize;
        let g = self.leaves.get(leaf)?.primitive.gradient(p);
        let size = g.slope.norm();
        (size > 0.0).then(|| (g.value / size, g.slope / size))
    }
}

/// A common point of two surfaces, near a given one: Gauss-Newton steps of least norm on the
/// deciding leaves. At a tangential contact each step halves the distance.
fn common_point(a: &SetSurface, b: &SetSurface, start: Vec3, size: f64) -> Option<Vec3> {
    let mut p = start;
    for _ in 0..STEPS {
        let ((f, m), (g, n)) = (a.height(p)?, b.height(p)?);
        if f.abs().max(g.abs()) <= SAME * size {
            return Some(p);
        }
        let c = m.dot(n);
        let det = 1.0 - c * c;
        let step = match det > 1e-14 {
            true => m * ((f - c * g) / det) + n * ((g - c * f) / det),
            false => m * (0.5 * (f + c.signum() * g)),
        };
        let most = 0.1 * size / step.norm().max(0.1 * size);
        p -= step * most;
    }
    None
}

/// True if there is an interior point of both sets near a point on their surfaces.
fn overlap(a: &SetSurface, b: &SetSurface, p: Vec3, size: f64) -> bool {
    let (Some((_, m)), Some((_, n))) = (a.height(p), b.height(p)) else { return false };
    // Near a tangential contact the intersection is a lens; inward is across its rim.
    let Some(inward) = ((m + n) * -1.0).normalized() else { return false };
    [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].into_iter().any(|reach| {
        let q = p + inward * (reach * size);
        let inside = |s: &SetSurface| s.height(q).is_some_and(|h| h.0 < -SAME * size);
        inside(a) && inside(b)
    })
}

/// True if two surfaces that meet at a point share a piece of surface there, not only a line or the
/// point.
fn share_face(a: &SetSurface, b: &SetSurface, p: Vec3, size: f64) -> bool {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    [2e-2, 1e-3].into_iter().any(|part| {
        let reach = part * size;
        let near = |k: usize| {
            let z = 1.0 - (2 * k + 1) as f64 / AROUND as f64;
            let (s, c) = libm::sincos(golden * k as f64);
            let r = (1.0 - z * z).sqrt();
            let mut q = p + Vec3::of(r * c, r * s, z) * reach;
            for _ in 0..4 {
                let (f, m) = a.height(q)?;
                q -= m * f;
            }
            let on = |s: &SetSurface| s.height(q).is_some_and(|h| h.0.abs() <= SAME * size);
            (on(a) && on(b)).then_some(q - p)
        };
        let shared: Vec<Vec3> = (0..AROUND).filter_map(near).collect();
        let first = shared.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
        first.is_some_and(|d| shared.iter().any(|e| d.cross(*e).norm() > WIDE * reach * reach))
    })
}

/// Sets without common volume, and their contacts.
pub(super) struct Parted {
    pub(super) sets: Vec<Set>,
    pub(super) contacts: Vec<Vec3>,
    /// False when surfaces cross at a contact, as those of a symmetric difference do.
    tangent: bool,
}

/// The bodies of a set that touch others in points or lines; `None` for a single body, or without
/// contact.
pub(super) fn parted(
    set: &Set,
    over: &Box3,
    budget: &Budget,
) -> Result<Option<Parted>, FieldError> {
    for view in UnionView::all(set) {
        if let Some(found) = parted_by(&view, over, budget)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

fn parted_by(view: &UnionView, over: &Box3, budget: &Budget) -> Result<Option<Parted>, FieldError> {
    let bodies: Vec<Set> = view.parts.iter().map(|p| view.with(p.clone())).collect();
    let mut groups = UnionFind::new(bodies.len());
    let pairs = pairs(&bodies, over, &mut groups, budget)?;
    if pairs.is_empty() || pairs.len() > PAIRS {
        return Ok(None);
    }
    let side = |k: usize| over.high[k] - over.low[k];
    let (volume, size) = ((0..3).map(side).product::<f64>(), (0..3).map(side).fold(0.0, f64::max));
    let mut contacts = Vec::new();
    for [i, j] in pairs {
        if groups.find(i) == groups.find(j) {
            continue;
        }
        let both = &bodies[i] & &bodies[j];
        let places = common_places(&both, over);
        if places.is_empty() {
            continue;
        }
        let (a, b) = (SetSurface::of(&bodies[i]), SetSurface::of(&bodies[j]));
        let some = places.iter().step_by(places.len().div_ceil(PLACES));
        let points = some.filter_map(|p| common_point(&a, &b, *p, size));
        let points: Vec<Vec3> = points.collect();
        let meets = |p: &Vec3| overlap(&a, &b, *p, size) || share_face(&a, &b, *p, size);
        if points.iter().any(meets) {
            groups.join(i, j);
            continue;
        }
        let shared = certified(&both, over, &Effort::of_cells(CELLS), budget)?.bracket.volume();
        // A line of contact leaves more open than a point does; without a point in common there is no reason to.
        let open = points.is_empty() && shared.high > SHARED * volume;
        match points.first() {
            _ if shared.low > 0.0 || open => groups.join(i, j),
            Some(p) => contacts.push((i, j, *p)),
            None => {}
        }
    }
    contacts.retain(|&(i, j, _)| groups.find(i) != groups.find(j));
    if contacts.is_empty() {
        return Ok(None);
    }
    let tangent = contacts.iter().all(|&(i, j, p)| tangent(&bodies[i], &bodies[j], p));
    let mut members: Vec<Vec<Set>> = vec![Vec::new(); bodies.len()];
    for (k, part) in view.parts.iter().enumerate() {
        members[groups.find(k)].push(part.clone());
    }
    let sets = members.into_iter().filter_map(|own| own.into_iter().reduce(|a, b| a | b));
    let sets = sets.map(|part| view.with(part)).collect();
    Ok(Some(Parted { sets, contacts: contacts.into_iter().map(|c| c.2).collect(), tangent }))
}

/// True if the surfaces of two sets have nearly the same tangent plane at a common point.
fn tangent(a: &Set, b: &Set, p: Vec3) -> bool {
    let normal = |set| SetSurface::of(set).height(p).map(|h| h.1);
    let (Some(m), Some(n)) = (normal(a), normal(b)) else { return false };
    m.cross(n).norm() <= TANGENT
}

/// Maximum penetration of one of two triangles through the plane of the other.
fn depth(mesh: &Mesh, pair: [usize; 2]) -> f64 {
    let [s, t] = pair.map(|face| {
        let corners = mesh.faces()[face];
        [0, 1, 2].map(|k| mesh.positions()[corners[k] as usize])
    });
    let through = |s: [Vec3; 3], t: [Vec3; 3]| {
        let normal = (t[1] - t[0]).cross(t[2] - t[0]);
        let heights = s.map(|p| (p - t[0]).dot(normal) / normal.norm().max(f64::MIN_POSITIVE));
        let above = heights.into_iter().fold(0.0, f64::max);
        let below = heights.into_iter().fold(0.0, |low: f64, h| low.max(-h));
        above.min(below)
    };
    through(s, t).min(through(t, s))
}

/// Retracts faces of bodies that share an edge and penetrate each other by rounding: corners are
/// moved into their bodies from planes of others, by less than the accuracy of vertices.
fn withdrawn(
    mesh: &Mesh,
    pairs: &[[usize; 2]],
    over: &Box3,
    step: f64,
) -> Result<Mesh, moldloft_mesh::MeshError> {
    let corners = |face: usize| mesh.faces()[face];
    let normal = |face: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.positions()[corners(face)[k] as usize]);
        ((b - a).cross(c - a), a)
    };
    let mut moved: BTreeSet<u32> = BTreeSet::new();
    for [s, t] in pairs.iter().flat_map(|&[s, t]| [[s, t], [t, s]]) {
        let (n, at) = normal(t);
        let near = |v: &u32| {
            let height = (mesh.positions()[*v as usize] - at).dot(n) / n.norm();
            height.abs() <= TOUCH * step
        };
        moved.extend(corners(s)[..3].iter().copied().filter(near));
    }
    let mut outward: FxHashMap<u32, Vec3> = FxHashMap::default();
    for (face, corners) in mesh.faces().iter().enumerate() {
        for v in corners[..3].iter().filter(|v| moved.contains(v)) {
            let sum = outward.entry(*v).or_default();
            *sum += normal(face).0.normalized().unwrap_or_default();
        }
    }
    let size = (0..3).map(|k| over.high[k] - over.low[k]).fold(0.0, f64::max);
    let mut positions = mesh.positions().to_vec();
    for (v, n) in outward {
        positions[v as usize] -= n.normalized().unwrap_or_default() * (BACK * size);
    }
    Mesh::new(mesh.topology().clone(), positions)
}

/// The facets of several sets that share no volume as those of the whole `set`; `None` when triangles of bodies whose
/// surfaces cross at a contact would cut each other.
pub(super) fn together(
    set: &Set,
    found: &Parted,
    over: &Box3,
    step: f64,
    accuracy: f64,
    options: &FacetOptions,
) -> Result<Option<Facets>, FieldError> {
    let each = found.sets.iter().map(|s| at_step(s, over, step, accuracy, options, None));
    let parts: Vec<Facets> = each.collect::<Result<_, _>>()?;
    let whole = capped(set, over)?.compiled();
    let own = own_leaves(&whole);
    let leaves = whole.leaves;
    let mut known: FxHashMap<u64, SmallVec<[usize; 1]>> = FxHashMap::default();
    for (k, leaf) in leaves.iter().enumerate() {
        known.entry(leaf.primitive.0.fingerprint).or_default().push(k);
    }
    // A part has leaves of the whole only.
    let number = |p: &Primitive| {
        let alike = known.get(&p.0.fingerprint)?;
        alike.iter().copied().find(|&k| leaves[k].primitive.same(p))
    };
    let count = parts.iter().map(|p| p.mesh.faces().len()).sum::<usize>() as f64;
    let broken = |_| FieldError::TooFine { boxes: count, limit: options.limit };
    let mut builder = TopologyBuilder::new();
    let mut positions: Vec<Vec3> = Vec::new();
    let mut surfaces: Vec<SmallVec<[u32; 3]>> = Vec::new();
    let mut by_leaf: Vec<Vec<[u32; 4]>> = vec![Vec::new(); leaves.len()];
    let mut body = Vec::new();
    for (n, part) in parts.iter().enumerate() {
        let Some(of) = part.leaves.iter().map(|l| number(&l.primitive)).collect::<Option<Vec<_>>>()
        else {
            return Ok(None);
        };
        let start = positions.len() as u32;
        positions.extend_from_slice(part.mesh.positions());
        body.resize(positions.len(), n);
        surfaces.extend(part.surfaces.iter().map(|on| {
            let mut on: SmallVec<[u32; 3]> = on.iter().map(|l| of[*l as usize] as u32).collect();
            on.sort_unstable();
            on
        }));
        for (patch, leaf) in part.mesh.patches().iter().zip(&part.patch_leaves) {
            let faces = &part.mesh.faces()[patch.faces.clone()];
            by_leaf[of[*leaf]].extend(faces.iter().map(|f| f.map(|v| v + start)));
        }
    }
    builder.add_vertices(positions.len()).map_err(broken)?;
    let mut patch_leaves = Vec::new();
    for (leaf, faces) in by_leaf.into_iter().enumerate() {
        if !faces.is_empty() {
            patch_leaves.push(leaf);
            builder.add_faces(info(&leaves[leaf]), faces).map_err(broken)?;
        }
    }
    let mut mesh = Mesh::new(builder.build().into(), positions).map_err(broken)?;
    let mut undecided: Vec<Box3> = parts.iter().flat_map(|p| p.undecided.iter().copied()).collect();
    let body_of = |mesh: &Mesh, face: usize| body[mesh.faces()[face][0] as usize];
    for round in 0..=ROUNDS {
        let mut pairs = crossing_faces(&mesh, None);
        pairs.retain(|p| body_of(&mesh, p[0]) != body_of(&mesh, p[1]));
        let deep = |p: &[usize; 2]| depth(&mesh, *p) > TOUCH * step;
        if !found.tangent && pairs.iter().any(deep) {
            return Ok(None);
        }
        if pairs.is_empty() || round == ROUNDS || pairs.iter().all(deep) {
            for face in pairs.into_iter().flatten() {
                let at = mesh.positions()[mesh.faces()[face][0] as usize];
                let middle = (at - over.low) / step;
                let cell = Vec3::of(middle.x.floor(), middle.y.floor(), middle.z.floor());
                let low = over.low + cell * step;
                undecided.push(Box3 { low, high: low + Vec3::of(step, step, step) });
            }
            break;
        }
        pairs.retain(|p| !deep(p));
        mesh = withdrawn(&mesh, &pairs, over, step).map_err(broken)?;
    }
    let place = |b: &Box3| [b.low.x, b.low.y, b.low.z];
    undecided.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
    undecided.dedup_by_key(|b| place(b));
    let first = &parts[0];
    Ok(Some(Facets {
        mesh,
        leaves,
        own_leaves: own,
        patch_leaves,
        surfaces,
        undecided,
        blunt: parts.iter().flat_map(|p| p.blunt.iter().copied()).collect(),
        unresolved: parts.iter().flat_map(|p| p.unresolved.iter().copied()).collect(),
        contacts: found.contacts.clone(),
        about: first.about,
        cells: parts.iter().map(|p| p.cells).sum(),
        step,
        blocks: parts.iter().map(|p| p.blocks).sum(),
        computed: parts.iter().map(|p| p.computed).sum(),
        memory: Memory { grid: first.memory.grid.clone(), blocks: Arc::default() },
    }))
}
