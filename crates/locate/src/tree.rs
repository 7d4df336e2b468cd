//! Trees of boxes over the pieces of curves and surfaces, for searches with bounds.

use crate::pieces::{BezierPatch, CurvePiece, curve_pieces, meet, patches, size_of};
use moldloft_num::{Box3, Curve, Surface, Vec3};

/// A node of a tree of boxes.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// The box around all items below.
    pub bounds: Box3,
    /// First item, for a leaf; index of the second child otherwise (the first follows the node).
    pub first: u32,
    /// Number of items; 0 for an inner node.
    pub count: u32,
}

/// A binary tree of boxes over items given by index.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    /// The nodes; the root is the first.
    pub nodes: Vec<Node>,
    /// The items, in the order of the leaves.
    pub order: Vec<u32>,
}

impl Boxes {
    /// The tree over these boxes with at most `leaf` items per leaf. Nodes are split at the median
    /// of the centres along the longest side, ties by index, so the tree is deterministic.
    pub fn new(bounds: &[Box3], leaf: usize) -> Self {
        let mut tree = Boxes { nodes: Vec::new(), order: (0..bounds.len() as u32).collect() };
        if !bounds.is_empty() {
            tree.grow(bounds, 0, bounds.len(), leaf);
        }
        tree
    }

    fn grow(&mut self, bounds: &[Box3], begin: usize, end: usize, leaf: usize) {
        let items = &mut self.order[begin..end];
        let around = items.iter().fold(Box3::EMPTY, |b, &k| b.union(bounds[k as usize]));
        let at = self.nodes.len();
        let count = end - begin;
        self.nodes.push(Node { bounds: around, first: begin as u32, count: count as u32 });
        if count <= leaf {
            return;
        }
        let centres = items.iter().map(|&k| bounds[k as usize].centre());
        let spread = Box3::around(centres);
        let side = spread.high - spread.low;
        let axis = if side.x >= side.y && side.x >= side.z {
            0
        } else if side.y >= side.z {
            1
        } else {
            2
        };
        let middle = count / 2;
        items.select_nth_unstable_by(middle, |&a, &b| {
            let centre = |k: u32| bounds[k as usize].centre()[axis];
            centre(a).total_cmp(&centre(b)).then(a.cmp(&b))
        });
        self.nodes[at].count = 0;
        self.grow(bounds, begin, begin + middle, leaf);
        self.nodes[at].first = self.nodes.len() as u32;
        self.grow(bounds, begin + middle, end, leaf);
    }

    /// Calls `f` for each item such that `wanted` is true for the boxes of all nodes above it.
    pub fn visit(&self, wanted: impl Fn(&Box3) -> bool, mut f: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = vec![0u32];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !wanted(&node.bounds) {
                continue;
            }
            if node.count > 0 {
                let (a, b) = (node.first as usize, (node.first + node.count) as usize);
                self.order[a..b].iter().for_each(|&k| f(k));
            } else {
                stack.push(node.first);
                stack.push(at + 1);
            }
        }
    }
}

/// A curve divided into bounded pieces, for searches.
#[derive(Clone, Debug)]
pub struct CurveTree {
    /// The pieces, in the order of t.
    pub pieces: Vec<CurvePiece>,
    /// The box around all.
    pub bounds: Box3,
    /// The length to which accuracies are relative.
    pub size: f64,
}

impl CurveTree {
    /// Cuts the curve up.
    pub fn new(curve: &dyn Curve<f64>) -> Self {
        let pieces = curve_pieces(curve);
        let bounds = pieces.iter().fold(Box3::EMPTY, |b, p| b.union(p.bounds()));
        Self { pieces, bounds, size: size_of(&bounds) }
    }
}

/// A surface divided into bounded pieces, for searches.
#[derive(Clone, Debug)]
pub struct SurfaceTree {
    /// The pieces.
    pub patches: Vec<BezierPatch>,
    /// The tree over their boxes.
    pub boxes: Boxes,
    /// The box around all.
    pub bounds: Box3,
    /// The length to which accuracies are relative.
    pub size: f64,
    /// True when every piece equals the surface up to rounding.
    pub exact: bool,
}

impl SurfaceTree {
    /// Cuts the surface up.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        let patches = patches(surface);
        let all: Vec<Box3> = patches.iter().map(BezierPatch::bounds).collect();
        let boxes = Boxes::new(&all, 2);
        let bounds = all.iter().fold(Box3::EMPTY, |a, b| a.union(*b));
        let size = size_of(&bounds);
        let exact = patches.iter().all(|p| p.slack <= 1e-12 * size);
        Self { patches, boxes, bounds, size, exact }
    }

    /// The patches whose boxes intersect `b`, in order.
    pub fn meeting(&self, b: &Box3) -> Vec<u32> {
        let mut found = Vec::new();
        self.boxes.visit(
            |node| meet(node, b),
            |k| {
                if meet(&self.patches[k as usize].bounds(), b) {
                    found.push(k);
                }
            },
        );
        found.sort_unstable();
        found
    }

    /// The square of a distance from `p` within which the surface certainly has a point.
    pub fn reach_sq(&self, p: Vec3) -> f64 {
        let corner = |patch: &BezierPatch| (patch.net[0].distance(p) + patch.slack).powi(2);
        self.patches.iter().map(corner).fold(f64::INFINITY, f64::min)
    }
}
