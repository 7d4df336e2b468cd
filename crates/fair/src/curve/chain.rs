//! Chains of straight lines and circular arcs that are tangent to each other, near points.
//!
//! A chain begins at an offset from its first point, in a direction; each part has a length and an
//! arc a curvature. Lines, radii and tangency points are found together by least squares (Levenberg
//! and Marquardt), and towards the least largest residual where a point would stay outside its
//! tolerance (Lawson's weights).

use crate::curve::bernstein::P;

/// A line or an arc of a chain, and the points that it is near.
#[derive(Clone, Debug)]
pub(crate) struct ChainElement {
    pub arc: bool,
    /// Its first and last point.
    pub between: [usize; 2],
    /// The angle of a line that is given.
    pub angle: Option<f64>,
}

/// A part that has been found: where it begins, its direction there, its curvature and length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedSegment {
    pub start: P<f64>,
    pub angle: f64,
    pub curvature: f64,
    pub length: f64,
}

impl FittedSegment {
    /// Position and direction at an arc length.
    pub fn at(&self, s: f64) -> (P<f64>, P<f64>) {
        let half = 0.5 * self.curvature * s;
        // The chord of an arc is s sin(half) / half long.
        let chord = if half.abs() < 1e-8 { s } else { s * libm::sin(half) / half };
        let (dy, dx) = libm::sincos(self.angle + half);
        let (ty, tx) = libm::sincos(self.angle + 2.0 * half);
        ([self.start[0] + chord * dx, self.start[1] + chord * dy], [tx, ty])
    }

    /// The arc length of the foot of a point, and its distance, positive to the left.
    pub fn foot(&self, p: P<f64>) -> (f64, f64) {
        let (sin, cos) = libm::sincos(self.angle);
        let away = [p[0] - self.start[0], p[1] - self.start[1]];
        let (along, left) = (away[0] * cos + away[1] * sin, away[1] * cos - away[0] * sin);
        if self.curvature == 0.0 {
            return (along, left);
        }
        let k = self.curvature;
        // Relative to the centre, at (0, 1 / k) in the own frame.
        let turned = libm::atan2(along * k, 1.0 - left * k);
        let far = ((along * k).powi(2) + (1.0 - left * k).powi(2)).sqrt();
        (turned / k, (1.0 - far) / k)
    }
}

/// A chain near its points.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub pieces: Vec<FittedSegment>,
}

impl Chain {
    /// Position and direction at an arc length from its start.
    pub fn at(&self, mut s: f64) -> (P<f64>, P<f64>) {
        let last = self.pieces.len() - 1;
        for piece in &self.pieces[..last] {
            if s <= piece.length {
                return piece.at(s);
            }
            s -= piece.length;
        }
        self.pieces[last].at(s)
    }

    /// Arc length of the foot of a point near part `near`, and its distance. The first part is
    /// extended before its start, the last beyond its end.
    pub fn foot(&self, p: P<f64>, near: usize) -> (f64, f64) {
        let last = self.pieces.len() - 1;
        let mut best = (0.0, f64::INFINITY);
        let mut begin = 0.0;
        for (k, piece) in self.pieces.iter().enumerate() {
            if k + 1 >= near && k <= near + 1 {
                let (s, off) = piece.foot(p);
                let low = k == 0 || s >= -1e-12 * piece.length;
                let high = k == last || s <= piece.length * (1.0 + 1e-12);
                if low && high && off.abs() < best.1 {
                    best = (begin + s, off.abs());
                }
            }
            begin += piece.length;
        }
        best
    }

    /// The arc lengths at which part meets part.
    pub fn joints(&self) -> Vec<f64> {
        let mut s = 0.0;
        let inner = &self.pieces[..self.pieces.len() - 1];
        inner
            .iter()
            .map(|p| {
                s += p.length;
                s
            })
            .collect()
    }
}

/// The unknowns of a chain, in the order of [`Fit::pieces`].
struct ChainFit<'a> {
    parts: &'a [ChainElement],
    points: &'a [P<f64>],
    /// Point and part of each residual.
    rows: Vec<(usize, usize)>,
}

const ROUNDS: usize = 80;
const LAWSON: usize = 60;

impl ChainFit<'_> {
    fn first(&self) -> P<f64> {
        self.points[self.parts[0].between[0]]
    }

    fn pieces(&self, x: &[f64]) -> Vec<FittedSegment> {
        let mut x = x.iter().copied();
        let mut next = || x.next().expect("as many as unknowns");
        let offset = next();
        let mut angle = self.parts[0].angle.unwrap_or_else(&mut next);
        let first = self.first();
        let mut start =
            [first[0] - offset * libm::sin(angle), first[1] + offset * libm::cos(angle)];
        let last = self.parts.len() - 1;
        let mut out = Vec::new();
        for (k, part) in self.parts.iter().enumerate() {
            let curvature = if part.arc { next() } else { 0.0 };
            let length = if k == last {
                0.0
            } else if let (true, Some(to)) = (part.arc, self.parts[k + 1].angle) {
                let pi = std::f64::consts::PI;
                // A line has two directions: that which the arc reaches first.
                let turn = (to - angle) * curvature.signum();
                turn.rem_euclid(pi) / curvature.abs()
            } else {
                next()
            };
            let piece = FittedSegment { start, angle, curvature, length };
            (start, angle) = (piece.at(length).0, angle + curvature * length);
            out.push(piece);
        }
        out
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        let pieces = self.pieces(x);
        self.rows.iter().map(|&(point, part)| pieces[part].foot(self.points[point]).1).collect()
    }

    /// Lengths, directions and curvatures of the parts one by one.
    fn start(&self) -> Vec<f64> {
        let line = |[a, b]: [usize; 2]| {
            let all = &self.points[a..=b];
            let n = all.len() as f64;
            let middle = [0, 1].map(|c| all.iter().map(|p| p[c]).sum::<f64>() / n);
            let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
            for p in all {
                let (x, y) = (p[0] - middle[0], p[1] - middle[1]);
                xx += x * x;
                xy += x * y;
                yy += y * y;
            }
            let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
            let (sin, cos) = libm::sincos(angle);
            let (from, to) = (all[0], all[all.len() - 1]);
            let back = (to[0] - from[0]) * cos + (to[1] - from[1]) * sin < 0.0;
            if back { angle + std::f64::consts::PI } else { angle }
        };
        let polyline = |a: usize, b: usize| -> f64 {
            let step = |w: &[P<f64>]| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]);
            self.points[a..=b].windows(2).map(step).sum()
        };
        // Curvature and the direction at the first point of the circle of least squares (Kasa 1976).
        let circle = |[a, b]: [usize; 2]| {
            let all = &self.points[a..=b];
            let o = all[0];
            let (mut m, mut r) = ([0.0; 9], vec![0.0; 3]);
            for p in all {
                let v = [p[0] - o[0], p[1] - o[1], 1.0];
                let z = v[0] * v[0] + v[1] * v[1];
                for i in 0..3 {
                    r[i] += z * v[i];
                    for j in 0..3 {
                        m[3 * i + j] += v[i] * v[j];
                    }
                }
            }
            let flat = (0.0, line([a, b]));
            if moldloft_num::solve_dense(&mut m, &mut r).is_err() {
                return flat;
            }
            let c = [0.5 * r[0], 0.5 * r[1]];
            let radius = (r[2] + c[0] * c[0] + c[1] * c[1]).sqrt();
            if !radius.is_finite() || radius == 0.0 {
                return flat;
            }
            let end = all[all.len() - 1];
            let left = (end[0] - o[0]) * c[1] - (end[1] - o[1]) * c[0] > 0.0;
            let out = libm::atan2(-c[1], -c[0]);
            let quarter = std::f64::consts::FRAC_PI_2;
            if left { (1.0 / radius, out + quarter) } else { (-1.0 / radius, out - quarter) }
        };
        let mut x = vec![0.0];
        let first = &self.parts[0];
        if first.angle.is_none() {
            x.push(if first.arc { circle(first.between).1 } else { line(first.between) });
        }
        for (k, part) in self.parts.iter().enumerate() {
            if part.arc {
                x.push(circle(part.between).0);
            }
            if let Some(after) = self.parts.get(k + 1)
                && !(part.arc && after.angle.is_some())
            {
                x.push(polyline(part.between[0], after.between[0]));
            }
        }
        x
    }

    /// The least sum of weighted squares from a start.
    fn descend(&self, mut x: Vec<f64>, weights: &[f64]) -> Vec<f64> {
        let n = x.len();
        let square = |r: &[f64]| -> f64 { r.iter().zip(weights).map(|(r, w)| w * r * r).sum() };
        let mut r = self.residuals(&x);
        let mut best = square(&r);
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let columns: Vec<Vec<f64>> = (0..n)
                .map(|k| {
                    let h = 1e-6 * x[k].abs().max(1e-3);
                    let (mut up, mut down) = (x.clone(), x.clone());
                    up[k] += h;
                    down[k] -= h;
                    let both = self.residuals(&up).into_iter().zip(self.residuals(&down));
                    both.map(|(a, b)| (a - b) / (2.0 * h)).collect()
                })
                .collect();
            let sum = |a: &[f64], b: &[f64]| -> f64 {
                a.iter().zip(b).zip(weights).map(|((a, b), w)| w * a * b).sum()
            };
            let mut moved = false;
            for _ in 0..12 {
                let mut matrix = vec![0.0; n * n];
                let mut step: Vec<f64> = columns.iter().map(|c| -sum(c, &r)).collect();
                for i in 0..n {
                    for j in 0..n {
                        matrix[i * n + j] = sum(&columns[i], &columns[j]);
                    }
                    matrix[i * n + i] *= 1.0 + damping;
                    matrix[i * n + i] += 1e-300;
                }
                if moldloft_num::solve_dense(&mut matrix, &mut step).is_err() {
                    damping *= 10.0;
                    continue;
                }
                let trial: Vec<f64> = x.iter().zip(&step).map(|(a, b)| a + b).collect();
                let there = self.residuals(&trial);
                let value = square(&there);
                if value < best {
                    let gain = best - value;
                    (x, r, best) = (trial, there, value);
                    damping = (damping * 0.1).max(1e-15);
                    moved = gain > 1e-15 * value;
                    break;
                }
                damping *= 10.0;
            }
            if !moved {
                break;
            }
            damping = damping.min(1e3);
        }
        x
    }
}

/// The chain near points within their tolerances. The part whose point stays farthest beyond its
/// tolerance, the point and its distance otherwise.
pub(crate) fn chain(
    points: &[P<f64>],
    radii: &[f64],
    parts: Vec<ChainElement>,
) -> Result<Chain, (usize, usize, f64)> {
    // In units of its own size.
    let (from, to) = (parts[0].between[0], parts[parts.len() - 1].between[1]);
    let size = points[from..=to]
        .iter()
        .map(|p| libm::hypot(p[0] - points[from][0], p[1] - points[from][1]))
        .fold(0.0, f64::max);
    let scaled: Vec<P<f64>> = points.iter().map(|p| p.map(|c| c / size)).collect();
    let mut rows = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        // A point of two parts is the first one's.
        let begin = if k > 0 && parts[k - 1].between[1] == part.between[0] { 1 } else { 0 };
        rows.extend((part.between[0] + begin..=part.between[1]).map(|i| (i, k)));
    }
    let allowed: Vec<f64> = rows
        .iter()
        .map(|&(i, _)| if radii[i].is_finite() { (radii[i] / size).max(1e-12) } else { 1.0 })
        .collect();
    let fit = ChainFit { parts: &parts, points: &scaled, rows };
    let mut weights: Vec<f64> = allowed.iter().map(|a| 1.0 / (a * a)).collect();
    let largest = |x: &[f64]| {
        let all = fit.residuals(x);
        let over = all.iter().zip(&allowed).map(|(r, a)| r.abs() / a);
        over.enumerate().fold((0, 0.0), |a, b| if b.1 > a.1 || b.1.is_nan() { b } else { a })
    };
    let mut x = fit.descend(fit.start(), &weights);
    let mut best = (largest(&x), x.clone());
    for _ in 0..LAWSON {
        if best.0.1 <= 0.999 {
            break;
        }
        for ((w, r), a) in weights.iter_mut().zip(fit.residuals(&x)).zip(&allowed) {
            *w = (*w * (r.abs() / a)).max(1e-12 / (a * a));
        }
        let total: f64 = weights.iter().zip(&allowed).map(|(w, a)| w * a * a).sum();
        let share = weights.len() as f64 / total;
        weights.iter_mut().for_each(|w| *w *= share);
        x = fit.descend(x, &weights);
        let now = largest(&x);
        if now.1 < best.0.1 {
            best = (now, x.clone());
        }
    }
    let ((worst, over), x) = best;
    let (point, part) = fit.rows[worst];
    if over.is_nan() || over > 1.0 {
        return Err((part, point, over * allowed[worst] * size));
    }
    let back = |p: FittedSegment| FittedSegment {
        start: p.start.map(|c| c * size),
        curvature: p.curvature / size,
        length: p.length * size,
        ..p
    };
    let pieces = fit.pieces(&x).into_iter().map(back).collect();
    Ok(Chain { pieces })
}

/// Increasing positions, each within `rooms` of its foot; noise can reverse the order of close
/// points. Least-squares solution with a minimum step between positions, by pooling adjacent
/// violators (Ayer, Brunk, Ewing, Reid and Silverman 1955), with the largest step that `rooms`
/// allow; otherwise the error is the index of the first reversed foot.
pub(crate) fn in_order(feet: Vec<f64>, rooms: &[f64]) -> Result<Vec<f64>, usize> {
    let Some(first) = (1..feet.len()).find(|&k| feet[k] <= feet[k - 1]) else { return Ok(feet) };
    let least = rooms.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = rooms.iter().copied().fold(0.0, f64::max);
    let mut step = if largest.is_finite() { largest } else { least };
    for _ in 0..PLACE_HALVINGS {
        step *= 0.5;
        // Mean and number of feet of each block.
        let mut blocks: Vec<(f64, usize)> = Vec::new();
        for (k, s) in feet.iter().enumerate() {
            blocks.push((s - step * k as f64, 1));
            while let [.., a, b] = blocks[..]
                && a.0 > b.0
            {
                blocks.truncate(blocks.len() - 2);
                let count = a.1 + b.1;
                blocks.push(((a.0 * a.1 as f64 + b.0 * b.1 as f64) / count as f64, count));
            }
        }
        let means = blocks.iter().flat_map(|&(mean, count)| std::iter::repeat_n(mean, count));
        let placed: Vec<f64> = means.enumerate().map(|(k, mean)| mean + step * k as f64).collect();
        let within =
            placed.iter().zip(&feet).zip(rooms).all(|((p, s), room)| (p - s).abs() <= *room);
        if within && placed.windows(2).all(|w| w[0] < w[1]) {
            return Ok(placed);
        }
    }
    Err(first)
}

/// Maximum number of halvings of the step.
const PLACE_HALVINGS: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_an_arc_and_a_line_come_back() {
        // Flat bottom, bilge of radius 1.4, side.
        let truth = Chain {
            pieces: vec![
                FittedSegment { start: [0.0, 0.02], angle: 0.03, curvature: 0.0, length: 3.2 },
                FittedSegment { start: [0.0; 2], angle: 0.0, curvature: 1.0 / 1.4, length: 2.1 },
                FittedSegment { start: [0.0; 2], angle: 0.0, curvature: 0.0, length: 4.8 },
            ],
        };
        let mut truth = truth;
        for k in 1..3 {
            let before = truth.pieces[k - 1];
            truth.pieces[k].start = before.at(before.length).0;
            truth.pieces[k].angle = before.angle + before.curvature * before.length;
        }
        let joints = truth.joints();
        let s: Vec<f64> = (0..30).map(|k| 10.1 * f64::from(k) / 29.0).collect();
        let points: Vec<P<f64>> = s.iter().map(|&s| truth.at(s).0).collect();
        let last = |j: f64| s.iter().rposition(|&s| s <= j).unwrap();
        let (a, b) = (last(joints[0]), last(joints[1]));
        let part = |arc, between| ChainElement { arc, between, angle: None };
        let parts = vec![part(false, [0, a]), part(true, [a + 1, b]), part(false, [b + 1, 29])];
        let found = chain(&points, &[1e-6; 30], parts).unwrap();
        for (own, wanted) in found.pieces.iter().zip(&truth.pieces) {
            assert!((own.curvature - wanted.curvature).abs() < 1e-9, "{own:?} {wanted:?}");
        }
        for (own, wanted) in found.joints().iter().zip(&joints) {
            assert!((own - wanted).abs() < 1e-7, "{own} {wanted}");
        }
        for (k, &p) in points.iter().enumerate() {
            let (near, off) = found.foot(
                p,
                if k <= a {
                    0
                } else if k <= b {
                    1
                } else {
                    2
                },
            );
            assert!(off < 1e-10 && (near - s[k]).abs() < 1e-6, "{k}: {off} {near}");
        }
    }
}
