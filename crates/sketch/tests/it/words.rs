//! Words, numbers and continuations of command lines.

use moldloft_sketch::command::words::{continued, feet_and_inches, number, parse, text_commands};
use moldloft_testing::{Random, rounds};

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

/// Commands written with any delimiters, quotes, comments and line ends are found where they are.
#[test]
fn commands_of_a_text_have_their_places() {
    let mut random = Random::new(7);
    for round in 0..rounds(200, 20_000) {
        let (mut text, mut wanted) = (String::new(), Vec::new());
        for _ in 0..random.below(9) {
            let mut tokens = Vec::new();
            let words = [
                ("POI", "POINT"),
                ("line", "LINE"),
                ("DIMENSION", "DIMENSION"),
                ("\u{1f6a4}", ""),
                ("12", ""),
            ];
            let (word, verb) = *random.pick(&words);
            let readable = !word.starts_with('\u{1f6a4}');
            let mut put = |text: &mut String, written: &str| {
                let start = text.len();
                text.push_str(written);
                tokens.push((written.trim_matches(['"', '\'']).to_owned(), start..text.len()));
            };
            put(&mut text, word);
            for _ in 0..random.below(5) {
                text.push_str(random.pick::<&str>(&[
                    " ",
                    ", ",
                    "=",
                    "\t",
                    " & ! more\n",
                    "  &\r\n",
                ]));
                put(
                    &mut text,
                    random.pick::<&str>(&["1", "-2.5", "w1", "\"a; ! b\"", "'\u{e9} &'"]),
                );
            }
            text.push_str(random.pick::<&str>(&["", " ", "\t"]));
            let end = *random.pick::<&str>(&["; ", ";", "\n", "\r\n", " ! \"x; y\n", "#\u{e9};\n"]);
            let last = !end.starts_with(';');
            text.push_str(end);
            if readable {
                wanted.push((verb, tokens, last));
            }
        }
        let found = text_commands(&text);
        assert_eq!(found.len(), wanted.len(), "round {round}: {text:?}");
        for (k, (found, (verb, tokens, last))) in found.iter().zip(&wanted).enumerate() {
            assert_eq!(found.verb.unwrap_or(""), *verb, "round {round}: {text:?}");
            let spans: Vec<_> =
                found.tokens.iter().map(|(t, s)| (t.text.clone(), s.clone())).collect();
            assert_eq!(spans, *tokens, "round {round}: {text:?}");
            // After a `;` at the end of a text there is no command that could be the last one.
            if k + 1 < wanted.len() {
                assert_eq!(found.last, *last, "round {round}: {text:?}");
            }
        }
    }
}
