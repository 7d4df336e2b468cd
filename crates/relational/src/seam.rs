//! Surfaces that run round: a parameter of which 0 and 1 are one line, the seam.

use moldloft_num::trace::Edge;
use moldloft_num::{Order, Real, SurfJet};
use moldloft_registry::SurfaceRef;

/// How far beyond 0 and 1 a parameter is still that of the edge.
const NEAR: f64 = 1e-9;

/// Which parameters of a surface, u and v, run round: those whose two edges are one by identity.
pub fn round<T: Real>(surface: &SurfaceRef<T>) -> [bool; 2] {
    let edges = surface.edges().edges;
    let same =
        |a: usize, b: usize| edges[a] == Edge::SameAs(b as u8) || edges[b] == Edge::SameAs(a as u8);
    [same(1, 3), same(0, 2)]
}

/// The parameter in 0 .. 1 of a place that lies whole turns beyond; near 0 and 1 it stays as it is.
pub fn inside<J: Real>(x: J) -> J {
    let re = x.re();
    if (-NEAR..=1.0 + NEAR).contains(&re) { x } else { x - re.floor() }
}

/// The place on a surface of one that may lie beyond its seams.
pub fn wrapped<J: Real>(round: [bool; 2], w: [J; 2]) -> [J; 2] {
    [0, 1].map(|a| if round[a] { inside(w[a]) } else { w[a] })
}

/// The jet of a surface at a place that may lie beyond its seams.
pub fn jet<T: Real>(
    surface: &SurfaceRef<T>,
    round: [bool; 2],
    w: [T; 2],
    order: Order,
) -> SurfJet<T> {
    let [u, v] = wrapped(round, w);
    surface.jet(u, v, order)
}
