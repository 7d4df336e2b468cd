//! From options to reports.

use super::arguments::{certificate, fair_error, measure, refused};
use super::spline::{Spline, reported};
use moldloft::fair::{
    Bound as Bounded, CurveRequest, CurveStatistics, Demand, EndContinuity, FairError,
    FairingReport, Goal, Job, KnotRemovalOptions, Limit, Mode, Motion, NearCurve, OptimumOptions,
    ParameterSpacing, PointSpacing, RemovalStep, Rule, ShapeCondition, Stops, knot_removal,
    near_budget, report, shape, words,
};
use moldloft::num::Vec3;
use numpy::ToPyArray;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Options<'a, 'py> = &'a Bound<'py, PyDict>;

pub fn get<'py, R>(options: Options<'_, 'py>, name: &str) -> PyResult<R>
where
    R: FromPyObjectOwned<'py>,
{
    let value = options.get_item(name)?.ok_or_else(|| refused(format!("no option `{name}`")))?;
    value.extract().map_err(Into::into)
}

pub fn motion(word: &str, direction: [f64; 3]) -> PyResult<Motion> {
    Ok(match word {
        "ball" => Motion::Ball,
        "box" => Motion::Box,
        "along" => Motion::Along(direction.into()),
        "across" => Motion::Across(direction.into()),
        _ => return Err(refused(format!("unknown motion `{word}`"))),
    })
}

pub fn end(word: &str) -> PyResult<EndContinuity> {
    words::end(word).map_err(refused)
}

pub fn bound(word: &str) -> PyResult<Bounded> {
    Ok(match word {
        "points" => Bounded::ControlPoints,
        "curve" => Bounded::Bezier,
        _ => {
            return Err(refused(format!("unknown bound `{word}`; expected one of: curve, points")));
        }
    })
}

/// A condition: its word, its parameter in [0, 1], and one or two vectors.
type PlacedCondition = (String, f64, [f64; 3], [f64; 3]);

/// The job and the mode of a curve's options.
fn asked(spline: &Spline, options: Options) -> PyResult<(Job, Mode, Vec<usize>)> {
    let radii: Vec<f64> = get(options, "tolerance")?;
    let motion = motion(&get::<String>(options, "motion")?, get(options, "direction")?)?;
    let ends: (String, String) = get(options, "ends")?;
    let mut limit = Limit::new(motion, radii).map_err(fair_error)?;
    for index in get::<Vec<usize>>(options, "fixed")? {
        let count = limit.radii.len();
        let radius = limit.radii.get_mut(index);
        *radius.ok_or_else(|| fair_error(FairError::Mark { index, count }))? = 0.0;
    }
    let job = Job {
        space: spline.space.clone(),
        points: spline.points.clone(),
        weights: spline.weights.clone(),
        limit,
        marks: get(options, "marks")?,
        ends: [end(&ends.0)?, end(&ends.1)?],
    };
    job.check().map_err(fair_error)?;
    let named = measure(&get::<String>(options, "measure")?)?;
    let mode: String = get(options, "mode")?;
    let steps: usize = get(options, "steps")?;
    let mut owners = Vec::new();
    let local = |rule, step| {
        let (least_move, least_drop, gap, pieces) = get(options, "stops")?;
        Ok::<_, PyErr>(Mode::KnotRemoval(KnotRemovalOptions {
            rule,
            step,
            measure: named,
            stops: Stops { steps, least_move, least_drop, gap, pieces },
            log: get(options, "log")?,
        }))
    };
    let mode = match mode.as_str() {
        "optimum" => {
            let mut chosen = OptimumOptions::of(named);
            chosen.bound = bound(&get::<String>(options, "bound")?)?;
            chosen.accuracy = get(options, "accuracy")?;
            let wanted: Vec<PlacedCondition> = get(options, "conditions")?;
            for (k, one) in wanted.iter().enumerate() {
                let (t, demand) = demand(one)?;
                let all = demand.conditions(&job.space, &job.points, t).map_err(fair_error)?;
                owners.extend(std::iter::repeat_n(k, all.len()));
                chosen.conditions.extend(all);
            }
            Mode::Optimum(chosen)
        }
        "faithful" => local(Rule::Achievable, RemovalStep::Knot)?,
        "literal" => local(Rule::Literal, RemovalStep::Knot)?,
        "vertex" => local(Rule::Achievable, RemovalStep::Vertex)?,
        "sweeps" => Mode::Sweeps(named, steps),
        "levels" => Mode::Multilevel(named, steps),
        _ => {
            let known = "optimum, faithful, literal, vertex, sweeps, levels";
            return Err(refused(format!("unknown mode `{mode}`; expected one of: {known}")));
        }
    };
    Ok((job, mode, owners))
}

pub fn curve<'py>(
    py: Python<'py>,
    spline: &Spline,
    options: Options<'_, 'py>,
) -> PyResult<(Spline, Bound<'py, PyDict>)> {
    let (job, mode, owners) = asked(spline, options)?;
    let labels: Vec<String> = get(options, "labels")?;
    let logged = matches!(&mode, Mode::KnotRemoval(options) if options.log);
    let done = crate::work::interruptible(py, &Default::default(), move || {
        let reported = report(&job, &mode)?;
        // The steps are made again for their log: a log of all steps is not always wanted.
        let log = match &mode {
            Mode::KnotRemoval(options) if logged => knot_removal(&job, options)?.log,
            _ => Vec::new(),
        };
        Ok::<_, FairError>((reported, log))
    })?;
    let (reported, log) = match done {
        Ok(done) => done,
        Err(FairError::Contradiction { conditions, ends, miss }) => {
            return Err(contradiction(&conditions, ends, miss, &owners, &labels));
        }
        Err(other) => return Err(fair_error(other)),
    };
    let dict = dictionary(py, &reported)?;
    if logged {
        let index: Vec<u32> = log.iter().map(|m| m.index).collect();
        let to: Vec<Vec3> = log.iter().map(|m| m.to).collect();
        dict.set_item("log_index", index.to_pyarray(py))?;
        let fill = |out: &mut [Vec3]| out.copy_from_slice(&to);
        dict.set_item("log_to", crate::arrays::filled(py, [to.len(), 3], fill).0)?;
    }
    let faired = Spline {
        space: spline.space.clone(),
        points: reported.points,
        weights: spline.weights.clone(),
    };
    Ok((faired, dict))
}

/// The goal called `word`, with its share; that of "near" and "budget" without one.
pub fn goal((word, share): &(String, Option<f64>), budget: f64) -> PyResult<Goal> {
    words::goal(word, *share, budget).map_err(refused)
}

/// A spacing: a word, or "along" and the direction.
pub fn point_spacing(word: &str, direction: [f64; 3]) -> PyResult<PointSpacing> {
    if word == "along" {
        return Ok(PointSpacing::Given(ParameterSpacing::Along(direction.into())));
    }
    words::spacing(word).map_err(refused)
}

/// A condition from its word and vectors.
fn demand((word, t, v, second): &PlacedCondition) -> PyResult<(f64, Demand)> {
    let v = Vec3::from(*v);
    let demand = match word.as_str() {
        "through" => Demand::Through(v),
        "tangent" => Demand::Tangent(v),
        "join" => Demand::Join([v, (*second).into()]),
        word => Demand::kept(word).ok_or_else(|| {
            refused(format!("`{word}` cannot be kept; what can: area, centroid, volume"))
        })?,
    };
    Ok((*t, demand))
}

/// The request of a curve near its points, and how its conditions and shapes are called.
fn request(points: &[Vec3], options: Options) -> PyResult<CurveRequest<f64>> {
    let motion = motion(&get::<String>(options, "motion")?, get(options, "direction")?)?;
    let ends: [Option<String>; 2] = get(options, "ends")?;
    let kept = |k: usize| match &ends[k] {
        Some(word) => end(word),
        None => Ok(EndContinuity::Free),
    };
    let measured = get::<Option<String>>(options, "measure")?;
    let shape = get::<Vec<String>>(options, "shape")?;
    let shape = shape.iter().map(|text| ShapeCondition::read(text, points.len()));
    let conditions: Vec<PlacedCondition> = get(options, "conditions")?;
    let spaced = get::<String>(options, "spacing")?;
    Ok(CurveRequest {
        tolerances: get(options, "tolerance")?,
        fixed: get(options, "fixed")?,
        release: get(options, "release")?,
        breaks: get(options, "breaks")?,
        degree: get(options, "degree")?,
        closed: get(options, "closed")?,
        measure: measured.as_deref().map(measure).transpose()?,
        goal: goal(&get(options, "goal")?, near_budget(points, motion))?,
        spacing: point_spacing(&spaced, get(options, "spacing_direction")?)?,
        at: get(options, "at")?,
        ends: [kept(0)?, kept(1)?],
        motion,
        shape: shape.collect::<Result<_, _>>().map_err(refused)?,
        conditions: conditions.iter().map(demand).collect::<PyResult<_>>()?,
        bends: get(options, "bends")?,
        accuracy: get(options, "accuracy")?,
        draft: get(options, "draft")?,
    })
}

/// Fairs data under tolerances: the faired curve, the curve through the data, and the report.
pub fn data<'py>(
    py: Python<'py>,
    points: Vec<Vec3>,
    options: Options<'_, 'py>,
) -> PyResult<(Spline, Spline, Bound<'py, PyDict>)> {
    let asked = request(&points, options)?;
    let labels: Vec<String> = get(options, "labels")?;
    let shape_labels: Vec<String> = get(options, "shape")?;
    let own = points.clone();
    let done = crate::work::interruptible(py, &Default::default(), move || {
        let curve = asked.curve(&own)?;
        let reported = curve.report()?;
        Ok::<_, FairError>((curve, reported))
    })?;
    let (curve, reported) = done.map_err(|error| match error {
        FairError::Contradiction { conditions, ends, miss } => {
            let owners: Vec<usize> = (0..labels.len()).collect();
            contradiction(&conditions, ends, miss, &owners, &labels)
        }
        FairError::Shape { shapes, miss } => {
            let named: Vec<&str> =
                shapes.iter().filter_map(|&k| shape_labels.get(k)).map(String::as_str).collect();
            refused(format!(
                "no curve with this shape was found within the tolerance (missed by {miss:.3e}): {}",
                named.join("; ")
            ))
        }
        FairError::Shapeless { shape, why } => {
            let label = shape_labels.get(shape).map_or("shape", String::as_str);
            refused(format!("{label}: {why}"))
        }
        other => fair_error(other),
    })?;
    let NearCurve { data, of, fit, .. } = curve;
    let space = data.layout.space.clone();
    let dict = dictionary(py, &reported)?;
    let off = |k: usize| {
        let t = data.layout.at[of[k]];
        (shape::sample_at(&space, &fit.points, None, t).point - points[k]).norm()
    };
    let off: Vec<f64> = (0..points.len()).map(off).collect();
    dict.set_item("residuals", off.to_pyarray(py))?;
    let (a, b) = space.domain();
    let at: Vec<f64> = of.iter().map(|&k| (data.layout.at[k] - a) / (b - a)).collect();
    dict.set_item("at", at.to_pyarray(py))?;
    dict.set_item("thin", !data.layout.interpolates())?;
    dict.set_item("refined", data.layout.is_refined())?;
    dict.set_item("used", fit.used)?;
    dict.set_item("least", fit.least)?;
    dict.set_item("fairer", fit.fairer)?;
    let arc = |a: &moldloft::fair::FoundArc| {
        let user = |k: usize| of.iter().position(|&o| o == k).unwrap_or(k);
        (a.between.map(user), a.radius, a.centre.to_array(), a.off)
    };
    dict.set_item("arcs", fit.arcs.iter().map(arc).collect::<Vec<_>>())?;
    let marks: Vec<usize> = data.layout.marks.iter().map(|&m| data.layout.control_of(m)).collect();
    dict.set_item("marks", marks)?;
    let spline = |points: Vec<Vec3>| Spline { space: space.clone(), points, weights: None };
    Ok((spline(fit.points), spline(fit.original), dict))
}

/// Error for the user's conditions that contradict each other or the tolerance.
pub fn contradiction(
    conditions: &[usize],
    ends: bool,
    miss: f64,
    owners: &[usize],
    labels: &[String],
) -> PyErr {
    // Those of seams come after the user's.
    let mut whose: Vec<usize> =
        conditions.iter().filter_map(|&c| owners.get(c)).map(|owner| owner + 1).collect();
    whose.dedup();
    let seams = conditions.iter().any(|&c| c >= owners.len());
    let list: Vec<String> = whose.iter().map(usize::to_string).collect();
    let named: Vec<&str> =
        whose.iter().filter_map(|k| labels.get(k - 1)).map(String::as_str).collect();
    let what = match (whose.len(), ends) {
        (0, _) if seams => "the continuity across seams".to_string(),
        (0, _) => "the conditions of the ends".to_string(),
        (1, false) => format!("condition {}", list[0]),
        (1, true) => format!("condition {} and those of the ends", list[0]),
        (_, false) => format!("conditions {}", list.join(", ")),
        (_, true) => format!("conditions {} and those of the ends", list.join(", ")),
    };
    let named = if named.is_empty() { String::new() } else { format!(": {}", named.join("; ")) };
    refused(format!("{what} cannot hold within the tolerance (missed by {miss:.3e}){named}"))
}

fn numbers<'py>(py: Python<'py>, n: &CurveStatistics) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("measure", n.measure)?;
    dict.set_item("jumps", n.jumps)?;
    dict.set_item("largest_jump", n.largest_jump)?;
    dict.set_item("pieces", n.pieces)?;
    dict.set_item("inflections", n.inflections)?;
    dict.set_item("largest_curvature", n.largest_curvature)?;
    Ok(dict)
}

fn dictionary<'py>(py: Python<'py>, r: &FairingReport) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("measure", r.measure)?;
    dict.set_item("before", numbers(py, &r.before)?)?;
    dict.set_item("after", numbers(py, &r.after)?)?;
    let far = PyDict::new(py);
    far.set_item("control", r.deviation.control)?;
    far.set_item("certified", r.deviation.certified)?;
    far.set_item("sampled", r.deviation.sampled)?;
    far.set_item("length", r.deviation.length)?;
    dict.set_item("deviation", far)?;
    dict.set_item("certificate", certificate(py, &r.certificate)?)?;
    dict.set_item("steps", r.steps)?;
    dict.set_item("stopped", r.stopped.map(|s| s.name()))?;
    dict.set_item("active", r.active)?;
    dict.set_item("findings", r.findings.iter().copied().map(reported).collect::<Vec<_>>())?;
    dict.set_item("jumps_before", r.jumps[0].to_pyarray(py))?;
    dict.set_item("jumps_after", r.jumps[1].to_pyarray(py))?;
    dict.set_item("notes", &r.notes)?;
    Ok(dict)
}
