//! Wrong digits and knuckles among data at any spacing: proposals, with the evidence.
//!
//! Each point is left out and predicted by a cubic through five neighbours on either side,
//! parametrised by chord length. Only the error across the curve counts, since the error along it
//! is a matter of spacing; it is compared with a scale of the neighbourhood that is moderated by
//! the whole file (Smyth 2004). Leaving the point out removes the outlier at a wrong digit, but not
//! at a knuckle.

use crate::interrogate::short_lists::{SHORT, short_knuckles, swapped};
use moldloft_num::Vec3;

/// A finding about data.
#[derive(Clone, Debug, PartialEq)]
pub enum DataFinding {
    /// A point that its neighbours do not predict: probably a wrong digit.
    WrongDigit {
        /// The point.
        index: usize,
        /// Predicted position: the point moved across the curve.
        expected: Vec3<f64>,
        /// Error relative to the local scale.
        score: f64,
        /// Smallest error that is reported.
        least: f64,
    },
    /// A point at which the tangent turns: probably an intended break.
    Knuckle {
        /// The point.
        index: usize,
        /// The turn of the tangent, in radians.
        angle: f64,
        /// The turn as a multiple of its scale.
        score: f64,
    },
    /// A point that seems to belong after the next one: the polyline through both reverses.
    Swapped {
        /// The first of the two.
        index: usize,
    },
}

impl DataFinding {
    /// Index of the point.
    pub fn index(&self) -> usize {
        match *self {
            Self::WrongDigit { index, .. }
            | Self::Knuckle { index, .. }
            | Self::Swapped { index } => index,
        }
    }
}

impl std::fmt::Display for DataFinding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let number = self.index() + 1;
        match self {
            Self::WrongDigit { expected, score, least, .. } => write!(
                f,
                "point {number}: a wrong digit? its neighbours have it at ({:.6}, {:.6}, {:.6}), it is \
                 {score:.1} times the scale off ({least:.2e} would have been found)",
                expected.x, expected.y, expected.z
            ),
            Self::Knuckle { angle, score, .. } => write!(
                f,
                "point {number}: an intended break? the tangent turns by {:.2} degrees there, \
                 {score:.0} times the scale",
                angle.to_degrees()
            ),
            Self::Swapped { index } => write!(
                f,
                "points {number} and {}: in the wrong order? the path through them turns back",
                index + 2
            ),
        }
    }
}

/// The chance of a false finding among the points of a file whose noise is Gaussian and as large
/// everywhere as it is here.
const CHANCE: f64 = 0.01;

/// Range of the score from which a point is proposed. Noise of varying strength has long tails by
/// Student's law; that of rounding and drawing is bounded. At a score of 5, of 2 169 aerofoils none
/// had a false finding away from the ends.
const SCORES: [f64; 2] = [4.0, 5.0];

/// The score from which a point is proposed where fewer than `CLOSE` neighbours are on one side: a
/// cubic is extrapolated there, and a straight end or a trailing edge looks like a slip.
const END_SCORE: f64 = 7.0;

/// The score from which a point is proposed between these two cases: where there are more
/// neighbours on one side than on the other.
const ASIDE_SCORE: f64 = 6.0;

/// Leaving a point out cures when no neighbour has a larger score without it.
const CURED: f64 = 6.0;

/// Minimum score of a knuckle's turn.
const KNUCKLE_SCORE: f64 = 20.0;

/// Turn in radians beyond which it counts as a nose, unless both sides are straight or the turn is
/// `STANDS_OUT` times its neighbours, which do not grow towards it.
const LARGEST_TURN: f64 = 0.44;

/// A polygon that doubles back by more than this is a nose that the points do not resolve.
pub(super) const DOUBLES_BACK: f64 = 1.75;

/// Minimum ratio of a knuckle's turn to those beside it, for turns at which a nose is possible.
pub(super) const STANDS_OUT: f64 = 6.0;

/// Neighbours on either side.
const SIDE: usize = 5;

/// Number of neighbours on either side that must confirm an error, and the part of it that they
/// must confirm: more beside an end.
const CLOSE: usize = 3;
const CONFIRMS: [f64; 2] = [0.5, 0.8];

/// Number of points whose influence on the scales of others is examined: those with the largest
/// score by the scale of their neighbourhood and by that of the file.
const CANDIDATES: [usize; 2] = [8, 4];

/// Minimum number of points for any finding.
const FEWEST: usize = 12;

/// Proposals at most.
const MOST: usize = 5;

/// Weight of the file's scale beside that of a neighbourhood, in degrees of freedom, at least and at
/// most: as the neighbourhoods' scales differ more or less than noise alone makes them.
const PRIOR: [f64; 2] = [4.0, 60.0];

/// Degrees of freedom of the scale of a neighbourhood.
const FREEDOM: f64 = (2 * SIDE - 4) as f64;

/// Fraction of turns of more than 90 degrees from which on chords are lengths of noise.
const TURNS_BACK: f64 = 0.25;

/// Number of points from which on the scale of a file is that without any of its points.
const MANY: usize = 1_000;

/// How neighbours in a list follow each other.
#[derive(Clone, Copy, Debug)]
struct ListForm {
    closed: bool,
    /// True if their noise is larger than their spacing: their number is the parameter, knuckles are not
    /// resolved, and all of an error counts.
    dense: bool,
}

impl ListForm {
    fn of(points: &[Vec3<f64>], closed: bool) -> Self {
        let turn = |w: &&[Vec3<f64>]| (w[1] - w[0]).dot(w[2] - w[1]) < 0.0;
        let back = points.windows(3).filter(turn).count() as f64;
        let dense = points.len() > SHORT[1] && back > TURNS_BACK * points.len() as f64;
        Self { closed, dense }
    }
}

/// Prediction of a point from its neighbours.
#[derive(Clone, Copy, Debug)]
struct NeighbourFit {
    /// Across the curve, over the root of 1 + leverage.
    off: f64,
    /// The part across the curve, as it is.
    across: Vec3<f64>,
    expected: Vec3<f64>,
    leverage: f64,
    /// The scale of the neighbours about their cubic.
    scale: f64,
    judged: bool,
    /// True with as many neighbours on either side.
    central: bool,
    /// True with enough neighbours on either side to interpolate.
    inner: bool,
}

/// A least squares fit of polynomials with an extra column, by Householder's QR through modified
/// Gram and Schmidt, which columns this few allow.
pub(super) struct ThinQr<const C: usize> {
    q: Vec<[f64; C]>,
    r: [[f64; C]; C],
}

impl<const C: usize> ThinQr<C> {
    pub(super) fn new(mut a: Vec<[f64; C]>) -> Option<Self> {
        let mut r = [[0.0; C]; C];
        for j in 0..C {
            for _ in 0..2 {
                for i in 0..j {
                    let dot: f64 = a.iter().map(|row| row[i] * row[j]).sum();
                    r[i][j] += dot;
                    a.iter_mut().for_each(|row| row[j] -= dot * row[i]);
                }
            }
            let norm = a.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
            if norm.is_nan() || norm <= 1e-12 {
                return None;
            }
            r[j][j] = norm;
            a.iter_mut().for_each(|row| row[j] /= norm);
        }
        Some(Self { q: a, r })
    }

    /// Norm of the part of the last column that is orthogonal to the others.
    pub(super) fn last(&self) -> f64 {
        self.r[C - 1][C - 1]
    }

    pub(super) fn solve(&self, b: &[Vec3<f64>]) -> [Vec3<f64>; C] {
        let mut x = [Vec3::zero(); C];
        for j in 0..C {
            x[j] = self.q.iter().zip(b).fold(Vec3::zero(), |s, (row, p)| s + *p * row[j]);
        }
        for j in (0..C).rev() {
            for k in j + 1..C {
                let known = x[k];
                x[j] -= known * self.r[j][k];
            }
            x[j] = x[j] * (1.0 / self.r[j][j]);
        }
        x
    }

    /// The squared length of R^-T a.
    fn leverage(&self, a: [f64; C]) -> f64 {
        let mut y = a;
        for j in 0..C {
            for k in 0..j {
                y[j] -= self.r[k][j] * y[k];
            }
            y[j] /= self.r[j][j];
        }
        y.iter().map(|v| v * v).sum()
    }
}

fn cubic(c: &[Vec3<f64>; 4], x: f64) -> [Vec3<f64>; 3] {
    [
        c[0] + (c[1] + (c[2] + c[3] * x) * x) * x,
        c[1] + (c[2] * 2.0 + c[3] * (3.0 * x)) * x,
        c[2] * 2.0 + c[3] * (6.0 * x),
    ]
}

/// Indices of the neighbours of item `i`, `side` on either side, and the number of them before it.
fn window(i: usize, n: usize, side: usize, closed: bool) -> (Vec<usize>, usize) {
    let side = side.min((n - 1) / 2);
    if closed {
        let all = (1..=side).rev().map(|k| (i + n - k) % n).chain((1..=side).map(|k| (i + k) % n));
        return (all.collect(), side);
    }
    let low = i.saturating_sub(side).min(n - 1 - 2 * side);
    ((low..=low + 2 * side).filter(|&j| j != i).collect(), i - low)
}

fn seen(points: &[Vec3<f64>], i: usize, side: usize, form: ListForm) -> Option<NeighbourFit> {
    let (n, ListForm { closed, dense }) = (points.len(), form);
    let (near, place) = window(i, n, side, closed);
    let m = near.len();
    if m < 6 {
        return None;
    }
    let mut chord = vec![0.0];
    for (k, w) in near.windows(2).enumerate() {
        let step = if dense {
            if k + 1 == place { 2.0 } else { 1.0 }
        } else {
            (points[w[1]] - points[w[0]]).norm()
        };
        chord.push(chord.last()? + step);
    }
    let middle = 0.5 * chord[m - 1];
    if middle.is_nan() || middle <= 0.0 {
        return None;
    }
    let t: Vec<f64> = chord.iter().map(|c| (c - middle) / middle).collect();
    let powers = |x: f64| [1.0, x, x * x, x * x * x];
    let columns = ThinQr::new(t.iter().map(|&x| powers(x)).collect())?;
    let own: Vec<Vec3<f64>> = near.iter().map(|&j| points[j]).collect();
    let c = columns.solve(&own);
    let inside = 0 < place && place < m;
    let (a, b) = (place.max(1) - 1, place.min(m - 1));
    let p = points[i];
    let apart = |q: Vec3<f64>| if dense { 1.0 } else { (p - q).norm() };
    let (da, db) = (apart(own[a]), apart(own[b]));
    let mut x = if place == 0 {
        t[0] - db / middle
    } else if place == m {
        t[m - 1] + da / middle
    } else {
        t[a] + (t[b] - t[a]) * da / (da + db).max(f64::MIN_POSITIVE)
    };
    for _ in 0..if dense { 0 } else { 6 } {
        let [at, d, dd] = cubic(&c, x);
        let v = at - p;
        let plain = d.norm_sq();
        let bent = plain + v.dot(dd);
        let step = v.dot(d) / if bent > 0.3 * plain { bent } else { plain };
        x = (x - step).clamp(-2.0, 2.0);
    }
    let across = |v: Vec3<f64>, d: Vec3<f64>| {
        let long = d.norm_sq();
        if long > 0.0 && !dense { v - d * (v.dot(d) / long) } else { v }
    };
    let [at, d, _] = cubic(&c, x);
    let off = across(p - at, d);
    let leverage = columns.leverage(powers(x));
    let squares: f64 = own
        .iter()
        .zip(&t)
        .map(|(q, &x)| {
            let [at, d, _] = cubic(&c, x);
            across(*q - at, d).norm_sq()
        })
        .sum();
    let scale = (squares / (m - 4) as f64).sqrt();
    let across = off;
    let off = off.norm() / (1.0 + leverage).sqrt();
    let judged = inside && (closed || (i > 0 && i + 1 < n));
    let central = closed || 2 * place == m;
    let inner = central || (place >= CLOSE && m - place >= CLOSE);
    (off.is_finite() && scale.is_finite()).then_some(NeighbourFit {
        off,
        across,
        expected: at,
        leverage,
        scale,
        judged,
        central,
        inner,
    })
}

/// True if the `CLOSE` nearest neighbours on either side confirm the error in size and direction;
/// where a cubic does not follow the curve their error is much smaller.
fn confirmed(points: &[Vec3<f64>], i: usize, form: ListForm, wide: &NeighbourFit) -> bool {
    seen(points, i, CLOSE, form).is_some_and(|close| {
        let share = CONFIRMS[usize::from(!close.central)];
        close.across.dot(wide.across) >= share * wide.across.norm_sq()
    })
}

fn median(mut all: Vec<f64>) -> f64 {
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A point set against its scale.
#[derive(Clone, Copy, Debug)]
struct Judged {
    seen: NeighbourFit,
    /// Error relative to the local scale.
    score: f64,
    /// The score from which it is proposed.
    least: f64,
    /// The deviation that is predicted for it: its scale and the error of the prediction.
    deviation: f64,
}

/// The argument of the trigamma function, which falls, from its asymptotic series: exact enough for
/// degrees of freedom.
fn inverse_trigamma(y: f64) -> f64 {
    (1.0 + (1.0 + 2.0 * y).sqrt()) / (2.0 * y)
}

/// Degrees of freedom of the file's scale for a neighbourhood (Smyth 2004, equation 14, with a
/// robust variance): from the variance of the logarithms of the squared scales beyond that of
/// noise.
fn prior(scales: impl Iterator<Item = f64>, floor: f64) -> f64 {
    let logs: Vec<f64> = scales.map(|s| 2.0 * libm::log(s.max(floor))).collect();
    let middle = median(logs.clone());
    let spread = 1.4826 * median(logs.iter().map(|l| (l - middle).abs()).collect());
    // Trigamma of half the degrees of freedom, 3: pi squared over 6 less 5/4.
    let beyond = spread * spread - 0.394_934;
    let most = PRIOR[1];
    if beyond > 0.0 { (2.0 * inverse_trigamma(beyond)).clamp(PRIOR[0], most) } else { most }
}

/// The score that noise of `freedom` degrees exceeds among `count` points with `CHANCE`, kept within
/// `SCORES`: the normal quantile with the first terms of Student's (Abramowitz and Stegun 26.2.23,
/// 26.7.5).
fn threshold(count: usize, freedom: f64) -> f64 {
    let t = (-2.0 * libm::log(0.5 * CHANCE / count as f64)).sqrt();
    let z = t
        - (2.515_517 + (0.802_853 + 0.010_328 * t) * t)
            / (1.0 + (1.432_788 + (0.189_269 + 0.001_308 * t) * t) * t);
    let (z3, z5) = (z.powi(3), z.powi(5));
    let student = z
        + (z3 + z) / (4.0 * freedom)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom.powi(2));
    student.clamp(SCORES[0], SCORES[1])
}

/// Predictions of all points from their neighbours.
fn fits(points: &[Vec3<f64>], form: ListForm) -> Vec<Option<NeighbourFit>> {
    (0..points.len()).map(|i| seen(points, i, SIDE, form)).collect()
}

/// Scale of a file, and its degrees of freedom for a neighbourhood.
#[derive(Clone, Copy, Debug)]
struct FileScale {
    scale: f64,
    weight: f64,
    count: usize,
}

impl FileScale {
    fn of(all: &[Option<NeighbourFit>], floor: f64) -> Self {
        let fit = || all.iter().flatten().filter(|s| s.judged);
        let scale = (1.4826 * median(fit().map(|s| s.off).collect())).max(floor);
        let weight = prior(fit().map(|s| s.scale), floor.max(f64::MIN_POSITIVE));
        // The scale of few points is not known better than they allow.
        let most = (all.len() as f64 - 4.0).max(PRIOR[0]);
        Self { scale, weight: weight.min(most), count: all.len() }
    }

    /// The scale that the others have among themselves.
    fn without(
        self,
        points: &[Vec3<f64>],
        all: &[Option<NeighbourFit>],
        at: usize,
        form: ListForm,
        floor: f64,
    ) -> Self {
        if all.len() > MANY { self } else { Self::of(&without(points, all, at, form), floor) }
    }

    /// A point set against its scale.
    fn judge(&self, seen: NeighbourFit) -> Judged {
        let file = self.scale;
        // If cubics deviate by more than noise, the file's scale has little weight: a sharp turn
        // has a scale of its own. The squares of noise exceed twice their mean in one of twenty
        // neighbourhoods.
        let beyond = (seen.scale * seen.scale / (file * file).max(f64::MIN_POSITIVE) - 2.0) / 2.0;
        let weight = self.weight + (PRIOR[0] - self.weight) * beyond.clamp(0.0, 1.0);
        let usual = threshold(self.count, weight + FREEDOM);
        let squares = weight * file * file + FREEDOM * seen.scale * seen.scale;
        let scale = (squares / (weight + FREEDOM)).sqrt().max(f64::MIN_POSITIVE);
        let least = match (seen.central, seen.inner) {
            (true, _) => usual,
            (false, true) => ASIDE_SCORE,
            (false, false) => END_SCORE,
        };
        let deviation = scale * (1.0 + seen.leverage).sqrt();
        Judged { seen, score: seen.off / scale, least, deviation }
    }
}

/// Predictions of all points with one left out; `all` are those with it.
fn without(
    points: &[Vec3<f64>],
    all: &[Option<NeighbourFit>],
    at: usize,
    form: ListForm,
) -> Vec<Option<NeighbourFit>> {
    let n = points.len();
    let mut left = points.to_vec();
    left.remove(at);
    (0..n)
        .filter(|&i| i != at)
        .map(|i| {
            if window(i, n, SIDE, form.closed).0.contains(&at) {
                seen(&left, i - usize::from(i > at), SIDE, form)
            } else {
                all[i]
            }
        })
        .collect()
}

/// The clearest wrong digit of a list.
///
/// One point is among the neighbours of ten, and of all in a short list: it is set against the scale
/// that the others have among themselves.
fn clearest(points: &[Vec3<f64>], form: ListForm, floor: f64) -> Option<(usize, Judged)> {
    let n = points.len();
    let all = fits(points, form);
    let file = FileScale::of(&all, floor);
    let judged = || (0..n).filter_map(|i| Some((i, all[i].filter(|s| s.judged)?)));
    let own = |s: &NeighbourFit| s.off / s.scale.max(floor).max(f64::MIN_POSITIVE);
    let mut picked = largest(judged().map(|(i, s)| (i, own(&s))), CANDIDATES[0]);
    picked.extend(largest(judged().map(|(i, s)| (i, file.judge(s).score)), CANDIDATES[1]));
    let scale = |at: usize| file.without(points, &all, at, form, floor);
    picked
        .into_iter()
        .filter_map(|at| {
            let seen_at = all[at]?;
            let judged = scale(at).judge(seen_at);
            let found = judged.score >= judged.least && confirmed(points, at, form, &seen_at);
            found.then_some((at, judged))
        })
        .max_by(|a, b| a.1.score.total_cmp(&b.1.score))
}

/// The places of the largest of some numbers, in falling order; of equal ones the first come first.
fn largest(all: impl Iterator<Item = (usize, f64)>, count: usize) -> Vec<usize> {
    let mut all: Vec<(usize, f64)> = all.collect();
    let falling = |a: &(usize, f64), b: &(usize, f64)| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0));
    if count < all.len() {
        all.select_nth_unstable_by(count, falling);
        all.truncate(count);
    }
    all.sort_by(falling);
    all.into_iter().map(|(at, _)| at).collect()
}

/// Standard deviation of rounding to the common digits of all coordinates: half the step over √3.
pub fn digit_scale(points: &[Vec3<f64>]) -> f64 {
    let size = points.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let whole = |step: f64| {
        points.iter().flat_map(|p| p.to_array()).all(|x| {
            let k = x / step;
            (k - k.round()).abs() <= 1e-6 && k.abs() < 1e15
        })
    };
    for digits in 0..10 {
        let step = 10f64.powi(-digits);
        // Whole numbers beside a large size say nothing about their digits.
        if whole(step) {
            return if step < 0.1 * size { step / 12f64.sqrt() } else { 0.0 };
        }
    }
    0.0
}

/// The points between knuckles, which cubics do not cross, and whether they are a closed list.
fn pieces(n: usize, closed: bool, knuckles: &[DataFinding]) -> Vec<(Vec<usize>, bool)> {
    let mut cuts: Vec<usize> = knuckles.iter().map(DataFinding::index).collect();
    cuts.sort_unstable();
    match (closed, cuts.as_slice()) {
        (true, []) => vec![((0..n).collect(), true)],
        (true, cuts) => (0..cuts.len())
            .map(|k| {
                let (a, b) = (cuts[k], cuts[(k + 1) % cuts.len()]);
                let count = if b > a { b - a } else { b + n - a };
                ((0..=count).map(|i| (a + i) % n).collect(), false)
            })
            .collect(),
        (false, cuts) => {
            let ends: Vec<usize> =
                std::iter::once(0).chain(cuts.iter().copied()).chain([n - 1]).collect();
            ends.windows(2).map(|w| ((w[0]..=w[1]).collect(), false)).collect()
        }
    }
}

/// The wrong digits of a piece, which leave it one by one.
fn wrong_digits(
    points: &[Vec3<f64>],
    own: &mut Vec<usize>,
    form: ListForm,
    floor: f64,
) -> Vec<DataFinding> {
    let mut out = Vec::new();
    while own.len() >= FEWEST && out.len() < MOST {
        let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let found = clearest(&list, form, floor);
        let Some((at, Judged { seen, score, least, deviation })) = found else { break };
        let (index, expected) = (own.remove(at), seen.expected);
        let least = least * deviation;
        out.push(DataFinding::WrongDigit { index, expected, score, least });
    }
    out
}

/// Findings among data: wrong digits first, each group by decreasing score. Wrong digits are
/// reported for at least 12 points, knuckles and order for at least 7.
pub fn data_findings(points: &[Vec3<f64>], closed: bool) -> Vec<DataFinding> {
    let n = points.len();
    let swapped = swapped(points, closed);
    if !swapped.is_empty() {
        // Further findings are determined in the corrected order.
        let mut ordered = points.to_vec();
        swapped.iter().for_each(|&k| ordered.swap(k, (k + 1) % n));
        let said = swapped.iter().map(|&index| DataFinding::Swapped { index });
        return said.chain(ordered_findings(&ordered, closed)).collect();
    }
    ordered_findings(points, closed)
}

fn ordered_findings(points: &[Vec3<f64>], closed: bool) -> Vec<DataFinding> {
    let n = points.len();
    if n < SHORT[0] {
        return Vec::new();
    }
    let size = points.iter().map(|p| (*p - points[0]).norm()).fold(0.0, f64::max);
    let floor = digit_scale(points).max(1e-12 * size);
    let form = ListForm::of(points, closed);
    let knuckles = knuckles(points, form, floor);
    let mut out = Vec::new();
    for (mut own, round) in pieces(n, closed, &knuckles) {
        let form = ListForm { closed: round, ..form };
        out.extend(wrong_digits(points, &mut own, form, floor));
    }
    out.sort_by(|a, b| match (a, b) {
        (DataFinding::WrongDigit { score: a, .. }, DataFinding::WrongDigit { score: b, .. }) => {
            b.total_cmp(a)
        }
        _ => std::cmp::Ordering::Equal,
    });
    out.truncate(MOST);
    out.extend(knuckles);
    out
}

/// For each point, the smallest error that can be found; infinite if the point is not judged.
pub fn detectable(points: &[Vec3<f64>], closed: bool) -> Vec<f64> {
    of_each(points, closed, |j| j.least * j.deviation)
}

/// The expected deviation of each point, from noise and the error of the prediction by its
/// neighbours; infinite for points that are not judged.
pub fn predicted(points: &[Vec3<f64>], closed: bool) -> Vec<f64> {
    of_each(points, closed, |j| j.deviation)
}

/// Each point is judged as in the search: between knuckles, without the wrong digits of higher
/// score, and by the scale of the others.
fn of_each(points: &[Vec3<f64>], closed: bool, what: impl Fn(Judged) -> f64) -> Vec<f64> {
    let n = points.len();
    let mut out = vec![f64::INFINITY; n];
    if n < FEWEST {
        return out;
    }
    let size = points.iter().map(|p| (*p - points[0]).norm()).fold(0.0, f64::max);
    let floor = digit_scale(points).max(1e-12 * size);
    let whole_form = ListForm::of(points, closed);
    for (mut own, round) in pieces(n, closed, &knuckles(points, whole_form, floor)) {
        let form = ListForm { closed: round, ..whole_form };
        if own.len() < FEWEST {
            continue;
        }
        let whole = own.clone();
        let wrong: Vec<usize> =
            wrong_digits(points, &mut own, form, floor).iter().map(DataFinding::index).collect();
        let list: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let all = fits(&list, form);
        let file = FileScale::of(&all, floor);
        for (at, &i) in own.iter().enumerate() {
            if let Some(seen) = all[at].filter(|s| s.judged) {
                let scale = file.without(&list, &all, at, form, floor);
                out[i] = out[i].min(what(scale.judge(seen)));
            }
        }
        for &i in &wrong {
            let with: Vec<usize> =
                whole.iter().copied().filter(|k| *k == i || !wrong.contains(k)).collect();
            let list: Vec<Vec3<f64>> = with.iter().map(|&k| points[k]).collect();
            let at = with.iter().position(|&k| k == i).unwrap_or(0);
            if let Some(own) = seen(&list, at, SIDE, form).filter(|s| s.judged) {
                out[i] = what(file.judge(own));
            }
        }
    }
    out
}

/// Points on each side of a hinge.
const HINGE_SIDE: usize = 4;

/// A cubic through a point's neighbours that may turn at the point.
struct Hinge {
    index: usize,
    size: f64,
    scale: f64,
    factor: f64,
    angle: f64,
    straight: bool,
    /// Its turn over the largest beside it.
    sharpness: f64,
    /// True if the turns beside it grow towards it, as at a nose.
    led: bool,
    turn: f64,
}

impl Hinge {
    /// `None`: coincident points.
    fn at(index: usize, points: &[Vec3<f64>]) -> Option<Self> {
        const HALF: usize = HINGE_SIDE;
        let n = points.len();
        let near: Vec<Vec3<f64>> =
            (0..=2 * HALF).map(|k| points[(index + n + k - HALF) % n]).collect();
        let mut chord = vec![0.0];
        for w in near.windows(2) {
            chord.push(chord.last()? + (w[1] - w[0]).norm());
        }
        let half = 0.5 * chord[2 * HALF];
        let t: Vec<f64> = chord.iter().map(|c| (c - chord[HALF]) / half).collect();
        let row = |x: f64| [1.0, x, x * x, x * x * x, x.max(0.0)];
        let columns = ThinQr::new(t.iter().map(|&x| row(x)).collect())?;
        let c = columns.solve(&near);
        let smooth = [c[0], c[1], c[2], c[3]];
        let square = |(q, &x): (&Vec3<f64>, &f64)| {
            let [at, d, _] = cubic(&smooth, x);
            let (at, d) = (at + c[4] * x.max(0.0), d + c[4] * if x > 0.0 { 1.0 } else { 0.0 });
            let v = *q - at;
            (v - d * (v.dot(d) / d.norm_sq().max(f64::MIN_POSITIVE))).norm_sq()
        };
        let squares: f64 = near.iter().zip(&t).map(square).sum();
        let d = c[1] + c[4] * 0.5;
        let speed = d.norm();
        let normal = c[4] - d * (c[4].dot(d) / (speed * speed));
        let turn = |k: usize| {
            let (u, v) = (near[k] - near[k - 1], near[k + 1] - near[k]);
            moldloft_num::Real::atan2(u.cross(v).norm(), u.dot(v))
        };
        let turns: Vec<f64> = (1..2 * HALF).map(turn).collect();
        let own = turns[HALF - 1];
        let others = || turns.iter().enumerate().filter(|(k, _)| *k != HALF - 1).map(|(_, t)| *t);
        let beside = turns[HALF - 2].min(turns[HALF]);
        let farther = turns[..HALF - 2].iter().chain(&turns[HALF + 1..]);
        Some(Self {
            index,
            size: normal.norm(),
            scale: (squares / 4.0).sqrt(),
            factor: 1.0 / columns.r[4][4],
            angle: moldloft_num::Real::atan2(normal.norm(), speed),
            straight: others().all(|t| t < 0.02),
            sharpness: own / others().fold(f64::MIN_POSITIVE, f64::max),
            led: beside > 0.02 && beside > 1.3 * farther.fold(0.0, |m: f64, &t| m.max(t)),
            turn: own,
        })
    }

    /// True for the strong turn of a smooth nose.
    fn is_nose(&self) -> bool {
        self.angle > LARGEST_TURN
            && !self.straight
            && (self.sharpness < STANDS_OUT || self.led || self.turn > DOUBLES_BACK)
    }

    /// True if it is the wrong digit of the point or a neighbour: leaving that out cures it. A wrong
    /// digit turns the polygon half as much beside it, at any spacing.
    fn is_digit(&self, points: &[Vec3<f64>], form: ListForm, file: f64) -> bool {
        let closed = form.closed;
        let n = points.len();
        let cures = |gone: usize| {
            if !closed && (gone < 2 || gone + 2 >= n) {
                return false;
            }
            let left: Vec<Vec3<f64>> = (0..n).filter(|&j| j != gone).map(|j| points[j]).collect();
            let m = left.len();
            let near = (0..8).map(|k| (gone + m + k - 4) % m);
            let seen = near.filter_map(|j| seen(&left, j, SIDE, form)).filter(|s| s.judged);
            // Beside a break the neighbours' own scale is large: the file's decides.
            let off = seen.map(|s| s.off / shrunk(file, s.scale, 6.0).min(3.0 * file));
            off.fold(0.0, f64::max) < CURED
        };
        self.sharpness < STANDS_OUT
            && [self.index, (self.index + 1) % n, (self.index + n - 1) % n].into_iter().any(cures)
    }
}

/// An own scale of `freedom` degrees, shrunk towards that of the file.
fn shrunk(file: f64, own: f64, freedom: f64) -> f64 {
    ((PRIOR[0] * file * file + freedom * own * own) / (PRIOR[0] + freedom)).sqrt()
}

/// Points at which a cubic through the neighbours wants a hinge.
fn knuckles(points: &[Vec3<f64>], form: ListForm, floor: f64) -> Vec<DataFinding> {
    let (n, closed) = (points.len(), form.closed);
    if form.dense {
        return Vec::new();
    }
    if !closed && n <= SHORT[1] {
        return short_knuckles(points, floor);
    }
    if n < 2 * HINGE_SIDE + 1 {
        return Vec::new();
    }
    let range = if closed { 0..n } else { HINGE_SIDE..n - HINGE_SIDE };
    let all: Vec<Hinge> = range.filter_map(|i| Hinge::at(i, points)).collect();
    let file = (1.4826 * median(all.iter().map(|h| h.scale).collect()) / 1.2).max(floor);
    let finding = |h: &Hinge| {
        let score = h.size / (shrunk(file, h.scale, 3.0) * h.factor);
        let smooth = score <= KNUCKLE_SCORE || h.sharpness <= 2.0 || h.is_nose();
        (!smooth && !h.is_digit(points, form, file)).then_some(DataFinding::Knuckle {
            index: h.index,
            angle: h.angle,
            score,
        })
    };
    all.iter().filter_map(finding).collect()
}
