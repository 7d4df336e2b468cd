//! Functions that need more than the values of their arguments: the variable behind an argument,
//! the files of the run, the requested refinement.

use crate::functions::files::{OpenMode, STANDARD_OUTPUT};
use crate::functions::format::{self, FormatArgument};
use crate::functions::run_call::{RunCall, SequenceUse};
use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::source::scope::{Binding, Passed};
use crate::value::subarray::{ArraySection, Place};
use crate::value::variables::{self, Called as _};
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Row, Scalar, Value, Vectors};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{ExprId, Symbol, Type};
use std::fmt::Write;
use std::sync::Arc;

type Evaluated<T> = Result<Value<T>, Diagnostic>;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The row of a function for a number of arguments; includes the misprint of `makecc` of 1992.
    pub fn row(
        &mut self,
        m: &Module,
        symbol: Symbol,
        count: usize,
        span: Span,
    ) -> Option<Arc<Row>> {
        // Without a parameter it is the curvature of the points of an array.
        if count == 1 && m.program.name(symbol) == "curvature" {
            return self.loader.registry.get("curvatures").cloned();
        }
        if let Some(row) = &m.rows[symbol.0 as usize] {
            return Some(row.clone());
        }
        if m.program.name(symbol) != "makeecc" {
            return None;
        }
        let row = self.loader.registry.get("makecc")?.clone();
        if !std::mem::replace(&mut self.misprint_told, true) {
            let note = Diagnostic::remark("misprint", "`makeecc` is taken as `makecc`")
                .at(span)
                .help("the paper of 1992 prints it so in one listing; write `makecc`");
            self.report(note);
        }
        Some(row)
    }

    /// `format("%d", n)`.
    pub(crate) fn formatted(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let m = call.m;
        let pattern = self.text(m, call.first())?;
        let mut items = Vec::new();
        for arg in call.rest() {
            let value = self.operand(m, arg)?;
            flatten(&value, &mut items).map_err(|d| d.or_at(m.program[arg].span))?;
        }
        format::format(&pattern, &items).map(|text| Value::text(&text))
    }

    /// `close(f)`.
    pub(crate) fn close_file(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let unit = self.unit(call.m, call.first())?;
        self.env.files.close(unit).map(|()| Value::Unset)
    }

    /// `write(f, a, b)`.
    pub(crate) fn write_values(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let m = call.m;
        let unit = self.unit(m, call.first())?;
        let mut text = String::new();
        for arg in call.rest() {
            let value = self.operand(m, arg)?;
            lines(&value, &mut text).map_err(|d| d.or_at(m.program[arg].span))?;
            self.charge(&value, m.program[arg].span)?;
        }
        if unit == STANDARD_OUTPUT || unit == 0 {
            for line in text.lines() {
                self.print(line.to_string(), call.span)?;
            }
            return Ok(Value::Unset);
        }
        self.env.files.write(unit, &text).map(|()| Value::Unset)
    }

    /// `read(f, a, b[1,])`.
    pub(crate) fn read_values(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let m = call.m;
        let unit = self.unit(m, call.first())?;
        for arg in call.rest() {
            let place = self.place(m, arg)?;
            let value = self.read_place(unit, &place)?;
            self.charge(&value, m.program[arg].span)?;
            self.store(place, value).map_err(|d| d.or_at(m.program[arg].span))?;
        }
        Ok(Value::Unset)
    }

    /// `isset(a)`.
    pub(crate) fn is_set(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let place = self.place(call.m, call.first())?;
        let (_, value, known) = self.known(&place)?;
        let set = match shape_of(value) {
            Some(shape) if place.path.is_empty() => {
                known.has(shape, place.section.unwrap_or(ArraySection::whole(shape)))
            }
            _ => !matches!(value, Value::Unset),
        };
        Ok(Value::Number(T::from(f64::from(u8::from(set)))))
    }

    /// `ieee()`, `ieee(0)`.
    pub(crate) fn ieee(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        self.arrays.ieee = match call.at(0) {
            Some(arg) => self.number(call.m, arg)?.re() != 0.0,
            None => true,
        };
        Ok(Value::Unset)
    }

    /// `refined(n)`.
    pub(crate) fn refined_count(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let n = self.whole(call.m, call.first())?;
        let fine = (n - 1.0) * self.parts() + 1.0;
        if self.parts() > 1.0 {
            self.refined.counts.insert(fine.to_bits(), n);
        }
        Ok(Value::Number(T::from(fine)))
    }

    /// `refined_step(ds)`.
    pub(crate) fn refined_step(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let step = self.number(call.m, call.first())?;
        let fine = step / self.parts();
        if self.parts() > 1.0 {
            self.refined.steps.insert(fine.re().to_bits(), step);
        }
        Ok(Value::Number(fine))
    }

    /// `refinement()`.
    pub(crate) fn refinement(&mut self, _: &RunCall<'_>) -> Evaluated<T> {
        Ok(Value::Number(T::from(self.parts())))
    }

    fn parts(&self) -> f64 {
        f64::from(1u32 << self.inputs.settings.refine)
    }

    /// An integer of at least 1.
    pub fn whole(&mut self, m: &Module, arg: ExprId) -> Result<f64, Diagnostic> {
        let n = self.number(m, arg)?.re();
        if n.fract() == 0.0 && (1.0..=1e9).contains(&n) {
            return Ok(n);
        }
        Err(Diagnostic::error("not-whole", "the number of points must be a whole number")
            .at(m.program[arg].span)
            .expected("a whole number of at least 1")
            .found(n.to_string()))
    }

    pub fn text(&mut self, m: &Module, arg: ExprId) -> Result<Arc<str>, Diagnostic> {
        match self.operand(m, arg)? {
            Value::Text(text) => Ok(text),
            other => Err(Diagnostic::error("wrong-type", "expected a text")
                .at(m.program[arg].span)
                .expected("a text")
                .found(other.called())),
        }
    }

    fn unit(&mut self, m: &Module, arg: ExprId) -> Result<u32, Diagnostic> {
        let span = m.program[arg].span;
        let unit = self.number(m, arg)?.re();
        if unit.fract() == 0.0 && (0.0..1e6).contains(&unit) {
            return Ok(unit as u32);
        }
        Err(Diagnostic::error("not-open", "this is not a file")
            .at(span)
            .expected("a file that open() gave, or a unit number")
            .found(unit.to_string()))
    }

    /// `open("name", "w")`, `open(7, "name")`, `open(7, "name", "r")`.
    pub(crate) fn open_file(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let m = call.m;
        let unit_first = matches!(self.operand(m, call.first())?, Value::Number(_));
        let places = if unit_first { [1, 2, 0] } else { [0, 1, 2] };
        let [name, mode, unit] = places.map(|field| call.at(field));
        let Some(name) = name else {
            return Err(Diagnostic::error("missing-argument", "open needs the name of a file")
                .expected("open(\"name\", \"w\") or open(7, \"name\")"));
        };
        let unit = unit.map(|unit| self.unit(m, unit)).transpose()?;
        let path = self.text(m, name)?;
        let mode = match mode {
            Some(mode) => {
                let word = self.text(m, mode)?;
                OpenMode::parse(&word).map_err(|d| d.or_at(m.program[mode].span))?
            }
            None if unit_first => OpenMode::Write,
            None => OpenMode::Read,
        };
        if mode != OpenMode::Read && self.run.extent() == Extent::Edit {
            return Err(Diagnostic::error(
                "misplaced-assignment",
                "a queried expression cannot write files",
            )
            .expected("an expression that reads the program's variables"));
        }
        let from = self.modules.get(0).path.clone();
        let world = self.loader.world;
        let unit = self
            .env
            .files
            .open(world, &from, &path, mode, unit)
            .map_err(|d| d.or_at(m.program[name].span))?;
        Ok(Value::Number(T::from(f64::from(unit))))
    }

    /// Type, value and initialised elements of a variable.
    fn known(
        &self,
        place: &Place,
    ) -> Result<(Type, &Value<T>, &crate::value::initialised::Known), Diagnostic> {
        match self.env.scope.root(place).map(|b| &b.what) {
            Some(Binding::Variable { ty, value, known, .. }) => {
                let within = variables::inside(value, &place.path).ok_or_else(silent)?;
                let ty = if place.path.is_empty() { *ty } else { variables::type_of(within) };
                Ok((ty, within, known))
            }
            Some(Binding::Poisoned) | None => Err(silent()),
            _ => Err(Diagnostic::error("not-assignable", "this is not a variable")
                .expected("a variable, or a part of one")
                .found("an object or parameter")),
        }
    }

    /// As many numbers as the variable can hold.
    fn read_place(&mut self, unit: u32, place: &Place) -> Evaluated<T> {
        let (ty, value, _) = self.known(place)?;
        if ty == Type::String {
            return self.env.files.line(unit).map(|line| Value::text(&line));
        }
        let section =
            |shape: ArrayShape| place.section.unwrap_or(ArraySection::whole(shape)).shape();
        let vectors = matches!(value, Value::Vectors(_) | Value::Vector(_));
        let vectors = vectors && place.component.is_none();
        let shape = match shape_of(value) {
            Some(shape) => section(shape),
            None if matches!(value, Value::Number(_) | Value::Vector(_)) => None,
            None => {
                return Err(Diagnostic::error(
                    "no-shape",
                    "the number of values to read is unknown",
                )
                .help("declare the dimensions of the array first"));
            }
        };
        let count = shape.map_or(1, ArrayShape::count);
        let files = &mut self.env.files;
        let mut number = || files.number(unit).map(T::from);
        // Files store grids with the first index fastest.
        let order: Vec<usize> = match shape {
            Some(ArrayShape::Grid(a, b)) => {
                (0..b).flat_map(|j| (0..a).map(move |i| i * b + j)).collect()
            }
            _ => (0..count).collect(),
        };
        if !vectors {
            let mut items = vec![T::zero(); count];
            for k in order {
                items[k] = number()?;
            }
            return Ok(match shape {
                Some(shape) => Value::Numbers(Arc::new(Array { shape, items })),
                None => Value::Number(items[0]),
            });
        }
        let mut items = vec![Vec3::zero(); count];
        for k in order {
            items[k] = Vec3::new(number()?, number()?, number()?);
        }
        Ok(match shape {
            Some(shape) => Value::Vectors(Arc::new(Vectors::new(shape, items))),
            None => Value::Vector(items[0]),
        })
    }

    /// `count(c)`, `next(c)`, `more(c)`, `rewind(c)`.
    pub(crate) fn sequence(&mut self, call: &RunCall<'_>, to: SequenceUse) -> Evaluated<T> {
        let (m, arg) = (call.m, call.first());
        let name = m.program.as_name(arg).map(|symbol| m.names[symbol.0 as usize]);
        let multiple = name.and_then(|name| match &self.env.scope.lookup(name)?.what {
            Binding::Multiple(multiple) => Some((name, multiple.items.len(), multiple.read)),
            _ => None,
        });
        let flag = |holds: bool| Value::Number(T::from(f64::from(u8::from(holds))));
        let Some((name, all, read)) = multiple else {
            if to == SequenceUse::Count {
                let value = self.operand(m, arg)?;
                match &*moldloft_arrays::gathered(&value) {
                    Value::Numbers(a) => {
                        let held = a.items.iter().filter(|x| x.re() != 0.0).count();
                        return Ok(Value::Number(T::from(held as f64)));
                    }
                    Value::List(items) => return Ok(Value::Number(T::from(items.len() as f64))),
                    _ => {}
                }
            }
            if matches!(to, SequenceUse::Count | SequenceUse::Next) {
                return Err(Diagnostic::error(
                    "wrong-type",
                    format!("{} reads a multiple argument", call.row.name),
                )
                .at(m.program[arg].span)
                .expected("the last argument of a subroutine, declared as `curve c...`"));
            }
            let unit = self.unit(m, arg)?;
            return match to {
                SequenceUse::More => self.env.files.more(unit).map(flag),
                _ => self.env.files.rewind(unit).map(|()| Value::Unset),
            };
        };
        match to {
            SequenceUse::Count => Ok(Value::Number(T::from(all as f64))),
            SequenceUse::More => Ok(flag(read < all)),
            SequenceUse::Rewind => {
                self.set_read(name, 0);
                Ok(Value::Unset)
            }
            _ => {
                let text = self.modules.text(name).clone();
                let Some(Binding::Multiple(multiple)) =
                    self.env.scope.lookup(name).map(|b| &b.what)
                else {
                    return Err(silent());
                };
                let Some(item) = multiple.items.get(read) else {
                    return Err(Diagnostic::error(
                        "outside",
                        format!("all arguments of `{text}` were read"),
                    )
                    .expected(format!("at most {all} calls of next"))
                    .help(format!("test more({text}) first, or start over with rewind({text})")));
                };
                let item: Passed<T> = item.clone();
                self.set_read(name, read + 1);
                self.passed(&item)
            }
        }
    }

    fn set_read(&mut self, name: crate::source::module::Name, read: usize) {
        let frame = self.env.scope.frame_mut();
        let local = frame.locals.iter_mut().find(|(n, _)| *n == name);
        if let Some(Binding::Multiple(multiple)) = local.map(|(_, b)| &mut b.what) {
            multiple.read = read;
        }
    }

    /// That the edges of a surface are there and meet at its corners.
    pub(crate) fn check_edges(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let place = self.place(call.m, call.first())?;
        let tolerance = self.run.graph().context().tolerance;
        let (_, value, known) = self.known(&place)?;
        let name = self.modules.text(place.name);
        let Some(shape @ ArrayShape::Grid(..)) = shape_of(value) else {
            return Err(Diagnostic::error("wrong-type", "expected a surface")
                .expected("a surface (a grid of vectors)")
                .found(value.called()));
        };
        let whole = place.section.unwrap_or(ArraySection::whole(shape));
        let ArraySection::Grid(a, b) = whole else { return Err(silent()) };
        let end = |s: crate::value::subarray::Selection, last: bool| {
            crate::value::subarray::Selection::at(s.position(if last { s.count - 1 } else { 0 }))
        };
        let edges = [
            ("i = 1", ArraySection::Grid(end(a, false), b)),
            ("i = d1", ArraySection::Grid(end(a, true), b)),
            ("j = 1", ArraySection::Grid(a, end(b, false))),
            ("j = d2", ArraySection::Grid(a, end(b, true))),
        ];
        for (edge, section) in edges {
            if let Some(at) = known.first_missing(shape, section) {
                let at: Vec<String> = at.iter().map(usize::to_string).collect();
                let message =
                    format!("the edge {edge} of `{name}` is not set: {name}[{}]", at.join(","));
                return Err(Diagnostic::error("edge-not-set", message)
                    .expected("all four edges set before the interior")
                    .found(format!("no value at [{}]", at.join(",")))
                    .help(format!("assign {name}[1,], {name}[{name}.d1,], {name}[,1] and {name}[,{name}.d2] first")));
            }
        }
        if place.section.is_none()
            && let ArrayShape::Grid(rows, columns) = shape
            && let Some(gap) = known.widest_gap([rows, columns])
        {
            let [(one, p), (other, q)] = &gap.edges;
            let wide = p.distance(*q);
            if wide > tolerance {
                let [i, j] = gap.corner;
                let point = |p: &Vec3| crate::value::display::plain(&Value::<f64>::Vector(*p));
                let message = format!(
                    "the edges {one} and {other} of `{name}` do not meet at corner [{i},{j}]: the \
                     gap is {}",
                    number::plain(wide)
                );
                return Err(Diagnostic::error("edges-do-not-meet", message)
                    .expected(format!("ends within {tolerance} of each other"))
                    .found(format!("{} on {one} and {} on {other}", point(p), point(q)))
                    .help("move the end of one edge to the other's before filling"));
            }
        }
        Ok(Value::Unset)
    }
}

fn shape_of<T: Real>(value: &Value<T>) -> Option<ArrayShape> {
    match value {
        Value::Numbers(a) => Some(a.shape),
        Value::Vectors(a) => Some(a.shape),
        _ => None,
    }
}

fn unwritable<T: Real>(value: &Value<T>) -> Diagnostic {
    let found = value.called();
    Diagnostic::error("wrong-type", format!("{found} cannot be written"))
        .expected("numbers, texts, vectors and arrays")
        .found(found)
}

/// The numbers and texts of a value one by one.
fn flatten<T: Real>(value: &Value<T>, out: &mut Vec<FormatArgument>) -> Result<(), Diagnostic> {
    let number = |x: T| FormatArgument::Number(x.re() + 0.0);
    match value {
        Value::Number(x) => out.push(number(*x)),
        Value::Text(text) => out.push(FormatArgument::Text(text.clone())),
        Value::Vector(v) => out.extend(v.to_array().map(number)),
        Value::Point(p) => out.extend(p.xyz.to_array().map(number)),
        Value::Numbers(a) => out.extend(a.items.iter().map(|&x| number(x))),
        Value::Vectors(a) => out.extend(a.iter().flat_map(|v| v.to_array().map(number))),
        Value::List(items) | Value::Block(items) => {
            for item in items.iter() {
                flatten(item, out)?;
            }
        }
        other => return Err(unwritable(other)),
    }
    Ok(())
}

/// The value as lines of a file.
fn lines<T: Real>(value: &Value<T>, out: &mut String) -> Result<(), Diagnostic> {
    let spell = |x: T| number::plain(x.re() + 0.0);
    let point = |v: Vec3<T>, out: &mut String| {
        let _ = writeln!(out, "{} {} {}", spell(v.x), spell(v.y), spell(v.z));
    };
    // The first index fastest.
    let order = |shape: ArrayShape| -> Vec<usize> {
        match shape {
            ArrayShape::Row(n) => (0..n).collect(),
            ArrayShape::Grid(m, n) => (0..n).flat_map(|j| (0..m).map(move |i| i * n + j)).collect(),
        }
    };
    match value {
        Value::Number(x) => {
            let _ = writeln!(out, "{}", spell(*x));
        }
        Value::Text(text) => {
            let _ = writeln!(out, "{text}");
        }
        Value::Vector(v) => point(*v, out),
        Value::Point(p) => point(p.xyz, out),
        Value::Numbers(a) => {
            for k in order(a.shape) {
                let _ = writeln!(out, "{}", spell(a.items[k]));
            }
        }
        Value::Vectors(a) => order(a.shape).into_iter().for_each(|k| point(a.at(k), out)),
        Value::List(items) | Value::Block(items) => {
            for item in items.iter() {
                lines(item, out)?;
            }
        }
        other => return Err(unwritable(other)),
    }
    Ok(())
}
