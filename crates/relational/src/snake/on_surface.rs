//! The curve on a surface of a path in its parameter plane.

use moldloft_num::trace::Trace;
use moldloft_num::{Curve, CurveJet, Order, Real};
use moldloft_registry::{CurveRef, SurfaceRef};
use std::cell::RefCell;
use std::collections::HashMap;

/// The curve X(t) = S(w(t)) of a path w(t) = (u, v, 0) in the parameter plane of a surface.
pub struct OnSurface<T: Real, P> {
    /// The surface.
    pub surface: SurfaceRef<T>,
    /// The path.
    pub path: P,
    /// Curves and points that it follows.
    pub trace: Trace<T>,
}

impl<T: Real, P: Curve<T>> Curve<T> for OnSurface<T, P> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [w, d, dd] = self.path.jet(t, order);
        let s = self.surface.jet(w.x, w.y, order);
        let mut jet = [s.p, s.u * d.x + s.v * d.y, s.u * dd.x + s.v * dd.y];
        jet[2] += s.uu * (d.x * d.x) + s.uv * (d.x * d.y * 2.0) + s.vv * (d.y * d.y);
        jet
    }

    /// Breaks of the path, and crossings with those of the surface.
    fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.path.breaks();
        let mut spans = vec![0.0];
        spans.extend(&breaks);
        spans.push(1.0);
        // All lines of the surface are searched at the same parameters of the path.
        let known: RefCell<HashMap<u64, [f64; 2]>> = RefCell::default();
        let path = |t: f64| {
            *known.borrow_mut().entry(t.to_bits()).or_insert_with(|| {
                let [w, ..] = self.path.jet(T::from(t), Order::Zero);
                [w.x.re(), w.y.re()]
            })
        };
        breaks.extend(self.surface.crossings(&path, &spans));
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    fn kinks(&self) -> Vec<f64> {
        let mut kinks = self.path.kinks();
        let spans = || [&[0.0], &*self.path.breaks(), &[1.0]].concat();
        let path = |t: f64| {
            let [w, ..] = self.path.jet(T::from(t), Order::Zero);
            [w.x.re(), w.y.re()]
        };
        kinks.extend(self.surface.kink_crossings(&path, &spans()));
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.path.jet(t, order))
    }

    moldloft_num::curve_facts!(joints_at_breaks, open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}

/// The path of a snake in the parameter plane of its surface.
pub struct PathOnSurface<T: Real> {
    /// The snake.
    pub curve: CurveRef<T>,
}

impl<T: Real> Curve<T> for PathOnSurface<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.on_surface(t, order).expect("a snake knows its place on its surface")
    }

    moldloft_num::curve_facts!(breaks of [self.curve], open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}
