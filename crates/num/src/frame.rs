//! Planes, axes and right-handed orthonormal frames.

use crate::{Real, Vec3};

/// A plane: the points X with n . (X - p) = 0. The unit normal points to its positive side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<T> {
    /// A point of the plane.
    pub point: Vec3<T>,
    /// Its unit normal.
    pub normal: Vec3<T>,
}

impl<T: Real> Plane<T> {
    /// Through `point` with the direction of `normal`, or `None` when that is zero.
    pub fn new(point: Vec3<T>, normal: Vec3<T>) -> Option<Self> {
        Some(Self { point, normal: normal.normalized()? })
    }

    /// Signed distance of `p`, positive on the side of the normal.
    pub fn distance(&self, p: Vec3<T>) -> T {
        self.normal.dot(p - self.point)
    }

    /// Foot of the perpendicular from `p`.
    pub fn foot(&self, p: Vec3<T>) -> Vec3<T> {
        p - self.normal * self.distance(p)
    }
}

/// A directed line in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis<T> {
    /// A point of the line.
    pub point: Vec3<T>,
    /// Its unit direction.
    pub direction: Vec3<T>,
}

impl<T: Real> Axis<T> {
    /// The line from `from` towards `to`, or `None` when they coincide.
    pub fn through(from: Vec3<T>, to: Vec3<T>) -> Option<Self> {
        Some(Self { point: from, direction: (to - from).normalized()? })
    }

    /// Foot of the perpendicular from `p`.
    pub fn foot(&self, p: Vec3<T>) -> Vec3<T> {
        self.point + self.direction * self.direction.dot(p - self.point)
    }

    /// `p` turned about the line by `angle` radians, right-handed (Rodrigues).
    pub fn rotated(&self, p: Vec3<T>, angle: T) -> Vec3<T> {
        self.turned(p, angle.cos(), angle.sin())
    }

    /// `p` turned about the line by the angle of cosine `c` and sine `s`.
    pub fn turned(&self, p: Vec3<T>, c: T, s: T) -> Vec3<T> {
        let d = p - self.point;
        let k = self.direction;
        self.point + d * c + k.cross(d) * s + k * (k.dot(d) * (-c + 1.0))
    }
}

/// A right-handed orthonormal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<T> {
    /// Origin in world coordinates.
    pub origin: Vec3<T>,
    /// Unit axes in world coordinates.
    pub axes: [Vec3<T>; 3],
}

impl<T: Real> Frame<T> {
    /// The world's own frame.
    pub fn world() -> Self {
        Self {
            origin: Vec3::zero(),
            axes: [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0), Vec3::of(0.0, 0.0, 1.0)],
        }
    }

    /// Origin `o`, first axis towards `x`, second axis in the plane of `o`, `x`, `xy` on the side
    /// of `xy`; `None` when the three are in line.
    pub fn through(o: Vec3<T>, x: Vec3<T>, xy: Vec3<T>) -> Option<Self> {
        let e1 = (x - o).normalized()?;
        let e3 = e1.cross(xy - o).normalized()?;
        Some(Self { origin: o, axes: [e1, e3.cross(e1), e3] })
    }

    /// The world position of local coordinates.
    pub fn world_from(&self, p: Vec3<T>) -> Vec3<T> {
        self.origin + self.axes[0] * p.x + self.axes[1] * p.y + self.axes[2] * p.z
    }

    /// The local coordinates of a world position.
    pub fn local_from(&self, p: Vec3<T>) -> Vec3<T> {
        let d = p - self.origin;
        Vec3::new(self.axes[0].dot(d), self.axes[1].dot(d), self.axes[2].dot(d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_z() {
        let axis = Axis::<f64>::through(Vec3::of(0.0, 0.0, -3.0), Vec3::of(0.0, 0.0, 9.0)).unwrap();
        let p = axis.rotated(Vec3::of(1.0, 0.0, 2.0), std::f64::consts::FRAC_PI_2);
        assert!(p.distance(Vec3::of(0.0, 1.0, 2.0)) < 1e-15);
        assert!(Axis::<f64>::through(Vec3::of(1.0, 1.0, 1.0), Vec3::of(1.0, 1.0, 1.0)).is_none());
    }

    #[test]
    fn frames_invert() {
        let f = Frame::<f64>::through(
            Vec3::of(1.0, 2.0, 3.0),
            Vec3::of(4.0, 2.5, 3.0),
            Vec3::of(0.0, 5.0, 4.0),
        )
        .unwrap();
        let p = Vec3::of(0.3, -7.0, 2.0);
        assert!(f.world_from(f.local_from(p)).distance(p) < 1e-14);
    }
}
