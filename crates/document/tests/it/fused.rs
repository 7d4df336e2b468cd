//! Element-wise statements in one pass, in code and outside of it, against operators applied one after the
//! other to whole arrays: the same bits and the same messages, for plain and dual numbers.

use crate::common::{Random, reported, rounds};
use moldloft_document::{Document, NoFiles, registry};
use moldloft_registry::Value;

/// A random expression of numbers, vectors and arrays, most of which fit.
fn expression(random: &mut Random, depth: usize, wanted: &str) -> String {
    let other = |random: &mut Random| {
        let all = ["float", "vector", "farray", "curve", "surface"];
        random.pick(&all).to_string()
    };
    if random.chance(3) {
        // What does not fit is a fault, the same on both sides.
        let wanted = other(random);
        return expression(random, depth, &wanted);
    }
    let leaf = depth == 0 || random.chance(25);
    let e = |random: &mut Random, wanted: &str| expression(random, depth.max(1) - 1, wanted);
    match (wanted, leaf) {
        ("float", true) => {
            let all = ["x", "y", "2", "0.5", "3", "v.x", "f[2]", "c[1].y", "p.z", "-1", "PI"];
            random.pick(&all).to_string()
        }
        ("vector", true) => {
            let all = ["v", "w", "{1, 2, 3}", "c[3]", "s[2,1]", "A", "c[c.d1]"];
            random.pick(&all).to_string()
        }
        ("farray", true) => {
            let all = ["f", "g", "c.x", "d.z", "s[1,].y", "f[::-1]", "uniform(0, 1, N)", "g[:]"];
            random.pick(&all).to_string()
        }
        ("curve", true) => {
            let all = ["c", "d", "s[2,]", "c[::-1]", "{f, g, f}", "distc(l, uniform(0, 1, N))"];
            random.pick(&all).to_string()
        }
        ("surface", true) => random.pick(&["s", "t"]).to_string(),
        ("float", false) => match random.below(9) {
            0 => format!("({} + {})", e(random, "float"), e(random, "float")),
            1 => format!("{} * {}", e(random, "float"), e(random, "float")),
            2 => format!("({}) / 3", e(random, "float")),
            3 => format!("({})^{}", e(random, "float"), random.below(5)),
            4 => format!("({} . {})", e(random, "vector"), e(random, "vector")),
            5 => format!("|{}|", e(random, "vector")),
            6 => format!("sin({})", e(random, "float")),
            7 => format!("sum({})", e(random, "farray")),
            _ => format!("-({})", e(random, "float")),
        },
        ("vector", false) => match random.below(6) {
            0 => format!("({} + {})", e(random, "vector"), e(random, "vector")),
            1 => format!("({} .* {})", e(random, "vector"), e(random, "vector")),
            2 => format!("({}) * ({})", e(random, "vector"), e(random, "float")),
            3 => format!("({}) / ({})", e(random, "vector"), e(random, "float")),
            4 => format!("-({})", e(random, "vector")),
            _ => format!("({}) * ({})", e(random, "vector"), e(random, "vector")),
        },
        ("farray", false) => match random.below(14) {
            0 => format!("({} + {})", e(random, "farray"), e(random, "farray")),
            1 => format!("({} - {})", e(random, "farray"), e(random, "float")),
            2 => format!("({}) * ({})", e(random, "float"), e(random, "farray")),
            3 => format!("({}) / ({})", e(random, "farray"), e(random, "farray")),
            4 => format!("({})^{}", e(random, "farray"), random.below(7)),
            5 => format!("({} . {})", e(random, "curve"), e(random, "curve")),
            6 => format!("({} . {})", e(random, "vector"), e(random, "curve")),
            7 => format!("|{}|", e(random, "curve")),
            8 => format!(
                "{}({})",
                random.pick(&["sin", "cos", "exp", "abs", "tanh", "sqrt", "log", "floor"]),
                e(random, "farray")
            ),
            9 => format!("atan2({}, {})", e(random, "farray"), e(random, "farray")),
            10 => format!("({}).{}", e(random, "curve"), random.pick(&["x", "y", "z"])),
            11 => format!("-({})", e(random, "farray")),
            12 => format!("|{}|", e(random, "farray")),
            _ => format!("({})^({})", e(random, "farray"), e(random, "float")),
        },
        ("curve", false) => match random.below(9) {
            0 => format!("({} + {})", e(random, "curve"), e(random, "curve")),
            1 => format!("({} - {})", e(random, "curve"), e(random, "vector")),
            2 => format!("({}) * ({})", e(random, "farray"), e(random, "vector")),
            3 => format!("({}) * ({})", e(random, "curve"), e(random, "curve")),
            4 => format!("({} .* {})", e(random, "curve"), e(random, "vector")),
            5 => format!("({}) / ({})", e(random, "curve"), e(random, "farray")),
            6 => format!(
                "{{{}, {}, {}}}",
                e(random, "farray"),
                e(random, "farray"),
                e(random, "farray")
            ),
            7 => format!("({} .* {})", e(random, "curve"), e(random, "curve")),
            _ => format!("-({})", e(random, "curve")),
        },
        _ => match random.below(5) {
            0 => format!("({} + {})", e(random, "surface"), e(random, "surface")),
            1 => format!("({}) * ({})", e(random, "surface"), e(random, "vector")),
            2 => format!("({}) * ({}).x", e(random, "surface"), e(random, "surface")),
            3 => format!(
                "({} . {}) * ({})",
                e(random, "surface"),
                e(random, "vector"),
                e(random, "surface")
            ),
            _ => format!("({}) / ({})", e(random, "surface"), e(random, "float")),
        },
    }
}

const HEAD: &str = "load \"stdsubs.sdl\"\nparam float p0 = 1.25;\nfloat x = p0, y = -0.5;\nvector v = {1, p0, 3}, w = {-2, 0, 1};\n\
    vector p = {0, 1, x};\nAbsPoint A(1, 2, p0);\nAbsPoint B(2, 0, 1);\nLine l(A, B);\nfarray f = p0*uniform(0, 1, N), g = cosine(-1, 2, N);\n\
    curve c = {f, g, f*g}, d = {g, f + 1, g^2};\nsurface s[2, N], t[2, N];\ns[1,] = c; s[2,] = d; t[1,] = d + v; t[2,] = c*2;\n";

/// The bits of all numbers; those of what is not a number say nothing.
fn bits(value: &Value<f64>) -> Vec<u64> {
    let of = |x: &f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
    match value {
        Value::Number(x) => vec![of(x)],
        Value::Vector(v) => v.to_array().iter().map(of).collect(),
        Value::Numbers(a) => a.items.iter().map(of).collect(),
        Value::Vectors(a) => a.planes.iter().flatten().map(of).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn one_pass_changes_no_bit_and_no_message() {
    let mut random = Random::new(4);
    let mut compared = 0;
    for round in 0..rounds(5_000) {
        let n = *random.pick(&[3, 5, 64, 511, 1025]);
        let mut text = HEAD.replace('N', &n.to_string());
        for k in 0..5 {
            let kind = *random.pick(&["farray", "curve", "surface", "farray", "curve"]);
            let e = expression(&mut random, 4, kind).replace('N', &n.to_string());
            let target = match kind {
                "farray" => random.pick(&["", "f", "c.x", "s[1,].z"]),
                "curve" => random.pick(&["", "c", "s[2,]", "d[::-1]"]),
                _ => random.pick(&["", "s", "t[::-1,]", "s[:,:]"]),
            };
            text += &match target {
                &"" => format!("{kind} r{k} = {e};\n"),
                target if random.chance(30) => format!("{target} += {e};\n"),
                target => format!("{target} = {e};\n"),
            };
        }
        let mut fused = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
        let mut plain = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
        plain.by_reference();
        assert_eq!(reported(&fused), reported(&plain), "round {round}\n{text}");
        for name in ["f", "c", "d", "s", "t", "r0", "r1", "r2", "r3", "r4"] {
            match (fused.eval(name), plain.eval(name)) {
                (Ok(a), Ok(b)) => {
                    assert_eq!(bits(&a), bits(&b), "round {round}: {name}\n{text}");
                    compared += 1;
                }
                (Err(_), Err(_)) => {}
                (a, b) => panic!("round {round}: {name} {a:?} {b:?}\n{text}"),
            }
        }
        if fused.has_errors() {
            continue;
        }
        let by = ["p0".to_string()];
        for name in ["c", "s"] {
            let (Ok(a), Ok(b)) =
                (fused.derivatives(&[name.into()], &by), plain.derivatives(&[name.into()], &by))
            else {
                continue;
            };
            assert_eq!(bits(&a[0][0]), bits(&b[0][0]), "round {round}: d{name}\n{text}");
        }
    }
    assert!(compared > 200, "{compared}");
}

/// Statements on whole arrays in loops and routines are passes of their code: they do what the interpreter does, in as
/// many steps.
#[test]
fn statements_on_arrays_do_the_same_in_code() {
    let mut random = Random::new(17);
    let mut sound = 0;
    for round in 0..rounds(2_000) {
        let n = *random.pick(&[3, 5, 64, 70]);
        let mut body = String::new();
        for k in 0..2 {
            let kind = *random.pick(&["farray", "curve", "surface", "farray", "curve", "float"]);
            let depth = 1 + random.below(2);
            let e = expression(&mut random, depth, kind);
            let all: &[&str] = match kind {
                "farray" => &["f", "f", "c.x", "s[1,].z", "g[2:]", "", "c[::-1].y", "s[:,k].x"],
                "curve" => &["c", "c", "s[2,]", "d[::-1]", "", "s[,k]", "c[k:k+1]", "u"],
                "surface" => &["s", "t", "t[::-1,]", "s[:,:]", "", "s[1:k,]"],
                _ => &["f", "x", "c.z", "f[k:]", "g[1:3:k]", "y", "s.x", "t[k,].y"],
            };
            let target = *random.pick(all);
            body += &match target {
                "" => format!("{kind} r{k} = {e};\n"),
                target if random.chance(30) => format!("{target} *= 0.5;\n{target} += {e};\n"),
                target => format!("{target} = {e};\n"),
            };
            if random.chance(20) {
                let more = ["if (k == 2) d = c;\n", "c = d;\n", "g = f;\n", "y += f[k];\n"];
                body += *random.pick(&more);
            }
        }
        let text = match random.below(3) {
            0 => format!("curve u;\nfor (k = 1:2) {{\n{body}}}\n"),
            1 => format!(
                "subroutine work(returned curve c, farray f, int k) {{ curve u; farray g = f*2;\n{body}}}\n\
                 work(c, g, 1); work(d, f, 2); for (k = 1:2) work(c, f, k);\n"
            ),
            _ => format!(
                "curve u = c; function float work(int k) {{\n{body}return f[k]; }}\nfor (k = 1:2) y += work(k);\n"
            ),
        };
        let text = (HEAD.to_string() + &text).replace('N', &n.to_string());
        let what = format!("round {round}");
        let (_, faults) = crate::scalar_code::alike(&text, 90_000, &what);
        if faults == 0 {
            sound += 1;
            // Also when the steps do not suffice.
            for most in [90_000, 300 + random.below(900) as u64] {
                crate::scalar_code::compare(&text, most, &what);
            }
        }
    }
    assert!(sound > 9, "{sound}");
}

/// Sources and targets that overlap: the whole right side is known before anything is stored.
#[test]
fn targets_may_overlap_their_sources() {
    let text = "farray a = round(uniform(1, 2000, 2000)); farray b = a;\n\
                a[2:] = a[1:a.d1-1] + a[2:];\n\
                b[1:b.d1-1] = b[2:]*1;\n\
                curve c = {uniform(1, 9, 9), uniform(2, 10, 9), uniform(0, 0, 9)};\n\
                c = c[1] + .5*(c - c[c.d1]);\nc[::-1] = c;\nc.x = c.y + c.x;\n\
                surface s[3,3]; s[1,] = c[1:3]; s[2,] = c[4:6]; s[3,] = c[7:9]; s[,1] = s[1,]; s = s + s[3,3];\n\
                float q = 0; for (i = 1:9) { c = c*1; c += c[i]; q += c[9].x; }";
    let mut fused = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
    assert!(!fused.has_errors(), "{:?}", reported(&fused));
    let mut plain = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
    plain.by_reference();
    for name in ["a", "b", "c", "s", "q"] {
        assert_eq!(bits(&fused.eval(name).unwrap()), bits(&plain.eval(name).unwrap()), "{name}");
    }
    let Ok(Value::Numbers(a)) = fused.eval("a") else { panic!() };
    assert!((1..2000).all(|k| a.items[k] == (k + k + 1) as f64) && a.items[0] == 1.0);
    let Ok(Value::Numbers(b)) = fused.eval("b") else { panic!() };
    assert!((0..1999).all(|k| b.items[k] == (k + 2) as f64) && b.items[1999] == 2000.0);
}

/// Rows of every length around the widths of the machine's chunks.
#[test]
fn rows_of_all_lengths_are_done_to_the_last_element() {
    for n in (1..150).chain([255, 256, 257, 1000]) {
        let text = format!(
            "farray u = cosine(0.1, 1, {n} + 1)[2:]; vector p = {{1, 2, 3}}, q = {{-1, 0.5, 2}};\n\
             curve c, d; farray a;\nfor (k = 1:4) {{\n\
             c = p*(1 - u)^3 + 3*q*u*(1 - u)^2 - p*u^2/(p*u - (q - u*p)*3);\n\
             a = |c| - (c . p)/(1 + u)*u^-2 - (u*2 - (3 - u)*(u + 1)*(u - 4));\n\
             d = (c .* q)*sin(a) + {{a, -a, abs(a)}};\n}}"
        );
        let mut fused = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
        assert!(!fused.has_errors(), "{n}: {:?}", reported(&fused));
        let mut plain = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
        plain.by_reference();
        for name in ["a", "c", "d"] {
            let (a, b) = (fused.eval(name).unwrap(), plain.eval(name).unwrap());
            assert_eq!(bits(&a), bits(&b), "{n}: {name}");
        }
    }
}

/// A variable whose array nothing else holds is filled where it is; copies of it keep their values, and
/// so does the variable when the statement fails.
#[test]
fn arrays_filled_in_place_are_no_others() {
    let text = "farray u = uniform(0, 1, 70), e = u; curve c[70], d, b; float x = 1;\n\
                subroutine f(returned curve k, float y) { k = {y, 2, 3}*u; }\n\
                for (k = 1:9) {\n\
                c = {1, 2, 3}*u*k; if (k == 4) d = c; if (k == 5) b = c*1;\n\
                f(c, k); u = e*1;\n\
                }\n\
                for (k = 1:5) { e = sqrt(u*(4 - k)); }";
    let mut fused = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
    let mut plain = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
    plain.by_reference();
    assert_eq!(reported(&fused), reported(&plain));
    for name in ["b", "c", "d", "e", "u"] {
        let (a, b) = (fused.eval(name).unwrap(), plain.eval(name).unwrap());
        assert_eq!(bits(&a), bits(&b), "{name}");
    }
    assert_eq!(crate::common::number(&mut fused, "d[70].x"), 4.0);
    assert_eq!(crate::common::number(&mut fused, "b[70].y"), 10.0);
    assert_eq!(crate::common::number(&mut fused, "c[70].x"), 9.0);
}

#[test]
fn long_chains_go_in_parts() {
    let sum = vec!["a"; 990].join(" + ");
    let mixed: String = (0..490).map(|k| format!(" + {k}.5*a")).collect();
    let cross = vec!["c"; 90].join(" .* d .* ");
    let text = format!(
        "farray a = uniform(0, 1, 7); curve c = {{a, a^2, 1 - a}}, d = {{1 - a, 2*a, a}};\n\
         farray b = {sum}; farray e = a{mixed}; curve f = ({cross}) + ({cross})*2;\n\
         curve g = ({cross} .* {{1, 2, 3}}) + ({cross} .* {{a, a, a}}) + ({cross} .* d)*a + ({cross}) * 7 + ({cross} .* {{0, 0, 1}});"
    );
    let mut fused = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
    assert!(!fused.has_errors(), "{:?}", reported(&fused));
    let mut plain = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text);
    plain.by_reference();
    for name in ["b", "e", "f", "g"] {
        assert_eq!(bits(&fused.eval(name).unwrap()), bits(&plain.eval(name).unwrap()));
    }
}

#[test]
fn limits_end_a_run_with_a_clear_error() {
    let id = |text: &str| {
        let document = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
        let all = document.diagnostics();
        all.first().map(|d| d.id.to_string()).unwrap_or_default()
    };
    assert_eq!(id("surface s[1e6, 1e6];"), "too-many-elements");
    let endless = "function float f(float x) { return f(x + 1); } float y = f(0);";
    assert_eq!(id(endless), "nested-too-deep");
    let endless = "subroutine f(returned float x) { x += 1; f(x); } float y = 0; f(y);";
    assert_eq!(id(endless), "nested-too-deep");
    assert_eq!(id("farray a[1e6]; while (1) { a = a*2; a /= 3; }"), "too-many-steps");
    let prints = "string s = format(\"%900d\", 1); while (1) { print s, s, s, s, s, s; }";
    assert_eq!(id(prints), "too-much-output");
}

#[test]
fn expressions_from_outside_change_nothing() {
    let text = "load \"stdsubs.sdl\"\ncurve c[3]; float n = 1; subroutine bump() { n += 1; }\n\
                function float f(float x) { float y = x; y += 1; return y; }\n\
                function float g() { n = 5; return n; }";
    let mut m = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
    for outside in ["g()", "arc(c, 0, 1, 2)", "bump()", "open(\"a\", \"w\")"] {
        let faults = m.eval(outside).unwrap_err();
        assert_eq!(faults[0].id, "misplaced-assignment", "{outside}: {faults:?}");
    }
    assert_eq!(crate::common::number(&mut m, "f(2)"), 3.0);
    assert_eq!(crate::common::number(&mut m, "n"), 1.0);
    assert_eq!(m.written().count(), 0);
}

/// What a statement costs, for `cargo test --test fused -- --ignored --nocapture speed`.
#[test]
#[ignore = "measures"]
fn speed_of_the_bezier_statement() {
    let statement = "c = p0*(1 - u)^3 + 3*p1*u*(1 - u)^2 + 3*p2*u^2*(1 - u) + p3*u^3;";
    for n in [60, 1_000, 10_000, 100_000, 1_000_000] {
        // So many that the first executions, into fresh memory, count little.
        let repeats = (8_000_000 / n).clamp(40, 20_000);
        let text = |body: &str| {
            format!(
                "vector p0 = {{0, 0, 0}}, p1 = {{1, 2, 0}}, p2 = {{3, 2, 1}}, p3 = {{4, 0, 1}};\n\
                 farray u = uniform(0, 1, {n}); curve c[{n}];\nfor (k = 1:{repeats}) {{ {body} }}"
            )
        };
        let least = |body: &str| {
            let mut m = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", &text(body));
            assert!(!m.has_errors(), "{:?}", reported(&m));
            let mut least = f64::INFINITY;
            for _ in 0..24 {
                let start = std::time::Instant::now();
                m.run();
                least = least.min(start.elapsed().as_secs_f64());
            }
            least
        };
        let one = (least(statement) - least(";")) / f64::from(repeats);
        println!("{n:8} points: {:8.2} us, {:7.2} ns/point", one * 1e6, one * 1e9 / f64::from(n));
    }
    for (name, text) in [
        ("figure 1", include_str!("fixtures/figure1.sdl")),
        ("figures 1 and 3", include_str!("fixtures/figure1and3.sdl")),
        ("figure 5", include_str!("fixtures/figure5.sdl")),
    ] {
        let mut m = Document::from_text(registry(), Box::new(NoFiles), "a.sdl", text);
        let mut least = f64::INFINITY;
        for _ in 0..20 {
            let start = std::time::Instant::now();
            m.run();
            least = least.min(start.elapsed().as_secs_f64());
        }
        println!("{name}: {:.3} ms", least * 1e3);
    }
}
