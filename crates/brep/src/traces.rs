//! Edges in the parameters of the NURBS of quadrics and tori: what formats need that have no such surfaces.
//!
//! `edge -> angles along it, without jumps -> all loop within one turn -> parameters of the NURBS -> spline of degree 5`
//!
//! A trace is at the edge's place at equal parameters. Loops through a pole or an apex have none: there an angle is
//! missing.

use crate::patch::PatchBasis;
use crate::{Brep, BrepFace, Coedge, SurfaceAxes, SurfaceShape};
use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

const DEGREE: usize = 5;

/// Steps along a span of an edge in which an angle turns by less than half of it.
const STEPS: usize = 48;

/// How often a piece of a trace may be halved.
const HALVINGS: usize = 12;

/// What is nearer to the axis than this share of the size has no angle.
const POLE: f64 = 1e-7;

/// Places between those that a piece goes through, at which it is compared with the edge.
const COMPARED: [f64; 6] = [0.04, 0.2, 0.42, 0.58, 0.8, 0.96];

/// The coordinates of a surface of revolution: its axes, and how its second parameter is found.
struct RoundParameters<'a> {
    face: &'a SurfaceShape,
    /// The surface, or that of which it is the image.
    of: &'a SurfaceShape,
    axes: &'a SurfaceAxes,
    heights: [f64; 2],
    /// Points nearer to the axis have no angle.
    pole: f64,
}

/// The parameter of the rational arcs of a quarter each, at an angle from their beginning.
fn parameter(angle: f64, quarters: f64) -> f64 {
    let turned = (angle / FRAC_PI_2).clamp(0.0, quarters);
    let quarter = libm::floor(turned).min(quarters - 1.0);
    let theta = (turned - quarter) * FRAC_PI_2;
    let (a, b) = (libm::sin(0.5 * theta), libm::sin(FRAC_PI_4 - 0.5 * theta));
    (quarter + a / (a + b)) / quarters
}

impl RoundParameters<'_> {
    fn local(&self, p: Vec3) -> [f64; 3] {
        match self.face {
            SurfaceShape::Image(image) => self.axes.local(image.local(p)),
            _ => self.axes.local(p),
        }
    }

    /// The angle about the axis, and that of the profile or the height; none at poles.
    fn angles(&self, p: Vec3) -> Option<[f64; 2]> {
        let [x, y, z] = self.local(p);
        let across = libm::sqrt(x * x + y * y);
        let second = match self.of {
            SurfaceShape::Sphere { .. } => libm::atan2(z, across),
            SurfaceShape::Torus { major, .. } => libm::atan2(z, across - major),
            _ => z,
        };
        (across > self.pole).then(|| [libm::atan2(y, x), second])
    }

    /// The parameters of the NURBS.
    fn parameters(&self, [round, second]: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.heights;
        let v = match self.of {
            SurfaceShape::Sphere { .. } => parameter(second + FRAC_PI_2, 2.0),
            SurfaceShape::Torus { .. } => parameter(second, 4.0),
            _ => ((second - low) / (high - low)).clamp(0.0, 1.0),
        };
        [parameter(round, 4.0), v]
    }

    /// Which of both grow beyond a turn.
    fn turns(&self) -> [bool; 2] {
        [true, matches!(self.of, SurfaceShape::Torus { .. })]
    }
}

fn near_to(value: f64, known: f64) -> f64 {
    value + TAU * libm::round((known - value) / TAU)
}

/// Angles along an edge in its own direction, at even steps of each of its spans.
struct EdgeAngles {
    at: Vec<f64>,
    angles: Vec<[f64; 2]>,
}

impl EdgeAngles {
    fn new(surface: &RoundParameters<'_>, curve: &Nurbs<1>) -> Option<Self> {
        let mut knots = curve.knots[0].clone();
        knots.dedup();
        let mut at = vec![knots[0]];
        for w in knots.windows(2) {
            at.extend((1..=STEPS).map(|k| w[0] + (w[1] - w[0]) * k as f64 / STEPS as f64));
        }
        let mut angles: Vec<[f64; 2]> = Vec::with_capacity(at.len());
        for p in curve.grid(std::slice::from_ref(&at).try_into().ok()?) {
            let mut own = surface.angles(p)?;
            if let Some(before) = angles.last() {
                for (k, turns) in surface.turns().into_iter().enumerate() {
                    if turns {
                        own[k] = near_to(own[k], before[k]);
                        if (own[k] - before[k]).abs() > 0.5 * PI {
                            return None;
                        }
                    }
                }
            }
            angles.push(own);
        }
        Some(Self { at, angles })
    }

    fn ends(&self, forward: bool) -> [[f64; 2]; 2] {
        let ends = [self.angles[0], self.angles[self.angles.len() - 1]];
        if forward { ends } else { [ends[1], ends[0]] }
    }

    /// The angles at a place of the edge, by those of the nearest step.
    fn exactly(&self, surface: &RoundParameters<'_>, curve: &Nurbs<1>, t: f64) -> Option<[f64; 2]> {
        let k = self.at.partition_point(|s| *s < t).min(self.at.len() - 1);
        let mut own = surface.angles(curve.at([t]))?;
        for (k_of, turns) in surface.turns().into_iter().enumerate() {
            if turns {
                own[k_of] = near_to(own[k_of], self.angles[k][k_of]);
            }
        }
        Some(own)
    }
}

impl Brep {
    /// The sides of a face's loops in the parameters of [`Self::nurbs`] of it, along the edges' curves; none for planes and
    /// for NURBS, and where a side goes through a pole.
    pub fn traces(&self, face: &BrepFace, surface: &Nurbs<2>) -> Option<Vec<Vec<Nurbs<1>>>> {
        let of = match &face.surface {
            SurfaceShape::Image(image) => image.of(),
            other => other,
        };
        let axes = of.axes()?;
        let heights = self.heights(face)?;
        let corner = |f: fn(f64, f64) -> f64, start: f64| {
            let all = surface.points.iter();
            Vec3::from([0, 1, 2].map(|k| all.clone().map(|p| p[k]).fold(start, f)))
        };
        let size = corner(f64::min, f64::INFINITY).distance(corner(f64::max, f64::NEG_INFINITY));
        let scale = match &face.surface {
            SurfaceShape::Image(image) => image.scale(),
            _ => 1.0,
        };
        let round =
            RoundParameters { face: &face.surface, of, axes, heights, pole: POLE * size / scale };
        let near = (0.5 * self.gap).max(1e-10 * size);
        face.loops.iter().map(|cycle| self.traced(&round, cycle, surface, near)).collect()
    }

    fn traced(
        &self,
        round: &RoundParameters<'_>,
        cycle: &[Coedge],
        surface: &Nurbs<2>,
        near: f64,
    ) -> Option<Vec<Nurbs<1>>> {
        const SMALL: f64 = 1e-5;
        let curve = |side: &Coedge| &self.edges[side.edge].curve;
        let known: Vec<EdgeAngles> = cycle
            .iter()
            .map(|side| EdgeAngles::new(round, curve(side)))
            .collect::<Option<Vec<_>>>()?;
        // By how much the angles of each side are moved to go on where the last one ends.
        let mut shifts = vec![[0.0; 2]; cycle.len()];
        let mut end: Option<[f64; 2]> = None;
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for ((side, angles), shift) in cycle.iter().zip(&known).zip(&mut shifts) {
            let [from, to] = angles.ends(side.forward);
            for k in (0..2).filter(|k| round.turns()[*k]) {
                if let Some(end) = end {
                    shift[k] = near_to(from[k], end[k]) - from[k];
                }
                for a in angles.angles.iter().map(|a| a[k] + shift[k]) {
                    range[k] = [range[k][0].min(a), range[k][1].max(a)];
                }
            }
            end = Some([to[0] + shift[0], to[1] + shift[1]]);
        }
        let [first, _] = known.first()?.ends(cycle[0].forward);
        for k in (0..2).filter(|k| round.turns()[*k]) {
            let [low, high] = range[k];
            // The loop ends where it begins, and all of it is within one turn.
            if (end?[k] - first[k]).abs() > SMALL || high - low > TAU + SMALL {
                return None;
            }
            let by = -TAU * libm::floor((low + SMALL) / TAU);
            if high + by > TAU + SMALL {
                return None;
            }
            shifts.iter_mut().for_each(|s| s[k] += by);
        }
        let sides = cycle.iter().zip(&known).zip(&shifts);
        sides
            .map(|((side, angles), shift)| {
                let made = spline(round, angles, curve(side), *shift, surface, near)?;
                Some(if side.forward { made } else { made.reversed() })
            })
            .collect()
    }
}

/// The trace of an edge: one line where it runs along one, else pieces of degree 5 that are near enough.
fn spline(
    round: &RoundParameters<'_>,
    known: &EdgeAngles,
    curve: &Nurbs<1>,
    shift: [f64; 2],
    surface: &Nurbs<2>,
    near: f64,
) -> Option<Nurbs<1>> {
    let angles = |t: f64| {
        let own = known.exactly(round, curve, t)?;
        Some([own[0] + shift[0], own[1] + shift[1]])
    };
    let place = |t: f64| {
        let [u, v] = round.parameters(angles(t)?);
        Some(Vec3::of(u, v, 0.0))
    };
    // The edge itself may be off the surface by as much as counts: what is compared is on it.
    let off = |p: Vec3, t: f64| {
        let known = place(t).map(|q| surface.at([q.x, q.y]));
        known.map_or(f64::INFINITY, |q| surface.at([p.x, p.y]).distance(q))
    };
    let (mut low, mut high) = (known.at[0], known.at[known.at.len() - 1]);
    let (from, to) = (place(low)?, place(high)?);
    if COMPARED.iter().all(|s| off(from.lerp(to, *s), low + (high - low) * s) <= near) {
        return Some(polynomial(1, [vec![low, low, high, high]], vec![from, to]));
    }
    let basis = PatchBasis::new(DEGREE);
    // Pieces begin at the edge's knots, and where the surface's arcs do.
    let mut knots = curve.knots[0].clone();
    knots.dedup();
    let turns = round.turns();
    let quarter = |a: [f64; 2]| {
        let second = turns[1] || matches!(round.of, SurfaceShape::Sphere { .. });
        let of = |x: f64| libm::floor(x / FRAC_PI_2 + 1e-9);
        [of(a[0]), if second { of(a[1]) } else { 0.0 }]
    };
    let mut ends = knots.clone();
    for w in known.at.windows(2) {
        let [a, b] = [quarter(angles(w[0])?), quarter(angles(w[1])?)];
        if a == b {
            continue;
        }
        let [mut from, mut to] = [w[0], w[1]];
        for _ in 0..50 {
            let t = 0.5 * (from + to);
            if quarter(angles(t)?) == a {
                from = t;
            } else {
                to = t;
            }
        }
        let clear = 1e-6 * (w[1] - w[0]);
        if to - w[0] > clear && w[1] - to > clear {
            ends.push(to);
        }
    }
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let (mut points, mut breaks) = (vec![place(ends[0])?], vec![ends[0]]);
    let mut pieces: Vec<(f64, f64, usize)> =
        ends.windows(2).rev().map(|w| (w[0], w[1], 0)).collect();
    while let Some((from, to, depth)) = pieces.pop() {
        let through: Vec<Vec3> =
            basis.at.iter().map(|s| place(from + (to - from) * s)).collect::<Option<Vec<_>>>()?;
        let net = basis.curve(&through);
        let good =
            COMPARED.iter().all(|s| off(basis.on_curve(&net, *s), from + (to - from) * s) <= near);
        if !good && depth < HALVINGS {
            let middle = 0.5 * (from + to);
            pieces.extend([(middle, to, depth + 1), (from, middle, depth + 1)]);
            continue;
        }
        if !good {
            return None;
        }
        points.extend(&net[1..]);
        breaks.push(to);
    }
    (low, high) = (breaks[0], breaks[breaks.len() - 1]);
    let mut all = vec![low; DEGREE + 1];
    for t in &breaks[1..breaks.len() - 1] {
        all.extend([*t; DEGREE]);
    }
    all.extend([high; DEGREE + 1]);
    Some(polynomial(DEGREE, [all], points))
}

fn polynomial(degree: usize, knots: [Vec<f64>; 1], points: Vec<Vec3>) -> Nurbs<1> {
    Nurbs {
        degrees: [degree],
        knots,
        points,
        weights: None,
        error: 0.0,
        exact: false,
        paces: [Pace::Even],
    }
}
