//! Surfaces and solids.

use crate::laws::program::Program;
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
            match p.random.below(4) {
                0 => format!("{profile}, {path}, {divisions}"),
                3 => format!("{profile}, {path}, \"fixed\", scale = {{1, w}}, {divisions}"),
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
        "TanBoundary" => {
            let floor = flat_patch(p, 0.0);
            let low = p.object("EdgeSnake", &format!("3, {floor}"));
            // Sides that leave the floor along its lines u = 0 and u = 1.
            let mut side = |u: usize| {
                let [a, b] = [0, 1].map(|v| p.object("AbsMagnet", &format!("{floor}, {u}, {v}")));
                let on = p.object("BlendPoint", &format!("{{{b}, {a}}}, {{1.25, -0.25}}"));
                let (x, z) = (p.number(-0.3, 0.3), p.number(0.5, 1.5));
                let top = p.object("AbsPoint", &format!("{}*w + {x}, 5, {z}*h", 4 * u));
                (p.object("BCurve", &format!("{{{b}, {on}, {top}}}, degree = 2")), top)
            };
            let ((west, a), (east, b)) = (side(0), side(1));
            let high = p.object("Line", &format!("{a}, {b}"));
            format!("{{{low}, {east}, {high}, {west}}}, {divisions}")
        }
        "DevSurf" => format!("{}, {divisions}", bows(p)),
        "ExpandedSurf" => {
            let args = bows(p);
            let plate = p.object("DevSurf", &args);
            format!("{plate}, {}, {divisions}", p.frame())
        }
        "FoilLoftSurf" => {
            // Nose, thickness point and tail at the root and, smaller, at the tip.
            let mut rail = |x: f64, z: f64| {
                let ends = [(x, 0.0), (0.5 * x + 0.5, 3.0)].map(|(x, y)| {
                    let (dx, dz) = (p.number(-0.1, 0.1), p.number(-0.02, 0.02));
                    p.object("AbsPoint", &format!("{x}*w + {dx}, {y}, {z}*h + {dz}"))
                });
                p.object("Line", &ends.join(", "))
            };
            let (nose, up, tail) = (rail(0.0, 0.0), rail(0.6, 0.2), rail(2.0, 0.0));
            let family = *p.random.pick(&["4-digit", "16", "65A", "66tmb"]);
            let rails = match p.random.below(2) {
                0 => format!("{nose}, {up}, {tail}"),
                _ => format!("{tail}, {up}, {nose}, {tail}"),
            };
            format!("{{{rails}}}, \"{family}\", {divisions}")
        }
        "RollFillet" => {
            // A floor, and a wall that stands across its middle.
            let floor = flat_patch(p, 0.0);
            let wall = wall(p);
            match p.random.below(2) {
                0 => format!("{floor}, {wall}, 0.3*w, side2 = 1, {divisions}"),
                _ => {
                    format!("{floor}, {wall}, 0.4, side2 = 1, radii = {{0.3*w, 0.4}}, {divisions}")
                }
            }
        }
        "TrimSurf" => {
            let sheet = p.sheet();
            let mut at = |u: f64, v: f64| {
                let (u, v) = (p.number(u - 0.03, u + 0.03), p.number(v - 0.03, v + 0.03));
                p.object("AbsMagnet", &format!("{sheet}, {u}, {v}"))
            };
            let [a, b, c] = [at(0.1, 0.1), at(0.9, 0.15), at(0.4, 0.9)];
            let hole = [at(0.45, 0.35), at(0.55, 0.35), at(0.45, 0.45)].join(", ");
            let pairs = [format!("{a}, {b}"), format!("{c}, {b}"), format!("{c}, {a}")];
            let sides = pairs.map(|ends| p.object("LineSnake", &ends)).join(", ");
            // Round its second magnet, through the first.
            let (centre, rest) = hole.split_once(", ").expect("three magnets");
            let (from, toward) = rest.split_once(", ").expect("two magnets");
            let round = p.object("ArcSnake", &format!("{from}, {centre}, {toward}, type = 6"));
            format!("{sheet}, {{{sides}, {round}}}, rim = 5, nu = 4, nv = 4")
        }
        "Blister" => {
            let sheet = p.sheet();
            let mut at = |u: f64, v: f64| {
                let (u, v) = (p.number(u - 0.03, u + 0.03), p.number(v - 0.03, v + 0.03));
                p.object("AbsMagnet", &format!("{sheet}, {u}, {v}"))
            };
            let [c, a, b] = [at(0.5, 0.5), at(0.75, 0.5), at(0.5, 0.7)];
            let ring = p.object("ConicSnake", &format!("{c}, {a}, {b}"));
            let edge = *p.random.pick(&["sharp", "tangent", "curvature"]);
            let top = *p.random.pick(&["round", "pointed"]);
            format!("{ring}, {c}, 0.2*w, \"{edge}\", \"{top}\", {divisions}")
        }
        "TabSurf" => {
            let [x, y, z] = p.coordinates();
            format!(
                "rows = 2, points = {{{{0, 0, {x}}}, {{1, {y}*w, 0}}, {{2*w, 1, {z}}}, {{0, 0, 3}}, {{1, 1, 3*w}}, \
                 {{2, 1, 4}}}}, {divisions}"
            )
        }
        "OffsetSurf" => format!("{}, 0.2*w, {divisions}", p.sheet()),
        "PolySurf" => {
            let [a, b, c] = stations(p);
            let r = p.object("RuledSurf", &format!("{a}, {b}, visible = 0"));
            let s = p.object("RuledSurf", &format!("{b}, {c}, visible = 0"));
            match p.random.below(2) {
                0 => format!("{{{r}, {s}}}, \"v\", {divisions}"),
                _ => format!("{{{r}, {s}}}, \"v\", {{0.3*w}}, {divisions}"),
            }
        }
        "ProcSurf" => {
            let [path, other, _] = stations(p);
            let bead = p.bead(&path);
            let copy = p.object("CopyBead", &format!("{bead}, {other}"));
            let middle = p.object("RelPoint", &format!("{bead}, 0.5*w, h, 0.3"));
            let rib = p.object("BCurve", &format!("{{{bead}, {middle}, {copy}}}, degree = 2"));
            format!("{bead}, {rib}, t1 = 0.1*w, t2 = 0.9, {divisions}")
        }
        "BFitSurf" => format!("{}, 2, 2, 5, 4, {divisions}", p.surface()),
        "NUBFitSurf" => format!("{}, 3, 1, {{0, 0.3*w, 1}}, {{0, 1}}, {divisions}", p.surface()),
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
            let words = match p.random.below(6) {
                0 => "as = \"control\"",
                1 => "breaks_u = {3}",
                2 => "mode = \"faithful\", passes = 2",
                3 => "rims = \"position\"",
                4 => "rims = {\"tangent\", \"corners\", \"corners\", \"curvature\"}",
                _ => "measure = \"bending\"",
            };
            format!("{grid}, {}, {words}, {divisions}", p.number(0.05, 0.3))
        }
        "NetSurf" => {
            let args = patches(p);
            let net = p.object("FairPatches", &args);
            format!("{net}, {}, {divisions}", 1 + p.random.below(2))
        }
        _ => return None,
    })
}

/// The arguments of two grids with a common row that are faired together.
pub fn patches(p: &mut Program) -> String {
    let grids = [0, 4].map(|start| {
        let grid = p.name("g");
        writeln!(p.text, "surface {grid}[5, 5];").unwrap();
        (grid, start)
    });
    for i in 1..=9 {
        for j in 1..=5 {
            let z = p.number(-0.1, 0.1);
            for (grid, start) in &grids {
                let row = i - start;
                if (1..=5).contains(&row) {
                    writeln!(p.text, "{grid}[{row},{j}] = {{{i}*w, {j}, {z}*h}};").unwrap();
                }
            }
        }
    }
    let words = match p.random.below(4) {
        0 => "as = \"control\"",
        1 => "seams = \"tangent\"",
        2 => "seams = \"position\", rims = \"position\"",
        _ => "measure = \"bending\"",
    };
    let [(a, _), (b, _)] = grids;
    format!("{{{a}, {b}}}, {}, {words}", p.number(0.5, 0.9))
}

/// Two nearly parallel bows, so that rulings run across.
fn bows(p: &mut Program) -> String {
    let curves = [0.0, 2.0].map(|z| {
        let points: Vec<String> = (0..3)
            .map(|j| {
                let (x, y) = (p.number(-0.1, 0.1), p.number(-0.1, 0.1));
                let bow = [0.0, 1.5, 0.0][j];
                p.object("AbsPoint", &format!("{}*w + {x}, {bow} + {y}, {z}", 2 * j))
            })
            .collect();
        p.object("BCurve", &format!("{{{}}}, degree = 2", points.join(", ")))
    });
    curves.join(", ")
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

/// A hidden wall that stands across the middle of a flat patch.
pub fn wall(p: &mut Program) -> String {
    let wall = [-1.0, 3.0].map(|z| {
        let ends = [0.0, 4.0].map(|x| {
            let (y, dz) = (p.number(2.0, 2.3), p.number(-0.2, 0.2));
            p.object("AbsPoint", &format!("{x}, {y} + 0.05*w, {z} + {dz}"))
        });
        p.object("Line", &ends.join(", "))
    });
    p.object("RuledSurf", &format!("{}, visible = 0", wall.join(", ")))
}

/// A patch that is nearly flat, at the height `z`.
pub fn flat_patch(p: &mut Program, z: f64) -> String {
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
