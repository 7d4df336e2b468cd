//! An editor: the program itself, spoken to by the protocol.

use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

pub struct Client {
    pub child: Child,
    pub input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    asked: u64,
    notices: VecDeque<Value>,
}

pub const URI: &str = "file:///nowhere/hull%20one.sdl";

impl Client {
    pub fn start() -> Self {
        Self::start_in(json!({"capabilities": {}}))
    }

    /// Begins with these parameters.
    pub fn start_in(begin: Value) -> Self {
        // A folder without the libraries.
        let temporary = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("lsp-{}", std::process::id()));
        std::fs::create_dir_all(&temporary).expect("a folder for temporary files");
        let mut child = Command::new(env!("CARGO_BIN_EXE_moldloft-lsp"))
            .env("TMPDIR", temporary)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let input = child.stdin.take();
        let output = BufReader::new(child.stdout.take().unwrap());
        let mut client = Self { child, input, output, asked: 0, notices: VecDeque::new() };
        let answer = client.ask("initialize", begin);
        assert_eq!(answer["serverInfo"]["name"], "moldloft-lsp");
        assert_eq!(answer["capabilities"]["hoverProvider"], true);
        client.tell("initialized", json!({}));
        client
    }

    pub fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let input = self.input.as_mut().unwrap();
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        input.flush().unwrap();
    }

    pub fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({"jsonrpc": "2.0", "method": method, "params": params}));
    }

    pub fn next(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            self.output.read_line(&mut line).unwrap();
            if line.trim().is_empty() {
                break;
            }
            if let Some(n) = line.strip_prefix("Content-Length: ") {
                length = n.trim().parse().unwrap();
            }
        }
        let mut bytes = vec![0; length];
        self.output.read_exact(&mut bytes).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }

    pub fn answer(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = self.asked;
        self.send(&json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params}));
        loop {
            let answer = self.next();
            // Reports of runs in the meantime are skipped.
            if answer.get("id").is_some() {
                assert_eq!(answer["id"], id, "{answer}");
                return answer;
            }
            self.notices.push_back(answer);
        }
    }

    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.answer(method, params);
        assert!(answer.get("error").is_none(), "{answer}");
        answer["result"].clone()
    }

    pub fn at(&mut self, method: &str, line: u64, character: u64) -> Value {
        self.at_of(URI, method, line, character)
    }

    pub fn at_of(&mut self, uri: &str, method: &str, line: u64, character: u64) -> Value {
        let place = json!({"line": line, "character": character});
        self.ask(method, json!({"textDocument": {"uri": uri}, "position": place}))
    }

    /// The diagnostics of the text after it was opened or changed.
    pub fn open(&mut self, text: &str) -> Vec<Value> {
        self.open_of(URI, text)
    }

    pub fn open_of(&mut self, uri: &str, text: &str) -> Vec<Value> {
        let item = json!({"uri": uri, "languageId": "sdl", "version": 1, "text": text});
        self.tell("textDocument/didOpen", json!({"textDocument": item}));
        self.published_of(uri)
    }

    pub fn change(&mut self, version: u64, changes: Value) -> Vec<Value> {
        self.tell_change(URI, version, changes);
        self.published()
    }

    pub fn tell_change(&mut self, uri: &str, version: u64, changes: Value) {
        let id = json!({"uri": uri, "version": version});
        self.tell("textDocument/didChange", json!({"textDocument": id, "contentChanges": changes}));
    }

    pub fn published(&mut self) -> Vec<Value> {
        self.published_of(URI)
    }

    /// The next diagnostics of a text; those of others are passed over.
    pub fn published_of(&mut self, uri: &str) -> Vec<Value> {
        loop {
            let message = self.notices.pop_front().unwrap_or_else(|| self.next());
            let published = message["method"] == "textDocument/publishDiagnostics";
            if published && message["params"]["uri"] == uri {
                return message["params"]["diagnostics"].as_array().unwrap().clone();
            }
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The words of completions.
pub fn words(completions: &Value) -> Vec<String> {
    let items = completions["items"].as_array().unwrap();
    items.iter().map(|i| i["label"].as_str().unwrap().to_string()).collect()
}
