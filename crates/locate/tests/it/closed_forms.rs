//! Searches against closed forms.

use crate::common::{Circle, Cylinder, Line, Random, Sphere, brute, bumpy};
use moldloft_locate::curve_pairs::{all_curve_curve, curve_curve};
use moldloft_locate::roots::{
    all_curve_surface, all_on_level, curve_level, curve_surface, line_surface,
};
use moldloft_locate::{Level, LocateStatus, nearest_on_curve, nearest_on_surface};
use moldloft_num::{Curve, Order, Surface, Vec3};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::of(x, y, z)
}

#[test]
fn nearest_on_a_sphere_lies_towards_its_centre() {
    let s = Sphere { centre: v(1.0, 2.0, 3.0), radius: 2.0 };
    let mut random = Random::new(5);
    for _ in 0..200 {
        let p = v(random.between(-4.0, 6.0), random.between(-3.0, 7.0), random.between(-2.0, 8.0));
        let found = nearest_on_surface(&s, p, None);
        let x = s.jet(found.at[0], found.at[1], Order::Zero).p;
        let exact = s.centre + (p - s.centre).normalized().unwrap() * 2.0;
        assert!(x.distance(exact) < 1e-9, "{p:?} {found:?}");
    }
    // From the centre all points are equally near.
    let found = nearest_on_surface(&s, s.centre, Some([0.3, 0.4]));
    assert!(found.report.status != LocateStatus::Ok, "{found:?}");
}

#[test]
fn nearest_from_a_start_stays_near_it_and_an_edge_is_told() {
    let c = Circle { centre: v(0.0, 0.0, 0.0), radius: 1.0 };
    let found = nearest_on_curve(&c, v(3.0, 0.1, 1.0), Some(0.1));
    assert_eq!(found.report.status, LocateStatus::Ok);
    assert!((found.at[0] - (0.1f64 / 3.0).atan() / std::f64::consts::TAU).abs() < 1e-14);
    let l = Line(v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0));
    for start in [None, Some(0.9)] {
        let found = nearest_on_curve(&l, v(2.0, 1.0, 0.0), start);
        assert_eq!(
            (found.report.status, found.at[0]),
            (LocateStatus::EdgeClamped, 1.0),
            "{found:?}"
        );
        let found = nearest_on_curve(&l, v(0.25, 1.0, 0.0), start);
        assert_eq!(found.report.status, LocateStatus::Ok);
        assert!((found.at[0] - 0.25).abs() < 1e-15);
    }
    // Two feet at the same distance.
    let found =
        nearest_on_curve(&Line(v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)), v(0.0, 0.0, 0.0), None);
    assert_eq!(found.report.status, LocateStatus::Ok);
    let arc = moldloft_spline::BSplineCurve::uniform(
        2,
        vec![v(-1.0, 1.0, 0.0), v(0.0, -1.0, 0.0), v(1.0, 1.0, 0.0)],
    )
    .unwrap();
    let found = nearest_on_curve(&arc, v(0.0, 3.0, 0.0), None);
    assert!(matches!(found.report.status, LocateStatus::Multiple { count: 2, .. }), "{found:?}");
    assert_eq!(found.report.alternatives.len(), 1);
}

#[test]
fn nearest_on_a_spline_surface_is_the_nearest() {
    let s = bumpy(8, 3);
    let mut random = Random::new(11);
    for _ in 0..40 {
        let p = v(random.between(-1.0, 5.0), random.between(-1.0, 5.0), random.between(-2.0, 3.0));
        let found = nearest_on_surface(&s, p, None);
        let d = s.jet(found.at[0], found.at[1], Order::Zero).p.distance(p);
        let (best, uv) = brute(&s, p, 120);
        assert!(d <= best + 1e-9, "{p:?}: {d} at {:?}, but {best} at {uv:?}", found);
    }
}

#[test]
fn a_circle_crosses_a_plane_twice_touches_it_once_or_misses_it() {
    let c = Circle { centre: v(0.0, 0.0, 0.0), radius: 2.0 };
    let plane = |x: f64| Level::Plane { normal: v(1.0, 0.0, 0.0), offset: x };
    let all = all_on_level(&c, &plane(1.0));
    let ts: Vec<f64> = all.roots.iter().map(|r| r.at[0]).collect();
    assert!(all.complete && ts.len() == 2, "{all:?}");
    assert!((ts[0] - 1.0 / 6.0).abs() < 1e-14 && (ts[1] - 5.0 / 6.0).abs() < 1e-14, "{ts:?}");
    let found = curve_level(&c, &plane(1.0), Some(0.8)).unwrap();
    assert_eq!(found.report.status, LocateStatus::Ok);
    assert!((found.at[0] - 5.0 / 6.0).abs() < 1e-14);
    let found = curve_level(&c, &plane(1.0), None).unwrap();
    assert!(matches!(found.report.status, LocateStatus::Multiple { count: 2, .. }));
    // The start sits at the turning point: Newton fails, subdivision does not.
    let found = curve_level(&c, &plane(1.0), Some(0.5)).unwrap();
    assert_eq!(found.report.status, LocateStatus::Fallback, "{found:?}");
    let touch = curve_level(&c, &plane(-2.0), None).unwrap();
    assert_eq!(touch.report.status, LocateStatus::Tangent, "{touch:?}");
    assert!((touch.at[0] - 0.5).abs() < 1e-6);
    let none = curve_level(&c, &plane(2.5), None).unwrap_err();
    assert_eq!(none.status, LocateStatus::NoSolution);
    let ball = Level::Sphere { centre: v(2.0, 0.0, 0.0), radius: 2.0 };
    assert_eq!(all_on_level(&c, &ball).roots.len(), 2);
}

#[test]
fn a_line_pierces_a_sphere_twice() {
    let s = Sphere { centre: v(0.0, 0.0, 0.0), radius: 1.0 };
    let l = Line(v(0.1, 0.2, -3.0), v(0.1, 0.2, 3.0));
    let all = all_curve_surface(&l, &s);
    let h = (1.0f64 - 0.05).sqrt();
    let ts: Vec<f64> = all.roots.iter().map(|r| r.at[0]).collect();
    assert_eq!(ts.len(), 2, "{all:?}");
    assert!((ts[0] - (3.0 - h) / 6.0).abs() < 1e-12 && (ts[1] - (3.0 + h) / 6.0).abs() < 1e-12);
    let top = curve_surface(&l, &s, Some([0.6, 0.2, 0.8])).unwrap();
    assert!((top.at[0] - ts[1]).abs() < 1e-12 && top.report.status == LocateStatus::Ok);
    let near = line_surface(&s, v(0.1, 0.2, 5.0), v(0.0, 0.0, -0.5), None).unwrap();
    assert!((near.at[2] - 2.0 * (5.0 - h)).abs() < 1e-11, "{near:?}");
    assert!(matches!(near.report.status, LocateStatus::Multiple { count: 2, .. }));
    let miss = line_surface(&s, v(2.0, 0.0, 5.0), v(0.0, 0.0, 1.0), None).unwrap_err();
    assert_eq!(miss.status, LocateStatus::NoSolution);
    assert!(miss.residual > 0.5);
    // A tangent line.
    let graze = Line(v(1.0, -3.0, 0.0), v(1.0, 3.0, 0.0));
    let touch = curve_surface(&graze, &s, None).unwrap();
    assert_eq!(touch.report.status, LocateStatus::Tangent, "{touch:?}");
}

#[test]
fn curves_meet_where_they_should() {
    let c = Circle { centre: v(0.0, 0.0, 0.0), radius: 1.0 };
    let l = Line(v(-2.0, 0.5, 0.0), v(2.0, 0.5, 0.0));
    let all = all_curve_curve(&c, &l, 0.0);
    assert_eq!(all.roots.len(), 2, "{all:?}");
    let x = c.jet(all.roots[0].at[0], Order::Zero)[0];
    assert!((x.x - 0.75f64.sqrt()).abs() < 1e-12 && (x.y - 0.5).abs() < 1e-12);
    let left = curve_curve(&c, &l, Some([0.4, 0.3]), 0.0).unwrap();
    assert!(left.report.residual < 1e-12 && left.at[1] < 0.5);
    // Skew: the nearest points, with their gap.
    let up = Line(v(-2.0, 0.5, 0.25), v(2.0, 0.5, 0.25));
    let gap = curve_curve(&c, &up, None, 0.0).unwrap_err();
    assert_eq!(gap.status, LocateStatus::NoSolution);
    assert!((gap.residual - 0.25).abs() < 1e-12, "{gap:?}");
}

#[test]
fn all_roots_of_a_line_and_a_cylinder() {
    let s = Cylinder { centre: v(0.0, 0.0, 0.0), radius: 1.0, half: 3.0, axis: 2 };
    let mut random = Random::new(2);
    for _ in 0..100 {
        let mut r = || random.between(-1.5, 1.5);
        let l = Line(v(-3.0, r(), r()), v(3.0, r(), r()));
        // |x, y| of the line is 1: a quadratic.
        let d = l.1 - l.0;
        let (a, b, c) =
            (d.x * d.x + d.y * d.y, l.0.x * d.x + l.0.y * d.y, l.0.x * l.0.x + l.0.y * l.0.y - 1.0);
        let disc = b * b - a * c;
        if disc.abs() < 1e-6 {
            continue;
        }
        let all = all_curve_surface(&l, &s);
        let seam = all.roots.iter().any(|r| !(1e-6..1.0 - 1e-6).contains(&r.at[1]));
        let expected = if disc > 0.0 { 2 } else { 0 };
        assert!(all.complete);
        assert!(all.roots.len() == expected || seam, "{l0:?} {l1:?} {all:?}", l0 = l.0, l1 = l.1);
    }
}
