//! Facets: closed forms, sharp edges and corners, the T-piece, bad input.

use crate::common::{at_depth, axis, cube, facets, sound, t_piece, v, volume};
use moldloft_field::{
    FacetOptions, FieldError, Primitive, Resolution, Set, crossing_faces, facet, refacet,
};
use moldloft_num::{Box3, Vec3};
use std::f64::consts::PI;

#[test]
fn closed_forms_converge_at_second_order() {
    let z = axis(v(0.02, 0.01, 0.03), v(0.1, 0.2, 1.0));
    let solid = |p: Result<Primitive, FieldError>| Set::new(&p.unwrap());
    let bore = solid(Primitive::cylinder(z, 0.6));
    let other = solid(Primitive::cylinder(axis(z.point, z.direction.perpendicular()), 1.0));
    let ball = solid(Primitive::sphere(z.point, 1.0));
    let ring = 2.0 * (1.0f64 - 0.36).sqrt();
    let cases = [
        ("sphere", ball.clone(), 4.0 * PI / 3.0),
        ("torus", solid(Primitive::torus(z, 0.9, 0.4)), 2.0 * PI * PI * 0.9 * 0.16),
        ("steinmetz", solid(Primitive::cylinder(z, 1.0)) & other, 16.0 / 3.0),
        ("napkin ring", ball - bore, PI * ring.powi(3) / 6.0),
    ];
    for (name, set, exact) in cases {
        let error = |depth| {
            let f = facets(&set, &cube(2.0), depth);
            sound(&f);
            assert!(f.worst_vertex() <= 1e-12 * 4.0 * 3f64.sqrt(), "{name}: {}", f.worst_vertex());
            // The rims of the ring are thinner than a cell in places, at this size.
            assert!(f.undecided.is_empty(), "{name}: {}", f.undecided.len());
            assert!(f.blunt.len() * 500 <= f.cells, "{name}: {}", f.blunt.len());
            volume(&f) - exact
        };
        let (coarse, fine) = (error(5), error(6));
        let rate = (coarse / fine).log2();
        assert!((rate - 2.0).abs() < 0.2, "{name}: {coarse} {fine}, rate {rate}");
        assert!(fine.abs() < 4e-3 * exact, "{name}: {fine}");
    }
}

#[test]
fn edges_and_corners_are_sharp() {
    // A rotated cube has its exact volume: every edge and corner is exact.
    let turn = moldloft_field::Affine::rotation(&axis(v(0.1, 0.0, 0.2), v(1.0, 2.0, 3.0)), 0.7);
    let set = Set::cuboid(v(-1.0, -0.7, -0.5), v(0.9, 0.8, 0.6)).unwrap().mapped(&turn).unwrap();
    let f = facets(&set, &cube(2.0), 5);
    let report = sound(&f);
    assert_eq!((report.euler, report.components), (2, 1));
    assert!((volume(&f) - 1.9 * 1.5 * 1.1).abs() < 1e-12, "{}", volume(&f));
    assert_eq!(f.surfaces.iter().filter(|s| s.len() == 3).count(), 8);
    assert!(f.undecided.is_empty() && f.blunt.is_empty());
    assert_eq!(f.mesh.patches().len(), 6);
}

#[test]
fn the_box_caps_what_runs_out_and_its_faces_are_named() {
    let [x, _, z] = Primitive::<f64>::axes();
    let wave = Set::new(&(&z + (&x * 3.0).sin() * 0.3)).named("wave");
    let f = facets(&wave, &cube(2.0), 5);
    let report = sound(&f);
    assert_eq!(report.euler, 2);
    let names: Vec<&str> = f.mesh.patches().iter().map(|p| p.info.name.as_str()).collect();
    assert_eq!(names, ["wave", "cap -x", "cap +x", "cap -y", "cap +y", "cap -z"]);
    assert!((volume(&f) - 32.0).abs() < 0.01);
    let everything = facets(&Set::everything(), &cube(1.0), 3);
    assert!((volume(&everything) - 8.0).abs() < 1e-12 && everything.mesh.patches().len() == 6);
    let nothing = facets(&Set::nothing(), &cube(1.0), 3);
    assert!(nothing.mesh.faces().is_empty() && nothing.cells == 0);
}

#[test]
fn the_t_piece_is_one_ball() {
    let f = facets(&t_piece(), &cube(4.0), 7);
    let report = sound(&f);
    assert_eq!((report.components, report.euler), (1, 2));
    assert!(f.worst_vertex() <= 1e-12 * 8.0 * 3f64.sqrt(), "{}", f.worst_vertex());
    assert!((volume(&f) - 25.097).abs() < 0.02, "{}", volume(&f));
    assert!((30_000..45_000).contains(&report.faces), "{}", report.faces);
    let d = f.centre_distances();
    let rms = (d.iter().map(|x| x * x).sum::<f64>() / d.len() as f64).sqrt();
    assert!(rms <= 3.5e-4, "{rms}");
    assert!(crossing_faces(&f.mesh, None).is_empty());
    assert!(f.undecided.is_empty(), "{}", f.undecided.len());
}

#[test]
fn the_bored_t_piece_has_three_openings() {
    let pipe = |d: Vec3, r: f64| Set::new(&Primitive::cylinder(axis(Vec3::zero(), d), r).unwrap());
    let s = v(1.0, 0.0, 1.0);
    let beyond = Set::new(&Primitive::plane(-s, Vec3::zero()).unwrap());
    let bore = pipe(v(1.0, 0.0, 0.0), 0.8) | (pipe(s, 0.4) & beyond);
    // The walls are 0.2 thick: cells of 0.0625 tell their sides apart, those of 0.125 would not.
    let f = facets(&(t_piece() - bore.named("bore")), &cube(4.0), 7);
    let report = sound(&f);
    // A closed skin round a duct with three ends has two handles.
    assert_eq!((report.components, report.euler), (1, -2));
    assert!(f.mesh.patches().iter().any(|p| p.info.name == "bore" && p.info.kind == "cylinder"));
    assert!(f.undecided.is_empty() && f.blunt.is_empty());
    assert!(f.worst_vertex() <= 1e-12 * 8.0 * 3f64.sqrt());
}

#[test]
fn tiny_huge_and_distant_bodies_are_as_good() {
    let shape = |at: Vec3, size: f64| {
        let ball = Set::new(&Primitive::sphere(at, size).unwrap());
        let bore = axis(at, v(0.3, 0.2, 1.0));
        ball - Set::new(&Primitive::cylinder(bore, 0.5 * size).unwrap())
    };
    let relative = |at: Vec3, size: f64| {
        let half = v(1.5, 1.5, 1.5) * size;
        let f = facets(&shape(at, size), &Box3 { low: at - half, high: at + half }, 6);
        assert_eq!(sound(&f).euler, 0, "{at:?} {size}");
        let epsilon = 1e-12 * size + 16.0 * f64::EPSILON * at.norm();
        assert!(f.worst_vertex() <= epsilon, "{at:?} {size}: {}", f.worst_vertex());
        // Volumes by cones from the origin lose digits there: measure from the body.
        let near: Vec<Vec3> = f.mesh.positions().iter().map(|p| *p - at).collect();
        let near = moldloft_mesh::Mesh::new(f.mesh.topology().clone(), near).unwrap();
        moldloft_mesh::measure(&near).volume / size.powi(3)
    };
    let plain = relative(Vec3::zero(), 1.0);
    for (at, size) in [
        (v(1.0, 0.0, 0.0), 1e-4),
        (v(1e4, -1e4, 3e3), 1.0),
        (v(0.0, 0.0, 0.0), 1e6),
        (v(0.0, 0.0, 0.0), 1e-9),
    ] {
        let here = relative(at, size);
        assert!((here - plain).abs() < 1e-3, "{at:?} {size}: {here} {plain}");
    }
}

#[test]
fn accuracy_is_kept() {
    let torus =
        Set::new(&Primitive::torus(axis(Vec3::zero(), v(0.0, 0.3, 1.0)), 1.0, 0.3).unwrap());
    for accuracy in [1e-2, 1e-3, 3e-4] {
        let f =
            facet(&torus, &cube(1.5), &FacetOptions::new(Resolution::Accuracy(accuracy))).unwrap();
        assert!(f.worst_centre() <= accuracy);
        assert!(sound(&f).euler == 0);
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let many = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let run = || facets(&t_piece(), &cube(4.0), 5);
    assert_eq!(one.install(run).mesh, many.install(run).mesh);
}

#[test]
fn an_edit_recomputes_the_boxes_it_touches() {
    let ball = |k: usize, r: f64| {
        let at = v((k % 10) as f64, (k / 10) as f64, 0.0);
        Set::new(&Primitive::sphere(at, r).unwrap())
    };
    let field = |edited: f64| {
        (0..100).fold(Set::nothing(), |s, k| s | ball(k, if k == 37 { edited } else { 0.4 }))
    };
    let over = Box3 { low: v(-1.0, -1.0, -1.0), high: v(10.0, 10.0, 1.0) };
    let before = facets(&field(0.4), &over, 7);
    let after = refacet(&field(0.45), &over, &at_depth(7), Some(&before)).unwrap();
    let scratch = facets(&field(0.45), &over, 7);
    assert_eq!(after.mesh, scratch.mesh);
    assert_eq!(after.surfaces, scratch.surfaces);
    assert_eq!(before.computed, before.blocks);
    // The ball of radius 0.45 meets at most 3 x 3 x 3 blocks of 8 cells, each 0.69 wide.
    assert!(after.computed > 0 && after.computed <= 27, "{} of {}", after.computed, after.blocks);
    let unchanged = refacet(&field(0.45), &over, &at_depth(7), Some(&after)).unwrap();
    assert_eq!(unchanged.computed, 0);
}

#[test]
fn touching_bodies_are_apart() {
    // Two cubes that share an edge only, on the lattice or off it: two components, each manifold.
    for shift in [0.0, 0.013] {
        let cube_at = |a: f64| {
            let low = v(a + shift, a, -0.5);
            Set::cuboid(low, low + v(1.0, 1.0, 1.0)).unwrap()
        };
        let f = facets(&(cube_at(-1.0) | cube_at(0.0)), &cube(1.5), 5);
        let report = sound(&f);
        assert_eq!(report.negative_components, 0);
        assert!((volume(&f) - 2.0).abs() < 1e-2, "{}", volume(&f));
    }
}

#[test]
fn bad_requests_are_refused() {
    let ball = Set::new(&Primitive::sphere(Vec3::<f64>::zero(), 1.0).unwrap());
    let flat = Box3 { low: v(0.0, 0.0, 0.0), high: v(1.0, 0.0, 1.0) };
    assert!(matches!(facet(&ball, &flat, &at_depth(3)), Err(FieldError::EmptyBox { .. })));
    let endless = Box3 { low: v(0.0, 0.0, 0.0), high: v(1.0, f64::INFINITY, 1.0) };
    assert!(matches!(facet(&ball, &endless, &at_depth(3)), Err(FieldError::EmptyBox { .. })));
    let fine = FacetOptions::new(Resolution::Accuracy(1e-13));
    let Err(FieldError::TooFine { boxes, .. }) = facet(&ball, &cube(2.0), &fine) else { panic!() };
    assert!(boxes > 1e11, "{boxes}");
    assert!(matches!(facet(&ball, &cube(2.0), &at_depth(30)), Err(FieldError::TooFine { .. })));
    let zero = FacetOptions::new(Resolution::Accuracy(0.0));
    assert!(matches!(facet(&ball, &cube(2.0), &zero), Err(FieldError::NotPositive { .. })));
    let stopped = at_depth(5);
    stopped.budget.cancel();
    assert_eq!(facet(&ball, &cube(2.0), &stopped).unwrap_err().to_string(), "cancelled");
    let nan = Set::new(&(Primitive::axes()[0].clone() * f64::NAN));
    assert!(matches!(facet(&nan, &cube(2.0), &at_depth(3)), Err(FieldError::NoValue { .. })));
}

#[test]
fn fewer_triangles_within_an_accuracy() {
    let set = t_piece();
    let fine = facets(&set, &cube(4.0), 7);
    let rms = |f: &moldloft_field::Facets| {
        let all = f.centre_distances();
        (all.iter().map(|d| d * d).sum::<f64>() / all.len() as f64).sqrt()
    };
    let simple = fine.simplified(1e-3).unwrap();
    let report = sound(&simple);
    assert_eq!((report.euler, report.components), (2, 1));
    println!(
        "{} triangles, rms {:.2e}; {} after, rms {:.2e}",
        fine.mesh.faces().len(),
        rms(&fine),
        simple.mesh.faces().len(),
        rms(&simple)
    );
    assert!(simple.mesh.faces().len() * 4 < fine.mesh.faces().len() * 3);
    assert!(simple.worst_vertex() <= 1e-12 * 8.0 * 3f64.sqrt());
    assert!(crossing_faces(&simple.mesh, None).is_empty());
    assert!((volume(&simple) - 25.097).abs() < 0.06);
    // The same bits again.
    assert_eq!(fine.simplified(1e-3).unwrap().mesh.positions(), simple.mesh.positions());
    assert!(fine.simplified(0.0).is_err());
}

#[test]
fn bends_finer_than_the_cells_are_divided() {
    // A rod and a ring of radius 0.15 in cells of 0.125: over a cell the normal turns by 50 degrees, and an edge
    // of that length leaves the surface by h^2 / 8 r = 0.013. Divided, edges turn by 20 degrees.
    let z = axis(v(0.013, 0.027, 0.011), v(0.1, 0.2, 1.0));
    let rod = Set::new(&Primitive::cylinder(z, 0.15).unwrap());
    let ring = Set::new(&Primitive::torus(z, 1.0, 0.15).unwrap());
    for set in [rod, ring] {
        let f = facets(&set, &cube(2.0), 5);
        sound(&f);
        assert!(crossing_faces(&f.mesh, None).is_empty());
        assert!(f.worst_vertex() <= 1e-12 * 4.0 * 3f64.sqrt(), "{}", f.worst_vertex());
        assert!(f.worst_centre() < 5e-3, "{}", f.worst_centre());
        // New vertices on the edge of two primitives are on both.
        assert_eq!(f.surfaces.len(), f.mesh.positions().len());
    }
    // Sixty times finer than its bends nothing is divided: the mesh is that of the cells alone.
    let ball = facets(&Set::new(&Primitive::sphere(z.point, 1.9).unwrap()), &cube(2.0), 5);
    assert_eq!(ball.mesh.faces().len(), 2 * (ball.mesh.positions().len() - 2));
    assert!(ball.mesh.positions().len() <= ball.cells + ball.cells / 100);
}
