//! Arrays against shapes: nearest points, projections, intersections.

use crate::value::{Shaped, VectorArray, numbers, vectors};
use moldloft_locate::march::{Branch, Crossing};
use moldloft_locate::{
    NearestCurve, NearestSurface, PlainCurve, PlainSurface, Roots, curve_pairs, implicit, roots,
};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, FromValue, Kind, Scalar, SurfaceRef, Value,
};

fn dots<T: Real>(v: Vec3<T>, a: Vec3<f64>) -> T {
    v.x * a.x + v.y * a.y + v.z * a.z
}

/// The parameters of the nearest points of a surface, with derivatives, and the distances.
pub fn nearest_parameters<T: Real>(
    surface: &SurfaceRef<T>,
    points: &[Vec3<T>],
) -> (Vec<[T; 2]>, Vec<f64>) {
    let plain = PlainSurface(&**surface);
    let search = NearestSurface::new(&plain);
    points
        .iter()
        .map(|p| {
            let found = search.nearest(&plain, p.re());
            (surface_foot(surface, *p, found.at), found.distance)
        })
        .unzip()
}

/// (u, v) with the derivatives that the equations (S - p) . S_u = 0 and (S - p) . S_v = 0 give; at an
/// edge that the foot is held by, only of the one along it.
fn surface_foot<T: Real>(surface: &SurfaceRef<T>, p: Vec3<T>, at: [f64; 2]) -> [T; 2] {
    let at_t = at.map(T::from);
    if T::PARTS == 1 {
        return at_t;
    }
    let jet = surface.jet(at_t[0], at_t[1], Order::Second);
    let gap = jet.p - p;
    let f = [gap.dot(jet.u), gap.dot(jet.v)];
    let uv = dots(jet.uv, gap.re());
    let a = [
        [jet.u.norm_sq() + dots(jet.uu, gap.re()), jet.u.dot(jet.v) + uv],
        [jet.u.dot(jet.v) + uv, jet.v.norm_sq() + dots(jet.vv, gap.re())],
    ]
    .map(|row| row.map(|x| x.re()));
    let scale = jet.u.re().norm() * gap.re().norm();
    // At an edge the gradient does not vanish, since the foot would be outside.
    let held = |k: usize| {
        let edge = at[k] == 0.0 || at[k] == 1.0;
        edge && f[k].re().abs() > 1e-9 * scale.max(f64::MIN_POSITIVE)
    };
    let rest = f.map(|x| x - x.re());
    let mut step = [T::zero(); 2];
    match (held(0), held(1)) {
        (true, true) => {}
        (true, false) if a[1][1] != 0.0 => step[1] = rest[1] / a[1][1],
        (false, true) if a[0][0] != 0.0 => step[0] = rest[0] / a[0][0],
        (false, false) => {
            let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
            if det != 0.0 {
                step[0] = (rest[0] * a[1][1] - rest[1] * a[0][1]) / det;
                step[1] = (rest[1] * a[0][0] - rest[0] * a[1][0]) / det;
            }
        }
        _ => {}
    }
    [at_t[0] - step[0], at_t[1] - step[1]]
}

fn curve_foot<T: Real>(curve: &CurveRef<T>, p: Vec3<T>, t: f64) -> T {
    if T::PARTS == 1 {
        return T::from(t);
    }
    let [c, d, dd] = curve.jet(T::from(t), Order::Second);
    let gap = c - p;
    let f = gap.dot(d);
    let slope = (d.norm_sq() + dots(dd, gap.re())).re();
    let held = (t == 0.0 || t == 1.0) && f.re().abs() > 1e-9 * d.re().norm() * gap.re().norm();
    if held || slope == 0.0 { T::from(t) } else { T::from(t) - (f - f.re()) / slope }
}

/// The parameter of the point of a curve that is nearest to a point; for each point of a curve of
/// points, an farray.
///
/// With several at equal distance, the first. Ends are included.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "closest",
    example = "Line l({0, 0, 0}, {4, 0, 0}); assert abs(closest({1, 2, 0}, l) - 0.25) < 1e-12;"
)]
pub struct Closest<T: Scalar> {
    /// A point, or a curve of points.
    p: Shaped<T>,
    /// The curve.
    curve: CurveRef<T>,
}

impl<T: Scalar> Build<T> for Closest<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { p, curve } = self;
        let plain = PlainCurve(&*curve);
        let search = NearestCurve::new(&plain);
        let foot = |p: Vec3<T>| curve_foot(&curve, p, search.nearest(&plain, p.re()).at[0]);
        Ok(match p {
            Shaped::One(p) => Value::Number(foot(p)),
            Shaped::Many(VectorArray { shape, items }) => {
                numbers(shape, items.into_iter().map(foot).collect())
            }
        })
    }
}

/// The points of a surface nearest to the points of an array ("closest"), or their projections
/// along a direction, forwards or backwards.
///
/// Along a direction the nearest of several intersections counts. With "closest" a point beyond an
/// edge is projected to the edge.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "project",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); \
               vector p = project({0.5, 0.5, 3}, r, {0, 0, 1}); assert abs(p.z - 0.25) < 1e-12; \
               vector q = project({0.5, 0.5, 3}, r, \"closest\");"
)]
pub struct Project<T: Scalar> {
    /// A vector, a curve or a surface of points.
    o: Shaped<T>,
    /// The surface.
    surface: SurfaceRef<T>,
    /// The direction, or "closest".
    dir: Value<T>,
}

impl<T: Scalar> Build<T> for Project<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { o, surface, dir } = self;
        let (shape, points) = match &o {
            Shaped::One(p) => (None, vec![*p]),
            Shaped::Many(a) => (Some(a.shape), a.items.clone()),
        };
        let moved: Vec<Vec3<T>> = match &dir {
            Value::Text(word) if &**word == "closest" => {
                let (uv, _) = nearest_parameters(&surface, &points);
                uv.into_iter().map(|[u, v]| surface.jet(u, v, Order::Zero).p).collect()
            }
            Value::Text(word) => {
                return Err(CallError::new(
                    "unknown-word",
                    format!("unknown direction \"{word}\""),
                )
                .expected("\"closest\", or a vector")
                .found(format!("\"{word}\""))
                .in_field(Self::DIR));
            }
            other => {
                let d = <Vec3<T>>::from_value(other).map_err(|fault| fault.in_field(Self::DIR))?;
                along(&surface, &points, d)?
            }
        };
        Ok(match shape {
            None => Value::Vector(moved[0]),
            Some(shape) => vectors(shape, moved),
        })
    }
}

fn along<T: Scalar>(
    surface: &SurfaceRef<T>,
    points: &[Vec3<T>],
    d: Vec3<T>,
) -> Result<Vec<Vec3<T>>, CallError> {
    if d.re().norm() == 0.0 {
        return Err(CallError::new("no-direction", "the direction is zero")
            .expected("a non-zero vector")
            .in_field(Project::<T>::DIR));
    }
    let plain = PlainSurface(&**surface);
    let mut moved = Vec::with_capacity(points.len());
    for (k, p) in points.iter().enumerate() {
        let found = roots::line_surface(&plain, p.re(), d.re(), None).map_err(|report| {
            let message = format!("the line through point {} misses the surface", k + 1);
            CallError::new("no-solution", message)
                .expected("a line that meets the surface")
                .found(format!("a gap of {}", report.residual))
                .help("\"closest\" finds a point in every case")
                .in_item(k)
                .in_field(Project::<T>::O)
        })?;
        let [_, _, s] = found.at;
        if T::PARTS == 1 {
            moved.push(*p + d * T::from(s));
            continue;
        }
        let [u, v, s] = found.at.map(T::from);
        let jet = surface.jet(u, v, Order::First);
        let rest = (jet.p - *p - d * s).map(|x| x - x.re()).to_array();
        let columns = [jet.u.re(), jet.v.re(), -d.re()].map(Vec3::to_array);
        let a: [[T; 3]; 3] =
            std::array::from_fn(|r| std::array::from_fn(|c| T::from(columns[c][r])));
        // At a tangential intersection of line and surface there is no derivative.
        let s = implicit::solve(&a, rest).map_or(s, |step| s - step[2]);
        moved.push(*p + d * s);
    }
    Ok(moved)
}

fn none(what: &str, residual: f64, field: FieldId) -> CallError {
    CallError::new("no-solution", format!("{what} do not meet"))
        .expected("shapes that meet")
        .found(format!("a gap of {residual}"))
        .in_field(field)
}

fn nothing<const N: usize>(roots: &Roots<N>, what: &str, field: FieldId) -> CallError {
    none(what, roots.closest.map_or(f64::INFINITY, |(_, residual)| residual), field)
}

/// The intersection of two shapes with parameters: of two curves, or a curve and a surface, the points, in
/// the order of the first curve's parameter; of two surfaces a branch of their intersection, as a
/// curve of points: the longest, or another by its number.
///
/// Points are found to 1e-12 of the size. `intersections` gives all branches.
#[derive(Kind)]
#[kind(
    class = Vectors,
    function,
    name = "intersect",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); \
               Line l({0.5, 0.5, -1}, {0.5, 0.5, 1}); curve p = intersect(l, r); \
               assert |p[1] - {0.5, 0.5, 0.25}| < 1e-12;"
)]
pub struct Intersect<T: Scalar> {
    /// A curve or a surface.
    a: Value<T>,
    /// A curve or a surface.
    b: Value<T>,
    /// The number of the branch, longest first; only two surfaces have several.
    #[field(default = 1, min = 1)]
    branch: usize,
}

impl<T: Scalar> Build<T> for Intersect<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (count, found) = meetings(&self.a, &self.b, Some(self.branch - 1), [Self::A, Self::B])?;
        match found.into_iter().next() {
            Some(points) => Ok(crate::value::curve(points)),
            None => {
                Err(CallError::new("no-solution", format!("there is no branch {}", self.branch))
                    .expected(format!("a branch from 1 to {count}"))
                    .found(self.branch.to_string())
                    .in_field(Self::BRANCH))
            }
        }
    }
}

/// All branches of the intersection of two surfaces as a list of curves, the longest first; for
/// other shapes, the result of `intersect` alone.
///
/// `foreach (c in intersections(p, q))` walks through them, `intersections(p, q)[2]` is the second.
#[derive(Kind)]
#[kind(
    class = Any,
    function,
    name = "intersections",
    example = "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 0}); RuledSurf r(a, b); \
               BCurve w({{0, 0.5, 1}, {0.5, 0.5, -3}, {1, 0.5, 1}}); \
               Line y({0, 0, 1}, {0, 1, 1}); TranSurf t(y, w); \
               float n = 0; foreach (c in intersections(r, t)) n += 1; assert n == 2;"
)]
pub struct Intersections<T: Scalar> {
    /// A curve or a surface.
    a: Value<T>,
    /// A curve or a surface.
    b: Value<T>,
}

impl<T: Scalar> Build<T> for Intersections<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (_, found) = meetings(&self.a, &self.b, None, [Self::A, Self::B])?;
        Ok(Value::list(found.into_iter().map(crate::value::curve)))
    }
}

/// The number of branches, and the points of all of them or of the requested one (from 0).
fn meetings<T: Real>(
    a: &Value<T>,
    b: &Value<T>,
    only: Option<usize>,
    fields: [FieldId; 2],
) -> Result<(usize, Vec<Vec<Vec3<T>>>), CallError> {
    let points = match (a, b) {
        (Value::Curve(a), Value::Curve(b)) => curves(a, b, fields[1])?,
        (Value::Curve(a), Value::Surface(b)) | (Value::Surface(b), Value::Curve(a)) => {
            curve_surface(a, b, fields[1])?
        }
        (Value::Surface(a), Value::Surface(b)) => return surfaces(a, b, only, fields[1]),
        (a, b) => {
            let second = usize::from(matches!(a, Value::Curve(_) | Value::Surface(_)));
            let other = [a, b][second];
            let found = other.class().with_article();
            let fault = CallError::new(
                "wrong-class",
                format!("expected a pcurve or a psurface, found {found}"),
            )
            .expected("a curve or a surface with parameters")
            .found(found);
            return Err(match other {
                Value::Vectors(_) => fault.help("makecc(c) or makecs(s) interpolates points"),
                _ => fault,
            }
            .in_field(fields[second]));
        }
    };
    Ok((1, if only.unwrap_or(0) == 0 { vec![points] } else { Vec::new() }))
}

fn curves<T: Real>(
    a: &CurveRef<T>,
    b: &CurveRef<T>,
    field: FieldId,
) -> Result<Vec<Vec3<T>>, CallError> {
    let found = curve_pairs::all_curve_curve(&PlainCurve(&**a), &PlainCurve(&**b), 0.0);
    if found.roots.is_empty() {
        let gap = found.closest.map_or(f64::INFINITY, |(_, r)| r);
        return Err(none("the two curves", gap, field));
    }
    Ok(found
        .roots
        .iter()
        .map(|root| {
            let [t, s] = root.at.map(T::from);
            let ([p, d, _], [q, e, _]) = (a.jet(t, Order::First), b.jet(s, Order::First));
            if T::PARTS == 1 {
                return p;
            }
            // Least squares of p + d dt = q + e ds in the derivative parts.
            let gap = (p - q).map(|x| x - x.re());
            let (d, e) = (d.re(), e.re());
            let (dd, de, ee) = (d.norm_sq(), d.dot(e), e.norm_sq());
            let det = dd * ee - de * de;
            if det == 0.0 {
                return p;
            }
            let (x, y) = (dots(gap, d), dots(gap, e));
            let dt = -(x * ee - y * de) / det;
            p + Vec3::lifted(d) * dt
        })
        .collect())
}

fn curve_surface<T: Real>(
    curve: &CurveRef<T>,
    surface: &SurfaceRef<T>,
    field: FieldId,
) -> Result<Vec<Vec3<T>>, CallError> {
    let found = roots::all_curve_surface(&PlainCurve(&**curve), &PlainSurface(&**surface));
    if found.roots.is_empty() {
        return Err(nothing(&found, "the curve and the surface", field));
    }
    Ok(found
        .roots
        .iter()
        .map(|root| {
            let [t, u, v] = root.at.map(T::from);
            let [p, d, _] = curve.jet(t, Order::First);
            if T::PARTS == 1 {
                return p;
            }
            let jet = surface.jet(u, v, Order::First);
            let rest = (p - jet.p).map(|x| x - x.re()).to_array();
            let columns = [d.re(), -jet.u.re(), -jet.v.re()].map(Vec3::to_array);
            let a: [[T; 3]; 3] =
                std::array::from_fn(|r| std::array::from_fn(|c| T::from(columns[c][r])));
            implicit::solve(&a, rest).map_or(p, |step| p - Vec3::lifted(d.re()) * step[0])
        })
        .collect())
}

fn surfaces<T: Real>(
    a: &SurfaceRef<T>,
    b: &SurfaceRef<T>,
    only: Option<usize>,
    field: FieldId,
) -> Result<(usize, Vec<Vec<Vec3<T>>>), CallError> {
    let (p, q) = (PlainSurface(&**a), PlainSurface(&**b));
    let mut branches = Crossing::with_surface(&p, &q).branches().branches;
    let length = |branch: &Branch| -> f64 {
        branch.stations.windows(2).map(|w| w[0].x.distance(w[1].x)).sum()
    };
    if branches.is_empty() {
        return Err(none("the two surfaces", f64::INFINITY, field));
    }
    // Stable: branches of one length stay in the order in which they were found.
    branches.sort_by(|x, y| length(y).total_cmp(&length(x)));
    let wanted = |k: &usize| only.is_none_or(|only| only == *k);
    let points = (0..branches.len()).filter(wanted).map(|k| along_branch(a, b, &branches[k]));
    Ok((branches.len(), points.collect()))
}

/// The points of a branch, with derivatives.
fn along_branch<T: Real>(a: &SurfaceRef<T>, b: &SurfaceRef<T>, branch: &Branch) -> Vec<Vec3<T>> {
    branch
        .stations
        .iter()
        .map(|station| {
            let [u, v, s, t] = station.q.map(T::from);
            let (f, g) = (a.jet(u, v, Order::First), b.jet(s, t, Order::First));
            if T::PARTS == 1 {
                return f.p;
            }
            // A - B = 0, and no motion along the branch.
            let gap = (f.p - g.p).map(|x| x - x.re());
            let drift = dots(f.p.map(|x| x - x.re()), station.tangent);
            let [gx, gy, gz] = gap.to_array();
            let columns = [f.u.re(), f.v.re(), -g.u.re(), -g.v.re()];
            let along = [f.u.re().dot(station.tangent), f.v.re().dot(station.tangent), 0.0, 0.0];
            let a: [[T; 4]; 4] = std::array::from_fn(|r| {
                std::array::from_fn(|c| {
                    T::from(if r < 3 { columns[c].to_array()[r] } else { along[c] })
                })
            });
            implicit::solve(&a, [gx, gy, gz, drift]).map_or(f.p, |step| {
                f.p - Vec3::lifted(f.u.re()) * step[0] - Vec3::lifted(f.v.re()) * step[1]
            })
        })
        .collect()
}
