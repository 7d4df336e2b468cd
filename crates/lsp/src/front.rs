//! The process that the editor starts: it passes messages to the engine and back, keeps the texts, and starts another
//! engine when one ends.
//!
//! Invariant: runs nothing and computes nothing, so that no text can end it; a text is never lost with an engine.

use crate::lines::apply;
use crate::server::{HELD, RUNNING};
use crate::wire::{read_message, to_editor, write_message};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{self as note, Notification as _};
use lsp_types::{DidChangeTextDocumentParams, DidOpenTextDocumentParams, TextDocumentItem};
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ffi::OsString;
use std::io::{BufReader, BufWriter};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, ExitCode, Stdio};
use std::sync::mpsc::{self, Sender};
use std::time::{Duration, Instant};

/// The id of the request that begins another engine; the editor does not see it.
const BEGIN_AGAIN: &str = "moldloft-begin-again";

/// Ends of engines without a message of the editor between them, after which no other is started.
const MOST_ENDS: u32 = 5;

/// Maximum wait at the end of a session for pending answers.
const EXIT_TIMEOUT: Duration = Duration::from_secs(10);

enum FrontEvent {
    Editor(Message),
    EditorGone,
    Engine(u32, Message),
    EngineGone(u32),
}

/// Command that starts an engine: a program that calls [`crate::engine`](crate::engine()).
#[derive(Clone, Debug)]
pub struct EngineCommand {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<OsString>,
}

struct EngineProcess {
    number: u32,
    child: Child,
    input: BufWriter<ChildStdin>,
}

impl EngineProcess {
    fn start(
        number: u32,
        command: &EngineCommand,
        events: &Sender<FrontEvent>,
    ) -> std::io::Result<Self> {
        let mut child = Command::new(&command.program)
            .args(&command.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let taken = "a pipe was requested";
        let input = BufWriter::new(child.stdin.take().expect(taken));
        let mut output = BufReader::new(child.stdout.take().expect(taken));
        // The engine may not write files, which standard error may be.
        let mut errors = child.stderr.take().expect(taken);
        std::thread::spawn(move || std::io::copy(&mut errors, &mut std::io::stderr()));
        let events = events.clone();
        std::thread::spawn(move || {
            while let Ok(Some(message)) = read_message(&mut output) {
                if events.send(FrontEvent::Engine(number, message)).is_err() {
                    return;
                }
            }
            let _ = events.send(FrontEvent::EngineGone(number));
        });
        Ok(Self { number, child, input })
    }

    /// That the pipe is closed shows when its output ends.
    fn send(&mut self, message: &Message) {
        let _ = write_message(&mut self.input, message);
    }

    /// Ends it, and says how it ended.
    fn ended(mut self) -> String {
        drop(self.input);
        let _ = self.child.kill();
        match self.child.wait() {
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        }
    }
}

/// State from which a new engine continues after another ended.
struct EditorFront<'c> {
    editor: &'c Connection,
    engine: EngineProcess,
    command: EngineCommand,
    events: Sender<FrontEvent>,
    begin: Option<Request>,
    begun: bool,
    texts: BTreeMap<String, TextDocumentItem>,
    /// Texts that ended an engine, with the message about them.
    held: BTreeMap<String, String>,
    /// Current runs: text and number.
    running: HashSet<(String, u64)>,
    /// Requests without an answer so far.
    pending: HashMap<RequestId, String>,
    /// Ends of engines since the editor's last message.
    ends: u32,
    leaving: bool,
}

/// Serves until the editor disconnects; a success if it ended the session as the protocol requires.
pub fn run(command: EngineCommand) -> ExitCode {
    let wire = to_editor();
    let (events, received) = mpsc::channel();
    let (messages, incoming) = (events.clone(), wire.connection.receiver.clone());
    std::thread::spawn(move || {
        for message in incoming {
            if messages.send(FrontEvent::Editor(message)).is_err() {
                return;
            }
        }
        let _ = messages.send(FrontEvent::EditorGone);
    });
    let engine = match EngineProcess::start(0, &command, &events) {
        Ok(engine) => engine,
        Err(error) => {
            eprintln!("error: the engine cannot be started: {error}");
            return ExitCode::FAILURE;
        }
    };
    let mut front = EditorFront {
        editor: &wire.connection,
        engine,
        command,
        events,
        begin: None,
        begun: false,
        texts: BTreeMap::new(),
        held: BTreeMap::new(),
        running: HashSet::new(),
        pending: HashMap::new(),
        ends: 0,
        leaving: false,
    };
    let mut orderly = false;
    for event in &received {
        match event {
            FrontEvent::Editor(message) => {
                if let Message::Notification(notice) = &message
                    && notice.method == note::Exit::METHOD
                {
                    orderly = front.leaving;
                    break;
                }
                front.take_editors(message);
            }
            FrontEvent::Engine(number, message) if number == front.engine.number => {
                front.take_engines(message);
            }
            FrontEvent::EngineGone(number) if number == front.engine.number && !front.leaving => {
                if !front.begin_again() {
                    break;
                }
            }
            // The editor has gone without a word.
            FrontEvent::EditorGone => break,
            FrontEvent::Engine(..) | FrontEvent::EngineGone(_) => {}
        }
    }
    // An editor that sends everything at once still gets the requested answers.
    let deadline = Instant::now() + EXIT_TIMEOUT;
    while orderly && !front.pending.is_empty() {
        match received.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(FrontEvent::Engine(number, message)) if number == front.engine.number => {
                front.take_engines(message);
            }
            Ok(FrontEvent::EngineGone(number)) if number == front.engine.number => break,
            Ok(_) => {}
            Err(_) => break,
        }
    }
    front.engine.ended();
    let written = wire.finish();
    if orderly && written { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

impl EditorFront<'_> {
    fn to_editor(&self, message: impl Into<Message>) {
        // An editor that has gone is noticed by the end of its messages.
        let _ = self.editor.sender.send(message.into());
    }

    fn take_editors(&mut self, message: Message) {
        self.ends = 0;
        match &message {
            Message::Request(request) => {
                self.pending.insert(request.id.clone(), request.method.clone());
                match request.method.as_str() {
                    "initialize" => self.begin = Some(request.clone()),
                    "shutdown" => self.leaving = true,
                    _ => {}
                }
            }
            Message::Notification(notice) => self.keep(notice),
            Message::Response(_) => {}
        }
        self.engine.send(&message);
    }

    /// Records the texts of a notification.
    fn keep(&mut self, notice: &Notification) {
        match notice.method.as_str() {
            note::Initialized::METHOD => self.begun = true,
            note::DidOpenTextDocument::METHOD => {
                let opened =
                    serde_json::from_value::<DidOpenTextDocumentParams>(notice.params.clone());
                if let Ok(opened) = opened {
                    let item = opened.text_document;
                    self.texts.insert(item.uri.to_string(), item);
                }
            }
            note::DidChangeTextDocument::METHOD => {
                let changed =
                    serde_json::from_value::<DidChangeTextDocumentParams>(notice.params.clone());
                if let Ok(changed) = changed
                    && let Some(item) = self.texts.get_mut(&changed.text_document.uri.to_string())
                {
                    apply(&mut item.text, &changed.content_changes);
                    item.version = changed.text_document.version;
                    self.held.remove(&changed.text_document.uri.to_string());
                }
            }
            note::DidCloseTextDocument::METHOD => {
                let uri = notice.params["textDocument"]["uri"].as_str().unwrap_or("");
                self.texts.remove(uri);
                self.held.remove(uri);
            }
            _ => {}
        }
    }

    fn take_engines(&mut self, message: Message) {
        match &message {
            Message::Response(response) => {
                if response.id == RequestId::from(BEGIN_AGAIN.to_string()) {
                    self.hand_over();
                    return;
                }
                self.pending.remove(&response.id);
            }
            Message::Notification(notice) if notice.method == RUNNING => {
                let uri = notice.params["uri"].as_str().unwrap_or("").to_string();
                let run = (uri, notice.params["serial"].as_u64().unwrap_or(0));
                if notice.params["begins"] == true {
                    self.running.insert(run);
                } else {
                    self.running.remove(&run);
                }
                return;
            }
            _ => {}
        }
        self.to_editor(message);
    }

    /// Starts another engine in place of the one that ended; false when that makes no sense.
    fn begin_again(&mut self) -> bool {
        self.ends += 1;
        let started = EngineProcess::start(self.engine.number + 1, &self.command, &self.events);
        let Ok(engine) = started else {
            eprintln!("error: the engine ended and another cannot be started");
            return false;
        };
        let how = std::mem::replace(&mut self.engine, engine).ended();
        let why = format!(
            "this text ended the process that ran it ({how}); it runs again when it is changed"
        );
        // The running text ended it. If there was none, no text is run after a few ends.
        let mut blamed: Vec<String> = self.running.drain().map(|(uri, _)| uri).collect();
        if blamed.is_empty() && self.ends > 1 {
            blamed = self.texts.keys().cloned().collect();
        }
        for uri in &blamed {
            self.held.insert(uri.clone(), why.clone());
        }
        let said = format!("the engine ended ({how}) and was started again; all texts are kept");
        let reported = json!({"type": 2, "message": said});
        self.to_editor(Notification::new(note::LogMessage::METHOD.into(), reported));
        for (id, method) in std::mem::take(&mut self.pending) {
            if method == "initialize" {
                self.pending.insert(id, method);
                continue;
            }
            let code = ErrorCode::RequestFailed as i32;
            self.to_editor(Response::new_err(id, code, format!("the engine ended ({how})")));
        }
        if self.ends > MOST_ENDS {
            eprintln!("error: the engine ends again and again ({how})");
            return false;
        }
        let Some(begin) = self.begin.clone() else { return true };
        // Before the editor has its answer, the new engine gives it.
        let id = match self.begun {
            true => RequestId::from(BEGIN_AGAIN.to_string()),
            false => begin.id.clone(),
        };
        self.engine.send(&Request { id, ..begin }.into());
        true
    }

    /// Gives the texts to an engine that has begun.
    fn hand_over(&mut self) {
        let initialized = Notification::new(note::Initialized::METHOD.into(), json!({}));
        self.engine.send(&initialized.into());
        for (uri, why) in &self.held {
            let params: Value = json!({"uri": uri, "message": why});
            self.engine.send(&Notification::new(HELD.into(), params).into());
        }
        for item in self.texts.values() {
            let params = json!({"textDocument": item});
            let opened = Notification::new(note::DidOpenTextDocument::METHOD.into(), params);
            self.engine.send(&opened.into());
        }
    }
}
