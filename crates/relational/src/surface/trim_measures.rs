//! Area, middle and cone volume of a part of a surface, by integrals over the part itself: Green's theorem along the
//! loops, Gauss' rules across them. There are no triangles in it.
//!
//! The integral of f over a region is the loop integral of F dv, F the integral of f by u from a
//! line u = const to the loop (or of -G du, with u and v exchanged). Loops are split at their
//! breaks and at crossings with lines on which derivatives of the surface may jump, and so is the
//! segment across; each piece is a polynomial or analytic. The orders of the rules along and across
//! a piece are raised independently, and a piece at the maximum order is halved (Sommariva,
//! Vianello 2009, for the rule of one piece).

use crate::surface::trim_density::crossings;
use moldloft_num::{Order, Real, Vec3, gauss_rule};
use moldloft_registry::{CurveRef, SheetMeasures, SurfaceRef};

/// Maximum difference between rules, relative to the total.
const ACCURACY: f64 = 1e-10;

/// Points of the rules along a piece and across it, one after another.
const RULES: [usize; 5] = [4, 6, 9, 13, 19];

/// The most evaluations of the surface for one part.
const MAX_EVALUATIONS: usize = 3_000_000;

/// A curve of a loop; true if its direction is opposite to the loop's.
#[derive(Clone, Copy)]
pub(crate) struct LoopCurve<'a, T: Real> {
    pub curve: &'a CurveRef<T>,
    pub backwards: bool,
}

/// Area, first moments of it, and three times the volume of the cone from the origin.
#[derive(Clone, Copy)]
struct SurfaceSums<T: Real> {
    area: T,
    moment: Vec3<T>,
    cone: T,
}

impl<T: Real> SurfaceSums<T> {
    fn zero() -> Self {
        Self { area: T::zero(), moment: Vec3::zero(), cone: T::zero() }
    }

    fn plus(self, o: Self, by: T) -> Self {
        Self {
            area: self.area + o.area * by,
            moment: self.moment + o.moment * by,
            cone: self.cone + o.cone * by,
        }
    }

    /// Distance between two measures, in areas of a body of that size.
    fn apart(&self, o: &Self, size: f64) -> f64 {
        let moment = (self.moment - o.moment).re().norm();
        let cone = (self.cone - o.cone).re().abs();
        (self.area - o.area).re().abs().max((moment.max(cone)) / size)
    }
}

/// End of the segment across a piece.
#[derive(Clone, Copy)]
enum Far {
    Line(f64),
    Loop,
}

/// A part of a loop's curve, and a part of the segment from the base line to it.
#[derive(Clone, Copy)]
struct LoopPiece<'a, T: Real> {
    of: LoopCurve<'a, T>,
    along: [T; 2],
    near: f64,
    far: Far,
    /// Halvings of the segment across; this is part `part`.
    halvings: u32,
    part: u32,
    rules: [usize; 2],
    sums: SurfaceSums<T>,
    /// Error estimates of the present rules, along and across.
    errors: [f64; 2],
}

struct SurfaceIntegral<'a, T: Real> {
    surface: &'a SurfaceRef<T>,
    /// Parameter of the direction across: 0 for u.
    across: usize,
    size: f64,
    evaluations: usize,
}

impl<'a, T: Real> SurfaceIntegral<'a, T> {
    /// The integrand per parameter area.
    fn at(&self, u: T, v: T) -> SurfaceSums<T> {
        let jet = self.surface.jet(u, v, Order::First);
        let normal = jet.u.cross(jet.v);
        let area = if normal.re().norm() > 0.0 { normal.norm() } else { T::zero() };
        SurfaceSums { area, moment: jet.p * area, cone: jet.p.dot(normal) }
    }

    fn rule(&mut self, piece: &LoopPiece<'a, T>, rules: [usize; 2]) -> SurfaceSums<T> {
        let [along, across] = rules.map(|k| gauss_rule(RULES[k]));
        self.evaluations += along.len() * across.len();
        let reach = piece.along[1] - piece.along[0];
        let parts = f64::from(1u32 << piece.halvings);
        let mut sums = SurfaceSums::zero();
        for &(x, weight) in along {
            let t = piece.along[0] + reach * T::from(x);
            let Some([p, d, ..]) = piece.of.curve.on_surface(t, Order::First) else { continue };
            let (place, speed) = ([p.x, p.y], [d.x, d.y]);
            let near = T::from(piece.near);
            let far = match piece.far {
                Far::Line(x) => T::from(x),
                Far::Loop => place[self.across],
            };
            let step = (far - near) / parts;
            let near = near + step * f64::from(piece.part);
            let mut inner = SurfaceSums::zero();
            for &(y, share) in across {
                let at = near + step * T::from(y);
                let [u, v] = if self.across == 0 { [at, place[1]] } else { [place[0], at] };
                inner = inner.plus(self.at(u, v), T::from(share));
            }
            // F dv, or -G du.
            let sense = if (self.across == 1) != piece.of.backwards { -1.0 } else { 1.0 };
            let by = step * speed[1 - self.across] * reach * T::from(sense * weight);
            sums = sums.plus(inner, by);
        }
        sums
    }

    /// The piece by these rules, and its error estimated from rules of fewer points.
    fn ruled(&mut self, mut piece: LoopPiece<'a, T>, rules: [usize; 2]) -> LoopPiece<'a, T> {
        piece.rules = rules;
        piece.sums = self.rule(&piece, rules);
        piece.errors = [0, 1].map(|k| {
            let mut lower = rules;
            lower[k] -= 1;
            self.rule(&piece, lower).apart(&piece.sums, self.size)
        });
        piece
    }

    /// The piece with the worse of its rules raised, or its halves.
    fn refined(&mut self, piece: LoopPiece<'a, T>) -> Vec<LoopPiece<'a, T>> {
        let k = usize::from(piece.errors[1] > piece.errors[0]);
        if piece.rules[k] + 1 < RULES.len() {
            let mut rules = piece.rules;
            rules[k] += 1;
            return vec![self.ruled(piece, rules)];
        }
        let mut rules = piece.rules;
        rules[k] = 1;
        let mut halves = [piece; 2];
        if k == 0 {
            let middle = (piece.along[0] + piece.along[1]) * T::from(0.5);
            halves[0].along[1] = middle;
            halves[1].along[0] = middle;
        } else {
            for (i, half) in halves.iter_mut().enumerate() {
                half.halvings += 1;
                half.part = 2 * piece.part + i as u32;
            }
        }
        halves.into_iter().map(|half| self.ruled(half, rules)).collect()
    }
}

/// Parameter at which a path crosses a line, as a scalar of the model with the derivatives of the
/// path.
fn moved<T: Real>(curve: &CurveRef<T>, t: f64, axis: usize, line: f64) -> T {
    let at = T::from(t);
    if T::PARTS == 1 {
        return at;
    }
    let Some([p, d, ..]) = curve.on_surface(at, Order::First) else { return at };
    let (place, speed) = if axis == 0 { (p.x, d.x) } else { (p.y, d.y) };
    if speed.re() == 0.0 {
        return at;
    }
    let step = (place - T::from(line)) / speed.re();
    at - (step - step.re())
}

/// The measures of the part within loops, the outer one counter-clockwise and the holes clockwise;
/// and an estimate of the relative error of its area.
pub(crate) fn measured<'a, T: Real>(
    surface: &'a SurfaceRef<T>,
    loops: &[LoopCurve<'a, T>],
) -> (SheetMeasures<T>, f64) {
    let place = |c: &CurveRef<T>, t: f64| {
        c.on_surface(T::from(t), Order::Zero).map(|[w, ..]| [w.x.re(), w.y.re()])
    };
    let lines = surface.breaks();
    // Across in the direction in which the part is short, from the loop's lowest point.
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for c in loops {
        for p in (0..=32).filter_map(|i| place(c.curve, f64::from(i) / 32.0)) {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
    }
    let middle = [0, 1].map(|k| T::from(0.5 * (low[k] + high[k])));
    let jet = surface.jet(middle[0], middle[1], Order::First);
    let reach = [jet.u.re().norm() * (high[0] - low[0]), jet.v.re().norm() * (high[1] - low[1])];
    let across = usize::from(reach[0].partial_cmp(&reach[1]) != Some(std::cmp::Ordering::Less));
    let mut integral = SurfaceIntegral { surface, across, size: 1.0, evaluations: 0 };
    integral.size =
        [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().fold(f64::MIN_POSITIVE, |size, [i, j]| {
            let corner = [[low, high][i][0], [low, high][j][1]];
            let p = surface.jet(T::from(corner[0]), T::from(corner[1]), Order::Zero).p;
            size.max(p.re().norm())
        });
    let mut pieces = Vec::new();
    for of in loops {
        for piece in pieces_of(*of, &lines, across, low[across], place) {
            pieces.push(integral.ruled(piece, [1, 1]));
        }
    }
    settle(&mut integral, &mut pieces);
    let sums = pieces.iter().fold(SurfaceSums::zero(), |s, p| s.plus(p.sums, T::one()));
    let error = pieces.iter().map(|p| p.errors[0] + p.errors[1]).sum::<f64>();
    let empty = sums.area.re() <= 0.0;
    let centroid = if empty { Vec3::zero() } else { sums.moment / sums.area };
    let measures = SheetMeasures { area: sums.area, centroid, volume: sums.cone / T::from(3.0) };
    (measures, if empty { 1.0 } else { error / sums.area.re() })
}

/// A loop's curve split at its breaks and at the lines of the surface, with the segments to it from
/// the base line.
fn pieces_of<'a, T: Real>(
    of: LoopCurve<'a, T>,
    lines: &[Vec<f64>; 2],
    across: usize,
    base: f64,
    place: impl Fn(&CurveRef<T>, f64) -> Option<[f64; 2]>,
) -> Vec<LoopPiece<'a, T>> {
    let breaks = of.curve.breaks();
    let mut cuts: Vec<(f64, T)> = breaks.iter().map(|&t| (t, T::from(t))).collect();
    for (t, axis, line) in crossings(lines, &breaks, |t| place(of.curve, t)) {
        cuts.push((t, moved(of.curve, t, axis, line)));
    }
    cuts.retain(|c| c.0 > 0.0 && c.0 < 1.0);
    cuts.extend([(0.0, T::zero()), (1.0, T::one())]);
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    cuts.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-13);
    let mut pieces = Vec::new();
    for w in cuts.windows(2) {
        let along = [w[0].1, w[1].1];
        let Some(p) = place(of.curve, 0.5 * (w[0].0 + w[1].0)) else { continue };
        let end = p[across];
        let (from, to) = (base.min(end), base.max(end));
        let mut stops = vec![base];
        let mut between: Vec<f64> =
            lines[across].iter().copied().filter(|x| *x > from && *x < to).collect();
        if end < base {
            between.reverse();
        }
        stops.extend(between);
        for (k, &near) in stops.iter().enumerate() {
            let far = stops.get(k + 1).map_or(Far::Loop, |&x| Far::Line(x));
            let sums = SurfaceSums::zero();
            pieces.push(LoopPiece {
                of,
                along,
                near,
                far,
                halvings: 0,
                part: 0,
                rules: [1; 2],
                sums,
                errors: [0.0; 2],
            });
        }
    }
    pieces
}

/// Refines the worst pieces until their errors are small together.
fn settle<'a, T: Real>(integral: &mut SurfaceIntegral<'a, T>, pieces: &mut Vec<LoopPiece<'a, T>>) {
    loop {
        let area = pieces.iter().map(|p| p.sums.area.re()).sum::<f64>().abs();
        let goal = ACCURACY * area;
        let total: f64 = pieces.iter().map(|p| p.errors[0] + p.errors[1]).sum();
        if total <= goal || integral.evaluations > MAX_EVALUATIONS || !total.is_finite() {
            return;
        }
        // All pieces above their allowance, in order.
        let share = 0.5 * goal / pieces.len() as f64;
        let mut next = Vec::with_capacity(pieces.len());
        for piece in pieces.drain(..) {
            if piece.errors[0] + piece.errors[1] <= share || piece.halvings > 20 {
                next.push(piece);
            } else {
                next.extend(integral.refined(piece));
            }
        }
        *pieces = next;
    }
}
