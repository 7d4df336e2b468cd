//! Pictures of sets by ray casting: exact surfaces, lights, shadows, highlights.

use crate::facet::FacetOptions;
use crate::query::ray::{Hit, Ray};
use crate::query::ray_index::RayIndex;
use crate::{FieldError, Set};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_parallel::prelude::*;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Direction of parallel light; `None` for a lamp.
    pub direction: Option<Vec3>,
    /// Position of a lamp.
    pub place: Vec3,
    /// Linear red, green and blue; with 1 a white face perpendicular to the light is fully lit.
    pub colour: [f64; 3],
}

/// A view of a set with its lights.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTrace {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Position of the eye.
    pub eye: Vec3,
    /// Centre of the view.
    pub centre: Vec3,
    /// Upward direction.
    pub up: Vec3,
    /// Angle between the top and bottom of the picture.
    pub angle: f64,
    /// The lights.
    pub lights: Vec<Light>,
    /// Light from everywhere, linear.
    pub ambient: [f64; 3],
    /// sRGB at the top and bottom.
    pub background: [[u8; 3]; 2],
    /// True to draw shadows.
    pub shadows: bool,
    /// Strength of highlights, 0 to 1, and their sharpness.
    pub shine: [f64; 2],
    /// sRGB of each of the set's leaves.
    pub colours: Vec<[u8; 3]>,
    /// Fraction of light reflected by each of the set's leaves, 0 to 1; 0 for leaves not in the
    /// list.
    pub mirrors: Vec<f64>,
    /// Rays along each side of a pixel.
    pub samples: usize,
}

/// Maximum number of reflections of a ray: the rest is a thousandth for mirrors of one half.
const BOUNCES: u32 = 10;

fn linear(c: u8) -> f64 {
    Real::powf(f64::from(c) / 255.0, 2.2)
}

fn stored(x: f64) -> u8 {
    (Real::powf(x.clamp(0.0, 1.0), 1.0 / 2.2) * 255.0 + 0.5) as u8
}

/// Distance before the box at which rays begin, relative to it.
const MARGIN: f64 = 1e-6;
/// Angle between view and `up`, below which the view is vertical.
const STRAIGHT: f64 = 1e-9;

/// Parameters of a ray within a box.
fn clipped(start: Vec3, direction: Vec3, over: &Box3) -> Option<[f64; 2]> {
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for k in 0..3 {
        if direction[k] == 0.0 {
            if start[k] < over.low[k] || start[k] > over.high[k] {
                return None;
            }
            continue;
        }
        let (a, b) =
            ((over.low[k] - start[k]) / direction[k], (over.high[k] - start[k]) / direction[k]);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    (near < far).then_some([near, far])
}

/// The picture of a set within a box whose faces cut it: three bytes per pixel, row by row from the
/// top.
///
/// # Errors
/// A box without volume, a view without direction, a budget that is spent.
pub fn ray_trace(
    set: &Set,
    over: &Box3,
    view: &RayTrace,
    options: &FacetOptions,
) -> Result<Vec<u8>, FieldError> {
    let over = crate::error::solid_box(*over)?;
    let ahead = crate::error::unit("direction of the view", view.centre - view.eye)?;
    // Straight up or down, the second axis is up in the picture.
    let up = match ahead.cross(view.up).norm() > STRAIGHT * view.up.norm() {
        true => view.up,
        false => Vec3::of(0.0, 1.0, 0.0),
    };
    let right = crate::error::unit("direction that is up", ahead.cross(up))?;
    let upward = right.cross(ahead);
    let cut = set.clone() & Set::cuboid(over.low, over.high)?;
    let margin = MARGIN * over.diagonal();
    let more = Vec3::of(margin, margin, margin);
    let index = RayIndex::new(&cut, &Box3 { low: over.low - more, high: over.high + more });
    let [width, height] = view.size;
    let reach = Real::tan(0.5 * view.angle);
    let n = view.samples.max(1);
    let scene = RayScene { index: &index, over: &over, view };
    let rows: Vec<Vec<u8>> = (0..height)
        .into_par_iter()
        .map(|row| {
            let mut out = Vec::with_capacity(3 * width);
            if options.budget.is_spent() {
                return out;
            }
            for column in 0..width {
                let mut sum = [0.0; 3];
                for k in 0..n * n {
                    let at = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / n as f64;
                    let x = (2.0 * at(column, k % n) - width as f64) / height as f64;
                    let y = 1.0 - 2.0 * at(row, k / n) / height as f64;
                    let d = (ahead + right * (x * reach) + upward * (y * reach)).normalized();
                    let colour = d
                        .and_then(|d| scene.seen(view.eye, d, 0))
                        .unwrap_or_else(|| view.behind(row as f64 / height as f64));
                    for c in 0..3 {
                        sum[c] += colour[c];
                    }
                }
                out.extend(sum.map(|x| stored(x / (n * n) as f64)));
            }
            out
        })
        .collect();
    options.budget.poll()?;
    Ok(rows.concat())
}

impl RayTrace {
    /// The background, from its top at 0 to its bottom at 1.
    fn behind(&self, down: f64) -> [f64; 3] {
        let [top, bottom] = self.background;
        [0, 1, 2].map(|c| linear(top[c]) * (1.0 - down) + linear(bottom[c]) * down)
    }
}

struct RayScene<'a> {
    index: &'a RayIndex,
    over: &'a Box3,
    view: &'a RayTrace,
}

impl RayScene<'_> {
    fn first(&self, start: Vec3, direction: Vec3) -> Option<Hit> {
        let [near, far] = clipped(start, direction, self.over)?;
        // A little before the box, so that its faces are crossed and not begun on.
        let margin = MARGIN * self.over.diagonal();
        let begin = start + direction * (near - margin).max(0.0);
        let ray = Ray { start: begin, direction, length: far - near + 2.0 * margin };
        self.index.first(&ray)
    }

    /// The light that comes from where the ray ends.
    fn seen(&self, eye: Vec3, direction: Vec3, bounces: u32) -> Option<[f64; 3]> {
        let hit = self.first(eye, direction)?;
        // Sheets have two sides.
        let normal = if hit.normal.dot(direction) > 0.0 { -hit.normal } else { hit.normal };
        let own = self.view.colours.get(hit.leaf).copied().unwrap_or([0xb6, 0xbc, 0xc4]);
        let own = own.map(linear);
        let mut out = [0, 1, 2].map(|c| own[c] * self.view.ambient[c]);
        let away = 1e-6 * self.over.diagonal();
        for light in &self.view.lights {
            let (to, far) = match light.direction {
                Some(d) => (-d, f64::INFINITY),
                None => (light.place - hit.point, (light.place - hit.point).norm()),
            };
            let Some(to) = to.normalized() else { continue };
            let facing = normal.dot(to);
            if facing <= 0.0 {
                continue;
            }
            let from = hit.point + normal * away;
            let shaded = self.view.shadows
                && self.first(from, to).is_some_and(|h| (h.point - from).norm() < far);
            if shaded {
                continue;
            }
            let half = (to - direction).normalized().unwrap_or(normal);
            let [strength, power] = self.view.shine;
            let glint = strength * Real::powf(normal.dot(half).max(0.0), power);
            for c in 0..3 {
                out[c] += light.colour[c] * (own[c] * facing + glint);
            }
        }
        let share = self.view.mirrors.get(hit.leaf).copied().unwrap_or(0.0).clamp(0.0, 1.0);
        if share > 0.0 && bounces < BOUNCES {
            let back = direction - normal * (2.0 * direction.dot(normal));
            let from = hit.point + normal * away;
            // A mirrored ray without a hit has the colour of the background at its height.
            let seen = self.seen(from, back, bounces + 1).unwrap_or_else(|| {
                let up = self.view.up.normalized().unwrap_or(normal);
                self.view.behind(0.5 - 0.5 * back.dot(up))
            });
            for c in 0..3 {
                out[c] = (1.0 - share) * out[c] + share * seen[c];
            }
        }
        Some(out)
    }
}
