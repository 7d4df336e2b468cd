//! Common part of all lofts: the master curves, and the edges that follow from them.

use moldloft_num::trace::{Edge, Edges, Key, Piece, Trace};
use moldloft_num::{Jet, Order, Pace, Rational, Real, Uni1, Vec3, Weight};
use moldloft_registry::{CallError, CurveRef, FieldId};
use smallvec::SmallVec;

/// A short list of positions: those of a few masters stay on the stack.
pub type Points<S> = SmallVec<[Vec3<S>; 6]>;

/// The master curves of a loft, two or more.
pub struct Masters<T: Real>(Vec<CurveRef<T>>);

impl<T: Real> Masters<T> {
    /// # Errors
    /// `too-few-items`, in field `field`, for fewer than two curves.
    pub fn new(curves: Vec<CurveRef<T>>, field: FieldId) -> Result<Self, CallError> {
        if curves.len() >= 2 {
            return Ok(Self(curves));
        }
        Err(CallError::new("too-few-items", "a loft needs at least 2 curves")
            .expected("at least 2 curves")
            .found(curves.len().to_string())
            .in_field(field))
    }

    pub fn curves(&self) -> &[CurveRef<T>] {
        &self.0
    }

    /// The positions of all masters at `u`.
    pub fn at<J: Jet<T>>(&self, u: J) -> Points<J> {
        self.0.iter().map(|curve| curve.at(u)).collect()
    }

    /// The positions at the plain number `u`, with their derivatives by u.
    pub fn with_slopes(&self, u: f64) -> Points<Uni1<T>> {
        let jet = |curve: &CurveRef<T>| {
            let [p, d, _] = curve.jet(T::from(u), Order::First);
            Vec3::new(Uni1 { f: p.x, t: d.x }, Uni1 { f: p.y, t: d.y }, Uni1 { f: p.z, t: d.z })
        };
        self.0.iter().map(jet).collect()
    }

    /// The parameters u at which a master has a break.
    pub fn breaks(&self) -> Vec<f64> {
        self.merged(|curve| curve.breaks())
    }

    /// The parameters u at which the first derivative of a master may jump.
    pub fn kinks(&self) -> Vec<f64> {
        self.merged(|curve| curve.kinks())
    }

    /// The parameters u of joints of masters.
    pub fn joints(&self) -> Vec<f64> {
        self.merged(|curve| curve.joints())
    }

    /// Homogeneous form of surfaces that are linear in the masters: equal speed along all, and the
    /// product of their different weights.
    pub fn rational(&self) -> Rational<2> {
        let all: Vec<Rational<1>> = self.0.iter().map(|c| c.rational()).collect();
        let [pace] = all[0].paces;
        if all.iter().any(|r| r.paces != [pace]) {
            return Rational::none();
        }
        let mut weights: Vec<Weight<1>> = Vec::new();
        for weight in all.into_iter().filter_map(|r| r.weight) {
            let samples = (0..=64).map(|k| [f64::from(k) / 64.0]);
            let near = |x: f64, y: f64| (x - y).abs() <= 1e-15 * 8.0 * x.abs();
            let known = |w: &Weight<1>| samples.clone().all(|s| near(w(s), weight(s)));
            if !weights.iter().any(known) {
                weights.push(weight);
            }
        }
        let paces = [pace, Pace::Even];
        if weights.is_empty() {
            return Rational::paced(paces);
        }
        let weight: Weight<2> = Box::new(move |[u, _]| weights.iter().map(|w| w([u])).product());
        Rational { paces, weight: Some(weight) }
    }

    fn merged(&self, of: impl Fn(&CurveRef<T>) -> Vec<f64>) -> Vec<f64> {
        let mut all: Vec<f64> = self.0.iter().flat_map(of).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// The points that the line u = 0 (end 0) or u = 1 of a loft is determined by: the masters' ends.
    pub fn ends(&self, end: usize) -> Vec<Key> {
        self.0.iter().filter_map(|c| c.end_points()[end]).collect()
    }

    /// Identity of the edges: ends of the masters for edges across them, first and last master for
    /// edges along them.
    pub fn edge_made_of(&self, k: usize) -> Vec<Key> {
        match k {
            0 => self.0[0].made_of(),
            1 => self.ends(1),
            2 => self.0[self.0.len() - 1].made_of(),
            _ => self.ends(0),
        }
    }

    /// The edges of a surface that is straight from each master to the next, at uniform steps of v:
    /// as [`Masters::edges`], with the segments between the masters' ends as the other two.
    pub fn straight_edges(&self) -> Edges<T> {
        let mut edges = self.edges();
        let steps = self.0.len() - 1;
        for (end, k) in [(1, 1), (0, 3)] {
            if edges.edges[k] != Edge::Own {
                continue;
            }
            let ends: Vec<Option<Key>> = self.0.iter().map(|c| c.end_points()[end]).collect();
            let pieces: Option<_> = (ends.windows(2).enumerate())
                .map(|(n, pair)| {
                    let until = if n + 1 == steps { 1.0 } else { (n + 1) as f64 / steps as f64 };
                    Piece::straight(pair[0]?, pair[1]?, T::from(until))
                })
                .collect();
            if let Some(pieces) = pieces {
                edges = edges.with(k, Edge::Pieces(pieces));
            }
        }
        edges
    }

    /// The edges of a surface from the first master at v = 0 to the last at v = 1, which are its
    /// edges along u. If all masters meet in one point object, the edge across is that point; if
    /// each master begins and ends in one point object, the surface is closed.
    pub fn edges(&self) -> Edges<T> {
        let (first, last) = (&self.0[0], &self.0[self.0.len() - 1]);
        let ends: Vec<[Option<Key>; 2]> = self.0.iter().map(|c| c.end_points()).collect();
        let across = |end: usize| {
            let point = ends[0][end];
            let meet = point.is_some() && ends.iter().all(|e| e[end] == point);
            if meet { Edge::Pole(point) } else { Edge::Own }
        };
        let ([a, b], [d, c]) = (ends[0], ends[ends.len() - 1]);
        let closed = ends.iter().all(|&e| is_closed(e));
        let east = match across(1) {
            Edge::Own if closed => Edge::SameAs(3),
            edge => edge,
        };
        Edges { edges: [along(first), east, along(last), across(0)], corners: [a, b, c, d] }
    }
}

/// True when a curve with these end points begins and ends in one point object.
pub fn is_closed([start, end]: [Option<Key>; 2]) -> bool {
    start.is_some() && start == end
}

/// The edge along the whole of a curve.
pub fn along<T: Real>(curve: &CurveRef<T>) -> Edge<T> {
    if let Trace::Point(point) = curve.trace() {
        return Edge::Pole(point);
    }
    let pieces = curve.pieces();
    if pieces.is_empty() { Edge::Own } else { Edge::Pieces(pieces) }
}
