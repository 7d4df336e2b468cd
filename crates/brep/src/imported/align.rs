//! One parametrisation of the two sides along a common edge.
//!
//! A program may write the circle between two faces as splines of two parametrisations. A join compares its sides at
//! equal parameters: the path of one side in its surface's parameters is fitted again with the parametrisation of the
//! other. It stays on the old path. Paths of many control points are fitted with fewer.

use super::faces::{ImportedFace, ImportedSide, border, is_whole, within};
use super::fitting::{FollowedPath, followed};
use super::points::NurbsPoints;
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;
use std::collections::BTreeMap;

/// Distance at equal parameters, relative to the length, below which two sides have the same
/// parametrisation.
const NEAR: f64 = 1e-7;

/// Distance of two curves, relative to their length, above which they are distinct, unless the
/// tolerance of the edge is larger.
const PARTED: f64 = 1e-4;

/// Deviation of a fitted path from the old one, relative to the distance of the two curves.
const FIT_SHARE: f64 = 0.1;

/// Points of a table of a path.
const TABLE: usize = 1025;

/// Steps towards the nearest point of a path: Newton's, within known bounds.
const MAX_NEAREST_STEPS: usize = 14;

/// Change of a parameter at which it is found.
const FOUND: f64 = 1e-14;

/// A nearest point is sought where the lengths from the start, relative to the whole, differ by at most this.
const LENGTH_WINDOW: f64 = 0.08;

/// Paths of this many control points and more are fitted with fewer.
const HEAVY: usize = 40;

/// Deviation of a path with fewer control points, relative to the length.
const THINNED: f64 = 1e-8;

/// Points of a side at which sides are compared.
const TRIALS: usize = 65;

/// A face, its loop and its side.
type SideIndex = (usize, usize, usize);

/// Gives the two sides along each shared edge the same parametrisation, if they are one curve. Returns the sides
/// whose paths are new.
pub fn align(faces: &mut [ImportedFace]) -> Vec<SideIndex> {
    let surfaces: Vec<NurbsPoints<2>> =
        faces.iter().map(|f| NurbsPoints::new(&f.surface)).collect();
    let mut changed = Vec::new();
    let mut shared: BTreeMap<usize, Vec<SideIndex>> = BTreeMap::new();
    for (f, face) in faces.iter_mut().enumerate() {
        for (c, cycle) in face.loops.iter_mut().enumerate() {
            for (k, side) in cycle.iter_mut().enumerate() {
                shared.entry(side.edge).or_default().push((f, c, k));
                if let Some(path) = thinned(&surfaces[f], &side.path) {
                    side.path = path;
                    changed.push((f, c, k));
                }
            }
        }
    }
    for sides in shared.values() {
        if let [one, other] = sides[..]
            && one.0 != other.0
        {
            changed.extend(pair(faces, &surfaces, one, other));
        }
    }
    changed.sort_unstable();
    changed.dedup();
    changed
}

/// A path of many control points with fewer.
fn thinned(surface: &NurbsPoints<2>, path: &Nurbs<1>) -> Option<Nurbs<1>> {
    if path.points.len() < HEAVY {
        return None;
    }
    let own = NurbsPoints::new(path);
    let table: Vec<Vec3> = steps(TRIALS).map(|t| surface.at(within(own.at([t])))).collect();
    let length = length(&table);
    let place = |t: f64| {
        let p = own.at([t]);
        Some([p.x, p.y])
    };
    let (kinks, cuts) = breaks(path);
    let goal = FollowedPath { surface, place: &place, kinks, cuts };
    let (made, apart) = followed(&goal, THINNED * length)?;
    let is_better = apart <= THINNED * length && 2 * made.points.len() <= path.points.len();
    is_better.then_some(made)
}

/// Equal steps from 0 to 1.
fn steps(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| i as f64 / (count - 1) as f64)
}

fn length(points: &[Vec3]) -> f64 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// The inner knots at which a path may have a kink, and all inner knots.
fn breaks(path: &Nurbs<1>) -> (Vec<f64>, Vec<f64>) {
    let (mut kinks, mut cuts) = (Vec::new(), Vec::new());
    for run in path.knots[0].chunk_by(|a, b| a == b) {
        if run[0] > 0.0 && run[0] < 1.0 {
            cuts.push(run[0]);
            if run.len() >= path.degrees[0] {
                kinks.push(run[0]);
            }
        }
    }
    (kinks, cuts)
}

/// A side in space, with the parameter that it has in the program.
enum SideCurve<'f> {
    Path { surface: &'f NurbsPoints<2>, path: Nurbs<1>, points: NurbsPoints<1> },
    Border { surface: &'f NurbsPoints<2>, axis: usize, held: f64 },
}

impl<'f> SideCurve<'f> {
    /// `None` for a part of an edge of a whole surface.
    fn new(natural: bool, side: &ImportedSide, surface: &'f NurbsPoints<2>) -> Option<Self> {
        if natural {
            let (axis, held) = border(&side.path).filter(|_| is_whole(&side.path))?;
            return Some(Self::Border { surface, axis, held });
        }
        let path = if side.backwards { side.path.reversed() } else { side.path.clone() };
        let points = NurbsPoints::new(&path);
        Some(Self::Path { surface, path, points })
    }

    fn at(&self, t: f64) -> Vec3 {
        match self {
            Self::Path { surface, points, .. } => surface.at(within(points.at([t]))),
            Self::Border { surface, axis: 0, held } => surface.at([*held, t]),
            Self::Border { surface, held, .. } => surface.at([t, *held]),
        }
    }

    fn all(&self) -> Vec<Vec3> {
        steps(TRIALS).map(|t| self.at(t)).collect()
    }
}

fn gap(one: &[Vec3], other: impl Iterator<Item = Vec3>) -> f64 {
    one.iter().zip(other).fold(0.0, |most, (p, q)| most.max(p.distance(q)))
}

fn pair(
    faces: &mut [ImportedFace],
    surfaces: &[NurbsPoints<2>],
    mut one: SideIndex,
    mut other: SideIndex,
) -> Option<SideIndex> {
    let curve = |faces: &[ImportedFace], (f, c, k): SideIndex| {
        SideCurve::new(faces[f].natural, &faces[f].loops[c][k], &surfaces[f])
    };
    let (mut first, mut second) = (curve(faces, one)?, curve(faces, other)?);
    let (places, theirs) = (first.all(), second.all());
    let length = length(&places);
    let against = |p: &[Vec3], q: &[Vec3]| {
        let (alike, opposite) = (gap(p, q.iter().copied()), gap(p, q.iter().rev().copied()));
        (opposite < alike, alike.min(opposite))
    };
    let (mut turned, apart) = against(&places, &theirs);
    if length == 0.0 || apart <= NEAR * length {
        return None;
    }
    // A whole surface keeps its edges where it can.
    if faces[other.0].natural && !faces[one.0].natural {
        (one, other) = (other, one);
        (first, second) = (second, first);
    }
    if faces[other.0].natural {
        let mut numbers: Vec<usize> =
            faces[other.0].loops.iter().flatten().map(|side| side.edge).collect();
        let count = numbers.len();
        numbers.sort_unstable();
        numbers.dedup();
        if numbers.len() < count || count != 4 {
            return None;
        }
        faces[other.0].natural = false;
        second = curve(faces, other)?;
        turned = against(&first.all(), &second.all()).0;
    }
    let SideCurve::Path { path: own, points, surface } = &second else { return None };
    let (f, c, k) = other;
    let goal = |t: f64| first.at(if turned { 1.0 - t } else { t });
    let mut known = match &first {
        SideCurve::Path { path, .. } => breaks(path).1,
        SideCurve::Border { axis, .. } => {
            let mut knots = faces[one.0].surface.knots[1 - axis].clone();
            knots.dedup();
            knots.retain(|t| *t > 0.0 && *t < 1.0);
            knots
        }
    };
    if turned {
        known = known.into_iter().rev().map(|t| 1.0 - t).collect();
    }
    let tolerance = faces[f].loops[c][k].tolerance;
    let made = rerun(&OwnPath { own, points, surface }, &goal, known, length, tolerance)?;
    let side = &mut faces[f].loops[c][k];
    side.path = if side.backwards { made.reversed() } else { made };
    Some(other)
}

struct OwnPath<'a> {
    own: &'a Nurbs<1>,
    points: &'a NurbsPoints<1>,
    surface: &'a NurbsPoints<2>,
}

impl OwnPath<'_> {
    /// The point in space, and its derivative.
    fn jet(&self, s: f64) -> [Vec3; 2] {
        let [w, dw] = self.points.jet(s);
        let [p, u, v] = self.surface.jet(within(w));
        [p, u * dw.x + v * dw.y]
    }
}

/// PathTable points of a curve, by a table of it.
struct PathTable {
    places: Vec<Vec3>,
    /// Lengths from the start, relative to the whole.
    lengths: Vec<f64>,
}

impl PathTable {
    fn new(at: impl Fn(f64) -> Vec3) -> Self {
        let places: Vec<Vec3> = steps(TABLE).map(at).collect();
        let mut lengths = vec![0.0];
        for w in places.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + w[0].distance(w[1]));
        }
        let whole = lengths[TABLE - 1];
        if whole > 0.0 {
            lengths.iter_mut().for_each(|l| *l /= whole);
        }
        Self { places, lengths }
    }

    /// The length from the start to a parameter, relative to the whole.
    fn share(&self, t: f64) -> f64 {
        let x = t * (TABLE - 1) as f64;
        let k = (x as usize).min(TABLE - 2);
        let part = x - k as f64;
        self.lengths[k] + (self.lengths[k + 1] - self.lengths[k]) * part
    }

    /// The parameter of the nearest place of the table at about a length from the start.
    fn start(&self, goal: Vec3, share: f64) -> usize {
        let low = self.lengths.partition_point(|l| *l < share - LENGTH_WINDOW);
        let high = self.lengths.partition_point(|l| *l <= share + LENGTH_WINDOW);
        let near = (low..high.max(low + 1)).filter(|&k| k < TABLE);
        let distance = |k: usize| self.places[k].distance(goal);
        near.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(TABLE - 1)
    }

    /// The parameter of the nearest point, from a place of the table.
    fn refined(&self, goal: Vec3, start: usize, jet: impl Fn(f64) -> [Vec3; 2]) -> f64 {
        let at = |k: usize| k as f64 / (TABLE - 1) as f64;
        let (mut low, mut high) = (at(start.saturating_sub(1)), at((start + 1).min(TABLE - 1)));
        let mut found = at(start);
        for _ in 0..MAX_NEAREST_STEPS {
            let [p, d] = jet(found);
            let ahead = (goal - p).dot(d);
            if ahead > 0.0 {
                low = found
            } else {
                high = found
            }
            let speed = d.dot(d);
            let moved = found + ahead / speed;
            let next = if moved >= low && moved <= high { moved } else { 0.5 * (low + high) };
            let step = (next - found).abs();
            found = next;
            if step <= FOUND {
                break;
            }
        }
        found
    }
}

/// The path with the parameters of another curve; `None` if that is a distinct curve.
fn rerun(
    path: &OwnPath,
    wanted: &dyn Fn(f64) -> Vec3,
    known: Vec<f64>,
    length: f64,
    tolerance: f64,
) -> Option<Nurbs<1>> {
    let own_table = PathTable::new(|s| path.jet(s)[0]);
    let table = PathTable::new(wanted);
    // The ends of the two curves are as far apart as the curves: they are moved to one another.
    let last = TABLE - 1;
    let [begin, end] = [0, last].map(|k| own_table.places[k] - table.places[k]);
    let goal = |t: f64| wanted(t) + begin * (1.0 - t) + end * t;
    let parameter = |t: f64| -> f64 {
        if t <= 0.0 || t >= 1.0 {
            return t.clamp(0.0, 1.0);
        }
        let there = goal(t);
        let start = own_table.start(there, table.share(t));
        own_table.refined(there, start, |s| path.jet(s))
    };
    let parted = (PARTED * length).max(tolerance);
    let mut floor = 0.0f64;
    let mut before = 0.0;
    for t in steps(2 * TRIALS - 1) {
        let s = parameter(t);
        if t > 0.0 && s <= before {
            return None;
        }
        before = s;
        floor = floor.max(path.jet(s)[0].distance(wanted(t)));
    }
    if floor > parted {
        return None;
    }
    // Both may change their pace at their knots.
    let (kinks, inner) = breaks(path.own);
    let on_other = |knots: Vec<f64>| -> Vec<f64> {
        let found = knots.into_iter().map(|s| parameter_of(s, &parameter));
        found.filter(|t| *t > 0.0 && *t < 1.0).collect()
    };
    let (kinks, mut cuts) = (on_other(kinks), on_other(inner));
    cuts.extend(known);
    cuts.sort_by(f64::total_cmp);
    let place = |t: f64| {
        let p = path.points.at([parameter(t)]);
        Some([p.x, p.y])
    };
    let goal = FollowedPath { surface: path.surface, place: &place, kinks, cuts };
    let near = (NEAR * length).max(FIT_SHARE * floor);
    let (made, apart) = followed(&goal, near)?;
    (apart <= near || apart <= parted).then_some(made)
}

/// Halvings that find where a parameter of the path is on the other curve.
const MAX_HALVINGS: usize = 44;

/// The parameter at which an ascending function has a value.
fn parameter_of(value: f64, parameter: &dyn Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..MAX_HALVINGS {
        let middle = 0.5 * (low + high);
        if parameter(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::imported::{EdgeContact, contacts};
    use moldloft_num::Pace;

    fn nurbs<const D: usize>(degrees: [usize; D], points: &[[f64; 3]]) -> Nurbs<D> {
        let ends = |p: usize| [vec![0.0; p + 1], vec![1.0; p + 1]].concat();
        Nurbs {
            degrees,
            knots: degrees.map(ends),
            points: points.iter().map(|p| Vec3::of(p[0], p[1], p[2])).collect(),
            weights: None,
            error: 0.0,
            exact: true,
            paces: [Pace::Even; D],
        }
    }

    /// A sheet from y = 0 to `y` with one side, of a pace that is not even, along y = 0 at height `z`.
    fn sheet(y: f64, z: f64, middle: f64) -> ImportedFace {
        let surface = nurbs([1, 1], &[[0.0, 0.0, z], [0.0, y, z], [1.0, 0.0, z], [1.0, y, z]]);
        let path = nurbs([2], &[[0.0, 0.0, 0.0], [middle, 0.0, 0.0], [1.0, 0.0, 0.0]]);
        let side = |edge, path| ImportedSide { edge, backwards: false, path, tolerance: 0.02 };
        let back = nurbs([1], &[[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]);
        let loops = vec![vec![side(7, path), side((100.0 + y) as usize, back)]];
        ImportedFace { surface, loops, natural: false }
    }

    fn gap_of(faces: &[ImportedFace]) -> (f64, bool) {
        let found = contacts(faces);
        let joined = found.iter().find_map(|contact| match contact {
            EdgeContact::Joined { gap, by_tolerance, .. } => Some((*gap, *by_tolerance)),
            EdgeContact::Apart { gap, .. } => Some((*gap, false)),
            _ => None,
        });
        joined.expect("the edge of both faces")
    }

    #[test]
    fn sides_of_different_paces_become_one() {
        let mut faces = [sheet(1.0, 0.0, 0.2), sheet(-1.0, 0.0, 0.7)];
        assert!(gap_of(&faces).0 > 0.1);
        assert_eq!(align(&mut faces), [(1, 0, 0)]);
        let (gap, by_tolerance) = gap_of(&faces);
        assert!(gap <= NEAR && !by_tolerance, "{gap}");
    }

    #[test]
    fn sides_apart_within_their_tolerance_are_one() {
        let mut faces = [sheet(1.0, 0.0, 0.2), sheet(-1.0, 0.01, 0.7)];
        align(&mut faces);
        let (gap, by_tolerance) = gap_of(&faces);
        assert!((gap - 0.01).abs() < 1e-4 && by_tolerance, "{gap}");
        let mut faces = [sheet(1.0, 0.0, 0.2), sheet(-1.0, 0.03, 0.7)];
        assert!(align(&mut faces).is_empty());
    }
}
