//! B-spline and NURBS surfaces of nets of points.

use super::free_knots::{FreeKnots, FreeNet};
use crate::faults;
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{
    Build, CallError, Context, FieldId, Kind, Point, Scalar, SurfaceRef, Value,
};
use moldloft_spline::{BSplineSurface, KnotVector};

/// A B-spline surface of a net of points: S(u, v) = sum N_i(u) N_j(v) P_ij, with clamped uniform
/// knots (de Boor 1978).
///
/// It passes through the four corner points and is attracted by the others. A degree that the net
/// is too small for is lowered to the number of points less one.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "degree_u degree_v nu nv points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(0, 1, 1); AbsPoint C(1, 0, 1); AbsPoint D(1, 1, 0); \
               BSurf S({A, B, C, D}, nu = 2, nv = 2, degree_u = 1, degree_v = 1);"
)]
pub struct BSurf<T: Real> {
    /// Net of points, v running fastest: nu rows of nv points.
    #[field(min_items = 4)]
    points: Vec<Point<T>>,
    /// Points along u.
    #[field(min = 2)]
    nu: usize,
    /// Points along v.
    #[field(min = 2)]
    nv: usize,
    /// Polynomial degree in u.
    #[field(default = 3, min = 1, max = 25)]
    degree_u: usize,
    /// Polynomial degree in v.
    #[field(default = 3, min = 1, max = 25)]
    degree_v: usize,
}

impl<T: Real> Build<T> for BSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { points, nu, nv, degree_u, degree_v } = self;
        let fields = NetFields {
            points: Self::POINTS,
            degrees: [Self::DEGREE_U, Self::DEGREE_V],
            knots: [Self::DEGREE_U, Self::DEGREE_V],
        };
        let net =
            KeyedBSpline::new(points, [nu, nv], [degree_u, degree_v], [None, None], None, fields)?;
        Ok(Value::Surface(SurfaceRef::new(net, 0)))
    }
}

/// A rational B-spline surface (NURBS) of a net of points: S(u, v) = sum w_ij N_i(u) N_j(v) P_ij /
/// sum w_ij N_i(u) N_j(v) (Piegl and Tiller 1997, equation 4.11).
///
/// Knot vectors list every knot, end knots included: nu + degree_u + 1 of them, ascending; they are
/// scaled to [0, 1]. By default knots are clamped and uniform, and weights are 1.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "degree_u degree_v nu nv knots_u knots_v points weights",
    example = "AbsPoint A(1, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(0, 1, 0.2); AbsPoint D(2, 0, 1); \
               AbsPoint E(2, 2, 1.5); AbsPoint F(0, 2, 1); AbsPoint G(1, 0, 3); AbsPoint H(1, 1, 2); \
               AbsPoint I(0, 1, 3); \
               NURBSurf S({A, B, C, D, E, F}, nu = 2, nv = 3, degree_u = 1, degree_v = 2, \
               weights = {1, 0.7071, 1, 1, 0.7071, 1}); \
               NURBSurf T({A, B, C, D, E, F, G, H, I}, nu = 3, nv = 3, degree_u = 1, degree_v = 2, \
               knots_u = {0, 0, 0.25, 1, 1}, knots_v = {0, 0, 0, 2, 2, 2});"
)]
pub struct NURBSurf<T: Real> {
    /// Net of points, v running fastest: nu rows of nv points.
    #[field(min_items = 4)]
    points: Vec<Point<T>>,
    /// Points along u.
    #[field(min = 2)]
    nu: usize,
    /// Points along v.
    #[field(min = 2)]
    nv: usize,
    /// Polynomial degree in u.
    #[field(default = 3, min = 1, max = 25)]
    degree_u: usize,
    /// Polynomial degree in v.
    #[field(default = 3, min = 1, max = 25)]
    degree_v: usize,
    /// Positive weights in the order of the points; default: all 1.
    weights: Option<Vec<T>>,
    /// Knots in u: nu + degree_u + 1 ascending numbers; default: uniform.
    knots_u: Option<Vec<T>>,
    /// Knots in v: nv + degree_v + 1 ascending numbers; default: uniform.
    knots_v: Option<Vec<T>>,
}

impl<T: Scalar> Build<T> for NURBSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { points, nu, nv, degree_u, degree_v, weights, knots_u, knots_v } = self;
        if let Some(weights) = &weights {
            if weights.len() != points.len() {
                return Err(CallError::new(
                    "wrong-length",
                    "there must be a weight for each point",
                )
                .expected(format!("{} weights", points.len()))
                .found(weights.len().to_string())
                .in_field(Self::WEIGHTS));
            }
            if let Some(k) = weights.iter().position(|w| w.re() <= 0.0) {
                let found = weights[k].re();
                return Err(CallError::new("out-of-range", format!("weight {} is {found}", k + 1))
                    .expected("positive weights")
                    .found(found.to_string())
                    .in_item(k)
                    .in_field(Self::WEIGHTS));
            }
        }
        let plain = |knots: &Option<Vec<T>>| {
            knots.as_ref().map(|k| k.iter().map(|x| x.re()).collect::<Vec<f64>>())
        };
        let knots = [plain(&knots_u), plain(&knots_v)];
        let fields = NetFields {
            points: Self::POINTS,
            degrees: [Self::DEGREE_U, Self::DEGREE_V],
            knots: [Self::KNOTS_U, Self::KNOTS_V],
        };
        let net =
            KeyedBSpline::new(points, [nu, nv], [degree_u, degree_v], knots, weights, fields)?;
        if knots_u.is_none() && knots_v.is_none() {
            return Ok(Value::Surface(SurfaceRef::new(net, 0)));
        }
        // The same bits with and without derivatives by the knots.
        let KeyedBSpline { surface, corners, rows } = net;
        let free = |given: Option<Vec<T>>, knots: &KnotVector| match given {
            Some(given) => FreeKnots::normalized(knots.degree(), &given),
            None => {
                let knots_t: Vec<T> = knots.as_slice().iter().map(|&k| T::from(k)).collect();
                FreeKnots { degree: knots.degree(), knots: knots_t }
            }
        };
        let [u, v] = surface.knots();
        let free = FreeNet {
            knots: [free(knots_u, u), free(knots_v, v)],
            points: surface.control_points().to_vec(),
            weights: surface.weights().map(<[T]>::to_vec),
            corners,
            rows,
        };
        Ok(Value::Surface(SurfaceRef::new(free, 0)))
    }
}

/// A B-spline surface with the point objects at its corners.
struct KeyedBSpline<T: Real> {
    surface: BSplineSurface<T>,
    corners: [Option<Key>; 4],
    /// The point objects along the edges, where these are clamped.
    rows: Rows,
}

/// The point objects along each edge of a net.
pub(super) type Rows = [Box<[Key]>; 4];

impl<T: Real> Surface<T> for KeyedBSpline<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        self.surface.jet(u, v, order)
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        self.surface.grid(us, vs, points, normals);
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        self.surface.scattered(uv, out);
    }
    fn edges(&self) -> Edges<T> {
        Edges { corners: self.corners, ..Edges::own() }
    }

    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        self.rows[k].to_vec()
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        self.surface.line(u, vs, order)
    }

    moldloft_num::surface_facts!(breaks of [self.surface], closed of [self.surface], rational of [self.surface]);
}

struct NetFields {
    points: FieldId,
    degrees: [FieldId; 2],
    knots: [FieldId; 2],
}

impl<T: Real> KeyedBSpline<T> {
    fn new(
        points: Vec<Point<T>>,
        [nu, nv]: [usize; 2],
        [degree_u, degree_v]: [usize; 2],
        [knots_u, knots_v]: [Option<Vec<f64>>; 2],
        weights: Option<Vec<T>>,
        fields: NetFields,
    ) -> Result<Self, CallError> {
        if nu.checked_mul(nv) != Some(points.len()) || nu < 2 || nv < 2 {
            return Err(CallError::new(
                "wrong-length",
                format!("a net of {nu} x {nv} points is not {} points", points.len()),
            )
            .expected(format!("{nu} x {nv} points"))
            .found(points.len().to_string())
            .in_field(fields.points));
        }
        let knots = |given: Option<Vec<f64>>, degree: usize, n: usize, [d, k]: [FieldId; 2]| {
            let Some(given) = given else {
                return KnotVector::clamped_uniform(degree.min(n - 1), n)
                    .map_err(|error| faults::of_spline(error.into(), fields.points, d));
            };
            let found = given.len();
            if found != n + degree + 1 {
                return Err(CallError::new(
                    "wrong-length",
                    format!("{found} knots do not serve {n} points of degree {degree}"),
                )
                .expected(format!("{} knots, end knots included", n + degree + 1))
                .found(found.to_string())
                .in_field(k));
            }
            let knots = KnotVector::new(degree, given);
            Ok(knots.map_err(|error| faults::of_spline(error.into(), k, d))?.normalized())
        };
        let u = knots(knots_u, degree_u, nu, [fields.degrees[0], fields.knots[0]])?;
        let v = knots(knots_v, degree_v, nv, [fields.degrees[1], fields.knots[1]])?;
        // The corners are interpolated where the knots are clamped.
        let clamped = |k: &KnotVector| {
            let (low, high) = k.domain();
            [low, high].map(|end| k.multiplicity(end) > k.degree())
        };
        let ([west, east], [south, north]) = (clamped(&u), clamped(&v));
        let corner = |there: bool, k: usize| if there { points[k].key } else { None };
        let corners = [
            corner(west && south, 0),
            corner(east && south, (nu - 1) * nv),
            corner(east && north, nu * nv - 1),
            corner(west && north, nv - 1),
        ];
        let row = |there: bool, places: &mut dyn Iterator<Item = usize>| -> Box<[Key]> {
            let keys: Option<Box<[Key]>> = places.map(|k| points[k].key).collect();
            keys.filter(|_| there).unwrap_or_default()
        };
        let rows = [
            row(south, &mut (0..nu).map(|i| i * nv)),
            row(east, &mut ((nu - 1) * nv..nu * nv)),
            row(north, &mut (0..nu).map(|i| i * nv + nv - 1)),
            row(west, &mut (0..nv)),
        ];
        let net = points.iter().map(|p| p.xyz).collect();
        let surface = BSplineSurface::new(u, v, net, weights)
            .map_err(|error| faults::of_spline(error, fields.points, fields.degrees[0]))?;
        Ok(Self { surface, corners, rows })
    }
}
