//! Mass properties: brackets that hold, best values, derivatives.

use crate::common::{axis, cube, facets, t_piece, v};
use moldloft_field::{FieldError, IntegralOptions, Primitive, Set, bracket, mass};
use moldloft_num::{Axis, Dual, Real, Vec3};
use std::f64::consts::PI;

#[test]
fn brackets_contain_closed_forms_and_close_at_second_order() {
    let z = axis(v(0.05, 0.0, 0.1), v(0.0, 0.0, 1.0));
    let solid = |p: Result<Primitive, FieldError>| Set::new(&p.unwrap());
    let crossed = solid(Primitive::cylinder(z, 1.0))
        & solid(Primitive::cylinder(axis(z.point, v(1.0, 0.0, 0.0)), 1.0));
    let cases = [
        ("sphere", solid(Primitive::sphere(v(0.1, 0.2, 0.0), 1.0)), 4.0 * PI / 3.0),
        ("torus", solid(Primitive::torus(z, 0.9, 0.4)), 2.0 * PI * PI * 0.9 * 0.16),
        ("steinmetz", crossed, 16.0 / 3.0),
    ];
    for (name, set, exact) in cases {
        let at = |depth| {
            let m = mass(&set, &cube(1.5), &IntegralOptions::to_depth(depth)).unwrap();
            assert!(m.bracket.volume().contains(exact), "{name}: {:?}", m.bracket.volume());
            assert!(m.bracket.contains(&m.best));
            (m.bracket.volume().width(), (m.best.volume() - exact).abs())
        };
        let (coarse, fine) = (at(5), at(6));
        let rate = (coarse.0 / fine.0).log2();
        assert!(rate > 1.8, "{name}: bracket {coarse:?} {fine:?}, rate {rate}");
        assert!(fine.0 < 0.06 * exact, "{name}: {fine:?}");
        assert!(fine.1 < 2e-5 * exact, "{name}: best off by {}", fine.1);
    }
}

#[test]
fn centroid_and_inertia_of_a_ball_and_a_box() {
    let ball = Set::new(&Primitive::sphere(v(0.3, -0.2, 0.1), 1.0).unwrap());
    let m = mass(&ball, &cube(1.5), &IntegralOptions::to_depth(6)).unwrap();
    assert!(m.best.centroid().distance(v(0.3, -0.2, 0.1)) < 1e-6);
    for (range, x) in m.bracket.centroid().iter().zip([0.3, -0.2, 0.1]) {
        assert!(range.contains(x), "{range:?} {x}");
    }
    let inertia = m.best.inertia();
    for i in 0..3 {
        for j in 0..3 {
            let exact = if i == j { 0.4 * 4.0 * PI / 3.0 } else { 0.0 };
            assert!((inertia[i][j] - exact).abs() < 3e-5, "{i} {j}: {}", inertia[i][j]);
        }
    }
    let block = Set::cuboid(v(0.0, 0.0, 0.0), v(1.0, 0.8, 0.6)).unwrap();
    let m = facets(&block, &cube(1.3), 5).moments();
    let exact = 0.48 / 12.0 * (0.8 * 0.8 + 0.6 * 0.6);
    assert!((m.inertia()[0].x - exact).abs() < 1e-13);
}

/// The hypergeometric series 2F1(a, b; c; x).
fn series(a: f64, b: f64, c: f64, x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for n in 0..60 {
        let n = f64::from(n);
        term *= (a + n) * (b + n) / (c + n) / (n + 1.0) * x;
        sum += term;
    }
    sum
}

/// Area and volume of the ring cyclide whose spheres of radius m - c cos t are centred on the ellipse of half
/// axes a and b, b^2 = a^2 - c^2. Its parallel surfaces are cyclides of another m, so the area is the volume's
/// derivative by m. With x = (c/a)^2 the area is 4 pi^2 a m F(-1/2, -1/2; 1; x), and the volume is
/// 2 pi^2 a (m^2 F(-1/2, -1/2; 1; x) plus c^2/2 F(-1/2, 1/2; 2; x)); the first series is the perimeter of an
/// ellipse, the torus has x = 0. Both were found from the integrals over the parametric form, with which they
/// agree to 15 digits.
fn cyclide(a: f64, m: f64, c: f64) -> (f64, f64) {
    let x = (c / a).powi(2);
    let ring = series(-0.5, -0.5, 1.0, x);
    let bulge = 0.5 * c * c * series(-0.5, 0.5, 2.0, x);
    (4.0 * PI * PI * a * m * ring, 2.0 * PI * PI * a * (m * m * ring + bulge))
}

#[test]
fn the_cyclide_has_its_closed_forms() {
    // By quadrature of the parametric form: a = 2, c = 0.8, m = 1.2.
    let (area, volume) = cyclide(2.0, 1.2, 0.8);
    assert!((area - 98.577_648_511_504_5).abs() < 1e-11, "{area}");
    assert!((volume - 71.521_695_640_187_6).abs() < 1e-11, "{volume}");

    let z = axis(v(0.01, 0.02, 0.03), v(0.1, 0.2, 1.0));
    for (a, m, c) in [(1.0, 0.3, 0.1), (0.9, 0.45, 0.2)] {
        let (area, volume) = cyclide(a, m, c);
        let along = z.direction.perpendicular();
        let set = Set::new(&Primitive::cyclide(z, along, a, m, c).unwrap());
        let whole = mass(&set, &cube(1.8), &IntegralOptions::to_depth(6)).unwrap();
        assert!(whole.bracket.volume().contains(volume), "{:?}", whole.bracket.volume());
        assert!((whole.best.volume() - volume).abs() < 1e-4 * volume, "{a} {m} {c}");
        let error = |depth| {
            let f = facets(&set, &cube(1.8), depth);
            let found = moldloft_mesh::measure(&f.mesh);
            ((volume - found.volume) / volume, (area - found.area) / area)
        };
        let (coarse, fine) = (error(6), error(7));
        assert!(fine.0 < 1e-3 && fine.1 < 5e-4, "{fine:?}");
        for rate in [(coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2()] {
            assert!((rate - 2.0).abs() < 0.25, "{coarse:?} {fine:?}");
        }
    }
}

#[test]
fn best_values_are_of_high_order() {
    let z = axis(v(0.02, 0.01, 0.03), v(0.1, 0.2, 1.0));
    let solid = |p: Result<Primitive, FieldError>| Set::new(&p.unwrap());
    let other = axis(z.point, z.direction.perpendicular());
    let crossed = solid(Primitive::cylinder(z, 0.9)) & solid(Primitive::cylinder(other, 0.9));
    let cases = [
        ("sphere", solid(Primitive::sphere(z.point, 1.0)), 4.0 * PI / 3.0, 4.0 * PI),
        (
            "torus",
            solid(Primitive::torus(z, 0.9, 0.4)),
            2.0 * PI * PI * 0.9 * 0.16,
            4.0 * PI * PI * 0.9 * 0.4,
        ),
        ("steinmetz", crossed, 16.0 / 3.0 * 0.729, 16.0 * 0.81),
    ];
    for (name, set, volume, area) in cases {
        let errors = |depth| {
            let f = facets(&set, &cube(1.5), depth);
            [f.moments().volume() / volume - 1.0, f.area() / area - 1.0]
        };
        let (coarse, fine) = (errors(4), errors(6));
        println!("{name}: {coarse:?} {fine:?}");
        for k in 0..2 {
            let rate = (coarse[k] / fine[k]).abs().log2() / 2.0;
            // The edges of the last cross where its cylinders touch, which costs orders.
            let most = if name == "steinmetz" { 2.0 } else { 3.0 };
            assert!(rate > most, "{name}: {coarse:?} {fine:?}, {rate}");
            assert!(fine[k].abs() < 1e-7, "{name}: {fine:?}");
        }
    }
}

#[test]
fn the_t_piece_weighs_what_it_should() {
    let m = mass(&t_piece(), &cube(4.0), &IntegralOptions::to_depth(7)).unwrap();
    assert!((m.best.volume() - 25.097).abs() < 1e-3, "{}", m.best.volume());
    assert!(m.bracket.volume().contains(25.097) && m.bracket.volume().width() < 2.0);
    // The model is symmetric in y.
    assert!(m.best.centroid().y.abs() < 1e-5);
}

type D = Dual<1>;

/// A bored ball with the radius and height of the bore as parameters.
fn bored<T: Real>(r: T, h: T) -> Set<T> {
    let centre = Vec3::new(T::from(0.02), T::from(0.01), h);
    let ball = Set::new(&Primitive::sphere(centre, T::from(1.0)).unwrap());
    let line = Axis { point: Vec3::of(0.1, 0.0, 0.0), direction: Vec3::of(0.1, 0.2, 1.0) };
    let line = Axis { direction: line.direction / line.direction.norm(), ..line };
    let bore = Set::new(&Primitive::cylinder(line, r).unwrap());
    let floor = Set::new(
        &Primitive::plane(Vec3::of(0.0, 0.1, -1.0), Vec3::new(T::zero(), T::zero(), h - 0.4))
            .unwrap(),
    );
    (ball - bore) & floor
}

#[test]
fn derivatives_equal_central_differences() {
    let (r, h) = (0.5, 0.05);
    let f = facets(&bored(r, h), &cube(1.5), 7);
    assert!(f.worst_vertex() < 1e-12, "{}", f.worst_vertex());
    for k in 0..2 {
        let seed = |x: f64, j: usize| if j == k { D::seeded(x, 0) } else { D::from(x) };
        let lifted = f.lifted(&bored(seed(r, 0), seed(h, 1))).unwrap();
        assert!(
            lifted
                .mesh
                .re()
                .positions()
                .iter()
                .zip(f.mesh.positions())
                .all(|(a, b)| a.distance(*b) < 1e-12)
        );
        // The same vertices followed to both sides: positions by Newton from the old ones.
        let step = 1e-4;
        let moved = |sign: f64| {
            let (r, h) = if k == 0 { (r + sign * step, h) } else { (r, h + sign * step) };
            let set = bored(r, h);
            let mut g = f.clone();
            for _ in 0..4 {
                let mut leaves = set.leaves();
                leaves.extend_from_slice(&f.leaves[f.own_leaves..]);
                g.leaves = leaves;
                g.mesh = g.lifted(&set).unwrap().mesh;
            }
            let moments = g.moments();
            (g.mesh, moments)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let mut corners = 0;
        for (j, p) in lifted.mesh.positions().iter().enumerate() {
            corners += usize::from(f.surfaces[j].len() == 3);
            let centred = (plus.0.positions()[j] - minus.0.positions()[j]) / (2.0 * step);
            let exact = p.map(|x| x.eps[0]);
            assert!(centred.distance(exact) < 1e-6, "{j}: {centred:?} {exact:?}");
        }
        assert!(corners == 0 && f.surfaces.iter().any(|s| s.len() == 2));
        let centred = (plus.1.volume() - minus.1.volume()) / (2.0 * step);
        let exact = lifted.moments.volume().eps[0];
        assert!((centred - exact).abs() < 1e-6, "{centred} {exact}");
        let centred = (plus.1.centroid() - minus.1.centroid()) / (2.0 * step);
        assert!(centred.distance(lifted.moments.centroid().map(|x| x.eps[0])) < 1e-6);
        let spin = |m: &moldloft_field::Moments<f64>| m.inertia()[0].x;
        let centred = (spin(&plus.1) - spin(&minus.1)) / (2.0 * step);
        assert!((centred - lifted.moments.inertia()[0].x.eps[0]).abs() < 1e-6);
    }
    let other = Set::new(&Primitive::sphere(Vec3::of(0.0, 0.0, 0.0), D::from(1.0)).unwrap());
    assert!(matches!(f.lifted(&other), Err(FieldError::Degenerate { .. })));
}

#[test]
fn the_volume_of_a_ball_grows_by_its_area() {
    let ball = |r: D| Set::new(&Primitive::sphere(Vec3::of(0.1, 0.0, 0.0), r).unwrap());
    let f = facets(&ball(D::from(1.0)).re(), &cube(1.5), 7);
    let lifted = f.lifted(&ball(D::seeded(1.0, 0))).unwrap();
    assert!((lifted.moments.volume().eps[0] - 4.0 * PI).abs() < 1e-4);
    for p in lifted.mesh.positions() {
        let speed = p.map(|x| x.eps[0]).norm();
        assert!((speed - 1.0).abs() < 1e-12);
    }
}

#[test]
fn bad_requests_are_refused() {
    let ball = Set::new(&Primitive::sphere(Vec3::<f64>::zero(), 1.0).unwrap());
    assert!(matches!(bracket(&ball, &cube(2.0), 30), Err(FieldError::TooFine { .. })));
    assert!(matches!(bracket(&ball, &cube(0.0), 3), Err(FieldError::EmptyBox { .. })));
}
