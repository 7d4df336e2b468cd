//! Drawings of other programs as sections: coordinates to rounding, lines that cross, blocks, units.

use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;
use std::fmt::Write as _;

struct OneFile(&'static str, String);

impl Files for OneFile {
    fn read(&self, name: &str) -> Result<String, String> {
        if name == self.0 { Ok(self.1.clone()) } else { Err("there is no such file".to_owned()) }
    }
}

fn groups(text: &str) -> String {
    text.split_whitespace().fold(String::new(), |out, word| out + word + "\n")
}

fn line([x, y]: [f64; 2], [u, v]: [f64; 2]) -> String {
    groups(&format!("0 LINE 10 {x:?} 20 {y:?} 11 {u:?} 21 {v:?}"))
}

fn circle([x, y]: [f64; 2], r: f64) -> String {
    groups(&format!("0 CIRCLE 10 {x:?} 20 {y:?} 40 {r:?}"))
}

fn polygon(corners: &[[f64; 2]]) -> String {
    (0..corners.len()).map(|k| line(corners[k], corners[(k + 1) % corners.len()])).collect()
}

fn file(before: &str, entities: &str) -> String {
    groups(before) + &groups("0 SECTION 2 ENTITIES") + entities + &groups("0 ENDSEC 0 EOF")
}

fn imported(text: String) -> SketchSession {
    let mut s = SketchSession::with_files(Box::new(OneFile("plate.dxf", text)));
    for command in ["IMPORT \"plate.dxf\"", "ACCEPT ALL", "GENERATE FACES"] {
        let replies = s.run_line(command);
        assert!(replies.iter().all(|r| !r.is_error()), "{command}: {replies:?}");
    }
    s
}

fn area(s: &mut SketchSession) -> f64 {
    s.objects()[0].area.unwrap()
}

#[test]
fn a_plate_with_a_hole_keeps_its_coordinates() {
    let corners = [[1.25, -3.0], [124.706, -3.0], [124.706, 75.9], [1.25, 75.9]];
    let units = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC";
    let mut s = imported(file(units, &(polygon(&corners) + &circle([20.25, 20.125], 3.3))));
    let want = 123.456 * 78.9 - PI * 3.3 * 3.3;
    assert!((area(&mut s) - want).abs() < 1e-12 * want, "{}", area(&mut s));
    let object = s.active_object().unwrap().clone();
    assert_eq!(object.units.as_deref(), Some("MM"));
    assert_eq!(object.drawing.section, Some(CoordinateAxis::Z));
    let data = s.objects().remove(0);
    for (id, [x, y, _]) in &data.points {
        let Some(page) = data.page.iter().find(|p| p.0 == *id) else { continue };
        assert!((x.unwrap() - page.1[0]).abs() < 1e-12 * 124.0);
        assert!((y.unwrap() - page.1[1]).abs() < 1e-12 * 124.0);
    }
    // The commands make the same object, and the journal does without the file.
    let mut again = SketchSession::new();
    assert!(again.run_text(&script(&object)).iter().all(|r| !r.is_error()));
    assert_eq!(again.active_object(), Some(&object));
    let mut replayed = SketchSession::new();
    assert!(replayed.run_text(&s.journal().join("\n")).iter().all(|r| !r.is_error()));
    assert_eq!(replayed.active_object(), Some(&object));
}

/// Leaning lines stay as they lean, whatever their slope.
#[test]
fn polygons_of_any_slopes() {
    let mut random = Random::new(21);
    for _ in 0..rounds(5, 400) {
        // A star about the origin is simple.
        let n = 3 + random.below(9);
        let corners: Vec<[f64; 2]> = (0..n)
            .map(|k| {
                let angle = (k as f64 + 0.2 * random.unit()) * 2.0 * PI / n as f64;
                let r = random.decimal(10.0, 90.0);
                [r * libm::cos(angle), r * libm::sin(angle)].map(|x| (x * 1e4).round() / 1e4)
            })
            .collect();
        let twice: f64 = (0..n)
            .map(|k| {
                let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % n]);
                a * d - b * c
            })
            .sum();
        let mut s = imported(file("", &polygon(&corners)));
        let got = area(&mut s);
        assert!((got - 0.5 * twice).abs() < 1e-11 * twice, "{got} {corners:?}");
    }
}

#[test]
fn lines_that_cross_and_blocks() {
    // A square with both middle lines drawn through: four faces.
    let mut lines = polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
    lines += &line([5.0, 0.0], [5.0, 10.0]);
    lines += &line([0.0, 4.0], [10.0, 4.0]);
    let mut s = imported(file("", &lines));
    assert_eq!(s.active_object().unwrap().faces.len(), 4);
    assert!((area(&mut s) - 100.0).abs() < 1e-12);
    // A block with a base point, inserted twice: as it is, and turned, stretched and moved.
    let mut blocks = groups("0 SECTION 2 BLOCKS 0 BLOCK 2 TRIANGLE 10 1 20 1");
    blocks += &polygon(&[[1.0, 1.0], [4.0, 1.0], [1.0, 3.0]]);
    blocks += &groups("0 ENDBLK 0 ENDSEC");
    let inserts =
        groups("0 INSERT 2 TRIANGLE 10 0 20 0 0 INSERT 2 TRIANGLE 10 20 20 5 41 2 42 3 50 90");
    let mut text = blocks;
    write!(text, "{}", file("", &inserts)).unwrap();
    let mut s = imported(text);
    assert!((area(&mut s) - (3.0 + 18.0)).abs() < 1e-12, "{}", area(&mut s));
    let places: Vec<[f64; 2]> = s.objects()[0].page.iter().map(|p| p.1).collect();
    for corner in [[20.0, 5.0], [20.0, 11.0], [14.0, 5.0]] {
        assert!(places.contains(&corner), "{places:?}");
    }
}

/// A picture of a solid needs an object of its own.
#[test]
fn pictorials_stay_pictorials() {
    let text = file("", &polygon(&[[0.0, 0.0], [10.0, 0.0], [10.0, 7.0], [0.0, 7.0]]));
    let mut s = SketchSession::with_files(Box::new(OneFile("plate.dxf", text)));
    s.run_line("SKETCH A 3D");
    assert!(s.run_line("IMPORT \"plate.dxf\"").iter().all(|r| !r.is_error()));
    let drawing = &s.active_object().unwrap().drawing;
    assert_eq!((drawing.section, drawing.exact), (None, false));
}
