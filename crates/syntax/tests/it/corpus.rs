//! The language corpus: `tests/corpus/*.sdl` at the top of the repository, see the README there.
//!
//! `MOLDLOFT_ACCEPT=1 cargo test -p moldloft-syntax --test corpus` writes the present output into the files.

use crate::ebnf::Grammar;
use moldloft_diag::{FileId, Sources};
use moldloft_syntax::sdl;
use std::fmt::Write;
use std::path::{Path, PathBuf};

struct Case {
    name: String,
    text: String,
    trees: Vec<String>,
    faults: Vec<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus")
}

fn files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder())
        .expect("the corpus is part of the repository")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "sdl"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

fn read(path: &Path) -> (String, Vec<Case>) {
    let text = std::fs::read_to_string(path).expect("a readable file").replace("\r\n", "\n");
    let mut head = String::new();
    let mut cases: Vec<Case> = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("#### ") {
            let (name, text) = (name.to_owned(), String::new());
            cases.push(Case { name, text, trees: Vec::new(), faults: Vec::new() });
        } else if let Some(case) = cases.last_mut() {
            if let Some(tree) = line.strip_prefix("#= ") {
                case.trees.push(tree.to_owned());
            } else if let Some(fault) = line.strip_prefix("#> ") {
                case.faults.push(fault.to_owned());
            } else {
                case.text.push_str(line);
                case.text.push('\n');
            }
        } else {
            head.push_str(line);
            head.push('\n');
        }
    }
    for case in &mut cases {
        case.text.truncate(case.text.trim_end().len());
        case.text.push('\n');
    }
    (head, cases)
}

/// The parser's result for a case: trees and errors, one per line.
fn run(case: &Case) -> (Vec<String>, Vec<String>) {
    let mut sources = Sources::new();
    let file = sources.add(case.name.as_str(), case.text.as_str());
    let (program, diagnostics) = sdl::parse(case.text.as_str(), file);
    let faults = diagnostics.iter().map(|fault| {
        let at = sources.locate(file, fault.span().start).expect("a place in the case");
        let word = format!("{}[{}] {}:{}", fault.severity, fault.id, at.line, at.column);
        let rest = fault.expectation().map(|text| format!(" ({text})")).unwrap_or_default();
        format!("{word} {}{rest}", fault.message)
    });
    (program.dump().lines().map(str::to_owned).collect(), faults.collect())
}

#[test]
fn expectations_hold() {
    let accept = std::env::var("MOLDLOFT_ACCEPT").is_ok_and(|value| value == "1");
    let mut differences = String::new();
    for path in files() {
        let (head, cases) = read(&path);
        let mut out = head;
        for case in &cases {
            let (trees, faults) = run(case);
            let trees = if case.trees.is_empty() { Vec::new() } else { trees };
            if trees != case.trees || faults != case.faults {
                let expected =
                    case.trees.iter().chain(&case.faults).cloned().collect::<Vec<_>>().join("\n  ");
                let found = trees.iter().chain(&faults).cloned().collect::<Vec<_>>().join("\n  ");
                let place = path.file_name().unwrap_or_default().to_string_lossy();
                let _ = writeln!(
                    differences,
                    "{place}: {}\n expected\n  {expected}\n found\n  {found}",
                    case.name
                );
            }
            let _ = write!(out, "#### {}\n{}", case.name, case.text);
            for tree in &trees {
                let _ = writeln!(out, "#= {tree}");
            }
            for fault in &faults {
                let _ = writeln!(out, "#> {fault}");
            }
            out.push('\n');
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

#[test]
fn formatting_keeps_the_meaning() {
    for path in files() {
        for case in read(&path).1 {
            let (program, faults) = sdl::parse(case.text.as_str(), FileId(0));
            let Ok(once) = sdl::format(&case.text) else {
                assert!(!faults.is_empty(), "{}", case.name);
                continue;
            };
            assert!(faults.is_empty(), "{}", case.name);
            let again = sdl::parse(once.as_str(), FileId(0)).0;
            assert_eq!(program.dump(), again.dump(), "{}", case.name);
            assert_eq!(sdl::format(&once), Ok(once.clone()), "{}", case.name);
        }
    }
}

/// Faults that the grammar does not state, or that are about single tokens.
const BEYOND_GRAMMAR: [&str; 6] = [
    "stray-jump",
    "duplicate-argument",
    "nesting-too-deep",
    "bad-number",
    "bad-character",
    "unclosed-string",
];

#[test]
fn grammar_and_parser_agree() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/grammar.ebnf");
    let grammar = Grammar::read(
        &std::fs::read_to_string(path).expect("the grammar is part of the repository"),
    );
    let mut compared = 0;
    for path in files() {
        for case in read(&path).1 {
            let (_, faults) = sdl::parse(case.text.as_str(), FileId(0));
            if faults.iter().any(|fault| BEYOND_GRAMMAR.contains(&fault.id.as_ref())) {
                continue;
            }
            let accepted = grammar.accepts(&case.text);
            assert_eq!(accepted, faults.is_empty(), "{}\n{}\n{faults:#?}", case.name, case.text);
            compared += 1;
        }
    }
    assert!(compared > 60, "{compared} cases");
}
