use crate::{Class, DefaultValue, Fault, Field, Unit, Value};
use moldloft_num::Real;
use std::sync::Arc;

/// What every object carries besides its geometry: how it is drawn and divided. A change here
/// never evaluates geometry again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// Colour index 0..=255; 0..=15 are the sixteen classic ones.
    pub colour: i32,
    /// Visibility: positive shown, 0 or negative hidden; the magnitude is a display mask that is
    /// kept as it is.
    pub visible: i32,
    /// Layer 0..=255.
    pub layer: i32,
    /// Divisions in each parameter: panels along it.
    pub divisions: [u32; 2],
    /// Subdivisions of each division: finer tabulation between panel edges.
    pub subdivisions: [u32; 2],
    /// 1 when the normal of the panels is opposite to the natural one.
    pub orientation: i32,
    /// Attributes of a model file, such as `A:Note(port side)`, kept as they are.
    pub attributes: Option<Arc<str>>,
    /// True when divisions were given: an image without any is divided like its original.
    pub divided: bool,
}

/// The most panels along one parameter.
const MOST_DIVISIONS: f64 = 1e6;

const fn head(name: &'static str, help: &'static str, default: DefaultValue) -> Field {
    Field {
        name,
        help,
        class: Class::Integer,
        many: false,
        default: Some(default),
        unit: Unit::None,
        min: None,
        max: None,
        min_items: 0,
    }
}

/// The named arguments that every kind accepts besides its own.
pub const HEAD: [Field; 7] = [
    head("colour", "Colour index, 0 to 255.", DefaultValue::Unset),
    head("visible", "Shown when positive, hidden when 0 or negative.", DefaultValue::Number(1.0)),
    head("layer", "Layer, 0 to 255.", DefaultValue::Number(0.0)),
    head("divisions", "Panels along the curve, or {along u, along v}.", DefaultValue::Unset),
    head("subdivisions", "Steps in each division, or {in u, in v}.", DefaultValue::Unset),
    head("orientation", "1 turns the normal of a surface's panels round.", DefaultValue::Unset),
    Field {
        class: Class::Text,
        ..head("attributes", "Attributes of a model file, kept as they are.", DefaultValue::Unset)
    },
];

impl Head {
    /// The head of an object of `class` that says nothing.
    pub fn of(class: Class) -> Self {
        let (colour, divisions, subdivisions) = match class.dimension() {
            Some(0) => (14, [1, 1], [1, 1]),
            Some(1) => (11, [8, 1], [4, 1]),
            Some(_) => (10, [8, 8], [1, 1]),
            None => (12, [1, 1], [1, 1]),
        };
        Self {
            colour,
            visible: 1,
            layer: 0,
            divisions,
            subdivisions,
            orientation: 0,
            attributes: None,
            divided: false,
        }
    }

    /// True when the object is drawn and meshed.
    pub fn shown(&self) -> bool {
        self.visible > 0
    }

    /// Sets one part by its name; false when `name` is no part of a head.
    ///
    /// # Errors
    /// A [`Fault`] when the value is not a whole number in range.
    pub fn set<T: Real>(&mut self, name: &str, value: &Value<T>) -> Result<bool, Fault> {
        let whole = |low: f64, high: f64, value: &Value<T>| -> Result<f64, Fault> {
            let Value::Number(x) = value else {
                return Err(Fault::wrong_class(Class::Integer, value.class()));
            };
            let x = x.re();
            if x.fract() == 0.0 && x >= low && x <= high {
                return Ok(x);
            }
            Err(Fault::new("out-of-range", format!("{name} = {x} is out of range"))
                .expected(format!("a whole number from {low} to {high}"))
                .found(x.to_string()))
        };
        let pair = |value: &Value<T>, old: [u32; 2]| -> Result<[u32; 2], Fault> {
            let most = |v: &Value<T>| whole(1.0, MOST_DIVISIONS, v).map(|x| x as u32);
            match value {
                Value::List(items) if items.len() == 2 => Ok([most(&items[0])?, most(&items[1])?]),
                Value::List(items) => Err(Fault::new(
                    "wrong-length",
                    format!("{name} takes one or two whole numbers, found {}", items.len()),
                )),
                single => Ok([most(single)?, old[1]]),
            }
        };
        match name {
            "colour" => self.colour = whole(0.0, 255.0, value)? as i32,
            "visible" => self.visible = whole(-65536.0, 65535.0, value)? as i32,
            "layer" => self.layer = whole(0.0, 255.0, value)? as i32,
            "divisions" => {
                self.divisions = pair(value, self.divisions)?;
                self.divided = true;
            }
            "subdivisions" => self.subdivisions = pair(value, self.subdivisions)?,
            "orientation" => self.orientation = whole(0.0, 1.0, value)? as i32,
            "attributes" => match value {
                Value::Text(text) => self.attributes = Some(text.clone()),
                other => return Err(Fault::wrong_class(Class::Text, other.class())),
            },
            _ => return Ok(false),
        }
        Ok(true)
    }
}
