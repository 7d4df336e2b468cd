//! The examples of all functions of the registry run by themselves.

use crate::common::{line, open};
use moldloft_document::registry;

#[test]
fn examples_of_functions_run() {
    let mut failed = Vec::new();
    for row in registry().rows().filter(|row| !row.kind) {
        let document = open(&row.example);
        if document.has_errors() {
            let faults: Vec<String> =
                document.diagnostics().iter().map(|d| line(&document, d)).collect();
            failed.push(format!("{}: {faults:?}\n{}", row.name, row.example));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
