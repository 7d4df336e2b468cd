//! Quality of the panels of a patch and of a whole mesh: aspect ratio, skewness, warp and jumps of area, with the worst panel named.

use crate::half_edge::{edges, half_edges};
use crate::panel::length;
use crate::{Mesh, Panel};
use moldloft_num::{Dual4, Real, Vec3};

/// Lowest, highest and mean value of a measure over the panels of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Lowest.
    pub min: f64,
    /// Highest.
    pub max: f64,
    /// Mean.
    pub mean: f64,
}

/// The panel where a measure is worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstPanel {
    /// Its index in the mesh.
    pub face: usize,
    /// Mean of its corners.
    pub centre: Vec3,
}

/// Quality of the panels of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchQuality {
    /// Quads.
    pub quads: usize,
    /// Triangles.
    pub triangles: usize,
    /// Panel size, the square root of the area.
    pub size: Statistics,
    /// Aspect ratio, 1 or more. Quads: the longer over the shorter of the two lines that join the
    /// middles of opposite sides (Robinson 1987, "CRE method of element testing", Eng. Comput.
    /// 4:113). Triangles: the longest side over its height, scaled to 1 for equal sides.
    pub aspect: Statistics,
    /// Equiangular skewness, 0 (best) to 1: the largest of (a - e) / (180 - e) and (e - a) / e over
    /// the corner angles a, with e = 90 degrees for quads and 60 for triangles (Ansys Fluent User's
    /// Guide, "Mesh Quality").
    pub skew: Statistics,
    /// Warp: the distance of the corners from the plane midway between both diagonals and parallel
    /// to them, over the panel size. 0 for plane panels.
    pub warp: Statistics,
    /// Smallest angle between two sides of a panel, in radians.
    pub angle: Statistics,
    /// Ratio of the sizes of a panel and a neighbour, the larger over the smaller. Neighbours
    /// across the edges of patches are included, panels without area are not.
    pub jump: Statistics,
    /// The panels with the greatest aspect, skew, warp and jump; `None` for a patch of panels
    /// without area.
    pub worst: Option<[WorstPanel; 4]>,
    /// The panel with the smallest angle.
    pub sharpest: Option<WorstPanel>,
    /// Panels without area although their corners are different vertices; they are included in
    /// `size` only.
    pub without_area: usize,
}

/// Quality of one patch by its index; `None` when it has no faces. Takes time proportional to the
/// whole mesh: for all patches use [`qualities`].
///
/// # Panics
/// When there is no such patch.
pub fn quality(mesh: &Mesh, patch: usize) -> Option<PatchQuality> {
    of_patch(mesh, patch, &jumps(mesh))
}

/// Quality of each patch; `None` for one without faces.
pub fn qualities(mesh: &Mesh) -> Vec<Option<PatchQuality>> {
    let jumps = jumps(mesh);
    (0..mesh.patches().len()).map(|patch| of_patch(mesh, patch, &jumps)).collect()
}

/// The greatest ratio of areas between each face and its neighbours; 1 for a face alone.
fn jumps(mesh: &Mesh) -> Vec<f64> {
    let areas: Vec<f64> = (0..mesh.faces().len()).map(|f| mesh.panel(f).area()).collect();
    let mut jumps = vec![1.0f64; areas.len()];
    for edge in edges(&half_edges(mesh.topology())) {
        for pair in edge.windows(2) {
            let (a, b) = (pair[0].face(), pair[1].face());
            let (small, large) = (areas[a].min(areas[b]), areas[a].max(areas[b]));
            if small > 0.0 {
                jumps[a] = jumps[a].max(large / small);
                jumps[b] = jumps[b].max(large / small);
            }
        }
    }
    jumps
}

fn of_patch(mesh: &Mesh, patch: usize, jumps: &[f64]) -> Option<PatchQuality> {
    let faces = mesh.patches()[patch].faces.clone();
    let mut size = Tally::new();
    let mut shape = [Tally::new(); 4];
    // For the angle the smallest is the worst.
    let mut blunt = Tally::new();
    let (mut quads, mut triangles, mut without_area) = (0, 0, 0);
    for face in faces.clone() {
        let panel = mesh.panel(face);
        match panel {
            Panel::Quad(_) => quads += 1,
            Panel::Triangle(_) => triangles += 1,
        }
        let here = WorstPanel { face, centre: panel.centre() };
        let side = panel.area().sqrt();
        size.take(side, here);
        if side == 0.0 {
            without_area += 1;
            continue;
        }
        let values = [aspect(&panel), skew(&panel), warp(&panel), jumps[face]];
        for (tally, value) in shape.iter_mut().zip(values) {
            tally.take(value, here);
        }
        blunt.take(-angles(&panel).fold(f64::INFINITY, f64::min), here);
    }
    let angle = blunt.statistics();
    let worst: Vec<WorstPanel> = shape.iter().filter_map(|tally| tally.worst).collect();
    (!faces.is_empty()).then(|| PatchQuality {
        quads,
        triangles,
        size: size.statistics(),
        aspect: shape[0].statistics(),
        skew: shape[1].statistics(),
        warp: shape[2].statistics(),
        angle: Statistics { min: 0.0 - angle.max, max: 0.0 - angle.min, mean: 0.0 - angle.mean },
        jump: shape[3].statistics(),
        worst: worst.try_into().ok(),
        sharpest: blunt.worst,
        without_area,
    })
}

#[derive(Clone, Copy)]
struct Tally {
    min: f64,
    max: f64,
    sum: f64,
    count: usize,
    worst: Option<WorstPanel>,
}

impl Tally {
    fn new() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY, sum: 0.0, count: 0, worst: None }
    }

    fn take(&mut self, value: f64, here: WorstPanel) {
        self.min = self.min.min(value);
        if value > self.max {
            self.max = value;
            self.worst = Some(here);
        }
        self.sum += value;
        self.count += 1;
    }

    /// The spread; all zero when nothing was taken.
    fn statistics(&self) -> Statistics {
        if self.count == 0 {
            return Statistics { min: 0.0, max: 0.0, mean: 0.0 };
        }
        Statistics { min: self.min, max: self.max, mean: self.sum / self.count as f64 }
    }
}

fn aspect<T: Real>(panel: &Panel<T>) -> T {
    match *panel {
        Panel::Quad([a, b, c, d]) => {
            let along = length(b + c - a - d);
            let across = length(c + d - a - b);
            along.max(across) / along.min(across)
        }
        Panel::Triangle([a, b, c]) => {
            let longest_sq = (b - a).norm_sq().max((c - b).norm_sq()).max((a - c).norm_sq());
            longest_sq / (panel.area() * 2.0) * (3f64.sqrt() / 2.0)
        }
    }
}

/// The angles at the corners, between the two sides that meet there.
fn angles<T: Real>(panel: &Panel<T>) -> impl Iterator<Item = T> + '_ {
    let corners = panel.corners();
    let n = corners.len();
    (0..n).map(move |k| {
        let (to_next, to_last) =
            (corners[(k + 1) % n] - corners[k], corners[(k + n - 1) % n] - corners[k]);
        length(to_next.cross(to_last)).atan2(to_next.dot(to_last))
    })
}

fn skew<T: Real>(panel: &Panel<T>) -> T {
    let n = panel.corners().len();
    let best = std::f64::consts::PI * (1.0 - 2.0 / n as f64);
    angles(panel).fold(T::zero(), |worst, angle| {
        let off = angle - T::from(best);
        worst.max(off / (std::f64::consts::PI - best)).max(-off / best)
    })
}

fn warp<T: Real>(panel: &Panel<T>) -> T {
    let &Panel::Quad([a, b, c, d]) = panel else { return T::zero() };
    let normal = (c - a).cross(d - b);
    let size = length(normal);
    if size.re() == 0.0 {
        return T::zero();
    }
    // Half the distance between the diagonals.
    let height = (b - a).dot(normal).abs() * 0.5 / size;
    height / panel.area().sqrt()
}

fn sharpest_angle<T: Real>(panel: &Panel<T>) -> T {
    angles(panel).fold(T::from(std::f64::consts::PI), T::min)
}

/// A measure of a mesh's worst panel, and which one is worst.
struct WorstMeasure<T> {
    name: &'static str,
    of: fn(&Panel<T>) -> T,
    /// True where the smallest is the worst.
    least: bool,
}

fn worst_measures<T: Real>() -> [WorstMeasure<T>; 4] {
    [
        WorstMeasure { name: "aspect", of: aspect, least: false },
        WorstMeasure { name: "skew", of: skew, least: false },
        WorstMeasure { name: "warp", of: warp, least: false },
        WorstMeasure { name: "angle", of: sharpest_angle, least: true },
    ]
}

/// The face with the worst panel by a measure; panels without area do not count.
fn worst_face<T: Real>(mesh: &Mesh<T>, of: fn(&Panel<T>) -> T, least: bool) -> Option<usize> {
    let values = (0..mesh.faces().len()).filter_map(|face| {
        let panel = mesh.panel(face);
        let value = if least { -of(&panel).re() } else { of(&panel).re() };
        (panel.area().re() != 0.0).then_some((face, value))
    });
    // Of equal ones the first.
    let worse = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
    values.reduce(worse).map(|(face, _)| face)
}

/// The largest aspect ratio, skewness and warp of the panels of a mesh and the smallest angle, as in
/// [`PatchQuality`], by their names; empty for a mesh of panels without area.
///
/// Derivatives are those of the worst panel: of the first of several.
pub fn worst_quality<T: Real>(mesh: &Mesh<T>) -> Vec<(&'static str, T)> {
    let worst = |m: WorstMeasure<T>| {
        let face = worst_face(mesh, m.of, m.least)?;
        Some((m.name, (m.of)(&mesh.panel(face))))
    };
    worst_measures().into_iter().filter_map(worst).collect()
}

/// The derivatives of a number of [`worst_quality`] by each vertex; `None` for another name, or a
/// mesh of panels without area.
pub fn pulled_quality(mesh: &Mesh<f64>, name: &str) -> Option<Vec<Vec3>> {
    let named = |m: &WorstMeasure<Dual4>| m.name == name;
    let differentiated = worst_measures::<Dual4>().into_iter().find(named)?;
    let plain = worst_measures::<f64>().into_iter().find(|m| m.name == name)?;
    let face = worst_face(mesh, plain.of, plain.least)?;
    let corners = mesh.faces()[face];
    let mut out = vec![Vec3::zero(); mesh.positions().len()];
    for axis in 0..3 {
        let points: [Vec3<Dual4>; 4] = std::array::from_fn(|k| {
            let mut point = mesh.positions()[corners[k] as usize].to_array().map(Dual4::from);
            point[axis].eps[k] = 1.0;
            Vec3::from(point)
        });
        let panel = match mesh.panel(face) {
            Panel::Quad(_) => Panel::Quad(points),
            Panel::Triangle(_) => Panel::Triangle([points[0], points[1], points[2]]),
        };
        let slopes = (differentiated.of)(&panel).eps;
        for (corner, slope) in corners.into_iter().zip(slopes) {
            let mut point = out[corner as usize].to_array();
            point[axis] += slope;
            out[corner as usize] = Vec3::from(point);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixtures::{grid, sphere};

    fn quad(corners: [[f64; 3]; 4]) -> Panel<f64> {
        Panel::Quad(corners.map(Vec3::from))
    }

    #[test]
    fn known_shapes() {
        let rectangle = quad([[0.0; 3], [10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!((aspect(&rectangle), skew(&rectangle), warp(&rectangle)), (10.0, 0.0, 0.0));
        let h = 3f64.sqrt() / 2.0;
        let equal = Panel::Triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.5, h, 0.0]].map(Vec3::from));
        assert!((aspect(&equal) - 1.0).abs() < 1e-15 && skew(&equal) < 1e-15);
        // A rhombus of 60 and 120 degrees.
        let rhombus = quad([[0.0; 3], [1.0, 0.0, 0.0], [1.5, h, 0.0], [0.5, h, 0.0]]);
        assert!((skew(&rhombus) - 1.0 / 3.0).abs() < 1e-15);
        // A unit square with corners lifted by 0.1, -0.1, 0.1, -0.1.
        let lift = quad([[0.0, 0.0, 0.1], [1.0, 0.0, -0.1], [1.0, 1.0, 0.1], [0.0, 1.0, -0.1]]);
        assert!((warp(&lift) - 0.1 / lift.area().sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_patch_names_its_worst_panel() {
        let mesh = grid(5, 3, |u, v| Vec3::of(u * u, v, 0.0));
        let q = quality(&mesh, 0).unwrap();
        assert_eq!((q.quads, q.triangles, q.without_area), (8, 0, 0));
        assert!((q.aspect.max - 8.0).abs() < 1e-14);
        let worst = q.worst.unwrap();
        assert_eq!((worst[0].face, worst[0].centre), (0, Vec3::of(0.03125, 0.25, 0.0)));
        // Widths 1, 3, 5 and 7 sixteenths.
        assert!((q.jump.max - 3.0).abs() < 1e-14 && worst[3].face == 0);
        assert!((q.angle.min - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert_eq!(mesh.topology().place_of(5), Some([2, 1]));
        assert!((q.size.min - (0.0625f64 * 0.5).sqrt()).abs() < 1e-15);
        let ball = quality(&sphere(6, 1.0, Vec3::zero()), 0).unwrap();
        assert_eq!((ball.quads, ball.triangles), (48, 24));
        assert!(ball.angle.min > 0.1 && ball.sharpest.is_some());
    }

    #[test]
    fn panels_without_area_do_no_harm() {
        let flat = grid(3, 3, |u, _| Vec3::of(u, 0.0, 0.0));
        let q = quality(&flat, 0).unwrap();
        assert_eq!((q.without_area, q.size.max, q.aspect.max), (4, 0.0, 0.0));
        assert!(q.worst.is_none() && q.sharpest.is_none() && q.angle.min == 0.0);
    }
}
