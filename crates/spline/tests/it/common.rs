//! Laws that every shape obeys.
use moldloft_num::{Curve, Dual, Order, SurfJet, Surface, Vec3};
pub use moldloft_testing::{Random, close, ridders_vector};

pub type D = Dual<1>;

/// Derivatives are central differences, at parameters away from breaks.
pub fn curve_laws(curve: &dyn Curve<f64>, ts: &[f64], scale: f64) {
    for &t in ts {
        let jet = curve.jet(t, Order::Second);
        assert_eq!(jet[0], curve.jet(t, Order::Zero)[0]);
        let first = ridders_vector(|t| curve.jet(t, Order::Zero)[0], t, 0.01);
        let second = ridders_vector(|t| curve.jet(t, Order::First)[1], t, 0.01);
        close(jet[1], first, 1e-8 * scale);
        close(jet[2], second, 1e-7 * scale);
    }
    let mut grid = vec![Vec3::zero(); ts.len()];
    curve.grid(ts, &mut grid);
    for (&t, x) in ts.iter().zip(grid) {
        close(x, curve.jet(t, Order::Zero)[0], 1e-14 * scale);
    }
}

/// Partial derivatives are central differences, at parameters away from breaks.
pub fn surface_laws(s: &dyn Surface<f64>, uv: &[[f64; 2]], scale: f64) {
    for &[u, v] in uv {
        let jet = s.jet(u, v, Order::Second);
        let first = |u: f64, v: f64| s.jet(u, v, Order::First);
        type Part = fn(SurfJet<f64>) -> Vec3<f64>;
        let parts: [(Vec3<f64>, Part, bool); 5] = [
            (jet.u, |j| j.p, true),
            (jet.v, |j| j.p, false),
            (jet.uu, |j| j.u, true),
            (jet.uv, |j| j.v, true),
            (jet.vv, |j| j.v, false),
        ];
        for (exact, part, by_u) in parts {
            let along = |x: f64| if by_u { part(first(x, v)) } else { part(first(u, x)) };
            close(exact, ridders_vector(along, if by_u { u } else { v }, 0.01), 1e-7 * scale);
        }
    }
}

/// The points moved by `h` along `directions`, and as dual numbers.
pub fn moved(points: &[Vec3<f64>], directions: &[Vec3<f64>], h: f64) -> Vec<Vec3<f64>> {
    points.iter().zip(directions).map(|(&p, &d)| p + d * h).collect()
}

pub fn seeded(points: &[Vec3<f64>], directions: &[Vec3<f64>]) -> Vec<Vec3<D>> {
    let dual = |re: f64, e: f64| D { re, eps: [e] };
    let pairs = points.iter().zip(directions);
    pairs.map(|(p, d)| Vec3::new(dual(p.x, d.x), dual(p.y, d.y), dual(p.z, d.z))).collect()
}

/// A shape made from points moves with them as its dual numbers say.
pub fn point_derivative_law(
    points: &[Vec3<f64>],
    directions: &[Vec3<f64>],
    plain: impl Fn(&[Vec3<f64>]) -> Vec3<f64>,
    dual: impl Fn(&[Vec3<D>]) -> Vec3<D>,
    accuracy: f64,
) {
    let exact = dual(&seeded(points, directions));
    let base = plain(points);
    close(exact.re(), base, 1e-13 * (1.0 + base.norm()));
    let slope = ridders_vector(|h| plain(&moved(points, directions, h)), 0.0, 1e-2);
    close(exact.map(|x| x.eps[0]), slope, accuracy);
}
