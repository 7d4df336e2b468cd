//! Parameters of a patch's divisions: along each edge separately, so that points marked by
//! neighbours are among them, and between the edges along straight lines of the parameter square.

use crate::conformal::conform;
use crate::identity::on_part;
use crate::roots::{AliasId, EdgeParameter, MarkSource, on_its_root, pieces};
use crate::topology::PatchTopology;
use moldloft_num::trace::{Edges, Key};
use moldloft_num::{Order, Real, Vec3};
use moldloft_parallel::prelude::*;
use moldloft_registry::{Point, Scalar, SurfaceRef};
use std::ops::Range;
use std::sync::Arc;

/// Number of points of a patch evaluated together.
const PART: usize = 1024;

/// Spacing of the divisions between two stops: ascending fractions, without 0 and 1; `None` for
/// uniform ones.
pub(crate) type Shares = Option<Arc<[f64]>>;

/// A run of divisions along an edge.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DivisionRun {
    /// The edge's parameter where it ends; it begins where the one before does, or at 0.
    pub until: EdgeParameter,
    pub count: u32,
    pub shares: Shares,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EdgePlan {
    /// From 0 to 1 in one stretch.
    Whole(u32, Shares),
    /// Run by run.
    Segments(Vec<DivisionRun>),
    /// As edge 0..4 of the same patch.
    As(u8),
    /// As the same edge of another patch.
    Like(u32),
}

/// Data of a model, for any scalar, that determine the divisions.
pub(crate) trait PatchLookup<T: Real> {
    /// Divisions of the edges of a draft.
    fn plans(&self, draft: u32) -> &[EdgePlan; 4];
    fn edges(&self, draft: u32) -> Option<&Edges<T>>;
    /// The identity of its surface in this graph.
    fn owner(&self, draft: u32) -> Key;
    /// A point object, by its identity in the graph that was planned.
    fn point(&self, key: Key) -> Option<&Point<T>>;
    /// The parameters, on its representative, of the ends of a root with that alias.
    fn alias_ends(&self, alias: AliasId) -> Option<[T; 2]>;
    /// The derivatives of the parameter of a knuckle on edge `k` of a draft, with a real part of 0.
    fn knuckle_rate(&self, draft: u32, k: usize, at: f64) -> Option<T>;
}

/// The parameters of the divisions of edge `k` of a draft, from 0 to 1.
pub(crate) fn along_edge<T: Real>(
    k: usize,
    draft: u32,
    places: &impl PatchLookup<T>,
) -> Option<Vec<T>> {
    let mut out = Vec::new();
    let run = |out: &mut Vec<T>, from: T, to: T, count: u32, shares: &Shares| {
        let step = to - from;
        match shares {
            Some(shares) => out.extend(shares.iter().map(|&s| from + step * s)),
            None => out.extend((1..count).map(|i| from + step * (f64::from(i) / f64::from(count)))),
        }
    };
    match &places.plans(draft)[k] {
        EdgePlan::Whole(n, None) => {
            // Plain quotients, so that all patches of equal divisions have them bit for bit.
            return Some((0..=*n).map(|i| T::from(f64::from(i) / f64::from(*n))).collect());
        }
        EdgePlan::Whole(n, shares) => {
            out.push(T::zero());
            run(&mut out, T::zero(), T::one(), *n, shares);
            out.push(T::one());
        }
        EdgePlan::As(other) => return along_edge(usize::from(*other), draft, places),
        EdgePlan::Like(other) => return along_edge(k, *other, places),
        EdgePlan::Segments(segments) => {
            let edges = places.edges(draft)?;
            let pieces = pieces(&edges.edges[k], places.owner(draft), k)?;
            let begin = |p: u16| if p == 0 { T::zero() } else { pieces[usize::from(p) - 1].until };
            let mut from = T::zero();
            out.push(from);
            for (at, segment) in segments.iter().enumerate() {
                let to = match segment.until {
                    _ if at + 1 == segments.len() => T::one(),
                    EdgeParameter::Piece(p) => pieces.get(usize::from(p))?.until,
                    EdgeParameter::Inside(p, source, alias) => {
                        let piece = pieces.get(usize::from(p))?;
                        // On the root that both have, and from there to the piece's own.
                        let mut t = parameter(source, places)?;
                        if source.alias() != alias {
                            t = on_part(places.alias_ends(source.alias())?, t);
                            let [from, to] = places.alias_ends(alias)?;
                            t = (t - from) / (to - from);
                        }
                        let share = (t - piece.from.t) / (piece.to.t - piece.from.t);
                        begin(p) + (piece.until - begin(p)) * share
                    }
                };
                run(&mut out, from, to, segment.count, &segment.shares);
                out.push(to);
                from = to;
            }
        }
    }
    Some(out)
}

fn parameter<T: Real>(source: MarkSource, places: &impl PatchLookup<T>) -> Option<T> {
    match source {
        MarkSource::Bead { point, .. } | MarkSource::Magnet { point, .. } => {
            on_its_root(places.point(point)?, source)
        }
        MarkSource::Piece { draft, edge, piece, end, .. } => {
            let k = usize::from(edge);
            let pieces = pieces(&places.edges(draft)?.edges[k], places.owner(draft), k)?;
            let piece = pieces.get(usize::from(piece))?;
            Some(if end { piece.to.t } else { piece.from.t })
        }
        MarkSource::Knuckle { draft, edge, piece, share, .. } => {
            let k = usize::from(edge);
            let pieces = pieces(&places.edges(draft)?.edges[k], places.owner(draft), k)?;
            let p = usize::from(piece);
            let piece = pieces.get(p)?;
            let begin = if p == 0 { T::zero() } else { pieces[p - 1].until };
            let reach = piece.until - begin;
            // The knuckle moves with its corner, and the ends of the piece move independently.
            let place = if T::PARTS == 1 {
                T::from(share)
            } else {
                let at = begin.re() + reach.re() * share;
                let moved = places.knuckle_rate(draft, k, at)? - begin - reach * share;
                let moved = moved / reach;
                moved - moved.re() + share
            };
            Some(piece.from.t + (piece.to.t - piece.from.t) * place)
        }
    }
}

/// The points of a patch; that of (i, j) at `[i * (nv + 1) + j]`.
pub(crate) fn evaluated<T: Scalar>(
    surface: &SurfaceRef<T>,
    parameters: &PatchParameters<T>,
) -> Vec<Vec3<T>> {
    let mut points = vec![Vec3::zero(); parameters.count()];
    match parameters {
        PatchParameters::Grid(us, vs) => surface.grid(us, vs, &mut points, None),
        PatchParameters::Fixed(uv) => {
            // In chunks on all threads: one patch may be most of a model.
            let parts = points.par_chunks_mut(PART).zip(uv.par_chunks(PART));
            parts.for_each(|(points, uv)| surface.scattered(uv, points));
        }
        PatchParameters::Moving(uv) => at_moving(surface, uv, &mut points),
    }
    points
}

/// The points of a patch in parts of about `most` points, one after the other: those of a range of which `wanted` says so, each with
/// the index of its first.
pub(crate) fn evaluated_in_parts<T: Scalar>(
    surface: &SurfaceRef<T>,
    parameters: &PatchParameters<T>,
    most: usize,
    wanted: impl Fn(Range<usize>) -> bool,
    mut each: impl FnMut(usize, &[Vec3<T>]),
) {
    let mut points = Vec::new();
    let mut part = |range: Range<usize>, fill: &dyn Fn(&mut [Vec3<T>])| {
        if wanted(range.clone()) {
            points.resize(range.len(), Vec3::zero());
            fill(&mut points);
            each(range.start, &points);
        }
    };
    match parameters {
        PatchParameters::Grid(us, vs) => {
            let (rows, nv) = ((most / vs.len()).max(1), vs.len());
            for (k, us) in us.chunks(rows).enumerate() {
                let first = k * rows * nv;
                let range = first..first + us.len() * nv;
                part(range, &|points| surface.grid(us, vs, points, None));
            }
        }
        PatchParameters::Fixed(uv) => {
            for (k, uv) in uv.chunks(most).enumerate() {
                let range = k * most..k * most + uv.len();
                part(range, &|points| surface.scattered(uv, points));
            }
        }
        PatchParameters::Moving(uv) => {
            for (k, uv) in uv.chunks(most).enumerate() {
                let range = k * most..k * most + uv.len();
                part(range, &|points| at_moving(surface, uv, points));
            }
        }
    }
}

/// The parameters of the points of a patch.
pub(crate) enum PatchParameters<T> {
    /// All u with all v.
    Grid(Vec<f64>, Vec<f64>),
    /// Pairs that no parameter of the model moves.
    Fixed(Vec<[f64; 2]>),
    /// Pairs that move.
    Moving(Vec<[T; 2]>),
}

impl<T: Scalar> PatchParameters<T> {
    /// The parameters of the points of a patch whose edges have their divisions at `edges`.
    pub fn of(surface: &SurfaceRef<T>, frame: &PatchTopology, edges: &[Vec<T>; 4]) -> Self {
        let [south, east, north, west] = edges;
        let even =
            |a: &[T], b: &[T]| a.iter().zip(b).all(|(x, y)| x.bits_eq(*y) && x.is_constant());
        if !frame.conformal && even(south, north) && even(west, east) {
            let real = |x: &[T]| x.iter().map(|t| t.re()).collect::<Vec<f64>>();
            return Self::Grid(real(south), real(west));
        }
        let uv = net(surface, frame, edges);
        match uv.iter().flatten().all(|x| x.is_constant()) {
            true => Self::Fixed(uv.iter().map(|p| p.map(T::re)).collect()),
            false => Self::Moving(uv),
        }
    }

    fn count(&self) -> usize {
        match self {
            Self::Grid(us, vs) => us.len() * vs.len(),
            Self::Fixed(uv) => uv.len(),
            Self::Moving(uv) => uv.len(),
        }
    }
}

fn at_moving<T: Scalar>(surface: &SurfaceRef<T>, uv: &[[T; 2]], points: &mut [Vec3<T>]) {
    for (p, &[u, v]) in points.iter_mut().zip(uv) {
        *p = surface.jet(u, v, Order::Zero).p;
    }
}

/// The parameters of the points of a patch whose edges have their divisions at `edges`: of the net of straight lines between
/// these, or one with knuckles as rows.
pub(crate) fn net<T: Scalar>(
    surface: &SurfaceRef<T>,
    frame: &PatchTopology,
    edges: &[Vec<T>; 4],
) -> Vec<[T; 2]> {
    let mut uv = parameters(edges);
    if let Some(knuckles) = frame.knuckles.as_deref().filter(|_| frame.conformal) {
        // A net that is not displaced is that of straight lines.
        let _ = conform(surface, knuckles, edges, &mut uv);
    }
    uv
}

/// The parameters of the points of the net of straight lines.
pub(crate) fn parameters<T: Real>([south, east, north, west]: &[Vec<T>; 4]) -> Vec<[T; 2]> {
    let mut uv = Vec::with_capacity(south.len() * west.len());
    for i in 0..south.len() {
        for j in 0..west.len() {
            uv.push(crossing(south[i], north[i], west[j], east[j]));
        }
    }
    uv
}

/// Intersection of the line from (a, 0) to (b, 1) with that from (0, c) to (1, d), in the unit
/// square.
///
/// u = a + (b - a) v and v = c + (d - c) u. Lines of one family never cross inside the square when
/// their ends ascend on both sides, so a grid of such points does not fold.
fn crossing<T: Real>(a: T, b: T, c: T, d: T) -> [T; 2] {
    let (lean, rise) = (b - a, d - c);
    let below = T::one() - lean * rise;
    if below.re() <= 0.0 {
        return [a, c];
    }
    // On an edge the other family's ends are 0 or 1 exactly, and so must the results be.
    if c.re() == d.re() && (c.re() == 0.0 || c.re() == 1.0) {
        return [if c.re() == 0.0 { a } else { b }, c];
    }
    if a.re() == b.re() && (a.re() == 0.0 || a.re() == 1.0) {
        return [a, if a.re() == 0.0 { c } else { d }];
    }
    [(a + lean * c) / below, (c + rise * a) / below]
}

/// Spacing of the panels along a side of a patch.
pub(crate) fn shares_of(law: &moldloft_registry::Spacing, from: u32, to: u32, of: u32) -> Shares {
    if law.is_even() || to - from < 2 {
        return None;
    }
    let at = |i: u32| law.at(f64::from(i) / f64::from(of), of);
    let (low, high) = (at(from), at(to));
    Some((from + 1..to).map(|i| (at(i) - low) / (high - low)).collect())
}

/// The shares seen from the other end.
pub(crate) fn reversed(shares: &Shares) -> Shares {
    shares.as_ref().map(|s| s.iter().rev().map(|x| 1.0 - x).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_square_cross_where_they_should() {
        let [u, v] = crossing(0.25, 0.25, 0.5, 0.75);
        assert_eq!((u, v), (0.25, 0.5625));
        let [u, v] = crossing(0.2, 0.6, 0.3, 0.1);
        assert!((u - (0.2 + 0.4 * v)).abs() < 1e-15 && (v - (0.3 - 0.2 * u)).abs() < 1e-15);
        assert_eq!(crossing(0.2, 0.6, 0.0, 0.0), [0.2, 0.0]);
        assert_eq!(crossing(0.2, 0.6, 1.0, 1.0), [0.6, 1.0]);
        assert_eq!(crossing(1.0, 1.0, 0.3, 0.1), [1.0, 0.1]);
    }
}
