//! Faces of files of other programs: one parametrisation along common edges, and the edges that are common.

use crate::error::plain_error;
use moldloft::brep::imported::{
    self, EdgeContact, ImportedFace, ImportedSide, NurbsPoints, SideName,
};
use moldloft::num::{Pace, Vec3};
use moldloft::spline::KnotVector;
use moldloft::spline::nurbs::Nurbs;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Degrees, knots, control points `(n, 3)` and weights.
#[derive(FromPyObject)]
pub struct NurbsData<'py>(
    Vec<usize>,
    Vec<PyReadonlyArray1<'py, f64>>,
    PyReadonlyArray2<'py, f64>,
    Option<PyReadonlyArray1<'py, f64>>,
);

impl NurbsData<'_> {
    fn nurbs<const D: usize>(&self) -> PyResult<Nurbs<D>> {
        let Self(degrees, knots, points, weights) = self;
        let points = points.as_slice()?.chunks_exact(3);
        let points: Vec<Vec3> = points.map(|p| Vec3::of(p[0], p[1], p[2])).collect();
        let weights = weights.as_ref().map(|w| w.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let knots: Vec<Vec<f64>> =
            knots.iter().map(|k| Ok(k.as_slice()?.to_vec())).collect::<PyResult<_>>()?;
        let axes = || knots.iter().zip(degrees);
        let count: usize = axes().map(|(k, p)| k.len().saturating_sub(p + 1)).product();
        let fits = (degrees.len(), knots.len()) == (D, D)
            && points.len() == count
            && weights.as_ref().is_none_or(|w| w.len() == count)
            && axes().all(|(k, &p)| KnotVector::new(p, k.clone()).is_ok());
        if !fits {
            return Err(plain_error("the knots do not fit the control points"));
        }
        Ok(Nurbs {
            degrees: std::array::from_fn(|d| degrees[d]),
            knots: std::array::from_fn(|d| knots[d].clone()),
            points,
            weights,
            error: 0.0,
            exact: true,
            paces: [Pace::Even; D],
        })
    }
}

/// A path as a dictionary.
fn path_data<'py>(py: Python<'py>, path: &Nurbs<1>) -> PyResult<Bound<'py, PyDict>> {
    crate::nurbs::data(py, path)
}

/// A surface, a flag for a face that covers it, and loops of (edge, backwards, path, tolerance).
#[derive(FromPyObject)]
pub struct FaceData<'py>(NurbsData<'py>, bool, Vec<Vec<(usize, bool, NurbsData<'py>, f64)>>);

impl FaceData<'_> {
    fn face(&self) -> PyResult<ImportedFace> {
        let side = |(edge, backwards, path, tolerance): &(usize, bool, NurbsData, f64)| {
            let path = path.nurbs()?;
            Ok(ImportedSide { edge: *edge, backwards: *backwards, path, tolerance: *tolerance })
        };
        let loops: PyResult<Vec<Vec<ImportedSide>>> =
            self.2.iter().map(|cycle| cycle.iter().map(side).collect()).collect();
        Ok(ImportedFace { surface: self.0.nurbs()?, loops: loops?, natural: self.1 })
    }
}

fn faces_of(faces: &[FaceData]) -> PyResult<Vec<ImportedFace>> {
    faces.iter().map(FaceData::face).collect()
}

/// Face, loop and side, and the path.
type NewPath<'py> = (usize, usize, usize, Bound<'py, PyDict>);

/// One parametrisation of the sides along common edges: which faces cover their surfaces now, and the new paths.
#[pyfunction]
pub fn aligned_faces<'py>(
    py: Python<'py>,
    faces: Vec<FaceData<'py>>,
) -> PyResult<(Vec<bool>, Vec<NewPath<'py>>)> {
    let mut faces = faces_of(&faces)?;
    let changed = py.detach(|| imported::align(&mut faces));
    let path = |(f, c, k): (usize, usize, usize)| {
        Ok((f, c, k, path_data(py, &faces[f].loops[c][k].path)?))
    };
    let paths: PyResult<Vec<_>> = changed.into_iter().map(path).collect();
    Ok((faces.iter().map(|face| face.natural).collect(), paths?))
}

/// The name of a side in a program.
fn side_name(side: SideName) -> String {
    match side {
        SideName::Border(axis, held) => format!(".{}{held}", if axis == 0 { 'u' } else { 'v' }),
        SideName::Snake(c, k) => format!("_s{c}_{k}"),
    }
}

/// Kind, faces, names of sides and distance of an edge of several faces.
type Contact = (&'static str, Vec<usize>, Vec<String>, f64);

/// Two sides by face and name.
type SidePair = [(usize, String); 2];

/// The edges of several faces, as (kind, faces, sides, distance), and sides that are one point within `near`: pairs, and
/// faces of others.
#[pyfunction]
pub fn common_sides(
    py: Python<'_>,
    faces: Vec<FaceData<'_>>,
    near: f64,
) -> PyResult<(Vec<Contact>, Vec<SidePair>, Vec<usize>)> {
    let faces = faces_of(&faces)?;
    let (found, (pairs, alone)) =
        py.detach(|| (imported::contacts(&faces), imported::poles(&faces, near)));
    let contact = |contact: EdgeContact| match contact {
        EdgeContact::Joined { sides, gap, by_tolerance } => {
            let kind = if by_tolerance { "tolerated" } else { "joined" };
            let names = sides.map(|(_, side)| side_name(side)).to_vec();
            (kind, sides.map(|(face, _)| face).to_vec(), names, gap)
        }
        EdgeContact::Seam { face } => ("seam", vec![face], Vec::new(), 0.0),
        EdgeContact::Apart { faces, gap } => ("apart", faces.to_vec(), Vec::new(), gap),
        EdgeContact::Part { face } => ("part", vec![face], Vec::new(), 0.0),
    };
    let named = |(face, side): (usize, SideName)| (face, side_name(side));
    Ok((
        found.into_iter().map(contact).collect(),
        pairs.into_iter().map(|pair| pair.map(named)).collect(),
        alone,
    ))
}

/// Each path as an edge of the square of parameters, if it is the same curve in space within its distance.
#[pyfunction]
pub fn on_border<'py>(
    py: Python<'py>,
    surface: NurbsData<'py>,
    paths: Vec<(NurbsData<'py>, f64)>,
) -> PyResult<Vec<Option<Bound<'py, PyDict>>>> {
    let surface = NurbsPoints::new(&surface.nurbs::<2>()?);
    let on = |(path, near): &(NurbsData, f64)| {
        let found = imported::on_border(&surface, &path.nurbs()?, *near);
        found.map(|path| path_data(py, &path)).transpose()
    };
    paths.iter().map(on).collect()
}
