//! Primitives: expressions of planes and reals, immutable and shared.

use crate::expr::algebra::{Hessian, Unary, ValueGradient};
use crate::expr::form::Form;
use crate::expr::interval::Interval;
use crate::expr::oracle::{Affine, Oracle};
use crate::expr::tape::ExprTape;
use crate::{FieldError, error};
use moldloft_num::{Box3, Field, Plane, Real, Vec3};
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::{Arc, OnceLock};

/// A function of two primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// Sum.
    Add,
    /// Difference.
    Sub,
    /// Product.
    Mul,
    /// The smaller.
    Min,
    /// The larger.
    Max,
    /// The angle of the point (second, first).
    Atan2,
    /// Quotient.
    Div,
    /// The remainder x - y floor(x / y).
    Mod,
}

/// Operation of a node.
pub(crate) enum Op<T: Real> {
    Real(T),
    Plane {
        normal: Vec3<T>,
        offset: T,
    },
    /// The map is apart: few are from outside, and all expressions would be as large.
    User {
        oracle: Arc<dyn Oracle<T>>,
        map: Box<Affine<T>>,
    },
    Unary(Unary, Primitive<T>),
    Over(Primitive<T>, T),
    Power(Primitive<T>, u32),
    Binary(Binary, Primitive<T>, Primitive<T>),
}

pub(crate) struct PrimitiveNode<T: Real> {
    pub(crate) op: Op<T>,
    /// Form, if known beyond the operation.
    form: OnceLock<Box<Form<T>>>,
    degree: u32,
    /// By which different expressions mostly differ.
    pub(crate) fingerprint: u64,
    tape: OnceLock<Arc<ExprTape<T>>>,
}

impl<T: Real> PrimitiveNode<T> {
    fn remember(&mut self, form: Form<T>) {
        let says = matches!(self.op, Op::Real(_) | Op::Plane { .. } | Op::Unary(Unary::Neg, _));
        self.form = match form {
            // Most are that, without a word.
            Form::General if !says => OnceLock::new(),
            form => OnceLock::from(Box::new(form)),
        };
    }
}

fn plane_form<T: Real>(normal: Vec3<T>, offset: T) -> Form<T> {
    match normal.normalized() {
        Some(unit) => {
            let point = normal * -(offset / normal.norm_sq());
            Form::Plane(Plane { point, normal: unit })
        }
        None => Form::General,
    }
}

/// An implicit function f(x, y, z): solid where it is negative, surface where it is zero, air where it
/// is positive.
///
/// Primitives are made from planes and reals by arithmetic, so every affine map of a primitive is the
/// same expression of mapped planes. They are immutable and share their parts; those that were made as
/// a sphere, cylinder, cone, torus or cyclide remember it, and so do their complements
/// ([`Primitive::form`]).
///
/// # Example
/// ```
/// use moldloft_field::Primitive;
/// use moldloft_num::Vec3;
///
/// let [x, y, _] = Primitive::<f64>::axes();
/// let cylinder = x.power(2) + y.power(2) - 4.0;
/// assert_eq!(cylinder.value(Vec3::of(1.0, 1.0, 7.0)), -2.0);
/// assert_eq!(cylinder.gradient(Vec3::of(1.0, 1.0, 7.0)).slope, Vec3::of(2.0, 2.0, 0.0));
/// assert_eq!(cylinder.degree(), 2);
/// ```
#[derive(Clone)]
pub struct Primitive<T: Real = f64>(pub(crate) Arc<PrimitiveNode<T>>);

impl<T: Real> Op<T> {
    fn take_children(&mut self) -> [Option<Primitive<T>>; 2] {
        match std::mem::replace(self, Op::Real(T::zero())) {
            Op::Unary(_, a) | Op::Over(a, _) | Op::Power(a, _) => [Some(a), None],
            Op::Binary(_, a, b) => [Some(a), Some(b)],
            _ => [None, None],
        }
    }

    fn fingerprint(&self) -> u64 {
        let mut h = FxHasher::default();
        std::mem::discriminant(self).hash(&mut h);
        let mut number = |x: T| x.re().to_bits().hash(&mut h);
        match self {
            Op::Real(c) | Op::Over(_, c) => number(*c),
            Op::Plane { normal, offset } => {
                (0..3).for_each(|k| number(normal[k]));
                number(*offset);
            }
            Op::User { oracle, .. } => Arc::as_ptr(oracle).cast::<()>().hash(&mut h),
            Op::Unary(f, _) => f.hash(&mut h),
            Op::Power(_, n) => n.hash(&mut h),
            Op::Binary(f, ..) => f.hash(&mut h),
        }
        self.children().into_iter().flatten().for_each(|c| c.0.fingerprint.hash(&mut h));
        h.finish()
    }

    /// The operands, in order.
    pub(crate) fn children(&self) -> [Option<&Primitive<T>>; 2] {
        match self {
            Op::Unary(_, a) | Op::Over(a, _) | Op::Power(a, _) => [Some(a), None],
            Op::Binary(_, a, b) => [Some(a), Some(b)],
            _ => [None, None],
        }
    }
}

impl<T: Real> Drop for PrimitiveNode<T> {
    /// Long chains are taken apart in a loop: recursion would overflow the stack.
    fn drop(&mut self) {
        let mut pending: Vec<Primitive<T>> =
            self.op.take_children().into_iter().flatten().collect();
        while let Some(Primitive(node)) = pending.pop() {
            if let Some(mut node) = Arc::into_inner(node) {
                pending.extend(node.op.take_children().into_iter().flatten());
            }
        }
    }
}

impl<T: Real> Primitive<T> {
    pub(crate) fn from_op(op: Op<T>) -> Self {
        let degree = match &op {
            Op::Real(_) => 0,
            Op::Plane { .. } => 1,
            Op::User { .. } => 100,
            Op::Unary(Unary::Neg, a) | Op::Over(a, _) => a.degree(),
            Op::Unary(_, a) => a.degree().saturating_add(1),
            Op::Power(a, n) => a.degree().saturating_mul(*n),
            Op::Binary(Binary::Mul, a, b) => a.degree().saturating_add(b.degree()),
            Op::Binary(Binary::Atan2, a, b) => a.degree().max(b.degree()).saturating_add(1),
            Op::Binary(_, a, b) => a.degree().max(b.degree()),
        };
        let fingerprint = op.fingerprint();
        let (form, tape) = (OnceLock::new(), OnceLock::new());
        Self(Arc::new(PrimitiveNode { op, form, degree, fingerprint, tape }))
    }

    /// The same function, remembered as `form`.
    pub(crate) fn remembered(self, form: Form<T>) -> Self {
        match Arc::try_unwrap(self.0) {
            Ok(mut node) => {
                // The torus's square root is a shorthand of its quartic.
                node.degree = if matches!(form, Form::Torus { .. }) { 4 } else { node.degree };
                node.remember(form);
                Self(Arc::new(node))
            }
            // Somebody else holds it: a new node for the same expression, times one.
            Err(shared) => {
                let op = Op::Over(Self(shared), T::one());
                let mut node = Self::from_op(op);
                if let Some(inner) = Arc::get_mut(&mut node.0) {
                    inner.remember(form);
                }
                node
            }
        }
    }

    /// A constant.
    pub fn real(value: T) -> Self {
        Self::from_op(Op::Real(value))
    }

    /// The coordinates x, y and z.
    pub fn axes() -> [Self; 3] {
        Affine::identity().rows.map(|n| Self::linear(n, T::zero()))
    }

    /// `normal` . X + `offset`; the normal need not be a unit vector.
    pub fn linear(normal: Vec3<T>, offset: T) -> Self {
        let constant = normal.re() == Vec3::zero() && (0..3).all(|k| normal[k].is_constant());
        if constant { Self::real(offset) } else { Self::from_op(Op::Plane { normal, offset }) }
    }

    /// The half-space behind the plane through `point`: the distance from it, positive on the side to
    /// which `normal` points.
    ///
    /// # Errors
    /// A normal without direction; numbers that are not finite.
    pub fn plane(normal: Vec3<T>, point: Vec3<T>) -> Result<Self, FieldError> {
        let normal = error::unit("normal", normal)?;
        let point = error::finite("point", point)?;
        Ok(Self::linear(normal, -normal.dot(point)))
    }

    /// A primitive from outside.
    pub fn user(oracle: Arc<dyn Oracle<T>>) -> Self {
        Self::from_op(Op::User { oracle, map: Box::new(Affine::identity()) })
    }

    fn as_real(&self) -> Option<T> {
        match self.0.op {
            Op::Real(c) => Some(c),
            _ => None,
        }
    }

    fn as_plane(&self) -> Option<(Vec3<T>, T)> {
        match self.0.op {
            Op::Plane { normal, offset } => Some((normal, offset)),
            _ => None,
        }
    }

    fn unary(&self, f: Unary) -> Self {
        match &self.0.op {
            Op::Real(c) => Self::real(f.of(*c)),
            Op::Unary(Unary::Neg, inner) if f == Unary::Neg => inner.clone(),
            Op::Plane { normal, offset } if f == Unary::Neg => Self::linear(-*normal, -*offset),
            _ => Self::from_op(Op::Unary(f, self.clone())),
        }
    }

    fn binary(&self, f: Binary, o: &Self) -> Self {
        if let (Some(a), Some(b)) = (self.as_real(), o.as_real()) {
            return Self::real(match f {
                Binary::Add => a + b,
                Binary::Sub => a - b,
                Binary::Mul => a * b,
                Binary::Min => a.min(b),
                Binary::Max => a.max(b),
                Binary::Atan2 => a.atan2(b),
                Binary::Div => a / b,
                Binary::Mod => crate::expr::algebra::remainder(a, b),
            });
        }
        let line = |p: &Self| p.as_plane().or_else(|| Some((Vec3::zero(), p.as_real()?)));
        match (f, line(self), line(o)) {
            (Binary::Add, Some((n, d)), Some((m, e))) => return Self::linear(n + m, d + e),
            (Binary::Sub, Some((n, d)), Some((m, e))) => return Self::linear(n - m, d - e),
            (Binary::Mul, Some((n, d)), _) if o.as_real().is_some() => {
                let c = o.as_real().unwrap_or_default();
                return Self::linear(n * c, d * c);
            }
            (Binary::Mul, _, Some(_)) if self.as_real().is_some() => return o.binary(f, self),
            (Binary::Mul, ..) if Arc::ptr_eq(&self.0, &o.0) => return self.power(2),
            _ => {}
        }
        Self::from_op(Op::Binary(f, self.clone(), o.clone()))
    }

    /// The absolute value: a sheet, with no solid side. Its slope on the sheet is that of `self`.
    pub fn abs(&self) -> Self {
        self.unary(Unary::Abs)
    }
    /// 1 where it is positive, else -1.
    pub fn sign(&self) -> Self {
        self.unary(Unary::Sign)
    }
    /// Square root; zero where it is negative.
    pub fn sqrt(&self) -> Self {
        self.unary(Unary::Sqrt)
    }
    /// sgn(f) sqrt|f|. This is not a distance: its slope on the surface is unbounded.
    pub fn s_sqrt(&self) -> Self {
        self.unary(Unary::SignedSqrt)
    }
    /// Sine, of radians.
    pub fn sin(&self) -> Self {
        self.unary(Unary::Sin)
    }
    /// Cosine, of radians.
    pub fn cos(&self) -> Self {
        self.unary(Unary::Cos)
    }
    /// Exponential.
    pub fn exp(&self) -> Self {
        self.unary(Unary::Exp)
    }
    /// Natural logarithm, defined where the primitive is positive.
    pub fn ln(&self) -> Self {
        self.unary(Unary::Ln)
    }
    /// Tangent, of radians.
    pub fn tan(&self) -> Self {
        self.unary(Unary::Tan)
    }
    /// The smaller of two.
    pub fn min(&self, o: &Self) -> Self {
        self.binary(Binary::Min, o)
    }
    /// The larger of two.
    pub fn max(&self, o: &Self) -> Self {
        self.binary(Binary::Max, o)
    }
    /// The angle of the point (`x`, `self`), in (-pi, pi].
    pub fn atan2(&self, x: &Self) -> Self {
        self.binary(Binary::Atan2, x)
    }

    /// A whole power.
    pub fn power(&self, n: u32) -> Self {
        match (n, &self.0.op) {
            (0, _) => Self::real(T::one()),
            (1, _) => self.clone(),
            (_, Op::Real(c)) => Self::real(crate::expr::algebra::power(*c, n)),
            _ => Self::from_op(Op::Power(self.clone(), n)),
        }
    }

    /// A power whose exponent is a number.
    ///
    /// # Errors
    /// [`FieldError::Exponent`] unless it is whole, from 0 to 1000.
    pub fn to_power(&self, exponent: f64) -> Result<Self, FieldError> {
        if exponent.fract() == 0.0 && (0.0..=1000.0).contains(&exponent) {
            Ok(self.power(exponent as u32))
        } else {
            Err(FieldError::Exponent { value: exponent })
        }
    }

    /// The quotient. It has a pole at zeros of the divisor; facets that meet one are an error with
    /// its position.
    ///
    /// # Errors
    /// [`FieldError::Division`] when the divisor is zero everywhere.
    pub fn over(&self, divisor: &Self) -> Result<Self, FieldError> {
        match divisor.as_real() {
            Some(c) if c.re() != 0.0 && c.is_finite() => Ok(self / c),
            Some(_) => Err(FieldError::Division),
            None => Ok(self.binary(Binary::Div, divisor)),
        }
    }

    /// The remainder x - y floor(x / y): x repeated with the period y.
    ///
    /// # Errors
    /// [`FieldError::Division`] when the divisor is zero everywhere.
    pub fn remainder(&self, divisor: &Self) -> Result<Self, FieldError> {
        match divisor.as_real() {
            Some(c) if c.re() == 0.0 || !c.is_finite() => Err(FieldError::Division),
            _ => Ok(self.binary(Binary::Mod, divisor)),
        }
    }

    /// Constructor with dimensions.
    pub fn form(&self) -> &Form<T> {
        let mut node = self;
        loop {
            if let Some(form) = node.0.form.get() {
                return form;
            }
            match &node.0.op {
                // The complement of a ball has the ball's surface.
                Op::Unary(Unary::Neg, inner) => node = inner,
                Op::Real(c) => return node.0.form.get_or_init(|| Box::new(Form::Real(*c))),
                Op::Plane { normal, offset } => {
                    return node.0.form.get_or_init(|| Box::new(plane_form(*normal, *offset)));
                }
                _ => return &Form::General,
            }
        }
    }

    /// The degree of the polynomial, counted as in svLis: reals 0, planes 1, sums the maximum,
    /// products the sum, functions one more, external primitives 100.
    pub fn degree(&self) -> u32 {
        self.0.degree
    }

    /// The compiled expression.
    pub(crate) fn tape(&self) -> &Arc<ExprTape<T>> {
        self.0.tape.get_or_init(|| Arc::new(ExprTape::of_primitive(self)))
    }

    /// The value at a point.
    pub fn value(&self, p: Vec3<T>) -> T {
        self.tape().eval::<T>(&p, &mut Vec::new())
    }

    /// The value and the exact gradient at a point.
    pub fn gradient(&self, p: Vec3<T>) -> ValueGradient<T> {
        self.tape().eval::<ValueGradient<T>>(&p, &mut Vec::new())
    }

    /// The value, the exact gradient and the exact second derivatives at a point.
    pub fn hessian(&self, p: Vec3<T>) -> Hessian<T> {
        self.tape().eval::<Hessian<T>>(&p, &mut Vec::new())
    }

    /// True when both are the same expression of the same numbers.
    pub fn same(&self, o: &Self) -> bool {
        Arc::ptr_eq(&self.0, &o.0) || self.tape().same(o.tape())
    }

    /// True for a sheet: the absolute value of a primitive, or its complement.
    pub fn is_sheet(&self) -> bool {
        !std::ptr::eq(self.of_sheet(), self)
    }

    /// The argument of a sheet's absolute value; the primitive itself if it is not a sheet.
    pub fn of_sheet(&self) -> &Self {
        match &self.0.op {
            Op::Unary(Unary::Abs, inner) => inner,
            Op::Unary(Unary::Neg, outer) => match &outer.0.op {
                Op::Unary(Unary::Abs, inner) => inner,
                _ => self,
            },
            _ => self,
        }
    }

    /// Address of its node; unique while the node lives.
    pub(crate) fn identity(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    pub(crate) fn operation(&self) -> &Op<T> {
        &self.0.op
    }

    /// Its value if it is constant.
    pub fn constant_value(&self) -> Option<f64> {
        self.as_real().map(T::re)
    }

    /// True if its value is the same at all points.
    pub fn is_constant(&self) -> bool {
        self.as_real().is_some()
    }

    /// The expression with every plane, form and primitive from outside replaced.
    pub(crate) fn rebuilt<S: Real>(
        &self,
        real: &dyn Fn(T) -> S,
        leaf: &dyn Fn(&Op<T>) -> Primitive<S>,
        form: &dyn Fn(&Form<T>) -> Form<S>,
    ) -> Primitive<S> {
        // Children first, each once, without recursion.
        let order = crate::expr::tape::order(self);
        let mut made: std::collections::HashMap<*const PrimitiveNode<T>, Primitive<S>> =
            Default::default();
        for node in &order {
            let of = |p: &Primitive<T>| made[&Arc::as_ptr(&p.0)].clone();
            let op = match &node.0.op {
                Op::Unary(f, a) => Op::Unary(*f, of(a)),
                Op::Over(a, c) => Op::Over(of(a), real(*c)),
                Op::Power(a, n) => Op::Power(of(a), *n),
                Op::Binary(f, a, b) => Op::Binary(*f, of(a), of(b)),
                other => {
                    made.insert(Arc::as_ptr(&node.0), leaf(other));
                    continue;
                }
            };
            let mut new = Primitive::from_op(op);
            if let Some(inner) = Arc::get_mut(&mut new.0) {
                inner.remember(form(node.form()));
            }
            made.insert(Arc::as_ptr(&node.0), new);
        }
        made[&Arc::as_ptr(&self.0)].clone()
    }

    /// The primitive with real parts only.
    pub fn re(&self) -> Primitive<f64> {
        let any: &dyn std::any::Any = self;
        if let Some(plain) = any.downcast_ref::<Primitive<f64>>() {
            return plain.clone();
        }
        self.rebuilt(
            &|c| c.re(),
            &|op| match op {
                Op::Plane { normal, offset } => Primitive::linear(normal.re(), offset.re()),
                Op::User { oracle, map } => {
                    Primitive::from_op(Op::User { oracle: oracle.re(), map: Box::new(map.re()) })
                }
                Op::Real(c) => Primitive::real(c.re()),
                _ => unreachable!("leaves only"),
            },
            &|form| form.re(),
        )
    }
}

impl Primitive<f64> {
    /// The same function in numbers with derivatives; it depends on no parameter.
    pub fn constant<S: Real>(&self) -> Primitive<S> {
        self.rebuilt(
            &|c| S::from(c),
            &|op| match op {
                Op::Plane { normal, offset } => {
                    Primitive::linear(Vec3::lifted(*normal), S::from(*offset))
                }
                Op::User { oracle, map } => Primitive::from_op(Op::User {
                    oracle: Arc::new(crate::Constant(oracle.clone())),
                    map: Box::new(Affine {
                        rows: map.rows.map(Vec3::lifted),
                        shift: Vec3::lifted(map.shift),
                    }),
                }),
                Op::Real(c) => Primitive::real(S::from(*c)),
                _ => unreachable!("leaves only"),
            },
            &|form| form.constant(),
        )
    }

    /// A range of the values over a box: the plain interval value and the mean-value form, both
    /// rounded outward, whichever is tighter at each end.
    pub fn range(&self, over: &Box3) -> Interval {
        self.gradient_range(over).value
    }

    /// Ranges of value and gradient over a box; the value is tightened as in [`Primitive::range`].
    pub fn gradient_range(&self, over: &Box3) -> crate::expr::algebra::GradientRange {
        self.tape().mean_value(&crate::expr::interval::sides(over), &mut Default::default())
    }

    /// The values at many points.
    pub fn values(&self, points: &[Vec3], out: &mut [f64]) {
        self.tape().bulk(points, out, &mut Default::default());
    }
}

impl<T: Real> Field<T> for Primitive<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let g = self.gradient(p);
        (g.value, g.slope)
    }
    fn value(&self, p: Vec3<T>) -> T {
        Primitive::value(self, p)
    }
    fn second_order(&self, p: Vec3<T>) -> (T, Vec3<T>, [Vec3<T>; 3]) {
        let h = self.hessian(p);
        (h.value, h.slope, h.second)
    }
    fn bounds(&self, over: &Box3) -> Option<[f64; 2]> {
        let any: &dyn std::any::Any = self;
        let plain = any.downcast_ref::<Primitive<f64>>()?;
        let range = plain.range(over);
        Some([range.low, range.high])
    }
}

impl<T: Real> std::fmt::Debug for Primitive<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} of degree {}", self.form().name(), self.degree())
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $binary:expr) => {
        impl<T: Real> $trait<&Primitive<T>> for &Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: &Primitive<T>) -> Primitive<T> {
                self.binary($binary, o)
            }
        }
        impl<T: Real> $trait for Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: Primitive<T>) -> Primitive<T> {
                self.binary($binary, &o)
            }
        }
        impl<T: Real> $trait<&Primitive<T>> for Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: &Primitive<T>) -> Primitive<T> {
                self.binary($binary, o)
            }
        }
        impl<T: Real> $trait<Primitive<T>> for &Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: Primitive<T>) -> Primitive<T> {
                self.binary($binary, &o)
            }
        }
        impl<T: Real> $trait<T> for Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: T) -> Primitive<T> {
                self.binary($binary, &Primitive::real(o))
            }
        }
        impl<T: Real> $trait<T> for &Primitive<T> {
            type Output = Primitive<T>;
            fn $method(self, o: T) -> Primitive<T> {
                self.binary($binary, &Primitive::real(o))
            }
        }
    };
}
operator!(Add, add, Binary::Add);
operator!(Sub, sub, Binary::Sub);
operator!(Mul, mul, Binary::Mul);

impl<T: Real> Div<T> for &Primitive<T> {
    type Output = Primitive<T>;
    fn div(self, c: T) -> Primitive<T> {
        match self.0.op {
            Op::Real(a) => Primitive::real(a / c),
            Op::Plane { normal, offset } => Primitive::linear(normal / c, offset / c),
            _ => Primitive::from_op(Op::Over(self.clone(), c)),
        }
    }
}

impl<T: Real> Div<T> for Primitive<T> {
    type Output = Primitive<T>;
    fn div(self, c: T) -> Primitive<T> {
        &self / c
    }
}

impl<T: Real> Neg for &Primitive<T> {
    type Output = Primitive<T>;
    fn neg(self) -> Primitive<T> {
        self.unary(Unary::Neg)
    }
}

impl<T: Real> Neg for Primitive<T> {
    type Output = Primitive<T>;
    fn neg(self) -> Primitive<T> {
        self.unary(Unary::Neg)
    }
}
