//! What the server answers.

use crate::position::{offset, position, range};
use moldloft::budget::Budget;
use moldloft::diag::{DiagnosticData, LabelData, Severity};
use moldloft::document::{CompletionKind, Document, NoFiles, World};
use moldloft::host::FileWorld;
use moldloft::lang::LIBRARIES;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Code of the protocol for a method that the server does not know.
const METHOD_NOT_FOUND: i64 = -32601;
/// Code for what cannot be done to this text.
const REQUEST_FAILED: i64 = -32803;

/// Code for what the text was changed under.
const CONTENT_MODIFIED: i64 = -32801;

/// How long a program may run before it is stopped, so that an endless loop is reported soon.
const STOP_TIMEOUT: Duration = Duration::from_secs(2);
/// How long a run may take to notice that it was stopped; then it is left to itself.
const EXIT_TIMEOUT: Duration = Duration::from_secs(1);

/// Whether more messages are awaited.
pub enum Next {
    Message,
    End { orderly: bool },
}

/// What the server waits for.
pub enum Event {
    /// A message of the editor; nothing when the editor has gone.
    Message(io::Result<Option<Value>>),
    Ran(Ran),
}

/// A run that came to its end.
pub struct Ran {
    uri: String,
    serial: u64,
    /// Nothing when the run panicked.
    document: Option<Box<Document>>,
}

/// A text that an editor has open.
struct OpenDocument {
    text: String,
    version: Value,
    /// Other texts that diagnostics of this one were reported for.
    told: Vec<String>,
    state: RunState,
    /// Requests that wait for the end of the run: id, method, parameters.
    waiting: Vec<(Value, String, Value)>,
}

/// What is known of a text.
enum RunState {
    /// What came of its run; whether that was stopped.
    Ready(Box<Document>, bool),
    Running(Running),
    /// Nothing: its run did not stop in time, or panicked.
    Unknown,
}

/// A run under way, on a thread of its own.
struct Running {
    /// Which run it is.
    serial: u64,
    budget: Arc<Budget>,
    since: Instant,
    /// When it was asked to stop.
    stopped: Option<Instant>,
    /// True when the text was changed since.
    outdated: bool,
}

impl Running {
    fn stop(&mut self) {
        self.budget.cancel();
        self.stopped.get_or_insert_with(Instant::now);
    }

    /// When something is to be done about it.
    fn deadline(&self) -> Instant {
        self.stopped.map_or(self.since + STOP_TIMEOUT, |stopped| stopped + EXIT_TIMEOUT)
    }
}

/// The open texts. Programs run on threads of their own: whatever a text says, the server answers.
pub struct Server {
    open: BTreeMap<String, OpenDocument>,
    shut_down: bool,
    events: Sender<Event>,
    runs: u64,
    /// Answers to requests about texts that are there no more.
    refused: Vec<Value>,
}

impl Server {
    /// A server that receives the ends of its runs by these events.
    pub fn new(events: Sender<Event>) -> Self {
        Self { open: BTreeMap::new(), shut_down: false, events, runs: 0, refused: Vec::new() }
    }

    /// The messages that answer one.
    pub fn handle(&mut self, message: &Value) -> (Vec<Value>, Next) {
        let method = message["method"].as_str().unwrap_or("");
        let params = &message["params"];
        if method == "exit" {
            return (Vec::new(), Next::End { orderly: self.shut_down });
        }
        let answers = match message.get("id") {
            Some(id) if !method.is_empty() => {
                let uri = params["textDocument"]["uri"].as_str().unwrap_or("");
                match self.open.get_mut(uri) {
                    Some(open)
                        if matches!(open.state, RunState::Running(_)) && needs_run(method) =>
                    {
                        open.waiting.push((id.clone(), method.to_string(), params.clone()));
                        Vec::new()
                    }
                    _ => vec![answered(id, self.request(method, params))],
                }
            }
            _ => self.notice(method, params),
        };
        (answers, Next::Message)
    }

    /// When [`Self::tick`] is to be called.
    pub fn deadline(&self) -> Option<Instant> {
        let running = self.open.values().filter_map(|open| match &open.state {
            RunState::Running(running) => Some(running.deadline()),
            _ => None,
        });
        running.min()
    }

    /// Cancels runs over the time limit and abandons those that do not stop.
    pub fn tick(&mut self) -> Vec<Value> {
        let now = Instant::now();
        let mut late = Vec::new();
        for (uri, open) in &mut self.open {
            if let RunState::Running(running) = &mut open.state
                && running.deadline() <= now
            {
                match running.stopped {
                    None => running.stop(),
                    Some(_) => late.push((uri.clone(), running.outdated)),
                }
            }
        }
        let mut answers = Vec::new();
        for (uri, outdated) in late {
            if outdated {
                self.start(&uri, None);
                continue;
            }
            let Some(open) = self.open.get_mut(&uri) else { continue };
            open.state = RunState::Unknown;
            let place = json!({"line": 0, "character": 0});
            let diagnostic = json!({
                "range": {"start": place, "end": place},
                "severity": 1,
                "code": "cancelled",
                "source": "moldloft",
                "message": stopped_text(),
            });
            answers.push(published(&uri, &open.version, &[diagnostic]));
            answers.extend(self.answer_waiting(&uri));
        }
        answers
    }

    /// Takes what came of a run.
    pub fn ran(&mut self, ran: Ran) -> Vec<Value> {
        let Ran { uri, serial, document } = ran;
        let Some(open) = self.open.get_mut(&uri) else { return Vec::new() };
        let RunState::Running(running) = &open.state else { return Vec::new() };
        if running.serial != serial {
            return Vec::new();
        }
        if running.outdated {
            self.start(&uri, document);
            return Vec::new();
        }
        let stopped = running.stopped.is_some();
        open.state = match document {
            Some(document) => RunState::Ready(document, stopped),
            None => RunState::Unknown,
        };
        let mut answers = self.diagnostics(&uri);
        answers.extend(self.answer_waiting(&uri));
        answers
    }

    fn answer_waiting(&mut self, uri: &str) -> Vec<Value> {
        let waiting = self.open.get_mut(uri).map(|open| std::mem::take(&mut open.waiting));
        let waiting = waiting.unwrap_or_default().into_iter();
        waiting.map(|(id, method, params)| answered(&id, self.request(&method, &params))).collect()
    }

    /// Runs the text that is there now, on what its last run left when there is that.
    fn start(&mut self, uri: &str, document: Option<Box<Document>>) {
        let Some(open) = self.open.get_mut(uri) else { return };
        self.runs += 1;
        let budget = document.as_ref().map_or_else(Arc::default, |d| d.budget());
        budget.resume();
        open.state = RunState::Running(Running {
            serial: self.runs,
            budget: budget.clone(),
            since: Instant::now(),
            stopped: None,
            outdated: false,
        });
        let (uri, text, serial) = (uri.to_string(), open.text.clone(), self.runs);
        let events = self.events.clone();
        // As much as a program's first thread has, for texts that nest deeply.
        let thread = std::thread::Builder::new().stack_size(8 << 20);
        let begun = thread.spawn(move || {
            let run = AssertUnwindSafe(|| match document {
                Some(mut document) => {
                    document.set_text(&text);
                    document
                }
                None => Box::new(opened(&uri, &text, budget)),
            });
            let document = catch_unwind(run).ok();
            moldloft::budget::settle();
            // After the end of the server nobody listens; that is not a fault.
            let _ = events.send(Event::Ran(Ran { uri, serial, document }));
        });
        if begun.is_err() {
            open.state = RunState::Unknown;
        }
    }

    /// Runs a text again: at once, or as soon as the run under way has stopped.
    fn run_again(&mut self, uri: &str, afresh: bool) {
        let Some(open) = self.open.get_mut(uri) else { return };
        match std::mem::replace(&mut open.state, RunState::Unknown) {
            RunState::Running(mut running) => {
                running.stop();
                running.outdated = true;
                let late = running.deadline() <= Instant::now();
                open.state = RunState::Running(running);
                // What waits asked about another text.
                let waiting = std::mem::take(&mut open.waiting);
                let changed = |(id, ..): (Value, String, Value)| {
                    answered(&id, Err((CONTENT_MODIFIED, "the text was changed".into())))
                };
                self.refused.extend(waiting.into_iter().map(changed));
                if late || afresh {
                    self.start(uri, None);
                }
            }
            RunState::Ready(document, _) => self.start(uri, Some(document).filter(|_| !afresh)),
            RunState::Unknown => self.start(uri, None),
        }
    }

    fn notice(&mut self, method: &str, params: &Value) -> Vec<Value> {
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        match method {
            "textDocument/didOpen" => {
                let item = &params["textDocument"];
                let open = OpenDocument {
                    text: item["text"].as_str().unwrap_or("").to_string(),
                    version: item["version"].clone(),
                    told: Vec::new(),
                    state: RunState::Unknown,
                    waiting: Vec::new(),
                };
                self.stop(&uri);
                self.open.insert(uri.clone(), open);
                self.start(&uri, None);
            }
            "textDocument/didChange" => {
                let Some(open) = self.open.get_mut(&uri) else { return Vec::new() };
                let text = &mut open.text;
                for change in params["contentChanges"].as_array().into_iter().flatten() {
                    let new = change["text"].as_str().unwrap_or("");
                    match change.get("range") {
                        Some(range) => {
                            let start = offset(text, &range["start"]) as usize;
                            let end = (offset(text, &range["end"]) as usize).max(start);
                            text.replace_range(start..end, new);
                        }
                        None => *text = new.to_string(),
                    }
                }
                open.version = params["textDocument"]["version"].clone();
                self.run_again(&uri, false);
            }
            "textDocument/didSave" => {
                // Other texts may load this one.
                let all: Vec<String> = self.open.keys().filter(|o| **o != uri).cloned().collect();
                for other in all {
                    self.run_again(&other, true);
                }
            }
            "textDocument/didClose" => {
                self.stop(&uri);
                let told = self.open.remove(&uri).map_or(Vec::new(), |open| open.told);
                let all = std::iter::once(uri).chain(told);
                let mut answers = std::mem::take(&mut self.refused);
                answers.extend(all.map(|uri| published(&uri, &Value::Null, &[])));
                return answers;
            }
            _ => {}
        }
        std::mem::take(&mut self.refused)
    }

    /// Stops the run of a text; nobody waits for its end.
    fn stop(&mut self, uri: &str) {
        if let Some(open) = self.open.get_mut(uri) {
            if let RunState::Running(running) = &mut open.state {
                running.stop();
            }
            for (id, ..) in open.waiting.drain(..) {
                let changed = Err((CONTENT_MODIFIED, "the text was closed".into()));
                self.refused.push(answered(&id, changed));
            }
        }
    }

    /// The diagnostics of a text, by the files that they are about.
    fn diagnostics(&mut self, uri: &str) -> Vec<Value> {
        let Some(open) = self.open.get_mut(uri) else { return Vec::new() };
        let RunState::Ready(document, stopped) = &open.state else { return Vec::new() };
        let sources = document.sources();
        let main = sources.ids().next();
        let main_text = &open.text;
        let mut by_file: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        by_file.insert(uri.to_string(), Vec::new());
        for diagnostic in document.diagnostics() {
            let span = diagnostic.span();
            let at_home = !span.is_known() || Some(span.file) == main;
            let (home, text) = if at_home {
                (uri.to_string(), main_text.clone())
            } else {
                let name = sources.name(span.file).unwrap_or("");
                (uri_of(name), sources.text(span.file).map_or(String::new(), |t| t.to_string()))
            };
            let place = if span.is_known() {
                range(&text, span)
            } else {
                json!({"start": position(&text, 0), "end": position(&text, 0)})
            };
            let data = diagnostic.to_data(sources);
            let severity = match diagnostic.severity {
                Severity::Error => 1,
                Severity::Warning => 2,
                _ => 3,
            };
            let related: Vec<Value> =
                data.secondary.iter().map(|l| self::related(l, uri)).collect();
            by_file.entry(home).or_default().push(json!({
                "range": place,
                "severity": severity,
                "code": data.id,
                "source": "moldloft",
                "message": match *stopped && data.id == "cancelled" {
                    true => stopped_text(),
                    false => message(&data),
                },
                "relatedInformation": related,
            }));
        }
        let mut answers = Vec::new();
        let before = std::mem::take(&mut open.told);
        for gone in before.iter().filter(|uri| !by_file.contains_key(*uri)) {
            answers.push(published(gone, &Value::Null, &[]));
        }
        for (home, all) in &by_file {
            let version = if home == uri { open.version.clone() } else { Value::Null };
            answers.push(published(home, &version, all));
        }
        open.told = by_file.into_keys().filter(|home| home != uri).collect();
        answers
    }

    fn request(&mut self, method: &str, params: &Value) -> Result<Value, (i64, String)> {
        match method {
            "initialize" => return Ok(capabilities()),
            "shutdown" => {
                self.shut_down = true;
                return Ok(Value::Null);
            }
            _ => {}
        }
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        if !method.starts_with("textDocument/") {
            return Err((METHOD_NOT_FOUND, format!("unknown method `{method}`")));
        }
        let Some(open) = self.open.get_mut(&uri) else {
            return Err((REQUEST_FAILED, format!("`{uri}` is not open")));
        };
        let text = &open.text;
        if method == "textDocument/formatting" {
            return match moldloft::syntax::sdl::format(text) {
                Ok(new) if new == *text => Ok(json!([])),
                Ok(new) => {
                    let whole =
                        json!({"start": position(text, 0), "end": position(text, u32::MAX)});
                    Ok(json!([{"range": whole, "newText": new}]))
                }
                Err(_) => Err((REQUEST_FAILED, "the text has errors and is left as it is".into())),
            };
        }
        let RunState::Ready(document, _) = &mut open.state else {
            return match needs_run(method) {
                true => Err((REQUEST_FAILED, stopped_text())),
                false => Err((METHOD_NOT_FOUND, format!("unknown method `{method}`"))),
            };
        };
        let at = offset(text, &params["position"]);
        match method {
            "textDocument/hover" => Ok(match document.hover(at) {
                Some((said, span)) => json!({
                    "contents": {"kind": "markdown", "value": said},
                    "range": range(text, span),
                }),
                None => Value::Null,
            }),
            "textDocument/completion" => {
                let items = document.completions(at).into_iter().map(|c| {
                    let kind = match c.kind {
                        CompletionKind::Variable => 6,
                        CompletionKind::Object => 21,
                        CompletionKind::Function => 3,
                        CompletionKind::Kind => 7,
                        CompletionKind::Keyword => 14,
                        CompletionKind::Member => 5,
                    };
                    json!({"label": c.word, "kind": kind, "detail": c.detail})
                });
                Ok(json!({"isIncomplete": false, "items": items.collect::<Vec<_>>()}))
            }
            "textDocument/definition" => Ok(match document.definition(at) {
                Some(span) => {
                    let sources = document.sources();
                    if sources.ids().next() == Some(span.file) {
                        json!({"uri": uri, "range": range(text, span)})
                    } else {
                        let there = sources.text(span.file).map_or("", |t| t);
                        let name = sources.name(span.file).unwrap_or("");
                        json!({"uri": uri_of(name), "range": range(there, span)})
                    }
                }
                None => Value::Null,
            }),
            "textDocument/references" | "textDocument/documentHighlight" => {
                let spans = document.references(at);
                let places =
                    spans.into_iter().map(|s| json!({"uri": uri, "range": range(text, s)}));
                Ok(places.collect())
            }
            "textDocument/prepareRename" => match document.references(at).first() {
                Some(_) => {
                    let found = document.references(at);
                    let here = found.into_iter().find(|s| s.touches(at));
                    Ok(here.map_or(Value::Null, |span| range(text, span)))
                }
                None => Err((REQUEST_FAILED, "no name at this position".into())),
            },
            "textDocument/rename" => {
                let new = params["newName"].as_str().unwrap_or("");
                let spans = document.renamed(at, new).map_err(|why| (REQUEST_FAILED, why))?;
                let edits =
                    spans.into_iter().map(|s| json!({"range": range(text, s), "newText": new}));
                let edits: Vec<Value> = edits.collect();
                Ok(json!({"changes": {uri: edits}}))
            }
            "textDocument/documentSymbol" => {
                let symbols = document.symbols().into_iter().map(|(name, kind, span)| {
                    let kind = match kind {
                        CompletionKind::Function => 12,
                        CompletionKind::Object => 19,
                        _ => 13,
                    };
                    let place = range(text, span);
                    json!({"name": name, "kind": kind, "range": place, "selectionRange": place})
                });
                Ok(symbols.collect())
            }
            _ => Err((METHOD_NOT_FOUND, format!("unknown method `{method}`"))),
        }
    }
}

/// True for methods that are answered from what came of a text's run.
fn needs_run(method: &str) -> bool {
    let methods = [
        "hover",
        "completion",
        "definition",
        "references",
        "documentHighlight",
        "prepareRename",
        "rename",
        "documentSymbol",
    ];
    method.strip_prefix("textDocument/").is_some_and(|name| methods.contains(&name))
}

fn answered(id: &Value, answer: Result<Value, (i64, String)>) -> Value {
    match answer {
        Ok(result) => json!({"jsonrpc": "2.0", "id": id, "result": result}),
        Err((code, text)) => {
            json!({"jsonrpc": "2.0", "id": id, "error": {"code": code, "message": text}})
        }
    }
}

/// What is reported for a run that took too long.
fn stopped_text() -> String {
    format!(
        "the program was stopped after {} s, to keep the editor responsive\n\
         look for a loop whose condition always holds; `moldloft run` gives it more time",
        STOP_TIMEOUT.as_secs()
    )
}

/// What the server can do.
fn capabilities() -> Value {
    json!({
        "capabilities": {
            "textDocumentSync": {"openClose": true, "change": 2, "save": true},
            "hoverProvider": true,
            "completionProvider": {"triggerCharacters": ["."]},
            "definitionProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "renameProvider": {"prepareProvider": true},
            "documentFormattingProvider": true,
            "documentSymbolProvider": true,
        },
        "serverInfo": {"name": "moldloft-lsp", "version": env!("CARGO_PKG_VERSION")},
    })
}

fn published(uri: &str, version: &Value, all: &[Value]) -> Value {
    let mut params = json!({"uri": uri, "diagnostics": all});
    if !version.is_null() {
        params["version"] = version.clone();
    }
    json!({"jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params})
}

/// The text of a diagnostic: what is wrong, what was expected, how to fix it.
fn message(data: &DiagnosticData) -> String {
    let mut text = data.message.clone();
    for (word, said) in [("expected", &data.expected), ("found", &data.found)] {
        if let Some(said) = said {
            text.push_str(&format!("\n{word} {said}"));
        }
    }
    for said in data.notes.iter().chain(&data.help) {
        text.push_str(&format!("\n{said}"));
    }
    text
}

fn related(label: &LabelData, uri: &str) -> Value {
    let home = path_of(uri).map(|p| p.display().to_string());
    let same = home.as_deref() == Some(label.file.as_str()) || label.file == uri;
    let place = |line: u32, column: u32| json!({"line": line - 1, "character": column - 1});
    json!({
        "location": {
            "uri": if same { uri.to_string() } else { uri_of(&label.file) },
            "range": {
                "start": place(label.line, label.column),
                "end": place(label.end_line, label.end_column),
            },
        },
        "message": label.text,
    })
}

/// The model of a text: what it loads is sought beside its file.
fn opened(uri: &str, text: &str, budget: Arc<Budget>) -> Document {
    let (world, name): (Box<dyn World>, String) = match path_of(uri) {
        Some(path) => {
            let folder = path.parent().unwrap_or(Path::new(".")).to_path_buf();
            (Box::new(FileWorld::new(Some(&folder), &[])), path.display().to_string())
        }
        None => (Box::new(NoFiles), uri.to_string()),
    };
    Document::from_text_within(moldloft::document::registry(), world, (&name, text), budget)
}

/// The path of a file address.
fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let mut bytes = Vec::new();
    let mut at = rest.bytes();
    while let Some(b) = at.next() {
        if b == b'%' {
            let hex = [at.next()?, at.next()?];
            let hex = std::str::from_utf8(&hex).ok()?.to_string();
            bytes.push(u8::from_str_radix(&hex, 16).ok()?);
        } else {
            bytes.push(b);
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    // /C:/models on Windows.
    let drive = path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if drive { &path[1..] } else { &path }))
}

/// The address of a file; a built-in library is laid beside other temporary files to be shown.
fn uri_of(name: &str) -> String {
    let library = LIBRARIES.iter().find(|(file, _)| name.strip_prefix("moldloft:") == Some(file));
    let path = match library {
        Some((file, text)) => {
            let folder = std::env::temp_dir().join("moldloft-libraries");
            let path = folder.join(file);
            let same = std::fs::read_to_string(&path).is_ok_and(|there| there == *text);
            if !same {
                // Without the file the editor says itself that there is none.
                let _ = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, text));
            }
            path
        }
        None => PathBuf::from(name),
    };
    let spelled = path.display().to_string().replace('\\', "/");
    let mut uri = String::from(if spelled.starts_with('/') { "file://" } else { "file:///" });
    for b in spelled.bytes() {
        if b.is_ascii_alphanumeric() || b"/-._~:".contains(&b) {
            uri.push(b as char);
        } else {
            uri.push_str(&format!("%{b:02X}"));
        }
    }
    uri
}
