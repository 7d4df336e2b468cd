//! Code for vectors, points of curves and surfaces, `foreach` and arguments passed by reference against the
//! interpreter: random ordinary programs, run by both.

use crate::common::Random;
use crate::scalar_code::{bits, compare, opened};

/// Writes programs on vectors.
struct VectorPrograms {
    random: Random,
    /// True inside of a routine.
    local: bool,
    loops: usize,
    /// Percentage of what is likely to fail.
    faults: usize,
}

impl VectorPrograms {
    fn number_name(&mut self) -> &'static str {
        match self.local && self.random.chance(50) {
            true => self.random.pick::<&str>(&["u", "k", "late"]),
            false => self.random.pick::<&str>(&["x", "y", "i", "m", "t"]),
        }
    }

    fn vector_name(&mut self) -> &'static str {
        match self.local && self.random.chance(50) {
            true => self.random.pick::<&str>(&["v", "w"]),
            false => self.random.pick::<&str>(&["p", "q", "r"]),
        }
    }

    fn index(&mut self, extent: usize) -> String {
        if self.random.chance(self.faults / 2) {
            return self.number(1);
        }
        match self.random.below(3) {
            0 => format!("{}", 1 + self.random.below(extent)),
            1 => format!("mod(floor({}), {extent}) + 1", self.number(0)),
            _ => format!("max(1, min({extent}, floor({})))", self.number(1)),
        }
    }

    fn element(&mut self) -> String {
        match self.random.below(4) {
            0 => format!("g[{}, {}]", self.index(3), self.index(4)),
            1 => format!("d[{}]", self.index(3)),
            _ => format!("c[{}]", self.index(4)),
        }
    }

    fn number(&mut self, depth: usize) -> String {
        if depth == 0 || self.random.chance(25) {
            return match self.random.below(9) {
                0..=3 => self.number_name().into(),
                4 => self.random.pick(&["1", "2.5", "0", "-3", "0.1"]).to_string(),
                5 => format!("{}.{}", self.vector_name(), self.axis()),
                6 => format!("{}.{}", self.element(), self.axis()),
                7 => self.random.pick(&["c.d1", "g.d1", "g.d2", "PI", "a[2]"]).to_string(),
                _ => format!("{}", self.random.below(9)),
            };
        }
        let d = depth - 1;
        match self.random.below(13) {
            0 | 1 => format!("({} + {})", self.number(d), self.number(d)),
            2 => format!("({})*({})", self.number(d), self.number(d)),
            3 => format!("({} - {})", self.number(d), self.number(d)),
            4 if self.random.chance(self.faults) => {
                format!("({})/({})", self.number(d), self.number(d))
            }
            4 => format!("({})/(|{}| + 1)", self.number(d), self.number(d)),
            5 | 6 => format!("|{}|", self.vector(d)),
            7 => format!("({} . {})", self.vector(d), self.vector(d)),
            8 => format!("({}).{}", self.vector(d), self.axis()),
            9 => format!("dist({}, {})", self.vector(d), self.vector(d)),
            10 => format!("sin({})", self.number(d)),
            11 => format!("a[{}]", self.index(5)),
            _ => format!("max({}, {})", self.number(d), self.number(d)),
        }
    }

    fn axis(&mut self) -> &'static str {
        self.random.pick::<&str>(&["x", "y", "z"])
    }

    fn vector(&mut self, depth: usize) -> String {
        if depth == 0 || self.random.chance(20) {
            return match self.random.below(6) {
                0..=2 => self.vector_name().into(),
                3 => self.element(),
                4 if self.random.chance(self.faults) => "unknown".into(),
                4 => self.random.pick(&["{1, 2, 3}", "{0, 0, 1}", "{x, 1, 0.5}"]).to_string(),
                _ => format!("{{{}, {}, {}}}", self.number(0), self.number(0), self.number(0)),
            };
        }
        let d = depth - 1;
        match self.random.below(13) {
            0 | 1 => format!("({} + {})", self.vector(d), self.vector(d)),
            2 => format!("({} - {})", self.vector(d), self.vector(d)),
            3 => format!("{}*({})", self.number(d), self.vector(d)),
            4 => format!("({})*({})", self.vector(d), self.number(d)),
            5 if self.random.chance(self.faults) => {
                format!("({})/({})", self.vector(d), self.number(d))
            }
            5 => format!("({})/(|{}| + 1)", self.vector(d), self.number(d)),
            6 => format!("({} .* {})", self.vector(d), self.vector(d)),
            7 => format!("-({})", self.vector(d)),
            8 => format!("mid({}, {})", self.vector(d), self.vector(d)),
            9 => format!("turned({}, {})", self.vector(d), self.number(d)),
            10 => format!("({} * {})", self.vector(d), self.vector(d)),
            11 => format!("walked(c, {})", self.index(4)),
            _ => format!("{{{}, {}, {}}}", self.number(d), self.number(d), self.number(d)),
        }
    }

    fn block(&mut self, depth: usize) -> String {
        let count = 1 + self.random.below(4);
        let all: Vec<String> = (0..count).map(|_| self.statement(depth)).collect();
        format!("{{\n{}\n}}", all.join("\n"))
    }

    fn statement(&mut self, depth: usize) -> String {
        if self.random.chance(10) {
            return match self.random.below(14) {
                0 => format!("print {}, {};", self.number(1), self.vector(1)),
                1 => "c = c*0.5;".into(),
                2 => format!("vector {} = {};", self.vector_name(), self.vector(2)),
                3 => format!("float {};", self.number_name()),
                4 => format!("vector {};", self.vector_name()),
                5 => format!("curve c[{}];", 4 + self.random.below(2)),
                6 => "surface g[3, 4];".into(),
                7 => "g[,2] = d;".into(),
                8 => "c = c[::-1];".into(),
                9 if self.random.chance(self.faults) => format!("p = {};", self.number(1)),
                10 if self.random.chance(self.faults) => format!("x = {};", self.vector(1)),
                11 if self.random.chance(self.faults) => "c[2] = 3;".into(),
                12 => format!("if ({} > 3) vector late = {};", self.number(1), self.vector(1)),
                _ => format!("assert |{}| < 100;", self.vector_name()),
            };
        }
        if self.local && self.random.chance(6) {
            return format!("if ({} > 2) return {};", self.number(1), self.vector(1));
        }
        let compound = depth > 0 && self.random.chance(35);
        match (compound, self.random.below(15)) {
            (false, 0..=2) => format!("{} = small({});", self.vector_name(), self.vector(3)),
            (false, 3) => format!("{} += {};", self.vector_name(), self.vector(1)),
            (false, 4) => {
                format!("{}.{} = tame({});", self.vector_name(), self.axis(), self.number(2))
            }
            (false, 5) => format!("{}.{} *= 0.5;", self.vector_name(), self.axis()),
            (false, 6 | 7) => format!("{} = small({});", self.element(), self.vector(2)),
            (false, 8) => format!("{}.{} = tame({});", self.element(), self.axis(), self.number(1)),
            (false, 9) => format!("{} -= {};", self.element(), self.vector_name()),
            (false, 10) => format!("{} = tame({});", self.number_name(), self.number(2)),
            (false, 11) => {
                let (curve, number) =
                    (*self.random.pick(&["c", "d"]), *self.random.pick(&["x", "y", "m"]));
                format!("shift({curve}, {}, {number});", self.vector(1))
            }
            (false, 12) => {
                let vector = self.vector_name();
                format!("bump({vector}, {});", self.random.pick(&["m", "x", "i"]))
            }
            (false, 13) => "smooth(a, g);".into(),
            (false, _) if self.loops > 0 && self.random.chance(30) => {
                format!("if ({} > 1) {};", self.number(1), self.random.pick(&["break", "continue"]))
            }
            (false, _) => format!("{}.z += {}.x;", self.vector_name(), self.vector_name()),
            (true, 0..=3) => {
                format!("if ({} > {}) {}", self.number(1), self.number(1), self.block(depth - 1))
            }
            (true, 4..=7) => {
                self.loops += 1;
                let body = self.block(depth - 1);
                self.loops -= 1;
                let name = *self.random.pick(&["t", "e", "x"]);
                match self.random.below(4) {
                    0 => format!("foreach (t in a) {body}"),
                    1 if self.random.chance(self.faults) => format!("foreach ({name} in c) {body}"),
                    1 => format!("foreach (e in c) {{ p = small(p + e); {body} }}"),
                    2 => format!("foreach (e in g) {{ q += e*0.125;\n{body} }}"),
                    _ => format!("foreach (t in {{1, 2, 3, 4}}) {body}"),
                }
            }
            (true, _) => {
                self.loops += 1;
                let body = self.block(depth - 1);
                self.loops -= 1;
                let name = if self.local { "k" } else { "i" };
                format!("for ({name} = 1:{}) {body}", 1 + self.random.below(4))
            }
        }
    }

    fn program(&mut self) -> String {
        let mut text = String::from(
            "param float s = 1.5;\nfloat x = 1, y = .5, t = 0; int i = 1, m = 3;\nvector p = {1, 2, s}, q = {0, 1, 0}, r;\n\
             curve c[4], d[3]; surface g[3,4]; farray a[5] = 0.5;\n\
             c[1] = {1, 0, 0}; c[2] = {0, 2, 0}; c[3] = {0, 0, 3}; d[1] = p; d[3] = q;\n\
             function float tame(float v) { while (|v| > 1e4) v /= 1024; return v; }\n\
             function vector small(vector v) { while (|v| > 1e4) v = v/1024; return v; }\n\
             function vector mid(vector v, vector w) { return (v + w)/2; }\n\
             function float dist(vector v, vector w) { return tame(|v - w|); }\n\
             function vector turned(vector v, float u) { vector w = {v.x*cos(u) - v.y*sin(u), v.x*sin(u) + v.y*cos(u), v.z}; return w; }\n\
             function vector walked(curve b, int n) { vector w; for (k = 1:n) w += b[mod(k, b.d1) + 1]; foreach (e in b) w += e*0.25; if (n > 3) b[1] = w; return small(w + b[1])/n; }\n\
             function vector nested(vector v, int n) { if (n < 1) return v; return mid(nested(v*0.5, n - 1), {n, v.x, 1}); }\n\
             subroutine shift(returned curve b, vector by, returned float count) { for (k = 1:b.d1) { b[k] = small(b[k] + by); count += 1; if (count > 40) { count = 0; return; } b[k].z = count; } }\n\
             subroutine bump(returned vector v, returned int n) { v.x += 1; n += 1; v = v*0.5; if (n > 30) n = 0.5; if (n > 40) n = 0; }\n\
             subroutine smooth(returned farray b, returned surface f) { for (k = 2:b.d1 - 1) b[k] = (b[k - 1] + b[k + 1])/2; b[1] += 0.25; for (k = 1:f.d1) for (j = 2:f.d2) f[k, j] = small(f[k, j - 1]*0.5 + {k, j, b[1]}); twice(b); }\n\
             subroutine twice(returned farray b) { foreach (e in b) x += e; b[b.d1] = tame(x); x = tame(x); }\n",
        );
        self.local = true;
        let body: Vec<String> = (0..3).map(|_| self.statement(2)).collect();
        text += &format!(
            "function vector own(vector v, float u) {{ vector w = v*2; int k = 2;\n{}\nreturn small(v + w); }}\n",
            body.join("\n")
        );
        self.local = false;
        for round in 0..2 + self.random.below(3) {
            self.loops += 1;
            let body = self.block(3);
            self.loops -= 1;
            let extra = match round {
                0 => "r = own(p, x);",
                1 => "q = nested(q, 3);",
                _ => "",
            };
            text += &format!(
                "for ({} = 1:{}) {{ {extra}\n{body} }}\n",
                self.random.pick(&["i", "x", "j"]),
                1 + self.random.below(5)
            );
        }
        // Straight from the file, where the interpreter calls the routine.
        text += "shift(c, p, y); smooth(a, g); bump(q, m); float sum = 0; foreach (e in c) sum += e.x + e . e;\n";
        text
    }
}

#[test]
fn code_for_vectors_does_what_the_interpreter_does() {
    let (mut faulty, mut sound) = (0, 0);
    for round in 0..moldloft_testing::rounds(80, 20_000) {
        let random = Random::new(round as u64 + 1);
        let mut programs = VectorPrograms { random, local: false, loops: 0, faults: 8 };
        programs.faults = if round % 3 == 0 { 0 } else { 12 };
        let text = programs.program();
        let most = if round % 5 == 4 { 40 + programs.random.below(3000) as u64 } else { 60_000 };
        let (_, count) = compare(&text, most, &format!("round {round}"));
        faulty += usize::from(count > 0);
        sound += usize::from(count == 0);
    }
    assert!(faulty > 8 && sound > 2, "{faulty} {sound}");
}

/// Programs with something of their own: each was written for a rule of the language.
const PROGRAMS: [&str; 9] = [
    // The second component fails: the vector stays as it was.
    "vector v = {1, 2, 3}; for (k = 1:3) { v = {v.y, v.x, v.z/(k - 2)}; v = v*{1, 1/(3 - k), 1}; }",
    "vector v = {1e200, 1, 1}, w = {1e200, 0, 0}; float s = 0; for (k = 1:2) { s = v . w; s = |v|; w = v .* w; v = v*1e300; }",
    // What a declaration that fails leaves.
    "float s = 0; curve c[3]; for (k = 1:4) { vector t = c[k]; s += t.x; curve e[k - 1]; e[1] = t; surface f[k, 2/k]; f[1, 1] = t; }",
    // References: to the same variable twice, to an element, to a parameter, to a variable of another call.
    "param float p = 2; float x = 1; vector v; curve c[2]; subroutine f(returned float a, returned float b) { a += 1; b += a; } subroutine g(returned vector a) { a.y += 1; float l = 3; f(l, x); a.x = l; } for (k = 1:3) { f(x, x); f(v.x, x); f(p, x); g(c[1]); g(v); f(1, x); g(x); }",
    "int n = 1; farray a[3]; curve c; subroutine f(returned float a, returned farray b, returned curve d) { a = a/2; n += 1; b[n] = a; n = b[1]; d[1] = {n, 0, 0}; } for (k = 1:4) f(n, a, c); c = {{1, 2, 3}, {4, 5, 6}}; for (k = 1:2) f(n, a, c); f(n, a, c);",
    // A recursion through a reference, and an endless one.
    "vector v; subroutine f(returned vector a, int n) { if (n < 1) return; a += {n, 1, 0}; f(a, n - 1); v.z += a.x; } for (k = 1:3) f(v, k); f(v, 5); subroutine e(returned vector a) { e(a); } for (k = 1:1) e(v);",
    // `foreach` walks through what there was when it began.
    "curve c[3]; farray a = {1, 2, 3, 4, 5}; float s = 0; foreach (e in a) { a[5] += e; a = {9, 9}; s += e; if (s > 6) break; } foreach (e in c) { c[2].x += 1; s += e.x; if (e.x > 0) continue; s += 1; } curve n; foreach (e in n) s += 1; foreach (e in s) s += 1; foreach (e in {1, 2, 3}) s += e;",
    // A glued dot may be a product.
    "vector v = {1, 2, 3}, x = {4, 5, 6}; float s = 0, t = 0; curve y[2]; for (k = 1:2) { s += v.x; t += v . x; s += v.y; s += v.z; }",
    // Corners of grids do not meet.
    "surface s[3,3]; for (k = 1:3) { s[k, 1] = {k, 0, 0}; s[1, k] = {1, k, 0}; s[3, k] = {3, k, 0}; s[k, 3].x = k; s[k, 3].y = 2; } surface t = tfi(s);",
];

#[test]
fn rules_of_vectors_hold_in_code() {
    for (k, text) in PROGRAMS.iter().enumerate() {
        for most in 1..60 {
            compare(text, most, &format!("program {k}, {most} steps"));
        }
        compare(text, 50_000, &format!("program {k}"));
        let named = format!(
            "{text}\nfor (k = 1:3) {{ vector w = {{k, 0, 0}}; if (w.x > 1) AbsPoint P(w.x, 0, 0); }}"
        );
        compare(&named, 50_000, &format!("program {k} with objects"));
    }
}

/// Derivatives of vectors are those of the interpreter, bit by bit.
#[test]
fn derivatives_of_vectors_go_through_code() {
    let text = "param float p = 1.25; curve c[5]; vector v = {p, 1, 0}; float s = 0;\n\
        function vector f(vector v, int n) { if (n < 1) return v*p; return f({v.y + sin(p*v.x), v.z, v.x}, n - 1)/2; }\n\
        subroutine g(returned curve c, returned float s) { for (i = 1:c.d1) { c[i] = f({i, p, i*p}, i) .* {p, 0, 1}; s += |c[i]| + c[i] . {1, p, 0}; } }\n\
        g(c, s); foreach (e in c) v += e*(e . v)/(1 + |e|);";
    let mut coded = opened(text);
    let mut plain = opened(text);
    plain.by_reference();
    let by = ["p".to_string()];
    for name in ["s", "v", "c"] {
        let [a, b] = [&mut coded, &mut plain].map(|d| d.derivatives(&[name.into()], &by).unwrap());
        assert_eq!(bits(&a[0][0]), bits(&b[0][0]), "{name}");
        assert!(bits(&a[0][0]).iter().any(|bits| *bits != 0), "{name}");
    }
}

/// Routines of the libraries that loop over numbers and vectors, called rightly and wrongly: an error in a library
/// leaves it and is told at the caller's place.
const LIBRARIES: [&str; 8] = [
    "load \"naca.sdl\" curve c[41]; naca4s(c, 0, 0, 12); for (k = 1:3) { curve d[21]; naca4s(d, 2, .4, 10 + k); c[k] = d[3]; }",
    "load \"naca.sdl\" curve c[41]; naca5(c, 230, 12); naca5(c, 999, 12); naca4(c, 2, 4, 500); float x = 1;",
    "load \"naca.sdl\" curve c[31]; naca6(c, \"64A\", .2, .8, 10); naca6(c, \"6?\", .2, .8, 10); naca16(c, 0, 9); print c[3];",
    "load \"stdsubs.sdl\" curve c[9]; c[1] = {0, 0, 0}; c[9] = {1, 2, 3}; line(c); curve d[4]; line(d); dline(c, {0, 1}); arc(d, 0, PI, 3); for (k = 1:3) { line(d); arc(d, 0, k, 1); }",
    "load \"stdsubs.sdl\" surface s[5,4]; arc(s[1,], 0, PI_d2, 1); arc(s[5,], 0, PI_d2, 2); line(s[,1]); line(s[,4]); transfinite(s); transfinite(s[1:2,1:3]); surface e[3,3]; transfinite(e); float last = 1;",
    "load \"mslbody.sdl\" surface body[90,25]; set_ntips(body, 10, \"hemisphere\"); mk_missile_body(body); print body.d1;",
    "load \"mslbody.sdl\" mk_missile_body(3); for (k = 1:2) set_fin(k, 0, -1); surface b[4,4]; mk_missile_body(b); print 1;",
    "load \"stdsubs.sdl\" load \"naca.sdl\" curve w[21]; for (k = 1:4) { naca4s(w, k, .4, 12/(3 - k)); curdist(w, uniform(0, 1, 21)); } float y = w[5].y;",
];

#[test]
fn code_of_libraries_does_what_the_interpreter_does() {
    for (k, text) in LIBRARIES.iter().enumerate() {
        for most in [5, 17, 60, 211, 1_000, 4_000] {
            compare(text, most, &format!("library {k}, {most} steps"));
        }
        compare(text, 1_000_000, &format!("library {k}"));
    }
}
