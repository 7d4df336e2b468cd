//! The language server `moldloft-lsp`: the language server protocol on standard input and output.
//!
//! `frames of JSON -> Server -> analysis of the text -> frames of JSON`
//!
//! Every open text is a [`moldloft::document::Document`] that is run at each change, without writing any
//! file, on a thread of its own; all answers come from there. A change stops the run under way, and one
//! that does not come to an end soon is stopped and reported.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod frames;
mod position;
mod server;

use moldloft::budget::Limits;
use server::{Event, Next, Server};
use std::io::{BufReader, BufWriter, Write};
use std::process::ExitCode;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Instant;

/// Counts the bytes that are held, for [`moldloft::budget::Budget`].
#[global_allocator]
static ALLOCATOR: moldloft::budget::Counting = moldloft::budget::Counting;

/// The most memory that the server takes for the texts that are open.
const MEMORY: u64 = 2 << 30;

fn main() -> ExitCode {
    let memory = moldloft::budget::usual_memory().min(MEMORY);
    moldloft::budget::set_limits(Limits { memory, ..Limits::USUAL });
    if let Some(word) = std::env::args().nth(1) {
        if word == "--version" || word == "-V" {
            println!("moldloft-lsp {}", env!("CARGO_PKG_VERSION"));
            return ExitCode::SUCCESS;
        }
        if word != "--stdio" {
            eprintln!(
                "error: unknown argument `{word}`; moldloft-lsp speaks on standard input and output"
            );
            return ExitCode::from(2);
        }
    }
    let (sender, events) = mpsc::channel();
    let messages = sender.clone();
    std::thread::spawn(move || {
        let mut input = BufReader::new(std::io::stdin().lock());
        loop {
            let message = frames::read(&mut input);
            let last = !matches!(message, Ok(Some(_)));
            if messages.send(Event::Message(message)).is_err() || last {
                return;
            }
        }
    });
    let mut output = BufWriter::new(std::io::stdout().lock());
    let mut server = Server::new(sender);
    loop {
        let event = match server.deadline() {
            None => events.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(at) => events.recv_timeout(at.saturating_duration_since(Instant::now())),
        };
        let (answers, next) = match event {
            Ok(Event::Message(Ok(Some(message)))) => server.handle(&message),
            Ok(Event::Ran(ran)) => (server.ran(ran), Next::Message),
            Err(RecvTimeoutError::Timeout) => (server.tick(), Next::Message),
            // The editor has gone without a word.
            Ok(Event::Message(Ok(None))) | Err(RecvTimeoutError::Disconnected) => {
                return ExitCode::FAILURE;
            }
            Ok(Event::Message(Err(fault))) => {
                eprintln!("error: {fault}");
                return ExitCode::FAILURE;
            }
        };
        for answer in answers {
            if frames::write(&mut output, &answer).and_then(|()| output.flush()).is_err() {
                return ExitCode::FAILURE;
            }
        }
        match next {
            Next::Message => {}
            Next::End { orderly: true } => return ExitCode::SUCCESS,
            Next::End { orderly: false } => return ExitCode::FAILURE,
        }
    }
}
