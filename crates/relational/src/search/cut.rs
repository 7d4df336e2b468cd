//! The shape of an intersection: pieces near it, and the place of each point on both shapes.

use super::equations::PlainField;
use moldloft_locate::PlainSurface;
use moldloft_locate::implicit::{Implicit, jets, refined, solve};
use moldloft_locate::march::{Crossing, Other, Unknowns};
use moldloft_num::trace::Trace;
use moldloft_num::{
    Curve, CurveJet, Jet, Order, Plane, Real, SurfJet, Vec3, slope_scale, solve_dense,
};
use moldloft_registry::{FieldRef, SurfaceRef};

/// What the surface is cut by.
#[derive(Clone)]
pub(super) enum Second<T: Real> {
    Plane(Plane<T>),
    Surface(SurfaceRef<T>),
    Field(FieldRef<T>),
}

/// The second shape in plain numbers, for as long as a search lasts.
pub(super) enum PlainSecond<'a, T: Real> {
    Plane(Plane<f64>),
    Surface(PlainSurface<'a, T>),
    Field(PlainField<'a, T>),
}

impl<T: Real> Second<T> {
    pub fn plain(&self) -> PlainSecond<'_, T> {
        match self {
            Second::Plane(plane) => {
                PlainSecond::Plane(Plane { point: plane.point.re(), normal: plane.normal.re() })
            }
            Second::Surface(surface) => PlainSecond::Surface(PlainSurface(&**surface)),
            Second::Field(field) => PlainSecond::Field(PlainField(field)),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Second::Plane(_) => "plane",
            Second::Surface(_) => "other surface",
            Second::Field(_) => "field",
        }
    }
}

impl<T: Real> PlainSecond<'_, T> {
    pub fn other(&self) -> Other<'_> {
        match self {
            PlainSecond::Plane(plane) => Other::Plane(*plane),
            PlainSecond::Surface(surface) => Other::Surface(surface),
            PlainSecond::Field(field) => Other::Level(field),
        }
    }
}

/// Points of a piece that its polynomial goes through.
pub(super) const NODES: usize = 7;

/// A stretch of the intersection with a polynomial near it: the place is the point of the
/// intersection across from the polynomial's.
#[derive(Clone, Debug)]
pub(super) struct Piece<T> {
    /// Length along the snake at which it begins, and its own length.
    pub begin: T,
    pub length: T,
    /// Powers of 2 x - 1, with x the share of the piece.
    pub powers: Vec<Vec3<T>>,
    /// The unknowns at the nodes, where iterations begin.
    pub places: [Unknowns; NODES],
}

/// X(t) = S(w(t)) on both shapes.
pub(super) struct Cut<T: Real> {
    pub trace: Trace<T>,
    pub first: SurfaceRef<T>,
    pub second: Second<T>,
    pub pieces: Vec<Piece<T>>,
    pub total: T,
    pub size: f64,
    pub closed: bool,
}

/// Both shapes at a place of the cut: unit tangent and change of the parameters along it.
struct Along<T> {
    w: [T; 2],
    rate: [T; 2],
    /// Of the second order by the length.
    bend: [T; 2],
}

/// Nodes on [0, 1]: both ends, denser towards them (Chebyshev and Lobatto).
pub(super) fn node(k: usize) -> f64 {
    0.5 - 0.5 * Real::cos(k as f64 * std::f64::consts::PI / (NODES - 1) as f64)
}

/// The matrix from values at the nodes to powers of 2 x - 1.
pub(super) fn to_powers() -> [[f64; NODES]; NODES] {
    std::array::from_fn(|column| {
        let mut matrix: Vec<f64> = (0..NODES)
            .flat_map(|k| (0..NODES).map(move |p| (2.0 * node(k) - 1.0).powi(p as i32)))
            .collect();
        let mut unit: [f64; NODES] = std::array::from_fn(|k| f64::from(u8::from(k == column)));
        solve_dense(&mut matrix, &mut unit).expect("the nodes are different");
        unit
    })
}

pub(super) fn powers_of<T: Real>(
    matrix: &[[f64; NODES]; NODES],
    values: &[Vec3<T>; NODES],
) -> Vec<Vec3<T>> {
    let power =
        |p: usize| (0..NODES).fold(Vec3::zero(), |sum, k| sum + values[k] * T::from(matrix[k][p]));
    (0..NODES).map(power).collect()
}

/// Value and derivative by x of a polynomial in powers of 2 x - 1.
pub(super) fn polynomial<T: Real, J: Jet<T>>(powers: &[Vec3<T>], x: J) -> [Vec3<J>; 2] {
    let y = x * 2.0 - 1.0;
    let (mut value, mut slope) = (Vec3::<J>::zero(), Vec3::<J>::zero());
    for p in powers.iter().rev() {
        slope = slope * y + value;
        value = value * y + p.map(J::fixed);
    }
    [value, slope * J::from(2.0)]
}

/// A point of both shapes across from a polynomial's.
struct Across<'a, T: Real> {
    first: &'a SurfaceRef<T>,
    powers: &'a [Vec3<T>],
}

impl<T: Real> Across<'_, T> {
    fn level<J: Jet<T>>(&self, point: Vec3<J>, x: J) -> J {
        let [c, d] = polynomial(self.powers, x);
        d.dot(point - c)
    }
    fn gradient(&self, j: &moldloft_num::SurfJet<T>, x: T) -> [T; 2] {
        let [_, d] = polynomial::<T, T>(self.powers, x);
        [d.dot(j.u), d.dot(j.v)]
    }
}

struct AcrossPlane<'a, T: Real>(Across<'a, T>, &'a Plane<T>);

impl<T: Real> Implicit<T, 2> for AcrossPlane<'_, T> {
    fn at<J: Jet<T>>(&self, [u, v]: [J; 2], x: J) -> [J; 2] {
        let p = self.0.first.at(u, v);
        let fixed = |a: Vec3<T>| a.map(J::fixed);
        [fixed(self.1.normal).dot(p - fixed(self.1.point)), self.0.level(p, x)]
    }
    fn jacobian(&self, [u, v]: [T; 2], x: T) -> [[T; 2]; 2] {
        let j = self.0.first.jet(u, v, Order::First);
        [[self.1.normal.dot(j.u), self.1.normal.dot(j.v)], self.0.gradient(&j, x)]
    }
}

struct AcrossField<'a, T: Real>(Across<'a, T>, &'a FieldRef<T>);

impl<T: Real> Implicit<T, 2> for AcrossField<'_, T> {
    fn at<J: Jet<T>>(&self, [u, v]: [J; 2], x: J) -> [J; 2] {
        let p = self.0.first.at(u, v);
        [self.1.at(p), self.0.level(p, x)]
    }
    fn jacobian(&self, [u, v]: [T; 2], x: T) -> [[T; 2]; 2] {
        let j = self.0.first.jet(u, v, Order::First);
        let g = self.1.value_and_gradient(j.p).1;
        let g = g * T::from(slope_scale(g.re()));
        [[g.dot(j.u), g.dot(j.v)], self.0.gradient(&j, x)]
    }
}

struct AcrossSurface<'a, T: Real>(Across<'a, T>, &'a SurfaceRef<T>);

impl<T: Real> Implicit<T, 4> for AcrossSurface<'_, T> {
    fn at<J: Jet<T>>(&self, [u, v, p, r]: [J; 4], x: J) -> [J; 4] {
        let point = self.0.first.at(u, v);
        let gap = point - self.1.at(p, r);
        [gap.x, gap.y, gap.z, self.0.level(point, x)]
    }
    fn jacobian(&self, [u, v, p, r]: [T; 4], x: T) -> [[T; 4]; 4] {
        let j = self.0.first.jet(u, v, Order::First);
        let k = self.1.jet(p, r, Order::First);
        let c = [j.u, j.v, -k.u, -k.v].map(Vec3::to_array);
        let row = |a: usize| [c[0][a], c[1][a], c[2][a], c[3][a]];
        let [gu, gv] = self.0.gradient(&j, x);
        [row(0), row(1), row(2), [gu, gv, T::zero(), T::zero()]]
    }
}

/// Unknowns with their derivatives by the parameter of a polynomial.
pub(super) fn derived<T: Real>(
    first: &SurfaceRef<T>,
    second: &Second<T>,
    powers: &[Vec3<T>],
    q: Unknowns,
    x: T,
    order: Order,
) -> Option<[[T; 2]; 3]> {
    let across = Across { first, powers };
    match second {
        Second::Plane(plane) => jets(&AcrossPlane(across, plane), [q[0], q[1]], x, order),
        Second::Field(field) => jets(&AcrossField(across, field), [q[0], q[1]], x, order),
        Second::Surface(surface) => {
            let all = jets(&AcrossSurface(across, surface), q, x, order)?;
            Some(all.map(|[u, v, ..]| [u, v]))
        }
    }
}

impl<T: Real> Cut<T> {
    /// The piece with the length `s`, and the share of it.
    fn share(&self, t: T) -> (&Piece<T>, T) {
        let s = self.total * t;
        let k = self.pieces.partition_point(|p| p.begin.re() <= s.re()).saturating_sub(1);
        let piece = &self.pieces[k];
        (piece, (s - piece.begin) / piece.length)
    }

    /// (u, v, 0) with derivatives by t.
    ///
    /// The parameter is the share of the length, so derivatives are those by the length, from the
    /// normals of both shapes: they do not depend on where the pieces end.
    fn place(&self, t: T, order: Order) -> CurveJet<T> {
        let (piece, x) = self.share(t);
        let first = PlainSurface(&*self.first);
        let second = self.second.plain();
        let crossing = Crossing::local(&first, second.other(), self.size);
        self.place_near(&crossing, piece, x, order)
    }

    fn place_near(
        &self,
        crossing: &Crossing<'_>,
        piece: &Piece<T>,
        x: T,
        order: Order,
    ) -> CurveJet<T> {
        let plain = x.re();
        let [c, d] = polynomial::<T, T>(&piece.powers, T::from(plain)).map(Vec3::re);
        let near = (0..NODES)
            .min_by(|&a, &b| (node(a) - plain).abs().total_cmp(&(node(b) - plain).abs()))
            .expect("there are nodes");
        let guess = guess(&piece.places, near, plain);
        let q = crossing.across_near(guess, c, d / d.norm()).unwrap_or(guess);
        let flat = |[u, v]: [T; 2], by: T| Vec3::new(u * by, v * by, T::zero());
        let plain_jet =
            [flat([T::from(q[0]), T::from(q[1])], T::one()), Vec3::zero(), Vec3::zero()];
        let Some(all) = self.unknowns(piece, q, x) else { return plain_jet };
        if order == Order::Zero {
            return [flat([all[0], all[1]], T::one()), Vec3::zero(), Vec3::zero()];
        }
        let Some(along) = self.along(all, d, order) else { return plain_jet };
        let rate = self.total;
        [flat(along.w, T::one()), flat(along.rate, rate), flat(along.bend, rate * rate)]
    }

    /// All unknowns at the share `x` of a piece, with what they owe to the model's parameters.
    fn unknowns(&self, piece: &Piece<T>, q: Unknowns, x: T) -> Option<[T; 4]> {
        let across = Across { first: &self.first, powers: &piece.powers };
        match &self.second {
            Second::Plane(plane) => {
                let [u, v] = refined(&AcrossPlane(across, plane), [q[0], q[1]], x)?;
                Some([u, v, T::zero(), T::zero()])
            }
            Second::Field(field) => {
                let [u, v] = refined(&AcrossField(across, field), [q[0], q[1]], x)?;
                Some([u, v, T::zero(), T::zero()])
            }
            Second::Surface(surface) => refined(&AcrossSurface(across, surface), q, x),
        }
    }

    /// Derivatives of u and v by the length at a place, in the direction of `d`: with N = n1 x n2
    /// for normals that are no unit vectors, T = N / |N| and T' = (N' - T (T . N')) / |N|.
    fn along(&self, [u, v, p, r]: [T; 4], d: Vec3, order: Order) -> Option<Along<T>> {
        let j = self.first.jet(u, v, order);
        let k = match &self.second {
            Second::Surface(surface) => Some(surface.jet(p, r, order)),
            Second::Plane(_) | Second::Field(_) => None,
        };
        let m = j.u.cross(j.v);
        let n = match (&self.second, &k) {
            (Second::Plane(plane), _) => plane.normal,
            (Second::Field(field), _) => {
                let g = field.value_and_gradient(j.p).1;
                g * T::from(slope_scale(g.re()))
            }
            (_, Some(k)) => k.u.cross(k.v),
            _ => unreachable!("a second surface has its jet"),
        };
        let along = m.cross(n);
        let sign = if along.re().dot(d) < 0.0 { -1.0 } else { 1.0 };
        let length = along.norm() * sign;
        if length.re() == 0.0 {
            return None;
        }
        let tangent = along / length;
        let in_plane = |s: &SurfJet<T>, x: Vec3<T>| {
            let a = s.u.dot(s.v);
            solve(&[[s.u.norm_sq(), a], [a, s.v.norm_sq()]], [x.dot(s.u), x.dot(s.v)])
        };
        let rate = in_plane(&j, tangent)?;
        if order == Order::First {
            return Some(Along { w: [u, v], rate, bend: [T::zero(); 2] });
        }
        // How the normal S_u x S_v changes along the tangent.
        let turn = |s: &SurfJet<T>, [a, b]: [T; 2]| {
            (s.uu * a + s.uv * b).cross(s.v) + s.u.cross(s.uv * a + s.vv * b)
        };
        let dm = turn(&j, rate);
        let dn = match &k {
            Some(k) => turn(k, in_plane(k, tangent)?),
            None => match &self.second {
                Second::Field(field) => {
                    let (_, g, h) = field.second_order(j.p);
                    let change = Vec3::new(h[0].dot(tangent), h[1].dot(tangent), h[2].dot(tangent));
                    change * T::from(slope_scale(g.re()))
                }
                _ => Vec3::zero(),
            },
        };
        let change = dm.cross(n) + m.cross(dn);
        let curvature = (change - tangent * tangent.dot(change)) / length;
        let [a, b] = rate;
        let own = j.uu * (a * a) + j.uv * (a * b * 2.0) + j.vv * (b * b);
        let bend = in_plane(&j, curvature - own)?;
        Some(Along { w: [u, v], rate, bend })
    }
}

/// The unknowns between two nodes, linearly.
fn guess(places: &[Unknowns; NODES], near: usize, x: f64) -> Unknowns {
    let other = if x > node(near) && near + 1 < NODES || near == 0 { near + 1 } else { near - 1 };
    let share = (x - node(near)) / (node(other) - node(near));
    std::array::from_fn(|k| places[near][k] + share * (places[other][k] - places[near][k]))
}

impl<T: Real> Curve<T> for Cut<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        super::on_surface_jet(&self.first, self.place(t, order), order)
    }

    /// Place by place, as single ones; what places of one piece share is made once.
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        let first = PlainSurface(&*self.first);
        let second = self.second.plain();
        let crossing = Crossing::local(&first, second.other(), self.size);
        for (out, &t) in out.iter_mut().zip(ts) {
            let (piece, x) = self.share(T::from(t));
            let [w, ..] = self.place_near(&crossing, piece, x, Order::Zero);
            *out = self.first.jet(w.x, w.y, Order::Zero).p;
        }
    }

    /// Those of the surfaces that it crosses are ends of pieces.
    fn breaks(&self) -> Vec<f64> {
        let share = |p: &Piece<T>| p.begin.re() / self.total.re();
        self.pieces[1..].iter().map(share).collect()
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.place(t, order))
    }
}
