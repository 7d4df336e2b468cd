//! Meshes of other programs.

use crate::arrays;
use crate::error::{format_error, plain_error};
use crate::work::unlocked;
use moldloft::io::{obj, off, ply, stl};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// A mesh: points (n, 3), faces (m, 4), groups of faces by name with their first and one past their
/// last, warnings.
type Foreign<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<u32>>,
    Vec<(String, usize, usize)>,
    Vec<String>,
);

/// The mesh of a file by its ending: stl, obj, ply or off.
#[pyfunction]
pub fn read_mesh<'py>(py: Python<'py>, data: &[u8], ending: &str) -> PyResult<Foreign<'py>> {
    let read = match ending {
        "stl" => stl::read,
        "obj" => obj::read,
        "ply" => ply::read,
        "off" => off::read,
        _ => return Err(plain_error(format!("no reader for `{ending}`"))),
    };
    let data = data.to_vec();
    let found = unlocked(py, move || read(&data))?.map_err(format_error)?;
    let (places, corners) = (found.mesh.positions(), found.mesh.faces());
    let points = arrays::filled(py, [places.len(), 3], |out| out.copy_from_slice(places)).0;
    let faces = PyArray2::<u32>::zeros(py, [corners.len(), 4], false);
    faces.readwrite().as_slice_mut()?.copy_from_slice(corners.as_flattened());
    let groups = found.mesh.patches().iter();
    let groups = groups.map(|p| (p.info.name.clone(), p.faces.start, p.faces.end)).collect();
    Ok((points, faces, groups, found.remarks))
}
