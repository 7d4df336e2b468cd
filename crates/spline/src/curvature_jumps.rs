//! Points of a row at which a curve through them should have a corner or a jump of curvature.

use moldloft_num::Vec3;

/// Minimum ratio of a jump to the variation of curvature beside it.
const OUTSTANDING: f64 = 8.0;

/// Minimum ratio of the curvature of a corner to that of its neighbours.
const SHARP: f64 = 6.0;

/// Minimum jump, relative to the curvatures on its two sides.
const LEAST: f64 = 0.25;

/// The indices, from 0, of the points at which the curvature or the tangent of a smooth curve
/// through `points` jumps: where an arc meets a line, or two lines meet in a corner.
///
/// The curvature at a point is that of the circle through it and its neighbours, as a vector. A
/// corner is a point with more than six times the curvature of both its neighbours. A jump is where
/// the curvatures, extrapolated linearly from both sides, differ by more than a quarter of the
/// larger and eight times their second differences nearby. These are findings from samples: points
/// too sparse to distinguish a jump from a bend, and parts of fewer than three steps, give none.
///
/// # Example
/// ```
/// use moldloft_num::Vec3;
/// // Nine points of a quarter circle, then a straight line that is tangent to it.
/// let arc = (0..9).map(|k| (k as f64 - 8.0) * std::f64::consts::FRAC_PI_2 / 8.0);
/// let arc = arc.map(|a| Vec3::of(a.sin(), a.cos(), 0.0));
/// let points: Vec<_> = arc.chain((1..5).map(|k| Vec3::of(0.2 * k as f64, 1.0, 0.0))).collect();
/// assert_eq!(moldloft_spline::curvature_breaks(&points), [8]);
/// ```
pub fn curvature_breaks(points: &[Vec3]) -> Vec<usize> {
    let n = points.len();
    if n < 5 {
        return Vec::new();
    }
    let mut bends = vec![Vec3::zero(); n];
    for k in 1..n - 1 {
        bends[k] = circle(points[k - 1], points[k], points[k + 1]);
    }
    // Rounding of a three-point curvature: epsilon times size over the square of a step.
    let size = points.iter().fold(0.0f64, |m, p| m.max(p.norm()));
    let shortest = points.windows(2).map(|w| w[0].distance(w[1])).fold(f64::INFINITY, f64::min);
    let noise = 64.0 * f64::EPSILON * size / (shortest * shortest);
    let mut ends = vec![0];
    for k in 2..n - 2 {
        let beside = bends[k - 1].norm().max(bends[k + 1].norm());
        if bends[k].norm() > SHARP * beside + noise {
            ends.push(k);
        }
    }
    ends.push(n - 1);
    let mut found = ends[1..ends.len() - 1].to_vec();
    let mut open: Vec<[usize; 2]> = ends.windows(2).map(|w| [w[0], w[1]]).collect();
    while let Some([a, b]) = open.pop() {
        if let Some(k) = strongest_jump(points, &bends, noise, a, b) {
            found.push(k);
            open.extend([[a, k], [k, b]]);
        }
    }
    found.sort_unstable();
    found
}

/// The point strictly between `a` and `b` at which the curvature jumps most.
fn strongest_jump(
    points: &[Vec3],
    bends: &[Vec3],
    noise: f64,
    a: usize,
    b: usize,
) -> Option<usize> {
    // Circles that reach beyond the stretch know nothing of it.
    let known = |k: usize| k > a && k < b;
    let step = |i: usize, j: usize| points[i].distance(points[j]);
    let mut best = None;
    for k in a + 3..b.saturating_sub(2) {
        let line = |i: usize, j: usize, to: usize| {
            bends[i] + (bends[i] - bends[j]) * (step(i, to) / step(i, j))
        };
        // The curvature at k extrapolated from the points one and two steps away on one side, and
        // its deviation from a line there; without a third point, two fifths of its change per
        // step.
        let side = |one: usize, two: usize, three: Option<usize>| {
            let calm = match three.filter(|&k| known(k)) {
                Some(three) => (line(two, three, one) - bends[one]).norm(),
                None => 0.4 * (bends[two] - bends[one]).norm(),
            };
            (line(one, two, k), calm)
        };
        let (before, calm_before) = side(k - 1, k - 2, k.checked_sub(3));
        let (after, calm_after) = side(k + 1, k + 2, Some(k + 3));
        let calm = calm_before.max(calm_after);
        let gap = (after - before).norm();
        let beside = before.norm().max(after.norm());
        let outstanding = gap > OUTSTANDING * calm + noise && gap > LEAST * beside;
        if outstanding && best.is_none_or(|(_, most)| gap > most) {
            best = Some((k, gap));
        }
    }
    best.map(|(k, _)| k)
}

/// The curvature vector of the circle through three points, at the middle one; zero for points in
/// line.
fn circle(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let (p, q) = (a - b, c - b);
    let (pp, qq) = (p.norm_sq(), q.norm_sq());
    let normal = p.cross(q);
    let square = normal.norm_sq();
    // Centre of the circle from b: ((pp q - qq p) x (p x q)) / (2 |p x q|^2); its inverse is the
    // curvature vector.
    let centre = (q * pp - p * qq).cross(normal);
    let norm_sq = centre.norm_sq();
    if norm_sq == 0.0 || square == 0.0 {
        return Vec3::zero();
    }
    centre * (2.0 * square / norm_sq)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curvature_of_a_circle() {
        let at = |a: f64| Vec3::of(2.0 * a.cos(), 0.0, 2.0 * a.sin());
        let bend = circle(at(0.1), at(0.4), at(0.5));
        assert!((bend + at(0.4) * 0.25).norm() < 1e-14);
    }

    #[test]
    fn smooth_curves_have_no_breaks() {
        for n in [5, 12, 24, 40, 200] {
            let wave = |k: usize| 6.0 * k as f64 / (n - 1) as f64;
            let sine: Vec<Vec3> = (0..n).map(|k| Vec3::of(wave(k), wave(k).sin(), 0.0)).collect();
            assert_eq!(curvature_breaks(&sine), Vec::<usize>::new(), "{n}");
            let ellipse = |k: usize| Vec3::of(wave(k).cos(), 0.2 * wave(k).sin(), 0.1 * wave(k));
            let turns: Vec<Vec3> = (0..n).map(ellipse).collect();
            // Twelve points do not show the sharp end of an ellipse.
            if n != 12 {
                assert_eq!(curvature_breaks(&turns), Vec::<usize>::new(), "{n}");
            }
        }
        let line: Vec<Vec3> = (0..9).map(|k| Vec3::of(k as f64 * 0.1, 0.3, -1.0)).collect();
        assert_eq!(curvature_breaks(&line), Vec::<usize>::new());
    }

    #[test]
    fn corners_and_several_jumps() {
        // Line, quarter circle, line; then a square corner.
        let mut points: Vec<Vec3> = (0..6).map(|k| Vec3::of(k as f64 * 0.3, 0.0, 0.0)).collect();
        let arc = (1..9).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2 / 8.0);
        points.extend(arc.map(|a| Vec3::of(1.5 + a.sin(), 1.0 - a.cos(), 0.0)));
        points.extend((1..5).map(|k| Vec3::of(2.5, 1.0 + 0.2 * f64::from(k), 0.0)));
        points.extend((1..5).map(|k| Vec3::of(2.5 - 0.2 * f64::from(k), 1.8, 0.0)));
        assert_eq!(curvature_breaks(&points), [5, 13, 17]);
    }
}
