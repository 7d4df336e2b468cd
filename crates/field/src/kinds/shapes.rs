//! Primitives from curves, surfaces and bodies, as rows of the registry.

use super::read::{fault, field_value};
use crate::shapes::{Beside, Inside, Near, Tube};
use crate::{FieldError, Primitive};
use moldloft_num::Real;
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, SurfaceRef, TriangleBody, Value,
};
use std::sync::Arc;

fn positive<T: Real>(what: &'static str, value: T, field: FieldId) -> Result<T, CallError> {
    crate::error::positive(what, value).map_err(|e: FieldError| fault(&e).in_field(field))
}

/// The distance from a curve minus a radius: a round bar along the curve, with round ends.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "tube",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 1); BCurve c({A, B, C}); field bar = tube(c, 0.2);"
)]
pub struct TubeOf<T: Real> {
    /// The curve.
    curve: CurveRef<T>,
    /// Radius.
    #[field(min = 0)]
    radius: T,
}

impl<T: Real> Build<T> for TubeOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let radius = positive("radius", self.radius, Self::RADIUS)?;
        Ok(field_value(Primitive::user(Arc::new(Tube::new(self.curve, radius)))))
    }
}

/// The distance from a surface on both sides, minus half a thickness: a plate with round edges.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "plate",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); field p = plate(S, 0.1);"
)]
pub struct PlateOf<T: Real> {
    /// The surface.
    surface: SurfaceRef<T>,
    /// Thickness.
    #[field(min = 0)]
    thickness: T,
}

impl<T: Real> Build<T> for PlateOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let thickness = positive("thickness", self.thickness, Self::THICKNESS)?;
        let near = Near::new(self.surface, Beside::Plate(thickness));
        Ok(field_value(Primitive::user(Arc::new(near))))
    }
}

/// The half-space behind a surface: the distance from it, positive on the side of its natural normal.
///
/// Value: (p - q) . n for the point q of the surface nearest to p and the normal n there; beyond
/// the edges the half-space is continued along their tangent planes. The nearest point, and with it
/// the side, jumps where the planes of two edges meet and far behind a surface that bends by more
/// than half a turn: cut the surface before. The ranges are valid there too.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "side",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); field below = side(S);"
)]
pub struct SideOf<T: Real> {
    /// The surface.
    surface: SurfaceRef<T>,
}

impl<T: Real> Build<T> for SideOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(field_value(Primitive::user(Arc::new(Near::new(self.surface, Beside::Side)))))
    }
}

/// The signed distance from a closed body of triangles, such as a sketch's solid or a `SetBody`.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "inside",
    example = "SetBody b(set(sphere({0, 0, 0}, 1)), depth = 4); field f = inside(b); assert abs(f({3, 0, 0}) - 2) < 0.05;"
)]
pub struct InsideOf<T: Real> {
    /// The body.
    body: Arc<TriangleBody<T>>,
}

impl<T: Real> Build<T> for InsideOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        match Inside::new(self.body) {
            Ok(inside) => Ok(field_value(Primitive::user(Arc::new(inside)))),
            Err(open) => {
                let found = format!("{} edges without just one triangle on each side", open.edges);
                Err(CallError::new("not-closed", "the body is not closed, so it has no inside")
                    .expected("a closed, oriented body")
                    .found(found)
                    .in_field(Self::BODY))
            }
        }
    }
}
