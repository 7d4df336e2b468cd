use crate::{Class, Fault, FromValue, Value};
use moldloft_num::{Real, Vec3};
use std::sync::Arc;

/// Where a point of the model is when a bead that it depends on is moved: the objects between the
/// two, evaluated anew.
pub trait Sweep<T: Real>: Send + Sync {
    /// The position of the point with the bead at `t` of its curve.
    ///
    /// # Errors
    /// The fault of the first object that has no value then.
    fn at(&self, t: T) -> Result<Vec3<T>, Fault>;
}

/// The argument of a kind that sweeps a point: made by the model, see [`crate::Row::sweep`].
#[derive(Clone)]
pub struct LocusRef<T: Real>(Arc<dyn Sweep<T>>);

impl<T: Real> LocusRef<T> {
    /// The locus of a sweep.
    pub fn new(sweep: impl Sweep<T> + 'static) -> Self {
        Self(Arc::new(sweep))
    }
}

impl<T: Real> std::ops::Deref for LocusRef<T> {
    type Target = dyn Sweep<T>;
    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl<T: Real> std::fmt::Debug for LocusRef<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("LocusRef")
    }
}

impl<T: Real> FromValue<T> for LocusRef<T> {
    const CLASS: Class = Class::Point;
    fn from_value(value: &Value<T>) -> Result<Self, Fault> {
        match value {
            Value::Locus(locus) => Ok(locus.clone()),
            _ => Err(Fault::new("no-model", "a point is swept in a model only")
                .expected("a named point that depends on a bead")
                .found(value.class().a())),
        }
    }
}
