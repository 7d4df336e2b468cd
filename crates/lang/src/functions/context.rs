//! Functions that need more than the values of their arguments: the place that an argument is, the
//! files of the run, how fine it is asked for.

use crate::functions::files::{OpenMode, STANDARD_OUTPUT};
use crate::functions::format::{self, FormatArgument};
use crate::functions::grid_files::{GridFormat, RowFormat};
use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::source::scope::{Binding, Passed};
use crate::value::subarray::{ArraySection, Place};
use crate::value::variables::Called as _;
use moldloft_diag::{Diagnostic, Span};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Row, Scalar, Value, Vectors};
use moldloft_syntax::number;
use moldloft_syntax::sdl::{Arg, ExprId, NodeList, Symbol, Type};
use std::fmt::Write;
use std::sync::Arc;

/// The finest grids: intervals halved that many times.
pub const MOST_REFINED: u32 = 8;

/// A built-in function, as the reference and the editor show it.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name.
    pub name: &'static str,
    /// How many arguments it takes, at least and at most.
    pub(crate) arguments: (usize, usize),
    /// What a call does.
    pub(crate) action: Action,
    /// Its arguments.
    pub signature: &'static str,
    /// What it does, in one line.
    pub doc: &'static str,
    /// A program that calls it and runs by itself.
    pub example: &'static str,
}

/// What the call of a built-in function does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Format,
    Open,
    Close,
    Write,
    Read,
    More,
    Next,
    Rewind,
    Count,
    IsSet,
    Ieee,
    CheckEdges,
    Refined,
    RefinedStep,
    Refinement,
    WriteGrids(GridFormat),
    ReadPlot3d,
    ReadRows(RowFormat),
}

/// All built-in functions, in the order of the reference.
pub const BUILTINS: [Builtin; 23] = [
    Builtin {
        name: "format",
        arguments: (1, usize::MAX),
        action: Action::Format,
        signature: "format(pattern, ...)",
        doc: "Formats numbers by C directives; the pattern repeats for the remaining values.",
        example: "assert format(\"%6.2f|%d\", 2.5, 3) == \"  2.50|3\";",
    },
    Builtin {
        name: "open",
        arguments: (1, 3),
        action: Action::Open,
        signature: "open(name, mode)",
        doc: "Opens a text file to read (\"r\"), write (\"w\") or append (\"a\"); open(7, name) chooses the unit.",
        example: "file f = open(\"a.txt\", \"w\"); write(f, 1, {2, 3, 4}); close(f);",
    },
    Builtin {
        name: "close",
        arguments: (1, 1),
        action: Action::Close,
        signature: "close(f)",
        doc: "Closes a file.",
        example: "open(7, \"a.txt\"); close(7);",
    },
    Builtin {
        name: "write",
        arguments: (1, usize::MAX),
        action: Action::Write,
        signature: "write(f, ...)",
        doc: "Writes values to a file: a point or number on each line, the first index of a grid fastest.",
        example: "write(stdout, \"two points\", {{1, 2, 3}, {4, 5, 6}});",
    },
    Builtin {
        name: "read",
        arguments: (1, usize::MAX),
        action: Action::Read,
        signature: "read(f, ...)",
        doc: "Reads numbers into variables or parts of them; a string takes the rest of the line.",
        example: "open(7, \"a.txt\"); write(7, {1, 2, 3}); close(7); file f = open(\"a.txt\", \"r\"); vector v; read(f, v); assert v.z == 3;",
    },
    Builtin {
        name: "more",
        arguments: (1, 1),
        action: Action::More,
        signature: "more(c)",
        doc: "Reports whether a multiple argument, or a file, has unread items.",
        example: "function float total(float x...) { float s = 0; while (more(x)) s += next(x); return s; } assert total(1, 2) == 3;",
    },
    Builtin {
        name: "next",
        arguments: (1, 1),
        action: Action::Next,
        signature: "next(c)",
        doc: "The next item of a multiple argument.",
        example: "function float second(float x...) { next(x); return next(x); } assert second(1, 2) == 2;",
    },
    Builtin {
        name: "rewind",
        arguments: (1, 1),
        action: Action::Rewind,
        signature: "rewind(c)",
        doc: "Returns to the first item of a multiple argument, or to the start of a file.",
        example: "function float first(float x...) { next(x); rewind(x); return next(x); } assert first(1, 2) == 1;",
    },
    Builtin {
        name: "count",
        arguments: (1, 1),
        action: Action::Count,
        signature: "count(c)",
        doc: "The number of items of a multiple argument or a list; of a mask, the number of elements where it holds.",
        example: "function float n(float x...) { return count(x); } assert n(5, 6, 7) == 3;",
    },
    Builtin {
        name: "isset",
        arguments: (1, 1),
        action: Action::IsSet,
        signature: "isset(a[i])",
        doc: "Reports whether a variable, or every element of a section, has a value.",
        example: "curve c[3]; c[1:2] = {0, 0, 0}; assert isset(c[2]) and not isset(c);",
    },
    Builtin {
        name: "ieee",
        arguments: (0, 1),
        action: Action::Ieee,
        signature: "ieee(on)",
        doc: "Lets infinite results and NaN pass from here on, such as that of 1/0, or with 0 makes them errors again.",
        example: "ieee(); float a = 1/0; assert a > 1e308; ieee(0);",
    },
    Builtin {
        name: "check_edges",
        arguments: (1, 1),
        action: Action::CheckEdges,
        signature: "check_edges(s)",
        doc: "Stops with location and gap when the four edges of a surface are not set or do not meet.",
        example: "surface s[3,3] = {0, 0, 0}; check_edges(s);",
    },
    Builtin {
        name: "refined",
        arguments: (1, 1),
        action: Action::Refined,
        signature: "refined(n)",
        doc: "n points, or more when the run is refined: intervals are halved, so that coarse points recur.",
        example: "farray s = uniform(0, 1, refined(5));",
    },
    Builtin {
        name: "refined_step",
        arguments: (1, 1),
        action: Action::RefinedStep,
        signature: "refined_step(ds)",
        doc: "A step per index consistent with refined(n): halved at each refinement.",
        example: "farray s = d_tanh(0, 1, refined_step(.01), 0, refined(25));",
    },
    Builtin {
        name: "refinement",
        arguments: (0, 0),
        action: Action::Refinement,
        signature: "refinement()",
        doc: "The number of parts of each interval of refined(n): 1, 2, 4, ...",
        example: "assert refinement() >= 1;",
    },
    Builtin {
        name: "write_p3d",
        arguments: (2, usize::MAX),
        action: Action::WriteGrids(GridFormat::Plot3d),
        signature: "write_p3d(name, words, s1, s2, ...)",
        doc: "Writes surfaces as a Plot3D file: stream, records or text; single; single-block; 2d; planes; big; iblank; mark8.",
        example: "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", \"records single\", s); surface t = read_p3d(\"s.x\"); assert t.d1 == 3;",
    },
    Builtin {
        name: "write_vts",
        arguments: (2, usize::MAX),
        action: Action::WriteGrids(GridFormat::Vts),
        signature: "write_vts(name, s1, s2, ...)",
        doc: "Writes surfaces as VTK structured grids: one .vts, or several with their .vtm.",
        example: "surface s[3,2] = {1, 2, 3}; write_vts(\"s.vts\", s);",
    },
    Builtin {
        name: "write_stl",
        arguments: (2, usize::MAX),
        action: Action::WriteGrids(GridFormat::Stl),
        signature: "write_stl(name, words, s1, s2, ...)",
        doc: "Writes surfaces as binary STL, triangles without area at poles left out; \"flip\" reverses the normals.",
        example: "surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; write_stl(\"s.stl\", s);",
    },
    Builtin {
        name: "write_cgns",
        arguments: (2, usize::MAX),
        action: Action::WriteGrids(GridFormat::Cgns),
        signature: "write_cgns(name, s1, s2, ...)",
        doc: "Writes surfaces as structured CGNS zones with the interfaces where their edges have the same points.",
        example: "surface s[3,2] = {1, 2, 3}; write_cgns(\"s.cgns\", s);",
    },
    Builtin {
        name: "write_csv",
        arguments: (2, usize::MAX),
        action: Action::WriteGrids(GridFormat::Csv),
        signature: "write_csv(name, c1, c2, ...)",
        doc: "Writes points as lines of x,y,z under a heading, with all digits.",
        example: "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); assert read_points(\"c.csv\")[2] . {1, 0, 0} == 1;",
    },
    Builtin {
        name: "read_p3d",
        arguments: (1, 2),
        action: Action::ReadPlot3d,
        signature: "read_p3d(name, block)",
        doc: "A surface of a Plot3D file of any variant, by the number of its block (1).",
        example: "surface s[3,2] = {1, 2, 3}; write_p3d(\"s.x\", s); assert read_p3d(\"s.x\", 1).d2 == 2;",
    },
    Builtin {
        name: "read_points",
        arguments: (1, 1),
        action: Action::ReadRows(RowFormat::Points),
        signature: "read_points(name)",
        doc: "The points of a text with two or three numbers to a line, as a curve.",
        example: "curve c[2] = {1, 2, 3}; write_csv(\"c.csv\", c); curve d = read_points(\"c.csv\");",
    },
    Builtin {
        name: "read_aerofoil",
        arguments: (1, 1),
        action: Action::ReadRows(RowFormat::Aerofoil),
        signature: "read_aerofoil(name)",
        doc: "A section of a coordinate file in Selig's or Lednicer's listing: tail, upper side, nose, lower side, tail.",
        example: "file f = open(\"a.dat\", \"w\"); write(f, \"a wedge\"); for (x = 1:0:-.25) write(f, format(\"%g %g\", x, .1*x)); for (x = .25:1:.25) write(f, format(\"%g %g\", x, -.1*x)); close(f); assert read_aerofoil(\"a.dat\").d1 == 9;",
    },
];

type Evaluated<T> = Result<Value<T>, Diagnostic>;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The row of a function called with so many arguments; that of `makecc` for its misprint of 1992.
    pub fn row(
        &mut self,
        m: &Module,
        symbol: Symbol,
        count: usize,
        span: Span,
    ) -> Option<Arc<Row>> {
        // Without a parameter it is asked of the points of an array.
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

    /// The value of a call of a built-in function; `None` when the name means none.
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
        if let Some(named) = m.program[args].iter().find_map(|a| a.name) {
            let message = format!("{} takes no named arguments", builtin.name);
            return Err(Diagnostic::error("unknown-argument", message)
                .at(named.span)
                .expected(builtin.signature));
        }
        let given: Vec<ExprId> = m.program[args].iter().map(|a| a.value).collect();
        let (least, most) = builtin.arguments;
        if !(least..=most).contains(&given.len()) {
            let id = if given.len() < least { "missing-argument" } else { "too-many-arguments" };
            let message = format!("invalid arguments of {}", builtin.name);
            return Err(Diagnostic::error(id, message)
                .at(span)
                .expected(builtin.signature)
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
                    Some(shape) => {
                        known.has(shape, place.section.unwrap_or(ArraySection::whole(shape)))
                    }
                    None => !matches!(value, Value::Unset),
                };
                Ok(Value::Number(T::from(f64::from(u8::from(set)))))
            }
            Action::Ieee => {
                let on = match given.first() {
                    Some(&arg) => self.number(m, arg)?.re() != 0.0,
                    None => true,
                };
                if std::mem::replace(&mut self.arrays.ieee, on) != on {
                    // Their tapes test, or do not test, what they compute.
                    self.arrays.recipes.clear();
                }
                Ok(Value::Unset)
            }
            Action::CheckEdges => self.check_edges(m, given[0]).map(|()| Value::Unset),
            Action::Refined => {
                let n = self.whole(m, given[0])?;
                let fine = (n - 1.0) * self.parts() + 1.0;
                Ok(Value::Number(T::from(fine)))
            }
            Action::RefinedStep => {
                let step = self.number(m, given[0])?;
                Ok(Value::Number(step / self.parts()))
            }
            Action::Refinement => Ok(Value::Number(T::from(self.parts()))),
            Action::WriteGrids(format) => {
                self.write_grids(m, (builtin.name, format), &given).map(|()| Value::Unset)
            }
            Action::ReadPlot3d => self.read_p3d(m, &given),
            Action::ReadRows(format) => self.read_rows(m, format, &given),
        }
    }

    fn parts(&self) -> f64 {
        f64::from(1u32 << self.inputs.settings.refine)
    }

    /// A whole number of at least 1.
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
            _ => (None, given),
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

    /// What a variable is and what is known of it.
    fn known(
        &self,
        place: &Place,
    ) -> Result<(Type, &Value<T>, &crate::value::initialised::Known), Diagnostic> {
        match self.env.scope.root(place).map(|b| &b.what) {
            Some(Binding::Variable { ty, value, known, .. }) => Ok((*ty, value, known)),
            Some(Binding::Poisoned) | None => Err(silent()),
            _ => Err(Diagnostic::error("not-assignable", "this is not a variable")
                .expected("a variable, or a part of one")
                .found("an object or parameter")),
        }
    }

    /// As many numbers as the place holds.
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
        // Grids stand in files with their first index fastest.
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
            if builtin.action == Action::Count {
                let value = self.operand(m, arg)?;
                match &*crate::value::ops::gathered(&value) {
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
        Value::List(items) => {
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
        Value::List(items) => {
            for item in items.iter() {
                lines(item, out)?;
            }
        }
        other => return Err(unwritable(other)),
    }
    Ok(())
}
