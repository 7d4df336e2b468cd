//! The least change of chosen numbers that brings conditions to zero.
//! Each step solves, with exact derivatives, a linear least-squares problem within the ranges
//! (Stark and Parker, Computational Statistics 10, 1995); a condition weighs `CONDITION` times
//! the change of a number over its whole range. Conditions that can be met within the ranges are
//! met with the convergence of Newton's method; otherwise the result is the closest approach.

/// Weight of a condition relative to the change of a number over its range.
const CONDITION: f64 = 1e5;

/// Residual at which a condition is met, relative to the effect of the numbers over their ranges.
const MET: f64 = 1e-9;

/// Step, relative to the ranges, that ends the search.
const SMALL_STEP: f64 = 1e-9;

/// Step, relative to the ranges, that ends the search once the conditions are met: the change would
/// decrease no further.
const SMALL_GAIN: f64 = 1e-3;

/// Maximum number of halvings of a step.
const HALVINGS: usize = 10;

/// Maximum number of steps that only reduce the change, once the conditions are met.
const LESSENING: usize = 4;

/// A number that may change.
#[derive(Clone, Debug)]
pub struct FollowingNumber {
    /// The value from which changes are measured.
    pub home: f64,
    /// The least and the largest value.
    pub range: Option<(f64, f64)>,
    /// Weight of its change.
    pub weight: f64,
}

impl FollowingNumber {
    /// The change with weight one.
    fn size(&self) -> f64 {
        match self.range {
            Some((low, high)) if high > low => high - low,
            _ if self.home != 0.0 => self.home.abs(),
            _ => 1.0,
        }
    }
}

/// Effect of the numbers on the conditions.
pub trait Conditions {
    /// Sets the numbers to `x` and returns the conditions, which are to be zero.
    ///
    /// # Errors
    /// The reason why they cannot be evaluated.
    fn at(&mut self, x: &[f64]) -> Result<Vec<f64>, String>;

    /// The derivatives at the last values: `[condition][number]`.
    ///
    /// # Errors
    /// The reason why they cannot be evaluated.
    fn slopes(&mut self) -> Result<Vec<Vec<f64>>, String>;
}

/// Options of a search.
#[derive(Clone, Copy, Debug)]
pub struct FollowSearch<'a> {
    /// Weight of each condition: if not all can be met, those of small weight are violated first.
    pub importance: &'a [f64],
    /// True for conditions of one unit, such as the coordinates of a point: all are scaled alike,
    /// so that a condition on which the numbers have little effect gets no larger weight.
    pub alike: bool,
    /// Effect of all numbers over their ranges below which a condition counts as independent of
    /// them, as for rounding; empty for none.
    pub no_effect: &'a [f64],
    /// Residual below which a condition is met.
    pub enough: f64,
    /// Maximum number of steps.
    pub steps: usize,
}

/// Result of a search.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The numbers.
    pub x: Vec<f64>,
    /// Residuals of the conditions.
    pub left: Vec<f64>,
    /// Number of steps.
    pub steps: usize,
    /// Effect of the numbers on each condition over their ranges, at the start.
    pub reach: Vec<f64>,
    /// Reason why the conditions could not be evaluated at the last trial values, if this failed.
    pub refused: Option<String>,
}

/// Brings the conditions to zero by the least change from `home`, beginning at `start`.
///
/// # Errors
/// The reason why the conditions cannot be evaluated at the start.
pub fn follow(
    conditions: &mut dyn Conditions,
    followers: &[FollowingNumber],
    start: &[f64],
    how: FollowSearch<'_>,
) -> Result<Followed, String> {
    let mut search = ScaledSearch::new(followers, how);
    let mut x = start.to_vec();
    let mut left = conditions.at(&x)?;
    let mut best: Option<(f64, Vec<f64>, Vec<f64>)> = None;
    let mut refused = None;
    let (mut steps, mut lessening) = (0, 0);
    while steps < how.steps {
        let slopes = conditions.slopes()?;
        search.measure(&slopes);
        let (rows, aims) = search.system(&slopes, &left, &x);
        let bounds = search.bounds(&x);
        let Some(step) = bounded_least_squares(&rows, &aims, &bounds) else { break };
        let length = step.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let met = search.missed(&left) <= MET || left.iter().all(|l| l.abs() <= how.enough);
        if met {
            let worth = search.changed(&x);
            if best.as_ref().is_none_or(|(w, ..)| worth < *w) {
                best = Some((worth, x.clone(), left.clone()));
            }
            if lessening == LESSENING || length <= SMALL_GAIN {
                break;
            }
            lessening += 1;
        }
        if length <= SMALL_STEP {
            break;
        }
        let now = search.merit(&left, &x);
        let hoped = now - rest(&rows, &aims, &step).iter().map(|r| r * r).sum::<f64>();
        // A step along the conditions may violate them by its square; the next step corrects this.
        let good = |share: f64, found: &[f64], next: &[f64]| {
            search.merit(found, next) <= now - 0.1 * share * hoped
                || (met && search.missed(found) < 0.1)
        };
        let accepted = search.accepted(conditions, &x, &step, &good, &mut refused);
        let Some((next, found)) = accepted else { break };
        (x, left) = (next, found);
        steps += 1;
    }
    if let Some((_, met, there)) = best
        && met != x
    {
        (x, left) = (met, there);
    }
    conditions.at(&x)?;
    Ok(Followed { x, left, steps, reach: search.reach, refused })
}

/// A search in numbers scaled by their sizes, of conditions scaled by their reach.
struct ScaledSearch<'a> {
    followers: &'a [FollowingNumber],
    how: FollowSearch<'a>,
    sizes: Vec<f64>,
    /// Effect of the numbers on each condition over their ranges, at the start.
    reach: Vec<f64>,
}

impl<'a> ScaledSearch<'a> {
    fn new(followers: &'a [FollowingNumber], how: FollowSearch<'a>) -> Self {
        let sizes = followers.iter().map(FollowingNumber::size).collect();
        Self { followers, how, sizes, reach: Vec::new() }
    }

    /// Takes the reach from the first slopes.
    fn measure(&mut self, slopes: &[Vec<f64>]) {
        if !self.reach.is_empty() {
            return;
        }
        let effect = |row: &Vec<f64>| row.iter().zip(&self.sizes).map(|(d, s)| (d * s).abs()).sum();
        self.reach = slopes.iter().map(effect).collect();
        for (reach, none) in self.reach.iter_mut().zip(self.how.no_effect) {
            if *reach <= *none {
                *reach = 0.0;
            }
        }
        if self.how.alike {
            let largest = self.reach.iter().copied().fold(0.0, f64::max);
            self.reach.fill(largest);
        }
    }

    /// The scale of a condition: 0 where no number has an effect, or it would be infinite.
    fn scale(&self, i: usize) -> f64 {
        let reach = self.reach[i];
        if reach > 0.0 { CONDITION * self.how.importance[i] / reach } else { 0.0 }
    }

    /// The linear system of a step: conditions, then the changes of the numbers.
    fn system(&self, slopes: &[Vec<f64>], left: &[f64], x: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let n = self.followers.len();
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(left.len() + n);
        let mut aims: Vec<f64> = Vec::with_capacity(left.len() + n);
        for (i, row) in slopes.iter().enumerate() {
            let scale = self.scale(i);
            rows.push(row.iter().zip(&self.sizes).map(|(d, s)| d * s * scale).collect());
            aims.push(-left[i] * scale);
        }
        for (j, follower) in self.followers.iter().enumerate() {
            let mut row = vec![0.0; n];
            row[j] = follower.weight;
            rows.push(row);
            aims.push(-follower.weight * (x[j] - follower.home) / self.sizes[j]);
        }
        (rows, aims)
    }

    /// The bounds of a step from `x`.
    fn bounds(&self, x: &[f64]) -> Vec<(f64, f64)> {
        let one = |((f, x), s): ((&FollowingNumber, &f64), &f64)| match f.range {
            Some((low, high)) => ((low - x) / s, (high - x) / s),
            None => (f64::NEG_INFINITY, f64::INFINITY),
        };
        self.followers.iter().zip(x).zip(&self.sizes).map(one).collect()
    }

    /// Residuals relative to the reach of their conditions.
    fn missed(&self, left: &[f64]) -> f64 {
        let share = |(l, r): (&f64, &f64)| if *r > 0.0 { (l / r) * (l / r) } else { 0.0 };
        left.iter().zip(&self.reach).map(share).sum::<f64>().sqrt()
    }

    /// The squared change from home.
    fn changed(&self, x: &[f64]) -> f64 {
        let one = |((f, x), s): ((&FollowingNumber, &f64), &f64)| f.weight * (x - f.home) / s;
        self.followers.iter().zip(x).zip(&self.sizes).map(one).map(|y| y * y).sum::<f64>()
    }

    /// The function that is minimised.
    fn merit(&self, left: &[f64], x: &[f64]) -> f64 {
        let one = |(i, l): (usize, &f64)| (l * self.scale(i)) * (l * self.scale(i));
        left.iter().enumerate().map(one).sum::<f64>() + self.changed(x)
    }

    /// The first good point of a step that is halved, with its residuals.
    fn accepted(
        &self,
        conditions: &mut dyn Conditions,
        x: &[f64],
        step: &[f64],
        good: &dyn Fn(f64, &[f64], &[f64]) -> bool,
        refused: &mut Option<String>,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let moved = |j: usize| {
                let next = x[j] + share * step[j] * self.sizes[j];
                self.followers[j].range.map_or(next, |(low, high)| next.clamp(low, high))
            };
            let next: Vec<f64> = (0..x.len()).map(moved).collect();
            match conditions.at(&next) {
                Ok(found) if found.iter().all(|c| c.is_finite()) && good(share, &found, &next) => {
                    return Some((next, found));
                }
                Ok(_) => {}
                Err(why) => *refused = Some(why),
            }
            share *= 0.5;
        }
        None
    }
}

/// The x that minimises |a x - b| within bounds; `None` for values that are not finite.
fn bounded_least_squares(a: &[Vec<f64>], b: &[f64], bounds: &[(f64, f64)]) -> Option<Vec<f64>> {
    let n = bounds.len();
    let within = |x: &[f64]| x.iter().zip(bounds).all(|(x, (low, high))| low <= x && x <= high);
    let all: Vec<usize> = (0..n).collect();
    let whole = least_squares(a, b, &all)?;
    if within(&whole) {
        return Some(whole);
    }
    let mut x: Vec<f64> = bounds.iter().map(|(low, high)| 0f64.clamp(*low, *high)).collect();
    let mut free = vec![false; n];
    // Each iteration frees one number, and no set of free numbers occurs twice.
    for _ in 0..8 * n + 8 {
        let residual = rest(a, b, &x);
        let pull: Vec<f64> =
            (0..n).map(|j| a.iter().zip(&residual).map(|(row, r)| row[j] * r).sum()).collect();
        let inward = |j: usize| {
            let size = a.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
            let width = residual.iter().map(|r| r * r).sum::<f64>().sqrt();
            let (low, high) = bounds[j];
            let open = if pull[j] > 0.0 { x[j] < high } else { x[j] > low };
            if open && pull[j].abs() > 1e-12 * size * width { pull[j].abs() / size } else { 0.0 }
        };
        let best = (0..n).filter(|j| !free[*j]).max_by(|i, j| inward(*i).total_cmp(&inward(*j)));
        let Some(j) = best.filter(|j| inward(*j) > 0.0) else { break };
        free[j] = true;
        loop {
            let set: Vec<usize> = (0..n).filter(|j| free[*j]).collect();
            if set.is_empty() {
                break;
            }
            // The others keep their values.
            let mut fixed = x.clone();
            set.iter().for_each(|j| fixed[*j] = 0.0);
            let wish = least_squares(a, &rest(a, b, &fixed), &set)?;
            let mut share = 1.0f64;
            for (&j, wish) in set.iter().zip(&wish) {
                let (low, high) = bounds[j];
                let end = if *wish > high {
                    high
                } else if *wish < low {
                    low
                } else {
                    continue;
                };
                share = share.min((end - x[j]) / (wish - x[j]));
            }
            for (&j, wish) in set.iter().zip(&wish) {
                let (low, high) = bounds[j];
                x[j] = (x[j] + share * (wish - x[j])).clamp(low, high);
                let at_end = (*wish > high && x[j] >= high - 1e-15 * high.abs())
                    || (*wish < low && x[j] <= low + 1e-15 * low.abs());
                if share < 1.0 && at_end {
                    x[j] = if *wish > high { high } else { low };
                    free[j] = false;
                }
            }
            if share >= 1.0 {
                break;
            }
            if set.iter().all(|j| free[*j]) {
                // Rounding hides which number is at its bound.
                break;
            }
        }
    }
    Some(x)
}

fn rest(a: &[Vec<f64>], b: &[f64], x: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(row, b)| b - row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>()).collect()
}

/// Least squares in some of the columns, by Householder reflections; a column that depends on those before it is zero.
fn least_squares(a: &[Vec<f64>], b: &[f64], columns: &[usize]) -> Option<Vec<f64>> {
    let (m, n) = (a.len(), columns.len());
    let mut r: Vec<Vec<f64>> =
        a.iter().map(|row| columns.iter().map(|&j| row[j]).collect()).collect();
    let mut b = b.to_vec();
    let largest = r.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
    let mut pivots = Vec::new();
    let mut row = 0;
    for k in 0..n {
        if row == m {
            break;
        }
        let norm = (row..m).map(|i| r[i][k] * r[i][k]).sum::<f64>().sqrt();
        if !norm.is_finite() {
            return None;
        }
        if norm <= 1e-14 * largest {
            continue;
        }
        let alpha = if r[row][k] > 0.0 { -norm } else { norm };
        let mut v: Vec<f64> = (row..m).map(|i| r[i][k]).collect();
        v[0] -= alpha;
        let length = v.iter().map(|x| x * x).sum::<f64>();
        for j in k..n {
            let dot: f64 = (row..m).map(|i| v[i - row] * r[i][j]).sum();
            (row..m).for_each(|i| r[i][j] -= 2.0 * dot / length * v[i - row]);
        }
        let dot: f64 = (row..m).map(|i| v[i - row] * b[i]).sum();
        (row..m).for_each(|i| b[i] -= 2.0 * dot / length * v[i - row]);
        pivots.push(k);
        row += 1;
    }
    let mut x = vec![0.0; n];
    for (i, &k) in pivots.iter().enumerate().rev() {
        let known: f64 = (k + 1..n).map(|j| r[i][j] * x[j]).sum();
        x[k] = (b[i] - known) / r[i][k];
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}
