//! Snakes.

use crate::laws::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let t = p.number(0.05, 0.3);
    Some(match kind {
        "LineSnake" => {
            let surface = p.surface();
            format!("{}, {}", p.magnet(&surface), p.magnet(&surface))
        }
        "BSnake" => {
            let surface = p.surface();
            let magnets: Vec<_> = (0..4).map(|_| p.magnet(&surface)).collect();
            format!("{{{}}}, degree = 3", magnets.join(", "))
        }
        "ArcSnake" => {
            let surface = p.surface();
            let [a, b, c] = std::array::from_fn(|_| p.magnet(&surface));
            format!("{a}, {b}, {c}, type = {}", p.random.pick(&[1, 2, 5]))
        }
        "CSnake" => {
            let surface = p.surface();
            let magnets: Vec<_> = (0..4).map(|_| p.magnet(&surface)).collect();
            format!("{{{}}}, ends = \"natural\"", magnets.join(", "))
        }
        "NURBSnake" => {
            let surface = p.surface();
            let magnets: Vec<_> = (0..3).map(|_| p.magnet(&surface)).collect();
            format!("{{{}}}, 2, weights = {{1, w, 0.7}}", magnets.join(", "))
        }
        "ConicSnake" => {
            let surface = p.surface();
            let at = |u: f64, v: f64| format!("{surface}, {u}, {v}");
            let [a, b, c] = [at(0.5, 0.5), at(0.7, 0.45), at(0.55, 0.8)]
                .map(|place| p.object("AbsMagnet", &place));
            format!("{a}, {b}, {c}, {t}, 2*w")
        }
        "RelSnake" => {
            let surface = p.surface();
            format!("{}, {}, {}", p.snake(&surface), p.magnet(&surface), p.magnet(&surface))
        }
        "CopySnake" => {
            let surface = p.surface();
            format!("{}, {}", p.snake(&surface), p.surface())
        }
        "BSubSnake" => {
            let surface = p.surface();
            let snake = p.snake(&surface);
            let at = [p.number(0.1, 0.3), p.number(0.35, 0.5), p.number(0.6, 0.9)];
            let rings = at.map(|t| p.object("AbsRing", &format!("{snake}, {t}")));
            format!("{{{}}}, degree = 2", rings.join(", "))
        }
        "FoilSnake" => {
            let surface = p.surface();
            let mut at = |u: f64, v: f64| {
                let (u, v) = (p.number(u - 0.1, u + 0.1), p.number(v - 0.1, v + 0.1));
                p.object("AbsMagnet", &format!("{surface}, {u}, {v}"))
            };
            let (t, u, n, d) = (at(0.8, 0.5), at(0.4, 0.7), at(0.2, 0.5), at(0.4, 0.4));
            let metric = p.random.pick(&["", ", offset = \"normal\", metric = {2*w, 0.3, 1}"]);
            format!("{{{t}, {u}, {n}, {d}, {t}}}, \"66tmb\"{metric}")
        }
        "PolySnake" => {
            let surface = p.surface();
            let [a, b, c] = std::array::from_fn(|_| p.magnet(&surface));
            let first = p.object("LineSnake", &format!("{a}, {b}"));
            let last = p.object("LineSnake", &format!("{b}, {c}"));
            format!("{{{first}, {last}}}")
        }
        "GeoSnake" => {
            let sheet = p.sheet();
            format!("{}, {}", p.magnet(&sheet), p.magnet(&sheet))
        }
        "ContactSnake" => {
            let floor = super::surfaces::flat_patch(p, 0.0);
            let wall = super::surfaces::wall(p);
            let fillet = match p.random.below(2) {
                0 => p.object("RollFillet", &format!("{floor}, {wall}, 0.3*w, side2 = 1")),
                _ => {
                    let low = p.object("UVSnake", &format!("{floor}, \"v\", 0.3*w"));
                    let high = p.object("UVSnake", &format!("{wall}, \"v\", 0.6*w"));
                    p.object("FilletSurf", &format!("{low}, {high}"))
                }
            };
            format!("{fillet}, {}", 1 + p.random.below(2))
        }
        "IntSnake" => {
            let sheet = p.sheet();
            let way = p.random.below(4);
            match way {
                0 => {
                    let at = p.number(1.0, 3.0);
                    let plane = p.object("XPlane", &format!("{at}*w"));
                    format!("{sheet}, {plane}")
                }
                // The wall ends beyond the sheet: where both end at once the snake's end has a kink.
                _ => {
                    let [a, b, c, d] =
                        [(1.3, -0.4, -1), (1.6, 2.4, -1), (2.2, -0.4, 1), (1.9, 2.4, 1)]
                            .map(|(x, y, z)| p.object("AbsPoint", &format!("{x}*w, {y}, {z}")));
                    let (l, m) = (
                        p.object("Line", &format!("{a}, {b}")),
                        p.object("Line", &format!("{c}, {d}")),
                    );
                    let wall = p.object("RuledSurf", &format!("{l}, {m}, visible = 0"));
                    match way {
                        1 => format!("{sheet}, {wall}"),
                        2 => format!("{wall}, {sheet}"),
                        _ => {
                            let x = p.object("Intersection", &format!("{sheet}, {wall}"));
                            format!("{wall}, {x}")
                        }
                    }
                }
            }
        }
        "ProjSnake" => {
            let (sheet, strand) = (p.sheet(), p.strand());
            match p.random.below(3) {
                0 => format!("{strand}, {sheet}"),
                1 => format!("{strand}, {sheet}, \"z=0\""),
                _ => format!("{strand}, {sheet}, {{2*w, 1, 7}}"),
            }
        }
        "EdgeSnake" => format!("{}, {}", 1 + p.random.below(4), p.surface()),
        "UVSnake" => format!("{}, \"{}\", {t}", p.surface(), p.random.pick(&["u", "v"])),
        "SubSnake" => {
            let surface = p.surface();
            let snake = p.snake(&surface);
            format!("{}, {}", p.ring(&snake), p.ring(&snake))
        }
        "FairSnake" => {
            let surface = p.surface();
            let magnets: Vec<String> = (0..6)
                .map(|k| {
                    let (du, dv) = (p.number(-0.04, 0.04), p.number(-0.08, 0.08));
                    let u = 0.1 + 0.15 * f64::from(k);
                    p.object("AbsMagnet", &format!("{surface}, {u} + {du}, 0.5 + {dv}"))
                })
                .collect();
            format!("{{{}}}, {}", magnets.join(", "), p.number(0.01, 0.05))
        }
        _ => return None,
    })
}
