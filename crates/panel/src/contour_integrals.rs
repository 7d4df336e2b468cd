//! Length of sections and the area that they enclose: integrals along the lines on the exact surface, with
//! derivatives.
//!
//! A line is known by points on lines u or v = constant of a grid. Between two of them the section
//! is followed by Newton steps across the chord in the parameter plane, at the nodes of a Gauss
//! rule; the chord's ends stay on their grid lines, so that the whole moves with the surface as the
//! section does.

use crate::contour::{Contour, body_section};
use moldloft_num::period::crease_rate;
use moldloft_num::{Order, Real, Surface, Vec3};
use moldloft_registry::{Family, SurfaceRef, TriangleBody};

/// One line of a section, with its integrals.
#[derive(Clone, Debug)]
pub struct ContourPiece<T> {
    /// Its points, for nesting and for connecting ends.
    pub points: Vec<Vec3>,
    /// Its first point.
    pub from: Vec3<T>,
    /// Its last point; the first one again for a closed line.
    pub to: Vec3<T>,
    /// Its length.
    pub length: T,
    /// Half the integral of r x dr about a given origin: the area vector of a closed line.
    pub swept: Vec3<T>,
}

/// The Gauss rule of three points on 0 .. 1.
const RULE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Relative difference, in section sizes, within which the halves of a chord agree with the whole.
const ALIKE: f64 = 1e-11;

/// A chord is halved this often at most.
const MOST_HALVINGS: u32 = 10;

/// Slope along a grid line, relative to that along the other, below which it is zero.
const FLAT: f64 = 1e-6;

/// Newton steps to the section from the chord of two neighbouring points.
const MOST_STEPS: usize = 12;

/// Distance from a knuckle at which its two sides are evaluated.
const ASIDE: f64 = 1e-4;

/// A node of the line: its parameters, and the grid line that contains it when the model changes.
#[derive(Clone, Copy)]
struct ContourNode<T> {
    uv: [T; 2],
    /// The parameter that is free along the grid line.
    free: usize,
}

/// The integrals of a line of the section `value` of a surface; `None` if they are not finite or
/// the line cannot be followed.
pub fn contour_piece<T: Real>(
    line: &Contour,
    surface: &SurfaceRef<T>,
    family: &Family<T>,
    value: T,
    origin: Vec3,
) -> Option<ContourPiece<T>> {
    let breaks = surface.breaks();
    let first = *line.points.first()?;
    let size = line.points.iter().fold(0.0f64, |size, p| size.max(p.distance(first)));
    let follow = Follower { surface, breaks, family, value, origin: Vec3::lifted(origin), size };
    let mut nodes: Vec<ContourNode<T>> = line.uv.iter().map(|&uv| follow.node(uv)).collect();
    if line.closed {
        nodes.push(*nodes.first()?);
    }
    let (mut length, mut swept) = (T::zero(), Vec3::zero());
    for pair in nodes.windows(2) {
        let (part, area) = follow.between(pair[0], pair[1])?;
        length += part;
        swept += area;
    }
    let [from, to] = [nodes.first()?, nodes.last()?].map(|n| follow.place(n.uv));
    let sound = length.is_finite() && swept.is_finite() && from.is_finite() && to.is_finite();
    sound.then(|| ContourPiece { points: line.points.clone(), from, to, length, swept })
}

struct Follower<'s, T: Real> {
    surface: &'s SurfaceRef<T>,
    breaks: [Vec<f64>; 2],
    family: &'s Family<T>,
    value: T,
    origin: Vec3<T>,
    /// The size of the section.
    size: f64,
}

impl<T: Real> Follower<'_, T> {
    fn place(&self, [u, v]: [T; 2]) -> Vec3<T> {
        self.surface.jet(u, v, Order::Zero).p
    }

    /// The height over the section and its slopes by u and v.
    fn height(&self, [u, v]: [T; 2]) -> (T, [T; 2]) {
        let jet = self.surface.jet(u, v, Order::First);
        let slope = self.family.gradient(self.value, jet.p);
        (self.family.height(self.value, jet.p), [slope.dot(jet.u), slope.dot(jet.v)])
    }

    /// A point of the line on its grid line, moving along it with the model.
    fn node(&self, uv: [f64; 2]) -> ContourNode<T> {
        let mut at = uv.map(T::from);
        let slopes = self.height(at).1;
        let creased = [0, 1].map(|k| self.breaks[k].iter().any(|x| x.to_bits() == uv[k].to_bits()));
        let on_border = [0, 1].map(|k| creased[k] || uv[k] == 0.0 || uv[k] == 1.0);
        // Ends of the line and its corners keep to the border or crease; others to the line that the section crosses.
        let held = match on_border {
            [true, false] => 0,
            [false, true] => 1,
            _ => usize::from(slopes[0].re().abs() > slopes[1].re().abs()),
        };
        // If the section is along a border, the step follows the lines that cross it.
        let flat = |k: usize| slopes[k].re().abs() <= FLAT * slopes[1 - k].re().abs();
        let held = if flat(1 - held) { 1 - held } else { held };
        let free = 1 - held;
        if creased[held] {
            at[held] += crease_rate(&**self.surface, held, uv[held], [ASIDE; 2]);
        }
        let (height, slopes) = self.height(at);
        if slopes[free].re() != 0.0 {
            at[free] -= height / slopes[free];
        }
        ContourNode { uv: at, free }
    }

    /// Length and swept area between two neighbouring points.
    fn between(&self, a: ContourNode<T>, b: ContourNode<T>) -> Option<(T, Vec3<T>)> {
        let chord = SectionChord::new(self, a, b);
        let whole = self.over(&chord, 0.0, 1.0)?;
        self.refined(&chord, 0.0, 1.0, whole, 0)
    }

    /// The integrals over a part of a chord: halved until halves and whole agree.
    fn refined(
        &self,
        chord: &SectionChord<T>,
        low: f64,
        high: f64,
        whole: (T, Vec3<T>),
        depth: u32,
    ) -> Option<(T, Vec3<T>)> {
        let middle = 0.5 * (low + high);
        let halves = [self.over(chord, low, middle)?, self.over(chord, middle, high)?];
        let [(first, before), (second, after)] = halves;
        let both = (first + second, before + after);
        let moved = (0..T::PARTS).map(|k| (both.0 - whole.0).part(k).abs()).fold(0.0, f64::max);
        let swept = (both.1 - whole.1).re().norm();
        let limit = ALIKE * self.size;
        if depth >= MOST_HALVINGS || moved <= limit && swept <= limit * self.size {
            return Some(both);
        }
        let (first, before) = self.refined(chord, low, middle, halves[0], depth + 1)?;
        let (second, after) = self.refined(chord, middle, high, halves[1], depth + 1)?;
        Some((first + second, before + after))
    }

    /// The Gauss rule over a part of a chord.
    fn over(&self, chord: &SectionChord<T>, low: f64, high: f64) -> Option<(T, Vec3<T>)> {
        let SectionChord { start, along, up, turn } = *chord;
        let (mut length, mut swept) = (T::zero(), Vec3::zero());
        let mut offset = T::zero();
        for (place, weight) in RULE {
            let s = low + (high - low) * place;
            let weight = weight * (high - low);
            let normal = [up[0] + turn[0] * s, up[1] + turn[1] * s];
            let at = |offset: T| [0, 1].map(|k| start[k] + along[k] * s + offset * normal[k]);
            let rise = |slopes: [T; 2]| slopes[0] * normal[0] + slopes[1] * normal[1];
            let mut left = f64::INFINITY;
            for _ in 0..MOST_STEPS {
                let (height, slopes) = self.height(at(offset));
                let step = height / rise(slopes);
                if !step.is_finite() {
                    return None;
                }
                offset -= step;
                // One more step after the last that counts: derivatives follow a step behind.
                if left < 1e-9 || step.re().abs() >= left && left < 1e-6 {
                    break;
                }
                left = step.re().abs();
            }
            let [u, v] = at(offset);
            let jet = self.surface.jet(u, v, Order::First);
            let slope = self.family.gradient(self.value, jet.p);
            let slopes = [slope.dot(jet.u), slope.dot(jet.v)];
            let moved = [0, 1].map(|k| along[k] + offset * turn[k]);
            let rate = -(slopes[0] * moved[0] + slopes[1] * moved[1]) / rise(slopes);
            let velocity =
                jet.u * (moved[0] + rate * normal[0]) + jet.v * (moved[1] + rate * normal[1]);
            length += velocity.norm() * weight;
            swept += (jet.p - self.origin).cross(velocity) * T::from(0.5 * weight);
        }
        Some((length, swept))
    }
}

/// The chord of two neighbouring points in the parameter plane, and the directions across it.
struct SectionChord<T> {
    start: [T; 2],
    along: [T; 2],
    /// Up the slope along the grid line of the first point.
    up: [f64; 2],
    /// Displacement from there to that of the second.
    turn: [f64; 2],
}

impl<T: Real> SectionChord<T> {
    fn new(follow: &Follower<'_, T>, a: ContourNode<T>, b: ContourNode<T>) -> Self {
        let across = |node: ContourNode<T>| {
            let slope = follow.height(node.uv).1[node.free].re();
            let mut direction = [0.0; 2];
            direction[node.free] = slope.signum();
            direction
        };
        let (up, end) = (across(a), across(b));
        Self {
            start: a.uv,
            along: [b.uv[0] - a.uv[0], b.uv[1] - a.uv[1]],
            up,
            turn: [end[0] - up[0], end[1] - up[1]],
        }
    }
}

/// The integrals of the section of a body by a plane or half-plane: its length and its area vector,
/// outer lines being positive along the plane's normal. `None` if the section is not plane.
pub fn body_integrals<T: Real>(
    body: &TriangleBody<T>,
    family: &Family<T>,
    value: T,
    origin: Vec3,
) -> Option<(T, Vec3<T>, Vec<Contour>)> {
    if matches!(family, Family::Cylinders(_)) {
        return None;
    }
    let origin = Vec3::lifted(origin);
    let heights: Vec<T> = body.points.iter().map(|&p| family.height(value, p)).collect();
    let (mut length, mut swept) = (T::zero(), Vec3::zero());
    for triangle in &body.triangles {
        let corners = triangle.map(|k| (body.points[k as usize], heights[k as usize]));
        let below = corners.map(|(_, h)| h.re() < 0.0);
        let mut ends = [Vec3::zero(); 2];
        let mut found = 0;
        for k in 0..3 {
            let ((p, g), (q, h)) = (corners[k], corners[(k + 1) % 3]);
            if below[k] != below[(k + 1) % 3] {
                // Counter-clockwise from outside, the section begins where the border comes up through it.
                ends[usize::from(!below[(k + 1) % 3])] = p + (q - p) * (g / (g - h));
                found += 1;
            }
        }
        let middle = (ends[0] + ends[1]) * T::from(0.5);
        if found == 2 && family.holds(value, middle) {
            let step = ends[1] - ends[0];
            if step.re().norm_sq() > 0.0 {
                length += step.norm();
            }
            swept += (ends[0] - origin).cross(ends[1] - origin) * T::from(0.5);
        }
    }
    Some((length, swept, body_section(body, family, value)))
}
