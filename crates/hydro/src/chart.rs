//! Charts: pieces of a subsurface between the lines at which the parent surface is not smooth.
//! A subsurface maps its parameters to those of its parent, so these lines cross its parameter
//! square at any angle. The square is cut along one line after another. Where a line is a graph
//! over one parameter, it is approximated by a polynomial in that parameter, and the pieces on both
//! sides are mapped to unit squares, one side of which may have zero length. Where it is not a
//! graph, as near a turning point, the square is quartered.

use crate::trimmed::{TrimLoops, trimmed_charts};
use moldloft_num::period::breaks_between;
use moldloft_num::{Bi1, InnerPlane, Jet, Order, Real, Surface, find_root};

/// A map from the unit square to a piece of the parameter square of a surface that no inner line
/// crosses.
#[derive(Clone, Debug)]
pub(crate) struct Chart<T> {
    cuts: Vec<ChartCut<T>>,
    /// For u and v, true if its places may be beyond 0 and 1.
    closed: [bool; 2],
    /// True for each of the edges v = 0, u = 1, v = 1, u = 0 of the surface that it reaches.
    pub border: [bool; 4],
}

/// A map from the unit square into another one.
#[derive(Clone, Debug)]
struct ChartCut<T> {
    /// The parameter, 0 or 1, from one boundary to the other.
    along: usize,
    /// The range of the other parameter.
    range: [f64; 2],
    /// The steps from one boundary to the other.
    graded: GradedSteps,
    /// Both boundaries, as functions of the relative position of the other parameter in its range.
    sides: [ChartBoundary<T>; 2],
}

/// A polynomial on [0, 1] in Chebyshev form.
#[derive(Clone, Debug)]
pub(crate) struct ChartBoundary<T>(Vec<T>);

/// A monotonic map of [0, 1] to itself, with slope zero at the chosen ends.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GradedSteps {
    pub ends: [bool; 2],
}

impl GradedSteps {
    pub fn at<J: Real>(self, s: J) -> J {
        match self.ends {
            [false, false] => s,
            [true, false] => s * s,
            [false, true] => s * (-s + 2.0),
            [true, true] => s * s * (s * -2.0 + 3.0),
        }
    }

    /// Its derivative.
    pub fn slope(self, s: f64) -> f64 {
        match self.ends {
            [false, false] => 1.0,
            [true, false] => 2.0 * s,
            [false, true] => 2.0 - 2.0 * s,
            [true, true] => 6.0 * s * (1.0 - s),
        }
    }
}

/// A line of constant parameter: coordinate `axis` of parameter plane `plane` is `at`.
#[derive(Clone, Copy, Debug)]
struct InnerLine {
    plane: usize,
    axis: usize,
    at: f64,
}

/// Number of coefficients of a boundary.
const NODES: usize = 16;

/// Number of sampling intervals of a square in each direction.
const STEPS: usize = 16;

/// Distance, in parameters, within which a point is on a line.
const ON_LINE: f64 = 1e-11;

/// Maximum slope of a line that is treated as a graph, in steps across per step along.
const STEEPEST: f64 = 3.0;

/// Tolerance of a boundary of a surface's part, relative to the square.
pub(crate) const BOUNDARY_FIT: f64 = 1e-11;

/// Tolerance of a boundary between two charts, relative to the square: a crease that is as far
/// beside it changes areas by the square of this.
const CREASE_FIT: f64 = 1e-8;

/// Maximum number of quarterings of a square and of halvings of a boundary.
pub(crate) const DEEPEST: u32 = 14;

/// Distance from a line at which one side of it is evaluated, relative to the square.
const BESIDE: f64 = 1e-9;

/// Parameters at which a boundary is compared with its line.
pub(crate) const PROBES: [f64; 4] = [0.003, 0.31, 0.77, 0.997];

impl<T: Real> ChartBoundary<T> {
    pub fn constant(value: T) -> Self {
        Self(vec![value])
    }

    pub fn at<J: Jet<T>>(&self, t: J) -> J {
        let [first, rest @ ..] = &*self.0 else { return J::zero() };
        let x = t * 2.0 - 1.0;
        let (mut next, mut after) = (J::zero(), J::zero());
        for &c in rest.iter().rev() {
            (next, after) = (x * next * 2.0 - after + J::fixed(c), next);
        }
        x * next - after + J::fixed(*first)
    }

    /// The polynomial with these values at the roots of the Chebyshev polynomial of degree [`NODES`].
    pub fn through(values: &[T; NODES]) -> Self {
        let coefficient = |k: usize| {
            let sum = (0..NODES).fold(T::zero(), |sum, j| {
                let angle = std::f64::consts::PI * (k as f64) * (j as f64 + 0.5) / NODES as f64;
                sum + values[j] * libm::cos(angle)
            });
            sum * (if k == 0 { 1.0 } else { 2.0 } / NODES as f64)
        };
        Self((0..NODES).map(coefficient).collect())
    }

    /// This polynomial without its last coefficients, where they are rounding.
    pub fn shortened(mut self) -> Self {
        let negligible = |c: &T| (0..T::PARTS).all(|part| c.probe(part).abs() < 1e-16);
        while self.0.len() > 1 && self.0.last().is_some_and(negligible) {
            self.0.pop();
        }
        self
    }
}

/// The roots of that polynomial on [0, 1].
pub(crate) fn nodes() -> [f64; NODES] {
    std::array::from_fn(|j| {
        let half = std::f64::consts::FRAC_PI_2 * (j as f64 + 0.5) / NODES as f64;
        // From 1 down to 0, in the order of the cosines of the coefficients.
        libm::pow(libm::cos(half), 2.0)
    })
}

impl<T: Real> Chart<T> {
    /// The rectangle [u0, u1] x [v0, v1].
    fn rectangle([u0, u1, v0, v1]: [T; 4]) -> Self {
        let cut = |along: usize, a: T, b: T| ChartCut {
            along,
            range: [0.0, 1.0],
            graded: GradedSteps::default(),
            sides: [ChartBoundary(vec![a]), ChartBoundary(vec![b])],
        };
        let border = [v0.re() == 0.0, u1.re() == 1.0, v1.re() == 1.0, u0.re() == 0.0];
        Self { cuts: vec![cut(0, u0, u1), cut(1, v0, v1)], closed: [false; 2], border }
    }

    /// The part of a trapezoid between two values of the parameter `w`, over a range of its steps
    /// along w; `sides` are its boundaries there.
    pub fn trapezoid(
        w: usize,
        ends: [T; 2],
        graded: GradedSteps,
        range: [f64; 2],
        sides: [ChartBoundary<T>; 2],
        closed: [bool; 2],
    ) -> Self {
        let along_w = ChartCut {
            along: w,
            range: [0.0, 1.0],
            graded,
            sides: ends.map(ChartBoundary::constant),
        };
        let across = ChartCut { along: 1 - w, range, graded: GradedSteps::default(), sides };
        Self { cuts: vec![along_w, across], closed, border: [false; 4] }
    }

    /// The point in the parameter square of the surface.
    pub fn at<J: Jet<T>>(&self, place: [J; 2]) -> [J; 2] {
        self.cuts.iter().rev().fold(place, |p, cut| {
            let share = p[1 - cut.along];
            let [low, high] = cut.sides.each_ref().map(|side| side.at(share));
            let mut out = p;
            out[cut.along] = low + (high - low) * cut.graded.at(p[cut.along]);
            let [from, to] = cut.range;
            out[1 - cut.along] =
                if [from, to] == [0.0, 1.0] { share } else { share * (to - from) + from };
            out
        })
    }

    /// The point at these parameters without derivatives.
    pub fn real(&self, place: [f64; 2]) -> [f64; 2] {
        let [u, v] = self.at(place.map(T::from)).map(T::re);
        let within = |w: f64, closed: bool| if closed { w } else { w.clamp(0.0, 1.0) };
        [within(u, self.closed[0]), within(v, self.closed[1])]
    }

    /// The part between two boundaries along a parameter, over a range of the other.
    fn part(&self, along: usize, range: [f64; 2], sides: [Option<ChartBoundary<T>>; 2]) -> Self {
        let reaches = [sides[0].is_none(), sides[1].is_none()];
        // Indices in `border` of the sides 0 and 1 of each parameter.
        let of_sides = [[3, 1], [0, 2]];
        let mut border = self.border;
        for end in 0..2 {
            border[of_sides[along][end]] &= reaches[end];
            border[of_sides[1 - along][end]] &= range[end] == end as f64;
        }
        let [low, high] = sides;
        let end = |side: Option<ChartBoundary<T>>, at: f64| {
            side.unwrap_or_else(|| ChartBoundary(vec![T::from(at)]))
        };
        let mut cuts = self.cuts.clone();
        let sides = [end(low, 0.0), end(high, 1.0)];
        cuts.push(ChartCut { along, range, graded: GradedSteps::default(), sides });
        Self { cuts, closed: self.closed, border }
    }
}

/// The charts of a surface or, with loops, of its part within them; `Some(None)` for a whole
/// surface without inner lines, `None` for loops that bound no part. `us` and `vs` are the cell
/// boundaries at its own joints.
pub(crate) fn charts<T: Real>(
    surface: &dyn Surface<T>,
    loops: Option<&TrimLoops<'_, T>>,
    [us, vs]: [&[T]; 2],
) -> Option<Option<Vec<Chart<T>>>> {
    let planes = surface.inner_planes();
    let none = |plane: &InnerPlane<'_>| {
        plane.joints.iter().all(Vec::is_empty) && plane.closed == [false; 2]
    };
    let whole = planes.iter().all(none);
    let charts = match loops {
        Some(loops) => trimmed_charts(surface, loops)?,
        None if whole => return Some(None),
        None => {
            let pairs =
                |u: &[T]| vs.windows(2).map(|v| [u[0], u[1], v[0], v[1]]).collect::<Vec<_>>();
            us.windows(2).flat_map(pairs).map(Chart::rectangle).collect()
        }
    };
    if whole {
        return Some(Some(charts));
    }
    let mut cutter = Cutter { surface, planes, charts: Vec::new() };
    for chart in charts {
        let lines = cutter.lines(&chart);
        cutter.cut(chart, lines, 0);
    }
    Some(Some(cutter.charts))
}

struct Cutter<'a, T: Real> {
    surface: &'a dyn Surface<T>,
    planes: Vec<InnerPlane<'a>>,
    charts: Vec<Chart<T>>,
}

/// Signed distances from a line on a grid of a square.
struct LineSamples(Vec<f64>);

/// A line that is a graph of one parameter over the other.
struct LineGraph {
    along: usize,
    /// Maximum slope, in steps across per step along.
    steepest: f64,
}

impl LineSamples {
    /// The distance at step `i` of one parameter and step `j` of the other.
    fn at(&self, along: usize, i: usize, j: usize) -> f64 {
        let (i, j) = if along == 0 { (i, j) } else { (j, i) };
        let x = self.0[i * (STEPS + 1) + j];
        if x.abs() <= ON_LINE { 0.0 } else { x }
    }

    fn crosses(&self) -> bool {
        self.0.iter().any(|x| *x > ON_LINE) && self.0.iter().any(|x| *x < -ON_LINE)
    }

    /// The step at which row `j` crosses the line, and true if the distance increases there;
    /// `Some(None)` without a crossing, `None` for several.
    fn crossing(&self, along: usize, j: usize) -> Option<Option<(f64, bool)>> {
        let mut found = None;
        let mut last: Option<(usize, f64)> = None;
        for i in 0..=STEPS {
            let x = self.at(along, i, j);
            if x == 0.0 {
                continue;
            }
            if let Some((k, y)) = last
                && (x < 0.0) != (y < 0.0)
            {
                if found.is_some() {
                    return None;
                }
                found = Some((k as f64 + (i - k) as f64 * y / (y - x), x > 0.0));
            }
            last = Some((i, x));
        }
        Some(found)
    }

    /// The line as a graph, if each row crosses it at most once and its position changes steadily
    /// from row to row.
    fn graph(&self, along: usize) -> Option<LineGraph> {
        let (mut steepest, mut upwards) = (0.0f64, None);
        let mut before: Option<Option<f64>> = None;
        for j in 0..=STEPS {
            if (0..=STEPS).all(|i| self.at(along, i, j) == 0.0) {
                before = None;
                continue;
            }
            let here = self.crossing(along, j)?;
            if let Some((_, up)) = here
                && *upwards.get_or_insert(up) != up
            {
                return None;
            }
            let here = here.map(|(at, _)| at);
            let to_side = |at: f64| at.min(STEPS as f64 - at);
            let step = match (before, here) {
                (Some(Some(a)), Some(b)) => (a - b).abs(),
                (Some(None), Some(at)) | (Some(Some(at)), None) => to_side(at),
                _ => 0.0,
            };
            steepest = steepest.max(step);
            before = Some(here);
        }
        (steepest <= STEEPEST).then_some(LineGraph { along, steepest })
    }
}

impl<T: Real> Cutter<'_, T> {
    /// The point of a chart, in the coordinates of a parameter plane.
    fn inside(&self, plane: usize, chart: &Chart<T>, place: [f64; 2]) -> [f64; 2] {
        (self.planes[plane].place)(chart.real(place))
    }

    fn grid(&self, plane: usize, chart: &Chart<T>) -> Vec<[f64; 2]> {
        let step = |k: usize| k as f64 / STEPS as f64;
        let all = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| [step(i), step(j)]));
        all.map(|place| self.inside(plane, chart, place)).collect()
    }

    /// The lines that may cross a chart.
    fn lines(&self, chart: &Chart<T>) -> Vec<InnerLine> {
        let mut lines = Vec::new();
        for (k, plane) in self.planes.iter().enumerate() {
            let places = self.grid(k, chart);
            for axis in 0..2 {
                let all = places.iter().map(|w| w[axis]);
                let (low, high) =
                    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
                let ats = breaks_between(&plane.joints[axis], plane.closed[axis], low, high);
                lines.extend(ats.into_iter().map(|at| InnerLine { plane: k, axis, at }));
            }
        }
        lines
    }

    fn samples(&self, line: InnerLine, places: &[Vec<[f64; 2]>]) -> LineSamples {
        LineSamples(places[line.plane].iter().map(|w| w[line.axis] - line.at).collect())
    }

    /// Cuts a chart along lines and stores the pieces.
    fn cut(&mut self, chart: Chart<T>, lines: Vec<InnerLine>, depth: u32) {
        let used = |k: usize| lines.iter().any(|line| line.plane == k);
        let places: Vec<_> = (0..self.planes.len())
            .map(|k| if used(k) { self.grid(k, &chart) } else { Vec::new() })
            .collect();
        let crossing: Vec<(InnerLine, LineSamples)> = lines
            .into_iter()
            .map(|line| (line, self.samples(line, &places)))
            .filter(|(_, samples)| samples.crosses())
            .collect();
        if crossing.is_empty() {
            self.charts.push(chart);
            return;
        }
        let graphs = crossing.iter().enumerate().flat_map(|(k, (_, samples))| {
            [0, 1].into_iter().filter_map(move |along| Some((k, samples.graph(along)?)))
        });
        let best = graphs.min_by(|a, b| a.1.steepest.total_cmp(&b.1.steepest).then(a.0.cmp(&b.0)));
        let mut lines: Vec<InnerLine> = crossing.into_iter().map(|(line, _)| line).collect();
        match best {
            Some((k, graph)) => {
                let line = lines.remove(k);
                self.cut_along(&chart, line, graph.along, &lines, depth);
            }
            None if depth < DEEPEST => {
                for along in [0.0, 0.5] {
                    for across in [0.0, 0.5] {
                        let side = |at: f64| {
                            (at != 0.0 && at != 1.0).then(|| ChartBoundary(vec![T::from(at)]))
                        };
                        let part =
                            chart.part(0, [across, across + 0.5], [side(along), side(along + 0.5)]);
                        self.cut(part, lines.clone(), depth + 1);
                    }
                }
            }
            // Less than a cell: the fit handles the rest.
            None => self.charts.push(chart),
        }
    }

    /// Cuts a chart along a line that is a graph with values in the parameter `along`.
    fn cut_along(
        &mut self,
        chart: &Chart<T>,
        line: InnerLine,
        along: usize,
        others: &[InnerLine],
        depth: u32,
    ) {
        let mut ends = vec![0.0, 1.0];
        let beyond = |cutter: &Self, s: f64, t: f64| {
            let place = if along == 0 { [s, t] } else { [t, s] };
            cutter.inside(line.plane, chart, place)[line.axis] - line.at
        };
        // Positions where the line enters or leaves across a side.
        for side in [0.0, 1.0] {
            let step = |k: usize| k as f64 / STEPS as f64;
            for k in 0..STEPS {
                let (a, b) = (step(k), step(k + 1));
                ends.extend(find_root(|t| beyond(self, side, t), a, b).ok());
            }
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|a, b| *a - *b < ON_LINE);
        let last = ends.len() - 1;
        ends[last] = 1.0;
        let mut ranges: Vec<([f64; 2], u32)> =
            ends.windows(2).map(|w| ([w[0], w[1]], 0)).rev().collect();
        while let Some((range, halvings)) = ranges.pop() {
            let middle = 0.5 * (range[0] + range[1]);
            let sides = [0.0, 1.0].map(|s| beyond(self, s, middle));
            if (sides[0] < 0.0) == (sides[1] < 0.0) || sides.contains(&0.0) {
                let part = chart.part(along, range, [None, None]);
                self.cut(part, others.to_vec(), depth);
                continue;
            }
            let root = |t: f64| {
                let t = range[0] + (range[1] - range[0]) * t;
                let ends = [0.0, 1.0].map(|s| beyond(self, s, t).abs());
                let nearer = if ends[0] <= ends[1] { 0.0 } else { 1.0 };
                find_root(|s| beyond(self, s, t), 0.0, 1.0).unwrap_or(nearer)
            };
            let found = nodes().map(root);
            let plain = ChartBoundary::<f64>::through(&found);
            let off = PROBES.iter().map(|&t| (plain.at(t) - root(t)).abs()).fold(0.0, f64::max);
            // The line may end abruptly at the ends of the range.
            if off > CREASE_FIT && halvings < DEEPEST {
                ranges.push(([middle, range[1]], halvings + 1));
                ranges.push(([range[0], middle], halvings + 1));
                continue;
            }
            let rate = |k: usize| {
                let t = range[0] + (range[1] - range[0]) * nodes()[k];
                self.rate(chart, along, found[k], t) + found[k]
            };
            let boundary = ChartBoundary::through(&std::array::from_fn(rate));
            for sides in [[None, Some(boundary.clone())], [Some(boundary.clone()), None]] {
                self.cut(chart.part(along, range, sides), others.to_vec(), depth);
            }
        }
    }

    /// The derivatives of the parameter `s` of a crease in a chart, as a number with real part 0.
    /// Both sides S- and S+ stay joined as the crease moves, so ds = (dS+ - dS-) . n / n . n with n
    /// = S-' - S+'. Zero if the tangents agree.
    fn rate(&self, chart: &Chart<T>, along: usize, s: f64, t: f64) -> T {
        if T::PARTS == 1 {
            return T::zero();
        }
        let side = |h: f64| {
            let place = if along == 0 { [s + h, t] } else { [t, s + h] };
            let [x, y] = place.map(T::from);
            let (x, y) = Bi1::parameters(x, y);
            let [u, v] = chart.at([x, y]);
            let jet = self.surface.jet(u.f, v.f, Order::First);
            let [du, dv] = if along == 0 { [u.u, v.u] } else { [u.v, v.v] };
            let slope = jet.u * du + jet.v * dv;
            (jet.p - slope * T::from(h), slope.re())
        };
        let ((low, before), (high, after)) = (side(-BESIDE), side(BESIDE));
        let turn = before - after;
        let square = turn.norm_sq();
        if square <= 1e-16 * before.norm_sq().max(after.norm_sq()) {
            return T::zero();
        }
        let gap = high - low;
        let rate = (gap.x * turn.x + gap.y * turn.y + gap.z * turn.z) / square;
        if rate.is_finite() { rate - rate.re() } else { T::zero() }
    }
}
