//! The examples of the facade run; the fuzz targets hold.

// The name under which the fuzz targets ask for their macro.
extern crate self as libfuzzer_sys;

#[path = "../../examples/derivative.rs"]
mod derivative;
mod fuzz;
#[path = "../../examples/hull_to_gdf.rs"]
mod hull_to_gdf;

// Behind the module that asks for it by its path.
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

#[test]
fn the_hull_becomes_panels() {
    let text = String::from_utf8(hull_to_gdf::panels(None).unwrap()).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("hull"));
    assert_eq!(lines.nth(2), Some("128"));
    assert_eq!(lines.count(), 4 * 128);
    let fault = hull_to_gdf::panels(Some("no-such.sdl")).unwrap_err();
    assert!(fault.contains("no-such.sdl"), "{fault}");
}
