use crate::control::{WallTerms, middlecoff};
use crate::lines::{Change, Control, Rows, larger, pass, transposed_control};
use crate::{Edge, GridError, Sheet};
use moldloft_num::{Order, Real, Surface, Vec3};
use rayon::prelude::*;

/// What the grid is drawn to besides smoothness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Nothing (Winslow 1966).
    #[default]
    Laplace,
    /// The spacing of the edges, carried inward (Thomas and Middlecoff 1980).
    Middlecoff,
    /// Spacings and angles at walls (Steger and Sorenson 1979), on top of Middlecoff's terms.
    Sorenson,
}

/// An edge at which the grid shall have a spacing and an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall<T> {
    /// The edge.
    pub edge: Edge,
    /// The spacing off the wall: one for all points, or one of each.
    pub spacing: Vec<T>,
    /// The angle to the wall, in radians.
    pub angle: T,
}

/// How a grid is smoothed.
pub struct Elliptic<'a, T: Real> {
    /// What it is drawn to.
    pub method: Method,
    /// The most sweeps; each solves every grid line of one direction once, the directions taking
    /// turns, two sweeps each.
    pub sweeps: usize,
    /// Stops when no point moves by more than this share of the size.
    pub tolerance: f64,
    /// Over-relaxation, between 0 and 2.
    pub omega: f64,
    /// For [`Method::Sorenson`].
    pub walls: Vec<Wall<T>>,
    /// The surface that the points stay on, with their parameters u and v at the start; the points
    /// move freely without.
    pub on: Option<(&'a dyn Surface<T>, [Vec<T>; 2])>,
}

/// Sweeps in one direction before it is the other's turn: rows and columns change places then.
const TURN: usize = 2;

/// A smoothed grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed<T> {
    /// The grid.
    pub sheet: Sheet<T>,
    /// The sweeps that were done.
    pub sweeps: usize,
    /// The greatest step of the last sweep, as a share of the size.
    pub change: f64,
}

/// The sheet with its inner points moved towards a solution of
/// a (r_xx + p r_x) - 2 b r_xy + c (r_yy + q r_y) = 0, a = |r_y|^2, b = r_x . r_y, c = |r_x|^2,
/// by line over-relaxation in two colours; the edges stay.
///
/// Derivatives are those of the sweeps that were done. The same bits at any number of threads.
///
/// # Errors
/// [`GridError::TooFew`], [`GridError::NotFinite`], [`GridError::Diverged`].
pub fn elliptic<T: Real>(
    sheet: &Sheet<T>,
    options: &Elliptic<T>,
) -> Result<Smoothed<T>, GridError> {
    sheet.check_count(3)?;
    sheet.check_finite()?;
    let size = sheet.size();
    let (m, n) = (sheet.m, sheet.n);
    // A component that is the same everywhere stays so.
    let varies = |c: &usize| {
        let plane = &sheet.planes[*c];
        !plane.iter().all(|x| x.bits_eq(plane[0]))
    };
    let mut components: Vec<usize> = (0..3).filter(varies).collect();
    if components.len() < 2 || options.on.is_some() {
        components = vec![0, 1, 2];
    }
    let planes: Vec<Vec<T>> = components.iter().map(|&c| sheet.planes[c].clone()).collect();
    let mut state = State { rows: Rows::of(m, n, &planes), turned: false };
    let merged = |state: &State<T>| {
        let rows = if state.turned { state.rows.transposed() } else { state.rows.clone() };
        let mut planes = sheet.planes.clone();
        for (&c, plane) in components.iter().zip(rows.planes()) {
            planes[c] = plane;
        }
        Sheet { m, n, planes }
    };
    let base = match options.method {
        Method::Laplace => None,
        Method::Middlecoff | Method::Sorenson => Some(middlecoff(sheet)),
    };
    let mut terms = (options.method == Method::Sorenson && !options.walls.is_empty())
        .then(|| WallTerms::new(sheet, &options.walls));
    let mut control = base.as_ref().map(|base| [base.clone(), transposed_control(base, m, n)]);
    let mut constraint = options.on.as_ref().map(|(surface, uv)| {
        let rows = Rows::of(m, n, uv);
        Constraint { surface: *surface, rows }
    });
    let mut change = f64::INFINITY;
    let mut done = 0;
    while done < options.sweeps {
        if let (Some(terms), Some(base)) = (&mut terms, &base) {
            let now = merged(&state);
            terms.update(&now, &options.walls);
            let new = terms.control(&now, &options.walls, base);
            let turned = transposed_control(&new, m, n);
            control = Some([new, turned]);
        }
        let control: Option<&Control<T>> =
            control.as_ref().map(|both| &both[usize::from(state.turned)]);
        let mut square: f64 = 0.0;
        for colour in 0..2 {
            let moved = match &mut constraint {
                Some(constraint) => {
                    constraint.pass(&mut state.rows, colour, options.omega, control)
                }
                None => pass(&mut state.rows, colour, options.omega, control),
            };
            square = larger(square, moved);
        }
        done += 1;
        if !square.is_finite() {
            return Err(GridError::Diverged { step: done });
        }
        change = square.sqrt() / size;
        if change <= options.tolerance {
            break;
        }
        if done % TURN == 0 && done < options.sweeps {
            state.rows = state.rows.transposed();
            state.turned = !state.turned;
            if let Some(constraint) = &mut constraint {
                constraint.rows = constraint.rows.transposed();
            }
        }
    }
    Ok(Smoothed { sheet: merged(&state), sweeps: done, change })
}

struct State<T> {
    rows: Rows<T>,
    /// True when the rows run along i.
    turned: bool,
}

/// Points that stay on a surface: their parameters move instead.
struct Constraint<'a, T: Real> {
    surface: &'a dyn Surface<T>,
    rows: Rows<T>,
}

impl<T: Real> Constraint<'_, T> {
    /// Solves all inner rows of one colour for steps in the surface, over-relaxed by `omega`.
    ///
    /// What is left over of the equations at a point counts in the tangent plane only; its component
    /// along the normal is what keeps the grid on the surface. The steps that the row's equations give
    /// are projected to the tangent planes, turned into steps of (u, v), kept inside the surface, and
    /// the points evaluated there.
    fn pass(
        &mut self,
        rows: &mut Rows<T>,
        colour: usize,
        omega: f64,
        control: Option<&Control<T>>,
    ) -> Change {
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
                // At a singular place of the surface the point stays.
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
