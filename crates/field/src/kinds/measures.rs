//! Measures and queries of fields and sets, as rows of the registry.

use super::body::options;
use super::read::{SetArgument, fault, primitive_of, set_of};
use super::region::{Region, region};
use crate::facet::{Facets, Resolution};
use crate::measure::curved::{self, Curved};
use crate::query::bounds::around;
use crate::query::foot;
use crate::{
    FacetMemo, FieldError, IntegralOptions, Lifter, Membership, Moments, Primitive, Set, bracket,
    facet_mixed, mass_of,
};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{
    Array, Build, CallError, Class, Context, FieldId, FromValue, Kind, Point, Remark, Value,
    Vectors,
};
use std::sync::Arc;

/// The coarsest and finest divisions of the box by which integrals are made.
const DEPTHS: [u32; 2] = [5, 9];

/// Default relative accuracy of areas and lengths.
const ALIKE: f64 = 1e-6;

/// Facets for integrals, which stop when the model does.
fn sharp(depth: u32, context: &Context) -> crate::FacetOptions {
    crate::FacetOptions { sharp: true, ..options(Resolution::Level(depth), context) }
}

/// Moments of a set: best values inside a proved bracket.
fn moments<T: Real>(
    set: &Set<T>,
    region: &Region<T>,
    accuracy: Option<T>,
    context: &Context,
) -> Result<Moments<T>, FieldError> {
    let measure = IntegralOptions {
        agreement: accuracy.map(T::re),
        budget: context.budget.for_set(),
        ..IntegralOptions::default()
    };
    let found = mass_of(set, &region.over, region.corners, &measure, &context.kept.of())?;
    if let Some(Remark { id, message, advice }) = found.doubt(accuracy.map(T::re)) {
        context.remark(id, message, advice);
    }
    Ok(found.best)
}

macro_rules! measure {
    (
        $kind:ident, $class:ident, $name:literal, $doc:literal, $accuracy:literal, $example:literal,
        $known:expr, |$this:ident, $set:ident, $region:ident, $context:ident| $body:expr
    ) => {
        #[doc = $doc]
        ///
        /// Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
        /// the set. Volume and area of the body of a sketch are those of its faces, exact.
        #[derive(Kind)]
        #[kind(forward, class = $class, function, name = $name, example = $example)]
        pub struct $kind<T: Real> {
            /// The set.
            set: SetArgument<T>,
            /// Low corner of the box.
            #[field(default)]
            low: Option<Point<T>>,
            /// High corner of the box.
            #[field(default)]
            high: Option<Point<T>>,
            #[doc = $accuracy]
            #[field(default)]
            accuracy: Option<T>,
        }

        impl<T: Real> Build<T> for $kind<T> {
            fn build(self, $context: &Context) -> Result<Value<T>, CallError> {
                let $this = self;
                let $set = &$this.set.0;
                let own: fn([T; 2]) -> Option<T> = $known;
                if let (None, None, Some(known)) =
                    (&$this.low, &$this.high, $set.figures().and_then(own))
                {
                    return Ok(Value::Number(known));
                }
                let $region = region(&$set.re(), &$this.low, &$this.high, [Self::SET, Self::HIGH])?;
                $body
            }
        }
    };
}

measure!(
    Volume,
    Number,
    "volume",
    "The volume of a set within a box, by a high-order rule; `volume_bracket` gives guaranteed bounds.",
    "Maximum difference of two values at successive divisions of the box; default: 1e-8 of the box's volume.",
    "assert abs(volume(set(sphere({0, 0, 0}, 1))) - 4.18879) < 1e-4;",
    |[volume, _]| Some(volume),
    |this, set, region, context| {
        let m = moments(set, &region, this.accuracy, context).map_err(|e| fault(&e))?;
        Ok(Value::Number(m.volume()))
    }
);

measure!(
    Centroid,
    Vector,
    "mass_centre",
    "The centre of mass of a set within a box.",
    "Maximum difference of two volumes at successive divisions of the box; default: 1e-8 of the box's volume.",
    "set half = set(sphere({0, 0, 0}, 1)) & set(plane({0, 0, -1}, {0, 0, 0})); assert abs(mass_centre(half).z - 0.375) < 1e-4;",
    |_| None,
    |this, set, region, context| {
        let m = moments(set, &region, this.accuracy, context).map_err(|e| fault(&e))?;
        if m.volume().re() <= 0.0 {
            return Err(empty(Self::SET));
        }
        Ok(Value::Vector(m.centroid()))
    }
);

measure!(
    Inertia,
    Vectors,
    "inertia",
    "The rows of the matrix of inertia of a set of density 1 about its centroid.",
    "Maximum difference of two volumes at successive divisions of the box; default: 1e-8 of the box's volume.",
    "curve rows = inertia(cuboid({0, 0, 0}, {1, 2, 3})); assert abs(rows[1].x - 6.5) < 1e-6;",
    |_| None,
    |this, set, region, context| {
        let m = moments(set, &region, this.accuracy, context).map_err(|e| fault(&e))?;
        if m.volume().re() <= 0.0 {
            return Err(empty(Self::SET));
        }
        Ok(Value::Vectors(Arc::new(Vectors::row(m.inertia().to_vec()))))
    }
);

fn empty(set: FieldId) -> CallError {
    CallError::new("empty-set", "the set has no volume in the box")
        .expected("a solid in the box")
        .in_field(set)
}

measure!(
    Area,
    Number,
    "area",
    "The area of the surface of a set within a box, sheets counted once.",
    "Maximum difference of two values at successive divisions of the box; default: 1e-6 of the area.",
    "assert abs(area(set(sphere({0, 0, 0}, 1))) - 12.56637) < 1e-5;",
    |[_, area]| Some(area),
    |this, set, region, context| {
        let memo = context.kept.of();
        refined(this.accuracy, Self::ACCURACY, context, |options| {
            area(set, &region, options, &memo)
        })
    }
);

measure!(
    WireLength,
    Number,
    "wire_length",
    "The length of the wires of a set within a box: curves in which two sheets meet.",
    "Maximum difference of two values at successive divisions of the box; default: 1e-6 of the length.",
    "set ring = set(abs(sphere({0, 0, 0}, 1))) & set(abs(plane({0, 0, 1}, {0, 0, 0.6}))); assert abs(wire_length(ring) - 5.0265482) < 1e-5;",
    |_| None,
    |this, set, region, context| {
        refined(this.accuracy, Self::ACCURACY, context, |options| length(set, &region, options))
    }
);

/// A measure at resolutions that are made finer until two agree.
fn refined<T: Real>(
    accuracy: Option<T>,
    field: FieldId,
    context: &Context,
    measure: impl Fn(&crate::FacetOptions) -> Result<T, FieldError>,
) -> Result<Value<T>, CallError> {
    let asked = match accuracy {
        Some(a) => Some(
            crate::error::positive("accuracy", a.re()).map_err(|e| fault(&e).in_field(field))?,
        ),
        None => None,
    };
    let mut found = T::zero();
    for depth in DEPTHS[0]..=DEPTHS[1] {
        let before = found;
        found = measure(&sharp(depth, context)).map_err(|e| fault(&e))?;
        let step = (found - before).re().abs();
        let alike = asked.unwrap_or(ALIKE * found.re());
        if depth > DEPTHS[0] && step <= alike {
            return Ok(Value::Number(found));
        }
        if depth == DEPTHS[1] {
            context.remark(
                "accuracy-not-reached",
                format!("the last two values differ by {step:.3e}, more than {alike:.3e}"),
                "give a smaller box, or a coarser accuracy",
            );
        }
    }
    Ok(Value::Number(found))
}

/// The area of the curved facets at one resolution.
fn area<T: Real>(
    set: &Set<T>,
    region: &Region<T>,
    options: &crate::FacetOptions,
    memo: &FacetMemo,
) -> Result<T, FieldError> {
    let plain = set.re();
    let lifter = Lifter::of(set, &plain, region.corners);
    let own = |facets: &Facets| -> Result<T, FieldError> {
        let (positions, primitives) = (lifter.positions(facets)?, lifter.primitives(facets)?);
        // A face of the box is not a surface of the set.
        let counts = |leaf: u32| (leaf as usize) < facets.own_leaves;
        Ok(Curved::new(&facets.flat()).area(&positions, &primitives, counts))
    };
    if plain.leaves().iter().all(|l| !l.primitive.is_sheet()) {
        return own(&*memo.facet(&plain, &region.over, options)?);
    }
    let mixed = facet_mixed(&plain, &region.over, options)?;
    let mut area = own(&mixed.solid)?;
    for sheet in &mixed.sheets {
        let positions = lifter.moved_on(sheet.mesh.positions(), &sheet.on)?;
        let primitives = lifter.primitives_on(&sheet.on)?;
        area += Curved::new(&sheet.flat()).area(&positions, &primitives, |_| true);
    }
    Ok(area)
}

/// The length of the wires at one resolution.
fn length<T: Real>(
    set: &Set<T>,
    region: &Region<T>,
    options: &crate::FacetOptions,
) -> Result<T, FieldError> {
    let plain = set.re();
    let lifter = Lifter::of(set, &plain, region.corners);
    let mut sum = T::zero();
    for wire in &facet_mixed(&plain, &region.over, options)?.wires {
        sum += curved::length(wire, &lifter.primitives_on(&wire.on)?);
    }
    Ok(sum)
}

/// Proved bounds of the volume of a set within a box, {low, high}, from ranges over boxes.
#[derive(Kind)]
#[kind(
    forward,
    class = Numbers,
    function,
    name = "volume_bracket",
    example = "farray v = volume_bracket(set(sphere({0, 0, 0}, 1)), depth = 5); assert v[1] < 4.18879; assert v[2] > 4.18879;"
)]
pub struct VolumeBracket<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Low corner of the box.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
    /// Number of halvings of the box.
    #[field(default = 6, min = 1, max = 12)]
    depth: u32,
}

impl<T: Real> Build<T> for VolumeBracket<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let set = self.set.0.re();
        let region = region(&set, &self.low, &self.high, [Self::SET, Self::HIGH])?;
        let volume = bracket(&set, &region.over, self.depth).map_err(|e| fault(&e))?.volume();
        let ends = vec![T::from(volume.low.max(0.0)), T::from(volume.high)];
        Ok(Value::Numbers(Arc::new(Array::row(ends))))
    }
}

/// The position of a point: "solid", "surface" or "air".
#[derive(Kind)]
#[kind(
    forward,
    class = Text,
    function,
    name = "member",
    example = "assert member(set(sphere({0, 0, 0}, 1)), {0.5, 0, 0}) == \"solid\";"
)]
pub struct Member<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// The point.
    point: Point<T>,
    /// Distance from a surface that counts as on it.
    #[field(default = 1e-9, min = 0)]
    tolerance: T,
}

impl<T: Real> Build<T> for Member<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = self.set.0.member(self.point.xyz, self.tolerance.re());
        Ok(Value::text(match place {
            Membership::Solid => "solid",
            Membership::Surface => "surface",
            Membership::Air => "air",
        }))
    }
}

/// Name of the primitive that decides the value at a point: the least of a union, the greatest of
/// an intersection.
#[derive(Kind)]
#[kind(
    forward,
    class = Text,
    function,
    name = "winner",
    example = "field a = sphere({0, 0, 0}, 1); field b = sphere({3, 0, 0}, 1); assert winner(set(a) | set(b), {2.9, 0, 0}) == \"b\";"
)]
pub struct Winner<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// The point.
    point: Point<T>,
}

impl<T: Real> Build<T> for Winner<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let word = match self.set.0.winner(self.point.xyz) {
            (_, Some(leaf)) => {
                let leaf = self.set.0.leaves().swap_remove(leaf);
                leaf.attributes.name.unwrap_or_else(|| leaf.primitive.form().name().to_string())
            }
            (value, None) => if value.re() < 0.0 { "everything" } else { "nothing" }.to_string(),
        };
        Ok(Value::text(&word))
    }
}

/// A field or a set.
enum Either<T: Real> {
    Field(Primitive<T>),
    Set(Set<T>),
}

impl<T: Real> FromValue<T> for Either<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let wrong = || CallError::wrong_class(Class::Set, value.class());
        match value {
            Value::Set(_) => set_of(value).map(Either::Set).ok_or_else(wrong),
            _ => primitive_of(value).map(Either::Field).ok_or_else(wrong),
        }
    }
}

/// The exact gradient of a field or set at a point.
#[derive(Kind)]
#[kind(
    forward,
    class = Vector,
    function,
    name = "gradient",
    example = "vector g = gradient(sphere({0, 0, 0}, 1), {0.5, 0, 0}); assert g.x == 1;"
)]
pub struct Gradient<T: Real> {
    /// The field or set.
    shape: Either<T>,
    /// The point.
    point: Point<T>,
}

impl<T: Real> Build<T> for Gradient<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let p = self.point.xyz;
        Ok(Value::Vector(match self.shape {
            Either::Field(f) => f.gradient(p).slope,
            Either::Set(s) => moldloft_num::Field::value_and_gradient(&s, p).1,
        }))
    }
}

/// Bounds {low, high} of the values of a field or set over a box, rounded outward.
#[derive(Kind)]
#[kind(
    forward,
    class = Numbers,
    function,
    name = "range",
    example = "farray r = range(sphere({0, 0, 0}, 1), {0, 0, 0}, {1, 1, 1}); assert r[1] <= -1; assert r[2] >= 2;"
)]
pub struct Range<T: Real> {
    /// The field or set.
    shape: Either<T>,
    /// Low corner of the box.
    low: Point<T>,
    /// High corner of the box.
    high: Point<T>,
}

impl<T: Real> Build<T> for Range<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let over = Box3 { low: self.low.xyz.re(), high: self.high.xyz.re() };
        let over = crate::error::solid_box(over).map_err(|e| fault(&e).in_field(Self::HIGH))?;
        let range = match self.shape {
            Either::Field(f) => f.re().range(&over),
            Either::Set(s) => s.re().range(&over),
        };
        let ends = vec![T::from(range.low), T::from(range.high)];
        Ok(Value::Numbers(Arc::new(Array::row(ends))))
    }
}

/// The degree of a field, or the highest in a set: numbers 0, planes 1, sums the maximum, products
/// the sum, functions one more, external primitives 100.
#[derive(Kind)]
#[kind(
    forward,
    class = Number,
    function,
    name = "degree",
    example = "AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); assert degree(torus(axis, 2, 0.5)) == 4;"
)]
pub struct Degree<T: Real> {
    /// The field or set.
    shape: Either<T>,
}

impl<T: Real> Build<T> for Degree<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let degree = match self.shape {
            Either::Field(f) => f.degree(),
            Either::Set(s) => s.degree(),
        };
        Ok(Value::Number(T::from(f64::from(degree))))
    }
}

/// The point of a set's surface that is nearest to a point.
///
/// Default box: the bounds of the set.
#[derive(Kind)]
#[kind(
    forward,
    class = Vector,
    function,
    name = "nearest",
    example = "vector p = nearest(set(sphere({0, 0, 0}, 1)), {3, 0, 0}); assert abs(p.x - 1) < 1e-9;"
)]
pub struct NearestPoint<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// The point.
    point: Point<T>,
    /// Low corner of the box.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
    /// Error bound of the distance; default: 1e-6 of the box.
    #[field(default)]
    accuracy: Option<T>,
}

impl<T: Real> Build<T> for NearestPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let set = &self.set.0;
        let plain = set.re();
        let over = region(&plain, &self.low, &self.high, [Self::SET, Self::HIGH])?.over;
        let accuracy = self.accuracy.map_or(1e-6 * over.diagonal(), T::re);
        let p = self.point.xyz;
        let found = crate::nearest(&plain, p.re(), &over, accuracy).map_err(|e| fault(&e))?;
        let Some(found) = found else {
            return Err(CallError::new("no-surface", "the set has no surface in the box")
                .expected("a set whose surface passes through the box")
                .in_field(Self::SET));
        };
        let near = 1e-9 * over.diagonal();
        Ok(Value::Vector(foot::nearest(set, p, found.point, near)))
    }
}

/// The first intersection of a ray with the surface of a set, in lengths of its direction.
#[derive(Kind)]
#[kind(
    forward,
    class = Number,
    function,
    name = "hit",
    example = "assert abs(hit(set(sphere({0, 0, 0}, 1)), {-3, 0, 0}, {1, 0, 0}) - 2) < 1e-12;"
)]
pub struct FirstHit<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Start of the ray.
    start: Point<T>,
    /// Its direction, of any length.
    direction: Point<T>,
    /// Length of the ray; default: through the box of the set.
    #[field(default, min = 0)]
    length: Option<T>,
}

impl<T: Real> Build<T> for FirstHit<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let set = &self.set.0;
        let plain = set.re();
        let (start, direction) = (self.start.xyz, self.direction.xyz);
        let size = direction.re().norm();
        if size == 0.0 {
            let none = FieldError::Degenerate { what: "direction of the ray" };
            return Err(fault(&none).in_field(Self::DIRECTION));
        }
        let none = || {
            CallError::new("no-hit", "the ray does not meet the set")
                .expected("a ray that meets it")
        };
        let length = match self.length {
            Some(length) => length.re(),
            None => {
                let over =
                    around(&plain).map_err(|e| fault(&e).in_field(Self::SET))?.ok_or_else(none)?;
                (over.centre().distance(start.re()) + over.diagonal()) / size
            }
        };
        let ray = foot::ray(start, direction, length);
        let hit = plain.first_hit(&ray).ok_or_else(none)?;
        let leaves = set.leaves();
        // With derivatives, equal primitives may occur twice: the one with this index in the plain
        // set.
        let wanted = &plain.leaves()[hit.leaf].primitive;
        let leaf = leaves.iter().find(|l| l.primitive.re().same(wanted));
        let t = leaf.map(|l| foot::along(l.primitive.of_sheet(), start, direction, hit.t));
        Ok(Value::Number(t.unwrap_or(T::from(hit.t))))
    }
}

/// The distance between two sets; 0 where they overlap or touch.
///
/// Default box: the bounds of the set.
#[derive(Kind)]
#[kind(
    forward,
    class = Number,
    function,
    name = "distance",
    example = "assert abs(distance(set(sphere({0, 0, 0}, 1)), set(sphere({5, 0, 0}, 1))) - 3) < 1e-6;"
)]
pub struct Distance<T: Real> {
    /// A set.
    a: SetArgument<T>,
    /// The other set.
    b: SetArgument<T>,
    /// Low corner of the box.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
    /// Error bound of the distance; default: 1e-5 of the box.
    #[field(default)]
    accuracy: Option<T>,
}

impl<T: Real> Build<T> for Distance<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [a, b] = [&self.a.0, &self.b.0];
        let [p, q] = [a.re(), b.re()];
        let over =
            region(&(p.clone() | q.clone()), &self.low, &self.high, [Self::A, Self::HIGH])?.over;
        let accuracy = self.accuracy.map_or(1e-5 * over.diagonal(), T::re);
        let found = crate::distance(&p, &q, &over, accuracy).map_err(|e| fault(&e))?;
        let Some(found) = found else { return Err(empty(Self::A)) };
        if found.distance == 0.0 {
            return Ok(Value::Number(T::zero()));
        }
        // Each foot moves with its own surface; its slide along the surface does not change the
        // distance.
        let near = 1e-9 * over.diagonal();
        let x = foot::nearest(a, Vec3::lifted(found.second), found.first, near);
        let y = foot::nearest(b, Vec3::lifted(found.first), found.second, near);
        Ok(Value::Number((x - y).norm()))
    }
}

/// The number of bodies of a set, by facets; bodies that only touch are counted separately.
#[derive(Kind)]
#[kind(
    forward,
    class = Number,
    function,
    name = "components",
    example = "assert components(set(sphere({0, 0, 0}, 1)) | set(sphere({5, 0, 0}, 1))) == 2;"
)]
pub struct Components<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Low corner of the box.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
    /// Number of halvings of the longest side of the box.
    #[field(default = 6, min = 1, max = 10)]
    depth: u32,
}

impl<T: Real> Build<T> for Components<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let set = self.set.0.re();
        if set.is_nothing() {
            return Ok(Value::Number(T::zero()));
        }
        let over = region(&set, &self.low, &self.high, [Self::SET, Self::HIGH])?.over;
        let options = options(Resolution::Level(self.depth), context);
        let facets = context.kept.of::<FacetMemo>().facet(&set, &over, &options);
        let facets = facets.map_err(|e| fault(&e))?;
        Ok(Value::Number(T::from(facets.bodies() as f64)))
    }
}

/// A box around a set, {low, high}.
#[derive(Kind)]
#[kind(
    forward,
    class = Vectors,
    function,
    name = "bounds",
    example = "curve b = bounds(set(sphere({0, 0, 0}, 1)), 1e-3); assert abs(b[2].x - 1) < 2e-3;"
)]
pub struct Bounds<T: Real> {
    /// The set.
    set: SetArgument<T>,
    /// Maximum distance between the box and the set.
    #[field(default = 1e-3, min = 0)]
    accuracy: T,
}

impl<T: Real> Build<T> for Bounds<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let found = crate::bounds(&self.set.0.re(), self.accuracy.re()).map_err(|e| fault(&e))?;
        let Some(over) = found else { return Err(empty(Self::SET)) };
        let ends = vec![Vec3::lifted(over.low), Vec3::lifted(over.high)];
        Ok(Value::Vectors(Arc::new(Vectors::row(ends))))
    }
}
