//! Dimensions that are not along an axis: length, slope, angle, equal length.
//!
//! They act only on what the axis dimensions leave open. Equations with one unknown are solved first,
//! then the rest together, by Newton's method from the estimate of the drawing, so of several
//! solutions the one near the drawing is taken. Derivatives come from one more step in the scalar
//! itself (implicit function theorem).

use crate::dimension::layout::{DimensionFault, Layout};
use crate::dimension::{Dimension, Measure};
use crate::drawing::estimate::Estimate;
use crate::drawing::planes::Planes;
use crate::object::Object;
use crate::{Axis, LineId, PointId};
use moldloft_num::{Dual, Real, Vec3, solve_dense};

type Floating<T> = Vec<(Axis, Vec<(usize, T)>)>;

/// The ends of a line; for an angle, away from the common point.
fn vector<T: Real>(
    object: &Object,
    line: LineId,
    from: Option<PointId>,
    at: &dyn Fn(PointId) -> Option<Vec3<T>>,
) -> Option<Vec3<T>> {
    let line = object.drawing.lines.get(&line)?;
    let d = at(line.q)? - at(line.p)?;
    Some(if from == Some(line.q) { -d } else { d })
}

/// What a derived measure comes to. An [`Measure::Equal`] is the ratio of the lengths.
pub fn value<T: Real>(
    object: &Object,
    measure: &Measure,
    at: &dyn Fn(PointId) -> Option<Vec3<T>>,
) -> Option<T> {
    let lines = &object.drawing.lines;
    match *measure {
        Measure::Length(l) => Some(vector(object, l, None, at)?.norm()),
        Measure::Slope(l) => {
            let d = vector(object, l, None, at)?;
            let up = object.drawing.letters.up.index();
            let run = Axis::ALL.into_iter().map(Axis::index).filter(|&k| k != up);
            let square = run.fold(T::zero(), |s, k| s + d[k] * d[k]);
            let rise = d[up].abs();
            (rise.re() > 0.0).then(|| square.sqrt() / rise)
        }
        Measure::Angle(a, b) => {
            let (la, lb) = (lines.get(&a)?, lines.get(&b)?);
            let common = [la.p, la.q].into_iter().find(|p| [lb.p, lb.q].contains(p));
            let (a, b) = (vector(object, a, common, at)?, vector(object, b, common, at)?);
            let angle = a.cross(b).norm().atan2(a.dot(b));
            Some(angle * (180.0 / std::f64::consts::PI))
        }
        Measure::Equal(a, b) => {
            let length = vector(object, a, None, at)?.norm();
            (length.re() > 0.0).then_some(())?;
            Some(vector(object, b, None, at)?.norm() / length)
        }
        Measure::Along { .. } | Measure::Datum { .. } => None,
    }
}

/// The points of a derived measure.
fn points(object: &Object, measure: &Measure) -> Vec<PointId> {
    let lines = match *measure {
        Measure::Length(l) | Measure::Slope(l) => vec![l],
        Measure::Angle(a, b) | Measure::Equal(a, b) => vec![a, b],
        _ => vec![],
    };
    lines.iter().filter_map(|l| object.drawing.lines.get(l)).flat_map(|l| [l.p, l.q]).collect()
}

/// Solves for the positions of floating parts, which leave `floating` when they are determined.
pub(crate) fn solve_derived<T: Real>(
    object: &Object,
    planes: &Planes,
    layout: &mut Layout<T>,
    floating: &mut Floating<T>,
    dimensions: &[&Dimension],
    estimate: &dyn Fn() -> Option<Estimate>,
) -> Vec<DimensionFault> {
    let mut faults = Vec::new();
    let guess = if floating.is_empty() { None } else { estimate() };
    let scale = guess.as_ref().map_or(1.0, |e| scale(object, planes, layout, e));
    let mut left: Vec<&Dimension> = dimensions.to_vec();
    loop {
        // The floating parts that each equation reads.
        let reads = |d: &Dimension| {
            let mut parts: Vec<usize> = points(object, &d.measure)
                .into_iter()
                .flat_map(|p| Axis::ALL.map(|a| (a, planes.plane(a, p))))
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
        // What is fully determined only has to agree.
        if let Some(k) = table.iter().position(Vec::is_empty) {
            let d = left.remove(k);
            faults.extend(check(object, planes, layout, d));
            continue;
        }
        let Some((equations, unknowns)) = block(&table) else { break };
        let chosen: Vec<&Dimension> = equations.iter().map(|&k| left[k]).collect();
        let start = |part: &(Axis, Vec<(usize, T)>)| {
            let (axis, nodes) = part;
            let at = guess.as_ref().map_or(0.0, |e| {
                let (mut sum, n) = (0.0, nodes.len() as f64);
                for (plane, offset) in nodes {
                    sum += e.plane(*axis, *plane) * scale - offset.re();
                }
                sum / n
            });
            let origin = object.reference().map_or(0.0, |r| r.at[axis.index()]);
            at + origin
        };
        let x: Vec<f64> = unknowns.iter().map(|&u| start(&floating[u])).collect();
        let system =
            System { object, planes, layout, floating, unknowns: &unknowns, dimensions: &chosen };
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
    object: &Object,
    planes: &Planes,
    layout: &Layout<T>,
    estimate: &Estimate,
) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for (key, d) in &object.dimensions {
        if let Measure::Along { axis, p, q } = d.measure
            && let (Some(a), Some(b)) = (planes.plane(axis, p), planes.plane(axis, q))
            && let Some(value) = layout.values.get(key)
        {
            let gap = estimate.plane(axis, b) - estimate.plane(axis, a);
            product += value.re() * gap;
            square += gap * gap;
        }
    }
    if square > 0.0 && product > 0.0 { product / square } else { 1.0 }
}

fn check<T: Real>(
    object: &Object,
    planes: &Planes,
    layout: &Layout<T>,
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

/// A square system of derived dimensions.
struct System<'a, T> {
    object: &'a Object,
    planes: &'a Planes,
    layout: &'a Layout<T>,
    floating: &'a Floating<T>,
    unknowns: &'a [usize],
    dimensions: &'a [&'a Dimension],
}

impl<T: Real> System<'_, T> {
    /// The residuals at `x` over the scalar `S`, into which `lift` takes the known numbers.
    fn residuals<S: Real>(&self, x: &[S], lift: &dyn Fn(T) -> S) -> Option<Vec<S>> {
        let coordinate = |axis: Axis, p: PointId| -> Option<S> {
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
        let at = |p: PointId| {
            let [x, y, z] = Axis::ALL.map(|a| coordinate(a, p));
            // An undetermined coordinate that the measure does not depend on counts as zero.
            Some(Vec3::new(x.unwrap_or_default(), y.unwrap_or_default(), z.unwrap_or_default()))
        };
        self.dimensions
            .iter()
            .map(|d| {
                let asked = *self.layout.values.get(&d.name.to_ascii_lowercase())?;
                Some(value(self.object, &d.measure, &at)? - lift(asked))
            })
            .collect()
    }

    /// The Jacobian at `x`, row by row.
    fn jacobian(&self, x: &[f64]) -> Option<Vec<f64>> {
        let n = x.len();
        let mut jacobian = vec![0.0; n * n];
        for c in 0..n {
            let seeded: Vec<Dual<1>> = (0..n)
                .map(|k| if k == c { Dual::seeded(x[k], 0) } else { Dual::from(x[k]) })
                .collect();
            for (r, f) in self.residuals(&seeded, &|t| Dual::from(t.re()))?.iter().enumerate() {
                jacobian[r * n + c] = f.eps[0];
            }
        }
        Some(jacobian)
    }

    fn solve(&self, mut x: Vec<f64>) -> Result<Vec<T>, f64> {
        const STEPS: usize = 60;
        let plain = |x: &[f64]| self.residuals(x, &|t: T| t.re());
        let size = |f: &[f64]| f.iter().map(|a| a * a).sum::<f64>();
        let mut f = plain(&x).ok_or(f64::INFINITY)?;
        let scale = 1.0 + f.iter().map(|a| a.abs()).fold(0.0, f64::max);
        for _ in 0..STEPS {
            let worst = size(&f);
            if !worst.is_finite() || worst == 0.0 {
                break;
            }
            let mut jacobian = self.jacobian(&x).ok_or(worst)?;
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
        // One step over the scalar: x - J⁻¹ F(x) carries the derivatives.
        let lifted: Vec<T> = x.iter().map(|&a| T::from(a)).collect();
        let mut step = self.residuals(&lifted, &|t| t).ok_or(residual)?;
        let mut jacobian: Vec<T> =
            self.jacobian(&x).ok_or(residual)?.into_iter().map(T::from).collect();
        if solve_dense(&mut jacobian, &mut step).is_err() {
            return Err(residual);
        }
        Ok(lifted.into_iter().zip(step).map(|(x, s)| x - s).collect())
    }
}
