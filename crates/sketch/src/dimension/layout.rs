//! Coordinates from dimensions, with an exact account of missing and redundant ones.
//!
//! A dimension along an axis joins two planes with an offset. The planes and one ground node (joined
//! to the reference point's planes) form a graph; dimensions that join two parts drive, one that
//! closes a loop is redundant or contradicts the loop. Coordinates are sums of ±d along the only path
//! from the ground (routine CVTSTR), so nothing is solved, nothing flips, and derivatives are exact.

use crate::dimension::solver::solve_derived;
use crate::dimension::{Dimension, DimensionRole, MeasuredQuantity};
use crate::drawing::estimate::Estimate;
use crate::drawing::planes::Planes;
use crate::object::SketchObject;
use crate::{CoordinateAxis, PointId};
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Real, Vec3};
use std::collections::{BTreeMap, VecDeque};

/// A dimension that is not satisfied.
#[derive(Clone, Debug, PartialEq)]
pub enum DimensionFault {
    /// Other dimensions determine it, consistently.
    Redundant {
        /// Its name.
        name: String,
        /// The dimensions that determine it.
        path: Vec<String>,
    },
    /// Other dimensions determine it, with another value.
    Contradictory {
        /// Its name.
        name: String,
        /// Given value.
        asked: f64,
        /// Value from the other dimensions.
        measured: f64,
        /// The dimensions that determine it.
        path: Vec<String>,
    },
    /// Its expression reads an undefined name or one without a value.
    NoValue {
        /// Its name.
        name: String,
        /// The name it reads.
        reads: String,
    },
    /// Its expression depends on itself.
    Cycle {
        /// All names of the cycle.
        names: Vec<String>,
    },
    /// Its value is not a finite number.
    NotFinite {
        /// Its name.
        name: String,
    },
    /// Its value is outside its range.
    OutOfRange {
        /// Its name.
        name: String,
        /// Its value.
        value: f64,
        /// The range.
        range: [f64; 2],
    },
    /// A derived dimension (length, slope, angle, equal) has no solution near the drawing.
    Unsolved {
        /// Its name.
        name: String,
        /// Violation.
        residual: f64,
    },
}

/// Planes of an axis that are connected to each other but not to the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Loose {
    /// The axis.
    pub axis: CoordinateAxis,
    /// The planes.
    pub planes: Vec<usize>,
    /// Their points.
    pub points: Vec<PointId>,
}

/// Number of dimensions, required and given, of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Planes less one.
    pub required: usize,
    /// Dimensions that drive.
    pub given: usize,
    /// Still to be given.
    pub missing: usize,
}

/// Positions from dimensions.
#[derive(Clone, Debug)]
pub struct DimensionLayout<T> {
    /// The coordinate of each plane of each axis, as far as determined.
    pub coordinates: [Vec<Option<T>>; 3],
    /// The numbers of dimensions of each axis.
    pub counts: [Count; 3],
    /// Parts that are not connected to the reference.
    pub loose: Vec<Loose>,
    /// Dimensions in trouble.
    pub faults: Vec<DimensionFault>,
    /// Values of all dimensions and variables by folded name.
    pub values: BTreeMap<String, T>,
}

impl<T: Real> DimensionLayout<T> {
    /// True if every point is determined.
    pub fn complete(&self) -> bool {
        self.counts.iter().all(|c| c.missing == 0)
    }

    /// The coordinate of a point on an axis.
    pub fn coordinate(&self, planes: &Planes, axis: CoordinateAxis, point: PointId) -> Option<T> {
        self.coordinates[axis.index()].get(planes.plane(axis, point)?).copied().flatten()
    }

    /// Position of a point.
    pub fn point(&self, planes: &Planes, point: PointId) -> Option<Vec3<T>> {
        let [x, y, z] = CoordinateAxis::ALL.map(|a| self.coordinate(planes, a, point));
        Some(Vec3::new(x?, y?, z?))
    }

    /// All positions, in the order of [`Planes::ids`]; `None` when one is undetermined.
    pub fn positions(&self, planes: &Planes) -> Option<Vec<Vec3<T>>> {
        let at = |axis: CoordinateAxis, k: usize| {
            self.coordinates[axis.index()][planes.classes(axis)[k] as usize]
        };
        (0..planes.ids().len())
            .map(|k| {
                Some(Vec3::new(
                    at(CoordinateAxis::X, k)?,
                    at(CoordinateAxis::Y, k)?,
                    at(CoordinateAxis::Z, k)?,
                ))
            })
            .collect()
    }

    /// Value of a measure, if its points are determined.
    pub fn measured(
        &self,
        object: &SketchObject,
        planes: &Planes,
        measure: &MeasuredQuantity,
    ) -> Option<T> {
        match *measure {
            MeasuredQuantity::Along { axis, p, q } => {
                Some(self.coordinate(planes, axis, q)? - self.coordinate(planes, axis, p)?)
            }
            MeasuredQuantity::Datum { axis, point } => self.coordinate(planes, axis, point),
            _ => crate::dimension::solver::value(object, measure, &|p| self.point(planes, p)),
        }
    }
}

/// The dimension graph of one axis: planes and the ground.
struct DimensionGraph {
    /// Per node: (other node, dimension, whether the other node is its far end).
    next: Vec<Vec<(usize, usize, bool)>>,
    sets: UnionFind,
}

impl DimensionGraph {
    fn new(nodes: usize) -> DimensionGraph {
        DimensionGraph { next: vec![Vec::new(); nodes], sets: UnionFind::new(nodes) }
    }

    fn join(&mut self, a: usize, b: usize, dimension: usize) {
        self.next[a].push((b, dimension, true));
        self.next[b].push((a, dimension, false));
        self.sets.join(a, b);
    }

    fn path(&self, a: usize, b: usize) -> Vec<(usize, bool)> {
        let mut from = vec![None; self.next.len()];
        let mut queue = VecDeque::from([a]);
        while let Some(at) = queue.pop_front() {
            for &(to, d, forward) in &self.next[at] {
                if to != a && from[to].is_none() {
                    from[to] = Some((at, d, forward));
                    queue.push_back(to);
                }
            }
        }
        let mut path = Vec::new();
        let mut at = b;
        while let Some((before, d, forward)) = from[at] {
            path.push((d, forward));
            at = before;
        }
        path.reverse();
        path
    }
}

/// Not a dimension but the reference point.
const REFERENCE: usize = usize::MAX;

/// Its name among those of dimensions.
pub(crate) const REFERENCE_NAME: &str = "REFERENCE";

/// The two nodes that a dimension joins on its axis, from and to; the ground is node `planes`.
fn ends(planes: &Planes, measure: &MeasuredQuantity) -> Option<(CoordinateAxis, usize, usize)> {
    match *measure {
        MeasuredQuantity::Along { axis, p, q } => {
            Some((axis, planes.plane(axis, p)?, planes.plane(axis, q)?))
        }
        MeasuredQuantity::Datum { axis, point } => {
            Some((axis, planes.counts()[axis.index()], planes.plane(axis, point)?))
        }
        _ => None,
    }
}

/// The chain of driving dimensions between two points on an axis, as points and names of
/// dimensions; `None` without connection.
pub fn chain(
    object: &SketchObject,
    planes: &Planes,
    axis: CoordinateAxis,
    p: PointId,
    q: PointId,
) -> Option<(Vec<PointId>, Vec<String>)> {
    let (a, b) = (planes.plane(axis, p)?, planes.plane(axis, q)?);
    let graph = &graphs(object, planes).0[axis.index()];
    let path = graph.path(a, b);
    if path.is_empty() && a != b {
        return None;
    }
    let ground = planes.counts()[axis.index()];
    let (mut points, mut names) = (vec![p], Vec::new());
    let mut at = a;
    for (d, forward) in path {
        let far = graph.next[at].iter().find(|n| n.1 == d && n.2 == forward).map(|n| n.0);
        at = far.unwrap_or(b);
        let (first, last, name) = match object.dimensions.get_index(d) {
            Some((_, dimension)) => match dimension.measure {
                MeasuredQuantity::Along { p, q, .. } if forward => (p, q, dimension.name.clone()),
                MeasuredQuantity::Along { p, q, .. } => (q, p, dimension.name.clone()),
                MeasuredQuantity::Datum { point, .. } => (point, point, dimension.name.clone()),
                _ => continue,
            },
            None => match object.reference() {
                Some(r) => (r.point, r.point, REFERENCE_NAME.to_owned()),
                None => continue,
            },
        };
        for point in [first, last] {
            let known = points.last().is_some_and(|l| planes.same(axis, *l, point));
            if !known && at != ground {
                points.push(point);
            }
        }
        names.push(name);
    }
    if let Some(last) = points.last_mut() {
        *last = q;
    }
    Some((points, names))
}

/// `1>4>2`.
pub fn chain_text(points: &[PointId]) -> String {
    points.iter().map(ToString::to_string).collect::<Vec<_>>().join(">")
}

/// The forests of driving dimensions, and the dimensions that close loops in them.
fn graphs(object: &SketchObject, planes: &Planes) -> ([DimensionGraph; 3], Vec<usize>) {
    let mut graphs = planes.counts().map(|n| DimensionGraph::new(n + 1));
    if let Some(r) = object.reference() {
        for axis in CoordinateAxis::ALL {
            if let Some(plane) = planes.plane(axis, r.point) {
                graphs[axis.index()].join(planes.counts()[axis.index()], plane, REFERENCE);
            }
        }
    }
    let mut closing = Vec::new();
    for (k, dimension) in object.dimensions.values().enumerate() {
        let Some((axis, a, b)) = ends(planes, &dimension.measure) else { continue };
        if dimension.role != DimensionRole::Driving || dimension.value.is_none() {
            continue;
        }
        let graph = &mut graphs[axis.index()];
        if graph.sets.same(a, b) {
            closing.push(k);
        } else {
            graph.join(a, b, k);
        }
    }
    (graphs, closing)
}

/// Computes the layout. `overrides` replaces the values of dimensions and variables (folded names);
/// `estimate` is called only if derived dimensions (length, slope, …) need a start.
pub fn solve<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    overrides: &BTreeMap<String, T>,
    estimate: &dyn Fn() -> Option<Estimate>,
) -> DimensionLayout<T> {
    let (values, mut faults) = evaluate(object, overrides);
    let origin = origin(object, &values, &mut faults);
    let (graphs, closing) = graphs(object, planes);
    let value = |k: usize| -> Option<T> {
        let (key, _) = object.dimensions.get_index(k)?;
        values.get(key).copied()
    };
    let mut coordinates = planes.counts().map(|n| vec![None; n]);
    let mut floating: Vec<(CoordinateAxis, Vec<(usize, T)>)> = Vec::new();
    let mut counts = [Count::default(); 3];
    for axis in CoordinateAxis::ALL {
        let k = axis.index();
        let (graph, ground) = (&graphs[k], planes.counts()[k]);
        let mut offset: Vec<Option<T>> = vec![None; ground + 1];
        for start in std::iter::once(ground).chain(0..ground) {
            if offset[start].is_some() {
                continue;
            }
            offset[start] = Some(T::zero());
            let mut part = vec![(start, T::zero())];
            let mut done = 0;
            while let Some(&(at, here)) = part.get(done) {
                done += 1;
                for &(to, d, forward) in &graph.next[at] {
                    if offset[to].is_some() {
                        continue;
                    }
                    let step = if d == REFERENCE { origin[k] } else { value(d) };
                    // A dimension without a value leaves its far side open.
                    let Some(step) = step else { continue };
                    let there = if forward { here + step } else { here - step };
                    offset[to] = Some(there);
                    part.push((to, there));
                }
            }
            if start == ground {
                for &(plane, at) in &part[1..] {
                    coordinates[k][plane] = Some(at);
                }
            } else {
                floating.push((axis, part));
            }
        }
        let parts = floating.iter().filter(|(a, _)| *a == axis).count();
        let required = planes.required(axis);
        counts[k] = Count { required, given: required.saturating_sub(parts), missing: parts };
    }
    let derived: Vec<&Dimension> = (object.dimensions.values())
        .filter(|d| d.role == DimensionRole::Driving && d.value.is_some())
        .filter(|d| ends(planes, &d.measure).is_none())
        .collect();
    let mut layout =
        DimensionLayout { coordinates, counts, loose: Vec::new(), faults: Vec::new(), values };
    if !derived.is_empty() {
        faults.extend(solve_derived(
            object,
            planes,
            &mut layout,
            &mut floating,
            &derived,
            estimate,
        ));
    }
    for (axis, part) in floating {
        let mut own: Vec<usize> = part.iter().map(|p| p.0).collect();
        own.sort_unstable();
        let mut points: Vec<PointId> = own.iter().flat_map(|&p| planes.members(axis, p)).collect();
        points.sort_unstable();
        layout.loose.push(Loose { axis, planes: own, points });
    }
    for k in closing {
        let Some((key, dimension)) = object.dimensions.get_index(k) else { continue };
        let Some((axis, a, b)) = ends(planes, &dimension.measure) else { continue };
        let Some(asked) = layout.values.get(key).copied() else { continue };
        let mut path = Vec::new();
        let mut sum = T::zero();
        for (d, forward) in graphs[axis.index()].path(a, b) {
            let (name, step) = match object.dimensions.get_index(d) {
                Some((key, d)) => (d.name.clone(), layout.values.get(key).copied()),
                None => (REFERENCE_NAME.to_owned(), origin[axis.index()]),
            };
            path.push(name);
            let step = step.unwrap_or_default();
            sum = if forward { sum + step } else { sum - step };
        }
        let name = dimension.name.clone();
        let (asked, measured) = (asked.re(), sum.re());
        faults.push(if agree(asked, measured) {
            DimensionFault::Redundant { name, path }
        } else {
            DimensionFault::Contradictory { name, asked, measured, path }
        });
    }
    layout.faults = faults;
    layout
}

/// True if two values of a dimension agree within rounding.
pub fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

/// The values of variables and dimensions, by folded name. `overrides` replaces values, and gives those of other
/// objects that expressions read.
pub fn numbers<T: Real>(
    object: &SketchObject,
    overrides: &BTreeMap<String, T>,
) -> BTreeMap<String, T> {
    evaluate(object, overrides).0
}

/// The coordinates of the reference point, as far as they have values.
fn origin<T: Real>(
    object: &SketchObject,
    values: &BTreeMap<String, T>,
    faults: &mut Vec<DimensionFault>,
) -> [Option<T>; 3] {
    let Some(reference) = object.reference() else { return [None; 3] };
    let name = || REFERENCE_NAME.to_owned();
    reference.at.map(|e| match e.eval(&|name| values.get(name).copied()) {
        Ok(x) if x.is_finite() => Some(x),
        Ok(_) => {
            faults.push(DimensionFault::NotFinite { name: name() });
            None
        }
        Err(no) => {
            faults.push(DimensionFault::NoValue { name: name(), reads: no.name });
            None
        }
    })
}

/// Evaluates all variables and dimensions, each after those it reads.
fn evaluate<T: Real>(
    object: &SketchObject,
    overrides: &BTreeMap<String, T>,
) -> (BTreeMap<String, T>, Vec<DimensionFault>) {
    // Names of other objects come with the overrides.
    let outside = |key: &&String| {
        !object.variables.contains_key(*key) && !object.dimensions.contains_key(*key)
    };
    let mut values: BTreeMap<String, T> = (overrides.iter())
        .filter(|(key, _)| outside(key))
        .map(|(key, value)| (key.clone(), *value))
        .collect();
    let mut faults = Vec::new();
    let mut waiting = Vec::new();
    let variables = object.variables.iter().map(|(k, v)| (k, Some(&v.value)));
    let dimensions = object.dimensions.iter().map(|(k, d)| (k, d.value.as_ref()));
    for (key, expr) in variables.chain(dimensions) {
        let Some(expr) = expr else { continue };
        if let Some(given) = overrides.get(key) {
            values.insert(key.clone(), *given);
        } else if let Some(number) = expr.literal() {
            values.insert(key.clone(), T::from(number));
        } else {
            waiting.push((key, expr));
        }
    }
    // Names that wait for a name, by that name.
    let mut waits: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    let mut ready: VecDeque<usize> = (0..waiting.len()).collect();
    let mut open = vec![true; waiting.len()];
    let mut missing: Vec<Option<String>> = vec![None; waiting.len()];
    while let Some(k) = ready.pop_front() {
        let (key, expr) = waiting[k];
        if !open[k] {
            continue;
        }
        match expr.eval(&|name| values.get(name).copied()) {
            Ok(value) => {
                open[k] = false;
                values.insert(key.clone(), value);
                ready.extend(waits.remove(key.as_str()).unwrap_or_default());
            }
            Err(no) => {
                if let Some(name) = expr.names().find(|n| *n == no.name) {
                    waits.entry(name).or_default().push(k);
                }
                missing[k] = Some(no.name);
            }
        }
    }
    let stuck: BTreeMap<&str, &str> = (0..waiting.len())
        .filter(|&k| open[k])
        .filter_map(|k| Some((waiting[k].0.as_str(), missing[k].as_deref()?)))
        .collect();
    let mut cycles: Vec<Vec<String>> = Vec::new();
    for (&name, &reads) in &stuck {
        // Follow the references from name to name: they end at a name without a value or in a
        // cycle.
        let mut way = vec![name];
        let mut at = reads;
        while let Some(&next) = stuck.get(at) {
            if let Some(k) = way.iter().position(|w| *w == at) {
                let mut names: Vec<String> = way[k..].iter().map(|s| (*s).to_owned()).collect();
                names.sort_unstable();
                if !cycles.contains(&names) {
                    cycles.push(names);
                }
                break;
            }
            way.push(at);
            at = next;
        }
        if !stuck.contains_key(at) {
            // As the user wrote it; keys are folded.
            let dimension = object.dimensions.get(name).map(|d| &d.name);
            let written = dimension.or(object.variables.get(name).map(|v| &v.name));
            let name = written.map_or_else(|| name.to_owned(), Clone::clone);
            faults.push(DimensionFault::NoValue { name, reads: at.into() });
        }
    }
    faults.extend(cycles.into_iter().map(|names| DimensionFault::Cycle { names }));
    values.retain(|name, value| {
        let fine = value.is_finite();
        if !fine {
            faults.push(DimensionFault::NotFinite { name: name.clone() });
        }
        fine
    });
    // Ranges bind numbers however they come about.
    let variables = object.variables.iter().map(|(k, v)| (k, &v.name, v.range));
    let dimensions = object.dimensions.iter().map(|(k, d)| (k, &d.name, d.range));
    for (key, name, range) in variables.chain(dimensions) {
        if let (Some([low, high]), Some(value)) = (range, values.get(key).map(|v| v.re())) {
            let slack = 1e-12 * low.abs().max(high.abs());
            if !(low - slack..=high + slack).contains(&value) {
                faults.push(DimensionFault::OutOfRange {
                    name: name.clone(),
                    value,
                    range: [low, high],
                });
            }
        }
    }
    (values, faults)
}

/// The driving dimensions between two points as a sum of names; `None` when they are not connected,
/// or through a reference at the origin only.
pub fn chain_expression(
    object: &SketchObject,
    planes: &Planes,
    axis: CoordinateAxis,
    p: PointId,
    q: PointId,
) -> Option<String> {
    let (a, b) = (planes.plane(axis, p)?, planes.plane(axis, q)?);
    let path = graphs(object, planes).0[axis.index()].path(a, b);
    let mut sum = String::new();
    for (d, forward) in path {
        let term = match object.dimensions.get_index(d) {
            Some((_, dimension)) => dimension.name.clone(),
            None => {
                let at = &object.reference()?.at[axis.index()];
                if at.literal() == Some(0.0) {
                    continue;
                }
                format!("({at})")
            }
        };
        sum.push_str(match (forward, sum.is_empty()) {
            (true, true) => "",
            (true, false) => " + ",
            (false, true) => "-",
            (false, false) => " - ",
        });
        sum.push_str(&term);
    }
    (!sum.is_empty()).then_some(sum)
}
