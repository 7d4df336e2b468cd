//! The curves of a network: splines through its points, how far these are apart, and limits that
//! hold all along them.
//!
//! Points that are near each other turn a curve when they move apart, and it then swings away from
//! its original beyond them. Limits between the points are those of the Bézier points of the
//! displacements, of which a curve is a convex combination.

use crate::net::shapes::control_map;
use crate::net::strand::NetworkCurve;
use crate::optimum::{DataLimits, FAR};
use crate::{
    Bound, Deviation, FairError, InterpolationSpace, Job, Motion, Network, ParameterSpacing, Space,
    SparseRows, deviation, interpolate_with_corners,
};
use moldloft_num::Vec3;

/// Displacement of a curve between its points, in tolerances, above which the curve is reported, if
/// the bound is that of the points.
pub const SWING: f64 = 1.5;

/// Number of halvings of the spans, which bring their Bézier points near the curve.
pub(super) const HALVINGS: usize = 2;

/// Rounding of a certified distance, relative.
const CERTIFIED_ROUNDING: f64 = 128.0 * f64::EPSILON;

/// Rounding of that bound, relative.
pub(super) const SWING_SLACK: f64 = 1e-6;

/// A curve of a network before and after fairing, on the same knots.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePair {
    /// The splines.
    pub space: Space,
    /// The control points of the curve through the given points.
    pub before: Vec<Vec3<f64>>,
    /// The control points of the curve through the faired points, at the same parameters.
    pub after: Vec<Vec3<f64>>,
}

impl CurvePair {
    /// The distance between the curves.
    ///
    /// # Errors
    /// As [`Job::new`].
    pub fn deviation(&self) -> Result<Deviation, FairError> {
        let job = Job::new(self.space.clone(), self.before.clone(), 0.0)?;
        let mut deviation = deviation(&job, &self.after);
        let moved: Vec<Vec3<f64>> =
            self.after.iter().zip(&self.before).map(|(p, q)| *p - *q).collect();
        let mut most = 0.0f64;
        each_bezier(&self.space, HALVINGS, |entries| {
            let off = entries.iter().fold(Vec3::zero(), |s, &(c, x)| s + moved[c] * x);
            most = most.max(off.norm());
        });
        deviation.certified = deviation.certified.min(most * (1.0 + CERTIFIED_ROUNDING));
        Ok(deviation)
    }
}

/// Calls `f` with the Bézier points of a spline's spans, each halved `halvings` times.
fn each_bezier(space: &Space, halvings: usize, mut f: impl FnMut(&[(usize, f64)])) {
    if halvings == 0 {
        space.each_bezier(None, f);
        return;
    }
    for k in space.spans() {
        let columns: Vec<usize> = space.columns(k).collect();
        let mut parts = vec![space.bezier_of(k)];
        for _ in 0..halvings {
            parts = parts.into_iter().flat_map(halves).collect();
        }
        for (part, points) in parts.into_iter().enumerate() {
            // A part begins where the one before ends.
            for point in points.into_iter().skip(usize::from(part > 0)) {
                let entries: Vec<(usize, f64)> = columns.iter().copied().zip(point).collect();
                f(&entries);
            }
        }
    }
}

/// The Bézier points of both halves of a polynomial, by de Casteljau's algorithm.
fn halves(mut points: Vec<Vec<f64>>) -> [Vec<Vec<f64>>; 2] {
    let (mut low, mut high) = (Vec::new(), Vec::new());
    while let (Some(first), Some(last)) = (points.first(), points.last()) {
        low.push(first.clone());
        high.push(last.clone());
        let middle = |w: &[Vec<f64>]| -> Vec<f64> {
            w[0].iter().zip(&w[1]).map(|(x, y)| 0.5 * (x + y)).collect()
        };
        points = points.windows(2).map(middle).collect();
    }
    high.reverse();
    [low, high]
}

impl Network {
    /// The splines through the points of curve `k`, where it has parameters.
    pub(super) fn layout(&self, k: usize) -> Option<Result<InterpolationSpace, FairError>> {
        let strand = &self.strands[k];
        let (degree, closed) = (strand.space.degree(), strand.space.is_closed());
        strand.at.as_ref().map(|at| {
            if strand.runs.is_empty() {
                return InterpolationSpace::new(degree, at, &strand.marks, closed);
            }
            InterpolationSpace::with_runs(at, &strand.marks, &strand.runs, closed)
        })
    }

    /// Curve `k` through its given points and through the faired ones.
    ///
    /// # Errors
    /// [`FairError`] when there is no such spline.
    pub fn curve_pair(&self, k: usize, points: &[Vec3<f64>]) -> Result<CurvePair, FairError> {
        let strand = &self.strands[k];
        let own = |all: &[Vec3<f64>]| -> Vec<Vec3<f64>> {
            strand.points.iter().map(|&i| all[i]).collect()
        };
        let (before, after) = (own(&self.points), own(points));
        if let Some(layout) = self.layout(k) {
            let layout = layout?;
            let through = |points: &[Vec3<f64>]| layout.through(&layout.data(points));
            let (before, after) = (through(&before)?, through(&after)?);
            return Ok(CurvePair { space: layout.space, before, after });
        }
        let (degree, closed) = (strand.space.degree(), strand.space.is_closed());
        let through = |points: &[Vec3<f64>]| {
            interpolate_with_corners(
                degree,
                points,
                ParameterSpacing::Uniform,
                closed,
                &strand.marks,
            )
        };
        let (before, after) = (through(&before)?, through(&after)?);
        Ok(CurvePair { space: before.fit.space, before: before.points, after: after.points })
    }

    /// True if all curves run through their points, at parameters of these.
    pub(super) fn runs_through_points(&self) -> bool {
        let through = |s: &NetworkCurve| s.at.is_some() && s.weights.is_none();
        self.patches.is_empty() && self.strands.iter().all(through)
    }

    /// The Bézier points of the displacement of curve `k`, linear in the moves of its points, and of
    /// each the tolerance next to it: the smaller one of the two points that move it most, of those
    /// that may move. Beside a point without limit there is none, nor for a Bézier point of a single
    /// point.
    ///
    /// `halvings` of each span bring the Bézier points nearer to the curve.
    pub(super) fn bezier_limits(
        &self,
        k: usize,
        halvings: usize,
    ) -> Result<Vec<BezierLimit>, FairError> {
        let own = &self.strands[k].points;
        let Some(layout) = self.layout(k).transpose()? else { return Ok(Vec::new()) };
        let control = control_map(&layout, own.len())?;
        let (mut out, mut sum) = (Vec::new(), vec![0.0; own.len()]);
        let mut places: Vec<usize> = Vec::new();
        each_bezier(&layout.space, halvings, |entries| {
            for (place, f) in entries
                .iter()
                .flat_map(|&(c, x)| control[c].iter().map(move |&(place, f)| (place, x * f)))
            {
                sum[place] += f;
                places.push(place);
            }
            places.sort_unstable();
            places.dedup();
            let factors = places.drain(..).map(|c| (own[c], std::mem::take(&mut sum[c])));
            let factors: Vec<(usize, f64)> = factors.filter(|(_, f)| *f != 0.0).collect();
            let mut near: Vec<&(usize, f64)> = factors.iter().collect();
            near.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            let radii = &self.limit.radii;
            let least_of = |near: &[&(usize, f64)]| {
                let all = near.iter().map(|(i, _)| *i).filter(|&i| radii[i] > 0.0);
                all.reduce(|a, b| if radii[b] < radii[a] { b } else { a })
            };
            let two = &near[..near.len().min(2)];
            let free = two.iter().any(|(i, _)| radii[*i].is_infinite());
            let owner = least_of(two).or_else(|| least_of(&near)).filter(|_| !free);
            let single = factors.iter().filter(|(_, f)| f.abs() > 1e-12).count() < 2;
            if let (Some(owner), false) = (owner, single) {
                let (radius, beside) = (radii[owner], near[0].0);
                out.push(BezierLimit { entries: factors, radius, owner, beside });
            }
        });
        Ok(out)
    }

    /// False where no Bézier point of curve `k` is displaced by more than `share` of its least
    /// tolerance.
    pub(super) fn may_swing(
        &self,
        k: usize,
        moves: &[Vec3<f64>],
        share: f64,
    ) -> Result<bool, FairError> {
        let own = &self.strands[k].points;
        let moved: Vec<Vec3<f64>> = own.iter().map(|&i| moves[i]).collect();
        if moved.iter().all(|&v| v == Vec3::zero()) {
            return Ok(false);
        }
        let radii = own.iter().map(|&i| self.limit.radii[i]).filter(|&r| r > 0.0);
        let least = radii.fold(f64::INFINITY, f64::min);
        let Some(layout) = self.layout(k).transpose()? else { return Ok(false) };
        let control = layout.through(&layout.data(&moved))?;
        let mut most = 0.0f64;
        each_bezier(&layout.space, HALVINGS, |entries| {
            let off = entries.iter().fold(Vec3::zero(), |s, &(c, x)| s + control[c] * x);
            most = most.max(off.norm());
        });
        Ok(most > share * least)
    }

    /// Limits on the points alone.
    pub(super) fn point_limits(&self) -> DataLimits {
        let radii = self.limit.radii.clone();
        let rows = SparseRows::identity(self.points.len());
        // Without a bound on some there is no certificate.
        let far = FAR * self.extent();
        let reach = radii.iter().map(|&r| if r.is_finite() { r } else { far }).collect();
        DataLimits { rows, reach, radii, offsets: Vec::new() }
    }

    /// Limits on the points and, all along the curves, on their displacements, of those places that
    /// can be farther off.
    pub(super) fn along_curves(&self) -> Result<DataLimits, FairError> {
        let mut limits = self.point_limits();
        let size = |limit: &BezierLimit| {
            limit.entries.iter().map(|&(i, f)| f.abs() * self.limit.radii[i]).sum::<f64>()
        };
        for k in 0..self.strands.len() {
            for limit in self.bezier_limits(k, 0)? {
                if size(&limit) > limit.radius {
                    limits.radii.push(limit.radius);
                    limits.rows.push(limit.entries);
                }
            }
        }
        Ok(limits)
    }

    /// The curves that exceed their bound, each at its farthest point.
    ///
    /// # Errors
    /// [`FairError`] when a curve has no spline.
    pub fn swings(&self, points: &[Vec3<f64>]) -> Result<Vec<CurveSwing>, FairError> {
        let share = if self.bound == Bound::ControlPoints { SWING } else { 1.0 };
        let share = share * (1.0 + SWING_SLACK);
        let moves = self.moves(points);
        let mut out = Vec::new();
        for curve in 0..self.strands.len() {
            if self.strands[curve].at.is_none() {
                out.extend(self.even_swing(curve, &moves, share));
                continue;
            }
            if !self.may_swing(curve, &moves, share)? {
                continue;
            }
            let (mut most, mut point) = (share, None);
            for limit in self.bezier_limits(curve, HALVINGS)? {
                let own = limit.share(self.limit.motion, &moves);
                if own > most {
                    (most, point) = (own, Some(limit.beside));
                }
            }
            out.extend(point.map(|point| CurveSwing { curve, point, share: most }));
        }
        Ok(out)
    }

    /// The swing of a curve without parameters, measured against its largest tolerance: its spline
    /// has even parameters. The point is that which moves farthest.
    fn even_swing(&self, k: usize, moves: &[Vec3<f64>], share: f64) -> Option<CurveSwing> {
        let own = &self.strands[k].points;
        let finite = |i: usize| Some(self.limit.radii[i]).filter(|r| r.is_finite());
        let largest = own.iter().map(|&i| finite(i)).reduce(|a, b| Some(a?.max(b?)))??;
        let points: Vec<Vec3<f64>> = self.points.iter().zip(moves).map(|(p, v)| *p + *v).collect();
        let off = self.curve_pair(k, &points).ok()?.deviation().ok()?.certified;
        let farther = |a: usize, b: usize| if moves[b].norm() > moves[a].norm() { b } else { a };
        let point = own.iter().copied().reduce(farther)?;
        (off > share * largest).then(|| CurveSwing { curve: k, point, share: off / largest })
    }

    pub(super) fn moves(&self, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        points.iter().zip(&self.points).map(|(p, q)| *p - *q).collect()
    }
}

/// A Bézier point of a curve's displacement: its entries over the moves of the network's points, the
/// tolerance next to it with the point that has it, and the point that moves it most.
#[derive(Clone)]
pub(super) struct BezierLimit {
    pub entries: Vec<(usize, f64)>,
    pub radius: f64,
    pub owner: usize,
    beside: usize,
}

impl BezierLimit {
    /// Its displacement in tolerances.
    pub fn share(&self, motion: Motion, moves: &[Vec3<f64>]) -> f64 {
        let off = self.entries.iter().fold(Vec3::zero(), |s, &(i, f)| s + moves[i] * f);
        let size = match motion {
            Motion::Box => off.x.abs().max(off.y.abs()).max(off.z.abs()),
            _ => off.norm(),
        };
        size / self.radius
    }
}

/// A curve that exceeds its bound on the distance from its original.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSwing {
    /// The curve.
    pub curve: usize,
    /// The point nearest to that position.
    pub point: usize,
    /// The displacement in tolerances: of a Bézier point, which bounds the distance of the curve.
    pub share: f64,
}
