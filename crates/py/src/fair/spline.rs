//! Spline curves and their interrogation.

use super::arguments::{fair_error, floats, long, measure, refused, space, vectors};
use super::solve;
use crate::arrays;
use moldloft::fair::shape::{self, Sample};
use moldloft::fair::{
    DataFinding, Finding, Job, KnotJumps, ParameterSpacing, PointSpacing, Space, fit, fit_rational,
    interpolate_with_corners, least_squares, parameters, surface,
};
use moldloft::num::Vec3;
use numpy::ndarray::Array1;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A spline curve, open or closed, of any degree and knots, with weights or without.
#[pyclass(frozen, module = "moldloft._core")]
pub struct Spline {
    pub space: Space,
    pub points: Vec<Vec3>,
    pub weights: Option<Vec<f64>>,
}

/// A spacing other than by the turns of a curve.
pub fn spacing(name: &str, direction: [f64; 3]) -> PyResult<ParameterSpacing> {
    match solve::point_spacing(name, direction)? {
        PointSpacing::Given(spacing) => Ok(spacing),
        _ => Err(refused(format!("spacing `{name}` is of one curve near its points"))),
    }
}

fn rows<'py>(py: Python<'py>, points: &[Vec3]) -> Bound<'py, PyArray2<f64>> {
    arrays::filled(py, [points.len(), 3], |out| out.copy_from_slice(points)).0
}

/// Parameters in a space's knots as parameters in [0, 1].
fn shares(space: &Space, at: &[f64]) -> Vec<f64> {
    let (a, b) = space.domain();
    let share = |&t: &f64| {
        let t = (t - a) / (b - a);
        if space.is_closed() { t.rem_euclid(1.0) } else { t }
    };
    at.iter().map(share).collect()
}

impl Spline {
    /// A parameter of [0, 1] in the space's own knots.
    fn own(&self, t: f64) -> f64 {
        let (a, b) = self.space.domain();
        a + (b - a) * t
    }

    fn samples(&self, per_span: usize) -> Vec<Sample> {
        shape::samples(&self.space, &self.points, self.weights.as_deref(), per_span.max(1))
    }

    /// The curve with a tolerance that does not matter.
    fn job(&self) -> PyResult<Job> {
        let mut job = Job::new(self.space.clone(), self.points.clone(), 0.0).map_err(fair_error)?;
        job.weights.clone_from(&self.weights);
        job.check().map_err(fair_error)?;
        Ok(job)
    }

    fn reported<'py>(&self, py: Python<'py>, samples: &[Sample]) -> PyResult<Bound<'py, PyDict>> {
        let (a, b) = self.space.domain();
        let dict = PyDict::new(py);
        let numbers = |f: &dyn Fn(&Sample) -> f64| -> Bound<'py, PyArray1<f64>> {
            samples.iter().map(f).collect::<Vec<f64>>().to_pyarray(py)
        };
        let points: Vec<Vec3> = samples.iter().map(|s| s.point).collect();
        dict.set_item("t", numbers(&|s| (s.t - a) / (b - a)))?;
        dict.set_item("points", rows(py, &points))?;
        for (k, name) in ["first", "second", "third"].into_iter().enumerate() {
            let scale = (b - a).powi(k as i32 + 1);
            let vectors: Vec<Vec3> = samples.iter().map(|s| s.derivatives[k] * scale).collect();
            dict.set_item(name, rows(py, &vectors))?;
        }
        // Whether the curve is plane depends on all of it.
        let normal = shape::plane_normal(&self.samples(4));
        let curvature = |s: &Sample| match normal {
            Some(n) => s.signed_curvature(n),
            None => s.curvature(),
        };
        dict.set_item("curvature", numbers(&curvature))?;
        dict.set_item("torsion", numbers(&Sample::torsion))?;
        let slope = |s: &Sample| normal.map_or(f64::NAN, |n| s.curvature_slope(n));
        dict.set_item("curvature_slope", numbers(&slope))?;
        dict.set_item("plane", normal.map(|n| n.to_array()))?;
        Ok(dict)
    }
}

#[pymethods]
impl Spline {
    /// `form`: "floating", "clamped" or "closed" uniform knots, if none are given.
    #[new]
    #[pyo3(signature = (points, degree, form, knots=None, weights=None, period=None))]
    fn new(
        points: PyReadonlyArray2<'_, f64>,
        degree: usize,
        form: &str,
        knots: Option<PyReadonlyArray1<'_, f64>>,
        weights: Option<PyReadonlyArray1<'_, f64>>,
        period: Option<f64>,
    ) -> PyResult<Self> {
        let points = vectors(&points)?;
        let space = space(degree, points.len(), form, floats(knots), period).map_err(fair_error)?;
        let spline = Self { space, points, weights: floats(weights) };
        spline.job()?;
        Ok(spline)
    }

    /// The spline through points, its parameters in [0, 1], and which control points are breaks.
    #[staticmethod]
    fn interpolate<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        degree: usize,
        spaced: &str,
        closed: bool,
        breaks: Vec<usize>,
        direction: [f64; 3],
    ) -> PyResult<(Self, Bound<'py, PyArray1<f64>>, Vec<usize>)> {
        let points = vectors(&points)?;
        let spaced = spacing(spaced, direction)?;
        let sharp =
            long(py, move || interpolate_with_corners(degree, &points, spaced, closed, &breaks))?;
        let at = shares(&sharp.fit.space, &sharp.at).to_pyarray(py);
        let spline = Self { space: sharp.fit.space, points: sharp.points, weights: None };
        Ok((spline, at, sharp.marks))
    }

    /// Data faired under tolerances: the faired spline, the one through the data, and the report.
    #[staticmethod]
    fn fair_data<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Self, Self, Bound<'py, PyDict>)> {
        solve::data(py, vectors(&points)?, &options)
    }

    /// The spline with `count` control points nearest to points; parameters, largest and rms
    /// distance.
    #[staticmethod]
    fn least_squares<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        degree: usize,
        count: usize,
        spaced: &str,
        closed: bool,
    ) -> PyResult<(Self, Bound<'py, PyArray1<f64>>, f64, f64)> {
        let points = vectors(&points)?;
        let spaced = spacing(spaced, [0.0; 3])?;
        let fit = long(py, move || least_squares(degree, &points, count, spaced, closed))?;
        let at = shares(&fit.space, &fit.parameters).to_pyarray(py);
        let spline = Self { space: fit.space, points: fit.points, weights: None };
        Ok((spline, at, fit.largest, fit.rms))
    }

    /// The spline with these knots, or as many uniform ones as give `count` control points, and these
    /// weights, nearest to points at parameters in [0, 1] (or spaced); parameters, largest and rms
    /// distance.
    #[staticmethod]
    #[pyo3(signature = (points, degree, count, form, knots, weights, period, spaced, at))]
    #[expect(clippy::too_many_arguments, reason = "called by name from Python")]
    fn fit<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        degree: usize,
        count: usize,
        form: &str,
        knots: Option<PyReadonlyArray1<'py, f64>>,
        weights: Option<PyReadonlyArray1<'py, f64>>,
        period: Option<f64>,
        spaced: &str,
        at: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<(Self, Bound<'py, PyArray1<f64>>, f64, f64)> {
        let points = vectors(&points)?;
        let space = space(degree, count, form, floats(knots), period).map_err(fair_error)?;
        let (spaced, at, weights) = (spacing(spaced, [0.0; 3])?, floats(at), floats(weights));
        let own = weights.clone();
        let fit = long(py, move || {
            let at = match at {
                Some(at) => at,
                None => parameters(&points, spaced, space.is_closed())?,
            };
            let (a, b) = space.domain();
            let at = at.into_iter().map(|t| a + (b - a) * t).collect();
            match own {
                Some(own) => fit_rational(space, &points, at, &own),
                None => {
                    let ones = vec![1.0; points.len()];
                    fit(space, &points, at, &ones)
                }
            }
        })?;
        let at = shares(&fit.space, &fit.parameters).to_pyarray(py);
        let spline = Self { space: fit.space, points: fit.points, weights };
        Ok((spline, at, fit.largest, fit.rms))
    }

    #[getter]
    fn degree(&self) -> usize {
        self.space.degree()
    }

    #[getter]
    fn closed(&self) -> bool {
        self.space.is_closed()
    }

    #[getter]
    fn clamped(&self) -> bool {
        self.space.is_clamped()
    }

    #[getter]
    fn knots<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.space.knots().to_pyarray(py)
    }

    /// Knots over [0, 1] and control points of the curve as an open spline.
    fn open_form<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Option<Vec<f64>>) {
        let (knots, places) = self.space.knot_vector();
        let points: Vec<Vec3> = places.iter().map(|&i| self.points[i]).collect();
        let weights = self.weights.as_ref().map(|w| places.iter().map(|&i| w[i]).collect());
        (knots.as_slice().to_pyarray(py), rows(py, &points), weights)
    }

    #[getter]
    fn domain(&self) -> (f64, f64) {
        self.space.domain()
    }

    #[getter]
    fn control_points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        rows(py, &self.points)
    }

    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.weights.as_ref().map(|w| w.to_pyarray(py))
    }

    /// Position, derivatives, curvature and torsion at parameters in [0, 1].
    fn at<'py>(
        &self,
        py: Python<'py>,
        t: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let ts: Vec<f64> = t.as_array().to_vec();
        if let Some(bad) = ts.iter().find(|t| !t.is_finite()) {
            return Err(refused(format!("a parameter is {bad}")));
        }
        let samples: Vec<Sample> = py.detach(|| {
            let weights = self.weights.as_deref();
            let (start, end) = self.space.domain();
            let one = |&t: &f64| {
                let mut sample = shape::sample_at(&self.space, &self.points, weights, self.own(t));
                // A closed space turns its end into its start.
                sample.t = start + (end - start) * t;
                sample
            };
            ts.iter().map(one).collect()
        });
        self.reported(py, &samples)
    }

    /// Position, derivatives, curvature and torsion on every span, ends of spans from both sides.
    fn spans<'py>(&self, py: Python<'py>, per_span: usize) -> PyResult<Bound<'py, PyDict>> {
        let samples = py.detach(|| self.samples(per_span));
        self.reported(py, &samples)
    }

    fn comb<'py>(
        &self,
        py: Python<'py>,
        scale: f64,
        per_span: usize,
    ) -> (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>) {
        let samples = self.samples(per_span);
        let points: Vec<Vec3> = samples.iter().map(|s| s.point).collect();
        (rows(py, &points), rows(py, &shape::comb(&samples, scale)))
    }

    fn orthotomic<'py>(
        &self,
        py: Python<'py>,
        p: [f64; 3],
        k: f64,
        per_span: usize,
    ) -> Bound<'py, PyArray2<f64>> {
        rows(py, &shape::orthotomic(&self.samples(per_span), p.into(), k))
    }

    fn logarithmic<'py>(&self, py: Python<'py>, per_span: usize) -> Bound<'py, PyArray2<f64>> {
        let graph = shape::logarithmic_graph(&self.samples(per_span));
        let array = Array1::from_iter(graph.iter().flat_map(|p| [p.radius, p.rate]));
        let flat = array.to_pyarray(py);
        flat.reshape([graph.len(), 2]).expect("two numbers a point")
    }

    /// The parameters of the knots in [0, 1], and the jump vectors there.
    fn jumps<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
        let job = self.job()?;
        let jumps = KnotJumps::of(&self.space);
        let own = job.own_rows(&jumps.rows);
        let relative = job.relative(&self.points);
        let vectors: Vec<Vec3> = (0..own.len()).map(|k| own.apply(k, &relative)).collect();
        let (a, b) = self.space.domain();
        let at: Vec<f64> =
            jumps.knots.iter().map(|&k| (self.space.knots()[k] - a) / (b - a)).collect();
        Ok((at.to_pyarray(py), rows(py, &vectors)))
    }

    fn measure(&self, name: &str) -> PyResult<f64> {
        self.job()?.value(measure(name)?, &self.points).map_err(fair_error)
    }

    fn length(&self, py: Python<'_>) -> f64 {
        py.detach(|| shape::arc_length(&self.space, &self.points, self.weights.as_deref()))
    }

    fn monotone_pieces(&self, share: f64, per_span: usize) -> usize {
        shape::monotone_pieces(&self.samples(per_span), share)
    }

    fn inflections(&self, per_span: usize) -> usize {
        shape::inflections(&self.samples(per_span))
    }

    /// Rows of word, control point, vector, sentence.
    fn findings(&self) -> PyResult<Vec<Reported>> {
        Ok(moldloft::fair::findings(&self.job()?).into_iter().map(reported).collect())
    }

    /// Fairs: the faired spline and the report.
    #[pyo3(signature = (options))]
    fn fair<'py>(
        &self,
        py: Python<'py>,
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        solve::curve(py, self, &options)
    }
}

/// A finding as a word, a control point, a vector and a sentence.
pub type Reported = (&'static str, usize, [f64; 3], String);

pub fn reported(finding: Finding) -> Reported {
    let text = finding.to_string();
    match finding {
        Finding::Corner { index, turn } => ("corner", index, turn.to_array(), text),
        Finding::Outlier { index, error } => ("outlier", index, error.to_array(), text),
    }
}

/// A finding about data as a word, a point, a vector and a sentence.
fn told_of(points: &[Vec3], finding: DataFinding) -> Reported {
    let text = finding.to_string();
    match finding {
        DataFinding::WrongDigit { index, expected, .. } => {
            ("outlier", index, (points[index] - expected).to_array(), text)
        }
        DataFinding::Knuckle { index, angle, .. } => ("corner", index, [angle, 0.0, 0.0], text),
        DataFinding::Swapped { index } => ("order", index, [0.0; 3], text),
    }
}

/// Findings among data at any spacing: kind, point, vector, sentence.
#[pyfunction]
pub fn data_findings(points: PyReadonlyArray2<'_, f64>, closed: bool) -> PyResult<Vec<Reported>> {
    let points = vectors(&points)?;
    let found = moldloft::fair::data_findings(&points, closed);
    Ok(found.into_iter().map(|f| told_of(&points, f)).collect())
}

/// Findings along lines through numbered points (each its points and whether it is closed), except
/// at marked points: the line, and the rest as for `data_findings`.
#[pyfunction]
pub fn line_findings(
    points: PyReadonlyArray2<'_, f64>,
    lines: Vec<(Vec<usize>, bool)>,
    marked: Vec<usize>,
) -> PyResult<Vec<(usize, Reported)>> {
    let points = vectors(&points)?;
    check_lines(&points, &lines)?;
    let found = moldloft::fair::line_findings(&points, &lines, &marked);
    Ok(found.into_iter().map(|(line, f)| (line, told_of(&points, f))).collect())
}

/// The knuckles among these findings as what lines share: of each the line that turns and its point.
#[pyfunction]
pub fn shared_knuckles(
    points: PyReadonlyArray2<'_, f64>,
    lines: Vec<(Vec<usize>, bool)>,
) -> PyResult<Vec<(usize, usize)>> {
    let points = vectors(&points)?;
    check_lines(&points, &lines)?;
    let found = moldloft::fair::line_findings(&points, &lines, &[]);
    Ok(moldloft::fair::shared_knuckles(&lines, &found))
}

/// True if the points between breaks are exact; see `moldloft::fair::is_exact`.
#[pyfunction]
pub fn is_exact(
    points: PyReadonlyArray2<'_, f64>,
    breaks: Vec<usize>,
    closed: bool,
) -> PyResult<bool> {
    Ok(moldloft::fair::is_exact(&vectors(&points)?, &breaks, closed))
}

/// True for each of the lines through numbered points, each its points and whether it is closed.
#[pyfunction]
pub fn are_exact(
    points: PyReadonlyArray2<'_, f64>,
    lines: Vec<(Vec<usize>, bool)>,
    breaks: Vec<usize>,
) -> PyResult<bool> {
    let points = vectors(&points)?;
    check_lines(&points, &lines)?;
    Ok(moldloft::fair::are_exact(&points, &lines, &breaks))
}

fn check_lines(points: &[Vec3], lines: &[(Vec<usize>, bool)]) -> PyResult<()> {
    match lines.iter().flat_map(|l| &l.0).find(|&&i| i >= points.len()) {
        Some(i) => Err(refused(format!("there is no point {}", i + 1))),
        None => Ok(()),
    }
}

/// The smallest error of each point that would be found.
#[pyfunction]
pub fn detectable<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    closed: bool,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    Ok(moldloft::fair::detectable(&vectors(&points)?, closed).to_pyarray(py))
}

/// The number of monotone runs of a list of numbers; see `moldloft::fair::shape::monotone_runs`.
#[pyfunction]
pub fn monotone_runs(values: PyReadonlyArray1<'_, f64>, share: f64) -> PyResult<usize> {
    let values = values.as_array().to_vec();
    if values.is_empty() || values.iter().any(|v| !v.is_finite()) {
        return Err(refused("expected finite numbers, at least one"));
    }
    Ok(shape::monotone_runs(&values, share))
}

/// Second divided differences.
#[pyfunction]
pub fn divided_differences<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    t: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let t = t.as_array().to_vec();
    let out = shape::divided_differences(&vectors(&points)?, &t).map_err(fair_error)?;
    Ok(rows(py, &out))
}

/// The metric eta_y of a plane grid, flat.
#[pyfunction]
pub fn eta_y<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    m: usize,
    n: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let out = surface::eta_y(&vectors(&points)?, m, n).map_err(fair_error)?;
    Ok(out.to_pyarray(py))
}
