//! Hanging interfaces: two faces that are one, whose cells divide each other.

use crate::functions::named_blocks::{NamedBlock, face_points};
use moldloft_io::cgns::FacePart;
use moldloft_num::{Box3, Vec3, nearest_on_triangle};

/// Two parts of faces with the same corners. Along each axis the cells of one are whole multiples of those of the other, and
/// the points that both should have coincide.
#[derive(Clone, Debug)]
pub(crate) struct HangingJoint {
    /// The free parts of the two faces.
    pub parts: [FacePart; 2],
    /// What of them coincides: of the first, it may be less than the free part.
    pub sides: [FacePart; 2],
    /// Cells along the two axes of the second: of the first, and of the second.
    pub cells: [[usize; 2]; 2],
    /// The greatest distance of a point of one from the cells of the other: 0 on plane faces.
    pub gap: f64,
}

/// The points of a part, and the number along its two axes.
struct PartPoints {
    points: Vec<Vec3>,
    axes: [usize; 2],
    count: [usize; 2],
    bounds: Box3,
}

impl PartPoints {
    fn of(blocks: &[NamedBlock], part: &FacePart) -> Self {
        let (points, axes, count) = face_points(blocks, part);
        let bounds = Box3::around(points.iter().copied());
        Self { points, axes, count, bounds }
    }

    fn at(&self, [i, j]: [usize; 2]) -> Vec3 {
        self.points[i * self.count[1] + j]
    }

    /// The indices of all points at a place.
    fn all_at(&self, p: Vec3, tolerance: f64) -> Vec<[usize; 2]> {
        let near = |k: &usize| self.points[*k].distance(p) <= tolerance;
        (0..self.points.len())
            .filter(near)
            .map(|k| [k / self.count[1], k % self.count[1]])
            .collect()
    }

    fn meets(&self, other: &Self, tolerance: f64) -> bool {
        let (low, high) = (self.bounds.low.to_array(), self.bounds.high.to_array());
        let (from, to) = (other.bounds.low.to_array(), other.bounds.high.to_array());
        (0..3).all(|k| low[k] <= to[k] + tolerance && from[k] <= high[k] + tolerance)
    }
}

/// The hanging interfaces among parts of faces without a neighbour.
pub(super) fn hanging(
    blocks: &[NamedBlock],
    parts: &[FacePart],
    tolerance: f64,
) -> Vec<HangingJoint> {
    let points: Vec<PartPoints> = parts.iter().map(|part| PartPoints::of(blocks, part)).collect();
    let mut found: Vec<HangingJoint> = Vec::new();
    for (a, part) in parts.iter().enumerate() {
        for (b, other) in parts.iter().enumerate() {
            let known =
                |joint: &HangingJoint| joint.parts.contains(part) && joint.parts.contains(other);
            if a == b || !points[a].meets(&points[b], tolerance) || found.iter().any(known) {
                continue;
            }
            found.extend(between((part, &points[a]), (other, &points[b]), tolerance));
        }
    }
    found
}

/// Where the corners of the second part are points of the first.
fn between(
    (part, own): (&FacePart, &PartPoints),
    (other, theirs): (&FacePart, &PartPoints),
    tolerance: f64,
) -> Option<HangingJoint> {
    let [m, n] = theirs.count;
    let corner = |at: [usize; 2]| own.all_at(theirs.at(at), tolerance);
    let starts = corner([0, 0]);
    if starts.is_empty() {
        return None;
    }
    let (firsts, seconds) = (corner([m - 1, 0]), corner([0, n - 1]));
    for &start in &starts {
        for &first in &firsts {
            for &second in &seconds {
                if let Some(grid) = Correspondence::of([start, first, second], [m - 1, n - 1])
                    && let Some(gap) = grid.gap(own, theirs, tolerance)
                {
                    let mut side = *part;
                    let (start, end) = (grid.own([0, 0]), grid.own(grid.finest()));
                    for (k, axis) in own.axes.into_iter().enumerate() {
                        let low = part.2[axis].min(part.3[axis]);
                        (side.2[axis], side.3[axis]) = (low + start[k], low + end[k]);
                    }
                    let cells = [grid.cells, [m - 1, n - 1]];
                    let parts = [*part, *other];
                    return Some(HangingJoint { parts, sides: [side, *other], cells, gap });
                }
            }
        }
    }
    None
}

/// The indices of one part at those of another.
struct Correspondence {
    start: [usize; 2],
    /// The axis of the first part along each one of the second, and whether it runs backwards.
    along: [(usize, bool); 2],
    /// Cells of the first part along the axes of the second.
    cells: [usize; 2],
    /// Cells of the second part along its axes.
    theirs: [usize; 2],
}

impl Correspondence {
    fn of([start, first, second]: [[usize; 2]; 3], theirs: [usize; 2]) -> Option<Self> {
        let step = |to: [usize; 2]| match [to[0] != start[0], to[1] != start[1]] {
            [true, false] => Some((0, to[0] < start[0], to[0].abs_diff(start[0]))),
            [false, true] => Some((1, to[1] < start[1], to[1].abs_diff(start[1]))),
            _ => None,
        };
        let ((a, back_a, count_a), (b, back_b, count_b)) = (step(first)?, step(second)?);
        let cells = [count_a, count_b];
        let divides =
            |k: usize| cells[k].is_multiple_of(theirs[k]) || theirs[k].is_multiple_of(cells[k]);
        let fits = a != b && divides(0) && divides(1) && cells != theirs;
        fits.then_some(Self { start, along: [(a, back_a), (b, back_b)], cells, theirs })
    }

    /// Cells of both together.
    fn finest(&self) -> [usize; 2] {
        std::array::from_fn(|k| self.cells[k].max(self.theirs[k]))
    }

    /// The first part's indices at a place in steps of the finest cells, at which it has a node.
    fn own(&self, place: [usize; 2]) -> [usize; 2] {
        let (mut own, finest) = (self.start, self.finest());
        for k in 0..2 {
            let steps = place[k] * self.cells[k] / finest[k];
            let (axis, back) = self.along[k];
            own[axis] = if back { own[axis] - steps } else { own[axis] + steps };
        }
        own
    }

    /// The greatest distance of the points of one part from the cells of the other; `None` if points that both should have
    /// do not coincide.
    fn gap(&self, own: &PartPoints, theirs: &PartPoints, tolerance: f64) -> Option<f64> {
        let finest = self.finest();
        let own_at = |place: [usize; 2]| own.at(self.own(place));
        let their_at = |place: [usize; 2]| {
            theirs.at(std::array::from_fn(|k| place[k] * self.theirs[k] / finest[k]))
        };
        let mut gap = 0.0f64;
        for i in 0..=finest[0] {
            for j in 0..=finest[1] {
                let place = [i, j];
                let has = |cells: [usize; 2]| {
                    (0..2).all(|k| (place[k] * cells[k]).is_multiple_of(finest[k]))
                };
                match (has(self.cells), has(self.theirs)) {
                    (true, true) if own_at(place).distance(their_at(place)) > tolerance => {
                        return None;
                    }
                    (true, false) => {
                        gap = gap.max(off(own_at(place), place, [self.theirs, finest], &their_at));
                    }
                    (false, true) => {
                        gap = gap.max(off(their_at(place), place, [self.cells, finest], &own_at));
                    }
                    _ => {}
                }
            }
        }
        Some(gap)
    }
}

/// The distance of a point from the cell of the other part at its place.
fn off(
    p: Vec3,
    place: [usize; 2],
    [cells, finest]: [[usize; 2]; 2],
    corner: &dyn Fn([usize; 2]) -> Vec3,
) -> f64 {
    let span = |k: usize| {
        let width = finest[k] / cells[k];
        let low = (place[k] / width).min(cells[k] - 1) * width;
        [low, low + width]
    };
    let ([i0, i1], [j0, j1]) = (span(0), span(1));
    let [a, b, c, d] = [[i0, j0], [i1, j0], [i1, j1], [i0, j1]].map(corner);
    let triangles = [[a, b, c], [a, c, d], [a, b, d], [b, c, d]];
    triangles
        .into_iter()
        .map(|t| p.distance(nearest_on_triangle(p, t)))
        .fold(f64::INFINITY, f64::min)
}
