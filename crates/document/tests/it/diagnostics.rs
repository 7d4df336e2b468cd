//! What programs print and what is said of them: `tests/corpus/run/*.sdl` at the top of the
//! repository. A case begins with `#### its name`; below its text stand, as comments,
//!
//! - `#< text`: a printed line,
//! - `#> severity[id] line:column message (expectation)`: a diagnostic,
//! - `#+ line:column label` and `#? help`: its other places, and how to fix it.
//!
//! `MOLDLOFT_ACCEPT=1 cargo test -p moldloft-lang --test diagnostics` writes the present output
//! into the files.

use crate::common::{ids, line, open, reported, with_files};
use moldloft_document::Document;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

struct Case {
    name: String,
    text: String,
    expected: Vec<String>,
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus/run");
    let entries = std::fs::read_dir(folder).expect("the corpus is part of the repository");
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("a readable folder").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "sdl"));
    files.sort();
    files
}

fn read(path: &Path) -> (String, Vec<Case>) {
    let text = std::fs::read_to_string(path).expect("a readable file").replace("\r\n", "\n");
    let mut head = String::new();
    let mut cases: Vec<Case> = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("#### ") {
            cases.push(Case { name: name.into(), text: String::new(), expected: Vec::new() });
            continue;
        }
        let Some(case) = cases.last_mut() else {
            head.push_str(line);
            head.push('\n');
            continue;
        };
        if ["#> ", "#< ", "#+ ", "#? "].iter().any(|mark| line.starts_with(mark)) {
            case.expected.push(line.to_owned());
        } else {
            case.text.push_str(line);
            case.text.push('\n');
        }
    }
    for case in &mut cases {
        case.text.truncate(case.text.trim_end().len());
        case.text.push('\n');
    }
    (head, cases)
}

/// What is printed and said of a document, a line each.
fn found(document: &Document) -> Vec<String> {
    let printed = document.printed().iter().flat_map(|text| text.split('\n'));
    let mut lines: Vec<String> = printed.map(|line| format!("#< {line}")).collect();
    for d in document.diagnostics() {
        lines.push(format!("#> {}", line(document, &d)));
        for place in &d.secondary {
            let at = document.sources().locate(place.span.file, place.span.start);
            let at = at.map_or("-".into(), |at| format!("{}:{}", at.line, at.column));
            lines.push(format!("#+ {at} {}", place.text));
        }
        lines.extend(d.notes.iter().chain(&d.help).map(|text| format!("#? {text}")));
    }
    lines
}

#[test]
fn expectations_hold() {
    let accept = std::env::var("MOLDLOFT_ACCEPT").is_ok_and(|value| value == "1");
    let mut differences = String::new();
    for path in files() {
        let (mut out, cases) = read(&path);
        for case in &cases {
            let found = found(&open(&case.text));
            if found != case.expected {
                let (a, b) = (case.expected.join("\n  "), found.join("\n  "));
                let place = path.file_name().unwrap_or_default().to_string_lossy();
                let _ = writeln!(
                    differences,
                    "{place}: {}\n expected\n  {a}\n found\n  {b}",
                    case.name
                );
            }
            let _ = writeln!(out, "#### {}\n{}{}\n", case.name, case.text, found.join("\n"));
        }
        if accept {
            out.truncate(out.trim_end().len());
            out.push('\n');
            std::fs::write(&path, out).expect("a writable file");
        }
    }
    assert!(
        accept || differences.is_empty(),
        "{differences}\nMOLDLOFT_ACCEPT=1 accepts what was found"
    );
}

/// Every error of the corpus has a place in its text.
#[test]
fn every_diagnostic_has_its_place() {
    for path in files() {
        for case in read(&path).1 {
            let document = open(&case.text);
            for reported in reported(&document) {
                assert!(!reported.contains("] - "), "{}: {reported}", case.name);
            }
        }
    }
}

/// The Rust files of a folder and those in it; none when there is no such folder.
fn rust_files(folder: PathBuf) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found
}

/// The texts of all tests of the crates but this one: an id that stands in one of them is raised
/// there.
fn tests_of_crates() -> String {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut text = String::new();
    for package in std::fs::read_dir(crates).expect("a readable folder") {
        let tests = package.expect("a readable folder").path().join("tests");
        for file in rust_files(tests).iter().filter(|f| !f.ends_with("diagnostics.rs")) {
            text += &std::fs::read_to_string(file).expect("a readable file");
        }
    }
    text
}

/// Ids that no program alone can raise, or that other tests raise because they take long.
const ELSEWHERE: [&str; 27] = [
    "silent",
    // Bodies of sketches that lie on each other: tests/python/sketch/test_sketch_derivatives.py.
    "no-derivative",
    // 256 MB of output, a thousand open files.
    "too-much-output",
    "too-many-files",
    "cancelled",
    "internal-error",
    "no-mesh",
    "two-meanings",
    "not-here",
    "not-a-name",
    "has-dependents",
    "not-a-literal",
    "misplaced-object",
    "too-many-panels",
    "too-many-steps",
    "too-many-errors",
    "too-many-elements",
    "nested-too-deep",
    "cannot-read",
    "redefined",
    "not-a-number",
    "no-area",
    "empty",
    "no-spline",
    "no-distribution",
    // Quadrature that does not settle: no solid is known of which it does not.
    "rough-volume",
    // Kinds refuse what has places that are not finite; a guard of their measures.
    "no-body",
];

/// The ids in the sources of the crates that run programs: a new one must be raised by a case.
#[test]
fn every_id_is_raised() {
    let mut raised = BTreeSet::new();
    for path in files() {
        for case in read(&path).1 {
            raised.extend(ids(&open(&case.text)));
        }
    }
    let mut missing = BTreeSet::new();
    for crate_name in ["lang", "document", "registry", "relational", "model"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(crate_name).join("src");
        for path in rust_files(folder) {
            // Those of model files have tests of their own.
            if path.components().any(|c| c.as_os_str() == "model_file") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a readable file");
            let text = text.split("#[cfg(test)]").next().unwrap_or_default();
            for begin in ["Diagnostic::error(", "Diagnostic::remark(", "Fault::new("] {
                for rest in text.split(begin).skip(1) {
                    let id = rest.trim_start().strip_prefix('"').and_then(|r| r.split('"').next());
                    missing.extend(id.filter(|id| !id.is_empty()).map(str::to_owned));
                }
            }
        }
    }
    let tested = tests_of_crates();
    missing.retain(|id| {
        let listed = id.as_str();
        let elsewhere = ELSEWHERE.contains(&listed) || tested.contains(&format!("\"{id}\""));
        !raised.contains(id) && !elsewhere
    });
    assert!(missing.is_empty(), "never raised: {missing:?}");
}

#[test]
fn loads() {
    let text = "load \"lib.sdl\"; print width(2);";
    let lib = ("lib.sdl", "float base = 1; function float width(float x) { return x + base; }");
    let document = with_files(text, &[lib]);
    assert_eq!(document.printed(), ["3"], "{:?}", reported(&document));
    // Twice is once; a file may come by way of another.
    let other = ("other.sdl", "load \"lib.sdl\"; float more = width(3);");
    let twice = "load \"lib.sdl\"; load \"other.sdl\"; load \"lib.sdl\"; print more;";
    let document = with_files(twice, &[lib, other]);
    assert_eq!((document.printed().join(","), ids(&document)), ("4".into(), vec![]));
    // A cycle comes to an end.
    let (a, b) =
        (("a.sdl", "load \"b.sdl\"; float x = 1;"), ("b.sdl", "load \"a.sdl\"; float y = 2;"));
    let document = with_files("load \"a.sdl\"; print x + y;", &[a, b]);
    assert_eq!((document.printed().join(","), ids(&document)), ("3".into(), vec![]));
    let document = with_files(
        "load \"model.sdl\"; print 1;",
        &[("model.sdl", "load \"model.sdl\"; print 1;")],
    );
    assert_eq!((document.printed().join(","), ids(&document)), ("1".into(), vec![]));
    // What is missing is said where it is asked for.
    let document = with_files("float x = 1;\nload \"lid.sdl\";\nprint x;", &[lib]);
    assert_eq!(reported(&document), ["error[cannot-read] 2:1 unknown file `lid.sdl`"]);
    assert_eq!(document.printed(), ["1"]);
}

#[test]
fn a_program_may_redefine_a_library_routine() {
    let lib = "function float width(float x) { return x; } function float twice(float x) { return 2 * width(x); }";
    let text = "load \"lib.sdl\"; function float width(float x) { return 10 * x; } print twice(3);";
    let document = with_files(text, &[("lib.sdl", lib)]);
    assert_eq!(document.printed(), ["60"]);
    assert_eq!(ids(&document), ["redefined"]);
    assert!(!document.has_errors());
    let document =
        open("function float f() { return 1; } function float f() { return 2; } print f();");
    assert_eq!(ids(&document), ["duplicate-name"]);
}

#[test]
fn faults_of_a_loaded_file_are_told_at_every_run() {
    let mut document = with_files("load \"lib.sdl\"; param p = 1;", &[("lib.sdl", "float x = ;")]);
    let first = reported(&document);
    assert_eq!(first.len(), 1, "{first:?}");
    document.run();
    assert_eq!(reported(&document), first);
    document.set(&[("p".into(), 2.0)]).unwrap();
    assert_eq!(reported(&document), first);
}

#[test]
fn set_refuses_what_a_run_would() {
    let text = "param float w = 2 in [1, 3]; param int n = 2; AbsPoint A(w, 2*w, 0.5);\n\
                AbsPoint B(0, 0, 0); BCurve c({A, B}, degree = 1); for (i = 1:2) AbsPoint p(i, 0.25, 0); RelPoint r(B);";
    let mut document = open(text);
    assert!(!document.has_errors(), "{:?}", reported(&document));
    let mut refused = |name: &str, value: f64, id: &str, says: &str| {
        let before = document.text();
        let faults = document.set(&[("B.x".into(), 9.0), (name.into(), value)]).unwrap_err();
        assert_eq!(faults[0].id, id, "{name} {faults:?}");
        assert!(format!("{faults:?}").contains(says), "{name}: {faults:?}");
        // All or nothing.
        assert_eq!(document.text(), before, "{name}");
        assert_eq!(crate::common::number(&mut document, "B.x"), 0.0);
        assert_eq!(crate::common::number(&mut document, "w"), 2.0);
    };
    refused("w", 4.0, "out-of-range", "from 1 to 3");
    refused("w", f64::NAN, "out-of-range", "finite");
    refused("n", 2.5, "out-of-range", "whole");
    refused("A.x", 1.0, "not-a-literal", "set its parameters: w");
    refused("A.y", 1.0, "not-a-literal", "set its parameters: w");
    refused("p[1].y", 1.0, "not-a-literal", "shares its number");
    refused("r.dx", 1.0, "not-a-literal", "default");
    refused("A.q", 1.0, "unknown-member", "x, y, z");
    refused("Q.x", 1.0, "unknown-name", "Q.x");
    refused("c.points", 1.0, "not-a-number", "the parents of an object");
    refused("A.z", f64::INFINITY, "not-finite", "inf");
    refused("c.degree", 0.0, "out-of-range", "from 1 to 25");
    refused("c.degree", 1.5, "out-of-range", "whole");
    assert_eq!(document.set(&[("A.z".into(), 0.75)]).unwrap().evaluated, 2);
}

#[test]
fn an_expression_changes_nothing() {
    let text = "function float f(float x) { AbsPoint P(x, 0, 0); return P.x; } float y = f(2); AbsPoint Q(y, 0, 0);";
    let mut document = open(text);
    assert!(!document.has_errors(), "{:?}", reported(&document));
    assert!(document.eval("f(3)").is_err());
    assert_eq!(crate::common::number(&mut document, "P.x"), 2.0);
    assert_eq!(document.graph().len(), 2);
    let faults = document.eval("Q.x + nothing + 1").unwrap_err();
    assert_eq!(faults[0].id, "unknown-name");
    assert_eq!(ids(&document), Vec::<String>::new());
    for text in ["", "1 +", "Q.x = 3", "Q.x; Q.y", "AbsPoint R(1, 2, 3)", "((("] {
        assert!(document.eval(text).is_err(), "{text}");
    }
    assert_eq!(crate::common::number(&mut document, "Q.x"), 2.0);
}

#[test]
fn numbers_of_loaded_files_are_set_there() {
    let lib = ("lib.sdl", "AbsPoint P(1, 2, 3);");
    let mut document = with_files("load \"lib.sdl\"; RelPoint Q(P, 1);", &[lib]);
    let faults = document.set(&[("P.x".into(), 5.0)]).unwrap_err();
    assert_eq!(faults[0].id, "not-here");
    assert_eq!(crate::common::number(&mut document, "Q.x"), 2.0);
    // Derivatives by them exist all the same.
    let d = document
        .derivatives(&["Q.x".into()], &["P.x".into(), "P.x".into(), "Q.dx".into()])
        .unwrap();
    let d: Vec<String> = d[0].iter().map(moldloft_lang::display::plain).collect();
    assert_eq!(d, ["1", "1", "1"]);
}

#[test]
fn deleting_and_renaming_are_checked() {
    let text = "param w = 2; AbsPoint A(0, 0, 0); AbsPoint B(1, w, 0);\nLine l(A, B); float s = length(l);\n\
                for (i = 1:2) AbsPoint p(i, 0, 0);\nAbsPoint C(s, B.y, 0); # far\nAbsPoint D(0, 0, 0);\n\
                subroutine f(AbsPoint D) { RelPoint r(D, 1); } f(A);";
    let mut document = open(text);
    assert!(document.diagnostics().is_empty(), "{:?}", reported(&document));
    for (name, id) in [
        ("A", "has-dependents"),
        ("l", "has-dependents"),
        ("p[1]", "not-here"),
        ("r", "not-here"),
        ("E", "unknown-name"),
    ] {
        let fault = document.delete(name).unwrap_err();
        assert_eq!(fault.id, id, "{name}: {fault:?}");
    }
    for (old, new, id) in [
        ("A", "B", "duplicate-name"),
        ("A", "w", "duplicate-name"),
        ("A", "for", "not-a-name"),
        ("A", "while", "not-a-name"),
        ("A", "RevSurf", "duplicate-name"),
        ("A", "Line", "duplicate-name"),
        ("A", "sqrt", "duplicate-name"),
        ("A", "a b", "not-a-name"),
        ("A", "", "not-a-name"),
        ("A", "1a", "not-a-name"),
        ("D", "E", "two-meanings"),
        ("p[1]", "q", "not-here"),
        ("E", "F", "unknown-name"),
    ] {
        let fault = document.rename(old, new).expect_err(old);
        assert_eq!(fault.id, id, "{old} -> {new}: {fault:?}");
    }
    assert_eq!(document.text(), text);
    document.set(&[("A.x".into(), -1234.5)]).unwrap();
    document.rename("B", "bow").unwrap();
    assert!(document.diagnostics().is_empty(), "{:?}\n{}", reported(&document), document.text());
    assert!(
        document.text().contains("AbsPoint bow(1, w, 0);\nLine l(A, bow)")
            && document.text().contains("bow.y")
    );
    assert_eq!(crate::common::number(&mut document, "bow.y"), 2.0);
    let applied = document.delete("C").unwrap();
    assert_eq!((applied.evaluated, document.diagnostics().len()), (0, 0));
    assert!(document.text().contains("AbsPoint p(i, 0, 0);\n # far\n"), "{}", document.text());
    assert!(document.text().contains("-1234.5"));
}

#[test]
fn a_long_session_of_expressions_keeps_no_texts() {
    let mut document = open("AbsPoint A(1, 2, 3);");
    for k in 0..2000 {
        assert_eq!(crate::common::number(&mut document, &format!("A.x + {k}")), 1.0 + f64::from(k));
        assert!(document.eval("A.x + nothing").is_err());
    }
    assert_eq!(document.sources().len(), 2);
}

#[test]
fn a_cancelled_run_says_so_and_can_be_made_again() {
    let mut document = open("float x = 0; for (i = 1:1e4) x += i; AbsPoint A(x, 0, 0);");
    let budget = document.budget();
    budget.cancel();
    document.run();
    assert_eq!(ids(&document), ["cancelled"]);
    budget.resume();
    document.run();
    assert_eq!((ids(&document).len(), document.graph().len()), (0, 1));
}

#[test]
fn what_a_cancelled_edit_left_is_evaluated_by_the_next() {
    let text = "param float a = 1; param float b = 1; AbsPoint A(a, 0, 0); RelPoint B(A, b, 0, 0); \
                AbsPoint C(b, b, b);";
    let mut document = open(text);
    let budget = document.budget();
    budget.cancel();
    let _ = document.set(&[("a".into(), 5.0)]);
    assert!(document.diagnostics().iter().any(|d| d.id == "cancelled"));
    budget.resume();
    // An edit of something else evaluates what was left, too.
    document.set(&[("b".into(), 2.0)]).unwrap();
    assert_eq!(ids(&document), Vec::<&str>::new());
    assert_eq!(crate::common::number(&mut document, "B.x"), 7.0);
    assert_eq!(crate::common::number(&mut document, "C.y"), 2.0);
}
