//! Primitives: closed forms, laws of arithmetic and derivatives, ranges, identity.

use moldloft_field::{Affine, FieldError, Form, Interval, Oracle, Primitive};
use moldloft_num::{Axis, Box3, Dual, Field, Plane, Real, Vec3};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::of(x, y, z)
}

fn axis(point: Vec3, direction: Vec3) -> Axis<f64> {
    Axis { point, direction: direction.normalized().unwrap() }
}

/// A few dozen points spread over [-2, 2]^3 (additive recurrence, Roberts 2018).
fn points() -> impl Iterator<Item = Vec3> {
    (1..60).map(|k| {
        let part = |a: f64| 4.0 * (f64::from(k) * a).fract() - 2.0;
        v(part(0.819_172_513), part(0.671_043_607), part(0.549_700_478))
    })
}

/// One primitive of every operation.
fn zoo() -> Vec<(&'static str, Primitive)> {
    let [x, y, z] = Primitive::axes();
    let a = axis(v(0.1, -0.2, 0.3), v(1.0, 2.0, 2.0));
    vec![
        ("plane", Primitive::plane(v(1.0, 2.0, -2.0), v(0.5, 0.0, 0.0)).unwrap()),
        ("sphere", Primitive::sphere(v(0.3, 0.0, -0.4), 1.2).unwrap()),
        ("sphere distance", Primitive::sphere_distance(v(0.3, 0.0, -0.4), 1.2).unwrap()),
        ("cylinder", Primitive::cylinder(a, 0.7).unwrap()),
        ("cylinder distance", Primitive::cylinder_distance(a, 0.7).unwrap()),
        ("cone", Primitive::cone(a, 0.8).unwrap()),
        ("torus", Primitive::torus(a, 1.1, 0.4).unwrap()),
        ("cyclide", Primitive::cyclide(a, v(1.0, 0.0, 0.0), 2.0, 0.5, 0.2).unwrap()),
        ("wave", &z + (&x * 2.0).sin() * 0.5),
        ("cos exp", x.cos() * y.exp() - &z),
        ("rational", (x.power(3) - &y * &z) / 3.0),
        ("s_sqrt", (x.power(2) + y.power(2) - 1.7).s_sqrt()),
        ("sqrt", (x.power(4) + z.power(2) + 0.1).sqrt()),
        ("atan2", (&y * 1.5 + 0.1).atan2(&(&x - 0.2))),
        ("min max abs", x.min(&y).max(&(-&z)) + (&x - &y).abs() * y.sign()),
        ("fifth", (&x + &y * 0.5).power(5) - z.power(3) * 2.0),
    ]
}

#[test]
fn gradients_and_hessians_equal_central_differences() {
    let h = 1e-5;
    for (name, f) in zoo() {
        for p in points() {
            let exact = f.hessian(p);
            let gradient = f.gradient(p);
            assert_eq!((exact.value, exact.slope), (gradient.value, gradient.slope), "{name}");
            assert_eq!(f.value(p).to_bits(), gradient.value.to_bits(), "{name}");
            for k in 0..3 {
                let mut step = Vec3::zero();
                *[&mut step.x, &mut step.y, &mut step.z][k] = h;
                let (high, low) = (f.gradient(p + step), f.gradient(p - step));
                let slope = (high.value - low.value) / (2.0 * h);
                let size = 1.0 + exact.second[k].norm();
                assert!((slope - exact.slope[k]).abs() < 1e-7 * size * size, "{name} {p:?} {k}");
                let second = (high.slope - low.slope) / (2.0 * h);
                let error = second.distance(exact.second[k]);
                assert!(error < 1e-6 * size * size, "{name} {p:?} {k}: {error}");
            }
        }
    }
}

#[test]
fn ranges_contain_all_values_and_slopes() {
    for (name, f) in zoo() {
        for (k, c) in points().enumerate() {
            let half = [0.5, 0.05, 1e-3][k % 3];
            let b = Box3 { low: c - v(half, half, half), high: c + v(half, half, half) };
            let range = f.gradient_range(&b);
            assert_eq!(range.value, f.range(&b));
            for q in points() {
                let p = c + q * (half / 2.0);
                let g = f.gradient(p);
                assert!(range.value.contains(g.value), "{name}: {} in {range:?}", g.value);
                for axis in 0..3 {
                    assert!(range.slope[axis].contains(g.slope[axis]), "{name}: slope {axis}");
                }
            }
        }
    }
}

#[test]
fn the_mean_value_form_is_of_second_order() {
    // x^2 - 2 x y + y^2 - z at a point where the plain form is of first order.
    let [x, y, z] = Primitive::axes();
    let f = x.power(2) - &x * &y * 2.0 + y.power(2) - z;
    let excess = |h: f64| {
        let b = Box3 { low: v(1.0, 1.0, 0.0), high: v(1.0 + h, 1.0 + h, h) };
        // True range: [-h, h^2].
        f.range(&b).width() - (h + h * h)
    };
    let rate = (excess(0.02) / excess(0.01)).log2();
    assert!((rate - 2.0).abs() < 0.1, "{rate}");
}

#[test]
fn planes_and_reals_fold() {
    let [x, y, _] = Primitive::<f64>::axes();
    let sum = &x * 3.0 + &y - 2.0;
    assert!(matches!(sum.form(), Form::Plane(_)) && sum.degree() == 1);
    assert_eq!(sum.value(v(1.0, 4.0, 9.0)), 5.0);
    assert!(matches!((&x - &x).form(), Form::Real(c) if *c == 0.0));
    assert!(matches!(Primitive::real(2.0).exp().form(), Form::Real(c) if *c == 2f64.exp()));
    assert!((-(-x.abs())).same(&x.abs()));
}

#[test]
fn degrees_follow_the_rule() {
    let [x, y, z] = Primitive::<f64>::axes();
    let quadric = x.power(2) + &y * &z - 1.0;
    let cases = [
        (Primitive::real(3.0), 0),
        (&x + 2.0, 1),
        (quadric.clone(), 2),
        (&quadric * &quadric * 0.6 - x.power(3), 4),
        (quadric.power(4), 8),
        (quadric.sin(), 3),
        (-&quadric / 2.0, 2),
        (Primitive::torus(axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)), 2.0, 0.5).unwrap(), 4),
    ];
    for (f, degree) in cases {
        assert_eq!(f.degree(), degree, "{f:?}");
    }
}

#[test]
fn forms_remember_and_move() {
    let ball = Primitive::sphere(v(1.0, 0.0, 0.0), 2.0).unwrap();
    let turn = Affine::rotation(&axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)), 0.5 * f64::acos(-1.0));
    let grow = Affine::scaling(v(0.0, 0.0, 0.0), 3.0);
    let moved = ball.mapped(&turn).unwrap().mapped(&grow).unwrap();
    let Form::Sphere { centre, radius } = moved.form() else { panic!("{moved:?}") };
    assert!(centre.distance(v(0.0, 3.0, 0.0)) < 1e-14 && (radius - 6.0).abs() < 1e-14);
    let long = ball.mapped(&Affine::stretch(&axis(v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0)), 2.0));
    assert_eq!(*long.unwrap().form(), Form::General);
}

#[test]
fn a_mapped_primitive_has_the_old_value_at_the_image() {
    let maps = [
        Affine::translation(v(0.3, -0.4, 0.5)),
        Affine::rotation(&axis(v(1.0, 0.0, 0.0), v(1.0, 2.0, 3.0)), 0.7),
        Affine::reflection(&Plane { point: v(0.1, 0.2, 0.3), normal: v(0.0, 0.6, 0.8) }),
        Affine::scaling(v(1.0, 1.0, 1.0), 1.7),
        Affine::stretch(&axis(v(0.2, 0.0, 0.0), v(1.0, 1.0, 0.0)), 0.4),
    ];
    for (name, f) in zoo() {
        for (k, map) in maps.iter().enumerate() {
            let g = f.mapped(map).unwrap();
            for p in points() {
                let (old, new) = (f.value(p), g.value(map.apply(p)));
                let slack = 1e-12 * (1.0 + f.gradient(p).slope.norm());
                // s_sqrt has no bound on its slope.
                let slack = if name == "s_sqrt" { 1e-6 } else { slack };
                assert!((old - new).abs() < slack, "{name} under map {k}: {old} {new}");
            }
        }
    }
    let flat = Affine::scaling(v(0.0, 0.0, 0.0), 0.0);
    let refused = Primitive::<f64>::real(1.0).mapped(&flat);
    assert_eq!(refused.unwrap_err(), FieldError::Degenerate { what: "map" });
}

#[test]
fn the_cyclide_is_dupins() {
    // Roots on the line of symmetry for a = 2, m = 0.5, c = 0.2: the tube is m - c thick about a,
    // and m + c about -a.
    let z = axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    let f = Primitive::cyclide(z, v(1.0, 0.0, 0.0), 2.0, 0.5, 0.2).unwrap();
    for x in [-2.7, -1.3, 1.7, 2.3] {
        assert!(f.value(v(x, 0.0, 0.0)).abs() < 1e-12, "{x}");
    }
    assert!(f.value(v(2.0, 0.0, 0.0)) < 0.0 && f.value(v(0.0, 0.0, 0.0)) > 0.0);
    // Without change it is the torus.
    let f = Primitive::cyclide(z, v(1.0, 0.0, 0.0), 2.0, 0.5, 0.0).unwrap();
    let torus = Primitive::torus(z, 2.0, 0.5).unwrap();
    for k in 0..20 {
        let (s, c) = (f64::from(k) * 0.7).sin_cos();
        let p = v((2.0 + 0.5 * c) * s, (2.0 + 0.5 * c) * c, 0.5 * s);
        assert!(torus.value(p).abs() < 1e-14 && f.value(p).abs() < 1e-12);
    }
}

#[test]
fn true_distances_are_distances() {
    let a = axis(v(0.1, -0.2, 0.3), v(1.0, 2.0, 2.0));
    let f = Primitive::cylinder_distance(a, 0.7).unwrap();
    for p in points() {
        assert!((f.value(p) - (p.distance(a.foot(p)) - 0.7)).abs() < 1e-14);
        assert!((f.gradient(p).slope.norm() - 1.0).abs() < 1e-12);
    }
    // Without a gradient of the distance the result is zero, not NaN.
    assert_eq!(f.gradient(a.point).slope.norm(), 0.0);
    // The direction of s_sqrt(f) on the surface is that of f.
    let [x, y, _] = Primitive::<f64>::axes();
    let rooted = (x.power(2) + y.power(2) - 1.0).s_sqrt();
    assert_eq!(rooted.gradient(v(1.0, 0.0, 0.0)).slope, v(2.0, 0.0, 0.0));
    assert_eq!(rooted.value(v(2.0, 1.0, 0.0)), 2.0);
}

#[test]
fn sheets_have_no_solid_side() {
    let ball = Primitive::sphere(Vec3::<f64>::zero(), 1.0).unwrap();
    let sheet = ball.abs();
    for p in points() {
        assert!(sheet.value(p) >= 0.0 && (-&sheet).value(p) <= 0.0);
    }
    assert_eq!(sheet.gradient(v(1.0, 0.0, 0.0)).slope, v(2.0, 0.0, 0.0));
    assert_eq!((Primitive::<f64>::real(0.0) * 1.0).sign().value(Vec3::zero()), -1.0);
}

#[test]
fn equality_is_of_structure_and_parts_are_shared() {
    let make = || Primitive::sphere(v(0.3, 0.0, -0.4), 1.2).unwrap();
    assert!(make().same(&make()));
    assert!(!make().same(&Primitive::sphere(v(0.3, 0.0, -0.4), 1.3).unwrap()));
    // A power tower of shared squares would be 2^60 nodes if parts were copied.
    let mut f = Primitive::<f64>::axes()[0].clone() * 0.999 + 0.0005;
    for _ in 0..60 {
        f = (&f * &f + &f) / 2.0;
    }
    let value = f.value(v(0.9, 0.0, 0.0));
    assert!(value > 0.0 && value < 1.0);
}

#[test]
fn long_chains_neither_overflow_nor_crawl() {
    let [x, y, _] = Primitive::<f64>::axes();
    let mut f = x.sin();
    for _ in 0..200_000 {
        f = f + y.cos();
    }
    assert!((f.value(v(0.0, 0.0, 0.0)) - 200_000.0).abs() < 1e-6);
    drop(f);
}

#[test]
fn dual_numbers_give_derivatives_by_parameters() {
    type D = Dual<1>;
    let r = D::seeded(1.5, 0);
    let centre = Vec3::lifted(v(0.2, 0.3, 0.1));
    let a = Axis { point: centre, direction: Vec3::lifted(v(0.0, 0.6, 0.8)) };
    let p = v(1.0, -0.3, 0.4);
    let f = Primitive::torus(a, r, D::from(0.4)).unwrap();
    let value = f.value(Vec3::lifted(p));
    let plain = |r: f64| {
        Primitive::torus(Axis { point: a.point.re(), direction: a.direction.re() }, r, 0.4).unwrap()
    };
    assert_eq!(value.re.to_bits(), plain(1.5).value(p).to_bits());
    assert_eq!(value.re.to_bits(), f.re().value(p).to_bits());
    assert!(f.re().same(&plain(1.5)));
    let h = 1e-6;
    let centred = (plain(1.5 + h).value(p) - plain(1.5 - h).value(p)) / (2.0 * h);
    assert!((value.eps[0] - centred).abs() < 1e-9);
}

/// The distance from a point by a formula of its own.
struct Foreign;

impl<T: Real> Field<T> for Foreign {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        (p.norm() - 1.0, p.normalized().unwrap_or_default())
    }

    moldloft_num::field_facts!(T: value_with_gradient, second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for Foreign {
    fn range(&self, over: &Box3) -> Interval {
        let centre = over.centre();
        let (d, r) = (centre.norm() - 1.0, over.diagonal() / 2.0 + 1e-9);
        Interval::new(d - r, d + r)
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        Arc::new(Foreign)
    }
}

#[test]
fn primitives_from_outside_take_part() {
    let f = Primitive::<f64>::user(Arc::new(Foreign));
    let map = Affine::scaling(v(0.0, 0.0, 0.0), 2.0);
    let g = f.mapped(&map).unwrap() * 2.0;
    assert_eq!(g.degree(), 200 - 100);
    assert_eq!(g.value(v(0.0, 4.0, 0.0)), 2.0);
    assert_eq!(g.gradient(v(0.0, 4.0, 0.0)).slope, v(0.0, 1.0, 0.0));
    let far = Box3 { low: v(5.0, 5.0, 5.0), high: v(6.0, 6.0, 6.0) };
    assert!(g.range(&far).low > 0.0);
    assert!(f.same(&f.clone()) && !f.same(&g));
}

#[test]
fn bad_arguments_are_refused() {
    let z = axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0));
    let nan = f64::NAN;
    let err = |p: Result<Primitive, FieldError>| p.unwrap_err();
    assert_eq!(
        err(Primitive::sphere(Vec3::zero(), 0.0)),
        FieldError::NotPositive { what: "radius", value: 0.0 }
    );
    assert_eq!(
        err(Primitive::sphere(v(nan, 0.0, 0.0), 1.0)),
        FieldError::NotFinite { what: "centre" }
    );
    assert_eq!(err(Primitive::cylinder(z, nan)), FieldError::NotFinite { what: "radius" });
    assert!(matches!(err(Primitive::cone(z, 3.2)), FieldError::NotPositive { .. }));
    assert!(matches!(
        err(Primitive::cyclide(z, v(1.0, 0.0, 0.0), 1.0, 0.2, 1.5)),
        FieldError::NotPositive { .. }
    ));
    assert_eq!(
        err(Primitive::plane(Vec3::zero(), Vec3::zero())),
        FieldError::Degenerate { what: "normal" }
    );
    let [x, y, _] = Primitive::<f64>::axes();
    assert_eq!(err(x.over(&Primitive::real(0.0))), FieldError::Division);
    assert!(x.over(&Primitive::real(2.0)).is_ok() && x.over(&y).is_ok());
    assert_eq!(err(x.to_power(0.5)), FieldError::Exponent { value: 0.5 });
    assert_eq!(x.to_power(3.0).unwrap().degree(), 3);
}
