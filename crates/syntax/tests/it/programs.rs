//! Whole programs: edits of literals, odd shapes, and random programs through the formatter.

use crate::random::RandomText;
use moldloft_diag::FileId;
use moldloft_syntax::sdl::{self, Grouping, Step, StmtKind};

fn parse(text: &str) -> sdl::Program {
    let (program, faults) = sdl::parse(text, FileId(0));
    assert!(faults.is_empty(), "{text}\n{faults:#?}");
    program
}

fn first_fault(text: &str) -> String {
    let (_, faults) = sdl::parse(text, FileId(0));
    faults.first().map_or("none".into(), |fault| fault.id.to_string())
}

#[test]
fn a_direct_edit_changes_one_number_and_nothing_else() {
    let text = "# Ω\nAbsPoint P(15,\t-1.175, 2 ) ; # keep\r\nfloat a = 2^x - 3;\n";
    let mut program = parse(text);
    let values: Vec<f64> = program.literals().iter().map(|literal| literal.value).collect();
    assert_eq!(values, [15.0, -1.175, 2.0, 2.0, 3.0]);
    assert_eq!(program.text_with_edits(), text);
    program.set_literal(sdl::LiteralId(1), 0.5).unwrap();
    program.set_literal(sdl::LiteralId(2), 2.5).unwrap();
    program.set_literal(sdl::LiteralId(0), 16.0).unwrap();
    program.set_literal(sdl::LiteralId(3), -4.0).unwrap();
    program.set_literal(sdl::LiteralId(1), -0.25).unwrap();
    let edited = program.text_with_edits();
    let expected = "# Ω\nAbsPoint P(16,\t-0.25, 2.5 ) ; # keep\r\nfloat a = (-4)^x - 3;\n";
    assert_eq!(edited, expected);
    // The edited tree says the same as its text.
    assert_eq!(program.dump(), parse(&edited).dump());
    // A literal behind a sign of its own keeps its value when that turns negative.
    let mut signed = parse("a = b . -2;");
    signed.set_literal(sdl::LiteralId(0), -3.0).unwrap();
    assert_eq!(signed.text_with_edits(), "a = b . -(-3);");
    let fault = program.set_literal(sdl::LiteralId(0), f64::INFINITY).unwrap_err();
    assert_eq!(fault.id, "not-finite");
    assert_eq!(program.set_literal(sdl::LiteralId(77), 1.0).unwrap_err().id, "unknown-literal");
}

#[test]
fn random_edits_reparse_to_the_same_tree() {
    let mut random = RandomText::new(11);
    for _ in 0..300 {
        let mut program = parse(&random.program(6));
        for _ in 0..5 {
            let count = program.literals().len();
            if count == 0 {
                break;
            }
            let id = sdl::LiteralId(random.below(count) as u32);
            let value = random.number_value();
            program.set_literal(id, value).unwrap();
        }
        let text = program.text_with_edits();
        assert_eq!(program.dump(), parse(&text).dump(), "{}\n{text}", program.text());
    }
}

#[test]
fn random_programs_format_to_the_same_meaning() {
    let mut random = RandomText::new(12);
    for _ in 0..crate::random::rounds(20_000) {
        let text = random.program(8);
        let program = parse(&text);
        let once = sdl::format(&text).unwrap();
        assert_eq!(
            program.dump(),
            parse(&once).dump(),
            "--- source\n{text}\n--- formatted\n{once}"
        );
        let twice = sdl::format(&once).unwrap();
        assert_eq!(once, twice, "--- source\n{text}");
    }
}

#[test]
fn ten_thousand_lines_are_as_many_statements() {
    let mut text = String::from("param float beam = 5.0 in [3, 7];\n");
    for i in 0..10_000 {
        let line = match i % 4 {
            0..2 => {
                format!("AbsPoint P{i}({}.5, 0.9{i:03}*beam, -{}.25);  # a point\n", i % 31, i % 7)
            }
            2 => format!("AbsPoint Q{i}(15.000, 4.815, 2.560);  # another point\n"),
            _ => format!("BCurve C{i}({{P{}, P{}, Q{}}}, degree = 2);\n", i - 3, i - 2, i - 1),
        };
        text.push_str(&line);
    }
    let program = parse(&text);
    assert_eq!(program[program.body()].len(), 10_001);
}

#[test]
fn extreme_shapes_are_refused_or_parsed_in_linear_time() {
    let n = 100_000;
    for (open, close) in [
        ("(", ")"),
        ("{", "}"),
        ("|", "|"),
        ("f(", ")"),
        ("a[", "]"),
        ("-", ""),
        ("!", ""),
        ("a.", ""),
    ] {
        let deep = format!("x = {}1{};", open.repeat(n), close.repeat(n));
        assert_ne!(first_fault(&deep), "none", "{open}");
    }
    for piece in [
        "{", "if (a) ", "else ", "(", ")", "}", ";", "a ", "\"", "| ", "1", ".", "for (", "a(",
        "\n{ a",
    ] {
        let _ = sdl::parse(piece.repeat(n), FileId(0));
        let _ = sdl::format(&piece.repeat(n));
    }
    assert_eq!(first_fault(&format!("x = 1{};", "+1".repeat(900))), "none");
    assert_eq!(first_fault(&format!("x = 1{};", "+1".repeat(2000))), "nesting-too-deep");
    assert_eq!(first_fault(&format!("x = a{};", "-b^c".repeat(20_000))), "nesting-too-deep");
    assert_eq!(first_fault(&format!("x = {{1{}}};", ",1".repeat(n))), "none");
    assert_eq!(first_fault(&format!("{}{}", "{".repeat(150), "}".repeat(150))), "none");
    assert_eq!(first_fault(&format!("{}{}", "{".repeat(300), "}".repeat(300))), "nesting-too-deep");
    let (_, faults) = sdl::parse("a = $;\n".repeat(1000), FileId(0));
    assert_eq!(faults.len(), sdl::MAX_DIAGNOSTICS + 1);
    assert_eq!(faults.last().unwrap().id, "too-many-errors");
}

#[test]
fn chains_group_as_asked() {
    let program = parse("t = -a - b^c * d;");
    let StmtKind::Assign { value, .. } = program[program[program.body()][0]].kind else { panic!() };
    let sdl::ExprKind::Chain(chain) = program[value].kind else { panic!("{}", program.dump()) };
    let words = |grouping| -> String {
        let steps = program.grouped(chain, grouping);
        let words = steps.iter().map(|step| match step {
            Step::Push(operand) => program.name(program.as_name(*operand).unwrap()).to_owned(),
            Step::Unary(op, _) => format!("u{}", op.spelling()),
            Step::Binary(op, _) => op.spelling().to_owned(),
        });
        words.collect::<Vec<_>>().join(" ")
    };
    assert_eq!(words(Grouping::Numbers), "a u- b c ^ d * -");
    assert_eq!(words(Grouping::Sets), "a u- b - c d * ^");
}

#[test]
fn one_expression() {
    let (program, expr, faults) = sdl::parse_expr("hull(0.5, .25) . {1,0,0}", FileId(0));
    assert!(faults.is_empty());
    assert_eq!(program.dump_of(expr), "(. (call hull 0.5 0.25) (list 1.0i 0.0i 0.0i))");
    for text in ["", "a b", "1 +", "f(", "a;"] {
        let (program, expr, faults) = sdl::parse_expr(text, FileId(0));
        assert_eq!(faults.len(), 1, "{text}");
        assert!(matches!(program[expr].kind, sdl::ExprKind::Error));
    }
}

#[test]
fn places_of_members_and_statements() {
    let program = parse("  a = fore.leg.x; b = 2;");
    let stmts = &program[program.body()];
    assert_eq!(program.slice(program[stmts[0]].span), "a = fore.leg.x;");
    assert_eq!(program.slice(program[stmts[1]].span), "b = 2;");
    let StmtKind::Assign { value, .. } = program[stmts[0]].kind else { panic!() };
    assert_eq!(program.slice(program[value].span), "fore.leg.x");
    let sdl::ExprKind::Member { base, or_dot: false, .. } = program[value].kind else { panic!() };
    assert_eq!(program.slice(program.member_span(base)), "leg");
}

#[test]
fn lists_records_and_defaults() {
    let text = "record rib { float chord = 1; farray y[3]; }\nrecord wing { float span; rib ribs[2], more[]; }\n\
                curve lines[4][60], other[4][], open[] = {a, b};\nsurface parts[6];\n\
                function surface[] halves(surface s[], float at = 2*x, wing w = wing(span = 3)) {\n    return s;\n}\n";
    let (program, faults) = sdl::parse(text, FileId(0));
    assert!(faults.is_empty(), "{faults:#?}");
    let dump = program.dump();
    for part in [
        "(record rib (declare Float (chord [ ] 1.0i)) (declare Farray (y [ 3.0i ])))",
        "(declare rib (ribs [ 2.0i ]) (more [] [ ]))",
        "(lines [ 4.0i ] [ 60.0i ]) (other [ 4.0i ] [ ]) (open [] [ ] (list a b))",
        "(function Surface[] halves ( ( Surface[] s) ( Float at (* 2.0i x)) ( wing w (call wing span=3.0i)))",
    ] {
        assert!(dump.contains(part), "{part}\n{dump}");
    }
    assert_eq!(
        sdl::format(text).unwrap(),
        text.replace("{ float", "{\n    float")
            .replace("; farray", ";\n    farray")
            .replace("; rib", ";\n    rib")
            .replace("; }", ";\n}")
            .replace("2*x", "2 * x")
    );
    for (text, id) in [
        ("function float f(float a = 1, float b) { return a; }", "misplaced-default"),
        ("subroutine f(returned curve c = 1) {}", "misplaced-default"),
        ("subroutine f(int a[]) {}", "wrong-type"),
        ("subroutine f(float x) { if (x > 0) { curve x[3]; } }", "duplicate-name"),
        ("record a { float x; int x; }", "duplicate-name"),
        ("record a { print 1; }", "misplaced-statement"),
        ("if (1) { record a { float x; } }", "misplaced-record"),
    ] {
        let (_, faults) = sdl::parse(text, FileId(0));
        assert!(faults.iter().any(|fault| fault.id == id), "{text}: {faults:#?}");
    }
}

#[test]
fn habits_of_other_languages_are_explained() {
    for (text, help) in [
        ("x = 1; // one", "begin with `#`"),
        ("i++;", "`i += 1`"),
        ("x = a ** 2;", "`a^b`"),
        ("x = a ? 1 : 2;", "where(condition, a, b)"),
        ("for (int i = 1; i < 3; i += 1) {}", "`for (i = 1:n)`"),
        ("if x > 1 { y = 2; }", "parentheses"),
        ("def f(x) { return x; }", "function float f"),
        ("if (x) {} elif (y) {}", "else if"),
        ("farray q = [1, 2, 3];", "in braces"),
        ("for (i in a) { x = 1; }", "foreach (x in list)"),
        ("foreach x in a { y = 1; }", "foreach (x in list)"),
        ("switch (x) { y = 1; }", "else if"),
    ] {
        let (_, faults) = sdl::parse(text, FileId(0));
        let said = format!("{faults:?}");
        assert!(said.contains(help), "{text}: {said}");
    }
}
