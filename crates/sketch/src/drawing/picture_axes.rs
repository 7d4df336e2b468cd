//! The axes of an untyped picture.
//!
//! Directions that lines share are candidates, and the vertical is one for the axis that points up. Of
//! all choices of three the likeliest is taken: by the lines along them, by where axes usually are on a
//! page, and by the contradictions between planes that remain once all lines are typed.

use crate::drawing::line_types::FAULT;
use crate::drawing::noise::{PRINCIPAL, Stroke};
use crate::{CoordinateAxis, Drawing, Free, Projection};
use moldloft_num::Real;

/// Maximum number of directions that are tried, and least angle between two of them, in degrees.
const MOST_DIRECTIONS: usize = 8;
const LEAST_ANGLE: f64 = 10.0;

/// Width of the Gaussian of a line in the histogram of directions, and reach of the mean about a
/// peak, in degrees.
const PEAK_WIDTH: f64 = 2.0;
const PEAK_REACH: f64 = 4.0;

/// Largest angle of the axis that points up from the vertical, and its standard deviation, in degrees.
const MOST_LEAN: f64 = 30.0;
const LEAN: f64 = 2.5;

/// Standard deviation of the other axes from the horizontal, in degrees.
const GROUND_ANGLE: f64 = 35.0;

/// Loss of likelihood, as a logarithm, by an axis that is fitted to lines rather than vertical.
const FITTED_AXIS: f64 = 4.0;

/// Number of contradictions that may make the likeliest choice by the lines alone a worse one.
const MOST_CONTRADICTIONS: f64 = 4.0;

/// Number of choices for which all lines are typed, and of fits of their axes.
const MOST_TYPED: usize = 8;
const AXIS_FITS: usize = 4;

/// The angle between two directions of lines in degrees, from -90 to 90.
fn apart(a: f64, b: f64) -> f64 {
    (a - b + 90.0).rem_euclid(180.0) - 90.0
}

/// Directions that lines share, in degrees from 0 to 180, those of most lines first.
fn peaks(strokes: &[Stroke]) -> Vec<f64> {
    let polar: Vec<(f64, f64)> = (strokes.iter())
        .map(|s| (Real::atan2(s.d[1], s.d[0]).to_degrees().rem_euclid(180.0), s.length))
        .collect();
    let mut height = [0.0; 180];
    for (k, h) in height.iter_mut().enumerate() {
        for &(angle, _) in &polar {
            let z = apart(angle, k as f64 + 0.5) / PEAK_WIDTH;
            *h += Real::exp(-0.5 * z * z);
        }
    }
    let mut order: Vec<usize> = (0..180).collect();
    order.sort_by(|&a, &b| height[b].total_cmp(&height[a]).then(a.cmp(&b)));
    let mut found: Vec<f64> = Vec::new();
    for k in order {
        let (h, centre) = (height[k], k as f64 + 0.5);
        let highest = h > 0.0 && h >= height[(k + 179) % 180] && h >= height[(k + 1) % 180];
        let new = found.iter().all(|&p| apart(p, centre).abs() >= LEAST_ANGLE);
        if highest && new && found.len() < MOST_DIRECTIONS {
            found.push(centre);
        }
    }
    let refined = |peak: f64| {
        let near = polar.iter().filter(|(angle, _)| apart(*angle, peak).abs() <= PEAK_REACH);
        let (sum, weight) = near.fold((0.0, 0.0), |(s, w), &(angle, length)| {
            (s + length * apart(angle, peak), w + length)
        });
        if weight > 0.0 { (peak + sum / weight).rem_euclid(180.0) } else { peak }
    };
    found.into_iter().map(refined).collect()
}

/// Logarithm of the likelihood of a choice of axes by itself; `drawn` if lines show the vertical one.
fn usual([x, y, z]: [f64; 3], drawn: bool) -> f64 {
    let square = |a: f64, deviation: f64| (a / deviation).powi(2) / 2.0;
    let ground = square(apart(x, 0.0), GROUND_ANGLE) + square(apart(y, 0.0), GROUND_ANGLE);
    -ground - square(apart(z, 90.0), LEAN) - if drawn { FITTED_AXIS } else { 0.0 }
}

/// Logarithm of the likelihood of a stroke along an axis, and as an inclined one.
fn line_fit(s: &Stroke, sigma: f64, angle_deg: f64) -> [f64; 2] {
    let (sin, cos) = (Real::sin(angle_deg.to_radians()), Real::cos(angle_deg.to_radians()));
    let miss = s.d[0] * sin - s.d[1] * cos;
    let width = Real::sqrt(2.0) * sigma / s.length;
    let mean = (width * Real::sqrt(2.0 / std::f64::consts::PI)).min(1.0);
    [
        Real::ln(PRINCIPAL / 3.0) - miss * miss / (4.0 * sigma * sigma),
        Real::ln((1.0 - PRINCIPAL) * mean),
    ]
}

impl Drawing {
    /// The axes of an untyped picture, from the directions of its lines: the third one is vertical or
    /// close to it, the first one is the flatter of the others. `None` when the lines do not show two
    /// directions beside the vertical.
    pub fn axes_of_lines(&self) -> Option<Projection> {
        let strokes = self.strokes();
        let sigma = self.pen_noise_of(&strokes, &peaks(&strokes));
        let mut choices = self.choices(&strokes, sigma);
        choices.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = choices.first()?.0;
        choices.retain(|c| c.0 >= best - MOST_CONTRADICTIONS * FAULT);
        choices.truncate(MOST_TYPED);
        let typed = choices.into_iter().map(|(_, angles, drawn)| {
            let mut fitted = self.clone();
            fitted.projection = Projection { angle_deg: angles, scale: [1.0; 3] };
            fitted.fit_axes(&strokes);
            let angles = fitted.projection.angle_deg;
            let contradictions = fitted.typed_contradictions();
            let lines = strokes.iter().map(|s| {
                let axis = fitted.lines[&s.id].free.and_then(Free::single);
                let angle = axis.map_or(0.0, |a| angles[a.index()]);
                line_fit(s, sigma, angle)[usize::from(axis.is_none())]
            });
            let score = usual(angles, drawn) + lines.sum::<f64>();
            (score - FAULT * contradictions as f64, fitted.projection)
        });
        typed.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, projection)| projection)
    }

    /// Choices of axes with their likelihood by the lines alone.
    fn choices(&self, strokes: &[Stroke], sigma: f64) -> Vec<(f64, [f64; 3], bool)> {
        let peaks = peaks(strokes);
        let up = peaks.iter().copied().filter(|p| apart(*p, 90.0).abs() <= MOST_LEAN);
        // Both ground axes point to the right.
        let right = |a: f64| if a > 90.0 { a + 180.0 } else { a };
        let mut choices = Vec::new();
        for (z, drawn) in up.map(|z| (z, true)).chain([(90.0, false)]) {
            let beside = |p: &f64| apart(*p, z).abs() >= LEAST_ANGLE;
            let ground: Vec<f64> = peaks.iter().copied().filter(beside).collect();
            for (k, a) in ground.iter().enumerate() {
                for b in &ground[..k] {
                    let flat = |p: &f64| apart(*p, 0.0).abs();
                    let (x, y) = if flat(a) <= flat(b) { (*a, *b) } else { (*b, *a) };
                    let angles = [right(x), right(y), z];
                    let lines = strokes.iter().map(|s| {
                        let along = angles.map(|angle| line_fit(s, sigma, angle)[0]);
                        along.into_iter().fold(line_fit(s, sigma, z)[1], f64::max)
                    });
                    choices.push((usual(angles, drawn) + lines.sum::<f64>(), angles, drawn));
                }
            }
        }
        choices
    }

    /// Moves the axes to where the lines along them are drawn.
    fn fit_axes(&mut self, strokes: &[Stroke]) {
        for _ in 0..AXIS_FITS {
            for (axis, [x, y]) in self.pen_fit(strokes).axes {
                let angle = &mut self.projection.angle_deg[axis.index()];
                let to = Real::atan2(y, x).to_degrees();
                *angle += (to - *angle + 180.0).rem_euclid(360.0) - 180.0;
            }
        }
    }

    /// The standard deviation of a coordinate of an end, from the lines near these directions.
    fn pen_noise_of(&self, strokes: &[Stroke], directions: &[f64]) -> f64 {
        let axes: Vec<(CoordinateAxis, [f64; 2])> = (directions.iter())
            .map(|a| (CoordinateAxis::X, [Real::cos(a.to_radians()), Real::sin(a.to_radians())]))
            .collect();
        self.pen_noise(strokes, &axes)
    }
}
