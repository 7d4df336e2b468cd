//! Limits all along curves, also between their points, where these may swing farther than their points move.
//!
//! All of them are conditions of a network; in a search are those that are reached, or nearly. The
//! optimum under these is that under all as soon as none of the others is passed.

use crate::net::curves::{BezierLimit, HALVINGS, SWING_SLACK};
use crate::optimum::{Bounded, Solved};
use crate::{Bound, FairError, Network};
use moldloft_num::{Real, Vec3};

/// Fraction of a limit from which on it takes part in the search.
const NEAR: f64 = 0.9;

/// Limits between points.
#[derive(Clone, Default)]
pub(super) struct LimitsBetween {
    /// The curve and the number of the Bézier point on it, with its limit.
    limits: Vec<([usize; 2], BezierLimit)>,
}

impl LimitsBetween {
    pub fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// Adds the limits that these points reach or nearly reach; false where all others hold.
    pub fn extend(&mut self, network: &Network, points: &[Vec3<f64>]) -> Result<bool, FairError> {
        let moves = network.moves(points);
        let (mut passed, mut found) = (false, Vec::new());
        for curve in 0..network.strands.len() {
            // A curve through a point without limit follows that.
            let strand = &network.strands[curve];
            let limited = strand.points.iter().all(|&i| network.limit.radii[i].is_finite());
            if strand.at.is_none() || !limited || !network.may_swing(curve, &moves, NEAR)? {
                continue;
            }
            for (number, limit) in network.bezier_limits(curve, HALVINGS)?.into_iter().enumerate() {
                let share = limit.share(network.limit.motion, &moves);
                let place = [curve, number];
                if share > NEAR && self.limits.iter().all(|own| own.0 != place) {
                    passed |= share > 1.0 + SWING_SLACK;
                    found.push((place, limit));
                }
            }
        }
        if passed {
            self.limits.extend(found);
        }
        Ok(passed)
    }

    /// The limits on the points and these.
    pub fn bounded(&self, network: &Network) -> Bounded {
        let mut all = network.point_limits();
        for (_, limit) in &self.limits {
            all.radii.push(limit.radius);
            all.rows.push(limit.entries.iter().copied());
        }
        Bounded::Data(all)
    }

    /// The tolerances of all limits, in their order.
    pub fn tolerances<T: Real>(&self, of_points: &[T]) -> Vec<T> {
        let own = self.limits.iter().map(|(_, limit)| of_points[limit.owner]);
        of_points.iter().copied().chain(own).collect()
    }

    /// Refuses derivatives where it is not decided which of the limits are reached, or where one that is
    /// reached moves with the parameters of its curve.
    pub fn check<T: Real>(
        &self,
        solved: &Solved,
        bounded: &Bounded,
        frozen: &[bool],
        ats: &[Option<Vec<T>>],
    ) -> Result<(), FairError> {
        let Bounded::Data(data) = bounded else { return Ok(()) };
        if self.is_empty() {
            return Ok(());
        }
        let Some(reached) = solved.reached() else {
            return Err(FairError::NoDerivative(
                "the limits reached between the points of the network are undecided within \
                rounding, so no derivatives are available: change the tolerance slightly",
            ));
        };
        let used: Vec<usize> = data.used(frozen).collect();
        let points = data.radii.len() - self.limits.len();
        let moves = |k: usize| {
            let curve = used[k].checked_sub(points).map(|own| self.limits[own].0[0]);
            let at = curve.and_then(|curve| ats.get(curve)).and_then(Option::as_ref);
            at.is_some_and(|at| !at.iter().all(|t| t.is_constant()))
        };
        if reached.into_iter().any(moves) {
            return Err(FairError::NoDerivative(
                "no derivatives are available for a network that reaches limits between its \
                points if the parameters depend on the points: let the points move along one \
                direction",
            ));
        }
        Ok(())
    }
}

impl Network {
    /// True if limits between points are part of the search.
    pub(super) fn limits_between(&self) -> bool {
        self.bound == Bound::Bezier && self.runs_through_points()
    }

    /// The bound that a search begins with: limits between points are added as they are passed.
    pub(super) fn first_bound(&self) -> Bound {
        if self.limits_between() { Bound::ControlPoints } else { self.bound }
    }
}
