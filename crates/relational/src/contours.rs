//! Families of sections: by parallel planes, by cylinders about a line, by half-planes through it.

use moldloft_num::{Axis, Plane, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, Contours, Family, FieldId, Kind, OBLIQUE, Point, Value,
};
use std::sync::Arc;

const MOST_SECTIONS: i64 = 10_000;

/// The values start + i step, for i from first to last; `field` is that of the last.
fn values<T: Real>(
    [first, last]: [i32; 2],
    start: T,
    step: T,
    field: FieldId,
) -> Result<Vec<T>, CallError> {
    let count = i64::from(last) - i64::from(first) + 1;
    if count < 1 {
        return Err(CallError::new("empty-range", format!("no section from {first} to {last}"))
            .expected(format!("a last index of at least {first}"))
            .found(last.to_string())
            .in_field(field));
    }
    if count > MOST_SECTIONS {
        return Err(CallError::new("out-of-range", format!("{count} sections are too many"))
            .expected(format!("at most {MOST_SECTIONS}"))
            .found(count.to_string())
            .in_field(field));
    }
    Ok((first..=last).map(|i| start + step * f64::from(i)).collect())
}

fn contours<T: Real>(
    axis: usize,
    family: Family<T>,
    values: Vec<T>,
    shapes: Option<Vec<Value<T>>>,
    field: FieldId,
) -> Result<Value<T>, CallError> {
    for (k, shape) in shapes.iter().flatten().enumerate() {
        let Some(shape) = not_cut(shape) else { continue };
        let error = CallError::new("wrong-class", "contours are drawn on surfaces and bodies")
            .expected("names of surfaces and bodies")
            .found(shape.class().with_article())
            .in_item(k)
            .in_field(field);
        let is_set = matches!(shape, Value::Set(_));
        return Err(if is_set {
            error.help("make a body of the set: SetBody b(set, ...);")
        } else {
            error
        });
    }
    Ok(Value::Contours(Arc::new(Contours { axis, family, values })))
}

/// The entry of a shape or a list of shapes that has no section.
fn not_cut<T: Real>(shape: &Value<T>) -> Option<&Value<T>> {
    match shape {
        Value::Surface(_) | Value::Body(_) => None,
        Value::List(items) => items.iter().find_map(not_cut),
        other => Some(other),
    }
}

macro_rules! contour_kind {
    ($(#[$doc:meta])* $name:ident, $axis:literal, $example:literal) => {
        $(#[$doc])*
        #[derive(Kind)]
        #[kind(class = Contours, columns = "first last start step", example = $example)]
        pub struct $name<T: Real> {
            /// First index i.
            first: i32,
            /// Last index i.
            last: i32,
            /// Position of the section with index 0.
            start: T,
            /// Distance of neighbouring sections.
            step: T,
            /// Surfaces and bodies to cut; default: all visible ones.
            surfaces: Option<Vec<Value<T>>>,
        }

        impl<T: Real> Build<T> for $name<T> {
            fn build(self, _: &Context) -> Result<Value<T>, CallError> {
                let values = values([self.first, self.last], self.start, self.step, Self::LAST)?;
                contours($axis, Family::coordinate($axis), values, self.surfaces, Self::SURFACES)
            }
        }
    };
}

contour_kind!(
    /// Sections x = start + i step, for i from first to last: the stations of a hull.
    XContours, 0,
    "AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); \
     AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); \
     XContours stations(0, 10, 1.8, 2.735);"
);
contour_kind!(
    /// Sections y = start + i step, for i from first to last: the buttocks of a hull.
    YContours, 1,
    "AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); \
     AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); \
     YContours buttocks(0, 4, 0.5, 0.75);"
);
contour_kind!(
    /// Sections z = start + i step, for i from first to last: the waterlines of a hull.
    ZContours, 2,
    "AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); \
     AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); \
     ZContours waterlines(-2, 4, 0, 0.5);"
);

/// Sections by planes parallel to a given plane, at the distances start + i step along its normal,
/// for i from first to last: diagonals, cant frames.
#[derive(Kind)]
#[kind(
    class = Contours,
    columns = "plane first last start step",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0.5, 2); TwoPointPlane deck(A, B); \
               AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); \
               AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); \
               PlaneContours diagonals(deck, 0, 4, -1, 0.5);"
)]
pub struct PlaneContours<T: Real> {
    /// The plane at distance 0.
    plane: Plane<T>,
    /// First index i.
    first: i32,
    /// Last index i.
    last: i32,
    /// Distance of the section with index 0 from the plane.
    start: T,
    /// Distance of neighbouring sections.
    step: T,
    /// Surfaces and bodies to cut; default: all visible ones.
    surfaces: Option<Vec<Value<T>>>,
}

impl<T: Real> Build<T> for PlaneContours<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let values = values([self.first, self.last], self.start, self.step, Self::LAST)?;
        contours(OBLIQUE, Family::Planes(self.plane), values, self.surfaces, Self::SURFACES)
    }
}

/// Sections by cylinders about a line, of the radii start + i step, for i from first to last: the
/// sections of a propeller blade.
#[derive(Kind)]
#[kind(
    class = Contours,
    columns = "line first last start step",
    example = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0.25, 0); Line shaft(O, X); \
               AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); \
               AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); \
               CylinderContours radii(shaft, 0, 8, 1, 0.25);"
)]
pub struct CylinderContours<T: Real> {
    /// The common axis: the line through the ends of a curve.
    line: Axis<T>,
    /// First index i.
    first: i32,
    /// Last index i.
    last: i32,
    /// Radius of the section with index 0.
    start: T,
    /// Difference of neighbouring radii.
    step: T,
    /// Surfaces and bodies to cut; default: all visible ones.
    surfaces: Option<Vec<Value<T>>>,
}

impl<T: Real> Build<T> for CylinderContours<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let values = values([self.first, self.last], self.start, self.step, Self::LAST)?;
        if let Some(k) = values.iter().position(|r| r.re() <= 0.0) {
            let radius = values[k].re();
            let index = i64::from(self.first) + k as i64;
            return Err(CallError::new("out-of-range", format!("a cylinder of radius {radius}"))
                .expected("positive radii")
                .found(format!("the radius {radius} for i = {index}"))
                .in_field(Self::START));
        }
        contours(OBLIQUE, Family::Cylinders(self.line), values, self.surfaces, Self::SURFACES)
    }
}

/// Sections by half-planes through a line, at the angles start + i step about it (right-handed), for
/// i from first to last: the meridians of a body of revolution.
///
/// Angle 0 is on the side of the point `zero` or, without one, of the z-axis (of the x-axis when
/// the line is within a degree of z).
#[derive(Kind)]
#[kind(
    class = Contours,
    columns = "line first last start step",
    example = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0.25, 0); Line shaft(O, X); AbsPoint up(0, 0.5, 2); \
               AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); \
               AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); \
               AngleContours meridians(shaft, 0, 3, -1, 0.5); \
               AngleContours others(shaft, 0, 3, 0.25, 0.5, zero = up);"
)]
pub struct AngleContours<T: Real> {
    /// The common axis: the line through the ends of a curve.
    line: Axis<T>,
    /// First index i.
    first: i32,
    /// Last index i.
    last: i32,
    /// Angle of the section with index 0, in radians (degrees in model files).
    #[field(angle)]
    start: T,
    /// Angle between neighbouring sections, in radians (degrees in model files).
    #[field(angle)]
    step: T,
    /// A point of the half-plane at angle 0.
    zero: Option<Point<T>>,
    /// Surfaces and bodies to cut; default: all visible ones.
    surfaces: Option<Vec<Value<T>>>,
}

/// A line nearer to the z-axis than this (the cosine of a degree) has its zero toward x.
const UPRIGHT: f64 = 0.999_847_695;

impl<T: Real> Build<T> for AngleContours<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let axis = self.line;
        let toward = match &self.zero {
            Some(point) => point.xyz - axis.foot(point.xyz),
            None => {
                let upright = axis.direction.z.re().abs() > UPRIGHT;
                let d: Vec3<T> =
                    if upright { Vec3::of(1.0, 0.0, 0.0) } else { Vec3::of(0.0, 0.0, 1.0) };
                d - axis.direction * axis.direction.dot(d)
            }
        };
        let Some(zero) = toward.normalized() else {
            let key = self.zero.as_ref().and_then(|p| p.key);
            return Err(CallError::new("coincident-points", "the point of angle 0 is on the axis")
                .expected("a point off the axis")
                .found("no direction from the axis to it")
                .related(key, "is on the axis")
                .in_field(Self::ZERO));
        };
        let values = values([self.first, self.last], self.start, self.step, Self::LAST)?;
        contours(OBLIQUE, Family::Angles { axis, zero }, values, self.surfaces, Self::SURFACES)
    }
}
