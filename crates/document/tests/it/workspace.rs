//! Renames in random programs of several files: the language is the oracle. After a rename every program runs as before,
//! prints the same, and the old name is found nowhere where it meant the same.

use moldloft_document::{Document, Workspace, registry};
use moldloft_lang::{ReadText, TextReadError, World};
use moldloft_testing::{Random, rounds};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Few names, so that the same is declared in several files, and locally as well as globally.
const NAMES: [&str; 6] = ["a", "b", "beam", "c", "draft", "x"];

fn name(random: &mut Random) -> &'static str {
    NAMES[random.below(NAMES.len())]
}

/// The text of file `k`, which may load and insert earlier files.
fn file(random: &mut Random, k: usize) -> String {
    let mut text = String::new();
    let mut known: Vec<&str> = Vec::new();
    for earlier in 0..k {
        if random.chance(35) {
            writeln!(text, "load \"file{earlier}.sdl\"").unwrap();
        }
    }
    for _ in 0..1 + random.below(3) {
        let new = name(random);
        match known.first() {
            Some(old) if random.chance(50) => {
                writeln!(text, "float {new}{k} = {old} + {};", random.below(9)).unwrap();
                writeln!(text, "print {new}{k};").unwrap();
            }
            _ => {
                writeln!(text, "param float {new} = {};", 1 + random.below(9)).unwrap();
                known.push(new);
            }
        }
    }
    // A routine whose arguments and variables are called as what is outside.
    let (one, two, own) = (name(random), name(random), name(random));
    let outer = known.first().map_or("1", |n| *n);
    if one != two && own != one && own != two {
        let used = if [one, two, own].contains(&outer) { "2" } else { outer };
        writeln!(
            text,
            "function float f{k}(float {one}, float {two}) {{ float {own} = {one} - {two}; return {own}*{used}; }}"
        )
        .unwrap();
        writeln!(text, "print f{k}({}, {two} = {outer});", random.below(9)).unwrap();
        writeln!(text, "print f{k}({two} = 3, {one} = f{k}(1, 2));").unwrap();
    }
    writeln!(text, "for (i{k} = 1:3) {{ print i{k}*{outer}; }}").unwrap();
    if k > 0 && random.chance(50) {
        let part = random.below(k);
        writeln!(text, "AbsPoint P{k}(0, {outer}, 0); Component part{k}(\"part{part}.sdl\", root = P{k}, {} = 7);", NAMES[part % 6]).unwrap();
        writeln!(text, "print part{k}.tip.x, part{k}.{};", NAMES[part % 6]).unwrap();
    }
    text
}

/// A file that is inserted.
fn part(k: usize) -> String {
    let own = NAMES[k % 6];
    format!(
        "param float {own} = 2;\nAbsPoint root(0, 0, 0);\nRelPoint tip(root, {own}, {own}, 0);\n"
    )
}

type Texts = BTreeMap<String, String>;

struct Shown(Texts);

impl World for Shown {
    fn read(&self, path: &str, _: Option<&str>) -> Result<ReadText, TextReadError> {
        let text = self.0.get(path);
        text.map(|text| ReadText { name: path.into(), bytes: text.as_bytes().into() })
            .ok_or_else(|| TextReadError { message: format!("unknown file `{path}`"), help: None })
    }
}

/// What each program prints and reports, names aside.
fn outcomes(texts: &Texts) -> Vec<(String, Vec<String>)> {
    let world = || Box::new(Shown(texts.clone()));
    let run = |file: &String| {
        let document = Document::open(registry(), world(), file);
        let found = document.diagnostics();
        (document.printed().concat(), found.iter().map(|d| d.id.to_string()).collect())
    };
    texts.keys().map(run).collect()
}

fn workspace(texts: &Texts) -> Workspace {
    let mut all = Workspace::default();
    for (file, text) in texts {
        all.set(file, text, |path| texts.contains_key(path).then(|| path.to_string()));
    }
    all
}

#[test]
fn programs_of_several_files_run_as_before_after_a_rename() {
    let (mut renamed, mut over_files, mut refused) = (0, 0, 0);
    for seed in 0..rounds(60, 5_000) as u64 {
        let random = &mut Random::new(seed);
        let mut texts = Texts::new();
        for k in 0..2 + random.below(4) {
            texts.insert(format!("file{k}.sdl"), file(random, k));
            texts.insert(format!("part{k}.sdl"), part(k));
        }
        let before = outcomes(&texts);
        for _ in 0..4 {
            let names: Vec<&String> = texts.keys().collect();
            let home = (*random.pick(&names)).clone();
            let offset = random.below(texts[&home].len()) as u32;
            let all = workspace(&texts);
            let reserved = |name: &str| registry().get(name).is_some();
            let Ok(places) = all.renamed(&home, offset, "fresh_name", reserved) else {
                refused += 1;
                continue;
            };
            let mut new = texts.clone();
            for (file, start, end) in places.iter().rev() {
                let text = new.get_mut(file).unwrap();
                text.replace_range(*start as usize..*end as usize, "fresh_name");
            }
            renamed += 1;
            over_files += usize::from(places.iter().any(|p| p.0 != places[0].0));
            assert_eq!(
                outcomes(&new),
                before,
                "seed {seed}: {home} at {offset}\n{texts:#?}\n{new:#?}"
            );
            // There and back again.
            let again = workspace(&new);
            let (file, start, _) = &places[0];
            let old = &texts[file][*start as usize..places[0].2 as usize];
            let back = again.references(file, *start);
            assert_eq!(back.len(), places.len(), "seed {seed}: `{old}` in {file}");
        }
    }
    assert!(renamed > refused / 4 && over_files > renamed / 10, "{renamed} {over_files} {refused}");
}
