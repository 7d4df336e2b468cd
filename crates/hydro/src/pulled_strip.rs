//! The transposed quadrature of [`crate::integrals::integrated`]: weights of the integrals over a
//! strip become weights of the net of its cell and of the ends of the strip.
//!
//! `weights of the sums -> point and vector area at each node -> line at w, cut on it, w -> net, from, to`

use crate::bernstein::{Row, basis};
use crate::integrals::{HydrostaticIntegrals, outer_share, rule_points};
use crate::strip::{CoordinatePlane, Strip, StripLine, Wet};
use moldloft_num::{Vec3, gauss_rule};

/// Weights of what a strip is made of.
pub(crate) struct PulledStrip {
    /// Of the net of its cell.
    pub net: Vec<Vec3>,
    /// Of `from` and of `to`.
    pub ends: [f64; 2],
}

/// The Bernstein polynomials of a degree at a parameter, their first and second derivatives.
struct StripBases([Row<f64>; 3]);

impl StripBases {
    fn new(degree: usize, t: f64) -> Self {
        let (values, slopes) = basis(degree, t);
        let mut bends = Row::default();
        if degree >= 2 {
            let (lower, _) = basis(degree - 2, t);
            let scale = (degree * (degree - 1)) as f64;
            for k in 0..=degree - 2 {
                bends[k] += scale * lower[k];
                bends[k + 1] -= 2.0 * scale * lower[k];
                bends[k + 2] += scale * lower[k];
            }
        }
        Self([values, slopes, bends])
    }

    /// The sum of `row` times the derivatives of this order.
    fn sum(&self, row: &[Vec3], order: usize) -> Vec3 {
        row.iter().zip(&self.0[order]).fold(Vec3::zero(), |sum, (c, b)| sum + *c * *b)
    }

    /// Adds `weight` of such a sum to the weights of its row.
    fn pull(&self, row: &mut [Vec3], order: usize, weight: Vec3) {
        row.iter_mut().zip(&self.0[order]).for_each(|(w, b)| *w += weight * *b);
    }
}

/// A line of the strip, with the cut on it.
struct CutLine {
    line: StripLine<f64>,
    /// The second derivatives of its control points by the outer parameter.
    bend: Vec<Vec3>,
    /// The outer parameter's step.
    dw: f64,
    /// The inner parameter of the cut with its basis, and true if it moves with the line.
    cut: Option<(StripBases, bool)>,
}

/// Weights of a line.
struct PulledLine {
    at: Vec<Vec3>,
    by: Vec<Vec3>,
    dw: f64,
    /// Of the inner parameter of the cut.
    root: f64,
}

/// The weights of the strip in each sum, whose weights of the integrals are `sums`.
pub(crate) fn pulled_strip(
    strip: &Strip<f64>,
    cut: CoordinatePlane<f64>,
    origin: Vec3,
    sums: &[HydrostaticIntegrals<f64>],
) -> Vec<PulledStrip> {
    let cell = &strip.cell;
    let degree = cell.degree();
    let [inner, outer] = [degree[strip.inner], degree[1 - strip.inner]];
    let (step, stride) = if strip.inner == 0 { (1, degree[1] + 1) } else { (degree[1] + 1, 1) };
    let [along, across] = rule_points(strip, 0);
    let none = || PulledStrip { net: vec![Vec3::zero(); cell.net().len()], ends: [0.0; 2] };
    let mut pulled: Vec<_> = sums.iter().map(|_| none()).collect();
    let length = strip.to - strip.from;
    // Of whole lines the nodes are the same on each.
    let nodes = gauss_rule(along);
    let whole: Vec<StripBases> = match strip.is_cut() {
        true => Vec::new(),
        false => nodes.iter().map(|&(s, _)| StripBases::new(inner, s)).collect(),
    };
    let mut line = StripLine::default();
    for &(s, weight) in gauss_rule(across) {
        let (share, slope) = outer_share(strip, s);
        let (w, dw) = (strip.from + length * share, length * (slope * weight));
        strip.line(w, &mut line);
        let across = StripBases::new(outer, w);
        let bend = (0..=inner).map(|k| {
            let row = (0..=outer).map(|m| cell.net()[k * stride + m * step] * across.0[2][m]);
            row.fold(Vec3::zero(), |sum, p| sum + p)
        });
        let bend = bend.collect();
        let (root, cut_bases) = cut_of(strip, &line, cut, inner);
        let [low, high] = match (strip.wet, root) {
            (Wet::Before, Some(root)) => [0.0, root],
            (Wet::After, Some(root)) => [root, 1.0],
            _ => [0.0, 1.0],
        };
        let moved: Vec<StripBases> = match root {
            Some(_) => {
                nodes.iter().map(|&(s, _)| StripBases::new(inner, low + (high - low) * s)).collect()
            }
            None => Vec::new(),
        };
        let bases = if root.is_some() { &moved } else { &whole };
        let of = CutLine { line, bend, dw, cut: cut_bases };
        for (pulled, sums) in pulled.iter_mut().zip(sums) {
            let own = of.pull(strip, origin, sums, bases, nodes, high - low);
            let mut by_w = 0.0;
            for k in 0..=inner {
                by_w += own.at[k].dot(of.line.by[k]) + own.by[k].dot(of.bend[k]);
                for m in 0..=outer {
                    pulled.net[k * stride + m * step] +=
                        own.at[k] * across.0[0][m] + own.by[k] * across.0[1][m];
                }
            }
            let by_length = own.dw * (slope * weight);
            pulled.ends[0] += by_w * (1.0 - share) - by_length;
            pulled.ends[1] += by_w * share + by_length;
        }
        line = of.line;
    }
    pulled
}

/// The inner parameter of the cut on a line, its basis there, and true if it moves with the line.
fn cut_of(
    strip: &Strip<f64>,
    line: &StripLine<f64>,
    cut: CoordinatePlane<f64>,
    inner: usize,
) -> (Option<f64>, Option<(StripBases, bool)>) {
    if !strip.is_cut() {
        return (None, None);
    }
    let root = strip.cut_on(line, cut).t;
    let bases = StripBases::new(inner, root);
    let off = (bases.sum(&line.at, 0)[cut.axis] - cut.level) / bases.sum(&line.at, 1)[cut.axis];
    (Some(root), Some((bases, off.is_finite() && off.abs() < 1e-6)))
}

impl CutLine {
    /// The weights of this line; `bases` are those of the nodes along it, `reach` the part of it that is wet.
    fn pull(
        &self,
        strip: &Strip<f64>,
        origin: Vec3,
        sums: &HydrostaticIntegrals<f64>,
        bases: &[StripBases],
        nodes: &[(f64, f64)],
        reach: f64,
    ) -> PulledLine {
        let StripLine { at, by } = &self.line;
        let none = || vec![Vec3::zero(); at.len()];
        let mut pulled = PulledLine { at: none(), by: none(), dw: 0.0, root: 0.0 };
        let sign = strip.sign();
        for (bases, &(s, weight)) in bases.iter().zip(nodes) {
            let [p, inner, outer] = [bases.sum(at, 0), bases.sum(at, 1), bases.sum(by, 0)];
            let area = inner.cross(outer);
            let scale = weight * sign;
            let share = reach * self.dw * scale;
            let (of_p, of_n) = sums.pulled(p - origin, area * share);
            let (of_inner, of_outer) = (outer.cross(of_n) * share, of_n.cross(inner) * share);
            bases.pull(&mut pulled.at, 0, of_p);
            bases.pull(&mut pulled.at, 1, of_inner);
            bases.pull(&mut pulled.by, 0, of_outer);
            let of_share = of_n.dot(area) * scale;
            pulled.dw += of_share * reach;
            if self.cut.is_none() {
                continue;
            }
            // The node moves with the cut.
            let by_t =
                of_p.dot(inner) + of_inner.dot(bases.sum(at, 2)) + of_outer.dot(bases.sum(by, 1));
            pulled.root += match strip.wet {
                Wet::After => by_t * (1.0 - s) - of_share * self.dw,
                _ => by_t * s + of_share * self.dw,
            };
        }
        if let Some((bases, moves)) = &self.cut {
            self.pull_cut(strip, origin, sums, bases, *moves, &mut pulled);
        }
        pulled
    }

    /// The waterline's own integral, and the dependence of the cut on the line.
    fn pull_cut(
        &self,
        strip: &Strip<f64>,
        origin: Vec3,
        sums: &HydrostaticIntegrals<f64>,
        bases: &StripBases,
        moves: bool,
        pulled: &mut PulledLine,
    ) {
        let StripLine { at, by } = &self.line;
        let [p, inner, outer] = [bases.sum(at, 0), bases.sum(at, 1), bases.sum(by, 0)];
        let share = outer.z / inner.z;
        let follows = share.is_finite();
        let along = if follows { outer - inner * share } else { outer };
        let p = p - origin;
        let turn = 0.5 * if strip.wet == Wet::Before { -strip.sign() } else { strip.sign() };
        let green = sums.green * turn;
        pulled.dw += green * (p.x * along.y - p.y * along.x);
        let weight = green * self.dw;
        let of_p = Vec3::of(along.y, -along.x, 0.0) * weight;
        let of_along = Vec3::of(-p.y, p.x, 0.0) * weight;
        let (mut of_outer, mut of_inner) = (of_along, Vec3::zero());
        if follows {
            of_inner -= of_along * share;
            let of_share = -of_along.dot(inner) / inner.z;
            of_outer.z += of_share;
            of_inner.z -= of_share * share;
        }
        bases.pull(&mut pulled.at, 0, of_p);
        bases.pull(&mut pulled.at, 1, of_inner);
        bases.pull(&mut pulled.by, 0, of_outer);
        pulled.root +=
            of_p.dot(inner) + of_inner.dot(bases.sum(at, 2)) + of_outer.dot(bases.sum(by, 1));
        if moves {
            // z is the level at the cut.
            bases.pull(&mut pulled.at, 0, Vec3::of(0.0, 0.0, -pulled.root / inner.z));
        }
    }
}
