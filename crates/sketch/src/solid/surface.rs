//! Surfaces of faces, and points where surfaces and curves meet, with derivatives.

use super::revolved::{RevolvedSurface, patch_parameters};
use crate::solid::curve::SmoothPiece;
use moldloft_num::GAUSS_8_UNIT;
use moldloft_num::{Real, Vec3, solve_dense};

/// The surface of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceSurface<T> {
    /// The plane through a point with a normal, which points outward on a face.
    Plane {
        /// A point of it.
        at: Vec3<T>,
        /// Unit normal.
        normal: Vec3<T>,
    },
    /// Straight lines from `near(u)` to `far(u)`.
    Ruled {
        /// The curve v = 0.
        near: SmoothPiece<T>,
        /// The curve v = 1.
        far: SmoothPiece<T>,
    },
    /// A profile rotated about an axis, right-handed, by u `sweep`.
    Turned {
        /// A point of the axis.
        centre: Vec3<T>,
        /// Its unit direction.
        axis: Vec3<T>,
        /// The curve u = 0, over v.
        profile: SmoothPiece<T>,
        /// The angle from u = 0 to u = 1, in radians.
        sweep: T,
    },
}

/// The points of a surface with one u, over v.
enum ParameterLine<'a, T> {
    Point(Vec3<T>),
    Straight {
        ends: [Vec3<T>; 2],
        across: [Vec3<T>; 2],
    },
    Profile {
        centre: &'a Vec3<T>,
        axis: &'a Vec3<T>,
        profile: &'a SmoothPiece<T>,
        sweep: T,
        /// Cosine and sine of the angle.
        turn: [T; 2],
    },
}

impl<T: Real> ParameterLine<'_, T> {
    fn jet(&self, v: T) -> Jet<T> {
        match self {
            ParameterLine::Point(at) => [*at, Vec3::zero(), Vec3::zero()],
            ParameterLine::Straight { ends: [a, b], across: [da, db] } => {
                [a.lerp(*b, v), da.lerp(*db, v), *b - *a]
            }
            ParameterLine::Profile { centre, axis, profile, sweep, turn: [c, s] } => {
                let (centre, axis, c, s) = (**centre, **axis, *c, *s);
                let turned =
                    |d: Vec3<T>| d * c + axis.cross(d) * s + axis * (axis.dot(d) * (-c + 1.0));
                let arm = turned(profile.at(v) - centre);
                [centre + arm, axis.cross(arm) * *sweep, turned(profile.velocity(v))]
            }
        }
    }
}

/// A point of a surface with the derivatives by u and v.
pub(crate) type Jet<T> = [Vec3<T>; 3];

impl<T: Real> FaceSurface<T> {
    /// The point (u, v) with derivatives. Planes have no parameters.
    pub(crate) fn jet(&self, u: T, v: T) -> Jet<T> {
        self.line(u).jet(v)
    }

    /// The line of the points with one u.
    fn line(&self, u: T) -> ParameterLine<'_, T> {
        match self {
            FaceSurface::Plane { at, .. } => ParameterLine::Point(*at),
            FaceSurface::Ruled { near, far } => ParameterLine::Straight {
                ends: [near.at(u), far.at(u)],
                across: [near.velocity(u), far.velocity(u)],
            },
            FaceSurface::Turned { centre, axis, profile, sweep } => {
                let turn = [(u * *sweep).cos(), (u * *sweep).sin()];
                ParameterLine::Profile { centre, axis, profile, sweep: *sweep, turn }
            }
        }
    }

    /// The parameters of a point on the surface: of one of revolution in closed form, else by a
    /// grid and Gauss-Newton steps.
    pub(crate) fn parameters(&self, p: Vec3) -> [f64; 2] {
        if let Some(at) = patch_parameters(self, p, [0.5; 2]) {
            return at;
        }
        let mut best = (f64::INFINITY, [0.5; 2]);
        for i in 0..=8 {
            for j in 0..=8 {
                let (u, v) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                let d = self.jet(T::from(u), T::from(v))[0].re().distance(p);
                if d < best.0 {
                    best = (d, [u, v]);
                }
            }
        }
        let mut at = best.1;
        for _ in 0..12 {
            let [s, du, dv] = self.jet(T::from(at[0]), T::from(at[1])).map(Vec3::re);
            let r = p - s;
            let (a, b, c) = (du.norm_sq(), du.dot(dv), dv.norm_sq());
            let (x, y) = (du.dot(r), dv.dot(r));
            let det = a * c - b * b;
            if det <= 1e-14 * a * c || det == 0.0 {
                break;
            }
            at[0] = (at[0] + (c * x - b * y) / det).clamp(-0.1, 1.1);
            at[1] = (at[1] + (a * y - b * x) / det).clamp(-0.1, 1.1);
        }
        at
    }

    /// The ends of v at which the surface degenerates to a point.
    fn poles(&self) -> [bool; 2] {
        let thin = |v: f64| {
            let size = |u: f64| self.jet(T::from(u), T::from(v))[1].re().norm();
            size(0.1) + size(0.6)
        };
        let middle = thin(0.5);
        [0.0, 1.0].map(|v| thin(v) <= 1e-9 * middle)
    }

    /// Start of integrals along v: at a pole if there is one.
    fn start(&self) -> f64 {
        if self.poles() == [false, true] { 1.0 } else { 0.0 }
    }

    /// The pole at which integrals along v end: its v and position.
    pub(crate) fn far_pole(&self) -> Option<(f64, Vec3)> {
        (self.poles() == [true, true]).then(|| (1.0, self.jet(T::from(0.5), T::one())[0].re()))
    }

    /// Calls `add` with points and vector areas so that their sums are the integrals over the part of
    /// the surface inside a closed curve: `nodes` are its (u, v, du) with weights in du; the third
    /// argument is the area of the element with its sign. By Green's
    /// theorem, with integrals along v by Gauss's rule.
    pub(crate) fn sweep(&self, nodes: &[[T; 3]], mut add: impl FnMut(Vec3<T>, Vec3<T>, T)) {
        let start = T::from(self.start());
        let parts = if matches!(self, FaceSurface::Ruled { .. }) { 1 } else { 3 };
        for &[u, v, du] in nodes {
            let length = v - start;
            let line = self.line(u);
            for part in 0..parts {
                for (x, w) in GAUSS_8_UNIT {
                    let x = (f64::from(part) + x) / f64::from(parts);
                    let [p, a, b] = line.jet(start + length * x);
                    let weight = -(length * du) * (w / f64::from(parts));
                    let (density, sign) = (a.cross(b), if weight.re() < 0.0 { -1.0 } else { 1.0 });
                    let element = density * weight;
                    // At zero width with a derivative, the length of the element has no derivative.
                    let size = match weight.re() == 0.0 {
                        true => density.norm() * weight,
                        false => element.norm() * T::from(sign),
                    };
                    add(p, element, size);
                }
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Carrier<'a, T> {
    Surface(&'a FaceSurface<T>),
    Curve(&'a SmoothPiece<T>),
}

/// A carrier as equations of a point.
enum CarrierForm<'a, T> {
    Plane(Vec3<T>, Vec3<T>),
    Level(RevolvedSurface<T>),
    Patch(&'a FaceSurface<T>),
    Curve(&'a SmoothPiece<T>),
}

impl<'a, T: Real> CarrierForm<'a, T> {
    fn of(carrier: &Carrier<'a, T>) -> CarrierForm<'a, T> {
        match *carrier {
            Carrier::Curve(piece) => CarrierForm::Curve(piece),
            Carrier::Surface(FaceSurface::Plane { at, normal }) => CarrierForm::Plane(*at, *normal),
            Carrier::Surface(surface) => match RevolvedSurface::of(surface) {
                Some(round) => CarrierForm::Level(round),
                None => CarrierForm::Patch(surface),
            },
        }
    }

    /// Number of its parameters.
    fn unknowns(&self) -> usize {
        match self {
            CarrierForm::Plane(..) | CarrierForm::Level(_) => 0,
            CarrierForm::Curve(_) => 1,
            CarrierForm::Patch(_) => 2,
        }
    }
}

/// A point with its parameters on its carriers.
#[derive(Clone, Debug)]
pub(crate) struct Met<T> {
    pub at: Vec3<T>,
    /// For each constraint: u and v, or s and nothing; zeros for planes and surfaces of revolution,
    /// which are equations.
    pub parameters: Vec<[T; 2]>,
    /// The derivatives of point and parameters for a unit motion of the constraints' last plane
    /// along its normal.
    pub moved: Vec3<T>,
    pub moved_parameters: Vec<[T; 2]>,
}

/// The point near `guess` on all of `on`, which must determine it. `None` if Newton's method does
/// not converge, as at a contact of surfaces.
pub(crate) fn meet<T: Real>(
    on: &[Carrier<'_, T>],
    guess: Vec3,
    start: &[[f64; 2]],
    scale: f64,
) -> Option<Met<T>> {
    if let &[Carrier::Curve(piece), Carrier::Surface(FaceSurface::Plane { at, normal })] = on {
        return curve_and_plane(piece, [*at, *normal], start[0][0], scale);
    }
    let forms: Vec<CarrierForm<'_, T>> = on.iter().map(CarrierForm::of).collect();
    let n = 3 + forms.iter().map(CarrierForm::unknowns).sum::<usize>();
    let rows: usize = forms.iter().map(|o| if o.unknowns() == 0 { 1 } else { 3 }).sum();
    if n != rows {
        return None;
    }
    let mut x: Vec<f64> = guess.to_array().to_vec();
    for (o, s) in forms.iter().zip(start) {
        x.extend_from_slice(&s[..o.unknowns()]);
    }
    let system = |x: &[T]| -> Option<(Vec<T>, Vec<T>)> {
        let (mut matrix, mut right) = (vec![T::zero(); n * n], vec![T::zero(); n]);
        let p = Vec3::new(x[0], x[1], x[2]);
        let (mut row, mut column) = (0, 3);
        for o in &forms {
            match o {
                CarrierForm::Plane(at, normal) => {
                    right[row] = normal.dot(p - *at);
                    for k in 0..3 {
                        matrix[row * n + k] = normal[k];
                    }
                    row += 1;
                }
                CarrierForm::Level(round) => {
                    let (level, gradient) = round.level(p)?;
                    right[row] = level;
                    for k in 0..3 {
                        matrix[row * n + k] = gradient[k];
                    }
                    row += 1;
                }
                CarrierForm::Patch(surface) => {
                    let [s, du, dv] = surface.jet(x[column], x[column + 1]);
                    for k in 0..3 {
                        right[row] = p[k] - s[k];
                        matrix[row * n + k] = T::one();
                        matrix[row * n + column] = -du[k];
                        matrix[row * n + column + 1] = -dv[k];
                        row += 1;
                    }
                    column += 2;
                }
                CarrierForm::Curve(piece) => {
                    let (s, ds) = (piece.at(x[column]), piece.velocity(x[column]));
                    for k in 0..3 {
                        right[row] = p[k] - s[k];
                        matrix[row * n + k] = T::one();
                        matrix[row * n + column] = -ds[k];
                        row += 1;
                    }
                    column += 1;
                }
            }
        }
        Some((matrix, right))
    };
    let plain = |x: &[f64]| -> Option<(Vec<f64>, Vec<f64>)> {
        let lifted: Vec<T> = x.iter().map(|&a| T::from(a)).collect();
        let (m, r) = system(&lifted)?;
        Some((m.into_iter().map(Real::re).collect(), r.into_iter().map(Real::re).collect()))
    };
    let mut last = f64::INFINITY;
    for step in 0..30 {
        let (mut matrix, mut right) = plain(&x)?;
        let size = right.iter().fold(0.0f64, |m, r| m.max(r.abs()));
        if !size.is_finite() {
            return None;
        }
        if size <= 1e-15 * scale || (step > 3 && size >= 0.5 * last && size <= 1e-12 * scale) {
            last = size;
            break;
        }
        last = size;
        solve_dense(&mut matrix, &mut right).ok()?;
        x.iter_mut().zip(&right).for_each(|(a, d)| *a -= d.clamp(-scale, scale));
    }
    if last > 1e-11 * scale {
        return None;
    }
    let lifted: Vec<T> = x.iter().map(|&a| T::from(a)).collect();
    let (mut matrix, mut right) = system(&lifted)?;
    solve_dense(&mut matrix, &mut right).ok()?;
    let exact: Vec<T> = lifted.iter().zip(&right).map(|(a, d)| *a - *d).collect();
    let (mut matrix, _) = system(&exact)?;
    let mut rate = vec![T::zero(); n];
    if forms.last()?.unknowns() == 0 {
        rate[n - 1] = T::one();
        solve_dense(&mut matrix, &mut rate).ok()?;
    }
    let split = |x: &[T]| {
        let mut column = 3;
        let mut all = Vec::with_capacity(on.len());
        for o in &forms {
            let count = o.unknowns();
            let at = |k: usize| if k < count { x[column + k] } else { T::zero() };
            all.push([at(0), at(1)]);
            column += count;
        }
        (Vec3::new(x[0], x[1], x[2]), all)
    };
    let (at, parameters) = split(&exact);
    let (moved, moved_parameters) = split(&rate);
    Some(Met { at, parameters, moved, moved_parameters })
}

/// The point of a curve in a plane, by its normal, near a parameter.
fn curve_and_plane<T: Real>(
    piece: &SmoothPiece<T>,
    [at, normal]: [Vec3<T>; 2],
    start: f64,
    scale: f64,
) -> Option<Met<T>> {
    let (mut s, mut last) = (start, f64::INFINITY);
    for step in 0..30 {
        let off = normal.dot(piece.at(T::from(s)) - at).re();
        let size = off.abs();
        if !size.is_finite() {
            return None;
        }
        let still = step > 3 && size >= 0.5 * last && size <= 1e-12 * scale;
        last = size;
        if size <= 1e-15 * scale || still {
            break;
        }
        let rate = normal.dot(piece.velocity(T::from(s))).re();
        if rate == 0.0 {
            return None;
        }
        s -= (off / rate).clamp(-scale, scale);
    }
    if last > 1e-11 * scale {
        return None;
    }
    let rate = normal.dot(piece.velocity(T::from(s)));
    let s = T::from(s) - normal.dot(piece.at(T::from(s)) - at) / rate;
    let way = piece.velocity(s);
    let by = T::one() / normal.dot(way);
    let none = [T::zero(); 2];
    Some(Met {
        at: piece.at(s),
        parameters: vec![[s, T::zero()], none],
        moved: way * by,
        moved_parameters: vec![[by, T::zero()], none],
    })
}
