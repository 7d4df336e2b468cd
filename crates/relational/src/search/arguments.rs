//! Arguments of searches: a shape, or a point on it as the start of the iteration.

use moldloft_num::{Plane, Real, Vec3};
use moldloft_registry::{CallError, Class, CurveRef, FieldRef, FromValue, SurfaceRef, Value};

fn wrong<T: Real, R>(class: Class, value: &Value<T>) -> Result<R, CallError> {
    Err(CallError::wrong_class(class, value.class()))
}

/// A curve, or a bead on it.
#[derive(Clone, Debug)]
pub struct Along<T: Real> {
    /// The curve.
    pub curve: CurveRef<T>,
    /// Start of the iteration.
    pub start: Option<f64>,
}

fn along<T: Real>(value: &Value<T>, class: Class) -> Result<Along<T>, CallError> {
    match value {
        Value::Curve(curve) => Ok(Along { curve: curve.clone(), start: None }),
        Value::Point(p) => match &p.on_curve {
            Some(place) => Ok(Along { curve: place.0.clone(), start: Some(place.1.re()) }),
            None => wrong(class, value),
        },
        _ => wrong(class, value),
    }
}

impl<T: Real> FromValue<T> for Along<T> {
    const CLASS: Class = Class::Along;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        along(value, Class::Along)
    }
}

/// A snake, or a ring on it.
#[derive(Clone, Debug)]
pub struct AlongSnake<T: Real>(pub Along<T>);

impl<T: Real> FromValue<T> for AlongSnake<T> {
    const CLASS: Class = Class::AlongSnake;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let found = along(value, Class::AlongSnake)?;
        if found.curve.surface.is_some() {
            Ok(AlongSnake(found))
        } else {
            wrong(Class::AlongSnake, value)
        }
    }
}

/// A surface, or a magnet on it.
#[derive(Clone, Debug)]
pub struct Onto<T: Real> {
    /// The surface.
    pub surface: SurfaceRef<T>,
    /// The parameters of the magnet: where to begin.
    pub start: Option<[T; 2]>,
}

impl<T: Real> Onto<T> {
    /// Start of the iteration, real parts.
    pub fn from(&self) -> Option<[f64; 2]> {
        self.start.map(|uv| uv.map(|x| x.re()))
    }
}

fn onto<T: Real>(value: &Value<T>) -> Option<Onto<T>> {
    match value {
        Value::Surface(surface) => Some(Onto { surface: surface.clone(), start: None }),
        Value::Point(p) => {
            let place = p.on_surface.as_ref()?;
            Some(Onto { surface: place.0.clone(), start: Some(place.1) })
        }
        _ => None,
    }
}

impl<T: Real> FromValue<T> for Onto<T> {
    const CLASS: Class = Class::Onto;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        onto(value).map_or_else(|| wrong(Class::Onto, value), Ok)
    }
}

/// Targets of intersections and projections.
#[derive(Clone, Debug)]
pub enum Target<T: Real> {
    /// A plane.
    Plane(Plane<T>),
    /// A surface, or a magnet on it.
    Surface(Onto<T>),
    /// A curve, or a bead on it.
    Curve(Along<T>),
    /// A point.
    Point(Vec3<T>),
    /// The zero set of an implicit function.
    Field(FieldRef<T>),
}

impl<T: Real> FromValue<T> for Target<T> {
    const CLASS: Class = Class::Target;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        if let Some(onto) = onto(value) {
            return Ok(Target::Surface(onto));
        }
        if let Ok(along) = along(value, Class::Target) {
            return Ok(Target::Curve(along));
        }
        match value {
            Value::Plane(_) | Value::Text(_) => Plane::from_value(value).map(Target::Plane),
            Value::Point(p) => Ok(Target::Point(p.xyz)),
            Value::Field(f) => Ok(Target::Field(f.clone())),
            Value::Vector(_) | Value::List(_) => Vec3::from_value(value).map(Target::Point),
            other => wrong(Class::Target, other),
        }
    }
}
