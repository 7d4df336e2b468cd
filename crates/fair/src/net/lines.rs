//! Networks line by line: each curve weighed by itself, with no more changes of curvature than its
//! points ask for.
//!
//! The sum of a measure over all curves is nearly all that of a few hard spots, so that these would
//! decide for all. Each curve counts by what it has left of its own measure instead. And third
//! differences buy smoothness with a bend: the signs of second divided differences are held, those
//! of the fewest changes that fit within the tolerance.

use crate::optimum::ControlInequality;
use crate::optimum::Parts;
use crate::{FairError, Motion, Network, RowNorm, SparseRows};
use moldloft_num::Vec3;

/// The share of the tolerances within which a pattern of signs fits: at the whole of them true
/// bends of their size would go.
const FITS: f64 = 0.8;

/// Halvings of the search for the least share of the tolerances at which a number of changes fits.
const HALVINGS: usize = 30;

/// The most changes that are looked for, and the fewest points of a line that has any.
const MOST_CHANGES: usize = 6;
const FEWEST_POINTS: usize = 5;

/// The share of the measure that noise of the tolerances has below which lines are alike.
const ALIKE: f64 = 1e-3;

/// Rounds of weights.
const ROUNDS: usize = 3;

/// Budgets, in the goal's own, that are tried where signs leave none within it.
const WIDER: [f64; 3] = [1.0, 1.5, f64::INFINITY];

/// Numbers at rising places with room on both sides.
struct ValueTube<'a> {
    at: &'a [f64],
    values: &'a [f64],
    rooms: &'a [f64],
}

impl ValueTube<'_> {
    fn low(&self, i: usize, share: f64) -> f64 {
        self.values[i] - share * self.rooms[i]
    }

    fn high(&self, i: usize, share: f64) -> f64 {
        self.values[i] + share * self.rooms[i]
    }

    /// The least last value of a convex list from `a` to `b` that begins at most at `begin`, within
    /// a share of the rooms; none where there is no such list. With `sign` -1 all is upside down.
    fn least_end(&self, [a, b]: [usize; 2], begin: f64, sign: f64, share: f64) -> Option<f64> {
        let low = |i: usize| if sign > 0.0 { self.low(i, share) } else { -self.high(i, share) };
        let high = |i: usize| {
            let own = if sign > 0.0 { self.high(i, share) } else { -self.low(i, share) };
            if i == a { own.min(begin) } else { own }
        };
        // What is convex stays above the line on from two of its points, the first at its highest
        // and the second at its lowest; a bound of that on the points between is what makes it fit.
        let mut least = low(b);
        for i in a..b {
            if low(i) > high(i) {
                return None;
            }
            for j in i + 1..b {
                let slope = (low(j) - high(i)) / (self.at[j] - self.at[i]);
                for k in j + 1..=b {
                    let on = low(j) + slope * (self.at[k] - self.at[j]);
                    if k == b {
                        least = least.max(on);
                    } else if on > high(k) {
                        return None;
                    }
                }
            }
        }
        (least <= high(b)).then_some(least)
    }

    /// The signs of the second differences at the inner points of a list with so many changes that
    /// fits within a share of the rooms: 0 where the sign changes. None where there is none.
    fn pattern(&self, changes: usize, share: f64) -> Option<Vec<f64>> {
        let last = self.at.len() - 1;
        for first in [1.0, -1.0] {
            // Of each end of a part the most room that is left to the next, and where that part
            // begins.
            let mut ends: Vec<Vec<Option<(f64, usize)>>> = Vec::new();
            let start = if first > 0.0 { self.high(0, share) } else { -self.low(0, share) };
            let mut before: Vec<Option<(f64, usize)>> = vec![None; last + 1];
            before[0] = Some((start, 0));
            let mut sign = first;
            for part in 0..=changes {
                let mut next: Vec<Option<(f64, usize)>> = vec![None; last + 1];
                for b in part + 1..=last {
                    if (part == changes) != (b == last) {
                        continue;
                    }
                    for a in part..b {
                        let Some((begin, _)) = before[a] else { continue };
                        let Some(end) = self.least_end([a, b], begin, sign, share) else {
                            continue;
                        };
                        if next[b].is_none_or(|n| end < n.0) {
                            next[b] = Some((end, a));
                        }
                    }
                }
                // The next part is upside down: the least end is its highest begin.
                before = next.iter().map(|n| n.map(|(end, a)| (-end, a))).collect();
                ends.push(next);
                sign = -sign;
            }
            if ends[changes][last].is_none() {
                continue;
            }
            let mut signs = vec![0.0; last + 1];
            let (mut b, mut sign) = (last, if changes.is_multiple_of(2) { first } else { -first });
            for part in (0..=changes).rev() {
                let a = ends[part][b]?.1;
                signs[a + 1..b].fill(sign);
                (b, sign) = (a, -sign);
            }
            return Some(signs[1..last].to_vec());
        }
        None
    }

    /// The signs of the fewest changes that fit, and of these the ones that fit nearest.
    fn fewest(&self) -> Option<Vec<f64>> {
        let most = MOST_CHANGES.min(self.at.len().saturating_sub(3));
        let (changes, mut best) = (0..=most)
            .find_map(|changes| self.pattern(changes, FITS).map(|signs| (changes, signs)))?;
        let (mut low, mut high) = (0.0, FITS);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.pattern(changes, middle) {
                Some(signs) => (high, best) = (middle, signs),
                None => low = middle,
            }
        }
        Some(best)
    }
}

/// A network faired line by line.
pub(super) struct LineOptimum {
    pub optimum: crate::Optimum,
    /// The weight of the squares beside it.
    pub weight: f64,
}

impl Network {
    /// Whether it is one of curves through points, which have measures of their own.
    pub(super) fn has_lines(&self, norm: RowNorm) -> bool {
        self.patches.is_empty()
            && norm == RowNorm::Square
            && self.strands.iter().all(|s| s.at.is_some() && s.weights.is_none())
    }

    /// The direction in which points move, where it is one.
    fn way(&self) -> Option<Vec3<f64>> {
        match self.limit.motion {
            Motion::Along(d) => Some(d),
            _ => None,
        }
    }

    /// The measure of a line, in the directions in which points move.
    fn line_value(&self, rows: &SparseRows, points: &[Vec3<f64>]) -> f64 {
        let square = |k: usize| {
            let e = rows.apply(k, points);
            self.way().map_or_else(|| e.norm_sq(), |d| d.dot(e).powi(2))
        };
        (0..rows.len()).map(square).sum()
    }

    /// The squares that noise of the tolerances has in a line's measure.
    fn line_noise(&self, rows: &SparseRows, frozen: &[bool]) -> f64 {
        let square = |k: usize| {
            let (columns, factors) = rows.row(k);
            let own = columns.iter().zip(factors).map(|(&c, f)| {
                let radius = self.limit.radii[c as usize];
                let moves = !frozen[c as usize] && radius.is_finite();
                if moves { (f * radius).powi(2) } else { 0.0 }
            });
            own.sum::<f64>()
        };
        (0..rows.len()).map(square).sum::<f64>() / 3.0
    }

    /// The signs of second differences that line `k` keeps, as half-spaces.
    fn line_signs(&self, k: usize, frozen: &[bool]) -> Vec<ControlInequality> {
        let (strand, Some(way)) = (&self.strands[k], self.way()) else { return Vec::new() };
        let Some(at) = strand.at.as_ref().filter(|_| !strand.space.is_closed()) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut bounds = vec![0];
        bounds.extend(strand.marks.iter().copied());
        bounds.push(strand.points.len() - 1);
        bounds.sort_unstable();
        bounds.dedup();
        for pair in bounds.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if to - from + 1 < FEWEST_POINTS {
                continue;
            }
            let own = &strand.points[from..=to];
            let values: Vec<f64> = own.iter().map(|&i| way.dot(self.points[i])).collect();
            let room = |&i: &usize| if frozen[i] { 0.0 } else { self.limit.radii[i] };
            let rooms: Vec<f64> = own.iter().map(room).collect();
            if rooms.iter().any(|r| !r.is_finite()) || rooms.iter().all(|&r| r == 0.0) {
                continue;
            }
            let tube = ValueTube { at: &at[from..=to], values: &values, rooms: &rooms };
            for (j, sign) in tube.fewest().into_iter().flatten().enumerate() {
                if sign == 0.0 {
                    continue;
                }
                let t = &at[from + j..from + j + 3];
                let (h, g) = (t[1] - t[0], t[2] - t[1]);
                let factors = [1.0 / h, -1.0 / h - 1.0 / g, 1.0 / g].map(|f| f * h.min(g));
                let ids = &own[j..j + 3];
                if ids.iter().all(|&i| frozen[i]) {
                    continue;
                }
                let entries = ids.iter().zip(factors).map(|(&i, f)| (i, way * (-sign * f)));
                // Against rounding of exact runs.
                let size = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                let most = 16.0 * f64::EPSILON * size;
                out.push(ControlInequality { entries: entries.collect(), most, owner: k });
            }
        }
        out
    }

    /// The optimum of the weighed measure under a budget of the squares and signs.
    pub(super) fn by_lines(
        &self,
        parts: &mut Parts<'_>,
        measure: crate::Measure,
        pull: &SparseRows,
        most: f64,
    ) -> Result<LineOptimum, FairError> {
        let count = self.strands.len();
        let own: Vec<SparseRows> =
            (0..count).map(|k| self.own_rows(k, measure)).collect::<Result<_, _>>()?;
        let floors: Vec<f64> =
            own.iter().map(|rows| ALIKE * self.line_noise(rows, &parts.frozen)).collect();
        let mut signs: Vec<Vec<ControlInequality>> =
            (0..count).map(|k| self.line_signs(k, &parts.frozen)).collect();
        let mut points = self.points.clone();
        let whole: f64 = own.iter().map(|rows| self.line_value(rows, &points)).sum();
        let mut found = None;
        for _ in 0..ROUNDS {
            let left = |k: usize| self.line_value(&own[k], &points).max(floors[k]);
            let weights: Vec<f64> = (0..count)
                .map(|k| whole / (count as f64 * left(k).max(f64::MIN_POSITIVE)))
                .collect();
            let mut rows = SparseRows::new();
            for (own, weight) in own.iter().zip(&weights) {
                rows = rows.joined(&own.clone().scaled(weight.sqrt()));
            }
            parts.measure = rows;
            let optimum = self.under_signs(parts, &mut signs, pull, most)?;
            points.clone_from(&optimum.0.points);
            found = Some(LineOptimum { optimum: optimum.0, weight: optimum.1 });
        }
        Ok(found.expect("there are rounds"))
    }

    /// The same at weights: signs of lines that contradict others are given up, and then the
    /// budget.
    fn under_signs(
        &self,
        parts: &mut Parts<'_>,
        signs: &mut [Vec<ControlInequality>],
        pull: &SparseRows,
        most: f64,
    ) -> Result<(crate::Optimum, f64), FairError> {
        loop {
            parts.halves = signs.iter().flatten().cloned().collect();
            let mut refused = Vec::new();
            for wider in WIDER {
                let most = wider * most;
                let made = if most.is_finite() { parts.within(pull, most) } else { Ok(None) };
                match made {
                    Ok(Some(found)) => return Ok((found.optimum, found.weight)),
                    Ok(None) => match parts.solve() {
                        Ok(fairest) => {
                            let away: Vec<Vec3<f64>> = fairest
                                .points
                                .iter()
                                .zip(&self.points)
                                .map(|(p, q)| *p - *q)
                                .collect();
                            if pull.sum_sq(&away) <= most {
                                return Ok((fairest, 0.0));
                            }
                        }
                        Err(FairError::Shape { shapes, .. }) => refused = shapes,
                        Err(other) => return Err(other),
                    },
                    Err(FairError::Shape { .. }) => {}
                    Err(other) => return Err(other),
                }
                if !refused.is_empty() {
                    break;
                }
            }
            let before: usize = signs.iter().map(Vec::len).sum();
            for k in refused {
                signs[k].clear();
            }
            if signs.iter().map(Vec::len).sum::<usize>() == before {
                // What contradicts what is not known: none is held.
                signs.iter_mut().for_each(Vec::clear);
                if before == 0 {
                    parts.halves.clear();
                    return Ok((parts.solve()?, 0.0));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(signs: &[f64]) -> usize {
        let held: Vec<f64> = signs.iter().copied().filter(|s| *s != 0.0).collect();
        held.windows(2).filter(|w| w[0] != w[1]).count()
    }

    fn signs_of(of: impl Fn(f64) -> f64, noise: f64) -> Vec<f64> {
        let at: Vec<f64> =
            [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.5, 9.0].to_vec();
        let off = |k: usize| noise * ((k * k * 7919 % 1009) as f64 / 504.5 - 1.0);
        let values: Vec<f64> = at.iter().enumerate().map(|(k, &x)| of(x) + off(k)).collect();
        let rooms = vec![noise.max(1e-9) / FITS; at.len()];
        ValueTube { at: &at, values: &values, rooms: &rooms }.fewest().unwrap()
    }

    #[test]
    fn patterns_have_the_fewest_changes() {
        for noise in [0.0, 0.02] {
            assert_eq!(changes(&signs_of(|x| 0.1 * x * x, noise)), 0);
            assert_eq!(changes(&signs_of(|x| -(x - 3.0) * (x - 3.0) * 0.2, noise)), 0);
            assert_eq!(changes(&signs_of(|x| 0.02 * (x - 4.5).powi(3), noise)), 1);
            assert_eq!(changes(&signs_of(|x| (x * 0.9).sin(), noise)), 2);
        }
        let held = signs_of(|x| 0.02 * (x - 4.5).powi(3), 0.0);
        assert!(held[0] < 0.0 && held[held.len() - 1] > 0.0, "{held:?}");
    }
}
