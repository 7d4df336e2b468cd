//! Bumps raised on a surface inside a closed snake.

use super::offset::beside;
use super::sub::SubPatch;
use crate::arguments::{Magnet, Side, Snake, common_surface};
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Jet, Real, Surface, SurfaceFormula, Vec3};
use moldloft_registry::{Build, CallError, Class, Context, FromValue, Kind, SurfaceRef, Value};
use std::sync::Arc;

/// A bump on a surface inside a closed snake: a sonar dome, a blister of a fairing, a bulge round a shaft.
///
/// S(u, v) = P(w) + h b(v) n(w), with w on the straight line of the parameter plane from the snake
/// at u (v = 0) to the magnet (v = 1), n the unit normal of the surface P and b a polynomial from 0
/// to 1. Edge of the bump: "sharp" (b' non-zero), "tangent" to the surface (b' = 0), or "curvature"
/// (b' = b'' = 0, equal curvatures too). Top: "round" (b' = 0 at v = 1) or "pointed". It joins
/// other objects on the same snake.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "snake centre height edge top",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 3); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet c(S, 0.5, 0.5); AbsMagnet p(S, 0.8, 0.5); AbsMagnet q(S, 0.5, 0.75); \
               ConicSnake ring(c, p, q); Blister dome(ring, c, 0.4); \
               Blister cone(ring, c, -0.2, \"sharp\", \"pointed\");"
)]
pub struct Blister<T: Real> {
    /// The closed snake around the bump.
    snake: Snake<T>,
    /// The magnet below the top.
    centre: Magnet<T>,
    /// The height, on the side of the natural normal if positive.
    height: T,
    /// At the snake: "sharp", "tangent" or "curvature".
    #[field(default = "tangent")]
    edge: BumpEdge,
    /// At the centre: "round" or "pointed".
    #[field(default = "round")]
    top: BumpTop,
}

/// Contact of a bump with the surface at its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BumpEdge {
    /// At an angle.
    Sharp,
    /// In the tangent plane.
    Tangent,
    /// With the curvatures of the surface.
    Curvature,
}

/// Shape of a bump at its top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BumpTop {
    /// Level.
    Round,
    /// A point.
    Pointed,
}

fn word<T: Real, R: Copy>(value: &Value<T>, words: &[(&str, R)]) -> Result<R, CallError> {
    let text = Arc::<str>::from_value(value)?;
    words.iter().find(|(word, _)| *word == &*text).map(|(_, meaning)| *meaning).ok_or_else(|| {
        let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        CallError::new("unknown-option", format!("unknown option \"{text}\""))
            .expected(known.join(", "))
            .found(format!("\"{text}\""))
    })
}

impl<T: Real> FromValue<T> for BumpEdge {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let words = [
            ("sharp", BumpEdge::Sharp),
            ("tangent", BumpEdge::Tangent),
            ("curvature", BumpEdge::Curvature),
        ];
        word(value, &words)
    }
}

impl<T: Real> FromValue<T> for BumpTop {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        word(value, &[("round", BumpTop::Round), ("pointed", BumpTop::Pointed)])
    }
}

impl<T: Real> Build<T> for Blister<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { snake, centre, height, edge, top } = self;
        let items = [(snake.curve.key, &snake.surface), (centre.key, &centre.surface)];
        common_surface(&items, |fault, k| fault.in_field([Self::SNAKE, Self::CENTRE][k]))?;
        let surface = snake.surface.clone();
        let key = snake.curve.key;
        let patch = SubPatch::cap(surface, [Side::Snake(snake), Side::Magnet(centre)]);
        if !patch.is_closed() {
            return Err(CallError::new("not-closed", "a bump is raised inside a closed snake")
                .expected("a snake that ends where it begins")
                .found("two different ends")
                .related(key, "is the snake")
                .in_field(Self::SNAKE));
        }
        patch.check_folds().map_err(|fault| fault.in_field(Self::CENTRE))?;
        let shape = Bump { patch, height, edge, top };
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting)))
    }
}

struct Bump<T: Real> {
    patch: SubPatch<T>,
    height: T,
    edge: BumpEdge,
    top: BumpTop,
}

impl<T: Real> Bump<T> {
    /// The fraction of the height at v: the polynomial of least degree that meets the conditions.
    fn share<J: Jet<T>>(&self, v: J) -> J {
        let square = v * v;
        match (self.edge, self.top) {
            (BumpEdge::Sharp, BumpTop::Pointed) => v,
            (BumpEdge::Sharp, BumpTop::Round) => v * (-v + 2.0),
            (BumpEdge::Tangent, BumpTop::Pointed) => square,
            (BumpEdge::Tangent, BumpTop::Round) => square * (v * -2.0 + 3.0),
            (BumpEdge::Curvature, BumpTop::Pointed) => square * v,
            (BumpEdge::Curvature, BumpTop::Round) => square * v * (v * -3.0 + 4.0),
        }
    }
}

impl<T: Real> SurfaceFormula for Bump<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let w = self.patch.inside(u, v);
        beside(&**self.patch.surface(), J::fixed(self.height) * self.share(v), w.x, w.y)
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.patch.breaks()
    }

    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        self.patch.crossings(path, spans)
    }

    fn inner_planes(&self) -> Vec<moldloft_num::InnerPlane<'_>> {
        self.patch.inner_planes()
    }

    /// The snake, a seam in space, and a top of its own.
    fn edges(&self) -> Edges<T> {
        let Edges { edges: [foot, ..], corners: [start, ..] } = self.patch.edges();
        Edges {
            edges: [foot, Edge::SameAs(3), Edge::Pole(None), Edge::Own],
            corners: [start, start, None, None],
        }
    }

    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        if k == 0 { self.patch.edge_made_of(0) } else { Vec::new() }
    }

    moldloft_num::surface_facts!(joints_at_breaks, kinks_at_breaks, open, not_rational);
}
