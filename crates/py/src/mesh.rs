//! Meshes: arrays and their report.

use crate::arrays;
use crate::error::plain_error;
use crate::work::unlocked_if;
use moldloft::document::Panelled;
use moldloft::mesh::{
    Block, Closes, Mesh, PatchInfo, PatchQuality, Statistics, TopologyBuilder, WorstPanel, closure,
    measure, measure_patch, qualities, united,
};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;

/// Number of panels from which work is done in another thread.
const LARGE: usize = 50_000;

/// Patch, name, tag, turned, vertices.
type BlockFacts<'py> = (usize, String, String, bool, Bound<'py, PyArray2<u32>>);

/// Panels at one state of a model.
#[pyclass(frozen, name = "Mesh", module = "moldloft._core")]
pub struct PyMesh {
    panelled: Arc<Panelled>,
    /// Some of its patches, unless all were requested.
    part: Option<Mesh>,
}

impl PyMesh {
    pub fn new(panelled: Arc<Panelled>, part: Option<Mesh>) -> Self {
        Self { panelled, part }
    }

    /// Work that is long for many panels, in another thread then, so that Ctrl-C is handled.
    fn of_mesh<R: Send + 'static>(
        slf: &Bound<'_, Self>,
        work: impl FnOnce(&Mesh) -> R + Send + 'static,
    ) -> PyResult<R> {
        let large = slf.get().mesh().faces().len() > LARGE;
        let own = slf.clone().unbind();
        unlocked_if(slf.py(), large, move || work(own.get().mesh()))
    }

    fn mesh(&self) -> &Mesh {
        self.part.as_ref().unwrap_or(&self.panelled.mesh)
    }
}

#[pymethods]
impl PyMesh {
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let positions = self.mesh().positions();
        arrays::filled(py, [positions.len(), 3], |out| out.copy_from_slice(positions)).0
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let faces = self.mesh().faces();
        let array = PyArray2::<u32>::zeros(py, [faces.len(), 4], false);
        array.readwrite().as_slice_mut()?.copy_from_slice(faces.as_flattened());
        Ok(array)
    }

    /// Counts, measures, closure and orientation of the whole.
    fn summary<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let (py, mesh) = (slf.py(), slf.get().mesh());
        let (report, measures) = Self::of_mesh(slf, |mesh| (mesh.report(), measure(mesh)))?;
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
        let patches = self.mesh().patches().iter().enumerate();
        let blocks = patches.filter_map(|(k, patch)| Some((k, &patch.info, patch.block.as_ref()?)));
        let row = |(k, info, b): (usize, &PatchInfo, &Block)| {
            let array = PyArray2::<u32>::zeros(py, [b.nu, b.nv], false);
            array.readwrite().as_slice_mut()?.copy_from_slice(&b.vertices);
            Ok((k, info.name.clone(), info.tag.word().to_owned(), b.reversed, array))
        };
        blocks.map(row).collect()
    }

    /// The patches with their measures and quality.
    fn patches<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let all = Self::of_mesh(slf, qualities)?;
        all.iter().enumerate().map(|(k, q)| slf.get().patch(slf.py(), k, q.as_ref())).collect()
    }

    /// Vertices and faces of the outer skin of its bodies.
    fn united<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
        let skin = Self::of_mesh(slf, united)?.map_err(plain_error)?;
        let (py, points) = (slf.py(), &skin.positions);
        let vertices = arrays::filled(py, [points.len(), 3], |out| out.copy_from_slice(points)).0;
        let faces = PyArray2::<u32>::zeros(py, [skin.faces.len(), 4], false);
        faces.readwrite().as_slice_mut()?.copy_from_slice(skin.faces.as_flattened());
        Ok((vertices, faces))
    }

    /// Open edges, by patch and edge; the remedy of each; and whether these are all.
    fn closure<'py>(
        slf: &Bound<'py, Self>,
        mirrors: &str,
        level: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let axes: Vec<u8> =
            (0..3).filter(|&k| mirrors.contains(['x', 'y', 'z'][k as usize])).collect();
        let (py, mesh) = (slf.py(), slf.get().mesh());
        let found = Self::of_mesh(slf, move |mesh| closure(mesh, &axes, level))?;
        let dict = PyDict::new(py);
        dict.set_item("closed", found.closed())?;
        dict.set_item("closed_with_lids_and_mirror", found.closed_with_lids_and_mirror())?;
        let edges = PyList::empty(py);
        for open in &found.open {
            let one = PyDict::new(py);
            one.set_item("patch", &mesh.patches()[open.patch].info.name)?;
            one.set_item("edge", open.edge.to_string())?;
            let closes = match open.closes {
                Closes::Mirror(axis) => {
                    Some(["mirror x", "mirror y", "mirror z"][usize::from(axis)])
                }
                Closes::Lid => Some("lid"),
                Closes::Nothing => None,
            };
            one.set_item("closed_by", closes)?;
            one.set_item("panels", open.panels)?;
            one.set_item("length", open.length)?;
            one.set_item("low", open.bounds.low.to_array().to_vec())?;
            one.set_item("high", open.bounds.high.to_array().to_vec())?;
            edges.append(one)?;
        }
        dict.set_item("edges", edges)?;
        Ok(dict)
    }
}

impl PyMesh {
    fn patch<'py>(
        &self,
        py: Python<'py>,
        k: usize,
        quality: Option<&PatchQuality>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let patch = &self.mesh().patches()[k];
        let measures = measure_patch(self.mesh(), k);
        let report = alone(self.mesh(), k).map(|mesh| mesh.report());
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
        dict.set_item("tags", &patch.info.tags)?;
        dict.set_item("colour", patch.info.colour)?;
        dict.set_item("quality", self.quality(py, quality)?)?;
        Ok(dict)
    }

    fn quality<'py>(
        &self,
        py: Python<'py>,
        quality: Option<&PatchQuality>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let Some(q) = quality else { return Ok(dict) };
        dict.set_item("quads", q.quads)?;
        dict.set_item("triangles", q.triangles)?;
        dict.set_item("without_area", q.without_area)?;
        let worst = q.worst.map(|w| w.map(Some)).unwrap_or_default();
        let measures = [
            ("size", q.size, None),
            ("aspect", q.aspect, worst[0]),
            ("skew", q.skew, worst[1]),
            ("warp", q.warp, worst[2]),
            ("angle", q.angle, q.sharpest),
            ("jump", q.jump, worst[3]),
        ];
        for (name, spread, worst) in measures {
            let Statistics { min, max, mean } = spread;
            let one = PyDict::new(py);
            one.set_item("min", min)?;
            one.set_item("max", max)?;
            one.set_item("mean", mean)?;
            if let Some(WorstPanel { face, centre }) = worst {
                let topology = self.mesh().topology();
                let patch = &topology.patches()[topology.patch_of(face)];
                one.set_item("worst", face)?;
                one.set_item("panel", face - patch.faces.start)?;
                one.set_item("place", topology.place_of(face).map(|[i, j]| (i, j)))?;
                one.set_item("centre", centre.to_array().to_vec())?;
            }
            dict.set_item(name, one)?;
        }
        Ok(dict)
    }
}

/// One patch as a mesh of its own, with the vertices that it uses.
fn alone(mesh: &Mesh, k: usize) -> Option<Mesh> {
    let faces = &mesh.faces()[mesh.patches()[k].faces.clone()];
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.partition_point(|&u| u < v) as u32;
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(used.len()).ok()?;
    builder.add_faces(PatchInfo::default(), faces.iter().map(|f| f.map(number))).ok()?;
    let positions = used.iter().map(|&v| mesh.positions()[v as usize]).collect();
    Mesh::new(builder.build().into(), positions).ok()
}
