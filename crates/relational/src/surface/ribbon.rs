//! The tangent planes of a surface along a snake on it.

use crate::arguments::Snake;
use crate::third_derivatives::{bends, tangent, tangents};
use moldloft_num::{Jet, Order, Real, Vec3, lift_curve};

/// A point of a snake with the tangent plane of its surface.
#[derive(Clone, Copy)]
pub struct SnakePoint<J> {
    /// The parameters (u, v, 0) on the surface.
    pub place: Vec3<J>,
    /// The position.
    pub p: Vec3<J>,
    /// The derivative of the position along the snake.
    pub along: Vec3<J>,
    /// S_u and S_v.
    pub tangents: [Vec3<J>; 2],
    /// The unit normal, or zero if undefined.
    pub normal: Vec3<J>,
}

/// The tangent plane at parameter `t` of a snake.
pub fn ribbon<T: Real, J: Jet<T>>(snake: &Snake<T>, t: J) -> SnakePoint<J> {
    let path = |t: T, order: Order| snake.path(t, order);
    let place = lift_curve(&path(t.value(), J::ORDER), t);
    let step = tangent(path, || snake.curve.breaks(), t);
    let [su, sv] = tangents(&*snake.surface, place.x, place.y);
    SnakePoint {
        place,
        p: snake.surface.at(place.x, place.y),
        along: su * step.x + sv * step.y,
        tangents: [su, sv],
        normal: unit(su.cross(sv)),
    }
}

/// The unit vector, or zero for the zero vector.
pub fn unit<J: Real>(v: Vec3<J>) -> Vec3<J> {
    v.normalized().unwrap_or_default()
}

impl<J: Real> SnakePoint<J> {
    /// The normal curvature of the surface in the direction of a tangent vector, times the square
    /// of its length; positive where the surface bends towards its normal.
    pub fn bend<T: Real>(&self, snake: &Snake<T>, d: Vec3<J>) -> J
    where
        J: Jet<T>,
    {
        // d = a S_u + b S_v, by the metric.
        let [su, sv] = self.tangents;
        let (e, f, g) = (su.dot(su), su.dot(sv), sv.dot(sv));
        let (x, y) = (d.dot(su), d.dot(sv));
        let det = e * g - f * f;
        let (a, b) = ((x * g - y * f) / det, (y * e - x * f) / det);
        let [uu, uv, vv] = bends(&*snake.surface, self.place.x, self.place.y);
        let along = |v: Vec3<J>| v.dot(self.normal);
        along(uu) * a * a + along(uv) * a * b * 2.0 + along(vv) * b * b
    }
}
