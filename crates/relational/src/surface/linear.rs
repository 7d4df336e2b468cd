//! Lofts that are linear in their masters: S(u, v) = sum B_i(v) C_i(u).

use super::chunk::{Chunk, ChunkQuantity, LANES, Plane};
use super::masters::{Masters, Points};
use moldloft_num::trace::Edges;
use moldloft_num::{Order, Rational, Real, SurfJet, Surface, Uni1, Vec3};
use moldloft_spline::{Basis, KnotVector};
use smallvec::SmallVec;

/// Masters blended by the basis functions of a clamped knot vector.
pub struct LinearLoft<T: Real> {
    pub masters: Masters<T>,
    /// One control point per master, on [0, 1].
    pub knots: KnotVector,
}

impl<T: Real> LinearLoft<T> {
    /// The jet from basis functions; `times` multiplies a coordinate with a basis function, which
    /// is a plain number wherever v is.
    fn combine<S: Real>(
        &self,
        u: T,
        basis: &Basis<S>,
        order: Order,
        times: impl Fn(T, S) -> T,
    ) -> SurfJet<T> {
        let mut jet = SurfJet::default();
        let [values, slopes, bends] = &basis.rows;
        for (r, curve) in self.masters.curves()[basis.first..].iter().enumerate().take(values.len())
        {
            let [p, d, dd] = curve.jet(u, order);
            let share = |v: Vec3<T>, b: S| v.map(|x| times(x, b));
            jet.p += share(p, values[r]);
            if order >= Order::First {
                jet.u += share(d, values[r]);
                jet.v += share(p, slopes[r]);
            }
            if order == Order::Second {
                jet.uu += share(dd, values[r]);
                jet.uv += share(d, slopes[r]);
                jet.vv += share(p, bends[r]);
            }
        }
        jet
    }
}

/// The basis at all parameters v of a grid.
struct BasisTable {
    rows: Vec<Basis<f64>>,
}

impl BasisTable {
    /// The stretches, at most [`LANES`] long, within which the same masters are blended.
    fn stretches(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let mut begin = 0;
        std::iter::from_fn(move || {
            let first = self.rows.get(begin)?.first;
            let most = (begin + LANES).min(self.rows.len());
            let end = (begin..most).find(|&j| self.rows[j].first != first).unwrap_or(most);
            let stretch = begin..end;
            begin = end;
            Some(stretch)
        })
    }
}

/// The basis values of one stretch, one plane for each master in play.
fn planes(rows: &[Basis<f64>], order: usize) -> Vec<Plane> {
    let mut planes = vec![[0.0; LANES]; rows[0].rows[order].len()];
    for (j, row) in rows.iter().enumerate() {
        for (plane, &b) in planes.iter_mut().zip(&row.rows[order]) {
            plane[j] = b;
        }
    }
    planes
}

/// The sum of the basis planes times the numbers `q(0)`, `q(1)`, ...
#[inline(always)]
fn blend(planes: &[Plane], q: impl Fn(usize) -> f64, n: usize, out: &mut Plane) {
    out.fill(0.0);
    for (r, plane) in planes.iter().enumerate() {
        let q = q(r);
        for (o, &b) in out.iter_mut().zip(plane).take(n) {
            *o += q * b;
        }
    }
}

/// Points as sums of masters' points, each coordinate one node of a tape.
fn fill_on_tape<T: Real>(
    planes: &[Plane],
    master: impl Fn(usize) -> Vec3<T>,
    points: &mut [Vec3<T>],
) {
    for (j, p) in points.iter_mut().enumerate() {
        let coordinate = |axis: usize| {
            let terms: SmallVec<[(f64, T); 8]> =
                planes.iter().enumerate().map(|(r, plane)| (plane[j], master(r)[axis])).collect();
            T::linear(terms.iter().fold(0.0, |sum, (b, x)| sum + x.re() * b), &terms)
        };
        *p = Vec3::from([0, 1, 2].map(coordinate));
    }
}

impl<T: Real> Surface<T> for LinearLoft<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        if v.is_constant() {
            let basis = self.knots.basis(v.re(), order);
            self.combine(u, &basis, order, |x, b: f64| x * b)
        } else {
            self.combine(u, &self.knots.basis(v, order), order, |x, b: T| x * b)
        }
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        mut normals: Option<&mut [Vec3<T>]>,
    ) {
        let order = if normals.is_some() { Order::First } else { Order::Zero };
        let table = BasisTable { rows: vs.iter().map(|&v| self.knots.basis(v, order)).collect() };
        let columns: Vec<Points<Uni1<T>>> = match order {
            Order::Zero => Vec::new(),
            _ => us.iter().map(|&u| self.masters.with_slopes(u)).collect(),
        };
        let plain: Vec<Points<T>> = match order {
            Order::Zero => us.iter().map(|&u| self.masters.at(T::from(u))).collect(),
            _ => Vec::new(),
        };
        let mut chunk = Chunk::new();
        for stretch in table.stretches() {
            let rows = &table.rows[stretch.clone()];
            let (first, n) = (rows[0].first, rows.len());
            let values = planes(rows, 0);
            let slopes = planes(rows, usize::from(order >= Order::First));
            for i in 0..us.len() {
                let out = i * vs.len() + stretch.start..i * vs.len() + stretch.end;
                let each = (0..3).flat_map(|axis| (0..T::PARTS).map(move |k| (axis, k)));
                if T::TAPED && normals.is_none() {
                    let master = |r: usize| plain[i][first + r];
                    fill_on_tape(&values, master, &mut points[out]);
                    continue;
                }
                let Some(normals) = normals.as_deref_mut() else {
                    for (axis, k) in each {
                        let q = |r: usize| plain[i][first + r][axis].part(k);
                        blend(&values, q, n, chunk.plane(ChunkQuantity::Point, axis, k));
                    }
                    chunk.write_points(&mut points[out]);
                    continue;
                };
                for (axis, k) in each {
                    let q = |r: usize| columns[i][first + r][axis].f.part(k);
                    let by_u = |r: usize| columns[i][first + r][axis].t.part(k);
                    blend(&values, q, n, chunk.plane(ChunkQuantity::Point, axis, k));
                    blend(&values, by_u, n, chunk.plane(ChunkQuantity::ByU, axis, k));
                    blend(&slopes, q, n, chunk.plane(ChunkQuantity::ByV, axis, k));
                }
                chunk.write_points(&mut points[out.clone()]);
                chunk.write_normals(&mut normals[out]);
            }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.masters.breaks(), self.knots.breaks()]
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        [self.masters.joints(), self.knots.joints()]
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        [self.masters.kinks(), self.knots.breaks()]
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        self.masters.edge_made_of(k)
    }

    fn rational(&self) -> Rational<2> {
        self.masters.rational()
    }

    fn edges(&self) -> Edges<T> {
        if self.knots.degree() == 1 { self.masters.straight_edges() } else { self.masters.edges() }
    }

    moldloft_num::surface_facts!(breaks_along_lines, open);
    moldloft_num::surface_one_by_one!(T: line, scattered);
}
