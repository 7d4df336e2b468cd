//! The language server `moldloft-lsp`: the language server protocol on standard input and output.
//!
//! `frames of JSON -> Server -> analysis of the text -> frames of JSON`
//!
//! Every open text is a [`moldloft_lang::Document`] that is run at each change, without writing any
//! file; all answers come from there.

mod frames;
mod position;
mod server;

use server::{Next, Server};
use std::io::{BufReader, BufWriter, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
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
    let mut input = BufReader::new(std::io::stdin().lock());
    let mut output = BufWriter::new(std::io::stdout().lock());
    let mut server = Server::default();
    loop {
        let message = match frames::read(&mut input) {
            Ok(Some(message)) => message,
            // The editor has gone without a word.
            Ok(None) => return ExitCode::FAILURE,
            Err(fault) => {
                eprintln!("error: {fault}");
                return ExitCode::FAILURE;
            }
        };
        let (answers, next) = server.handle(&message);
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
