//! Curves with vertices of their own at their ends, and their traces along other curves.

use moldloft_num::trace::{Key, Piece, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::Point;

/// A curve with its trace: most are roots of their own between point objects.
pub struct Ended<T: Real, C> {
    /// The curve.
    pub curve: C,
    /// Curves and points that it follows.
    pub trace: Trace<T>,
}

impl<T: Real, C> Ended<T, C> {
    /// A root of its own between the point objects at its ends, where it has them.
    pub fn between(curve: C, ends: [Option<Key>; 2]) -> Self {
        Self { curve, trace: Trace::Own(ends) }
    }
}

/// The trace of a polyline through points, with the fractions `shares` at the ends of its sides:
/// the lines between the point objects, if all points are objects and each differs from the next.
pub(crate) fn polyline<T: Real>(points: &[Point<T>], shares: Vec<T>) -> Trace<T> {
    let sides = points.windows(2).zip(shares);
    let pieces = sides.map(|(ends, until)| Piece::straight(ends[0].key?, ends[1].key?, until));
    match pieces.collect::<Option<_>>() {
        Some(pieces) if points.len() > 2 => Trace::Pieces(pieces),
        _ => Trace::Own([0, points.len() - 1].map(|k| points[k].key)),
    }
}

impl<T: Real, C: Curve<T>> Curve<T> for Ended<T, C> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.jet(t, order)
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
    }
    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }
    moldloft_num::curve_facts!(breaks of [self.curve], closed of [self.curve], rational of [self.curve]);
}
