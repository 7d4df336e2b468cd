//! Help during editing: signatures, quick fixes, colours, names of arguments, folds, words and
//! files.

use crate::client::{Client, URI, words};
use serde_json::{Value, json};

/// The text without `|`, and the position of `|`.
fn marked(text: &str) -> (String, u64, u64) {
    let at = text.find('|').expect("the place");
    let before = &text[..at];
    let line = before.matches('\n').count() as u64;
    let character = before.rsplit('\n').next().unwrap().encode_utf16().count() as u64;
    (text.replacen('|', "", 1), line, character)
}

/// The signature at `|`: label and active argument.
fn signature(client: &mut Client, text: &str) -> Option<(String, Option<String>)> {
    let (text, line, character) = marked(text);
    client.change(2, json!([{"text": text}]));
    let help = client.at("textDocument/signatureHelp", line, character);
    let one = help["signatures"].get(0)?;
    let label = one["label"].as_str().unwrap().to_string();
    let active = one["activeParameter"].as_u64().map(|k| {
        let range = &one["parameters"][k as usize]["label"];
        let at = |i: usize| range[i].as_u64().unwrap() as usize;
        label[at(0)..at(1)].to_string()
    });
    Some((label, active))
}

#[test]
fn the_signature_of_the_call_around_the_cursor_is_shown() {
    let mut client = Client::start();
    client.open("");
    let own = "# Half of a number.\nfunction float half(float whole, float part) { return whole/part; }\n";
    for (text, head, active) in [
        ("AbsPoint P(|", "AbsPoint(", Some("x")),
        ("AbsPoint P(1, 2|", "AbsPoint(", Some("y")),
        ("AbsPoint P(1, z = |", "AbsPoint(", Some("z")),
        ("AbsPoint P(1, sin(|", "sin(", Some("x")),
        (&format!("{own}float h = half(1, |"), "function float half(", Some("part")),
        ("Component keel(|", "Component name(", Some("file")),
        ("float a = format(|", "format(", Some("pattern")),
    ] {
        let (label, found) = signature(&mut client, text).unwrap_or_else(|| panic!("{text}"));
        assert!(label.starts_with(head), "{text}: {label}");
        assert_eq!(found.as_deref(), active, "{text}: {label}");
    }
    for text in ["|", "float a = 1|;", "nosuch(|", "AbsPoint P(1, 2, 3);|"] {
        assert_eq!(signature(&mut client, text), None, "{text}");
    }
}

#[test]
fn every_kind_and_function_has_a_signature_with_all_its_arguments() {
    let mut client = Client::start();
    client.open("");
    let registry = moldloft::registry();
    let mut text = String::new();
    let mut names = Vec::new();
    for row in registry.rows() {
        let head = if row.kind { format!("{} q(", row.name) } else { format!("{}(", row.name) };
        names.push((row.name.to_string(), row.fields.len(), head.len() as u64));
        text.push_str(&head);
        text.push_str(");\n");
    }
    client.change(2, json!([{"text": text}]));
    for (line, (name, arguments, character)) in names.into_iter().enumerate() {
        let help = client.at("textDocument/signatureHelp", line as u64, character);
        let one = &help["signatures"][0];
        assert!(one["label"].as_str().is_some_and(|l| l.starts_with(&name)), "{name}: {help}");
        assert_eq!(one["parameters"].as_array().unwrap().len(), arguments, "{name}: {one}");
    }
}

#[test]
fn corrections_are_applied_as_proposed() {
    let mut client = Client::start();
    client.open("");
    let whole = json!({"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}});
    for (text, right) in [
        ("AbsPiont A(0, 0, 0);\n", "AbsPoint A(0, 0, 0);\n"),
        ("float width = 2;\nfloat b = 2*widht;\n", "float width = 2;\nfloat b = 2*width;\n"),
        ("float b = sqr(4);\n", "float b = sqrt(4);\n"),
        (
            "AbsPoint A(0, 0, 0)\nAbsPoint B(1, 0, 0);\n",
            "AbsPoint A(0, 0, 0);\nAbsPoint B(1, 0, 0);\n",
        ),
        (
            "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0);\nBCurve c({A, B}, degre = 1);\n",
            "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0);\nBCurve c({A, B}, degree = 1);\n",
        ),
        (
            "AbsPoint A(0, 0, 0); AbsPoint Bow(1, 0, 0);\nLine c(A, Bwo);\n",
            "AbsPoint A(0, 0, 0); AbsPoint Bow(1, 0, 0);\nLine c(A, Bow);\n",
        ),
        ("float a = 1;\nif (a = 2) { a = 3; }\n", "float a = 1;\nif (a == 2) { a = 3; }\n"),
    ] {
        let found = client.change(2, json!([{"text": text}]));
        assert!(!found.is_empty(), "{text}");
        let ask =
            json!({"textDocument": {"uri": URI}, "range": whole, "context": {"diagnostics": []}});
        let actions = client.ask("textDocument/codeAction", ask);
        let action = actions.get(0).unwrap_or_else(|| panic!("no correction of {text}: {found:?}"));
        assert_eq!(action["kind"], "quickfix");
        let edits = action["edit"]["changes"][URI].as_array().unwrap();
        let changes: Vec<Value> =
            edits.iter().map(|e| json!({"range": e["range"], "text": e["newText"]})).collect();
        let left = client.change(3, json!(changes));
        assert_eq!(left, Vec::<Value>::new(), "{text}: {action}");
        let range = json!({"textDocument": {"uri": URI}, "options": {}});
        client.ask("textDocument/formatting", range);
        // The text is the one that was meant: it names nothing else.
        assert_eq!(applied(text, edits), right, "{action}");
    }
}

/// A text of ASCII after edits that do not overlap.
fn applied(text: &str, edits: &[Value]) -> String {
    let at = |place: &Value| {
        let line = place["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        start + place["character"].as_u64().unwrap() as usize
    };
    let mut new = text.to_string();
    let mut edits: Vec<&Value> = edits.iter().collect();
    edits.sort_by_key(|e| std::cmp::Reverse(at(&e["range"]["start"])));
    for edit in edits {
        let (a, b) = (at(&edit["range"]["start"]), at(&edit["range"]["end"]));
        new.replace_range(a..b, edit["newText"].as_str().unwrap());
    }
    new
}

#[test]
fn names_are_coloured_by_what_they_are() {
    let mut client = Client::start();
    let text = "param float beam = 2;\nAbsPoint A(0, y = beam, z = sqrt(4)); # é\nfloat h = A.x;\nfunction float half(float a) { return a/2; }\nh = half(h);\n";
    assert_eq!(client.open(text), Vec::<Value>::new());
    let ask = json!({"textDocument": {"uri": URI}});
    let data = client.ask("textDocument/semanticTokens/full", ask)["data"].clone();
    let data: Vec<u64> = data.as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    let lines: Vec<&str> = text.lines().collect();
    let (mut line, mut start) = (0, 0);
    let mut found = Vec::new();
    for token in data.chunks(5) {
        line += token[0];
        start = if token[0] == 0 { start + token[1] } else { token[1] };
        let name = &lines[line as usize][start as usize..(start + token[2]) as usize];
        let kind = ["type", "variable", "parameter", "function", "property"][token[3] as usize];
        found.push((name, kind, token[4] & 1 == 1));
    }
    assert_eq!(
        found,
        [
            ("beam", "parameter", true),
            ("AbsPoint", "type", false),
            ("A", "variable", true),
            ("y", "property", false),
            ("beam", "parameter", false),
            ("z", "property", false),
            ("sqrt", "function", false),
            ("h", "variable", true),
            ("A", "variable", false),
            ("x", "property", false),
            ("half", "function", true),
            ("a", "variable", true),
            ("a", "variable", false),
            ("h", "variable", false),
            ("half", "function", false),
            ("h", "variable", false),
        ]
    );
}

#[test]
fn arguments_without_a_name_show_it_where_the_value_does_not() {
    let mut client = Client::start();
    let text = "AbsPoint A(0, 1, 2); AbsPoint B(1, 1, 2);\nBCurve c({A, B}, 1);\nfunction float part(float whole, float share) { return whole*share; }\n                float n = 3;\nfloat p = part(n, 0.5);\n";
    assert_eq!(client.open(text), Vec::<Value>::new());
    let range = json!({"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}});
    let ask = json!({"textDocument": {"uri": URI}, "range": range});
    let hints = client.ask("textDocument/inlayHint", ask);
    let found: Vec<(u64, u64, &str)> = hints
        .as_array()
        .unwrap()
        .iter()
        .map(|h| {
            let at = |key: &str| h["position"][key].as_u64().unwrap();
            (at("line"), at("character"), h["label"].as_str().unwrap())
        })
        .collect();
    assert_eq!(found, [(1, 17, "degree ="), (4, 18, "share =")]);
    // Only the part in the range.
    let range = json!({"start": {"line": 2, "character": 0}, "end": {"line": 9, "character": 0}});
    let ask = json!({"textDocument": {"uri": URI}, "range": range});
    assert_eq!(client.ask("textDocument/inlayHint", ask).as_array().unwrap().len(), 1);
}

#[test]
fn folds_come_without_a_run() {
    let mut client = Client::start();
    client.open("# a\n# b\nsubroutine f(float a)\n{\n  a = 1;\n}\nwhile (1) { }\n");
    let folds = client.ask("textDocument/foldingRange", json!({"textDocument": {"uri": URI}}));
    let found: Vec<(u64, u64)> = folds
        .as_array()
        .unwrap()
        .iter()
        .map(|f| (f["startLine"].as_u64().unwrap(), f["endLine"].as_u64().unwrap()))
        .collect();
    assert_eq!(found, [(0, 1), (3, 4)]);
}

#[test]
fn words_of_arguments_and_files_are_proposed_inside_of_quotes() {
    let folder = std::env::temp_dir().join(format!("moldloft-words-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("parts")).unwrap();
    std::fs::write(folder.join("parts/keel.sdl"), "").unwrap();
    std::fs::write(folder.join("foil.sdl"), "").unwrap();
    std::fs::write(folder.join(".hidden.sdl"), "").unwrap();
    let uri = format!("file://{}/boat.sdl", folder.display());
    let mut client = Client::start();
    client.open_of(&uri, "");
    let mut version = 1;
    let mut at = |text: &str| {
        let (text, line, character) = marked(text);
        version += 1;
        client.tell_change(&uri, version, json!([{"text": text}]));
        client.published_of(&uri);
        words(&client.at_of(&uri, "textDocument/completion", line, character))
    };
    assert_eq!(at("load \"|"), ["foil.sdl", "parts/"]);
    assert_eq!(at("load \"parts/|\""), ["keel.sdl"]);
    assert_eq!(at("load \"../|\""), Vec::<String>::new());
    assert!(at("Component keel(\"parts/|").contains(&"keel.sdl".to_string()));
    let found = at("Model m(symmetry = \"|\")");
    assert!(
        found.contains(&"y".to_string()) && !found.contains(&"AbsPoint".to_string()),
        "{found:?}"
    );
    let found = at("BCurve c({}, |");
    assert!(found.contains(&"degree".to_string()), "{found:?}");
    std::fs::remove_dir_all(&folder).unwrap();
}
