//! Sections of the exact surfaces, and of bodies of triangles: stations, waterlines, buttocks, and those by cylinders and angles.

use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder, section_where};
use moldloft_num::{Order, Real, Vec3, find_root};
use moldloft_registry::{Attributes, Family, SurfaceRef, TriangleBody};
use std::collections::{BTreeMap, BTreeSet};

/// One line of a section, with points that are on the surface and in the plane, up to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Points in order along the line.
    pub points: Vec<Vec3>,
    /// Their parameters (u, v) on the surface; empty on the triangles of a body.
    pub uv: Vec<[f64; 2]>,
    /// True when the line closes; the first point is not repeated.
    pub closed: bool,
}

/// The grid for finding sections of a surface: a line inside a single cell is missed.
pub struct ContourCutter<'s, T: Real> {
    surface: &'s SurfaceRef<T>,
    us: Vec<f64>,
    vs: Vec<f64>,
    points: Vec<Vec3>,
}

/// An edge of the search grid: from (i, j) along u or along v.
type GridEdge = (usize, usize, bool);

impl<'s, T: Real> ContourCutter<'s, T> {
    /// Tabulates `surface` at least four times as finely as its panels, with 32 steps or more.
    pub fn new(surface: &'s SurfaceRef<T>, head: &Attributes) -> Self {
        let breaks = surface.breaks();
        let steps = |k: usize| {
            let n = head.own_divisions()[k].saturating_mul(head.subdivisions[k]).saturating_mul(4);
            let n = n.clamp(32, 512);
            let even = (0..=n).map(|i| f64::from(i) / f64::from(n));
            // A line turns where it crosses a knuckle: there it has a point.
            let mut all: Vec<f64> = even.chain(breaks[k].iter().copied()).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let (us, vs) = (steps(0), steps(1));
        let mut points = vec![Vec3::<T>::zero(); us.len() * vs.len()];
        surface.grid(&us, &vs, &mut points, None);
        let points = points.into_iter().map(|p| p.re()).collect();
        Self { surface, us, vs, points }
    }

    /// The lines in which the member `value` of a family cuts the surface: first those that begin
    /// at an edge, each from the edge point of lowest grid index.
    pub fn section(&self, family: &Family<T>, value: T) -> Vec<Contour> {
        let nv = self.vs.len();
        let over = |p: Vec3| family.height(value, Vec3::lifted(p)).re();
        let heights: Vec<f64> = self.points.iter().map(|&p| over(p)).collect();
        // At a pole on the section all heights are rounding: they must have one sign.
        let size = self.points.iter().fold(0.0f64, |m, p| m.max(p.norm()));
        let epsilon = 64.0 * f64::EPSILON * size;
        let above = |i: usize, j: usize| heights[i * nv + j] >= -epsilon;
        let point = |u: f64, v: f64| self.point([u, v]);
        let height = |u: f64, v: f64| over(point(u, v));
        let mut crossings: BTreeMap<GridEdge, [f64; 2]> = BTreeMap::new();
        for i in 0..self.us.len() {
            for j in 0..nv {
                if i + 1 < self.us.len() && above(i, j) != above(i + 1, j) {
                    let at = |u: f64| height(u, self.vs[j]);
                    let u = root(at, self.us[i], self.us[i + 1]);
                    crossings.insert((i, j, true), [u, self.vs[j]]);
                }
                if j + 1 < nv && above(i, j) != above(i, j + 1) {
                    let at = |v: f64| height(self.us[i], v);
                    let v = root(at, self.vs[j], self.vs[j + 1]);
                    crossings.insert((i, j, false), [self.us[i], v]);
                }
            }
        }
        crossings.retain(|_, [u, v]| family.holds(value, Vec3::lifted(point(*u, *v))));
        let mut links: BTreeMap<GridEdge, Vec<GridEdge>> = BTreeMap::new();
        let cells: BTreeSet<(usize, usize)> =
            crossings.keys().flat_map(|&e| self.cells(e)).collect();
        for (i, j) in cells {
            let edges = [(i, j, true), (i + 1, j, false), (i, j + 1, true), (i, j, false)];
            let cut: Vec<GridEdge> =
                edges.into_iter().filter(|e| crossings.contains_key(e)).collect();
            let pairs: &[(usize, usize)] = match cut.len() {
                2 => &[(0, 1)],
                4 => {
                    // A saddle: the middle tells which corners are connected.
                    let (u, v) =
                        (0.5 * (self.us[i] + self.us[i + 1]), 0.5 * (self.vs[j] + self.vs[j + 1]));
                    let middle = height(u, v) >= 0.0;
                    if middle == above(i, j) { &[(0, 1), (2, 3)] } else { &[(0, 3), (1, 2)] }
                }
                _ => &[],
            };
            for &(a, b) in pairs {
                links.entry(cut[a]).or_default().push(cut[b]);
                links.entry(cut[b]).or_default().push(cut[a]);
            }
        }
        let mut lines = self.chains(&crossings, links, epsilon);
        for axis in 0..2 {
            for far in [false, true] {
                let line = self.border(axis, far, &heights, epsilon);
                let held = |line: &Contour| {
                    line.points.iter().all(|&p| family.holds(value, Vec3::lifted(p)))
                };
                lines.extend(line.filter(held));
            }
        }
        lines
    }

    /// The border at one end of a parameter, when it is in the section and the surface rises from it: no cell then shows
    /// a change of sign.
    fn border(&self, axis: usize, far: bool, heights: &[f64], epsilon: f64) -> Option<Contour> {
        let counts = [self.us.len(), self.vs.len()];
        let [end, next] = if far { [counts[axis] - 1, counts[axis] - 2] } else { [0, 1] };
        let index = |row: usize, k: usize| {
            if axis == 0 { row * counts[1] + k } else { k * counts[1] + row }
        };
        let along = 0..counts[1 - axis];
        let inside = along.clone().map(|k| heights[index(next, k)]);
        let (low, high) = inside.fold((0.0f64, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        if along.clone().any(|k| heights[index(end, k)].abs() > epsilon)
            || low < -epsilon
            || high <= epsilon
        {
            return None;
        }
        let points: Vec<Vec3> = along.clone().map(|k| self.points[index(end, k)]).collect();
        let long: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let place = |k: usize| {
            if axis == 0 { [self.us[end], self.vs[k]] } else { [self.us[k], self.vs[end]] }
        };
        let uv = along.map(place).collect();
        (long > epsilon).then_some(Contour { points, uv, closed: false })
    }

    fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        self.surface.jet(T::from(u), T::from(v), Order::Zero).p.re()
    }

    fn cells(&self, (i, j, along_u): GridEdge) -> Vec<(usize, usize)> {
        let (nu, nv) = (self.us.len() - 1, self.vs.len() - 1);
        let before =
            if along_u { (Some(i), j.checked_sub(1)) } else { (i.checked_sub(1), Some(j)) };
        let mut cells = Vec::with_capacity(2);
        if i < nu && j < nv {
            cells.push((i, j));
        }
        if let (Some(i), Some(j)) = before
            && i < nu
            && j < nv
        {
            cells.push((i, j));
        }
        cells
    }

    fn chains(
        &self,
        crossings: &BTreeMap<GridEdge, [f64; 2]>,
        links: BTreeMap<GridEdge, Vec<GridEdge>>,
        epsilon: f64,
    ) -> Vec<Contour> {
        let mut seen = BTreeSet::new();
        let mut lines = Vec::new();
        let ends = links.iter().filter(|(_, l)| l.len() == 1).map(|(&e, _)| e);
        let starts: Vec<GridEdge> = ends.chain(links.keys().copied()).collect();
        for start in starts {
            if !seen.insert(start) {
                continue;
            }
            let mut chain = vec![start];
            let mut at = start;
            while let Some(&next) = links[&at].iter().find(|&e| seen.insert(*e)) {
                chain.push(next);
                at = next;
            }
            let mut uv: Vec<[f64; 2]> = chain.iter().map(|e| crossings[e]).collect();
            let mut points: Vec<Vec3> = uv.iter().map(|&at| self.point(at)).collect();
            let closed = chain.len() > 2 && links[&start].len() == 2 && links[&at].contains(&start);
            // A line may be along a pole: one point of it is enough.
            let mut kept = vec![true; points.len()];
            for k in 1..points.len() {
                kept[k] = points[k].distance(points[k - 1]) > epsilon;
            }
            let (mut at_point, mut at_place) = (kept.iter(), kept.iter());
            points.retain(|_| at_point.next() == Some(&true));
            uv.retain(|_| at_place.next() == Some(&true));
            if points.len() > 1 {
                lines.push(Contour { points, uv, closed });
            }
        }
        lines
    }
}

/// The lines in which the member `value` of a family cuts the triangles of a body.
pub fn body_section<T: Real>(body: &TriangleBody<T>, family: &Family<T>, value: T) -> Vec<Contour> {
    let mut builder = TopologyBuilder::new();
    let faces = body.triangles.iter().map(|&[a, b, c]| [a, b, c, c]);
    let built = builder
        .add_vertices(body.points.len())
        .and_then(|_| builder.add_faces(PatchInfo::new(""), faces));
    let mesh = built.and_then(|_| {
        Mesh::new(builder.build().into(), body.points.iter().map(|p| p.re()).collect())
    });
    let Ok(mesh) = mesh else { return Vec::new() };
    let lines = section_where(
        &mesh,
        |p| family.height(value, Vec3::lifted(p)).re(),
        |p| family.holds(value, Vec3::lifted(p)),
    );
    let line =
        |l: moldloft_mesh::Polyline| Contour { points: l.points, uv: Vec::new(), closed: l.closed };
    lines.into_iter().map(line).collect()
}

/// The root between `low` and `high`; the end that is nearer to one when rounding hides it.
fn root(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    find_root(&f, low, high).unwrap_or_else(
        |_| {
            if f(low).abs() <= f(high).abs() { low } else { high }
        },
    )
}
