//! Damaged programs: none panics, none hangs, and the model that went through them all equals one
//! opened from the last text.

use crate::common::{Random, ids, open, reported, rounds};
use moldloft_registry::Value;
use std::path::Path;

/// The words of all texts of the corpus, and the texts.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus/run");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .expect("the corpus is part of the repository")
        .map(|e| e.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "sdl"))
        .collect();
    paths.sort();
    let mut cases = Vec::new();
    for path in paths {
        let text = std::fs::read_to_string(path).expect("a readable file");
        for case in text.split("#### ").skip(1) {
            let lines = case.lines().skip(1).filter(|line| !line.starts_with('#'));
            cases.push(lines.collect::<Vec<_>>().join("\n"));
        }
    }
    cases
}

fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() || c == '_' {
            word.push(c);
        } else {
            words.push(std::mem::take(&mut word));
            words.push(c.to_string());
        }
    }
    words.push(word);
    words
}

#[test]
fn damaged_programs_neither_panic_nor_hang() {
    let mut random = Random::new(11);
    let cases = corpus();
    let extra = [
        "1e9",
        "-1",
        "0",
        "1/0",
        "\"\"",
        "{",
        "}",
        "(",
        ")",
        ";",
        "[",
        "]",
        ".x",
        "for (i = 1:3)",
        "A",
        "P",
    ];
    let mut document = open("");
    for round in 0..rounds(4_000) {
        let mut text = random.pick(&cases).clone();
        if random.chance(30) {
            text += "\n";
            text += random.pick::<String>(&cases).as_str();
        }
        let mut words = words(&text);
        for _ in 0..1 + random.below(6) {
            let (at, other) = (random.below(words.len()), random.below(words.len()));
            match random.below(5) {
                0 => drop(words.remove(at)),
                1 => words.swap(at, other),
                2 => words.insert(at, random.pick(&extra).to_string()),
                3 => words[at] = random.pick(&extra).to_string(),
                _ => words[at] = words[other].clone(),
            }
            if words.is_empty() {
                words.push(String::new());
            }
        }
        let text = words.concat();
        document.set_text(&text);
        let _ = document.panelled();
        assert!(!ids(&document).iter().any(|id| id == "internal-error"), "round {round}\n{text}");
        let mut again = open(&text);
        assert_eq!(reported(&document), reported(&again), "round {round}\n{text}");
        assert_eq!(document.printed(), again.printed(), "round {round}\n{text}");
        let names = |d: &moldloft_document::Document| {
            d.graph().objects().map(|o| o.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names(&document), names(&again), "round {round}\n{text}");
        for object in again.graph().objects().filter(|o| o.value().is_some()).take(3) {
            // What has a value can be asked for.
            let name = object.name.to_string();
            if name.chars().all(|c| c.is_ascii_alphanumeric()) {
                assert!(document.eval(&name).is_ok(), "round {round}: {name}\n{text}");
            }
        }
        if let Ok(Value::Number(x)) = again.eval("mesh.area") {
            assert!(x >= 0.0 || x.is_nan(), "round {round}: {x}\n{text}");
        }
    }
}
