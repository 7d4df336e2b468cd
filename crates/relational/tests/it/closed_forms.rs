//! Shapes whose numbers are known: the paper's hull, circles, spheres, cylinders, mirror images.

use crate::common::{HULL, scene};
use moldloft_num::{Order, Vec3, find_root, gauss_legendre};
use moldloft_registry::{SurfaceRef, Value};
use std::f64::consts::PI;

fn at(s: &SurfaceRef<f64>, u: f64, v: f64) -> Vec3 {
    s.jet(u, v, Order::Zero).p
}

fn near(p: Vec3, x: f64, y: f64, z: f64, accuracy: f64) {
    assert!(p.distance(Vec3::of(x, y, z)) <= accuracy, "{p:?} and {:?}", (x, y, z));
}

/// Area by Gauss quadrature on 8 x 8 parts.
fn area(s: &SurfaceRef<f64>) -> f64 {
    let mut sum = 0.0;
    for i in 0..8 {
        for j in 0..8 {
            let part = |k: i32| (f64::from(k) / 8.0, f64::from(k + 1) / 8.0);
            let ((a, b), (c, d)) = (part(i), part(j));
            sum += gauss_legendre(a, b, |u| {
                gauss_legendre(c, d, |v| {
                    let jet = s.jet(u, v, Order::First);
                    jet.u.cross(jet.v).norm()
                })
            });
        }
    }
    sum
}

#[test]
fn the_hull_of_the_paper() {
    let scene = scene(HULL);
    let hull = scene.surface("hull");
    near(at(hull, 0.5, 0.25), 8.6422, 2.9203, -0.2053, 1e-4);
    near(at(hull, 0.5, 0.5), 15.6002, 4.3938, -0.1043, 1e-4);
    near(at(hull, 0.5, 0.75), 22.7195, 4.4203, 0.2042, 1e-4);
    near(at(hull, 0.0, 0.25), 7.2339, 3.1440, 2.9322, 1e-4);
    near(at(hull, 1.0, 0.25), 9.7675, 0.0, -1.1976, 1e-4);
    let sheer = (0..=10_000).map(|k| at(hull, 0.0, f64::from(k) / 1e4).y).fold(0.0, f64::max);
    assert!((sheer - 5.0284).abs() < 1e-4, "{sheer}");
    // The waterline begins on the stem and ends on the keel line.
    let u = find_root(|u| at(hull, u, 0.0).z, 0.0, 1.0).unwrap();
    let v = find_root(|v| at(hull, 1.0, v).z, 0.5, 1.0).unwrap();
    assert!((at(hull, u, 0.0).x - 1.781).abs() < 1e-3);
    assert!((at(hull, 1.0, v).x - 29.167).abs() < 1e-3);
}

#[test]
fn arcs_are_circular() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint B(0, 2, 0); AbsPoint O(0, 0, 0); AbsPoint D(-1, 0, 0);
         AbsPoint E(1, 1, 0); AbsPoint G(-1, 1, 0);
         Arc about(A, O, B, 2); Arc half(A, D, B, 5); Arc round(A, O, B, 6); Arc from(A, E, D, 3);
         Arc to(A, G, D, 4);",
    );
    for (name, angle) in [("about", 0.5), ("half", 1.0), ("round", 2.0), ("from", 1.0), ("to", 1.0)]
    {
        let curve = scene.curve(name);
        for t in [0.0f64, 0.2, 0.5, 1.0] {
            let [p, d, _] = curve.jet(t, Order::First);
            let turned = angle * PI * t;
            near(p, turned.cos(), turned.sin(), 0.0, 1e-14);
            assert!((d.norm() - angle * PI).abs() < 1e-13, "{name}");
        }
    }
    assert_eq!(scene.curve("round").end_points(), [Some(scene.key("A")); 2]);
}

#[test]
fn a_turned_semicircle_is_a_sphere() {
    let scene = scene(
        "AbsPoint S(0, 0, -2); AbsPoint N(0, 0, 2); AbsPoint X(1, 0, 0); Arc meridian(S, N, X, 5);
         Line axis(S, N); RevSurf globe(meridian, axis); float l = length(meridian);",
    );
    let globe = scene.surface("globe");
    for (u, v) in [(0.1, 0.2), (0.5, 0.5), (0.8, 0.9)] {
        let jet = globe.jet(u, v, Order::First);
        assert!((jet.p.norm() - 2.0).abs() < 1e-14);
        assert!(jet.normal().cross(jet.p).norm() < 1e-13);
    }
    assert!((area(globe) - 16.0 * PI).abs() < 1e-9);
    near(at(globe, 0.5, 0.25), 0.0, 2.0, 0.0, 1e-15);
    assert_eq!(at(globe, 0.3, 1.0), at(globe, 0.3, 0.0));
    let Value::Number(length) = scene.value("l") else { panic!("a number") };
    assert!((length - 2.0 * PI).abs() < 1e-11);
}

#[test]
fn a_moved_circle_is_a_cylinder() {
    let scene = scene(
        "AbsPoint A(1, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 1, 0); AbsPoint C(1, 0, 3);
         Arc c(A, O, B, 6); Line l(A, C); TranSurf wall(c, l); Line axis(O, B);
         MirrSurf image(wall, \"z=0\");",
    );
    let wall = scene.surface("wall");
    assert!((area(wall) - 6.0 * PI).abs() < 1e-10);
    near(at(wall, 0.25, 0.5), 0.0, 1.0, 1.5, 1e-15);
    let image = scene.surface("image");
    near(at(image, 0.25, 0.5), 0.0, 1.0, -1.5, 1e-15);
    let (n, m) = (wall.jet(0.1, 0.5, Order::First), image.jet(0.1, 0.5, Order::First));
    near(n.normal() + m.normal(), 0.0, 0.0, 0.0, 1e-15);
    assert_eq!(image.image_of(), Some((scene.key("wall"), true)));
}

#[test]
fn points_are_where_they_should_be() {
    let scene = scene(
        "AbsPoint A(1, 2, 3); MirrPoint m(A, \"y=0\"); AbsPoint O(0, 0, 0); MirrPoint c(A, O);
         AbsPoint Z(0, 0, 5); Line axis(O, Z); MirrPoint h(A, axis); ProjPoint p(A, axis);
         ZPlane deck(2); ProjPoint q(A, deck); OffsetPlane up(deck, 0.5); MirrPoint r(A, up);
         RelPoint d(A, 0.5, 0, -1); AbsBead b(axis, 1.5); RelBead e(b, -0.5);
         TwoPointPlane t(O, Z); ThreePointPlane w(O, A, Z); ProjPoint s(A, t);",
    );
    for (name, x, y, z) in [
        ("m", 1.0, -2.0, 3.0),
        ("c", -1.0, -2.0, -3.0),
        ("h", -1.0, -2.0, 3.0),
        ("p", 0.0, 0.0, 3.0),
        ("q", 1.0, 2.0, 2.0),
        ("r", 1.0, 2.0, 2.0),
        ("d", 1.5, 2.0, 2.0),
        ("b", 0.0, 0.0, 7.5),
        ("e", 0.0, 0.0, 5.0),
        ("s", 1.0, 2.0, 0.0),
    ] {
        near(scene.point(name).xyz, x, y, z, 1e-15);
    }
}

#[test]
fn degrees_are_lowered_to_what_the_points_allow() {
    let scene = scene(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 4, 0); AbsPoint C(4, 0, 0); BCurve line({A, B}, 25);
         BCurve bend({A, B, C}); CCurve parabola({A, B, C}); CCurve chord({A, C});
         CCurve poly({A, B, C}, 1);",
    );
    near(scene.curve("line").jet(0.5, Order::Zero)[0], 1.0, 2.0, 0.0, 1e-15);
    near(scene.curve("bend").jet(0.5, Order::Zero)[0], 2.0, 2.0, 0.0, 1e-15);
    near(scene.curve("parabola").jet(0.25, Order::Zero)[0], 1.0, 3.0, 0.0, 1e-15);
    near(scene.curve("poly").jet(0.25, Order::Zero)[0], 1.0, 2.0, 0.0, 1e-15);
    assert_eq!(scene.curve("poly").breaks(), [0.5]);
}

#[test]
fn parts_of_surfaces_lie_on_them() {
    let text = moldloft_relational::rows().into_iter().find(|r| r.name == "SubSurf").unwrap();
    let scene = scene(&text.example);
    let (whole, part) = (scene.surface("S"), scene.surface("part"));
    let corner = |name: &str| scene.point(name).xyz;
    for (u, v, name) in [(0.0, 0.0, "p"), (1.0, 0.0, "q"), (1.0, 1.0, "r"), (0.0, 1.0, "s")] {
        assert!(at(part, u, v).distance(corner(name)) < 1e-15);
    }
    // A point of four straight sides is the bilinear one.
    let south = scene.curve("south").on_surface(0.5, Order::Zero).unwrap()[0];
    near(at(whole, south.x, south.y) - at(part, 0.5, 0.0), 0.0, 0.0, 0.0, 1e-15);
    assert!(at(scene.surface("fan"), 0.3, 1.0).distance(corner("r")) < 1e-15);
    assert!(at(scene.surface("three"), 0.0, 0.7).distance(corner("p")) < 1e-15);
}

#[test]
fn contours_and_rows_of_numbers() {
    let scene = scene(
        "XContours stations(0, 10, 1.8, 2.735); AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0);
         Line l(A, B); farray s = uniform(0, 1, 5); curve p = distc(l, s);
         farray t = cosine(0, 1, 9); farray d = d_tanh(0, 1, 0.07, 0.01, 60);",
    );
    let Value::Contours(c) = scene.value("stations") else { panic!("contours") };
    assert!(c.axis == 0 && c.values.len() == 11 && (c.values[10] - 29.15).abs() < 1e-14);
    let Value::Vectors(p) = scene.value("p") else { panic!("points") };
    assert_eq!(p.at(3), Vec3::of(3.0, 0.0, 0.0));
    let Value::Numbers(t) = scene.value("t") else { panic!("numbers") };
    assert!((t.items[1] - 0.0380602337).abs() < 1e-10);
    let Value::Numbers(d) = scene.value("d") else { panic!("numbers") };
    assert!((d.items[29] - 0.7203569806627).abs() < 1e-8 && d.items[59] == 1.0);
}
