//! The Python extension `moldloft._core`: classes over documents and meshes, no logic.
//!
//! `Document -> Python object`, `&[Vec3] -> NumPy array`, `Diagnostic -> exception`. The public
//! interface is `python/moldloft`, which wraps these classes.
//!
//! Invariant: this crate is the only one that knows Python. It opens no files: models are read
//! through `moldloft-host`, and Python reads and writes all others.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arrays;
mod blocks;
mod diagnostics;
mod document;
mod engine;
mod error;
mod fair;
mod foreign;
mod formats;
mod gradients;
mod grids;
mod implicit;
mod imported;
mod language_server;
mod limits;
mod mesh;
mod mesh_files;
mod nurbs;
mod reference;
mod search;
mod sketch;
mod value;
mod work;

use pyo3::pymodule;

/// Counts the bytes that the extension holds, for [`moldloft::budget::Budget`].
#[global_allocator]
static ALLOCATOR: moldloft::budget::Counting = moldloft::budget::Counting::new();

/// The compiled part of Moldloft.
#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use crate::blocks::PyBlocks;
    #[pymodule_export]
    use crate::diagnostics::{PyDiagnostic, PyLabel};
    #[pymodule_export]
    use crate::document::{PyDocument, format_text};
    #[pymodule_export]
    use crate::engine::{PySession, engine};
    #[pymodule_export]
    use crate::fair::{
        Look, Net, Spline, Web, are_exact, data_findings, detectable, divided_differences, eta_y,
        is_exact, line_findings, monotone_runs, shared_knuckles,
    };
    #[pymodule_export]
    use crate::formats::{formats, spline_patch_grid, spline_patch_knots};
    #[pymodule_export]
    use crate::gradients::{jvp, literals, state, vjp};
    #[pymodule_export]
    use crate::grids::{
        grid_with_fields, grids_as_stl, points_csv, points_text, read_aerofoil, read_cgns,
        read_plot3d, read_points, write_cgns, write_grids, write_plot3d,
    };
    #[pymodule_export]
    use crate::implicit::{PyFacets, PyField, PySet, call_row};
    #[pymodule_export]
    use crate::imported::{aligned_faces, common_sides, on_border};
    #[pymodule_export]
    use crate::language_server::{language_engine, language_server};
    #[pymodule_export]
    use crate::limits::{held_memory, limits, set_limits};
    #[pymodule_export]
    use crate::mesh::PyMesh;
    #[pymodule_export]
    use crate::mesh_files::read_mesh;
    #[pymodule_export]
    use crate::nurbs::{brep, length_unit, nurbs, nurbs_points};
    #[pymodule_export]
    use crate::reference::{attributes, keywords, libraries, reference, statements};
    #[pymodule_export]
    use crate::search::{intersect, intersect_plane, nearest};
    #[pymodule_export]
    use crate::sketch::{PySketch, sketch_reference, sketch_stroke};
    #[pymodule_export]
    use crate::value::Shape;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::limits::take_usual();
        crate::work::register(module)
    }
}
