//! Smoothing across two edges that are one line.
//!
//! The grid is widened by the row before its first one, an image of the last but one; its last row is an image of the
//! first. Both follow after each pass, so that the rows between are like any others.

use crate::surface_grid::SAME;
use crate::zebra::Banks;
use crate::{Elliptic, GridError, GridSide, PeriodicEdges, SurfaceGrid, Wall};
use moldloft_num::{Real, Vec3};

/// The vectors from the points of the first row to those of the last.
pub struct PeriodicSeam<T> {
    steps: Vec<Vec3<T>>,
}

impl<T: Real> PeriodicSeam<T> {
    pub fn of(grid: &SurfaceGrid<T>) -> Result<Self, GridError> {
        let (first, last) = (grid.edge(GridSide::FirstI), grid.edge(GridSide::LastI));
        let steps: Vec<Vec3<T>> = first.iter().zip(&last).map(|(a, b)| *b - *a).collect();
        let limit = SAME * grid.size();
        for (j, step) in steps.iter().enumerate() {
            let gap = step.re().distance(steps[0].re());
            if gap > limit {
                return Err(GridError::NotPeriodic { at: [grid.m, j + 1], gap });
            }
        }
        Ok(Self { steps })
    }

    /// The grid with one more row, ahead of the first.
    pub fn widened(grid: &SurfaceGrid<T>) -> SurfaceGrid<T> {
        let m = grid.m;
        let before = |j: usize| grid.at(m - 2, j) - (grid.at(m - 1, j) - grid.at(0, j));
        SurfaceGrid::from_fn(m + 1, grid.n, |i, j| match i {
            0 => before(j),
            i => grid.at(i - 1, j),
        })
    }

    /// The walls of the widened grid.
    pub fn walls(options: &Elliptic<T>) -> Vec<Wall<T>> {
        let wider = |wall: &Wall<T>| {
            let crosses = matches!(wall.edge, GridSide::FirstJ | GridSide::LastJ);
            assert!(crosses, "a periodic edge is no wall");
            let mut spacing = wall.spacing.clone();
            if spacing.len() > 1 {
                spacing.insert(0, spacing[spacing.len() - 2]);
            }
            Wall { spacing, ..wall.clone() }
        };
        options.walls.iter().map(wider).collect()
    }

    /// Moves the two outer rows of the widened grid to their places.
    pub fn close<const L: usize>(
        &self,
        banks: &mut Banks<T, L>,
        turned: bool,
        components: &[usize],
    ) {
        let last = if turned { banks.n } else { banks.m } - 1;
        for (j, step) in self.steps.iter().enumerate() {
            for (c, &axis) in components.iter().enumerate() {
                let place = |row: usize| if turned { [j, row] } else { [row, j] };
                let step = [step.x, step.y, step.z][axis];
                for (from, to, step) in [(last - 1, 0, -step), (1, last, step)] {
                    let ([i, j], [k, l]) = (place(from), place(to));
                    let x = banks.at(c, i, j) + step;
                    banks.set(c, k, l, x);
                }
            }
        }
    }

    /// The grid without the row ahead; edges that are not periodic have their bits.
    pub fn narrowed(grid: &SurfaceGrid<T>, original: &SurfaceGrid<T>) -> SurfaceGrid<T> {
        let n = grid.n;
        SurfaceGrid::from_fn(grid.m - 1, n, |i, j| match j {
            0 => original.at(i, j),
            j if j + 1 == n => original.at(i, j),
            j => grid.at(i + 1, j),
        })
    }
}

/// The options for the grid with its indices exchanged.
pub fn crossed<'a, T: Real>(options: &Elliptic<'a, T>) -> Elliptic<'a, T> {
    let wall = |wall: &Wall<T>| Wall { edge: wall.edge.crossed(), ..wall.clone() };
    Elliptic {
        walls: options.walls.iter().map(wall).collect(),
        periodic: options.periodic.map(|_| PeriodicEdges::I),
        on: None,
        ..*options
    }
}
