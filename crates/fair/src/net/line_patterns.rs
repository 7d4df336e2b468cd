//! The fewest changes of curvature that a line of offsets has within its tolerances.

/// Fraction of the tolerances within which a pattern of signs must fit: with the whole of them true
/// bends of that size would vanish.
const FITS: f64 = 0.8;

/// Multiple of the tolerances within which a list without a change is sought: conditions may leave
/// one that its own tolerances would not.
const WIDEST: f64 = 2.0;

/// Halvings in the search for the least fraction of the tolerances at which a number of changes
/// fits.
const HALVINGS: usize = 30;

/// The most changes that are looked for.
const MOST_CHANGES: usize = 6;

/// Numbers at increasing parameters, each with a tolerance.
pub(super) struct ValueTube<'a> {
    pub at: &'a [f64],
    pub values: &'a [f64],
    pub rooms: &'a [f64],
}

impl ValueTube<'_> {
    fn low(&self, i: usize, share: f64) -> f64 {
        self.values[i] - share * self.rooms[i]
    }

    fn high(&self, i: usize, share: f64) -> f64 {
        self.values[i] + share * self.rooms[i]
    }

    /// The least last values of convex lists that begin at place `a`, at most at `begin`, within a share
    /// of the rooms: one for each end from `a + 1` on, until none fits. With `sign` -1 all is upside
    /// down.
    fn least_ends(&self, a: usize, begin: f64, sign: f64, share: f64) -> Vec<f64> {
        let low = |i: usize| if sign > 0.0 { self.low(i, share) } else { -self.high(i, share) };
        let high = |i: usize| {
            let own = if sign > 0.0 { self.high(i, share) } else { -self.low(i, share) };
            if i == a { own.min(begin) } else { own }
        };
        let slope = |i: usize, j: usize| (low(j) - high(i)) / (self.at[j] - self.at[i]);
        // A convex list stays above the line on from two of its points, the first at its highest
        // and the second at its lowest: of lines on from one point the steepest is the highest.
        let mut steepest: Vec<f64> = Vec::new();
        let mut out = Vec::new();
        for b in a + 1..self.at.len() {
            let on = |(j, s): (usize, &f64)| low(j) + s * (self.at[b] - self.at[j]);
            let least = (a + 1..b).zip(&steepest).map(on).fold(low(b), f64::max);
            if low(b - 1) > high(b - 1) || least > high(b) {
                break;
            }
            out.push(least);
            steepest.push((a..b).map(|i| slope(i, b)).fold(f64::NEG_INFINITY, f64::max));
        }
        out
    }

    /// The signs of the second differences at the inner points of a list with so many changes that
    /// fits within a share of the rooms: 0 where the sign changes. None where there is none.
    fn pattern(&self, changes: usize, share: f64) -> Option<Vec<f64>> {
        [1.0, -1.0].into_iter().find_map(|first| self.pattern_from(first, changes, share))
    }

    /// The same beginning with a sign.
    fn pattern_from(&self, first: f64, changes: usize, share: f64) -> Option<Vec<f64>> {
        let last = self.at.len() - 1;
        // Of each end of a part the most room that is left to the next, and where that part
        // begins.
        let mut ends: Vec<Vec<Option<(f64, usize)>>> = Vec::new();
        let start = if first > 0.0 { self.high(0, share) } else { -self.low(0, share) };
        let mut before: Vec<Option<(f64, usize)>> = vec![None; last + 1];
        before[0] = Some((start, 0));
        let mut sign = first;
        for part in 0..=changes {
            let mut next: Vec<Option<(f64, usize)>> = vec![None; last + 1];
            for a in part..last {
                let Some((begin, _)) = before[a] else { continue };
                for (b, end) in (a + 1..).zip(self.least_ends(a, begin, sign, share)) {
                    let ends = (part == changes) == (b == last);
                    if ends && next[b].is_none_or(|n| end < n.0) {
                        next[b] = Some((end, a));
                    }
                }
            }
            // The next part is upside down: the least end is its highest begin.
            before = next.iter().map(|n| n.map(|(end, a)| (-end, a))).collect();
            ends.push(next);
            sign = -sign;
        }
        ends[changes][last]?;
        let mut signs = vec![0.0; last + 1];
        let (mut b, mut sign) = (last, if changes.is_multiple_of(2) { first } else { -first });
        for part in (0..=changes).rev() {
            let a = ends[part][b]?.1;
            signs[a + 1..b].fill(sign);
            (b, sign) = (a, -sign);
        }
        Some(signs[1..last].to_vec())
    }

    /// The sign of the second differences of a list without a change that fits within the smaller share
    /// of the rooms; none where neither does within twice of them.
    pub fn bulge(&self) -> Option<f64> {
        let share = |sign: f64| {
            self.pattern_from(sign, 0, WIDEST)?;
            let (mut low, mut high) = (0.0, WIDEST);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                match self.pattern_from(sign, 0, middle) {
                    Some(_) => high = middle,
                    None => low = middle,
                }
            }
            Some(high)
        };
        match (share(1.0), share(-1.0)) {
            (Some(up), Some(down)) => Some(if up <= down { 1.0 } else { -1.0 }),
            (Some(_), None) => Some(1.0),
            (None, Some(_)) => Some(-1.0),
            (None, None) => None,
        }
    }

    /// The signs of the fewest changes that fit, and of these the ones that fit nearest.
    pub fn fewest(&self) -> Option<Vec<f64>> {
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

    #[test]
    fn ends_of_convex_lists_are_those_of_all_lines_on() {
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..200 {
            let mut t = 0.0;
            let mut place = || {
                t += 0.2 + random();
                [t, 0.1 * t * t + 0.8 * random(), 0.6 * random()]
            };
            let all: Vec<[f64; 3]> = (0..9).map(|_| place()).collect();
            let [at, values, rooms]: [Vec<f64>; 3] =
                std::array::from_fn(|c| all.iter().map(|p| p[c]).collect());
            let tube = ValueTube { at: &at, values: &values, rooms: &rooms };
            let most = |k: usize| if k == 0 { 0.5 } else { f64::INFINITY };
            let high = |k: usize| tube.high(k, 1.0).min(most(k));
            let line = |i: usize, j: usize, k: usize| {
                let slope = (tube.low(j, 1.0) - high(i)) / (at[j] - at[i]);
                tube.low(j, 1.0) + slope * (at[k] - at[j])
            };
            let least = |b: usize| {
                let pairs = (0..b).flat_map(|j| (0..j).map(move |i| (i, j)));
                pairs.map(|(i, j)| line(i, j, b)).fold(tube.low(b, 1.0), f64::max)
            };
            let fits = |b: &usize| (0..=*b).all(|k| tube.low(k, 1.0).max(least(k)) <= high(k));
            let expected: Vec<f64> = (1..9).take_while(fits).map(least).collect();
            assert_eq!(tube.least_ends(0, 0.5, 1.0, 1.0), expected);
        }
    }
}
