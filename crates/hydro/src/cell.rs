//! A piece of a skin: a tensor-product polynomial in Bernstein form over the unit square.
//! Surfaces are interpolated by cells at Chebyshev points between their joints; a cell whose last
//! Chebyshev coefficients are not negligible is halved. The remaining ones bound the distance to
//! the surface.

use crate::bernstein::{MOST_DEGREE, basis, halves};
use crate::chart::{Chart, charts};
use crate::trimmed::TrimLoops;
use moldloft_num::period::crease_rate;
use moldloft_num::{Order, Real, Surface, Vec3};
use std::sync::OnceLock;

/// A polynomial patch; its outward normal is -S_u x S_v if `reversed`.
#[derive(Clone, Debug)]
pub struct PolynomialCell<T> {
    degree: [usize; 2],
    /// Control points, (i, j) at `[i * (degree[1] + 1) + j]`.
    net: Vec<Vec3<T>>,
    pub(crate) reversed: bool,
    /// True for each of the edges v = 0, u = 1, v = 1, u = 0 of the surface that it reaches.
    border: [bool; 4],
    /// Estimated distance to the surface from the last coefficients along u and along v.
    pub(crate) fit: [f64; 2],
}

/// Tolerances of a fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitLimits {
    /// Negligible distance.
    pub distance: f64,
    /// Negligible area: distance times the length across.
    pub area: f64,
    /// Negligible relative error of a derivative.
    pub relative: f64,
}

impl FitLimits {
    /// Tolerances for surfaces that need too many cells.
    fn coarser(self) -> Self {
        let Self { distance, area, relative } = self;
        Self { distance: 30.0 * distance, area: 30.0 * area, relative: 30.0 * relative }
    }
}

/// Maximum number of cells of a surface.
const MOST_CELLS: usize = 6000;

/// Maximum number of cells while derivatives are fitted as well: such a cell costs several times as
/// much.
const MOST_CELLS_FOR_SLOPES: usize = 1500;

/// Maximum number of halvings of a cell in one direction.
const DEEPEST: u32 = 40;

/// Maximum number of halvings where only derivatives with respect to model parameters miss their
/// tolerance, which rounding may prevent.
const DEEPEST_FOR_SLOPES: u32 = 8;

impl<T: Real> PolynomialCell<T> {
    /// The bilinear cell of four corners, counter-clockwise seen from outside; a triangle repeats
    /// its last corner.
    pub fn of_panel([a, b, c, d]: [Vec3<T>; 4]) -> Self {
        Self {
            degree: [1, 1],
            net: vec![a, d, b, c],
            reversed: false,
            border: [false; 4],
            fit: [0.0; 2],
        }
    }

    /// The corners of a panel of three.
    pub(crate) fn triangle(&self) -> Option<[Vec3<T>; 3]> {
        let three = self.degree == [1, 1] && self.net[1].re() == self.net[3].re();
        three.then(|| [self.net[0], self.net[2], self.net[3]])
    }

    /// A part of a triangle, in its plane and of its sense.
    pub(crate) fn part_of_triangle(&self, [a, b, c]: [Vec3<T>; 3]) -> Self {
        Self { reversed: self.reversed, fit: self.fit, ..Self::of_panel([a, b, c, c]) }
    }

    pub(crate) fn degree(&self) -> [usize; 2] {
        self.degree
    }

    pub(crate) fn net(&self) -> &[Vec3<T>] {
        &self.net
    }

    /// The cell under an affine map; `turned` is true if the map reverses the normal.
    pub fn mapped(&self, map: impl Fn(Vec3<T>) -> Vec3<T>, turned: bool) -> Self {
        Self {
            net: self.net.iter().map(|&p| map(p)).collect(),
            reversed: self.reversed ^ turned,
            degree: self.degree,
            border: self.border,
            fit: self.fit,
        }
    }

    /// The cell without derivatives.
    pub fn re(&self) -> PolynomialCell<f64> {
        PolynomialCell {
            degree: self.degree,
            net: self.net.iter().map(|p| p.re()).collect(),
            reversed: self.reversed,
            border: self.border,
            fit: self.fit,
        }
    }

    /// A cell with zero derivatives.
    pub fn lifted(cell: &PolynomialCell<f64>) -> Self {
        Self {
            degree: cell.degree,
            net: cell.net.iter().map(|&p| Vec3::lifted(p)).collect(),
            reversed: cell.reversed,
            border: cell.border,
            fit: cell.fit,
        }
    }

    /// The cell with these numbers, each made by `number`.
    pub(crate) fn with_numbers<S: Real>(
        &self,
        mut number: impl FnMut(T) -> S,
    ) -> PolynomialCell<S> {
        PolynomialCell {
            degree: self.degree,
            net: self.net.iter().map(|p| p.map(&mut number)).collect(),
            reversed: self.reversed,
            border: self.border,
            fit: self.fit,
        }
    }

    /// True when it reaches edge `k` of the surface.
    pub(crate) fn on_edge(&self, k: usize) -> bool {
        self.border[k]
    }

    /// The control points of the edge v = 0, u = 1, v = 1, u = 0, for k = 0 to 3.
    pub fn edge(&self, k: usize) -> Vec<Vec3<T>> {
        let [du, dv] = self.degree;
        let at = |i: usize, j: usize| self.net[i * (dv + 1) + j];
        match k {
            0 => (0..=du).map(|i| at(i, 0)).collect(),
            1 => (0..=dv).map(|j| at(du, j)).collect(),
            2 => (0..=du).map(|i| at(i, dv)).collect(),
            _ => (0..=dv).map(|j| at(0, j)).collect(),
        }
    }

    /// The control points of the line along `inner` at `w` of the other parameter, and their
    /// derivatives with respect to `w`.
    pub(crate) fn line(&self, inner: usize, w: T, at: &mut Vec<Vec3<T>>, by: &mut Vec<Vec3<T>>) {
        let [du, dv] = self.degree;
        at.clear();
        by.clear();
        let (b, slope) = basis(self.degree[1 - inner], w);
        let (count, across, step, along) =
            if inner == 0 { (du + 1, dv + 1, 1, dv + 1) } else { (dv + 1, du + 1, dv + 1, 1) };
        for k in 0..count {
            let (mut p, mut d) = (Vec3::zero(), Vec3::zero());
            for m in 0..across {
                let c = self.net[k * along + m * step];
                p += c * b[m];
                d += c * slope[m];
            }
            at.push(p);
            by.push(d);
        }
    }

    /// The two halves along u (0) or v (1).
    pub(crate) fn split(&self, along: usize) -> [Self; 2] {
        let [du, dv] = self.degree;
        let mut parts = [self.clone(), self.clone()];
        if along == 1 {
            for i in 0..=du {
                let row = i * (dv + 1)..(i + 1) * (dv + 1);
                let [low, high] = halves(&self.net[row.clone()]);
                parts[0].net[row.clone()].copy_from_slice(&low);
                parts[1].net[row].copy_from_slice(&high);
            }
        } else {
            for j in 0..=dv {
                let column: Vec<_> = (0..=du).map(|i| self.net[i * (dv + 1) + j]).collect();
                for (part, half) in parts.iter_mut().zip(halves(&column)) {
                    for (i, p) in half.into_iter().enumerate() {
                        part.net[i * (dv + 1) + j] = p;
                    }
                }
            }
        }
        parts
    }

    /// The part of it that halvings leave: each the parameter along, and which half.
    pub(crate) fn along_path(&self, path: &[[u8; 2]]) -> Self {
        path.iter().fold(self.clone(), |cell, &[along, half]| {
            let [low, high] = cell.split(usize::from(along));
            if half == 0 { low } else { high }
        })
    }

    /// Maximum lengths of its control polygons along u and along v.
    pub(crate) fn lengths(&self) -> [f64; 2] {
        let [du, dv] = self.degree;
        let at = |i: usize, j: usize| self.net[i * (dv + 1) + j].re();
        let along_u = |j: usize| (0..du).map(|i| at(i, j).distance(at(i + 1, j))).sum::<f64>();
        let along_v = |i: usize| (0..dv).map(|j| at(i, j).distance(at(i, j + 1))).sum::<f64>();
        [(0..=dv).map(along_u).fold(0.0, f64::max), (0..=du).map(along_v).fold(0.0, f64::max)]
    }
}

/// The cells of a surface or, with loops, of its part within them; `None` if it is not finite, or
/// the loops bound no part. `reversed` is true for an outward normal of -S_u x S_v.
/// A part of another surface is also cut along the break lines of that surface.
pub(crate) fn cells_of<T: Real>(
    surface: &dyn Surface<T>,
    loops: Option<&TrimLoops<'_, T>>,
    reversed: bool,
    limits: FitLimits,
) -> Option<Vec<PolynomialCell<T>>> {
    let division = SurfaceDivision::new(surface, loops)?;
    let mut sampling = Sampling::new();
    let fit = &mut |frame: &CellFrame<'_, T>| {
        let samples = sampling.on(surface, frame, |x| x, || {});
        samples.interpolated(frame.border(), reversed)
    };
    let cells = division.cells(limits, fit)?;
    Some(cells.into_iter().map(|(_, cell)| cell).collect())
}

/// The parts of a surface that cells begin with: between its joints, or charts of what loops leave
/// of it.
pub(crate) struct SurfaceDivision<T> {
    us: Vec<T>,
    vs: Vec<T>,
    charts: Option<Vec<Chart<T>>>,
    /// The number of pieces between joints that are at other v from u to u; 0 where there are none, or where
    /// derivatives, which are less smooth at them, do not matter.
    pieces: usize,
}

impl<T: Real> SurfaceDivision<T> {
    /// `None` for loops that bound no part.
    pub fn new(surface: &dyn Surface<T>, loops: Option<&TrimLoops<'_, T>>) -> Option<Self> {
        let ends = |mut breaks: Vec<f64>, joints: Vec<f64>| {
            breaks.extend(joints);
            breaks.retain(|t| *t > 0.0 && *t < 1.0);
            breaks.extend([0.0, 1.0]);
            breaks.sort_by(f64::total_cmp);
            breaks.dedup_by(|a, b| *a - *b < 1e-13);
            breaks
        };
        let [bu, bv] = surface.breaks();
        let [ju, jv] = surface.joints();
        let (us, vs) = (ends(bu, ju), ends(bv, jv));
        let (us, vs) = (moving(surface, 0, &us), moving(surface, 1, &vs));
        let charts = charts(surface, loops, [&us, &vs])?;
        let whole = charts.is_none() && vs.len() == 2 && us.iter().all(|u| u.is_constant());
        let pieces = match T::PARTS > 1 && whole {
            true => surface.between_joints(&[0.5], &[0.5]).map_or(0, |points| points.len()),
            false => 0,
        };
        Some(Self { us, vs, charts, pieces })
    }

    fn frames(&self) -> Vec<CellFrame<'_, T>> {
        let whole = [0.0, 1.0, 0.0, 1.0].map(T::from);
        match &self.charts {
            Some(charts) => (charts.iter())
                .map(|chart| CellFrame { chart: Some(chart), piece: None, ends: whole })
                .collect(),
            None if self.pieces > 0 => {
                let of = self.pieces;
                let row = move |u: [T; 2]| {
                    let piece = move |at: usize| Some(FramePiece { at, of });
                    let ends = [u[0], u[1], T::zero(), T::one()];
                    (0..of).map(move |at| CellFrame { chart: None, piece: piece(at), ends })
                };
                self.us.windows(2).flat_map(|u| row([u[0], u[1]])).collect()
            }
            None => {
                let row = |u: [T; 2]| {
                    let ends = self.vs.windows(2).map(move |v| [u[0], u[1], v[0], v[1]]);
                    ends.map(|ends| CellFrame { chart: None, piece: None, ends })
                };
                self.us.windows(2).flat_map(|u| row([u[0], u[1]])).collect()
            }
        }
    }

    /// The cells by a fit, with their frames; `None` if a point is not finite.
    pub fn cells<C: Real>(
        &self,
        mut limits: FitLimits,
        fit: CellFit<'_, T, C>,
    ) -> Option<Vec<(CellFrame<'_, T>, PolynomialCell<C>)>> {
        let frames = self.frames();
        // If there are too many cells, the whole surface is fitted with larger tolerances.
        loop {
            match fitted_cells(&frames, limits, fit) {
                CellFits::Cells(cells) => return Some(cells),
                // Derivatives dominated by rounding never meet their tolerance: then only values
                // decide.
                CellFits::TooMany if T::PARTS > 1 && limits.relative.is_finite() => {
                    limits.relative = f64::INFINITY;
                }
                CellFits::TooMany => limits = limits.coarser(),
                CellFits::NotFinite => return None,
            }
        }
    }
}

/// A fit of a surface on a frame, with the relative errors of its derivatives along u and v; `None`
/// if a point is not finite.
pub(crate) type CellFit<'f, T, C> =
    &'f mut dyn FnMut(&CellFrame<'_, T>) -> Option<(PolynomialCell<C>, [f64; 2])>;

/// Result of fitting a surface by cells.
enum CellFits<'a, T, C> {
    Cells(Vec<(CellFrame<'a, T>, PolynomialCell<C>)>),
    TooMany,
    /// A point is not finite.
    NotFinite,
}

/// One of the pieces between joints across u.
#[derive(Clone, Copy)]
struct FramePiece {
    at: usize,
    of: usize,
}

/// A rectangle in the parameters of a chart, of a piece between joints, or of the surface.
#[derive(Clone, Copy)]
pub(crate) struct CellFrame<'a, T> {
    chart: Option<&'a Chart<T>>,
    piece: Option<FramePiece>,
    /// Minimum and maximum of u, minimum and maximum of v, which is relative to the width of a piece.
    ends: [T; 4],
}

/// Ends of frames of pieces, which share their samples.
pub(crate) type PieceEnds = [u64; 4];

impl<T: Real> CellFrame<'_, T> {
    /// The ends of the frame of a piece.
    pub fn piece_ends(&self) -> Option<PieceEnds> {
        self.piece.map(|_| self.ends.map(|t| t.re().to_bits()))
    }

    /// The index of the piece.
    pub fn piece(&self) -> usize {
        self.piece.map_or(0, |piece| piece.at)
    }

    /// The points of the surface of which the cells between these ends are made, of each piece.
    pub fn points_of_pieces(&self, surface: &dyn Surface<T>) -> Vec<Vec<Vec3<T>>> {
        self.places_in_pieces(surface, &tables().nodes)
    }

    fn places_in_pieces(&self, surface: &dyn Surface<T>, shares: &[f64]) -> Vec<Vec<Vec3<T>>> {
        let count = self.piece.map_or(0, |piece| piece.of);
        let [us, vs] = self.parameters(shares);
        let each = shares.len();
        let all = surface.between_joints(&us, &vs).filter(|all| all.len() == count * each * each);
        let of = |at: usize| match &all {
            Some(all) => {
                (0..each * each).map(|k| all[(k / each * count + at) * each + k % each]).collect()
            }
            None => vec![Vec3::of(f64::NAN, f64::NAN, f64::NAN); each * each],
        };
        (0..count).map(of).collect()
    }

    /// The parameters at these relative positions in the frame.
    fn parameters(&self, shares: &[f64]) -> [Vec<f64>; 2] {
        let [u0, u1, v0, v1] = self.ends.map(|t| t.re());
        let within = |a: f64, b: f64, s: f64| match s {
            0.0 => a,
            1.0 => b,
            s => a + (b - a) * s,
        };
        [(u0, u1), (v0, v1)].map(|(a, b)| shares.iter().map(|&s| within(a, b, s)).collect())
    }

    /// The halves along u (0) or v (1).
    fn halves(&self, along: usize) -> [Self; 2] {
        let [u0, u1, v0, v1] = self.ends;
        let halves = match along {
            0 => [[u0, (u0 + u1) * 0.5, v0, v1], [(u0 + u1) * 0.5, u1, v0, v1]],
            _ => [[u0, u1, v0, (v0 + v1) * 0.5], [u0, u1, (v0 + v1) * 0.5, v1]],
        };
        halves.map(|ends| CellFrame { ends, ..*self })
    }

    /// The points of the surface of which a cell is made.
    pub fn points(&self, surface: &dyn Surface<T>) -> Vec<Vec3<T>> {
        let shares = &tables().nodes;
        if self.is_one_sided() {
            self.moving_places(surface, shares)
        } else {
            self.places(surface, shares)
        }
    }

    /// Positions of the surface between these.
    pub fn probes(&self, surface: &dyn Surface<T>) -> Vec<Vec3> {
        self.places(surface, &PROBES).iter().map(|p| p.re()).collect()
    }

    /// True for each of the edges v = 0, u = 1, v = 1, u = 0 of the surface that it reaches.
    pub fn border(&self) -> [bool; 4] {
        let [u0, u1, v0, v1] = self.ends.map(|t| t.re());
        let ends = [v0 == 0.0, u1 == 1.0, v1 == 1.0, u0 == 0.0];
        let of_piece = |FramePiece { at, of }: FramePiece| [at == 0, true, at + 1 == of, true];
        match (self.chart, self.piece.map(of_piece)) {
            (Some(chart), _) => std::array::from_fn(|k| ends[k] && chart.border[k]),
            (None, Some(reached)) => std::array::from_fn(|k| ends[k] && reached[k]),
            (None, None) => ends,
        }
    }

    /// Points of the surface on a grid of relative positions in the frame.
    fn places(&self, surface: &dyn Surface<T>, shares: &[f64]) -> Vec<Vec3<T>> {
        let [us, vs] = self.parameters(shares);
        let mut points = vec![Vec3::zero(); us.len() * vs.len()];
        match self.chart {
            Some(chart) => {
                let all = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
                let uv: Vec<[f64; 2]> = all.map(|place| chart.real(place)).collect();
                surface.scattered(&uv, &mut points);
            }
            None => surface.grid(&us, &vs, &mut points, None),
        }
        points
    }

    /// The points with the derivatives of moving boundaries.
    fn moving_places(&self, surface: &dyn Surface<T>, shares: &[f64]) -> Vec<Vec3<T>> {
        let [u0, u1, v0, v1] = self.ends;
        let along = |a: T, b: T| shares.iter().map(|&s| a + (b - a) * s).collect::<Vec<T>>();
        let (us, vs) = (along(u0, u1), along(v0, v1));
        match self.chart {
            None => moving_grid(surface, &us, &vs),
            Some(chart) => moving_chart(surface, chart, &us, &vs),
        }
    }

    /// True when derivatives at its edges are those beside them, inside: edges move with a parameter
    /// of the model, or may touch a line at which the parent surface is not smooth.
    fn is_one_sided(&self) -> bool {
        T::PARTS > 1 && (self.chart.is_some() || !self.ends.iter().all(|t| t.is_constant()))
    }
}

/// The cells of all frames.
fn fitted_cells<'a, T: Real, C: Real>(
    frames: &[CellFrame<'a, T>],
    limits: FitLimits,
    fit: CellFit<'_, T, C>,
) -> CellFits<'a, T, C> {
    let mut stack: Vec<(CellFrame<'a, T>, [u32; 2])> =
        frames.iter().rev().map(|frame| (*frame, [0, 0])).collect();
    let slopes_count = T::PARTS > 1 && limits.relative.is_finite();
    let most = if slopes_count { MOST_CELLS_FOR_SLOPES } else { MOST_CELLS };
    let most = most.max(2 * frames.len());
    let mut cells = Vec::new();
    while let Some((frame, depth)) = stack.pop() {
        let Some((fitted, slopes)) = fit(&frame) else {
            return CellFits::NotFinite;
        };
        let [length_u, length_v] = fitted.lengths();
        // Points are not more accurate than their rounding.
        let size = fitted.net.iter().fold(0.0f64, |m, p| m.max(p.re().norm()));
        let distance = limits.distance.max(4e-14 * size);
        let negligible = |k: usize, across: f64| {
            let tail = fitted.fit[k];
            (tail <= distance || tail * across.max(tail) <= limits.area)
                && (slopes[k] <= limits.relative || depth[k] >= DEEPEST_FOR_SLOPES)
        };
        let rough = [!negligible(0, length_v), !negligible(1, length_u)];
        let [tail_u, tail_v] =
            [0, 1].map(|k| fitted.fit[k] / distance + slopes[k] / limits.relative);
        let worse = usize::from(tail_v > tail_u);
        let along = if rough[worse] { worse } else { 1 - worse };
        if rough[along] && depth[along] < DEEPEST {
            if cells.len() + stack.len() >= most {
                return CellFits::TooMany;
            }
            let mut deeper = depth;
            deeper[along] += 1;
            let [low, high] = frame.halves(along);
            stack.push((high, deeper));
            stack.push((low, deeper));
        } else {
            cells.push((frame, fitted));
        }
    }
    CellFits::Cells(cells)
}

/// Distance from a break at which one side of it is evaluated, relative to the cell.
const BESIDE: f64 = 1e-9;

/// The cell boundaries along u (0) or v (1), with the derivatives of their parameters: without
/// these a derivative would miss the strip swept by a moving break.
fn moving<T: Real>(surface: &dyn Surface<T>, along: usize, ends: &[f64]) -> Vec<T> {
    let last = ends.len() - 1;
    let kinks = if T::PARTS > 1 { std::mem::take(&mut surface.kinks()[along]) } else { Vec::new() };
    let end = |(k, &t): (usize, &f64)| {
        let inner = 0 < k && k < last && kinks.iter().any(|kink| (kink - t).abs() < 1e-13);
        let aside = |k: usize| BESIDE * (ends[k + 1] - ends[k]);
        if inner {
            crease_rate(surface, along, t, [aside(k - 1), aside(k)]) + t
        } else {
            T::from(t)
        }
    };
    ends.iter().enumerate().map(end).collect()
}

/// Positions of a surface on a grid of parameters. The first and last may be moving breaks, where
/// the side inside the grid is evaluated.
fn moving_grid<T: Real>(surface: &dyn Surface<T>, us: &[T], vs: &[T]) -> Vec<Vec3<T>> {
    let inside = |ts: &[T], k: usize| {
        let step = BESIDE * (ts[ts.len() - 1].re() - ts[0].re());
        match k {
            0 => step,
            k if k + 1 == ts.len() => -step,
            _ => 0.0,
        }
    };
    let mut points = Vec::with_capacity(us.len() * vs.len());
    for (i, &u) in us.iter().enumerate() {
        let du = inside(us, i);
        for (j, &v) in vs.iter().enumerate() {
            let dv = inside(vs, j);
            // The derivatives beside the break; the point on it.
            let jet = surface.jet(T::from(u.re() + du), T::from(v.re() + dv), Order::First);
            let beside = jet.p - jet.u * T::from(du) - jet.v * T::from(dv)
                + jet.u * (u - u.re())
                + jet.v * (v - v.re());
            let place = surface.jet(T::from(u.re()), T::from(v.re()), Order::Zero).p;
            points.push(beside - Vec3::lifted(beside.re()) + Vec3::lifted(place.re()));
        }
    }
    points
}

/// Points of a part on a grid of its chart. Boundaries may move; there the side inside the chart is
/// evaluated.
fn moving_chart<T: Real>(
    surface: &dyn Surface<T>,
    chart: &Chart<T>,
    us: &[T],
    vs: &[T],
) -> Vec<Vec3<T>> {
    // Where a line leaves it a chart narrows to a point: there the middle is inside.
    let inside = |place: [f64; 2]| -> [f64; 2] {
        let beside = place.map(|t| t.clamp(BESIDE, 1.0 - BESIDE));
        std::array::from_fn(|axis| {
            if beside[axis] == place[axis] {
                return place[axis];
            }
            let across = |t: f64| {
                let mut end = beside;
                end[axis] = t;
                chart.real(end)
            };
            let ([a, b], [c, d]) = (across(0.0), across(1.0));
            let width = (c - a).abs().max((d - b).abs());
            let step = if width > 2.0 * BESIDE { BESIDE / width } else { 0.5 };
            place[axis].clamp(step, 1.0 - step)
        })
    };
    let mut points = Vec::with_capacity(us.len() * vs.len());
    let mut exact = Vec::with_capacity(us.len() * vs.len());
    for &u in us {
        for &v in vs {
            let place = [u, v];
            let at = chart.at(place);
            let [x, y] = chart.real(inside(place.map(|t| t.re())));
            // The derivatives beside the boundary; the point on it.
            let jet = surface.jet(T::from(x), T::from(y), Order::First);
            points.push(jet.p + jet.u * (at[0] - x) + jet.v * (at[1] - y));
            exact.push(chart.real(place.map(|t| t.re())));
        }
    }
    let mut places = vec![Vec3::zero(); exact.len()];
    surface.scattered(&exact, &mut places);
    for (p, place) in points.iter_mut().zip(places) {
        *p = *p - Vec3::lifted(p.re()) + Vec3::lifted(place.re());
    }
    points
}

/// Parameters between the Chebyshev points at which an interpolation is checked.
const PROBES: [f64; 3] = [0.071, 0.457, 0.893];

/// The positions of a surface of which a cell is made, and positions between them.
#[derive(Clone)]
pub(crate) struct Samples<C> {
    points: Vec<Vec3<C>>,
    probes: Vec<Vec3>,
}

impl<C: Real> Samples<C> {
    /// The cell, with the relative errors of its derivatives along u and v; `None` if a point is not finite.
    pub fn interpolated(
        &self,
        border: [bool; 4],
        reversed: bool,
    ) -> Option<(PolynomialCell<C>, [f64; 2])> {
        let finite = self.points.iter().all(|p| p.is_finite());
        finite.then(|| interpolated(&self.points, &self.probes, border, reversed))?
    }
}

/// Samples of a surface; all pieces between the same ends are sampled at once.
pub(crate) struct Sampling<C> {
    of_pieces: Vec<(PieceEnds, Vec<Samples<C>>)>,
}

/// Maximum number of ends whose samples are kept.
const MOST_ENDS: usize = 32;

impl<C: Real> Sampling<C> {
    pub fn new() -> Self {
        Self { of_pieces: Vec::new() }
    }

    /// The samples on a frame, each number turned by `number`; `evaluated` is called when the
    /// surface is no longer needed.
    pub fn on<T: Real>(
        &mut self,
        surface: &dyn Surface<T>,
        frame: &CellFrame<'_, T>,
        number: impl Fn(T) -> C + Copy,
        evaluated: impl Fn(),
    ) -> Samples<C> {
        let turned = |points: &[Vec3<T>]| points.iter().map(|p| p.map(number)).collect();
        let Some(ends) = frame.piece_ends() else {
            let points = turned(&frame.points(surface));
            let probes = frame.probes(surface);
            evaluated();
            return Samples { points, probes };
        };
        let known = self.of_pieces.iter().position(|(known, _)| *known == ends);
        let at = known.unwrap_or_else(|| {
            let points = frame.points_of_pieces(surface);
            let probes = frame.places_in_pieces(surface, &PROBES);
            let pieces = points.iter().zip(&probes).map(|(points, probes)| Samples {
                points: turned(points),
                probes: probes.iter().map(|p| p.re()).collect(),
            });
            let pieces = pieces.collect();
            evaluated();
            if self.of_pieces.len() == MOST_ENDS {
                self.of_pieces.clear();
            }
            self.of_pieces.push((ends, pieces));
            self.of_pieces.len() - 1
        });
        self.of_pieces[at].1[frame.piece()].clone()
    }
}

/// The interpolation of points at the Chebyshev points, reduced to the lowest sufficient degree,
/// and the relative errors of its derivatives along u and v; `probes` are positions between them.
fn interpolated<T: Real>(
    points: &[Vec3<T>],
    probes: &[Vec3],
    border: [bool; 4],
    reversed: bool,
) -> Option<(PolynomialCell<T>, [f64; 2])> {
    const N: usize = MOST_DEGREE + 1;
    let tables = tables();
    let coefficients = transformed(points, [N, N], [&tables.analysis, &tables.analysis]);
    // Sums of the coefficient norms by rows and by columns.
    let row = |i: usize| (0..N).map(|j| coefficients[i * N + j].re().norm()).sum::<f64>();
    let column = |j: usize| (0..N).map(|i| coefficients[i * N + j].re().norm()).sum::<f64>();
    let size = coefficients.iter().fold(0.0f64, |m, c| m.max(c.re().norm()));
    let rounding = 2e-16 * size;
    let degree = |size_of: &dyn Fn(usize) -> f64| {
        (1..N).rev().find(|&k| size_of(k) > rounding * 8.0).unwrap_or(1)
    };
    let still = |k: usize, along: usize| {
        let at = |m: usize| if along == 0 { k * N + m } else { m * N + k };
        (0..N).all(|m| {
            let c = coefficients[at(m)];
            (1..T::PARTS).all(|p| {
                let largest = |x: T| x.probe(p).abs();
                largest(c.x).max(largest(c.y)).max(largest(c.z)) <= 1e-13 * (1.0 + size)
            })
        })
    };
    // Derivatives may need a higher degree than the points.
    let highest =
        |from: usize, along: usize| (from + 1..N).rev().find(|&k| !still(k, along)).unwrap_or(from);
    let (du, dv) = (highest(degree(&row), 0), highest(degree(&column), 1));
    let tail = |d: usize, size_of: &dyn Fn(usize) -> f64| {
        let left: f64 = (d + 1..N).map(size_of).sum();
        if d < N - 1 { left } else { size_of(N - 1) + size_of(N - 2) }
    };
    let mut fit = [tail(du, &row), tail(dv, &column)];
    let mut kept = Vec::with_capacity((du + 1) * (dv + 1));
    for i in 0..=du {
        kept.extend_from_slice(&coefficients[i * N..i * N + dv + 1]);
    }
    let to_bernstein = [&tables.synthesis[du], &tables.synthesis[dv]];
    let net = transformed(&kept, [du + 1, dv + 1], to_bernstein);
    let cell = PolynomialCell { degree: [du, dv], net, reversed, border, fit };
    // Check between the interpolation points, where an undeclared kink shows.
    let mut off: f64 = 0.0;
    let (mut at, mut by) = (Vec::new(), Vec::new());
    for (j, &v) in PROBES.iter().enumerate() {
        cell.line(0, T::from(v), &mut at, &mut by);
        for (i, &u) in PROBES.iter().enumerate() {
            let p = crate::bernstein::place_and_tangent(&at, T::from(u)).0.re();
            off = off.max(p.distance(probes[i * PROBES.len() + j]));
        }
    }
    if !off.is_finite() {
        return None;
    }
    if off > fit[0] + fit[1] + 1e-13 * (1.0 + size) {
        let worse = usize::from(fit[1] > fit[0]);
        fit[worse] = off;
        if fit[1 - worse] == 0.0 && cell.degree[1 - worse] > cell.degree[worse] {
            fit = [off, off];
        }
    }
    Some((PolynomialCell { fit, ..cell }, derivative_tails(&coefficients)))
}

/// The last coefficients of the derivatives along u and v, relative to the largest coefficient in
/// this direction.
fn derivative_tails<T: Real>(coefficients: &[Vec3<T>]) -> [f64; 2] {
    const N: usize = MOST_DEGREE + 1;
    let mut tails = [0.0f64; 2];
    for part in 1..T::PARTS {
        let size = |k: usize| {
            let c = coefficients[k];
            c.x.probe(part).abs().max(c.y.probe(part).abs()).max(c.z.probe(part).abs())
        };
        let most = (0..N * N).map(size).fold(0.0, f64::max);
        if most == 0.0 {
            continue;
        }
        for last in N - 2..N {
            let row = (0..N).map(|j| size(last * N + j)).fold(0.0, f64::max);
            let column = (0..N).map(|i| size(i * N + last)).fold(0.0, f64::max);
            tails[0] = tails[0].max(row / most);
            tails[1] = tails[1].max(column / most);
        }
    }
    tails
}

/// The weights of the points of which a cell of this degree is made, from those of its net.
pub(crate) fn pulled_points([du, dv]: [usize; 2], net: &[Vec3]) -> Vec<Vec3> {
    const N: usize = MOST_DEGREE + 1;
    let tables = tables();
    // Transposed: from Bernstein to Chebyshev coefficients, and from these to the points.
    let half = |d: usize| -> Vec<Vec<f64>> {
        (0..N)
            .map(|a| {
                let entry = |i: usize| -> f64 {
                    let of = |m: usize| tables.synthesis[d][i][m] * tables.analysis[m][a];
                    (0..=d).map(of).sum()
                };
                (0..=d).map(entry).collect()
            })
            .collect()
    };
    transformed(net, [du + 1, dv + 1], [&half(du), &half(dv)])
}

/// The Chebyshev points, and the matrices from values at these to Chebyshev coefficients and from
/// those to Bernstein coefficients.
struct Tables {
    nodes: Vec<f64>,
    analysis: Vec<Vec<f64>>,
    /// For each degree.
    synthesis: Vec<Vec<Vec<f64>>>,
}

fn tables() -> &'static Tables {
    static TABLES: OnceLock<Tables> = OnceLock::new();
    TABLES.get_or_init(|| {
        let n = MOST_DEGREE;
        let angle = |k: usize| std::f64::consts::PI * k as f64 / n as f64;
        // sin^2 is exact at both ends.
        let nodes = (0..=n).map(|k| libm::pow(libm::sin(0.5 * angle(k)), 2.0)).collect();
        // The discrete cosine transform at the extrema, in x = 1 - 2 s.
        let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
        let entry = |m: usize, k: usize| {
            2.0 / n as f64 * half(m) * half(k) * libm::cos(angle((m * k) % (2 * n)))
        };
        let analysis = (0..=n).map(|m| (0..=n).map(|k| entry(m, k)).collect()).collect();
        Tables { nodes, analysis, synthesis: (0..=n).map(bernstein_from_chebyshev).collect() }
    })
}

/// Row k, column m: the Bernstein coefficient k of T_m(1 - 2 s) in a degree. All are integers over binomials, exact:
/// T_m(1 - 2 s) has the coefficients (-1)^k C(2m, 2k) / C(m, k) in its own degree.
fn bernstein_from_chebyshev(degree: usize) -> Vec<Vec<f64>> {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    let mut matrix = vec![vec![0.0; degree + 1]; degree + 1];
    for m in 0..=degree {
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut row: Vec<f64> =
            (0..=m).map(|k| sign(k) * (choose(2 * m, 2 * k) / choose(m, k))).collect();
        for d in m..degree {
            // Raised by one degree.
            let raised = (0..=d + 1).map(|k| {
                let share = k as f64 / (d + 1) as f64;
                let before = if k > 0 { row[k - 1] } else { 0.0 };
                let here = if k <= d { row[k] } else { 0.0 };
                share * before + (1.0 - share) * here
            });
            row = raised.collect();
        }
        for (k, c) in row.into_iter().enumerate() {
            matrix[k][m] = c;
        }
    }
    matrix
}

/// The matrices applied along u and along v.
fn transformed<T: Real>(
    points: &[Vec3<T>],
    [nu, nv]: [usize; 2],
    [along_u, along_v]: [&Vec<Vec<f64>>; 2],
) -> Vec<Vec3<T>> {
    let scaled = |p: Vec3<T>, c: f64| p.map(|x| x * c);
    let (mu, mv) = (along_u.len(), along_v.len());
    let mut half = vec![Vec3::zero(); nu * mv];
    for i in 0..nu {
        for (j, row) in along_v.iter().enumerate() {
            let sum = (0..nv).fold(Vec3::zero(), |s, k| s + scaled(points[i * nv + k], row[k]));
            half[i * mv + j] = sum;
        }
    }
    let mut all = vec![Vec3::zero(); mu * mv];
    for (i, row) in along_u.iter().enumerate() {
        for j in 0..mv {
            all[i * mv + j] =
                (0..nu).fold(Vec3::zero(), |s, k| s + scaled(half[k * mv + j], row[k]));
        }
    }
    all
}
