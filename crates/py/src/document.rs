//! A model with its text.

use crate::arrays::{self, Unshared};
use crate::blocks::PyBlocks;
use crate::diagnostics::PyDiagnostic;
use crate::error::{model_error, plain_error, unknown_name};
use crate::fair::Look;
use crate::mesh::PyMesh;
use crate::value::{arguments, to_python};
use crate::work::{interruptible, interruptible_shared};
use moldloft::budget::Budget;
use moldloft::diag::Sources;
use moldloft::document::searches::Searches;
use moldloft::document::{
    Adjustable, Attitude, Document, FloatAnswer, FloatRequest, FlotationOptions, Immersion,
    ModelFormat, WantedNumber,
};
use moldloft::export::{SplinePatch, WriteOptions, format_named, spline_patches, stated_length};
use moldloft::host::FileWorld;
use moldloft::model::Object;
use moldloft::num::{Order, Vec3};
use moldloft::rows::{CurveRef, SurfaceRef, Value};
use moldloft_parallel::prelude::*;
use numpy::ndarray::{Dim, Dimension, IntoDimension};
use numpy::{PyArray, PyArray2, PyArray3, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyBytes, PyDict};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Number of scattered points that a thread evaluates at a time.
const CHUNK: usize = 1 << 14;

/// A model that is at least this large is changed on another thread, so that Ctrl-C is heard.
const LARGE: usize = 50_000;

/// A model with its text.
#[pyclass(frozen, name = "Document", module = "moldloft._core")]
pub struct PyDocument {
    inner: Arc<Mutex<Document>>,
    budget: Arc<Budget>,
    /// True once the model may call Python: a run then needs Python's lock on another thread.
    calls_python: AtomicBool,
    /// Shapes prepared for searches.
    searches: Arc<Searches>,
}

/// A B-spline patch: name, degrees, spans, control points, deviation.
type PatchFacts<'py> = (String, [usize; 2], [usize; 2], Bound<'py, PyArray3<f64>>, f64);

type Outcome<R> = Result<R, Vec<moldloft::diag::Diagnostic>>;

impl PyDocument {
    fn new(document: Document) -> Self {
        let budget = document.budget();
        let inner = Arc::new(Mutex::new(document));
        Self { inner, budget, calls_python: AtomicBool::new(false), searches: Arc::default() }
    }

    fn lock<'a>(&'a self, py: Python<'_>) -> MutexGuard<'a, Document> {
        // A panic is our own bug and was shown as such; the document is still in one piece.
        self.inner.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Work that may take long.
    fn long<R: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Document) -> R + Send + 'static,
    ) -> PyResult<R> {
        let inner = self.inner.clone();
        interruptible_shared(py, &self.budget, move || {
            work(&mut inner.lock().unwrap_or_else(PoisonError::into_inner))
        })
    }

    /// Work that may take long or find fault.
    pub(crate) fn long_checked<R: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Document) -> Outcome<R> + Send + 'static,
    ) -> PyResult<R> {
        let outcome = self.long(py, move |document| {
            let outcome = work(document);
            outcome.map_err(|diagnostics| (diagnostics, document.sources().clone()))
        })?;
        outcome.map_err(|(diagnostics, sources)| model_error(&diagnostics, &sources))
    }

    /// The value of an object, without holding on to the document.
    pub(crate) fn value(&self, py: Python<'_>, name: &str) -> PyResult<Value<f64>> {
        let document = self.lock(py);
        let object = object_named(&document, name)?;
        match object.value() {
            Some(value) => Ok(value.clone()),
            None => Err(model_error(&document.diagnostics(), document.sources())),
        }
    }

    pub(crate) fn searches(&self) -> &Arc<Searches> {
        &self.searches
    }

    /// Limits of long work; also cancels it.
    pub(crate) fn budget(&self) -> &Arc<Budget> {
        &self.budget
    }

    /// The model as a boundary representation.
    pub(crate) fn with_brep(
        &self,
        py: Python<'_>,
        accuracy: Option<f64>,
        stem: String,
    ) -> PyResult<moldloft::brep::Brep> {
        self.long_checked(py, move |d| {
            moldloft::export::brep(d, accuracy, &stem).map_err(|e| e.diagnostics("nurbs"))
        })
    }

    /// The name of the unit of length, and its millimetres.
    pub(crate) fn unit(&self, py: Python<'_>) -> (String, f64) {
        moldloft::export::length_unit(&self.lock(py))
    }

    /// Many points in another thread, so that Ctrl-C is heard.
    fn many<'py, const K: usize, const N: usize>(
        &self,
        py: Python<'py>,
        shape: [usize; N],
        fill: impl FnOnce([&mut [Vec3]; K], &Budget) + Send + 'static,
    ) -> PyResult<[Bound<'py, PyArray<f64, Dim<[usize; N]>>>; K]>
    where
        [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
        Dim<[usize; N]>: Dimension,
    {
        // The last extent is that of a point.
        arrays::room([shape[0], shape[1..N - 1].iter().product()], K * size_of::<Vec3>())?;
        let budget = self.budget.clone();
        let mut made = [(); K].map(|()| Unshared::new(py, shape));
        let work = move || {
            fill(made.each_mut().map(Unshared::vectors), &budget);
            // Points that are left out are not answered: the time is over, or Ctrl-C has come.
            budget.poll().map(|()| made)
        };
        let made = interruptible_shared(py, &self.budget, work)?;
        let made = made.map_err(|spent| plain_error(format!("{spent}\nhelp: {}", spent.help())))?;
        Ok(made.map(|array| array.shared(py)))
    }

    fn surface_of(&self, py: Python<'_>, name: &str) -> PyResult<SurfaceRef<f64>> {
        match self.value(py, name)? {
            Value::Surface(surface) => Ok(surface),
            other => Err(wrong_class(name, "a surface takes u and v", &other)),
        }
    }

    fn curve_of(&self, py: Python<'_>, name: &str) -> PyResult<CurveRef<f64>> {
        match self.value(py, name)? {
            Value::Curve(curve) => Ok(curve),
            other => Err(wrong_class(name, "a curve takes t", &other)),
        }
    }
}

#[pymethods]
impl PyDocument {
    #[staticmethod]
    #[pyo3(signature = (path, library, edited = false))]
    fn open(py: Python<'_>, path: String, library: Vec<String>, edited: bool) -> PyResult<Self> {
        let world = Box::new(FileWorld::around(&path, &library));
        let budget = Arc::<Budget>::default();
        let own = budget.clone();
        let open = if edited { Document::open_edited } else { Document::open_within };
        let open = move || open(moldloft::document::registry(), world, &path, own);
        interruptible(py, &budget, open).map(Self::new)
    }

    #[staticmethod]
    #[pyo3(signature = (name, text, folder, library, edited = false))]
    fn from_text(
        py: Python<'_>,
        name: String,
        text: String,
        folder: Option<String>,
        library: Vec<String>,
        edited: bool,
    ) -> PyResult<Self> {
        let world = Box::new(FileWorld::new(folder.as_deref().map(Path::new), &library));
        let budget = Arc::<Budget>::default();
        let own = budget.clone();
        let begin = if edited { Document::edited } else { Document::from_text_within };
        let open = move || begin(moldloft::document::registry(), world, (&name, &text), own);
        interruptible(py, &budget, open).map(Self::new)
    }

    fn diagnostics(&self, py: Python<'_>) -> Vec<PyDiagnostic> {
        let document = self.lock(py);
        let sources = document.sources();
        document.diagnostics().iter().map(|d| d.to_data(sources).into()).collect()
    }

    /// Warnings about the last value of `eval`.
    fn expression_remarks(&self, py: Python<'_>) -> Vec<PyDiagnostic> {
        let document = self.lock(py);
        let sources = document.sources();
        document.expression_remarks().iter().map(|d| d.to_data(sources).into()).collect()
    }

    /// Parts of the model that the last written text or file does not keep.
    fn export_remarks(&self, py: Python<'_>) -> Vec<PyDiagnostic> {
        let document = self.lock(py);
        let sources = document.sources();
        document.export_remarks().iter().map(|d| d.to_data(sources).into()).collect()
    }

    fn has_errors(&self, py: Python<'_>) -> bool {
        self.lock(py).has_errors()
    }

    fn allow_partial(&self, py: Python<'_>, partial: bool) {
        self.lock(py).allow_partial(partial);
    }

    fn partial(&self, py: Python<'_>) -> bool {
        self.lock(py).partial()
    }

    fn is_whole(&self, py: Python<'_>) -> bool {
        self.lock(py).lacking().is_ok_and(|errors| errors.is_empty())
    }

    fn text(&self, py: Python<'_>) -> String {
        self.lock(py).text()
    }

    fn set_text(&self, py: Python<'_>, text: String) -> PyResult<()> {
        self.long(py, move |document| {
            document.set_text(&text);
        })
    }

    fn convert(&self, py: Python<'_>, to: &str) -> PyResult<String> {
        let format = match to {
            "sdl" => ModelFormat::Sdl,
            "ms2" => ModelFormat::ModelFile,
            _ => return Err(plain_error(format!("unknown form `{to}`; expected sdl or ms2"))),
        };
        self.long_checked(py, move |document| {
            let (text, remarks) = document.convert_with_remarks(format)?;
            document.set_export_remarks(remarks);
            Ok(text)
        })
    }

    /// Rows of name, value, default, low, high, whole.
    fn params(&self, py: Python<'_>) -> Vec<(String, f64, f64, Option<f64>, Option<f64>, bool)> {
        let document = self.lock(py);
        let row = |p: &moldloft::document::Param| {
            let (low, high) = p.range.unzip();
            (p.name.clone(), p.value, p.default, low, high, p.is_int)
        };
        document.params().iter().map(row).collect()
    }

    fn param(&self, py: Python<'_>, name: &str) -> Option<f64> {
        self.lock(py).params().iter().find(|p| p.name == name).map(|p| p.value)
    }

    fn set(&self, py: Python<'_>, assignments: Vec<(String, f64)>) -> PyResult<()> {
        let mut document = self.lock(py);
        if document.graph().len() >= LARGE || self.calls_python.load(Ordering::Relaxed) {
            drop(document);
            return self.long_checked(py, move |d| d.set(&assignments).map(drop));
        }
        match document.set(&assignments) {
            Ok(_) => Ok(()),
            Err(diagnostics) => Err(model_error(&diagnostics, document.sources())),
        }
    }

    fn evaluated(&self, py: Python<'_>) -> usize {
        self.lock(py).applied().evaluated
    }

    fn symmetry(&self, py: Python<'_>) -> String {
        self.lock(py).symmetry()
    }

    /// The names of the files that the model was read from.
    fn files(&self, py: Python<'_>) -> Vec<String> {
        let document = self.lock(py);
        let sources = document.sources();
        sources.ids().filter_map(|id| sources.name(id)).map(str::to_owned).collect()
    }

    fn names(&self, py: Python<'_>) -> Vec<String> {
        self.lock(py).graph().objects().map(|o| o.name.to_string()).collect()
    }

    fn has(&self, py: Python<'_>, name: &str) -> bool {
        self.lock(py).graph().find(name).is_some()
    }

    /// The parameter or object most like `name`.
    fn similar(&self, py: Python<'_>, name: &str) -> Option<String> {
        let document = self.lock(py);
        similar(&document, name)
    }

    fn object<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
        let document = self.lock(py);
        let object = object_named(&document, name)?;
        let graph = document.graph();
        let names = |keys: &mut dyn Iterator<Item = moldloft::num::trace::Key>| -> Vec<String> {
            keys.filter_map(|key| Some(graph.get(key)?.name.to_string())).collect()
        };
        let class = object.value().map_or(object.row.class, Value::class);
        let dict = PyDict::new(py);
        dict.set_item("name", object.name.as_ref())?;
        dict.set_item("kind", object.row.name.as_ref())?;
        dict.set_item("class", class.name())?;
        dict.set_item("ok", object.value().is_some())?;
        dict.set_item("shown", object.head.shown())?;
        dict.set_item("parents", names(&mut object.parents.iter().copied()))?;
        dict.set_item("children", names(&mut object.children.iter().copied()))?;
        dict.set_item("arguments", arguments(py, graph, object)?)?;
        Ok(dict)
    }

    /// Lines printed by the program.
    fn printed(&self, py: Python<'_>) -> Vec<String> {
        self.lock(py).printed().to_vec()
    }

    /// The names of the files that the program wrote.
    fn written_names(&self, py: Python<'_>) -> Vec<String> {
        self.lock(py).written().map(|(name, _)| name.to_owned()).collect()
    }

    /// Files written by the program: names and contents; nothing is on the disk yet.
    fn written<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyBytes>)> {
        let document = self.lock(py);
        document.written().map(|(name, bytes)| (name.to_owned(), PyBytes::new(py, bytes))).collect()
    }

    /// Halves the intervals of all numbers that the program declares by `refined` that many times.
    fn refine(&self, py: Python<'_>, times: u32) -> PyResult<()> {
        self.long_checked(py, move |d| d.refine(times).map(drop).map_err(|e| vec![e]))
    }

    /// The variables of the program: name, type with extents, and value.
    fn variables<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Vec<(String, String, Bound<'py, PyAny>)>> {
        let variables = self.lock(py).variables();
        let data = |(name, shape, value): (String, String, Value<f64>)| {
            Ok((name, shape, to_python(py, &value)?))
        };
        variables.into_iter().map(data).collect()
    }

    /// Possible words at the end of the text followed by `line`.
    fn complete(&self, py: Python<'_>, line: &str) -> Vec<String> {
        self.lock(py).completions_of(line).into_iter().map(|c| c.word).collect()
    }

    fn rename(&self, py: Python<'_>, old: String, new: String) -> PyResult<()> {
        self.long_checked(py, move |d| d.rename(&old, &new).map(drop).map_err(|e| vec![e]))
    }

    fn delete(&self, py: Python<'_>, name: String) -> PyResult<()> {
        self.long_checked(py, move |d| d.delete(&name).map(drop).map_err(|e| vec![e]))
    }

    /// Makes a Python function callable in the model under `name`.
    fn add_function(
        &self,
        py: Python<'_>,
        name: String,
        arguments: Vec<String>,
        doc: String,
        function: Py<PyAny>,
    ) -> PyResult<()> {
        self.calls_python.store(true, Ordering::Relaxed);
        let row = crate::foreign::row(name, arguments, doc, function);
        self.long(py, move |d| {
            d.add_row(row);
        })
    }

    /// Makes a field or set callable in the model under `name`, without arguments.
    fn add_shape(&self, py: Python<'_>, name: String, shape: &Bound<'_, PyAny>) -> PyResult<()> {
        let Some(row) = crate::foreign::shape_row(&name, shape) else {
            return Err(plain_error(format!("`{name}` is neither a field nor a set")));
        };
        // A field may be a Python function.
        self.calls_python.store(true, Ordering::Relaxed);
        self.long(py, move |d| {
            d.add_row(row);
        })
    }

    fn eval<'py>(&self, py: Python<'py>, expression: &str) -> PyResult<Bound<'py, PyAny>> {
        let expression = expression.to_owned();
        let value = self.long_checked(py, move |d| d.eval(&expression))?;
        to_python(py, &value)
    }

    /// Adjustments (name, before, after, share), the values reached and the number of steps.
    #[allow(clippy::type_complexity)]
    fn solve_for(
        &self,
        py: Python<'_>,
        targets: Vec<(String, f64)>,
        by: Vec<(String, f64)>,
    ) -> PyResult<(Vec<(String, f64, f64, f64)>, Vec<f64>, usize)> {
        let target = |(expression, value)| WantedNumber { expression, value };
        let targets: Vec<WantedNumber> = targets.into_iter().map(target).collect();
        let adjustable = |(name, weight)| Adjustable { name, weight, home: None };
        let by: Vec<Adjustable> = by.into_iter().map(adjustable).collect();
        let found = self.long_checked(py, move |d| d.solve_for(&targets, &by))?;
        let rows = found.adjustments.into_iter();
        let rows = rows.map(|a| (a.name, a.before, a.after, a.share)).collect();
        Ok((rows, found.reached, found.steps))
    }

    fn derivatives<'py>(
        &self,
        py: Python<'py>,
        expressions: Vec<String>,
        by: Vec<String>,
    ) -> PyResult<Vec<Vec<Bound<'py, PyAny>>>> {
        let rows = self.long_checked(py, move |d| d.derivatives(&expressions, &by))?;
        let row = |row: Vec<Value<f64>>| row.iter().map(|value| to_python(py, value)).collect();
        rows.into_iter().map(row).collect()
    }

    fn curve<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        t: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let curve = self.curve_of(py, name)?;
        let ts = t.as_slice()?;
        if ts.len() <= LARGE {
            return Ok(arrays::filled(py, [ts.len(), 3], |out| py.detach(|| curve.grid(ts, out))).0);
        }
        let ts = ts.to_vec();
        let [points] = self.many(py, [ts.len(), 3], move |[out], budget| {
            in_runs(ts.len(), CHUNK, budget, |run| curve.grid(&ts[run.clone()], &mut out[run]));
        })?;
        Ok(points)
    }

    fn surface<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        u: PyReadonlyArray1<'py, f64>,
        v: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let surface = self.surface_of(py, name)?;
        let (us, vs) = (u.as_slice()?, v.as_slice()?);
        let some = |surface: &SurfaceRef<f64>, out: &mut [Vec3], us: &[f64], vs: &[f64]| {
            let uv: Vec<[f64; 2]> = us.iter().zip(vs).map(|(&u, &v)| [u, v]).collect();
            surface.scattered(&uv, out);
        };
        if us.len() <= CHUNK {
            let fill = |out: &mut [Vec3]| py.detach(|| some(&surface, out, us, vs));
            return Ok(arrays::filled(py, [us.len(), 3], fill).0);
        }
        let (us, vs) = (us.to_vec(), vs.to_vec());
        let [points] = self.many(py, [us.len(), 3], move |[out], budget| {
            let chunks = out.par_chunks_mut(CHUNK);
            let parameters = us.par_chunks(CHUNK).zip(vs.par_chunks(CHUNK));
            // The rest after a Ctrl-C is not used.
            let _ = chunks.zip(parameters).try_for_each(|(out, (us, vs))| {
                some(&surface, out, us, vs);
                budget.poll()
            });
        })?;
        Ok(points)
    }

    fn grid<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        nu: usize,
        nv: usize,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let [us, vs] = parameters(nu, nv)?;
        let surface = self.surface_of(py, name)?;
        if nu * nv <= LARGE {
            let fill = |out: &mut [Vec3]| py.detach(|| surface.grid(&us, &vs, out, None));
            return Ok(arrays::filled(py, [nu, nv, 3], fill).0);
        }
        let [points] = self.many(py, [nu, nv, 3], move |[out], budget| {
            in_runs(nu, (CHUNK / nv).max(1), budget, |run| {
                let out = &mut out[run.start * nv..run.end * nv];
                surface.grid(&us[run], &vs, out, None);
            });
        })?;
        Ok(points)
    }

    fn grid_with_normals<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        nu: usize,
        nv: usize,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>)> {
        let [us, vs] = parameters(nu, nv)?;
        let surface = self.surface_of(py, name)?;
        if nu * nv > LARGE {
            let [points, normals] =
                self.many(py, [nu, nv, 3], move |[points, normals], budget| {
                    in_runs(nu, (CHUNK / nv).max(1), budget, |run| {
                        let place = run.start * nv..run.end * nv;
                        let normals = Some(&mut normals[place.clone()]);
                        surface.grid(&us[run], &vs, &mut points[place], normals);
                    });
                })?;
            return Ok((points, normals));
        }
        let (points, normals) = arrays::filled(py, [nu, nv, 3], |points| {
            let fill = |normals: &mut [Vec3]| {
                py.detach(|| surface.grid(&us, &vs, points, Some(normals)));
            };
            arrays::filled(py, [nu, nv, 3], fill).0
        });
        Ok((points, normals))
    }

    /// Normals, curvatures and reflections of a surface on a grid of parameters.
    fn look(
        &self,
        py: Python<'_>,
        name: &str,
        u: PyReadonlyArray1<'_, f64>,
        v: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Look> {
        let surface = self.surface_of(py, name)?;
        Look::of(py, surface, u.as_slice()?.to_vec(), v.as_slice()?.to_vec())
    }

    /// First and second derivatives of a curve, and the parameters at which these may jump.
    fn curve_derivatives<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        t: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Vec<f64>)> {
        let curve = self.curve_of(py, name)?;
        let ts = t.as_slice()?;
        let jets: Vec<_> = py.detach(|| ts.iter().map(|&t| curve.jet(t, Order::Second)).collect());
        let part = |k: usize| {
            let fill = |out: &mut [Vec3]| out.iter_mut().zip(&jets).for_each(|(o, j)| *o = j[k]);
            arrays::filled(py, [jets.len(), 3], fill).0
        };
        Ok((part(1), part(2), curve.breaks()))
    }

    /// The panels; of the patches with one of the tags when any are given, of both sides, and as near to the surfaces as
    /// tolerance and angle say.
    fn mesh(
        &self,
        py: Python<'_>,
        tags: Vec<String>,
        whole: bool,
        tolerance: Option<f64>,
        angle: Option<f64>,
    ) -> PyResult<PyMesh> {
        let options = WriteOptions { tags, whole, tolerance, angle, ..WriteOptions::default() };
        let (panelled, part) = self
            .long_checked(py, move |d| Ok(moldloft::export::panels(d, &options)?.into_parts()))?;
        Ok(PyMesh::new(panelled, part))
    }

    /// Position, S_u, S_v, S_uu, S_uv, S_vv of a surface at parameters.
    fn surface_derivatives<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        u: PyReadonlyArray1<'py, f64>,
        v: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let surface = self.surface_of(py, name)?;
        let (us, vs) = (u.as_slice()?, v.as_slice()?);
        let at = || us.iter().zip(vs).map(|(&u, &v)| surface.jet(u, v, Order::Second)).collect();
        let jets: Vec<moldloft::num::SurfJet<f64>> = py.detach(at);
        let part = |of: fn(&moldloft::num::SurfJet<f64>) -> Vec3| {
            let fill = |out: &mut [Vec3]| out.iter_mut().zip(&jets).for_each(|(o, j)| *o = of(j));
            arrays::filled(py, [jets.len(), 3], fill).0
        };
        Ok(vec![
            part(|j| j.p),
            part(|j| j.u),
            part(|j| j.v),
            part(|j| j.uu),
            part(|j| j.uv),
            part(|j| j.vv),
        ])
    }

    /// Corners on edges of other patches without a join.
    fn junctions(&self, py: Python<'_>) -> PyResult<Vec<PyDiagnostic>> {
        let found = self.long_checked(py, |d| d.junctions().map_err(|e| vec![e]))?;
        let document = self.lock(py);
        let sources = document.sources();
        Ok(found.iter().map(|d| d.to_data(sources).into()).collect())
    }

    /// Surfaces of the skin that turn over themselves.
    fn folded_surfaces(&self, py: Python<'_>) -> PyResult<Vec<PyDiagnostic>> {
        let found = self.long_checked(py, |d| d.folded_surfaces().map_err(|e| vec![e]))?;
        let document = self.lock(py);
        let sources = document.sources();
        Ok(found.iter().map(|d| d.to_data(sources).into()).collect())
    }

    /// The patches that hydrostatics measure on their panels.
    fn on_panels(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.long_checked(py, |d| d.on_panels().map_err(|e| vec![e]))
    }

    /// Plates inside a body, and bodies that overlap.
    fn inner_skins(&self, py: Python<'_>) -> PyResult<Vec<PyDiagnostic>> {
        let found = self.long_checked(py, |d| d.inner_skins().map_err(|e| vec![e]))?;
        let document = self.lock(py);
        let sources = document.sources();
        Ok(found.iter().map(|d| d.to_data(sources).into()).collect())
    }

    /// Object, tags and wetted area of each patch of the skin.
    fn wetted_areas(
        &self,
        py: Python<'_>,
        attitude: [f64; 3],
        accuracy: f64,
    ) -> PyResult<Vec<(String, Vec<String>, f64)>> {
        let found = self.long_checked(py, move |d| {
            d.wetted_areas(Attitude::of(attitude), accuracy).map_err(|e| vec![e])
        })?;
        Ok(found.into_iter().map(|w| (w.object, w.tags, w.area)).collect())
    }

    /// The volume mesh of the shown solids.
    fn blocks(&self, py: Python<'_>) -> PyResult<PyBlocks> {
        self.long_checked(py, |d| {
            let blocked = d.blocked().map_err(|e| vec![e])?;
            let sources = d.sources();
            let problems = blocked.diagnostics();
            let problems = problems.iter().map(|p| p.to_data(sources).into()).collect();
            let (symmetry, length) = (d.symmetry(), stated_length(d).unwrap_or_default());
            Ok(PyBlocks { blocked, problems, symmetry, length })
        })
    }

    fn block_jacobian<'py>(
        &self,
        py: Python<'py>,
        by: Vec<String>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let columns = self.long_checked(py, move |d| d.block_jacobian(&by))?;
        Ok(derivatives(py, &columns))
    }

    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        by: Vec<String>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let columns = self.long_checked(py, move |d| d.jacobian(&by))?;
        Ok(derivatives(py, &columns))
    }

    /// Area and centroid of a surface with bounds, derivatives and their bounds, as rows of four.
    fn part_measures(
        &self,
        py: Python<'_>,
        name: String,
        accuracy: f64,
        by: Vec<String>,
    ) -> PyResult<([[f64; 4]; 2], [[Vec<f64>; 4]; 2])> {
        in_accuracy(accuracy)?;
        object_named(&self.lock(py), &name)?;
        let found = self.long_checked(py, move |d| d.part_measures(&name, accuracy, &by))?;
        Ok(([found.figures, found.bounds], [found.derivatives, found.derivative_bounds]))
    }

    /// Hydrostatics: rows of the given quantity (`level`, `draft`, `displacement`), its value,
    /// trim, heel, and whether trim and heel are free; a dictionary for each.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (rows, density, gravity, centre, sides, by, accuracy, of_weights, flooded))]
    fn floating<'py>(
        &self,
        py: Python<'py>,
        rows: Vec<(String, f64, f64, f64, bool, bool)>,
        density: f64,
        gravity: Option<f64>,
        centre: Option<[f64; 3]>,
        sides: &str,
        by: Vec<String>,
        accuracy: f64,
        of_weights: bool,
        flooded: bool,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        in_accuracy(accuracy)?;
        let one_side = match sides {
            "both" => false,
            "one" => true,
            _ => return Err(plain_error(format!("sides are `both` or `one`, not `{sides}`"))),
        };
        let centimetre = 10.0 / moldloft::export::length_unit(&self.lock(py)).1;
        let gravity = gravity.unwrap_or(moldloft::export::GRAVITY * 100.0 * centimetre);
        if !(density > 0.0 && density.is_finite() && gravity > 0.0 && gravity.is_finite()) {
            return Err(plain_error("density and gravity must be positive numbers"));
        }
        let finite = |r: &(String, f64, f64, f64, bool, bool)| {
            r.0 == "displacement" || [r.1, r.2, r.3].iter().all(|x| x.is_finite())
        };
        if !rows.iter().all(finite) || centre.is_some_and(|c| c.iter().any(|x| !x.is_finite())) {
            return Err(plain_error("level, draft, trim, heel and centre must be finite numbers"));
        }
        let request = |(given, x, trim, heel, free_trim, free_heel): (String, f64, _, _, _, _)| {
            let immersion = match given.as_str() {
                "level" => Immersion::Level(x),
                "draft" => Immersion::Draft(x),
                _ => Immersion::Mass { mass: x, free_trim, free_heel },
            };
            FloatRequest { immersion, trim, heel }
        };
        let requests: Vec<FloatRequest> = rows.into_iter().map(request).collect();
        let options = FlotationOptions {
            density,
            gravity,
            centimetre,
            centre,
            one_side,
            of_weights,
            flooded,
            accuracy,
        };
        let names = by.clone();
        let answers = self.long_checked(py, move |d| d.floating(&requests, options, &by))?;
        answers.iter().map(|answer| float_facts(py, answer, &names)).collect()
    }

    /// Name, group, mass, margin in percent, centre and status of each weight.
    fn weights(&self, py: Python<'_>) -> Vec<(String, String, f64, f64, [f64; 3], String)> {
        let weights = self.lock(py).weights();
        let row = |w: moldloft::document::WeightItem| {
            (w.name, w.group, w.mass, w.margin, w.centre, w.status)
        };
        weights.into_iter().map(row).collect()
    }

    /// The sections of a contours object: position, and lines `(name, (n, 3) points, closed)`.
    fn sections_of<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Vec<(f64, Vec<(String, Bound<'py, PyArray2<f64>>, bool)>)>> {
        let sections = self.lock(py).sections_of(name);
        let line = |name: &str, line: &moldloft::panel::Contour| {
            let fill = |out: &mut [Vec3]| out.copy_from_slice(&line.points);
            let points = arrays::filled(py, [line.points.len(), 3], fill).0;
            (name.to_owned(), points, line.closed)
        };
        let section = |section: moldloft::document::ContourSection| {
            let all = section.lines.iter();
            let lines = all.flat_map(|(name, lines)| lines.iter().map(|l| line(name, l)));
            (section.value, lines.collect())
        };
        Ok(sections.into_iter().map(section).collect())
    }

    /// Immersed area of sections and its moment about z = 0, `[station][level]`.
    fn section_areas(
        &self,
        py: Python<'_>,
        stations: Vec<f64>,
        levels: Vec<f64>,
        accuracy: f64,
    ) -> PyResult<Vec<Vec<[f64; 2]>>> {
        self.long_checked(py, move |d| d.section_areas(&stations, &levels, accuracy))
    }

    /// Displaced volume, wetted area and waterplane area of the panels.
    fn panel_figures(&self, py: Python<'_>, level: f64) -> PyResult<[f64; 3]> {
        self.long_checked(py, move |d| d.panel_figures(level).map_err(|d| vec![d]))
    }

    /// The units that the model states: length, mass, force and angle, each a word and its size in metres,
    /// kilograms, newtons or radians.
    fn units(&self, py: Python<'_>) -> Vec<(&'static str, f64)> {
        let text = self.lock(py).units();
        let known = moldloft::lang::model_file::units::parsed(&text).unwrap_or_default();
        known.into_iter().map(|(word, _, size)| (word, size)).collect()
    }

    /// The files of a format, the first of them under the name `main`: name and content of each.
    #[allow(clippy::too_many_arguments)]
    fn write<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        main: String,
        lids: bool,
        immersed: bool,
        tags: Vec<String>,
        tolerance: Option<f64>,
        angle: Option<f64>,
        whole: bool,
        triangles: bool,
    ) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let format = format_named(format).map_err(|d| plain_error(&d.message))?;
        let options = WriteOptions { lids, immersed, tags, whole, triangles, tolerance, angle };
        let files =
            self.long_checked(py, move |d| moldloft::export::write(d, format, &main, &options))?;
        Ok(files.into_iter().map(|f| (f.name, PyBytes::new(py, &f.bytes))).collect())
    }

    /// The skin as B-spline patches: name, degrees, spans, control points (nu, nv, 3), deviation.
    fn spline_patches<'py>(
        &self,
        py: Python<'py>,
        tolerance: Option<f64>,
        lids: bool,
    ) -> PyResult<Vec<PatchFacts<'py>>> {
        let patches = self.long_checked(py, move |d| {
            spline_patches(d, tolerance, lids).map_err(|e| e.diagnostics("gdf-high"))
        })?;
        let facts = |patch: SplinePatch| {
            let shape = [0, 1].map(|axis| patch.degree[axis] + patch.spans[axis]);
            let fill = |out: &mut [Vec3]| out.copy_from_slice(&patch.points);
            let points = arrays::filled(py, [shape[0], shape[1], 3], fill).0;
            (patch.name.clone(), patch.degree, patch.spans, points, patch.deviation)
        };
        Ok(patches.into_iter().map(facts).collect())
    }

    fn picture<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        height: usize,
        only: Vec<String>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let picture =
            self.long_checked(py, move |d| moldloft::export::picture(d, width, height, &only))?;
        Ok(PyBytes::new(py, &picture))
    }

    /// A picture with the objects of one kind highlighted.
    fn portrait<'py>(
        &self,
        py: Python<'py>,
        kind: String,
        width: usize,
        height: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let picture = self
            .long_checked(py, move |d| moldloft::export::kind_picture(d, &kind, width, height))?;
        Ok(PyBytes::new(py, &picture))
    }
}

fn float_facts<'py>(
    py: Python<'py>,
    answer: &FloatAnswer,
    by: &[String],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("sides", answer.sides)?;
    for (name, value) in &answer.figures {
        dict.set_item(name, value + 0.0)?;
    }
    dict.set_item("open_edges", answer.open_edges)?;
    dict.set_item("closure_error", answer.closure_error)?;
    dict.set_item("waterplane_error", answer.waterplane_error)?;
    dict.set_item("outward", answer.outward)?;
    dict.set_item("status", answer.status)?;
    dict.set_item("iterations", answer.iterations)?;
    dict.set_item("residual", answer.residual)?;
    dict.set_item("stable", answer.stable)?;
    dict.set_item("lolls", answer.lolls)?;
    let bounds = PyDict::new(py);
    for (name, bound) in &answer.bounds {
        bounds.set_item(name, bound)?;
    }
    dict.set_item("bounds", bounds)?;
    for (key, rows) in
        [("derivatives", &answer.derivatives), ("derivative_bounds", &answer.derivative_bounds)]
    {
        let all = PyDict::new(py);
        let rows = answer.figures.iter().zip(rows).filter(|_| !by.is_empty());
        for ((name, _), row) in rows {
            let one = PyDict::new(py);
            for (parameter, slope) in by.iter().zip(row) {
                one.set_item(parameter, slope + 0.0)?;
            }
            all.set_item(name, one)?;
        }
        dict.set_item(key, all)?;
    }
    Ok(dict)
}

/// The canonical text of a program.
#[pyfunction]
pub fn format_text(name: &str, text: &[u8]) -> PyResult<String> {
    let mut sources = Sources::new();
    let text = match moldloft::syntax::decode(text, name) {
        Ok(text) => text,
        Err(diagnostic) => return Err(model_error(&[diagnostic], &sources)),
    };
    sources.add(name, &*text);
    moldloft::syntax::sdl::format(&text).map_err(|diagnostics| model_error(&diagnostics, &sources))
}

fn in_accuracy(accuracy: f64) -> PyResult<()> {
    if (1e-12..=0.1).contains(&accuracy) {
        return Ok(());
    }
    Err(plain_error(format!("the accuracy is relative, from 1e-12 to 0.1, not {accuracy}")))
}

fn object_named<'d>(document: &'d Document, name: &str) -> PyResult<&'d Object<f64>> {
    let graph = document.graph();
    graph.find(name).and_then(|key| graph.get(key)).ok_or_else(|| {
        let near = similar(document, name).map(|n| format!("; did you mean `{n}`?"));
        unknown_name(format!("unknown object `{name}`{}", near.unwrap_or_default()))
    })
}

fn similar(document: &Document, name: &str) -> Option<String> {
    let params = document.params().iter().map(|p| p.name.as_str());
    let objects = document.graph().objects().map(|o| o.name.as_ref());
    moldloft::diag::nearest(name, params.chain(objects)).map(str::to_owned)
}

pub(crate) fn wrong_class(name: &str, takes: &str, found: &Value<f64>) -> PyErr {
    plain_error(format!("{takes}, but `{name}` is {}", found.class().with_article()))
}

/// Minimum time between two checks of the budget.
const RUN: Duration = Duration::from_millis(20);

/// Work on items in runs, with checks of the budget between them. The first run has `first` items;
/// they grow while they are short, since each run repeats its preparation.
fn in_runs(count: usize, first: usize, budget: &Budget, mut work: impl FnMut(Range<usize>)) {
    let (mut at, mut step) = (0, first);
    while at < count && !budget.is_spent() {
        let end = count.min(at + step);
        let began = Instant::now();
        work(at..end);
        if began.elapsed() < RUN {
            step *= 2;
        }
        at = end;
    }
}

/// Even parameters along both sides of a grid.
fn parameters(nu: usize, nv: usize) -> PyResult<[Vec<f64>; 2]> {
    if nu < 2 || nv < 2 {
        let message = format!("a grid has at least 2 points along each side, not {nu} x {nv}");
        return Err(plain_error(message));
    }
    arrays::room([nu, nv], size_of::<Vec3>())?;
    Ok([nu, nv].map(|n| (0..n).map(|i| i as f64 / (n - 1) as f64).collect()))
}

/// Derivatives `[by][vertex]` as an array (vertices, 3, by).
fn derivatives<'py>(py: Python<'py>, columns: &[Vec<Vec3>]) -> Bound<'py, PyArray3<f64>> {
    let vertices = columns.first().map_or(0, Vec::len);
    let array = PyArray3::<f64>::zeros(py, [vertices, 3, columns.len()], false);
    {
        let mut access = numpy::PyArrayMethods::readwrite(&array);
        let mut out = access.as_array_mut();
        for (k, column) in columns.iter().enumerate() {
            for (i, v) in column.iter().enumerate() {
                for (axis, x) in v.to_array().into_iter().enumerate() {
                    out[[i, axis, k]] = x;
                }
            }
        }
    }
    array
}
