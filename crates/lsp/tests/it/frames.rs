//! Invalid input of an editor: it is answered, and the server continues.

use crate::client::{Client, URI};
use moldloft_testing::{Random, rounds};
use serde_json::{Value, json};
use std::io::Write;

/// Bytes as they are.
fn raw(client: &mut Client, bytes: &[u8]) {
    let input = client.input.as_mut().unwrap();
    input.write_all(bytes).unwrap();
    input.flush().unwrap();
}

fn framed(client: &mut Client, body: &[u8]) {
    raw(client, format!("Content-Length: {}\r\n\r\n", body.len()).as_bytes());
    raw(client, body);
}

/// The next answer without an id.
fn refusal(client: &mut Client) -> i64 {
    loop {
        let message = client.next();
        if message.get("id") == Some(&Value::Null) {
            return message["error"]["code"].as_i64().unwrap();
        }
    }
}

#[test]
fn what_is_no_message_is_answered() {
    let mut client = Client::start();
    for (body, code) in [
        (&b"{\"jsonrpc\": oops"[..], -32700),
        (b"\"\xff\xfe\"", -32700),
        (b"", -32700),
        (b"[]", -32600),
        (b"7", -32600),
        (b"{\"jsonrpc\": \"2.0\"}", -32600),
        ("[".repeat(100_000).as_bytes(), -32700),
    ] {
        framed(&mut client, body);
        assert_eq!(
            refusal(&mut client),
            code,
            "{:?}",
            String::from_utf8_lossy(&body[..9.min(body.len())])
        );
    }
    for header in [
        "Content-Length: many\r\n\r\n{}",
        "Content-Length: 99999999999999\r\n\r\n",
        "nonsense\r\n\r\n",
    ] {
        raw(&mut client, header.as_bytes());
        raw(&mut client, b"\r\n");
        assert_eq!(refusal(&mut client), -32700, "{header}");
        // The content after the wrong header is skipped.
        let id = 800 + header.len();
        client.send(&json!({"jsonrpc": "2.0", "id": id, "method": "no/such", "params": {}}));
        while client.next()["id"] != id {}
    }
    // Two requests in one message.
    let one = |id: u64| json!({"jsonrpc": "2.0", "id": id, "method": "no/such", "params": {}});
    framed(&mut client, json!([one(901), one(902)]).to_string().as_bytes());
    let mut left = vec![901, 902];
    while !left.is_empty() {
        let id = client.next()["id"].clone();
        left.retain(|known| id != *known);
    }
    assert!(client.open("AbsPoint A(0, 0, 0);\n").is_empty());
}

#[test]
fn damaged_messages_leave_the_server_alive() {
    let mut client = Client::start();
    client.open(
        "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0);\nAbsPoint B(w, 0, 0);\nLine l(A, B);\n",
    );
    let place = json!({"textDocument": {"uri": URI}, "position": {"line": 2, "character": 12}});
    let seeds: Vec<String> = [
        ("textDocument/hover", place.clone()),
        ("textDocument/completion", place.clone()),
        ("textDocument/rename", json!({"textDocument": {"uri": URI}, "position": {"line": 0, "character": 12}, "newName": "v"})),
        ("textDocument/didChange", json!({"textDocument": {"uri": URI, "version": 3}, "contentChanges": [{"range": {"start": {"line": 0, "character": 3}, "end": {"line": 1, "character": 0}}, "text": "x"}]})),
        ("textDocument/semanticTokens/full", json!({"textDocument": {"uri": URI}})),
        ("textDocument/didOpen", json!({"textDocument": {"uri": "file:///a.sdl", "languageId": "sdl", "version": 1, "text": "AbsPoint A(0,0,0);"}})),
        ("textDocument/didClose", json!({"textDocument": {"uri": "file:///a.sdl"}})),
        ("workspace/symbol", json!({"query": "A"})),
        ("textDocument/formatting", json!({"textDocument": {"uri": URI}, "options": {"tabSize": 4, "insertSpaces": true}})),
        ("$/cancelRequest", json!({"id": 3})),
    ]
    .iter()
    .map(|(method, params)| json!({"jsonrpc": "2.0", "id": 5000, "method": method, "params": params}).to_string())
    .collect();
    let mut random = Random::new(1);
    for turn in 0..rounds(400, 40_000) {
        let mut body = seeds[random.below(seeds.len())].clone().into_bytes();
        for _ in 0..random.below(4) {
            let at = random.below(body.len());
            match random.below(4) {
                0 => body[at] = random.bits() as u8,
                1 => drop(body.drain(at..(at + 1 + random.below(20)).min(body.len()))),
                2 => {
                    let numbers = ["-1", "4294967296", "1e308", "null", "[]", "{}", "\"\""];
                    let new = numbers[random.below(numbers.len())];
                    let digit = body.iter().skip(at).position(u8::is_ascii_digit);
                    if let Some(k) = digit {
                        body.splice(at + k..=at + k, new.bytes());
                    }
                }
                _ => body.truncate(at.max(1)),
            }
            if body.is_empty() {
                break;
            }
        }
        // An orderly end of the server is not tested here.
        if body.windows(6).any(|w| w == b"\"exit\"") || body.windows(8).any(|w| w == b"shutdown") {
            continue;
        }
        framed(&mut client, &body);
        if turn % 20 == 19 {
            let id = 100_000 + turn as u64;
            client.send(&json!({"jsonrpc": "2.0", "id": id, "method": "workspace/symbol", "params": {"query": "A"}}));
            while client.next()["id"] != id {}
        }
    }
    assert!(client.child.try_wait().unwrap().is_none(), "the server is there");
}
