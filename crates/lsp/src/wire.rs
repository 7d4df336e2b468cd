//! Messages as they travel: to the editor with the headers of its protocol, between front and engine in frames.
//!
//! Bytes of an editor that make no message are answered with an error, and the next message is read.

use lsp_server::{Connection, ErrorCode, Message};
use moldloft::budget::{read_frame, write_frame};
use serde_json::{Value, json};
use std::io::{self, BufRead, Read, Write};
use std::thread::JoinHandle;

/// The longest message of an editor, in bytes.
const LONGEST: u64 = 512 << 20;

const LONGEST_LINE: u64 = 8 << 10;

/// A connection, and the thread that writes its messages.
pub struct MessageWire {
    pub connection: Connection,
    writer: JoinHandle<io::Result<()>>,
}

impl MessageWire {
    /// True when everything that was sent is written.
    pub fn finish(self) -> bool {
        drop(self.connection);
        self.writer.join().is_ok_and(|written| written.is_ok())
    }

    /// `read` returns the next messages, `None` at the end; `write` sends one.
    fn of(
        mut read: impl FnMut() -> io::Result<Option<Vec<Message>>> + Send + 'static,
        mut write: impl FnMut(&Message) -> io::Result<()> + Send + 'static,
    ) -> Self {
        let (connection, far) = Connection::memory();
        let (messages, sent) = (far.sender, far.receiver);
        // It waits for input, also when the other side has gone: nobody joins it.
        std::thread::spawn(move || {
            while let Ok(Some(all)) = read() {
                for message in all {
                    if messages.send(message).is_err() {
                        return;
                    }
                }
            }
        });
        let writer = std::thread::spawn(move || sent.into_iter().try_for_each(|m| write(&m)));
        Self { connection, writer }
    }
}

/// To the editor: standard input and output of the front.
pub fn to_editor() -> MessageWire {
    let write = |message: &Message| message.write(&mut io::stdout().lock());
    MessageWire::of(move || editors_messages(&mut io::stdin().lock(), &mut io::stdout()), write)
}

/// To the front: standard input and output of the engine.
pub fn to_front() -> MessageWire {
    let read = || Ok(read_message(&mut io::stdin().lock())?.map(|message| vec![message]));
    MessageWire::of(read, |message| write_message(&mut io::stdout().lock(), message))
}

/// A message of one of the two processes of ours to the other.
pub fn read_message(input: &mut impl Read) -> io::Result<Option<Message>> {
    match read_frame(input)? {
        None => Ok(None),
        Some(frame) => Ok(Some(serde_json::from_slice(&frame)?)),
    }
}

/// Sends such a message.
pub fn write_message(output: &mut impl Write, message: &Message) -> io::Result<()> {
    write_frame(output, &serde_json::to_vec(message)?)
}

/// The next input of an editor, headers and one message or a batch; errors are answered on
/// `output`, and give no message. `None` at the end.
///
/// # Errors
/// Those of `input` and `output`.
pub fn editors_messages(
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> io::Result<Option<Vec<Message>>> {
    let mut refuse = |id: &Value, code: ErrorCode, why: &str| {
        let error = json!({"code": code as i32, "message": why});
        let text = json!({"jsonrpc": "2.0", "id": id, "error": error}).to_string();
        // All at once: another thread writes, too, and may do so while this one waits for input.
        output.write_all(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes())?;
        output.flush()
    };
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line).trim().to_ascii_lowercase();
        match line.split_once(':') {
            None if !line.is_empty() => {
                refuse(&Value::Null, ErrorCode::ParseError, "expected a header")?;
                length = None;
            }
            None if length.is_some() => break,
            Some(("content-length", count)) => {
                length = count.trim().parse::<u64>().ok().filter(|count| *count <= LONGEST);
                if length.is_none() {
                    let why = format!("Content-Length is a number of at most {LONGEST}");
                    refuse(&Value::Null, ErrorCode::ParseError, &why)?;
                }
            }
            _ => {}
        }
    }
    let length = length.unwrap_or(0);
    let mut body = Vec::new();
    input.by_ref().take(length).read_to_end(&mut body)?;
    if (body.len() as u64) < length {
        return Ok(None);
    }
    let all = match serde_json::from_slice(&body) {
        Ok(Value::Array(all)) if !all.is_empty() => all,
        Ok(Value::Array(_)) => vec![Value::Null],
        Ok(one) => vec![one],
        Err(error) => {
            refuse(&Value::Null, ErrorCode::ParseError, &format!("expected JSON: {error}"))?;
            return Ok(Some(Vec::new()));
        }
    };
    let mut messages = Vec::new();
    for one in all {
        let id = one.get("id").cloned().unwrap_or(Value::Null);
        match serde_json::from_value(one) {
            Ok(message) => messages.push(message),
            Err(_) => refuse(&id, ErrorCode::InvalidRequest, "expected a message of JSON-RPC")?,
        }
    }
    Ok(Some(messages))
}
