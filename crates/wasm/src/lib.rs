//! The engine inside of a page: a session in WebAssembly.
//!
//! `bytes in -> Session -> bytes out`
//!
//! The page allocates memory with `room`, writes a message there and calls `start` (once) or
//! `answer`; the result of `answer` is the length of the frame at `reply`. The message of `start`
//! is `u32 length, JSON, bytes of the files`; that of `answer` is a request in JSON.
//!
//! Files that the model requested and the page does not contain are listed by `missing`, so that a
//! page whose host has them can start again.
//!
//! A panic ends the instance, after `env.panicked` was given its message: the page makes another
//! one with the same text.
//!
//! Invariant: no computation here: `session` answers. The unsafe code is required for the linker's
//! names.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg(target_arch = "wasm32")]
#![allow(unsafe_code)]

mod pools;

use moldloft_budget::{Counting, Limits, limits, set_limits};
use moldloft_lang::{ReadText, TextReadError, World};
use moldloft_session::Session;
use serde::Deserialize;
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// Memory is counted, as everywhere: exceeding the limit is an error with a position.
#[global_allocator]
static ALLOCATOR: Counting<pools::Pools> = Counting::over(pools::Pools::new());

/// Limit of a model's memory, of the 4 GiB that an instance can have.
const MEMORY: u64 = 3 << 30;

#[link(wasm_import_module = "env")]
unsafe extern "C" {
    /// Takes the words of a panic.
    fn panicked(words: *const u8, length: usize);
}

/// Initial state of a page.
#[derive(Deserialize)]
struct InitialModel {
    /// The model's name; its extension determines the format.
    name: String,
    /// The text.
    text: String,
    /// The files that the model reads, by requested path.
    #[serde(default)]
    files: Vec<Carried>,
}

/// A file that the page carries.
#[derive(Deserialize)]
struct Carried {
    /// As the text spells it.
    path: String,
    /// Name of the requesting text.
    from: Option<String>,
    /// Its own name.
    name: String,
    /// Its first byte behind the JSON.
    offset: usize,
    /// Number.
    count: usize,
}

/// A file by the requested path, and the name of the requesting text.
type Asked = (String, Option<String>);

/// The files that the page carries, and no others.
struct CarriedFiles {
    files: HashMap<Asked, ReadText>,
    missing: Arc<Mutex<BTreeSet<Asked>>>,
}

impl World for CarriedFiles {
    fn read(&self, path: &str, from: Option<&str>) -> Result<ReadText, TextReadError> {
        let asked = (path.to_owned(), from.map(str::to_owned));
        let known = self.files.get(&asked).cloned();
        known.ok_or_else(|| {
            self.missing.lock().unwrap_or_else(PoisonError::into_inner).insert(asked);
            TextReadError {
                message: format!("cannot read `{path}`: this page does not carry it"),
                help: Some("`moldloft view` reads the files beside the model".into()),
            }
        })
    }
}

#[derive(Default)]
struct Engine {
    input: Vec<u8>,
    session: Option<Session>,
    reply: Vec<u8>,
    missing: Arc<Mutex<BTreeSet<Asked>>>,
}

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
}

/// Memory for a message of `bytes` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    ENGINE.with_borrow_mut(|engine| {
        engine.input.clear();
        engine.input.resize(bytes, 0);
        engine.input.as_mut_ptr()
    })
}

/// Starts with the model of the message; false if it is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn start() -> bool {
    std::panic::set_hook(Box::new(|info| {
        let words = info.to_string();
        // SAFETY: the host copies the words before it returns.
        unsafe { panicked(words.as_ptr(), words.len()) }
    }));
    set_limits(Limits { memory: MEMORY, ..limits() });
    ENGINE.with_borrow_mut(|engine| {
        let input = std::mem::take(&mut engine.input);
        engine.session = begun(&input, engine.missing.clone());
        engine.session.is_some()
    })
}

fn begun(message: &[u8], missing: Arc<Mutex<BTreeSet<Asked>>>) -> Option<Session> {
    let (length, rest) = message.split_first_chunk::<4>()?;
    let (json, bytes) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    let start: InitialModel = serde_json::from_slice(json).ok()?;
    let mut files = HashMap::new();
    for file in start.files {
        let data = bytes.get(file.offset..file.offset.checked_add(file.count)?)?;
        let read = ReadText { name: file.name, bytes: Arc::from(data) };
        files.insert((file.path, file.from), read);
    }
    let world = CarriedFiles { files, missing };
    Some(Session::new(Box::new(world), &start.name, &start.text))
}

/// Answers the request of the message; the length of the frame.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    ENGINE.with_borrow_mut(|engine| {
        let request = String::from_utf8_lossy(&engine.input);
        engine.reply = match &mut engine.session {
            Some(session) => session.answer(&request),
            None => Vec::new(),
        };
        engine.reply.len()
    })
}

/// The frame that `answer` made.
#[unsafe(no_mangle)]
pub extern "C" fn reply() -> *const u8 {
    ENGINE.with_borrow(|engine| engine.reply.as_ptr())
}

/// Makes a reply with the files that were requested and are not contained, as JSON `[[path, asker],
/// ...]`; returns its length.
#[unsafe(no_mangle)]
pub extern "C" fn missing() -> usize {
    ENGINE.with_borrow_mut(|engine| {
        let asked = engine.missing.lock().unwrap_or_else(PoisonError::into_inner);
        engine.reply = serde_json::json!(&*asked).to_string().into_bytes();
        engine.reply.len()
    })
}
