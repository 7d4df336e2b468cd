//! Requests to a session as the workbench's page sends them, one a line: each is answered by a frame.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::document::NoFiles;
use moldloft_session::Session;

const MODEL: &str =
    "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0);\nAbsPoint B(w, 0, 0);\nLine l(A, B);\n";

fuzz_target!(|text: &str| {
    let mut session = Session::new(Box::new(NoFiles), "fuzz.sdl", MODEL);
    for request in text.lines().take(50) {
        let frame = session.answer(request);
        assert!(frame.len() >= 16);
        let head = String::from_utf8_lossy(&frame);
        assert!(!head.contains("internal-error"));
    }
    assert!(session.answer(r#"{"kind":"ping","id":1}"#).len() >= 16);
});
