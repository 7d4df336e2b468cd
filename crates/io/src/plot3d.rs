//! Plot3D grids: structured surfaces or volumes, several blocks, double precision.
//!
//! The number of blocks, then all sizes `ni nj nk` (nk = 1 for surfaces), then per block all x, all
//! y and all z, i running fastest (Walatka et al. 1990, PLOT3D User's Manual, NASA TM 101067, chapter 8).

use crate::WriteError;
use crate::error::{check_blocks, check_positions};
use crate::text::{put, real};
use moldloft_mesh::{Block, Blocks, Mesh};
use moldloft_num::Vec3;

/// How the numbers are laid down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Text.
    Formatted,
    /// Plain little-endian numbers: 32-bit integers and doubles, as C writes them.
    #[default]
    Stream,
    /// Records as a Fortran program writes them: each with its length in 32 bits before and after;
    /// one record of the count, one of the sizes, one per block.
    Unformatted,
}

/// The structured patches with their names.
pub(crate) fn blocks(mesh: &Mesh) -> Result<Vec<(&str, &Block)>, WriteError> {
    let without = mesh.patches().iter().filter(|p| p.block.is_none());
    let patches: Vec<String> = without.map(|p| p.info.name.clone()).collect();
    if !patches.is_empty() || mesh.patches().is_empty() {
        return Err(WriteError::NoGrid { patches });
    }
    let all = mesh.patches().iter();
    Ok(all.filter_map(|p| Some((p.info.name.as_str(), p.block.as_ref()?))).collect())
}

/// The grid file; i runs along u, j along v.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid; positions that are not finite; blocks too
/// large for the 32-bit integers of the format.
pub fn write(mesh: &Mesh, layout: Layout) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let grids = blocks(mesh)?.into_iter().map(|(_, b)| Grid {
        size: [b.nu, b.nv, 1],
        vertices: (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| b.at(i, j))).collect(),
    });
    written(mesh.positions(), &grids.collect::<Vec<_>>(), layout)
}

/// The grid file of volume blocks; i runs along u, j along v, k along w.
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite; blocks too large
/// for the 32-bit integers of the format.
pub fn write_blocks(blocks: &Blocks, layout: Layout) -> Result<Vec<u8>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let grids = blocks.blocks().iter().map(|b| {
        let [nu, nv, nw] = b.size;
        let across = (0..nw).flat_map(|k| (0..nv).map(move |j| (j, k)));
        let along = across.flat_map(|(j, k)| (0..nu).map(move |i| [i, j, k]));
        Grid { size: b.size, vertices: along.map(|place| b.at(place)).collect() }
    });
    written(blocks.positions(), &grids.collect::<Vec<_>>(), layout)
}

/// A block's vertices in the order of the file.
struct Grid {
    size: [usize; 3],
    vertices: Vec<u32>,
}

fn written(positions: &[Vec3], grids: &[Grid], layout: Layout) -> Result<Vec<u8>, WriteError> {
    let mut out = Writer { layout, bytes: Vec::new() };
    let integer = |n: usize| {
        i32::try_from(n).map_err(|_| WriteError::TooLarge { what: "points of a block", count: n })
    };
    let mut sizes = Vec::with_capacity(3 * grids.len());
    for grid in grids {
        // A Fortran record holds 24 bytes per point and counts them in 31 bits.
        if layout == Layout::Unformatted {
            integer(grid.vertices.len().saturating_mul(24))?;
        }
        for n in grid.size {
            sizes.push(integer(n)?);
        }
    }
    out.integers(&[integer(grids.len())?]);
    out.integers(&sizes);
    for grid in grids {
        let coordinates =
            (0..3).flat_map(|axis| grid.vertices.iter().map(move |&v| positions[v as usize][axis]));
        out.reals(3 * grid.vertices.len(), coordinates);
    }
    Ok(out.bytes)
}

struct Writer {
    layout: Layout,
    bytes: Vec<u8>,
}

impl Writer {
    /// The length of a Fortran record; nothing in other layouts.
    fn mark(&mut self, length: usize) {
        if self.layout == Layout::Unformatted {
            self.bytes.extend_from_slice(&(length as u32).to_le_bytes());
        }
    }

    fn integers(&mut self, values: &[i32]) {
        if self.layout == Layout::Formatted {
            let mut line = String::new();
            for (k, value) in values.iter().enumerate() {
                put!(
                    line,
                    "{value}{}",
                    if k % 3 == 2 || k + 1 == values.len() { '\n' } else { ' ' }
                );
            }
            self.bytes.extend_from_slice(line.as_bytes());
            return;
        }
        self.mark(4 * values.len());
        values.iter().for_each(|v| self.bytes.extend_from_slice(&v.to_le_bytes()));
        self.mark(4 * values.len());
    }

    fn reals(&mut self, count: usize, values: impl Iterator<Item = f64>) {
        self.mark(8 * count);
        for (k, value) in values.enumerate() {
            if self.layout == Layout::Formatted {
                self.bytes.extend_from_slice(real(value).as_bytes());
                self.bytes.push(if k % 4 == 3 || k + 1 == count { b'\n' } else { b' ' });
            } else {
                self.bytes.extend_from_slice(&(value + 0.0).to_le_bytes());
            }
        }
        self.mark(8 * count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};
    use moldloft_num::Vec3;

    fn two_grids() -> Mesh {
        let mut b = TopologyBuilder::new();
        b.add_vertices(6).unwrap();
        b.add_block(PatchInfo::new("a"), 3, 2, (0..6).collect(), false).unwrap();
        b.add_block(PatchInfo::new("b"), 2, 2, vec![0, 1, 2, 3], false).unwrap();
        let p = (0..6).map(|k| Vec3::of((k / 2) as f64, (k % 2) as f64, -0.0)).collect();
        Mesh::new(b.build().into(), p).unwrap()
    }

    #[test]
    fn text_reads_as_written_here() {
        let text = String::from_utf8(write(&two_grids(), Layout::Formatted).unwrap()).unwrap();
        let expected = "2\n3 2 1\n2 2 1\n0 1 2 0\n1 2 0 0\n0 1 1 1\n0 0 0 0\n0 0\n\
            0 1 0 1\n0 0 1 1\n0 0 0 0\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn volume_blocks_run_i_fastest() {
        let blocks = crate::fixtures::two_bricks();
        let text = String::from_utf8(write_blocks(&blocks, Layout::Formatted).unwrap()).unwrap();
        let expected = "2\n2 2 2\n3 2 2\n\
            0 1 0 1\n0 1 0 1\n0 0 1 1\n0 0 1 1\n0 0 0 0\n1 1 1 1\n\
            1 2 3 1\n2 3 1 2\n3 1 2 3\n0 0 0 1\n1 1 0 0\n0 1 1 1\n0 0 0 0\n0 0 1 1\n1 1 1 1\n";
        assert_eq!(text, expected);
        let none = Blocks::new(vec![], vec![]).unwrap();
        assert!(matches!(write_blocks(&none, Layout::Stream), Err(WriteError::NoGrid { .. })));
    }

    #[test]
    fn binary_sizes() {
        let stream = write(&two_grids(), Layout::Stream).unwrap();
        assert_eq!(stream.len(), 4 * 7 + 24 * 10);
        assert_eq!(stream[..8], [2, 0, 0, 0, 3, 0, 0, 0]);
        let records = write(&two_grids(), Layout::Unformatted).unwrap();
        assert_eq!(records.len(), stream.len() + 8 * 4);
        assert_eq!(records[..12], [4, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0]);
    }

    #[test]
    fn patches_without_grid_are_named() {
        let error = write(&crate::fixtures::two_patches(), Layout::Stream).unwrap_err();
        assert!(error.to_string().contains("`lid`"));
        let none = Mesh::new(TopologyBuilder::new().build().into(), vec![]).unwrap();
        assert!(matches!(write(&none, Layout::Stream), Err(WriteError::NoGrid { .. })));
    }
}
