//! The call around an offset and the parts that fold, in incomplete texts.

use moldloft_syntax::sdl::{call_around, folds, text_around};

/// `|` marks the offset; returns callee, argument, name.
#[track_caller]
fn call(text: &str) -> Option<(String, usize, Option<String>)> {
    let at = text.find('|').expect("the place") as u32;
    let call = call_around(&text.replacen('|', "", 1), at)?;
    Some((call.callee, call.argument, call.name))
}

fn found(
    callee: &str,
    argument: usize,
    name: Option<&str>,
) -> Option<(String, usize, Option<String>)> {
    Some((callee.into(), argument, name.map(Into::into)))
}

#[test]
fn the_call_around_a_place_is_the_innermost_that_is_open() {
    assert_eq!(call("AbsPoint P(|"), found("AbsPoint", 0, None));
    assert_eq!(call("AbsPoint P(1, |"), found("AbsPoint", 1, None));
    assert_eq!(call("AbsPoint P(1, sin(2|), 3);"), found("sin", 0, None));
    assert_eq!(call("AbsPoint P(1, sin(2), |3);"), found("AbsPoint", 2, None));
    assert_eq!(call("BCurve c({A, B|}, degree = 2);"), found("BCurve", 0, None));
    assert_eq!(call("BCurve c({A, B}, degree = |"), found("BCurve", 1, Some("degree")));
    assert_eq!(call("BCurve c({A, B}, degree = 2, |"), found("BCurve", 2, None));
    assert_eq!(call("a = arc(c, 0, |\nfloat b;"), found("arc", 2, None));
    // Behind its statement nothing is open, closed or not.
    assert_eq!(call("a = arc(c, 0;\nfloat b|;"), None);
    assert_eq!(call("a = arc(c, 0); float b|;"), None);
    // Definitions and conditions are no calls.
    assert_eq!(call("subroutine arc(|float a) {}"), None);
    assert_eq!(call("function float half(float a|) { return a/2; }"), None);
    assert_eq!(call("for (i = 0; i < |10; i += 1) {}"), None);
    assert_eq!(call("while (x < cos(|"), found("cos", 0, None));
    assert_eq!(call("for (i = 0; i < cos(|"), found("cos", 0, None));
    // Brackets in texts and comments do not count; neither do those that nothing opened.
    assert_eq!(call("f(\")\", |"), found("f", 1, None));
    assert_eq!(call("f( # a comment )\n |"), found("f", 0, None));
    assert_eq!(call("f(1], |"), found("f", 1, None));
    assert_eq!(call("|"), None);
}

#[test]
fn a_place_inside_of_a_text_is_known_closed_or_not() {
    for (text, inside) in [
        ("Model m(units = \"|", true),
        ("Model m(units = \"f|t\")", true),
        ("Model m(units = |\"ft\")", false),
        ("Model m(units = \"ft\"|)", false),
        ("Model m(units = \"ft|\nfloat a;", true),
        ("Model m(units = \"ft\\\"|\");", true),
    ] {
        let at = text.find('|').unwrap() as u32;
        let text = text.replacen('|', "", 1);
        let found = text_around(&text, at);
        assert_eq!(found, inside.then(|| text.find('"').unwrap() as u32 + 1), "{text}");
        assert_eq!(call_around(&text, at).unwrap().callee, "Model");
    }
}

#[test]
fn brackets_and_comments_over_several_lines_fold() {
    let text = "# one\n# two\n\n# alone\nsubroutine f(float a)\n{\n  if (a) { a = 1; }\n}\nx = {1,\n 2}; # behind\n# lead\n# er";
    let lines = |at: u32| text[..at as usize].matches('\n').count();
    let found: Vec<_> =
        folds(text).into_iter().map(|f| (lines(f.start), lines(f.end), f.comment)).collect();
    assert_eq!(found, [(0, 1, true), (5, 7, false), (8, 9, false), (10, 11, true)]);
    assert!(folds("").is_empty() && folds("}}}(((").is_empty());
}
