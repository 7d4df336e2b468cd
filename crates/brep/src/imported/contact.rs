//! Sides of faces along a common edge: whether they coincide, and how far apart they run.

use super::faces::{ImportedFace, border, is_whole, within};
use super::points::NurbsPoints;
use moldloft_num::Vec3;
use std::collections::HashMap;

/// Number of points at which two sides are compared, as in `Join`.
const TRIALS: usize = 65;

/// Distance of two sides, relative to their length, above which they are not joined, unless the
/// tolerance of the edge is larger.
const PARTED: f64 = 1e-3;

/// A side of a face as it is named in a program: a snake, or an edge of a whole surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideName {
    /// An edge of the whole surface: the parameter that is fixed (0 for u) and its value.
    Border(usize, u8),
    /// A side of a loop, by numbers.
    Snake(usize, usize),
}

/// An edge with several sides.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeContact {
    /// Two sides that are one within a distance.
    Joined {
        /// Faces and their sides.
        sides: [(usize, SideName); 2],
        /// Their distance at equal parameters.
        gap: f64,
        /// True when only the tolerance of the edge allows it.
        by_tolerance: bool,
    },
    /// A trimmed face that meets itself.
    Seam {
        /// The face.
        face: usize,
    },
    /// Two sides that are not one curve.
    Apart {
        /// The faces.
        faces: [usize; 2],
        /// Their distance at equal parameters.
        gap: f64,
    },
    /// A part of an edge of a whole surface.
    Part {
        /// The face.
        face: usize,
    },
}

struct NamedSide {
    face: usize,
    name: SideName,
    tolerance: f64,
    places: Vec<Vec3>,
}

/// A side; `None` for a part of an edge of a whole surface.
fn named_side(
    face: &ImportedFace,
    number: usize,
    surface: &NurbsPoints<2>,
    (c, k): (usize, usize),
) -> Option<NamedSide> {
    let cycle = &face.loops[c];
    let side = &cycle[k];
    let ts = (0..TRIALS).map(|i| i as f64 / (TRIALS - 1) as f64);
    let (name, places) = if face.natural {
        let (axis, held) = border(&side.path).filter(|_| is_whole(&side.path))?;
        let at = |t: f64| if axis == 0 { [held, t] } else { [t, held] };
        let places: Vec<Vec3> = ts.map(|t| surface.at(at(t))).collect();
        (SideName::Border(axis, held as u8), places)
    } else {
        // In a program a side ends where the next one begins.
        let next = &cycle[(k + 1) % cycle.len()];
        let following =
            if next.backwards { next.path.points.last() } else { next.path.points.first() };
        let mut path = side.path.clone();
        let end = if side.backwards { path.points.first_mut() } else { path.points.last_mut() };
        if let (Some(end), Some(following)) = (end, following) {
            *end = *following;
        }
        let points = NurbsPoints::new(&path);
        let along = |t: f64| if side.backwards { 1.0 - t } else { t };
        let places = ts.map(|t| surface.at(within(points.at([along(t)])))).collect();
        (SideName::Snake(c, k), places)
    };
    Some(NamedSide { face: number, name, tolerance: side.tolerance, places })
}

/// Edges of several sides, in the order of first mention.
pub fn contacts(faces: &[ImportedFace]) -> Vec<EdgeContact> {
    let mut order: Vec<(usize, Vec<Option<NamedSide>>)> = Vec::new();
    let mut known: HashMap<usize, usize> = HashMap::new();
    for (f, face) in faces.iter().enumerate() {
        let surface = NurbsPoints::new(&face.surface);
        for (c, cycle) in face.loops.iter().enumerate() {
            for (k, side) in cycle.iter().enumerate() {
                let at = *known.entry(side.edge).or_insert_with(|| {
                    order.push((f, Vec::new()));
                    order.len() - 1
                });
                order[at].1.push(named_side(face, f, &surface, (c, k)));
            }
        }
    }
    let mut found = Vec::new();
    for (face, sides) in &order {
        if sides.len() > 1 && sides.iter().any(Option::is_none) {
            found.push(EdgeContact::Part { face: *face });
        }
        for pair in sides.windows(2) {
            if let [Some(one), Some(other)] = pair {
                found.extend(contact(faces, one, other));
            }
        }
    }
    found
}

fn contact(faces: &[ImportedFace], one: &NamedSide, other: &NamedSide) -> Option<EdgeContact> {
    let length: f64 = one.places.windows(2).map(|w| w[0].distance(w[1])).sum();
    if (one.face, one.name) == (other.face, other.name) || length == 0.0 {
        return None;
    }
    if one.face == other.face && !faces[one.face].natural {
        return Some(EdgeContact::Seam { face: one.face });
    }
    let gap = one.gap(other);
    let tolerance = one.tolerance.max(other.tolerance);
    Some(if gap <= PARTED * length || gap <= tolerance {
        let by_tolerance = gap > PARTED * length;
        let sides = [one, other].map(|side| (side.face, side.name));
        EdgeContact::Joined { sides, gap, by_tolerance }
    } else {
        EdgeContact::Apart { faces: [one.face, other.face], gap }
    })
}

impl NamedSide {
    /// The distance at equal parameters, in the direction in which it is less.
    fn gap(&self, other: &NamedSide) -> f64 {
        let widest = |theirs: &mut dyn Iterator<Item = &Vec3>| {
            self.places.iter().zip(theirs).fold(0.0f64, |most, (p, q)| most.max(p.distance(*q)))
        };
        widest(&mut other.places.iter()).min(widest(&mut other.places.iter().rev()))
    }
}

/// Sides of trimmed faces that are one point within a distance: those of two faces that meet, and faces with others.
pub fn poles(faces: &[ImportedFace], near: f64) -> (Vec<[(usize, SideName); 2]>, Vec<usize>) {
    let mut sides: Vec<NamedSide> = Vec::new();
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| !face.natural) {
        let surface = NurbsPoints::new(&face.surface);
        for (c, cycle) in face.loops.iter().enumerate() {
            let all = (0..cycle.len()).filter_map(|k| named_side(face, f, &surface, (c, k)));
            sides.extend(all.filter(|side| side.is_point(near)));
        }
    }
    let (mut pairs, mut alone) = (Vec::new(), Vec::new());
    while let Some(one) = sides.pop() {
        let apart = |side: &NamedSide| {
            let d = side.places[0] - one.places[0];
            d.x.abs().max(d.y.abs()).max(d.z.abs())
        };
        let (there, left): (Vec<NamedSide>, Vec<NamedSide>) =
            sides.into_iter().partition(|side| apart(side) <= near);
        sides = left;
        match &there[..] {
            [other] if other.face != one.face => {
                pairs.push([(other.face, other.name), (one.face, one.name)]);
            }
            _ => {
                alone.push(one.face);
                alone.extend(there.iter().map(|side| side.face));
            }
        }
    }
    (pairs, alone)
}

impl NamedSide {
    fn is_point(&self, near: f64) -> bool {
        let first = self.places[0];
        let (mut low, mut high) = (first, first);
        for p in &self.places {
            low = Vec3::of(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
            high = Vec3::of(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
        }
        let d = high - low;
        d.x.max(d.y).max(d.z) <= near
    }
}
