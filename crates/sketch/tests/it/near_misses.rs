//! Round faces that pass others, or intersect them, by less than a chord: right to rounding, or
//! refused with the position.

use crate::generators::{bar, block, measured};
use moldloft_num::GAUSS_8_UNIT;
use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;

/// A part of a circle of radius r beyond a chord at a height h of its arc: area, arc, chord.
fn segment(r: f64, h: f64) -> [f64; 3] {
    if h <= 0.0 {
        return [0.0; 3];
    }
    // 1 - cos of a small angle, without cancellation.
    let half = 2.0 * libm::asin((h / (2.0 * r)).sqrt());
    let chord = 2.0 * r * libm::sin(half);
    // θ - sin θ of a small angle by its series.
    let t = 2.0 * half;
    let lens = if t < 0.1 {
        t.powi(3) / 6.0 * (1.0 - t * t / 20.0 * (1.0 - t * t / 42.0 * (1.0 - t * t / 72.0)))
    } else {
        t - libm::sin(t)
    };
    [r * r / 2.0 * lens, r * t, chord]
}

/// From a tenth to a ten-millionth, to either side.
fn gap(random: &mut Random) -> f64 {
    let size = libm::pow(10.0, -1.0 - 6.0 * random.unit());
    if random.chance(50) { size } else { -size }
}

#[derive(Default)]
struct Tally {
    right: usize,
    refused: usize,
}

impl Tally {
    /// The figures, or a refusal that is allowed only where things are nearer than the finest chords.
    fn compare(&mut self, s: &mut SketchSession, line: &str, want: [f64; 2], gap: f64, what: &str) {
        let replies = s.run_line(line);
        if let Some(e) = replies.iter().find(|r| r.is_error()) {
            let said = e.text.contains("nearly") && e.about.place.is_some();
            assert!(said && gap.abs() < 2e-4, "{what}: {}", e.text);
            self.refused += 1;
            return;
        }
        let got = measured(s, "C").unwrap_or_else(|| panic!("{what}: no body"));
        for k in 0..2 {
            let off = (got[k] - want[k]).abs();
            assert!(off <= 1e-9 * want[k], "{what}: {got:?} for {want:?}");
        }
        self.right += 1;
    }
}

#[test]
fn bars_and_walls_at_a_hair() {
    let mut random = Random::new(77);
    let mut tally = Tally::default();
    for round in 0..rounds(24, 1_000) {
        let (r, g) = (0.5 + 1.5 * random.unit(), gap(&mut random));
        let (low, high) = (0.5, 0.5 + 2.0 * random.unit());
        let length = high - low;
        // The axis beside the wall x = 0 of a block 10 x 8 x 3: within, the bar leaves it by g; without, it enters it.
        let x = if round % 2 == 0 { r - g } else { -r + g };
        let mut s = SketchSession::new();
        s.insert(block("A", [10.0, 8.0, 3.0], [0.0; 3]));
        s.insert(bar("B", 2.0 * r, [x, 4.0], [low, high]));
        let [area, arc, chord] = segment(r, g);
        let (disc, round_) = (PI * r * r, 2.0 * PI * r);
        let what = format!("bar {r} at {x}, gap {g}");
        if round % 2 == 0 {
            let inside = [disc - area, round_ - arc];
            let cut = [
                240.0 - length * inside[0],
                268.0 + 2.0 * inside[0] + length * (inside[1] - chord),
            ];
            tally.compare(&mut s, "CUT A B INTO C", cut, g, &what);
        } else {
            let out = [disc - area, round_ - arc];
            let united =
                [240.0 + length * out[0], 268.0 + 2.0 * out[0] + length * (out[1] - chord)];
            tally.compare(&mut s, "UNION A B INTO C", united, g, &what);
        }
    }
    println!("{} right, {} refused", tally.right, tally.refused);
    assert!(
        tally.right > 3 * tally.refused / 2,
        "{} right, {} refused",
        tally.right,
        tally.refused
    );
}

/// Two perpendicular bars whose axes are apart by slightly less than the sum of their radii.
#[test]
fn crossing_bars_at_a_hair() {
    let mut random = Random::new(78);
    let mut tally = Tally::default();
    for _ in 0..rounds(10, 300) {
        let (r, q, g) = (0.5 + 1.5 * random.unit(), 0.5 + 1.5 * random.unit(), gap(&mut random));
        let mut s = SketchSession::new();
        s.insert(bar("A", 2.0 * r, [0.0; 2], [-5.0, 5.0]));
        s.insert(bar("B", 2.0 * q, [0.0; 2], [-5.0, 5.0]));
        s.run_text(&format!("ROTATE B X 90; MOVE B {} 0 0", r + q - g));
        let lens = if g > 0.0 { lens(r, q, g) } else { [0.0; 2] };
        let want = [
            10.0 * PI * (r * r + q * q) - lens[0],
            2.0 * PI * (r * r + q * q) + 20.0 * PI * (r + q) - lens[1],
        ];
        tally.compare(&mut s, "UNION A B INTO C", want, g, &format!("bars {r} {q}, gap {g}"));
    }
    println!("{} right, {} refused", tally.right, tally.refused);
    assert!(tally.right >= tally.refused, "{} right, {} refused", tally.right, tally.refused);
}

/// Volume and surface of the common part of two crossing bars whose axes are r + q - g apart.
fn lens(r: f64, q: f64, g: f64) -> [f64; 2] {
    let fall = |r: f64, y: f64| y * y / (r + (r * r - y * y).sqrt());
    let far = |r: f64, h: f64| (h * (2.0 * r - h)).sqrt();
    let gauss = |parts: u32, f: &mut dyn FnMut(f64, f64)| {
        for part in 0..parts {
            for (x, w) in GAUSS_8_UNIT {
                f((f64::from(part) + x) / f64::from(parts), w / f64::from(parts));
            }
        }
    };
    let mut sum = [0.0; 2];
    let top = far(r, g.min(r));
    // y = top sin t: at the rim the width across is a square root in y.
    gauss(12, &mut |x, w| {
        let t = PI * (x - 0.5);
        let y = top * libm::sin(t);
        let dy = top * libm::cos(t) * PI * w;
        let left = g - fall(r, y);
        let wide = far(q, left.clamp(0.0, q));
        gauss(4, &mut |x, w| {
            let z = wide * (2.0 * x - 1.0);
            let dz = 2.0 * wide * w;
            sum[0] += (left - fall(q, z)) * dz * dy;
            // Surfaces of both bars over the plane of y and z.
            sum[1] += (r / (r * r - y * y).sqrt() + q / (q * q - z * z).sqrt()) * dz * dy;
        });
    });
    sum
}

/// A round hole beside the side of a section.
#[test]
fn holes_of_sections_at_a_hair() {
    let mut random = Random::new(79);
    let mut tally = Tally::default();
    for round in 0..rounds(12, 500) {
        let (r, g) = (0.5 + 1.5 * random.unit(), gap(&mut random));
        let x = r - g;
        // Lines within the tolerance of the wireframe coincide: the change is then made from a
        // distance.
        let by_change = round % 2 == 0 || g.abs() < 1e-5;
        let text = format!(
            "SKETCH C 2D XY\nPOINT 1 0 0; POINT 2 100 0; POINT 3 100 80; POINT 4 0 80; POLYLINE 1 2 3 4 CLOSE
            POINT 5 20 20; POINT 6 60 20; POINT 7 60 60; POINT 8 20 60; POLYLINE 5 6 7 8 CLOSE
            DIM X 1 2 10; DIM Y 1 4 8; DIM HX X 1 5 {}; DIM X 5 6 {}; DIM Y 1 5 {}; DIM Y 5 8 {}
            CIRCLE CORNER 5 6 8",
            if by_change { 3.0 } else { x - r },
            2.0 * r,
            4.0 - r,
            2.0 * r
        );
        let mut s = SketchSession::new();
        for reply in s.run_text(&text) {
            assert!(!reply.is_error(), "{}", reply.text);
        }
        // Every other one gets there by a change.
        let mut replies = s.run_line("GENERATE FACES");
        if by_change {
            replies = s.run_line(&format!("SET HX {}", x - r));
        }
        let what = format!("hole {r}, gap {g}");
        match s.objects()[0].area {
            Some(area) => {
                assert!(g < 0.0, "{what}: {area}");
                let want = 80.0 - PI * r * r;
                assert!((area - want).abs() < 1e-9, "{what}: {area} for {want}");
                tally.right += 1;
            }
            None => {
                assert!(replies.iter().any(|r| r.code == Some(701)), "{what}: {replies:?}");
                assert!(g > -2e-4, "{what}: {replies:?}");
                tally.refused += 1;
            }
        }
    }
    println!("{} right, {} refused", tally.right, tally.refused);
    assert!(tally.right > 2 && tally.refused > 2);
}

/// Halves of a ball by planes beside its poles and through its equator are the ball.
#[test]
fn halves_of_a_ball() {
    let mut random = Random::new(80);
    for round in 0..rounds(6, 300) {
        let r = 5.0 + 10.0 * random.unit();
        // The poles are on z.
        let (axis, off) = match round % 3 {
            0 => (2, 0.0),
            1 => (0, r * (0.2 * random.unit() - 0.1)),
            _ => (2, 1.8 * r * (random.unit() - 0.5)),
        };
        let mut text = String::new();
        for (name, low) in [("A", off), ("B", off - 60.0)] {
            let mut at = [-30.0; 3];
            at[axis] = low;
            let [x, y, z] = at;
            text += &format!(
                "SKETCH {name} 2D XZ; RECTANGLE {r} {} AT 0 {}\nARC CORNER 2 1 3 RADIUS {r}\n\
                 ARC CORNER 3 2 4 RADIUS {r}\nGENERATE FACES; REVOLVE {name} 4 360\n\
                 SKETCH W{name} 2D XY; RECTANGLE 60 60; EXTRUDE W{name} 60\n\
                 MOVE W{name} {x} {y} {z}\nCOMMON {name} W{name} INTO H{name}\n",
                2.0 * r,
                -r
            );
        }
        let mut s = SketchSession::new();
        for reply in s.run_text(&(text + "UNION HA HB INTO P")) {
            assert!(!reply.is_error(), "{r} {axis} {off}: {}", reply.text);
        }
        let got = measured(&mut s, "P").unwrap_or_else(|| panic!("{r} {axis} {off}"));
        let want = [4.0 / 3.0 * PI * r.powi(3), 4.0 * PI * r * r];
        for k in 0..2 {
            assert!((got[k] - want[k]).abs() <= 1e-11 * want[k], "{r} {axis} {off}: {got:?}");
        }
    }
}
