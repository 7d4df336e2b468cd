//! Solids of surfaces that are translated or swept.

use super::layers::{edges_of, on};
use crate::surface::{FrameMode, MovingFrame};
use moldloft_num::trace::{Face, Faces, LayerLaw, Layers, Turn};
use moldloft_num::{Jet, Real, SolidFormula, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SolidRef, SurfaceRef, Value};

/// A surface translated along a curve: X(u, v, w) = S(u, v) + C(w) - C(0).
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "surface curve",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); \
               AbsPoint E(0.5, 0, 2); AbsPoint F(1, 1, 4); Line a(A, B); Line b(C, D); RuledSurf low(a, b); \
               BCurve way({A, E, F}); TranSolid S(low, way);"
)]
pub struct TranSolid<T: Real> {
    /// The face w = 0.
    surface: SurfaceRef<T>,
    /// Path of the surface.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for TranSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let solid = TranslationSolid { surface: self.surface, curve: self.curve };
        Ok(Value::Solid(SolidRef::new(solid, context.nesting)))
    }
}

struct TranslationSolid<T: Real> {
    surface: SurfaceRef<T>,
    curve: CurveRef<T>,
}

impl<T: Real> SolidFormula for TranslationSolid<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J, w: J) -> Vec3<J> {
        self.surface.at(u, v) + (self.curve.at(w) - self.curve.end(0.0).map(J::fixed))
    }

    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<T>]) {
        let start = self.curve.end(0.0);
        let shifts: Vec<Vec3<T>> = ws.iter().map(|&w| self.curve.at(T::from(w)) - start).collect();
        moved(&self.surface, us, vs, ws.len(), points, |p, k| p + shifts[k]);
    }

    fn faces(&self) -> Faces<T> {
        faces(&self.surface, &self.curve, 0)
    }
}

/// A surface swept along a path by a moving frame: X(u, v, w) = path(w) + F(w) (S(u, v) - path(0)),
/// with F(0) = 1, so that the face w = 0 is the surface. The frames are those of `SweepSurf`.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "surface path frame",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); \
               AbsPoint E(0.5, 0, 2); AbsPoint F(1, 1, 4); Line a(A, B); Line b(C, D); RuledSurf low(a, b); \
               BCurve way({A, E, F}); SweepSolid S(low, way); SweepSolid U(low, way, \"up\", up = {1, 0, 0});"
)]
pub struct SweepSolid<T: Real> {
    /// The face w = 0.
    surface: SurfaceRef<T>,
    /// Path of the surface.
    path: CurveRef<T>,
    /// Motion of the frame: "minimal", "up" or "fixed".
    #[field(default = "minimal")]
    frame: std::sync::Arc<str>,
    /// Upright direction of frame = "up"; default: z.
    up: Option<Vec3<T>>,
}

impl<T: Real> Build<T> for SweepSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, path, frame, up } = self;
        let mode = FrameMode::of(&frame, up, [Self::FRAME, Self::UP])?;
        let moving = MovingFrame::new(path, mode, Self::PATH)?;
        Ok(Value::Solid(SolidRef::new(SweptSolid { surface, moving }, context.nesting)))
    }
}

struct SweptSolid<T: Real> {
    surface: SurfaceRef<T>,
    moving: MovingFrame<T>,
}

impl<T: Real> SweptSolid<T> {
    fn carried<J: Jet<T>>(&self, p: Vec3<J>, path: Vec3<J>, [t, r, s]: [Vec3<J>; 3]) -> Vec3<J> {
        let d = p - self.moving.path.end(0.0).map(J::fixed);
        let [a, b, c] = self.moving.first.map(|axis| d.dot(axis.map(J::fixed)));
        path + t * a + r * b + s * c
    }
}

impl<T: Real> SolidFormula for SweptSolid<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J, w: J) -> Vec3<J> {
        self.carried(self.surface.at(u, v), self.moving.path.at(w), self.moving.frame(w))
    }

    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<T>]) {
        let station = |&w: &f64| {
            let w = T::from(w);
            (self.moving.path.at(w), self.moving.frame(w))
        };
        let stations: Vec<_> = ws.iter().map(station).collect();
        moved(&self.surface, us, vs, ws.len(), points, |p, k| {
            self.carried(p, stations[k].0, stations[k].1)
        });
    }

    fn faces(&self) -> Faces<T> {
        faces(&self.surface, &self.moving.path, self.moving.number())
    }
}

/// The grid of a surface, each of its points moved to station k by `to`.
fn moved<T: Real>(
    surface: &SurfaceRef<T>,
    us: &[f64],
    vs: &[f64],
    stations: usize,
    points: &mut [Vec3<T>],
    to: impl Fn(Vec3<T>, usize) -> Vec3<T>,
) {
    let mut layer = vec![Vec3::zero(); us.len() * vs.len()];
    surface.grid(us, vs, &mut layer, None);
    for (line, &p) in points.chunks_mut(stations.max(1)).zip(&layer) {
        for (k, x) in line.iter_mut().enumerate() {
            *x = to(p, k);
        }
    }
}

/// The first face is the surface; a closed one closes the solid. Solids of joined surfaces along one
/// curve join.
fn faces<T: Real>(surface: &SurfaceRef<T>, curve: &CurveRef<T>, how: u8) -> Faces<T> {
    use moldloft_num::trace::Edge;
    let mut faces = Faces::own();
    let edges = edges_of(surface);
    for (edge, low, face) in [(1, 3, 1), (2, 0, 3)] {
        if edges.edges[edge] == Edge::SameAs(low) {
            faces.faces[face] = Face::SameAs(face as u8 - 1);
        }
    }
    faces.faces[4] = on(surface, Turn::default());
    faces.layers =
        Some(Layers { surfaces: vec![(surface.key, edges)], law: LayerLaw::Along(curve.key, how) });
    faces
}
