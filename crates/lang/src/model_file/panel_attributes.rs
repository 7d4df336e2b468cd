//! Size, spacing and tags of panels, which have no columns in model files, as attributes.
//!
//! `A:Size(0.5 0)`, `A:Spacing(cosine 1.2)`, `A:Tags(wetted keel)`; along u, then v, with `auto`
//! for defaults. An attribute of these names with other content is kept unchanged.

use moldloft_registry::{Attributes, PanelAttributes, Value};
use std::fmt::Write;

/// The attributes of panels in a model file's line, from a head.
pub fn written(panels: &PanelAttributes) -> String {
    let mut out = String::new();
    if panels.size.iter().any(Option::is_some) {
        let [u, v] = panels.size.map(|s| s.map_or("auto".into(), |s| s.to_string()));
        let _ = write!(out, " A:Size({u} {v})");
    }
    if panels.spacing.iter().any(Option::is_some) {
        let spelled = panels.spacing.map(|s| s.map_or("auto".into(), |s| s.spelled()));
        let [u, v] = spelled.map(|s| s.replace('"', ""));
        let _ = write!(out, " A:Spacing({u} {v})");
    }
    if !panels.tags.is_empty() {
        let _ = write!(out, " A:Tags({})", panels.tags.join(" "));
    }
    out
}

/// Reads an attribute of panels into a head; false for other attributes.
pub fn read(head: &mut Attributes, name: &str, text: &str) -> bool {
    let argument = match name {
        "Size" => "size",
        "Spacing" => "spacing",
        "Tags" => "tags",
        _ => return false,
    };
    let words = text.split_whitespace().map(|word| match word.parse::<f64>() {
        Ok(x) if name != "Tags" => Value::<f64>::Number(x),
        _ => Value::text(word),
    });
    let value = Value::list(words);
    let counts = matches!(&value, Value::List(items) if name == "Tags" || items.len() == 2);
    counts && head.set(argument, &value).is_ok()
}
