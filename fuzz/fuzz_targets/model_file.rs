//! The reader of model files, from bytes: nothing panics, nothing is lost, and canonical text reads back as itself.
#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::diag::FileId;
use moldloft::syntax::{decode, model_file};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = decode(bytes, "fuzz.ms2") else { return };
    let (model, faults) = model_file::parse(&*text, FileId(0));
    for fault in &faults {
        assert!(fault.span().range().end <= text.len());
    }
    assert_eq!(model.text_with_edits(), text);
    let canonical = model.to_canonical(|_| false);
    if faults.is_empty() {
        let (again, faults) = model_file::parse(canonical.as_str(), FileId(0));
        assert!(faults.is_empty());
        assert_eq!(again.to_canonical(|_| false), canonical);
    }
});
