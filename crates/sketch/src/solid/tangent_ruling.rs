//! Cylinders that touch planes, or wider ones from inside, along a ruling.
//!
//! Beside such a ruling facets that subtend one angle are in one plane, whatever the radii, and facets that do not end
//! there cross. So chords of both cylinders end at it, and those of the wider one turn less there than the first ones
//! of the narrower one.

use super::SketchSolid;
use super::curve::SmoothPiece;
use super::edges::FaceForm;
use super::facet_source::along;
use super::meeting::round_cylinder;
use super::surface::FaceSurface;
use moldloft_num::{Real, Vec3};

/// Tolerance of a contact, relative to the wider radius.
const CONTACT: f64 = 1e-9;

/// Maximum sine between parallel axes.
const PARALLEL: f64 = 1e-9;

/// Difference of parameters on an arc below which they are equal.
const ONE_SHARE: f64 = 1e-9;

/// Half the angle of a chord, in radians.
const HALF_CHORD: f64 = std::f64::consts::PI / 72.0;

/// Maximum number of divisions of the wider cylinder's chords into three.
const MAX_THIRDS: u32 = 4;

/// The ruling along which a cylinder touches a plane, or a wider cylinder from inside.
#[derive(Clone, Debug, PartialEq)]
pub struct TangentRuling {
    /// A point of it.
    pub at: Vec3,
    /// Its unit direction.
    pub way: Vec3,
    /// The radii, the smaller one first; that of a plane is infinite.
    pub radii: [f64; 2],
}

/// An end of chords of an arc at a ruling.
#[derive(Clone, Copy)]
pub(super) struct ChordEnd {
    /// Its parameter on the arc.
    share: f64,
    /// Divisions of the chords around it into three; none of the narrower cylinder's.
    thirds: u32,
    /// Extent of the divisions to either side, as a parameter range on the arc.
    reach: f64,
}

impl TangentRuling {
    /// The image by a similarity.
    pub(super) fn mapped(&self, map: &dyn Fn(Vec3) -> Vec3) -> TangentRuling {
        let at = map(self.at);
        let by = map(self.at + self.way) - at;
        let scale = by.norm();
        TangentRuling { at, way: by / scale, radii: self.radii.map(|r| r * scale) }
    }

    fn same(&self, other: &TangentRuling) -> bool {
        let [narrow, wide] = self.radii;
        let tolerance = 2.0 * CONTACT * if wide.is_finite() { wide } else { narrow };
        (other.at - self.at).cross(self.way).norm() <= tolerance && self.radii == other.radii
    }

    /// The end of chords where it meets an arc of one of its cylinders.
    pub(super) fn end_on<T: Real>(&self, piece: &SmoothPiece<T>) -> Option<ChordEnd> {
        let SmoothPiece::Conic { centre, a, b, sweep } = *piece else { return None };
        let [centre, a, b] = [centre, a, b].map(Vec3::re);
        let [narrow, wide] = self.radii;
        let size = a.norm();
        let tolerance = CONTACT * size;
        let one = |r: f64| (size - r).abs() <= tolerance;
        let circle = (size - b.norm()).abs() <= tolerance && a.dot(b).abs() <= tolerance * size;
        let upright = a.cross(b).normalized()?.cross(self.way).norm() <= PARALLEL;
        if !(circle && upright && (one(narrow) || one(wide))) {
            return None;
        }
        let p = self.at + self.way * self.way.dot(centre - self.at);
        let share = share_at(piece, p, tolerance)?;
        if one(narrow) {
            return Some(ChordEnd { share, thirds: 0, reach: 0.0 });
        }
        // The polygon of the wider circle is off it by the height of a chord; the narrower circle is off it by more from
        // this distance on.
        let reach = 1.5 * HALF_CHORD * (narrow / (wide - narrow)).sqrt() / sweep.re().abs();
        // The first chord of the narrower circle subtends half of a whole one or more.
        let turn = 0.9 * (narrow * (wide - narrow)).sqrt() / wide;
        let thirds = (1..MAX_THIRDS).find(|k| 3f64.powi(*k as i32) * turn >= 1.0);
        Some(ChordEnd { share, thirds: thirds.unwrap_or(MAX_THIRDS), reach })
    }
}

impl ChordEnd {
    /// The end on an edge that runs the other way.
    pub(super) fn turned(self) -> ChordEnd {
        ChordEnd { share: 1.0 - self.share, ..self }
    }

    /// True if it divides the chords around it.
    pub(super) fn divides(&self) -> bool {
        self.thirds > 0
    }

    /// Their order along an arc.
    pub(super) fn order(&self, other: &ChordEnd) -> std::cmp::Ordering {
        self.share.total_cmp(&other.share)
    }

    /// True if two are one.
    pub(super) fn same(&self, other: &ChordEnd) -> bool {
        (self.share - other.share).abs() <= ONE_SHARE && self.thirds == other.thirds
    }

    /// The ends of an arc's chords with this one.
    pub(super) fn among(&self, shares: &[f64]) -> Vec<f64> {
        let s = self.share;
        let parts = 3u32.pow(self.thirds);
        let near = |w: &[f64]| w[1] >= s - self.reach && w[0] <= s + self.reach;
        let mut out = vec![shares[0]];
        for w in shares.windows(2) {
            if near(w) {
                let part = |k: u32| w[0] + (w[1] - w[0]) * f64::from(k) / f64::from(parts);
                out.extend((1..parts).map(part));
            }
            out.push(w[1]);
        }
        let k = out.partition_point(|x| *x < s - ONE_SHARE);
        if k == 0 || k >= out.len() || (out[k] - s).abs() <= ONE_SHARE {
            return out;
        }
        out.insert(k, s);
        if self.thirds == 0 {
            // No chord beside it is shorter than half of one.
            let nearer = if s - out[k - 1] < out[k + 1] - s { k - 1 } else { k + 1 };
            if nearer > 0 && nearer + 1 < out.len() {
                out.remove(nearer);
            }
        }
        out
    }
}

/// The parameter on an arc of a point that is on it.
fn share_at<T: Real>(piece: &SmoothPiece<T>, p: Vec3, tolerance: f64) -> Option<f64> {
    let s = along(piece, p);
    let on = piece.at(T::from(s)).re().distance(p) <= tolerance;
    (on && (-ONE_SHARE..=1.0 + ONE_SHARE).contains(&s)).then(|| s.clamp(0.0, 1.0))
}

/// A round face of a cylinder.
struct CylinderPatch<T> {
    near: SmoothPiece<T>,
    centre: Vec3,
    way: Vec3,
    radius: f64,
    length: f64,
}

impl<T: Real> CylinderPatch<T> {
    fn of(surface: &FaceSurface<T>) -> Option<CylinderPatch<T>> {
        let cylinder = round_cylinder(surface)?;
        let FaceSurface::Ruled { near, far } = *surface else { return None };
        let [SmoothPiece::Conic { centre, .. }, SmoothPiece::Conic { centre: other, .. }] =
            [near, far]
        else {
            return None;
        };
        let (centre, way) = (centre.re(), cylinder.axis.direction.re());
        let length = way.dot(other.re() - centre);
        Some(CylinderPatch { near, centre, way, radius: cylinder.radius.re(), length })
    }

    /// True if the ruling through a point is on it.
    fn holds(&self, p: Vec3, tolerance: f64) -> bool {
        let level = p - self.way * self.way.dot(p - self.centre);
        share_at(&self.near, level, tolerance).is_some()
    }

    /// The ruling along which it touches a plane.
    fn touches_plane(&self, [at, normal]: [Vec3; 2]) -> Option<TangentRuling> {
        let off = normal.dot(self.centre - at);
        let tolerance = CONTACT * self.radius;
        if normal.dot(self.way).abs() > PARALLEL || (off.abs() - self.radius).abs() > tolerance {
            return None;
        }
        let at = self.centre - normal * off;
        let ruling = TangentRuling { at, way: self.way, radii: [self.radius, f64::INFINITY] };
        self.holds(at, tolerance).then_some(ruling)
    }

    /// The rulings of it and of a cylinder across it through the points where they touch.
    fn touches_across(&self, other: &CylinderPatch<T>) -> Vec<TangentRuling> {
        let across = self.way.cross(other.way);
        let Some(normal) = across.normalized().filter(|_| across.norm() > PARALLEL) else {
            return Vec::new();
        };
        let (apart, square) = (other.centre - self.centre, across.norm_sq());
        let height = normal.dot(apart);
        let foot = self.centre + self.way * (apart.cross(other.way).dot(across) / square);
        let tolerance = CONTACT * self.radius.max(other.radius);
        let mut out = Vec::new();
        for (side, own) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            // The levels of both surfaces along the common normal of the axes.
            let level = side * self.radius;
            if (level - height - own * other.radius).abs() > tolerance {
                continue;
            }
            let at = foot + normal * level;
            for patch in [self, other].into_iter().filter(|patch| patch.holds(at, tolerance)) {
                let radii = [patch.radius, f64::INFINITY];
                out.push(TangentRuling { at, way: patch.way, radii });
            }
        }
        out
    }

    fn touches(&self, wide: &CylinderPatch<T>) -> Option<TangentRuling> {
        let (way, tolerance) = (wide.way, CONTACT * wide.radius);
        if self.radius >= wide.radius - tolerance || self.way.cross(way).norm() > PARALLEL {
            return None;
        }
        let off = self.centre - wide.centre;
        let across = off - way * way.dot(off);
        let apart = across.norm();
        if apart <= tolerance || (apart - (wide.radius - self.radius)).abs() > tolerance {
            return None;
        }
        let at = wide.centre + across * (wide.radius / apart);
        // Their extents along the axis.
        let from = way.dot(off);
        let to = from + self.length * way.dot(self.way);
        let beside = from.max(to) < -tolerance || from.min(to) > wide.length + tolerance;
        let both = [self, wide].iter().all(|patch| patch.holds(at, tolerance));
        let radii = [self.radius, wide.radius];
        (both && !beside).then_some(TangentRuling { at, way, radii })
    }
}

/// The rulings along which cylinders touch wider ones of other bodies from inside, or planes, and those through the
/// points where they touch cylinders across them.
pub(super) fn rulings<T: Real>(bodies: &[&SketchSolid<T>]) -> Vec<TangentRuling> {
    let patches = |body: &&SketchSolid<T>| -> Vec<CylinderPatch<T>> {
        let surfaces = (0..body.faces.len()).filter_map(|f| body.surface(f));
        surfaces.filter_map(|s| CylinderPatch::of(&s)).collect()
    };
    let planes = |body: &&SketchSolid<T>| -> Vec<[Vec3; 2]> {
        let form = |f: usize| match body.form(f) {
            FaceForm::Plane { at, normal } => Some([at.re(), normal.re()]),
            _ => None,
        };
        (0..body.faces.len()).filter_map(form).collect()
    };
    let all: Vec<Vec<CylinderPatch<T>>> = bodies.iter().map(patches).collect();
    let mut out: Vec<TangentRuling> = Vec::new();
    for (j, other) in bodies.iter().enumerate() {
        let planes = planes(other);
        for narrow in all.iter().enumerate().filter(|(i, _)| *i != j).flat_map(|(_, own)| own) {
            let beside = all[j].iter().filter_map(|wide| narrow.touches(wide));
            let flat = planes.iter().filter_map(|plane| narrow.touches_plane(*plane));
            let across = all[j].iter().flat_map(|other| narrow.touches_across(other));
            for found in beside.chain(flat).chain(across) {
                if !out.iter().any(|known| known.same(&found)) {
                    out.push(found);
                }
            }
        }
    }
    out
}
