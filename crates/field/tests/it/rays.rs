//! Rays: roots of all degrees, crossings of sets.

use crate::common::{axis, t_piece, v};
use moldloft_field::{Primitive, Ray, Set, roots};
use moldloft_num::Vec3;

fn ray(start: Vec3, direction: Vec3, length: f64) -> Ray {
    Ray { start, direction, length }
}

#[test]
fn roots_of_quadrics_and_quartics_are_exact() {
    let z = axis(Vec3::zero(), v(0.0, 0.0, 1.0));
    let x = ray(v(-3.0, 0.0, 0.0), v(1.0, 0.0, 0.0), 6.0);
    let cyclide = Primitive::cyclide(z, v(1.0, 0.0, 0.0), 2.0, 0.5, 0.2).unwrap();
    let found = roots(&cyclide, &x);
    for (t, exact) in found.iter().zip([0.3, 1.7, 4.7, 5.3]) {
        assert!((t - exact).abs() < 1e-12, "{found:?}");
    }
    assert_eq!(found.len(), 4);
    let ball = Primitive::sphere(Vec3::zero(), 1.0).unwrap();
    // A contact is one root; a miss has none.
    assert_eq!(roots(&ball, &ray(v(-3.0, 1.0, 0.0), v(1.0, 0.0, 0.0), 6.0)), [3.0]);
    assert!(roots(&ball, &ray(v(-3.0, 1.0 + 1e-9, 0.0), v(1.0, 0.0, 0.0), 6.0)).is_empty());
    // Outside the given interval.
    assert!(roots(&ball, &ray(v(-3.0, 0.0, 0.0), v(1.0, 0.0, 0.0), 1.5)).is_empty());
}

#[test]
fn roots_of_other_functions_are_all_found() {
    let [x, y, _] = Primitive::<f64>::axes();
    let wave = &y - (&x * 7.0).sin() * 0.5;
    let found = roots(&wave, &ray(v(0.0, 0.1, 0.0), v(1.0, 0.0, 0.0), 3.0));
    // sin 7 x = 0.2: two for each of the three whole waves, and the start of the fourth.
    let exact: Vec<f64> = (0..4)
        .flat_map(|k| {
            let (base, a) = (2.0 * std::f64::consts::PI * f64::from(k), 0.2f64.asin());
            [(base + a) / 7.0, (base + std::f64::consts::PI - a) / 7.0]
        })
        .filter(|t| *t <= 3.0)
        .collect();
    assert_eq!(found.len(), exact.len());
    for (t, e) in found.iter().zip(exact) {
        assert!((t - e).abs() < 1e-12, "{t} {e}");
    }
    // The torus is written with a square root; its quartic has the same roots.
    let a = axis(v(0.1, 0.2, 0.0), v(0.3, 0.1, 1.0));
    let torus = Primitive::torus(a, 1.0, 0.3).unwrap();
    let quartic = Primitive::cyclide(a, v(1.0, 0.0, 0.0), 1.0, 0.3, 0.0).unwrap();
    let across = v(1.0, 0.0, -0.3);
    let r = ray(v(0.1, 0.2, 0.0) - across * 2.0, across, 4.0);
    let (s, t) = (roots(&torus, &r), roots(&quartic, &r));
    assert!(s.len() == 4 && t.len() == 4, "{s:?} {t:?}");
    for (a, b) in s.iter().zip(&t) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let touch = roots(
        &((&x - 0.5).exp() + (-(&x - 0.5)).exp() - 2.0),
        &ray(Vec3::zero(), v(1.0, 0.0, 0.0), 1.0),
    );
    assert!(touch.len() == 1 && (touch[0] - 0.5).abs() < 1e-6, "{touch:?}");
}

#[test]
fn sets_are_entered_and_left() {
    let ball = |x: f64| Set::new(&Primitive::sphere(v(x, 0.0, 0.0), 1.0).unwrap());
    let x = ray(v(-4.0, 0.1, 0.0), v(1.0, 0.0, 0.0), 9.0);
    let h = (1.0f64 - 0.01).sqrt();
    let check = |set: &Set, expected: &[(f64, bool)]| {
        let hits = set.hits(&x);
        assert_eq!(hits.len(), expected.len(), "{hits:?}");
        for (hit, (at, enters)) in hits.iter().zip(expected) {
            assert!((hit.point.x - at).abs() < 1e-12 && hit.enters == *enters, "{hit:?}");
            assert_eq!(hit.normal.x < 0.0, *enters);
        }
    };
    check(&(ball(-0.5) | ball(0.5)), &[(-0.5 - h, true), (0.5 + h, false)]);
    check(&(ball(-0.5) & ball(0.5)), &[(0.5 - h, true), (-0.5 + h, false)]);
    check(&(ball(-0.5) - ball(0.5)), &[(-0.5 - h, true), (0.5 - h, false)]);
    check(&ball(-4.0), &[(-4.0 + h, false)]);
    // A sheet is met, not entered.
    let sheet = Set::new(&Primitive::sphere(Vec3::zero(), 1.0).unwrap().abs());
    let hits = sheet.hits(&x);
    assert_eq!(hits.len(), 2);
    assert!(hits.iter().all(|hit| !hit.enters));
    let half = sheet & Set::new(&Primitive::plane(v(1.0, 0.0, 0.0), Vec3::zero()).unwrap());
    assert_eq!(half.hits(&x).len(), 1);
}

#[test]
fn a_ray_down_the_t_piece_meets_the_fillet_and_the_end() {
    let set = t_piece();
    let s = v(1.0, 0.0, 1.0) / 2f64.sqrt();
    // Down the axis of the branch from beyond its end: in at 4, out through the run at -1 across.
    let down = ray(s * 6.0, -s, 12.0);
    let hits = set.hits(&down);
    assert_eq!(hits.len(), 2, "{hits:?}");
    assert!((hits[0].t - 2.0).abs() < 1e-12 && hits[0].enters);
    assert!(hits[0].normal.distance(s) < 1e-12);
    assert_eq!(set.leaves()[hits[0].leaf].attributes.name.as_deref(), Some("end"));
    // The far side of the run, z = -1, at s = -sqrt 2.
    assert!((hits[1].point.z + 1.0).abs() < 1e-12);
    assert!(set.normal(hits[1].point).distance(v(0.0, 0.0, -1.0)) < 1e-12);
}
