//! Shapes with closed forms, and random numbers.

use moldloft_num::{CurveFormula, Jet, Surface, SurfaceFormula, Vec3};
use moldloft_spline::{BSplineSurface, KnotVector};
pub use moldloft_testing::Random;

/// The sphere of radius r about c, without its poles' neighbourhood when `cap` is below 1.
pub struct Sphere {
    pub centre: Vec3,
    pub radius: f64,
}

impl SurfaceFormula for Sphere {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * std::f64::consts::TAU, (v - 0.5) * std::f64::consts::PI);
        let c = self.centre.map(J::fixed);
        let r = self.radius;
        let local = Vec3::new(b.cos() * a.cos(), b.cos() * a.sin(), b.sin());
        c + local.map(|x| x * r)
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

/// A cylinder of radius r round the line through c along axis 0, 1 or 2, from -h to h.
pub struct Cylinder {
    pub centre: Vec3,
    pub radius: f64,
    pub half: f64,
    pub axis: usize,
}

impl SurfaceFormula for Cylinder {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let a = u * std::f64::consts::TAU;
        let (x, y, z) = (a.cos() * self.radius, a.sin() * self.radius, (v * 2.0 - 1.0) * self.half);
        let local = match self.axis {
            0 => Vec3::new(z, x, y),
            1 => Vec3::new(x, z, y),
            _ => Vec3::new(x, y, z),
        };
        self.centre.map(J::fixed) + local
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

/// A circle of radius r about c in the plane z = c.z.
pub struct Circle {
    pub centre: Vec3,
    pub radius: f64,
}

impl CurveFormula for Circle {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, t: J) -> Vec3<J> {
        let a = t * std::f64::consts::TAU;
        let local = Vec3::new(a.cos() * self.radius, a.sin() * self.radius, J::fixed(0.0));
        self.centre.map(J::fixed) + local
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}

pub struct Line(pub Vec3, pub Vec3);

impl CurveFormula for Line {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, t: J) -> Vec3<J> {
        self.0.map(J::fixed) + (self.1 - self.0).map(|x| t * x)
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}

/// The 20 x 20 bicubic surface of the comparisons: an even net with random heights in [0, 1].
pub fn bumpy(n: usize, seed: u64) -> BSplineSurface<f64> {
    let mut random = Random::new(seed);
    let k = KnotVector::clamped_uniform(3, n).unwrap();
    let net = (0..n * n)
        .map(|i| Vec3::of((i / n) as f64 * 0.5, (i % n) as f64 * 0.5, random.unit()))
        .collect();
    BSplineSurface::new(k.clone(), k, net, None).unwrap()
}

/// The nearest of a fine grid, polished by a descent of its own kind (coordinate search).
pub fn brute(surface: &dyn Surface<f64>, p: Vec3, n: usize) -> (f64, [f64; 2]) {
    let ts: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
    let mut x = vec![Vec3::zero(); ts.len() * ts.len()];
    surface.grid(&ts, &ts, &mut x, None);
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].distance(p).total_cmp(&x[b].distance(p)));
    let mut best = (f64::INFINITY, [0.0; 2]);
    for &k in order.iter().take(12) {
        let mut uv = [ts[k / ts.len()], ts[k % ts.len()]];
        let at = |uv: [f64; 2]| surface.jet(uv[0], uv[1], moldloft_num::Order::Zero).p.distance(p);
        let mut d = at(uv);
        let mut h = 1.0 / n as f64;
        while h > 1e-13 {
            let mut moved = false;
            for (a, b) in [
                (1., 0.),
                (-1., 0.),
                (0., 1.),
                (0., -1.),
                (0.7, 0.7),
                (-0.7, 0.7),
                (0.7, -0.7),
                (-0.7, -0.7),
            ] {
                let next = [(uv[0] + a * h).clamp(0.0, 1.0), (uv[1] + b * h).clamp(0.0, 1.0)];
                let e = at(next);
                if e < d {
                    (uv, d, moved) = (next, e, true);
                }
            }
            if !moved {
                h *= 0.5;
            }
        }
        if d < best.0 {
            best = (d, uv);
        }
    }
    best
}
