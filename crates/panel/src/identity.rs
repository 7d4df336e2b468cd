//! Roots, and points, with several names that are identical.
//!
//! An edge of a loft has no name of its own, nor has a corner of a patch. They are identified by
//! their origin: the edge by the ends of the masters, the corner of an image by the corner of the
//! original, a bead by its curve and its numbers. Two of them are identical if they have the same
//! origin *and* coincide: neither alone suffices, for the same point may be rotated to several
//! positions, and equal numbers join nothing. Identical ones have one root, so marks, divisions and
//! vertices are shared along it as along any curve.
//!
//! `roots in use -> origin of each -> those of equal origin -> coincident ones -> one root`

use crate::draft::{Draft, surface_of};
use crate::roots::{MarkSource, pieces, places_of};
use moldloft_model::Graph;
use moldloft_num::trace::{EDGE_CORNERS, Edge, Key, Mark, Named, Piece, Root, Trace};
use moldloft_num::{Box3, Order, Real, Vec3};
use moldloft_registry::{CurveRef, SurfaceRef, Value};
use smallvec::SmallVec;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

/// The parameters at which two roots are compared; the same ones from the other end.
const TRIALS: [f64; 9] = [0.0, 0.0625, 0.1875, 0.34375, 0.5, 0.65625, 0.8125, 0.9375, 1.0];

/// Relative tolerance of coincidence for equal origin: rounding, independent of the construction.
const SAME_PLACE: f64 = 1e-10;

/// Maximum number of rounds: unions may make further origins equal, such as those of lines between
/// corners found to be identical.
const ROUNDS: usize = 6;

/// Origin of a line or a point, as a number; equal for equal origins.
type Make = u64;

/// A step from the parameter of a root to that of the root that it is, or is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AliasStep {
    /// In the opposite direction.
    Turned,
    /// Onto the part of a root that is edge 0 or 1 of a declared join.
    Part {
        /// The join.
        join: Key,
        /// The edge of the join, 0 or 1.
        edge: u8,
    },
    /// Onto the part of a root between two points of it.
    Between([PartEnd; 2]),
}

/// A point of a root at which a part of it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum PartEnd {
    /// The begin of the root.
    Begin,
    /// Its end.
    End,
    /// A bead or ring or, on an edge of its surface, a magnet; in the opposite direction to the
    /// root that it is defined on.
    Point {
        /// The object.
        point: Key,
        /// The edge, 0..4, of its surface.
        edge: Option<u8>,
        /// True for the opposite direction.
        turned: bool,
    },
}

impl PartEnd {
    /// Source of the parameter of a point on the root that it is defined on.
    pub fn source(self) -> Option<MarkSource> {
        match self {
            PartEnd::Point { point, edge: Some(edge), .. } => {
                Some(MarkSource::Magnet { point, edge, alias: 0 })
            }
            PartEnd::Point { point, .. } => Some(MarkSource::Bead { point, alias: 0 }),
            PartEnd::Begin | PartEnd::End => None,
        }
    }
}

/// The steps from the parameter of a root to that of its representative.
pub(crate) type Alias = SmallVec<[AliasStep; 2]>;

/// True when the root is its representative from end to end.
fn is_whole(alias: &Alias) -> bool {
    alias.iter().all(|step| *step == AliasStep::Turned)
}

fn is_turned(alias: &Alias) -> bool {
    alias.first() == Some(&AliasStep::Turned)
}

/// One alias after the other.
fn append(alias: &mut Alias, steps: impl IntoIterator<Item = AliasStep>) {
    for step in steps {
        if step == AliasStep::Turned && alias.last() == Some(&step) {
            alias.pop();
        } else {
            alias.push(step);
        }
    }
}

fn turn(turned: bool) -> Option<AliasStep> {
    turned.then_some(AliasStep::Turned)
}

/// The parameter of a root at the parameter t of a part from `from` to `to`; exact at both ends.
pub(crate) fn on_part<T: Real>([from, to]: [T; 2], t: T) -> T {
    if t.re() == 1.0 { to + (to - from) * (t - 1.0) } else { from + (to - from) * t }
}

/// The roots and points with other identities.
#[derive(Clone, Debug, Default)]
pub(crate) struct Identities {
    roots: HashMap<Root, (Root, Alias)>,
    /// Parameters, on their roots, of the ends of parts.
    parts: HashMap<AliasStep, [f64; 2]>,
    points: HashMap<Key, Key>,
    /// The roots of declared joins, with the maximum distance of their edges.
    declared: Vec<(Root, f64)>,
    /// Declared joins of parts whose ends are no points of the other edge: the joins, and the ends.
    unnamed: Vec<(Key, Option<Key>)>,
}

impl Identities {
    /// Edges between points that turn out to be one are poles: the end of a strip between a curve that
    /// begins in a mirror and its image.
    pub fn collapse(&self, drafts: &mut [Draft]) {
        for draft in drafts {
            for k in 0..4 {
                let one = match &draft.edges.edges[k] {
                    Edge::Pieces(pieces) => {
                        let segments = pieces.iter().flat_map(|p| match p.root {
                            Root::Segment(a, b) => [Some(a), Some(b)],
                            _ => [None, None],
                        });
                        // A snake along the pole of its surface is a point.
                        let ends = pieces.iter().flat_map(|p| {
                            [p.from, p.to].map(|m| m.point.or_else(|| p.root.end(m.t.re())))
                        });
                        self.one_point(segments).or_else(|| {
                            self.one_point(ends).filter(|_| has_no_length(&draft.surface, k))
                        })
                    }
                    Edge::Own => {
                        let made = draft.surface.edge_made_of(k);
                        // One point alone may be turned to a circle.
                        let several = made.len() > 1 && has_no_length(&draft.surface, k);
                        let one = self.one_point(made.into_iter().map(Some));
                        one.filter(|_| several)
                    }
                    _ => None,
                };
                if let Some(point) = one {
                    draft.edges.edges[k] = Edge::Pole(Some(point));
                }
            }
        }
    }

    /// The point that all of these are.
    fn one_point(&self, mut points: impl Iterator<Item = Option<Key>>) -> Option<Key> {
        let first = self.point(points.next()??);
        points.all(|p| p.is_some_and(|p| self.point(p) == first)).then_some(first)
    }

    /// Declared joins of an edge with a part of another of which an end, which follows, is no point of that.
    pub fn unnamed(&self) -> &[(Key, Option<Key>)] {
        &self.unnamed
    }

    /// True when joins are declared.
    pub fn has_declared(&self) -> bool {
        !self.declared.is_empty()
    }

    /// Maximum distance of the edges along a root by a declared join.
    pub fn tolerance(&self, root: Root) -> Option<f64> {
        let (root, _) = self.root(root);
        let of = self.declared.iter().filter(|(r, _)| self.root(*r).0 == root);
        of.map(|(_, tolerance)| *tolerance).reduce(f64::max)
    }

    /// Identities of all curves and points of the patches.
    pub fn new(graph: &Graph<f64>, drafts: &[Draft]) -> Self {
        let mut finder = IdentityFinder::new(graph, drafts);
        finder.join_declared();
        for _ in 0..ROUNDS {
            finder.makes.clear();
            let before = finder.unions;
            finder.join_points();
            finder.join_by_ends();
            finder.join_lines();
            finder.join_parts_of_lines();
            finder.found.flatten();
            if finder.unions == before {
                break;
            }
        }
        // Hidden patches join nothing.
        let used: HashSet<Root> = finder.roots.iter().copied().collect();
        let shown = |edges: &[Piece<f64>; 2]| edges.iter().all(|edge| used.contains(&edge.root));
        let unnamed = finder.pending.iter().filter(|(_, edges)| shown(edges));
        let unnamed = unnamed.map(|(join, edges)| (*join, finder.unnamed_end(edges))).collect();
        finder.found.unnamed = unnamed;
        finder.found
    }

    /// The one name of a point.
    pub fn point(&self, key: Key) -> Key {
        let mut at = key;
        while let Some(&next) = self.points.get(&at) {
            at = next;
        }
        at
    }

    /// Resolves chains of names.
    fn flatten(&mut self) {
        let points: Vec<Key> = self.points.keys().copied().collect();
        for key in points {
            let last = self.point(key);
            self.points.insert(key, last);
        }
        let roots: Vec<Root> = self.roots.keys().copied().collect();
        for root in roots {
            let (last, alias) = self.root(root);
            let (straight, turned) = self.straightened(root);
            if straight != last && straight != root {
                // The same line by the one names of its ends.
                let mut known = Alias::from_iter(turn(turned));
                append(&mut known, alias.iter().copied());
                self.roots.insert(straight, (last, known));
            }
            self.roots.insert(root, (last, alias));
        }
    }

    /// The representative of a root, and its parameters on that.
    pub fn root(&self, root: Root) -> (Root, Alias) {
        let (mut at, mut alias) = (root, Alias::new());
        // Names lead to others and end; a count keeps that from resting on it.
        for _ in 0..=2 * self.roots.len() {
            // A line may have been joined before its ends had their one name.
            if let Some((next, steps)) = self.roots.get(&at) {
                append(&mut alias, steps.iter().copied());
                at = *next;
                continue;
            }
            let (straight, turned) = self.straightened(at);
            append(&mut alias, turn(turned));
            if straight == at {
                break;
            }
            at = straight;
        }
        (at, alias)
    }

    /// The parameter on the representative.
    pub fn on_representative(&self, alias: &Alias, t: f64) -> f64 {
        alias.iter().fold(t, |t, step| match step {
            AliasStep::Turned => 1.0 - t,
            part => on_part(self.parts[part], t),
        })
    }

    /// A straight line between points by the one names of these.
    fn straightened(&self, root: Root) -> (Root, bool) {
        match root {
            Root::Segment(a, b) => {
                let [p, q] = [self.point(a), self.point(b)];
                if p == q { (root, false) } else { (Root::Segment(p.min(q), p.max(q)), p > q) }
            }
            Root::Governed(a, b, law) => (Root::Governed(self.point(a), self.point(b), law), false),
            other => (other, false),
        }
    }

    /// The piece on the representative root, and its parameters on that.
    pub fn piece(&self, piece: &Piece<f64>) -> (Piece<f64>, Alias) {
        let (root, alias) = self.root(piece.root);
        let mark = |mark: Mark<f64>| Mark {
            t: self.on_representative(&alias, mark.t),
            point: mark.point.map(|p| self.point(p)),
        };
        let on = Piece { root, from: mark(piece.from), to: mark(piece.to), until: piece.until };
        (on, alias)
    }
}

struct IdentityFinder<'g> {
    graph: &'g Graph<f64>,
    found: Identities,
    /// The roots of the patches, and the points in use, in the order of first use.
    roots: Vec<Root>,
    points: Vec<Key>,
    makes: HashMap<Key, Make>,
    lines: HashMap<Root, Make>,
    /// The points on curves and surfaces, by the one name of each.
    names: HashMap<Key, Vec<Key>>,
    /// Declared joins of a whole edge with a part of another that are not resolved yet.
    pending: Vec<(Key, [Piece<f64>; 2])>,
    unions: usize,
}

fn hashed(parts: impl Hash) -> Make {
    let mut hasher = DefaultHasher::new();
    parts.hash(&mut hasher);
    hasher.finish()
}

/// The origin of several parts, independent of their order.
fn set(mut parts: Vec<Make>) -> Make {
    parts.sort_unstable();
    parts.dedup();
    match parts[..] {
        [one] => one,
        _ => hashed(parts),
    }
}

impl<'g> IdentityFinder<'g> {
    fn new(graph: &'g Graph<f64>, drafts: &[Draft]) -> Self {
        let mut roots = indexed();
        let mut points = indexed();
        for draft in drafts {
            for (k, edge) in draft.edges.edges.iter().enumerate() {
                for piece in pieces(edge, draft.object.key, k).iter().flatten() {
                    roots.add(piece.root);
                    if let Root::Segment(a, b) | Root::Governed(a, b, _) = piece.root {
                        points.add(a);
                        points.add(b);
                    }
                    [piece.from, piece.to]
                        .iter()
                        .filter_map(|m| m.point)
                        .for_each(|p| points.add(p));
                }
                if let Edge::Pole(Some(point)) = edge {
                    points.add(*point);
                }
            }
            draft.edges.corners.iter().flatten().for_each(|&p| points.add(p));
        }
        Self {
            graph,
            found: Identities::default(),
            roots: roots.all,
            points: points.all,
            makes: HashMap::new(),
            lines: HashMap::new(),
            names: HashMap::new(),
            pending: Vec::new(),
            unions: 0,
        }
    }

    fn curve(&self, key: Key) -> Option<&'g CurveRef<f64>> {
        match self.graph.get(key)?.value()? {
            Value::Curve(curve) => Some(curve),
            _ => None,
        }
    }

    fn surface(&self, key: Key) -> Option<&'g SurfaceRef<f64>> {
        surface_of(self.graph.get(key)?)
    }

    /// Origin of a point: itself, or the point of which it is an image.
    fn point_make(&mut self, key: Key) -> Make {
        let mut at = self.found.point(key);
        if let Some(&make) = self.makes.get(&at) {
            return make;
        }
        let first = at;
        let mut seen = vec![at];
        // Images of images: down to the original.
        loop {
            let next = match at.named() {
                Named::Object(_) => match self.graph.get(at).and_then(|o| o.value()) {
                    Some(Value::Point(p)) => p.image_of.or(p.key.filter(|&k| k != at)),
                    _ => None,
                },
                Named::Corner(surface, k) => self.surface(surface).and_then(|s| {
                    let known = s.edges().corners[k];
                    known.or_else(|| s.image_of()?.0.corner(k))
                }),
                Named::End(curve, k) => self.curve(curve).and_then(|c| {
                    let known = c.end_points()[k].filter(|&p| p != at);
                    known.or_else(|| c.image_of()?.end(k))
                }),
                Named::Joint(curve, k) => self.curve(curve).and_then(|c| c.image_of()?.joint(k)),
                Named::Edge(..) => None,
            };
            let Some(next) = next.map(|p| self.found.point(p)) else { break };
            // Points that are images of each other, by other names, have the first of them in common.
            if let Some(from) = seen.iter().position(|&p| p == next) {
                at = seen[from..].iter().copied().min().unwrap_or(next);
                break;
            }
            seen.push(next);
            at = next;
        }
        let make = self.placed_make(at).unwrap_or_else(|| hashed((0u8, at.0)));
        self.makes.insert(first, make);
        make
    }

    /// Origin of a point on a curve or surface: its kind, its carrier, and its numbers. Two of
    /// equal origin are identical for all values of the model's parameters.
    fn placed_make(&mut self, key: Key) -> Option<Make> {
        let object = self.graph.get(key)?;
        match object.value()? {
            Value::Point(p) if p.on_curve.is_some() || p.on_surface.is_some() => {}
            _ => return None,
        }
        let mut parts = vec![hashed((4u8, &object.row.name))];
        for arg in &object.args {
            parts.push(match arg {
                Value::Object(key) => self.make(*key),
                Value::Curve(curve) => self.make(curve.key?),
                Value::Surface(surface) => self.make(surface.key?),
                Value::Point(point) => self.make(point.key?),
                other => hashed(format!("{other:?}")),
            });
        }
        Some(hashed(parts))
    }

    /// Origin of anything with a key.
    fn make(&mut self, key: Key) -> Make {
        match key.named() {
            Named::Edge(surface, k) => self.line_make(Root::Edge(surface, k as u8)),
            Named::Corner(..) | Named::End(..) | Named::Joint(..) => self.point_make(key),
            Named::Object(_) => match self.graph.get(key).and_then(|o| o.value()) {
                Some(Value::Curve(_)) => self.line_make(Root::Curve(key)),
                Some(Value::Point(_)) => self.point_make(key),
                _ => hashed((2u8, key.0)),
            },
        }
    }

    fn pieces_make(&mut self, pieces: &[Piece<f64>]) -> Make {
        let mut parts = Vec::new();
        for piece in pieces {
            let line = self.line_make(piece.root);
            let ends = [piece.from, piece.to];
            if ends.iter().all(|m| m.t == 0.0 || m.t == 1.0) {
                parts.push(line);
                continue;
            }
            // A part: the line, and where it begins and ends.
            let mut marks: Vec<Make> = Vec::new();
            for mark in ends {
                marks.push(match mark.point.or_else(|| piece.root.end(mark.t)) {
                    Some(point) => self.point_make(point),
                    None => hashed((3u8, mark.t.to_bits())),
                });
            }
            marks.push(line);
            parts.push(set(marks));
        }
        set(parts)
    }

    /// The representative of a root, unless the root is only a part of it.
    fn whole_root(&self, root: Root) -> Root {
        let (representative, alias) = self.found.root(root);
        if is_whole(&alias) { representative } else { root }
    }

    /// Origin of a line: the curve of which it is an image, or the points that it is drawn through.
    fn line_make(&mut self, root: Root) -> Make {
        let root = self.whole_root(root);
        if let Some(&make) = self.lines.get(&root) {
            return make;
        }
        let own = hashed((1u8, root));
        // Stops a circular origin.
        self.lines.insert(root, own);
        let make = match root {
            Root::Segment(a, b) => set(vec![self.point_make(a), self.point_make(b)]),
            Root::Governed(a, b, _) => set(vec![self.point_make(a), self.point_make(b)]),
            Root::Curve(key) => match self.curve(key) {
                Some(curve) => self.curve_make(key, curve),
                None => own,
            },
            Root::Edge(key, k) => match self.surface(key) {
                Some(surface) => self.edge_make(key, usize::from(k), surface),
                None => own,
            },
        };
        self.lines.insert(root, make);
        make
    }

    fn curve_make(&mut self, key: Key, curve: &CurveRef<f64>) -> Make {
        if let Some(original) = curve.image_of() {
            return self.make(original);
        }
        match curve.trace() {
            Trace::Pieces(pieces) => self.pieces_make(&pieces),
            Trace::Point(Some(point)) => self.point_make(point),
            _ => {
                let parents = self.graph.get(key).map(|o| o.parents.clone()).unwrap_or_default();
                let shapes: Vec<Key> = parents
                    .into_iter()
                    .filter(|&p| {
                        matches!(
                            self.graph.get(p).and_then(|o| o.value()),
                            Some(Value::Point(_) | Value::Curve(_) | Value::Surface(_))
                        )
                    })
                    .collect();
                if shapes.is_empty() {
                    return hashed((1u8, Root::Curve(key)));
                }
                set(shapes.into_iter().map(|p| self.make(p)).collect())
            }
        }
    }

    fn edge_make(&mut self, key: Key, k: usize, surface: &SurfaceRef<f64>) -> Make {
        if let Some(edge) = surface.image_of().and_then(|(original, _)| original.edge(k)) {
            return self.make(edge);
        }
        let edges = surface.edges();
        match &edges.edges[k] {
            Edge::Pieces(pieces) => self.pieces_make(pieces),
            Edge::SameAs(other) => self.line_make(Root::Edge(key, *other)),
            Edge::Pole(Some(point)) => self.point_make(*point),
            Edge::Pole(None) => hashed((1u8, Root::Edge(key, k as u8))),
            Edge::Own => {
                let mut made = surface.edge_made_of(k);
                if made.is_empty() {
                    // Nothing is known but the ends.
                    let ends = EDGE_CORNERS[k].map(|c| edges.corners[c].or_else(|| key.corner(c)));
                    made.extend(ends.into_iter().flatten());
                }
                let makes: Vec<Make> = made.into_iter().map(|p| self.make(p)).collect();
                if makes.is_empty() { hashed((1u8, Root::Edge(key, k as u8))) } else { set(makes) }
            }
        }
    }

    /// Position of a point.
    fn place(&self, key: Key) -> Option<Vec3> {
        match key.named() {
            Named::Object(_) => match self.graph.get(key)?.value()? {
                Value::Point(p) => Some(p.xyz),
                _ => None,
            },
            Named::Corner(surface, k) => {
                let [u, v] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][k];
                Some(self.surface(surface)?.jet(u, v, Order::Zero).p)
            }
            Named::End(curve, k) => Some(self.curve(curve)?.end(k as f64)),
            Named::Joint(curve, k) => {
                let curve = self.curve(curve)?;
                Some(curve.end(*curve.joints().get(k)?))
            }
            Named::Edge(..) => None,
        }
    }

    /// The points of a root at the trial parameters.
    fn places(&self, root: Root) -> Option<Vec<Vec3>> {
        let mut points = vec![Vec3::zero(); TRIALS.len()];
        match root {
            Root::Curve(key) => self.curve(key)?.grid(&TRIALS, &mut points),
            Root::Edge(key, k) => {
                let surface = self.surface(key)?;
                let fixed = [if k == 1 || k == 2 { 1.0 } else { 0.0 }];
                match k % 2 {
                    0 => surface.grid(&TRIALS, &fixed, &mut points, None),
                    _ => surface.grid(&fixed, &TRIALS, &mut points, None),
                }
            }
            Root::Segment(a, b) => {
                let [a, b] = [self.place(a)?, self.place(b)?];
                for (p, t) in points.iter_mut().zip(TRIALS) {
                    *p = a * (1.0 - t) + b * t;
                }
            }
            // The law is the same for those that may be one.
            Root::Governed(..) => return None,
        }
        points.iter().all(|p| p.norm().is_finite()).then_some(points)
    }

    /// The edges that the user declares to be one.
    fn join_declared(&mut self) {
        for object in self.graph.objects() {
            let Some(Value::Curve(curve)) = object.value() else { continue };
            let Some(join) = &curve.joins else { continue };
            let (edges, tolerance) = (&join.edges, join.tolerance);
            let [Some(a), Some(b)] = [0, 1].map(|k| edges[k].pieces().first().copied()) else {
                continue;
            };
            // Rings begin and end at the same point: their direction shows between.
            const PLACES: [f64; 5] = [0.0, 0.21, 0.5, 0.79, 1.0];
            let place = |k: usize, t: f64| edges[k].jet(t, Order::Zero)[0];
            let apart = |turned: bool| -> f64 {
                let other = |t: f64| if turned { 1.0 - t } else { t };
                PLACES.iter().map(|&t| place(0, t).distance(place(1, other(t)))).sum()
            };
            let (alike, against) = (apart(false), apart(true));
            let against = against < alike;
            let runs = |p: &Piece<f64>| (p.from.t - p.to.t).abs() == 1.0;
            match [runs(&a), runs(&b)] {
                [true, true] if join.whole => {
                    let turned = against ^ (a.from.t > a.to.t) ^ (b.from.t > b.to.t);
                    self.join_line(a.root, b.root, turned);
                }
                [true, true] => self.pending.push((object.key, [a, b])),
                [true, false] => self.join_part(&a, (object.key, 1), &b, against),
                [false, true] => self.join_part(&b, (object.key, 0), &a, against),
                [false, false] => continue,
            }
            let (root, _) = self.found.root(a.root);
            self.found.declared.push((root, tolerance));
        }
    }

    /// The whole of a root is a part of another, which is an edge of a declared join.
    fn join_part(
        &mut self,
        whole: &Piece<f64>,
        (join, edge): (Key, u8),
        part: &Piece<f64>,
        against: bool,
    ) {
        let step = AliasStep::Part { join, edge };
        self.found.parts.insert(step, [part.from.t, part.to.t]);
        let turned = against ^ (whole.from.t > whole.to.t);
        let steps = turn(turned).into_iter().chain([step]);
        if !self.place_on(whole.root, steps, part.root) {
            return;
        }
        let [from, to] = [whole, part].map(|piece| {
            let known = self.ends(piece.root);
            [piece.from, piece.to].map(|mark| match mark.t {
                0.0 => known[0].or(mark.point),
                1.0 => known[1].or(mark.point),
                _ => mark.point,
            })
        });
        for k in 0..2 {
            if let (Some(p), Some(q)) = (from[k], to[if against { 1 - k } else { k }]) {
                self.join_point(p, q);
            }
        }
    }

    /// The declared joins of a whole edge with the part of another between the points that it ends at.
    fn join_by_ends(&mut self) {
        self.name_points();
        for (join, [a, b]) in std::mem::take(&mut self.pending) {
            if !(self.is_between_points(a.root, b.root) || self.is_between_points(b.root, a.root)) {
                self.pending.push((join, [a, b]));
            }
        }
    }

    /// Makes a root a part of another, if it ends at points of that.
    fn is_between_points(&mut self, root: Root, on: Root) -> bool {
        let (on, alias) = self.found.root(on);
        let ends = self.ends(root).map(|end| self.part_end(end?, on));
        match ends {
            // It may be known already.
            _ if self.found.root(root).0 == on => true,
            [Some(from), Some(to)] if is_whole(&alias) => self.place_between(root, [from, to], on),
            _ => false,
        }
    }

    /// The end of a pending join that is no point of the longer edge, if the other end is one.
    fn unnamed_end(&self, [a, b]: &[Piece<f64>; 2]) -> Option<Key> {
        [[a, b], [b, a]].into_iter().find_map(|[edge, longer]| {
            let (on, _) = self.found.root(longer.root);
            let [from, to] = self.ends(edge.root);
            let is_known = |end: Option<Key>| end.is_some_and(|p| self.part_end(p, on).is_some());
            match [is_known(from), is_known(to)] {
                [true, false] => to,
                [false, true] => from,
                _ => None,
            }
        })
    }

    /// Straight lines between two points of another are parts of that.
    fn join_parts_of_lines(&mut self) {
        self.name_points();
        for root in self.roots.clone() {
            let line = self.found.straightened(root).0;
            let Root::Segment(a, b) = line else { continue };
            let (own, alias) = self.found.root(line);
            if !is_whole(&alias) || self.found.point(a) == self.found.point(b) {
                continue;
            }
            let mut others: Vec<Root> = [a, b]
                .into_iter()
                .flat_map(|point| self.places_on_roots(point))
                .filter(|(_, root, ..)| matches!(root, Root::Segment(..)))
                .map(|(_, root, ..)| self.found.root(root))
                .filter(|(other, alias)| is_whole(alias) && *other != own)
                .map(|(other, _)| other)
                .collect();
            others.sort_unstable();
            others.dedup();
            for other in others {
                if let [Some(from), Some(to)] = [a, b].map(|end| self.part_end(end, other))
                    && self.place_between(line, [from, to], other)
                {
                    break;
                }
            }
        }
    }

    /// Collects the names of points that are defined on curves or surfaces.
    fn name_points(&mut self) {
        self.names.clear();
        for &name in &self.points {
            if let Some(Value::Point(point)) = self.graph.get(name).and_then(|o| o.value())
                && (point.on_curve.is_some() || point.on_surface.is_some())
            {
                self.names.entry(self.found.point(name)).or_default().push(name);
            }
        }
    }

    /// The points in use that are one with this, each with its positions on roots.
    fn places_on_roots(&self, point: Key) -> Vec<(Key, Root, f64, MarkSource)> {
        let names = self.names.get(&self.found.point(point)).into_iter().flatten();
        let mut places = Vec::new();
        for &name in names {
            if let Some(Value::Point(point)) = self.graph.get(name).and_then(|o| o.value()) {
                let on = places_of(point, name).into_iter();
                places.extend(on.map(|(root, t, source)| (name, root, t, source)));
            }
        }
        places
    }

    /// A point as the end of a part of a root that represents itself, with its parameter.
    fn part_end(&self, point: Key, on: Root) -> Option<(PartEnd, f64)> {
        let one = self.found.point(point);
        let is_it = |end: Option<Key>| end.is_some_and(|p| self.found.point(p) == one);
        match self.ends(on).map(is_it) {
            [true, false] => return Some((PartEnd::Begin, 0.0)),
            [false, true] => return Some((PartEnd::End, 1.0)),
            _ => {}
        }
        self.places_on_roots(point).into_iter().find_map(|(point, root, t, source)| {
            let (root, alias) = self.found.root(root);
            let edge = match source {
                MarkSource::Magnet { edge, .. } => Some(edge),
                _ => None,
            };
            let end = PartEnd::Point { point, edge, turned: is_turned(&alias) };
            let t = self.found.on_representative(&alias, t);
            (root == on && is_whole(&alias)).then_some((end, t))
        })
    }

    /// A root is the part of another between two points of that.
    fn place_between(&mut self, root: Root, [from, to]: [(PartEnd, f64); 2], on: Root) -> bool {
        let step = AliasStep::Between([from.0, to.0]);
        self.found.parts.insert(step, [from.1, to.1]);
        from.1 != to.1 && self.place_on(root, [step], on)
    }

    /// A root is on another by these steps from now on; false when that cannot be said of it, or is
    /// known.
    fn place_on(
        &mut self,
        root: Root,
        steps: impl IntoIterator<Item = AliasStep>,
        on: Root,
    ) -> bool {
        let [(child, own), (parent, further)] = [root, on].map(|root| self.found.root(root));
        if child == parent || !is_whole(&own) {
            return false;
        }
        // A turn is its own inverse.
        let mut alias = own;
        append(&mut alias, steps);
        append(&mut alias, further);
        self.found.roots.insert(child, (parent, alias));
        self.unions += 1;
        true
    }

    fn join_points(&mut self) {
        let mut groups: BTreeMap<Make, Vec<Key>> = BTreeMap::new();
        let mut seen = HashSet::new();
        for key in self.points.clone() {
            let key = self.found.point(key);
            if seen.insert(key) {
                let make = self.point_make(key);
                groups.entry(make).or_default().push(key);
            }
        }
        for group in groups.into_values().filter(|g| g.len() > 1) {
            let placed: Vec<(Key, Vec<Vec3>)> =
                group.into_iter().filter_map(|p| Some((p, vec![self.place(p)?]))).collect();
            for (a, b, _) in coincident(&placed) {
                self.join_point(a, b);
            }
        }
    }

    fn join_point(&mut self, a: Key, b: Key) {
        let [a, b] = [self.found.point(a), self.found.point(b)];
        if a == b {
            return;
        }
        // Objects have smaller keys than parts of them: names of the user's come first.
        let (kept, other) = (a.min(b), a.max(b));
        self.found.points.insert(other, kept);
        self.unions += 1;
    }

    fn join_lines(&mut self) {
        self.lines.clear();
        let mut groups: BTreeMap<Make, Vec<Root>> = BTreeMap::new();
        let mut seen = HashSet::new();
        for root in self.roots.clone() {
            let root = self.whole_root(root);
            if seen.insert(root) {
                let make = self.line_make(root);
                groups.entry(make).or_default().push(root);
            }
        }
        for group in groups.into_values().filter(|g| g.len() > 1) {
            let placed: Vec<(Root, Vec<Vec3>)> =
                group.into_iter().filter_map(|r| Some((r, self.places(r)?))).collect();
            for (a, b, turned) in coincident(&placed) {
                self.join_line(a, b, turned);
            }
        }
    }

    /// Two roots are one from now on, and so are their ends.
    fn join_line(&mut self, a: Root, b: Root, turned: bool) {
        let [(first, on_a), (second, on_b)] = [self.found.root(a), self.found.root(b)];
        match [is_whole(&on_a), is_whole(&on_b)] {
            [true, true] => {}
            // One of them is a part already; so is the other then.
            [true, false] => {
                self.place_on(a, turn(turned), b);
                return;
            }
            [false, true] => {
                self.place_on(b, turn(turned), a);
                return;
            }
            [false, false] => return,
        }
        let (a, b) = (first, second);
        let turned = turned ^ is_turned(&on_a) ^ is_turned(&on_b);
        if a == b {
            return;
        }
        let (kept, other) = if rank(a) <= rank(b) { (a, b) } else { (b, a) };
        self.found.roots.insert(other, (kept, Alias::from_iter(turn(turned))));
        self.unions += 1;
        let [from, to] = [kept, other].map(|root| self.ends(root));
        for k in 0..2 {
            if let (Some(p), Some(q)) = (from[k], to[if turned { 1 - k } else { k }]) {
                self.join_point(p, q);
            }
        }
    }

    /// The points at both ends of a root.
    fn ends(&self, root: Root) -> [Option<Key>; 2] {
        match root {
            Root::Curve(key) => self.curve(key).map_or([None; 2], |c| c.end_points()),
            Root::Segment(a, b) | Root::Governed(a, b, _) => [Some(a), Some(b)],
            Root::Edge(key, k) => {
                let known = self.surface(key).map(|s| s.edges().corners).unwrap_or_default();
                EDGE_CORNERS[usize::from(k)].map(|c| known[c].or_else(|| key.corner(c)))
            }
        }
    }
}

/// True for an edge of zero length within rounding.
fn has_no_length(surface: &SurfaceRef<f64>, k: usize) -> bool {
    let place = |t: f64| {
        let [u, v] = [[t, 0.0], [1.0, t], [t, 1.0], [0.0, t]][k];
        surface.jet(u, v, Order::Zero).p
    };
    let middle = surface.jet(0.5, 0.5, Order::Zero).p;
    let first = place(0.0);
    let near = SAME_PLACE * first.distance(middle) + 64.0 * f64::EPSILON * first.norm();
    TRIALS.iter().all(|&t| place(t).distance(first) <= near)
}

/// Curves of the user's keep their names before straight lines, and these before edges.
fn rank(root: Root) -> (u8, u32, u32) {
    match root {
        Root::Curve(key) => (0, key.0, 0),
        Root::Segment(a, b) | Root::Governed(a, b, _) => (1, a.0, b.0),
        Root::Edge(key, k) => (2, key.0, u32::from(k)),
    }
}

/// The pairs of coincident items, and whether one has the opposite direction: each with the first
/// at its position.
fn coincident<K: Copy>(placed: &[(K, Vec<Vec3>)]) -> Vec<(K, K, bool)> {
    let all = placed.iter().flat_map(|(_, points)| points.iter());
    let (mut bounds, mut far) = (Box3::EMPTY, 0.0f64);
    for &p in all {
        bounds = bounds.including(p);
        far = far.max(p.norm());
    }
    let near = SAME_PLACE * bounds.diagonal() + 64.0 * f64::EPSILON * far;
    // The middle is the same from both ends. Sorted along an oblique direction, only neighbours can meet.
    let middle = |k: usize| placed[k].1[placed[k].1.len() / 2].dot(Vec3::new(0.61, 0.53, 0.59));
    let mut order: Vec<usize> = (0..placed.len()).collect();
    order.sort_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
    let mut firsts: Vec<usize> = Vec::new();
    let mut pairs = Vec::new();
    for k in order {
        let points = &placed[k].1;
        let meets = |other: usize, turned: bool| {
            let n = points.len();
            let at = |i: usize| placed[other].1[if turned { n - 1 - i } else { i }];
            points.iter().enumerate().all(|(i, p)| p.distance(at(i)) <= near)
        };
        let candidates =
            firsts.iter().rev().take_while(|&&f| middle(k) - middle(f) <= near).copied();
        let found =
            candidates.flat_map(|f| [(f, false), (f, true)]).find(|&(f, turned)| meets(f, turned));
        match found {
            Some((first, turned)) => pairs.push((placed[first].0, placed[k].0, turned)),
            None => firsts.push(k),
        }
    }
    pairs
}

/// A list without repetitions, in the order of first mention.
struct Indexed<K> {
    all: Vec<K>,
    known: HashSet<K>,
}

fn indexed<K>() -> Indexed<K> {
    Indexed { all: Vec::new(), known: Default::default() }
}

impl<K: Copy + Eq + Hash> Indexed<K> {
    fn add(&mut self, key: K) {
        if self.known.insert(key) {
            self.all.push(key);
        }
    }
}
