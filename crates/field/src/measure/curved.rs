//! Facets as quadratic triangles, by which integrals over bodies and surfaces are of high order.
//!
//! Every side of a triangle gets a midpoint on the surface, on both surfaces along an edge. A
//! quadratic patch through the six points is within O(h^3) of the surface. The rest is a layer: at
//! a point of the patch, with N = f' / |f'|, the surface is at the distance t = -f / |f'| along N.
//! With dA the area vector of the patch and the divergence theorem for the layer,
//!
//! - the integral of a monomial g of degree d over the body is that of g x . dA / (3 + d), plus g t N . dA;
//! - the area of the surface, the flux of N through it, is that of N . dA (1 + t div N).
//!
//! Both neglect terms of second order in t, thus of sixth in h. Along an edge the quadratic curve
//! crosses the true one between its nodes, so that the area between them cancels like the error of
//! Simpson's rule. All is a formula of the six points, so that numbers with derivatives give the
//! derivatives: those of moving edges are those of their midpoints.

use super::moments::{Moments, POWERS};
use super::moved::moved;
use crate::expr::algebra::Algebra;
use crate::facet::types::TriangleView;
use crate::facet::wires::FacetWire;
use crate::set::Leaf;
use crate::{Hessian, Primitive, ValueGradient};
use moldloft_num::{Box3, Real, Vec3};
use moldloft_parallel::prelude::*;

use crate::facet::vertex::{Solver, Surfaces};

/// Maximum distance of a midpoint from that of the chord, relative to the length; beyond, the side
/// stays straight.
const AWAY: f64 = 0.3;
/// A layer whose curvature changes its area by more than this is not a thin layer of a smooth surface.
const THIN: f64 = 0.2;
/// Number of triangles summed together, so that the order of summation does not depend on threads.
const CHUNK: usize = 512;

/// The rule of seven points of degree five on a triangle (Radon 1948): the first coordinate of each orbit's
/// odd corner, the two equal ones, and the weight.
const CENTRE: f64 = 0.225;
const ORBITS: [[f64; 3]; 2] = [
    [0.059_715_871_789_769_82, 0.470_142_064_105_115_1, 0.132_394_152_788_506_2],
    [0.797_426_985_353_087_3, 0.101_286_507_323_456_34, 0.125_939_180_544_827_15],
];

/// Triangles with the middles of their sides.
pub(crate) struct Curved<'a> {
    positions: &'a [Vec3],
    faces: &'a [[u32; 4]],
    /// The leaf of each face.
    leaves: Vec<u32>,
    /// The midpoints, and their leaves: empty for straight sides.
    middles: Vec<Vec3>,
    on: Vec<Surfaces>,
    ends: Vec<[u32; 2]>,
    /// The sides of each face: that from its corner k to the next.
    sides: Vec<[u32; 3]>,
}

/// Distance from a surface that counts as on it, for points of that box.
fn goal(over: &Box3) -> f64 {
    1e-12 * over.diagonal() + 8.0 * f64::EPSILON * over.low.norm().max(over.high.norm())
}

/// The point of some surfaces between two of their points, near the middle of the chord.
fn middle(
    solver: &mut Solver,
    leaves: &[Leaf],
    on: &[u32],
    [p, q]: [Vec3; 2],
    goal: f64,
) -> Option<Vec3> {
    let (chord, length) = ((p + q) * 0.5, p.distance(q));
    let away = AWAY * length;
    let reach = Vec3::of(away, away, away);
    let around = Box3 { low: chord - reach, high: chord + reach };
    let placed = solver.place(leaves, on, chord, &around, goal);
    (placed.residual <= goal && placed.point.distance(chord) <= away).then_some(placed.point)
}

impl<'a> Curved<'a> {
    /// From triangles, closed or open.
    pub fn new(flat: &TriangleView<'a>) -> Self {
        let TriangleView { positions, faces, .. } = *flat;
        let mut leaves = vec![0; faces.len()];
        for (leaf, range) in &flat.patches {
            leaves[range.clone()].fill(*leaf);
        }
        let mut all: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * faces.len());
        for (k, face) in faces.iter().enumerate() {
            for side in 0..3 {
                let (p, q) = (face[side], face[(side + 1) % 3]);
                all.push((p.min(q), p.max(q), (3 * k + side) as u32));
            }
        }
        all.par_sort_unstable();
        let groups: Vec<&[(u32, u32, u32)]> =
            all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
        let mut sides = vec![[0; 3]; faces.len()];
        for (number, group) in groups.iter().enumerate() {
            for (_, _, place) in *group {
                sides[*place as usize / 3][*place as usize % 3] = number as u32;
            }
        }
        let goal = goal(&Box3::around(positions.iter().copied()));
        let found: Vec<(Vec3, Surfaces)> = groups
            .par_iter()
            .map_init(Solver::default, |solver, group| {
                let (a, b, _) = group[0];
                let ends = [a, b].map(|v| positions[v as usize]);
                let mut on: Surfaces = group.iter().map(|g| leaves[g.2 as usize / 3]).collect();
                on.sort_unstable();
                on.dedup();
                // At the boundary of a sheet, the other surface is one that contains both ends.
                let other = |k: &u32| !on.contains(k) && flat.surfaces[b as usize].contains(k);
                let others: Surfaces = match group.len() {
                    1 => flat.surfaces[a as usize].iter().copied().filter(other).collect(),
                    _ => Surfaces::new(),
                };
                let straight = ((ends[0] + ends[1]) * 0.5, Surfaces::new());
                if on.len() > 2 {
                    return straight;
                }
                for other in others {
                    let mut both = on.clone();
                    both.push(other);
                    if let Some(point) = middle(solver, flat.leaves, &both, ends, goal) {
                        return (point, both);
                    }
                }
                match middle(solver, flat.leaves, &on, ends, goal) {
                    Some(point) => (point, on),
                    None => straight,
                }
            })
            .collect();
        let ends = groups.iter().map(|g| [g[0].0, g[0].1]).collect();
        let (middles, on) = found.into_iter().unzip();
        Self { positions, faces, leaves, middles, on, ends, sides }
    }

    /// The middles when the corners are at `positions` and the surfaces are these.
    fn middles<T: Real>(
        &self,
        positions: &[Vec3<T>],
        primitives: &[Option<Primitive<T>>],
    ) -> Vec<Vec3<T>> {
        let mut middles = moved(&self.middles, &self.on, primitives);
        for ((middle, on), [a, b]) in middles.iter_mut().zip(&self.on).zip(&self.ends) {
            if on.is_empty() {
                *middle = (positions[*a as usize] + positions[*b as usize]) * T::from(0.5);
            }
        }
        middles
    }

    /// Sum of `each` of the leaf, its jet (if it has a primitive), the point and the area vector
    /// over all points of the rule.
    fn sum<T: Real, A: Algebra<T, At = Vec3<T>> + Send, const N: usize>(
        &self,
        positions: &[Vec3<T>],
        primitives: &[Option<Primitive<T>>],
        each: impl Fn(u32, Option<&A>, Vec3<T>, Vec3<T>) -> [T; N] + Sync,
    ) -> [T; N] {
        let middles = self.middles(positions, primitives);
        let numbers: Vec<u32> = (0..self.faces.len() as u32).collect();
        let parts: Vec<[T; N]> = numbers
            .par_chunks(CHUNK)
            .map_init(Vec::new, |room, chunk| {
                let mut total = [T::zero(); N];
                // Faces of one leaf are consecutive: external primitives are evaluated once for
                // all.
                for run in
                    chunk.chunk_by(|a, b| self.leaves[*a as usize] == self.leaves[*b as usize])
                {
                    let leaf = self.leaves[run[0] as usize];
                    let tape = primitives[leaf as usize].as_ref().map(|f| f.tape());
                    let all = run.iter().flat_map(|&k| {
                        let (face, sides) = (self.faces[k as usize], self.sides[k as usize]);
                        let p = [0, 1, 2].map(|i| positions[face[i] as usize]);
                        let m = [0, 1, 2].map(|i| middles[sides[i] as usize]);
                        points(p, m)
                    });
                    let mut add = |jet: Option<&A>, (x, area): (Vec3<T>, Vec3<T>)| {
                        let terms = each(leaf, jet, x, area);
                        for (total, term) in total.iter_mut().zip(terms) {
                            *total += term;
                        }
                    };
                    match tape {
                        None => all.for_each(|point| add(None, point)),
                        Some(tape) if tape.has_users() => {
                            let all: Vec<_> = all.collect();
                            let places: Vec<Vec3<T>> = all.iter().map(|(x, _)| *x).collect();
                            let jets = tape.eval_many::<A>(&places).pop().unwrap_or_default();
                            all.into_iter()
                                .zip(&jets)
                                .for_each(|(point, jet)| add(Some(jet), point));
                        }
                        Some(tape) => all.for_each(|point| {
                            let jet = tape.eval::<A>(&point.0, room);
                            add(Some(&jet), point);
                        }),
                    }
                }
                total
            })
            .collect();
        let mut total = [T::zero(); N];
        for part in parts {
            for (total, part) in total.iter_mut().zip(part) {
                *total += part;
            }
        }
        total
    }

    /// The moments, about a point, of the body that closed triangles bound.
    pub fn moments<T: Real>(
        &self,
        positions: &[Vec3<T>],
        primitives: &[Option<Primitive<T>>],
        about: Vec3,
    ) -> Moments<T> {
        let size = self.size();
        let each = |_: u32, jet: Option<&ValueGradient<T>>, x: Vec3<T>, area: Vec3<T>| {
            let x = x - Vec3::lifted(about);
            let flux = x.dot(area);
            let mut layer = T::zero();
            if let Some(g) = jet {
                let slope = g.slope.norm_sq();
                if slope.re() > 0.0 && (g.value.re() / slope.re().sqrt()).abs() <= size {
                    layer = -(g.value / slope) * g.slope.dot(area);
                }
            }
            let mut terms = [T::zero(); 10];
            for (term, powers) in terms.iter_mut().zip(POWERS) {
                let degree = f64::from(powers.iter().sum::<u32>());
                let monomial = (0..3).fold(T::one(), |m, k| match powers[k] {
                    0 => m,
                    1 => m * x[k],
                    _ => m * x[k] * x[k],
                });
                *term = monomial * (flux / (3.0 + degree) + layer);
            }
            terms
        };
        Moments { about, terms: self.sum(positions, primitives, each) }
    }

    /// The area of the faces of those leaves.
    pub fn area<T: Real>(
        &self,
        positions: &[Vec3<T>],
        primitives: &[Option<Primitive<T>>],
        counts: impl Fn(u32) -> bool + Sync,
    ) -> T {
        let each = |leaf: u32, jet: Option<&Hessian<T>>, _: Vec3<T>, area: Vec3<T>| {
            if !counts(leaf) {
                return [T::zero()];
            }
            let plain = || match area.re().norm_sq() > 0.0 {
                true => area.norm(),
                false => T::zero(),
            };
            let Some(h) = jet else { return [plain()] };
            let slope = h.slope.norm_sq();
            if slope.re() == 0.0 || !slope.is_finite() {
                return [plain()];
            }
            let size = slope.sqrt();
            // |f'| div N = tr f'' - N . f'' N, so t div N = -f (tr f'' - N . f'' N) / |f'|^2.
            let trace = h.second[0].x + h.second[1].y + h.second[2].z;
            let bend = (0..3).fold(T::zero(), |s, k| s + h.slope[k] * h.second[k].dot(h.slope));
            let grown = -(h.value * (trace - bend / slope)) / slope;
            let thin = grown.re().abs() <= THIN && grown.is_finite();
            let flux = h.slope.dot(area) / size;
            [if thin { flux + flux * grown } else { flux }]
        };
        let [area] = self.sum(positions, primitives, each);
        area
    }

    /// Mean side of the triangles; layers thicker than that are rejected.
    fn size(&self) -> f64 {
        let all = self
            .ends
            .iter()
            .map(|[a, b]| self.positions[*a as usize].distance(self.positions[*b as usize]));
        all.sum::<f64>() / self.ends.len().max(1) as f64
    }
}

/// The points of the rule on a quadratic triangle with corners p and middles m, m[k] between p[k] and the next,
/// each with its weighted area vector.
fn points<T: Real>(p: [Vec3<T>; 3], m: [Vec3<T>; 3]) -> [(Vec3<T>, Vec3<T>); 7] {
    let third = 1.0 / 3.0;
    let mut out = [(Vec3::zero(), Vec3::zero()); 7];
    let mut at = |k: usize, l: [f64; 3], weight: f64| {
        // Shape functions l (2 l - 1) of corners and 4 l l' of middles, and their slopes by l[1] and l[2].
        let [a, b, c] = l;
        let corner = |l: f64| l * (2.0 * l - 1.0);
        let times = |v: Vec3<T>, k: f64| v * T::from(k);
        let x = times(p[0], corner(a))
            + times(p[1], corner(b))
            + times(p[2], corner(c))
            + times(m[0], 4.0 * a * b)
            + times(m[1], 4.0 * b * c)
            + times(m[2], 4.0 * c * a);
        let first = times(p[0], 1.0 - 4.0 * a);
        let u = first
            + times(p[1], 4.0 * b - 1.0)
            + times(m[0], 4.0 * (a - b))
            + times(m[1] - m[2], 4.0 * c);
        let v = first
            + times(p[2], 4.0 * c - 1.0)
            + times(m[2], 4.0 * (a - c))
            + times(m[1] - m[0], 4.0 * b);
        out[k] = (x, u.cross(v) * T::from(0.5 * weight));
    };
    at(0, [third; 3], CENTRE);
    for (k, [odd, even, weight]) in ORBITS.into_iter().enumerate() {
        for turn in 0..3 {
            let mut l = [even; 3];
            l[turn] = odd;
            at(1 + 3 * k + turn, l, weight);
        }
    }
    out
}

/// The length of a wire, of fourth order: that of parabolas through middles.
pub(crate) fn length<T: Real>(wire: &FacetWire, primitives: &[Option<Primitive<T>>]) -> T {
    let (points, surfaces, leaves) = (&wire.points, &wire.on.surfaces, &wire.on.leaves);
    let goal = goal(&Box3::around(points.iter().copied()));
    let mut solver = Solver::default();
    let n = points.len();
    let ends = moved(points, surfaces, primitives);
    let mut length = T::zero();
    for k in 0..if wire.closed { n } else { n.saturating_sub(1) } {
        let (i, j) = (k, (k + 1) % n);
        let on: Surfaces =
            surfaces[i].iter().copied().filter(|s| surfaces[j].contains(s)).collect();
        let (p, q) = (ends[i], ends[j]);
        let found = match on.len() {
            2 => middle(&mut solver, leaves, &on, [points[i], points[j]], goal),
            _ => None,
        };
        let m = match found {
            Some(point) => moved(&[point], &[on], primitives)[0],
            None => (p + q) * T::from(0.5),
        };
        // Gauss's rule of three points for |x'| of the parabola.
        let (step, bend) = (q - p, (p + q - m * T::from(2.0)) * T::from(2.0));
        for (x, weight) in
            [(-0.6f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6f64.sqrt(), 5.0 / 18.0)]
        {
            let speed = step + bend * T::from(x);
            if speed.re().norm_sq() > 0.0 {
                length += speed.norm() * weight;
            }
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_degree_five() {
        let p = [Vec3::of(0.0, 0.0, 0.0), Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0)];
        let m = [0, 1, 2].map(|k| (p[k] + p[(k + 1) % 3]) * 0.5);
        let factorial = |n: u32| (1..=n).product::<u32>() as f64;
        for i in 0..=5u32 {
            for j in 0..=5 - i {
                let sum: f64 = points(p, m)
                    .iter()
                    .map(|(x, a)| x.x.powi(i as i32) * x.y.powi(j as i32) * a.z)
                    .sum();
                let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                assert!((sum - exact).abs() < 1e-15, "{i} {j}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn a_quadratic_triangle_passes_through_its_six_points() {
        // x, y and x^2 + x y: the patch is that graph, whose area vector is (-z_x, -z_y, 1).
        let lift = |x: f64, y: f64| Vec3::<f64>::of(x, y, x * x + x * y);
        let p = [lift(0.0, 0.0), lift(1.0, 0.0), lift(0.0, 1.0)];
        let m = [lift(0.5, 0.0), lift(0.5, 0.5), lift(0.0, 0.5)];
        for (x, a) in points(p, m) {
            assert!((x.z - x.x * x.x - x.x * x.y).abs() < 1e-15);
            let slope = Vec3::of(-2.0 * x.x - x.y, -x.x, 1.0);
            assert!((a / a.z).distance(slope) < 1e-13);
        }
    }
}
