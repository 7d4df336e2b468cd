//! Facets of sets.

use super::arguments::{array, attributes};
use crate::error::plain_error;
use crate::work::{unlocked, unlocked_if};
use moldloft::field::{Facets, Pieces, crossing_faces};
use moldloft::io::{LinesAndPoints, obj, ply, stl, threemf, vtk};
use moldloft::mesh::{Mesh, PatchInfo, TopologyBuilder, measure};
use moldloft::num::{Box3, Plane, Vec3};
use moldloft::picture::{Options, StyledPolyline, patch_colour, render};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use std::sync::Arc;

/// Facets of a set: of its solids, sheets, wires and points.
#[pyclass(frozen, name = "Facets", module = "moldloft._core")]
pub struct PyFacets {
    pieces: Pieces,
    over: Box3,
    /// Solids and sheets in one.
    mesh: Mesh,
    loose: LinesAndPoints,
}

/// Number of triangles from which work is done in another thread.
const LARGE: usize = 20_000;

impl PyFacets {
    /// Work that is long for many triangles, in another thread then, so that Ctrl-C is handled.
    fn of_facets<R: Send + 'static>(
        slf: &Bound<'_, Self>,
        work: impl FnOnce(&Self) -> R + Send + 'static,
    ) -> PyResult<R> {
        let large = slf.get().mesh.faces().len() > LARGE;
        let own = slf.clone().unbind();
        unlocked_if(slf.py(), large, move || work(own.get()))
    }

    pub fn new(pieces: Pieces, over: Box3) -> Self {
        let solid = solid_of(&pieces);
        let mut loose = LinesAndPoints::default();
        let mut mesh = solid.mesh.clone();
        if let Pieces::Mixed(mixed) = &pieces {
            let mut builder = TopologyBuilder::extending((**solid.mesh.topology()).clone());
            let mut positions = solid.mesh.positions().to_vec();
            let mut whole = true;
            for sheet in &mixed.sheets {
                let start = positions.len() as u32;
                positions.extend_from_slice(sheet.mesh.positions());
                whole &= builder.add_vertices(sheet.mesh.positions().len()).is_ok();
                for patch in sheet.mesh.patches() {
                    let faces = &sheet.mesh.faces()[patch.faces.clone()];
                    let faces = faces.iter().map(|f| f.map(|v| v + start));
                    whole &= builder.add_faces(patch.info.clone(), faces).is_ok();
                }
            }
            if let (true, Ok(all)) = (whole, Mesh::new(builder.build().into(), positions)) {
                mesh = all;
            }
            for wire in &mixed.wires {
                let mut points = wire.points.clone();
                points.extend(wire.points.first().copied().filter(|_| wire.closed));
                loose.wires.push(("wire".into(), points));
            }
            loose.dots = mixed.points.iter().map(|d| ("point".into(), d.point)).collect();
        }
        Self { pieces, over, mesh, loose }
    }

    /// The facets of a set without sheets, to be taken over from.
    pub fn solid(&self) -> Option<Arc<Facets>> {
        match &self.pieces {
            Pieces::Solid(facets) => Some(facets.clone()),
            Pieces::Mixed(_) => None,
        }
    }
}

fn solid_of(pieces: &Pieces) -> &Facets {
    match pieces {
        Pieces::Solid(facets) => facets,
        Pieces::Mixed(mixed) => &mixed.solid,
    }
}

#[pymethods]
impl PyFacets {
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array(py, self.mesh.positions())
    }

    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let flat: Vec<u32> = self.mesh.faces().iter().flat_map(|f| [f[0], f[1], f[2]]).collect();
        PyArray1::from_vec(py, flat).reshape([self.mesh.faces().len(), 3])
    }

    /// The patches: name, kind, colour, first triangle and one past the last, whether it is a sheet.
    fn patches(&self) -> Vec<(String, String, Option<u8>, usize, usize, bool)> {
        let solids = solid_of(&self.pieces).mesh.patches().len();
        let one = |(k, p): (usize, &moldloft::mesh::Patch)| {
            let PatchInfo { name, kind, colour, .. } = &p.info;
            (name.clone(), kind.clone(), *colour, p.faces.start, p.faces.end, k >= solids)
        };
        self.mesh.patches().iter().enumerate().map(one).collect()
    }

    /// The attributes of each patch: those of the solids, then those of the sheets.
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let solid = solid_of(&self.pieces);
        let list = PyList::empty(py);
        for &leaf in &solid.patch_leaves {
            list.append(attributes(py, &solid.leaves[leaf].attributes)?)?;
        }
        if let Pieces::Mixed(mixed) = &self.pieces {
            for sheet in &mixed.sheets {
                list.append(attributes(py, &mixed.leaves[sheet.leaf].attributes)?)?;
            }
        }
        Ok(list)
    }

    fn wires<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray2<f64>>> {
        self.loose.wires.iter().map(|(_, points)| array(py, points)).collect()
    }

    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let points: Vec<Vec3> = self.loose.dots.iter().map(|(_, p)| *p).collect();
        array(py, &points)
    }

    fn summary<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let (py, this) = (slf.py(), slf.get());
        let solid = solid_of(&this.pieces);
        let (report, area, moments) = Self::of_facets(slf, |facets| {
            let solid = solid_of(&facets.pieces);
            (solid.mesh.report(), measure(&facets.mesh).area, solid.moments())
        })?;
        let dict = PyDict::new(py);
        dict.set_item("closed", report.closed)?;
        dict.set_item("manifold", report.manifold)?;
        dict.set_item("oriented", report.oriented)?;
        dict.set_item("components", report.components)?;
        dict.set_item("euler", report.euler)?;
        dict.set_item("area", area)?;
        dict.set_item("volume", measure(&solid.mesh).volume)?;
        dict.set_item("best_volume", moments.volume())?;
        dict.set_item("cells", solid.cells)?;
        dict.set_item("step", solid.step)?;
        dict.set_item("blocks", solid.blocks)?;
        dict.set_item("computed", solid.computed)?;
        dict.set_item("low", this.over.low.to_array())?;
        dict.set_item("high", this.over.high.to_array())?;
        Ok(dict)
    }

    /// The facets with fewer triangles.
    fn simplified(&self, py: Python<'_>, accuracy: f64) -> PyResult<Self> {
        let pieces = self.pieces.clone();
        let simple = unlocked(py, move || pieces.simplified(accuracy))?.map_err(plain_error)?;
        Ok(Self::new(simple, self.over))
    }

    /// The volumes of the connected parts of the solids' surface, the number of bodies, and the
    /// contacts of bodies.
    #[allow(clippy::type_complexity)]
    fn shells<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Vec<f64>, usize, Bound<'py, PyArray2<f64>>)> {
        let (shells, touching) = Self::of_facets(slf, |facets| {
            let solid = solid_of(&facets.pieces);
            let volumes: Vec<f64> = solid.shells().iter().map(|s| s.volume).collect();
            (volumes, solid.touching())
        })?;
        let bodies = shells.iter().filter(|volume| **volume > 0.0).count();
        Ok((shells, bodies, array(slf.py(), &touching)))
    }

    /// The boxes whose triangles cut others.
    fn undecided(&self) -> Vec<([f64; 3], [f64; 3])> {
        let solid = solid_of(&self.pieces);
        solid.undecided.iter().map(|b| (b.low.to_array(), b.high.to_array())).collect()
    }

    /// Regions that the corners of cells do not resolve: the box, the volume it may hold, and true
    /// when there certainly is some.
    #[allow(clippy::type_complexity)]
    fn unresolved(&self) -> Vec<(([f64; 3], [f64; 3]), f64, bool)> {
        let solid = solid_of(&self.pieces);
        let row = |u: &moldloft::field::Unresolved| {
            ((u.place.low.to_array(), u.place.high.to_array()), u.volume, u.missed)
        };
        solid.open_places().iter().map(row).collect()
    }

    /// The boxes with an edge or corner that is cut off.
    fn blunt(&self) -> Vec<([f64; 3], [f64; 3])> {
        let solid = solid_of(&self.pieces);
        solid.blunt.iter().map(|b| (b.low.to_array(), b.high.to_array())).collect()
    }

    /// Distances of triangle centres and vertices from their surfaces, the solids' only.
    fn distances<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
        let (centres, worst) = Self::of_facets(slf, |facets| {
            let solid = solid_of(&facets.pieces);
            (solid.centre_distances(), solid.worst_vertex())
        })?;
        Ok((PyArray1::from_vec(slf.py(), centres), worst))
    }

    /// Number of intersecting pairs of triangles.
    fn crossings(slf: &Bound<'_, Self>) -> PyResult<usize> {
        Self::of_facets(slf, |facets| crossing_faces(&facets.mesh, None).len())
    }

    #[allow(clippy::type_complexity)]
    fn section<'py>(
        slf: &Bound<'py, Self>,
        normal: [f64; 3],
        point: [f64; 3],
    ) -> PyResult<Vec<(Bound<'py, PyArray2<f64>>, bool)>> {
        let plane = Plane { point: Vec3::from(point), normal: Vec3::from(normal) };
        let contours =
            Self::of_facets(slf, move |facets| solid_of(&facets.pieces).section(&plane))?;
        let (contours, py) = (contours.map_err(plain_error)?, slf.py());
        Ok(contours.into_iter().map(|c| (array(py, &c.points), c.closed)).collect())
    }

    fn write<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        stem: &str,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let (mesh, loose) = (&self.mesh, &self.loose);
        let refused = |name: &'static str| loose.refused(name).map_err(plain_error);
        let bytes = match format {
            "obj" => obj::write_with(mesh, loose),
            "vtp" => vtk::polydata_with(mesh, loose, &[]),
            "stl" => {
                refused("stl")?;
                stl::write(mesh, stem)
            }
            "ply" => {
                refused("ply")?;
                ply::write(mesh)
            }
            "glb" => {
                refused("glb")?;
                moldloft::io::gltf::write(mesh, stem, 1.0, patch_colour)
            }
            "3mf" => {
                refused("3mf")?;
                threemf::write(mesh, stem, "meter", patch_colour)
            }
            _ => {
                let known = "stl, obj, ply, glb, vtp, 3mf";
                return Err(plain_error(format!(
                    "facets are not written as `{format}`; they are as: {known}"
                )));
            }
        };
        Ok(PyBytes::new(py, &bytes.map_err(plain_error)?))
    }

    /// A shaded picture.
    fn picture<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        height: usize,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let line = |(_, points): &(String, Vec<Vec3>)| StyledPolyline {
            points: points.clone(),
            colour: [0x30, 0x36, 0x40],
            width: 3.0,
            on_surface: false,
        };
        let lines: Vec<StyledPolyline> = self.loose.wires.iter().map(line).collect();
        let options = Options { width, height, edges: false, ..Options::default() };
        let png = py.detach(|| render(&self.mesh, &lines, &options)).map_err(plain_error)?;
        Ok(PyBytes::new(py, &png))
    }
}
