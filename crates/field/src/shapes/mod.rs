//! Primitives from the rest of a model: about a curve, beside a surface, inside a closed mesh.

pub mod faces;
mod polygon;
pub mod profile;
mod signed_side;

use self::signed_side::SignedSide;
use crate::expr::interval::Interval;
use crate::expr::oracle::Oracle;
use moldloft_locate::{NearestCurve, NearestSurface, PlainCurve, PlainSurface};
use moldloft_num::{
    Box3, Curve, CurveJet, Field, Order, Real, SurfJet, Surface, Vec3, triangle_foot,
};
use moldloft_registry::{CurveRef, SheetMeasures, SurfaceRef, TriangleBody};
use std::collections::HashMap;
use std::sync::Arc;

/// The range of a function with Lipschitz constant 1, from its value at the centre of a box.
fn lipschitz(middle: f64, over: &Box3) -> Interval {
    let reach = 0.5 * over.diagonal() * (1.0 + 1e-9) + 1e-9 * over.diagonal();
    Interval { low: middle - reach, high: middle + reach }
}

/// A shape in plain numbers that holds on to the one it shows.
struct Shown<S>(S);

impl<T: Real> Curve<f64> for Shown<CurveRef<T>> {
    fn jet(&self, t: f64, order: Order) -> CurveJet<f64> {
        PlainCurve(&*self.0).jet(t, order)
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3]) {
        PlainCurve(&*self.0).grid(ts, out);
    }

    moldloft_num::curve_facts!(breaks of [self.0], closed of [self.0], rational of [self.0]);
}

impl<T: Real> Surface<f64> for Shown<SurfaceRef<T>> {
    fn jet(&self, u: f64, v: f64, order: Order) -> SurfJet<f64> {
        PlainSurface(&*self.0).jet(u, v, order)
    }

    fn grid(&self, us: &[f64], vs: &[f64], points: &mut [Vec3], normals: Option<&mut [Vec3]>) {
        PlainSurface(&*self.0).grid(us, vs, points, normals);
    }
    fn line(&self, u: f64, vs: &[f64], order: Order) -> Vec<SurfJet<f64>> {
        PlainSurface(&*self.0).line(u, vs, order)
    }
    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3]) {
        PlainSurface(&*self.0).scattered(uv, out);
    }

    moldloft_num::surface_facts!(breaks of [self.0], closed of [self.0], rational of [self.0]);
}

/// The distance from a curve minus a radius.
pub struct Tube<T: Real> {
    curve: CurveRef<T>,
    nearest: Arc<NearestCurve>,
    radius: T,
}

impl<T: Real> Tube<T> {
    /// A tube about `curve`, with round ends.
    pub fn new(curve: CurveRef<T>, radius: T) -> Self {
        let nearest = Arc::new(NearestCurve::new(&PlainCurve(&*curve)));
        Self { curve, nearest, radius }
    }
}

impl<T: Real> Field<T> for Tube<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let found = self.nearest.nearest(&PlainCurve(&*self.curve), p.re());
        // The foot may slide: that changes the distance by nothing.
        let [c, d, _] = self.curve.jet(T::from(found.at[0]), Order::First);
        let away = p - c;
        let size = away.norm();
        if size.re() > 0.0 {
            return (size - self.radius, away / size);
        }
        (-self.radius, d.normalized().map_or_else(Vec3::zero, Vec3::perpendicular))
    }

    moldloft_num::field_facts!(T: value_with_gradient, second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for Tube<T> {
    fn range(&self, over: &Box3) -> Interval {
        lipschitz(Field::value(self, Vec3::lifted(over.centre())).re(), over)
    }
    fn gradient_range(&self, _: &Box3) -> [Interval; 3] {
        [Interval { low: -1.0, high: 1.0 }; 3]
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        Arc::new(Tube {
            curve: CurveRef::new(Shown(self.curve.clone()), 0),
            nearest: self.nearest.clone(),
            radius: self.radius.re(),
        })
    }
}

/// Solid bounded by a surface.
#[derive(Clone, Copy, Debug)]
pub enum Beside<T> {
    /// The distance from the surface on both sides, minus half this thickness.
    Plate(T),
    /// One side of the surface: negative against its natural normal.
    Side,
}

/// The distance from a surface.
pub struct Near<T: Real> {
    surface: SurfaceRef<T>,
    nearest: Arc<NearestSurface>,
    what: Beside<T>,
    /// Bounds of its facing, for `Beside::Side`.
    facing: Option<Arc<SignedSide>>,
}

impl<T: Real> Near<T> {
    /// The distance from `surface`.
    pub fn new(surface: SurfaceRef<T>, what: Beside<T>) -> Self {
        let plain = PlainSurface(&*surface);
        let nearest = Arc::new(NearestSurface::new(&plain));
        let facing = match what {
            Beside::Side => Some(Arc::new(SignedSide::new(&plain))),
            Beside::Plate(_) => None,
        };
        Self { surface, nearest, what, facing }
    }

    fn foot(&self, p: Vec3<T>) -> SurfJet<T> {
        let [u, v] = self.nearest.nearest(&PlainSurface(&*self.surface), p.re()).at;
        self.surface.jet(T::from(u), T::from(v), Order::First)
    }
}

impl<T: Real> Field<T> for Near<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let j = self.foot(p);
        let (away, normal) = (p - j.p, j.normal());
        match self.what {
            // Beyond an edge the surface continues along the tangent plane there.
            Beside::Side => (away.dot(normal), normal),
            Beside::Plate(thickness) => {
                let half = thickness * 0.5;
                let size = away.norm();
                if size.re() > 0.0 { (size - half, away / size) } else { (-half, normal) }
            }
        }
    }

    moldloft_num::field_facts!(T: value_with_gradient, second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for Near<T> {
    fn range(&self, over: &Box3) -> Interval {
        let middle = Vec3::lifted(over.centre());
        let value = Field::value(self, middle).re();
        if let Beside::Plate(_) = self.what {
            return lipschitz(value, over);
        }
        let far = (over.centre() - self.foot(middle).p.re()).norm();
        match &self.facing {
            Some(facing) => facing.range(over, far),
            None => Interval::ENTIRE,
        }
    }
    fn gradient_range(&self, _: &Box3) -> [Interval; 3] {
        match self.what {
            Beside::Plate(_) => [Interval { low: -1.0, high: 1.0 }; 3],
            Beside::Side => [Interval::ENTIRE; 3],
        }
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        Arc::new(Near {
            surface: SurfaceRef::new(Shown(self.surface.clone()), 0),
            nearest: self.nearest.clone(),
            facing: self.facing.clone(),
            what: match self.what {
                Beside::Plate(t) => Beside::Plate(t.re()),
                Beside::Side => Beside::Side,
            },
        })
    }
}

/// Reason why triangles bound no solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotClosed {
    /// Number of edges without exactly one triangle on each side.
    pub edges: usize,
}

/// A box around consecutive triangles, and the indices of its halves; a leaf has none.
struct BvhNode {
    bounds: Box3,
    triangles: std::ops::Range<u32>,
    halves: Option<[u32; 2]>,
}

/// Triangles prepared for nearest points, in plain numbers.
struct Tree {
    nodes: Vec<BvhNode>,
    order: Vec<u32>,
    /// For each triangle the normals of its three corners and of its three edges, as sums that tell sides.
    sides: Vec<[Vec3; 7]>,
}

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// The signed distance from a closed mesh.
pub struct Inside<T: Real> {
    body: Arc<TriangleBody<T>>,
    plain: Arc<Vec<Vec3>>,
    tree: Arc<Tree>,
}

impl<T: Real> Inside<T> {
    /// For the body bounded by closed triangles.
    ///
    /// # Errors
    /// The number of open edges.
    pub fn new(body: Arc<TriangleBody<T>>) -> Result<Self, NotClosed> {
        let points: Vec<Vec3> = body.points.iter().map(|p| p.re()).collect();
        let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
        for t in &body.triangles {
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        let open = edges.iter().filter(|((a, b), n)| **n != 1 || !edges.contains_key(&(*b, *a)));
        let open = open.count();
        if open > 0 || body.triangles.is_empty() {
            return Err(NotClosed { edges: open });
        }
        let tree = Tree::new(&points, &body.triangles);
        Ok(Self { body, plain: Arc::new(points), tree: Arc::new(tree) })
    }
}

fn corners(points: &[Vec3], t: [u32; 3]) -> [Vec3; 3] {
    t.map(|v| points[v as usize])
}

impl Tree {
    fn new(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        // Angle-weighted normals at vertices, sums at edges (Baerentzen and Aanaes 2005).
        let mut at_vertex = vec![Vec3::zero(); points.len()];
        let mut at_edge: HashMap<(u32, u32), Vec3> = HashMap::new();
        let mut normals = Vec::with_capacity(triangles.len());
        for t in triangles {
            let p = corners(points, *t);
            let n = (p[1] - p[0]).cross(p[2] - p[0]).normalized().unwrap_or_default();
            normals.push(n);
            for k in 0..3 {
                let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                let angle = libm::atan2(a.cross(b).norm(), a.dot(b));
                at_vertex[t[k] as usize] += n * angle;
                let (v, w) = (t[k], t[(k + 1) % 3]);
                *at_edge.entry((v.min(w), v.max(w))).or_default() += n;
            }
        }
        let side = |(t, n): (&[u32; 3], &Vec3)| {
            let vertex = |k: usize| at_vertex[t[k] as usize];
            let edge = |k: usize| {
                let (v, w) = (t[k], t[(k + 1) % 3]);
                at_edge[&(v.min(w), v.max(w))]
            };
            [vertex(0), vertex(1), vertex(2), edge(0), edge(1), edge(2), *n]
        };
        let sides = triangles.iter().zip(&normals).map(side).collect();
        let mut tree =
            Self { nodes: Vec::new(), order: (0..triangles.len() as u32).collect(), sides };
        tree.split(points, triangles, 0..triangles.len() as u32);
        tree
    }

    /// Adds the node of a run of triangles and those below it; its number.
    fn split(&mut self, points: &[Vec3], triangles: &[[u32; 3]], run: std::ops::Range<u32>) -> u32 {
        let own = run.start as usize..run.end as usize;
        let all =
            self.order[own.clone()].iter().flat_map(|&t| corners(points, triangles[t as usize]));
        let bounds = Box3::around(all);
        let number = self.nodes.len() as u32;
        self.nodes.push(BvhNode { bounds, triangles: run.clone(), halves: None });
        if own.len() > LEAF {
            let size = bounds.high - bounds.low;
            let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
            let centre = |t: u32| {
                corners(points, triangles[t as usize]).iter().map(|p| p[axis]).sum::<f64>()
            };
            self.order[own].sort_by(|a, b| centre(*a).total_cmp(&centre(*b)).then(a.cmp(b)));
            let middle = run.start + (run.end - run.start) / 2;
            let low = self.split(points, triangles, run.start..middle);
            let high = self.split(points, triangles, middle..run.end);
            self.nodes[number as usize].halves = Some([low, high]);
        }
        number
    }

    /// The triangle nearest to `p`, the weights of its corners and the normal that determines the side.
    fn nearest(&self, points: &[Vec3], triangles: &[[u32; 3]], p: Vec3) -> (u32, [f64; 3], Vec3) {
        let reach = |b: &Box3| {
            (0..3).map(|k| (b.low[k] - p[k]).max(p[k] - b.high[k]).max(0.0).powi(2)).sum::<f64>()
        };
        let mut best = (f64::INFINITY, 0u32, [0.0; 3], 6usize);
        let mut stack: Vec<(f64, u32)> = vec![(reach(&self.nodes[0].bounds), 0)];
        while let Some((distance, at)) = stack.pop() {
            if distance > best.0 {
                continue;
            }
            let node = &self.nodes[at as usize];
            if let Some(halves) = node.halves {
                let mut both = halves.map(|h| (reach(&self.nodes[h as usize].bounds), h));
                if both[0].0 < both[1].0 {
                    both.swap(0, 1);
                }
                stack.extend(both);
                continue;
            }
            for k in node.triangles.clone() {
                let t = self.order[k as usize];
                let [a, b, c] = corners(points, triangles[t as usize]);
                let (weights, feature) = triangle_foot(p, [a, b, c]);
                let q = a * weights[0] + b * weights[1] + c * weights[2];
                let d = (p - q).norm_sq();
                if d < best.0 || d == best.0 && t < best.1 {
                    best = (d, t, weights, feature);
                }
            }
        }
        (best.1, best.2, self.sides[best.1 as usize][best.3])
    }
}

impl<T: Real> Field<T> for Inside<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let (t, weights, side) = self.tree.nearest(&self.plain, &self.body.triangles, p.re());
        let corner = self.body.triangles[t as usize].map(|v| self.body.points[v as usize]);
        let q = (0..3).fold(Vec3::zero(), |q, k| q + corner[k] * T::from(weights[k]));
        let away = p - q;
        let size = away.norm();
        let outside = away.re().dot(side) >= 0.0;
        if size.re() > 1e-12 * (1.0 + p.re().norm()) {
            let signed = if outside { size } else { -size };
            return (signed, away / signed);
        }
        // On the mesh the distance is along the normal.
        let n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        let n = n.normalized().unwrap_or_default();
        (away.dot(n), n)
    }

    moldloft_num::field_facts!(T: value_with_gradient, second_by_differences, no_bounds);
}

impl<T: Real> Oracle<T> for Inside<T> {
    fn range(&self, over: &Box3) -> Interval {
        lipschitz(Field::value(self, Vec3::lifted(over.centre())).re(), over)
    }
    fn gradient_range(&self, _: &Box3) -> [Interval; 3] {
        [Interval { low: -1.0, high: 1.0 }; 3]
    }
    fn re(&self) -> Arc<dyn Oracle<f64>> {
        let body = TriangleBody {
            points: self.plain.to_vec(),
            triangles: self.body.triangles.clone(),
            quads: self.body.quads,
            groups: Vec::new(),
            wires: Vec::new(),
            dots: Vec::new(),
            of_triangles: SheetMeasures {
                area: self.body.of_triangles.area.re(),
                centroid: self.body.of_triangles.centroid.re(),
                volume: self.body.of_triangles.volume.re(),
            },
            border: None,
            flaws: Vec::new(),
        };
        Arc::new(Inside {
            body: Arc::new(body),
            plain: self.plain.clone(),
            tree: self.tree.clone(),
        })
    }
}
