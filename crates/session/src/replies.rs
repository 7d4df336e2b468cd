//! Facts in the headers of replies. Places are pairs of offsets of the text in UTF-16 units.

use serde::Serialize;
use serde_json::Value;

/// Offsets of a part of the text.
pub type TextRange = [usize; 2];

/// A parameter of the model.
#[derive(Serialize)]
pub struct ParamFact {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The value that the text gives it.
    pub default: f64,
    /// Its range.
    pub range: Option<[f64; 2]>,
    /// True for whole numbers.
    pub whole: bool,
    /// True when the text, or a file beside it, has it as a number.
    pub written: bool,
    /// Its declaration.
    pub place: Option<TextRange>,
}

/// State of an object.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectState {
    /// It has a value.
    Ok,
    /// It is at fault.
    Failed,
    /// An object that it needs is at fault.
    Blocked,
}

/// An object of the model.
#[derive(Serialize)]
pub struct ObjectFact {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// The class of its value.
    pub class: &'static str,
    /// Its state.
    pub state: ObjectState,
    /// True unless it is hidden by the text.
    pub shown: bool,
    /// The names of the objects that it is made of.
    pub parents: Vec<String>,
}

/// A correction of the text.
#[derive(Serialize)]
pub struct CorrectionFact {
    /// What is replaced.
    pub place: TextRange,
    /// The replacement.
    pub insert: String,
    /// Its title.
    pub title: String,
}

/// A diagnostic.
#[derive(Serialize)]
pub struct FaultFact {
    /// Stable name of the kind of fault.
    pub id: String,
    /// `error`, `warning` or `note`.
    pub severity: &'static str,
    /// The message.
    pub message: String,
    /// Its place in the main text.
    pub place: Option<TextRange>,
    /// Its line, from 1.
    pub line: Option<u32>,
    /// The file, if it is not the main one.
    pub file: Option<String>,
    /// Its place in that file.
    pub elsewhere: Option<TextRange>,
    /// Expected input.
    pub expected: Option<String>,
    /// Found input.
    pub found: Option<String>,
    /// Background.
    pub notes: Vec<String>,
    /// Ways to fix it.
    pub help: Vec<String>,
    /// The object at fault.
    pub object: Option<String>,
    /// A change of the main text that fixes it.
    pub edit: Option<CorrectionFact>,
}

/// A remark of the writer of a file.
#[derive(Serialize)]
pub struct RemarkFact {
    /// `error`, `warning` or `note`.
    pub severity: &'static str,
    /// The message.
    pub message: String,
    /// What was expected and found, background and remedies.
    pub help: Vec<String>,
    /// The object.
    pub object: Option<String>,
}

/// The value of an expression: a number, numbers, a text, the name of a class, or a summary of an array.
#[derive(Default, Serialize)]
pub struct ValueFact {
    /// The expression.
    pub expression: String,
    /// Its value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// The reason why it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Its derivative, if one was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub derivative: Option<Value>,
    /// The reason why it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_derivative: Option<String>,
}

/// An argument of a kind, for a form.
#[derive(Serialize)]
pub struct ArgumentFact {
    /// Its name.
    pub name: &'static str,
    /// A line of help.
    pub help: &'static str,
    /// Its class.
    pub class: &'static str,
    /// The classes of objects that it accepts.
    pub accepts: Vec<&'static str>,
    /// True for a list.
    pub many: bool,
    /// Least length of a list.
    pub least: usize,
    /// True without a default.
    pub required: bool,
    /// Its default.
    pub default: Value,
    /// The permitted words of a text.
    pub words: Vec<&'static str>,
}

/// A kind of objects.
#[derive(Serialize)]
pub struct KindFact {
    /// Its name.
    pub name: String,
    /// The class of its value.
    pub class: &'static str,
    /// Its first sentence.
    pub about: String,
    /// Other words by which it is looked for.
    pub also: Option<String>,
    /// Its arguments.
    pub fields: Vec<ArgumentFact>,
}

/// A change of the text.
#[derive(Serialize)]
pub struct EditFact {
    /// Where the replaced text begins.
    pub from: usize,
    /// Where it ends.
    pub to: usize,
    /// The replacement.
    pub insert: String,
}

/// A number of a parameter in a file beside the text, and its new value.
#[derive(Serialize)]
pub struct BesideFact {
    /// The parameter.
    pub name: String,
    /// The file.
    pub file: String,
    /// Where the number begins.
    pub from: usize,
    /// Where it ends.
    pub to: usize,
    /// What is there.
    pub found: String,
    /// The replacement.
    pub insert: String,
}

/// A number that moves a dragged point.
#[derive(Serialize)]
pub struct HandleFact {
    /// Its name.
    pub name: String,
    /// True for a number of the object itself.
    pub own: bool,
    /// True for a parameter of the model.
    pub parameter: bool,
    /// Derivative of the point by the number.
    pub direction: [f64; 3],
    /// Its value.
    pub value: f64,
    /// Its range.
    pub range: Option<[f64; 2]>,
}

/// A number that was adjusted to reach a target.
#[derive(Serialize)]
pub struct AdjustmentFact {
    /// Its name.
    pub name: String,
    /// Its value before.
    pub before: f64,
    /// Its value now.
    pub after: f64,
    /// Its fraction of the weighted change, 0 to 1.
    pub share: f64,
}
