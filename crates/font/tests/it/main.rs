//! Outlines of a small font, which `tests/python/helpers/small_font.py` makes; its areas are closed forms.

use moldloft_font::{
    Bezier, Font, FontError, HorizontalAlign, TextLayout, VerticalAlign, font_names,
};

const QUADRATIC: &[u8] = include_bytes!("../letters.ttf");
const CUBIC: &[u8] = include_bytes!("../letters.otf");

/// Half-axes of the rings of the letter O and of the dot of i, in units of the font.
const RINGS: [[f64; 2]; 3] = [[350.0, 360.0], [220.0, 230.0], [80.0, 80.0]];

fn areas(bytes: &[u8], text: &str) -> Vec<f64> {
    let font = Font::new(bytes, None).unwrap();
    let loops = font.outlines(text, &TextLayout::default()).unwrap();
    loops.iter().map(|l| l.area() * 700.0 * 700.0).collect()
}

/// The box round loops.
fn bounds(bytes: &[u8], text: &str, layout: &TextLayout) -> [[f64; 2]; 2] {
    let font = Font::new(bytes, None).unwrap();
    let loops = font.outlines(text, layout).unwrap();
    let all = loops.iter().flat_map(|l| &l.pieces).flat_map(Bezier::ends);
    all.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k]))]
    })
}

fn near(found: f64, exact: f64) {
    assert!((found - exact).abs() <= 1e-9 * exact.abs().max(1.0), "{found}, not {exact}");
}

#[test]
fn areas_are_those_of_their_curves() {
    for (bytes, cubic) in [(QUADRATIC, false), (CUBIC, true)] {
        // Four parabolas over the corners of the box of a ring; cubics have their inner points rounded to the grid.
        let ring = |[r, s]: [f64; 2]| match cubic {
            false => 4.0 * r * s * (5.0 / 6.0),
            true => {
                let [u, v] = [r, s].map(|x| libm::round(0.56 * x));
                // Green's formula of one quarter.
                let c = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
                let p = [[r, 0.0], [r, v], [u, s], [0.0, s]];
                let sum = 6.0 * c(p[0], p[1]) + 3.0 * c(p[0], p[2]) + c(p[0], p[3]);
                let rest = 3.0 * c(p[1], p[2]) + 3.0 * c(p[1], p[3]) + 6.0 * c(p[2], p[3]);
                4.0 * (sum + rest) / 20.0
            }
        };
        let o = areas(bytes, "O");
        assert_eq!(o.len(), 2);
        near(o[0], ring(RINGS[0]));
        near(o[1], -ring(RINGS[1]));
        let mut i = areas(bytes, "i");
        i.sort_by(f64::total_cmp);
        near(i[0], ring(RINGS[2]));
        near(i[1], 150.0 * 480.0);
        near(areas(bytes, "H")[0], 2.0 * 150.0 * 700.0 + 300.0 * 120.0);
    }
}

#[test]
fn overlapping_outlines_are_one_region() {
    for bytes in [QUADRATIC, CUBIC] {
        assert_eq!(areas(bytes, "+").len(), 1);
        near(areas(bytes, "+")[0], 2.0 * 600.0 * 100.0 - 100.0 * 100.0);
        // The letter A: two legs that share their top, and a bar; the triangle over it is a hole.
        let a = areas(bytes, "A");
        assert_eq!(a.len(), 2);
        let slope = 700.0 / 250.0;
        let inner = |y: f64| {
            let left = 150.0 + y / slope;
            let right = 490.0 - y * 240.0 / 700.0;
            right - left
        };
        let meets = 340.0 / (1.0 / slope + 240.0 / 700.0);
        near(-a[1], 0.5 * inner(280.0) * (meets - 280.0));
    }
}

#[test]
fn letters_are_set_by_advance_and_kerning() {
    for bytes in [QUADRATIC, CUBIC] {
        let plain = TextLayout { kerning: false, ..TextLayout::default() };
        let right = |text: &str, layout: &TextLayout| bounds(bytes, text, layout)[1][0] * 700.0;
        near(right("AV", &plain), 640.0 + 640.0);
        near(right("AV", &TextLayout::default()), 640.0 - 80.0 + 640.0);
        near(right("H H", &plain), 700.0 + 300.0 + 650.0);
    }
}

#[test]
fn texts_are_aligned_by_lines_and_capitals() {
    let layout = TextLayout {
        horizontal: HorizontalAlign::Centre,
        vertical: VerticalAlign::Middle,
        ..TextLayout::default()
    };
    let [low, high] = bounds(QUADRATIC, "HH", &layout);
    near(low[0], -650.0 / 700.0);
    near(high[0], 650.0 / 700.0);
    near(low[1], -0.5);
    near(high[1], 0.5);
    let layout = TextLayout {
        horizontal: HorizontalAlign::Right,
        vertical: VerticalAlign::Top,
        ..TextLayout::default()
    };
    // The second baseline is ascent, descent and gap below the first.
    let [low, high] = bounds(QUADRATIC, "H\nHH", &layout);
    near(high[0], -50.0 / 700.0);
    near(high[1], 0.0);
    near(low[1], -1.0 - 1100.0 / 700.0);
}

#[test]
fn what_cannot_be_set_is_named() {
    let font = Font::new(QUADRATIC, None).unwrap();
    let of = |text: &str| font.outlines(text, &TextLayout::default()).unwrap_err();
    assert_eq!(of("HB"), FontError::NoGlyph('B'));
    assert_eq!(of("H\t"), FontError::Control('\t'));
    assert_eq!(of("\u{645}"), FontError::Script('\u{645}'));
    assert_eq!(of("e\u{301}"), FontError::NoGlyph('e'));
    assert_eq!(of("H\u{301}"), FontError::Script('\u{301}'));
    assert_eq!(of("  "), FontError::Blank);
    assert!(matches!(of(&"H".repeat(301)), FontError::TooLong(300)));
    assert!(matches!(Font::new(b"no font", None), Err(FontError::NoFont(_))));
    assert_eq!(font_names(QUADRATIC), [["Letters", "Letters"].map(str::to_owned).to_vec()]);
    assert!(font_names(b"no font").is_empty());
}

#[test]
fn damaged_fonts_give_outlines_or_an_error() {
    // Each byte replaced in turn: no panic, no endless loop.
    for bytes in [QUADRATIC, CUBIC] {
        for k in 0..bytes.len() {
            for value in [0, 0xff] {
                let mut damaged = bytes.to_vec();
                damaged[k] = value;
                if let Ok(font) = Font::new(&damaged, None) {
                    let _ = font.outlines("HOAVi+ \nH", &TextLayout::default());
                }
            }
        }
    }
}
