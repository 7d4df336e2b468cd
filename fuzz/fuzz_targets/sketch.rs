//! A session of the sketch language, from lines and from a file that INPUT reads: no text panics or hangs.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::sketch::{Files, SketchSession};

/// A world of one file, whatever its name.
struct Only(String);

impl Files for Only {
    fn read(&self, _: &str) -> Result<String, String> {
        Ok(self.0.clone())
    }
}

fuzz_target!(|text: &str| {
    let mut session = SketchSession::with_files(Box::new(Only(text.to_owned())));
    for line in text.lines().take(400) {
        for reply in session.run_line(line) {
            assert!(!reply.text.contains("internal-error"));
        }
    }
    let mut session = SketchSession::with_files(Box::new(Only(text.to_owned())));
    for command in ["INPUT \"a.skt\"", "INPUT \"a.json\"", "IMPORT \"a.dxf\""] {
        let _ = session.run_line(command);
    }
});
