//! Types of lines from strokes: probability of each axis, given the noise of the ends.
//!
//! An end that is off by σ in each coordinate lets a line of an axis miss it by √2 σ at right angles,
//! whatever its length, so short lines tell little and long ones much. Lines that are parallel in space,
//! because two lines of one axis join their ends, are judged together: m of them tell √m times as much.

use crate::{CoordinateAxis, DOUBTFUL, Drawing, LineId, PointId};
use moldloft_num::Real;
use moldloft_num::union_find::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// Prior fraction of lines along an axis.
pub(super) const PRINCIPAL: f64 = 0.85;

/// Weight of the prior, in lines of a drawing.
const USUAL_LINES: f64 = 6.0;

/// Probability from which a line counts as certainly typed.
const SURE: f64 = 0.9;

/// Noise of a steady hand, relative to the longest line, and its weight in lines.
const STEADY: f64 = 2e-3;
const STEADY_LINES: f64 = 2.0;

/// Limits of the noise, relative to the longest line.
const LEAST: f64 = 1.2e-3;
const MOST: f64 = 0.02;

/// Strokes that differ by more than this multiple of their noise are not parallel, whatever is
/// connected to their ends.
const APART: f64 = 3.5;

/// Reduction of the odds of a line along an axis, as a logarithm, if the opposite side of its face
/// is inclined: most tapered bodies taper on all sides.
const TAPER: f64 = 2.5;

/// Standard deviation of the direction in which a hand draws an axis, in radians, and the most by
/// which it is taken to be off.
const AXIS_TURN: f64 = 0.03;
const MOST_TURN: f64 = 0.09;

/// Parallel lines whose direction differs from that of the others along their axis by more than this
/// multiple of the noise have at most this probability.
const APART_FROM_AXIS: f64 = 3.0;
const STANDS_OUT: f64 = DOUBTFUL - 0.01;

/// Odds that an axis is drawn otherwise than stated.
const TURNED_ODDS: f64 = 0.03;

/// Directions at which an inclined line is tried.
const DIRECTIONS: usize = 720;

/// Evidence of the strokes about a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// The likeliest axis, `None` when it is likelier inclined.
    pub axis: Option<CoordinateAxis>,
    /// Probability of that answer.
    pub share: f64,
    /// The lines that were judged together have one number.
    pub group: usize,
    /// Probability of the axis by this line alone.
    pub alone: f64,
    /// Probability of each axis by the strokes.
    pub axes: [f64; 3],
}

/// A line as it is judged.
pub(super) struct Stroke {
    pub id: LineId,
    ends: [PointId; 2],
    pub d: [f64; 2],
    pub length: f64,
}

/// The axes as a hand drew them, the noise of its pen, and what each stroke shows by itself.
pub(super) struct PenFit {
    /// The axes as they are stated.
    given: Vec<(CoordinateAxis, [f64; 2])>,
    pub axes: Vec<(CoordinateAxis, [f64; 2])>,
    /// Standard deviation of a coordinate of an end.
    pub sigma: f64,
    /// Fraction of lines along an axis.
    usual: f64,
    alone: Vec<Verdict>,
}

impl PenFit {
    /// True if parallel strokes differ in direction from all others along their axis.
    fn stands_out(
        &self,
        own: &[&Stroke],
        strokes: &[Stroke],
        axis: Option<CoordinateAxis>,
    ) -> bool {
        let Some((_, unit)) = self.given.iter().find(|a| Some(a.0) == axis) else { return false };
        let others = (strokes.iter().zip(&self.alone))
            .filter(|(s, v)| v.axis == axis && own.iter().all(|o| o.id != s.id))
            .map(|(s, v)| (s, v.share));
        let [sum, weight] = turn_of(*unit, others, self.sigma);
        let weight = weight + 1.0 / AXIS_TURN.powi(2);
        let [own_sum, own_weight] = turn_of(*unit, own.iter().map(|s| (*s, 1.0)), self.sigma);
        let apart = sum / weight - own_sum / own_weight;
        apart * apart > APART_FROM_AXIS.powi(2) * (1.0 / weight + 1.0 / own_weight)
    }
}

impl Drawing {
    pub(super) fn strokes(&self) -> Vec<Stroke> {
        (self.lines.iter())
            .map(|(&id, line)| {
                let d = self.stroke(line);
                let length = Real::sqrt(d[0] * d[0] + d[1] * d[1]);
                Stroke { id, ends: [line.p, line.q], d, length }
            })
            .filter(|s| s.length > 0.0)
            .collect()
    }

    pub(super) fn pen_fit(&self, strokes: &[Stroke]) -> PenFit {
        let given: Vec<(CoordinateAxis, [f64; 2])> = (CoordinateAxis::ALL.into_iter())
            .filter(|a| self.section != Some(*a))
            .filter_map(|a| {
                let [x, y] = self.projection.unit(a);
                let length = Real::sqrt(x * x + y * y);
                (length > 0.0).then(|| (a, [x / length, y / length]))
            })
            .collect();
        let mut axes = given.clone();
        let mut sigma = self.pen_noise(strokes, &axes);
        let size = strokes.iter().map(|s| s.length).fold(0.0, f64::max);
        // The fraction of lines along an axis varies between drawings: the drawing's own, starting
        // from the prior.
        let mut usual = PRINCIPAL;
        let mut alone: Vec<Verdict> = Vec::new();
        for _ in 0..3 {
            alone = strokes.iter().map(|s| judge(&[s], &axes, sigma, usual)).collect();
            let along = |v: &Verdict| if v.axis.is_some() { v.share } else { 1.0 - v.share };
            let sum = alone.iter().map(along).sum::<f64>() + USUAL_LINES * PRINCIPAL;
            usual = sum / (alone.len() as f64 + USUAL_LINES);
            axes = drawn_axes(&given, strokes, &alone, sigma);
            // The noise by all lines that are likely along an axis.
            let (mut squares, mut weight) = (STEADY_LINES * (STEADY * size).powi(2), STEADY_LINES);
            for (v, s) in alone.iter().zip(strokes) {
                let Some(axis) = v.axis else { continue };
                let Some((_, unit)) = axes.iter().find(|a| a.0 == axis) else { continue };
                let miss = s.d[0] * unit[1] - s.d[1] * unit[0];
                squares += v.share * miss * miss / 2.0;
                weight += v.share;
            }
            sigma = Real::sqrt(squares / weight).clamp(LEAST * size, MOST * size);
        }
        PenFit { given, axes, sigma, usual, alone }
    }

    /// Standard deviation of a drawn coordinate of an end, in units of the page.
    pub(crate) fn noise_of_hand(&self) -> f64 {
        let strokes = self.strokes();
        if strokes.is_empty() { 0.0 } else { self.pen_fit(&strokes).sigma }
    }

    /// The likeliest type of every line by its stroke and those that are parallel to it in space.
    pub(crate) fn verdicts(&self) -> BTreeMap<LineId, Verdict> {
        let strokes = self.strokes();
        let fit = self.pen_fit(&strokes);
        let PenFit { axes, sigma, usual, alone, .. } = &fit;
        let (sigma, usual) = (*sigma, *usual);
        // The lines beside each point, with their verdicts.
        let mut at: BTreeMap<PointId, Vec<usize>> = BTreeMap::new();
        for (k, s) in strokes.iter().enumerate() {
            s.ends.iter().for_each(|&p| at.entry(p).or_default().push(k));
        }
        // The end of a sure line from a point, by axis and sense.
        let leads = |p: PointId| -> Vec<(CoordinateAxis, bool, PointId, usize)> {
            (at.get(&p).into_iter().flatten())
                .filter_map(|&k| {
                    let axis = alone[k].axis.filter(|_| alone[k].share >= SURE)?;
                    let s = &strokes[k];
                    let forward = s.ends[0] == p;
                    let unit = axes.iter().find(|a| a.0 == axis)?.1;
                    let along = s.d[0] * unit[0] + s.d[1] * unit[1] > 0.0;
                    Some((axis, along == forward, s.ends[usize::from(forward)], k))
                })
                .collect()
        };
        let mut group = UnionFind::new(strokes.len());
        // Sides between two lines of one axis that are not parallel.
        let mut mates: Vec<(usize, usize)> = Vec::new();
        for (k, s) in strokes.iter().enumerate() {
            for (axis, sense, far, own) in leads(s.ends[0]) {
                if own == k {
                    continue;
                }
                for (other, turn, end, second) in leads(s.ends[1]) {
                    if second == k || other != axis || turn != sense {
                        continue;
                    }
                    let parallel = at.get(&far).into_iter().flatten().copied().find(|&m| {
                        m != k && strokes[m].ends.contains(&far) && strokes[m].ends.contains(&end)
                    });
                    match parallel {
                        Some(m) if agree(s, &strokes[m], sigma) => group.join(k, m),
                        Some(m) => mates.push((k, m)),
                        None => {}
                    }
                }
            }
        }
        let mut members: BTreeMap<usize, Vec<&Stroke>> = BTreeMap::new();
        for (k, s) in strokes.iter().enumerate() {
            members.entry(group.find(k)).or_default().push(s);
        }
        let index: BTreeMap<LineId, usize> =
            strokes.iter().enumerate().map(|(k, s)| (s.id, k)).collect();
        let mut out = BTreeMap::new();
        for (&group, own) in &members {
            let mut verdict = Verdict { group, ..judge(own, axes, sigma, usual) };
            if fit.stands_out(own, &strokes, verdict.axis) {
                verdict.share = verdict.share.min(STANDS_OUT);
            }
            if let [s] = own[..]
                && verdict.axis.is_some()
            {
                let k = index[&s.id];
                let inclined = |m: usize| alone[m].axis.is_none() && alone[m].share >= SURE;
                let all: BTreeSet<usize> = (mates.iter())
                    .filter_map(|&(a, b)| if a == k { Some(b) } else { (b == k).then_some(a) })
                    .filter(|&m| inclined(m))
                    .collect();
                let odds = verdict.share / (1.0 - verdict.share).max(1e-12);
                let left = odds * Real::exp(-TAPER * all.len() as f64);
                verdict.share = left / (1.0 + left);
                if left < 1.0 {
                    (verdict.axis, verdict.share) = (None, 1.0 - verdict.share);
                }
            }
            for s in own {
                let single = alone[index[&s.id]];
                let share =
                    if single.axis == verdict.axis { single.share } else { 1.0 - single.share };
                out.insert(s.id, Verdict { alone: share, ..verdict });
            }
        }
        out
    }

    /// Standard deviation of a coordinate of an end, from the deviations of lines near an axis.
    pub(super) fn pen_noise(&self, strokes: &[Stroke], axes: &[(CoordinateAxis, [f64; 2])]) -> f64 {
        let size = strokes.iter().map(|s| s.length).fold(0.0, f64::max);
        let mut off: Vec<f64> = (strokes.iter())
            .filter_map(|s| {
                let miss = |a: &[f64; 2]| (s.d[0] * a[1] - s.d[1] * a[0]).abs();
                let least = axes.iter().map(|a| miss(&a.1)).fold(f64::INFINITY, f64::min);
                (least <= 0.12 * s.length).then_some(least)
            })
            .collect();
        off.sort_by(f64::total_cmp);
        let median = off.get(off.len() / 2).copied().unwrap_or(0.0);
        let found = median / 0.6745 / std::f64::consts::SQRT_2;
        // A few exact lines are weak evidence: the noise of a steady hand is included with them.
        let (n, usual) = (off.len() as f64, (STEADY * size).max(found));
        let mean = (n * found * found + STEADY_LINES * usual * usual) / (n + STEADY_LINES);
        Real::sqrt(mean).clamp(LEAST * size, MOST * size)
    }
}

/// The turn from a direction that strokes along one axis show, times its precision, and that precision.
fn turn_of<'a>(
    [x, y]: [f64; 2],
    strokes: impl Iterator<Item = (&'a Stroke, f64)>,
    sigma: f64,
) -> [f64; 2] {
    strokes.fold([0.0; 2], |[sum, weight], (s, share)| {
        let sense = (s.d[0] * x + s.d[1] * y).signum();
        let precision = share / (2.0 * sigma * sigma);
        let turn = sense * (x * s.d[1] - y * s.d[0]) / s.length;
        let own = precision * s.length * s.length;
        [sum + own * turn, weight + own]
    })
}

/// The directions in which a hand drew the axes: the likeliest by the lines along each, and by its
/// stated direction.
fn drawn_axes(
    given: &[(CoordinateAxis, [f64; 2])],
    strokes: &[Stroke],
    verdicts: &[Verdict],
    sigma: f64,
) -> Vec<(CoordinateAxis, [f64; 2])> {
    let turned = |&(axis, [x, y]): &(CoordinateAxis, [f64; 2])| {
        let along = strokes.iter().zip(verdicts).filter(|(_, v)| v.axis == Some(axis));
        let [sum, weight] = turn_of([x, y], along.map(|(s, v)| (s, v.share)), sigma);
        // Either the axis is drawn as stated, or turned: the mean of both.
        let (own, turned) = (1.0 / weight.max(1e-12), AXIS_TURN.powi(2));
        let seen = (sum * own).powi(2) / 2.0;
        let odds = TURNED_ODDS
            * Real::sqrt(own / (own + turned))
            * Real::exp(seen / own - seen / (own + turned));
        let share = if odds.is_finite() { odds / (1.0 + odds) } else { 1.0 };
        let angle = share * sum / (weight + 1.0 / turned);
        let angle = angle.clamp(-MOST_TURN, MOST_TURN);
        let (sin, cos) = (Real::sin(angle), Real::cos(angle));
        (axis, [x * cos - y * sin, x * sin + y * cos])
    };
    given.iter().map(turned).collect()
}

/// True if two strokes may be parallel in space: they are parallel in the picture within the noise
/// of their ends.
fn agree(a: &Stroke, b: &Stroke, sigma: f64) -> bool {
    let across = (a.d[0] * b.d[1] - a.d[1] * b.d[0]).abs();
    let spread = sigma * Real::sqrt(2.0 * (a.length * a.length + b.length * b.length));
    across <= APART * spread
}

/// The likeliest direction of parallel strokes.
fn judge(
    strokes: &[&Stroke],
    axes: &[(CoordinateAxis, [f64; 2])],
    sigma: f64,
    usual: f64,
) -> Verdict {
    let spread = 2.0 * 2.0 * sigma * sigma;
    // Logarithm of the likelihood that all have a direction.
    let fits = |[x, y]: [f64; 2]| -> f64 {
        -strokes.iter().map(|s| (s.d[0] * y - s.d[1] * x).powi(2) / spread).sum::<f64>()
    };
    // A prism of many edges is rarely an oblique one: the more lines are parallel, the likelier an axis is.
    let count = strokes.len() as f64;
    let times = 1.0 + libm::log2(count);
    let [usual, rare] = [usual, 1.0 - usual].map(|p| Real::exp(times * Real::ln(p.max(1e-9))));
    let (usual, rare) = (usual / (usual + rare), rare / (usual + rare));
    let weight = usual / axes.len().max(1) as f64;
    let principal: Vec<f64> = axes.iter().map(|a| weight * Real::exp(fits(a.1))).collect();
    let step = std::f64::consts::PI / DIRECTIONS as f64;
    // The mean over all directions, by the strokes' own one where they leave a narrow peak.
    let own = {
        let sum = strokes.iter().fold([0.0; 2], |m, s| {
            let turn =
                if s.d[0] * strokes[0].d[0] + s.d[1] * strokes[0].d[1] < 0.0 { -1.0 } else { 1.0 };
            [m[0] + turn * s.d[0], m[1] + turn * s.d[1]]
        });
        Real::atan2(sum[1], sum[0])
    };
    let square: f64 = strokes.iter().map(|s| s.length * s.length).sum();
    let width = Real::sqrt(spread / 2.0 / square.max(f64::MIN_POSITIVE));
    let mean = if width > 3.0 * step {
        let at = |k: usize| k as f64 * step;
        let sum: f64 =
            (0..DIRECTIONS).map(|k| Real::exp(fits([Real::cos(at(k)), Real::sin(at(k))]))).sum();
        sum / DIRECTIONS as f64
    } else {
        let peak = Real::exp(fits([Real::cos(own), Real::sin(own)]));
        peak * width * Real::sqrt(2.0 * std::f64::consts::PI) / std::f64::consts::PI
    };
    let free = rare * mean;
    let all = principal.iter().sum::<f64>() + free;
    if all <= 0.0 {
        return Verdict { axis: None, share: 1.0, group: 0, alone: 1.0, axes: [0.0; 3] };
    }
    let mut shares = [0.0; 3];
    for ((axis, _), p) in axes.iter().zip(&principal) {
        shares[axis.index()] = p / all;
    }
    let best = (0..axes.len()).max_by(|&a, &b| principal[a].total_cmp(&principal[b]));
    match best.filter(|&k| principal[k] > free) {
        Some(k) => {
            let (axis, share) = (Some(axes[k].0), principal[k] / all);
            Verdict { axis, share, group: 0, alone: 1.0, axes: shares }
        }
        None => Verdict { axis: None, share: free / all, group: 0, alone: 1.0, axes: shares },
    }
}
