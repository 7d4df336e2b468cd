//! From options to reports.

use super::arguments::{certificate, fair_error, measure, refused};
use super::spline::{Spline, reported, spacing};
use moldloft::fair::{
    Bound as Bounded, Condition, CurveStatistics, Data, DataOptions, EndContinuity, FairError,
    FairingReport, Goal, InterpolationSpace, Job, KnotRemovalOptions, Limit, Mode, Motion,
    OptimumOptions, RemovalStep, Rule, ShapeCondition, Space, Stops, curvature_parameters,
    data_report, knot_removal, merged, near_budget, parameters_across, report, shape, thinned,
};
use moldloft::num::{Order, Vec3};
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
    if let Some(count) = word.strip_prefix("points:").and_then(|n| n.parse().ok()) {
        return Ok(EndContinuity::Points(count));
    }
    EndContinuity::named(word).ok_or_else(|| {
        refused(format!(
            "unknown end condition `{word}`; expected one of: free, position, tangent, curvature"
        ))
    })
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

/// One condition of the user's as linear conditions.
fn conditions(
    space: &Space,
    points: &[Vec3],
    (word, t, v, second): &(String, f64, [f64; 3], [f64; 3]),
) -> PyResult<Vec<Condition>> {
    let (t, v) = (*t, *v);
    let (a, b) = space.domain();
    let at = a + (b - a) * t;
    Ok(match word.as_str() {
        "through" => Condition::point(space, at, v.into()),
        "join" => Condition::join(space, points, t > 0.5, [v.into(), (*second).into()])
            .map_err(fair_error)?,
        "tangent" => Condition::tangent(space, at, v.into()),
        "derivative" => {
            let scaled = Vec3::from(v) * (1.0 / (b - a));
            Condition::derivative(space, at, Order::First, scaled)
        }
        "centroid" => Condition::centroid(points),
        "area" => vec![Condition::area(space, points, v.into())],
        "volume" => vec![Condition::revolution(space, points, v.into())],
        _ => return Err(refused(format!("unknown condition `{word}`"))),
    })
}

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
            let wanted: Vec<(String, f64, [f64; 3], [f64; 3])> = get(options, "conditions")?;
            for (k, one) in wanted.iter().enumerate() {
                let all = conditions(&job.space, &job.points, one)?;
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

/// The goal called `word`, with its share.
pub fn goal((word, share): &(String, f64)) -> PyResult<Goal> {
    Ok(match word.as_str() {
        "near" => Goal::Near(*share),
        "fairest" => Goal::Fairest,
        "budget" => Goal::Budget(*share),
        "nearest" => Goal::Nearest(*share),
        "energy" => Goal::Energy(*share),
        "closest" => Goal::Closest,
        _ => {
            let known = "near, fairest, budget, nearest, energy, closest";
            return Err(refused(format!("unknown goal `{word}`; expected one of: {known}")));
        }
    })
}

/// A shape: its word, points or a count, a direction and a number, those that it has.
pub type ShapeOption = (String, usize, usize, Option<[f64; 3]>, f64);

fn condition_of_shape((word, a, b, v, x): &ShapeOption, count: usize) -> PyResult<ShapeCondition> {
    let between = [*a, *b];
    let direction = || {
        v.map(Vec3::from).ok_or_else(|| refused(format!("the shape `{word}` needs a direction")))
    };
    if let Some(k) = between.into_iter().find(|&k| k >= count)
        && word != "pieces"
    {
        return Err(fair_error(FairError::Mark { index: k, count }));
    }
    Ok(match word.as_str() {
        "convex" | "concave" => ShapeCondition::Turn { between, left: word == "convex" },
        "one-way" => ShapeCondition::OneWay { between },
        "straight" => ShapeCondition::Straight { between, along: v.map(Vec3::from) },
        "arc" => ShapeCondition::Arc { between },
        "pieces" => ShapeCondition::Pieces(*a),
        "within" => ShapeCondition::Within { direction: direction()?, most: *x },
        "side" => ShapeCondition::OneSided { direction: direction()? },
        _ => {
            let known = "convex, concave, one-way, straight, arc, pieces, within, side";
            return Err(refused(format!("unknown shape `{word}`; expected one of: {known}")));
        }
    })
}

/// A shape as the command writes it, for a number of points.
#[pyfunction]
pub fn fair_shape(text: &str, count: usize) -> PyResult<ShapeOption> {
    use ShapeCondition as C;
    let made = C::read(text, count).map_err(refused)?;
    let plain = |word: &str, [a, b]: [usize; 2]| (word.to_string(), a, b, None, 0.0);
    Ok(match made {
        C::Turn { between, left } => plain(if left { "convex" } else { "concave" }, between),
        C::OneWay { between } => plain("one-way", between),
        C::Straight { between: [a, b], along } => {
            ("straight".to_string(), a, b, along.map(|d| d.to_array()), 0.0)
        }
        C::Arc { between } => plain("arc", between),
        C::Pieces(k) => plain("pieces", [k, k]),
        C::Within { direction, most } => {
            ("within".to_string(), 0, 0, Some(direction.to_array()), most)
        }
        C::OneSided { direction } => ("side".to_string(), 0, 0, Some(direction.to_array()), 0.0),
    })
}

/// Fairs data under tolerances: the faired curve, the curve through the data, and the report.
pub fn data<'py>(
    py: Python<'py>,
    points: Vec<Vec3>,
    options: Options<'_, 'py>,
) -> PyResult<(Spline, Spline, Bound<'py, PyDict>)> {
    let radii: Vec<f64> = get(options, "tolerance")?;
    let motion = motion(&get::<String>(options, "motion")?, get(options, "direction")?)?;
    let ends: (String, String) = get(options, "ends")?;
    let closed: bool = get(options, "closed")?;
    let degree: usize = get(options, "degree")?;
    let breaks: Vec<usize> = get(options, "breaks")?;
    let one = merged(&points, &radii, closed).map_err(fair_error)?;
    let limit = Limit::new(motion, one.radii.clone()).map_err(fair_error)?;
    let budget = near_budget(&one.points, limit.motion);
    let mut turning = false;
    let at = match get::<Option<Vec<f64>>>(options, "at")? {
        Some(all) if one.points.len() < points.len() => {
            let first = |k: usize| one.of.iter().position(|&o| o == k).unwrap_or(0);
            (0..one.points.len()).map(|k| all[first(k)]).collect()
        }
        Some(all) => all,
        None => {
            let word: String = get(options, "spacing")?;
            turning = word == "curvature";
            let chosen = if turning { "chord" } else { &word };
            let spaced = spacing(chosen, get(options, "spacing_direction")?)?;
            parameters_across(&one.points, spaced, closed, (limit.motion, &limit.radii))
                .map_err(fair_error)?
        }
    };
    let breaks: Vec<usize> = breaks.iter().filter_map(|&b| one.of.get(b).copied()).collect();
    let wanted: Vec<ShapeCondition> = get::<Vec<ShapeOption>>(options, "shape")?
        .iter()
        .map(|one| condition_of_shape(one, points.len()))
        .collect::<PyResult<_>>()?;
    let shape_labels: Vec<String> = get(options, "shape_labels")?;
    let renumbered: Vec<ShapeCondition> =
        wanted.iter().map(|w| w.renumbered(|k| one.of.get(k).copied().unwrap_or(k))).collect();
    let ends = [end(&ends.0)?, end(&ends.1)?];
    let thin = if get(options, "thin")? && breaks.is_empty() {
        thinned(&one.points, &limit, ends, degree, closed, turning).map_err(fair_error)?
    } else {
        None
    };
    turning &= thin.is_none();
    let layout = match thin {
        Some(thin) => thin,
        None => InterpolationSpace::new(degree, &at, &breaks, closed).map_err(fair_error)?,
    };
    let mut data = Data { limit, layout, ends, points: one.points.clone() };
    if turning {
        let own = curvature_parameters(&data, &data.points, &data.limit.radii, &at, budget)
            .map_err(fair_error)?;
        data.layout = InterpolationSpace::new(degree, &own, &breaks, closed).map_err(fair_error)?;
    }
    let unshaped = |e: FairError| match e {
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
    };
    let (data, shape) = data.shaped(&renumbered).map_err(&unshaped)?;
    let mut owners = Vec::new();
    let mut chosen = DataOptions {
        measure: measure(&get::<String>(options, "measure")?)?,
        goal: match get::<(String, Option<f64>)>(options, "goal")? {
            (word, Some(share)) => goal(&(word, share))?,
            (word, None) => goal(&(word, budget))?,
        },
        conditions: Vec::new(),
        shape,
        bends: get(options, "bends")?,
        accuracy: get(options, "accuracy")?,
    };
    let wanted: Vec<(String, f64, [f64; 3], [f64; 3])> = get(options, "conditions")?;
    if !wanted.is_empty() {
        let control = data.layout.through(&data.layout.data(&data.points)).map_err(fair_error)?;
        for (k, one) in wanted.iter().enumerate() {
            let all = conditions(&data.layout.space, &control, one)?;
            owners.extend(std::iter::repeat_n(k, all.len()));
            chosen.conditions.extend(all);
        }
    }
    let labels: Vec<String> = get(options, "labels")?;
    let done = crate::work::interruptible(py, &Default::default(), move || {
        data_report(&data, &chosen).map(|made| (data, made))
    })?;
    let (data, (made, reported)) = match done {
        Ok(done) => done,
        Err(FairError::Contradiction { conditions, ends, miss }) => {
            return Err(contradiction(&conditions, ends, miss, &owners, &labels));
        }
        Err(other) => return Err(unshaped(other)),
    };
    let space = data.layout.space.clone();
    let dict = dictionary(py, &reported)?;
    let off = |k: usize| {
        let t = data.layout.at[one.of[k]];
        (shape::sample_at(&space, &made.points, None, t).point - points[k]).norm()
    };
    let off: Vec<f64> = (0..points.len()).map(off).collect();
    dict.set_item("residuals", off.to_pyarray(py))?;
    let (a, b) = space.domain();
    let at: Vec<f64> = one.of.iter().map(|&k| (data.layout.at[k] - a) / (b - a)).collect();
    dict.set_item("at", at.to_pyarray(py))?;
    dict.set_item("thin", !data.layout.interpolates())?;
    dict.set_item("used", made.used)?;
    dict.set_item("least", made.least)?;
    let arc = |a: &moldloft::fair::FoundArc| {
        let user = |k: usize| one.of.iter().position(|&o| o == k).unwrap_or(k);
        (a.between.map(user), a.radius, a.centre.to_array(), a.off)
    };
    dict.set_item("arcs", made.arcs.iter().map(arc).collect::<Vec<_>>())?;
    let marks: Vec<usize> = data.layout.marks.iter().map(|&m| data.layout.control_of(m)).collect();
    dict.set_item("marks", marks)?;
    let spline = |points: Vec<Vec3>| Spline { space: space.clone(), points, weights: None };
    Ok((spline(made.points), spline(made.original), dict))
}

/// Which of the user's conditions contradict each other or the tolerance.
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
