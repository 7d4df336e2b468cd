//! The canonical text of model files is a fixed point, for any blanks and line ends.

use moldloft_diag::FileId;
use moldloft_syntax::model_file;
use moldloft_testing::Random;

const PARTS: [&str; 18] = [
    "# note",
    "#",
    "# a: b",
    "Rem a hull",
    "rem",
    "Units: m kg",
    "Symmetry: y",
    "Places:",
    "AbsPoint P 14 1 0 .5 3;",
    "BCurve C 1 1 { P Q } A:Note(a b);",
    ";",
    "# BeginModel;",
    "#x Units: m",
    "Rem\tx",
    "# \u{a0}",
    "#\u{b}y",
    "",
    "A P 1 1 ( 2 );",
];

const BLANKS: [&str; 14] = [
    "\n",
    "\n",
    "\n",
    "\r\n",
    "\r",
    "\r\r\n",
    "\n\r\n",
    " ",
    "\n\u{a0}",
    "\r\u{c}",
    "\t\n",
    "\n\u{c}",
    "\n\u{b}\n",
    "\n\n\n",
];

const BITS: [&str; 15] = [
    "\r", "\r", "\n", "#", "rem ", " ", "\u{b}", "\u{c}", "\u{a0}", ":", ";", "x", "\t", "Rem\r",
    "\u{feff}",
];

const WHOLE: &str = "MultiSurf 1.44 y\n# made by hand\nUnits: m kg\nRem more\nSymmetry: x y\n\n# last\nBeginModel;\n\
    # items\nCLoftSurf hull 2 1 36x4 A:Note(a (b) c) / * 3 { MC1\n MC2 } =beam [2*b] *X=0 ( P 1.5 );\nRem end\n\
    Variable b 3 1 5;\nEndModel;\n";

#[test]
fn canonical_text_is_its_own() {
    let cases = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 3_000_000 } else { 60_000 };
    let mut random = Random::new(19);
    let mut sound = 0;
    for case in 0..cases {
        let mut text = String::new();
        let mut add = |random: &mut Random, part: &str| {
            text += part;
            text += *random.pick(&BLANKS);
        };
        for begins in [0, 1, 2] {
            for _ in 0..random.below(5) {
                let part = *random.pick(&PARTS);
                add(&mut random, part);
            }
            match begins {
                0 => add(&mut random, "MultiSurf 1.44"),
                1 if random.chance(60) => add(&mut random, "BeginModel;"),
                1 => {}
                _ => add(&mut random, "EndModel"),
            }
        }
        if case % 2 == 0 {
            text = WHOLE.into();
            for _ in 0..1 + random.below(5) {
                let mut at = random.below(text.len() + 1);
                while !text.is_char_boundary(at) {
                    at -= 1;
                }
                match random.below(4) {
                    0 if at < text.len() && text.is_char_boundary(at + 1) => drop(text.remove(at)),
                    _ => {
                        text.insert_str(at, random.pick::<&str>(&BITS));
                    }
                }
            }
        }
        let (model, faults) = model_file::parse(text.as_str(), FileId(0));
        if !faults.is_empty() {
            continue;
        }
        sound += 1;
        let canonical = model.to_canonical(|_| false);
        let (again, faults) = model_file::parse(canonical.as_str(), FileId(0));
        assert!(faults.is_empty(), "{text:?} became {canonical:?}: {faults:?}");
        assert_eq!(again.to_canonical(|_| false), canonical, "of {text:?}");
    }
    assert!(sound > cases / 50, "{sound} of {cases} texts have no faults");
}

/// All heads of a few words and blanks, before `BeginModel` and without it.
#[test]
fn canonical_heads_are_their_own() {
    const WORDS: [&str; 9] = ["#", "\r", "\n", "x", "Rem", "X:", "\u{b}", " ", ";"];
    let longest = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 6 } else { 4 };
    for length in 1..=longest {
        for mut number in 0..WORDS.len().pow(length) {
            let mut head = String::new();
            for _ in 0..length {
                head += WORDS[number % WORDS.len()];
                number /= WORDS.len();
            }
            for (before, after) in [
                ("MultiSurf 1\n", "\nBeginModel;\nEndModel;\n"),
                ("MultiSurf 1\n", "BeginModel;\nEndModel;\n"),
                ("MultiSurf 1", "\nEndModel;\n"),
                ("", "MultiSurf 1\nBeginModel;\nEndModel;\n"),
                ("MultiSurf 1\nBeginModel;\n", "\nEndModel;\n"),
            ] {
                let text = format!("{before}{head}{after}");
                let (model, faults) = model_file::parse(text.as_str(), FileId(0));
                if !faults.is_empty() {
                    continue;
                }
                let canonical = model.to_canonical(|_| false);
                let (again, faults) = model_file::parse(canonical.as_str(), FileId(0));
                assert!(faults.is_empty(), "{text:?} became {canonical:?}: {faults:?}");
                assert_eq!(again.to_canonical(|_| false), canonical, "of {text:?}");
            }
        }
    }
}
