//! Zebra line relaxation: the rows of a sheet in two colours, each row solved at once.
//!
//! Rows of one colour depend on rows of the other only, so a pass gives the same bits whatever the
//! number of threads. Four rows of a colour are solved together, a number of each in one register.

use moldloft_num::Real;
use rayon::prelude::*;

/// Rows that are solved together.
const LANES: usize = 4;

/// So many groups of rows make a task for a thread.
const GROUPS: usize = 4;

type Lanes<T> = [T; LANES];

/// Components of a sheet (those that vary) with its even rows apart from its odd ones.
#[derive(Clone)]
pub struct Rows<T> {
    pub m: usize,
    pub n: usize,
    /// Of each component the even rows and the odd rows.
    pub colours: [Vec<Vec<T>>; 2],
}

/// The terms of first derivatives, P and Q of the literature: `along` goes with the derivative along
/// a row, `across` with the one from row to row. Whole planes, row by row.
#[derive(Clone)]
pub struct Control<T> {
    pub along: Vec<T>,
    pub across: Vec<T>,
}

impl<T: Real> Rows<T> {
    /// The rows of planes of m by n numbers.
    pub fn of(m: usize, n: usize, planes: &[Vec<T>]) -> Self {
        let colour = |colour: usize, plane: &Vec<T>| -> Vec<T> {
            plane.chunks(n).skip(colour).step_by(2).flatten().copied().collect()
        };
        let colours = [0, 1].map(|c| planes.iter().map(|plane| colour(c, plane)).collect());
        Self { m, n, colours }
    }

    /// The planes.
    pub fn planes(&self) -> Vec<Vec<T>> {
        let n = self.n;
        let row = |c: usize, i: usize| &self.colours[i % 2][c][i / 2 * n..][..n];
        let plane = |c: usize| (0..self.m).flat_map(|i| row(c, i).iter().copied()).collect();
        (0..self.colours[0].len()).map(plane).collect()
    }

    /// Rows become columns.
    pub fn transposed(&self) -> Self {
        let (m, n) = (self.n, self.m);
        let colours = [0, 1].map(|colour| {
            let count = (m + 1 - colour) / 2;
            (0..self.colours[0].len())
                .map(|c| {
                    let mut plane = vec![T::zero(); count * n];
                    let chunk = 8;
                    plane.par_chunks_mut(chunk * n).enumerate().for_each(|(k, rows)| {
                        // A few rows at once, so that each cache line read serves all of them.
                        let height = rows.len() / n;
                        for i in 0..n {
                            let column = &self.colours[i % 2][c][i / 2 * self.n..][..self.n];
                            for r in 0..height {
                                rows[r * n + i] = column[2 * (k * chunk + r) + colour];
                            }
                        }
                    });
                    plane
                })
                .collect()
        });
        Self { m, n, colours }
    }
}

/// The same of control terms, whose two directions change places.
pub fn transposed_control<T: Real>(control: &Control<T>, m: usize, n: usize) -> Control<T> {
    let turn = |plane: &Vec<T>| (0..m * n).map(|k| plane[k % m * n + k / m]).collect();
    Control { along: turn(&control.across), across: turn(&control.along) }
}

/// The larger of two changes; NaN wins, so that divergence shows.
pub fn larger(most: Change, x: Change) -> Change {
    if x <= most { most } else { x }
}

/// What a pass has done: the square of the greatest step.
pub type Change = f64;

/// Solves all inner rows of one colour, over-relaxed by `omega`.
pub fn pass<T: Real>(
    rows: &mut Rows<T>,
    colour: usize,
    omega: f64,
    control: Option<&Control<T>>,
) -> Change {
    let (m, n) = (rows.m, rows.n);
    match (rows.colours[0].len(), control) {
        (2, None) => solve::<T, 2, false>(rows, colour, omega, None, m, n),
        (2, Some(_)) => solve::<T, 2, true>(rows, colour, omega, control, m, n),
        (_, None) => solve::<T, 3, false>(rows, colour, omega, None, m, n),
        (_, Some(_)) => solve::<T, 3, true>(rows, colour, omega, control, m, n),
    }
}

fn solve<T: Real, const C: usize, const CONTROLLED: bool>(
    rows: &mut Rows<T>,
    colour: usize,
    omega: f64,
    control: Option<&Control<T>>,
    m: usize,
    n: usize,
) -> Change {
    let [even, odd] = &mut rows.colours;
    let (own, other) = if colour == 0 { (even, &*odd) } else { (odd, &*even) };
    let arch = pulp::Arch::new();
    let task = LANES * GROUPS * n;
    let mut chunks: Vec<Vec<&mut [T]>> = Vec::new();
    for (c, plane) in own.iter_mut().enumerate() {
        for (k, chunk) in plane.chunks_mut(task).enumerate() {
            if c == 0 {
                chunks.push(Vec::with_capacity(C));
            }
            chunks[k].push(chunk);
        }
    }
    let work = |(k, chunk): (usize, &mut Vec<&mut [T]>)| -> Change {
        let mut store = vec![[[T::zero(); LANES]; 4]; n];
        let count = chunk[0].len() / n;
        let mut change: Change = 0.0;
        for first in (0..count).step_by(LANES) {
            let lanes = LANES.min(count - first);
            // Own row r of the chunk is row 2 (k LANES GROUPS + r) + colour of the sheet.
            let row = |r: usize| 2 * (k * LANES * GROUPS + r) + colour;
            let inner = |r: usize| row(r) > 0 && row(r) + 1 < m;
            let Some(some) = (first..first + lanes).find(|&r| inner(r)) else { continue };
            // Lanes without a row of their own repeat another's work.
            let taken: [usize; LANES] = std::array::from_fn(|l| {
                let r = first + l;
                if l < lanes && inner(r) { r } else { some }
            });
            let group = Group::<T, C> {
                n,
                own: std::array::from_fn(|c| taken.map(|r| &chunk[c][r * n..][..n])),
                above: std::array::from_fn(|c| {
                    taken.map(|r| &other[c][row(r).div_ceil(2) * n..][..n])
                }),
                below: std::array::from_fn(|c| {
                    taken.map(|r| &other[c][(row(r) - 1) / 2 * n..][..n])
                }),
                in_turn: (1..LANES).all(|l| taken[l] == taken[l - 1] + 1),
                control: control.filter(|_| CONTROLLED).map(|control| {
                    taken.map(|r| {
                        [&control.along[row(r) * n..][..n], &control.across[row(r) * n..][..n]]
                    })
                }),
            };
            arch.dispatch(Eliminate::<T, C, CONTROLLED> { group: &group, store: &mut store });
            if taken == std::array::from_fn(|l| first + l) {
                let rows = chunk.iter_mut().map(|plane| four(&mut plane[first * n..], n));
                let rows: Vec<[&mut [T]; LANES]> = rows.collect();
                let moved = arch.dispatch(Substitute::<T, C> { rows, store: &store, n, omega });
                change = larger(change, moved);
                continue;
            }
            for l in 0..LANES {
                // A repeated row is written once.
                if !taken[..l].contains(&taken[l]) {
                    let moved = substitute::<T, C>(chunk, taken[l] * n, n, &store, l, omega);
                    change = larger(change, moved);
                }
            }
        }
        change
    };
    let changes: Vec<Change> = chunks.par_iter_mut().enumerate().map(work).collect();
    changes.into_iter().fold(0.0, larger)
}

/// The first four rows of `n`.
fn four<T>(plane: &mut [T], n: usize) -> [&mut [T]; LANES] {
    let (a, rest) = plane.split_at_mut(n);
    let (b, rest) = rest.split_at_mut(n);
    let (c, rest) = rest.split_at_mut(n);
    [a, b, c, &mut rest[..n]]
}

/// Loops that are compiled for the widest registers at hand. They are structs because closures need
/// not be inlined, and what is not inlined keeps the narrow ones.
struct Eliminate<'a, 'b, T, const C: usize, const CONTROLLED: bool> {
    group: &'b Group<'a, T, C>,
    store: &'b mut [[Lanes<T>; 4]],
}

impl<T: Real, const C: usize, const CONTROLLED: bool> pulp::NullaryFnOnce
    for Eliminate<'_, '_, T, C, CONTROLLED>
{
    type Output = ();
    #[inline(always)]
    fn call(self) {
        match self.group.in_turn {
            true => self.group.eliminate::<CONTROLLED, true>(self.store),
            false => self.group.eliminate::<CONTROLLED, false>(self.store),
        }
    }
}

/// Back substitution of four rows, of each component.
struct Substitute<'a, 'b, T, const C: usize> {
    rows: Vec<[&'a mut [T]; LANES]>,
    store: &'b [[Lanes<T>; 4]],
    n: usize,
    omega: f64,
}

impl<T: Real, const C: usize> pulp::NullaryFnOnce for Substitute<'_, '_, T, C> {
    type Output = Change;
    #[inline(always)]
    fn call(self) -> Change {
        let Self { mut rows, store, n, omega } = self;
        let store = &store[..n];
        for lanes in &mut rows {
            for row in lanes {
                *row = &mut std::mem::take(row)[..n];
            }
        }
        let mut x: [Lanes<T>; C] =
            std::array::from_fn(|c| std::array::from_fn(|l| rows[c][l][n - 1]));
        let mut most = [0.0; LANES];
        for j in (1..n - 1).rev() {
            let [factor, right @ ..] = &store[j];
            let mut square = [0.0; LANES];
            for c in 0..C {
                let row = &mut rows[c];
                for l in 0..LANES {
                    x[c][l] = right[c][l] - factor[l] * x[c][l];
                    let old = row[l][j];
                    let step = (x[c][l] - old) * omega;
                    square[l] += step.re() * step.re();
                    row[l][j] = old + step;
                }
            }
            for l in 0..LANES {
                most[l] = larger(most[l], square[l]);
            }
        }
        most.into_iter().fold(0.0, larger)
    }
}

/// Four rows with the rows beside them.
struct Group<'a, T, const C: usize> {
    n: usize,
    own: [[&'a [T]; LANES]; C],
    above: [[&'a [T]; LANES]; C],
    below: [[&'a [T]; LANES]; C],
    /// True when the row below each lane but the first is the one above the lane before it.
    in_turn: bool,
    control: Option<[[&'a [T]; 2]; LANES]>,
}

#[inline(always)]
fn gather<T: Real>(rows: &[&[T]; LANES], j: usize) -> Lanes<T> {
    [rows[0][j], rows[1][j], rows[2][j], rows[3][j]]
}

#[inline(always)]
fn cut<'a, T, const C: usize>(rows: &[[&'a [T]; LANES]; C], n: usize) -> [[&'a [T]; LANES]; C] {
    rows.map(|lanes| lanes.map(|row| &row[..n]))
}

#[inline(always)]
fn zip<T: Real>(a: Lanes<T>, b: Lanes<T>, f: impl Fn(T, T) -> T) -> Lanes<T> {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])]
}

impl<T: Real, const C: usize> Group<'_, T, C> {
    /// Forward elimination along the rows: afterwards x_j = store[j][1..] - store[j][0] x_(j+1).
    ///
    /// With A, B, G four times alpha, beta and gamma, from central differences, the equation is
    /// G (1 - q/2) x_(j-1) - 2 (A + G) x_j + G (1 + q/2) x_(j+1)
    /// = -A (U + D + p/2 (U - D)) + B X / 2, with U and D the points above and below, X four times
    /// the mixed difference, p and q the control terms across and along.
    #[inline(always)]
    fn eliminate<const CONTROLLED: bool, const IN_TURN: bool>(&self, store: &mut [[Lanes<T>; 4]]) {
        let n = self.n;
        // Lengths that the compiler sees, so that the loop needs no checks.
        let (own, above, below) = (cut(&self.own, n), cut(&self.above, n), cut(&self.below, n));
        let store = &mut store[..n];
        let load = |rows: &[[&[T]; LANES]; C], j: usize| -> [Lanes<T>; C] {
            std::array::from_fn(|c| gather(&rows[c], j))
        };
        // Rows in turn share the rows between them: one number is read instead of four.
        let load_below = |up: &[Lanes<T>; C], j: usize| -> [Lanes<T>; C] {
            match IN_TURN {
                true => std::array::from_fn(|c| [below[c][0][j], up[c][0], up[c][1], up[c][2]]),
                false => load(&below, j),
            }
        };
        let (mut before, mut here) = (load(&own, 0), load(&own, 1));
        let (mut up_before, mut up) = (load(&above, 0), load(&above, 1));
        let (mut down_before, mut down) = (load_below(&up_before, 0), load_below(&up, 1));
        store[0][0] = [T::zero(); LANES];
        store[0][1..=C].copy_from_slice(&before[..C]);
        for j in 1..n - 1 {
            let after = load(&own, j + 1);
            let up_after = load(&above, j + 1);
            let down_after = load_below(&up_after, j + 1);
            let zero = [T::zero(); LANES];
            let (mut a, mut b, mut g) = (zero, zero, zero);
            let mut mixed = [zero; C];
            for c in 0..C {
                let along = zip(after[c], before[c], |x, y| x - y);
                let across = zip(up[c], down[c], |x, y| x - y);
                let outer = zip(up_after[c], up_before[c], |x, y| x - y);
                let inner = zip(down_after[c], down_before[c], |x, y| x - y);
                mixed[c] = zip(outer, inner, |x, y| (x - y) * 0.5);
                for l in 0..LANES {
                    a[l] += along[l] * along[l];
                    b[l] += along[l] * across[l];
                    g[l] += across[l] * across[l];
                }
            }
            let (mut low, mut high) = (g, g);
            let mut lean = zero;
            if CONTROLLED && let Some(control) = &self.control {
                for l in 0..LANES {
                    let shift = g[l] * control[l][0][j] * 0.5;
                    low[l] = g[l] - shift;
                    high[l] = g[l] + shift;
                    lean[l] = control[l][1][j] * 0.5;
                }
            }
            let last = store[j - 1];
            let (mut pivot, mut stuck) = (zero, false);
            for l in 0..LANES {
                let whole = -((a[l] + g[l]) * 2.0 + low[l] * last[0][l]);
                stuck |= whole.re() == 0.0;
                pivot[l] = T::one() / whole;
            }
            if stuck {
                self.hold(&mut pivot, [&a, &g, &low], &last[0]);
            }
            let next = &mut store[j];
            for l in 0..LANES {
                next[0][l] = high[l] * pivot[l];
            }
            for c in 0..C {
                for l in 0..LANES {
                    let mut sum = up[c][l] + down[c][l];
                    if CONTROLLED {
                        sum += lean[l] * (up[c][l] - down[c][l]);
                    }
                    let right = b[l] * mixed[c][l] - a[l] * sum;
                    next[1 + c][l] = (right - low[l] * last[1 + c][l]) * pivot[l];
                }
            }
            if stuck {
                for l in 0..LANES {
                    if pivot[l].re() == 0.0 {
                        for c in 0..C {
                            next[1 + c][l] = here[c][l];
                        }
                    }
                }
            }
            (before, here) = (here, after);
            (up_before, up) = (up, up_after);
            (down_before, down) = (down, down_after);
        }
    }
}

impl<T: Real, const C: usize> Group<'_, T, C> {
    /// Points whose neighbours coincide have no equation: a pivot of 0 marks them, and they stay.
    #[cold]
    fn hold(&self, pivot: &mut Lanes<T>, [a, g, low]: [&Lanes<T>; 3], last: &Lanes<T>) {
        for l in 0..LANES {
            if ((a[l] + g[l]) * 2.0 + low[l] * last[l]).re() == 0.0 {
                pivot[l] = T::zero();
            }
        }
    }
}

/// Back substitution of one row, which starts at `start` of each component; the square of the
/// greatest step.
#[inline(always)]
fn substitute<T: Real, const C: usize>(
    chunk: &mut [&mut [T]],
    start: usize,
    n: usize,
    store: &[[Lanes<T>; 4]],
    lane: usize,
    omega: f64,
) -> Change {
    let mut x: [T; C] = std::array::from_fn(|c| chunk[c][start + n - 1]);
    let mut most: Change = 0.0;
    for j in (1..n - 1).rev() {
        let factor = store[j][0][lane];
        let mut square = 0.0;
        for c in 0..C {
            x[c] = store[j][1 + c][lane] - factor * x[c];
            let old = chunk[c][start + j];
            let step = (x[c] - old) * omega;
            square += step.re() * step.re();
            chunk[c][start + j] = old + step;
        }
        most = larger(most, square);
    }
    most
}
