//! Properties of a model as a whole: mirror planes, unit, header of its model file.

use crate::model_file::text::Text;
use crate::model_file::units;
use moldloft_model::Graph;
use moldloft_num::Real;
use moldloft_registry::export::StaticRow;
use moldloft_registry::{Build, CallError, Context, Kind, Role, Row, Scalar, Value};

/// The model's properties: its symmetry planes, units, and the header of its model file.
///
/// A model has one at most. With `symmetry = "y"` the objects are the half on one side of y = 0,
/// and hydrostatics count both.
#[derive(Kind)]
#[kind(class = List, role = Header, example = "Model info(symmetry = \"y\", units = \"m kg\");")]
pub struct Model<T: Real> {
    /// The mirror planes, as letters: "y" for y = 0, "xy" for x = 0 and y = 0.
    #[field(default = "")]
    symmetry: Text<T>,
    /// The units of length, mass, force and angle, at most one of each, such as "m t kN".
    #[field(default = "")]
    units: Text<T>,
    /// The version of the model file, such as "0.35" or "1.44".
    #[field(default = "")]
    version: Text<T>,
    /// The other lines of the model file's header.
    lines: Option<Vec<Text<T>>>,
}

impl<T: Real> Build<T> for Model<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let letters = self.symmetry.as_str().to_string();
        let known = letters.chars().all(|c| matches!(c, 'x' | 'y' | 'z'));
        let once = letters.chars().enumerate().all(|(k, c)| letters.find(c) == Some(k));
        if !known || !once {
            return Err(CallError::new("unknown-plane", format!("unknown symmetry \"{letters}\""))
                .expected("the letters of the mirror planes, such as \"y\" or \"xy\"")
                .found(format!("\"{letters}\""))
                .in_field(Self::SYMMETRY));
        }
        if let Err(word) = units::parsed(self.units.as_str()) {
            let known: Vec<&str> = units::UNITS.iter().map(|u| u.0).collect();
            return Err(CallError::new(
                "unknown-unit",
                format!("`{word}` is not a unit, or a second one"),
            )
            .expected(format!(
                "at most one unit each of length, mass, force and angle: {}",
                known.join(", ")
            ))
            .found(format!("\"{}\"", self.units.as_str()))
            .in_field(Self::UNITS));
        }
        let lines = self.lines.unwrap_or_default();
        let texts = [self.symmetry, self.units, self.version].into_iter().chain(lines);
        Ok(Value::list(texts.map(Text::into_value)))
    }
}

/// The row of the header.
pub fn row() -> Row {
    <Model<f64> as StaticRow>::row()
}

/// The text of that field in the header: the first object of kind `Model`; empty without one.
pub fn text<T: Scalar>(graph: &Graph<T>, field: &str) -> String {
    let Some(object) = graph.objects().find(|o| o.row.role == Role::Header) else {
        return String::new();
    };
    match object.row.field(field).and_then(|at| object.args.get(at)) {
        Some(Value::Text(text)) => text.to_string(),
        _ => String::new(),
    }
}

/// The mirror planes, as "y" or "xy"; empty without symmetry.
pub fn symmetry(graph: &Graph<f64>) -> String {
    text(graph, "symmetry")
}
