//! Projections of drawings.

use moldloft_num::Vec3;
use moldloft_sketch::{CoordinateAxis, Projection};

#[test]
fn the_sight_vector_is_drawn_as_a_point() {
    for name in Projection::PRESETS {
        let p = Projection::preset(name).unwrap();
        let [u, v] = p.project(p.sight(CoordinateAxis::Z));
        assert!(u.abs() < 1e-12 && v.abs() < 1e-12 && p.sight(CoordinateAxis::Z).z > 0.0, "{name}");
    }
    let iso = Projection::preset("iso").unwrap();
    let (a, b) = (iso.project(Vec3::of(1.0, 0.0, 1.0)), iso.project(Vec3::of(0.0, 1.0, 0.0)));
    // With unit scales the isometric presets draw these two corners at the same position.
    assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
    assert!(Projection::preset("FISHEYE").is_none());
}

#[test]
fn leaning_is_a_slope_even_for_a_vertical_axis() {
    let p = Projection::section(CoordinateAxis::Y);
    assert_eq!(p.lean([0.0, 3.0], CoordinateAxis::Z), 0.0);
    assert_eq!(p.lean([1.0, 20.0], CoordinateAxis::Z), 0.05);
    assert_eq!(p.lean([0.0, 3.0], CoordinateAxis::X), f64::INFINITY);
}
