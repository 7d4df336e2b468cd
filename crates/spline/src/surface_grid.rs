//! Many points of a surface at once.
//!
//! Tensor grids are two matrix products: the basis in v is applied once per row of control points,
//! then the basis in u to whole lines of the grid, contiguous in memory.

use crate::{BSplineSurface, KnotVector};
use moldloft_num::{Order, Real, Vec3};
use smallvec::SmallVec;

/// Parameters v handled together: small enough for the lines of one span to stay in the first-level
/// cache (4 lines x 256 x 24 bytes = 24 KiB for a cubic), large enough to run.
const BLOCK: usize = 256;

/// The basis at many parameters, values and slopes, flat.
struct Bases {
    degree: usize,
    first: Vec<usize>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Bases {
    fn new(knots: &KnotVector, ts: &[f64], order: Order) -> Self {
        let degree = knots.degree();
        let mut all = Self {
            degree,
            first: Vec::with_capacity(ts.len()),
            values: Vec::with_capacity(ts.len() * (degree + 1)),
            slopes: Vec::new(),
        };
        for &t in ts {
            let basis = knots.basis(t, order);
            all.first.push(basis.first);
            all.values.extend_from_slice(&basis.rows[0]);
            all.slopes.extend_from_slice(&basis.rows[1]);
        }
        all
    }

    fn values(&self, k: usize) -> &[f64] {
        &self.values[k * (self.degree + 1)..][..self.degree + 1]
    }

    fn slopes(&self, k: usize) -> &[f64] {
        &self.slopes[k * (self.degree + 1)..][..self.degree + 1]
    }
}

/// Lines of the grid, one per row of control points: the net with its v direction evaluated.
struct Lines<X> {
    width: usize,
    data: Vec<X>,
}

impl<X: Linear> Lines<X> {
    /// Applies the basis functions of the parameters `block` to each row of the net.
    fn evaluate(&mut self, net: &[X], columns: usize, bases: &Bases, from: usize, slopes: bool) {
        for (line, row) in self.data.chunks_exact_mut(self.width).zip(net.chunks_exact(columns)) {
            for (k, x) in line.iter_mut().enumerate() {
                let k = from + k;
                let basis = if slopes { bases.slopes(k) } else { bases.values(k) };
                if X::TAPED {
                    *x = X::combined(basis, &row[bases.first[k]..]);
                    continue;
                }
                let mut sum = X::zero();
                for (&b, &p) in basis.iter().zip(&row[bases.first[k]..]) {
                    sum = sum.plus(p, b);
                }
                *x = sum;
            }
        }
    }

    /// The combination of consecutive lines with the weights `basis`, each element through `f`.
    #[inline(always)]
    fn combine<Y>(&self, first: usize, basis: &[f64], out: &mut [Y], f: impl Fn(X) -> Y) {
        let w = self.width;
        let line = |a: usize| &self.data[(first + a) * w..][..w];
        let out = &mut out[..w];
        if X::TAPED {
            let mut terms = vec![X::zero(); basis.len()];
            for (k, x) in out.iter_mut().enumerate() {
                terms.iter_mut().enumerate().for_each(|(a, term)| *term = line(a)[k]);
                *x = f(X::combined(basis, &terms));
            }
            return;
        }
        match *basis {
            // One pass over memory for the usual degrees.
            [b0, b1, b2] => {
                let (l0, l1, l2) = (line(0), line(1), line(2));
                for k in 0..w {
                    out[k] = f(l0[k].times(b0).plus(l1[k], b1).plus(l2[k], b2));
                }
            }
            [b0, b1, b2, b3] => {
                let (l0, l1, l2, l3) = (line(0), line(1), line(2), line(3));
                for k in 0..w {
                    out[k] = f(l0[k].times(b0).plus(l1[k], b1).plus(l2[k], b2).plus(l3[k], b3));
                }
            }
            _ => {
                for (k, x) in out.iter_mut().enumerate() {
                    let terms = basis.iter().enumerate();
                    *x = f(terms.fold(X::zero(), |sum, (a, &b)| sum.plus(line(a)[k], b)));
                }
            }
        }
    }
}

/// Values that basis functions combine: points, or points with a weight.
trait Linear: Copy {
    /// True for numbers of a tape, on which a sum is one node.
    const TAPED: bool;
    fn zero() -> Self;
    /// The sum of the first terms, as many as there are basis functions, for numbers of a tape.
    fn combined(basis: &[f64], terms: &[Self]) -> Self;
    fn times(self, b: f64) -> Self;
    fn plus(self, other: Self, b: f64) -> Self;
}

/// The sum of basis functions times numbers, summed in order, as one node.
fn combined<T: Real>(basis: &[f64], number: impl Fn(usize) -> T) -> T {
    let terms: SmallVec<[(f64, T); 8]> =
        basis.iter().enumerate().map(|(a, &b)| (b, number(a))).collect();
    T::linear(terms.iter().fold(0.0, |sum, (b, x)| sum + x.re() * b), &terms)
}

impl<T: Real> Linear for Vec3<T> {
    const TAPED: bool = T::TAPED;
    fn combined(basis: &[f64], terms: &[Self]) -> Self {
        Vec3::from([0, 1, 2].map(|axis| combined(basis, |a| terms[a][axis])))
    }
    #[inline(always)]
    fn zero() -> Self {
        Vec3::default()
    }
    #[inline(always)]
    fn times(self, b: f64) -> Self {
        self.map(|x| x * b)
    }
    #[inline(always)]
    fn plus(self, o: Self, b: f64) -> Self {
        Vec3 { x: self.x + o.x * b, y: self.y + o.y * b, z: self.z + o.z * b }
    }
}

#[derive(Clone, Copy)]
struct Weighted<T> {
    p: Vec3<T>,
    w: T,
}

impl<T: Real> Linear for Weighted<T> {
    const TAPED: bool = T::TAPED;
    fn combined(basis: &[f64], terms: &[Self]) -> Self {
        let p = [0, 1, 2].map(|axis| combined(basis, |a| terms[a].p[axis]));
        Self { p: p.into(), w: combined(basis, |a| terms[a].w) }
    }
    #[inline(always)]
    fn zero() -> Self {
        Self { p: Vec3::default(), w: T::zero() }
    }
    #[inline(always)]
    fn times(self, b: f64) -> Self {
        Self { p: self.p.times(b), w: self.w * b }
    }
    #[inline(always)]
    fn plus(self, o: Self, b: f64) -> Self {
        Self { p: self.p.plus(o.p, b), w: self.w + o.w * b }
    }
}

impl<T: Real> BSplineSurface<T> {
    /// The tensor grid; see [`moldloft_num::Surface::grid`].
    pub(crate) fn tensor_grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        let Some(weights) = self.weights() else {
            let keep = |p: Vec3<T>| p;
            let normal = |_: Vec3<T>, su: Vec3<T>, sv: Vec3<T>| unit_normal(su, sv);
            return self.products(self.control_points(), us, vs, points, normals, keep, normal);
        };
        let net = self.control_points().iter().zip(weights);
        let net: Vec<_> = net.map(|(&p, &w)| Weighted { p: p * w, w }).collect();
        let project = |a: Weighted<T>| a.p / a.w;
        // The direction of (A / w)' is that of A' - (A / w) w'.
        let normal = |a: Weighted<T>, au: Weighted<T>, av: Weighted<T>| {
            let p = a.p / a.w;
            unit_normal(au.p - p * au.w, av.p - p * av.w)
        };
        self.products(&net, us, vs, points, normals, project, normal);
    }

    #[allow(clippy::too_many_arguments)]
    fn products<X: Linear>(
        &self,
        net: &[X],
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
        project: impl Fn(X) -> Vec3<T>,
        normal: impl Fn(X, X, X) -> Vec3<T>,
    ) {
        let [u, v] = self.knots();
        let order = if normals.is_some() { Order::First } else { Order::Zero };
        let (bu, bv) = (Bases::new(u, us, order), Bases::new(v, vs, order));
        let (rows, columns) = (u.points(), v.points());
        let mut lines = Lines { width: 0, data: Vec::new() };
        let mut slopes = Lines { width: 0, data: Vec::new() };
        let mut line = [vec![X::zero(); BLOCK], vec![X::zero(); BLOCK], vec![X::zero(); BLOCK]];
        for from in (0..vs.len()).step_by(BLOCK) {
            let width = BLOCK.min(vs.len() - from);
            lines.width = width;
            lines.data.resize(rows * width, X::zero());
            lines.evaluate(net, columns, &bv, from, false);
            if normals.is_some() {
                slopes.width = width;
                slopes.data.resize(rows * width, X::zero());
                slopes.evaluate(net, columns, &bv, from, true);
            }
            for i in 0..us.len() {
                let (first, basis) = (bu.first[i], bu.values(i));
                let place = i * vs.len() + from..i * vs.len() + from + width;
                let points = &mut points[place.clone()];
                if let Some(normals) = normals.as_deref_mut() {
                    let [p, su, sv] = &mut line;
                    lines.combine(first, basis, p, |x| x);
                    for (x, &p) in points.iter_mut().zip(p.iter()) {
                        *x = project(p);
                    }
                    lines.combine(first, bu.slopes(i), su, |x| x);
                    slopes.combine(first, basis, sv, |x| x);
                    for (k, x) in normals[place].iter_mut().enumerate() {
                        *x = normal(p[k], su[k], sv[k]);
                    }
                } else {
                    lines.combine(first, basis, points, &project);
                }
            }
        }
    }
}

#[inline(always)]
fn unit_normal<T: Real>(su: Vec3<T>, sv: Vec3<T>) -> Vec3<T> {
    let normal = su.cross(sv);
    let length = normal.norm();
    // One division instead of three.
    if length.re() > 0.0 { normal * (T::one() / length) } else { Vec3::default() }
}
