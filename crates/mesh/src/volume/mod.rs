//! Volume meshes: structured blocks of hexahedra with common vertices.

mod blocks;
mod cell;
mod interface;
mod report;

pub use blocks::{BlockFace, Blocks, HexBlock};
pub use cell::Hexahedron;
pub use interface::{Boundary, Interface, interfaces_of};
pub use report::{BadCell, BlockQuality, BlocksReport};

#[cfg(test)]
mod fixtures;
