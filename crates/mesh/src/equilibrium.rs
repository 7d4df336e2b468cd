//! The attitude in which a body of given mass floats at rest.

use crate::afloat::rim;
use crate::hydrostatics::{displaced, skin_of};
use crate::{Afloat, Attitude, Mesh, Symmetry, Water, afloat};
use moldloft_num::{Dual, Real, Vec3, solve_dense};
use std::fmt;

/// What floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loading<T> {
    /// Mass.
    pub mass: T,
    /// Centre of gravity in the body's axes; needed where trim or heel are free.
    pub centre: Option<Vec3<T>>,
    /// The trim is sought too, not kept.
    pub free_trim: bool,
    /// The heel is sought too, not kept.
    pub free_heel: bool,
}

/// How a solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The residual is rounding.
    Converged,
    /// The best attitude found is not an equilibrium.
    NotConverged,
}

/// An equilibrium, or the best attempt at one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved<T> {
    /// The figures there.
    pub afloat: Afloat<T>,
    /// Whether it is one.
    pub status: Status,
    /// Newton steps.
    pub iterations: usize,
    /// Largest of: the error of the volume over the volume, those of the arms over the diagonal.
    pub residual: f64,
    /// True when small turns about the free axes are righted.
    pub stable: bool,
}

/// Why a body cannot float so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloatError {
    /// The mass is not a positive number.
    Mass {
        /// The mass.
        mass: f64,
    },
    /// Trim or heel are free but no centre of gravity is given.
    NoCentre,
    /// A mesh of one side cannot heel.
    HalfHeels,
    /// There is no skin, or it encloses nothing.
    NoBody,
    /// The mass is more than the body displaces when it is all under water.
    Sinks {
        /// The mass.
        mass: f64,
        /// The most it displaces.
        most: f64,
    },
}

impl fmt::Display for FloatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mass { mass } => write!(f, "the displacement {mass} is not a positive number"),
            Self::NoCentre => {
                write!(f, "trim and heel need a centre of gravity to come to rest")
            }
            Self::HalfHeels => write!(f, "one side of a body cannot heel by itself"),
            Self::NoBody => write!(f, "the panels enclose no body that could float"),
            Self::Sinks { mass, most } => write!(
                f,
                "the displacement {mass} is more than the body displaces all under water, {most}"
            ),
        }
    }
}

impl std::error::Error for FloatError {}

/// The most Newton steps; a ship takes about five.
const MOST_STEPS: usize = 60;

/// Residual that counts as rounding, and the one that does where steps no longer improve it.
const TIGHT: f64 = 1e-13;
const LOOSE: f64 = 1e-9;

/// The largest turn of a step, in radians.
const LARGEST_TURN: f64 = 0.2;

/// The attitude at rest, from `start` (its level is not used): level, and trim and heel where these
/// are free.
///
/// The level is first found at the given trim and heel, by Newton steps within a bracket; then all
/// unknowns together by Newton's method with exact derivatives and shortened steps, on the real
/// parts. One more step in `T` gives the derivatives of the solution (implicit function theorem).
/// An equilibrium may be unstable: see [`Solved::stable`].
///
/// # Errors
/// [`FloatError`].
pub fn equilibrium<T: Real>(
    mesh: &Mesh<T>,
    water: Water,
    loading: Loading<T>,
    start: Attitude<T>,
) -> Result<Solved<T>, FloatError> {
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
    let real = mesh.re();
    let problem = Problem::new(&real, water, loading)?;
    let level = problem.level(start.trim.re(), start.heel.re())?;
    let from = [level, start.trim.re(), start.heel.re()];
    let (at, iterations, residual) = problem.newton(from);
    let status = if residual <= LOOSE { Status::Converged } else { Status::NotConverged };

    // One Newton step in T: the unknowns move so that the residual's derivative vanishes.
    let constant = at.map(T::from);
    let seeded = [constant[0], start.trim, start.heel];
    let fixed: [T; 3] =
        std::array::from_fn(|k| if problem.free.contains(&k) { constant[k] } else { seeded[k] });
    let (skin, free) = (problem.skin.clone(), problem.free.clone());
    let (count, size) = (problem.count, problem.size);
    let exact = Problem { mesh, water, loading, skin, free, count, size };
    let off = exact.residual(fixed);
    let mut unknowns = fixed;
    if let Some(step) = problem.step(at, |r| off[r]) {
        for (&k, dx) in problem.free.iter().zip(step) {
            unknowns[k] += dx;
        }
    }
    let afloat = afloat(mesh, water, Attitude::of(unknowns), loading.centre);
    let stable = match afloat.gm {
        Some([transverse, lengthwise]) => {
            (!loading.free_heel || transverse.re() > 0.0)
                && (!loading.free_trim || lengthwise.re() > 0.0)
        }
        None => true,
    };
    Ok(Solved { afloat, status, iterations, residual, stable })
}

/// The equations of rest, made dimensionless: volume, trimming arm, heeling arm.
struct Problem<'m, T: Real> {
    mesh: &'m Mesh<T>,
    water: Water,
    loading: Loading<T>,
    /// The faces of the skin.
    skin: Vec<usize>,
    /// Which of level, trim and heel are sought: equation k for unknown k.
    free: Vec<usize>,
    /// 1, or -1 where the panels' normals point inward; times 2 for one of two sides.
    count: f64,
    /// Diagonal of the mesh.
    size: f64,
}

impl<'m> Problem<'m, f64> {
    fn new<S: Real>(
        mesh: &'m Mesh<f64>,
        water: Water,
        loading: Loading<S>,
    ) -> Result<Self, FloatError> {
        let skin = skin_of(mesh);
        let bounds = mesh.bounds();
        let size = bounds.diagonal();
        if skin.is_empty() || !(size > 0.0 && size.is_finite()) {
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
        // Half under water the sign of the volume tells which way the normals point.
        let middle = bounds.centre();
        let (volume, _) = displaced(mesh, &skin, middle);
        if volume == 0.0 {
            return Err(FloatError::NoBody);
        }
        let sides = if water.symmetry == Symmetry::MirroredTwice { 2.0 } else { 1.0 };
        Ok(Self { mesh, water, loading, skin, free, count: sides * volume.signum(), size })
    }

    /// The level at which the body displaces its mass, at a trim and heel.
    fn level(&self, trim: f64, heel: f64) -> Result<f64, FloatError> {
        let turned = Attitude { level: 0.0, trim, heel }.turned(self.mesh);
        let bounds = turned.bounds();
        let density = self.water.density;
        let wanted = self.loading.mass / density;
        let volume = |z: f64| {
            let level = Dual::<1>::seeded(z, 0);
            let lifted = lifted(&turned);
            let (v, _) = displaced(&lifted, &self.skin, Vec3::new(0.0.into(), 0.0.into(), level));
            (v.re * self.count - wanted, v.eps[0] * self.count)
        };
        // A hair above the top, so that panels in the top are under water too.
        let (mut low, mut high) = (bounds.low.z, bounds.high.z + 1e-9 * self.size);
        // Beyond its rim an open body gains nothing: it is full there.
        let full = rim(&turned, self.water.symmetry).map_or(high, |z| z.min(high));
        let most = volume(full).0.max(volume(high).0) + wanted;
        if wanted > most * (1.0 + 1e-12) {
            return Err(FloatError::Sinks { mass: self.loading.mass, most: most * density });
        }
        if volume(full).0 >= 0.0 {
            high = full;
        }
        let mut z = 0.5 * (low + high);
        for _ in 0..200 {
            let (off, slope) = volume(z);
            if off.abs() <= TIGHT * wanted {
                break;
            }
            if off > 0.0 {
                high = z
            } else {
                low = z
            }
            let newton = z - off / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if next == z || high - low <= 1e-15 * self.size {
                break;
            }
            z = next;
        }
        Ok(z)
    }

    /// The residuals and their derivatives by level, trim and heel.
    fn slopes(&self, at: [f64; 3]) -> [Dual<3>; 3] {
        let unknowns = std::array::from_fn(|k| Dual::<3>::seeded(at[k], k));
        let loading = Loading {
            mass: Dual::from(self.loading.mass),
            centre: self.loading.centre.map(Vec3::lifted),
            free_trim: self.loading.free_trim,
            free_heel: self.loading.free_heel,
        };
        let mesh = lifted(self.mesh);
        let (water, skin, free) = (self.water, self.skin.clone(), self.free.clone());
        let (count, size) = (self.count, self.size);
        Problem { mesh: &mesh, water, loading, skin, free, count, size }.residual(unknowns)
    }

    /// The Newton step of the free unknowns against the residuals `off`.
    fn step<T: Real>(&self, at: [f64; 3], off: impl Fn(usize) -> T) -> Option<Vec<T>> {
        let slopes = self.slopes(at);
        let entries = self.free.iter().flat_map(|&r| self.free.iter().map(move |&c| (r, c)));
        let mut matrix: Vec<T> = entries.map(|(r, c)| T::from(slopes[r].eps[c])).collect();
        let mut step: Vec<T> = self.free.iter().map(|&r| -off(r)).collect();
        solve_dense(&mut matrix, &mut step).ok()?;
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    fn worst(&self, residual: [f64; 3]) -> f64 {
        self.free.iter().map(|&k| residual[k].abs()).fold(0.0, f64::max)
    }

    fn newton(&self, from: [f64; 3]) -> ([f64; 3], usize, f64) {
        let bounds = self.mesh.bounds();
        let height = bounds.diagonal();
        let mut at = from;
        let mut worst = self.worst(self.residual(at));
        let mut steps = 0;
        while worst > TIGHT && steps < MOST_STEPS {
            let residual = self.residual(at);
            let Some(step) = self.step(at, |k| residual[k]) else { break };
            let mut share: f64 = 1.0;
            for (&k, dx) in self.free.iter().zip(&step) {
                let most = if k == 0 { 0.25 * height } else { LARGEST_TURN };
                share = share.min(most / dx.abs().max(f64::MIN_POSITIVE));
            }
            let mut better = false;
            for _ in 0..12 {
                let mut next = at;
                for (&k, dx) in self.free.iter().zip(&step) {
                    next[k] += share * dx;
                }
                let off = self.worst(self.residual(next));
                if off < worst {
                    (at, worst, better) = (next, off, true);
                    break;
                }
                share *= 0.5;
            }
            steps += 1;
            if !better {
                break;
            }
        }
        (at, steps, worst)
    }
}

impl<T: Real> Problem<'_, T> {
    /// What is missing to rest: (V - V0) / V0, and the moments of volume about the centre of gravity
    /// over V0 and the diagonal.
    fn residual(&self, unknowns: [T; 3]) -> [T; 3] {
        let attitude = Attitude::of(unknowns);
        let turned = attitude.turned(self.mesh);
        let wanted = self.loading.mass / self.water.density;
        let centre = self.loading.centre.unwrap_or_default();
        let g = attitude.earth_from(centre);
        // Moments about the centre of gravity, so that a far origin costs no digits.
        let origin = Vec3::new(g.x, g.y, attitude.level);
        let (volume, moment) = displaced(&turned, &self.skin, origin);
        let arm = wanted * self.size;
        [
            volume * self.count / wanted - 1.0,
            moment.x * self.count / arm,
            moment.y * self.count / arm,
        ]
    }
}

fn lifted<T: Real>(mesh: &Mesh<f64>) -> Mesh<T> {
    let positions = mesh.positions().iter().map(|&p| Vec3::lifted(p)).collect();
    Mesh::new(mesh.topology().clone(), positions).expect("as many positions as before")
}

#[cfg(test)]
mod tests;
