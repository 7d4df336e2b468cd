//! Runs a program: expressions by the recipes of their earlier executions.

use crate::array::lanes::{TapeArray, not_finite};
use crate::array::lower::TapeBuilder;
use crate::array::recipe::{Course, Entry, ExprKey, LeafKind, Read, Recipe, Recorder, Slot};
use crate::functions::elementary::{self, Elementary};
use crate::run::interpreter::{DEEPEST, Interpreter};
use crate::source::module::Module;
use crate::source::scope::Binding;
use crate::value::ops;
use crate::value::variables;
use moldloft_diag::Diagnostic;
use moldloft_elementwise::{Cell, Origin};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Scalar, Value};
use moldloft_syntax::sdl::{BinaryOp, ExprId};
use smallvec::SmallVec;
use std::sync::Arc;

/// Number of misfits after which an expression is not recorded again.
const MOST_MISFITS: u8 = 4;

/// Result of a cached recipe.
enum RecipeOutcome<T: Real> {
    Done(Result<Value<T>, Diagnostic>),
    /// It does not fit: the tree evaluates the leaves that were read.
    Misfit(Read<T>),
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Executes the expression by its recipe, if it has one that fits.
    pub fn by_recipe(&mut self, m: &Module, key: ExprKey) -> Course<T> {
        if self.arrays.plain_operators {
            return Course::Tree { read: Vec::new(), record: None };
        }
        let Some(slot) = self.arrays.recipes.get_mut(&key) else {
            self.arrays.recipes.insert(key, Slot::Seen(0));
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
                    RecipeOutcome::Done(value) => {
                        self.arrays.recipes.insert(key, Slot::Kept(recipe));
                        Course::Done(value)
                    }
                    RecipeOutcome::Misfit(read) => {
                        let misfits = recipe.misfits + 1;
                        let record = (misfits < MOST_MISFITS).then_some(misfits);
                        if record.is_none() {
                            self.arrays.recipes.insert(key, Slot::Never);
                        }
                        Course::Tree { read, record }
                    }
                }
            }
        }
    }

    /// A recording that begins here.
    pub fn recorder(&self) -> Recorder<T> {
        Recorder::new(self.usage.depth)
    }

    /// Stores a recording, or gives the expression up.
    pub fn keep_recipe(
        &mut self,
        key: ExprKey,
        misfits: u8,
        lanes: Option<TapeArray>,
        work: &mut TapeBuilder<T>,
    ) {
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
        self.arrays.recipes.insert(key, slot);
    }

    fn follow(&mut self, m: &Module, key: ExprKey, recipe: &mut Recipe<T>) -> RecipeOutcome<T> {
        let Recipe { entries, functions, exponents, depth, tape, calls, lanes, values, .. } =
            recipe;
        let base = self.usage.depth;
        let hidden = functions.iter().any(|symbol| self.hides_function(m, *symbol));
        if hidden || base + *depth >= DEEPEST {
            return RecipeOutcome::Misfit(Vec::new());
        }
        values.clear();
        // Leaves read so far, for the tree.
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
                            self.usage.depth = base + depth;
                            let value = self.expr(m, expr);
                            self.usage.depth = base;
                            value
                        }
                    };
                    match value {
                        Ok(value) if LeafKind::of(&value) == Some(kind) => value,
                        other => {
                            let mut all = so_far(values);
                            let found = match other {
                                Ok(value) if read => self.read(value, m.program[expr].span),
                                other => other,
                            };
                            all.push((expr, found));
                            return RecipeOutcome::Misfit(all);
                        }
                    }
                }
                ref computed => match compute(computed, of) {
                    Some(value) => value,
                    None => return RecipeOutcome::Misfit(so_far(values)),
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
            return RecipeOutcome::Misfit(so_far(values));
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
                _ => return RecipeOutcome::Misfit(so_far(values)),
            };
        }
        let mut rows: SmallVec<[&Vec<T>; 16]> = SmallVec::new();
        for Origin { cell, part } in &tape.plane_origins {
            rows.push(match &values[cell.0 as usize] {
                Value::Numbers(a) => &a.items,
                Value::Vectors(a) => &a.planes[*part as usize],
                _ => return RecipeOutcome::Misfit(so_far(values)),
            });
        }
        let (roots, count) = (lanes.roots(), lanes.shape.count());
        // An operation that can fail must not change the variable.
        if !tape.is_checked() {
            let filled = |outs: &mut [Vec<T>]| tape.execute(&rows, &roots, count, outs).is_ok();
            if let Some(value) = self.filled_in_place(m, key, lanes, filled) {
                return RecipeOutcome::Done(Ok(value));
            }
        }
        let spare = &mut self.arrays.spare;
        let mut outs: SmallVec<[Vec<T>; 3]> = roots.iter().map(|_| spare.take(count)).collect();
        RecipeOutcome::Done(match tape.execute(&rows, &roots, count, &mut outs) {
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
        key: ExprKey,
        lanes: &TapeArray,
        fill: impl FnOnce(&mut [Vec<T>]) -> bool,
    ) -> Option<Value<T>> {
        // The target belongs to another module if a function is called in between.
        let (_, target) = self.arrays.assigning.filter(|(of, _)| *of == key)?;
        let symbol = m.program.as_name(target)?;
        let place = self.env.scope.place_of(m.names[symbol.0 as usize])?;
        let whole = place.is_whole();
        let outside = place.frame.is_none() && self.run.extent() == Extent::Edit;
        // Neither may one that can stop the run.
        if !whole || outside || !self.has_room(lanes.shape.count()) {
            return None;
        }
        let Binding::Variable { value, .. } = &mut self.env.scope.root_mut(&place)?.what else {
            return None;
        };
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
        match &self.env.scope.lookup(m.names[symbol.0 as usize])?.what {
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
            // The most frequent ones without the general rules.
            (BinaryOp::Mul, Value::Number(a), Value::Number(b)) => Some(Value::Number(*a * *b)),
            (BinaryOp::Mul, Value::Number(a), Value::Vector(b)) => Some(Value::Vector(*b * *a)),
            (_, a, b) => ops::binary(op, a, b).ok(),
        }
        // Values that are not finite are judged by the tree.
        .filter(Value::is_finite),
        Entry::Negated(a) => ops::negated(of(a)).ok(),
        Entry::Magnitude(a) => ops::magnitude(of(a)).ok().filter(Value::is_finite),
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
