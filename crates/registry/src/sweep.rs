//! Points and curves that follow a bead: arguments of the kinds that sweep one along its curve.

use crate::{CallError, Class, CurveRef, FromValue, Value};
use moldloft_num::{Real, Vec3};
use std::sync::Arc;

/// Value of an object as a function of the parameter of a bead that it depends on: the objects
/// between the two are evaluated again.
pub trait Sweep<T: Real>: Send + Sync {
    /// The value of the object with the bead at `t` of its curve.
    ///
    /// # Errors
    /// The fault of the first object that has no value then.
    fn at(&self, t: T) -> Result<Value<T>, CallError>;
}

/// An object that follows a bead, made by the model for kinds that sweep; see
/// [`crate::Row::sweep`].
#[derive(Clone)]
pub struct LocusRef<T: Real>(Arc<dyn Sweep<T>>);

impl<T: Real> LocusRef<T> {
    /// The locus of a sweep.
    pub fn new(sweep: impl Sweep<T> + 'static) -> Self {
        Self(Arc::new(sweep))
    }
}

impl<T: Real> std::fmt::Debug for LocusRef<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("LocusRef")
    }
}

/// The argument of a kind that sweeps a point.
#[derive(Clone, Debug)]
pub struct MovingPoint<T: Real>(LocusRef<T>);

impl<T: Real> MovingPoint<T> {
    /// The position with the bead at `t`.
    ///
    /// # Errors
    /// See [`Sweep::at`].
    pub fn at(&self, t: T) -> Result<Vec3<T>, CallError> {
        match self.0.0.at(t)? {
            Value::Point(p) => Ok(p.xyz),
            other => Err(CallError::wrong_class(Class::Point, other.class())),
        }
    }
}

/// The argument of a kind that sweeps a curve.
#[derive(Clone, Debug)]
pub struct MovingCurve<T: Real>(LocusRef<T>);

impl<T: Real> MovingCurve<T> {
    /// The curve with the bead at `t`.
    ///
    /// # Errors
    /// See [`Sweep::at`].
    pub fn at(&self, t: T) -> Result<CurveRef<T>, CallError> {
        match self.0.0.at(t)? {
            Value::Curve(c) => Ok(c),
            other => Err(CallError::wrong_class(Class::Curve, other.class())),
        }
    }
}

fn locus<T: Real>(value: &Value<T>, class: Class) -> Result<LocusRef<T>, CallError> {
    match value {
        Value::Locus(locus) => Ok(locus.clone()),
        _ => Err(CallError::new("no-model", "things are swept in a model only")
            .expected(format!("a named {} that depends on a bead", class.name()))
            .found(value.class().with_article())),
    }
}

impl<T: Real> FromValue<T> for MovingPoint<T> {
    const CLASS: Class = Class::Point;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        locus(value, Class::Point).map(Self)
    }
}

impl<T: Real> FromValue<T> for MovingCurve<T> {
    const CLASS: Class = Class::Curve;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        locus(value, Class::Curve).map(Self)
    }
}
