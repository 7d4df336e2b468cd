//! Quality of the cells of volume blocks.

use super::Blocks;
use moldloft_parallel::prelude::*;

/// The cell of a block with the smallest scaled Jacobian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadCell {
    /// The cell (i, j, k).
    pub cell: [usize; 3],
    /// The scaled Jacobian, 1 for a brick, negative where the cell is folded.
    pub scaled_jacobian: f64,
    /// The Jacobian of the cell's trilinear map at that position, in units of volume.
    pub jacobian: f64,
    /// Position in space.
    pub at: [f64; 3],
    /// Position in the block's own parameters u, v, w, with cells of equal size.
    pub parameters: [f64; 3],
}

/// Quality of the cells of one block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockQuality {
    /// The block.
    pub name: String,
    /// Number of cells.
    pub cells: usize,
    /// Its volume.
    pub volume: f64,
    /// Cells whose Jacobian is zero or negative at a corner or Gauss point.
    pub folded: usize,
    /// The worst cell.
    pub worst: BadCell,
    /// Mean of the cells' smallest scaled Jacobians.
    pub mean_scaled_jacobian: f64,
    /// The largest ratio of the edges of a cell.
    pub largest_aspect: f64,
}

/// Report of a volume mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BlocksReport {
    /// Each block.
    pub blocks: Vec<BlockQuality>,
    /// Number of vertices used by cells.
    pub vertices: usize,
    /// Number of cells.
    pub cells: usize,
    /// Number of joined pairs of faces.
    pub interfaces: usize,
    /// The whole volume.
    pub volume: f64,
}

impl BlocksReport {
    /// True when every cell has a positive Jacobian at all corners and Gauss points.
    pub fn positive(&self) -> bool {
        self.blocks.iter().all(|b| b.folded == 0)
    }
}

/// Sums over cells, in their order.
#[derive(Clone, Copy)]
struct VolumeTally {
    volume: f64,
    folded: usize,
    sum: f64,
    aspect: f64,
    worst: Option<BadCell>,
}

impl VolumeTally {
    const EMPTY: VolumeTally =
        VolumeTally { volume: 0.0, folded: 0, sum: 0.0, aspect: 0.0, worst: None };

    fn and(self, o: VolumeTally) -> VolumeTally {
        let worst = match (self.worst, o.worst) {
            (Some(a), Some(b)) if b.scaled_jacobian < a.scaled_jacobian => Some(b),
            (a, b) => a.or(b),
        };
        VolumeTally {
            volume: self.volume + o.volume,
            folded: self.folded + o.folded,
            sum: self.sum + o.sum,
            aspect: self.aspect.max(o.aspect),
            worst,
        }
    }
}

impl Blocks<f64> {
    /// Counts, volumes and the quality of all cells, with Jacobians at the 8 corners and the 2 x 2
    /// x 2 Gauss points.
    pub fn report(&self) -> BlocksReport {
        let blocks: Vec<BlockQuality> = (0..self.blocks().len()).map(|b| self.quality(b)).collect();
        let mut used = vec![false; self.positions().len()];
        self.blocks().iter().flat_map(|b| &b.vertices).for_each(|&v| used[v as usize] = true);
        BlocksReport {
            vertices: used.iter().filter(|&&u| u).count(),
            cells: self.cell_count(),
            interfaces: self.interfaces().0.len(),
            volume: blocks.iter().map(|b| b.volume).sum(),
            blocks,
        }
    }

    /// The quality of one block.
    pub fn quality(&self, block: usize) -> BlockQuality {
        let hex = &self.blocks()[block];
        let [nu, ..] = hex.divisions();
        // A slab of cells each; added up in order, so the bits do not depend on threads.
        let slabs: Vec<VolumeTally> =
            (0..nu).into_par_iter().map(|i| self.slab(block, i)).collect();
        let tally = slabs.into_iter().fold(VolumeTally::EMPTY, VolumeTally::and);
        let cells = hex.cell_count();
        BlockQuality {
            name: hex.name.clone(),
            cells,
            volume: tally.volume,
            folded: tally.folded,
            worst: tally.worst.expect("a block has cells"),
            mean_scaled_jacobian: tally.sum / cells as f64,
            largest_aspect: tally.aspect,
        }
    }

    fn slab(&self, block: usize, i: usize) -> VolumeTally {
        let hex = &self.blocks()[block];
        let divisions = hex.divisions();
        let [_, nv, nw] = divisions;
        let mut tally = VolumeTally::EMPTY;
        for (j, k) in (0..nv).flat_map(|j| (0..nw).map(move |k| (j, k))) {
            let place = [i, j, k];
            let cell = self.cell(block, place);
            let (scaled, at) = cell.scaled_jacobian();
            // A position that is not a number is as bad as a folded cell.
            let good = scaled > 0.0;
            let one = VolumeTally {
                volume: cell.volume(),
                folded: usize::from(!good),
                sum: scaled,
                aspect: cell.aspect(),
                worst: Some(BadCell {
                    cell: place,
                    scaled_jacobian: scaled,
                    jacobian: cell.jacobian(at),
                    at: cell.position(at).to_array(),
                    parameters: std::array::from_fn(|axis| {
                        (place[axis] as f64 + at[axis]) / divisions[axis] as f64
                    }),
                }),
            };
            tally = tally.and(one);
        }
        tally
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::two_bricks;
    use crate::Blocks;
    use moldloft_num::Vec3;

    #[test]
    fn two_bricks_are_counted() {
        let report = super::super::fixtures::two_bricks(false).report();
        assert_eq!((report.cells, report.vertices, report.interfaces), (12, 40, 1));
        assert!(report.positive() && (report.volume - 12.0).abs() < 1e-13);
        assert_eq!(report.blocks[1].worst.scaled_jacobian, 1.0);
    }

    #[test]
    fn a_folded_cell_is_named() {
        let two = two_bricks(false);
        let mut positions = two.positions().to_vec();
        let vertex = two.blocks()[1].at([1, 1, 2]) as usize;
        positions[vertex] += Vec3::of(0.0, -2.0, 0.0);
        let report = Blocks::new(positions, two.blocks().to_vec()).unwrap().report();
        assert!(!report.positive());
        let bad = &report.blocks[1];
        assert!(bad.folded == 4 && report.blocks[0].folded == 0, "{bad:?}");
        assert!(bad.worst.scaled_jacobian < -0.3, "{bad:?}");
        assert!((bad.worst.at[0] - 3.0).abs() <= 1.0, "{bad:?}");
    }
}
