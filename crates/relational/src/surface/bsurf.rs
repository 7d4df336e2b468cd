use crate::faults;
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{Build, Context, Fault, Kind, Point, SurfaceRef, Value};
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
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let Self { points, nu, nv, degree_u, degree_v } = self;
        if nu.checked_mul(nv) != Some(points.len()) || nu < 2 || nv < 2 {
            return Err(Fault::new(
                "wrong-length",
                format!("a net of {nu} x {nv} points is not {} points", points.len()),
            )
            .expected(format!("{nu} x {nv} points"))
            .found(points.len().to_string())
            .in_field(0));
        }
        let knots = |degree: usize, n: usize, field: usize| {
            KnotVector::clamped_uniform(degree.min(n - 1), n)
                .map_err(|error| faults::of_spline(error.into(), 0, field))
        };
        let corners = [0, (nu - 1) * nv, nu * nv - 1, nv - 1].map(|k| points[k].key);
        let net = points.iter().map(|p| p.xyz).collect();
        let surface =
            BSplineSurface::new(knots(degree_u, nu, 3)?, knots(degree_v, nv, 4)?, net, None)
                .map_err(|error| faults::of_spline(error, 0, 3))?;
        Ok(Value::Surface(SurfaceRef::new(Net { surface, corners }, 0)))
    }
}

/// A B-spline surface that knows the point objects at its corners.
struct Net<T: Real> {
    surface: BSplineSurface<T>,
    corners: [Option<Key>; 4],
}

impl<T: Real> Surface<T> for Net<T> {
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

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.surface.breaks()
    }

    fn edges(&self) -> Edges<T> {
        Edges { corners: self.corners, ..Edges::own() }
    }
}
