//! Derivatives and sweeps of the objects of a session.

use super::SketchSession;
use crate::{DimensionFault, Estimate, Planes, SolidGradient, Swept, gradient, solid, solve};
use std::collections::BTreeMap;

impl SketchSession {
    /// The body at each value of a dimension or variable; the session is unchanged.
    ///
    /// # Errors
    /// When there is no such object or number.
    pub fn sweep(
        &mut self,
        object: &str,
        name: &str,
        values: &[f64],
    ) -> Result<Vec<Swept>, String> {
        let object = self.object(object).ok_or(object)?.clone();
        let key = object.source(name);
        let mut followed = object.followed_numbers().into_iter();
        if !object.has_number(&key) && !followed.any(|n| n.0.eq_ignore_ascii_case(&key)) {
            return Err(name.to_owned());
        }
        let planes = Planes::of(&object.drawing);
        let estimate = || Estimate::of(&object.drawing, &planes, object.reference()?.point);
        let at = |&value: &f64| {
            let own = BTreeMap::from([(key.clone(), value)]);
            let mut given = self.state.others_with(&object, &own);
            given.extend(own);
            let layout = solve(&object, &planes, &given, &estimate);
            let refused =
                layout.faults.iter().any(|f| !matches!(f, DimensionFault::Redundant { .. }));
            let body = solid(&object, &planes, &layout).filter(|_| !refused);
            let mass = body.map(|s| s.mass());
            Swept { value, mass: mass.filter(|m| m.volume.is_finite() && m.area.is_finite()) }
        };
        Ok(values.iter().map(at).collect())
    }

    /// [`gradient`] of an object of the session.
    ///
    /// # Errors
    /// As there; an unknown object's name is the error.
    pub fn gradient(&self, object: &str, by: &[String]) -> Result<SolidGradient, String> {
        let object = self.object(object).ok_or(object)?;
        let others = |given: &_| self.state.others_with(object, given);
        gradient(object, &Planes::of(&object.drawing), by, &others)
    }
}
