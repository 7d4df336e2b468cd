//! The root curves of patches, divided at every point that some patch marks on them.
//!
//! An edge of one patch may be a whole curve, and those of its neighbours parts of it, between
//! beads. All marks of a root divide it into *stretches*; an edge is a chain of these, so the
//! neighbours of a part have their corners among the vertices of the whole.

use crate::draft::Draft;
use crate::identity::{Alias, Identities};
use moldloft_model::Graph;
use moldloft_num::Real;
use moldloft_num::trace::{Edge, Key, Mark, Piece, Root};
use moldloft_registry::{Point, Value};
use smallvec::SmallVec;
use std::collections::HashMap;

/// Distance in t within which two marks of the same point object coincide: rounding of the
/// different aliases of a root.
const SAME_MARK: f64 = 1e-9;

/// Source of a mark's parameter, for any scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MarkSource {
    /// The begin or end of a piece of an edge of a patch.
    Piece { draft: u32, edge: u8, piece: u16, end: bool, alias: AliasId },
    /// A bead or ring, by its object.
    Bead { point: Key, alias: AliasId },
    /// A magnet on an edge, 0..4, of its surface.
    Magnet { point: Key, edge: u8, alias: AliasId },
    /// A knuckle of a patch that crosses a piece of an edge at a fraction of its length.
    Knuckle { draft: u32, edge: u8, piece: u16, share: f64, alias: AliasId },
}

impl MarkSource {
    /// The parameters of the source on the root.
    pub fn alias(self) -> AliasId {
        match self {
            MarkSource::Piece { alias, .. }
            | MarkSource::Bead { alias, .. }
            | MarkSource::Knuckle { alias, .. }
            | MarkSource::Magnet { alias, .. } => alias,
        }
    }
}

/// A point of a root where a patch ends.
#[derive(Clone, Debug)]
pub(crate) struct RootPlace {
    /// Lowest and highest parameter under which it is known.
    low: f64,
    high: f64,
    /// The point objects there.
    pub points: SmallVec<[Key; 2]>,
    source: MarkSource,
}

impl RootPlace {
    /// Its parameter on the root.
    pub fn parameter(&self) -> f64 {
        self.low
    }
}

/// The number of an alias in [`RootTable::aliases`]; 0 is a root that represents itself.
pub(crate) type AliasId = u32;

/// The number of a mark among those of all roots.
pub(crate) type RootPlaceId = u32;

/// The stretch from a mark to the next on its root has the number of the mark.
pub(crate) type IntervalId = u32;

/// The points of all roots in ascending order, root by root.
#[derive(Debug, Default)]
pub(crate) struct RootTable {
    ids: HashMap<Root, usize>,
    /// The index of the first point of each root, and one past the last.
    start: Vec<u32>,
    places: Vec<RootPlace>,
    roots: Vec<Root>,
    aliases: Vec<Alias>,
    identities: Identities,
}

/// A part of an edge that is one stretch of a root, or a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeInterval {
    /// `None` for a piece without length.
    pub interval: Option<IntervalId>,
    /// True if the edge has the opposite direction to the root.
    pub backwards: bool,
    /// The points at its beginning and end, in the direction of the edge.
    pub ends: [RootPlaceId; 2],
    /// The edge's parameter at its end.
    pub until: EdgeParameter,
}

/// A parameter of an edge, as something that can be had with any scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EdgeParameter {
    Piece(u16),
    /// Inside a piece, at a mark of its root, on which the piece has that alias.
    Inside(u16, MarkSource, AliasId),
}

struct RawMark {
    root: usize,
    t: f64,
    point: Option<Key>,
    source: MarkSource,
}

impl RootTable {
    /// All points marked by edges and corners of the patches.
    pub fn new(graph: &Graph<f64>, drafts: &[Draft], identities: Identities) -> Self {
        let mut all = Self { identities, aliases: vec![Alias::new()], ..Self::default() };
        let mut raw = Vec::new();
        for (d, draft) in drafts.iter().enumerate() {
            for (k, edge) in draft.edges.edges.iter().enumerate() {
                let Some(pieces) = pieces(edge, draft.object.key, k) else { continue };
                for (p, piece) in pieces.iter().enumerate() {
                    let (piece, alias) = all.identities.piece(piece);
                    let alias = all.alias_id(alias);
                    for (end, mark) in [piece.from, piece.to].into_iter().enumerate() {
                        let source = MarkSource::Piece {
                            draft: d as u32,
                            edge: k as u8,
                            piece: p as u16,
                            end: end == 1,
                            alias,
                        };
                        let root = all.id(piece.root);
                        raw.push(RawMark { root, t: mark.t + 0.0, point: mark.point, source });
                    }
                }
                for at in draft.knuckles.on_edge(k) {
                    let Some((p, share)) = share_of(&pieces, at) else { continue };
                    let (piece, alias) = all.identities.piece(&pieces[p]);
                    let alias = all.alias_id(alias);
                    let t = piece.from.t + (piece.to.t - piece.from.t) * share;
                    let (draft, edge, piece_at) = (d as u32, k as u8, p as u16);
                    let source = MarkSource::Knuckle { draft, edge, piece: piece_at, share, alias };
                    let root = all.id(piece.root);
                    raw.push(RawMark { root, t: t + 0.0, point: None, source });
                }
            }
        }
        all.mark_points(graph, drafts, &mut raw);
        all.sort(raw);
        all
    }

    /// Declared joins of an edge with a part of another of which an end, which follows, is no point of that.
    pub fn unnamed(&self) -> &[(Key, Option<Key>)] {
        self.identities.unnamed()
    }

    /// True when joins are declared.
    pub fn has_declared(&self) -> bool {
        self.identities.has_declared()
    }

    /// Maximum distance of the edges along a stretch by a declared join.
    pub fn tolerance(&self, interval: IntervalId) -> Option<f64> {
        self.identities.tolerance(self.root_of(interval))
    }

    /// The one name of a point.
    pub fn point(&self, key: Key) -> Key {
        self.identities.point(key)
    }

    /// The aliases in use.
    pub fn aliases(&self) -> &[Alias] {
        &self.aliases
    }

    /// The own parameter of a root with that alias, at one of its representative.
    pub fn own_parameter(&self, alias: AliasId, t: f64) -> f64 {
        let alias = &self.aliases[alias as usize];
        let [from, to] = [0.0, 1.0].map(|end| self.identities.on_representative(alias, end));
        (t - from) / (to - from)
    }

    fn alias_id(&mut self, alias: Alias) -> AliasId {
        let known = self.aliases.iter().position(|a| *a == alias);
        known.unwrap_or_else(|| {
            self.aliases.push(alias);
            self.aliases.len() - 1
        }) as AliasId
    }

    fn id(&mut self, root: Root) -> usize {
        let next = self.ids.len();
        *self.ids.entry(root).or_insert_with(|| {
            self.roots.push(root);
            next
        })
    }

    /// Corners and poles that are beads, rings or magnets mark their edges, even if no edge ends
    /// there.
    fn mark_points(&mut self, graph: &Graph<f64>, drafts: &[Draft], raw: &mut Vec<RawMark>) {
        let poles = |draft: &Draft| -> SmallVec<[Key; 4]> {
            let edges = draft.edges.edges.iter();
            edges.filter_map(|e| if let Edge::Pole(p) = e { *p } else { None }).collect()
        };
        let mut seen = std::collections::HashSet::new();
        for draft in drafts {
            let corners = draft.edges.corners.into_iter().flatten();
            for key in corners.chain(poles(draft)) {
                if !seen.insert(key) {
                    continue;
                }
                let Some(Value::Point(point)) = graph.get(key).and_then(|o| o.value()) else {
                    continue;
                };
                let name = self.identities.point(key);
                for (root, t, source) in places_of(point, key) {
                    let (root, alias) = self.identities.root(root);
                    // A root of no patch needs no marks.
                    let Some(&root) = self.ids.get(&root) else { continue };
                    let t = self.identities.on_representative(&alias, t);
                    let source = with_alias(source, self.alias_id(alias));
                    raw.push(RawMark { root, t: t + 0.0, point: Some(name), source });
                }
            }
        }
    }

    fn sort(&mut self, mut raw: Vec<RawMark>) {
        // Stable: among equal ones the first patch comes first.
        raw.sort_by(|a, b| a.root.cmp(&b.root).then(a.t.total_cmp(&b.t)));
        let mut root = None;
        for RawMark { root: at, t, point, source } in raw {
            let same_root = root == Some(at);
            root = Some(at);
            while self.start.len() <= at {
                self.start.push(self.places.len() as u32);
            }
            if let Some(last) = self.places.last_mut().filter(|_| same_root) {
                let known = point.is_some_and(|p| last.points.contains(&p));
                // A position that differs only by rounding of the fraction is the same.
                let knuckle = is_knuckle(source) || is_knuckle(last.source);
                if t == last.high || ((known || knuckle) && t - last.high <= SAME_MARK) {
                    if is_knuckle(last.source) {
                        last.source = source;
                    }
                    last.high = t;
                    last.points.extend(point.filter(|_| !known));
                    continue;
                }
            }
            let points = point.into_iter().collect();
            self.places.push(RootPlace { low: t, high: t, points, source });
        }
        self.start.push(self.places.len() as u32);
    }

    /// The number of marks; stretches are numbered alike.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The points.
    pub fn places(&self) -> &[RootPlace] {
        &self.places
    }

    /// The root that a stretch is part of.
    pub fn root_of(&self, interval: IntervalId) -> Root {
        self.roots[self.start.partition_point(|&s| s <= interval) - 1]
    }

    fn find(&self, root: usize, t: f64) -> RootPlaceId {
        let (from, to) = (self.start[root] as usize, self.start[root + 1] as usize);
        let places = &self.places[from..to];
        (from + places.partition_point(|p| p.high < t)) as RootPlaceId
    }

    /// The stretches along the pieces of an edge.
    pub fn spans(&self, pieces: &[Piece<f64>]) -> Vec<EdgeInterval> {
        let mut spans = Vec::with_capacity(pieces.len());
        for (p, piece) in pieces.iter().enumerate() {
            let (piece, alias) = self.identities.piece(piece);
            let alias = self.aliases.iter().position(|a| *a == alias).unwrap_or(0) as AliasId;
            let root = self.ids[&piece.root];
            let (from, to) =
                (self.find(root, piece.from.t + 0.0), self.find(root, piece.to.t + 0.0));
            let p = p as u16;
            if from == to {
                let until = EdgeParameter::Piece(p);
                spans.push(EdgeInterval {
                    interval: None,
                    backwards: false,
                    ends: [from, to],
                    until,
                });
                continue;
            }
            let backwards = from > to;
            let mut at = from;
            while at != to {
                let next = if backwards { at - 1 } else { at + 1 };
                let until = if next == to {
                    EdgeParameter::Piece(p)
                } else {
                    EdgeParameter::Inside(p, self.places[next as usize].source, alias)
                };
                let interval = Some(at.min(next));
                spans.push(EdgeInterval { interval, backwards, ends: [at, next], until });
                at = next;
            }
        }
        spans
    }
}

/// True for a mark that is only where a patch breaks, which no one else names.
fn is_knuckle(source: MarkSource) -> bool {
    matches!(source, MarkSource::Knuckle { .. })
}

/// The piece of an edge that contains a parameter of the edge, and the fraction of it; `None` at
/// the junction of two.
fn share_of(pieces: &[Piece<f64>], at: f64) -> Option<(usize, f64)> {
    let p = pieces.iter().position(|piece| at < piece.until + SAME_MARK)?;
    let begin = if p == 0 { 0.0 } else { pieces[p - 1].until };
    let share = (at - begin) / (pieces[p].until - begin);
    (at < pieces[p].until - SAME_MARK && at > begin + SAME_MARK).then_some((p, share))
}

fn with_alias(source: MarkSource, of: AliasId) -> MarkSource {
    let mut source = source;
    match &mut source {
        MarkSource::Piece { alias, .. }
        | MarkSource::Bead { alias, .. }
        | MarkSource::Knuckle { alias, .. }
        | MarkSource::Magnet { alias, .. } => *alias = of,
    }
    source
}

/// Positions of a point on roots, by its own data.
pub(crate) fn places_of(point: &Point<f64>, key: Key) -> SmallVec<[(Root, f64, MarkSource); 2]> {
    let mut places = SmallVec::new();
    if let Some(place) = &point.on_curve {
        let (curve, t) = (&place.0, place.1);
        if let [piece] = curve.pieces().as_slice() {
            places.push((piece.root, on_root(piece, t), MarkSource::Bead { point: key, alias: 0 }));
        }
    }
    if let Some(place) = &point.on_surface
        && let (surface, [u, v]) = (&place.0, place.1)
        && let Some(owner) = surface.key
    {
        let edges = surface.edges();
        for (k, edge) in edges.edges.iter().enumerate() {
            let (across, along) = if k % 2 == 0 { (v, u) } else { (u, v) };
            let on = if k == 1 || k == 2 { 1.0 } else { 0.0 };
            if across != on {
                continue;
            }
            if let Some(pieces) = pieces(edge, owner, k)
                && let [piece] = pieces.as_slice()
            {
                let source = MarkSource::Magnet { point: key, edge: k as u8, alias: 0 };
                places.push((piece.root, on_root(piece, along), source));
            }
        }
    }
    places
}

fn on_root<T: Real>(piece: &Piece<T>, t: T) -> T {
    piece.from.t + (piece.to.t - piece.from.t) * t
}

/// The pieces of an edge that has any: of its own, the whole of itself.
pub(crate) fn pieces<T: Real>(
    edge: &Edge<T>,
    owner: Key,
    k: usize,
) -> Option<SmallVec<[Piece<T>; 1]>> {
    match edge {
        Edge::Own => {
            let end = |t: f64| Mark { t: T::from(t), point: None };
            let (from, to) = (end(0.0), end(1.0));
            let root = Root::Edge(owner, k as u8);
            Some(smallvec::smallvec![Piece { root, from, to, until: T::one() }])
        }
        Edge::Pieces(pieces) => Some(pieces.clone()),
        Edge::SameAs(_) | Edge::Pole(_) => None,
    }
}

/// The parameter on its root of a bead, ring or magnet that marks it.
pub(crate) fn on_its_root<T: Real>(point: &Point<T>, source: MarkSource) -> Option<T> {
    match source {
        MarkSource::Bead { .. } => {
            let place = point.on_curve.as_ref()?;
            place.0.pieces().first().map(|piece| on_root(piece, place.1))
        }
        MarkSource::Magnet { edge, .. } => {
            let place = point.on_surface.as_ref()?;
            let k = usize::from(edge);
            let pieces = pieces(&place.0.edges().edges[k], place.0.key?, k)?;
            pieces.first().map(|piece| on_root(piece, place.1[k % 2]))
        }
        MarkSource::Piece { .. } | MarkSource::Knuckle { .. } => None,
    }
}
