//! Notes about the joins of blocks.

use moldloft_num::Vec3;

/// A note to the user about the joins of blocks.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockNote {
    /// Cell counts along a part of a block's edge contradict those of the neighbour, so the blocks
    /// are not joined there.
    Divisions {
        /// The block whose edge has several parts, and the neighbour along one of them.
        blocks: [String; 2],
        /// Cells along the edge of the first.
        divisions: usize,
        /// Cells of the neighbour along the part.
        along: f64,
        /// The part as a fraction of the edge.
        share: f64,
    },
    /// A shared vertex has different positions in both blocks.
    Apart {
        /// The blocks.
        blocks: [String; 2],
        /// Distance of the two positions.
        distance: f64,
        /// Position.
        at: Vec3,
    },
}

impl BlockNote {
    /// A stable word for the type of note.
    pub fn id(&self) -> &'static str {
        match self {
            BlockNote::Divisions { .. } => "divisions-contradict",
            BlockNote::Apart { .. } => "faces-apart",
        }
    }
}

impl std::fmt::Display for BlockNote {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            BlockNote::Divisions { blocks: [a, b], divisions: n, along: m, share } => write!(
                f,
                "`{a}` has {n} cells along an edge, `{b}` has {m} along the part {share} of it, \
                 so their cells do not join"
            ),
            BlockNote::Apart { blocks: [a, b], distance, at } => write!(
                f,
                "`{a}` and `{b}` share a face or edge but are {distance:.3e} apart at ({}, {}, {})",
                at.x, at.y, at.z
            ),
        }
    }
}
