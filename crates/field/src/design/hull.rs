//! Hulls of balls, and of discs of one axis, as sets of planes, balls, cylinders, cones and tori.
//!
//! The hull of balls is the union of the polyhedron between the points where its planes touch, of a piece of a cone
//! about each pair of balls that a plane can roll about, and of the balls (Boissonnat and Karavelas 2003). All pieces touch
//! along their rims, so that the surface has a tangent plane everywhere but at balls of radius 0.

use crate::{FieldError, Primitive, Set};
use moldloft_num::{Axis, Real, Vec3};

/// Balls that one hull may be spanned by.
pub(super) const MOST_BALLS: usize = 400;

/// Directions and points that differ by less than this, relative to the size, count as one.
pub(super) const SAME: f64 = 1e-10;

/// A ball; of radius 0, a point. In a plane, a disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct HullBall<T> {
    pub(super) centre: Vec3<T>,
    pub(super) radius: T,
}

impl<T: Real> HullBall<T> {
    pub(super) fn re(&self) -> HullBall<f64> {
        HullBall { centre: self.centre.re(), radius: self.radius.re() }
    }

    pub(super) fn touch(&self, normal: Vec3<T>) -> Vec3<T> {
        self.centre + normal * self.radius
    }
}

/// Balls that are not inside another.
pub(super) fn outermost<T: Real>(balls: &[HullBall<T>]) -> Vec<HullBall<T>> {
    let plain: Vec<HullBall<f64>> = balls.iter().map(HullBall::re).collect();
    let slack = SAME * size(&plain);
    let hidden = |i: usize| {
        let inside = |j: usize| {
            let apart = plain[i].centre.distance(plain[j].centre) + plain[i].radius;
            // The first of equal ones is kept.
            let equal = (plain[i].radius - plain[j].radius).abs() <= slack;
            j != i && apart <= plain[j].radius + slack && (j < i || !equal)
        };
        (0..plain.len()).any(inside)
    };
    (0..balls.len()).filter(|&i| !hidden(i)).map(|i| balls[i]).collect()
}

pub(super) fn size(balls: &[HullBall<f64>]) -> f64 {
    let Some(first) = balls.first() else { return 0.0 };
    balls.iter().map(|b| b.centre.distance(first.centre) + b.radius).fold(first.radius, f64::max)
}

pub(super) fn half_space<T: Real>(normal: Vec3<T>, point: Vec3<T>) -> Result<Set<T>, FieldError> {
    Ok(Set::new(&Primitive::plane(normal, point)?))
}

/// A plane that all balls are behind, and those that touch it.
struct TangentPlane {
    normal: Vec3,
    members: Vec<usize>,
}

/// The unit normals of the planes that touch three balls from one side.
fn touching<T: Real>([a, b, c]: [HullBall<T>; 3]) -> [Option<Vec3<T>>; 2] {
    let (p, q) = (b.centre - a.centre, c.centre - a.centre);
    let (u, v) = (a.radius - b.radius, a.radius - c.radius);
    let across = p.cross(q);
    let area_sq = across.norm_sq();
    let flat = area_sq.re() <= 1e-24 * p.norm_sq().re() * q.norm_sq().re();
    if flat || area_sq.re() == 0.0 {
        return [None, None];
    }
    // n = x p + y q + z p x q with n.p = u, n.q = v, |n| = 1.
    let (pp, pq, qq) = (p.norm_sq(), p.dot(q), q.norm_sq());
    let (x, y) = ((u * qq - v * pq) / area_sq, (v * pp - u * pq) / area_sq);
    let within = p * x + q * y;
    let rest = -within.norm_sq() + 1.0;
    if rest.re() <= 0.0 {
        return [None, None];
    }
    let z = (rest / area_sq).sqrt();
    [Some(within + across * z), Some(within - across * z)]
}

/// The planes that touch three balls or more and have all of them behind.
fn facets(balls: &[HullBall<f64>]) -> Vec<TangentPlane> {
    let slack = SAME * size(balls);
    let n = balls.len();
    let mut found: Vec<TangentPlane> = Vec::new();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                for normal in touching([balls[i], balls[j], balls[k]]).into_iter().flatten() {
                    let top = (balls[i].centre - balls[0].centre).dot(normal) + balls[i].radius;
                    let over = |b: &HullBall<f64>| {
                        (b.centre - balls[0].centre).dot(normal) + b.radius - top
                    };
                    if balls.iter().any(|b| over(b) > slack) {
                        continue;
                    }
                    let known = |f: &TangentPlane| {
                        f.normal.distance(normal) < 1e-7 && f.members.contains(&i)
                    };
                    if found.iter().any(known) {
                        continue;
                    }
                    let members = (0..n).filter(|&m| over(&balls[m]) >= -slack).collect();
                    found.push(TangentPlane { normal, members });
                }
            }
        }
    }
    found
}

impl TangentPlane {
    /// The normal with derivatives, by the three members that span the largest triangle.
    fn exact<T: Real>(&self, balls: &[HullBall<T>]) -> Option<(Vec3<T>, Vec3<T>)> {
        let m = &self.members;
        let at = |k: usize| balls[k].centre.re();
        let far = |from: &dyn Fn(usize) -> f64| {
            m.iter().copied().max_by(|a, b| from(*a).total_cmp(&from(*b)).then(b.cmp(a)))
        };
        let i = *m.first()?;
        let j = far(&|k| at(k).distance(at(i)))?;
        let k = far(&|k| (at(j) - at(i)).cross(at(k) - at(i)).norm())?;
        let both = touching([balls[i], balls[j], balls[k]]).into_iter().flatten();
        let off = |n: &Vec3<T>| n.re().distance(self.normal);
        let normal = both.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some((normal, balls[i].touch(normal)))
    }
}

/// True when a plane can roll about two balls with all others behind, through an angle.
fn is_edge(balls: &[HullBall<f64>], i: usize, j: usize) -> bool {
    let slack = SAME * size(balls);
    let along = balls[j].centre - balls[i].centre;
    let length = along.norm();
    if length <= slack {
        return false;
    }
    let u = along / length;
    let rise = (balls[i].radius - balls[j].radius) / length;
    let across = (1.0 - rise * rise).max(0.0).sqrt();
    let Some(e1) = u.perpendicular().normalized() else { return false };
    let e2 = u.cross(e1);
    // Of the angle of the normal rise u + across (e1 cos + e2 sin), for each other ball.
    let mut bounds: Vec<[f64; 3]> = Vec::new();
    for (m, ball) in balls.iter().enumerate() {
        if m == i || m == j {
            continue;
        }
        let to = ball.centre - balls[i].centre;
        let (a, b) = (across * to.dot(e1), across * to.dot(e2));
        let most = balls[i].radius - ball.radius - rise * to.dot(u);
        let reach = libm::hypot(a, b);
        if reach <= slack {
            // In line: the two neighbours have the edge.
            let between = to.dot(u) > 0.0 && to.dot(u) < length;
            if most < -slack || most <= slack && between {
                return false;
            }
            continue;
        }
        bounds.push([a, b, most]);
    }
    has_free_angle(&bounds, slack)
}

/// True if a cos + b sin <= most for all bounds [a, b, most] in an interval of the angle.
pub(super) fn has_free_angle(bounds: &[[f64; 3]], slack: f64) -> bool {
    let mut forbidden: Vec<[f64; 2]> = Vec::new();
    for &[a, b, most] in bounds {
        let reach = libm::hypot(a, b);
        if most >= reach - slack {
            continue;
        }
        if most <= -reach + slack {
            return false;
        }
        let (middle, half) = (libm::atan2(b, a), libm::acos(most / reach));
        let from = (middle - half).rem_euclid(std::f64::consts::TAU);
        forbidden.push([from, from + 2.0 * half]);
    }
    let Some(first) = forbidden.iter().map(|f| f[0]).min_by(f64::total_cmp) else { return true };
    forbidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut reached = first;
    for [from, to] in &forbidden {
        if *from > reached + 1e-6 {
            return true;
        }
        reached = reached.max(*to);
    }
    reached + 1e-6 < first + std::f64::consts::TAU
}

/// The piece of a cone, or cylinder, that touches two balls along circles.
fn frustum<T: Real>(a: &HullBall<T>, b: &HullBall<T>) -> Result<Set<T>, FieldError> {
    let along = b.centre - a.centre;
    let length = along.norm();
    let u = crate::error::unit("line between centres", along)?;
    let rise = (a.radius - b.radius) / length;
    let axis = Axis { point: a.centre, direction: u };
    let side = if rise.re().abs() > 1e-12 {
        let apex = a.centre + u * (a.radius / rise);
        let half = if rise.re() > 0.0 { rise.asin() } else { (-rise).asin() };
        Primitive::cone(Axis { point: apex, direction: u }, half * 2.0)?
    } else if rise.is_constant() {
        Primitive::cylinder(axis, a.radius)?
    } else {
        // A cylinder that is about to become a cone: rho sqrt(1 - rise²) = r - rise s.
        let p = u.perpendicular().normalized().ok_or(FieldError::Degenerate { what: "axis" })?;
        let q = u.cross(p);
        let [x, y, s] = [p, q, u].map(|n| Primitive::linear(n, -n.dot(a.centre)));
        let radius = s * -rise + a.radius;
        (x.power(2) + y.power(2)) * (-(rise * rise) + 1.0) - radius.power(2)
    };
    let low = half_space(-u, a.centre + u * (rise * a.radius))?;
    let high = half_space(u, b.centre + u * (rise * b.radius))?;
    Ok(Set::new(&side) & low & high)
}

/// The polyhedron spanned by points, as half-spaces; `None` if they are in a plane.
pub(super) fn polyhedron<T: Real>(
    points: &[Vec3],
    visible: &[(Vec3<T>, Vec3<T>)],
) -> Result<Option<Set<T>>, FieldError> {
    let balls: Vec<HullBall<f64>> =
        points.iter().map(|&centre| HullBall { centre, radius: 0.0 }).collect();
    let balls = outermost(&balls);
    let slack = 1e3 * SAME * size(&balls);
    let found = facets(&balls);
    let deep = |f: &TangentPlane| {
        let at = balls[f.members[0]].centre;
        balls.iter().any(|b| (b.centre - at).dot(f.normal) < -slack)
    };
    if found.len() < 4 || !found.iter().all(deep) {
        return Ok(None);
    }
    let mut set = Set::everything();
    for facet in &found {
        let at = balls[facet.members[0]].centre;
        let same = |(n, p): &&(Vec3<T>, Vec3<T>)| {
            n.re().distance(facet.normal) < 1e-7 && (p.re() - at).dot(facet.normal).abs() <= slack
        };
        let (normal, point) = match visible.iter().find(same) {
            Some(exact) => *exact,
            None => (Vec3::lifted(facet.normal), Vec3::lifted(at)),
        };
        set = set & half_space(normal, point)?;
    }
    Ok(Some(set))
}

pub(super) fn of_balls<T: Real>(balls: &[HullBall<T>]) -> Result<Set<T>, FieldError> {
    let balls = outermost(balls);
    let flat = FieldError::Degenerate { what: "hull: it has no volume; it" };
    if balls.len() > MOST_BALLS {
        return Err(FieldError::ManyFaces { most: MOST_BALLS });
    }
    let plain: Vec<HullBall<f64>> = balls.iter().map(HullBall::re).collect();
    let thin = SAME * size(&plain);
    let round = |k: usize| plain[k].radius > thin;
    if let [only] = &balls[..] {
        return Ok(Set::new(&Primitive::sphere(only.centre, only.radius)?));
    }
    let found = facets(&plain);
    let mut visible = Vec::with_capacity(found.len());
    let mut points: Vec<Vec3> = Vec::new();
    for facet in &found {
        visible.push(facet.exact(&balls).ok_or(flat.clone())?);
        points.extend(facet.members.iter().map(|&m| plain[m].touch(facet.normal)));
    }
    let mut all = Set::nothing();
    if !found.is_empty() {
        let core = match polyhedron(&points, &visible)? {
            Some(core) => Some(core),
            // All planes touch in one: the centres behind them span the rest.
            None => {
                points.extend(plain.iter().map(|b| b.centre));
                polyhedron(&points, &visible)?
            }
        };
        all = core.unwrap_or(all);
    }
    if (0..balls.len()).any(round) {
        let mut used = vec![false; balls.len()];
        for i in 0..balls.len() {
            for j in i + 1..balls.len() {
                if (round(i) || round(j)) && is_edge(&plain, i, j) {
                    (used[i], used[j]) = (true, true);
                    all = all | frustum(&balls[i], &balls[j])?;
                }
            }
        }
        for (_, ball) in balls.iter().enumerate().filter(|(k, _)| used[*k] && round(*k)) {
            all = all | Set::new(&Primitive::sphere(ball.centre, ball.radius)?);
        }
    }
    if all.is_nothing() { Err(flat) } else { Ok(all) }
}

/// Discs normal to one axis, with the same outline at both ends.
pub(super) struct Prism<T> {
    pub(super) axis: Vec3<T>,
    /// A point of the plane of each end.
    pub(super) ends: [Vec3<T>; 2],
    /// The discs at the low end, of radius 0 for corners.
    pub(super) discs: Vec<HullBall<T>>,
}

/// A side of an outline: from one disc to the next.
pub(super) struct PrismSide<T> {
    pub(super) discs: [usize; 2],
    pub(super) normal: Vec3<T>,
}

impl<T: Real> Prism<T> {
    /// The sides of the outline, counterclockwise about the axis.
    pub(super) fn sides(&self) -> Vec<PrismSide<T>> {
        let axis = self.axis.re();
        let flat = |v: Vec3| v - axis * axis.dot(v);
        let plain: Vec<HullBall<f64>> = (self.discs.iter())
            .map(|d| HullBall { centre: flat(d.centre.re()), radius: d.radius.re() })
            .collect();
        let slack = SAME * size(&plain);
        let mut sides = Vec::new();
        for i in 0..plain.len() {
            for j in (0..plain.len()).filter(|&j| j != i) {
                let normal = self.side_normal(i, j);
                let Some(normal) = normal else { continue };
                let (n, u) = (normal.re(), plain[j].centre - plain[i].centre);
                let length = u.norm();
                let behind = |m: usize| {
                    let to = plain[m].centre - plain[i].centre;
                    let over = to.dot(n) + plain[m].radius - plain[i].radius;
                    let t = to.dot(u) / length;
                    // Of several discs along one side the outer two have it.
                    over < -slack || over <= slack && (-slack..=length + slack).contains(&t)
                };
                if (0..plain.len()).all(behind) {
                    sides.push(PrismSide { discs: [i, j], normal });
                }
            }
        }
        sides
    }

    fn side_normal(&self, i: usize, j: usize) -> Option<Vec3<T>> {
        let along = self.discs[j].centre - self.discs[i].centre;
        let along = along - self.axis * self.axis.dot(along);
        let length = along.norm();
        let u = along.normalized()?;
        let rise = (self.discs[i].radius - self.discs[j].radius) / length;
        let rest = -(rise * rise) + 1.0;
        (rest.re() > 0.0).then(|| u * rise + u.cross(self.axis) * rest.sqrt())
    }

    /// The outline's extrusion between its ends, each moved outward by `longer`, with `wider` added to the radii.
    fn solid(&self, wider: T, longer: T) -> Result<Set<T>, FieldError> {
        let grown = Prism {
            axis: self.axis,
            ends: self.ends,
            discs: (self.discs.iter())
                .map(|d| HullBall { centre: d.centre, radius: d.radius + wider })
                .collect(),
        };
        let sides = grown.sides();
        let discs = &grown.discs;
        let slack = SAME * size(&discs.iter().map(HullBall::re).collect::<Vec<_>>());
        let mut core = Set::everything();
        let mut cylinders = Set::nothing();
        for side in &sides {
            core = core & half_space(side.normal, discs[side.discs[0]].touch(side.normal))?;
        }
        for (k, disc) in discs.iter().enumerate().filter(|(_, d)| d.radius.re() > slack) {
            let ending = sides.iter().find(|s| s.discs[1] == k);
            let beginning = sides.iter().find(|s| s.discs[0] == k);
            if let (Some(a), Some(b)) = (ending, beginning) {
                // The chord under the arc between two sides.
                let [from, to] = [a, b].map(|s| disc.touch(s.normal).re());
                if from.distance(to) > slack {
                    let out = (to - from).cross(self.axis.re());
                    core = core & half_space(Vec3::lifted(out), Vec3::lifted(from))?;
                }
            } else if discs.len() > 1 {
                continue;
            }
            let axis = Axis { point: disc.centre, direction: self.axis };
            cylinders = cylinders | Set::new(&Primitive::cylinder(axis, disc.radius)?);
        }
        let outline = if sides.is_empty() { cylinders } else { core | cylinders };
        if outline.is_nothing()
            || outline.is_everything()
            || sides.len() == 2 && discs.iter().all(|d| d.radius.re() <= slack)
        {
            return Err(FieldError::Degenerate { what: "hull: it has no volume; it" });
        }
        let [low, high] = self.ends;
        let low = half_space(-self.axis, low - self.axis * longer)?;
        let high = half_space(self.axis, high + self.axis * longer)?;
        Ok(outline & low & high)
    }

    /// The extrusion.
    pub(super) fn hull(&self) -> Result<Set<T>, FieldError> {
        self.solid(T::from(0.0), T::from(0.0))
    }

    /// The extrusion with a ball of that radius at each of its points.
    pub(super) fn rounded(&self, radius: T) -> Result<Set<T>, FieldError> {
        let none = T::from(0.0);
        let mut all = self.solid(radius, none)? | self.solid(none, radius)?;
        let sides = self.sides();
        let height = |p: Vec3<T>| self.axis.dot(p);
        let slack = SAME * size(&self.discs.iter().map(HullBall::re).collect::<Vec<_>>());
        for end in self.ends {
            let there = |p: Vec3<T>| p + self.axis * (height(end) - height(p));
            for (k, disc) in self.discs.iter().enumerate() {
                if self.discs.len() > 1 && !sides.iter().any(|s| s.discs.contains(&k)) {
                    continue;
                }
                let centre = there(disc.centre);
                let rim = if disc.radius.re() > slack {
                    Primitive::torus(
                        Axis { point: centre, direction: self.axis },
                        disc.radius,
                        radius,
                    )?
                } else {
                    Primitive::sphere(centre, radius)?
                };
                all = all | Set::new(&rim);
            }
            for side in &sides {
                let [a, b] = side.discs.map(|k| there(self.discs[k].touch(side.normal)));
                let ball = |centre| HullBall { centre, radius };
                all = all | frustum(&ball(a), &ball(b))?;
            }
        }
        Ok(all)
    }
}
