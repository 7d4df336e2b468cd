//! Laws that every shape obeys, and a source of random numbers with a fixed seed.
#![allow(dead_code)]

use moldloft_num::{Curve, Dual, Order, SurfJet, Surface, Vec3};

pub type D = Dual<1>;

/// A splitmix64 sequence (Steele, Lea and Flood 2014) of numbers in [-1, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn point(&mut self) -> Vec3<f64> {
        Vec3::of(self.next(), self.next(), self.next())
    }

    pub fn points(&mut self, n: usize) -> Vec<Vec3<f64>> {
        (0..n).map(|_| self.point()).collect()
    }
}

/// The derivative of `f` at `x` by Ridders' extrapolated central differences (Ridders 1982).
pub fn ridders(f: impl Fn(f64) -> Vec3<f64>, x: f64, step: f64) -> Vec3<f64> {
    let mut table: Vec<Vec<Vec3<f64>>> = Vec::new();
    let (mut best, mut error, mut h) = (Vec3::zero(), f64::INFINITY, step);
    for i in 0..8 {
        let mut row = vec![(f(x + h) - f(x - h)) / (2.0 * h)];
        let mut factor = 4.0;
        for j in 0..i {
            let next = (row[j] * factor - table[i - 1][j]) / (factor - 1.0);
            let change = (next - row[j]).norm().max((next - table[i - 1][j]).norm());
            if change <= error {
                (best, error) = (next, change);
            }
            row.push(next);
            factor *= 4.0;
        }
        table.push(row);
        h *= 0.5;
    }
    best
}

pub fn close(a: Vec3<f64>, b: Vec3<f64>, accuracy: f64) {
    assert!((a - b).norm() <= accuracy, "{a:?} against {b:?}");
}

/// Derivatives are central differences, at parameters away from breaks.
pub fn curve_laws(curve: &dyn Curve<f64>, ts: &[f64], scale: f64) {
    for &t in ts {
        let jet = curve.jet(t, Order::Second);
        assert_eq!(jet[0], curve.jet(t, Order::Zero)[0]);
        let first = ridders(|t| curve.jet(t, Order::Zero)[0], t, 0.01);
        let second = ridders(|t| curve.jet(t, Order::First)[1], t, 0.01);
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
            close(exact, ridders(along, if by_u { u } else { v }, 0.01), 1e-7 * scale);
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
    let slope = ridders(|h| plain(&moved(points, directions, h)), 0.0, 1e-2);
    close(exact.map(|x| x.eps[0]), slope, accuracy);
}
