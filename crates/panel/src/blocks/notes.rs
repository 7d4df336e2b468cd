//! Notes about the joins of blocks.

use moldloft_num::Vec3;

/// Something about the joins of blocks that the user may want to know.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockNote {
    /// The cells of one block along a part of another's edge do not fit, so they are not joined.
    Divisions {
        /// The block whose edge has several parts, and the other one along one of them.
        blocks: [String; 2],
        /// Cells along the edge of the first.
        divisions: usize,
        /// Cells of the other along the part.
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
    /// A stable word for its kind.
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
