//! Pictures of meshes without a display.
//!
//! `Mesh + lines + Options -> camera -> depth-buffered pixels -> PNG bytes`
//!
//! Panels are shaded from both sides by a headlight, a key light over the viewer's left shoulder and
//! a soft sky; each picture point is the mean of 2 x 2 samples.
//!
//! ```
//! use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
//! use moldloft_num::Vec3;
//! use moldloft_picture::{Options, render};
//!
//! let mut builder = TopologyBuilder::new();
//! builder.add_vertices(3)?;
//! builder.add_faces(PatchInfo::new("fin"), [[0, 1, 2, 2]])?;
//! let corners = vec![Vec3::of(0.0, 0.0, 0.0), Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 0.0, 1.0)];
//! let fin = Mesh::new(builder.build().into(), corners)?;
//! let png = render(&fin, &[], &Options { width: 64, height: 48, ..Options::default() })?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Invariant: this crate performs no input or output and opens no window; the same input gives the
//! same bytes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod camera;
mod lettering;
mod palette;
mod raster;
mod render;

pub use camera::Camera;
pub use lettering::PointName;
pub use palette::{PALETTE, patch_colour};
pub use render::{
    Options, PatchStyle, PictureError, StyledPolyline, encoded, render, render_while,
};
