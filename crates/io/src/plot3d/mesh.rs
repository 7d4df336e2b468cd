//! Structured patches of a mesh and blocks of a volume mesh as grids of points.

use super::variant::Variant;
use super::write::write;
use crate::error::{check_blocks, check_positions};
use crate::{StructuredGrid, WriteError};
use moldloft_mesh::{Block, Blocks, HexBlock, Mesh};
use moldloft_num::Vec3;

/// The structured patches with their names.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid, or there are no patches.
pub(crate) fn structured_patches(mesh: &Mesh) -> Result<Vec<(&str, &Block)>, WriteError> {
    let without = mesh.patches().iter().filter(|p| p.block.is_none());
    let patches: Vec<String> = without.map(|p| p.info.name.clone()).collect();
    if !patches.is_empty() || mesh.patches().is_empty() {
        return Err(WriteError::NoGrid { patches });
    }
    let all = mesh.patches().iter();
    Ok(all.filter_map(|p| Some((p.info.name.as_str(), p.block.as_ref()?))).collect())
}

/// The grid file of a mesh's structured patches; i is along u, j along v.
///
/// # Errors
/// [`WriteError::NoGrid`] when some patch has no grid; positions that are not finite; blocks that
/// the variant cannot hold, see [`write()`].
pub fn write_mesh(mesh: &Mesh, variant: Variant) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let patches = structured_patches(mesh)?.into_iter();
    let grids: Vec<StructuredGrid> =
        patches.map(|(_, block)| of_patch(mesh.positions(), block)).collect();
    write(&grids, variant)
}

/// The grid file of volume blocks; i is along u, j along v, k along w.
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite; blocks that the
/// variant cannot hold, see [`write()`].
pub fn write_blocks(blocks: &Blocks, variant: Variant) -> Result<Vec<u8>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let grids = blocks.blocks().iter().map(|b| of_block(blocks.positions(), b));
    write(&grids.collect::<Vec<_>>(), variant)
}

/// The points of a structured patch.
pub(crate) fn of_patch(positions: &[Vec3], b: &Block) -> StructuredGrid {
    let vertices = (0..b.nv).flat_map(|j| (0..b.nu).map(move |i| b.at(i, j)));
    of_vertices(positions, [b.nu, b.nv, 1], vertices)
}

/// The points of a block.
pub(crate) fn of_block(positions: &[Vec3], b: &HexBlock) -> StructuredGrid {
    let [nu, nv, nw] = b.size;
    let across = (0..nw).flat_map(|k| (0..nv).map(move |j| (j, k)));
    let along = across.flat_map(|(j, k)| (0..nu).map(move |i| [i, j, k]));
    of_vertices(positions, b.size, along.map(|place| b.at(place)))
}

/// The grid whose points, i fastest, are these vertices.
fn of_vertices(
    positions: &[Vec3],
    size: [usize; 3],
    vertices: impl Iterator<Item = u32> + Clone,
) -> StructuredGrid {
    let plane = |axis: usize| vertices.clone().map(|v| positions[v as usize][axis]).collect();
    StructuredGrid { size, planes: [plane(0), plane(1), plane(2)], iblank: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot3d::Laid;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    const TEXT: Variant = variant(Laid::Formatted);

    const fn variant(laid: Laid) -> Variant {
        Variant { laid, ..Variant::USUAL }
    }

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
        let text = String::from_utf8(write_mesh(&two_grids(), TEXT).unwrap()).unwrap();
        let expected = "2\n3 2 1 2 2 1\n0 1 2 0 1 2\n0 0 0 1 1 1\n0 0 0 0 0 0\n\
            0 1 0 1\n0 0 1 1\n0 0 0 0\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn volume_blocks_run_i_fastest() {
        let blocks = crate::fixtures::two_bricks();
        let text = String::from_utf8(write_blocks(&blocks, TEXT).unwrap()).unwrap();
        let expected = "2\n2 2 2 3 2 2\n\
            0 1 0 1 0 1\n0 1\n0 0 1 1 0 0\n1 1\n0 0 0 0 1 1\n1 1\n\
            1 2 3 1 2 3\n1 2 3 1 2 3\n0 0 0 1 1 1\n0 0 0 1 1 1\n0 0 0 0 0 0\n1 1 1 1 1 1\n";
        assert_eq!(text, expected);
        let none = Blocks::new(vec![], vec![]).unwrap();
        assert!(matches!(write_blocks(&none, Variant::default()), Err(WriteError::NoGrid { .. })));
    }

    #[test]
    fn binary_sizes() {
        let stream = write_mesh(&two_grids(), Variant::default()).unwrap();
        assert_eq!(stream.len(), 4 * 7 + 24 * 10);
        assert_eq!(stream[..8], [2, 0, 0, 0, 3, 0, 0, 0]);
        let records = write_mesh(&two_grids(), variant(Laid::Unformatted)).unwrap();
        assert_eq!(records.len(), stream.len() + 8 * 4);
        assert_eq!(records[..12], [4, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0]);
    }

    #[test]
    fn patches_without_grid_are_named() {
        let error = write_mesh(&crate::fixtures::two_patches(), Variant::default()).unwrap_err();
        assert!(error.to_string().contains("`lid`"));
        let none = Mesh::new(TopologyBuilder::new().build().into(), vec![]).unwrap();
        assert!(matches!(write_mesh(&none, Variant::default()), Err(WriteError::NoGrid { .. })));
    }
}
