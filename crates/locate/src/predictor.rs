//! Prediction of a branch from its last three stations.

use crate::march::{TracePoint, Unknowns};
use moldloft_num::Vec3;

/// Unknowns and position of a branch at a length along it, side by side.
type Row = [f64; 8];

fn values(s: &TracePoint) -> Row {
    let ([a, b, c, d], x) = (s.q, s.x);
    [a, b, c, d, x.x, x.y, x.z, 0.0]
}

fn rates(s: &TracePoint, sign: f64) -> Row {
    let ([a, b, c, d], x) = (s.rate, s.tangent);
    [a, b, c, d, x.x, x.y, x.z, 0.0].map(|rate| rate * sign)
}

/// (a - b) by a number.
#[inline(always)]
fn slope(a: &Row, b: &Row, by: f64) -> Row {
    let mut out = [0.0; 8];
    for k in 0..8 {
        out[k] = (a[k] - b[k]) * by;
    }
    out
}

#[inline(always)]
fn plus(a: &Row, b: &Row, by: f64) -> Row {
    let mut out = [0.0; 8];
    for k in 0..8 {
        out[k] = a[k] + b[k] * by;
    }
    out
}

/// Ratio of an arc to its chord, for a turn by an angle whose chord is `turn`: w / (2 sin w/2), by
/// its series.
#[inline(always)]
fn bulge(turn: f64) -> f64 {
    let square = turn * turn;
    1.0 + square * (1.0 / 24.0 + square * (3.0 / 640.0))
}

/// The unknowns at the end of a step along the last station's tangent, in the normal plane: by the
/// polynomial of degree 5 in the length through three stations and their tangents, in Newton's
/// form. Its error is of the sixth order in the step, so that two evaluations suffice instead of
/// three from a cubic prediction.
#[inline(always)]
pub(crate) fn predict([a, b, c]: [&TracePoint; 3], step: f64, sign: f64) -> Unknowns {
    let turn = b.tangent.distance(c.tangent);
    let chord = b.x.distance(c.x);
    let near = chord * bulge(turn);
    let far = a.x.distance(b.x) * bulge(a.tangent.distance(b.tangent));
    let whole = near + far;
    let (by_near, by_far, by_whole) = (1.0 / near, 1.0 / far, 1.0 / whole);
    // Divided differences over the nodes c, c, b, b, a, a.
    let [fa, fb, fc] = [values(a), values(b), values(c)];
    let [ga, gb, gc] = [rates(a, sign), rates(b, sign), rates(c, sign)];
    let (cb, ba) = (slope(&fc, &fb, by_near), slope(&fb, &fa, by_far));
    let (ccb, cbb) = (slope(&gc, &cb, by_near), slope(&cb, &gb, by_near));
    let (bba, baa) = (slope(&gb, &ba, by_far), slope(&ba, &ga, by_far));
    let ccbb = slope(&ccb, &cbb, by_near);
    let cbba = slope(&cbb, &bba, by_whole);
    let bbaa = slope(&bba, &baa, by_far);
    let ccbba = slope(&ccbb, &cbba, by_whole);
    let cbbaa = slope(&cbba, &bbaa, by_whole);
    let last = slope(&ccbba, &cbbaa, by_whole);
    // The length at which a circle with the last curvature is that far along the tangent: r asin(step
    // / r), by its series.
    let bent = (step * turn / chord).min(0.5);
    let square = bent * bent;
    let s = step * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)));
    // Value and derivative by Horner's rule.
    let (to_b, to_a) = (s + near, s + whole);
    let m = plus(&ccbba, &last, to_a);
    let k = plus(&ccbb, &m, to_b);
    let by_k = plus(&m, &last, to_b);
    let j = plus(&ccb, &k, to_b);
    let by_j = plus(&k, &by_k, to_b);
    let value = plus(&fc, &plus(&gc, &j, s), s);
    let rate = plus(&gc, &plus(&slope(&j, &[0.0; 8], 2.0), &by_j, s), s);
    // To the plane across, by the remaining length.
    let place = |row: &Row| Vec3 { x: row[4], y: row[5], z: row[6] };
    let tangent = c.tangent * sign;
    let left = step - (place(&value) - c.x).dot(tangent);
    let rest = (left / place(&rate).dot(tangent)).clamp(-0.1 * step, 0.1 * step);
    let at = plus(&value, &rate, rest);
    [at[0], at[1], at[2], at[3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A station of a helix of radius 1, with its length for the first unknown.
    fn station(s: f64, pitch: f64) -> TracePoint {
        let speed = 1.0_f64.hypot(pitch);
        let a = s / speed;
        let tangent = Vec3::of(-a.sin(), a.cos(), pitch) / speed;
        TracePoint {
            q: [s, a.cos(), a.sin(), pitch * a],
            rate: [1.0, tangent.x, tangent.y, tangent.z],
            x: Vec3::of(a.cos(), a.sin(), pitch * a),
            tangent,
        }
    }

    /// The error decreases with the sixth power of the step, and the prediction is in the normal
    /// plane.
    #[test]
    fn the_outlook_is_of_the_sixth_order() {
        for sign in [1.0, -1.0] {
            let off = |step: f64| {
                let at = [-1.9, -0.8, 0.0].map(|s| station(0.7 + sign * s * step, 0.4));
                let [a, b, c] = &at;
                let seen = predict([a, b, c], step, sign);
                // The helix at the length that was found, which is in the plane across.
                let real = station(seen[0], 0.4);
                let across = (real.x - c.x).dot(c.tangent) * sign - step;
                across.abs().max((seen[1] - real.q[1]).abs()).max((seen[2] - real.q[2]).abs())
            };
            let [wide, narrow] = [0.2, 0.1].map(off);
            assert!(wide < 1e-5 && (40.0..100.0).contains(&(wide / narrow)), "{wide} {narrow}");
        }
    }
}
