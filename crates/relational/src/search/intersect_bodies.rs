//! The intersection of two bodies of several faces: the intersections of pairs of faces, end to end.

use super::cut::{CutView, Second};
use super::intersect_snake::{CutRequest, IntersectionFields, set_up};
use crate::curve::CompositeCurve;
use moldloft_locate::march::{Branch, BranchEnd, Crossing, Other};
use moldloft_locate::{PlainSurface, nearest_on_surface};
use moldloft_num::trace::Trace;
use moldloft_num::{Order, Real, Surface, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, Kind, Point, SearchReport, SearchStatus, SurfaceRef, Value,
};
use std::sync::Arc;

/// The intersection of two bodies, each a list of surfaces side by side: one curve from face to face, the same on
/// both bodies. Its parameter is the fraction of its length, its joints are on the edges of the faces.
///
/// `IntSnake(face, x)` is the part of the intersection `x` on one of the faces; patches there share its vertices with those of the
/// other body. Where `x` returns to a face, a magnet on the face selects the nearest part. Of several curves, `near` selects the
/// nearest to a point, by default to the middle of the first face; the others are reported. The curve begins with the first
/// pair of faces in the order of the lists, in the direction n1 x n2 of their normals.
///
/// Faces of a body meet in common edges: pieces that end in one point, within the tolerance of the model, continue each
/// other. The curve is open where a body is.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel faces1 faces2",
    example = "AbsPoint A(0, -2, -2); AbsPoint B(0, 2, -2); AbsPoint C(0, -2, 2); AbsPoint D(0, 2, 2); \
               Line ab(A, B); Line cd(C, D); RuledSurf wall(ab, cd, visible = 0); \
               AbsPoint P(-1, -1, -1); AbsPoint Q(-1, 1, -1); AbsPoint R(-1, 0, 1); \
               AbsPoint S(2, -1, -1); AbsPoint T(2, 1, -1); AbsPoint U(2, 0, 1); \
               Line p(P, S); Line q(Q, T); Line r(R, U); \
               RuledSurf f1(p, q, visible = 0); RuledSurf f2(q, r, visible = 0); RuledSurf f3(r, p, visible = 0); \
               BodyIntersection x({f1, f2, f3}, {wall}); IntSnake hole(wall, x); IntSnake rim(f1, x); \
               TrimSurf plate(wall, {hole}, whole = 1); EdgeSnake far(2, f1); SubSurf tube({rim, far});"
)]
pub struct BodyIntersection<T: Real> {
    /// The faces of one body.
    #[field(min_items = 1)]
    faces1: Vec<SurfaceRef<T>>,
    /// The faces of the other.
    #[field(min_items = 1)]
    faces2: Vec<SurfaceRef<T>>,
    /// A point near the intended curve.
    near: Option<Point<T>>,
}

impl<T: Real> BodyIntersection<T> {
    const FIELDS: IntersectionFields =
        IntersectionFields { target: Self::FACES2, ends: [(Self::FACES2, "start"); 2] };
}

impl<T: Real> Build<T> for BodyIntersection<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let bodies = [self.faces1, self.faces2];
        let mut segments = segments(&bodies, Self::FIELDS)?;
        continued(&bodies, &mut segments, context.tolerance)
            .map_err(|fault| fault.in_field(Self::FACES2))?;
        let chains =
            chains(&segments, context.tolerance).map_err(|fault| fault.in_field(Self::FACES2))?;
        let middle = || bodies[0][0].jet(T::from(0.5), T::from(0.5), Order::Zero).p.re();
        let by_point = self.near.is_some();
        let near = self.near.map_or_else(middle, |point| point.xyz.re());
        let away = |chain: &CutChain| {
            let stations =
                chain.links.iter().flat_map(|link| &segments[link.segment].branch.stations);
            stations.map(|s| s.x.distance(near)).fold(f64::INFINITY, f64::min)
        };
        let chosen =
            (0..chains.len()).min_by(|&a, &b| away(&chains[a]).total_cmp(&away(&chains[b])));
        let Some(chosen) = chosen else {
            return Err(CallError::new("no-intersection", "the bodies do not meet")
                .expected("faces that cross")
                .found("no two faces with a common curve")
                .help("move or lengthen one of the bodies")
                .in_field(Self::FACES2));
        };
        let report = report(&segments, &chains, chosen, by_point);
        let made = ChainedCuts::of(&bodies, &segments, &chains[chosen], Self::FIELDS, context)?;
        let mut curve = CurveRef::new(made.curve(None, made.all()), context.nesting);
        curve.snakes = made.snakes(&bodies, context).into();
        Ok(Value::Curve(curve.with_found(report)))
    }
}

/// An intersection of a face of one body with one of the other.
struct FaceCut {
    /// The numbers of the faces.
    faces: [usize; 2],
    branch: Branch,
}

impl FaceCut {
    fn end(&self, k: usize) -> Vec3 {
        let stations = &self.branch.stations;
        stations[if k == 0 { 0 } else { stations.len() - 1 }].x
    }
}

fn crossing<'a, T: Real>(
    first: &'a PlainSurface<'a, T>,
    second: &'a super::cut::PlainSecond<'a, T>,
) -> Crossing<'a> {
    match second.other() {
        Other::Surface(surface) => Crossing::with_surface(first, surface),
        _ => unreachable!("faces are surfaces"),
    }
}

/// The intersections of all pairs of faces.
fn segments<T: Real>(
    bodies: &[Vec<SurfaceRef<T>>; 2],
    fields: IntersectionFields,
) -> Result<Vec<FaceCut>, CallError> {
    let mut segments = Vec::new();
    for (i, face) in bodies[0].iter().enumerate() {
        let first = PlainSurface(&**face);
        for (j, other) in bodies[1].iter().enumerate() {
            let second = Second::Surface(other.clone());
            let plain = second.plain();
            let found = crossing(&first, &plain).branches();
            if !found.complete {
                return Err(CallError::new(
                    "search-unfinished",
                    "the search for the intersection of two faces reached its limit",
                )
                .expected("faces that do not run along each other")
                .found("faces that coincide or touch along a line")
                .help("move one of the bodies until they cross")
                .related(face.key, "is one face")
                .related(other.key, "is the other")
                .in_item(j)
                .in_field(fields.target));
            }
            segments
                .extend(found.branches.into_iter().map(|branch| FaceCut { faces: [i, j], branch }));
        }
    }
    Ok(segments)
}

/// Adds the segments, shorter than those that a search claims to find, that continue others across an edge of a face.
fn continued<T: Real>(
    bodies: &[Vec<SurfaceRef<T>>; 2],
    segments: &mut Vec<FaceCut>,
    tolerance: f64,
) -> Result<(), CallError> {
    let mut at = 0;
    while at < segments.len() {
        for k in [0, 1] {
            let x = segments[at].end(k);
            let BranchEnd::Edge { unknown, .. } = segments[at].branch.ends[k] else { continue };
            let met = segments.iter().enumerate().any(|(n, s)| {
                [0, 1].iter().any(|&j| (n, j) != (at, k) && s.end(j).distance(x) <= tolerance)
            });
            if met {
                continue;
            }
            let side = unknown / 2;
            let own = segments[at].faces;
            let beside: Vec<Option<FaceCut>> = (0..bodies[side].len())
                .filter(|number| *number != own[side])
                .filter_map(|number| {
                    let mut faces = own;
                    faces[side] = number;
                    through(bodies, faces, x, tolerance)
                })
                .collect();
            // Without a face beyond the edge the body is open there.
            let missing = !beside.is_empty();
            match beside.into_iter().flatten().next() {
                Some(segment) => segments.push(segment),
                None if missing => {
                    return Err(CallError::new(
                        "search-unfinished",
                        "the intersection ends at an edge between two faces",
                    )
                    .expected("faces that cross on both sides of the edge")
                    .found(format!("an end at ({:.6}, {:.6}, {:.6})", x.x, x.y, x.z))
                    .help("move one of the bodies until the edge crosses the other"));
                }
                None => {}
            }
        }
        at += 1;
    }
    Ok(())
}

/// The intersection of two faces that ends at a point; `None` if a face is not there, and an inner `None` if there is no
/// intersection.
fn through<T: Real>(
    bodies: &[Vec<SurfaceRef<T>>; 2],
    faces: [usize; 2],
    x: Vec3,
    tolerance: f64,
) -> Option<Option<FaceCut>> {
    let first = PlainSurface(&*bodies[0][faces[0]]);
    let second = Second::Surface(bodies[1][faces[1]].clone());
    let plain = second.plain();
    let crossing = crossing(&first, &plain);
    let Other::Surface(other) = crossing.other else { return None };
    let [[u, v], [p, r]] = [crossing.first, other].map(|s| nearest_on_surface(s, x, None).at);
    let there =
        |s: &dyn Surface<f64>, u: f64, v: f64| s.jet(u, v, Order::Zero).p.distance(x) <= tolerance;
    if !there(crossing.first, u, v) || !there(other, p, r) {
        return None;
    }
    let found = crossing.near([u, v], Some([p, r])).and_then(|q| crossing.branch(q));
    let found = found.filter(|branch| branch.stations.len() > 1);
    let found = found.map(|branch| FaceCut { faces, branch });
    Some(found.filter(|s| [0, 1].iter().any(|&k| s.end(k).distance(x) <= tolerance)))
}

/// A segment in a chain, forwards or backwards.
#[derive(Clone, Copy)]
struct CutLink {
    segment: usize,
    backwards: bool,
}

/// Segments end to end.
struct CutChain {
    links: Vec<CutLink>,
    closed: bool,
}

/// The chains of segments whose ends are one point within `tolerance`.
fn chains(segments: &[FaceCut], tolerance: f64) -> Result<Vec<CutChain>, CallError> {
    // Ends 2 k and 2 k + 1 are those of segment k.
    let ends: Vec<Vec3> = segments.iter().flat_map(|s| [s.end(0), s.end(1)]).collect();
    let mut next = vec![None; ends.len()];
    for (e, x) in ends.iter().enumerate() {
        if segments[e / 2].branch.closed() {
            continue;
        }
        let meets = |&o: &usize| {
            o != e && !segments[o / 2].branch.closed() && ends[o].distance(*x) <= tolerance
        };
        let mut others = (0..ends.len()).filter(meets);
        next[e] = others.next();
        if others.next().is_some() {
            return Err(CallError::new(
                "tangent-contact",
                "an edge of one body meets an edge of the other",
            )
            .expected("faces that cross, two at each edge")
            .found(format!(
                "more than two pieces of the intersection at ({:.6}, {:.6}, {:.6})",
                x.x, x.y, x.z
            ))
            .help("move one of the bodies, or join the intersections of the faces by PolyCurve"));
        }
    }
    let mut used = vec![false; segments.len()];
    let mut all = Vec::new();
    for start in 0..segments.len() {
        if used[start] {
            continue;
        }
        let follow = |from: usize, used: &mut Vec<bool>| {
            // `from` is the end at which the walk leaves a segment.
            let mut links = Vec::new();
            let mut at = next[from];
            while let Some(enter) = at.filter(|e| !used[e / 2]) {
                used[enter / 2] = true;
                links.push(CutLink { segment: enter / 2, backwards: enter % 2 == 1 });
                at = next[enter ^ 1];
            }
            (links, at.is_some())
        };
        used[start] = true;
        let first = CutLink { segment: start, backwards: false };
        let (ahead, returned) = follow(2 * start + 1, &mut used);
        let (behind, _) = follow(2 * start, &mut used);
        let before = behind.iter().rev().map(|l| CutLink { backwards: !l.backwards, ..*l });
        let links = before.chain([first]).chain(ahead).collect();
        all.push(CutChain { links, closed: returned || segments[start].branch.closed() });
    }
    Ok(all)
}

/// The report about the chosen one of all chains, with positions in space.
fn report(
    segments: &[FaceCut],
    chains: &[CutChain],
    chosen: usize,
    by_point: bool,
) -> SearchReport {
    let place = |chain: &CutChain| {
        let link = chain.links[chain.links.len() / 2];
        let stations = &segments[link.segment].branch.stations;
        stations[stations.len() / 2].x
    };
    let last = place(&chains[chosen]);
    let others = chains.iter().enumerate().filter(|(k, _)| *k != chosen);
    let alternatives: Vec<(Vec<f64>, Vec3)> =
        others.map(|(_, chain)| place(chain)).map(|x| (x.to_array().to_vec(), x)).collect();
    let status = if by_point || alternatives.is_empty() {
        SearchStatus::Ok
    } else {
        let next = alternatives.iter().map(|(_, x)| x.distance(last)).fold(f64::INFINITY, f64::min);
        SearchStatus::Multiple { count: chains.len(), chosen, next }
    };
    SearchReport {
        status,
        residual: 0.0,
        iterations: chains[chosen].links.len() as u32,
        start: Vec::new(),
        last: last.to_array().to_vec(),
        alternatives,
        advice: "to choose another curve, give a point near it as `near`",
    }
}

/// The intersections along a chain, and the fractions of the length at their ends.
struct ChainedCuts<T: Real> {
    views: Vec<CutView<T>>,
    faces: Vec<[usize; 2]>,
    ends: Vec<T>,
    closed: bool,
    depth: u32,
}

/// Pieces of a chain: the first, and how many; beyond the last one follows the first.
type Run = (usize, usize);

impl<T: Real> ChainedCuts<T> {
    fn of(
        bodies: &[Vec<SurfaceRef<T>>; 2],
        segments: &[FaceCut],
        chain: &CutChain,
        fields: IntersectionFields,
        context: &Context,
    ) -> Result<Self, CallError> {
        let mut views = Vec::new();
        let mut faces = Vec::new();
        let mut lengths = vec![T::zero()];
        for link in &chain.links {
            let segment = &segments[link.segment];
            let [first, second] = [0, 1].map(|side| bodies[side][segment.faces[side]].clone());
            let request = CutRequest::of_pair(first, Second::Surface(second), fields);
            let plain = request.second.plain();
            let own = PlainSurface(&*request.first);
            let cut = set_up(&request, &crossing(&own, &plain), segment.branch.clone(), context)?;
            lengths.push(lengths[lengths.len() - 1] + cut.total);
            views.push(CutView {
                cut: Arc::new(cut),
                side: 0,
                backwards: link.backwards,
                trace: Trace::own(),
                snake: false,
            });
            faces.push(segment.faces);
        }
        let total = lengths[lengths.len() - 1];
        let mut ends: Vec<T> = lengths.into_iter().map(|s| s / total).collect();
        if let Some(last) = ends.last_mut() {
            *last = T::one();
        }
        Ok(Self { views, faces, ends, closed: chain.closed, depth: context.nesting })
    }

    fn all(&self) -> Run {
        (0, self.views.len())
    }

    /// The parameter at the begin of piece `k`, which may be beyond the last.
    fn begin(&self, k: usize) -> T {
        let count = self.views.len();
        self.ends[k % count] + (k / count) as f64
    }

    /// A run in space, or on the faces of one body.
    fn curve(&self, side: Option<usize>, (first, count): Run) -> CompositeCurve<T> {
        let [from, to] = [self.begin(first), self.begin(first + count)];
        let mut ends: Vec<T> =
            (first..=first + count).map(|k| (self.begin(k) - from) / (to - from)).collect();
        ends[count] = T::one();
        let piece = |k: usize| {
            let view = &self.views[k % self.views.len()];
            match side {
                None => CurveRef::new(view.clone(), self.depth),
                Some(side) => {
                    let view = CutView { side, snake: true, ..view.clone() };
                    let surface = view.surface().clone();
                    CurveRef::snake(view, surface, self.depth)
                }
            }
        };
        let curves = (first..first + count).map(piece).collect();
        let closed = self.closed && count == self.views.len();
        CompositeCurve { curves, ends, trace: Trace::own(), closed }
    }

    /// The runs on each face, as snakes that know which part of the curve they are.
    fn snakes(&self, bodies: &[Vec<SurfaceRef<T>>; 2], context: &Context) -> Vec<CurveRef<T>> {
        let whole = CurveRef::new(self.curve(None, self.all()), context.nesting);
        let mut snakes = Vec::new();
        for (side, faces) in bodies.iter().enumerate() {
            for (number, face) in faces.iter().enumerate() {
                for run in self.runs(|faces| faces[side] == number) {
                    let mut snake =
                        CurveRef::snake(self.curve(Some(side), run), face.clone(), context.nesting);
                    let part = [self.begin(run.0), self.begin(run.0 + run.1)];
                    snake.part_of = Some(Arc::new((whole.clone(), part)));
                    snakes.push(snake);
                }
            }
        }
        snakes
    }

    /// The longest runs of pieces on a face.
    fn runs(&self, on_face: impl Fn(&[usize; 2]) -> bool) -> Vec<Run> {
        let count = self.views.len();
        let on: Vec<bool> = self.faces.iter().map(on_face).collect();
        if on.iter().all(|on| *on) {
            return vec![(0, count)];
        }
        let before = |k: usize| {
            if k > 0 { on[k - 1] } else { self.closed && on[count - 1] }
        };
        let reach = if self.closed { 2 * count } else { count };
        let run = |first: usize| (first, (first..reach).take_while(|k| on[k % count]).count());
        (0..count).filter(|&k| on[k] && !before(k)).map(run).collect()
    }
}
