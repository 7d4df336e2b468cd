//! The traits of curves, surfaces and implicit fields: evaluation, derivatives with respect to the
//! shape parameters (jets), breaks and evaluation on grids. `grid` gives the same as `jet` point by
//! point.

use crate::jet::{Jet, lift_curve, lift_surface};
use crate::reparametrization::Reparametrization;
use crate::trace::{Edges, Key, Trace};
use crate::{Rational, Real, Vec3, find_root};
use std::sync::Arc;

/// Order of derivatives with respect to the shape parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Position only.
    Zero,
    /// Position and first derivatives.
    First,
    /// Position, first and second derivatives.
    Second,
}

/// Position, first and second derivative of a curve; entries above the requested order are zero.
pub type CurveJet<T> = [Vec3<T>; 3];

/// Position and derivatives of a surface; entries above the requested order are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfJet<T> {
    /// Position.
    pub p: Vec3<T>,
    /// Derivative by u.
    pub u: Vec3<T>,
    /// Derivative by v.
    pub v: Vec3<T>,
    /// Second derivative by u.
    pub uu: Vec3<T>,
    /// Mixed second derivative.
    pub uv: Vec3<T>,
    /// Second derivative by v.
    pub vv: Vec3<T>,
}

impl<T: Real> SurfJet<T> {
    /// The unit normal along S_u x S_v; zero if the surface is singular.
    pub fn normal(&self) -> Vec3<T> {
        self.u.cross(self.v).normalized().unwrap_or_default()
    }
}

/// A curve C(t) for t in [0, 1]; outside this range its formula continues.
///
/// Methods that affect speed and correctness have no default: each curve states them, a curve
/// derived from another one forwards or changes them. [`curve_facts!`](crate::curve_facts) and
/// [`curve_one_by_one!`](crate::curve_one_by_one) are the usual statements.
pub trait Curve<T: Real>: Send + Sync {
    /// Position and derivatives by t at `t`, to `order`.
    fn jet(&self, t: T, order: Order) -> CurveJet<T>;

    /// Positions at many parameters. `out` has the length of `ts`.
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]);

    /// Interior parameters at which a derivative up to the second may jump, ascending.
    fn breaks(&self) -> Vec<f64>;

    /// Interior parameters at which one formula ends and another begins, ascending: the breaks, and
    /// those at which only higher derivatives jump. Between them a spline is a polynomial.
    fn joints(&self) -> Vec<f64>;

    /// Interior parameters at which the first derivative may jump, ascending; the breaks, where nothing less
    /// is known.
    fn kinks(&self) -> Vec<f64>;

    /// Rational form of the curve, if known.
    fn rational(&self) -> Rational<1>;

    /// The curve to which this one is parallel, sideways in the plane of that normal, and the
    /// distance: a parallel of a parallel is one of the first curve, so no derivative is lost.
    fn parallel_to(&self) -> Option<(&dyn Curve<T>, Vec3<T>, T)> {
        None
    }

    /// True if the curve is closed: it is then periodic, and `jet` beyond 0 .. 1 gives the value
    /// reduced by whole turns. Objects of a model determine that themselves; see [`crate::period`].
    fn closed(&self) -> bool;

    /// The root of the curve, for joins: itself, or a part of other curves.
    fn trace(&self) -> Trace<T> {
        Trace::own()
    }

    /// The curve object whose image this is, point by point at equal parameters, under a map of
    /// space. For joins: coincident images of one curve are one.
    fn image_of(&self) -> Option<Key> {
        None
    }

    /// The curve in the parameter plane of its surface: (u(t), v(t), 0), for snakes.
    fn on_surface(&self, _t: T, _order: Order) -> Option<CurveJet<T>> {
        None
    }

    /// The law by which its natural parameter was redistributed; `None` when it was not. Images of
    /// curves pass on their original's.
    fn law(&self) -> Option<Arc<dyn Reparametrization<T>>> {
        None
    }
}

/// A surface S(u, v) for u, v in [0, 1]; its natural normal is S_u x S_v.
///
/// As for [`Curve`], each surface states the methods that affect speed and correctness:
/// [`surface_facts!`](crate::surface_facts), [`surface_one_by_one!`](crate::surface_one_by_one).
pub trait Surface<T: Real>: Send + Sync {
    /// Position and derivatives at (`u`, `v`), to `order`.
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T>;

    /// Positions, and unit normals if requested, on the tensor grid `us` x `vs`, in the order `[i *
    /// vs.len() + j]`. Normals are zero at singular points.
    fn grid(&self, us: &[f64], vs: &[f64], points: &mut [Vec3<T>], normals: Option<&mut [Vec3<T>]>);

    /// The results of [`Surface::jet`] along the line at one `u`, at each of `vs`: for surfaces
    /// with much work at a `u` that does not depend on v.
    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>>;

    /// Positions at many parameter pairs in any order. `out` has the length of `uv`.
    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]);

    /// Interior parameters u and v at which a derivative up to the second may jump, ascending.
    fn breaks(&self) -> [Vec<f64>; 2];

    /// Interior parameters u and v at which one formula ends and another begins; see
    /// [`Curve::joints`].
    fn joints(&self) -> [Vec<f64>; 2];

    /// Interior parameters u and v at which a first derivative may jump; see [`Curve::kinks`].
    fn kinks(&self) -> [Vec<f64>; 2];

    /// The parameters in (0, 1), in any order, at which a path (u, v) in the parameter plane meets a
    /// line on which a derivative up to the second may jump. `spans` are the ascending ends of the
    /// stretches, from 0 to 1, on which the path itself is smooth.
    ///
    /// A surface that is made from another one's parameter plane hands the path on.
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64>;

    /// Rational form of the surface, if known.
    fn rational(&self) -> Rational<2>;

    /// For u and v, true if closed, since the two sides of the surface are one line; see
    /// [`Curve::closed`].
    fn closed(&self) -> [bool; 2];

    /// The surface to which this one is parallel, along the natural normal, and the distance: a
    /// parallel of a parallel is one of the first surface, so no derivative is lost.
    fn parallel_to(&self) -> Option<(&dyn Surface<T>, T)> {
        None
    }

    /// The parameter planes of the surfaces of which this one is a part: their lines cross it at
    /// any angle.
    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        Vec::new()
    }

    /// Positions between joints that are at other v from u to u: at each of `us`, in each piece
    /// between two joints, at each of `shares` of its width, in the order `[u][piece][share]`.
    /// Derivatives are those of points that move with the joints.
    ///
    /// `None` for a surface with joints on lines v = const alone.
    fn between_joints(&self, _us: &[f64], _shares: &[f64]) -> Option<Vec<Vec3<T>>> {
        None
    }

    /// The roots of the four edges, for joins: v = 0, u = 1, v = 1, u = 0, each in the direction of
    /// increasing parameter.
    fn edges(&self) -> Edges<T> {
        Edges::own()
    }

    /// The objects, or parts of objects, that alone determine the shape of an edge of the surface's
    /// own (0..4): the points on a loft's line across its masters, the point that is rotated to a
    /// circle, the curve that is moved. Empty if there are none. For joins: coincident edges with
    /// the same origin are one.
    fn edge_made_of(&self, _k: usize) -> Vec<Key> {
        Vec::new()
    }

    /// The surface object whose image this is, point by point at equal parameters, under a map of
    /// space; and whether the map reverses the natural normal. For joins: images of joined surfaces
    /// under one map are joined, and so are points that are their own images.
    fn image_of(&self) -> Option<(Key, bool)> {
        None
    }

    /// The solid object whose face 0..6 this is, at equal parameters. For joins of blocks.
    fn face_of(&self) -> Option<(Key, u8)> {
        None
    }
}

/// The parameter plane of a surface that contains another one as a part.
pub struct InnerPlane<'a> {
    /// The point of the plane for a point (u, v) of the part.
    pub place: Box<dyn Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'a>,
    /// The lines of the plane between different formulas; see [`Surface::joints`].
    pub joints: [Vec<f64>; 2],
    /// The lines of the plane at which a first derivative may jump; see [`Surface::kinks`].
    pub kinks: [Vec<f64>; 2],
    /// For each parameter, true if closed, so that the lines are repeated in each period.
    pub closed: [bool; 2],
}

impl<'a> InnerPlane<'a> {
    /// The plane seen through a map of parameters.
    pub fn through(self, map: impl Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'a) -> Self {
        let place = self.place;
        Self { place: Box::new(move |w| place(map(w))), ..self }
    }
}

/// Number of steps in which a smooth part of a path is searched for crossings.
const STEPS: usize = 8;

/// The parameters in (0, 1) at which a path crosses the lines u = const and v = const; see
/// [`Surface::crossings`].
pub fn line_crossings(
    lines: &[Vec<f64>; 2],
    path: &dyn Fn(f64) -> [f64; 2],
    spans: &[f64],
) -> Vec<f64> {
    let mut found = Vec::new();
    if lines.iter().all(Vec::is_empty) {
        return found;
    }
    for span in spans.windows(2) {
        let step = (span[1] - span[0]) / STEPS as f64;
        for k in 0..STEPS {
            let (a, b) = (span[0] + k as f64 * step, span[0] + (k + 1) as f64 * step);
            for (axis, lines) in lines.iter().enumerate() {
                for &line in lines {
                    let across = |t: f64| path(t)[axis] - line;
                    // A path that stays on the line crosses nowhere.
                    if across(a) == 0.0 && across(b) == 0.0 {
                        continue;
                    }
                    found.extend(find_root(across, a, b).ok());
                }
            }
        }
    }
    found.retain(|t| *t > 0.0 && *t < 1.0);
    found
}

/// An implicit function f(x, y, z): negative inside, zero on the surface, positive outside.
pub trait Field<T: Real>: Send + Sync {
    /// The value and the gradient at `p`.
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>);

    /// The value at `p`.
    fn value(&self, p: Vec3<T>) -> T;

    /// Value, gradient and rows of second derivatives at `p`; [`field_differences`] where the function does not know them.
    fn second_order(&self, p: Vec3<T>) -> (T, Vec3<T>, [Vec3<T>; 3]);

    /// Bounds of the real values over a box, where they are known.
    fn bounds(&self, over: &crate::Box3) -> Option<[f64; 2]>;
}

/// Step of differences of a gradient, relative to the distance from the origin, or to 1 nearby.
const GRADIENT_STEP: f64 = 1e-5;

/// [`Field::second_order`] by differences of the gradient, to about ten digits.
pub fn field_differences<T: Real>(
    field: &(impl Field<T> + ?Sized),
    p: Vec3<T>,
) -> (T, Vec3<T>, [Vec3<T>; 3]) {
    let (value, gradient) = field.value_and_gradient(p);
    let h = GRADIENT_STEP * (1.0 + p.re().norm());
    let along = |k: usize| {
        let mut step = [0.0; 3];
        step[k] = h;
        let step = Vec3::lifted(step.into());
        let (high, low) =
            (field.value_and_gradient(p + step).1, field.value_and_gradient(p - step).1);
        (high - low) / T::from(2.0 * h)
    };
    (value, gradient, [along(0), along(1), along(2)])
}

impl<T: Real> dyn Field<T> + '_ {
    /// The value at a point that is a jet, divided by the size of the gradient there: a length.
    pub fn at<J: Jet<T>>(&self, p: Vec3<J>) -> J {
        let here = p.map(J::value);
        let (value, gradient, second) = match J::ORDER {
            Order::Second => self.second_order(here),
            _ => {
                let (value, gradient) = self.value_and_gradient(here);
                (value, gradient, [Vec3::zero(); 3])
            }
        };
        let d = p - here.map(J::fixed);
        let mut sum = J::fixed(value);
        for k in 0..3 {
            sum += d[k].scaled(gradient[k]);
            if J::ORDER == Order::Second {
                for i in 0..3 {
                    sum += (d[k] * d[i]).scaled(second[k][i] * 0.5);
                }
            }
        }
        sum * slope_scale(gradient.re())
    }
}

/// Factor that converts a value with this gradient to a length.
pub fn slope_scale(gradient: Vec3) -> f64 {
    let size = gradient.norm();
    if size > 0.0 && size.is_finite() { 1.0 / size } else { 1.0 }
}

impl<T: Real> dyn Curve<T> + '_ {
    /// The position at a parameter that is a jet of the caller's own parameters.
    #[inline(always)]
    pub fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        lift_curve(&self.jet(t.value(), J::ORDER), t)
    }
}

impl<T: Real> dyn Surface<T> + '_ {
    /// The position at parameters that are jets of the caller's own parameters.
    #[inline(always)]
    pub fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        lift_surface(&self.jet(u.value(), v.value(), J::ORDER), u, v)
    }
}

/// A curve given by a formula that is generic over jets: all its derivatives follow from it.
///
/// The scalar is an associated type so that a generic type of another crate may implement
/// [`Curve`] itself, with its own jets and grid, instead.
pub trait CurveFormula: Send + Sync {
    /// The scalar of the curve.
    type Scalar: Real;

    /// The position at `t`.
    fn at<J: Jet<Self::Scalar>>(&self, t: J) -> Vec3<J>;

    /// See [`Curve::breaks`].
    fn breaks(&self) -> Vec<f64>;

    /// See [`Curve::joints`].
    fn joints(&self) -> Vec<f64>;

    /// See [`Curve::kinks`].
    fn kinks(&self) -> Vec<f64>;

    /// See [`Curve::closed`].
    fn closed(&self) -> bool;

    /// See [`Curve::rational`].
    fn rational(&self) -> Rational<1>;

    /// See [`Curve::parallel_to`].
    fn parallel_to(&self) -> Option<(&dyn Curve<Self::Scalar>, Vec3<Self::Scalar>, Self::Scalar)> {
        None
    }

    /// See [`Curve::trace`].
    fn trace(&self) -> Trace<Self::Scalar> {
        Trace::own()
    }

    /// See [`Curve::image_of`].
    fn image_of(&self) -> Option<Key> {
        None
    }
}

impl<F: CurveFormula> Curve<F::Scalar> for F {
    fn jet(&self, t: F::Scalar, order: Order) -> CurveJet<F::Scalar> {
        crate::curve_jet_of!(self, F::at, t, order)
    }
    crate::curve_one_by_one!(F::Scalar);
    fn breaks(&self) -> Vec<f64> {
        CurveFormula::breaks(self)
    }
    fn joints(&self) -> Vec<f64> {
        CurveFormula::joints(self)
    }
    fn kinks(&self) -> Vec<f64> {
        CurveFormula::kinks(self)
    }
    fn closed(&self) -> bool {
        CurveFormula::closed(self)
    }
    fn parallel_to(&self) -> Option<(&dyn Curve<F::Scalar>, Vec3<F::Scalar>, F::Scalar)> {
        CurveFormula::parallel_to(self)
    }
    fn trace(&self) -> Trace<F::Scalar> {
        CurveFormula::trace(self)
    }
    fn image_of(&self) -> Option<Key> {
        CurveFormula::image_of(self)
    }

    fn rational(&self) -> Rational<1> {
        CurveFormula::rational(self)
    }
}

/// A surface given by a formula that is generic over jets; see [`CurveFormula`].
pub trait SurfaceFormula: Send + Sync {
    /// The scalar of the surface.
    type Scalar: Real;

    /// The position at (`u`, `v`).
    fn at<J: Jet<Self::Scalar>>(&self, u: J, v: J) -> Vec3<J>;

    /// See [`Surface::breaks`].
    fn breaks(&self) -> [Vec<f64>; 2];

    /// See [`Surface::joints`].
    fn joints(&self) -> [Vec<f64>; 2];

    /// See [`Surface::kinks`].
    fn kinks(&self) -> [Vec<f64>; 2];

    /// See [`Surface::crossings`].
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64>;

    /// See [`Surface::closed`].
    fn closed(&self) -> [bool; 2];

    /// See [`Surface::rational`].
    fn rational(&self) -> Rational<2>;

    /// See [`Surface::inner_planes`].
    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        Vec::new()
    }

    /// See [`Surface::edges`].
    fn edges(&self) -> Edges<Self::Scalar> {
        Edges::own()
    }

    /// See [`Surface::edge_made_of`].
    fn edge_made_of(&self, _k: usize) -> Vec<Key> {
        Vec::new()
    }

    /// See [`Surface::parallel_to`].
    fn parallel_to(&self) -> Option<(&dyn Surface<Self::Scalar>, Self::Scalar)> {
        None
    }

    /// See [`Surface::image_of`].
    fn image_of(&self) -> Option<(Key, bool)> {
        None
    }
}

impl<F: SurfaceFormula> Surface<F::Scalar> for F {
    fn jet(&self, u: F::Scalar, v: F::Scalar, order: Order) -> SurfJet<F::Scalar> {
        crate::surface_jet_of!(self, F::at, u, v, order)
    }
    crate::surface_one_by_one!(F::Scalar: grid, line, scattered);
    fn breaks(&self) -> [Vec<f64>; 2] {
        SurfaceFormula::breaks(self)
    }
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        SurfaceFormula::crossings(self, path, spans)
    }
    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        SurfaceFormula::inner_planes(self)
    }
    fn edges(&self) -> Edges<F::Scalar> {
        SurfaceFormula::edges(self)
    }
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        SurfaceFormula::edge_made_of(self, k)
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        SurfaceFormula::joints(self)
    }
    fn kinks(&self) -> [Vec<f64>; 2] {
        SurfaceFormula::kinks(self)
    }
    fn closed(&self) -> [bool; 2] {
        SurfaceFormula::closed(self)
    }
    fn parallel_to(&self) -> Option<(&dyn Surface<F::Scalar>, F::Scalar)> {
        SurfaceFormula::parallel_to(self)
    }
    fn image_of(&self) -> Option<(Key, bool)> {
        SurfaceFormula::image_of(self)
    }
    fn rational(&self) -> Rational<2> {
        SurfaceFormula::rational(self)
    }
}
