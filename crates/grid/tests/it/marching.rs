//! Grids marched off curves and surfaces, measured by the tests' own code.

use crate::sections;
use crate::walls::{self, Wall, geometric};
use moldloft_budget::{Budget, Spent};
use moldloft_grid::*;
use moldloft_num::{Dual4, Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

const UP: Vec3 = Vec3 { x: 0.0, y: 0.0, z: 1.0 };

fn even(n: usize, last: f64) -> Vec<f64> {
    (0..n).map(|k| last * (k as f64 / (n - 1) as f64)).collect()
}

fn options(wall: &Wall) -> Hyperbolic<f64> {
    let mut sides = [MarchBoundary::Free; 4];
    if wall.closed {
        sides[..2].fill(MarchBoundary::Periodic);
    }
    if wall.constant_ends {
        sides[..2].fill(MarchBoundary::Symmetry(0));
    }
    Hyperbolic::new(wall.heights.clone()).with_sides(sides)
}

fn march(wall: &Wall) -> Result<Marched<f64>, GridError> {
    hyperbolic_curve(&wall.points, UP, &options(wall))
}

/// The least scaled Jacobian over the four corners of all cells.
fn jacobian(grid: &SurfaceGrid<f64>) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..grid.m - 1 {
        for j in 0..grid.n - 1 {
            let p = [grid.at(i, j), grid.at(i, j + 1), grid.at(i + 1, j + 1), grid.at(i + 1, j)];
            for k in 0..4 {
                let (a, b) = (p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k]);
                least = least.min((a.x * b.y - a.y * b.x) / (a.norm() * b.norm()));
            }
        }
    }
    least
}

/// The distance of a point from a polygon.
fn distance(p: Vec3, wall: &[Vec3]) -> f64 {
    let each = wall.windows(2).map(|w| {
        let along = w[1] - w[0];
        let t = ((p - w[0]).dot(along) / along.norm_sq()).clamp(0.0, 1.0);
        p.distance(w[0] + along * t)
    });
    each.fold(f64::INFINITY, f64::min)
}

/// The largest angle, in degrees, between a line of the first layer and the bisector of the edges at its foot.
fn wall_angle(grid: &SurfaceGrid<f64>, wall: &Wall) -> f64 {
    let n = grid.n;
    let mut worst = 0.0f64;
    for j in 0..n {
        let at = |j: usize| grid.at(0, j);
        let ends = wall.closed;
        let next = if j + 1 < n {
            at(j + 1)
        } else if ends {
            at(1)
        } else {
            continue;
        };
        let last = if j > 0 {
            at(j - 1)
        } else if ends {
            at(n - 2)
        } else {
            continue;
        };
        let (p, m) = (next - at(j), last - at(j));
        let t = p / p.norm() - m / m.norm();
        let normal = Vec3::of(-t.y, t.x, 0.0);
        let line = grid.at(1, j) - at(j);
        worst = worst.max(line.cross(normal).norm().atan2(line.dot(normal)).to_degrees());
    }
    worst
}

/// Faults of a marched grid.
fn faults(wall: &Wall, grid: &SurfaceGrid<f64>) -> Vec<String> {
    let mut faults = Vec::new();
    let least = jacobian(grid);
    if !(least > 0.0) {
        faults.push(format!("Jacobian {least}"));
    }
    let first = wall.heights[1];
    let off = (0..grid.n)
        .map(|j| (distance(grid.at(1, j), &wall.points) / first - 1.0).abs())
        .fold(0.0, f64::max);
    if !(off <= 0.05) {
        faults.push(format!("first cell {:.1} % off", off * 100.0));
    }
    let angle = wall_angle(grid, wall);
    if !(angle <= 5.0) {
        faults.push(format!("{angle:.1} degrees off the normal"));
    }
    faults
}

/// Tightness of the tightest concave corner: first cell over spacing times the tangent of half its
/// angle. Beyond 1 lines on the bisectors must intersect.
fn tightness(wall: &Wall) -> f64 {
    let n = wall.points.len();
    let mut most = 0.0f64;
    for j in 1..n - 1 {
        let (p, m) = (wall.points[j + 1] - wall.points[j], wall.points[j - 1] - wall.points[j]);
        let turn = m.cross(p).z.atan2(m.dot(p));
        // The angle on the left, counted from the next edge to the last.
        let angle = if turn > 0.0 { 2.0 * PI - turn } else { -turn };
        if angle < PI {
            let spacing = p.norm().min(m.norm());
            most = most.max(wall.heights[1] / (spacing * (0.5 * angle).tan()));
        }
    }
    most
}

/// Each wall comes out right, or is refused beyond the limit that no march can pass.
fn judged(all: &[Wall]) {
    let (mut passed, mut refused, mut wrong) = (0, 0, Vec::new());
    let mut rungs = [0; 3];
    for wall in all {
        match march(wall) {
            Ok(marched) => {
                let faults = faults(wall, &marched.layers[0]);
                if !faults.is_empty() {
                    wrong.push(format!("{}: {}", wall.name, faults.join(", ")));
                }
                passed += 1;
                rungs[marched.report.rung - 1] += 1;
                assert_eq!(marched.layers[0].m, wall.heights.len());
            }
            Err(error) => {
                refused += 1;
                let tight = tightness(wall);
                if tight < 0.95 {
                    wrong.push(format!("{}: refused at tightness {tight:.2}: {error}", wall.name));
                }
                assert!(matches!(error, GridError::March(_)), "{}: {error:?}", wall.name);
            }
        }
    }
    println!("{passed} passed on rungs {rungs:?}, {refused} refused, {} wrong", wrong.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn is_soak() -> bool {
    std::env::var_os("MOLDLOFT_SOAK").is_some()
}

#[test]
fn walls_march_to_the_height_asked_or_say_why_not() {
    let all: Vec<Wall> =
        walls::walls().into_iter().step_by(if is_soak() { 1 } else { 41 }).collect();
    judged(&all);
}

/// The soak takes each fifteenth of a collection of 2 000 listings.
#[test]
fn listings_and_blades_march_or_say_why_not() {
    let all = sections::sections(if is_soak() { 15 } else { 1 });
    let every = if is_soak() { 1 } else { 17 };
    let all: Vec<Wall> = all.into_iter().step_by(every).collect();
    judged(&all);
}

/// Concave corners accept first cells up to the limit; larger ones are refused with the maximum.
#[test]
fn concave_corners_march_up_to_the_limit() {
    for angle in [30.0, 45.0, 60.0, 75.0, 90.0, 110.0, 135.0, 160.0f64] {
        for share in [0.3, 0.9, 0.94, 1.0, 2.0] {
            let points = walls::corner(angle, 21, None);
            let first = share * 0.05 * (0.5 * angle).to_radians().tan();
            if first > 0.2 {
                continue;
            }
            let heights = geometric(0.8f64.max(3.0 * first), first, 16);
            let name = format!("corner {angle} at {share}");
            let wall = Wall { name, points, heights, closed: false, constant_ends: false };
            match march(&wall) {
                Ok(marched) => {
                    assert!(share < 0.95, "{}", wall.name);
                    assert_eq!(
                        faults(&wall, &marched.layers[0]),
                        Vec::<String>::new(),
                        "{}",
                        wall.name
                    );
                }
                Err(GridError::March(failure)) => match failure.cause {
                    FailureCause::CornerTooTight { angle: found, spacing, height, fits } => {
                        assert!(share > 0.95, "{}: {failure}", wall.name);
                        assert!((found - angle).abs() < 1e-9 && (spacing - 0.05).abs() < 1e-12);
                        assert!(height == first && (fits / first - 0.95 / share).abs() < 1e-9);
                        assert_eq!(failure.at.at, [21, 1]);
                    }
                    _ => println!("{}: {failure}", wall.name),
                },
                Err(error) => panic!("{error}"),
            }
        }
    }
}

/// The radius of a circle marched to 2, first cell 0.02, against n; angles are exact.
#[test]
fn circles_keep_their_height() {
    let error = |n: usize| {
        let points = walls::round(n - 1, |a| [a.cos(), a.sin()]);
        let sides = [MarchBoundary::Periodic; 4];
        let marched = hyperbolic_curve(
            &points,
            UP,
            &Hyperbolic::new(geometric(1.0, 0.02, 21)).with_sides(sides),
        )
        .unwrap();
        let grid = &marched.layers[0];
        for j in 0..n {
            let (p, q) = (grid.at(20, j), grid.at(0, j));
            assert!(p.cross(q).norm() < 1e-12, "{p:?}");
        }
        (0..n).map(|j| (grid.at(20, j).norm() - 2.0).abs()).fold(0.0, f64::max)
    };
    let [a, b, c] = [33, 65, 129].map(error);
    println!("{a:e} {b:e} {c:e}");
    assert!(a < 1.6e-2 && b < 0.6 * a && c < 0.4 * b);
}

fn hexahedra(layers: &[SurfaceGrid<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for w in layers.windows(2) {
        for i in 0..w[0].m - 1 {
            for j in 0..w[0].n - 1 {
                for k in 0..8 {
                    let (a, b, c) = (k >> 2, k >> 1 & 1, k & 1);
                    let at = |a: usize, b: usize, c: usize| w[c].at(i + a, j + b);
                    let here = at(a, b, c);
                    let turn = |x: usize| 1.0 - 2.0 * x as f64;
                    let u = (at(1 - a, b, c) - here) * turn(a);
                    let v = (at(a, 1 - b, c) - here) * turn(b);
                    let w = (at(a, b, 1 - c) - here) * turn(c);
                    let scale = u.norm() * v.norm() * w.norm();
                    if scale > 0.0 {
                        least = least.min(u.cross(v).dot(w) / scale);
                    }
                }
            }
        }
    }
    least
}

fn bent(angle: f64) -> SurfaceGrid<f64> {
    let profile = walls::corner(angle, 21, None);
    SurfaceGrid::from_fn(41, 15, |i, j| Vec3::of(profile[i].x, j as f64 / 14.0, profile[i].y))
}

/// Two faces at an angle: the least scaled Jacobian is that of the cell in the corner of the wall, which no grid
/// with lines on the bisector can better.
#[test]
fn bent_plates() {
    for angle in [135.0, 90.0, 60.0, 270.0, 300.0f64] {
        for first in [1e-2, 1e-3] {
            let marched =
                hyperbolic(&bent(angle), &Hyperbolic::new(geometric(0.6, first, 25))).unwrap();
            let least = hexahedra(&marched.layers);
            let half = (0.5 * angle).to_radians();
            let best = if angle < 180.0 { half.sin() } else { (half - FRAC_PI_2).cos() };
            println!("{angle} {first}: {least:.4} of {best:.4}, {:?}", marched.report);
            assert!(least > best - 0.01, "{angle} {first}: {least} of {best}");
            assert!((marched.report.jacobian - least).abs() < 1e-12);
            for i in 0..41 {
                for j in 0..15 {
                    let p = marched.layers[1].at(i, j);
                    let flat = Vec3::of(p.x, p.z, 0.0);
                    let off = distance(flat, &walls::corner(angle, 21, None)) / first - 1.0;
                    assert!(
                        off.abs() < 0.05 || i == 0 || i == 40,
                        "{angle} {first} {i} {j}: {off}"
                    );
                }
            }
        }
    }
}

/// A plate with a post, square or round, as a collar: concave along the foot, convex round the post.
fn post(round: bool, n: usize, nj: usize) -> SurfaceGrid<f64> {
    SurfaceGrid::from_fn(4 * n + 1, 2 * nj - 1, |i, j| {
        let i = i % (4 * n);
        let (x, y) = if round {
            let a = 2.0 * PI * i as f64 / (4 * n) as f64;
            (0.5 * a.cos(), 0.5 * a.sin())
        } else {
            let t = 2.0 * (i % n) as f64 / n as f64;
            let (x, y) = [(1.0 - t, 1.0), (-1.0, 1.0 - t), (t - 1.0, -1.0), (1.0, t - 1.0)][i / n];
            (0.5 * x, 0.5 * y)
        };
        let u = j as f64 / (nj - 1) as f64;
        if u <= 1.0 {
            Vec3::of(x * (3.0 - 2.0 * u), y * (3.0 - 2.0 * u), 0.0)
        } else {
            Vec3::of(x, y, u - 1.0)
        }
    })
}

#[test]
fn posts_on_plates() {
    for (is_round, least) in [(false, 0.33), (true, 0.6)] {
        for first in [1e-2, 1e-3] {
            let mut sides = [MarchBoundary::Free; 4];
            sides[..2].fill(MarchBoundary::Periodic);
            let surface = post(is_round, if is_round { 12 } else { 16 }, 15);
            let options = Hyperbolic::new(geometric(0.5, first, 25)).with_sides(sides);
            let marched = hyperbolic(&surface, &options).unwrap();
            println!("{is_round} {first}: {:?}", marched.report);
            assert!(hexahedra(&marched.layers) > least);
        }
    }
}

fn ball(m: usize, n: usize, flat: f64) -> SurfaceGrid<f64> {
    SurfaceGrid::from_fn(m, n, |i, j| {
        let (a, b) =
            (PI * i as f64 / (m - 1) as f64, 2.0 * PI * (j % (n - 1)) as f64 / (n - 1) as f64);
        let r = if i == 0 || i == m - 1 { 0.0 } else { flat * a.sin() };
        Vec3::of(a.cos(), r * b.cos(), r * b.sin())
    })
}

/// Spheres and flat ellipsoids with two poles; spheres reach the given radius, more exactly with
/// finer grids.
#[test]
fn balls_with_two_poles() {
    let sides = [
        MarchBoundary::Pole,
        MarchBoundary::Pole,
        MarchBoundary::Periodic,
        MarchBoundary::Periodic,
    ];
    for (flat, least) in [(1.0, 0.8), (0.2, 0.75)] {
        for first in [1e-2, 1e-3] {
            let surface = ball(25, 33, flat);
            let options = Hyperbolic::new(geometric(10.0, first, 41)).with_sides(sides);
            let marched = hyperbolic(&surface, &options).unwrap();
            println!("{flat} {first}: {:?}", marched.report);
            assert!(hexahedra(&marched.layers) > 0.0);
            let inner: Vec<_> = marched
                .layers
                .iter()
                .map(|layer| SurfaceGrid::from_fn(23, 33, |i, j| layer.at(i + 1, j)))
                .collect();
            assert!(hexahedra(&inner) > least, "{}", hexahedra(&inner));
        }
    }
    let error = |m: usize| {
        let options = Hyperbolic::new(geometric(1.0, 0.02, 21)).with_sides(sides);
        let layers = hyperbolic(&ball(m, 2 * m - 1, 1.0), &options).unwrap().layers;
        layers[20].points().map(|p| (p.norm() - 2.0).abs()).fold(0.0, f64::max)
    };
    let [a, b] = [13, 25].map(error);
    println!("radius errors {a:e} {b:e}");
    assert!(a < 0.1 && b < 0.6 * a);
}

#[test]
fn noses_stay_one_point_on_the_axis() {
    let (m, n) = (16, 13);
    let body = SurfaceGrid::<f64>::from_fn(m, n, |i, j| {
        let (x, a) = ((i as f64 / (m - 1) as f64).powi(2), PI * j as f64 / (n - 1) as f64);
        let r = 0.4 * x.sqrt();
        let z = if j == 0 || j == n - 1 { 0.0 } else { r * a.sin() };
        Vec3::of(2.0 * x, r * a.cos(), z)
    });
    // s_i x s_j points inward on such a half body: march off its swapped image.
    let turned = SurfaceGrid::from_fn(n, m, |j, i| body.at(i, j));
    let sides = [
        MarchBoundary::Symmetry(2),
        MarchBoundary::Symmetry(2),
        MarchBoundary::Pole,
        MarchBoundary::Free,
    ];
    let layers =
        hyperbolic(&turned, &Hyperbolic::new(even(9, 0.15)).with_sides(sides)).unwrap().layers;
    for layer in &layers[1..] {
        let nose = layer.at(0, 0);
        assert!((0..n).all(|j| layer.at(j, 0) == nose));
        assert!(nose.x < 0.0 && nose.y.abs() < 1e-9 && nose.z == 0.0, "{nose:?}");
        assert!((0..m).all(|i| layer.at(0, i).z == 0.0 && layer.at(n - 1, i).z == 0.0));
    }
}

/// Half a ball from its nose: the layers are halves of larger balls, at the pole as elsewhere.
#[test]
fn a_half_ball_with_a_pole_stays_one() {
    for (m, n, tall) in [(21, 25, 0.5), (41, 61, 2.0), (11, 9, 0.1)] {
        let half = SurfaceGrid::from_fn(m, n, |i, j| {
            let a = FRAC_PI_2 * i as f64 / (m - 1) as f64;
            let b = FRAC_PI_2 - PI * j as f64 / (n - 1) as f64;
            Vec3::of(-a.cos(), a.sin() * b.cos(), a.sin() * b.sin())
        });
        let sides = [
            MarchBoundary::Pole,
            MarchBoundary::Free,
            MarchBoundary::Symmetry(1),
            MarchBoundary::Symmetry(1),
        ];
        let heights = vec![0.0, 0.1 * tall, 0.3 * tall, 0.6 * tall, tall];
        let options = Hyperbolic::new(heights).with_sides(sides);
        let layers = hyperbolic(&half, &options).unwrap().layers;
        let last = &layers[4];
        for j in 0..n {
            for i in 0..m {
                let off = last.at(i, j).norm() - 1.0 - tall;
                assert!(off.abs() < 0.1 * tall, "{m} {n} {tall}: {off} at {i}, {j}");
            }
            assert!(last.at(0, j) == last.at(0, 0));
        }
    }
}

#[test]
fn derivatives_are_those_of_the_steps() {
    fn last<T: Real>(h: T) -> SurfaceGrid<T> {
        let hill = SurfaceGrid::from_fn(7, 6, |i, j| {
            let (u, v) = (i as f64 / 6.0, j as f64 / 5.0);
            Vec3::new(T::from(u), T::from(v), h * (3.0 * u).sin() * (1.0 + v))
        });
        let options = Hyperbolic::new(vec![T::zero(), h * 0.2, h * 0.5, h * 2.0]);
        hyperbolic(&hill, &options).unwrap().layers.remove(3)
    }
    fn section<T: Real>(h: T) -> SurfaceGrid<T> {
        let points: Vec<Vec3<T>> = walls::naca4(41, 0.02, 0.4, 0.12, true)
            .into_iter()
            .map(|p| Vec3::new(T::from(p.x), h * (p.y * 5.0), T::zero()))
            .collect();
        let heights = geometric(5.0, 1e-3, 21).into_iter().map(T::from).collect();
        let options = Hyperbolic::new(heights).with_sides([MarchBoundary::Periodic; 4]);
        hyperbolic_curve(&points, Vec3::lifted(UP), &options).unwrap().layers.remove(0)
    }
    let against =
        |dual: SurfaceGrid<Dual4>, high: SurfaceGrid<f64>, low: SurfaceGrid<f64>, bound: f64| {
            for (c, plane) in dual.planes.iter().enumerate() {
                for (k, x) in plane.iter().enumerate() {
                    let difference = (high.planes[c][k] - low.planes[c][k]) / 2e-6;
                    assert!((x.part(1) - difference).abs() < bound, "{} {difference}", x.part(1));
                }
            }
        };
    let seed = Dual4::from_parts(|k| [0.2, 1.0, 0.0, 0.0, 0.0][k]);
    against(last(seed), last(0.2 + 1e-6), last(0.2 - 1e-6), 1e-6);
    against(section(seed), section(0.2 + 1e-6), section(0.2 - 1e-6), 1e-4);
}

#[test]
fn refusals_name_the_place() {
    let flat = SurfaceGrid::<f64>::from_fn(4, 4, |i, j| Vec3::of(i as f64, j as f64, 0.0));
    let with = |heights: Vec<f64>| hyperbolic(&flat, &Hyperbolic::new(heights)).unwrap_err();
    assert_eq!(with(vec![0.0, 1.0, 0.5]), GridError::Heights { at: 3, value: 0.5 });
    assert_eq!(with(vec![0.5, 1.0]), GridError::Heights { at: 1, value: 0.5 });
    assert!(matches!(with(vec![0.0, f64::NAN]), GridError::Heights { at: 2, .. }));
    assert!(matches!(with(vec![0.0, f64::INFINITY]), GridError::Heights { at: 2, .. }));
    let fan = SurfaceGrid::<f64>::from_fn(4, 4, |i, j| {
        let a = 0.3 * j as f64;
        Vec3::of(i as f64 * a.cos(), i as f64 * a.sin(), 0.0)
    });
    let error = hyperbolic(&fan, &Hyperbolic::new(even(3, 0.1))).unwrap_err();
    assert!(matches!(error, GridError::NoNormal { at } if at.at == [1, 1]));
    // A circle marched inward past its centre, and a periodic curve that does not close.
    let mut inward = walls::round(64, |a| [a.cos(), -a.sin()]);
    let options = |last: f64| {
        Hyperbolic::new(geometric(last, 1e-2, 31)).with_sides([MarchBoundary::Periodic; 4])
    };
    assert!(jacobian(&hyperbolic_curve(&inward, UP, &options(0.9)).unwrap().layers[0]) > 0.9);
    let error = hyperbolic_curve(&inward, UP, &options(1.2)).unwrap_err();
    let GridError::March(failure) = &error else { panic!("{error}") };
    assert!(failure.layer > 20, "{failure}");
    let mut kept = options(1.2);
    kept.stop.keep = true;
    let marched = hyperbolic_curve(&inward, UP, &kept).unwrap();
    assert!(marched.report.layers + 1 >= failure.layer && marched.report.stopped.is_some());
    assert!(jacobian(&marched.layers[0]) > 0.0);
    inward.pop();
    let error = hyperbolic_curve(&inward, UP, &options(0.5)).unwrap_err();
    assert!(matches!(error, GridError::EdgesApart { .. }), "{error}");
    // A cancelled march ends.
    struct Flat;
    impl Support<f64> for Flat {
        fn project(&self, points: &[Vec3]) -> Vec<(Vec3, Vec3)> {
            points.iter().map(|p| (*p, UP)).collect()
        }
    }
    let line = walls::corner(135.0, 21, None);
    let set = Budget::default();
    set.cancel();
    let error =
        hyperbolic_curve_until(&line, &Flat, &Hyperbolic::new(even(9, 0.5)), &set).unwrap_err();
    assert_eq!(error, GridError::Spent(Spent::Cancelled));
    let error = hyperbolic_until(&bent(90.0), &Hyperbolic::new(even(9, 0.3)), &set).unwrap_err();
    assert_eq!(error, GridError::Spent(Spent::Cancelled));
}

#[test]
fn marches_end_where_the_criteria_say() {
    let points = walls::round(64, |a| [a.cos(), a.sin()]);
    let mut options =
        Hyperbolic::new(geometric(5.0, 1e-2, 31)).with_sides([MarchBoundary::Periodic; 4]);
    options.stop.isotropic = true;
    let marched = hyperbolic_curve(&points, UP, &options).unwrap();
    assert_eq!(marched.report.stopped, Some(StopReason::Isotropic));
    let grid = &marched.layers[0];
    let (last, edge) = (grid.m - 1, grid.at(grid.m - 1, 1).distance(grid.at(grid.m - 1, 0)));
    let cell = |k: usize| grid.at(k, 0).distance(grid.at(k - 1, 0));
    assert!(cell(last) >= 0.99 * edge && cell(last - 1) < edge, "{} {edge}", cell(last));
    options.stop = Stop { growth: 1.1, ..Stop::default() };
    let marched = hyperbolic_curve(&points, UP, &options).unwrap();
    assert!(matches!(marched.report.stopped, Some(StopReason::Growth(x)) if x > 1.1));
    assert_eq!(marched.report.layers, 2);
}

/// A collar on a sphere: lines from a circle of latitude are meridians, layers stay on the sphere.
#[test]
fn collars_stay_on_their_surface() {
    struct Sphere;
    impl Support<f64> for Sphere {
        fn project(&self, points: &[Vec3]) -> Vec<(Vec3, Vec3)> {
            points.iter().map(|p| (*p / p.norm(), *p / p.norm())).collect()
        }
    }
    let error = |n: usize| {
        let (a, cancel) = (0.5f64, Budget::default());
        let points = walls::round(n, |b| [a.sin() * b.cos(), a.sin() * b.sin()]);
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::of(p.x, p.y, a.cos())).collect();
        let options =
            Hyperbolic::new(geometric(0.8, 0.01, 25)).with_sides([MarchBoundary::Periodic; 4]);
        let marched = hyperbolic_curve_until(&points, &Sphere, &options, &cancel).unwrap();
        let grid = &marched.layers[0];
        assert!(grid.points().all(|p| (p.norm() - 1.0).abs() < 1e-14));
        let angle = |k: usize| (0..=n).map(move |j| (k, j));
        for (k, j) in angle(24) {
            let (p, q) = (grid.at(k, j), grid.at(0, j));
            assert!((p.x * q.y - p.y * q.x).abs() < 1e-12);
        }
        (0..=n).map(|j| (grid.at(24, j).z.acos() - a - 0.8).abs()).fold(0.0, f64::max)
    };
    let [coarse, fine] = [32, 64].map(error);
    println!("heights on the sphere off by {coarse:e} {fine:e}");
    assert!(fine < 0.02 && fine < coarse);
}
