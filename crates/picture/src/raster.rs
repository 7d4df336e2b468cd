//! Triangles and lines into samples with depth.

use crate::camera::ScreenPoint;
use crate::palette::Gamma;

/// A corner of a triangle: where it is seen and its light (linear).
#[derive(Clone, Copy)]
pub(crate) struct ShadedVertex {
    pub at: ScreenPoint,
    pub light: [f32; 3],
}

/// Samples with depth, twice as many in each direction as the picture has points.
pub(crate) struct Raster {
    width: usize,
    height: usize,
    near: Vec<f32>,
    colour: Vec<[u8; 3]>,
    gamma: Gamma,
}

/// Length of a vector on the picture. Square roots are the same bits everywhere, `hypot` is not.
pub(crate) fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

/// Lines drawn along the sides of a panel.
#[derive(Clone, Copy)]
pub(crate) struct PanelSides {
    /// Sides (from corner k to k + 1) with a line.
    pub shown: [bool; 3],
    /// Half the line's width in samples.
    pub half_width: f32,
    /// 0 for no line, 1 for black.
    pub strength: f32,
}

impl Raster {
    /// A background with a gradient from `top` to `bottom`.
    pub fn new(width: usize, height: usize, top: [u8; 3], bottom: [u8; 3], gamma: Gamma) -> Self {
        let mut colour = Vec::with_capacity(width * height);
        for y in 0..height {
            let t = y as f32 / height.max(2) as f32;
            let mix = |k: usize| (top[k] as f32 * (1.0 - t) + bottom[k] as f32 * t + 0.5) as u8;
            colour.extend(std::iter::repeat_n([mix(0), mix(1), mix(2)], width));
        }
        let near = vec![f32::NEG_INFINITY; width * height];
        Self { width, height, near, colour, gamma }
    }

    /// Fills a triangle, nearer samples winning.
    pub fn triangle(&mut self, corners: [ShadedVertex; 3], sides: Option<PanelSides>) {
        let [a, b, c] = corners.map(|c| c.at);
        let double_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if double_area == 0.0 || !double_area.is_finite() {
            return;
        }
        let low = |p: f32, q: f32, r: f32| (p.min(q).min(r) - 0.5).ceil().max(0.0) as usize;
        let high = |p: f32, q: f32, r: f32, n: usize| {
            ((p.max(q).max(r) - 0.5).floor() + 1.0).clamp(0.0, n as f32) as usize
        };
        let (x0, x1) = (low(a.x, b.x, c.x), high(a.x, b.x, c.x, self.width));
        let (y0, y1) = (low(a.y, b.y, c.y), high(a.y, b.y, c.y, self.height));
        // Weight of each corner, linear on the picture; and distance to the side opposite to it.
        let weight = |p: ScreenPoint, q: ScreenPoint| {
            let (dx, dy) = ((q.x - p.x) / double_area, (q.y - p.y) / double_area);
            (move |x: f32, y: f32| (y - p.y) * dx - (x - p.x) * dy, -dy)
        };
        let ((wa, wa_x), (wb, wb_x)) = (weight(b, c), weight(c, a));
        let per_weight =
            |p: ScreenPoint, q: ScreenPoint| double_area.abs() / length(q.x - p.x, q.y - p.y);
        let distances = sides.map(|s| (s, [per_weight(a, b), per_weight(b, c), per_weight(c, a)]));
        for y in y0..y1 {
            let py = y as f32 + 0.5;
            let (mut u, mut v) = (wa(x0 as f32 + 0.5, py), wb(x0 as f32 + 0.5, py));
            let row = y * self.width;
            for x in x0..x1 {
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    let near = u * a.near + v * b.near + w * c.near;
                    let k = row + x;
                    if near > self.near[k] {
                        self.near[k] = near;
                        let mut shade = 1.0;
                        if let Some((sides, per)) = distances {
                            // Side k begins at corner k; the weight of the opposite corner is zero
                            // on it.
                            for (n, weight) in [w, u, v].into_iter().enumerate() {
                                if sides.shown[n] {
                                    let outside = weight * per[n] - sides.half_width;
                                    let cover = (0.5 - outside).clamp(0.0, 1.0);
                                    shade = f32::min(shade, 1.0 - sides.strength * cover);
                                }
                            }
                        }
                        let light = std::array::from_fn(|n| {
                            let [a, b, c] = [0, 1, 2].map(|m: usize| corners[m].light[n]);
                            shade * (u * a + v * b + w * c)
                        });
                        self.colour[k] = self.gamma.stored(light);
                    }
                }
                u += wa_x;
                v += wb_x;
            }
        }
    }

    /// Draws a line of `half_width` samples, where it is at most the first of `depths` behind the
    /// visible surface and at most the second in front of it.
    pub fn line(
        &mut self,
        a: ScreenPoint,
        b: ScreenPoint,
        half_width: f32,
        [slack, before]: [f32; 2],
        colour: [u8; 3],
    ) {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let length_sq = dx * dx + dy * dy;
        if !length_sq.is_finite() {
            return;
        }
        let reach = half_width + 1.0;
        let cells = |p: f32, q: f32, n: usize| {
            let low = (p.min(q) - reach).max(0.0) as usize;
            low..((p.max(q) + reach).clamp(0.0, n as f32) as usize)
        };
        for y in cells(a.y, b.y, self.height) {
            let py = y as f32 + 0.5;
            // Only the columns near the line on this row, so long lines stay cheap.
            let columns = if dy.abs() > 1e-3 {
                let at = |y: f32| a.x + dx * ((y - a.y) / dy).clamp(0.0, 1.0);
                cells(at(py - reach), at(py + reach), self.width)
            } else {
                cells(a.x, b.x, self.width)
            };
            for x in columns {
                let (px, py) = (x as f32 + 0.5 - a.x, py - a.y);
                let t = if length_sq > 0.0 {
                    ((px * dx + py * dy) / length_sq).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = length(px - t * dx, py - t * dy);
                let cover = (half_width + 0.5 - distance).clamp(0.0, 1.0);
                let k = y * self.width + x;
                let near = a.near + t * (b.near - a.near);
                if cover > 0.0 && near + slack >= self.near[k] && near - self.near[k] <= before {
                    for (old, new) in self.colour[k].iter_mut().zip(colour) {
                        *old =
                            (f32::from(*old) * (1.0 - cover) + f32::from(new) * cover + 0.5) as u8;
                    }
                }
            }
        }
    }

    /// The picture: the mean of 2 x 2 samples, rows of RGB.
    pub fn halved(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.width * self.height * 3 / 4);
        for y in (0..self.height).step_by(2) {
            let (upper, lower) =
                self.colour[y * self.width..(y + 2) * self.width].split_at(self.width);
            for (p, q) in upper.chunks_exact(2).zip(lower.chunks_exact(2)) {
                for n in 0..3 {
                    let sum = p[0][n] as u16 + p[1][n] as u16 + q[0][n] as u16 + q[1][n] as u16;
                    out.push(((sum + 2) / 4) as u8);
                }
            }
        }
        out
    }
}
