//! Laws of circular arcs.

use crate::common::{Random, close, curve_laws, point_derivative_law};
use moldloft_num::{Curve, Dual, Order, Vec3};
use moldloft_spline::{ArcError, CircularArc};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn at(arc: &CircularArc<f64>, t: f64) -> Vec3<f64> {
    arc.jet(t, Order::Zero)[0]
}

fn arc(kind: u32, p: [Vec3<f64>; 3]) -> CircularArc<f64> {
    CircularArc::of_type(kind, p).unwrap().unwrap()
}

fn flat(points: [[f64; 2]; 3]) -> [Vec3<f64>; 3] {
    points.map(|[x, y]| Vec3::of(x, y, 0.0))
}

#[test]
fn all_types_have_constant_speed_and_curvature() {
    let mut random = Random::new(10);
    for kind in 1..=6 {
        for _ in 0..20 {
            let p = [random.point(), random.point(), random.point()];
            let arc = arc(kind, p);
            let jet = arc.jet(0.0, Order::Second);
            let (speed, bend) = (jet[1].norm(), jet[1].cross(jet[2]).norm());
            let radius = speed.powi(3) / bend;
            assert!((speed / radius - arc.angle()).abs() < 1e-9 * radius.max(1.0));
            for k in 0..=10 {
                let jet = arc.jet(k as f64 / 10.0, Order::Second);
                assert!((jet[1].norm() - speed).abs() < 1e-9 * speed, "type {kind}");
                assert!((jet[1].cross(jet[2]).norm() - bend).abs() < 1e-8 * bend, "type {kind}");
            }
            curve_laws(&arc, &[0.1, 0.5, 0.83], 10.0 * (1.0 + speed * arc.angle()));
        }
    }
}

#[test]
fn each_type_meets_its_points() {
    let mut random = Random::new(11);
    for _ in 0..20 {
        let p = [random.point(), random.point(), random.point()];
        let through = arc(1, p);
        assert_eq!((at(&through, 0.0), at(&through, 1.0)), (p[0], p[2]));
        // The middle point is on the arc at its angle from the start.
        let centre = at(&through, 0.0)
            + through.jet(0.0, Order::Second)[2].map(|x| x / through.angle().powi(2));
        let radius = (p[0] - centre).norm();
        assert!(((p[1] - centre).norm() - radius).abs() < 1e-9 * radius);

        let about = arc(2, p);
        assert_eq!(at(&about, 0.0), p[0]);
        let end = at(&about, 1.0) - p[1];
        assert!(end.cross(p[2] - p[1]).norm() < 1e-13 && end.dot(p[2] - p[1]) > 0.0);
        assert!(about.angle() < PI);

        let tangent = arc(3, p);
        assert_eq!((at(&tangent, 0.0), at(&tangent, 1.0)), (p[0], p[2]));
        let (t, d) = (tangent.jet(0.0, Order::First)[1], p[1] - p[0]);
        assert!(t.cross(d).norm() < 1e-9 * t.norm() && t.dot(d) > 0.0);

        let tangent = arc(4, p);
        assert_eq!((at(&tangent, 0.0), at(&tangent, 1.0)), (p[0], p[2]));
        let (t, d) = (tangent.jet(1.0, Order::First)[1], p[2] - p[1]);
        assert!(t.cross(d).norm() < 1e-9 * t.norm() && t.dot(d) > 0.0);

        let half = arc(5, p);
        close(at(&half, 1.0), p[1], 1e-15);
        assert!((at(&half, 0.5) - (p[0] + p[1]) * 0.5).dot(p[2] - p[0]).is_finite());
        let circle = arc(6, p);
        assert_eq!(at(&circle, 0.0), at(&circle, 1.0));
        close((at(&circle, 0.0) + at(&circle, 0.5)) * 0.5, p[1], 1e-15);
    }
    let half = arc(5, flat([[1.0, 0.0], [-1.0, 0.0], [5.0, 2.0]]));
    assert_eq!(at(&half, 0.5), Vec3::of(0.0, 1.0, 0.0));
    let circle = arc(6, flat([[1.0, 0.0], [0.0, 0.0], [1.0, 3.0]]));
    assert_eq!(at(&circle, 0.25), Vec3::of(0.0, 1.0, 0.0));
    assert_eq!(circle.angle(), TAU);
}

#[test]
fn a_quarter_circle_is_one() {
    let (c, s) = (0.3f64.cos(), 0.3f64.sin());
    for (kind, points) in [
        (1, [[1.0, 0.0], [c, s], [0.0, 1.0]]),
        (2, [[1.0, 0.0], [0.0, 0.0], [0.0, 7.0]]),
        (3, [[1.0, 0.0], [1.0, 2.0], [0.0, 1.0]]),
        (4, [[1.0, 0.0], [4.0, 1.0], [0.0, 1.0]]),
    ] {
        let arc = arc(kind, flat(points));
        assert!((arc.angle() - FRAC_PI_2).abs() < 1e-14);
        for k in 0..=8 {
            let a = FRAC_PI_2 * k as f64 / 8.0;
            close(at(&arc, k as f64 / 8.0), Vec3::of(a.cos(), a.sin(), 0.0), 1e-14);
        }
    }
}

#[test]
fn straight_arcs_are_lines_and_the_limit_of_bent_ones() {
    for (kind, y2) in [(1, 1.0), (3, 1.0), (4, 1.0)] {
        let bent = |e: f64| arc(kind, flat([[0.0, 0.0], [1.0, e * y2], [3.0, 0.0]]));
        for k in 0..=6 {
            let t = k as f64 / 6.0;
            close(at(&bent(0.0), t), Vec3::of(3.0 * t, 0.0, 0.0), 1e-15);
            for e in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
                close(at(&bent(e), t), at(&bent(0.0), t), 4.0 * e);
            }
            // The derivative by the bend exists at the straight line.
            let up = Vec3::of(0.0, 1.0, 0.0);
            point_derivative_law(
                &flat([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]]),
                &[Vec3::zero(), up, Vec3::zero()],
                |p| at(&arc(kind, [p[0], p[1], p[2]]), t),
                |p| {
                    let arc = CircularArc::of_type(kind, [p[0], p[1], p[2]]).unwrap().unwrap();
                    arc.jet(Dual::from(t), Order::Zero)[0]
                },
                1e-9,
            );
        }
    }
    // Points on a line out of order, and opposite directions from a centre, are straight too.
    for (kind, points) in [
        (1, [[0.0, 0.0], [0.3, 0.3], [0.1, 0.1]]),
        (1, [[0.0, 0.0], [0.0, 0.0], [1.0, 2.0]]),
        (2, [[1.0, 0.0], [0.0, 0.0], [-3.0, 0.0]]),
        (3, [[0.0, 0.0], [-1.0, 0.0], [3.0, 0.0]]),
    ] {
        let arc = arc(kind, flat(points));
        close(at(&arc, 0.5), (at(&arc, 0.0) + at(&arc, 1.0)) * 0.5, 1e-15);
        assert_eq!(arc.angle(), 0.0);
    }
}

#[test]
fn moves_with_its_points() {
    let mut random = Random::new(12);
    for kind in 1..=6 {
        let (points, directions) = (random.points(3), random.points(3));
        let make = |p: &[Vec3<f64>]| at(&arc(kind, [p[0], p[1], p[2]]), 0.7);
        let dual = |p: &[Vec3<Dual<1>>]| {
            let arc = CircularArc::of_type(kind, [p[0], p[1], p[2]]).unwrap().unwrap();
            arc.jet(Dual::from(0.7), Order::Zero)[0]
        };
        point_derivative_law(&points, &directions, make, dual, 1e-6);
    }
}

#[test]
fn refuses_what_has_no_plane() {
    let line = flat([[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]);
    for kind in [5, 6] {
        assert_eq!(CircularArc::of_type(kind, line).unwrap(), Err(ArcError::Collinear));
    }
    assert_eq!(CircularArc::about(line[0], line[0], line[1]), Err(ArcError::AtCentre));
    let nan = Vec3::of(f64::NAN, 0.0, 0.0);
    assert_eq!(CircularArc::through(line[0], nan, line[1]), Err(ArcError::NotFinite { index: 1 }));
    assert!(CircularArc::of_type(7, line).is_none());
}
