//! An interior point method for measures of sparse rows under bounds on sparse rows.
//!
//! minimise   sum of psi(e_k + P_k x)        psi(e) = |e|^2 / 2 or |e|
//! subject to |Q_k x| <= r_k,  A x = b,  C x <= d
//!
//! over the displacement x of the control points, D coordinates each. Both kinds of rows couple
//! few neighbours, so each Newton step factors one band matrix: O(n) time and memory for curves.
//!
//! Limits and lengths are second-order cones, (r, Q x) and (t, e), with Nesterov and Todd's
//! scaling and Mehrotra's two-step directions (Vandenberghe 2010, "The CVXOPT linear and quadratic
//! cone program solvers"); the lengths' own unknowns t are eliminated row by row. Half-spaces C x <= d
//! are kept with slacks of their own, which may begin outside.

use crate::optimum::held::HeldDirections;
use crate::optimum::interior_point::{self, InteriorPointState};
use crate::optimum::second_order_cone::Pair;
use crate::{FairError, RowNorm, SparseRows};
use moldloft_num::Real;

/// One coordinate triple; only those of the problem's dimension are used.
pub(crate) type V = [f64; 3];

/// A limit |o_k + Q_k x| <= radius, of all coordinates together or of each separately.
pub(crate) struct NormBounds {
    pub rows: SparseRows,
    /// Each row is a single point, each point has at most one row.
    pub direct: bool,
    pub radii: Vec<f64>,
    /// Offsets of the rows, shorter than their radii; zero when empty.
    pub offsets: Vec<V>,
    /// True to limit each coordinate separately.
    pub separate: bool,
}

impl NormBounds {
    /// No limits.
    pub fn none() -> Self {
        let (rows, radii, offsets) = (SparseRows::new(), Vec::new(), Vec::new());
        Self { rows, direct: true, radii, offsets, separate: false }
    }

    /// Offset of row `k`.
    pub fn offset(&self, k: usize) -> V {
        self.offsets.get(k).copied().unwrap_or_default()
    }
}

/// One linear condition: the sum of factor . x[point] equals `value`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EqualityConstraint {
    pub entries: Vec<(usize, V)>,
    pub value: f64,
}

/// A half-space: the sum of factor . x[point] is at most `room`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct InequalityConstraint {
    pub entries: Vec<(usize, V)>,
    pub room: f64,
    /// Its variation when points move by their tolerances.
    pub scale: f64,
}

/// A problem in the coordinates of its own frame.
pub(crate) struct Problem {
    /// Coordinates in use, 0 to 3.
    pub dimension: usize,
    /// SparseRows of the measure over points.
    pub measure: SparseRows,
    pub norm: RowNorm,
    /// SparseRows times the original points.
    pub offsets: Vec<V>,
    pub bounds: NormBounds,
    /// Points that do not move.
    pub frozen: Vec<bool>,
    /// Directions in which points do not move; factors of conditions and half-spaces have none there.
    pub held: HeldDirections,
    pub conditions: Vec<EqualityConstraint>,
    /// True to meet the conditions to rounding: those of data on the curve, which do not depend on each other.
    pub refined: bool,
    pub halves: Vec<InequalityConstraint>,
    /// Rows with their values at no displacement (none when empty), the sum of whose squares is at most a
    /// number.
    pub squares: Option<(SparseRows, Vec<V>, f64)>,
    /// By how much each point can move at most, for the certificate.
    pub reach: Vec<f64>,
    /// Start of the search, strictly inside the bounds; no displacement when empty.
    pub begin: Vec<V>,
}

/// A solution with the certificate's parts.
#[derive(Clone)]
pub(crate) struct CertifiedSolution {
    /// Displacements, zero for frozen points.
    pub x: Vec<V>,
    /// psi's sum.
    pub value: f64,
    /// A bound on the optimality gap.
    pub gap: f64,
    pub iterations: usize,
    /// Largest miss of a condition, relative to its own scale, and which ones are missed.
    pub misses: Vec<f64>,
    /// By how much each half-space is left, relative to its own scale.
    pub outside: Vec<f64>,
    /// True for half-spaces that are reached: they resist more than the measure does.
    pub pressed: Vec<bool>,
    /// Slacks and duals at the solution, for [`respond`].
    pub cones: Vec<(Pair<3>, Pair<3>)>,
    /// The multipliers of the conditions.
    pub nu: Vec<f64>,
    /// The limits that are reached and their forces, when the solution was polished.
    pub active: Option<Active>,
    /// The weight of the squares beside the measure that gives the same solution as their bound.
    pub weight: f64,
}

/// The limits that are reached, and how hard they push.
#[derive(Clone, Debug, Default)]
pub(crate) struct Active {
    /// Cones, ascending.
    pub cones: Vec<u32>,
    /// The force at each.
    pub forces: Vec<f64>,
}

/// The place of a point that is not an unknown.
pub(crate) const NONE: u32 = u32::MAX;

/// The unknown of each point.
pub(crate) struct UnknownOrder {
    /// Unknown number of each point, or [`NONE`].
    pub place: Vec<u32>,
    pub unknowns: usize,
    /// The largest distance of two unknowns in a row.
    pub span: usize,
}

impl UnknownOrder {
    pub fn of(p: &Problem) -> Self {
        if p.dimension == 0 {
            return Self { place: vec![NONE; p.frozen.len()], unknowns: 0, span: 0 };
        }
        let (place, unknowns, span) = order(p);
        Self { place, unknowns, span }
    }
}

/// An order of the unknowns with a narrow band: the original one, or that of a breadth-first search
/// from a point at the rim (Cuthill and McKee 1969), whichever is narrower.
fn order(p: &Problem) -> (Vec<u32>, usize, usize) {
    let n = p.frozen.len();
    let natural: Vec<u32> = {
        let mut next = 0;
        (0..n)
            .map(|i| {
                if p.frozen[i] {
                    NONE
                } else {
                    next += 1;
                    next - 1
                }
            })
            .collect()
    };
    let unknowns = natural.iter().filter(|&&i| i != NONE).count();
    let span = |place: &[u32]| {
        let of = |rows: &SparseRows| {
            (0..rows.len())
                .map(|k| {
                    let used = || {
                        let all = rows.row(k).0.iter().map(|&c| place[c as usize]);
                        all.filter(|&i| i != NONE)
                    };
                    match (used().max(), used().min()) {
                        (Some(a), Some(b)) => (a - b) as usize,
                        _ => 0,
                    }
                })
                .max()
                .unwrap_or(0)
        };
        let half = |h: &InequalityConstraint| {
            let used = || h.entries.iter().map(|(i, _)| place[*i]).filter(|&i| i != NONE);
            match (used().max(), used().min()) {
                (Some(a), Some(b)) => (a - b) as usize,
                _ => 0,
            }
        };
        let halves = p.halves.iter().map(half).max().unwrap_or(0);
        let squares = p.squares.as_ref().map_or(0, |s| of(&s.0));
        of(&p.measure).max(of(&p.bounds.rows)).max(halves).max(squares)
    };
    let wide = span(&natural);
    if wide <= 32 || unknowns < 3 {
        return (natural, unknowns, wide);
    }
    // Neighbours through shared rows.
    let lists = [p.measure.transposed(n), p.bounds.rows.transposed(n)];
    let neighbours = |i: usize| {
        let mut all: Vec<u32> = Vec::new();
        for (list, rows) in lists.iter().zip([&p.measure, &p.bounds.rows]) {
            for &k in list.row(i).0 {
                all.extend(rows.row(k as usize).0.iter().filter(|&&c| natural[c as usize] != NONE));
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    };
    let search = |start: usize, place: &mut Vec<u32>, next: &mut u32| {
        let mut queue = std::collections::VecDeque::from([start as u32]);
        let mut last = start;
        place[start] = *next;
        *next += 1;
        while let Some(i) = queue.pop_front() {
            last = i as usize;
            for j in neighbours(i as usize) {
                if place[j as usize] == NONE {
                    place[j as usize] = *next;
                    *next += 1;
                    queue.push_back(j);
                }
            }
        }
        last
    };
    let mut place = vec![NONE; n];
    let mut next = 0;
    for i in 0..n {
        if natural[i] != NONE && place[i] == NONE {
            // From a point far from the first: the ends of what is connected.
            let mut trial = place.clone();
            let far = search(i, &mut trial, &mut next.clone());
            search(far, &mut place, &mut next);
        }
    }
    let narrow = span(&place);
    if narrow < wide { (place, unknowns, narrow) } else { (natural, unknowns, wide) }
}

/// Solves a problem until the certified gap is at most `accuracy` times the value, or `floor`.
/// Limits are kept with a `margin` for the rounding of positions. `before` is the solution of a problem
/// that differs little, if there is one: where it shows which limits are reached it is quicker.
pub(crate) fn solve(
    p: &Problem,
    accuracy: f64,
    floor: f64,
    margin: f64,
    before: Option<&CertifiedSolution>,
) -> Result<CertifiedSolution, FairError> {
    let order = UnknownOrder::of(p);
    macro_rules! of_dimension {
        ($d:literal) => {{
            let state = InteriorPointState::<$d>::new(p, order);
            interior_point::solve(state, accuracy, floor, margin, before)
        }};
    }
    match p.dimension {
        0 | 1 => of_dimension!(1),
        2 => of_dimension!(2),
        _ => of_dimension!(3),
    }
}

/// How the displacements answer to small changes of the offsets (per measure row), the radii (per
/// limit) and the values of the conditions, and to small forces on the points (`pushes`, none when empty,
/// against the slope of the measure): the implicit function theorem at the solution, where
/// each cone resists with its stiffness. The changes are numbers with a zero real part.
///
/// # Errors
/// [`FairError::TooLarge`].
pub(crate) fn respond<T: Real>(
    p: &Problem,
    solution: &CertifiedSolution,
    offsets: &[[T; 3]],
    radii: &[T],
    values: &[T],
    pushes: &[[T; 3]],
) -> Result<Vec<[T; 3]>, FairError> {
    let order = UnknownOrder::of(p);
    match p.dimension {
        0 | 1 => {
            InteriorPointState::<1>::new(p, order).respond(solution, offsets, radii, values, pushes)
        }
        2 => {
            InteriorPointState::<2>::new(p, order).respond(solution, offsets, radii, values, pushes)
        }
        _ => {
            InteriorPointState::<3>::new(p, order).respond(solution, offsets, radii, values, pushes)
        }
    }
}
