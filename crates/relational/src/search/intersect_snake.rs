//! Intersections of a surface with a plane, another surface or a field.
//!
//! An intersection is one curve ([`Cut`]), of two surfaces in the order of their declaration; a snake is a view of it
//! on one of them.

use super::arguments::{Onto, Target};
use super::branch_ends::{cut_open, place_at, turn_to_start};
use super::branch_order::BranchNumber;
use super::cut::{Both, Cut, CutJet, CutView, Second};
use super::outcome::no_intersection;
use super::pieces::{PieceEnd, at_seam, fitted, laid};
use crate::alias::AliasCurve;
use crate::arguments::Magnet;
use moldloft_locate::implicit::{Implicit, refined, solve};
use moldloft_locate::march::{Branch, BranchEnd, Crossing, Other, TracePoint, Unknowns};
use moldloft_locate::{LocateReport, LocateStatus, PlainSurface};
use moldloft_num::trace::{Key, Mark, Root, Trace};
use moldloft_num::{Jet, Order, Plane, Real, Surface, Vec3, slope_scale};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Point, SearchReport, SearchStatus,
    SurfaceRef, Value,
};
use std::sync::Arc;

/// The intersection of two surfaces, or of a surface with a plane or the zero set of a field: one
/// curve, the same on either surface. Its parameter is the fraction of its length.
///
/// `IntSnake(a, x)` is the intersection `x` as a snake on its surface `a`. The snakes on both surfaces
/// are `x` itself from end to end, so panels on both sides share its vertices. A body of several surfaces
/// side by side is one `PolySurf`.
///
/// A magnet selects the branch nearest to it; a surface, the branch nearest to the middle of the
/// parameters of the surface declared first. Other branches are reported. `branch = {1, 2}` is the first of two branches
/// in the order along u of the surface that is given first (`along = "v"`: along v), at all values of the parameters:
/// where there is another number of branches, or another one beside it, an error says so. The direction is n1 x n2, the product of both
/// normals. The curve extends from edge to edge, or from the magnet `start` to the magnet `end`, each on either
/// surface and on the intersection, which keep their identity, so that patches join. A closed branch begins at
/// the point nearest to the magnet or, without one, to S(0.3, 0.4) of the surface declared first. Each point
/// is on both shapes to rounding.
///
/// All branches are found that are longer than 2 % of the size and somewhere cross at an angle
/// larger than the shapes turn within that length; of two branches closer than that all along, one
/// may be missed. Shapes that only touch have no intersection.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel surface target start end",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m, visible = 0); AbsPoint E(2, -1, -2); \
               AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); Line n(E, F); Line o(G, H); \
               RuledSurf T(n, o, visible = 0); Intersection x(S, T); IntSnake a(S, x); IntSnake b(T, x); \
               EdgeSnake hem(4, S); EdgeSnake rim(3, T); SubSurf half({hem, a}); SubSurf web({b, rim}); \
               AbsBead p(x, 0.5); XPlane y(1); Intersection c(S, y);"
)]
pub struct Intersection<T: Real> {
    /// The surface, or a magnet on it near the intended branch.
    surface: Onto<T>,
    /// The plane, the other surface (or a magnet on it), or the field with the zero set.
    target: Target<T>,
    /// Start: a magnet or ring on the intersection. Default: the start of the branch.
    start: Option<Magnet<T>>,
    /// End.
    end: Option<Magnet<T>>,
    /// With a plane: selects the parallel plane through this point.
    point: Option<Point<T>>,
    /// The branch as {number, count}: its number in the order along a parameter of the surface that is given first, and the number
    /// of all branches.
    branch: Option<Vec<usize>>,
    /// The parameter of that order, "u" or "v".
    along: Option<Arc<str>>,
}

impl<T: Real> Build<T> for Intersection<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, target, start, end, point, branch, along } = self;
        let number = BranchNumber::of(branch, along, [Self::BRANCH, Self::ALONG])?;
        let select = BranchSelection { ends: [start, end], point, number };
        let found = cut(&surface, target, select, Self::FIELDS, context)?;
        let in_space = CutView { snake: false, ..found.view(0) };
        let mut curve = CurveRef::new(in_space, context.nesting).with_found(found.report.clone());
        let sides = if found.cut.both.second.surface().is_some() { 2 } else { 1 };
        curve.snakes = (0..sides).map(|side| found.snake(side, context)).collect();
        Ok(Value::Curve(curve))
    }
}

/// The intersection of a surface with a plane, another surface or the zero set of a field, as a
/// snake on the surface: [`Intersection`] on one of its surfaces.
///
/// `IntSnake(a, x)` is the intersection `x` on its surface `a`. Otherwise the arguments are those of the
/// intersection: `IntSnake(a, b)` and `IntSnake(b, a)` are one curve in opposite directions, which patches on both
/// sides share. At the seam of a closed surface the parameter jumps between 0 and 1.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel surface target start end",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); ZPlane z(0.5); IntSnake w(S, z); \
               AbsPoint E(2, -1, -2); AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); \
               Line n(E, F); Line o(G, H); RuledSurf T(n, o); IntSnake x(S, T); \
               IntRing r(x, \"y=0\", {0, 1, 0}); AbsMagnet near(S, 0.5, 0.5); IntSnake y(near, T, start = r);"
)]
pub struct IntSnake<T: Real> {
    /// The surface of the snake, or a magnet on it near the intended branch.
    surface: Onto<T>,
    /// The plane, the other surface (or a magnet on it), the field with the zero set, or an intersection
    /// on the surface.
    target: Target<T>,
    /// Start: a magnet or ring on the intersection. Default: the start of the branch.
    start: Option<Magnet<T>>,
    /// End.
    end: Option<Magnet<T>>,
    /// With a plane: selects the parallel plane through this point.
    point: Option<Point<T>>,
    /// The branch as {number, count}: its number in the order along a parameter of the surface that is given first, and the number
    /// of all branches.
    branch: Option<Vec<usize>>,
    /// The parameter of that order, "u" or "v".
    along: Option<Arc<str>>,
}

impl<T: Real> IntSnake<T> {
    /// The arguments of the two shapes.
    pub const SHAPES: [FieldId; 2] = [Self::SURFACE, Self::TARGET];
}

impl<T: Real> Build<T> for IntSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, target, start, end, point, branch, along: order } = self;
        let number = BranchNumber::of(branch, order, [Self::BRANCH, Self::ALONG])?;
        if let Target::Curve(along) = &target
            && !along.curve.snakes.is_empty()
        {
            let many =
                along.curve.snakes.iter().filter(|s| lies_on(s, &surface.surface)).count() > 1;
            let unused = [
                (surface.start.is_some() && !many || along.start.is_some(), Self::SURFACE),
                (start.is_some(), Self::START),
                (end.is_some(), Self::END),
                (point.is_some(), Self::POINT),
                (number.is_some(), Self::BRANCH),
            ];
            if let Some((_, field)) = unused.into_iter().find(|(given, _)| *given) {
                return Err(CallError::new(
                    "unused-argument",
                    "an intersection has its branch and its ends",
                )
                .expected("a surface and the intersection alone")
                .found("a magnet or a point, too")
                .help("give it to the intersection; `SubSnake` is a part of the snake")
                .in_field(field));
            }
            return on_surface(&along.curve, &surface, Self::SURFACE, context);
        }
        let select = BranchSelection { ends: [start, end], point, number };
        let found = cut(&surface, target, select, Self::FIELDS, context)?;
        let snake = found.snake(0, context);
        Ok(Value::Curve(snake.with_found(found.report)))
    }
}

/// True for a snake on the surface.
fn lies_on<T: Real>(snake: &CurveRef<T>, surface: &SurfaceRef<T>) -> bool {
    snake.surface.as_ref().is_some_and(|own| is_one(own, surface))
}

/// An intersection as a snake on one of its surfaces; a magnet selects one of several parts there.
fn on_surface<T: Real>(
    whole: &CurveRef<T>,
    onto: &Onto<T>,
    field: FieldId,
    context: &Context,
) -> Result<Value<T>, CallError> {
    let surface = &onto.surface;
    let parts: Vec<&CurveRef<T>> =
        whole.snakes.iter().filter(|snake| lies_on(snake, surface)).collect();
    let snake = match (parts.as_slice(), onto.from()) {
        ([], _) => {
            return Err(CallError::new("wrong-surface", "the intersection is not on this surface")
                .expected("one of the surfaces of the intersection")
                .found("another surface")
                .related(whole.key, "is the intersection")
                .related(surface.key, "is the surface")
                .in_field(field));
        }
        ([one], _) => *one,
        (many, None) => {
            return Err(CallError::new(
                "several-parts",
                format!("the intersection has {} parts on this surface", many.len()),
            )
            .expected("a magnet on the surface near one of them")
            .found("the surface")
            .related(whole.key, "is the intersection")
            .in_field(field));
        }
        (many, Some(near)) => {
            let away = |snake: &CurveRef<T>| distance_in_parameters(snake, near);
            let nearest = many.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            *nearest.expect("there are several")
        }
    };
    let pieces = whole.pieces();
    let trace = match (&snake.part_of, whole.key) {
        _ if pieces.is_empty() => Trace::own(),
        (Some(part), Some(key)) => {
            let joints = whole.joints();
            let point = |t: T| match t.re() {
                // A ring begins and ends in one point.
                end if end.fract() == 0.0 && whole.closed() => key.end(0),
                inside => {
                    // Once round, rounding is that of 1.
                    let is_it = |joint: &f64| (joint - inside.fract()).abs() <= f64::EPSILON;
                    key.joint(joints.iter().position(is_it)?)
                }
            };
            let [from, to] = part.1.map(|t| Mark { t, point: point(t) });
            whole.trace().part(Root::Curve(key), from, to)
        }
        _ => Trace::Pieces(pieces),
    };
    let nesting = context.nesting.max(whole.depth);
    let curve = AliasCurve { curve: snake.clone(), trace };
    Ok(Value::Curve(CurveRef::snake(curve, surface.clone(), nesting)))
}

/// Number of points of a snake that are compared with a magnet.
const COMPARED_POINTS: usize = 33;

/// The distance of a snake from a point in the parameter plane, approximately.
fn distance_in_parameters<T: Real>(snake: &CurveRef<T>, [u, v]: [f64; 2]) -> f64 {
    let places = (0..COMPARED_POINTS).map(|k| k as f64 / (COMPARED_POINTS - 1) as f64);
    let away = |t: f64| {
        let [w, ..] = snake.on_surface(T::from(t), Order::Zero)?;
        Some((w - Vec3::of(u, v, 0.0)).re().norm())
    };
    places.filter_map(away).fold(f64::INFINITY, f64::min)
}

/// True for one surface: of one name, or the same shape without a name.
fn is_one<T: Real>(a: &SurfaceRef<T>, b: &SurfaceRef<T>) -> bool {
    if a.key.is_some() || b.key.is_some() { a.key == b.key } else { a.same(b) }
}

/// The fields that an intersection may fail for, and the words for its ends.
#[derive(Clone, Copy)]
pub(super) struct IntersectionFields {
    pub target: FieldId,
    pub ends: [(FieldId, &'static str); 2],
}

impl<T: Real> IntSnake<T> {
    const FIELDS: IntersectionFields = IntersectionFields {
        target: Self::TARGET,
        ends: [(Self::START, "start"), (Self::END, "end")],
    };
}

impl<T: Real> Intersection<T> {
    const FIELDS: IntersectionFields = IntersectionFields {
        target: Self::TARGET,
        ends: [(Self::START, "start"), (Self::END, "end")],
    };
}

/// A given end of an intersection.
struct CutEnd<T: Real> {
    x: Vec3<T>,
    /// Its surface, 0 or 1 of the cut, and its parameters there.
    side: usize,
    uv: [f64; 2],
    key: Option<Key>,
}

/// An intersection that was found from the surfaces as they are given.
struct FoundCut<T: Real> {
    cut: Arc<Cut<T>>,
    /// True if the surface that is given first is the second of the cut: then the intersection has
    /// the opposite direction.
    swapped: bool,
    trace: Trace<T>,
    report: SearchReport,
}

impl<T: Real> FoundCut<T> {
    /// On the surface that is given first (0) or second (1).
    fn view(&self, given: usize) -> CutView<T> {
        CutView {
            cut: self.cut.clone(),
            side: given ^ usize::from(self.swapped),
            backwards: self.swapped,
            trace: self.trace.clone(),
            snake: true,
        }
    }

    fn snake(&self, given: usize, context: &Context) -> CurveRef<T> {
        let view = self.view(given);
        let surface = view.surface().clone();
        CurveRef::snake(view, surface, context.nesting)
    }
}

/// What selects a branch and a part of it.
struct BranchSelection<T: Real> {
    ends: [Option<Magnet<T>>; 2],
    point: Option<Point<T>>,
    number: Option<BranchNumber>,
}

/// The intersection, from the arguments of both kinds. Two named surfaces are cut in the order of
/// their declaration, in whichever order they are given: there is one curve.
fn cut<T: Real>(
    surface: &Onto<T>,
    target: Target<T>,
    select: BranchSelection<T>,
    fields: IntersectionFields,
    context: &Context,
) -> Result<FoundCut<T>, CallError> {
    let BranchSelection { ends: [start, end], point, number } = select;
    let (second, second_start) = match target {
        Target::Plane(plane) => {
            let point = point.map_or(plane.point, |p| p.xyz);
            (Second::Plane(Plane { point, normal: plane.normal }), None)
        }
        Target::Surface(onto) => {
            let start = onto.start;
            (Second::Surface(onto.surface), start)
        }
        Target::Field(field) => (Second::Field(field), None),
        Target::Curve(_) | Target::Point(_) => {
            return Err(CallError::new(
                "wrong-class",
                "a surface is cut by a plane, a surface or a field",
            )
            .expected("a plane, a surface, a magnet, a field or, for a snake, an intersection")
            .found("a curve or a point")
            .in_field(fields.target));
        }
    };
    let keys = [start.as_ref().and_then(|m| m.key), end.as_ref().and_then(|m| m.key)];
    let mut request = CutRequest {
        starts: [surface.start, second_start],
        number,
        ..CutRequest::of_pair(surface.surface.clone(), second, fields)
    };
    if let Some(number) = number.filter(|_| request.starts.iter().any(Option::is_some)) {
        return Err(number.twice());
    }
    for (k, magnet) in [start, end].into_iter().enumerate() {
        request.ends[k] = magnet.map(|magnet| request.end(magnet, k)).transpose()?;
    }
    request.order();
    let swapped = request.swapped;
    let (cut, report) = traced(request, context)?;
    let trace = match (keys, cut.closed) {
        // A closed snake ends where it begins.
        ([Some(k), None], true) => Trace::Own([Some(k); 2]),
        _ => Trace::Own(keys),
    };
    Ok(FoundCut { cut: Arc::new(cut), swapped, trace, report })
}

/// Two shapes, and what selects a branch of their intersection and its ends.
pub(super) struct CutRequest<T: Real> {
    pub first: SurfaceRef<T>,
    pub second: Second<T>,
    /// The parameters of magnets near the branch, on each surface.
    starts: [Option<[T; 2]>; 2],
    ends: [Option<CutEnd<T>>; 2],
    /// True if the surfaces are in the opposite order to the given one, and so are the ends.
    swapped: bool,
    number: Option<BranchNumber>,
    fields: IntersectionFields,
}

impl<T: Real> CutRequest<T> {
    /// Two shapes in the given order.
    pub fn of_pair(first: SurfaceRef<T>, second: Second<T>, fields: IntersectionFields) -> Self {
        Self {
            first,
            second,
            starts: [None; 2],
            ends: [None, None],
            swapped: false,
            number: None,
            fields,
        }
    }

    /// The end `k` at a magnet on one of the surfaces.
    fn end(&self, magnet: Magnet<T>, k: usize) -> Result<CutEnd<T>, CallError> {
        let surfaces = [Some(&self.first), self.second.surface()];
        let is_it = |surface: &Option<&SurfaceRef<T>>| {
            surface.is_some_and(|surface| is_one(surface, &magnet.surface))
        };
        let Some(side) = surfaces.iter().position(is_it) else {
            return Err(CallError::new("wrong-surface", "the end is on another surface")
                .expected("a magnet or ring of a surface of the intersection")
                .found("one of another surface")
                .related(magnet.key, "is on another surface")
                .related(magnet.surface.key, "is its surface")
                .in_field(self.fields.ends[k].0));
        };
        let [u, v] = magnet.uv;
        let x = magnet.surface.jet(u, v, Order::Zero).p;
        Ok(CutEnd { x, side, uv: magnet.uv.map(|x| x.re()), key: magnet.key })
    }

    /// Exchanges named surfaces that are not in the order of their declaration.
    fn order(&mut self) {
        let Second::Surface(second) = &mut self.second else { return };
        let (Some(a), Some(b)) = (self.first.key, second.key) else { return };
        if b < a {
            std::mem::swap(&mut self.first, second);
            self.starts.swap(0, 1);
            self.ends.swap(0, 1);
            self.fields.ends.swap(0, 1);
            self.ends.iter_mut().flatten().for_each(|end| end.side = 1 - end.side);
            self.swapped = true;
        }
    }

    /// The point that a closed branch without a start begins next to: the magnet or, without one, a point
    /// off the usual symmetries of surfaces, so that it is unique as a rule.
    fn reference(&self) -> Vec3<T> {
        let at = |surface: &SurfaceRef<T>, [u, v]: [T; 2]| surface.jet(u, v, Order::Zero).p;
        match (self.starts, self.second.surface()) {
            ([None, Some(uv)], Some(second)) => at(second, uv),
            ([uv, _], _) => at(&self.first, uv.unwrap_or([0.3, 0.4].map(T::from))),
        }
    }

    /// Parameters from which the branch is searched, on each surface.
    fn seeds(&self, first: &PlainSurface<'_, T>) -> [Option<[f64; 2]>; 2] {
        let end = self.ends.iter().flatten().next();
        let seed = |side: usize| {
            let start = self.starts[side].map(|uv| uv.map(|x| x.re()));
            start.or_else(|| end.filter(|end| end.side == side).map(|end| end.uv))
        };
        let [own, other] = [seed(0), seed(1)];
        let nearest = || {
            let x = match (self.starts[1], end) {
                (None, Some(end)) => end.x.re(),
                _ => self.reference().re(),
            };
            Some(moldloft_locate::nearest_on_surface(first, x, None).at)
        };
        [own.or_else(|| other.and_then(|_| nearest())), other]
    }
}

/// The end of a branch at an edge: unknown `k` stays, the others follow.
struct AtEdge<'a, T: Real> {
    first: &'a SurfaceRef<T>,
    second: &'a SurfaceRef<T>,
    unknown: usize,
    value: f64,
}

impl<T: Real> Implicit<T, 4> for AtEdge<'_, T> {
    fn at<J: Jet<T>>(&self, q: [J; 4], _: J) -> [J; 4] {
        let gap = self.first.at(q[0], q[1]) - self.second.at(q[2], q[3]);
        [gap.x, gap.y, gap.z, q[self.unknown] - self.value]
    }
    fn jacobian(&self, q: [T; 4], _: T) -> [[T; 4]; 4] {
        let j = self.first.jet(q[0], q[1], Order::First);
        let k = self.second.jet(q[2], q[3], Order::First);
        let c = [j.u, j.v, -k.u, -k.v].map(Vec3::to_array);
        let row = |a: usize| [c[0][a], c[1][a], c[2][a], c[3][a]];
        let mut last = [T::zero(); 4];
        last[self.unknown] = T::one();
        [row(0), row(1), row(2), last]
    }
}

/// End of a branch at an edge, with derivatives.
fn edge_point<T: Real>(
    first: &SurfaceRef<T>,
    second: &Second<T>,
    q: Unknowns,
    unknown: usize,
    value: f64,
) -> Option<Vec3<T>> {
    match second {
        Second::Plane(_) | Second::Field(_) => {
            // One unknown is left.
            let [u, v] = [T::from(q[0]), T::from(q[1])];
            let j = first.jet(u, v, Order::First);
            let (rest, normal) = match second {
                Second::Plane(plane) => (plane.distance(j.p), plane.normal),
                Second::Field(field) => field.value_and_gradient(j.p),
                Second::Surface(_) => return None,
            };
            let along = if unknown == 0 { j.v } else { j.u };
            let slope = normal.re().dot(along.re());
            let [step] = solve(&[[T::from(slope)]], [rest - rest.re()])?;
            Some(j.p - along.map(|x| T::from(x.re())) * step)
        }
        Second::Surface(surface) => {
            let system = AtEdge { first, second: surface, unknown, value };
            let [u, v, ..] = refined(&system, q, T::zero())?;
            Some(first.jet(u, v, Order::Zero).p)
        }
    }
}

fn touching(x: Vec3) -> CallError {
    CallError::new("tangent-contact", "the shapes touch without crossing: no intersection curve")
        .expected("shapes that cross at an angle")
        .found(format!("a touch at ({:.6}, {:.6}, {:.6})", x.x, x.y, x.z))
        .help("move one of them until they cross")
}

fn lost(why: &str) -> CallError {
    CallError::new("tangent-contact", "the intersection cannot be followed: the shapes touch there")
        .expected("shapes that cross at an angle all along")
        .found(why.to_owned())
        .help("move one of them, or give `start` and `end` before the point of contact")
}

/// Follows the intersection and sets it up.
fn traced<T: Real>(
    request: CutRequest<T>,
    context: &Context,
) -> Result<(Cut<T>, SearchReport), CallError> {
    let (first, second, fields) = (&request.first, &request.second, request.fields);
    let plain = PlainSurface(&**first);
    let plain_second = second.plain();
    let crossing = match plain_second.other() {
        Other::Plane(plane) => Crossing::with_plane(&plain, plane),
        Other::Surface(surface) => Crossing::with_surface(&plain, surface),
        Other::Level(field) => Crossing::with_level(&plain, field),
    };
    let seeds = request.seeds(&plain);
    // The parameters that a report states are those of the surface that is given first.
    let given = usize::from(request.swapped);
    let report_at = |q: &Unknowns| vec![q[2 * given], q[2 * given + 1]];
    let by_magnet = seeds[0].filter(|_| request.number.is_none());
    let seed = by_magnet.and_then(|uv| crossing.near(uv, seeds[1]));
    let mut status = SearchStatus::Ok;
    let mut alternatives = Vec::new();
    let branch = match seed.and_then(|q| crossing.branch(q)) {
        Some(branch) => branch,
        None => {
            let found = crossing.branches();
            let numbered = request.number.map(|n| n.chosen(&found, 2 * given)).transpose()?;
            let mut all = found.branches;
            let from = seeds[0].unwrap_or([0.5, 0.5]);
            let away = |b: &Branch| {
                let d = |q: &Unknowns| (q[0] - from[0]).powi(2) + (q[1] - from[1]).powi(2);
                b.stations.iter().map(|s| d(&s.q)).fold(f64::INFINITY, f64::min)
            };
            let nearest = (0..all.len()).min_by(|&a, &b| away(&all[a]).total_cmp(&away(&all[b])));
            let chosen = numbered.or(nearest);
            let Some(chosen) = chosen else {
                if let Some(touch) = found.touches.first() {
                    return Err(touching(touch.x).in_field(fields.target));
                }
                return Err(apart(&crossing, from, second.name()).in_field(fields.target));
            };
            if numbered.is_some() {
                status = SearchStatus::Ok;
            } else if seeds[0].is_some() {
                status = SearchStatus::Fallback;
            } else if all.len() > 1 {
                let middle = |b: &Branch| b.stations[b.stations.len() / 2];
                let own = all[chosen].stations.clone();
                let next = all.iter().enumerate().filter(|(k, _)| *k != chosen);
                let next = next
                    .flat_map(|(_, b)| &b.stations)
                    .map(|s| own.iter().map(|o| o.x.distance(s.x)).fold(f64::INFINITY, f64::min))
                    .fold(f64::INFINITY, f64::min);
                status = SearchStatus::Multiple { count: all.len(), chosen, next };
                let others = all.iter().enumerate().filter(|(k, _)| *k != chosen);
                let middles = others.map(|(_, b)| middle(b));
                alternatives.extend(middles.map(|s| (report_at(&s.q), s.x)));
            }
            all.swap_remove(chosen)
        }
    };
    let begin = if request.swapped { branch.stations.last() } else { branch.stations.first() };
    let last = begin.map_or_else(Vec::new, |s| report_at(&s.q));
    let shape = set_up(&request, &crossing, branch, context)?;
    let found = SearchReport {
        status,
        residual: 0.0,
        iterations: shape.pieces.len() as u32,
        start: seeds[given].map_or_else(|| vec![0.5, 0.5], |uv| uv.to_vec()),
        last,
        alternatives,
        advice: "to choose another branch, give a magnet near it instead of the surface",
    };
    Ok((shape, found))
}

/// The error of shapes that do not meet.
fn apart(crossing: &Crossing<'_>, from: [f64; 2], second: &'static str) -> CallError {
    let x = crossing.first.jet(from[0], from[1], Order::Zero).p;
    let residual = match crossing.other {
        Other::Plane(plane) => plane.distance(x).abs(),
        Other::Level(field) => {
            let (f, g) = field.value_and_gradient(x);
            (f * slope_scale(g)).abs()
        }
        Other::Surface(s) => {
            let [p, r] = moldloft_locate::nearest_on_surface(s, x, None).at;
            s.jet(p, r, Order::Zero).p.distance(x)
        }
    };
    let report = LocateReport {
        status: LocateStatus::NoSolution,
        residual,
        iterations: 0,
        start: from.into_iter().collect(),
        last: from.into_iter().collect(),
        alternatives: Vec::new(),
    };
    no_intersection(&report, "surface", second)
}

/// The error of a closed branch with an end alone.
fn no_start(field: FieldId) -> CallError {
    CallError::new("missing-argument", "a closed branch with an end needs a start")
        .expected("a magnet or ring where it starts")
        .found("an end only")
        .in_field(field)
}

/// The error of a magnet that is not on the branch.
fn open_end((field, which): (FieldId, &str), key: Option<Key>, tolerance: f64) -> CallError {
    CallError::new("open-end", format!("the {which} is not on the intersection"))
        .expected(format!("a magnet within {tolerance:e} of it"))
        .found("a magnet away from it")
        .help("make it by IntRing, IntMagnet or IntBead with the same surface or plane")
        .related(key, "is the magnet")
        .in_field(field)
}

/// Begin of a cut as parameters change.
enum CutBegin<T> {
    /// At the ends, where they are known.
    Ends([Option<Vec3<T>>; 2]),
    /// Of a closed cut: in the plane through a point across a direction.
    AcrossPlane(Vec3<T>, Vec3),
    /// Of a closed cut: at the point nearest to another.
    Nearest(Vec3<T>),
}

impl<T: Real> CutBegin<T> {
    /// Distances of the cut's ends beyond those of its pieces, as far as they depend on parameters;
    /// `at_end` returns the first (0) or the last (1) point of the pieces.
    fn offsets(&self, at_end: impl Fn(usize, Order) -> Option<CutJet<T>>) -> Option<[T; 2]> {
        let mut offsets = [T::zero(); 2];
        match *self {
            Self::Ends(places) => {
                for (k, place) in places.iter().enumerate() {
                    let Some(place) = place else { continue };
                    let end = at_end(k, Order::First)?;
                    let along = Vec3::lifted(end.tangent.re()).dot(*place - end.x);
                    offsets[k] = along - along.re();
                }
            }
            Self::AcrossPlane(x, d) => {
                // The branch begins where it crosses the plane d . (X - x) = 0.
                let level = Vec3::lifted(d).dot(at_end(0, Order::First)?.x - x);
                offsets = [(level - level.re()) * (-1.0 / d.dot(d)); 2];
            }
            Self::Nearest(m) => {
                // The branch begins where (X - M) . T is zero; the derivative of this with respect
                // to the length is 1 + (X - M) . k with the curvature k.
                let end = at_end(0, Order::Second)?;
                let away = end.x - m;
                let slope = 1.0 + away.re().dot(end.curvature.re());
                if slope.abs() > 1e-9 {
                    let level = away.dot(end.tangent);
                    offsets = [(level - level.re()) * (-1.0 / slope); 2];
                }
            }
        }
        Some(offsets)
    }
}

/// Cuts the branch to its ends, gives it its length as parameter, with derivatives.
pub(super) fn set_up<T: Real>(
    request: &CutRequest<T>,
    crossing: &Crossing<'_>,
    mut branch: Branch,
    context: &Context,
) -> Result<Cut<T>, CallError> {
    let (first, second, fields) = (&request.first, &request.second, request.fields);
    let reference = request.reference();
    let mut ends = request.ends.each_ref().map(Option::as_ref);
    let mut places = [None, None];
    for (k, end) in ends.iter().enumerate() {
        let Some(end) = end else { continue };
        let place = place_at(crossing, &branch, end.x.re(), context.tolerance);
        places[k] =
            Some(place.ok_or_else(|| open_end(fields.ends[k], end.key, context.tolerance))?);
    }
    let closed = branch.closed();
    // The given start is the end of the opposite direction.
    let start = usize::from(request.swapped);
    if closed && places[start].is_none() && places[1 - start].is_some() {
        return Err(no_start(fields.ends[start].0));
    }
    if closed && places[0].is_none() {
        ends.swap(0, 1);
        places.swap(0, 1);
    }
    let whole = closed && places[1].is_none();
    // A closed branch from a seam to the seam, where it may have a corner.
    let at_seam_start = if closed {
        turn_to_start(crossing, &mut branch, places, reference.re())
    } else {
        cut_open(&mut branch, places);
        false
    };
    for (k, end) in branch.ends.iter().enumerate() {
        let given = places[k].is_some();
        if !given && matches!(end, BranchEnd::Tangent | BranchEnd::Lost) {
            return Err(lost("a point where they are tangent").in_field(fields.target));
        }
    }
    let stops = with_joints(first, second, crossing, &branch);
    // The ends, with derivatives.
    let at_joint = |q: &Unknowns, (unknown, value): (usize, f64)| {
        edge_point(first, second, *q, unknown, value)
    };
    let end_place = |k: usize| -> Option<Vec3<T>> {
        let station = [stops.first(), stops.last()][k]?.station;
        if let Some(end) = ends[if at_seam_start { 0 } else { k }] {
            return Some(end.x);
        }
        if whole {
            return None;
        }
        match branch.ends[k] {
            BranchEnd::Edge { unknown, value } => at_joint(&station.q, (unknown, value)),
            _ => Some(Vec3::lifted(station.x)),
        }
    };
    let places = [end_place(0), end_place(1)];
    let begin = match ends[0] {
        Some(end) if whole && !at_seam_start => {
            CutBegin::AcrossPlane(end.x, stops[0].station.tangent)
        }
        None if whole => CutBegin::Nearest(reference),
        _ => CutBegin::Ends(places),
    };
    let failed = || lost("a point where they are nearly tangent").in_field(fields.target);
    let fits = fitted(crossing, &stops).ok_or_else(failed)?;
    let both = Both { first: first.clone(), second: second.clone() };
    let mut pieces = Vec::with_capacity(fits.len());
    let mut sum = T::zero();
    for fit in &fits {
        let piece = laid(&both, fit, sum, at_joint).ok_or_else(failed)?;
        sum += piece.length;
        pieces.push(piece);
    }
    let (Some(head), Some(tail)) = (pieces.first(), pieces.last()) else { return Err(failed()) };
    let at_end = |k: usize, order: Order| -> Option<CutJet<T>> {
        let (piece, stop, y) =
            if k == 0 { (head, stops[0], -1.0) } else { (tail, stops[stops.len() - 1], 1.0) };
        let q = both.unknowns(&piece.guide, stop.station.q, T::from(y))?;
        both.along(q, stop.station.tangent, order)
    };
    let offsets = begin.offsets(at_end).ok_or_else(failed)?;
    for piece in &mut pieces {
        piece.begin -= offsets[0];
    }
    let total = sum + offsets[1] - offsets[0];
    let on_edges = [0, 1].map(|k| match branch.ends[k] {
        BranchEnd::Edge { unknown, value } if ends[k].is_none() => Some((unknown, value)),
        _ => None,
    });
    Ok(Cut { both, pieces, total, size: crossing.size, closed: whole, on_edges })
}

/// Stations within this fraction of the distance to the next are moved onto a joint.
const NEAR_JOINT: f64 = 0.1;

/// The stations of a branch, with others at the joints of the surfaces between them, so that pieces
/// are smooth.
fn with_joints<T: Real>(
    first: &SurfaceRef<T>,
    second: &Second<T>,
    crossing: &Crossing<'_>,
    branch: &Branch,
) -> Vec<PieceEnd> {
    let mut lines: Vec<(usize, f64)> = Vec::new();
    let mut add = |at: usize, [us, vs]: [Vec<f64>; 2]| {
        lines.extend(us.into_iter().map(|x| (at, x)));
        lines.extend(vs.into_iter().map(|x| (at + 1, x)));
    };
    add(0, first.joints());
    if let Second::Surface(surface) = second {
        add(2, surface.joints());
    }
    let mut stops = vec![PieceEnd::from(branch.stations[0])];
    let count = branch.stations.len();
    for (i, pair) in branch.stations.windows(2).enumerate() {
        let (a, b) = (&pair[0], &pair[1]);
        let mut next = Some(PieceEnd::from(*b));
        let mut between: Vec<(f64, usize, f64)> = lines
            .iter()
            .filter(|(k, x)| (a.q[*k] - x) * (b.q[*k] - x) < 0.0 && !at_seam(a, b))
            .map(|&(k, x)| ((x - a.q[k]) / (b.q[k] - a.q[k]), k, x))
            .collect();
        between.sort_by(|p, q| p.0.total_cmp(&q.0));
        for (share, k, x) in between {
            let guess = std::array::from_fn(|i| a.q[i] + share * (b.q[i] - a.q[i]));
            let Some(mut s) = crossing.at_line(guess, k, x).and_then(|q| crossing.station(q))
            else {
                continue;
            };
            if s.tangent.dot(a.tangent) < 0.0 {
                s.tangent = -s.tangent;
                s.rate = s.rate.map(|r| -r);
            }
            let chord = a.x.distance(b.x);
            let (after, before) = ((s.x - a.x).dot(a.tangent), (b.x - s.x).dot(a.tangent));
            let ahead = |stop: &PieceEnd| (s.x - stop.station.x).dot(a.tangent);
            if after < -1e-9 * chord || before < -1e-9 * chord {
                continue;
            }
            let stop = PieceEnd { station: s, joint: Some((k, x)) };
            // Stations very near to it are removed, except ends and other joints.
            let tiny = 1e-7 * crossing.size;
            let last = stops.len() - 1;
            let movable = last > 0
                && stops[last].joint.is_none()
                && !at_seam(&stops[last].station, &stops[last - 1].station);
            if movable && ahead(&stops[last]) < NEAR_JOINT * chord {
                stops[last] = stop;
            } else if ahead(&stops[last]) > tiny && before > tiny {
                stops.push(stop);
            } else {
                continue;
            }
            let seam_next = i + 2 < count && at_seam(b, &branch.stations[i + 2]);
            if before < NEAR_JOINT * chord && i + 2 < count && !seam_next {
                next = None;
            }
        }
        stops.extend(next);
    }
    // A station may be at a joint already; a branch along one does not cross it.
    for stop in stops.iter_mut().filter(|stop| stop.joint.is_none()) {
        let TracePoint { q, rate, .. } = stop.station;
        let crosses = |&&(k, x): &&(usize, f64)| {
            (q[k] - x).abs() <= 1e-12 && rate[k].abs() * crossing.size > 1e-3
        };
        stop.joint = lines.iter().find(crosses).copied();
    }
    stops
}
