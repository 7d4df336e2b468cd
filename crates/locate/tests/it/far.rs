//! Nearest points from very far away, where all of a shape is nearly equally near, and from where all of
//! it is equally near exactly.

use crate::common::{Circle, Random, Sphere, bumpy};
use moldloft_locate::{
    LocateStatus, NearestCurve, NearestSurface, nearest_on_curve, nearest_on_surface,
};
use moldloft_num::{Curve, Order, Surface, Vec3};
use moldloft_spline::BSplineCurve;

fn directions(seed: u64, count: usize) -> impl Iterator<Item = Vec3> {
    let mut random = Random::new(seed);
    (0..count).map(move |_| {
        let mut side = || random.between(-1.0, 1.0);
        Vec3::of(side(), side(), side()).normalized().unwrap_or(Vec3::of(1.0, 0.0, 0.0))
    })
}

/// From far away the nearest point is the foremost in that direction.
#[test]
fn from_far_away_the_foremost_point_is_the_nearest() {
    let mut random = Random::new(3);
    let points = (0..9).map(|i| Vec3::of(f64::from(i), random.unit(), random.unit())).collect();
    let c = BSplineCurve::uniform(3, points).unwrap();
    let s = bumpy(8, 3);
    let (curve, surface) = (NearestCurve::new(&c), NearestSurface::new(&s));
    for d in directions(5, 20) {
        let n = 4_000;
        let on_curve = (0..=n).map(|k| c.jet(f64::from(k) / f64::from(n), Order::Zero)[0].dot(d));
        let most_curve = on_curve.fold(f64::NEG_INFINITY, f64::max);
        let mut most_surface = f64::NEG_INFINITY;
        for k in 0..=200 {
            for l in 0..=200 {
                let x = s.jet(f64::from(k) / 200.0, f64::from(l) / 200.0, Order::Zero).p;
                most_surface = most_surface.max(x.dot(d));
            }
        }
        for far in [1e6, 1e9, 1e20, 1e100, 1e155, 1e300] {
            let p = d * far;
            // Squares of sizes over the distance, and rounding of distances.
            let slack = 1e-5;
            let found = [
                curve.nearest(&c, p).xyz,
                c.jet(nearest_on_curve(&c, p, None).at[0], Order::Zero)[0],
            ];
            for x in found {
                assert!(x.dot(d) > most_curve - slack, "{far}: {x:?} along {d:?}, {most_curve}");
            }
            let single = nearest_on_surface(&s, p, None);
            let found =
                [surface.nearest(&s, p).xyz, s.jet(single.at[0], single.at[1], Order::Zero).p];
            for x in found {
                assert!(x.dot(d) > most_surface - slack, "{far}: {x:?} along {d:?}");
            }
            // The distance is reported as it is.
            let reported = surface.nearest(&s, p).distance / far;
            assert!((reported - 1.0).abs() < 1e-4, "{far}: {reported}");
        }
    }
}

/// Feet keep their digits however far the point is.
#[test]
fn feet_of_far_points_are_sharp() {
    let c = Circle { centre: Vec3::of(1.0, 2.0, 3.0), radius: 2.0 };
    let s = Sphere { centre: Vec3::of(1.0, 2.0, 3.0), radius: 2.0 };
    let prepared = NearestSurface::new(&s);
    for d in directions(8, 20) {
        let flat = Vec3::of(d.x, d.y, 0.0).normalized().unwrap();
        for far in [1e3, 1e12, 1e155, 1e300] {
            let x = c.jet(nearest_on_curve(&c, d * far, None).at[0], Order::Zero)[0];
            let exact = Vec3::of(1.0, 2.0, 3.0) + flat * 2.0;
            // The direction is rotated by the ratio of the centre's coordinates to the distance.
            let turn = 20.0 / far;
            assert!(x.distance(exact) < 1e-9 + turn, "{far}: {x:?} {exact:?}");
            let exact = Vec3::of(1.0, 2.0, 3.0) + d * 2.0;
            let x = prepared.nearest(&s, d * far).xyz;
            assert!(x.distance(exact) < 1e-8 + turn, "{far}: {x:?} {exact:?}");
        }
    }
}

/// From a centre a search ends, and reports that there are others.
#[test]
fn from_the_centre_every_point_will_do() {
    let c = Circle { centre: Vec3::of(1.0, 2.0, 3.0), radius: 2.0 };
    let s = Sphere { centre: c.centre, radius: 2.0 };
    for axis in [0.0, 1.0, 1e6] {
        let p = c.centre + Vec3::of(0.0, 0.0, axis);
        let found = nearest_on_curve(&c, p, None);
        assert!(found.report.status != LocateStatus::Ok, "{:?}", found.report.status);
        let x = c.jet(found.at[0], Order::Zero)[0];
        assert!((x.distance(c.centre) - 2.0).abs() < 1e-12);
    }
    let found = nearest_on_surface(&s, s.centre, None);
    assert!(found.report.status != LocateStatus::Ok, "{:?}", found.report.status);
    let x = s.jet(found.at[0], found.at[1], Order::Zero).p;
    assert!((x.distance(s.centre) - 2.0).abs() < 1e-9);
}
