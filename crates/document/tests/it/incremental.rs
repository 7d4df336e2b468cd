//! A model that was edited equals one opened from its text, bit for bit, and no more is evaluated
//! than must be.

use crate::common::{Random, number, open, reported, rounds, sound};
use moldloft_document::Document;
use moldloft_num::Order;
use moldloft_registry::Value;
use std::fmt::Write;

/// All that can be seen of a model: objects and the bits of their values, positions of the mesh,
/// what is said of it.
fn seen(document: &mut Document) -> String {
    let mut out = String::new();
    for object in document.graph().objects() {
        let _ = write!(out, "{} {} {:?}: ", object.name, object.row.name, object.head);
        match object.value() {
            Some(value) => bits(value, &mut out),
            None => out.push_str(if object.blocked_by().is_some() { "blocked" } else { "failed" }),
        }
        out.push('\n');
    }
    for param in document.params() {
        let _ = writeln!(out, "{} = {:x}", param.name, param.value.to_bits());
    }
    match document.panelled() {
        Ok(panelled) => {
            for p in panelled.mesh.positions() {
                let _ = writeln!(out, "{:x?}", p.to_array().map(f64::to_bits));
            }
            for remark in panelled.panelling.remarks() {
                let _ = writeln!(out, "{remark}");
            }
        }
        Err(fault) => drop(writeln!(out, "{}", fault.message)),
    }
    for line in reported(document).iter().chain(document.printed()) {
        let _ = writeln!(out, "{line}");
    }
    out
}

fn bits(value: &Value<f64>, out: &mut String) {
    let hex = |x: f64| format!("{:x} ", x.to_bits());
    let vector = |v: moldloft_num::Vec3| v.to_array().map(hex).concat();
    match value {
        Value::Number(x) => out.push_str(&hex(*x)),
        Value::Vector(v) => out.push_str(&vector(*v)),
        Value::Point(p) => {
            out.push_str(&vector(p.xyz));
            out.extend(p.on_curve.iter().map(|place| hex(place.1)));
            out.extend(p.on_surface.iter().map(|place| place.1.map(hex).concat()));
        }
        Value::Curve(c) => {
            for t in [0.0, 0.37, 1.0] {
                c.jet(t, Order::Second).iter().for_each(|v| out.push_str(&vector(*v)));
            }
        }
        Value::Surface(s) => {
            for (u, v) in [(0.0, 0.0), (0.37, 0.61), (1.0, 0.25)] {
                let jet = s.jet(u, v, Order::First);
                [jet.p, jet.u, jet.v].into_iter().for_each(|v| out.push_str(&vector(v)));
            }
        }
        Value::Plane(p) => out.push_str(&(vector(p.point) + &vector(p.normal))),
        Value::Contours(c) => out.extend(c.values.iter().map(|&x| hex(x))),
        other => out.push_str(other.class().name()),
    }
}

const HEAD: &str = "param float w = 5 in [3, 7];\nparam float h = 2*w in [0, 20];\n\
    subroutine leg(float x, AbsPoint p) { AbsPoint foot(x, w, p.z); RelPoint toe(foot, x); Line bone(p, toe); }\n";

/// A program of statements that a test adds, removes, changes and breaks.
#[derive(Clone)]
struct Model {
    /// (name, statement with `#` for a number).
    lines: Vec<Line>,
    next: usize,
    broken: Option<usize>,
}

#[derive(Clone)]
struct Line {
    name: String,
    class: char,
    text: String,
    numbers: Vec<f64>,
}

impl Model {
    fn new(random: &mut Random) -> Self {
        let mut model = Self { lines: Vec::new(), next: 0, broken: None };
        for _ in 0..60 {
            model.add(random, usize::MAX);
        }
        model
    }

    fn is_like(&self, other: &Self) -> bool {
        self.text() == other.text()
    }

    /// A name of class `class` declared before `at`, mostly.
    fn parent(&self, random: &mut Random, class: char, at: usize) -> Option<String> {
        let at = at.min(self.lines.len());
        let fits = |line: &&Line| line.class == class || (class == 'p' && line.class == 'b');
        let found: Vec<&Line> = self.lines[..at].iter().filter(fits).collect();
        (!found.is_empty()).then(|| random.pick(&found).name.clone())
    }

    /// A new statement before line `at`.
    fn add(&mut self, random: &mut Random, at: usize) {
        let at = at.min(self.lines.len());
        let (p, c, s) = ('p', 'c', 's');
        let name = format!("n{}", self.next);
        let (class, text, wants): (char, &str, &[char]) = match random.below(17) {
            0..3 => (p, "AbsPoint @(#, #, #)", &[]),
            3 => (p, "RelPoint @($, #, #, #)", &[p]),
            4 => (p, "MirrPoint @($, \"y=0\")", &[p]),
            5 => (p, "AbsPoint @(max(w, 4.5), #, w)", &[]),
            6 => (c, "Line @($, $)", &[p, p]),
            7 => (c, "BCurve @({$, $, $}, degree = 2, divisions = 4)", &[p, p, p]),
            8 => (c, "CCurve @({$, $, $, $})", &[p, p, p, p]),
            9 => ('b', "AbsBead @($, 0.25)", &[c]),
            10 => (s, "RuledSurf @($, $, divisions = {3, 4})", &[c, c]),
            11 if random.chance(8) => (s, "CLoftSurf @({$, $, $}, divisions = {4, 3})", &[c, c, c]),
            11 => (s, "BLoftSurf @({$, $, $}, degree = 2, divisions = {4, 3})", &[c, c, c]),
            12 => (s, "MirrSurf @($, \"y=0\", divisions = {3, 4})", &[s]),
            13 => (p, "if (length($) > w) { AbsPoint @(w, #, #); } else AbsPoint @(#, w, #)", &[c]),
            14 => (p, "for (i = 1:round(w)) AbsPoint @(i, #, w)", &[]),
            15 => (p, "leg @(#, $)", &[p]),
            _ => (p, "foreach (p in {$, $}) { if (p.x < 8) RelPoint @(p, 1, #); }", &[p, p]),
        };
        let mut text = text.replace('@', &name);
        for &class in wants {
            let Some(mut parent) = self.parent(random, class, at) else { return };
            for _ in 0..8 {
                // Mostly different ones, so that most models have no faults.
                if text.contains(&parent) && random.chance(97) {
                    parent = self.parent(random, class, at).unwrap_or(parent);
                }
            }
            text = text.replacen('$', &parent, 1);
        }
        let numbers = text.matches('#').map(|_| random.decimal(-9.0, 9.0)).collect();
        // Made in loops and subroutines: how others refer to it.
        let name = match text.split([' ', '(']).next() {
            Some("for") => name + "[2]",
            Some("foreach") => name + "[1]",
            Some("leg") => name + ".toe",
            _ => name,
        };
        self.lines.insert(at, Line { name, class, text: text + ";", numbers });
        self.next += 1;
    }

    fn text(&self) -> String {
        let mut out = String::from(HEAD);
        for (k, line) in self.lines.iter().enumerate() {
            let mut text = line.text.clone();
            for &x in &line.numbers {
                text = text.replacen('#', &format!("{x:?}"), 1);
            }
            if self.broken == Some(k) {
                text = text.replacen(['(', ','], "", 1);
            }
            out.push_str(&text);
            out.push('\n');
        }
        out
    }

    /// Changes the text somehow.
    fn change(&mut self, random: &mut Random) {
        let at = random.below(self.lines.len());
        match random.below(8) {
            0 | 1 => self.add(random, at),
            2 if self.lines.len() > 20 => drop(self.lines.remove(at)),
            3 => {
                // Renamed, everywhere or only here.
                let (old, new) = (self.lines[at].name.clone(), format!("m{}", self.next));
                self.next += 1;
                let stem = old.split(['[', '.']).next().unwrap_or(&old);
                let everywhere = random.chance(80);
                for (k, line) in self.lines.iter_mut().enumerate() {
                    if everywhere || k == at {
                        line.text = replaced(&line.text, stem, &new);
                    }
                }
                self.lines[at].name = old.replacen(stem, &new, 1);
                let renamed = self.lines[at].name.clone();
                self.lines
                    .iter_mut()
                    .filter(|l| l.name == old)
                    .for_each(|l| l.name.clone_from(&renamed));
            }
            4 => self.broken = if self.broken.is_some() { None } else { Some(at) },
            5 => {
                // Another parent, perhaps one that is declared later.
                let class = if random.chance(80) { 'p' } else { 'c' };
                let from = self.parent(random, class, usize::MAX);
                let before = if random.chance(90) { at } else { usize::MAX };
                let to = self.parent(random, class, before);
                if let (Some(from), Some(to)) = (from, to)
                    && self.lines[at].name != from
                {
                    self.lines[at].text = replaced(&self.lines[at].text, &from, &to);
                }
            }
            6 => {
                let other = random.below(self.lines.len());
                self.lines.swap(at, other);
            }
            _ => {
                if !self.lines[at].numbers.is_empty() {
                    self.lines[at].numbers[0] = random.decimal(-9.0, 9.0);
                }
            }
        }
    }
}

/// The text with the word `from` replaced.
fn replaced(text: &str, from: &str, to: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(from) {
        let word = |c: char| c.is_ascii_alphanumeric();
        let whole = !rest[..at].ends_with(word) && !rest[at + from.len()..].starts_with(word);
        out.push_str(&rest[..at]);
        out.push_str(if whole { to } else { from });
        rest = &rest[at + from.len()..];
    }
    out + rest
}

/// One direct edit of some literal; false when there is none.
fn edit(document: &mut Document, random: &mut Random) -> bool {
    let graph = document.graph();
    let points: Vec<_> =
        graph.objects().filter(|o| matches!(&*o.row.name, "AbsPoint" | "RelPoint")).collect();
    if points.is_empty() {
        return false;
    }
    let point = random.pick(&points);
    let field = if point.row.name == "AbsPoint" { ["x", "y", "z"] } else { ["dx", "dy", "dz"] };
    let value = *random.pick(&[0.0, -0.0, 1e-300, random_value(point.order), 2.5, -7.125]);
    let name = format!("{}.{}", point.name, field[random.below(3)]);
    match document.set(&[(name, value)]) {
        Ok(_) => true,
        Err(faults) => {
            assert!(faults.iter().all(|f| f.id == "not-a-literal"), "{faults:?}");
            false
        }
    }
}

fn random_value(k: u32) -> f64 {
    f64::from(k) * 0.37 - 3.0
}

/// Edits a model `count` times and compares it with one from scratch after each.
fn edited(seed: u64, count: usize) -> Vec<String> {
    let mut random = Random::new(seed);
    let mut model = Model::new(&mut random);
    let mut document = open(&model.text());
    let mut w = 5.0;
    let mut all = Vec::new();
    let mut good = model.clone();
    for round in 0..count {
        let mut how = random.below(10);
        if !good.is_like(&model) && random.chance(60) {
            // What was broken is mended.
            model = Model { next: model.next, ..good.clone() };
            document.set_text(&model.text());
            how = 10;
        }
        match how {
            0..3 => {
                w = random.decimal(3.0, 7.0);
                document.set(&[("w".into(), w)]).unwrap();
            }
            3..6 => {
                let mut done = 0;
                for _ in 0..1 + random.below(3) {
                    done += usize::from(edit(&mut document, &mut random));
                }
                // The text moved on: the statements' numbers are those of the document.
                let mut again = open(&document.text());
                again.set(&[("w".into(), w)]).unwrap();
                let (a, b) = (seen(&mut document), seen(&mut again));
                assert_eq!(a, b, "round {round}, {done} direct edits\n{}", document.text());
                document.set_text(&model.text());
            }
            10 => {}
            _ => {
                for _ in 0..1 + random.below(2) {
                    model.change(&mut random);
                }
                document.set_text(&model.text());
            }
        }
        let mut again = open(&model.text());
        if again.params().iter().any(|p| p.name == "w") {
            again.set(&[("w".into(), w)]).unwrap();
        }
        let (a, b) = (seen(&mut document), seen(&mut again));
        assert_eq!(a, b, "round {round}, kind {how}\n{}", model.text());
        assert_eq!(document.run().evaluated, 0, "round {round}: nothing has changed");
        if !a.contains("error[") || (a.contains(": failed") && random.chance(50)) {
            good = model.clone();
        }
        all.push(a);
    }
    all
}

#[test]
fn edited_models_equal_those_from_scratch_at_any_thread_count() {
    let count = rounds(1000);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (1..=5).flat_map(|seed| edited(seed, count / 5)).collect::<Vec<String>>())
    };
    let one = run(1);
    assert!(one == run(2), "two threads differ from one");
    assert!(one == run(4), "four threads differ from one");
    let with = |word: &str| one.iter().filter(|text| text.contains(word)).count();
    // Random divisions contradict each other nearly always; that is no fault of a statement.
    let faulty = |text: &&String| {
        text.lines().any(|l| l.contains("error[") && !l.contains("[divisions-contradict]"))
    };
    let errors = one.iter().filter(faulty).count();
    let (failed, blocked) = (with(": failed"), with(": blocked"));
    let meshed = count - with("has no panels");
    println!(
        "{count} edits: {errors} states with errors, {failed} with failed and {blocked} with blocked objects, {meshed} with panels"
    );
    assert!(errors > count / 10 && errors < count && meshed > count / 10);
    assert!(!crate::common::soak() || failed + blocked > count / 50);
}

/// Many objects of one rank, so that several threads share them.
#[test]
fn wide_models_have_the_same_bits_on_any_number_of_threads() {
    let mut text = String::from("param float w = 1;\n");
    for k in 0..400 {
        writeln!(
            text,
            "AbsPoint A{k}(w*{k}, {}, 0); AbsPoint B{k}({k}, w, 1); AbsPoint C{k}({k}, 2, w*w);",
            k % 5
        )
        .unwrap();
        writeln!(text, "CCurve c{k}({{A{k}, B{k}, C{k}}}); AbsBead b{k}(c{k}, 0.3*w);").unwrap();
    }
    text.push_str("CLoftSurf S({c0, c1, c2, c3, c4});");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut document = sound(&text);
            let mut all = seen(&mut document);
            document.set(&[("w".into(), 1.25)]).unwrap();
            all += &seen(&mut document);
            all
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(4));
}

/// Patches whose opposite sides are divided differently are evaluated in parts on all threads.
#[test]
fn large_uneven_patches_have_the_same_bits_on_any_number_of_threads() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/wingbody/wingbody.sdl");
    let text = std::fs::read_to_string(path).unwrap().replace("{48, 10}", "{192, 60}");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut document = sound(&text);
            let mut bits = Vec::new();
            for length in [20.0, 31.0] {
                document.set(&[("length".into(), length)]).unwrap();
                let mesh = document.panelled().unwrap();
                let all = mesh.mesh.positions().iter().flat_map(|p| p.to_array());
                bits.extend(all.map(f64::to_bits));
            }
            bits
        })
    };
    let one = run(1);
    assert!(one.len() > 60_000);
    assert!(one == run(2) && one == run(3));
}

#[test]
fn a_direct_edit_evaluates_exactly_what_it_reaches() {
    let mut text = String::new();
    for k in 0..1250 {
        writeln!(text, "AbsPoint A{k}({k}, 0, 1.25); AbsPoint B{k}({k}, 2, 0.5); AbsPoint C{k}({k}, 1.25, -0.75);").unwrap();
        writeln!(text, "RelPoint D{k}(C{k}, 0, -1, -0.25);").unwrap();
        writeln!(text, "BCurve M{k}({{A{k}, B{k}, C{k}, D{k}}}, degree = 3, visible = 0);")
            .unwrap();
        writeln!(
            text,
            "AbsBead E{k}(M{k}, 0.5); MirrPoint F{k}(E{k}, \"y=0\"); Line L{k}(E{k}, F{k});"
        )
        .unwrap();
    }
    text.push_str("RelPoint G(F7, 1); Line H(G, L7); Line I(G, F7); RelPoint J(G, 1); RelPoint K(J, 1); RelPoint L(K, 1);");
    let text = text.replace("Line H(G, L7);", "MirrPoint H(G, L7);");
    let mut document = sound(&text);
    assert_eq!(document.graph().len(), 10_006);
    // C7, D7, M7, E7, F7, L7, and G, H, I, J, K, L.
    assert_eq!(document.set(&[("C7.y".into(), 1.5)]).unwrap().evaluated, 12);
    // A8, M8, E8, F8, L8.
    assert_eq!(document.set(&[("A8.z".into(), 1.5)]).unwrap().evaluated, 5);
    assert_eq!(document.set(&[("A8.z".into(), 1.5)]).unwrap().evaluated, 0);
    // A number of the text, the same.
    let moved = document.text().replace("AbsPoint A9(9, 0, 1.25)", "AbsPoint A9(9, 0, 1.5)");
    assert_eq!(document.set_text(&moved).evaluated, 5);
    // Blanks and comments change nothing.
    assert_eq!(document.set_text(&moved.replace("\n", "\n  # a comment\n")).evaluated, 0);
}

#[test]
fn equal_results_stop_the_wave() {
    let text = "param float w = 5; AbsPoint A(1, 0, 2); MirrPoint M(A, \"y=0\"); RelPoint R(M, 1); Line l(M, R);\n\
                AbsPoint B(max(w, 6), 0, 0); RelPoint C(B, 1); ProjPoint P(A, \"z=0\"); Line k(P, C);";
    let mut document = sound(text);
    // y = 0 mirrored is -0, so that moves; z of a point projected to z = 0 does not matter.
    assert_eq!(document.set(&[("A.z".into(), 3.0)]).unwrap().evaluated, 5);
    // Below 6 the parameter changes no number of any object; above it B, C and k.
    assert_eq!(document.set(&[("w".into(), 5.5)]).unwrap().evaluated, 0);
    assert_eq!(document.set(&[("w".into(), 7.0)]).unwrap().evaluated, 3);
    // Another head evaluates nothing.
    let coloured = document.text().replace("Line l(M, R)", "Line l(M, R, colour = 3)");
    assert_eq!(document.set_text(&coloured).evaluated, 0);
}

#[test]
fn failures_block_their_children_only() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(2, 1, 0); CCurve c({A, B, C}); AbsBead b(c, 0.5);\n\
                RelPoint r(b, 1); Line l(A, B); RuledSurf S(c, l);";
    let mut document = sound(text);
    document.set(&[("B.x".into(), 0.0)]).unwrap();
    assert_eq!(document.applied().failed, 4);
    let blocked: Vec<&str> =
        document.graph().objects().filter(|o| o.blocked_by().is_some()).map(|o| &*o.name).collect();
    assert_eq!(blocked, ["b", "r", "S"]);
    // The failure, and the line of no length.
    assert_eq!(document.diagnostics().len(), 2, "{:?}", reported(&document));
    assert_eq!(number(&mut document, "l.length"), 0.0);
    assert!(document.eval("r.x").is_err());
    // What stays blocked is not evaluated on and on.
    assert_eq!(document.set(&[("C.x".into(), 3.0)]).unwrap().evaluated, 2);
    document.set(&[("B.x".into(), 1.0)]).unwrap();
    assert_eq!((document.applied().failed, document.diagnostics().len()), (0, 0));
}

/// A program that reads objects must run again when they change; the direct edit notices.
#[test]
fn a_direct_edit_equals_the_run_where_the_program_reads_objects() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(3, 4, 0); Line l(A, B); float s = length(l);\n\
                AbsPoint C(s, 0, 0); RelPoint R(C, 1); if (A.z > 1) { AbsPoint D(A.z, l(0.5).x, l.length); }\n\
                for (i = 1:round(B.y)) AbsPoint p(i, 0, 0); AbsPoint Q(7, 7, 7); RelPoint T(Q, B.x); print l.length;\n\
                AbsPoint U(9, 9, 9); Line n(U, A);";
    let mut document = sound(text);
    let compare = |document: &mut Document, what: &str| {
        let mut again = open(&document.text());
        assert_eq!(seen(document), seen(&mut again), "{what}");
    };
    for (name, value) in [
        ("B.x", 6.0),
        ("A.z", 2.0),
        ("B.y", 8.25),
        ("A.z", 0.5),
        ("B.y", 1.0),
        ("Q.x", 1.0),
        ("A.x", 5.0),
        ("U.x", 3.0),
    ] {
        document.set(&[(name.into(), value)]).unwrap();
        compare(&mut document, name);
    }
    // What the program does not read takes the short way.
    assert_eq!(document.set(&[("U.y".into(), 1.0)]).unwrap().evaluated, 2);
    compare(&mut document, "U.y");
    // The number of an object that is only made under a condition on another.
    document.set(&[("A.z".into(), 3.0)]).unwrap();
    assert_eq!(number(&mut document, "D.x"), 3.0);
    compare(&mut document, "A.z");
    // Several at once, some read and some not.
    document.set(&[("U.x".into(), 0.0), ("B.x".into(), 0.25), ("Q.z".into(), 0.0)]).unwrap();
    compare(&mut document, "several");
    // A failure that is read.
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); CCurve c({A, B}); float s = c.length; AbsPoint C(s, 0, 0);";
    let mut document = sound(text);
    document.set(&[("B.x".into(), 0.0)]).unwrap();
    compare(&mut document, "failing");
    document.set(&[("B.x".into(), 2.0)]).unwrap();
    compare(&mut document, "mended");
    assert_eq!(number(&mut document, "C.x"), 2.0);
}

/// Numbers survive the way through the text.
#[test]
fn direct_edits_are_written_as_they_are() {
    let mut document = sound("AbsPoint A(1, 2, 3); vector v = A; RelPoint B({1, 2, 3}, 0.5);");
    let mut random = Random::new(3);
    for k in 0..2000 {
        let x = match k % 4 {
            0 => f64::from_bits(random.bits()),
            1 => random.decimal(-1e6, 1e6),
            2 => f64::from_bits(random.below(1 << 52) as u64),
            _ => -0.0,
        };
        // Larger ones are refused.
        if x.is_nan() || x.abs() > 1e50 {
            continue;
        }
        document.set(&[("A.y".into(), x), ("B.point.z".into(), -x)]).unwrap();
        let again = open(&document.text());
        let at = |d: &Document, name: &str| match d
            .graph()
            .get(d.graph().find(name).unwrap())
            .unwrap()
            .value()
        {
            Some(Value::Point(p)) => p.xyz.to_array().map(f64::to_bits),
            other => panic!("{other:?}"),
        };
        assert_eq!(at(&document, "A"), at(&again, "A"), "{x:e}\n{}", document.text());
        assert_eq!(at(&document, "B"), at(&again, "B"), "{x:e}");
        // Minus zero is written as zero.
        assert_eq!(at(&document, "A")[1], (x + 0.0).to_bits());
    }
}

/// Surfaces with knuckles of which one may go, their images, edges in pieces between a moving bead, sizes.
const SHELL: &str = "param float w = 5 in [3, 7]; param float k = 1 in [0, 2]; param float t = 0.4 in [0.2, 0.8];
    param float size = 0.9 in [0.5, 2];
    AbsPoint a(0, 0, 0); AbsPoint b(2, k, 0); AbsPoint c(4, 0, 0); Line l1(a, b); Line l2(b, c); PolyCurve p({l1, l2});
    AbsPoint a2(0, 0.5, w); AbsPoint b2(2, 0.5 + k, w); AbsPoint c2(4, 0.5, w);
    Line m1(a2, b2); Line m2(b2, c2); PolyCurve q({m1, m2});
    RuledSurf s(p, q, divisions = {6, 4}); MirrSurf i(s, \"y=-1\"); MirrSurf j(i, \"x=-1\");
    AbsBead e(q, t); AbsPoint d(0, 3, w); AbsPoint d2(2, 3, w); AbsPoint d3(4, 3, w); Line n1(d, d2); Line n2(d2, d3);
    AbsBead e0(q, 0); AbsBead e1(q, 1); SubCurve q1(e0, e); SubCurve q2(e, e1); RuledSurf r1(q1, n1); RuledSurf r2(q2, n2);
    Line up(a, a2); Line side(c, c2); Line far(d, d3); RuledSurf z(up, side, size = {size, size});";

#[test]
fn panels_after_changes_are_those_of_a_fresh_start() {
    let text = SHELL;
    let mut random = Random::new(23);
    let mut document = open(text);
    assert!(
        !reported(&document).iter().any(|d| d.starts_with("error")),
        "{:?}",
        reported(&document)
    );
    let ranges = [("w", 3.0, 7.0), ("k", 0.0, 2.0), ("t", 0.2, 0.8), ("size", 0.5, 2.0)];
    let mut values: Vec<(String, f64)> = Vec::new();
    for round in 0..rounds(1500) {
        let (name, low, high) = *random.pick(&ranges);
        // Ends of ranges as well: there a knuckle is none, and lines fall together.
        let x = match random.below(4) {
            0 => low,
            _ => random.between(low, high),
        };
        values.retain(|(n, _)| n != name);
        values.push((name.into(), x));
        document.set(&[(name.into(), x)]).unwrap();
        let mut fresh = open(text);
        fresh.set(&values).unwrap();
        assert!(seen(&mut document) == seen(&mut fresh), "round {round}: {values:?}");
    }
}
