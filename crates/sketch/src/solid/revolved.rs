//! Surfaces of revolution as equations: their axes and meridians, the distance of a point, and its
//! parameters on a patch.

use super::curve::SmoothPiece;
use super::surface::FaceSurface;
use moldloft_num::{Axis, Real, Vec3};
use std::f64::consts::TAU;

/// Tolerance of equal positions, relative to the sizes around them.
const ALIKE: f64 = 1e-11;

/// Speed relative to a face, compared with the speeds around, from which faces separate in a
/// corner.
const PARTING: f64 = 1e-6;

/// Speed by rounding: parameters are lengths and degrees, so that speeds of motion are about one.
const STILL: f64 = 1e-11;

/// True if a speed is above rounding, relative to the speeds around it.
pub(super) fn moves(speed: f64, around: f64) -> bool {
    speed.abs() > PARTING * around + STILL
}

/// A cylinder, cone, sphere or torus.
pub(super) struct RevolvedSurface<T> {
    /// Its axis, through the centre of a sphere or torus.
    pub(super) axis: Axis<T>,
    pub(super) meridian: Meridian<T>,
}

/// The curve that is turned about the axis.
#[derive(Clone, Copy)]
pub(super) enum Meridian<T> {
    /// The radius at the point of the axis, and its change along the axis.
    Line { radius: T, slope: T },
    /// The distance of a circle's centre from the axis, and its radius.
    Circle { big: T, small: T },
}

impl<T: Real> Meridian<T> {
    pub(super) fn re(&self) -> Meridian<f64> {
        match self {
            Meridian::Line { radius, slope } => {
                Meridian::Line { radius: radius.re(), slope: slope.re() }
            }
            Meridian::Circle { big, small } => {
                Meridian::Circle { big: big.re(), small: small.re() }
            }
        }
    }
}

impl<T: Real> RevolvedSurface<T> {
    pub(super) fn of(surface: &FaceSurface<T>) -> Option<RevolvedSurface<T>> {
        match surface {
            FaceSurface::Plane { .. } => None,
            FaceSurface::Ruled { near, far } => {
                let axis = straight_axis(near, far)?;
                let &SmoothPiece::Conic { centre, a, .. } = near else { return None };
                let radius = a.norm();
                let (end, other) = match *far {
                    SmoothPiece::Conic { centre, a: p, .. } => (centre, p.dot(a) / radius),
                    SmoothPiece::Cubic([p, ..]) => (p, T::zero()),
                };
                let height = axis.direction.dot(end - centre);
                // A plane ring, or two nappes.
                if height.re().abs() <= ALIKE * radius.re() || other.re() < 0.0 {
                    return None;
                }
                let slope = (other - radius) / height;
                Some(RevolvedSurface { axis, meridian: Meridian::Line { radius, slope } })
            }
            FaceSurface::Turned { centre, axis, profile, .. } => {
                let SmoothPiece::Conic { centre: c, a, b, .. } = *profile else { return None };
                let normal = a.cross(b).normalized()?;
                let own = Axis { point: *centre, direction: *axis };
                let (small, foot) = (a.norm(), own.foot(c));
                let size = small.re() + (c - foot).re().norm();
                let upright = vanishes(normal.dot(*axis), 1.0)
                    && vanishes(normal.dot(c - foot), size)
                    && round(a, b);
                let central = all_vanish(c - foot, small.re());
                let big = if central { T::zero() } else { (c - foot).norm() };
                let own = Axis { point: if central { c } else { foot }, direction: *axis };
                let meridian = Meridian::Circle { big, small };
                upright.then_some(RevolvedSurface { axis: own, meridian })
            }
        }
    }

    /// The distance of a point from the surface, negative on the side of the axis or of the centre
    /// of the section, and its gradient; that of a cone is measured across the axis. `None` where there is no gradient.
    pub(super) fn level(&self, p: Vec3<T>) -> Option<(T, Vec3<T>)> {
        let Axis { point, direction } = self.axis;
        let by = p - point;
        let out = |v: Vec3<T>| -> Option<(T, Vec3<T>)> {
            let size = v.norm();
            (size.re() > 0.0).then(|| (size, v / size))
        };
        let height = direction.dot(by);
        match self.meridian {
            Meridian::Line { radius, slope } => {
                let (size, way) = out(by - direction * height)?;
                Some((size - radius - slope * height, way - direction * slope))
            }
            Meridian::Circle { big, small } => {
                let from = match big.re() == 0.0 {
                    true => by,
                    false => by - out(by - direction * height)?.1 * big,
                };
                let (size, way) = out(from)?;
                Some((size - small, way))
            }
        }
    }

    /// The direction to a point from the axis, or from the centre of the section by a plane
    /// through it.
    pub(super) fn away(&self, p: Vec3) -> Vec3 {
        let (at, d) = (self.axis.point.re(), self.axis.direction.re());
        let by = p - at;
        let flat = by - d * d.dot(by);
        match self.meridian.re() {
            Meridian::Line { .. } => flat,
            Meridian::Circle { big, .. } => {
                by - flat.normalized().map_or(Vec3::zero(), |out| out * big)
            }
        }
    }
}

/// True if a length is zero relative to a size, with its derivatives.
pub(super) fn vanishes<T: Real>(x: T, size: f64) -> bool {
    x.re().abs() <= ALIKE * size && (1..T::PARTS).all(|k| !moves(x.part(k), 1.0))
}

pub(super) fn all_vanish<T: Real>(v: Vec3<T>, size: f64) -> bool {
    v.to_array().into_iter().all(|x| vanishes(x, size))
}

/// True if a curve from `a` to its conjugate `b` is a circle.
pub(super) fn round<T: Real>(a: Vec3<T>, b: Vec3<T>) -> bool {
    let size = a.norm();
    size.re() > 0.0 && vanishes(size - b.norm(), size.re()) && vanishes(a.dot(b) / size, size.re())
}

/// The axis of a cone or cylinder between circles.
pub(super) fn straight_axis<T: Real>(
    near: &SmoothPiece<T>,
    far: &SmoothPiece<T>,
) -> Option<Axis<T>> {
    let SmoothPiece::Conic { centre, a, b, sweep } = *near else { return None };
    let size = a.re().norm();
    let direction = a.cross(b).normalized()?;
    let other = match *far {
        SmoothPiece::Conic { centre: c, a: p, b: q, sweep: s } => {
            let long = p.re().norm();
            let turned = all_vanish(a.cross(p) / T::from(size), long)
                && all_vanish(b.cross(q) / T::from(size), long);
            (turned && round(p, q) && vanishes(sweep - s, 1.0)).then_some(c)?
        }
        SmoothPiece::Cubic([p, q, r, e]) => {
            let point = [q, r, e].into_iter().all(|x| all_vanish(x - p, size));
            point.then_some(p)?
        }
    };
    let across = (other - centre).cross(direction);
    let reach = size + (other - centre).re().norm();
    (round(a, b) && all_vanish(across, reach)).then_some(Axis { point: centre, direction })
}

/// True if a curve from `a` to its conjugate `b` is a circle, apart from derivatives.
pub(super) fn is_circle(a: Vec3, b: Vec3) -> bool {
    let size = a.norm_sq();
    (size - b.norm_sq()).abs().max(a.dot(b).abs()) <= ALIKE * size
}

/// The share of an angle in a sweep, by whole turns nearest to another one.
pub(super) fn arc_share(angle: f64, sweep: f64, near: f64) -> f64 {
    let (share, turn) = (angle / sweep, TAU / sweep);
    share + turn * ((near - share) / turn).round()
}

/// The parameters of the point of a patch of a surface of revolution that is nearest to `p`, by
/// whole turns nearest to `near`; `None` for another surface.
pub(super) fn patch_parameters<T: Real>(
    surface: &FaceSurface<T>,
    p: Vec3,
    near: [f64; 2],
) -> Option<[f64; 2]> {
    let round = RevolvedSurface::of(surface)?;
    let (point, direction) = (round.axis.point.re(), round.axis.direction.re());
    let by = p - point;
    let height = direction.dot(by);
    let arm = by - direction * height;
    match *surface {
        FaceSurface::Plane { .. } => None,
        FaceSurface::Ruled { near: arc, far } => {
            let SmoothPiece::Conic { a, b, sweep, .. } = arc else { return None };
            let Meridian::Line { radius, slope } = round.meridian.re() else { return None };
            let end = match far {
                SmoothPiece::Conic { centre, .. } => centre,
                SmoothPiece::Cubic([p, ..]) => p,
            };
            let long = direction.dot(end.re() - point);
            let angle = libm::atan2(arm.dot(b.re()), arm.dot(a.re()));
            let along = (height + slope * (arm.norm() - radius)) / (1.0 + slope * slope);
            Some([arc_share(angle, sweep.re(), near[0]), along / long])
        }
        FaceSurface::Turned { profile, sweep, .. } => {
            let SmoothPiece::Conic { centre, a, b, sweep: own } = profile else { return None };
            // The half plane that is turned.
            let middle = profile.at(T::from(0.5)).re() - point;
            let out = (middle - direction * direction.dot(middle)).normalized()?;
            let angle = libm::atan2(direction.dot(out.cross(arm)), out.dot(arm));
            let flat = point + out * arm.norm() + direction * height - centre.re();
            let turn = libm::atan2(flat.dot(b.re()), flat.dot(a.re()));
            // At a pole every angle is the same point.
            let pole = arm.norm() <= ALIKE * a.re().norm();
            let u = if pole { near[0] } else { arc_share(angle, sweep.re(), near[0]) };
            Some([u, arc_share(turn, own.re(), near[1])])
        }
    }
}

/// The parameter u in which a direction leaves a pole of a turned surface, by whole turns nearest
/// to `near`; `None` along the axis.
pub(super) fn turn_about_axis<T: Real>(
    surface: &FaceSurface<T>,
    way: Vec3<T>,
    near: f64,
) -> Option<T> {
    let FaceSurface::Turned { centre, axis, profile, sweep } = surface else { return None };
    let middle = profile.at(T::from(0.5)) - *centre;
    let out = (middle - *axis * axis.dot(middle)).normalized()?;
    let (x, y) = (out.dot(way), axis.dot(out.cross(way)));
    if x.re() == 0.0 && y.re() == 0.0 {
        return None;
    }
    let angle = y.atan2(x);
    let share = angle.re() / sweep.re();
    Some(angle / *sweep + (arc_share(angle.re(), sweep.re(), near) - share))
}
