//! Derivatives and sweeps of the objects of a session.

use super::SketchSession;
use crate::{DimensionFault, Estimate, Planes, SolidGradient, Swept, gradient, solid, solve};

impl SketchSession {
    /// The body at each of the values of a dimension or variable; the session stays as it is.
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
        let key = name.to_ascii_lowercase();
        if !object.dimensions.contains_key(&key) && !object.variables.contains_key(&key) {
            return Err(name.to_owned());
        }
        let planes = Planes::of(&object.drawing);
        let others = self.state.others(&object);
        let estimate = || Estimate::of(&object.drawing, &planes, object.reference()?.point);
        let at = |&value: &f64| {
            let mut given = others.clone();
            given.insert(key.clone(), value);
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
        gradient(object, &Planes::of(&object.drawing), by, &self.state.others(object))
    }
}
