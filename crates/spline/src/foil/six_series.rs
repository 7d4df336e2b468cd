//! Thickness forms of the NACA 6- and 6A-series by conformal mapping (Theodorsen 1931).

use super::tables::{FAMILIES, ThicknessFamily};
use super::thickness::Thickness;
use crate::{End, Ends, InterpolatingSpline};
use moldloft_num::{Curve, Order, Real, Vec3, find_root};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Intervals of s at which the mapping is sampled: their spline is within 1e-7 of it.
pub(super) const STEPS: usize = 128;

/// Ratios at which forms are computed; between them a form is the polynomial through these, which
/// is within 1e-8 of the mapping (tested) and smooth, as lofts require.
const NODES: usize = 26;

/// Ratios of thickness that the scale polynomials serve; beyond, the nearest form is stretched.
const RATIOS: (f64, f64) = (0.02, 0.24);

/// The mapping of a circle to a thickness form (Theodorsen 1931; Abbott and von Doenhoff 1959,
/// section 3.6): the point exp(psi_0 + i phi) is mapped to z = exp(psi + i (phi - epsilon)), and
/// that to z + 1/z, which is normalised to the unit chord.
struct Mapping {
    epsilon: InterpolatingSpline<f64>,
    psi: InterpolatingSpline<f64>,
    scale: f64,
}

impl Mapping {
    fn new(family: &ThicknessFamily, scale: f64) -> Self {
        let n = family.psi.len() - 1;
        let knots: Vec<f64> = (0..=n).map(|k| k as f64 * PI / n as f64).collect();
        // Epsilon is odd about both ends, psi even.
        let spline = |values: &[u16; 41], end: End<f64>| {
            let points: Vec<Vec3> =
                values.iter().map(|&x| Vec3::of(f64::from(x) * 1e-5, 0.0, 0.0)).collect();
            InterpolatingSpline::with_knots(&knots, &points, Ends::Open(end, end))
                .expect("the table ascends")
        };
        Self {
            epsilon: spline(&family.epsilon, End::Natural),
            psi: spline(&family.psi, End::Clamped(Vec3::zero())),
            scale,
        }
    }

    /// The scaled functions psi and phi - epsilon, and their derivatives by phi.
    fn parts(&self, phi: f64) -> [(f64, f64); 2] {
        let of = |spline: &InterpolatingSpline<f64>| {
            let [p, d, _] = spline.jet(phi, Order::First);
            (self.scale * p.x, self.scale * d.x)
        };
        let (epsilon, rate) = of(&self.epsilon);
        [of(&self.psi), (phi - epsilon, 1.0 - rate)]
    }

    /// The ordinates (x, y) at phi, with the nose at 0 and the tail at 1.
    ///
    /// z + 1/z is 2 (cosh psi cos angle + i sinh psi sin angle). The distance from the nose is a
    /// sum of two squares, so that it keeps its digits near the nose.
    fn at(&self, phi: f64) -> (f64, f64) {
        let [(nose, _), _] = self.parts(0.0);
        let [(tail, _), _] = self.parts(PI);
        let [(psi, _), (angle, _)] = self.parts(phi);
        let (ch, sh, s) = (Real::cosh(psi), Real::sinh(psi), Real::sin(angle));
        let chord = Real::cosh(nose) + Real::cosh(tail);
        let half = Real::sin(angle * 0.5);
        let bend = Real::sinh((nose + psi) * 0.5) * Real::sinh((nose - psi) * 0.5);
        ((bend + ch * half * half) * 2.0 / chord, sh * s / chord)
    }
}

/// Half thickness in units of half the greatest, over s, at one ratio.
#[derive(Debug)]
pub struct ThicknessForm {
    /// Coefficients of the powers 0 to 3 of the position within each interval of s.
    pieces: Vec<[f64; 4]>,
    /// The position x of the greatest thickness.
    top: f64,
}

impl ThicknessForm {
    fn new(family: &ThicknessFamily, ratio: f64) -> Self {
        let scale = family.scale.iter().rev().fold(0.0, |sum, &c| (sum + c) * ratio);
        let mapping = Mapping::new(family, scale);
        let place = |k: usize| {
            let s = k as f64 / STEPS as f64;
            let y = match k {
                0 => 0.0,
                STEPS => mapping.at(PI).1,
                _ => {
                    let phi = find_root(|phi| mapping.at(phi).0 - s * s, 0.0, PI);
                    mapping.at(phi.unwrap_or(s * PI)).1
                }
            };
            Vec3::of(s, y * 2.0 / ratio, 0.0)
        };
        let points: Vec<Vec3> = (0..=STEPS).map(place).collect();
        let knots: Vec<f64> = points.iter().map(|p| p.x).collect();
        let spline = InterpolatingSpline::with_knots(&knots, &points, Ends::default());
        let spline = spline.expect("the samples ascend");
        let jets: Vec<_> = knots.iter().map(|&s| spline.jet(s, Order::Second)).collect();
        let pieces = jets.windows(2).map(|w| {
            let [p, d, dd] = w[0].map(|v| v.y);
            [p, d, 0.5 * dd, (w[1][2].y - dd) * STEPS as f64 / 6.0]
        });
        let pieces = pieces.collect();
        let high = (1..STEPS).max_by(|&a, &b| points[a].y.total_cmp(&points[b].y)).unwrap_or(1);
        let slope = |s: f64| spline.jet(s, Order::First)[1].y;
        let top = find_root(slope, knots[high - 1], knots[high + 1]).unwrap_or(knots[high]);
        Self { pieces, top: top * top }
    }
}

/// Chebyshev's nodes in the range of the ratios.
fn node(k: usize) -> f64 {
    let (low, high) = RATIOS;
    let x = Real::cos(PI * (k as f64 + 0.5) / NODES as f64);
    0.5 * (low + high) - 0.5 * (high - low) * x
}

/// The forms of a family at the nodes; computed on first use.
fn forms(at: usize) -> &'static [ThicknessForm] {
    static FORMS: [OnceLock<Vec<ThicknessForm>>; FAMILIES.len()] =
        [const { OnceLock::new() }; FAMILIES.len()];
    FORMS[at]
        .get_or_init(|| (0..NODES).map(|k| ThicknessForm::new(&FAMILIES[at], node(k))).collect())
}

/// A form between those of the nodes.
#[derive(Clone, Debug)]
pub struct Blended<T> {
    forms: &'static [ThicknessForm],
    /// The weight of each: Lagrange's polynomials at the ratio.
    shares: [T; NODES],
    /// Precomputed sums, if they save time.
    pieces: Vec<[T; 4]>,
}

impl<T: Real> Blended<T> {
    /// The position x of the greatest thickness.
    pub fn top(&self) -> T {
        let parts = self.forms.iter().zip(&self.shares);
        parts.fold(T::zero(), |sum, (form, share)| sum + *share * form.top)
    }

    /// The coefficients in one interval of s.
    fn piece(&self, k: usize) -> [T; 4] {
        let mut coefficients = [T::zero(); 4];
        for (form, share) in self.forms.iter().zip(&self.shares) {
            for (sum, c) in coefficients.iter_mut().zip(form.pieces[k]) {
                *sum += *share * c;
            }
        }
        coefficients
    }

    /// The mean line with its sums precomputed, for sections that are evaluated at many parameters.
    pub fn settled(mut self) -> Self {
        self.pieces = (0..STEPS).map(|k| self.piece(k)).collect();
        self
    }

    /// The half thickness at `s`; in numbers that may depend on a parameter.
    pub fn at<J: moldloft_num::Jet<T>>(&self, s: J) -> J {
        let k = (s.re() * STEPS as f64).floor().clamp(0.0, (STEPS - 1) as f64);
        let z = s - k / STEPS as f64;
        let [p, d, q, r] = match self.pieces.get(k as usize) {
            Some(piece) => *piece,
            None => self.piece(k as usize),
        };
        let inner = z.scaled(r) + J::fixed(q);
        (inner * z + J::fixed(d)) * z + J::fixed(p)
    }
}

/// The thickness form of a family at the thickness ratio `ratio`; `None` for another name.
pub(super) fn thickness<T: Real>(name: &str, ratio: T) -> Option<Thickness<T>> {
    let at = FAMILIES.iter().position(|family| family.name == name)?;
    let ratio = if (RATIOS.0..=RATIOS.1).contains(&ratio.re()) {
        ratio
    } else {
        T::from(ratio.re().clamp(RATIOS.0, RATIOS.1))
    };
    let shares = std::array::from_fn(|k| {
        let others = (0..NODES).filter(|j| *j != k);
        others.fold(T::one(), |product, j| product * ((ratio - node(j)) / (node(k) - node(j))))
    });
    Some(Thickness::Family(Blended { forms: forms(at), shares, pieces: Vec::new() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_between_the_nodes_are_those_of_the_mapping() {
        for (at, family) in FAMILIES.iter().enumerate() {
            for ratio in [0.021, 0.1, 0.137, 0.239] {
                let direct = ThicknessForm::new(family, ratio);
                let Some(Thickness::Family(blended)) = thickness(family.name, ratio) else {
                    panic!("{at}")
                };
                assert!((blended.top() - direct.top).abs() < 1e-6, "{} {ratio}", family.name);
                for k in 0..=40 {
                    let s = f64::from(k) / 40.0;
                    let step = (s * STEPS as f64).floor().min((STEPS - 1) as f64);
                    let z = s - step / STEPS as f64;
                    let [p, d, q, r] = direct.pieces[step as usize];
                    let y = ((r * z + q) * z + d) * z + p;
                    let gap = (blended.at(s) - y).abs();
                    assert!(gap < 1e-8, "{} {ratio} {s}: {gap}", family.name);
                }
            }
        }
    }
}
