//! Distances of sets, and bodies: their number, and where they only touch.

use crate::common::{axis, cube, facets, sound, v};
use moldloft_field::{FieldError, Membership, Primitive, Set, distance};
use moldloft_num::Box3;

fn ball(x: f64, y: f64, z: f64, r: f64) -> Set {
    Set::new(&Primitive::sphere(v(x, y, z), r).unwrap())
}

#[test]
fn distances_of_known_pairs() {
    let over = cube(8.0);
    let pipe =
        Set::new(&Primitive::cylinder(axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)), 1.0).unwrap());
    let slanted =
        Set::new(&Primitive::cylinder(axis(v(4.0, 0.0, 0.0), v(0.0, 1.0, 0.3)), 0.5).unwrap());
    let ring =
        Set::new(&Primitive::torus(axis(v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)), 3.0, 0.5).unwrap());
    let block = Set::cuboid(v(1.0, 2.0, 3.0), v(2.0, 3.0, 4.0)).unwrap();
    let corner = (1.0f64 + 4.0 + 9.0).sqrt();
    for (name, a, b, exact) in [
        ("balls", ball(0.0, 0.0, 0.0, 1.0), ball(3.0, 4.0, 0.0, 0.5), 3.5),
        ("askew pipes", pipe.clone(), slanted, 2.5),
        ("ball and corner", ball(0.0, 0.0, 0.0, 1.0), block.clone(), corner - 1.0),
        ("ball in a ring", ball(1.0, 0.0, 0.0, 0.5), ring.clone(), 1.0),
        ("overlapping", ball(0.0, 0.0, 0.0, 1.0), ball(1.0, 0.0, 0.0, 1.0), 0.0),
        ("one in the other", ball(0.0, 0.0, 0.0, 2.0), ball(0.2, 0.0, 0.0, 1.0), 0.0),
    ] {
        let found = distance(&a, &b, &over, 1e-5).unwrap().unwrap();
        assert!((found.distance - exact).abs() < 1e-5, "{name}: {found:?}");
        assert!(found.at_least <= exact + 1e-12 && found.at_least >= exact - 2e-5, "{name}");
        assert!((found.first.distance(found.second) - found.distance).abs() < 1e-12);
        for (set, p) in [(&a, found.first), (&b, found.second)] {
            assert_ne!(set.member(p, 1e-7), Membership::Air, "{name}");
        }
    }
}

#[test]
fn distances_that_are_none() {
    let over = cube(2.0);
    let a = ball(0.0, 0.0, 0.0, 1.0);
    assert_eq!(distance(&a, &Set::nothing(), &over, 1e-3), Ok(None));
    assert_eq!(distance(&a, &ball(9.0, 0.0, 0.0, 1.0), &over, 1e-3), Ok(None));
    assert!(matches!(distance(&a, &a, &over, 0.0), Err(FieldError::NotPositive { .. })));
    let flat = Box3 { low: v(0.0, 0.0, 0.0), high: v(1.0, 1.0, 0.0) };
    assert!(matches!(distance(&a, &a, &flat, 1e-3), Err(FieldError::EmptyBox { .. })));
}

#[test]
fn bodies_and_cavities_are_counted() {
    let shell = ball(0.0, 0.0, 0.0, 1.5) - ball(0.1, 0.0, 0.0, 1.0);
    let f = facets(&(shell | ball(0.1, 0.0, 0.0, 0.3)), &cube(2.0), 6);
    let mut volumes: Vec<f64> = f.shells().iter().map(|s| s.volume).collect();
    volumes.sort_by(f64::total_cmp);
    let exact = [-1.0f64, 0.027, 3.375].map(|c| 4.0 / 3.0 * std::f64::consts::PI * c);
    for (found, exact) in volumes.iter().zip(exact) {
        assert!((found - exact).abs() < 0.02 * exact.abs(), "{volumes:?}");
    }
    assert_eq!((f.bodies(), f.shells().len()), (2, 3));
}

#[test]
fn bodies_that_only_touch_are_manifold_copies() {
    // At an edge, at a corner, and at a point of smooth surfaces.
    let cube_at =
        |x: f64, y: f64, z: f64| Set::cuboid(v(x, y, z), v(x + 0.9, y + 0.9, z + 0.9)).unwrap();
    let origin = cube_at(0.0, 0.0, 0.0);
    for (name, other, bodies) in [
        ("edge", cube_at(0.9, 0.9, 0.0), 2),
        ("corner", cube_at(0.9, 0.9, 0.9), 2),
        ("face", cube_at(0.9, 0.0, 0.0), 1),
    ] {
        let f = facets(&(origin.clone() | other), &cube(2.0), 5);
        sound(&f);
        assert_eq!(f.bodies(), bodies, "{name}");
        assert_eq!(f.touching().is_empty(), bodies == 1, "{name}: {:?}", f.touching());
    }
    let f = facets(&(ball(-1.0, 0.0, 0.0, 1.0) | ball(1.0, 0.0, 0.0, 1.0)), &cube(2.5), 5);
    sound(&f);
    assert!(f.bodies() <= 2);
}
