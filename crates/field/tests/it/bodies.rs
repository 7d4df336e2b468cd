//! A set is a body: offsets, shells, nearest points, membership and cut edges of parts face to face and of cutters that end
//! outside, beside closed forms and beside bodies that are known by their parts alone.
//! `MOLDLOFT_SOAK` makes the number of bodies 500.

use crate::common::{axis, v};
use moldloft_field::{
    FieldError, IntegralOptions, Membership, Primitive, Set, around, chamfer_edges, fillet_sets,
    mass, nearest, round_edges,
};
use moldloft_num::{Box3, Vec3};
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

fn cub(low: [f64; 3], high: [f64; 3]) -> Set {
    Set::cuboid(Vec3::from(low), Vec3::from(high)).unwrap()
}

fn volume(set: &Set) -> f64 {
    let over = around(set).unwrap().unwrap();
    let found = mass(set, &over, &IntegralOptions::default()).unwrap();
    let (bracket, best) = (found.bracket.volume(), found.best.volume());
    assert!(bracket.contains(best));
    best
}

fn check(set: &Set, exact: f64) {
    let found = volume(set);
    assert!((found - exact).abs() < 1e-6, "{found} {exact}");
}

fn drill(radius: f64) -> Set {
    Set::new(&Primitive::cylinder(axis(v(5.0, 5.0, 0.0), v(0.0, 0.0, 1.0)), radius).unwrap())
}

#[test]
fn offsets_and_shells_are_those_of_the_body() {
    let plate = cub([0.0; 3], [4.0, 4.0, 1.0]);
    for top in [1.0, 1.1, 3.0] {
        let pocketed = plate.clone() - cub([1.0, 1.0, 0.5], [3.0, 3.0, top]);
        check(&pocketed.offset(0.25).unwrap(), 29.25);
    }
    let window = cub([0.0; 3], [10.0, 10.0, 1.0]) - cub([2.0, 2.0, -1.0], [8.0, 8.0, 2.0]);
    check(&window.offset(1.0).unwrap(), 384.0);
    let drilled =
        cub([0.0; 3], [10.0, 10.0, 1.0]) - (drill(3.0) & cub([0.0, 0.0, -0.5], [10.0, 10.0, 1.5]));
    check(&drilled.offset(1.0).unwrap(), 432.0 - 12.0 * PI);
    let two = cub([0.0; 3], [1.0; 3]) | cub([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    check(&two.offset(-0.1).unwrap(), 1.152);
    check(&two.shell(0.1).unwrap(), 0.848);
    for base in [4.0, 3.8, 2.0] {
        let boss = cub([0.0; 3], [4.0; 3]) | cub([1.0, 1.0, base], [3.0, 3.0, 6.0]);
        check(&boss.shell(0.5).unwrap(), 43.0);
    }
    let bars = cub([0.0; 3], [3.0, 1.0, 1.0]) | cub([0.0; 3], [1.0, 3.0, 1.0]);
    check(&bars.shell(0.2).unwrap(), 5.0 - (2.6 * 0.6 + 0.6 * 2.0) * 0.6);
    let framed = cub([0.0; 3], [10.0, 10.0, 2.0]) - cub([4.0, 4.0, -1.0], [6.0, 6.0, 3.0]);
    check(&framed.shell(0.2).unwrap(), 192.0 - (9.6 * 9.6 - 2.4 * 2.4) * 1.6);
    let flush = cub([0.0; 3], [10.0, 10.0, 3.0]) - cub([3.0, 3.0, 2.0], [7.0, 7.0, 3.0]);
    check(&flush.shell(0.2).unwrap(), 284.0 - (9.6 * 9.6 * 2.6 - 4.4 * 4.4));
    // Offsets stack, and undo each other where nothing closes.
    check(&framed.offset(0.3).unwrap().offset(-0.2).unwrap().offset(-0.1).unwrap(), 192.0);
}

#[test]
fn a_carrying_handle_keeps_its_notches_and_hole() {
    let body = cub([0.0; 3], [320.0, 100.0, 1.0]);
    let notch = |x: f64| cub([x, 80.0, -1.0], [x + 40.0, 101.0, 2.0]);
    let hole = cub([100.0, 20.0, -1.0], [220.0, 50.0, 2.0]);
    let handle = ((body - notch(20.0)) - notch(260.0)) - hole;
    let section = 330.0 * 110.0 - 2.0 * 30.0 * 20.0 - 110.0 * 20.0;
    check(&handle.offset(5.0).unwrap(), section * 11.0);
}

#[test]
fn chamfers_and_rounds_are_those_of_the_body() {
    let cut = |set: &Set, width: f64| volume(&chamfer_edges(set, width, None).unwrap());
    let two = cub([0.0; 3], [1.0; 3]) | cub([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    let one = cub([0.0; 3], [2.0, 1.0, 1.0]);
    assert!((cut(&two, 0.1) - 1.926).abs() < 1e-4, "{}", cut(&two, 0.1));
    assert!((cut(&two, 0.1) - cut(&one, 0.1)).abs() < 1e-9);
    let soft = |set: &Set| round_edges(set, 0.1, moldloft_field::CIRCULAR, None).unwrap();
    let mut random = Random::new(4);
    let mut alike = |a: &Set, b: &Set, size: [f64; 3]| {
        for _ in 0..3000 {
            let p = Vec3::from(size.map(|x| random.between(-0.1, x + 0.1)));
            assert_eq!(a.value(p) < 0.0, b.value(p) < 0.0, "{p:?}");
        }
    };
    alike(&soft(&two), &soft(&one), [2.0, 1.0, 1.0]);
    for base in [4.0, 2.0] {
        let boss = cub([0.0; 3], [10.0, 6.0, 4.0]) | cub([3.0, 2.0, base], [7.0, 4.0, 6.0]);
        assert!((cut(&boss, 0.3) - 251.743).abs() < 1e-3, "{}", cut(&boss, 0.3));
    }
    // At the corners of a pocket's rim the chamfers meet in a mitre; the cutter may end outside.
    let block = cub([0.0; 3], [10.0, 6.0, 4.0]);
    for top in [4.0, 4.1, 4.9] {
        let pocketed = block.clone() - cub([3.0, 2.0, 2.0], [7.0, 4.0, top]);
        let lost = cut(&block, 0.3) - cut(&pocketed, 0.3);
        let rim = 16.0 + 6.0 * 0.3_f64.powi(2) + 4.0 / 3.0 * 0.3_f64.powi(3);
        assert!((lost - rim).abs() < 1e-6, "{lost} for {rim}");
    }
    let pocket =
        |top: f64| cub([0.0; 3], [10.0, 10.0, 1.0]) - cub([2.0, 2.0, 0.5], [8.0, 8.0, top]);
    alike(&soft(&pocket(1.0)), &soft(&pocket(1.5)), [10.0, 10.0, 1.0]);
}

#[test]
fn a_post_is_filleted_whether_it_stands_on_the_plate_or_is_let_in() {
    let plate = cub([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]);
    let pipe = Primitive::cylinder(axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)), 1.0).unwrap();
    let square = |foot: f64| cub([-1.0, -1.0, foot], [1.0, 1.0, 2.0]);
    let round = |foot: f64| Set::new(&pipe) & cub([-2.0, -2.0, foot], [2.0, 2.0, 2.0]);
    let fillet =
        |post: &Set| fillet_sets([&plate, post], [0.5; 2], moldloft_field::CIRCULAR, None).unwrap();
    let mut random = Random::new(5);
    for post in [&square as &dyn Fn(f64) -> Set, &round] {
        let let_in = fillet(&post(-1.0));
        // The middle of the arc of radius 0.5 about (1.5, 0.5).
        let reach = 1.5 - 0.5 * 0.5_f64.sqrt();
        assert!(let_in.value(v(reach - 1e-3, 0.0, reach - 1.0 - 1e-3)) < 0.0);
        assert!(let_in.value(v(reach + 1e-3, 0.0, reach - 1.0 + 1e-3)) > 0.0);
        for foot in [0.0, -0.5] {
            let found = fillet(&post(foot));
            for _ in 0..3000 {
                let p = v(
                    random.between(-2.1, 2.1),
                    random.between(-2.1, 2.1),
                    random.between(-0.2, 0.7),
                );
                assert_eq!(found.value(p) < 0.0, let_in.value(p) < 0.0, "{foot} {p:?}");
            }
        }
    }
}

#[test]
fn blends_stack() {
    let pipe = |x: f64, dir: Vec3, r: f64| {
        Set::new(&Primitive::cylinder(axis(v(x, 0.0, 0.0), dir), r).unwrap())
    };
    let run = pipe(0.0, v(1.0, 0.0, 0.0), 1.0) & cub([-6.0, -3.0, -3.0], [6.0, 3.0, 3.0]);
    let branch =
        |x: f64| pipe(x, v(0.0, 0.0, 1.0), 0.5) & cub([x - 1.0, -1.0, 0.0], [x + 1.0, 1.0, 3.0]);
    let fillet =
        |a: &Set, b: &Set| fillet_sets([a, b], [0.3, 0.3], moldloft_field::CIRCULAR, None).unwrap();
    let once = fillet(&run, &(branch(-3.0) | branch(3.0)));
    let stacked = fillet(&fillet(&run, &branch(-3.0)), &branch(3.0));
    assert!((volume(&once) - volume(&stacked)).abs() < 1e-5);
    let block = cub([0.0; 3], [4.0, 3.0, 2.0]);
    let soft = round_edges(&block, 0.2, moldloft_field::CIRCULAR, None).unwrap();
    let post = cub([1.0, 1.0, 1.0], [2.0, 2.0, 4.0]);
    let joined = fillet(&soft, &post);
    // In the fillet between the post and the top, and above it.
    let inside = v(0.95, 1.5, 2.03);
    assert!(joined.value(inside) < 0.0 && (soft | post).value(inside) > 0.0);
    assert!(joined.value(v(0.85, 1.5, 2.15)) > 0.0);
}

#[test]
fn hidden_faces_are_no_surface() {
    let two = cub([0.0; 3], [1.0; 3]) | cub([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    let over = around(&two).unwrap().unwrap();
    for x in [1.0, 1.01, 0.97] {
        let found = nearest(&two, v(x, 0.5, 0.5), &over, 1e-6).unwrap().unwrap();
        assert!((found.distance - 0.5).abs() < 1e-9 && found.at_least > 0.5 - 2e-6, "{found:?}");
    }
    assert_eq!(two.member(v(1.0, 0.5, 0.5), 1e-9), Membership::Solid);
    assert_eq!(two.member(v(1.0, 1.0, 0.5), 1e-9), Membership::Surface);
    let cavities = cub([0.0; 3], [2.0, 1.0, 1.0])
        - (cub([0.5, 0.2, 0.2], [1.0, 0.8, 0.8]) | cub([1.0, 0.2, 0.2], [1.5, 0.8, 0.8]));
    assert_eq!(cavities.member(v(1.0, 0.5, 0.5), 1e-9), Membership::Air);
    // A cylinder on its tangent plane: surface along the line, visible from one of its sides only.
    let ground = cub([-5.0, -5.0, -2.0], [5.0, 5.0, 0.0]);
    let lying =
        Set::new(&Primitive::cylinder(axis(v(0.0, 0.0, 1.0), v(1.0, 0.0, 0.0)), 1.0).unwrap());
    let both = ground | (lying & cub([-2.0, -2.0, -1.0], [2.0, 2.0, 3.0]));
    assert_eq!(both.member(v(0.0, 0.0, 0.0), 1e-9), Membership::Surface);
}

/// A part with a known formula.
#[derive(Clone, Debug)]
enum Part {
    Cuboid([f64; 3], [f64; 3]),
    /// Axis, centre of the base, radius, height.
    Cylinder(usize, [f64; 3], f64, f64),
    Ball([f64; 3], f64),
}

impl Part {
    fn random(random: &mut Random, whole: bool, round: bool) -> Self {
        let number = |r: &mut Random, low: f64, high: f64| match whole {
            true => low.ceil() + r.below((high - low.ceil()) as usize + 1) as f64,
            false => r.between(low, high),
        };
        let at = [0; 3].map(|_| number(random, 0.0, 3.0));
        match if round { random.below(3) } else { 0 } {
            0 => Part::Cuboid(at, at.map(|x| x + number(random, 0.6, 3.0))),
            1 => {
                let axis = random.below(3);
                Part::Cylinder(axis, at, number(random, 0.5, 2.0), number(random, 0.6, 3.0))
            }
            _ => Part::Ball(at, number(random, 0.5, 2.0)),
        }
    }

    fn set(&self) -> Set {
        match self {
            Part::Cuboid(low, high) => cub(*low, *high),
            Part::Cylinder(k, at, r, h) => {
                let mut up = [0.0; 3];
                up[*k] = 1.0;
                let (up, at) = (Vec3::from(up), Vec3::from(*at));
                let side = Primitive::cylinder(axis(at, up), *r).unwrap();
                let top = Primitive::plane(up, at + up * *h).unwrap();
                let base = Primitive::plane(-up, at).unwrap();
                Set::new(&side) & Set::new(&top) & Set::new(&base)
            }
            Part::Ball(at, r) => Set::new(&Primitive::sphere(Vec3::from(*at), *r).unwrap()),
        }
    }

    /// Inside of the part grown by `more` along its normals.
    fn holds(&self, p: Vec3, more: f64) -> bool {
        match self {
            Part::Cuboid(low, high) => {
                (0..3).all(|k| p[k] > low[k] - more && p[k] < high[k] + more)
            }
            Part::Cylinder(k, at, r, h) => {
                let d = p - Vec3::from(*at);
                let aside = (d.norm_sq() - d[*k] * d[*k]).max(0.0).sqrt();
                d[*k] > -more && d[*k] < h + more && aside < r + more
            }
            Part::Ball(at, r) => p.distance(Vec3::from(*at)) < r + more,
        }
    }

    /// Points of its surface, with normals.
    fn surface(&self, count: usize, random: &mut Random) -> Vec<(Vec3, Vec3)> {
        (0..count)
            .map(|_| match self {
                Part::Cuboid(low, high) => {
                    let (k, side) = (random.below(3), random.below(2));
                    let mut p = [0, 1, 2].map(|j| random.between(low[j], high[j]));
                    p[k] = if side == 0 { low[k] } else { high[k] };
                    let mut n = [0.0; 3];
                    n[k] = 1.0;
                    (Vec3::from(p), Vec3::from(n))
                }
                Part::Cylinder(k, at, r, h) => {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let turn = random.between(0.0, 2.0 * PI);
                    let (mut p, mut n) = (*at, [0.0; 3]);
                    let (at_side, share) = (random.chance(60), random.unit().sqrt());
                    let reach = if at_side { *r } else { r * share };
                    p[i] += reach * turn.cos();
                    p[j] += reach * turn.sin();
                    if at_side {
                        p[*k] += random.between(0.0, *h);
                        (n[i], n[j]) = (turn.cos(), turn.sin());
                    } else {
                        p[*k] += if random.chance(50) { *h } else { 0.0 };
                        n[*k] = 1.0;
                    }
                    (Vec3::from(p), Vec3::from(n))
                }
                Part::Ball(at, r) => {
                    let n = direction(random);
                    (Vec3::from(*at) + n * *r, n)
                }
            })
            .collect()
    }
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let p = v(random.signed(), random.signed(), random.signed());
        if p.norm() <= 1.0 && p.norm() > 0.1 {
            return p / p.norm();
        }
    }
}

/// A body by its parts: each united with the previous ones, or cut from them.
#[derive(Debug)]
struct Known(Vec<(Part, bool)>);

impl Known {
    fn random(random: &mut Random, whole: bool, round: bool) -> Self {
        let count = 2 + random.below(3);
        let part = |k: usize, random: &mut Random| {
            (Part::random(random, whole, round), k == 0 || random.chance(55))
        };
        Self((0..count).map(|k| part(k, random)).collect())
    }

    fn set(&self) -> Set {
        self.0.iter().fold(Set::nothing(), |s, (part, joined)| match joined {
            true => s | part.set(),
            false => s - part.set(),
        })
    }

    fn holds(&self, p: Vec3) -> bool {
        self.0.iter().fold(false, |inside, (part, joined)| match (part.holds(p, 0.0), joined) {
            (true, joined) => *joined,
            (false, _) => inside,
        })
    }

    /// Points of the body's surface.
    fn surface(&self, count: usize, random: &mut Random) -> Vec<Vec3> {
        let all =
            self.0.iter().flat_map(|(part, _)| part.surface(count, random)).collect::<Vec<_>>();
        let shows =
            |(p, n): &(Vec3, Vec3)| self.holds(*p + *n * 1e-7) != self.holds(*p - *n * 1e-7);
        all.into_iter().filter(shows).map(|(p, _)| p).collect()
    }
}

fn bodies(seed: u64, round: bool, mut each: impl FnMut(usize, &Known, &Set, &mut Random)) {
    let mut random = Random::new(seed);
    for case in 0..rounds(24, 500) {
        let known = Known::random(&mut random, case % 2 == 0, round);
        let set = known.set();
        each(case, &known, &set, &mut random);
    }
}

#[test]
fn membership_is_that_of_a_tiny_ball() {
    let (mut wrong, mut asked, mut touching) = (0, 0, 0);
    bodies(3, true, |case, known, set, random| {
        let body = set.as_body();
        for (part, _) in &known.0 {
            for (p, _) in part.surface(12, random) {
                // Half of them at a corner of the grid, where many faces meet.
                let p = if random.chance(30) { p.map(f64::round) } else { p };
                let found = body.member(p, 1e-9, &[]);
                let inside = (0..400)
                    .filter(|_| known.holds(p + direction(random) * (1e-5 * random.unit())))
                    .count();
                let right = match inside {
                    0 => Membership::Air,
                    400 => Membership::Solid,
                    _ => Membership::Surface,
                };
                asked += 1;
                match (found, right) {
                    (a, b) if a == b => {}
                    // A cusp thinner than the ball's points are apart.
                    (Membership::Surface, _) => touching += 1,
                    _ => {
                        wrong += 1;
                        println!("case {case} at {p:?}: {found:?}, right {right:?} {known:?}");
                    }
                }
            }
        }
    });
    println!("{asked} points, {wrong} wrong, {touching} in cusps");
    assert_eq!(wrong, 0);
    assert!(touching * 100 <= asked, "{touching} of {asked}");
}

#[test]
fn nearest_points_are_as_near_as_any_of_the_surface() {
    let mut asked = 0;
    bodies(5, true, |case, known, set, random| {
        let Some(over) = around(set).unwrap() else { return };
        let cloud = known.surface(3000, random);
        for _ in 0..3 {
            let p = Vec3::from([0, 1, 2].map(|k| random.between(over.low[k], over.high[k])));
            let Some(found) = nearest(set, p, &over, 1e-4).unwrap() else {
                assert!(cloud.is_empty(), "case {case}: no surface found");
                continue;
            };
            let near = cloud.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            asked += 1;
            assert!(found.distance <= near + 1e-3, "case {case}: {found:?} {near} {p:?} {known:?}");
            assert!(found.at_least <= near + 1e-12, "case {case}: {found:?} {near}");
            assert!(near < found.distance + 0.4, "case {case}: {found:?} {near} {known:?}");
            let inside = (0..400)
                .filter(|_| known.holds(found.point + direction(random) * (1e-5 * random.unit())))
                .count();
            assert!(inside > 0 && inside < 400, "case {case}: {found:?} is no surface {known:?}");
        }
    });
    assert!(asked > 40);
}

/// True if a body of boxes meets the box of half side `d` around a point: its dilation by a cube.
fn dilated(known: &Known, p: Vec3, d: f64) -> bool {
    let cuts: Vec<Vec<f64>> = (0..3)
        .map(|k| {
            let mut all = vec![p[k] - d, p[k] + d];
            for (part, _) in &known.0 {
                if let Part::Cuboid(low, high) = part {
                    all.extend([low[k], high[k]]);
                }
            }
            all.retain(|x| *x >= p[k] - d && *x <= p[k] + d);
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        })
        .collect();
    let middle = |k: usize, i: usize| 0.5 * (cuts[k][i] + cuts[k][i + 1]);
    (0..cuts[0].len() - 1).any(|i| {
        (0..cuts[1].len() - 1).any(|j| {
            (0..cuts[2].len() - 1).any(|l| known.holds(v(middle(0, i), middle(1, j), middle(2, l))))
        })
    })
}

#[test]
fn offsets_of_boxes_are_dilations_by_cubes() {
    let mut asked = 0;
    bodies(7, false, |case, known, set, random| {
        let d = random.between(0.05, 0.5);
        let (grown, shrunk) = (set.offset(d).unwrap(), set.offset(-d).unwrap());
        for _ in 0..300 {
            let p = Vec3::from([0; 3].map(|_| random.between(-1.0, 7.0)));
            asked += 1;
            assert_eq!(
                grown.value(p) < 0.0,
                dilated(known, p, d),
                "case {case} {p:?} {d} {known:?}"
            );
            // The complement within a larger box.
            let hollow = Known(
                [(Part::Cuboid([-9.0; 3], [15.0; 3]), true)]
                    .into_iter()
                    .chain(known.0.iter().map(|(part, joined)| (part.clone(), !joined)))
                    .collect(),
            );
            assert_eq!(
                shrunk.value(p) < 0.0,
                !dilated(&hollow, p, d),
                "case {case} {p:?} {d} {known:?}"
            );
        }
    });
    println!("{asked} points");
}

#[test]
fn offsets_of_round_bodies_lie_between_those_of_a_ball_and_their_mitres() {
    let (mut asked, mut refused) = (0, 0);
    bodies(9, true, |case, known, set, random| {
        let d = random.between(0.05, 0.4);
        asked += 1;
        let (grown, shrunk) = match (set.offset(d), set.offset(-d)) {
            (Ok(a), Ok(b)) => (a, b),
            (Err(FieldError::HiddenEdge { .. }), _) | (_, Err(FieldError::HiddenEdge { .. })) => {
                refused += 1;
                return;
            }
            (a, b) => panic!("case {case}: {a:?} {b:?} {known:?}"),
        };
        let cloud = known.surface(4000, random);
        for _ in 0..100 {
            let p = Vec3::from([0; 3].map(|_| random.between(-2.0, 7.0)));
            let near = cloud.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            let inside = known.holds(p);
            if inside || near < d - 1e-9 {
                assert!(grown.value(p) <= 0.0, "case {case} {p:?} {d} {near} {known:?}");
            }
            if !inside || near < d - 1e-9 {
                assert!(shrunk.value(p) >= 0.0, "case {case} {p:?} {d} {near} {known:?}");
            }
            // Unions of convex parts are those of their parts, grown one by one.
            if known.0.iter().all(|(_, joined)| *joined) {
                let right = known.0.iter().any(|(part, _)| part.holds(p, d));
                assert_eq!(grown.value(p) < 0.0, right, "case {case} {p:?} {d} {known:?}");
            }
        }
    });
    println!("{asked} bodies, {refused} with a mitre inside");
    assert!(2 * refused <= asked, "{refused} of {asked}");
}

#[test]
fn a_point_of_a_large_box_is_found() {
    let over = Box3 { low: v(-1.0, -1.0, -1.0), high: v(3.0, 2.0, 2.0) };
    let wall = cub([0.0; 3], [2.0, 1.0, 0.001]) | cub([0.0, 0.0, 0.001], [2.0, 1.0, 0.002]);
    let found = nearest(&wall, v(1.0, 0.5, 0.0012), &over, 1e-7).unwrap().unwrap();
    assert!((found.distance - 0.0008).abs() < 1e-9, "{found:?}");
}

#[test]
fn bodies_of_planes_have_the_fewest_triangles() {
    use moldloft_field::{Affine, FacetOptions, Resolution, facet};
    let facets = |set: &Set| {
        let over = around(set).unwrap().unwrap();
        facet(set, &over, &FacetOptions::new(Resolution::Level(6))).unwrap()
    };
    let exact = |set: &Set, volume: f64, triangles: usize| {
        let made = facets(set);
        let report = made.mesh.report();
        assert!(report.closed && report.manifold && report.oriented);
        assert_eq!(made.mesh.faces().len(), triangles);
        assert!((made.moments().volume() - volume).abs() < 1e-12 * (1.0 + volume));
    };
    let block = cub([0.0; 3], [2.0, 1.0, 1.0]);
    exact(&block, 2.0, 12);
    exact(&(cub([0.0; 3], [1.0; 3]) | cub([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])), 2.0, 12);
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.3, 1.0]];
    let [a, b, c, d] = corners.map(Vec3::from);
    let below = v(0.3, 0.2, -0.8);
    let pair =
        Set::tetrahedron([a, b, c, d]).unwrap() | Set::tetrahedron([a, b, c, below]).unwrap();
    exact(&pair, 1.0 / 6.0 + 0.8 / 6.0, 6);
    let pocketed = cub([0.0; 3], [4.0, 4.0, 1.0]) - cub([1.0, 1.0, 0.5], [3.0, 3.0, 2.0]);
    exact(&pocketed, 14.0, 28);
    let window = cub([0.0; 3], [4.0, 4.0, 1.0]) - cub([1.0, 1.0, -0.5], [3.0, 3.0, 2.0]);
    exact(&window, 12.0, 32);
    // Turned boxes, joined and cut by turns, beside the means of cells.
    let mut random = Random::new(21);
    let mut joined = Set::nothing();
    for k in 0..rounds(12, 100) {
        let turn =
            Affine::rotation(&axis(Vec3::zero(), direction(&mut random)), random.between(0.0, 3.0));
        let at = Affine::translation(v(random.signed(), random.signed(), random.signed()) * 1.5);
        let part =
            cub([-0.4, -0.3, -0.2], [0.4, 0.3, 0.2]).mapped(&turn).unwrap().mapped(&at).unwrap();
        joined = if k % 3 == 2 { joined - part } else { joined | part };
    }
    let made = facets(&joined);
    let report = made.mesh.report();
    assert!(report.closed && report.manifold && report.oriented && made.cells == 0);
    let over = around(&joined).unwrap().unwrap();
    let range = moldloft_field::bracket(&joined, &over, 7).unwrap().volume();
    assert!(range.contains(made.moments().volume()), "{range:?} {}", made.moments().volume());
    assert!(made.mesh.faces().len() < 6000);
    println!("{} triangles", made.mesh.faces().len());
}

#[test]
fn jumps_that_are_no_faces_leave_nothing_open() {
    use moldloft_field::{FacetOptions, Resolution, facet};
    let [x, y, z] = Primitive::<f64>::axes();
    let radius = (x.power(2) + y.power(2)).sqrt();
    let turn = y.atan2(&x);
    let open = |set: &Set, low: [f64; 3], high: [f64; 3]| {
        let over = Box3 { low: Vec3::from(low), high: Vec3::from(high) };
        let made = facet(set, &over, &FacetOptions::new(Resolution::Depth(5))).unwrap();
        println!(
            "{} open, {} blunt, {} cells",
            made.unresolved.len(),
            made.blunt.len(),
            made.cells
        );
        made.unresolved.len()
    };
    // A bolt, whose surface is smooth across the cut of the angle.
    let bolt = Set::new(&(&radius - ((&z * (2.0 * PI) - &turn).cos() * 0.35 + 3.6)));
    let ends = cub([-5.0, -5.0, -1.0], [5.0, 5.0, 1.0]);
    assert!(open(&(bolt & ends), [-4.5, -4.6, -1.4], [4.4, 4.5, 1.3]) <= 40);
    // A repeated ball that stays off the ends of its period.
    let period = z.remainder(&Primitive::real(2.0)).unwrap() - 1.0;
    let balls = Set::new(&((x.power(2) + y.power(2) + period.power(2)).sqrt() - 0.7));
    let tray = balls & cub([-2.0, -2.0, 0.1], [2.0, 2.0, 7.9]);
    assert!(open(&tray, [-1.0, -1.1, -0.2], [1.1, 1.0, 8.1]) <= 40);
    // Two materials with a face in common.
    let block = cub([-1.0; 3], [1.0; 3]);
    let ball = Set::new(&Primitive::sphere(Vec3::zero(), 0.6).unwrap());
    let both = (block - ball.clone()) | ball;
    assert_eq!(open(&both, [-1.2, -1.3, -1.25], [1.3, 1.2, 1.15]), 0);
}

#[test]
fn a_mitre_inside_of_the_body_is_refused_where_it_would_stand_out() {
    // A wedge with an edge of 10 degrees, let into a plate by less than its mitre is long.
    let plate = cub([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
    let side = |sign: f64| {
        let normal = v(10f64.to_radians().cos() * sign, 0.0, -(10f64.to_radians().sin()));
        Set::new(&Primitive::plane(normal, v(0.0, 0.0, -0.3)).unwrap())
    };
    let wedge = side(1.0) & side(-1.0) & cub([-2.0, -2.0, -2.0], [2.0, 2.0, 3.0]);
    let both = plate.clone() | wedge.clone();
    // Two wedges that share the edge, one over a part of the other.
    let pair = |shift: f64| {
        let part = |y: f64| wedge.clone() & cub([-2.0, y - 1.0, -2.0], [2.0, y + 1.0, 3.0]);
        plate.clone() | part(-shift) | part(shift)
    };
    for body in [both, pair(0.5), pair(0.0), pair(0.9)] {
        assert!(body.offset(0.05).is_ok());
        let refused = body.offset(0.5).err();
        assert!(
            matches!(refused, Some(moldloft_field::FieldError::HiddenEdge { .. })),
            "{refused:?}"
        );
    }
}
