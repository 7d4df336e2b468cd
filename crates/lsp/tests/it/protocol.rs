//! A session with one text: answers of each method, and reports while typing.

use crate::client::{Client, URI, words};
use serde_json::{Value, json};
use std::time::Duration;

const TEXT: &str = "\
load \"stdsubs.sdl\"
param float r = 2 in [1, 3]; # é
curve c[5];
arc(c, 0, PI, r);
AbsPoint P(r, 0, 0);
# Twice a number.
function float twice(float x) { float y = 2*x; return y; }
float x = twice(c[1].x);
";

#[test]
fn a_session() {
    let mut client = Client::start();
    assert_eq!(client.open(TEXT), Vec::<Value>::new());

    // Hover tells shape and value.
    let hover = client.at("textDocument/hover", 3, 4);
    let said = hover["contents"]["value"].as_str().unwrap();
    assert!(said.contains("curve[5] c") && said.contains("x from -2 to 2"), "{said}");
    assert_eq!(hover["range"]["start"], json!({"line": 3, "character": 4}));
    let said = client.at("textDocument/hover", 3, 1)["contents"]["value"].to_string();
    assert!(
        said.contains("subroutine arc(returned curve c") && said.contains("radius r"),
        "{said}"
    );
    let said = client.at("textDocument/hover", 1, 12)["contents"]["value"].to_string();
    assert!(said.contains("param r = 2 in [1, 3]"), "{said}");
    let said = client.at("textDocument/hover", 4, 2)["contents"]["value"].to_string();
    assert!(said.contains("AbsPoint("), "{said}");
    let said = client.at("textDocument/hover", 7, 12)["contents"]["value"].to_string();
    assert!(said.contains("Twice a number"), "{said}");
    assert_eq!(client.at("textDocument/hover", 0, 2), Value::Null);

    // Definition: in the text, and in a library.
    let there = client.at("textDocument/definition", 7, 17);
    assert_eq!(there["uri"], URI);
    assert_eq!(there["range"]["start"], json!({"line": 2, "character": 6}));
    let there = client.at("textDocument/definition", 3, 1);
    let path = there["uri"].as_str().unwrap();
    assert!(path.ends_with("/moldloft-libraries/stdsubs.sdl"), "{path}");
    let file = std::fs::read_to_string(path.strip_prefix("file://").unwrap()).unwrap();
    let line = there["range"]["start"]["line"].as_u64().unwrap() as usize;
    assert!(file.lines().nth(line).unwrap().starts_with("subroutine arc("));

    // Completion: names, kinds, library routines, members.
    let all = words(&client.at("textDocument/completion", 8, 0));
    for word in ["c", "x", "r", "P", "arc", "transfinite", "AbsPoint", "d_tanh", "format", "curve"]
    {
        assert!(all.iter().any(|w| w == word), "{word} is not among the completions");
    }
    assert!(!all.iter().any(|w| w == "y"), "y is local to its routine");
    let inside = words(&client.at("textDocument/completion", 6, 54));
    assert!(inside.iter().any(|w| w == "y"), "{inside:?}");
    let members = words(&client.at("textDocument/completion", 7, 21));
    assert_eq!(members, ["x", "y", "z"]);

    // Rename keeps to its scope: the argument x is another name than the variable.
    let place = json!({"line": 7, "character": 6});
    let id = json!({"uri": URI});
    let ask = json!({"textDocument": id, "position": place, "newName": "width"});
    let edits = client.ask("textDocument/rename", ask)["changes"][URI].clone();
    assert_eq!(edits.as_array().unwrap().len(), 1, "{edits}");
    let place = json!({"line": 2, "character": 6});
    let ask = json!({"textDocument": id, "position": place, "newName": "circle"});
    let edits = client.ask("textDocument/rename", ask)["changes"][URI].clone();
    assert_eq!(edits.as_array().unwrap().len(), 3, "{edits}");
    for (new, says) in [
        ("1x", "is not a valid name"),
        ("for", "is not a valid name"),
        ("x", "is already in use"),
        ("sqrt", "is already in use"),
    ] {
        let ask = json!({"textDocument": id, "position": place, "newName": new});
        let answer = client.answer("textDocument/rename", ask);
        assert!(answer["error"]["message"].as_str().unwrap().contains(says), "{answer}");
    }
    let ask =
        json!({"textDocument": id, "position": {"line": 3, "character": 1}, "newName": "bow"});
    let answer = client.answer("textDocument/rename", ask);
    assert!(answer["error"]["message"].as_str().unwrap().contains("not declared in this file"));
    assert_eq!(client.at("textDocument/references", 2, 6).as_array().unwrap().len(), 3);

    // Formatting and symbols.
    let ask = json!({"textDocument": id, "options": {}});
    let edits = client.ask("textDocument/formatting", ask.clone());
    assert!(edits.as_array().unwrap().len() <= 1, "{edits}");
    let symbols = client.ask("textDocument/documentSymbol", ask);
    let names: Vec<&str> =
        symbols.as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["r", "c", "P", "twice", "x"]);

    // Unknown methods are refused, unknown notices passed over.
    assert_eq!(
        client.answer("textDocument/foo", json!({"textDocument": id}))["error"]["code"],
        -32601
    );
    client.tell("$/whatever", json!({}));
    assert_eq!(client.ask("shutdown", Value::Null), Value::Null);
    client.tell("exit", Value::Null);
    assert!(client.child.wait().unwrap().success());
}

#[test]
fn diagnostics_come_as_one_types() {
    let mut client = Client::start();
    client.open("curve a[3], b[4];\n");
    // An insertion at the end.
    let at = json!({"line": 1, "character": 0});
    let found =
        client.change(2, json!([{"range": {"start": at, "end": at}, "text": "a = a + b;\n"}]));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["code"], "shapes-differ");
    let message = found[0]["message"].as_str().unwrap();
    assert!(message.starts_with("shapes differ: `a` is curve[3], `b` is curve[4]"), "{message}");
    assert_eq!(found[0]["range"]["start"], json!({"line": 1, "character": 4}));
    assert_eq!(found[0]["range"]["end"], json!({"line": 1, "character": 5}));
    let related = found[0]["relatedInformation"].as_array().unwrap();
    assert_eq!(related.len(), 3, "{related:?}");
    assert_eq!(related[0]["location"]["uri"], URI);
    // Several changes in one notice, then the text as a whole.
    let word = json!({"start": {"line": 1, "character": 8}, "end": {"line": 1, "character": 9}});
    let found = client.change(
        3,
        json!([{"range": word, "text": "a"}, {"range": {"start": at, "end": at}, "text": "a = ;"}]),
    );
    assert!(found.iter().all(|d| d["code"] == "unexpected-token"), "{found:?}");
    assert_eq!(client.change(4, json!([{"text": "float x = 1;"}])), Vec::<Value>::new());
    // A text without a file, with many kinds of faults.
    for text in [
        "",
        "}",
        "(((",
        "\u{feff}",
        "load \"nothing.sdl\"",
        "subroutine f(",
        "\"",
        "a.",
        "for (",
        "𝄞",
    ] {
        client.change(5, json!([{"text": text}]));
        for character in 0..=text.chars().count() as u64 {
            for method in ["hover", "completion", "definition", "references"] {
                client.at(&format!("textDocument/{method}"), 0, character);
            }
        }
    }
    client.tell("textDocument/didClose", json!({"textDocument": {"uri": URI}}));
    assert_eq!(client.published(), Vec::<Value>::new());
    client.input = None;
    let status = client.child.wait().unwrap();
    assert!(!status.success(), "an end without shutdown is a failure");
}

/// Programs that do not end in a reasonable time, for different reasons.
const ENDLESS: [&str; 4] = [
    "float x = 1;\nwhile (1) { x = x + 1; }\n",
    "float x = 1;\nfarray a[1000000];\nwhile (1) { a = sin(a) + x; }\n",
    "float x = 1;\nfunction float f(float y) { if (y > 40) return y; return f(y + 1) + f(y + 1); }\nx = f(1);\n",
    "float x = 1;\nsurface s[300, 300];\nfor (i = 1:300) for (j = 1:300) s[i, j] = {i, j, 0};\n\
     s[2:299, 2:299].x += 0.2;\ns = elliptic(s, 1000000, 0);\n",
];

#[test]
fn endless_programs_do_not_occupy_the_server() {
    let mut client = Client::start();
    client.open("float x = 1;\n");
    for text in ENDLESS {
        // Reported soon, with its position, and the rest of the text is still known.
        let found = client.change(2, json!([{"text": text}]));
        assert_eq!(found.len(), 1, "{found:?}");
        let (code, message) = (&found[0]["code"], found[0]["message"].as_str().unwrap());
        // A fast machine comes to the limit of statements before.
        assert!(code == "cancelled" || code == "too-many-steps", "{found:?}");
        assert!(message.contains("look for"), "{message}");
        assert!(found[0]["range"]["start"]["line"].as_u64().unwrap() > 0, "{found:?}");
        let said = client.at("textDocument/hover", 0, 6)["contents"]["value"].to_string();
        assert!(said.contains('x'), "{said}");
        // A change while it runs stops it: otherwise the next answer would be that of the endless program.
        let id = json!({"uri": URI, "version": 3});
        let changes = json!([{"text": text.replace("= 1;", "= 2;")}]);
        let notice = json!({"textDocument": id, "contentChanges": changes});
        client.tell("textDocument/didChange", notice);
        std::thread::sleep(Duration::from_millis(300));
        let mut found = client.change(4, json!([{"text": "print y;\n"}]));
        if found[0]["code"] == "too-many-steps" {
            // A run that reached the limit before the change was reported.
            found = client.published();
        }
        assert_eq!(found[0]["code"], "unknown-name", "{found:?}");
    }
}
