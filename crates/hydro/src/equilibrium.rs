//! Equilibrium attitude of a floating body of given mass.

use crate::body::Body;
use crate::figures::{Displaced, displaced};
use crate::hydrostatics::Symmetry;
use crate::{Attitude, Flotation, Water, flotation};
use moldloft_num::{Real, Vec3, solve_dense};
use std::fmt;

/// Loading condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loading<T> {
    /// Mass.
    pub mass: T,
    /// Centre of gravity in body axes; required if trim or heel is free.
    pub centre: Option<Vec3<T>>,
    /// True to solve for the trim.
    pub free_trim: bool,
    /// True to solve for the heel.
    pub free_heel: bool,
}

/// Status of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The residual is at rounding level.
    Converged,
    /// The best attitude found is not an equilibrium.
    NotConverged,
}

/// An equilibrium, or the best attempt at one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium<T> {
    /// Figures at this attitude.
    pub flotation: Flotation<T>,
    /// Converged or not.
    pub status: Status,
    /// Number of Newton steps.
    pub iterations: usize,
    /// Maximum of the relative error of the volume and the arms over the diagonal.
    pub residual: f64,
    /// True for positive stiffness in heel and trim, free or fixed; also true without a centre of
    /// gravity.
    pub stable: bool,
    /// True for an angle of loll: the search reached an unstable equilibrium first, and this is the
    /// stable one beside it.
    pub lolls: bool,
}

/// Reason why there is no equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloatError {
    /// The mass is not a positive number.
    Mass {
        /// The mass.
        mass: f64,
    },
    /// Trim or heel is free, but there is no centre of gravity.
    NoCentre,
    /// A mesh of one side cannot heel.
    HalfHeels,
    /// There is no skin, or it encloses no volume.
    NoBody,
    /// The mass exceeds the displacement of the submerged body.
    Sinks {
        /// The mass.
        mass: f64,
        /// Maximum displacement.
        most: f64,
        /// Trim and heel, in radians, at which an open rim limits the displacement.
        rim: Option<[f64; 2]>,
    },
}

impl fmt::Display for FloatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mass { mass } => write!(f, "the displacement {mass} is not a positive number"),
            Self::NoCentre => {
                write!(f, "free trim and heel require a centre of gravity")
            }
            Self::HalfHeels => write!(f, "half a body cannot heel"),
            Self::NoBody => write!(f, "the panels enclose no body that could float"),
            Self::Sinks { mass, most, rim: None } => {
                write!(f, "the displacement {mass} exceeds that of the submerged body, {most}")
            }
            Self::Sinks { mass, most, rim: Some([trim, heel]) } => write!(
                f,
                "the displacement {mass} exceeds the largest one without an immersed open edge, \
                {most}, at a trim of {:.2} and a heel of {:.2} degrees",
                trim.to_degrees(),
                heel.to_degrees()
            ),
        }
    }
}

impl std::error::Error for FloatError {}

/// Maximum number of Newton steps; a ship needs about five.
const MOST_STEPS: usize = 60;

/// Residual at rounding level, and residual accepted once steps no longer reduce it.
const TIGHT: f64 = 1e-13;
const LOOSE: f64 = 1e-9;

/// Residual from which one Newton step reaches rounding level.
const POLISHED: f64 = 1e-10;

/// Relative accuracy of the integrals of a search up to its last steps, and the residual at which these begin.
const ROUGH: f64 = 1e-4;
const NEARLY: f64 = 1e-3;

/// Maximum rotation of a step, in radians.
const LARGEST_TURN: f64 = 0.2;

/// The equilibrium attitude, from `start` (whose level is not used): level, and trim and heel if
/// free.
/// First the level is solved for at the given trim and heel by bracketed Newton steps, then all
/// unknowns together by damped Newton steps with exact derivatives, without derivatives in `T`, and
/// with rough integrals up to the last steps; if these do not converge, by descent of the energy. From an unstable equilibrium the search
/// continues, heeling to both sides, to the nearest stable one, if any. A last step in `T` gives
/// the derivatives of the solution (implicit function theorem).
///
/// # Errors
/// [`FloatError`].
pub fn equilibrium<T: Real>(
    body: &Body<T>,
    water: Water,
    loading: Loading<T>,
    start: Attitude<T>,
) -> Result<Equilibrium<T>, FloatError> {
    let mass = loading.mass.re();
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(FloatError::Mass { mass });
    }
    if loading.centre.is_none() && (loading.free_trim || loading.free_heel) {
        return Err(FloatError::NoCentre);
    }
    let half = water.symmetry != Symmetry::None;
    if half && (loading.free_heel || start.heel.re() != 0.0) {
        return Err(FloatError::HalfHeels);
    }
    let problem = EquilibriumProblem::new(body.real(), water, loading)?;
    let [trim, heel] = [start.trim.re(), start.heel.re()];
    let level = match problem.rough() {
        Some(rough) if problem.free.len() > 1 => rough.level(trim, heel),
        _ => problem.level(trim, heel),
    };
    let mut found = problem.rest([level?, trim, heel]);
    let loose = problem.loose();
    let mut lolls = false;
    if found.residual <= loose
        && loading.free_heel
        && !problem.stable(found.at)
        && let Some(beyond) = problem.beyond(found.at)
    {
        lolls = true;
        found = FoundAttitude { steps: found.steps + beyond.steps, ..beyond };
    }
    let FoundAttitude { at, steps: iterations, residual, here } = found;
    let status = if residual <= loose { Status::Converged } else { Status::NotConverged };

    // One Newton step in T makes the derivative of the residual vanish, and its real part removes
    // rounding. With a larger residual the body is near pitchpoling, and the step is not reliable.
    let tight = residual <= POLISHED;
    let constant = at.map(T::from);
    let seeded = [constant[0], start.trim, start.heel];
    let fixed: [T; 3] =
        std::array::from_fn(|k| if problem.free.contains(&k) { constant[k] } else { seeded[k] });
    let free = problem.free.clone();
    let EquilibriumProblem { count, size, accuracy, tight: end, .. } = problem;
    let exact =
        EquilibriumProblem { body, water, loading, free, count, size, accuracy, tight: end };
    let off = match T::PARTS {
        1 => problem.residual_of(&here).map(T::from),
        _ => exact.residual(fixed),
    };
    let mut unknowns = fixed;
    if let Some(step) = problem.step(&problem.slopes_of(at, &here), off) {
        for (&k, dx) in problem.free.iter().zip(step) {
            unknowns[k] += if tight { dx } else { dx - dx.re() };
        }
    }
    let flotation = flotation(body, water, Attitude::of(unknowns), loading.centre);
    let stable = flotation.stable.unwrap_or(true);
    Ok(Equilibrium { flotation, status, iterations, residual, stable, lolls })
}

/// The dimensionless equations of equilibrium: volume, trimming arm, heeling arm.
pub(crate) struct EquilibriumProblem<'m, T: Real> {
    pub(crate) body: &'m Body<T>,
    water: Water,
    pub(crate) loading: Loading<T>,
    /// Free unknowns: 0 level, 1 trim, 2 heel; equation k belongs to unknown k.
    pub(crate) free: Vec<usize>,
    /// 1, or -1 for normals that point inward; times 2 for a half body that counts as whole.
    pub(crate) count: f64,
    /// Diagonal of the body.
    pub(crate) size: f64,
    /// Relative accuracy of the integrals.
    pub(crate) accuracy: f64,
    /// Residual at which a search ends.
    tight: f64,
}

/// The best attitude that a search has found.
struct FoundAttitude {
    at: [f64; 3],
    steps: usize,
    residual: f64,
    here: Displacement<f64>,
}

/// Step of heel, in radians, in the search beyond an unstable attitude.
const HEEL_STEP: f64 = 0.0349;

impl<'m> EquilibriumProblem<'m, f64> {
    fn new<S: Real>(
        body: &'m Body<f64>,
        water: Water,
        loading: Loading<S>,
    ) -> Result<Self, FloatError> {
        let bounds = body.bounds();
        let size = bounds.diagonal();
        if body.is_empty() || !(size > 0.0 && size.is_finite()) {
            return Err(FloatError::NoBody);
        }
        let mut free = vec![0];
        free.extend(loading.free_trim.then_some(1));
        free.extend(loading.free_heel.then_some(2));
        let loading = Loading {
            mass: loading.mass.re(),
            centre: loading.centre.map(|c| c.re()),
            free_trim: loading.free_trim,
            free_heel: loading.free_heel,
        };
        // The sign of the volume of the half-submerged body gives the orientation of the normals.
        let middle = bounds.centre();
        let accuracy = body.quadrature_accuracy();
        let origin = [middle.x, middle.y];
        let upright = Attitude::upright(middle.z);
        let volume = displaced(body, upright, origin, 1.0, ROUGH.max(accuracy)).volume;
        if volume == 0.0 {
            return Err(FloatError::NoBody);
        }
        let sides = if water.symmetry == Symmetry::MirroredTwice { 2.0 } else { 1.0 };
        Ok(Self {
            body,
            water,
            loading,
            free,
            count: sides * volume.signum(),
            size,
            accuracy,
            tight: TIGHT,
        })
    }

    /// The search with rough integrals; `None` if they are rough already.
    fn rough(&self) -> Option<Self> {
        let rough = || Self { accuracy: ROUGH, tight: NEARLY, ..self.with(self.free.clone()) };
        (self.accuracy < ROUGH).then(rough)
    }

    /// The search with other free unknowns.
    fn with(&self, free: Vec<usize>) -> Self {
        let Self { body, water, loading, count, size, accuracy, tight, .. } = *self;
        Self { body, water, loading, free, count, size, accuracy, tight }
    }

    /// Maximum residual of an equilibrium.
    fn loose(&self) -> f64 {
        LOOSE.max(0.1 * self.body.accuracy())
    }

    /// The level at which the body displaces its mass, at a trim and heel.
    pub(crate) fn level(&self, trim: f64, heel: f64) -> Result<f64, FloatError> {
        let attitude = Attitude { level: 0.0, trim, heel };
        let middle = attitude.earth_from(self.body.bounds().centre());
        let density = self.water.density;
        let wanted = self.loading.mass / density;
        let volume = |z: f64| {
            let (at, origin) = (Attitude { level: z, ..attitude }, [middle.x, middle.y]);
            let sums = displaced(self.body, at, origin, self.count, self.accuracy);
            (sums.volume - wanted, sums.plane[0])
        };
        let [low, high] = self.body.heights(attitude.axes()[2]);
        // Slightly above the top, so that panels in the top are submerged.
        let (mut low, mut high) = (low, high + 1e-9 * self.size);
        // An open body displaces no more once its rim is immersed.
        let half = self.water.symmetry != Symmetry::None;
        let rims = self.body.rims_alone().turned(attitude);
        let full = rims.lowest_rim(half).map_or(high, |z| z.min(high));
        let when_full = volume(full).0;
        let most = if full < high { when_full.max(volume(high).0) } else { when_full } + wanted;
        if wanted > most * (1.0 + 1e-12) {
            let rim = (full < high).then_some([trim, heel]);
            return Err(FloatError::Sinks { mass: self.loading.mass, most: most * density, rim });
        }
        if when_full >= 0.0 {
            high = full;
        }
        let mut z = 0.5 * (low + high);
        // Between hulls and deck of a catamaran the volume grows slowly with the level, which slows
        // down Newton's method.
        let mut before = f64::INFINITY;
        for _ in 0..200 {
            let (off, slope) = volume(z);
            if off.abs() <= self.tight * wanted {
                break;
            }
            if off > 0.0 {
                high = z
            } else {
                low = z
            }
            let newton = z - off / slope;
            let shrinks = off.abs() <= 0.5 * before;
            before = off.abs();
            let next =
                if newton > low && newton < high && shrinks { newton } else { 0.5 * (low + high) };
            if next == z || high - low <= 1e-15 * self.size {
                break;
            }
            z = next;
        }
        Ok(z)
    }

    /// The derivatives of the residuals with respect to level, trim and heel:
    /// `[residual][unknown]`.
    ///
    /// With the level axes ex, ey, n and moments about the origin: d/dlevel of V, P, Q are A, A xf, A yf; d/dtrim are
    /// A xf, Ipp + V n.B, Ipq; d/dheel are c A yf, c Ipq - s V ey.B, c Iqq + V (s ex.B + c n.B), with c and s of the
    /// trim.
    pub(crate) fn slopes(&self, at: [f64; 3]) -> [[f64; 3]; 3] {
        self.slopes_of(at, &self.displacement(at))
    }

    fn slopes_of(&self, at: [f64; 3], found: &Displacement<f64>) -> [[f64; 3]; 3] {
        let Displacement { sums, centre: g } = found;
        let v = sums.volume;
        let [a, ax, ay, axx, axy, ayy] = sums.plane;
        let (px, qy) = (ax + a * g.x, ay + a * g.y);
        let ipp = axx + 2.0 * g.x * ax + g.x * g.x * a;
        let ipq = axy + g.x * ay + g.y * ax + g.x * g.y * a;
        let iqq = ayy + 2.0 * g.y * ay + g.y * g.y * a;
        let vb = sums.moment + Vec3::of(g.x, g.y, at[0]) * v;
        let (s, c) = (libm::sin(at[1]), libm::cos(at[1]));
        let dv = [a, px, c * qy];
        let dp = [px, ipp + vb.z, c * ipq - s * vb.y];
        let dq = [qy, ipq, c * iqq + s * vb.x + c * vb.z];
        // The centre of gravity moves relative to the level axes as well.
        let dpg = [0.0, g.z, -s * g.y];
        let dqg = [0.0, 0.0, s * g.x + c * g.z];
        let wanted = self.loading.mass / self.water.density;
        let arm = wanted * self.size;
        let mut rows = [[0.0; 3]; 3];
        for k in 0..3 {
            rows[0][k] = dv[k] / wanted;
            rows[1][k] = (dp[k] - dv[k] * g.x - v * dpg[k]) / arm;
            rows[2][k] = (dq[k] - dv[k] * g.y - v * dqg[k]) / arm;
        }
        rows
    }

    /// The Newton step of the free unknowns against the residuals `off`.
    fn step<T: Real>(&self, slopes: &[[f64; 3]; 3], off: [T; 3]) -> Option<Vec<T>> {
        let entries = self.free.iter().flat_map(|&r| self.free.iter().map(move |&c| (r, c)));
        let mut matrix: Vec<T> = entries.map(|(r, c)| T::from(slopes[r][c])).collect();
        let mut step: Vec<T> = self.free.iter().map(|&r| -off[r]).collect();
        solve_dense(&mut matrix, &mut step).ok()?;
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    fn worst(&self, residual: [f64; 3]) -> f64 {
        self.free.iter().map(|&k| residual[k].abs()).fold(0.0, f64::max)
    }

    /// The equilibrium reached from `from`.
    fn rest(&self, from: [f64; 3]) -> FoundAttitude {
        let mut best = self.newton(from);
        let improved = |best: &mut FoundAttitude, from: [f64; 3]| {
            let Some((at, steps)) = self.descended(from) else { return };
            let found = self.newton(at);
            let all = best.steps + steps + found.steps;
            if found.residual < best.residual {
                *best = found;
            }
            best.steps = all;
        };
        if self.free.len() > 1 && best.residual > self.loose() {
            let near = best.at;
            improved(&mut best, near);
            if best.residual > self.loose() {
                improved(&mut best, from);
            }
        }
        best
    }

    /// The best attitude that Newton's method finds from `from`.
    fn newton(&self, from: [f64; 3]) -> FoundAttitude {
        let Some(rough) = self.rough() else { return self.newton_steps(from) };
        let near = rough.newton_steps(from);
        let found = self.newton_steps(near.at);
        FoundAttitude { steps: near.steps + found.steps, ..found }
    }

    fn newton_steps(&self, from: [f64; 3]) -> FoundAttitude {
        let height = self.size;
        let mut at = from;
        // Residual and derivatives use the same integrals, which take nearly all of the time.
        let mut here = self.displacement(at);
        let mut off = self.residual_of(&here);
        let mut residual = self.worst(off);
        let mut steps = 0;
        while residual > self.tight && steps < MOST_STEPS {
            let Some(step) = self.step(&self.slopes_of(at, &here), off) else { break };
            let mut share: f64 = 1.0;
            for (&k, dx) in self.free.iter().zip(&step) {
                let most = if k == 0 { 0.25 * height } else { LARGEST_TURN };
                share = share.min(most / dx.abs().max(f64::MIN_POSITIVE));
            }
            let mut better = false;
            let tries = if residual < 1e-10 { 1 } else { 12 };
            for _ in 0..tries {
                let mut next = at;
                for (&k, dx) in self.free.iter().zip(&step) {
                    next[k] += share * dx;
                }
                let there = self.displacement(next);
                let found = self.residual_of(&there);
                let left = self.worst(found);
                if left < residual {
                    (at, here, off, residual, better) = (next, there, found, left, true);
                    break;
                }
                share *= 0.5;
            }
            steps += 1;
            if !better {
                break;
            }
        }
        FoundAttitude { at, steps, residual, here }
    }

    fn stable(&self, at: [f64; 3]) -> bool {
        let found = flotation(self.body, self.water, Attitude::of(at), self.loading.centre);
        found.stable.unwrap_or(true)
    }

    /// From an unstable equilibrium: the nearest stable one on either side in heel, with the steps of
    /// the search. The arm is evaluated at fixed heel; where it changes from overturning to righting,
    /// all unknowns are solved for together.
    fn beyond(&self, at: [f64; 3]) -> Option<FoundAttitude> {
        let held = self.with(self.free.iter().copied().filter(|&k| k != 2).collect());
        let side = |sign: f64| -> Option<FoundAttitude> {
            let (mut now, mut count) = (at, 0);
            let mut before = -1.0;
            while (now[2] - at[2]).abs() < std::f64::consts::PI {
                let mut next = now;
                next[2] += sign * HEEL_STEP;
                next[0] = held.level(next[1], next[2]).ok()?;
                let rest = held.rest(next);
                count += rest.steps;
                if rest.residual > self.loose() {
                    return None;
                }
                let arm = self.residual_of(&rest.here)[2] * sign;
                if before < 0.0 && arm >= 0.0 {
                    // Between two heels the arm is nearly linear.
                    let found = self.newton(rest.at);
                    let near = (found.at[2] - rest.at[2]).abs() <= 3.0 * HEEL_STEP;
                    let good = found.residual <= self.loose() && near && self.stable(found.at);
                    return good.then(|| FoundAttitude { steps: count + found.steps, ..found });
                }
                before = arm;
                now = rest.at;
            }
            None
        };
        let [up, down] = [side(1.0), side(-1.0)];
        let turned = |f: &Option<FoundAttitude>| {
            f.as_ref().map_or(f64::INFINITY, |f| (f.at[2] - at[2]).abs())
        };
        if turned(&down) < turned(&up) * (1.0 - 1e-9) { down } else { up }
    }
}

/// Displacement of the body at an attitude.
struct Displacement<T> {
    /// The centre of gravity in the level axes.
    centre: Vec3<T>,
    /// The integrals, about the vertical through the centre of gravity: a distant origin would cost
    /// digits.
    sums: Displaced<T>,
}

impl<T: Real> EquilibriumProblem<'_, T> {
    fn displacement(&self, unknowns: [T; 3]) -> Displacement<T> {
        let attitude = Attitude::of(unknowns);
        let centre = attitude.earth_from(self.loading.centre.unwrap_or_default());
        let origin = [centre.x, centre.y];
        let sums = displaced(self.body, attitude, origin, self.count, self.accuracy);
        Displacement { centre, sums }
    }

    fn residual(&self, unknowns: [T; 3]) -> [T; 3] {
        self.residual_of(&self.displacement(unknowns))
    }

    /// Residual of the equilibrium: (V - V0) / V0, and the moments of volume about the centre of
    /// gravity over V0 and the diagonal.
    fn residual_of(&self, Displacement { sums, .. }: &Displacement<T>) -> [T; 3] {
        let wanted = self.loading.mass / self.water.density;
        let arm = wanted * self.size;
        [sums.volume / wanted - 1.0, sums.moment.x / arm, sums.moment.y / arm]
    }
}

#[cfg(test)]
mod tests;
