//! Curves and surfaces whose parameter is redistributed by a law: the `relabel` of their heads.

use crate::{
    CallError, Class, CurveRef, FieldSpec, FromValue, ReparametrizationRef, SurfaceRef, Value,
};
use moldloft_num::trace::{Edge, Edges, Mark, Piece, Trace};
use moldloft_num::{
    Composed, Curve, CurveJet, Order, Real, Reparametrization, ReparametrizationJet, SurfJet,
    Surface, Vec3, inv_reparametrization, inv_reparametrization_in, line_crossings,
};
use smallvec::SmallVec;
use std::sync::Arc;

/// The last argument of every kind of curve, and of every surface whose direction across its
/// masters can be reparametrised.
pub const RELABEL_FIELD: FieldSpec =
    FieldSpec::new("relabel", Class::Relabel, "Reparametrisation of t (surfaces: v).").optional();

/// Breaks nearer to each other than this are one.
const ONE_BREAK: f64 = 1e-12;

/// The curve C(t) = c(R(t)), or the surface S(u, v) = s(u, R(v)); the value itself without a law.
///
/// Beads, meshes, sub-curves and neighbours all see the new parameter. A curve that is a root for
/// joins stays one, so neighbours along it share its vertices at equal t. A part of another curve
/// stays such a part where the law is straight; elsewhere its divisions are not the other's, and it
/// is a root of its own between the same points. Straight lines and edges between the same point
/// objects under the same law are one.
///
/// # Errors
/// `wrong-class` if the law is not a reparametrisation.
pub fn relabelled<T: Real>(value: Value<T>, law: &Value<T>) -> Result<Value<T>, CallError> {
    let Some(law) = Option::<ReparametrizationRef<T>>::from_value(law)? else { return Ok(value) };
    if law.is_straight() && law.breaks().is_empty() && reaches(&law) == [true; 2] {
        return Ok(value);
    }
    Ok(match value {
        Value::Curve(curve) => {
            let (nesting, surface) = (curve.depth.max(law.depth), curve.surface.clone());
            let (found, figures) = (curve.found.clone(), curve.figures.clone());
            let shape = RelabelledCurve { curve, law };
            let mut relabelled = match surface {
                Some(surface) => CurveRef::snake(shape, *surface, nesting),
                None => CurveRef::new(shape, nesting),
            };
            relabelled.found = found;
            relabelled.figures = figures;
            Value::Curve(relabelled)
        }
        Value::Surface(surface) => {
            let nesting = surface.depth.max(law.depth);
            let (found, figures) = (surface.found.clone(), surface.figures.clone());
            let shape = RelabelledSurface { surface, law };
            let mut relabelled = SurfaceRef::new(shape, nesting);
            relabelled.found = found;
            relabelled.figures = figures;
            Value::Surface(relabelled)
        }
        other => other,
    })
}

/// Whether the law starts at 0, and whether it ends at 1: a partial one may not.
fn reaches<T: Real>(law: &ReparametrizationRef<T>) -> [bool; 2] {
    [0.0, 1.0].map(|end| law.jet(T::from(end), Order::Zero)[0].re() == end)
}

/// The breaks of the law, and where it reaches those of the shape.
fn breaks<T: Real>(law: &ReparametrizationRef<T>, of_shape: Vec<f64>) -> Vec<f64> {
    let mut all = law.breaks();
    let [low, high] = [0.0, 1.0].map(|end| law.jet(T::from(end), Order::Zero)[0].re());
    let inside = of_shape.into_iter().filter(|b| low < *b && *b < high);
    all.extend(inside.map(|b| inv_reparametrization(&**law, b)));
    all.retain(|t| *t > 0.0 && *t < 1.0);
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a < ONE_BREAK);
    all
}

/// The values of the law at plain parameters; as plain numbers too, when they carry no derivatives.
fn values<T: Real>(law: &ReparametrizationRef<T>, ts: &[f64]) -> (Vec<T>, Option<Vec<f64>>) {
    let values: Vec<T> = ts.iter().map(|&t| law.jet(T::from(t), Order::Zero)[0]).collect();
    let plain = values.iter().all(|r| r.is_constant());
    let plain = plain.then(|| values.iter().map(|r| r.re()).collect());
    (values, plain)
}

/// Straight lines between the same points, run by the same law, are one.
fn governed<T: Real>(
    law: &ReparametrizationRef<T>,
    pieces: &[Piece<T>],
) -> Option<SmallVec<[Piece<T>; 1]>> {
    match pieces {
        [piece] => Some(std::iter::once(piece.governed(law.key?)?).collect()),
        _ => None,
    }
}

/// The same pieces run by a law; `None` where their divisions are no one else's.
fn pieces_by<T: Real>(
    law: &ReparametrizationRef<T>,
    pieces: &[Piece<T>],
) -> Option<SmallVec<[Piece<T>; 1]>> {
    if !law.is_straight() {
        return governed(law, pieces);
    }
    // Values at the breaks of the law.
    let turns: Vec<T> =
        law.breaks().into_iter().map(|b| law.jet(T::from(b), Order::Zero)[0]).collect();
    let mut out = SmallVec::new();
    let mut begin = T::zero();
    for (k, piece) in pieces.iter().enumerate() {
        let end = piece.until;
        let mut from = piece.from;
        let inside = |r: &&T| r.re() > begin.re() + ONE_BREAK && r.re() < end.re() - ONE_BREAK;
        for &turn in turns.iter().filter(inside) {
            let share = (turn - begin) / (end - begin);
            let t = piece.from.t + (piece.to.t - piece.from.t) * share;
            let to = Mark { t, point: None };
            out.push(Piece {
                root: piece.root,
                from,
                to,
                until: inv_reparametrization_in(&**law, turn),
            });
            from = to;
        }
        let until =
            if k + 1 == pieces.len() { T::one() } else { inv_reparametrization_in(&**law, end) };
        out.push(Piece { root: piece.root, from, to: piece.to, until });
        begin = end;
    }
    Some(out)
}

struct RelabelledCurve<T: Real> {
    curve: CurveRef<T>,
    law: ReparametrizationRef<T>,
}

impl<T: Real> RelabelledCurve<T> {
    fn chained(&self, t: T, order: Order, jet: impl Fn(T) -> CurveJet<T>) -> CurveJet<T> {
        let [r, r1, r2] = self.law.jet(t, order);
        let [p, d, dd] = jet(r);
        [p, d * r1, dd * (r1 * r1) + d * r2]
    }
}

impl<T: Real> Curve<T> for RelabelledCurve<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.chained(t, order, |r| self.curve.jet(r, order))
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        let (values, plain) = values(&self.law, ts);
        if let Some(plain) = plain {
            return self.curve.grid(&plain, out);
        }
        for (p, r) in out.iter_mut().zip(values) {
            *p = self.curve.jet(r, Order::Zero)[0];
        }
    }

    fn breaks(&self) -> Vec<f64> {
        breaks(&self.law, self.curve.breaks())
    }

    fn joints(&self) -> Vec<f64> {
        breaks(&self.law, self.curve.joints())
    }

    fn trace(&self) -> Trace<T> {
        let whole = reaches(&self.law);
        match self.curve.trace() {
            Trace::Point(point) => Trace::Point(point),
            // A part is a curve of its own; it shares the end of the whole only if it reaches it.
            _ if whole != [true; 2] => {
                let ends = self.curve.end_points();
                Trace::Own([0, 1].map(|k| ends[k].filter(|_| whole[k])))
            }
            Trace::Pieces(pieces) => match pieces_by(&self.law, &pieces) {
                Some(pieces) => Trace::Pieces(pieces),
                None => Trace::Own(self.curve.end_points()),
            },
            other => other,
        }
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        self.curve.on_surface(t, Order::Zero)?;
        let place = |r: T| self.curve.on_surface(r, order).unwrap_or_default();
        Some(self.chained(t, order, place))
    }

    fn law(&self) -> Option<Arc<dyn Reparametrization<T>>> {
        let first = self.law.law().clone();
        Some(match self.curve.law() {
            Some(second) => Arc::new(Composed { first, second }),
            None => first,
        })
    }

    fn kinks(&self) -> Vec<f64> {
        breaks(&self.law, self.curve.kinks())
    }

    moldloft_num::curve_facts!(open, not_rational);
}

struct RelabelledSurface<T: Real> {
    surface: SurfaceRef<T>,
    law: ReparametrizationRef<T>,
}

impl<T: Real> RelabelledSurface<T> {
    fn chained(s: SurfJet<T>, [_, r1, r2]: ReparametrizationJet<T>) -> SurfJet<T> {
        SurfJet { v: s.v * r1, uv: s.uv * r1, vv: s.vv * (r1 * r1) + s.v * r2, ..s }
    }
}

impl<T: Real> Surface<T> for RelabelledSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        let law = self.law.jet(v, order);
        Self::chained(self.surface.jet(u, law[0], order), law)
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        let (values, plain) = values(&self.law, vs);
        if let Some(plain) = plain {
            return self.surface.grid(us, &plain, points, normals);
        }
        let order = if normals.is_some() { Order::First } else { Order::Zero };
        for (i, &u) in us.iter().enumerate() {
            for (j, &r) in values.iter().enumerate() {
                let k = i * vs.len() + j;
                // The normal is that of the surface, also where the law has no slope.
                let jet = self.surface.jet(T::from(u), r, order);
                points[k] = jet.p;
                if let Some(normals) = normals.as_deref_mut() {
                    normals[k] = jet.normal();
                }
            }
        }
    }

    fn scattered(&self, uv: &[[f64; 2]], out: &mut [Vec3<T>]) {
        let vs: Vec<f64> = uv.iter().map(|w| w[1]).collect();
        let (values, plain) = values(&self.law, &vs);
        if let Some(plain) = plain {
            let uv: Vec<[f64; 2]> = uv.iter().zip(plain).map(|(w, r)| [w[0], r]).collect();
            return self.surface.scattered(&uv, out);
        }
        for ((p, w), r) in out.iter_mut().zip(uv).zip(values) {
            *p = self.surface.jet(T::from(w[0]), r, Order::Zero).p;
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        let [u, v] = self.surface.breaks();
        [u, breaks(&self.law, v)]
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        let [u, v] = self.surface.joints();
        [u, breaks(&self.law, v)]
    }

    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        let of_law = [Vec::new(), breaks(&self.law, Vec::new())];
        let own = line_crossings(&of_law, path, spans);
        let mut finer = spans.to_vec();
        finer.extend(&own);
        finer.sort_by(f64::total_cmp);
        finer.dedup();
        let inside = |t: f64| {
            let [u, v] = path(t);
            [u, self.law.jet(T::from(v), Order::Zero)[0].re()]
        };
        let mut all = self.surface.crossings(&inside, &finer);
        all.extend(own);
        all
    }

    fn inner_planes(&self) -> Vec<moldloft_num::InnerPlane<'_>> {
        let inside = |[u, v]: [f64; 2]| [u, self.law.jet(T::from(v), Order::Zero)[0].re()];
        self.surface.inner_planes().into_iter().map(|plane| plane.through(inside)).collect()
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        self.surface.edge_made_of(k)
    }

    fn edges(&self) -> Edges<T> {
        let mut edges = self.surface.edges();
        let whole = reaches(&self.law);
        if whole != [true; 2] {
            for (end, k) in [(0, 0), (1, 2)] {
                if !whole[end] {
                    edges.edges[k] = Edge::Own;
                    edges.corners[k] = None;
                    edges.corners[k + 1] = None;
                }
            }
            // A seam between the two is then open, and the sides are parts of the original ones.
            for k in 0..4 {
                let keeps = match &edges.edges[k] {
                    Edge::Pole(_) | Edge::Own => true,
                    Edge::SameAs(_) => k % 2 == 1,
                    Edge::Pieces(_) => k % 2 == 0,
                };
                if !keeps {
                    edges.edges[k] = Edge::Own;
                }
            }
            return edges;
        }
        for k in [1, 3] {
            if let Edge::Pieces(pieces) = &edges.edges[k] {
                edges.edges[k] = match governed(&self.law, pieces) {
                    Some(pieces) => Edge::Pieces(pieces),
                    None => Edge::Own,
                };
            }
        }
        edges
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        let [u, v] = self.surface.kinks();
        [u, breaks(&self.law, v)]
    }

    fn line(&self, u: T, vs: &[f64], order: Order) -> Vec<SurfJet<T>> {
        let laws: Vec<_> = vs.iter().map(|&v| self.law.jet(T::from(v), order)).collect();
        if !laws.iter().all(|law| law[0].is_constant()) {
            return vs.iter().map(|&v| self.jet(u, T::from(v), order)).collect();
        }
        let plain: Vec<f64> = laws.iter().map(|law| law[0].re()).collect();
        let line = self.surface.line(u, &plain, order).into_iter().zip(laws);
        line.map(|(jet, law)| Self::chained(jet, law)).collect()
    }

    moldloft_num::surface_facts!(open, not_rational);
}
