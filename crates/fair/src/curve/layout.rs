//! Splines whose knots stand at the data: where data lie on the curve, and the curve through them.

use crate::curve::fit::{fit_with, values};
use crate::{FairError, Space, SparseRows, fit};
use moldloft_num::{Banded, Real, Vec3};
use moldloft_spline::KnotVector;

/// A space of splines with as many control points as there are sites, of which one passes through
/// any data at the sites.
///
/// Knots stand at the sites but for those next to the ends ("not a knot", de Boor 1978), so that
/// polynomials are reproduced at any spacing. At a break the spline is continuous and no more.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The splines.
    pub space: Space,
    /// Parameters of the sites: those of the data, and of points that complete short pieces.
    pub sites: Vec<f64>,
    /// The sites as combinations of the data.
    sources: SparseRows,
    /// Which datum each site is.
    pub owner: Vec<Option<usize>>,
    /// The parameter of each datum.
    pub at: Vec<f64>,
    /// Sites that are breaks, each a control point of its own.
    pub marks: Vec<usize>,
    /// Values at the sites over the control points.
    pub rows: SparseRows,
}

impl Layout {
    /// The splines for data at rising parameters in [0, 1] (of a closed curve less than 1), with
    /// `breaks` among them. A closed curve with breaks begins and ends at the first of them.
    ///
    /// # Errors
    /// [`FairError`] when the data are too few, or parameters do not rise.
    pub fn new(
        degree: usize,
        at: &[f64],
        breaks: &[usize],
        closed: bool,
    ) -> Result<Self, FairError> {
        let n = at.len();
        if let Some(&index) = breaks.iter().find(|&&b| b >= n) {
            return Err(FairError::Mark { index, count: n });
        }
        if let Some(k) = (1..n).find(|&k| at[k].is_nan() || at[k] <= at[k - 1]) {
            return Err(FairError::Unsorted { index: k });
        }
        let mut breaks = breaks.to_vec();
        breaks.sort_unstable();
        breaks.dedup();
        if !closed {
            return Self::open(degree, at, (0..n).collect(), &breaks);
        }
        if let Some(&first) = breaks.first() {
            let owner: Vec<usize> = (0..=n).map(|k| (first + k) % n).collect();
            let turned: Vec<f64> = (0..=n)
                .map(|k| at[(first + k) % n] - at[first] + if first + k >= n { 1.0 } else { 0.0 })
                .collect();
            let mut moved: Vec<usize> = breaks.iter().map(|b| b - first).collect();
            moved.push(n);
            let mut layout = Self::open(degree, &turned, owner, &moved)?;
            layout.at = (0..n).map(|i| turned[(i + n - first) % n]).collect();
            return Ok(layout);
        }
        let knot = |k: usize| {
            let next = if k + 1 < n { at[k + 1] } else { at[0] + 1.0 };
            if degree % 2 == 1 { at[k] } else { 0.5 * (at[k] + next) }
        };
        let space = Space::periodic(degree, (0..n).map(knot).collect(), 1.0)?;
        Ok(Self {
            rows: values(&space, at),
            space,
            sites: at.to_vec(),
            sources: SparseRows::identity(n),
            owner: (0..n).map(Some).collect(),
            at: at.to_vec(),
            marks: Vec::new(),
        })
    }

    fn open(
        degree: usize,
        at: &[f64],
        owners: Vec<usize>,
        breaks: &[usize],
    ) -> Result<Self, FairError> {
        let count = at.len();
        if count < 2 {
            return Err(FairError::TooFew { expected: 2, actual: count });
        }
        let last = count - 1;
        let inner = breaks.iter().copied().filter(|&b| 0 < b && b < last);
        let ends: Vec<usize> = std::iter::once(0).chain(inner).chain([last]).collect();
        if ends.len() == 2 && count < degree + 1 {
            return Err(FairError::TooFew { expected: degree + 1, actual: count });
        }
        let mut knots = vec![at[0]; degree + 1];
        let (mut sites, mut owner) = (vec![at[0]], vec![Some(owners[0])]);
        let mut sources = SparseRows::new();
        sources.push([(owners[0], 1.0)]);
        let mut marks = Vec::new();
        if breaks.contains(&0) {
            marks.push(0);
        }
        for pair in ends.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let own = completed(degree, &at[from..=to]);
            let m = own.len();
            let t: Vec<f64> = own.iter().map(|s| s.0).collect();
            // Odd degrees leave out the same number of sites at both ends.
            for j in 1..m - degree {
                knots.push(if degree % 2 == 1 {
                    t[j + degree / 2]
                } else {
                    0.5 * (t[j + degree / 2 - 1] + t[j + degree / 2])
                });
            }
            let times = if to == last { degree + 1 } else { degree };
            knots.extend(std::iter::repeat_n(at[to], times));
            for (site, source) in own.into_iter().skip(1) {
                sites.push(site);
                owner.push(match source[..] {
                    [(k, _)] => Some(owners[from + k]),
                    _ => None,
                });
                sources.push(source.into_iter().map(|(k, x)| (owners[from + k], x)));
            }
            if breaks.contains(&to) {
                marks.push(sites.len() - 1);
            }
        }
        // A single polynomial piece has nothing to fair.
        if knots.len() == 2 * degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: count });
        }
        let space = Space::open(KnotVector::new(degree, knots)?)?;
        let rows = values(&space, &sites);
        Ok(Self { space, sites, sources, owner, at: at.to_vec(), marks, rows })
    }

    /// The sites of data.
    pub fn data<T: Real>(&self, points: &[Vec3<T>]) -> Vec<Vec3<T>> {
        (0..self.sources.len())
            .map(|k| {
                let (columns, factors) = self.sources.row(k);
                if let [only] = columns {
                    return points[*only as usize];
                }
                let entries = columns.iter().zip(factors);
                entries.fold(Vec3::zero(), |s, (&c, &f)| s + points[c as usize].map(|x| x * f))
            })
            .collect()
    }

    /// The sites' tolerances: of a point that completes a short piece the largest near it.
    pub fn radii(&self, radii: &[f64]) -> Vec<f64> {
        let of = |k: usize| {
            let near = self.sources.row(k).0.iter().map(|&c| radii[c as usize]);
            near.fold(0.0, f64::max)
        };
        (0..self.sources.len()).map(of).collect()
    }

    /// The control points of the spline that takes these values at the sites.
    ///
    /// # Errors
    /// [`FairError::Singular`].
    pub fn through<T: Real>(&self, values: &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError> {
        let n = self.space.count();
        if self.space.is_closed() {
            let plain: Vec<_> = values.iter().map(|v| v.re()).collect();
            let own = fit(self.space.clone(), &plain, self.sites.clone(), &vec![1.0; n])?;
            return fit_with(&own, values);
        }
        let solve = |right: &[Vec3<T>]| -> Result<Vec<Vec3<T>>, FairError> {
            let mut matrix = Banded::<T>::zero(n, self.space.degree().min(n - 1));
            for k in 0..n {
                let (columns, factors) = self.rows.row(k);
                for (&c, &f) in columns.iter().zip(factors) {
                    *matrix.entry(k, c as usize) = T::from(f);
                }
            }
            let mut out = right.to_vec();
            matrix.solve(&mut out).map_err(|_| FairError::Singular)?;
            Ok(out)
        };
        let mut control = solve(values)?;
        // Once more for what rounding left.
        let short: Vec<Vec3<T>> = (0..n)
            .map(|k| {
                let (columns, factors) = self.rows.row(k);
                let entries = columns.iter().zip(factors);
                entries.fold(values[k], |s, (&c, &f)| s - control[c as usize].map(|x| x * f))
            })
            .collect();
        for (c, more) in control.iter_mut().zip(solve(&short)?) {
            *c += more;
        }
        if control.iter().any(|c| !c.is_finite()) {
            return Err(FairError::Singular);
        }
        // Marks and ends are data by their bits.
        for &m in &self.marks {
            let (columns, factors) = self.rows.row(m);
            if let (&[c], &[1.0]) = (columns, factors) {
                control[c as usize] = values[m];
            }
        }
        Ok(control)
    }

    /// By how much control points can move when the curve moves at the sites by these radii at
    /// most: the collocation matrix is totally positive, so its inverse has the signs of a
    /// chequer-board and one solution with alternating signs has the sums of its entries' sizes.
    ///
    /// # Errors
    /// [`FairError::Singular`].
    pub fn reach(&self, radii: &[f64]) -> Result<Vec<f64>, FairError> {
        let n = self.space.count();
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let size = |points: &[Vec3<f64>]| points.iter().map(|p| p.x.abs()).collect::<Vec<f64>>();
        let alternating = |radii: &[f64]| -> Vec<Vec3<f64>> {
            radii.iter().enumerate().map(|(k, r)| Vec3::of(sign(k) * r, 0.0, 0.0)).collect()
        };
        if !self.space.is_closed() || n.is_multiple_of(2) {
            return Ok(size(&self.through(&alternating(radii))?));
        }
        // Signs alternate round a closed curve when it is run through twice.
        let twice = |all: &[f64]| -> Vec<f64> {
            all.iter().copied().chain(all.iter().map(|t| t + 1.0)).collect()
        };
        let double = Self {
            space: Space::periodic(self.space.degree(), twice(self.space.knots()), 2.0)?,
            sites: twice(&self.sites),
            ..self.clone()
        };
        let radii: Vec<f64> = radii.iter().chain(radii).copied().collect();
        let all = double.through(&alternating(&radii))?;
        Ok(size(&all[..n]))
    }
}

/// The parameters of a piece with at least `degree + 1` sites, each as a combination of the data:
/// what is missing is taken from the polynomial through the others, spread over its gaps.
fn completed(degree: usize, at: &[f64]) -> Vec<(f64, Vec<(usize, f64)>)> {
    let m = at.len();
    let datum = |k: usize| (at[k], vec![(k, 1.0)]);
    if m > degree {
        return (0..m).map(datum).collect();
    }
    let (missing, gaps) = (degree + 1 - m, m - 1);
    let mut out = Vec::new();
    for gap in 0..gaps {
        out.push(datum(gap));
        let share = missing / gaps + usize::from(gap < missing % gaps);
        for k in 1..=share {
            let t = at[gap] + (at[gap + 1] - at[gap]) * k as f64 / (share + 1) as f64;
            let factor = |j: usize| {
                let others = (0..m).filter(|&i| i != j);
                others.map(|i| (t - at[i]) / (at[j] - at[i])).product::<f64>()
            };
            out.push((t, (0..m).map(|j| (j, factor(j))).collect()));
        }
    }
    out.push(datum(m - 1));
    out
}
