//! B-spline solids of nets of points.

use crate::faults;
use moldloft_num::trace::Faces;
use moldloft_num::{Jet, Order, Real, SolidFormula, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Point, SolidRef, Value};
use moldloft_spline::KnotVector;

/// A B-spline solid of a net of points: X(u, v, w) = sum N_i(u) N_j(v) N_k(w) P_ijk, with clamped
/// uniform knots.
///
/// It passes through the eight corner points and is attracted by the others. A degree that the net is
/// too small for is lowered to the number of points less one.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "degree_u degree_v degree_w nu nv nw points",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(0, 0, 2); AbsPoint C(0, 2, 0); AbsPoint D(0, 2, 2); \
               AbsPoint E(1, 0.5, 0); AbsPoint F(1, 0, 3); AbsPoint G(1, 2, 0); AbsPoint H(1, 2.5, 2); \
               AbsPoint I(3, 0, 0); AbsPoint J(3, 0, 2); AbsPoint K(3, 2, 0); AbsPoint L(3, 2, 2); \
               BSolid S({A, B, C, D, E, F, G, H, I, J, K, L}, nu = 3, nv = 2, nw = 2);"
)]
pub struct BSolid<T: Real> {
    /// Net of points, w running fastest, then v: nu times nv rows of nw points.
    #[field(min_items = 8)]
    points: Vec<Point<T>>,
    /// Points along u.
    #[field(min = 2)]
    nu: usize,
    /// Points along v.
    #[field(min = 2)]
    nv: usize,
    /// Points along w.
    #[field(min = 2)]
    nw: usize,
    /// Polynomial degree in u.
    #[field(default = 3, min = 1, max = 25)]
    degree_u: usize,
    /// Polynomial degree in v.
    #[field(default = 3, min = 1, max = 25)]
    degree_v: usize,
    /// Polynomial degree in w.
    #[field(default = 3, min = 1, max = 25)]
    degree_w: usize,
}

impl<T: Real> Build<T> for BSolid<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { points, nu, nv, nw, degree_u, degree_v, degree_w } = self;
        let size = [nu, nv, nw];
        let count = nu.checked_mul(nv).and_then(|n| n.checked_mul(nw));
        if count != Some(points.len()) || size.iter().any(|&n| n < 2) {
            let message =
                format!("a net of {nu} x {nv} x {nw} points is not {} points", points.len());
            return Err(CallError::new("wrong-length", message)
                .expected(format!("{nu} x {nv} x {nw} points, at least 2 each way"))
                .found(points.len().to_string())
                .in_field(Self::POINTS));
        }
        let knots = |degree: usize, n: usize, field: FieldId| {
            KnotVector::clamped_uniform(degree.min(n - 1), n)
                .map_err(|error| faults::of_spline(error.into(), Self::POINTS, field))
        };
        let knots = [
            knots(degree_u, nu, Self::DEGREE_U)?,
            knots(degree_v, nv, Self::DEGREE_V)?,
            knots(degree_w, nw, Self::DEGREE_W)?,
        ];
        let corners = std::array::from_fn(|c| {
            let at = |axis: usize| if c >> axis & 1 == 1 { size[axis] - 1 } else { 0 };
            points[(at(0) * nv + at(1)) * nw + at(2)].key
        });
        let net = points.iter().map(|p| p.xyz).collect();
        Ok(Value::Solid(SolidRef::new(BSplineSolid { knots, net, corners }, 0)))
    }
}

struct BSplineSolid<T: Real> {
    knots: [KnotVector; 3],
    net: Vec<Vec3<T>>,
    corners: [Option<moldloft_num::trace::Key>; 8],
}

impl<T: Real> SolidFormula for BSplineSolid<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J, w: J) -> Vec3<J> {
        let at = [u, v, w];
        let [a, b, c] = [0, 1, 2].map(|axis| self.knots[axis].basis(at[axis], Order::Zero));
        let (nv, nw) = (self.knots[1].points(), self.knots[2].points());
        let mut sum = Vec3::zero();
        for (i, &x) in a.rows[0].iter().enumerate() {
            for (j, &y) in b.rows[0].iter().enumerate() {
                let row = ((a.first + i) * nv + b.first + j) * nw + c.first;
                let share = x * y;
                for (&z, p) in c.rows[0].iter().zip(&self.net[row..]) {
                    let share = share * z;
                    sum += p.map(|x| share.scaled(x));
                }
            }
        }
        sum
    }

    fn faces(&self) -> Faces<T> {
        Faces { corners: self.corners, ..Faces::own() }
    }
}
