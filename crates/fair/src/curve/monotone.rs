//! Pattern of rising and falling curvature with few monotone pieces.

use crate::Space;
use crate::interrogate::shape;
use moldloft_num::Vec3;

/// The spans on which the curvature should rise (true) or fall in the best split into `count`
/// monotone runs: that with the least variation against them. The span in which it turns is left
/// out.
pub(crate) fn runs_of(
    space: &Space,
    control: &[Vec3<f64>],
    normal: Vec3<f64>,
    count: usize,
) -> Vec<(isize, bool)> {
    let spans: Vec<isize> = space.spans().collect();
    let each = 8;
    // Variation up and down on each span, and at the knot before it.
    let mut last: Option<f64> = None;
    let mut against = Vec::with_capacity(spans.len());
    for &k in &spans {
        let (a, b) = (space.knot(k), space.knot(k + 1));
        let (mut up, mut down) = (0.0, 0.0);
        for i in 0..=each {
            let t = a + (b - a) * f64::from(i) / f64::from(each);
            let value = shape::sample_in(space, control, None, k, t).signed_curvature(normal);
            if let Some(before) = last {
                up += (value - before).max(0.0);
                down += (before - value).max(0.0);
            }
            last = Some(value);
        }
        against.push([up, down]);
    }
    // cost[run][direction] up to each span; direction 0 falls, 1 rises.
    let n = spans.len();
    let count = count.min(n);
    let none = (f64::INFINITY, false);
    let mut table = vec![vec![[none; 2]; count]; n];
    for i in 0..n {
        for run in 0..count {
            for d in 0..2 {
                let own = against[i][d];
                table[i][run][d] = if i == 0 {
                    if run == 0 { (own, false) } else { none }
                } else {
                    let stay = table[i - 1][run][d].0;
                    let turn = if run > 0 { table[i - 1][run - 1][1 - d].0 } else { f64::INFINITY };
                    // The span of a turn may do as it likes.
                    if turn < stay + own { (turn, true) } else { (stay + own, false) }
                };
            }
        }
    }
    let mut at = (0, 0);
    for run in 0..count {
        for d in 0..2 {
            if table[n - 1][run][d].0 < table[n - 1][at.0][at.1].0 {
                at = (run, d);
            }
        }
    }
    let mut out = Vec::new();
    for i in (0..n).rev() {
        let (_, turned) = table[i][at.0][at.1];
        if turned {
            at = (at.0 - 1, 1 - at.1);
        } else {
            out.push((spans[i], at.1 == 1));
        }
    }
    out.reverse();
    out
}
