//! Damaged texts: the parsers neither panic nor hang, and print accepted texts faithfully.
//!
//! Two per cent of a long run by default; all of it with `MOLDLOFT_SOAK=1`.

use crate::random::{RandomText, rounds};
use moldloft_diag::{FileId, Sources, render};
use moldloft_syntax::{model_file, sdl};

const PIECES: [&str; 60] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "|",
    "||",
    ";",
    ",",
    ":",
    ".",
    ".*",
    "...",
    "=",
    "==",
    "+=",
    "^",
    "&",
    "&&",
    "!",
    "-",
    "#",
    "\n",
    "\r\n",
    "\t",
    "\"",
    "\\",
    "é",
    "\u{feff}",
    "$",
    "if",
    "else",
    "for",
    "while",
    "foreach",
    "in",
    "param",
    "load",
    "subroutine",
    "function",
    "returned",
    "return",
    "global",
    "float",
    "curve",
    "set",
    "field",
    "assert",
    "not",
    "1",
    ".5",
    "1e999",
    "2.",
    "a.x",
    "a.b",
    "A:b(",
    "Rem ",
    "EndModel",
    "*",
];

fn damage(text: &str, random: &mut RandomText) -> String {
    let mut text = text.to_owned();
    for _ in 0..=random.below(6) {
        let at = floor(&text, random.below(text.len() + 1));
        let to = floor(&text, (at + random.below(12)).min(text.len()));
        match random.below(4) {
            0 => text.replace_range(at..to, ""),
            1 => text.insert_str(at, random.pick(&PIECES)),
            2 => text.replace_range(at..to, random.pick(&PIECES)),
            _ => {
                let from = floor(&text, random.below(text.len() + 1));
                let copy = text[from..floor(&text, (from + 20).min(text.len()))].to_owned();
                text.insert_str(at, &copy);
            }
        }
    }
    if random.below(20) == 0 {
        let end = floor(&text, random.below(text.len() + 1));
        text.truncate(end);
    }
    text
}

fn floor(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[test]
fn damaged_programs() {
    let mut random = RandomText::new(21);
    for _ in 0..rounds(100_000) {
        let text = random.program(5);
        let text = damage(&text, &mut random);
        let (program, faults) = sdl::parse(text.as_str(), FileId(0));
        let mut sources = Sources::new();
        sources.add("a.sdl", text.as_str());
        for fault in &faults {
            assert!(fault.span().range().end <= text.len(), "{fault} in\n{text}");
            assert!(!render(fault, &sources).is_empty());
        }
        let has_error_node = program.dump().contains("(error)");
        assert!(!has_error_node || !faults.is_empty(), "a fault was not reported in\n{text}");
        if let Ok(once) = sdl::format(&text) {
            let (again, faults) = sdl::parse(once.as_str(), FileId(0));
            assert!(faults.is_empty(), "{faults:?}\n--- source\n{text}\n--- formatted\n{once}");
            assert_eq!(program.dump(), again.dump(), "--- source\n{text}\n--- formatted\n{once}");
            assert_eq!(sdl::format(&once).as_ref(), Ok(&once), "--- source\n{text}");
        }
    }
}

#[test]
fn damaged_model_files() {
    let model = "MultiSurf 1.44 /y\nUnits: m kg\nBeginModel;\nRem a hull\nAbsPoint P11 14 1 0.000 0.5 3.600;\n\
        BCurve MC1 11 1 8x4 A:Layer(2) / * 2 { P11 P12 (P13 1.5) };\n# note\nVariable beam 5 3 7;\n\
        CLoftSurf hull 10 1 10 1 20 1 0 3 { MC1 MC2 } =beam [2*beam] \"text\" *X=0;\nEndModel;\n";
    let mut random = RandomText::new(22);
    for _ in 0..rounds(200_000) {
        let text = damage(model, &mut random);
        let (parsed, faults) = model_file::parse(text.as_str(), FileId(0));
        for fault in &faults {
            assert!(fault.span().range().end <= text.len(), "{fault} in\n{text}");
        }
        assert_eq!(parsed.text_with_edits(), text);
        let _ = parsed.to_canonical(|_| true);
        if faults.is_empty() {
            let once = parsed.to_canonical(|_| false);
            let (again, faults) = model_file::parse(once.as_str(), FileId(0));
            assert!(faults.is_empty(), "{faults:?}\n--- source\n{text}\n--- canonical\n{once}");
            assert_eq!(again.to_canonical(|_| false), once, "--- source\n{text}");
            let counts = (again.objects().count(), parsed.objects().count());
            assert_eq!(counts.0, counts.1, "--- source\n{text}\n--- canonical\n{once}");
        }
    }
}

#[test]
fn each_single_character_is_read_and_a_form_feed_is_a_blank() {
    for c in (0..=0x2fff).filter_map(char::from_u32) {
        for text in [c.to_string(), format!("{c}{c}"), format!("float a{c}= 1;{c}\n")] {
            let (program, _) = moldloft_syntax::sdl::parse(text.as_str(), moldloft_diag::FileId(0));
            assert_eq!(program.text_with_edits(), text);
            let _ = moldloft_syntax::sdl::format(&text);
            let (_, _) =
                moldloft_syntax::model_file::parse(text.as_str(), moldloft_diag::FileId(0));
        }
    }
    let pages = "float a = 1;\n\x0c\nfloat b = 2;\n";
    assert_eq!(moldloft_syntax::sdl::format(pages).unwrap(), "float a = 1;\n\nfloat b = 2;\n");
}
