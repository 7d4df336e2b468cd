//! Hulls of discs across one axis, and of rings about it.
//!
//! Two discs in parallel planes span an oblique cone. The hull of several is the union of the polyhedron between the
//! points where its planes touch, and of a piece of a cone for each pair that a plane can roll about: the section at any
//! height is the hull of the sections of these pieces. A hull about one axis is an outline of lines and arcs, turned.

use super::hull::{
    HullBall, MOST_BALLS, Prism, SAME, half_space, has_free_angle, outermost, polyhedron, size,
};
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Axis, Real, Vec3};

/// Sines and slopes below this are zero.
const FLAT: f64 = 1e-12;

/// A circle about an axis at a height, as the centres of balls of radius `tube`.
pub(super) struct CoaxialRing<T> {
    pub(super) height: T,
    pub(super) radius: T,
    pub(super) tube: T,
}

fn no_volume<R>() -> Result<R, FieldError> {
    Err(FieldError::Degenerate { what: "hull: it has no volume; it" })
}

/// The inside of a cylinder or of one nappe of a cone about an axis: of this radius at the axis's
/// point, which grows by `slope`.
fn round_side<T: Real>(axis: Axis<T>, radius: T, slope: T) -> Result<Set<T>, FieldError> {
    if slope.re().abs() > FLAT {
        let apex = axis.point - axis.direction * (radius / slope);
        let (steep, up) = if slope.re() > 0.0 { (slope, -1.0) } else { (-slope, 1.0) };
        let cone = Primitive::cone(Axis { point: apex, ..axis }, steep.atan() * 2.0)?;
        return Ok(Set::new(&cone) & half_space(axis.direction * T::from(up), apex)?);
    }
    if slope.is_constant() {
        return Ok(Set::new(&Primitive::cylinder(axis, radius)?));
    }
    // A cylinder that is about to become a cone.
    let p = axis.direction.perpendicular();
    let [x, y, s] = [p, axis.direction.cross(p), axis.direction]
        .map(|n| Primitive::linear(n, -n.dot(axis.point)));
    Ok(Set::new(&(x.power(2) + y.power(2) - (s * slope + radius).power(2))))
}

/// The hull of rings about an axis with a unit direction.
pub(super) fn of_rings<T: Real>(
    axis: Axis<T>,
    rings: &[CoaxialRing<T>],
) -> Result<Set<T>, FieldError> {
    let up = axis.direction;
    let out = crate::error::unit("axis", up.perpendicular())?;
    // The outline in a plane through the axis, with its mirror image.
    let circles = rings.iter().flat_map(|ring| {
        [1.0, -1.0].map(|sign| HullBall {
            centre: axis.point + up * ring.height + out * (ring.radius * sign),
            radius: ring.tube,
        })
    });
    let discs = outermost(&circles.collect::<Vec<_>>());
    let slack = SAME * size(&discs.iter().map(HullBall::re).collect::<Vec<_>>());
    let outline = Prism { axis: up.cross(out), ends: [axis.point; 2], discs };
    // A line of the outline turned about the axis; the mirror image is left out.
    let turned = |normal: Vec3<T>, at: Vec3<T>| -> Result<Set<T>, FieldError> {
        let (across, along) = (normal.dot(out), normal.dot(up));
        if across.re() < -FLAT {
            return Ok(Set::everything());
        }
        if across.re() <= FLAT {
            return half_space(up * T::from(along.re().signum()), at);
        }
        let at = at - axis.point;
        let (slope, height) = (-along / across, up.dot(at));
        let foot = Axis { point: axis.point + up * height, direction: up };
        round_side(foot, out.dot(at), slope)
    };
    let sides = outline.sides();
    let mut core = Set::everything();
    for side in &sides {
        let touch = outline.discs[side.discs[0]].touch(side.normal);
        core = core & turned(side.normal, touch)?;
    }
    let mut round = Set::nothing();
    for (k, disc) in outline.discs.iter().enumerate().filter(|(_, d)| d.radius.re() > slack) {
        let from = sides.iter().find(|s| s.discs[1] == k).map(|s| disc.touch(s.normal).re());
        let to = sides.iter().find(|s| s.discs[0] == k).map(|s| disc.touch(s.normal).re());
        let Some((from, to)) = from.zip(to) else { continue };
        if from.distance(to) <= slack {
            continue;
        }
        // The chord under the arc.
        let chord = (to - from).cross(outline.axis.re()).normalized().unwrap_or_default();
        core = core & turned(Vec3::lifted(chord), Vec3::lifted(from))?;
        let (radius, height) =
            (out.dot(disc.centre - axis.point), up.dot(disc.centre - axis.point));
        if radius.re() < -slack {
            continue;
        }
        let centre = axis.point + up * height;
        round = round
            | Set::new(&match radius.re() > slack {
                true => {
                    Primitive::torus(Axis { point: centre, direction: up }, radius, disc.radius)?
                }
                false => Primitive::sphere(centre, disc.radius)?,
            });
    }
    if sides.len() < 3 && round.is_nothing() { no_volume() } else { Ok(core | round) }
}

/// Discs across one axis.
struct ParallelDiscs<'a, T> {
    /// Two directions across the axis, and its own.
    axes: [Vec3<T>; 3],
    discs: &'a [HullBall<T>],
}

/// The normals (cos, sin, slope) of planes that touch three discs from one side, given by their
/// centres (x, y, height) and radii.
fn touching<T: Real>([a, b, c]: [HullBall<T>; 3]) -> [Option<Vec3<T>>; 2] {
    let (p, q) = (b.centre - a.centre, c.centre - a.centre);
    let (u, v) = (a.radius - b.radius, a.radius - c.radius);
    let across = p.cross(q);
    let area_sq = across.norm_sq();
    let (pp, pq, qq) = (p.norm_sq(), p.dot(q), q.norm_sq());
    let lift = across.x * across.x + across.y * across.y;
    if area_sq.re() <= 1e-24 * pp.re() * qq.re() || lift.re() <= 1e-20 * area_sq.re() {
        return [None, None];
    }
    // n = x p + y q + t p x q with n.p = u, n.q = v, and a horizontal part of length 1.
    let (x, y) = ((u * qq - v * pq) / area_sq, (v * pp - u * pq) / area_sq);
    let within = p * x + q * y;
    let half = within.x * across.x + within.y * across.y;
    let rest = half * half - lift * (within.x * within.x + within.y * within.y - T::one());
    if rest.re() < 0.0 {
        return [None, None];
    }
    let root = rest.sqrt();
    [root, -root].map(|root| Some(within + across * ((root - half) / lift)))
}

impl<T: Real> ParallelDiscs<'_, T> {
    /// The centre as (x, y, height) from the first one's, and the radius.
    fn local(&self, k: usize) -> HullBall<T> {
        let (disc, origin) = (&self.discs[k], self.discs[0].centre);
        let [x, y, h] = self.axes.map(|a| a.dot(disc.centre - origin));
        HullBall { centre: Vec3::new(x, y, h), radius: disc.radius }
    }

    /// The unit normal of a local one, and the point where it touches a disc.
    fn touch(&self, normal: Vec3<T>, k: usize) -> Option<(Vec3<T>, Vec3<T>)> {
        let [x, y, h] = self.axes;
        let outward = x * normal.x + y * normal.y;
        let disc = &self.discs[k];
        Some(((outward + h * normal.z).normalized()?, disc.centre + outward * disc.radius))
    }

    /// True when a plane can roll about two discs with all others behind, through an angle.
    fn is_edge(&self, plain: &[HullBall<f64>], i: usize, j: usize, slack: f64) -> bool {
        let along = plain[j].centre - plain[i].centre;
        let mut bounds: Vec<[f64; 3]> = Vec::new();
        for (_, disc) in plain.iter().enumerate().filter(|(m, _)| *m != i && *m != j) {
            let to = disc.centre - plain[i].centre;
            let s = to.z / along.z;
            let aside = to - along * s;
            let here = plain[i].radius + s * (plain[j].radius - plain[i].radius);
            let most = here - disc.radius;
            if libm::hypot(aside.x, aside.y) <= slack {
                // On the cone: the two neighbours have the edge.
                if most < -slack || most <= slack && s > 0.0 && s < 1.0 {
                    return false;
                }
                continue;
            }
            bounds.push([aside.x, aside.y, most]);
        }
        has_free_angle(&bounds, slack)
    }

    /// The piece of an oblique cone or cylinder between two discs at different heights.
    fn piece(&self, low: &HullBall<T>, high: &HullBall<T>) -> Result<Set<T>, FieldError> {
        let [e, f, up] = self.axes;
        let rise = up.dot(high.centre - low.centre);
        let shift = [e, f].map(|a| a.dot(high.centre - low.centre));
        let grow = high.radius - low.radius;
        let upright = |x: &T| x.is_constant() && x.re().abs() <= FLAT * rise.re();
        let side = if shift.iter().all(upright) {
            round_side(Axis { point: low.centre, direction: up }, low.radius, grow / rise)?
        } else {
            let share = Primitive::linear(up / rise, -up.dot(low.centre) / rise);
            let [x, y] = [(e, shift[0]), (f, shift[1])]
                .map(|(a, by)| Primitive::linear(a, -a.dot(low.centre)) - share.clone() * by);
            let radius = share * grow + low.radius;
            Set::new(&(x.power(2) + y.power(2) - radius.power(2)))
        };
        Ok(side & half_space(-up, low.centre)? & half_space(up, high.centre)?)
    }
}

/// The hull of discs across an axis with a unit direction; of radius 0, points.
pub(super) fn of_discs<T: Real>(up: Vec3<T>, discs: &[HullBall<T>]) -> Result<Set<T>, FieldError> {
    if discs.len() > MOST_BALLS {
        return Err(FieldError::ManyFaces { most: MOST_BALLS });
    }
    let across = crate::error::unit("axis", up.perpendicular())?;
    let all = ParallelDiscs { axes: [across, up.cross(across), up], discs };
    let exact: Vec<HullBall<T>> = (0..discs.len()).map(|k| all.local(k)).collect();
    let plain: Vec<HullBall<f64>> = exact.iter().map(HullBall::re).collect();
    let slack = SAME * size(&plain);
    let count = plain.len();
    let mut points: Vec<Vec3> = discs.iter().map(|d| d.centre.re()).collect();
    let mut visible: Vec<(Vec3<T>, Vec3<T>)> = Vec::new();
    for (sign, disc) in [(-1.0, false), (1.0, true)].map(|(sign, top)| {
        let by = |a: &&usize, b: &&usize| plain[**a].centre.z.total_cmp(&plain[**b].centre.z);
        let order: Vec<usize> = (0..count).collect();
        let end = if top { order.iter().max_by(by) } else { order.iter().min_by(by) };
        (sign, end.copied().unwrap_or(0))
    }) {
        visible.push((up * T::from(sign), discs[disc].centre));
    }
    let over = |normal: Vec3, k: usize| normal.dot(plain[k].centre) + plain[k].radius;
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                let three = [i, j, k];
                for (way, normal) in touching(three.map(|m| plain[m])).into_iter().enumerate() {
                    let Some(normal) = normal else { continue };
                    let slack = slack * (1.0 + normal.z.abs());
                    let top = over(normal, i);
                    if (0..count).any(|m| over(normal, m) > top + slack) {
                        continue;
                    }
                    for m in (0..count).filter(|&m| over(normal, m) >= top - slack) {
                        let d = &plain[m];
                        let at = all.touch(Vec3::lifted(normal), m).map(|t| t.1.re());
                        points.extend(at.filter(|p| {
                            d.radius > slack && points.iter().all(|q| q.distance(*p) > slack)
                        }));
                    }
                    let found = touching(three.map(|m| exact[m]))[way];
                    visible.extend(found.and_then(|n| all.touch(n, i)));
                }
            }
        }
    }
    let mut hull = polyhedron(&points, &visible)?.unwrap_or_else(Set::nothing);
    for i in 0..count {
        for j in 0..count {
            let rises = plain[j].centre.z - plain[i].centre.z > slack;
            let round = plain[i].radius.max(plain[j].radius) > slack;
            if rises && round && all.is_edge(&plain, i, j, slack) {
                hull = hull | all.piece(&discs[i], &discs[j])?;
            }
        }
    }
    if hull.is_nothing() { no_volume() } else { Ok(hull) }
}
