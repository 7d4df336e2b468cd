//! Vectors of three and of two components over any scalar.

use crate::Real;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub, SubAssign};

/// A point or vector in space.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<T = f64> {
    /// First coordinate.
    pub x: T,
    /// Second coordinate.
    pub y: T,
    /// Third coordinate.
    pub z: T,
}

/// A pair, such as the parameters (u, v) of a surface.
pub type Vec2<T> = [T; 2];

impl<T: Real> Vec3<T> {
    /// The vector (`x`, `y`, `z`).
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The vector of three plain numbers.
    pub fn of(x: f64, y: f64, z: f64) -> Self {
        Self::new(x.into(), y.into(), z.into())
    }

    /// The zero vector.
    pub fn zero() -> Self {
        Self::default()
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    /// Square of the length.
    #[inline(always)]
    pub fn norm_sq(self) -> T {
        self.dot(self)
    }

    /// Length.
    #[inline(always)]
    pub fn norm(self) -> T {
        self.norm_sq().sqrt()
    }

    /// The unit vector of the same direction, or `None` for the zero vector.
    pub fn normalized(self) -> Option<Self> {
        let length = self.norm();
        (length.re() > 0.0).then(|| self / length)
    }

    /// Distance to `o`.
    pub fn distance(self, o: Self) -> T {
        (self - o).norm()
    }

    /// The point self + t (o - self).
    #[inline(always)]
    pub fn lerp(self, o: Self, t: T) -> Self {
        self * (-t + 1.0) + o * t
    }

    /// Applies `f` to each coordinate.
    #[inline(always)]
    pub fn map<S>(self, mut f: impl FnMut(T) -> S) -> Vec3<S> {
        Vec3 { x: f(self.x), y: f(self.y), z: f(self.z) }
    }

    /// The real parts.
    #[inline(always)]
    pub fn re(self) -> Vec3<f64> {
        self.map(|a| a.re())
    }

    /// A plain vector as a constant of another scalar.
    pub fn lifted(v: Vec3<f64>) -> Self {
        v.map(T::from)
    }

    /// The three coordinates in order.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    /// True when all coordinates, derivatives included, are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// True when all coordinates have the same bits.
    pub fn bits_eq(self, o: Self) -> bool {
        self.x.bits_eq(o.x) && self.y.bits_eq(o.y) && self.z.bits_eq(o.z)
    }

    /// A unit vector perpendicular to this one (which must not be zero).
    pub fn perpendicular(self) -> Self {
        let a = self.re();
        let (x, y, z) = (a.x.abs(), a.y.abs(), a.z.abs());
        let helper = if x <= y && x <= z {
            Self::of(1.0, 0.0, 0.0)
        } else if y <= z {
            Self::of(0.0, 1.0, 0.0)
        } else {
            Self::of(0.0, 0.0, 1.0)
        };
        let p = self.cross(helper);
        p / p.norm()
    }
}

impl<T> From<[T; 3]> for Vec3<T> {
    fn from([x, y, z]: [T; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<T> Index<usize> for Vec3<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, axis: usize) -> &T {
        match axis {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a vector has coordinates 0, 1 and 2"),
        }
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        self.map(|a| a * s)
    }
}

impl<T: Real> Div<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: T) -> Self {
        self.map(|a| a / s)
    }
}

impl<T: Real> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<T: Real> SubAssign for Vec3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_obey_the_textbook() {
        let (a, b) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 5.0, 0.5));
        assert_eq!(a.cross(b).dot(a), 0.0);
        assert_eq!(a.cross(b).dot(b), 0.0);
        let lagrange = a.norm_sq() * b.norm_sq() - a.dot(b).powi(2);
        assert!((a.cross(b).norm_sq() - lagrange).abs() < 1e-9);
        assert_eq!(a.perpendicular().dot(a), 0.0);
        assert!(Vec3::<f64>::zero().normalized().is_none());
    }
}
