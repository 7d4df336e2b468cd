//! Gradients in reverse mode against forward mode: examples of all kinds, random models, solve sets, functions from outside.

use crate::common::{ids, number, open, rounds, sound};
use crate::laws;
use moldloft_document::{Document, GradientMode, WeightedOutput};
use moldloft_num::{Dual4, Real};
use moldloft_registry::{
    CallError, Class, Context, FieldSpec, Foreign, Implementation, Row, Value,
};
use moldloft_testing::Random;
use rayon::prelude::*;
use std::sync::Arc;

/// Greatest difference of a derivative, as a share of the greatest of its gradient.
const EXACT: f64 = 1e-12;

/// The numbers of an output.
fn count(document: &mut Document, output: &str) -> Option<usize> {
    match output {
        "mesh" => document.entire_panels().ok().map(|p| 3 * p.mesh.positions().len()),
        "blocks" => document.blocked().ok().map(|b| 3 * b.blocks.positions().len()),
        _ => document.eval(output).ok()?.numbers().map(|numbers| numbers.len()),
    }
    .filter(|count| *count > 0)
}

/// Random weights of those outputs that the model has, in `sums` sums.
fn weighted(
    document: &mut Document,
    outputs: &[String],
    sums: usize,
    random: &mut Random,
) -> Vec<WeightedOutput> {
    let mut found = Vec::new();
    for name in outputs {
        let Some(count) = count(document, name) else { continue };
        let weights = (0..sums).map(|_| (0..count).map(|_| random.signed()).collect()).collect();
        found.push(WeightedOutput { name: name.clone(), weights });
    }
    found
}

/// The greatest difference of both modes, as a share of the greatest derivative; `None` when forward mode refuses.
fn difference(
    document: &mut Document,
    outputs: &[WeightedOutput],
    by: &[String],
) -> Option<(f64, Vec<String>)> {
    let forward = document.vjp(outputs, by, GradientMode::Forward);
    let reverse = document.vjp(outputs, by, GradientMode::Reverse);
    let Ok(forward) = forward else {
        assert!(reverse.is_err(), "reverse mode has a gradient where forward mode has none");
        return None;
    };
    let reverse = reverse.expect("forward mode has a gradient");
    let mut worst = 0.0f64;
    for (forward, reverse) in forward.rows.iter().zip(&reverse.rows) {
        let size = forward.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let off = forward.iter().zip(reverse).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off.is_finite());
        worst = worst.max(if size > 0.0 { off / size } else { off });
    }
    Some((worst, reverse.forward))
}

/// What is differentiated of a model: places and measures of its objects, its mesh.
fn outputs(document: &Document) -> Vec<String> {
    let (mut places, measures) = laws::expressions(document);
    places.extend(measures.into_iter().filter(|m| m.starts_with("mesh.")));
    places.push("mesh".into());
    for object in document.graph().objects() {
        if matches!(
            object.value(),
            Some(Value::Number(_) | Value::Vector(_) | Value::Numbers(_) | Value::Vectors(_))
        ) {
            places.push(object.name.to_string());
        }
    }
    places
}

/// Parameters and literals.
fn inputs(document: &Document) -> Vec<String> {
    let params = document.params().iter().filter(|p| !p.is_int).map(|p| p.name.clone());
    params.chain(document.literals()).collect()
}

#[test]
fn examples_of_all_kinds_have_the_gradients_of_forward_mode() {
    let rows: Vec<Arc<Row>> =
        moldloft_document::registry().rows().filter(|row| row.kind).cloned().collect();
    let found: Vec<(String, bool, Vec<String>)> = rows
        .par_iter()
        .enumerate()
        .filter_map(|(at, row)| {
            let mut document = open(&row.example);
            let all = outputs(&document);
            let by = inputs(&document);
            let outputs = weighted(&mut document, &all, 2, &mut Random::new(at as u64));
            if by.is_empty() || outputs.is_empty() {
                return None;
            }
            let (worst, forward) = difference(&mut document, &outputs, &by)?;
            println!("{:20} {:4} inputs {worst:.1e} {forward:?}", row.name, by.len());
            assert!(worst <= EXACT, "{}: {worst:e}", row.name);
            let has_reverse = matches!(&row.body, Implementation::Native { rev: Some(_), .. });
            Some((row.name.to_string(), has_reverse, forward))
        })
        .collect();
    let taped = found.iter().filter(|(_, _, forward)| forward.is_empty()).count();
    println!("{} examples, {taped} in reverse mode", found.len());
    // The area of a plate, which a weight may be by, refines its cells by derivatives.
    let not =
        found.iter().filter(|(name, rev, forward)| *rev && !forward.is_empty() && name != "Weight");
    assert_eq!(not.count(), 0, "rows with a body for a tape that have no gradient by it");
    assert!(taped >= 130, "{taped}");
}

#[test]
fn random_models_have_the_gradients_of_forward_mode() {
    let models = rounds(500).max(laws::parts());
    let found: Vec<(f64, usize, bool)> = (1..=models as u64)
        .into_par_iter()
        .filter_map(|seed| {
            let text = laws::model(seed);
            let mut document = open(&text);
            if document.has_errors() {
                return None;
            }
            let all = outputs(&document);
            let by = inputs(&document);
            let outputs = weighted(&mut document, &all, 1, &mut Random::new(seed));
            let (worst, forward) = difference(&mut document, &outputs, &by)?;
            assert!(worst <= EXACT, "seed {seed}: {worst:e} {forward:?}\n{text}");
            Some((worst, by.len(), forward.is_empty()))
        })
        .collect();
    let worst = found.iter().fold(0.0f64, |most, (worst, ..)| most.max(*worst));
    let inputs: usize = found.iter().map(|(_, inputs, _)| inputs).sum();
    let taped = found.iter().filter(|(.., taped)| *taped).count();
    println!(
        "{models} models, {} compared, {taped} in reverse mode, {inputs} inputs, worst {worst:.1e}",
        found.len()
    );
    assert!(2 * found.len() >= models);
}

const HULL: &str = "param float beam = 2 in [1, 4]; param float draft = 1 in [0.2, 3]; \
    AbsPoint A(0, 0, -draft); AbsPoint B(3, 0.5 * beam, -0.7); AbsPoint C(6, 0, 0); \
    AbsPoint D(0, 0.3, 0.5); AbsPoint E(3, beam * draft, 0.4); AbsPoint F(6, 0.1, 0.6); \
    BCurve a({A, B, C}); CCurve b({D, E, F}); CLoftSurf hull({a, b}, divisions = {5, 7}); \
    AbsBead p(a, 0.4); AbsBead q(b, 0.6); Line l(p, q); BCurve c({A, E, F, C}); \
    BLoftSurf other({a, l, c}, divisions = {0, 4});";

#[test]
fn shared_vertices_measures_and_arrays_by_parameters_and_literals() {
    let mut document = sound(HULL);
    let names = document.literals();
    assert!(names.contains(&"B.x".into()) && names.contains(&"p.t".into()), "{names:?}");
    // What follows from a parameter, and a count, are no literals.
    assert!(!names.contains(&"E.y".into()) && !names.iter().any(|n| n.contains("divisions")));
    let by = inputs(&document);
    let outputs: Vec<String> = [
        "mesh",
        "mesh.area",
        "mesh.volume",
        "mesh.centroid",
        "mesh_quality.aspect",
        "mesh_quality.skew",
        "mesh_quality.warp",
        "mesh_quality.angle",
        "a({0.1, 0.7})",
        "hull.area * beam",
        "p.x + beam",
        "hull({0.2, 0.9}, {0.4, 0.6})",
        "{A, B}",
        "{beam, {draft, 3}}",
    ]
    .map(String::from)
    .to_vec();
    let weights = weighted(&mut document, &outputs, 3, &mut Random::new(7));
    assert_eq!(weights.len(), outputs.len());
    let (worst, forward) = difference(&mut document, &weights, &by).unwrap();
    // Areas of surfaces refine their cells by derivatives, and points of the mesh need the skin.
    let ahead = ["mesh.centroid", "hull.area * beam"];
    assert!(worst <= EXACT && forward == ahead, "{worst:e} {forward:?}");
    // The model may change between two gradients.
    document.set(&[("beam".into(), 2.5), ("B.x".into(), 2.75)]).unwrap();
    let (worst, _) = difference(&mut document, &weights, &by).unwrap();
    assert!(worst <= EXACT, "{worst:e}");
}

#[test]
fn qualities_of_panels_are_those_of_the_worst_one() {
    // Panels of a trapezium: the first row is the flattest.
    let text = "param float h = 0.5 in [0.1, 2]; \
        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, h, 0); AbsPoint D(4, h, 0); \
        Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {4, 1});";
    let mut document = sound(text);
    assert_eq!(number(&mut document, "mesh_quality.aspect"), 2.0);
    assert_eq!(number(&mut document, "mesh_quality.skew"), 0.0);
    assert_eq!(number(&mut document, "mesh_quality.warp"), 0.0);
    let angle = number(&mut document, "mesh_quality.angle");
    assert!((angle - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    // 1 / h, whose slope is -1 / h^2.
    let output = WeightedOutput { name: "mesh_quality.aspect".into(), weights: vec![vec![1.0]] };
    for mode in [GradientMode::Forward, GradientMode::Reverse] {
        let found = document.vjp(std::slice::from_ref(&output), &["h".into()], mode).unwrap();
        assert!((found.rows[0][0] + 4.0).abs() < 1e-13, "{mode:?} {found:?}");
        assert_eq!(found.forward.is_empty(), mode == GradientMode::Reverse);
    }
    assert!(document.eval("mesh_quality.area").is_err());
}

#[test]
fn directions_are_products_with_the_same_jacobian() {
    let mut document = sound(HULL);
    let by = inputs(&document);
    let outputs: Vec<String> = ["mesh", "mesh.volume", "hull.area"].map(String::from).to_vec();
    let mut random = Random::new(3);
    let weights = weighted(&mut document, &outputs, 1, &mut random);
    let directions: Vec<(String, f64)> =
        by.iter().map(|name| (name.clone(), random.signed())).collect();
    let changes = document.jvp(&outputs, &directions).unwrap();
    let gradient = document.vjp(&weights, &by, GradientMode::Reverse).unwrap();
    let ahead: f64 = weights
        .iter()
        .zip(&changes)
        .flat_map(|(w, c)| w.weights[0].iter().zip(c))
        .map(|(w, c)| w * c)
        .sum();
    let back: f64 = gradient.rows[0].iter().zip(&directions).map(|(g, (_, d))| g * d).sum();
    assert!((ahead - back).abs() <= 1e-12 * ahead.abs(), "{ahead} {back}");
}

#[test]
fn solve_sets_and_what_follows_from_them() {
    let mut document = sound(
        "param float w = 2 in [1, 9]; param float area = 8 in [4, 30]; param float x = 1 in [0.1, 20]; \
         param float y = 1 in [0.1, 20]; param float z = 3 in [0.1, 90]; \
         AbsPoint A(0, 0, 0); AbsPoint B(x, 0.1, 0); AbsPoint C(0, y, 0.2); AbsPoint D(x, y, 0.3); \
         Line a(A, B); Line b(C, D); RuledSurf s(a, b, divisions = {3, 2}); \
         SolveSet first({x, y}, {x * y - area, x - w * y * 1.01}); SolveSet second({z}, {z * z - x - 3});\
         AbsPoint E(z, x, y);",
    );
    let by = ["w", "area", "A.z", "B.y", "C.z", "D.z", "x", "z"].map(String::from);
    let outputs: Vec<String> = ["mesh", "E", "x"].map(String::from).to_vec();
    let weights = weighted(&mut document, &outputs, 2, &mut Random::new(1));
    let (worst, forward) = difference(&mut document, &weights, &by).unwrap();
    assert!(worst <= EXACT && forward.is_empty(), "{worst:e} {forward:?}");
}

/// A function from outside, of two numbers and a vector.
struct Outside;

impl Outside {
    fn of<T: Real>(args: &[Value<T>]) -> Result<Value<T>, CallError> {
        let [Value::Number(a), Value::Number(b), Value::Vector(v)] = args else {
            return Err(CallError::new("wrong-class", "expected two numbers and a vector"));
        };
        Ok(Value::Vector(*v * (a.sin() * *b) + moldloft_num::Vec3::new(*a, *b, v.norm())))
    }
}

impl Foreign for Outside {
    fn call_plain(&self, args: &[Value<f64>], _: &Context) -> Result<Value<f64>, CallError> {
        Self::of(args)
    }
    fn call_dual(&self, args: &[Value<Dual4>], _: &Context) -> Result<Value<Dual4>, CallError> {
        Self::of(args)
    }
}

#[test]
fn functions_from_outside_are_one_node_a_number() {
    let field = |name, class| FieldSpec::new(name, class, "");
    let fields =
        vec![field("a", Class::Number), field("b", Class::Number), field("v", Class::Vector)];
    let row = Row::new("outside", Implementation::Foreign(Arc::new(Outside))).fields(fields);
    let mut document = open("");
    document.add_row(row);
    document.set_text(
        "param float t = 0.4 in [0, 1]; AbsPoint A(1, 2, t); AbsPoint B(t, 3, 4); \
        vector o = outside(A.x, t * B.y, {A.y, t, B.z}); AbsPoint C(o.x, o.y, o.z); Line l(A, C);",
    );
    assert!(!document.has_errors(), "{:?}", ids(&document));
    let by = ["t", "A.x", "A.y", "B.y", "B.z"].map(String::from);
    let weights = weighted(&mut document, &["C".into(), "l(0.3)".into()], 1, &mut Random::new(5));
    let (worst, forward) = difference(&mut document, &weights, &by).unwrap();
    assert!(worst <= EXACT && forward.is_empty(), "{worst:e} {forward:?}");
}

#[test]
fn what_has_no_reverse_mode_is_found_by_forward_mode() {
    // The area of a surface refines its cells by derivatives.
    let mut document = sound(HULL);
    let by = inputs(&document);
    let outputs: Vec<String> = ["mesh.volume", "hull.area"].map(String::from).to_vec();
    let weights = weighted(&mut document, &outputs, 1, &mut Random::new(5));
    let (worst, forward) = difference(&mut document, &weights, &by).unwrap();
    assert!(worst <= EXACT, "{worst:e}");
    assert_eq!(forward, ["hull.area"]);
}

#[test]
fn faults_are_those_of_forward_mode() {
    let mut document = sound(HULL);
    let mesh =
        |weights: Vec<f64>| vec![WeightedOutput { name: "mesh".into(), weights: vec![weights] }];
    let by = inputs(&document);
    for mode in [GradientMode::Forward, GradientMode::Reverse] {
        let mut id = |outputs: &[WeightedOutput], by: &[String]| {
            document.vjp(outputs, by, mode).unwrap_err()[0].id.to_string()
        };
        assert_eq!(id(&mesh(vec![1.0; 5]), &by), "wrong-shape");
        assert_eq!(id(&mesh(vec![1.0; 5]), &["nobody".into()]), "unknown-name");
        let nothing = WeightedOutput { name: "nothing.x".into(), weights: vec![vec![1.0]] };
        assert_eq!(id(&[nothing], &by), "unknown-name");
        let shape = WeightedOutput { name: "hull".into(), weights: vec![vec![1.0]] };
        assert_eq!(id(&[shape], &by), "not-a-number");
    }
    // A root of zero has no derivative, in neither mode.
    let mut document =
        sound("param float a = 0 in [0, 1]; AbsPoint P(a, 0, 0); AbsPoint Q(0, 0, 0);");
    let root = [WeightedOutput { name: "sqrt(P.x)".into(), weights: vec![vec![1.0]] }];
    let ids = [GradientMode::Forward, GradientMode::Reverse].map(|mode| {
        assert_eq!(document.vjp(&root, &["Q.x".into()], mode).unwrap().rows, [[0.0]]);
        document.vjp(&root, &["a".into()], mode).unwrap_err()[0].id.clone()
    });
    assert_eq!(ids[0], ids[1]);
    assert!(ids[0] == "no-derivative" || ids[0] == "not-finite", "{ids:?}");
}

#[test]
fn gradients_have_the_same_bits_on_any_number_of_threads() {
    let text = HULL.replace("{5, 7}", "{80, 90}");
    let bits: Vec<Vec<u64>> = [1, 3]
        .into_iter()
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut document = sound(&text);
                let by = inputs(&document);
                let weights = weighted(&mut document, &["mesh".into()], 1, &mut Random::new(1));
                let found = document.vjp(&weights, &by, GradientMode::Reverse).unwrap();
                assert!(found.forward.is_empty());
                found.rows[0].iter().map(|x| x.to_bits()).collect()
            })
        })
        .collect();
    assert_eq!(bits[0], bits[1]);
}
