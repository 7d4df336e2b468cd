//! Equilibrium by descent of the energy, which converges for a closed body of given mass from any
//! attitude.
//! With the level solved for the mass at each trim and heel, the energy over the weight is the
//! height of the centre of gravity above the centre of buoyancy. Its first derivatives are the
//! righting arms and are continuous, so the descent ends in an equilibrium. Its second derivatives
//! are those of the arms with the level eliminated, and jump where an edge meets the water.

use crate::Attitude;
use crate::equilibrium::EquilibriumProblem;
use crate::figures::displaced;
use moldloft_num::find_root;
use std::cell::Cell;

/// Maximum number of steps of a descent.
const MOST_STEPS: usize = 200;

/// Maximum rotation of a step, in radians.
const LARGEST_TURN: f64 = 0.2;

/// First step in trim, in radians.
const FIRST_TURN: f64 = 0.02;

/// Maximum number of halvings of a step that does not descend.
const MOST_HALVED: usize = 40;

/// Rounding error of the energy over the weight, relative to the diagonal.
const ROUNDING: f64 = 1e-15;

/// Arm, relative to the diagonal, below which Newton's method takes over.
const NEARLY_AT_REST: f64 = 1e-10;

/// A body at a trim and a heel, at the level at which it displaces its mass.
struct EnergyState {
    at: [f64; 3],
    /// Height of the centre of gravity above the centre of buoyancy.
    energy: f64,
    /// Its derivatives with respect to trim and heel; zero for a fixed angle.
    slopes: [f64; 2],
}

impl EquilibriumProblem<'_, f64> {
    /// `None` if no level displaces the mass because an open rim is immersed first.
    fn energy_state(&self, trim: f64, heel: f64) -> Option<EnergyState> {
        let level = self.level(trim, heel).ok()?;
        let at = [level, trim, heel];
        let attitude = Attitude::of(at);
        let g = attitude.earth_from(self.loading.centre.unwrap_or_default());
        let sums = displaced(self.body, attitude, [g.x, g.y], self.count, self.accuracy);
        let volume = sums.volume;
        let [trims, heels] = self.tilts(trim);
        let slopes = [trims * sums.moment.x / volume, heels * sums.moment.y / volume];
        Some(EnergyState { at, energy: g.z - sums.moment.z / volume - level, slopes })
    }

    /// Ratios of a rotation about the level axes to one of trim and of heel, zero for a fixed
    /// angle: the body heels about its own axis, which trim inclines.
    fn tilts(&self, trim: f64) -> [f64; 2] {
        let tilts = [1.0, libm::cos(trim)];
        [1, 2].map(|k| if self.free.contains(&k) { tilts[k - 1] } else { 0.0 })
    }

    /// The second derivatives of the energy, with the level that displaces the mass: trim-trim,
    /// trim-heel, heel-heel.
    fn stiffness(&self, at: [f64; 3]) -> [f64; 3] {
        let rows = self.slopes(at);
        let tilts = self.tilts(at[1]);
        let of = |r: usize, k: usize| {
            if tilts[k - 1] == 0.0 {
                return 0.0;
            }
            // Without a waterplane the level has no effect on the volume.
            let followed =
                if rows[0][0] > 0.0 { rows[r][0] * rows[0][k] / rows[0][0] } else { 0.0 };
            tilts[r - 1] * (rows[r][k] - followed) * self.size
        };
        [of(1, 1), 0.5 * (of(1, 2) + of(2, 1)), of(2, 2)]
    }

    /// An attitude near equilibrium, by descent of the energy from a trim and a heel, and the
    /// number of steps.
    pub(crate) fn descended(&self, from: [f64; 3]) -> Option<([f64; 3], usize)> {
        let [_, trim, heel] = from;
        match self.free[..] {
            [0, 1] => self.trimmed(trim, heel),
            _ => self.descended_in_both(trim, heel),
        }
    }

    /// At fixed heel: the nearest trim downhill where the derivative changes sign.
    fn trimmed(&self, trim: f64, heel: f64) -> Option<([f64; 3], usize)> {
        let steps = Cell::new(0);
        let slope = |trim: f64| {
            steps.set(steps.get() + 1);
            self.energy_state(trim, heel).map_or(f64::NAN, |state| state.slopes[0])
        };
        let first = slope(trim);
        let way = if first > 0.0 { -1.0 } else { 1.0 };
        let (mut above, mut turn) = (trim, FIRST_TURN);
        let below = loop {
            let next = above + way * turn;
            let found = slope(next);
            if found * way >= 0.0 {
                break next;
            }
            // No sign change within a full rotation: the energy is constant.
            if found.is_nan() || steps.get() > MOST_STEPS {
                return None;
            }
            above = next;
            turn = (2.0 * turn).min(LARGEST_TURN);
        };
        let trim = find_root(slope, above, below).ok()?;
        Some(([self.level(trim, heel).ok()?, trim, heel], steps.get()))
    }

    fn descended_in_both(&self, trim: f64, heel: f64) -> Option<([f64; 3], usize)> {
        let mut state = self.energy_state(trim, heel)?;
        for steps in 0..MOST_STEPS {
            let steepest = state.slopes.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            if steepest <= NEARLY_AT_REST * self.size {
                return Some((state.at, steps));
            }
            let turn = turn(state.slopes, self.stiffness(state.at), self.size);
            let descent = turn[0] * state.slopes[0] + turn[1] * state.slopes[1];
            let mut share = 1.0;
            let mut next = None;
            for _ in 0..MOST_HALVED {
                let [trim, heel] = [0, 1].map(|k| state.at[k + 1] + share * turn[k]);
                let lower = |s: &EnergyState| s.energy <= state.energy + 1e-4 * share * descent;
                next = self.energy_state(trim, heel).filter(lower);
                if next.is_some() {
                    break;
                }
                share *= 0.5;
                if -share * descent <= ROUNDING * self.size {
                    break;
                }
            }
            // Rounding hides any further descent: leave the rest to Newton's method.
            let Some(next) = next else { return Some((state.at, steps)) };
            state = next;
        }
        Some((state.at, MOST_STEPS))
    }
}

/// The Newton step with the absolute values of the principal stiffnesses, which is always a descent
/// direction.
fn turn(slopes: [f64; 2], [a, b, c]: [f64; 3], size: f64) -> [f64; 2] {
    let (middle, half) = (0.5 * (a + c), libm::hypot(0.5 * (a - c), b));
    // Direction of the larger principal stiffness.
    let angle = 0.5 * libm::atan2(2.0 * b, a - c);
    let axis = [libm::cos(angle), libm::sin(angle)];
    let mut turn = [0.0; 2];
    for (stiff, v) in [(middle + half, axis), (middle - half, [-axis[1], axis[0]])] {
        let along = v[0] * slopes[0] + v[1] * slopes[1];
        let step = -along / stiff.abs().max(1e-9 * size);
        turn[0] += step * v[0];
        turn[1] += step * v[1];
    }
    let largest = turn[0].abs().max(turn[1].abs());
    if largest > LARGEST_TURN { turn.map(|x| x * LARGEST_TURN / largest) } else { turn }
}
