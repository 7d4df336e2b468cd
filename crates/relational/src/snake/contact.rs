//! The curves along which a fillet touches its surfaces.

use super::edge_trace;
use crate::alias::AliasCurve;
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};

/// The contact line of a fillet with one of its two surfaces: a snake on that surface and an edge
/// of the fillet.
///
/// Its parameter is the fillet's u. A part of the surface bounded by it (`SubSurf`, `TrimSurf`)
/// shares the fillet's vertices, which are the rings at t = 0 and 1. It crosses the seam of a
/// closed surface, where its parameter jumps from 1 to 0; the magnet of the fillet chooses the
/// start of the path of a ball that rolls round the whole surface, and a start at the seam avoids
/// the jump.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel fillet side",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); \
               AbsPoint E(0, 2.5, -1); AbsPoint F(4, 2, -1); AbsPoint G(0, 2.5, 3); AbsPoint H(4, 2.25, 3); \
               Line a(A, B); Line b(C, D); RuledSurf floor(a, b, visible = 0); Line c(E, F); Line d(G, H); \
               RuledSurf wall(c, d, visible = 0); RollFillet S(floor, wall, 0.8); \
               ContactSnake low(S, 1); ContactSnake high(S, 2); EdgeSnake front(1, floor); \
               EdgeSnake top(3, wall); SubSurf deck({front, low}); SubSurf bulkhead({high, top});"
)]
pub struct ContactSnake<T: Real> {
    /// The fillet: a RollFillet or a FilletSurf.
    fillet: SurfaceRef<T>,
    /// 1 for its first surface, 2 for its second.
    #[field(min = 1, max = 2)]
    side: usize,
}

impl<T: Real> Build<T> for ContactSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { fillet, side } = self;
        let touches = fillet.contacts.as_ref().and_then(|both| both.get(side.wrapping_sub(1)));
        let Some(curve) = touches.cloned() else {
            return Err(CallError::new(
                "no-contact",
                "the surface is not a fillet between two others",
            )
            .expected("a RollFillet or a FilletSurf, and the side 1 or 2")
            .found(if fillet.contacts.is_some() { "another side" } else { "another surface" })
            .help("of the image of a fillet, take the contacts of the original and their images")
            .related(fillet.key, "touches nothing")
            .in_field(Self::FILLET));
        };
        let trace = edge_trace(&fillet, if side == 1 { 0 } else { 2 });
        let surface = curve.surface.as_deref().cloned().expect("a contact lies on a surface");
        let nesting = context.nesting.max(curve.depth);
        Ok(Value::Curve(CurveRef::snake(AliasCurve { curve, trace }, surface, nesting)))
    }
}
