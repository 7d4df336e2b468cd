//! Block-tridiagonal systems along one grid line, open or closed, and their scalar counterpart.

use moldloft_num::{Real, Vec3};

pub(super) type Matrix<T> = [[T; 3]; 3];

/// One line of equations: low x_(k-1) + middle x_k + high x_(k+1) = right.
pub(super) struct BlockTridiagonal<T> {
    pub low: Vec<Matrix<T>>,
    pub middle: Vec<Matrix<T>>,
    pub high: Vec<Matrix<T>>,
    pub right: Vec<Vec3<T>>,
}

impl<T: Real> BlockTridiagonal<T> {
    /// The system of unit rows with nothing on the right.
    pub fn unit(count: usize) -> Self {
        Self {
            low: vec![scaled_identity(T::zero()); count],
            middle: vec![scaled_identity(T::one()); count],
            high: vec![scaled_identity(T::zero()); count],
            right: vec![Vec3::zero(); count],
        }
    }

    /// The solution of the line; of a closed one, whose first and last unknowns are neighbours, the last
    /// unknown is solved for by bordering.
    pub fn solved(self, closed: bool) -> Vec<Vec3<T>> {
        let right = self.right.clone();
        self.factored(closed).solved(right)
    }

    /// The factors of the line, for any right side.
    pub fn factored(self, closed: bool) -> FactoredLine<T> {
        if !closed {
            return self.eliminated::<false>(self.right.len());
        }
        let last = self.right.len() - 1;
        let mut factors = self.eliminated::<true>(last);
        let (low, high) = (&self.low[last], &self.high[last]);
        let border = &factors.border;
        let (before, after) = (times(low, &border[last - 1]), times(high, &border[0]));
        let mut middle = self.middle[last];
        for r in 0..3 {
            for c in 0..3 {
                middle[r][c] = middle[r][c] - before[r][c] - after[r][c];
            }
        }
        factors.seam = Some([*low, *high, inverse(&middle)]);
        factors
    }

    /// The factors of the first `count` unknowns and, with `BORDER`, how each depends on the next one, which
    /// closes the line.
    fn eliminated<const BORDER: bool>(&self, count: usize) -> FactoredLine<T> {
        let mut solves: Vec<Matrix<T>> = Vec::with_capacity(count);
        let mut upper: Vec<Matrix<T>> = Vec::with_capacity(count);
        let mut border: Vec<Matrix<T>> = Vec::with_capacity(if BORDER { count } else { 0 });
        for k in 0..count {
            let (low, mut middle) = (&self.low[k], self.middle[k]);
            let mut side = scaled_identity(T::zero());
            if BORDER && k == 0 {
                side = *low;
            }
            if BORDER && k + 1 == count {
                add(&mut side, &self.high[k]);
            }
            if k > 0 {
                subtract(&mut middle, &times(low, &upper[k - 1]));
                if BORDER {
                    subtract(&mut side, &times(low, &border[k - 1]));
                }
            }
            let solve = inverse(&middle);
            upper.push(times(&solve, &self.high[k]));
            if BORDER {
                border.push(times(&solve, &side));
            }
            solves.push(solve);
        }
        if BORDER {
            for k in (0..count.saturating_sub(1)).rev() {
                let product = times(&upper[k], &border[k + 1]);
                subtract(&mut border[k], &product);
            }
        }
        let low = self.low[..count].to_vec();
        FactoredLine { low, solves, upper, border, seam: None }
    }
}

/// A line of equations with its middle blocks eliminated.
pub(super) struct FactoredLine<T> {
    low: Vec<Matrix<T>>,
    /// Inverses of the middle blocks that elimination leaves.
    solves: Vec<Matrix<T>>,
    upper: Vec<Matrix<T>>,
    /// Dependence on the last unknown of a closed line.
    border: Vec<Matrix<T>>,
    /// Low and high block of the last equation of a closed line, and the inverse that is left of its middle one.
    seam: Option<[Matrix<T>; 3]>,
}

impl<T: Real> FactoredLine<T> {
    /// The solution for a right side.
    pub fn solved(&self, mut right: Vec<Vec3<T>>) -> Vec<Vec3<T>> {
        let count = self.solves.len();
        for k in 0..count {
            if k > 0 {
                let before = right[k - 1];
                right[k] -= apply(&self.low[k], before);
            }
            right[k] = apply(&self.solves[k], right[k]);
        }
        let mut x = right;
        for k in (0..count.saturating_sub(1)).rev() {
            let next = x[k + 1];
            x[k] -= apply(&self.upper[k], next);
        }
        if let Some([low, high, solve]) = &self.seam {
            let rest = x[count] - apply(low, x[count - 1]) - apply(high, x[0]);
            let w = apply(solve, rest);
            for (x, border) in x.iter_mut().zip(&self.border) {
                *x -= apply(border, w);
            }
            x[count] = w;
        }
        x
    }
}

/// The end of a line of values to smooth: nothing passes an open one, beyond a mirrored one is the line's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LineEnd {
    Open,
    Mirrored,
}

/// Solves (1 + 2 a_k) x_k - a_k (x_(k-1) + x_(k+1)) = v_k: values smoothed over a length of root a points, with
/// the ends of a line that is not closed.
pub(super) fn smoothed<T: Real>(a: &[T], v: &[T], ends: Option<[LineEnd; 2]>) -> Vec<T> {
    let closed = ends.is_none();
    let is = |end: usize, kind: LineEnd| ends.is_some_and(|ends| ends[end] == kind);
    let n = v.len();
    let one = T::one();
    let count = if closed { n - 1 } else { n };
    let mut upper = Vec::with_capacity(count);
    let mut x: Vec<T> = Vec::with_capacity(count);
    let mut border = vec![T::zero(); count];
    for k in 0..count {
        let first = k == 0 && !closed;
        let last = k + 1 == n;
        let is_open = (first && is(0, LineEnd::Open)) || (last && is(1, LineEnd::Open));
        let [low, high] = [last && is(1, LineEnd::Mirrored), first && is(0, LineEnd::Mirrored)]
            .map(|twice| if twice { a[k] * 2.0 } else { a[k] });
        let mut middle = one + a[k] * if is_open { one } else { T::from(2.0) };
        let mut right = v[k];
        let mut side = T::zero();
        if closed && k == 0 {
            side -= a[k];
        }
        if closed && k + 1 == count {
            side -= a[k];
        }
        if k > 0 {
            middle += low * upper[k - 1];
            right += low * x[k - 1];
            side += a[k] * border[k - 1];
        }
        x.push(right / middle);
        upper.push(-(high / middle));
        border[k] = side / middle;
    }
    for k in (0..count - 1).rev() {
        let (next, side) = (x[k + 1], border[k + 1]);
        x[k] -= upper[k] * next;
        border[k] -= upper[k] * side;
    }
    if closed {
        let a = a[n - 1];
        let whole = one + a * 2.0 + a * (border[count - 1] + border[0]);
        let w = (v[n - 1] + a * (x[count - 1] + x[0])) / whole;
        for (x, border) in x.iter_mut().zip(&border) {
            *x -= *border * w;
        }
        x.push(w);
    }
    x
}

pub(super) fn scaled_identity<T: Real>(x: T) -> Matrix<T> {
    let o = T::zero();
    [[x, o, o], [o, x, o], [o, o, x]]
}

pub(super) fn add<T: Real>(a: &mut Matrix<T>, b: &Matrix<T>) {
    for r in 0..3 {
        for c in 0..3 {
            a[r][c] += b[r][c];
        }
    }
}

fn subtract<T: Real>(a: &mut Matrix<T>, b: &Matrix<T>) {
    for r in 0..3 {
        for c in 0..3 {
            a[r][c] -= b[r][c];
        }
    }
}

pub(super) fn times<T: Real>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    std::array::from_fn(|r| {
        std::array::from_fn(|c| a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c])
    })
}

pub(super) fn apply<T: Real>(a: &Matrix<T>, v: Vec3<T>) -> Vec3<T> {
    let row = |r: usize| a[r][0] * v.x + a[r][1] * v.y + a[r][2] * v.z;
    Vec3::new(row(0), row(1), row(2))
}

/// The inverse by cofactors; of a singular matrix it is not finite, which the march refuses.
pub(super) fn inverse<T: Real>(a: &Matrix<T>) -> Matrix<T> {
    let [x, y, z] = [0, 1, 2].map(|c| Vec3::new(a[0][c], a[1][c], a[2][c]));
    let (p, q, r) = (y.cross(z), z.cross(x), x.cross(y));
    let det = T::one() / x.dot(p);
    [p, q, r].map(|row| (row * det).to_array())
}

/// The matrix with the signs of one column reversed: reflection of a step in the coordinate of a
/// mirror plane.
pub(super) fn mirrored<T: Real>(a: &Matrix<T>, column: usize) -> Matrix<T> {
    let mut b = *a;
    for row in &mut b {
        row[column] = -row[column];
    }
    b
}
