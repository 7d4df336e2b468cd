//! Elliptic smoothing of surface grids, free or on a support surface.
//!
//! Holds: edges that are not periodic stay to the bit; the same bits at any number of threads.

use crate::control::{WallReport, WallTerms, middlecoff, wall_reports};
use crate::lines::{Change, Control, ZebraRows, larger, transposed_control};
use crate::periodic::{PeriodicSeam, crossed};
use crate::zebra::Banks;
use crate::{GridError, GridSide, SurfaceGrid};
use moldloft_budget::Budget;
use moldloft_num::{Order, Real, Surface, Vec3};
use moldloft_parallel::prelude::*;

/// Control of the spacing besides smoothness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Nothing (Winslow 1966).
    #[default]
    Laplace,
    /// The spacing of the edges, carried inward (Thomas and Middlecoff 1980).
    Middlecoff,
    /// Spacings and angles at walls (Steger and Sorenson 1979, with the update of Hilgenstock 1988), on top of
    /// Middlecoff's terms.
    Sorenson,
}

/// An edge at which the grid shall have a spacing and an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall<T> {
    /// The edge.
    pub edge: GridSide,
    /// The spacing off the wall: one for all points, or one of each.
    pub spacing: Vec<T>,
    /// The angle to the wall, in radians.
    pub angle: T,
}

/// Two opposite edges that are one line, the second moved by a constant vector: the cut of an O-grid, the sides of a
/// cascade. Their points move like those inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeriodicEdges {
    /// `s[1,]` and `s[m,]`
    I,
    /// `s[,1]` and `s[,n]`
    J,
}

/// Options of elliptic smoothing.
pub struct Elliptic<'a, T: Real> {
    /// Control of the spacing.
    pub method: Method,
    /// The most sweeps; each solves every grid line of one direction once, the directions taking
    /// turns, two sweeps each.
    pub sweeps: usize,
    /// Stops when no point moves by more than this, relative to the size.
    pub tolerance: f64,
    /// Over-relaxation, between 0 and 2.
    pub omega: f64,
    /// For [`Method::Sorenson`].
    pub walls: Vec<Wall<T>>,
    /// Edges that are smoothed across; walls are on the others.
    pub periodic: Option<PeriodicEdges>,
    /// The surface that the points stay on, with their parameters u and v at the start; the points
    /// move freely without.
    pub on: Option<(&'a dyn Surface<T>, [Vec<T>; 2])>,
}

/// Number of sweeps in one direction before the other's turn: rows and columns are exchanged then.
const TURN: usize = 2;

/// A smoothed grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed<T> {
    /// The grid.
    pub grid: SurfaceGrid<T>,
    /// The sweeps that were done.
    pub sweeps: usize,
    /// Largest step of the last sweep, relative to the size.
    pub change: f64,
    /// The largest step of each sweep, relative to the size.
    pub history: Vec<f64>,
    /// Deviations of the walls from their specification.
    pub walls: Vec<WallReport>,
    /// True if the points have converged and the walls are as specified.
    pub converged: bool,
}

/// Walls count as met when their cells, relatively, and angles, in radians, are off by no more.
const WALL_ACCURACY: f64 = 1e-6;

/// The grid with its inner points moved towards a solution of
/// a (r_xx + p r_x) - 2 b r_xy + c (r_yy + q r_y) = 0, a = |r_y|^2, b = r_x . r_y, c = |r_x|^2,
/// by line over-relaxation in two colours; edges that are not periodic stay.
///
/// Derivatives are those of the sweeps that were done. The same bits at any number of threads.
///
/// # Errors
/// [`GridError::TooFew`], [`GridError::NotFinite`], [`GridError::NotPeriodic`], [`GridError::Diverged`].
///
/// # Panics
/// With periodic edges on a support surface, or with a wall on a periodic edge.
pub fn elliptic<T: Real>(
    grid: &SurfaceGrid<T>,
    options: &Elliptic<T>,
) -> Result<Smoothed<T>, GridError> {
    elliptic_until(grid, options, &Budget::default())
}

/// As [`elliptic`]; ends early when `budget` is spent.
///
/// # Errors
/// Also [`GridError::Spent`].
pub fn elliptic_until<T: Real>(
    grid: &SurfaceGrid<T>,
    options: &Elliptic<T>,
    budget: &Budget,
) -> Result<Smoothed<T>, GridError> {
    if options.periodic == Some(PeriodicEdges::J) {
        let done = elliptic_until(&grid.transposed(), &crossed(options), budget)?;
        let walls = done.walls.into_iter();
        let walls = walls.map(|wall| WallReport { edge: wall.edge.crossed(), ..wall }).collect();
        return Ok(Smoothed { grid: done.grid.transposed(), walls, ..done });
    }
    // Rows side by side that fill the widest registers; numbers with derivatives fill several.
    match T::PARTS {
        1 => smoothed::<T, 8>(grid, options, budget),
        _ => smoothed::<T, 2>(grid, options, budget),
    }
}

fn smoothed<T: Real, const L: usize>(
    grid: &SurfaceGrid<T>,
    options: &Elliptic<T>,
    budget: &Budget,
) -> Result<Smoothed<T>, GridError> {
    grid.check_count(3)?;
    grid.check_finite()?;
    let size = grid.size();
    let seam = options.periodic.map(|_| PeriodicSeam::of(grid)).transpose()?;
    assert!(seam.is_none() || options.on.is_none(), "periodic edges are in a plane");
    let original = grid;
    let grid = &seam.as_ref().map_or_else(|| grid.clone(), |_| PeriodicSeam::widened(grid));
    let specified =
        &seam.as_ref().map_or_else(|| options.walls.clone(), |_| PeriodicSeam::walls(options));
    let (m, n) = (grid.m, grid.n);
    // A component that is the same everywhere stays so.
    let varies = |c: &usize| {
        let plane = &grid.planes[*c];
        !plane.iter().all(|x| x.bits_eq(plane[0]))
    };
    let mut components: Vec<usize> = (0..3).filter(varies).collect();
    if components.len() < 2 || options.on.is_some() {
        components = vec![0, 1, 2];
    }
    let planes: Vec<Vec<T>> = components.iter().map(|&c| grid.planes[c].clone()).collect();
    let mut points = match &options.on {
        None => SmoothedPoints::Free(Banks::<T, L>::of(m, n, &planes)),
        Some((surface, uv)) => SmoothedPoints::On(Constraint {
            surface: *surface,
            points: ZebraRows::of(m, n, &planes),
            rows: ZebraRows::of(m, n, uv),
        }),
    };
    let mut turned = false;
    let merged = |points: &SmoothedPoints<T, L>, turned: bool| {
        let mut planes = grid.planes.clone();
        for (&c, plane) in components.iter().zip(points.planes(turned)) {
            planes[c] = plane;
        }
        SurfaceGrid { m, n, planes }
    };
    let base = match options.method {
        Method::Laplace => None,
        Method::Middlecoff | Method::Sorenson => Some(middlecoff(grid, seam.is_some())),
    };
    let mut terms = (options.method == Method::Sorenson && !options.walls.is_empty())
        .then(|| WallTerms::new(grid, specified));
    let both = |control: &Control<T>| {
        let turned = transposed_control(control, m, n);
        let bank = |m: usize, n: usize, c: &Control<T>| {
            Banks::<T, L>::of(m, n, &[c.along.clone(), c.across.clone()])
        };
        let banks = [bank(m, n, control), bank(n, m, &turned)];
        ([control.clone(), turned], banks)
    };
    let mut control = base.as_ref().map(both);
    let mut history = Vec::new();
    let mut done = 0;
    let mut converged = false;
    while done < options.sweeps {
        budget.poll()?;
        let mut met = true;
        if let (Some(terms), Some(base)) = (&mut terms, &base) {
            let now = merged(&points, turned);
            met = terms.update(&now, specified).iter().all(|wall| wall.error() <= WALL_ACCURACY);
            control = Some(both(&terms.control(&now, specified, base)));
        }
        let way = usize::from(turned);
        let mut square: f64 = 0.0;
        for colour in 0..2 {
            let moved = match (&mut points, &control) {
                (SmoothedPoints::Free(banks), control) => {
                    let control = control.as_ref().map(|(_, banks)| &banks[way]);
                    let moved = banks.pass(colour, options.omega, control);
                    if let Some(seam) = &seam {
                        seam.close(banks, turned, &components);
                    }
                    moved
                }
                (SmoothedPoints::On(constraint), control) => {
                    let control = control.as_ref().map(|(planes, _)| &planes[way]);
                    constraint.pass(colour, options.omega, control)
                }
            };
            square = larger(square, moved);
        }
        done += 1;
        if !square.is_finite() {
            return Err(GridError::Diverged { step: done });
        }
        let change = square.sqrt() / size;
        history.push(change);
        if change <= options.tolerance && met {
            converged = true;
            break;
        }
        if done % TURN == 0 && done < options.sweeps {
            points.turn();
            turned = !turned;
        }
    }
    let grid = merged(&points, turned);
    let walls = wall_reports(&grid, specified);
    let grid = seam.map_or(grid.clone(), |_| PeriodicSeam::narrowed(&grid, original));
    let change = history.last().copied().unwrap_or(f64::INFINITY);
    Ok(Smoothed { grid, sweeps: done, change, history, walls, converged })
}

/// The current points, as rows along j, or along i when they are turned.
enum SmoothedPoints<'a, T: Real, const L: usize> {
    Free(Banks<T, L>),
    On(Constraint<'a, T>),
}

impl<T: Real, const L: usize> SmoothedPoints<'_, T, L> {
    /// Rows become columns.
    fn turn(&mut self) {
        match self {
            SmoothedPoints::Free(banks) => banks.transpose(),
            SmoothedPoints::On(constraint) => {
                constraint.points = constraint.points.transposed();
                constraint.rows = constraint.rows.transposed();
            }
        }
    }

    fn planes(&self, turned: bool) -> Vec<Vec<T>> {
        match (self, turned) {
            (SmoothedPoints::Free(banks), false) => banks.planes(),
            (SmoothedPoints::Free(banks), true) => {
                let mut banks = banks.clone();
                banks.transpose();
                banks.planes()
            }
            (SmoothedPoints::On(constraint), false) => constraint.points.planes(),
            (SmoothedPoints::On(constraint), true) => constraint.points.transposed().planes(),
        }
    }
}

/// Points that stay on a surface: their parameters move instead.
struct Constraint<'a, T: Real> {
    surface: &'a dyn Surface<T>,
    points: ZebraRows<T>,
    /// Their parameters.
    rows: ZebraRows<T>,
}

impl<T: Real> Constraint<'_, T> {
    /// Solves all inner rows of one colour for steps in the surface, over-relaxed by `omega`.
    ///
    /// Only the tangential residual at a point counts; the normal component is the constraint force
    /// of the surface. The steps of the row's equations are projected to the tangent planes,
    /// converted to steps of (u, v), limited to the surface, and the points evaluated there.
    fn pass(&mut self, colour: usize, omega: f64, control: Option<&Control<T>>) -> Change {
        let rows = &mut self.points;
        let (m, n) = (rows.m, rows.n);
        let [even, odd] = &mut rows.colours;
        let (own, other) = if colour == 0 { (even, &*odd) } else { (odd, &*even) };
        let [x, y, z] = &mut own[..] else { unreachable!("three components") };
        let [u, v] = &mut self.rows.colours[colour][..] else { unreachable!("two parameters") };
        let surface = self.surface;
        let lines = x.par_chunks_mut(n).zip(y.par_chunks_mut(n)).zip(z.par_chunks_mut(n));
        let lines = lines.zip(u.par_chunks_mut(n)).zip(v.par_chunks_mut(n)).enumerate();
        let steps = lines.map(|(r, ((((x, y), z), u), v))| {
            let row = 2 * r + colour;
            let mut most: Change = 0.0;
            if row == 0 || row + 1 == m {
                return most;
            }
            let beside = |row: usize, j: usize| {
                let k = row / 2 * n + j;
                Vec3::new(other[0][k], other[1][k], other[2][k])
            };
            let point = |j: usize| Vec3::new(x[j], y[j], z[j]);
            let jets: Vec<_> = (0..n).map(|j| surface.jet(u[j], v[j], Order::First)).collect();
            // Forward elimination of low d_(j-1) + middle d_j + high d_(j+1) = left over.
            let mut factors = vec![T::zero(); n];
            let mut solved = vec![Vec3::zero(); n];
            for j in 1..n - 1 {
                let (before, here, after) = (point(j - 1), point(j), point(j + 1));
                let (up, down) = (beside(row + 1, j), beside(row - 1, j));
                let (along, across) = (after - before, up - down);
                let mixed =
                    beside(row + 1, j + 1) - beside(row + 1, j - 1) - beside(row - 1, j + 1)
                        + beside(row - 1, j - 1);
                let (a, b, g) = (along.norm_sq(), along.dot(across), across.norm_sq());
                let [p, q] = control.map_or([T::zero(); 2], |control| {
                    [control.across[row * n + j] * 0.5, control.along[row * n + j] * 0.5]
                });
                let (low, high) = (g - g * q, g + g * q);
                let middle = (a + g) * -2.0;
                let right = mixed * (b * 0.5) - (up + down + across * p) * a;
                let left = right - before * low - after * high - here * middle;
                let (su, sv) = (jets[j].u, jets[j].v);
                let normal = su.cross(sv);
                let square = normal.norm_sq();
                let flat = if square.re() > 0.0 {
                    left - normal * (normal.dot(left) / square)
                } else {
                    Vec3::zero()
                };
                let whole = middle - low * factors[j - 1];
                if whole.re() == 0.0 {
                    continue;
                }
                factors[j] = high / whole;
                solved[j] = (flat - solved[j - 1] * low) / whole;
            }
            let mut step = Vec3::zero();
            for j in (1..n - 1).rev() {
                step = solved[j] - step * factors[j];
                let jet = &jets[j];
                let (e, f, g) = (jet.u.norm_sq(), jet.u.dot(jet.v), jet.v.norm_sq());
                let whole = e * g - f * f;
                let (a, b) = (jet.u.dot(step) * omega, jet.v.dot(step) * omega);
                // At a singular point of the surface the point stays.
                if whole.re() > 1e-12 * (e * g).re() {
                    let inside = |t: T| t.max(T::zero()).min(T::one());
                    u[j] = inside(u[j] + (a * g - b * f) / whole);
                    v[j] = inside(v[j] + (b * e - a * f) / whole);
                    let p = surface.jet(u[j], v[j], Order::Zero).p;
                    most = larger(most, (p - Vec3::new(x[j], y[j], z[j])).re().norm_sq());
                    (x[j], y[j], z[j]) = (p.x, p.y, p.z);
                }
            }
            most
        });
        let steps: Vec<Change> = steps.collect();
        steps.into_iter().fold(0.0, larger)
    }
}
