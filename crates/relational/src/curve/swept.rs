//! The locus of a point as its bead moves along its curve.

use crate::arguments::Bead;
use crate::chebyshev::{ChebyshevPiece, DEEPEST, MOST_PIECES, NODES, PiecewiseChebyshev, nodes};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, MovingPoint, Value};

/// The locus of a point when a bead that it depends on sweeps its curve: C(t) is where `point` is with
/// `bead` at the parameter t1 + t (t2 - t1).
///
/// Everything between bead and point is evaluated at each sample. The curve is a chain of
/// polynomials through such samples, halved until they agree to about 1e-12 of its size;
/// derivatives with respect to the model's variables are those of the samples. The bead's own
/// parameter has no influence.
#[derive(Kind)]
#[kind(
    class = Curve,
    sweep = [bead, point],
    columns = "relabel bead point",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsBead b(c, 0.5); Line l(A, C); ProjPoint foot(b, l); BlendPoint m({b, foot}); \
               ProcCurve way(b, m);"
)]
pub struct ProcCurve<T: Real> {
    /// The bead that moves.
    bead: Bead<T>,
    /// The point that follows.
    point: MovingPoint<T>,
    /// Start of the bead.
    #[field(default = 0)]
    t1: T,
    /// End.
    #[field(default = 1)]
    t2: T,
}

impl<T: Real> Build<T> for ProcCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { bead, point, t1, t2 } = self;
        let at = |t: T| {
            let place = t1 * (-t + 1.0) + t2 * t;
            point.at(place).map_err(|fault| no_locus("point", place.re(), &fault, Self::POINT))
        };
        let mut size = 0.0f64;
        let pieces = halved(&stretches(&bead, [t1, t2]), |a, b| {
            let mut samples = Vec::with_capacity(NODES);
            for t in nodes(a, b) {
                samples.push(at(t)?);
            }
            let first = samples[0].re();
            size = samples.iter().fold(size, |s, p: &Vec3<T>| s.max(p.re().distance(first)));
            size = size.max(f64::EPSILON * first.norm());
            let piece = ChebyshevPiece::through(a, b, &samples);
            let fits = piece.rest() <= ACCURACY * size;
            Ok((piece, fits))
        })?;
        Ok(Value::Curve(CurveRef::new(PiecewiseChebyshev { pieces }, 0)))
    }
}

/// Bound of the last coefficients, relative to the size of the swept object.
pub const ACCURACY: f64 = 1e-12;

/// Error of a `noun` without a value for the bead at `t`.
pub fn no_locus(noun: &str, t: f64, fault: &CallError, field: FieldId) -> CallError {
    let whole =
        CallError::new("no-locus", format!("the {noun} has no position with the bead at {t}"))
            .expected(format!("a {noun} wherever the bead is"))
            .found(fault.message.clone())
            .help("sweep only a part of the curve: give t1 and t2")
            .in_field(field);
    fault.related.iter().fold(whole, |whole, (key, label)| whole.related(Some(*key), label.clone()))
}

/// The ends of the stretches of [0, 1] in which the curve of the bead is smooth; they move with t1 and t2.
pub fn stretches<T: Real>(bead: &Bead<T>, [t1, t2]: [T; 2]) -> Vec<T> {
    let breaks = bead.curve.breaks().into_iter().map(|b| (T::from(b) - t1) / (t2 - t1));
    let mut ends = vec![T::zero()];
    ends.extend(breaks.filter(|t| t.re() > 0.0 && t.re() < 1.0));
    ends.push(T::one());
    ends.sort_by(|a, b| a.re().total_cmp(&b.re()));
    ends
}

/// The pieces of these stretches, halved until each fits: `piece` makes one and says whether it does.
/// Pieces so short that they cannot be halved again stay as they are, which keeps a kink.
pub fn halved<T: Real, P>(
    ends: &[T],
    mut piece: impl FnMut(T, T) -> Result<(P, bool), CallError>,
) -> Result<Vec<P>, CallError> {
    let mut todo: Vec<(T, T, u32)> = ends.windows(2).map(|w| (w[0], w[1], 0)).collect();
    todo.reverse();
    let mut pieces = Vec::new();
    while let Some((a, b, depth)) = todo.pop() {
        let (made, fits) = piece(a, b)?;
        if !fits && depth < DEEPEST && pieces.len() + todo.len() < MOST_PIECES {
            let mid = (a + b) * 0.5;
            todo.push((mid, b, depth + 1));
            todo.push((a, mid, depth + 1));
        } else {
            pieces.push(made);
        }
    }
    Ok(pieces)
}
