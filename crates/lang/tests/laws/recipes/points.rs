//! Points, beads, magnets and rings.

use crate::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let [x, y, z] = p.coordinates();
    let t = p.number(0.05, 0.3);
    Some(match kind {
        "AbsPoint" => format!("{x}, {y}*w, {z}"),
        "RelPoint" => format!("{}, {x}, {y}, {z}", p.point()),
        "MirrPoint" | "ProjPoint" => format!("{}, {}", p.point(), p.mirror()),
        "FramePoint" => {
            let frame = p.frame();
            format!("{}, {frame}, {x}, {y}*w, {z}, type = {}", p.point(), p.random.below(3))
        }
        "PolarPoint" => format!("{}, {}, {x}, {y}*w, {z}", p.point(), p.frame()),
        "OffsetPoint" => {
            let surface = p.surface();
            format!("{}, {x}*w", p.magnet(&surface))
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
