//! Closed forms of the curves in which two surfaces meet.
//!
//! Surfaces of revolution about the same axis intersect in circles about it; the section of a
//! translation surface by a plane is an affine image of the translated curve; cylinders of one
//! radius with intersecting axes intersect in two ellipses, in the planes that bisect the angles
//! between the axes. The conditions are tested for derivatives too: a circle that any change turns
//! into another curve has no closed form here.

use super::curve::SmoothPiece;
use super::facet_source::along;
use super::revolved::{all_vanish, round, straight_axis, vanishes};
use super::surface::FaceSurface;
use moldloft_num::{Axis, Real, Vec3};
use std::f64::consts::PI;

/// The lines about which a surface may be turned without a change.
enum SymmetryAxis<T> {
    /// All in one direction: those of a plane.
    Along(Vec3<T>),
    /// All through a point: those of a sphere.
    Through(Vec3<T>),
    /// One.
    One(Axis<T>),
}

pub(super) struct RoundCylinder<T> {
    pub(super) axis: Axis<T>,
    pub(super) radius: T,
}

/// The displacement from the first curve of a ruled surface to its second one, if it is a
/// translation.
fn translation<T: Real>(surface: &FaceSurface<T>) -> Option<(&SmoothPiece<T>, Vec3<T>)> {
    let FaceSurface::Ruled { near, far } = surface else { return None };
    let (
        SmoothPiece::Conic { centre, a, b, sweep },
        SmoothPiece::Conic { centre: c, a: p, b: q, sweep: s },
    ) = (near, far)
    else {
        return None;
    };
    let size = a.re().norm() + b.re().norm();
    let same = all_vanish(*a - *p, size) && all_vanish(*b - *q, size) && vanishes(*sweep - *s, 1.0);
    same.then_some((near, *c - *centre))
}

pub(super) fn round_cylinder<T: Real>(surface: &FaceSurface<T>) -> Option<RoundCylinder<T>> {
    let (&SmoothPiece::Conic { centre, a, b, .. }, way) = translation(surface)? else {
        return None;
    };
    let (direction, length, radius) = (way.normalized()?, way.re().norm(), a.norm());
    let upright = [a, b].iter().all(|r| vanishes(r.dot(way) / length, radius.re()));
    (round(a, b) && upright)
        .then_some(RoundCylinder { axis: Axis { point: centre, direction }, radius })
}

fn symmetry_axis<T: Real>(surface: &FaceSurface<T>) -> Option<SymmetryAxis<T>> {
    Some(match surface {
        FaceSurface::Plane { normal, .. } => SymmetryAxis::Along(*normal),
        FaceSurface::Ruled { near, far } => SymmetryAxis::One(straight_axis(near, far)?),
        FaceSurface::Turned { centre, axis, profile, .. } => {
            let axis = Axis { point: *centre, direction: *axis };
            match *profile {
                SmoothPiece::Conic { centre: c, a, b, .. } if round(a, b) => {
                    let size = a.re().norm();
                    let normal = a.cross(b).normalized()?;
                    let central = all_vanish(c - axis.foot(c), size)
                        && vanishes(normal.dot(axis.direction), 1.0);
                    if central { SymmetryAxis::Through(c) } else { SymmetryAxis::One(axis) }
                }
                _ => SymmetryAxis::One(axis),
            }
        }
    })
}

/// The axis about which two surfaces may both be turned.
fn common_axis<T: Real>(pair: [&FaceSurface<T>; 2], scale: f64) -> Option<Axis<T>> {
    use SymmetryAxis::{Along, One, Through};
    let parallel = |a: Vec3<T>, b: Vec3<T>| all_vanish(a.cross(b), 1.0);
    let on = |axis: &Axis<T>, p: Vec3<T>| all_vanish(p - axis.foot(p), scale);
    match (symmetry_axis(pair[0])?, symmetry_axis(pair[1])?) {
        (Along(_), Along(_)) => None,
        (Along(n), Through(c)) | (Through(c), Along(n)) => Some(Axis { point: c, direction: n }),
        (Along(n), One(axis)) | (One(axis), Along(n)) => {
            parallel(n, axis.direction).then_some(axis)
        }
        (Through(c), One(axis)) | (One(axis), Through(c)) => on(&axis, c).then_some(axis),
        (Through(c), Through(e)) => Some(Axis { point: c, direction: (e - c).normalized()? }),
        (One(a), One(b)) => (parallel(a.direction, b.direction) && on(&a, b.point)).then_some(a),
    }
}

/// The arc about an axis through points in order.
fn arc<T: Real>(axis: &Axis<T>, points: &[Vec3<T>]) -> Option<SmoothPiece<T>> {
    let (first, last) = (*points.first()?, *points.last()?);
    let centre = axis.foot(first);
    let a = first - centre;
    let mut b = axis.direction.cross(a);
    if b.re().dot(points.get(1)?.re() - first.re()) < 0.0 {
        b = -b;
    }
    let closed = first.re() == last.re();
    let way = last.re() - centre.re();
    let angle = libm::atan2(b.re().dot(way), a.re().dot(way));
    let sweep = match (closed, angle > 0.0) {
        (true, _) => 2.0 * PI,
        (false, true) => angle,
        (false, false) => angle + 2.0 * PI,
    };
    (a.re().norm() > 0.0).then(|| SmoothPiece::Conic { centre, a, b, sweep: T::from(sweep) })
}

/// The section of a translation surface by a plane that crosses the direction of translation.
fn oblique_section<T: Real>(
    surface: &FaceSurface<T>,
    at: Vec3<T>,
    normal: Vec3<T>,
) -> Option<SmoothPiece<T>> {
    let (&SmoothPiece::Conic { centre, a, b, sweep }, way) = translation(surface)? else {
        return None;
    };
    let rate = normal.dot(way);
    if rate.re().abs() <= 1e-6 * way.re().norm() {
        return None;
    }
    let moved = |r: Vec3<T>| r - way * (normal.dot(r) / rate);
    let centre = centre + way * (normal.dot(at - centre) / rate);
    Some(SmoothPiece::Conic { centre, a: moved(a), b: moved(b), sweep })
}

/// Cylinders of one radius whose axes cross.
pub(super) struct EqualCylinders<T> {
    /// Intersection of the axes.
    centre: Vec3<T>,
    /// The normals of the planes of their two ellipses.
    normals: [Vec3<T>; 2],
    /// From the centre to an intersection of the ellipses; the other one is opposite.
    pinch: Vec3<T>,
}

impl<T: Real> EqualCylinders<T> {
    /// Two surfaces, where they are such cylinders.
    pub(super) fn of(pair: [&FaceSurface<T>; 2], scale: f64) -> Option<EqualCylinders<T>> {
        let [a, b] = [round_cylinder(pair[0])?, round_cylinder(pair[1])?];
        let (y, z) = (a.axis.direction, b.axis.direction);
        let across = y.cross(z);
        let square = across.norm_sq();
        // Parallel axes.
        if square.re() <= 1e-12 {
            return None;
        }
        let apart = b.axis.point - a.axis.point;
        let height = apart.dot(across) / square.sqrt();
        if !vanishes(a.radius - b.radius, a.radius.re()) || !vanishes(height, scale) {
            return None;
        }
        let centre = a.axis.point + y * (apart.cross(z).dot(across) / square);
        let normals = [(y + z).normalized()?, (y - z).normalized()?];
        Some(EqualCylinders { centre, normals, pinch: across * (a.radius / square.sqrt()) })
    }

    /// The common point of both ellipses near a position.
    pub(super) fn vertex(&self, near: Vec3, scale: f64) -> Option<Vec3<T>> {
        let both = [self.centre + self.pinch, self.centre - self.pinch];
        both.into_iter().find(|p| p.re().distance(near) <= 1e-7 * scale)
    }

    /// The ellipse that passes near a position.
    pub(super) fn ellipse(&self, surface: &FaceSurface<T>, by: Vec3) -> Option<SmoothPiece<T>> {
        let off = |n: &Vec3<T>| n.re().dot(by - self.centre.re()).abs();
        let [m, n] = &self.normals;
        oblique_section(surface, self.centre, if off(m) <= off(n) { *m } else { *n })
    }
}

/// The curve of closed form in which two surfaces meet, through points in order, where it has one.
pub(super) fn closed_form<T: Real>(
    pair: [&FaceSurface<T>; 2],
    points: &[Vec3<T>],
    scale: f64,
) -> Option<SmoothPiece<T>> {
    let curve = match common_axis(pair, scale) {
        Some(axis) => arc(&axis, points)?,
        None => match (pair, ruling(pair)) {
            (_, true) => SmoothPiece::straight(*points.first()?, *points.last()?),
            ([FaceSurface::Plane { at, normal }, round], _)
            | ([round, FaceSurface::Plane { at, normal }], _) => {
                oblique_section(round, *at, *normal)?
            }
            _ => return None,
        },
    };
    // Newton's method found the points, so they say whether it is the curve that was meant.
    let on = |p: &Vec3<T>| {
        let s = along(&curve, p.re());
        (-1e-6..=1.0 + 1e-6).contains(&s)
            && curve.at(T::from(s)).re().distance(p.re()) <= 1e-9 * scale
    };
    points.iter().step_by(1 + points.len() / 4).chain(points.last()).all(on).then_some(curve)
}

/// True if surfaces intersect in straight lines that are rulings of both.
fn ruling<T: Real>(pair: [&FaceSurface<T>; 2]) -> bool {
    let way = |s: &FaceSurface<T>| translation(s).and_then(|t| t.1.normalized());
    match pair {
        [FaceSurface::Plane { normal, .. }, round] | [round, FaceSurface::Plane { normal, .. }] => {
            way(round).is_some_and(|w| vanishes(normal.dot(w), 1.0))
        }
        [a, b] => {
            let both = way(a).zip(way(b));
            both.is_some_and(|(a, b)| all_vanish(a.cross(b), 1.0))
        }
    }
}
