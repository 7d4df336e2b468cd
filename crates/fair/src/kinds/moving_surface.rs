//! A spline surface whose knots carry derivatives, as surfaces through data have.

use crate::FairError;
use moldloft_num::{Jet, Order, Real, SurfJet, Surface, SurfaceFormula, Vec3};
use moldloft_registry::SurfaceRef;
use moldloft_spline::{BSplineSurface, KnotVector};

/// Values are those of `plain`; derivatives include those of the knots.
pub(super) struct MovingSurface<T: Real> {
    plain: BSplineSurface<T>,
    formula: Tensor<T>,
}

impl<T: Real> MovingSurface<T> {
    /// A referenced surface; control point (i, j) has the index `i * n + j`, knots range from 0 to
    /// 1.
    pub fn referred(
        degrees: [usize; 2],
        knots: [Vec<T>; 2],
        points: Vec<Vec3<T>>,
    ) -> Result<SurfaceRef<T>, FairError> {
        let plain = |d: usize| {
            KnotVector::new(degrees[d], knots[d].iter().map(|k| k.re()).collect())
                .map_err(FairError::Knots)
        };
        let (u, v) = (plain(0)?, plain(1)?);
        let still = knots.iter().flatten().all(|k| k.is_constant());
        let own = if still {
            points.clone()
        } else {
            points.iter().map(|p| Vec3::lifted(p.re())).collect()
        };
        let surface = BSplineSurface::new(u, v, own, None).map_err(|_| FairError::Singular)?;
        if still {
            return Ok(SurfaceRef::new(surface, 0));
        }
        Ok(SurfaceRef::new(Self { plain: surface, formula: Tensor { degrees, knots, points } }, 0))
    }
}

impl<T: Real> Surface<T> for MovingSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let real = self.plain.jet(T::from(u.re()), T::from(v.re()), order);
        let moving = self.formula.jet(u, v, order);
        let join = |m: Vec3<T>, r: Vec3<T>| m - Vec3::lifted(m.re()) + Vec3::lifted(r.re());
        SurfJet {
            p: join(moving.p, real.p),
            u: join(moving.u, real.u),
            v: join(moving.v, real.v),
            uu: join(moving.uu, real.uu),
            uv: join(moving.uv, real.uv),
            vv: join(moving.vv, real.vv),
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.plain.breaks()
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.plain.joints()
    }

    moldloft_num::surface_facts!(kinks_at_breaks, breaks_along_lines, open, not_rational);
    moldloft_num::surface_one_by_one!(T: grid, line, scattered);
}

struct Tensor<T> {
    degrees: [usize; 2],
    knots: [Vec<T>; 2],
    points: Vec<Vec3<T>>,
}

impl<T: Real> Tensor<T> {
    /// Knot span that contains `t`: the last one that starts at or below it.
    fn span(&self, d: usize, t: f64) -> usize {
        let (p, knots) = (self.degrees[d], &self.knots[d]);
        let n = knots.len() - p - 1;
        let mut k = p + knots[p + 1..n].iter().filter(|k| k.re() <= t).count();
        while k > p && knots[k].re() >= knots[k + 1].re() {
            k -= 1;
        }
        k
    }

    /// De Boor's algorithm (de Boor 1978, ch. X) along direction `d` in span `k`.
    fn blossom<J: Jet<T>>(&self, d: usize, k: usize, t: J, mut c: Vec<Vec3<J>>) -> Vec3<J> {
        let (p, knots) = (self.degrees[d], &self.knots[d]);
        for level in 1..=p {
            for j in (level..=p).rev() {
                let (low, high) = (knots[k - p + j], knots[k + 1 + j - level]);
                let share = (t - J::fixed(low)) / J::fixed(high - low);
                let rest = -share + 1.0;
                c[j] = c[j - 1] * rest + c[j] * share;
            }
        }
        c[p]
    }
}

impl<T: Real> SurfaceFormula for Tensor<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let [pu, pv] = self.degrees;
        let (ku, kv) = (self.span(0, u.re()), self.span(1, v.re()));
        let n = self.knots[1].len() - pv - 1;
        let row = |i: usize| {
            let own = (kv - pv..=kv).map(|j| self.points[i * n + j].map(J::fixed)).collect();
            self.blossom(1, kv, v, own)
        };
        self.blossom(0, ku, u, (ku - pu..=ku).map(row).collect())
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}
