//! Conditions on networks of curves: shapes along curves, flats, tangents at ends, directions in which
//! points move, a displacement that stays.
//!
//! Conditions of curves are conditions of their points, in which the splines through these are linear.
//! If points move along one direction all conditions are linear, too; otherwise those of runs, flats and
//! signs are linearised at the previous network, and solved again until they hold.

use crate::curve::shaping::ShapeConstraints;
use crate::interrogate::shape;
use crate::optimum::{ControlInequality, HeldDirections, MotionAxes};
use crate::{Condition, FairError, InterpolationSpace, Motion, Network, ShapeCondition};
use moldloft_num::{Vec3, gauss_points};

/// A condition of a network. Points are indices of the network's list.
#[derive(Clone, Debug, PartialEq)]
pub enum NetworkCondition {
    /// A shape of one curve, in terms of the indices of its points.
    Curve {
        /// The curve.
        curve: usize,
        /// Its shape.
        shape: ShapeCondition,
    },
    /// Points in one plane: a flat part of the side or bottom.
    Flat {
        /// The points.
        points: Vec<usize>,
        /// The plane's normal, if given.
        normal: Option<Vec3<f64>>,
    },
    /// A curve's tangent at its end or start.
    Tangent {
        /// The curve.
        curve: usize,
        /// True for the tangent at the end.
        at_end: bool,
        /// The direction.
        direction: Vec3<f64>,
    },
    /// The volume of the plane sections across an axis, by splines through the sections, or its
    /// centroid along the axis and across it, is preserved.
    Volume {
        /// The axis.
        axis: Vec3<f64>,
        /// True for the centroid.
        centre: bool,
    },
}

/// Fewest points of an arc: three are always on a circle.
const FEWEST_ARC_POINTS: usize = 4;

/// Rounds in which conditions are made linear.
pub(super) const ROUNDS: usize = 20;

/// Tolerance of equations, relative to the extent.
pub(super) const MET: f64 = 1e-12;

/// Tolerance of half-spaces, relative to the mean tolerance: that of the solver.
pub(super) const KEPT: f64 = 1e-8;

/// Residual of equations, relative to the mean tolerance, that the rounding of a solution may
/// leave.
pub(super) const SETTLED: f64 = 1e-6;

/// Maximum number of projections on conditions and tolerances in turn; the fraction of the
/// tolerances that a start may use, and the smaller target.
const MOST_PROJECTIONS: usize = 2000;
const STRICTLY: f64 = 0.9999;
const DEEPER: f64 = 0.999;

/// Relative size of a condition's factor below which the condition depends on earlier ones.
const DEPENDENT: f64 = 1e-9;

/// Maximum number of passes over the equations in which ranges of moves are narrowed, and the rounding
/// of a range relative to the tolerance.
const MOST_PROPAGATIONS: usize = 50;
const PROPAGATED: f64 = 1e-6;

/// A factor below which a point does not move a control point of its curve: far from it, whose factor is
/// near 1, these fall geometrically.
const NEGLIGIBLE: f64 = 1e-18;

/// Allowed contradiction of a condition that depends on others, relative to the extent: rounding of
/// the input.
const AGREES: f64 = 1e-9;

/// Conditions of a network made linear at its points.
#[derive(Clone, Debug, Default)]
pub(super) struct LinearConditions {
    /// Equations, each with the condition that requires it.
    pub equations: Vec<(Condition, usize)>,
    pub halves: Vec<ControlInequality>,
    /// The largest residual of an equation at these points, and the condition that requires it.
    pub missed: (f64, usize),
    /// The largest distance from a half-space at these points, and the condition that requires it.
    pub left: (f64, usize),
}

fn refused(shape: usize, why: impl Into<String>) -> FairError {
    FairError::Shapeless { shape, why: why.into() }
}

impl NetworkCondition {
    /// The quantity to preserve, "volume" or "centroid", where points move along a direction:
    /// sections are in planes perpendicular to the first axis perpendicular to it.
    pub fn kept(word: &str, way: Option<Vec3<f64>>) -> Option<Self> {
        let axes = [Vec3::of(1.0, 0.0, 0.0), Vec3::of(0.0, 1.0, 0.0)];
        let across = |a: &Vec3<f64>| way.is_none_or(|way| a.dot(way).abs() < 1e-9 * way.norm());
        let axis = axes.into_iter().find(across).unwrap_or(axes[0]);
        match word {
            "volume" => Some(Self::Volume { axis, centre: false }),
            "centroid" => Some(Self::Volume { axis, centre: true }),
            _ => None,
        }
    }
}

impl Network {
    /// The network with conditions. Straight runs are for cubics.
    ///
    /// # Errors
    /// [`FairError::Shapeless`] with the number of a condition that this network cannot have.
    pub fn with_conditions(mut self, wanted: Vec<NetworkCondition>) -> Result<Self, FairError> {
        let count = self.points.len();
        for (owner, condition) in wanted.iter().enumerate() {
            let (curve, points): (Option<usize>, &[usize]) = match condition {
                NetworkCondition::Curve { curve, .. } | NetworkCondition::Tangent { curve, .. } => {
                    (Some(*curve), &[])
                }
                NetworkCondition::Flat { points, .. } => (None, points),
                NetworkCondition::Volume { .. } => (None, &[]),
            };
            if let Some(&index) = points.iter().find(|&&i| i >= count) {
                return Err(FairError::Mark { index, count });
            }
            let Some(k) = curve else { continue };
            let Some(strand) = self.strands.get_mut(k) else {
                return Err(refused(owner, format!("there is no curve {}", k + 1)));
            };
            if strand.at.is_none() {
                return Err(refused(
                    owner,
                    "conditions are for the optimum of curves at parameters: another spacing than `index`",
                ));
            }
            let closed = strand.space.is_closed();
            if closed && matches!(condition, NetworkCondition::Tangent { .. }) {
                return Err(refused(owner, "a closed curve has no ends"));
            }
            let NetworkCondition::Curve { shape, .. } = condition else { continue };
            let own = strand.points.len();
            if let ShapeCondition::Turn { between, .. }
            | ShapeCondition::OneWay { between }
            | ShapeCondition::Straight { between, .. }
            | ShapeCondition::Arc { between } = shape
                && !(between[0] < between[1] && between[1] < own)
            {
                return Err(refused(
                    owner,
                    format!("expected a first and a later point of 1 to {own}"),
                ));
            }
            match shape {
                ShapeCondition::Straight { between, .. } => {
                    if strand.space.degree() != 3 {
                        return Err(refused(owner, "straight runs are for cubics: degree 3"));
                    }
                    strand.runs.push(*between);
                    strand.runs.sort_unstable();
                    strand.runs.dedup();
                    let overlap = strand.runs.windows(2).find(|w| w[1][0] < w[0][1]);
                    if let Some(pair) = overlap {
                        return Err(refused(
                            owner,
                            format!("point {} is in two runs", pair[1][0] + 1),
                        ));
                    }
                    let sharp = |k: usize| strand.marks.contains(&k);
                    if let Some(pair) =
                        strand.runs.windows(2).find(|w| w[0][1] == w[1][0] && !sharp(w[1][0]))
                    {
                        return Err(refused(
                            owner,
                            format!(
                                "two straight runs meet at point {0}: add it to the breaks",
                                pair[1][0] + 1
                            ),
                        ));
                    }
                    if let Some(k) = (between[0] + 1..between[1]).find(|k| strand.marks.contains(k))
                    {
                        return Err(refused(
                            owner,
                            format!("point {} is a break within a straight run", k + 1),
                        ));
                    }
                }
                ShapeCondition::Arc { between } => self.arcs.push((k, *between)),
                ShapeCondition::Pieces(_) => {
                    return Err(refused(owner, "counts of pieces are for single curves"));
                }
                _ => {}
            }
        }
        self.check_arcs(&wanted)?;
        self.conditions = wanted;
        self.check()?;
        Ok(self)
    }

    /// Refuses arcs that overlap others, runs or breaks.
    fn check_arcs(&self, wanted: &[NetworkCondition]) -> Result<(), FairError> {
        for (owner, condition) in wanted.iter().enumerate() {
            let NetworkCondition::Curve { curve, shape: ShapeCondition::Arc { between } } =
                condition
            else {
                continue;
            };
            let strand = &self.strands[*curve];
            let found = between[1] - between[0] + 1;
            if found < FEWEST_ARC_POINTS {
                let why =
                    format!("expected {FEWEST_ARC_POINTS} points of an arc or more, found {found}");
                return Err(refused(owner, why));
            }
            let arcs = self.arcs_of(*curve);
            let overlaps = |other: &&[usize; 2]| other[0] < between[1] && between[0] < other[1];
            let twice = arcs.iter().filter(overlaps).count() > 1;
            if twice || strand.runs.iter().any(|run| overlaps(&run)) {
                return Err(refused(owner, "an arc overlaps a straight run or another arc"));
            }
            if strand.marks.iter().any(|&m| between[0] < m && m < between[1]) {
                return Err(refused(owner, "there is a break within the arc"));
            }
        }
        Ok(())
    }

    /// Largest distance of a point from the first.
    pub(super) fn extent(&self) -> f64 {
        let first = self.points.first().copied().unwrap_or_default();
        self.points.iter().map(|&p| (p - first).norm()).fold(0.0, f64::max)
    }

    /// The conditions made linear at points.
    pub(super) fn linear_conditions(
        &self,
        points: &[Vec3<f64>],
    ) -> Result<LinearConditions, FairError> {
        let mut out = LinearConditions::default();
        let mut shapes: Vec<Vec<(usize, &ShapeCondition)>> = vec![Vec::new(); self.strands.len()];
        for (owner, condition) in self.conditions.iter().enumerate() {
            let own: Vec<Condition> = match condition {
                NetworkCondition::Curve { curve, shape } => match shape {
                    ShapeCondition::Straight { between, along } => {
                        let ids = self.strands[*curve].points[between[0]..=between[1]].to_vec();
                        straight(ids, *along, points)
                            .ok_or_else(|| refused(owner, "the direction has no length"))?
                    }
                    ShapeCondition::Arc { between } => {
                        self.arc(*curve, *between, points).map_err(|why| refused(owner, why))?
                    }
                    ShapeCondition::OneSided { direction } => {
                        let d = direction.normalized().filter(|d| d.is_finite());
                        let d = d.ok_or_else(|| refused(owner, "a side has a direction"))?;
                        let half = |&i: &usize| ControlInequality {
                            entries: vec![(i, d)],
                            most: d.dot(self.points[i]),
                            owner,
                        };
                        out.halves.extend(self.strands[*curve].points.iter().map(half));
                        Vec::new()
                    }
                    shape => {
                        shapes[*curve].push((owner, shape));
                        Vec::new()
                    }
                },
                NetworkCondition::Flat { points: own, normal } => {
                    self.flat(own, *normal, points).map_err(|why| refused(owner, why))?
                }
                NetworkCondition::Tangent { curve, at_end, direction } => {
                    self.tangent(*curve, *at_end, *direction, owner)?
                }
                NetworkCondition::Volume { axis, centre } => {
                    self.kept_volume(*axis, *centre).map_err(|why| refused(owner, why))?
                }
            };
            out.equations.extend(own.into_iter().map(|c| (c, owner)));
        }
        for (k, own) in shapes.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            out.halves.extend(self.curve_halves(k, own, points)?);
        }
        let frozen = self.frozen();
        out.halves.retain(|h| h.entries.iter().any(|(i, _)| !frozen[*i]));
        for (condition, owner) in &out.equations {
            let off = (condition.at(points) - condition.value).abs();
            if off > out.missed.0 || off.is_nan() {
                out.missed = (off, *owner);
            }
        }
        for half in &out.halves {
            let sum: f64 = half.entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
            if sum - half.most > out.left.0 {
                out.left = (sum - half.most, half.owner);
            }
        }
        Ok(out)
    }

    /// The half-spaces of signs and limits of curve `k`, over the network's points.
    fn curve_halves(
        &self,
        k: usize,
        wanted: &[(usize, &ShapeCondition)],
        points: &[Vec3<f64>],
    ) -> Result<Vec<ControlInequality>, FairError> {
        let strand = &self.strands[k];
        let Some(layout) = self.layout(k).transpose()? else { return Ok(Vec::new()) };
        let own: Vec<Vec3<f64>> = strand.points.iter().map(|&i| points[i]).collect();
        let map = control_map(&layout, own.len())?;
        let control = layout.through(&layout.data(&own))?;
        let at = &layout.at;
        let runs: Vec<[f64; 2]> = strand.runs.iter().map(|run| run.map(|c| at[c])).collect();
        let bulge = |between: [usize; 2]| self.bulge(k, between);
        let shape =
            ShapeConstraints::of_spline(&layout.space, &control, at, &runs, wanted, &bulge)?;
        let pulled = |(half, now): (ControlInequality, f64)| {
            let mut sums = vec![Vec3::zero(); own.len()];
            for (c, f) in &half.entries {
                for &(place, x) in &map[*c] {
                    sums[place] += *f * x;
                }
            }
            let entries: Vec<(usize, Vec3<f64>)> = sums
                .into_iter()
                .enumerate()
                .filter(|(_, f)| f.norm_sq() > 0.0)
                .map(|(place, f)| (strand.points[place], f))
                .collect();
            let sum: f64 = entries.iter().map(|(i, f)| f.dot(points[*i])).sum();
            ControlInequality { entries, most: sum + now, owner: half.owner }
        };
        Ok(shape.spline_halves(&layout.space, &control).into_iter().map(pulled).collect())
    }

    /// Points in one plane.
    fn flat(
        &self,
        own: &[usize],
        normal: Option<Vec3<f64>>,
        points: &[Vec3<f64>],
    ) -> Result<Vec<Condition>, String> {
        let [first, ..] = own else { return Err("no point of the network is there".into()) };
        if let Some(normal) = normal {
            let n = normal.normalized().ok_or("the normal has no length")?;
            let one = |&i: &usize| Condition { entries: vec![(*first, -n), (i, n)], value: 0.0 };
            return Ok(own[1..].iter().map(one).collect());
        }
        // Three points far apart as they were read, and all others in their plane.
        let far = |of: &dyn Fn(Vec3<f64>) -> f64| {
            let size = |i: &usize| of(self.points[*i] - self.points[*first]);
            own.iter().copied().fold((*first, 0.0), |best, i| {
                let own = size(&i);
                if own > best.1 { (i, own) } else { best }
            })
        };
        let (second, length) = far(&|v| v.norm());
        let along = self.points[second] - self.points[*first];
        let (third, area) = far(&|v| v.cross(along).norm());
        if area <= AGREES * length * length {
            return Err("its points are on one line: a straight run".into());
        }
        let [a, b, c] = [*first, second, third].map(|i| points[i]);
        let (u, v) = (b - a, c - a);
        let size = u.cross(v).norm();
        if size == 0.0 {
            return Err("its points are on one line: a straight run".into());
        }
        let others = own.iter().filter(|i| ![*first, second, third].contains(i));
        Ok(others
            .map(|&i| {
                let p = points[i] - a;
                let by_p = u.cross(v) * (1.0 / size);
                let (by_b, by_c) = (v.cross(p) * (1.0 / size), p.cross(u) * (1.0 / size));
                let by_a = -(by_p + by_b + by_c);
                let entries = vec![(*first, by_a), (second, by_b), (third, by_c), (i, by_p)];
                let mut condition = Condition { entries, value: 0.0 };
                condition.value = condition.at(points) - p.dot(u.cross(v)) / size;
                condition
            })
            .collect())
    }

    fn tangent(
        &self,
        k: usize,
        at_end: bool,
        direction: Vec3<f64>,
        owner: usize,
    ) -> Result<Vec<Condition>, FairError> {
        let strand = &self.strands[k];
        let d = direction.normalized().filter(|d| d.is_finite());
        let d = d.ok_or_else(|| refused(owner, "a tangent has a direction"))?;
        let Some(layout) = self.layout(k).transpose()? else { return Ok(Vec::new()) };
        let map = control_map(&layout, strand.points.len())?;
        let (start, end) = layout.space.domain();
        let t = if at_end { end } else { start };
        // As a length: the tangent over the step beside it.
        let last = layout.at.len() - 1;
        let step = if at_end {
            layout.at[last] - layout.at[last - 1]
        } else {
            layout.at[1] - layout.at[0]
        };
        let pulled = |condition: Condition| {
            let mut sums = vec![Vec3::zero(); strand.points.len()];
            for (c, f) in &condition.entries {
                for &(place, x) in &map[*c] {
                    sums[place] += *f * (x * step);
                }
            }
            let all = strand.points.iter().copied().zip(sums);
            Condition { entries: all.filter(|(_, f)| f.norm_sq() > 0.0).collect(), value: 0.0 }
        };
        Ok(Condition::tangent(&layout.space, t, d).into_iter().map(pulled).collect())
    }

    /// The volume, or its centre: linear where points move along one direction.
    fn kept_volume(&self, axis: Vec3<f64>, centre: bool) -> Result<Vec<Condition>, String> {
        let Motion::Along(way) = self.limit.motion else {
            return Err("the volume of a network can be preserved only if points move along one \
                direction"
                .into());
        };
        let axis = axis.normalized().ok_or("the axis has no length")?;
        let up = axis.cross(way).normalized().filter(|_| axis.dot(way).abs() < 1e-9);
        let up =
            up.ok_or("the axis of a volume must be perpendicular to the direction of motion")?;
        let size = self.extent();
        // The sections: curves in planes across the axis.
        let mut sections: Vec<(f64, usize)> = Vec::new();
        for (k, strand) in self.strands.iter().enumerate() {
            let place = |i: &usize| axis.dot(self.points[*i]);
            let (low, high) = strand
                .points
                .iter()
                .map(place)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            if high - low <= AGREES * size && !strand.space.is_closed() {
                sections.push((low, k));
            }
        }
        sections.sort_by(|a, b| a.0.total_cmp(&b.0));
        let count = sections.len();
        if count < 2 {
            return Err(format!("expected two sections across the axis or more, found {count}"));
        }
        if sections.windows(2).any(|w| w[1].0 - w[0].0 <= AGREES * size) {
            return Err("two sections are in one plane".into());
        }
        let (first, length) = (sections[0].0, sections[count - 1].0 - sections[0].0);
        let at: Vec<f64> = sections.iter().map(|s| (s.0 - first) / length).collect();
        let degree = (count - 1).min(3);
        let shares = quadrature(&at, degree).map_err(|e| e.to_string())?;
        // By the offsets: the volume, and its moments along and across.
        let mut by = vec![[0.0; 3]; self.points.len()];
        for (&(x, k), share) in sections.iter().zip(&shares) {
            let share = share * length;
            for (i, [area, moment]) in self.section(k, up).map_err(|e| e.to_string())? {
                by[i][0] += share * area;
                by[i][1] += share * x * area;
                by[i][2] += share * moment;
            }
        }
        let sum = |order: usize| -> f64 {
            by.iter().zip(&self.points).map(|(b, p)| b[order] * way.dot(*p)).sum()
        };
        let volume = sum(0);
        // Kept combinations of the three.
        let kept: Vec<[f64; 3]> = if centre {
            vec![[-sum(1) / volume, 1.0, 0.0], [-sum(2) / volume, 0.0, 1.0]]
        } else {
            vec![[1.0, 0.0, 0.0]]
        };
        let condition = |kept: [f64; 3]| {
            let factor = |b: &[f64; 3]| -> f64 { b.iter().zip(kept).map(|(b, k)| b * k).sum() };
            let largest = by.iter().map(|b| factor(b).abs()).fold(f64::MIN_POSITIVE, f64::max);
            let each = by.iter().enumerate().map(|(i, b)| (i, way * (factor(b) / largest)));
            let entries = each.filter(|(_, f)| f.norm_sq() > 0.0).collect();
            let mut condition = Condition { entries, value: 0.0 };
            condition.value = condition.at(&self.points);
            condition
        };
        Ok(kept.into_iter().map(condition).collect())
    }

    /// By the offset of each point of a section: its area between the curve and the axis of heights,
    /// and the moment of that by the height.
    fn section(&self, k: usize, up: Vec3<f64>) -> Result<Vec<(usize, [f64; 2])>, FairError> {
        let strand = &self.strands[k];
        let Some(layout) = self.layout(k).transpose()? else { return Ok(Vec::new()) };
        let own: Vec<Vec3<f64>> = strand.points.iter().map(|&i| self.points[i]).collect();
        let control = layout.through(&layout.data(&own))?;
        let map = control_map(&layout, own.len())?;
        let mut by = vec![[0.0; 2]; control.len()];
        for span in layout.space.spans() {
            let (a, b) = (layout.space.knot(span), layout.space.knot(span + 1));
            for (t, weight) in gauss_points(a, b) {
                let sample = shape::sample_in(&layout.space, &control, None, span, t);
                let (height, rate) = (up.dot(sample.point), up.dot(sample.derivatives[0]));
                let basis = layout.space.basis(span, t);
                for (c, &value) in layout.space.columns(span).zip(basis.rows[0].iter()) {
                    by[c][0] += weight * rate * value;
                    by[c][1] += weight * rate * height * value;
                }
            }
        }
        let mut out = vec![[0.0; 2]; own.len()];
        for (c, own) in map.iter().enumerate() {
            for &(place, x) in own {
                out[place][0] += by[c][0] * x;
                out[place][1] += by[c][1] * x;
            }
        }
        // Upwards, whichever way the curve runs.
        let rises = up.dot(own[own.len() - 1] - own[0]) >= 0.0;
        let sign = if rises { 1.0 } else { -1.0 };
        let each = strand.points.iter().copied().zip(out);
        Ok(each.map(|(i, b)| (i, b.map(|x| x * sign))).collect())
    }

    /// Equations of which none depends on the others: what they repeat is left out.
    ///
    /// # Errors
    /// [`FairError::Shapeless`] for one that contradicts others, or what does not move.
    pub(super) fn independent(
        &self,
        equations: Vec<(Condition, usize)>,
    ) -> Result<Vec<(Condition, usize)>, FairError> {
        let all: Vec<&Condition> = equations.iter().map(|e| &e.0).collect();
        let mut span = EquationSpan::empty(self, &all);
        let size = self.extent();
        let mut out = Vec::new();
        for (condition, owner) in equations {
            match span.add(self, &condition) {
                None => out.push((condition, owner)),
                Some(off) if off <= AGREES * size => {}
                Some(off) => {
                    return Err(refused(
                        owner,
                        format!(
                            "fixed points, the direction of motion or other conditions leave a \
                            deviation of {off:.3e}"
                        ),
                    ));
                }
            }
        }
        Ok(out)
    }
}

/// The span of linear conditions.
pub(super) struct EquationSpan {
    frozen: Vec<bool>,
    frame: MotionAxes,
    held: HeldDirections,
    /// Orthogonal rows of unit length, over the coordinates in which points move, and their values.
    rows: Vec<(Vec<f64>, f64)>,
}

impl EquationSpan {
    fn empty(network: &Network, conditions: &[&Condition]) -> Self {
        let all: Vec<Condition> = conditions.iter().map(|c| (*c).clone()).collect();
        let frame = MotionAxes::of(network.limit.motion, &network.points, &all);
        let held = frame.held(&network.held);
        Self { frozen: network.frozen(), frame, held, rows: Vec::new() }
    }

    /// The span of these.
    pub fn of(network: &Network, conditions: &[Condition]) -> Self {
        let mut span = Self::empty(network, &conditions.iter().collect::<Vec<_>>());
        for condition in conditions {
            span.add(network, condition);
        }
        span
    }

    /// The component of factors, and of a value, across the span.
    fn left(&self, entries: &[(usize, Vec3<f64>)], value: f64) -> (Vec<f64>, f64) {
        let dimension = self.frame.axes.len();
        let mut row = vec![0.0; self.frozen.len() * dimension];
        for (i, f) in entries.iter().filter(|(i, _)| !self.frozen[*i]) {
            let moving = self.held.project(*i, self.frame.down(*f));
            for (d, x) in moving.into_iter().take(dimension).enumerate() {
                row[i * dimension + d] += x;
            }
        }
        let mut value = value;
        for (other, its) in &self.rows {
            let share: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
            if share != 0.0 {
                row.iter_mut().zip(other).for_each(|(a, b)| *a -= share * b);
                value -= share * its;
            }
        }
        (row, value)
    }

    /// Adds a condition; of one that the others determine, by how much these miss it.
    fn add(&mut self, network: &Network, condition: &Condition) -> Option<f64> {
        let size = factor_size(&condition.entries);
        let value = condition.value - condition.at(&network.points);
        let (mut row, value) = self.left(&condition.entries, value);
        let length = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length <= DEPENDENT * size {
            return Some(value.abs() / size.max(f64::MIN_POSITIVE));
        }
        row.iter_mut().for_each(|x| *x /= length);
        self.rows.push((row, value / length));
        None
    }

    /// The points nearest to these that meet the conditions: what rounding left of a solution.
    pub fn nearest(&self, network: &Network, points: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let dimension = self.frame.axes.len();
        let mut out = points.to_vec();
        for (row, value) in &self.rows {
            let mut sum = *value;
            for (i, x) in
                row.chunks(dimension).enumerate().filter(|(_, x)| x.iter().any(|&x| x != 0.0))
            {
                let moved = self.frame.down(out[i] - network.points[i]);
                sum -= x.iter().zip(moved).map(|(a, b)| a * b).sum::<f64>();
            }
            for (i, x) in
                row.chunks(dimension).enumerate().filter(|(_, x)| x.iter().any(|&x| x != 0.0))
            {
                let mut step = [0.0; 3];
                step.iter_mut().zip(x).for_each(|(s, x)| *s = x * sum);
                out[i] += self.frame.up(step);
            }
        }
        out
    }

    /// Moves that satisfy the conditions strictly within the tolerances, by projections on both in
    /// turn; `None` if they find none.
    pub fn within(&self, network: &Network) -> Vec<Vec3<f64>> {
        let radii = &network.limit.radii;
        let mut points = network.points.clone();
        for _ in 0..MOST_PROJECTIONS {
            points = self.nearest(network, &points);
            let moves = points.iter().zip(&network.points).map(|(p, q)| *p - *q);
            let moves: Vec<Vec3<f64>> = moves.collect();
            let free = |i: usize| !self.frozen[i] && radii[i] > 0.0;
            let share =
                |(i, v): (usize, &Vec3<f64>)| if free(i) { v.norm() / radii[i] } else { 0.0 };
            if moves.iter().enumerate().map(share).fold(0.0, f64::max) < STRICTLY {
                return moves;
            }
            for (i, v) in moves.iter().enumerate().filter(|(i, _)| free(*i)) {
                let most = DEEPER * radii[i];
                let size = v.norm();
                if size > most {
                    points[i] = network.points[i] + *v * (most / size);
                }
            }
        }
        Vec::new()
    }

    /// The ranges of the moves of points, by coordinates of the frame, that the tolerances and single
    /// equations leave (propagation of bounds): no move that meets all of them is outside.
    pub fn move_ranges(&self, network: &Network, conditions: &[Condition]) -> Vec<Vec<[f64; 2]>> {
        let dimension = self.frame.axes.len();
        let extent = network.extent();
        let range = |i: usize| {
            let most = if self.frozen[i] { 0.0 } else { network.limit.radii[i].min(extent) };
            vec![[-most, most]; dimension]
        };
        let mut ranges: Vec<Vec<[f64; 2]>> = (0..self.frozen.len()).map(range).collect();
        let row = |c: &Condition| -> (Vec<(usize, usize, f64)>, f64) {
            let free = c.entries.iter().filter(|(i, _)| !self.frozen[*i]);
            let entries = free.flat_map(|(i, f)| {
                let moving = self.held.project(*i, self.frame.down(*f));
                let own = moving.into_iter().take(dimension).enumerate();
                own.filter(|(_, x)| *x != 0.0).map(|(d, x)| (*i, d, x)).collect::<Vec<_>>()
            });
            (entries.collect(), c.value - c.at(&network.points))
        };
        let rows: Vec<(Vec<(usize, usize, f64)>, f64)> = conditions.iter().map(row).collect();
        let product = |f: f64, [low, high]: [f64; 2]| {
            if f > 0.0 { [f * low, f * high] } else { [f * high, f * low] }
        };
        for _ in 0..MOST_PROPAGATIONS {
            let mut changed = false;
            for (entries, value) in &rows {
                let sum = entries.iter().fold([0.0; 2], |s, &(i, d, f)| {
                    let own = product(f, ranges[i][d]);
                    [s[0] + own[0], s[1] + own[1]]
                });
                for &(i, d, f) in entries {
                    let [low, high] = ranges[i][d];
                    let own = product(f, [low, high]);
                    let rest = [value - (sum[1] - own[1]), value - (sum[0] - own[0])];
                    let rounding = PROPAGATED * network.limit.radii[i].min(extent);
                    let [a, b] = product(1.0 / f, rest);
                    let new = [low.max(a - rounding), high.min(b + rounding)];
                    let gain = (new[0] - low).max(high - new[1]);
                    if new[0] <= new[1] && gain > 2.0 * rounding {
                        ranges[i][d] = new;
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
        }
        ranges
    }

    /// The range of the moves of a point along a direction that is an axis of the frame.
    pub fn along(&self, ranges: &[[f64; 2]], way: Vec3<f64>) -> Option<[f64; 2]> {
        let near = |a: &Vec3<f64>| a.dot(way).abs() >= 1.0 - AGREES;
        let d = self.frame.axes.iter().position(near)?;
        let [low, high] = ranges[d];
        Some(if self.frame.axes[d].dot(way) > 0.0 { [low, high] } else { [-high, -low] })
    }

    /// True if the conditions determine a combination of points.
    pub fn determines(&self, entries: &[(usize, Vec3<f64>)]) -> bool {
        if self.rows.is_empty() {
            return false;
        }
        let (row, _) = self.left(entries, 0.0);
        row.iter().map(|x| x * x).sum::<f64>().sqrt() <= DEPENDENT * factor_size(entries)
    }
}

fn factor_size(entries: &[(usize, Vec3<f64>)]) -> f64 {
    entries.iter().map(|(_, f)| f.norm_sq()).sum::<f64>().sqrt()
}

/// The common direction of the moving points, if there is one; points that move in more directions
/// move along it as well.
pub fn one_way(motion: Motion, held: &[(usize, Vec3<f64>)], points: &[usize]) -> Option<Vec3<f64>> {
    if let Motion::Along(d) = motion {
        return d.normalized();
    }
    let fixed = |i: usize| -> Vec<Vec3<f64>> {
        let mut fixed: Vec<Vec3<f64>> = Vec::new();
        let also = match motion {
            Motion::Across(d) => Some(d),
            _ => None,
        };
        let here = held.iter().filter(|(point, _)| *point == i).map(|h| h.1);
        for d in also.into_iter().chain(here) {
            let left = fixed.iter().fold(d, |v, f| v - *f * f.dot(v));
            if left.norm() > AGREES * d.norm() {
                fixed.extend(left.normalized());
            }
        }
        fixed
    };
    let all: Vec<Vec<Vec3<f64>>> = points.iter().map(|&i| fixed(i)).collect();
    let single = |fixed: &Vec<Vec3<f64>>| match fixed[..] {
        [a, b] => a.cross(b).normalized(),
        _ => None,
    };
    let way = all.iter().find_map(single)?;
    let free = |fixed: &Vec<Vec3<f64>>| fixed.iter().all(|f| f.dot(way).abs() <= AGREES);
    all.iter().all(free).then_some(way)
}

/// Points on a straight line; none where a direction has no length.
fn straight(
    own: Vec<usize>,
    along: Option<Vec3<f64>>,
    points: &[Vec3<f64>],
) -> Option<Vec<Condition>> {
    let along = match along {
        Some(d) => Some(d.normalized()?),
        None => None,
    };
    let line = ShapeConstraints::straight(own, along);
    Some(line.conditions(points).into_iter().map(|(condition, _)| condition).collect())
}

/// The control points of a spline over the points that it passes through.
pub(super) fn control_map(
    layout: &InterpolationSpace,
    count: usize,
) -> Result<Vec<Vec<(usize, f64)>>, FairError> {
    let mut map: Vec<Vec<(usize, f64)>> = vec![Vec::new(); layout.space.count()];
    for place in 0..count {
        let mut unit: Vec<Vec3<f64>> = vec![Vec3::zero(); count];
        unit[place] = Vec3::of(1.0, 0.0, 0.0);
        for (c, p) in layout.through(&layout.data(&unit))?.iter().enumerate() {
            if p.x.abs() > NEGLIGIBLE {
                map[c].push((place, p.x));
            }
        }
    }
    Ok(map)
}

/// The weights by which the spline through values at rising parameters in [0, 1] is integrated.
fn quadrature(at: &[f64], degree: usize) -> Result<Vec<f64>, FairError> {
    let n = at.len();
    if n < degree + 2 || degree < 3 {
        // By trapezia.
        let mut out = vec![0.0; n];
        for k in 1..n {
            let half = 0.5 * (at[k] - at[k - 1]);
            out[k - 1] += half;
            out[k] += half;
        }
        return Ok(out);
    }
    let layout = InterpolationSpace::new(degree, at, &[], false)?;
    let map = control_map(&layout, n)?;
    let mut out = vec![0.0; n];
    for span in layout.space.spans() {
        let (a, b) = (layout.space.knot(span), layout.space.knot(span + 1));
        for (t, weight) in gauss_points(a, b) {
            let basis = layout.space.basis(span, t);
            for (c, &value) in layout.space.columns(span).zip(basis.rows[0].iter()) {
                for &(place, x) in &map[c] {
                    out[place] += weight * value * x;
                }
            }
        }
    }
    Ok(out)
}
