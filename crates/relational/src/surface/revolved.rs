//! Surfaces of revolution.

use super::masters::{along, is_closed};
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Axis, Jet, Order, Pace, Rational, Real, SurfaceFormula, Vec3, Weight};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A curve rotated about a line: S(u, v) is C(u) rotated by a1 + v (a2 - a1), right-handed about
/// the direction from the line's start to its end (Rodrigues).
///
/// An end of the curve on the line gives a pole. A full turn closes the surface.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "relabel curve line a1 a2",
    example = "AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(-1, 0, 0.1); \
               AbsPoint B(0, 1.5, 0.2); AbsPoint C(2, 0.5, 0); BCurve c({A, B, C}); \
               RevSurf S(c, axis, 0.25, 2.5);"
)]
pub struct RevSurf<T: Real> {
    /// Generating curve.
    curve: CurveRef<T>,
    /// Axis of rotation.
    line: Axis<T>,
    /// Angle at v = 0, in radians (degrees in model files).
    #[field(default = 0, angle)]
    a1: T,
    /// Angle at v = 1, in radians (degrees in model files).
    #[field(default = TAU, angle)]
    a2: T,
}

impl<T: Real> Build<T> for RevSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, line, a1, a2 } = self;
        let sweep = a2 - a1;
        // Degrees come through a product, so a full turn is one to rounding.
        let full = (sweep.re().abs() - TAU).abs() <= 8.0 * f64::EPSILON;
        let on_axis = [0.0, 1.0].map(|t| {
            let p = curve.jet(T::from(t), Order::Zero)[0].re();
            let foot = line.foot(Vec3::lifted(p)).re();
            let size = p.norm().max(line.point.re().norm());
            p.distance(foot) <= 4.0 * f64::EPSILON * size
        });
        let shape = Revolved { curve, axis: line, a1, sweep, full, on_axis };
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting)))
    }
}

struct Revolved<T: Real> {
    curve: CurveRef<T>,
    axis: Axis<T>,
    a1: T,
    sweep: T,
    full: bool,
    /// True for each end of the curve on the axis.
    on_axis: [bool; 2],
}

/// Cosine and sine, exact at multiples of a right angle.
pub fn cos_sin<J: Real>(angle: J) -> (J, J) {
    let quarters = (angle.re() / FRAC_PI_2).round();
    let rest = angle - quarters * FRAC_PI_2;
    let (c, s) = (rest.cos(), rest.sin());
    match quarters.rem_euclid(4.0) as u8 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

impl<T: Real> SurfaceFormula for Revolved<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let (c, s) = cos_sin(v.scaled(self.sweep) + J::fixed(self.a1));
        let fixed = |v: Vec3<T>| v.map(J::fixed);
        let axis = Axis { point: fixed(self.axis.point), direction: fixed(self.axis.direction) };
        axis.turned(self.curve.at(u), c, s)
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.curve.breaks(), Vec::new()]
    }

    /// The circle of an end of the curve, and the rotated curve itself.
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        match k {
            0 | 2 => self.curve.made_of(),
            _ => self.curve.end_points()[usize::from(k == 1)].into_iter().collect(),
        }
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        [self.curve.joints(), Vec::new()]
    }

    fn rational(&self) -> Rational<2> {
        let Rational { paces: [pace], weight } = self.curve.rational();
        let weight = weight.map(|w| Box::new(move |[u, _]: [f64; 2]| w([u])) as Weight<2>);
        Rational { paces: [pace, Pace::Angle(self.sweep.re())], weight }
    }

    /// Edge v = 0 follows the curve if the first angle is 0; after a full turn edge v = 1 is edge v
    /// = 0.
    fn edges(&self) -> Edges<T> {
        let mut edges = Edges::own();
        let ends = self.curve.end_points();
        if self.a1.re() == 0.0 {
            edges = edges.with(0, along(&self.curve));
            edges.corners[..2].copy_from_slice(&ends);
        }
        if self.full {
            edges = edges.with(2, Edge::SameAs(0));
            (edges.corners[3], edges.corners[2]) = (edges.corners[0], edges.corners[1]);
        }
        if is_closed(ends) {
            edges = edges.with(1, Edge::SameAs(3));
        }
        for (end, k) in [(0, 3), (1, 1)] {
            if self.on_axis[end] {
                edges = edges.with(k, Edge::Pole(ends[end]));
            }
        }
        edges
    }

    moldloft_num::surface_facts!(kinks_at_breaks, breaks_along_lines, open);
}
