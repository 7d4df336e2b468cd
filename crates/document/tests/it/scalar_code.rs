//! Code for what is done on numbers against the interpreter: random ordinary programs, run by both. The same values
//! bit by bit, the same diagnostics with all places and notes, the same prints, the same count of steps.

use crate::common::{Random, reported};
use moldloft_diag::{Diagnostic, Severity};
use moldloft_document::{Document, NoFiles, registry};
use moldloft_registry::Value;

/// Names of numbers at file level, of arrays, and of routines with their arguments.
const NUMBERS: [&str; 6] = ["x", "y", "z", "i", "n", "p"];
const LOCALS: [&str; 5] = ["u", "v", "k", "x", "w"];

struct Programs {
    random: Random,
    /// True inside of a routine.
    local: bool,
    loops: usize,
    /// Percentage of what is likely to fail.
    faults: usize,
}

impl Programs {
    fn name(&mut self) -> &'static str {
        match self.local && self.random.chance(65) {
            true => self.random.pick::<&str>(&LOCALS),
            false => self.random.pick::<&str>(&NUMBERS),
        }
    }

    fn index(&mut self, extent: usize) -> String {
        if self.random.chance(self.faults) {
            return self.number(1);
        }
        match self.random.below(4) {
            0 => format!("{}", 1 + self.random.below(extent)),
            1 => format!("mod(floor({}), {extent}) + 1", self.number(1)),
            2 => format!("round(mod({}, {}) + 1)", self.number(1), extent - 1),
            _ => format!("max(1, min({extent}, floor({})))", self.number(1)),
        }
    }

    fn number(&mut self, depth: usize) -> String {
        if depth == 0 || self.random.chance(25) {
            return match self.random.below(12) {
                0..=5 => self.name().into(),
                6 => self.random.pick(&["1", "2.5", "0", "-3", "7", "0.1"]).to_string(),
                7 => format!("a[{}]", self.random.below(5) + 1),
                8 => format!("b[{}, {}]", self.random.below(3) + 1, self.random.below(4) + 1),
                9 => "PI".into(),
                10 if self.random.chance(self.faults) => "unknown".into(),
                10 => "a.d1".into(),
                _ => format!("{}", self.random.below(9)),
            };
        }
        let d = depth - 1;
        match self.random.below(22) {
            0..=2 => format!("({} + {})", self.number(d), self.number(d)),
            3 => format!("({} - {})", self.number(d), self.number(d)),
            4 | 5 => format!("{}*{}", self.atom(d), self.atom(d)),
            6 if self.random.chance(self.faults) => {
                format!("({})/({})", self.number(d), self.number(d))
            }
            6 => format!("({})/(|{}| + 1)", self.number(d), self.number(d)),
            7 => format!("({})^{}", self.number(d), self.random.below(4)),
            8 if self.random.chance(self.faults) => {
                let f = *self.random.pick(&["sqrt", "log", "asin", "exp"]);
                format!("{f}({})", self.number(d))
            }
            8 => format!("sqrt(|{}|)", self.number(d)),
            9 => format!(
                "{}({})",
                self.random.pick(&["sin", "floor", "sign", "atan"]),
                self.number(d)
            ),
            10 => format!("min({}, {})", self.number(d), self.number(d)),
            11 => format!("max({}, {}, {})", self.number(d), self.number(d), self.number(d)),
            12 => format!("mod({}, 7)", self.number(d)),
            13 => format!("({} {} {})", self.number(d), self.relation(), self.number(d)),
            14 => format!("({} and not {})", self.number(d), self.number(d)),
            15 => {
                let extent = 5;
                format!("a[{}]", self.index(extent))
            }
            16 => format!("b[{}, {}]", self.index(3), self.index(4)),
            17 if self.random.chance(50) => {
                format!("quick({}, {})", self.number(d), self.number(d))
            }
            17 => format!("f({}, {})", self.number(d), self.number(d)),
            18 => format!("g({})", self.number(d)),
            19 => format!("mean_of(a, {})", self.number(d)),
            20 => format!("-{}^2*{}", self.atom(d), self.atom(d)),
            _ => format!("h({})", self.number(d)),
        }
    }

    fn atom(&mut self, depth: usize) -> String {
        format!("({})", self.number(depth))
    }

    /// A text; the variables are `t`, `w` and, in routines, `own`.
    fn text(&mut self, depth: usize) -> String {
        if depth == 0 || self.random.chance(30) {
            return match self.random.below(8) {
                0 | 1 => format!("\"{}\"", self.random.pick::<&str>(&["", "a", "ab", "b", "é"])),
                2 if self.random.chance(self.faults) => self.number(0),
                3 if self.local => "own".into(),
                2..=5 => "t".into(),
                _ => "words".into(),
            };
        }
        let d = depth - 1;
        match self.random.below(5) {
            0 | 1 => format!("{} + {}", self.text(d), self.text(d)),
            2 => format!("({})", self.text(d)),
            3 => format!(
                "format(\"{}\", {}, {})",
                self.random.pick::<&str>(&["%g|%g", "%d %s", "%5.2f%s", "%s", "%%%-6g", "%q"]),
                self.number(1),
                if self.random.chance(50) { self.text(d) } else { self.number(1) }
            ),
            _ => format!("format({}, {})", self.text(d), self.number(d)),
        }
    }

    fn of_texts(&mut self) -> String {
        match self.random.below(9) {
            0 | 1 => format!("t = {};", self.text(2)),
            2 => format!("words = {};", self.text(1)),
            3 => format!("t += {};", self.text(1)),
            4 => format!("string late = {}; t = late;", self.text(1)),
            5 => format!("string {};", self.random.pick::<&str>(&["late", "t"])),
            6 => "print t;".into(),
            7 => format!("x = same({}, {});", self.text(1), self.text(1)),
            _ => format!("longer({}, t);", self.text(1)),
        }
    }

    fn relation(&mut self) -> &'static str {
        self.random.pick::<&str>(&["<", ">", "<=", ">=", "==", "!="])
    }

    fn condition(&mut self) -> String {
        match self.random.below(8) {
            7 => format!("{} {} {}", self.text(1), self.relation(), self.text(1)),
            0 => format!(
                "{} {} {} and {} > 0",
                self.number(1),
                self.relation(),
                self.number(1),
                self.name()
            ),
            1 => format!("{} < 2 or {} > {}", self.name(), self.number(1), self.number(1)),
            2 => format!("not ({} > 1)", self.number(1)),
            3 => "isset(a[2])".into(),
            4 => self.number(2),
            _ => format!("{} {} {}", self.number(2), self.relation(), self.number(2)),
        }
    }

    fn block(&mut self, depth: usize) -> String {
        let count = 1 + self.random.below(4);
        let all: Vec<String> = (0..count).map(|_| self.statement(depth)).collect();
        format!("{{\n{}\n}}", all.join("\n"))
    }

    fn statement(&mut self, depth: usize) -> String {
        if self.random.chance(15) {
            return self.of_texts();
        }
        let odd = self.random.chance(12);
        if odd {
            return match self.random.below(15) {
                0 => format!("print {};", self.number(1)),
                1 => "a = a*0.5;".into(),
                2 => format!("vector q = {{{}, 1, 2}};", self.name()),
                3 => format!("float {} = {};", self.name(), self.number(2)),
                4 => format!("int {} = floor({});", self.name(), self.number(1)),
                5 if self.random.chance(self.faults) => {
                    format!("int {} = {};", self.name(), self.number(2))
                }
                6 => format!("farray a[{}];", 5 + self.random.below(2)),
                7 => format!("foreach (t in a) {{ {} += small(t); }}", self.name()),
                8 => format!("change({});", self.name()),
                9 => format!("s({}, {});", self.number(1), self.number(1)),
                10 if self.random.chance(self.faults) => "ieee();".into(),
                11 => "ieee(0);".into(),
                12 => "c[2] = {x, y, 1};".into(),
                13 => format!("if ({} > 3) float late = {};", self.name(), self.number(1)),
                _ => format!("assert {} < 100;", self.name()),
            };
        }
        if self.local && self.random.chance(7) {
            return format!("if ({}) return {};", self.condition(), self.number(2));
        }
        let compound = depth > 0 && self.random.chance(40);
        match (compound, self.random.below(10)) {
            (false, 0..=3) => format!("{} = small({});", self.name(), self.number(3)),
            (false, 4) => format!("{} += small({});", self.name(), self.number(2)),
            (false, 5) => format!("{} = {};", self.name(), self.number(3)),
            (false, 6) => format!("a[{}] = small({});", self.index(5), self.number(2)),
            (false, 7) => {
                format!("a[{}] *= {};", self.index(5), self.random.pick(&["0.5", "x", "-1"]))
            }
            (false, 8) => {
                format!("b[{}, {}] = small({});", self.index(3), self.index(4), self.number(2))
            }
            (false, _) if self.loops > 0 && self.random.chance(30) => {
                format!("if ({}) {};", self.condition(), self.random.pick(&["break", "continue"]))
            }
            (false, _) => format!("{} -= {};", self.name(), self.number(1)),
            (true, 0..=2) => format!("if ({}) {}", self.condition(), self.block(depth - 1)),
            (true, 3) => {
                let (a, b) = (self.block(depth - 1), self.block(depth - 1));
                format!("if ({}) {a} else {b}", self.condition())
            }
            (true, 4) => {
                self.loops += 1;
                let body = self.block(depth - 1);
                self.loops -= 1;
                format!(
                    "{{ int r = 0; while (r < {}) {{ r += 1;\n{body} }} }}",
                    self.random.below(4)
                )
            }
            (true, 5) => {
                self.loops += 1;
                let body = self.block(depth - 1);
                self.loops -= 1;
                let name = if self.local { "k" } else { "i" };
                format!("for ({name} = 0; {name} < 3; {name} += 1) {body}")
            }
            (true, _) => {
                self.loops += 1;
                let body = self.block(depth - 1);
                self.loops -= 1;
                let name = self.name();
                let range = match self.random.below(4) {
                    0 => "3:1:-1".to_string(),
                    1 => format!("0:{}:0.25", self.random.below(2)),
                    2 if self.random.chance(self.faults) => {
                        format!("1:{}:{}", self.name(), self.name())
                    }
                    _ => format!("1:{}", self.random.below(5)),
                };
                format!("for ({name} = {range}) {body}")
            }
        }
    }

    fn program(&mut self) -> String {
        let mut text = String::from(
            "param float p = 1.5;\nfloat x = 1, y = .5, z = -2; int i = 1, n = 3;\nfarray a[5]; a[1] = 1; a[3] = x;\n\
             farray b[3,4] = 0.5; curve c[3]; string t = \"a\", words = \"b c\";\n\
             function float same(string own, string other) { if (own == other) return 1; own += other; return own < t; }\n\
             subroutine longer(string own, returned string other) { if (other < \"zzzz\") other += own + words; else other = own; }\n\
             function float small(float v) { while (|v| > 1e4) v /= 1024; return v; }\n\
             function float f(float m, float v) { if (m < 1) return v; if (m > 20) return 20; float w = f(m - 1, v*0.5); return w + m; }\n\
             function float quick(float t, float r) { return sqrt(|t|)*r^2 + t/(r + 1) - mod(t, 3); }\n\
             function int h(float t) { x += 0.5; if (t > 3) return floor(t); return 1; }\n\
             function float mean_of(farray q, float t) { float s = 0; for (j = 1:q.d1) s += q[j]; if (t > 2) q[1] = t; return s/q.d1 + q[1]; }\n\
             subroutine change(returned float t) { t += 1; for (j = 1:3) t += j/4; }\n",
        );
        self.local = true;
        let body: Vec<String> = (0..3).map(|_| self.statement(2)).collect();
        text += &format!(
            "function float g(float u) {{ float v = u*2; int k = 2; float w = 0; string own = format(\"%g\", u);\n{}\nreturn small(v + w); }}\n",
            body.join("\n")
        );
        let body: Vec<String> = (0..2).map(|_| self.statement(1)).collect();
        text += &format!(
            "subroutine s(float u, int k) {{ float v = 1, w = 2; string own;\n{}\n}}\n",
            body.join("\n")
        );
        self.local = false;
        for _ in 0..2 + self.random.below(3) {
            self.loops += 1;
            let body = self.block(3);
            self.loops -= 1;
            let name = *self.random.pick(&["i", "x", "j"]);
            text += &format!("for ({name} = 1:{}) {body}\n", 1 + self.random.below(5));
        }
        text
    }
}

/// The bits of all numbers; those of what is not a number say nothing.
pub(crate) fn bits(value: &Value<f64>) -> Vec<u64> {
    let of = |x: &f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
    match value {
        Value::Number(x) => vec![of(x)],
        Value::Numbers(a) => a.items.iter().map(of).collect(),
        Value::Vector(v) => v.to_array().iter().map(of).collect(),
        Value::Vectors(a) => a.planes.iter().flatten().map(of).collect(),
        Value::Text(text) => text.bytes().map(u64::from).collect(),
        _ => Vec::new(),
    }
}

pub(crate) fn opened(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text)
}

/// Both runs of a program, compared; how many errors there are.
pub(crate) fn compare(text: &str, most: u64, what: &str) -> (Document, usize) {
    let ([coded, plain], count) = alike(text, most, what);
    assert_eq!(coded.steps(), plain.steps(), "{what}\n{text}");
    (coded, count)
}

/// The same but for the steps: a fault in the middle of a statement on arrays is found by the reference before what
/// follows in it is evaluated.
pub(crate) fn alike(text: &str, most: u64, what: &str) -> ([Document; 2], usize) {
    let mut coded = opened("");
    let mut plain = opened("");
    coded.with_steps(most);
    plain.with_steps(most);
    coded.set_text(text);
    plain.set_text(text);
    plain.by_reference();
    let all = |d: &Document| -> Vec<String> {
        d.diagnostics().iter().map(|d| format!("{d:?}")).collect()
    };
    if all(&coded) != all(&plain) {
        assert_eq!(reported(&coded), reported(&plain), "{what}\n{text}");
        assert_eq!(all(&coded), all(&plain), "{what}\n{text}");
    }
    assert_eq!(coded.printed(), plain.printed(), "{what}\n{text}");
    let shown = |d: &Document| -> Vec<String> {
        let all = d.variables();
        all.iter().map(|(name, ty, value)| format!("{name} {ty} {:?}", bits(value))).collect()
    };
    assert_eq!(shown(&coded), shown(&plain), "{what}\n{text}");
    // Notes of unused names are no faults.
    let is_fault = |d: &&Diagnostic| d.severity == Severity::Error;
    let count = coded.diagnostics().iter().filter(is_fault).count();
    ([coded, plain], count)
}

/// A condition that is left to the interpreter, after a function of it was put in place: its fault leaves the whole
/// statement, not the function.
#[test]
fn a_faulty_condition_does_not_hold() {
    let text = "float y = .5; function float f(float t) { return t + 1; } function int h(float t) { y += 0.5; return 1; } \
                for (j = 1:3) { if ((f(y) != unknown) > y) { print 1; if ((h(2) and not y) < 3) print 2; } print 3; }";
    let (document, _) = compare(text, 60_000, "a faulty condition");
    assert_eq!(document.printed(), ["3", "3", "3"]);
}

#[test]
fn code_does_what_the_interpreter_does() {
    let (mut faulty, mut sound) = (0, 0);
    for round in 0..moldloft_testing::rounds(200, 20_000) {
        let random = Random::new(round as u64 + 1);
        let mut programs = Programs { random, local: false, loops: 0, faults: 8 };
        programs.faults = if round % 3 == 0 { 0 } else { 12 };
        let text = programs.program();
        // Now and then the steps do not suffice: the run ends at the same place.
        let most = if round % 5 == 4 { 40 + programs.random.below(3000) as u64 } else { 60_000 };
        let (_, count) = compare(&text, most, &format!("round {round}"));
        faulty += usize::from(count > 0);
        sound += usize::from(count == 0);
    }
    assert!(faulty > 20 && sound > 5, "{faulty} {sound}");
}

/// Programs with something of their own: each was written for a rule of the language.
const PROGRAMS: [&str; 17] = [
    // A fault in the middle of a call, of a loop, of a recursion.
    "float s = 0; farray a[3]; function float f(float k) { a[k] = k; return 1/(3 - k); } for (k = 1:5) s += f(k);",
    "function float f(float n) { if (n < 1) return sqrt(-1); return f(n - 1) + 1; } float s = 0; for (k = 1:3) s += f(k);",
    // Whole numbers are exact to 2^53.
    "int n = 1; for (k = 1:60) n = n*2; float x = n; for (k = 1:3) { int m = k/2; x += m; }",
    // A declaration that fails leaves its name without meaning.
    "float s = 0; for (k = 1:4) { float t = 1/(k - 2); s += t; float u = t; s += u; }",
    // A name that comes late, and one of the file that a routine's own hides.
    "float v = 1; function float f(float x) { if (x > 2) float v = 5; v = v + 1; return v; } float s = 0; for (k = 1:4) s += f(k);",
    "float s = 0; for (k = 1:4) { if (k > 2) float late = k; s += late; }",
    // The variable of a loop is a float after the loop, whatever it was.
    "int k = 2; for (j = 1:2) { k = j/2; for (k = 0:1:0.25) {} k = 0.3; }",
    // Endless loops end, steps of zero are refused.
    "float s = 0; for (k = 1:3) for (j = 0:1:k - 2) s += j;",
    // Infinite results pass on request.
    "float s = 0; for (k = -2:2) { if (k == 0) ieee(); s += 1/k; } for (k = 1:3) s = k/0; ieee(0); for (k = 1:2) s = k/0;",
    // Arrays without a shape, of another shape, with what was never given.
    "farray a, b[2,2]; float s = 0; for (k = 1:2) { s = a[1/(k - 1)]; s = b[k]; b[1, k] = 2; a[k] = 1; s += isset(b[1, 2]); a = {1, 2}; }",
    // A function that comes to its end without a value, one of no argument, `break` outside of loops.
    "function float f(float x) { if (x > 2) return x; } function int g() { return 1.5; } subroutine h(float x) { if (x > 1) break; x = 1/0; } float s = 0; for (k = 1:4) { s += f(k); s += g(); h(k); }",
    // Short functions: steps, faults and declarations that fail in them.
    "function float q(float t) { return 1/(t - 2); } function float f(float n) { if (n < 1) return q(2); return q(n)*f(n - 1) + q(q(2)); } for (k = 1:3) { float u = q(k) + f(k); float v = u + q(2*k); float s = v; }",
    // Texts: of the file, of a routine, by reference, of a loop's own; joined with a number, and by a pattern that is wrong.
    "string t = \"a\", u; int n = 0; function float size(string own) { t += own; string more; more = own + t; if (more == \"aaa\") return 1; return 2; } for (k = 1:4) { string w = format(\"%d\", k); u = w + t; n += size(w); if (u > w) t = u; u += \"x\"; string v = t + k; v = v + w; w = format(\"%d\", k/2); string r = format(\"%q\", k) + t; }",
    "string names[2] = {\"x\", \"y\"}, t; subroutine longer(returned string own) { own += own; own = own + \"e\"; } for (k = 1:5) { longer(t); foreach (w in names) { t += w; if (w == t or t != \"\") t = w; } t = names[k]; float z = t == k; if (not t) t = 3; t -= w; }",
    // Texts that are joined with themselves and from both sides, sums that no int holds, `if` and `while` in every order.
    "string t = \"a\", u = \"b\"; int n = 9007199254740000, k = 0; while (k < 4) { k += 1; t = u + t; t += t; u = t; t = (t + u) + u; string own = u + t; own += own; if (k > 1) n += 500; if (k > 2) n += 0.5; else if (t > u) k += 0; while (n < k) n += 1; }",
    // `foreach` in calls of itself, left and changed while it runs.
    "farray a = {1, 2, 3}; curve c = {a, 2*a, a}; vector v; float s = 0; function float inner(farray q, float d) { float t = 0; foreach (x in q) { if (d > 0) t += inner(q, d - 1); t += x/(x - 2); } return t; } for (k = 1:2) { foreach (p in c) { v += p; foreach (x in a) { s += x; a[1] = s; if (x > 2) break; s += inner(a, 1); } } }",
    // Subscripts of subscripts, and which fault comes first.
    "farray a[3] = 1, b[3,3] = 2; float s = 0; for (k = 1:5) { s += b[k, a[k/2]]; s += b[9, 1/0]; a[a[k]*4] = b[1/0, k]; farray q[0, 1/0]; }",
];

#[test]
fn rules_of_the_language_hold_in_code() {
    for (k, text) in PROGRAMS.iter().enumerate() {
        // The run ends at each of the first steps.
        for most in 1..60 {
            compare(text, most, &format!("program {k}, {most} steps"));
        }
        compare(text, 5_000, &format!("program {k}"));
        // Objects and names in loops are those of the turn.
        let named =
            format!("{text}\nfor (k = 1:3) {{ float x = k/2; if (x > .6) AbsPoint P(x, 0, 0); }}");
        compare(&named, 5_000, &format!("program {k} with objects"));
    }
}

#[test]
fn calls_nest_as_deep_as_without_code() {
    let text = "function float f(float n) { if (n < 1) return 0; return f(n - 1) + 1; } float s = 0; for (k = 1:2) s += f(k*5000);";
    let (mut document, count) = compare(text, 1_000_000, "10 000 calls");
    assert_eq!(count, 0);
    assert_eq!(crate::common::number(&mut document, "s"), 15_000.0);
    let text =
        "function float f(float n) { return f(n + 1) + 1; } float s = 0; for (k = 1:2) s += f(k);";
    let (document, _) = compare(text, 1_000_000, "endless calls");
    assert_eq!(crate::common::ids(&document)[0], "nested-too-deep");
    // Statements that the interpreter executes between the calls, and calls in them.
    let text = "curve c[2]; function float f(float n) { if (n < 1) return 0; c[1] = {n, f(n - 1), 0}; return n; } float s = 0; for (k = 1:2) s += f(k*1500);";
    let (_, count) = compare(text, 1_000_000, "calls in statements of arrays");
    assert_eq!(count, 0);
}

/// Derivatives of loops are those of the interpreter, bit by bit.
#[test]
fn derivatives_go_through_code() {
    let text = "param float p = 1.25; farray a[4]; float s = 0;\n\
        function float f(float x, int n) { if (n < 1) return x; return f(x*p + sin(x), n - 1)/2; }\n\
        for (i = 1:4) { a[i] = p^i + f(p, i); if (a[i] > 2) s += sqrt(a[i]); else s -= a[i]^2/p; s += mod(s*p, 3); }";
    let mut coded = opened(text);
    let mut plain = opened(text);
    plain.by_reference();
    let by = ["p".to_string()];
    for name in ["s", "a"] {
        let [a, b] = [&mut coded, &mut plain].map(|d| d.derivatives(&[name.into()], &by).unwrap());
        assert_eq!(bits(&a[0][0]), bits(&b[0][0]), "{name}");
        assert!(bits(&a[0][0]).iter().any(|bits| *bits != 0), "{name}");
    }
}

/// A run that is cancelled ends, also in the middle of a loop that would not.
#[test]
fn code_can_be_stopped() {
    let mut document = opened("");
    document.with_steps(u64::MAX);
    let budget = document.budget();
    let (begun, begins) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            begins.recv().unwrap();
            budget.cancel();
        });
        begun.send(()).unwrap();
        document.set_text("float s = 0; while (1) s += 1;");
    });
    assert_eq!(crate::common::ids(&document), ["cancelled"]);
}
