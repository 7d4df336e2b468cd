//! Equations between two points of a network whose points move along one direction: straight runs in a
//! given direction and flats. Their points move as one, within the intersection of their tolerances.

use crate::optimum::ties::Ties;
use crate::{Condition, FairError, Motion, Network};

/// Difference of two factors that are opposite, relative to them.
const OPPOSITE: f64 = 1e-12;

/// Width of an intersection of tolerances below which its points do not move, relative to these.
const NARROW: f64 = 1e-9;

/// Distance of the start from the ends of an intersection, relative to its width.
const INSIDE: f64 = 0.1;

/// Points joined by equations: of each point its parent, and its displacement over that of the parent.
/// The last node is the ground, which does not move.
struct JoinedPoints(Vec<(usize, f64)>);

impl JoinedPoints {
    fn root(&self, mut node: usize) -> (usize, f64) {
        let mut apart = 0.0;
        while self.0[node].0 != node {
            apart += self.0[node].1;
            node = self.0[node].0;
        }
        (node, apart)
    }

    /// Joins `a` and `b`, whose displacements differ by `apart`.
    fn join(&mut self, a: usize, b: usize, apart: f64) {
        let ((a, by_a), (b, by_b)) = (self.root(a), self.root(b));
        if a != b {
            // The ground stays a root.
            let (child, parent, apart) =
                if a > b { (b, a, by_a - by_b - apart) } else { (a, b, by_b - by_a + apart) };
            self.0[child] = (parent, apart);
        }
    }
}

impl Network {
    /// The ties among independent equations, the other equations, and the points that do not move.
    ///
    /// # Errors
    /// [`FairError::Shape`] where tied points have no position within their tolerances.
    pub(super) fn tied(
        &self,
        equations: Vec<(Condition, usize)>,
    ) -> Result<(Ties, Vec<(Condition, usize)>, Vec<bool>), FairError> {
        let mut frozen = self.frozen();
        let Motion::Along(way) = self.limit.motion else {
            return Ok((Ties::default(), equations, frozen));
        };
        let (count, radii) = (self.points.len(), &self.limit.radii);
        let mut joined = JoinedPoints((0..=count).map(|i| (i, 0.0)).collect());
        let (mut others, mut tied, mut owners) = (Vec::new(), Vec::new(), vec![0; count + 1]);
        for (condition, owner) in equations {
            let mut free: Vec<(usize, f64)> = Vec::new();
            for (i, f) in condition.entries.iter().filter(|(i, _)| !frozen[*i]) {
                let f = f.dot(way);
                match free.iter_mut().find(|(j, _)| j == i) {
                    Some((_, sum)) => *sum += f,
                    None => free.push((*i, f)),
                }
            }
            free.retain(|(_, f)| *f != 0.0);
            let value = condition.value - condition.at(&self.points);
            let pair = match free[..] {
                [(a, f)] => Some((a, count, value / f)),
                [(a, f), (b, g)] if (f + g).abs() <= OPPOSITE * f.abs() => Some((a, b, value / f)),
                _ => None,
            };
            match pair {
                Some((a, b, apart)) => {
                    joined.join(a, b, apart);
                    (owners[a], owners[b]) = (owner, owner);
                    tied.push(condition);
                }
                None => others.push((condition, owner)),
            }
        }
        if tied.is_empty() {
            return Ok((Ties::default(), others, frozen));
        }
        let mut ties = Ties { equations: tied, ..Ties::default() };
        ties.leader = (0..count).collect();
        ties.shift = vec![moldloft_num::Vec3::zero(); count];
        let mut groups: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count + 1];
        for i in 0..count {
            let (root, apart) = joined.root(i);
            groups[root].push((i, apart));
        }
        for (root, members) in groups.iter().enumerate() {
            if members.len() < 2 && root < count {
                continue;
            }
            // The position of the group that all tolerances leave, and the nearest to the given points.
            let bounded = || members.iter().filter(|(i, _)| radii[*i].is_finite());
            let low = bounded().map(|&(i, e)| -radii[i] - e).fold(f64::NEG_INFINITY, f64::max);
            let high = bounded().map(|&(i, e)| radii[i] - e).fold(f64::INFINITY, f64::min);
            let [sum, total] = bounded().fold([0.0; 2], |[s, t], &(i, e)| {
                let weight = 1.0 / (radii[i] * radii[i]);
                [s - e * weight, t + weight]
            });
            let least = bounded().map(|&(i, _)| radii[i]).fold(f64::INFINITY, f64::min);
            let grounded = root == count;
            // The ground has one position.
            let miss = if grounded { low.max(-high) } else { low - high };
            if miss > NARROW * least {
                let owner = members.iter().map(|&(i, _)| owners[i]).max().unwrap_or_default();
                return Err(FairError::Shape { shapes: vec![owner], miss });
            }
            let nearest = if total > 0.0 { (sum / total).clamp(low, high.max(low)) } else { 0.0 };
            let at = if grounded { 0.0 } else { nearest };
            ties.forced += bounded().map(|&(i, e)| ((at + e) / radii[i]).powi(2)).sum::<f64>();
            ties.removed += members.len() - usize::from(!grounded);
            let still = grounded || high - low <= NARROW * least;
            let width = if still || !(high - low).is_finite() { 0.0 } else { high - low };
            let start = if still && !grounded { 0.5 * (low + high) } else { at };
            let inside = [low + INSIDE * width, high - INSIDE * width];
            let start = if width > 0.0 { start.clamp(inside[0], inside[1]) } else { start };
            let leader =
                members.iter().copied().reduce(|a, b| if radii[b.0] < radii[a.0] { b } else { a });
            let leader = leader.map_or(root, |l| l.0);
            for &(i, e) in members {
                ties.leader[i] = leader;
                ties.shift[i] = way * (start + e);
                frozen[i] |= still;
            }
        }
        Ok((ties, others, frozen))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_points_keep_their_differences() {
        let mut joined = JoinedPoints((0..6).map(|i| (i, 0.0)).collect());
        // x0 - x1 = 2, x3 - x1 = -1, x4 = 5 (the ground is node 5).
        joined.join(0, 1, 2.0);
        joined.join(3, 1, -1.0);
        joined.join(4, 5, 5.0);
        let apart = |a: usize, b: usize| {
            let ((r, x), (s, y)) = (joined.root(a), joined.root(b));
            (r == s).then_some(x - y)
        };
        assert_eq!(apart(0, 3), Some(3.0));
        assert_eq!(apart(0, 1), Some(2.0));
        assert_eq!(joined.root(4), (5, 5.0));
        assert_eq!(apart(2, 4), None);
        joined.join(0, 4, 1.0);
        assert_eq!(joined.root(1), (5, 4.0));
        assert_eq!(joined.root(0), (5, 6.0));
    }
}
