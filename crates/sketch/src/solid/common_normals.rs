//! The lengths of all common normals of two surfaces, in closed form.
//!
//! A cylinder, sphere or torus is everything at one distance from its spine: a line, point or circle. A common normal of
//! two such surfaces is one of their spines, longer or shorter by these distances.

use super::revolved::{Meridian, RevolvedSurface};
use super::surface::FaceSurface;
use moldloft_num::{Axis, Real, Vec3};

/// Tolerance of parallel directions, and of one axis relative to the bodies.
const ONE: f64 = 1e-11;

/// Angle from which directions are not parallel to a search.
const TURNED: f64 = 1e-5;

/// What a surface is about, and at which distance.
#[derive(Clone, Copy)]
pub(super) struct SurfaceAbout {
    spine: Spine,
    radius: f64,
}

#[derive(Clone, Copy)]
enum Spine {
    Plane {
        at: Vec3,
        normal: Vec3,
    },
    Point(Vec3),
    Line(Axis<f64>),
    Circle(Axis<f64>, f64),
    /// A cone about an axis: the radius at its point, and the slope.
    Cone(Axis<f64>, f64, f64),
}

impl SurfaceAbout {
    /// A plane, cylinder, cone, sphere or torus.
    pub(super) fn of<T: Real>(surface: &FaceSurface<T>) -> Option<SurfaceAbout> {
        if let FaceSurface::Plane { at, normal } = surface {
            let spine = Spine::Plane { at: at.re(), normal: normal.re() };
            return Some(SurfaceAbout { spine, radius: 0.0 });
        }
        let RevolvedSurface { axis, meridian } = RevolvedSurface::of(surface)?;
        let axis = Axis { point: axis.point.re(), direction: axis.direction.re() };
        let (spine, radius) = match meridian.re() {
            Meridian::Line { radius, slope: 0.0 } => (Spine::Line(axis), radius),
            Meridian::Line { radius, slope } => (Spine::Cone(axis, radius, slope), 0.0),
            Meridian::Circle { big: 0.0, small } => (Spine::Point(axis.point), small),
            Meridian::Circle { big, small } => (Spine::Circle(axis, big), small),
        };
        Some(SurfaceAbout { spine, radius })
    }

    /// The lengths of the common normals with another surface; `None` where they are not known.
    pub(super) fn common_normals(&self, other: &SurfaceAbout, scale: f64) -> Option<Vec<f64>> {
        let spines = self.spine.apart(&other.spine, scale);
        let spines = spines.or_else(|| other.spine.apart(&self.spine, scale))?;
        let (r, s) = (self.radius, other.radius);
        let ways = [r + s, r - s, s - r, -r - s];
        Some(spines.into_iter().flat_map(|d| ways.map(|way| (d + way).abs())).collect())
    }
}

impl Spine {
    /// The distances of two spines along common normals, in one order of their kinds.
    fn apart(&self, other: &Spine, scale: f64) -> Option<Vec<f64>> {
        let sine = |a: &Axis<f64>, b: &Axis<f64>| a.direction.cross(b.direction).norm();
        let off = |axis: &Axis<f64>, p: Vec3| p.distance(axis.foot(p));
        let high = |axis: &Axis<f64>, p: Vec3| axis.direction.dot(p - axis.point);
        let coaxial =
            |a: &Axis<f64>, b: &Axis<f64>| sine(a, b) <= ONE && off(a, b.point) <= ONE * scale;
        // Distances in a half-plane through the axis from a point to a circle and its other half.
        let both = |high: f64, out: f64, big: f64| {
            vec![libm::hypot(high, out - big), libm::hypot(high, out + big)]
        };
        let to_cone = |high: f64, out: f64, radius: f64, slope: f64| {
            let (wide, long) = (radius + slope * high, libm::hypot(1.0, slope));
            vec![(out - wide).abs() / long, (out + wide).abs() / long]
        };
        match (self, other) {
            (Spine::Point(p), Spine::Point(q)) => Some(vec![p.distance(*q)]),
            (Spine::Point(p), Spine::Plane { at, normal }) => {
                Some(vec![normal.dot(*p - *at).abs()])
            }
            (Spine::Point(p), Spine::Line(axis)) => Some(vec![off(axis, *p)]),
            (Spine::Point(p), Spine::Circle(axis, big)) => {
                Some(both(high(axis, *p), off(axis, *p), *big))
            }
            (Spine::Point(p), Spine::Cone(axis, radius, slope)) => {
                Some(to_cone(high(axis, *p), off(axis, *p), *radius, *slope))
            }
            (Spine::Line(axis), Spine::Plane { at, normal }) => {
                let along = normal.dot(axis.direction).abs();
                match along {
                    _ if along <= ONE => Some(vec![normal.dot(axis.point - *at).abs()]),
                    _ => (along > TURNED).then(Vec::new),
                }
            }
            (Spine::Line(a), Spine::Line(b)) => {
                let across = a.direction.cross(b.direction);
                match across.norm() {
                    sine if sine <= ONE => Some(vec![off(a, b.point)]),
                    sine if sine > TURNED => Some(vec![across.dot(b.point - a.point).abs() / sine]),
                    _ => None,
                }
            }
            (Spine::Line(line), Spine::Circle(axis, big)) => {
                (sine(line, axis) <= ONE).then(|| both(0.0, off(line, axis.point), *big))
            }
            (Spine::Circle(axis, big), Spine::Plane { at, normal }) => {
                let (level, lean) =
                    (normal.dot(axis.point - *at), normal.cross(axis.direction).norm());
                Some(vec![(level + big * lean).abs(), (level - big * lean).abs()])
            }
            (Spine::Circle(a, big), Spine::Circle(b, other)) => {
                coaxial(a, b).then(|| both(high(a, b.point), *other, *big))
            }
            (Spine::Cone(axis, _, slope), Spine::Plane { normal, .. }) => {
                let own = slope.abs() / libm::hypot(1.0, *slope);
                let along = normal.dot(axis.direction).abs();
                ((own - along).abs() > TURNED).then(Vec::new)
            }
            (Spine::Cone(a, _, slope), Spine::Line(b)) => {
                (coaxial(a, b) && slope.abs() > TURNED).then(Vec::new)
            }
            (Spine::Cone(a, _, slope), Spine::Cone(b, _, other)) => {
                let apart = (slope - other).abs().min((slope + other).abs());
                (coaxial(a, b) && apart > TURNED).then(Vec::new)
            }
            (Spine::Cone(a, radius, slope), Spine::Circle(b, big)) => {
                coaxial(a, b).then(|| to_cone(high(a, b.point), *big, *radius, *slope))
            }
            _ => None,
        }
    }
}
