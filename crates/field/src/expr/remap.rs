//! Primitives with their coordinates replaced by primitives: twists, bends, tapers, repetitions.

use super::form::Form;
use super::interval::Interval;
use super::oracle::{Affine, Oracle};
use super::primitive::{Op, Primitive};
use moldloft_num::{Box3, Field, Real, Vec3};
use std::sync::Arc;

impl<T: Real> Primitive<T> {
    /// The primitive with its coordinates replaced: f(x', y', z') of three primitives.
    ///
    /// A twist, a bend, a taper or a repetition is such a replacement; its inverse moves the solid.
    pub fn remapped(&self, coordinates: &[Self; 3]) -> Self {
        let [x, y, z] = coordinates;
        self.rebuilt(
            &|c| c,
            &|op| match op {
                Op::Plane { normal, offset } => {
                    let term = |n: T, p: &Self| (n.re() != 0.0 || !n.is_constant()).then(|| p * n);
                    let terms = [term(normal.x, x), term(normal.y, y), term(normal.z, z)];
                    let sum = terms.into_iter().flatten().reduce(|a, b| a + b);
                    sum.unwrap_or_else(|| Self::real(T::zero())) + *offset
                }
                Op::User { oracle, map } => {
                    let inner = RemappedOracle {
                        oracle: oracle.clone(),
                        map: **map,
                        coordinates: coordinates.clone(),
                    };
                    Self::user(Arc::new(inner))
                }
                Op::Real(c) => Self::real(*c),
                _ => unreachable!("leaves only"),
            },
            &|form| match form {
                Form::Real(_) => form.clone(),
                _ => Form::General,
            },
        )
    }
}

/// The coordinates of a twist about the z axis by `rate` radians for each unit of z.
pub fn twist<T: Real>(rate: T) -> [Primitive<T>; 3] {
    let [x, y, z] = Primitive::axes();
    let (cos, sin) = ((&z * rate).cos(), (&z * rate).sin());
    [&x * &cos + &y * &sin, &y * &cos - &x * &sin, z]
}

/// A primitive from outside whose coordinates are replaced by primitives.
pub(crate) struct RemappedOracle<T: Real> {
    pub(crate) oracle: Arc<dyn Oracle<T>>,
    pub(crate) map: Affine<T>,
    pub(crate) coordinates: [Primitive<T>; 3],
}

impl<T: Real> RemappedOracle<T> {
    /// The image of a point, and the gradients of its coordinates.
    fn image(&self, p: Vec3<T>) -> (Vec3<T>, [Vec3<T>; 3]) {
        let [x, y, z] = [0, 1, 2].map(|k| self.coordinates[k].gradient(p));
        (self.map.apply(Vec3::new(x.value, y.value, z.value)), [x.slope, y.slope, z.slope])
    }

    /// A box that contains the image of a box.
    fn image_range(&self, over: &Box3) -> Box3 {
        let at = [0, 1, 2].map(|k| self.coordinates[k].re().range(over));
        let at = self.map.re().range(&at);
        Box3 {
            low: Vec3::new(at[0].low, at[1].low, at[2].low),
            high: Vec3::new(at[0].high, at[1].high, at[2].high),
        }
    }
}

impl<T: Real> Field<T> for RemappedOracle<T> {
    fn value(&self, p: Vec3<T>) -> T {
        let [x, y, z] = [0, 1, 2].map(|k| self.coordinates[k].value(p));
        self.oracle.value(self.map.apply(Vec3::new(x, y, z)))
    }
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let (image, [x, y, z]) = self.image(p);
        let (value, g) = self.oracle.value_and_gradient(image);
        let g = self.map.pull_back(g);
        (value, x * g.x + y * g.y + z * g.z)
    }

    moldloft_num::field_facts!(T: second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for RemappedOracle<T> {
    fn range(&self, over: &Box3) -> Interval {
        self.oracle.range(&self.image_range(over))
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        Arc::new(RemappedOracle {
            oracle: self.oracle.re(),
            map: self.map.re(),
            coordinates: [0, 1, 2].map(|k| self.coordinates[k].re()),
        })
    }
}
