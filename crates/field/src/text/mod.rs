//! Sets and fields as text: written, read again bit for bit, and taken over from other programs.
//!
//! The text is a list of numbered nodes, operands before their users, each part that is shared written once:
//!
//! ```text
//! moldloft set 1
//! 0 plane 1.0 0.0 0.0 0.0
//! 1 power 0 2
//! 2 leaf 1
//! root 2
//! ```

mod foreign;
mod sdl;

pub use foreign::{read_fidget, read_libfive};

use crate::expr::algebra::Unary;
use crate::expr::form::Form;
use crate::expr::primitive::{Binary, Op};
use crate::{FieldError, Primitive, Set, SetAttributes};
use moldloft_num::{Axis, Plane, Vec3};
use std::collections::HashMap;
use std::fmt::Write as _;

/// Reason why a text is not a set or field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextError {
    /// The line, from 1.
    pub line: usize,
    /// Description of the fault.
    pub message: String,
}

impl std::fmt::Display for TextError {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for TextError {}

fn wrong<R>(line: usize, message: impl Into<String>) -> Result<R, TextError> {
    Err(TextError { line, message: message.into() })
}

/// The first line, with the version of the format.
const HEADER: &str = "moldloft set 1";

const UNARY: [(&str, Unary); 11] = [
    ("neg", Unary::Neg),
    ("abs", Unary::Abs),
    ("sign", Unary::Sign),
    ("sqrt", Unary::Sqrt),
    ("s_sqrt", Unary::SignedSqrt),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("exp", Unary::Exp),
    ("ln", Unary::Ln),
    ("tan", Unary::Tan),
    ("reciprocal", Unary::Reciprocal),
];

const BINARY: [(&str, Binary); 8] = [
    ("add", Binary::Add),
    ("sub", Binary::Sub),
    ("mul", Binary::Mul),
    ("min", Binary::Min),
    ("max", Binary::Max),
    ("atan2", Binary::Atan2),
    ("div", Binary::Div),
    ("mod", Binary::Mod),
];

pub(super) fn unary_name(f: Unary) -> &'static str {
    UNARY.iter().find(|u| u.1 == f).map_or("neg", |u| u.0)
}

pub(super) fn binary_name(f: Binary) -> &'static str {
    BINARY.iter().find(|b| b.1 == f).map_or("add", |b| b.0)
}

fn numbers(out: &mut String, values: &[f64]) {
    for x in values {
        let _ = write!(out, " {x:?}");
    }
}

#[derive(Default)]
struct TextWriter {
    out: String,
    count: usize,
    primitives: HashMap<usize, usize>,
}

impl TextWriter {
    fn line(&mut self, text: &str) -> usize {
        let _ = writeln!(self.out, "{} {text}", self.count);
        self.count += 1;
        self.count - 1
    }

    fn primitive(&mut self, root: &Primitive) -> Result<usize, FieldError> {
        for node in crate::expr::tape::order(root) {
            let key = node.identity();
            if self.primitives.contains_key(&key) {
                continue;
            }
            let of = |p: &Primitive| self.primitives[&p.identity()];
            let mut text = String::new();
            match node.operation() {
                Op::Real(c) => {
                    text.push_str("real");
                    numbers(&mut text, &[*c]);
                }
                Op::Plane { normal, offset } => {
                    text.push_str("plane");
                    numbers(&mut text, &[normal.x, normal.y, normal.z, *offset]);
                }
                Op::User { .. } => return Err(FieldError::Outside),
                Op::Unary(f, a) => {
                    let _ = write!(text, "{} {}", unary_name(*f), of(a));
                }
                Op::Over(a, c) => {
                    let _ = write!(text, "over {}", of(a));
                    numbers(&mut text, &[*c]);
                }
                Op::Power(a, n) => {
                    let _ = write!(text, "power {} {n}", of(a));
                }
                Op::Binary(f, a, b) => {
                    let _ = write!(text, "{} {} {}", binary_name(*f), of(a), of(b));
                }
            }
            form_text(&mut text, node.form(), node.operation());
            let number = self.line(&text);
            self.primitives.insert(key, number);
        }
        Ok(self.primitives[&root.identity()])
    }
}

/// ` as sphere ...` where the form does not follow from the operation.
fn form_text(out: &mut String, form: &Form<f64>, op: &Op<f64>) {
    let axial = |out: &mut String, name: &str, a: &Axis<f64>, rest: &[f64]| {
        let _ = write!(out, " as {name}");
        numbers(out, &a.point.to_array());
        numbers(out, &a.direction.to_array());
        numbers(out, rest);
    };
    match form {
        Form::Real(_) | Form::General => {}
        Form::Plane(_) if matches!(op, Op::Plane { .. } | Op::Unary(Unary::Neg, _)) => {}
        Form::Plane(p) => {
            out.push_str(" as plane");
            numbers(out, &p.point.to_array());
            numbers(out, &p.normal.to_array());
        }
        // The form of a complement is that of its operand.
        _ if matches!(op, Op::Unary(Unary::Neg, _)) => {}
        Form::Sphere { centre, radius } => {
            out.push_str(" as sphere");
            numbers(out, &centre.to_array());
            numbers(out, &[*radius]);
        }
        Form::Cylinder { axis, radius } => axial(out, "cylinder", axis, &[*radius]),
        Form::Cone { axis, angle } => axial(out, "cone", axis, &[*angle]),
        Form::Torus { axis, major, minor } => axial(out, "torus", axis, &[*major, *minor]),
        Form::Cyclide { axis, along, major, minor, change } => {
            let [x, y, z] = along.to_array();
            axial(out, "cyclide", axis, &[x, y, z, *major, *minor, *change]);
        }
    }
}

/// A text of one word: blanks and the signs that separate are written by their codes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out.push_str("\\n"),
            _ => out.push(c),
        }
    }
    out.push('"');
    out
}

fn attribute_text(a: &SetAttributes) -> String {
    let mut out = String::from(" with");
    if let Some(name) = &a.name {
        let _ = write!(out, " {} {}", if a.given { "given" } else { "name" }, quoted(name));
    }
    if let Some(colour) = a.colour {
        let _ = write!(out, " colour {colour}");
    }
    if let Some(material) = &a.material {
        let _ = write!(out, " material {}", quoted(material));
    }
    if let Some(tolerance) = a.tolerance {
        let _ = write!(out, " tolerance {tolerance:?}");
    }
    for (tag, value) in &a.tags {
        let _ = write!(out, " tag {} {}", quoted(tag), quoted(value));
    }
    out
}

impl Set<f64> {
    /// The set as text, from which [`Set::from_text`] makes an identical one, bit for bit.
    ///
    /// # Errors
    /// [`FieldError::Outside`] when a primitive is a function from outside.
    ///
    /// # Example
    /// ```
    /// use moldloft_field::{Primitive, Set};
    /// use moldloft_num::Vec3;
    ///
    /// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?).named("ball");
    /// let half = ball - Set::cuboid(Vec3::of(0.0, -2.0, -2.0), Vec3::of(2.0, 2.0, 2.0))?;
    /// assert!(Set::from_text(&half.to_text()?).unwrap().same(&half));
    /// # Ok::<(), moldloft_field::FieldError>(())
    /// ```
    pub fn to_text(&self) -> Result<String, FieldError> {
        let mut writer = TextWriter { out: format!("{HEADER}\n"), ..TextWriter::default() };
        let root = self.bottom_up::<usize, FieldError>(&mut |set, operands| {
            let mut text = match (set.primitive(), operands) {
                (Some(p), _) => format!("leaf {}", writer.primitive(p)?),
                (_, Some([a, b])) => {
                    format!("{} {a} {b}", if set.is_union() { "union" } else { "common" })
                }
                _ if set.is_everything() => "everything".to_owned(),
                _ => "nothing".to_owned(),
            };
            if let Some(a) = set.attributes() {
                text.push_str(&attribute_text(a));
            }
            Ok(writer.line(&text))
        })?;
        let _ = writeln!(writer.out, "root {root}");
        Ok(writer.out)
    }

    /// The set of a text written by [`Set::to_text`].
    ///
    /// # Errors
    /// The fault of the text, with its line.
    pub fn from_text(text: &str) -> Result<Self, TextError> {
        match read(text)? {
            ParsedShape::Set(set) => Ok(set),
            ParsedShape::Field(_) => wrong(1, "expected a set, found a field"),
        }
    }
}

impl Primitive<f64> {
    /// The primitive as text; see [`Set::to_text`].
    ///
    /// # Errors
    /// [`FieldError::Outside`] when part of it is a function from outside.
    pub fn to_text(&self) -> Result<String, FieldError> {
        let mut writer = TextWriter { out: format!("{HEADER}\n"), ..TextWriter::default() };
        let root = writer.primitive(self)?;
        let _ = writeln!(writer.out, "root {root}");
        Ok(writer.out)
    }

    /// The primitive of a text written by [`Primitive::to_text`].
    ///
    /// # Errors
    /// The fault of the text, with its line.
    pub fn from_text(text: &str) -> Result<Self, TextError> {
        match read(text)? {
            ParsedShape::Field(f) => Ok(f),
            ParsedShape::Set(_) => wrong(1, "expected a field, found a set"),
        }
    }
}

#[derive(Clone)]
enum ParsedShape {
    Field(Primitive),
    Set(Set),
}

/// The words of a line; a quoted string is one.
fn words(line: &str, number: usize) -> Result<Vec<String>, TextError> {
    let mut out = Vec::new();
    let mut chars = line.chars().peekable();
    while let Some(&c) = chars.peek() {
        if c.is_whitespace() {
            chars.next();
            continue;
        }
        let mut word = String::new();
        if c == '"' {
            chars.next();
            loop {
                match chars.next() {
                    Some('"') => break,
                    Some('\\') => match chars.next() {
                        Some('n') => word.push('\n'),
                        Some(c) => word.push(c),
                        None => return wrong(number, "a quoted text without an end"),
                    },
                    Some(c) => word.push(c),
                    None => return wrong(number, "a quoted text without an end"),
                }
            }
        } else {
            while let Some(c) = chars.next_if(|c| !c.is_whitespace()) {
                word.push(c);
            }
        }
        out.push(word);
    }
    Ok(out)
}

/// The words of a line from which values are taken in order.
struct Words<'a> {
    list: &'a [String],
    at: usize,
    line: usize,
}

impl Words<'_> {
    fn next(&mut self, what: &str) -> Result<&str, TextError> {
        let Some(word) = self.list.get(self.at) else {
            return wrong(self.line, format!("expected {what}, found the end of the line"));
        };
        self.at += 1;
        Ok(word)
    }
    fn number(&mut self) -> Result<f64, TextError> {
        let line = self.line;
        let word = self.next("a number")?;
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => wrong(line, format!("expected a finite number, found `{word}`")),
        }
    }
    fn whole(&mut self) -> Result<usize, TextError> {
        let line = self.line;
        let word = self.next("a whole number")?;
        word.parse().or_else(|_| wrong(line, format!("expected a whole number, found `{word}`")))
    }
    fn vector(&mut self) -> Result<Vec3, TextError> {
        Ok(Vec3::of(self.number()?, self.number()?, self.number()?))
    }
    fn axis(&mut self) -> Result<Axis<f64>, TextError> {
        Ok(Axis { point: self.vector()?, direction: self.vector()? })
    }
    fn done(&self) -> bool {
        self.at >= self.list.len()
    }
}

fn read(text: &str) -> Result<ParsedShape, TextError> {
    let mut lines = text.lines().enumerate().map(|(k, l)| (k + 1, l.trim()));
    match lines.next() {
        Some((_, HEADER)) => {}
        Some((n, found)) => {
            let found: String = found.chars().take(40).collect();
            return wrong(n, format!("expected `{HEADER}`, found `{found}`"));
        }
        None => return wrong(1, format!("expected `{HEADER}`, found nothing")),
    }
    let mut nodes: Vec<ParsedShape> = Vec::new();
    for (number, line) in lines.filter(|l| !l.1.is_empty() && !l.1.starts_with('#')) {
        let list = words(line, number)?;
        let mut w = Words { list: &list, at: 0, line: number };
        if list[0] == "root" {
            w.at = 1;
            let root = w.whole()?;
            return match nodes.get(root) {
                Some(node) => Ok(node.clone()),
                None => wrong(number, format!("there is no node {root}")),
            };
        }
        let own = w.whole()?;
        if own != nodes.len() {
            return wrong(number, format!("expected node {}, found {own}", nodes.len()));
        }
        let node = read_node(&mut w, &nodes)?;
        if !w.done() {
            return wrong(number, format!("nothing more was expected at `{}`", list[w.at]));
        }
        nodes.push(node);
    }
    wrong(text.lines().count(), "the text ends without `root`")
}

fn read_node(w: &mut Words, nodes: &[ParsedShape]) -> Result<ParsedShape, TextError> {
    let line = w.line;
    let word = w.next("an operation")?.to_owned();
    let operand = |w: &mut Words| -> Result<ParsedShape, TextError> {
        let k = w.whole()?;
        match nodes.get(k) {
            Some(node) => Ok(node.clone()),
            None => wrong(line, format!("node {k} is not above")),
        }
    };
    let field = |w: &mut Words| match operand(w)? {
        ParsedShape::Field(f) => Ok(f),
        ParsedShape::Set(_) => wrong(line, "expected a field, found a set"),
    };
    let set = |w: &mut Words| match operand(w)? {
        ParsedShape::Set(s) => Ok(s),
        ParsedShape::Field(_) => wrong(line, "expected a set, found a field"),
    };
    let op = match &*word {
        "everything" => return with_attributes(w, Set::everything()),
        "nothing" => return with_attributes(w, Set::nothing()),
        "leaf" => {
            let f = field(w)?;
            return with_attributes(w, Set::of_leaf(&f));
        }
        "union" | "common" => {
            let (a, b) = (set(w)?, set(w)?);
            let made = Set::of_two(word == "union", a, b);
            return with_attributes(w, made);
        }
        "real" => Op::Real(w.number()?),
        "plane" => Op::Plane { normal: w.vector()?, offset: w.number()? },
        "over" => {
            let a = field(w)?;
            let c = w.number()?;
            if c == 0.0 {
                return wrong(line, "division by 0");
            }
            Op::Over(a, c)
        }
        "power" => {
            let a = field(w)?;
            let n = w.whole()?;
            if n > 1000 {
                return wrong(line, format!("expected an exponent up to 1000, found {n}"));
            }
            Op::Power(a, n as u32)
        }
        other => {
            if let Some((_, f)) = UNARY.iter().find(|u| u.0 == other) {
                Op::Unary(*f, field(w)?)
            } else if let Some((_, f)) = BINARY.iter().find(|b| b.0 == other) {
                let (a, b) = (field(w)?, field(w)?);
                Op::Binary(*f, a, b)
            } else {
                return wrong(line, format!("there is no operation `{other}`"));
            }
        }
    };
    let made = Primitive::from_op(op);
    if w.done() {
        return Ok(ParsedShape::Field(made));
    }
    match w.next("`as`")? {
        "as" => {}
        other => return wrong(line, format!("expected `as`, found `{other}`")),
    }
    let form = match w.next("a form")? {
        "plane" => Form::Plane(Plane { point: w.vector()?, normal: w.vector()? }),
        "sphere" => Form::Sphere { centre: w.vector()?, radius: w.number()? },
        "cylinder" => Form::Cylinder { axis: w.axis()?, radius: w.number()? },
        "cone" => Form::Cone { axis: w.axis()?, angle: w.number()? },
        "torus" => Form::Torus { axis: w.axis()?, major: w.number()?, minor: w.number()? },
        "cyclide" => Form::Cyclide {
            axis: w.axis()?,
            along: w.vector()?,
            major: w.number()?,
            minor: w.number()?,
            change: w.number()?,
        },
        other => return wrong(line, format!("unknown primitive `{other}`")),
    };
    Ok(ParsedShape::Field(made.remembered(form)))
}

fn with_attributes(w: &mut Words, set: Set) -> Result<ParsedShape, TextError> {
    if w.done() {
        return Ok(ParsedShape::Set(set));
    }
    let line = w.line;
    match w.next("`with`")? {
        "with" => {}
        other => return wrong(line, format!("expected `with`, found `{other}`")),
    }
    let mut a = SetAttributes::default();
    while !w.done() {
        match &*w.next("an attribute")?.to_owned() {
            key @ ("name" | "given") => {
                a.given = key == "given";
                a.name = Some(w.next("a name")?.to_owned());
            }
            "colour" => match w.whole()? {
                n @ 0..=15 => a.colour = Some(n as u8),
                n => return wrong(line, format!("expected a colour from 0 to 15, found {n}")),
            },
            "material" => a.material = Some(w.next("a material")?.to_owned()),
            "tolerance" => a.tolerance = Some(w.number()?),
            "tag" => {
                let tag = w.next("a tag")?.to_owned();
                let value = w.next("the value of the tag")?.to_owned();
                a.tags.insert(tag, value);
            }
            other => return wrong(line, format!("there is no attribute `{other}`")),
        }
    }
    Ok(ParsedShape::Set(set.with(a)))
}
