//! Roots of curves and edges: the identities by which meshes join exactly.
//!
//! An edge of a surface is a chain of pieces of *root* curves. Two patches share the vertices of a
//! piece if root, ends and division are the same objects; never because numbers are equal.
//! Sub-curves, edge snakes and the like are aliases: they forward the trace of their original.

use crate::Real;
use smallvec::{SmallVec, smallvec};

/// The identity of a named object, assigned by the model, or of an unnamed part of one: a corner or
/// an edge of a surface, an end of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(pub u32);

/// Element named by a [`Key`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// An object.
    Object(Key),
    /// Corner 0..4, (u,v) = (0,0), (1,0), (1,1), (0,1), of a surface object.
    Corner(Key, usize),
    /// Edge 0..4 (v = 0, u = 1, v = 1, u = 0) of a surface object.
    Edge(Key, usize),
    /// The begin (0) or the end (1) of a curve object.
    End(Key, usize),
    /// Joint k of a curve object, among those of [`crate::Curve::joints`].
    Joint(Key, usize),
}

/// Objects have numbers below this; a part has its kind above them.
const PART: u32 = 1 << 24;

/// The kind of the first joint; those of corners, edges and ends are below.
const FIRST_JOINT: u32 = 11;

impl Key {
    fn part(self, kind: u32) -> Option<Key> {
        (self.0 < PART).then(|| Key(self.0 + PART * kind))
    }

    /// The identity of corner `k` of this surface; `None` for a key that is not an object.
    pub fn corner(self, k: usize) -> Option<Key> {
        self.part(1 + k as u32)
    }

    /// The identity of edge `k` of this surface.
    pub fn edge(self, k: usize) -> Option<Key> {
        self.part(5 + k as u32)
    }

    /// The identity of the begin (0) or the end (1) of this curve.
    pub fn end(self, k: usize) -> Option<Key> {
        self.part(9 + k as u32)
    }

    /// The identity of joint `k` of this curve; `None` beyond the first 245.
    pub fn joint(self, k: usize) -> Option<Key> {
        let kind = FIRST_JOINT + u32::try_from(k).ok()?;
        (kind <= u32::MAX / PART).then(|| self.part(kind))?
    }

    /// The named element.
    pub fn named(self) -> Named {
        let of = Key(self.0 % PART);
        match (self.0 / PART) as usize {
            kind @ 1..=4 => Named::Corner(of, kind - 1),
            kind @ 5..=8 => Named::Edge(of, kind - 5),
            kind @ 9..=10 => Named::End(of, kind - 9),
            0 => Named::Object(self),
            kind => Named::Joint(of, kind - FIRST_JOINT as usize),
        }
    }
}

/// The corners at the begin and end of edge 0..4 of a surface.
pub const EDGE_CORNERS: [[usize; 2]; 4] = [[0, 1], [1, 2], [3, 2], [0, 3]];

/// The identity of a root: an object, or one of the four edges of a surface object if it has no
/// curve object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Root {
    /// A curve object.
    Curve(Key),
    /// Edge 0..4 (v = 0, u = 1, v = 1, u = 0) of a surface object.
    Edge(Key, u8),
    /// The straight line between two point objects, from the smaller key (t = 0) to the greater:
    /// any straight line with constant speed between the same two points.
    Segment(Key, Key),
    /// The segment from the first to the second, reparametrised by a law (the third): t is the
    /// law's argument.
    Governed(Key, Key, Key),
}

impl Root {
    /// The begin or the end of the root, at t = 0 or 1, if the root itself determines it.
    pub fn end(self, t: f64) -> Option<Key> {
        let k = match t {
            0.0 => 0,
            1.0 => 1,
            _ => return None,
        };
        match self {
            Root::Curve(key) => key.end(k),
            Root::Edge(key, edge) => key.corner(EDGE_CORNERS[usize::from(edge)][k]),
            Root::Segment(a, b) | Root::Governed(a, b, _) => Some([a, b][k]),
        }
    }
}

/// End of a piece on its root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark<T> {
    /// Parameter on the root.
    pub t: T,
    /// The point object there, if any: a bead, or the end point of the root.
    pub point: Option<Key>,
}

/// A part of a root, from `from` to `to` (which may be backwards), linear in its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<T> {
    /// Its root.
    pub root: Root,
    /// Start.
    pub from: Mark<T>,
    /// End.
    pub to: Mark<T>,
    /// The end of this piece in the alias's parameter, from 0 to 1 (the last: 1).
    pub until: T,
}

impl<T: Real> Piece<T> {
    /// The piece for a whole straight line between point objects that is reparametrised by the law
    /// `law`; `None` for any other piece.
    pub fn governed(&self, law: Key) -> Option<Self> {
        let (Root::Segment(..), Some(from), Some(to)) = (self.root, self.from.point, self.to.point)
        else {
            return None;
        };
        let ends = [self.from.t.re(), self.to.t.re()];
        (ends == [0.0, 1.0] || ends == [1.0, 0.0]).then(|| Piece {
            root: Root::Governed(from, to, law),
            from: Mark { t: T::zero(), point: Some(from) },
            to: Mark { t: T::one(), point: Some(to) },
            until: T::one(),
        })
    }

    /// The mark on the root where the alias, in which the piece begins at `begin`, has `mark`.
    fn mark(&self, begin: T, mark: Mark<T>) -> Mark<T> {
        let share = (mark.t - begin) / (self.until - begin);
        Mark { t: self.from.t + (self.to.t - self.from.t) * share, point: mark.point }
    }

    /// The straight line from one point object to another, up to the fraction `until` of the alias;
    /// `None` if they are the same.
    pub fn straight(from: Key, to: Key, until: T) -> Option<Self> {
        let mark = |point: Key, other: Key| Mark {
            t: if point < other { T::zero() } else { T::one() },
            point: Some(point),
        };
        (from != to).then(|| Piece {
            root: Root::Segment(from.min(to), from.max(to)),
            from: mark(from, to),
            to: mark(to, from),
            until,
        })
    }
}

/// Roots of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Trace<T> {
    /// The curve is its own root; the point objects at its ends, if any.
    Own([Option<Key>; 2]),
    /// The curve is an alias of pieces of roots.
    Pieces(SmallVec<[Piece<T>; 1]>),
    /// The curve is a single point object.
    Point(Option<Key>),
}

impl<T: Real> Trace<T> {
    /// A curve that is its own root, without known end points.
    pub fn own() -> Self {
        Trace::Own([None, None])
    }

    /// A straight line between two points with constant speed: on the segment of its point objects,
    /// or a point if both are the same.
    pub fn straight(ends: [Option<Key>; 2]) -> Self {
        match ends {
            [Some(from), Some(to)] => match Piece::straight(from, to, T::one()) {
                Some(piece) => Trace::Pieces(smallvec![piece]),
                None => Trace::Point(Some(from)),
            },
            _ => Trace::Own(ends),
        }
    }

    /// The chain of pieces of a curve with this trace and the object `root`.
    pub fn pieces(&self, root: Root) -> SmallVec<[Piece<T>; 1]> {
        match self {
            Trace::Own(ends) => smallvec![Piece {
                root,
                from: Mark { t: T::zero(), point: ends[0] },
                to: Mark { t: T::one(), point: ends[1] },
                until: T::one(),
            }],
            Trace::Pieces(pieces) => pieces.clone(),
            Trace::Point(_) => SmallVec::new(),
        }
    }

    /// The trace of the part between two marks in the alias's parameter, which may run backwards:
    /// whole pieces, and parts of the first and last. A part of a point is that point; a part of
    /// zero length, or one that extends beyond a curve of several pieces, is its own root.
    pub fn part(&self, root: Root, from: Mark<T>, to: Mark<T>) -> Self {
        if let Trace::Point(point) = self {
            return Trace::Point(*point);
        }
        let pieces = self.pieces(root);
        if let [whole] = pieces.as_slice() {
            let whole = *whole;
            return Trace::Pieces(smallvec![Piece {
                root: whole.root,
                from: whole.mark(T::zero(), from),
                to: whole.mark(T::zero(), to),
                until: T::one(),
            }]);
        }
        let backwards = to.t.re() < from.t.re();
        let [low, high] = if backwards { [to, from] } else { [from, to] };
        let inside = low.t.re() >= 0.0 && high.t.re() <= 1.0 && low.t.re() < high.t.re();
        if !inside {
            return Trace::Own([from.point, to.point]);
        }
        let mut all: SmallVec<[Piece<T>; 1]> = SmallVec::new();
        let mut begin = T::zero();
        for piece in &pieces {
            let until = piece.until;
            if until.re() > low.t.re() && begin.re() < high.t.re() {
                // At a joint the point that the curves have in common is the mark's own.
                let from = if begin.re() < low.t.re() {
                    piece.mark(begin, low)
                } else {
                    Mark {
                        point: piece.from.point.or(all.is_empty().then_some(low.point).flatten()),
                        ..piece.from
                    }
                };
                let last = until.re() >= high.t.re();
                let to = if until.re() > high.t.re() {
                    piece.mark(begin, high)
                } else {
                    Mark {
                        point: piece.to.point.or(last.then_some(high.point).flatten()),
                        ..piece.to
                    }
                };
                let share = if last { T::one() } else { (until - low.t) / (high.t - low.t) };
                all.push(Piece { root: piece.root, from, to, until: share });
            }
            begin = until;
        }
        if backwards {
            let ends: Vec<T> = all.iter().map(|p| p.until).collect();
            all.reverse();
            let count = all.len();
            for (k, piece) in all.iter_mut().enumerate() {
                std::mem::swap(&mut piece.from, &mut piece.to);
                piece.until =
                    if k + 1 == count { T::one() } else { T::one() - ends[count - 2 - k] };
            }
        }
        Trace::Pieces(all)
    }
}

/// One edge of a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Edge<T> {
    /// The surface's own edge.
    Own,
    /// Along a chain of pieces.
    Pieces(SmallVec<[Piece<T>; 1]>),
    /// The edge is the line of edge 0..4 of this surface, in the same direction (a closed surface).
    SameAs(u8),
    /// A single point, with its object if it has one.
    Pole(Option<Key>),
}

/// The four edges of a surface (v = 0, u = 1, v = 1, u = 0, each in increasing parameter), and the
/// known point objects at its corners (u,v) = (0,0), (1,0), (1,1), (0,1).
#[derive(Clone, Debug, PartialEq)]
pub struct Edges<T> {
    /// The edges.
    pub edges: [Edge<T>; 4],
    /// The corners.
    pub corners: [Option<Key>; 4],
}

impl<T: Real> Edges<T> {
    /// Four edges that are their own roots.
    pub fn own() -> Self {
        Edges { edges: [Edge::Own, Edge::Own, Edge::Own, Edge::Own], corners: [None; 4] }
    }

    /// The same edges with edge `k` (0..4) replaced.
    pub fn with(mut self, k: usize, edge: Edge<T>) -> Self {
        self.edges[k] = edge;
        self
    }
}

/// Relation of the parameters (a, b) of a solid's face to those of a surface: swapped or not, then
/// each reversed or not. These are bits 0, 1 and 2 of its number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Turn(pub u8);

impl Turn {
    /// The eight turns.
    pub const ALL: [Turn; 8] =
        [Turn(0), Turn(1), Turn(2), Turn(3), Turn(4), Turn(5), Turn(6), Turn(7)];

    /// True when u of the surface is along b of the face.
    pub fn swaps(self) -> bool {
        self.0 & 1 == 1
    }

    /// True when parameter 0 (u) or 1 (v) of the surface is opposite to the face's.
    pub fn flips(self, parameter: usize) -> bool {
        self.0 >> (1 + parameter) & 1 == 1
    }

    /// The (u, v) of the surface for (a, b) of the face, all from 0 to 1.
    pub fn place<S: Real>(self, a: S, b: S) -> [S; 2] {
        let p = if self.swaps() { [b, a] } else { [a, b] };
        [0, 1].map(|k| if self.flips(k) { -p[k] + 1.0 } else { p[k] })
    }

    /// The surface's edge 0..4 along face edge 0..4, and true if the directions are opposite.
    pub fn edge(self, k: usize) -> (usize, bool) {
        // Face edges: 0 b = 0, 1 a = 1, 2 b = 1, 3 a = 0. On the surface, `across` is fixed.
        let (along, high) = [(0, 0), (1, 1), (0, 1), (1, 0)][k];
        let (along, across) = if self.swaps() { (1 - along, along) } else { (along, 1 - along) };
        let high = (high == 1) != self.flips(across);
        let edge = match (along, high) {
            (0, false) => 0,
            (1, true) => 1,
            (0, true) => 2,
            _ => 3,
        };
        (edge, self.flips(along))
    }
}

/// One face of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Face<T> {
    /// The solid's own face.
    Own,
    /// The whole of a surface, with the roots of its edges.
    On {
        /// The surface object; a face without one joins no other.
        surface: Option<Key>,
        /// The solid with that surface as a face, if there is one.
        face_of: Option<(Key, u8)>,
        /// Relation of the face's parameters to those of the surface.
        turn: Turn,
        /// Its edges.
        edges: Box<Edges<T>>,
    },
    /// The face coincides with face 0..6 of the solid (a closed solid), at equal parameters.
    SameAs(u8),
}

/// Law of the points between the layers of a solid: solids with common layers and the same law
/// share the points between these too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LayerLaw {
    /// B-splines of this degree across the layers.
    Blend(usize),
    /// An interpolating spline with ends of this number.
    Spline(usize),
    /// The first layer moved along a curve object, or along an unnamed curve; the number states
    /// how.
    Along(Option<Key>, u8),
}

/// The surfaces that determine a solid's lines along w, point by point at equal u and v.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers<T> {
    /// The surface objects with their edges, in order of w.
    pub surfaces: Vec<(Option<Key>, Edges<T>)>,
    /// Law between them.
    pub law: LayerLaw,
}

/// Roots of the six faces of a solid: u = 0, u = 1, v = 0, v = 1, w = 0, w = 1; the parameters of a
/// face are the other two, in order. Also the point objects at its corners, if the solid alone
/// determines them; u, v, w are bits 0, 1 and 2 of a corner's number.
#[derive(Clone, Debug, PartialEq)]
pub struct Faces<T> {
    /// The faces.
    pub faces: [Face<T>; 6],
    /// The corners.
    pub corners: [Option<Key>; 8],
    /// For solids made of surfaces along w.
    pub layers: Option<Layers<T>>,
}

impl<T: Real> Faces<T> {
    /// Six faces that belong to this solid alone.
    pub fn own() -> Self {
        Faces {
            faces: [Face::Own, Face::Own, Face::Own, Face::Own, Face::Own, Face::Own],
            corners: [None; 8],
            layers: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root and the parameter on it where an alias of pieces has `t`.
    fn place(pieces: &[Piece<f64>], t: f64) -> (Root, f64) {
        let k = pieces.iter().position(|p| t <= p.until).unwrap_or(pieces.len() - 1);
        let begin = if k == 0 { 0.0 } else { pieces[k - 1].until };
        let piece = &pieces[k];
        let share = (t - begin) / (piece.until - begin);
        (piece.root, piece.from.t + (piece.to.t - piece.from.t) * share)
    }

    #[test]
    fn a_part_runs_along_the_pieces_of_the_whole() {
        // Five pieces, some of them parts of curves and some backwards; all pairs of marks among 21.
        let untils = [0.1, 0.35, 0.5, 0.8, 1.0];
        let ts = [[0.0, 1.0], [1.0, 0.0], [0.2, 0.7], [0.9, 0.4], [0.0, 1.0]];
        let joint = |k: usize| Some(Key(100 + k as u32));
        let pieces: SmallVec<[Piece<f64>; 1]> = (0..5)
            .map(|k| Piece {
                root: Root::Curve(Key(k as u32)),
                from: Mark { t: ts[k][0], point: joint(k) },
                to: Mark { t: ts[k][1], point: joint(k + 1) },
                until: untils[k],
            })
            .collect();
        let whole = Trace::Pieces(pieces.clone());
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))).filter(|(i, j)| i != j) {
            let [from, to] = [i, j].map(|k| f64::from(k) / 20.0);
            let marks = [from, to].map(|t| Mark { t, point: Some(Key((t * 20.0) as u32)) });
            let Trace::Pieces(part) = whole.part(Root::Curve(Key(99)), marks[0], marks[1]) else {
                panic!("{from} {to}")
            };
            assert_eq!(part[part.len() - 1].until, 1.0);
            assert!(part.windows(2).all(|p| p[0].until < p[1].until), "{from} {to}: {part:?}");
            for k in 0..40 {
                // Never at a joint, where the piece before and the one after are both right.
                let s = (f64::from(k) + 0.37) / 40.0;
                let (root, t) = place(&part, s);
                let (expected, at) = place(&pieces, from + (to - from) * s);
                assert!(root == expected && (t - at).abs() < 1e-12, "{from} {to} {s}");
            }
            // A mark at a joint is the joint's point, any other its own.
            let ends = [(from, part[0].from), (to, part[part.len() - 1].to)];
            for (mark, (t, end)) in marks.into_iter().zip(ends) {
                let at = [0.0, 0.1, 0.35, 0.5, 0.8, 1.0].into_iter().position(|u| u == t);
                assert_eq!(end.point, at.map_or(mark.point, joint), "{from} {to}");
            }
        }
        // Parts that leave it, and those without length, are curves of their own.
        let mark = |t: f64| Mark { t, point: None };
        for (a, b) in [(-0.1, 0.5), (0.5, 1.1), (0.4, 0.4), (f64::NAN, 0.5)] {
            assert_eq!(whole.part(Root::Curve(Key(99)), mark(a), mark(b)), Trace::own());
        }
    }

    #[test]
    fn turns_know_their_edges() {
        let ends = [
            [[0., 0.], [1., 0.]],
            [[1., 0.], [1., 1.]],
            [[0., 1.], [1., 1.]],
            [[0., 0.], [0., 1.]],
        ];
        for turn in Turn::ALL {
            for (k, [from, to]) in ends.into_iter().enumerate() {
                let (edge, against) = turn.edge(k);
                let [mut start, mut end] = ends[edge];
                if against {
                    std::mem::swap(&mut start, &mut end);
                }
                assert_eq!(turn.place(from[0], from[1]), start, "{turn:?} {k}");
                assert_eq!(turn.place(to[0], to[1]), end, "{turn:?} {k}");
            }
        }
    }
}
