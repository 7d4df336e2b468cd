//! Convex hulls of cylinders, cones, polyhedra, balls and tori beside closed forms and support functions.

use crate::common::{axis, v};
use moldloft_field::{
    FacetOptions, FieldError, IntegralOptions, Primitive, Resolution, Set, around, convex_hull,
    facet, mass, minkowski_sum,
};
use moldloft_num::Vec3;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

fn half(normal: Vec3, at: Vec3) -> Set {
    Set::new(&Primitive::plane(normal, at).unwrap())
}

fn ball(at: Vec3, r: f64) -> Set {
    Set::new(&Primitive::sphere(at, r).unwrap())
}

fn ring(at: Vec3, up: Vec3, r: f64, tube: f64) -> Set {
    Set::new(&Primitive::torus(axis(at, up), r, tube).unwrap())
}

/// A cylinder or cone from one disc to another above it.
fn upright(foot: Vec3, up: Vec3, height: f64, [r, q]: [f64; 2]) -> Set {
    let side = match r == q {
        true => Primitive::cylinder(axis(foot, up), r),
        false => {
            let apex = foot + up * (height * r / (r - q));
            Primitive::cone(axis(apex, up), 2.0 * ((r - q).abs() / height).atan())
        }
    };
    Set::new(&side.unwrap()) & half(-up, foot) & half(up, foot + up * height)
}

fn close(set: &Set, exact: f64) {
    let over = around(set).unwrap().unwrap();
    let found = mass(set, &over, &IntegralOptions::default()).unwrap();
    let (range, best) = (found.bracket.volume(), found.best.volume());
    assert!(range.low <= exact + 1e-12 && exact - 1e-12 <= range.high, "{range:?} {exact}");
    assert!((best - exact).abs() < 1e-7 * (1.0 + exact), "{best} {exact}");
}

#[test]
fn hulls_about_one_axis_have_their_closed_forms() {
    let (o, up) = (v(0.3, -0.2, 0.1), v(1.0, 2.0, -0.5).normalized().unwrap());
    // A disc between two halves of the ring's outer side (Pappus).
    let outer = PI * 0.125 * 2.0 * PI * (2.0 + 4.0 * 0.5 / (3.0 * PI));
    close(&convex_hull(&[ring(o, up, 2.0, 0.5)]).unwrap(), 4.0 * PI + outer);
    let pin = upright(o, up, 1.0, [1.0, 1.0]);
    let post = convex_hull(&[pin.clone(), ball(o + up * 2.0, 1.0)]).unwrap();
    close(&post, PI * (2.0 + 2.0 / 3.0));
    // Two cylinders, one above the other: a piece of a cone from the lower to the top.
    let tower = convex_hull(&[pin.clone(), upright(o + up * 3.0, up, 1.0, [0.5, 0.5])]).unwrap();
    close(&tower, PI * (1.0 + 3.0 * (1.0 + 0.5 + 0.25) / 3.0));
    // A ball on a wide disc: its tangent cone, and the cap above the circle where they touch.
    let (r, height): (f64, f64) = (1.5, 2.0);
    let plate = upright(o - up * 0.1, up, 0.1, [r, r]);
    let dome = convex_hull(&[plate, ball(o + up * height, 0.5)]).unwrap();
    // The tangent n = (cos, sin) with n.(r, 0) = n.(0, height) + 0.5.
    let long = r.hypot(height);
    let turn = (height / r).atan();
    let angle = (0.5 / long).acos() - turn;
    let (sin, cos) = angle.sin_cos();
    let (rho, h) = (0.5 * cos, height + 0.5 * sin);
    let frustum = PI * h * (r * r + r * rho + rho * rho) / 3.0;
    let cap = 0.5 * (1.0 - sin);
    close(&dome, PI * r * r * 0.1 + frustum + PI * cap * cap * (0.5 - cap / 3.0));
    // Radii and heights of cylinders add.
    let sum = minkowski_sum(&pin, &upright(o, up, 3.0, [0.5, 0.5])).unwrap();
    close(&sum, PI * 2.25 * 4.0);
}

#[test]
fn what_has_no_closed_form_is_refused() {
    let (o, up) = (Vec3::zero(), v(0.0, 0.0, 1.0));
    let pin = upright(o, up, 1.0, [1.0, 1.0]);
    for sets in [
        vec![pin.clone(), ball(v(3.0, 0.0, 2.0), 1.0)],
        vec![pin.clone(), upright(o, v(1.0, 0.0, 0.0), 1.0, [1.0, 1.0])],
        vec![pin.clone(), ring(v(3.0, 0.0, 0.0), up, 2.0, 0.5)],
    ] {
        assert!(matches!(convex_hull(&sets), Err(FieldError::NoHull { .. })));
    }
    let summed = minkowski_sum(&ring(o, up, 2.0, 0.5), &ball(o, 1.0));
    assert!(matches!(summed, Err(FieldError::NoHull { .. })), "a torus is not convex");
}

/// A circle by centre and radius, with balls of radius `tube`.
struct Circle {
    centre: Vec3,
    radius: f64,
    tube: f64,
}

/// Points beyond a plane of support are outside of a hull, mixtures of points of the circles inside.
fn beside_support(hull: &Set, circles: &[Circle], up: Vec3, random: &mut Random) {
    let e = up.perpendicular().normalized().unwrap();
    let f = up.cross(e);
    let direction = |random: &mut Random| loop {
        let p = v(random.signed(), random.signed(), random.signed());
        if p.norm() <= 1.0 && p.norm() > 0.1 {
            return p / p.norm();
        }
    };
    let support = |n: Vec3| {
        let of = |c: &Circle| n.dot(c.centre) + c.radius * n.cross(up).norm() + c.tube;
        circles.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let normals: Vec<(Vec3, f64)> = (0..3000)
        .map(|_| {
            let n = direction(random);
            (n, support(n))
        })
        .collect();
    let mut beyond = 0;
    for _ in 0..1500 {
        let p = v(random.between(-4.0, 4.0), random.between(-4.0, 4.0), random.between(-4.0, 4.0));
        if normals.iter().any(|(n, most)| n.dot(p) > most + 1e-9) {
            beyond += 1;
            assert!(hull.value(p) > 0.0, "{p:?}");
        }
    }
    assert!(beyond > 100);
    let middle = circles.iter().fold(Vec3::zero(), |s, c| s + c.centre) / circles.len() as f64;
    for _ in 0..1500 {
        let mut p = Vec3::zero();
        let shares: Vec<f64> = circles.iter().map(|_| random.unit().powi(4)).collect();
        let whole: f64 = shares.iter().sum();
        for (c, share) in circles.iter().zip(&shares) {
            let (sin, cos) = random.between(0.0, 2.0 * PI).sin_cos();
            let rim = c.centre + (e * cos + f * sin) * c.radius + direction(random) * c.tube;
            p += rim * (share / whole);
        }
        let p = middle + (p - middle) * 0.9999;
        assert!(hull.value(p) < 0.0, "{p:?} {}", hull.value(p));
    }
}

#[test]
fn upright_parts_of_any_height_have_the_hull_of_their_support_function() {
    let mut random = Random::new(41);
    for _ in 0..rounds(5, 200) {
        let up = v(random.signed(), random.signed(), random.signed()).normalized().unwrap();
        let (mut sets, mut circles) = (Vec::new(), Vec::new());
        for _ in 0..2 + random.below(3) {
            let mut any = || random.between(-1.5, 1.5);
            let foot = v(any(), any(), any());
            if random.chance(30) {
                let at = |random: &mut Random| {
                    foot + v(random.signed(), random.signed(), random.signed())
                };
                let corners = [(); 4].map(|()| at(&mut random));
                sets.push(Set::tetrahedron(corners).unwrap());
                circles.extend(corners.map(|centre| Circle { centre, radius: 0.0, tube: 0.0 }));
                continue;
            }
            let (height, r) = (random.between(0.3, 2.0), random.between(0.2, 1.0));
            let q = if random.chance(50) { r } else { random.between(0.1, 1.0) };
            sets.push(upright(foot, up, height, [r, q]));
            circles.push(Circle { centre: foot, radius: r, tube: 0.0 });
            circles.push(Circle { centre: foot + up * height, radius: q, tube: 0.0 });
        }
        beside_support(&convex_hull(&sets).unwrap(), &circles, up, &mut random);
    }
}

#[test]
fn parts_about_one_axis_have_the_hull_of_their_support_function() {
    let mut random = Random::new(42);
    for _ in 0..rounds(5, 200) {
        let up = v(random.signed(), random.signed(), random.signed()).normalized().unwrap();
        let o = v(random.signed(), random.signed(), random.signed());
        let (mut sets, mut circles) = (Vec::new(), Vec::new());
        for k in 0..1 + random.below(4) {
            let at = o + up * random.between(-1.5, 1.5);
            let r = random.between(0.3, 1.2);
            match if k == 0 { 1 + random.below(2) } else { random.below(3) } {
                0 => {
                    sets.push(ball(at, r));
                    circles.push(Circle { centre: at, radius: 0.0, tube: r });
                }
                1 => {
                    let tube = r * random.between(0.1, 0.9);
                    sets.push(ring(at, up, r, tube));
                    circles.push(Circle { centre: at, radius: r, tube });
                }
                _ => {
                    let (height, q) = (random.between(0.3, 2.0), random.between(0.1, 1.0));
                    sets.push(upright(at, up, height, [r, q]));
                    circles.push(Circle { centre: at, radius: r, tube: 0.0 });
                    circles.push(Circle { centre: at + up * height, radius: q, tube: 0.0 });
                }
            }
        }
        let hull = convex_hull(&sets).unwrap();
        beside_support(&hull, &circles, up, &mut random);
        let over = around(&hull).unwrap().unwrap();
        let made = facet(&hull, &over, &FacetOptions::new(Resolution::Level(5))).unwrap();
        let report = made.mesh.report();
        assert!(report.closed && report.manifold && report.oriented, "{report:?}");
        assert!(made.undecided.is_empty(), "{:?}", made.undecided);
    }
}
