//! Edges declared to be one.

use moldloft_num::trace::Trace;
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Value};
use std::sync::Arc;

/// A declared join: two coincident edges of patches count as one edge in meshes, though they come
/// from different objects. The result is the first edge.
///
/// Edges are given as members: `Join j(a.v1, b.v0);` joins edge v = 1 of `a` to edge v = 0 of `b`.
/// Curves and snakes along edges are accepted too; the directions may be opposite. One of the two may
/// be a part of an edge, such as a `SubCurve` between beads: the whole other edge is on that part.
/// Patches on the same curves and points join without a declaration. Edges farther apart than the tolerance at
/// any point are an error; the vertices are those of the patch declared first.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel first second tolerance",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(0, 0, 2); AbsPoint D(2, 1, 2); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(2, 1, 2); AbsPoint Q(0, 0, 2); \
               AbsPoint E(0, 3, 2); AbsPoint F(2, 3, 2); Line p(P, Q); Line q(F, E); RuledSurf R(p, q); \
               EdgeSnake a(3, S); EdgeSnake b(1, R); Join j(a, b);"
)]
pub struct Join<T: Real> {
    /// An edge.
    first: CurveRef<T>,
    /// The other edge.
    second: CurveRef<T>,
    /// Maximum distance between the two edges; default: the model's tolerance.
    #[field(min = 0)]
    tolerance: Option<T>,
}

/// Number of points at which the two edges are compared.
const TRIALS: usize = 64;

impl<T: Real> Build<T> for Join<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { first, second, tolerance } = self;
        let tolerance = tolerance.map_or(context.tolerance, |t| t.re());
        let parts = [is_part(&first, Self::FIRST)?, is_part(&second, Self::SECOND)?];
        if parts == [true; 2] {
            return Err(CallError::new("not-an-edge", "two parts of edges are not joined")
                .expected("one whole edge of a patch, such as `a.v1`, or a curve along one")
                .found("a part of an edge")
                .help("divide one of the patches where the other ends")
                .in_field(Self::SECOND));
        }
        // The widest gap in equal and in opposite direction, and its parameter on the first edge.
        let gap = |turned: bool| {
            let mut widest = (0.0f64, 0.0, Vec3::zero());
            for i in 0..=TRIALS {
                let t = i as f64 / TRIALS as f64;
                let p = first.jet(T::from(t), Order::Zero)[0].re();
                let other = T::from(if turned { 1.0 - t } else { t });
                let gap = p.distance(second.jet(other, Order::Zero)[0].re());
                // Written so that NaN counts.
                if gap.is_nan() || gap > widest.0 {
                    widest = (gap, t, p);
                }
            }
            widest
        };
        let (alike, against) = (gap(false), gap(true));
        let (gap, t, at) = if against.0 < alike.0 { against } else { alike };
        if gap.is_nan() || gap > tolerance {
            return Err(CallError::new("edges-apart", "the edges do not coincide")
                .expected(format!("at most {tolerance} between them"))
                .found(format!("{gap} at t = {t} of the first, at ({}, {}, {})", at.x, at.y, at.z))
                .related(first.key, "is the first")
                .related(second.key, "is the second")
                .help("move one of them, or state a larger `tolerance`")
                .in_field(Self::SECOND));
        }
        let shape = JoinedEdge { first: first.clone() };
        let nesting = context.nesting.max(first.depth).max(second.depth);
        let mut edge = match &first.surface {
            Some(surface) => CurveRef::snake(shape, (**surface).clone(), nesting),
            None => CurveRef::new(shape, nesting),
        };
        edge.joins = Some(Arc::new(([first, second], tolerance)));
        Ok(Value::Curve(edge))
    }
}

/// True for a part of an edge or of a curve, false for all of it.
fn is_part<T: Real>(edge: &CurveRef<T>, field: FieldId) -> Result<bool, CallError> {
    let pieces = edge.pieces();
    match pieces.as_slice() {
        [one] => {
            let ends = [one.from.t.re(), one.to.t.re()];
            Ok(ends != [0.0, 1.0] && ends != [1.0, 0.0])
        }
        other => Err(CallError::new("not-an-edge", "only edges in one piece are joined")
            .expected("an edge of a patch, such as `a.v1`, or a curve along one")
            .found(match other {
                [] => "a point, or a curve without a name".to_string(),
                many => format!("{} pieces", many.len()),
            })
            .help("join the patches' edges piece by piece, or build both on one curve")
            .in_field(field)),
    }
}

struct JoinedEdge<T: Real> {
    first: CurveRef<T>,
}

impl<T: Real> Curve<T> for JoinedEdge<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.first.jet(t, order)
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.first.grid(ts, out);
    }
    fn trace(&self) -> Trace<T> {
        Trace::Pieces(self.first.pieces())
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        self.first.on_surface(t, order)
    }

    moldloft_num::curve_facts!(breaks of [self.first], closed of [self.first], rational of [self.first]);
}
