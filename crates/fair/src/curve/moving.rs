//! Measures and values of splines whose knots carry derivatives: how they change with the data that
//! give the knots.

use crate::measure::{gauss, unit_of};
use crate::{FairError, Measure, Space};
use moldloft_num::{Real, Vec3};

/// Sparse rows whose factors carry derivatives.
pub(crate) struct MovingRows<T> {
    pub rows: Vec<Vec<(usize, T)>>,
}

impl<T: Real> MovingRows<T> {
    pub fn apply(&self, k: usize, points: &[Vec3<T>]) -> Vec3<T> {
        self.rows[k].iter().fold(Vec3::zero(), |s, &(c, f)| s + points[c].map(|x| x * f))
    }

    /// The sum of squares.
    pub fn sum_sq(&self, points: &[Vec3<T>]) -> T {
        (0..self.rows.len()).fold(T::zero(), |s, k| s + self.apply(k, points).norm_sq())
    }

    /// Half the slope of the sum of squares.
    pub fn slope(&self, points: &[Vec3<f64>]) -> Vec<Vec3<T>> {
        let mut out = vec![Vec3::zero(); points.len()];
        for row in &self.rows {
            let e = row
                .iter()
                .fold(Vec3::zero(), |s: Vec3<T>, &(c, f)| s + points[c].map_real(|x| f * x));
            for &(c, f) in row {
                out[c] += e.map(|x| x * f);
            }
        }
        out
    }

    /// Changes of half the slope that come from the rows.
    pub fn forces(&self, points: &[Vec3<f64>]) -> Vec<Vec3<T>> {
        self.slope(points).into_iter().map(|f| f - Vec3::lifted(f.re())).collect()
    }
}

/// Data at sites that move with knots and parameters.
pub(crate) struct MovingSites<T> {
    /// Values of control points at the sites.
    pub values: MovingRows<T>,
    pub wanted: Vec<Vec3<T>>,
}

impl<T: Real> MovingSites<T> {
    /// The control points `real`, changed so that the values of `of` follow the data; `solve`
    /// returns the control points that take given values.
    pub fn through(
        &self,
        of: &[Vec3<f64>],
        real: &[Vec3<f64>],
        solve: impl Fn(&[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError>,
    ) -> Result<Vec<Vec3<T>>, FairError> {
        let lifted: Vec<Vec3<T>> = of.iter().map(|&p| Vec3::lifted(p)).collect();
        let change = |(k, &wanted): (usize, &Vec3<T>)| {
            let off = wanted - self.values.apply(k, &lifted);
            off - Vec3::lifted(off.re())
        };
        let change: Vec<Vec3<T>> = self.wanted.iter().enumerate().map(change).collect();
        let change = solve(&change)?;
        Ok(real.iter().zip(change).map(|(&p, c)| Vec3::lifted(p) + c).collect())
    }

    /// Adds to `forces` the change of a force at site `k` that acts through a row that moves.
    pub fn act(&self, k: usize, force: Vec3<f64>, forces: &mut [Vec3<T>]) {
        for &(c, f) in &self.values.rows[k] {
            let change = f - T::from(f.re());
            forces[c] += force.map_real(|x| change * x);
        }
    }
}

/// Real vectors times numbers that carry derivatives.
pub(crate) trait MapReal {
    fn map_real<T: Real>(self, f: impl Fn(f64) -> T) -> Vec3<T>;
}

impl MapReal for Vec3<f64> {
    fn map_real<T: Real>(self, f: impl Fn(f64) -> T) -> Vec3<T> {
        Vec3::new(f(self.x), f(self.y), f(self.z))
    }
}

/// A space with knots that carry derivatives.
pub(crate) struct MovingSpace<'a, T> {
    pub space: &'a Space,
    pub knots: &'a [T],
}

impl<T: Real> MovingSpace<'_, T> {
    fn knot(&self, i: isize) -> T {
        if !self.space.is_closed() {
            return self.knots[i as usize];
        }
        let n = self.knots.len() as isize;
        let (a, b) = self.space.domain();
        self.knots[i.rem_euclid(n) as usize] + T::from(i.div_euclid(n) as f64 * (b - a))
    }

    /// The derivative of order `r` of each basis function of span `k` at `t`; see
    /// [`Space::derivative`].
    pub fn derivative(&self, k: isize, t: T, r: usize) -> Vec<T> {
        let p = self.space.degree();
        (0..=p)
            .map(|unit| {
                let mut c = vec![T::zero(); p + 1];
                c[unit] = T::one();
                for q in 0..r {
                    let left = p - q;
                    for j in 0..left {
                        let i = k - left as isize + 1 + j as isize;
                        let width = self.knot(i + left as isize) - self.knot(i);
                        c[j] = (c[j + 1] - c[j]) * left as f64 / width;
                    }
                }
                let left = p - r;
                for level in 0..left {
                    for j in 0..left - level {
                        let low = self.knot(k - left as isize + 1 + (j + level) as isize);
                        let high = self.knot(k + 1 + j as isize);
                        let share = (t - low) / (high - low);
                        c[j] = c[j] * (T::one() - share) + c[j + 1] * share;
                    }
                }
                c[0]
            })
            .collect()
    }

    /// Values at a parameter.
    pub fn value(&self, t: T) -> Vec<(usize, T)> {
        let (k, at) = self.space.locate(t.re());
        let t = t + T::from(at - t.re());
        self.space.columns(k).zip(self.derivative(k, t, 0)).collect()
    }

    /// The rows of a measure of squares, as [`Measure::rows`] has them.
    pub fn measure(&self, measure: Measure) -> Result<MovingRows<T>, FairError> {
        let p = self.space.degree() as isize;
        let (start, end) = self.space.domain();
        let spans = if self.space.is_closed() {
            self.space.count()
        } else {
            self.space.count() - self.space.degree()
        };
        // The domain is the whole of the curve: it does not change.
        let mean = (end - start) / spans as f64;
        let mut rows = Vec::new();
        let need = |expected: usize| {
            let actual = self.space.degree();
            if actual < expected { Err(FairError::Degree { expected, actual }) } else { Ok(()) }
        };
        match measure {
            Measure::Second | Measure::Third if self.space.degree() > 1 => {
                let order: usize =
                    if measure == Measure::Second { 2 } else { need(3).map(|()| 3)? };
                let first = if self.space.is_closed() { 0 } else { order as isize };
                'rows: for s in first..self.space.count() as isize {
                    let mut c = vec![T::zero(); order + 1];
                    c[order] = T::one();
                    for q in (1..=order as isize).rev() {
                        let mut next = vec![T::zero(); order + 1];
                        for i in 0..=order {
                            if c[i].re() == 0.0 {
                                continue;
                            }
                            let at = s - order as isize + i as isize;
                            let width = self.knot(at + p - q + 1) - self.knot(at);
                            if width.re() <= 0.0 {
                                continue 'rows;
                            }
                            let factor = T::from((p - q + 1) as f64 * mean) / width;
                            next[i] += c[i] * factor;
                            next[i - 1] -= c[i] * factor;
                        }
                        c = next;
                    }
                    let left = p - order as isize;
                    let integral = (self.knot(s + left + 1) - self.knot(s)) / (left + 1) as f64;
                    let scale = (integral / mean).sqrt();
                    let column = |i: usize| self.space.column(s - order as isize + i as isize);
                    rows.push(c.iter().enumerate().map(|(i, &x)| (column(i), x * scale)).collect());
                }
            }
            Measure::Bending | Measure::Variation => {
                let order = if measure == Measure::Bending { 2 } else { 3 };
                need(order)?;
                let unit = unit_of(mean, order);
                for k in self.space.spans() {
                    let (a, b) = (self.knot(k), self.knot(k + 1));
                    for (x, w) in gauss((p as usize - order + 1).max(1)) {
                        let t = a + (b - a) * (0.5 * (1.0 + x));
                        let scale = ((b - a) * (0.5 * w * unit)).sqrt();
                        let values = self.derivative(k, t, order);
                        rows.push(
                            self.space
                                .columns(k)
                                .zip(values.into_iter().map(|v| v * scale))
                                .collect(),
                        );
                    }
                }
            }
            _ => {
                let factorial: f64 = (1..=p).map(|i| i as f64).product();
                let sign = if p % 2 == 0 { -1.0 } else { 1.0 };
                for m in self.space.simple_knots() {
                    let um = self.knot(m);
                    let h = (self.knot(m + 1) - self.knot(m - 1)) * 0.5;
                    let size = (0..p).fold(T::from(sign * factorial), |s, _| s * h);
                    let entry = |s: isize| {
                        let width = self.knot(s + p + 1) - self.knot(s);
                        let others = (s..=s + p + 1).filter(|&l| l != m);
                        let product = others.fold(T::one(), |s, l| s * (um - self.knot(l)));
                        (self.space.column(s), size * width / product)
                    };
                    rows.push((m - p - 1..=m).map(entry).collect());
                }
            }
        }
        Ok(MovingRows { rows })
    }
}
