//! Closed forms.

use crate::{Body, Side};
use moldloft_num::{Dual, Jet, Real, SurfaceFormula, Vec3};
use std::f64::consts::PI;

/// The ellipsoid of half axes a, b, c about `at`; u from the lowest point up, v around.
struct Ellipsoid<T> {
    axes: [T; 3],
    at: Vec3<T>,
}

impl<T: Real> SurfaceFormula for Ellipsoid<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * PI, v * (2.0 * PI));
        let r = a.sin();
        let [x, y, z] = self.axes;
        Vec3::new(
            (r * b.cos()).scaled(x) + J::fixed(self.at.x),
            (r * b.sin()).scaled(y) + J::fixed(self.at.y),
            (-a.cos()).scaled(z) + J::fixed(self.at.z),
        )
    }
}

pub(crate) fn ellipsoid<T: Real>(axes: [T; 3], at: Vec3<T>, accuracy: f64) -> Body<T> {
    let surface = Ellipsoid { axes, at };
    let side = Side { surface: &surface, reversed: true, open_edges: [false; 4] };
    let size = 2.0 * axes.iter().map(|a| a.re() * a.re()).sum::<f64>().sqrt();
    Body::new(&[side], [], Vec::new(), size, accuracy).unwrap()
}

#[test]
fn a_sphere_is_measured() {
    let r = 1.7;
    for accuracy in [1e-4, 1e-6, 1e-10] {
        let ball = ellipsoid([r; 3], Vec3::of(100.0, -3.0, 40.0), accuracy);
        let m = ball.measures();
        let (area, volume) = (4.0 * PI * r * r, 4.0 / 3.0 * PI * r * r * r);
        let off = [(m.area - area).abs(), (m.volume - volume).abs()];
        println!("{accuracy} cells {} off {off:?} bounds {:?}", ball.cell_count(), m.bounds);
        assert!(off[0] <= m.bounds[0] + 1e-13 * area && m.bounds[0] <= accuracy * area, "{m:?}");
        assert!(off[1] <= m.bounds[1] + 1e-12 * volume && m.bounds[1] <= accuracy * volume);
        assert!(m.centroid.distance(Vec3::of(100.0, -3.0, 40.0)) < accuracy);
        assert!(m.area_centre.distance(Vec3::of(100.0, -3.0, 40.0)) < accuracy);
    }
}

#[test]
fn a_sphere_afloat() {
    let r = 1.0;
    for h in [0.01, 0.3, 0.9, 1.0, 1.5, 1.99] {
        let ball = ellipsoid([r; 3], Vec3::zero(), 1e-8);
        let all = ball.integrals(h - r, [0.0; 2]);
        let volume = PI * h * h * (3.0 * r - h) / 3.0;
        let plane = PI * h * (2.0 * r - h);
        let area = 2.0 * PI * r * h;
        let got = [all.sums.forms[2], all.sums.wetted, all.sums.plane[0], all.sums.green];
        println!("{h}: {:?} {:?} strips {}", 
            [got[0] - volume, got[1] - area, got[2] - plane, got[3] - plane], all.errors, all.waterline.len());
        assert!((got[0] - volume).abs() < 1e-9 && (got[1] - area).abs() < 1e-8);
        assert!((got[2] - plane).abs() < 1e-9 && (got[3] - plane).abs() < 1e-9);
    }
}

#[test]
fn derivatives_are_exact() {
    // A rise of the water, and a longer body.
    let [rise, longer] = [0, 1].map(|k| Dual::<2>::seeded([0.3, 5.0][k], k));
    let body = ellipsoid([longer, 2.0.into(), 1.5.into()], Vec3::zero(), 1e-9);
    let all = body.integrals(rise, [Dual::from(0.0); 2]);
    let (a, b, c, d): (f64, f64, f64, f64) = (5.0, 2.0, 1.5, 0.2);
    let volume = |d: f64| PI * b * c * (2.0 / 3.0 + d - d * d * d / 3.0);
    let v = all.sums.forms[2];
    assert!((v.re - a * volume(d)).abs() < 1e-8);
    let plane = PI * a * b * (1.0 - d * d);
    assert!((v.eps[0] - plane).abs() < 1e-8, "{} {plane}", v.eps[0]);
    assert!((v.eps[1] - volume(d)).abs() < 1e-8);
    let w = all.sums.plane[0];
    assert!((w.re - plane).abs() < 1e-8 && (w.eps[1] - plane / a).abs() < 1e-8);
    assert!((w.eps[0] - PI * a * b * (-2.0 * d / c)).abs() < 1e-7, "{:?}", w.eps);
}
