use moldloft_num::trace::Key;
use moldloft_num::{Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{Kind, Mirror, SurfaceRef};

/// The mirror image of a surface in a plane, line or point, point by point.
///
/// A plane or point turns the natural normal round; panels keep the side of the original's all the
/// same.
#[derive(Kind)]
#[kind(
    class = Surface,
    shape,
    columns = "surface mirror",
    example = "AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               MirrSurf port(S, \"y=0\");"
)]
pub struct MirrSurf<T: Real> {
    /// The surface to mirror.
    surface: SurfaceRef<T>,
    /// What to mirror it in.
    mirror: Mirror<T>,
}

impl<T: Real> Surface<T> for MirrSurf<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let jet = self.surface.jet(u, v, order);
        let turned = |d| self.mirror.direction(d, false);
        SurfJet {
            p: self.mirror.image(jet.p),
            u: turned(jet.u),
            v: turned(jet.v),
            uu: turned(jet.uu),
            uv: turned(jet.uv),
            vv: turned(jet.vv),
        }
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
            *p = self.mirror.image(*p);
        }
        // A x B of images is the image of A x B times the determinant of the map.
        let flip = self.mirror.reverses();
        for n in normals.into_iter().flatten() {
            let turned = self.mirror.direction(*n, false);
            *n = if flip { -turned } else { turned };
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.surface.breaks()
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.surface.joints()
    }

    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        self.surface.crossings(path, spans)
    }

    fn image_of(&self) -> Option<(Key, bool)> {
        Some((self.surface.key?, self.mirror.reverses()))
    }
}
