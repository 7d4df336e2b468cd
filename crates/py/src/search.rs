//! Nearest points and intersections of a model's curves and surfaces, for whole arrays at once.

use crate::arrays;
use crate::document::{PyDocument, wrong_class};
use crate::error::plain_error;
use crate::work::interruptible_shared;
use moldloft::document::searches::{CommonPoints, Meeting, NearestPoints, With};
use moldloft::locate::branches::Branches;
use moldloft::locate::march::{Branch, BranchEnd};
use moldloft::locate::{LocateStatus, Nearest};
use moldloft::num::{Plane, Vec3};
use moldloft::rows::Value;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// More points than this are answered on another thread, so that Ctrl-C is heard.
const LARGE: usize = 50_000;

fn code(status: LocateStatus) -> u8 {
    match status {
        LocateStatus::Ok | LocateStatus::Fallback => 0,
        LocateStatus::EdgeClamped => 1,
        LocateStatus::Multiple { .. } => 2,
        LocateStatus::Tangent => 3,
        LocateStatus::NoSolution | LocateStatus::Unfinished | LocateStatus::Diverged => 4,
    }
}

type Answers<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u8>>,
);

/// Parameters (n, N), positions (n, 3), distances and codes of statuses.
fn arrays_of<'py, const N: usize>(
    py: Python<'py>,
    answers: &[Nearest<N>],
) -> PyResult<Answers<'py>> {
    let parameters: Vec<f64> = answers.iter().flat_map(|a| a.at).collect();
    let places = |out: &mut [Vec3]| out.iter_mut().zip(answers).for_each(|(o, a)| *o = a.xyz);
    let distances: Vec<f64> = answers.iter().map(|a| a.distance).collect();
    let codes: Vec<u8> = answers.iter().map(|a| code(a.status)).collect();
    Ok((
        PyArray1::from_vec(py, parameters).reshape([answers.len(), N])?,
        arrays::filled(py, [answers.len(), 3], places).0,
        PyArray1::from_vec(py, distances),
        PyArray1::from_vec(py, codes),
    ))
}

/// The points of a curve or surface that are nearest to given ones, (n, 3).
#[pyfunction]
pub fn nearest<'py>(
    py: Python<'py>,
    document: &PyDocument,
    name: &str,
    points: PyReadonlyArray2<'py, f64>,
) -> PyResult<Answers<'py>> {
    let numbers = points.as_slice()?;
    let points: Vec<Vec3> = numbers.chunks_exact(3).map(|p| Vec3::of(p[0], p[1], p[2])).collect();
    let (budget, searches) = (document.budget(), document.searches().clone());
    let value = document.value(py, name)?;
    let refused = wrong_class(name, "a curve or a surface has nearest points", &value);
    let (stop, large) = (budget.clone(), points.len() > LARGE);
    let key = name.to_owned();
    let search = move || searches.nearest(&key, &value, &points, &stop);
    let found = if large { interruptible_shared(py, budget, search)? } else { py.detach(search) };
    match found {
        Some(NearestPoints::Surface(found)) => arrays_of(py, &found),
        Some(NearestPoints::Curve(found)) => arrays_of(py, &found),
        None => Err(refused),
    }
}

/// The intersection of a curve or surface with an object of the same or another model.
#[pyfunction]
pub fn intersect<'py>(
    py: Python<'py>,
    document: &PyDocument,
    name: &str,
    other: &PyDocument,
    other_name: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let with = match other.value(py, other_name)? {
        Value::Surface(surface) => {
            let searches = other.searches();
            let cut = py.detach(|| searches.cut(other_name, &surface));
            With::Surface(surface, cut)
        }
        Value::Curve(curve) => With::Curve(curve),
        Value::Plane(plane) => With::Plane(*plane),
        found => {
            let takes = "a curve or surface is intersected with a plane, a curve or a surface";
            return Err(wrong_class(other_name, takes, &found));
        }
    };
    met(py, document, name, with)
}

/// The intersection of a curve or surface with the plane through a point across a normal.
#[pyfunction]
pub fn intersect_plane<'py>(
    py: Python<'py>,
    document: &PyDocument,
    name: &str,
    point: [f64; 3],
    normal: [f64; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let [point, normal] = [point, normal].map(Vec3::from);
    let Some(normal) = normal.normalized().filter(|n| n.is_finite() && point.is_finite()) else {
        let message = "a plane takes a point and a normal of finite numbers, the normal not zero";
        return Err(plain_error(message));
    };
    met(py, document, name, With::Plane(Plane { point, normal }))
}

fn met<'py>(
    py: Python<'py>,
    document: &PyDocument,
    name: &str,
    with: With,
) -> PyResult<Bound<'py, PyDict>> {
    let value = document.value(py, name)?;
    let refused = wrong_class(name, "a curve or a surface has intersections", &value);
    let (searches, key) = (document.searches().clone(), name.to_owned());
    let short = matches!(with, With::Plane(_));
    let search = move || searches.intersection(&key, &value, &with);
    let budget = document.budget();
    let found = if short { py.detach(search) } else { interruptible_shared(py, budget, search)? };
    match found {
        Some(Meeting::Points(points)) => points_dict(py, points),
        Some(Meeting::Branches(found, two)) => branches_dict(py, &found, two),
        None => Err(refused),
    }
}

fn points_array<'py>(py: Python<'py>, points: &[Vec3]) -> Bound<'py, PyArray2<f64>> {
    let fill = |out: &mut [Vec3]| out.copy_from_slice(points);
    arrays::filled(py, [points.len(), 3], fill).0
}

fn rows<'py>(
    py: Python<'py>,
    all: impl ExactSizeIterator<Item = Vec<f64>>,
    width: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let count = all.len();
    PyArray1::from_vec(py, all.flatten().collect()).reshape([count, width])
}

/// Isolated common points.
fn points_dict(py: Python<'_>, points: CommonPoints) -> PyResult<Bound<'_, PyDict>> {
    let CommonPoints { ours, theirs, widths, xyz, tangent, complete, nearest } = points;
    let dict = PyDict::new(py);
    dict.set_item("branches", PyList::empty(py))?;
    dict.set_item("points", points_array(py, &xyz))?;
    dict.set_item("parameters", rows(py, ours.into_iter(), widths[0])?)?;
    dict.set_item("other", rows(py, theirs.into_iter(), widths[1])?)?;
    dict.set_item("tangent", PyArray1::from_vec(py, tangent))?;
    dict.set_item("complete", complete)?;
    dict.set_item("nearest", nearest)?;
    dict.set_item("smallest", 0.0)?;
    Ok(dict)
}

fn end_name(end: BranchEnd) -> &'static str {
    match end {
        BranchEnd::Edge { unknown: 0 | 1, .. } => "edge",
        BranchEnd::Edge { .. } => "other-edge",
        BranchEnd::Closed => "closed",
        BranchEnd::Tangent => "tangent",
        BranchEnd::Lost => "lost",
    }
}

fn branch_dict<'py>(
    py: Python<'py>,
    branch: &Branch,
    width: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let stations = &branch.stations;
    let part = |first: usize, width: usize| {
        rows(py, stations.iter().map(|s| s.q[first..first + width].to_vec()), width)
    };
    let (xyz, tangents): (Vec<Vec3>, Vec<Vec3>) = stations.iter().map(|s| (s.x, s.tangent)).unzip();
    dict.set_item("points", points_array(py, &xyz))?;
    dict.set_item("tangents", points_array(py, &tangents))?;
    dict.set_item("parameters", part(0, 2)?)?;
    dict.set_item("other", part(2, width)?)?;
    dict.set_item("ends", branch.ends.map(end_name).to_vec())?;
    Ok(dict)
}

fn branches_dict<'py>(
    py: Python<'py>,
    found: &Branches,
    two: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let width = if two { 2 } else { 0 };
    let dict = PyDict::new(py);
    let branches: PyResult<Vec<_>> =
        found.branches.iter().map(|b| branch_dict(py, b, width)).collect();
    dict.set_item("branches", PyList::new(py, branches?)?)?;
    let xyz: Vec<Vec3> = found.touches.iter().map(|t| t.x).collect();
    let part = |first: usize, width: usize| {
        rows(py, found.touches.iter().map(|t| t.q[first..first + width].to_vec()), width)
    };
    dict.set_item("points", points_array(py, &xyz))?;
    dict.set_item("parameters", part(0, 2)?)?;
    dict.set_item("other", part(2, width)?)?;
    dict.set_item("tangent", PyArray1::from_vec(py, vec![true; xyz.len()]))?;
    dict.set_item("complete", found.complete)?;
    dict.set_item("nearest", None::<([f64; 2], f64)>)?;
    dict.set_item("smallest", found.smallest)?;
    Ok(dict)
}
