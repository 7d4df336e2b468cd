//! Points that are exact: on a line, a conic, a plane cubic or a helix to rounding.
//!
//! These are as fair as a curve can be, for any spacing and parameters; goals that move points only
//! for a gain leave them unchanged.

use moldloft_num::Vec3;

/// Rounding of coordinates, relative to the size.
const ROUNDING: f64 = 1e-12;

/// Number of points beyond those that determine a curve, for a coincidence to be excluded.
const SPARE: usize = 4;

/// Number of spare points of one of many lines, all of which must be exact.
const SPARE_EACH: usize = 1;

/// True if the points are in order on a line, a circle, another conic, a plane cubic or a helix.
pub(crate) fn exact(points: &[Vec3<f64>]) -> bool {
    exact_with(points, SPARE)
}

/// True if the points between breaks are exact: in order on a line, a conic, a plane cubic or a
/// helix to rounding, with more points than determine such a curve.
///
/// # Example
/// ```
/// use moldloft_fair::is_exact;
/// use moldloft_num::Vec3;
/// let at = |x: f64| Vec3::of(x, 0.1 * x * x, 0.0);
/// let mut points: Vec<_> = [0.0, 0.5, 1.0, 2.0, 4.0, 5.0, 7.5, 8.0, 9.0, 9.5].map(at).to_vec();
/// assert!(is_exact(&points, &[], false));
/// points[4].y += 1e-6;
/// assert!(!is_exact(&points, &[], false));
/// ```
pub fn is_exact(points: &[Vec3<f64>], breaks: &[usize], closed: bool) -> bool {
    between_breaks(points, breaks, closed).iter().all(|part| exact(part))
}

/// As `is_exact`, for lines through numbered points, each given by its points and true if closed;
/// `breaks` are numbers of points. A line of coincident points is exact.
pub fn are_exact(points: &[Vec3<f64>], lines: &[(Vec<usize>, bool)], breaks: &[usize]) -> bool {
    all_exact(lines.iter().flat_map(|(own, closed)| {
        let marks: Vec<usize> = (0..own.len()).filter(|&k| breaks.contains(&own[k])).collect();
        let line: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        between_breaks(&line, &marks, *closed)
    }))
}

/// True if all lines of a grid or network are exact; a line of coincident points is.
pub(crate) fn all_exact(lines: impl IntoIterator<Item = Vec<Vec3<f64>>>) -> bool {
    lines
        .into_iter()
        .all(|line| line.iter().all(|p| *p == line[0]) || exact_with(&line, SPARE_EACH))
}

/// The parts of a list between breaks, which belong to both sides; the last part of a closed list
/// extends to the first break.
pub(crate) fn between_breaks<T: Copy>(list: &[T], breaks: &[usize], closed: bool) -> Vec<Vec<T>> {
    let n = list.len();
    let mut inner: Vec<usize> = breaks.iter().copied().filter(|&b| b < n).collect();
    inner.sort_unstable();
    inner.dedup();
    if closed {
        let Some(&first) = inner.first() else { return vec![list.to_vec()] };
        let turned: Vec<T> = (0..=n).map(|k| list[(first + k) % n]).collect();
        let moved: Vec<usize> = inner.iter().map(|b| b - first).collect();
        return between_breaks(&turned, &moved, false);
    }
    let ends = [0].into_iter().chain(inner.into_iter().filter(|&b| 0 < b && b + 1 < n));
    let ends: Vec<usize> = ends.chain([n.saturating_sub(1)]).collect();
    ends.windows(2).map(|w| list[w[0]..=w[1]].to_vec()).collect()
}

/// True if the points are in order on one of these curves, with `spare` points beyond those that
/// determine it.
fn exact_with(points: &[Vec3<f64>], spare: usize) -> bool {
    let n = points.len();
    let finite = points.iter().all(|p| p.is_finite());
    if n < 2 || !finite {
        return false;
    }
    let middle = points.iter().fold(Vec3::zero(), |s, &p| s + p) * (1.0 / n as f64);
    let size = points.iter().map(|p| (*p - middle).norm()).fold(0.0, f64::max);
    if size == 0.0 {
        return false;
    }
    let close = ROUNDING * (1.0 + middle.norm() / size);
    let own: Vec<Vec3<f64>> = points.iter().map(|&p| (p - middle) * (1.0 / size)).collect();
    let Some([a, b, c]) = frame(&own) else { return false };
    if own.iter().all(|p| b.dot(*p).abs() <= close && c.dot(*p).abs() <= close) {
        return own.windows(2).all(|w| (w[1] - w[0]).dot(a) > 0.0)
            || own.windows(2).all(|w| (w[1] - w[0]).dot(a) < 0.0);
    }
    if own.iter().all(|p| c.dot(*p).abs() <= close) {
        let plane: Vec<[f64; 2]> = own.iter().map(|p| [a.dot(*p), b.dot(*p)]).collect();
        return families().iter().any(|terms| algebraic(&plane, terms, close, spare));
    }
    helix(&own, close, spare)
}

/// A sum of monomials x^i y^j.
type Term = Vec<(usize, usize)>;

/// The terms of circles, conics and cubics.
fn families() -> [Vec<Term>; 3] {
    let all = |degree: usize| -> Vec<Term> {
        (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| vec![(i, j)])).collect()
    };
    let circle = vec![vec![(2, 0), (0, 2)], vec![(1, 0)], vec![(0, 1)], vec![(0, 0)]];
    [circle, all(2), all(3)]
}

/// Axes: from the first point to the farthest, across it to the farthest from that line, and across
/// both.
fn frame(points: &[Vec3<f64>]) -> Option<[Vec3<f64>; 3]> {
    let far = |of: &dyn Fn(Vec3<f64>) -> Vec3<f64>| {
        let all = points.iter().map(|&p| of(p - points[0]));
        all.reduce(|a, b| if b.norm_sq() > a.norm_sq() { b } else { a })
    };
    let a = far(&|v| v)?.normalized()?;
    let across = far(&|v| v - a * a.dot(v))?;
    let b = match across.normalized() {
        Some(b) if across.norm() > 1e-9 => (b - a * a.dot(b)).normalized()?,
        _ => a.perpendicular().normalized()?,
    };
    Some([a, b, a.cross(b)])
}

/// True if plane points are in order on an algebraic curve with these terms.
fn algebraic(points: &[[f64; 2]], terms: &[Term], close: f64, spare: usize) -> bool {
    let count = terms.len();
    if points.len() < count - 1 + spare {
        return false;
    }
    let one = |&(i, j): &(usize, usize), [x, y]: [f64; 2]| x.powi(i as i32) * y.powi(j as i32);
    let term = |all: &Term, p: [f64; 2]| all.iter().map(|e| one(e, p)).sum::<f64>();
    let mut rows: Vec<Vec<f64>> =
        points.iter().map(|&p| terms.iter().map(|e| term(e, p)).collect()).collect();
    // Elimination with complete pivoting: the last pivot measures how far the columns are from
    // dependent.
    let mut order: Vec<usize> = (0..count).collect();
    for k in 0..count {
        let (mut best, mut at) = (0.0, (k, k));
        for (r, row) in rows.iter().enumerate().skip(k) {
            for (c, x) in row.iter().enumerate().skip(k) {
                if x.abs() > best {
                    (best, at) = (x.abs(), (r, c));
                }
            }
        }
        if best <= 16.0 * close {
            let fixed = k;
            if fixed + 1 < count {
                // More than one such curve: points of a simpler one.
                return false;
            }
            let mut own = vec![0.0; count];
            own[fixed] = 1.0;
            for r in (0..fixed).rev() {
                let sum: f64 = (r + 1..count).map(|c| rows[r][c] * own[c]).sum();
                own[r] = -sum / rows[r][r];
            }
            let (mut powers, mut curve) = (Vec::new(), Vec::new());
            for (c, &place) in order.iter().enumerate() {
                powers.extend(&terms[place]);
                curve.resize(powers.len(), own[c]);
            }
            return in_order(points, &powers, &curve);
        }
        rows.swap(k, at.0);
        order.swap(k, at.1);
        rows.iter_mut().for_each(|row| row.swap(k, at.1));
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            for (x, p) in row.iter_mut().zip(&pivot).skip(k) {
                *x -= factor * p;
            }
        }
    }
    false
}

/// True if the points follow each other along the curve: its tangent turns in the same direction
/// before and after each chord, except for chords with an inflection. Points that alternate between
/// branches do not.
fn in_order(points: &[[f64; 2]], powers: &[(usize, usize)], curve: &[f64]) -> bool {
    let slope = |[x, y]: [f64; 2]| {
        let part =
            |base: f64, e: usize| if e == 0 { 0.0 } else { e as f64 * base.powi(e as i32 - 1) };
        let both = powers.iter().zip(curve);
        both.fold([0.0; 2], |s, (&(i, j), k)| {
            [s[0] + k * part(x, i) * y.powi(j as i32), s[1] + k * x.powi(i as i32) * part(y, j)]
        })
    };
    let mut breaks = 0;
    for w in points.windows(2) {
        let chord = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let length = libm::hypot(chord[0], chord[1]);
        let turn = |p: [f64; 2]| {
            let g = slope(p);
            let size = libm::hypot(g[0], g[1]) * length;
            // The sine of the angle from the tangent to the chord.
            let tangent = [-g[1], g[0]];
            let (sin, cos) = (
                (tangent[0] * chord[1] - tangent[1] * chord[0]) / size,
                (tangent[0] * chord[0] + tangent[1] * chord[1]) / size,
            );
            sin * cos.signum()
        };
        let (before, after) = (turn(w[0]), -turn(w[1]));
        let fine = before * after >= 0.0 || (before - after).abs() < 1e-6;
        if before.is_nan() || after.is_nan() || before.abs().max(after.abs()) > 0.95 {
            return false;
        }
        breaks += usize::from(!fine);
    }
    breaks <= 3
}

/// True if the points are on a helix: on a circle in the view along its axis, at angles that
/// increase with height.
fn helix(points: &[Vec3<f64>], close: f64, spare: usize) -> bool {
    if points.len() < 6 + spare {
        return false;
    }
    // An axis is across the differences of a helix' second derivatives: those of the circles through
    // neighbours point at it.
    let towards: Vec<Vec3<f64>> = points
        .windows(3)
        .filter_map(|w| {
            let (u, v) = (w[0] - w[1], w[2] - w[1]);
            (u * (1.0 / u.norm()) + v * (1.0 / v.norm())).normalized()
        })
        .collect();
    let crossed = |a: &Vec3<f64>, b: &Vec3<f64>| a.cross(*b);
    let mut axis = Vec3::zero();
    for w in towards.windows(2) {
        let c = crossed(&w[0], &w[1]);
        axis += if axis.dot(c) < 0.0 { -c } else { c };
    }
    let Some(mut axis) = axis.normalized() else { return false };
    // Gauss and Newton on the two angles of the axis.
    let mut last = f64::INFINITY;
    for _ in 0..30 {
        let Some(now) = off_helix(points, axis) else { return false };
        let size = largest(&now);
        if size <= 16.0 * close {
            return true;
        }
        if size > 0.999 * last && last < f64::INFINITY && size < 1e-9 {
            return false;
        }
        last = size;
        let a = axis.perpendicular().normalized().unwrap_or_default();
        let b = axis.cross(a);
        let step = 1e-6;
        let by = [a, b].map(|d| {
            let turned = |s: f64| (axis + d * s).normalized().and_then(|x| off_helix(points, x));
            let (up, down) = (turned(step)?, turned(-step)?);
            Some(up.iter().zip(&down).map(|(p, q)| (p - q) / (2.0 * step)).collect::<Vec<f64>>())
        });
        let [Some(x), Some(y)] = by else { return false };
        let sum = |p: &[f64], q: &[f64]| -> f64 { p.iter().zip(q).map(|(p, q)| p * q).sum() };
        let (xx, xy, yy) = (sum(&x, &x), sum(&x, &y), sum(&y, &y));
        let (xr, yr) = (sum(&x, &now), sum(&y, &now));
        let determinant = xx * yy - xy * xy;
        if determinant.is_nan() || determinant <= 1e-14 * xx * yy {
            return false;
        }
        let (s, t) = ((yy * xr - xy * yr) / determinant, (xx * yr - xy * xr) / determinant);
        let far = libm::hypot(s, t);
        let most = if far > 0.3 { 0.3 / far } else { 1.0 };
        let Some(next) = (axis - (a * s + b * t) * most).normalized() else { return false };
        axis = next;
    }
    false
}

fn largest(all: &[f64]) -> f64 {
    all.iter().fold(0.0, |m: f64, r| m.max(r.abs()))
}

/// Distances of points from the least-squares helix about an axis: radially from its cylinder, and
/// along the circle from its angle.
fn off_helix(points: &[Vec3<f64>], axis: Vec3<f64>) -> Option<Vec<f64>> {
    let a = axis.perpendicular().normalized()?;
    let b = axis.cross(a);
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [a.dot(*p), b.dot(*p)]).collect();
    // The circle of least squares (Kasa 1976).
    let (mut m, mut r) = ([0.0; 9], vec![0.0; 3]);
    for p in &flat {
        let v = [p[0], p[1], 1.0];
        let z = p[0] * p[0] + p[1] * p[1];
        for i in 0..3 {
            r[i] += z * v[i];
            for j in 0..3 {
                m[3 * i + j] += v[i] * v[j];
            }
        }
    }
    moldloft_num::solve_dense(&mut m, &mut r).ok()?;
    let centre = [0.5 * r[0], 0.5 * r[1]];
    let radius = (r[2] + centre[0] * centre[0] + centre[1] * centre[1]).sqrt();
    if !radius.is_finite() {
        return None;
    }
    let heights: Vec<f64> = points.iter().map(|p| axis.dot(*p)).collect();
    let mut angles: Vec<f64> = Vec::with_capacity(flat.len());
    for p in &flat {
        let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
        let angle = libm::atan2(y, x);
        let before = angles.last().copied().unwrap_or(angle);
        let full = std::f64::consts::TAU;
        angles.push(angle - full * ((angle - before) / full).round());
    }
    let n = flat.len() as f64;
    let mean = |all: &[f64]| all.iter().sum::<f64>() / n;
    let (h, t) = (mean(&heights), mean(&angles));
    let both = heights.iter().zip(&angles);
    let (mut hh, mut ht) = (0.0, 0.0);
    for (x, y) in both {
        hh += (x - h) * (x - h);
        ht += (x - h) * (y - t);
    }
    let rate = ht / hh;
    let mut out: Vec<f64> =
        flat.iter().map(|p| libm::hypot(p[0] - centre[0], p[1] - centre[1]) - radius).collect();
    out.extend(heights.iter().zip(&angles).map(|(x, y)| radius * ((y - t) - rate * (x - h))));
    out.iter().all(|r| r.is_finite()).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_share_their_breaks() {
        let list = [0, 1, 2, 3, 4, 5];
        assert_eq!(between_breaks(&list, &[], false), [vec![0, 1, 2, 3, 4, 5]]);
        assert_eq!(between_breaks(&list, &[0, 3, 5], false), [vec![0, 1, 2, 3], vec![3, 4, 5]]);
        assert_eq!(between_breaks(&list, &[], true), [vec![0, 1, 2, 3, 4, 5]]);
        assert_eq!(between_breaks(&list, &[4, 2, 2], true), [vec![2, 3, 4], vec![4, 5, 0, 1, 2]]);
    }

    fn turned(points: &[[f64; 3]]) -> Vec<Vec3<f64>> {
        let a = Vec3::of(0.36, 0.48, 0.8);
        let b = Vec3::of(-0.8, 0.6, 0.0);
        let c = a.cross(b);
        let place = |p: &[f64; 3]| a * p[0] + b * p[1] + c * p[2] + Vec3::of(3.0, -2.0, 1.0);
        points.iter().map(place).collect()
    }

    /// Uneven parameters in [0, 1].
    fn places(n: usize) -> Vec<f64> {
        let mut x = 0.0;
        let all: Vec<f64> = (0..n)
            .map(|k| {
                x += 0.1 + ((k * k * 7919 + 13 * k) % 100) as f64 / 20.0;
                x
            })
            .collect();
        all.iter().map(|x| (x - all[0]) / (all[n - 1] - all[0])).collect()
    }

    #[test]
    fn what_is_exact_is_found_and_nothing_else() {
        type Curve = fn(f64) -> [f64; 3];
        let curves: [Curve; 6] = [
            |u| [2.0 * u, 0.3 * u, 0.0],
            |u| [3.0 * u - 1.0, 0.5 * (3.0 * u - 1.0).powi(2), 0.0],
            |u| [3.0 * u - 1.0, 0.3 * (3.0 * u - 1.0).powi(3) - 0.6 * u, 0.0],
            |u| [(2.5 * u).cos(), (2.5 * u).sin(), 0.0],
            |u| [1.5 * (2.5 * u).cos(), 0.6 * (2.5 * u).sin(), 0.0],
            |u| [(4.0 * u).cos(), (4.0 * u).sin(), 0.9 * u],
        ];
        for (k, curve) in curves.into_iter().enumerate() {
            for n in [16, 23, 50] {
                let all: Vec<[f64; 3]> = places(n).into_iter().map(curve).collect();
                let points = turned(&all);
                assert!(exact(&points), "curve {k} of {n} points");
                let mut off = points.clone();
                off[n / 2] += Vec3::of(1e-8, 2e-8, -1e-8);
                assert!(!exact(&off), "curve {k} of {n} points, one of them off");
            }
        }
        // Between two lines and three: readings of few digits.
        for steps in [2, 3] {
            let level = |k: usize| ((k * k * 7919 + 13 * k) % 101 % steps) as f64;
            let read: Vec<[f64; 3]> = (0..40).map(|k| [k as f64, 0.01 * level(k), 0.0]).collect();
            assert!(!exact(&turned(&read)));
        }
        let clothoid: Vec<[f64; 3]> = places(30)
            .into_iter()
            .map(|u| [u, u.powi(3) / 3.0 - u.powi(7) / 42.0 + u.powi(11) / 1320.0, 0.0])
            .collect();
        assert!(!exact(&turned(&clothoid)));
    }
}
