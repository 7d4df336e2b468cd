//! Rational form of a shape, for exact conversion to a NURBS.

use std::f64::consts::FRAC_PI_2;

/// A parameter t in [0, 1] as a function of the parameter s in [0, 1] of a rational form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// t = s.
    Even,
    /// t is proportional to an angle, with the given total in radians. The form has equal pieces of
    /// at most a right angle; each is the rational quadratic of an arc, of weights 1, cos(half the
    /// piece), 1 (Piegl and Tiller 1997, section 7.3).
    Angle(f64),
}

impl Pace {
    /// The number of pieces, and the angle of each.
    fn pieces(self) -> (usize, f64) {
        match self {
            Self::Even => (1, 0.0),
            Self::Angle(angle) => {
                // A full turn that comes through a product is still four right angles.
                let count = (angle.abs() / FRAC_PI_2 - 1e-9).ceil().max(1.0);
                (count as usize, angle.abs() / count)
            }
        }
    }

    /// The parameters s, other than 0 and 1, at which one piece ends and another begins; t = s there.
    pub fn joints(self) -> Vec<f64> {
        let (count, _) = self.pieces();
        (1..count).map(|k| k as f64 / count as f64).collect()
    }

    /// The piece that contains `s`, the fraction of it before `s`, and the number of pieces.
    fn place(self, s: f64) -> (f64, f64, f64) {
        let count = self.pieces().0 as f64;
        let piece = (s * count).floor().clamp(0.0, count - 1.0);
        (piece, s * count - piece, count)
    }

    /// t at `s`.
    pub fn parameter(self, s: f64) -> f64 {
        let (_, angle) = self.pieces();
        if angle == 0.0 {
            return s;
        }
        let (piece, x, count) = self.place(s);
        let (half, y) = (angle / 2.0, 1.0 - x);
        // The arc about the origin from the angle 0, its middle control point times its weight.
        let across = 2.0 * x * y * libm::sin(half) + x * x * libm::sin(angle);
        let along = y * y + 2.0 * x * y * libm::cos(half) + x * x * libm::cos(angle);
        (piece + libm::atan2(across, along) / angle) / count
    }

    /// s at `t`: the inverse of [`Self::parameter`].
    pub fn inverse(self, t: f64) -> f64 {
        let (_, angle) = self.pieces();
        if angle == 0.0 {
            return t;
        }
        let (piece, share, count) = self.place(t);
        // x : 1 - x = sin(a) : sin(angle - a), both being areas of triangles about the origin.
        let here = share * angle;
        let (a, b) = (libm::sin(here / 2.0), libm::sin((angle - here) / 2.0));
        (piece + a / (a + b)) / count
    }

    /// The weight at `s`.
    pub fn weight(self, s: f64) -> f64 {
        let (_, angle) = self.pieces();
        if angle == 0.0 {
            return 1.0;
        }
        let (_, x, _) = self.place(s);
        let y = 1.0 - x;
        y * y + 2.0 * x * y * libm::cos(angle / 2.0) + x * x
    }
}

/// A weight as a function of the parameters of a form.
pub type Weight<const D: usize> = Box<dyn Fn([f64; D]) -> f64>;

/// Rational form of a shape of D parameters: its position times all weights, and the weights, are
/// polynomials of the parameters of the form between joints.
pub struct Rational<const D: usize> {
    /// Its parameters.
    pub paces: [Pace; D],
    /// The weight in addition to those of the paces, unless it is 1.
    pub weight: Option<Weight<D>>,
}

impl<const D: usize> Rational<D> {
    /// A shape of polynomials.
    pub fn none() -> Self {
        Self { paces: [Pace::Even; D], weight: None }
    }

    /// The same paces without another weight.
    pub fn paced(paces: [Pace; D]) -> Self {
        Self { paces, weight: None }
    }

    /// The product of all weights.
    pub fn weight_at(&self, s: [f64; D]) -> f64 {
        let own = self.weight.as_ref().map_or(1.0, |w| w(s));
        self.paces.iter().zip(s).fold(own, |w, (pace, s)| w * pace.weight(s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn a_pace_runs_an_arc_as_a_rational_quadratic_does() {
        for angle in [0.3, FRAC_PI_2, 2.0, -PI, TAU, 6.2] {
            let pace = Pace::Angle(angle);
            let count = pace.joints().len() + 1;
            assert!(angle.abs() / count as f64 <= FRAC_PI_2 * (1.0 + 1e-9));
            for k in 0..=40 {
                let s = f64::from(k) / 40.0;
                let t = pace.parameter(s);
                assert!((pace.inverse(t) - s).abs() < 4e-16 * 8.0, "{angle} {s}");
                // w cos and w sin are quadratics on each piece: third differences vanish.
                let h = 0.2 / count as f64;
                let start = (s * count as f64).floor().min(count as f64 - 1.0) / count as f64;
                for f in [f64::cos as fn(f64) -> f64, f64::sin] {
                    let at = |i: i32| {
                        let s = start + (0.1 + f64::from(i)) * h;
                        pace.weight(s) * f(angle * pace.parameter(s))
                    };
                    let third = at(3) - 3.0 * at(2) + 3.0 * at(1) - at(0);
                    assert!(third.abs() < 2e-15 * 8.0, "{angle} {third:e}");
                }
            }
        }
        assert_eq!(Pace::Even.parameter(0.3), 0.3);
        assert_eq!(Pace::Angle(0.0).parameter(0.3), 0.3);
    }
}
