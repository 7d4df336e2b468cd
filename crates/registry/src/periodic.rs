//! Curves and surfaces of a model as shapes: closed ones are continued periodically beyond 0 and 1.

use crate::{CurveRef, SurfaceRef};
use moldloft_num::period::{closed_sides, closes, smooth_seams, turned_back};
use moldloft_num::trace::{Edges, Key, Trace};
use moldloft_num::{
    Curve, CurveJet, InnerPlane, Order, Rational, Real, Reparametrization, SurfJet, Surface, Vec3,
    line_crossings,
};
use std::sync::Arc;

/// True when parameters reach beyond 0 .. 1.
fn beyond(ts: &[f64]) -> bool {
    ts.iter().any(|t| !(0.0..=1.0).contains(t))
}

fn all_turned_back(ts: &[f64], closed: bool) -> Vec<f64> {
    ts.iter().map(|t| if closed { turned_back(*t) } else { *t }).collect()
}

impl<T: Real> CurveRef<T> {
    /// Position and derivatives at `t`.
    #[inline(always)]
    pub fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        if (0.0..=1.0).contains(&t.re()) {
            self.shape.jet(t, order)
        } else {
            self.outside(t, order)
        }
    }

    #[cold]
    fn outside(&self, t: T, order: Order) -> CurveJet<T> {
        self.shape.jet(if self.closed() { turned_back(t) } else { t }, order)
    }

    /// See [`Curve::closed`].
    pub fn closed(&self) -> bool {
        *self.closed.get_or_init(|| closes(&*self.shape))
    }
}

impl<T: Real> Curve<T> for CurveRef<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        CurveRef::jet(self, t, order)
    }
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        if beyond(ts) && self.closed() {
            return self.shape.grid(&all_turned_back(ts, true), out);
        }
        self.shape.grid(ts, out);
    }
    fn breaks(&self) -> Vec<f64> {
        self.shape.breaks()
    }
    fn joints(&self) -> Vec<f64> {
        self.shape.joints()
    }
    fn kinks(&self) -> Vec<f64> {
        self.shape.kinks()
    }
    fn closed(&self) -> bool {
        CurveRef::closed(self)
    }
    fn trace(&self) -> Trace<T> {
        self.shape.trace()
    }
    fn parallel_to(&self) -> Option<(&dyn Curve<T>, Vec3<T>, T)> {
        self.shape.parallel_to()
    }
    fn image_of(&self) -> Option<Key> {
        self.shape.image_of()
    }
    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        let inside = (0.0..=1.0).contains(&t.re());
        self.shape.on_surface(if inside || !self.closed() { t } else { turned_back(t) }, order)
    }
    fn law(&self) -> Option<Arc<dyn Reparametrization<T>>> {
        self.shape.law()
    }
    fn rational(&self) -> Rational<1> {
        self.shape.rational()
    }
}

impl<T: Real> SurfaceRef<T> {
    /// Position and derivatives at (`u`, `v`).
    #[inline(always)]
    pub fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let unit = 0.0..=1.0;
        if unit.contains(&u.re()) && unit.contains(&v.re()) {
            self.shape.jet(u, v, order)
        } else {
            self.outside(u, v, order)
        }
    }

    #[cold]
    fn outside(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let closed = self.closed();
        let [u, v] = [(u, closed[0]), (v, closed[1])]
            .map(|(w, round)| if round { turned_back(w) } else { w });
        self.shape.jet(u, v, order)
    }

    /// See [`Surface::closed`].
    pub fn closed(&self) -> [bool; 2] {
        *self.closed.get_or_init(|| closed_sides(&*self.shape))
    }

    /// The parameters in (0, 1), in any order, at which a path, smooth between `spans`, may meet a
    /// line on which a first derivative jumps: a subset of its [crossings](Surface::crossings),
    /// which are more expensive.
    pub fn kink_crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        let mut ends = spans.iter().flat_map(|t| path(*t));
        let closed = self.closed();
        if closed == [false; 2] || ends.all(|w| (0.0..=1.0).contains(&w)) {
            return self.shape.crossings(path, spans);
        }
        let smooth = self.smooth_seams.get_or_init(|| smooth_seams(&*self.shape, closed));
        if *smooth != closed {
            return self.crossings(path, spans);
        }
        // At a smooth seam the path may appear to cross a line; an additional break is harmless.
        let within = |t: f64| {
            let w = path(t);
            [0, 1].map(|k| if closed[k] { turned_back(w[k]) } else { w[k] })
        };
        self.shape.crossings(&within, spans)
    }
}

impl<T: Real> Surface<T> for SurfaceRef<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        SurfaceRef::jet(self, u, v, order)
    }
    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        if beyond(us) || beyond(vs) {
            let closed = self.closed();
            let (us, vs) = (all_turned_back(us, closed[0]), all_turned_back(vs, closed[1]));
            return self.shape.grid(&us, &vs, points, normals);
        }
        self.shape.grid(us, vs, points, normals);
    }
    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        if beyond(&[u.re()]) || beyond(vs) {
            return vs.iter().map(|&v| SurfaceRef::jet(self, u, T::from(v), order)).collect();
        }
        self.shape.line(u, vs, order)
    }
    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        if uv.iter().any(|w| beyond(w)) {
            let closed = self.closed();
            let inside: Vec<[f64; 2]> = uv
                .iter()
                .map(|w| [0, 1].map(|k| if closed[k] { turned_back(w[k]) } else { w[k] }))
                .collect();
            return self.shape.scattered(&inside, out);
        }
        self.shape.scattered(uv, out);
    }
    fn breaks(&self) -> [Vec<f64>; 2] {
        self.shape.breaks()
    }
    fn joints(&self) -> [Vec<f64>; 2] {
        self.shape.joints()
    }
    fn closed(&self) -> [bool; 2] {
        SurfaceRef::closed(self)
    }
    fn kinks(&self) -> [Vec<f64>; 2] {
        self.shape.kinks()
    }
    /// Over the seam of a closed surface, the seam itself and the lines beyond it count, too.
    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        let ends = spans.iter().flat_map(|t| path(*t));
        if !ends.into_iter().any(|w| !(0.0..=1.0).contains(&w)) || self.closed() == [false; 2] {
            return self.shape.crossings(path, spans);
        }
        let closed = self.closed();
        let seams =
            closed.map(|round| if round { (-2..=3).map(f64::from).collect() } else { vec![] });
        let over = line_crossings(&seams, path, spans);
        let mut finer = spans.to_vec();
        finer.extend(&over);
        finer.sort_by(f64::total_cmp);
        finer.dedup();
        let mut all = over;
        for span in finer.windows(2) {
            // The whole stretch is in one turn.
            let turn = path(0.5 * (span[0] + span[1])).map(f64::floor);
            let inside = |t: f64| {
                let w = path(t);
                [0, 1].map(|k| if closed[k] { w[k] - turn[k] } else { w[k] })
            };
            all.extend(
                self.shape
                    .crossings(&inside, span)
                    .into_iter()
                    .filter(|t| *t > span[0] && *t < span[1]),
            );
        }
        all
    }
    fn between_joints(&self, us: &[f64], shares: &[f64]) -> Option<Vec<Vec3<T>>> {
        self.shape.between_joints(us, shares)
    }
    fn inner_planes(&self) -> Vec<InnerPlane<'_>> {
        self.shape.inner_planes()
    }
    fn edges(&self) -> Edges<T> {
        self.shape.edges()
    }
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        self.shape.edge_made_of(k)
    }
    fn parallel_to(&self) -> Option<(&dyn Surface<T>, T)> {
        self.shape.parallel_to()
    }
    fn image_of(&self) -> Option<(Key, bool)> {
        self.shape.image_of()
    }
    fn face_of(&self) -> Option<(Key, u8)> {
        self.shape.face_of()
    }
    fn rational(&self) -> Rational<2> {
        self.shape.rational()
    }
}
