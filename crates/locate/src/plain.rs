//! Shapes of any scalar seen through their real parts, so that searches choose alike for all scalars.

use moldloft_num::{Curve, CurveJet, Order, Real, SurfJet, Surface, Vec3};

/// A curve of any scalar seen through its real parts. Searches run on these, so that discrete
/// choices are the same with and without derivatives.
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

    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }

    fn joints(&self) -> Vec<f64> {
        self.0.joints()
    }

    fn closed(&self) -> bool {
        self.0.closed()
    }
}

/// A surface of any scalar seen through its real parts; see [`PlainCurve`].
pub struct PlainSurface<'a, T: Real>(pub &'a dyn Surface<T>);

impl<T: Real> Surface<f64> for PlainSurface<'_, T> {
    #[inline]
    fn jet(&self, u: f64, v: f64, order: Order) -> SurfJet<f64> {
        let j = self.0.jet(T::from(u), T::from(v), order);
        SurfJet {
            p: j.p.re(),
            u: j.u.re(),
            v: j.v.re(),
            uu: j.uu.re(),
            uv: j.uv.re(),
            vv: j.vv.re(),
        }
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

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.0.breaks()
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.0.joints()
    }

    fn closed(&self) -> [bool; 2] {
        self.0.closed()
    }
}
