//! Truncated Taylor numbers: a value with its derivatives by one or two shape parameters.
//!
//! A kind writes its formula once, generic over [`Jet`]; instantiated with `T` it gives points,
//! with [`Uni1`]/[`Bi1`] first and with [`Uni2`]/[`Bi2`] second derivatives.

use crate::real::{Real, real_by_chain};
use crate::shape::{CurveJet, Order, SurfJet};
use crate::vec3::Vec3;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number in a shape's formula: the scalar `T` with derivatives by the shape parameters.
pub trait Jet<T: Real>: Real {
    /// Order of its derivatives.
    const ORDER: Order;
    /// A number that does not depend on the parameters.
    fn fixed(value: T) -> Self;
    /// The number without its derivatives by the parameters.
    fn value(self) -> T;
    /// The product with a scalar that does not depend on the parameters; cheaper than `*`.
    fn scaled(self, factor: T) -> Self;
}

impl<T: Real> Jet<T> for T {
    const ORDER: Order = Order::Zero;
    #[inline(always)]
    fn fixed(value: T) -> Self {
        value
    }
    #[inline(always)]
    fn value(self) -> T {
        self
    }
    #[inline(always)]
    fn scaled(self, factor: T) -> Self {
        self * factor
    }
}

/// The position of a curve at a parameter that is itself a jet, from the curve's own jet at
/// `t.value()`: the chain rule by Taylor's formula, exact to the order of `J`.
#[inline(always)]
pub fn lift_curve<T: Real, J: Jet<T>>(jet: &CurveJet<T>, t: J) -> Vec3<J> {
    let fixed = |v: Vec3<T>| v.map(J::fixed);
    if J::ORDER == Order::Zero {
        return fixed(jet[0]);
    }
    let dt = t - J::fixed(t.value());
    let mut x = fixed(jet[0]) + jet[1].map(|a| dt.scaled(a));
    if J::ORDER == Order::Second {
        let half = dt * dt * 0.5;
        x += jet[2].map(|a| half.scaled(a));
    }
    x
}

/// The position of a surface at parameters that are themselves jets; see [`lift_curve`].
#[inline(always)]
pub fn lift_surface<T: Real, J: Jet<T>>(jet: &SurfJet<T>, u: J, v: J) -> Vec3<J> {
    let fixed = |v: Vec3<T>| v.map(J::fixed);
    if J::ORDER == Order::Zero {
        return fixed(jet.p);
    }
    let (du, dv) = (u - J::fixed(u.value()), v - J::fixed(v.value()));
    let mut x = fixed(jet.p) + jet.u.map(|a| du.scaled(a)) + jet.v.map(|a| dv.scaled(a));
    if J::ORDER == Order::Second {
        let (uu, uv, vv) = (du * du * 0.5, du * dv, dv * dv * 0.5);
        x += jet.uu.map(|a| uu.scaled(a));
        x += jet.uv.map(|a| uv.scaled(a));
        x += jet.vv.map(|a| vv.scaled(a));
    }
    x
}

// In the browser the size of the download matters: there the compiler decides which operations of
// the larger numbers are inlined.
macro_rules! jet_type {
    ($(#[$doc:meta])* $name:ident, $order:expr, [$($part:ident),*], chain = |$x:ident, $d1:ident, $d2:ident| [$($chain:expr),*], times = |$a:ident, $b:ident| [$($times:expr),*]) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name<T> {
            /// The value.
            pub f: T,
            $(
                #[doc = concat!("Derivative by ", stringify!($part), ".")]
                pub $part: T,
            )*
        }

        impl<T: Real> $name<T> {
            #[inline(always)]
            fn constant(f: T) -> Self { Self { f, $($part: T::zero()),* } }
            #[inline(always)]
            fn value(self) -> T { self.f }
            #[inline(always)]
            fn value_mut(&mut self) -> &mut T { &mut self.f }
            #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
            #[cfg_attr(target_arch = "wasm32", inline)]
            fn chain(self, f: T, $d1: T, $d2: T) -> Self {
                let $x = self;
                let _ = $d2;
                Self { f, $($part: $chain),* }
            }
            #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
            #[cfg_attr(target_arch = "wasm32", inline)]
            fn times(self, $b: Self) -> Self {
                let $a = self;
                Self { f: $a.f * $b.f, $($part: $times),* }
            }
            #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
            #[cfg_attr(target_arch = "wasm32", inline)]
            fn zip(self, o: Self, mut g: impl FnMut(T, T) -> T) -> Self {
                Self { f: g(self.f, o.f), $($part: g(self.$part, o.$part)),* }
            }
            #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
            #[cfg_attr(target_arch = "wasm32", inline)]
            fn map(self, mut g: impl FnMut(T) -> T) -> Self {
                Self { f: g(self.f), $($part: g(self.$part)),* }
            }
            const FIELDS: usize = [$(stringify!($part)),*].len() + 1;
            #[inline(always)]
            fn nth_part(self, k: usize) -> f64 {
                [self.f, $(self.$part),*][k / T::PARTS].part(k % T::PARTS)
            }
            #[inline(always)]
            fn of_parts(mut part: impl FnMut(usize) -> f64) -> Self {
                let mut begin = 0;
                let mut next = || {
                    let x = T::from_parts(|k| part(begin + k));
                    begin += T::PARTS;
                    x
                };
                Self { f: next(), $($part: next()),* }
            }
            fn all(self, g: impl Fn(T) -> bool) -> bool {
                g(self.f) $(&& g(self.$part))*
            }
        }

        real_by_chain!(
            impl[T: Real] $name<T>,
            base = T,
            parts = Self::FIELDS * T::PARTS,
            first_order = T::PARTS == 1 && matches!($order, Order::First)
        );

        impl<T: Real> Jet<T> for $name<T> {
            const ORDER: Order = $order;
            #[inline(always)]
            fn fixed(value: T) -> Self { Self::constant(value) }
            #[inline(always)]
            fn value(self) -> T { self.f }
            #[inline(always)]
            fn scaled(self, factor: T) -> Self { self.map(|a| a * factor) }
        }
    };
}

jet_type!(
    /// A value with its first derivative by `t`.
    Uni1, Order::First, [t],
    chain = |x, d1, d2| [d1 * x.t],
    times = |a, b| [a.t * b.f + a.f * b.t]
);

jet_type!(
    /// A value with its first and second derivative by `t`.
    Uni2, Order::Second, [t, tt],
    chain = |x, d1, d2| [d1 * x.t, d1 * x.tt + d2 * x.t * x.t],
    times = |a, b| [
        a.t * b.f + a.f * b.t,
        a.tt * b.f + a.t * b.t * 2.0 + a.f * b.tt
    ]
);

jet_type!(
    /// A value with its first derivatives by `u` and `v`.
    Bi1, Order::First, [u, v],
    chain = |x, d1, d2| [d1 * x.u, d1 * x.v],
    times = |a, b| [a.u * b.f + a.f * b.u, a.v * b.f + a.f * b.v]
);

jet_type!(
    /// A value with its first and second derivatives by `u` and `v`.
    Bi2, Order::Second, [u, v, uu, uv, vv],
    chain = |x, d1, d2| [
        d1 * x.u,
        d1 * x.v,
        d1 * x.uu + d2 * x.u * x.u,
        d1 * x.uv + d2 * x.u * x.v,
        d1 * x.vv + d2 * x.v * x.v
    ],
    times = |a, b| [
        a.u * b.f + a.f * b.u,
        a.v * b.f + a.f * b.v,
        a.uu * b.f + a.u * b.u * 2.0 + a.f * b.uu,
        a.uv * b.f + a.u * b.v + a.v * b.u + a.f * b.uv,
        a.vv * b.f + a.v * b.v * 2.0 + a.f * b.vv
    ]
);

jet_type!(
    /// A value with its first derivatives by `u`, `v` and `w`.
    Tri1, Order::First, [u, v, w],
    chain = |x, d1, d2| [d1 * x.u, d1 * x.v, d1 * x.w],
    times = |a, b| [a.u * b.f + a.f * b.u, a.v * b.f + a.f * b.v, a.w * b.f + a.f * b.w]
);

impl<T: Real> Tri1<T> {
    /// The parameters of a solid, as jets.
    pub fn parameters(u: T, v: T, w: T) -> [Self; 3] {
        let (z, one) = (Self::default(), T::one());
        [Self { f: u, u: one, ..z }, Self { f: v, v: one, ..z }, Self { f: w, w: one, ..z }]
    }
}

impl<T: Real> Uni1<T> {
    /// The curve parameter itself.
    pub fn parameter(t: T) -> Self {
        Self { f: t, t: T::one() }
    }
}

impl<T: Real> Uni2<T> {
    /// The curve parameter itself.
    pub fn parameter(t: T) -> Self {
        Self { f: t, t: T::one(), tt: T::zero() }
    }
}

impl<T: Real> Bi1<T> {
    /// The surface parameters themselves.
    pub fn parameters(u: T, v: T) -> (Self, Self) {
        (Self { f: u, u: T::one(), v: T::zero() }, Self { f: v, u: T::zero(), v: T::one() })
    }
}

impl<T: Real> Bi2<T> {
    /// The surface parameters themselves.
    pub fn parameters(u: T, v: T) -> (Self, Self) {
        let z = Self::default();
        (Self { f: u, u: T::one(), ..z }, Self { f: v, v: T::one(), ..z })
    }
}

/// The curve jet of a formula `at(t)`, computed to the requested order.
#[doc(hidden)]
#[macro_export]
macro_rules! curve_jet_of {
    ($self:expr, $at:path, $t:expr, $order:expr) => {{
        let (shape, t, order) = ($self, $t, $order);
        match order {
            $crate::Order::Zero => {
                let p = $at(shape, t);
                [p, $crate::Vec3::zero(), $crate::Vec3::zero()]
            }
            $crate::Order::First => {
                let p = $at(shape, $crate::Uni1::parameter(t));
                [p.map(|a| a.f), p.map(|a| a.t), $crate::Vec3::zero()]
            }
            $crate::Order::Second => {
                let p = $at(shape, $crate::Uni2::parameter(t));
                [p.map(|a| a.f), p.map(|a| a.t), p.map(|a| a.tt)]
            }
        }
    }};
}

/// The surface jet of a formula `at(u, v)`, computed to the requested order.
#[doc(hidden)]
#[macro_export]
macro_rules! surface_jet_of {
    ($self:expr, $at:path, $u:expr, $v:expr, $order:expr) => {{
        let (shape, u, v, order) = ($self, $u, $v, $order);
        match order {
            $crate::Order::Zero => $crate::SurfJet { p: $at(shape, u, v), ..Default::default() },
            $crate::Order::First => {
                let (u, v) = $crate::Bi1::parameters(u, v);
                let p = $at(shape, u, v);
                $crate::SurfJet {
                    p: p.map(|a| a.f),
                    u: p.map(|a| a.u),
                    v: p.map(|a| a.v),
                    ..Default::default()
                }
            }
            $crate::Order::Second => {
                let (u, v) = $crate::Bi2::parameters(u, v);
                let p = $at(shape, u, v);
                $crate::SurfJet {
                    p: p.map(|a| a.f),
                    u: p.map(|a| a.u),
                    v: p.map(|a| a.v),
                    uu: p.map(|a| a.uu),
                    uv: p.map(|a| a.uv),
                    vv: p.map(|a| a.vv),
                }
            }
        }
    }};
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_derivatives_follow_the_chain_rule() {
        // f(u, v) = sin(u v) exp(u) / v, by hand.
        let (u0, v0) = (0.3f64, 1.7f64);
        let (u, v) = Bi2::parameters(u0, v0);
        let f = (u * v).sin() * u.exp() / v;
        let (s, c, e) = ((u0 * v0).sin(), (u0 * v0).cos(), u0.exp());
        assert!((f.f - s * e / v0).abs() < 1e-15);
        assert!((f.u - (c * e + s * e / v0)).abs() < 1e-14);
        assert!((f.uu - (-v0 * s * e + 2.0 * c * e + s * e / v0)).abs() < 1e-14);
        assert!((f.v - e * (u0 * c / v0 - s / (v0 * v0))).abs() < 1e-14);
        let fuv = -u0 * s * e + u0 * c * e / v0 - s * e / (v0 * v0);
        assert!((f.uv - fuv).abs() < 1e-14, "{} {fuv}", f.uv);
    }

    #[test]
    fn parts_make_the_whole() {
        type J = Uni2<crate::Dual<2>>;
        assert_eq!((J::PARTS, J::FIRST_ORDER, Bi1::<f64>::FIRST_ORDER), (9, false, true));
        let x = J::from_parts(|k| k as f64);
        assert_eq!((x.f.eps, x.t.re, x.tt.eps[1]), ([1.0, 2.0], 3.0, 8.0));
        assert!((0..9).all(|k| x.part(k) == k as f64));
    }

    #[test]
    fn lifting_a_curve_is_the_chain_rule() {
        // x(t) = t^3 at t = u v.
        let (u, v) = Bi2::parameters(0.5f64, 0.8);
        let t = u * v;
        let t0 = t.f;
        let jet: CurveJet<f64> = [
            Vec3::of(t0.powi(3), 0.0, 0.0),
            Vec3::of(3.0 * t0 * t0, 0.0, 0.0),
            Vec3::of(6.0 * t0, 0.0, 0.0),
        ];
        let (lifted, direct) = (lift_curve(&jet, t).x, t.powi(3));
        for (a, b) in [(lifted.u, direct.u), (lifted.uu, direct.uu), (lifted.uv, direct.uv)] {
            assert!((a - b).abs() < 1e-14);
        }
    }
}
