//! The point of a triangle that is nearest to another point.

use crate::Vec3;

/// Weights of the point of a triangle nearest to `p`, and its feature: corners 0 to 2, edges 3 to 5
/// from these, or 6 for the inside (Ericson, Real-Time Collision Detection, 5.1.5).
pub fn triangle_foot(p: Vec3, [a, b, c]: [Vec3; 3]) -> ([f64; 3], usize) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ([1.0, 0.0, 0.0], 0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return ([0.0, 1.0, 0.0], 1);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return ([1.0 - v, v, 0.0], 3);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return ([0.0, 0.0, 1.0], 2);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return ([1.0 - w, 0.0, w], 5);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return ([0.0, 1.0 - w, w], 4);
    }
    let all = va + vb + vc;
    if all == 0.0 {
        return ([1.0, 0.0, 0.0], 0);
    }
    ([va / all, vb / all, vc / all], 6)
}

/// The point of a triangle nearest to `p`.
pub fn nearest_on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let ([_, v, w], _) = triangle_foot(p, [a, b, c]);
    a + (b - a) * v + (c - a) * w
}
