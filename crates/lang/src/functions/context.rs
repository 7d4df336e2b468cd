//! Functions that need more than the values of their arguments: the variable behind an argument,
//! the files of the run, the requested refinement.

use crate::functions::builtins::{Action, BUILTINS, Builtin};
use crate::functions::files::{OpenMode, STANDARD_OUTPUT};
use crate::functions::format::{self, FormatArgument};
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
use moldloft_syntax::sdl::{Arg, ExprId, NodeList, Symbol, Type};
use std::fmt::Write;
use std::sync::Arc;

type Evaluated<T> = Result<Value<T>, Diagnostic>;

/// The arguments of a call in the order of the function's: positional ones, then those by name.
fn in_order(m: &Module, builtin: &Builtin, args: NodeList<Arg>) -> Result<Vec<ExprId>, Diagnostic> {
    let mut given: Vec<ExprId> = Vec::new();
    let names: Vec<&str> = builtin.argument_names().collect();
    for arg in &m.program[args] {
        let Some(ident) = arg.name else {
            given.push(arg.value);
            continue;
        };
        let word = m.program.name(ident.symbol);
        let fault = |id: &'static str, message: String| {
            Diagnostic::error(id, message).at(ident.span).expected(builtin.signature())
        };
        match names.iter().position(|name| *name == word) {
            Some(at) if at == given.len() => given.push(arg.value),
            Some(at) if at < given.len() => {
                let message = format!("`{word}` of {} is given twice", builtin.name);
                return Err(fault("argument-twice", message));
            }
            Some(_) => {
                let before = names[given.len()];
                let message = format!("{} needs `{before}` before `{word}`", builtin.name);
                return Err(fault("missing-argument", message));
            }
            None => {
                let message = format!("{} has no argument `{word}`", builtin.name);
                return Err(fault("unknown-argument", message).suggest(word, names));
            }
        }
    }
    Ok(given)
}

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

    /// The value of a call of a built-in function; `None` for other names.
    pub fn builtin(
        &mut self,
        m: &Module,
        symbol: Symbol,
        args: NodeList<Arg>,
        span: Span,
    ) -> Option<Evaluated<T>> {
        let name = m.program.name(symbol);
        let builtin = BUILTINS.iter().find(|b| b.name == name)?;
        Some(self.builtin_of(m, builtin, args, span).map_err(|d| d.or_at(span)))
    }

    fn builtin_of(
        &mut self,
        m: &Module,
        builtin: &Builtin,
        args: NodeList<Arg>,
        span: Span,
    ) -> Evaluated<T> {
        let given = in_order(m, builtin, args)?;
        let (least, most) = builtin.arity();
        if !(least..=most).contains(&given.len()) {
            let id = if given.len() < least { "missing-argument" } else { "too-many-arguments" };
            let message = format!("invalid arguments of {}", builtin.name);
            return Err(Diagnostic::error(id, message)
                .at(span)
                .expected(builtin.signature())
                .found(format!("{} arguments", given.len())));
        }
        match builtin.action {
            Action::Format => {
                let pattern = self.text(m, given[0])?;
                let mut items = Vec::new();
                for &arg in &given[1..] {
                    let value = self.operand(m, arg)?;
                    flatten(&value, &mut items).map_err(|d| d.or_at(m.program[arg].span))?;
                }
                format::format(&pattern, &items).map(|text| Value::text(&text))
            }
            Action::Open => self.open(m, &given),
            Action::Close => {
                let unit = self.unit(m, given[0])?;
                self.env.files.close(unit).map(|()| Value::Unset)
            }
            Action::Write => {
                let unit = self.unit(m, given[0])?;
                let mut text = String::new();
                for &arg in &given[1..] {
                    let value = self.operand(m, arg)?;
                    lines(&value, &mut text).map_err(|d| d.or_at(m.program[arg].span))?;
                    self.charge(&value, m.program[arg].span)?;
                }
                if unit == STANDARD_OUTPUT || unit == 0 {
                    for line in text.lines() {
                        self.print(line.to_string(), span)?;
                    }
                    return Ok(Value::Unset);
                }
                self.env.files.write(unit, &text).map(|()| Value::Unset)
            }
            Action::Read => {
                let unit = self.unit(m, given[0])?;
                for &arg in &given[1..] {
                    let place = self.place(m, arg)?;
                    let value = self.read_place(unit, &place)?;
                    self.charge(&value, m.program[arg].span)?;
                    self.store(place, value).map_err(|d| d.or_at(m.program[arg].span))?;
                }
                Ok(Value::Unset)
            }
            Action::More | Action::Next | Action::Rewind | Action::Count => {
                self.sequence(m, builtin, given[0])
            }
            Action::IsSet => {
                let place = self.place(m, given[0])?;
                let (_, value, known) = self.known(&place)?;
                let set = match shape_of(value) {
                    Some(shape) if place.path.is_empty() => {
                        known.has(shape, place.section.unwrap_or(ArraySection::whole(shape)))
                    }
                    _ => !matches!(value, Value::Unset),
                };
                Ok(Value::Number(T::from(f64::from(u8::from(set)))))
            }
            Action::Ieee => {
                self.arrays.ieee = match given.first() {
                    Some(&arg) => self.number(m, arg)?.re() != 0.0,
                    None => true,
                };
                Ok(Value::Unset)
            }
            Action::CheckEdges => self.check_edges(m, given[0]).map(|()| Value::Unset),
            Action::Refined => {
                let n = self.whole(m, given[0])?;
                let fine = (n - 1.0) * self.parts() + 1.0;
                if self.parts() > 1.0 {
                    self.refined.counts.insert(fine.to_bits(), n);
                }
                Ok(Value::Number(T::from(fine)))
            }
            Action::RefinedStep => {
                let step = self.number(m, given[0])?;
                let fine = step / self.parts();
                if self.parts() > 1.0 {
                    self.refined.steps.insert(fine.re().to_bits(), step);
                }
                Ok(Value::Number(fine))
            }
            Action::Refinement => Ok(Value::Number(T::from(self.parts()))),
            Action::WriteGrids(format) => {
                self.write_grids(m, (builtin.name, format), &given).map(|()| Value::Unset)
            }
            Action::Interfaces => self.interfaces(m, builtin.name, &given),
            Action::ReadPlot3d => self.read_p3d(m, &given),
            Action::BlankingPlot3d => self.iblank_p3d(m, &given),
            Action::CountPlot3d => self.count_p3d(m, given[0]),
            Action::ReadCgns => self.read_cgns(m, &given),
            Action::CountCgns => self.count_cgns(m, given[0]),
            Action::NamesCgns => self.names_cgns(m, given[0]),
            Action::ReadRows(format) => self.read_rows(m, format, &given),
        }
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
    fn open(&mut self, m: &Module, given: &[ExprId]) -> Evaluated<T> {
        let first = self.operand(m, given[0])?;
        let (unit, rest) = match first {
            Value::Number(_) => (Some(self.unit(m, given[0])?), &given[1..]),
            _ => match given {
                &[_, _, unit] => (Some(self.unit(m, unit)?), &given[..2]),
                _ => (None, given),
            },
        };
        let (Some(&name), true) = (rest.first(), rest.len() <= 2) else {
            return Err(Diagnostic::error("missing-argument", "open needs the name of a file")
                .expected("open(\"name\", \"w\") or open(7, \"name\")"));
        };
        let path = self.text(m, name)?;
        let mode = match rest.get(1) {
            Some(&mode) => {
                let word = self.text(m, mode)?;
                OpenMode::parse(&word).map_err(|d| d.or_at(m.program[mode].span))?
            }
            None if unit.is_some() => OpenMode::Write,
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
    fn sequence(&mut self, m: &Module, builtin: &Builtin, arg: ExprId) -> Evaluated<T> {
        let name = m.program.as_name(arg).map(|symbol| m.names[symbol.0 as usize]);
        let multiple = name.and_then(|name| match &self.env.scope.lookup(name)?.what {
            Binding::Multiple(multiple) => Some((name, multiple.items.len(), multiple.read)),
            _ => None,
        });
        let flag = |holds: bool| Value::Number(T::from(f64::from(u8::from(holds))));
        let Some((name, all, read)) = multiple else {
            if matches!(builtin.action, Action::Count) {
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
            if matches!(builtin.action, Action::Count | Action::Next) {
                return Err(Diagnostic::error(
                    "wrong-type",
                    format!("{} reads a multiple argument", builtin.name),
                )
                .at(m.program[arg].span)
                .expected("the last argument of a subroutine, declared as `curve c...`"));
            }
            let unit = self.unit(m, arg)?;
            return match builtin.action {
                Action::More => self.env.files.more(unit).map(flag),
                _ => self.env.files.rewind(unit).map(|()| Value::Unset),
            };
        };
        match builtin.action {
            Action::Count => Ok(Value::Number(T::from(all as f64))),
            Action::More => Ok(flag(read < all)),
            Action::Rewind => {
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
    fn check_edges(&mut self, m: &Module, arg: ExprId) -> Result<(), Diagnostic> {
        let place = self.place(m, arg)?;
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
        Ok(())
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
        Value::Text(text) => out.push(FormatArgument::Text(text.to_string())),
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
