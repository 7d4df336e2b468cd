//! Piecewise Chebyshev curves against the functions they interpolate.

use moldloft_num::{Curve, Order, Real, Vec3};
use moldloft_relational::parts::{ChebyshevPiece, PiecewiseChebyshev, nodes};

#[test]
fn a_smooth_curve_is_met_to_rounding() {
    let f = |t: f64| Vec3::of(Real::sin(3.0 * t), Real::exp(t), t * t);
    let samples: Vec<Vec3> = nodes(0.25, 1.0).map(f).collect();
    let way = PiecewiseChebyshev { pieces: vec![ChebyshevPiece::through(0.25, 1.0, &samples)] };
    assert!(way.pieces[0].rest() < 1e-14);
    for t in [0.25, 0.4, 0.77, 1.0] {
        let [p, d, dd] = way.jet(t, Order::Second);
        assert!(p.distance(f(t)) < 1e-14);
        assert!((d.y - Real::exp(t)).abs() < 1e-12 && (dd.z - 2.0).abs() < 1e-10);
    }
}
