//! Exact derivatives against differences, on random models that have every kind of the registry.

mod common;

use common::{Random, line, open, rounds};
use moldloft_lang::{Document, registry};
use moldloft_num::{Order, Vec3, gauss_legendre};
use moldloft_registry::{Class, Value};
use std::fmt::Write;

/// A program that grows by random statements.
struct Program<'r> {
    random: &'r mut Random,
    text: String,
    count: usize,
    points: Vec<String>,
    curves: Vec<String>,
    surfaces: Vec<String>,
    planes: Vec<String>,
}

impl Program<'_> {
    fn number(&mut self, low: f64, high: f64) -> String {
        format!("{:?}", self.random.between(low, high))
    }

    fn name(&mut self, stem: &str) -> String {
        self.count += 1;
        format!("{stem}{}", self.count)
    }

    /// Declares an object and returns its name.
    fn object(&mut self, kind: &str, args: &str) -> String {
        let name = self.name("o");
        writeln!(self.text, "{kind} {name}({args});").unwrap();
        name
    }

    fn point(&mut self) -> String {
        self.random.pick(&self.points).clone()
    }

    /// Three different points.
    fn points<const N: usize>(&mut self) -> [String; N] {
        let mut left = self.points.clone();
        std::array::from_fn(|_| left.swap_remove(self.random.below(left.len())))
    }

    fn curve(&mut self) -> String {
        self.random.pick(&self.curves).clone()
    }

    /// Different curves: a loft of one curve alone is no surface, and the speed of a snake that
    /// turns on it has a kink.
    fn curves<const N: usize>(&mut self) -> [String; N] {
        let mut left = self.curves.clone();
        std::array::from_fn(|_| left.swap_remove(self.random.below(left.len())))
    }

    fn surface(&mut self) -> String {
        self.random.pick(&self.surfaces).clone()
    }

    fn magnet(&mut self, surface: &str) -> String {
        let (u, v) = (self.number(0.1, 0.9), self.number(0.1, 0.9));
        self.object("AbsMagnet", &format!("{surface}, {u}, {v}"))
    }

    fn bead(&mut self, curve: &str) -> String {
        let t = self.number(0.1, 0.9);
        self.object("AbsBead", &format!("{curve}, {t}"))
    }

    fn snake(&mut self, surface: &str) -> String {
        let (a, b, c) = (self.magnet(surface), self.magnet(surface), self.magnet(surface));
        match self.random.below(3) {
            0 => self.object("LineSnake", &format!("{a}, {b}")),
            1 => self.object("BSnake", &format!("{{{a}, {b}, {c}}}, degree = 2")),
            _ => {
                let value = self.number(0.1, 0.9);
                let which = self.random.pick(&["u", "v"]);
                self.object("UVSnake", &format!("{surface}, \"{which}\", {value}"))
            }
        }
    }

    fn ring(&mut self, snake: &str) -> String {
        let t = self.number(0.1, 0.9);
        self.object("AbsRing", &format!("{snake}, {t}"))
    }

    /// Something to mirror in or project to, and whether it is drawn at random.
    fn mirror(&mut self) -> String {
        match self.random.below(4) {
            0 => format!("\"{}=0\"", self.random.pick(&["x", "y", "z"])),
            1 => self.random.pick(&self.planes).clone(),
            2 => self.point(),
            _ => {
                let [a, b] = self.points();
                self.object("Line", &format!("{a}, {b}"))
            }
        }
    }

    /// An object of a kind, with all that it needs; false for a kind that is not known here.
    fn kind(&mut self, kind: &str) -> bool {
        let divisions =
            format!("divisions = {{{}, {}}}", 2 + self.random.below(3), 2 + self.random.below(3));
        let (x, y, z) = (self.number(-3.0, 3.0), self.number(-3.0, 3.0), self.number(-3.0, 3.0));
        let t = self.number(0.05, 0.3);
        let args = match kind {
            "Model" => "symmetry = \"\"".to_string(),
            "AbsPoint" => format!("{x}, {y}*w, {z}"),
            "RelPoint" => format!("{}, {x}, {y}, {z}", self.point()),
            "MirrPoint" | "ProjPoint" => format!("{}, {}", self.point(), self.mirror()),
            "AbsBead" => format!("{}, {t}", self.curve()),
            "RelBead" => {
                let curve = self.curve();
                format!("{}, {t}", self.bead(&curve))
            }
            "AbsMagnet" => format!("{}, {t}, 0.{}", self.surface(), 1 + self.random.below(9)),
            "RelMagnet" => {
                let surface = self.surface();
                format!("{}, {t}, -0.125", self.magnet(&surface))
            }
            "AbsRing" => {
                let surface = self.surface();
                format!("{}, {t}", self.snake(&surface))
            }
            "RelRing" => {
                let surface = self.surface();
                let snake = self.snake(&surface);
                format!("{}, {t}", self.ring(&snake))
            }
            "Line" => self.points::<2>().join(", "),
            "Arc" => {
                format!("{}, type = {}", self.points::<3>().join(", "), 1 + self.random.below(6))
            }
            "BCurve" => {
                format!("{{{}, {{{x}, w, {z}}}}}, degree = 2", self.points::<4>().join(", "))
            }
            "CCurve" => match self.random.below(3) {
                0 => format!("{{{}}}, ends = \"natural\"", self.points::<4>().join(", ")),
                1 => format!("{{{}}}, degree = 1", self.points::<3>().join(", ")),
                _ => format!("{{{}}}", self.points::<5>().join(", ")),
            },
            "SubCurve" => {
                let curve = self.curve();
                format!("{}, {}", self.bead(&curve), self.bead(&curve))
            }
            "MirrCurve" => format!("{}, {}", self.curve(), self.mirror()),
            "LineSnake" => {
                let surface = self.surface();
                format!("{}, {}", self.magnet(&surface), self.magnet(&surface))
            }
            "BSnake" => {
                let surface = self.surface();
                let magnets: Vec<_> = (0..4).map(|_| self.magnet(&surface)).collect();
                format!("{{{}}}, degree = 3", magnets.join(", "))
            }
            "EdgeSnake" => format!("{}, {}", 1 + self.random.below(4), self.surface()),
            "UVSnake" => format!("{}, \"{}\", {t}", self.surface(), self.random.pick(&["u", "v"])),
            "SubSnake" => {
                let surface = self.surface();
                let snake = self.snake(&surface);
                format!("{}, {}", self.ring(&snake), self.ring(&snake))
            }
            "RuledSurf" | "TranSurf" => format!("{}, {divisions}", self.curves::<2>().join(", ")),
            "BLoftSurf" => {
                let masters = self.curves::<3>().join(", ");
                format!("{{{masters}}}, degree = 2, {divisions}")
            }
            "CLoftSurf" => {
                // Masters of its own, apart from one another.
                let masters: Vec<String> = (0..3)
                    .map(|k| {
                        let points: Vec<String> = (0..3)
                            .map(|j| {
                                let (y, z) = (self.number(-0.5, 0.5), self.number(-0.5, 0.5));
                                self.object("AbsPoint", &format!("{}*w, {j} + {y}, {z}", 2 * k))
                            })
                            .collect();
                        self.object(
                            "BCurve",
                            &format!("{{{}}}, degree = 2, visible = 0", points.join(", ")),
                        )
                    })
                    .collect();
                format!("{{{}}}, {divisions}", masters.join(", "))
            }
            "BSurf" => {
                let net = self.points::<6>().join(", ");
                format!("{{{net}}}, nu = 3, nv = 2, degree_u = 2, degree_v = 1, {divisions}")
            }
            "RevSurf" => {
                let [a, b] = self.points();
                let line = self.object("Line", &format!("{a}, {b}"));
                format!("{}, {line}, {t}, 2.25, {divisions}", self.curve())
            }
            "SubSurf" => {
                let s = self.surface();
                let m: [String; 4] = std::array::from_fn(|_| self.magnet(&s));
                let mut side =
                    |a: usize, b: usize| self.object("LineSnake", &format!("{}, {}", m[a], m[b]));
                let sides = [side(0, 1), side(1, 2), side(3, 2), side(0, 3)];
                match self.random.below(3) {
                    0 => format!("{{{}, {}}}, {divisions}", sides[0], sides[2]),
                    1 => format!("{{{}, {}}}, {divisions}", sides[0], m[2]),
                    _ => format!("{{{}}}, {divisions}", sides.join(", ")),
                }
            }
            "MirrSurf" => format!("{}, {}, {divisions}", self.surface(), self.mirror()),
            "XPlane" | "YPlane" | "ZPlane" => x,
            "OffsetPlane" => format!("{}, {x}", self.random.pick(&self.planes)),
            "ThreePointPlane" => self.points::<3>().join(", "),
            "TwoPointPlane" => self.points::<2>().join(", "),
            "XContours" | "YContours" | "ZContours" => format!("0, 3, {x}, {y}"),
            _ => return false,
        };
        let name = self.object(kind, &args);
        match registry().get(kind).expect("a kind of the registry").class {
            Class::Point | Class::Bead | Class::Magnet | Class::Ring => self.points.push(name),
            Class::Curve | Class::Snake => self.curves.push(name),
            Class::Surface => self.surfaces.push(name),
            Class::Plane => {
                // A plane shows itself in what is projected to it.
                let point = self.point();
                self.object("ProjPoint", &format!("{point}, {name}"));
                self.planes.push(name);
            }
            _ => {}
        }
        true
    }
}

/// A random model with every kind of the registry.
fn model(seed: u64) -> String {
    let mut random = Random::new(seed);
    let text = String::from("param float w = 1.25 in [0.5, 2];\nparam float h = 0.5*w + 0.25;\n");
    let mut p = Program {
        random: &mut random,
        text,
        count: 0,
        points: Vec::new(),
        curves: Vec::new(),
        surfaces: Vec::new(),
        planes: Vec::new(),
    };
    for k in 0..9 {
        // Spread out, so that few points are in line or near each other.
        let at = [k % 3, k / 3, (k * 5) % 7]
            .map(|g| p.random.between(-0.3, 0.3) + f64::from(g) * 1.5 - 1.5);
        let name = p.object("AbsPoint", &format!("{:?}, {:?} + 0.1*h, {:?}", at[0], at[1], at[2]));
        p.points.push(name);
    }
    for kind in ["XPlane", "Line", "BCurve", "CCurve", "CLoftSurf"] {
        assert!(p.kind(kind), "{kind}");
    }
    let registry = registry();
    let mut kinds: Vec<&str> = registry.rows().filter(|r| r.kind).map(|r| &*r.name).collect();
    while !kinds.is_empty() {
        let kind = kinds.swap_remove(p.random.below(kinds.len()));
        assert!(p.kind(kind), "the generator of random models has no recipe for the kind {kind}");
    }
    // The program's own arithmetic on what it reads.
    let (c, s) = (p.curve(), p.surface());
    writeln!(p.text, "farray law = d_tanh(0, 1, 0.1*w, 0.2, 5); curve row = distc({c}, law);")
        .unwrap();
    writeln!(p.text, "AbsPoint last1(row[3].x, row[2].y*h, length({c}));").unwrap();
    writeln!(p.text, "AbsPoint last2({s}(0.3*w, 0.4).z, abs({s}.area - 3)^1.5, {c}.length/w);")
        .unwrap();
    p.text
}

/// Values, flat, and the object (or measured number) that each belongs to.
#[derive(Clone)]
struct Sample {
    values: Vec<f64>,
    owners: Vec<usize>,
}

const TS: [f64; 5] = [0.0, 0.29, 0.5, 0.83, 1.0];
const US: [f64; 5] = [0.0, 0.23, 0.5, 0.71, 1.0];

/// The expressions that are measured: positions of objects, and numbers.
fn expressions(document: &Document) -> (Vec<String>, Vec<String>) {
    let (mut positions, mut numbers) = (Vec::new(), Vec::new());
    for object in document.graph().objects() {
        let name = &object.name;
        match object.value() {
            Some(Value::Point(_)) => positions.push(name.to_string()),
            Some(Value::Curve(_)) => {
                positions.push(format!("{name}({{0, 0.29, 0.5, 0.83, 1}})"));
                numbers.push(format!("{name}.length"));
            }
            Some(Value::Surface(_)) => {
                positions
                    .push(format!("{name}({{0, 0.29, 0.5, 0.83, 1}}, {{0, 0.23, 0.5, 0.71, 1}})"));
                numbers.push(format!("{name}.area"));
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
        Value::Vectors(a) => a.items.iter().for_each(|v| out.extend(v.to_array())),
        other => panic!("{other:?}"),
    }
}

/// Everything measured now; `None` when the model has no such values (a draw beyond its range).
fn sample(document: &mut Document, numbers: &[String]) -> Option<Sample> {
    let mut sample = Sample { values: Vec::new(), owners: Vec::new() };
    let mut owner = 0;
    let mut close = |sample: &mut Sample, values: Vec<f64>| {
        sample.owners.extend(std::iter::repeat_n(owner, values.len()));
        sample.values.extend(values);
        owner += 1;
    };
    let xyz = |vs: Vec<Vec3>| vs.iter().flat_map(|v| v.to_array()).collect::<Vec<f64>>();
    for object in document.graph().objects() {
        match object.value() {
            Some(Value::Point(p)) => close(&mut sample, xyz(vec![p.xyz])),
            Some(Value::Curve(c)) => {
                close(&mut sample, xyz(TS.iter().map(|&t| c.jet(t, Order::Zero)[0]).collect()));
            }
            Some(Value::Surface(s)) => {
                let at = |(&u, &v): (&f64, &f64)| s.jet(u, v, Order::Zero).p;
                close(&mut sample, xyz(TS.iter().zip(&US).map(at).collect()));
            }
            Some(_) => {}
            None => return None,
        }
    }
    for text in numbers {
        let mut values = Vec::new();
        flat(&document.eval(text).ok()?, &mut values);
        close(&mut sample, values);
    }
    let mesh = document.panelled().ok()?;
    close(&mut sample, xyz(mesh.mesh.positions().to_vec()));
    Some(sample)
}

/// Ridders' extrapolation of central differences (Ridders 1982), for all values at once.
fn ridders(mut at: impl FnMut(f64) -> Option<Sample>, mut h: f64) -> Option<Vec<f64>> {
    const LEVELS: usize = 5;
    let mut rows: Vec<Vec<Vec<f64>>> = Vec::new();
    let (mut best, mut error) = (Vec::new(), Vec::new());
    for i in 0..LEVELS {
        let (high, low) = (at(h)?.values, at(-h)?.values);
        if high.len() != low.len() {
            return None;
        }
        let mut row =
            vec![high.iter().zip(&low).map(|(a, b)| (a - b) / (2.0 * h)).collect::<Vec<f64>>()];
        if i == 0 {
            (best, error) = (row[0].clone(), vec![f64::INFINITY; row[0].len()]);
        }
        let mut factor = 1.96;
        for j in 1..=i {
            let next: Vec<f64> = (0..best.len())
                .map(|k| {
                    let x = (row[j - 1][k] * factor - rows[i - 1][j - 1][k]) / (factor - 1.0);
                    let e = (x - row[j - 1][k]).abs().max((x - rows[i - 1][j - 1][k]).abs());
                    if e < error[k] {
                        (best[k], error[k]) = (x, e);
                    }
                    x
                })
                .collect();
            row.push(next);
            factor *= 1.96;
        }
        rows.push(row);
        h /= 1.4;
    }
    Some(best)
}

/// True when the length of a curve is not that of a much finer quadrature.
fn missed_knot(document: &mut Document, text: &str) -> bool {
    let Some(name) = text.strip_suffix(".length") else { return false };
    let length = common::number(document, text);
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
    values: usize,
    kinks: usize,
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
    let inputs = inputs(&mut document);
    let names: Vec<String> = inputs.iter().map(|(name, _)| name.clone()).collect();
    let (positions, numbers) = expressions(&document);
    let all: Vec<String> = positions.iter().chain(&numbers).cloned().collect();
    let exact =
        document.derivatives(&all, &names).unwrap_or_else(|e| panic!("seed {seed}: {e:?}\n{text}"));
    let vertices = document.jacobian(&names).unwrap();
    let base = sample(&mut document, &numbers).unwrap_or_else(|| panic!("seed {seed}\n{text}"));
    let mut tally = Tally { parameters: names.len(), ..Tally::default() };
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
            tolerance[owner] = tolerance[owner].max(1e-7 * d.abs().max(x.abs() / scale));
        }
        let mut open: Vec<usize> = (0..derivative.len()).collect();
        let mut last = Vec::new();
        for h in [1e-2, 1e-3, 1e-4, 1e-5] {
            let mut at = |h: f64| {
                document.set(&[(name.clone(), start + h)]).ok()?;
                sample(&mut document, &numbers)
            };
            let Some(centred) = ridders(&mut at, h * scale) else { continue };
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
        if !open.is_empty() {
            // A kink: the one-sided differences disagree, too.
            let mut at = |h: f64| {
                document.set(&[(name.clone(), start + h)]).ok()?;
                sample(&mut document, &numbers).filter(|s| s.values.len() == base.values.len())
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
                    let folded = (right - left).abs() > 1e3 * tolerance[owner];
                    let what = all.get(owner).map_or("the mesh", String::as_str);
                    assert!(
                        folded,
                        "seed {seed}: d({what}[{i}])/d({name}) = {} but differences say {}\n{text}",
                        derivative[i],
                        last.get(i).copied().unwrap_or(f64::NAN),
                    );
                    tally.kinks += 1;
                }
            } else {
                tally.kinks += 1;
            }
        }
        tally.values += derivative.len();
        document.set(&[(name.clone(), *start)]).unwrap();
    }
    Some(tally)
}

#[test]
fn derivatives_equal_differences_on_random_models_of_all_kinds() {
    let models = rounds(100);
    let (mut total, mut redrawn) = (Tally::default(), 0);
    for seed in 1..=models as u64 {
        let mut draws = (0..5).map(|k| check(seed + 1000 * k));
        let tally = draws.find_map(|tally| {
            redrawn += usize::from(tally.is_none());
            tally
        });
        let tally = tally.expect("one of five draws is a model");
        total.parameters += tally.parameters;
        total.values += tally.values;
        total.kinks += tally.kinks;
        total.missed += tally.missed;
    }
    println!("{models} models, {redrawn} drawn again: {total:?}");
    assert!(redrawn <= models / 10);
    assert!(total.kinks * 1000 <= total.values, "{total:?}");
    assert!(total.missed <= models / 4, "{total:?}");
}

/// Where a curve has a corner that moves, the corner's own way counts as well.
#[test]
fn lengths_across_moving_corners_have_exact_derivatives() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0.25); AbsPoint D(0.25, 0, 2); \
                AbsPoint E(1, 0.5, 2); AbsPoint F(1.5, 1, 2.25); CCurve a({A, B, C}, degree = 1); \
                CCurve b({D, E, F}, degree = 1); RuledSurf S(a, b); AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.7); \
                LineSnake s(p, q); AbsBead c(a, 0.2); AbsBead d(a, 0.875); SubCurve k(c, d);";
    let mut document = common::sound(text);
    for (number, inputs) in [
        ("s.length", ["p.u", "q.v", "B.x", "E.y"]),
        ("length(s)", ["p.v", "q.u", "C.z", "E.x"]),
        ("k.length", ["c.t", "d.t", "B.y", "A.x"]),
        ("a.length", ["A.x", "B.z", "C.x", "B.y"]),
    ] {
        for input in inputs {
            let exact = document.derivatives(&[number.into()], &[input.into()]).unwrap();
            let Value::Number(exact) = exact[0][0] else { panic!() };
            let start = common::number(&mut document, input);
            let at = |h: f64| {
                document.set(&[(input.into(), start + h)]).unwrap();
                let values = vec![common::number(&mut document, number)];
                document.set(&[(input.into(), start)]).unwrap();
                Some(Sample { values, owners: vec![0] })
            };
            let centred = ridders(at, 1e-2).unwrap()[0];
            let close = (exact - centred).abs() < 1e-7 * exact.abs().max(1.0);
            assert!(close, "d({number})/d({input}) = {exact}, differences {centred}");
        }
    }
}
