//! Shapes of any scalar seen through their real parts, so that searches choose alike for all scalars.

use moldloft_num::{Curve, CurveJet, Order, Real, SurfJet, Surface, Vec3};

/// A curve of any scalar reduced to its real parts. Searches use these, so that discrete choices
/// are the same with and without derivatives.
pub struct PlainCurve<'a, T: Real>(pub &'a dyn Curve<T>);

impl<T: Real> Curve<f64> for PlainCurve<'_, T> {
    #[inline]
    fn jet(&self, t: f64, order: Order) -> CurveJet<f64> {
        self.0.jet(T::from(t), order).map(Vec3::re)
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3]) {
        let mut full = vec![Vec3::zero(); ts.len()];
        self.0.grid(ts, &mut full);
        for (x, p) in out.iter_mut().zip(full) {
            *x = p.re();
        }
    }
    moldloft_num::curve_facts!(breaks of [self.0], closed of [self.0], rational of [self.0]);
}

/// A surface of any scalar reduced to its real parts; see [`PlainCurve`].
pub struct PlainSurface<'a, T: Real>(pub &'a dyn Surface<T>);

impl<T: Real> Surface<f64> for PlainSurface<'_, T> {
    #[inline]
    fn jet(&self, u: f64, v: f64, order: Order) -> SurfJet<f64> {
        plain(&self.0.jet(T::from(u), T::from(v), order))
    }

    fn grid(&self, us: &[f64], vs: &[f64], points: &mut [Vec3], normals: Option<&mut [Vec3]>) {
        let mut full = vec![Vec3::zero(); points.len()];
        if let Some(normals) = normals {
            let mut full_normals = vec![Vec3::zero(); points.len()];
            self.0.grid(us, vs, &mut full, Some(&mut full_normals));
            for (x, n) in normals.iter_mut().zip(full_normals) {
                *x = n.re();
            }
        } else {
            self.0.grid(us, vs, &mut full, None);
        }
        for (x, p) in points.iter_mut().zip(full) {
            *x = p.re();
        }
    }

    fn line(&self, u: f64, vs: &[f64], order: Order) -> Vec<SurfJet<f64>> {
        self.0.line(T::from(u), vs, order).iter().map(plain).collect()
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3]) {
        let mut full = vec![Vec3::zero(); uv.len()];
        self.0.scattered(uv, &mut full);
        for (x, p) in out.iter_mut().zip(full) {
            *x = p.re();
        }
    }

    moldloft_num::surface_facts!(breaks of [self.0], closed of [self.0], rational of [self.0]);
}

#[inline]
fn plain<T: Real>(jet: &SurfJet<T>) -> SurfJet<f64> {
    SurfJet {
        p: jet.p.re(),
        u: jet.u.re(),
        v: jet.v.re(),
        uu: jet.uu.re(),
        uv: jet.uv.re(),
        vv: jet.vv.re(),
    }
}
