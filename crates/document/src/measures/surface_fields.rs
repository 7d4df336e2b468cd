//! Curvature, reflection and normal fields of surfaces at the vertices of the mesh.

use crate::Document;
use moldloft_diag::Diagnostic;
use moldloft_fair::surface::{self, PointField, SurfaceAnalysis};
use moldloft_num::Vec3;
use moldloft_parallel::prelude::*;

/// The fields of one structured patch, point (i, j) of its block at `i * nv + j`.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchAnalysis {
    /// The patch's name.
    pub patch: String,
    /// Curvatures, reflections and normals, and of a plane patch the metric of its grid.
    pub fields: Vec<PointField>,
}

/// Maximum distance of a point of a plane patch from its plane, relative to its extent.
const PLANE: f64 = 1e-12;

impl Document {
    /// Curvatures, isophotes, zebra stripes and normals at the vertices of the structured patches:
    /// of the surfaces themselves, not of the panels. Normals point as those of the panels, and a
    /// curvature is positive where the surface bends towards them. Patches in a plane of constant z
    /// have the metric `eta_y` of their grid too.
    ///
    /// # Errors
    /// As [`Document::panelled`].
    pub fn patch_fields(&mut self) -> Result<Vec<PatchAnalysis>, Diagnostic> {
        let panelled = self.panelled()?;
        let Some(places) = panelled.panelling.parameters(self.graph()) else {
            return Ok(Vec::new());
        };
        let patches = panelled.mesh.patches().iter().zip(places);
        Ok(patches
            .map(|(patch, (surface, uv))| {
                let turned = patch.block.as_ref().is_some_and(|b| b.reversed);
                let one = |&[u, v]: &[f64; 2]| -> Option<SurfaceAnalysis> {
                    let look = surface::look(&*surface, u, v)?;
                    Some(if turned { look.turned() } else { look })
                };
                let looks: Vec<_> = uv.par_iter().map(one).collect();
                let mut fields = surface::fields(&looks);
                if let Some(block) = &patch.block {
                    let at = |&k: &u32| panelled.mesh.positions()[k as usize];
                    let grid: Vec<Vec3> = block.vertices.iter().map(at).collect();
                    fields.extend(metric(&grid, block.nu, block.nv));
                }
                PatchAnalysis { patch: patch.info.name.clone(), fields }
            })
            .collect())
    }
}

fn metric(grid: &[Vec3], nu: usize, nv: usize) -> Option<PointField> {
    let range = |f: fn(&Vec3) -> f64| {
        let all = grid.iter().map(f);
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let extent = range(|p| p.x).max(range(|p| p.y));
    if range(|p| p.z).is_nan() || range(|p| p.z) > PLANE * extent {
        return None;
    }
    let values = surface::eta_y(grid, nu, nv).ok()?;
    Some(PointField { name: "eta_y", components: 1, values })
}
