//! Imported faces, and paths along the edges of the square of parameters.

use super::points::NurbsPoints;
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;

/// A side of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedSide {
    /// Number of its edge; sides of the same number are one edge.
    pub edge: usize,
    /// True when the loop runs against the path.
    pub backwards: bool,
    /// The curve in the parameters (u, v, 0) of the surface.
    pub path: Nurbs<1>,
    /// Distance of two surfaces along the edge up to which they are joined.
    pub tolerance: f64,
}

/// A face.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedFace {
    /// Its surface.
    pub surface: Nurbs<2>,
    /// Its loops, the outer one first.
    pub loops: Vec<Vec<ImportedSide>>,
    /// True when its loops are the edges of the surface's parameters.
    pub natural: bool,
}

/// Distance from an edge of the square of parameters, or from its ends, below which a path is on it.
const ON_BORDER: f64 = 1e-9;

/// The edge of the square of parameters along which a path runs: 0 for u or 1 for v, and its value.
pub fn border(path: &Nurbs<1>) -> Option<(usize, f64)> {
    let coordinate = |p: &Vec3, axis: usize| if axis == 0 { p.x } else { p.y };
    let all = [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0)];
    all.into_iter().find(|&(axis, end)| {
        path.points.iter().all(|p| (coordinate(p, axis) - end).abs() < ON_BORDER)
    })
}

/// True when a path along an edge of the square of parameters covers all of it.
pub fn is_whole(path: &Nurbs<1>) -> bool {
    let [Some(a), Some(b)] = [path.points.first(), path.points.last()] else { return false };
    ((a.x - b.x).abs().max((a.y - b.y).abs()) - 1.0).abs() < ON_BORDER
}

/// Number of points between knots at which a side is compared with an edge of the parameters.
const BORDER_TRIALS: usize = 33;

/// A path as an edge of the square of parameters, if it is the same curve in space within `near`.
///
/// Towards a pole one parameter has ever less effect, and programs write it with any error there.
pub fn on_border(surface: &NurbsPoints<2>, path: &Nurbs<1>, near: f64) -> Option<Nurbs<1>> {
    if border(path).is_some() {
        return Some(path.clone());
    }
    let along = NurbsPoints::new(path);
    let knots = &path.knots[0];
    let trials: Vec<([f64; 2], Vec3)> = knots
        .windows(2)
        .filter(|w| w[1] > w[0])
        .flat_map(|w| {
            let step = (w[1] - w[0]) / (BORDER_TRIALS - 1) as f64;
            (0..BORDER_TRIALS).map(move |i| w[0] + step * i as f64)
        })
        .map(|t| {
            let at = within(along.at([t]));
            (at, surface.at(at))
        })
        .collect();
    let moved = |at: [f64; 2], axis: usize, end: f64| {
        if axis == 0 { [end, at[1]] } else { [at[0], end] }
    };
    for (axis, end) in [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0)] {
        let is_there =
            |(at, p): &([f64; 2], Vec3)| surface.at(moved(*at, axis, end)).distance(*p) <= near;
        if !trials.iter().all(is_there) {
            continue;
        }
        let mut found = path.clone();
        for p in &mut found.points {
            let [u, v] = moved([p.x, p.y], axis, end);
            *p = Vec3::of(u, v, 0.0);
        }
        // Ends at a corner but for the same tolerance are there.
        for k in [found.points.len() - 1, 0] {
            let own = [found.points[k].x, found.points[k].y];
            let corner = moved(own.map(f64::round), axis, end);
            let apart = surface.at(own.map(|x| x.clamp(0.0, 1.0))).distance(surface.at(corner));
            if apart <= near {
                found.points[k] = Vec3::of(corner[0], corner[1], 0.0);
            }
        }
        return Some(found);
    }
    None
}

/// A place inside the square of parameters.
pub(super) fn within(p: Vec3) -> [f64; 2] {
    [p.x.clamp(0.0, 1.0), p.y.clamp(0.0, 1.0)]
}
