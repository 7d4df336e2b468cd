//! The hydrostatics of a model, as named numbers.

use crate::Document;
use moldloft_diag::Diagnostic;
use moldloft_mesh::{FloatOptions, Hydrostatics, Mesh, Symmetry, hydrostatics};
use moldloft_num::{Real, Vec3};
use moldloft_registry::Value;

/// How the model floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Height z of the water.
    pub level: f64,
    /// True when the mesh is one side of y = 0 and both are meant.
    pub mirrored: bool,
    /// Mass per volume of the water.
    pub density: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: 0.0, mirrored: false, density: 1.0 }
    }
}

impl Options {
    /// The same for a mesh of another scalar.
    pub fn float<T: Real>(&self) -> FloatOptions<T> {
        let symmetry = if self.mirrored { Symmetry::MirroredTwice } else { Symmetry::None };
        FloatOptions { level: T::from(self.level), symmetry, density: self.density }
    }
}

/// The named numbers of a mesh's hydrostatics; those of the waterplane only where there is one.
///
/// # Errors
/// When the mesh cannot be measured.
pub(crate) fn numbers<T: Real>(
    mesh: &Mesh<T>,
    options: &Options,
) -> Result<Vec<(&'static str, Value<T>)>, Diagnostic> {
    let float = hydrostatics(mesh, options.float());
    Ok(named(&float))
}

/// The numbers of hydrostatics by their names.
pub fn named<T: Real>(h: &Hydrostatics<T>) -> Vec<(&'static str, Value<T>)> {
    let mut all: Vec<_> =
        h.figures().into_iter().map(|(name, x)| (name, Value::Number(x))).collect();
    let mut vector = |name, v: Option<Vec3<T>>| all.extend(v.map(|v| (name, Value::Vector(v))));
    vector("buoyancy_centre", h.buoyancy_centre);
    vector("waterplane_centre", h.waterplane.as_ref().map(|w| w.centre));
    all
}

impl Document {
    /// The hydrostatics of the model's panels.
    ///
    /// # Errors
    /// When there are no panels.
    pub fn hydrostatics(&mut self, options: &Options) -> Result<Hydrostatics<f64>, Diagnostic> {
        Ok(hydrostatics(&self.panelled()?.mesh, options.float()))
    }
}
