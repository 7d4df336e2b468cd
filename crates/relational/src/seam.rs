//! Surfaces whose opposite sides are one line by identity, for joins; `SurfaceRef::closed` states
//! that they coincide.

use moldloft_num::Real;
use moldloft_num::trace::Edge;
use moldloft_registry::SurfaceRef;

/// For u and v of a surface, true if the opposite sides are the same by identity.
pub fn joined_sides<T: Real>(surface: &SurfaceRef<T>) -> [bool; 2] {
    let edges = surface.edges().edges;
    let same =
        |a: usize, b: usize| edges[a] == Edge::SameAs(b as u8) || edges[b] == Edge::SameAs(a as u8);
    [same(1, 3), same(0, 2)]
}
