//! Division of a stroke into lines and arcs of least description length.

use super::cells::StrokeCells;
use super::{cross, distance, dot, to, turn};
use std::ops::Range;

/// Costs of a line and of an arc: their parameters and a break, as logarithms of a likelihood.
pub(super) const LINE: f64 = 8.0;
pub(super) const ARC: f64 = 13.0;

/// Standard deviation of the height of a line that a hand bends, and least height of an arc, as parts
/// of the chord.
const BOW: f64 = 0.02;
const LEAST_ARC: f64 = 0.045;

/// Fewest cells of an arc.
const ARC_CELLS: usize = 5;

/// Ratio of the noises of the ladder, and the largest one, in units of the size of the stroke.
const STEP: f64 = 1.5;
const MOST_NOISE: f64 = 0.03;

/// Least chord of a line as a part of its length.
const STRAIGHT: f64 = 0.8;

/// Sums of powers of the coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StrokeMoments {
    pub n: f64,
    pub x: f64,
    pub y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    xz: f64,
    yz: f64,
    zz: f64,
}

impl StrokeMoments {
    /// With a point of a weight.
    pub fn with(&self, [x, y]: [f64; 2], w: f64) -> StrokeMoments {
        let z = x * x + y * y;
        self.plus(&StrokeMoments {
            n: w,
            x: w * x,
            y: w * y,
            xx: w * x * x,
            xy: w * x * y,
            yy: w * y * y,
            xz: w * x * z,
            yz: w * y * z,
            zz: w * z * z,
        })
    }

    /// The sum.
    pub fn plus(&self, o: &StrokeMoments) -> StrokeMoments {
        self.combined(o, 1.0)
    }

    fn combined(&self, o: &StrokeMoments, s: f64) -> StrokeMoments {
        StrokeMoments {
            n: self.n + s * o.n,
            x: self.x + s * o.x,
            y: self.y + s * o.y,
            xx: self.xx + s * o.xx,
            xy: self.xy + s * o.xy,
            yy: self.yy + s * o.yy,
            xz: self.xz + s * o.xz,
            yz: self.yz + s * o.yz,
            zz: self.zz + s * o.zz,
        }
    }

    /// Covariances: of x, of x and y, of y.
    fn covariance(&self) -> [f64; 3] {
        let (x, y) = (self.x / self.n, self.y / self.n);
        [self.xx / self.n - x * x, self.xy / self.n - x * y, self.yy / self.n - y * y]
    }

    /// Sum of the squared distances from the line of least squares.
    pub fn line(&self) -> f64 {
        let [a, b, c] = self.covariance();
        let half = 0.5 * (a - c);
        self.n * (0.5 * (a + c) - libm::hypot(half, b)).max(0.0)
    }

    /// Direction of the line of least squares.
    pub fn direction(&self) -> [f64; 2] {
        let [a, b, c] = self.covariance();
        let angle = 0.5 * libm::atan2(2.0 * b, a - c);
        [libm::cos(angle), libm::sin(angle)]
    }

    /// Taubin's circle: centre, radius, sum of the squared distances.
    pub fn circle(&self) -> Option<([f64; 2], f64, f64)> {
        let n = self.n;
        let (x, y) = (self.x / n, self.y / n);
        let [mxx, mxy, myy] = self.covariance();
        // Moments about the mean; z is the squared distance from it.
        let z = self.xx / n + self.yy / n;
        let q = x * x + y * y;
        let mz = mxx + myy;
        let txx = self.xx / n;
        let tyy = self.yy / n;
        let txy = self.xy / n;
        let raw = [self.xz / n, self.yz / n];
        // E[(x-a) (z - 2 a x - 2 b y + q)] with (a, b) the mean.
        let mxz = raw[0] - 2.0 * x * txx - 2.0 * y * txy + q * x - x * (z - 2.0 * q + q);
        let myz = raw[1] - 2.0 * x * txy - 2.0 * y * tyy + q * y - y * (z - 2.0 * q + q);
        let mzz = self.zz / n + 4.0 * (x * x * txx + 2.0 * x * y * txy + y * y * tyy) + q * q
            - 4.0 * (x * raw[0] + y * raw[1])
            + 2.0 * q * z
            - 4.0 * q * q;
        let cov = mxx * myy - mxy * mxy;
        let var = mzz - mz * mz;
        let a3 = 4.0 * mz;
        let a2 = -3.0 * mz * mz - mzz;
        let a1 = var * mz + 4.0 * cov * mz - mxz * mxz - myz * myz;
        let a0 = mxz * (mxz * myy - myz * mxy) + myz * (myz * mxx - mxz * mxy) - var * cov;
        let (mut root, mut value) = (0.0, a0);
        for _ in 0..20 {
            let slope = a1 + root * (2.0 * a2 + 3.0 * a3 * root);
            let next = root - value / slope;
            if !next.is_finite() || (next - root).abs() <= 1e-14 * mz {
                break;
            }
            let at = a0 + next * (a1 + next * (a2 + next * a3));
            if at.abs() >= value.abs() {
                break;
            }
            (root, value) = (next, at);
        }
        let det = root * root - root * mz + cov;
        let cx = (mxz * (myy - root) - myz * mxy) / det / 2.0;
        let cy = (myz * (mxx - root) - mxz * mxy) / det / 2.0;
        let radius = (cx * cx + cy * cy + mz).sqrt();
        let good = radius.is_finite() && root >= -1e-12;
        good.then_some(([x + cx, y + cy], radius, n * root.max(0.0)))
    }
}

/// Consecutive cells that are one line or arc.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StrokeRun {
    pub cells: Range<usize>,
    pub arc: bool,
    /// Description length.
    pub cost: f64,
}

/// Squared distances of the cells of a range from a line, from an arc, and the penalty of a line that is as bent as
/// that arc; infinite where they are no such shape.
#[derive(Clone, Copy)]
struct ShapeCost {
    line: f64,
    arc: f64,
    bow: f64,
    round: bool,
}

impl ShapeCost {
    /// The cheapest description, and true for an arc.
    fn cost(&self, precision: f64) -> (f64, bool) {
        let bowed = precision * self.arc + self.bow;
        let line = (precision * self.line).min(bowed) + LINE;
        let arc = if self.round { precision * self.arc + ARC } else { f64::INFINITY };
        if arc < line { (arc, true) } else { (line, false) }
    }
}

/// The choices of all ranges of cells.
struct ShapeCosts {
    /// For each end, those of the starts before it.
    rows: Vec<Vec<ShapeCost>>,
}

impl ShapeCosts {
    fn of(cells: &StrokeCells) -> ShapeCosts {
        let (mut moments, mut along) = (vec![StrokeMoments::default()], vec![0.0]);
        for k in 0..cells.len() {
            moments.push(moments[k].plus(&cells.moments[k]));
            if k > 0 {
                along.push(along[k - 1] + distance(cells.at[k - 1], cells.at[k]));
            }
        }
        let row = |end: usize| {
            let one = |start: usize| {
                let sum = moments[end].combined(&moments[start], -1.0);
                choice(cells, start..end, &sum, along[end - 1] - along[start])
            };
            (0..end.saturating_sub(1)).map(one).collect()
        };
        ShapeCosts { rows: (0..=cells.len()).map(row).collect() }
    }

    /// The division of least cost, by dynamic programming.
    fn cheapest(&self, precision: f64) -> (Vec<StrokeRun>, f64) {
        let n = self.rows.len() - 1;
        let mut best: Vec<(f64, usize, bool)> = vec![(f64::INFINITY, 0, false); n + 1];
        best[0].0 = 0.0;
        for end in 2..=n {
            for (start, choice) in self.rows[end].iter().enumerate() {
                let before = best[start].0;
                if before + LINE >= best[end].0 {
                    continue;
                }
                let (cost, arc) = choice.cost(precision);
                if before + cost < best[end].0 {
                    best[end] = (before + cost, start, arc);
                }
            }
        }
        let mut runs = Vec::new();
        let mut end = n;
        while end > 0 {
            let (cost, start, arc) = best[end];
            runs.push(StrokeRun { cells: start..end, arc, cost: cost - best[start].0 });
            end = start;
        }
        runs.reverse();
        (runs, best[n].0)
    }
}

/// The shapes of the cells of a range, of a length along the stroke.
fn choice(cells: &StrokeCells, range: Range<usize>, sum: &StrokeMoments, length: f64) -> ShapeCost {
    let (first, last) = (range.start, range.end - 1);
    let [a, b] = [first, last].map(|k| cells.at[k]);
    let chord = distance(a, b);
    let straight = chord >= STRAIGHT * length;
    let line = if straight { sum.line() } else { f64::INFINITY };
    let none = ShapeCost { line, arc: f64::INFINITY, bow: f64::INFINITY, round: false };
    if range.len() < ARC_CELLS {
        return none;
    }
    let Some((centre, radius, square)) = sum.circle() else { return none };
    let sweep = length / radius;
    let height = radius * (1.0 - libm::cos((0.5 * sweep).min(std::f64::consts::PI)));
    let bow = if straight { 0.5 * (height / chord / BOW).powi(2) } else { f64::INFINITY };
    // The cells turn about the centre in one sense by the sweep of their length.
    let middle = cells.at[(first + last) / 2];
    let [p, m, q] = [a, middle, b].map(|p| to(centre, p));
    let (one, two) = (turn(p, m), turn(m, q));
    let turned = (one + two).abs();
    let around = one * two > 0.0 && sweep > 0.85 * turned && sweep < 1.3 * turned + 0.1;
    let round = around && height > LEAST_ARC * chord;
    let arc = if round || straight { square } else { f64::INFINITY };
    ShapeCost { line, arc, bow, round }
}

/// A division under the assumption of a noise.
#[derive(Clone, Debug)]
pub(super) struct StrokeDivision {
    pub noise: f64,
    pub runs: Vec<StrokeRun>,
    /// Description length of the runs, without that of the noise.
    pub cost: f64,
}

impl StrokeDivision {
    fn total(&self, cells: &StrokeCells) -> f64 {
        self.cost + cells.independent() * libm::log(self.noise)
    }
}

/// The divisions of cells for a ladder of noises, the likeliest first.
pub(super) fn divisions(cells: &StrokeCells) -> Vec<StrokeDivision> {
    if cells.len() < 4 {
        let whole = StrokeRun { cells: 0..cells.len(), arc: false, cost: LINE };
        return vec![StrokeDivision { noise: cells.noise, runs: vec![whole], cost: LINE }];
    }
    let choices = ShapeCosts::of(cells);
    let mut out = Vec::new();
    let mut noise = cells.noise;
    while out.is_empty() || noise < MOST_NOISE {
        let (runs, cost) = choices.cheapest(cells.precision_of(noise));
        out.push(StrokeDivision { noise, runs, cost });
        noise *= STEP;
    }
    out.sort_by(|a, b| a.total(cells).total_cmp(&b.total(cells)));
    out
}

/// The cells of a closed stroke from its sharpest corner on, or from the start of an arc or line of a smooth one.
pub(super) fn from_corner(cells: StrokeCells) -> StrokeCells {
    let divisions = divisions(&cells);
    let Some(StrokeDivision { runs, .. }) = divisions.first() else { return cells };
    let sharpness = |k: usize| {
        let [a, b] = [k - 1, k].map(|k| end_directions(&cells, &runs[k]));
        turn(a[1], b[0]).abs()
    };
    let first = (1..runs.len()).max_by(|&a, &b| sharpness(a).total_cmp(&sharpness(b)));
    let first = first.map_or(0, |k| runs[k].cells.start);
    cells.rotated(first)
}

/// Directions at the start and the end of a run, forward.
pub(super) fn end_directions(cells: &StrokeCells, run: &StrokeRun) -> [[f64; 2]; 2] {
    let sum = sum_of(cells, run.cells.clone());
    let [a, b] = [run.cells.start, run.cells.end - 1].map(|k| cells.at[k]);
    let line = || {
        let d = sum.direction();
        let d = if dot(d, to(a, b)) < 0.0 { d.map(|x| -x) } else { d };
        [d, d]
    };
    if !run.arc {
        return line();
    }
    let Some((centre, ..)) = sum.circle() else { return line() };
    let middle = cells.at[(run.cells.start + run.cells.end - 1) / 2];
    let sense = cross(to(centre, a), to(centre, middle)).signum();
    [a, b].map(|p| {
        let r = to(centre, p);
        let length = libm::hypot(r[0], r[1]).max(f64::MIN_POSITIVE);
        [-sense * r[1] / length, sense * r[0] / length]
    })
}

/// Sum of the moments of some cells.
pub(super) fn sum_of(cells: &StrokeCells, range: Range<usize>) -> StrokeMoments {
    cells.moments[range].iter().fold(StrokeMoments::default(), |m, c| m.plus(c))
}
