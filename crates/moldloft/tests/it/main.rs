//! The examples of the facade run; the fuzz targets hold.

// The name under which the fuzz targets import their macro.
extern crate self as libfuzzer_sys;

#[allow(dead_code, reason = "its `main` is that of the example")]
#[path = "../../examples/bits.rs"]
mod bits;
#[path = "../../examples/derivative.rs"]
mod derivative;
mod fuzz;
#[path = "../../examples/hull_to_gdf.rs"]
mod hull_to_gdf;

// After the module that imports it by its path.
/// The macro of libFuzzer, for one function from bytes.
#[macro_export]
macro_rules! fuzz_target {
    (|$input:ident: &str| $body:block) => {
        pub fn run(bytes: &[u8]) {
            fn body($input: &str) $body
            if let Ok(text) = std::str::from_utf8(bytes) {
                body(text);
            }
        }
    };
    (|$input:ident: &[u8]| $body:block) => {
        pub fn run($input: &[u8]) $body
    };
}

#[test]
fn derivatives_equal_differences() {
    derivative::main().unwrap();
}

/// Results are the same bits as on the machine that wrote the file; in a long run those of the examples, too.
#[test]
fn results_have_the_bits_of_the_file() {
    let file = std::fs::read_to_string(bits::root().join("tests/bits.txt")).unwrap();
    let examples = moldloft_testing::soak();
    let there: Vec<&str> = file.lines().filter(|l| examples || !l.starts_with("example")).collect();
    let here = bits::lines(examples);
    let different: Vec<&String> = here.iter().filter(|l| !there.contains(&l.as_str())).collect();
    assert!(
        different.is_empty() && here.len() == there.len(),
        "{} of {} results differ from tests/bits.txt, which has {}; after a change of results `make bits`\n{different:#?}",
        different.len(),
        here.len(),
        there.len()
    );
}

#[test]
fn the_hull_becomes_panels() {
    let text = String::from_utf8(hull_to_gdf::panels(None).unwrap()).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("hull"));
    // 160 panels of the hull, 32 of the transom.
    assert_eq!(lines.nth(2), Some("192"));
    assert_eq!(lines.count(), 4 * 192);
    let fault = hull_to_gdf::panels(Some("no-such.sdl")).unwrap_err();
    assert!(fault.contains("no-such.sdl"), "{fault}");
}
