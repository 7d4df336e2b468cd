//! Operations on whole sets and replaced coordinates, as rows of the registry.

use super::read::{NamedField, SetArgument, fault, field, primitive_of, set, set_of, set_value};
use crate::{Affine, Primitive, Set};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Class, Context, FieldId, FromValue, Kind, Point, Value};
use std::sync::Arc;

/// A field or a set.
pub struct FieldOrSet<T: Real>(Value<T>);

impl<T: Real> FromValue<T> for FieldOrSet<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Field(_) | Value::Set(_) | Value::Plane(_) => Ok(Self(value.clone())),
            other => Err(CallError::wrong_class(Class::Set, other.class())),
        }
    }
}

impl<T: Real> FieldOrSet<T> {
    fn remapped(&self, coordinates: &[Primitive<T>; 3]) -> Result<Value<T>, CallError> {
        match (&self.0, set_of(&self.0), primitive_of(&self.0)) {
            (Value::Set(_), Some(s), _) => set(s.remapped(coordinates)),
            (_, _, Some(f)) => field(Ok(f.remapped(coordinates))),
            (value, ..) => Err(CallError::wrong_class(Class::Set, value.class())),
        }
    }
}

/// Edges as "face, face; face, face"; `None` for all edges.
fn edges(text: Option<&Arc<str>>, place: FieldId) -> Result<Option<Vec<[String; 2]>>, CallError> {
    let Some(text) = text else { return Ok(None) };
    let pair = |part: &str| match part.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [a, b] if !a.is_empty() && !b.is_empty() => Ok([a.to_owned(), b.to_owned()]),
        _ => Err(CallError::new("wrong-edges", format!("`{}` names no edge", part.trim()))
            .expected("the names of two faces, and more after `;`: \"top, side; top, front\"")
            .in_field(place)),
    };
    text.split(';').filter(|p| !p.trim().is_empty()).map(pair).collect::<Result<_, _>>().map(Some)
}

/// A field or set under a change of coordinates: its value at p is that of the shape at (x(p),
/// y(p), z(p)).
///
/// Twists, bends, tapers and repetitions are such replacements.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "remapped",
    example = "field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); field egg = remapped(sphere({0, 0, 0}, 1), x, y, z*(1 + z/10));"
)]
pub struct Remapped<T: Real> {
    /// Field or set.
    shape: FieldOrSet<T>,
    /// Field that replaces x.
    x: NamedField<T>,
    /// Field that replaces y.
    y: NamedField<T>,
    /// Field that replaces z.
    z: NamedField<T>,
}

impl<T: Real> Build<T> for Remapped<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        self.shape.remapped(&[self.x.primitive, self.y.primitive, self.z.primitive])
    }
}

/// A field or set twisted about the z axis.
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "twisted",
    example = "set drill = twisted(cuboid({-1, -0.3, 0}, {1, 0.3, 4}), 0.8);"
)]
pub struct Twisted<T: Real> {
    /// Field or set.
    shape: FieldOrSet<T>,
    /// Angle of rotation per unit of z.
    #[field(angle)]
    rate: T,
}

impl<T: Real> Build<T> for Twisted<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        self.shape.remapped(&crate::twist(self.rate))
    }
}

/// The remainder x - y floor(x / y) of fields: x repeated with the period y.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "remainder",
    example = "field x = plane({1, 0, 0}, {0, 0, 0}); field teeth = remainder(x, 0.5);"
)]
pub struct Remainder<T: Real> {
    /// The dividend.
    x: NamedField<T>,
    /// The divisor.
    y: NamedField<T>,
}

impl<T: Real> Build<T> for Remainder<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        field(self.x.primitive.remainder(&self.y.primitive)).map_err(|f| f.in_field(Self::Y))
    }
}

/// Copies of a set, each moved from the one before by the same vector.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "repeated",
    example = "set row = repeated(set(sphere({0, 0, 0}, 0.4)), {1, 0, 0}, 5); assert components(row) == 5;"
)]
pub struct Repeated<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Vector from each copy to the next.
    by: Point<T>,
    /// Number of copies.
    #[field(min = 1, max = 10000)]
    count: u32,
}

impl<T: Real> Build<T> for Repeated<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let copy = |k: u32| {
            let by: Vec3<T> = self.by.xyz * T::from(f64::from(k));
            self.set.0.mapped(&Affine::translation(by))
        };
        let mut all = Set::nothing();
        for k in 0..self.count {
            all = all | copy(k).map_err(|e| fault(&e))?;
        }
        Ok(set_value(all))
    }
}

/// A set grown by a distance, or shrunk by a negative one: every face moves along its normals, edges stay sharp.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_offset",
    example = "set grown = set_offset(cuboid({0, 0, 0}, {1, 1, 1}), 0.1); assert abs(volume(grown) - 1.728) < 1e-9;"
)]
pub struct SetOffset<T: Real> {
    /// The set, of planes, balls, cylinders, cones and tori.
    set: SetArgument<T>,
    /// Outward displacement of the faces.
    distance: T,
}

impl<T: Real> Build<T> for SetOffset<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        set(self.set.0.offset(self.distance))
    }
}

/// The wall inside a set's surface.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_shell",
    example = "set tank = set_shell(cuboid({0, 0, 0}, {1, 1, 1}), 0.1); assert abs(volume(tank) - 0.488) < 1e-9;"
)]
pub struct SetShell<T: Real> {
    /// The set, of planes, balls, cylinders, cones and tori.
    set: SetArgument<T>,
    /// Wall thickness.
    #[field(min = 0)]
    thickness: T,
}

impl<T: Real> Build<T> for SetShell<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        set(self.set.0.shell(self.thickness))
    }
}

/// The convex hull of sets: the smallest convex set that holds all of them.
///
/// Its surface is of planes, balls, cylinders, cones and tori, and smooth where balls span it. The sets are unions of
/// bounded polyhedra and balls; or of polyhedra, cylinders and cones of one axis direction; or of cylinders, cones, tori
/// and balls about one axis.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "convex_hull",
    example = "set pill = convex_hull({set(sphere({0, 0, 0}, 1)), set(sphere({3, 0, 0}, 1))}); assert abs(volume(pill) - 13/3*PI) < 1e-6;"
)]
pub struct ConvexHull<T: Real> {
    /// The sets.
    #[field(variadic, min_items = 1)]
    sets: Vec<SetArgument<T>>,
}

impl<T: Real> Build<T> for ConvexHull<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let sets: Vec<Set<T>> = self.sets.into_iter().map(|s| s.0).collect();
        set(crate::convex_hull(&sets))
    }
}

/// The Minkowski sum of two sets: all sums of a point of one and a point of the other.
///
/// With a ball it is the set grown by its radius, with round edges. Each set is a union of convex
/// parts, as for `convex_hull`; a cylinder or prism may be added to another with the same axis, or
/// to a ball.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "minkowski_sum",
    example = "set soft = minkowski_sum(cuboid({0, 0, 0}, {3, 2, 1}), sphere({0, 0, 0}, 0.2)); assert abs(volume(soft) - (6 + 22*0.2 + 6*PI*0.04 + 4/3*PI*0.008)) < 1e-6;"
)]
pub struct MinkowskiSum<T: Real> {
    /// A set.
    a: SetArgument<T>,
    /// The other set.
    b: SetArgument<T>,
}

impl<T: Real> Build<T> for MinkowskiSum<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        set(crate::minkowski_sum(&self.a.0, &self.b.0))
    }
}

/// The union of two sets with fillets where their faces meet.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_fillet",
    example = "set post = set_fillet(cuboid({-2, -2, -1}, {2, 2, 0}), cuboid({-0.5, -0.5, -0.5}, {0.5, 0.5, 2}), 0.2);"
)]
pub struct FilletSets<T: Real> {
    /// A set, of planes, balls, cylinders, cones and tori.
    a: SetArgument<T>,
    /// The other set.
    b: SetArgument<T>,
    /// Setback of the blend on both.
    #[field(min = 0)]
    width: T,
    /// Setback on the first set, if different.
    #[field(default, min = 0)]
    other: Option<T>,
    /// Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between perpendicular planes.
    #[field(default = crate::CIRCULAR)]
    lambda: T,
    /// The edges, by the names of a face of each set: "top, side; top, front". Default: all.
    #[field(default)]
    edges: Option<Arc<str>>,
}

impl<T: Real> Build<T> for FilletSets<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let chosen = edges(self.edges.as_ref(), Self::EDGES)?;
        let widths = [self.width, self.other.unwrap_or(self.width)];
        set(crate::fillet_sets([&self.a.0, &self.b.0], widths, self.lambda, chosen.as_deref()))
    }
}

/// A set with the convex edges between its faces rounded.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_round",
    example = "set soft = set_round(cuboid({0, 0, 0}, {3, 2, 1}), 0.2);"
)]
pub struct RoundEdges<T: Real> {
    /// The set, of planes, balls, cylinders, cones and tori.
    set: SetArgument<T>,
    /// Setback of the round on both faces.
    #[field(min = 0)]
    width: T,
    /// Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between perpendicular planes.
    #[field(default = crate::CIRCULAR)]
    lambda: T,
    /// The edges, by the names of both faces: "top, side; top, front". Default: all.
    #[field(default)]
    edges: Option<Arc<str>>,
}

impl<T: Real> Build<T> for RoundEdges<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let chosen = edges(self.edges.as_ref(), Self::EDGES)?;
        set(crate::round_edges(&self.set.0, self.width, self.lambda, chosen.as_deref()))
    }
}

/// A set with the convex edges between its faces chamfered.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_chamfer",
    example = "set block = set_chamfer(cuboid({0, 0, 0}, {10, 6, 4}), 1); assert abs(volume(block) - 206) < 1e-6;"
)]
pub struct ChamferEdges<T: Real> {
    /// The set, of planes, balls, cylinders, cones and tori.
    set: SetArgument<T>,
    /// Setback of the chamfer on both faces.
    #[field(min = 0)]
    width: T,
    /// The edges, by the names of both faces: "top, side; top, front". Default: all.
    #[field(default)]
    edges: Option<Arc<str>>,
}

impl<T: Real> Build<T> for ChamferEdges<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let chosen = edges(self.edges.as_ref(), Self::EDGES)?;
        set(crate::chamfer_edges(&self.set.0, self.width, chosen.as_deref()))
    }
}

/// The union of any number of sets, in a balanced tree, which is the fastest to evaluate for many
/// sets.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_union",
    example = "set balls = set_union({sphere({0, 0, 0}, 1), sphere({3, 0, 0}, 1), sphere({6, 0, 0}, 1)}); assert components(balls) == 3;"
)]
pub struct UnionOf<T: Real> {
    /// The sets.
    #[field(variadic)]
    sets: Vec<SetArgument<T>>,
}

impl<T: Real> Build<T> for UnionOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(set_value(Set::union_of(self.sets.into_iter().map(|s| s.0).collect())))
    }
}

/// The intersection of any number of sets, in a balanced tree.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "set_intersection",
    example = "set lens = set_intersection({sphere({0, 0, 0}, 1), sphere({1, 0, 0}, 1)}); assert abs(volume(lens) - 5*PI/12) < 1e-6;"
)]
pub struct IntersectionOf<T: Real> {
    /// The sets.
    #[field(variadic)]
    sets: Vec<SetArgument<T>>,
}

impl<T: Real> Build<T> for IntersectionOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        Ok(set_value(Set::intersection_of(self.sets.into_iter().map(|s| s.0).collect())))
    }
}
