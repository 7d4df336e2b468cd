//! Random programs of the array language, built from its grammar, and damaged copies of real ones: none
//! panics, hangs or takes time out of proportion, and one pass says what operators one after the other
//! say.
//!
//! `MOLDLOFT_FUZZ_SECONDS` runs each test so long instead of the usual number of rounds.

use crate::common::{Random, ids, open, reported, rounds};
use moldloft_document::{Document, NoFiles, registry};
use moldloft_registry::Value;
use moldloft_testing::soak;
use std::time::{Duration, Instant};

/// The most processor time that a program of a few lines may take: an endless loop ends after so many
/// steps, which is the longest of all. Looked at in long runs alone, as other tests of this program count, too.
const LONGEST: Duration = Duration::from_secs(30);

/// What took longer than this is reported, so that it can be looked at.
const LONG: Duration = Duration::from_secs(2);

/// The processor time of this program so far, where the system tells it, else the time of the clock:
/// other work on the machine does not count.
fn now(start: Instant) -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").ok();
    let ticks = stat.and_then(|text| {
        // The fields after the name of the program, which is in brackets: user and system time are
        // the twelfth and thirteenth, in hundredths of a second.
        let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
        Some(fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?)
    });
    ticks.map_or_else(|| start.elapsed(), |ticks| Duration::from_millis(10 * ticks))
}

/// Rounds, or seconds when the environment asks for them.
fn go_on(round: usize, long: usize, start: Instant) -> bool {
    let seconds = std::env::var("MOLDLOFT_FUZZ_SECONDS").ok().and_then(|s| s.parse::<u64>().ok());
    match seconds {
        Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
        None => round < rounds(long),
    }
}

/// Another seed in each long run, printed so that a failure can be made again.
fn seed(plain: u64) -> u64 {
    let given = std::env::var("MOLDLOFT_FUZZ_SEED").ok().and_then(|s| s.parse().ok());
    let seed = given.unwrap_or(plain);
    println!("seed {seed}");
    seed
}

const NUMBERS: [&str; 24] = [
    "0", "1", "2", "3", "5", "-1", ".5", "1e-3", "1e9", "1e300", "-0.0", "i", "n", "x", "PI",
    "x^2", "7/2", "a[2]", "v.x", "c[1].y", "c.d1", "s.d2", "sum(a)", "|v|",
];

fn e(r: &mut Random, depth: usize, kind: &str) -> String {
    if r.chance(2) {
        let other = *r.pick(&["float", "vector", "farray", "curve", "surface", "pcurve"]);
        return e(r, depth, other);
    }
    let down = depth.max(1) - 1;
    if depth == 0 || r.chance(30) {
        let all: &[&str] = match kind {
            "float" => &NUMBERS,
            "vector" => &["v", "w", "{1, 2, 3}", "c[2]", "s[1,2]", "c[c.d1]", "{x, i, n}"],
            "farray" => &[
                "a",
                "b",
                "c.x",
                "s[1,].z",
                "a[::-1]",
                "uniform(0, 1, n)",
                "a[2:4]",
                "{1, 2, 3, 4, 5}",
            ],
            "curve" => &["c", "d", "s[2,]", "c[::-1]", "s[,1]", "d[1:3]", "{a, b, a}"],
            "surface" => &["s", "t", "swap(s)", "s[1:2,]", "s[,::-1]"],
            _ => &["p", "makecc(c)", "makelc(d)"],
        };
        return r.pick(all).to_string();
    }
    let mut x = |kind: &str| e(r, down, kind);
    let (f, g, v, w) = (x("float"), x("float"), x("vector"), x("vector"));
    let (a, b, c, d) = (x("farray"), x("farray"), x("curve"), x("curve"));
    let (s, t) = (x("surface"), x("surface"));
    let n = r.pick(&["2", "3", "5", "n", "i + 1", "0", "-4", "1.5", "60"]).to_string();
    let options = match kind {
        "float" => vec![
            format!("({f} + {g})"),
            format!("{f}*{g}"),
            format!("({f})/({g})"),
            format!("({f})^({g})"),
            format!("({v} . {w})"),
            format!("|{v}|"),
            format!("min({a})"),
            format!("argmax({a})"),
            format!("len({c})"),
            format!("f({f})"),
            format!("mod({f}, {g})"),
            format!("({f} < {g})"),
            format!("sin({f})"),
            format!("({c})[{n}].z"),
            format!("prod({a})"),
            format!("lengthc(p)"),
            format!("closest({v}, p)"),
            format!("norm({v})"),
            format!("dot({v}, {w})"),
        ],
        "vector" => vec![
            format!("({v} + {w})"),
            format!("({v} .* {w})"),
            format!("({v})*({f})"),
            format!("({v})/({g})"),
            format!("-({v})"),
            format!("centroid({c})"),
            format!("({c})[{n}]"),
            format!("({s})[{n},1]"),
            format!("rotate({v}, {w}, {f})"),
            format!("p({f})"),
            format!("bbox_max({c})"),
        ],
        "farray" => vec![
            format!("({a} + {b})"),
            format!("({a})*({b})"),
            format!("({a})^{n}"),
            format!("({c}) . ({d})"),
            format!("|{c}|"),
            format!("exp({a})"),
            format!("sqrt({a})"),
            format!("({c}).y"),
            format!("d_tanh({f}, {g}, .1, .2, {n})"),
            format!("d_tanhx({f}, {g}, .1, .2, {n})"),
            format!("geometric({f}, {g}, .1, {n})"),
            format!("cosine({f}, {g}, {n})"),
            format!("cumlen({c})"),
            format!("redist({a}, {n})"),
            format!("list({f}, {g}, {f})"),
            format!("join({a}, {b})"),
            format!("curvature({c})"),
            format!("({a})[1:{n}]"),
            format!("d_sinh(0, 1, {f}, {g}, {n})"),
            format!("reverse({a})"),
            format!("atan2({a}, {b})"),
            format!("geometric2(0, 1, {f}, {g}, {n})"),
        ],
        "curve" => vec![
            format!("({c} + {d})"),
            format!("({c} - {v})"),
            format!("({a})*({v})"),
            format!("({c} .* {d})"),
            format!("{{{a}, {b}, {a}}}"),
            format!("({s})[{n},]"),
            format!("reverse({c})"),
            format!("distc(p, {a})"),
            format!("distc(makecc({c}, \"quadratic\", \"arc\"), uniform(0, 1, {n}))"),
            format!("join({c}, {d})"),
            format!("rotate({c}, {v}, {f})"),
            format!("translate({c}, {v})"),
            format!("mirror({c}, {v}, {w})"),
            format!("points({v}, {w}, {v})"),
            format!("({c})[{n}:1:-1]"),
            format!("redist({c}, {n})"),
            format!("scale({c}, {w})"),
            format!("project({c}, {s}, \"closest\")"),
        ],
        "surface" => vec![
            format!("({s} + {t})"),
            format!("({s})*({v})"),
            format!("tfi({s}, \"arc\")"),
            format!("elliptic({s}, 3)"),
            format!("revolve({c}, 0, {f}, {n})"),
            format!("stack({c}, {d})"),
            format!("spread_i({c}, {n})"),
            format!("spread_j({c}, {n})"),
            format!("({s})[1:{n},]"),
            format!("normals({s})"),
            format!("swap({s})"),
            format!("dists(makecs({s}), {a}, {b})"),
            format!("({s})/({f})"),
            format!("tfi({s}, \"hermite\")"),
        ],
        _ => vec![
            format!("makecc({c}, \"natural\", \"index\")"),
            format!("makelc({c}, \"arc\")"),
            format!("makecc({c}, \"periodic\", \"arc\")"),
            format!("makecc({c}, \"quadratic\", \"arclen+breaks\")"),
        ],
    };
    r.pick(&options).clone()
}

fn statement(r: &mut Random, depth: usize) -> String {
    let kinds = ["float", "vector", "farray", "curve", "surface"];
    let kind = *r.pick(&kinds);
    let value = e(r, 2, kind);
    let target = *r.pick(match kind {
        "float" => &["x", "a[2]", "c[1].z", "v.y", "n", "a"],
        "vector" => &["v", "w", "c[3]", "s[1,2]", "c"],
        "farray" => &["a", "b", "c.x", "s[2,].y", "a[::-1]", "b[2:4]"],
        "curve" => &["c", "d", "s[1,]", "s[,2]", "c[1:3]", "d[::-1]"],
        _ => &["s", "t", "s[:,:]", "t[::-1,]", "s[1:2,1:3]"],
    });
    let op = *r.pick(&["=", "=", "=", "+=", "-=", "*=", "/="]);
    let body = |r: &mut Random| match depth {
        0 => "x += 1;".to_string(),
        _ => format!("{{ {} {} }}", statement(r, depth - 1), statement(r, depth - 1)),
    };
    match r.below(22) {
        0 => {
            format!("for (i = 1:{}) {}", r.pick(&["3", "n", "c.d1", "5:1:-2", "0:1:.25"]), body(r))
        }
        1 => {
            format!("if ({} > {}) {} else {}", e(r, 1, "float"), e(r, 1, "float"), body(r), body(r))
        }
        2 => format!("while (x < 3) {{ x += 1; {} }}", statement(r, 0)),
        3 => format!("foreach (k in {}) {{ x = x + 1; {} }}", e(r, 1, "curve"), statement(r, 0)),
        4 => format!("{kind} q{} = {value};", r.below(9)),
        5 => format!(
            "{kind} q{}[{}] = {value};",
            r.below(9),
            r.pick(&["3", "n", "5,2", "5", "1e7", "0"])
        ),
        6 => format!("print {value};"),
        7 => format!("fill({target}, {value});"),
        8 => format!("many({target}, c, d);"),
        9 => format!("line({target});"),
        10 => format!("dline({target}, {});", e(r, 1, "farray")),
        11 => format!("curdist({target}, {});", e(r, 1, "farray")),
        12 => format!("transfinite({target});"),
        13 => format!("naca4({target}, 0, 0, {});", e(r, 0, "float")),
        14 => format!("assert {} == {}, \"told\";", e(r, 1, "float"), e(r, 1, "float")),
        15 => format!("write(7, {value});"),
        16 => format!("for (i = 1:{}) {{ {target} {op} {value}; }}", r.pick(&["3", "9", "40"])),
        _ => format!("{target} {op} {value};"),
    }
}

const HEAD: &str = "load \"stdsubs.sdl\"\nload \"naca.sdl\"\nparam float p0 = 1.25;\nint i = 2, n = 5; float x = p0;\n\
    vector v = {1, p0, 3}, w = {-2, 0, 1};\nfarray a[5] = uniform(0, 1, 5), b = {5, 4, 3, 2, 1};\n\
    curve c[5], d; c = {a, b, a*b}; d = c*p0 + v;\nsurface s[5,5], t;\n\
    for (j = 1:5) s[j,] = c + j*w;\nt = s*{1, 2, 1};\npcurve p = makecc(c, \"quadratic\", \"arc\");\n\
    open(7, \"out.txt\");\n\
    function float f(float y) { if (y > 3) return y; return f(y + 1); }\n\
    subroutine fill(returned curve k, curve m) { k = m; }\n\
    subroutine many(returned curve k, curve m...) { foreach (z in m) k += z; }\n";

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
fn programs_of_the_grammar() {
    let mut r = Random::new(seed(29));
    let (start, mut round, mut slowest, mut sound) = (Instant::now(), 0, Duration::ZERO, 0);
    while go_on(round, 20_000, start) {
        let mut text = HEAD.to_string();
        for _ in 0..2 + r.below(8) {
            text += &statement(&mut r, 2);
            text.push('\n');
        }
        if r.chance(10) {
            // Round and round, so that recipes are made, used and given up.
            let inside: String = (0..4).map(|_| statement(&mut r, 0) + " ").collect();
            text += &format!("for (m = 1:6) {{ {inside} }}\n");
        }
        let begun = now(start);
        let mut fused = open(&text);
        let took = now(start) - begun;
        assert!(!soak() || took < LONGEST, "round {round}: {took:?}\n{text}");
        if took > LONG {
            println!("round {round} took {took:?}:\n{text}\n");
        }
        slowest = slowest.max(took);
        assert!(!ids(&fused).iter().any(|id| id == "internal-error"), "round {round}\n{text}");
        sound += usize::from(!fused.has_errors());
        if r.chance(25) {
            let mut plain = Document::from_text(registry(), Box::new(NoFiles), "model.sdl", &text);
            plain.by_reference();
            assert_eq!(reported(&fused), reported(&plain), "round {round}\n{text}");
            assert_eq!(fused.printed(), plain.printed(), "round {round}\n{text}");
            for name in ["x", "v", "w", "a", "b", "c", "d", "s", "t"] {
                if let (Ok(p), Ok(q)) = (fused.eval(name), plain.eval(name)) {
                    assert_eq!(bits(&p), bits(&q), "round {round}: {name}\n{text}");
                }
            }
        }
        round += 1;
    }
    println!("{round} programs, {sound} without errors, slowest {slowest:?}");
    assert!(sound * 200 > round, "{sound} of {round}");
}

/// The programs of 1992, the examples and the libraries.
const REAL: [&str; 6] = [
    include_str!("fixtures/figure1and3.sdl"),
    include_str!("fixtures/figure5.sdl"),
    include_str!("../../../../examples/missile/half.sdl"),
    include_str!("../../../lang/sdl/stdsubs.sdl"),
    include_str!("../../../lang/sdl/mslbody.sdl"),
    include_str!("../../../lang/sdl/naca.sdl"),
];

fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() || c == '_' {
            word.push(c);
        } else {
            words.push(std::mem::take(&mut word));
            words.push(c.to_string());
        }
    }
    words.push(word);
    words.retain(|w| !w.is_empty());
    words
}

#[test]
fn damaged_programs() {
    let mut r = Random::new(seed(31));
    let real: Vec<Vec<String>> = REAL.iter().map(|text| words(text)).collect();
    let extra = [
        "1e9",
        "-1",
        "0",
        "1/0",
        "\"\"",
        "{",
        "}",
        "(",
        ")",
        ";",
        "[",
        "]",
        ".x",
        ".*",
        "|",
        "for",
        "while (1)",
        "returned",
        "...",
        "#",
        "\"",
        "load \"mslbody.sdl\"",
        "1e7",
        "45",
        "é",
        "\u{0}",
        "^",
        "return",
        "subroutine",
        "if (1)",
        ":",
        ",",
        "curve",
        "surface s[9,9];",
        "mk_missile_body(b);",
        "transfinite(s);",
    ];
    let (start, mut round, mut slowest) = (Instant::now(), 0, Duration::ZERO);
    while go_on(round, 10_000, start) {
        let mut all = r.pick(&real).clone();
        for _ in 0..1 + r.below(8) {
            let (at, other) = (r.below(all.len()), r.below(all.len()));
            match r.below(7) {
                0 => drop(all.remove(at)),
                1 => all.swap(at, other),
                2 => all.insert(at, r.pick(&extra).to_string()),
                3 => all[at] = r.pick(&extra).to_string(),
                4 => {
                    let donor = r.below(real.len());
                    all[at] = real[donor][r.below(real[donor].len())].clone();
                }
                5 => all.truncate(at.max(1)),
                _ => all[at] = all[other].clone(),
            }
            if all.is_empty() {
                all.push(";".into());
            }
        }
        let text = all.concat();
        let begun = now(start);
        let document = open(&text);
        for diagnostic in document.diagnostics() {
            let _ = moldloft_diag::render(&diagnostic, document.sources());
        }
        let took = now(start) - begun;
        assert!(!soak() || took < LONGEST, "round {round}: {took:?}\n{text}");
        if took > LONG {
            println!("round {round} took {took:?}:\n{text}\n");
        }
        slowest = slowest.max(took);
        assert!(!ids(&document).iter().any(|id| id == "internal-error"), "round {round}\n{text}");
        round += 1;
    }
    println!("{round} damaged programs, slowest {slowest:?}");
}

/// What is repeated takes time in proportion: looked at in long runs alone, in which this test runs by itself.
#[test]
fn long_inputs_take_time_in_proportion() {
    let shapes: [(&str, fn(usize) -> String); 14] = [
        ("statements", |n| "float x = 0;".to_string() + &"x = x + 1;\n".repeat(n)),
        ("array statements", |n| {
            "farray a = uniform(0, 1, 5);".to_string() + &"a = a*2 - a;\n".repeat(n)
        }),
        ("declarations", |n| (0..n).map(|k| format!("float x{k} = {k};\n")).collect()),
        ("a sum", |n| format!("float x = 1{};", " + 1".repeat(n.min(2_000)))),
        ("brackets", |n| format!("float x = {}1{};", "(".repeat(n), ")".repeat(n))),
        ("open brackets", |n| format!("float x = {}", "(".repeat(n))),
        ("open braces", |n| "{".repeat(n)),
        ("bars", |n| format!("float x = {};", "|".repeat(n))),
        ("signs", |n| format!("float x = {}1;", "-".repeat(n))),
        ("routines", |n| {
            (0..n).map(|k| format!("function float f{k}(float y) {{ return y; }}\n")).collect()
        }),
        ("unknown names", |n| (0..n).map(|k| format!("print q{k};\n")).collect()),
        ("shapes that differ", |n| "farray a[3], b[4];\n".to_string() + &"a = a + b;\n".repeat(n)),
        ("sections", |n| "curve c[9];\n".to_string() + &"c[2:] = c[1:8];\n".repeat(n)),
        ("a text", |n| format!("string s = \"{}\"; print s;", "a\\n".repeat(n))),
    ];
    for (name, text) in shapes {
        let time = |n: usize| {
            let text = text(n);
            let start = Instant::now();
            let begun = now(start);
            drop(open(&text));
            (now(start) - begun).as_secs_f64()
        };
        let (one, four) = (time(4_000), time(16_000));
        // Four times as much may take four times as long; a square would take sixteen times.
        assert!(!soak() || four < 10.0 * one + 1.0, "{name}: {one} s, then {four} s");
    }
}
