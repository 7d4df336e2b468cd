//! Solve sets: closed forms, derivatives through the solution, and what has none.

use crate::common::{ids, number, open, reported, sound};
use moldloft_document::{Document, SolveStatus};
use moldloft_registry::Value;

/// A point at the distance d from the origin in the direction (3, 4): x = 0.6 d, y = 0.8 d.
const TRIANGLE: &str = "
param float d = 5 in [1, 10]; param float x = 1 in [0, 20]; param float y = 1 in [0, 20];
AbsPoint O(0, 0, 0); AbsPoint A(x, y, 0); Line l(O, A);
SolveSet s({x, y}, {l.length - d, 4*A.x - 3*A.y});
AbsPoint B(x + y, s.x*s.y, 1);
";

fn derivative(document: &mut Document, of: &str, by: &str) -> f64 {
    let found = document.derivatives(&[of.into()], &[by.into()]).unwrap();
    match found[0][0] {
        Value::Number(x) => x,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn the_unknowns_meet_the_conditions() {
    let mut document = sound(TRIANGLE);
    assert!((number(&mut document, "x") - 3.0).abs() < 1e-14);
    assert!((number(&mut document, "s.y") - 4.0).abs() < 1e-14);
    assert!((number(&mut document, "B.y") - 12.0).abs() < 1e-13);
    assert!(number(&mut document, "s.residual") < 1e-14);
    let [report] = document.solved() else { panic!("one set") };
    assert_eq!((report.status, &report.starts[..]), (SolveStatus::Solved, &[1.0, 1.0][..]));
    assert!((1..10).contains(&report.iterations), "{report:?}");
    let steps = report.iterations as f64;
    assert_eq!(number(&mut document, "s.iterations"), steps);
    assert!(matches!(document.eval("s.status"), Ok(Value::Text(t)) if &*t == "solved"));
    let x = document.params().iter().find(|p| p.name == "x").unwrap();
    assert_eq!(x.default, 1.0);
}

#[test]
fn derivatives_go_through_the_solution() {
    let mut document = sound(TRIANGLE);
    for (of, by, exact) in [
        ("x", "d", 0.6),
        ("s.y", "d", 0.8),
        ("B.y", "d", 2.0 * 0.48 * 5.0),
        ("l.length", "d", 1.0),
        // The origin moves along x: |A - O| = d and 4 A.x = 3 A.y give x = (9 o + ...)/25.
        ("s.residual", "d", 0.0),
        // The start has no say.
        ("B.x", "x", 0.0),
    ] {
        let found = derivative(&mut document, of, by);
        assert!((found - exact).abs() < 1e-13, "d{of}/d{by} = {found}");
    }
    for literal in ["O.x", "O.y", "O.z", "B.z"] {
        let exact = derivative(&mut document, "B.y", literal);
        let mut at = |h: f64| {
            let start = if literal == "B.z" { 1.0 } else { 0.0 };
            document.set(&[(literal.into(), start + h)]).unwrap();
            number(&mut document, "B.y")
        };
        let h = 1e-4;
        let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        document.set(&[(literal.into(), if literal == "B.z" { 1.0 } else { 0.0 })]).unwrap();
        assert!((exact - difference).abs() < 1e-9, "{literal}: {exact} {difference}");
    }
    // More directions than one pass has, mesh vertices included.
    let names: Vec<String> =
        ["d", "O.x", "O.y", "O.z", "B.z"].iter().map(|s| s.to_string()).collect();
    let all = document.derivatives(&["x".into(), "y".into()], &names).unwrap();
    assert_eq!((all[0].len(), all[1].len()), (5, 5));
}

#[test]
fn the_answer_depends_on_the_model_only() {
    // x^3 - 3 x = 1 has three roots: each start has its own, whatever came before.
    let text = |start: f64| {
        format!("param float x = {start}; param float c = 1; SolveSet s({{x}}, {{x^3 - 3*x - c}});")
    };
    let fresh = |start: f64| number(&mut sound(&text(start)), "x").to_bits();
    let mut document = sound(&text(2.0));
    for start in [2.0, -0.5, -2.0, 2.0, 0.0, -3.0] {
        document.set(&[("x".into(), start)]).unwrap();
        assert_eq!(number(&mut document, "x").to_bits(), fresh(start), "{start}");
    }
    document.set(&[("x".into(), 2.0), ("c".into(), 1.5)]).unwrap();
    document.set(&[("c".into(), 1.0)]).unwrap();
    assert_eq!(number(&mut document, "x").to_bits(), fresh(2.0));
    let x = number(&mut document, "x");
    assert!((x * x * x - 3.0 * x - 1.0).abs() < 1e-14);
    // 2 cos(20 degrees).
    assert!((x - 2.0 * (std::f64::consts::PI / 9.0).cos()).abs() < 1e-14);
}

#[test]
fn sets_follow_one_another() {
    let mut document = sound(
        "param float a = 1; param float x = 1; param float y = 1;
         SolveSet first({x}, {x^2 - 2*a}); SolveSet second({y}, {y^3 - 4*x});",
    );
    let (x, y) = (2f64.sqrt(), (4.0 * 2f64.sqrt()).cbrt());
    assert!((number(&mut document, "x") - x).abs() < 1e-14);
    assert!((number(&mut document, "y") - y).abs() < 1e-14);
    // y = (4 sqrt(2 a))^(1/3): dy/da = y / 6 at a = 1.
    assert!((derivative(&mut document, "y", "a") - y / 6.0).abs() < 1e-14);
    let wrong = open(
        "param float x = 1; param float y = 1; SolveSet first({x}, {x - y}); SolveSet second({y}, {y - 3});",
    );
    assert_eq!(ids(&wrong), ["unsolved"]);
    assert!(reported(&wrong)[0].contains("`first` depends on `y`"), "{:?}", reported(&wrong));
}

/// The trim of a hull: the draft at which it displaces what it weighs (a wall-sided box has a closed
/// form), and a direct edit of a point that the conditions see.
#[test]
fn edits_solve_again() {
    let mut document = sound(
        "param float draft = 1 in [0.1, 4]; param float weight = 24;
         AbsPoint A(0, 0, -draft); AbsPoint B(6, 0, -draft); AbsPoint C(6, 2, -draft); AbsPoint D(0, 2, -draft);
         Line ab(A, B); Line dc(D, C); RuledSurf bottom(ab, dc, divisions = {2, 2});
         SolveSet draft_of({draft}, {bottom.area*draft - weight});",
    );
    assert!((number(&mut document, "draft") - 2.0).abs() < 1e-14);
    assert!((derivative(&mut document, "draft", "weight") - 1.0 / 12.0).abs() < 1e-14);
    document.set(&[("weight".into(), 36.0)]).unwrap();
    assert!((number(&mut document, "draft") - 3.0).abs() < 1e-14);
    document.set(&[("C.y".into(), 4.0), ("D.y".into(), 4.0)]).unwrap();
    assert!((number(&mut document, "draft") - 1.5).abs() < 1e-14);
    assert_eq!(number(&mut document, "A.z"), -number(&mut document, "draft"));
    let text = document.text();
    assert!(text.contains("draft = 1 in"), "the start stays in the text");
    assert!(document.diagnostics().is_empty());
    // Beyond its range there is none; back inside there is.
    document.set(&[("weight".into(), 1e6)]).unwrap();
    assert_eq!(document.solved()[0].status, SolveStatus::OutOfRange);
    assert_eq!(number(&mut document, "draft"), 1.0, "unsolved, it is where it began");
    document.set(&[("weight".into(), 36.0)]).unwrap();
    assert!(document.diagnostics().is_empty());
}

#[test]
fn what_has_no_solution_says_so() {
    let mut wrong = Vec::new();
    let head =
        "param float x = 1; param float y = 2; param int n = 3; float v = 1; AbsPoint P(x, y, 0);";
    for (set, id, says) in [
        ("SolveSet s({x}, {x^4 + x + 3});", "unsolved", "is not solved"),
        ("SolveSet s({x}, {x^2 + 1});", "unsolved", "do not determine"),
        ("SolveSet s({x, y}, {x - y, 2*x - 2*y - 1});", "unsolved", "do not determine"),
        ("SolveSet s({x, y}, {x - 1.5, x^2 - 2});", "unsolved", "do not determine"),
        ("SolveSet s({x}, {x - 1, x - 2});", "wrong-count", "2 conditions do not determine 1"),
        ("SolveSet s({x, y}, {x - 1});", "wrong-count", "1 conditions"),
        ("SolveSet s({v}, {v - 2});", "not-an-unknown", "`v`"),
        ("SolveSet s({2}, {x - 2});", "not-an-unknown", "`2`"),
        ("SolveSet s({n}, {n - 2});", "not-an-unknown", "an int"),
        ("SolveSet s({x, x}, {x - 2, y});", "not-an-unknown", "an unknown already"),
        ("SolveSet s({x}, {P});", "wrong-class", "expected a number"),
        ("SolveSet s({x}, {x - 2}, steps = 0);", "out-of-range", "`steps`"),
        (
            "SolveSet s({x}, {x^3 - 1e3}, steps = 2);",
            "unsolved",
            "no solution was found in 2 steps",
        ),
        ("SolveSet s({x}, {(0 - x)^0.5});", "not-finite", ""),
        ("for (i = 1:2) { SolveSet s({x}, {x - i}); }", "misplaced-param", "file level"),
        ("SolveSet s({x}, {x - 2}); SolveSet t({x}, {x - 3});", "not-an-unknown", "already"),
        ("SolveSet s({x}, {y*0});", "", ""),
    ] {
        let document = open(&format!("{head} {set}"));
        let found = reported(&document);
        let right = match id {
            "" => found.is_empty(),
            _ => ids(&document) == [id] && found[0].contains(says),
        };
        if !right {
            wrong.push(format!("{set}: {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let lost = open(&format!("{head} SolveSet s({{x, y}}, {{x - 1.5, x^2 - 2}});"));
    assert!(lost.diagnostics()[0].help[0].contains("`y`"), "{:?}", lost.diagnostics()[0].help);
}
