//! Parts of surfaces within loops of snakes, as triangles whose borders divide as their neighbours do.

use crate::arguments::{Snake, common_surface};
use crate::curve::Segment;
use crate::snake::{OnSurface, edge_trace};
use crate::surface::trim_measures::{BorderLens, measured};
use moldloft_mesh::planar_triangles;
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{
    Border, BorderCurve, Build, CallError, Context, CurveRef, Kind, SheetMeasures, SurfaceRef,
    TriangleBody, TriangulatedBorder, Value,
};
use std::sync::Arc;

/// The part of a surface within loops of snakes on it, as triangles.
///
/// Snakes that follow one another make a loop; one may run backwards, and a closed snake is a loop by
/// itself. The first loop is the outer one and the others are holes in it; with `whole = 1` the outer
/// one is the boundary of the surface and all loops are holes. The interior contains points of the surface's
/// own nu x nv divisions that are not too near the border; the triangles between are Delaunay's (in
/// parameters scaled to lengths). All vertices are on the surface.
///
/// Along its snakes, and with `whole = 1` along the surface's edges, it joins its neighbours: patches,
/// fillets and other trimmed surfaces whose edges run along the same snakes have its vertices there,
/// by identity. Divisions flow over such edges from the one to the other; `rim` states those of each
/// snake, and a contradiction is reported.
///
/// Where a sub-surface serves (`SubSurf`: two, three or four sides), prefer it: it has a net of panels.
#[derive(Kind)]
#[kind(
    class = Mesh,
    columns = "surface loops",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 3, 0); \
               AbsPoint E(4, 3, 1); BCurve l({A, B, C}); Line m(D, E); \
               RuledSurf S(l, m, visible = 0); AbsMagnet p(S, 0.5, 0.45); AbsMagnet q(S, 0.71, 0.45); AbsMagnet r(S, 0.5, 0.7); \
               ArcSnake round(q, p, r, type = 6); AbsMagnet a(S, 0.1, 0.15); AbsMagnet b(S, 0.95, 0.2); \
               AbsMagnet c(S, 0.8, 0.93); LineSnake ab(a, b); LineSnake cb(c, b); LineSnake ca(c, a); \
               TrimSurf window(S, {round}, whole = 1); \
               TrimSurf part(S, {ab, cb, ca}, visible = 0);"
)]
pub struct TrimSurf<T: Real> {
    /// The surface that is trimmed.
    surface: SurfaceRef<T>,
    /// Snakes on it, loop after loop.
    #[field(min_items = 1)]
    loops: Vec<Snake<T>>,
    /// 1 when the whole surface is kept but for holes.
    #[field(default = 0, min = 0, max = 1)]
    whole: u32,
    /// Divisions of each snake. Not given: as its neighbours have them, or 12.
    #[field(min = 1, max = 10_000)]
    rim: Option<usize>,
    /// Divisions along u of the surface's grid inside the border.
    #[field(default = 12, min = 1, max = 1000)]
    nu: usize,
    /// Divisions of the surface along v.
    #[field(default = 12, min = 1, max = 1000)]
    nv: usize,
}

/// How far apart, in u or v, ends that should meet may be.
const MEETING: f64 = 1e-6;

/// Points inside keep this share of the smallest step of the net from the rim.
const MARGIN: f64 = 0.35;

impl<T: Real> Build<T> for TrimSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, loops, whole, rim, nu, nv } = self;
        let mut items = vec![(surface.key, &surface)];
        items.extend(loops.iter().map(|s| (s.curve.key, &s.surface)));
        common_surface(&items, |fault, k| {
            fault.in_item(k.saturating_sub(1)).in_field(Self::LOOPS)
        })?;
        let mut hems = Vec::new();
        let mut cycles = Vec::new();
        if whole == 1 {
            let hem = |k: usize, n: usize| {
                let snake = edge(&surface, k, context.nesting);
                BorderCurve { curve: snake, stated: None, usual: n as u32 }
            };
            hems.extend([hem(0, nu), hem(1, nv), hem(2, nu), hem(3, nv)]);
            cycles.push(vec![(0, false), (1, false), (2, true), (3, true)]);
        }
        let before = hems.len();
        for cycle in chained(&loops)? {
            cycles.push(cycle.into_iter().map(|(k, back)| (k + before, back)).collect());
        }
        let usual = rim.unwrap_or(DEFAULT_DIVISIONS) as u32;
        let stated = rim.map(|n| n as u32);
        hems.extend(loops.into_iter().map(|s| BorderCurve { curve: s.curve, stated, usual }));
        let trimmed = Trimmed { scale: scale(&surface), surface, hems, cycles, inside: [nu, nv] };
        let even = |n: u32| (0..=n).map(|k| T::from(f64::from(k) / f64::from(n))).collect();
        let at: Vec<Vec<T>> = trimmed.hems.iter().map(|hem| even(hem.usual)).collect();
        let (mut facets, _) = trimmed.facets(&at)?;
        facets.border = Some(Border(Arc::new(trimmed)));
        Ok(Value::Body(Arc::new(facets)))
    }
}

/// Divisions of a snake when nothing else determines them.
const DEFAULT_DIVISIONS: usize = 12;

/// Edge `k` of a surface as a snake without a name.
fn edge<T: Real>(surface: &SurfaceRef<T>, k: usize, nesting: u32) -> CurveRef<T> {
    let ends = [
        [(0.0, 0.0), (1.0, 0.0)],
        [(1.0, 0.0), (1.0, 1.0)],
        [(0.0, 1.0), (1.0, 1.0)],
        [(0.0, 0.0), (0.0, 1.0)],
    ];
    let [from, to] = ends[k].map(|(u, v)| Vec3::of(u, v, 0.0));
    let trace = edge_trace(surface, k);
    let shape = OnSurface { surface: surface.clone(), path: Segment { from, to }, trace };
    CurveRef::snake(shape, surface.clone(), nesting)
}

/// A surface and what is kept of it.
struct Trimmed<T: Real> {
    surface: SurfaceRef<T>,
    hems: Vec<BorderCurve<T>>,
    /// The hems of each loop in order, and whether each runs against it.
    cycles: Vec<Vec<(usize, bool)>>,
    scale: [f64; 2],
    /// The net whose points stand inside.
    inside: [usize; 2],
}

impl<T: Real> TriangulatedBorder<T> for Trimmed<T> {
    fn surface(&self) -> &SurfaceRef<T> {
        &self.surface
    }

    fn cycles(&self) -> &[Vec<(usize, bool)>] {
        &self.cycles
    }

    fn curves(&self) -> &[BorderCurve<T>] {
        &self.hems
    }

    fn divided(&self, at: &[Vec<T>]) -> Option<(TriangleBody<T>, Vec<Vec<u32>>)> {
        self.facets(at).ok()
    }

    fn measures(&self) -> Option<SheetMeasures<T>> {
        let even = |n: u32| (0..=n).map(|k| T::from(f64::from(k) / f64::from(n))).collect();
        let at: Vec<Vec<T>> = self.hems.iter().map(|hem| even(hem.usual)).collect();
        let (region, turned, _) = self.region(&at).ok()?;
        let (places, triangles) = region.net(self.inside);
        let triangles: Vec<[Place<T>; 3]> =
            triangles.into_iter().map(|t| t.map(|k| places[k])).collect();
        let mut lenses = Vec::new();
        for (cycle, turned) in self.cycles.iter().zip(turned) {
            for &(hem, backwards) in cycle {
                for w in at[hem].windows(2) {
                    let [from, to] = if backwards != turned { [w[1], w[0]] } else { [w[0], w[1]] };
                    lenses.push(BorderLens { snake: &self.hems[hem].curve, from, to });
                }
            }
        }
        Some(measured(&self.surface, &triangles, &lenses))
    }
}

impl<T: Real> Trimmed<T> {
    /// The triangles with vertices at these parameters of the hems, and which these vertices are.
    fn facets(&self, at: &[Vec<T>]) -> Result<(TriangleBody<T>, Vec<Vec<u32>>), CallError> {
        let (region, turned, mut rims) = self.region(at)?;
        // What was turned round is counted from its other end.
        let mut first = 0;
        for (cycle, turned) in self.cycles.iter().zip(turned) {
            let total: usize = cycle.iter().map(|&(hem, _)| at[hem].len() - 1).sum();
            if turned {
                for &(hem, _) in cycle {
                    rims[hem].iter_mut().for_each(|v| *v = (2 * first + total - 1) as u32 - *v);
                }
            }
            first += total;
        }
        Ok((region.facets(&self.surface, self.inside), rims))
    }

    /// The region within these vertices of the hems, which of its loops were turned round for it, and the numbers of
    /// the vertices.
    fn region(&self, at: &[Vec<T>]) -> Result<DividedRegion<T>, CallError> {
        let mut rims: Vec<Vec<u32>> = at.iter().map(|ts| vec![0; ts.len()]).collect();
        let mut first = 0;
        let mut cycles = Vec::with_capacity(self.cycles.len());
        for cycle in &self.cycles {
            let mut places: Vec<Place<T>> = Vec::new();
            let total: usize = cycle.iter().map(|&(hem, _)| at[hem].len() - 1).sum();
            if total < 3 {
                return Err(CallError::new("gap", "a loop needs an area")
                    .expected("three vertices or more")
                    .found(total.to_string())
                    .help("give the snakes more divisions")
                    .in_field(TrimSurf::<T>::LOOPS));
            }
            for &(hem, backwards) in cycle {
                let n = at[hem].len() - 1;
                for i in 0..=n {
                    let k = if backwards { n - i } else { i };
                    // The last is the first of what comes next.
                    rims[hem][k] = (first + places.len() % total) as u32;
                    if i < n {
                        let curve = &self.hems[hem].curve;
                        let path = curve.on_surface(at[hem][k], Order::Zero);
                        let [w, ..] = path.expect("a snake knows its place on its surface");
                        places.push([w.x, w.y]);
                    }
                }
            }
            first += total;
            cycles.push(places);
        }
        let (region, turned) = TrimRegion::new(cycles, self.scale)?;
        Ok((region, turned, rims))
    }
}

/// A region, which of its loops were turned round, and the vertices of each hem.
type DividedRegion<T> = (TrimRegion<T>, Vec<bool>, Vec<Vec<u32>>);

/// A place of the parameter plane.
type Place<T> = [T; 2];

/// The mean lengths of S_u and S_v.
fn scale<T: Real>(surface: &SurfaceRef<T>) -> [f64; 2] {
    let at = [0.1, 0.3, 0.5, 0.7, 0.9];
    let mut sums = [0.0f64; 2];
    for (u, v) in at.into_iter().flat_map(|u| at.map(|v| (u, v))) {
        let jet = surface.jet(T::from(u), T::from(v), Order::First);
        sums[0] += jet.u.re().norm();
        sums[1] += jet.v.re().norm();
    }
    // A surface without extent in one direction is not stretched.
    sums.map(|s| if s > 0.0 && s.is_finite() { s / 25.0 } else { 1.0 })
}

/// The snakes of each loop in order, and whether each runs against it.
fn chained<T: Real>(snakes: &[Snake<T>]) -> Result<Vec<Vec<(usize, bool)>>, CallError> {
    let place = |s: &Snake<T>, t: f64| {
        let [w, ..] = s.path(T::from(t), Order::Zero);
        [w.x, w.y]
    };
    let meet = |a: Place<T>, b: Place<T>| {
        (a[0].re() - b[0].re()).abs().max((a[1].re() - b[1].re()).abs()) <= MEETING
    };
    let gap = |k: usize, text: String, a: Place<T>, b: Place<T>| {
        let says = |p: Place<T>| format!("(u, v) = ({}, {})", p[0].re(), p[1].re());
        Err(CallError::new("gap", text)
            .expected("snakes that follow one another until they close")
            .found(format!("{} and {}", says(a), says(b)))
            .help("let neighbouring snakes begin and end in common magnets")
            .related(snakes[k].curve.key, "ends there")
            .in_item(k)
            .in_field(TrimSurf::<T>::LOOPS))
    };
    let mut cycles = Vec::new();
    // The loop so far, where it began and where it has come to.
    let mut open: Option<(Vec<(usize, bool)>, Place<T>, Place<T>)> = None;
    for (k, snake) in snakes.iter().enumerate() {
        let [from, to] = [place(snake, 0.0), place(snake, 1.0)];
        let backwards = match &open {
            Some((_, _, at)) if meet(*at, from) => false,
            Some((_, _, at)) if meet(*at, to) => true,
            Some((_, _, at)) => {
                let text = format!("snake {} does not start where snake {k} ends", k + 1);
                return gap(k, text, *at, from);
            }
            // The first of a loop runs so that it ends where the next one goes on.
            None => match snakes.get(k + 1).filter(|_| !meet(from, to)) {
                Some(next) => {
                    let ends = [place(next, 0.0), place(next, 1.0)];
                    !ends.iter().any(|e| meet(*e, to)) && ends.iter().any(|e| meet(*e, from))
                }
                None => false,
            },
        };
        let (from, to) = if backwards { (to, from) } else { (from, to) };
        let (mut cycle, start) = match open.take() {
            Some((cycle, start, _)) => (cycle, start),
            None => (Vec::new(), from),
        };
        cycle.push((k, backwards));
        if meet(to, start) {
            cycles.push(cycle);
        } else {
            open = Some((cycle, start, to));
        }
    }
    match open {
        None => Ok(cycles),
        Some((_, start, at)) => {
            gap(snakes.len() - 1, "the last loop does not close".into(), at, start)
        }
    }
}

/// A region of the parameter plane.
struct TrimRegion<T> {
    /// The outer loop counter-clockwise, the holes clockwise.
    cycles: Vec<Vec<Place<T>>>,
    scale: [f64; 2],
}

/// A place in lengths.
fn flat<T: Real>(p: &Place<T>, scale: [f64; 2]) -> [f64; 2] {
    [p[0].re() * scale[0], p[1].re() * scale[1]]
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Twice the area of a polygon.
fn area(polygon: &[[f64; 2]]) -> f64 {
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    (0..polygon.len()).map(|k| polygon[k][0] * next(k)[1] - polygon[k][1] * next(k)[0]).sum()
}

/// True for a place within a polygon (by the rule of odd crossings).
fn within(polygon: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut inside = false;
    for k in 0..polygon.len() {
        let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        if (a[1] > p[1]) != (b[1] > p[1]) {
            let x = a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            inside ^= p[0] < x;
        }
    }
    inside
}

/// The distance of a place from a segment.
fn distance(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let size = dx * dx + dy * dy;
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = if size > 0.0 { (along / size).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
    (x * x + y * y).sqrt()
}

impl<T: Real> TrimRegion<T> {
    /// The region within loops, and which of them were turned round for it.
    fn new(
        mut cycles: Vec<Vec<Place<T>>>,
        scale: [f64; 2],
    ) -> Result<(Self, Vec<bool>), CallError> {
        let mut reversed = Vec::with_capacity(cycles.len());
        let flat_of = |cycle: &[Place<T>]| -> Vec<[f64; 2]> {
            cycle.iter().map(|p| flat(p, scale)).collect()
        };
        for (k, cycle) in cycles.iter_mut().enumerate() {
            let turned = area(&flat_of(cycle)) < 0.0;
            let turn = turned == (k == 0);
            if turn {
                cycle.reverse();
            }
            reversed.push(turn);
        }
        let polygons: Vec<Vec<[f64; 2]>> = cycles.iter().map(|c| flat_of(c)).collect();
        let fault = |message: String, found: String| {
            Err(CallError::new("crossed-loops", message)
                .expected("loops that neither cross themselves nor others, all inside the first")
                .found(found)
                .help(
                    "move the snakes apart; give the outer loop first, or whole = 1 for holes only",
                )
                .in_field(TrimSurf::<T>::LOOPS))
        };
        for (k, polygon) in polygons.iter().enumerate().skip(1) {
            if let Some(p) = polygon.iter().find(|p| !within(&polygons[0], **p)) {
                let at = format!("(u, v) = ({}, {})", p[0] / scale[0], p[1] / scale[1]);
                return fault(format!("loop {} is not inside the outer one", k + 1), at);
            }
        }
        let sides: Vec<(usize, [f64; 2], [f64; 2])> = polygons
            .iter()
            .enumerate()
            .flat_map(|(c, p)| (0..p.len()).map(move |k| (c, p[k], p[(k + 1) % p.len()])))
            .collect();
        for (i, &(c, a, b)) in sides.iter().enumerate() {
            for &(d, p, q) in &sides[i + 1..] {
                let crosses =
                    cross(a, b, p) * cross(a, b, q) < 0.0 && cross(p, q, a) * cross(p, q, b) < 0.0;
                if crosses {
                    let at = format!("(u, v) = ({}, {})", a[0] / scale[0], a[1] / scale[1]);
                    let what = if c == d { "itself".into() } else { format!("loop {}", d + 1) };
                    return fault(format!("loop {} crosses {what}", c + 1), format!("near {at}"));
                }
            }
        }
        Ok((Self { cycles, scale }, reversed))
    }

    /// Places of the region and triangles between them, the border's first.
    fn net(&self, [nu, nv]: [usize; 2]) -> (Vec<Place<T>>, Vec<[usize; 3]>) {
        let mut places: Vec<Place<T>> = Vec::new();
        let mut loops: Vec<Vec<usize>> = Vec::new();
        for cycle in &self.cycles {
            loops.push((places.len()..places.len() + cycle.len()).collect());
            places.extend(cycle);
        }
        let mut points: Vec<[f64; 2]> = places.iter().map(|p| flat(p, self.scale)).collect();
        let margin = MARGIN * (self.scale[0] / nu as f64).min(self.scale[1] / nv as f64);
        let side = |l: &Vec<usize>, k: usize| (points[l[k]], points[l[(k + 1) % l.len()]]);
        let sides: Vec<_> =
            loops.iter().flat_map(|l| (0..l.len()).map(move |k| side(l, k))).collect();
        let polygons: Vec<Vec<[f64; 2]>> =
            loops.iter().map(|l| l.iter().map(|&k| points[k]).collect()).collect();
        let rim = points.len();
        let mut inner = Vec::new();
        for (i, j) in (0..=nu).flat_map(|i| (0..=nv).map(move |j| (i, j))) {
            let (u, v) = (i as f64 / nu as f64, j as f64 / nv as f64);
            let p = [u * self.scale[0], v * self.scale[1]];
            let kept = within(&polygons[0], p)
                && !polygons[1..].iter().any(|hole| within(hole, p))
                && sides.iter().all(|&(a, b)| distance(a, b, p) >= margin);
            if kept {
                places.push([T::from(u), T::from(v)]);
                inner.push(p);
            }
        }
        points.extend(inner);
        let triangles = planar_triangles(&points, &loops, &(rim..points.len()).collect::<Vec<_>>());
        (places, triangles)
    }

    fn facets(&self, surface: &SurfaceRef<T>, inside: [usize; 2]) -> TriangleBody<T> {
        let (places, triangles) = self.net(inside);
        let xyz: Vec<Vec3<T>> =
            places.iter().map(|&[u, v]| surface.jet(u, v, Order::Zero).p).collect();
        let triangles = triangles.into_iter().map(|t| t.map(|k| k as u32)).collect();
        let mut facets = TriangleBody::new(xyz, triangles);
        // It is a sheet: its middle is that of its area, its volume that of the cone from the origin.
        let (mut moment, mut size) = (Vec3::zero(), T::zero());
        let mut volume = T::zero();
        for t in &facets.triangles {
            let [a, b, c] = t.map(|k| facets.points[k as usize]);
            let share = (b - a).cross(c - a).norm();
            moment += (a + b + c) * (share / 3.0);
            size += share;
            volume += a.cross(b).dot(c) / 6.0;
        }
        facets.of_triangles.volume = volume;
        if size.re() > 0.0 {
            facets.of_triangles.centroid = moment / size;
        }
        facets
    }
}
