//! Curves and snakes end to end as one.

use crate::arguments::{Snake, common_surface};
use moldloft_num::trace::{Key, Piece, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, SurfaceRef, Value};

/// Curves end to end: piece k of N covers t = (k - 1) / N to k / N, or the interval between given
/// breaks.
///
/// Each piece begins where the one before ends, within the model's tolerance; the direction of a
/// piece is never changed. Meshes join along the pieces.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curves",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               BCurve c({A, B, C}); Line l(C, D); PolyCurve both({c, l}); \
               PolyCurve late({c, l}, {0.7});"
)]
pub struct PolyCurve<T: Real> {
    /// The curves, in order.
    #[field(min_items = 1)]
    curves: Vec<CurveRef<T>>,
    /// Parameters of the joints, ascending between 0 and 1; default: equal intervals.
    breaks: Option<Vec<T>>,
}

impl<T: Real> Build<T> for PolyCurve<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        chain(self.curves, self.breaks, None, context, [Self::CURVES, Self::BREAKS])
    }
}

/// Snakes of one surface end to end, which is a snake again: as a poly-curve.
///
/// The pieces must meet in the parameter plane: one that crosses the seam of a closed surface is
/// refused.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel snakes",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.8, 0.9); \
               LineSnake s(p, q); LineSnake t(q, r); PolySnake both({s, t});"
)]
pub struct PolySnake<T: Real> {
    /// The snakes, in order.
    #[field(min_items = 1)]
    snakes: Vec<Snake<T>>,
    /// Parameters of the joints, ascending between 0 and 1; default: equal intervals.
    breaks: Option<Vec<T>>,
}

impl<T: Real> Build<T> for PolySnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let items: Vec<_> = self.snakes.iter().map(|s| (s.curve.key, &s.surface)).collect();
        let Some(_) = items.first() else { return Err(too_few("snake", Self::SNAKES)) };
        let surface = common_surface(&items, |fault, k| fault.in_item(k).in_field(Self::SNAKES))?;
        let curves = self.snakes.into_iter().map(|s| s.curve).collect();
        chain(curves, self.breaks, Some(surface), context, [Self::SNAKES, Self::BREAKS])
    }
}

/// The most pieces of a chain, those of chains within it included.
const MOST_PARTS: usize = 200_000;

fn too_few(noun: &str, field: FieldId) -> CallError {
    CallError::new("too-few-items", format!("a chain needs at least 1 {noun}"))
        .expected(format!("at least 1 {noun}"))
        .found("0")
        .in_field(field)
}

fn chain<T: Real>(
    curves: Vec<CurveRef<T>>,
    breaks: Option<Vec<T>>,
    surface: Option<SurfaceRef<T>>,
    context: &Context,
    [pieces, at]: [FieldId; 2],
) -> Result<Value<T>, CallError> {
    if curves.is_empty() {
        return Err(too_few("curve", pieces));
    }
    let ends = shares(curves.len(), breaks, at)?;
    for k in 1..curves.len() {
        check_joint(&curves, k, surface.is_some(), context.tolerance, pieces)?;
    }
    // Chains of chains double with each line of a program.
    let parts: usize = curves.iter().map(|curve| curve.joints().len() + 1).sum();
    if parts > MOST_PARTS {
        return Err(CallError::new("too-many-elements", "the chain has too many pieces")
            .expected(format!("at most {MOST_PARTS} pieces, those of its pieces included"))
            .found(parts.to_string())
            .in_field(pieces));
    }
    let trace = trace(&curves, &ends);
    let shape = CompositeCurve { curves, ends, trace, closed: false };
    Ok(Value::Curve(match surface {
        Some(surface) => CurveRef::snake(shape, surface, context.nesting),
        None => CurveRef::new(shape, context.nesting),
    }))
}

/// The end parameters of `count` pieces, 0 and 1 included: the breaks of field `field`, or equal
/// intervals.
///
/// # Errors
/// `wrong-length` and `not-ascending`.
pub fn shares<T: Real>(
    count: usize,
    breaks: Option<Vec<T>>,
    field: FieldId,
) -> Result<Vec<T>, CallError> {
    let Some(breaks) = breaks else {
        return Ok((0..=count).map(|k| T::from(k as f64 / count as f64)).collect());
    };
    if breaks.len() + 1 != count {
        let text = format!("{count} pieces meet at {} parameters", count - 1);
        return Err(CallError::new("wrong-length", text)
            .expected(format!("{} numbers between 0 and 1", count - 1))
            .found(breaks.len().to_string())
            .in_field(field));
    }
    let mut ends = vec![T::zero()];
    ends.extend(breaks);
    ends.push(T::one());
    // Written so that NaN is refused.
    let descends = |k: &usize| {
        ends[*k].re().partial_cmp(&ends[k - 1].re()) != Some(std::cmp::Ordering::Greater)
    };
    if let Some(k) = (1..=count).find(descends) {
        let at = k.min(count - 1);
        return Err(CallError::new("not-ascending", "the breaks do not ascend between 0 and 1")
            .expected("numbers that ascend, greater than 0 and less than 1")
            .found(format!("{} after {}", ends[k].re(), ends[k - 1].re()))
            .in_item(at.saturating_sub(1))
            .in_field(field));
    }
    Ok(ends)
}

/// Maximum distance in u or v between adjacent ends of pieces on a surface.
const MEETING: f64 = 1e-6;

fn check_joint<T: Real>(
    curves: &[CurveRef<T>],
    k: usize,
    on_surface: bool,
    tolerance: f64,
    field: FieldId,
) -> Result<(), CallError> {
    let (before, after) = (&curves[k - 1], &curves[k]);
    let gap_of = |s: f64, t: f64| before.end(s).re().distance(after.end(t).re());
    let gap = gap_of(1.0, 0.0);
    let fault = |text: String, found: String| {
        CallError::new("gap", text)
            .expected("pieces that start where the previous one ends")
            .found(found)
            .related(before.key, "ends on one side of the gap")
            .related(after.key, "begins on the other")
            .in_item(k)
            .in_field(field)
    };
    // Written so that NaN is refused.
    if gap.is_nan() || gap > tolerance {
        let text = format!("piece {} does not begin where piece {k} ends", k + 1);
        let found = format!("a gap of {gap}, with a tolerance of {tolerance}");
        let fault = fault(text, found);
        return Err(if gap_of(1.0, 1.0) <= tolerance {
            fault.help(format!("piece {} ends there: reverse it", k + 1))
        } else if gap_of(0.0, 0.0) <= tolerance && k == 1 {
            fault.help("piece 1 begins there: reverse it")
        } else {
            fault.help("let neighbouring pieces end in common points")
        });
    }
    if !on_surface {
        return Ok(());
    }
    let place = |curve: &CurveRef<T>, t: f64| {
        curve.on_surface(T::from(t), Order::Zero).map(|w| w[0].re()).unwrap_or_default()
    };
    let d = place(before, 1.0) - place(after, 0.0);
    if d.x.abs().max(d.y.abs()) <= MEETING {
        return Ok(());
    }
    let text = format!("piece {} jumps in the parameter plane of the surface", k + 1);
    let found = format!("a jump of ({}, {}) in (u, v)", -d.x, -d.y);
    Err(fault(text, found).help("a snake cannot cross the seam or a pole of a closed surface"))
}

/// The trace of the chain: the pieces of its curves, if all of them have names.
fn trace<T: Real>(curves: &[CurveRef<T>], ends: &[T]) -> Trace<T> {
    let mut all: smallvec::SmallVec<[Piece<T>; 1]> = smallvec::SmallVec::new();
    for (k, curve) in curves.iter().enumerate() {
        let pieces = curve.pieces();
        if pieces.is_empty() {
            let outer = |k: usize, end: usize| -> Option<Key> { curves[k].end_points()[end] };
            return Trace::Own([outer(0, 0), outer(curves.len() - 1, 1)]);
        }
        let width = ends[k + 1] - ends[k];
        let last = pieces.len() - 1;
        all.extend(pieces.into_iter().enumerate().map(|(j, piece)| Piece {
            until: if j == last { ends[k + 1] } else { ends[k] + width * piece.until },
            ..piece
        }));
    }
    Trace::Pieces(all)
}

/// Curves end to end, each up to its end parameter.
pub(crate) struct CompositeCurve<T: Real> {
    pub curves: Vec<CurveRef<T>>,
    /// The parameters of the joints, 0 and 1 included.
    pub ends: Vec<T>,
    pub trace: Trace<T>,
    /// True if it is closed by construction.
    pub closed: bool,
}

impl<T: Real> CompositeCurve<T> {
    /// The piece in charge at `t`, the parameter in it, and that one's rate.
    fn local(&self, t: T) -> (&CurveRef<T>, T, T) {
        let inner = &self.ends[1..self.ends.len() - 1];
        let k = inner.partition_point(|end| end.re() <= t.re());
        let width = self.ends[k + 1] - self.ends[k];
        (&self.curves[k], (t - self.ends[k]) / width, T::one() / width)
    }
}

fn sped<T: Real>(jet: CurveJet<T>, rate: T) -> CurveJet<T> {
    [jet[0], jet[1] * rate, jet[2] * (rate * rate)]
}

impl<T: Real> CompositeCurve<T> {
    /// Parameters collected from the curves, with those of the joints.
    fn with_joints(&self, of: impl Fn(&CurveRef<T>) -> Vec<f64>) -> Vec<f64> {
        let mut all = Vec::new();
        for (k, curve) in self.curves.iter().enumerate() {
            let (from, to) = (self.ends[k].re(), self.ends[k + 1].re());
            all.extend(of(curve).into_iter().map(|b| from + (to - from) * b));
            all.push(to);
        }
        all.pop();
        all
    }
}

impl<T: Real> Curve<T> for CompositeCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let (curve, s, rate) = self.local(t);
        sped(curve.jet(s, order), rate)
    }

    fn breaks(&self) -> Vec<f64> {
        self.with_joints(|curve| curve.breaks())
    }

    fn kinks(&self) -> Vec<f64> {
        self.with_joints(|curve| curve.kinks())
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        let (curve, s, rate) = self.local(t);
        Some(sped(curve.on_surface(s, order)?, rate))
    }

    fn joints(&self) -> Vec<f64> {
        self.with_joints(|curve| curve.joints())
    }

    fn closed(&self) -> bool {
        self.closed
    }

    moldloft_num::curve_facts!(not_rational);
    moldloft_num::curve_one_by_one!(T);
}
