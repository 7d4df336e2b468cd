//! The first hit of many rays: an octree in whose parts few leaves decide.
//!
//! A ray passes through the parts in order. Parts of solid or air only are skipped; elsewhere the
//! roots of the leaves in the pruned tape are computed. The cost of a ray depends on the surfaces
//! near it, not on the size of the set.

use crate::expr::interval::{Interval, sides as sides_of};
use crate::expr::tape::{ExprTape, NO_LEAF};
use crate::query::ray::{Hit, Ray, roots};
use crate::set::Membership;
use crate::set::body::SurfacedSet;
use crate::{Primitive, Set};
use moldloft_num::{Box3, Vec3};
use std::sync::Arc;

/// Number of deciding leaves up to which parts are not halved.
const FEW_LEAVES: usize = 3;
/// Parts are halved this often at most.
const DEEPEST: u32 = 8;
/// An index has this many parts at most; those beyond stay coarse.
const MOST_PARTS: usize = 400_000;
/// Roots within this fraction of a ray coincide.
const ONE_PLACE: f64 = 1e-12;

enum RayPart {
    /// All solid, or all air.
    Known(bool),
    /// The deciding part, with its leaves.
    Few(Arc<ExprTape<f64>>, Vec<u32>),
    Halved(Box<[RayPart; 8]>),
}

/// A set with its octree over a box.
pub(crate) struct RayIndex {
    body: SurfacedSet,
    over: Box3,
    root: RayPart,
}

/// State of a ray: whether it was inside before.
struct RayWalk<'a> {
    ray: &'a Ray,
    inside: Option<bool>,
}

impl RayIndex {
    pub(crate) fn new(set: &Set, over: &Box3) -> Self {
        let body = set.as_body();
        let (mut room, mut count) = (Vec::new(), 0);
        let tape = body.compiled.tape.clone();
        let root = part(&body, tape, &sides_of(over), 0, &mut room, &mut count);
        Self { body, over: *over, root }
    }

    /// The first point where a ray crosses the surface, or meets a sheet.
    pub(crate) fn first(&self, ray: &Ray) -> Option<Hit> {
        let [from, to] = clip(ray, &self.over, [0.0, ray.length])?;
        self.visit(&self.root, &self.over, &mut RayWalk { ray, inside: None }, [from, to])
    }

    fn visit(
        &self,
        part: &RayPart,
        over: &Box3,
        walk: &mut RayWalk,
        [from, to]: [f64; 2],
    ) -> Option<Hit> {
        match part {
            RayPart::Known(solid) => self.passed(walk, *solid, from, &[]),
            RayPart::Few(tape, leaves) => self.among(tape, leaves, walk, [from, to]),
            RayPart::Halved(parts) => {
                let centre = over.centre();
                let mut met: Vec<([f64; 2], usize, Box3)> = Vec::with_capacity(4);
                for corner in 0..8 {
                    let (mut low, mut high) = (over.low.to_array(), over.high.to_array());
                    for k in 0..3 {
                        match corner >> k & 1 {
                            0 => high[k] = centre[k],
                            _ => low[k] = centre[k],
                        }
                    }
                    let half = Box3 { low: low.into(), high: high.into() };
                    if let Some(range) = clip(walk.ray, &half, [from, to]) {
                        met.push((range, corner, half));
                    }
                }
                met.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.1.cmp(&b.1)));
                met.into_iter()
                    .find_map(|(range, k, half)| self.visit(&parts[k], &half, walk, range))
            }
        }
    }

    /// Updates the state of the ray from `at` on; returns a hit if it changes. `here` are the
    /// leaves with a root there.
    fn passed(&self, walk: &mut RayWalk, inside: bool, at: f64, here: &[u32]) -> Option<Hit> {
        let before = walk.inside.replace(inside);
        if before.is_none_or(|b| b == inside) {
            return None;
        }
        let point = walk.ray.at(at);
        let leaf = match here.first() {
            Some(leaf) => *leaf as usize,
            None => self.body.winner(point).1?,
        };
        Some(self.hit(at, point, leaf, inside))
    }

    fn hit(&self, t: f64, point: Vec3, leaf: usize, enters: bool) -> Hit {
        let slope = self.body.compiled.leaves[leaf].primitive.gradient(point).slope;
        Hit { t, point, leaf, normal: slope.normalized().unwrap_or_default(), enters }
    }

    fn among(
        &self,
        tape: &ExprTape<f64>,
        leaves: &[u32],
        walk: &mut RayWalk,
        [from, to]: [f64; 2],
    ) -> Option<Hit> {
        let start = walk.ray.at(from);
        let piece = Ray { start, direction: walk.ray.direction, length: to - from };
        let mut found: Vec<(f64, u32)> = Vec::new();
        for &leaf in leaves {
            let f = self.body.compiled.leaves[leaf as usize].primitive.of_sheet();
            found.extend(roots(f, &piece).into_iter().map(|t| (from + t, leaf)));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let near = ONE_PLACE * walk.ray.length;
        let (mut at, mut values) = (from, Vec::new());
        let mut here: Vec<u32> = Vec::new();
        let mut k = 0;
        loop {
            // All roots at one position, then the interval up to the next.
            while k < found.len() && found[k].0 - at <= near {
                here.push(found[k].1);
                k += 1;
            }
            let next = found.get(k).map_or(to, |f| f.0);
            let middle = walk.ray.at(0.5 * (at + next));
            let inside = tape.eval::<f64>(&middle, &mut values) < 0.0;
            let outside = walk.inside == Some(false) && !inside;
            if let Some(hit) = self.passed(walk, inside, at, &here) {
                return Some(hit);
            }
            if outside && let Some(hit) = self.sheet(walk.ray, at, &here) {
                return Some(hit);
            }
            if k >= found.len() {
                return None;
            }
            at = next;
            here.clear();
        }
    }

    /// The sheet that a ray passes through in air, if one of these leaves is.
    fn sheet(&self, ray: &Ray, at: f64, here: &[u32]) -> Option<Hit> {
        let of = |leaf: u32| &self.body.compiled.leaves[leaf as usize].primitive;
        let leaf = here.iter().copied().find(|leaf| of(*leaf).is_sheet())?;
        let known: Vec<Primitive> = here.iter().map(|leaf| of(*leaf).clone()).collect();
        let point = ray.at(at);
        let shows = self.body.member(point, 0.0, &known) == Membership::Surface;
        shows.then(|| self.hit(at, point, leaf as usize, false))
    }
}

fn part(
    body: &SurfacedSet,
    tape: Arc<ExprTape<f64>>,
    sides: &[Interval; 3],
    depth: u32,
    room: &mut Vec<Interval>,
    count: &mut usize,
) -> RayPart {
    *count += 1;
    let range = tape.range(sides, room);
    if range.low > 0.0 || range.high < 0.0 {
        return RayPart::Known(range.high < 0.0);
    }
    let tape = tape.pruned(room).map_or(tape, Arc::new);
    match body.one_state(&tape) {
        Some(Membership::Solid) => return RayPart::Known(true),
        Some(_) => return RayPart::Known(false),
        None => {}
    }
    let mut leaves: Vec<u32> = tape.leaf.iter().copied().filter(|l| *l != NO_LEAF).collect();
    leaves.sort_unstable();
    leaves.dedup();
    if leaves.len() <= FEW_LEAVES || depth == DEEPEST || *count > MOST_PARTS {
        return RayPart::Few(tape, leaves);
    }
    let mut half = |corner: usize| {
        let half = [0, 1, 2].map(|k| {
            let middle = sides[k].middle();
            match corner >> k & 1 {
                0 => Interval { low: sides[k].low, high: middle },
                _ => Interval { low: middle, high: sides[k].high },
            }
        });
        part(body, tape.clone(), &half, depth + 1, room, count)
    };
    RayPart::Halved(Box::new(std::array::from_fn(&mut half)))
}

/// Parameters of a ray within a box, limited to a range.
fn clip(ray: &Ray, over: &Box3, [mut near, mut far]: [f64; 2]) -> Option<[f64; 2]> {
    for k in 0..3 {
        let (start, along) = (ray.start[k], ray.direction[k]);
        if along == 0.0 {
            if start < over.low[k] || start > over.high[k] {
                return None;
            }
            continue;
        }
        let (a, b) = ((over.low[k] - start) / along, (over.high[k] - start) / along);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    (near < far).then_some([near, far])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Caster;

    #[test]
    fn first_hits_are_those_of_all_leaves() {
        let mut random = moldloft_testing::Random::new(8);
        let mut set = Set::nothing();
        for k in 0..60 {
            let at = Vec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
            let part = match k % 3 {
                0 => Set::cuboid(at, at + Vec3::of(0.2, 0.3, 0.1)).unwrap(),
                _ => Set::new(&Primitive::sphere(at, random.between(0.05, 0.2)).unwrap()),
            };
            set = if k % 4 == 3 { set - part } else { set | part };
        }
        let sheet = Primitive::plane(Vec3::of(0.2, 0.1, 1.0), Vec3::zero()).unwrap().abs();
        let thin = Set::new(&sheet) & Set::new(&Primitive::sphere(Vec3::zero(), 0.9).unwrap());
        let set = set | thin;
        let over = Box3 { low: Vec3::of(-1.5, -1.5, -1.5), high: Vec3::of(1.5, 1.5, 1.5) };
        let (index, caster) = (RayIndex::new(&set, &over), Caster::new(&set));
        let mut hits = 0;
        for _ in 0..400 {
            let start = Vec3::from([0; 3].map(|_| random.between(-1.4, 1.4)));
            let to = Vec3::from([0; 3].map(|_| random.signed()));
            let ray = Ray { start, direction: to / to.norm(), length: 6.0 };
            let (found, right) = (index.first(&ray), caster.first(&ray));
            match (&found, &right) {
                (Some(a), Some(b)) => {
                    assert!((a.t - b.t).abs() < 1e-9 && a.enters == b.enters, "{a:?} {b:?}");
                    hits += 1;
                }
                (None, None) => {}
                _ => panic!("{found:?} {right:?}"),
            }
        }
        assert!(hits > 50, "{hits}");
    }
}
