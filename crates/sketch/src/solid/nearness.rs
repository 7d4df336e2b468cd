//! Comparison of exact positions with the facets that determined the intersecting surfaces.
//!
//! Facets are off their surfaces by up to their chords, so an edge may seem to end in one face where it ends in
//! the next. The exact corner is then outside of the face that it was taken to be in.

use super::curve::SmoothPiece;
use super::facet_source::{FacetSource, along};
use super::surface::FaceSurface;
use moldloft_num::{Real, Vec3};

/// Distance, relative to the bodies, beyond which facets are right.
const FAR: f64 = 2e-2;

/// Relative distance from a border within which a point is on it: for borders in closed form, and
/// for others, which are known by points.
const ON: [f64; 2] = [1e-9, 1e-5];

/// Faces of bodies, with their exact borders.
pub(super) struct Nearness<'a, T> {
    pub sources: &'a [FacetSource<T>],
    pub scale: f64,
}

/// The point of a border nearest to a position.
struct NearestOfBorder {
    distance: f64,
    /// Distance of the point to the left of the border, seen from outside the face.
    left: f64,
    /// The end of its edge, if nearest.
    end: Option<Vec3>,
    exact: bool,
}

impl<T: Real> Nearness<'_, T> {
    /// True if a point on the surface of a face, near its border, is outside the face.
    pub fn outside(&self, at: Vec3, (operand, tag): (usize, u32)) -> bool {
        let source = &self.sources[operand];
        let (border, along_normal) = &source.borders[tag as usize];
        let normal = match &source.surfaces[tag as usize] {
            FaceSurface::Plane { normal, .. } => normal.re(),
            surface => {
                let [u, v] = surface.parameters(at);
                let [_, du, dv] = surface.jet(T::from(u), T::from(v)).map(Vec3::re);
                let Some(n) = du.cross(dv).normalized() else { return false };
                if *along_normal { n } else { -n }
            }
        };
        let mut all: Vec<NearestOfBorder> = Vec::new();
        for &(e, forward) in border {
            all.extend(self.nearest(at, source, e, forward, normal));
        }
        let Some(best) = all.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
            return false;
        };
        let on = self.scale * if all.iter().all(|n| n.exact) { ON[0] } else { ON[1] };
        if best.distance <= on || best.distance > FAR * self.scale {
            return false;
        }
        match best.end {
            None => best.left < -on,
            // The nearest is a corner: the point is outside if it is to the right of both edges.
            Some(end) => {
                let here = |n: &&NearestOfBorder| n.end.is_some_and(|p| p.distance(end) <= on);
                all.iter().filter(here).all(|n| n.left < -on)
            }
        }
    }

    fn nearest(
        &self,
        at: Vec3,
        source: &FacetSource<T>,
        e: u32,
        forward: bool,
        normal: Vec3,
    ) -> Option<NearestOfBorder> {
        let turn = if forward { 1.0 } else { -1.0 };
        let left = |p: Vec3, way: Vec3| {
            let way = (way * turn).normalized().unwrap_or_default();
            normal.cross(way).dot(at - p)
        };
        if let Some(piece) = &source.edges[e as usize].0 {
            let [from, to] = source.ranges[e as usize];
            let (low, high) = (from.min(to), from.max(to));
            let s = along(piece, at);
            let held = s.clamp(low, high);
            let p = piece.at(T::from(held)).re();
            let way = piece.velocity(T::from(held)).re() * if from <= to { 1.0 } else { -1.0 };
            // Rounding may leave the foot of an end inside.
            let ends = [low, high].map(|s| piece.at(T::from(s)).re());
            let end = ends.into_iter().find(|end| end.distance(p) <= ON[0] * self.scale);
            return Some(NearestOfBorder {
                distance: p.distance(at),
                left: left(p, way),
                end,
                exact: true,
            });
        }
        let (p, way, end) =
            nearest_of_nodes(at, &source.traced[e as usize], source.ends[e as usize])?;
        let end = end.then_some(p);
        Some(NearestOfBorder { distance: p.distance(at), left: left(p, way), end, exact: false })
    }
}

/// The point of an edge nearest to a position, its direction there, and whether it is an end. The
/// edge is known by nodes with directions and by its ends: between neighbours it is a cubic.
fn nearest_of_nodes(
    at: Vec3,
    nodes: &[(Vec3, Vec3)],
    [first, last]: [Vec3; 2],
) -> Option<(Vec3, Vec3, bool)> {
    // At an end the direction of a circle through the end and the node beside it.
    let mirrored = |p: Vec3, q: Vec3, way: Vec3| {
        let (chord, way) = ((q - p).normalized()?, way.normalized()?);
        Some(chord * (2.0 * chord.dot(way)) - way)
    };
    let (head, tail) = (nodes.first()?, nodes.last()?);
    let mut all = vec![(first, mirrored(first, head.0, head.1).unwrap_or(head.1))];
    all.extend_from_slice(nodes);
    all.push((last, mirrored(tail.0, last, tail.1).unwrap_or(tail.1)));
    let share = |p: Vec3, q: Vec3| {
        let d = q - p;
        (d.dot(at - p) / d.norm_sq().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    let off = |w: &[(Vec3, Vec3)]| w[0].0.lerp(w[1].0, share(w[0].0, w[1].0)).distance(at);
    let k = (0..all.len() - 1).min_by(|&i, &j| off(&all[i..]).total_cmp(&off(&all[j..])))?;
    let [p, q] = [all[k].0, all[k + 1].0];
    let third = p.distance(q) / 3.0;
    let [m, n] = [all[k].1, all[k + 1].1].map(|d| d.normalized().unwrap_or_default() * third);
    let piece = SmoothPiece::Cubic([p, p + m, q - n, q]);
    let mut s = share(p, q);
    for _ in 0..4 {
        let way = piece.velocity(s);
        s = (s + way.dot(at - piece.at(s)) / way.norm_sq().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    }
    let end = first != last && ((k == 0 && s == 0.0) || (k + 2 == all.len() && s == 1.0));
    Some((piece.at(s), piece.velocity(s), end))
}
