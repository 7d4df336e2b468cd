//! Derivatives of unit tangents by differences within stretches.

use moldloft_num::{Real, Uni2, Vec3};
use moldloft_relational::parts::{slope, tangent};

#[test]
fn slopes_stay_within_their_stretch() {
    // Kinks at the breaks; in between the derivative is exact for polynomials of degree 4.
    let f = |t: f64| {
        let x = if t < 0.3 {
            t.powi(4)
        } else if t < 0.301 {
            -t
        } else {
            t * t
        };
        [Vec3::of(x, 0.0, 1.0)]
    };
    let breaks = [0.3, 0.301];
    for (t, exact) in [(0.0, 0.0), (0.2999, 4.0 * 0.2999f64.powi(3)), (0.3005, -1.0)] {
        assert!((slope(f, t, &breaks)[0].x - exact).abs() < 1e-10, "{t}");
    }
    for (t, exact) in [(0.3, -1.0), (0.3011, 0.6022), (1.0, 2.0), (1.3, 2.6), (-0.1, -0.004)] {
        assert!((slope(f, t, &breaks)[0].x - exact).abs() < 1e-10, "{t}");
    }
}

#[test]
fn tangents_of_a_circle() {
    let jet = |t: f64, _| {
        let (s, c) = (Real::sin(t), Real::cos(t));
        [Vec3::of(c, s, 0.0), Vec3::of(-s, c, 0.0), Vec3::of(-c, -s, 0.0)]
    };
    let d = tangent(jet, Vec::new, Uni2::parameter(0.4));
    assert!((d.x.tt - Real::sin(0.4)).abs() < 1e-11 && (d.y.t + Real::sin(0.4)).abs() < 1e-16);
}
