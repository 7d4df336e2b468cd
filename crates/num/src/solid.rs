//! Solids X(u, v, w): positions, first derivatives, and solids given by one formula over jets.

use crate::jet::Jet;
use crate::trace::Faces;
use crate::{Real, Tri1, Vec3};

/// Position and first derivatives of a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidJet<T> {
    /// Position.
    pub p: Vec3<T>,
    /// Derivative by u.
    pub u: Vec3<T>,
    /// Derivative by v.
    pub v: Vec3<T>,
    /// Derivative by w.
    pub w: Vec3<T>,
}

impl<T: Real> SolidJet<T> {
    /// The Jacobian det(X_u, X_v, X_w): positive where the solid is right-handed.
    pub fn jacobian(&self) -> T {
        self.u.cross(self.v).dot(self.w)
    }
}

/// A solid X(u, v, w) for u, v, w in [0, 1].
pub trait Solid<T: Real>: Send + Sync {
    /// The position at (`u`, `v`, `w`).
    fn eval(&self, u: T, v: T, w: T) -> Vec3<T>;

    /// Position and first derivatives at (`u`, `v`, `w`).
    fn jet(&self, u: T, v: T, w: T) -> SolidJet<T>;

    /// Positions on the grid `us` x `vs` x `ws`, at `[(i * vs.len() + j) * ws.len() + k]`.
    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<T>]) {
        let mut out = points.iter_mut();
        for &u in us {
            for &v in vs {
                for (&w, x) in ws.iter().zip(&mut out) {
                    *x = self.eval(T::from(u), T::from(v), T::from(w));
                }
            }
        }
    }

    /// The roots of its faces, edges and corners, for joins.
    fn faces(&self) -> Faces<T> {
        Faces::own()
    }
}

/// A solid given by a formula that is generic over jets: its derivatives follow from it.
pub trait SolidFormula: Send + Sync {
    /// The scalar of the solid.
    type Scalar: Real;

    /// The position at (`u`, `v`, `w`).
    fn at<J: Jet<Self::Scalar>>(&self, u: J, v: J, w: J) -> Vec3<J>;

    /// See [`Solid::grid`].
    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<Self::Scalar>]) {
        let mut out = points.iter_mut();
        for &u in us {
            for &v in vs {
                for (&w, x) in ws.iter().zip(&mut out) {
                    *x = self.at(u.into(), v.into(), w.into());
                }
            }
        }
    }

    /// See [`Solid::faces`].
    fn faces(&self) -> Faces<Self::Scalar> {
        Faces::own()
    }
}

impl<F: SolidFormula> Solid<F::Scalar> for F {
    fn eval(&self, u: F::Scalar, v: F::Scalar, w: F::Scalar) -> Vec3<F::Scalar> {
        self.at(u, v, w)
    }
    fn jet(&self, u: F::Scalar, v: F::Scalar, w: F::Scalar) -> SolidJet<F::Scalar> {
        let [u, v, w] = Tri1::parameters(u, v, w);
        let x = self.at(u, v, w);
        SolidJet { p: x.map(|a| a.f), u: x.map(|a| a.u), v: x.map(|a| a.v), w: x.map(|a| a.w) }
    }
    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<F::Scalar>]) {
        SolidFormula::grid(self, us, vs, ws, points);
    }
    fn faces(&self) -> Faces<F::Scalar> {
        SolidFormula::faces(self)
    }
}
