//! The inside of a closed plane curve: as a prism without ends, and turned about a line of its plane.
//!
//! The distance of a point's image in the plane of the curve, signed by whether it is inside. Moving a point moves its image
//! by no more, so that ranges follow from one value.

use super::polygon::{SideFormula, sides_of};
use super::{Shown, lipschitz};
use crate::expr::interval::Interval;
use crate::expr::oracle::Oracle;
use crate::{FieldError, Primitive, Set};
use moldloft_locate::{NearestCurve, PlainCurve};
use moldloft_num::period::corner_rate;
use moldloft_num::{Axis, Box3, Curve, Field, Order, Real, Vec3};
use moldloft_registry::CurveRef;
use std::sync::Arc;

/// Why a curve bounds no part of a plane, with the measure of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotAProfile {
    /// Distance of its ends.
    Open(f64),
    /// Distance by which it leaves its plane.
    Bent(f64),
    /// It has no extent in two directions.
    Flat,
    /// Distance from the plane of the axis, or from the axis on the other side.
    Beside(f64),
}

/// Samples of a span of the curve.
const SAMPLES: usize = 96;
/// Relative distance within which points coincide or are in one plane.
const SAME: f64 = 1e-9;

/// The most corners of a curve whose sides are faces of their own.
const MOST_CORNERS: usize = 400;

/// Projection of a point into the plane of the curve.
#[derive(Clone, Copy)]
enum ProfileMap<T: Real> {
    Along,
    /// Rotation about the line into the half plane with the second direction.
    About(Axis<T>, Vec3<T>),
}

/// The signed distance, in its plane, from a closed plane curve.
pub struct ProfileField<T: Real> {
    curve: CurveRef<T>,
    nearest: Arc<NearestCurve>,
    outline: Arc<ProfileOutline>,
    /// A point of the plane and its normal.
    plane: [Vec3<T>; 2],
    map: ProfileMap<T>,
}

/// The curve as a polygon in two coordinates of its plane.
struct ProfileOutline {
    origin: Vec3,
    across: [Vec3; 2],
    points: Vec<[f64; 2]>,
    /// Nearer to the curve than this the polygon does not tell sides.
    close: f64,
    /// Parameters of possible corners.
    breaks: Vec<f64>,
    corners: Vec<Vec3>,
}

impl ProfileOutline {
    fn at(&self, p: Vec3) -> [f64; 2] {
        self.across.map(|a| (p - self.origin).dot(a))
    }

    /// True if a point is inside, by the crossings of a ray (even-odd rule).
    fn inside(&self, p: Vec3) -> bool {
        let [x, y] = self.at(p);
        let n = self.points.len();
        let crosses = |k: &usize| {
            let ([a, b], [c, d]) = (self.points[*k], self.points[(*k + 1) % n]);
            (b > y) != (d > y) && x < a + (y - b) / (d - b) * (c - a)
        };
        (0..n).filter(crosses).count() % 2 == 1
    }
}

impl<T: Real> ProfileField<T> {
    /// The prism without ends over a closed plane curve.
    ///
    /// # Errors
    /// Reason why it is not a profile.
    pub fn new(curve: CurveRef<T>) -> Result<Self, NotAProfile> {
        let spans: Vec<f64> = {
            let mut all = PlainCurve(&*curve).breaks();
            all.extend([0.0, 1.0]);
            all.retain(|t| (0.0..=1.0).contains(t));
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let inner = |w: &[f64]| {
            let [a, b] = [w[0], w[1]];
            (0..SAMPLES).map(move |k| a + (b - a) * k as f64 / SAMPLES as f64).collect::<Vec<_>>()
        };
        let places: Vec<f64> = spans.windows(2).flat_map(inner).collect();
        let at = |t: f64| curve.jet(T::from(t), Order::Zero)[0];
        let points: Vec<Vec3> = places.iter().map(|t| at(*t).re()).collect();
        let size = Box3::around(points.iter().copied()).diagonal();
        let gap = at(0.0).re().distance(at(1.0).re());
        if gap > SAME * size {
            return Err(NotAProfile::Open(gap));
        }
        // The area vector of the polygon is normal to the plane.
        let n = points.len();
        let area = (0..n).fold(Vec3::zero(), |sum, k| {
            sum + (points[k] - points[0]).cross(points[(k + 1) % n] - points[0])
        });
        let normal = area.normalized().filter(|_| area.norm() > SAME * size * size);
        let Some(normal) = normal else { return Err(NotAProfile::Flat) };
        let bent = points.iter().map(|p| (*p - points[0]).dot(normal).abs()).fold(0.0, f64::max);
        if bent > SAME * size {
            return Err(NotAProfile::Bent(bent));
        }
        let across = normal.perpendicular();
        let across = across.normalized().unwrap_or(across);
        let across = [across, normal.cross(across)];
        let sag = |w: &[f64]| {
            let [p, q] = [at(w[0]).re(), at(w[1]).re()];
            at(0.5 * (w[0] + w[1])).re().distance((p + q) * 0.5)
        };
        let close = places.windows(2).map(sag).fold(0.0, f64::max).max(SAME * size);
        let mut outline = ProfileOutline {
            origin: points[0],
            across,
            points: Vec::new(),
            close: 4.0 * close,
            corners: corners_of(&curve, &spans),
            breaks: spans,
        };
        outline.points = points.iter().map(|p| outline.at(*p)).collect();
        // The normal follows the derivatives of three points that are far apart.
        let third = |k: usize| at(places[k * n / 3]);
        let found = (third(1) - third(0)).cross(third(2) - third(0));
        let plane = match found.normalized().filter(|_| found.re().norm() > 1e-3 * area.norm()) {
            Some(m) if m.re().dot(normal) < 0.0 => [third(0), -m],
            Some(m) => [third(0), m],
            None => [third(0), Vec3::lifted(normal)],
        };
        let nearest = Arc::new(NearestCurve::new(&PlainCurve(&*curve)));
        Ok(Self { curve, nearest, outline: Arc::new(outline), plane, map: ProfileMap::Along })
    }

    /// The body that a closed plane curve passes over in a full turn about a line of its plane.
    ///
    /// # Errors
    /// Reason why it is not a profile.
    pub fn turned(curve: CurveRef<T>, axis: Axis<T>) -> Result<Self, NotAProfile> {
        let mut own = Self::new(curve)?;
        let along = axis.direction.normalized().ok_or(NotAProfile::Flat)?;
        let out = own.plane[1].cross(along);
        let out = out.normalized().ok_or(NotAProfile::Flat)?;
        let [u, v] = own.outline.across;
        let space = |p: &[f64; 2]| own.outline.origin + u * p[0] + v * p[1];
        let (point, normal) = (axis.point.re(), own.plane[1].re());
        let points: Vec<Vec3> = own.outline.points.iter().map(space).collect();
        let size = Box3::around(points.iter().copied()).diagonal();
        let aside = (points[0] - point).dot(normal).abs().max(size * along.re().dot(normal).abs());
        if aside > 1e-7 * size {
            return Err(NotAProfile::Beside(aside));
        }
        let radii: Vec<f64> = points.iter().map(|p| (*p - point).dot(out.re())).collect();
        let (least, most) = radii.iter().fold((0.0f64, 0.0f64), |(a, b), r| (a.min(*r), b.max(*r)));
        if least.min(-SAME * size).abs() > SAME * size && most > SAME * size {
            return Err(NotAProfile::Beside((-least).min(most)));
        }
        let out = if most > -least { out } else { -out };
        own.map = ProfileMap::About(Axis { point: axis.point, direction: along }, out);
        Ok(own)
    }

    /// A point of the plane of the curve, and its normal; the curve runs counter-clockwise about it.
    pub fn plane(&self) -> [Vec3<T>; 2] {
        self.plane
    }

    /// Largest distance of another curve from the plane of this one, relative to the extent of both.
    pub fn off(&self, other: &Self) -> f64 {
        let outline = &other.outline;
        let [u, v] = outline.across;
        let places = outline.points.iter().map(|[x, y]| outline.origin + u * *x + v * *y);
        let own = &self.outline;
        let normal = own.across[0].cross(own.across[1]);
        let far = places.map(|p| ((p - own.origin).dot(normal).abs(), p.distance(own.origin)));
        let (off, size) = far.fold((0.0f64, 0.0f64), |(a, b), (d, e)| (a.max(d), b.max(e)));
        off / size
    }

    /// True if another curve of the plane is inside.
    pub fn encloses(&self, other: &Self) -> bool {
        let outline = &other.outline;
        let [[x, y], [u, v]] = [outline.points[0], outline.points[1]];
        let middle = [0.5 * (x + u), 0.5 * (y + v)];
        let [a, b] = outline.across;
        self.outline.inside(outline.origin + a * middle[0] + b * middle[1])
    }

    /// The body as a set: where the curve is a polygon each side is a face of its own, a plane or a part of a
    /// cylinder or cone, so that the corners are edges; another curve is one face, and its corners are blunt in meshes.
    ///
    /// # Errors
    /// Errors of the faces.
    pub fn into_set(self) -> Result<Set<T>, FieldError> {
        let formula = self.corners().and_then(|corners| {
            let flat: Vec<[f64; 2]> = corners.iter().map(|p| self.outline.at(p.re())).collect();
            Some((sides_of(&flat)?, corners))
        });
        match formula {
            Some((formula, corners)) => self.behind(&formula, &corners),
            None => Ok(Set::new(&Primitive::user(Arc::new(self)))),
        }
    }

    /// The corners of a polygon, in order, with their derivatives.
    fn corners(&self) -> Option<Vec<Vec3<T>>> {
        let outline = &self.outline;
        let spans = outline.breaks.len() - 1;
        if !(3..=MOST_CORNERS).contains(&spans) {
            return None;
        }
        let size =
            Box3::around(outline.points.iter().map(|[x, y]| Vec3::of(*x, *y, 0.0))).diagonal();
        let straight = outline.points.chunks(SAMPLES).enumerate().all(|(k, own)| {
            let ([a, b], [c, d]) = (own[0], outline.points[(k + 1) % spans * SAMPLES]);
            let [u, v] = [c - a, d - b];
            let length = (u * u + v * v).sqrt();
            let off = |[x, y]: &[f64; 2]| (u * (y - b) - v * (x - a)).abs();
            length > SAME * size && own.iter().all(|p| off(p) <= SAME * size * length)
        });
        if !straight {
            return None;
        }
        let corner = |&t: &f64| {
            let moved = match t > 0.0 {
                true => corner_rate(&self.curve, t, 1e-7).unwrap_or_else(T::zero),
                false => T::zero(),
            };
            self.curve.jet(moved + T::from(t), Order::Zero)[0]
        };
        let mut corners: Vec<Vec3<T>> = outline.breaks[..spans].iter().map(corner).collect();
        // A corner between two collinear sides is left out, unless it may leave the line.
        let mut k = 0;
        while k < corners.len() && corners.len() > 3 {
            let n = corners.len();
            let [a, b, c] = [corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]];
            let turn = (b - a).cross(c - b);
            if turn.re().norm() > 1e-12 * (b - a).re().norm() * (c - b).re().norm() {
                k += 1;
            } else if turn.to_array().iter().all(|x| x.is_constant()) {
                corners.remove(k);
            } else {
                return None;
            }
        }
        Some(corners)
    }

    /// The set on the inner side of the sides of a formula.
    fn behind(&self, of: &SideFormula, corners: &[Vec3<T>]) -> Result<Set<T>, FieldError> {
        let each = |all: &[SideFormula]| {
            all.iter().map(|f| self.behind(f, corners)).collect::<Result<Vec<_>, _>>()
        };
        Ok(match of {
            SideFormula::All(all) => Set::intersection_of(each(all)?),
            SideFormula::Any(all) => Set::union_of(each(all)?),
            SideFormula::Side(k) => {
                let [p, q] = [corners[*k], corners[(k + 1) % corners.len()]];
                match &self.map {
                    ProfileMap::Along => {
                        Set::new(&Primitive::plane((q - p).cross(self.plane[1]), p)?)
                    }
                    ProfileMap::About(axis, out) => {
                        turned_side(*axis, *out, self.plane[1], [p, q])?
                    }
                }
            }
        })
    }

    /// The image of a point in the plane, and how a direction there is one in space.
    fn image(&self, p: Vec3<T>) -> (Vec3<T>, Vec3<T>, Vec3<T>) {
        match &self.map {
            ProfileMap::Along => {
                let [q, n] = self.plane;
                (p - n * (p - q).dot(n), Vec3::zero(), Vec3::zero())
            }
            ProfileMap::About(axis, out) => {
                let away = p - axis.point;
                let s = away.dot(axis.direction);
                let flat = away - axis.direction * s;
                let r = flat.norm();
                let radial = match r.re() > 0.0 {
                    true => flat / r,
                    false => *out,
                };
                (axis.point + axis.direction * s + *out * r, radial, *out)
            }
        }
    }

    /// The outward normal of the curve in its plane.
    fn normal(&self, t: f64) -> Option<Vec3<T>> {
        let d = self.curve.jet(T::from(t), Order::First)[1];
        d.cross(self.plane[1]).normalized()
    }
}

/// The region behind a side in the half plane of an axis, rotated about it.
fn turned_side<T: Real>(
    axis: Axis<T>,
    out: Vec3<T>,
    normal: Vec3<T>,
    [p, q]: [Vec3<T>; 2],
) -> Result<Set<T>, FieldError> {
    let outward = (q - p).cross(normal);
    let [across, along] = [outward.dot(out), outward.dot(axis.direction)];
    let [first, last] = [p, q].map(|p| (p - axis.point).dot(out));
    let size = outward.re().norm();
    if first.re().abs().max(last.re().abs()) <= SAME * size {
        // A side on the axis bounds nothing.
        return Ok(Set::everything());
    }
    let still = |x: T| x.re().abs() <= 1e-12 * size && x.is_constant();
    if still(across) {
        let up = if along.re() > 0.0 { axis.direction } else { -axis.direction };
        return Ok(Set::new(&Primitive::plane(up, p)?));
    }
    if still(along) {
        let inside = Set::new(&Primitive::cylinder(axis, first)?);
        return Ok(if across.re() > 0.0 { inside } else { inside.complement() });
    }
    if across.re().abs().min(along.re().abs()) <= 1e-9 * size {
        // Flat or upright now, and a cone after a change.
        let e = axis.direction.perpendicular();
        let e = e / e.norm();
        let [x, y] = [e, axis.direction.cross(e)].map(|n| Primitive::linear(n, -n.dot(axis.point)));
        let away = (x.power(2) + y.power(2)).sqrt() - first;
        let up = Primitive::linear(axis.direction, -axis.direction.dot(p));
        return Ok(Set::new(&(away * across + up * along)));
    }
    // The half of a double cone on one side of its apex.
    let slope = across / along;
    let apex = axis.point + axis.direction * ((p - axis.point).dot(axis.direction) + slope * first);
    let ratio = (T::one() / slope).abs();
    let angle = ratio.atan2(T::one()) * 2.0;
    let cone = Set::new(&Primitive::cone(Axis { point: apex, direction: axis.direction }, angle)?);
    let up = if along.re() > 0.0 { axis.direction } else { -axis.direction };
    let below = Set::new(&Primitive::plane(up, apex)?);
    Ok(match across.re() > 0.0 {
        true => cone & below,
        false => cone.complement() | below,
    })
}

impl<T: Real> Field<T> for ProfileField<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let (image, radial, out) = self.image(p);
        let t = self.nearest.nearest(&PlainCurve(&*self.curve), image.re()).at[0];
        let away = image - self.curve.jet(T::from(t), Order::Zero)[0];
        let size = away.norm();
        let far = size.re();
        // At a corner the mean of the normals beside it tells the side.
        let corner = self.outline.breaks.iter().find(|b| (*b - t).abs() < 1e-7);
        let beside = |by: f64| {
            let at = t + by;
            let at = if at < 0.0 {
                at + 1.0
            } else if at > 1.0 {
                at - 1.0
            } else {
                at
            };
            self.normal(at)
        };
        let facing = match corner {
            None => self.normal(t).unwrap_or_else(Vec3::zero),
            Some(_) => {
                let [a, b] = [-1e-6, 1e-6].map(|by| beside(by).unwrap_or_else(Vec3::zero));
                a + b
            }
        };
        let inside = match far > self.outline.close {
            true => self.outline.inside(image.re()),
            false => away.re().dot(facing.re()) < 0.0,
        };
        let (value, slope) = if far > SAME * self.outline.close {
            let signed = if inside { -size } else { size };
            (signed, away / signed)
        } else {
            let n = facing.normalized().unwrap_or_else(Vec3::zero);
            (away.dot(n), n)
        };
        match &self.map {
            ProfileMap::Along => (value, slope),
            ProfileMap::About(axis, _) => {
                let along = axis.direction * slope.dot(axis.direction);
                (value, along + radial * slope.dot(out))
            }
        }
    }

    moldloft_num::field_facts!(T: value_with_gradient, second_by_differences, no_bounds);
}

/// Corners of the tangent of a closed curve, at breaks from 0 to 1.
fn corners_of<T: Real>(curve: &CurveRef<T>, breaks: &[f64]) -> Vec<Vec3> {
    const ASIDE: f64 = 1e-9;
    let jet = |t: f64| curve.jet(T::from(t), Order::First);
    let turns = |&&t: &&f64| {
        let before = if t == 0.0 { 1.0 } else { t - ASIDE };
        let [a, b] = [before, t + if t == 0.0 { 0.0 } else { ASIDE }].map(|t| jet(t)[1].re());
        a.cross(b).norm() > 1e-5 * a.norm() * b.norm() || a.dot(b) <= 0.0
    };
    breaks[..breaks.len() - 1].iter().filter(turns).map(|t| jet(*t)[0].re()).collect()
}

impl<T: Real> Oracle<T> for ProfileField<T> {
    fn creased_in(&self, over: &Box3) -> bool {
        let (at, reach) = (self.image(Vec3::lifted(over.centre())).0.re(), 0.5 * over.diagonal());
        self.outline.corners.iter().any(|c| c.distance(at) <= reach)
    }
    fn range(&self, over: &Box3) -> Interval {
        lipschitz(Field::value(self, Vec3::lifted(over.centre())).re(), over)
    }
    fn gradient_range(&self, _: &Box3) -> [Interval; 3] {
        [Interval { low: -1.0, high: 1.0 }; 3]
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        let map = match &self.map {
            ProfileMap::Along => ProfileMap::Along,
            ProfileMap::About(axis, out) => ProfileMap::About(
                Axis { point: axis.point.re(), direction: axis.direction.re() },
                out.re(),
            ),
        };
        Arc::new(ProfileField {
            curve: CurveRef::new(Shown(self.curve.clone()), 0),
            nearest: self.nearest.clone(),
            outline: self.outline.clone(),
            plane: self.plane.map(|v| v.re()),
            map,
        })
    }
}
