//! Expressions in the names of a small model: each gives a value or diagnostics, twice the same.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::document::{Document, NoFiles, registry};

const MODEL: &str = "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); AbsPoint C(0, 1, 1);\n\
    AbsPoint D(w, 1, 2); Line l(A, B); BCurve m({C, B, D}, degree = 2); RuledSurf s(l, m);\nfarray a = uniform(0, 1, 5);\n";

fuzz_target!(|text: &str| {
    let mut document = Document::from_text(registry(), Box::new(NoFiles), "fuzz.sdl", MODEL);
    let first = document.eval(text).map_err(|found| found.len()).err();
    let again = document.eval(text).map_err(|found| found.len()).err();
    assert_eq!(first, again);
});
