//! Opens arbitrary text as a program and as a model file, evaluates and converts it: no text may
//! panic, hang or exhaust the memory.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::document::{Document, ModelFormat, NoFiles, registry};

fuzz_target!(|text: &str| {
    for name in ["fuzz.sdl", "fuzz.ms2"] {
        let mut document = Document::from_text(registry(), Box::new(NoFiles), name, text);
        for diagnostic in document.diagnostics() {
            let _ = moldloft::diag::render(&diagnostic, document.sources());
        }
        let _ = document.panelled();
        let _ = document.convert(ModelFormat::Sdl);
        let _ = document.convert(ModelFormat::ModelFile);
    }
});
