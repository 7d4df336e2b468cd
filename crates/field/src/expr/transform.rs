//! Moved, turned, mirrored and scaled primitives: the same expression of mapped planes.

use crate::expr::form::Form;
use crate::expr::oracle::Affine;
use crate::expr::primitive::Op;
use crate::{FieldError, Primitive, error};
use moldloft_num::{Axis, Plane, Real, Vec3};

impl<T: Real> Affine<T> {
    /// Moves by `v`.
    pub fn translation(v: Vec3<T>) -> Self {
        Self { shift: v, ..Self::identity() }
    }

    /// Turns about `axis` by `angle` radians, right-handed.
    pub fn rotation(axis: &Axis<T>, angle: T) -> Self {
        Self::from_images(|p| axis.rotated(p, angle))
    }

    /// Mirrors in `plane`.
    pub fn reflection(plane: &Plane<T>) -> Self {
        Self::from_images(|p| p - plane.normal * (plane.distance(p) * 2.0))
    }

    /// Scales about `point` by `factor`.
    pub fn scaling(point: Vec3<T>, factor: T) -> Self {
        Self::from_images(|p| point + (p - point) * factor)
    }

    /// Stretches along `axis` by `factor`; the plane through its point across it is fixed.
    pub fn stretch(axis: &Axis<T>, factor: T) -> Self {
        let d = axis.direction;
        Self::from_images(|p| p + d * (d.dot(p - axis.point) * (factor - 1.0)))
    }

    /// The affine map with these images of points.
    fn from_images(image: impl Fn(Vec3<T>) -> Vec3<T>) -> Self {
        let shift = image(Vec3::zero());
        let columns = Self::identity().rows.map(|e| image(e) - shift);
        let row = |k: usize| Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
        Self { rows: [row(0), row(1), row(2)], shift }
    }

    /// The factor of all lengths, when there is one: to rounding, the rows are perpendicular and
    /// equally long.
    fn similarity(&self) -> Option<T> {
        let [a, b, c] = self.rows;
        let size = a.norm_sq();
        let small = |x: T| x.re().abs() <= 1e-12 * size.re();
        let similar = small(b.norm_sq() - size)
            && small(c.norm_sq() - size)
            && small(a.dot(b))
            && small(b.dot(c))
            && small(c.dot(a));
        (similar && size.re() > 0.0).then(|| size.sqrt())
    }
}

impl<T: Real> Primitive<T> {
    /// The primitive moved by an affine map: its value at the image of a point is the old value at
    /// the point. Planes stay planes; forms are preserved by uniform scaling.
    ///
    /// # Errors
    /// A map without inverse.
    pub fn mapped(&self, world_from: &Affine<T>) -> Result<Self, FieldError> {
        error::finite("map", world_from.shift)?;
        let local_from = world_from.inverse().ok_or(FieldError::Degenerate { what: "map" })?;
        let similarity = world_from.similarity();
        Ok(self.rebuilt(
            &|c| c,
            &|op| match op {
                Op::Plane { normal, offset } => Primitive::linear(
                    local_from.pull_back(*normal),
                    normal.dot(local_from.shift) + *offset,
                ),
                Op::User { oracle, map } => Primitive::from_op(Op::User {
                    oracle: oracle.clone(),
                    map: Box::new(map.after(&local_from)),
                }),
                Op::Real(c) => Primitive::real(*c),
                _ => unreachable!("leaves only"),
            },
            &|form| match (form, similarity) {
                (Form::Real(_), _) => form.clone(),
                (_, Some(scale)) => form.moved(world_from, scale),
                (_, None) => Form::General,
            },
        ))
    }
}
