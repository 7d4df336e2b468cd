//! Surfaces whose lines u = const are curves of one family: S(u, v) = L[u](v).

use moldloft_num::trace::Edges;
use moldloft_num::{Curve, CurveJet, Jet, Order, Real, SurfJet, Surface, Uni1, Uni2, Vec3};
use smallvec::SmallVec;

/// A surface by its curves across.
pub trait Column: Send + Sync {
    /// The scalar.
    type Scalar: Real;
    /// The curves, over any scalar.
    type Across<S: Real>: Curve<S>;
    /// The curve at `u`, or `None`.
    fn across<J: Jet<Self::Scalar>>(&self, u: J) -> Option<Self::Across<J>>;
    /// See [`Surface::breaks`].
    fn breaks(&self) -> [Vec<f64>; 2];
    /// See [`Surface::edges`].
    fn edges(&self) -> Edges<Self::Scalar>;
    /// See [`Surface::edge_made_of`].
    fn edge_made_of(&self, _k: usize) -> Vec<moldloft_num::trace::Key> {
        Vec::new()
    }
}

/// The surface of such curves.
pub struct Columns<C>(pub C);

type Across<C, S> = <C as Column>::Across<S>;

fn jet_of<S: Real>(curve: Option<&impl Curve<S>>, v: S, order: Order) -> CurveJet<S> {
    match curve {
        Some(curve) => curve.jet(v, order),
        None => [Vec3::of(f64::NAN, f64::NAN, f64::NAN); 3],
    }
}

/// First derivatives, from a curve over numbers with a derivative by u.
fn first<T: Real>([p, d, _]: CurveJet<Uni1<T>>) -> SurfJet<T> {
    SurfJet { p: p.map(|a| a.f), u: p.map(|a| a.t), v: d.map(|a| a.f), ..SurfJet::default() }
}

/// First and second derivatives, likewise.
fn second<T: Real>([p, d, dd]: CurveJet<Uni2<T>>) -> SurfJet<T> {
    SurfJet {
        p: p.map(|a| a.f),
        u: p.map(|a| a.t),
        v: d.map(|a| a.f),
        uu: p.map(|a| a.tt),
        uv: d.map(|a| a.t),
        vv: dd.map(|a| a.f),
    }
}

impl<C: Column> Surface<C::Scalar> for Columns<C> {
    fn jet(&self, u: C::Scalar, v: C::Scalar, order: Order) -> SurfJet<C::Scalar> {
        match order {
            Order::Zero => {
                SurfJet { p: jet_of(self.0.across(u).as_ref(), v, order)[0], ..SurfJet::default() }
            }
            Order::First => {
                let curve: Option<Across<C, Uni1<C::Scalar>>> = self.0.across(Uni1::parameter(u));
                first(jet_of(curve.as_ref(), Uni1::fixed(v), order))
            }
            Order::Second => {
                let curve: Option<Across<C, Uni2<C::Scalar>>> = self.0.across(Uni2::parameter(u));
                second(jet_of(curve.as_ref(), Uni2::fixed(v), order))
            }
        }
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<C::Scalar>],
        mut normals: Option<&mut [Vec3<C::Scalar>]>,
    ) {
        for (i, &u) in us.iter().enumerate() {
            let u = C::Scalar::from(u);
            let row = i * vs.len()..(i + 1) * vs.len();
            let out = points[row.clone()].iter_mut().zip(vs);
            let Some(normals) = normals.as_deref_mut() else {
                let curve: Option<Across<C, C::Scalar>> = self.0.across(u);
                for (x, &v) in out {
                    *x = jet_of(curve.as_ref(), C::Scalar::from(v), Order::Zero)[0];
                }
                continue;
            };
            let curve: Option<Across<C, Uni1<C::Scalar>>> = self.0.across(Uni1::parameter(u));
            for ((x, &v), normal) in out.zip(&mut normals[row]) {
                let [p, d, _] = jet_of(curve.as_ref(), Uni1::from(v), Order::First);
                *x = p.map(|a| a.f);
                let along = p.map(|a| a.t);
                *normal = along.cross(d.map(|a| a.f)).normalized().unwrap_or_default();
            }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.0.breaks()
    }

    fn edges(&self) -> Edges<C::Scalar> {
        self.0.edges()
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        self.0.edge_made_of(k)
    }

    /// The curve at `u` is made once.
    fn line(&self, u: C::Scalar, vs: &[f64], order: Order) -> Vec<SurfJet<C::Scalar>> {
        let vs = vs.iter().map(|&v| C::Scalar::from(v));
        match order {
            Order::Zero => {
                let curve: Option<Across<C, C::Scalar>> = self.0.across(u);
                let at =
                    |v| SurfJet { p: jet_of(curve.as_ref(), v, order)[0], ..SurfJet::default() };
                vs.map(at).collect()
            }
            Order::First => {
                let curve: Option<Across<C, Uni1<C::Scalar>>> = self.0.across(Uni1::parameter(u));
                vs.map(|v| first(jet_of(curve.as_ref(), Uni1::fixed(v), order))).collect()
            }
            Order::Second => {
                let curve: Option<Across<C, Uni2<C::Scalar>>> = self.0.across(Uni2::parameter(u));
                vs.map(|v| second(jet_of(curve.as_ref(), Uni2::fixed(v), order))).collect()
            }
        }
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
    moldloft_num::surface_one_by_one!(C::Scalar: scattered);
}

/// A Bézier curve; of degree 5 at most without allocation.
pub struct ColumnBezier<S>(pub SmallVec<[Vec3<S>; 6]>);

impl<S: Real> Curve<S> for ColumnBezier<S> {
    /// De Casteljau's algorithm; exactly the first and the last point at the ends.
    fn jet(&self, t: S, order: Order) -> CurveJet<S> {
        let n = self.0.len() - 1;
        let mut row = self.0.clone();
        let rest = -t + 1.0;
        let mut jet = [Vec3::zero(); 3];
        while row.len() > 1 {
            if row.len() == 3 && order == Order::Second {
                let factor = S::from((n * (n - 1)) as f64);
                jet[2] = (row[0] - row[1] * S::from(2.0) + row[2]) * factor;
            }
            if row.len() == 2 && order >= Order::First {
                jet[1] = (row[1] - row[0]) * S::from(n as f64);
            }
            for k in 0..row.len() - 1 {
                row[k] = row[k] * rest + row[k + 1] * t;
            }
            row.pop();
        }
        jet[0] = row[0];
        jet
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
    moldloft_num::curve_one_by_one!(S);
}
