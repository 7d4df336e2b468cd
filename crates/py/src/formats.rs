//! The table of formats, and B-spline patches as arrays.

use crate::arrays;
use crate::error::plain_error;
use moldloft::export::{FORMATS, Format, SplinePatch, SymmetryPlanes};
use moldloft::num::Vec3;
use numpy::{PyArray1, PyArray3, PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The rows of the table, as dictionaries.
#[pyfunction]
pub fn formats(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |format: &Format| {
        let dict = PyDict::new(py);
        dict.set_item("name", format.name)?;
        dict.set_item("aliases", format.aliases.to_vec())?;
        dict.set_item("suffix", format.suffix)?;
        dict.set_item("other_suffix", format.other_suffix)?;
        dict.set_item("about", format.about)?;
        dict.set_item("holds", format.holds.word())?;
        let symmetry = match format.symmetry {
            SymmetryPlanes::None => "",
            SymmetryPlanes::Y => "y",
            SymmetryPlanes::YThenX => "y, xy",
            SymmetryPlanes::Either => "x, y",
            SymmetryPlanes::Both => "x, y, xy",
        };
        dict.set_item("symmetry", symmetry)?;
        dict.set_item("lids", format.asks_for_lids())?;
        dict.set_item("immersed", format.immersed)?;
        dict.set_item("text", format.text)?;
        dict.set_item("of_grids", format.grids.is_some())?;
        Ok(dict)
    };
    FORMATS.iter().map(row).collect()
}

/// The knots of even spans of [-1, 1].
#[pyfunction]
pub fn spline_patch_knots(
    py: Python<'_>,
    degree: usize,
    spans: usize,
) -> PyResult<Bound<'_, PyArray1<f64>>> {
    if !(1..=16).contains(&degree) || spans == 0 {
        return Err(plain_error(format!("there are no knots of degree {degree} on {spans} spans")));
    }
    let knots = SplinePatch::uniform_knots(degree, spans);
    Ok(PyArray1::from_slice(py, knots.as_slice()))
}

/// Points (nu, nv, 3) of a patch on a grid of parameters in [-1, 1].
#[pyfunction]
pub fn spline_patch_grid<'py>(
    py: Python<'py>,
    degree: [usize; 2],
    points: PyReadonlyArray3<'py, f64>,
    u: PyReadonlyArray1<'py, f64>,
    v: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let a = points.as_array();
    let shape = [a.shape()[0], a.shape()[1]];
    let fits = (0..2).all(|k| (1..=16).contains(&degree[k]) && shape[k] > degree[k]);
    if !fits || a.shape()[2] != 3 {
        let found = a.shape();
        return Err(plain_error(format!(
            "no patch of degrees {degree:?} has the points {found:?}"
        )));
    }
    let spans = [shape[0] - degree[0], shape[1] - degree[1]];
    let places = (0..shape[0]).flat_map(|i| (0..shape[1]).map(move |j| (i, j)));
    let points = places.map(|(i, j)| Vec3::of(a[[i, j, 0]], a[[i, j, 1]], a[[i, j, 2]])).collect();
    let patch = SplinePatch { name: String::new(), degree, spans, points, deviation: 0.0 };
    let (us, vs) = (u.as_array().to_vec(), v.as_array().to_vec());
    arrays::room([us.len(), vs.len()], 2 * size_of::<Vec3>())?;
    let found = patch.grid(&us, &vs);
    Ok(arrays::filled(py, [us.len(), vs.len(), 3], |out| out.copy_from_slice(&found)).0)
}
