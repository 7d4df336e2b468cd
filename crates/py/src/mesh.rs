//! Meshes: arrays and their report.

use crate::arrays;
use moldloft_lang::Panelled;
use moldloft_mesh::{
    Block, Mesh, PatchInfo, Spread, TopologyBuilder, measure, measure_patch, quality,
};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;

/// Patch, name, tag, turned, vertices.
type BlockFacts<'py> = (usize, String, String, bool, Bound<'py, PyArray2<u32>>);

/// Panels at one state of a model.
#[pyclass(frozen, name = "Mesh", module = "moldloft._core")]
pub struct PyMesh {
    panelled: Arc<Panelled>,
}

impl PyMesh {
    pub fn new(panelled: Arc<Panelled>) -> Self {
        Self { panelled }
    }
}

#[pymethods]
impl PyMesh {
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let positions = self.panelled.mesh.positions();
        arrays::filled(py, [positions.len(), 3], |out| out.copy_from_slice(positions)).0
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let faces = self.panelled.mesh.faces();
        let array = PyArray2::<u32>::zeros(py, [faces.len(), 4], false);
        array.readwrite().as_slice_mut()?.copy_from_slice(faces.as_flattened());
        Ok(array)
    }

    /// Counts, measures, closure and orientation of the whole.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mesh = &self.panelled.mesh;
        let (report, measures) = py.detach(|| (mesh.report(), measure(mesh)));
        let dict = PyDict::new(py);
        dict.set_item("panels", report.faces)?;
        dict.set_item("vertices", report.vertices)?;
        dict.set_item("closed", report.closed)?;
        dict.set_item("area", measures.area)?;
        dict.set_item("volume", measures.volume)?;
        dict.set_item("manifold", report.manifold)?;
        dict.set_item("oriented", report.oriented)?;
        dict.set_item("outward", report.outward)?;
        dict.set_item("components", report.components)?;
        let loops = PyList::empty(py);
        for open in &report.open_loops {
            let names = open.patches.iter().map(|(k, _)| mesh.patches()[*k].info.name.as_str());
            let one = PyDict::new(py);
            one.set_item("patches", names.collect::<Vec<_>>())?;
            one.set_item("edges", open.edge_count())?;
            one.set_item("length", open.length)?;
            one.set_item("closed", open.closed)?;
            loops.append(one)?;
        }
        dict.set_item("open_loops", loops)?;
        Ok(dict)
    }

    /// The structured patches: index of the patch, name, tag, turned or not, and the grid of vertices.
    fn blocks<'py>(&self, py: Python<'py>) -> PyResult<Vec<BlockFacts<'py>>> {
        let patches = self.panelled.mesh.patches().iter().enumerate();
        let blocks = patches.filter_map(|(k, patch)| Some((k, &patch.info, patch.block.as_ref()?)));
        let row = |(k, info, b): (usize, &PatchInfo, &Block)| {
            let array = PyArray2::<u32>::zeros(py, [b.nu, b.nv], false);
            array.readwrite().as_slice_mut()?.copy_from_slice(&b.vertices);
            Ok((k, info.name.clone(), info.tag.word().to_owned(), b.reversed, array))
        };
        blocks.map(row).collect()
    }

    /// The patches with their measures and quality.
    fn patches<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        (0..self.panelled.mesh.patches().len()).map(|k| self.patch(py, k)).collect()
    }
}

impl PyMesh {
    fn patch<'py>(&self, py: Python<'py>, k: usize) -> PyResult<Bound<'py, PyDict>> {
        let patch = &self.panelled.mesh.patches()[k];
        let measures = measure_patch(&self.panelled.mesh, k);
        let report = alone(&self.panelled.mesh, k).map(|mesh| mesh.report());
        let closed = report.as_ref().is_some_and(|r| r.closed);
        let dict = PyDict::new(py);
        dict.set_item("name", &patch.info.name)?;
        dict.set_item("kind", &patch.info.kind)?;
        dict.set_item("tag", patch.info.tag.word())?;
        dict.set_item("start", patch.faces.start)?;
        dict.set_item("stop", patch.faces.end)?;
        let divisions = patch.block.as_ref().map(|b| (b.nu - 1, b.nv - 1));
        dict.set_item("divisions", divisions)?;
        dict.set_item("area", measures.area)?;
        dict.set_item("closed", closed)?;
        dict.set_item("volume", measures.volume)?;
        dict.set_item("vertices", report.map_or(0, |r| r.vertices))?;
        dict.set_item("quality", self.quality(py, k)?)?;
        Ok(dict)
    }

    fn quality<'py>(&self, py: Python<'py>, k: usize) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let Some(q) = quality(&self.panelled.mesh, k) else { return Ok(dict) };
        dict.set_item("quads", q.quads)?;
        dict.set_item("triangles", q.triangles)?;
        dict.set_item("without_area", q.without_area)?;
        for (name, spread) in
            [("size", q.size), ("aspect", q.aspect), ("skew", q.skew), ("warp", q.warp)]
        {
            let Spread { min, max, mean } = spread;
            let one = PyDict::new(py);
            one.set_item("min", min)?;
            one.set_item("max", max)?;
            one.set_item("mean", mean)?;
            dict.set_item(name, one)?;
        }
        Ok(dict)
    }
}

/// One patch as a mesh of its own.
fn alone(mesh: &Mesh, k: usize) -> Option<Mesh> {
    let faces = mesh.faces()[mesh.patches()[k].faces.clone()].iter().copied();
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(mesh.positions().len()).ok()?;
    builder.add_faces(PatchInfo::default(), faces).ok()?;
    Mesh::new(builder.build().into(), mesh.positions().to_vec()).ok()
}
