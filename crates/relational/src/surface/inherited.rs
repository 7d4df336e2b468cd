//! Edges of surfaces that follow another one point by point, but not by a map of space.

use moldloft_num::trace::{Edge, Edges};
use moldloft_num::{Box3, Order, Real, Surface};

/// Points along an edge at which it is compared.
const TRIALS: usize = 16;

/// Maximum distance between points of one line, or of a pole, relative to the surface's size.
const SAME_PARAMETER: f64 = 1e-12;

/// The edges of `own`, which closes and has poles where `parent` does, if it really does so there.
pub fn edges<T: Real>(parent: &dyn Surface<T>, own: &dyn Surface<T>) -> Edges<T> {
    let place = |k: usize, i: usize| {
        let t = i as f64 / TRIALS as f64;
        let (u, v) = [(t, 0.0), (1.0, t), (t, 1.0), (0.0, t)][k];
        own.jet(T::from(u), T::from(v), Order::Zero).p.re()
    };
    let corners = [(0, 0), (1, 0), (2, 0), (2, TRIALS)].map(|(k, i)| place(k, i));
    let size = Box3::around(corners).diagonal().max(corners[0].norm());
    let mut edges = Edges::own();
    for (k, edge) in parent.edges().edges.iter().enumerate() {
        let same = |other: usize, step: usize| {
            (0..=TRIALS)
                .all(|i| place(k, i).distance(place(other, i * step)) <= SAME_PARAMETER * size)
        };
        match edge {
            Edge::SameAs(other) if same(usize::from(*other), 1) => {
                edges.edges[k] = Edge::SameAs(*other);
            }
            Edge::Pole(_) if same(k, 0) => edges.edges[k] = Edge::Pole(None),
            _ => {}
        }
    }
    edges
}
