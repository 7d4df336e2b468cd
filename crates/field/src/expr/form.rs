//! The shapes that primitives remember to be, and their constructors.

use crate::error::{finite, positive, unit};
use crate::expr::oracle::Affine;
use crate::{FieldError, Primitive};
use moldloft_num::{Axis, Plane, Real, Vec3};

/// Constructor of a primitive, with its dimensions; they follow rotations, translations and uniform
/// scaling.
#[derive(Clone, Debug, PartialEq)]
pub enum Form<T> {
    /// A constant.
    Real(T),
    /// A half-space.
    Plane(Plane<T>),
    /// A ball.
    Sphere {
        /// Centre.
        centre: Vec3<T>,
        /// Radius.
        radius: T,
    },
    /// An infinite cylinder.
    Cylinder {
        /// Axis.
        axis: Axis<T>,
        /// Radius.
        radius: T,
    },
    /// A double cone.
    Cone {
        /// Axis; its point is the apex.
        axis: Axis<T>,
        /// Full angle at the apex.
        angle: T,
    },
    /// A torus.
    Torus {
        /// Axis; its point is the centre.
        axis: Axis<T>,
        /// Radius of the circle of centres.
        major: T,
        /// Radius of the tube.
        minor: T,
    },
    /// A Dupin cyclide; see [`Primitive::cyclide`].
    Cyclide {
        /// Axis; its point is the centre.
        axis: Axis<T>,
        /// Unit vector to the thin side.
        along: Vec3<T>,
        /// Radius of the ring.
        major: T,
        /// Mean radius of the tube.
        minor: T,
        /// Change of the tube's radius.
        change: T,
    },
    /// An expression.
    General,
}

impl<T: Real> Form<T> {
    /// The name of the form, as in the language.
    pub fn name(&self) -> &'static str {
        match self {
            Form::Real(_) => "real",
            Form::Plane(_) => "plane",
            Form::Sphere { .. } => "sphere",
            Form::Cylinder { .. } => "cylinder",
            Form::Cone { .. } => "cone",
            Form::Torus { .. } => "torus",
            Form::Cyclide { .. } => "cyclide",
            Form::General => "field",
        }
    }

    /// Applies a map of numbers, of points and of directions.
    fn mapped<S: Real>(
        &self,
        number: impl Fn(T) -> S,
        length: impl Fn(T) -> S,
        point: impl Fn(Vec3<T>) -> Vec3<S>,
        direction: impl Fn(Vec3<T>) -> Vec3<S>,
    ) -> Form<S> {
        let axis = |a: &Axis<T>| Axis { point: point(a.point), direction: direction(a.direction) };
        match self {
            Form::Real(c) => Form::Real(number(*c)),
            Form::Plane(p) => {
                Form::Plane(Plane { point: point(p.point), normal: direction(p.normal) })
            }
            Form::Sphere { centre, radius } => {
                Form::Sphere { centre: point(*centre), radius: length(*radius) }
            }
            Form::Cylinder { axis: a, radius } => {
                Form::Cylinder { axis: axis(a), radius: length(*radius) }
            }
            Form::Cone { axis: a, angle } => Form::Cone { axis: axis(a), angle: number(*angle) },
            Form::Torus { axis: a, major, minor } => {
                Form::Torus { axis: axis(a), major: length(*major), minor: length(*minor) }
            }
            Form::Cyclide { axis: a, along, major, minor, change } => Form::Cyclide {
                axis: axis(a),
                along: direction(*along),
                major: length(*major),
                minor: length(*minor),
                change: length(*change),
            },
            Form::General => Form::General,
        }
    }

    pub(crate) fn re(&self) -> Form<f64> {
        let vector = |v: Vec3<T>| v.re();
        self.mapped(|c| c.re(), |c| c.re(), vector, vector)
    }

    /// The form among numbers with derivatives.
    pub(crate) fn constant<S: Real>(&self) -> Form<S> {
        let vector = |v: Vec3<T>| Vec3::lifted(v.re());
        self.mapped(|c| S::from(c.re()), |c| S::from(c.re()), vector, vector)
    }

    /// The form after a map that multiplies all lengths by `scale`.
    pub(crate) fn moved(&self, world_from: &Affine<T>, scale: T) -> Self {
        let direction = |v: Vec3<T>| world_from.linear(v) / scale;
        self.mapped(|c| c, |c| c * scale, |p| world_from.apply(p), direction)
    }
}

/// Distances from two planes through the axis, and along it from the axis's point.
fn cylindrical<T: Real>(
    axis: &Axis<T>,
    along: Option<Vec3<T>>,
) -> Result<[Primitive<T>; 3], FieldError> {
    let h = unit("axis", axis.direction)?;
    let point = finite("point of the axis", axis.point)?;
    let p = match along {
        Some(v) => unit("direction of symmetry", v - h * h.dot(v))?,
        None => h.perpendicular(),
    };
    let q = h.cross(p);
    Ok([p, q, h].map(|n| Primitive::linear(n, -n.dot(point))))
}

impl<T: Real> Primitive<T> {
    /// The ball |X - centre|^2 - r^2.
    ///
    /// # Errors
    /// A radius that is not above zero; numbers that are not finite.
    pub fn sphere(centre: Vec3<T>, radius: T) -> Result<Self, FieldError> {
        let centre = finite("centre", centre)?;
        let radius = positive("radius", radius)?;
        let [x, y, z] = Affine::identity().rows.map(|n| Self::linear(n, -n.dot(centre)));
        let f = x.power(2) + y.power(2) + z.power(2) - radius * radius;
        Ok(f.remembered(Form::Sphere { centre, radius }))
    }

    /// The ball as a true distance, |X - centre| - r.
    ///
    /// # Errors
    /// As [`Primitive::sphere`].
    pub fn sphere_distance(centre: Vec3<T>, radius: T) -> Result<Self, FieldError> {
        let form = Self::sphere(centre, radius)?.form().clone();
        let [x, y, z] = Affine::identity().rows.map(|n| Self::linear(n, -n.dot(centre)));
        let f = (x.power(2) + y.power(2) + z.power(2)).sqrt() - radius;
        Ok(f.remembered(form))
    }

    /// The infinite cylinder p^2 + q^2 - r^2.
    ///
    /// # Errors
    /// A radius that is not above zero, an axis without direction, numbers that are not finite.
    pub fn cylinder(axis: Axis<T>, radius: T) -> Result<Self, FieldError> {
        let radius = positive("radius", radius)?;
        let [p, q, _] = cylindrical(&axis, None)?;
        let f = p.power(2) + q.power(2) - radius * radius;
        Ok(f.remembered(Form::Cylinder { axis, radius }))
    }

    /// The infinite cylinder as a true distance, sqrt(p^2 + q^2) - r.
    ///
    /// # Errors
    /// As [`Primitive::cylinder`].
    pub fn cylinder_distance(axis: Axis<T>, radius: T) -> Result<Self, FieldError> {
        let radius = positive("radius", radius)?;
        let [p, q, _] = cylindrical(&axis, None)?;
        let f = (p.power(2) + q.power(2)).sqrt() - radius;
        Ok(f.remembered(Form::Cylinder { axis, radius }))
    }

    /// The double cone p^2 + q^2 - (h tan(a/2))^2 with its apex at the axis's point; `angle` is the
    /// full angle a, below pi. For one nappe, intersect with a half-space through the apex.
    ///
    /// # Errors
    /// An angle outside (0, pi), an axis without direction, numbers that are not finite.
    pub fn cone(axis: Axis<T>, angle: T) -> Result<Self, FieldError> {
        let angle = positive("angle", angle)?;
        positive("angle's supplement", -angle + std::f64::consts::PI)?;
        let [p, q, h] = cylindrical(&axis, None)?;
        let f = p.power(2) + q.power(2) - (h * (angle * 0.5).tan()).power(2);
        Ok(f.remembered(Form::Cone { axis, angle }))
    }

    /// The torus h^2 + (sqrt(p^2 + q^2) - R)^2 - r^2 about the axis's point.
    ///
    /// # Errors
    /// Radii that are not above zero, an axis without direction, numbers that are not finite.
    pub fn torus(axis: Axis<T>, major: T, minor: T) -> Result<Self, FieldError> {
        let (major, minor) = (positive("major radius", major)?, positive("minor radius", minor)?);
        let [p, q, h] = cylindrical(&axis, None)?;
        let ring = (p.power(2) + q.power(2)).sqrt() - major;
        let f = h.power(2) + ring.power(2) - minor * minor;
        Ok(f.remembered(Form::Torus { axis, major, minor }))
    }

    /// The torus as a true distance, sqrt(h^2 + (sqrt(p^2 + q^2) - R)^2) - r.
    ///
    /// # Errors
    /// As [`Primitive::torus`].
    pub fn torus_distance(axis: Axis<T>, major: T, minor: T) -> Result<Self, FieldError> {
        let (major, minor) = (positive("major radius", major)?, positive("minor radius", minor)?);
        let [p, q, h] = cylindrical(&axis, None)?;
        let ring = (p.power(2) + q.power(2)).sqrt() - major;
        let f = (h.power(2) + ring.power(2)).sqrt() - minor;
        Ok(f.remembered(Form::Torus { axis, major, minor }))
    }

    /// The double cone as a true distance, sqrt(p^2 + q^2) cos(a/2) - |h| sin(a/2).
    ///
    /// # Errors
    /// As [`Primitive::cone`].
    pub fn cone_distance(axis: Axis<T>, angle: T) -> Result<Self, FieldError> {
        let form = Self::cone(axis, angle)?.form().clone();
        let [p, q, h] = cylindrical(&axis, None)?;
        let half = angle * 0.5;
        let f = (p.power(2) + q.power(2)).sqrt() * half.cos() - h.abs() * half.sin();
        Ok(f.remembered(form))
    }

    /// The Dupin cyclide (p^2 + q^2 + h^2 + b^2 - m^2)^2 = (2 a p - 2 c m)^2 + 4 b^2 q^2 with
    /// b^2 = a^2 - c^2 (Forsyth 1912; Chandru, Dutta, Hoffmann 1989, eq. 2).
    ///
    /// It meets the line from the centre along `along` at a - c - ... : its tube has the radius m - c
    /// there, about the distance a, and m + c about the same distance on the other side. A ring
    /// without singular points needs c < m < a. `change` = 0 is the torus, as a quartic.
    ///
    /// # Errors
    /// Radii that are not above zero, |c| >= a, directions that are degenerate.
    pub fn cyclide(
        axis: Axis<T>,
        along: Vec3<T>,
        major: T,
        minor: T,
        change: T,
    ) -> Result<Self, FieldError> {
        let (a, m) = (positive("major radius", major)?, positive("minor radius", minor)?);
        let c = change;
        let b_sq = positive("major radius squared less the change squared", a * a - c * c)?;
        let [p, q, h] = cylindrical(&axis, Some(along))?;
        let sum = p.power(2) + q.power(2) + h.power(2) + (b_sq - m * m);
        let line = p.clone() * (a * 2.0) - c * m * 2.0;
        let f = sum.power(2) - line.power(2) - q.power(2) * (b_sq * 4.0);
        let direction = unit("axis", axis.direction)?;
        let along = unit("direction of symmetry", along - direction * direction.dot(along))?;
        let axis = Axis { point: axis.point, direction };
        Ok(f.remembered(Form::Cyclide { axis, along, major, minor, change }))
    }
}
