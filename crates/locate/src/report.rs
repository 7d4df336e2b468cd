//! Solutions of searches with reports, and reasons of failures.

use moldloft_num::Vec3;
use moldloft_num::period::parameter_distance;
use smallvec::SmallVec;
use std::fmt;

/// Parameters of one solution: (t), (u, v), (t, u, v), …
pub type Parameters = SmallVec<[f64; 4]>;

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LocateStatus {
    /// Found from the given start, or the only solution.
    Ok,
    /// The iteration from the start failed; the solution is the nearest to the start, in parameter
    /// space, of all found by subdivision.
    Fallback,
    /// The solution is at an end or edge, because the unconstrained one is beyond it.
    EdgeClamped,
    /// The shapes are tangent or nearly so: the system of equations is singular at the solution.
    Tangent,
    /// There is no solution; the parameters are those of the least residual found.
    NoSolution,
    /// The search reached its limit without a solution; there may be one.
    Unfinished,
    /// There are several solutions, and no start to choose between them.
    Multiple {
        /// Number of solutions.
        count: usize,
        /// Index of the result, from 0, in the order of the parameters.
        chosen: usize,
        /// Distance in space from the chosen solution to the nearest other one.
        next: f64,
    },
    /// The iteration diverged, or a number is not finite.
    Diverged,
}

impl LocateStatus {
    /// The word used in the language and in Python.
    pub fn word(self) -> &'static str {
        match self {
            LocateStatus::Ok => "ok",
            LocateStatus::Fallback => "fallback",
            LocateStatus::EdgeClamped => "edge-clamped",
            LocateStatus::Tangent => "tangent",
            LocateStatus::NoSolution => "no-solution",
            LocateStatus::Unfinished => "unfinished",
            LocateStatus::Multiple { .. } => "multiple",
            LocateStatus::Diverged => "diverged",
        }
    }

    /// True when there is a solution.
    pub fn is_solution(self) -> bool {
        !matches!(
            self,
            LocateStatus::NoSolution | LocateStatus::Unfinished | LocateStatus::Diverged
        )
    }
}

impl fmt::Display for LocateStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LocateStatus::Multiple { count, chosen, .. } => {
                write!(f, "multiple({count}, {} taken)", chosen + 1)
            }
            other => f.write_str(other.word()),
        }
    }
}

/// A solution that was not chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// Its parameters.
    pub parameters: Parameters,
    /// Position.
    pub xyz: Vec3,
}

/// Report of a search, successful or not.
#[derive(Clone, Debug, PartialEq)]
pub struct LocateReport {
    /// Result of the search.
    pub status: LocateStatus,
    /// Residual of the equations, in the unit of length.
    pub residual: f64,
    /// Number of iterations that led to the solution.
    pub iterations: u32,
    /// The parameters it began with.
    pub start: Parameters,
    /// The parameters it ended with.
    pub last: Parameters,
    /// The solutions not chosen, in the order of the parameters.
    pub alternatives: Vec<Alternative>,
}

/// Parameters of a solution with its report.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution<const N: usize> {
    /// The parameters.
    pub at: [f64; N],
    /// For each parameter, true if it is that of a joint with a kink: the minimum distance is at a
    /// corner or a knuckle, and stays there.
    pub joint: [bool; N],
    /// Report of the search.
    pub report: LocateReport,
}

/// A root found by a search without a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundRoot<const N: usize> {
    /// Its parameters.
    pub at: [f64; N],
    /// Position.
    pub xyz: Vec3,
    /// Residual of the equations, in the unit of length.
    pub residual: f64,
    /// Steps of the iteration.
    pub iterations: u32,
    /// True when the shapes touch there.
    pub tangent: bool,
}

/// All roots, in the order of their parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Roots<const N: usize> {
    /// The roots.
    pub roots: Vec<FoundRoot<N>>,
    /// False when the search reached its limit, as it does if shapes coincide: there may be more.
    pub complete: bool,
    /// The parameters of the least residual found, for messages.
    pub closest: Option<([f64; N], f64)>,
    /// For each parameter, true if closed, so that 0 and 1 are the same.
    pub closed: [bool; N],
}

impl<const N: usize> Roots<N> {
    /// The root nearest to `start` in parameter space, across seams if that is shorter; the first
    /// of equally near ones.
    pub fn nearest_to(&self, start: &[f64]) -> Option<usize> {
        let away = |root: &FoundRoot<N>| -> f64 {
            let apart = |k: usize| parameter_distance(root.at[k], start[k], self.closed[k]);
            (0..N.min(start.len())).map(|k| apart(k) * apart(k)).sum()
        };
        let distances: Vec<f64> = self.roots.iter().map(away).collect();
        (0..distances.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]).then(a.cmp(&b)))
    }

    /// The solution that chooses root `chosen`; `given` is true if there was a start, from which
    /// the iteration failed.
    pub fn choose(&self, chosen: usize, start: &[f64], given: bool) -> Solution<N> {
        let root = &self.roots[chosen];
        let others = self.roots.iter().enumerate().filter(|(k, _)| *k != chosen);
        let next =
            others.clone().map(|(_, r)| r.xyz.distance(root.xyz)).fold(f64::INFINITY, f64::min);
        let status = match (self.roots.len(), given, root.tangent) {
            (_, _, true) => LocateStatus::Tangent,
            (_, true, _) => LocateStatus::Fallback,
            (1, ..) => LocateStatus::Ok,
            (count, ..) => LocateStatus::Multiple { count, chosen, next },
        };
        let alternatives = others
            .map(|(_, r)| Alternative { parameters: r.at.iter().copied().collect(), xyz: r.xyz })
            .collect();
        let report = LocateReport {
            status,
            residual: root.residual,
            iterations: root.iterations,
            start: start.iter().copied().collect(),
            last: root.at.iter().copied().collect(),
            alternatives,
        };
        Solution { at: root.at, joint: [false; N], report }
    }

    /// The report that there is no root, or that the search reached its limit before finding one.
    pub fn none(&self, start: &[f64]) -> LocateReport {
        let (last, residual) = match self.closest {
            Some((at, residual)) => (at.iter().copied().collect(), residual),
            None => (start.iter().copied().collect(), f64::INFINITY),
        };
        let status =
            if self.complete { LocateStatus::NoSolution } else { LocateStatus::Unfinished };
        LocateReport {
            status,
            residual,
            iterations: 0,
            start: start.iter().copied().collect(),
            last,
            alternatives: Vec::new(),
        }
    }
}
