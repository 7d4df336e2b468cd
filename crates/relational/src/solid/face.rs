//! Faces of solids as surfaces.

use crate::third_derivatives::slope;
use moldloft_num::trace::{Edges, Face, Key};
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, SolidRef, SurfaceRef, Value};

/// A face of a solid as a surface: 1 is u = 0, 2 is u = 1, 3 is v = 0, 4 is v = 1, 5 is w = 0, 6 is
/// w = 1. Its parameters are the solid's other two, in order.
///
/// Another solid with this surface as a face shares the vertices of the first solid there.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "face solid",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0); \
               AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 2); Line a(A, B); Line b(C, D); Line c(E, F); \
               RuledSurf low(a, b); RuledSurf side(a, c); Line up(A, E); TranSolid S(low, up); \
               FaceSurf top(6, S); TranSolid next(top, up);"
)]
pub struct FaceSurf<T: Real> {
    /// The number of the face.
    #[field(min = 1, max = 6)]
    face: usize,
    /// The solid.
    solid: SolidRef<T>,
}

impl<T: Real> Build<T> for FaceSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let shape = OfSolid { solid: self.solid, face: self.face - 1 };
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting)))
    }
}

struct OfSolid<T: Real> {
    solid: SolidRef<T>,
    face: usize,
}

impl<T: Real> OfSolid<T> {
    /// The solid's parameters at (a, b) of the face.
    fn place<S: Real>(&self, a: S, b: S) -> [S; 3] {
        let fixed = S::from((self.face % 2) as f64);
        match self.face / 2 {
            0 => [fixed, a, b],
            1 => [a, fixed, b],
            _ => [a, b, fixed],
        }
    }
}

impl<T: Real> OfSolid<T> {
    fn first(&self, u: T, v: T) -> SurfJet<T> {
        let [a, b, c] = self.place(u, v);
        let jet = self.solid.jet(a, b, c);
        let (along, across) = match self.face / 2 {
            0 => (jet.v, jet.w),
            1 => (jet.u, jet.w),
            _ => (jet.u, jet.v),
        };
        SurfJet { p: jet.p, u: along, v: across, ..SurfJet::default() }
    }
}

impl<T: Real> Surface<T> for OfSolid<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let [a, b, c] = self.place(u, v);
        if order == Order::Zero {
            return SurfJet { p: self.solid.eval(a, b, c), ..SurfJet::default() };
        }
        let first = self.first(u, v);
        if order == Order::First {
            return first;
        }
        // Solids tell first derivatives only: second ones are their differences.
        let [uu, uv] = slope(
            |u| {
                let j = self.first(u, v);
                [j.u, j.v]
            },
            u,
            &[],
        );
        let [vv] = slope(|v| [self.first(u, v).v], v, &[]);
        SurfJet { uu, uv, vv, ..first }
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        let one = [(self.face % 2) as f64];
        match self.face / 2 {
            0 => self.solid.grid(&one, us, vs, points),
            1 => self.solid.grid(us, &one, vs, points),
            _ => self.solid.grid(us, vs, &one, points),
        }
        let Some(normals) = normals else { return };
        for (row, &u) in normals.chunks_mut(vs.len().max(1)).zip(us) {
            for (n, &v) in row.iter_mut().zip(vs) {
                *n = self.jet(T::from(u), T::from(v), Order::First).normal();
            }
        }
    }

    fn edges(&self) -> Edges<T> {
        match &self.solid.faces().faces[self.face] {
            Face::On { edges, turn, .. } if turn.0 == 0 => (**edges).clone(),
            _ => Edges::own(),
        }
    }

    fn face_of(&self) -> Option<(Key, u8)> {
        Some((self.solid.key?, self.face as u8))
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
    moldloft_num::surface_one_by_one!(T: line, scattered);
}
