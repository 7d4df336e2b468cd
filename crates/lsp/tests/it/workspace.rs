//! Names over several files: open and saved, loaded and inserted.

use crate::client::Client;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

struct Folder(PathBuf);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("moldloft-workspace-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        let folder = Self(path.canonicalize().unwrap());
        for (name, text) in files {
            let path = folder.0.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}/{name}", self.0.display())
    }

    fn client(&self) -> Client {
        let uri = format!("file://{}", self.0.display());
        Client::start_in(json!({
            "capabilities": {},
            "workspaceFolders": [{"uri": uri, "name": "models"}],
        }))
    }

    /// A list of locations as `file:line:character`.
    fn places(&self, found: &Value) -> Vec<String> {
        let one = |l: &Value| {
            let name = l["uri"].as_str().unwrap().rsplit('/').next().unwrap();
            let at = &l["range"]["start"];
            format!("{name}:{}:{}", at["line"], at["character"])
        };
        let mut all: Vec<String> = found.as_array().unwrap().iter().map(one).collect();
        all.sort();
        all
    }

    fn rename(&self, client: &mut Client, name: &str, place: (u64, u64), new: &str) -> Value {
        let place = json!({"line": place.0, "character": place.1});
        let id = json!({"uri": self.uri(name)});
        let ask = json!({"textDocument": id, "position": place, "newName": new});
        client.answer("textDocument/rename", ask)
    }

    /// The texts after a rename.
    fn renamed(&self, answer: &Value, texts: &[(&str, &str)]) -> BTreeMap<String, String> {
        let mut new: BTreeMap<String, String> =
            texts.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect();
        let changes = answer["result"]["changes"].as_object().unwrap_or_else(|| panic!("{answer}"));
        for (uri, edits) in changes {
            let name = uri.strip_prefix(&self.uri("")).unwrap();
            let text = new.get_mut(name).unwrap();
            let at = |text: &str, place: &Value| {
                let line = place["line"].as_u64().unwrap() as usize;
                let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
                start + place["character"].as_u64().unwrap() as usize
            };
            let mut edits: Vec<&Value> = edits.as_array().unwrap().iter().collect();
            edits.sort_by_key(|e| std::cmp::Reverse(at(text, &e["range"]["start"])));
            for edit in edits {
                let range = at(text, &edit["range"]["start"])..at(text, &edit["range"]["end"]);
                text.replace_range(range, edit["newText"].as_str().unwrap());
            }
        }
        new
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const FILES: [(&str, &str); 5] = [
    (
        "lib/foil.sdl",
        "float chord = 1;\nfunction float lift(float alpha, float area) { return alpha*area*chord; }\n",
    ),
    ("wing.sdl", "load \"lib/foil.sdl\"\nfloat l = lift(2, area = 3);\nchord = 2;\n"),
    ("tail.sdl", "load \"lib/foil.sdl\"\nfloat l = lift(1, 1);\n"),
    ("other.sdl", "float chord = 7;\nfloat lift = chord;\n"),
    (
        "boat.sdl",
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); Line hull(A, B);\nComponent keel(\"keel.sdl\", root = hull, span = 3);\nRelPoint bulb(keel.tip, 0, 0, -0.5);\n",
    ),
];
const KEEL: (&str, &str) = (
    "keel.sdl",
    "param float span = 2 in [0.5, 4];\nAbsPoint K1(0, 0, 0); AbsPoint K2(1, 0, 0); Line root(K1, K2);\nAbsBead fore(root, 0.25); RelPoint tip(fore, 0, 0, -span);\n",
);

fn all() -> Vec<(&'static str, &'static str)> {
    FILES.into_iter().chain([KEEL]).collect()
}

#[test]
fn references_and_definitions_go_over_files() {
    let folder = Folder::new(&all());
    let mut client = folder.client();
    let wing = folder.uri("wing.sdl");
    assert_eq!(client.open_of(&wing, FILES[1].1), Vec::<Value>::new());
    let ask = |line: u64, character: u64| {
        json!({"textDocument": {"uri": wing}, "position": {"line": line, "character": character},
               "context": {"includeDeclaration": true}})
    };
    // A function of a file that is loaded: all who load it, and nobody else.
    let found = client.ask("textDocument/references", ask(1, 11));
    assert_eq!(folder.places(&found), ["foil.sdl:1:15", "tail.sdl:1:10", "wing.sdl:1:10"]);
    let found = client.ask("textDocument/references", ask(2, 0));
    assert_eq!(folder.places(&found), ["foil.sdl:0:6", "foil.sdl:1:65", "wing.sdl:2:0"]);
    // A name of this file alone, though another has the same.
    let found = client.ask("textDocument/references", ask(1, 6));
    assert_eq!(folder.places(&found), ["wing.sdl:1:6"]);
    let there = client.ask("textDocument/definition", ask(2, 1));
    assert_eq!(folder.places(&json!([there])), ["foil.sdl:0:6"]);
    // The label of an argument is the argument's name.
    let there = client.ask("textDocument/definition", ask(1, 19));
    assert_eq!(folder.places(&json!([there])), ["foil.sdl:1:39"]);
    let found = client.ask("workspace/symbol", json!({"query": "LIF"}));
    let names: Vec<String> = found
        .as_array()
        .unwrap()
        .iter()
        .map(|s| {
            format!("{} {}", s["name"].as_str().unwrap(), folder.places(&json!([s["location"]]))[0])
        })
        .collect();
    assert_eq!(names, ["lift foil.sdl:1:15", "lift other.sdl:1:6"]);
}

#[test]
fn a_rename_changes_all_files_and_they_run_as_before() {
    let folder = Folder::new(&all());
    let mut client = folder.client();
    let texts = all();
    for (name, text) in &texts {
        assert_eq!(client.open_of(&folder.uri(name), text), Vec::<Value>::new(), "{name}");
    }
    let cases = [
        ("wing.sdl", (2, 2), "width", vec!["lib/foil.sdl", "wing.sdl"]),
        ("lib/foil.sdl", (1, 17), "force", vec!["lib/foil.sdl", "wing.sdl", "tail.sdl"]),
        ("lib/foil.sdl", (1, 41), "surface_area", vec!["lib/foil.sdl", "wing.sdl"]),
        ("keel.sdl", (0, 14), "depth", vec!["keel.sdl", "boat.sdl"]),
        ("keel.sdl", (1, 50), "brim", vec!["keel.sdl", "boat.sdl"]),
        ("boat.sdl", (2, 20), "end", vec!["keel.sdl", "boat.sdl"]),
        ("boat.sdl", (1, 12), "fin", vec!["boat.sdl"]),
        ("other.sdl", (1, 8), "raise", vec!["other.sdl"]),
    ];
    for (name, place, new, touched) in cases {
        let answer = folder.rename(&mut client, name, place, new);
        assert!(answer.get("error").is_none(), "{name} {place:?}: {answer}");
        let after = folder.renamed(&answer, &texts);
        let changed: Vec<&str> =
            texts.iter().filter(|(n, t)| after[*n] != *t).map(|(n, _)| *n).collect();
        let (mut changed, mut touched) = (changed, touched);
        changed.sort_unstable();
        touched.sort_unstable();
        assert_eq!(changed, touched, "{name} {new}: {after:?}");
        // The language is the oracle: no name is left, none collides.
        let other = Folder::new(&after.iter().map(|(n, t)| (&**n, &**t)).collect::<Vec<_>>());
        let mut second = other.client();
        for (name, text) in &after {
            assert_eq!(second.open_of(&other.uri(name), text), Vec::<Value>::new(), "{name} {new}");
        }
    }
    for (name, place, new, why) in [
        ("wing.sdl", (2, 2), "l", "in use"),
        ("lib/foil.sdl", (1, 17), "l", "in use"),
        ("lib/foil.sdl", (1, 41), "alpha", "in use"),
        ("wing.sdl", (2, 2), "sqrt", "in use"),
        ("wing.sdl", (2, 2), "2b", "valid name"),
    ] {
        let answer = folder.rename(&mut client, name, place, new);
        let said = answer["error"]["message"].as_str().unwrap_or_else(|| panic!("{answer}"));
        assert!(said.contains(why), "{name} {new}: {said}");
    }
}

#[test]
fn open_texts_count_as_the_editor_shows_them() {
    let folder = Folder::new(&all());
    let mut client = folder.client();
    let (wing, foil) = (folder.uri("wing.sdl"), folder.uri("lib/foil.sdl"));
    assert_eq!(client.open_of(&wing, FILES[1].1), Vec::<Value>::new());
    // The loaded file is changed and not saved: the program that loads it runs again and says so.
    client.open_of(&foil, FILES[0].1);
    let new = FILES[0].1.replace("lift(", "drag(");
    client.tell_change(&foil, 2, json!([{"text": new}]));
    let found = loop {
        let found = client.published_of(&wing);
        if !found.is_empty() {
            break found;
        }
    };
    assert_eq!(found[0]["code"], "unknown-name", "{found:?}");
    let ask = json!({"textDocument": {"uri": foil}, "position": {"line": 1, "character": 16},
                     "context": {"includeDeclaration": true}});
    let found = client.ask("textDocument/references", ask);
    assert_eq!(folder.places(&found), ["foil.sdl:1:15"]);
    // Closed without saving, it is the saved one again.
    client.tell("textDocument/didClose", json!({"textDocument": {"uri": foil}}));
    while !client.published_of(&wing).is_empty() {}
}
