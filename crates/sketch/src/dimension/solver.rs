//! Dimensions that are not along an axis: length, slope, angle, equal length.
//!
//! They act only on the freedom left by the axis dimensions. Equations with one unknown are solved
//! first, then the rest together. Of several solutions the one nearest to the drawing is taken: the
//! drawn lengths and angles are changed into the given ones by continuation with Newton's method,
//! and the sign of the determinant of the equations, which distinguishes a solution from its mirror
//! image, must not change. So the same text gives the same branch, independent of earlier values.
//! Derivatives come from one more step in the scalar itself (implicit function theorem).

use crate::dimension::layout::{DimensionFault, DimensionLayout};
use crate::dimension::{Dimension, MeasuredQuantity};
use crate::drawing::estimate::Estimate;
use crate::drawing::planes::Planes;
use crate::object::SketchObject;
use crate::{CoordinateAxis, LineId, PointId};
use moldloft_num::{Dual, Real, Vec3, determinant, solve_dense};

type Floating<T> = Vec<(CoordinateAxis, Vec<(usize, T)>)>;

/// The ends of a line; for an angle, away from the common point.
fn vector<T: Real>(
    object: &SketchObject,
    line: LineId,
    from: Option<PointId>,
    at: &dyn Fn(PointId) -> Option<Vec3<T>>,
) -> Option<Vec3<T>> {
    let line = object.drawing.lines.get(&line)?;
    let d = at(line.q)? - at(line.p)?;
    Some(if from == Some(line.q) { -d } else { d })
}

/// Value of a derived measure. An [`MeasuredQuantity::Equal`] is the ratio of the lengths.
pub fn value<T: Real>(
    object: &SketchObject,
    measure: &MeasuredQuantity,
    at: &dyn Fn(PointId) -> Option<Vec3<T>>,
) -> Option<T> {
    let lines = &object.drawing.lines;
    match *measure {
        MeasuredQuantity::Length(l) => Some(vector(object, l, None, at)?.norm()),
        MeasuredQuantity::Slope(l) => {
            let d = vector(object, l, None, at)?;
            let up = object.drawing.letters.up.index();
            let run =
                CoordinateAxis::ALL.into_iter().map(CoordinateAxis::index).filter(|&k| k != up);
            let square = run.fold(T::zero(), |s, k| s + d[k] * d[k]);
            let rise = d[up].abs();
            (rise.re() > 0.0).then(|| square.sqrt() / rise)
        }
        MeasuredQuantity::Angle(a, b) => {
            let (la, lb) = (lines.get(&a)?, lines.get(&b)?);
            let common = [la.p, la.q].into_iter().find(|p| [lb.p, lb.q].contains(p));
            let (a, b) = (vector(object, a, common, at)?, vector(object, b, common, at)?);
            let angle = a.cross(b).norm().atan2(a.dot(b));
            Some(angle * (180.0 / std::f64::consts::PI))
        }
        MeasuredQuantity::Equal(a, b) => {
            let length = vector(object, a, None, at)?.norm();
            (length.re() > 0.0).then_some(())?;
            Some(vector(object, b, None, at)?.norm() / length)
        }
        MeasuredQuantity::Along { .. } | MeasuredQuantity::Datum { .. } => None,
    }
}

fn points(object: &SketchObject, measure: &MeasuredQuantity) -> Vec<PointId> {
    let lines = match *measure {
        MeasuredQuantity::Length(l) | MeasuredQuantity::Slope(l) => vec![l],
        MeasuredQuantity::Angle(a, b) | MeasuredQuantity::Equal(a, b) => vec![a, b],
        _ => vec![],
    };
    lines.iter().filter_map(|l| object.drawing.lines.get(l)).flat_map(|l| [l.p, l.q]).collect()
}

/// Solves for the positions of floating parts, which leave `floating` when they are determined.
pub(crate) fn solve_derived<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &mut DimensionLayout<T>,
    floating: &mut Floating<T>,
    dimensions: &[&Dimension],
    estimate: &dyn Fn() -> Option<Estimate>,
) -> Vec<DimensionFault> {
    let mut faults = Vec::new();
    let guess = if floating.is_empty() { None } else { estimate() };
    let scale = guess.as_ref().map_or(1.0, |e| scale(object, planes, layout, e));
    let mut left: Vec<&Dimension> = dimensions.to_vec();
    // All together first: a part solved separately would lose its orientation relative to the
    // others.
    let mut together = true;
    loop {
        // The floating parts that each equation reads.
        let reads = |d: &Dimension| {
            let mut parts: Vec<usize> = points(object, &d.measure)
                .into_iter()
                .flat_map(|p| CoordinateAxis::ALL.map(|a| (a, planes.plane(a, p))))
                .filter_map(|(a, plane)| {
                    let has = |part: &Vec<(usize, T)>| part.iter().any(|n| Some(n.0) == plane);
                    floating.iter().position(|(axis, part)| *axis == a && has(part))
                })
                .collect();
            parts.sort_unstable();
            parts.dedup();
            parts
        };
        let table: Vec<Vec<usize>> = left.iter().map(|d| reads(d)).collect();
        // A fully determined dimension only has to agree.
        if let Some(k) = table.iter().position(Vec::is_empty) {
            let d = left.remove(k);
            faults.extend(check(object, planes, layout, d));
            continue;
        }
        let whole = Some(&table).filter(|_| std::mem::take(&mut together)).and_then(|t| {
            let mut all: Vec<usize> = t.iter().flatten().copied().collect();
            all.sort_unstable();
            all.dedup();
            (all.len() == t.len() && t.len() <= MOST_TOGETHER)
                .then(|| ((0..t.len()).collect(), all))
        });
        let tried_whole = whole.is_some();
        let Some((equations, unknowns)) = whole.or_else(|| block(&table)) else { break };
        let chosen: Vec<&Dimension> = equations.iter().map(|&k| left[k]).collect();
        let start = |part: &(CoordinateAxis, Vec<(usize, T)>)| {
            let (axis, nodes) = part;
            let at = guess.as_ref().map_or(0.0, |e| {
                let (mut sum, n) = (0.0, nodes.len() as f64);
                for (plane, offset) in nodes {
                    sum += e.plane(*axis, *plane) * scale - offset.re();
                }
                sum / n
            });
            let origin = object.reference().and_then(|r| layout.coordinate(planes, *axis, r.point));
            at + origin.map_or(0.0, T::re)
        };
        let x: Vec<f64> = unknowns.iter().map(|&u| start(&floating[u])).collect();
        let mut system = System {
            object,
            planes,
            layout,
            floating,
            unknowns: &unknowns,
            dimensions: &chosen,
            turns: Vec::new(),
        };
        system.turns = system.drawn_turns(&x);
        if tried_whole && equations.len() > 1 && !system.regular(&x) {
            // Some of them determine others: one after the other.
            continue;
        }
        match system.solve(x) {
            Ok(solution) => {
                for (&u, x) in unknowns.iter().zip(solution) {
                    let (axis, nodes) = &floating[u];
                    for (plane, offset) in nodes {
                        layout.coordinates[axis.index()][*plane] = Some(*offset + x);
                    }
                    let count = &mut layout.counts[axis.index()];
                    count.missing -= 1;
                    count.given += 1;
                }
                for &u in unknowns.iter().rev() {
                    floating.remove(u);
                }
            }
            Err(residual) => faults.extend(
                chosen.iter().map(|d| DimensionFault::Unsolved { name: d.name.clone(), residual }),
            ),
        }
        for &k in equations.iter().rev() {
            left.remove(k);
        }
    }
    faults
}

/// The fewest equations with as many unknowns: one alone, else a growing group.
fn block(table: &[Vec<usize>]) -> Option<(Vec<usize>, Vec<usize>)> {
    let mut best: Option<(Vec<usize>, Vec<usize>)> = None;
    for first in 0..table.len() {
        let (mut equations, mut unknowns) = (vec![first], table[first].clone());
        while equations.len() < unknowns.len() {
            // The equation that adds the fewest unknowns.
            let adds = |k: &usize| table[*k].iter().filter(|u| !unknowns.contains(u)).count();
            let next = (0..table.len()).filter(|k| !equations.contains(k)).min_by_key(adds);
            let Some(k) = next else { break };
            equations.push(k);
            unknowns.extend(table[k].iter().copied());
            unknowns.sort_unstable();
            unknowns.dedup();
        }
        let smaller = best.as_ref().is_none_or(|(e, _)| equations.len() < e.len());
        if equations.len() == unknowns.len() && smaller {
            equations.sort_unstable();
            best = Some((equations, unknowns));
        }
    }
    best
}

/// Model units per unit of the page, from the dimensions along axes.
pub fn scale<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
    estimate: &Estimate,
) -> f64 {
    PageScale::of(object, planes, layout, estimate).value()
}

/// The sums of a scale, to which dimensions along axes can be added.
pub(crate) struct PageScale {
    /// Of value times gap, and of gap squared.
    along: [f64; 2],
    /// The same for each line with a length.
    lengths: Vec<[f64; 2]>,
}

impl PageScale {
    pub fn of<T: Real>(
        object: &SketchObject,
        planes: &Planes,
        layout: &DimensionLayout<T>,
        estimate: &Estimate,
    ) -> PageScale {
        let mut out = PageScale { along: [0.0; 2], lengths: Vec::new() };
        for (key, d) in &object.dimensions {
            let Some(value) = layout.values.get(key).map(|v| v.re()) else { continue };
            match d.measure {
                MeasuredQuantity::Along { axis, p, q } => {
                    let gap = estimate.gap(planes, axis, [p, q]);
                    gap.into_iter().for_each(|gap| out.add(value, gap));
                }
                MeasuredQuantity::Length(l) => {
                    let Some(line) = object.drawing.lines.get(&l) else { continue };
                    let [p, q] = [line.p, line.q].map(|p| estimate.point(planes, p));
                    let long = p.distance(q);
                    out.lengths.push([value * long, long * long]);
                }
                _ => {}
            }
        }
        out
    }

    /// Adds a dimension along an axis.
    pub fn add(&mut self, value: f64, gap: f64) {
        self.along[0] += value * gap;
        self.along[1] += gap * gap;
    }

    /// From the lengths where the dimensions along axes determine none.
    pub fn value(&self) -> f64 {
        let ratio =
            |[product, square]: [f64; 2]| (square > 0.0 && product > 0.0).then(|| product / square);
        let with_lengths =
            || self.lengths.iter().fold(self.along, |s, l| [s[0] + l[0], s[1] + l[1]]);
        ratio(self.along).or_else(|| ratio(with_lengths())).unwrap_or(1.0)
    }
}

fn check<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
    d: &Dimension,
) -> Option<DimensionFault> {
    let asked = layout.values.get(&d.name.to_ascii_lowercase())?.re();
    let (name, path) = (d.name.clone(), Vec::new());
    let measured = layout.measured(object, planes, &d.measure).map(Real::re);
    Some(match measured {
        Some(m) if (m - asked).abs() <= 1e-9 * asked.abs().max(1.0) => {
            DimensionFault::Redundant { name, path }
        }
        Some(measured) => DimensionFault::Contradictory { name, asked, measured, path },
        None => DimensionFault::Unsolved { name, residual: asked.abs() },
    })
}

/// More equations than this are solved in parts.
const MOST_TOGETHER: usize = 60;

/// A square system of derived dimensions.
struct System<'a, T> {
    object: &'a SketchObject,
    planes: &'a Planes,
    layout: &'a DimensionLayout<T>,
    floating: &'a Floating<T>,
    unknowns: &'a [usize],
    dimensions: &'a [&'a Dimension],
    /// By dimension, of an angle in a section: the side to which it was drawn, 1 or -1; else 0.
    turns: Vec<f64>,
}

/// A point on the path from the drawing to the given values.
struct ContinuationPoint {
    x: Vec<f64>,
    /// The sign of the determinant there.
    sign: f64,
}

impl<T: Real> System<'_, T> {
    /// The points of the lines at `x` over the scalar `S`, into which `lift` takes the known numbers.
    fn at<S: Real>(&self, x: &[S], lift: &dyn Fn(T) -> S, p: PointId) -> Option<Vec3<S>> {
        let coordinate = |axis: CoordinateAxis| -> Option<S> {
            let plane = self.planes.plane(axis, p)?;
            if let Some(known) = self.layout.coordinates[axis.index()][plane] {
                return Some(lift(known));
            }
            self.unknowns.iter().zip(x).find_map(|(&u, &x)| {
                let (a, nodes) = &self.floating[u];
                let node = nodes.iter().find(|n| *a == axis && n.0 == plane)?;
                Some(lift(node.1) + x)
            })
        };
        // An undetermined coordinate that the measure does not depend on counts as zero.
        let [x, y, z] = CoordinateAxis::ALL.map(|a| coordinate(a).unwrap_or_default());
        Some(Vec3::new(x, y, z))
    }

    /// The arms of an angle and the normal of the section, if it is in one.
    fn arms<S: Real>(
        &self,
        [a, b]: [LineId; 2],
        at: &dyn Fn(PointId) -> Option<Vec3<S>>,
    ) -> Option<([Vec3<S>; 2], Option<CoordinateAxis>)> {
        let lines = &self.object.drawing.lines;
        let (la, lb) = (lines.get(&a)?, lines.get(&b)?);
        let common = [la.p, la.q].into_iter().find(|p| [lb.p, lb.q].contains(p));
        let arms = [vector(self.object, a, common, at)?, vector(self.object, b, common, at)?];
        Some((arms, self.object.drawing.section))
    }

    /// True if the drawing determines all unknowns.
    fn regular(&self, x: &[f64]) -> bool {
        let jacobian = self.measured(x).and_then(|drawn| self.jacobian(x, &drawn));
        let n = x.len();
        jacobian.is_some_and(|j| {
            let row = |r: usize| j[r * n..(r + 1) * n].iter().map(|a| a * a).sum::<f64>().sqrt();
            let size: f64 = (0..n).map(row).product();
            determinant(&j, n).abs() > 1e-9 * size
        })
    }

    /// To which side each angle of a section was drawn.
    fn drawn_turns(&self, x: &[f64]) -> Vec<f64> {
        let at = |p: PointId| self.at::<f64>(x, &|t: T| t.re(), p);
        let turn = |d: &&Dimension| match d.measure {
            MeasuredQuantity::Angle(a, b) => match self.arms([a, b], &at) {
                Some(([a, b], Some(normal))) => {
                    let side = a.cross(b)[normal.index()];
                    if side < 0.0 { -1.0 } else { 1.0 }
                }
                _ => 0.0,
            },
            _ => 0.0,
        };
        self.dimensions.iter().map(turn).collect()
    }

    fn measured(&self, x: &[f64]) -> Option<Vec<f64>> {
        let at = |p: PointId| self.at::<f64>(x, &|t: T| t.re(), p);
        let one = |(d, turn): (&&Dimension, &f64)| match d.measure {
            MeasuredQuantity::Angle(a, b) if *turn != 0.0 => {
                let ([a, b], normal) = self.arms([a, b], &at)?;
                let side = a.cross(b)[normal?.index()] * *turn;
                Some(Real::atan2(side, a.dot(b)) * (180.0 / std::f64::consts::PI))
            }
            _ => value(self.object, &d.measure, &at),
        };
        self.dimensions.iter().zip(&self.turns).map(one).collect()
    }

    /// The residuals at `x` for the values `asked`. Lengths enter by their squares and angles by
    /// both sine and cosine, forms without extraneous solutions.
    fn residuals<S: Real>(&self, x: &[S], asked: &[S], lift: &dyn Fn(T) -> S) -> Option<Vec<S>> {
        let at = |p: PointId| self.at(x, lift, p);
        let one = |((d, &asked), &turn): ((&&Dimension, &S), &f64)| -> Option<S> {
            match d.measure {
                MeasuredQuantity::Length(l) => {
                    let square = vector(self.object, l, None, &at)?.norm_sq();
                    let half = if asked.re().abs() > 0.0 { asked * 2.0 } else { S::one() };
                    Some((square - asked * asked) / half)
                }
                MeasuredQuantity::Equal(a, b) => {
                    let first = vector(self.object, a, None, &at)?.norm_sq();
                    let second = vector(self.object, b, None, &at)?.norm_sq();
                    let size = first.re().max(second.re()).sqrt().max(f64::MIN_POSITIVE);
                    Some((second - first * asked * asked) / (2.0 * size))
                }
                MeasuredQuantity::Angle(a, b) if turn != 0.0 => {
                    let ([a, b], normal) = self.arms([a, b], &at)?;
                    let side = a.cross(b)[normal?.index()] * turn;
                    let degrees = side.atan2(a.dot(b)) * (180.0 / std::f64::consts::PI);
                    let off = degrees - asked;
                    Some(off - 360.0 * (off.re() / 360.0).round())
                }
                _ => Some(value(self.object, &d.measure, &at)? - asked),
            }
        };
        self.dimensions.iter().zip(asked).zip(&self.turns).map(one).collect()
    }

    /// The Jacobian at `x`, row by row.
    fn jacobian(&self, x: &[f64], asked: &[f64]) -> Option<Vec<f64>> {
        let n = x.len();
        let mut jacobian = vec![0.0; n * n];
        let asked: Vec<Dual<1>> = asked.iter().map(|&a| Dual::from(a)).collect();
        for c in 0..n {
            let seeded: Vec<Dual<1>> = (0..n)
                .map(|k| if k == c { Dual::seeded(x[k], 0) } else { Dual::from(x[k]) })
                .collect();
            let rows = self.residuals(&seeded, &asked, &|t| Dual::from(t.re()))?;
            for (r, f) in rows.iter().enumerate() {
                jacobian[r * n + c] = f.eps[0];
            }
        }
        Some(jacobian)
    }

    /// Newton's method from `x`; `None` when it does not converge at once and near.
    fn correct(&self, mut x: Vec<f64>, asked: &[f64], reach: f64) -> Option<ContinuationPoint> {
        let start = x.clone();
        let mut last = f64::INFINITY;
        for _ in 0..8 {
            let mut f = self.residuals(&x, asked, &|t: T| t.re())?;
            let mut jacobian = self.jacobian(&x, asked)?;
            let sign = determinant(&jacobian, x.len()).signum();
            solve_dense(&mut jacobian, &mut f).ok()?;
            let size = f.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            x.iter_mut().zip(&f).for_each(|(a, s)| *a -= s);
            let far = x.iter().zip(&start).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            if !size.is_finite() || far > reach || size > 0.7 * last.max(1e-9 * reach) {
                return None;
            }
            if size <= 1e-13 * (1.0 + x.iter().fold(0.0f64, |m, a| m.max(a.abs()))) {
                return Some(ContinuationPoint { x, sign });
            }
            last = size;
        }
        (last <= 1e-9 * reach).then(|| {
            let sign = self.jacobian(&x, asked).map_or(0.0, |j| determinant(&j, x.len()).signum());
            ContinuationPoint { x, sign }
        })
    }

    /// Follows the solution from values `from`, which hold at `x`, to `to`. `None` where it turns back.
    fn follow(&self, x: Vec<f64>, from: &[f64], to: &[f64]) -> Option<ContinuationPoint> {
        const SHORTEST: f64 = 1e-5;
        const MOST: usize = 3000;
        let sign = determinant(&self.jacobian(&x, from)?, x.len()).signum();
        let mut here = ContinuationPoint { x, sign };
        let (mut s, mut step) = (0.0, 0.125);
        for _ in 0..MOST {
            if s >= 1.0 {
                return Some(here);
            }
            let next: f64 = (s + step).min(1.0);
            let asked: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * next).collect();
            // No step farther than a part of the figure.
            let size = self.size(&here.x);
            match self.correct(here.x.clone(), &asked, 0.2 * size) {
                Some(found) if found.sign == here.sign => {
                    here = found;
                    s = next;
                    step *= 1.6;
                }
                _ => step *= 0.5,
            }
            if step < SHORTEST {
                return None;
            }
        }
        None
    }

    /// The shortest line of the dimensions, as a measure of steps.
    fn size(&self, x: &[f64]) -> f64 {
        let at = |p: PointId| self.at::<f64>(x, &|t: T| t.re(), p);
        let lines = self.dimensions.iter().flat_map(|d| match d.measure {
            MeasuredQuantity::Length(l) | MeasuredQuantity::Slope(l) => vec![l],
            MeasuredQuantity::Angle(a, b) | MeasuredQuantity::Equal(a, b) => vec![a, b],
            _ => vec![],
        });
        let lengths = lines.filter_map(|l| Some(vector(self.object, l, None, &at)?.norm()));
        let shortest = lengths.filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        if shortest.is_finite() { shortest } else { 1.0 }
    }

    fn solve(&self, x: Vec<f64>) -> Result<Vec<T>, f64> {
        let asked: Option<Vec<T>> = (self.dimensions.iter())
            .map(|d| self.layout.values.get(&d.name.to_ascii_lowercase()).copied())
            .collect();
        let asked = asked.ok_or(f64::INFINITY)?;
        let plain: Vec<f64> = asked.iter().map(|a| a.re()).collect();
        let drawn = self.measured(&x);
        let along = drawn.as_ref().and_then(|from| {
            self.follow(x.clone(), from, &plain).or_else(|| {
                // Another path: first the lengths, then the angles, or the reverse.
                let mixed = |angles: bool| -> Vec<f64> {
                    let kind = |d: &&&Dimension| matches!(d.measure, MeasuredQuantity::Angle(..));
                    let pick = |(k, d): (usize, &&Dimension)| {
                        if kind(&d) == angles { plain[k] } else { from[k] }
                    };
                    self.dimensions.iter().enumerate().map(pick).collect()
                };
                [false, true].into_iter().find_map(|first| {
                    let middle = mixed(first);
                    let there = self.follow(x.clone(), from, &middle)?;
                    self.follow(there.x, &middle, &plain)
                })
            })
        });
        let flat = || {
            let start = drawn.as_ref().and_then(|d| self.jacobian(&x, d));
            let sign = start.map_or(0.0, |j| determinant(&j, x.len()));
            if sign.is_finite() { sign.signum() * f64::from(u8::from(sign != 0.0)) } else { 0.0 }
        };
        let x = match along {
            Some(step) => step.x,
            // The drawing itself is a turning point, or there is no path: the nearest solution,
            // unless it is a mirror image of the drawing.
            None => {
                let sign = flat();
                let found = self.nearest(x.clone(), &plain)?;
                let own =
                    self.jacobian(&found, &plain).map_or(0.0, |j| determinant(&j, found.len()));
                if sign != 0.0 && own.signum() != sign {
                    let f = self.residuals(&x, &plain, &|t: T| t.re()).unwrap_or_default();
                    return Err(f.iter().fold(0.0f64, |m, r| m.max(r.abs())));
                }
                found
            }
        };
        // One step over the scalar: x - J⁻¹ F(x) carries the derivatives.
        let lifted: Vec<T> = x.iter().map(|&a| T::from(a)).collect();
        let mut step = self.residuals(&lifted, &asked, &|t| t).ok_or(f64::INFINITY)?;
        let jacobian = self.jacobian(&x, &plain).ok_or(f64::INFINITY)?;
        let mut jacobian: Vec<T> = jacobian.into_iter().map(T::from).collect();
        if solve_dense(&mut jacobian, &mut step).is_err() {
            return Err(f64::INFINITY);
        }
        Ok(lifted.into_iter().zip(step).map(|(x, s)| x - s).collect())
    }

    /// The solution that damped Newton steps lead to.
    fn nearest(&self, mut x: Vec<f64>, asked: &[f64]) -> Result<Vec<f64>, f64> {
        const STEPS: usize = 60;
        let plain = |x: &[f64]| self.residuals(x, asked, &|t: T| t.re());
        let size = |f: &[f64]| f.iter().map(|a| a * a).sum::<f64>();
        let mut f = plain(&x).ok_or(f64::INFINITY)?;
        let scale = 1.0 + f.iter().map(|a| a.abs()).fold(0.0, f64::max);
        for _ in 0..STEPS {
            let worst = size(&f);
            if !worst.is_finite() || worst == 0.0 {
                break;
            }
            let mut jacobian = self.jacobian(&x, asked).ok_or(worst)?;
            let mut step = f.clone();
            if solve_dense(&mut jacobian, &mut step).is_err() {
                // A flat start (an unknown exactly at its mirror plane): a nudge leaves it.
                x.iter_mut()
                    .enumerate()
                    .for_each(|(k, a)| *a += 1e-3 * (1.0 + k as f64) * (1.0 + a.abs()));
                f = plain(&x).ok_or(worst)?;
                continue;
            }
            let mut part = 1.0;
            let next = loop {
                let y: Vec<f64> = x.iter().zip(&step).map(|(a, s)| a - part * s).collect();
                match plain(&y) {
                    Some(g) if size(&g) < worst => break Some((y, g)),
                    _ if part < 1e-6 => break None,
                    _ => part *= 0.5,
                }
            };
            let Some((y, g)) = next else { break };
            (x, f) = (y, g);
        }
        let residual = Real::sqrt(size(&f));
        if !residual.is_finite() || residual > 1e-9 * scale {
            return Err(residual);
        }
        Ok(x)
    }
}
