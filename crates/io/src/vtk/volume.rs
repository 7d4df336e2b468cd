//! Volume blocks as VTK structured grids, or all their hexahedra as one unstructured grid.

use super::grid::{indexed, structured};
use super::xml::{Appended, NamedFile, array, strings};
use crate::WriteError;
use crate::error::check_blocks;
use moldloft_mesh::{Blocks, HexBlock};
use moldloft_num::Vec3;

/// The vertices of a block, u fastest, then v.
fn vertices(block: &HexBlock) -> impl Iterator<Item = u32> + '_ {
    let [nu, nv, nw] = block.size;
    let across = (0..nw).flat_map(move |k| (0..nv).map(move |j| (j, k)));
    across.flat_map(move |(j, k)| (0..nu).map(move |i| block.at([i, j, k])))
}

/// The blocks of a volume mesh as files, named as those of [`super::structured_files`].
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite.
pub fn block_files(blocks: &Blocks, stem: &str) -> Result<Vec<NamedFile>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let one = |b: &HexBlock| {
        let bytes =
            structured(blocks.positions(), b.size, vertices(b), Some(("block_name", &b.name)), &[]);
        (b.name.clone(), bytes)
    };
    Ok(indexed(blocks.blocks().iter().map(one).collect(), stem))
}

/// VTK's number for a hexahedron.
const VTK_HEXAHEDRON: u8 = 12;

/// VTK's order of the corners of a hexahedron, by ours (u, v, w are bits 0, 1, 2 of a corner).
const VTK_CORNERS: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// The `.vtu` file: all hexahedra over common points, with the cell array `block` (index of the
/// block) and the field array `block_name`. Cells at poles repeat points.
///
/// # Errors
/// [`WriteError::NoGrid`] when there are no blocks; positions that are not finite.
pub fn unstructured(blocks: &Blocks) -> Result<Vec<u8>, WriteError> {
    check_blocks(blocks, f64::MAX)?;
    let cells = || blocks.blocks().iter().flat_map(|b| b.cells().map(move |place| b.cell(place)));
    let count = blocks.cell_count();
    let mut used = vec![false; blocks.positions().len()];
    cells().flatten().for_each(|v| used[v as usize] = true);
    let points = blocks.positions().iter().zip(&used);
    let points = points.map(|(&p, &u)| if u { p } else { Vec3::zero() });
    let mut data = Appended::default();
    let points = data.add_reals(points.flat_map(Vec3::to_array));
    let corners = cells().flat_map(|cell| VTK_CORNERS.map(|c| i64::from(cell[c])));
    let connectivity = data.add_integers(corners);
    let offsets = data.add_integers((1..=count as i64).map(|k| 8 * k));
    let types = data.add(&vec![VTK_HEXAHEDRON; count]);
    let owners = blocks.blocks().iter().enumerate();
    let owner =
        data.add_integers(owners.flat_map(|(k, b)| std::iter::repeat_n(k as i64, b.cell_count())));
    let body = format!(
        "<UnstructuredGrid>\n<FieldData>\n{}</FieldData>\n<Piece NumberOfPoints=\"{}\" \
         NumberOfCells=\"{count}\">\n<CellData Scalars=\"block\">\n{}</CellData>\n<Points>\n{}\
         </Points>\n<Cells>\n{}{}{}</Cells>\n</Piece>\n</UnstructuredGrid>\n",
        strings("block_name", blocks.blocks().iter().map(|b| b.name.as_str())),
        blocks.positions().len(),
        array("Int64", "block", 1, owner),
        array("Float64", "Points", 3, points),
        array("Int64", "connectivity", 1, connectivity),
        array("Int64", "offsets", 1, offsets),
        array("UInt8", "types", 1, types),
    );
    Ok(data.file("UnstructuredGrid", &body))
}
