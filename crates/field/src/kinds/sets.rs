//! Sets as rows of the registry.

use super::read::{NamedField, SetArgument, set, set_value};
use crate::{Set, SetAttributes};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Class, Context, FromValue, Kind, Point, Value};
use std::marker::PhantomData;
use std::sync::Arc;

/// Source of a set: its solid side, a wire or a point.
enum SetSource<T: Real> {
    Field(NamedField<T>),
    Line([Vec3<T>; 2]),
    Point(Vec3<T>),
}

/// Maximum deviation of a straight line, relative to its length.
const STRAIGHT: f64 = 1e-9;

impl<T: Real> FromValue<T> for SetSource<T> {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Curve(curve) => {
                let [from, to] = [0.0, 1.0].map(|t| curve.end(t));
                let (start, length) = (from.re(), from.re().distance(to.re()));
                let bent = [0.25, 0.5, 0.75].into_iter().map(|t| {
                    let p = curve.end(t).re() - start;
                    let along = (to.re() - start) / length.max(f64::MIN_POSITIVE);
                    (p - along * p.dot(along)).norm()
                });
                if bent.fold(0.0, f64::max) > STRAIGHT * length {
                    return Err(CallError::new(
                        "not-straight",
                        "a set is made of straight lines only",
                    )
                    .expected("a line")
                    .found("a curve that bends")
                    .help("take the sheets of two fields that meet in the curve"));
                }
                Ok(Self::Line([from, to]))
            }
            Value::Point(_) | Value::Vector(_) => {
                Point::from_value(value).map(|p| Self::Point(p.xyz))
            }
            _ => NamedField::from_value(value).map(Self::Field),
        }
    }
}

/// The points where a field is not positive; or a line as a wire; or a point.
///
/// Its faces are called as the field is. A line reaches from its start to its end. Sets are combined by `|` (union), `&` (intersection), `-`
/// (difference), `^` (points in just one) and the sign `-` (complement).
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set",
    example = "field c = sphere({0, 0, 0}, 1); set ball = set(c) & -set(plane({0, 0, 1}, {0, 0, 0}));"
)]
pub struct SetOf<T: Real> {
    /// The field, line or point.
    field: SetSource<T>,
}

impl<T: Real> Build<T> for SetOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        match self.field {
            SetSource::Field(field) => {
                let set = Set::new(&field.primitive);
                Ok(set_value(match &field.name {
                    Some(name) => set.named(name),
                    None => set,
                }))
            }
            SetSource::Line([from, to]) => set(Set::segment(from, to)),
            SetSource::Point(at) => set(Set::point(at)),
        }
    }
}

/// The box between two corners, of six half-spaces.
#[derive(Kind)]
#[kind(forward, class = Set, function, name = "cuboid", example = "set block = cuboid({0, 0, 0}, {2, 1, 1});")]
pub struct Cuboid<T: Real> {
    /// Low corner.
    low: Point<T>,
    /// High corner.
    high: Point<T>,
}

impl<T: Real> Build<T> for Cuboid<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        set(Set::cuboid(self.low.xyz, self.high.xyz))
    }
}

/// The tetrahedron of four points, in any order.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "tetrahedron",
    example = "set t = tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});"
)]
pub struct Tetrahedron<T: Real> {
    /// A corner.
    a: Point<T>,
    /// A corner.
    b: Point<T>,
    /// A corner.
    c: Point<T>,
    /// A corner.
    d: Point<T>,
}

impl<T: Real> Build<T> for Tetrahedron<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        set(Set::tetrahedron([self.a.xyz, self.b.xyz, self.c.xyz, self.d.xyz]))
    }
}

/// The faces of a set as sheets, without its interior.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "thin",
    example = "set tank = thin(cuboid({0, 0, 0}, {2, 1, 1}));"
)]
pub struct Thin<T: Real> {
    /// The set whose primitives intersect.
    set: SetArgument<T>,
}

impl<T: Real> Build<T> for Thin<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(set_value(self.set.0.skin()))
    }
}

/// All of space.
#[derive(Kind)]
#[kind(forward, class = Set, function, name = "everything", example = "set all = everything();")]
pub struct Everything<T: Real> {
    scalar: PhantomData<T>,
}

impl<T: Real> Build<T> for Everything<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { scalar: _ } = self;
        Ok(set_value(Set::everything()))
    }
}

/// The empty set: the start of a union in a loop.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "nothing",
    example = "set balls = nothing(); for (i = 1:3) balls = balls | set(sphere({i, 0, 0}, 0.4));"
)]
pub struct Nothing<T: Real> {
    scalar: PhantomData<T>,
}

impl<T: Real> Build<T> for Nothing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { scalar: _ } = self;
        Ok(set_value(Set::nothing()))
    }
}

/// The same set with attributes; attributes of its parts take precedence.
///
/// They reach every triangle, and the panels of each are a patch under the name.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "attributes",
    example = "set ball = attributes(set(sphere({0, 0, 0}, 1)), name = \"ball\", colour = 12);"
)]
pub struct Attributed<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// The name of its faces.
    #[field(default)]
    name: Option<Arc<str>>,
    /// Index of a palette colour.
    #[field(default, min = 0, max = 15)]
    colour: Option<u32>,
    /// Its material.
    #[field(default)]
    material: Option<Arc<str>>,
    /// Distance below which two points of the set count as one.
    #[field(default, min = 0)]
    tolerance: Option<T>,
    /// Further attributes, as `tag = text` separated by `;`.
    #[field(default)]
    tags: Option<Arc<str>>,
}

impl<T: Real> Build<T> for Attributed<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let text = |t: Option<Arc<str>>| t.map(|t| t.to_string());
        let pair = |part: &str| match part.split_once('=') {
            Some((tag, value)) if !tag.trim().is_empty() => {
                Ok((tag.trim().to_owned(), value.trim().to_owned()))
            }
            _ => Err(CallError::new("wrong-tags", format!("`{}` is not a tag", part.trim()))
                .expected("`tag = text`, and more after `;`")
                .in_field(Self::TAGS)),
        };
        let parts = self.tags.as_deref().unwrap_or_default().split(';');
        let tags = parts.filter(|p| !p.trim().is_empty()).map(pair).collect::<Result<_, _>>()?;
        Ok(set_value(self.set.0.with(SetAttributes {
            given: self.name.is_some(),
            name: text(self.name),
            colour: self.colour.map(|c| c as u8),
            material: text(self.material),
            tolerance: self.tolerance.map(T::re),
            tags,
        })))
    }
}

/// An equal set without parts that combine to nothing new: A|A = A, A|-A = everything, A&-A = nothing,
/// A|(A&B) = A, A&(A|B) = A.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "regularized",
    example = "set b = set(sphere({0, 0, 0}, 1)); set once = regularized(b | b);"
)]
pub struct Regularized<T: Real> {
    /// The set.
    set: SetArgument<T>,
}

impl<T: Real> Build<T> for Regularized<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(set_value(self.set.0.regularized()))
    }
}

/// A named set: the declaration `set s = ...;`.
#[derive(Kind)]
#[kind(forward, class = Set, name = "Set", example = "Set ball(set(sphere({0, 0, 0}, 1)));")]
pub struct SetObject<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Objects from which it is computed.
    #[field(default)]
    of: Option<Vec<Value<T>>>,
}

impl<T: Real> Build<T> for SetObject<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        drop(self.of);
        Ok(set_value(self.set.0))
    }
}
