//! Placement on a plane face of a body.

use super::SketchSolid;
use super::edges::{FaceForm, TreatmentFault};
use super::place::Similarity;
use crate::CoordinateAxis;
use crate::feature::FaceChoice;
use moldloft_num::{Real, Vec3};

/// Deviation of a normal from an axis that counts as zero, and of planes relative to the size.
const SQUARE: f64 = 1e-9;

/// The plane of chosen faces: a point, and the outward normal.
pub(crate) struct FacePlane<T> {
    pub at: Vec3<T>,
    pub normal: Vec3<T>,
}

fn refused(text: String, next: &str) -> TreatmentFault {
    TreatmentFault::new(text, None, next)
}

impl<T: Real> FacePlane<T> {
    /// The common plane of the chosen faces of a body.
    pub fn of(base: &SketchSolid<T>, face: &FaceChoice) -> Result<Self, TreatmentFault> {
        let next = "name a plane face; LIST FACES names them";
        let size = base.vertices.iter().map(|v| v.at.re().norm()).fold(0.0, f64::max);
        let mut found: Option<FacePlane<T>> = None;
        for f in base.chosen_faces(face)? {
            let FaceForm::Plane { at, normal } = base.form(f) else {
                return Err(refused(format!("face {face} is round"), next));
            };
            match &found {
                Some(first)
                    if (normal.re() - first.normal.re()).norm() > SQUARE
                        || (at - first.at).dot(first.normal).re().abs() > SQUARE * size =>
                {
                    return Err(refused(format!("face {face} is in several planes"), next));
                }
                Some(_) => {}
                None => found = Some(FacePlane { at, normal }),
            }
        }
        found.ok_or_else(|| refused(format!("there is no face {face}"), next))
    }

    /// The axis to which the plane is square, also by its derivatives.
    fn square(&self) -> Option<usize> {
        let zero = |x: T| (0..T::PARTS).all(|part| x.part(part).abs() <= SQUARE);
        (0..3).find(|k| (0..3).all(|j| j == *k || zero(self.normal[j])))
    }

    /// The axis nearest to the normal.
    pub fn nearest_axis(&self) -> CoordinateAxis {
        let size = |axis: &CoordinateAxis| self.normal[axis.index()].re().abs();
        let [x, y, z] = CoordinateAxis::ALL;
        let wider = |a, b| if size(&b) > size(&a) + SQUARE { b } else { a };
        wider(wider(z, y), x)
    }

    /// 1 if the image of an axis points out of the body, -1 if it points into it.
    pub fn outward(&self, along: CoordinateAxis) -> f64 {
        if self.normal[along.index()].re() < -SQUARE { -1.0 } else { 1.0 }
    }

    /// The placement that brings the origin to its foot on the plane and `along` to the normal, by the
    /// least turn; without `along`, a move along the axis to which the plane is square.
    pub fn place(
        &self,
        face: &FaceChoice,
        along: Option<CoordinateAxis>,
    ) -> Result<Similarity<T>, TreatmentFault> {
        let own = along.map(CoordinateAxis::index);
        if let Some(k) = self.square().filter(|k| own.is_none_or(|own| own == *k)) {
            let mut shift = [T::zero(); 3];
            shift[k] = self.at[k];
            return Ok(Similarity::moved(Vec3::from(shift)));
        }
        let Some(axis) = along else {
            let next = "ALONG axis turns that axis to the normal of the face";
            return Err(refused(format!("face {face} is inclined"), next));
        };
        let identity = Similarity::<T>::identity();
        let own = identity.columns[axis.index()];
        let to = self.normal * T::from(self.outward(axis));
        let turn = own.cross(to);
        let part = T::one() / (T::one() + own.dot(to));
        let columns = identity.columns.map(|e| {
            let across = turn.cross(e);
            e + across + turn.cross(across) * part
        });
        Ok(Similarity { columns, shift: self.normal * self.at.dot(self.normal) })
    }
}
