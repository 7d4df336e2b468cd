//! Best integrals over a set by cells that are divided where it pays.
//!
//! In a cell the leaves are their planes at the middle, and the faces between these move by what second derivatives say
//! ([`taylor::best`]): of fifth order or more in the size of the cell on faces, edges and corners alike, and indifferent to
//! how many of them pass through it. A cell is compared with its eighth parts; the cells that differ most are divided, until
//! what may be wrong is as small as asked (de Doncker and Robinson 1984: globally adaptive cubature). What one cell has too much
//! at its walls its neighbour mostly has too little, so that differences are added with their signs, and as squares for chance. What
//! is estimated so is not proved: the certified bracket beside it is.

use super::moments::{Moments, POWERS};
use super::polytope::SECOND;
use super::taylor::{self, Combination, frame};
use crate::expr::interval::{Interval, sides};
use crate::expr::tape::ExprTape;
use crate::facet::sheets::solid_part;
use crate::set::Leaf;
use crate::{FieldError, Primitive, Set};
use moldloft_budget::Budget;
use moldloft_num::{Box3, Real, Vec3};
use moldloft_parallel::prelude::*;
use std::sync::Arc;

/// All cells with surface are halved this often, so that nothing is overlooked by chance.
const LEAST: u32 = 3;
/// No cell is halved more often.
const MOST: u32 = 30;
/// What differs by chance as little as that from its parts may still be wrong by this part of what was before.
const DOUBT: f64 = 0.02;
/// The cells that have this part of all that may be wrong are divided together.
const TOGETHER: f64 = 0.8;

/// A cell through which surface passes.
struct CubatureCell {
    sides: [Interval; 3],
    tape: Arc<ExprTape<f64>>,
    combination: Option<Combination>,
    /// About the middle of the box.
    integrals: [f64; 10],
    /// How much its volume may be wrong.
    doubt: f64,
    /// Its share of the difference that was found last, with its sign.
    share: f64,
    depth: u32,
}

/// How much the volume of all cells may be wrong: the sum of what was found, and thrice what it may be by chance. The parts
/// of one cell are not independent, so that their squares count for as many.
fn doubt_of(cells: &[CubatureCell]) -> f64 {
    let sum: f64 = cells.iter().map(|c| c.share).sum();
    let squares: f64 = cells.iter().map(|c| 8.0 * c.doubt * c.doubt).sum();
    sum.abs() + 3.0 * squares.sqrt()
}

/// Integrals over a set as sums over cells.
pub(crate) struct Cubature {
    whole: Moments<f64>,
    cells: Vec<CubatureCell>,
    leaves: Vec<Leaf>,
    /// How much the volume may be wrong, estimated.
    pub doubt: f64,
}

fn integrals_of(b: &[Interval; 3], about: Vec3) -> [f64; 10] {
    let local = [0, 1, 2].map(|k| b[k] - Interval::point(about[k]));
    POWERS.map(|powers| {
        (0..3).map(|k| super::moments::integral(local[k], powers[k]).middle()).product()
    })
}

/// Integrals about the middle of a cell as those about another point that is `d` before it.
fn moved<T: Real>(m: &[T; 10], d: Vec3) -> [T; 10] {
    let mut out = *m;
    for i in 0..3 {
        out[1 + i] = m[1 + i] + m[0] * d[i];
    }
    for (k, [i, j]) in SECOND.into_iter().enumerate() {
        out[4 + k] = m[4 + k] + m[1 + i] * d[j] + m[1 + j] * d[i] + m[0] * (d[i] * d[j]);
    }
    out
}

struct Examiner<'a> {
    about: Vec3,
    primitives: &'a [Primitive],
}

impl Examiner<'_> {
    /// A cell in which the set has a surface; of others what they contribute is added to `whole`.
    fn cell(
        &self,
        tape: &Arc<ExprTape<f64>>,
        sides: [Interval; 3],
        depth: u32,
        room: &mut Vec<Interval>,
        whole: &mut [f64; 10],
    ) -> Option<CubatureCell> {
        let range = tape.range(&sides, room);
        if range.low > 0.0 {
            return None;
        }
        if range.high < 0.0 {
            let own = integrals_of(&sides, self.about);
            whole.iter_mut().zip(own).for_each(|(w, x)| *w += x);
            return None;
        }
        let tape = tape.pruned(room).map_or_else(|| tape.clone(), Arc::new);
        let combination = Combination::of(&tape);
        let full: f64 = sides.iter().map(|s| s.width()).product();
        let primitive = |leaf: u32| Some(self.primitives[leaf as usize].clone());
        let integrals = match &combination {
            Some(combination) if depth >= LEAST => {
                part(combination, &sides, self.about, full, &primitive)
            }
            _ => integrals_of(&sides, self.about).map(|x| 0.5 * x),
        };
        Some(CubatureCell { sides, tape, combination, integrals, doubt: full, share: full, depth })
    }
}

/// What one cell contributes: half of the cell where the sum is not finite.
fn part<T: Real>(
    combination: &Combination,
    sides: &[Interval; 3],
    about: Vec3,
    full: f64,
    primitive: &dyn Fn(u32) -> Option<Primitive<T>>,
) -> [T; 10] {
    let m = taylor::best(combination, sides, primitive);
    let (centre, _) = frame(sides);
    let volume = m[0].re();
    if (0.0..=full).contains(&volume) && m.iter().all(|x| x.re().is_finite()) {
        return moved(&m, centre - about);
    }
    // Curvature that is too large for the cell: all of it, nothing, or as much as nothing is known of.
    let share = if volume.is_finite() { (volume / full).clamp(0.0, 1.0) } else { 0.5 };
    integrals_of(sides, about).map(|x| T::from(share * x))
}

fn eighths(sides: &[Interval; 3]) -> impl Iterator<Item = [Interval; 3]> + '_ {
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

impl Cubature {
    /// The integrals over the part of a set that is within a box, divided until the volume is thought to be that near to the
    /// truth or so many cells have been looked at.
    ///
    /// # Errors
    /// A box without volume; a budget that is spent.
    pub fn of(
        set: &Set,
        over: &Box3,
        near: f64,
        most: usize,
        budget: &Budget,
    ) -> Result<Self, FieldError> {
        let over = crate::error::solid_box(*over)?;
        let compiled = solid_part(set).compiled();
        let about = over.centre();
        let primitives: Vec<Primitive> =
            compiled.leaves.iter().map(|l| l.primitive.clone()).collect();
        let examiner = Examiner { about, primitives: &primitives };
        let mut whole = [0.0; 10];
        let first = examiner.cell(&compiled.tape, sides(&over), 0, &mut Vec::new(), &mut whole);
        let mut cells: Vec<CubatureCell> = first.into_iter().collect();
        let mut looked = 1;
        loop {
            budget.poll()?;
            let doubt: f64 = cells.iter().map(|c| c.doubt).sum();
            if doubt_of(&cells) <= near || looked >= most {
                break;
            }
            // The greatest first; equal ones by place.
            let place = |c: &CubatureCell| c.sides.map(|s| s.low);
            cells.sort_by(|a, b| {
                let mut by_place = place(a).into_iter().zip(place(b)).map(|(a, b)| a.total_cmp(&b));
                let differs = by_place.find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal);
                b.doubt.total_cmp(&a.doubt).then(differs)
            });
            let (mut sum, mut count) = (0.0, 0);
            for cell in &cells {
                if sum >= TOGETHER * doubt || cell.depth >= MOST || looked + 8 * count >= most {
                    break;
                }
                sum += cell.doubt;
                count += 1;
            }
            if count == 0 {
                break;
            }
            looked += 8 * count;
            let kept = cells.split_off(count);
            let parts: Vec<([f64; 10], Vec<CubatureCell>)> = cells
                .par_iter()
                .map_init(Vec::new, |room, cell| {
                    let mut own = [0.0; 10];
                    let next = eighths(&cell.sides).filter_map(|sides| {
                        examiner.cell(&cell.tape, sides, cell.depth + 1, room, &mut own)
                    });
                    let mut next: Vec<CubatureCell> = next.collect();
                    let now = own[0] + next.iter().map(|c| c.integrals[0]).sum::<f64>();
                    let difference = now - cell.integrals[0];
                    let mut differs = difference.abs().max(DOUBT * cell.doubt);
                    if cell.depth < LEAST {
                        differs = cell.doubt;
                    }
                    let of_all: f64 = next.len() as f64;
                    for c in &mut next {
                        c.doubt = (differs / of_all).min(c.doubt);
                        c.share = (difference / of_all).clamp(-c.doubt, c.doubt);
                    }
                    (own, next)
                })
                .collect();
            cells = kept;
            for (own, next) in parts {
                whole.iter_mut().zip(own).for_each(|(w, x)| *w += x);
                cells.extend(next);
            }
        }
        let doubt = doubt_of(&cells);
        let whole = Moments { about, terms: whole };
        Ok(Self { whole, cells, leaves: compiled.leaves, doubt })
    }

    /// The leaves that numbers of leaves mean.
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// The integrals.
    pub fn moments(&self) -> Moments<f64> {
        let mut terms = self.whole.terms;
        for cell in &self.cells {
            terms.iter_mut().zip(cell.integrals).for_each(|(s, x)| *s += x);
        }
        Moments { about: self.whole.about, terms }
    }

    /// The integrals, of the leaves as they are with derivatives; `primitive` gives these by number.
    pub fn moments_by<T: Real>(
        &self,
        primitive: &(dyn Fn(u32) -> Option<Primitive<T>> + Sync),
    ) -> Moments<T> {
        const CHUNK: usize = 256;
        let about = self.whole.about;
        let chunks: Vec<[T; 10]> = self
            .cells
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut sum = [T::zero(); 10];
                for cell in chunk {
                    let full = cell.sides.iter().map(|s| s.width()).product();
                    let own = match &cell.combination {
                        Some(c) if cell.depth >= LEAST => {
                            part(c, &cell.sides, about, full, primitive)
                        }
                        _ => cell.integrals.map(T::from),
                    };
                    sum.iter_mut().zip(own).for_each(|(s, x)| *s += x);
                }
                sum
            })
            .collect();
        let mut terms = self.whole.terms.map(T::from);
        for chunk in chunks {
            terms.iter_mut().zip(chunk).for_each(|(s, x)| *s += x);
        }
        Moments { about, terms }
    }
}
