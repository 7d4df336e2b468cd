//! Curves moved along others without turning.

use super::masters::{along, is_closed};
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Jet, Rational, Real, SurfaceFormula, Vec3, Weight};
use moldloft_registry::{CurveRef, Kind};

/// A curve translated along another: S(u, v) = C1(u) + (C2(v) - C2(0)).
#[derive(Kind)]
#[kind(
    class = Surface,
    shape,
    columns = "c1 c2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 1, 2); \
               AbsPoint E(1, 1, 3); BCurve l({A, B, C}); BCurve m({A, D, E}); TranSurf S(l, m);"
)]
pub struct TranSurf<T: Real> {
    /// The curve to translate: edge v = 0.
    c1: CurveRef<T>,
    /// The path.
    c2: CurveRef<T>,
}

impl<T: Real> SurfaceFormula for TranSurf<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        self.c1.at(u) + (self.c2.at(v) - self.c2.end(0.0).map(J::fixed))
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.c1.breaks(), self.c2.breaks()]
    }

    /// One of the curves, moved.
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        if k.is_multiple_of(2) { self.c1.made_of() } else { self.c2.made_of() }
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        [self.c1.joints(), self.c2.joints()]
    }

    fn rational(&self) -> Rational<2> {
        let (a, b) = (self.c1.rational(), self.c2.rational());
        let paces = [a.paces[0], b.paces[0]];
        let weight: Option<Weight<2>> = match (a.weight, b.weight) {
            (Some(a), Some(b)) => Some(Box::new(move |[u, v]| a([u]) * b([v]))),
            (Some(a), None) => Some(Box::new(move |[u, _]| a([u]))),
            (None, Some(b)) => Some(Box::new(move |[_, v]| b([v]))),
            (None, None) => None,
        };
        Rational { paces, weight }
    }

    /// Edge v = 0 follows the first curve; if both curves begin in one point object, edge u = 0
    /// follows the second. A closed first curve closes the surface.
    fn edges(&self) -> Edges<T> {
        let (a, b) = (self.c1.end_points(), self.c2.end_points());
        let mut edges = Edges::own().with(0, along(&self.c1));
        edges.corners[..2].copy_from_slice(&a);
        if a[0].is_some() && a[0] == b[0] {
            let second = along(&self.c2);
            if second != Edge::Own {
                edges = edges.with(3, second);
            }
            edges.corners[3] = b[1];
        }
        if is_closed(a) {
            edges = edges.with(1, Edge::SameAs(3));
        }
        edges
    }

    moldloft_num::surface_facts!(kinks_at_breaks, breaks_along_lines, open);
}
