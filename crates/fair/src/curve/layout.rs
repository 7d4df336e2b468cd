//! Splines with knots at the data: parameters of the data, and the interpolating spline.

use crate::curve::condition::AXES;
use crate::curve::fit::{fit_with, values};

use crate::curve::moving::{MapReal, MovingSpace};
use crate::curve::thinning::CurvesBesideData;
use crate::{Condition, FairError, Space, SparseRows, fit};
use moldloft_num::{Banded, Real, Vec3};
use moldloft_spline::KnotVector;

/// A space of splines with as many control points as sites: for any data at the sites it has a
/// unique interpolating spline.
///
/// Knots are at the sites except those next to the ends ("not a knot", de Boor 1978), so that
/// polynomials are reproduced at any spacing. At a break the spline is only continuous.
#[derive(Clone, Debug)]
pub struct InterpolationSpace {
    /// The splines.
    pub space: Space,
    /// Parameters of the sites: those of the data, and of points that complete short pieces.
    pub sites: Vec<f64>,
    /// The sites as combinations of the data.
    pub(super) sources: SparseRows,
    /// Sites without a datum are on the polynomial through the data of their row of `sources`.
    polynomial: bool,
    /// Datum of each site.
    pub owner: Vec<Option<usize>>,
    /// True for sites between the data at which the curve is free.
    pub(super) free: Vec<bool>,
    /// The parameter of each datum.
    pub at: Vec<f64>,
    /// Sites that are breaks; each is a control point.
    pub marks: Vec<usize>,
    /// Values at the sites over the control points.
    pub rows: SparseRows,
    /// Sites as interpolations between two parameters of the list.
    site_of: Vec<Share>,
    /// Knots as interpolations between two sites.
    knot_of: Vec<Share>,
    /// The datum at which a closed curve with breaks begins.
    pub(super) first: Option<usize>,
    /// Curves beside the data where the space has far fewer control points than these.
    pub(crate) thin: Option<CurvesBesideData>,
}

/// The degree of curves with straight runs.
const CUBIC: usize = 3;

/// An interpolation between two items of a list, by indices and fraction; if the second index is
/// the length of the list, between the last and the first of a closed curve.
type Share = (usize, usize, f64);

impl InterpolationSpace {
    /// The splines for data at increasing parameters in [0, 1] (less than 1 for a closed curve),
    /// with `breaks` among them. A closed curve with breaks begins and ends at the first break.
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
            return Self::open(degree, at, (0..n).collect(), &breaks, &[]);
        }
        if let [first, .., last] = at
            && last - first >= 1.0
        {
            return Err(FairError::Unsorted { index: n });
        }
        if let Some(&first) = breaks.first() {
            let owner: Vec<usize> = (0..=n).map(|k| (first + k) % n).collect();
            let turned: Vec<f64> = (0..=n)
                .map(|k| at[(first + k) % n] - at[first] + if first + k >= n { 1.0 } else { 0.0 })
                .collect();
            let mut moved: Vec<usize> = breaks.iter().map(|b| b - first).collect();
            moved.push(n);
            let mut layout = Self::open(degree, &turned, owner, &moved, &[])?;
            layout.first = Some(first);
            layout.at = (0..n).map(|i| turned[(i + n - first) % n]).collect();
            return Ok(layout);
        }
        let half = if degree % 2 == 1 { 0.0 } else { 0.5 };
        let knot_of: Vec<Share> = (0..n).map(|k| (k, k + 1, half)).collect();
        let knots = knot_of.iter().map(|&s| shared(at, s)).collect();
        let space = Space::periodic(degree, knots, 1.0)?;
        Ok(Self {
            rows: values(&space, at),
            space,
            sites: at.to_vec(),
            sources: SparseRows::identity(n),
            polynomial: true,
            owner: (0..n).map(Some).collect(),
            free: vec![false; n],
            at: at.to_vec(),
            marks: Vec::new(),
            site_of: (0..n).map(|k| (k, k, 0.0)).collect(),
            knot_of,
            first: None,
            thin: None,
        })
    }

    /// Cubics with straight runs among the data, from place to place: of a run its own points alone
    /// decide, so that it is straight where these are, and what begins or ends at it has its tangent
    /// there and a curvature of its own.
    ///
    /// # Errors
    /// As [`InterpolationSpace::new`].
    pub(crate) fn with_runs(
        at: &[f64],
        breaks: &[usize],
        runs: &[[usize; 2]],
        closed: bool,
    ) -> Result<Self, FairError> {
        let n = at.len();
        if runs.is_empty() {
            return Self::new(CUBIC, at, breaks, closed);
        }
        let mut all: Vec<usize> =
            breaks.iter().copied().chain(runs.iter().flatten().copied()).collect();
        all.sort_unstable();
        all.dedup();
        if let Some(&index) = all.iter().find(|&&b| b >= n) {
            return Err(FairError::Mark { index, count: n });
        }
        if let Some(k) = (1..n).find(|&k| at[k].is_nan() || at[k] <= at[k - 1]) {
            return Err(FairError::Unsorted { index: k });
        }
        // A closed curve begins at the first of its breaks and ends of runs.
        let first = if closed { all[0] } else { 0 };
        let count = if closed { n + 1 } else { n };
        let owners: Vec<usize> = (0..count).map(|k| (first + k) % n).collect();
        let round = |k: usize| if first + k >= n { 1.0 } else { 0.0 };
        let turned: Vec<f64> = if closed {
            (0..count).map(|k| at[owners[k]] - at[first] + round(k)).collect()
        } else {
            at.to_vec()
        };
        let mut moved: Vec<usize> = all.iter().map(|b| b - first).collect();
        if closed {
            moved.push(n);
        }
        // The pieces that take their tangent from a run at the first place, or at the last.
        let sharp = |k: usize| breaks.contains(&owners[k]);
        let ends_run = |k: usize, end: usize| runs.iter().any(|run| run[end] == owners[k]);
        let tangents: Vec<[bool; 2]> = {
            let bounds: Vec<usize> = {
                let mut bounds = vec![0];
                bounds.extend(moved.iter().copied().filter(|&b| 0 < b && b < count - 1));
                bounds.push(count - 1);
                bounds
            };
            let tangent = |pair: &[usize]| {
                let inside = runs.iter().any(|run| run[0] == owners[pair[0]]);
                [
                    !inside && ends_run(pair[0], 1) && !sharp(pair[0]),
                    !inside && ends_run(pair[1], 0) && !sharp(pair[1]),
                ]
            };
            bounds.windows(2).map(tangent).collect()
        };
        let mut layout = Self::open(CUBIC, &turned, owners, &moved, &tangents)?;
        if closed {
            layout.first = Some(first);
            layout.at = (0..n).map(|i| turned[(i + n - first) % n]).collect();
        }
        Ok(layout)
    }

    fn open(
        degree: usize,
        at: &[f64],
        owners: Vec<usize>,
        breaks: &[usize],
        tangents: &[[bool; 2]],
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
        let mut knot_of: Vec<Share> = vec![(0, 0, 0.0); degree + 1];
        let mut site_of: Vec<Share> = vec![(0, 0, 0.0)];
        let (mut sites, mut owner) = (vec![at[0]], vec![Some(owners[0])]);
        let mut sources = SparseRows::new();
        sources.push([(owners[0], 1.0)]);
        let mut marks = Vec::new();
        if breaks.contains(&0) {
            marks.push(0);
        }
        let mut held = Vec::new();
        for (piece, pair) in ends.windows(2).enumerate() {
            let (from, to) = (pair[0], pair[1]);
            let tangent = tangents.get(piece).copied().unwrap_or_default();
            let own = if tangent == [false; 2] {
                completed(degree, &at[from..=to])
            } else {
                held.push((sites.len() - 1, tangent));
                with_tangents(to - from + 1, tangent)
            };
            let m = own.len();
            let start = sites.len() - 1;
            // Odd degrees leave out the same number of sites at both ends.
            for j in 1..m - degree {
                let middle = start + j + degree / 2;
                knot_of.push(if degree % 2 == 1 {
                    (middle, middle, 0.0)
                } else {
                    (middle - 1, middle, 0.5)
                });
            }
            let times = if to == last { degree + 1 } else { degree };
            knot_of.extend(std::iter::repeat_n((start + m - 1, start + m - 1, 0.0), times));
            for (share, source) in own.into_iter().skip(1) {
                let share = (from + share.0, from + share.1, share.2);
                sites.push(shared(at, share));
                site_of.push(share);
                owner.push(match source[..] {
                    [(k, 1.0)] => Some(owners[from + k]),
                    _ => None,
                });
                sources.push(source.into_iter().map(|(k, x)| (owners[from + k], x)));
            }
            if breaks.contains(&to) {
                marks.push(sites.len() - 1);
            }
        }
        // A single polynomial piece has nothing to fair.
        if knot_of.len() == 2 * degree + 2 {
            return Err(FairError::TooFew { expected: degree + 2, actual: count });
        }
        let knots = knot_of.iter().map(|&s| shared(&sites, s)).collect();
        let space = Space::open(KnotVector::new(degree, knots)?)?;
        let rows = values(&space, &sites);
        let (at, first, thin) = (at.to_vec(), None, None);
        let polynomial = held.is_empty();
        let mut layout = Self {
            space,
            sites,
            sources,
            polynomial,
            free: vec![false; owner.len()],
            owner,
            at,
            marks,
            rows,
            site_of,
            knot_of,
            first,
            thin,
        };
        if !held.is_empty() {
            layout.sources = layout.tangent_sources(&held)?;
        }
        Ok(layout)
    }

    /// The sites over the data where pieces have the tangents of the runs beside them: of each its
    /// first site, and whether it takes one there and at its end.
    fn tangent_sources(&self, held: &[(usize, [bool; 2])]) -> Result<SparseRows, FairError> {
        let n = self.sites.len();
        let unknown: Vec<usize> = (0..n).filter(|&k| self.sources.row(k).0.is_empty()).collect();
        let mut responses = Vec::with_capacity(n);
        for k in 0..n {
            let mut unit = vec![Vec3::zero(); n];
            unit[k] = Vec3::of(1.0, 0.0, 0.0);
            responses.push(self.through(&unit)?);
        }
        let slope = |span: isize, t: f64| -> Vec<f64> {
            let basis = self.space.basis(span, t);
            let of = |control: &Vec<Vec3<f64>>| {
                let columns = self.space.columns(span).zip(basis.rows[1].iter());
                columns.map(|(c, b)| control[c].x * b).sum()
            };
            responses.iter().map(of).collect()
        };
        // The conditions to satisfy, over the sites.
        let mut equations: Vec<Vec<f64>> = Vec::new();
        for &(first, tangent) in held {
            let last = (first + 1..n)
                .find(|&k| self.owner[k].is_some() && self.marks.contains(&k))
                .unwrap_or(n - 1);
            for (place, _) in [first, last].iter().zip(tangent).filter(|(_, held)| *held) {
                let t = self.sites[*place];
                let beside = |left: bool| {
                    let end = |k: &isize| self.space.knot(*k + isize::from(left)) == t;
                    self.space.spans().find(end)
                };
                let (Some(left), Some(right)) = (beside(true), beside(false)) else { continue };
                let pair = slope(left, t).into_iter().zip(slope(right, t));
                equations.push(pair.map(|(a, b)| a - b).collect());
            }
            let open = unknown.iter().filter(|&&u| first < u && u < last).count();
            if open == 2 && tangent != [true; 2] {
                // Two points and a tangent: a parabola.
                let mut row = vec![0.0; n];
                for k in first..=last {
                    let others = (first..=last).filter(|&l| l != k);
                    row[k] = 1.0 / others.map(|l| self.sites[k] - self.sites[l]).product::<f64>();
                }
                equations.push(row);
            }
        }
        let m = unknown.len();
        if equations.len() != m {
            return Err(FairError::Singular);
        }
        let mut out = vec![Vec::new(); m];
        for k in (0..n).filter(|k| !unknown.contains(k)) {
            let mut matrix = Vec::with_capacity(m * m);
            let mut right = Vec::with_capacity(m);
            for row in &equations {
                let size = row.iter().fold(f64::MIN_POSITIVE, |s, x| s.max(x.abs()));
                matrix.extend(unknown.iter().map(|&u| row[u] / size));
                right.push(-row[k] / size);
            }
            moldloft_num::solve_dense(&mut matrix, &mut right).map_err(|_| FairError::Singular)?;
            for (own, x) in out.iter_mut().zip(right) {
                own.push((k, x));
            }
        }
        let mut sources = SparseRows::new();
        for k in 0..n {
            let (columns, factors) = self.sources.row(k);
            match unknown.iter().position(|&u| u == k) {
                None => {
                    sources.push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()))
                }
                Some(u) => {
                    // Sites are data here, or combinations of them.
                    let mut entries = std::collections::BTreeMap::new();
                    for &(site, x) in out[u].iter().filter(|(_, x)| *x != 0.0) {
                        let (columns, factors) = self.sources.row(site);
                        for (&c, &f) in columns.iter().zip(factors) {
                            *entries.entry(c as usize).or_insert(0.0) += x * f;
                        }
                    }
                    sources.push(entries);
                }
            }
        }
        Ok(sources)
    }

    /// A space of fewer control points than there are data, at parameters `at` in any order; `rows` are the
    /// values there.
    pub(crate) fn thin(
        space: Space,
        at: Vec<f64>,
        rows: SparseRows,
        thin: CurvesBesideData,
    ) -> Self {
        let n = at.len();
        Self {
            space,
            sites: at.clone(),
            sources: SparseRows::identity(n),
            polynomial: true,
            owner: (0..n).map(Some).collect(),
            free: vec![false; n],
            at,
            marks: Vec::new(),
            rows,
            site_of: (0..n).map(|k| (k, k, 0.0)).collect(),
            knot_of: Vec::new(),
            first: None,
            thin: Some(thin),
        }
    }

    /// True if there are knots between the data.
    pub fn is_refined(&self) -> bool {
        self.free.contains(&true)
    }

    /// True if there is a knot at each datum, so that the spline interpolates.
    pub fn interpolates(&self) -> bool {
        self.thin.is_none()
    }

    /// The parameters of the sites and the knots for parameters of the data that carry derivatives,
    /// whose real parts are those of the layout.
    pub(crate) fn moving<T: Real>(&self, at: &[T]) -> (Vec<T>, Vec<T>) {
        let n = at.len();
        let turned: Vec<T> = match self.first {
            None => at.to_vec(),
            Some(first) => (0..=n)
                .map(|k| {
                    let once = if first + k >= n { T::one() } else { T::zero() };
                    at[(first + k) % n] - at[first] + once
                })
                .collect(),
        };
        let sites: Vec<T> = self.site_of.iter().map(|&s| shared(&turned, s)).collect();
        let knots = self.knot_of.iter().map(|&s| shared(&sites, s)).collect();
        (sites, knots)
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

    /// The sites of data at parameters that carry derivatives, whose real parts are those of the
    /// layout; `sites` are the parameters of the sites (see [`Self::moving`]).
    pub(crate) fn moving_data<T: Real>(
        &self,
        points: &[Vec3<T>],
        at: &[T],
        sites: &[T],
    ) -> Vec<Vec3<T>> {
        let mut out = self.data(points);
        let short = |k: &usize| self.polynomial && self.sources.row(*k).0.len() > 1;
        for k in (0..out.len()).filter(short) {
            let (columns, t) = (self.sources.row(k).0, sites[k]);
            let places: Vec<T> =
                columns.iter().map(|&c| self.place(at, c as usize, columns)).collect();
            let mut moved = Vec3::zero();
            for (j, &c) in columns.iter().enumerate() {
                let others = (0..columns.len()).filter(|&i| i != j);
                let factor = others.fold(T::one(), |product, i| {
                    product * ((t - places[i]) / (places[j] - places[i]))
                });
                moved += points[c as usize].map(|x| x * factor);
            }
            out[k] = Vec3::lifted(out[k].re()) + (moved - Vec3::lifted(moved.re()));
        }
        out
    }

    /// The parameter of a datum of a piece, that of the first break of a closed curve being 0 or 1.
    fn place<T: Real>(&self, at: &[T], datum: usize, piece: &[u32]) -> T {
        let Some(first) = self.first else { return at[datum] };
        let ends = datum == first && !piece.contains(&(((first + 1) % at.len()) as u32));
        let turn = if datum < first || ends { T::one() } else { T::zero() };
        at[datum] - at[first] + turn
    }

    /// The data at breaks.
    pub(crate) fn break_data(&self) -> Vec<usize> {
        self.marks.iter().filter_map(|&m| self.owner[m]).collect()
    }

    /// Doubles the knot of a cubic at a datum, or at a fraction of the interval to the next one, so
    /// that the curvature may jump there. The knots are taken from the neighbourhood, preferably
    /// where `spare` is true; if there are none, nothing changes.
    pub(crate) fn doubled(
        &mut self,
        datum: usize,
        share: Option<f64>,
        spare: impl Fn(usize) -> bool,
    ) -> Result<bool, FairError> {
        let site = |k: usize| self.owner.iter().position(|o| *o == Some(k));
        let (Some(a), b) = (site(datum), site(datum + 1)) else { return Ok(true) };
        let place: Share = match (share, b) {
            (Some(s), Some(b)) => (a, b, s),
            _ => (a, a, 0.0),
        };
        let t = shared(&self.sites, place);
        let here = self.knot_of.iter().filter(|&&k| shared(&self.sites, k) == t).count();
        let wanted = 2usize.saturating_sub(here);
        // A piece between breaks keeps as many knots as it has data.
        let breaks = self.marks.iter().map(|&m| self.sites[m]);
        let low = breaks.clone().filter(|&m| m <= t).fold(f64::NEG_INFINITY, f64::max);
        let high = breaks.filter(|&m| m > t).fold(f64::INFINITY, f64::min);
        // Simple knots at data, the nearest first, those that are spare sixteen times nearer.
        let mut near: Vec<(f64, usize)> = Vec::new();
        for (at, &k) in self.knot_of.iter().enumerate() {
            let value = shared(&self.sites, k);
            let alone = self.knot_of.iter().filter(|&&o| shared(&self.sites, o) == value).count();
            let owner = self.owner[k.0].filter(|_| k.2 == 0.0);
            if let (1, Some(owner)) = (alone, owner)
                && value != t
                && low < value
                && value < high
            {
                let weight = if spare(owner) { 1.0 } else { 16.0 };
                near.push(((value - t).abs() * weight, at));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        if near.len() < wanted {
            return Ok(true);
        }
        let before = self.knot_of.clone();
        for &(_, at) in near.iter().take(wanted) {
            self.knot_of[at] = place;
        }
        let value = |k: &Share| shared(&self.sites, *k);
        self.knot_of.sort_by(|a, b| value(a).total_cmp(&value(b)));
        let knots = self.knot_of.iter().map(value).collect();
        let space = Space::open(KnotVector::new(self.space.degree(), knots)?)?;
        let rows = values(&space, &self.sites);
        // Each site in the support of its own basis function (Schoenberg and Whitney 1953).
        let own = |k: usize| {
            let (columns, factors) = rows.row(k);
            columns.iter().zip(factors).any(|(&c, &f)| c as usize == k && f > 0.0)
        };
        if !(0..self.sites.len()).all(own) {
            self.knot_of = before;
            return Ok(false);
        }
        (self.space, self.rows) = (space, rows);
        Ok(true)
    }

    /// The conditions that pieces with fewer data than control points stay polynomials of the degree that these
    /// determine: differences of their control points vanish. Where all data of such a piece stay, so does the piece.
    pub(crate) fn short_conditions(&self, frozen: &mut [bool]) -> Vec<Condition> {
        let mut out = Vec::new();
        if !self.polynomial || self.thin.is_some() || self.space.is_closed() {
            return out;
        }
        let degree = self.space.degree();
        let known = |k: usize| self.owner[k].is_some();
        let mut first = 0;
        for last in 1..self.sites.len() {
            if !(self.marks.contains(&last) || last + 1 == self.sites.len()) {
                continue;
            }
            let sites = first..=last;
            let count = sites.clone().filter(|&k| known(k)).count();
            if count <= degree && last - first == degree {
                if count == 2 && frozen[first] && frozen[last] {
                    frozen[sites].fill(true);
                } else {
                    let factors = differences(count);
                    for from in first..=last - count {
                        for axis in AXES {
                            let entries = factors.iter().enumerate();
                            let entries = entries.map(|(j, &f)| (from + j, axis * f)).collect();
                            out.push(Condition { entries, value: 0.0 });
                        }
                    }
                }
            }
            first = last;
        }
        out
    }

    /// The data that a site depends on.
    pub(crate) fn sources_of(&self, site: usize) -> impl Iterator<Item = usize> + '_ {
        self.sources.row(site).0.iter().map(|&c| c as usize)
    }

    /// The tolerances of the sites; a point that completes a short piece has the largest tolerance
    /// near it, a free one none.
    pub fn radii(&self, radii: &[f64]) -> Vec<f64> {
        let of = |k: usize| {
            if self.free[k] {
                return f64::INFINITY;
            }
            let near = self.sources.row(k).0.iter().map(|&c| radii[c as usize]);
            near.fold(0.0, f64::max)
        };
        (0..self.sources.len()).map(of).collect()
    }

    /// The control points of the spline that has these values at the sites.
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
                for (&c, &f) in columns.iter().zip(factors).filter(|(_, f)| **f != 0.0) {
                    if k.abs_diff(c as usize) > self.space.degree() {
                        return Err(FairError::Singular);
                    }
                    *matrix.entry(k, c as usize) = T::from(f);
                }
            }
            let mut out = right.to_vec();
            matrix.solve(&mut out).map_err(|_| FairError::Singular)?;
            Ok(out)
        };
        let mut control = solve(values)?;
        // A second pass removes rounding.
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

    /// Control points and knots of the spline through data at parameters that carry derivatives,
    /// whose real parts are those of the layout.
    ///
    /// # Errors
    /// [`FairError::Singular`].
    pub(crate) fn through_moving<T: Real>(
        &self,
        points: &[Vec3<T>],
        at: &[T],
    ) -> Result<(Vec<Vec3<T>>, Vec<T>), FairError> {
        let (sites, knots) = self.moving(at);
        let wanted = self.moving_data(points, at, &sites);
        let real: Vec<Vec3<f64>> = wanted.iter().map(|p| p.re()).collect();
        let control = self.through(&real)?;
        let space = MovingSpace { space: &self.space, knots: &knots };
        let change: Vec<Vec3<T>> = sites
            .iter()
            .zip(&wanted)
            .map(|(&t, &p)| {
                let value = space.value(t);
                let at = value
                    .iter()
                    .fold(Vec3::zero(), |s: Vec3<T>, &(c, f)| s + control[c].map_real(|x| f * x));
                let off = p - at;
                off - Vec3::lifted(off.re())
            })
            .collect();
        let change = self.through(&change)?;
        Ok((control.iter().zip(change).map(|(&p, c)| Vec3::lifted(p) + c).collect(), knots))
    }

    /// Maximum move of each control point when the curve moves at the sites by at most these radii.
    /// The collocation matrix is totally positive, so its inverse has checkerboard signs, and one
    /// solution with alternating signs gives the row sums of absolute values.
    ///
    /// # Errors
    /// [`FairError::Singular`].
    pub fn reach(&self, radii: &[f64]) -> Result<Vec<f64>, FairError> {
        if self.thin.is_some() {
            return self.thin_reach(radii);
        }
        let n = self.space.count();
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let size = |points: &[Vec3<f64>]| points.iter().map(|p| p.x.abs()).collect::<Vec<f64>>();
        let alternating = |radii: &[f64]| -> Vec<Vec3<f64>> {
            radii.iter().enumerate().map(|(k, r)| Vec3::of(sign(k) * r, 0.0, 0.0)).collect()
        };
        if !self.space.is_closed() || n.is_multiple_of(2) {
            return Ok(size(&self.through(&alternating(radii))?));
        }
        // Signs alternate around a closed curve when it is traversed twice.
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

    /// The reach of control points that only some of the sites limit: of each control point the
    /// site with the largest coefficient.
    fn thin_reach(&self, radii: &[f64]) -> Result<Vec<f64>, FairError> {
        let n = self.space.count();
        let mut best: Vec<Option<(f64, usize)>> = vec![None; n];
        for k in 0..self.sites.len() {
            let (columns, factors) = self.rows.row(k);
            for (&c, &f) in columns.iter().zip(factors) {
                let own = &mut best[c as usize];
                if own.is_none_or(|b| f > b.0) {
                    *own = Some((f, k));
                }
            }
        }
        let mut chosen: Vec<usize> = best.into_iter().flatten().map(|b| b.1).collect();
        chosen.sort_by(|&a, &b| self.sites[a].total_cmp(&self.sites[b]));
        chosen.dedup();
        if chosen.len() < n {
            return Err(FairError::Singular);
        }
        let sites: Vec<f64> = chosen.iter().map(|&k| self.sites[k]).collect();
        let rows = values(&self.space, &sites);
        let few = Self { sites, rows, thin: None, ..self.clone() };
        few.reach(&chosen.iter().map(|&k| radii[k]).collect::<Vec<f64>>())
    }
}

/// The factors of the differences of an order.
fn differences(order: usize) -> Vec<f64> {
    let mut out = vec![1.0];
    for _ in 0..order {
        let before = out.iter().chain([&0.0]).zip([0.0].iter().chain(&out));
        out = before.map(|(a, b)| b - a).collect();
    }
    out
}

/// Interpolation between two items of a list.
fn shared<T: Real>(list: &[T], (a, b, share): Share) -> T {
    if share == 0.0 {
        return list[a];
    }
    let to = if b < list.len() { list[b] } else { list[0] + T::one() };
    list[a] + (to - list[a]) * share
}

/// The sites of a cubic piece of a number of data, with tangents at its first, its last or both:
/// sites without sources follow from these.
fn with_tangents(count: usize, tangent: [bool; 2]) -> Vec<(Share, Vec<(usize, f64)>)> {
    let datum = |k: usize| ((k, k, 0.0), vec![(k, 1.0)]);
    if count == 2 {
        let more = [1.0, 2.0].map(|k| ((0, 1, k / 3.0), Vec::new()));
        return [datum(0)].into_iter().chain(more).chain([datum(1)]).collect();
    }
    let mut out: Vec<_> = (0..count).map(datum).collect();
    if tangent[1] {
        out.insert(count - 1, ((count - 2, count - 1, 0.5), Vec::new()));
    }
    if tangent[0] {
        out.insert(1, ((0, 1, 0.5), Vec::new()));
    }
    out
}

/// Parameters of a piece with at least `degree + 1` sites, each as a combination of the data:
/// missing sites are on the polynomial through the data, distributed over its gaps.
fn completed(degree: usize, at: &[f64]) -> Vec<(Share, Vec<(usize, f64)>)> {
    let m = at.len();
    let datum = |k: usize| ((k, k, 0.0), vec![(k, 1.0)]);
    if m > degree {
        return (0..m).map(datum).collect();
    }
    let (missing, gaps) = (degree + 1 - m, m - 1);
    let mut out = Vec::new();
    for gap in 0..gaps {
        out.push(datum(gap));
        let more = missing / gaps + usize::from(gap < missing % gaps);
        for k in 1..=more {
            let share = k as f64 / (more + 1) as f64;
            let t = at[gap] + (at[gap + 1] - at[gap]) * share;
            let factor = |j: usize| {
                let others = (0..m).filter(|&i| i != j);
                others.map(|i| (t - at[i]) / (at[j] - at[i])).product::<f64>()
            };
            out.push(((gap, gap + 1, share), (0..m).map(|j| (j, factor(j))).collect()));
        }
    }
    out.push(datum(m - 1));
    out
}
