//! Attitudes of a body in the water.

use moldloft_num::{Real, Vec3};

/// Attitude of a body in the water: heel about its own x axis, then trim about the horizontal axis
/// across it, both through its origin; then the water level, relative to the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude<T> {
    /// Height of the water above the origin of the body.
    pub level: T,
    /// Radians; positive immerses the end with large x.
    pub trim: T,
    /// Radians; positive immerses the side with large y.
    pub heel: T,
}

impl<T: Real> Attitude<T> {
    /// The upright attitude with the water at `level`.
    pub fn upright(level: T) -> Self {
        Self { level, trim: T::zero(), heel: T::zero() }
    }

    /// The three numbers: level, trim, heel.
    pub fn to_array(self) -> [T; 3] {
        [self.level, self.trim, self.heel]
    }

    /// The attitude of three numbers.
    pub fn of([level, trim, heel]: [T; 3]) -> Self {
        Self { level, trim, heel }
    }

    /// A point of the body in earth axes: x horizontal along the body, z up.
    pub fn earth_from(&self, p: Vec3<T>) -> Vec3<T> {
        let (st, ct, sh, ch) = self.turns();
        let (y, z) = (p.y * ch + p.z * sh, p.z * ch - p.y * sh);
        Vec3::new(p.x * ct + z * st, y, z * ct - p.x * st)
    }

    /// The reverse of [`Attitude::earth_from`].
    pub fn body_from(&self, p: Vec3<T>) -> Vec3<T> {
        let (st, ct, sh, ch) = self.turns();
        let (x, z) = (p.x * ct - p.z * st, p.z * ct + p.x * st);
        Vec3::new(x, p.y * ch - z * sh, z * ch + p.y * sh)
    }

    /// The height z of the water in body axes at (x, y) = (`x`, 0).
    pub fn water_over(&self, x: T) -> T {
        let (st, ct, _, ch) = self.turns();
        (self.level + x * st) / (ct * ch)
    }

    /// The level at which the water is at height `z` in body axes at (`x`, 0).
    pub fn level_at(trim: T, heel: T, x: T, z: T) -> T {
        let (st, ct, _, ch) = Self { level: T::zero(), trim, heel }.turns();
        z * ct * ch - x * st
    }

    /// The rotation from body axes to earth axes; `None` for an upright body.
    pub(crate) fn rotation(&self) -> Option<impl Fn(Vec3<T>) -> Vec3<T> + use<T>> {
        let still = |a: T| a.re() == 0.0 && a.is_constant();
        let (st, ct, sh, ch) = self.turns();
        let place = move |p: Vec3<T>| {
            let (y, z) = (p.y * ch + p.z * sh, p.z * ch - p.y * sh);
            Vec3::new(p.x * ct + z * st, y, z * ct - p.x * st)
        };
        (!(still(self.trim) && still(self.heel))).then_some(place)
    }

    /// The earth axes in body axes.
    pub(crate) fn axes(&self) -> [Vec3<T>; 3] {
        let (st, ct, sh, ch) = self.turns();
        let x = Vec3::new(ct, -sh * st, ch * st);
        [x, Vec3::new(T::zero(), ch, sh), Vec3::new(-st, -sh * ct, ch * ct)]
    }

    fn turns(&self) -> (T, T, T, T) {
        (self.trim.sin(), self.trim.cos(), self.heel.sin(), self.heel.cos())
    }
}
