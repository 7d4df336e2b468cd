//! The parser of programs: any text gives a tree, and every fault a place inside the text that can be printed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::diag::{Sources, render};

fuzz_target!(|text: &str| {
    let mut sources = Sources::new();
    let file = sources.add("fuzz.sdl", text);
    let (program, faults) = moldloft::syntax::sdl::parse(text, file);
    for fault in &faults {
        assert!(fault.span().range().end <= text.len());
        let _ = render(fault, &sources);
    }
    assert!(!program.dump().contains("(error)") || !faults.is_empty());
    assert_eq!(program.text_with_edits(), text);
});
