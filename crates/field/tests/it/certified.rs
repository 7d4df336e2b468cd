//! Certified integrals: thin bodies, edges, points far from the origin, all beside closed forms.

use crate::common::{axis, cube, t_piece, v};
use moldloft_field::{
    Affine, Effort, FacetOptions, IntegralOptions, Primitive, Resolution, Set, around, certified,
    facet, mass,
};
use moldloft_num::{Axis, Box3, Vec3};
use moldloft_testing::Random;
use std::f64::consts::PI;

fn direction(random: &mut Random) -> Vec3 {
    let z = random.between(-1.0, 1.0);
    let (t, r) = (random.between(0.0, 2.0 * PI), (1.0 - z * z).sqrt());
    v(r * t.cos(), r * t.sin(), z)
}

fn ball(r: f64) -> Set {
    Set::new(&Primitive::sphere(v(0.0, 0.0, 0.0), r).unwrap())
}

fn cylinder(point: Vec3, along: Vec3, r: f64) -> Set {
    Set::new(&Primitive::cylinder(axis(point, along), r).unwrap())
}

fn half(normal: Vec3, point: Vec3) -> Set {
    Set::new(&Primitive::plane(normal, point).unwrap())
}

/// A thin body of size about 1 and thickness t, with its volume and the number of holes through it.
fn thin(kind: usize, t: f64) -> (Set, f64, &'static str) {
    let o = v(0.0, 0.0, 0.0);
    let z = v(0.0, 0.0, 1.0);
    let between = |set: Set, low: f64, high: f64| {
        set & half(-z, v(0.0, 0.0, low)) & half(z, v(0.0, 0.0, high))
    };
    match kind {
        0 => (Set::cuboid(o, v(1.0, 1.0, t)).unwrap(), t, "plate"),
        1 => (between(cylinder(o, z, t), 0.0, 1.0), PI * t * t, "rod"),
        2 => {
            let ring = Primitive::torus(axis(o, z), 1.0, t).unwrap();
            (Set::new(&ring), 2.0 * PI * PI * t * t, "ring")
        }
        3 => {
            let exact = 4.0 * PI * t * (1.0 - t + t * t / 3.0);
            (ball(1.0) - ball(1.0 - t), exact, "shell")
        }
        4 => {
            let wall = cylinder(o, z, 0.3) - cylinder(o, z, 0.3 * (1.0 - t));
            (between(wall, 0.0, 1.0), PI * 0.09 * (1.0 - (1.0 - t).powi(2)), "pipe")
        }
        _ => {
            // A wedge of 2 to 10 degrees.
            let angle = (2.0 + 80.0 * t.min(0.1)).to_radians();
            let side = half(v(-angle.sin(), 0.0, angle.cos()), o);
            let wedge = side & half(-z, o) & half(v(1.0, 0.0, 0.0), v(1.0, 0.0, 0.0));
            let y = v(0.0, 1.0, 0.0);
            (wedge & half(-y, o) & half(y, y), 0.5 * angle.tan(), "wedge")
        }
    }
}

#[test]
fn thin_bodies_anywhere_have_their_volume_inside_the_bracket() {
    let mut random = Random::new(11);
    for k in 0..moldloft_testing::rounds(3, 500) {
        let t = 10f64.powf(random.between(-4.0, -1.0));
        let (set, exact, name) = thin(k % 6, t);
        let turn = Affine::rotation(
            &Axis { point: v(0.1, 0.2, 0.3), direction: direction(&mut random) },
            random.between(0.0, 6.0),
        );
        let move_by = Affine::translation(direction(&mut random) * random.between(0.0, 3.0));
        let set = set.mapped(&turn).unwrap().mapped(&move_by).unwrap();
        let over = around(&set).unwrap().unwrap();
        let found = certified(&set, &over, &Effort::of_cells(20_000), &Default::default()).unwrap();
        let v = found.bracket.volume();
        let (low, high) = (v.low / exact, v.high / exact);
        // The bracket is proved, the closed form rounded.
        assert!(low <= 1.0 + 1e-9 && high >= 1.0 - 1e-9, "{name} {t:e}: [{low}, {high}]");
        let best = found.best.volume() / exact;
        assert!(low <= best && best <= high, "{name} {t:e}: {best} in [{low}, {high}]");
        // Parts that are thin along a line are left to facets with cells of that size.
        let m = mass(&set, &over, &IntegralOptions::default()).unwrap();
        assert!(m.bracket.contains(&m.best));
        let off = m.best.volume() / exact - 1.0;
        println!("{name} {t:.1e}: best {:.1e}, {off:.1e}, bracket {:.1e}", best - 1.0, high - low);
        assert!(off.abs() < 1e-3, "{name} {t:e}: {off}");
    }
}

#[test]
fn the_volume_is_the_same_whatever_asks() {
    for t in [0.03, 0.01, 1e-3, 1e-5] {
        let (plate, exact, _) = thin(0, t);
        let over = around(&plate).unwrap().unwrap();
        let m = mass(&plate, &over, &IntegralOptions::default()).unwrap();
        assert!(m.bracket.contains(&m.best));
        assert!((m.best.volume() / exact - 1.0).abs() < 1e-9, "{t}: {}", m.best.volume());
    }
}

#[test]
fn inertia_and_centroid_do_not_depend_on_the_place() {
    for o in [0.0, 1.0, 1e3, 1e4, 1e5, 1e6] {
        let p = v(o, -o, o);
        let block = Set::cuboid(p, p + v(1.0, 1.0, 1.0)).unwrap();
        let over = Box3 { low: p - v(0.1, 0.11, 0.12), high: p + v(1.1, 1.12, 1.13) };
        let m = mass(&block, &over, &IntegralOptions::default()).unwrap();
        let c = m.best.centroid() - p;
        assert!(c.distance(v(0.5, 0.5, 0.5)) < 1e-9, "{o}: {c:?}");
        let inertia = m.best.inertia();
        for (i, row) in inertia.iter().enumerate() {
            for j in 0..3 {
                let exact = if i == j { 1.0 / 6.0 } else { 0.0 };
                assert!((row[j] - exact).abs() < 1e-9, "{o}: {inertia:?}");
                let range = m.bracket.inertia()[i][j];
                assert!(range.low <= exact + 1e-9 && range.high >= exact - 1e-9);
                assert!(range.width() < 1e-6, "{o}: {range:?}");
            }
        }
    }
}

#[test]
fn the_bracket_of_a_curved_body_closes_at_second_order() {
    let exact = 4.0 / 3.0 * PI;
    let widths = [4, 5, 6].map(|depth| {
        let v = moldloft_field::bracket(&ball(1.0), &cube(1.3), depth).unwrap().volume();
        assert!(v.contains(exact));
        v.width() / exact
    });
    println!("{widths:?}");
    assert!(widths[1] < widths[0] / 3.5 && widths[2] < widths[1] / 3.5, "{widths:?}");
    assert!(widths[1] < 8e-3, "{widths:?}");
    let piece = certified(&t_piece(), &cube(4.0), &Effort::to(0.05), &Default::default()).unwrap();
    let v = piece.bracket.volume();
    println!("T-piece: {v:?} after {} cells, best {}", piece.cells, piece.best.volume());
    assert!(v.contains(25.097_230_6) && v.width() <= 0.05);
}

#[test]
fn facets_miss_nothing_in_silence() {
    let mut random = Random::new(5);
    for k in 0..moldloft_testing::rounds(6, 60) {
        let t = [0.05, 0.02, 0.004][k / 6 % 2 + usize::from(k == 7)];
        let (set, exact, name) = thin(k % 5, t);
        let turn = Affine::rotation(&axis(v(0.0, 0.0, 0.0), direction(&mut random)), 0.7);
        let set = set.mapped(&turn).unwrap();
        let over = around(&set).unwrap().unwrap();
        let f = facet(&set, &over, &FacetOptions::new(Resolution::Level(6))).unwrap();
        let missed = f.unresolved.iter().filter(|u| u.missed).count();
        let part = crate::common::volume(&f) / exact;
        println!(
            "{name} {t}: {part:.4} of its volume, {missed} missed, {} cells, {} open",
            f.cells,
            f.unresolved.len()
        );
        assert!(missed > 0 || (part - 1.0).abs() < 0.05, "{name} {t}: {part}");
        let coarse = facet(&set, &over, &FacetOptions::new(Resolution::Depth(4))).unwrap();
        let part = crate::common::volume(&coarse) / exact;
        assert!(!coarse.unresolved.is_empty() || (part - 1.0).abs() < 0.2, "{name} {t}: {part}");
    }
}

#[test]
fn clearances_of_faces_axes_and_centres_are_exact() {
    let o = v(0.0, 0.0, 0.0);
    let z = v(0.0, 0.0, 1.0);
    let apart = |a: &Set, b: &Set, over: &Box3| {
        let d = moldloft_field::distance(a, b, over, 1e-9).unwrap().unwrap();
        assert!(d.at_least <= d.distance + 1e-15);
        (d.distance, d.at_least)
    };
    let block = |x: f64| Set::cuboid(v(x, 0.0, 0.0), v(x + 1.0, 1.0, 1.0)).unwrap();
    let (d, least) = apart(&block(0.0), &block(2.0), &cube(3.5));
    assert!((d - 1.0).abs() < 1e-9 && least > 1.0 - 1e-8, "{d} {least}");
    let turn = Affine::rotation(&axis(v(0.3, 0.1, 0.2), v(1.0, 2.0, 3.0)), 0.8);
    let [a, b] = [0.0, 1.25].map(|x| block(x).mapped(&turn).unwrap());
    let (d, least) = apart(&a, &b, &cube(3.5));
    assert!((d - 0.25).abs() < 1e-9 && least > 0.25 - 1e-8, "{d} {least}");
    let (d, least) = apart(&ball(1.0), &(ball(3.0) - ball(2.0)), &cube(3.2));
    assert!((d - 1.0).abs() < 1e-9 && least > 1.0 - 1e-8, "{d} {least}");
    let pipe = |r: f64| cylinder(o, z, r) & half(z, z) & half(-z, -z);
    let (d, least) = apart(&pipe(0.5), &(pipe(2.0) - cylinder(o, z, 1.25)), &cube(2.2));
    assert!((d - 0.75).abs() < 1e-9 && least > 0.75 - 1e-8, "{d} {least}");
    for (set, exact) in [(ball(1.0), 1.0), (cylinder(o, z, 0.7), 0.7)] {
        let n = moldloft_field::nearest(&set, o, &cube(2.0), 1e-9).unwrap().unwrap();
        assert!((n.distance - exact).abs() < 1e-9 && n.at_least > exact - 1e-8, "{n:?}");
    }
}

#[test]
fn texts_give_the_same_set_again() {
    let set = (ball(1.0).named("ball")
        - cylinder(v(0.0, 0.0, 0.0), v(1.0, 2.0, 3.0), 0.3).named("a \"hole\""))
        | thin(2, 0.1).0.named("ring");
    let text = set.to_text().unwrap();
    let again = Set::from_text(&text).unwrap();
    assert!(again.same(&set));
    let forms = |s: &Set| s.leaves().iter().map(|l| l.primitive.form().clone()).collect::<Vec<_>>();
    assert_eq!(forms(&again), forms(&set));
    assert_eq!(again.to_text().unwrap(), text);
    for (wrong, line) in [
        ("", 1),
        ("moldloft set 2\n", 1),
        ("moldloft set 1\n0 real x\n", 2),
        ("moldloft set 1\n0 real 1.0\n1 neg 5\n", 3),
        ("moldloft set 1\n0 real 1.0\n1 leaf 0 with colour 99\nroot 1\n", 3),
        ("moldloft set 1\n0 real 1.0\n", 2),
    ] {
        assert_eq!(Set::from_text(wrong).unwrap_err().line, line, "{wrong}");
    }
    let sdl = set.to_sdl("part").unwrap();
    assert!(sdl.contains("set part = ") && sdl.contains("name = \"ring\""), "{sdl}");
    for wrong in ["_0 cosh _1", "_0 var-x\n_1 sin _7", "_0 const nan", ""] {
        assert!(moldloft_field::read_fidget(wrong).is_err(), "{wrong}");
    }
    for wrong in ["(", "(+ 1", ")", "(foo x)", "x y", "(1 2)", ""] {
        assert!(moldloft_field::read_libfive(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn fillets_rounds_and_chamfers_of_sets_have_their_volumes() {
    let volume = |set: &Set| {
        let over = around(set).unwrap().unwrap();
        mass(set, &over, &IntegralOptions::default()).unwrap().best.volume()
    };
    let block = Set::cuboid(v(0.0, 0.0, 0.0), v(10.0, 6.0, 4.0)).unwrap();
    let chamfered = moldloft_field::chamfer_edges(&block, 1.0, None).unwrap();
    assert!((volume(&chamfered) - 206.0).abs() < 1e-6);
    let grown = block.offset(0.5).unwrap();
    assert!((volume(&grown) - 11.0 * 7.0 * 5.0).abs() < 1e-6);
    assert!((volume(&block.shell(0.5).unwrap()) - (240.0 - 9.0 * 5.0 * 3.0)).abs() < 1e-6);
    // A long post on a plate: along each edge a fillet of setback w of chamfer shape has the section w^2/2.
    let plate = Set::cuboid(v(-3.0, -3.0, -1.0), v(3.0, 3.0, 0.0)).unwrap();
    let post = Set::cuboid(v(-1.0, -1.0, -0.5), v(1.0, 1.0, 2.0)).unwrap();
    let joined = moldloft_field::fillet_sets([&plate, &post], [0.5, 0.5], 2.0 / 3.0, None).unwrap();
    // A quarter of a square of side 0.5 less its circle, four times, two long each.
    let section = 0.25 * (1.0 - PI / 4.0);
    let exact = 36.0 + 8.0 + 4.0 * 2.0 * section;
    assert!((volume(&joined) - exact).abs() < 1e-4, "{} {exact}", volume(&joined));
    let none = [["top".to_owned(), "side".to_owned()]];
    assert!(
        moldloft_field::fillet_sets([&plate, &post], [0.5, 0.5], 2.0 / 3.0, Some(&none)).is_err()
    );
}

#[test]
fn quotients_logarithms_and_replaced_coordinates_have_proved_ranges() {
    let [x, y, z] = Primitive::<f64>::axes();
    let one = &x * 0.0 + 1.0;
    let fields = [
        (&x + 3.0).ln() - &y * 0.3,
        x.over(&(y.power(2) + 1.0)).unwrap() - &z,
        (&x * 0.4).tan() - &y,
        x.remainder(&Primitive::real(0.7)).unwrap() - 0.3,
        Primitive::sphere(v(0.1, 0.2, 0.3), 1.0).unwrap().remapped(&moldloft_field::twist(0.7)),
        one.over(&(x.power(2) + y.power(2) + 0.5)).unwrap() - 0.9,
    ];
    let mut random = Random::new(3);
    for (k, f) in fields.iter().enumerate() {
        for _ in 0..200 {
            let c =
                v(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let h = v(random.between(0.0, 0.4), random.between(0.0, 0.4), random.between(0.0, 0.4));
            let over = Box3 { low: c - h, high: c + h };
            let range = f.gradient_range(&over);
            let u =
                v(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let p = c + v(u.x * h.x, u.y * h.y, u.z * h.z);
            let g = f.gradient(p);
            assert!(range.value.contains(g.value), "{k}: {:?} {}", range.value, g.value);
            for axis in 0..3 {
                assert!(range.slope[axis].contains(g.slope[axis]), "{k}");
            }
            let mut bulk = [0.0];
            f.values(&[p], &mut bulk);
            assert_eq!(bulk[0], f.value(p), "{k}");
        }
    }
}
