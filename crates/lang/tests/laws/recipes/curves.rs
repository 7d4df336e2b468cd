//! Curves.

use crate::program::Program;

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
        "SubCurve" => {
            let curve = p.curve();
            format!("{}, {}", p.bead(&curve), p.bead(&curve))
        }
        "MirrCurve" => format!("{}, {}", p.curve(), p.mirror()),
        _ => return None,
    })
}
