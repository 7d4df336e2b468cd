//! Zebra line relaxation: the rows of a grid in two colours, each row solved at once.
//!
//! Rows of one colour depend on rows of the other only, so a pass gives the same bits for any
//! number of threads. The rows of a colour are stored in banks of interleaved rows, so that a bank
//! is solved like one row: number l of a pack belongs to row l of the bank.

use crate::lines::{Change, larger};
use moldloft_num::Real;
use moldloft_parallel::prelude::*;

/// Banks that make a task for a thread, so that both threads of a small machine have several of a grid of
/// 500 rows.
const BANKS_PER_TASK: usize = 2;

type Pack<T, const L: usize> = [T; L];

/// Components of a grid in banks of `L` rows.
#[derive(Clone)]
pub struct Banks<T, const L: usize> {
    pub m: usize,
    pub n: usize,
    /// The even rows and the odd ones of each component: row 2 (b L + l) + colour is lane l of the
    /// packs b n .. (b + 1) n. Lanes behind the last row repeat it.
    colours: [Vec<Vec<Pack<T, L>>>; 2],
    /// Memory of the banks before rows became columns, for the next time.
    spare: [Vec<Vec<Pack<T, L>>>; 2],
}

impl<T: Real, const L: usize> Banks<T, L> {
    /// Banks of a colour of `m` rows.
    fn count(m: usize, colour: usize) -> usize {
        ((m + 1 - colour) / 2).div_ceil(L)
    }

    /// The banks of planes of m by n numbers.
    pub fn of(m: usize, n: usize, planes: &[Vec<T>]) -> Self {
        let colours = [0, 1].map(|colour| {
            let bank = |plane: &Vec<T>| -> Vec<Pack<T, L>> {
                let mut packs = vec![[T::zero(); L]; Self::count(m, colour) * n];
                for (k, pack) in packs.iter_mut().enumerate() {
                    for (l, x) in pack.iter_mut().enumerate() {
                        let row = (2 * (k / n * L + l) + colour).min(m - 1);
                        *x = plane[row * n + k % n];
                    }
                }
                packs
            };
            planes.iter().map(bank).collect()
        });
        Self { m, n, colours, spare: [Vec::new(), Vec::new()] }
    }

    /// The planes.
    pub fn planes(&self) -> Vec<Vec<T>> {
        let n = self.n;
        let plane = |c: usize| (0..self.m * n).map(|k| self.at(c, k / n, k % n)).collect();
        (0..self.colours[0].len()).map(plane).collect()
    }

    /// Number (i, j) of a component.
    pub fn at(&self, component: usize, i: usize, j: usize) -> T {
        self.colours[i % 2][component][i / 2 / L * self.n + j][i / 2 % L]
    }

    /// Replaces number (i, j) of a component.
    pub fn set(&mut self, component: usize, i: usize, j: usize, x: T) {
        self.colours[i % 2][component][i / 2 / L * self.n + j][i / 2 % L] = x;
    }

    /// Rows become columns.
    pub fn transpose(&mut self) {
        let (m, n, old) = (self.n, self.m, self.n);
        let mut turned = std::mem::take(&mut self.spare);
        for (colour, planes) in turned.iter_mut().enumerate() {
            planes.resize_with(self.colours[0].len(), Vec::new);
            for (c, packs) in planes.iter_mut().enumerate() {
                packs.resize(Self::count(m, colour) * n, [T::zero(); L]);
                packs.par_chunks_mut(n).enumerate().for_each(|(b, bank)| {
                    // Lane l is filled from column `column[l]`, in blocks of L by L.
                    let column: [usize; L] =
                        std::array::from_fn(|l| (2 * (b * L + l) + colour).min(m - 1));
                    for (own, all) in self.colours.iter().enumerate() {
                        for (k, rows) in all[c].chunks_exact(old).enumerate() {
                            let block: [&Pack<T, L>; L] = column.map(|j| &rows[j]);
                            for l in 0..L {
                                let i = 2 * (k * L + l) + own;
                                if i < n {
                                    bank[i] = std::array::from_fn(|k| block[k][l]);
                                }
                            }
                        }
                    }
                });
            }
        }
        self.spare = std::mem::replace(&mut self.colours, turned);
        (self.m, self.n) = (m, n);
    }

    /// Solves all inner rows of one colour, over-relaxed by `omega`; control terms are banks of those
    /// along and across.
    pub fn pass(&mut self, colour: usize, omega: f64, control: Option<&Self>) -> Change {
        match (self.colours[0].len(), control) {
            (2, None) => self.solve::<2, false>(colour, omega, None),
            (2, Some(_)) => self.solve::<2, true>(colour, omega, control),
            (_, None) => self.solve::<3, false>(colour, omega, None),
            (_, Some(_)) => self.solve::<3, true>(colour, omega, control),
        }
    }

    fn solve<const C: usize, const CONTROLLED: bool>(
        &mut self,
        colour: usize,
        omega: f64,
        control: Option<&Self>,
    ) -> Change {
        let (m, n) = (self.m, self.n);
        let [even, odd] = &mut self.colours;
        let (own, other) = if colour == 0 { (even, &*odd) } else { (odd, &*even) };
        let task = BANKS_PER_TASK * n;
        let mut tasks: Vec<Vec<&mut [Pack<T, L>]>> = Vec::new();
        for (c, plane) in own.iter_mut().enumerate() {
            for (k, part) in plane.chunks_mut(task).enumerate() {
                if c == 0 {
                    tasks.push(Vec::with_capacity(C));
                }
                tasks[k].push(part);
            }
        }
        let arch = pulp::Arch::new();
        type Held<T, const L: usize, const C: usize> = (Vec<Pack<T, L>>, Vec<[Pack<T, L>; C]>);
        let held = || -> Held<T, L, C> { (vec![[T::zero(); L]; n], vec![[[T::zero(); L]; C]; n]) };
        let work = |(factors, rights): &mut Held<T, L, C>,
                    (k, part): (usize, &mut Vec<&mut [Pack<T, L>]>)|
         -> Change {
            let mut change: Change = 0.0;
            for inside in 0..part[0].len() / n {
                let b = k * BANKS_PER_TASK + inside;
                let row = |l: usize| 2 * (b * L + l) + colour;
                let free: [bool; L] = std::array::from_fn(|l| row(l) > 0 && row(l) + 1 < m);
                let bank = |c: usize, b: usize| other[c].get(b * n..(b + 1) * n);
                // The row on one side of a lane is the same lane of the other colour's bank, the
                // one on the other side the lane before or after it; for the outermost lane it is
                // in the bank before or after. Rows at the border have no such neighbour, and are
                // not moved.
                let beside = if colour == 0 { b.checked_sub(1) } else { Some(b + 1) };
                let mut parts =
                    part.iter_mut().map(|plane| &mut plane[inside * n..(inside + 1) * n]);
                let bank = Bank::<T, L, C> {
                    n,
                    odd: colour == 1,
                    own: std::array::from_fn(|_| parts.next().expect("a plane per component")),
                    facing: std::array::from_fn(|c| {
                        bank(c, b).or_else(|| bank(c, b - 1)).expect("colours alternate")
                    }),
                    beside: std::array::from_fn(|c| {
                        let found = beside.and_then(|b| bank(c, b));
                        found.or_else(|| bank(c, b)).or_else(|| bank(c, b - 1)).expect("as above")
                    }),
                    control: control.filter(|_| CONTROLLED).map(|control| {
                        let of = |c: usize| &control.colours[colour][c][b * n..(b + 1) * n];
                        [of(0), of(1)]
                    }),
                    free,
                    omega,
                };
                let moved =
                    arch.dispatch(ZebraSolve::<T, L, C, CONTROLLED> { bank, factors, rights });
                change = larger(change, moved);
            }
            change
        };
        let changes: Vec<Change> = tasks.par_iter_mut().enumerate().map_init(held, work).collect();
        changes.into_iter().fold(0.0, larger)
    }
}

/// A bank with the rows beside its own.
struct Bank<'a, T, const L: usize, const C: usize> {
    n: usize,
    /// True for the odd rows, whose lanes have the row after them in the next lane.
    odd: bool,
    own: [&'a mut [Pack<T, L>]; C],
    facing: [&'a [Pack<T, L>]; C],
    beside: [&'a [Pack<T, L>]; C],
    control: Option<[&'a [Pack<T, L>]; 2]>,
    free: [bool; L],
    omega: f64,
}

/// A loop compiled for the widest available registers. A struct, because code in closures that are
/// not inlined uses the narrow ones.
struct ZebraSolve<'a, 'b, T, const L: usize, const C: usize, const CONTROLLED: bool> {
    bank: Bank<'a, T, L, C>,
    factors: &'b mut [Pack<T, L>],
    rights: &'b mut [[Pack<T, L>; C]],
}

impl<T: Real, const L: usize, const C: usize, const CONTROLLED: bool> pulp::NullaryFnOnce
    for ZebraSolve<'_, '_, T, L, C, CONTROLLED>
{
    type Output = Change;
    #[inline(always)]
    fn call(self) -> Change {
        let Self { mut bank, factors, rights } = self;
        match bank.odd {
            true => bank.eliminate::<CONTROLLED, true>(factors, rights),
            false => bank.eliminate::<CONTROLLED, false>(factors, rights),
        }
        bank.substitute(factors, rights)
    }
}

#[inline(always)]
fn zip<T: Real, const L: usize>(
    a: &Pack<T, L>,
    b: &Pack<T, L>,
    f: impl Fn(T, T) -> T,
) -> Pack<T, L> {
    let mut out = *a;
    for l in 0..L {
        out[l] = f(a[l], b[l]);
    }
    out
}

impl<T: Real, const L: usize, const C: usize> Bank<'_, T, L, C> {
    /// Forward elimination along the rows: afterwards x_j = right_j - factor_j x_(j+1).
    ///
    /// With A, B, G four times alpha, beta and gamma, from central differences, the equation is
    /// G (1 - q/2) x_(j-1) - 2 (A + G) x_j + G (1 + q/2) x_(j+1)
    /// = -A (U + D + p/2 (U - D)) + B X / 2, with U and D the points above and below, X four times
    /// the mixed difference, p and q the control terms across and along.
    #[inline(always)]
    fn eliminate<const CONTROLLED: bool, const ODD: bool>(
        &self,
        factors: &mut [Pack<T, L>],
        rights: &mut [[Pack<T, L>; C]],
    ) {
        let n = self.n;
        // Lengths that the compiler sees, so that the loop needs no checks.
        let (factors, rights) = (&mut factors[..n], &mut rights[..n]);
        let mut own: [&[Pack<T, L>]; C] = self.facing;
        let (mut facing, mut beside) = (self.facing, self.beside);
        for c in 0..C {
            own[c] = &self.own[c][..n];
            facing[c] = &facing[c][..n];
            beside[c] = &beside[c][..n];
        }
        let zero = [T::zero(); L];
        let load = |j: usize| sides::<T, L, C, ODD>(&facing, &beside, j);
        let mut before = [zero; C];
        let mut here = [zero; C];
        for c in 0..C {
            (before[c], here[c]) = (own[c][0], own[c][1]);
        }
        let ([mut up_before, mut down_before], [mut up, mut down]) = (load(0), load(1));
        factors[0] = zero;
        rights[0] = before;
        for j in 1..n - 1 {
            let [up_after, down_after] = load(j + 1);
            let mut after = [zero; C];
            let (mut a, mut b, mut g) = (zero, zero, zero);
            let mut mixed = [zero; C];
            for c in 0..C {
                after[c] = own[c][j + 1];
                let along = zip(&after[c], &before[c], |x, y| x - y);
                let across = zip(&up[c], &down[c], |x, y| x - y);
                let outer = zip(&up_after[c], &up_before[c], |x, y| x - y);
                let inner = zip(&down_after[c], &down_before[c], |x, y| x - y);
                mixed[c] = zip(&outer, &inner, |x, y| (x - y) * 0.5);
                for l in 0..L {
                    a[l] += along[l] * along[l];
                    b[l] += along[l] * across[l];
                    g[l] += across[l] * across[l];
                }
            }
            let (mut low, mut high) = (g, g);
            let mut lean = zero;
            if CONTROLLED && let Some([along, across]) = &self.control {
                for l in 0..L {
                    let shift = g[l] * along[j][l] * 0.5;
                    low[l] = g[l] - shift;
                    high[l] = g[l] + shift;
                    lean[l] = across[j][l] * 0.5;
                }
            }
            let (factor, right) = (factors[j - 1], rights[j - 1]);
            let (mut pivot, mut stuck) = (zero, false);
            for l in 0..L {
                let whole = -((a[l] + g[l]) * 2.0 + low[l] * factor[l]);
                stuck |= whole.re() == 0.0;
                pivot[l] = T::one() / whole;
            }
            if stuck {
                hold(&mut pivot, [&a, &g, &low], &factor);
            }
            for l in 0..L {
                factors[j][l] = high[l] * pivot[l];
            }
            for c in 0..C {
                for l in 0..L {
                    let mut sum = up[c][l] + down[c][l];
                    if CONTROLLED {
                        sum += lean[l] * (up[c][l] - down[c][l]);
                    }
                    let whole = b[l] * mixed[c][l] - a[l] * sum;
                    rights[j][c][l] = (whole - low[l] * right[c][l]) * pivot[l];
                }
            }
            if stuck {
                for l in 0..L {
                    if pivot[l].re() == 0.0 {
                        for c in 0..C {
                            rights[j][c][l] = here[c][l];
                        }
                    }
                }
            }
            (before, here) = (here, after);
            (up_before, up) = (up, up_after);
            (down_before, down) = (down, down_after);
        }
    }

    /// Back substitution; the square of the greatest step.
    #[inline(always)]
    fn substitute(&mut self, factors: &[Pack<T, L>], rights: &[[Pack<T, L>; C]]) -> Change {
        let n = self.n;
        let (factors, rights) = (&factors[..n], &rights[..n]);
        let mut x = [[T::zero(); L]; C];
        for c in 0..C {
            self.own[c] = &mut std::mem::take(&mut self.own[c])[..n];
            x[c] = self.own[c][n - 1];
        }
        let all = self.free == [true; L];
        let mut most = [0.0; L];
        for j in (1..n - 1).rev() {
            let factor = factors[j];
            let mut square = [0.0; L];
            for c in 0..C {
                let mut row = self.own[c][j];
                let mut steps = [T::zero(); L];
                for l in 0..L {
                    x[c][l] = rights[j][c][l] - factor[l] * x[c][l];
                    steps[l] = (x[c][l] - row[l]) * self.omega;
                }
                if !all {
                    for l in 0..L {
                        if !self.free[l] {
                            steps[l] = T::zero();
                        }
                    }
                }
                for l in 0..L {
                    square[l] += steps[l].re() * steps[l].re();
                    row[l] += steps[l];
                }
                self.own[c][j] = row;
            }
            for l in 0..L {
                most[l] = larger(most[l], square[l]);
            }
        }
        most.into_iter().fold(0.0, larger)
    }
}

/// The points after and before those of a bank's rows, at index `j`.
#[inline(always)]
fn sides<T: Real, const L: usize, const C: usize, const ODD: bool>(
    facing: &[&[Pack<T, L>]; C],
    beside: &[&[Pack<T, L>]; C],
    j: usize,
) -> [[Pack<T, L>; C]; 2] {
    let (mut up, mut down) = ([[T::zero(); L]; C], [[T::zero(); L]; C]);
    for c in 0..C {
        let (same, next) = (facing[c][j], beside[c][j]);
        let mut moved = same;
        for l in 1..L {
            match ODD {
                true => moved[l - 1] = same[l],
                false => moved[l] = same[l - 1],
            }
        }
        match ODD {
            true => moved[L - 1] = next[0],
            false => moved[0] = next[L - 1],
        }
        (up[c], down[c]) = if ODD { (moved, same) } else { (same, moved) };
    }
    [up, down]
}

/// Points whose neighbours coincide have no equation: a pivot of 0 marks them, and they stay.
#[cold]
fn hold<T: Real, const L: usize>(
    pivot: &mut Pack<T, L>,
    [a, g, low]: [&Pack<T, L>; 3],
    last: &Pack<T, L>,
) {
    for l in 0..L {
        if ((a[l] + g[l]) * 2.0 + low[l] * last[l]).re() == 0.0 {
            pivot[l] = T::zero();
        }
    }
}
