//! Strokes of a pen or mouse as lines, arcs, ellipses and splines.
//!
//! The samples are gathered in cells of equal length along the stroke. Dynamic programming divides the
//! cells into lines and arcs of least description length: the squared distances, in units of the noise
//! of the stroke, and a cost for each piece (J.-H. Horng, J. T. Li, "A dynamic programming approach for
//! fitting digital planar curves with line segments and circular arcs", Pattern Recognition Letters 22,
//! 2001; G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978). Circles are
//! those of G. Taubin (IEEE PAMI 13, 1991), ellipses those of R. Halíř and J. Flusser (WSCG 1998). Pieces
//! that join smoothly become one part of an ellipse, or a spline, if that is shorter to describe.

mod cells;
mod division;
mod joints;
mod shapes;

use cells::{StrokeCells, closed_part, noise_of_samples};

/// A sample of a pen or mouse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenSample {
    /// Position on the page.
    pub at: [f64; 2],
    /// Time, in any unit; samples are put in its order.
    pub time: Option<f64>,
    /// Pressure of the pen: samples of pressure 0 are not drawn.
    pub pressure: Option<f64>,
}

/// Kind of a piece of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeKind {
    /// A straight line.
    Line,
    /// An arc of a circle.
    Arc,
    /// A circle.
    Circle,
    /// An arc of an ellipse.
    EllipseArc,
    /// An ellipse.
    Ellipse,
    /// A chain of cubics.
    Spline,
}

impl StrokeKind {
    /// The word for data and messages.
    pub fn word(self) -> &'static str {
        match self {
            StrokeKind::Line => "line",
            StrokeKind::Arc => "arc",
            StrokeKind::Circle => "circle",
            StrokeKind::EllipseArc => "elliptical arc",
            StrokeKind::Ellipse => "ellipse",
            StrokeKind::Spline => "spline",
        }
    }
}

/// A piece of a stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokePiece {
    /// Its kind.
    pub kind: StrokeKind,
    /// The ends of a line; start, middle and end of an arc; none of a circle or ellipse; the 3 n + 1
    /// Bézier points of a spline of n cubics.
    pub points: Vec<[f64; 2]>,
    /// Centre of an arc, circle or ellipse.
    pub centre: Option<[f64; 2]>,
    /// Radius of an arc or circle.
    pub radius: Option<f64>,
    /// Half-axes of an ellipse, the longer one first.
    pub half_axes: Option<[[f64; 2]; 2]>,
    /// Root mean square distance of the samples.
    pub residual: f64,
    /// True if the next piece continues it without a corner.
    pub smooth: bool,
}

/// A stroke as pieces, joined end to start.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokeFit {
    /// The pieces in the order of the stroke.
    pub pieces: Vec<StrokePiece>,
    /// True if the last piece ends at the start of the first one.
    pub closed: bool,
    /// Standard deviation of the samples across the stroke.
    pub noise: f64,
    /// Distance within which ends are one point.
    pub tolerance: f64,
}

/// Reason why samples are no stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeFault {
    /// A coordinate, time or pressure of this sample, from 0, is not a finite number.
    NotFinite(usize),
    /// Fewer than two places.
    NoLength,
}

impl std::fmt::Display for StrokeFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            StrokeFault::NotFinite(k) => {
                write!(f, "sample {} of the stroke is not a finite number", k + 1)
            }
            StrokeFault::NoLength => f.write_str("the stroke has no length"),
        }
    }
}

/// Joints with smaller turns, in radians, are smooth where an arc is beside them.
const SMOOTH: f64 = 0.42;

/// The tolerance of ends, in standard deviations of the noise and relative to the size of the stroke.
const JOINED: f64 = 5.0;
const JOINED_SIZE: f64 = 0.03;

/// Fits pieces to the samples of one stroke, in time proportional to their number.
///
/// # Errors
/// Samples that are not finite, or all at one position.
///
/// ```
/// use moldloft_sketch::{PenSample, StrokeKind, fit_stroke};
/// let corner = |k: u32| {
///     let s = f64::from(k);
///     let at = if k <= 20 { [s * 5.0, 0.0] } else { [100.0, (s - 20.0) * 5.0] };
///     PenSample { at, ..PenSample::default() }
/// };
/// let samples: Vec<PenSample> = (0..=40).map(corner).collect();
/// let fit = fit_stroke(&samples).unwrap();
/// assert!(fit.pieces.iter().all(|p| p.kind == StrokeKind::Line));
/// assert_eq!(fit.pieces.len(), 2);
/// ```
pub fn fit_stroke(samples: &[PenSample]) -> Result<StrokeFit, StrokeFault> {
    let points = pen_positions(samples)?;
    let (low, high) = bounds(&points);
    let size = libm::hypot(high[0] - low[0], high[1] - low[1]);
    if !(size > 0.0 && size.is_finite()) {
        return Err(StrokeFault::NoLength);
    }
    let middle = [0, 1].map(|k| 0.5 * low[k] + 0.5 * high[k]);
    // The stroke in units of its size.
    let points: Vec<[f64; 2]> =
        points.iter().map(|p| [0, 1].map(|k| (p[k] - middle[k]) / size)).collect();
    let cells = StrokeCells::of(&points, noise_of_samples(&points));
    let reach = (JOINED * cells.noise).max(JOINED_SIZE);
    let part = closed_part(&cells, reach);
    let closed = part.is_some();
    let mut cells = match part {
        Some(part) => division::from_corner(cells.part(part)),
        None => cells,
    };
    // The noise and the shapes that are shortest to describe together.
    let mut best: Option<(f64, f64, Vec<shapes::FittedRun>)> = None;
    for division in division::divisions(&cells) {
        cells.noise = division.noise;
        let least = cells.independent() * libm::log(division.noise);
        if best.as_ref().is_some_and(|b| least + shapes::LEAST.min(division.cost) >= b.0) {
            continue;
        }
        let (fitted, cost) = shapes::fitted(&cells, &division.runs, closed);
        if best.as_ref().is_none_or(|b| cost + least < b.0) {
            best = Some((cost + least, division.noise, fitted));
        }
    }
    let Some((_, noise, fitted)) = best else { return Err(StrokeFault::NoLength) };
    cells.noise = noise;
    let tolerance = (JOINED * noise).max(JOINED_SIZE);
    let mut pieces = joints::joined(&cells, &fitted, closed);
    for piece in &mut pieces {
        let at = |p: &mut [f64; 2]| *p = [0, 1].map(|k| middle[k] + size * p[k]);
        piece.points.iter_mut().chain(piece.centre.as_mut()).for_each(at);
        piece.radius = piece.radius.map(|r| r * size);
        piece.half_axes = piece.half_axes.map(|h| h.map(|a| a.map(|x| x * size)));
        piece.residual *= size;
    }
    Ok(StrokeFit { pieces, closed, noise: noise * size, tolerance: tolerance * size })
}

/// The positions where the pen was down, in the order of time, without repetitions.
///
/// # Errors
/// As for [`fit_stroke`].
pub fn pen_positions(samples: &[PenSample]) -> Result<Vec<[f64; 2]>, StrokeFault> {
    for (k, s) in samples.iter().enumerate() {
        let numbers = s.at.into_iter().chain(s.time).chain(s.pressure);
        if !numbers.into_iter().all(f64::is_finite) {
            return Err(StrokeFault::NotFinite(k));
        }
    }
    let mut order: Vec<&PenSample> = samples.iter().filter(|s| s.pressure != Some(0.0)).collect();
    if order.iter().all(|s| s.time.is_some()) {
        order.sort_by(|a, b| a.time.unwrap_or(0.0).total_cmp(&b.time.unwrap_or(0.0)));
    }
    let mut points: Vec<[f64; 2]> = order.into_iter().map(|s| s.at).collect();
    points.dedup();
    if points.len() < 2 { Err(StrokeFault::NoLength) } else { Ok(points) }
}

fn bounds(points: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    points.iter().fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), p| {
        ([0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k])))
    })
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn to(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

/// The angle by which a direction turns into another one, in radians within half a turn.
fn turn(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::atan2(cross(a, b), dot(a, b))
}
