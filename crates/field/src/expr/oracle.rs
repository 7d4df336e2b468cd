//! Primitives from outside: a scan, a mesh's distance, a Python function.

use crate::expr::interval::Interval;
use moldloft_num::{Box3, Field, Real, Vec3};
use std::sync::Arc;

/// An external primitive. Its ranges must contain all its values; wide ranges cost time, wrong ones
/// correctness.
pub trait Oracle<T: Real>: Field<T> {
    /// A range of the value over a box.
    fn range(&self, over: &Box3) -> Interval;

    /// A range of the gradient over a box; everything when nothing is known.
    fn gradient_range(&self, _over: &Box3) -> [Interval; 3] {
        [Interval::ENTIRE; 3]
    }

    /// True if its surface may have an edge in the box on which no vertex is placed.
    fn creased_in(&self, _over: &Box3) -> bool {
        false
    }

    /// The values at many points.
    fn values(&self, points: &[Vec3<T>], out: &mut [T]) {
        for (x, p) in out.iter_mut().zip(points) {
            *x = self.value(*p);
        }
    }

    /// The values and gradients at many points.
    fn values_and_gradients(&self, points: &[Vec3<T>]) -> Vec<(T, Vec3<T>)> {
        points.iter().map(|p| self.value_and_gradient(*p)).collect()
    }

    /// The function with real parts only.
    fn re(&self) -> Arc<dyn Oracle<f64>>;
}

/// A plain primitive in calculations with derivatives: it depends on no parameter, though its
/// position may.
pub struct Constant(pub Arc<dyn Oracle<f64>>);

/// True when a point carries no derivatives.
fn fixed<T: Real>(p: &Vec3<T>) -> bool {
    p.to_array().iter().all(|x| x.is_constant())
}

/// Plain numbers as ones with derivatives that are zero.
fn lifted<T: Real>((value, gradient): (f64, Vec3)) -> (T, Vec3<T>) {
    (T::from(value), Vec3::lifted(gradient))
}

impl<T: Real> Field<T> for Constant {
    fn value(&self, p: Vec3<T>) -> T {
        if fixed(&p) {
            return T::from(self.0.value(p.re()));
        }
        let (value, gradient) = self.0.value_and_gradient(p.re());
        let d = p - Vec3::lifted(p.re());
        d.x * gradient.x + d.y * gradient.y + d.z * gradient.z + value
    }

    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        if fixed(&p) {
            return lifted(self.0.value_and_gradient(p.re()));
        }
        let (value, gradient, second) = self.0.second_order(p.re());
        let d = p - Vec3::lifted(p.re());
        let along = |row: Vec3, x: f64| d.x * row.x + d.y * row.y + d.z * row.z + x;
        let slope = Vec3::new(
            along(second[0], gradient.x),
            along(second[1], gradient.y),
            along(second[2], gradient.z),
        );
        (along(gradient, value), slope)
    }

    moldloft_num::field_facts!(T: second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for Constant {
    fn creased_in(&self, over: &Box3) -> bool {
        self.0.creased_in(over)
    }
    fn range(&self, over: &Box3) -> Interval {
        self.0.range(over)
    }
    fn gradient_range(&self, over: &Box3) -> [Interval; 3] {
        self.0.gradient_range(over)
    }
    fn values(&self, points: &[Vec3<T>], out: &mut [T]) {
        if points.iter().all(fixed) {
            let plain: Vec<Vec3> = points.iter().map(|p| p.re()).collect();
            let mut values = vec![0.0; plain.len()];
            self.0.values(&plain, &mut values);
            out.iter_mut().zip(values).for_each(|(out, value)| *out = T::from(value));
            return;
        }
        for (out, p) in out.iter_mut().zip(points) {
            *out = Field::<T>::value(self, *p);
        }
    }
    fn values_and_gradients(&self, points: &[Vec3<T>]) -> Vec<(T, Vec3<T>)> {
        if points.iter().all(fixed) {
            let plain: Vec<Vec3> = points.iter().map(|p| p.re()).collect();
            return self.0.values_and_gradients(&plain).into_iter().map(lifted).collect();
        }
        points.iter().map(|p| self.value_and_gradient(*p)).collect()
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        self.0.clone()
    }
}

/// An affine map of space, here from the world to the frame in which a primitive was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<T> {
    /// Rows of the matrix.
    pub rows: [Vec3<T>; 3],
    /// Translation after it.
    pub shift: Vec3<T>,
}

impl<T: Real> Affine<T> {
    /// The identity map.
    pub fn identity() -> Self {
        let rows = [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0), Vec3::of(0.0, 0.0, 1.0)];
        Self { rows, shift: Vec3::zero() }
    }

    /// The image of a point.
    #[inline(always)]
    pub fn apply(&self, p: Vec3<T>) -> Vec3<T> {
        self.linear(p) + self.shift
    }

    /// The image of a vector.
    #[inline(always)]
    pub fn linear(&self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(self.rows[0].dot(v), self.rows[1].dot(v), self.rows[2].dot(v))
    }

    /// The transposed matrix times `g`: the gradient of f(map(p)) from that of f.
    pub fn pull_back(&self, g: Vec3<T>) -> Vec3<T> {
        self.rows[0] * g.x + self.rows[1] * g.y + self.rows[2] * g.z
    }

    /// A'HA: the second derivatives of f(map(p)) from those of f.
    pub(crate) fn pull_back_matrix(&self, h: [Vec3<T>; 3]) -> [Vec3<T>; 3] {
        let right = h.map(|row| self.pull_back(row));
        let column = |k: usize| Vec3::new(right[0][k], right[1][k], right[2][k]);
        [0, 1, 2].map(|k| self.pull_back(column(k)))
    }

    /// This map after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self { rows: self.rows.map(|row| first.pull_back(row)), shift: self.apply(first.shift) }
    }

    /// The map with real parts only.
    pub fn re(&self) -> Affine<f64> {
        Affine { rows: self.rows.map(|r| r.re()), shift: self.shift.re() }
    }

    /// The determinant of the matrix.
    pub fn determinant(&self) -> T {
        self.rows[0].dot(self.rows[1].cross(self.rows[2]))
    }

    /// The inverse map, or `None` when the matrix is singular.
    pub fn inverse(&self) -> Option<Self> {
        let [a, b, c] = self.rows;
        let det = self.determinant();
        if !(det.re().abs() > 0.0 && det.is_finite()) {
            return None;
        }
        // The columns of the inverse are cross products of the rows (Cramer).
        let columns = [b.cross(c) / det, c.cross(a) / det, a.cross(b) / det];
        let row = |k: usize| Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
        let linear = Self { rows: [row(0), row(1), row(2)], shift: Vec3::zero() };
        Some(Self { shift: -linear.linear(self.shift), ..linear })
    }
}

impl Affine<f64> {
    pub(crate) fn range(&self, at: &[Interval; 3]) -> [Interval; 3] {
        use crate::expr::algebra::Algebra;
        [0, 1, 2].map(|k| Interval::plane(self.rows[k], self.shift[k], at))
    }

    pub(crate) fn pull_back_range(&self, g: [Interval; 3]) -> [Interval; 3] {
        use crate::expr::algebra::Algebra;
        [0, 1, 2].map(|k| {
            let column = Vec3::new(self.rows[0][k], self.rows[1][k], self.rows[2][k]);
            Interval::plane(column, 0.0, &g)
        })
    }
}
