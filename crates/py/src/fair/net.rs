//! Nets of surfaces, and curves that share points.

use super::arguments::{certificate, fair_error, floats, measure, refused, space, vectors};
use super::look::Look;
use super::solve::{bound, contradiction, end, get, goal, motion};
use super::spline::{Spline, spacing};
use crate::arrays;
use moldloft::fair::{
    Condition, EndContinuity, FairError, GridData, InterpolationSpace, Limit, Measure, Motion,
    NETWORK_BUDGET, NamedCurves, Network, NetworkCondition, NetworkCurve, NetworkMode,
    NetworkReport, ParameterSpacing, PatchNet, SURFACE_BUDGET, Seam, Space, fair_grid,
    grid_parameters, grid_spacing, one_way, parameters_across,
};
use moldloft::num::Vec3;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A tensor-product spline surface with any knots, open or closed in each direction.
#[pyclass(frozen, module = "moldloft._core")]
pub struct Net {
    spaces: [Space; 2],
    points: Vec<Vec3>,
    weights: Option<Vec<f64>>,
}

type Option1<'py> = Option<PyReadonlyArray1<'py, f64>>;

impl Net {
    fn network(&self, radii: Vec<f64>) -> PyResult<Network> {
        let limit = Limit::new(Motion::Ball, radii).map_err(fair_error)?;
        let (spaces, points) = (self.spaces.clone(), self.points.clone());
        Network::net(spaces, points, self.weights.clone(), limit).map_err(fair_error)
    }
}

#[pymethods]
impl Net {
    /// Points flat, (i, j) at `i * n + j`.
    #[new]
    #[pyo3(signature = (points, degrees, counts, forms, knots=(None, None), periods=(None, None), weights=None))]
    fn new(
        points: PyReadonlyArray2<'_, f64>,
        degrees: [usize; 2],
        counts: [usize; 2],
        forms: [String; 2],
        knots: (Option1<'_>, Option1<'_>),
        periods: (Option<f64>, Option<f64>),
        weights: Option1<'_>,
    ) -> PyResult<Self> {
        let points = vectors(&points)?;
        let u = space(degrees[0], counts[0], &forms[0], floats(knots.0), periods.0);
        let v = space(degrees[1], counts[1], &forms[1], floats(knots.1), periods.1);
        let spaces = [u.map_err(fair_error)?, v.map_err(fair_error)?];
        let net = Self { spaces, points, weights: floats(weights) };
        net.network(vec![0.0; net.points.len()])?;
        Ok(net)
    }

    #[getter]
    fn rational(&self) -> bool {
        self.weights.is_some()
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.spaces[0].count(), self.spaces[1].count())
    }

    #[getter]
    fn degrees(&self) -> (usize, usize) {
        (self.spaces[0].degree(), self.spaces[1].degree())
    }

    #[getter]
    fn closed(&self) -> (bool, bool) {
        (self.spaces[0].is_closed(), self.spaces[1].is_closed())
    }

    fn knots<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let [u, v] = &self.spaces;
        (u.knots().to_pyarray(py), v.knots().to_pyarray(py))
    }

    #[getter]
    fn control_points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let fill = |out: &mut [Vec3]| out.copy_from_slice(&self.points);
        arrays::filled(py, [self.points.len(), 3], fill).0
    }

    /// The surface at a grid of parameters in [0, 1].
    fn look(
        &self,
        py: Python<'_>,
        us: PyReadonlyArray1<'_, f64>,
        vs: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Look> {
        let network = self.network(vec![0.0; self.points.len()])?;
        let surface = network.surface(&self.points).map_err(fair_error)?;
        Look::of(py, surface, us.as_array().to_vec(), vs.as_array().to_vec())
    }

    /// The sum of a measure over the curves along u and over those along v.
    fn measure(&self, name: &str) -> PyResult<(f64, f64)> {
        let network = self.network(vec![0.0; self.points.len()])?;
        let (m, nv) = (measure(name)?, self.spaces[1].count());
        let all = network.strands.len();
        let value = |r| network.value(m, r, &self.points).map_err(fair_error);
        Ok((value(0..nv)?, value(nv..all)?))
    }

    /// Fairs: the faired net and the report.
    fn fair<'py>(
        &self,
        py: Python<'py>,
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Self, Bound<'py, PyDict>)> {
        let mut network = self.network(get(&options, "tolerance")?)?;
        let word: String = get(&options, "motion")?;
        network.limit.motion = motion(&word, get(&options, "direction")?)?;
        network.limit =
            Limit::new(network.limit.motion, network.limit.radii.clone()).map_err(fair_error)?;
        let ends: (String, String) = get(&options, "ends")?;
        let ends = [end(&ends.0)?, end(&ends.1)?];
        network.strands.iter_mut().for_each(|s| s.ends = ends);
        let (u, v): (Vec<usize>, Vec<usize>) = get(&options, "marks")?;
        let mut network = network.with_breaks(&u, &v).map_err(fair_error)?;
        network.kept.extend(get::<Vec<usize>>(&options, "fixed")?);
        if let Some(words) = get::<Option<[String; 4]>>(&options, "rims")? {
            network = network.with_rims(rims(&words)?).map_err(fair_error)?;
        }
        if get::<String>(&options, "order")? == "uv" {
            // Passes begin with the curves along v.
            let nv = self.spaces[1].count();
            network.strands.rotate_left(nv);
        }
        let (reported, points) = solved(py, network, &options, &[])?;
        let (spaces, weights) = (self.spaces.clone(), self.weights.clone());
        Ok((Self { spaces, points, weights }, reported))
    }

    /// Fairs a grid of data, point (i, j) at `i * n + j`: the faired net, the net through the data, the
    /// parameters of the data along u and v, and the report.
    #[staticmethod]
    #[expect(clippy::type_complexity, reason = "nets, parameters and the report")]
    fn fair_data<'py>(
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        shape: [usize; 2],
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Self, Self, (Vec<f64>, Vec<f64>), Bound<'py, PyDict>)> {
        let points = vectors(&points)?;
        let word: String = get(&options, "motion")?;
        let way = motion(&word, get(&options, "direction")?)?;
        let limit = Limit::new(way, get(&options, "tolerance")?).map_err(fair_error)?;
        let degrees: [usize; 2] = get(&options, "degree")?;
        let closed: [bool; 2] = get(&options, "closed")?;
        let spaced =
            spacing(&get::<String>(&options, "spacing")?, get(&options, "spacing_direction")?)?;
        let spaced = grid_spacing(&points, shape, spaced, closed, &limit.radii);
        let at = grid_parameters(&points, shape, spaced, closed, (limit.motion, &limit.radii))
            .map_err(fair_error)?;
        let marks: (Vec<usize>, Vec<usize>) = get(&options, "marks")?;
        let layout = |d: usize, marks: &[usize]| {
            InterpolationSpace::new(degrees[d], &at[d], marks, closed[d]).map_err(fair_error)
        };
        let layouts = [layout(0, &marks.0)?, layout(1, &marks.1)?];
        let rims = rims(&get::<[String; 4]>(&options, "rims")?)?;
        let data = GridData { points, limit, layouts, rims };
        let named = measure(&get::<String>(&options, "measure")?)?;
        let wanted = goal(&get(&options, "goal")?, SURFACE_BUDGET)?;
        let conditions: Vec<(String, [f64; 2], [f64; 3])> = get(&options, "conditions")?;
        let labels: Vec<String> = get(&options, "labels")?;
        let done = crate::work::interruptible(py, &Default::default(), move || {
            let mut owners = Vec::new();
            let made = (|| {
                let network = data.network(data.original()?)?;
                let mut all = Vec::new();
                for (k, one) in conditions.iter().enumerate() {
                    let own = condition(&network, one)?;
                    owners.extend(std::iter::repeat_n(k, own.len()));
                    all.extend(own);
                }
                let made = fair_grid(&data, named, wanted, &all, 1e-9)?;
                Ok::<_, FairError>((made, network, data))
            })();
            (made, owners)
        })?;
        let (made, network, data) = match done {
            (Ok(made), _) => made,
            (Err(FairError::Contradiction { conditions, ends, miss }), owners) => {
                return Err(contradiction(&conditions, ends, miss, &owners, &labels));
            }
            (Err(other), _) => return Err(fair_error(other)),
        };
        let jumps = |points: &[Vec3]| {
            let all = 0..network.strands.len();
            network.value(Measure::Jumps, all, points).map_err(fair_error)
        };
        let dict = PyDict::new(py);
        dict.set_item("measure_before", made.before)?;
        dict.set_item("measure_after", made.certificate.value)?;
        dict.set_item("jumps_before", jumps(&made.original)?)?;
        dict.set_item("jumps_after", jumps(&made.points)?)?;
        dict.set_item("certified", network.certified(&made.points))?;
        dict.set_item("sampled", network.sampled(&made.points))?;
        dict.set_item("used", made.used)?;
        dict.set_item("residuals", made.residuals.to_pyarray(py))?;
        dict.set_item("active", made.active)?;
        dict.set_item("certificate", certificate(py, &made.certificate)?)?;
        let spaces = [0, 1].map(|d| data.layouts[d].space.clone());
        let net = |points| Self { spaces: spaces.clone(), points, weights: None };
        let at = |d: usize| {
            let (a, b) = spaces[d].domain();
            data.layouts[d].at.iter().map(|t| (t - a) / (b - a)).collect()
        };
        Ok((net(made.points), net(made.original), (at(0), at(1)), dict))
    }

    /// Fairs surfaces with common edges together: the faired nets, their seams as (surface, direction,
    /// end) of both sides, and the report. Tolerances are those of all control points, net after net.
    #[staticmethod]
    #[expect(clippy::type_complexity, reason = "a seam is a pair of edges")]
    fn joined<'py>(
        py: Python<'py>,
        nets: Vec<PyRef<'_, Net>>,
        keeps: &str,
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Vec<Self>, Vec<[(usize, usize, usize); 2]>, Bound<'py, PyDict>)> {
        let radii: Vec<f64> = get(&options, "tolerance")?;
        let word: String = get(&options, "motion")?;
        let motion = motion(&word, get(&options, "direction")?)?;
        let rims = rims(&get::<[String; 4]>(&options, "rims")?)?;
        let mut at = 0;
        let mut sheets = Vec::new();
        for net in &nets {
            let own = radii.get(at..at + net.points.len()).unwrap_or_default().to_vec();
            at += net.points.len();
            let limit = Limit::new(motion, own).map_err(fair_error)?;
            let mut sheet = PatchNet::new(net.spaces.clone(), net.points.clone(), limit);
            sheet.weights.clone_from(&net.weights);
            sheet.rims = rims;
            sheets.push(sheet);
        }
        let seams = Seam::found(&sheets, end(keeps)?);
        for seam in &seams {
            for (k, edge) in seam.sheets.into_iter().zip(seam.edges) {
                sheets[k].rims[edge.direction][edge.end] = EndContinuity::Free;
            }
        }
        let network = Network::joined(&sheets, &seams).map_err(fair_error)?;
        let (reported, points) = solved(py, network.clone(), &options, &[])?;
        let net = |(k, old): (usize, &PyRef<'_, Net>)| Self {
            spaces: old.spaces.clone(),
            points: network.sheet(k, &points),
            weights: old.weights.clone(),
        };
        let side = |s: &Seam, k: usize| (s.sheets[k], s.edges[k].direction, s.edges[k].end);
        let pairs = seams.iter().map(|s| [side(s, 0), side(s, 1)]).collect();
        Ok((nets.iter().enumerate().map(net).collect(), pairs, reported))
    }
}

/// Conditions at the four rims: at both ends of u, then of v.
fn rims(words: &[String; 4]) -> PyResult<[[EndContinuity; 2]; 2]> {
    let rim = |k: usize| match words[k].as_str() {
        "corners" => Ok(EndContinuity::Free),
        word => end(word),
    };
    Ok([[rim(0)?, rim(1)?], [rim(2)?, rim(3)?]])
}

/// Curves over common points.
#[pyclass(frozen, module = "moldloft._core")]
pub struct Web {
    points: Vec<Vec3>,
    /// Parameters, closed, own marks.
    curves: Vec<(Vec<usize>, bool, Vec<usize>)>,
    degree: usize,
}

/// A curve before and after, and their distance: certified, and by sampling.
type PairOfCurves = (Spline, Spline, f64, f64);

#[pymethods]
impl Web {
    #[new]
    fn new(
        points: PyReadonlyArray2<'_, f64>,
        curves: Vec<(Vec<usize>, bool, Vec<usize>)>,
        degree: usize,
    ) -> PyResult<Self> {
        Ok(Self { points: vectors(&points)?, curves, degree })
    }

    /// Fairs: the faired points, each curve before and after, and the report.
    fn fair<'py>(
        &self,
        py: Python<'py>,
        options: Bound<'py, PyDict>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<PairOfCurves>, Bound<'py, PyDict>)> {
        let word: String = get(&options, "motion")?;
        let motion = motion(&word, get(&options, "direction")?)?;
        let limit = Limit::new(motion, get(&options, "tolerance")?).map_err(fair_error)?;
        let motion = limit.motion;
        let mut strands = Vec::new();
        let word: String = get(&options, "spacing")?;
        let spaced = spacing(&word, get(&options, "spacing_direction")?)?;
        let names: Vec<String> = get(&options, "names")?;
        let lists: Vec<(Vec<usize>, bool)> =
            self.curves.iter().map(|c| (c.0.clone(), c.1)).collect();
        let named = NamedCurves { curves: &lists, names: &names };
        let held: Vec<(usize, [f64; 3])> = get(&options, "held")?;
        let held: Vec<(usize, Vec3)> = held.into_iter().map(|(i, d)| (i, d.into())).collect();
        for (k, (own, closed, marks)) in self.curves.iter().enumerate() {
            let form = if *closed { "closed" } else { "floating" };
            let space = space(self.degree, own.len(), form, None, None)
                .map_err(|e| refused(format!("{}: {e}", named.name(k))))?;
            strands.push(NetworkCurve {
                space,
                points: own.clone(),
                weights: None,
                marks: marks.clone(),
                runs: Vec::new(),
                ends: [EndContinuity::Points(1); 2],
                at: match spaced {
                    ParameterSpacing::Uniform => None,
                    spaced => {
                        let list: Vec<Vec3> = own.iter().map(|&i| self.points[i]).collect();
                        let radii: Vec<f64> = own.iter().map(|&i| limit.radii[i]).collect();
                        // Chords are measured across the way in which the curve's own points move.
                        let way = one_way(motion, &held, own);
                        let limits = (way.map_or(motion, Motion::Along), &radii[..]);
                        let at =
                            parameters_across(&list, spaced, *closed, limits).or_else(|error| {
                                match error {
                                    // Sections run across the stations.
                                    FairError::TurnsAlong { .. } | FairError::Coincident { .. }
                                        if matches!(spaced, ParameterSpacing::Along(_)) =>
                                    {
                                        parameters_across(
                                            &list,
                                            ParameterSpacing::Chord,
                                            *closed,
                                            limits,
                                        )
                                    }
                                    error => Err(error),
                                }
                            });
                        Some(at.map_err(|e| refused(format!("{}: {e}", named.name(k))))?)
                    }
                },
            });
        }
        let mut network = Network::new(self.points.clone(), strands, limit).map_err(fair_error)?;
        network.kept = get(&options, "fixed")?;
        let mut network = network.with_held(held).map_err(fair_error)?;
        network.bound = bound(&get::<String>(&options, "bound")?)?;
        let (wanted, labels) = network_conditions(&network, named, &options)?;
        if !wanted.is_empty() {
            network = network.with_conditions(wanted).map_err(|e| shape_error(e, &labels))?;
        }
        let (reported, points) = solved(py, network.clone(), &options, &labels)?;
        // What was released has no place to be far from.
        for i in get::<Vec<usize>>(&options, "release")? {
            network.points[i] = points[i];
        }
        let pair = |k: usize| -> PyResult<PairOfCurves> {
            let pair = network.curve_pair(k, &points).map_err(fair_error)?;
            let far = pair.deviation().map_err(fair_error)?;
            let spline = |points| Spline { space: pair.space.clone(), points, weights: None };
            Ok((spline(pair.before), spline(pair.after), far.certified, far.sampled))
        };
        let pairs = (0..network.strands.len()).map(pair).collect::<PyResult<_>>()?;
        let fill = |out: &mut [Vec3]| out.copy_from_slice(&points);
        Ok((arrays::filled(py, [points.len(), 3], fill).0, pairs, reported))
    }
}

/// The conditions of a network, each with its name.
fn network_conditions(
    network: &Network,
    named: NamedCurves<'_>,
    options: &Bound<'_, PyDict>,
) -> PyResult<(Vec<NetworkCondition>, Vec<String>)> {
    let (mut wanted, mut labels) = (Vec::new(), Vec::new());
    for text in get::<Vec<String>>(options, "shape")? {
        for condition in NetworkCondition::read(&text, named).map_err(refused)? {
            labels.push(match &condition {
                NetworkCondition::Curve { curve, .. } | NetworkCondition::Tangent { curve, .. } => {
                    let name = named.name(*curve);
                    if text.starts_with(&format!("{name}: ")) {
                        text.clone()
                    } else {
                        format!("{text} ({name})")
                    }
                }
                _ => text.clone(),
            });
            wanted.push(condition);
        }
    }
    for word in get::<Vec<String>>(options, "keep")? {
        let way = match network.limit.motion {
            Motion::Along(way) => Some(way),
            _ => None,
        };
        let kept = NetworkCondition::kept(&word, way).ok_or_else(|| {
            refused(format!("`{word}` of a network cannot be kept; what can: volume, centroid"))
        })?;
        wanted.push(kept);
        labels.push(format!("keep {word}"));
    }
    Ok((wanted, labels))
}

/// A fault of conditions with their names.
fn shape_error(error: FairError, labels: &[String]) -> PyErr {
    let name = |k: &usize| labels.get(*k).map_or("a condition", String::as_str);
    match error {
        FairError::Shapeless { shape, why } => refused(format!("{}: {why}", name(&shape))),
        FairError::Shape { shapes, miss } => {
            let all: Vec<&str> = shapes.iter().map(name).collect();
            refused(format!(
                "no network with these shapes was found within the tolerances (missed by {miss:.3e}): {}",
                all.join("; ")
            ))
        }
        other => fair_error(other),
    }
}

fn solved<'py>(
    py: Python<'py>,
    network: Network,
    options: &Bound<'py, PyDict>,
    shapes: &[String],
) -> PyResult<(Bound<'py, PyDict>, Vec<Vec3>)> {
    let measure = measure(&get::<String>(options, "measure")?)?;
    let mode: String = get(options, "mode")?;
    let (passes, steps): (usize, usize) = (get(options, "passes")?, get(options, "steps")?);
    let mode = match mode.as_str() {
        "optimum" => match get::<Option<(String, Option<f64>)>>(options, "goal")? {
            Some(word) => {
                let budget = if word.0 == "near" { NETWORK_BUDGET } else { SURFACE_BUDGET };
                NetworkMode::Toward(goal(&word, budget)?)
            }
            None => NetworkMode::Joint(bound(&get::<String>(options, "bound")?)?),
        },
        "sweeps" => NetworkMode::Sweeps(steps),
        "faithful" => NetworkMode::Passes(passes, steps),
        _ => {
            let known = "optimum, faithful, sweeps";
            return Err(refused(format!(
                "unknown mode `{mode}` of nets; expected one of: {known}"
            )));
        }
    };
    let wanted: Vec<(String, [f64; 2], [f64; 3])> = get(options, "conditions")?;
    let labels: Vec<String> = get(options, "labels")?;
    let done = crate::work::interruptible(py, &Default::default(), move || {
        let (mut conditions, mut owners) = (Vec::new(), Vec::new());
        for (k, one) in wanted.iter().enumerate() {
            let all = match condition(&network, one) {
                Ok(all) => all,
                Err(error) => return (Err(error), owners),
            };
            owners.extend(std::iter::repeat_n(k, all.len()));
            conditions.extend(all);
        }
        (network.report_with(measure, mode, conditions), owners)
    })?;
    let reported = match done {
        (Ok(reported), _) => reported,
        (Err(FairError::Contradiction { conditions, ends, miss }), owners) => {
            return Err(contradiction(&conditions, ends, miss, &owners, &labels));
        }
        (Err(other), _) => return Err(shape_error(other, shapes)),
    };
    let dict = dictionary(py, &reported)?;
    Ok((dict, reported.points))
}

fn dictionary<'py>(py: Python<'py>, r: &NetworkReport) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("measure_before", r.measure[0])?;
    dict.set_item("measure_after", r.measure[1])?;
    dict.set_item("jumps_before", r.jumps[0])?;
    dict.set_item("jumps_after", r.jumps[1])?;
    dict.set_item("certified", r.certified)?;
    dict.set_item("sampled", r.sampled)?;
    dict.set_item("used", r.used)?;
    dict.set_item("bent", &r.bent)?;
    let swings: Vec<(usize, usize, f64)> =
        r.swings.iter().map(|s| (s.curve, s.point, s.share)).collect();
    dict.set_item("swings", swings)?;
    let arc = |a: &moldloft::fair::NetworkArc| (a.curve, a.between, a.radius);
    dict.set_item("arcs", r.arcs.iter().map(arc).collect::<Vec<_>>())?;
    dict.set_item("certificate", certificate(py, &r.certificate)?)?;
    Ok(dict)
}

/// One condition of the user's as linear conditions.
fn condition(
    network: &Network,
    (word, at, v): &(String, [f64; 2], [f64; 3]),
) -> Result<Vec<Condition>, FairError> {
    let (at, v) = (*at, Vec3::from(*v));
    match word.as_str() {
        "through" => network.point_condition(at, v),
        "normal" => network.normal_condition(at, v),
        "tangent_u" => network.tangent_condition(at, 0, v),
        "tangent_v" => network.tangent_condition(at, 1, v),
        "area" => Ok(vec![network.area_condition()?]),
        _ => Ok(vec![network.volume_condition()?]),
    }
}
