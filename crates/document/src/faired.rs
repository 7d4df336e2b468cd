//! Faired objects whose tolerance is smaller than the noise of their points, and points that do not fit their
//! neighbours: remarks by the figures that fairing leaves.

use moldloft_model::Object;
use moldloft_registry::Scalar;

/// The ids of these remarks.
pub const IDS: [&str; 2] = ["unlike-neighbours", "at-its-tolerance"];

/// Squared residuals of the fairest, over those of noise that fills the tolerance, from which on it is at its
/// tolerances nearly everywhere: 3 is everywhere. On six known shapes under noise of the size of the tolerance it
/// has 2.6 at most, and of five times the tolerance 2.6 on the average.
const EVERYWHERE: f64 = 2.6;

/// What is remarkable about a faired object: id, message, advice.
pub fn remark<T: Scalar>(object: &Object<T>) -> Option<(&'static str, &'static str, &'static str)> {
    let figures = object.value()?.figures();
    let of = |name: &str| figures.iter().find(|f| f.0 == name).map_or(0.0, |f| f.1);
    if of("findings") > 0.0 {
        return Some((
            "unlike-neighbours",
            "points do not fit their neighbours: wrong digits, or breaks that are meant",
            "`moldloft fair` finds them in a file of the points; what is meant belongs in `breaks`",
        ));
    }
    (of("fairest_used") >= EVERYWHERE).then_some((
        "at-its-tolerance",
        "the fairest result is at its tolerance nearly everywhere: the noise of the points is larger",
        "take the noise for the tolerance, or look for wrong points",
    ))
}
