//! Parts of a surface within loops: charts whose union is the part.
//!
//! The loops are cut where their curves begin, change formula, cross a line of the surface and turn
//! back along one parameter w of the plane; between these values of w every curve is a graph over
//! w. Adjacent graphs with the part between them bound a trapezoid, which extends over w until one
//! of them ends (the trapezoidal decomposition by a sweep, de Berg et al. 2008, Computational
//! Geometry, 6.1). Its two boundaries are approximated by polynomials; where a loop turns back they
//! begin like a square root, which a quadratic step of w removes.

use crate::chart::{BOUNDARY_FIT, Chart, ChartBoundary, DEEPEST, GradedSteps, PROBES, nodes};
use moldloft_num::period::{breaks_between, crease_rate};
use moldloft_num::{Curve, Order, Real, Surface, find_root, gauss_rule};
use std::collections::BTreeMap;

/// A curve of a loop in the parameter plane of its surface.
#[derive(Clone, Copy)]
pub struct TrimCurve<'a, T: Real> {
    /// The curve, with its place on the surface ([`Curve::on_surface`]).
    pub curve: &'a dyn Curve<T>,
    /// True if its direction is opposite to the loop's.
    pub backwards: bool,
}

/// The loops of a part of a surface, the outer one first.
pub type TrimLoops<'a, T> = [Vec<TrimCurve<'a, T>>];

/// Numbers of samples of a smooth stretch of a curve; the next one where the trapezoids are not the
/// part.
const SAMPLES: [usize; 3] = [16, 64, 512];

/// Distance in parameters at which two values are one.
const SAME: f64 = 1e-11;

/// Maximum distance in parameters between the ends of adjacent curves of a loop.
const MAX_GAP: f64 = 2e-6;

/// Maximum difference between the area of the trapezoids and that within the loops, relative to the
/// box of the loops, in the parameter plane.
const AREA_FIT: f64 = 1e-9;

/// Slope of w at the end of a graph, relative to its maximum, below which the loop turns back there.
const TURNING: f64 = 1e-2;

/// Distance from a crease at which one side of it is evaluated, relative to the surface.
const BESIDE: f64 = 1e-9;

/// Points of the rule of areas, and of the coarser one for its error.
const RULES: [usize; 2] = [19, 13];

/// A value of w at which a graph begins or ends.
#[derive(Clone, Copy)]
struct SweepEvent<T> {
    at: T,
    /// True on a line w = const of the surface.
    on_line: bool,
}

/// A line of the surface: its parameter, and the same with derivatives.
#[derive(Clone, Copy)]
struct SweepLine<T> {
    at: f64,
    moved: T,
}

/// A stretch of a curve that is a graph over w.
struct LoopGraph<'a, T: Real> {
    curve: &'a dyn Curve<T>,
    /// Parameters of the curve at the lowest and the highest w, and the indices of these events.
    ends: [f64; 2],
    events: [usize; 2],
    /// True where the loop turns back.
    turns: [bool; 2],
}

/// A boundary of a trapezoid, by its index.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum TrapezoidSide {
    Line(usize),
    Graph(usize),
}

/// The decomposition of a part along one parameter.
struct TrapezoidDecomposition<'a, T: Real> {
    /// The parameter of the sweep.
    w: usize,
    lines: &'a [Vec<SweepLine<T>>; 2],
    events: Vec<SweepEvent<T>>,
    graphs: Vec<LoopGraph<'a, T>>,
    /// Lower and upper boundary, and the events at both ends.
    trapezoids: Vec<([TrapezoidSide; 2], [usize; 2])>,
    /// The area in each loop by Green's theorem, signed, and the error of all.
    areas: Vec<f64>,
    area_error: f64,
}

/// The charts of a part of a surface, or `None` if its loops cross or are not finite.
pub(crate) fn trimmed_charts<T: Real>(
    surface: &dyn Surface<T>,
    loops: &TrimLoops<'_, T>,
) -> Option<Vec<Chart<T>>> {
    let extent = extent(loops)?;
    let lines = [0, 1].map(|axis| lines_of(surface, axis, extent[axis]));
    let closed = surface.closed();
    let size = (extent[0][1] - extent[0][0]) * (extent[1][1] - extent[1][0]);
    for samples in SAMPLES {
        let both = [0, 1].map(|w| TrapezoidDecomposition::new(loops, &lines, w, samples));
        let Some(found) = both.into_iter().flatten().min_by_key(|d| d.trapezoids.len()) else {
            continue;
        };
        let Some((charts, area)) = found.charts(closed) else { continue };
        if (area - found.area()).abs() <= AREA_FIT * size + found.area_error {
            return Some(charts);
        }
    }
    None
}

/// True if the loops bound a part of the surface, as they do unless they cross.
pub fn bounds_part<T: Real>(surface: &dyn Surface<T>, loops: &TrimLoops<'_, T>) -> bool {
    trimmed_charts(surface, loops).is_some()
}

/// The place of a curve in the parameter plane, and its derivative; `None` if not finite.
fn path<T: Real>(curve: &dyn Curve<T>, t: f64) -> Option<[[T; 2]; 2]> {
    let [p, d, ..] = curve.on_surface(T::from(t), Order::First)?;
    (p.is_finite() && d.is_finite()).then_some([[p.x, p.y], [d.x, d.y]])
}

/// Minimum and maximum of u and v on the loops.
fn extent<T: Real>(loops: &TrimLoops<'_, T>) -> Option<[[f64; 2]; 2]> {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for of in loops.iter().flatten() {
        for k in 0..=64 {
            let [p, _] = path(of.curve, f64::from(k) / 64.0)?;
            for (range, x) in extent.iter_mut().zip(p) {
                *range = [range[0].min(x.re()), range[1].max(x.re())];
            }
        }
    }
    Some(extent)
}

/// The lines of the surface that cross a range of a parameter.
fn lines_of<T: Real>(
    surface: &dyn Surface<T>,
    axis: usize,
    [low, high]: [f64; 2],
) -> Vec<SweepLine<T>> {
    let mut own = surface.breaks()[axis].clone();
    own.extend(&surface.joints()[axis]);
    own.sort_by(f64::total_cmp);
    own.dedup_by(|a, b| *a - *b < SAME);
    let beside = SAME * (high - low);
    let found =
        breaks_between(&own, surface.closed()[axis], low + beside, high - beside).into_iter();
    let moved = |at: f64| {
        if T::PARTS == 1 || !own.contains(&at) {
            return T::from(at);
        }
        crease_rate(surface, axis, at, [BESIDE * at, BESIDE * (1.0 - at)]) + at
    };
    found.map(|at| SweepLine { at, moved: moved(at) }).collect()
}

/// A parameter of a curve at which it is cut, and the value of w there.
struct CurveCut<T> {
    t: f64,
    event: SweepEvent<T>,
}

/// The places at which sampled values change their sign; values within `negligible` have none.
fn changes(ts: &[f64], values: impl Fn(usize) -> f64, negligible: f64) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    let mut last: Option<usize> = None;
    for k in (0..ts.len()).filter(|&k| values(k).abs() > negligible) {
        if let Some(before) = last
            && (values(before) < 0.0) != (values(k) < 0.0)
        {
            found.push([ts[before], ts[k]]);
        }
        last = Some(k);
    }
    found
}

/// The cuts of a curve, from 0 to 1; stretches without extent in w are whole.
fn cuts<T: Real>(
    curve: &dyn Curve<T>,
    lines: &[Vec<SweepLine<T>>; 2],
    w: usize,
    samples: usize,
) -> Option<Vec<CurveCut<T>>> {
    let mut ends = curve.joints();
    ends.extend(curve.breaks());
    ends.retain(|t| *t > 0.0 && *t < 1.0);
    ends.extend([0.0, 1.0]);
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < SAME);
    let plain = |t: f64| {
        Some(CurveCut { t, event: SweepEvent { at: path(curve, t)?[0][w], on_line: false } })
    };
    let mut cuts: Vec<CurveCut<T>> = ends.iter().map(|&t| plain(t)).collect::<Option<_>>()?;
    for span in ends.windows(2) {
        let beside = SAME * (span[1] - span[0]);
        // Slopes at the ends are those inside.
        let inside = |t: f64| t.clamp(span[0] + beside, span[1] - beside);
        let step = |k: usize| inside(span[0] + (span[1] - span[0]) * (k as f64 / samples as f64));
        let ts: Vec<f64> = (0..=samples).map(step).collect();
        let found: Vec<[[T; 2]; 2]> = ts.iter().map(|&t| path(curve, t)).collect::<Option<_>>()?;
        let value = |k: usize, axis: usize| found[k][0][axis].re();
        let all = || (0..=samples).map(|k| value(k, w));
        let reach = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
        if reach <= SAME {
            continue;
        }
        let slope = |t: f64| path(curve, t).map_or(f64::NAN, |p| p[1][w].re());
        for [a, b] in changes(&ts, |k| found[k][1][w].re(), 0.0) {
            cuts.push(plain(find_root(slope, a, b).ok()?)?);
        }
        for axis in 0..2 {
            for line in &lines[axis] {
                let off = |t: f64| path(curve, t).map_or(f64::NAN, |p| p[0][axis].re() - line.at);
                for [a, b] in changes(&ts, |k| value(k, axis) - line.at, SAME) {
                    let t = find_root(off, a, b).ok()?;
                    let [place, rate] = path(curve, t)?;
                    let step = (line.moved - place[axis]) / rate[axis].re();
                    let step = if step.is_finite() { step - step.re() } else { T::zero() };
                    let on_line = axis == w;
                    let at = if on_line { line.moved } else { place[w] + step * rate[w].re() };
                    cuts.push(CurveCut { t, event: SweepEvent { at, on_line } });
                }
            }
        }
    }
    cuts.sort_by(|a, b| a.t.total_cmp(&b.t));
    Some(cuts)
}

impl<'a, T: Real> TrapezoidDecomposition<'a, T> {
    fn new(
        loops: &TrimLoops<'a, T>,
        lines: &'a [Vec<SweepLine<T>>; 2],
        w: usize,
        samples: usize,
    ) -> Option<Self> {
        let (events, graphs, trapezoids, areas) = Default::default();
        let mut made = Self { w, lines, events, graphs, trapezoids, areas, area_error: 0.0 };
        for cycle in loops {
            made.add_loop(cycle, samples)?;
        }
        let on_line = |line: &SweepLine<T>| SweepEvent { at: line.moved, on_line: true };
        made.events.extend(lines[w].iter().map(on_line));
        made.merge_events();
        made.sweep()?;
        Some(made)
    }

    /// The area within the outer loop and outside of the others, in the parameter plane.
    fn area(&self) -> f64 {
        let sizes = self.areas.iter().map(|a| a.abs());
        2.0 * sizes.clone().fold(0.0, f64::max) - sizes.sum::<f64>()
    }

    /// The stretches of a loop; each begins at the event at which the one before ends.
    fn add_loop(&mut self, cycle: &[TrimCurve<'a, T>], samples: usize) -> Option<()> {
        self.areas.push(0.0);
        let first = self.events.len();
        let mut last: Option<usize> = None;
        for (k, of) in cycle.iter().enumerate() {
            let mut cuts = cuts(of.curve, self.lines, self.w, samples)?;
            if of.backwards {
                cuts.reverse();
            }
            let count = cuts.len();
            for (i, cut) in cuts.iter().enumerate() {
                let closes = k + 1 == cycle.len() && i + 1 == count;
                let event = match last {
                    Some(last) if i == 0 => {
                        self.join(last, cut)?;
                        last
                    }
                    _ if closes => {
                        self.join(first, cut)?;
                        first
                    }
                    _ => {
                        self.events.push(cut.event);
                        self.events.len() - 1
                    }
                };
                if let Some(from) = last
                    && i > 0
                {
                    self.add_stretch(of.curve, [cuts[i - 1].t, cut.t], [from, event])?;
                }
                last = Some(event);
            }
        }
        Some(())
    }

    /// Counts the gap between ends that are one event.
    fn join(&mut self, event: usize, cut: &CurveCut<T>) -> Option<()> {
        let gap = (self.events[event].at - cut.event.at).re().abs();
        self.area_error += gap;
        (gap <= MAX_GAP).then_some(())
    }

    fn add_stretch(
        &mut self,
        curve: &'a dyn Curve<T>,
        [from, to]: [f64; 2],
        events: [usize; 2],
    ) -> Option<()> {
        let (w, c) = (self.w, 1 - self.w);
        let at = |x: f64| path(curve, from + (to - from) * x);
        // Of the loop's integral of c dw.
        let by_rule = |rule: usize| -> Option<f64> {
            gauss_rule(rule).iter().try_fold(0.0, |sum, &(x, weight)| {
                let [p, d] = at(x)?;
                Some(sum + p[c].re() * d[w].re() * (to - from) * weight)
            })
        };
        let [fine, coarse] = [by_rule(RULES[0])?, by_rule(RULES[1])?];
        *self.areas.last_mut()? += fine;
        self.area_error += (fine - coarse).abs();
        let shares = [1e-6, 0.25, 0.5, 0.75, 1.0 - 1e-6];
        let slopes = shares.map(|x| at(x).map_or(f64::NAN, |p| p[1][w].re().abs()));
        let most = slopes.into_iter().fold(0.0, f64::max);
        let turns = [slopes[0], slopes[4]].map(|s| s < TURNING * most);
        let mut graph = LoopGraph { curve, ends: [from, to], events, turns };
        if self.events[events[0]].at.re() > self.events[events[1]].at.re() {
            graph.turn();
        }
        self.graphs.push(graph);
        Some(())
    }

    /// One event for all of the same value, in ascending order; graphs without extent are dropped.
    fn merge_events(&mut self) {
        let mut order: Vec<usize> = (0..self.events.len()).collect();
        order.sort_by(|&a, &b| self.events[a].at.re().total_cmp(&self.events[b].at.re()));
        let mut place = vec![0; order.len()];
        let mut merged: Vec<SweepEvent<T>> = Vec::new();
        for k in order {
            let event = self.events[k];
            match merged.last_mut() {
                Some(last) if event.at.re() - last.at.re() <= SAME => {
                    if event.on_line && !last.on_line {
                        *last = event;
                    }
                }
                _ => merged.push(event),
            }
            place[k] = merged.len() - 1;
        }
        self.events = merged;
        for graph in &mut self.graphs {
            graph.events = graph.events.map(|k| place[k]);
        }
        self.graphs.retain(|g| g.events[0] < g.events[1]);
    }

    /// The trapezoids, between events at which one of their boundaries begins or ends. `None` if a
    /// loop is not closed.
    fn sweep(&mut self) -> Option<()> {
        let mut beginning: Vec<Vec<usize>> = vec![Vec::new(); self.events.len()];
        for (k, graph) in self.graphs.iter().enumerate() {
            beginning[graph.events[0]].push(k);
        }
        let mut active: Vec<usize> = Vec::new();
        let mut open: BTreeMap<[TrapezoidSide; 2], usize> = BTreeMap::new();
        for k in 0..self.events.len() {
            active.retain(|&g| self.graphs[g].events[1] > k);
            active.extend(&beginning[k]);
            let mut between: BTreeMap<[TrapezoidSide; 2], usize> = BTreeMap::new();
            if k + 1 < self.events.len() {
                let middle = (self.events[k].at + self.events[k + 1].at) * 0.5;
                between.extend(self.pairs(&active, middle)?.into_iter().map(|pair| (pair, k)));
            }
            let cut = self.events[k].on_line;
            for (pair, from) in open {
                match between.get_mut(&pair) {
                    Some(begins) if !cut => *begins = from,
                    _ => self.trapezoids.push((pair, [from, k])),
                }
            }
            open = between;
        }
        Some(())
    }

    /// The adjacent boundaries with the part between them at a value of w.
    fn pairs(&self, active: &[usize], w: T) -> Option<Vec<[TrapezoidSide; 2]>> {
        if active.len() % 2 == 1 {
            return None;
        }
        let of_graph = |&g: &usize| {
            let graph = TrapezoidSide::Graph(g);
            Some((self.height(graph, w)?.re(), graph))
        };
        let mut stack: Vec<(f64, TrapezoidSide)> =
            active.iter().map(of_graph).collect::<Option<_>>()?;
        let lines = self.lines[1 - self.w].iter().enumerate();
        stack.extend(lines.map(|(k, line)| (line.at, TrapezoidSide::Line(k))));
        stack.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut inside = false;
        let mut pairs = Vec::new();
        for pair in stack.windows(2) {
            inside ^= matches!(pair[0].1, TrapezoidSide::Graph(_));
            if inside && pair[1].0 - pair[0].0 > f64::EPSILON {
                pairs.push([pair[0].1, pair[1].1]);
            }
        }
        Some(pairs)
    }

    /// The other parameter on a boundary at a value of w, with the derivatives of both.
    fn height(&self, boundary: TrapezoidSide, w: T) -> Option<T> {
        let c = 1 - self.w;
        let graph = match boundary {
            TrapezoidSide::Line(k) => return Some(self.lines[c][k].moved),
            TrapezoidSide::Graph(k) => &self.graphs[k],
        };
        let t = graph.parameter(self.w, w.re())?;
        let [p, d] = path(graph.curve, t)?;
        let step = (w - p[self.w]) / d[self.w].re();
        // Zero beyond the ends of curves that only nearly meet.
        let near = step.is_finite() && step.re().abs() < 1e-9;
        Some(p[c] + if near { step * d[c].re() } else { T::zero() })
    }

    /// The charts of the trapezoids, and their area in the parameter plane.
    fn charts(&self, closed: [bool; 2]) -> Option<(Vec<Chart<T>>, f64)> {
        let (mut charts, mut area) = (Vec::new(), 0.0);
        for &(boundaries, events) in &self.trapezoids {
            let [from, to] = events.map(|k| self.events[k].at);
            let turns = |end: usize| {
                boundaries.iter().any(|b| match *b {
                    TrapezoidSide::Line(_) => false,
                    TrapezoidSide::Graph(k) => {
                        let graph = &self.graphs[k];
                        graph.turns[end] && graph.events[end] == events[end]
                    }
                })
            };
            let graded = GradedSteps { ends: [turns(0), turns(1)] };
            let mut ranges = vec![([0.0, 1.0], 0)];
            while let Some((range, depth)) = ranges.pop() {
                let share = |s: f64| range[0] + (range[1] - range[0]) * s;
                let at = |s: f64| from + (to - from) * graded.at(T::from(share(s)));
                let Some(sides) = self.fitted(boundaries, &at, depth == DEEPEST)? else {
                    let middle = share(0.5);
                    ranges.push(([middle, range[1]], depth + 1));
                    ranges.push(([range[0], middle], depth + 1));
                    continue;
                };
                for &(s, weight) in gauss_rule(RULES[0]) {
                    let height = sides[1].at(T::from(s)) - sides[0].at(T::from(s));
                    let step = graded.slope(share(s)) * (range[1] - range[0]);
                    area += (height * (to - from)).re() * step * weight;
                }
                charts.push(Chart::trapezoid(self.w, [from, to], graded, range, sides, closed));
            }
        }
        Some((charts, area))
    }

    /// The two boundaries as polynomials on [0, 1], where `at` is w; `Some(None)` if these miss the
    /// tolerance and it is not the `last` try.
    fn fitted(
        &self,
        boundaries: [TrapezoidSide; 2],
        at: &dyn Fn(f64) -> T,
        last: bool,
    ) -> Option<Option<[ChartBoundary<T>; 2]>> {
        let mut sides = Vec::with_capacity(2);
        for boundary in boundaries {
            if let TrapezoidSide::Line(_) = boundary {
                sides.push(ChartBoundary::constant(self.height(boundary, at(0.5))?));
                continue;
            }
            let mut values = nodes().map(T::from);
            for x in &mut values {
                *x = self.height(boundary, at(x.re()))?;
            }
            let side = ChartBoundary::through(&values).shortened();
            let mut off: f64 = 0.0;
            for &s in PROBES.iter().filter(|_| !last) {
                off = off.max((side.at(T::from(s)) - self.height(boundary, at(s))?).re().abs());
            }
            if off > BOUNDARY_FIT {
                return Some(None);
            }
            sides.push(side);
        }
        Some(sides.try_into().ok())
    }
}

/// Maximum number of steps to a place on a graph.
const MAX_STEPS: usize = 100;

impl<T: Real> LoopGraph<'_, T> {
    fn turn(&mut self) {
        self.ends.reverse();
        self.events.reverse();
        self.turns.reverse();
    }

    /// The parameter of the curve at a value of w: Newton's steps within a bracket. Curves that
    /// only nearly meet end beside their event.
    fn parameter(&self, axis: usize, w: f64) -> Option<f64> {
        let at = |t: f64| Some(path(self.curve, t)?.map(|x| x[axis].re()));
        let ends = [at(self.ends[0])?[0] - w, at(self.ends[1])?[0] - w];
        if ends[0] >= 0.0 {
            return Some(self.ends[0]);
        }
        if ends[1] <= 0.0 {
            return Some(self.ends[1]);
        }
        let [mut low, mut high] = self.ends;
        let mut t = low + (high - low) * (-ends[0] / (ends[1] - ends[0]));
        for _ in 0..MAX_STEPS {
            let [x, slope] = at(t)?;
            let off = x - w;
            if off == 0.0 {
                break;
            }
            if off < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let newton = t - off / slope;
            let inside = newton > low.min(high) && newton < low.max(high);
            let next = if inside { newton } else { 0.5 * (low + high) };
            if (next - t).abs() <= 2.0 * f64::EPSILON * t.abs() {
                break;
            }
            t = next;
        }
        Some(t)
    }
}
