//! The open texts and their runs: scheduling, reports, pending requests.

use crate::answers::{self, Answer};
use crate::index::{Index, OpenText};
use crate::lines::{LineIndex, apply};
use crate::places::{path_of, uri_of};
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification as note;
use lsp_types::notification::Notification as _;
use moldloft::budget::Budget;
use moldloft::diag::{DiagnosticData, LabelData, Severity, Sources};
use moldloft::document::{Document, NoFiles, OpenFiles, OpenTexts, World};
use moldloft::host::FileWorld;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Time limit of a program, so that an endless loop is reported soon.
const STOP_TIMEOUT: Duration = Duration::from_secs(2);
/// Maximum time for a stopped run to end; then it is abandoned.
const EXIT_TIMEOUT: Duration = Duration::from_secs(1);

/// The notice of the engine that a run of a text begins or has ended.
pub const RUNNING: &str = "$/moldloft/running";
/// The notice to the engine that a text ended an engine and is not run before it is changed.
pub const HELD: &str = "$/moldloft/held";

/// Events of the server.
pub enum Event {
    /// A message of the editor.
    Message(Message),
    /// The editor has gone.
    Gone,
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
pub struct OpenDocument {
    pub text: String,
    version: Option<i32>,
    changes: u64,
    /// Other texts that diagnostics of this one were reported for.
    reported: Vec<String>,
    state: RunState,
    /// Requests that wait for the end of the run.
    waiting: Vec<Request>,
}

/// State of a text's run.
enum RunState {
    /// Result of its run; true if that was stopped.
    Ready(Box<Document>, bool),
    Running(Running),
    /// Nothing: its run did not stop in time, or panicked.
    Unknown,
}

/// A run in progress, on a thread of its own.
struct Running {
    /// Number of the run.
    serial: u64,
    budget: Arc<Budget>,
    since: Instant,
    /// Time at which it was stopped.
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

/// The open texts. Programs run on threads of their own, so the server answers whatever a text
/// contains.
pub struct Server {
    open: BTreeMap<String, OpenDocument>,
    folders: Vec<PathBuf>,
    texts: Arc<OpenTexts>,
    index: Index,
    events: Sender<Event>,
    runs: u64,
    /// Texts that ended an engine, with the message about them.
    held: HashMap<String, String>,
    /// Messages to be sent with the next one.
    out: Vec<Message>,
}

impl Server {
    /// A server that receives the ends of its runs by these events; `folders` are those of the workspace.
    pub fn new(events: Sender<Event>, folders: Vec<PathBuf>) -> Self {
        Self {
            open: BTreeMap::new(),
            folders,
            texts: Arc::default(),
            index: Index::default(),
            events,
            runs: 0,
            held: HashMap::new(),
            out: Vec::new(),
        }
    }

    /// The messages ready to be sent.
    pub fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.out)
    }

    /// Answers a request, or keeps it until the run of its text is done.
    pub fn request(&mut self, request: Request) {
        let uri = request.params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        if let Some(open) = self.open.get_mut(&uri)
            && matches!(open.state, RunState::Running(_))
            && answers::needs_run(&request.method)
        {
            open.waiting.push(request);
            return;
        }
        let answer = self.answer(&request);
        self.respond(request.id, answer);
    }

    fn respond(&mut self, id: RequestId, answer: Answer) {
        let response = match answer {
            Ok(value) => Response::new_ok(id, value),
            Err((code, text)) => Response::new_err(id, code, text),
        };
        self.out.push(response.into());
    }

    fn answer(&mut self, request: &Request) -> Answer {
        let (method, params) = (request.method.as_str(), &request.params);
        let uri = params["textDocument"]["uri"].as_str().unwrap_or("").to_string();
        if answers::needs_workspace(method) {
            return self.of_workspace(method, params, &uri);
        }
        if !method.starts_with("textDocument/") {
            return Err(unknown(method));
        }
        let Some(open) = self.open.get_mut(&uri) else {
            return Err((ErrorCode::RequestFailed as i32, format!("`{uri}` is not open")));
        };
        if let Some(answer) = answers::of_text(method, &open.text) {
            return answer;
        }
        match &mut open.state {
            RunState::Ready(document, _) => {
                let folder = path_of(&uri).and_then(|path| Some(path.parent()?.to_path_buf()));
                let asked = answers::Asked { uri: &uri, text: &open.text, folder };
                answers::of_document(method, params, document, &asked)
            }
            _ if answers::needs_run(method) => {
                Err((ErrorCode::RequestFailed as i32, stopped_text()))
            }
            _ => Err(unknown(method)),
        }
    }

    /// Answers about the names of all texts of the workspace.
    fn of_workspace(&mut self, method: &str, params: &Value, uri: &str) -> Answer {
        let open: Vec<OpenText> =
            self.open.iter().map(|(uri, o)| (uri.as_str(), o.changes, o.text.as_str())).collect();
        self.index.refresh(&self.folders, &open);
        // Declarations of kinds, functions and libraries are known to a run only.
        let document = self.open.get(uri).and_then(|o| match &o.state {
            RunState::Ready(document, _) => Some(&**document),
            _ => None,
        });
        answers::of_workspace(method, params, uri, &self.index, &open, document)
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
    pub fn tick(&mut self) {
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
        for (uri, outdated) in late {
            if outdated {
                self.start(&uri, None);
                continue;
            }
            self.publish_one(&uri, "cancelled", &stopped_text());
            if let Some(open) = self.open.get_mut(&uri) {
                open.state = RunState::Unknown;
            }
            self.answer_waiting(&uri);
        }
    }

    /// Receives the result of a run.
    pub fn ran(&mut self, ran: Ran) {
        let Ran { uri, serial, document } = ran;
        self.out.push(running(&uri, serial, false));
        let Some(open) = self.open.get_mut(&uri) else { return };
        let RunState::Running(running) = &open.state else { return };
        if running.serial != serial {
            return;
        }
        if running.outdated {
            self.start(&uri, document);
            return;
        }
        let stopped = running.stopped.is_some();
        open.state = match document {
            Some(document) => RunState::Ready(document, stopped),
            None => RunState::Unknown,
        };
        self.publish(&uri);
        self.answer_waiting(&uri);
    }

    fn answer_waiting(&mut self, uri: &str) {
        let waiting = self.open.get_mut(uri).map(|open| std::mem::take(&mut open.waiting));
        for request in waiting.unwrap_or_default() {
            let answer = self.answer(&request);
            self.respond(request.id, answer);
        }
    }

    /// Runs the present text, on the document of its last run if there is one.
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
        self.out.push(running(uri, self.runs, true));
        let (uri, text, serial) = (uri.to_string(), open.text.clone(), self.runs);
        let (events, texts) = (self.events.clone(), self.texts.clone());
        // As much as a program's first thread has, for texts that nest deeply.
        let thread = std::thread::Builder::new().stack_size(8 << 20);
        let begun = thread.spawn(move || {
            let run = AssertUnwindSafe(|| {
                let _timed = budget.timed();
                match document {
                    Some(mut document) => {
                        document.set_text(&text);
                        document
                    }
                    None => Box::new(opened(&uri, &text, budget.clone(), texts)),
                }
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

    /// Runs a text again: at once, or as soon as the current run has stopped.
    fn run_again(&mut self, uri: &str, afresh: bool) {
        let Some(open) = self.open.get_mut(uri) else { return };
        match std::mem::replace(&mut open.state, RunState::Unknown) {
            RunState::Running(mut running) => {
                running.stop();
                running.outdated = true;
                let late = running.deadline() <= Instant::now();
                open.state = RunState::Running(running);
                self.refuse_waiting(uri, "the text was changed");
                if late || afresh {
                    self.start(uri, None);
                }
            }
            RunState::Ready(document, _) => self.start(uri, Some(document).filter(|_| !afresh)),
            RunState::Unknown => self.start(uri, None),
        }
    }

    /// Pending requests refer to an earlier text.
    fn refuse_waiting(&mut self, uri: &str, why: &str) {
        let Some(open) = self.open.get_mut(uri) else { return };
        for request in std::mem::take(&mut open.waiting) {
            self.respond(request.id, Err((ErrorCode::ContentModified as i32, why.into())));
        }
    }

    /// Handles a notification; an invalid one is ignored, as the protocol requires.
    pub fn notice(&mut self, notice: Notification) {
        match notice.method.as_str() {
            note::DidOpenTextDocument::METHOD => {
                if let Ok(params) =
                    serde_json::from_value::<lsp_types::DidOpenTextDocumentParams>(notice.params)
                {
                    self.opened(params.text_document);
                }
            }
            note::DidChangeTextDocument::METHOD => {
                if let Ok(params) =
                    serde_json::from_value::<lsp_types::DidChangeTextDocumentParams>(notice.params)
                {
                    self.changed(&params);
                }
            }
            note::DidSaveTextDocument::METHOD => {
                // Other texts may read the saved file by other functions than `load`.
                let uri = notice.params["textDocument"]["uri"].as_str().unwrap_or("");
                let all: Vec<String> = self.open.keys().filter(|o| *o != uri).cloned().collect();
                all.iter().for_each(|other| self.run_again(other, true));
            }
            note::DidCloseTextDocument::METHOD => {
                let uri = notice.params["textDocument"]["uri"].as_str().unwrap_or("");
                self.closed(&uri.to_string());
            }
            note::DidChangeWorkspaceFolders::METHOD => {
                let event = &notice.params["event"];
                let folders = |key: &str| folders_of(&event[key]);
                let removed = folders("removed");
                self.folders.retain(|folder| !removed.contains(folder));
                self.folders.extend(folders("added"));
            }
            HELD => {
                let said = |key: &str| notice.params[key].as_str().unwrap_or("").to_string();
                self.held.insert(said("uri"), said("message"));
            }
            _ => {}
        }
    }

    fn opened(&mut self, item: lsp_types::TextDocumentItem) {
        let uri = item.uri.to_string();
        self.stop(&uri);
        let open = OpenDocument {
            text: item.text,
            version: Some(item.version),
            changes: self.open.get(&uri).map_or(0, |before| before.changes + 1),
            reported: Vec::new(),
            state: RunState::Unknown,
            waiting: Vec::new(),
        };
        self.open.insert(uri.clone(), open);
        self.buffer(&uri);
        match self.held.get(&uri).cloned() {
            Some(why) => self.publish_one(&uri, "engine-ended", &why),
            None => self.start(&uri, None),
        }
    }

    fn changed(&mut self, params: &lsp_types::DidChangeTextDocumentParams) {
        let uri = params.text_document.uri.to_string();
        let Some(open) = self.open.get_mut(&uri) else { return };
        apply(&mut open.text, &params.content_changes);
        open.version = Some(params.text_document.version);
        open.changes += 1;
        self.held.remove(&uri);
        self.buffer(&uri);
        self.run_again(&uri, false);
        self.run_dependents(&uri);
    }

    fn closed(&mut self, uri: &String) {
        self.stop(uri);
        let Some(open) = self.open.remove(uri) else { return };
        if let Some(path) = path_of(uri).and_then(|path| path.canonicalize().ok()) {
            self.texts.put(&path.display().to_string(), None);
        }
        for uri in std::iter::once(uri.clone()).chain(open.reported) {
            self.out.push(published(&uri, None, &[]));
        }
        // They see the file as it is saved from now on.
        self.run_dependents(uri);
    }

    /// Other texts use the open text, not the saved one.
    fn buffer(&mut self, uri: &str) {
        let path = path_of(uri).and_then(|path| path.canonicalize().ok());
        if let (Some(path), Some(open)) = (path, self.open.get(uri)) {
            self.texts.put(&path.display().to_string(), Some(&open.text));
        }
    }

    /// Runs the open texts again that read the file of this one.
    fn run_dependents(&mut self, uri: &str) {
        let Some(path) = path_of(uri).and_then(|path| path.canonicalize().ok()) else { return };
        let reads = |document: &Document| {
            let sources: &Sources = document.sources();
            sources.ids().skip(1).any(|id| sources.name(id).is_some_and(|n| Path::new(n) == path))
        };
        let others = self.open.iter().filter(|(other, open)| {
            other.as_str() != uri
                && match &open.state {
                    RunState::Ready(document, _) => reads(document),
                    RunState::Running(_) => true,
                    RunState::Unknown => false,
                }
        });
        let others: Vec<String> = others.map(|(other, _)| other.clone()).collect();
        others.iter().for_each(|other| self.run_again(other, true));
    }

    /// Stops the run of a text; nobody waits for its end.
    fn stop(&mut self, uri: &str) {
        if let Some(open) = self.open.get_mut(uri)
            && let RunState::Running(running) = &mut open.state
        {
            running.stop();
        }
        self.refuse_waiting(uri, "the text was closed");
    }

    /// One error about a text as a whole.
    fn publish_one(&mut self, uri: &str, code: &str, message: &str) {
        let place = json!({"line": 0, "character": 0});
        let diagnostic = json!({
            "range": {"start": place, "end": place},
            "severity": 1,
            "code": code,
            "source": "moldloft",
            "message": message,
        });
        let version = self.open.get(uri).and_then(|open| open.version);
        self.out.push(published(uri, version, &[diagnostic]));
    }

    /// Reports the diagnostics of a text, by the files that they are about.
    fn publish(&mut self, uri: &str) {
        let Some(open) = self.open.get_mut(uri) else { return };
        let RunState::Ready(document, stopped) = &open.state else { return };
        let sources = document.sources();
        let main = sources.ids().next();
        let own = LineIndex::new(&open.text);
        let mut by_file: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        by_file.insert(uri.to_string(), Vec::new());
        for diagnostic in document.diagnostics() {
            let span = diagnostic.span();
            let at_home = !span.is_known() || Some(span.file) == main;
            let (home, range) = if at_home {
                (uri.to_string(), own.range(span.start, span.end))
            } else {
                let name = sources.name(span.file).unwrap_or("");
                let text = sources.text(span.file).map_or("", |text| text);
                (uri_of(name), LineIndex::new(text).range(span.start, span.end))
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
                "range": range,
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
        let before = std::mem::take(&mut open.reported);
        for gone in before.iter().filter(|uri| !by_file.contains_key(*uri)) {
            self.out.push(published(gone, None, &[]));
        }
        for (home, all) in &by_file {
            let version = open.version.filter(|_| home == uri);
            self.out.push(published(home, version, all));
        }
        open.reported = by_file.into_keys().filter(|home| home != uri).collect();
    }
}

/// The error for a method that the server does not know.
pub fn unknown(method: &str) -> (i32, String) {
    (ErrorCode::MethodNotFound as i32, format!("unknown method `{method}`"))
}

/// The folders of a list of `{uri, name}`, links resolved.
pub fn folders_of(list: &Value) -> Vec<PathBuf> {
    let all = list.as_array().into_iter().flatten();
    all.filter_map(|folder| path_of(folder["uri"].as_str()?)?.canonicalize().ok()).collect()
}

fn running(uri: &str, serial: u64, begins: bool) -> Message {
    let params = json!({"uri": uri, "serial": serial, "begins": begins});
    Notification::new(RUNNING.into(), params).into()
}

/// The report of a run that exceeded its time.
fn stopped_text() -> String {
    format!(
        "the program was stopped after {} s, to keep the editor responsive\n\
         look for a loop whose condition always holds; `moldloft run` gives it more time",
        STOP_TIMEOUT.as_secs()
    )
}

fn published(uri: &str, version: Option<i32>, all: &[Value]) -> Message {
    let mut params = json!({"uri": uri, "diagnostics": all});
    if let Some(version) = version {
        params["version"] = version.into();
    }
    Notification::new(note::PublishDiagnostics::METHOD.into(), params).into()
}

/// The text of a diagnostic: fault, expectation, remedy.
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

/// The model of a text, which loads files from the folder of its file.
fn opened(uri: &str, text: &str, budget: Arc<Budget>, texts: Arc<OpenTexts>) -> Document {
    let (world, name): (Box<dyn World>, String) = match path_of(uri) {
        Some(path) => {
            let files = FileWorld::new(path.parent(), &[]);
            (Box::new(OpenFiles::new(files, texts)), path.display().to_string())
        }
        None => (Box::new(NoFiles), uri.to_string()),
    };
    Document::edited(moldloft::document::registry(), world, (&name, text), budget)
}
