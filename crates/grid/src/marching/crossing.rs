//! Fronts that meet: layers of a march that cross each other or the wall, far from their neighbours.
//!
//! Cells between two layers can all be right while the grid overlaps itself, as in a slot that is
//! narrower than twice its height. A grid without folded cells covers its region once if its
//! boundary — the wall, the last layer and the open sides — does not cross itself.

use moldloft_num::{Box3, BoxTree, Real, Vec3};

/// Part of the boundary: an edge (off curves) or a triangle (off surfaces).
pub(super) struct BoundaryPart {
    /// Its corners; an edge repeats the last one.
    pub corners: [Vec3; 3],
    /// The wall's nodes below it: parts with a common one are neighbours, checked cell by cell.
    pub foot: [usize; 4],
}

impl BoundaryPart {
    fn bounds(&self) -> Box3 {
        Box3::around(self.corners)
    }

    fn is_neighbour(&self, other: &Self) -> bool {
        self.foot.iter().any(|node| other.foot.contains(node))
    }
}

/// Distance of layers, relative to their last cell, below which they touch and do not cross.
const TOUCHING: f64 = 1e-6;

/// The last layer, with its points moved towards the layer below by a share of at most twice [`TOUCHING`]: fronts
/// that touch do not cross then, and no two points of symmetric ones coincide.
pub(super) fn lowered<T: Real>(layers: &[Vec<Vec3<T>>]) -> Vec<Vec3> {
    /// The fractional part of the golden ratio: its multiples are spread evenly.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (below, last) = (&layers[layers.len() - 2], &layers[layers.len() - 1]);
    let each = below.iter().zip(last).enumerate();
    each.map(|(k, (a, b))| {
        let share = TOUCHING * (1.0 + (k as f64 * GOLDEN).fract());
        b.re().lerp(a.re(), share)
    })
    .collect()
}

/// The first of the `front` parts, which come first, that crosses another part, and that part.
pub(super) fn first_crossing(
    parts: &[BoundaryPart],
    front: usize,
    crosses: impl Fn(&BoundaryPart, &BoundaryPart) -> bool,
) -> Option<[usize; 2]> {
    let tree = BoxTree::new(parts.iter().map(BoundaryPart::bounds).collect());
    let mut near = Vec::new();
    for (k, part) in parts[..front].iter().enumerate() {
        near.clear();
        tree.meeting(part.bounds(), &mut near);
        near.sort_unstable();
        let other = near.iter().copied().find(|&other| {
            // Two parts of the front are compared once.
            (other >= front || other > k)
                && !part.is_neighbour(&parts[other])
                && crosses(part, &parts[other])
        });
        if let Some(other) = other {
            return Some([k, other]);
        }
    }
    None
}

/// True if two edges cross in their inside, as seen along `up`, and are there nearer to each other than half the longer.
pub(super) fn edges_cross(a: &BoundaryPart, b: &BoundaryPart, up: Vec3) -> bool {
    let ([p, q, _], [r, s, _]) = (a.corners, b.corners);
    let (along, across) = (q - p, s - r);
    let side = |from: Vec3, line: Vec3, to: Vec3| line.cross(to - from).dot(up);
    let (r_side, s_side) = (side(p, along, r), side(p, along, s));
    let (p_side, q_side) = (side(r, across, p), side(r, across, q));
    if !(r_side * s_side < 0.0 && p_side * q_side < 0.0) {
        return false;
    }
    let on_a = p + along * (p_side / (p_side - q_side));
    let on_b = r + across * (r_side / (r_side - s_side));
    (on_a - on_b).dot(up).abs() <= 0.5 * along.norm().max(across.norm())
}

/// True if an edge of one of two triangles pierces the inside of the other.
pub(super) fn triangles_cross(a: &BoundaryPart, b: &BoundaryPart) -> bool {
    let (p, q) = (a.corners, b.corners);
    (0..3).any(|k| pierces(p[k], p[(k + 1) % 3], q) || pierces(q[k], q[(k + 1) % 3], p))
}

fn pierces(from: Vec3, to: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let (below, above) = (normal.dot(from - a), normal.dot(to - a));
    if !(below * above < 0.0) {
        return false;
    }
    let line = to - from;
    let side = |p: Vec3, q: Vec3| line.dot((p - from).cross(q - from));
    let (x, y, z) = (side(a, b), side(b, c), side(c, a));
    (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0)
}
