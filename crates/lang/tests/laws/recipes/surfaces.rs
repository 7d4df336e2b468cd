//! Surfaces and solids.

use crate::program::Program;
use std::fmt::Write;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let divisions = p.divisions();
    let t = p.number(0.05, 0.3);
    Some(match kind {
        "RuledSurf" | "TranSurf" => format!("{}, {divisions}", p.curves::<2>().join(", ")),
        "BLoftSurf" => {
            let masters = p.curves::<3>().join(", ");
            format!("{{{masters}}}, degree = 2, {divisions}")
        }
        "CLoftSurf" => {
            // Masters of its own, apart from one another.
            let masters: Vec<String> = (0..3)
                .map(|k| {
                    let points: Vec<String> = (0..3)
                        .map(|j| {
                            let (y, z) = (p.number(-0.5, 0.5), p.number(-0.5, 0.5));
                            p.object("AbsPoint", &format!("{}*w, {j} + {y}, {z}", 2 * k))
                        })
                        .collect();
                    p.object(
                        "BCurve",
                        &format!("{{{}}}, degree = 2, visible = 0", points.join(", ")),
                    )
                })
                .collect();
            format!("{{{}}}, {divisions}", masters.join(", "))
        }
        "BSurf" => {
            let net = p.points::<6>().join(", ");
            format!("{{{net}}}, nu = 3, nv = 2, degree_u = 2, degree_v = 1, {divisions}")
        }
        "FacePatch" => match p.random.below(3) {
            0 => format!("{{{}}}, {divisions}", p.points::<3>().join(", ")),
            1 => format!("{{{}}}, {divisions}", p.points::<4>().join(", ")),
            _ => {
                // A plane pentagon that grows with w.
                let corners: Vec<String> = [(0, 0), (4, 0), (5, 2), (3, 4), (-1, 3)]
                    .map(|(x, y)| p.object("AbsPoint", &format!("{x}*w, {y}, {x} + {y}*w")))
                    .to_vec();
                format!("{{{}}}, {divisions}", corners.join(", "))
            }
        },
        "RevSurf" => {
            let [a, b] = p.points();
            let line = p.object("Line", &format!("{a}, {b}"));
            format!("{}, {line}, {t}, 2.25, {divisions}", p.curve())
        }
        "SubSurf" => {
            let s = p.surface();
            let m: [String; 4] = std::array::from_fn(|_| p.magnet(&s));
            let mut side =
                |a: usize, b: usize| p.object("LineSnake", &format!("{}, {}", m[a], m[b]));
            let sides = [side(0, 1), side(1, 2), side(3, 2), side(0, 3)];
            match p.random.below(3) {
                0 => format!("{{{}, {}}}, {divisions}", sides[0], sides[2]),
                1 => format!("{{{}, {}}}, {divisions}", sides[0], m[2]),
                _ => format!("{{{}}}, {divisions}", sides.join(", ")),
            }
        }
        "MirrSurf" => format!("{}, {}, {divisions}", p.surface(), p.mirror()),
        "FairSurf" => {
            let grid = p.name("g");
            writeln!(p.text, "surface {grid}[5, 5];").unwrap();
            for (i, j) in (1..=5).flat_map(|i| (1..=5).map(move |j| (i, j))) {
                let z = p.number(-0.2, 0.2);
                writeln!(p.text, "{grid}[{i},{j}] = {{{i}*w, {j}, {z}*h}};").unwrap();
            }
            let words = match p.random.below(3) {
                0 => "as = \"control\"",
                1 => "breaks_u = {3}",
                _ => "measure = \"bending\"",
            };
            format!("{grid}, {}, {words}, {divisions}", p.number(0.05, 0.3))
        }
        _ => return None,
    })
}
