//! Images of surfaces, point by point, under maps of space.

use crate::snake::{PathOnSurface, on_surface};
use moldloft_num::trace::Key;
use moldloft_num::{Axis, Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, Kind, MirrorArgument, Point, SurfacePart, SurfaceRef,
    Value,
};

/// An affine map of p to `to` + A (p - `from`).
#[derive(Clone)]
enum AffineTransform<T: Real> {
    /// A turn about an axis, with the cosine and sine of its angle.
    Turn(Axis<T>, T, T),
    /// A shift and a stretch along the three axes.
    Stretch { from: Vec3<T>, to: Vec3<T>, factors: Vec3<T> },
    /// A reflection in a plane, line or point.
    Reflection(MirrorArgument<T>),
}

impl<T: Real> AffineTransform<T> {
    fn point(&self, p: Vec3<T>) -> Vec3<T> {
        match self {
            AffineTransform::Turn(axis, c, s) => axis.turned(p, *c, *s),
            AffineTransform::Stretch { from, to, .. } => *to + self.direction(p - *from),
            AffineTransform::Reflection(mirror) => mirror.image(p),
        }
    }

    fn direction(&self, d: Vec3<T>) -> Vec3<T> {
        match self {
            AffineTransform::Turn(axis, c, s) => {
                Axis { point: Vec3::zero(), direction: axis.direction }.turned(d, *c, *s)
            }
            AffineTransform::Stretch { factors: f, .. } => {
                Vec3::new(d.x * f.x, d.y * f.y, d.z * f.z)
            }
            AffineTransform::Reflection(mirror) => mirror.direction(d, false),
        }
    }

    fn jet(&self, jet: SurfJet<T>) -> SurfJet<T> {
        let turned = |d| self.direction(d);
        SurfJet {
            p: self.point(jet.p),
            u: turned(jet.u),
            v: turned(jet.v),
            uu: turned(jet.uu),
            uv: turned(jet.uv),
            vv: turned(jet.vv),
        }
    }

    /// The image of a unit normal: A n x A m = det(A) A^-T (n x m).
    fn normal(&self, n: Vec3<T>) -> Vec3<T> {
        match self {
            AffineTransform::Turn(..) => self.direction(n),
            AffineTransform::Stretch { factors: f, .. } => {
                let m = Vec3::new(n.x * f.y * f.z, n.y * f.z * f.x, n.z * f.x * f.y);
                m.normalized().unwrap_or_default()
            }
            AffineTransform::Reflection(mirror) => {
                let turned = mirror.direction(n, false);
                if mirror.reverses() { -turned } else { turned }
            }
        }
    }

    /// True when the map turns the natural normal round.
    fn reverses(&self) -> bool {
        match self {
            AffineTransform::Turn(..) => false,
            AffineTransform::Stretch { factors: f, .. } => f.x.re() * f.y.re() * f.z.re() < 0.0,
            AffineTransform::Reflection(mirror) => mirror.reverses(),
        }
    }
}

struct Image<T: Real> {
    surface: SurfaceRef<T>,
    map: AffineTransform<T>,
}

impl<T: Real> Surface<T> for Image<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        self.map.jet(self.surface.jet(u, v, order))
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        self.surface.grid(us, vs, points, normals.as_deref_mut());
        for p in points {
            *p = self.map.point(*p);
        }
        for n in normals.into_iter().flatten() {
            *n = self.map.normal(*n);
        }
    }
    fn image_of(&self) -> Option<(Key, bool)> {
        Some((self.surface.key?, self.map.reverses()))
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        self.surface.line(u, vs, order).into_iter().map(|jet| self.map.jet(jet)).collect()
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        self.surface.scattered(uv, out);
        for p in out {
            *p = self.map.point(*p);
        }
    }

    fn between_joints(&self, us: &[f64], shares: &[f64]) -> Option<Vec<Vec3<T>>> {
        let mut points = self.surface.between_joints(us, shares)?;
        points.iter_mut().for_each(|p| *p = self.map.point(*p));
        Some(points)
    }

    moldloft_num::surface_facts!(breaks of [self.surface], closed of [self.surface], rational of [self.surface]);
}

/// The image of a surface: that of a part is a part of the image of the whole surface.
fn image<T: Real>(surface: SurfaceRef<T>, map: AffineTransform<T>, nesting: u32) -> Value<T> {
    let part = surface.part_of.as_ref().map(|part| {
        let whole = Image { surface: part.surface.clone(), map: map.clone() };
        let whole = SurfaceRef::new(whole, nesting);
        let moved = |side: &Option<CurveRef<T>>| {
            side.clone().map(|curve| on_surface(&whole, PathOnSurface { curve }))
        };
        let sides = part.sides.each_ref().map(moved);
        SurfacePart { surface: whole, sides }
    });
    Value::Surface(SurfaceRef::new(Image { surface, map }, nesting).with_part_of(part))
}

/// The mirror image of a surface in a plane, line or point, point by point.
///
/// A plane or point reverses the natural normal; panels keep the orientation of the original.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface mirror",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               MirrSurf port(S, \"y=0\");"
)]
pub struct MirrSurf<T: Real> {
    /// The surface to mirror.
    surface: SurfaceRef<T>,
    /// The mirror: a plane, line or point.
    mirror: MirrorArgument<T>,
}

impl<T: Real> Build<T> for MirrSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        Ok(image(self.surface, AffineTransform::Reflection(self.mirror), context.nesting))
    }
}

/// A surface rotated about a line, right-handed about the direction from the line's start to its
/// end (Rodrigues). Images of joined surfaces under the same rotation are joined.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface line angle",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0.2); Line axis(O, X); \
               RotatSurf blade(S, axis, 1.25);"
)]
pub struct RotatSurf<T: Real> {
    /// The surface to turn.
    surface: SurfaceRef<T>,
    /// Axis of rotation.
    line: Axis<T>,
    /// The angle, in radians (degrees in model files).
    #[field(angle)]
    angle: T,
}

impl<T: Real> Build<T> for RotatSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let (c, s) = super::revolved::cos_sin(self.angle);
        Ok(image(self.surface, AffineTransform::Turn(self.line, c, s), context.nesting))
    }
}

/// A copy of a surface, translated and scaled along the axes: p maps to `to` + diag(sx, sy, sz) (p
/// - `from`).
///
/// A negative product of the three factors reverses the natural normal; panels keep the orientation
/// of the original.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface from to sx sy sz",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsPoint P(1, 8, 0.5); CopySurf beside(S, A, P); CopySurf small(S, A, P, 0.5, -0.25, 0.4);"
)]
pub struct CopySurf<T: Real> {
    /// The surface to copy.
    surface: SurfaceRef<T>,
    /// The point that is moved to `to`.
    from: Point<T>,
    /// Its image.
    to: Point<T>,
    /// Stretch along x.
    #[field(default = 1)]
    sx: T,
    /// Stretch along y.
    #[field(default = 1)]
    sy: T,
    /// Stretch along z.
    #[field(default = 1)]
    sz: T,
}

impl<T: Real> Build<T> for CopySurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, from, to, sx, sy, sz } = self;
        let factors = Vec3::new(sx, sy, sz);
        let zeros = factors.re().to_array().iter().filter(|f| **f == 0.0).count();
        if zeros > 1 {
            return Err(CallError::new("no-area", "two zero factors: the surface has no area")
                .expected("at most one factor of 0")
                .found(format!("{zeros} factors of 0"))
                .in_field(Self::SX));
        }
        let map = AffineTransform::Stretch { from: from.xyz, to: to.xyz, factors };
        Ok(image(surface, map, context.nesting))
    }
}

/// A surface projected onto a plane along its normal: each point maps to the foot of its
/// perpendicular.
///
/// The image of a surface perpendicular to the plane degenerates; panels overlap there.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface mirror",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               YPlane p(2.5); ProjSurf shadow(S, p); ProjSurf flat(S, \"y=0\");"
)]
pub struct ProjSurf<T: Real> {
    /// The surface to project.
    surface: SurfaceRef<T>,
    /// The plane of projection.
    mirror: MirrorArgument<T>,
}

impl<T: Real> Build<T> for ProjSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, mirror } = self;
        if !matches!(mirror, MirrorArgument::Plane(_)) {
            return Err(CallError::new(
                "no-area",
                "a surface projected to a line or point has no area",
            )
            .expected("a plane")
            .found("a line or point")
            .in_field(Self::MIRROR));
        }
        Ok(Value::Surface(SurfaceRef::new(ProjectedSurface { surface, mirror }, context.nesting)))
    }
}

struct ProjectedSurface<T: Real> {
    surface: SurfaceRef<T>,
    mirror: MirrorArgument<T>,
}

impl<T: Real> ProjectedSurface<T> {
    fn projected(&self, jet: SurfJet<T>) -> SurfJet<T> {
        let flat = |d| self.mirror.direction(d, true);
        SurfJet {
            p: self.mirror.foot(jet.p),
            u: flat(jet.u),
            v: flat(jet.v),
            uu: flat(jet.uu),
            uv: flat(jet.uv),
            vv: flat(jet.vv),
        }
    }
}

impl<T: Real> Surface<T> for ProjectedSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        self.projected(self.surface.jet(u, v, order))
    }
    fn image_of(&self) -> Option<(Key, bool)> {
        Some((self.surface.key?, false))
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        let Some(normals) = normals else {
            self.surface.grid(us, vs, points, None);
            for p in points {
                *p = self.mirror.foot(*p);
            }
            return;
        };
        // A normal of the image takes both tangents.
        let out = points.chunks_mut(vs.len().max(1)).zip(normals.chunks_mut(vs.len().max(1)));
        for ((points, normals), &u) in out.zip(us) {
            let line = self.line(T::from(u), vs, Order::First);
            for ((p, n), jet) in points.iter_mut().zip(normals).zip(line) {
                (*p, *n) = (jet.p, jet.normal());
            }
        }
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        self.surface.line(u, vs, order).into_iter().map(|jet| self.projected(jet)).collect()
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        self.surface.scattered(uv, out);
        for p in out {
            *p = self.mirror.foot(*p);
        }
    }

    moldloft_num::surface_facts!(breaks of [self.surface], closed of [self.surface], rational of [self.surface]);
}

/// A surface whose four corners are moved to given points: S plus the bilinear blend of the
/// corners' displacements, which is linear along each edge.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface p00 p10 p11 p01",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsPoint P(0, 2, 0); AbsPoint Q(4.5, 2, 0.5); AbsPoint R(4, 2, 3); AbsPoint T(0, 1.5, 2); \
               RelSurf moved(S, P, Q, R, T);"
)]
pub struct RelSurf<T: Real> {
    /// The surface it follows.
    surface: SurfaceRef<T>,
    /// The corner (u, v) = (0, 0).
    p00: Point<T>,
    /// The corner (1, 0).
    p10: Point<T>,
    /// The corner (1, 1).
    p11: Point<T>,
    /// The corner (0, 1).
    p01: Point<T>,
}

impl<T: Real> Build<T> for RelSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, p00, p10, p11, p01 } = self;
        let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let points = [p00, p10, p11, p01];
        let shift = |k: usize| {
            let (u, v) = places[k];
            points[k].xyz - surface.jet(T::from(u), T::from(v), Order::Zero).p
        };
        let shifts = [shift(0), shift(1), shift(2), shift(3)];
        let corners = [0, 1, 2, 3].map(|k| points[k].key);
        Ok(Value::Surface(SurfaceRef::new(
            ShiftedSurface { surface, shifts, corners },
            context.nesting,
        )))
    }
}

struct ShiftedSurface<T: Real> {
    surface: SurfaceRef<T>,
    shifts: [Vec3<T>; 4],
    corners: [Option<Key>; 4],
}

impl<T: Real> ShiftedSurface<T> {
    fn shift(&self, u: T, v: T) -> Vec3<T> {
        let [a, b, c, d] = self.shifts;
        let (p, q) = (-u + 1.0, -v + 1.0);
        (a * p + b * u) * q + (d * p + c * u) * v
    }

    fn added(&self, mut jet: SurfJet<T>, u: T, v: T, order: Order) -> SurfJet<T> {
        let [a, b, c, d] = self.shifts;
        let (p, q) = (-u + 1.0, -v + 1.0);
        jet.p += self.shift(u, v);
        if order >= Order::First {
            jet.u += (b - a) * q + (c - d) * v;
            jet.v += (d - a) * p + (c - b) * u;
        }
        if order == Order::Second {
            jet.uv += a - b + c - d;
        }
        jet
    }
}

impl<T: Real> Surface<T> for ShiftedSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        self.added(self.surface.jet(u, v, order), u, v, order)
    }
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        let [a, b] = moldloft_num::trace::EDGE_CORNERS[k].map(|c| self.corners[c]);
        let edge = self.surface.key.and_then(|s| s.edge(k));
        [a, b, edge].into_iter().flatten().collect()
    }

    fn edges(&self) -> moldloft_num::trace::Edges<T> {
        moldloft_num::trace::Edges { corners: self.corners, ..moldloft_num::trace::Edges::own() }
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        let Some(normals) = normals else {
            self.surface.grid(us, vs, points, None);
            for (row, &u) in points.chunks_mut(vs.len().max(1)).zip(us) {
                for (p, &v) in row.iter_mut().zip(vs) {
                    *p += self.shift(T::from(u), T::from(v));
                }
            }
            return;
        };
        // A normal of the image takes both tangents.
        let out = points.chunks_mut(vs.len().max(1)).zip(normals.chunks_mut(vs.len().max(1)));
        for ((points, normals), &u) in out.zip(us) {
            let line = self.line(T::from(u), vs, Order::First);
            for ((p, n), jet) in points.iter_mut().zip(normals).zip(line) {
                (*p, *n) = (jet.p, jet.normal());
            }
        }
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        let line = self.surface.line(u, vs, order).into_iter().zip(vs);
        line.map(|(jet, &v)| self.added(jet, u, T::from(v), order)).collect()
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        self.surface.scattered(uv, out);
        for (p, &[u, v]) in out.iter_mut().zip(uv) {
            *p += self.shift(T::from(u), T::from(v));
        }
    }

    moldloft_num::surface_facts!(breaks of [self.surface], open, not_rational);
}
