//! Planes, frames, contours, relabels and everything else.

use crate::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let [x, y, _] = p.coordinates();
    Some(match kind {
        "Model" => "symmetry = \"\"".to_string(),
        "XPlane" | "YPlane" | "ZPlane" => x,
        "OffsetPlane" => format!("{}, {x}", p.random.pick(&p.planes)),
        "ThreePointPlane" => p.points::<3>().join(", "),
        "TwoPointPlane" => p.points::<2>().join(", "),
        "XContours" | "YContours" | "ZContours" => format!("0, 3, {x}, {y}"),
        _ => return None,
    })
}
