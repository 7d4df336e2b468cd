use crate::arguments::{Bead, Ring, common_curve};
use moldloft_num::trace::{Mark, Root, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, Value};

/// The part of a curve between two of its beads: C(t) = P((1 - t) t1 + t t2), where P is the
/// curve and t1, t2 the parameters of the beads. It may run backwards.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel bead1 bead2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               BCurve c({A, B, C, D}); AbsBead b(c, 0.9); AbsBead d(c, 0.2); SubCurve part(b, d);"
)]
pub struct SubCurve<T: Real> {
    /// Where it begins.
    bead1: Bead<T>,
    /// Where it ends, on the same curve.
    bead2: Bead<T>,
}

impl<T: Real> Build<T> for SubCurve<T> {
    fn build(self, context: &Context) -> Result<Value<T>, Fault> {
        part(self.bead1, self.bead2, context)
    }
}

/// The part of a snake between two of its rings, which is a snake again: as a sub-curve.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel ring1 ring2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               AbsRing r(s, 0.9); AbsRing q(s, 0.25); SubSnake part(r, q);"
)]
pub struct SubSnake<T: Real> {
    /// Where it begins.
    ring1: Ring<T>,
    /// Where it ends, on the same snake.
    ring2: Ring<T>,
}

impl<T: Real> Build<T> for SubSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, Fault> {
        part(self.ring1.0, self.ring2.0, context)
    }
}

fn part<T: Real>(from: Bead<T>, to: Bead<T>, context: &Context) -> Result<Value<T>, Fault> {
    let curve = common_curve([&from, &to], 1)?;
    let marks = [&from, &to].map(|bead| Mark { t: bead.t, point: bead.key });
    let trace = match (curve.trace(), curve.key) {
        (Trace::Point(point), _) => Trace::Point(point),
        // A nameless curve is no root that others could share.
        (Trace::Own(_), None) => Trace::Own([from.key, to.key]),
        (trace, key) => {
            let root = key.map_or(Root::Curve(moldloft_num::trace::Key(u32::MAX)), Root::Curve);
            trace.part(root, marks[0], marks[1])
        }
    };
    let surface = curve.surface.clone();
    let shape = Part { curve, from: from.t, to: to.t, trace };
    Ok(Value::Curve(match surface {
        Some(surface) => CurveRef::snake(shape, *surface, context.nesting),
        None => CurveRef::new(shape, context.nesting),
    }))
}

struct Part<T: Real> {
    curve: CurveRef<T>,
    from: T,
    to: T,
    trace: Trace<T>,
}

impl<T: Real> Part<T> {
    fn inner(&self, t: T) -> T {
        // Exact at both ends.
        self.from * (-t + 1.0) + self.to * t
    }

    fn chained(&self, jet: CurveJet<T>) -> CurveJet<T> {
        let rate = self.to - self.from;
        [jet[0], jet[1] * rate, jet[2] * (rate * rate)]
    }
}

impl<T: Real> Curve<T> for Part<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.chained(self.curve.jet(self.inner(t), order))
    }

    fn breaks(&self) -> Vec<f64> {
        let (from, to) = (self.from.re(), self.to.re());
        let at = |b: f64| (b - from) / (to - from);
        let mut breaks: Vec<f64> =
            self.curve.breaks().into_iter().map(at).filter(|t| *t > 0.0 && *t < 1.0).collect();
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.chained(self.curve.on_surface(self.inner(t), order)?))
    }
}
