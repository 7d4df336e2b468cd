//! Number of bodies, and their contacts, for bodies that touch in points and lines, share a face,
//! overlap or are apart. `MOLDLOFT_SOAK` makes 60 times as many.

use crate::common::{axis, sound, v};
use moldloft_field::{
    Affine, FacetOptions, Primitive, Resolution, Set, bounds, crossing_faces, facet,
};
use moldloft_num::{Box3, Vec3};
use moldloft_testing::{Random, rounds};

fn ball(x: f64, y: f64, z: f64, r: f64) -> Set {
    Set::new(&Primitive::sphere(v(x, y, z), r).unwrap())
}

fn bar(x: f64, y: f64, r: f64) -> Set {
    let round = Primitive::cylinder(axis(v(x, y, 0.0), v(0.0, 0.0, 1.0)), r).unwrap();
    Set::new(&round)
}

fn block(low: [f64; 3], high: [f64; 3]) -> Set {
    Set::cuboid(low.into(), high.into()).unwrap()
}

/// A set, its number of bodies, a contact if there is one, and whether triangles near it may
/// intersect.
fn case(kind: usize, random: &mut Random) -> (&'static str, Set, usize, Option<Vec3>, bool) {
    let mut between = |low: f64, high: f64| random.between(low, high);
    let (r, s) = (between(0.5, 1.2), between(0.3, 1.2));
    let slab = |low: f64, high: f64| block([-3.0, -3.0, low], [6.0, 3.0, high]);
    let unit = block([0.0; 3], [1.0, 1.0, 1.0]);
    match kind {
        0 => {
            let set = ball(0.0, 0.0, 0.0, r) | ball(r + s, 0.0, 0.0, s);
            ("balls", set, 2, Some(v(r, 0.0, 0.0)), false)
        }
        1 => {
            let plate = block([-1.5, -1.5, -0.4], [1.5, 1.5, 0.0]);
            ("ball on plate", plate | ball(0.1, 0.2, r, r), 2, Some(v(0.1, 0.2, 0.0)), false)
        }
        2 => {
            let set = (bar(0.0, 0.0, r) | bar(r + s, 0.0, s)) & slab(-0.7, 0.9);
            ("bars", set, 2, Some(v(r, 0.0, f64::NAN)), false)
        }
        3 => {
            let other = block([1.0, 1.0, -0.2], [1.0 + r, 1.0 + s, 1.1]);
            ("edge", unit | other, 2, Some(v(1.0, 1.0, f64::NAN)), false)
        }
        4 => {
            let other = block([1.0, 1.0, 1.0], [1.0 + r, 1.0 + s, 1.7]);
            ("corner", unit | other, 2, Some(v(1.0, 1.0, 1.0)), false)
        }
        5 => {
            let shell = ball(0.0, 0.0, 0.0, 1.8) - ball(0.0, 0.0, 0.0, 1.3);
            let inner = 0.3 + 0.3 * r;
            let set = shell | ball(0.0, 1.3 - inner, 0.0, inner);
            ("ball in a shell", set, 2, Some(v(0.0, 1.3, 0.0)), true)
        }
        6 => {
            let other = block([1.0, 0.2, 0.3], [1.0 + r, 0.8, 0.9]);
            ("face", unit | other, 1, None, false)
        }
        7 => {
            let set = ball(0.0, 0.0, 0.0, r) | ball(0.8 * (r + s), 0.0, 0.0, s);
            ("overlapping balls", set, 1, None, false)
        }
        8 => {
            let set = ball(0.0, 0.0, 0.0, r) | ball(1.25 * (r + s), 0.0, 0.0, s);
            ("balls apart", set, 2, None, false)
        }
        9 => {
            let third = ball(r + s, s + 0.6, 0.0, 0.6);
            let set = ball(0.0, 0.0, 0.0, r) | ball(r + s, 0.0, 0.0, s) | third;
            let near = libm::hypot(r + s, s + 0.6) < r + 0.6 + 0.2;
            match near {
                true => ("balls apart", ball(0.0, 0.0, 0.0, r), 1, None, false),
                false => ("three balls", set, 3, Some(v(r, 0.0, 0.0)), false),
            }
        }
        _ => {
            let set = ball(0.0, 0.0, 0.0, r) | ball(r + s, 0.0, 0.0, s);
            let tie = bar(0.0, 0.0, 0.2) | block([-0.1, -0.1, -0.1], [r + s, 0.1, 0.1]);
            ("balls that a bar joins", set | (tie & slab(-0.1, 0.1)), 1, None, false)
        }
    }
}

#[test]
fn bodies_that_touch_are_split_and_told() {
    const KINDS: usize = 11;
    for round in 0..rounds(2, 120) {
        for kind in 0..KINDS {
            let seed = (round * KINDS + kind) as u64;
            let mut random = Random::new(seed * 6151 + 3);
            let (name, set, bodies, place, cuts) = case(kind, &mut random);
            // As it is, in the box of its own, where contacts are at corners of cells; else anyhow.
            let mut between = |low: f64, high: f64| random.between(low, high);
            let a = axis(
                v(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)),
                v(between(-1.0, 1.0), between(-1.0, 1.0), 1.1),
            );
            let turn = Affine::rotation(&a, between(0.1, 3.0));
            let (set, moved) = match round % 2 {
                0 => (set, false),
                _ => (set.mapped(&turn).unwrap(), true),
            };
            let own = bounds(&set, 1e-3).unwrap().unwrap();
            let f = facet(&set, &own, &FacetOptions::new(Resolution::Depth(5))).unwrap();
            let reported = format!("{name}, seed {seed}: {:?}", f.touching());
            sound(&f);
            assert_eq!(f.bodies(), bodies, "{reported}");
            assert_eq!(!f.touching().is_empty(), place.is_some(), "{reported}");
            if let (Some(place), false) = (place, moved) {
                let off = |p: &Vec3| {
                    let d = *p - place;
                    [d.x, d.y, d.z]
                        .into_iter()
                        .filter(|x| x.is_finite())
                        .map(f64::abs)
                        .fold(0.0, f64::max)
                };
                assert!(f.touching().iter().any(|p| off(p) < 1e-4), "{reported}");
            }
            assert!(cuts || f.undecided.is_empty(), "{reported}: {:?}", f.undecided);
            for pair in crossing_faces(&f.mesh, None) {
                let corner = f.mesh.positions()[f.mesh.faces()[pair[0]][0] as usize];
                let near = |b: &Box3| b.centre().distance(corner) < 5.0 * f.step;
                assert!(!cuts || f.undecided.iter().any(near), "{reported}");
            }
        }
    }
}
