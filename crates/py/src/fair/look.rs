//! Appearance of a surface: curvatures and reflections on a grid.

use super::arguments::refused;
use crate::arrays;
use crate::work::unlocked_if;
use moldloft::fair::surface::{self, SurfaceAnalysis as One};
use moldloft::num::{Surface, Vec3};
use moldloft_parallel::prelude::*;
use numpy::ndarray::Array2;
use numpy::{PyArray2, PyArray3, ToPyArray};
use pyo3::prelude::*;

/// A surface at a grid of parameters: normals, curvatures, and reflections. All numbers are NaN at
/// singular points.
#[pyclass(frozen, module = "moldloft._core")]
pub struct Look {
    shape: [usize; 2],
    points: Vec<Vec3>,
    looks: Vec<Option<One>>,
}

/// Number of points from which work is done in another thread.
const LARGE: usize = 4_000;

impl Look {
    /// Refuses more than can be held; Ctrl-C ends it.
    pub fn of(
        py: Python<'_>,
        surface: impl Surface<f64> + 'static,
        us: Vec<f64>,
        vs: Vec<f64>,
    ) -> PyResult<Self> {
        let each = size_of::<Option<One>>() + size_of::<Vec3>();
        let count = arrays::room([us.len(), vs.len()], each)?;
        unlocked_if(py, count > LARGE, move || {
            let at = |k: usize| (us[k / vs.len()], vs[k % vs.len()]);
            let looks = (0..count)
                .into_par_iter()
                .map(|k| {
                    let (u, v) = at(k);
                    surface::look(&surface, u, v)
                })
                .collect();
            let mut points = vec![Vec3::zero(); count];
            surface.grid(&us, &vs, &mut points, None);
            Self { shape: [us.len(), vs.len()], points, looks }
        })
    }

    fn numbers<'py>(&self, py: Python<'py>, f: impl Fn(&One) -> f64) -> Bound<'py, PyArray2<f64>> {
        let values = self.looks.iter().map(|l| l.as_ref().map_or(f64::NAN, &f)).collect();
        let array = Array2::from_shape_vec((self.shape[0], self.shape[1]), values);
        array.expect("as many looks as parameters").to_pyarray(py)
    }

    fn vectors<'py>(
        &self,
        py: Python<'py>,
        f: impl Fn(usize) -> Vec3,
    ) -> Bound<'py, PyArray3<f64>> {
        let [m, n] = self.shape;
        let fill = |out: &mut [Vec3]| out.iter_mut().enumerate().for_each(|(k, o)| *o = f(k));
        arrays::filled(py, [m, n, 3], fill).0
    }
}

const NOWHERE: Vec3 = Vec3 { x: f64::NAN, y: f64::NAN, z: f64::NAN };

fn direction(v: [f64; 3], what: &str) -> PyResult<Vec3> {
    let v = Vec3::from(v);
    if v.is_finite() && v.norm() > 0.0 {
        return Ok(v);
    }
    Err(refused(format!("the direction of the {what} has no length")))
}

#[pymethods]
impl Look {
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.vectors(py, |k| self.points[k])
    }

    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.vectors(py, |k| self.looks[k].map_or(NOWHERE, |l| l.normal))
    }

    #[getter]
    fn gaussian<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.numbers(py, |l| l.curvatures.gaussian)
    }

    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.numbers(py, |l| l.curvatures.mean)
    }

    #[getter]
    fn largest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.numbers(py, |l| l.curvatures.principal[0])
    }

    #[getter]
    fn smallest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.numbers(py, |l| l.curvatures.principal[1])
    }

    #[getter]
    fn absolute<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.numbers(py, |l| l.curvatures.absolute())
    }

    fn isophote<'py>(
        &self,
        py: Python<'py>,
        light: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let light = direction(light, "light")?;
        Ok(self.numbers(py, |l| surface::isophote(l, light)))
    }

    fn highlight<'py>(
        &self,
        py: Python<'py>,
        point: [f64; 3],
        along: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let along = direction(along, "light line")?;
        Ok(self.numbers(py, |l| surface::highlight(l, point.into(), along)))
    }

    fn reflection<'py>(
        &self,
        py: Python<'py>,
        view: [f64; 3],
        point: [f64; 3],
        along: [f64; 3],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (view, along) = (direction(view, "view")?, direction(along, "line")?);
        Ok(self.numbers(py, |l| surface::reflection(l, view, point.into(), along)))
    }

    fn zebra<'py>(
        &self,
        py: Python<'py>,
        view: [f64; 3],
        axis: [f64; 3],
        stripes: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (view, axis) = (direction(view, "view")?, direction(axis, "axis")?);
        Ok(self.numbers(py, |l| surface::zebra(l, view, axis, stripes)))
    }

    fn orthotomic<'py>(&self, py: Python<'py>, p: [f64; 3], k: f64) -> Bound<'py, PyArray3<f64>> {
        let at = |l: One| surface::orthotomic(&l, p.into(), k);
        self.vectors(py, |i| self.looks[i].map_or(NOWHERE, at))
    }
}
