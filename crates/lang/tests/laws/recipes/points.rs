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
