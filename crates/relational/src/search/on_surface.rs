//! Curves in the parameter plane of a surface: their jets in space, and where they cross its breaks.

use moldloft_num::period::breaks_between;
use moldloft_num::{CurveJet, Order, Real, find_root};
use moldloft_registry::SurfaceRef;

/// The jet of S(w(t)) from that of w.
pub(super) fn on_surface_jet<T: Real>(
    surface: &SurfaceRef<T>,
    [w, d, dd]: CurveJet<T>,
    order: Order,
) -> CurveJet<T> {
    let s = surface.jet(w.x, w.y, order);
    let mut jet = [s.p, s.u * d.x + s.v * d.y, s.u * dd.x + s.v * dd.y];
    jet[2] += s.uu * (d.x * d.x) + s.uv * (d.x * d.y * 2.0) + s.vv * (d.y * d.y);
    jet
}

/// The parameters at which a path in a parameter plane crosses lines u = const and v = const, which recur with each turn
/// where the plane is closed. The nodes are close enough for the path to cross a line at most once between two of them.
pub(super) fn crossings(
    lines: &[Vec<f64>; 2],
    closed: [bool; 2],
    nodes: &[(f64, [f64; 2])],
    at: impl Fn(f64) -> [f64; 2],
) -> Vec<f64> {
    let mut found = Vec::new();
    for axis in 0..2 {
        let range = nodes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], (_, w)| {
            [a.min(w[axis]), b.max(w[axis])]
        });
        for line in breaks_between(&lines[axis], closed[axis], range[0], range[1]) {
            for pair in nodes.windows(2) {
                let ((a, p), (b, q)) = (pair[0], pair[1]);
                if (p[axis] - line) * (q[axis] - line) < 0.0 {
                    found.extend(find_root(|t| at(t)[axis] - line, a, b).ok());
                } else if p[axis] == line && q[axis] != line {
                    found.push(a);
                }
            }
        }
    }
    found.retain(|t| *t > 0.0 && *t < 1.0);
    found
}
