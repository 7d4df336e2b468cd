//! Comparisons that report the values and their difference.

use moldloft_num::Vec3;
use std::fmt::Debug;

/// A type with a distance.
pub trait AbsoluteDistance: Copy + Debug {
    /// The absolute distance.
    fn distance_to(self, other: Self) -> f64;
    /// The distance from zero.
    fn size(self) -> f64;
}

impl AbsoluteDistance for f64 {
    fn distance_to(self, other: f64) -> f64 {
        (self - other).abs()
    }
    fn size(self) -> f64 {
        self.abs()
    }
}

impl AbsoluteDistance for Vec3<f64> {
    fn distance_to(self, other: Vec3<f64>) -> f64 {
        self.distance(other)
    }
    fn size(self) -> f64 {
        self.norm()
    }
}

/// Asserts that `found` is within `accuracy` of `exact`.
///
/// # Panics
/// When it is not, or when one of the two is not a number.
#[track_caller]
pub fn close<T: AbsoluteDistance>(found: T, exact: T, accuracy: f64) {
    let off = found.distance_to(exact);
    assert!(off <= accuracy, "found {found:?}, expected {exact:?}: off by {off:e} > {accuracy:e}");
}

/// Asserts that `found` is within `accuracy` times the size of `exact`.
///
/// # Panics
/// When it is not, or when one of the two is not a number.
#[track_caller]
pub fn close_relative<T: AbsoluteDistance>(found: T, exact: T, accuracy: f64) {
    close(found, exact, accuracy * exact.size());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_the_accuracy() {
        close(1.0, 1.0, 0.0);
        close_relative(1001.0, 1000.0, 1e-3);
        close(Vec3::of(1.0, 2.0, 3.0), Vec3::of(1.0, 2.0, 3.5), 0.5);
    }

    #[test]
    #[should_panic(expected = "off by")]
    fn what_is_off() {
        close_relative(1001.1, 1000.0, 1e-3);
    }

    #[test]
    #[should_panic(expected = "found NaN")]
    fn not_a_number_is_close_to_nothing() {
        close(f64::NAN, 0.0, 1.0);
    }
}
