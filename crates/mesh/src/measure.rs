//! Area, volume and centres of meshes and their patches.

use crate::sum::chunked_sum;
use crate::{Mesh, Panel};
use moldloft_num::{Real, Vec3};
use std::ops::Range;

/// Size of a mesh or a patch, in the model's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures<T> {
    /// Surface area.
    pub area: T,
    /// Centroid of the surface, weighted by area; the origin for an empty mesh.
    pub area_centre: Vec3<T>,
    /// Integral of the unit normal; zero for a closed mesh.
    pub vector_area: Vec3<T>,
    /// Signed volume of the cone from the origin to the surface: the enclosed volume of a closed,
    /// outward mesh; meaningless for an open one.
    pub volume: T,
    /// Centroid of that volume; `None` when the volume is zero.
    pub centroid: Option<Vec3<T>>,
}

/// The integrals behind [`Measures`].
#[derive(Clone, Copy)]
struct Sums<T> {
    area: T,
    area_moment: Vec3<T>,
    vector_area: Vec3<T>,
    volume: T,
    moment: Vec3<T>,
}

impl<T: Real> Sums<T> {
    fn zero() -> Self {
        let (t, v) = (T::zero(), Vec3::zero());
        Self { area: t, area_moment: v, vector_area: v, volume: t, moment: v }
    }

    fn add(&mut self, o: Self) {
        self.area += o.area;
        self.area_moment += o.area_moment;
        self.vector_area += o.vector_area;
        self.volume += o.volume;
        self.moment += o.moment;
    }

    /// Adds the panel, seen from `origin`.
    fn take(&mut self, panel: Panel<T>, origin: Vec3<T>) {
        panel.quadrature(|p, weight| {
            let p = p - origin;
            let area = crate::panel::length(weight);
            self.area += area;
            self.area_moment += p * area;
            self.vector_area += weight;
            // Divergence theorem: V = (1/3) int p . n dA and int x dV = (1/4) int x (p . n) dA,
            // from the fields p and x p with divergences 3 and 4.
            let flux = p.dot(weight);
            self.volume += flux / 3.0;
            self.moment += p * (flux * 0.25);
        });
    }
}

/// Area, volume and centroids of the whole mesh.
///
/// Volumes are exact for the bilinear panels, areas exact for plane convex ones; against the smooth
/// surface both converge at second order in the panel size.
pub fn measure<T: Real>(mesh: &Mesh<T>) -> Measures<T> {
    over(mesh, 0..mesh.faces().len())
}

/// Area, and cone volume from the origin, of one patch by its index.
///
/// # Panics
/// When there is no such patch.
pub fn measure_patch<T: Real>(mesh: &Mesh<T>, patch: usize) -> Measures<T> {
    over(mesh, mesh.patches()[patch].faces.clone())
}

fn over<T: Real>(mesh: &Mesh<T>, faces: Range<usize>) -> Measures<T> {
    let sums = chunked_sum(
        faces,
        Sums::zero,
        |sum, f| sum.take(mesh.panel(f), Vec3::zero()),
        |sum, part| sum.add(part),
    );
    let centre_of = |moment: Vec3<T>, size: T| (size.re() != 0.0).then(|| moment / size);
    Measures {
        area: sums.area,
        area_centre: centre_of(sums.area_moment, sums.area).unwrap_or_default(),
        vector_area: sums.vector_area,
        volume: sums.volume,
        centroid: centre_of(sums.moment, sums.volume),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixtures::{open_half_box, sphere};
    use moldloft_num::Dual;
    use std::f64::consts::PI;

    #[test]
    fn a_box_exactly() {
        let whole = open_half_box().with_mirror_image(1, "'").unwrap();
        let m = measure(&whole);
        assert!((m.area - 2.0 * (4.0 + 6.0 + 6.0)).abs() < 1e-13);
        assert!((m.volume - 12.0).abs() < 1e-14);
        assert!(m.centroid.unwrap().distance(Vec3::of(1.0, 0.0, 1.5)) < 1e-14);
        assert!(m.vector_area.norm() < 1e-14);
        assert!((measure_patch(&whole, 0).area - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_sphere_at_second_order() {
        let error = |n| {
            let m = measure(&sphere(n, 2.0, Vec3::of(1.0, -2.0, 3.0)));
            assert!(m.centroid.unwrap().distance(Vec3::of(1.0, -2.0, 3.0)) < 1e-11);
            [m.area / (16.0 * PI) - 1.0, m.volume / (32.0 * PI / 3.0) - 1.0]
        };
        let (coarse, fine) = (error(20), error(40));
        for k in 0..2 {
            let rate = (coarse[k] / fine[k]).log2();
            assert!((rate - 2.0).abs() < 0.05, "{coarse:?} {fine:?}");
        }
    }

    #[test]
    fn the_volume_grows_by_the_area_of_the_facets() {
        // V and A of similar bodies: dV/dr = 3 V / r, dA/dr = 2 A / r.
        let m = measure(&sphere(9, Dual::<1>::seeded(1.5, 0), Vec3::zero()));
        assert!((m.volume.eps[0] - 3.0 * m.volume.re / 1.5).abs() < 1e-12);
        assert!((m.area.eps[0] - 2.0 * m.area.re / 1.5).abs() < 1e-12);
    }
}
