//! Curves of piecewise cubics run at constant speed.

use crate::PiecewiseCubic;
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3, integrate};
use std::iter::once;

/// A piecewise cubic curve with constant speed: the point at `t` is at the fraction `t` of the
/// total length.
///
/// The parts are joined end to end; where two of them meet, derivatives may jump. Lengths are
/// integrals of |C'| to about 1e-13 of the whole, so stations are true positions on the curve, not
/// approximations by chords. Outside [0, 1] it continues as its second-order Taylor polynomial at
/// that end.
///
/// # Example
/// ```
/// use moldloft_num::{Curve, Order, Vec3};
/// use moldloft_spline::{ByArclen, InterpolatingSpline};
/// let points = [[0., 0., 0.], [1., 1., 0.], [4., 0., 0.]].map(Vec3::from);
/// let spline = InterpolatingSpline::<f64>::through(&points).unwrap();
/// let even = ByArclen::of(vec![spline.pieces().clone()]).unwrap();
/// let speed = |t: f64| even.jet(t, Order::First)[1].norm();
/// assert!((speed(0.1) - speed(0.9)).abs() < 1e-12 * speed(0.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ByArclen<T: Real> {
    /// The polynomials: coefficients of 1, s, s^2, s^3 from the start of each.
    spans: Vec<[Vec3<T>; 4]>,
    /// Interval of s of each.
    widths: Vec<T>,
    /// The length before each span, and the whole at the end.
    before: Vec<T>,
    end: Vec3<T>,
    breaks: Vec<f64>,
}

/// Tolerance of lengths, relative to the whole length.
const SHARE: f64 = 1e-14;

impl<T: Real> ByArclen<T> {
    /// The curve composed of these parts; `None` if it has no length.
    pub fn of(parts: Vec<PiecewiseCubic<T>>) -> Option<Self> {
        let (mut spans, mut widths) = (Vec::new(), Vec::new());
        let mut end = Vec3::zero();
        for part in &parts {
            let (knots, coefficients) = (part.knots(), part.coefficients());
            for k in 0..knots.len() - 1 {
                spans.push(coefficients[k]);
                widths.push(knots[k + 1] - knots[k]);
            }
            end = coefficients[knots.len() - 1][0];
        }
        let mut rough = 0.0;
        for (span, width) in spans.iter().zip(&widths) {
            rough += span[0].re().distance(polynomial(span, *width, Order::Zero)[0].re());
        }
        if !(rough > 0.0 && rough.is_finite()) {
            return None;
        }
        let mut total = T::zero();
        let lengths = spans.iter().zip(&widths).map(|(span, width)| {
            total += length(span, *width, SHARE * rough);
            total
        });
        let before: Vec<T> = once(T::zero()).chain(lengths).collect();
        let breaks = before[1..before.len() - 1].iter().map(|b| b.re() / total.re()).collect();
        Some(Self { spans, widths, before, end, breaks })
    }

    /// The whole length.
    pub fn length(&self) -> T {
        self.before[self.before.len() - 1]
    }

    /// The span at the length `along`, and the parameter in that span.
    fn place(&self, along: T) -> (usize, T) {
        let (s, last) = (along.re(), self.spans.len() - 1);
        let inner = &self.before[1..=last];
        let k = inner.partition_point(|b| b.re() <= s);
        let (span, rest) = (&self.spans[k], along - self.before[k]);
        let (width, all) = (self.widths[k].re(), (self.before[k + 1] - self.before[k]).re());
        let (mut low, mut high) = (0.0, width);
        let mut x = (width * rest.re() / all).clamp(low, high);
        let plain = span.map(Vec3::re);
        let accuracy = SHARE * self.length().re();
        // Newton between brackets; arc length is monotone, so this ends within a few steps.
        for _ in 0..64 {
            let ahead = length(&plain, x, accuracy) - rest.re();
            if ahead.abs() <= accuracy || low >= high {
                break;
            }
            if ahead > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let speed = polynomial(&plain, x, Order::First)[1].norm();
            let next = x - ahead / speed;
            let next = if low < next && next < high { next } else { 0.5 * (low + high) };
            if next == x {
                break;
            }
            x = next;
        }
        if T::PARTS == 1 || (along.is_constant() && self.is_constant()) {
            return (k, T::from(x));
        }
        let residual = rest - length(span, T::from(x), accuracy);
        let speed = polynomial(&plain, x, Order::First)[1].norm();
        (k, if speed > 0.0 { (residual - residual.re()) / speed + x } else { T::from(x) })
    }

    fn is_constant(&self) -> bool {
        let constant = |v: &Vec3<T>| v.to_array().iter().all(|x| x.is_constant());
        self.spans.iter().flatten().all(constant) && self.widths.iter().all(|w| w.is_constant())
    }

    /// Jet at a parameter within [0, 1].
    fn inside(&self, t: T, order: Order) -> CurveJet<T> {
        let total = self.length();
        let (k, x) = self.place(t * total);
        let [p, d, dd] = polynomial(&self.spans[k], x, order);
        let mut jet = [p, Vec3::zero(), Vec3::zero()];
        if order == Order::Zero {
            return jet;
        }
        let square = d.norm_sq();
        // At a cusp there is no direction; it stays zero.
        if square.re() > 0.0 {
            jet[1] = d * (total / square.sqrt());
            if order == Order::Second {
                let rate = total * total / square;
                jet[2] = (dd - d * (d.dot(dd) / square)) * rate;
            }
        }
        jet
    }
}

/// Position and derivatives of a cubic at `s`.
fn polynomial<T: Real>([a, b, c, d]: &[Vec3<T>; 4], s: T, order: Order) -> CurveJet<T> {
    let mut jet = [((*d * s + *c) * s + *b) * s + *a, Vec3::zero(), Vec3::zero()];
    if order >= Order::First {
        jet[1] = (*d * (s * 3.0) + c.map(|x| x * 2.0)) * s + *b;
    }
    if order == Order::Second {
        jet[2] = *d * (s * 6.0) + c.map(|x| x * 2.0);
    }
    jet
}

fn length<T: Real>(span: &[Vec3<T>; 4], width: T, accuracy: f64) -> T {
    // A straight span with even speed: no integral needed, and none of its rounding.
    let flat = |v: &Vec3<T>| v.to_array().iter().all(|x| x.bits_eq(T::zero()));
    if flat(&span[2]) && flat(&span[3]) {
        return span[1].norm() * width;
    }
    integrate(T::zero(), width, accuracy, |s| polynomial(span, s, Order::First)[1].norm())
}

impl<T: Real> Curve<T> for ByArclen<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let at = t.re();
        if at > 0.0 && at < 1.0 {
            return self.inside(t, order);
        }
        let nearest = if at > 0.0 { T::one() } else { T::zero() };
        let mut jet = self.inside(nearest, Order::Second);
        if at > 0.0 {
            jet[0] = self.end;
        }
        // Nothing to add at the end itself, whose point is the given one to the bit.
        if !(t - nearest).bits_eq(T::zero()) {
            let (step, [p, d, dd]) = (t - nearest, jet);
            jet = [p + (d + dd * (step * 0.5)) * step, d + dd * step, dd];
        }
        for derivative in &mut jet[1 + order as usize..] {
            *derivative = Vec3::zero();
        }
        jet
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.clone()
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}
