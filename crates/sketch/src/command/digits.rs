//! Numbers in replies.

use moldloft_num::Vec3;
use moldloft_syntax::number::plain;

/// Three significant digits, the accuracy of a picture.
pub(super) fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 0.0;
    }
    format!("{x:.2e}").parse().unwrap_or(x)
}

pub(super) fn place_text(p: Vec3) -> String {
    p.to_array().map(|x| plain(rounded(x))).join(" ")
}
