//! Where the break of a surface goes when a parameter of the model moves.

use moldloft_num::{Order, Real, Surface};

/// Places along a break at which its rate is looked for.
const PLACES: [f64; 7] = [0.03, 0.19, 0.37, 0.52, 0.68, 0.83, 0.96];

/// The derivatives of the place of a break, the parameter `at` of u (0) or v (1), as a number whose real part is 0; its
/// sides are looked at so far before and after it.
///
/// Both sides of a corner meet there whatever becomes of it: with S- and S+ the sides,
/// dt = (dS+ - dS-) . n / n . n with n = S-' - S+', over places along the break. Zero where the tangent does not
/// turn: there the place does not matter to a first derivative.
pub fn break_rate<T: Real>(
    surface: &dyn Surface<T>,
    along: usize,
    at: f64,
    [before, after]: [f64; 2],
) -> T {
    let side = |h: f64, across: f64| {
        let [u, v] = if along == 0 { [at + h, across] } else { [across, at + h] };
        let jet = surface.jet(T::from(u), T::from(v), Order::First);
        let slope = if along == 0 { jet.u } else { jet.v };
        (jet.p - slope * T::from(h), slope.re())
    };
    let (mut gaps, mut squares, mut size) = (T::zero(), 0.0, 0.0f64);
    for across in PLACES {
        let ((p, low), (q, high)) = (side(-before, across), side(after, across));
        let turn = low - high;
        let gap = q - p;
        gaps += gap.x * turn.x + gap.y * turn.y + gap.z * turn.z;
        squares += turn.norm_sq();
        size = size.max(low.norm_sq()).max(high.norm_sq());
    }
    if squares > 1e-16 * size && gaps.is_finite() {
        let rate = gaps / squares;
        rate - rate.re()
    } else {
        T::zero()
    }
}
