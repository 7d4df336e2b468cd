//! Intersections of curves, against sufficiently fine polylines.

use crate::common::{Line, Random};
use moldloft_locate::curve_pairs::{all_curve_curve, curve_curve};
use moldloft_locate::{LocateStatus, Roots};
use moldloft_num::{Curve, CurveFormula, Jet, Order, Vec3};
use moldloft_testing::soak;

/// A Bezier curve of the third degree.
#[derive(Clone, Copy, Debug)]
struct Cubic([Vec3; 4]);

impl CurveFormula for Cubic {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, t: J) -> Vec3<J> {
        let s = -t + 1.0;
        let [a, b, c, d] = self.0.map(|p| p.map(J::fixed));
        let mix = |p: Vec3<J>, q: Vec3<J>| p * s + q * t;
        let (ab, bc, cd) = (mix(a, b), mix(b, c), mix(c, d));
        mix(mix(ab, bc), mix(bc, cd))
    }
    moldloft_num::curve_facts!(smooth, open, not_rational);
}

fn plane(random: &mut Random, reach: f64) -> Vec3 {
    Vec3::of(random.between(-reach, reach), random.between(-reach, reach), 0.0)
}

fn space(random: &mut Random) -> Vec3 {
    Vec3::of(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0))
}

fn at(curve: &dyn Curve<f64>, t: f64) -> Vec3 {
    curve.jet(t, Order::Zero)[0]
}

fn cases(all: usize, few: usize) -> usize {
    if soak() { all } else { few }
}

/// The segments of two polylines that cross in the plane, as (t, s); `None` where a crossing is too flat, or too near to
/// an end, for the polylines to tell.
fn brute(a: &dyn Curve<f64>, b: &dyn Curve<f64>, [n, m]: [usize; 2]) -> Option<Vec<[f64; 2]>> {
    let line = |c: &dyn Curve<f64>, n: usize| -> Vec<Vec3> {
        (0..=n).map(|k| at(c, k as f64 / n as f64)).collect()
    };
    let (p, q) = (line(a, n), line(b, m));
    let mut found = Vec::new();
    for (i, x) in p.windows(2).enumerate() {
        for (j, y) in q.windows(2).enumerate() {
            let (d, e, g) = (x[1] - x[0], y[1] - y[0], y[0] - x[0]);
            let det = d.x * e.y - d.y * e.x;
            let (t, s) = ((g.x * e.y - g.y * e.x) / det, (g.x * d.y - g.y * d.x) / det);
            let near = |w: f64| (-0.2..1.2).contains(&w);
            if !(near(t) && near(s)) {
                continue;
            }
            if det.abs() < 0.02 * d.norm() * e.norm() {
                return None;
            }
            let uv = [(i as f64 + t) / n as f64, (j as f64 + s) / m as f64];
            if uv.iter().any(|w| w.min(1.0 - w).abs() < 1e-4) {
                return None;
            }
            if (0.0..1.0).contains(&t) && (0.0..1.0).contains(&s) {
                found.push(uv);
            }
        }
    }
    Some(found)
}

fn agrees(found: &Roots<2>, expected: &[[f64; 2]], steps: f64) -> bool {
    let near =
        |root: [f64; 2], other: &[f64; 2]| (0..2).all(|k| (root[k] - other[k]).abs() < 2.0 / steps);
    found.complete
        && found.roots.len() == expected.len()
        && found.roots.iter().all(|root| expected.iter().any(|e| near(root.at, e)))
}

#[test]
fn plane_curves_and_lines_cross_where_their_sides_change() {
    let mut random = Random::new(7);
    let (mut told, mut crossing) = (0, 0);
    for _ in 0..cases(10_000, 300) {
        let c = Cubic(std::array::from_fn(|_| plane(&mut random, 1.0)));
        let l = Line(plane(&mut random, 1.2), plane(&mut random, 1.2));
        let Some(expected) = brute(&c, &l, [2000, 1]) else { continue };
        let found = all_curve_curve(&c, &l, 0.0);
        assert!(
            agrees(&found, &expected, 400.0),
            "{c:?} {:?} {:?}\n{expected:?}\n{found:?}",
            l.0,
            l.1
        );
        for root in &found.roots {
            let gap = at(&c, root.at[0]).distance(at(&l, root.at[1]));
            assert!(gap < 1e-14 && root.residual < 1e-14, "{gap}");
        }
        told += 1;
        crossing += usize::from(!expected.is_empty());
    }
    assert!(told > cases(8_000, 240) && crossing > told / 4, "{told} {crossing}");
}

#[test]
fn plane_curves_cross_where_their_polylines_do() {
    let mut random = Random::new(8);
    let (mut told, mut most) = (0, 0);
    for _ in 0..cases(2_000, 60) {
        let [a, b] = [0, 1].map(|_| Cubic(std::array::from_fn(|_| plane(&mut random, 1.0))));
        let Some(expected) = brute(&a, &b, [300, 300]) else { continue };
        let found = all_curve_curve(&a, &b, 0.0);
        assert!(agrees(&found, &expected, 100.0), "{a:?}\n{b:?}\n{expected:?}\n{found:?}");
        told += 1;
        most = most.max(expected.len());
    }
    assert!(told > cases(1_200, 30) && most > 2, "{told} {most}");
}

#[test]
fn a_line_through_a_place_of_a_space_curve_meets_it() {
    let mut random = Random::new(9);
    for _ in 0..cases(5_000, 200) {
        let c = Cubic(std::array::from_fn(|_| space(&mut random)));
        let t = random.between(0.0, 1.0);
        let (x, d) = (at(&c, t), space(&mut random));
        let s = random.between(0.05, 0.95);
        let l = Line(x - d * s, x + d * (1.0 - s));
        let found = all_curve_curve(&c, &l, 0.0);
        let meets = |r: &moldloft_locate::FoundRoot<2>| r.xyz.distance(x) < 1e-12;
        assert!(found.complete && found.roots.iter().any(meets), "{c:?} {t} {found:?}");
        // From a random start.
        let from = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
        let taken = curve_curve(&c, &l, Some(from), 0.0).unwrap();
        assert!(taken.report.residual < 1e-12, "{taken:?}");
    }
}

#[test]
fn curves_that_do_not_meet_are_as_far_apart_as_their_nearest_places() {
    let mut random = Random::new(10);
    for _ in 0..cases(2_000, 60) {
        let [a, b] = [0, 1].map(|_| Cubic(std::array::from_fn(|_| space(&mut random))));
        let found = all_curve_curve(&a, &b, 0.0);
        assert!(found.complete && found.roots.is_empty(), "{a:?} {b:?} {found:?}");
        let (place, gap) = found.closest.unwrap();
        assert!((at(&a, place[0]).distance(at(&b, place[1])) - gap).abs() < 1e-14);
        const STEPS: usize = 120;
        let ts = (0..=STEPS).map(|k| k as f64 / STEPS as f64);
        let (p, q): (Vec<Vec3>, Vec<Vec3>) = ts.map(|t| (at(&a, t), at(&b, t))).unzip();
        let each = p.iter().flat_map(|x| q.iter().map(|y| x.distance(*y)));
        let least = each.fold(f64::INFINITY, f64::min);
        // The polylines' points are within half a step of it.
        assert!(gap <= least + 1e-14 && least <= gap + 0.1, "{a:?} {b:?} {gap} {least}");
        let report = curve_curve(&a, &b, None, 0.0).unwrap_err();
        assert_eq!((report.status, report.residual), (LocateStatus::NoSolution, gap));
    }
}

#[test]
fn contacts_are_told_from_near_misses() {
    // A parabola above a line.
    for (height, expected) in [(0.0, 1), (1e-7, 0), (-1e-6, 2), (0.3, 0)] {
        let p = |x: f64, y: f64| Vec3::of(x, y, 0.0);
        // y = height + (2 t - 1)^2.
        let c = Cubic([
            p(-1.0, 1.0 + height),
            p(-1.0 / 3.0, height - 1.0 / 3.0),
            p(1.0 / 3.0, height - 1.0 / 3.0),
            p(1.0, 1.0 + height),
        ]);
        let l = Line(p(-2.0, 0.0), p(1.7, 0.0));
        let found = all_curve_curve(&c, &l, 0.0);
        assert!(found.complete && found.roots.len() == expected, "{height} {found:?}");
        assert!(expected != 1 || found.roots[0].tangent, "{found:?}");
    }
}

#[test]
fn curves_side_by_side_do_not_meet() {
    let (from, along) = (Vec3::of(0.3, -0.2, 0.1), Vec3::of(2.0, 1.0, -0.7));
    for away in [1e-6, 1e-3, 0.5, 3.0] {
        let aside = Vec3::of(1.0, -2.0, 0.0).normalized().unwrap() * away;
        let l = Line(from, from + along);
        let m = Line(from + aside + along * 0.1, from + aside + along * 1.3);
        let found = all_curve_curve(&l, &m, 0.0);
        assert!(found.complete && found.roots.is_empty(), "{away} {found:?}");
        let gap = found.closest.unwrap().1;
        assert!((gap - away).abs() < 1e-12, "{away} {gap}");
    }
}

#[test]
fn a_search_that_ran_into_its_limit_says_so() {
    // Two halves of one curve share a third of it.
    let whole = Cubic([
        Vec3::of(0.0, 0.0, 0.0),
        Vec3::of(1.0, 2.0, 0.3),
        Vec3::of(2.0, -1.0, 0.7),
        Vec3::of(3.0, 1.0, 0.0),
    ]);
    let found = all_curve_curve(&whole, &whole, 0.0);
    assert!(!found.complete, "{found:?}");
}
