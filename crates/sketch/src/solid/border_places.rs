//! Borders of round faces in the parameters of their surfaces, for integrals.

use super::facet_source::along;
use super::revolved::turn_about_axis;
use super::surface::FaceSurface;
use super::{SketchSolid, combine, mass};
use moldloft_num::{GAUSS_8_UNIT, Real, Vec3};

/// Distance from a pole, relative to the size of the surface, within which a vertex is at it.
const AT_POLE: f64 = 1e-9;

impl<T: Real> SketchSolid<T> {
    /// Gauss nodes of a cycle of a round face, and the segments between edges whose ends separate.
    pub(crate) fn cycle_places(
        &self,
        face: usize,
        surface: &FaceSurface<T>,
        cycle: &[(usize, bool)],
    ) -> Vec<[T; 3]> {
        let mut nodes = Vec::new();
        for (k, &edge) in cycle.iter().enumerate() {
            nodes.extend(self.places(face, edge));
            let next = cycle[(k + 1) % cycle.len()];
            if self.parts(edge, next) {
                let (from, to) = (self.ends(edge)[1], self.ends(next)[0]);
                let place = combine::located(surface, from, to - from, None);
                nodes.extend(place.filter(|p| !p[2].is_constant()));
            }
            nodes.extend(self.pole_places(surface, edge, next));
        }
        nodes
    }

    /// Gauss's nodes of an edge on the surface of a round face: u, v and the weighted change of u.
    fn places(&self, face: usize, (e, forward): (usize, bool)) -> Vec<[T; 3]> {
        let edge = &self.edges[e];
        let sign = T::from(if forward { 1.0 } else { -1.0 });
        if let Some(trace) = &edge.trace {
            let own = trace.places.iter().find(|p| p.0 == face);
            let turned = |p: &[T; 3]| [p[0], p[1], p[2] * sign];
            return own.map(|p| p.1.iter().map(turned).collect()).unwrap_or_default();
        }
        let Some(surface) = self.surface(face) else { return vec![] };
        let piece = self.piece((e, true));
        let mut at = None;
        let mut nodes = Vec::new();
        for (s, w) in mass::along() {
            let (p, by) = (piece.at(T::from(s)), piece.velocity(T::from(s)) * (sign * w));
            let Some(place) = combine::located(&surface, p, by, at) else { continue };
            at = Some([place[0].re(), place[1].re()]);
            nodes.push(place);
        }
        nodes
    }

    /// Nodes at the pole in which a patch ends, where its border turns from one edge to the next: in
    /// the parameters this is a side of the patch.
    fn pole_places(
        &self,
        surface: &FaceSurface<T>,
        edge: (usize, bool),
        next: (usize, bool),
    ) -> Vec<[T; 3]> {
        let Some((v, pole)) = surface.far_pole() else { return Vec::new() };
        let end = self.ends(edge)[1].re();
        if end.distance(pole) > AT_POLE * (end - self.middle()).norm() {
            return Vec::new();
        }
        let turn = |way: Option<Vec3<T>>, near: f64| turn_about_axis(surface, way?, near);
        let arm = self.end_way((edge.0, !edge.1));
        let Some(from) = turn(arm, 0.5) else { return Vec::new() };
        let Some(to) = turn(self.end_way(next), from.re()) else { return Vec::new() };
        let node = |(x, w): (f64, f64)| [from + (to - from) * x, T::from(v), (to - from) * w];
        GAUSS_8_UNIT.map(node).to_vec()
    }

    /// The direction in which an edge leaves its start.
    fn end_way(&self, (e, forward): (usize, bool)) -> Option<Vec3<T>> {
        let Some(trace) = &self.edges[e].trace else {
            return Some(self.piece((e, forward)).velocity(T::zero()));
        };
        let node = if forward { trace.nodes.first() } else { trace.nodes.last() };
        let by = if forward { node?.1 } else { -node?.1 };
        let Some(piece) = &trace.carrier else { return Some(by) };
        let start = along(piece, self.ends((e, forward))[0].re());
        let way = piece.velocity(T::from(start));
        Some(if way.re().dot(by.re()) < 0.0 { -way } else { way })
    }
}
