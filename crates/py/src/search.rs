//! Nearest points and intersections of a model's curves and surfaces, for whole arrays at once.

use crate::arrays;
use crate::document::{PyDocument, wrong_class};
use crate::error::plain_error;
use crate::work::interruptible_shared;
use moldloft_locate::branches::{Branches, CutSurface};
use moldloft_locate::march::{Branch, Crossing, End};
use moldloft_locate::roots::{all_curve_curve, all_curve_surface, all_on_level};
use moldloft_locate::{
    Level, LocateStatus, Nearest, NearestCurve, NearestSurface, Roots, by_place,
};
use moldloft_num::{Plane, Vec3};
use moldloft_registry::{CurveRef, SurfaceRef, Value};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Points that a thread answers at a time.
const CHUNK: usize = 256;

/// More points than this are answered on another thread, so that Ctrl-C is heard.
const LARGE: usize = 50_000;

/// Prepared shapes that are kept.
const KEPT: usize = 64;

/// Shapes prepared for searches, by the name of their object; each with the shape it was made from.
#[derive(Default)]
pub struct Searches {
    surfaces: HashMap<String, (SurfaceRef<f64>, Arc<NearestSurface>)>,
    curves: HashMap<String, (CurveRef<f64>, Arc<NearestCurve>)>,
    cuts: HashMap<String, (SurfaceRef<f64>, Arc<CutSurface>)>,
}

/// The prepared shape of an object: that of an earlier call, when the object is still the same.
fn prepared<S: Clone + Sync, P: Send + Sync>(
    py: Python<'_>,
    searches: &Mutex<Searches>,
    name: &str,
    shape: &S,
    of: fn(&mut Searches) -> &mut HashMap<String, (S, Arc<P>)>,
    same: fn(&S, &S) -> bool,
    prepare: impl FnOnce(&S) -> P + Send,
) -> Arc<P> {
    let lock = || searches.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((kept, prepared)) = of(&mut lock()).get(name)
        && same(kept, shape)
    {
        return prepared.clone();
    }
    let made = Arc::new(py.detach(|| prepare(shape)));
    let mut held = lock();
    let map = of(&mut held);
    if map.len() >= KEPT {
        map.clear();
    }
    map.insert(name.to_owned(), (shape.clone(), made.clone()));
    made
}

fn code(status: LocateStatus) -> u8 {
    match status {
        LocateStatus::Ok | LocateStatus::Fallback => 0,
        LocateStatus::EdgeClamped => 1,
        LocateStatus::Multiple { .. } => 2,
        LocateStatus::Tangent => 3,
        LocateStatus::NoSolution | LocateStatus::Diverged => 4,
    }
}

/// Answers of many points, in their order.
fn answered<const N: usize>(
    py: Python<'_>,
    cancel: &Arc<AtomicBool>,
    points: Vec<Vec3>,
    answer: impl Fn(Vec3) -> Nearest<N> + Send + Sync + 'static,
) -> PyResult<Vec<Nearest<N>>> {
    let (stop, large) = (cancel.clone(), points.len() > LARGE);
    let all = move || -> Vec<Nearest<N>> {
        let chunk = |points: &[Vec3]| -> Vec<Nearest<N>> {
            if stop.load(Ordering::Relaxed) {
                return Vec::new();
            }
            points.iter().map(|p| answer(*p)).collect()
        };
        if points.len() <= CHUNK {
            return chunk(&points);
        }
        let order = by_place(&points);
        let sorted: Vec<Vec3> = order.iter().map(|&k| points[k as usize]).collect();
        let found: Vec<Nearest<N>> = sorted.par_chunks(CHUNK).flat_map_iter(chunk).collect();
        let Some(&first) = found.first() else { return found };
        let mut all = vec![first; points.len()];
        for (k, answer) in order.into_iter().zip(found) {
            all[k as usize] = answer;
        }
        all
    };
    if large { interruptible_shared(py, cancel, all) } else { Ok(py.detach(all)) }
}

type Answers<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u8>>,
);

/// Parameters (n, N), places (n, 3), distances and codes of statuses.
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
    let cancel = document.cancel_handle();
    let searches = document.searches();
    match document.value(py, name)? {
        Value::Surface(surface) => {
            let same = SurfaceRef::same;
            let prepare = |s: &SurfaceRef<f64>| NearestSurface::new(&**s);
            let found = prepared(py, searches, name, &surface, |s| &mut s.surfaces, same, prepare);
            let answer = move |p: Vec3| found.nearest(&*surface, p);
            arrays_of(py, &answered(py, cancel, points, answer)?)
        }
        Value::Curve(curve) => {
            let same = CurveRef::same;
            let prepare = |c: &CurveRef<f64>| NearestCurve::new(&**c);
            let found = prepared(py, searches, name, &curve, |s| &mut s.curves, same, prepare);
            let answer = move |p: Vec3| found.nearest(&*curve, p);
            arrays_of(py, &answered(py, cancel, points, answer)?)
        }
        other => Err(wrong_class(name, "a curve or a surface has nearest points", &other)),
    }
}

/// What something is intersected with.
enum With {
    Plane(Plane<f64>),
    Curve(CurveRef<f64>),
    Surface(SurfaceRef<f64>, Arc<CutSurface>),
}

fn cut(
    py: Python<'_>,
    document: &PyDocument,
    name: &str,
    surface: &SurfaceRef<f64>,
) -> Arc<CutSurface> {
    let prepare = |s: &SurfaceRef<f64>| CutSurface::new(&**s);
    let searches = document.searches();
    prepared(py, searches, name, surface, |s| &mut s.cuts, SurfaceRef::same, prepare)
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
            let cut = cut(py, other, other_name, &surface);
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
    let cancel = document.cancel_handle();
    match document.value(py, name)? {
        Value::Surface(surface) => {
            if let With::Curve(curve) = with {
                let roots = move || all_curve_surface(&*curve, &*surface);
                let roots = interruptible_shared(py, cancel, roots)?;
                // Ours are u and v, theirs is t.
                return points_dict(py, &roots, &[1, 2], &[0]);
            }
            let first = cut(py, document, name, &surface);
            let (found, two) = match with {
                With::Plane(plane) => {
                    let search = || {
                        let crossing = Crossing::with_plane(&*surface, plane);
                        crossing.branches_in(&first, None)
                    };
                    (py.detach(search), false)
                }
                With::Surface(other, second) => {
                    let search = move || {
                        let crossing = Crossing::with_surface(&*surface, &*other);
                        crossing.branches_in(&first, Some(&second))
                    };
                    (py.detach(search), true)
                }
                With::Curve(_) => unreachable!("curves were answered above"),
            };
            branches_dict(py, &found, two)
        }
        Value::Curve(curve) => match with {
            With::Plane(plane) => {
                let offset = plane.normal.dot(plane.point);
                let level = Level::Plane { normal: plane.normal, offset };
                let roots = py.detach(|| all_on_level(&*curve, &level));
                points_dict(py, &roots, &[0], &[])
            }
            With::Curve(other) => {
                let roots =
                    interruptible_shared(py, cancel, move || all_curve_curve(&*curve, &*other))?;
                let size = roots.roots.iter().map(|r| r.xyz.norm()).fold(1.0, f64::max);
                // Where curves do not meet, the search gives the place where they come nearest.
                let met = |r: &moldloft_locate::Root<2>| r.residual <= 1e-8 * size;
                let kept = roots.roots.iter().copied().filter(met).collect();
                points_dict(py, &Roots { roots: kept, ..roots }, &[0], &[1])
            }
            With::Surface(other, _) => {
                let roots =
                    interruptible_shared(py, cancel, move || all_curve_surface(&*curve, &*other))?;
                points_dict(py, &roots, &[0], &[1, 2])
            }
        },
        other => Err(wrong_class(name, "a curve or a surface has intersections", &other)),
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
fn points_dict<'py, const N: usize>(
    py: Python<'py>,
    roots: &Roots<N>,
    ours: &[usize],
    theirs: &[usize],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let part = |which: &[usize]| {
        let row = |r: &moldloft_locate::Root<N>| which.iter().map(|&k| r.at[k]).collect();
        rows(py, roots.roots.iter().map(row), which.len())
    };
    let xyz: Vec<Vec3> = roots.roots.iter().map(|r| r.xyz).collect();
    let tangent: Vec<bool> = roots.roots.iter().map(|r| r.tangent).collect();
    dict.set_item("branches", PyList::empty(py))?;
    dict.set_item("points", points_array(py, &xyz))?;
    dict.set_item("parameters", part(ours)?)?;
    dict.set_item("other", part(theirs)?)?;
    dict.set_item("tangent", PyArray1::from_vec(py, tangent))?;
    dict.set_item("complete", roots.complete)?;
    dict.set_item("smallest", 0.0)?;
    Ok(dict)
}

fn end_name(end: End) -> &'static str {
    match end {
        End::Edge { unknown: 0 | 1, .. } => "edge",
        End::Edge { .. } => "other-edge",
        End::Closed => "closed",
        End::Tangent => "tangent",
        End::Lost => "lost",
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
    dict.set_item("smallest", found.smallest)?;
    Ok(dict)
}
