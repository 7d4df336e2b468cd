//! Curves.

use crate::laws::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let [x, _, z] = p.coordinates();
    Some(match kind {
        "Line" => p.points::<2>().join(", "),
        "Arc" => {
            format!("{}, type = {}", p.points::<3>().join(", "), 1 + p.random.below(6))
        }
        "BCurve" => {
            format!("{{{}, {{{x}, w, {z}}}}}, degree = 2", p.points::<4>().join(", "))
        }
        "CCurve" => match p.random.below(3) {
            0 => format!("{{{}}}, ends = \"natural\"", p.points::<4>().join(", ")),
            1 => format!("{{{}}}, degree = 1", p.points::<3>().join(", ")),
            _ => format!("{{{}}}", p.points::<5>().join(", ")),
        },
        "XCurve" => {
            let points: Vec<String> = (0..4)
                .map(|k| {
                    let (y, z) = (p.number(-1.0, 1.0), p.number(-1.0, 1.0));
                    p.object("AbsPoint", &format!("{k}*w, {y}, {z}"))
                })
                .collect();
            format!("\"x\", {{{}}}", points.join(", "))
        }
        "NURBCurve" => {
            let points = p.points::<4>().join(", ");
            match p.random.below(2) {
                0 => format!("{{{points}}}, 2, {{0, 0, 0, 0.45*w, 1, 1, 1}}"),
                _ => format!("{{{points}}}, 3, weights = {{1, w, 0.7, 1.5}}"),
            }
        }
        "BSubCurve" => {
            let curve = p.curve();
            // Ascending: where a curve turns back on itself its speed has a kink.
            let at = [p.number(0.1, 0.3), p.number(0.35, 0.5), p.number(0.6, 0.9)];
            let beads = at.map(|t| p.object("AbsBead", &format!("{curve}, {t}")));
            format!("{{{}}}, degree = 2", beads.join(", "))
        }
        "RelCurve" => format!("{}, {}", p.curve(), p.points::<2>().join(", ")),
        "CopyCurve" => {
            format!("{}, {}, {x}, w, {z}", p.curve(), p.points::<2>().join(", "))
        }
        "RotatCurve" => {
            let [a, b] = p.points();
            let line = p.object("Line", &format!("{a}, {b}"));
            format!("{}, {line}, {x}*w", p.curve())
        }
        "OffsetCurve" => {
            let points = p.points::<3>().join(", ");
            let curve = p.object("Arc", &points);
            let [a, b, c] = p.points();
            let plane = p.object("ThreePointPlane", &format!("{a}, {b}, {c}"));
            format!("{curve}, 0.01*w, {plane}")
        }
        "TanCurve" => {
            let points = p.points::<3>().join(", ");
            let curve = p.object("BCurve", &format!("{{{points}}}, degree = 2"));
            format!("{curve}, 0.3*w")
        }
        "TabCurve" => {
            let [x, y, z] = p.coordinates();
            format!("points = {{{{0, 0, {x}}}, {{1, {y}*w, 0}}, {{2*w, 1, {z}}}, {{3, 0, w}}}}")
        }
        "BFitCurve" => format!("{}, 2, 5", p.curve()),
        "NUBFitCurve" => format!("{}, 3, {{0, 0.3*w, 1}}", p.curve()),
        "ProcCurve" => {
            let curve = p.curve();
            let bead = p.bead(&curve);
            let other = p.point();
            let middle = p.object("BlendPoint", &format!("{{{bead}, {other}}}, {{w, 1 - w}}"));
            let image = p.object("MirrPoint", &format!("{middle}, \"y=0\""));
            format!("{bead}, {image}, t1 = 0.2*w, t2 = 0.9")
        }
        "Conic" => {
            format!("{}, {x}, {z}*w, type = {}", p.points::<3>().join(", "), 1 + p.random.below(3))
        }
        "Helix" => {
            let [a, b, c] = p.points();
            let line = p.object("Line", &format!("{a}, {b}"));
            format!("{c}, {line}, {x}*w, {z}")
        }
        "FoilCurve" => {
            let [t, u, n, d] = p.points();
            let family = p.random.pick(&["4-digit", "modified", "16", "63", "65A", "66tmb"]);
            let offset = p.random.pick(&["affine", "normal"]);
            let more = match *family {
                "4-digit" => "camber_at = 0.3*w",
                "modified" => "nose_index = 4*w, thickness_at = 0.45",
                "66tmb" => "load = 0.5*w",
                _ => "tail = \"open\"",
            };
            let points = match p.random.below(3) {
                0 => format!("{n}, {u}, {t}"),
                1 => format!("{t}, {u}, {n}, {d}"),
                _ => format!("{t}, {u}, {n}, {d}, {t}"),
            };
            format!("{{{points}}}, \"{family}\", offset = \"{offset}\", {more}")
        }
        "PolyCurve" => {
            let [a, b, c, d] = p.points();
            let first = p.object("BCurve", &format!("{{{a}, {b}, {c}}}, degree = 2"));
            let last = p.object("Line", &format!("{c}, {d}"));
            match p.random.below(2) {
                0 => format!("{{{first}, {last}}}"),
                _ => format!("{{{first}, {last}}}, {{0.4*w}}"),
            }
        }
        "SubCurve" => {
            let curve = p.curve();
            format!("{}, {}", p.bead(&curve), p.bead(&curve))
        }
        "Intersection" => {
            let (sheet, at) = (p.sheet(), p.number(1.0, 3.0));
            format!("{sheet}, {}", p.object("XPlane", &format!("{at}*w")))
        }
        // Two walls side by side, which end beyond the sheet.
        "BodyIntersection" => {
            let sheet = p.sheet();
            let posts =
                [(1.3, 2.2, -0.4), (1.5, 2.0, 1.0), (1.6, 1.9, 2.4)].map(|(low, high, y)| {
                    let foot = p.object("AbsPoint", &format!("{low}*w, {y}, -1"));
                    let head = p.object("AbsPoint", &format!("{high}*w, {y}, 1"));
                    p.object("Line", &format!("{foot}, {head}"))
                });
            let walls: Vec<String> = posts
                .windows(2)
                .map(|w| p.object("RuledSurf", &format!("{}, {}, visible = 0", w[0], w[1])))
                .collect();
            format!("{{{}}}, {{{sheet}}}", walls.join(", "))
        }
        "ProjCurve" => {
            let (sheet, strand) = (p.sheet(), p.strand());
            match p.random.below(2) {
                0 => format!("{strand}, {sheet}"),
                _ => format!("{strand}, \"y=0\""),
            }
        }
        "ConjugateArc" => {
            let sweep = p.number(0.5, 6.0);
            format!("{}, {sweep}*w/h", p.points::<3>().join(", "))
        }
        "CubicChain" => format!("{{{}}}", p.points::<7>().join(", ")),
        "MirrCurve" => format!("{}, {}", p.curve(), p.mirror()),
        "FairCurve" => {
            let closed = p.random.below(3) == 0;
            let points = if closed { ring(p) } else { row(p, 7, 0.0) };
            let mut tolerance = p.number(0.02, 0.2);
            let words = match p.random.below(6) {
                0 => "measure = \"third\", ends = \"position\"".to_owned(),
                1 => "as = \"points\"".to_owned(),
                2 if !closed => "breaks = {4}, measure = \"bending\"".to_owned(),
                3 => "mode = \"faithful\"".to_owned(),
                4 if !closed => {
                    // A curve that ends at its first point.
                    let first = points.split(", ").next().expect("a row of seven").to_owned();
                    let [dy, dz] = [p.number(-0.1, 0.1), p.number(-0.1, 0.1)];
                    let before = [2.0, 1.0]
                        .map(|x| p.object("AbsPoint", &format!("-{x}*w, {dy} + 0.2*h, {dz}*{x}")));
                    let neighbour = p.object(
                        "BCurve",
                        &format!("{{{}, {first}}}, degree = 2", before.join(", ")),
                    );
                    tolerance = "1.5".to_owned();
                    format!("joins = {{{neighbour}}}")
                }
                _ => "as = \"control\", degree = 2".to_owned(),
            };
            format!("{{{points}}}, {tolerance}, {words}, closed = {}", u8::from(closed))
        }
        "FairNet" => {
            let words = ["", ", kept_ends = \"ends\"", ", mode = \"faithful\""][p.random.below(3)];
            format!("{}{words}", net(p))
        }
        "FairPatches" => super::surfaces::patches(p),
        "NetCurve" => {
            let args = net(p);
            let net = p.object("FairNet", &args);
            format!("{net}, {}", 1 + p.random.below(2))
        }
        _ => return None,
    })
}

/// So many points in a wavy row, from x = 0 on.
fn row(p: &mut Program, count: usize, z: f64) -> String {
    let points: Vec<String> = (0..count)
        .map(|k| {
            let (dy, dz) = (p.number(-0.2, 0.2), p.number(-0.2, 0.2));
            p.object("AbsPoint", &format!("{}*w, {dy} + 0.2*h, {z} + {dz}", 0.5 * k as f64))
        })
        .collect();
    points.join(", ")
}

/// Points round a wavy ring.
fn ring(p: &mut Program) -> String {
    let points: Vec<String> = (0..9)
        .map(|k| {
            let (r, z) = (p.number(0.85, 1.15), p.number(-0.1, 0.1));
            let angle = f64::from(k) * std::f64::consts::TAU / 9.0;
            let (x, y) = (angle.cos(), angle.sin());
            p.object("AbsPoint", &format!("{r}*w*{x:?}, {r}*{y:?}, {z}"))
        })
        .collect();
    points.join(", ")
}

/// The arguments of a network of two curves that cross in their second points.
fn net(p: &mut Program) -> String {
    let along = row(p, 6, 0.0);
    let shared = along.split(", ").nth(1).expect("a row of six").to_string();
    let across = row(p, 5, 1.0);
    let (first, rest) = across.split_once(", ").expect("a row of five");
    let tolerance = p.number(0.02, 0.2);
    format!("{{{{{along}}}, {{{first}, {shared}, {rest}}}}}, {tolerance}")
}
