//! A set as a program of the language.

use super::{binary_name, unary_name};
use crate::expr::algebra::Unary;
use crate::expr::form::Form;
use crate::expr::primitive::{Binary, Op};
use crate::{FieldError, Primitive, Set, SetAttributes};
use std::collections::HashMap;
use std::fmt::Write as _;

struct SdlWriter<'a> {
    out: String,
    name: &'a str,
    fields: HashMap<usize, String>,
    count: usize,
}

fn number(x: f64) -> String {
    if x < 0.0 { format!("({x:?})") } else { format!("{x:?}") }
}

impl SdlWriter<'_> {
    fn fresh(&mut self, kind: &str, text: &str) -> String {
        self.count += 1;
        let name = format!("{}_{}", self.name, self.count);
        let _ = writeln!(self.out, "{kind} {name} = {text};");
        name
    }

    /// The name of a primitive, declared before it is used.
    fn field(&mut self, root: &Primitive) -> Result<String, FieldError> {
        for node in crate::expr::tape::order(root) {
            if self.fields.contains_key(&node.identity()) {
                continue;
            }
            let of = |p: &Primitive| self.fields[&p.identity()].clone();
            let axes = [0, 1, 2].map(|k| format!("{}_{}", self.name, ["x", "y", "z"][k]));
            let text = match (node.form(), node.operation()) {
                // The constructor where it makes the very same expression.
                (Form::Sphere { centre, radius }, _)
                    if Primitive::sphere(*centre, *radius).is_ok_and(|p| p.same(&node)) =>
                {
                    let [x, y, z] = centre.to_array().map(number);
                    format!("sphere({{{x}, {y}, {z}}}, {})", number(*radius))
                }
                (_, Op::User { .. }) => return Err(FieldError::Outside),
                (_, Op::Real(c)) => format!("{}*0 + {}", axes[0], number(*c)),
                (_, Op::Plane { normal, offset }) => {
                    let mut text = String::new();
                    for k in 0..3 {
                        if normal[k] != 0.0 {
                            let plus = if text.is_empty() { "" } else { " + " };
                            let _ = write!(text, "{plus}{}*{}", axes[k], number(normal[k]));
                        }
                    }
                    let _ = write!(text, " + {}", number(*offset));
                    text
                }
                (_, Op::Unary(Unary::Neg, a)) => format!("-{}", of(a)),
                (_, Op::Unary(Unary::Reciprocal, a)) => format!("({}*0 + 1)/{}", axes[0], of(a)),
                (_, Op::Unary(Unary::Ln, a)) => format!("log({})", of(a)),
                (_, Op::Unary(f, a)) => format!("{}({})", unary_name(*f), of(a)),
                (_, Op::Over(a, c)) => format!("{}/{}", of(a), number(*c)),
                (_, Op::Power(a, n)) => format!("{}^{n}", of(a)),
                (_, Op::Binary(f, a, b)) => {
                    let (a, b) = (of(a), of(b));
                    match f {
                        Binary::Add => format!("{a} + {b}"),
                        Binary::Sub => format!("{a} - {b}"),
                        Binary::Mul => format!("{a}*{b}"),
                        Binary::Div => format!("{a}/{b}"),
                        Binary::Mod => format!("remainder({a}, {b})"),
                        _ => format!("{}({a}, {b})", binary_name(*f)),
                    }
                }
            };
            let name = self.fresh("field", &text);
            self.fields.insert(node.identity(), name);
        }
        Ok(self.fields[&root.identity()].clone())
    }
}

/// Attributes as further arguments of the function `attributes`.
fn attribute_arguments(a: &SetAttributes) -> String {
    let mut out = String::new();
    let mut text = |name: &str, text: &str| {
        let _ = write!(out, ", {name} = \"{}\"", text.replace(['"', '\\'], "'"));
    };
    if let Some(name) = &a.name {
        text("name", name);
    }
    if let Some(material) = &a.material {
        text("material", material);
    }
    if !a.tags.is_empty() {
        let tags = a.tags.iter().map(|(tag, value)| format!("{tag} = {value}"));
        text("tags", &tags.collect::<Vec<_>>().join("; "));
    }
    if let Some(colour) = a.colour {
        let _ = write!(out, ", colour = {colour}");
    }
    if let Some(tolerance) = a.tolerance {
        let _ = write!(out, ", tolerance = {tolerance:?}");
    }
    out
}

impl Set<f64> {
    /// The set as a program that declares it under `name`: the same values, bit for bit, and the
    /// same faces and names.
    ///
    /// # Errors
    /// [`FieldError::Outside`] when a primitive is a function from outside.
    pub fn to_sdl(&self, name: &str) -> Result<String, FieldError> {
        let mut w = SdlWriter { out: String::new(), name, fields: HashMap::new(), count: 0 };
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let n = [0, 1, 2].map(|i| if i == k { "1" } else { "0" }).join(", ");
            let _ = writeln!(w.out, "field {name}_{axis} = plane({{{n}}}, {{0, 0, 0}});");
        }
        let root = self.bottom_up::<String, FieldError>(&mut |set, operands| {
            let text = match (set.primitive(), operands) {
                (Some(p), _) => format!("set({})", w.field(p)?),
                (_, Some([a, b])) => format!("{a} {} {b}", if set.is_union() { '|' } else { '&' }),
                _ if set.is_everything() => "everything()".to_owned(),
                _ => "nothing()".to_owned(),
            };
            let with = set.attributes().map(attribute_arguments).unwrap_or_default();
            let text = if with.is_empty() { text } else { format!("attributes({text}{with})") };
            Ok(w.fresh("set", &text))
        })?;
        let _ = writeln!(w.out, "set {name} = {root};");
        Ok(w.out)
    }
}
