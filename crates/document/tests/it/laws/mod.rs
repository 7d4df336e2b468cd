//! Exact derivatives against differences, on random models that have every kind of the registry.

mod program;
mod recipes;

pub use self::program::{model, parts};
use crate::common::{line, open, rounds};
use moldloft_document::Document;
use moldloft_hydro::surface_measures;
use moldloft_num::{Order, Vec3, gauss_legendre};
use moldloft_registry::{Class, Value};
use moldloft_testing::{ridders_vectors, soak};
use rayon::prelude::*;
use std::collections::HashMap;

/// Values, flat, and the object (or measured number) that each belongs to.
#[derive(Clone)]
struct Sample {
    values: Vec<f64>,
    owners: Vec<usize>,
    /// The objects as they were.
    objects: HashMap<String, Value<f64>>,
}

const TS: [f64; 5] = [0.0, 0.29, 0.5, 0.83, 1.0];
const US: [f64; 5] = [0.0, 0.23, 0.5, 0.71, 1.0];
/// Steps of a scheme of differences.
const LEVELS: usize = 5;

/// The expressions that are measured: positions of objects, and numbers.
pub fn expressions(document: &Document) -> (Vec<String>, Vec<String>) {
    let (mut positions, mut numbers) = (Vec::new(), Vec::new());
    for object in document.graph().objects() {
        let name = &object.name;
        match object.value() {
            Some(Value::Numbers(_)) if object.row.name.starts_with("Weight") => {
                positions.push(format!("{name}.centre"));
                numbers.push(format!("{name}.mass"));
            }
            Some(Value::Point(_)) => positions.push(name.to_string()),
            Some(Value::Curve(_)) => {
                positions.push(format!("{name}({{0, 0.29, 0.5, 0.83, 1}})"));
                numbers.push(format!("{name}.length"));
            }
            Some(Value::Body(_)) => {
                positions.push(format!("{name}.centroid"));
                numbers.push(format!("{name}.volume"));
                numbers.push(format!("{name}.area"));
            }
            Some(Value::Surface(_)) => {
                positions
                    .push(format!("{name}({{0, 0.29, 0.5, 0.83, 1}}, {{0, 0.23, 0.5, 0.71, 1}})"));
                numbers.push(format!("{name}.area"));
            }
            Some(Value::Solid(_)) => {
                positions.push(format!(
                    "{name}({{0, 0.29, 0.5, 0.83, 1}}, {{0, 0.23, 0.5, 0.71, 1}}, {{1, 0.4, 0.5, 0.2, 0}})"
                ));
                numbers.push(format!("{name}.volume"));
            }
            _ => {}
        }
    }
    for number in
        ["mesh.area", "mesh.volume", "hydrostatics.volume", "hydrostatics.buoyancy_centre"]
    {
        numbers.push(number.into());
    }
    (positions, numbers)
}

fn flat(value: &Value<f64>, out: &mut Vec<f64>) {
    match value {
        Value::Number(x) => out.push(*x),
        Value::Vector(v) => out.extend(v.to_array()),
        Value::Point(p) => out.extend(p.xyz.to_array()),
        Value::Vectors(a) => a.iter().for_each(|v| out.extend(v.to_array())),
        other => panic!("{other:?}"),
    }
}

/// Everything measured now; `None` when the model has no such values (a draw beyond its range). The numbers of objects
/// that are the same as in `base` are taken from there: certified measures are dear.
fn sample(document: &mut Document, numbers: &[String], base: Option<&Sample>) -> Option<Sample> {
    let mut sample = Sample { values: Vec::new(), owners: Vec::new(), objects: HashMap::new() };
    let mut owner = 0;
    let mut close = |sample: &mut Sample, values: Vec<f64>| {
        sample.owners.extend(std::iter::repeat_n(owner, values.len()));
        sample.values.extend(values);
        owner += 1;
    };
    let xyz = |vs: Vec<Vec3>| vs.iter().flat_map(|v| v.to_array()).collect::<Vec<f64>>();
    for object in document.graph().objects() {
        if let Some(value) = object.value() {
            sample.objects.insert(object.name.to_string(), value.clone());
        }
        match object.value() {
            Some(Value::Numbers(w)) if object.row.name.starts_with("Weight") => {
                close(&mut sample, w.items[1..4].to_vec());
            }
            Some(Value::Point(p)) => close(&mut sample, xyz(vec![p.xyz])),
            Some(Value::Curve(c)) => {
                close(&mut sample, xyz(TS.iter().map(|&t| c.jet(t, Order::Zero)[0]).collect()));
            }
            Some(Value::Body(m)) => {
                // Of the part of the surface where it is one, as the expression has it.
                close(&mut sample, xyz(m.measures().iter().map(|part| part.centroid).collect()));
            }
            Some(Value::Surface(s)) => {
                let at = |(&u, &v): (&f64, &f64)| s.jet(u, v, Order::Zero).p;
                close(&mut sample, xyz(TS.iter().zip(&US).map(at).collect()));
            }
            Some(Value::Solid(s)) => {
                let at = |((&u, &v), w): ((&f64, &f64), f64)| s.eval(u, v, w);
                let places = TS.iter().zip(&US).zip([1.0, 0.4, 0.5, 0.2, 0.0]);
                close(&mut sample, xyz(places.map(at).collect()));
            }
            Some(_) => {}
            None => return None,
        }
    }
    for text in numbers {
        let mut values = Vec::new();
        match base.and_then(|base| base.unchanged(text, &sample)) {
            Some(known) => values.extend(known),
            None => values.extend(measured(document, text)?),
        }
        close(&mut sample, values);
    }
    let mesh = document.panelled().ok()?;
    close(&mut sample, xyz(mesh.mesh.positions().to_vec()));
    Some(sample)
}

/// The accuracy of measures whose differences are formed.
const FINE: f64 = 1e-9;
/// The accuracy of derivatives of measures, which are asked to 1e-6 themselves.
const MEASURED: f64 = 5e-5;

/// The accuracy of derivatives by differences in models that fair: an optimum is known to its gap.
const OPTIMAL: f64 = 2e-6;

/// Whether a number is a certified measure: exact to a stated accuracy only, so are its derivatives.
fn certified(text: &str) -> bool {
    [".area", ".mass", ".centre"].iter().any(|end| text.ends_with(end))
        || text.starts_with("hydrostatics.")
}

/// A number of a document; what is certified to an accuracy, to a fine one.
fn measured(document: &mut Document, text: &str) -> Option<Vec<f64>> {
    let mut values = Vec::new();
    let fine = text.strip_suffix(".area").and_then(|name| {
        let graph = document.graph();
        match graph.find(name).and_then(|key| graph.get(key))?.value()? {
            Value::Surface(surface) => surface_measures(&**surface, FINE),
            _ => None,
        }
    });
    match fine {
        Some(measures) => values.push(measures.area),
        None => flat(&document.eval(text).ok()?, &mut values),
    }
    Some(values)
}

impl Sample {
    /// The values of `number` when its object is the same in `now`.
    fn unchanged<'a>(
        &'a self,
        number: &str,
        now: &Sample,
    ) -> Option<impl Iterator<Item = f64> + use<'a>> {
        let (name, _) = number.split_once('.')?;
        let same = self.objects.get(name)?.same(now.objects.get(name)?);
        // Owners are numbered alike in all samples of a model: what was measured next comes next.
        let owner = now.owners.last().map_or(0, |last| last + 1);
        let at = self.owners.iter().position(|&o| o == owner)?;
        let end = self.owners[at..]
            .iter()
            .position(|&o| o != owner)
            .map_or(self.owners.len(), |n| at + n);
        same.then(|| self.values[at..end].iter().copied())
    }
}

/// True when the length of a curve is not that of a much finer quadrature.
fn missed_knot(document: &mut Document, text: &str) -> bool {
    let Some(name) = text.strip_suffix(".length") else { return false };
    let length = crate::common::number(document, text);
    let graph = document.graph();
    let object = graph.find(name).and_then(|key| graph.get(key)).expect("a measured curve");
    let Some(Value::Curve(curve)) = object.value() else { return false };
    let speed = |t: f64| curve.jet(t, Order::First)[1].norm();
    let n = 1 << 14;
    let part = |k: i32| {
        gauss_legendre(f64::from(k) / f64::from(n), f64::from(k + 1) / f64::from(n), speed)
    };
    let fine: f64 = (0..n).map(part).sum();
    (fine - length).abs() > 1e-9 * fine
}

/// What became of the comparisons of a model.
#[derive(Default, Debug)]
struct Tally {
    parameters: usize,
    /// Values that were compared, those at kinks among them.
    values: usize,
    kinks: usize,
    /// Values that were compared with nothing, because the model cannot be moved to both sides.
    uncompared: usize,
    /// Lengths whose quadrature missed a knot of a surface that a sub-surface hides.
    missed: usize,
}

/// The parameters and literal coordinates of a model, with their values.
fn inputs(document: &mut Document) -> Vec<(String, f64)> {
    let mut all: Vec<(String, f64)> = vec![("w".into(), 1.25)];
    let mut names = Vec::new();
    for object in document.graph().objects() {
        for (field, arg) in object.row.fields.iter().zip(&object.args) {
            let name = format!("{}.{}", object.name, field.name);
            match arg {
                Value::Number(x) if field.class == Class::Number => names.push((name, *x)),
                Value::List(items) if field.many => {
                    for (k, item) in items.iter().enumerate() {
                        if let Value::Vector(v) = item {
                            for (c, axis) in ["x", "y", "z"].iter().enumerate() {
                                names.push((format!("{name}[{}].{axis}", k + 1), v.to_array()[c]));
                            }
                        }
                    }
                }
                _ => {}
            }
        }
    }
    for (name, x) in names {
        if document.set(&[(name.clone(), x)]).is_ok() {
            all.push((name, x));
        }
    }
    all
}

/// `None` for a draw that makes no model, such as a line between a point and its own image.
fn check(seed: u64) -> Option<Tally> {
    let text = model(seed);
    let mut document = open(&text);
    if document.has_errors() {
        let faults: Vec<String> =
            document.diagnostics().iter().map(|d| line(&document, d)).collect();
        println!("seed {seed}: {faults:?}");
        return None;
    }
    let mut inputs = inputs(&mut document);
    if !soak() {
        // The ordinary run moves the parameter and one literal of 48, other ones in each model.
        let mut k = seed as usize;
        inputs.retain(|(name, _)| {
            k += 1;
            name == "w" || k.is_multiple_of(48)
        });
    }
    let names: Vec<String> = inputs.iter().map(|(name, _)| name.clone()).collect();
    let (positions, mut numbers) = expressions(&document);
    if !soak() {
        // Certified measures are dear: a third of them, other ones in each model.
        let mut k = seed as usize;
        numbers.retain(|text| {
            k += usize::from(certified(text));
            !certified(text) || k.is_multiple_of(3)
        });
    }
    let all: Vec<String> = positions.iter().chain(&numbers).cloned().collect();
    // Skins of random models are open.
    document.allow_partial(true);
    let exact =
        document.derivatives(&all, &names).unwrap_or_else(|e| panic!("seed {seed}: {e:?}\n{text}"));
    let vertices = document.jacobian(&names).unwrap();
    let base =
        sample(&mut document, &numbers, None).unwrap_or_else(|| panic!("seed {seed}\n{text}"));
    let mut tally = Tally { parameters: names.len(), ..Tally::default() };
    let fairs = text.lines().any(|line| line.starts_with("Fair"));
    let exactness = if fairs { OPTIMAL } else { 1e-7 };
    for (k, (name, start)) in inputs.iter().enumerate() {
        let mut derivative = Vec::new();
        for column in &exact {
            flat(&column[k], &mut derivative);
        }
        derivative.extend(vertices[k].iter().flat_map(|v| v.to_array()));
        assert_eq!(derivative.len(), base.values.len(), "seed {seed} {name}");
        // Per owner: the largest derivative, or the size per scale of the parameter.
        let scale = start.abs().max(1.0);
        let mut tolerance = vec![0.0_f64; base.owners.last().unwrap() + 1];
        for ((&owner, d), x) in base.owners.iter().zip(&derivative).zip(&base.values) {
            let measured = all.get(owner).is_some_and(|text| certified(text));
            let share = if measured { MEASURED } else { exactness };
            tolerance[owner] = tolerance[owner].max(share * d.abs().max(x.abs() / scale));
        }
        let mut open: Vec<usize> = (0..derivative.len()).collect();
        let before = tally.uncompared;
        let mut last = Vec::new();
        for h in [1e-2, 1e-3, 1e-4, 1e-5] {
            let mut at = |h: f64| {
                document.set(&[(name.clone(), start + h)]).ok()?;
                sample(&mut document, &numbers, Some(&base)).map(|sample| sample.values)
            };
            let Some(centred) = ridders_vectors(&mut at, h * scale, LEVELS) else { continue };
            if centred.len() != derivative.len() {
                continue;
            }
            open.retain(|&i| {
                let near =
                    (centred[i] - derivative[i]).abs() <= tolerance[base.owners[i]].max(1e-12);
                !near
            });
            last = centred;
            if open.is_empty() {
                break;
            }
        }
        if !open.is_empty() && last.is_empty() {
            // At the end of what the model can take: there are no differences.
            tally.uncompared += open.len();
        } else if !open.is_empty() {
            // A kink: the one-sided differences disagree, too.
            let mut at = |h: f64| {
                document.set(&[(name.clone(), start + h)]).ok()?;
                sample(&mut document, &numbers, Some(&base))
                    .filter(|s| s.values.len() == base.values.len())
            };
            let h = 1e-6 * scale;
            if let (Some(high), Some(low)) = (at(h), at(-h)) {
                for i in open {
                    let right = (high.values[i] - base.values[i]) / h;
                    let left = (base.values[i] - low.values[i]) / h;
                    let owner = base.owners[i];
                    if all.get(owner).is_some_and(|text| missed_knot(&mut document, text)) {
                        tally.missed += 1;
                        continue;
                    }
                    let (fold, tolerance) = ((right - left).abs(), tolerance[owner]);
                    // A small one, of two panels of many, has the derivative on one of its sides.
                    let sided =
                        [left, right].iter().any(|x| (x - derivative[i]).abs() <= tolerance);
                    let folded = fold > 1e3 * tolerance || (fold > 4.0 * tolerance && sided);
                    let what = all.get(owner).map_or("the mesh", String::as_str);
                    assert!(
                        folded,
                        "seed {seed}: d({what}[{i}])/d({name}) = {} but differences say {}, on its sides {left} and {right}\n{text}",
                        derivative[i], last[i],
                    );
                    tally.kinks += 1;
                }
            } else {
                tally.uncompared += open.len();
            }
        }
        tally.values += derivative.len() - (tally.uncompared - before);
        document.set(&[(name.clone(), *start)]).unwrap();
    }
    Some(tally)
}

/// A kind that models must have, and how many there are: `MOLDLOFT_LAWS=IntSnake:900` looks at those
/// of the first 900 that have one.
fn wanted() -> Option<(String, usize)> {
    let text = std::env::var("MOLDLOFT_LAWS").ok()?;
    let (kind, models) = text.split_once(':')?;
    Some((kind.into(), models.parse().ok()?))
}

#[test]
fn derivatives_equal_differences_on_random_models_of_all_kinds() {
    let wanted = wanted();
    let models = wanted.as_ref().map_or(rounds(100).max(parts()), |w| w.1);
    let with = |seed: &u64| {
        let has = |(kind, _): &(String, usize)| model(*seed).contains(&format!("\n{kind} "));
        wanted.as_ref().is_none_or(has)
    };
    // On threads of its own: the other tests would wait for a free one.
    let threads = rayon::ThreadPoolBuilder::new().build().expect("threads");
    let tallies: Vec<(Tally, usize)> = threads.install(|| {
        (1..=models as u64)
            .into_par_iter()
            .filter(with)
            .map(|seed| {
                let mut redrawn = 0;
                let mut draws = (0..5).map(|k| check(seed + k * 1000 * parts() as u64));
                let tally = draws.find_map(|tally| {
                    redrawn += usize::from(tally.is_none());
                    tally
                });
                (tally.expect("one of five draws is a model"), redrawn)
            })
            .collect()
    });
    let (mut total, mut redrawn) = (Tally::default(), 0);
    for (tally, again) in tallies {
        redrawn += again;
        total.parameters += tally.parameters;
        total.values += tally.values;
        total.kinks += tally.kinks;
        total.uncompared += tally.uncompared;
        total.missed += tally.missed;
    }
    println!("{models} models, {redrawn} drawn again: {total:?}");
    assert!(redrawn <= models / 10);
    assert!(total.kinks * 1000 <= total.values, "{total:?}");
    assert!(total.missed <= models / 4, "{total:?}");
    // What lies at the end of what a model can take has no differences.
    assert!(total.uncompared * 100 <= total.values, "{total:?}");
}

/// Where a curve has a corner that moves, the corner's own way counts as well.
#[test]
fn lengths_across_moving_corners_have_exact_derivatives() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0.25); AbsPoint D(0.25, 0, 2); \
                AbsPoint E(1, 0.5, 2); AbsPoint F(1.5, 1, 2.25); CCurve a({A, B, C}, degree = 1); \
                CCurve b({D, E, F}, degree = 1); RuledSurf S(a, b); AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.7); \
                LineSnake s(p, q); AbsBead c(a, 0.2); AbsBead d(a, 0.875); SubCurve k(c, d);";
    let mut document = crate::common::sound(text);
    for (number, inputs) in [
        ("s.length", ["p.u", "q.v", "B.x", "E.y"]),
        ("length(s)", ["p.v", "q.u", "C.z", "E.x"]),
        ("k.length", ["c.t", "d.t", "B.y", "A.x"]),
        ("a.length", ["A.x", "B.z", "C.x", "B.y"]),
    ] {
        for input in inputs {
            let exact = document.derivatives(&[number.into()], &[input.into()]).unwrap();
            let Value::Number(exact) = exact[0][0] else { panic!() };
            let start = crate::common::number(&mut document, input);
            let at = |h: f64| {
                document.set(&[(input.into(), start + h)]).unwrap();
                let values = vec![crate::common::number(&mut document, number)];
                document.set(&[(input.into(), start)]).unwrap();
                Some(values)
            };
            let centred = ridders_vectors(at, 1e-2, LEVELS).unwrap()[0];
            let close = (exact - centred).abs() < 1e-7 * exact.abs().max(1.0);
            assert!(close, "d({number})/d({input}) = {exact}, differences {centred}");
        }
    }
}
