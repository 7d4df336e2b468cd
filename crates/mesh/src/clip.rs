//! Panels cut at the water.

use crate::{Mesh, MeshError, Panel, Tag, TopologyBuilder};
use moldloft_num::{Real, Vec3};
use std::collections::HashMap;

/// The part of a panel below a level, at most six corners.
#[derive(Clone, Copy)]
pub(crate) struct ClippedPanel<T> {
    points: [Vec3<T>; 6],
    /// Whether each corner lies on the level.
    wet: [bool; 6],
    len: usize,
}

impl<T: Real> ClippedPanel<T> {
    fn push(&mut self, point: Vec3<T>, on_level: bool) {
        self.points[self.len] = point;
        self.wet[self.len] = on_level;
        self.len += 1;
    }

    /// The sides that lie in the level, in the panel's direction.
    pub fn waterline(&self) -> impl Iterator<Item = (Vec3<T>, Vec3<T>)> + '_ {
        let next = |k: usize| (k + 1) % self.len;
        (0..self.len)
            .filter(move |&k| self.wet[k] && self.wet[next(k)])
            .map(move |k| (self.points[k], self.points[next(k)]))
    }

    /// The pieces to integrate: the panel itself where it is not cut, else a triangle, a bilinear
    /// quad, or a fan of triangles about the mean of the corners.
    pub fn pieces(&self, mut at: impl FnMut(Panel<T>)) {
        match *self.corners() {
            [a, b, c] => at(Panel::Triangle([a, b, c])),
            [a, b, c, d] => at(Panel::Quad([a, b, c, d])),
            ref corners => {
                let n = corners.len();
                let sum = corners.iter().fold(Vec3::zero(), |s, &p| s + p);
                let middle = sum / T::from(n as f64);
                for k in 0..n {
                    at(Panel::Triangle([corners[k], corners[(k + 1) % n], middle]));
                }
            }
        }
    }

    /// The corners in order.
    pub fn corners(&self) -> &[Vec3<T>] {
        &self.points[..self.len]
    }
}

/// The part of the panel below `z = level`, or `None` when no corner is strictly below it, so a
/// panel that lies in the level counts as above. The real parts decide; corners made on the level
/// have z equal to it. Panels that share a side are cut at the same point, to the bit.
pub(crate) fn below<T: Real>(panel: &Panel<T>, level: T) -> Option<ClippedPanel<T>> {
    let corners = panel.corners();
    let c = level.re();
    if corners.iter().all(|p| p.z.re() >= c) {
        return None;
    }
    let mut cut = ClippedPanel { points: [Vec3::zero(); 6], wet: [false; 6], len: 0 };
    for (k, &p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        let (pz, qz) = (p.z.re(), q.z.re());
        if pz <= c {
            cut.push(p, pz == c);
        }
        if pz < c && qz > c {
            cut.push(crossing(p, q, level), true);
        } else if pz > c && qz < c {
            cut.push(crossing(q, p, level), true);
        }
    }
    Some(cut)
}

impl<T: Real> Mesh<T> {
    /// The part of the mesh below `z = level`, its cut sides sharing their new vertices by identity;
    /// open along the cut. Panels in the level are left out, but for those of lids. Patches keep their names, those that
    /// are cut lose their grids; patches that are wholly above stay, empty.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`].
    pub fn immersed(&self, level: T) -> Result<Self, MeshError> {
        let c = level.re();
        let z = |v: u32| self.positions()[v as usize].z.re();
        let mut positions = self.positions().to_vec();
        // Looked up only, never walked, so its order does not show.
        let mut cuts: HashMap<[u32; 2], u32> = HashMap::new();
        let mut patches = Vec::new();
        for patch in self.patches() {
            let mut faces = Vec::new();
            let mut whole = true;
            let is_lid = patch.info.tag == Tag::Lid;
            for &face in &self.faces()[patch.faces.clone()] {
                let corners = if crate::is_triangle(face) { 3 } else { 4 };
                if face[..corners].iter().all(|&v| z(v) <= c) {
                    if is_lid || face[..corners].iter().any(|&v| z(v) < c) {
                        faces.push(face);
                    } else {
                        whole = false;
                    }
                    continue;
                }
                whole = false;
                if face[..corners].iter().all(|&v| z(v) >= c) {
                    continue;
                }
                let mut ring = Vec::with_capacity(6);
                for k in 0..corners {
                    let (p, q) = (face[k], face[(k + 1) % corners]);
                    if z(p) <= c {
                        ring.push(p);
                    }
                    if (z(p) < c && z(q) > c) || (z(p) > c && z(q) < c) {
                        let (low, high) = if z(p) < c { (p, q) } else { (q, p) };
                        ring.push(*cuts.entry([low, high]).or_insert_with(|| {
                            let [a, b] = [low, high].map(|v| positions[v as usize]);
                            positions.push(crossing(a, b, level));
                            (positions.len() - 1) as u32
                        }));
                    }
                }
                match *ring.as_slice() {
                    [a, b, c] => faces.push([a, b, c, c]),
                    [a, b, c, d] => faces.push([a, b, c, d]),
                    [a, b, c, d, e] => faces.extend([[a, b, c, d], [a, d, e, e]]),
                    [a, b, c, d, e, f] => faces.extend([[a, b, c, d], [a, d, e, f]]),
                    _ => {}
                }
            }
            patches.push((patch.info.clone(), faces, patch.block.clone().filter(|_| whole)));
        }
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        for (info, faces, block) in patches {
            builder.add_faces_of(info, faces.into_iter(), block)?;
        }
        Mesh::new(builder.build().into(), positions)
    }
}

/// Where the line from `low` to `high` passes the level.
fn crossing<T: Real>(low: Vec3<T>, high: Vec3<T>, level: T) -> Vec3<T> {
    let t = (level - low.z) / (high.z - low.z);
    Vec3 { z: level, ..low + (high - low) * t }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: [f64; 4]) -> Panel<f64> {
        let xy = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        Panel::Quad([0, 1, 2, 3].map(|k| Vec3::of(xy[k].0, xy[k].1, z[k])))
    }

    #[test]
    fn corners_on_the_level_are_not_doubled() {
        assert!(below(&square([0.0; 4]), 0.0).is_none());
        assert!(below(&square([0.0, 0.0, 1.0, 1.0]), 0.0).is_none());
        let whole = below(&square([-1.0, -1.0, 0.0, 0.0]), 0.0).unwrap();
        assert_eq!((whole.corners().len(), whole.waterline().count()), (4, 1));
        let half = below(&square([-1.0, 0.0, 1.0, 0.0]), 0.0).unwrap();
        assert_eq!((half.corners().len(), half.waterline().count()), (3, 1));
        let five = below(&square([-1.0, -1.0, -1.0, 1.0]), 0.0).unwrap();
        assert_eq!((five.corners().len(), five.waterline().count()), (5, 1));
        let saddle = below(&square([-1.0, 1.0, -1.0, 1.0]), 0.0).unwrap();
        assert_eq!((saddle.corners().len(), saddle.waterline().count()), (6, 2));
    }

    #[test]
    fn pieces_cover_the_cut() {
        for z in [[-1.0, -1.0, -1.0, -1.0], [-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, -1.0, 2.0]] {
            let mut sum = Vec3::zero();
            let cut = below(&square(z), 0.0).unwrap();
            cut.pieces(|p| sum += p.vector_area());
            let corners = cut.corners();
            let boundary = (0..corners.len())
                .fold(Vec3::zero(), |s, k| s + corners[k].cross(corners[(k + 1) % corners.len()]));
            assert!(sum.distance(boundary * 0.5) < 1e-15);
        }
    }

    #[test]
    fn the_immersed_mesh_floats_alike() {
        let ball = crate::report::fixtures::sphere(20, 1.0, Vec3::zero());
        let options = crate::FloatOptions { level: 0.13, ..Default::default() };
        let immersed = ball.immersed(0.13).unwrap();
        let (a, b) = (crate::hydrostatics(&ball, options), crate::hydrostatics(&immersed, options));
        assert!((a.volume - b.volume).abs() < 1e-14 && b.open_edges == 0);
        let report = immersed.report();
        assert_eq!((report.open_loops.len(), report.components, report.euler), (1, 1, 1));
        assert!(report.oriented && report.manifold && report.open_loops[0].bounds.low.z == 0.13);
        assert!(ball.immersed(-2.0).unwrap().faces().is_empty());
        assert_eq!(ball.immersed(2.0).unwrap(), ball);
    }
}
