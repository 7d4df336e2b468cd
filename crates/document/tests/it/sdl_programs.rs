//! The three programs of 1992 (R. C. Maple, "SDL: A Surface Description Language", N92-24401) and the
//! libraries that they load: the figures are of closed forms of the bodies.
#![allow(clippy::excessive_precision)] // figures as computed to more digits than a double has

use crate::common::{OneFont, number, reported, vector};
use moldloft_document::{Document, NoFiles, registry};
use moldloft_num::Vec3;
use moldloft_registry::{Value, Vectors};
use std::sync::Arc;

const FIGURE_1: &str = include_str!("fixtures/figure1.sdl");
const FIGURES_1_AND_3: &str = include_str!("fixtures/figure1and3.sdl");
const FIGURE_5: &str = include_str!("fixtures/figure5.sdl");

/// A program that runs without errors.
fn run(text: &str) -> Document {
    let document = Document::from_text(registry(), Box::new(OneFont), "program.sdl", text);
    assert!(!document.has_errors(), "{}", reported(&document).join("\n"));
    document
}

fn vectors(document: &mut Document, text: &str) -> Arc<Vectors<f64>> {
    match document.eval(text) {
        Ok(Value::Vectors(a)) => a,
        other => panic!("{text}: {other:?}"),
    }
}

fn near(what: &str, found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "{what}: {found} is not {wanted} within {within}");
}

fn at(document: &mut Document, text: &str, wanted: [f64; 3], within: f64) {
    let found = vector(document, text);
    let d = (found - Vec3::from(wanted)).to_array();
    assert!(d.iter().all(|d| d.abs() <= within), "{text}: {found:?} is not {wanted:?}");
}

const RADIUS: f64 = 0.75;
const RHO: f64 = 5.0;
const NOSE: f64 = 2.633_913_438_213_184_6;
const BASE: f64 = 10.133_913_438_213_185;

/// The radius of the body without rear ogive.
fn radius(x: f64) -> f64 {
    if x >= NOSE {
        return RADIUS;
    }
    (RHO * RHO - (NOSE - x).powi(2)).sqrt() + RADIUS - RHO
}

#[test]
fn figure_1_half_missile() {
    let mut m = run(FIGURE_1);
    for j in 1..=20 {
        at(&mut m, &format!("body[1,{j}]"), [0.0; 3], 0.0);
    }
    at(&mut m, "body[60,1]", [BASE, RADIUS, 0.0], 1e-14);
    at(&mut m, "body[60,20]", [BASE, -RADIUS, 0.0], 1e-14);
    near("nose", number(&mut m, "body[23,1].x"), NOSE, 0.0);
    near("base", number(&mut m, "body[60,1].x"), BASE, 0.0);
    let body = vectors(&mut m, "body");
    for i in 0..60 {
        for j in 0..20 {
            let p = body.at(20 * i + j);
            let r = (p.y * p.y + p.z * p.z).sqrt();
            assert!((r - radius(p.x)).abs() <= 1e-14, "{i} {j} {p:?}");
            assert!(i == 0 || p.x > body.at(20 * (i - 1) + j).x);
        }
    }
    // Cells on both sides of the joint are equal, the tip cell is half the mean of the nose.
    let x = |i: usize| body.at(20 * (i - 1)).x;
    let nose_arc = 2.774_055_164_90;
    let joint = (nose_arc / 22.0 * 7.5 / 37.0_f64).sqrt();
    near("cell behind the joint", x(24) - x(23), joint, 1e-12);
    let arc = |i: usize| RHO * ((NOSE - x(i)) / RHO).asin();
    near("cell ahead of the joint", arc(22), joint, 1e-12);
    near("tip cell", arc(1) - arc(2), nose_arc / 44.0, 1e-10);
    near("tip half-angle", (NOSE / RHO).asin().to_degrees(), 31.788_330_617_05, 1e-10);
    for (x, r) in [(0.5, 0.271_771_051_061), (1.0, 0.475_497_526_867), (2.0, 0.709_652_583_887)] {
        near("r", radius(x), r, 1e-12);
    }
    // Area and volume of the grid converge to the closed forms with the square of its cells.
    let area = |n: usize, k: usize| {
        let text = FIGURE_1.replace("60,20", &format!("{n},{k}"));
        let body = vectors(&mut run(&text), "body");
        let p = |i: usize, j: usize| body.at(k * i + j);
        let mut sum = 0.0;
        for i in 0..n - 1 {
            for j in 0..k - 1 {
                let (d, e) = (p(i + 1, j + 1) - p(i, j), p(i + 1, j) - p(i, j + 1));
                sum += d.cross(e).norm() / 2.0;
            }
        }
        sum
    };
    let exact = 22.006_331_076_361;
    let (coarse, fine) = (exact - area(60, 20), exact - area(119, 39));
    assert!(
        coarse > 0.0 && fine > 0.0 && coarse / fine > 3.8 && coarse / fine < 4.2,
        "{coarse} {fine}"
    );
}

#[test]
fn figure_3_reflection_planes() {
    let mut m = run(FIGURES_1_AND_3);
    let outer = 12.160_696_125_855_821;
    near("radius", 1.2 * number(&mut m, "body[60,1].x"), outer, 0.0);
    for (i, x, y) in [
        (2, -12.010_453_1, 1.905_661_3),
        (10, -7.157_130_2, 9.831_480_9),
        (20, -1.731_937_9, 12.036_732_1),
        (30, 1.958_584_5, 12.160_705_6),
    ] {
        at(&mut m, &format!("outer_profile[{i}]"), [x, y, 0.0], 1e-6);
    }
    for (i, x) in [(40, 4.816_831_2), (50, 7.411_720_0), (59, 9.844_317_4)] {
        near("x", number(&mut m, &format!("outer_profile[{i}].x")), x, 1e-6);
    }
    at(&mut m, "outer_profile[1]", [-outer, 0.0, 0.0], 1e-12);
    at(&mut m, "outer_profile[60]", [BASE, outer, 0.0], 1e-12);
    near("first", number(&mut m, "|outer_profile[2] - outer_profile[1]|"), 1.911_57, 1e-5);
    near("last", number(&mut m, "|outer_profile[60] - outer_profile[59]|"), 0.289_60, 1e-5);
    let profile = vectors(&mut m, "outer_profile");
    assert_eq!(profile.planes[0].iter().filter(|x| **x < 0.0).count(), 24);
    near("uref[1,2]", number(&mut m, "uref[1,2].x"), -0.129_755_113_576, 1e-11);
    near("uref[1,13]", number(&mut m, "uref[1,13].x"), -3.262_425_336_853, 1e-11);
    near("uref[60,2]", number(&mut m, "uref[60,2].y"), 0.871_752_583_608, 1e-11);
    near("uref[60,13]", number(&mut m, "uref[60,13].y"), 3.811_218_187_417, 1e-11);
    near("uref[60,25]", number(&mut m, "uref[60,25].y"), 12.160_696_125_856, 1e-11);
    let (upper, lower) = (vectors(&mut m, "uref"), vectors(&mut m, "lref"));
    assert!(upper.planes[2].iter().all(|z| *z == 0.0));
    for k in 0..60 * 25 {
        let (p, q) = (upper.at(k), lower.at(k));
        assert!(p.x == q.x && p.y == -q.y && q.z == 0.0);
    }
    for i in 1..=60 {
        near("join", number(&mut m, &format!("|lref[{i},1] - body[{i},20]|")), 0.0, 1e-14);
        near("join", number(&mut m, &format!("|uref[{i},1] - body[{i},1]|")), 0.0, 0.0);
        near("edge", number(&mut m, &format!("|uref[{i},25] - outer_profile[{i}]|")), 0.0, 0.0);
    }
    // The arc's end is exact before the program makes it so; sin(PI) had left 1.49e-15.
    let text =
        FIGURES_1_AND_3.replace("outer_profile[1].y = 0.0;", "float y1 = outer_profile[1].y;");
    near("y1", number(&mut run(&text), "y1"), 0.0, 0.0);
    // With breaks found at the jump of curvature the points lie where arc length says.
    let text = FIGURES_1_AND_3.replace(
        "curdist( outer_profile, d_tanh(0,1, .07, .01, 60) );",
        "outer_profile = distc(makecc(outer_profile, \"quadratic\", \"arclen+breaks\"), \
         d_tanh(0,1, .07, .01, 60));",
    );
    let mut m = run(&text);
    let along = match m.eval("d_tanh(0, 1, .07, .01, 60)") {
        Ok(Value::Numbers(a)) => a,
        other => panic!("{other:?}"),
    };
    let length = 29.235_890_243_976;
    let profile = vectors(&mut m, "outer_profile");
    let bend = outer * std::f64::consts::FRAC_PI_2;
    for (k, t) in along.items.iter().enumerate() {
        let s = t * length;
        let exact = if s <= bend {
            let a = std::f64::consts::PI - s / outer;
            Vec3::of(outer * a.cos(), outer * a.sin(), 0.0)
        } else {
            Vec3::of(s - bend, outer, 0.0)
        };
        assert!((profile.at(k) - exact).norm() < 3e-7, "{k}: {:?} {exact:?}", profile.at(k));
    }
}

/// The second listing goes on where the first ends; by itself it lacks what the first loads.
#[test]
fn what_a_library_has_is_told_where_it_was_not_loaded() {
    for (text, file) in [
        ("curve c[5]; arc(c, 0, 1, 2);", "stdsubs.sdl"),
        ("print cos(PI_d2);", "stdsubs.sdl"),
        ("curve c[5]; naca4(c, 0, 0, 12);", "naca.sdl"),
        ("set_sting(.4, 10, 15);", "mslbody.sdl"),
    ] {
        let m = crate::common::open(text);
        let all = m.diagnostics();
        assert_eq!((all.len(), &*all[0].id), (1, "unknown-name"), "{text}: {all:?}");
        assert!(all[0].help.iter().any(|h| h.contains(&format!("load \"{file}\""))), "{all:?}");
    }
    let other = crate::common::open("print radii;").diagnostics();
    assert!(other[0].help.is_empty(), "{other:?}");
}

#[test]
fn figure_5_quarter_missile_with_fins_and_sting() {
    let mut m = run(FIGURE_5);
    let notes: Vec<String> = m.diagnostics().iter().map(|d| d.id.to_string()).collect();
    assert_eq!(notes, ["misprint"]);
    for (k, x, y) in [
        (2, 0.037_124_990_3, 0.031_234_946_0),
        (3, 0.086_913_706_5, 0.044_461_938_1),
        (5, 0.190_353_825_2, 0.056_783_495_6),
        (10, 0.456_281_135_5, 0.055_480_382_7),
        (15, 0.727_218_307_4, 0.033_939_859_9),
        (19, 0.945_456_007_5, 0.008_664_012_5),
    ] {
        // The spline through 200 points is within 4.9e-6 of the exact arc length.
        at(&mut m, &format!("root[{k}]"), [x, y, 0.0], 5e-6);
    }
    at(&mut m, "root[20]", [1.0, 0.001_26, 0.0], 1e-12);
    let x = |m: &mut Document, i: usize| number(m, &format!("body[{i},6].x"));
    near("shoulder", x(&mut m, 19), NOSE, 1e-12);
    near("leading edge", x(&mut m, 45), 8.933_913_438_213, 1e-12);
    near("trailing edge", x(&mut m, 64), 9.933_913_438_213, 1e-12);
    near("barrel end", x(&mut m, 67), BASE, 1e-12);
    near("sting", x(&mut m, 76), 11.540_149_549_256, 1e-12);
    near("end", x(&mut m, 90), 21.540_149_549_256, 1e-12);
    let body = vectors(&mut m, "body");
    let root = vectors(&mut m, "root");
    let p = |i: usize, j: usize| body.at(11 * (i - 1) + j - 1);
    for i in 1..=90 {
        for j in 1..=11 {
            let q = p(i, j);
            let r = (q.y * q.y + q.z * q.z).sqrt();
            let wanted = match q.x {
                x if x <= BASE => radius(x),
                x if i < 76 => (9.0 - (x - BASE).powi(2)).sqrt() + RADIUS - 3.0,
                _ => 0.4,
            };
            near("r", r, wanted, 1e-13);
            assert!(i == 1 || q.x > p(i - 1, j).x, "{i} {j}");
        }
        // On the fins the edges follow the half thickness, elsewhere the planes of the sector.
        let thick = if (45..=64).contains(&i) { root.at(i - 45).y } else { 0.0 };
        let r = if i == 1 { 0.0 } else { RADIUS };
        if (45..=64).contains(&i) {
            near("z", p(i, 1).z, thick, 1e-15);
            near("y", p(i, 11).y, thick, 1e-15);
            near("x", p(i, 1).x, 8.933_913_438_213_185 + root.at(i - 45).x, 1e-14);
            // The cell off the fin is what was asked for.
            let cell = p(i, 2).z.atan2(p(i, 2).y) - p(i, 1).z.atan2(p(i, 1).y);
            near("off fin", r * cell, 0.03, 1e-13);
        } else if i > 1 {
            near("z", p(i, 1).z, 0.0, 1e-15);
            near("y", p(i, 11).y, 0.0, 1e-15);
        }
    }
    // The widest fin edge.
    let widest = (0.060_017_273_088_f64 / RADIUS).asin().to_degrees();
    near("edge", widest, 4.589_889_55, 1e-8);
}

/// Runs again in well under a millisecond in a release build: here only that nothing is made anew.
#[test]
fn programs_run_again_alike() {
    for text in [FIGURE_1, FIGURES_1_AND_3, FIGURE_5] {
        let mut m = run(text);
        let first = vectors(&mut m, "body");
        m.run();
        assert!(!m.has_errors());
        let second = vectors(&mut m, "body");
        assert!((0..first.len()).all(|k| first.at(k).bits_eq(second.at(k))));
        m.by_reference();
        let plain = vectors(&mut m, "body");
        assert!((0..first.len()).all(|k| first.at(k).bits_eq(plain.at(k))));
    }
}

#[test]
fn derivatives_run_through_the_missile() {
    for (program, literal, from) in
        [(FIGURES_1_AND_3, "set_barrel(.75,7.5)", 0.75), (FIGURE_5, "set_barrel(.75,7.5)", 0.75)]
    {
        let text =
            format!("param float r = {from};\n{}", program.replace(literal, "set_barrel(r,7.5)"));
        let mut m = run(&text);
        let mut wanted = vec!["body"];
        if program == FIGURES_1_AND_3 {
            wanted.extend(["uref", "outer_profile"]);
        }
        for name in wanted {
            let derivative = m.derivatives(&[name.into()], &["r".into()]).unwrap();
            let Value::Vectors(exact) = &derivative[0][0] else { panic!("{name}") };
            let h = 1e-5;
            let mut moved = |by: f64| {
                m.set(&[("r".into(), from + by)]).unwrap();
                vectors(&mut m, name)
            };
            let (plus, minus) = (moved(h), moved(-h));
            m.set(&[("r".into(), from)]).unwrap();
            let largest = exact.iter().map(|v| v.norm()).fold(0.0, f64::max);
            assert!(largest > 0.5);
            for k in 0..exact.len() {
                let d = (plus.at(k) - minus.at(k)) * (0.5 / h);
                assert!(
                    (d - exact.at(k)).norm() <= 1e-7 * largest,
                    "{name}[{k}]: {d:?} {:?}",
                    exact.at(k)
                );
            }
        }
    }
}

#[test]
fn grids_are_nested() {
    let text = FIGURES_1_AND_3
        .replace("[60,20]", "[refined(60), refined(20)]")
        .replace("outer_profile[60]", "outer_profile[refined(60)]")
        .replace(
            "uref[60,25], lref[60,25]",
            "uref[refined(60),refined(25)], lref[refined(60),refined(25)]",
        )
        .replace("[ :45]", "[ :refined(45)]")
        .replace("[45:]", "[refined(45):]")
        .replace("body[60,1]", "body[body.d1,1]")
        .replace("[60]", "[refined(60)]")
        .replace("uref[60, ]", "uref[refined(60), ]")
        .replace("uref[ ,25]", "uref[ ,refined(25)]")
        .replace(".07, .01, 60", "refined_step(.07), refined_step(.01), refined(60)")
        .replace("0,1,.01, 0, 25", "0,1,refined_step(.01), 0, refined(25)");
    let mut m = run(&text);
    let coarse = vectors(&mut m, "body");
    let plane = vectors(&mut m, "uref[1,]");
    for times in [1, 2] {
        m.refine(times).unwrap();
        assert!(!m.has_errors(), "{}", reported(&m).join("\n"));
        let parts = 1 << times;
        let fine = vectors(&mut m, "body");
        let n = 19 * parts + 1;
        assert_eq!(fine.len(), (59 * parts + 1) * n);
        for i in 0..60 {
            for j in 0..20 {
                let d = fine.at(i * parts * n + j * parts) - coarse.at(20 * i + j);
                assert!(d.norm() < 1e-13, "{i} {j} {d:?}");
            }
        }
        // The line that a law of given slopes spaces.
        let line = vectors(&mut m, "uref[1,]");
        for j in 0..25 {
            assert!((line.at(j * parts) - plane.at(j)).norm() < 1e-10, "{j}");
        }
    }
    assert_eq!(m.refine(99).unwrap_err().id, "out-of-range");
}

#[test]
fn errors_of_the_missile_are_told_at_the_call() {
    let fails = |text: &str, says: &str| {
        let document = Document::from_text(registry(), Box::new(NoFiles), "program.sdl", text);
        let reported = reported(&document);
        assert!(reported.iter().any(|t| t.contains(says)), "{reported:?} do not say {says}");
        for d in document.diagnostics() {
            let name = document.sources().name(d.span().file);
            assert_eq!(name, Some("program.sdl"), "{d:?}");
        }
    };
    fails("load \"mslbody.sdl\" surface b[9,5]; mk_missile_body(b);", "set_fwd_ogive comes first");
    fails("load \"mslbody.sdl\" set_barrel(0, 1);", "positive");
    let begin = "load \"mslbody.sdl\" surface b[30,5]; curve r[3]; r[1] = {0,0,0}; r[2] = {.5,.06,0}; r[3] = {1,0,0};\n";
    fails(
        &format!("{begin}set_fwd_ogive(.5); set_barrel(.75, 7.5); mk_missile_body(b);"),
        "less than the barrel's",
    );
    let begin = format!("{begin}set_fwd_ogive(5); set_barrel(.75, 7.5);");
    fails(
        &format!("{begin}set_rear_ogive(3); set_sting(.8, 1, 3); mk_missile_body(b);"),
        "not less than the barrel's",
    );
    fails(
        &format!(
            "{begin}set_fin_loc(9.5, 9); set_fin_cnt(4); set_fin_root(r); mk_missile_body(b);"
        ),
        "behind the barrel's end",
    );
    fails(
        &format!("{begin}set_fin_loc(2, 9); set_fin_cnt(4); set_fin_root(r); mk_missile_body(b);"),
        "ahead of the barrel",
    );
    fails(
        &format!("{begin}set_fin_loc(5, 9); set_fin_cnt(4); mk_missile_body(b);"),
        "set_fin_root comes first",
    );
    fails(
        "load \"mslbody.sdl\" surface b[2,5]; set_fwd_ogive(5); set_barrel(.75, 7.5); mk_missile_body(b);",
        "too few points",
    );
}

#[test]
fn naca_sections() {
    let text = "load \"naca.sdl\"\ncurve c[401]; naca4(c, 0, 0, 12); float length = lengthc(makecc(c, \"quadratic\", \"arc\"));";
    let mut m = run(text);
    let section = vectors(&mut m, "c");
    let thick = |x: f64| {
        // The point at x by the spline of the section: the parameter of its points is known.
        let k = (2.0 * 400.0 * x.sqrt().asin() / std::f64::consts::PI).round() as usize;
        let p = section.at(k);
        let h = |x: f64| {
            5.0 * 0.12
                * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
                    - 0.1015 * x.powi(4))
        };
        assert!((p.y - h(p.x)).abs() < 1e-14, "{p:?} {}", h(p.x));
        h(x) * 100.0
    };
    for (x, y) in [
        (0.0125, 1.894),
        (0.025, 2.615),
        (0.05, 3.555),
        (0.1, 4.683),
        (0.2, 5.738),
        (0.3, 6.002),
        (0.4, 5.803),
        (0.5, 5.294),
        (0.6, 4.563),
        (0.8, 2.623),
        (0.95, 0.807),
        (1.0, 0.126),
    ] {
        near("0012", thick(x), y, 5e-4);
    }
    assert_eq!(section.at(0).to_array(), [0.0; 3]);
    near("tail", section.at(400).y, 0.001_26, 1e-15);
    near("length", number(&mut m, "length"), 1.019_635_816_521_586, 1e-6);
    // Points at x = (1 - cos(pi k/n))/2.
    for k in 0..=400 {
        let x = (1.0 - (std::f64::consts::PI * k as f64 / 400.0).cos()) / 2.0;
        near("x", section.at(k).x, x, 1e-15);
    }
    // Modified and 16-series thickness at given x.
    let ordinates = [
        (
            "naca16(c, 0, 15)",
            [
                0.014_485_57,
                0.031_374_39,
                0.043_210_02,
                0.067_724_12,
                0.075,
                0.065_868,
                0.031_464,
                0.001_5,
            ],
        ),
        (
            "naca4m(c, 0, 0, 12, 6, 3)",
            [
                0.017_205_4,
                0.036_178_02,
                0.047_643_78,
                0.06,
                0.054_073_47,
                0.038_096_33,
                0.014_772_24,
                0.001_2,
            ],
        ),
    ];
    for (call, ys) in ordinates {
        let mut m = run(&format!("load \"naca.sdl\"\ncurve c[2001]; {call};"));
        let section = vectors(&mut m, "c");
        for (x, y) in [0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0].into_iter().zip(ys) {
            let next = section.planes[0].iter().position(|p| *p >= x).unwrap();
            let (a, b) = (section.at(next.max(1) - 1), section.at(next));
            let found = if next == 0 { b.y } else { a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x) };
            near(call, found, y, 2e-6);
        }
    }
    // Camber: the mean of both sides, and thickness set off across the mean line.
    let mut m = run(
        "load \"naca.sdl\"\ncurve u[101], l[101], s[201]; naca4(u, 4, 4, 12); naca4l(l, 4, 4, 12); naca4s(s, 4, 4, 12);",
    );
    let (u, l, s) = (vectors(&mut m, "u"), vectors(&mut m, "l"), vectors(&mut m, "s"));
    for k in [20, 50, 80] {
        // x = .4 has no slope of the mean line; elsewhere points lean with it.
        let x = (1.0 - (std::f64::consts::PI * k as f64 / 100.0).cos()) / 2.0;
        let (m, p) = (0.04, 0.4);
        let (yc, dy) = if x < p {
            (m / (p * p) * (2.0 * p * x - x * x), 2.0 * m / (p * p) * (p - x))
        } else {
            let q = (1.0 - p) * (1.0 - p);
            (m / q * (1.0 - 2.0 * p + 2.0 * p * x - x * x), 2.0 * m / q * (p - x))
        };
        let yt = 0.6
            * (0.2969 * x.sqrt() - 0.1260 * x - 0.3516 * x * x + 0.2843 * x.powi(3)
                - 0.1015 * x.powi(4));
        let lean = dy.atan();
        near("upper x", u.at(k).x, x - yt * lean.sin(), 1e-12);
        near("upper y", u.at(k).y, yc + yt * lean.cos(), 1e-12);
        near("lower x", l.at(k).x, x + yt * lean.sin(), 1e-12);
        near("lower y", l.at(k).y, yc - yt * lean.cos(), 1e-12);
    }
    assert_eq!(s.at(0).to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(s.at(200).to_array(), [1.0, 0.0, 0.0]);
    assert!(s.at(100).norm() < 1e-15 && s.at(50).y > 0.0 && s.at(150).y < s.at(50).y);
    // The other families run, with their thickness and camber.
    let text = "load \"naca.sdl\"\ncurve c[101]; naca5(c, 230, 12); float a = max(c.y); naca6(c, \"65\", .2, 1, 10); \
                float b = max(c.y); naca66tmb(c, 2, 8); float d = max(c.y); naca6(c, \"63\", .4, .5, 9); float e = max(c.y); naca66tmb(c, 0, 8); naca16(c, .2, 12);";
    let mut m = run(text);
    near("23012", number(&mut m, "a"), 0.0760, 2e-4);
    near("65-210", number(&mut m, "b"), 0.0604, 6e-4);
    near("66 tmb", number(&mut m, "d"), 0.06, 1e-3);
    assert!(number(&mut m, "e") > 0.06);
}

/// Every routine of the libraries has an example in the comment above it, which runs.
#[test]
fn examples_of_the_libraries_run() {
    let mut count = 0;
    for (name, text) in moldloft_lang::LIBRARIES {
        let mut comment: Vec<&str> = Vec::new();
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix('#') {
                comment.push(rest);
                continue;
            }
            let head = line.strip_prefix("subroutine ").or(line.strip_prefix("function "));
            if head.is_some_and(|head| line.starts_with("subroutine") || head.contains(' ')) {
                let example: Vec<&str> =
                    comment.iter().filter_map(|c| c.strip_prefix("   ")).collect();
                if !example.is_empty() {
                    run(&format!("load \"{name}\"\n{}", example.join("\n")));
                    count += 1;
                } else {
                    let helper = ["naca_", "msl_", "grid_", "blade_", "solids_"]
                        .iter()
                        .any(|p| line.contains(p));
                    assert!(helper, "{name}: {line} has no example");
                }
            }
            comment.clear();
        }
    }
    assert!(count > 30, "{count}");
}

#[test]
fn examples_of_built_in_functions_run() {
    for row in moldloft_lang::functions::builtins::rows() {
        let document = run(&row.example);
        assert!(row.example.contains(&format!("{}(", row.name)), "{}", row.name);
        let found = reported(&document);
        assert!(found.is_empty(), "{}: {found:?}", row.name);
    }
}

/// Quoted words of a text, as completion offers them.
fn quoted(help: &str) -> Vec<&str> {
    help.split('"').skip(1).step_by(2).collect()
}

#[test]
fn words_that_arguments_list_are_taken() {
    let grid = "surface s[2,2]; s[1,] = {{0,0,0}, {0,1,0}}; s[2,] = {{1,0,0}, {1,1,0}};";
    for row in moldloft_lang::functions::builtins::rows() {
        for field in row.fields.iter().filter(|f| ["words", "view", "faces"].contains(&f.name)) {
            let words = quoted(field.help);
            assert!(!words.is_empty(), "{} {}", row.name, field.name);
            for word in words {
                let (file, name) = (if row.name == "plot" { "a.svg" } else { "a" }, &row.name);
                let call = match field.name {
                    "faces" if *name == "interfaces" => continue,
                    "faces" => format!("{name}(\"a.ugrid\", b, \"k1 = n {word}\");"),
                    _ => format!("{name}(\"{file}\", \"{word}\", s);"),
                };
                let text = format!("{grid} block b = {{s, s + {{0,0,1}}}}; {call}");
                let document = Document::from_text(registry(), Box::new(NoFiles), "p.sdl", &text);
                assert!(document.diagnostics().iter().all(|d| d.id != "unknown-word"), "{call}");
            }
        }
    }
}

#[test]
fn functions_of_the_run_take_named_arguments() {
    let grid = "surface s[3,2] = {1, 2, 3};";
    let written = |call: &str| {
        let document = run(&format!("{grid} {call}"));
        assert!(reported(&document).is_empty(), "{call} {:?}", reported(&document));
        document.written().map(|(_, bytes)| bytes.to_vec()).collect::<Vec<_>>()
    };
    let text = written("write_p3d(\"s.x\", \"text\", s, s);");
    for call in [
        "write_p3d(\"s.x\", s, s, words = \"text\");",
        "write_p3d(words = \"text\", name = \"s.x\", s = {s, s});",
    ] {
        assert_eq!(written(call), text, "{call}");
    }
    let file = written("file f = open(\"a.txt\", \"w\"); write(f, 1, 2); close(f);");
    for call in [
        "open(\"a.txt\", unit = 7, mode = \"w\"); write(f = 7, values = {1, 2}); close(7);",
        "open(7, \"a.txt\"); write(7, 1, 2); close(f = 7);",
        "open(\"a.txt\", \"w\", 7); write(7, 1, 2); close(7);",
    ] {
        assert_eq!(written(call), file, "{call}");
    }
    for (call, wanted) in [
        ("write_p3d(s = s);", "missing-argument"),
        ("write_p3d(\"s.x\");", "missing-argument"),
        ("write_vts(\"s.x\", s, s = s);", "argument-twice"),
        ("write_vts(\"s.x\", name = \"t.x\");", "argument-twice"),
        ("close(7, 8);", "too-many-arguments"),
        ("write_vts(\"s.x\", t = s);", "unknown-argument"),
    ] {
        let text = format!("{grid} {call}");
        let document = Document::from_text(registry(), Box::new(NoFiles), "p.sdl", &text);
        let found = reported(&document);
        assert!(document.diagnostics().iter().any(|d| d.id == wanted), "{call} {found:?}");
    }
}

/// The language has every function that its description names.
#[test]
fn all_functions_are_there() {
    let names = "abs sqrt exp log log10 sin cos tan asin acos atan atan2 sinh cosh tanh floor ceil round sign \
        min max mod div hypot sum prod argmin argmax dot norm len cumlen centroid bbox_min bbox_max reverse swap \
        join spread_i spread_j list points d1 d2 translate scale mirror rotate revolve frame uniform cosine \
        geometric geometric2 d_sinh d_tanh d_tanhx redist makecc makelc makecs makels distc dists evalc derivc \
        lengthc curvc project closest intersect intersections curvature torsion gauss mean normals tfi elliptic \
        hyperbolic quality report fair format open close read write write_p3d write_vts write_stl write_cgns \
        write_csv read_p3d read_points read_aerofoil count next more rewind";
    for name in names.split_whitespace() {
        let row = registry().rows().any(|row| row.name == name && !row.kind);
        assert!(row, "{name}");
    }
    for (library, routines) in [
        (
            0,
            "line dline arc curdist transfinite blend bezier ellipse conic fillet revolve_sub stack ruled copy_edge sweep extrude helix",
        ),
        (
            1,
            "set_fwd_ogive set_barrel set_rear_ogive get_fwd_shoulder set_fin_root set_fin_cnt set_fin_loc set_fin_roll set_off_fin_sp set_sting mk_missile_body",
        ),
        (2, "naca4 naca4l naca4s naca4m naca5 naca16 naca6 naca66tmb"),
    ] {
        let wanted = ["stdsubs.sdl", "mslbody.sdl", "naca.sdl"][library];
        let text = moldloft_lang::LIBRARIES.iter().find(|(name, _)| *name == wanted).unwrap().1;
        for routine in routines.split_whitespace() {
            assert!(text.contains(&format!("subroutine {routine}(")), "{wanted}: {routine}");
        }
    }
}
