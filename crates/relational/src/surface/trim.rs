//! Parts of surfaces bounded by loops of snakes, as triangles with the divisions of their
//! neighbours on the border.

use crate::arguments::{Snake, common_surface};
use crate::curve::Segment;
use crate::snake::{OnSurface, edge_trace};
use crate::surface::trim_density::rim_density;
use crate::surface::trim_measures::{LoopCurve, measured};
use crate::surface::trim_region::{Place, TrimPlane, TrimRegion};
use moldloft_num::{Fineness, Order, Real, Vec3};
use moldloft_registry::{
    Border, BorderCurve, Build, CallError, Context, CurveRef, Kind, SheetMeasures, SurfaceRef,
    TriangleBody, TriangulatedBorder, Value,
};
use std::sync::{Arc, OnceLock};

/// The part of a surface within loops of snakes on it, as triangles.
///
/// Consecutive snakes form a loop, in either direction; a closed snake is a loop on its own. The
/// first loop is the outer one, the others are holes; with `whole = 1` the boundary of the surface
/// is the outer loop and all given loops are holes. All vertices are on the surface. Without stated
/// divisions the border is divided by its own curvature and the interior by the surface's, until
/// the area of the triangles is within 1e-3 of that of the surface; a larger difference is a
/// warning. With `nu` or `nv` the interior contains points of the surface's own nu x nv divisions
/// at some distance from the border. The triangulation is Delaunay's, in parameters scaled to
/// lengths or by curvature.
///
/// Along its snakes, and with `whole = 1` along the surface's edges, it joins its neighbours:
/// patches, fillets and other trimmed surfaces whose edges follow the same snakes share its
/// vertices by identity. Derivatives of vertices are at fixed parameters of their divisions. Divisions propagate across such edges; `rim` states those of each snake,
/// and a contradiction is reported.
///
/// For two, three or four sides prefer `SubSurf`, which has a net of panels.
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
    /// 1 when the whole surface is kept except for holes.
    #[field(default = 0, min = 0, max = 1)]
    whole: u32,
    /// Divisions of each snake; default: by its curvature and that of the surface, with the
    /// neighbours' as a minimum.
    #[field(min = 1, max = 10_000)]
    rim: Option<usize>,
    /// Divisions along u of the surface's grid inside the border; default: by the curvature of the
    /// surface.
    #[field(min = 1, max = 1000)]
    nu: Option<usize>,
    /// Divisions of the surface along v.
    #[field(min = 1, max = 1000)]
    nv: Option<usize>,
}

/// Maximum distance in u or v between adjacent ends.
pub(crate) const MEETING: f64 = 1e-6;

/// Maximum relative difference between the area of the triangles and that of the surface, without
/// stated divisions.
const AREA_PROMISE: f64 = 1e-3;

/// The turn along a panel, in radians, at first. A panel of turn h loses h^2 / 24 of an area and, on a tube, h^2 / 6 of
/// its volume: both are below 1e-3.
const TURN: f64 = 0.07;

/// The longest side of a panel is this part of the part's greater extent.
const SIDES: f64 = 12.0;

/// Divisions of the surface along u or v where only the others are stated.
const DIVISIONS: usize = 12;

/// Maximum number of reductions of the turn until the area is right.
const MAX_ROUNDS: usize = 6;

/// A finer interior that leaves more than this part of the missed area is not worth its triangles.
const WORTHWHILE: f64 = 0.8;

/// Maximum number of points in the box of a part that is divided by curvature alone, and of one
/// with a given fineness.
const MOST_POINTS: usize = 50_000;
const MOST_FINE_POINTS: usize = 2_000_000;

impl<T: Real> Build<T> for TrimSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, loops, whole, rim, nu, nv } = self;
        let mut items = vec![(surface.key, &surface)];
        items.extend(loops.iter().map(|s| (s.curve.key, &s.surface)));
        common_surface(&items, |fault, k| {
            fault.in_item(k.saturating_sub(1)).in_field(Self::LOOPS)
        })?;
        let inside = (nu.is_some() || nv.is_some())
            .then(|| [nu.unwrap_or(DIVISIONS), nv.unwrap_or(DIVISIONS)]);
        // The surface's own edges, then the snakes: each with its divisions where they are stated.
        let mut curves: Vec<(CurveRef<T>, Option<usize>, Option<usize>)> = Vec::new();
        let mut cycles = Vec::new();
        if whole == 1 {
            let own = |k: usize| inside.map(|n| n[k % 2]);
            curves.extend((0..4).map(|k| (edge(&surface, k, context.nesting), None, own(k))));
            cycles.push(vec![(0, false), (1, false), (2, true), (3, true)]);
        }
        let before = curves.len();
        for cycle in chained(&loops)? {
            cycles.push(cycle.into_iter().map(|(k, back)| (k + before, back)).collect());
        }
        curves.extend(loops.into_iter().map(|s| (s.curve, rim, rim)));
        let free = inside.is_none() && rim.is_none();
        let mut fineness = fineness(&surface, &curves);
        let mut exact = None;
        for round in 0.. {
            let hems = curves
                .iter()
                .map(|(curve, stated, usual)| hem(&surface, curve, *stated, *usual, fineness));
            let mut trimmed = Trimmed {
                surface: surface.clone(),
                hems: hems.collect(),
                cycles: cycles.clone(),
                inside,
                fineness,
                most_points: MOST_POINTS,
                promised: free.then_some(AREA_PROMISE),
                exact: exact.clone().unwrap_or_default(),
            };
            trimmed.close_loops();
            let at: Vec<Vec<T>> = trimmed.hems.iter().map(divisions).collect();
            let last = !free || round + 1 == MAX_ROUNDS;
            let mut facets = match trimmed.facets(&at, &fineness) {
                Ok((facets, _)) => facets,
                // Coarse rims may cross where the curves do not.
                Err(fault) if last => return Err(fault),
                Err(_) => {
                    fineness.angle *= 0.5;
                    continue;
                }
            };
            if let Some(missed) = trimmed.missed(&facets)
                && !last
                && facets.triangles.len() < MOST_POINTS
            {
                fineness.angle *= finer(missed);
                exact = Some(trimmed.exact.clone());
                continue;
            }
            facets.border = Some(Border(Arc::new(trimmed)));
            return Ok(Value::Body(Arc::new(facets)));
        }
        unreachable!("the last round returns")
    }
}

/// The factor of the turn by which triangles that miss so much of the area come to the promise.
fn finer(missed: f64) -> f64 {
    (0.8 * AREA_PROMISE / missed).sqrt().clamp(0.25, 0.8)
}

/// Accuracy of the panels for given curves.
fn fineness<T: Real>(
    surface: &SurfaceRef<T>,
    curves: &[(CurveRef<T>, Option<usize>, Option<usize>)],
) -> Fineness {
    let (mut low, mut high) =
        (Vec3::of(1.0, 1.0, 0.0) * f64::INFINITY, Vec3::of(-1.0, -1.0, 0.0) * f64::INFINITY);
    for (curve, ..) in curves {
        for i in 0..=16 {
            let path = curve.on_surface(T::from(f64::from(i) / 16.0), Order::Zero);
            let [w, ..] = path.expect("a snake knows its place on its surface");
            let w = w.re();
            low = Vec3::of(low.x.min(w.x), low.y.min(w.y), 0.0);
            high = Vec3::of(high.x.max(w.x), high.y.max(w.y), 0.0);
        }
    }
    let (mut along_u, mut along_v) = (0.0f64, 0.0f64);
    let shares = [0.1, 0.3, 0.5, 0.7, 0.9];
    for (a, b) in shares.into_iter().flat_map(|a| shares.map(|b| (a, b))) {
        let at = [low.x + (high.x - low.x) * a, low.y + (high.y - low.y) * b].map(T::from);
        let jet = surface.jet(at[0], at[1], Order::First);
        along_u = along_u.max(jet.u.re().norm() * (high.x - low.x));
        along_v = along_v.max(jet.v.re().norm() * (high.y - low.y));
    }
    let reach = along_u.max(along_v);
    let side = if reach > 0.0 && reach.is_finite() { reach / SIDES } else { f64::INFINITY };
    Fineness { angle: TURN, chord: f64::INFINITY, side }
}

/// A curve of the border and its divisions: those that are stated, else those that it usually has, else by curvature.
fn hem<T: Real>(
    surface: &SurfaceRef<T>,
    curve: &CurveRef<T>,
    stated: Option<usize>,
    usual: Option<usize>,
    fineness: Fineness,
) -> BorderCurve<T> {
    let stated = stated.map(|n| n as u32);
    let curve = curve.clone();
    match usual {
        Some(n) => BorderCurve { curve, stated, usual: n as u32, density: None },
        None => {
            let density = Arc::new(rim_density(&fineness, surface, &curve));
            BorderCurve { curve, stated, usual: density.count(), density: Some(density) }
        }
    }
}

fn divisions<T: Real>(hem: &BorderCurve<T>) -> Vec<T> {
    hem.divisions().into_iter().map(T::from).collect()
}

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

/// A surface with its trimmed region.
struct Trimmed<T: Real> {
    surface: SurfaceRef<T>,
    hems: Vec<BorderCurve<T>>,
    /// The hems of each loop in order; true for those in the opposite direction.
    cycles: Vec<Vec<(usize, bool)>>,
    /// Divisions of the surface's net whose points are inside; `None`: by curvature.
    inside: Option<[usize; 2]>,
    fineness: Fineness,
    most_points: usize,
    /// The promise of [`TriangulatedBorder::promised`].
    promised: Option<f64>,
    /// Its measures and an estimate of their error, computed on first use.
    exact: OnceLock<Option<(SheetMeasures<T>, f64)>>,
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
        let mut fineness = self.fineness;
        let (mut made, mut rims) = self.facets(at, &fineness).ok()?;
        // The vertices of the border are given: only the interior can be finer.
        while let Some(missed) = self.missed(&made)
            && made.triangles.len() < MOST_POINTS
        {
            fineness.angle *= finer(missed);
            let Ok((next, next_rims)) = self.facets(at, &fineness) else { break };
            if self.missed(&next).is_some_and(|m| m > WORTHWHILE * missed) {
                break;
            }
            (made, rims) = (next, next_rims);
        }
        Some((made, rims))
    }

    fn promised(&self) -> Option<f64> {
        self.promised
    }

    fn measures(&self) -> Option<SheetMeasures<T>> {
        Some(self.exact()?.0)
    }

    fn within(&self, fineness: &Fineness) -> Result<Border<T>, CallError> {
        let hems = self.hems.iter().map(|h| hem(&self.surface, &h.curve, None, None, *fineness));
        let mut finer = Self {
            surface: self.surface.clone(),
            hems: hems.collect(),
            cycles: self.cycles.clone(),
            inside: None,
            fineness: *fineness,
            most_points: MOST_FINE_POINTS,
            promised: None,
            exact: self.exact.clone(),
        };
        finer.close_loops();
        let at: Vec<Vec<T>> = finer.hems.iter().map(divisions).collect();
        let (cycles, ..) = finer.loops(&at)?;
        let points = TrimPlane::points(&finer.surface, &cycles, fineness);
        if points > MOST_FINE_POINTS as f64 {
            return Err(CallError::new(
                "too-many-panels",
                "a part of a surface takes too many triangles",
            )
            .expected(format!("at most {MOST_FINE_POINTS} points in its box"))
            .found(format!("{points:.3e} points in the box"))
            .help("a larger tolerance or angle, or parts without folds"));
        }
        Ok(Border(Arc::new(finer)))
    }
}

impl<T: Real> Trimmed<T> {
    /// Gives a loop of few divisions as many as make it a loop.
    fn close_loops(&mut self) {
        for cycle in &self.cycles {
            let total: u32 = cycle.iter().map(|&(hem, _)| self.hems[hem].usual).sum();
            for &(hem, _) in cycle.iter().filter(|_| total < 3) {
                let hem = &mut self.hems[hem];
                if hem.density.is_some() {
                    hem.usual = 3;
                }
            }
        }
    }

    /// Its measures, and an estimate of the relative error of the area.
    fn exact(&self) -> Option<(SheetMeasures<T>, f64)> {
        *self.exact.get_or_init(|| {
            let at: Vec<Vec<T>> = self.hems.iter().map(divisions).collect();
            let (_, turned, _) = self.loops(&at).ok()?;
            let cycles = self.cycles.iter().zip(turned);
            let loops: Vec<LoopCurve<T>> = cycles
                .flat_map(|(cycle, turned)| {
                    let of = move |&(hem, backwards): &(usize, bool)| LoopCurve {
                        curve: &self.hems[hem].curve,
                        backwards: backwards != turned,
                    };
                    cycle.iter().map(of)
                })
                .collect();
            let (measures, error) = measured(&self.surface, &loops);
            measures.area.is_finite().then_some((measures, error))
        })
    }

    /// The relative difference of area from the surface, if it is beyond the promise.
    fn missed(&self, facets: &TriangleBody<T>) -> Option<f64> {
        let promise = self.promised?;
        let area = self.exact()?.0.area.re();
        let missed = (facets.of_triangles.area.re() - area).abs() / area;
        (missed > promise).then_some(missed)
    }

    /// The triangles with vertices at these parameters of the hems, and which these vertices are.
    fn facets(
        &self,
        at: &[Vec<T>],
        fineness: &Fineness,
    ) -> Result<(TriangleBody<T>, Vec<Vec<u32>>), CallError> {
        let (cycles, turned, mut rims) = self.loops(at)?;
        // Reversed curves are counted from their other end.
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
        let plane = match self.inside {
            Some(net) => TrimPlane::of_net(&self.surface, &cycles, net),
            None => TrimPlane::by_curvature(&self.surface, &cycles, fineness, self.most_points),
        };
        let region = match TrimRegion::new(&cycles, plane) {
            Ok(region) => region,
            // Sides of few vertices may cross only where they are stretched.
            Err(fault) => {
                let plain = TrimPlane::of_net(&self.surface, &cycles, [DIVISIONS; 2]);
                TrimRegion::new(&cycles, plain).map_err(|_| fault)?
            }
        };
        let (inner, triangles) = region.net();
        if triangles.is_empty() {
            return Err(region.crossed("loops touch".into(), "no triangles between them".into()));
        }
        let places = cycles.into_iter().flatten();
        let places = places.chain(inner.into_iter().map(|p| p.map(T::from)));
        let xyz = places.map(|[u, v]| self.surface.jet(u, v, Order::Zero).p).collect();
        Ok((sheet(xyz, triangles), rims))
    }

    /// Parameters of the vertices of each loop (outer loop counter-clockwise, holes clockwise), a
    /// flag for each reversed loop, and the vertex numbers of each hem.
    fn loops(&self, at: &[Vec<T>]) -> Result<DividedLoops<T>, CallError> {
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
                    // The last is the first of the next.
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
        let mut turned = Vec::with_capacity(cycles.len());
        for (k, cycle) in cycles.iter_mut().enumerate() {
            let turn = (area(cycle) < 0.0) == (k == 0);
            if turn {
                cycle.reverse();
            }
            turned.push(turn);
        }
        Ok((cycles, turned, rims))
    }
}

/// Parameters of each loop, a flag for each reversed loop, and the vertices of each hem.
type DividedLoops<T> = (Vec<Vec<Place<T>>>, Vec<bool>, Vec<Vec<u32>>);

/// Twice the area of a polygon of parameters.
fn area<T: Real>(polygon: &[Place<T>]) -> f64 {
    let at = |k: usize| polygon[k % polygon.len()].map(T::re);
    (0..polygon.len()).map(|k| at(k)[0] * at(k + 1)[1] - at(k)[1] * at(k + 1)[0]).sum()
}

/// Triangles as a sheet: its middle is that of its area, its volume that of the cone from the origin.
fn sheet<T: Real>(points: Vec<Vec3<T>>, triangles: Vec<[u32; 3]>) -> TriangleBody<T> {
    let mut facets = TriangleBody::new(points, triangles);
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

/// The snakes of each loop in order; true for those in the opposite direction.
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
    // The open loop: its parts, its start and its end.
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
            // The first snake of a loop is oriented to end where the next one begins.
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
