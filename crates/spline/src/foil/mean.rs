//! Mean lines of foils: parabolic, four- and five-digit, and those of uniform load.

use moldloft_num::{Jet, Real, find_root};

/// A mean line, in units of its greatest height.
#[derive(Clone, Debug, PartialEq)]
pub enum MeanLine<T> {
    /// No camber.
    Flat,
    /// The camber is given with the ordinates of the thickness.
    InOrdinates,
    /// Two parabolas that meet at the greatest height (four-digit).
    Parabolic {
        /// The position x of that height.
        at: T,
    },
    /// Two cubics that meet at `r` (five-digit); see [`MeanLine::cubic`].
    Cubic {
        /// Position of the junction.
        r: f64,
        /// The ratio k2 / k1: 0 for a straight aft part.
        k: f64,
        /// The reciprocal of the greatest height.
        scale: f64,
    },
    /// The line of a load that is uniform to x = a and decreases to zero at the trailing edge.
    Load(Load<T>),
    /// The line with a = 0.8 and a straight aft part, for the 6A-series.
    Straightened {
        /// The line with a = 0.8.
        load: Load<T>,
        /// Slope added so that the trailing edge is at height 0.
        tilt: f64,
        /// The slope of the straight part.
        slope: f64,
        /// One over the greatest height.
        scale: f64,
    },
}

/// The numbers of a line with uniform load, of the heights that its formula gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<T> {
    a: T,
    g: T,
    h: T,
    /// One over the greatest height.
    scale: T,
    /// The height at the tail, which rounding and regularisation leave.
    rest: T,
}

/// Offset of the arguments of logarithms: far below visible dimensions, and far above the square
/// root of rounding, so that second derivatives stay finite.
const HELD: f64 = 1e-9;

/// x ln x, and 0 at 0.
fn x_ln<J: Real>(x: J) -> J {
    x * (x + HELD).ln()
}

/// ln |z|, held at 0.
fn ln_abs<J: Real>(z: J) -> J {
    (z * z + HELD * HELD).ln() * 0.5
}

/// z^2 (ln |z| / 2 - 1/4).
fn square_ln<J: Real>(z: J) -> J {
    z * z * (ln_abs(z) * 0.5 - 0.25)
}

impl<T: Real> Load<T> {
    /// Abbott and von Doenhoff 1959, eq. 4.26 and 4.27, without the factor c_l / (2 pi (a + 1)).
    fn new(a: T) -> Self {
        let (one, zero) = (T::one(), T::zero());
        let (g, h) = if a.re() == 1.0 {
            (zero, zero)
        } else {
            let b = -a + 1.0;
            let low = if a.re() == 0.0 { zero } else { a * a * (a.ln() * 0.5 - 0.25) };
            let g = -((low + 0.25) / b);
            (g, square_ln(b) / b + g)
        };
        let mut line = Self { a, g, h, scale: one, rest: zero };
        line.rest = line.at(one);
        let slope = |x: f64| line.slope(T::from(x)).re();
        let top = find_root(slope, 1e-4, 1.0 - 1e-4).unwrap_or(0.5);
        // The height at its maximum does not depend on the maximum's x to first order.
        line.scale = one / line.at(T::from(top));
        line
    }

    /// Height and slope at x, the slope as [`held`] says.
    fn both<J: Jet<T>>(&self, x: J) -> (J, J) {
        if x.re() < HOLD || self.a.re() == 1.0 {
            return (self.at(x), self.slope(held(x)));
        }
        // As for the separate functions, to the bit, with each logarithm computed once.
        let (a, b) = (J::fixed(self.a), J::fixed(-self.a + 1.0));
        let (w, z) = (a - x, -x + 1.0);
        let (ln_w, ln_z) = (ln_abs(w), ln_abs(z));
        let [square_w, square_z] = [(w, ln_w), (z, ln_z)].map(|(d, ln)| d * d * (ln * 0.5 - 0.25));
        let y = (square_w - square_z) / b - x_ln(x) + J::fixed(self.g) - x.scaled(self.h);
        let rate = (z * ln_z - w * ln_w) / b - x.ln() - 1.0 - J::fixed(self.h);
        let y = (y - x.scaled(self.rest)).scaled(self.scale);
        (y, (rate - J::fixed(self.rest)).scaled(self.scale))
    }

    fn at<J: Jet<T>>(&self, x: J) -> J {
        let y = if self.a.re() == 1.0 {
            let z = -x + 1.0;
            -(z * ln_abs(z)) - x_ln(x)
        } else {
            let (a, b) = (J::fixed(self.a), J::fixed(-self.a + 1.0));
            (square_ln(a - x) - square_ln(-x + 1.0)) / b - x_ln(x) + J::fixed(self.g)
                - x.scaled(self.h)
        };
        (y - x.scaled(self.rest)).scaled(self.scale)
    }

    fn slope<J: Jet<T>>(&self, x: J) -> J {
        let z = -x + 1.0;
        let y = if self.a.re() == 1.0 {
            ln_abs(z) - x.ln()
        } else {
            let (a, b) = (J::fixed(self.a), J::fixed(-self.a + 1.0));
            let w = a - x;
            (z * ln_abs(z) - w * ln_abs(w)) / b - x.ln() - 1.0 - J::fixed(self.h)
        };
        (y - J::fixed(self.rest)).scaled(self.scale)
    }
}

/// Start of the straight tail of the 6A-series.
const STRAIGHT: f64 = 0.874_37;

/// In front of this, slopes are taken behind; see [`held`].
const HOLD: f64 = 0.04 / 3.0;

/// The x at which the slope for `x` is taken: `x` itself, and near the nose a value that tends to
/// (3/8) HOLD = 0.005, twice differentiably.
fn held<J: Real>(x: J) -> J {
    if x.re() >= HOLD {
        return x;
    }
    let r = x / HOLD;
    let square = r * r;
    (square * 6.0 - square * square + 3.0) * (HOLD / 8.0)
}

impl<T: Real> MeanLine<T> {
    /// No camber.
    pub fn flat() -> Self {
        MeanLine::Flat
    }

    /// The four-digit line with its greatest height at x = `at` (NACA Report 460).
    pub fn parabolic(at: T) -> Self {
        MeanLine::Parabolic { at }
    }

    /// The five-digit line of a name: 210 to 250 with a straight aft part, 221 to 251 reflexed
    /// (Jacobs and Pinkerton, NACA Report 537, 1935).
    #[allow(clippy::approx_constant)] // 0.318 is a figure of the table, and has nothing to do with 1/pi
    pub fn cubic(name: &str) -> Option<Self> {
        let (at, r, reflexed) = match name {
            "210" => (0.05, 0.0580, false),
            "220" => (0.10, 0.1260, false),
            "230" => (0.15, 0.2025, false),
            "240" => (0.20, 0.2900, false),
            "250" => (0.25, 0.3910, false),
            "221" => (0.10, 0.1300, true),
            "231" => (0.15, 0.2170, true),
            "241" => (0.20, 0.3180, true),
            "251" => (0.25, 0.4410, true),
            _ => return None,
        };
        let cube = |x: f64| x * x * x;
        let k = if reflexed { (3.0 * (r - at) * (r - at) - cube(r)) / cube(1.0 - r) } else { 0.0 };
        let top = r - (Self::fall(r, k).0 / 3.0).sqrt();
        let height = Self::cubics(r, k, top, 1.0);
        Some(MeanLine::Cubic { r, k, scale: 1.0 / height })
    }

    fn cubics<J: Real>(r: f64, k: f64, x: J, scale: f64) -> J {
        let way = x - r;
        let cube = way * way * way * if x.re() < r { 1.0 } else { k };
        let (fall, start) = Self::fall(r, k);
        (cube - x * fall + start) * scale
    }

    /// The slope of the tail, and the height that the cubic starts from.
    fn fall(r: f64, k: f64) -> (f64, f64) {
        let cube = |x: f64| x * x * x;
        (k * cube(1.0 - r) + cube(r), cube(r))
    }

    /// The line of uniform load to x = `a` in [0, 1].
    pub fn uniform_load(a: T) -> Self {
        MeanLine::Load(Load::new(a))
    }

    /// The line of the 6A-series: the line with a = 0.8, continued by its tangent from x = 0.87437
    /// and rotated so that the trailing edge is at 0 again (Loftin, NACA Report 903, 1948).
    pub fn uniform_load_modified() -> Self {
        let load = Load::new(T::from(0.8));
        let slope = load.slope(T::from(STRAIGHT)).re();
        let tilt = -(load.at(T::from(STRAIGHT)).re() + slope * (1.0 - STRAIGHT));
        let top = find_root(|x| load.slope(T::from(x)).re() + tilt, 0.2, 0.8).unwrap_or(0.5);
        let scale = 1.0 / (load.at(T::from(top)).re() + tilt * top);
        MeanLine::Straightened { load, tilt, slope: slope + tilt, scale }
    }

    /// Height and slope at `x`.
    pub fn at<J: Jet<T>>(&self, x: J) -> (J, J) {
        match self {
            MeanLine::Flat | MeanLine::InOrdinates => (J::zero(), J::zero()),
            MeanLine::Parabolic { at } => {
                // w is the distance from the top, relative to the distance from the top to that
                // end.
                let end = if x.re() < at.re() { *at } else { -*at + 1.0 };
                let w = (x - J::fixed(*at)) / J::fixed(end);
                (-(w * w) + 1.0, -(w * 2.0) / J::fixed(end))
            }
            MeanLine::Cubic { r, k, scale } => {
                let way = x - *r;
                let bent = way * way * (if x.re() < *r { 3.0 } else { 3.0 * k });
                let (fall, _) = Self::fall(*r, *k);
                (Self::cubics(*r, *k, x, *scale), (bent - fall) * *scale)
            }
            MeanLine::Load(load) => load.both(x),
            MeanLine::Straightened { load, tilt, slope, scale } => {
                if x.re() < STRAIGHT {
                    let (y, rate) = load.both(x);
                    ((y + x * *tilt) * *scale, (rate + *tilt) * *scale)
                } else {
                    ((x - 1.0) * (*slope * *scale), J::from(*slope * *scale))
                }
            }
        }
    }

    /// The positions x at which a second derivative may jump.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            MeanLine::Flat | MeanLine::InOrdinates => Vec::new(),
            MeanLine::Parabolic { at } => vec![at.re()],
            MeanLine::Cubic { r, .. } => vec![*r],
            MeanLine::Load(load) => vec![load.a.re()],
            MeanLine::Straightened { load, .. } => vec![load.a.re(), STRAIGHT],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::Dual;

    /// Height and slope computed together agree with the separate values, derivatives included.
    #[test]
    fn height_and_slope_share_their_logarithms_to_the_bit() {
        for a in [0.0, 0.3, 0.8, 1.0] {
            let load = Load::new(a);
            for x in [0.0, 1e-6, 0.9 * HOLD, HOLD, 0.1, 0.3, 0.5, 0.8, 0.93, 1.0] {
                let bits = |(y, rate): (f64, f64)| [y, rate].map(f64::to_bits);
                assert_eq!(bits(load.both(x)), bits((load.at(x), load.slope(held(x)))), "{a} {x}");
            }
            let load = Load::new(Dual::<1>::seeded(a, 0));
            let x = Dual::<1>::from(0.4);
            assert_eq!(load.both(x), (load.at(x), load.slope(x)), "{a}");
        }
    }
}
