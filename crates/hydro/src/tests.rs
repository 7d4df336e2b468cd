//! Closed forms.

use crate::integrals::{Immersed, Wanted};
use crate::{Attitude, Body, HullSide, PolynomialCell, Water, flotation};
use moldloft_num::{Dual, Jet, Real, SurfaceFormula, Vec3};
use moldloft_testing::{Random, soak};
use std::f64::consts::PI;
use std::sync::Arc;

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

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

pub(crate) fn ellipsoid<T: Real>(axes: [T; 3], at: Vec3<T>, accuracy: f64) -> Body<T> {
    let surface = Ellipsoid { axes, at };
    let side = HullSide { surface: &surface, reversed: true, open_edges: [false; 4], loops: None };
    let size = 2.0 * axes.iter().map(|a| a.re() * a.re()).sum::<f64>().sqrt();
    Body::new(&[side], [], Vec::new(), size, accuracy).unwrap()
}

fn integrals<T: Real>(body: &Body<T>, attitude: Attitude<T>, origin: [T; 2]) -> Immersed<T> {
    body.immersed_at(attitude, origin, Wanted::All, body.quadrature_accuracy())
}

#[test]
fn a_sphere_is_measured() {
    let r = 1.7;
    for accuracy in [1e-4, 1e-6, 1e-10] {
        let ball = ellipsoid([r; 3], Vec3::of(100.0, -3.0, 40.0), accuracy);
        let m = ball.measures();
        let (area, volume) = (4.0 * PI * r * r, 4.0 / 3.0 * PI * r * r * r);
        let off = [(m.area - area).abs(), (m.volume - volume).abs()];
        assert!(off[0] <= m.bounds[0] + 1e-13 * area && m.bounds[0] <= accuracy * area, "{m:?}");
        assert!(off[1] <= m.bounds[1] + 1e-12 * volume && m.bounds[1] <= accuracy * volume);
        assert!(m.centroid.distance(Vec3::of(100.0, -3.0, 40.0)) < accuracy);
        assert!(m.area_centre.distance(Vec3::of(100.0, -3.0, 40.0)) < accuracy);
    }
}

#[test]
fn a_floating_sphere() {
    // Down to a sliver, at the level of an edge of cells, and all but under.
    for h in [0.01, 0.3, 0.9, 1.0, 1.5, 1.99] {
        let ball = ellipsoid([1.0; 3], Vec3::zero(), 1e-8);
        let all = integrals(&ball, Attitude::upright(h - 1.0), [0.0; 2]);
        let volume = PI * h * h * (3.0 - h) / 3.0;
        let plane = PI * h * (2.0 - h);
        let area = 2.0 * PI * h;
        let got = &all.sums;
        assert!((got.forms[2] - volume).abs() < 1e-9 && (got.wetted - area).abs() < 1e-8);
        assert!((got.plane[0] - plane).abs() < 1e-9 && (got.green - plane).abs() < 1e-9, "{h}");
    }
}

#[test]
fn an_ellipsoid_below_any_plane() {
    // w = (a n1, b n2, c n3), m = w/|w|, delta = d/|w|: V = pi abc (2/3 + delta - delta^3 / 3).
    let axes = [5.0f64, 2.0, 1.5];
    let body = ellipsoid(axes, Vec3::zero(), 1e-8);
    let mut random = Random::new(7);
    for _ in 0..if soak() { 400 } else { 12 } {
        let [heel, trim] = [random.between(-3.0, 3.0), random.between(-1.5, 1.5)];
        let [s, c, sf, cf] = [trim.sin(), trim.cos(), heel.sin(), heel.cos()];
        let n = [-s, -c * sf, c * cf];
        let w: [f64; 3] = std::array::from_fn(|k| axes[k] * n[k]);
        let norm = w.iter().map(|x| x * x).sum::<f64>().sqrt();
        let delta = random.between(-0.95, 0.95);
        let attitude = Attitude { level: delta * norm, trim, heel };
        let found = flotation(&body, Water::default(), attitude, None);
        let abc = axes[0] * axes[1] * axes[2];
        let share = 2.0 / 3.0 + delta - delta.powi(3) / 3.0;
        let volume = PI * abc * share;
        let reach = 0.25 * (1.0 - delta * delta).powi(2) / share;
        let plane = PI * abc * (1.0 - delta * delta) / norm;
        let h = &found.earth;
        let near = |x: f64, y: f64, scale: f64| (x - y).abs() < 3e-8 * scale;
        assert!(near(h.volume, volume, PI * abc), "{heel} {trim} {delta}: {} {volume}", h.volume);
        assert!(near(h.waterplane.unwrap().area, plane, plane));
        assert!(h.waterplane_error < 1e-8 && h.closure_error < 1e-6);
        let b = found.buoyancy_centre.unwrap().to_array();
        for k in 0..3 {
            assert!(near(b[k], -axes[k] * w[k] / norm * reach, 50.0), "{b:?}");
        }
    }
}

/// A lumpy ball: no two planes cut it alike.
struct Lumpy;

impl SurfaceFormula for Lumpy {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * PI, v * (2.0 * PI));
        let r =
            (a.sin() * 3.0).sin() * (b * 3.0).cos() * 0.2 + (a * 2.0).sin() * b.sin() * 0.15 + 1.0;
        Vec3::new(a.sin() * b.cos() * r, a.sin() * b.sin() * r, -a.cos() * r)
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn below_and_above_are_all() {
    let side = HullSide { surface: &Lumpy, reversed: true, open_edges: [false; 4], loops: None };
    let body = Body::new(&[side], [], Vec::new(), 3.0, 1e-7).unwrap();
    let whole = body.measures();
    let turned = body.mapped(|p| Vec3::new(p.x, -p.y, -p.z), false);
    let mut random = Random::new(3);
    for _ in 0..if soak() { 100 } else { 5 } {
        let level = random.between(-1.1, 1.1);
        let [below, above] = [(&body, level, -0.2), (&turned, -level, 0.2)]
            .map(|(body, level, y)| integrals(body, Attitude::upright(level), [0.1, y]));
        let off = below.sums.forms[2] + above.sums.forms[2] - whole.volume;
        let bound = below.errors[0] + above.errors[0] + 3.0 * whole.bounds[1];
        assert!(off.abs() <= bound && bound < 1e-6 * whole.volume, "{level}: {off} {bound}");
        let off = below.sums.wetted + above.sums.wetted - whole.area;
        let bound = below.errors[2] + above.errors[2] + 3.0 * whole.bounds[0];
        assert!(off.abs() <= bound && bound < 1e-6 * whole.area, "{level}: {off} {bound}");
        // One water plane from both sides, and from its line.
        let [a, b] = [&below, &above].map(|all| all.sums.plane[0]);
        assert!((a - b).abs() < 1e-7 && (a - below.sums.green).abs() < 1e-7, "{a} {b}");
        assert!(below.sums.open.iter().all(|x| x.abs() < 1e-8));
    }
}

/// A torus with its axis up: a flat ring of water, or a waterplane of two circles.
struct Torus([f64; 2]);

impl SurfaceFormula for Torus {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * (2.0 * PI), v * (2.0 * PI));
        let r = a.cos() * self.0[1] + self.0[0];
        Vec3::new(r * b.cos(), r * b.sin(), a.sin() * self.0[1])
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn a_torus_half_immersed_and_on_its_side() {
    let (big, small) = (3.0, 0.8);
    let torus = Torus([big, small]);
    let side = HullSide { surface: &torus, reversed: true, open_edges: [false; 4], loops: None };
    let body = Body::new(&[side], [], Vec::new(), 8.0, 1e-7).unwrap();
    let volume = 2.0 * PI * PI * big * small * small;
    assert!((body.measures().volume - volume).abs() < 1e-6);
    let flat = flotation(&body, Water::default(), Attitude::upright(0.0), None);
    assert!((flat.earth.volume - volume / 2.0).abs() < 1e-6);
    let ring = PI * ((big + small).powi(2) - (big - small).powi(2));
    let plane = flat.earth.waterplane.unwrap();
    assert!((plane.area - ring).abs() < 1e-6 && (plane.beam - 2.0 * (big + small)).abs() < 1e-9);
    let upright = Attitude { heel: PI / 2.0, ..Attitude::upright(0.0) };
    let two = flotation(&body, Water::default(), upright, None);
    assert!((two.earth.volume - volume / 2.0).abs() < 1e-6);
    assert!((two.earth.waterplane.unwrap().area - 2.0 * PI * small * small).abs() < 1e-6);
}

/// A spar whose skin runs along v as the square root: the tangent is infinite at v = 0.
struct Bowl;

impl SurfaceFormula for Bowl {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        // The paraboloid z = r^2 - 1 with r = sqrt(v): half-immersed it holds pi / 2.
        let r = if v.re() > 0.0 { v.sqrt() } else { v * 0.0 };
        let a = u * (2.0 * PI);
        Vec3::new(r * a.cos(), r * a.sin(), v - 1.0)
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

#[test]
fn a_skin_with_an_infinite_tangent() {
    let side = HullSide {
        surface: &Bowl,
        reversed: false,
        open_edges: [false, false, true, false],
        loops: None,
    };
    let body = Body::new(&[side], [], Vec::new(), 2.0, 1e-6).unwrap();
    let found = flotation(&body, Water::default(), Attitude::upright(0.0), None);
    let off = (found.earth.volume.abs() - PI / 2.0).abs();
    assert!(off <= found.errors[0] && found.errors[0] < 1e-5, "{off} {:?}", found.errors);
    let area = PI / 6.0 * (5f64.powf(1.5) - 1.0);
    let off = (found.earth.wetted_area - area).abs();
    assert!(off <= found.errors[2], "{off} {:?} {}", found.errors, body.cell_count());
    assert_eq!(found.earth.open_edges, 0);
    assert!(found.freeboard.unwrap().abs() < 1e-12);
}

fn lifted<T: Real>(body: &Body<f64>) -> Vec<Arc<PolynomialCell<T>>> {
    body.cells().iter().map(|c| Arc::new(PolynomialCell::lifted(c))).collect()
}

/// Whole cells by their moments, and the body turned and integrated cell by cell.
#[test]
fn two_ways_to_the_integrals_of_a_turned_body_agree() {
    let side = HullSide { surface: &Lumpy, reversed: true, open_edges: [false; 4], loops: None };
    let lumpy = Body::new(&[side], [], Vec::new(), 3.0, 1e-7).unwrap();
    let mut random = Random::new(17);
    for seed in 0..if soak() { 300 } else { 6 } {
        let mut dual = |a: f64, b: f64, k: usize| Dual::<3>::seeded(random.between(a, b), k);
        let attitude = Attitude::of([dual(-0.8, 1.2, 0), dual(-0.5, 0.5, 1), dual(-3.0, 3.0, 2)]);
        let origin = [dual(-9.0, 9.0, 0), dual(-9.0, 9.0, 1)];
        let body = match seed % 2 {
            0 => Body::of_cells(lifted(&lumpy), 3.0, 1e-7),
            _ => ellipsoid([dual(1.0, 4.0, 0), dual(0.4, 2.0, 1), 1.0.into()], Vec3::zero(), 1e-7),
        };
        let found = integrals(&body, attitude, origin);
        let turned = body.turned(attitude);
        let accuracy = body.quadrature_accuracy();
        let other = turned.wanted_integrals(attitude.level, origin, Wanted::All, accuracy);
        let errors = [0, 2].map(|k| found.errors[k] + other.errors[k]);
        assert!(errors[0] < 1e-7 && errors[1] < 1e-6, "{seed}: {errors:?}");
        for (a, b) in found.sums.numbers().into_iter().zip(other.sums.numbers()) {
            let parts = (a.eps.iter().zip(b.eps)).map(|(a, b)| (a - b).abs() / (1.0 + b.abs()));
            let off = parts.fold((a.re - b.re).abs() / (1.0 + b.re.abs()), f64::max);
            assert!(off < 2e-6, "{seed}: {a:?} {b:?}");
        }
    }
}

#[test]
fn derivatives_are_exact() {
    // A rise of the water, and a longer body.
    let [rise, longer] = [0, 1].map(|k| Dual::<2>::seeded([0.3, 5.0][k], k));
    let body = ellipsoid([longer, 2.0.into(), 1.5.into()], Vec3::zero(), 1e-9);
    let all = integrals(&body, Attitude::upright(rise), [Dual::from(0.0); 2]);
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

/// A revolved line: from (r0, z0) to (r1, z1), over an angle.
struct Revolved {
    line: [[f64; 2]; 2],
    angle: f64,
}

impl SurfaceFormula for Revolved {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let [[r0, z0], [r1, z1]] = self.line;
        let r = u * (r1 - r0) + J::fixed(r0);
        let a = v * self.angle;
        Vec3::new(r * a.cos(), r * a.sin(), u * (z1 - z0) + J::fixed(z0))
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

/// Walls, discs, cones and tubes have no volume of their own: their areas take a few cells all the same.
#[test]
fn open_skins_take_few_cells() {
    let mut random = Random::new(5);
    for case in 0..60 {
        let r = [random.between(0.0, 9.0), random.between(0.1, 9.0)];
        let z = [random.between(-70.0, -20.0), random.between(0.0, 30.0)];
        let line = match case % 5 {
            0 => [[0.0, z[0]], [r[1], z[0]]],
            1 => [[r[1], z[0]], [r[1], z[1]]],
            2 => [[r[0], z[0]], [r[1], z[0]]],
            3 => [[0.0, z[0]], [r[1], z[1]]],
            _ => [[r[0], z[0]], [r[1], z[1]]],
        };
        let angle = [PI, 0.5 * PI, 2.0 * PI, 1.3][case % 4];
        let [[r0, z0], [r1, z1]] = line;
        let exact = 0.5 * angle * (r0 + r1) * (r1 - r0).hypot(z1 - z0);
        let surface = Revolved { line, angle };
        let (found, halved) =
            crate::integrals::counted(|| crate::surface_measures(&surface, 1e-6).unwrap());
        assert!((found.area - exact).abs() <= found.bounds[0] + 1e-13 * exact, "{case}: {found:?}");
        assert!(found.bounds[0] <= 1e-6 * exact, "{case}");
        assert!(halved <= 20, "{case}: {halved} halved");
    }
}
