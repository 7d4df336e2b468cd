//! Points that three shapes have in common.

use super::arguments::Target;
use super::equations::PlainField;
use super::magnets::ANOTHER;
use super::outcome::{found, no_intersection, tangent};
use moldloft_locate::common::Three;
use moldloft_locate::implicit::{Implicit, refined, solve};
use moldloft_locate::march::Other;
use moldloft_locate::{PlainSurface, nearest_on_surface};
use moldloft_num::{Jet, Order, Plane, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, FieldRef, Kind, Point, SearchReport, SurfaceRef, Value,
};

/// The common point of three planes, surfaces or zero sets of fields.
///
/// With magnets instead of surfaces it is the point found by Newton's method from there. Without
/// them all points are searched: the result is the one nearest to `near`, by default to the middle
/// of the surfaces' parameters, and the others are reported.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "shape1 shape2 shape3 near",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); IntPoint p(S, \"x=0\", \"y=0\"); \
               XPlane x(1.5); YPlane y(2); ZPlane z(3); IntPoint q(x, y, z); AbsPoint E(1, 0.5, -2); \
               AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); Line n(E, F); \
               Line o(G, H); RuledSurf T(n, o); IntPoint r(S, T, y);"
)]
pub struct IntPoint<T: Real> {
    /// A plane, a surface (or a magnet on it near the intended point), or a field.
    shape1: Target<T>,
    /// Another.
    shape2: Target<T>,
    /// A third.
    shape3: Target<T>,
    /// Selects the nearest of several common points.
    near: Option<Point<T>>,
}

enum IntersectedShape<T: Real> {
    Surface(SurfaceRef<T>),
    Plane(Plane<T>),
    Field(FieldRef<T>),
}

impl<T: Real> Build<T> for IntPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let mut shapes = Vec::with_capacity(3);
        let mut starts = Vec::new();
        for (k, target) in [self.shape1, self.shape2, self.shape3].into_iter().enumerate() {
            shapes.push(match target {
                Target::Surface(onto) => {
                    starts.push(onto.from());
                    IntersectedShape::Surface(onto.surface)
                }
                Target::Plane(plane) => IntersectedShape::Plane(plane),
                Target::Field(field) => IntersectedShape::Field(field),
                Target::Curve(_) | Target::Point(_) => {
                    let found =
                        if matches!(target, Target::Curve(_)) { "a curve" } else { "a point" };
                    return Err(CallError::new(
                        "wrong-class",
                        "common points are those of planes, surfaces and fields",
                    )
                    .expected("a plane, a surface, a magnet or a field")
                    .found(found)
                    .help("where a curve meets one of these, use IntBead or IntMagnet")
                    .in_field([Self::SHAPE1, Self::SHAPE2, Self::SHAPE3][k]));
                }
            });
        }
        let near = self.near.map(|p| p.xyz.re());
        // Surfaces first; the order does not affect the intersection.
        shapes.sort_by_key(|shape| !matches!(shape, IntersectedShape::Surface(_)));
        let point = match starts.len() {
            0 => planes(&shapes, near)?,
            1 => common::<T, 2>(&shapes, &starts, near)?,
            2 => common::<T, 4>(&shapes, &starts, near)?,
            _ => common::<T, 6>(&shapes, &starts, near)?,
        };
        Ok(Value::Point(Box::new(point)))
    }
}

fn parallel() -> CallError {
    CallError::new("parallel-planes", "the planes have no one point in common")
        .expected("three planes of which no two are parallel, nor all to one line")
        .found("coplanar normals")
        .help("turn one of them")
}

/// The common point without a surface: of three planes by elimination, with fields by Newton's
/// method from `near`.
fn planes<T: Real>(
    shapes: &[IntersectedShape<T>],
    near: Option<Vec3>,
) -> Result<Point<T>, CallError> {
    let fields = shapes.iter().any(|s| matches!(s, IntersectedShape::Field(_)));
    let Some(mut x) = near.or_else(|| (!fields).then(Vec3::zero)) else {
        return Err(CallError::new("missing-argument", "fields have no middle to begin at")
            .expected("a point near the common point")
            .found("nothing")
            .in_field(IntPoint::<T>::NEAR));
    };
    let at = |shape: &IntersectedShape<T>, x: Vec3<T>| match shape {
        IntersectedShape::Field(field) => field.value_and_gradient(x),
        IntersectedShape::Plane(plane) => (plane.distance(x), plane.normal),
        IntersectedShape::Surface(_) => (T::zero(), Vec3::zero()),
    };
    let step = |x: Vec3<T>| -> Result<Vec3<T>, CallError> {
        let all = [0, 1, 2].map(|k| at(&shapes[k], x));
        let n = all.map(|(_, g)| g.re());
        let size = n[0].norm() * n[1].norm() * n[2].norm();
        if n[0].cross(n[1]).dot(n[2]).abs() <= 1e-12 * size {
            return Err(if fields { tangent() } else { parallel() });
        }
        let rows = all.map(|(_, g)| g.to_array());
        let back = solve(&rows, all.map(|(f, _)| f)).ok_or_else(parallel)?;
        Ok(Vec3::from(back))
    };
    if !fields {
        let x = Vec3::zero();
        return Ok(Point::free(x - step(x)?));
    }
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        let back = step(Vec3::lifted(x))?.re();
        let length = back.norm();
        if length <= 1e-15 * (1.0 + x.norm()) || length >= last && length <= 1e-9 * (1.0 + x.norm())
        {
            // One step in T adds the derivatives with respect to the model's parameters.
            let back = step(Vec3::lifted(x))?;
            return Ok(Point::free(Vec3::lifted(x) - back.map(|b| b - b.re())));
        }
        x -= back;
        last = length;
        if !x.is_finite() {
            break;
        }
    }
    Err(CallError::new("no-intersection", "the search for the common point did not converge")
        .expected("shapes that have a point in common near the start")
        .found(format!("a last step of {last:.3e}"))
        .help("give a point nearer to it"))
}

/// With at least one surface, N / 2 of them.
fn common<T: Real, const N: usize>(
    shapes: &[IntersectedShape<T>],
    starts: &[Option<[f64; 2]>],
    near: Option<Vec3>,
) -> Result<Point<T>, CallError> {
    let surfaces: Vec<PlainSurface<'_, T>> = shapes
        .iter()
        .filter_map(|s| match s {
            IntersectedShape::Surface(surface) => Some(PlainSurface(&**surface)),
            _ => None,
        })
        .collect();
    let fields: Vec<Option<PlainField<'_, T>>> = shapes
        .iter()
        .map(|s| match s {
            IntersectedShape::Field(field) => Some(PlainField(field)),
            _ => None,
        })
        .collect();
    let others: [Other<'_>; 3] = std::array::from_fn(|k| match (&shapes[k], &fields[k]) {
        (IntersectedShape::Plane(plane), _) => {
            Other::Plane(Plane { point: plane.point.re(), normal: plane.normal.re() })
        }
        (_, Some(field)) => Other::Level(field),
        _ => Other::Surface(&surfaces[k]),
    });
    // A magnet is the start on its surface; on the others the start is the point nearest to it.
    let begin = starts.iter().zip(&surfaces).find_map(|(start, surface)| {
        let [u, v] = (*start)?;
        Some(moldloft_num::Surface::jet(surface, u, v, Order::Zero).p)
    });
    let start = begin.map(|x| {
        let places: Vec<[f64; 2]> = starts
            .iter()
            .zip(&surfaces)
            .map(|(start, surface)| {
                start.unwrap_or_else(|| nearest_on_surface(surface, x, None).at)
            })
            .collect();
        std::array::from_fn(|k| places[k / 2][k % 2])
    });
    let three = Three::<N>(others);
    let solution = three
        .point(start, near)
        .map_err(|report| no_intersection(&report, "first shape", "two others"))?;
    let report: SearchReport = found(&solution.report, ANOTHER);
    let system = Common { shapes };
    let q: [T; N] = refined(&system, solution.at, T::zero()).ok_or_else(tangent)?;
    let IntersectedShape::Surface(first) = &shapes[0] else { return Err(tangent()) };
    Ok(Point::free(first.jet(q[0], q[1], Order::Zero).p).with_found(report))
}

/// All shapes pass through S1(u, v).
struct Common<'a, T: Real> {
    shapes: &'a [IntersectedShape<T>],
}

impl<T: Real, const N: usize> Implicit<T, N> for Common<'_, T> {
    fn at<J: Jet<T>>(&self, q: [J; N], _: J) -> [J; N] {
        let mut rows = [J::zero(); N];
        let mut row = 0;
        let mut x = Vec3::zero();
        for (k, shape) in self.shapes.iter().enumerate() {
            match shape {
                IntersectedShape::Surface(surface) if k == 0 => x = surface.at(q[0], q[1]),
                IntersectedShape::Surface(surface) => {
                    let gap = x - surface.at(q[2 * k], q[2 * k + 1]);
                    rows[row..row + 3].copy_from_slice(&gap.to_array());
                    row += 3;
                }
                IntersectedShape::Plane(plane) => {
                    let fixed = |v: Vec3<T>| v.map(J::fixed);
                    rows[row] = fixed(plane.normal).dot(x - fixed(plane.point));
                    row += 1;
                }
                IntersectedShape::Field(field) => {
                    rows[row] = field.at(x);
                    row += 1;
                }
            }
        }
        rows
    }

    fn jacobian(&self, q: [T; N], _: T) -> [[T; N]; N] {
        let mut rows = [[T::zero(); N]; N];
        let mut row = 0;
        let IntersectedShape::Surface(first) = &self.shapes[0] else { return rows };
        let j = first.jet(q[0], q[1], Order::First);
        for (k, shape) in self.shapes.iter().enumerate().skip(1) {
            match shape {
                IntersectedShape::Surface(surface) => {
                    let s = surface.jet(q[2 * k], q[2 * k + 1], Order::First);
                    let columns = [j.u, j.v, -s.u, -s.v].map(Vec3::to_array);
                    for axis in 0..3 {
                        rows[row][0] = columns[0][axis];
                        rows[row][1] = columns[1][axis];
                        rows[row][2 * k] = columns[2][axis];
                        rows[row][2 * k + 1] = columns[3][axis];
                        row += 1;
                    }
                }
                other => {
                    let normal = match other {
                        IntersectedShape::Plane(plane) => plane.normal,
                        IntersectedShape::Field(field) => {
                            let g = field.value_and_gradient(j.p).1;
                            g * T::from(moldloft_num::slope_scale(g.re()))
                        }
                        IntersectedShape::Surface(_) => Vec3::zero(),
                    };
                    rows[row][0] = normal.dot(j.u);
                    rows[row][1] = normal.dot(j.v);
                    row += 1;
                }
            }
        }
        rows
    }
}
