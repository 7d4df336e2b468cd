//! Evaluation of a spline at the same relative parameters on every span; common factors are
//! computed once.

use crate::Space;
use crate::curve::space::BezierExtraction;
use crate::interrogate::shape::Sample;
use moldloft_num::{Order, Vec3};

/// Bernstein polynomials at a relative parameter of the span.
fn bernstein(degree: usize, s: f64) -> Vec<f64> {
    let mut row = vec![1.0];
    for _ in 0..degree {
        let mut next = vec![0.0; row.len() + 1];
        for (q, b) in row.iter().enumerate() {
            next[q] += b * (1.0 - s);
            next[q + 1] += b * s;
        }
        row = next;
    }
    row
}

/// Calls `f` with the samples of each span at the relative parameters `shares` (0 .. 1), in order
/// along the curve.
///
/// Positions, first and second derivatives are bit-identical to
/// [`crate::interrogate::shape::sample_in`]; third derivatives are those of the span's Bezier
/// points, or zero if not requested.
pub(crate) fn each_span(
    space: &Space,
    points: &[Vec3<f64>],
    weights: Option<&[f64]>,
    (shares, third): (impl Iterator<Item = f64>, bool),
    mut f: impl FnMut(&mut dyn Iterator<Item = Sample>),
) {
    let p = space.degree();
    // Third derivatives are zero below degree three.
    let rest = p.checked_sub(3).filter(|_| third);
    let places: Vec<(f64, Vec<f64>)> =
        shares.map(|s| (s, rest.map_or(Vec::new(), |d| bernstein(d, s)))).collect();
    let mut bezier = BezierExtraction::default();
    let mut own: Vec<(Vec3<f64>, f64)> = Vec::with_capacity(p + 1);
    let mut thirds = own.clone();
    for k in space.spans() {
        let (a, b) = (space.knot(k), space.knot(k + 1));
        own.clear();
        own.extend(space.columns(k).map(|c| {
            let weight = weights.map_or(1.0, |w| w[c]);
            (points[c], weight)
        }));
        thirds.clear();
        if rest.is_some() {
            thirds.extend(bezier.rows(space, k).iter().map(|row| {
                let add = |(point, weight): (Vec3<f64>, f64), (o, x): (&(Vec3<f64>, f64), &f64)| {
                    (point + o.0 * (o.1 * x), weight + o.1 * x)
                };
                own.iter().zip(row).fold((Vec3::zero(), 0.0), add)
            }));
            for order in 0..3 {
                let factor = (p - order) as f64 / (b - a);
                for q in 0..p - order {
                    let (low, high) = (thirds[q], thirds[q + 1]);
                    thirds[q] = ((high.0 - low.0) * factor, (high.1 - low.1) * factor);
                }
            }
            thirds.truncate(p - 2);
        }
        let knots = space.local_knots(k);
        let sample = |(share, row): &(f64, Vec<f64>)| {
            // The end is bit-identical to the next span's start, which distinguishes spans.
            let t = if *share == 1.0 { b } else { a + (b - a) * share };
            let mut sums = [Vec3::zero(); 4];
            let mut w = [0.0; 4];
            let basis = knots.basis_in(p, t, Order::Second);
            for (order, row) in basis.rows.iter().enumerate() {
                for ((point, weight), &x) in own.iter().zip(row) {
                    sums[order] += *point * (weight * x);
                    w[order] += weight * x;
                }
            }
            for ((point, weight), &x) in thirds.iter().zip(row) {
                sums[3] += *point * x;
                w[3] += weight * x;
            }
            Sample::of_sums(t, sums, weights.is_some().then_some(w))
        };
        f(&mut places.iter().map(sample));
    }
}

/// The basis functions at the same relative parameters of every span, to sample many splines of one
/// space without third derivatives. Their samples are bit-identical to those of [`each_span`].
pub(crate) struct SpanBasis {
    degree: usize,
    shares: Vec<f64>,
    /// Parameters followed by the values of all orders, sample by sample; `None` for more than
    /// `MOST_KEPT` numbers.
    values: Option<Vec<f64>>,
}

/// The most numbers of a basis that are kept.
const MOST_KEPT: usize = 1 << 22;

/// Position, first and second derivative.
const ORDERS: usize = 3;

impl SpanBasis {
    pub fn new(space: &Space, shares: impl Iterator<Item = f64>) -> Self {
        let (degree, shares) = (space.degree(), shares.collect::<Vec<f64>>());
        let stride = 1 + ORDERS * (degree + 1);
        let count = space.spans().count() * shares.len() * stride;
        let values = (count <= MOST_KEPT).then(|| {
            let mut values = Vec::with_capacity(count);
            for k in space.spans() {
                let (a, b, knots) = (space.knot(k), space.knot(k + 1), space.local_knots(k));
                for &share in &shares {
                    let t = if share == 1.0 { b } else { a + (b - a) * share };
                    values.push(t);
                    for row in &knots.basis_in(degree, t, Order::Second).rows {
                        values.extend(row.iter().copied());
                    }
                }
            }
            values
        });
        Self { degree, shares, values }
    }

    /// The samples of a spline of the space.
    pub fn samples(&self, space: &Space, points: &[Vec3<f64>]) -> Vec<Sample> {
        let Some(values) = &self.values else {
            let mut out = Vec::new();
            let shares = (self.shares.iter().copied(), false);
            each_span(space, points, None, shares, |samples| out.extend(samples));
            return out;
        };
        let order = self.degree + 1;
        let mut samples = values.chunks_exact(1 + ORDERS * order);
        let mut out = Vec::with_capacity(samples.len());
        let mut own: Vec<Vec3<f64>> = Vec::with_capacity(order);
        for k in space.spans() {
            own.clear();
            own.extend(space.columns(k).map(|c| points[c]));
            for values in samples.by_ref().take(self.shares.len()) {
                let mut sums = [Vec3::zero(); 4];
                for (sum, row) in sums.iter_mut().zip(values[1..].chunks_exact(order)) {
                    for (point, &x) in own.iter().zip(row) {
                        *sum += *point * x;
                    }
                }
                out.push(Sample::of_sums(values[0], sums, None));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interrogate::shape::sample_in;
    use moldloft_spline::KnotVector;

    #[test]
    fn samples_are_those_of_de_boor_s_triangle() {
        let mut random = moldloft_testing::Lcg::new(5);
        for degree in 1..=6 {
            let count = 2 * degree + 6;
            let mut inner: Vec<f64> =
                (0..count - degree - 1).map(|_| 0.5 + random.centred()).collect();
            inner.sort_by(f64::total_cmp);
            let knots = [vec![0.0; degree + 1], inner, vec![1.0; degree + 1]].concat();
            let open = Space::open(KnotVector::new(degree, knots).unwrap()).unwrap();
            for space in [open, Space::closed(degree, count).unwrap()] {
                let points: Vec<Vec3<f64>> = (0..count)
                    .map(|_| Vec3::of(random.centred(), random.centred(), random.centred()))
                    .collect();
                let weights: Vec<f64> = (0..count).map(|_| 1.0 + random.centred()).collect();
                for weights in [None, Some(&weights[..])] {
                    let mut spans = space.spans();
                    let shares = [0.0, 0.3, 1.0];
                    each_span(&space, &points, weights, (shares.into_iter(), true), |samples| {
                        let k = spans.next().unwrap();
                        for s in samples {
                            let other = sample_in(&space, &points, weights, k, s.t);
                            assert_eq!(s.point, other.point);
                            let [d, e] = [s, other].map(|s| s.derivatives);
                            assert_eq!(d[..2], e[..2]);
                            let narrow = 1.0 / (space.knot(k + 1) - space.knot(k));
                            assert!((d[2] - e[2]).norm() < 1e-12 * (e[2].norm() + narrow.powi(3)));
                        }
                    });
                    assert_eq!(spans.next(), None);
                }
                let basis = SpanBasis::new(&space, [0.0, 0.3, 1.0].into_iter());
                let mut all = Vec::new();
                let shares = ([0.0, 0.3, 1.0].into_iter(), false);
                each_span(&space, &points, None, shares, |samples| all.extend(samples));
                assert_eq!(basis.samples(&space, &points), all);
            }
        }
    }
}
