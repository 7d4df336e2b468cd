//! Polynomials of degree 2 in their normal form: ellipsoids, elliptic cylinders and elliptic cones.
//!
//! `expression -> value, gradient and second derivatives in its centre -> axes by eigenvectors`

use crate::expr::algebra::Unary;
use crate::expr::primitive::{Binary, Op, Primitive};
use crate::facet::vertex::eigen;
use moldloft_num::Vec3;
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// Second derivatives below this fraction of the largest are zero.
const NONE: f64 = 1e-11;

/// Class of a quadric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadricClass {
    /// An ellipsoid.
    Ellipsoid,
    /// An elliptic cylinder, along the third axis.
    Cylinder,
    /// An elliptic cone about the third axis; its radii equal its height at the ends of the axes.
    Cone,
}

/// A quadric given by its centre and the vectors to the ends of its axes: the image of the unit
/// sphere, the cylinder x^2 + y^2 = 1 or the cone x^2 + y^2 = z^2 in coordinates along these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricAxes {
    /// Class.
    pub class: QuadricClass,
    /// Its centre; for a cone its apex, for a cylinder a point of its axis.
    pub centre: Vec3,
    /// The half axes, at right angles; a cylinder's third one has the length of its second.
    pub half: [Vec3; 3],
}

impl Primitive<f64> {
    /// The ellipsoid, elliptic cylinder or elliptic cone that is the zero set, if this is a
    /// polynomial of degree 2 with such a zero set. A quadric closer than `near` to a cone in a box
    /// of `size` around `about` counts as a cone.
    pub fn quadric(&self, about: Vec3, size: f64, near: f64) -> Option<QuadricAxes> {
        if self.degree() != 2 || !self.is_polynomial() {
            return None;
        }
        let start = self.hessian(about);
        let (values, vectors) = eigen(start.second.map(|row| row.to_array()));
        let most = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if !most.is_finite() || most == 0.0 {
            return None;
        }
        let flat: Vec<usize> = (0..3).filter(|k| values[*k].abs() <= NONE * most).collect();
        // The centre, by two steps of Newton's method; along a cylinder it stays where it is.
        let mut centre = about;
        for _ in 0..2 {
            let slope = self.gradient(centre).slope;
            for k in (0..3).filter(|k| !flat.contains(k)) {
                centre -= vectors[k] * (vectors[k].dot(slope) / values[k]);
            }
        }
        let there = self.gradient(centre);
        let along = |k: usize, sign: f64| {
            let share = -2.0 * there.value / values[k] * sign;
            vectors[k] * share.max(0.0).sqrt()
        };
        let made = match flat[..] {
            [] => {
                let up = (0..3).filter(|k| values[*k] > 0.0).count();
                let alone = match up {
                    0 | 3 => {
                        let inside = there.value * values[0] < 0.0;
                        let half = [0, 1, 2].map(|k| along(k, 1.0));
                        let class = QuadricClass::Ellipsoid;
                        return inside.then_some(QuadricAxes { class, centre, half });
                    }
                    1 => (0..3).find(|k| values[*k] > 0.0)?,
                    _ => (0..3).find(|k| values[*k] < 0.0)?,
                };
                // The waist of a hyperboloid, or half the distance of its two parts.
                let least = values.iter().fold(f64::INFINITY, |m, v| m.min(v.abs()));
                if (2.0 * there.value.abs() / least).sqrt() > near {
                    return None;
                }
                let scale = |k: usize| vectors[k] * (values[alone].abs() / values[k].abs()).sqrt();
                let [i, j] = [(alone + 1) % 3, (alone + 2) % 3];
                let half = [scale(i), scale(j), vectors[alone]].map(|v| v * (0.5 * size));
                QuadricAxes { class: QuadricClass::Cone, centre, half }
            }
            [k] => {
                let [i, j] = [(k + 1) % 3, (k + 2) % 3];
                // A slope along it: a paraboloid.
                let tilt = there.slope.dot(vectors[k]).abs();
                if values[i] * values[j] < 0.0
                    || there.value * values[i] >= 0.0
                    || tilt * size > NONE * there.value.abs()
                {
                    return None;
                }
                let (x, y) = (along(i, 1.0), along(j, 1.0));
                let half = [x, y, vectors[k] * y.norm()];
                QuadricAxes { class: QuadricClass::Cylinder, centre, half }
            }
            _ => return None,
        };
        Some(made)
    }

    /// Made of planes and reals by sums, products and powers alone.
    fn is_polynomial(&self) -> bool {
        let mut seen = FxHashSet::default();
        let mut pending = vec![self];
        while let Some(p) = pending.pop() {
            if !seen.insert(Arc::as_ptr(&p.0)) {
                continue;
            }
            let known = match &p.0.op {
                Op::Real(_) | Op::Plane { .. } | Op::Over(..) | Op::Power(..) => true,
                Op::Unary(f, _) => *f == Unary::Neg,
                Op::Binary(f, ..) => matches!(f, Binary::Add | Binary::Sub | Binary::Mul),
                Op::User { .. } => false,
            };
            if !known {
                return false;
            }
            pending.extend(p.0.op.children().into_iter().flatten());
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned() -> [Vec3; 3] {
        let x = Vec3::of(0.36, 0.48, 0.8);
        let y = Vec3::of(-0.8, 0.6, 0.0);
        [x, y, x.cross(y)]
    }

    fn sum(weights: [f64; 3], centre: Vec3, constant: f64) -> Primitive<f64> {
        let squares = turned().map(|n| Primitive::linear(n, -n.dot(centre)).power(2));
        let mut all = Primitive::real(constant);
        for (square, w) in squares.iter().zip(weights) {
            all = all + square.clone() * w;
        }
        all
    }

    #[test]
    fn axes_are_those_it_was_made_of() {
        let centre = Vec3::of(3.0, -2.0, 1.0);
        let cases = [
            ([1.0 / 9.0, 0.25, 1.0], -1.0, Some(QuadricClass::Ellipsoid)),
            ([-1.0, -4.0, -2.0], 3.0, Some(QuadricClass::Ellipsoid)),
            ([0.0, 0.25, 1.0], -1.0, Some(QuadricClass::Cylinder)),
            ([-0.3, 0.25, 1.0], 0.0, Some(QuadricClass::Cone)),
            ([-0.3, 0.25, 1.0], 1e-3, None),
            ([-0.3, 0.25, 1.0], -1.0, None),
            ([1.0, 0.25, 1.0], 1.0, None),
            ([0.0, -0.25, 1.0], 1.0, None),
        ];
        for (weights, constant, class) in cases {
            let p = sum(weights, centre, constant);
            let found = p.quadric(Vec3::of(0.5, 0.0, 0.1), 10.0, 1e-8);
            assert_eq!(found.map(|q| q.class), class, "{weights:?}");
            let Some(q) = found else { continue };
            for (s, c) in [(0.0f64, 1.0f64), (0.6, 0.8), (-1.0, 0.0)] {
                let at = match q.class {
                    QuadricClass::Ellipsoid => {
                        q.half[0] * (0.6 * s) + q.half[1] * (0.6 * c) + q.half[2] * 0.8
                    }
                    QuadricClass::Cylinder => q.half[0] * s + q.half[1] * c + q.half[2] * 2.0,
                    QuadricClass::Cone => (q.half[0] * s + q.half[1] * c + q.half[2]) * 1.7,
                };
                assert!(p.value(q.centre + at).abs() < 1e-13 * (1.0 + at.norm_sq()), "{weights:?}");
            }
        }
        // A paraboloid, and an expression that only resembles degree 2.
        let [x, y, z] = Primitive::<f64>::axes();
        assert!((x.power(2) + y.power(2) - z).quadric(Vec3::zero(), 2.0, 1e-9).is_none());
    }
}
