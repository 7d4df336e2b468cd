//! Volume meshes: arrays, their report, and the files they are written as.

use crate::arrays;
use crate::diagnostics::PyDiagnostic;
use crate::error::{model_error, plain_error};
use moldloft::diag::Sources;
use moldloft::document::Blocked;
use moldloft::export::{SolidCells, format_named, write_blocks};
use moldloft::io::cgns::{FacePart, block_boundaries};
use moldloft::io::graded_blocks::{GradedPatch, graded_block_mesh, graded_parts};
use numpy::{PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::Arc;

/// Volume blocks at one state of a model.
#[pyclass(frozen, name = "Blocks", module = "moldloft._core")]
pub struct PyBlocks {
    pub blocked: Arc<Blocked>,
    pub problems: Vec<PyDiagnostic>,
    /// The planes of symmetry and the unit of length that the model states.
    pub symmetry: String,
    pub length: String,
}

#[pymethods]
impl PyBlocks {
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let positions = self.blocked.blocks.positions();
        arrays::filled(py, [positions.len(), 3], |out| out.copy_from_slice(positions)).0
    }

    fn indices<'py>(&self, py: Python<'py>, block: usize) -> PyResult<Bound<'py, PyArray3<u32>>> {
        let block = &self.blocked.blocks.blocks()[block];
        let array = PyArray3::<u32>::zeros(py, block.size, false);
        array.readwrite().as_slice_mut()?.copy_from_slice(&block.vertices);
        Ok(array)
    }

    fn problems(&self) -> Vec<PyDiagnostic> {
        self.problems.clone()
    }

    /// Counts and the volume of the whole.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let report = &self.blocked.report;
        let dict = PyDict::new(py);
        dict.set_item("cells", report.cells)?;
        dict.set_item("vertices", report.vertices)?;
        dict.set_item("interfaces", report.interfaces)?;
        dict.set_item("volume", report.volume)?;
        dict.set_item("positive", report.positive())?;
        Ok(dict)
    }

    /// Each block's name, divisions, face names and quality.
    fn blocks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let both = self.blocked.blocks.blocks().iter().zip(&self.blocked.report.blocks);
        both.map(|(block, quality)| {
            let dict = PyDict::new(py);
            dict.set_item("name", &block.name)?;
            let [nu, nv, nw] = block.divisions();
            dict.set_item("divisions", (nu, nv, nw))?;
            let faces: Vec<&str> = block.faces.iter().map(|f| f.name.as_str()).collect();
            dict.set_item("faces", faces)?;
            dict.set_item("cells", quality.cells)?;
            dict.set_item("volume", quality.volume)?;
            dict.set_item("folded", quality.folded)?;
            dict.set_item("scaled_jacobian", quality.worst.scaled_jacobian)?;
            dict.set_item("mean_scaled_jacobian", quality.mean_scaled_jacobian)?;
            dict.set_item("worst_cell", quality.worst.cell.to_vec())?;
            dict.set_item("worst_at", quality.worst.at.to_vec())?;
            dict.set_item("aspect", quality.largest_aspect)?;
            Ok(dict)
        })
        .collect()
    }

    /// Interfaces of blocks: (block, face, begin, end) of both sides, and the CGNS transform.
    fn interfaces(&self) -> Vec<(FacePart, FacePart, [i32; 3])> {
        let (all, _) = self.blocked.blocks.interfaces();
        all.iter()
            .map(|i| {
                let side = |k: usize| (i.sides[k].0, i.sides[k].1, i.from[k], i.to[k]);
                (side(0), side(1), i.transform())
            })
            .collect()
    }

    /// Parts of faces that meet nothing: (block, face, begin, end), name and type.
    fn boundaries(&self) -> Vec<(FacePart, String, &'static str)> {
        block_boundaries(&self.blocked.blocks, &self.symmetry)
    }

    /// The parts that a blockMeshDict has: (block, begin, end).
    fn block_mesh_parts(&self, every: usize) -> Vec<(usize, [usize; 3], [usize; 3])> {
        let parts = graded_parts(&self.blocked.blocks, every);
        parts.into_iter().map(|part| (part.block, part.begin, part.end)).collect()
    }

    /// A blockMeshDict with these parts of faces, their names and types.
    fn block_mesh<'py>(
        &self,
        py: Python<'py>,
        patches: Vec<(FacePart, String, String)>,
        every: usize,
    ) -> Bound<'py, PyBytes> {
        let patches: Vec<GradedPatch> = patches
            .into_iter()
            .map(|((block, face, from, to), name, kind)| {
                let entries = format!("    type {kind};\n");
                GradedPatch { block, face, from, to, name, entries }
            })
            .collect();
        let blocks = &self.blocked.blocks;
        PyBytes::new(py, &py.detach(|| graded_block_mesh(blocks, &patches, every)))
    }

    /// The files of a format, the first of them under the name `main`: name and content of each.
    fn write<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        main: &str,
    ) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let format = format_named(format).map_err(|d| plain_error(&d.message))?;
        let (symmetry, length) = (&*self.symmetry, &*self.length);
        let cells = SolidCells { blocks: &self.blocked.blocks, symmetry, length };
        let files = py.detach(|| write_blocks(&cells, format, main));
        let files = files.map_err(|d| model_error(&d, &Sources::new()))?;
        Ok(files.into_iter().map(|f| (f.name, PyBytes::new(py, &f.bytes))).collect())
    }
}
