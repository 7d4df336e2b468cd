//! Structured grids of points in and out of files.

use crate::error::plain_error;
use moldloft_io::plot3d_any::{self, Laid, Variant};
use moldloft_io::section::{self, Listing};
use moldloft_io::{Lattice, write_stl, write_vts};
use moldloft_num::Vec3;
use numpy::ndarray::Array4;
use numpy::{PyArray4, PyReadonlyArray4, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// Grids of shape (ni, nj, nk, 3).
fn lattices(grids: &[PyReadonlyArray4<'_, f64>]) -> PyResult<Vec<Lattice>> {
    let one = |grid: &PyReadonlyArray4<'_, f64>| {
        let a = grid.as_array();
        let &[ni, nj, nk, 3] = a.shape() else {
            let found = a.shape();
            return Err(plain_error(format!(
                "a grid has the shape (ni, nj, nk, 3), found {found:?}"
            )));
        };
        let plane = |c: usize| {
            let across = (0..nk).flat_map(|k| (0..nj).map(move |j| (j, k)));
            across
                .flat_map(|(j, k)| (0..ni).map(move |i| (i, j, k)))
                .map(|(i, j, k)| a[[i, j, k, c]])
                .collect()
        };
        Ok(Lattice { size: [ni, nj, nk], planes: [plane(0), plane(1), plane(2)], iblank: None })
    };
    grids.iter().map(one).collect()
}

fn array<'py>(py: Python<'py>, block: &Lattice) -> Bound<'py, PyArray4<f64>> {
    let [ni, nj, nk] = block.size;
    let at = |(i, j, k, c): (usize, usize, usize, usize)| block.planes[c][(k * nj + j) * ni + i];
    Array4::from_shape_fn((ni, nj, nk, 3), at).to_pyarray(py)
}

/// The blocks of a Plot3D file of any variant, as arrays (ni, nj, nk, 3), and what the variant is.
#[pyfunction]
pub fn read_plot3d<'py>(
    py: Python<'py>,
    data: &[u8],
) -> PyResult<(Vec<Bound<'py, PyArray4<f64>>>, Bound<'py, PyDict>)> {
    let (blocks, variant) = py.detach(|| plot3d_any::read(data)).map_err(plain_error)?;
    let dict = PyDict::new(py);
    let layout = match variant.laid {
        Laid::Formatted => "text",
        Laid::Stream => "stream",
        Laid::Unformatted => "records",
    };
    dict.set_item("layout", layout)?;
    dict.set_item("double", variant.double)?;
    dict.set_item("multi", variant.multi)?;
    dict.set_item("three", variant.three)?;
    dict.set_item("big_endian", variant.big_endian)?;
    dict.set_item("mark", variant.mark)?;
    dict.set_item("planes", variant.planes)?;
    let blank: Vec<Option<Vec<i32>>> = blocks.iter().map(|b| b.iblank.clone()).collect();
    dict.set_item("iblank", if variant.iblank { Some(blank) } else { None })?;
    dict.set_item("words", variant.to_string())?;
    Ok((blocks.iter().map(|b| array(py, b)).collect(), dict))
}

/// A Plot3D file of arrays (ni, nj, nk, 3).
#[pyfunction]
#[pyo3(signature = (grids, layout, double, multi, three, iblank, big_endian, mark, planes))]
#[allow(clippy::too_many_arguments)]
pub fn write_plot3d<'py>(
    py: Python<'py>,
    grids: Vec<PyReadonlyArray4<'py, f64>>,
    layout: &str,
    double: bool,
    multi: bool,
    three: bool,
    iblank: Option<Vec<Option<Vec<i32>>>>,
    big_endian: bool,
    mark: usize,
    planes: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let laid = match layout {
        "text" => Laid::Formatted,
        "stream" => Laid::Stream,
        "records" => Laid::Unformatted,
        other => {
            let expected = "text, stream or records";
            return Err(plain_error(format!("there is no layout `{other}`; there are {expected}")));
        }
    };
    let mut blocks = lattices(&grids)?;
    let given = iblank.is_some();
    for (block, blank) in blocks.iter_mut().zip(iblank.into_iter().flatten()) {
        block.iblank = blank;
    }
    let variant = Variant { laid, double, multi, three, iblank: given, big_endian, mark, planes };
    let bytes = plot3d_any::write(&blocks, variant).map_err(plain_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// VTK structured grids: names and contents of the files.
#[pyfunction]
pub fn grids_as_vts(
    grids: Vec<PyReadonlyArray4<'_, f64>>,
    stem: &str,
) -> PyResult<Vec<(String, Vec<u8>)>> {
    let files = write_vts(&lattices(&grids)?, stem).map_err(plain_error)?;
    Ok(files.into_iter().map(|file| (file.name, file.bytes)).collect())
}

/// A binary STL of surface grids.
#[pyfunction]
pub fn grids_as_stl<'py>(
    py: Python<'py>,
    grids: Vec<PyReadonlyArray4<'py, f64>>,
    name: &str,
    flip: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = write_stl(&lattices(&grids)?, name, flip).map_err(plain_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// Rows of coordinates in text.
#[pyfunction]
pub fn read_points(data: &[u8]) -> PyResult<Vec<[f64; 3]>> {
    let points = section::read_points(data).map_err(plain_error)?;
    Ok(points.into_iter().map(Vec3::to_array).collect())
}

/// An aerofoil section: its name, points, index of the nose and listing.
#[pyfunction]
pub fn read_aerofoil(data: &[u8]) -> PyResult<(String, Vec<[f64; 3]>, usize, &'static str)> {
    let found = section::read_aerofoil(data).map_err(plain_error)?;
    let listing = match found.listing {
        Listing::Selig => "selig",
        Listing::Lednicer => "lednicer",
    };
    let points = found.points.into_iter().map(Vec3::to_array).collect();
    Ok((found.name, points, found.nose, listing))
}
