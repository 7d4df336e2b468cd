//! Plot3D grids in every variant: text, plain binary or Fortran records; single or double precision;
//! one block or several; two or three coordinates; with or without blanking; both byte orders; whole
//! blocks or plane by plane.
//!
//! The format does not declare any of this. The reader tries the possible readings, and accepts the
//! one that fits to the byte: record marks, sizes and counts against the length of the file, and,
//! if more than one fits, plausible coordinates.
//!
//! Layout: Walatka et al. 1990, PLOT3D User's Manual, NASA TM 101067, chapter 8.

mod mesh;
mod read;
mod read_text;
mod variant;
mod write;

pub use mesh::{write_blocks, write_mesh};
pub use read::read;
pub use variant::{Laid, Variant};
pub use write::write;

pub(crate) use mesh::{of_block, of_patch, structured_patches};

#[cfg(test)]
mod tests;
