//! Plane cubic curves moved along a direction: the walls of letters, and of sections with parabolas and cubics.

use crate::{Brep, BrepFace, ExactCurve, SurfaceShape};
use moldloft_num::{GAUSS_8_UNIT, Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;

/// Steps along a span of an edge.
const STEPS: usize = 64;

/// A cylinder over a Bézier curve. Beyond its ends it continues along their tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtrudedCubic {
    /// Control points in one plane across the direction.
    points: [Vec3; 4],
    direction: Vec3,
}

/// The point of a Bézier curve.
fn at(points: &[Vec3; 4], t: f64) -> Vec3 {
    let s = 1.0 - t;
    points[0] * (s * s * s)
        + points[1] * (3.0 * s * s * t)
        + points[2] * (3.0 * s * t * t)
        + points[3] * (t * t * t)
}

fn velocity(points: &[Vec3; 4], t: f64) -> Vec3 {
    let s = 1.0 - t;
    let [a, b, c] = [0, 1, 2].map(|k| (points[k + 1] - points[k]) * 3.0);
    a * (s * s) + b * (2.0 * s * t) + c * (t * t)
}

fn acceleration(points: &[Vec3; 4], t: f64) -> Vec3 {
    let [a, b] = [0, 1].map(|k| (points[k] - points[k + 1] * 2.0 + points[k + 2]) * 6.0);
    a.lerp(b, t)
}

/// The parameter in [0, 1] of the point of a Bézier curve nearest to another.
fn nearest(points: &[Vec3; 4], p: Vec3) -> f64 {
    const PLACES: usize = 24;
    let far = |t: f64| (at(points, t) - p).norm_sq();
    let places = (0..=PLACES).map(|k| k as f64 / PLACES as f64);
    let mut t = places.min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(0.0);
    for _ in 0..40 {
        let (d, v, a) = (at(points, t) - p, velocity(points, t), acceleration(points, t));
        // Far inside of a bend Newton's step leads to a farthest point; then Gauss's does not.
        let slope = match v.norm_sq() + d.dot(a) {
            steep if steep > 0.25 * v.norm_sq() => steep,
            _ => v.norm_sq(),
        };
        let next = (t - d.dot(v) / slope).clamp(0.0, 1.0);
        if !next.is_finite() || (next - t).abs() <= 1e-16 {
            break;
        }
        t = next;
    }
    t
}

/// The part of a Bézier curve between two parameters, backwards if the second is less (blossom).
fn part(points: &[Vec3; 4], from: f64, to: f64) -> [Vec3; 4] {
    let blossom = |r: [f64; 3]| {
        let mut row = points.to_vec();
        for t in r {
            row = row.windows(2).map(|w| w[0].lerp(w[1], t)).collect();
        }
        row[0]
    };
    [[from; 3], [from, from, to], [from, to, to], [to; 3]].map(blossom)
}

/// A cubic as a curve.
fn spline(points: [Vec3; 4]) -> Nurbs<1> {
    Nurbs {
        degrees: [3],
        knots: [vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]],
        points: points.into(),
        weights: None,
        error: 0.0,
        exact: true,
        paces: [Pace::Even],
    }
}

/// The part of a plane cubic from one point to another, via others.
pub(crate) fn cubic_span(
    points: &[Vec3; 4],
    [p, q]: [Vec3; 2],
    inner: impl Iterator<Item = Vec3>,
) -> Option<Nurbs<1>> {
    let (mut from, mut to) = (nearest(points, p), nearest(points, q));
    if points[0].distance(points[3]) == 0.0 {
        // Both ends of a closed curve are one point.
        let first = inner.map(|r| nearest(points, r)).next().unwrap_or(0.5);
        let ends = |t: f64, low: bool| if t == 0.0 || t == 1.0 { f64::from(!low) } else { t };
        (from, to) = (ends(from, first < 0.5), ends(to, first >= 0.5));
    }
    let mut own = part(points, from, to);
    // Ends are vertices, bit for bit.
    (own[0], own[3]) = (p, q);
    (from != to).then(|| spline(own))
}

/// A point of a plane cubic near another.
pub(crate) fn near_cubic(points: &[Vec3; 4], p: Vec3) -> Vec3 {
    at(points, nearest(points, p))
}

/// The unit normal of the plane of a cubic.
pub(crate) fn plane_of(points: &[Vec3; 4]) -> Option<Vec3> {
    let [a, b, c] = [1, 2, 3].map(|k| points[k] - points[0]);
    let all = [a.cross(b), a.cross(c), b.cross(c)];
    all.into_iter().max_by(|m, n| m.norm_sq().total_cmp(&n.norm_sq()))?.normalized()
}

impl ExtrudedCubic {
    /// The surface of a plane Bézier curve and a vector across its plane, or at an angle to it.
    pub fn new(points: [Vec3; 4], along: Vec3) -> Option<Self> {
        let direction = along.normalized()?;
        let origin = points[0];
        let points = points.map(|p| p - direction * (p - origin).dot(direction));
        Some(Self { points, direction })
    }

    /// The unit direction.
    pub fn direction(&self) -> Vec3 {
        self.direction
    }

    /// Height of a point along the direction, from the first control point.
    pub(crate) fn height(&self, p: Vec3) -> f64 {
        (p - self.points[0]).dot(self.direction)
    }

    fn flat(&self, p: Vec3) -> Vec3 {
        p - self.direction * self.height(p)
    }

    /// The unit tangent at a parameter, where control points coincide that towards the next one.
    fn tangent(&self, t: f64) -> Vec3 {
        let [a, b, c, d] = self.points;
        let ends = match t < 0.5 {
            true => [c - a, d - a],
            false => [d - b, d - a],
        };
        let size = (b - a).norm() + (c - b).norm() + (d - c).norm();
        let v = velocity(&self.points, t);
        let known = [v, ends[0], ends[1]].into_iter().find(|v| v.norm() > 1e-9 * size);
        known.and_then(|v| v.normalized()).unwrap_or_default()
    }

    /// The foot of a point on the curve or on a tangent at its end, and the normal there: tangent x direction.
    fn foot(&self, p: Vec3) -> (Vec3, Vec3) {
        let p = self.flat(p);
        let t = nearest(&self.points, p);
        let along = self.tangent(t);
        let mut foot = at(&self.points, t);
        let beyond = (p - foot).dot(along);
        if (t == 0.0 && beyond < 0.0) || (t == 1.0 && beyond > 0.0) {
            foot += along * beyond;
        }
        (foot, along.cross(self.direction))
    }

    pub(crate) fn distance(&self, p: Vec3) -> f64 {
        let (foot, normal) = self.foot(p);
        (self.flat(p) - foot).dot(normal)
    }

    pub(crate) fn normal(&self, p: Vec3) -> Vec3 {
        self.foot(p).1
    }

    /// True for the same curve, whichever way it runs, along the same direction.
    pub(crate) fn is_same(&self, o: &Self, tolerance: f64, size: f64) -> bool {
        let near = |p: Vec3, q: Vec3| self.flat(q).distance(p) <= tolerance;
        let [a, b, c, d] = o.points;
        let same = |other: [Vec3; 4]| self.points.iter().zip(other).all(|(p, q)| near(*p, q));
        self.direction.cross(o.direction).norm() * size <= tolerance
            && (same([a, b, c, d]) || same([d, c, b, a]))
    }

    /// The mirror image by a map of points; its normal is the image of the normal.
    pub(crate) fn mirrored(&self, map: impl Fn(Vec3) -> Vec3) -> Self {
        let [a, b, c, d] = self.points.map(&map);
        Self { points: [d, c, b, a], direction: map(self.direction) - map(Vec3::zero()) }
    }

    /// The patch between two heights.
    pub(crate) fn nurbs(&self, heights: [f64; 2]) -> Nurbs<2> {
        let row = |p: &Vec3| heights.map(|h| *p + self.direction * h);
        let curve = spline(self.points);
        Nurbs {
            degrees: [3, 1],
            knots: [curve.knots[0].clone(), vec![0.0, 0.0, 1.0, 1.0]],
            points: self.points.iter().flat_map(row).collect(),
            weights: None,
            error: 0.0,
            exact: true,
            paces: [Pace::Even; 2],
        }
    }

    /// The curves that it has in common with another surface: lines along the direction, and the cubic on a plane
    /// across it. Of other surfaces only the lines through its ends are found.
    pub(crate) fn meet(&self, other: &SurfaceShape, tolerance: f64, size: f64) -> Vec<ExactCurve> {
        let line = |point: Vec3| ExactCurve::Line { point, direction: self.direction };
        let ends = [self.points[0], self.points[3]];
        match other {
            SurfaceShape::Plane { origin, normal, .. } => {
                let along = normal.dot(self.direction);
                if (along * size).abs() > tolerance {
                    let on = |p: Vec3| p + self.direction * ((*origin - p).dot(*normal) / along);
                    return vec![ExactCurve::Cubic(self.points.map(on))];
                }
                let heights = self.points.map(|p| (p - *origin).dot(*normal));
                if heights.iter().all(|h| h.abs() <= tolerance) {
                    return Vec::new();
                }
                let mut all: Vec<Vec3> = Vec::new();
                let found = zeros(&heights).into_iter().map(|t| at(&self.points, t));
                let at_ends = [0, 3].into_iter().filter(|&k| heights[k].abs() <= tolerance);
                for p in at_ends.map(|k| self.points[k]).chain(found) {
                    if all.iter().all(|q| q.distance(p) > tolerance) {
                        all.push(p);
                    }
                }
                all.into_iter().map(line).collect()
            }
            SurfaceShape::Extruded(o) => {
                if self.direction.cross(o.direction).norm() * size > tolerance {
                    return Vec::new();
                }
                let on = |s: &Self, p: Vec3| {
                    near_cubic(&s.points, s.flat(p)).distance(s.flat(p)) <= tolerance
                };
                let own = ends.into_iter().filter(|p| on(o, *p));
                let others = [o.points[0], o.points[3]].into_iter().filter(|p| on(self, *p));
                own.chain(others).map(|p| line(self.flat(p))).collect()
            }
            SurfaceShape::Cylinder { axes, .. }
                if axes.z.cross(self.direction).norm() * size <= tolerance =>
            {
                let on = |p: &Vec3| other.distance(*p).is_some_and(|d| d.abs() <= tolerance);
                ends.into_iter().filter(on).map(line).collect()
            }
            _ => Vec::new(),
        }
    }

    /// A bound on the distance of a Bézier curve: the distance between points of both at parameters related by a
    /// cubic is a polynomial of degree 9, which its control values bound.
    pub(crate) fn bound(&self, curve: &[Vec3; 4]) -> f64 {
        let flat = curve.map(|p| self.flat(p));
        let place = |k: usize| nearest(&self.points, flat[k]);
        let (t, u) = (place(0), place(3));
        let rate = |s: f64, at: f64| {
            let v = velocity(&self.points, at);
            if v.norm_sq() > 0.0 { velocity(&flat, s).dot(v) / v.norm_sq() } else { 0.0 }
        };
        let pace = [t, t + rate(0.0, t) / 3.0, u - rate(1.0, u) / 3.0, u];
        // Powers of the parameter, and the curve, in Bernstein form of degree 9.
        let raise = |f: &[f64]| -> [f64; 10] {
            let n = f.len() - 1;
            let ones = vec![1.0; 10 - n];
            std::array::from_fn(|k| crate::crossing::times(f, &ones)[k])
        };
        let two = crate::crossing::times(&pace, &pace);
        let three = crate::crossing::times(&two, &pace);
        let powers = [raise(&pace), raise(&two), raise(&three)];
        let [a, b, c, d] = self.points;
        let terms = [(b - a) * 3.0, (a - b * 2.0 + c) * 3.0, d - a + (b - c) * 3.0];
        let line: [[f64; 10]; 3] = std::array::from_fn(|j| raise(&flat.map(|p| p[j])));
        let off = |k: usize| {
            let own =
                a + terms[0] * powers[0][k] + terms[1] * powers[1][k] + terms[2] * powers[2][k];
            own.distance(Vec3::from([line[0][k], line[1][k], line[2][k]]))
        };
        let inside = pace.iter().all(|t| (0.0..=1.0).contains(t));
        if inside { (0..10).map(off).fold(0.0, f64::max) } else { f64::INFINITY }
    }

    /// The integral of (p - about) . n over a face, n the normal of the surface, and the error of the sums along its
    /// edges: that about the first control point, which depends on the parameter alone, by Green's theorem.
    pub(crate) fn flux(&self, brep: &Brep, face: &BrepFace, about: Vec3) -> (f64, f64) {
        let origin = self.points[0];
        let rate = |t: f64| {
            let v = velocity(&self.points, t).cross(self.direction);
            (at(&self.points, t) - origin).dot(v)
        };
        // Gauss's rule of eight points is exact.
        let between = |t: f64, u: f64| -> f64 {
            let term = |(x, w): &(f64, f64)| rate(t + (u - t) * x) * w;
            (u - t) * GAUSS_8_UNIT.iter().map(term).sum::<f64>()
        };
        let sense = if face.reversed { -1.0 } else { 1.0 };
        let (mut sum, mut error) = (0.0, 0.0);
        for side in face.loops.iter().flatten() {
            let curve = &brep.edges[side.edge].curve;
            let mut knots = curve.knots[0].clone();
            knots.dedup();
            for span in knots.windows(2) {
                let place = |k: usize| span[0] + (span[1] - span[0]) * k as f64 / STEPS as f64;
                let points = curve.grid(&[(0..=STEPS).map(place).collect()]);
                let own: Vec<(f64, f64)> = points
                    .iter()
                    .map(|p| (nearest(&self.points, self.flat(*p)), self.height(*p)))
                    .collect();
                let by = |stride: usize| -> (Vec3, f64) {
                    let mut all = (Vec3::zero(), 0.0);
                    for k in (stride..=STEPS).step_by(stride) {
                        let ((t, h), (u, g)) = (own[k - stride], own[k]);
                        let [p, q] = [k - stride, k].map(|k| points[k] - origin);
                        all.0 += p.cross(q) * 0.5;
                        all.1 -= 0.5 * (h + g) * between(t, u);
                    }
                    all
                };
                let value = |stride: usize| {
                    let (area, over) = by(stride);
                    (origin - about).dot(area) + over
                };
                let (made, off) = crate::volume::romberg(value(4), value(2), value(1));
                sum += if side.forward { made } else { -made };
                error += off;
            }
        }
        (sense * sum, error)
    }
}

/// The parameters in [0, 1] at which a cubic with these Bernstein coefficients is zero.
fn zeros(f: &[f64; 4]) -> Vec<f64> {
    const DEEPEST: u32 = 60;
    let mut found = Vec::new();
    let mut pending = vec![(*f, 0.0, 1.0, 0)];
    while let Some((f, low, high, deep)) = pending.pop() {
        let above = f.iter().filter(|x| **x > 0.0).count();
        if above == 0 && f.iter().all(|x| *x < 0.0) || above == 4 {
            continue;
        }
        let middle = 0.5 * (low + high);
        if deep == DEEPEST {
            if found.iter().all(|t: &f64| (t - middle).abs() > 1e-12) {
                found.push(middle);
            }
            continue;
        }
        let mut row = f.to_vec();
        let (mut left, mut right) = (f, f);
        for k in 1..4 {
            row = row.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
            (left[k], right[3 - k]) = (row[0], row[row.len() - 1]);
        }
        pending.push((left, low, middle, deep + 1));
        pending.push((right, middle, high, deep + 1));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LabelledFacets, meet};

    /// A frame that is square to no axis.
    fn frame() -> [Vec3; 3] {
        let z = Vec3::of(0.3, 0.5, 0.8).normalized().unwrap();
        let x = z.perpendicular().normalized().unwrap();
        [x, z.cross(x), z]
    }

    fn place(x: f64, y: f64, z: f64) -> Vec3 {
        let [u, v, w] = frame();
        Vec3::of(3.0, -1.0, 2.0) + u * x + v * y + w * z
    }

    const WALL: [[f64; 2]; 4] = [[0.0, 0.0], [2.5, -0.4], [1.0, 1.7], [0.0, 1.2]];

    fn wall() -> ExtrudedCubic {
        ExtrudedCubic::new(WALL.map(|[x, y]| place(x, y, 0.7)), frame()[2] * 2.0).unwrap()
    }

    fn plane(origin: Vec3, normal: Vec3) -> SurfaceShape {
        let normal = normal.normalized().unwrap();
        SurfaceShape::Plane { origin, normal, axis: normal.perpendicular() }
    }

    /// The prism over the wall and its chord, between z = 0 and z = 1 + x/4 - y/5.
    fn body() -> Brep {
        const STEPS: usize = 24;
        let [u, v, w] = frame();
        let top = |x: f64, y: f64| 1.0 + x / 4.0 - y / 5.0;
        let points = WALL.map(|[x, y]| Vec3::of(x, y, 0.0));
        let n = STEPS + 1;
        let mut positions = Vec::new();
        for high in [false, true] {
            for k in 0..n {
                let p = at(&points, k as f64 / STEPS as f64);
                positions.push(place(p.x, p.y, if high { top(p.x, p.y) } else { 0.0 }));
            }
        }
        let (mut triangles, mut labels) = (Vec::new(), Vec::new());
        let mut put = |t: [usize; 3], label: u32| {
            triangles.push(t.map(|k| k as u32));
            labels.push(label);
        };
        for k in 0..STEPS {
            put([k, k + 1, n + k + 1], 0);
            put([k, n + k + 1, n + k], 0);
            if k > 0 {
                put([0, k + 1, k], 1);
                put([n, n + k, n + k + 1], 2);
            }
        }
        put([STEPS, 0, n], 3);
        put([STEPS, n, n + STEPS], 3);
        let surfaces = vec![
            Some(SurfaceShape::Extruded(Box::new(wall()))),
            Some(plane(place(0.0, 0.0, 0.0), -w)),
            Some(plane(place(0.0, 0.0, 1.0), w - u / 4.0 + v / 5.0)),
            Some(plane(place(0.0, 0.0, 0.0), -u)),
        ];
        let facets = LabelledFacets {
            positions,
            triangles,
            labels,
            surfaces,
            names: (0..4).map(|k| format!("face {k}")).collect(),
            colours: vec![None; 4],
            layers: vec![Vec::new(); 4],
            step: 0.2,
            certain: true,
        };
        let mut brep = Brep::default();
        brep.add_facets(facets, 1e-9, 4.0).unwrap();
        brep
    }

    #[test]
    fn a_prism_has_the_volume_of_its_integral() {
        // By Green's theorem along the curve; the chord is on x = 0, where the integrand is zero.
        let points = WALL.map(|[x, y]| Vec3::of(x, y, 0.0));
        let over = |(t, w): &(f64, f64)| {
            let (p, d) = (at(&points, *t), velocity(&points, *t));
            w * (p.x * (1.0 - p.y / 5.0) + p.x * p.x / 8.0) * d.y
        };
        let exact: f64 = GAUSS_8_UNIT.iter().map(over).sum();
        let brep = body();
        assert_eq!((brep.faces.len(), brep.edges.len(), brep.vertices.len()), (4, 6, 4));
        assert!(brep.exact() && brep.faults().is_empty());
        for brep in [brep.clone(), brep.facing()] {
            let found = brep.volume();
            if brep.faces.iter().all(|f| !matches!(f.surface, SurfaceShape::Nurbs(_))) {
                let found = found.unwrap();
                let off = (found.volume - exact).abs();
                assert!(off < 1e-9 * exact && off <= found.error, "{found:?}, not {exact}");
                assert!(found.error < 1e-6 * exact, "{found:?}");
            }
        }
        let mirrored = body().with_image(0).volume().unwrap().volume;
        assert!((mirrored - 2.0 * exact).abs() < 1e-9 * exact, "{mirrored}");
    }

    #[test]
    fn patches_and_distances_are_of_one_surface() {
        let (wall, shape) = (wall(), SurfaceShape::Extruded(Box::new(wall())));
        let patch = shape.nurbs([-0.5, 1.5]).unwrap();
        for i in 0..=10 {
            for j in 0..=4 {
                let [u, v] = [f64::from(i) / 10.0, f64::from(j) / 4.0];
                let p = patch.at([u, v]);
                assert!(shape.distance(p).unwrap().abs() < 1e-14);
                let n = shape.normal(p);
                let off = p + n * 0.05;
                assert!((shape.distance(off).unwrap() - 0.05).abs() < 1e-12, "{u} {v}");
                assert!(n.dot(wall.direction()).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn planes_meet_it_in_cubics_and_lines() {
        let shape = SurfaceShape::Extruded(Box::new(wall()));
        let [u, v, w] = frame();
        let oblique = plane(place(0.1, 0.2, 0.3), w + u * 0.4);
        let level = plane(place(0.0, 1.22, 0.0), v);
        let [cubic] = &meet(&oblique, &shape, 1e-9, 4.0)[..] else { panic!() };
        let lines = meet(&shape, &level, 1e-9, 4.0);
        assert_eq!(lines.len(), 2);
        for (curve, other) in lines.iter().map(|l| (l, &level)).chain([(cubic, &oblique)]) {
            for k in 0..20 {
                let p = curve.near(place(0.1 * f64::from(k), 0.5, 0.3));
                assert!(other.distance(p).unwrap().abs() < 1e-12);
                assert!(shape.distance(p).unwrap().abs() < 1e-12);
            }
        }
    }

    #[test]
    fn bounds_are_above_distances() {
        let wall = wall();
        for k in 0..40 {
            // Curves along the wall that leave it by up to a part of their length.
            let (s, t) = (0.02 * f64::from(k), 0.02 * f64::from(k) + 0.15);
            let [_, v, w] = frame();
            let off = v * (1e-4 * f64::from(k % 7)) + w * 0.3;
            let own = part(&wall.points, s, t);
            let curve = [own[0], own[1] + off, own[2] + off * 0.5, own[3]];
            let sampled = |i: i32| wall.distance(at(&curve, f64::from(i) / 50.0)).abs();
            let most = (0..=50).map(sampled).fold(0.0, f64::max);
            let bound = wall.bound(&curve);
            assert!(bound + 1e-14 >= most && bound <= 4.0 * most + 1e-4, "{bound} {most}");
        }
    }
}
