//! Sizes: what is large must be fast, what is too large must be refused with a clear diagnostic.

use crate::common::{ids, number, open, reported, sound, vector};
use std::fmt::Write;
use std::time::{Duration, Instant};

/// Far above what these take on a quiet machine, far below what something quadratic would; looked at in long runs alone.
const SOON: Duration = Duration::from_secs(20);

fn timed<R>(what: &str, f: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = f();
    let taken = start.elapsed();
    println!("{what}: {:.3} s", taken.as_secs_f64());
    assert!(!moldloft_testing::soak() || taken < SOON, "{what} took {taken:?}");
    result
}

/// Programs that would run for seconds before the usual limit of steps is reached end at a lower one.
fn endless(what: &str, text: &str) {
    let mut document = sound("float nothing = 0;");
    document.with_steps(1_000_000);
    timed(what, || document.set_text(text));
    assert!(
        ids(&document).iter().any(|id| id == "too-many-steps"),
        "{what}: {:?}",
        reported(&document)
    );
}

fn refused(what: &str, text: &str, id: &str) {
    let document = timed(what, || open(text));
    assert!(ids(&document).iter().any(|found| found == id), "{what}: {:?}", reported(&document));
}

#[test]
fn a_chain_of_relative_points() {
    const N: usize = 100_000;
    let mut text = String::from("AbsPoint P0(0, 0, 0);\n");
    for k in 1..=N {
        writeln!(text, "RelPoint P{k}(P{}, 1, 0, 0.5);", k - 1).unwrap();
    }
    let mut document = timed("opening a chain", || sound(&text));
    assert_eq!(document.applied().evaluated, N + 1);
    let last = format!("P{N}.x");
    assert_eq!(number(&mut document, &last), N as f64);
    let applied = timed("moving its first", || document.set(&[("P0.x".into(), 2.0)]).unwrap());
    assert_eq!(applied.evaluated, N + 1);
    assert_eq!(number(&mut document, &last), N as f64 + 2.0);
    // The same text with another head: all ranks change.
    let text =
        text.replace("AbsPoint P0(0, 0, 0);", "AbsPoint Q(0, 0, 0); RelPoint P0(Q, 3, 0, 0);");
    let applied = timed("a new head", || document.set_text(&text));
    assert_eq!(applied.evaluated, N + 2);
    assert_eq!(number(&mut document, &last), N as f64 + 3.0);
    // Another object between each two.
    let mut text = String::from("AbsPoint P0(0, 0, 0);\n");
    for k in 1..=N / 2 {
        writeln!(text, "MirrPoint M{k}(P{}, \"x=0\"); MirrPoint N{k}(M{k}, \"x=0\");", k - 1)
            .unwrap();
        writeln!(text, "RelPoint P{k}(N{k}, 1, 0, 0.5);").unwrap();
    }
    timed("links doubled", || document.set_text(&text));
    assert_eq!(number(&mut document, &format!("P{}.x", N / 2)), (N / 2) as f64);
    timed("all gone", || document.set_text(""));
    assert_eq!(document.graph().len(), 0);
}

#[test]
fn a_chain_of_relative_beads() {
    const N: usize = 50_000;
    let mut text = String::from(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); Line l(A, B);\nAbsBead b0(l, 0);\n",
    );
    for k in 1..=N {
        writeln!(text, "RelBead b{k}(b{}, 0.00001);", k - 1).unwrap();
    }
    let mut document = timed("opening a bead chain", || sound(&text));
    let applied = timed("moving its curve", || document.set(&[("A.y".into(), 1.0)]).unwrap());
    assert_eq!(applied.evaluated, N + 3);
    assert!((number(&mut document, &format!("b{N}.t")) - 0.5).abs() < 1e-9);
}

#[test]
fn shapes_nested_too_deep_are_refused() {
    let mut text = String::from(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 1); AbsPoint D(1, 1, 2); Line a(A, B); \
         Line b(C, D); RuledSurf S0(a, b, visible = 0);\n",
    );
    for k in 1..=1000 {
        writeln!(text, "MirrSurf S{k}(S{}, \"y=0\", visible = 0);", k - 1).unwrap();
    }
    let document = timed("a thousand mirrors", || open(&text));
    assert_eq!(ids(&document), ["nested-too-deep"], "{:?}", reported(&document));
    // What is just deep enough is evaluated on a small stack, with derivatives.
    let mut text = text.lines().take(98).collect::<Vec<_>>().join("\n");
    text.push_str("\nUVSnake s(S96, \"u\", 0.25);\nAbsRing r(s, 0.5);");
    let mut document = sound(&text);
    let small = std::thread::Builder::new().stack_size(1 << 20);
    let handle = small.spawn(move || {
        let p = vector(&mut document, "r");
        assert!((p.y - 0.5).abs() < 1e-12, "{p:?}");
        document.set(&[("C.y".into(), 2.0)]).unwrap();
        let d = document.derivatives(&["S96(0.3, 0.4)".into(), "S96.area".into()], &["C.y".into()]);
        assert!(d.is_ok(), "{d:?}");
    });
    handle.unwrap().join().unwrap();
}

#[test]
fn lofts_nested_too_deep_are_refused() {
    let mut text = String::from(
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0); Line a0(A, B); \
         Line b(C, D);\n",
    );
    for k in 1..=200 {
        writeln!(text, "CLoftSurf S{k}({{a{}, b}}, visible = 0);", k - 1).unwrap();
        writeln!(text, "UVSnake a{k}(S{k}, \"v\", 0.001);").unwrap();
    }
    let document = timed("a hundred lofts", || open(&text));
    assert_eq!(ids(&document), ["nested-too-deep"], "{:?}", reported(&document));
}

#[test]
fn many_children_of_one_object() {
    const N: usize = 100_000;
    let mut text = String::from("AbsPoint P(0, 0, 0);\n");
    for k in 0..N {
        writeln!(text, "RelPoint Q{k}(P, {k}, 0, 0);").unwrap();
    }
    let mut document = timed("opening many children", || sound(&text));
    let applied = timed("moving their parent", || document.set(&[("P.x".into(), 2.0)]).unwrap());
    assert_eq!(applied.evaluated, N + 1);
    let renamed = text.replace("P(", "R(").replace("(P,", "(R,").replace("RelR(", "RelP(");
    let renamed = renamed.replace("AbsPoint P", "AbsPoint R");
    let applied = timed("another parent", || document.set_text(&renamed));
    assert!(document.diagnostics().is_empty(), "{:?}", reported(&document).first());
    assert_eq!(applied.objects, N + 1);
    timed("removing them", || document.set_text("AbsPoint R(0, 0, 0);"));
    assert_eq!(document.graph().len(), 1);
}

#[test]
fn a_list_of_many_points() {
    const N: usize = 100_000;
    let mut text = String::from("AbsPoint O(0, 0, 0);\n");
    for k in 0..N {
        writeln!(text, "RelPoint P{k}(O, {k}, {}, 0);", k % 7).unwrap();
    }
    let names: Vec<String> = (0..N).map(|k| format!("P{k}")).collect();
    writeln!(text, "BCurve c({{{}}}, degree = 3);", names.join(", ")).unwrap();
    let mut document = timed("opening a long curve", || sound(&text));
    let applied = timed("moving one point", || document.set(&[("P5.dy".into(), 2.0)]).unwrap());
    assert_eq!(applied.evaluated, 2);
    assert_eq!(vector(&mut document, "c(1)").x, (N - 1) as f64);
    // Every point of the list goes one rank up.
    let text = text.replace("AbsPoint O(0, 0, 0);", "AbsPoint Z(0, 0, 0); RelPoint O(Z);");
    timed("one rank up", || document.set_text(&text));
    assert!(document.diagnostics().is_empty());
    let applied = timed("moving all points", || document.set(&[("Z.y".into(), 2.0)]).unwrap());
    assert_eq!(applied.evaluated, N + 3);
}

#[test]
fn a_ladder_of_triangles_is_ranked_once_a_rung() {
    let mut text = String::from("AbsPoint Z0(0, 0, 0);\n");
    for k in 1..=5000 {
        writeln!(text, "RelPoint Z{k}(Z{}, 1);", k - 1).unwrap();
    }
    text.push_str("RelPoint A0(Z0, 1);\n");
    for k in 1..=5000 {
        writeln!(text, "RelPoint B{k}(A{}, 1); ProjPoint A{k}(A{}, B{k});", k - 1, k - 1).unwrap();
    }
    let mut document = timed("opening a ladder", || sound(&text));
    let text = text.replace("A0(Z0, 1)", "A0(Z5000, 1)");
    timed("hanging it lower", || document.set_text(&text));
    assert_eq!(number(&mut document, "A5000.x"), 10_001.0);
}

#[test]
fn too_many_divisions_and_panels_are_refused() {
    let base = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0);\n\
                Line l(A, B); Line m(C, D);\n";
    refused(
        "a billion divisions",
        &format!("{base}RuledSurf S(l, m, divisions = 1e9);"),
        "out-of-range",
    );
    refused(
        "half a division",
        &format!("{base}RuledSurf S(l, m, divisions = {{0.5, 2}});"),
        "out-of-range",
    );
    let text = format!("{base}RuledSurf S(l, m, divisions = {{1000000, 1000000}});");
    let mut document = timed("a million squared", || sound(&text));
    let fault = timed("panelling", || document.panelled().unwrap_err());
    assert_eq!(fault.id, "too-many-panels");
    assert_eq!(fault.object.as_deref(), Some("S"));
    assert!(fault.primary.is_some());
    assert!(document.eval("S.area").is_ok(), "a measure of the surface needs no panels");
    for text in ["mesh.area", "hydrostatics.volume"] {
        let faults = timed(text, || document.eval(text).unwrap_err());
        assert_eq!(faults[0].id, "too-many-panels", "{faults:?}");
    }
}

#[test]
fn endless_loops_and_recursion_end() {
    endless("an endless loop", "float x = 1; while (x > 0) x = x + 1;");
    endless("an empty endless loop", "while (1) {}");
    endless("a long loop", "float x = 0; for (i = 1:1e12) x += i;");
    endless("a loop by tiny steps", "float x = 0; for (i = 0:1:1e-300) x += i;");
    // The usual limit goes by time: ten million turns of code are no endless loop.
    assert_eq!(number(&mut sound("float x = 0; for (i = 1:1e7) x += 0.5;"), "x"), 5e6);
    refused("a loop without end", "ieee(); float x = 0; for (i = 0:1/0) x += i;", "endless-loop");
    refused("a loop without step", "float x = 0; for (i = 0:1:0) x += i;", "endless-loop");
    refused("an endless loop of faults", "float x = 0; while (1) x = nothing;", "too-many-errors");
    refused(
        "a subroutine without end",
        "subroutine f(float n) { f(n + 1); } f(0);",
        "nested-too-deep",
    );
    refused(
        "a function without end",
        "function float f(float n) { return f(n + 1) + 1; } float x = f(0);",
        "nested-too-deep",
    );
    refused(
        "a recursion 13 000 deep",
        "subroutine f(float n) { if (n > 0) { f(n - 1); } } f(13000);",
        "nested-too-deep",
    );
    timed("a recursion 10 000 deep", || {
        sound("subroutine f(float n) { if (n > 0) { f(n - 1); } } f(10000);")
    });
    refused(
        "mutual recursion",
        "subroutine f() { g(); } subroutine g() { f(); } f();",
        "nested-too-deep",
    );
    // A loop that stops by itself is none of that.
    assert_eq!(number(&mut sound("float x = 0; while (x < 1e5) x += 1;"), "x"), 1e5);
}

#[test]
fn arrays_that_are_too_large_are_refused() {
    // One array takes a sixteenth of the memory, of usually 4 GiB.
    refused("a long farray", "farray a[1e9];", "too-many-elements");
    refused("a large surface", "surface s[10000, 10000];", "too-many-elements");
    refused("a row of 1e8", "farray a[100000000];", "too-many-elements");
    refused("more than there are numbers", "farray a[1e300];", "wrong-dimension");
    sound("farray a[33554432];");
    refused("one more", "farray a[33554433];", "too-many-elements");
    // What an array replaces is no longer held, in a loop and by itself, in code and without.
    for text in [
        "for (i = 1:40) { farray s[2000, 2000]; s[1, 1] = i; }",
        "for (i = 1:40) { curve s[2000000]; s[1].x = i; string t = \"\"; t = t + \"a\"; }",
        "subroutine f() { farray s[2000, 2000]; s[1, 1] = 1; print s[1, 1]; } for (i = 1:40) f();",
        "for (i = 1:40) { surface s[1000, 1000]; farray a[3000000]; a[3] = i; s[2, 2].x = a[3]; }",
    ] {
        sound(text);
    }
    refused("many rows", "farray a; for (i = 1:10000) a = uniform(0, i, 1e6);", "too-many-steps");
    refused(
        "sums of rows",
        "farray a = uniform(0, 1, 1e6); while (1) a = a + 1;",
        "too-many-steps",
    );
    refused("lists of lists", "subroutine f(any x) { f({x, x}); } f(1);", "too-many-steps");
    refused("no dimension", "farray a[0];", "wrong-dimension");
    refused("half an element", "farray a[1.5];", "wrong-dimension");
}

#[test]
fn deep_expressions() {
    let deep = |open: &str, close: &str, n: usize| {
        format!("float x = {}1{};", open.repeat(n), close.repeat(n))
    };
    for (open_with, close) in
        [("(", ")"), ("{", "}"), ("-(", ")"), ("sin(", ")"), ("|", "|"), ("not ", "")]
    {
        let document = timed(open_with, || open(&deep(open_with, close, 100_000)));
        assert!(!document.diagnostics().is_empty(), "{open_with}");
    }
    refused("a long sum", &format!("float x = 0{};", " + 1".repeat(100_000)), "nesting-too-deep");
    let flat = format!("float x = 0{};", " + 1".repeat(900));
    assert_eq!(number(&mut timed("a sum", || sound(&flat)), "x"), 900.0);
    let power = format!("float x = 1{};", "^1".repeat(100_000));
    timed("a long power", || open(&power));
    let logic = format!("float x = 1{};", " and 1".repeat(100_000));
    timed("a long condition", || open(&logic));
    let blocks = format!("{}{}", "{".repeat(100_000), "}".repeat(100_000));
    timed("nested blocks", || open(&blocks));
    let ifs = format!("float x; {}x = 1;", "if (1) ".repeat(100_000));
    timed("nested ifs", || open(&ifs));
}

#[test]
fn many_faults_are_told_soon() {
    let mut text = String::new();
    for k in 0..3000 {
        writeln!(text, "AbsPoint P{k}(0, 0, 0); RelPoint Q{k}(Pp{k}, 1);").unwrap();
    }
    let document = timed("three thousand unknown names", || open(&text));
    assert!(ids(&document).len() >= 1000);
    let text = format!("{text}\n{}", "AbsPoint P(0, 0, 0);\n".repeat(3000));
    timed("duplicates as well", || open(&text));
}

#[test]
fn removed_objects_leave_nothing_behind() {
    let mut text = String::from("AbsPoint P(0, 0, 0);\n");
    for k in 0..2000 {
        writeln!(text, "RelPoint Q{k}(P, {k}, 0, 0);").unwrap();
    }
    let mut document = sound(&text);
    for _ in 0..200 {
        document.set_text("");
        document.set_text(&text);
    }
    let highest = document.graph().objects().map(|o| o.key.0).max().unwrap();
    assert!(highest < 20_000, "{highest} keys for 2001 objects");
}
