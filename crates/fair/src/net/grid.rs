//! Grids of data under tolerances: the fairest tensor-product spline that stays within each datum's
//! tolerance at the datum's own parameters.
//!
//! minimise   sum over v of E(x(., v)) + sum over u of E(x(u, .))
//! subject to |x(u_i, v_j) - p_ij| <= a_ij
//!
//! Knots stand at the data in both directions ([`InterpolationSpace`]), so any tolerance can be kept. The sums
//! run over the surface's curves through the data, each with the weight of the range that it stands
//! for: integrals over the surface by the trapezoidal rule. Both directions count by the parameter
//! from 0 to 1, hence by the measure of a curve of unit length.

use crate::curve::exact::{all_exact, between_breaks};
use crate::curve::moving::{MovingRows, MovingSites, MovingSpace};
use crate::optimum::goal::{
    Adaptation, Goal, GoalOptimum, GoalVariation, RegularizationPath, check_decided, check_single,
    check_unique, moved, rounding, tightened,
};
use crate::optimum::ties::Ties;
use crate::optimum::{Bounded, DataLimits, Parts, Solved};
use crate::{
    Certificate, Condition, EndContinuity, FairError, InterpolationSpace, Limit, Measure, Motion,
    Network, ParameterSpacing, RowNorm, SparseRows, parameters_across,
};
use moldloft_num::{Real, Vec3};

/// A grid of data with tolerances; point (i, j) is at `i * n + j`.
#[derive(Clone, Debug)]
pub struct GridData {
    /// The data.
    pub points: Vec<Vec3<f64>>,
    /// Limits on the distances of the surface from the data, and the directions of motion.
    pub limit: Limit,
    /// Parameters of the data and the splines, along u and along v.
    pub layouts: [InterpolationSpace; 2],
    /// Conditions at the rims of the surface through the data: at both ends of u, then of v. Free
    /// rims fix the corners alone.
    pub rims: [[EndContinuity; 2]; 2],
}

/// A faired surface.
#[derive(Clone, Debug)]
pub struct GridFit {
    /// Its control points.
    pub points: Vec<Vec3<f64>>,
    /// Control points of the surface through the data.
    pub original: Vec<Vec3<f64>>,
    /// The distance of each datum from the surface at its parameters.
    pub residuals: Vec<f64>,
    /// The mean of the squared residuals over the tolerances, over 1/3.
    pub used: f64,
    /// The same mean for the fairest surface; see [`crate::DataFit`].
    pub fairest_used: f64,
    /// The measure of the surface and the optimality gap; see [`crate::DataFit`].
    pub certificate: Certificate,
    /// The measure of the surface through the data.
    pub before: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Tolerances that are reached.
    pub active: usize,
}

/// The parameters of a grid of points along both directions, each the mean over its lines. Lines of
/// coincident points, such as poles, are ignored. A coordinate is used for the direction along
/// which it is monotone, chord lengths for the other. `radii` are the tolerances of the points, or
/// empty; see [`parameters_across`].
///
/// # Errors
/// [`FairError::Count`] when there are not m n points.
pub fn grid_parameters<T: Real>(
    points: &[Vec3<T>],
    [m, n]: [usize; 2],
    spacing: [ParameterSpacing; 2],
    closed: [bool; 2],
    (motion, radii): (Motion, &[f64]),
) -> Result<[Vec<T>; 2], FairError> {
    if points.len() != m * n {
        return Err(FairError::Count { what: "points", expected: m * n, actual: points.len() });
    }
    let along = |d: usize, lines: usize, at: &dyn Fn(usize, usize) -> usize| {
        let (count, spacing, closed) = ([m, n][d], spacing[d], closed[d]);
        let mut sum = vec![T::zero(); count];
        let mut used = 0usize;
        for line in 0..lines {
            let list: Vec<Vec3<T>> = (0..count).map(|k| points[at(k, line)]).collect();
            let allowed: Vec<f64> =
                (0..count).filter_map(|k| radii.get(at(k, line)).copied()).collect();
            let limit = (motion, allowed.as_slice());
            let own = match parameters_across(&list, spacing, closed, limit) {
                Err(FairError::TurnsAlong { .. } | FairError::Coincident { .. })
                    if matches!(spacing, ParameterSpacing::Along(_)) =>
                {
                    parameters_across(&list, ParameterSpacing::Chord, closed, limit)
                }
                own => own,
            };
            if let Ok(own) = own {
                sum.iter_mut().zip(own).for_each(|(s, t)| *s += t);
                used += 1;
            }
        }
        let steps = (if closed { count } else { count.max(2) - 1 }) as f64;
        let even = (0..count).map(|k| T::from(k as f64 / steps));
        if used == 0 {
            return even.collect::<Vec<T>>();
        }
        sum.iter_mut().for_each(|s| *s = *s / T::from(used as f64));
        if !closed && let Some(last) = sum.last_mut() {
            *last = T::one();
        }
        sum
    };
    Ok([along(0, n, &|k, line| k * n + line), along(1, m, &|k, line| line * n + k)])
}

/// As `Spacing::Chord`, but with a coordinate in place of chord lengths if all lines of the
/// direction share its values, as stations and waterlines do, it is monotone along them, and they
/// are not too steep. A point that leaves its station makes it chord lengths again, so it is for
/// fixed data only. The tolerances `radii` reduce the steepness of a step, so that noise between
/// close stations does not count.
pub fn grid_spacing(
    points: &[Vec3<f64>],
    [m, n]: [usize; 2],
    spacing: ParameterSpacing,
    closed: [bool; 2],
    radii: &[f64],
) -> [ParameterSpacing; 2] {
    let own = |d: usize, lines: usize, at: &dyn Fn(usize, usize) -> usize| {
        let fit = matches!(spacing, ParameterSpacing::Chord) && !closed[d] && points.len() == m * n;
        let axis = if fit { stations(points, radii, [m, n][d], lines, at) } else { None };
        axis.map_or(spacing, ParameterSpacing::Along)
    };
    [own(0, n, &|k, line| k * n + line), own(1, m, &|k, line| line * n + k)]
}

/// Minimum ratio of the projection of a chord on the stations to its length.
const SHALLOW: f64 = 0.2;

/// The coordinate that the lines of a direction share.
fn stations(
    points: &[Vec3<f64>],
    radii: &[f64],
    count: usize,
    lines: usize,
    at: &dyn Fn(usize, usize) -> usize,
) -> Option<Vec3<f64>> {
    let of = |k: usize, line: usize| points[at(k, line)];
    crate::curve::condition::AXES.into_iter().find(|axis| {
        let own = |k: usize| of(k, 0).dot(*axis);
        let common = (0..count).all(|k| (1..lines).all(|line| of(k, line).dot(*axis) == own(k)));
        let step = |k: usize| own(k) - own(k - 1);
        let rises = (2..count).all(|k| step(k) * step(1) > 0.0);
        let shallow = (1..count).all(|k| {
            let chords = (0..lines).map(|line| {
                let (a, b) = (at(k - 1, line), at(k, line));
                let allowed: f64 = [a, b].iter().filter_map(|&i| radii.get(i)).sum();
                let across = points[b] - points[a] - *axis * step(k);
                let needed = (across.norm() - allowed).max(0.0);
                (needed * needed + step(k) * step(k)).sqrt()
            });
            step(k).abs() >= SHALLOW * chords.fold(0.0, f64::max)
        });
        common && rises && shallow
    })
}

/// The range of parameters that each site represents.
fn weights<T: Real>(sites: &[T], closed: bool) -> Vec<T> {
    let n = sites.len();
    (0..n)
        .map(|k| {
            let before = match k {
                0 if closed => sites[n - 1] - T::one(),
                0 => sites[0],
                _ => sites[k - 1],
            };
            let after = match k + 1 {
                end if end == n && closed => sites[0] + T::one(),
                end if end == n => sites[n - 1],
                _ => sites[k + 1],
            };
            (after - before) * 0.5
        })
        .collect()
}

/// Factor from a measure by mean spans to one by the unit parameter.
fn unit(measure: Measure, layout: &InterpolationSpace) -> f64 {
    let order = match measure {
        Measure::Second | Measure::Bending => 2.0,
        Measure::Third | Measure::Variation => 3.0,
        // Jumps are lengths already.
        Measure::Jumps | Measure::JumpLengths => return 1.0,
    };
    libm::pow(layout.space.mean_span(), 0.5 - order)
}

impl GridData {
    /// The numbers of sites and control points along u and v.
    fn counts(&self) -> [usize; 2] {
        [self.layouts[0].sites.len(), self.layouts[1].sites.len()]
    }

    /// The number of data along v.
    fn columns(&self) -> usize {
        self.layouts[1].at.len()
    }

    /// The datum that a site is.
    fn owner(&self, a: usize, b: usize) -> Option<usize> {
        Some(self.layouts[0].owner[a]? * self.columns() + self.layouts[1].owner[b]?)
    }

    /// Applies what holds for the lines along u, then for those along v, `n` numbers to a row.
    fn both<T: Real>(
        grid: &[Vec3<T>],
        n: usize,
        each: impl Fn(usize, &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError>,
    ) -> Result<Vec<Vec3<T>>, FairError> {
        let m = grid.len() / n;
        let lines: Vec<Vec<Vec3<T>>> = (0..n)
            .map(|j| each(0, &(0..m).map(|i| grid[i * n + j]).collect::<Vec<_>>()))
            .collect::<Result<_, _>>()?;
        let rows = lines.first().map_or(0, Vec::len);
        let mut out = Vec::new();
        for i in 0..rows {
            out.extend(each(1, &lines.iter().map(|line| line[i]).collect::<Vec<_>>())?);
        }
        Ok(out)
    }

    /// The sites of data.
    fn sites<T: Real>(&self, points: &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError> {
        Self::both(points, self.columns(), |d, line| Ok(self.layouts[d].data(line)))
    }

    /// The control points of the surface that takes these values at the sites.
    fn through<T: Real>(&self, values: &[Vec3<T>]) -> Result<Vec<Vec3<T>>, FairError> {
        Self::both(values, self.counts()[1], |d, line| self.layouts[d].through(line))
    }

    /// The surface's values at the sites over its control points.
    fn rows(&self) -> SparseRows {
        let [u, v] = &self.layouts;
        let (su, sv) = (u.rows.len(), v.rows.len());
        let mut rows = SparseRows::new();
        for a in 0..su {
            for b in 0..sv {
                rows.push(product(u.rows.row(a), v.rows.row(b), v.space.count(), 1.0));
            }
        }
        rows
    }

    /// The measure over the curves through the sites in both directions.
    fn measure(&self, measure: Measure) -> Result<SparseRows, FairError> {
        let [u, v] = &self.layouts;
        let nv = v.space.count();
        let mut rows = SparseRows::new();
        let squares = measure.norm() == RowNorm::Square;
        let scale = |w: f64| if squares { w.sqrt() } else { w };
        let (mu, mv) = (measure.rows(&u.space)?, measure.rows(&v.space)?);
        let (wu, wv) =
            (weights(&u.sites, u.space.is_closed()), weights(&v.sites, v.space.is_closed()));
        let (cu, cv) = (unit(measure, u), unit(measure, v));
        for k in 0..mu.len() {
            for (b, &w) in wv.iter().enumerate() {
                rows.push(product(mu.row(k), v.rows.row(b), nv, cu * scale(w)));
            }
        }
        for (a, &w) in wu.iter().enumerate() {
            for k in 0..mv.len() {
                rows.push(product(u.rows.row(a), mv.row(k), nv, cv * scale(w)));
            }
        }
        Ok(rows)
    }

    /// Control points that stay: corners, rims and breaks.
    fn frozen(&self) -> Vec<bool> {
        let [u, v] = &self.layouts;
        let (nu, nv) = (u.space.count(), v.space.count());
        let kept = |layout: &InterpolationSpace, ends: [EndContinuity; 2]| {
            let n = layout.space.count();
            let rows =
                |end: EndContinuity| if layout.space.is_closed() { 0 } else { end.kept().min(n) };
            let mut all: Vec<bool> =
                (0..n).map(|k| k < rows(ends[0]) || k + rows(ends[1]) >= n).collect();
            for &m in &layout.marks {
                all[layout.control_of(m)] = true;
            }
            all
        };
        let (ku, kv) = (kept(u, self.rims[0]), kept(v, self.rims[1]));
        let open = !u.space.is_closed() && !v.space.is_closed();
        let rim = |k: usize, n: usize| k == 0 || k + 1 == n;
        (0..nu * nv)
            .map(|c| {
                let (i, j) = (c / nv, c % nv);
                ku[i] || kv[j] || open && rim(i, nu) && rim(j, nv)
            })
            .collect()
    }

    /// A net with these control points, for conditions and reports.
    ///
    /// # Errors
    /// As [`Network::net`].
    pub fn network(&self, points: Vec<Vec3<f64>>) -> Result<Network, FairError> {
        let spaces = [self.layouts[0].space.clone(), self.layouts[1].space.clone()];
        // Closed curves are refused without a tolerance; none is smaller than that of the data.
        let largest = self.limit.radii.iter().copied().fold(0.0, f64::max);
        let limit = Limit::ball(points.len(), largest)?;
        Network::net(spaces, points, None, limit)
    }

    /// The control points of the surface through the data.
    ///
    /// # Errors
    /// [`FairError::Singular`].
    pub fn original(&self) -> Result<Vec<Vec3<f64>>, FairError> {
        self.through(&self.sites(&self.points)?)
    }

    /// Tolerances of the sites; those that are no data have the largest.
    fn radii(&self) -> Vec<f64> {
        let [su, sv] = self.counts();
        let largest = self.limit.radii.iter().copied().fold(0.0, f64::max);
        let of = |k: usize| self.owner(k / sv, k % sv).map_or(largest, |i| self.limit.radii[i]);
        (0..su * sv).map(of).collect()
    }

    fn parts<'a>(
        &self,
        measure: Measure,
        conditions: &[Condition],
        accuracy: f64,
        original: &'a [Vec3<f64>],
        limit: &'a Limit,
    ) -> Result<Parts<'a>, FairError> {
        let radii = self.radii();
        let mut frozen = self.frozen();
        let all = self.rows();
        let (mut rows, mut own_radii) = (SparseRows::new(), Vec::new());
        let mut held = Vec::new();
        for (k, &radius) in radii.iter().enumerate() {
            let (columns, factors) = all.row(k);
            if columns.iter().all(|&c| frozen[c as usize]) {
                continue;
            }
            if radius > 0.0 {
                rows.push(columns.iter().map(|&c| c as usize).zip(factors.iter().copied()));
                own_radii.push(radius);
            } else if let &[c] = columns {
                frozen[c as usize] = true;
            } else {
                // A datum without tolerance stays on the surface.
                for axis in crate::curve::condition::AXES {
                    let entries = columns.iter().zip(factors);
                    let entries = entries.map(|(&c, &f)| (c as usize, axis * f)).collect();
                    let mut condition = Condition { entries, value: 0.0 };
                    condition.value = condition.at(original);
                    held.push(condition);
                }
            }
        }
        let own = held.len();
        held.extend(conditions.iter().cloned());
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let reach = if largest.is_finite() {
            let each = |layout: &InterpolationSpace| layout.reach(&vec![1.0; layout.sites.len()]);
            let (ru, rv) = (each(&self.layouts[0])?, each(&self.layouts[1])?);
            ru.iter().flat_map(|a| rv.iter().map(move |b| a * b * largest)).collect()
        } else {
            vec![f64::INFINITY; original.len()]
        };
        Ok(Parts {
            held: &[],
            ties: Ties::default(),
            points: original,
            relative: original.to_vec(),
            centred: false,
            limit,
            measure: self.measure(measure)?,
            norm: measure.norm(),
            frozen,
            conditions: held,
            rigid: 0,
            own,
            bounded: Bounded::Data(DataLimits {
                rows,
                radii: own_radii,
                offsets: Vec::new(),
                reach,
            }),
            halves: Vec::new(),
            pull: None,
            accuracy,
            begin: Vec::new(),
        })
    }

    /// The sites that pull, with their data.
    fn pulling(&self, parts: &Parts<'_>) -> Vec<(usize, usize)> {
        let all = self.rows();
        let sv = self.counts()[1];
        (0..all.len())
            .filter_map(|k| Some((k, self.owner(k / sv, k % sv)?)))
            .filter(|&(k, i)| {
                let radius = self.limit.radii[i];
                let free = all.row(k).0.iter().any(|&c| !parts.frozen[c as usize]);
                free && radius > 0.0 && radius.is_finite()
            })
            .collect()
    }

    fn pull(&self, pulling: &[(usize, usize)]) -> SparseRows {
        let all = self.rows();
        let mut pull = SparseRows::new();
        for &(k, i) in pulling {
            let (columns, factors) = all.row(k);
            let radius = self.limit.radii[i];
            pull.push(columns.iter().map(|&c| c as usize).zip(factors.iter().map(|f| f / radius)));
        }
        pull
    }

    /// True if all lines of the grid are exact between breaks.
    fn exact(&self) -> bool {
        let n = self.columns();
        let m = self.points.len() / n;
        let along = |d: usize, line: Vec<Vec3<f64>>| {
            let layout = &self.layouts[d];
            between_breaks(&line, &layout.break_data(), layout.space.is_closed())
        };
        let columns = (0..n).map(|j| (0, (0..m).map(|i| self.points[i * n + j]).collect()));
        let rows = (0..m).map(|i| (1, self.points[i * n..(i + 1) * n].to_vec()));
        all_exact(columns.chain(rows).flat_map(|(d, line)| along(d, line)))
    }

    fn found(
        &self,
        goal: Goal,
        conditioned: bool,
        parts: &mut Parts<'_>,
        pull: &SparseRows,
    ) -> Result<GoalOptimum, FairError> {
        let (rows, norm, original) = (parts.measure.clone(), parts.norm, parts.points);
        let still = self.limit.radii.iter().all(|&r| r == 0.0) || parts.frozen.iter().all(|&f| f);
        let fair = matches!(goal, Goal::Near(_)) && self.exact();
        if !conditioned && (still || fair) {
            let value = crate::measure::value(&rows, norm, original);
            return Ok(GoalOptimum::unmoved(original, value, still));
        }
        let path = RegularizationPath {
            energy: |points: &[Vec3<f64>]| crate::measure::value(&rows, norm, points),
            squares: |points: &[Vec3<f64>]| {
                let moved: Vec<_> = points.iter().zip(original).map(|(p, q)| *p - *q).collect();
                pull.sum_sq(&moved)
            },
            count: pull.len(),
            noise: rounding(&rows, norm, original),
            original,
            adapts: Adaptation::Surface,
            known: None,
            moves: None,
            nearest: None,
            fairest: None,
        };
        // The measure of closed lines is never small, so that it does not show what a move is worth.
        let closed = self.layouts.iter().any(|layout| layout.space.is_closed());
        let goal = match goal {
            Goal::Near(share) if closed => Goal::Budget(share),
            other => other,
        };
        path.follow(goal, norm, conditioned, parts, pull)
    }

    /// The distance of each datum from a surface at its parameters.
    fn residuals(&self, control: &[Vec3<f64>]) -> Vec<f64> {
        let (rows, sv) = (self.rows(), self.counts()[1]);
        let mut out = vec![0.0; self.points.len()];
        for k in 0..rows.len() {
            if let Some(i) = self.owner(k / sv, k % sv) {
                out[i] = f64::max(out[i], (rows.apply(k, control) - self.points[i]).norm());
            }
        }
        out
    }

    fn check(&self) -> Result<(), FairError> {
        crate::error::check_finite(&self.points)?;
        let expected = self.layouts[0].at.len() * self.columns();
        for (what, actual) in
            [("points", self.points.len()), ("tolerances", self.limit.radii.len())]
        {
            if actual != expected {
                return Err(FairError::Count { what, expected, actual });
            }
        }
        Ok(())
    }

    fn fit(&self, found: GoalOptimum, original: Vec<Vec3<f64>>, before: f64) -> GridFit {
        GridFit {
            residuals: self.residuals(&found.optimum.points),
            used: found.used,
            fairest_used: found.fairest_used,
            certificate: found.optimum.certificate,
            before,
            iterations: found.optimum.iterations,
            active: found.optimum.active,
            points: found.optimum.points,
            original,
        }
    }
}

/// A row over u times one over v.
fn product<'a>(
    (cu, fu): (&'a [u32], &'a [f64]),
    (cv, fv): (&'a [u32], &'a [f64]),
    nv: usize,
    scale: f64,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    cu.iter().zip(fu).flat_map(move |(&i, &x)| {
        let own = cv.iter().zip(fv);
        own.map(move |(&j, &y)| (i as usize * nv + j as usize, x * y * scale))
    })
}

/// Fairs a grid of data: a goal within the tolerances, under linear conditions on the control
/// points.
///
/// # Errors
/// [`FairError`] when conditions contradict each other, or the goal does not go with the measure.
///
/// # Example
/// ```
/// use moldloft_fair::{EndContinuity, Goal, GridData, InterpolationSpace, Limit, Measure, Motion, ParameterSpacing, fair_grid,
///     grid_parameters};
/// use moldloft_num::Vec3;
/// // A plane at uneven stations, with one reading off by 0.01.
/// let (xs, zs) = ([0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 4.5], [0.0, 0.1, 0.3, 1.0, 2.0, 3.0]);
/// let mut points: Vec<_> =
///     xs.iter().flat_map(|&x| zs.map(|z| Vec3::of(x, 0.2 * x + 0.1 * z, z))).collect();
/// points[20].y += 0.01;
/// let at = grid_parameters(&points, [7, 6], [ParameterSpacing::Chord; 2], [false; 2], (Motion::Ball, &[])).unwrap();
/// let data = GridData {
///     limit: Limit::ball(points.len(), 0.02).unwrap(),
///     layouts: at.map(|at| InterpolationSpace::new(3, &at, &[], false).unwrap()),
///     rims: [[EndContinuity::Free; 2]; 2],
///     points,
/// };
/// let faired = fair_grid(&data, Measure::Variation, Goal::Fairest, &[], 1e-9).unwrap();
/// assert!(faired.residuals.iter().all(|&r| r <= 0.02));
/// assert!(faired.certificate.value < 1e-4 * faired.before);
/// ```
pub fn fair_grid(
    data: &GridData,
    measure: Measure,
    goal: Goal,
    conditions: &[Condition],
    accuracy: f64,
) -> Result<GridFit, FairError> {
    data.check()?;
    let original = data.original()?;
    let limit = Limit { motion: data.limit.motion, radii: vec![f64::INFINITY; original.len()] };
    let mut parts = data.parts(measure, conditions, accuracy, &original, &limit)?;
    let before = crate::measure::value(&parts.measure, parts.norm, &original);
    let pull = data.pull(&data.pulling(&parts));
    let found = data.found(goal, !conditions.is_empty(), &mut parts, &pull)?;
    drop(parts);
    Ok(data.fit(found, original, before))
}

/// A faired surface whose control points and knots carry derivatives.
#[derive(Clone, Debug)]
pub struct MovingGrid<T> {
    /// The control points.
    pub points: Vec<Vec3<T>>,
    /// The knots along u and v.
    pub knots: [Vec<T>; 2],
}

/// Rows over u times rows over v, with the weights of either side.
fn products<T: Real>(u: &[Vec<(usize, T)>], v: &[Vec<(usize, T)>], nv: usize) -> MovingRows<T> {
    let one = |a: &Vec<(usize, T)>, b: &Vec<(usize, T)>| {
        a.iter().flat_map(|&(i, x)| b.iter().map(move |&(j, y)| (i * nv + j, x * y))).collect()
    };
    MovingRows { rows: u.iter().flat_map(|a| v.iter().map(move |b| one(a, b))).collect() }
}

/// As `fair_grid`, for data, tolerances (one per datum) and parameters that carry derivatives,
/// whose real parts are those of the data; see [`crate::fair_data_with`]. The only conditions are
/// those of the rims.
///
/// # Errors
/// As [`fair_grid`]; [`FairError::NoDerivative`] for the goal `nearest`, and for sums of lengths.
pub fn fair_grid_with<T: Real>(
    data: &GridData,
    measure: Measure,
    goal: Goal,
    accuracy: f64,
    points: &[Vec3<T>],
    tolerances: &[T],
    at: [&[T]; 2],
) -> Result<(MovingGrid<T>, GridFit), FairError> {
    data.check()?;
    let original = data.original()?;
    let limit = Limit { motion: data.limit.motion, radii: vec![f64::INFINITY; original.len()] };
    let mut parts = data.parts(measure, &[], accuracy, &original, &limit)?;
    let before = crate::measure::value(&parts.measure, parts.norm, &original);
    let pulling = data.pulling(&parts);
    let pull = data.pull(&pulling);
    let found = data.found(goal, false, &mut parts, &pull)?;
    let [u, v] = &data.layouts;
    let ((su, ku), (sv, kv)) = (u.moving(at[0]), v.moving(at[1]));
    let mut plain =
        points.iter().flat_map(|p| p.to_array()).chain(at.iter().flat_map(|a| a.iter().copied()));
    let constant = plain.all(|x| x.is_constant()) && tolerances.iter().all(|t| t.is_constant());
    if constant {
        let points = found.optimum.points.iter().map(|&p| Vec3::lifted(p)).collect();
        let grid = MovingGrid { points, knots: [ku, kv] };
        drop(parts);
        return Ok((grid, data.fit(found, original, before)));
    }
    let spaces =
        [MovingSpace { space: &u.space, knots: &ku }, MovingSpace { space: &v.space, knots: &kv }];
    let bases = [
        su.iter().map(|&t| spaces[0].value(t)).collect::<Vec<_>>(),
        sv.iter().map(|&t| spaces[1].value(t)).collect::<Vec<_>>(),
    ];
    let wanted = GridData::both(points, data.columns(), |d, line| {
        Ok(data.layouts[d].moving_data(line, at[d], [&su, &sv][d]))
    })?;
    let sites = MovingSites { values: products(&bases[0], &bases[1], v.space.count()), wanted };
    let start = sites.through(&original, &original, |values| data.through(values))?;
    if found.share == 0.0 {
        drop(parts);
        let grid = MovingGrid { points: start, knots: [ku, kv] };
        return Ok((grid, data.fit(found, original, before)));
    }
    if !ku.iter().chain(&kv).all(|k| k.is_constant()) {
        check_single(&found, before)?;
    }
    check_unique(&mut parts, &found, &pull)?;
    if parts.norm != RowNorm::Square {
        return Err(FairError::NoDerivative(
            "no derivatives are available for a sum of lengths with moving knots: use another \
            measure",
        ));
    }
    let rows = data.moving_measure(measure, &spaces, [&su, &sv], &bases)?;
    let (limited, limits) = data.moving_limits(&parts, tolerances);
    let moving = MovingGridData {
        data,
        original: &original,
        sites,
        start,
        rows,
        pulling: &pulling,
        limited,
        limits,
        tolerances,
    };
    let budget = match goal {
        Goal::Near(own) if found.between => moving.budget(own, &found, &mut parts, &pull)?,
        _ => T::zero(),
    };
    let weight = found.weight;
    parts.pull = (weight > 0.0).then(|| pull.clone().scaled(weight.sqrt()));
    let solved = parts.whole()?;
    let points =
        moved(&parts, &solved, goal, &found, &pull, moving.variation(&solved, weight, budget)?)?;
    drop((solved, parts, moving));
    Ok((MovingGrid { points, knots: [ku, kv] }, data.fit(found, original, before)))
}

/// Data of a grid that carry derivatives.
struct MovingGridData<'a, T: Real> {
    data: &'a GridData,
    original: &'a [Vec3<f64>],
    sites: MovingSites<T>,
    /// The original as it changes.
    start: Vec<Vec3<T>>,
    /// The rows of the measure.
    rows: MovingRows<T>,
    /// Sites that pull, each with its datum.
    pulling: &'a [(usize, usize)],
    /// Sites with limits, and their tolerances.
    limited: Vec<usize>,
    limits: Vec<T>,
    tolerances: &'a [T],
}

impl<T: Real> MovingGridData<'_, T> {
    /// Changes of a solution where data pull with a weight.
    fn variation(
        &self,
        solved: &Solved,
        weight: f64,
        budget: T,
    ) -> Result<GoalVariation<'_, T>, FairError> {
        let data = self.data;
        let control = &solved.optimum.points;
        let (radii, all, columns) = (data.radii(), data.rows(), data.counts()[1]);
        let mut forces = self.rows.forces(control);
        // Forces at the sites act through rows that move.
        let away: Vec<Vec3<f64>> =
            control.iter().zip(self.original).map(|(p, q)| *p - *q).collect();
        for (&k, force) in self.limited.iter().zip(&solved.forces()) {
            let mut force = *force;
            if data.owner(k / columns, k % columns).is_some() {
                force += all.apply(k, &away) * (weight / (radii[k] * radii[k]));
            }
            self.sites.act(k, force, &mut forces);
        }
        Ok(GoalVariation {
            originals: self.sites.through(control, self.original, |values| data.through(values))?,
            tolerances: &self.limits,
            pulled: self.pulling.iter().map(|&(_, i)| self.tolerances[i]).collect(),
            targets: &[],
            forces,
            rows: &self.rows,
            bends: &[],
            budget,
            start: &self.start,
        })
    }

    /// The budget of the goal `near`, which changes with the squares of the fairest; `own` is that
    /// of the goal.
    fn budget(
        &self,
        own: f64,
        found: &GoalOptimum,
        parts: &mut Parts<'_>,
        pull: &SparseRows,
    ) -> Result<T, FairError> {
        if found.share < 1.0 {
            return Err(FairError::NoDerivative(
                "the budget of this surface and its use both depend on the fairest surface, \
                so no derivatives are available: use the goal \"budget\"",
            ));
        }
        parts.pull = None;
        let fairest = parts.whole()?;
        let optimum = fairest.optimum.clone();
        let whole = GoalOptimum { share: 1.0, weight: 0.0, optimum, ..found.clone() };
        check_decided(&whole, &fairest)?;
        check_unique(parts, &whole, pull)?;
        let still = self.variation(&fairest, 0.0, T::zero())?;
        let at = moved(parts, &fairest, Goal::Fairest, &whole, pull, still)?;
        let mean = self.pulling.len() as f64 / 3.0;
        let used = self.pulling.iter().fold(T::zero(), |sum, &(k, i)| {
            let off = self.sites.values.apply(k, &at) - self.sites.wanted[k];
            sum + off.dot(off) / (self.tolerances[i] * self.tolerances[i])
        });
        Ok(tightened(own, used / mean, self.pulling.len()) * mean)
    }
}

impl GridData {
    /// Sites with limits, and their tolerances; those that are no data have the largest.
    fn moving_limits<T: Real>(&self, parts: &Parts<'_>, tolerances: &[T]) -> (Vec<usize>, Vec<T>) {
        let (radii, all, columns) = (self.radii(), self.rows(), self.counts()[1]);
        let free = |k: &usize| all.row(*k).0.iter().any(|&c| !parts.frozen[c as usize]);
        let limited: Vec<usize> = (0..radii.len())
            .filter(|k| radii[*k] > 0.0 && radii[*k].is_finite() && free(k))
            .collect();
        let largest = tolerances.iter().copied().reduce(|a, b| if b.re() > a.re() { b } else { a });
        let largest = largest.unwrap_or_else(T::zero);
        let of =
            |k: &usize| self.owner(k / columns, k % columns).map_or(largest, |i| tolerances[i]);
        let limits = limited.iter().map(of).collect();
        (limited, limits)
    }

    /// The measure's rows as knots, sites and weights move; `bases` are the values at the sites.
    fn moving_measure<T: Real>(
        &self,
        measure: Measure,
        spaces: &[MovingSpace<'_, T>; 2],
        [su, sv]: [&[T]; 2],
        bases: &[Vec<Vec<(usize, T)>>; 2],
    ) -> Result<MovingRows<T>, FairError> {
        let scaled = |rows: &[Vec<(usize, T)>], by: &[T]| -> Vec<Vec<(usize, T)>> {
            let one = |(row, w): (&Vec<(usize, T)>, &T)| {
                let root = w.sqrt();
                row.iter().map(|&(c, x)| (c, x * root)).collect()
            };
            rows.iter().zip(by).map(one).collect()
        };
        let times = |rows: MovingRows<T>, by: f64| -> Vec<Vec<(usize, T)>> {
            let one = |r: Vec<(usize, T)>| r.into_iter().map(|(c, x)| (c, x * by)).collect();
            rows.rows.into_iter().map(one).collect()
        };
        let [u, v] = &self.layouts;
        let nv = v.space.count();
        let (wu, wv) = (weights(su, u.space.is_closed()), weights(sv, v.space.is_closed()));
        let mu = times(spaces[0].measure(measure)?, unit(measure, u));
        let mv = times(spaces[1].measure(measure)?, unit(measure, v));
        let mut rows = products(&mu, &scaled(&bases[1], &wv), nv);
        rows.rows.extend(products(&scaled(&bases[0], &wu), &mv, nv).rows);
        Ok(rows)
    }
}
