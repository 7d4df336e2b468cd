//! Points: free, relative, projected and mirrored, and those that live on curves and surfaces.

mod along;
mod bead;
mod boxed;
mod derived;
mod framed;
mod free;
mod magnet;
mod ring;

pub use along::{ArcLenBead, ArcLenRing, CopyBead, CopyMagnet, CopyRing};
pub use bead::{AbsBead, RelBead};
pub use boxed::{BoxMagnet, BoxRing};
pub use derived::{
    BlendPoint, CentroidPoint, CopyPoint, OffsetPoint, RotatPoint, TanPoint, tangent,
};
pub use framed::{FramePoint, PolarPoint};
pub use free::{AbsPoint, MirrPoint, RelPoint};
pub use magnet::{AbsMagnet, RelMagnet};
pub use ring::{AbsRing, RelRing};
