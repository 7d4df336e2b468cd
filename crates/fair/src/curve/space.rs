//! Spline spaces of one degree on one knot sequence, open or closed.

use crate::{FairError, SparseRows};
use moldloft_spline::{Basis, KnotVector};

/// Splines of one degree on one knot sequence, open or closed.
///
/// Control point s of an open space belongs to the basis function on knots `s ..= s + degree + 1`.
/// A closed space has as many knots as control points (a period); control point j belongs to the
/// function whose middle knot is knot j (left of the middle for even degrees).
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    degree: usize,
    knots: Vec<f64>,
    count: usize,
    period: Option<f64>,
}

impl Space {
    /// Uniform knots 0, 1, 2 ... without multiple ends: data used directly as control points.
    ///
    /// # Errors
    /// [`FairError::TooFew`] unless there are at least `degree + 2` points.
    pub fn floating(degree: usize, count: usize) -> Result<Self, FairError> {
        let knots = (0..count + degree + 1).map(|i| i as f64 - degree as f64).collect();
        Self::open(KnotVector::new(degree, knots)?)
    }

    /// Uniform knots on [0, 1] with multiple ends.
    ///
    /// # Errors
    /// As [`Space::floating`].
    pub fn clamped(degree: usize, count: usize) -> Result<Self, FairError> {
        Self::open(KnotVector::clamped_uniform(degree, count)?)
    }

    /// Any open knot vector.
    ///
    /// # Errors
    /// [`FairError::TooFew`] when the spline has no interior knot, so nothing can be faired.
    pub fn open(knots: KnotVector) -> Result<Self, FairError> {
        let (degree, count) = (knots.degree(), knots.points());
        if count < degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: count });
        }
        Ok(Self { degree, knots: knots.as_slice().to_vec(), count, period: None })
    }

    /// Uniform closed splines.
    ///
    /// # Errors
    /// [`FairError::TooFew`] unless there are at least `2 degree + 2` points, so that no stencil
    /// meets itself.
    pub fn closed(degree: usize, count: usize) -> Result<Self, FairError> {
        Self::periodic(degree, (0..count).map(|i| i as f64).collect(), count as f64)
    }

    /// Closed splines on increasing knots, one per control point, repeated with `period`.
    ///
    /// # Errors
    /// [`FairError::TooFew`] as for [`Space::closed`]; [`FairError::Unsorted`].
    pub fn periodic(degree: usize, knots: Vec<f64>, period: f64) -> Result<Self, FairError> {
        // The degree's range is checked where all knot vectors are.
        KnotVector::clamped_uniform(degree, degree + 1)?;
        let count = knots.len();
        if count < 2 * degree + 2 {
            return Err(FairError::TooFew { expected: 2 * degree + 2, actual: count });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(FairError::NotFinite { index });
        }
        if let Some(k) = knots.windows(2).position(|w| w[1] <= w[0]) {
            return Err(FairError::Unsorted { index: k + 1 });
        }
        if !(period.is_finite() && period > knots[count - 1] - knots[0]) {
            return Err(FairError::Unsorted { index: count });
        }
        Ok(Self { degree, knots, count, period: Some(period) })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The number of control points.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True for closed splines.
    pub fn is_closed(&self) -> bool {
        self.period.is_some()
    }

    /// True if the first and the last knot have the multiplicity `degree + 1`.
    pub fn is_clamped(&self) -> bool {
        let (p, n) = (self.degree, self.count);
        !self.is_closed() && self.knots[0] == self.knots[p] && self.knots[n] == self.knots[n + p]
    }

    /// The knots: all of an open space, one period of a closed one.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Knot `i`, continued periodically in a closed space.
    #[inline(always)]
    pub(crate) fn knot(&self, i: isize) -> f64 {
        match self.period {
            None => self.knots[i as usize],
            Some(period) => {
                let n = self.count as isize;
                self.knots[i.rem_euclid(n) as usize] + i.div_euclid(n) as f64 * period
            }
        }
    }

    /// The control point of the basis function whose support begins at knot `s`.
    #[inline(always)]
    pub(crate) fn column(&self, s: isize) -> usize {
        if self.is_closed() {
            (s + (self.degree as isize + 1) / 2).rem_euclid(self.count as isize) as usize
        } else {
            s as usize
        }
    }

    /// Interior knots at which splines are only continuous.
    pub(crate) fn corners(&self) -> Vec<f64> {
        let (start, end) = self.domain();
        let groups = self.knots.chunk_by(|a, b| a == b);
        let corners = groups.filter(|g| g.len() >= self.degree && start < g[0] && g[0] < end);
        corners.map(|g| g[0]).collect()
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        match self.period {
            None => (self.knots[self.degree], self.knots[self.count]),
            Some(period) => (self.knots[0], self.knots[0] + period),
        }
    }

    /// The knot indices k of the non-empty spans [k, k + 1] of the domain.
    pub fn spans(&self) -> impl Iterator<Item = isize> + '_ {
        let range = if self.is_closed() { 0..self.count } else { self.degree..self.count };
        range.map(|k| k as isize).filter(|&k| self.knot(k) < self.knot(k + 1))
    }

    /// The control points that act on span `k`, in order.
    pub fn columns(&self, k: isize) -> impl Iterator<Item = usize> + '_ {
        (k - self.degree as isize..=k).map(|s| self.column(s))
    }

    /// The span that holds `t` (outside the domain the first or last one), and `t` itself, moved
    /// into the first period of a closed space.
    pub fn locate(&self, t: f64) -> (isize, f64) {
        let t = match self.period {
            Some(period) => {
                let away = (t - self.knots[0]).rem_euclid(period);
                self.knots[0] + if away < period { away } else { 0.0 }
            }
            None => t,
        };
        let (low, high) =
            if self.is_closed() { (0, self.count) } else { (self.degree, self.count) };
        let inner = &self.knots[low + 1..high];
        let mut k = (low + inner.partition_point(|&u| u <= t)) as isize;
        while self.knot(k) == self.knot(k + 1) {
            k -= 1;
        }
        (k, t)
    }

    /// The space as an open knot vector over [0, 1], and the control point of each of its
    /// coefficients: a closed spline repeats its first `degree` points.
    pub fn knot_vector(&self) -> (KnotVector, Vec<usize>) {
        let (p, n) = (self.degree as isize, self.count as isize);
        let (from, to) = if self.is_closed() { (-p, n + p) } else { (0, n + p) };
        let knots = (from..=to).map(|i| self.knot(i)).collect();
        let knots = KnotVector::new(self.degree, knots).expect("the knots of a space are sorted");
        let places = (from..n).map(|s| self.column(s)).collect();
        (knots.normalized(), places)
    }

    /// Knots and control points of an open curve for those of the space, which may carry
    /// derivatives: a closed spline repeats its first `degree` points.
    pub(crate) fn open_form<T: moldloft_num::Real>(
        &self,
        knots: &[T],
        points: &[moldloft_num::Vec3<T>],
    ) -> (Vec<T>, Vec<moldloft_num::Vec3<T>>) {
        if !self.is_closed() {
            return (knots.to_vec(), points.to_vec());
        }
        let (p, n) = (self.degree as isize, self.count as isize);
        let (a, b) = self.domain();
        let knot =
            |i: isize| knots[i.rem_euclid(n) as usize] + T::from(i.div_euclid(n) as f64 * (b - a));
        ((-p..=n + p).map(knot).collect(), (-p..n).map(|s| points[self.column(s)]).collect())
    }

    /// The simple interior knots: where the derivative of order `degree` may jump and a local
    /// step is defined. Multiple knots are intended breaks.
    pub(crate) fn simple_knots(&self) -> impl Iterator<Item = isize> + '_ {
        let range = if self.is_closed() { 0..self.count } else { self.degree + 1..self.count };
        range
            .map(|k| k as isize)
            .filter(|&m| self.knot(m - 1) < self.knot(m) && self.knot(m) < self.knot(m + 1))
    }

    /// The mean length of a span.
    pub fn mean_span(&self) -> f64 {
        let (start, end) = self.domain();
        let spans = if self.is_closed() { self.count } else { self.count - self.degree };
        (end - start) / spans as f64
    }

    /// Values, first and second derivatives of the basis functions of span `k` at `t`.
    pub(crate) fn basis(&self, k: isize, t: f64) -> Basis<f64> {
        self.local_knots(k).basis_in(self.degree, t, moldloft_num::Order::Second)
    }

    /// The knots that the basis functions of span `k` have; it is their span `degree`.
    pub(crate) fn local_knots(&self, k: isize) -> KnotVector {
        let p = self.degree as isize;
        let local: Vec<f64> = (k - p..=k + p + 1).map(|i| self.knot(i)).collect();
        KnotVector::new(self.degree, local).expect("a span lies between sorted knots")
    }

    /// The polar form of the spline with local coefficients `c` on span `k` at `arguments`
    /// (Ramshaw 1989); `c` is used up.
    pub(crate) fn polar(&self, k: isize, arguments: &[f64], c: &mut [f64]) -> f64 {
        let p = self.degree as isize;
        for (r, &t) in arguments.iter().enumerate() {
            let r = r as isize;
            for j in 0..p - r {
                let (low, high) = (self.knot(k - p + 1 + j + r), self.knot(k + 1 + j));
                let share = (t - low) / (high - low);
                c[j as usize] = c[j as usize] * (1.0 - share) + c[j as usize + 1] * share;
            }
        }
        c[0]
    }

    /// The derivative of order `r` of each basis function of span `k` at `t`.
    pub(crate) fn derivative(&self, k: isize, t: f64, r: usize) -> Vec<f64> {
        let p = self.degree;
        (0..=p)
            .map(|unit| {
                let mut c = vec![0.0; p + 1];
                c[unit] = 1.0;
                // Differences of coefficients (de Boor 1978, X(12)), then de Boor's triangle.
                for q in 0..r.min(p) {
                    let left = p - q;
                    for j in 0..left {
                        let i = k - left as isize + 1 + j as isize;
                        let width = self.knot(i + left as isize) - self.knot(i);
                        c[j] = left as f64 * (c[j + 1] - c[j]) / width;
                    }
                }
                if r > p {
                    return 0.0;
                }
                let left = p - r;
                for level in 0..left {
                    for j in 0..left - level {
                        let low = self.knot(k - left as isize + 1 + (j + level) as isize);
                        let high = self.knot(k + 1 + j as isize);
                        let share = (t - low) / (high - low);
                        c[j] = c[j] * (1.0 - share) + c[j + 1] * share;
                    }
                }
                c[0]
            })
            .collect()
    }

    /// Bézier points of all spans as rows over the control points, without duplicates at common
    /// ends. For a rational curve the rows give the displacement of the rational curve's projected
    /// Bézier points for a displacement of its control points.
    pub fn bezier(&self, weights: Option<&[f64]>) -> SparseRows {
        let mut rows = SparseRows::new();
        self.each_bezier(weights, |entries| rows.push(entries.iter().copied()));
        rows
    }

    /// Calls `f` with each row of [`Space::bezier`], in order along the curve.
    pub(crate) fn each_bezier(&self, weights: Option<&[f64]>, mut f: impl FnMut(&[(usize, f64)])) {
        let p = self.degree;
        let mut bezier = BezierExtraction::default();
        let mut entries = vec![(0, 0.0); p + 1];
        let mut last: Option<isize> = None;
        for k in self.spans() {
            let points = bezier.rows(self, k);
            // A knot of multiplicity above the degree separates: its first point is its own.
            let shared = match last {
                Some(before) => (k - before) as usize <= p,
                None => self.is_closed(),
            };
            for point in points.iter().skip(usize::from(shared)) {
                for ((e, c), &x) in entries.iter_mut().zip(self.columns(k)).zip(point) {
                    *e = (c, x);
                }
                if let Some(w) = weights {
                    let total: f64 = entries.iter().map(|&(c, x)| w[c] * x).sum();
                    for (c, x) in &mut entries {
                        *x *= w[*c] / total;
                    }
                }
                f(&entries);
            }
            last = Some(k);
        }
    }

    /// The Bézier points of span `k` over [`Space::columns`].
    pub(crate) fn bezier_of(&self, k: isize) -> Vec<Vec<f64>> {
        BezierExtraction::default().rows(self, k).to_vec()
    }

    /// Maximum move of each control point when every Bézier point of the displacement stays within
    /// 1 (the norm of the inverse of [`Space::bezier`] on one span).
    pub fn reach(&self, weights: Option<&[f64]>) -> Vec<f64> {
        let p = self.degree;
        let mut reach = vec![f64::INFINITY; self.count];
        for k in self.spans() {
            let (a, b) = (self.knot(k), self.knot(k + 1));
            let bezier_weight: Vec<f64> = match weights {
                None => vec![1.0; p + 1],
                Some(w) => (0..=p)
                    .map(|q| {
                        let mut arguments = vec![a; p - q];
                        arguments.extend(std::iter::repeat_n(b, q));
                        let mut c: Vec<f64> = self.columns(k).map(|c| w[c]).collect();
                        self.polar(k, &arguments, &mut c)
                    })
                    .collect(),
            };
            for (j, column) in self.columns(k).enumerate() {
                let first = k - p as isize + j as isize;
                // The control point is the polar form of the span's polynomial at its p knots;
                // its coefficients over the Bézier points are products of the pairs (1-t, t).
                let mut mass = vec![1.0];
                for i in 1..=p as isize {
                    let t = (self.knot(first + i) - a) / (b - a);
                    let mut next = vec![0.0; mass.len() + 1];
                    for (q, m) in mass.iter().enumerate() {
                        next[q] += m * (1.0 - t).abs();
                        next[q + 1] += m * t.abs();
                    }
                    mass = next;
                }
                // Bounding the mean over orders by the sum over choices is on the safe side.
                let bound: f64 = mass.iter().zip(&bezier_weight).map(|(m, w)| m * w).sum();
                let own = weights.map_or(1.0, |w| w[column]);
                reach[column] = reach[column].min(bound / own);
            }
        }
        reach
    }
}

/// The Bézier points of a span over its control points. Spans with the same knots about them, as most
/// have, share them.
#[derive(Default)]
pub(crate) struct BezierExtraction {
    local: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl BezierExtraction {
    /// A row per Bézier point of span `k`, over [`Space::columns`].
    pub(crate) fn rows(&mut self, space: &Space, k: isize) -> &[Vec<f64>] {
        let p = space.degree;
        let (a, b) = (space.knot(k), space.knot(k + 1));
        let knots = (0..2 * p as isize + 2).map(|i| space.knot(k - p as isize + i) - a);
        if self.rows.is_empty() || !knots.clone().eq(self.local.iter().copied()) {
            self.local.clear();
            self.local.extend(knots);
            let unit = |arguments: &[f64], at: usize| {
                let mut c = vec![0.0; p + 1];
                c[at] = 1.0;
                space.polar(k, arguments, &mut c)
            };
            let row = |q: usize| {
                let mut arguments = vec![a; p - q];
                arguments.extend(std::iter::repeat_n(b, q));
                (0..=p).map(|at| unit(&arguments, at)).collect()
            };
            self.rows = (0..=p).map(row).collect();
        }
        &self.rows
    }
}

impl Space {
    /// True when all knot spans are equally long (up to rounding), multiple ends included as such.
    pub fn is_uniform(&self) -> bool {
        let p = self.degree as isize;
        let n = self.count as isize;
        let (first, last) = if self.is_closed() { (0, n) } else { (0, n + p) };
        let mean = self.mean_span();
        (first..last).all(|k| (self.knot(k + 1) - self.knot(k) - mean).abs() < 1e-9 * mean)
    }
}
