//! The curve of an intersection: pieces near it, and the position of each point on both shapes.

use super::equations::PlainField;
use moldloft_locate::PlainSurface;
use moldloft_locate::implicit::{Implicit, refined, solve};
use moldloft_locate::march::{Crossing, Other, Unknowns};
use moldloft_num::trace::Trace;
use moldloft_num::{
    Curve, CurveJet, Jet, Order, Plane, Real, SurfJet, Vec3, slope_scale, solve_dense,
};
use moldloft_registry::{FieldRef, SurfaceRef};
use std::sync::Arc;

/// The second shape of a cut.
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

    pub fn surface(&self) -> Option<&SurfaceRef<T>> {
        match self {
            Second::Surface(surface) => Some(surface),
            Second::Plane(_) | Second::Field(_) => None,
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

/// Number of points interpolated by the polynomial of a piece.
pub(super) const NODES: usize = 8;

/// Powers of the length along a piece.
pub(super) const RUN: usize = NODES + 1;

/// A part of the intersection with a cubic near it, both with a parameter y from -1 to 1: the point
/// is the intersection with the normal plane of the cubic. The length up to it is a polynomial to
/// rounding, so that neither it nor its derivatives depend on the ends of pieces.
#[derive(Clone, Debug)]
pub(super) struct CutPiece<T> {
    /// Length along the snake at which it begins, and its own length.
    pub begin: T,
    pub length: T,
    /// The cubic, in powers of y.
    pub guide: Guide,
    /// The length from y = -1, in powers of y.
    pub run: [T; RUN],
    /// The unknowns in powers of y, nearly: where iterations begin.
    pub places: [Unknowns; NODES],
    /// True if these are the unknowns to rounding, so that no iteration is needed.
    pub exact: bool,
    /// The edges or joints of their surface between which each unknown is.
    pub within: [[f64; 2]; 4],
    /// True where the intersection may bend at its beginning: at a joint or a seam of a surface.
    pub joint: bool,
}

/// Rounding of a parameter at an edge or a joint of a surface.
const EDGE_ROUNDING: f64 = 1e-12;

/// A cubic in powers of y.
pub(super) type Guide = [Vec3; 4];

/// Position, first and second derivative of a cubic.
pub(super) fn on_guide([a, b, c, d]: &Guide, y: f64) -> [Vec3; 3] {
    [
        *a + (*b + (*c + *d * y) * y) * y,
        *b + (*c * 2.0 + *d * (3.0 * y)) * y,
        *c * 2.0 + *d * (6.0 * y),
    ]
}

pub(super) fn polynomial<S: Real>(powers: &[S], y: f64) -> [S; 2] {
    let (mut value, mut slope) = (S::zero(), S::zero());
    for p in powers.iter().rev() {
        slope = slope * y + value;
        value = value * y + *p;
    }
    [value, slope]
}

pub(super) fn guess(places: &[Unknowns; NODES], y: f64) -> Unknowns {
    let mut q = places[NODES - 1];
    for p in places[..NODES - 1].iter().rev() {
        q = std::array::from_fn(|k| q[k] * y + p[k]);
    }
    q
}

impl<T: Real> CutPiece<T> {
    /// Position in the piece at the length `run` from its start.
    pub fn at_length(&self, run: T) -> T {
        let plain = self.run.map(|x| x.re());
        let goal = run.re();
        let mut y = 2.0 * goal / self.length.re() - 1.0;
        for _ in 0..12 {
            let [value, slope] = polynomial(&plain, y);
            let step = (value - goal) / slope;
            if !step.is_finite() || step.abs() > 0.5 {
                break;
            }
            y -= step;
            if step.abs() < 1e-9 {
                break;
            }
        }
        let ([value, _], [_, slope]) = (polynomial(&self.run, y), polynomial(&plain, y));
        let rest = value - run;
        T::from(y) - (rest - rest.re()) / slope
    }

    /// The unknowns with those that rounding has moved across an edge or a joint of their surface back on their side: beyond
    /// it there may be the other side of a sharp seam or knuckle.
    fn on_its_side(&self, unknowns: [T; 4]) -> [T; 4] {
        std::array::from_fn(|k| {
            let x = unknowns[k];
            let [low, high] = self.within[k];
            let beyond = x.re() - x.re().clamp(low, high);
            let crossed = beyond.abs() < EDGE_ROUNDING;
            if crossed { x - beyond } else { x }
        })
    }
}

/// The common curve of two shapes, by the fraction of its length.
pub(super) struct Cut<T: Real> {
    pub both: Both<T>,
    pub pieces: Vec<CutPiece<T>>,
    pub total: T,
    pub size: f64,
    pub closed: bool,
    /// The unknown that is 0 or 1 at each end on an edge of a surface.
    pub on_edges: [Option<(usize, f64)>; 2],
}

/// The surface and the second shape of a cut.
#[derive(Clone)]
pub(super) struct Both<T: Real> {
    pub first: SurfaceRef<T>,
    pub second: Second<T>,
}

/// Both shapes at a point of the cut: position, unit tangent, derivatives with respect to the
/// length.
pub(super) struct CutJet<T> {
    pub x: Vec3<T>,
    pub tangent: Vec3<T>,
    /// First derivatives of u and v of one of the surfaces.
    rate: [T; 2],
    /// Second derivatives of u and v, and of the position.
    bend: [T; 2],
    pub curvature: Vec3<T>,
}

/// Nodes on [-1, 1] inside: a surface may continue differently beyond the ends (Chebyshev 1854).
pub(super) fn node(k: usize) -> f64 {
    -Real::cos((k as f64 + 0.5) * std::f64::consts::PI / NODES as f64)
}

/// The matrix from values at the nodes to powers of y.
pub(super) fn to_powers() -> [[f64; NODES]; NODES] {
    std::array::from_fn(|column| {
        let mut matrix: Vec<f64> =
            (0..NODES).flat_map(|k| (0..NODES).map(move |p| node(k).powi(p as i32))).collect();
        let mut unit: [f64; NODES] = std::array::from_fn(|k| f64::from(u8::from(k == column)));
        solve_dense(&mut matrix, &mut unit).expect("the nodes are different");
        unit
    })
}

pub(super) fn powers_of<T: Real>(
    matrix: &[[f64; NODES]; NODES],
    values: &[T; NODES],
) -> [T; NODES] {
    let power = |p: usize| (0..NODES).fold(T::zero(), |sum, k| sum + values[k] * matrix[k][p]);
    std::array::from_fn(power)
}

/// A point of both shapes across from a cubic's.
struct Across<'a, T: Real> {
    first: &'a SurfaceRef<T>,
    guide: &'a Guide,
}

impl<T: Real> Across<'_, T> {
    fn level<J: Jet<T>>(&self, point: Vec3<J>, y: J) -> J {
        let [a, b, c, d] = self.guide.map(Vec3::<J>::lifted);
        let at = a + (b + (c + d * y) * y) * y;
        let slope = b + (c * J::from(2.0) + d * (y * 3.0)) * y;
        slope.dot(point - at)
    }
    fn gradient(&self, j: &moldloft_num::SurfJet<T>, y: T) -> [T; 2] {
        let d = Vec3::<T>::lifted(on_guide(self.guide, y.re())[1]);
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

impl<T: Real> Both<T> {
    /// For each unknown the edges or joints of its surface on both sides of a place; at a joint above, the last number below.
    pub fn bounds_at(&self, place: &Unknowns) -> [[f64; 2]; 4] {
        let second = self.second.surface().map_or([Vec::new(), Vec::new()], |s| s.joints());
        let [us, vs] = self.first.joints();
        let [ps, rs] = second;
        let mut joints = [us, vs, ps, rs].into_iter();
        place.map(|x| {
            let joints = joints.next().unwrap_or_default();
            if !(0.0..=1.0).contains(&x) {
                return [f64::NEG_INFINITY, f64::INFINITY];
            }
            let low = joints.iter().filter(|j| **j <= x).fold(0.0, |a: f64, j| a.max(*j));
            let above = joints.into_iter().filter(|j| *j > x && *j < 1.0).reduce(f64::min);
            [low, above.map_or(1.0, f64::next_down)]
        })
    }

    /// All unknowns at `y` of a piece, from the real ones `q`, with derivatives with respect to the
    /// model's parameters.
    pub fn unknowns(&self, guide: &Guide, q: Unknowns, y: T) -> Option<[T; 4]> {
        if T::PARTS == 1 {
            return Some(q.map(T::from));
        }
        let across = Across { first: &self.first, guide };
        match &self.second {
            Second::Plane(plane) => {
                let [u, v] = refined(&AcrossPlane(across, plane), [q[0], q[1]], y)?;
                Some([u, v, T::zero(), T::zero()])
            }
            Second::Field(field) => {
                let [u, v] = refined(&AcrossField(across, field), [q[0], q[1]], y)?;
                Some([u, v, T::zero(), T::zero()])
            }
            Second::Surface(surface) => refined(&AcrossSurface(across, surface), q, y),
        }
    }

    /// Derivatives with respect to the length at a point, in the direction of `d`: with N = n1 x n2
    /// for normals that are not unit vectors, T = N / |N| and T' = (N' - T (T . N')) / |N|.
    pub fn along(&self, q: [T; 4], d: Vec3, order: Order) -> Option<CutJet<T>> {
        self.along_on(0, q, d, order)
    }

    /// The derivatives of [`Self::along`], with those of the parameters of the first (0) or the
    /// second surface (1).
    fn along_on(
        &self,
        side: usize,
        [u, v, p, r]: [T; 4],
        d: Vec3,
        order: Order,
    ) -> Option<CutJet<T>> {
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
        let own = if side == 0 { &j } else { k.as_ref()? };
        let rate = in_plane(own, tangent)?;
        let mut found =
            CutJet { x: j.p, tangent, rate, bend: [T::zero(); 2], curvature: Vec3::zero() };
        if order != Order::Second {
            return Some(found);
        }
        // Change of the normal S_u x S_v along the tangent.
        let turn = |s: &SurfJet<T>, [a, b]: [T; 2]| {
            (s.uu * a + s.uv * b).cross(s.v) + s.u.cross(s.uv * a + s.vv * b)
        };
        let dm = turn(&j, in_plane(&j, tangent)?);
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
        found.curvature = (change - tangent * tangent.dot(change)) / length;
        let [a, b] = rate;
        let turns = own.uu * (a * a) + own.uv * (a * b * 2.0) + own.vv * (b * b);
        found.bend = in_plane(own, found.curvature - turns)?;
        Some(found)
    }
}

impl<T: Real> Cut<T> {
    /// The piece at the fraction `t` of the length, and the length into it.
    fn share(&self, t: T) -> (&CutPiece<T>, T) {
        let s = self.total * t;
        let k = self.pieces.partition_point(|p| p.begin.re() <= s.re()).saturating_sub(1);
        let piece = &self.pieces[k];
        (piece, s - piece.begin)
    }

    /// (u, v, 0) on the first (0) or the second surface (1), with derivatives by t.
    ///
    /// The parameter is the fraction of the length, so derivatives are those with respect to
    /// length, from the normals of both shapes: they do not depend on the ends of pieces.
    fn place(&self, side: usize, crossing: &Crossing<'_>, t: T, order: Order) -> CurveJet<T> {
        let (piece, run) = self.share(t);
        let y = piece.at_length(run);
        let [c, d, _] = on_guide(&piece.guide, y.re());
        let guess = guess(&piece.places, y.re());
        let solved = || crossing.across_close(guess, c, d / d.norm());
        let q = if piece.exact { guess } else { solved().unwrap_or(guess) };
        let flat = |[u, v]: [T; 2], by: T| Vec3::new(u * by, v * by, T::zero());
        let pair = |q: [T; 4]| flat([q[2 * side], q[2 * side + 1]], T::one());
        let plain_jet = [pair(q.map(T::from)), Vec3::zero(), Vec3::zero()];
        let Some(all) = self.both.unknowns(&piece.guide, q, y) else { return plain_jet };
        let mut all = piece.on_its_side(all);
        let end = [0.0, 1.0].iter().position(|end| t.re() == *end);
        if let Some((k, value)) = end.and_then(|end| self.on_edges[end]) {
            all[k] = T::from(value);
        }
        let w = pair(all);
        if order == Order::Zero {
            return [w, Vec3::zero(), Vec3::zero()];
        }
        let Some(along) = self.both.along_on(side, all, d, order) else { return plain_jet };
        let rate = self.total;
        [w, flat(along.rate, rate), flat(along.bend, rate * rate)]
    }

    /// Evaluates with the crossing of both shapes.
    fn crossed<R>(&self, evaluate: impl FnOnce(&Crossing<'_>) -> R) -> R {
        let first = PlainSurface(&*self.both.first);
        let second = self.both.second.plain();
        evaluate(&Crossing::local(&first, second.other(), self.size))
    }
}

/// A cut on one of its surfaces.
#[derive(Clone)]
pub(super) struct CutView<T: Real> {
    pub cut: Arc<Cut<T>>,
    /// 0 for the first surface of the cut, 1 for the second.
    pub side: usize,
    /// True in the opposite direction.
    pub backwards: bool,
    pub trace: Trace<T>,
    /// False for a curve in space, whose surface is not known.
    pub snake: bool,
}

impl<T: Real> CutView<T> {
    /// Its surface; the first one if the second shape is not a surface.
    pub fn surface(&self) -> &SurfaceRef<T> {
        let second = self.cut.both.second.surface().filter(|_| self.side == 1);
        second.unwrap_or(&self.cut.both.first)
    }

    fn place(&self, crossing: &Crossing<'_>, t: T, order: Order) -> CurveJet<T> {
        if !self.backwards {
            return self.cut.place(self.side, crossing, t, order);
        }
        let [w, d, dd] = self.cut.place(self.side, crossing, -t + 1.0, order);
        [w, -d, dd]
    }
}

impl<T: Real> Curve<T> for CutView<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let place = self.cut.crossed(|crossing| self.place(crossing, t, order));
        super::on_surface::on_surface_jet(self.surface(), place, order)
    }

    /// Point by point, independently.
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.cut.crossed(|crossing| {
            for (out, &t) in out.iter_mut().zip(ts) {
                let [w, ..] = self.place(crossing, T::from(t), Order::Zero);
                *out = self.surface().jet(w.x, w.y, Order::Zero).p;
            }
        });
    }

    /// Crossings of joints and seams of the surfaces.
    fn breaks(&self) -> Vec<f64> {
        let total = self.cut.total.re();
        let joints = self.cut.pieces[1..].iter().filter(|p| p.joint);
        let breaks = joints.map(|p| p.begin.re() / total);
        if self.backwards { breaks.rev().map(|t| 1.0 - t).collect() } else { breaks.collect() }
    }

    fn closed(&self) -> bool {
        self.cut.closed
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        self.snake.then(|| self.cut.crossed(|crossing| self.place(crossing, t, order)))
    }

    moldloft_num::curve_facts!(broken, not_rational);
}
