//! Points: free, relative, projected and mirrored, and those that live on curves and surfaces.

mod bead;
mod framed;
mod free;
mod magnet;
mod ring;

pub use bead::{AbsBead, RelBead};
pub use framed::{FramePoint, PolarPoint};
pub use free::{AbsPoint, MirrPoint, ProjPoint, RelPoint};
pub use magnet::{AbsMagnet, RelMagnet};
pub use ring::{AbsRing, RelRing};
