//! Sides of plane outlines: lines and arcs of circles, the region to their left.

use super::SketchSolid;
use super::curve::SmoothPiece;
use super::edges::TreatmentFault;
use moldloft_num::{Real, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// An outline of more sides than this is refused.
const MAX_SIDES: usize = 2000;

/// A side of an outline.
#[derive(Clone, Debug)]
pub(super) struct BorderSide<T> {
    pub ends: [Vec3<T>; 2],
    pub arc: Option<SideArc<T>>,
    pub name: Option<Arc<str>>,
}

/// The circle of a round side.
#[derive(Clone, Copy, Debug)]
pub(super) struct SideArc<T> {
    pub centre: Vec3<T>,
    pub radius: T,
    /// True if it turns left, so that the region is on the side of the centre.
    pub left: bool,
    /// Its angle in radians, positive.
    pub sweep: T,
}

/// The loops of a section.
pub(super) struct SectionOutlines<T> {
    pub loops: Vec<Vec<BorderSide<T>>>,
    /// The unit normal about which loops around a region are counter-clockwise.
    pub plane: Vec3,
    /// Diagonal of the box around them.
    pub size: f64,
}

/// The border of a flat body; refused where it is neither straight nor an arc of a circle.
pub(super) fn outline_sides<T: Real>(
    section: &SketchSolid<T>,
    name: &dyn Fn(usize) -> Option<Arc<str>>,
) -> Result<SectionOutlines<T>, TreatmentFault> {
    let halves = || section.faces.iter().flat_map(|f| f.loops.iter().flatten()).copied();
    let mut uses = vec![0; section.edges.len()];
    halves().for_each(|h| uses[h.0] += 1);
    let way = |cycle: &Vec<(usize, bool)>| -> Vec<Vec3> {
        cycle.iter().flat_map(|&h| section.run(h)).map(Vec3::re).collect()
    };
    let cycles = section.faces.iter().flat_map(|f| &f.loops);
    let area =
        cycles.fold(Vec3::<f64>::zero(), |sum, c| sum + super::facet_source::newell(&way(c)));
    // A section is perpendicular to an axis.
    let k = (0..3).max_by(|&i, &j| area[i].abs().total_cmp(&area[j].abs())).unwrap_or(2);
    let mut plane = [0.0; 3];
    plane[k] = area[k].signum();
    let plane = Vec3::from(plane);
    let mut left: Vec<(usize, [usize; 2], BorderSide<T>)> = Vec::new();
    for (e, forward) in halves().filter(|h| uses[h.0] == 1) {
        let [a, b] = section.edges[e].ends;
        let ends = if forward { [a, b] } else { [b, a] };
        let at = ends.map(|v| section.vertices[v].at);
        let arc = match section.piece((e, forward)) {
            _ if section.is_straight(e) => None,
            piece => Some(SideArc::of(&piece, plane).ok_or_else(|| {
                let name = name(e).map_or_else(|| "a side".to_owned(), |n| format!("side {n}"));
                TreatmentFault::new(
                    format!("{name} is neither straight nor an arc of a circle"),
                    Some(piece.at(T::from(0.5)).re()),
                    "draw the outline of lines, ARC and CIRCLE",
                )
            })?),
        };
        left.push((e, ends, BorderSide { ends: at, arc, name: name(e) }));
    }
    if left.len() > MAX_SIDES {
        let text = format!("an outline of {} sides", left.len());
        return Err(TreatmentFault::new(text, None, format!("{MAX_SIDES} are the most")));
    }
    let mut starts = vec![0; section.vertices.len()];
    left.iter().for_each(|s| starts[s.1[0]] += 1);
    if let Some(v) = starts.iter().position(|n| *n > 1) {
        return Err(TreatmentFault::new(
            "the outline touches itself",
            Some(section.vertices[v].at.re()),
            "let its parts stay apart",
        ));
    }
    let mut next = vec![usize::MAX; section.vertices.len()];
    left.iter().enumerate().for_each(|(k, s)| next[s.1[0]] = k);
    let mut done = vec![false; left.len()];
    let mut loops = Vec::new();
    for first in 0..left.len() {
        let (mut cycle, mut k) = (Vec::new(), first);
        while k < left.len() && !done[k] {
            done[k] = true;
            cycle.push(left[k].2.clone());
            k = next[left[k].1[1]];
        }
        if !cycle.is_empty() {
            loops.push(cycle);
        }
    }
    let mut low = Vec3::<f64>::of(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for p in section.vertices.iter().map(|v| v.at.re()) {
        low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    Ok(SectionOutlines { loops, plane, size: (high - low).norm() })
}

impl<T: Real> SideArc<T> {
    /// The circle of a piece, if it is a part of one.
    fn of(piece: &SmoothPiece<T>, plane: Vec3) -> Option<SideArc<T>> {
        let SmoothPiece::Conic { centre, a, b, sweep } = *piece else { return None };
        let radius = a.norm();
        let size = radius.re();
        let round = (b.norm() - radius).re().abs() <= 1e-9 * size
            && a.dot(b).re().abs() <= 1e-9 * size * size;
        let turn = plane.dot(a.re().cross(b.re())) * sweep.re();
        round.then(|| SideArc { centre, radius, left: turn > 0.0, sweep: sweep.abs() })
    }

    /// 1 for a left turn, -1 for a right one.
    fn sign(&self) -> f64 {
        if self.left { 1.0 } else { -1.0 }
    }

    /// The angle from one direction to another as the arc turns, from 0 to a full turn.
    fn angle(&self, from: Vec3<T>, to: Vec3<T>, plane: Vec3) -> T {
        let angle = (Vec3::lifted(plane).dot(from.cross(to)) * self.sign()).atan2(from.dot(to));
        if angle.re() < 0.0 { angle + TAU } else { angle }
    }

    /// The part of the circle between two of its points.
    pub fn between(&self, [p, q]: [Vec3<T>; 2], plane: Vec3) -> SideArc<T> {
        let sweep = self.angle(p - self.centre, q - self.centre, plane);
        SideArc { sweep: if sweep.re() <= 0.0 { sweep + TAU } else { sweep }, ..*self }
    }
}

impl<T: Real> BorderSide<T> {
    /// The side without derivatives.
    pub fn re(&self) -> BorderSide<f64> {
        let arc = self.arc.map(|a| SideArc {
            centre: a.centre.re(),
            radius: a.radius.re(),
            left: a.left,
            sweep: a.sweep.re(),
        });
        BorderSide { ends: self.ends.map(Vec3::re), arc, name: self.name.clone() }
    }

    /// The curve of a round side.
    pub fn arc_piece(&self, arc: &SideArc<T>, plane: Vec3) -> SmoothPiece<T> {
        let a = self.ends[0] - arc.centre;
        let b = Vec3::lifted(plane).cross(a) * T::from(arc.sign());
        SmoothPiece::Conic { centre: arc.centre, a, b, sweep: arc.sweep }
    }

    /// The unit normal away from the region, at the start or the end.
    pub fn normal(&self, end: usize, plane: Vec3) -> Vec3<T> {
        let arm = match &self.arc {
            None => (self.ends[1] - self.ends[0]).cross(Vec3::lifted(plane)),
            Some(arc) => (self.ends[end] - arc.centre) * T::from(arc.sign()),
        };
        arm.normalized().unwrap_or_default()
    }

    /// The side moved along its normals; `None` if an arc is turned inside out.
    pub fn moved(&self, by: T, plane: Vec3) -> Option<BorderSide<T>> {
        let ends = [0, 1].map(|k| self.ends[k] + self.normal(k, plane) * by);
        let arc = match self.arc {
            None => None,
            Some(arc) => {
                let radius = arc.radius + by * arc.sign();
                if radius.re() <= 1e-12 * arc.radius.re() {
                    return None;
                }
                Some(SideArc { radius, ..arc })
            }
        };
        Some(BorderSide { ends, arc, name: self.name.clone() })
    }

    /// The same line or circle between other ends.
    pub fn ending(&self, ends: [Vec3<T>; 2], plane: Vec3) -> BorderSide<T> {
        let arc = self.arc.map(|arc| arc.between(ends, plane));
        BorderSide { ends, arc, name: self.name.clone() }
    }

    /// Distance of a point from the line or circle, and its gradient.
    pub fn residual(&self, p: Vec3<T>, plane: Vec3) -> Option<(T, Vec3<T>)> {
        match &self.arc {
            None => {
                let normal = self.normal(0, plane);
                Some((normal.dot(p - self.ends[0]), normal))
            }
            Some(arc) => {
                let arm = p - arc.centre;
                Some((arm.norm() - arc.radius, arm.normalized()?))
            }
        }
    }
}

impl BorderSide<f64> {
    /// The point at a fraction of the side.
    pub fn at(&self, s: f64, plane: Vec3) -> Vec3 {
        match &self.arc {
            None => self.ends[0].lerp(self.ends[1], s),
            Some(arc) => self.arc_piece(arc, plane).at(s),
        }
    }

    /// Direction at a fraction of the side.
    pub fn direction(&self, s: f64, plane: Vec3) -> Vec3 {
        let along = match &self.arc {
            None => self.ends[1] - self.ends[0],
            Some(arc) => self.arc_piece(arc, plane).velocity(s),
        };
        along.normalized().unwrap_or_default()
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        match &self.arc {
            None => self.ends[0].distance(self.ends[1]),
            Some(arc) => arc.radius * arc.sweep,
        }
    }

    /// The fraction of the side at which a point within `tolerance` is on it.
    pub fn fraction(&self, p: Vec3, plane: Vec3, tolerance: f64) -> Option<f64> {
        let margin = tolerance / self.length();
        let s = match &self.arc {
            None => {
                let along = self.ends[1] - self.ends[0];
                (p - self.ends[0]).dot(along) / along.norm_sq()
            }
            Some(arc) => {
                let angle = arc.angle(self.ends[0] - arc.centre, p - arc.centre, plane);
                let angle = if angle > 0.5 * (arc.sweep + TAU) { angle - TAU } else { angle };
                angle / arc.sweep
            }
        };
        if !(-margin..=1.0 + margin).contains(&s) {
            return None;
        }
        let s = s.clamp(0.0, 1.0);
        (self.at(s, plane).distance(p) <= tolerance).then_some(s)
    }

    /// Distance of a point.
    pub fn distance(&self, p: Vec3, plane: Vec3) -> f64 {
        match &self.arc {
            None => {
                let along = self.ends[1] - self.ends[0];
                let s = ((p - self.ends[0]).dot(along) / along.norm_sq()).clamp(0.0, 1.0);
                (self.ends[0] + along * s).distance(p)
            }
            Some(arc) => {
                let angle = arc.angle(self.ends[0] - arc.centre, p - arc.centre, plane);
                if angle <= arc.sweep {
                    return ((p - arc.centre).norm() - arc.radius).abs();
                }
                self.ends[0].distance(p).min(self.ends[1].distance(p))
            }
        }
    }

    /// Winding number of a loop about a point that is not on it.
    pub fn winding(sides: &[BorderSide<f64>], p: Vec3, plane: Vec3) -> i64 {
        let turn = |side: &BorderSide<f64>| {
            let [a, b] = side.ends.map(|e| e - p);
            let chord = Real::atan2(plane.dot(a.cross(b)), a.dot(b));
            let Some(arc) = &side.arc else { return chord };
            // A point between chord and arc sees the arc around its other side.
            let right = plane.dot((b - a).cross(-a)) * arc.sign() < 0.0;
            if right && (p - arc.centre).norm() < arc.radius {
                let full = TAU * arc.sign();
                return chord + full;
            }
            chord
        };
        (sides.iter().map(turn).sum::<f64>() / TAU).round() as i64
    }

    /// The area inside of a loop, negative if it is clockwise.
    pub fn area(sides: &[BorderSide<f64>], plane: Vec3) -> f64 {
        let origin = sides[0].ends[0];
        let part = |side: &BorderSide<f64>| {
            let [a, b] = side.ends.map(|e| e - origin);
            let chord = 0.5 * plane.dot(a.cross(b));
            let Some(arc) = &side.arc else { return chord };
            let segment = 0.5 * arc.radius * arc.radius * (arc.sweep - Real::sin(arc.sweep));
            chord + segment * arc.sign()
        };
        sides.iter().map(part).sum()
    }
}
