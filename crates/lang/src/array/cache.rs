//! Expressions that are executed again.
//!
//! `second execution -> recipe -> later executions`
//!
//! The first execution of an element-wise expression walks through its tree. The second does so, too, and
//! records what it finds: which parts of the expression are read from variables and calls (leaves),
//! what is computed of those that are no arrays, and the tape. Later executions read the leaves, in the same
//! order, and run the tape, as long as kinds and shapes are those of the recording. Whatever differs
//! (another shape, another exponent, a fault) sends the leaves that were read already through the tree, so
//! that a recipe changes no value and no message, and nothing is read twice.

use crate::array::lower::{Lanes, Work, not_finite};
use crate::functions::elementary::{self, Elementary};
use crate::run::interpreter::{DEEPEST, Interpreter};
use crate::source::env::Binding;
use crate::source::module::Module;
use crate::value::ops;
use crate::value::variables;
use moldloft_diag::Diagnostic;
use moldloft_elementwise::{Cell, Origin, Tape};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Scalar, Value};
use moldloft_syntax::sdl::{BinaryOp, ExprId, ExprKind, Subscript, Symbol};
use smallvec::SmallVec;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};
use std::sync::Arc;

/// So many recipes that did not fit, and the expression is not recorded again.
const MOST_MISFITS: u8 = 4;

/// The most entries of a recipe.
const LONGEST: usize = 1_000;

/// What is known of an expression that is executed again and again.
#[derive(Debug)]
pub(crate) enum Slot<T: Real> {
    /// Executed once, or a recipe did not fit so many times.
    Seen(u8),
    Kept(Box<Recipe<T>>),
    /// Under way.
    Busy,
    /// Not worth it, or not possible.
    Never,
}

/// Slots by expression.
pub(crate) type Slots<T> = HashMap<Key, Slot<T>, BuildHasherDefault<Mixed>>;

/// An expression of all files of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Key(u64);

impl Key {
    pub fn of(m: &Module, expr: ExprId) -> Self {
        Self(u64::from(m.program.file().0) << 32 | u64::from(expr.0))
    }
}

impl Hash for Key {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        hasher.write_u64(self.0);
    }
}

/// Scalar statements look here each time, so the hash is the shortest that spreads such keys.
#[derive(Default)]
pub(crate) struct Mixed(u64);

impl Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }
    fn write_u64(&mut self, x: u64) {
        // 2^64 over the golden ratio (Knuth, volume 3, section 6.4).
        self.0 = (self.0 ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32);
    }
}

/// What a leaf must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Number,
    Vector,
    Point,
    Numbers(ArrayShape),
    Vectors(ArrayShape),
}

impl Kind {
    /// `None` of what no tape takes.
    pub fn of<T: Real>(value: &Value<T>) -> Option<Self> {
        Some(match value {
            Value::Number(_) => Kind::Number,
            Value::Vector(_) => Kind::Vector,
            Value::Point(_) => Kind::Point,
            Value::Numbers(a) => Kind::Numbers(a.shape),
            Value::Vectors(a) => Kind::Vectors(a.shape),
            _ => return None,
        })
    }
}

/// One value of a recipe, in the order of the text.
#[derive(Clone, Copy)]
enum Entry<T> {
    Literal(T),
    /// An expression that is executed so many levels below the whole, and what comes of it read when it is
    /// an object.
    Leaf {
        expr: ExprId,
        depth: u32,
        kind: Kind,
        read: bool,
    },
    /// A variable that another leaf is, too.
    Same(Cell, ExprId),
    Binary(BinaryOp, Cell, Cell),
    Negated(Cell),
    Magnitude(Cell),
    Component(Cell, usize),
    Braces([Cell; 3]),
    Function(&'static str, Elementary<T>, [Cell; 2]),
}

/// A recording under way.
pub(crate) struct Recorder<T: Real> {
    entries: Vec<Entry<T>>,
    /// Names of the leaves that are variables.
    names: Vec<(Symbol, Cell)>,
    /// True while no leaf can change a variable.
    pure: bool,
    /// Elementary functions that were called: their names must mean nothing else.
    functions: Vec<Symbol>,
    /// Exponents that the tape depends on.
    exponents: Vec<(Cell, T)>,
    /// The nesting at the start, and the deepest since.
    base: u32,
    deepest: u32,
    /// True when something was met that no recipe takes.
    pub given_up: bool,
}

impl<T: Real> Recorder<T> {
    fn new(base: u32) -> Self {
        Self {
            entries: Vec::new(),
            names: Vec::new(),
            pure: true,
            functions: Vec::new(),
            exponents: Vec::new(),
            base,
            deepest: base,
            given_up: false,
        }
    }

    fn push(&mut self, entry: Entry<T>) -> Cell {
        if self.entries.len() >= LONGEST {
            self.given_up = true;
            return Cell::NONE;
        }
        self.entries.push(entry);
        Cell((self.entries.len() - 1) as u16)
    }

    /// Notes that something was computed of cells.
    fn computed(&mut self, of: &[Cell], entry: Entry<T>) -> Cell {
        match of.contains(&Cell::NONE) {
            true => Cell::NONE,
            false => self.push(entry),
        }
    }

    pub fn literal(&mut self, x: T) -> Cell {
        self.push(Entry::Literal(x))
    }

    /// Notes a leaf that was read at a depth; without a kind it was an object, or nothing for a tape.
    pub fn leaf(
        &mut self,
        m: &Module,
        (expr, read): (ExprId, bool),
        depth: u32,
        kind: Option<Kind>,
    ) -> Cell {
        let Some(kind) = kind else {
            self.given_up = true;
            return Cell::NONE;
        };
        self.pure &= is_pure(m, expr);
        let depth = depth - self.base;
        let Some(symbol) = m.program.as_name(expr) else {
            return self.push(Entry::Leaf { expr, depth, kind, read });
        };
        match self.names.iter().find(|(name, _)| *name == symbol) {
            Some(&(_, cell)) if self.pure => self.push(Entry::Same(cell, expr)),
            _ => {
                let cell = self.push(Entry::Leaf { expr, depth, kind, read });
                self.names.push((symbol, cell));
                cell
            }
        }
    }

    pub fn at_depth(&mut self, depth: u32) {
        self.deepest = self.deepest.max(depth);
    }

    pub fn binary(&mut self, op: BinaryOp, a: Cell, b: Cell) -> Cell {
        self.computed(&[a, b], Entry::Binary(op, a, b))
    }

    pub fn negated(&mut self, a: Cell) -> Cell {
        self.computed(&[a], Entry::Negated(a))
    }

    pub fn magnitude(&mut self, a: Cell) -> Cell {
        self.computed(&[a], Entry::Magnitude(a))
    }

    pub fn component(&mut self, a: Cell, axis: usize) -> Cell {
        self.computed(&[a], Entry::Component(a, axis))
    }

    pub fn braces(&mut self, all: [Cell; 3]) -> Cell {
        self.computed(&all, Entry::Braces(all))
    }

    pub fn called(&mut self, symbol: Symbol) {
        if !self.functions.contains(&symbol) {
            self.functions.push(symbol);
        }
    }

    pub fn function(&mut self, name: &'static str, f: Elementary<T>, args: &[Cell]) -> Cell {
        let of = [args[0], *args.last().unwrap_or(&args[0])];
        self.computed(&of, Entry::Function(name, f, of))
    }

    /// Notes that the tape depends on the exponent's value.
    pub fn exponent(&mut self, origin: Origin, x: T) {
        match self.entries.get(origin.cell.0 as usize) {
            Some(Entry::Literal(_)) => {}
            Some(_) => {
                self.exponents.push((origin.cell, x));
            }
            _ => self.given_up = true,
        }
    }
}

/// True for what reads variables and numbers only, and can change nothing.
fn is_pure(m: &Module, id: ExprId) -> bool {
    match m.program[id].kind {
        ExprKind::Name(_) | ExprKind::Number(_) | ExprKind::Text(_) => true,
        ExprKind::Paren(inner) | ExprKind::Magnitude(inner) => is_pure(m, inner),
        ExprKind::Unary { operand, .. } => is_pure(m, operand),
        ExprKind::Binary { left, right, .. } => is_pure(m, left) && is_pure(m, right),
        ExprKind::Member { base, .. } => is_pure(m, base),
        ExprKind::Index { base, subs } => {
            let pure = |e: &Option<ExprId>| e.is_none_or(|e| is_pure(m, e));
            is_pure(m, base)
                && m.program[subs].iter().all(|sub| match sub {
                    Subscript::At(e) => is_pure(m, *e),
                    Subscript::Range { from, to, step } => [from, to, step].into_iter().all(pure),
                    _ => true,
                })
        }
        _ => false,
    }
}

/// See the head of this file.
pub(crate) struct Recipe<T: Real> {
    entries: Vec<Entry<T>>,
    functions: Vec<Symbol>,
    exponents: Vec<(Cell, T)>,
    /// How much deeper than the start it goes.
    depth: u32,
    tape: Tape<T>,
    calls: crate::array::lower::Calls,
    lanes: Lanes,
    misfits: u8,
    /// Memory for the values of the entries.
    values: Vec<Value<T>>,
}

impl<T: Real> std::fmt::Debug for Recipe<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a recipe of {} entries", self.entries.len())
    }
}

/// Leaves that were read, and what came of them.
pub(crate) type Read<T> = Vec<(ExprId, Result<Value<T>, Diagnostic>)>;

/// How a kept recipe went.
enum Outcome<T: Real> {
    Done(Result<Value<T>, Diagnostic>),
    /// It does not fit: what was read goes through the tree.
    Misfit(Read<T>),
}

/// How an expression is executed.
pub(crate) enum Course<T: Real> {
    Done(Result<Value<T>, Diagnostic>),
    /// Through the tree, with values that were read already; `misfits` when it is to be recorded.
    Tree {
        read: Read<T>,
        record: Option<u8>,
    },
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Executes the expression by its recipe, if it has one that fits.
    pub fn by_recipe(&mut self, m: &Module, key: Key) -> Course<T> {
        if self.plain_operators {
            return Course::Tree { read: Vec::new(), record: None };
        }
        let Some(slot) = self.recipes.get_mut(&key) else {
            self.recipes.insert(key, Slot::Seen(0));
            return Course::Tree { read: Vec::new(), record: None };
        };
        match std::mem::replace(slot, Slot::Busy) {
            Slot::Busy => Course::Tree { read: Vec::new(), record: None },
            Slot::Never => {
                *slot = Slot::Never;
                Course::Tree { read: Vec::new(), record: None }
            }
            Slot::Seen(misfits) => Course::Tree { read: Vec::new(), record: Some(misfits) },
            Slot::Kept(mut recipe) => {
                let outcome = self.follow(m, key, &mut recipe);
                recipe.values.clear();
                match outcome {
                    Outcome::Done(value) => {
                        self.recipes.insert(key, Slot::Kept(recipe));
                        Course::Done(value)
                    }
                    Outcome::Misfit(read) => {
                        let misfits = recipe.misfits + 1;
                        let record = (misfits < MOST_MISFITS).then_some(misfits);
                        if record.is_none() {
                            self.recipes.insert(key, Slot::Never);
                        }
                        Course::Tree { read, record }
                    }
                }
            }
        }
    }

    /// A recording that begins here.
    pub fn recorder(&self) -> Recorder<T> {
        Recorder::new(self.depth)
    }

    /// Keeps what was recorded, or gives the expression up.
    pub fn keep_recipe(&mut self, key: Key, misfits: u8, lanes: Option<Lanes>, work: &mut Work<T>) {
        let slot = match (work.recorder.take(), lanes) {
            (Some(recorder), Some(lanes)) if !recorder.given_up => {
                let mut tape = std::mem::take(&mut work.tape);
                tape.release();
                let unknown = |o: &Origin| o.cell == Cell::NONE;
                match tape.plane_origins.iter().chain(&tape.const_origins).any(unknown) {
                    true => Slot::Never,
                    false => Slot::Kept(Box::new(Recipe {
                        entries: recorder.entries,
                        functions: recorder.functions,
                        exponents: recorder.exponents,
                        depth: recorder.deepest - recorder.base,
                        tape,
                        calls: std::mem::take(&mut work.calls),
                        lanes,
                        misfits,
                        values: Vec::new(),
                    })),
                }
            }
            // A fault may be another the next time.
            (Some(recorder), None) if !recorder.given_up && misfits + 1 < MOST_MISFITS => {
                Slot::Seen(misfits + 1)
            }
            _ => Slot::Never,
        };
        self.recipes.insert(key, slot);
    }

    fn follow(&mut self, m: &Module, key: Key, recipe: &mut Recipe<T>) -> Outcome<T> {
        let Recipe { entries, functions, exponents, depth, tape, calls, lanes, values, .. } =
            recipe;
        let base = self.depth;
        let hidden = functions.iter().any(|symbol| self.hides_function(m, *symbol));
        if hidden || base + *depth >= DEEPEST {
            return Outcome::Misfit(Vec::new());
        }
        values.clear();
        // What was read so far, when the tree must do the rest.
        let so_far = |values: &[Value<T>]| -> Read<T> {
            let leaf = |(entry, value): (&Entry<T>, &Value<T>)| match *entry {
                Entry::Leaf { expr, .. } | Entry::Same(_, expr) => Some((expr, Ok(value.clone()))),
                _ => None,
            };
            entries.iter().zip(values).filter_map(leaf).collect()
        };
        for entry in entries.iter() {
            let of = |cell: Cell| &values[cell.0 as usize];
            let value = match *entry {
                Entry::Literal(x) => Value::Number(x),
                Entry::Same(cell, _) => of(cell).clone(),
                Entry::Leaf { expr, depth, kind, read } => {
                    let value = match self.variable(m, expr) {
                        Some(value) => Ok(value),
                        None => {
                            self.depth = base + depth;
                            let value = self.expr(m, expr);
                            self.depth = base;
                            value
                        }
                    };
                    match value {
                        Ok(value) if Kind::of(&value) == Some(kind) => value,
                        other => {
                            let mut all = so_far(values);
                            let found = match other {
                                Ok(value) if read => self.read(value, m.program[expr].span),
                                other => other,
                            };
                            all.push((expr, found));
                            return Outcome::Misfit(all);
                        }
                    }
                }
                ref computed => match compute(computed, of) {
                    Some(value) => value,
                    None => return Outcome::Misfit(so_far(values)),
                },
            };
            values.push(value);
        }
        let number = |cell: Cell| match values[cell.0 as usize] {
            Value::Number(x) => Some(x),
            _ => None,
        };
        let fits = exponents.iter().all(|(cell, x)| number(*cell).is_some_and(|y| y.bits_eq(*x)));
        let alike = |pair: &[Cell; 2]| match pair.map(|cell| &values[cell.0 as usize]) {
            [Value::Numbers(a), Value::Numbers(b)] => Arc::ptr_eq(a, b),
            [Value::Vectors(a), Value::Vectors(b)] => Arc::ptr_eq(a, b),
            _ => false,
        };
        if !fits || !tape.aliases.iter().all(alike) {
            return Outcome::Misfit(so_far(values));
        }
        for k in 0..tape.const_origins.len() {
            let Origin { cell, part } = tape.const_origins[k];
            if cell == Origin::FIXED.cell {
                continue;
            }
            tape.constants_mut()[k] = match &values[cell.0 as usize] {
                Value::Number(x) => *x,
                Value::Vector(v) => component(v, part),
                Value::Point(p) => component(&p.xyz, part),
                _ => return Outcome::Misfit(so_far(values)),
            };
        }
        let mut rows: SmallVec<[&Vec<T>; 16]> = SmallVec::new();
        for Origin { cell, part } in &tape.plane_origins {
            rows.push(match &values[cell.0 as usize] {
                Value::Numbers(a) => &a.items,
                Value::Vectors(a) => &a.planes[*part as usize],
                _ => return Outcome::Misfit(so_far(values)),
            });
        }
        let (roots, count) = (lanes.roots(), lanes.shape.count());
        // What can fail must leave the variable as it was.
        if !tape.is_checked() {
            let filled = |outs: &mut [Vec<T>]| tape.execute(&rows, &roots, count, outs).is_ok();
            if let Some(value) = self.filled_in_place(m, key, lanes, filled) {
                return Outcome::Done(Ok(value));
            }
        }
        let spare = &mut self.spare;
        let mut outs: SmallVec<[Vec<T>; 3]> = roots.iter().map(|_| spare.take(count)).collect();
        Outcome::Done(match tape.execute(&rows, &roots, count, &mut outs) {
            Ok(()) => Ok(lanes.value(outs)),
            Err(check) => {
                let (span, name) = calls[check];
                Err(not_finite(name).at(span))
            }
        })
    }

    /// The variable that the expression is assigned to, its rows filled, when nothing else holds its
    /// array: a long row is read from and written to the memory that the caches know already.
    pub fn filled_in_place(
        &mut self,
        m: &Module,
        key: Key,
        lanes: &Lanes,
        fill: impl FnOnce(&mut [Vec<T>]) -> bool,
    ) -> Option<Value<T>> {
        let (of, target) = self.assigning?;
        let symbol = m.program.as_name(target).filter(|_| of == key)?;
        let place = self.place_of(m.names[symbol.0 as usize])?;
        let whole = place.section.is_none() && place.component.is_none();
        let outside = place.frame.is_none() && self.run.extent() == Extent::Edit;
        // Not what could still stop the run, either.
        if !whole || outside || !self.has_room(lanes.shape.count()) {
            return None;
        }
        let Binding::Variable { value, .. } = &mut self.root_mut(&place)?.what else { return None };
        let mut rows = lanes.rows_of(value)?;
        let mut outs: SmallVec<[Vec<T>; 3]> =
            rows.iter_mut().map(|row| std::mem::take(*row)).collect();
        let done = fill(&mut outs);
        debug_assert!(done, "only what cannot fail is filled in place");
        for (row, out) in rows.into_iter().zip(outs) {
            *row = out;
        }
        Some(value.clone())
    }

    /// The value of a variable that an expression names, when it is a plain one.
    fn variable(&self, m: &Module, expr: ExprId) -> Option<Value<T>> {
        let symbol = m.program.as_name(expr)?;
        match &self.lookup(m.names[symbol.0 as usize])?.what {
            Binding::Variable { value, .. } => match value {
                Value::Unset => None,
                value => Some(value.clone()),
            },
            _ => None,
        }
    }
}

/// The value of an entry that is computed of others; `None` for a fault, which the tree reports.
fn compute<'v, T: Real>(entry: &Entry<T>, of: impl Fn(Cell) -> &'v Value<T>) -> Option<Value<T>> {
    match *entry {
        Entry::Binary(op, a, b) => match (op, of(a), of(b)) {
            // The most frequent ones without the way through the rules.
            (BinaryOp::Mul, Value::Number(a), Value::Number(b)) => Some(Value::Number(*a * *b)),
            (BinaryOp::Mul, Value::Number(a), Value::Vector(b)) => Some(Value::Vector(*b * *a)),
            (_, a, b) => ops::binary(op, a, b).ok(),
        },
        Entry::Negated(a) => ops::negated(of(a)).ok(),
        Entry::Magnitude(a) => ops::magnitude(of(a)).ok(),
        Entry::Component(a, axis) => variables::component(of(a), axis),
        Entry::Braces(all) => ops::braces(all.map(|cell| of(cell).clone()).to_vec()).ok(),
        Entry::Function(name, f, args) => {
            let value = match f {
                Elementary::Unary(_) => elementary::apply(name, f, &[of(args[0]).clone()]),
                Elementary::Binary(_) => {
                    elementary::apply(name, f, &args.map(|cell| of(cell).clone()))
                }
            };
            value.ok().filter(Value::is_finite)
        }
        Entry::Literal(_) | Entry::Leaf { .. } | Entry::Same(..) => None,
    }
}

fn component<T: Real>(v: &Vec3<T>, part: u8) -> T {
    match part {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}
