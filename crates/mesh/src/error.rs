//! Errors of data that make no mesh.

use std::fmt;

/// Fault of the data given for a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// A face or block names a vertex that does not exist.
    UnknownVertex {
        /// The patch being built.
        patch: String,
        /// The given vertex.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A block's vertex list does not have `nu * nv` entries, or has fewer than two in a direction.
    BlockShape {
        /// The patch being built.
        patch: String,
        /// Vertices along u and v.
        shape: [usize; 2],
        /// Length of the vertex list.
        actual: usize,
    },
    /// A volume block's vertex list does not have `nu * nv * nw` entries, or has fewer than two in a
    /// direction.
    HexShape {
        /// The block.
        block: String,
        /// Vertices along u, v and w.
        shape: [usize; 3],
        /// Length of the vertex list.
        actual: usize,
    },
    /// The number of positions differs from the number of vertices of the topology.
    PositionCount {
        /// Vertices of the topology.
        expected: usize,
        /// Positions given.
        actual: usize,
    },
    /// More vertices or corners of faces than 32-bit indices can number.
    TooLarge {
        /// The given number.
        count: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownVertex { patch, vertex, count } => {
                write!(f, "patch `{patch}` uses vertex {vertex}, but there are {count}")
            }
            Self::BlockShape { patch, shape: [nu, nv], actual } => write!(
                f,
                "block `{patch}` of {nu} x {nv} points needs at least 2 x 2 and exactly {} vertices, \
                 found {actual}",
                nu.saturating_mul(*nv)
            ),
            Self::HexShape { block, shape: [nu, nv, nw], actual } => write!(
                f,
                "block `{block}` of {nu} x {nv} x {nw} points needs at least 2 x 2 x 2 and exactly \
                 {} vertices, found {actual}",
                nu.saturating_mul(*nv).saturating_mul(*nw)
            ),
            Self::PositionCount { expected, actual } => {
                write!(f, "the mesh has {expected} vertices, but {actual} positions were given")
            }
            Self::TooLarge { count } => {
                write!(f, "{count} vertices or faces are more than 32-bit indices can name")
            }
        }
    }
}

impl std::error::Error for MeshError {}
