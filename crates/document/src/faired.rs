//! Warnings about faired objects whose tolerance is smaller than the noise of their points, and
//! about outliers, from the results of fairing.

use moldloft_model::Object;
use moldloft_registry::Scalar;

/// Ids of these warnings.
pub const IDS: [&str; 2] = ["unlike-neighbours", "at-its-tolerance"];

/// Ratio of the squared residuals of the fairest shape to those of noise that fills the tolerance,
/// above which the shape is at its tolerances nearly everywhere; 3 means everywhere. Measured on
/// six known shapes: at most 2.6 with noise of the size of the tolerance, 2.6 on average with five
/// times as much.
const EVERYWHERE: f64 = 2.6;

/// Warning about a faired object: id, message, advice.
pub fn remark<T: Scalar>(object: &Object<T>) -> Option<(&'static str, &'static str, &'static str)> {
    let figures = object.value()?.figures();
    let of = |name: &str| figures.iter().find(|f| f.0 == name).map_or(0.0, |f| f.1);
    if of("findings") > 0.0 {
        return Some((
            "unlike-neighbours",
            "points do not fit their neighbours: wrong digits, or intended breaks",
            "`moldloft fair` finds them in a file of the points; intended ones belong in `breaks`",
        ));
    }
    (of("fairest_used") >= EVERYWHERE).then_some((
        "at-its-tolerance",
        "the fairest result is at its tolerance nearly everywhere: the noise of the points is larger",
        "set the tolerance to the noise, or look for wrong points",
    ))
}
