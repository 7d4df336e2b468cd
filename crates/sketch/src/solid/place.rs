//! Bodies moved, turned, mirrored and scaled.

use super::SketchSolid;
use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use moldloft_num::{Axis as Line, Real, Vec3};

/// A similarity: rotation, mirror image, scale and shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity<T> {
    /// The images of the unit vectors.
    pub columns: [Vec3<T>; 3],
    /// The image of the origin.
    pub shift: Vec3<T>,
}

impl<T: Real> Similarity<T> {
    /// No change.
    pub fn identity() -> Self {
        let unit = [0, 1, 2].map(|k| {
            let mut e = [T::zero(); 3];
            e[k] = T::one();
            Vec3::from(e)
        });
        Similarity { columns: unit, shift: Vec3::zero() }
    }

    /// Moved by a vector.
    pub fn moved(by: Vec3<T>) -> Self {
        Similarity { shift: by, ..Self::identity() }
    }

    /// Rotation about an axis through a point, right-handed, by an angle in radians.
    pub fn turned(axis: usize, through: Vec3<T>, angle: T) -> Self {
        let mut direction = [T::zero(); 3];
        direction[axis] = T::one();
        let line = Line { point: Vec3::zero(), direction: Vec3::from(direction) };
        let columns = Self::identity().columns.map(|e| line.rotated(e, angle));
        let linear = Similarity { columns, shift: Vec3::zero() };
        Similarity { shift: through - linear.vector(through), ..linear }
    }

    /// Reflection in the plane with coordinate `at` on an axis.
    pub fn mirrored(axis: usize, at: T) -> Self {
        let mut image = Self::identity();
        image.columns[axis] = -image.columns[axis];
        let mut shift = [T::zero(); 3];
        shift[axis] = at * 2.0;
        Similarity { shift: Vec3::from(shift), ..image }
    }

    /// Scaled about the origin.
    pub fn scaled(factor: T) -> Self {
        let columns = Self::identity().columns.map(|e| e * factor);
        Similarity { columns, shift: Vec3::zero() }
    }

    /// First this, then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let columns = self.columns.map(|c| next.vector(c));
        Similarity { columns, shift: next.point(self.shift) }
    }

    /// The image of a vector.
    pub fn vector(&self, v: Vec3<T>) -> Vec3<T> {
        self.columns[0] * v.x + self.columns[1] * v.y + self.columns[2] * v.z
    }

    /// The image of a point.
    pub fn point(&self, p: Vec3<T>) -> Vec3<T> {
        self.vector(p) + self.shift
    }

    /// The point whose image a point is.
    pub(super) fn source_of(&self, p: Vec3) -> Vec3 {
        let off = p - self.shift.re();
        let along = self.columns.map(|c| c.re().dot(off) / c.re().norm_sq());
        Vec3::new(along[0], along[1], along[2])
    }

    /// True if it changes the handedness.
    pub fn mirrors(&self) -> bool {
        let [a, b, c] = self.columns;
        a.cross(b).dot(c).re() < 0.0
    }

    fn piece(&self, piece: &SmoothPiece<T>) -> SmoothPiece<T> {
        match *piece {
            SmoothPiece::Conic { centre, a, b, sweep } => SmoothPiece::Conic {
                centre: self.point(centre),
                a: self.vector(a),
                b: self.vector(b),
                sweep,
            },
            SmoothPiece::Cubic(points) => SmoothPiece::Cubic(points.map(|p| self.point(p))),
        }
    }

    fn surface(&self, surface: &FaceSurface<T>) -> FaceSurface<T> {
        match *surface {
            FaceSurface::Plane { at, normal } => FaceSurface::Plane {
                at: self.point(at),
                normal: self.vector(normal).normalized().unwrap_or(normal),
            },
            FaceSurface::Ruled { near, far } => {
                FaceSurface::Ruled { near: self.piece(&near), far: self.piece(&far) }
            }
            FaceSurface::Turned { centre, axis, profile, sweep } => {
                // A mirror turns the sense of rotations.
                let image = self.vector(axis).normalized().unwrap_or(axis);
                let axis = if self.mirrors() { -image } else { image };
                let (centre, profile) = (self.point(centre), self.piece(&profile));
                FaceSurface::Turned { centre, axis, profile, sweep }
            }
        }
    }
}

impl<T: Real> SketchSolid<T> {
    /// The image of the body.
    #[must_use]
    pub fn placed(&self, place: &Similarity<T>) -> SketchSolid<T> {
        let mut out = self.clone();
        out.curves.clear();
        let forward = |p: Vec3| place.point(Vec3::lifted(p)).re();
        out.density = out.density.mapped(&forward);
        out.vertices.iter_mut().for_each(|v| v.at = place.point(v.at));
        for edge in &mut out.edges {
            edge.piece = edge.piece.as_ref().map(|p| place.piece(p));
            if let Some(trace) = &mut edge.trace {
                trace.points.iter_mut().for_each(|p| *p = place.point(*p));
                trace.nodes.iter_mut().for_each(|n| *n = (place.point(n.0), place.vector(n.1)));
                trace.carrier = trace.carrier.as_ref().map(|p| place.piece(p));
            }
        }
        for edge in &mut out.edges {
            edge.own_ends = edge.own_ends.map(|ends| ends.map(|p| place.point(p)));
        }
        for [at, normal] in out.planes.values_mut() {
            *at = place.point(*at);
            *normal = place.vector(*normal).normalized().unwrap_or(*normal);
        }
        out.kinks.iter_mut().for_each(|k| k.at = forward(k.at));
        let scale = place.columns[0].norm();
        for stray in &mut out.strays {
            stray.corners = stray.corners.map(forward);
            stray.ahead = stray.ahead.map(|x| x * scale);
        }
        out.trims.iter_mut().for_each(|t| t.surface = place.surface(&t.surface));
        if let Some(facets) = &mut out.facets {
            facets.points.iter_mut().for_each(|p| *p = place.point(*p));
            facets.flat.iter_mut().for_each(|p| *p = forward(*p));
            for part in facets.parts.iter_mut().flatten() {
                let image = place.vector(Vec3::lifted(part.normal)).re();
                part.normal = image.normalized().unwrap_or(part.normal);
            }
        }
        if place.mirrors() {
            out.turn_over();
        }
        out
    }
}
