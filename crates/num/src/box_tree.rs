//! A tree of boxes.

use crate::Box3;
use std::ops::Range;

/// Number of boxes in a leaf at most.
const LEAF_BOXES: usize = 8;

/// A tree over boxes, which are known by their numbers.
pub struct BoxTree {
    order: Vec<usize>,
    bounds: Vec<Box3>,
    nodes: Vec<TreeBox>,
}

struct TreeBox {
    bounds: Box3,
    range: Range<usize>,
    /// The two nodes that it consists of; a leaf has none.
    halves: Option<[usize; 2]>,
}

impl BoxTree {
    /// The tree over these boxes.
    pub fn new(bounds: Vec<Box3>) -> Self {
        let count = bounds.len();
        let mut tree = Self { order: (0..count).collect(), bounds, nodes: Vec::new() };
        tree.grow(0..count);
        tree
    }

    fn grow(&mut self, range: Range<usize>) -> usize {
        let inside = &mut self.order[range.clone()];
        let bounds = inside.iter().fold(Box3::EMPTY, |all, &k| all.union(self.bounds[k]));
        let number = self.nodes.len();
        let middle = range.start + range.len() / 2;
        let halved = range.len() > LEAF_BOXES;
        if halved {
            let extent = (bounds.high - bounds.low).to_array();
            let axis = (1..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best });
            let centre = |k: usize| self.bounds[k].centre().to_array()[axis];
            inside.sort_by(|&a, &b| centre(a).total_cmp(&centre(b)));
        }
        self.nodes.push(TreeBox { bounds, range: range.clone(), halves: None });
        if halved {
            let halves = [self.grow(range.start..middle), self.grow(middle..range.end)];
            self.nodes[number].halves = Some(halves);
        }
        number
    }

    /// Adds the numbers of the boxes that meet `bounds` to `found`; boxes that touch it meet it.
    pub fn meeting(&self, bounds: Box3, found: &mut Vec<usize>) {
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let node = &self.nodes[number];
            if !node.bounds.meets(bounds) {
                continue;
            }
            match node.halves {
                Some(halves) => open.extend(halves),
                None => {
                    let inside = self.order[node.range.clone()].iter().copied();
                    found.extend(inside.filter(|&k| self.bounds[k].meets(bounds)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    #[test]
    fn meets_as_a_loop_over_all_boxes() {
        // Points of a Weyl sequence: no two boxes alike.
        let part = |k: usize, a: f64| (k as f64 * a).fract();
        let at = |k: usize| {
            let low = Vec3::of(part(k, 0.618), part(k, 0.414), part(k, 0.732));
            Box3::around([low, low + Vec3::of(0.1, 0.1, 0.1) * part(k, 0.236)])
        };
        for count in [0, 1, 8, 9, 300] {
            let boxes: Vec<Box3> = (0..count).map(at).collect();
            let tree = BoxTree::new(boxes.clone());
            for query in (1000..1050).map(at) {
                let mut found = Vec::new();
                tree.meeting(query, &mut found);
                found.sort_unstable();
                let all: Vec<usize> = (0..count).filter(|&k| boxes[k].meets(query)).collect();
                assert_eq!(found, all);
            }
        }
    }
}
