//! Sets.

use super::arguments::{attributes, box_of, check_raised, finished, points};
use super::facets::PyFacets;
use super::field::{LARGE, PyField, values_at};
use super::oracle::Slots;
use crate::error::plain_error;
use crate::work::{interruptible, unlocked_if};
use moldloft::budget::Budget;
use moldloft::field::{
    Affine, BracketedMass, Caster, FacetOptions, FieldError, IntegralOptions, Light, Membership,
    Pieces, Ray, RayTrace, Resolution, Set, SetAttributes, facet_mixed,
};
use moldloft::num::{Box3, Vec3};
use moldloft_parallel::prelude::*;
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::sync::Arc;

/// A set of points.
#[pyclass(frozen, name = "Set", module = "moldloft._core")]
pub struct PySet {
    pub inner: Set,
    pub slots: Slots,
}

impl PySet {
    pub fn of(inner: Set) -> Self {
        Self { inner, slots: Slots::default() }
    }

    fn from(&self, inner: Set) -> Self {
        Self { inner, slots: self.slots.clone() }
    }

    /// Work on the set that may take long, and stops at Ctrl-C.
    fn long<R: Send + 'static>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Set, Arc<Budget>) -> Result<R, FieldError> + Send + 'static,
    ) -> PyResult<R> {
        let budget = Arc::<Budget>::default();
        let (set, part) = (self.inner.clone(), budget.for_set());
        let outcome = interruptible(py, &budget, move || work(&set, part))?;
        finished(py, &self.slots, outcome)
    }
}

/// The box given, or one around the set.
fn region(set: &Set, given: Option<Box3>) -> Result<Box3, FieldError> {
    match given {
        Some(over) => Ok(over),
        None => match moldloft::field::around(set)? {
            Some(over) => Ok(over),
            None => Err(FieldError::Degenerate { what: "set: it is empty and has no box; it" }),
        },
    }
}

type Corners = Option<([f64; 3], [f64; 3])>;

fn given(corners: Corners) -> Option<Box3> {
    corners.map(|(low, high)| box_of(low, high))
}

#[pymethods]
impl PySet {
    #[staticmethod]
    fn of_field(field: &PyField) -> Self {
        Self { inner: Set::new(&field.inner), slots: field.slots.clone() }
    }

    #[staticmethod]
    fn segment(start: [f64; 3], end: [f64; 3]) -> PyResult<Self> {
        Set::segment(Vec3::from(start), Vec3::from(end)).map(Self::of).map_err(plain_error)
    }

    #[staticmethod]
    fn point(at: [f64; 3]) -> PyResult<Self> {
        Set::point(Vec3::from(at)).map(Self::of).map_err(plain_error)
    }

    fn binary(&self, name: &str, o: &Self) -> PyResult<Self> {
        let (a, b) = (&self.inner, &o.inner);
        let inner = match name {
            "|" => a | b,
            "&" => a & b,
            "-" => a - b,
            "^" => a ^ b,
            _ => return Err(plain_error(format!("there is no operator {name} of sets"))),
        };
        Ok(Self { inner, slots: self.slots.with(&o.slots) })
    }

    fn complement(&self) -> Self {
        self.from(self.inner.complement())
    }

    fn skin(&self) -> Self {
        self.from(self.inner.skin())
    }

    fn regularized(&self) -> Self {
        self.from(self.inner.regularized())
    }

    fn pruned(&self, low: [f64; 3], high: [f64; 3]) -> Self {
        self.from(self.inner.pruned(&box_of(low, high)))
    }

    fn mapped(&self, rows: [[f64; 3]; 3], shift: [f64; 3]) -> PyResult<Self> {
        let map = Affine { rows: rows.map(Vec3::from), shift: Vec3::from(shift) };
        self.inner.mapped(&map).map(|s| self.from(s)).map_err(plain_error)
    }

    fn remapped(&self, x: &PyField, y: &PyField, z: &PyField) -> PyResult<Self> {
        let coordinates = [&x.inner, &y.inner, &z.inner].map(Clone::clone);
        let slots = self.slots.with(&x.slots).with(&y.slots).with(&z.slots);
        let inner = self.inner.remapped(&coordinates).map_err(plain_error)?;
        Ok(Self { inner, slots })
    }

    /// The set as text of its own format.
    fn to_text(&self) -> PyResult<String> {
        self.inner.to_text().map_err(plain_error)
    }

    /// The set as a program of the language.
    fn to_sdl(&self, name: &str) -> PyResult<String> {
        self.inner.to_sdl(name).map_err(plain_error)
    }

    #[staticmethod]
    fn from_text(text: &str) -> PyResult<Self> {
        Set::from_text(text).map(Self::of).map_err(plain_error)
    }

    /// The union with another set, with fillets.
    fn filleted(
        &self,
        py: Python<'_>,
        o: &Self,
        widths: [f64; 2],
        lambda: f64,
        edges: Option<Vec<[String; 2]>>,
    ) -> PyResult<Self> {
        let (a, b) = (&self.inner, &o.inner);
        let made =
            py.detach(|| moldloft::field::fillet_sets([a, b], widths, lambda, edges.as_deref()));
        let inner = made.map_err(plain_error)?;
        Ok(Self { inner, slots: self.slots.with(&o.slots) })
    }

    /// The set with its convex edges rounded, or chamfered without a weight.
    fn rounded(
        &self,
        py: Python<'_>,
        width: f64,
        lambda: Option<f64>,
        edges: Option<Vec<[String; 2]>>,
    ) -> PyResult<Self> {
        let set = &self.inner;
        let made = py.detach(|| match lambda {
            Some(lambda) => moldloft::field::round_edges(set, width, lambda, edges.as_deref()),
            None => moldloft::field::chamfer_edges(set, width, edges.as_deref()),
        });
        made.map(|s| self.from(s)).map_err(plain_error)
    }

    fn with_attributes(
        &self,
        name: Option<String>,
        colour: Option<u8>,
        material: Option<String>,
        tolerance: Option<f64>,
        tags: std::collections::BTreeMap<String, String>,
    ) -> Self {
        self.from(self.inner.with(SetAttributes {
            given: name.is_some(),
            name,
            colour,
            material,
            tolerance,
            tags,
        }))
    }

    #[getter]
    fn degree(&self) -> u32 {
        self.inner.degree()
    }

    #[getter]
    fn contents(&self) -> usize {
        self.inner.contents()
    }

    #[getter]
    fn is_everything(&self) -> bool {
        self.inner.is_everything()
    }

    #[getter]
    fn is_nothing(&self) -> bool {
        self.inner.is_nothing()
    }

    fn operands(&self) -> Vec<Self> {
        self.inner.operands().iter().map(|s| self.from(s.clone())).collect()
    }

    fn same(&self, o: &Self) -> bool {
        self.inner.same(&o.inner)
    }

    /// The primitives with their attributes.
    fn leaves<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for leaf in self.inner.leaves() {
            let dict = attributes(py, &leaf.attributes)?;
            dict.set_item("kind", leaf.primitive.form().name())?;
            let field = PyField { inner: leaf.primitive, slots: self.slots.clone() };
            list.append((field.into_pyobject(py)?, dict))?;
        }
        Ok(list)
    }

    fn values<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let inner = self.inner.clone();
        values_at(py, &self.slots, &at, move |p, o| inner.values(p, o))
    }

    /// -1 in the solid, 0 on the surface, 1 in air; the points are on the surfaces of `known`.
    fn members<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
        tolerance: f64,
        known: Vec<PyRef<'py, PyField>>,
    ) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let points = points(&at)?;
        let known: Vec<_> = known.iter().map(|f| f.inner.clone()).collect();
        let (body, many) = (self.inner.as_body(), self.slots.is_empty());
        let one = move |p: &Vec3| match body.member(*p, tolerance, &known) {
            Membership::Solid => -1i8,
            Membership::Surface => 0,
            Membership::Air => 1,
        };
        let out = unlocked_if(py, many && points.len() > LARGE, move || match many {
            true => points.par_iter().map(one).collect::<Vec<_>>(),
            false => points.iter().map(one).collect(),
        })?;
        check_raised(py, &self.slots)?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// The number of the deciding leaf at each point, -1 without one.
    fn winners<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let points = points(&at)?;
        let (inner, many) = (self.inner.clone(), self.slots.is_empty());
        let one = move |p: &Vec3| inner.winner(*p).1.map_or(-1, |leaf| leaf as i64);
        let large = many && points.len() > LARGE;
        let out = unlocked_if(py, large, move || points.iter().map(one).collect::<Vec<_>>())?;
        check_raised(py, &self.slots)?;
        Ok(PyArray1::from_vec(py, out))
    }

    fn range(&self, py: Python<'_>, low: [f64; 3], high: [f64; 3]) -> PyResult<(f64, f64)> {
        let over = box_of(low, high);
        let range = py.detach(|| self.inner.range(&over));
        check_raised(py, &self.slots)?;
        Ok((range.low, range.high))
    }

    fn bounds(&self, py: Python<'_>, accuracy: f64) -> PyResult<Option<([f64; 3], [f64; 3])>> {
        let found = self.long(py, move |set, _| moldloft::field::bounds(set, accuracy))?;
        Ok(found.map(|b| (b.low.to_array(), b.high.to_array())))
    }

    #[pyo3(signature = (corners, depth, accuracy, limit, before=None))]
    fn facets(
        &self,
        py: Python<'_>,
        corners: Corners,
        depth: Option<u32>,
        accuracy: Option<f64>,
        limit: f64,
        before: Option<&PyFacets>,
    ) -> PyResult<PyFacets> {
        let before = before.and_then(PyFacets::solid);
        let resolution = match (depth, accuracy) {
            (_, Some(accuracy)) => Resolution::Accuracy(accuracy),
            (Some(depth), None) => Resolution::Depth(depth),
            (None, None) => Resolution::Level(6),
        };
        let (pieces, over) = self.long(py, move |set, budget| {
            // A set that is proved to be empty has no triangle in any box.
            let unit = || Box3 { low: Vec3::zero(), high: Vec3::of(1.0, 1.0, 1.0) };
            let over = match given(corners) {
                Some(over) => over,
                None => moldloft::field::around(set)?.unwrap_or_else(unit),
            };
            let options = FacetOptions { limit, budget, ..FacetOptions::new(resolution) };
            let plain = set.leaves().iter().all(|l| !l.primitive.is_sheet());
            // Only the given facets are reused: time and counts are those of the work done.
            let pieces = if plain {
                let facets = moldloft::field::refacet(set, &over, &options, before.as_deref())?;
                Pieces::Solid(Arc::new(facets))
            } else {
                Pieces::Mixed(Arc::new(facet_mixed(set, &over, &options)?))
            };
            Ok((pieces, over))
        })?;
        Ok(PyFacets::new(pieces, over))
    }

    /// Brackets and best values of volume, centroid and inertia.
    fn mass<'py>(
        &self,
        py: Python<'py>,
        corners: Corners,
        depth: Option<u32>,
        accuracy: Option<f64>,
        cells: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = self.long(py, move |set, budget| {
            let over = match given(corners) {
                Some(over) => over,
                None => match moldloft::field::around(set)? {
                    Some(over) => over,
                    None => return Ok(None),
                },
            };
            let measure =
                IntegralOptions { depth, accuracy, cells, budget, ..IntegralOptions::default() };
            moldloft::field::mass(set, &over, &measure).map(Some)
        })?;
        let doubt = found.as_ref().and_then(|mass| mass.doubt(None));
        let Some(BracketedMass { bracket, best, uncertain, estimate }) = found else {
            let dict = PyDict::new(py);
            dict.set_item("doubt", None::<String>)?;
            dict.set_item("volume", 0.0)?;
            dict.set_item("volume_bracket", (0.0, 0.0))?;
            dict.set_item("uncertain", 0.0)?;
            dict.set_item("estimate", 0.0)?;
            for name in ["centroid", "inertia"] {
                dict.set_item(name, None::<f64>)?;
            }
            let all = (f64::NEG_INFINITY, f64::INFINITY);
            dict.set_item("centroid_bracket", [all; 3])?;
            dict.set_item("inertia_bracket", [[all; 3]; 3])?;
            return Ok(dict);
        };
        let dict = PyDict::new(py);
        dict.set_item("volume", best.volume())?;
        let v = bracket.volume();
        dict.set_item("uncertain", uncertain)?;
        dict.set_item("estimate", estimate)?;
        let doubt = doubt.map(|d| format!("note[{}]: {}", d.id, d.message));
        dict.set_item("doubt", doubt)?;
        dict.set_item("volume_bracket", (v.low.max(0.0), v.high))?;
        let empty = best.volume() <= 0.0;
        dict.set_item("centroid", (!empty).then(|| best.centroid().to_array()))?;
        let centroid = bracket.centroid().map(|i| (i.low, i.high));
        dict.set_item("centroid_bracket", centroid)?;
        dict.set_item("inertia", (!empty).then(|| best.inertia().map(|r| r.to_array())))?;
        let inertia = bracket.inertia().map(|row| row.map(|i| (i.low, i.high)));
        dict.set_item("inertia_bracket", inertia)?;
        Ok(dict)
    }

    /// The nearest point of the surface, its distance and a proved lower bound of it.
    fn nearest(
        &self,
        py: Python<'_>,
        point: [f64; 3],
        corners: Corners,
        accuracy: Option<f64>,
    ) -> PyResult<Option<([f64; 3], f64, f64)>> {
        let found = self.long(py, move |set, _| {
            let over = region(set, given(corners))?;
            let accuracy = accuracy.unwrap_or(1e-6 * over.diagonal());
            moldloft::field::nearest(set, Vec3::from(point), &over, accuracy)
        })?;
        Ok(found.map(|n| (n.point.to_array(), n.distance, n.at_least)))
    }

    /// The distance to another set: itself, a proved bound, and a point of each.
    #[allow(clippy::type_complexity)]
    fn distance(
        &self,
        py: Python<'_>,
        o: &Self,
        corners: Corners,
        accuracy: Option<f64>,
    ) -> PyResult<Option<(f64, f64, [f64; 3], [f64; 3])>> {
        let other = o.inner.clone();
        let found = self.long(py, move |set, _| {
            let over = region(&(set | &other), given(corners))?;
            let accuracy = accuracy.unwrap_or(1e-5 * over.diagonal());
            moldloft::field::distance(set, &other, &over, accuracy)
        })?;
        let row = |g: moldloft::field::SetDistance| {
            (g.distance, g.at_least, g.first.to_array(), g.second.to_array())
        };
        Ok(found.map(row))
    }

    /// Hits of a ray: parameter, point, leaf, normal, entering.
    #[allow(clippy::type_complexity)]
    fn hits(
        &self,
        py: Python<'_>,
        start: [f64; 3],
        direction: [f64; 3],
        length: f64,
    ) -> PyResult<Vec<(f64, [f64; 3], usize, [f64; 3], bool)>> {
        let (start, direction) = (Vec3::from(start), Vec3::from(direction));
        if !(direction.norm() > 0.0 && length > 0.0 && length.is_finite()) {
            return Err(plain_error("a ray needs a direction and a finite length above 0"));
        }
        let ray = Ray { start, direction, length };
        let hits = py.detach(|| Caster::new(&self.inner).hits(&ray));
        check_raised(py, &self.slots)?;
        let one = |h: moldloft::field::Hit| {
            (h.t, h.point.to_array(), h.leaf, h.normal.to_array(), h.enters)
        };
        Ok(hits.into_iter().map(one).collect())
    }

    /// A ray-traced picture as a PNG file.
    #[allow(clippy::too_many_arguments)]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        corners: Corners,
        size: [usize; 2],
        view: ([f64; 3], [f64; 3], [f64; 3], f64),
        lights: Vec<(Option<[f64; 3]>, [f64; 3], [f64; 3])>,
        ambient: [f64; 3],
        background: [[u8; 3]; 2],
        looks: (bool, [f64; 2], usize),
        mirrors: Vec<f64>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        if size.iter().any(|n| *n == 0 || *n > 8192) {
            return Err(plain_error("a picture is 1 to 8192 points wide and high"));
        }
        let (eye, centre, up, angle) = view;
        let light = |(direction, place, colour): (Option<[f64; 3]>, [f64; 3], [f64; 3])| Light {
            direction: direction.map(Vec3::from),
            place: Vec3::from(place),
            colour,
        };
        let colours = self
            .inner
            .leaves()
            .iter()
            .enumerate()
            .map(|(k, leaf)| {
                let turn = [9usize, 14, 10, 12, 11, 13, 6, 7][k % 8];
                let index = leaf.attributes.colour.map_or(turn, usize::from);
                moldloft::picture::PALETTE[index % 16]
            })
            .collect();
        let view = RayTrace {
            size,
            eye: Vec3::from(eye),
            centre: Vec3::from(centre),
            up: Vec3::from(up),
            angle,
            lights: lights.into_iter().map(light).collect(),
            ambient,
            background,
            shadows: looks.0,
            shine: looks.1,
            samples: looks.2,
            colours,
            mirrors,
        };
        let rgb = self.long(py, move |set, budget| {
            let over = region(set, given(corners))?;
            let options = FacetOptions { budget, ..FacetOptions::new(Resolution::Depth(1)) };
            moldloft::field::ray_trace(set, &over, &view, &options)
        })?;
        let png = moldloft::picture::encoded(&rgb, size[0], size[1]).map_err(plain_error)?;
        Ok(PyBytes::new(py, &png))
    }

    /// The default box around the set.
    fn around(&self, py: Python<'_>) -> PyResult<([f64; 3], [f64; 3])> {
        let over = self.long(py, |set, _| region(set, None))?;
        Ok((over.low.to_array(), over.high.to_array()))
    }
}
