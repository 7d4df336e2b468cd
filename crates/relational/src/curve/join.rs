//! Edges declared to be one.

use crate::alias::AliasCurve;
use moldloft_locate::PlainCurve;
use moldloft_num::trace::Trace;
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, DeclaredJoin, FieldId, Kind, Value};
use std::sync::Arc;

/// A declared join: two coincident edges of patches count as one edge in meshes, although they are
/// different objects. The result is the first edge.
///
/// Edges are given as members: `Join j(a.v1, b.v0);` joins edge v = 1 of `a` to edge v = 0 of `b`.
/// Curves and snakes along edges are accepted too; the directions may be opposite. One edge may be on a part
/// of the other, at equal fractions of both: the part between the beads, rings or ends of the longer edge that
/// the shorter one ends at, or the part that is given, such as a `SubCurve` between beads.
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
        let alike = widest_gap(&first, &second, [0.0, 1.0]);
        let against = widest_gap(&first, &second, [1.0, 0.0]);
        let (gap, t, at) = if against.0 < alike.0 { against } else { alike };
        let whole = gap <= tolerance;
        let in_part = || {
            parts == [false; 2]
                && [[&first, &second], [&second, &first]].into_iter().any(|[edge, longer]| {
                    let ends = [0.0, 1.0].map(|t| nearest(longer, edge.end(t).re()));
                    ends[0] != ends[1] && widest_gap(edge, longer, ends).0 <= tolerance
                })
        };
        if !whole && !in_part() {
            return Err(CallError::new("edges-apart", "the edges do not coincide")
                .expected(format!("at most {tolerance} between them"))
                .found(format!("{gap} at t = {t} of the first, at ({}, {}, {})", at.x, at.y, at.z))
                .related(first.key, "is the first")
                .related(second.key, "is the second")
                .help("move one of them, or state a larger `tolerance`")
                .in_field(Self::SECOND));
        }
        let shape = AliasCurve { curve: first.clone(), trace: Trace::Pieces(first.pieces()) };
        let nesting = context.nesting.max(first.depth).max(second.depth);
        let mut edge = match &first.surface {
            Some(surface) => CurveRef::snake(shape, (**surface).clone(), nesting),
            None => CurveRef::new(shape, nesting),
        };
        edge.joins = Some(Arc::new(DeclaredJoin { edges: [first, second], tolerance, whole }));
        Ok(Value::Curve(edge))
    }
}

/// The widest gap between an edge and the part of another between two parameters, its parameter on
/// the edge and its position; NaN if a position is.
fn widest_gap<T: Real>(
    edge: &CurveRef<T>,
    other: &CurveRef<T>,
    [from, to]: [f64; 2],
) -> (f64, f64, Vec3) {
    let mut widest = (0.0f64, 0.0, Vec3::zero());
    for i in 0..=TRIALS {
        let t = i as f64 / TRIALS as f64;
        let place = |curve: &CurveRef<T>, t: f64| curve.jet(T::from(t), Order::Zero)[0].re();
        let p = place(edge, t);
        let gap = p.distance(place(other, from * (1.0 - t) + to * t));
        // Written so that NaN counts.
        if gap.is_nan() || gap > widest.0 {
            widest = (gap, t, p);
        }
    }
    widest
}

/// The parameter of the point of an edge nearest to `p`.
fn nearest<T: Real>(edge: &CurveRef<T>, p: Vec3) -> f64 {
    moldloft_locate::nearest_on_curve(&PlainCurve(&**edge), p, None).at[0]
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
