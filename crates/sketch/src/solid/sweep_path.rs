//! Paths of sweeps: chains of lines and arcs of circles, and the positions of a section along them.

use super::curve::{CurveKind, SmoothPiece, trace};
use super::edges::TreatmentFault;
use super::outline_sides::outline_sides;
use super::swept::{RingMap, SweptSpan};
use super::{DimensionLayout, Planes, SketchSolid};
use crate::{PointId, SketchObject};
use moldloft_num::{Axis as Line, Real, Vec3};
use moldloft_syntax::number::plain;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;

/// Relative distance and angle within which a path is across a section, and pieces of it continue each other.
const ALIGNED: f64 = 1e-9;

/// A piece of a path.
#[derive(Clone, Copy, Debug)]
enum PathPiece<T> {
    Straight([Vec3<T>; 2]),
    /// From its start by an arc.
    Round(SmoothPiece<T>),
}

/// A chain of pieces.
#[derive(Clone, Debug)]
pub(super) struct SweepPath<T> {
    pieces: Vec<PathPiece<T>>,
    closed: bool,
}

impl<T: Real> PathPiece<T> {
    fn at(&self, s: f64) -> Vec3<T> {
        match self {
            PathPiece::Straight([p, q]) => p.lerp(*q, T::from(s)),
            PathPiece::Round(arc) => arc.at(T::from(s)),
        }
    }

    fn direction(&self, s: f64) -> Vec3<T> {
        let along = match self {
            PathPiece::Straight([p, q]) => *q - *p,
            PathPiece::Round(arc) => arc.velocity(T::from(s)),
        };
        along.normalized().unwrap_or_default()
    }

    fn reversed(&self) -> PathPiece<T> {
        match self {
            PathPiece::Straight([p, q]) => PathPiece::Straight([*q, *p]),
            PathPiece::Round(arc) => PathPiece::Round(arc.reversed()),
        }
    }

    /// The parts of the piece before and after its point in a plane that it crosses squarely.
    fn split(&self, at: Vec3<T>, normal: Vec3) -> Option<[PathPiece<T>; 2]> {
        let normal = Vec3::lifted(normal);
        match *self {
            PathPiece::Straight([p, q]) => {
                let m = p + (q - p) * (normal.dot(at - p) / normal.dot(q - p));
                let share = (m - p).re().dot((q - p).re()) / (q - p).re().norm_sq();
                let inside = share > ALIGNED && share < 1.0 - ALIGNED;
                inside.then_some([PathPiece::Straight([p, m]), PathPiece::Straight([m, q])])
            }
            PathPiece::Round(SmoothPiece::Conic { centre, a, b, sweep }) => {
                // Where the arm is in the plane.
                let turn = (-normal.dot(a)).atan2(normal.dot(b));
                let half = T::from(std::f64::consts::PI);
                let turns = [turn, turn + half, turn - half];
                let inside =
                    |t: &T| t.re() > ALIGNED * sweep.re() && t.re() < (1.0 - ALIGNED) * sweep.re();
                let turn = turns.into_iter().find(inside)?;
                let (c, s) = (turn.cos(), turn.sin());
                let first = SmoothPiece::Conic { centre, a, b, sweep: turn };
                let (a, b) = (a * c + b * s, b * c - a * s);
                let second = SmoothPiece::Conic { centre, a, b, sweep: sweep - turn };
                Some([PathPiece::Round(first), PathPiece::Round(second)])
            }
            PathPiece::Round(_) => None,
        }
    }
}

/// The path that a drawing is: all its lines, as one chain, with its rounded corners.
pub(super) fn drawn_path<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Result<SweepPath<T>, TreatmentFault> {
    let name = &object.name;
    let draw = "draw one chain of lines; ARC rounds its corners";
    let at = |p: PointId| layout.point(planes, p);
    let fault = |text: String, p: Option<PointId>| {
        TreatmentFault::new(text, p.and_then(at).map(Vec3::re), draw)
    };
    let mut next: BTreeMap<PointId, Vec<PointId>> = BTreeMap::new();
    for line in object.drawing.lines.values() {
        next.entry(line.p).or_default().push(line.q);
        next.entry(line.q).or_default().push(line.p);
    }
    if let Some((p, _)) = next.iter().find(|(_, n)| n.len() > 2) {
        return Err(fault(format!("the path {name} branches"), Some(*p)));
    }
    let end = next.iter().find(|(_, n)| n.len() == 1).map(|(p, _)| *p);
    let Some(first) = end.or_else(|| next.keys().next().copied()) else {
        return Err(fault(format!("the path {name} has no lines"), None));
    };
    let mut chain = vec![first];
    let mut seen = BTreeSet::from([first]);
    while let Some(p) = next[&chain[chain.len() - 1]].iter().find(|p| !seen.contains(*p)) {
        seen.insert(*p);
        chain.push(*p);
    }
    if let Some(p) = next.keys().find(|p| !seen.contains(*p)) {
        return Err(fault(format!("the path {name} has a second part"), Some(*p)));
    }
    let (n, closed) = (chain.len(), end.is_none());
    let mut arcs: BTreeMap<PointId, (PointId, SmoothPiece<T>, [Vec3<T>; 2])> = BTreeMap::new();
    for curve in object.curves.values().filter(|c| c.replaces) {
        let round = matches!(curve.kind, CurveKind::Arc | CurveKind::Circle);
        let (true, &[a, corner, _]) = (round, &curve.points[..]) else {
            let text = format!("{} of the path {name} is no arc of a circle", curve.name);
            return Err(TreatmentFault::new(text, None, "draw the path of lines and ARC"));
        };
        let refused = || fault(format!("{} does not fit", curve.name), Some(corner));
        let traced = trace(curve, &at, &layout.values).map_err(|_| refused())?;
        if curve.kind == CurveKind::Circle {
            if n != 4 || !closed {
                return Err(fault(format!("{} is not the whole path", curve.name), Some(corner)));
            }
            let pieces = traced.pieces.into_iter().map(PathPiece::Round).collect();
            return Ok(SweepPath { pieces, closed: true });
        }
        let tangents = traced.tangents.ok_or_else(refused)?;
        arcs.insert(corner, (a, traced.pieces[0], tangents));
    }
    let mut pieces = Vec::new();
    let place =
        |p: PointId| at(p).ok_or_else(|| fault(format!("the path {name} has no place"), None));
    // Where the line between two points of the chain starts.
    let leaves = |p: PointId, towards: PointId| -> Result<Vec3<T>, TreatmentFault> {
        match arcs.get(&p) {
            Some((a, _, tangents)) => Ok(tangents[usize::from(*a != towards)]),
            None => place(p),
        }
    };
    let count = if closed { n } else { n - 1 };
    for k in 0..count {
        let (p, q) = (chain[k], chain[(k + 1) % n]);
        let ends = [leaves(p, q)?, leaves(q, p)?];
        let size = place(p)?.re().distance(place(q)?.re());
        let along = (ends[1] - ends[0]).re().dot((place(q)? - place(p)?).re());
        if along < -ALIGNED * size * size {
            let text = format!("rounded corners of the path {name} overlap");
            return Err(TreatmentFault::new(text, Some(ends[0].re()), "give smaller radii"));
        }
        if along > ALIGNED * size * size {
            pieces.push(PathPiece::Straight(ends));
        }
        if let Some((a, arc, _)) = arcs.get(&q).filter(|_| closed || k + 1 < count) {
            pieces.push(PathPiece::Round(if *a == p { *arc } else { arc.reversed() }));
        }
    }
    Ok(SweepPath { pieces, closed })
}

/// The border of a section as a closed path.
pub(super) fn border_path<T: Real>(
    name: &str,
    section: &SketchSolid<T>,
) -> Result<SweepPath<T>, TreatmentFault> {
    let outline = outline_sides(section, &|_| None)?;
    let [sides] = &outline.loops[..] else {
        let text = format!("the path {name} has {} outlines", outline.loops.len());
        return Err(TreatmentFault::new(text, None, "sweep along one of them"));
    };
    let piece = |side: &super::outline_sides::BorderSide<T>| match &side.arc {
        None => PathPiece::Straight(side.ends),
        Some(arc) => PathPiece::Round(side.arc_piece(arc, outline.plane)),
    };
    Ok(SweepPath { pieces: sides.iter().map(piece).collect(), closed: true })
}

/// Positions of a section along a path, and the motions between them.
pub(super) struct SweptRings<T> {
    pub rings: Vec<RingMap<T>>,
    pub spans: Vec<SweptSpan<T>>,
}

impl<T: Real> SweepPath<T> {
    /// The path from the plane of a section on.
    fn started(self, at: Vec3<T>, middle: Vec3, normal: Vec3) -> Result<Self, TreatmentFault> {
        let places = self.pieces.iter().flat_map(|p| [p.at(0.0), p.at(0.5)]);
        let size = places.map(|p| p.re().distance(middle));
        let size = size.fold(0.0, f64::max);
        let square = |p: &PathPiece<T>, s: f64| {
            let off = normal.dot((p.at(s) - at).re()).abs();
            off <= ALIGNED * size && p.direction(s).re().cross(normal).norm() <= ALIGNED
        };
        if !self.closed {
            let turned = |pieces: &[PathPiece<T>]| -> Vec<PathPiece<T>> {
                pieces.iter().rev().map(PathPiece::reversed).collect()
            };
            let ways = [self.pieces.clone(), turned(&self.pieces)];
            let starts = ways.iter().map(|w| w[0].at(0.0).re()).collect::<Vec<_>>();
            let found = ways.into_iter().find(|way| square(&way[0], 0.0));
            return match found {
                Some(pieces) => Ok(SweepPath { pieces, closed: false }),
                None => Err(not_across(starts[0])),
            };
        }
        let mut best: Option<(f64, Vec<PathPiece<T>>)> = None;
        let n = self.pieces.len();
        let mut take = |start: Vec3, pieces: Vec<PathPiece<T>>| {
            let away = start.distance(middle);
            if best.as_ref().is_none_or(|b| away < b.0) {
                best = Some((away, pieces));
            }
        };
        for k in 0..n {
            let mut turned = self.pieces.clone();
            turned.rotate_left(k);
            if square(&turned[0], 0.0) && square(&turned[n - 1], 1.0) {
                take(turned[0].at(0.0).re(), turned);
            } else if let Some([first, second]) = turned[0].split(at, normal)
                && square(&second, 0.0)
            {
                turned[0] = second;
                turned.push(first);
                take(second.at(0.0).re(), turned);
            }
        }
        let start = self.pieces[0].at(0.0).re();
        let (_, pieces) = best.ok_or_else(|| not_across(start))?;
        Ok(SweepPath { pieces, closed: true })
    }

    /// The positions of a section that is moved along the path from its own place, turned as little as possible.
    pub fn rings(
        self,
        section: &SketchSolid<T>,
        normal: Vec3,
    ) -> Result<SweptRings<T>, TreatmentFault> {
        let at = section.vertices.first().map(|v| v.at).unwrap_or_default();
        let way = |e: usize| section.polyline(e, 8);
        let border: Vec<Vec3<T>> = (0..section.edges.len()).flat_map(way).collect();
        let path = self.started(at, section.middle(), normal)?;
        let mut out = SweptRings { rings: vec![RingMap::identity()], spans: Vec::new() };
        let n = path.pieces.len();
        for (k, piece) in path.pieces.iter().enumerate() {
            let next = path.pieces.get(k + 1).or(path.pieces.first().filter(|_| path.closed));
            let direction = piece.direction(1.0);
            let ahead = next.map_or(direction, |p| p.direction(0.0));
            let corner = direction.re().cross(ahead.re()).norm() > ALIGNED
                || direction.re().dot(ahead.re()) < 0.0;
            let end = piece.at(1.0);
            if corner {
                let lines = [Some(piece), next].into_iter().flatten();
                let straight = lines.clone().all(|p| matches!(p, PathPiece::Straight(_)));
                if !straight || direction.re().dot(ahead.re()) < -1.0 + 1e-6 {
                    return Err(TreatmentFault::new(
                        "the path has a corner at an arc, or turns back",
                        Some(end.re()),
                        "let the arc be tangent, as ARC makes it; lines may meet in corners",
                    ));
                }
            }
            let last = out.rings[out.rings.len() - 1];
            match piece {
                PathPiece::Straight(_) => {
                    let across = if corner { direction + ahead } else { direction };
                    let onto =
                        |p: Vec3<T>| p + direction * (across.dot(end - p) / across.dot(direction));
                    let ring = last.then(&onto);
                    let back = border.iter().find(|p| {
                        let way = ring.point(**p) - last.point(**p);
                        way.re().dot(direction.re()) <= ALIGNED * way.re().norm()
                    });
                    if let Some(p) = back {
                        return Err(TreatmentFault::new(
                            "the section is wider than a side of the path is long between its corners",
                            Some(ring.point(*p).re()),
                            "make the section smaller, or the side longer",
                        ));
                    }
                    out.rings.push(ring);
                    out.spans.push(SweptSpan::Straight);
                }
                PathPiece::Round(arc) => out.turn(arc, &border)?,
            }
            if path.closed && k + 1 == n {
                out.close(&border)?;
            }
        }
        Ok(out)
    }
}

fn not_across(start: Vec3) -> TreatmentFault {
    TreatmentFault::new(
        "the path does not start across the section",
        Some(start),
        "let an end of the path be in the plane of the section, square to it; REFERENCE moves a drawing",
    )
}

impl<T: Real> SweptRings<T> {
    /// Adds the positions along an arc.
    fn turn(&mut self, arc: &SmoothPiece<T>, border: &[Vec3<T>]) -> Result<(), TreatmentFault> {
        let SmoothPiece::Conic { centre, a, b, sweep } = *arc else { return Ok(()) };
        let last = self.rings[self.rings.len() - 1];
        let direction = a.cross(b).normalized().unwrap_or_default();
        let axis = Line { point: centre, direction };
        let radius = a.re().norm();
        let reach = border.iter().map(|p| {
            let arm = last.point(*p) - axis.foot(last.point(*p));
            arm.re().dot(a.re()) / radius
        });
        let nearest = reach.fold(f64::INFINITY, f64::min);
        if nearest < ALIGNED * radius {
            return Err(TreatmentFault::new(
                format!(
                    "an arc of the path of radius {} is too small for the section",
                    plain(radius)
                ),
                Some(centre.re()),
                "give a larger radius, or move the section outwards",
            ));
        }
        let steps = (sweep.re() / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let step = sweep * (1.0 / steps);
        for k in 1..=steps as usize {
            self.rings.push(last.then(&|p| axis.rotated(p, step * k as f64)));
            self.spans.push(SweptSpan::Turn(axis, step));
        }
        Ok(())
    }

    /// Joins the last position to the first.
    fn close(&mut self, border: &[Vec3<T>]) -> Result<(), TreatmentFault> {
        let Some(last) = self.rings.pop() else { return Ok(()) };
        let size = border.iter().map(|p| p.re().distance(border[0].re())).fold(0.0, f64::max);
        let off = border.iter().find(|p| last.point(**p).re().distance(p.re()) > 1e-8 * size);
        match off {
            None => Ok(()),
            Some(p) => Err(TreatmentFault::new(
                "the section comes back turned along the closed path",
                Some(last.point(*p).re()),
                "let the path be plane, or open it",
            )),
        }
    }
}
