//! Curvature of arrays of points.

use crate::grids::jets;
use crate::value::{GridArg, Points, farray, numbers, vectors};
use moldloft_grid::SurfaceGrid;
use moldloft_num::{Real, SurfJet, Vec3};
use moldloft_registry::{ArrayShape, Build, CallError, Context, FieldId, Kind, Scalar, Value};

fn root<T: Real>(square: T) -> T {
    if square.re() > 0.0 { square.sqrt() } else { T::zero() }
}

fn enough<T>(points: &[T], least: usize, field: FieldId) -> Result<(), CallError> {
    if points.len() >= least {
        return Ok(());
    }
    Err(CallError::new(
        "too-few-items",
        format!("{} points do not determine a curvature", points.len()),
    )
    .expected(format!("at least {least} points"))
    .found(points.len().to_string())
    .in_field(field))
}

/// The curvatures at the points of a curve: 4 A / (a b c) of the triangle of a point and its two
/// neighbours, the inverse radius of the circle through them. An end point has the curvature of its
/// neighbour.
///
/// For curves with a parameter use `curvc` and `curvature`.
///
/// `curvature(c)` of a curve of points is the same; `curvature(c, t)` is for a parametric curve.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "curvatures",
    example = "Arc a({2, 0, 0}, {0, 2, 0}, {-2, 0, 0}); \
               farray k = curvature(distc(a, uniform(0, 1, 9))); assert abs(k[3] - 0.5) < 1e-12 and k[3] == curvatures(distc(a, uniform(0, 1, 9)))[3];"
)]
pub struct Curvatures<T: Scalar> {
    /// The points, three or more.
    curve: Points<T>,
}

impl<T: Scalar> Build<T> for Curvatures<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        enough(&points, 3, Self::CURVE)?;
        let mut all = Vec::with_capacity(points.len());
        for (k, w) in points.windows(3).enumerate() {
            let (a, b, c) = (w[1] - w[0], w[2] - w[1], w[2] - w[0]);
            let product = a.norm_sq() * b.norm_sq() * c.norm_sq();
            if product.re() == 0.0 {
                let message =
                    format!("points {}, {} and {} do not define a circle", k + 1, k + 2, k + 3);
                return Err(CallError::new("coincident-points", message)
                    .expected("three different points")
                    .in_item(k + 1)
                    .in_field(Self::CURVE));
            }
            all.push(root(a.cross(b).norm_sq() * 4.0 / product));
        }
        all.insert(0, all[0]);
        all.push(all[all.len() - 1]);
        Ok(farray(all))
    }
}

/// The torsions at the points of a curve, positive for right-handed screws: 18 V / (d e f) of the
/// tetrahedron of four neighbouring points, times a ratio of curvatures (Boutin 2000). A segment
/// has one torsion, stored at its first point. Zero where the curve is plane or straight.
///
/// First-order accurate in the spacing of the points.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "torsion",
    example = "curve c[9]; for (i = 1:9) c[i] = {cos(0.1 * i), sin(0.1 * i), 0.1 * i}; \
               farray t = torsion(c); assert abs(t[5] - 0.5) < 0.01;"
)]
pub struct Torsions<T: Scalar> {
    /// The points, four or more.
    curve: Points<T>,
}

impl<T: Scalar> Build<T> for Torsions<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        enough(&points, 4, Self::CURVE)?;
        // The binormals of two neighbouring triangles turn by torsion times the step between them.
        let turn = |w: &[Vec3<T>]| {
            let (a, b, c) = (w[1] - w[0], w[2] - w[1], w[3] - w[2]);
            let (p, q) = (a.cross(b), b.cross(c));
            let step = root(b.norm_sq());
            let scale = root(p.norm_sq()) * root(q.norm_sq()) * step;
            // sin = (p x q) . b / (|p| |q| |b|); the two triangles are a step apart on average, a third
            // of all three.
            let mean = (root(a.norm_sq()) + step + root(c.norm_sq())) * (1.0 / 3.0);
            if scale.re() == 0.0 || mean.re() == 0.0 {
                return T::zero();
            }
            (p.cross(q).dot(b) / scale).atan2(p.dot(q) * step / scale) / mean
        };
        let inner: Vec<T> = points.windows(4).map(turn).collect();
        let n = points.len();
        let at = |k: usize| match k {
            // Inner points are in the centres of two tetrahedra.
            0 | 1 => inner[0],
            k if k + 2 >= n => inner[inner.len() - 1],
            k => (inner[k - 2] + inner[k - 1]) * 0.5,
        };
        Ok(farray((0..n).map(at).collect()))
    }
}

/// Normal and the six coefficients of the fundamental forms; `None` at a singular point of the
/// surface.
fn forms<T: Real>(jet: &SurfJet<T>) -> Option<(Vec3<T>, [T; 6])> {
    let cross = jet.u.cross(jet.v);
    let square = cross.norm_sq();
    let (e, f, g) = (jet.u.norm_sq(), jet.u.dot(jet.v), jet.v.norm_sq());
    if !(square.re() > 1e-16 * (e * g).re()) {
        return None;
    }
    let normal = cross / square.sqrt();
    Some((normal, [e, f, g, normal.dot(jet.uu), normal.dot(jet.uv), normal.dot(jet.vv)]))
}

/// A number at each point of a grid; at singular ones (poles) the mean of the next line's.
fn at_points<T: Real>(
    grid: &SurfaceGrid<T>,
    (field, context): (FieldId, &Context),
    f: impl Fn(&SurfJet<T>) -> Option<Vec3<T>>,
) -> Result<Vec<Vec3<T>>, CallError> {
    let (m, n) = (grid.m, grid.n);
    let all: Vec<Option<Vec3<T>>> = jets(grid, field, &context.budget)?.iter().map(f).collect();
    let mut known = Vec::with_capacity(m * n);
    for k in 0..m * n {
        let (i, j) = (k / n, k % n);
        let value = all[k].or_else(|| {
            let line: Vec<Vec3<T>> = if i == 0 || i + 1 == m {
                let beside = if i == 0 { 1 } else { m - 2 };
                (0..n).filter_map(|j| all[beside * n + j]).collect()
            } else {
                let beside = if j == 0 { 1 } else { n - 2 };
                (0..m).filter_map(|i| all[i * n + beside]).collect()
            };
            let edge = i == 0 || j == 0 || i + 1 == m || j + 1 == n;
            (edge && !line.is_empty()).then(|| {
                line.iter().fold(Vec3::zero(), |sum, v| sum + *v) / T::from(line.len() as f64)
            })
        });
        known.push(value.ok_or_else(|| {
            CallError::new("no-direction", format!("no normal at point [{},{}]", i + 1, j + 1))
                .expected("a surface with a tangent plane at every inner point")
                .in_field(field)
        })?);
    }
    Ok(known)
}

fn grid_of<T: Real>(grid: &SurfaceGrid<T>, values: Vec<Vec3<T>>) -> Value<T> {
    numbers(ArrayShape::Grid(grid.m, grid.n), values.into_iter().map(|v| v.x).collect())
}

/// The Gaussian curvatures at the points of a surface: K = (L N - M^2) / (E G - F^2), of the bicubic
/// spline through them.
///
/// At poles the mean of the next line.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "gauss",
    example = "Arc a({2, 0, 0}, {1.414213562373095, 1.414213562373095, 0}, {0, 2, 0}); \
               surface s = revolve(distc(a, uniform(0.2, 0.8, 15)), 0, 1, 12); \
               farray k[15,12]; k = gauss(s); assert abs(k[7,6] - 0.25) < 1e-3;"
)]
pub struct Gauss<T: Scalar> {
    /// The points.
    s: GridArg<T>,
}

impl<T: Scalar> Build<T> for Gauss<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let k = |jet: &SurfJet<T>| {
            let (_, [e, f, g, l, m, n]) = forms(jet)?;
            Some(Vec3::new((l * n - m * m) / (e * g - f * f), T::zero(), T::zero()))
        };
        let values = at_points(&self.s.0, (Self::S, context), k)?;
        Ok(grid_of(&self.s.0, values))
    }
}

/// The mean curvatures at the points of a surface, positive where it bends towards its natural
/// normal s_i x s_j: H = (E N - 2 F M + G L) / (2 (E G - F^2)), of the bicubic spline through them.
///
/// For numbers and vectors `mean` is their average: see `average`.
#[derive(Kind)]
#[kind(
    class = Numbers,
    function,
    name = "mean",
    example = "Arc a({2, 0, 0}, {1.414213562373095, 1.414213562373095, 0}, {0, 2, 0}); \
               surface s = revolve(distc(a, uniform(0.2, 0.8, 15)), 0, 1, 12); \
               farray h[15,12]; h = mean(s); assert abs(abs(h[7,6]) - 0.5) < 1e-3;"
)]
pub struct Mean<T: Scalar> {
    /// The points.
    s: GridArg<T>,
}

impl<T: Scalar> Build<T> for Mean<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let h = |jet: &SurfJet<T>| {
            let (_, [e, f, g, l, m, n]) = forms(jet)?;
            let h = (e * n - f * m * 2.0 + g * l) / ((e * g - f * f) * 2.0);
            Some(Vec3::new(h, T::zero(), T::zero()))
        };
        let values = at_points(&self.s.0, (Self::S, context), h)?;
        Ok(grid_of(&self.s.0, values))
    }
}

/// The unit normals at the points of a surface, along s_i x s_j, of the bicubic spline through
/// them; at a pole the normalised mean of the normals of the adjacent line.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "normals",
    example = "surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; \
               surface n = normals(s); assert |n[2,2] - {0, 0, 1}| < 1e-15;"
)]
pub struct Normals<T: Scalar> {
    /// The points.
    s: GridArg<T>,
}

impl<T: Scalar> Build<T> for Normals<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let all =
            at_points(&self.s.0, (Self::S, context), |jet| forms(jet).map(|(normal, _)| normal))?;
        let unit = |v: Vec3<T>| v.normalized().unwrap_or(v);
        let all = all.into_iter().map(unit).collect();
        Ok(vectors(ArrayShape::Grid(self.s.0.m, self.s.0.n), all))
    }
}
