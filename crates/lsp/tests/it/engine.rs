//! The engine is ended under the editor: nothing is lost, and the text that did it waits.
#![cfg(target_os = "linux")]

use crate::client::{Client, URI};
use serde_json::{Value, json};
use std::process::Command;

/// The process that runs the texts.
fn engine_of(client: &Client) -> u32 {
    let front = client.child.id();
    let path = format!("/proc/{front}/task/{front}/children");
    // Threads of the front may have started it.
    let mut all = std::fs::read_to_string(path).unwrap_or_default();
    for task in std::fs::read_dir(format!("/proc/{front}/task")).unwrap().flatten() {
        all += &std::fs::read_to_string(task.path().join("children")).unwrap_or_default();
    }
    all.split_whitespace().next().expect("an engine").parse().unwrap()
}

/// Runs until it is stopped: the limit of steps is far, as one call does all.
const LONG: &str = "surface s[300, 300];\nfor (i = 1:300) for (j = 1:300) s[i, j] = {i, j, 0};\n\
    s[2:299, 2:299].x += 0.2;\ns = elliptic(s, 1000000, 0);\n";

fn kill(engine: u32) {
    let done = Command::new("kill").args(["-9", &engine.to_string()]).status().unwrap();
    assert!(done.success());
}

#[test]
fn a_killed_engine_loses_no_text() {
    let mut client = Client::start();
    client.open("float width = 3;\n");
    for round in 0..10 {
        let text = format!("float width = {round};\nfloat other = nosuch;\n");
        let found = client.change(round + 2, json!([{"text": text}]));
        assert_eq!(found[0]["code"], "unknown-name");
        let before = engine_of(&client);
        kill(before);
        // The new engine has the text of the last change.
        let found = client.published();
        assert_eq!(found[0]["code"], "unknown-name", "{found:?}");
        let said = client.at("textDocument/hover", 0, 7)["contents"]["value"].to_string();
        assert!(said.contains(&round.to_string()), "{said}");
        assert_ne!(engine_of(&client), before);
    }
    assert_eq!(client.ask("shutdown", Value::Null), Value::Null);
    client.tell("exit", Value::Null);
    assert!(client.child.wait().unwrap().success());
}

#[test]
fn a_text_that_ends_its_engine_waits_until_it_is_changed() {
    let mut client = Client::start();
    let other = "file:///nowhere/other.sdl";
    client.open_of(other, "float calm = 2;\n");
    // It runs for two seconds, if nothing ends it.
    let item = json!({"uri": URI, "languageId": "sdl", "version": 1, "text": LONG});
    client.tell("textDocument/didOpen", json!({"textDocument": item}));
    std::thread::sleep(std::time::Duration::from_millis(700));
    kill(engine_of(&client));
    let found = client.published();
    assert_eq!(found[0]["code"], "engine-ended", "{found:?}");
    let answer = client.answer(
        "textDocument/hover",
        json!({"textDocument": {"uri": URI}, "position": {"line": 0, "character": 2}}),
    );
    assert!(answer.get("error").is_some(), "{answer}");
    // The other text is as before.
    let said = client.at_of(other, "textDocument/hover", 0, 8)["contents"]["value"].to_string();
    assert!(said.contains("calm"), "{said}");
    assert_eq!(client.change(2, json!([{"text": "float x = 1;\n"}])), Vec::<Value>::new());
}

#[test]
fn requests_of_an_engine_that_ended_are_refused() {
    let mut client = Client::start();
    let item = json!({"uri": URI, "languageId": "sdl", "version": 1, "text": LONG});
    client.tell("textDocument/didOpen", json!({"textDocument": item}));
    let place = json!({"line": 0, "character": 1});
    let params = json!({"textDocument": {"uri": URI}, "position": place});
    client.send(
        &json!({"jsonrpc": "2.0", "id": 77, "method": "textDocument/hover", "params": params}),
    );
    std::thread::sleep(std::time::Duration::from_millis(700));
    kill(engine_of(&client));
    loop {
        let message = client.next();
        if message["id"] == 77 {
            assert!(
                message["error"]["message"].as_str().unwrap().contains("engine ended"),
                "{message}"
            );
            return;
        }
    }
}

#[test]
fn more_memory_than_the_engine_may_have_is_an_error_of_the_text() {
    let mut client = Client::start();
    let found = client.open("farray a[20000, 20000];\na = a + 1;\nfarray b[20000, 20000];\n");
    assert!(!found.is_empty(), "3.2 GB were taken without a word");
    assert_eq!(client.change(2, json!([{"text": "float x = 1;\n"}])), Vec::<Value>::new());
}
