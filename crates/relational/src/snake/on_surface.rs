use moldloft_num::trace::Trace;
use moldloft_num::{Curve, CurveJet, Order, Real, find_root};
use moldloft_registry::SurfaceRef;

/// How many steps a span of the path is searched in for crossings of the surface's breaks.
const STEPS: usize = 8;

/// The curve X(t) = S(w(t)) of a path w(t) = (u, v, 0) in the parameter plane of a surface.
pub struct OnSurface<T: Real, P> {
    /// The surface.
    pub surface: SurfaceRef<T>,
    /// The path.
    pub path: P,
    /// What the curve runs along.
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

    /// Those of the path, and where it crosses those of the surface.
    fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.path.breaks();
        let mut ends = vec![0.0];
        ends.extend(&breaks);
        ends.push(1.0);
        let lines = self.surface.breaks();
        if lines.iter().all(Vec::is_empty) {
            return breaks;
        }
        let along = |axis: usize, t: f64| self.path.jet(T::from(t), Order::Zero)[0][axis].re();
        for span in ends.windows(2) {
            let step = (span[1] - span[0]) / STEPS as f64;
            for k in 0..STEPS {
                let (a, b) = (span[0] + k as f64 * step, span[0] + (k + 1) as f64 * step);
                for (axis, lines) in lines.iter().enumerate() {
                    for &line in lines {
                        let across = |t: f64| along(axis, t) - line;
                        // A path that stays on the line crosses nowhere.
                        if across(a) == 0.0 && across(b) == 0.0 {
                            continue;
                        }
                        breaks.extend(find_root(across, a, b).ok());
                    }
                }
            }
        }
        breaks.retain(|t| *t > 0.0 && *t < 1.0);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.path.jet(t, order))
    }
}
