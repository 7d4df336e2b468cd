//! Words, numbers and continuations of command lines.

use moldloft_sketch::command::words::{continued, feet_and_inches, number, parse};

fn words(line: &str) -> Vec<String> {
    let commands = parse(line, None).commands;
    commands[0].as_ref().unwrap().tokens.iter().map(|t| t.text.clone()).collect()
}

#[test]
fn delimiters_and_quotes() {
    assert_eq!(
        words("DIM W1 X 1 3=16"),
        words("dim w1,x,1,3,16")
            .iter()
            .zip(["DIM", "W1", "X", "1", "3", "16"])
            .map(|(_, b)| b.to_owned())
            .collect::<Vec<_>>()
    );
    assert_eq!(words("us,wall"), ["us", "wall"]);
    assert_eq!(words("SAVE \"my file.skt\" ! x"), ["SAVE", "my file.skt"]);
    let two = parse("POINT 1 0 0; POINT 2 'a;b' # c", None);
    assert_eq!(two.commands.len(), 2);
    assert_eq!(two.commands[1].as_ref().unwrap().tokens[2].text, "a;b");
    assert_eq!(continued("LINE 1 & ! more"), Some("LINE 1 "));
    assert_eq!(continued("LINE '1 &"), None);
    let long = format!("{}zz", "a".repeat(32));
    let cut = parse(&long, Some(32)).commands;
    assert_eq!(cut[0].as_ref().unwrap().tokens[0].text.len(), 32);
}

#[test]
fn numbers_and_their_faults() {
    for (text, value, unit) in [
        ("12", 12.0, None),
        ("-.5", -0.5, None),
        ("1e-3", 1e-3, None),
        ("6.5ft", 6.5, Some("FT")),
        ("2M", 2.0, Some("M")),
    ] {
        assert_eq!(number(text).unwrap(), (value, unit.map(str::to_owned)), "{text}");
    }
    for (text, says) in [
        ("1.2.3", "two decimal points in 1.2.3"),
        ("12-3", "misplaced hyphen in 12-3"),
        ("1A2", "letter A inside the number 1A2"),
        ("--1", "misplaced hyphen"),
        ("1e999", "too large"),
        ("7%", "`%` inside"),
    ] {
        let fault = number(text).unwrap_err();
        assert!(fault.text.contains(says), "{}", fault.text);
    }
    assert!(parse("SAVE \"x", None).commands[0].as_ref().unwrap_err().text.contains("no partner"));
    assert_eq!(feet_and_inches("3'-6"), Some(3.5));
    assert_eq!(feet_and_inches("3'6\""), Some(3.5));
    assert_eq!(feet_and_inches("2*W1"), None);
}
