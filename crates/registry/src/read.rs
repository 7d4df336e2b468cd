//! Arguments read as the types of the fields of a kind: each type has its class and its refusals.

use crate::{
    CallError, Class, CurveRef, FieldRef, Point, ReparametrizationRef, SetRef, SolidRef,
    SurfaceRef, TriangleBody, Value,
};
use moldloft_num::{Axis, Dual4, Frame, Plane, Real, Rev, Vec3};
use std::sync::Arc;

/// A type that an argument can be read as; the type of a kind's field.
pub trait FromValue<T: Real>: Sized {
    /// The class the argument must have.
    const CLASS: Class;
    /// True when the argument is a list of that class.
    const MANY: bool = false;
    /// True when the argument may be left out.
    const OPTIONAL: bool = false;
    /// Reads the argument.
    ///
    /// # Errors
    /// A [`CallError`] when the value is not of this class.
    fn from_value(value: &Value<T>) -> Result<Self, CallError>;
}

fn wrong<T: Real, R>(class: Class, value: &Value<T>) -> Result<R, CallError> {
    Err(match value {
        Value::Unset => {
            CallError::new("missing-argument", format!("{} is missing", class.with_article()))
        }
        _ => CallError::wrong_class(class, value.class()),
    })
}

fn finite<T: Real>(x: T) -> Result<T, CallError> {
    if x.is_finite() {
        return Ok(x);
    }
    let found = x.re();
    let found = if found.is_finite() { "an infinite derivative".into() } else { found.to_string() };
    Err(CallError::new("not-finite", format!("expected a finite number, found {found}"))
        .expected("a finite number")
        .found(found))
}

macro_rules! number_field {
    ($t:ty) => {
        impl FromValue<$t> for $t {
            const CLASS: Class = Class::Number;
            fn from_value(value: &Value<$t>) -> Result<Self, CallError> {
                match value {
                    Value::Number(x) => finite(*x),
                    other => wrong(Class::Number, other),
                }
            }
        }
    };
}
number_field!(f64);
number_field!(Dual4);
number_field!(Rev);

fn whole<T: Real>(value: &Value<T>) -> Result<f64, CallError> {
    let Value::Number(x) = value else { return wrong(Class::Integer, value) };
    let x = x.re();
    if x.fract() == 0.0 && x.abs() < 9e15 {
        return Ok(x);
    }
    Err(CallError::new("not-whole", format!("expected a whole number, found {x}"))
        .expected("a whole number")
        .found(x.to_string()))
}

macro_rules! integer_field {
    ($($t:ty),*) => {$(
        impl<T: Real> FromValue<T> for $t {
            const CLASS: Class = Class::Integer;
            fn from_value(value: &Value<T>) -> Result<Self, CallError> {
                let x = whole(value)?;
                if x < <$t>::MIN as f64 || x > <$t>::MAX as f64 {
                    let range = format!("a whole number from {} to {}", <$t>::MIN, <$t>::MAX);
                    return Err(CallError::new("out-of-range", format!("{x} is out of range"))
                        .expected(range)
                        .found(x.to_string()));
                }
                Ok(x as $t)
            }
        }
            )*};
}
integer_field!(u32, i32, usize);

impl<T: Real> FromValue<T> for Arc<str> {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Text(text) => Ok(text.clone()),
            other => wrong(Class::Text, other),
        }
    }
}

fn vector<T: Real>(value: &Value<T>, class: Class) -> Result<Vec3<T>, CallError> {
    let v = match value {
        Value::Vector(v) => *v,
        Value::Point(p) => p.xyz,
        Value::List(items) => match &items[..] {
            [Value::Number(x), Value::Number(y), Value::Number(z)] => Vec3::new(*x, *y, *z),
            _ => return wrong(class, value),
        },
        other => return wrong(class, other),
    };
    Ok(Vec3::new(finite(v.x)?, finite(v.y)?, finite(v.z)?))
}

impl<T: Real> FromValue<T> for Vec3<T> {
    const CLASS: Class = Class::Vector;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        vector(value, Class::Vector)
    }
}

impl<T: Real> FromValue<T> for Point<T> {
    const CLASS: Class = Class::Point;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Point(p) => Ok((**p).clone()),
            other => vector(other, Class::Point).map(Point::free),
        }
    }
}

impl<T: Real> FromValue<T> for CurveRef<T> {
    const CLASS: Class = Class::Curve;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Curve(c) => Ok(c.clone()),
            other => wrong(Class::Curve, other),
        }
    }
}

impl<T: Real> FromValue<T> for SurfaceRef<T> {
    const CLASS: Class = Class::Surface;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Surface(s) => Ok(s.clone()),
            other => wrong(Class::Surface, other),
        }
    }
}

impl<T: Real> FromValue<T> for SolidRef<T> {
    const CLASS: Class = Class::Solid;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Solid(s) => Ok(s.clone()),
            other => wrong(Class::Solid, other),
        }
    }
}

impl<T: Real> FromValue<T> for FieldRef<T> {
    const CLASS: Class = Class::Field;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Field(f) => Ok(f.clone()),
            other => wrong(Class::Field, other),
        }
    }
}

impl<T: Real> FromValue<T> for SetRef<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Set(s) => Ok(s.clone()),
            other => wrong(Class::Set, other),
        }
    }
}

impl<T: Real> FromValue<T> for ReparametrizationRef<T> {
    const CLASS: Class = Class::Relabel;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Relabel(r) => Ok(r.clone()),
            other => wrong(Class::Relabel, other),
        }
    }
}

impl<T: Real> FromValue<T> for Arc<TriangleBody<T>> {
    const CLASS: Class = Class::Mesh;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Body(m) => Ok(m.clone()),
            other => wrong(Class::Mesh, other),
        }
    }
}

impl<T: Real> FromValue<T> for Plane<T> {
    const CLASS: Class = Class::Plane;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Plane(p) => Ok(**p),
            Value::Text(text) => system_plane(text),
            other => wrong(Class::Plane, other),
        }
    }
}

impl<T: Real> FromValue<T> for Frame<T> {
    const CLASS: Class = Class::Frame;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Frame(f) => Ok(**f),
            // A point is converted to a frame there, with the axes of the world.
            other => vector(other, Class::Frame).map(|origin| Frame { origin, ..Frame::world() }),
        }
    }
}

/// The plane of a text such as "y=0" (model files write `*Y=0`) or "x = 2.5".
fn system_plane<T: Real>(text: &str) -> Result<Plane<T>, CallError> {
    let spelled = text.trim_start_matches('*').replace(' ', "").to_ascii_lowercase();
    let stated = spelled.split_once('=').and_then(|(axis, at)| {
        let axis = "xyz".find(axis).filter(|_| axis.len() == 1)?;
        Some((axis, at.parse::<f64>().ok().filter(|x| x.is_finite())?))
    });
    let Some((axis, at)) = stated else {
        return Err(CallError::new("unknown-plane", format!("unknown plane \"{text}\""))
            .expected("a coordinate plane such as \"x=0\" or \"z=1.5\", or a plane object")
            .found(format!("\"{text}\"")));
    };
    let unit = |value: f64| std::array::from_fn(|k| T::from(if k == axis { value } else { 0.0 }));
    Ok(Plane { point: Vec3::from(unit(at)), normal: Vec3::from(unit(1.0)) })
}

/// Mirror or target of a projection.
#[derive(Clone, Debug)]
pub enum MirrorArgument<T: Real> {
    /// A plane.
    Plane(Plane<T>),
    /// The line through the ends of a curve.
    Line(Axis<T>),
    /// A point.
    Point(Vec3<T>),
}

impl<T: Real> MirrorArgument<T> {
    /// The foot of the perpendicular from `p`, for a plane or line; the point itself for a point.
    pub fn foot(&self, p: Vec3<T>) -> Vec3<T> {
        match self {
            MirrorArgument::Plane(plane) => plane.foot(p),
            MirrorArgument::Line(line) => line.foot(p),
            MirrorArgument::Point(point) => *point,
        }
    }

    /// The mirror image of `p`.
    pub fn image(&self, p: Vec3<T>) -> Vec3<T> {
        self.foot(p) * T::from(2.0) - p
    }

    /// The linear part of [`Self::image`] (of [`Self::foot`] with `project`), which maps free
    /// vectors.
    pub fn direction(&self, d: Vec3<T>, project: bool) -> Vec3<T> {
        let foot = match self {
            MirrorArgument::Plane(plane) => d - plane.normal * plane.normal.dot(d),
            MirrorArgument::Line(line) => line.direction * line.direction.dot(d),
            MirrorArgument::Point(_) => Vec3::zero(),
        };
        if project { foot } else { foot * T::from(2.0) - d }
    }

    /// True when the image of a surface has the opposite natural normal.
    pub fn reverses(&self) -> bool {
        !matches!(self, MirrorArgument::Line(_))
    }
}

impl<T: Real> FromValue<T> for MirrorArgument<T> {
    const CLASS: Class = Class::MirrorArgument;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Plane(p) => Ok(MirrorArgument::Plane(**p)),
            Value::Text(text) => system_plane(text).map(MirrorArgument::Plane),
            Value::Curve(c) => axis(c).map(MirrorArgument::Line),
            other => vector(other, Class::MirrorArgument).map(MirrorArgument::Point),
        }
    }
}

fn axis<T: Real>(curve: &CurveRef<T>) -> Result<Axis<T>, CallError> {
    Axis::through(curve.end(0.0), curve.end(1.0)).ok_or_else(|| {
        CallError::new("zero-length-axis", "the axis has no direction: its ends coincide")
            .expected("a line between two different points")
            .found("no distance between its ends")
            .help("move one end of the line")
    })
}

impl<T: Real> FromValue<T> for Axis<T> {
    const CLASS: Class = Class::Axis;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Curve(c) => axis(c),
            other => wrong(Class::Axis, other),
        }
    }
}

impl<T: Real, F: FromValue<T>> FromValue<T> for Option<F> {
    const CLASS: Class = F::CLASS;
    const MANY: bool = F::MANY;
    const OPTIONAL: bool = true;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Unset => Ok(None),
            other => F::from_value(other).map(Some),
        }
    }
}

/// Reads a list, or a row of numbers or vectors as the list of its items.
///
/// # Errors
/// The fault of the first item that is not an `F`, with its index.
pub fn many<T: Real, F: FromValue<T>>(value: &Value<T>) -> Result<Vec<F>, CallError> {
    let item = |(k, v): (usize, &Value<T>)| F::from_value(v).map_err(|fault| fault.in_item(k));
    match value {
        Value::List(items) => items.iter().enumerate().map(item).collect(),
        Value::Numbers(a) => {
            a.items.iter().enumerate().map(|(k, x)| item((k, &Value::Number(*x)))).collect()
        }
        Value::Vectors(a) => {
            a.iter().enumerate().map(|(k, x)| item((k, &Value::Vector(x)))).collect()
        }
        Value::Unset => wrong(Class::List, value),
        other => Err(CallError::new(
            "not-a-list",
            format!(
                "expected a list of {}s, found {}",
                F::CLASS.name(),
                other.class().with_article()
            ),
        )
        .expected(format!("a list such as {{a, b, c}} of {}s", F::CLASS.name()))
        .found(other.class().with_article())),
    }
}

impl<T: Real, F: FromValue<T>> FromValue<T> for Vec<F> {
    const CLASS: Class = F::CLASS;
    const MANY: bool = true;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        // {a, b, c} of three numbers reads as a vector before the argument's class is known.
        match value {
            Value::Vector(v) if matches!(F::CLASS, Class::Number | Class::Integer) => {
                many(&Value::list(v.to_array().map(Value::Number)))
            }
            other => many(other),
        }
    }
}

impl<T: Real> FromValue<T> for Value<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        Ok(value.clone())
    }
}
