//! Edges and parameter lines of surfaces as snakes.

use crate::curve::Segment;
use crate::snake::OnSurface;
use moldloft_num::trace::{EDGE_CORNERS, Edge, Key, Mark, Piece, Root, Trace};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use std::sync::Arc;

/// The trace of a snake along edge `k` (0..4: v = 0, u = 1, v = 1, u = 0) of a surface.
pub fn edge_trace<T: Real>(surface: &SurfaceRef<T>, k: usize) -> Trace<T> {
    let mut edges = surface.edges();
    match std::mem::replace(&mut edges.edges[k], Edge::Own) {
        Edge::Pieces(pieces) => Trace::Pieces(pieces),
        Edge::Pole(point) => Trace::Point(point),
        // No edge is the same as one that is the same as another.
        Edge::SameAs(other) => match std::mem::replace(&mut edges.edges[other as usize], Edge::Own)
        {
            Edge::Pieces(pieces) => Trace::Pieces(pieces),
            _ => own_edge(surface, other),
        },
        Edge::Own => own_edge(surface, k as u8),
    }
}

fn own_edge<T: Real>(surface: &SurfaceRef<T>, k: u8) -> Trace<T> {
    let Some(key) = surface.key else { return Trace::own() };
    let known = surface.edges().corners;
    let [a, b] = EDGE_CORNERS[usize::from(k)].map(|c| known[c].or_else(|| key.corner(c)));
    let mark = |t: f64, point: Option<Key>| Mark { t: T::from(t), point };
    let (from, to) = (mark(0.0, a), mark(1.0, b));
    let whole = Piece { root: Root::Edge(key, k), from, to, until: T::one() };
    Trace::Pieces([whole].into_iter().collect())
}

/// An edge of a surface, in the direction of increasing parameter.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel edge surface",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               EdgeSnake s(2, S);"
)]
pub struct EdgeSnake<T: Real> {
    /// The edge: 1 is v = 0, 2 is u = 1, 3 is v = 1, 4 is u = 0.
    #[field(min = 1, max = 4)]
    edge: usize,
    /// The surface.
    surface: SurfaceRef<T>,
}

impl<T: Real> Build<T> for EdgeSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        match self.edge {
            k @ 1..=4 => Ok(Value::Curve(edge(self.surface, k - 1, context.nesting))),
            other => Err(CallError::new("out-of-range", format!("no edge {other}"))
                .expected("an edge from 1 to 4")
                .found(other.to_string())
                .in_field(Self::EDGE)),
        }
    }
}

/// The snake along edge `k` (0..4: v = 0, u = 1, v = 1, u = 0) of a surface, in the direction of
/// increasing parameter; it holds on to shapes nested `nesting` deep.
pub fn edge<T: Real>(surface: SurfaceRef<T>, k: usize, nesting: u32) -> CurveRef<T> {
    let [from, to] = EDGE_CORNERS[k].map(|corner| {
        let [u, v] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][corner];
        Vec3::of(u, v, 0.0)
    });
    let trace = edge_trace(&surface, k);
    let shape = OnSurface { surface: surface.clone(), path: Segment { from, to }, trace };
    CurveRef::snake(shape, surface, nesting)
}

/// A parameter line of a surface: X(t) = S(value, t), or X(t) = S(t, value).
///
/// At the values 0 and 1 it is the edge of the surface itself and joins in meshes.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel surface parameter value",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               UVSnake r(S, \"u\", 0.4); UVSnake s(S, \"v\", 0.25);"
)]
pub struct UVSnake<T: Real> {
    /// The surface.
    surface: SurfaceRef<T>,
    /// Constant parameter, "u" or "v".
    parameter: Arc<str>,
    /// Value of the constant parameter.
    value: T,
}

impl<T: Real> Build<T> for UVSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, parameter, value } = self;
        let held = |t: f64| {
            let t = T::from(t);
            match &*parameter {
                "u" => Ok(Vec3::new(value, t, T::zero())),
                "v" => Ok(Vec3::new(t, value, T::zero())),
                other => {
                    Err(CallError::new("unknown-parameter", format!("there is no \"{other}\""))
                        .expected("\"u\" or \"v\"")
                        .found(format!("\"{other}\""))
                        .in_field(Self::PARAMETER))
                }
            }
        };
        let path = Segment { from: held(0.0)?, to: held(1.0)? };
        let edge = match (&*parameter, value.re()) {
            ("v", 0.0) => Some(0),
            ("u", 1.0) => Some(1),
            ("v", 1.0) => Some(2),
            ("u", 0.0) => Some(3),
            _ => None,
        };
        let trace = edge.map_or(Trace::own(), |k| edge_trace(&surface, k));
        let shape = OnSurface { surface: surface.clone(), path, trace };
        Ok(Value::Curve(CurveRef::snake(shape, surface, context.nesting)))
    }
}
