//! Certified integrals over a set: bounds that are proved, refined only where they are open.
//!
//! The box is divided into cells. Cells of solid or air only are certain; in others the leaves'
//! Taylor forms bound the solid part from both sides (`taylor`), regardless of its thickness and of
//! the number of sheets. The cells with the widest bounds are divided first, until the requested
//! width or the maximum number of cells is reached; nothing is left out.

use super::moments::{Moments, POWERS};
use super::taylor::{self, Combination, TaylorRoom, frame};
use crate::error::solid_box;
use crate::expr::interval::{Interval, sides};
use crate::expr::tape::{ExprInstruction, ExprTape};
use crate::facet::sheets::solid_part;
use crate::set::Leaf;
use crate::{FieldError, Primitive, Set};
use moldloft_budget::Budget;
use moldloft_num::{Box3, Real, Vec3};
use moldloft_parallel::prelude::*;
use std::sync::Arc;

/// Limits of the work on integrals.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Width of the volume's bracket at which work ends.
    pub accuracy: f64,
    /// Maximum number of cells.
    pub cells: usize,
    /// Maximum number of halvings of cells along each axis.
    pub depth: u32,
}

impl Effort {
    /// Until the volume's bracket has this width, with at most 400 000 cells.
    pub fn to(accuracy: f64) -> Self {
        Self { accuracy, cells: 400_000, depth: ALL }
    }

    /// The narrowest bracket for this number of cells.
    pub fn of_cells(cells: usize) -> Self {
        Self { accuracy: 0.0, cells, depth: ALL }
    }
}

/// Certified integrals.
pub struct Certified {
    /// Proved.
    pub bracket: Moments<Interval>,
    /// Within it.
    pub best: Moments<f64>,
    /// Number of cells examined.
    pub cells: usize,
    /// Cells with an undecided contribution, the widest first, each with its undecided volume.
    pub open: Vec<(Box3, f64)>,
    sealed: Moments<f64>,
    parts: Vec<Open>,
    leaves: Vec<Leaf>,
}

/// A partly solid cell.
struct Open {
    sides: [Interval; 3],
    tape: Arc<ExprTape<f64>>,
    combination: Option<Combination>,
    bracket: [Interval; 10],
    /// The width of its volume's bracket.
    width: f64,
    depth: u32,
}

enum CellOutcome {
    Air,
    Solid([Interval; 10]),
    Open(Box<Open>),
}

/// Below this depth all cells are divided as deep.
const ALL: u32 = 40;
/// Relative rounding of integrals: some hundred roundings of a whole cell.
const ROUNDING: f64 = 1e-13;
/// Cells with at least this part of the widest bracket are divided together.
const TOGETHER: f64 = 0.25;

fn whole(b: &[Interval; 3]) -> [Interval; 10] {
    POWERS.map(|powers| {
        (0..3).fold(Interval::point(1.0), |product, k| {
            product * super::moments::integral(b[k], powers[k])
        })
    })
}

/// Moves integrals about one point to another that is `d` before it.
fn shifted(m: &[Interval; 10], d: [Interval; 3]) -> [Interval; 10] {
    let mut out = *m;
    for i in 0..3 {
        out[1 + i] = m[1 + i] + m[0] * d[i];
    }
    for (k, [i, j]) in super::polytope::SECOND.into_iter().enumerate() {
        let square = if i == j { d[i].square() } else { d[i] * d[j] };
        out[4 + k] = m[4 + k] + m[1 + i] * d[j] + m[1 + j] * d[i] + m[0] * square;
    }
    out
}

struct Work<'a> {
    about: Vec3,
    /// The depth that all cells are divided to, when there is one.
    last: Option<u32>,
    budget: &'a Budget,
}

impl Work<'_> {
    /// Contribution of a cell.
    fn examined(
        &self,
        tape: &Arc<ExprTape<f64>>,
        sides: [Interval; 3],
        depth: u32,
        room: &mut TaylorRoom,
    ) -> CellOutcome {
        let range = tape.range(&sides, &mut room.ranges.ranges);
        if range.low > 0.0 {
            return CellOutcome::Air;
        }
        let local = [0, 1, 2].map(|k| sides[k] - Interval::point(self.about[k]));
        if range.high < 0.0 {
            return CellOutcome::Solid(whole(&local));
        }
        let tape = tape.pruned(&room.ranges.ranges).map_or_else(|| tape.clone(), Arc::new);
        let all = whole(&local);
        // Cells that are divided in any case need no bounds, except for bodies of planes, for which
        // they are final.
        let divided = self.last.is_some_and(|last| depth < last);
        let planes = || {
            let of = |code: &ExprInstruction<f64>| {
                matches!(
                    code,
                    ExprInstruction::Plane(..)
                        | ExprInstruction::Union(..)
                        | ExprInstruction::Common(..)
                )
            };
            tape.code.iter().all(of)
        };
        let combination = match divided && !planes() {
            true => None,
            false => Combination::of(&tape),
        };
        let Some(parts) =
            combination.as_ref().map(|c| taylor::bounds(&tape, c, &sides, false, room))
        else {
            // Nothing is known but that at most all of it is solid.
            let bracket = self.between(&[Interval::ZERO; 10], all[0].high, &local);
            let width = all[0].high;
            let open = Open { sides, tape, combination: None, bracket, width, depth };
            return CellOutcome::Open(Box::new(open));
        };
        let (centre, half) = frame(&sides);
        let pad = ROUNDING * all[0].high;
        let reach = half.norm();
        let mut least = parts.least.map(Interval::point);
        for (x, powers) in least.iter_mut().zip(POWERS) {
            let error = pad * reach.powi(powers.iter().sum::<u32>() as i32);
            *x = Interval { low: x.low - error, high: x.high + error };
        }
        let high = (parts.most[0] + pad).min(all[0].high);
        let low = (parts.least[0] - pad).clamp(0.0, high);
        if high <= 2.0 * pad {
            // All air, to rounding: as much as that may be solid.
            if parts.most[0] <= 0.0 {
                return CellOutcome::Air;
            }
        }
        least[0] = Interval { low, high: low.max(least[0].high) };
        let d = [0, 1, 2].map(|k| Interval::point(centre[k]) - Interval::point(self.about[k]));
        let mut bracket = self.between(&shifted(&least, d), (high - low).max(0.0), &local);
        bracket[0] = Interval { low, high };
        let width = (high - low).max(0.0);
        if parts.least[0] >= all[0].low * (1.0 - ROUNDING) {
            return CellOutcome::Solid(all);
        }
        let open = Open { sides, tape, combination, bracket, width, depth };
        CellOutcome::Open(Box::new(open))
    }

    /// Integrals of a part that is certain and of up to `more` volume anywhere in the cell.
    fn between(
        &self,
        certain: &[Interval; 10],
        more: f64,
        local: &[Interval; 3],
    ) -> [Interval; 10] {
        let more = Interval { low: 0.0, high: more };
        let mut out = *certain;
        for (x, powers) in out.iter_mut().zip(POWERS) {
            let monomial = (0..3).fold(Interval::point(1.0), |m, k| match powers[k] {
                0 => m,
                n => m * local[k].powi(n),
            });
            *x = *x + more * monomial;
        }
        out
    }
}

fn halves(sides: &[Interval; 3]) -> impl Iterator<Item = [Interval; 3]> + '_ {
    (0..8).map(|k| {
        [0, 1, 2].map(|axis| {
            let (side, middle) = (sides[axis], sides[axis].middle());
            match k >> axis & 1 {
                0 => Interval::new(side.low, middle),
                _ => Interval::new(middle, side.high),
            }
        })
    })
}

/// Certified integrals over the part of a set that is within a box, about its middle.
///
/// # Errors
/// A box without volume; [`FieldError::Spent`].
///
/// # Example
/// ```
/// use moldloft_field::{Effort, Primitive, Set, certified};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = |r| Primitive::sphere(Vec3::zero(), r).map(|f| Set::new(&f));
/// let shell = ball(1.0)? - ball(0.999)?;
/// let over = Box3 { low: Vec3::of(-1.1, -1.1, -1.1), high: Vec3::of(1.1, 1.1, 1.1) };
/// let found = certified(&shell, &over, &Effort::of_cells(64_000), &Default::default())?;
/// let exact = 4.0 / 3.0 * std::f64::consts::PI * (1.0 - 0.999f64.powi(3));
/// assert!(found.bracket.volume().contains(exact));
/// assert!((found.best.volume() / exact - 1.0).abs() < 1e-3);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn certified(
    set: &Set,
    over: &Box3,
    effort: &Effort,
    budget: &Budget,
) -> Result<Certified, FieldError> {
    let over = solid_box(*over)?;
    // Sheets have no volume.
    let compiled = solid_part(set).compiled_within_memory()?;
    let about = over.centre();
    let last = (effort.accuracy <= 0.0 && effort.depth < ALL).then_some(effort.depth);
    let work = Work { about, last, budget };
    let mut sealed = Moments::zero(about);
    let mut open: Vec<Open> = Vec::new();
    let mut cells = 1;
    let mut take = |outcome: CellOutcome, open: &mut Vec<Open>| match outcome {
        CellOutcome::Air => {}
        CellOutcome::Solid(part) => sealed.add(&part),
        CellOutcome::Open(cell) => open.push(*cell),
    };
    let first = work.examined(&compiled.tape, sides(&over), 0, &mut TaylorRoom::default());
    take(first, &mut open);
    loop {
        work.budget.poll()?;
        // The widest first; equally wide ones by coordinates.
        let place = |c: &Open| c.sides.map(|s| s.low);
        open.sort_by(|a, b| {
            let by_place = place(a).into_iter().zip(place(b)).map(|(a, b)| a.total_cmp(&b));
            b.width
                .total_cmp(&a.width)
                .then(by_place.fold(std::cmp::Ordering::Equal, |o, x| o.then(x)))
        });
        let total: f64 = open.iter().map(|c| c.width).sum();
        let left = effort.cells.saturating_sub(cells) / 8;
        let Some(widest) = open.iter().find(|c| c.depth < effort.depth).map(|c| c.width) else {
            break;
        };
        if total <= effort.accuracy || left == 0 || widest <= 4.0 * ROUNDING * volume_of(&over) {
            break;
        }
        let mut chosen = Vec::new();
        let mut kept = Vec::new();
        for cell in open.drain(..) {
            let wide = cell.width >= TOGETHER * widest && cell.depth < effort.depth;
            if wide && chosen.len() < left { chosen.push(cell) } else { kept.push(cell) }
        }
        open = kept;
        cells += 8 * chosen.len();
        let parts: Vec<Vec<CellOutcome>> = chosen
            .par_iter()
            .map_init(TaylorRoom::default, |room, cell| {
                let each = |half| work.examined(&cell.tape, half, cell.depth + 1, room);
                halves(&cell.sides).map(each).collect()
            })
            .collect();
        parts.into_iter().flatten().for_each(|outcome| take(outcome, &mut open));
    }
    let mut bracket = sealed;
    for cell in &open {
        bracket.add(&cell.bracket);
    }
    bracket.terms[0].low = bracket.terms[0].low.max(0.0);
    let solid = Moments { about, terms: sealed.terms.map(Interval::middle) };
    let places = open.iter().filter(|c| c.width > 0.0).map(|c| (box_of(&c.sides), c.width));
    let mut found = Certified {
        bracket,
        best: solid,
        cells,
        open: places.collect(),
        sealed: solid,
        parts: open,
        leaves: compiled.leaves,
    };
    let primitive = |leaf: u32| Some(found.leaves[leaf as usize].primitive.clone());
    found.best = found.best_by(&primitive).clamped(&found.bracket);
    Ok(found)
}

fn volume_of(b: &Box3) -> f64 {
    (0..3).map(|k| b.high[k] - b.low[k]).product()
}

fn box_of(sides: &[Interval; 3]) -> Box3 {
    Box3 { low: sides.map(|s| s.low).into(), high: sides.map(|s| s.high).into() }
}

impl Certified {
    /// The leaves that numbers of leaves mean.
    pub(crate) fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// The best integrals, of the leaves as they are with derivatives; `primitive` gives these by number.
    pub(crate) fn best_by<T: Real>(
        &self,
        primitive: &(dyn Fn(u32) -> Option<Primitive<T>> + Sync),
    ) -> Moments<T> {
        const CHUNK: usize = 256;
        let chunks: Vec<[T; 10]> = self
            .parts
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut sum = [T::zero(); 10];
                for cell in chunk {
                    let part = self.part(cell, primitive);
                    sum.iter_mut().zip(part).for_each(|(s, x)| *s += x);
                }
                sum
            })
            .collect();
        let mut terms = self.sealed.terms.map(T::from);
        for chunk in chunks {
            terms.iter_mut().zip(chunk).for_each(|(s, x)| *s += x);
        }
        Moments { about: self.sealed.about, terms }
    }

    /// Contribution of one cell, about the middle of the box.
    fn part<T: Real>(
        &self,
        cell: &Open,
        primitive: &dyn Fn(u32) -> Option<Primitive<T>>,
    ) -> [T; 10] {
        let (centre, half) = frame(&cell.sides);
        let Some(combination) = &cell.combination else {
            // As much of it as of a few points.
            let n = 4;
            let at = |k: usize| (2 * k + 1) as f64 / n as f64 - 1.0;
            let solid = (0..n * n * n).filter(|m| {
                let u: Vec3 = Vec3::of(at(m / (n * n)), at(m / n % n), at(m % n));
                let p = centre + Vec3::of(u.x * half.x, u.y * half.y, u.z * half.z);
                cell.tape.eval::<f64>(&p, &mut Vec::new()) <= 0.0
            });
            let share = solid.count() as f64 / (n * n * n) as f64;
            return cell.bracket.map(|x| T::from(x.low + share * (x.high - x.low)));
        };
        let m = taylor::best(combination, &cell.sides, primitive);
        // A first-order value outside the bracket is invalid: the nearest end is better.
        let volume = T::from(m[0].re().clamp(cell.bracket[0].low, cell.bracket[0].high));
        let m0 = if volume.re() == m[0].re() { m[0] } else { volume };
        let d = centre - self.sealed.about;
        let mut out = m;
        out[0] = m0;
        for i in 0..3 {
            out[1 + i] = m[1 + i] + m0 * d[i];
        }
        for (k, [i, j]) in super::polytope::SECOND.into_iter().enumerate() {
            out[4 + k] = m[4 + k] + m[1 + i] * d[j] + m[1 + j] * d[i] + m0 * (d[i] * d[j]);
        }
        out
    }
}
