//! Corners of bodies that are combined, and how they and the ends of edges there move.

use super::coincidence::{Kink, StrayPart, Tangent, part, rates};
use super::combine::{CombineError, Kind, Placing, triangles_of};
use super::facet_source::{ON_SURFACE, along};
use super::meeting::EqualCylinders;
use super::revolved::moves;
use super::surface::{Carrier, FaceSurface, meet};
use moldloft_num::{Real, Vec3};
use std::collections::BTreeSet;

/// Maximum distance from its surfaces, relative to the bodies, of a point that represents their
/// contact.
const ON_ALL: f64 = 1e-11;

impl<T: Real> Placing<'_, T> {
    /// The position of a corner; `None` when the points of its closed edge determine it.
    pub(super) fn corner(
        &self,
        v: u32,
        faces: &BTreeSet<usize>,
        edges: &BTreeSet<(usize, u32)>,
    ) -> Result<Option<Vec3<T>>, CombineError> {
        // A vertex of a body stays, unless a surface of the other body happens to pass through it: the
        // corner is then where that one meets its surfaces, or it would follow the wrong one.
        let given = self.original.get(&v).map(|&k| k as usize);
        let foreign = |f: usize| {
            let own = given.map(|k| &self.all.around[k]);
            own.is_some_and(|own| !self.arranged.faces[f].sources.iter().any(|s| own.contains(s)))
        };
        let known = given.map(|k| self.all.points[k]);
        if known.is_some() && !faces.iter().any(|&f| foreign(f)) {
            return Ok(known);
        }
        let guess = self.arranged.points[v as usize];
        let parameters = |s: &FaceSurface<T>| match s {
            FaceSurface::Plane { .. } => [0.0; 2],
            _ => s.parameters(guess),
        };
        // Every surface at the corner, with its normal there; planes of one position count once.
        let mut surfaces: Vec<(&FaceSurface<T>, Vec3, [f64; 2])> = Vec::new();
        for &f in faces {
            let s = self.surface(f);
            let start = parameters(s);
            let normal = match s {
                FaceSurface::Plane { normal, .. } => normal.re(),
                _ => {
                    let [_, du, dv] = s.jet(T::from(start[0]), T::from(start[1]));
                    du.re().cross(dv.re()).normalized().unwrap_or_default()
                }
            };
            surfaces.push((s, normal, start));
        }
        let mut best: Option<(f64, Vec<Carrier<'_, T>>, Vec<[f64; 2]>)> = None;
        for &(operand, tag) in edges {
            let (Some(piece), beside) = &self.all.sources[operand].edges[tag as usize] else {
                continue;
            };
            let across = |f: &usize| {
                let mut sources = self.arranged.faces[*f].sources.iter();
                !sources.any(|s| s.0 == operand && beside.contains(&s.1))
            };
            // Several surfaces across it: one of them may contain the edge and not move with it.
            let alone = faces.iter().filter(|f| across(f)).count() < 2;
            let s = along(piece, guess);
            let direction = piece.velocity(T::from(s)).re().normalized().unwrap_or_default();
            for (k, &f) in faces.iter().enumerate() {
                let source = self.arranged.faces[f].sources[0];
                if source.0 == operand && beside.contains(&source.1) {
                    continue;
                }
                if known.is_some() && !foreign(f) {
                    continue;
                }
                let (surface, normal, start) = surfaces[k];
                // It holds where the faces beside the edge are tangent.
                let preferred = if alone { 1.5 } else { 1e-4 };
                let rate = preferred * direction.dot(normal).abs();
                if best.as_ref().is_none_or(|b| rate > b.0) {
                    let on = vec![Carrier::Curve(piece), Carrier::Surface(surface)];
                    best = Some((rate, on, vec![[s, 0.0], start]));
                }
            }
        }
        let strange: Vec<bool> = faces.iter().map(|&f| foreign(f)).collect();
        for i in 0..surfaces.len() {
            for j in i + 1..surfaces.len() {
                for k in j + 1..surfaces.len() {
                    if known.is_some() && ![i, j, k].iter().any(|&n| strange[n]) {
                        continue;
                    }
                    let (a, b, c) = (&surfaces[i], &surfaces[j], &surfaces[k]);
                    let rate = a.1.dot(b.1.cross(c.1)).abs();
                    if best.as_ref().is_none_or(|b| rate > b.0) {
                        let on = [a, b, c].map(|s| Carrier::Surface(s.0)).to_vec();
                        best = Some((rate, on, vec![a.2, b.2, c.2]));
                    }
                }
            }
        }
        if let Some(at) = known {
            let met = best.filter(|b| b.0 > 1e-3);
            let met = met.and_then(|(_, on, start)| meet(&on, guess, &start, self.scale));
            // The position is known to the last digit; only its derivatives are those of the
            // surfaces.
            let near = met.filter(|m| m.at.re().distance(at.re()) <= 1e-7 * self.scale);
            return Ok(Some(near.map_or(at, |m| m.at + Vec3::lifted(at.re() - m.at.re()))));
        }
        match best {
            Some((rate, on, start)) if rate > 1e-9 => {
                let met = meet(&on, guess, &start, self.scale);
                met.map(|m| Some(m.at)).ok_or(CombineError::Touching(guess))
            }
            // The vertex of a closed edge.
            _ if faces.len() == 2 => Ok(None),
            _ => self.tangent_corner(guess, faces).map(Some).ok_or(CombineError::Touching(guess)),
        }
    }

    /// A corner at which all faces touch: that of crossing cylinders of one radius, or a point that is on all of them.
    fn tangent_corner(&self, guess: Vec3, faces: &BTreeSet<usize>) -> Option<Vec3<T>> {
        let round: Vec<usize> =
            faces.iter().copied().filter(|&f| !self.arranged.faces[f].plane).collect();
        let pairs = || (0..round.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let crossing = pairs().find_map(|pair| {
            let pair = pair.map(|k| self.surface(round[k]));
            EqualCylinders::of(pair, self.scale)?.vertex(guess, self.scale)
        });
        let on = |&f: &usize| {
            let tangent = Tangent::of(self.surface(f), Vec3::lifted(guess), ON_SURFACE);
            tangent.is_some_and(|t: Tangent<T>| t.off.re().abs() <= ON_ALL * self.scale)
        };
        crossing.or_else(|| faces.iter().all(on).then(|| Vec3::lifted(guess)))
    }

    /// A corner without derivatives if its faces separate: more of them than determine a point meet
    /// there by chance, and any change splits it into several corners. Also returns whether edges
    /// need ends of their own there.
    pub(super) fn moved_with_all(
        &self,
        at: Vec3<T>,
        (faces, edges): (&BTreeSet<usize>, &BTreeSet<(usize, u32)>),
    ) -> (Vec3<T>, bool) {
        if T::PARTS == 1 {
            return (at, false);
        }
        // By face, its own plane and those of its other parts.
        let touching = |f: &usize| -> Vec<Tangent<T>> {
            let sources = self.arranged.faces[*f].sources.iter();
            let surface = |s: &(usize, u32)| &self.all.sources[s.0].surfaces[s.1 as usize];
            sources.filter_map(|s| Tangent::of(surface(s), at, ON_SURFACE)).collect()
        };
        let all: Vec<Vec<Tangent<T>>> = faces.iter().map(touching).collect();
        // Edges between tangent faces, whose planes do not tell where they run.
        let tangent: Vec<(Vec3<T>, Vec3)> =
            edges.iter().filter_map(|&e| self.tangent_edge(e, at.re())).collect();
        let strays = |k: usize| {
            tangent.iter().any(|(on, way)| {
                let [curve, own] = [part(*on, k), part(at, k)];
                let by = curve - own;
                moves((by - *way * way.dot(by)).norm(), curve.norm() + own.norm())
            })
        };
        // Or one that parted in a body that this one is made of.
        let lost = |k: usize| !part(at, k).is_finite() || strays(k);
        let speeds = |k: usize| all.iter().flatten().map(move |t| t.pace(k, self.scale));
        let off = |t: &Tangent<T>, k: usize| {
            let most = speeds(k).fold(part(at, k).norm(), f64::max);
            moves(t.off.part(k), most)
        };
        let leaves =
            |k: usize| lost(k) || all.iter().any(|own| own.first().is_some_and(|t| off(t, k)));
        let parted = |k: usize| {
            lost(k) || all.iter().any(|own| !own.is_empty() && own.iter().all(|t| off(t, k)))
        };
        let none = |x: T| T::from_parts(|k| if k > 0 && parted(k) { f64::NAN } else { x.part(k) });
        (at.map(none), (1..T::PARTS).any(leaves))
    }

    /// The point of an edge of a body at a position and its direction there, if the faces beside it
    /// are tangent.
    fn tangent_edge(&self, (operand, tag): (usize, u32), p: Vec3) -> Option<(Vec3<T>, Vec3)> {
        let source = &self.all.sources[operand];
        let (piece, beside) = &source.edges[tag as usize];
        let (piece, &[a, b]) = (piece.as_ref()?, &beside[..]) else { return None };
        let normal = |tag: u32| {
            let surface = &source.surfaces[tag as usize];
            Tangent::of(surface, Vec3::lifted(p), ON_SURFACE).map(|t: Tangent<T>| t.normal)
        };
        let touching = normal(a)?.cross(normal(b)?).norm_sq() <= 1e-8;
        let s = T::from(along(piece, p));
        let way = piece.velocity(s).re().normalized()?;
        touching.then(|| (piece.at(s), way))
    }

    /// Parts of plane faces that are of other bodies than the rest and do not move with it.
    pub(super) fn strays(&self) -> Vec<StrayPart<T>> {
        let mut out = Vec::new();
        if T::PARTS == 1 {
            return out;
        }
        for face in self.arranged.faces.iter().filter(|f| f.plane && f.sources.len() > 1) {
            let plane = |(operand, tag): (usize, u32), p: Vec3| {
                let surface = &self.all.sources[operand].surfaces[tag as usize];
                Tangent::of(surface, Vec3::lifted(p), ON_SURFACE)
            };
            for (part, &owner) in face.parts.iter().zip(&face.owners) {
                if owner == face.sources[0] {
                    continue;
                }
                let at = |v: u32| self.arranged.points[v as usize];
                // Distance of a face's point behind its plane, from that in front of it.
                let outward = |t: Tangent<T>| {
                    if t.normal.dot(face.normal) < 0.0 { t.off } else { -t.off }
                };
                let ahead = |v: u32| {
                    let p = at(v);
                    let [own, base] = [plane(owner, p)?, plane(face.sources[0], p)?];
                    let ahead = outward(own) - outward(base);
                    let pace = |k| own.pace(k, self.scale) + base.pace(k, self.scale);
                    let rate = |k| {
                        if k == 0 || !moves(ahead.part(k), pace(k)) { 0.0 } else { ahead.part(k) }
                    };
                    Some(T::from_parts(rate))
                };
                for corners in triangles_of(part, &at, face.normal) {
                    let [Some(a), Some(b), Some(c)] = corners.map(ahead) else { continue };
                    if [a, b, c].iter().any(|x| !x.is_constant()) {
                        out.push(StrayPart { corners: corners.map(at), ahead: [a, b, c] });
                    }
                }
            }
        }
        out
    }

    /// The ends of an edge as moved by its own surfaces, if one is a corner that splits. Their
    /// position along the edge is free: the connection from one edge's end to the next one's is a
    /// part of the border of the face between them.
    pub(super) fn own_ends(&self, ends: [u32; 2], kind: Kind) -> Option<[(Vec3<T>, Vec<Kink>); 2]> {
        if !ends.iter().any(|v| self.parted.contains(v)) {
            return None;
        }
        let at = ends.map(|v| self.placed.get(&v).copied());
        let at = [(ends[0], at[0]?), (ends[1], at[1]?)];
        Some(at.map(|(v, p)| match self.parted.contains(&v) {
            true => self.own_end(p.re(), kind),
            false => (p, Vec::new()),
        }))
    }

    fn own_end(&self, p: Vec3, kind: Kind) -> (Vec3<T>, Vec<Kink>) {
        let lifted = Vec3::lifted(p);
        let pair = [kind.0, kind.1].map(|f| Tangent::of(self.surface(f), lifted, ON_SURFACE));
        if let [Some(a), Some(b)] = pair {
            let [m, n] = [a.normal, b.normal];
            let (mn, across) = (m.dot(n), m.cross(n).norm_sq());
            if across > 1e-8 {
                // The smallest displacement onto both.
                let by = |k: usize| {
                    let (x, y) = (-a.off.part(k), -b.off.part(k));
                    m * ((x - mn * y) / across) + n * ((y - mn * x) / across)
                };
                return (lifted + rates(by), Vec::new());
            }
        }
        let curve = kind.2.and_then(|(o, t)| self.all.sources[o].edges[t as usize].0.as_ref());
        if let Some(piece) = curve {
            let s = T::from(along(piece, p));
            let way = piece.velocity(s).re().normalized().unwrap_or_default();
            let by = |k: usize| {
                let by = part(piece.at(s), k);
                by - way * way.dot(by)
            };
            return (lifted + rates(by), Vec::new());
        }
        // At a contact of its surfaces, an edge has no derivative.
        (lifted, (1..T::PARTS).map(|part| Kink { part, at: p, volume: true }).collect())
    }
}
