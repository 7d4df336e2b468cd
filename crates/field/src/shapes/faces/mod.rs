//! A body given by its faces as a set of exact half-spaces, cylinders and cones.
//!
//! `faces -> binary division of space -> set`. Space is divided by the planes of the faces until a cell
//! holds no face (it is solid or air throughout) or parts of one round side only. With F and B the sets
//! that the parts of a cell in front of a plane and behind it describe, and H the half-space behind,
//!
//! ```text
//! S = (F - H) | (B & H) | (F & B)
//! ```
//!
//! The last term does not change the set, but hides the plane inside it: a point of the plane with
//! solid on both sides is strictly inside F & B. So the function is zero on the surface of the body
//! only. If one of F, B contains the other, each is needed once: `F | (B & H)` or `(F - H) | B`, so
//! that terraces and prisms keep short formulas.
//!
//! (Divisions by faces: Fuchs, Kedem, Naylor 1980; the consensus term: Quine 1955.)

mod polytope;
mod round;
mod tree;

pub use round::{Round, RoundProfile};

use crate::{FieldError, Primitive, Set};
use moldloft_num::{Box3, Real, Vec3};
use polytope::{HessePlane, Polytope};
use round::Rounded;
use std::cell::Cell;
use std::collections::HashMap;
use tree::{BspTree, Containment, ConvexPiece, Divider, SideSurface, Tangled};

/// Maximum number of cells of a division, and of primitives of its set.
const MOST: usize = 100_000;
/// Number of cells sampled to decide whether one side contains the other.
const LOOKS: usize = 4_000;
/// Maximum number in total: undecided containments lengthen the formula, but do not change the set.
const ALL_LOOKS: usize = 30_000;
/// Points nearer to a plane than this part of the body's diagonal are on it.
const FLAT: f64 = 1e-9;

/// A closed body of triangles, each assigned to a side.
#[derive(Clone, Copy, Debug)]
pub struct Sides<'a, T> {
    /// The vertices.
    pub points: &'a [Vec3<T>],
    /// The triangles, counter-clockwise from outside; those of round sides are inscribed.
    pub triangles: &'a [[u32; 3]],
    /// Number of each triangle's side; `None`: coplanar triangles form a side.
    pub sides: Option<&'a [u32]>,
    /// The round sides.
    pub rounds: &'a [Round<T>],
}

/// The set of a body with plane and round sides: its primitives are the half-spaces of its faces
/// and the cylinders, cones and parabolic cylinders of its round sides, exact where triangles only
/// approximate these.
///
/// Sides that are neither plane nor among the rounds count as their triangles. Faces in one plane share
/// its half-space, also when they would move apart under a change.
///
/// # Errors
/// A body that is not closed; too many faces; round sides that touch or cross so that no plane of theirs
/// parts them.
pub fn faced<T: Real>(body: &Sides<'_, T>) -> Result<Set<T>, FieldError> {
    closed(body.triangles)?;
    let plain: Vec<Vec3> = body.points.iter().map(|p| p.re()).collect();
    if !plain.iter().all(|p| p.is_finite()) {
        return Err(FieldError::NotFinite { what: "vertices" });
    }
    let bounds = Box3::around(plain.iter().copied());
    let size = bounds.low.distance(bounds.high);
    let epsilon = FLAT * size;
    let rounds = Rounded::all(body.rounds, epsilon)?;
    let (flats, mut pieces) = flats(body, &plain, epsilon)?;
    let mut planes: Vec<HessePlane> = flats.iter().map(|f| f.level).collect();
    for (k, round) in rounds.iter().enumerate() {
        // Faces extend to the corners that an arc cuts off: their points belong to the faces too.
        for end in round.ends() {
            let on = |l: &HessePlane| end.iter().all(|p| l.at(*p).abs() <= 10.0 * epsilon);
            for n in 0..flats.len() {
                if on(&planes[n]) {
                    let body = Polytope::polygon(end.to_vec());
                    pieces.push(ConvexPiece { side: SideSurface::Flat(n), body });
                }
            }
        }
        pieces.extend(round.wedges().map(|body| ConvexPiece { side: SideSurface::Round(k), body }));
    }
    planes.extend(rounds.iter().flat_map(Rounded::beside));
    let solid_angle = |p: Vec3| {
        let angle = |t: &[u32; 3]| seen(t.map(|v| plain[v as usize] - p));
        body.triangles.iter().map(angle).sum::<f64>()
    };
    // For an inverted body the solid is around it, as for the distance from its triangles.
    let origin = (bounds.low + bounds.high) * 0.5;
    let part = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| plain[v as usize] - origin);
        a.dot(b.cross(c))
    };
    let turned = body.triangles.iter().map(part).sum::<f64>() < 0.0;
    let half = if turned { -2.0 } else { 2.0 } * std::f64::consts::PI;
    let inside = |p: Vec3| solid_angle(p) > half;
    let space = Polytope::cube((bounds.low + bounds.high) * 0.5, 4.0 * size);
    let bounded = bounded(&planes[..flats.len()], &pieces, &space, epsilon);
    let mut divider =
        Divider { planes: &planes, flat: flats.len(), inside: &inside, epsilon, cells: MOST };
    let tree = divider.divide(space.clone(), pieces).map_err(|tangled| match tangled {
        Tangled::Cells => FieldError::ManyFaces { most: MOST },
        Tangled::Rounds => FieldError::RoundSides,
    })?;
    let mut half_spaces = Vec::with_capacity(planes.len());
    for flat in &flats {
        half_spaces.push(Primitive::plane(flat.normal, flat.point)?);
    }
    // Planes that only part round sides need not move with them.
    for level in &planes[flats.len()..] {
        half_spaces.push(Primitive::linear(Vec3::lifted(level.normal), T::from(level.offset)));
    }
    let round_sets = rounds.iter().map(|r| r.set(body.rounds)).collect::<Result<Vec<_>, _>>()?;
    let assembly = DivisionBuilder {
        half_spaces,
        rounds: round_sets,
        planes: &planes,
        epsilon,
        space: bounded.then_some(space),
        looks: Cell::new(ALL_LOOKS),
    };
    Ok(assembly.set(&tree)?.0)
}

/// Every edge has one triangle on each side.
fn closed(triangles: &[[u32; 3]]) -> Result<(), FieldError> {
    let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
    for t in triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    let open = |((a, b), n): &(&(u32, u32), &usize)| edges.get(&(*b, *a)) != Some(*n);
    let open = edges.iter().filter(open).count();
    if open > 0 || triangles.is_empty() {
        return Err(FieldError::NotClosed { edges: open });
    }
    Ok(())
}

/// The solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983, eq. 8).
fn seen([a, b, c]: [Vec3; 3]) -> f64 {
    let (x, y, z) = (a.norm(), b.norm(), c.norm());
    let volume = a.dot(b.cross(c));
    let rest = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * libm::atan2(volume, rest)
}

struct PlaneSide<T> {
    level: HessePlane,
    normal: Vec3<T>,
    point: Vec3<T>,
}

/// The plane sides, each plane once, and their triangles.
fn flats<T: Real>(
    body: &Sides<'_, T>,
    plain: &[Vec3],
    epsilon: f64,
) -> Result<(Vec<PlaneSide<T>>, Vec<ConvexPiece>), FieldError> {
    let corners = |t: &[u32; 3]| t.map(|v| plain[v as usize]);
    let level = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        // Slivers have no plane of their own.
        let normal = (b - a).cross(c - a);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        if normal.norm() <= epsilon * longest { None } else { HessePlane::through(normal, a) }
    };
    // The triangles of each side, in the order of their first.
    let mut groups: Vec<Vec<usize>> = Vec::new();
    match body.sides {
        Some(sides) => {
            let mut number: HashMap<u32, usize> = HashMap::new();
            let round = |side: u32| body.rounds.iter().any(|r| r.side == side);
            for (k, &side) in sides.iter().enumerate().filter(|(_, side)| !round(**side)) {
                let n = *number.entry(side).or_insert_with(|| {
                    groups.push(Vec::new());
                    groups.len() - 1
                });
                groups[n].push(k);
            }
        }
        None => groups = (0..body.triangles.len()).map(|k| vec![k]).collect(),
    }
    let mut flats: Vec<PlaneSide<T>> = Vec::new();
    let mut pieces = Vec::new();
    let mut add = |triangles: &[usize], level: HessePlane| {
        let found = flats.iter().position(|f| {
            let all = || triangles.iter().flat_map(|&k| corners(&body.triangles[k]));
            all().all(|p| f.level.at(p).abs() <= epsilon)
        });
        let n = found.unwrap_or_else(|| {
            let (normal, point) = mean_plane(body, triangles);
            flats.push(PlaneSide { level, normal, point });
            flats.len() - 1
        });
        pieces.extend(triangles.iter().map(|&k| {
            let body = Polytope::polygon(corners(&body.triangles[k]).to_vec());
            ConvexPiece { side: SideSurface::Flat(n), body }
        }));
    };
    for group in groups {
        let (normal, point) = mean_plane(body, &group);
        let common = HessePlane::through(normal.re(), point.re()).filter(|l| {
            let all = || group.iter().flat_map(|&k| corners(&body.triangles[k]));
            all().all(|p| l.at(p).abs() <= epsilon)
        });
        match common {
            Some(level) => add(&group, level),
            None => {
                for &k in &group {
                    if let Some(level) = level(&body.triangles[k]) {
                        add(&[k], level);
                    }
                }
            }
        }
    }
    Ok((flats, pieces))
}

/// Normal and centre of some triangles of one plane.
fn mean_plane<T: Real>(body: &Sides<'_, T>, triangles: &[usize]) -> (Vec3<T>, Vec3<T>) {
    let (mut normal, mut centre) = (Vec3::zero(), Vec3::zero());
    let mut area = 0.0;
    for &k in triangles {
        let [a, b, c] = body.triangles[k].map(|v| body.points[v as usize]);
        let own = (b - a).cross(c - a);
        let weight = own.re().norm();
        normal += own;
        centre += (a + b + c) * T::from(weight / 3.0);
        area += weight;
    }
    (normal, if area > 0.0 { centre / T::from(area) } else { centre })
}

/// True if the half-spaces of the outermost faces bound a part of space.
fn bounded(planes: &[HessePlane], pieces: &[ConvexPiece], space: &Polytope, epsilon: f64) -> bool {
    let mut hull = Some(space.clone());
    for level in planes {
        let front = pieces.iter().map(|p| level.range(p.body.points())[1]);
        if front.fold(f64::NEG_INFINITY, f64::max) <= epsilon {
            hull = hull.and_then(|h| h.cut(&level.turned(), epsilon));
        }
    }
    let (centre, reach) = (space.middle(), Box3::around(space.points().copied()));
    let half = (reach.high.x - centre.x) * (1.0 - 1e-6);
    hull.is_some_and(|h| {
        h.points().all(|p| (*p - centre).to_array().iter().all(|x| x.abs() < half))
    })
}

/// Data from which the set of a division is built.
struct DivisionBuilder<'a, T: Real> {
    half_spaces: Vec<Primitive<T>>,
    rounds: Vec<Set<T>>,
    planes: &'a [HessePlane],
    epsilon: f64,
    /// The space in which one side may be found to contain the other; only for bodies whose outermost
    /// faces bound it.
    space: Option<Polytope>,
    /// Number of cells that may still be examined.
    looks: Cell<usize>,
}

impl<T: Real> DivisionBuilder<'_, T> {
    /// The set of a division, and its number of primitives.
    fn set(&self, tree: &BspTree) -> Result<(Set<T>, usize), FieldError> {
        let (plane, parts) = match tree {
            BspTree::Air => return Ok((Set::nothing(), 0)),
            BspTree::Solid => return Ok((Set::everything(), 0)),
            BspTree::Round(k) => return Ok((self.rounds[*k].clone(), 2)),
            BspTree::Split { plane, parts } => (*plane, &**parts),
        };
        let (front, behind) = (&parts[0], &parts[1]);
        let (f, many_f) = self.set(front)?;
        let (b, many_b) = self.set(behind)?;
        if front == behind {
            return Ok((f, many_f));
        }
        let half = || Set::new(&self.half_spaces[plane]);
        let rest = || Set::new(&-&self.half_spaces[plane]);
        let within = |inner: &BspTree, outer: &BspTree| {
            let trivial = matches!(inner, BspTree::Air) || matches!(outer, BspTree::Solid);
            trivial
                || self.space.as_ref().is_some_and(|space| {
                    let (planes, epsilon) = (self.planes, self.epsilon);
                    let steps = LOOKS.min(self.looks.get());
                    let mut containment = Containment { planes, epsilon, steps };
                    let holds = containment.holds(inner, outer, space);
                    self.looks.set(self.looks.get() - (steps - containment.steps));
                    holds
                })
        };
        let once = many_f + many_b + 1;
        let (set, many) = if within(front, behind) {
            (f | (b & half()), once)
        } else if within(behind, front) {
            ((f & rest()) | b, once)
        } else {
            let both = f.clone() & b.clone();
            ((f & rest()) | (b & half()) | both, 2 * once)
        };
        if many > MOST {
            return Err(FieldError::ManyFaces { most: MOST });
        }
        Ok((set, many))
    }
}
