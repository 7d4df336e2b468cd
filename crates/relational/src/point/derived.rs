//! Points off surfaces and on tangents; rotated, copied and blended points; centroids.

use crate::affine::PivotTransform;
use crate::arguments::{Bead, Magnet};
use crate::normal::normal;
use moldloft_num::{Axis, Order, Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Point, SearchReport, SearchStatus,
    SolidRef, SurfaceRef, Value,
};
use moldloft_spline::{arclen, curve_integral};

fn free<T: Real>(xyz: Vec3<T>) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::free(xyz))))
}

fn image<T: Real>(xyz: Vec3<T>, of: &Point<T>) -> Result<Value<T>, CallError> {
    Ok(Value::Point(Box::new(Point::image(xyz, of))))
}

/// A point off a surface: X = S(u, v) + d n, with n the unit normal along S_u x S_v.
///
/// At a pole the normal is the limit along the parameter line that ends there.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "magnet distance",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); \
               OffsetPoint q(p, 0.75);"
)]
pub struct OffsetPoint<T: Real> {
    /// The magnet on the surface.
    magnet: Magnet<T>,
    /// The distance, on the side of the natural normal if positive.
    distance: T,
}

impl<T: Real> Build<T> for OffsetPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let n = normal(&self.magnet).map_err(|fault| fault.in_field(Self::MAGNET))?;
        let [u, v] = self.magnet.uv;
        free(self.magnet.surface.jet(u, v, Order::Zero).p + n * self.distance)
    }
}

/// The unit tangent of a curve at a bead.
///
/// # Errors
/// `no-tangent`, in `field`, where the curve has a zero tangent.
pub fn tangent<T: Real>(bead: &Bead<T>, field: FieldId) -> Result<Vec3<T>, CallError> {
    bead.curve.jet(bead.t, Order::First)[1].normalized().ok_or_else(|| {
        CallError::new("no-tangent", "the curve has no tangent there")
            .expected("a point with a non-zero tangent")
            .found(format!("no speed at t = {}", bead.t.re()))
            .related(bead.key, "is there")
            .in_field(field)
    })
}

/// A point on the tangent of a curve: X = C(t) + d C'(t) / |C'(t)|.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "bead distance",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsBead b(c, 0.25); TanPoint p(b, 1.5);"
)]
pub struct TanPoint<T: Real> {
    /// The bead on the curve.
    bead: Bead<T>,
    /// The distance, in the direction of increasing parameter if positive.
    distance: T,
}

impl<T: Real> Build<T> for TanPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let along = tangent(&self.bead, Self::BEAD)?;
        free(self.bead.curve.jet(self.bead.t, Order::Zero)[0] + along * self.distance)
    }
}

/// A point rotated about a line by an angle, right-handed (Rodrigues).
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point line angle",
    example = "AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); Line axis(B, C); \
               RotatPoint p(A, axis, 0.75);"
)]
pub struct RotatPoint<T: Real> {
    /// The point to turn.
    point: Point<T>,
    /// The axis, from the line's first end to its last.
    line: Axis<T>,
    /// The angle.
    #[field(angle)]
    angle: T,
}

impl<T: Real> Build<T> for RotatPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        image(self.line.rotated(self.point.xyz, self.angle), &self.point)
    }
}

/// A point copied from one reference point to another and scaled along the axes: X = to + (sx, sy,
/// sz) (P - from), component by component.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "point from to sx sy sz",
    example = "AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); \
               CopyPoint p(A, B, C, 2, 1, -1);"
)]
pub struct CopyPoint<T: Real> {
    /// The point to copy.
    point: Point<T>,
    /// A point that is moved to `to`.
    from: Point<T>,
    /// The image of `from`.
    to: Point<T>,
    /// Scale along x.
    #[field(default = 1)]
    sx: T,
    /// Scale along y.
    #[field(default = 1)]
    sy: T,
    /// Scale along z.
    #[field(default = 1)]
    sz: T,
}

impl<T: Real> Build<T> for CopyPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { point, from, to, sx, sy, sz } = self;
        image(PivotTransform::scaled(from.xyz, to.xyz, [sx, sy, sz]).point(point.xyz), &point)
    }
}

/// The weighted sum of points: X = sum w_i P_i.
///
/// By default the weights are equal. Weights whose sum is not 1 raise a warning: the blend would
/// not translate with its points. The weights 1, -1, 1 give the fourth corner of a parallelogram.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "points weights",
    example = "AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); \
               BlendPoint fourth({A, B, C}, {1, -1, 1}); BlendPoint middle({A, C});"
)]
pub struct BlendPoint<T: Real> {
    /// The points.
    #[field(min_items = 1)]
    points: Vec<Point<T>>,
    /// Their weights, which should add up to 1.
    weights: Option<Vec<T>>,
}

impl<T: Real> Build<T> for BlendPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { points, weights } = self;
        let count = points.len();
        let weights = weights.unwrap_or_else(|| vec![T::from(1.0 / count as f64); count]);
        if weights.len() != count {
            return Err(CallError::new("wrong-length", "each point needs one weight")
                .expected(format!("{count} weights"))
                .found(weights.len().to_string())
                .in_field(Self::WEIGHTS));
        }
        let (mut sum, mut whole) = (Vec3::zero(), 0.0);
        for (point, weight) in points.iter().zip(weights) {
            sum += point.xyz * weight;
            whole += weight.re();
        }
        let mut blend = Point::free(sum);
        if (whole - 1.0).abs() > 1e-9 {
            blend = blend.with_found(SearchReport {
                status: SearchStatus::Unbalanced { sum: whole },
                residual: (whole - 1.0).abs(),
                iterations: 0,
                start: Vec::new(),
                last: Vec::new(),
                alternatives: Vec::new(),
                advice: "let the weights add up to 1",
            });
        }
        Ok(Value::Point(Box::new(blend)))
    }
}

/// The centroid of points, of curves by their length, of surfaces by their area, or of solids and closed
/// bodies of triangles by their volume.
///
/// All entries have one class, since a point has neither length nor area to weigh against a curve.
/// Left-handed solids count as positive volume; where a solid is folded, volume covered twice
/// counts twice.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "objects",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               BCurve l({A, B, D}); Line m(C, D); RuledSurf S(l, m); CentroidPoint p({A, B, C}); \
               CentroidPoint q({l, m}); CentroidPoint r({S}); AbsPoint E(0, 3, 0); Line up(A, E); \
               TranSolid block(S, up); CentroidPoint s({block});"
)]
pub struct CentroidPoint<T: Real> {
    /// Points, curves, surfaces or solids.
    #[field(min_items = 1)]
    objects: Vec<Value<T>>,
}

impl<T: Real> Build<T> for CentroidPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        // (size, size times centroid) of all.
        let (mut size, mut moment) = (T::zero(), Vec3::zero());
        let mut first = None;
        for (k, object) in self.objects.iter().enumerate() {
            let (kind, (s, m)) = match object {
                Value::Point(p) => ("points", (T::one(), p.xyz)),
                Value::Vector(p) => ("points", (T::one(), *p)),
                Value::Curve(curve) => ("curves", of_curve(curve)),
                Value::Surface(surface) => ("surfaces", of_surface(surface)),
                Value::Solid(solid) => ("solids", of_solid(solid)),
                Value::Body(body) => {
                    let m = body.measures().ok_or_else(|| {
                        CallError::new("no-body", "the shape has positions that are not finite")
                            .in_item(k)
                            .in_field(Self::OBJECTS)
                    })?;
                    if body.is_closed() {
                        ("solids", (m.volume, m.centroid * m.volume))
                    } else {
                        ("surfaces", (m.area, m.centroid * m.area))
                    }
                }
                other => {
                    return Err(CallError::new("wrong-class", "a centroid is of shapes")
                        .expected("points, curves, surfaces or solids")
                        .found(other.class().with_article())
                        .in_item(k)
                        .in_field(Self::OBJECTS));
                }
            };
            if *first.get_or_insert(kind) != kind {
                return Err(CallError::new(
                    "mixed-classes",
                    "a centroid is of shapes of one class",
                )
                .expected(first.unwrap_or(kind))
                .found(format!("{kind} as well"))
                .help("take the centroids of each class, and blend them")
                .in_item(k)
                .in_field(Self::OBJECTS));
            }
            size += s;
            moment += m;
        }
        if size.re() <= 0.0 {
            return Err(CallError::new("no-size", "the shapes have no size to weigh them by")
                .expected("curves with length, or surfaces with area")
                .in_field(Self::OBJECTS));
        }
        free(moment / size)
    }
}

/// Length of a curve, and the integral of C over it.
fn of_curve<T: Real>(curve: &CurveRef<T>) -> (T, Vec3<T>) {
    let curve = &**curve;
    let rough =
        (0..8).map(|k| curve.jet(T::from(f64::from(k) / 8.0 + 0.06), Order::First)[1].re().norm());
    let rough = rough.fold(0.0, f64::max);
    if rough == 0.0 {
        return (T::zero(), Vec3::zero());
    }
    let (zero, one) = (T::zero(), T::one());
    let far = curve.jet(zero, Order::Zero)[0].re().norm().max(rough);
    let axis = |k: usize| {
        curve_integral(curve, zero, one, 1e-11 * rough * far, |t| {
            let [p, d, _] = curve.jet(t, Order::First);
            p[k] * d.norm()
        })
    };
    (arclen(curve, zero, one, 1e-12 * rough), Vec3::new(axis(0), axis(1), axis(2)))
}

/// Parts of a solid per parameter, for integration.
const BLOCKS: usize = 3;

/// Volume of a solid and the integral of X over it, by Gauss's rule with eight points per
/// parameter.
fn of_solid<T: Real>(solid: &SolidRef<T>) -> (T, Vec3<T>) {
    let part = |k: usize| [k, k + 1].map(|k| k as f64 / BLOCKS as f64);
    let places: Vec<(f64, f64)> = (0..BLOCKS)
        .flat_map(|k| {
            let [a, b] = part(k);
            moldloft_num::gauss_points(a, b)
        })
        .collect();
    let (mut volume, mut moment) = (T::zero(), Vec3::zero());
    for (u, wu) in &places {
        for (v, wv) in &places {
            for (w, ww) in &places {
                let jet = solid.jet(T::from(*u), T::from(*v), T::from(*w));
                let share = jet.jacobian() * (wu * wv * ww);
                volume += share;
                moment += jet.p * share;
            }
        }
    }
    if volume.re() < 0.0 { (-volume, -moment) } else { (volume, moment) }
}

/// Parts of each span of a surface per parameter, for integration.
const PARTS: usize = 4;

/// Area of a surface and the integral of S over it, by Gauss's rule with eight points per parameter
/// on parts of the spans.
fn of_surface<T: Real>(surface: &SurfaceRef<T>) -> (T, Vec3<T>) {
    let cells = |breaks: Vec<f64>| {
        let mut ends = vec![0.0];
        ends.extend(breaks);
        ends.push(1.0);
        let part = |span: &[f64], k: usize| span[0] + (span[1] - span[0]) * k as f64 / PARTS as f64;
        let parts = |span: &[f64]| -> Vec<[f64; 2]> {
            (0..PARTS).map(|k| [part(span, k), part(span, k + 1)]).collect()
        };
        ends.windows(2).flat_map(parts).collect::<Vec<_>>()
    };
    let [us, vs] = surface.breaks().map(cells);
    let (mut area, mut moment) = (T::zero(), Vec3::zero());
    for ([a, b], [c, d]) in us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v))) {
        for (u, wu) in moldloft_num::gauss_points(a, b) {
            for (v, wv) in moldloft_num::gauss_points(c, d) {
                let jet = surface.jet(T::from(u), T::from(v), Order::First);
                let share = jet.u.cross(jet.v).norm() * (wu * wv);
                area += share;
                moment += jet.p * share;
            }
        }
    }
    (area, moment)
}
