//! Expressions that are executed again.
//!
//! `second execution -> recipe -> later executions`
//!
//! The first execution of an element-wise expression evaluates its tree. The second does so too,
//! and records the parts that are read from variables and calls (leaves), the computations without
//! arrays, and the tape. Later executions read the leaves, in the same order, and run the tape, as
//! long as kinds and shapes are those of the recording. Any difference (another shape, another
//! exponent, a fault) passes the leaves read so far to the tree, so that a recipe changes no value
//! and no message, and nothing is read twice.

use crate::array::lanes::{Calls, TapeArray};
use crate::functions::elementary::Elementary;
use crate::source::module::Module;
use moldloft_diag::Diagnostic;
use moldloft_elementwise::{Cell, Origin, Tape};
use moldloft_num::Real;
use moldloft_registry::{ArrayShape, Value};
use moldloft_syntax::sdl::{BinaryOp, ExprId, ExprKind, Subscript, Symbol};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};

/// The most entries of a recipe.
const LONGEST: usize = 1_000;

/// State of an expression that is executed repeatedly.
#[derive(Debug)]
pub(crate) enum Slot<T: Real> {
    /// Executed once, or the number of times that a recipe did not fit.
    Seen(u8),
    Kept(Box<Recipe<T>>),
    /// In use.
    Busy,
    /// No gain, or not possible.
    Never,
}

pub(crate) type Slots<T> = HashMap<ExprKey, Slot<T>, BuildHasherDefault<KeyHasher>>;

/// An expression of all files of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ExprKey(u64);

impl ExprKey {
    pub fn of(m: &Module, expr: ExprId) -> Self {
        Self(u64::from(m.program.file().0) << 32 | u64::from(expr.0))
    }
}

impl Hash for ExprKey {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        hasher.write_u64(self.0);
    }
}

/// Scalar statements look here each time, so the hash is the shortest that spreads such keys.
#[derive(Default)]
pub(crate) struct KeyHasher(u64);

impl Hasher for KeyHasher {
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

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LeafKind {
    Number,
    Vector,
    Point,
    Numbers(ArrayShape),
    Vectors(ArrayShape),
}

impl LeafKind {
    /// `None` for values that tapes do not support.
    pub fn of<T: Real>(value: &Value<T>) -> Option<Self> {
        Some(match value {
            Value::Number(_) => LeafKind::Number,
            Value::Vector(_) => LeafKind::Vector,
            Value::Point(_) => LeafKind::Point,
            Value::Numbers(a) => LeafKind::Numbers(a.shape),
            Value::Vectors(a) => LeafKind::Vectors(a.shape),
            _ => return None,
        })
    }
}

/// One value of a recipe, in the order of the text.
#[derive(Clone, Copy)]
pub(super) enum Entry<T> {
    Literal(T),
    /// An expression `depth` levels below the whole, whose result is read if it is an object.
    Leaf {
        expr: ExprId,
        depth: u32,
        kind: LeafKind,
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

/// A recording in progress.
pub(crate) struct Recorder<T: Real> {
    pub(super) entries: Vec<Entry<T>>,
    /// Names of the leaves that are variables.
    pub(super) names: Vec<(Symbol, Cell)>,
    /// True while no leaf can change a variable.
    pub(super) pure: bool,
    /// Elementary functions that were called: their names must mean nothing else.
    pub(super) functions: Vec<Symbol>,
    /// Exponents that the tape depends on.
    pub(super) exponents: Vec<(Cell, T)>,
    /// The nesting at the start, and the deepest since.
    pub(super) base: u32,
    pub(super) deepest: u32,
    /// True when something was met that no recipe takes.
    pub given_up: bool,
}

impl<T: Real> Recorder<T> {
    pub fn new(base: u32) -> Self {
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
        kind: Option<LeafKind>,
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

/// True if it reads only variables and numbers, and has no effects.
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
    pub(super) entries: Vec<Entry<T>>,
    pub(super) functions: Vec<Symbol>,
    pub(super) exponents: Vec<(Cell, T)>,
    /// Nesting depth relative to the start.
    pub(super) depth: u32,
    pub(super) tape: Tape<T>,
    pub(super) calls: Calls,
    pub(super) lanes: TapeArray,
    pub(super) misfits: u8,
    /// Memory for the values of the entries.
    pub(super) values: Vec<Value<T>>,
}

impl<T: Real> std::fmt::Debug for Recipe<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a recipe of {} entries", self.entries.len())
    }
}

/// Leaves that were read, with their results.
pub(crate) type Read<T> = Vec<(ExprId, Result<Value<T>, Diagnostic>)>;

/// Result of an execution.
pub(crate) enum Course<T: Real> {
    Done(Result<Value<T>, Diagnostic>),
    /// Through the tree, with values that were read already; `misfits` when it is to be recorded.
    Tree {
        read: Read<T>,
        record: Option<u8>,
    },
}
