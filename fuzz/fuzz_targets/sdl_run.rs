//! Runs arbitrary text as a program of the array language after a head that declares variables of all
//! types, and compares one pass with operators one after the other: no text may panic or hang.

#![no_main]

use libfuzzer_sys::fuzz_target;
use moldloft::document::{Document, NoFiles, registry};

const HEAD: &str = "load \"stdsubs.sdl\"\nload \"mslbody.sdl\"\nint n = 5; float x = 2; vector v = {1, 2, 3};\n\
    farray a = uniform(0, 1, 5); curve c = {a, a^2, 1 - a}; surface s[5,5];\n\
    for (j = 1:5) s[j,] = c + j*v;\npcurve p = makecc(c, \"quadratic\", \"arc\");\n";

fuzz_target!(|text: &str| {
    let text = format!("{HEAD}{text}");
    let mut fused = Document::from_text(registry(), Box::new(NoFiles), "fuzz.sdl", &text);
    for diagnostic in fused.diagnostics() {
        let _ = moldloft::diag::render(&diagnostic, fused.sources());
    }
    let mut plain = Document::from_text(registry(), Box::new(NoFiles), "fuzz.sdl", &text);
    plain.by_reference();
    assert_eq!(fused.printed(), plain.printed());
    assert_eq!(fused.diagnostics().len(), plain.diagnostics().len());
    let _ = fused.eval("c[1]");
});
