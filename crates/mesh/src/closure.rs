//! Open edges of a mesh, by the names of patches and edges, and remedies.

use crate::half_edge::{edges, half_edges};
use crate::{Block, Mesh};
use moldloft_num::{Box3, Real, Vec3};
use std::collections::BTreeMap;

/// Name of an edge of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeName {
    /// Edge 0..4 of a structured patch: v = 0, u = 1, v = 1, u = 0.
    Side(u8),
    /// Inside a structured patch, or an edge of a patch without a grid.
    Other,
}

impl std::fmt::Display for EdgeName {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Side(0) => "v = 0",
            Self::Side(1) => "u = 1",
            Self::Side(2) => "v = 1",
            Self::Side(_) => "u = 0",
            Self::Other => "inside",
        })
    }
}

/// Elements besides panels that close an open edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Closes {
    /// The mirror image in the plane through zero of axis 0..3.
    Mirror(u8),
    /// A lid at the level of the water.
    Lid,
    /// Nothing: it leaks.
    Nothing,
}

/// An open edge of a patch, or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenEdge {
    /// Index of the patch.
    pub patch: usize,
    /// Edge of the patch.
    pub edge: EdgeName,
    /// Remedy.
    pub closes: Closes,
    /// Number of open panel edges.
    pub panels: usize,
    /// Their length in the model's unit.
    pub length: f64,
    /// The box around them.
    pub bounds: Box3,
}

/// Open edges, in the order of patches and edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Closure {
    /// The open edges.
    pub open: Vec<OpenEdge>,
    /// True when there is a panel.
    pub any: bool,
}

impl Closure {
    /// True when no edge is open.
    pub fn closed(&self) -> bool {
        self.any && self.open.is_empty()
    }

    /// True when mirror images and lids close all open edges.
    pub fn closed_with_lids_and_mirror(&self) -> bool {
        self.any && self.leaks().next().is_none()
    }

    /// The open edges that nothing closes.
    pub fn leaks(&self) -> impl Iterator<Item = &OpenEdge> {
        self.open.iter().filter(|e| e.closes == Closes::Nothing)
    }
}

/// Two heights nearer to each other than this, relative to the mesh's size, count as one:
/// waterlines are found by iteration.
const LEVEL_ACCURACY: f64 = 1e-9;

/// Open edges with their names.
///
/// `mirrors` are the axes whose plane through zero mirrors the model: an open panel edge with both
/// ends exactly in it is closed by the image. `level` is the height of the water: an open panel edge
/// there is closed by a lid.
pub fn closure<T: Real>(mesh: &Mesh<T>, mirrors: &[u8], level: Option<f64>) -> Closure {
    let topology = mesh.topology();
    let size = mesh.bounds().diagonal();
    let mut open: BTreeMap<(usize, EdgeName, Closes), (usize, f64, Box3)> = BTreeMap::new();
    let mut rims: Vec<Option<Rim>> = vec![None; topology.patches().len()];
    for edge in edges(&half_edges(topology)) {
        let [side] = edge else { continue };
        let patch = topology.patch_of(side.face());
        let block = topology.patches()[patch].block.as_ref();
        let name = match block {
            Some(block) => {
                rims[patch].get_or_insert_with(|| Rim::new(block)).edge(side.from, side.to)
            }
            None => EdgeName::Other,
        };
        let at = |v: u32| mesh.positions()[v as usize].re();
        let (a, b) = (at(side.from), at(side.to));
        let on = |axis: u8| a[usize::from(axis)] == 0.0 && b[usize::from(axis)] == 0.0;
        let near = |p: Vec3, z: f64| (p.z - z).abs() <= LEVEL_ACCURACY * size;
        let closes = match mirrors.iter().find(|&&axis| on(axis)) {
            Some(&axis) => Closes::Mirror(axis),
            None if level.is_some_and(|z| near(a, z) && near(b, z)) => Closes::Lid,
            None => Closes::Nothing,
        };
        let entry = open.entry((patch, name, closes)).or_insert((0, 0.0, Box3::EMPTY));
        entry.0 += 1;
        entry.1 += a.distance(b);
        entry.2 = entry.2.including(a).including(b);
    }
    let open = open
        .into_iter()
        .map(|((patch, edge, closes), (panels, length, bounds))| OpenEdge {
            patch,
            edge,
            closes,
            panels,
            length,
            bounds,
        })
        .collect();
    Closure { open, any: !topology.faces().is_empty() }
}

/// The panel edges of a block's four edges, ordered.
#[derive(Clone)]
struct Rim(Vec<(u32, u32, u8)>);

impl Rim {
    fn new(block: &Block) -> Self {
        let (nu, nv) = (block.nu, block.nv);
        let mut rim = Vec::with_capacity(2 * (nu + nv));
        let mut along = |k: u8, n: usize, at: &dyn Fn(usize) -> u32| {
            for i in 1..n {
                let (a, b) = (at(i - 1), at(i));
                rim.push((a.min(b), a.max(b), k));
            }
        };
        along(0, nu, &|i| block.at(i, 0));
        along(1, nv, &|j| block.at(nu - 1, j));
        along(2, nu, &|i| block.at(i, nv - 1));
        along(3, nv, &|j| block.at(0, j));
        rim.sort_unstable();
        Self(rim)
    }

    fn edge(&self, a: u32, b: u32) -> EdgeName {
        let (a, b) = (a.min(b), a.max(b));
        let at = self.0.partition_point(|&(p, q, _)| (p, q) < (a, b));
        match self.0.get(at) {
            Some(&(p, q, k)) if (p, q) == (a, b) => EdgeName::Side(k),
            _ => EdgeName::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixtures::{grid, open_half_box, sphere};

    #[test]
    fn open_edges_have_names() {
        let plate = grid(4, 3, |u, v| Vec3::<f64>::of(u, v, 0.25));
        let c = closure(&plate, &[1], Some(0.25));
        let names: Vec<_> =
            c.open.iter().map(|e| (e.edge.to_string(), e.closes, e.panels)).collect();
        assert_eq!(
            names,
            [
                ("v = 0".to_string(), Closes::Mirror(1), 3),
                ("u = 1".to_string(), Closes::Lid, 2),
                ("v = 1".to_string(), Closes::Lid, 3),
                ("u = 0".to_string(), Closes::Lid, 2),
            ]
        );
        assert!(!c.closed() && c.closed_with_lids_and_mirror());
        let c = closure(&plate, &[1], None);
        assert_eq!(c.leaks().count(), 3);
        assert!((c.open[1].length - 1.0).abs() < 1e-15 && c.open[1].bounds.low.x == 1.0);
    }

    #[test]
    fn a_ball_is_closed_and_half_a_box_with_its_mirror() {
        assert!(closure(&sphere(6, 1.0, Vec3::<f64>::zero()), &[], None).closed());
        let half = closure(&open_half_box(), &[1], None);
        assert!(half.closed_with_lids_and_mirror() && half.open.len() == 4);
        assert!(half.open.iter().all(|e| e.edge == EdgeName::Other));
        assert!(closure(&open_half_box(), &[], None).leaks().count() == 4);
        // Nothing is not closed.
        let none = sphere(6, 1.0, Vec3::<f64>::zero()).selected(|_| false).unwrap();
        assert!(!closure(&none, &[], None).closed_with_lids_and_mirror());
    }
}
