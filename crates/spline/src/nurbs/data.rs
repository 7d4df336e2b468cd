//! Grids of homogeneous values, and operations line by line along one of their axes.

use moldloft_num::Vec3;

/// A position times its weight, and the weight.
pub type Value = [f64; 4];

/// The position of a value.
pub fn point([x, y, z, w]: Value) -> Vec3 {
    if w == 1.0 { Vec3::of(x, y, z) } else { Vec3::of(x / w, y / w, z / w) }
}

/// A grid of values, the last axis fastest.
#[derive(Clone, Debug)]
pub struct HomogeneousGrid<const D: usize> {
    pub dims: [usize; D],
    pub values: Vec<Value>,
}

impl<const D: usize> HomogeneousGrid<D> {
    /// The grid whose lines along `axis`, of `count` values, are made of those of this one.
    pub fn along(
        &self,
        axis: usize,
        count: usize,
        mut line: impl FnMut(&[Value], &mut [Value]),
    ) -> Self {
        let mut dims = self.dims;
        let old = dims[axis];
        dims[axis] = count;
        let inner: usize = self.dims[axis + 1..].iter().product();
        let outer: usize = self.dims[..axis].iter().product();
        let mut values = vec![[0.0; 4]; outer * count * inner];
        let (mut from, mut to) = (vec![[0.0; 4]; old], vec![[0.0; 4]; count]);
        for o in 0..outer {
            for i in 0..inner {
                for (k, value) in from.iter_mut().enumerate() {
                    *value = self.values[(o * old + k) * inner + i];
                }
                line(&from, &mut to);
                for (k, value) in to.iter().enumerate() {
                    values[(o * count + k) * inner + i] = *value;
                }
            }
        }
        Self { dims, values }
    }

    /// Calls `f` with each line along `axis`.
    pub fn lines(&self, axis: usize, mut f: impl FnMut(&[Value])) {
        let (count, inner) = (self.dims[axis], self.dims[axis + 1..].iter().product::<usize>());
        let outer: usize = self.dims[..axis].iter().product();
        let mut line = vec![[0.0; 4]; count];
        for o in 0..outer {
            for i in 0..inner {
                for (k, value) in line.iter_mut().enumerate() {
                    *value = self.values[(o * count + k) * inner + i];
                }
                f(&line);
            }
        }
    }
}

/// The largest component of the difference of two values.
pub fn gap(a: &Value, b: &Value) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (x, y)| {
        let d = (x - y).abs();
        // NaN counts as infinite.
        if d.is_nan() { f64::INFINITY } else { most.max(d) }
    })
}
