//! Parts of curves and snakes between beads and rings; divisions of a part are those of the whole.

use crate::arguments::{Bead, Ring, common_curve};
use moldloft_num::period::breaks_between;
use moldloft_num::trace::{Mark, Root, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3, find_root};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Value};
use moldloft_spline::BSplineCurve;
use std::sync::Arc;

/// The part of a curve between two of its beads: C(t) = P((1 - t) t1 + t t2), where P is the curve
/// and t1, t2 the parameters of the beads. For t1 > t2 it runs backwards.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel bead1 bead2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               BCurve c({A, B, C, D}); AbsBead b(c, 0.9); AbsBead d(c, 0.2); SubCurve part(b, d);"
)]
pub struct SubCurve<T: Real> {
    /// Start.
    bead1: Bead<T>,
    /// End, on the same curve.
    bead2: Bead<T>,
}

impl<T: Real> Build<T> for SubCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        part(self.bead1, self.bead2, Self::BEAD2)
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
    /// Start.
    ring1: Ring<T>,
    /// End, on the same snake.
    ring2: Ring<T>,
}

impl<T: Real> Build<T> for SubSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        part(self.ring1.0, self.ring2.0, Self::RING2)
    }
}

/// A curve reparametrised by a B-spline: C(t) = P(b(t)), where P is the curve of the beads and b
/// the clamped uniform B-spline with their parameters as coefficients.
///
/// It begins at the first bead and ends at the last; the others draw its divisions toward them.
/// With N beads the degree is at most N - 1: a higher one is lowered to that.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel degree beads",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); \
               BCurve c({A, B, C, D}); AbsBead b(c, 0.1); AbsBead d(c, 0.3); AbsBead e(c, 0.9); \
               BSubCurve part({b, d, e}, degree = 2);"
)]
pub struct BSubCurve<T: Real> {
    /// Beads of one curve, two or more.
    #[field(min_items = 2)]
    beads: Vec<Bead<T>>,
    /// Polynomial degree of the law.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BSubCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        redistributed(self.beads, self.degree, [Self::BEADS, Self::DEGREE])
    }
}

/// A snake reparametrised by a B-spline; the counterpart of a B-sub-curve.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel degree rings",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, \"u\", 0.4); \
               AbsRing r(s, 0.9); AbsRing q(s, 0.75); AbsRing p(s, 0.25); \
               BSubSnake part({r, q, p}, degree = 2);"
)]
pub struct BSubSnake<T: Real> {
    /// Rings of one snake, two or more.
    #[field(min_items = 2)]
    rings: Vec<Ring<T>>,
    /// Polynomial degree of the law.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BSubSnake<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let beads = self.rings.into_iter().map(|ring| ring.0).collect();
        redistributed(beads, self.degree, [Self::RINGS, Self::DEGREE])
    }
}

/// The parent curve of a bead's curve (the curve itself if it is not a part) and the bead's
/// parameter there.
fn whole<T: Real>(bead: &Bead<T>) -> (CurveRef<T>, T) {
    match &bead.curve.part_of {
        Some(part) => {
            let [from, to] = part.1;
            (part.0.clone(), between(from, to, bead.t))
        }
        None => (bead.curve.clone(), bead.t),
    }
}

/// (1 - t) from + t to: exact at both ends.
fn between<T: Real>(from: T, to: T, t: T) -> T {
    from * (-t + 1.0) + to * t
}

/// The curve of a shape along `curve`; on the same surface if that is a snake.
fn like<T: Real>(curve: &CurveRef<T>, shape: impl Curve<T> + 'static) -> CurveRef<T> {
    match &curve.surface {
        Some(surface) => CurveRef::snake(shape, (**surface).clone(), curve.depth),
        None => CurveRef::new(shape, curve.depth),
    }
}

fn part<T: Real>(from: Bead<T>, to: Bead<T>, field: FieldId) -> Result<Value<T>, CallError> {
    let along = common_curve([&from, &to], field)?;
    let marks = [&from, &to].map(|bead| Mark { t: bead.t, point: bead.key });
    let trace = match (along.trace(), along.key) {
        (Trace::Point(point), _) => Trace::Point(point),
        // A nameless curve is not a root and cannot be shared.
        (Trace::Own(_), None) => Trace::Own([from.key, to.key]),
        (trace, key) => {
            let root = key.map_or(Root::Curve(moldloft_num::trace::Key(u32::MAX)), Root::Curve);
            trace.part(root, marks[0], marks[1])
        }
    };
    // Parts of parts are parts of the whole, so that nesting does not grow.
    let ((curve, a), (_, b)) = (whole(&from), whole(&to));
    let law = SubParameter::Straight([a, b]);
    let mut found = like(&curve, GovernedCurve { curve: curve.clone(), law, trace });
    found.part_of = Some(Arc::new((curve, [a, b])));
    Ok(Value::Curve(found))
}

fn redistributed<T: Real>(
    beads: Vec<Bead<T>>,
    degree: usize,
    [list, number]: [FieldId; 2],
) -> Result<Value<T>, CallError> {
    let [first, rest @ ..] = beads.as_slice() else { return Err(too_few(0, list)) };
    let Some(last) = rest.last() else { return Err(too_few(1, list)) };
    for (k, bead) in rest.iter().enumerate() {
        common_curve([first, bead], list).map_err(|fault| fault.in_item(k + 1).in_field(list))?;
    }
    if beads.len() == 2 {
        return part(first.clone(), last.clone(), list);
    }
    let (curve, _) = whole(first);
    let coefficients = beads.iter().map(|b| Vec3::new(whole(b).1, T::zero(), T::zero())).collect();
    let law = BSplineCurve::uniform(degree.min(beads.len() - 1), coefficients)
        .map_err(|error| crate::faults::of_spline(error, list, number))?;
    let trace = Trace::Own([first.key, last.key]);
    Ok(Value::Curve(like(
        &curve,
        GovernedCurve { curve: curve.clone(), law: SubParameter::Spline(law), trace },
    )))
}

fn too_few(found: usize, field: FieldId) -> CallError {
    CallError::new("too-few-items", "a law needs at least 2 beads")
        .expected("at least 2 beads")
        .found(found.to_string())
        .in_field(field)
}

/// Parameter of the parent curve as a function of its own.
enum SubParameter<T> {
    /// Linear from the first to the second.
    Straight([T; 2]),
    /// The x of a spline.
    Spline(BSplineCurve<T>),
}

impl<T: Real> SubParameter<T> {
    /// The parameter and its derivatives.
    fn at(&self, t: T, order: Order) -> [T; 3] {
        match self {
            SubParameter::Straight([from, to]) => [between(*from, *to, t), *to - *from, T::zero()],
            SubParameter::Spline(law) => law.jet(t, order).map(|p| p.x),
        }
    }
}

/// A curve reparametrised by a spline.
struct GovernedCurve<T: Real> {
    curve: CurveRef<T>,
    law: SubParameter<T>,
    trace: Trace<T>,
}

impl<T: Real> GovernedCurve<T> {
    fn chained(&self, [_, rate, bend]: [T; 3], [p, d, dd]: CurveJet<T>) -> CurveJet<T> {
        [p, d * rate, dd * (rate * rate) + d * bend]
    }
}

/// Steps per span of the spline in the search for the curve's breaks.
const STEPS: usize = 8;

impl<T: Real> GovernedCurve<T> {
    /// Parameters at which it passes these parameters of the curve, and the breaks of the spline.
    fn passed(&self, own: &[f64]) -> Vec<f64> {
        let closed = self.curve.closed();
        let mut breaks = match &self.law {
            SubParameter::Straight([from, to]) => {
                let (from, to) = (from.re(), to.re());
                let passed = breaks_between(own, closed, from, to);
                passed.into_iter().map(|b| (b - from) / (to - from)).collect()
            }
            SubParameter::Spline(law) => {
                let mut breaks = law.breaks();
                let mut ends = vec![0.0];
                ends.extend(&breaks);
                ends.push(1.0);
                let at = |t: f64| self.law.at(T::from(t), Order::Zero)[0].re();
                // A spline stays between its coefficients.
                let reach = ends.iter().map(|t| at(*t));
                let low = reach.clone().fold(f64::INFINITY, f64::min);
                let high = reach.fold(f64::NEG_INFINITY, f64::max);
                let of_curve = breaks_between(own, closed, low - 1.0, high + 1.0);
                for span in ends.windows(2) {
                    let step = (span[1] - span[0]) / STEPS as f64;
                    for k in 0..STEPS {
                        let low = span[0] + k as f64 * step;
                        let reach = |b: &f64| find_root(|t| at(t) - b, low, low + step).ok();
                        breaks.extend(of_curve.iter().filter_map(reach));
                    }
                }
                breaks
            }
        };
        breaks.retain(|t| *t > 0.0 && *t < 1.0);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }
}

impl<T: Real> Curve<T> for GovernedCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let law = self.law.at(t, order);
        self.chained(law, self.curve.jet(law[0], order))
    }

    fn breaks(&self) -> Vec<f64> {
        self.passed(&self.curve.breaks())
    }

    fn kinks(&self) -> Vec<f64> {
        self.passed(&self.curve.kinks())
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        let law = self.law.at(t, order);
        Some(self.chained(law, self.curve.on_surface(law[0], order)?))
    }

    fn joints(&self) -> Vec<f64> {
        self.passed(&self.curve.joints())
    }

    moldloft_num::curve_facts!(open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}
