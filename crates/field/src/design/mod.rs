//! Operations on whole sets: offset and shell by true distance, fillets between sets, rounded and chamfered edges.
//!
//! All are sets of fields again: their surfaces have closed forms, and derivatives by every parameter. Edges are named by the
//! two faces that meet in them, which change of parameters leaves as they are.

mod convex;
mod discs;
mod edges;
mod hull;
mod mitre;
mod terms;

pub use convex::{convex_hull, minkowski_sum};
pub use edges::{Edges, chamfer_edges, fillet_sets, round_edges};

use crate::expr::form::Form;
use crate::query::separation::solid_within;
use crate::{FieldError, Primitive, Set};
use moldloft_num::Real;
use terms::BodyTerms;

impl<T: Real> Primitive<T> {
    /// The same solid by the distance from its surface, exact outside and inside.
    ///
    /// # Errors
    /// [`FieldError::NoDistance`] without a closed form: planes, balls, cylinders, cones and tori
    /// have one.
    pub fn distance_form(&self) -> Result<Self, FieldError> {
        let none = || FieldError::NoDistance { kind: self.form().name() };
        let within = solid_within(&self.re()).ok_or_else(none)?;
        let f = match self.form() {
            Form::Plane(p) => Self::plane(p.normal, p.point)?,
            Form::Sphere { centre, radius } => Self::sphere_distance(*centre, *radius)?,
            Form::Cylinder { axis, radius } => Self::cylinder_distance(*axis, *radius)?,
            Form::Torus { axis, major, minor } => Self::torus_distance(*axis, *major, *minor)?,
            Form::Cone { axis, angle } => Self::cone_distance(*axis, *angle)?,
            _ => return Err(none()),
        };
        Ok(if within { f } else { -f })
    }
}

/// The solid side of a primitive grown by a distance.
fn grown<T: Real>(p: &Primitive<T>, distance: T) -> Result<Set<T>, FieldError> {
    let none = || FieldError::NoDistance { kind: p.form().name() };
    let within = solid_within(&p.re()).ok_or_else(none)?;
    let radius = |r: T| if within { r + distance } else { r - distance };
    let closed = |r: T, made: &dyn Fn(T) -> Result<Primitive<T>, FieldError>| match r.re() > 0.0 {
        true => made(r).map(|f| Set::of_leaf(&if within { f } else { -f })),
        // A hole that is filled, or a body that is gone.
        false => Ok(if within { Set::nothing() } else { Set::everything() }),
    };
    match p.form() {
        Form::Sphere { centre, radius: r } => {
            closed(radius(*r), &|r| Primitive::sphere_distance(*centre, r))
        }
        Form::Cylinder { axis, radius: r } => {
            closed(radius(*r), &|r| Primitive::cylinder_distance(*axis, r))
        }
        Form::Torus { axis, major, minor } => {
            closed(radius(*minor), &|r| Primitive::torus_distance(*axis, *major, r))
        }
        _ => Ok(Set::of_leaf(&(p.distance_form()? - distance))),
    }
}

impl<T: Real> Set<T> {
    /// The body grown by a distance, or shrunk by a negative one: its visible faces move along
    /// their normals. Opening edges are mitred, all others are exact.
    ///
    /// Faces of the formula on which the body does not end, such as those between parts face to face or the ends of a cutter
    /// outside, do not count.
    ///
    /// # Errors
    /// [`FieldError::NoDistance`] for a face without a distance in closed form; [`FieldError::ManyFaces`];
    /// [`FieldError::HiddenEdge`]; a distance that is not finite.
    ///
    /// # Example
    /// ```
    /// use moldloft_field::Set;
    /// use moldloft_num::Vec3;
    ///
    /// let block = Set::cuboid(Vec3::of(0.0, 0.0, 0.0), Vec3::of(2.0, 1.0, 1.0))?;
    /// assert_eq!(block.offset(0.25)?.value(Vec3::of(1.0, 0.5, 1.5)), 0.25);
    /// # Ok::<(), moldloft_field::FieldError>(())
    /// ```
    pub fn offset(&self, distance: T) -> Result<Self, FieldError> {
        if !distance.is_finite() {
            return Err(FieldError::NotFinite { what: "distance" });
        }
        let inward = distance.re() < 0.0;
        let body = BodyTerms::of(self, inward)?;
        let more = if inward { -distance } else { distance };
        let target = if inward { self.re().complement() } else { self.re() };
        let over = body.over;
        if let Some(place) = mitre::false_mitre(&body, &target, &over, more.re())? {
            return Err(FieldError::HiddenEdge { place });
        }
        let made =
            body.set(&|leaf| Ok(grown(&leaf.primitive, more)?.with(leaf.attributes.clone())))?;
        let made = match (inward, body.near_only) {
            (false, _) => made,
            (true, false) => made.complement(),
            // Parts far outside may be missing in the offset set.
            (true, true) => made.complement() & self.clone(),
        };
        Ok(match self.attributes() {
            Some(own) => made.with(own.clone()),
            None => made,
        })
    }

    /// The wall of the given thickness inside the body's surface.
    ///
    /// # Errors
    /// As [`Set::offset`]; a thickness that is not above zero.
    pub fn shell(&self, thickness: T) -> Result<Self, FieldError> {
        let thickness = crate::error::positive("thickness", thickness)?;
        Ok(self - &self.offset(-thickness)?)
    }

    /// The body as a union of intersections of primitives, without faces that it does not show.
    fn pieces(&self) -> Result<Vec<Vec<Primitive<T>>>, FieldError> {
        let body = BodyTerms::of(self, false)?;
        let piece = |term: &Vec<u32>| {
            term.iter().map(|code| body.literal(*code).primitive.clone()).collect()
        };
        Ok(body.terms.iter().map(piece).collect())
    }
}
