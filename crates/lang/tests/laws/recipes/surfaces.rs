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
            // Round an area, so that the patch is not folded.
            let m = [(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8)].map(|(u, v)| {
                let (u, v) = (p.number(u - 0.15, u + 0.15), p.number(v - 0.15, v + 0.15));
                p.object("AbsMagnet", &format!("{s}, {u}, {v}"))
            });
            let mut side =
                |a: usize, b: usize| p.object("LineSnake", &format!("{}, {}", m[a], m[b]));
            let sides = [side(0, 1), side(1, 2), side(3, 2), side(0, 3)];
            match p.random.below(3) {
                0 => format!("{{{}, {}}}, {divisions}", sides[0], sides[2]),
                1 => format!("{{{}, {}}}, {divisions}", sides[0], m[2]),
                _ => format!("{{{}}}, {divisions}", sides.join(", ")),
            }
        }
        "XLoftSurf" => {
            let masters = stations(p).join(", ");
            format!("1, {{{masters}}}, ends = \"bessel\", {divisions}")
        }
        "ArcLoftSurf" => {
            let kind = 1 + p.random.below(6);
            format!("{}, type = {kind}, {divisions}", stations(p).join(", "))
        }
        "NURBSurf" => {
            let net = p.points::<6>().join(", ");
            let knot = p.number(0.2, 0.8);
            format!(
                "{{{net}}}, nu = 3, nv = 2, degree_u = 1, degree_v = 1, weights = {{1, w, 2, h, 1, 1.5}}, \
                 knots_u = {{0, 0, {knot}, 1, 1}}, {divisions}"
            )
        }
        "SweepSurf" => {
            let profile = p.curve();
            let [path, ..] = stations(p);
            match p.random.below(3) {
                0 => format!("{profile}, {path}, {divisions}"),
                1 => format!("{profile}, {path}, \"up\", up = {{0, 0.1, w}}, {divisions}"),
                _ => format!("{profile}, {path}, twist = {{0, h}}, scale = {{1, w}}, {divisions}"),
            }
        }
        "BlendSurf" | "BlendCenter" => {
            let [a, b, c, d] = p.points();
            let mut side = |a: &str, b: &str| {
                let (x, y, z) = (p.number(-1.0, 1.0), p.number(-1.0, 1.0), p.number(-1.0, 1.0));
                let middle = p.object("AbsPoint", &format!("{x}, {y}, {z}"));
                p.object("BCurve", &format!("{{{a}, {middle}, {b}}}, 2"))
            };
            let sides = [side(&a, &b), side(&b, &c), side(&d, &c), side(&a, &d)].join(", ");
            if kind == "BlendSurf" {
                format!("{{{sides}}}, {divisions}")
            } else {
                format!("{{{sides}}}, {}, {divisions}", p.point())
            }
        }
        "FilletSurf" => {
            let low = flat_patch(p, 0.0);
            let high = flat_patch(p, 5.0);
            let (a, b) = (p.number(0.3, 0.7), p.number(0.3, 0.7));
            let first = p.object("UVSnake", &format!("{low}, \"v\", {a}"));
            let second = p.object("UVSnake", &format!("{high}, \"v\", {b}"));
            let continuity = 1 + p.random.below(2);
            format!("{first}, {second}, w, h, continuity = {continuity}, {divisions}")
        }
        "RotatSurf" => {
            let [a, b] = p.points();
            let line = p.object("Line", &format!("{a}, {b}"));
            format!("{}, {line}, h, {divisions}", p.surface())
        }
        "CopySurf" => {
            let [a, b] = p.points();
            format!("{}, {a}, {b}, w, 1.2, {t}, {divisions}", p.surface())
        }
        "ProjSurf" => {
            let plane = p.random.pick(&p.planes).clone();
            format!("{}, {plane}, {divisions}", p.surface())
        }
        "RelSurf" => format!("{}, {}, {divisions}", p.surface(), p.points::<4>().join(", ")),
        "FaceSurf" => {
            let solid = block(p);
            format!("{}, {solid}, {divisions}", 1 + p.random.below(6))
        }
        "RuledSolid" => {
            let [a, b] = [flat_patch(p, 0.0), flat_patch(p, 4.0)];
            format!("{a}, {b}, divisions = {{2, 2, 3}}")
        }
        "BLoftSolid" | "CLoftSolid" => {
            let layers = [0.0, 3.0, 7.0].map(|z| flat_patch(p, z)).join(", ");
            format!("{{{layers}}}, divisions = {{2, 3, 2}}")
        }
        "BSolid" => {
            let points = p.points::<8>().join(", ");
            format!("{{{points}}}, 2, 2, 2, divisions = 2")
        }
        "TranSolid" | "SweepSolid" => {
            let patch = flat_patch(p, 0.0);
            let [path, ..] = stations(p);
            format!("{patch}, {path}, divisions = {{2, 2, 3}}")
        }
        "BlendSolid" => {
            let solid = block(p);
            let faces: Vec<String> = (1..=6)
                .map(|f| p.object("FaceSurf", &format!("{f}, {solid}, visible = 0")))
                .collect();
            format!("{{{}}}, divisions = {{2, 3, 4}}", faces.join(", "))
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

/// Three curves apart from one another: at y = 0, 2 and 4 more or less, and away from one line.
fn stations(p: &mut Program) -> [String; 3] {
    std::array::from_fn(|k| {
        let points: Vec<String> = (0..3)
            .map(|j| {
                let (x, y, z) = (p.number(-0.3, 0.3), p.number(-0.3, 0.3), p.number(-0.3, 0.3));
                let bow = [0.0, 1.5, 0.0][k];
                p.object("AbsPoint", &format!("{}*w + {x}, {bow} + {y}, 2*{j} + {z}", 2 * k))
            })
            .collect();
        p.object("BCurve", &format!("{{{}}}, degree = 2, visible = 0", points.join(", ")))
    })
}

/// A patch that is nearly flat, at the height `z`.
fn flat_patch(p: &mut Program, z: f64) -> String {
    let sides: Vec<String> = [0.0, 3.0]
        .map(|y| {
            let points: Vec<String> = (0..3)
                .map(|j| {
                    let (a, b) = (p.number(-0.3, 0.3), p.number(-0.3, 0.3));
                    p.object(
                        "AbsPoint",
                        &format!("2*{j} + {a}, {y} + {z} + {b}, {z}*0.6 + 0.2*{b}"),
                    )
                })
                .collect();
            p.object("BCurve", &format!("{{{}}}, degree = 2, visible = 0", points.join(", ")))
        })
        .into();
    p.object("RuledSurf", &format!("{}, visible = 0", sides.join(", ")))
}

/// A solid between two patches.
fn block(p: &mut Program) -> String {
    let [a, b] = [flat_patch(p, 0.0), flat_patch(p, 4.0)];
    p.object("RuledSolid", &format!("{a}, {b}, visible = 0"))
}
