//! Axis-aligned boxes, as bounds of points.

use crate::Vec3;

/// An axis-aligned box, initially empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// Low corner.
    pub low: Vec3,
    /// High corner.
    pub high: Vec3,
}

impl Box3 {
    /// The empty box.
    pub const EMPTY: Self = Self {
        low: Vec3 { x: f64::INFINITY, y: f64::INFINITY, z: f64::INFINITY },
        high: Vec3 { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY, z: f64::NEG_INFINITY },
    };

    /// The smallest box around the points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// The smallest box around this one and the point `p`.
    #[inline]
    pub fn including(self, p: Vec3) -> Self {
        let (low, high) = (self.low, self.high);
        Self {
            low: Vec3 { x: low.x.min(p.x), y: low.y.min(p.y), z: low.z.min(p.z) },
            high: Vec3 { x: high.x.max(p.x), y: high.y.max(p.y), z: high.z.max(p.z) },
        }
    }

    /// The smallest box around both.
    pub fn union(self, o: Self) -> Self {
        if o.is_empty() { self } else { self.including(o.low).including(o.high) }
    }

    /// True when the box contains nothing.
    pub fn is_empty(self) -> bool {
        self.low.x > self.high.x
    }

    /// True when the boxes have a point in common; a box with NaN meets every box.
    #[inline]
    pub fn meets(self, o: Self) -> bool {
        let ([a, b], [c, d]) = ([self.low, self.high], [o.low, o.high]);
        !(a.x > d.x || c.x > b.x || a.y > d.y || c.y > b.y || a.z > d.z || c.z > b.z)
    }

    /// The box that is larger by `margin` on each side.
    pub fn grown(self, margin: f64) -> Self {
        let by = Vec3 { x: margin, y: margin, z: margin };
        Self { low: self.low - by, high: self.high + by }
    }

    /// The centre; the origin for the empty box.
    pub fn centre(self) -> Vec3 {
        if self.is_empty() { Vec3::zero() } else { (self.low + self.high) * 0.5 }
    }

    /// Length of the diagonal; 0 for the empty box. Tolerances are derived from it.
    pub fn diagonal(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.low.distance(self.high) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grows_around_points() {
        let b = Box3::around([Vec3::of(1.0, 5.0, 0.0), Vec3::of(-2.0, 1.0, 0.0)]);
        assert_eq!((b.low, b.high), (Vec3::of(-2.0, 1.0, 0.0), Vec3::of(1.0, 5.0, 0.0)));
        assert_eq!(b.diagonal(), 5.0);
        assert!(Box3::EMPTY.is_empty() && Box3::EMPTY.diagonal() == 0.0);
        assert_eq!(Box3::EMPTY.union(b), b);
    }
}
