//! Attributes that every object has besides its geometry: visibility, colour, orientation, divisions and their
//! spacing. A change of them does not evaluate the object again.

use crate::{CallError, Class, DefaultValue, FieldSpec, Value};
use moldloft_num::Real;
use std::sync::Arc;

/// Below this logarithm of the total growth the panels are alike.
const NO_GROWTH: f64 = 1e-12;

/// Spacing of panels along a parameter, from one end to the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Spacing {
    /// Even in the parameter.
    #[default]
    Uniform,
    /// Narrow towards both ends: (1 - cos(pi s)) / 2.
    Cosine,
    /// Narrow towards the begin: 1 - cos(pi s / 2).
    Start,
    /// Narrow towards the end: sin(pi s / 2).
    End,
    /// Each panel is this many times as long as the one before.
    Growth(f64),
}

impl Spacing {
    /// The words for all but growth.
    pub const WORDS: [(&'static str, Spacing); 4] = [
        ("uniform", Spacing::Uniform),
        ("cosine", Spacing::Cosine),
        ("start", Spacing::Start),
        ("end", Spacing::End),
    ];

    /// True when all panels have the same length.
    pub fn is_even(&self) -> bool {
        matches!(self, Spacing::Uniform) || *self == Spacing::Growth(1.0)
    }

    /// Position of the fraction `s` of `n` panels, 0 at 0 and 1 at 1.
    pub fn at(&self, s: f64, n: u32) -> f64 {
        let right = std::f64::consts::FRAC_PI_2;
        match *self {
            _ if s <= 0.0 => 0.0,
            _ if s >= 1.0 => 1.0,
            Spacing::Uniform => s,
            Spacing::Cosine => (1.0 - Real::cos(2.0 * right * s)) * 0.5,
            Spacing::Start => 1.0 - Real::cos(right * s),
            Spacing::End => Real::sin(right * s),
            Spacing::Growth(q) => {
                // (q^(n s) - 1) / (q^n - 1), without overflow for large n.
                let log = Real::ln(q) * f64::from(n);
                if log.abs() < NO_GROWTH {
                    s
                } else if log > 0.0 {
                    (Real::exp(log * (s - 1.0)) - Real::exp(-log)) / (1.0 - Real::exp(-log))
                } else {
                    (1.0 - Real::exp(log * s)) / (1.0 - Real::exp(log))
                }
            }
        }
    }

    /// The same spacing seen from the other end.
    pub fn reversed(self) -> Self {
        match self {
            Spacing::Start => Spacing::End,
            Spacing::End => Spacing::Start,
            Spacing::Growth(q) => Spacing::Growth(1.0 / q),
            even => even,
        }
    }

    /// The spacing as an argument: a word or a number.
    pub fn spelled(&self) -> String {
        match self {
            Spacing::Growth(q) => q.to_string(),
            word => Spacing::WORDS
                .iter()
                .find(|(_, s)| s == word)
                .map_or(String::new(), |(w, _)| format!("\"{w}\"")),
        }
    }
}

/// Attributes of a surface's panels besides their number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelAttributes {
    /// The target length of panels along u and v, in the model's unit.
    pub size: [Option<f64>; 2],
    /// Their spacing along u and v, if stated.
    pub spacing: [Option<Spacing>; 2],
    /// Role of its patch for a flow solver or builder: "wetted", "lid", "waterline", "symmetry", or
    /// names given by the user.
    pub tags: Vec<Arc<str>>,
}

// No part is ever NaN.
impl Eq for PanelAttributes {}

/// Attributes of an object besides its geometry: display and divisions. A change here never
/// evaluates geometry again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attributes {
    /// Colour index 0..=255; 0..=15 are the sixteen classic ones.
    pub colour: i32,
    /// Visibility: positive shown, 0 or negative hidden; the magnitude is a display mask, stored
    /// unchanged.
    pub visible: i32,
    /// Layer 0..=255.
    pub layer: i32,
    /// Divisions along each parameter: the number of panels. With 0 the neighbours decide.
    pub divisions: [u32; 2],
    /// Subdivisions of each division: finer tabulation between panel edges.
    pub subdivisions: [u32; 2],
    /// 1 when the normal of the panels is opposite to the natural one, plus 2 for a face of a cavity; see
    /// [`Self::reversed`] and [`Self::cavity`].
    pub orientation: i32,
    /// Attributes of a model file, such as `A:Note(port side)`, stored unchanged.
    pub attributes: Option<Arc<str>>,
    /// Divisions of a solid in u, v and w; with 0 the neighbours, or the default, decide.
    pub blocks: [u32; 3],
    /// True when divisions were given: an image without divisions has those of its original.
    pub divided: bool,
    /// Attributes of the panels besides their number.
    pub panels: Option<Arc<PanelAttributes>>,
}

/// The most panels along one parameter.
const MOST_DIVISIONS: f64 = 1e6;

const fn head(name: &'static str, help: &'static str, default: DefaultValue) -> FieldSpec {
    FieldSpec { default: Some(default), ..FieldSpec::new(name, Class::Integer, help) }
}

/// The named arguments that every kind accepts besides its own.
pub const ATTRIBUTES: [FieldSpec; 10] = [
    head("colour", "Colour index, 0 to 255.", DefaultValue::Unset),
    head("visible", "Shown when positive, hidden when 0 or negative.", DefaultValue::Number(1.0)),
    head("layer", "Layer, 0 to 255.", DefaultValue::Number(0.0)),
    head(
        "divisions",
        "Panels along the curve, or {along u, along v}, or cells {u, v, w} of a solid; 0 or \
        \"auto\": taken from the neighbours.",
        DefaultValue::Unset,
    ),
    head("subdivisions", "Steps in each division, or {in u, in v}.", DefaultValue::Unset),
    FieldSpec {
        class: Class::Number,
        ..head("size", "Target length of panels, or {along u, along v}.", DefaultValue::Unset)
    },
    FieldSpec {
        class: Class::Any,
        ..head(
            "spacing",
            "\"uniform\", \"cosine\", \"start\" or \"end\" (narrow there), or the growth from panel to \
             panel; or {along u, along v}.",
            DefaultValue::Unset,
        )
    },
    FieldSpec {
        class: Class::Text,
        many: true,
        ..head(
            "tags",
            "Role of the patch: \"wetted\", \"lid\", \"waterline\", \"symmetry\" or names of your \
            own.",
            DefaultValue::Unset,
        )
    },
    head(
        "orientation",
        "1 reverses the normals of a surface's panels; 2: the closed body of which it is a face is a cavity, whose \
         panels face inward; 3: both.",
        DefaultValue::Unset,
    ),
    FieldSpec {
        class: Class::Text,
        ..head("attributes", "Attributes of a model file, stored unchanged.", DefaultValue::Unset)
    },
];

impl Attributes {
    /// The default head of an object of `class`.
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
            blocks: [0; 3],
            divided: false,
            panels: None,
        }
    }

    /// True when the normal of the panels is opposite to the natural one.
    pub fn reversed(&self) -> bool {
        self.orientation & 1 != 0
    }

    /// True for a face of a cavity.
    pub fn cavity(&self) -> bool {
        self.orientation & 2 != 0
    }

    /// True when the object is displayed and panelled.
    pub fn shown(&self) -> bool {
        self.visible > 0
    }

    /// Sets one part by its name; false when `name` is not a part of a head.
    ///
    /// # Errors
    /// A [`CallError`] when the value is not a whole number in range.
    pub fn set<T: Real>(&mut self, name: &str, value: &Value<T>) -> Result<bool, CallError> {
        let whole = |low: f64, high: f64, value: &Value<T>| -> Result<f64, CallError> {
            let Value::Number(x) = value else {
                return Err(CallError::wrong_class(Class::Integer, value.class()));
            };
            let x = x.re();
            if x.fract() == 0.0 && x >= low && x <= high {
                return Ok(x);
            }
            Err(CallError::new("out-of-range", format!("{name} = {x} is out of range"))
                .expected(format!("a whole number from {low} to {high}"))
                .found(x.to_string()))
        };
        let pair = |value: &Value<T>, least: f64, old: [u32; 2]| -> Result<[u32; 2], CallError> {
            let most = |v: &Value<T>| match v {
                Value::Text(word) if least == 0.0 && &**word == "auto" => Ok(0),
                v => whole(least, MOST_DIVISIONS, v).map(|x| x as u32),
            };
            match value {
                Value::List(items) if items.len() == 2 => Ok([most(&items[0])?, most(&items[1])?]),
                Value::List(items) => Err(CallError::new(
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
                let count = |v: &Value<T>| match v {
                    Value::Text(_) => Ok(0),
                    v => whole(0.0, MOST_DIVISIONS, v).map(|x| x as u32),
                };
                let given: &[Value<T>] = match value {
                    Value::List(items) => items,
                    single => std::slice::from_ref(single),
                };
                // {a, b, c} of three numbers reads as a vector.
                let three = match value {
                    Value::Vector(v) => Some(v.to_array().map(Value::Number)),
                    Value::List(items) if items.len() == 3 => {
                        Some(std::array::from_fn(|k| items[k].clone()))
                    }
                    _ => None,
                };
                self.blocks = match (&three, given) {
                    (Some([u, v, w]), _) => [count(u)?, count(v)?, count(w)?],
                    (None, [n]) => [count(n)?; 3],
                    (None, [u, v]) => [count(u)?, count(v)?, 0],
                    _ => [0; 3],
                };
                if three.is_some() {
                    self.divided = true;
                    return Ok(true);
                }
                self.divisions = pair(value, 0.0, self.divisions)?;
                self.divided = true;
            }
            "subdivisions" => self.subdivisions = pair(value, 1.0, self.subdivisions)?,
            "size" => {
                let size = both(name, value, length)?;
                Arc::make_mut(self.panels.get_or_insert_default()).size = size;
            }
            "spacing" => {
                let spacing = both(name, value, spacing)?;
                Arc::make_mut(self.panels.get_or_insert_default()).spacing = spacing;
            }
            "tags" => {
                let tags = tags(value)?;
                Arc::make_mut(self.panels.get_or_insert_default()).tags = tags;
            }
            "orientation" => self.orientation = whole(0.0, 3.0, value)? as i32,
            "attributes" => match value {
                Value::Text(text) => self.attributes = Some(text.clone()),
                other => return Err(CallError::wrong_class(Class::Text, other.class())),
            },
            _ => return Ok(false),
        }
        Ok(true)
    }
}

impl Attributes {
    /// Its divisions; where neighbours decide, the default of its class.
    pub fn own_divisions(&self) -> [u32; 2] {
        self.divisions.map(|n| if n == 0 { 8 } else { n })
    }

    /// The stated divisions, along u and v.
    pub fn stated_divisions(&self) -> [Option<u32>; 2] {
        self.divisions.map(|n| (self.divided && n > 0).then_some(n))
    }
}

/// A value for both parameters, or {for u, for v}.
fn both<T: Real, R: Copy>(
    name: &str,
    value: &Value<T>,
    one: impl Fn(&str, &Value<T>) -> Result<R, CallError>,
) -> Result<[R; 2], CallError> {
    match value {
        Value::List(items) if items.len() == 2 => {
            Ok([one(name, &items[0])?, one(name, &items[1])?])
        }
        Value::Vector(_) | Value::List(_) => Err(CallError::new(
            "wrong-length",
            format!("{name} takes one value, or two: one along u and one along v"),
        )),
        single => one(name, single).map(|x| [x; 2]),
    }
}

/// A length of panels; 0 or "auto": `None`.
fn length<T: Real>(name: &str, value: &Value<T>) -> Result<Option<f64>, CallError> {
    match value {
        Value::Number(x) if x.re() == 0.0 => Ok(None),
        Value::Number(x) if x.re() > 0.0 && x.re().is_finite() => Ok(Some(x.re())),
        Value::Number(x) => {
            Err(CallError::new("out-of-range", format!("{name} = {} is out of range", x.re()))
                .expected("a positive length in the model's unit, or 0 for none")
                .found(x.re().to_string()))
        }
        Value::Text(word) if &**word == "auto" => Ok(None),
        other => Err(CallError::wrong_class(Class::Number, other.class())),
    }
}

/// The steepest growth from panel to panel, and its inverse the least.
const MOST_GROWTH: f64 = 10.0;

fn spacing<T: Real>(name: &str, value: &Value<T>) -> Result<Option<Spacing>, CallError> {
    let words = || Spacing::WORDS.map(|(word, _)| word).join(", ");
    match value {
        Value::Number(x) if (1.0 / MOST_GROWTH..=MOST_GROWTH).contains(&x.re()) => {
            Ok(Some(Spacing::Growth(x.re())))
        }
        Value::Number(x) => {
            Err(CallError::new("out-of-range", format!("{name} = {} is out of range", x.re()))
                .expected(format!("a growth from {} to {MOST_GROWTH}", 1.0 / MOST_GROWTH))
                .found(x.re().to_string()))
        }
        Value::Text(word) if &**word == "auto" => Ok(None),
        Value::Text(word) => match Spacing::WORDS.iter().find(|(w, _)| *w == &**word) {
            Some((_, spacing)) => Ok(Some(*spacing)),
            None => Err(CallError::new("unknown-word", format!("unknown {name} \"{word}\""))
                .expected(format!("{} or a number, the growth from panel to panel", words()))
                .found(format!("\"{word}\""))),
        },
        other => Err(CallError::wrong_class(Class::Text, other.class())),
    }
}

fn tags<T: Real>(value: &Value<T>) -> Result<Vec<Arc<str>>, CallError> {
    let one = |value: &Value<T>| match value {
        Value::Text(tag) if !tag.is_empty() && !tag.chars().any(char::is_whitespace) => {
            Ok(tag.clone())
        }
        Value::Text(tag) => {
            Err(CallError::new("out-of-range", format!("\"{tag}\" is not a valid tag"))
                .expected("a word without blanks, such as \"wetted\", \"lid\" or \"keel\"")
                .found(format!("\"{tag}\"")))
        }
        other => Err(CallError::wrong_class(Class::Text, other.class())),
    };
    let mut tags = match value {
        Value::List(items) => items.iter().map(one).collect::<Result<Vec<_>, _>>()?,
        single => vec![one(single)?],
    };
    let mut seen = Vec::new();
    tags.retain(|tag| {
        let new = !seen.contains(tag);
        seen.push(tag.clone());
        new
    });
    Ok(tags)
}
