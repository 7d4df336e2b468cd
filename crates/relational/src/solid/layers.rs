//! Surfaces that are faces or layers of solids: facts known from the solid.

use moldloft_num::Real;
use moldloft_num::trace::{Edge, Edges, Face, Piece, Root, Turn};
use moldloft_registry::SurfaceRef;

/// The edges of a surface, its own ones by its name.
pub fn edges_of<T: Real>(surface: &SurfaceRef<T>) -> Edges<T> {
    let mut edges = surface.edges();
    let Some(key) = surface.key else { return edges };
    let corner_of = [[0, 1], [1, 2], [3, 2], [0, 3]];
    for (k, edge) in edges.edges.iter_mut().enumerate() {
        if *edge == Edge::Own {
            let mark = |end: usize| moldloft_num::trace::Mark {
                t: T::from(end as f64),
                point: edges.corners[corner_of[k][end]],
            };
            *edge = Edge::Pieces(smallvec::smallvec![Piece {
                root: Root::Edge(key, k as u8),
                from: mark(0),
                to: mark(1),
                until: T::one(),
            }]);
        }
    }
    edges
}

/// The face that is the whole of a surface.
pub fn on<T: Real>(surface: &SurfaceRef<T>, turn: Turn) -> Face<T> {
    Face::On {
        surface: surface.key,
        face_of: surface.face_of(),
        turn,
        edges: Box::new(edges_of(surface)),
    }
}
