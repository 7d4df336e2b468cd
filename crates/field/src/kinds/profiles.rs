//! Plane curves as fields and sets: prisms and bodies of revolution, as rows of the registry.

use super::read::{fault, field_value, set, set_value};
use crate::shapes::profile::{NotAProfile, ProfileField};
use crate::{Affine, Primitive, Set};
use moldloft_num::{Axis, Real, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, FieldId, Kind, Point, Value};
use std::sync::Arc;

fn refused(why: NotAProfile, place: FieldId) -> CallError {
    let (expected, found) = match why {
        NotAProfile::Open(gap) => ("a closed curve", format!("one whose ends are {gap:.3e} apart")),
        NotAProfile::Bent(away) => {
            ("a plane curve", format!("one that leaves its plane by {away:.3e}"))
        }
        NotAProfile::Flat => ("a curve round an area", "one without area".to_owned()),
        NotAProfile::Beside(away) => (
            "a line in the plane of the curve that it does not cross",
            format!("a line that is off by {away:.3e}, or that much of the curve beyond it"),
        ),
    };
    CallError::new("no-profile", "the curve is not a profile")
        .expected(expected)
        .found(found)
        .in_field(place)
}

fn user<T: Real>(profile: ProfileField<T>) -> Primitive<T> {
    Primitive::user(Arc::new(profile))
}

/// The signed distance from a closed plane curve, measured in its plane: a prism without ends, negative inside.
///
/// The curve must not cross itself; if it does, regions of odd winding are inside.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "profile",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); BCurve c({A, B, C, A}, degree = 1); field f = profile(c); assert abs(f({3, 0, 7}) - 1) < 1e-9;"
)]
pub struct ProfileOf<T: Real> {
    /// The closed plane curve.
    curve: CurveRef<T>,
}

impl<T: Real> Build<T> for ProfileOf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let profile = ProfileField::new(self.curve).map_err(|why| refused(why, Self::CURVE))?;
        Ok(field_value(user(profile)))
    }
}

/// The prism over a closed plane curve, from its plane to the plane moved by a vector, which may be oblique.
///
/// Its volume is the area of the curve times the height of the vector over the plane.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "extruded",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); BCurve c({A, B, C, A}, degree = 1); set s = extruded(c, {0, 0, 0.5}); SetBody bar(s, {-0.1, -0.1, -0.1}, {2.2, 1.1, 0.6}, depth = 4); assert abs(bar.volume - 0.5) < 0.01;"
)]
pub struct Extruded<T: Real> {
    /// The closed plane curve.
    curve: CurveRef<T>,
    /// Vector from its plane to the end.
    by: Point<T>,
}

impl<T: Real> Build<T> for Extruded<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let profile = ProfileField::new(self.curve).map_err(|why| refused(why, Self::CURVE))?;
        prism(profile, self.by.xyz, Self::BY).map(set_value)
    }
}

/// The prism over the region inside an odd number of closed curves of one plane, such as the outlines of a text.
///
/// The curves must not cross one another.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "extruded_region",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(3, 0, 0); AbsPoint C(3, 3, 0); AbsPoint D(0, 3, 0); BCurve c({A, B, C, D, A}, degree = 1); AbsPoint P(1, 1, 0); AbsPoint Q(2, 1, 0); AbsPoint R(2, 2, 0); AbsPoint S(1, 2, 0); BCurve d({P, Q, R, S, P}, degree = 1); set s = extruded_region({c, d}, {0, 0, 0.5}); SetBody frame(s, {-0.1, -0.1, -0.1}, {3.2, 3.1, 0.6}, depth = 5); assert abs(frame.volume - 4) < 0.01;"
)]
pub struct ExtrudedRegion<T: Real> {
    /// The closed curves.
    curves: Vec<CurveRef<T>>,
    /// Vector from their plane to the end.
    by: Point<T>,
}

impl<T: Real> Build<T> for ExtrudedRegion<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let profiles = self.curves.into_iter().enumerate().map(|(k, curve)| {
            ProfileField::new(curve).map_err(|why| refused(why, Self::CURVES).in_item(k))
        });
        let profiles = profiles.collect::<Result<Vec<_>, _>>()?;
        let Some(first) = profiles.first() else {
            return Err(CallError::new("empty-list", "no curves").in_field(Self::CURVES));
        };
        let off = profiles.iter().map(|p| first.off(p)).fold(0.0, f64::max);
        if off > 1e-9 {
            return Err(refused(NotAProfile::Bent(off), Self::CURVES));
        }
        // Prisms by the number of curves around them.
        let mut levels: Vec<Option<Set<T>>> = Vec::new();
        let around: Vec<usize> = profiles
            .iter()
            .map(|p| profiles.iter().filter(|q| !std::ptr::eq(*q, p) && q.encloses(p)).count())
            .collect();
        for (profile, level) in profiles.into_iter().zip(around) {
            let own = prism(profile, self.by.xyz, Self::BY)?;
            if levels.len() <= level {
                levels.resize(level + 1, None);
            }
            levels[level] = Some(match levels[level].take() {
                Some(set) => set | own,
                None => own,
            });
        }
        let mut made: Option<Set<T>> = None;
        for pair in levels.chunks(2) {
            let Some(solid) = pair[0].clone() else { continue };
            let ring = match pair.get(1).cloned().flatten() {
                Some(hole) => solid & hole.complement(),
                None => solid,
            };
            made = Some(match made {
                Some(set) => set | ring,
                None => ring,
            });
        }
        made.map(set_value)
            .ok_or_else(|| CallError::new("empty-list", "no curves").in_field(Self::CURVES))
    }
}

/// The part of a prism without ends from the plane of its curve to that plane moved by a vector.
fn prism<T: Real>(
    profile: ProfileField<T>,
    by: Vec3<T>,
    field: FieldId,
) -> Result<Set<T>, CallError> {
    let [point, normal] = profile.plane();
    let height = by.dot(normal);
    if height.re().abs() <= 1e-9 * by.re().norm() {
        return Err(CallError::new("out-of-range", "the vector lies in the plane of the curve")
            .expected("a vector that leaves the plane")
            .found(format!("a height of {:.3e}", height.re()))
            .in_field(field));
    }
    let mut prism = profile.into_set().map_err(|e| fault(&e))?;
    let aside = by - normal * height;
    let constant = aside.to_array().iter().all(|x| x.is_constant());
    if !constant || aside.re().norm() > 1e-12 * by.re().norm() {
        // The sideways move of a point is proportional to its height.
        let w = aside / height;
        let row = |k: usize| Affine::identity().rows[k] + normal * w[k];
        let rows = [row(0), row(1), row(2)];
        let shear = Affine { rows, shift: -w * point.dot(normal) };
        prism = prism.mapped(&shear).map_err(|e| fault(&e))?;
    }
    let up = if height.re() > 0.0 { normal } else { -normal };
    let half = |n: Vec3<T>, at: Vec3<T>| {
        Primitive::plane(n, at).map(|p| Set::new(&p)).map_err(|e| fault(&e))
    };
    Ok(prism & half(-up, point)? & half(up, point + by)?)
}

/// The solid of revolution of a closed plane curve about a line in its plane.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "revolved",
    example = "AbsPoint A(2, 0, 0); AbsPoint B(3, 0, 0); AbsPoint C(2, 0, 1); BCurve c({A, B, C, A}, degree = 1); AbsPoint P(0, 0, 0); AbsPoint Q(0, 0, 1); Line axis(P, Q); set s = revolved(c, axis); SetBody ring(s, {-3.1, -3.1, -0.1}, {3.1, 3.1, 1.1}, depth = 5); assert abs(ring.volume - 7*PI/3) < 0.1;"
)]
pub struct ProfileRevolved<T: Real> {
    /// The closed plane curve.
    curve: CurveRef<T>,
    /// The axis: a line in the plane of the curve that does not cross it.
    axis: Axis<T>,
}

impl<T: Real> Build<T> for ProfileRevolved<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let place = |why: &NotAProfile| match why {
            NotAProfile::Beside(_) => Self::AXIS,
            _ => Self::CURVE,
        };
        let profile = ProfileField::turned(self.curve, self.axis).map_err(|why| {
            let at = place(&why);
            refused(why, at)
        })?;
        set(profile.into_set())
    }
}
