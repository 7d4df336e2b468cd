//! Structured grids of points in and out of files.

use crate::arrays;
use crate::error::{format_error, model_error, plain_error};
use crate::work::unlocked;
use moldloft::diag::Sources;
use moldloft::export::{ExportFailure, format_named};
use moldloft::io::plot3d::{self, Laid, Variant};
use moldloft::io::points::{self, PointLayout};
use moldloft::io::section::{self, Listing};
use moldloft::io::{StructuredGrid, cgns, stl, vtk};
use moldloft::num::Vec3;
use numpy::ndarray::{Array4, ArrayView4};
use numpy::{PyArray2, PyArray4, PyReadonlyArray2, PyReadonlyArray4, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// Numbers (ni, nj, nk, c) as planes, i fastest.
fn planes(a: &ArrayView4<'_, f64>) -> Vec<Vec<f64>> {
    let &[ni, nj, nk, parts] = a.shape() else { return Vec::new() };
    let plane = |c: usize| {
        let across = (0..nk).flat_map(|k| (0..nj).map(move |j| (j, k)));
        let along = across.flat_map(|(j, k)| (0..ni).map(move |i| (i, j, k)));
        along.map(|(i, j, k)| a[[i, j, k, c]]).collect()
    };
    (0..parts).map(plane).collect()
}

/// A grid of shape (ni, nj, nk, 3).
fn grid(given: &PyReadonlyArray4<'_, f64>) -> PyResult<StructuredGrid> {
    let a = given.as_array();
    let &[ni, nj, nk, 3] = a.shape() else {
        let found = a.shape();
        return Err(plain_error(format!("a grid has the shape (ni, nj, nk, 3), found {found:?}")));
    };
    let planes = planes(&a).try_into().unwrap_or_default();
    Ok(StructuredGrid { size: [ni, nj, nk], planes, iblank: None })
}

fn grids(given: &[PyReadonlyArray4<'_, f64>]) -> PyResult<Vec<StructuredGrid>> {
    given.iter().map(grid).collect()
}

fn array<'py>(py: Python<'py>, block: &StructuredGrid) -> Bound<'py, PyArray4<f64>> {
    let [ni, nj, nk] = block.size;
    let at = |(i, j, k, c): (usize, usize, usize, usize)| block.planes[c][(k * nj + j) * ni + i];
    Array4::from_shape_fn((ni, nj, nk, 3), at).to_pyarray(py)
}

/// The blocks of a Plot3D file of any variant, as arrays (ni, nj, nk, 3), and the variant.
#[pyfunction]
pub fn read_plot3d<'py>(
    py: Python<'py>,
    data: &[u8],
) -> PyResult<(Vec<Bound<'py, PyArray4<f64>>>, Bound<'py, PyDict>)> {
    let data = data.to_vec();
    let (blocks, variant) = unlocked(py, move || plot3d::read(&data))?.map_err(format_error)?;
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

/// The zones of a CGNS file: names and arrays (ni, nj, nk, 3).
#[pyfunction]
pub fn read_cgns<'py>(
    py: Python<'py>,
    data: &[u8],
) -> PyResult<Vec<(String, Bound<'py, PyArray4<f64>>)>> {
    let data = data.to_vec();
    let zones = unlocked(py, move || cgns::read(&data))?.map_err(format_error)?;
    Ok(zones.iter().map(|zone| (zone.name.clone(), array(py, &zone.grid))).collect())
}

/// A CGNS file of surfaces (ni, nj, 1, 3), whose edges join within a distance relative to the size of the whole.
#[pyfunction]
pub fn write_cgns<'py>(
    py: Python<'py>,
    surfaces: Vec<PyReadonlyArray4<'py, f64>>,
    names: Vec<String>,
    title: String,
    tolerance: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let grids = grids(&surfaces)?;
    let bytes = unlocked(py, move || cgns::write_surfaces(&grids, &names, &title, tolerance))?;
    let bytes = bytes
        .map_err(|e| model_error(&ExportFailure::from(e).diagnostics("cgns"), &Sources::new()))?;
    Ok(PyBytes::new(py, &bytes))
}

/// A Plot3D file of arrays (ni, nj, nk, 3).
#[pyfunction]
#[pyo3(signature = (blocks, layout, double, multi, three, iblank, big_endian, mark, planes))]
#[allow(clippy::too_many_arguments)]
pub fn write_plot3d<'py>(
    py: Python<'py>,
    blocks: Vec<PyReadonlyArray4<'py, f64>>,
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
            return Err(plain_error(format!(
                "unknown layout `{other}`; expected one of: {expected}"
            )));
        }
    };
    let mut blocks = grids(&blocks)?;
    let given = iblank.is_some();
    for (block, blank) in blocks.iter_mut().zip(iblank.into_iter().flatten()) {
        block.iblank = blank;
    }
    let variant = Variant { laid, double, multi, three, iblank: given, big_endian, mark, planes };
    let bytes = unlocked(py, move || plot3d::write(&blocks, variant))?.map_err(plain_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// The files of named grids in a format, the first of them under the name `main`: name and content of each.
#[pyfunction]
pub fn write_grids<'py>(
    py: Python<'py>,
    blocks: Vec<PyReadonlyArray4<'py, f64>>,
    names: Vec<String>,
    format: &str,
    main: &str,
) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
    let format = format_named(format).map_err(|d| plain_error(&d.message))?;
    let (blocks, main) = (grids(&blocks)?, main.to_string());
    let files =
        unlocked(py, move || moldloft::export::write_grids(&blocks, &names, format, &main))?;
    let files = files.map_err(|d| model_error(&d, &Sources::new()))?;
    Ok(files.into_iter().map(|f| (f.name, PyBytes::new(py, &f.bytes))).collect())
}

/// One VTK structured grid with named numbers (ni, nj, nk, parts) at its points.
#[pyfunction]
pub fn grid_with_fields<'py>(
    py: Python<'py>,
    points: PyReadonlyArray4<'py, f64>,
    fields: Vec<(String, PyReadonlyArray4<'py, f64>)>,
) -> PyResult<Bound<'py, PyBytes>> {
    let field = |(name, given): &(String, PyReadonlyArray4<'py, f64>)| {
        let planes = planes(&given.as_array());
        let count = planes.first().map_or(0, Vec::len);
        let values = (0..count).flat_map(|k| planes.iter().map(move |plane| plane[k])).collect();
        vtk::VtkArray { name: name.clone(), components: planes.len(), values }
    };
    let fields: Vec<vtk::VtkArray> = fields.iter().map(field).collect();
    let points = grid(&points)?;
    let bytes = unlocked(py, move || vtk::grid_with_fields(&points, &fields))?;
    let bytes = bytes.map_err(plain_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// A binary STL of surface grids.
#[pyfunction]
pub fn grids_as_stl<'py>(
    py: Python<'py>,
    blocks: Vec<PyReadonlyArray4<'py, f64>>,
    name: &str,
    flip: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let (blocks, name) = (grids(&blocks)?, name.to_string());
    let bytes = unlocked(py, move || stl::write_grids(&blocks, &name, flip, &|| true))?;
    let bytes = bytes.map_err(plain_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// Rows of coordinates in text: points (n, 3), and the properties of the text.
#[pyfunction]
pub fn read_points<'py>(
    py: Python<'py>,
    data: &[u8],
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
    let data = data.to_vec();
    let table = unlocked(py, move || points::read(&data))?.map_err(format_error)?;
    let dict = PyDict::new(py);
    dict.set_item("columns", table.columns)?;
    dict.set_item("lines", table.lines)?;
    let blocks: Vec<(usize, usize)> = table.blocks.iter().map(|b| (b.start, b.end)).collect();
    dict.set_item("blocks", blocks)?;
    dict.set_item("head", table.head)?;
    dict.set_item("delimiter", table.delimiter.map(String::from))?;
    dict.set_item("halves", table.halves.map(|[upper, lower]| (upper, lower)))?;
    let rows = arrays::filled(py, [table.rows.len(), 3], |out| out.copy_from_slice(&table.rows)).0;
    Ok((rows, dict))
}

/// The text of points (n, 2) or (n, 3).
#[pyfunction]
pub fn points_text(
    py: Python<'_>,
    rows: PyReadonlyArray2<'_, f64>,
    separator: String,
    head: Vec<String>,
    blocks: Vec<(usize, usize)>,
    halves: Option<[usize; 2]>,
) -> PyResult<String> {
    let (rows, columns) = point_rows(&rows)?;
    let blocks = blocks.into_iter().map(|(first, end)| first..end).collect();
    let layout = PointLayout { head, separator, blocks, halves };
    unlocked(py, move || points::write(&rows, columns, &layout))
}

/// Points (n, 2) or (n, 3) as a table under the names of its columns.
#[pyfunction]
pub fn points_csv(py: Python<'_>, rows: PyReadonlyArray2<'_, f64>) -> PyResult<String> {
    let (rows, columns) = point_rows(&rows)?;
    unlocked(py, move || points::write_csv(&rows, columns))
}

fn point_rows(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<(Vec<Vec3>, usize)> {
    let a = rows.as_array();
    let columns = a.ncols();
    if !matches!(columns, 2 | 3) {
        let found = a.shape();
        return Err(plain_error(format!("points have 2 or 3 columns, found an array {found:?}")));
    }
    let row = |r: numpy::ndarray::ArrayView1<'_, f64>| {
        Vec3::of(r[0], r[1], if columns == 3 { r[2] } else { 0.0 })
    };
    Ok((a.outer_iter().map(row).collect(), columns))
}

/// An aerofoil section: its name, points, index of the nose and listing.
#[pyfunction]
pub fn read_aerofoil(
    py: Python<'_>,
    data: &[u8],
) -> PyResult<(String, Vec<[f64; 3]>, usize, &'static str)> {
    let data = data.to_vec();
    let found = unlocked(py, move || section::read_aerofoil(&data))?.map_err(format_error)?;
    let listing = match found.listing {
        Listing::Selig => "selig",
        Listing::Lednicer => "lednicer",
    };
    let points = found.points.into_iter().map(Vec3::to_array).collect();
    Ok((found.name, points, found.nose, listing))
}
