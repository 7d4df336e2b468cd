//! The engine: the process that runs the texts. It ends when the editor's side closes, or when a text ends it.

use crate::answers::capabilities;
use crate::places::lay_out_libraries;
use crate::server::{Event, Server, folders_of};
use crate::wire::to_front;
use lsp_server::{Connection, ErrorCode, Message, Response};
use serde_json::json;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Instant;

/// The most memory that the engine takes for the texts that are open.
const MEMORY: u64 = 2 << 30;

/// Confines this process and serves until the connection ends.
pub fn run() -> ExitCode {
    lay_out_libraries();
    let memory = moldloft::budget::usual_memory().min(MEMORY);
    moldloft::budget::confine(memory);
    let wire = to_front();
    let orderly = serve(&wire.connection);
    let flushed = wire.finish();
    if orderly && flushed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// True if the editor ended the session as the protocol requires.
fn serve(connection: &Connection) -> bool {
    let Ok((id, params)) = connection.initialize_start() else { return false };
    let reported = json!({
        "capabilities": capabilities(),
        "serverInfo": {"name": "moldloft-lsp", "version": env!("CARGO_PKG_VERSION")},
    });
    if connection.initialize_finish(id, reported).is_err() {
        return false;
    }
    let mut folders = folders_of(&params["workspaceFolders"]);
    if folders.is_empty() && params["rootUri"].is_string() {
        folders = folders_of(&json!([{"uri": params["rootUri"]}]));
    }
    let (sender, events) = mpsc::channel();
    let (messages, incoming) = (sender.clone(), connection.receiver.clone());
    std::thread::spawn(move || {
        for message in incoming {
            if messages.send(Event::Message(message)).is_err() {
                return;
            }
        }
        let _ = messages.send(Event::Gone);
    });
    let mut server = Server::new(sender, folders);
    let mut leaving = false;
    loop {
        let event = match server.deadline() {
            None => events.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(at) => events.recv_timeout(at.saturating_duration_since(Instant::now())),
        };
        match event {
            Ok(Event::Message(Message::Request(request))) => {
                if request.method == "shutdown" {
                    leaving = true;
                    let response = Response::new_ok(request.id, ());
                    let _ = connection.sender.send(response.into());
                    continue;
                }
                let id = request.id.clone();
                // A fault of an answer is an answer; the texts are as before.
                if catch_unwind(AssertUnwindSafe(|| server.request(request))).is_err() {
                    let code = ErrorCode::InternalError as i32;
                    let response = Response::new_err(id, code, "the answer failed".into());
                    let _ = connection.sender.send(response.into());
                }
            }
            Ok(Event::Message(Message::Notification(notice))) => {
                if notice.method == "exit" {
                    return leaving;
                }
                server.notice(notice);
            }
            Ok(Event::Message(Message::Response(_))) => {}
            Ok(Event::Ran(ran)) => server.ran(ran),
            Err(RecvTimeoutError::Timeout) => server.tick(),
            // The editor has gone without a word.
            Ok(Event::Gone) | Err(RecvTimeoutError::Disconnected) => return false,
        }
        for message in server.take_messages() {
            if connection.sender.send(message).is_err() {
                return false;
            }
        }
    }
}
