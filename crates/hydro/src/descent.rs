//! Rest by descent of the energy: from anywhere a closed body of given mass comes to rest somewhere.
//!
//! With the level solved for the mass at each trim and heel, the energy over the weight is the height of gravity above
//! buoyancy. It is continuous with its slopes, which are the arms, so that descent ends at rest; its second derivatives
//! are those of the arms with the level eliminated, and jump where an edge meets the water.

use crate::Attitude;
use crate::equilibrium::EquilibriumProblem;
use crate::figures::displaced;
use moldloft_num::find_root;
use std::cell::Cell;

/// The most steps of a descent.
const MOST_STEPS: usize = 200;

/// The largest turn of a step, in radians.
const LARGEST_TURN: f64 = 0.2;

/// The first step along the trim, in radians.
const FIRST_TURN: f64 = 0.02;

/// Halvings of a step until it must descend.
const MOST_HALVED: usize = 40;

/// Energies over the weight are known within this share of the diagonal.
const ROUNDING: f64 = 1e-15;

/// Arms within this share of the diagonal are left to Newton's method.
const NEARLY_AT_REST: f64 = 1e-10;

/// A body at a trim and a heel, its level that of its mass.
struct EnergyState {
    at: [f64; 3],
    /// The height of gravity above buoyancy.
    energy: f64,
    /// Its derivatives by trim and heel; zero for what is held.
    slopes: [f64; 2],
}

impl EquilibriumProblem<'_, f64> {
    /// `None` where the mass has no level: the water comes over an open rim.
    fn energy_state(&self, trim: f64, heel: f64) -> Option<EnergyState> {
        let level = self.level(trim, heel).ok()?;
        let at = [level, trim, heel];
        let attitude = Attitude::of(at);
        let turned = attitude.turned(self.body);
        let g = attitude.earth_from(self.loading.centre.unwrap_or_default());
        let sums = displaced(&turned, level, [g.x, g.y], self.count);
        let volume = sums.forms[2];
        let [trims, heels] = self.tilts(trim);
        let slopes = [trims * sums.moment.x / volume, heels * sums.moment.y / volume];
        Some(EnergyState { at, energy: g.z - sums.moment.z / volume - level, slopes })
    }

    /// By how much a turn about the level axes exceeds one of trim and of heel, zero for what is held: the body heels
    /// about its own axis, which the trim tilts.
    fn tilts(&self, trim: f64) -> [f64; 2] {
        let tilts = [1.0, libm::cos(trim)];
        [1, 2].map(|k| if self.free.contains(&k) { tilts[k - 1] } else { 0.0 })
    }

    /// The second derivatives of the energy where the body displaces its mass, the level following: by trim, by both,
    /// by heel.
    fn stiffness(&self, at: [f64; 3]) -> [f64; 3] {
        let rows = self.slopes(at);
        let tilts = self.tilts(at[1]);
        let of = |r: usize, k: usize| {
            if tilts[k - 1] == 0.0 {
                return 0.0;
            }
            // Without a waterplane no level keeps the volume.
            let followed =
                if rows[0][0] > 0.0 { rows[r][0] * rows[0][k] / rows[0][0] } else { 0.0 };
            tilts[r - 1] * (rows[r][k] - followed) * self.size
        };
        [of(1, 1), 0.5 * (of(1, 2) + of(2, 1)), of(2, 2)]
    }

    /// An attitude nearly at rest down the slope of the energy from a trim and a heel, and the steps that led there.
    pub(crate) fn descended(&self, from: [f64; 3]) -> Option<([f64; 3], usize)> {
        let [_, trim, heel] = from;
        match self.free[..] {
            [0, 1] => self.trimmed(trim, heel),
            _ => self.descended_in_both(trim, heel),
        }
    }

    /// At a heel that is held: the nearest trim downhill where the slope changes its sign.
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
            // A whole turn without an end: what it weighs has no slope.
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
            // Where rounding hides the descent, Newton's method is at home.
            let Some(next) = next else { return Some((state.at, steps)) };
            state = next;
        }
        Some((state.at, MOST_STEPS))
    }
}

/// The Newton step with the sizes of the principal stiffnesses, so that it leads downhill everywhere.
fn turn(slopes: [f64; 2], [a, b, c]: [f64; 3], size: f64) -> [f64; 2] {
    let (middle, half) = (0.5 * (a + c), libm::hypot(0.5 * (a - c), b));
    // The direction of the greater principal stiffness.
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
