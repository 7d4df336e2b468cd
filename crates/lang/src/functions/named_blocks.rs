//! Blocks with the names of their faces.

use moldloft_grid::{FaceNames, GridFace};
use moldloft_io::StructuredGrid;
use moldloft_io::cgns::FacePart;
use moldloft_num::Vec3;

/// A block that is written, and the names of its faces.
#[derive(Clone)]
pub(crate) struct NamedBlock {
    pub grid: StructuredGrid,
    pub name: String,
    pub faces: FaceNames,
}

/// The points of a part of a face, the first of its two axes slowest, and the numbers of points along them.
pub(super) fn face_points(
    blocks: &[NamedBlock],
    part: &FacePart,
) -> (Vec<Vec3>, [usize; 2], [usize; 2]) {
    let (block, face, from, to) = part;
    let axis = GridFace::ALL[*face].axis;
    let [a, b] = [[1, 2], [0, 2], [0, 1]][axis];
    let range = |k: usize| (from[k].min(to[k]), from[k].max(to[k]));
    let ((a0, a1), (b0, b1)) = (range(a), range(b));
    let mut points = Vec::new();
    for i in a0..=a1 {
        for j in b0..=b1 {
            let mut at = *from;
            (at[a], at[b]) = (i, j);
            points.push(blocks[*block].grid.at(at));
        }
    }
    (points, [a, b], [a1 - a0 + 1, b1 - b0 + 1])
}
