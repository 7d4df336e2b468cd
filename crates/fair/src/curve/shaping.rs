//! Shape as a condition: convex or concave parts, straight runs, circular arcs, monotone curvature,
//! limits that the curve stays within.
//!
//! Lines, limits and arcs are linear in the control points once found. The signs of curvature and of
//! its slope are polynomials in them: these are made linear at the curve before, and solved again
//! until the curve itself has them ([`crate::fair_data`]).

mod spline;

use crate::curve::bernstein::{P, SignedQuantity};
use crate::curve::chain::{Chain, ChainElement, chain, in_order};
use crate::curve::monotone::runs_of;
use crate::curve::shape_condition::ShapeCondition;
use crate::interrogate::shape;
use crate::optimum::ControlInequality;
use crate::{Condition, Data, FairError, InterpolationSpace, Motion, Space};
use moldloft_num::Vec3;

/// An arc found in the data.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundArc {
    /// Its first and last datum.
    pub between: [usize; 2],
    /// Its radius.
    pub radius: f64,
    /// Its centre.
    pub centre: Vec3<f64>,
    /// Maximum distance of the spline from the circle there, sampled 64 times per span.
    pub off: f64,
}

/// The plane of a curve, with the axes of its coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePlane {
    pub origin: Vec3<f64>,
    pub axes: [Vec3<f64>; 2],
}

impl CurvePlane {
    /// The plane of a curve, if it is plane.
    fn of(space: &Space, points: &[Vec3<f64>]) -> Option<Self> {
        let normal = shape::plane_normal(&shape::samples(space, points, None, 4))?;
        // Seen from above; for a vertical plane with z up and x, or else y, to the right.
        let back = if normal.z.abs() > 1e-9 {
            normal.z < 0.0
        } else if normal.y.abs() > 1e-9 {
            normal.y > 0.0
        } else {
            normal.x < 0.0
        };
        let normal = if back { -normal } else { normal };
        let a = normal.perpendicular().normalized()?;
        Some(Self { origin: points[0], axes: [a, normal.cross(a)] })
    }

    pub fn down(&self, p: Vec3<f64>) -> P<f64> {
        self.axes.map(|a| a.dot(p - self.origin))
    }

    fn turned(&self, d: P<f64>) -> Vec3<f64> {
        self.axes[0] * d[0] + self.axes[1] * d[1]
    }

    fn up(&self, p: P<f64>) -> Vec3<f64> {
        self.origin + self.turned(p)
    }

    fn normal(&self) -> Vec3<f64> {
        self.axes[0].cross(self.axes[1])
    }
}

/// A signed quantity on a span.
#[derive(Clone, Debug)]
struct Signed {
    span: isize,
    what: SignedQuantity,
    positive: bool,
    /// Tolerated violation of a coefficient.
    slack: f64,
    owner: usize,
}

/// Reversal of the curvature on a span, relative to its range, that is tolerated: half of what
/// counts.
const UNCOUNTED: f64 = 5e-4;

/// Control points on a line.
#[derive(Clone, Debug)]
struct CollinearPoints {
    points: Vec<usize>,
    /// A direction that is known.
    along: Option<Vec3<f64>>,
    /// A point on it, where one is known, too.
    through: Option<Vec3<f64>>,
    owner: usize,
}

/// Shape conditions resolved for data; see [`Data::shaped`].
#[derive(Clone, Debug, Default)]
pub struct ShapeConstraints {
    pub(crate) plane: Option<CurvePlane>,
    signs: Vec<Signed>,
    lines: Vec<CollinearPoints>,
    /// Control points of arcs.
    fixed: Vec<(usize, Vec3<f64>)>,
    /// Condition of each equation.
    arc_of: Vec<usize>,
    /// Spans that lines and arcs determine.
    determined: Vec<isize>,
    limits: Vec<(usize, Vec3<f64>, f64)>,
    sides: Vec<(usize, Vec3<f64>)>,
    /// Parts that turn in one direction, either of both.
    one_way: Vec<(usize, Vec<isize>)>,
    pieces: Option<(usize, usize)>,
    /// Required margin inside the signs, as a length.
    pub(crate) margin: f64,
    /// The arcs.
    pub arcs: Vec<FoundArc>,
}

/// Rows of Bézier points, one set for each half of the pieces.
fn halved(pieces: &[Vec<Vec<f64>>]) -> Vec<Vec<Vec<f64>>> {
    let middle = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).map(|(x, y)| 0.5 * (x + y)).collect();
    let mut out = Vec::with_capacity(2 * pieces.len());
    for piece in pieces {
        let (mut first, mut second) = (Vec::new(), Vec::new());
        let mut level = piece.clone();
        while let ([a, ..], Some(b)) = (&level[..], level.last()) {
            first.push(a.clone());
            second.push(b.clone());
            level = level.windows(2).map(|w| middle(&w[0], &w[1])).collect();
        }
        second.reverse();
        out.extend([first, second]);
    }
    out
}

/// The half-space in which a combination of control points is at most a distance along a direction.
fn half_space(
    rows: impl Iterator<Item = (usize, f64)>,
    direction: Vec3<f64>,
    most: f64,
    owner: usize,
) -> ControlInequality {
    let entries = rows.filter(|r| r.1 != 0.0).map(|(c, f)| (c, direction * f)).collect();
    ControlInequality { entries, most, owner }
}

fn refused(shape: usize, why: impl Into<String>) -> FairError {
    FairError::Shapeless { shape, why: why.into() }
}

/// Error for a run without enough points at its end for a change of curvature.
fn crowded(shape: usize, point: usize) -> FairError {
    refused(
        shape,
        format!(
            "too few points beside the end of a run, point {}, for another curvature",
            point + 1
        ),
    )
}

impl Data {
    /// The data with knots where straight runs and arcs begin and end, and the shape for them.
    ///
    /// # Errors
    /// [`FairError::Shapeless`] with the number of a condition that these data cannot meet.
    pub fn shaped(
        mut self,
        wanted: &[ShapeCondition],
    ) -> Result<(Self, ShapeConstraints), FairError> {
        let mut out = ShapeConstraints::default();
        if wanted.is_empty() {
            return Ok((self, out));
        }
        let n = self.points.len();
        let through = self.layout.through(&self.layout.data(&self.points))?;
        out.plane = CurvePlane::of(&self.layout.space, &through);
        let degree = self.layout.space.degree();
        let closed = self.layout.space.is_closed();
        let mut runs = Vec::new();
        for (owner, condition) in wanted.iter().enumerate() {
            use ShapeCondition as C;
            if let C::Turn { between, .. }
            | C::OneWay { between }
            | C::Straight { between, .. }
            | C::Arc { between } = condition
                && !(between[0] < between[1] && between[1] < n)
            {
                return Err(refused(
                    owner,
                    format!(
                        "expected a first and a later point of 1 to {n}, found {} and {}",
                        between[0] + 1,
                        between[1] + 1
                    ),
                ));
            }
            let flat = matches!(
                condition,
                C::Turn { .. } | C::OneWay { .. } | C::Arc { .. } | C::Pieces(_)
            );
            if flat && out.plane.is_none() {
                return Err(refused(
                    owner,
                    "a curve in space has no sign of curvature: shape its projections",
                ));
            }
            if flat && degree < 2 {
                return Err(refused(owner, "a polygon has no curvature"));
            }
            match condition {
                C::Straight { between, along } => {
                    let along = match along {
                        None => None,
                        Some(d) => Some(
                            d.normalized()
                                .ok_or_else(|| refused(owner, "the direction has no length"))?,
                        ),
                    };
                    runs.push((owner, *between, false, along));
                }
                C::Arc { between } => {
                    if between[1] - between[0] < 2 {
                        return Err(refused(owner, "an arc needs three points"));
                    }
                    if !matches!(self.limit.motion, Motion::Ball | Motion::Box) {
                        return Err(refused(
                            owner,
                            "an arc moves points along the curve too: do not state a direction of \
                            motion",
                        ));
                    }
                    runs.push((owner, *between, true, None));
                }
                C::Pieces(0) => return Err(refused(owner, "expected at least one piece")),
                C::Pieces(k) => out.pieces = Some((owner, *k)),
                C::Within { direction, most } => out.limit(owner, *direction, *most)?,
                C::OneSided { direction } => {
                    let unit = direction.normalized().filter(|d| d.is_finite());
                    let unit = unit.ok_or_else(|| refused(owner, "a side has a direction"))?;
                    out.sides.push((owner, unit));
                }
                C::Turn { .. } | C::OneWay { .. } => {}
            }
        }
        if !runs.is_empty() {
            if closed {
                return Err(refused(
                    runs[0].0,
                    "straight runs and arcs are for open curves: begin the curve elsewhere, or give \
                     it a break",
                ));
            }
            if degree != 3 {
                return Err(refused(runs[0].0, "straight runs and arcs are for cubics: degree 3"));
            }
            runs.sort_by_key(|r| r.1);
            out.runs(&mut self, &runs)?;
        }
        // Signs after the knots are final.
        let layout = &self.layout;
        for (owner, condition) in wanted.iter().enumerate() {
            out.turned(&layout.space, &layout.at, owner, condition);
        }
        Ok((self, out))
    }
}

type Run = (usize, [usize; 2], bool, Option<Vec3<f64>>);

impl ShapeConstraints {
    /// Adds a limit.
    fn limit(&mut self, owner: usize, direction: Vec3<f64>, most: f64) -> Result<(), FairError> {
        let size = direction.norm();
        if !(size > 0.0 && size.is_finite() && most.is_finite()) {
            return Err(refused(owner, "a limit has a direction and a number"));
        }
        self.limits.push((owner, direction * (1.0 / size), most / size));
        Ok(())
    }

    /// Adds the signs of a part that turns one way, of data at these parameters.
    fn turned(&mut self, space: &Space, at: &[f64], owner: usize, condition: &ShapeCondition) {
        let of = |between: &[usize; 2]| -> Vec<isize> {
            let [a, b] = between.map(|k| at[k]);
            let met = |&k: &isize| space.knot(k) < b && space.knot(k + 1) > a;
            space.spans().filter(met).filter(|k| !self.determined.contains(k)).collect()
        };
        match condition {
            ShapeCondition::Turn { between, left } => {
                let signed = |span: isize| Signed {
                    span,
                    what: SignedQuantity::Turn,
                    positive: *left,
                    slack: 0.0,
                    owner,
                };
                let own: Vec<Signed> = of(between).into_iter().map(signed).collect();
                self.signs.extend(own);
            }
            ShapeCondition::OneWay { between } => {
                let spans = of(between);
                self.one_way.push((owner, spans));
            }
            _ => {}
        }
    }

    /// True without conditions.
    pub fn is_empty(&self) -> bool {
        self.signs.is_empty()
            && self.lines.is_empty()
            && self.fixed.is_empty()
            && self.limits.is_empty()
            && self.sides.is_empty()
            && self.one_way.is_empty()
            && self.pieces.is_none()
    }

    fn bezier(&self, space: &Space, span: isize, control: &[Vec3<f64>]) -> Vec<P<f64>> {
        let plane = self.plane.expect("signs of curvature require a plane curve");
        let columns: Vec<usize> = space.columns(span).collect();
        let local: Vec<P<f64>> = columns.iter().map(|&c| plane.down(control[c])).collect();
        let point = |row: Vec<f64>| {
            let both = row.iter().zip(&local);
            both.fold([0.0; 2], |s, (f, p)| [s[0] + f * p[0], s[1] + f * p[1]])
        };
        space.bezier_of(span).into_iter().map(point).collect()
    }

    /// Straight runs and arcs: knots where they meet, control points that they hold.
    fn runs(&mut self, data: &mut Data, runs: &[Run]) -> Result<(), FairError> {
        let last = data.points.len() - 1;
        let breaks = data.layout.break_data();
        check_runs(runs, &breaks, last)?;
        let chains = chains_of(runs, &breaks);
        let plane = self.plane;
        let mut placed_at: Vec<Option<(Chain, Vec<f64>)>> = Vec::new();
        let mut at = data.layout.at.clone();
        for group in &chains {
            if !group.iter().any(|r| r.2) {
                placed_at.push(None);
                continue;
            }
            // Speed along a chain is even, so that cubics follow its arcs as closely as they can.
            let made = placed(data, plane.expect("an arc requires a plane curve"), group)?;
            let (from, to) = (group[0].1[0], group[group.len() - 1].1[1]);
            let (first, rate) = (at[from], (at[to] - at[from]) / (made.1[to - from] - made.1[0]));
            for k in from + 1..to {
                at[k] = first + rate * (made.1[k - from] - made.1[0]);
            }
            placed_at.push(Some(made));
        }
        if at != data.layout.at {
            let marks = data.layout.break_data();
            data.layout = InterpolationSpace::new(data.layout.space.degree(), &at, &marks, false)?;
        }
        let mut found: Vec<Option<(Chain, Vec<f64>)>> = Vec::new();
        for (group, made) in chains.iter().zip(placed_at) {
            let Some(made) = made else {
                // Outside a single line the curvature may differ.
                for k in group[0].1 {
                    let inside = |m: usize| group[0].1[0] < m && m < group[0].1[1];
                    if k != 0
                        && k != last
                        && !breaks.contains(&k)
                        && !data.layout.doubled(k, None, inside)?
                    {
                        return Err(crowded(group[0].0, k));
                    }
                }
                found.push(None);
                continue;
            };
            for (&s, pair) in made.0.joints().iter().zip(group.windows(2)) {
                let (from, to) = (group[0].1[0], group[group.len() - 1].1[1]);
                let k = (from..to).rfind(|&k| made.1[k - from] <= s).unwrap_or(from);
                let share = (s - made.1[k - from]) / (made.1[k + 1 - from] - made.1[k - from]);
                let share = if share.abs() < 1e-9 { None } else { Some(share) };
                let lines: Vec<[usize; 2]> = pair.iter().filter(|r| !r.2).map(|r| r.1).collect();
                let inside = |m: usize| lines.iter().any(|l| l[0] <= m && m <= l[1]);
                if !data.layout.doubled(k, share, inside)? {
                    return Err(crowded(pair[1].0, k));
                }
            }
            found.push(Some(made));
        }
        for (group, made) in chains.iter().zip(found) {
            match made {
                None => {
                    let (owner, between, _, along) = group[0];
                    let ends = between.map(|k| data.layout.at[k]);
                    let points = self.taken(&data.layout.space, ends);
                    self.lines.push(CollinearPoints { points, along, through: None, owner });
                }
                Some(made) => {
                    let plane = plane.expect("an arc requires a plane curve");
                    self.hold(data, plane, group, &made)?;
                }
            }
        }
        Ok(())
    }

    /// The control points of the spans between two parameters, which are determined from here on.
    fn taken(&mut self, space: &Space, [a, b]: [f64; 2]) -> Vec<usize> {
        let slack = 1e-12 * (b - a);
        let spans: Vec<isize> = space
            .spans()
            .filter(|&k| {
                let middle = 0.5 * (space.knot(k) + space.knot(k + 1));
                middle > a - slack && middle < b + slack
            })
            .collect();
        let mut points: Vec<usize> = spans.iter().flat_map(|&k| space.columns(k)).collect();
        points.sort_unstable();
        points.dedup();
        self.determined.extend(spans);
        points
    }

    /// Fixes the control points of a chain: those of arcs exactly, others on their lines.
    fn hold(
        &mut self,
        data: &Data,
        plane: CurvePlane,
        group: &[Run],
        (chain, feet): &(Chain, Vec<f64>),
    ) -> Result<(), FairError> {
        let space = &data.layout.space;
        let at = &data.layout.at;
        let (from, to) = (group[0].1[0], group[group.len() - 1].1[1]);
        let count = group.len();
        // The parameter at an arc length, and how fast arc length grows there.
        let place = |s: f64| -> (f64, f64) {
            let k = (from..to).rfind(|&k| feet[k - from] <= s).unwrap_or(from);
            let rate = (feet[k + 1 - from] - feet[k - from]) / (at[k + 1] - at[k]);
            (at[k] + (s - feet[k - from]) / rate, rate)
        };
        // The feet are spaced as the parameters are.
        let even = place(feet[0]).1;
        let joints = chain.joints();
        let ends = |k: usize| -> [(f64, f64, bool); 2] {
            let inner = |s: f64| {
                let (t, rate) = place(s);
                (t, rate, true)
            };
            let outer = |i: usize| {
                let (_, rate) = place(feet[i - from]);
                (at[i], rate, i != 0 && i + 1 != at.len())
            };
            [
                if k == 0 { outer(from) } else { inner(joints[k - 1]) },
                if k + 1 == count { outer(to) } else { inner(joints[k]) },
            ]
        };
        for (k, run) in group.iter().enumerate().filter(|(_, r)| r.2) {
            let both = ends(k);
            let points = self.taken(space, both.map(|e| e.0));
            let spans: Vec<isize> = {
                let held = |s: &isize| {
                    let middle = 0.5 * (space.knot(*s) + space.knot(*s + 1));
                    middle > both[0].0 && middle < both[1].0
                };
                space.spans().filter(held).collect()
            };
            let n = points.len();
            let mut rows: Vec<ArcRow> = Vec::new();
            let row = |t: f64, order: usize, span: isize| -> Vec<f64> {
                let basis = space.basis(span, t);
                let mut out = vec![0.0; n];
                for (c, &b) in space.columns(span).zip(basis.rows[order].iter()) {
                    out[points.iter().position(|&p| p == c).expect("a point of the span")] = b;
                }
                out
            };
            for (side, &(t, rate, tangent)) in both.iter().enumerate() {
                let span = if side == 0 { spans[0] } else { spans[spans.len() - 1] };
                let s = match (side, k) {
                    (0, 0) => feet[0],
                    (0, k) => joints[k - 1],
                    (_, k) if k + 1 == count => feet[to - from],
                    (_, k) => joints[k],
                };
                let (p, d) = chain.at(s);
                rows.push((row(t, 0, span), p));
                if tangent {
                    rows.push((row(t, 1, span), d.map(|c| c * rate)));
                }
            }
            if rows.len() > n {
                return Err(refused(run.0, "an arc needs more points between its ends"));
            }
            // Between its ends the spline has approximately the second derivative of the arc, since
            // curvature defines an arc. Positions then agree to a higher order.
            let mut near: Vec<ArcRow> = Vec::new();
            for &span in &spans {
                let (a, b) = (space.knot(span), space.knot(span + 1));
                for (t, weight) in moldloft_num::gauss_points(a, b) {
                    let d = chain.at(feet[0] + (t - at[from]) * even).1;
                    let bend = chain.pieces[k].curvature * even * even;
                    let root = weight.sqrt();
                    let own = row(t, 2, span).into_iter().map(|x| x * root).collect();
                    near.push((own, [-d[1] * bend * root, d[0] * bend * root]));
                }
            }
            let solved = constrained(n, &near, &rows).ok_or_else(|| {
                refused(run.0, "the points of the arc determine no spline: more of them")
            })?;
            let [x, y] = solved;
            let right: Vec<Vec3<f64>> =
                x.into_iter().zip(y).map(|(x, y)| Vec3::of(x, y, 0.0)).collect();
            for (&c, p) in points.iter().zip(&right) {
                if !self.fixed.iter().any(|f| f.0 == c) {
                    self.fixed.push((c, plane.up([p.x, p.y])));
                    self.arc_of.push(run.0);
                }
            }
            self.check(data, plane, run, chain, k, (&points, &right, &spans))?;
        }
        for (k, run) in group.iter().enumerate().filter(|(_, r)| !r.2) {
            let both = ends(k);
            let mut points = self.taken(space, both.map(|e| e.0));
            points.retain(|c| !self.fixed.iter().any(|f| f.0 == *c));
            let piece = chain.pieces[k];
            let along = Some(plane.turned(piece.at(0.0).1));
            let (owner, through) = (run.0, Some(plane.up(piece.start)));
            self.lines.push(CollinearPoints { points, along, through, owner });
        }
        Ok(())
    }

    /// Distance of the spline of an arc from its circle, and the difference of curvature.
    fn check(
        &mut self,
        data: &Data,
        plane: CurvePlane,
        run: &Run,
        chain: &Chain,
        part: usize,
        (points, control, spans): (&[usize], &[Vec3<f64>], &[isize]),
    ) -> Result<(), FairError> {
        let space = &data.layout.space;
        let piece = chain.pieces[part];
        let radius = 1.0 / piece.curvature.abs();
        let left = [-libm::sin(piece.angle), libm::cos(piece.angle)].map(|c| c / piece.curvature);
        let centre = [piece.start[0] + left[0], piece.start[1] + left[1]];
        let mut all = vec![Vec3::zero(); data.layout.space.count()];
        for (&c, &p) in points.iter().zip(control) {
            all[c] = p;
        }
        let (mut off, mut bend) = (0.0f64, 0.0f64);
        for &k in spans {
            for i in 0..=64 {
                let share = f64::from(i) / 64.0;
                let t = space.knot(k) * (1.0 - share) + space.knot(k + 1) * share;
                let sample = shape::sample_in(space, &all, None, k, t);
                let p = sample.point;
                off = off.max((libm::hypot(p.x - centre[0], p.y - centre[1]) - radius).abs());
                bend = bend.max((sample.curvature() * radius - 1.0).abs());
            }
        }
        if bend > 0.01 {
            return Err(refused(
                run.0,
                format!(
                    "with so few points the curvature of a cubic differs by {:.1} % from that of \
                     the arc: more points on it",
                    100.0 * bend
                ),
            ));
        }
        self.arcs.push(FoundArc { between: run.1, radius, centre: plane.up(centre), off });
        Ok(())
    }
}

/// Refuses runs that overlap, two straight ones that meet without a break, and ends of runs that
/// leave too few points to breaks or the ends of the data.
fn check_runs(runs: &[Run], breaks: &[usize], last: usize) -> Result<(), FairError> {
    for w in runs.windows(2) {
        if w[1].1[0] < w[0].1[1] {
            return Err(refused(w[1].0, format!("point {} is in two runs", w[1].1[0] + 1)));
        }
        let meet = w[0].1[1] == w[1].1[0] && !breaks.contains(&w[1].1[0]);
        if meet && !w[0].2 && !w[1].2 {
            let why =
                format!("two straight runs meet at point {0}: add it to the breaks", w[1].1[0] + 1);
            return Err(refused(w[1].0, why));
        }
    }
    for &(owner, [a, b], _, _) in runs {
        let alone = |k: usize| !breaks.contains(&k) && k != 0 && k != last;
        if (a == 1 && alone(1)) || (b + 1 == last && alone(b)) {
            let why = "a run ends at an end of the data, or three points from it";
            return Err(refused(owner, why));
        }
        let beside = |k: usize, other: usize| alone(k) && breaks.contains(&other);
        if let Some(k) = [(a, a.wrapping_sub(1)), (b, b + 1)]
            .into_iter()
            .find_map(|(k, other)| beside(k, other).then_some(other))
        {
            let why = format!("a run ends at a break, or three points from it: point {}", k + 1);
            return Err(refused(owner, why));
        }
    }
    Ok(())
}

/// Runs that touch an arc are found together with it.
fn chains_of(runs: &[Run], breaks: &[usize]) -> Vec<Vec<Run>> {
    let mut chains: Vec<Vec<Run>> = Vec::new();
    for run in runs {
        let joins = chains.last().and_then(|c| c.last()).is_some_and(|before| {
            let near = run.1[0] - before.1[1];
            let sharp = near == 0 && breaks.contains(&run.1[0]);
            near <= 1 && !sharp && (before.2 || run.2)
        });
        match chains.last_mut() {
            Some(c) if joins => c.push(*run),
            _ => chains.push(vec![*run]),
        }
    }
    chains
}

/// A row of factors of control points, and the point that it takes.
type ArcRow = (Vec<f64>, P<f64>);

/// Coordinates of `n` control points that take the rows `exact`, and `near` in the mean of squares.
fn constrained(n: usize, near: &[ArcRow], exact: &[ArcRow]) -> Option<[Vec<f64>; 2]> {
    let m = exact.len();
    let size: f64 = near.iter().flat_map(|r| &r.0).map(|x| x * x).sum();
    let mut solved = [Vec::new(), Vec::new()];
    for (axis, column) in solved.iter_mut().enumerate() {
        let mut matrix = vec![0.0; (n + m) * (n + m)];
        *column = vec![0.0; n + m];
        for (own, wanted) in near {
            for i in 0..n {
                column[i] += own[i] * wanted[axis] / size;
                for j in 0..n {
                    matrix[i * (n + m) + j] += own[i] * own[j] / size;
                }
            }
        }
        for (r, row) in exact.iter().enumerate() {
            let largest = row.0.iter().fold(0.0f64, |a, x| a.max(x.abs()));
            column[n + r] = row.1[axis] / largest;
            for i in 0..n {
                matrix[i * (n + m) + n + r] = row.0[i] / largest;
                matrix[(n + r) * (n + m) + i] = row.0[i] / largest;
            }
        }
        moldloft_num::solve_dense(&mut matrix, column).ok()?;
        column.truncate(n);
    }
    Some(solved)
}

/// The chain of a group of runs, and the feet of its data.
fn placed(data: &Data, plane: CurvePlane, group: &[Run]) -> Result<(Chain, Vec<f64>), FairError> {
    let points: Vec<P<f64>> = data.points.iter().map(|&p| plane.down(p)).collect();
    let part = |&(_, between, arc, along): &Run| {
        let angle = along.map(|d| {
            let [x, y] = plane.axes.map(|a| a.dot(d));
            let (p, q) = (points[between[0]], points[between[1]]);
            let back = (q[0] - p[0]) * x + (q[1] - p[1]) * y < 0.0;
            if back { libm::atan2(-y, -x) } else { libm::atan2(y, x) }
        });
        ChainElement { arc, between, angle }
    };
    let parts: Vec<ChainElement> = group.iter().map(part).collect();
    let found = chain(&points, &data.limit.radii, parts).map_err(|(part, point, off)| {
        let what = if group[part].2 { "arc" } else { "straight run" };
        refused(
            group[part].0,
            format!("point {} is {off:.3e} from the {what} fitted to its points", point + 1),
        )
    })?;
    let (from, to) = (group[0].1[0], group[group.len() - 1].1[1]);
    let mut feet: Vec<f64> = Vec::new();
    // Maximum distance along the chain between a point and its foot.
    let mut rooms: Vec<f64> = Vec::new();
    let near = |k: usize| group.iter().position(|r| r.1[0] <= k && k <= r.1[1]).unwrap_or(0);
    for (k, &p) in points.iter().enumerate().take(to + 1).skip(from) {
        let (s, d) = found.foot(p, near(k));
        let radius = data.limit.radii[k];
        if d > radius {
            let why = format!("point {} is {d:.3e} from the arc and its tangents", k + 1);
            return Err(refused(group[near(k)].0, why));
        }
        feet.push(s);
        rooms.push(ROOM * (radius * radius - d * d).sqrt());
    }
    let feet = in_order(feet, &rooms).map_err(|k| {
        let k = from + k;
        let why = format!("point {} is behind the point before it along the arc", k + 1);
        refused(group[near(k)].0, why)
    })?;
    Ok((found, feet))
}

/// Fraction of the possible distance, by the tolerance, that a point may have from its foot along a
/// chain.
const ROOM: f64 = 0.9;

impl ShapeConstraints {
    /// The equations of lines and arcs, made linear at a curve, and whose they are.
    pub(crate) fn conditions(&self, control: &[Vec3<f64>]) -> Vec<(Condition, usize)> {
        let mut all = Vec::new();
        for (&(c, p), &owner) in self.fixed.iter().zip(&self.arc_of) {
            let plane = self.plane.expect("an arc requires a plane curve");
            for axis in plane.axes {
                let entries = vec![(c, axis)];
                all.push((Condition { entries, value: axis.dot(p) }, owner));
            }
        }
        for line in &self.lines {
            all.extend(self.line(line, control).into_iter().map(|c| (c, line.owner)));
        }
        all
    }

    fn line(&self, line: &CollinearPoints, control: &[Vec3<f64>]) -> Vec<Condition> {
        let mut out = Vec::new();
        {
            let [a, .., b] = line.points[..] else {
                if let (Some(d), Some(p), &[c]) = (line.along, line.through, &line.points[..]) {
                    for axis in self.across(d) {
                        out.push(Condition { entries: vec![(c, axis)], value: axis.dot(p) });
                    }
                }
                return out;
            };
            let chord = control[b] - control[a];
            let along = line.along.unwrap_or(chord);
            for axis in self.across(along) {
                for &c in &line.points {
                    if let Some(p) = line.through {
                        out.push(Condition { entries: vec![(c, axis)], value: axis.dot(p) });
                    } else if c != a && line.along.is_some() {
                        out.push(Condition { entries: vec![(a, -axis), (c, axis)], value: 0.0 });
                    } else if c != a && c != b {
                        // ((c - a) x (b - a)) . e with e across the chord and across the axis.
                        let e = chord.cross(axis).normalized().unwrap_or_default();
                        let own = control[c] - control[a];
                        let (by_b, by_c) = (e.cross(own), chord.cross(e));
                        let size = 1.0 / chord.norm();
                        let entries =
                            vec![(a, (by_b + by_c) * -size), (c, by_c * size), (b, by_b * size)];
                        let mut condition = Condition { entries, value: 0.0 };
                        let now = own.cross(chord).dot(e) * size;
                        condition.value = condition.at(control) - now;
                        out.push(condition);
                    }
                }
            }
        }
        out
    }

    /// The axes across a line: one in the plane of a plane curve.
    fn across(&self, along: Vec3<f64>) -> Vec<Vec3<f64>> {
        match self.plane {
            Some(plane) => plane.normal().cross(along).normalized().into_iter().collect::<Vec<_>>(),
            None => {
                let (a, b) = crate::curve::condition::across(along);
                vec![a, b]
            }
        }
    }

    /// Half-spaces of signs, limits and sides, linearised at a curve; those that concern fixed
    /// points only are left out.
    pub(crate) fn halves(
        &self,
        data: &Data,
        frozen: &[bool],
        control: &[Vec3<f64>],
    ) -> Vec<ControlInequality> {
        let space = &data.layout.space;
        let mut out: Vec<ControlInequality> = self
            .signs
            .iter()
            .flat_map(|sign| self.linear(space, sign, control))
            .map(|(half, _)| ControlInequality { most: half.most - self.margin, ..half })
            .chain(self.beyond(data))
            .collect();
        out.retain(|h| h.entries.iter().any(|(c, _)| !frozen[*c]));
        out
    }

    /// The half-spaces of limits.
    fn limited(&self, space: &Space) -> Vec<ControlInequality> {
        let mut out = Vec::new();
        for &(owner, d, most) in &self.limits {
            for span in space.spans() {
                // Bézier points of quarters: those of whole spans are too far from the curve where
                // it turns away from its limit.
                for row in halved(&halved(&[space.bezier_of(span)])).into_iter().flatten() {
                    out.push(half_space(space.columns(span).zip(row), d, most, owner));
                }
            }
        }
        out
    }

    /// The half-spaces of limits and sides.
    fn beyond(&self, data: &Data) -> Vec<ControlInequality> {
        let mut out = self.limited(&data.layout.space);
        for &(owner, d) in &self.sides {
            for (k, owned) in data.layout.owner.iter().enumerate() {
                let Some(i) = *owned else { continue };
                if data.limit.radii[i] > 0.0 {
                    let (columns, factors) = data.layout.rows.row(k);
                    let own = columns.iter().map(|&c| c as usize).zip(factors.iter().copied());
                    out.push(half_space(own, d, d.dot(data.points[i]), owner));
                }
            }
        }
        out
    }

    /// Coefficients of a sign as half-spaces, and their present values: lengths, negative where the
    /// sign is violated.
    fn linear(
        &self,
        space: &Space,
        sign: &Signed,
        control: &[Vec3<f64>],
    ) -> Vec<(ControlInequality, f64)> {
        let plane = self.plane.expect("signs of curvature require a plane curve");
        let columns: Vec<usize> = space.columns(sign.span).collect();
        let rows = space.bezier_of(sign.span);
        let factor = if sign.positive { 1.0 } else { -1.0 };
        let all = sign.what.linear(&self.bezier(space, sign.span, control));
        let half = |(value, slope): (f64, Vec<P<f64>>)| {
            let mut entries: Vec<(usize, Vec3<f64>)> = Vec::new();
            for (j, &c) in columns.iter().enumerate() {
                let both = rows.iter().zip(&slope);
                let sum =
                    both.fold([0.0; 2], |s, (row, d)| [s[0] + row[j] * d[0], s[1] + row[j] * d[1]]);
                entries.push((c, plane.turned(sum) * -factor));
            }
            let size: f64 = entries.iter().map(|(_, f)| f.norm()).sum();
            if size == 0.0 || !size.is_finite() {
                return None;
            }
            for (_, f) in &mut entries {
                *f = *f * (1.0 / size);
            }
            let now = (factor * value + sign.slack) / size;
            let sum: f64 = entries.iter().map(|(c, f)| f.dot(control[*c])).sum();
            Some((ControlInequality { entries, most: sum + now, owner: sign.owner }, now))
        };
        all.into_iter().filter_map(half).collect()
    }

    /// Largest violation of a curve, as a length, and the condition it belongs to. Equations hold
    /// within `slack`.
    pub(crate) fn miss(&self, data: &Data, control: &[Vec3<f64>], slack: f64) -> (f64, usize) {
        let mut worst = (0.0, 0);
        let mut found = |off: f64, owner: usize| {
            if off > worst.0 || off.is_nan() {
                worst = (off, owner);
            }
        };
        let space = &data.layout.space;
        for sign in &self.signs {
            for (_, now) in self.linear(space, sign, control) {
                found(-now, sign.owner);
            }
        }
        for line in &self.lines {
            let [a, .., b] = line.points[..] else { continue };
            let along = line.along.unwrap_or(control[b] - control[a]);
            let from = line.through.unwrap_or(control[a]);
            for axis in self.across(along) {
                for &c in &line.points {
                    found(axis.dot(control[c] - from).abs() - slack, line.owner);
                }
            }
        }
        for (&(c, p), &owner) in self.fixed.iter().zip(&self.arc_of) {
            found((control[c] - p).norm() - slack, owner);
        }
        for half in self.beyond(data) {
            let sum: f64 = half.entries.iter().map(|(c, f)| f.dot(control[*c])).sum();
            found(sum - half.most, half.owner);
        }
        worst
    }

    /// A curve to make signs and lines linear at: the control points of lines on lines.
    pub(crate) fn projected(&self, control: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let mut out = control.to_vec();
        for &(c, p) in &self.fixed {
            out[c] = p;
        }
        for line in &self.lines {
            let [a, .., b] = line.points[..] else { continue };
            let along = line.along.unwrap_or(control[b] - control[a]);
            let Some(along) = along.normalized() else { continue };
            let from = line.through.unwrap_or(control[a]);
            for &c in &line.points {
                out[c] = from + along * along.dot(out[c] - from);
            }
        }
        out
    }

    /// The shape with the signs of a curve for its parts that turn in one direction, and with
    /// pieces if that curve has them.
    pub(crate) fn by(&self, space: &Space, control: &[Vec3<f64>]) -> Self {
        let mut out = self.clone();
        let normal = self.plane.map(|p| p.normal());
        for (owner, spans) in &self.one_way {
            let turn: f64 = spans
                .iter()
                .flat_map(|&k| SignedQuantity::Turn.coefficients(&self.bezier(space, k, control)))
                .sum();
            out.signs.extend(spans.iter().map(|&span| Signed {
                span,
                what: SignedQuantity::Turn,
                positive: turn >= 0.0,
                slack: 0.0,
                owner: *owner,
            }));
        }
        if let (Some((owner, count)), Some(normal)) = (self.pieces, normal) {
            let all = shape::curvatures(&shape::samples(space, control, None, 16));
            let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let range = most - all.iter().copied().fold(f64::INFINITY, f64::min);
            let p = space.degree() as f64;
            for (span, positive) in runs_of(space, control, normal, count) {
                if self.determined.contains(&span) {
                    continue;
                }
                // The curvature's slope by the parameter of the span is its numerator over the
                // fifth power of the length.
                let bezier = self.bezier(space, span, control);
                let length: f64 = bezier
                    .windows(2)
                    .map(|w| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]))
                    .sum();
                let slack = UNCOUNTED * range * length.powi(5) / (p.powi(4) * (p - 1.0));
                out.signs.push(Signed {
                    span,
                    what: SignedQuantity::Slope,
                    positive,
                    slack,
                    owner,
                });
            }
        }
        out.one_way.clear();
        out.pieces = None;
        out
    }

    /// Maximum number of pieces, if given.
    pub(crate) fn most_pieces(&self) -> Option<usize> {
        self.pieces.map(|(_, most)| most)
    }

    /// The shape but for its count of pieces.
    pub(crate) fn without_pieces(&self) -> Self {
        Self { pieces: None, ..self.clone() }
    }

    /// The condition and the number of pieces of a curve, if there are too many.
    pub(crate) fn counted(&self, space: &Space, control: &[Vec3<f64>]) -> Option<(usize, usize)> {
        let (owner, most) = self.pieces?;
        let all = shape::pieces(space, control);
        (all > most).then_some((owner, all))
    }
}
