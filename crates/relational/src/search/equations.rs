//! The equations that searches solve, for derivatives by the implicit function theorem.

use moldloft_locate::implicit::Implicit;
use moldloft_num::{
    Box3, CurveJet, Field, Jet, Order, Plane, Real, SurfJet, Vec3, lift_surface, slope_scale,
};
use moldloft_registry::{CurveRef, FieldRef, SurfaceRef};

/// A level of a function of space.
#[derive(Clone, Debug)]
pub enum LevelOf<T: Real> {
    /// A plane.
    Plane(Plane<T>),
    /// The points at a distance from a centre.
    Sphere {
        /// The centre.
        centre: Vec3<T>,
        /// The distance.
        radius: T,
    },
    /// The zero set of an implicit function.
    Field(FieldRef<T>),
}

/// An implicit function in plain numbers.
pub struct PlainField<'a, T: Real>(pub &'a FieldRef<T>);

impl<T: Real> Field<f64> for PlainField<'_, T> {
    fn value_and_gradient(&self, p: Vec3) -> (f64, Vec3) {
        let (value, gradient) = self.0.value_and_gradient(Vec3::lifted(p));
        (value.re(), gradient.re())
    }
    fn value(&self, p: Vec3) -> f64 {
        self.0.value(Vec3::lifted(p)).re()
    }

    fn second_order(&self, p: Vec3) -> (f64, Vec3, [Vec3; 3]) {
        let (value, gradient, second) = self.0.second_order(Vec3::lifted(p));
        (value.re(), gradient.re(), second.map(|row| row.re()))
    }
    fn bounds(&self, over: &Box3) -> Option<[f64; 2]> {
        self.0.bounds(over)
    }
}

impl<T: Real> LevelOf<T> {
    /// The level in plain numbers; `field` holds a plain field.
    pub fn plain<'a>(&self, field: &'a Option<PlainField<'a, T>>) -> moldloft_locate::Level<'a> {
        match self {
            LevelOf::Field(_) => match field {
                Some(field) => moldloft_locate::Level::Field(field),
                None => unreachable!("a field has its plain twin"),
            },
            LevelOf::Plane(plane) => {
                let normal = plane.normal.re();
                moldloft_locate::Level::Plane { normal, offset: normal.dot(plane.point.re()) }
            }
            LevelOf::Sphere { centre, radius } => {
                moldloft_locate::Level::Sphere { centre: centre.re(), radius: radius.re() }
            }
        }
    }

    /// The field behind [`LevelOf::plain`].
    pub fn plain_field(&self) -> Option<PlainField<'_, T>> {
        match self {
            LevelOf::Field(field) => Some(PlainField(field)),
            _ => None,
        }
    }

    fn value<J: Jet<T>>(&self, x: Vec3<J>) -> J {
        let fixed = |v: Vec3<T>| v.map(J::fixed);
        match self {
            LevelOf::Plane(plane) => fixed(plane.normal).dot(x - fixed(plane.point)),
            LevelOf::Sphere { centre, radius } => {
                let r = J::fixed(*radius);
                ((x - fixed(*centre)).norm_sq() - r * r) / (r * 2.0)
            }
            LevelOf::Field(field) => field.at(x),
        }
    }

    fn gradient(&self, x: Vec3<T>) -> Vec3<T> {
        match self {
            LevelOf::Plane(plane) => plane.normal,
            LevelOf::Sphere { centre, radius } => (x - *centre) / *radius,
            LevelOf::Field(field) => {
                let g = field.value_and_gradient(x).1;
                g * T::from(slope_scale(g.re()))
            }
        }
    }
}

/// g(C(t)) = 0.
pub struct OnLevel<'a, T: Real> {
    pub curve: &'a CurveRef<T>,
    pub level: LevelOf<T>,
}

impl<T: Real> Implicit<T, 1> for OnLevel<'_, T> {
    fn at<J: Jet<T>>(&self, [t]: [J; 1], _: J) -> [J; 1] {
        [self.level.value(self.curve.at(t))]
    }
    fn jacobian(&self, [t]: [T; 1], _: T) -> [[T; 1]; 1] {
        let [x, d, _] = self.curve.jet(t, Order::First);
        [[self.level.gradient(x).dot(d)]]
    }
}

fn columns<T: Real, const N: usize>(all: [Vec3<T>; N]) -> [[T; N]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|k| all[k].to_array()[row]))
}

/// C(t) = S(u, v).
pub struct Pierced<'a, T: Real> {
    pub curve: &'a CurveRef<T>,
    pub surface: &'a SurfaceRef<T>,
}

impl<T: Real> Implicit<T, 3> for Pierced<'_, T> {
    fn at<J: Jet<T>>(&self, [t, u, v]: [J; 3], _: J) -> [J; 3] {
        (self.curve.at(t) - self.surface.at(u, v)).to_array()
    }
    fn jacobian(&self, [t, u, v]: [T; 3], _: T) -> [[T; 3]; 3] {
        let d = self.curve.jet(t, Order::First)[1];
        let s = self.surface.jet(u, v, Order::First);
        columns([d, -s.u, -s.v])
    }
}

/// The derivative of a curve at a parameter that is a jet, to first order.
fn slope<T: Real, J: Jet<T>>(jet: &CurveJet<T>, t: J) -> Vec3<J> {
    let dt = t - J::fixed(t.value());
    jet[1].map(J::fixed) + jet[2].map(|a| dt.scaled(a))
}

/// The distance of two curves is stationary.
pub struct Between<'a, T: Real> {
    pub a: &'a CurveRef<T>,
    pub b: &'a CurveRef<T>,
}

impl<T: Real> Implicit<T, 2> for Between<'_, T> {
    fn at<J: Jet<T>>(&self, [t, s]: [J; 2], _: J) -> [J; 2] {
        let a = self.a.jet(t.value(), Order::Second);
        let b = self.b.jet(s.value(), Order::Second);
        let r = self.a.at(t) - self.b.at(s);
        [slope(&a, t).dot(r), -slope(&b, s).dot(r)]
    }
    fn jacobian(&self, [t, s]: [T; 2], _: T) -> [[T; 2]; 2] {
        let (a, b) = (self.a.jet(t, Order::Second), self.b.jet(s, Order::Second));
        let r = a[0] - b[0];
        let cross = -a[1].dot(b[1]);
        [[a[1].norm_sq() + a[2].dot(r), cross], [cross, b[1].norm_sq() - b[2].dot(r)]]
    }
}

/// A point that may move along a curve.
#[derive(Clone, Debug)]
pub enum Moving<T: Real> {
    /// It stays.
    Fixed(Vec3<T>),
    /// It moves along a curve.
    Curve(CurveRef<T>),
}

impl<T: Real> Moving<T> {
    /// Position at `t`.
    pub fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        match self {
            Moving::Fixed(p) => p.map(J::fixed),
            Moving::Curve(curve) => curve.at(t),
        }
    }
}

/// C'(t) . (C(t) - P) = 0.
pub struct FootOnCurve<'a, T: Real> {
    pub curve: &'a CurveRef<T>,
    pub point: Vec3<T>,
}

impl<T: Real> Implicit<T, 1> for FootOnCurve<'_, T> {
    fn at<J: Jet<T>>(&self, [t]: [J; 1], _: J) -> [J; 1] {
        let jet = self.curve.jet(t.value(), Order::Second);
        [slope(&jet, t).dot(self.curve.at(t) - self.point.map(J::fixed))]
    }
    fn jacobian(&self, [t]: [T; 1], _: T) -> [[T; 1]; 1] {
        let [x, d, dd] = self.curve.jet(t, Order::Second);
        [[d.norm_sq() + dd.dot(x - self.point)]]
    }
}

/// S_u . (S - P) = 0 and S_v . (S - P) = 0, to the first order; an unknown that is held at an edge or a joint stays there.
pub struct FootOnSurface<'a, T: Real> {
    pub surface: &'a SurfaceRef<T>,
    pub point: &'a Moving<T>,
    pub held: [Option<T>; 2],
}

impl<T: Real> Implicit<T, 2> for FootOnSurface<'_, T> {
    fn at<J: Jet<T>>(&self, [u, v]: [J; 2], t: J) -> [J; 2] {
        let s = self.surface.jet(u.value(), v.value(), Order::Second);
        let away = lift_surface(&s, u, v) - self.point.at(t);
        // The tangents as surfaces of their own, to the first order, as far as derivatives are known.
        let along = [
            SurfJet { p: s.u, u: s.uu, v: s.uv, ..SurfJet::default() },
            SurfJet { p: s.v, u: s.uv, v: s.vv, ..SurfJet::default() },
        ];
        let value = |k: usize, q: J| {
            if let Some(place) = self.held[k] {
                return q - J::fixed(place);
            }
            lift_surface(&along[k], u, v).dot(away)
        };
        [value(0, u), value(1, v)]
    }
    fn jacobian(&self, [u, v]: [T; 2], t: T) -> [[T; 2]; 2] {
        let s = self.surface.jet(u, v, Order::Second);
        let r = s.p - self.point.at(t);
        let cross = s.u.dot(s.v) + s.uv.dot(r);
        let mut rows = [[s.u.norm_sq() + s.uu.dot(r), cross], [cross, s.v.norm_sq() + s.vv.dot(r)]];
        for k in 0..2 {
            if self.held[k].is_some() {
                rows[k] = [T::zero(); 2];
                rows[k][k] = T::one();
            }
        }
        rows
    }
}

/// Along which lines points are projected onto a surface.
#[derive(Clone, Copy, Debug)]
pub enum Rays<T: Real> {
    /// Parallel to a direction.
    Along(Vec3<T>),
    /// Away from a point.
    From(Vec3<T>),
}

/// S(u, v) = P + s d, with the unknowns u, v, s.
pub struct OnRay<'a, T: Real> {
    pub surface: &'a SurfaceRef<T>,
    pub point: &'a Moving<T>,
    pub rays: Rays<T>,
}

impl<T: Real> OnRay<'_, T> {
    /// Start and direction of the ray.
    pub fn ray<J: Jet<T>>(&self, t: J) -> [Vec3<J>; 2] {
        let p = self.point.at(t);
        let d = match self.rays {
            Rays::Along(d) => d.map(J::fixed),
            Rays::From(c) => p - c.map(J::fixed),
        };
        [p, d]
    }
}

impl<T: Real> Implicit<T, 3> for OnRay<'_, T> {
    fn at<J: Jet<T>>(&self, [u, v, s]: [J; 3], t: J) -> [J; 3] {
        let [p, d] = self.ray(t);
        (self.surface.at(u, v) - p - d * s).to_array()
    }
    fn jacobian(&self, [u, v, _]: [T; 3], t: T) -> [[T; 3]; 3] {
        let j = self.surface.jet(u, v, Order::First);
        let [_, d] = self.ray::<T>(t);
        columns([j.u, j.v, -d])
    }
}
