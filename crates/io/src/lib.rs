//! Mesh, grid and drawing formats: bytes in, bytes out.
//!
//! | format | write | read |
//! | --- | --- | --- |
//! | WAMIT low-order GDF | [`gdf::write`] | [`gdf::read`] |
//! | Nemoh | [`nemoh::write`] | – |
//! | HydroStar | [`hydrostar::write`] | – |
//! | HAMS | [`hams::write`], [`hams::write_lids`] | – |
//! | AQWA geometry decks | [`aqwa::write`] | – |
//! | PLY | [`ply::write`] (binary) | – |
//! | glTF | [`gltf::write`] (`.glb`) | – |
//! | STL | [`stl::write`] (binary) | [`stl::read`] (binary and text) |
//! | 3MF | [`threemf::write`] | – |
//! | Wavefront OBJ | [`obj::write`] | [`obj::read`] |
//! | VTK XML | [`vtk::polydata`], [`vtk::structured_files`], [`vtk::block_files`], [`vtk::unstructured`] | – |
//! | Plot3D surfaces | [`plot3d::write`] | – |
//! | Plot3D volumes | [`plot3d::write_blocks`] | – |
//! | Plot3D, all variants, of grids of points | [`plot3d_any::write`] | [`plot3d_any::read`] |
//! | VTK XML and STL of grids of points | [`write_vts`], [`write_stl`] | – |
//! | coordinates in text, aerofoil sections | – | [`section::read_points`], [`section::read_aerofoil`] |
//! | SVG lines drawings | [`drawing::draw`] | – |
//!
//! `Mesh -> Vec<u8>` and `&[u8] -> Mesh`. The caller opens and closes the files, and writes each
//! whole or not at all.
//!
//! Numbers are written with as many digits as bring the same double back. Positions that are
//! not finite are refused, naming patch and vertex. Readers trust no count in a file: memory grows
//! with the bytes that are really there.
//!
//! Invariant: this crate performs no input or output.

// `!(a > b)` refuses NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod error;
mod lattice;
mod solver;
mod text;

pub mod aqwa;
pub mod drawing;
pub mod gdf;
pub mod gltf;
pub mod hams;
pub mod hydrostar;
pub mod nemoh;
pub mod obj;
pub mod plot3d;
pub mod plot3d_any;
pub mod ply;
pub mod section;
pub mod stl;
pub mod threemf;
pub mod vtk;

pub use error::{Bits, Place, ReadError, WriteError};
pub use lattice::{Lattice, write_stl, write_vts};
pub use solver::Skin;

use moldloft_num::Vec3;

/// What a model has besides surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strands {
    /// Polylines, each with the name of its object; a closed one repeats its first point.
    pub wires: Vec<(String, Vec<Vec3>)>,
    /// Points, each with the name of its object.
    pub dots: Vec<(String, Vec3)>,
}

impl Strands {
    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.wires.is_empty() && self.dots.is_empty()
    }

    /// Refuses them, by name, for a format that has no place for them.
    ///
    /// # Errors
    /// When there are some.
    pub fn refused(&self, format: &'static str) -> Result<(), WriteError> {
        let named = |what, name: &String| WriteError::NoPlace { format, what, name: name.clone() };
        match (self.wires.first(), self.dots.first()) {
            (Some((name, _)), _) => Err(named("wires", name)),
            (_, Some((name, _))) => Err(named("points", name)),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod fixtures;
