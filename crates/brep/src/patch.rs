//! Polynomial patches on implicit surfaces: control nets, errors, and folds.

use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;
use std::f64::consts::PI;

/// Number of parameters in each direction at which the distance of a patch is measured.
const DISTANCES: usize = 8;

/// The rows whose combinations are measured first.
const TRIED: [usize; 2] = [1, 5];

/// Parameters in each direction at which the normal of a patch is compared with that of the
/// surface.
const NORMALS: [f64; 5] = [0.04, 0.3, 0.5, 0.7, 0.96];

/// The highest degree.
const MOST: usize = 5;

/// Bernstein polynomials of a degree; zeros behind them.
type BernsteinRow = [f64; MOST + 1];

/// Value and gradient of a surface's function at a point; the surface is given by number.
pub type SurfaceField<'a> = dyn Fn(u32, Vec3) -> (f64, Vec3) + Sync + 'a;

/// Polynomials of one degree through points at fixed parameters.
pub struct PatchBasis {
    pub degree: usize,
    /// The parameters: denser towards the ends.
    pub at: Vec<f64>,
    /// Control points of the values there.
    inverse: Vec<Vec<f64>>,
    /// The Bernstein polynomials where distances are taken.
    rows: [BernsteinRow; DISTANCES],
    /// The Bernstein polynomials at the parameters `at`.
    own: Vec<BernsteinRow>,
    /// For each order, the factors of the values there in the Chebyshev coefficient.
    chebyshev: [[f64; DISTANCES]; DISTANCES],
    /// The Bernstein polynomials where normals are taken, and their derivatives.
    normals: [[BernsteinRow; 2]; NORMALS.len()],
}

/// A patch with its error.
#[derive(Clone)]
pub struct FittedPatch {
    /// Control points, the second parameter's fastest.
    pub net: Vec<Vec3>,
    /// A bound of its distance from its surface.
    pub error: f64,
    /// True where its normal turns against that of the surface.
    pub folded: bool,
}

impl PatchBasis {
    pub fn new(degree: usize) -> Self {
        let at: Vec<f64> =
            (0..=degree).map(|k| 0.5 * (1.0 - libm::cos(PI * k as f64 / degree as f64))).collect();
        let own: Vec<BernsteinRow> = at.iter().map(|t| bernstein(degree, *t)).collect();
        let inverse = inverted(own.iter().map(|row| row[..=degree].to_vec()).collect());
        let rows = std::array::from_fn(|k| {
            bernstein(degree, 0.5 * (1.0 - libm::cos(PI * (k as f64 + 0.5) / DISTANCES as f64)))
        });
        let chebyshev = std::array::from_fn(|k| {
            let scale = if k == 0 { 1.0 } else { 2.0 } / DISTANCES as f64;
            std::array::from_fn(|i| {
                scale * libm::cos(PI * k as f64 * (i as f64 + 0.5) / DISTANCES as f64)
            })
        });
        let normals = NORMALS.map(|t| [bernstein(degree, t), slope(degree, t)]);
        Self { degree, at, inverse, rows, own, chebyshev, normals }
    }

    /// The control points of a curve through points at the parameters `at`.
    pub fn curve(&self, through: &[Vec3]) -> Vec<Vec3> {
        let mut net: Vec<Vec3> = self
            .inverse
            .iter()
            .map(|row| row.iter().zip(through).fold(Vec3::zero(), |sum, (w, p)| sum + *p * *w))
            .collect();
        // Ends are vertices, bit for bit.
        (net[0], net[self.degree]) = (through[0], through[self.degree]);
        net
    }

    /// The point of a curve.
    pub fn on_curve(&self, net: &[Vec3], t: f64) -> Vec3 {
        let row = bernstein(self.degree, t);
        row.iter().zip(net).fold(Vec3::zero(), |sum, (w, p)| sum + *p * *w)
    }

    /// The points of a curve at the parameters `at`.
    pub fn at_places(&self, net: &[Vec3]) -> Vec<Vec3> {
        let at = |row: &BernsteinRow| {
            row.iter().zip(net).fold(Vec3::zero(), |sum, (w, p)| sum + *p * *w)
        };
        self.own.iter().map(at).collect()
    }

    /// A bound of the distance of a curve from a surface, as [`Self::distance`] is one.
    pub fn distance_of_curve(&self, net: &[Vec3], surface: u32, field: &SurfaceField<'_>) -> f64 {
        let values = self.rows.map(|row| {
            let p = row.iter().zip(net).fold(Vec3::zero(), |sum, (w, p)| sum + *p * *w);
            let (f, slope) = field(surface, p);
            if f == 0.0 { 0.0 } else { f / slope.norm() }
        });
        let mut bound = 0.0;
        for (k, along) in self.chebyshev.iter().enumerate() {
            let c: f64 = along.iter().zip(&values).map(|(c, v)| c * v).sum();
            bound += c.abs() * if k + 2 >= DISTANCES { 3.0 } else { 1.0 };
        }
        if bound.is_finite() { bound } else { f64::INFINITY }
    }

    /// The patch through points at the parameters `at`, with these control points along its sides u
    /// = 0 and 1, v = 0 and 1.
    pub fn patch(&self, through: &[Vec<Vec3>], sides: [&[Vec3]; 4]) -> Vec<Vec3> {
        let d = self.degree;
        let rows: Vec<Vec<Vec3>> = through.iter().map(|line| self.curve(line)).collect();
        let mut net = vec![Vec3::zero(); (d + 1) * (d + 1)];
        for j in 0..=d {
            let line: Vec<Vec3> = rows.iter().map(|row| row[j]).collect();
            for (i, p) in self.curve(&line).into_iter().enumerate() {
                net[i * (d + 1) + j] = p;
            }
        }
        // Common sides of neighbours are bit-identical.
        for k in 0..=d {
            net[k] = sides[0][k];
            net[d * (d + 1) + k] = sides[1][k];
            net[k * (d + 1)] = sides[2][k];
            net[k * (d + 1) + d] = sides[3][k];
        }
        net
    }

    /// A bound of the distance of a patch from a surface, |f| / |f'|: the sum of its Chebyshev
    /// coefficients, with the last two orders counted three times for the truncated ones. If it
    /// exceeds `enough`, it may be the distance at one point only.
    pub fn distance(
        &self,
        net: &[Vec3],
        surface: u32,
        field: &SurfaceField<'_>,
        enough: f64,
    ) -> f64 {
        let n = DISTANCES;
        let off = |p: Vec3| {
            let (f, slope) = field(surface, p);
            if f == 0.0 { 0.0 } else { f / slope.norm() }
        };
        for i in TRIED {
            for j in TRIED {
                let far = off(self.blend(net, &self.rows[i], &self.rows[j])).abs();
                if far > enough {
                    return if far.is_finite() { far } else { f64::INFINITY };
                }
            }
        }
        let mut values = [[0.0; DISTANCES]; DISTANCES];
        for (u, own) in self.rows.iter().zip(&mut values) {
            let line = self.across(net, u);
            let line = &line[..=self.degree];
            for (v, value) in self.rows.iter().zip(own) {
                let p = line.iter().zip(v).fold(Vec3::zero(), |sum, (p, w)| sum + *p * *w);
                *value = off(p);
            }
        }
        let mut bound = 0.0;
        for (k, along) in self.chebyshev.iter().enumerate() {
            let half: [f64; DISTANCES] = std::array::from_fn(|j| {
                along.iter().zip(&values).map(|(c, row)| c * row[j]).sum::<f64>()
            });
            for (l, across) in self.chebyshev.iter().enumerate() {
                let c: f64 = across.iter().zip(&half).map(|(c, h)| c * h).sum();
                bound += c.abs() * if k + 2 >= n || l + 2 >= n { 3.0 } else { 1.0 };
            }
        }
        if bound.is_finite() { bound } else { f64::INFINITY }
    }

    /// The control points of the curve of a patch at a first parameter, by its Bernstein polynomials.
    fn across(&self, net: &[Vec3], u: &BernsteinRow) -> [Vec3; MOST + 1] {
        let n = self.degree + 1;
        std::array::from_fn(|j| {
            let own = 0..if j < n { n } else { 0 };
            own.fold(Vec3::zero(), |sum, i| sum + net[i * n + j] * u[i])
        })
    }

    /// True where the patch's normal is not on the surface's side that `sign` says.
    pub fn folds(&self, net: &[Vec3], surface: u32, sign: f64, field: &SurfaceField<'_>) -> bool {
        const LEAST: f64 = 0.3;
        let rows = &self.normals;
        rows.iter().any(|[u, du]| {
            rows.iter().any(|[v, dv]| {
                let normal = self.blend(net, du, v).cross(self.blend(net, u, dv));
                let along = field(surface, self.blend(net, u, v)).1;
                let cosine = normal.dot(along) * sign;
                cosine.is_nan() || cosine <= LEAST * normal.norm() * along.norm()
            })
        })
    }

    /// The middle of a patch.
    pub fn middle(&self, net: &[Vec3]) -> Vec3 {
        let row = bernstein(self.degree, 0.5);
        self.blend(net, &row, &row)
    }

    fn blend(&self, net: &[Vec3], u: &[f64], v: &[f64]) -> Vec3 {
        let n = self.degree + 1;
        let line = |i: usize| {
            net[i * n..(i + 1) * n].iter().zip(v).fold(Vec3::zero(), |sum, (p, w)| sum + *p * *w)
        };
        (0..n).fold(Vec3::zero(), |sum, i| sum + line(i) * u[i])
    }

    /// A curve or patch as a NURBS.
    pub fn nurbs<const D: usize>(&self, net: Vec<Vec3>, error: f64) -> Nurbs<D> {
        let ends = [0.0, 1.0].map(|t| vec![t; self.degree + 1]);
        Nurbs {
            degrees: [self.degree; D],
            knots: std::array::from_fn(|_| ends.concat()),
            points: net,
            weights: None,
            error,
            exact: false,
            paces: std::array::from_fn(|_| Pace::Even),
        }
    }
}

fn bernstein(degree: usize, t: f64) -> BernsteinRow {
    let mut row = [0.0; MOST + 1];
    row[0] = 1.0;
    for n in 1..=degree {
        for k in (0..=n).rev() {
            let before = if k > 0 { row[k - 1] } else { 0.0 };
            row[k] = row[k] * (1.0 - t) + before * t;
        }
    }
    row
}

/// The derivatives of the Bernstein polynomials.
fn slope(degree: usize, t: f64) -> BernsteinRow {
    let lower = bernstein(degree - 1, t);
    std::array::from_fn(|k| degree as f64 * (if k > 0 { lower[k - 1] } else { 0.0 } - lower[k]))
}

/// The inverse of a small matrix, by elimination with pivots.
fn inverted(mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = rows.len();
    for (i, row) in rows.iter_mut().enumerate() {
        row.extend((0..n).map(|k| f64::from(u8::from(k == i))));
    }
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs()));
        rows.swap(i, pivot.unwrap_or(i));
        let scale = 1.0 / rows[i][i];
        rows[i].iter_mut().for_each(|x| *x *= scale);
        let own = rows[i].clone();
        for (k, row) in rows.iter_mut().enumerate() {
            if k != i {
                let by = row[i];
                row.iter_mut().zip(&own).for_each(|(x, y)| *x -= by * y);
            }
        }
    }
    rows.into_iter().map(|row| row[n..].to_vec()).collect()
}
