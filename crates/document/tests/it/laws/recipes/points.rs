//! Points, beads, magnets and rings.

use crate::laws::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let [x, y, z] = p.coordinates();
    let t = p.number(0.05, 0.3);
    Some(match kind {
        "AbsPoint" => format!("{x}, {y}*w, {z}"),
        "RelPoint" => format!("{}, {x}, {y}, {z}", p.point()),
        "FramePoint" => {
            let frame = p.frame();
            format!("{}, {frame}, {x}, {y}*w, {z}, type = {}", p.point(), p.random.below(3))
        }
        "PolarPoint" => format!("{}, {}, {x}, {y}*w, {z}", p.point(), p.frame()),
        "OffsetPoint" => {
            let surface = p.surface();
            format!("{}, {x}*w", p.magnet(&surface))
        }
        "TabPoint" => {
            let [x, y, z] = p.coordinates();
            format!("row = 2, points = {{{{0, 0, {x}}}, {{{y}*w, 1, {z}}}}}")
        }
        "TanPoint" => {
            let curve = p.curve();
            format!("{}, {x}*w", p.bead(&curve))
        }
        "RotatPoint" => {
            let [a, b] = p.points();
            let line = p.object("Line", &format!("{a}, {b}"));
            format!("{}, {line}, {x}*w", p.point())
        }
        "CopyPoint" => {
            let [a, b] = p.points();
            format!("{}, {a}, {b}, {x}, w, {z}", p.point())
        }
        "BlendPoint" => format!("{{{}}}, {{{x}, w, {z}}}", p.points::<3>().join(", ")),
        "CentroidPoint" => match p.random.below(3) {
            0 => format!("{{{}}}", p.points::<3>().join(", ")),
            1 => format!("{{{}}}", p.curves::<2>().join(", ")),
            _ => format!("{{{}}}", p.surface()),
        },
        "IntPoint" => {
            let sheet = p.sheet();
            let (a, b) = (p.number(1.0, 3.0), p.number(0.4, 1.6));
            let along = p.object("YPlane", &format!("{b}*w"));
            match p.random.below(2) {
                0 => format!("{sheet}, {}, {along}", p.object("XPlane", &format!("{a}*w"))),
                _ => {
                    let [c, d, e, f] =
                        [(1.3, 0.0, -1), (1.6, 3.0, -1), (2.2, 0.0, 1), (1.9, 3.0, 1)]
                            .map(|(x, y, z)| p.object("AbsPoint", &format!("{x}*w, {y}, {z}")));
                    let (l, m) = (
                        p.object("Line", &format!("{c}, {d}")),
                        p.object("Line", &format!("{e}, {f}")),
                    );
                    let wall = p.object("RuledSurf", &format!("{l}, {m}, visible = 0"));
                    format!("{wall}, {along}, {sheet}")
                }
            }
        }
        "ArcLenBead" => {
            let curve = p.curve();
            format!("{}, 0.01*w", p.bead(&curve))
        }
        "CopyBead" => {
            let curve = p.curve();
            format!("{}, {}", p.bead(&curve), p.curve())
        }
        "CopyMagnet" => {
            let surface = p.surface();
            format!("{}, {}", p.magnet(&surface), p.surface())
        }
        "ArcLenRing" => {
            let surface = p.surface();
            let snake = p.snake(&surface);
            format!("{}, -0.01*w", p.ring(&snake))
        }
        "CopyRing" => {
            let (surface, other) = (p.surface(), p.surface());
            let (snake, to) = (p.snake(&surface), p.snake(&other));
            format!("{}, {to}", p.ring(&snake))
        }
        "MirrPoint" => format!("{}, {}", p.point(), p.mirror()),
        "ProjPoint" => match p.random.below(2) {
            0 => {
                let mirror = p.mirror();
                // A magnet or a bead would stand for its surface or curve.
                if mirror.starts_with('o') {
                    format!("{}, {{{x}, {y}, w}}", p.point())
                } else {
                    format!("{}, {mirror}", p.point())
                }
            }
            _ => {
                let (sheet, strand) = (p.sheet(), p.strand());
                format!("{strand}(0.3), {sheet}")
            }
        },
        "IntBead" | "XYZBead" | "ProjBead" | "ProxBead" => {
            let strand = p.strand();
            let bead = p.object("AbsBead", &format!("{strand}, 0.4"));
            let value = p.number(1.2, 1.8);
            match (kind, p.random.below(3)) {
                ("IntBead", 0) => {
                    let sheet = p.sheet();
                    let (a, b) = (
                        p.object("AbsPoint", "1.1*w, 0.9, 3"),
                        p.object("AbsPoint", "2*w, 1.2, -3"),
                    );
                    let line = p.object("Line", &format!("{a}, {b}"));
                    format!("{line}, {sheet}")
                }
                ("IntBead", 1) => format!("{strand}, \"x=0\", {{{value}*w, 1, 1}}"),
                ("IntBead", _) => {
                    let plane = p.object("XPlane", &format!("{value}*w"));
                    format!("{bead}, {plane}")
                }
                ("XYZBead", _) => format!("{bead}, \"x\", {value}*w"),
                (_, 0) => format!("{strand}, {{{value}*w, 0.7, 4}}"),
                _ => format!("{bead}, {{{value}*w, 0.7, 4}}"),
            }
        }
        "IntRing" | "XYZRing" | "ProjRing" | "ProxRing" => {
            let sheet = p.sheet();
            let held = p.number(0.3, 0.7);
            let snake = p.object("UVSnake", &format!("{sheet}, \"u\", {held}"));
            let ring = p.object("AbsRing", &format!("{snake}, 0.4"));
            let value = p.number(1.2, 1.8);
            match kind {
                "IntRing" => {
                    let plane = p.object("XPlane", &format!("{value}*w"));
                    format!("{ring}, {plane}")
                }
                "XYZRing" => format!("{snake}, \"x\", {value}*w"),
                "ProjRing" => format!("{ring}, {{{value}*w, 0.7, 2}}"),
                _ => format!("{snake}, {{{value}*w, 0.7, 2}}"),
            }
        }
        "ProjMagnet" | "ProxMagnet" | "IntMagnet" | "XYZMagnet" | "TanMagnet" => {
            let sheet = p.sheet();
            let (u, v) = (p.number(1.0, 2.5), p.number(0.6, 1.4));
            let above = p.object("AbsPoint", &format!("{u}*w, {v}, 1.5"));
            let magnet = p.object("AbsMagnet", &format!("{sheet}, 0.4, 0.45"));
            match (kind, p.random.below(3)) {
                ("ProjMagnet", 0) => format!("{above}, {magnet}"),
                ("ProjMagnet", 1) => format!("{above}, {sheet}, \"z=0\""),
                ("ProjMagnet", _) => format!("{above}, {magnet}, {{2*w, 1, 5}}"),
                ("ProxMagnet", _) => format!("{above}, {sheet}"),
                ("IntMagnet", _) => {
                    let below = p.object("AbsPoint", "2*w, 1, -3");
                    let line = p.object("Line", &format!("{above}, {below}"));
                    format!("{line}, {magnet}")
                }
                ("XYZMagnet", _) => format!("{sheet}, \"x\", {u}*w, \"y\", {v}"),
                _ => format!("{magnet}, 0.2*w, -{t}"),
            }
        }
        "BoxMagnet" | "BoxRing" => {
            let surface = p.surface();
            let mut at = |u: f64, v: f64| {
                let (u, v) = (p.number(u - 0.02, u + 0.02), p.number(v - 0.02, v + 0.02));
                p.object("AbsMagnet", &format!("{surface}, {u}, {v}"))
            };
            let [a, b, c] = [at(0.5, 0.5), at(0.7, 0.45), at(0.55, 0.7)];
            let ring = p.object("ConicSnake", &format!("{a}, {b}, {c}"));
            format!("{ring}, {}, margin = 0.5*w", 1 + p.random.below(4))
        }
        "AbsBead" => format!("{}, {t}", p.curve()),
        "RelBead" => {
            let curve = p.curve();
            format!("{}, {t}", p.bead(&curve))
        }
        "AbsMagnet" => format!("{}, {t}, 0.{}", p.surface(), 1 + p.random.below(9)),
        "RelMagnet" => {
            let surface = p.surface();
            format!("{}, {t}, -0.125", p.magnet(&surface))
        }
        "AbsRing" => {
            let surface = p.surface();
            format!("{}, {t}", p.snake(&surface))
        }
        "RelRing" => {
            let surface = p.surface();
            let snake = p.snake(&surface);
            format!("{}, {t}", p.ring(&snake))
        }
        _ => return None,
    })
}
