//! The units that a model states, and what is taken where it states none.

use crate::Document;
use crate::document::ObjectSource;
use moldloft_diag::Diagnostic;
use moldloft_lang::model_file::units::{self, PhysicalDimension};

/// The unit of length of a sketch that states none.
const ASSUMED_UNIT: &str = "mm";

impl Document {
    /// The units that the model states, such as "m t".
    pub fn units(&self) -> String {
        match &self.source {
            ObjectSource::ModelFile(source) => source.units(),
            ObjectSource::Sketch(sketch) => {
                sketch.unit().unwrap_or_else(|| ASSUMED_UNIT.to_owned())
            }
            _ => self.units_of_program(),
        }
    }

    /// The warning of a sketch that states no unit of length, for files that state one: millimetres
    /// are taken. Of other models the remark that metres are.
    pub fn assumed_unit(&self) -> Option<Diagnostic> {
        let sketch = match &self.source {
            ObjectSource::Sketch(sketch) => sketch.unit().is_none().then(|| sketch.path.clone()),
            ObjectSource::Program => self.unitless_sketch().map(str::to_owned),
            _ => None,
        };
        const ASSUMED: &str = "assumed-unit";
        if let Some(of) = sketch {
            let message =
                format!("the sketch states no unit of length; millimetres are taken ({of})");
            return Some(
                Diagnostic::warning(ASSUMED, message).help("SET UNITS in the sketch states one"),
            );
        }
        let stated = units::parsed(&self.units()).unwrap_or_default();
        if stated.iter().any(|u| u.1 == PhysicalDimension::Length) {
            return None;
        }
        let message = "the model states no unit of length; metres are taken".to_owned();
        Some(
            Diagnostic::remark(ASSUMED, message)
                .help("`Model info(units = \"mm\");` states another"),
        )
    }

    /// The first sketch of a program where nothing states a unit of length.
    fn unitless_sketch(&self) -> Option<&str> {
        let stated = moldloft_lang::model_file::header::text(&self.plain.graph, "units");
        let known = units::parsed(&stated).unwrap_or_default();
        let length = known.iter().any(|u| u.1 == PhysicalDimension::Length);
        let none = !length && self.plain.env.sketch_units.is_empty();
        self.plain.env.sketches.first().filter(|_| none).map(String::as_str)
    }

    /// The units that a program states; its length is in the unit of the sketches that it loads when it states none, and
    /// in millimetres when those state none either.
    fn units_of_program(&self) -> String {
        let stated = moldloft_lang::model_file::header::text(&self.plain.graph, "units");
        let known = units::parsed(&stated).unwrap_or_default();
        let length = known.iter().any(|u| u.1 == PhysicalDimension::Length);
        match self.plain.env.sketch_units.first().filter(|_| !length) {
            Some((_, unit, _)) if stated.is_empty() => unit.clone(),
            Some((_, unit, _)) => format!("{unit} {stated}"),
            None if self.unitless_sketch().is_some() && stated.is_empty() => {
                ASSUMED_UNIT.to_owned()
            }
            None if self.unitless_sketch().is_some() => format!("{ASSUMED_UNIT} {stated}"),
            None => stated,
        }
    }
}
