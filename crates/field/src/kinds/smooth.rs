//! Smooth unions, intersections and differences, and arrays, as rows of the registry.

use super::read::{SetArgument, fault, field, primitive_of, set_of, set_value};
use crate::{Affine, Primitive, Set, SmoothShape, smooth_minimum};
use moldloft_num::{Axis, Real};
use moldloft_registry::{Build, CallError, Class, Context, FieldId, FromValue, Kind, Value};
use std::sync::Arc;

/// A field, or the function of a set: minima over unions and maxima over intersections.
pub struct FunctionOf<T: Real>(Primitive<T>);

impl<T: Real> FromValue<T> for FunctionOf<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let set = || set_of(value).map(|s| s.as_primitive());
        match primitive_of(value).or_else(set) {
            Some(primitive) => Ok(Self(primitive)),
            None => Err(CallError::wrong_class(Class::Set, value.class())),
        }
    }
}

fn shape(name: &str, place: FieldId) -> Result<SmoothShape, CallError> {
    SmoothShape::of_name(name).ok_or_else(|| {
        CallError::new("unknown-word", format!("`{name}` is no shape of a blend"))
            .expected(SmoothShape::NAMES.join(", "))
            .in_field(place)
    })
}

macro_rules! smooth {
    ($kind:ident, $name:literal, $doc:literal, $example:literal, $signs:expr) => {
        #[doc = $doc]
        ///
        /// The blend extends over the points where the functions differ by less than the width, a
        /// length for distances. A set is taken as its function. Quadratic blends have common
        /// tangents with both bodies, cubic ones common curvature, circular ones are arcs between
        /// planes at right angles.
        #[derive(Kind)]
        #[kind(forward, class = Field, function, name = $name, example = $example)]
        pub struct $kind<T: Real> {
            /// A body.
            a: FunctionOf<T>,
            /// The other body.
            b: FunctionOf<T>,
            /// The width of the blend.
            #[field(min = 0)]
            width: T,
            /// Shape of the blend: "quadratic", "cubic" or "circular".
            #[field(default = "quadratic")]
            blend: Arc<str>,
        }

        impl<T: Real> Build<T> for $kind<T> {
            fn build(self, _: &Context) -> Result<Value<T>, CallError> {
                let shape = shape(&self.blend, Self::BLEND)?;
                let [a, b, whole]: [bool; 3] = $signs;
                let signed = |p: Primitive<T>, turned: bool| if turned { -p } else { p };
                let (a, b) = (signed(self.a.0, a), signed(self.b.0, b));
                field(smooth_minimum([&a, &b], self.width, shape).map(|p| signed(p, whole)))
            }
        }
    };
}

smooth!(
    SmoothUnion,
    "smooth_union",
    "The union of two bodies with the edge between them filled smoothly.",
    "field blob = smooth_union(sphere({0, 0, 0}, 1, distance = 1), sphere({1.5, 0, 0}, 1, distance = 1), 0.5);",
    [false, false, false]
);
smooth!(
    SmoothIntersection,
    "smooth_intersection",
    "The intersection of two bodies with the edge between them rounded.",
    "field lens = smooth_intersection(sphere({0, 0, 0}, 1, distance = 1), sphere({1, 0, 0}, 1, distance = 1), 0.2);",
    [true, true, true]
);
smooth!(
    SmoothDifference,
    "smooth_difference",
    "The difference of two bodies with the edge between them rounded.",
    "field bowl = smooth_difference(sphere({0, 0, 0}, 1, distance = 1), sphere({0, 0, 1}, 0.8, distance = 1), 0.2);",
    [true, false, true]
);

/// Copies of a set about an axis, each rotated from the one before by the same angle.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "circular_array",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set holes = circular_array(set(sphere({3, 0, 0}, 0.5)), axis, 6); assert components(holes) == 6;"
)]
pub struct CircularArray<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// The axis, right-handed.
    axis: Axis<T>,
    /// Number of copies.
    #[field(min = 1, max = 10000)]
    count: u32,
    /// Angle from each copy to the next; default: a full turn divided by their number.
    #[field(default, angle)]
    angle: Option<T>,
}

impl<T: Real> Build<T> for CircularArray<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let whole = T::from(std::f64::consts::TAU / f64::from(self.count));
        let angle = self.angle.unwrap_or(whole);
        let copy = |k: u32| {
            self.set.0.mapped(&Affine::rotation(&self.axis, angle * T::from(f64::from(k))))
        };
        let copies: Result<Vec<Set<T>>, _> = (0..self.count).map(copy).collect();
        Ok(set_value(Set::union_of(copies.map_err(|e| fault(&e))?)))
    }
}
