//! Curves that share points: control nets of surfaces, and hulls of stations, waterlines and
//! buttocks.

use crate::error::check_finite;
use crate::net::seam::SeamCondition;
use crate::net::shapes::{NetworkCondition, one_way};
use crate::net::strand::NetworkCurve;
use crate::optimum::ties::Ties;
use crate::optimum::{Bounded, Optimum, Parts};
use crate::{Bound, Condition, EndContinuity, FairError, Job, Limit, Measure, Space, SparseRows};
use moldloft_num::{Real, Surface, Vec3};
use moldloft_spline::BSplineSurface;

/// Curves with common points: a shared point moves for all its curves at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// The original points.
    pub points: Vec<Vec3<f64>>,
    /// Limits on the moves of the points, across all passes.
    pub limit: Limit,
    /// The curves, in the order of passes.
    pub strands: Vec<NetworkCurve>,
    /// Points that do not move.
    pub kept: Vec<usize>,
    /// Scope of the limits of goals: the points, or the whole curves through the points.
    pub bound: Bound,
    /// Its conditions.
    pub(super) conditions: Vec<NetworkCondition>,
    /// The circular arcs among them: the curve, and the places of its points.
    pub(super) arcs: Vec<(usize, [usize; 2])>,
    /// Directions in which single points do not move.
    pub(super) held: Vec<(usize, Vec3<f64>)>,
    /// The one direction in which the points of each curve move, if there is one.
    pub(super) ways: Vec<Option<Vec3<f64>>>,
    /// The spaces of a tensor-product net, whose point (i, j) is at `i * count_v + j`.
    net: Option<[Space; 2]>,
    weights: Option<Vec<f64>>,
    /// The nets of joined surfaces.
    pub(crate) patches: Vec<PlacedNet>,
    /// Conditions across their seams, and their dependence on the given points.
    pub(crate) seams: Vec<Condition>,
    pub(crate) across: Vec<SeamCondition>,
}

/// A net within a network, with the places of its points there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlacedNet {
    pub net: Network,
    pub places: Vec<usize>,
}

impl Network {
    /// A network of curves.
    ///
    /// # Errors
    /// [`FairError`] when a curve refers to points that do not exist, or as for [`Job::check`].
    pub fn new(
        points: Vec<Vec3<f64>>,
        strands: Vec<NetworkCurve>,
        limit: Limit,
    ) -> Result<Self, FairError> {
        let network = Self::of(points, limit, strands);
        network.check()?;
        Ok(network)
    }

    /// The network with points that do not move in certain directions: an offset moves along its
    /// own axis only, a sheer in two.
    ///
    /// # Errors
    /// [`FairError::Mark`] when there is no such point.
    pub fn with_held(mut self, held: Vec<(usize, Vec3<f64>)>) -> Result<Self, FairError> {
        let count = self.points.len();
        if let Some(&(index, _)) = held.iter().find(|(i, _)| *i >= count) {
            return Err(FairError::Mark { index, count });
        }
        self.held = held;
        let way = |strand: &NetworkCurve| one_way(self.limit.motion, &self.held, &strand.points);
        self.ways = self.strands.iter().map(way).collect();
        Ok(self)
    }

    fn of(points: Vec<Vec3<f64>>, limit: Limit, strands: Vec<NetworkCurve>) -> Self {
        let (kept, conditions, arcs, held, ways, patches, seams, across) = Default::default();
        let bound = Bound::ControlPoints;
        Self {
            points,
            limit,
            strands,
            kept,
            bound,
            conditions,
            arcs,
            held,
            ways,
            net: None,
            weights: None,
            patches,
            seams,
            across,
        }
    }

    /// The control net of a surface with point (i, j) at `i * v.count() + j`. Passes fair the
    /// curves of constant v first, as in the report of 1991, then those of constant u. Each curve
    /// keeps two points at open ends; the joint optimum keeps two by two points at each of the four
    /// corners of open directions.
    ///
    /// # Errors
    /// As [`Network::new`].
    pub fn net(
        spaces: [Space; 2],
        points: Vec<Vec3<f64>>,
        weights: Option<Vec<f64>>,
        limit: Limit,
    ) -> Result<Self, FairError> {
        let [nu, nv] = [spaces[0].count(), spaces[1].count()];
        for (what, actual) in [
            ("control points", points.len()),
            ("weights", weights.as_ref().map_or(nu * nv, Vec::len)),
        ] {
            if actual != nu * nv {
                return Err(FairError::Count { what, expected: nu * nv, actual });
            }
        }
        let strand = |space: &Space, own: Vec<usize>| NetworkCurve {
            space: space.clone(),
            weights: weights.as_ref().map(|w| own.iter().map(|&i| w[i]).collect()),
            points: own,
            marks: Vec::new(),
            runs: Vec::new(),
            ends: [EndContinuity::Points(2); 2],
            at: None,
        };
        let along_u = (0..nv).map(|j| strand(&spaces[0], (0..nu).map(|i| i * nv + j).collect()));
        let along_v = (0..nu).map(|i| strand(&spaces[1], (0..nv).map(|j| i * nv + j).collect()));
        let strands = along_u.chain(along_v).collect();
        let rim = |k: usize, n: usize| k < 2 || k + 2 >= n;
        let corners = !spaces[0].is_closed() && !spaces[1].is_closed();
        let kept = (0..nu * nv).filter(|k| corners && rim(k / nv, nu) && rim(k % nv, nv)).collect();
        let plain = Self::of(points, limit, strands);
        let network = Self { kept, net: Some(spaces), weights, ..plain };
        network.check()?;
        Ok(network)
    }

    /// The net with intended breaks: knuckle lines along whole rows of points, at these indices
    /// along u (each a curve of constant u) and along v. Their points do not move, and nothing is
    /// smoothed across them.
    ///
    /// # Errors
    /// [`FairError::Mark`] when there is no such row, or the network is not a net.
    pub fn with_breaks(mut self, along_u: &[usize], along_v: &[usize]) -> Result<Self, FairError> {
        let [nu, nv] = self.net.as_ref().map_or([0, 0], |[u, v]| [u.count(), v.count()]);
        for (breaks, count) in [(along_u, nu), (along_v, nv)] {
            if let Some(&index) = breaks.iter().find(|&&b| b >= count) {
                return Err(FairError::Mark { index, count });
            }
        }
        // Curves along u come first.
        for (k, strand) in self.strands.iter_mut().enumerate() {
            strand.marks.extend(if k < nv { along_u } else { along_v });
        }
        // Those along the knuckle stay fixed too, whole.
        for (k, strand) in self.strands.iter().enumerate() {
            let own = if k < nv { along_v.contains(&k) } else { along_u.contains(&(k - nv)) };
            if own {
                self.kept.extend(&strand.points);
            }
        }
        self.kept.sort_unstable();
        self.kept.dedup();
        Ok(self)
    }

    /// The net with rims that preserve continuity with neighbours: at both ends of u, then of v. On
    /// clamped knots the position is one row of points, tangents are two and curvature three; these
    /// rows do not move, neither in the joint optimum nor in passes. A closed direction has no
    /// rims.
    ///
    /// # Errors
    /// [`FairError::Count`] when the network is not a net.
    pub fn with_rims(mut self, rims: [[EndContinuity; 2]; 2]) -> Result<Self, FairError> {
        let Some([su, sv]) = &self.net else {
            return Err(FairError::Count { what: "directions of a net", expected: 2, actual: 0 });
        };
        let (nu, nv) = (su.count(), sv.count());
        let rows = |space: &Space, [low, high]: [EndContinuity; 2]| {
            let of = |end: EndContinuity| end.points(space.is_clamped(), space.degree());
            let some = if space.is_closed() { [0, 0] } else { [of(low), of(high)] };
            some.map(|k| k.min(space.count()))
        };
        let ([u0, u1], [v0, v1]) = (rows(su, rims[0]), rows(sv, rims[1]));
        let still = |i: usize, j: usize| i < u0 || i >= nu - u1 || j < v0 || j >= nv - v1;
        self.kept.extend((0..nu * nv).filter(|k| still(k / nv, k % nv)));
        self.kept.sort_unstable();
        self.kept.dedup();
        Ok(self)
    }

    /// The spaces of a net and its weights.
    pub(crate) fn net_parts(&self) -> Option<(&[Space; 2], Option<&[f64]>)> {
        self.net.as_ref().map(|spaces| (spaces, self.weights.as_deref()))
    }

    /// Refuses invalid networks.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), FairError> {
        check_finite(&self.points)?;
        let count = self.points.len();
        if self.limit.radii.len() != count {
            let (expected, actual) = (count, self.limit.radii.len());
            return Err(FairError::Count { what: "tolerances", expected, actual });
        }
        let all = self.strands.iter().flat_map(|s| &s.points).chain(&self.kept);
        if let Some(&index) = all.into_iter().find(|&&i| i >= count) {
            return Err(FairError::Mark { index, count });
        }
        (0..self.strands.len()).try_for_each(|k| {
            let strand = &self.strands[k];
            let (expected, actual) = (strand.space.count(), strand.points.len());
            if expected != actual {
                return Err(FairError::Count { what: "points of a curve", expected, actual });
            }
            if let Some(at) = &strand.at {
                let (expected, actual) = (strand.points.len(), at.len());
                if expected != actual {
                    return Err(FairError::Count { what: "parameters", expected, actual });
                }
                if let Some(k) = (1..actual).find(|&k| at[k].is_nan() || at[k] <= at[k - 1]) {
                    return Err(FairError::Unsorted { index: k });
                }
            }
            self.job(k, &self.points).check()
        })
    }

    /// Curve `k` as a job of its own, at these points.
    pub(super) fn job(&self, k: usize, points: &[Vec3<f64>]) -> Job {
        let strand = &self.strands[k];
        let pick = |i: &usize| points[*i];
        Job {
            space: strand.space.clone(),
            points: strand.points.iter().map(pick).collect(),
            weights: strand.weights.clone(),
            limit: Limit {
                motion: self.limit.motion,
                radii: strand.points.iter().map(|&i| self.limit.radii[i]).collect(),
            },
            marks: strand.marks.clone(),
            ends: strand.ends,
        }
    }

    /// The value of a measure over some of the curves.
    ///
    /// # Errors
    /// [`FairError::Degree`].
    pub fn value(
        &self,
        measure: Measure,
        strands: std::ops::Range<usize>,
        points: &[Vec3<f64>],
    ) -> Result<f64, FairError> {
        let origin = self.origin();
        let mut sum = 0.0;
        for k in strands {
            if self.strands[k].at.is_some() {
                let own = self.own_rows(k, measure)?;
                sum += crate::measure::value(&own, measure.norm(), points);
                continue;
            }
            let job = self.job(k, points);
            let relative: Vec<_> = job.points.iter().map(|&p| p - origin).collect();
            sum += crate::measure::value(&job.measure_rows(measure)?, measure.norm(), &relative);
        }
        Ok(sum)
    }

    /// The rows of a measure over all curves.
    pub(super) fn rows(&self, measure: Measure) -> Result<SparseRows, FairError> {
        let mut all = SparseRows::new();
        for k in 0..self.strands.len() {
            all = all.joined(&self.own_rows(k, measure)?);
        }
        Ok(all)
    }

    /// The rows of a measure over the points of curve `k`.
    pub(super) fn own_rows(&self, k: usize, measure: Measure) -> Result<SparseRows, FairError> {
        let strand = &self.strands[k];
        let own = &strand.points;
        let mut all = SparseRows::new();
        if let Some(at) = &strand.at {
            for row in strand.divided(measure, at, &self.arcs_of(k)) {
                all.push(row.into_iter().map(|(c, f)| (own[c], f)));
            }
            return Ok(all);
        }
        let rows = self.job(k, &self.points).measure_rows(measure)?;
        for r in 0..rows.len() {
            let (c, f) = rows.row(r);
            all.push(c.iter().map(|&c| own[c as usize]).zip(f.iter().copied()));
        }
        Ok(all)
    }

    /// True for points that do not move in the joint optimum.
    pub(super) fn frozen(&self) -> Vec<bool> {
        let mut frozen: Vec<bool> = self.limit.radii.iter().map(|&r| r == 0.0).collect();
        for &i in &self.kept {
            frozen[i] = true;
        }
        // A knuckle stays, but for one along which another curve runs on.
        let mut smooth = vec![false; frozen.len()];
        for strand in self.strands.iter().filter(|s| s.at.is_some()) {
            let runs_on = |c: &usize| !strand.marks.contains(c);
            (0..strand.points.len()).filter(runs_on).for_each(|c| smooth[strand.points[c]] = true);
        }
        let marked = self.strands.iter().flat_map(|s| s.marks.iter().map(|&m| s.points[m]));
        marked.filter(|&i| !smooth[i]).for_each(|i| frozen[i] = true);
        frozen
    }

    /// The point that measures refer to: the mean of the original points when there are weights,
    /// so that results move with the network.
    pub(super) fn origin(&self) -> Vec3<f64> {
        if self.strands.iter().all(|s| s.weights.is_none()) {
            return Vec3::zero();
        }
        let sum = self.points.iter().fold(Vec3::zero(), |s, &p| s + p);
        sum * (1.0 / self.points.len() as f64)
    }

    /// Points as measures see them.
    pub(super) fn relative(&self, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let origin = self.origin();
        points.iter().map(|&p| p - origin).collect()
    }

    /// The Bézier points of the net's displacement and how far control points can move under them.
    fn bezier(&self) -> Option<(SparseRows, Vec<f64>)> {
        if !self.patches.is_empty() {
            return self.patches_bezier();
        }
        let [su, sv] = self.net.as_ref()?;
        let (bu, bv, nv) = (su.bezier(None), sv.bezier(None), sv.count());
        let mut rows = SparseRows::new();
        for a in 0..bu.len() {
            let (cu, fu) = bu.row(a);
            for b in 0..bv.len() {
                let (cv, fv) = bv.row(b);
                let mut entries = Vec::with_capacity(cu.len() * cv.len());
                for (&i, &x) in cu.iter().zip(fu) {
                    for (&j, &y) in cv.iter().zip(fv) {
                        let at = i as usize * nv + j as usize;
                        entries.push((at, x * y * self.weights.as_ref().map_or(1.0, |w| w[at])));
                    }
                }
                if self.weights.is_some() {
                    let total: f64 = entries.iter().map(|e| e.1).sum();
                    entries.iter_mut().for_each(|e| e.1 /= total);
                }
                rows.push(entries);
            }
        }
        // With weights the inverse's norm grows at most by their ratio.
        let spread = self.weights.as_ref().map_or(1.0, |w| {
            let (low, high) =
                w.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &x| (l.min(x), h.max(x)));
            high / low
        });
        let (ru, rv) = (su.reach(None), sv.reach(None));
        let reach = ru.iter().flat_map(|a| rv.iter().map(move |b| a * b * spread)).collect();
        Some((rows, reach))
    }

    /// The Bézier points of joined surfaces; a point of several can move as far as the least of them allows.
    fn patches_bezier(&self) -> Option<(SparseRows, Vec<f64>)> {
        let mut all = SparseRows::new();
        let mut reach = vec![f64::INFINITY; self.points.len()];
        for patch in &self.patches {
            let (rows, own) = patch.net.bezier()?;
            for k in 0..rows.len() {
                let (c, f) = rows.row(k);
                all.push(c.iter().map(|&c| patch.places[c as usize]).zip(f.iter().copied()));
            }
            for (&i, r) in patch.places.iter().zip(own) {
                reach[i] = reach[i].min(r);
            }
        }
        Some((all, reach))
    }

    /// A certified bound on the displacement of the surface of a net: the largest Bézier point of
    /// the displacement; for other networks the largest move of a point.
    pub fn certified(&self, points: &[Vec3<f64>]) -> f64 {
        let moved: Vec<_> = points.iter().zip(&self.points).map(|(p, q)| *p - *q).collect();
        match self.bezier() {
            Some((rows, _)) => {
                let largest = (0..rows.len()).map(|k| rows.apply(k, &moved).norm());
                largest.fold(0.0, f64::max) * (1.0 + 32.0 * f64::EPSILON)
            }
            None => moved.iter().map(|m| m.norm()).fold(0.0, f64::max),
        }
    }

    /// All curves faired together: minimises the sum of the measure over all curves within the
    /// limits, with a certificate. `conditions` are over the network's points.
    ///
    /// The factor of a net of m by n points takes about m n min(m, n) numbers.
    ///
    /// # Errors
    /// [`FairError::TooLarge`] beyond that ([`Network::sweeps`] is for such nets); others as for
    /// [`crate::optimum`]. [`Bound::Bezier`] is for nets only.
    pub fn optimum(
        &self,
        measure: Measure,
        bound: Bound,
        conditions: Vec<Condition>,
        accuracy: f64,
    ) -> Result<Optimum, FairError> {
        self.parts(measure, bound, conditions, accuracy)?.solve()
    }

    /// As `optimum`, for numbers that carry derivatives; see [`crate::optimum_with`].
    ///
    /// # Errors
    /// As [`Network::optimum`].
    pub fn optimum_with<T: Real>(
        &self,
        measure: Measure,
        bound: Bound,
        accuracy: f64,
        points: &[Vec3<T>],
        tolerances: &[T],
    ) -> Result<(Vec<Vec3<T>>, Optimum), FairError> {
        let parts = self.parts(measure, bound, Vec::new(), accuracy)?;
        // The ratios of seams follow the points given.
        parts.solve_bent(points, tolerances, &[], &self.bends(points)?)
    }

    pub(super) fn parts(
        &self,
        measure: Measure,
        bound: Bound,
        conditions: Vec<Condition>,
        accuracy: f64,
    ) -> Result<Parts<'_>, FairError> {
        self.check()?;
        let mut conditions = conditions;
        // Last, so that the caller's keep their numbers.
        conditions.extend(self.seams.iter().cloned());
        Ok(Parts {
            points: &self.points,
            relative: self.relative(&self.points),
            centred: self.strands.iter().any(|s| s.weights.is_some()),
            limit: &self.limit,
            measure: self.rows(measure)?,
            norm: measure.norm(),
            frozen: self.frozen(),
            held: &self.held,
            ties: Ties::default(),
            conditions,
            rigid: 0,
            own: 0,
            bounded: match bound {
                Bound::Bezier if self.runs_through_points() => Bounded::Data(self.along_curves()?),
                Bound::Bezier => self
                    .bezier()
                    .map_or(Bounded::ControlPoints, |(rows, reach)| Bounded::Bezier(rows, reach)),
                Bound::ControlPoints => Bounded::ControlPoints,
            },
            halves: Vec::new(),
            pull: None,
            accuracy,
            begin: Vec::new(),
        })
    }

    /// The surface of a net with these control points.
    ///
    /// # Errors
    /// [`FairError::Count`] when there are more or fewer, or the network is not a net.
    pub fn surface(&self, points: &[Vec3<f64>]) -> Result<BSplineSurface<f64>, FairError> {
        let expected = self.points.len();
        let Some([u, v]) = self.net.as_ref().filter(|_| points.len() == expected) else {
            let actual = points.len();
            return Err(FairError::Count { what: "control points of a net", expected, actual });
        };
        let ((ku, pu), (kv, pv)) = (u.knot_vector(), v.knot_vector());
        let places = || pu.iter().flat_map(|&i| pv.iter().map(move |&j| i * v.count() + j));
        let weights = self.weights.as_ref().map(|w| places().map(|k| w[k]).collect());
        let net = places().map(|k| points[k]).collect();
        BSplineSurface::new(ku, kv, net, weights).map_err(|_| FairError::Singular)
    }

    /// The largest displacement of the surface of a net on a grid of about four samples to a span;
    /// for other networks the largest move of a point.
    pub fn sampled(&self, points: &[Vec3<f64>]) -> f64 {
        let moved: Vec<_> = points.iter().zip(&self.points).map(|(p, q)| *p - *q).collect();
        let largest = |all: &[Vec3<f64>]| all.iter().map(|m| m.norm()).fold(0.0, f64::max);
        if !self.patches.is_empty() {
            let each = self.patches.iter().enumerate();
            let each = each.map(|(k, p)| p.net.sampled(&self.sheet(k, points)));
            return each.fold(0.0, f64::max);
        }
        let Some([u, v]) = &self.net else { return largest(&moved) };
        let Ok(surface) = self.surface(&moved) else { return f64::NAN };
        let steps =
            |n: usize| -> Vec<f64> { (0..=4 * n).map(|k| k as f64 / (4 * n) as f64).collect() };
        let (us, vs) = (steps(u.count()), steps(v.count()));
        let mut grid = vec![Vec3::zero(); us.len() * vs.len()];
        surface.grid(&us, &vs, &mut grid, None);
        largest(&grid)
    }
}
