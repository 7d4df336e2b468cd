//! The engine process: a session on standard input and output.
//!
//! `request -> Session -> reply`, each in a frame of [`read_frame`].
//!
//! The parent has the text and may end this process at any time. A request `cancel` stops the last one before it, when
//! it has no answer yet; everything else is answered in order.

use moldloft::budget::{Budget, read_frame, write_frame};
use moldloft::document::ReadText;
use moldloft::host::FileWorld;
use moldloft::session::Session;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};

/// Message that stops the current work.
const CANCEL: &[u8] = br#"{"kind":"cancel"}"#;

/// Stack of the working thread, for texts that nest deeply.
const STACK: usize = 64 << 20;

/// Limits the process's memory for models, and answers requests until standard input ends. The
/// first message is the text.
#[pyfunction]
pub fn engine(
    py: Python<'_>,
    memory: u64,
    name: String,
    folder: Option<String>,
    library: Vec<String>,
) {
    moldloft::budget::confine(memory);
    py.detach(|| {
        let worker = std::thread::Builder::new().stack_size(STACK);
        let run = worker.spawn(move || serve(&name, folder.as_deref(), &library));
        if let Ok(run) = run {
            let _ = run.join();
        }
    });
}

/// Numbers of requests, so that a cancellation reaches only the request that it was sent for.
struct Turns {
    budget: Arc<Budget>,
    counts: Mutex<TurnCounts>,
}

#[derive(Default)]
struct TurnCounts {
    /// Requests that have come in.
    received: u64,
    /// The last request that was begun.
    begun: u64,
    /// True while it is running.
    running: bool,
    /// The request that is to be stopped when it begins.
    stopped: Option<u64>,
}

impl Turns {
    fn counts(&self) -> MutexGuard<'_, TurnCounts> {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn receive(&self) {
        self.counts().received += 1;
    }

    fn cancel(&self) {
        let mut counts = self.counts();
        if counts.begun < counts.received {
            counts.stopped = Some(counts.received);
        } else if counts.running {
            self.budget.cancel();
        }
    }

    fn begin(&self) {
        let mut counts = self.counts();
        counts.begun += 1;
        counts.running = true;
        if counts.stopped == Some(counts.begun) {
            self.budget.cancel();
        }
    }

    fn end(&self) {
        let mut counts = self.counts();
        counts.running = false;
        self.budget.resume();
    }
}

fn serve(name: &str, folder: Option<&str>, library: &[String]) {
    let budget = Arc::<Budget>::default();
    let (sender, requests) = mpsc::channel::<String>();
    let turns = Arc::new(Turns { budget: budget.clone(), counts: Mutex::default() });
    let shared = turns.clone();
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock();
        while let Ok(Some(message)) = read_frame(&mut input) {
            if message == CANCEL {
                shared.cancel();
                continue;
            }
            shared.receive();
            if sender.send(String::from_utf8_lossy(&message).into_owned()).is_err() {
                return;
            }
        }
    });
    let Ok(text) = requests.recv() else { return };
    let world = Box::new(FileWorld::new(folder.map(Path::new), library));
    turns.begin();
    let timed = budget.timed();
    let mut session = Session::within(world, name, &text, budget.clone());
    drop(timed);
    turns.end();
    let mut output = std::io::stdout().lock();
    for request in requests {
        turns.begin();
        let timed = budget.timed();
        let frame = session.answer(&request);
        drop(timed);
        turns.end();
        if write_frame(&mut output, &frame).is_err() {
            return;
        }
    }
}

/// A session in this process, for pages that are made once.
#[pyclass(name = "Session", module = "moldloft._core")]
pub struct PySession {
    inner: Mutex<Session>,
}

#[pymethods]
impl PySession {
    #[new]
    fn new(
        py: Python<'_>,
        name: &str,
        text: &str,
        folder: Option<String>,
        library: Vec<String>,
    ) -> Self {
        let session = py.detach(|| {
            let files = FileWorld::new(folder.as_deref().map(Path::new), &library);
            Session::new(Box::new(files), name, text)
        });
        Self { inner: Mutex::new(session) }
    }

    /// The files that were read: path as requested, requesting text, name and bytes.
    fn files<'py>(
        &self,
        py: Python<'py>,
    ) -> Vec<(String, Option<String>, String, Bound<'py, pyo3::types::PyBytes>)> {
        let session = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        let one = |(path, from, text): (String, Option<String>, ReadText)| {
            let bytes = pyo3::types::PyBytes::new(py, &text.bytes);
            (path, from, text.name, bytes)
        };
        session.files().into_iter().map(one).collect()
    }

    /// The reply to a request, as a frame.
    fn answer<'py>(&self, py: Python<'py>, request: &str) -> Bound<'py, pyo3::types::PyBytes> {
        let frame = py.detach(|| {
            let mut session = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            session.answer(request)
        });
        pyo3::types::PyBytes::new(py, &frame)
    }
}
