//! The surface swept by a curve as the bead on which it depends moves along its curve.

use super::column::{Column, Columns};
use crate::arguments::Bead;
use crate::chebyshev::{ChebyshevPiece, NODES, PiecewiseChebyshev, nodes};
use crate::curve::swept::{ACCURACY, halved, no_locus, stretches};
use moldloft_num::trace::Edges;
use moldloft_num::{Jet, Order, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, Kind, MovingCurve, SurfaceRef, Value,
};

/// The surface swept by a curve as a bead on which it depends moves along its curve: S(u, v) is the
/// point u of `curve` with `bead` at the parameter t1 + v (t2 - t1).
///
/// Everything between bead and curve is evaluated at each sample of the bead, as for `ProcCurve`:
/// along v the surface is a chain of polynomials through such curves, halved until they agree to
/// about 1e-12 of its size.
#[derive(Kind)]
#[kind(
    class = Surface,
    sweep = [bead, curve],
    columns = "relabel bead curve",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsBead b(c, 0.5); AbsPoint D(0, 0, 3); AbsPoint E(3, 0, 3); Line l(D, E); \
               ProjPoint foot(b, l); RelPoint m(b, 0, -0.5, 1); BCurve rib({b, m, foot}, 2); \
               ProcSurf skin(b, rib);"
)]
pub struct ProcSurf<T: Real> {
    /// The bead that moves.
    bead: Bead<T>,
    /// The curve that follows.
    curve: MovingCurve<T>,
    /// Start of the bead.
    #[field(default = 0)]
    t1: T,
    /// End.
    #[field(default = 1)]
    t2: T,
}

/// Parameters u at which the polynomials along v are checked.
const PROBES: [f64; 6] = [0.0, 0.17, 0.39, 0.61, 0.83, 1.0];

impl<T: Real> Build<T> for ProcSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { bead, curve, t1, t2 } = self;
        let at = |t: T| {
            let place = t1 * (-t + 1.0) + t2 * t;
            curve.at(place).map_err(|fault| no_locus("curve", place.re(), &fault, Self::CURVE))
        };
        let mut size = 0.0f64;
        let pieces = halved(&stretches(&bead, [t1, t2]), |from, to| {
            let mut ribs = Vec::with_capacity(NODES);
            for t in nodes(from, to) {
                ribs.push(at(t)?);
            }
            let strip = RibStrip { from, to, ribs };
            let mut rest = 0.0f64;
            for u in PROBES {
                let places = strip.places(T::from(u));
                let first = places[0].re();
                size = places.iter().fold(size, |s, p| s.max(p.re().distance(first)));
                size = size.max(f64::EPSILON * first.norm());
                rest = rest.max(ChebyshevPiece::through(from, to, &places).rest());
            }
            Ok((strip, rest <= ACCURACY * size))
        })?;
        let depth = pieces.iter().flat_map(|s| &s.ribs).map(|c| c.depth).max().unwrap_or(0);
        let shape = Columns(SweptSkin { strips: pieces });
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting.max(depth))))
    }
}

/// A stretch along v: the curves at its nodes.
struct RibStrip<T: Real> {
    from: T,
    to: T,
    ribs: Vec<CurveRef<T>>,
}

impl<T: Real> RibStrip<T> {
    fn places<J: Jet<T>>(&self, u: J) -> Vec<Vec3<J>> {
        self.ribs.iter().map(|rib| rib.at(u)).collect()
    }
}

struct SweptSkin<T: Real> {
    strips: Vec<RibStrip<T>>,
}

impl<T: Real> Column for SweptSkin<T> {
    type Scalar = T;
    type Across<S: Real> = PiecewiseChebyshev<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<PiecewiseChebyshev<J>> {
        let piece = |s: &RibStrip<T>| {
            ChebyshevPiece::through(J::fixed(s.from), J::fixed(s.to), &s.places(u))
        };
        Some(PiecewiseChebyshev { pieces: self.strips.iter().map(piece).collect() })
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        let mut us: Vec<f64> = self
            .strips
            .iter()
            .flat_map(|s| [&s.ribs[0], &s.ribs[NODES / 2]])
            .flat_map(|c| c.breaks())
            .collect();
        us.sort_by(f64::total_cmp);
        us.dedup_by(|b, a| *b - *a < 1e-12);
        [us, self.strips[1..].iter().map(|s| s.from.re()).collect()]
    }

    /// An edge whose ribs all coincide in a point is a pole.
    fn edges(&self) -> Edges<T> {
        let mut edges = Edges::own();
        for (k, end) in [(3, 0.0), (1, 1.0)] {
            let ribs = self.strips.iter().flat_map(|s| &s.ribs);
            let mut ends = ribs.map(|c| c.jet(T::from(end), Order::Zero)[0]);
            let first = ends.next();
            if first.is_some_and(|first| ends.all(|p| p.bits_eq(first))) {
                edges.edges[k] = moldloft_num::trace::Edge::Pole(None);
            }
        }
        edges
    }
}
