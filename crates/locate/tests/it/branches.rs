//! All branches of intersections, on shapes with a known number of them.

use crate::common::{Cylinder, Random, Sphere, bumpy};
use moldloft_locate::branches::{Branches, CutSurface};
use moldloft_locate::march::{Branch, BranchEnd, Crossing, Other};
use moldloft_num::{Box3, Jet, Order, Plane, Surface, SurfaceFormula, Vec3};
use moldloft_spline::{BSplineSurface, KnotVector};
use moldloft_testing::rounds;

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::of(x, y, z)
}

fn plane(point: Vec3, normal: Vec3) -> Plane<f64> {
    Plane { point, normal: normal.normalized().unwrap() }
}

/// z = height sin(n pi u) sin(n pi v) over the unit square.
struct Waves {
    n: f64,
    height: f64,
}

impl SurfaceFormula for Waves {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let w = self.n * std::f64::consts::PI;
        Vec3::new(u, v, (u * w).sin() * (v * w).sin() * self.height)
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

struct Torus {
    large: f64,
    small: f64,
}

impl SurfaceFormula for Torus {
    type Scalar = f64;
    fn at<J: Jet<f64>>(&self, u: J, v: J) -> Vec3<J> {
        let (a, b) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
        let r = b.cos() * self.small + self.large;
        Vec3::new(r * a.cos(), r * a.sin(), b.sin() * self.small)
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}

/// The parallelogram with a corner and two sides.
fn flat(corner: Vec3, a: Vec3, b: Vec3) -> BSplineSurface<f64> {
    let k = KnotVector::clamped_uniform(1, 2).unwrap();
    BSplineSurface::new(k.clone(), k, vec![corner, corner + b, corner + a, corner + a + b], None)
        .unwrap()
}

/// Stations are on both shapes, neighbours are near each other, and ends are as declared.
fn sound(crossing: &Crossing<'_>, found: &Branches) {
    for branch in &found.branches {
        for s in &branch.stations {
            let x = crossing.first.jet(s.q[0], s.q[1], Order::Zero).p;
            let gap = match crossing.other {
                Other::Plane(plane) => plane.distance(x).abs(),
                Other::Surface(o) => o.jet(s.q[2], s.q[3], Order::Zero).p.distance(x),
                Other::Level(field) => field.value(x).abs(),
            };
            assert!(gap < 1e-11 * crossing.size && x.distance(s.x) < 1e-11 * crossing.size);
            assert!(s.q.iter().all(|q| (-1e-9..=1.0 + 1e-9).contains(q)), "{s:?}");
        }
        for pair in branch.stations.windows(2) {
            let step = pair[0].x.distance(pair[1].x);
            assert!(step < 0.2 * crossing.size);
            // At a seam or a crease two stations coincide.
            let here = 1e-12 * crossing.size;
            assert!(step < here || pair[0].tangent.dot(pair[1].tangent) > 0.9);
        }
        let [first, last] = [&branch.stations[0], branch.stations.last().unwrap()];
        if branch.closed() {
            assert_eq!(first, last);
        } else {
            for (s, end) in [(first, branch.ends[0]), (last, branch.ends[1])] {
                if let BranchEnd::Edge { unknown, value } = end {
                    assert_eq!(s.q[unknown], value);
                }
            }
        }
    }
}

fn with_plane(s: &dyn Surface<f64>, plane: Plane<f64>) -> Branches {
    let crossing = Crossing::with_plane(s, plane);
    let found = crossing.branches();
    sound(&crossing, &found);
    found
}

fn of_two(a: &dyn Surface<f64>, b: &dyn Surface<f64>) -> Branches {
    let crossing = Crossing::with_surface(a, b);
    let found = crossing.branches();
    sound(&crossing, &found);
    found
}

fn count(found: &Branches) -> [usize; 3] {
    let closed = found.branches.iter().filter(|b| b.closed()).count();
    [closed, found.branches.len() - closed, found.touches.len()]
}

fn length(branch: &Branch) -> f64 {
    branch.stations.windows(2).map(|p| p[0].x.distance(p[1].x)).sum()
}

#[test]
fn a_plane_cuts_a_cylinder_across_its_seam_along_it_or_not_at_all() {
    let s = Cylinder { centre: Vec3::zero(), radius: 1.0, half: 3.0, axis: 2 };
    // Across: one circle, whole although the surface has a seam; slanted: an ellipse.
    for normal in [v(0.0, 0.0, 1.0), v(0.3, 0.0, 1.0), v(0.0, -0.4, 1.0)] {
        let found = with_plane(&s, plane(v(0.0, 0.0, 0.3), normal));
        assert_eq!(count(&found), [1, 0, 0], "{normal:?}");
        assert!(found.complete);
        assert!(length(&found.branches[0]) > 6.2);
    }
    // Slanted out of one end: one open branch, across the seam or not.
    for normal in [v(1.0, 0.0, 0.3), v(-1.0, 0.0, 0.3)] {
        let found = with_plane(&s, plane(v(0.0, 0.0, 3.0), normal));
        assert_eq!(count(&found), [0, 1, 0], "{found:?}");
        assert!(
            found.branches[0].ends.iter().all(|e| matches!(e, BranchEnd::Edge { unknown: 1, .. }))
        );
    }
    // Along: two lines; through the seam too; touching; missing.
    let along = |x: f64| with_plane(&s, plane(v(x, 0.0, 0.0), v(1.0, 0.0, 0.0)));
    assert_eq!(count(&along(0.2)), [0, 2, 0]);
    assert_eq!(count(&along(-0.7)), [0, 2, 0]);
    assert_eq!(count(&along(1.5)), [0, 0, 0]);
    assert!(along(1.0).branches.is_empty());
}

#[test]
fn cylinders_pierce_each_other_in_two_closed_branches_or_one() {
    let a = Cylinder { centre: Vec3::zero(), radius: 1.0, half: 3.0, axis: 2 };
    for axis in [0, 1] {
        let b = Cylinder { centre: v(0.0, 0.0, 0.2), radius: 0.5, half: 3.0, axis };
        let found = of_two(&a, &b);
        assert_eq!(count(&found), [2, 0, 0], "{axis}");
        // The same from the other side.
        assert_eq!(count(&of_two(&b, &a)), [2, 0, 0]);
    }
    // Offset so far that the small one protrudes at the side: one branch.
    let b = Cylinder { centre: v(0.0, 0.7, 0.2), radius: 0.5, half: 3.0, axis: 0 };
    assert_eq!(count(&of_two(&a, &b)), [1, 0, 0]);
    // Beside it, and ending inside.
    let b = Cylinder { centre: v(0.0, 1.7, 0.0), radius: 0.5, half: 3.0, axis: 0 };
    assert_eq!(count(&of_two(&a, &b)), [0, 0, 0]);
    let b = Cylinder { centre: v(0.0, 0.0, 0.0), radius: 0.5, half: 0.5, axis: 0 };
    assert_eq!(count(&of_two(&a, &b)), [0, 0, 0]);
}

#[test]
fn spheres_meet_in_a_circle_touch_or_miss() {
    let a = Sphere { centre: Vec3::zero(), radius: 1.0 };
    let at = |d: f64| Sphere { centre: v(d * 0.6, d * 0.48, d * 0.64), radius: 0.5 };
    let found = of_two(&a, &at(1.2));
    assert_eq!(count(&found), [1, 0, 0], "{:?}", found.touches);
    assert_eq!(count(&of_two(&a, &at(1.6))), [0, 0, 0]);
    assert_eq!(count(&of_two(&a, &at(0.3))), [0, 0, 0]);
    let touch = of_two(&a, &at(1.5));
    assert_eq!(count(&touch), [0, 0, 1]);
    assert!(touch.touches[0].x.distance(v(0.6, 0.48, 0.64)) < 1e-7);
}

#[test]
fn waves_are_cut_in_islands() {
    let s = Waves { n: 5.0, height: 0.2 };
    // 25 humps, 13 of them up: a level above the middle cuts those off, one below the others.
    assert_eq!(count(&with_plane(&s, plane(v(0.0, 0.0, 0.1), v(0.0, 0.0, 1.0)))), [13, 0, 0]);
    assert_eq!(count(&with_plane(&s, plane(v(0.0, 0.0, -0.1), v(0.0, 0.0, 1.0)))), [12, 0, 0]);
    assert_eq!(count(&with_plane(&s, plane(v(0.0, 0.0, 0.21), v(0.0, 0.0, 1.0)))), [0, 0, 0]);
    let at = |z: f64| flat(v(-0.1, -0.1, z), v(1.2, 0.0, 0.0), v(0.0, 1.2, 0.0));
    assert_eq!(count(&of_two(&s, &at(0.1))), [13, 0, 0]);
    assert_eq!(count(&of_two(&at(-0.1), &s)), [12, 0, 0]);
    // The sheet ends in the middle of the square: the humps on its edge give open branches.
    let half = flat(v(-0.1, -0.1, 0.1), v(0.6, 0.0, 0.0), v(0.0, 1.2, 0.0));
    let found = of_two(&s, &half);
    assert_eq!(count(&found), [5, 3, 0]);
    let on_edge =
        |b: &&Branch| b.ends.iter().all(|e| *e == BranchEnd::Edge { unknown: 2, value: 1.0 });
    assert_eq!(found.branches.iter().filter(|b| !b.closed()).filter(on_edge).count(), 3);
    // Just under the tops: 13 small islands, larger than the guaranteed size.
    let z = 0.2 - 0.2 * 0.5 * (5.0 * std::f64::consts::PI * 0.02).powi(2);
    assert_eq!(count(&with_plane(&s, plane(v(0.0, 0.0, z), v(0.0, 0.0, 1.0)))), [13, 0, 0]);
}

#[test]
fn a_torus_is_closed_both_ways() {
    let s = Torus { large: 2.0, small: 0.5 };
    assert_eq!(count(&with_plane(&s, plane(v(0.0, 0.0, 0.1), v(0.0, 0.0, 1.0)))), [2, 0, 0]);
    assert_eq!(count(&with_plane(&s, plane(v(0.1, 0.0, 0.0), v(1.0, 0.0, 0.0)))), [2, 0, 0]);
    assert_eq!(count(&with_plane(&s, plane(v(1.9, 0.0, 0.0), v(1.0, 0.0, 0.0)))), [1, 0, 0]);
    let small = Torus { large: 2.0, small: 0.25 };
    assert_eq!(count(&of_two(&s, &small)), [0, 0, 0]);
    let post = Cylinder { centre: v(2.0, 0.0, 0.0), radius: 0.3, half: 2.0, axis: 2 };
    assert_eq!(count(&of_two(&s, &post)), [2, 0, 0]);
}

#[test]
fn sheets_cross_from_edge_to_edge_or_end_inside() {
    let a = flat(v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    let b = flat(v(0.3, -0.2, -0.5), v(0.1, 2.0, 0.0), v(0.0, 0.0, 1.0));
    let found = of_two(&a, &b);
    assert_eq!(count(&found), [0, 1, 0]);
    assert!((length(&found.branches[0]) - (1.0f64 + 0.0025).sqrt()).abs() < 1e-9);
    // The second begins inside the first: from its own edge to the first's.
    let b = flat(v(0.3, 0.4, -0.5), v(0.0, 2.0, 0.0), v(0.0, 0.0, 1.0));
    let found = of_two(&a, &b);
    assert_eq!(count(&found), [0, 1, 0]);
    assert!((length(&found.branches[0]) - 0.6).abs() < 1e-9);
    // Parallel; and the same sheet, which has no branches but does not claim to be sure.
    let c = flat(v(0.0, 0.0, 0.1), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    assert_eq!(count(&of_two(&a, &c)), [0, 0, 0]);
    let same = of_two(&a, &a);
    assert!(same.branches.is_empty() && (!same.complete || !same.touches.is_empty()));
}

/// A roof of 45 degrees over -1 <= x <= 1, 0 <= y <= 2 with its ridge at x = 0.
fn roof() -> BSplineSurface<f64> {
    let (along, across) =
        (KnotVector::clamped_uniform(1, 3).unwrap(), KnotVector::clamped_uniform(1, 2).unwrap());
    let net = [(-1.0, 0.0), (0.0, 1.0), (1.0, 0.0)].into_iter();
    let net = net.flat_map(|(x, z)| [v(x, 0.0, z), v(x, 2.0, z)]).collect();
    BSplineSurface::new(along, across, net, None).unwrap()
}

#[test]
fn branches_run_on_over_creases() {
    let s = roof();
    // Along y = 0.5 + 0.8 x: over the ridge the branch turns by 76 degrees.
    let exact = 1.625 * (1.0f64 + 0.64 + 1.0).sqrt();
    let wall = flat(v(-1.0, -0.3, -1.0), v(3.0, 2.4, 0.0), v(0.0, 0.0, 3.0));
    for found in [
        with_plane(&s, plane(v(0.0, 0.5, 0.0), v(-0.8, 1.0, 0.0))),
        of_two(&s, &wall),
        of_two(&wall, &s),
    ] {
        assert_eq!(count(&found), [0, 1, 0]);
        let branch = &found.branches[0];
        assert!((length(branch) - exact).abs() < 1e-9, "{}", length(branch));
        assert!(branch.ends.iter().all(|end| matches!(end, BranchEnd::Edge { .. })));
    }
    // A closed branch round a pyramid without its top.
    let tent = {
        let k = KnotVector::clamped_uniform(1, 5).unwrap();
        let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let net = ring.iter().flat_map(|&(x, y)| [v(x, y, 0.0), v(0.5 * x, 0.5 * y, 2.0)]);
        let across = KnotVector::clamped_uniform(1, 2).unwrap();
        BSplineSurface::new(k, across, net.collect(), None).unwrap()
    };
    let found = with_plane(&tent, plane(v(0.0, 0.0, 1.0), v(0.0, 0.0, 1.0)));
    assert_eq!(count(&found), [1, 0, 0]);
    assert!((length(&found.branches[0]) - 6.0).abs() < 1e-9);
}

/// The sizes of the components of the zero set of samples, by joining the sides of a fine net that
/// it crosses.
fn components(g: &[f64], n: usize, xyz: &[Vec3]) -> Vec<f64> {
    let id = |i: usize, j: usize, down: bool| 2 * (i * n + j) + usize::from(down);
    let mut parent: Vec<usize> = (0..2 * n * n).collect();
    fn top(parent: &mut [usize], mut k: usize) -> usize {
        while parent[k] != k {
            parent[k] = parent[parent[k]];
            k = parent[k];
        }
        k
    }
    let sign = |i: usize, j: usize| g[i * n + j] > 0.0;
    let mut bounds = std::collections::BTreeMap::new();
    for i in 0..n - 1 {
        for j in 0..n - 1 {
            let sides = [
                (id(i, j, false), sign(i, j) != sign(i, j + 1)),
                (id(i + 1, j, false), sign(i + 1, j) != sign(i + 1, j + 1)),
                (id(i, j, true), sign(i, j) != sign(i + 1, j)),
                (id(i, j + 1, true), sign(i, j + 1) != sign(i + 1, j + 1)),
            ];
            let crossed: Vec<usize> = sides.iter().filter(|s| s.1).map(|s| s.0).collect();
            assert!(crossed.len() != 4, "the net is too coarse at {i} {j}");
            if let [a, b] = crossed[..] {
                let (a, b) = (top(&mut parent, a), top(&mut parent, b));
                parent[a] = b;
            }
        }
    }
    for i in 0..n - 1 {
        for j in 0..n - 1 {
            for down in [false, true] {
                let (a, b) = if down { (i + 1, j) } else { (i, j + 1) };
                if sign(i, j) != sign(a, b) {
                    let k = top(&mut parent, id(i, j, down));
                    let around: &mut Box3 = bounds.entry(k).or_insert(Box3::EMPTY);
                    // Both ends of the side: a branch may cut off a corner of the square.
                    *around = around.including(xyz[i * n + j]).including(xyz[a * n + b]);
                }
            }
        }
    }
    bounds.values().map(|b| b.diagonal()).collect()
}

/// All of a promised size are found, and none twice.
fn agree(found: &Branches, net: &[f64], what: &str) {
    let sizes: Vec<f64> = found
        .branches
        .iter()
        .map(|b| Box3::around(b.stations.iter().map(|s| s.x)).diagonal())
        .collect();
    let count = |sizes: &[f64], least: f64| sizes.iter().filter(|d| **d > least).count();
    assert!(found.complete, "{what}");
    // A net that is finer than this has all of them; its sizes are off by a step or two.
    let step = 0.03;
    assert!(count(&sizes, found.smallest) >= count(net, found.smallest + step), "{what}");
    for least in [2.0 * step, found.smallest, 1.0] {
        assert!(count(&sizes, least) <= count(net, least - step), "{what} {sizes:?} {net:?}");
    }
}

#[test]
fn random_splines_are_cut_into_as_many_branches_as_a_fine_net_says() {
    let mut random = Random::new(17);
    let soak = moldloft_testing::soak();
    for seed in 1..=if soak { 200 } else { 12 } {
        let s = bumpy(20, seed);
        let z = random.between(0.35, 0.65);
        let n = 1001;
        let ts: Vec<f64> = (0..n).map(|i| i as f64 / (n - 1) as f64).collect();
        let mut xyz = vec![Vec3::zero(); n * n];
        s.grid(&ts, &ts, &mut xyz, None);
        let g: Vec<f64> = xyz.iter().map(|x| x.z - z).collect();
        let level = plane(v(0.0, 0.0, z), v(0.0, 0.0, 1.0));
        let crossing = Crossing::with_plane(&s, level);
        let net = components(&g, n, &xyz);
        let found = crossing.branches();
        sound(&crossing, &found);
        agree(&found, &net, &format!("seed {seed}, z = {z}"));
        // The same against a surface instead of the plane, prepared beforehand.
        let sheet = flat(v(-1.0, -1.0, z), v(12.0, 0.0, 0.0), v(0.0, 12.0, 0.0));
        let crossing = Crossing::with_surface(&s, &sheet);
        let (a, b) = (CutSurface::new(&s), CutSurface::new(&sheet));
        let found = crossing.branches_in(&a, Some(&b));
        sound(&crossing, &found);
        agree(&found, &net, &format!("seed {seed}, z = {z}, sheet"));
    }
}

#[test]
fn a_second_height_field_cuts_where_the_difference_is_zero() {
    for seed in 1..=6 {
        let (a, b) = (bumpy(20, seed), bumpy(20, seed + 100));
        let n = 1001;
        let ts: Vec<f64> = (0..n).map(|i| i as f64 / (n - 1) as f64).collect();
        let (mut x, mut y) = (vec![Vec3::zero(); n * n], vec![Vec3::zero(); n * n]);
        a.grid(&ts, &ts, &mut x, None);
        b.grid(&ts, &ts, &mut y, None);
        // Both nets are even, so that equal parameters are straight above each other.
        let g: Vec<f64> = x.iter().zip(&y).map(|(p, q)| p.z - q.z).collect();
        let crossing = Crossing::with_surface(&a, &b);
        let found = crossing.branches();
        sound(&crossing, &found);
        agree(&found, &components(&g, n, &x), &format!("seed {seed}"));
    }
}

#[test]
fn a_section_of_a_ball_is_followed_once() {
    let mut random = Random::new(2_024);
    let draws = (0..moldloft_testing::rounds(200, 50_000)).map(|_| {
        let radius = random.between(0.5, 3.0);
        [radius, random.between(-0.8, 0.8) * radius, random.between(0.0, std::f64::consts::TAU)]
    });
    // Sections on which one step beside the pole spans half a turn.
    let beside_pole = [
        [2.150046975038919, -0.01907768366801398, 0.35629481855687134],
        [0.6585412159934696, -0.004000724935373021, 0.5479523794434827],
    ];
    for [radius, offset, angle] in beside_pole.into_iter().chain(draws) {
        let normal = v(angle.cos(), angle.sin(), 0.0);
        let ball = Sphere { centre: Vec3::zero(), radius };
        let found = with_plane(&ball, plane(normal * offset, normal));
        assert_eq!(count(&found), [1, 0, 0], "{radius} {offset} {angle}");
        let chords = found.branches[0].stations.windows(2).map(|s| s[0].x.distance(s[1].x));
        let circle = std::f64::consts::TAU * (radius * radius - offset * offset).sqrt();
        moldloft_testing::close_relative(chords.sum::<f64>(), circle, 0.01);
    }
}

#[test]
fn a_branch_that_begins_beside_the_seam_is_followed_once() {
    let mut random = Random::new(2_025);
    for _ in 0..moldloft_testing::rounds(300, 50_000) {
        let radius = random.between(0.5, 3.0);
        let angle = random.between(-1.4, 1.4);
        let offset = random.between(-0.8, 0.8) * radius * angle.cos();
        let [normal, along] = [v(angle.cos(), angle.sin(), 0.0), v(-angle.sin(), angle.cos(), 0.0)];
        // The section meets the plane of the seam at this x; the seam is at positive ones.
        let x = (offset / angle.cos()).abs();
        let ball = Sphere { centre: Vec3::zero(), radius };
        let own = (radius * radius - offset * offset).sqrt();
        let at_seam = (radius * radius - x * x).sqrt().atan2(-x * angle.sin());
        let away = 10.0_f64.powf(random.between(-12.0, -0.5)) * (random.signed()).signum();
        let turn = at_seam + away;
        let p = normal * offset.abs() + (along * turn.cos() + v(0.0, 0.0, turn.sin())) * own;
        let u = (p.y.atan2(p.x) / std::f64::consts::TAU).rem_euclid(1.0);
        let w = (p.z / radius).asin() / std::f64::consts::PI + 0.5;
        let crossing = Crossing::with_plane(&ball, plane(normal * offset.abs(), normal));
        let branch = crossing.branch([u, w, 0.0, 0.0]).expect("a branch");
        assert!(branch.closed(), "{radius} {offset} {angle} {away}");
        let chords = branch.stations.windows(2).map(|s| s[0].x.distance(s[1].x));
        let circle = std::f64::consts::TAU * own;
        moldloft_testing::close_relative(chords.sum::<f64>(), circle, 0.01);
    }
}

/// Two planes that meet in a ridge along y, `slope` down to either side.
fn ridge_roof(slope: f64) -> BSplineSurface<f64> {
    let ends = KnotVector::clamped_uniform(1, 2).unwrap();
    let three = KnotVector::clamped_uniform(1, 3).unwrap();
    let at = |x: f64, y: f64| v(x, y, -slope * x.abs());
    let net = [-2.0, 0.0, 2.0].into_iter().flat_map(|x| [at(x, -2.0), at(x, 2.0)]).collect();
    BSplineSurface::new(three, ends, net, None).unwrap()
}

#[test]
fn a_closed_branch_over_a_ridge_is_walked_once_from_any_start() {
    let mut random = Random::new(11);
    for round in 0..rounds(400, 20_000) {
        let slope = if round % 4 == 0 { 0.0 } else { random.between(0.1, 2.0) };
        let radius = random.between(0.3, 1.2);
        let centre = v(random.between(-0.25, 0.25), random.between(-0.5, 0.5), 0.0);
        let pipe = Cylinder { centre, radius, half: 6.0, axis: 2 };
        let roof = ridge_roof(slope);
        let crossing = Crossing::with_surface(&roof, &pipe);
        // Near the ridge or the seam of the pipe, or anywhere.
        let near = random.signed() * 10f64.powf(-random.between(0.0, 13.0));
        let ridge = (-centre.x / radius).acos();
        let a = match random.below(3) {
            0 => near,
            1 => [ridge, -ridge][random.below(2)] + near,
            _ => random.between(0.0, std::f64::consts::TAU),
        };
        let turn = (a / std::f64::consts::TAU).rem_euclid(1.0);
        let x = centre + v(a.cos(), a.sin(), 0.0) * radius;
        let height = -slope * x.x.abs();
        let seed = [0.25 * (x.x + 2.0), 0.25 * (x.y + 2.0), turn, (height / 6.0 + 1.0) * 0.5];
        let branch = crossing.branch(seed).unwrap();
        assert!(branch.closed(), "round {round}: {:?} from {a}", branch.ends);
        let steps = 4000;
        let on = |k: usize| {
            let a = std::f64::consts::TAU * k as f64 / steps as f64;
            let x = centre + v(a.cos(), a.sin(), 0.0) * radius;
            v(x.x, x.y, -slope * x.x.abs())
        };
        let exact: f64 = (0..steps).map(|k| on(k).distance(on(k + 1))).sum();
        let found = length(&branch);
        assert!((found / exact - 1.0).abs() < 0.01, "round {round}: {found} {exact} from {a}");
    }
}
