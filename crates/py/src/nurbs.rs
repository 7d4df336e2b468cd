//! NURBS and boundary representations as data.

use crate::arrays;
use crate::document::{PyDocument, wrong_class};
use crate::error::plain_error;
use crate::work::interruptible_shared;
use moldloft::brep::{Brep, SurfaceShape};
use moldloft::num::Vec3;
use moldloft::rows::Value;
use moldloft::spline::nurbs::{FitOptions, NotFitted, Nurbs, of_curve, of_solid, of_surface};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A NURBS as a dictionary.
pub fn data<'py, const D: usize>(
    py: Python<'py>,
    nurbs: &Nurbs<D>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("degrees", nurbs.degrees.to_vec())?;
    let knots = nurbs.knots.iter().map(|k| PyArray1::from_slice(py, k));
    dict.set_item("knots", PyList::new(py, knots)?)?;
    dict.set_item("counts", nurbs.counts().to_vec())?;
    let fill = |out: &mut [Vec3]| out.copy_from_slice(&nurbs.points);
    dict.set_item("points", arrays::filled(py, [nurbs.points.len(), 3], fill).0)?;
    let weights = nurbs.weights.as_ref().map(|w| PyArray1::from_slice(py, w));
    dict.set_item("weights", weights)?;
    dict.set_item("error", nurbs.error)?;
    dict.set_item("exact", nurbs.exact)?;
    let angle = |pace: &moldloft::num::Pace| match pace {
        moldloft::num::Pace::Even => 0.0,
        moldloft::num::Pace::Angle(angle) => *angle,
    };
    dict.set_item("angles", nurbs.paces.iter().map(angle).collect::<Vec<_>>())?;
    Ok(dict)
}

/// The largest coordinate of a shape, roughly, for the usual accuracy.
fn size(points: &[Vec3]) -> f64 {
    let bounds = moldloft::num::Box3::around(points.iter().copied());
    let size = bounds.diagonal();
    if size > 0.0 && size.is_finite() { size } else { 1.0 }
}

enum Made {
    Curve(Nurbs<1>),
    Surface(Nurbs<2>),
    Solid(Nurbs<3>),
}

/// The NURBS of a curve, snake, surface or solid.
#[pyfunction]
#[pyo3(signature = (document, name, accuracy, degree))]
pub fn nurbs<'py>(
    py: Python<'py>,
    document: &PyDocument,
    name: &str,
    accuracy: Option<f64>,
    degree: usize,
) -> PyResult<Bound<'py, PyDict>> {
    if !(1..=9).contains(&degree) {
        return Err(plain_error(format!("the degree of a fit is 1 to 9, not {degree}")));
    }
    let value = document.value(py, name)?;
    if !matches!(value, Value::Curve(_) | Value::Surface(_) | Value::Solid(_)) {
        return Err(wrong_class(name, "a NURBS is made of a curve, surface or solid", &value));
    }
    let even = [0.0, 0.25, 0.5, 0.75, 1.0];
    let work = move || -> Result<Made, NotFitted> {
        let options = |points: &[Vec3]| FitOptions {
            accuracy: accuracy.unwrap_or_else(|| 1e-6 * size(points)),
            degree,
        };
        match value {
            Value::Curve(curve) => {
                let mut points = vec![Vec3::zero(); 5];
                curve.grid(&even, &mut points);
                of_curve(&*curve, &options(&points)).map(Made::Curve)
            }
            Value::Surface(surface) => {
                let mut points = vec![Vec3::zero(); 25];
                surface.grid(&even, &even, &mut points, None);
                of_surface(&*surface, &options(&points)).map(Made::Surface)
            }
            Value::Solid(solid) => {
                let mut points = vec![Vec3::zero(); 125];
                solid.grid(&even, &even, &even, &mut points);
                of_solid(&*solid, Default::default(), &options(&points)).map(Made::Solid)
            }
            _ => unreachable!("checked above"),
        }
    };
    let made = interruptible_shared(py, document.budget(), work)?;
    match made.map_err(|e| plain_error(format!("`{name}` as a NURBS: {e}")))? {
        Made::Curve(n) => data(py, &n),
        Made::Surface(n) => data(py, &n),
        Made::Solid(n) => data(py, &n),
    }
}

/// The points of a NURBS at the given parameters, `(n, dimension)`; see [`moldloft::spline::nurbs::Nurbs`].
#[pyfunction]
pub fn nurbs_points<'py>(
    py: Python<'py>,
    degrees: Vec<usize>,
    knots: Vec<Vec<f64>>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    places: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    fn at<const D: usize>(
        degrees: &[usize],
        knots: Vec<Vec<f64>>,
        points: Vec<Vec3>,
        weights: Option<Vec<f64>>,
        places: &[f64],
    ) -> Vec<Vec3> {
        let shape = Nurbs::<D> {
            degrees: std::array::from_fn(|d| degrees[d]),
            knots: knots.try_into().expect("as many rows of knots as parameters"),
            points,
            weights,
            error: 0.0,
            exact: true,
            paces: [moldloft::num::Pace::Even; D],
        };
        let places: Vec<[f64; D]> =
            places.chunks_exact(D).map(|p| std::array::from_fn(|d| p[d])).collect();
        shape.scattered(&places)
    }
    let net: Vec<Vec3> =
        points.as_slice()?.chunks_exact(3).map(|p| Vec3::of(p[0], p[1], p[2])).collect();
    let weights = weights.map(|w| w.as_slice().map(<[f64]>::to_vec)).transpose()?;
    let at_all = places.as_slice()?;
    let count: usize =
        knots.iter().zip(&degrees).map(|(k, p)| (k.len()).saturating_sub(p + 1)).product();
    let fits = net.len() == count
        && weights.as_ref().is_none_or(|w| w.len() == count)
        && knots
            .iter()
            .zip(&degrees)
            .all(|(k, &p)| moldloft::spline::KnotVector::new(p, k.clone()).is_ok());
    let found = match degrees.len() {
        _ if !fits => return Err(plain_error("the knots do not fit the control points")),
        1 => at::<1>(&degrees, knots, net, weights, at_all),
        2 => at::<2>(&degrees, knots, net, weights, at_all),
        3 => at::<3>(&degrees, knots, net, weights, at_all),
        n => return Err(plain_error(format!("a NURBS has 1 to 3 parameters, not {n}"))),
    };
    Ok(arrays::filled(py, [found.len(), 3], |out| out.copy_from_slice(&found)).0)
}

/// The name of the model's unit of length, and its millimetres.
#[pyfunction]
pub fn length_unit(py: Python<'_>, document: &PyDocument) -> (String, f64) {
    document.unit(py)
}

/// The model's boundary representation; with `facing`, every face's normal is that of its surface.
#[pyfunction]
pub fn brep<'py>(
    py: Python<'py>,
    document: &PyDocument,
    accuracy: Option<f64>,
    stem: String,
    facing: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let brep = document.with_brep(py, accuracy, stem)?;
    let brep = if facing { brep.facing() } else { brep };
    let dict = PyDict::new(py);
    let fill = |out: &mut [Vec3]| out.copy_from_slice(&brep.vertices);
    dict.set_item("vertices", arrays::filled(py, [brep.vertices.len(), 3], fill).0)?;
    let edges: PyResult<Vec<_>> =
        brep.edges.iter().map(|e| Ok((e.ends[0], e.ends[1], data(py, &e.curve)?))).collect();
    dict.set_item("edges", edges?)?;
    let faces: PyResult<Vec<_>> = brep.faces.iter().map(|f| face(py, &brep, f)).collect();
    dict.set_item("faces", faces?)?;
    dict.set_item("parts", parts(py, &brep)?)?;
    dict.set_item("gap", brep.gap)?;
    Ok(dict)
}

fn face<'py>(
    py: Python<'py>,
    brep: &Brep,
    face: &moldloft::brep::BrepFace,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &face.name)?;
    dict.set_item("colour", face.colour)?;
    dict.set_item("layers", face.layers.clone())?;
    dict.set_item("reversed", face.reversed)?;
    dict.set_item("error", face.error)?;
    dict.set_item("exact", face.exact)?;
    match &face.surface {
        SurfaceShape::Plane { origin, normal, axis } => {
            let all = [origin, normal, axis].map(|v| v.to_array());
            dict.set_item("plane", all)?;
            dict.set_item("surface", py.None())?;
        }
        _ => {
            dict.set_item("plane", py.None())?;
            let surface = brep.nurbs(face);
            dict.set_item("surface", surface.map(|s| data(py, &s)).transpose()?)?;
        }
    }
    let mut loops = Vec::new();
    for cycle in &face.loops {
        let mut sides = Vec::new();
        for side in cycle {
            let trace = side.trace.as_ref().map(|t| data(py, t)).transpose()?;
            sides.push((side.edge, side.forward, trace, side.alike));
        }
        loops.push(sides);
    }
    dict.set_item("loops", loops)?;
    Ok(dict)
}

fn parts<'py>(py: Python<'py>, brep: &Brep) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let part = |part: &moldloft::brep::Part| {
        let dict = PyDict::new(py);
        dict.set_item("name", &part.name)?;
        let shells: Vec<_> = part.shells.iter().map(|s| (s.faces.clone(), s.closed)).collect();
        dict.set_item("shells", shells)?;
        let mut wires = Vec::new();
        for wire in &part.wires {
            wires.push((wire.name.clone(), wire.colour, data(py, &wire.curve)?));
        }
        dict.set_item("wires", wires)?;
        let points = part.points.iter().map(|p| (p.name.clone(), p.colour, p.place.to_array()));
        dict.set_item("points", points.collect::<Vec<_>>())?;
        Ok(dict)
    };
    brep.parts.iter().map(part).collect()
}
