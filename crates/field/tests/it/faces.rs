//! Bodies by their faces as sets: exact inside, outside and on the surface, also where planes cross.

use moldloft_field::{FieldError, Round, RoundProfile, Set, Sides, bracket, faced};
use moldloft_num::{Box3, Dual, Vec3};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn of(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<Set, FieldError> {
    faced(&Sides { points, triangles, sides: None, rounds: &[] })
}

/// The boundary of the unit cubes where `solid`, as triangles that share vertices.
fn cubes(n: i32, solid: &dyn Fn([i32; 3]) -> bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut points, mut number) = (Vec::new(), HashMap::new());
    let mut triangles = Vec::new();
    for cell in (0..n * n * n).map(|k| [k / n / n, k / n % n, k % n]).filter(|c| solid(*c)) {
        for (axis, side) in (0..6).map(|k| (k / 2, k % 2)) {
            let mut other = cell;
            other[axis] += 2 * side as i32 - 1;
            if other[axis] >= 0 && other[axis] < n && solid(other) {
                continue;
            }
            let mut corner = |u: i32, v: i32| {
                let mut p = cell;
                p[axis] += side as i32;
                p[(axis + 1) % 3] += u;
                p[(axis + 2) % 3] += v;
                *number.entry(p).or_insert_with(|| {
                    points.push(Vec3::of(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])));
                    points.len() as u32 - 1
                })
            };
            let mut q = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if side == 0 {
                q.reverse();
            }
            triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
        }
    }
    (points, triangles)
}

/// At every half lattice point, on planes, edges and corners of the lattice too, the function is negative
/// where all cubes around are solid, positive where all are air, else zero.
fn check_cubes(n: i32, solid: &dyn Fn([i32; 3]) -> bool) -> usize {
    let (points, triangles) = cubes(n, solid);
    let set = of(&points, &triangles).unwrap();
    let at = |c: [i32; 3]| c.iter().all(|x| (0..n).contains(x)) && solid(c);
    let m = 2 * n + 3;
    for k in 0..m * m * m {
        let h = [k / m / m - 1, k / m % m - 1, k % m - 1];
        let mut around = Vec::new();
        for corner in 0..8 {
            let cell = [0, 1, 2]
                .map(|a| (h[a] - (corner >> a & 1) * (1 - h[a].rem_euclid(2))).div_euclid(2));
            around.push(at(cell));
        }
        let value = set.value(Vec3::of(f64::from(h[0]), f64::from(h[1]), f64::from(h[2])) * 0.5);
        let wanted = match (around.iter().all(|s| *s), around.iter().any(|s| *s)) {
            (true, _) => -1.0,
            (_, false) => 1.0,
            _ => 0.0,
        };
        let found = if value == 0.0 { 0.0 } else { value.signum() };
        assert_eq!(found, wanted, "at {h:?} halves: {value}");
    }
    set.contents()
}

#[test]
fn random_cubes_have_no_surface_inside() {
    let mut state = 7u64;
    let mut bit = || {
        // Knuth, MMIX.
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 63 == 1
    };
    for round in 0..60 {
        let n = 2 + round % 2;
        let bits: Vec<bool> = (0..n * n * n).map(|_| bit()).collect();
        if bits.iter().any(|b| *b) {
            check_cubes(n, &|[x, y, z]| bits[((x * n + y) * n + z) as usize]);
        }
    }
    // A cavity, a hole through, a cross of beams.
    assert_eq!(check_cubes(3, &|c| c != [1, 1, 1]), 12);
    check_cubes(3, &|[x, y, _]| [x, y] != [1, 1]);
    check_cubes(3, &|c| c.iter().filter(|x| **x == 1).count() >= 2);
}

#[test]
fn a_terrace_takes_one_half_space_for_each_face() {
    let steps = 40;
    let (points, triangles) = cubes(steps, &|[x, y, z]| y == 0 && x + z < steps);
    let set = of(&points, &triangles).unwrap();
    assert!(set.contents() <= 2 * steps as usize + 4, "{}", set.contents());
    let volume = bracket(&set, &box_of(&points, 0.5), 6).unwrap().volume();
    let exact = f64::from(steps * (steps + 1)) / 2.0;
    assert!(volume.contains(exact) && volume.width() < 0.06 * exact, "{volume:?} {exact}");
}

fn box_of(points: &[Vec3], more: f64) -> Box3 {
    let b = Box3::around(points.iter().copied());
    let m = Vec3::of(more, more, more);
    Box3 { low: b.low - m, high: b.high + m }
}

/// A prism of height 2 over a polygon of chords, and the number of each side of it.
fn prism(outline: &[(Vec3, u32)]) -> (Vec<Vec3>, Vec<[u32; 3]>, Vec<u32>) {
    let n = outline.len() as u32;
    let mut points: Vec<Vec3> = outline.iter().map(|o| o.0).collect();
    points.extend(outline.iter().map(|o| o.0 + Vec3::of(0.0, 0.0, 2.0)));
    let (mut triangles, mut sides) = (Vec::new(), Vec::new());
    for k in 0..n {
        let next = (k + 1) % n;
        triangles.extend([[k, next, next + n], [k, next + n, k + n]]);
        sides.extend([outline[k as usize].1; 2]);
    }
    for k in 1..n - 1 {
        triangles.extend([[0, k + 1, k], [n, n + k, n + k + 1]]);
        sides.extend([101, 102]);
    }
    (points, triangles, sides)
}

/// The arc of the unit circle about a centre from one angle over another, as `chords` chords.
fn arc(
    centre: [f64; 2],
    from: f64,
    over: f64,
    chords: usize,
    side: u32,
) -> (Vec<(Vec3, u32)>, Round<f64>) {
    let at = |angle: f64| Vec3::of(angle.cos(), angle.sin(), 0.0);
    let centre = Vec3::of(centre[0], centre[1], 0.0);
    let way = (0..chords).map(|k| (centre + at(from + over * k as f64 / chords as f64), side));
    let b = at(from + over.signum() * FRAC_PI_2);
    let profile = RoundProfile::Conic { centre, a: at(from), b, sweep: over.abs() };
    let shift = Vec3::of(0.0, 0.0, 2.0);
    (way.collect(), Round { side, profile, shift, scale: 1.0 })
}

/// Values at a grid of points have the sign that `inside` says, off the surface.
fn check(set: &Set, low: Vec3, high: Vec3, inside: &dyn Fn(Vec3) -> f64) {
    let n = 23;
    for k in 0..n * n * n {
        let part = |k: i32| (f64::from(k) + 0.37) / f64::from(n);
        let d = high - low;
        let p = low + Vec3::of(d.x * part(k / n / n), d.y * part(k / n % n), d.z * part(k % n));
        let (value, wanted) = (set.value(p), inside(p));
        assert!(wanted.abs() < 1e-3 || value * wanted > 0.0, "{p:?}: {value}, not {wanted}");
    }
}

fn slab(p: Vec3, flat: f64) -> f64 {
    flat.max(-p.z).max(p.z - 2.0)
}

#[test]
fn rounded_corners_are_cylinders() {
    // A square with one corner rounded off, one filled in from an L: convex and concave.
    let (rounding, outer) = arc([3.0, 3.0], 0.0, FRAC_PI_2, 2, 1);
    let (filling, inner) = arc([2.0, -1.0], PI, -FRAC_PI_2, 3, 2);
    // From a point that sees all others down to (0, -2), (1, -2), up to the filling at (1, -1),
    // over to (2, 0), (4, 0), the rounding.
    let mut outline =
        vec![(Vec3::zero(), 8), (Vec3::of(0.0, -2.0, 0.0), 3), (Vec3::of(1.0, -2.0, 0.0), 4)];
    outline.extend(filling);
    outline.extend([(Vec3::of(2.0, 0.0, 0.0), 5), (Vec3::of(4.0, 0.0, 0.0), 6)]);
    outline.extend(rounding);
    outline.extend([(Vec3::of(3.0, 4.0, 0.0), 7), (Vec3::of(0.0, 4.0, 0.0), 8)]);
    let (points, triangles, sides) = prism(&outline);
    let rounds = [outer, inner];
    let body =
        Sides { points: &points, triangles: &triangles, sides: Some(&sides), rounds: &rounds };
    let set = faced(&body).unwrap();
    let exact = |p: Vec3| {
        let block = (-p.x).max(p.x - 4.0).max(-p.y).max(p.y - 4.0);
        let leg = (-p.x).max(p.x - 1.0).max(-2.0 - p.y).max(p.y);
        let corner = (p.x - 3.0).min(p.y - 3.0);
        let round = ((p.x - 3.0).powi(2) + (p.y - 3.0).powi(2)).sqrt() - 1.0;
        let block = block.max(round.min(corner));
        let gap = ((p.x - 2.0).powi(2) + (p.y + 1.0).powi(2)).sqrt() - 1.0;
        let web = (1.0 - p.x).max(p.x - 2.0).max(-1.0 - p.y).max(p.y).max(-gap);
        slab(p, block.min(leg).min(web))
    };
    check(&set, Vec3::of(-1.0, -3.0, -0.5), Vec3::of(5.0, 5.0, 2.5), &exact);
    let over = Box3 { low: Vec3::of(-1.0, -3.0, -1.0), high: Vec3::of(5.0, 5.0, 3.0) };
    let volume = bracket(&set, &over, 6).unwrap().volume();
    let wanted = 2.0 * (16.0 + 2.0);
    assert!(volume.contains(wanted) && volume.width() < 0.06 * wanted, "{volume:?} {wanted}");
}

#[test]
fn holes_pegs_and_slots() {
    // A whole peg of four quarters, of one arc, of two: full cylinders without chords.
    for n in [1, 2, 4] {
        let (mut outline, mut rounds) = (Vec::new(), Vec::new());
        for k in 0..n {
            let turn = TAU / n as f64;
            let (way, round) = arc([0.0, 0.0], turn * k as f64, turn, 24 / n, k as u32 + 1);
            outline.extend(way);
            rounds.push(round);
        }
        let (points, triangles, sides) = prism(&outline);
        let sides = Some(&sides[..]);
        let body = Sides { points: &points, triangles: &triangles, sides, rounds: &rounds };
        let set = faced(&body).unwrap();
        assert_eq!(set.contents(), 3, "two ends and a cylinder");
        let exact = |p: Vec3| slab(p, p.x.hypot(p.y) - 1.0);
        check(&set, Vec3::of(-2.0, -2.0, -1.0), Vec3::of(2.0, 2.0, 3.0), &exact);
    }
    // A slot: two half circles and straight sides.
    let (mut outline, right) = arc([2.0, 0.0], -FRAC_PI_2, PI, 12, 1);
    outline.push((Vec3::of(2.0, 1.0, 0.0), 3));
    let (left_way, left) = arc([-2.0, 0.0], FRAC_PI_2, PI, 12, 2);
    outline.extend(left_way);
    outline.push((Vec3::of(-2.0, -1.0, 0.0), 4));
    let (points, triangles, sides) = prism(&outline);
    let rounds = [right, left];
    let body =
        Sides { points: &points, triangles: &triangles, sides: Some(&sides), rounds: &rounds };
    let set = faced(&body).unwrap();
    let exact = |p: Vec3| slab(p, (p.x.abs() - 2.0).max(0.0).hypot(p.y) - 1.0);
    check(&set, Vec3::of(-4.0, -2.0, -1.0), Vec3::of(4.0, 2.0, 3.0), &exact);
}

#[test]
fn cones_have_one_nappe_and_parabolas_one_branch() {
    // A cone over the unit circle with its apex at height 2.
    let (way, mut round) = arc([0.0, 0.0], 0.0, TAU, 24, 1);
    round.scale = 0.0;
    let mut points: Vec<Vec3> = way.iter().map(|w| w.0).collect();
    points.push(Vec3::of(0.0, 0.0, 2.0));
    let (mut triangles, mut sides) = (Vec::new(), Vec::new());
    for k in 0..24u32 {
        triangles.push([k, (k + 1) % 24, 24]);
        sides.push(1);
    }
    for k in 1..23 {
        triangles.push([0, k + 1, k]);
        sides.push(2);
    }
    let rounds = [round];
    let body =
        Sides { points: &points, triangles: &triangles, sides: Some(&sides), rounds: &rounds };
    let set = faced(&body).unwrap();
    let exact = |p: Vec3| (p.x.hypot(p.y) - (1.0 - p.z / 2.0)).max(-p.z).max(p.z - 2.0);
    check(&set, Vec3::of(-2.0, -2.0, -1.0), Vec3::of(2.0, 2.0, 5.0), &exact);
    // Under the parabola y = 1 - x².
    let corner = [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 2.0, 0.0), Vec3::of(-1.0, 0.0, 0.0)];
    let on = |x: f64| (Vec3::of(x, 1.0 - x * x, 0.0), 1);
    let mut outline: Vec<(Vec3, u32)> = (0..8).map(|k| on(1.0 - 0.25 * f64::from(k))).collect();
    outline.push((corner[2], 2));
    let (points, triangles, sides) = prism(&outline);
    let shift = Vec3::of(0.0, 0.0, 2.0);
    let rounds = [Round { side: 1, profile: RoundProfile::Parabola(corner), shift, scale: 1.0 }];
    let body =
        Sides { points: &points, triangles: &triangles, sides: Some(&sides), rounds: &rounds };
    let set = faced(&body).unwrap();
    let exact = |p: Vec3| slab(p, (p.y - 1.0 + p.x * p.x).max(-p.y));
    check(&set, Vec3::of(-2.0, -1.0, -1.0), Vec3::of(2.0, 2.0, 3.0), &exact);
}

#[test]
fn half_spaces_move_with_the_vertices() {
    let (points, triangles) = cubes(2, &|c| c != [1, 1, 1]);
    // Everything beyond x = 1 stretches.
    let moved: Vec<Vec3<Dual<1>>> = (points.iter())
        .map(|p| {
            let x = if p.x > 1.0 { Dual::seeded(p.x, 0) } else { p.x.into() };
            Vec3::new(x, p.y.into(), p.z.into())
        })
        .collect();
    let body = Sides { points: &moved, triangles: &triangles, sides: None, rounds: &[] };
    let set = faced(&body).unwrap();
    let at = |x: f64, y: f64, z: f64| set.value(Vec3::<Dual<1>>::of(x, y, z));
    assert_eq!((at(2.0, 0.5, 0.5).re, at(2.0, 0.5, 0.5).eps[0]), (0.0, -1.0));
    assert_eq!((at(1.0, 1.5, 1.5).re, at(1.0, 1.5, 1.5).eps[0]), (0.0, 0.0));
}

#[test]
fn open_and_flat_bodies_are_refused() {
    let points = [Vec3::zero(), Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0)];
    assert_eq!(of(&points, &[[0, 1, 2]]).unwrap_err(), FieldError::NotClosed { edges: 3 });
    assert_eq!(of(&points, &[]).unwrap_err(), FieldError::NotClosed { edges: 0 });
    // Two triangles back to back hold nothing.
    let flat = of(&points, &[[0, 1, 2], [0, 2, 1]]).unwrap();
    assert!(flat.value(Vec3::of(0.2, 0.2, 0.0)) >= 0.0);
    let bad = [Vec3::of(f64::NAN, 0.0, 0.0), points[1], points[2]];
    assert!(matches!(of(&bad, &[[0, 1, 2], [0, 2, 1]]), Err(FieldError::NotFinite { .. })));
}
