//! The examples of the facade run.

#[path = "../../examples/derivative.rs"]
mod derivative;
#[path = "../../examples/hull_to_gdf.rs"]
mod hull_to_gdf;

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
