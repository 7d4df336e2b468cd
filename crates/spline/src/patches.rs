//! Scattered points of a surface: each patch in local powers, evaluated by Horner's rule.

use crate::surface::quotient;
use crate::{BSplineSurface, KnotVector};
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};

/// Up to this degree the powers about the middle of a span keep 13 digits: on [-1/2, 1/2] of the
/// span, rounding grows by about 2^degree at most. Higher degrees are evaluated point by point.
const MAX_POWER_DEGREE: usize = 6;

/// Coefficients x, y, z, w of one power; w is 1, 0, 0 … for a polynomial surface.
type Coefficient<T> = [T; 4];

/// The polynomials of all patches of a surface, in powers of the parameters' distances from the
/// middle of the patch, with the tables that find the patch of a parameter pair.
#[derive(Clone, Debug)]
pub(crate) struct Patches<T> {
    u: Spans,
    v: Spans,
    /// Patch by patch; within one, the coefficient of s^a t^b at `a * (degree_v + 1) + b`.
    coefficients: Vec<Coefficient<T>>,
}

/// The non-empty spans of a knot vector.
#[derive(Clone, Debug)]
struct Spans {
    /// Start of each span, for the search; the first is minus infinity.
    starts: Vec<f64>,
    middles: Vec<f64>,
    /// The span in which bucket k of equal width begins.
    buckets: Vec<u32>,
}

impl Spans {
    fn new(knots: &KnotVector) -> Self {
        let k = knots.as_slice();
        let spans: Vec<usize> = knots.spans().collect();
        let mut starts: Vec<f64> = spans.iter().map(|&s| k[s]).collect();
        starts[0] = f64::NEG_INFINITY;
        let middles = spans.iter().map(|&s| 0.5 * (k[s] + k[s + 1])).collect();
        let count = 4 * spans.len();
        let begins = |b: usize| {
            let t = b as f64 / count as f64;
            (starts.partition_point(|&s| s <= t) - 1) as u32
        };
        Self { buckets: (0..count).map(begins).collect(), starts, middles }
    }

    /// The index of the span in charge at `t` and the distance from its middle.
    #[inline(always)]
    fn locate(&self, t: f64) -> (usize, f64) {
        // The cast saturates: negative values and NaN are in bucket 0.
        let bucket = (t * self.buckets.len() as f64) as usize;
        let mut k = self.buckets[bucket.min(self.buckets.len() - 1)] as usize;
        // Rounding of the product may name the bucket after the right one.
        while t < self.starts[k] {
            k -= 1;
        }
        while k + 1 < self.starts.len() && self.starts[k + 1] <= t {
            k += 1;
        }
        (k, t - self.middles[k])
    }
}

/// The basis functions of a span as polynomials in s = t - `middle`: entry `[r][k]` is the
/// coefficient of s^k of function r, by the recursion of Cox and de Boor on coefficients.
fn basis_polynomials(knots: &KnotVector, span: usize, middle: f64) -> Vec<Vec<f64>> {
    let (p, k) = (knots.degree(), knots.as_slice());
    let mut basis = vec![vec![1.0]];
    for degree in 1..=p {
        let mut raised = vec![vec![0.0; degree + 1]; degree + 1];
        for (r, lower) in basis.iter().enumerate() {
            let (left, right) = (k[span + 1 + r - degree], k[span + r + 1]);
            let width = right - left;
            for (power, &c) in lower.iter().enumerate() {
                let share = c / width;
                // (right - t) and (t - left), as polynomials in s.
                raised[r][power] += share * (right - middle);
                raised[r][power + 1] -= share;
                raised[r + 1][power] += share * (middle - left);
                raised[r + 1][power + 1] += share;
            }
        }
        basis = raised;
    }
    basis
}

impl<T: Real> Patches<T> {
    /// The patches of a surface, or `None` if its degrees are too high for powers.
    fn new(s: &BSplineSurface<T>) -> Option<Self> {
        let [ku, kv] = s.knots();
        let (p, q) = (ku.degree(), kv.degree());
        if p.max(q) > MAX_POWER_DEGREE {
            return None;
        }
        let (u, v) = (Spans::new(ku), Spans::new(kv));
        let columns = kv.points();
        let net = |i: usize, j: usize| {
            let at = i * columns + j;
            let w = s.weights().map_or(T::one(), |w| w[at]);
            let x = s.control_points()[at] * w;
            [x.x, x.y, x.z, w]
        };
        let polynomials = |k: &KnotVector, spans: &Spans| -> Vec<(usize, Vec<Vec<f64>>)> {
            let pairs = k.spans().zip(&spans.middles);
            pairs.map(|(span, &m)| (span, basis_polynomials(k, span, m))).collect()
        };
        let (all_u, all_v) = (polynomials(ku, &u), polynomials(kv, &v));
        let mut coefficients = Vec::with_capacity(all_u.len() * all_v.len() * (p + 1) * (q + 1));
        let add = |to: &mut Coefficient<T>, x: Coefficient<T>, b: f64| {
            for (to, x) in to.iter_mut().zip(x) {
                *to += x * b;
            }
        };
        for (span_u, basis_u) in &all_u {
            for (span_v, basis_v) in &all_v {
                let start = coefficients.len();
                coefficients.resize(start + (p + 1) * (q + 1), [T::zero(); 4]);
                for i in 0..=p {
                    let mut row = vec![[T::zero(); 4]; q + 1];
                    for j in 0..=q {
                        let x = net(span_u - p + i, span_v - q + j);
                        for (b, to) in row.iter_mut().enumerate() {
                            add(to, x, basis_v[j][b]);
                        }
                    }
                    for a in 0..=p {
                        for (b, &x) in row.iter().enumerate() {
                            add(&mut coefficients[start + a * (q + 1) + b], x, basis_u[i][a]);
                        }
                    }
                }
            }
        }
        Some(Self { u, v, coefficients })
    }

    /// The patch in charge at (u, v) and the distances from its middle.
    #[inline(always)]
    fn locate(&self, [u, v]: [f64; 2], size: usize) -> (&[Coefficient<T>], [f64; 2]) {
        let ((i, s), (j, t)) = (self.u.locate(u), self.v.locate(v));
        let patch = (i * self.v.middles.len() + j) * size;
        (&self.coefficients[patch..patch + size], [s, t])
    }
}

/// The sum of c_ab s^a t^b, with `columns` coefficients per power of s.
#[inline(always)]
fn horner<T: Real, const LANES: usize>(
    patch: &[Coefficient<T>],
    columns: usize,
    [s, t]: [f64; 2],
) -> [T; LANES] {
    let mut sum = [T::zero(); LANES];
    for row in patch.chunks_exact(columns).rev() {
        let mut line: [T; LANES] = std::array::from_fn(|k| row[columns - 1][k]);
        for c in row[..columns - 1].iter().rev() {
            for k in 0..LANES {
                line[k] = line[k] * t + c[k];
            }
        }
        for k in 0..LANES {
            sum[k] = sum[k] * s + line[k];
        }
    }
    sum
}

/// The sum of c_ab s^a t^b with its derivatives by s and by t.
#[inline(always)]
fn horner_first<T: Real, const LANES: usize>(
    patch: &[Coefficient<T>],
    columns: usize,
    [s, t]: [f64; 2],
) -> [[T; LANES]; 3] {
    let mut sums = [[T::zero(); LANES]; 3];
    for row in patch.chunks_exact(columns).rev() {
        let mut line: [T; LANES] = std::array::from_fn(|k| row[columns - 1][k]);
        let mut slope = [T::zero(); LANES];
        for c in row[..columns - 1].iter().rev() {
            for k in 0..LANES {
                slope[k] = slope[k] * t + line[k];
                line[k] = line[k] * t + c[k];
            }
        }
        let [p, ds, dt] = &mut sums;
        for k in 0..LANES {
            ds[k] = ds[k] * s + p[k];
            p[k] = p[k] * s + line[k];
            dt[k] = dt[k] * s + slope[k];
        }
    }
    sums
}

#[inline(always)]
fn xyz<T: Real, const LANES: usize>(a: [T; LANES]) -> Vec3<T> {
    Vec3 { x: a[0], y: a[1], z: a[2] }
}

impl<T: Real> BSplineSurface<T> {
    /// The positions at the parameter pairs `uv`, in any order. The first call converts the patches
    /// to local powers, at the cost of about a thousand points.
    ///
    /// # Panics
    /// When `out` is shorter than `uv`.
    ///
    /// # Example
    /// ```
    /// use moldloft_num::Vec3;
    /// use moldloft_spline::{BSplineSurface, KnotVector};
    /// let k = KnotVector::clamped_uniform(1, 2).unwrap();
    /// let net = [[0., 0., 0.], [0., 1., 0.], [1., 0., 0.], [1., 1., 4.]].map(Vec3::from);
    /// let s = BSplineSurface::<f64>::new(k.clone(), k, net.to_vec(), None).unwrap();
    /// let mut out = [Vec3::zero(); 2];
    /// s.scattered(&[[0.5, 0.5], [1.0, 0.25]], &mut out);
    /// assert_eq!(out, [Vec3::of(0.5, 0.5, 1.0), Vec3::of(1.0, 0.25, 1.0)]);
    /// ```
    pub fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        let out = &mut out[..uv.len()];
        if T::TAPED {
            return self.scattered_on_tape(uv, out);
        }
        let Some(patches) = self.patches.get_or_init(|| Patches::new(self)) else {
            for (x, &[u, v]) in out.iter_mut().zip(uv) {
                *x = self.jet(u.into(), v.into(), Order::Zero).p;
            }
            return;
        };
        // Constant sizes for the usual degrees let the compiler unroll both loops.
        match self.knots().map(KnotVector::degree) {
            [3, 3] => self.positions(patches, 16, 4, uv, out),
            [2, 2] => self.positions(patches, 9, 3, uv, out),
            [p, q] => self.positions(patches, (p + 1) * (q + 1), q + 1, uv, out),
        }
    }

    #[inline(always)]
    fn positions(
        &self,
        patches: &Patches<T>,
        size: usize,
        columns: usize,
        uv: &[[f64; 2]],
        out: &mut [Vec3<T>],
    ) {
        if self.weights().is_none() {
            for (x, &uv) in out.iter_mut().zip(uv) {
                let (patch, st) = patches.locate(uv, size);
                *x = xyz(horner::<T, 3>(patch, columns, st));
            }
        } else {
            for (x, &uv) in out.iter_mut().zip(uv) {
                let (patch, st) = patches.locate(uv, size);
                let a = horner::<T, 4>(patch, columns, st);
                *x = xyz(a) / a[3];
            }
        }
    }

    /// Positions and first derivatives at the parameter pairs `uv`; see
    /// [`BSplineSurface::scattered`].
    ///
    /// # Panics
    /// When `out` is shorter than `uv`.
    pub fn scattered_first(&self, uv: &[[f64; 2]], out: &mut [SurfJet<T>]) {
        let out = &mut out[..uv.len()];
        if T::TAPED {
            return self.scattered_first_on_tape(uv, out);
        }
        let Some(patches) = self.patches.get_or_init(|| Patches::new(self)) else {
            for (x, &[u, v]) in out.iter_mut().zip(uv) {
                *x = self.jet(u.into(), v.into(), Order::First);
            }
            return;
        };
        match self.knots().map(KnotVector::degree) {
            [3, 3] => self.tangents(patches, 16, 4, uv, out),
            [2, 2] => self.tangents(patches, 9, 3, uv, out),
            [p, q] => self.tangents(patches, (p + 1) * (q + 1), q + 1, uv, out),
        }
    }

    #[inline(always)]
    fn tangents(
        &self,
        patches: &Patches<T>,
        size: usize,
        columns: usize,
        uv: &[[f64; 2]],
        out: &mut [SurfJet<T>],
    ) {
        if self.weights().is_none() {
            for (x, &uv) in out.iter_mut().zip(uv) {
                let (patch, st) = patches.locate(uv, size);
                let [p, u, v] = horner_first::<T, 3>(patch, columns, st).map(xyz);
                *x = SurfJet { p, u, v, ..SurfJet::default() };
            }
        } else {
            let (none, zero) = (Vec3::default(), T::zero());
            for (x, &uv) in out.iter_mut().zip(uv) {
                let (patch, st) = patches.locate(uv, size);
                let [p, u, v] = horner_first::<T, 4>(patch, columns, st);
                let a = [[xyz(p), xyz(v), none], [xyz(u), none, none], [none; 3]];
                let w = [[p[3], v[3], zero], [u[3], zero, zero], [zero; 3]];
                let jet = quotient(a, w);
                *x = SurfJet { p: jet.p, u: jet.u, v: jet.v, ..SurfJet::default() };
            }
        }
    }
}
