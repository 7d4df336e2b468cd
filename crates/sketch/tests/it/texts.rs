//! TEXT against the areas of its letters: sections, solids, their boundary, derivatives, and the text of a sketch.

use crate::common::all_commands;
use crate::treatments::{near, refused, run, volume};
use moldloft_brep::Brep;
use moldloft_sketch::{Files, SketchSession};
use moldloft_testing::{Random, rounds};
use std::sync::Arc;

/// Two fonts of a few letters, and files that hold the volume and the number of faces of a boundary.
struct Fonts;

impl Files for Fonts {
    fn read(&self, _: &str) -> Result<String, String> {
        Err("no files".into())
    }
    fn font(&self, name: &str) -> Result<Arc<[u8]>, String> {
        match name {
            "letters.ttf" => Ok(include_bytes!("../../../font/tests/letters.ttf")[..].into()),
            "letters.otf" => Ok(include_bytes!("../../../font/tests/letters.otf")[..].into()),
            _ => Err("no such font".into()),
        }
    }
    fn step(&self, brep: &Brep, _: &str, _: f64) -> Result<Vec<u8>, String> {
        let volume = brep.volume().ok_or("no volume")?;
        assert!(brep.exact() && brep.faults().is_empty());
        Ok(format!("{} {}", volume.volume, brep.faces.len()).into_bytes())
    }
}

const FONTS: [&str; 2] = ["letters.ttf", "letters.otf"];

fn session() -> SketchSession {
    SketchSession::with_files(Box::new(Fonts))
}

/// The area of the letters H, i, O for capitals of height 1: of rings by four pieces over the corners of a box, whose
/// inner points of degree 3 are at 0.56 of the half-axes, rounded to the grid of the font.
fn letters(font: &str) -> f64 {
    let ring = |r: f64, s: f64| match font {
        "letters.ttf" => 4.0 * r * s * 5.0 / 6.0,
        _ => {
            let (u, v) = (libm::round(0.56 * r), libm::round(0.56 * s));
            let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
            let [a, b, c, d] = [[r, 0.0], [r, v], [u, s], [0.0, s]];
            let sums = 6.0 * (cross(a, b) + cross(c, d))
                + 3.0 * (cross(a, c) + cross(b, c) + cross(b, d))
                + cross(a, d);
            sums / 5.0
        }
    };
    let h = 2.0 * 150.0 * 700.0 + 300.0 * 120.0;
    let i = 150.0 * 480.0 + ring(80.0, 80.0);
    (h + i + ring(350.0, 360.0) - ring(220.0, 230.0)) / (700.0 * 700.0)
}

/// The volume and the number of faces in the written boundary of a body.
fn written(s: &mut SketchSession, name: &str) -> (f64, usize) {
    let replies = s.run_line(&format!("EXPORT STEP {name} b.step"));
    let file = replies.iter().find_map(|r| r.file.clone());
    let file = file.unwrap_or_else(|| panic!("{name}: {replies:?}"));
    let text = String::from_utf8(file.bytes).unwrap();
    let (volume, faces) = text.split_once(' ').unwrap();
    (volume.parse().unwrap(), faces.parse().unwrap())
}

#[test]
fn sections_have_the_areas_of_their_letters() {
    for font in FONTS {
        for plane in ["XY", "XZ", "YZ"] {
            for way in ["", " MIRRORED"] {
                let mut s = session();
                let place = "AT 3 4 ANGLE 30 CENTRE MIDDLE";
                run(
                    &mut s,
                    &format!("TEXT L \"HiO\" FONT {font} SIZE 7 {place} PLANE {plane}{way}"),
                );
                near(s.objects()[0].area.unwrap(), 49.0 * letters(font));
                run(&mut s, "SET L.SIZE1 2.5; SET L.TURN1 10");
                near(s.objects()[0].area.unwrap(), 6.25 * letters(font));
                run(&mut s, "EXTRUDE L 2 INTO E");
                near(volume(&mut s, "E"), 12.5 * letters(font));
            }
        }
    }
}

#[test]
fn letters_are_embossed_and_engraved() {
    let mut random = Random::new(5);
    for font in FONTS {
        for _ in 0..rounds(1, 50) {
            let (size, deep) = (random.between(4.0, 9.0), random.between(0.5, 4.0));
            let turn = random.between(-40.0, 40.0);
            let mut s = session();
            run(
                &mut s,
                &format!(
                    "SKETCH PLATE 2D XY; SET UNITS MM; RECTANGLE 90 60; EXTRUDE PLATE 5\n\
                     TEXT L \"HiO\" FONT {font} SIZE {size} AT 45 30 ANGLE {turn} CENTRE"
                ),
            );
            let own = size * size * letters(font) * deep;
            for (word, sign) in [("UNION", 1.0), ("CUT", -1.0)] {
                let tool = format!("T{word}");
                let part = format!("P{word}");
                run(
                    &mut s,
                    &format!(
                        "EXTRUDE L {} INTO {tool}; MOVE {tool} ON PLATE TOP Z INTO {tool}\n\
                         {word} PLATE {tool} INTO {part}",
                        sign * deep
                    ),
                );
                let exact = 27_000.0 + sign * own;
                near(volume(&mut s, &part), exact);
                let (found, faces) = written(&mut s, &part);
                near(found, exact);
                // The plate and the face inside of O, the walls of H, of i with its dot and of O, and an end or floor of each.
                assert_eq!(faces, 7 + 12 + 4 + 4 + 8 + 4);
            }
        }
    }
}

#[test]
fn other_extruded_curves_are_in_the_boundary() {
    let mut s = session();
    run(
        &mut s,
        "SKETCH P 2D XY; SET UNITS MM; POINT 1 0 0; POINT 2 90 0; POINT 3 45 80\n\
         LINE 1 2 TYPE X; LINE 2 3 TYPE F; LINE 3 1 TYPE F; DIM X 1 2 9; DIM X 1 3 4; DIM Y 1 3 6\n\
         QUADRATIC Q LINES 2 3; GENERATE FACES; EXTRUDE 5\n\
         SKETCH E 2D XY; SET UNITS MM; RECTANGLE 9 6; ELLIPSE A ARC CORNER 3 2 4 SEMI 4 5\n\
         GENERATE FACES; EXTRUDE 5",
    );
    // A parabola over a chord has two thirds of the parallelogram round it; a quarter of an ellipse π/4.
    near(volume(&mut s, "P"), 9.0 * 6.0 * 2.0 / 3.0 * 5.0);
    near(volume(&mut s, "E"), (54.0 - 20.0 * (1.0 - std::f64::consts::FRAC_PI_4)) * 5.0);
    for (name, faces) in [("P", 5), ("E", 7)] {
        let exact = volume(&mut s, name);
        let found = written(&mut s, name);
        near(found.0, exact);
        assert_eq!(found.1, faces, "{name}");
    }
}

#[test]
fn numbers_of_a_text_have_derivatives() {
    for font in FONTS {
        let mut s = session();
        run(&mut s, &format!("TEXT L \"HiO\" FONT {font} SIZE 7 AT 3 4; EXTRUDE L 2 INTO T"));
        let names = ["L.SIZE1", "L.TEXTP1", "L.TURN1", "EXTRUDE1"].map(String::from);
        let g = s.gradient("T", &names).unwrap();
        near(g.volume[0], 2.0 * 2.0 * 7.0 * letters(font));
        assert!(g.volume[1].abs() < 1e-9 && g.volume[2].abs() < 1e-9, "{:?}", g.volume);
        near(g.volume[3], 49.0 * letters(font));
    }
}

#[test]
fn a_text_is_saved_as_its_command() {
    let mut s = session();
    let place = "SIZE 3 AT 1 2 ANGLE 5 RIGHT TOP PLANE XZ MIRRORED";
    run(&mut s, &format!("TEXT L \"H i\" 'O' FONT letters.ttf {place}; EXTRUDE L 2 INTO E"));
    let text = all_commands(&s);
    let mut other = session();
    run(&mut other, &text);
    assert_eq!(all_commands(&other), text);
    assert_eq!(other.objects()[0].area, s.objects()[0].area);
}

#[test]
fn refusals_name_the_character_and_the_font() {
    let mut s = session();
    for (command, why) in [
        ("TEXT L \"HB\" FONT letters.ttf", "no glyph of 'B'"),
        ("TEXT L \" \" FONT letters.ttf", "nothing of the text is visible"),
        ("TEXT L \"H\" FONT letters.ttf BOLD", "expected the end of the command"),
        ("TEXT L \"H\" FONT Arial", "the font Arial cannot be read: no such font"),
        ("TEXT L \"H\" FONT letters.ttf SIZE 0", "no height"),
        ("TEXT L \"H\" FONT letters.ttf PLANE Z", "expected XY, XZ or YZ"),
        ("TEXT L FONT letters.ttf", "expected a text in quotation marks"),
        ("TEXT L \"H\" letters.ttf", "expected FONT"),
    ] {
        let text = refused(&mut s, command);
        assert!(text.contains(why), "{command}: {text}");
    }
    assert!(s.names().is_empty());
}
