//! Mesh, grid and drawing formats: bytes in, bytes out.
//!
//! | format | write | read |
//! | --- | --- | --- |
//! | WAMIT low-order GDF | [`gdf::write`] | [`gdf::read`] |
//! | Nemoh | [`nemoh::write`] | – |
//! | HydroStar | [`hydrostar::write`] | – |
//! | HAMS | [`hams::write`], [`hams::write_lids`] | – |
//! | AQWA geometry decks | [`aqwa::write`] | – |
//! | PLY | [`ply::write`] (binary) | [`ply::read`] (binary and text) |
//! | glTF | [`gltf::write`] (`.glb`) | – |
//! | STL | [`stl::write`] (binary) | [`stl::read`] (binary and text) |
//! | 3MF | [`threemf::write`] | – |
//! | Wavefront OBJ | [`obj::write`] | [`obj::read`] |
//! | OFF | [`off::write`] | [`off::read`] |
//! | Gmsh | [`msh::write`] | – |
//! | SU2 | [`su2::write`] | – |
//! | hexahedra of SU2, Gmsh | [`hexahedra::su2`], [`hexahedra::gmsh`] | – |
//! | OpenFOAM | [`openfoam::block_mesh`], [`graded_blocks::graded_block_mesh`], [`openfoam::poly_mesh`] | – |
//! | STL, text | [`stl::write_text`] | [`stl::read`] |
//! | VTK XML | [`vtk::polydata`], [`vtk::structured_files`], [`vtk::block_files`], [`vtk::unstructured`], [`vtk::grid_files`] | – |
//! | Plot3D, all variants | [`plot3d::write`], [`plot3d::write_mesh`], [`plot3d::write_blocks`] | [`plot3d::read`] |
//! | CGNS, structured zones | [`cgns::write_mesh`], [`cgns::write_surfaces`], [`cgns::write_blocks`], [`cgns::write_volume`] | [`cgns::read`] |
//! | points in text | [`points::write`], [`points::write_csv`] | [`points::read`] |
//! | aerofoil sections | – | [`section::read_aerofoil`] |
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

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// `!(a > b)` refuses NaN, `a <= b` lets it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod error;
mod foreign;
mod hdf5;
mod solver;
mod structured_grid;
mod text;

pub mod aqwa;
pub mod cgns;
pub mod drawing;
mod facing;
pub mod gdf;
pub mod gltf;
pub mod graded_blocks;
pub mod hams;
pub mod hexahedra;
pub mod hydrostar;
pub mod iges;
pub mod msh;
pub mod nemoh;
pub mod neutral_map;
mod numbered;
pub mod obj;
pub mod off;
pub mod openfoam;
pub mod plot3d;
pub mod ply;
pub mod points;
pub mod quadrilaterals;
pub mod section;
pub mod step;
pub mod stl;
pub mod su2;
pub mod threemf;
pub mod ugrid;
pub mod vtk;

pub use error::{Bits, FilePosition, ReadError, WriteError};
pub use foreign::ForeignMesh;
pub use solver::PanelFileOptions;
pub use structured_grid::{NamedGrid, StructuredGrid};

use moldloft_num::Vec3;

/// Content of a model besides surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinesAndPoints {
    /// Polylines, each with the name of its object; a closed one repeats its first point.
    pub wires: Vec<(String, Vec<Vec3>)>,
    /// Points, each with the name of its object.
    pub dots: Vec<(String, Vec3)>,
}

impl LinesAndPoints {
    /// True if empty.
    pub fn is_empty(&self) -> bool {
        self.wires.is_empty() && self.dots.is_empty()
    }

    /// Refuses them, by name, for a format that cannot hold them.
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
