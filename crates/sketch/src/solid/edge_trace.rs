//! Edges of combined bodies that are not straight: their points, and nodes for integrals, found on the surfaces.

use super::IntersectionEdge;
use super::combine::{CombineError, Kind, Placing, located};
use super::curve::SmoothPiece;
use super::facet_source::along;
use super::meeting::{EqualCylinders, closed_form};
use super::revolved::RevolvedSurface;
use super::surface::{Carrier, FaceSurface, Met, meet};
use moldloft_num::GAUSS_8_UNIT;
use moldloft_num::{Real, Vec3};

/// Maximum deviation of the nodes' paths along a chord, relative to its length, and maximum number
/// of halvings of a chord: an edge that turns sharply within a chord, or ends at a contact of its
/// surfaces, needs many.
const RESOLVED: f64 = 1e-12;
const MOST_HALVINGS: u32 = 16;

/// Deviation of the nodes' paths, relative to the chord, below which one that halving does not improve is rounding.
const NOISE: f64 = 1e-9;

/// Accuracy of points, relative to the bodies; smaller errors of chords cannot be resolved by
/// halving.
const ROUNDED: f64 = 1e-14;

/// Faces are tangent where the sine between their normals is less: surfaces that the arrangement takes for one line cross at
/// no greater angle beside it, √(2·1e-9).
const TANGENT: f64 = 4.5e-5;

/// Cosine of the angle between the chords of an edge that share their nodes: two chords of 5°, many of finer facets.
const ONE_CHORD: f64 = 0.99;

/// The points of an edge between which it turns by no more than that.
fn stations<T: Real>(points: &[Vec3<T>]) -> Vec<Vec3<T>> {
    let step = |w: &[Vec3<T>]| (w[1].re() - w[0].re()).normalized();
    let mut out = vec![points[0]];
    let mut first = step(points);
    for w in points.windows(3) {
        let next = step(&w[1..]);
        if !first.zip(next).is_some_and(|(a, b)| a.dot(b) > ONE_CHORD) {
            out.push(w[1]);
            first = next;
        }
    }
    out.extend(points.last());
    out
}

impl<T: Real> Placing<'_, T> {
    /// The points of an edge that is not straight, with their parameters on the round faces beside
    /// it.
    pub(super) fn trace(
        &self,
        chain: &[u32],
        kind: Kind,
        ends: Option<[Vec3<T>; 2]>,
    ) -> Result<IntersectionEdge<T>, CombineError> {
        let Some((operand, tag)) = kind.2 else { return self.crossing(chain, kind, ends) };
        let (curve, beside) = &self.all.sources[operand].edges[tag as usize];
        let curve = curve.as_ref();
        let own = |f: usize| {
            let mut sources = self.arranged.faces[f].sources.iter();
            sources.any(|s| s.0 == operand && beside.contains(&s.1))
        };
        let fixed = (self.fitted && operand == 1) || (own(kind.0) && own(kind.1));
        let on = || self.carriers(kind, curve);
        if fixed || self.tangent_along(chain, kind) {
            return self.trace_on(chain, kind, ends, on());
        }
        // A surface of the other body happens to contain an edge: the new edge moves with both
        // surfaces.
        self.crossing(chain, kind, ends).or_else(|_| self.trace_on(chain, kind, ends, on()))
    }

    /// An edge that two surfaces alone make.
    fn crossing(
        &self,
        chain: &[u32],
        kind: Kind,
        ends: Option<[Vec3<T>; 2]>,
    ) -> Result<IntersectionEdge<T>, CombineError> {
        let pair = [self.surface(kind.0), self.surface(kind.1)];
        // Beside the points where they touch, surfaces do not tell where they meet; the curves that cross there do.
        let middle = self.arranged.points[chain[chain.len() / 2] as usize];
        let ellipse = EqualCylinders::of(pair, self.scale)
            .and_then(|cylinders| cylinders.ellipse(pair[0], middle));
        // An edge of a body whose face continues beyond it on the same surface is where its own surfaces meet.
        let own = || self.own_surfaces(chain).filter(|_| self.tangent_along(chain, kind));
        let on = match (&ellipse, own()) {
            (None, Some(own)) => own.map(Carrier::Surface).to_vec(),
            _ => self.carriers(kind, ellipse.as_ref()),
        };
        let mut edge = self.trace_on(chain, kind, ends, on)?;
        edge.carrier = ellipse.or_else(|| closed_form(pair, &edge.points, self.scale));
        Ok(edge)
    }

    /// The curve, or else the surfaces of two faces.
    fn carriers<'c>(
        &'c self,
        kind: Kind,
        curve: Option<&'c SmoothPiece<T>>,
    ) -> Vec<Carrier<'c, T>> {
        match curve {
            Some(piece) => vec![Carrier::Curve(piece)],
            None => {
                vec![Carrier::Surface(self.surface(kind.0)), Carrier::Surface(self.surface(kind.1))]
            }
        }
    }

    /// The surfaces beside the edge of a body that a chain is on.
    fn own_surfaces(&self, chain: &[u32]) -> Option<[&FaceSurface<T>; 2]> {
        let key = (chain[0].min(chain[1]), chain[0].max(chain[1]));
        self.arranged.edges.get(&key)?.iter().find_map(|&(operand, tag)| {
            let source = &self.all.sources[operand];
            let &[a, b] = &source.edges[tag as usize].1[..] else { return None };
            Some([&source.surfaces[a as usize], &source.surfaces[b as usize]])
        })
    }

    /// True if the faces beside a chain are tangent all along it, so that they do not determine it.
    fn tangent_along(&self, chain: &[u32], kind: Kind) -> bool {
        let normal = |f: usize, p: Vec3| match self.surface(f) {
            FaceSurface::Plane { normal, .. } => normal.re().normalized(),
            surface => {
                let [u, v] = surface.parameters(p);
                let [_, du, dv] = surface.jet(T::from(u), T::from(v)).map(Vec3::re);
                du.cross(dv).normalized()
            }
        };
        chain.iter().all(|&v| {
            let p = self.arranged.points[v as usize];
            let both = normal(kind.0, p).zip(normal(kind.1, p));
            both.is_some_and(|(m, n)| m.cross(n).norm() < TANGENT)
        })
    }

    fn trace_on(
        &self,
        chain: &[u32],
        kind: Kind,
        ends: Option<[Vec3<T>; 2]>,
        fixed: Vec<Carrier<'_, T>>,
    ) -> Result<IntersectionEdge<T>, CombineError> {
        let rough: Vec<Vec3> = chain.iter().map(|&v| self.arranged.points[v as usize]).collect();
        let first = |p: Vec3| -> Vec<[f64; 2]> {
            fixed
                .iter()
                .map(|o| match o {
                    Carrier::Surface(FaceSurface::Plane { .. }) => [0.0; 2],
                    Carrier::Surface(s) => s.parameters(p),
                    Carrier::Curve(c) => [along(c, p), 0.0],
                })
                .collect()
        };
        let mut start = first(rough[0]);
        // A plane across an edge may meet its surfaces elsewhere too.
        let solve = |plane: &FaceSurface<T>, guess: Vec3, reach: f64, start: &mut Vec<[f64; 2]>| {
            let mut on = fixed.clone();
            on.push(Carrier::Surface(plane));
            let from = |s: &Vec<[f64; 2]>| {
                let mut s = s.clone();
                s.push([0.0; 2]);
                s
            };
            // Parameters may not leave the patch: a turned surface comes round again.
            let own = |p: &[T; 2]| p.iter().all(|x| (-0.3..=1.3).contains(&x.re()));
            let near =
                |m: &Met<T>| m.at.re().distance(guess) <= reach && m.parameters.iter().all(own);
            let met = meet(&on, guess, &from(start), self.scale)
                .filter(near)
                .or_else(|| meet(&on, guess, &from(&first(guess)), self.scale).filter(near));
            let met = met.ok_or(CombineError::Touching(guess))?;
            *start = met.parameters[..fixed.len()].iter().map(|p| p.map(Real::re)).collect();
            Ok::<Met<T>, CombineError>(met)
        };
        let m = chain.len();
        let closed = chain[0] == chain[m - 1];
        let mut points: Vec<Vec3<T>> = Vec::with_capacity(m);
        for k in 0..m {
            if closed && k == m - 1 {
                points.push(points[0]);
                continue;
            }
            if let (Some([first, last]), true) = (ends, k == 0 || k == m - 1) {
                points.push(if k == 0 { first } else { last });
                continue;
            }
            if let Some(at) = self.placed.get(&chain[k]) {
                points.push(*at);
                continue;
            }
            let before = if k > 0 { rough[k - 1] } else { rough[m - 2] };
            let after = rough[(k + 1).min(m - 1)];
            let normal = (after - before).normalized();
            let normal = normal.ok_or(CombineError::Touching(rough[k]))?;
            let plane =
                FaceSurface::Plane { at: Vec3::lifted(rough[k]), normal: Vec3::lifted(normal) };
            let reach = 0.5 * (after.distance(rough[k]) + before.distance(rough[k]));
            points.push(solve(&plane, rough[k], reach, &mut start)?.at);
        }
        // Nodes between neighbouring points.
        let round: Vec<usize> =
            [kind.0, kind.1].into_iter().filter(|&f| !self.arranged.faces[f].plane).collect();
        let mut nodes = Vec::new();
        let mut places: Vec<Vec<[T; 3]>> = vec![Vec::new(); round.len()];
        let mut at_round: Vec<Option<[f64; 2]>> = vec![None; round.len()];
        let mut chords: Vec<([Vec3<T>; 2], u32, f64)> =
            stations(&points).windows(2).rev().map(|p| ([p[0], p[1]], 0, f64::INFINITY)).collect();
        while let Some(([from, to], depth, error)) = chords.pop() {
            let step = to - from;
            let Some(normal) = step.re().normalized() else { continue };
            let lifted = Vec3::lifted(normal);
            let rate = lifted.dot(step);
            let before = start.clone();
            let across = |x: f64, start: &mut Vec<[f64; 2]>| {
                let at = from + step * T::from(x);
                let plane = FaceSurface::Plane { at, normal: lifted };
                solve(&plane, at.re(), 0.5 * step.re().norm(), start)
            };
            let mut own: Vec<(Met<T>, Vec3<T>, f64)> = Vec::with_capacity(GAUSS_8_UNIT.len());
            for (x, w) in GAUSS_8_UNIT {
                let met = across(x, &mut start)?;
                let by = met.moved * (rate * w);
                own.push((met, by, w));
            }
            // The nodes' steps add up to the chord as far as the rule resolves the edge.
            let way = own.iter().fold(-step.re(), |sum, n| sum + n.1.re());
            let long = step.re().norm();
            let (most, off) = ((RESOLVED * long).max(ROUNDED * self.scale), way.norm());
            // Beside a point where the surfaces are tangent, rounding grows as chords are halved.
            let rounding = off <= NOISE * long && off >= 0.5 * error;
            if depth < MOST_HALVINGS && off > most && !rounding {
                start = before;
                let middle = across(0.5, &mut start.clone())?.at;
                chords.push(([middle, to], depth + 1, off));
                chords.push(([from, middle], depth + 1, off));
                continue;
            }
            for (met, by, w) in own {
                nodes.push((met.at, by));
                for (r, &f) in round.iter().enumerate() {
                    let surface = self.surface(f);
                    let own = fixed.iter().position(
                        |o| matches!(o, Carrier::Surface(s) if std::ptr::eq::<FaceSurface<T>>(*s, surface)),
                    );
                    let searched = own.filter(|_| RevolvedSurface::of(surface).is_none());
                    let place = match searched {
                        Some(k) => {
                            let [u, v] = met.parameters[k];
                            [u, v, met.moved_parameters[k][0] * (rate * w)]
                        }
                        None => {
                            let from = at_round[r];
                            let place = located(surface, met.at, by, from);
                            let place = place.ok_or(CombineError::Touching(met.at.re()))?;
                            at_round[r] = Some([place[0].re(), place[1].re()]);
                            place
                        }
                    };
                    places[r].push(place);
                }
            }
        }
        let places = round.into_iter().zip(places).collect();
        let carrier = match fixed[..] {
            [Carrier::Curve(piece)] => Some(*piece),
            _ => None,
        };
        Ok(IntersectionEdge { points, nodes, places, carrier })
    }
}
