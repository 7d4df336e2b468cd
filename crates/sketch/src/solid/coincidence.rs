//! Detection of missing derivatives of a combined body's measures.
//!
//! A measure changes as the faces move: the volume by the integral of their normal speeds, the area
//! by the motion of their edges. If faces of two bodies coincide but move differently, they overlap
//! on one side and separate on the other, so that the volume has two one-sided derivatives; if an
//! edge is in a face that moves differently, the area has. More than three faces at a point do not
//! change either to first order.

use super::SketchSolid;
use super::facet_source::{FacetSource, settled};
use super::mass::Mass;
use super::revolved::moves;
use super::surface::{Carrier, FaceSurface, meet};
use crate::solid::arrangement::SurfaceCoincidence;
use moldloft_num::{Real, Vec3};
use moldloft_syntax::number::plain;

/// A state in which measures have different one-sided derivatives with respect to a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kink {
    /// The part of the scalar.
    pub part: usize,
    /// The place.
    pub at: Vec3,
    /// True if the volume has no derivative either, because faces separate and not an edge from a
    /// face.
    pub volume: bool,
}

impl std::fmt::Display for Kink {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let what =
            if self.volume { "faces lie in each other" } else { "an edge lies in another face" };
        let [x, y, z] = self.at.to_array().map(plain);
        write!(
            f,
            "{what} at ({x}, {y}, {z}) and they move differently: the derivatives of both sides differ"
        )
    }
}

/// A triangle of a plane face whose parts of one plane do not move alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StrayPart<T> {
    pub corners: [Vec3; 3],
    /// By corner, the rates by which it is ahead of the plane that the face has.
    pub ahead: [T; 3],
}

/// The measures, not a number where they have no derivative.
pub(super) fn without<T: Real>(mut mass: Mass<T>, kinks: &[Kink]) -> Mass<T> {
    for kink in kinks {
        let none = |x: T| T::from_parts(|k| if k == kink.part { f64::NAN } else { x.part(k) });
        mass.area = none(mass.area);
        if kink.volume {
            mass.volume = none(mass.volume);
            mass.centroid = mass.centroid.map(none);
            mass.inertia = mass.inertia.map(none);
        }
    }
    mass
}

/// A vector whose part `k` is `part(k)`, and whose real part is nothing.
pub(super) fn rates<T: Real>(part: impl Fn(usize) -> Vec3) -> Vec3<T> {
    let all: Vec<Vec3> =
        (0..T::PARTS).map(|k| if k > 0 { part(k) } else { Vec3::zero() }).collect();
    Vec3::new(T::from_parts(|k| all[k].x), T::from_parts(|k| all[k].y), T::from_parts(|k| all[k].z))
}

pub(super) fn part<T: Real>(v: Vec3<T>, k: usize) -> Vec3 {
    Vec3::new(v.x.part(k), v.y.part(k), v.z.part(k))
}

/// A surface near a point of it.
#[derive(Clone, Copy)]
pub(super) struct Tangent<T> {
    /// The unit normal.
    pub normal: Vec3,
    /// Distance of the point in front of the surface.
    pub off: T,
    /// The speed of the surface there, by part.
    speed: Vec3<T>,
    turn: Vec3<T>,
}

impl<T: Real> Tangent<T> {
    /// For a point on a surface, or off it by no more than a fraction of its size; `None` at poles,
    /// and if the point is not over it.
    pub fn of(surface: &FaceSurface<T>, p: Vec3<T>, share: f64) -> Option<Tangent<T>> {
        if let FaceSurface::Plane { at, normal } = surface {
            let off = normal.dot(p - *at);
            return Some(Tangent { normal: normal.re(), off, speed: *at, turn: *normal });
        }
        let grid = (0..81).map(|k| [f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0]);
        let mut starts = std::iter::once(surface.parameters(p.re())).chain(grid);
        let [u, v] = starts.find_map(|start| settled(surface, p.re(), start, share))?;
        let [s, du, dv] = surface.jet(T::from(u), T::from(v));
        let [a, b] = [du, dv].map(Vec3::re);
        if a.norm().min(b.norm()) <= 1e-9 * a.norm().max(b.norm()) {
            return None;
        }
        let normal = a.cross(b).normalized()?;
        let off = Vec3::lifted(normal).dot(p - s);
        Some(Tangent { normal, off, speed: s, turn: Vec3::zero() })
    }

    /// Maximum speed of its surface, by part.
    pub fn pace(&self, k: usize, scale: f64) -> f64 {
        part(self.speed, k).norm() + scale * part(self.turn, k).norm()
    }
}

/// Ratio of the speed of corners and points of edges to that of their operands, above which they
/// have no derivative.
const RUSHING: f64 = 1e6;

/// At a contact of faces the edge between them has no derivative: the computed speed is very large.
pub(super) fn rushing<T: Real>(body: &SketchSolid<T>, given: &[Vec3<T>]) -> Vec<Kink> {
    let corners = body.vertices.iter().map(|v| v.at);
    let traces = || body.edges.iter().filter_map(|e| e.trace.as_ref());
    let traced = traces().flat_map(|t| &t.points).copied();
    let nodes = traces().flat_map(|t| &t.nodes).flat_map(|n| [n.0, n.1]);
    let ends = body.edges.iter().filter_map(|e| e.own_ends).flatten();
    let all: Vec<Vec3<T>> = corners.chain(traced).chain(nodes).chain(ends).collect();
    let fast = |k: usize| {
        let most = given.iter().map(|p| part(*p, k).norm()).fold(0.0, f64::max);
        let place = all.iter().find(|p| part(**p, k).norm() > RUSHING * (most + 1e-3))?;
        Some(Kink { part: k, at: place.re(), volume: true })
    };
    (1..T::PARTS).filter_map(fast).collect()
}

/// The kinks of an arrangement. Tools that are `fitted` move with the round faces and edges that they touch.
pub(super) fn kinks<T: Real>(
    shared: &[SurfaceCoincidence],
    points: &[Vec3],
    sources: &[FacetSource<T>],
    scale: f64,
    fitted: bool,
) -> Vec<Kink> {
    let mut found: Vec<Kink> = Vec::new();
    let known = |found: &[Kink], k: usize, volume: bool| {
        found.iter().any(|kink| kink.part == k && (kink.volume || !volume))
    };
    for one in shared {
        let surfaces: Vec<&FaceSurface<T>> =
            one.sources.iter().map(|&(o, t)| &sources[o].surfaces[t as usize]).collect();
        let flat = || surfaces.iter().all(|s| matches!(s, FaceSurface::Plane { .. }));
        if (1..T::PARTS).all(|k| known(&found, k, one.region)) || (fitted && !flat()) {
            continue;
        }
        for &v in &one.points {
            let p = points[v as usize];
            let Some(off) = apart(&surfaces, p, scale, one) else { continue };
            for (k, off) in off.iter().enumerate().skip(1) {
                if *off && !known(&found, k, one.region) {
                    found.push(Kink { part: k, at: p, volume: one.region });
                }
            }
        }
    }
    found
}

/// For each part, true if surfaces that coincide, or intersect in a line, at a point move
/// differently there. `None` if only their facets meet.
fn apart<T: Real>(
    surfaces: &[&FaceSurface<T>],
    p: Vec3,
    scale: f64,
    one: &SurfaceCoincidence,
) -> Option<Vec<bool>> {
    let region = one.region;
    let round = surfaces.iter().any(|s| !matches!(s, FaceSurface::Plane { .. }));
    let share = if round { 0.1 } else { f64::INFINITY };
    let tangent = |p: Vec3<T>, s: &FaceSurface<T>| Tangent::of(s, p, share);
    let rough: Option<Vec<Tangent<T>>> =
        surfaces.iter().map(|s| tangent(Vec3::lifted(p), s)).collect();
    let rough = rough?;
    // Largest distance, and its indices.
    let mut best = (0.0, [0, 0]);
    for i in 0..rough.len() {
        for j in i + 1..rough.len() {
            let across = rough[i].normal.cross(rough[j].normal).norm();
            if across > best.0 {
                best = (across, [i, j]);
            }
        }
    }
    let tangent_all = best.0 < 1e-3;
    let at = if region || tangent_all {
        // On the first one.
        let first = rough[0];
        let by = rates(|k| first.normal * -first.off.part(k));
        Vec3::lifted(p - first.normal * first.off.re()) + by
    } else {
        let [i, j] = best.1;
        let way = rough[i].normal.cross(rough[j].normal).normalized()?;
        let plane = FaceSurface::Plane { at: Vec3::lifted(p), normal: Vec3::lifted(way) };
        let on = [surfaces[i], surfaces[j], &plane].map(Carrier::Surface);
        let start = [i, j].map(|n| match surfaces[n] {
            FaceSurface::Plane { .. } => [0.0; 2],
            s => s.parameters(p),
        });
        let met = meet(&on, p, &[start[0], start[1], [0.0; 2]], scale)?;
        if met.at.re().distance(p) > 0.05 * scale {
            return None;
        }
        met.at
    };
    let exact: Option<Vec<Tangent<T>>> = surfaces.iter().map(|s| tangent(at, s)).collect();
    let exact = exact?;
    // Beside a line where round faces only touch they are nearly as near, and move otherwise.
    let near = if round && !region && tangent_all { 1e-13 } else { 1e-8 };
    if exact.iter().any(|t| t.off.re().abs() > near * scale) {
        return None;
    }
    // If a round face of one body touches a face of another one, and a third contains that line,
    // normal speeds do not determine the motion of the line.
    let touch = |i: usize, j: usize| {
        let flat = |n: usize| matches!(surfaces[n], FaceSurface::Plane { .. });
        one.sources[i].0 != one.sources[j].0
            && !(flat(i) && flat(j))
            && exact[i].normal.cross(exact[j].normal).norm() < 1e-3
    };
    let pairs = || (0..exact.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let touching = !region && pairs().any(|(i, j)| touch(i, j));
    if touching {
        let moving = |k: usize| k > 0 && exact.iter().any(|t| moves(t.pace(k, scale), 0.0));
        return Some((0..T::PARTS).map(moving).collect());
    }
    let off = |k: usize| {
        let most = exact.iter().map(|t| t.pace(k, scale)).fold(part(at, k).norm(), f64::max);
        k > 0 && exact.iter().any(|t| moves(t.off.part(k), most))
    };
    Some((0..T::PARTS).map(off).collect())
}
