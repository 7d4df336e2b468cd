//! What an editor sends to the language server: headers and bodies of its protocol, whole or not.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::io::Cursor;

fuzz_target!(|bytes: &[u8]| {
    let mut input = Cursor::new(bytes);
    let mut answers = Vec::new();
    let mut at = 0;
    // Each call takes some of the input, or it is the end.
    while let Ok(Some(messages)) = moldloft_lsp::editors_messages(&mut input, &mut answers) {
        assert!(input.position() > at);
        at = input.position();
        assert!(messages.len() <= bytes.len());
    }
    // Answers are messages themselves, of the form that is read.
    let mut answers = Cursor::new(answers);
    let mut refused = Vec::new();
    while let Ok(Some(messages)) = moldloft_lsp::editors_messages(&mut answers, &mut refused) {
        assert_eq!(messages.len(), 1);
    }
    assert!(refused.is_empty());
});
