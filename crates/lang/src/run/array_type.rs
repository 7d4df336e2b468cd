//! Static detection of expressions that give arrays, by the types of their parts.
//!
//! `and` and `or` of numbers evaluate their right operand only if needed; beside an array they give a mask, whatever
//! the number is. So it must be known without evaluating the operand.

use crate::run::declared_lists::declared_list;
use crate::run::interpreter::Interpreter;
use crate::run::parts;
use crate::run::records::members;
use crate::source::module::Module;
use crate::source::scope::{Binding, RecordAt};
use crate::value::ops;
use crate::value::variables;
use moldloft_registry::{Class, Scalar, Value};
use moldloft_syntax::sdl::{ExprId, ExprKind, ItemType, NodeList, Subscript, Symbol, Type};

/// Number of indices of an expression's value: 0 for a single value.
type Rank = usize;

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// True of an expression whose value is an array, a list or a block.
    pub(super) fn gives_array(&self, m: &Module, id: ExprId) -> bool {
        self.rank(m, id) > 0
    }

    fn rank(&self, m: &Module, id: ExprId) -> Rank {
        let greatest = |all: &[ExprId]| all.iter().map(|&e| self.rank(m, e)).max().unwrap_or(0);
        match m.program[id].kind {
            ExprKind::Number(_) | ExprKind::Text(_) | ExprKind::Error => 0,
            ExprKind::Paren(inner) | ExprKind::Magnitude(inner) => self.rank(m, inner),
            ExprKind::Unary { operand, .. } => self.rank(m, operand),
            ExprKind::Name(symbol) => {
                let bound = self.env.scope.lookup(m.names[symbol.0 as usize]);
                match bound.map(|bound| &bound.what) {
                    Some(Binding::Variable { ty, value, .. }) => rank_of(*ty, value),
                    Some(Binding::Reference(place)) => {
                        match self.env.scope.root(place).map(|bound| &bound.what) {
                            Some(Binding::Variable { ty, value, .. }) => {
                                match variables::at_place(value, place) {
                                    Ok(value) => rank_of(*ty, &value),
                                    Err(_) => 0,
                                }
                            }
                            _ => 0,
                        }
                    }
                    Some(Binding::Multiple(_) | Binding::Turn { .. }) => 1,
                    _ => 0,
                }
            }
            // Three numbers in braces beside a mask are a row.
            ExprKind::List(items) => 1 + greatest(&m.program[items]),
            ExprKind::Binary { left, right, .. } => greatest(&[left, right]),
            ExprKind::Chain(_) => greatest(&parts::of_expression(m, id)),
            ExprKind::Index { base, subs } => self.rank_of_section(m, base, subs),
            ExprKind::Member { base, name, or_dot } => {
                let word = m.program.name(name);
                match (self.rank_of_member(m, base, word), word) {
                    (Some(rank), _) => rank,
                    (None, "x" | "y" | "z") => self.rank(m, base),
                    (None, "d1" | "d2" | "d3") => 0,
                    _ if or_dot => {
                        let bound = self.env.scope.lookup(m.names[name.0 as usize]);
                        let other = match bound.map(|bound| &bound.what) {
                            Some(Binding::Variable { ty, value, .. }) => rank_of(*ty, value),
                            _ => 0,
                        };
                        self.rank(m, base).max(other)
                    }
                    _ => 0,
                }
            }
            ExprKind::Call { callee, args } => {
                let args: Vec<ExprId> = m.program[args].iter().map(|arg| arg.value).collect();
                let Some(symbol) = m.program.as_name(callee) else { return greatest(&args) };
                let name = m.names[symbol.0 as usize];
                let result = self
                    .routine_named(name)
                    .and_then(|at| self.modules.get(at.module).program[at.routine].result);
                if let Some((ty, _)) = result {
                    return rank_of_type(ty);
                }
                match &m.rows[symbol.0 as usize] {
                    Some(row) => match row.class {
                        Class::Numbers | Class::Vectors | Class::List => 1,
                        Class::Block => 3,
                        Class::Any => self.rank_of_call(m, &row.name, &args),
                        _ => 0,
                    },
                    // A curve or surface of the model at a row of parameters.
                    None => greatest(&args),
                }
            }
        }
    }

    /// Rank of a record's member, by its declaration.
    fn rank_of_member(&self, m: &Module, base: ExprId, word: &str) -> Option<Rank> {
        let at = self.record_given(m, base)?;
        let of = self.modules.get(at.module);
        let member =
            members(of, at).into_iter().find(|x| of.program.name(x.item.name.symbol) == word)?;
        Some(match declared_list(of, member.ty.0, &member.item) {
            Some(_) => 1 + rank_of_type(member.ty.0),
            None => rank_of_type(member.ty.0).max(member.item.dims.len()),
        })
    }

    /// The record that an expression gives, or a list of it.
    fn record_given(&self, m: &Module, id: ExprId) -> Option<RecordAt> {
        let name = |symbol: Symbol| m.names[symbol.0 as usize];
        match m.program[id].kind {
            ExprKind::Paren(inner) | ExprKind::Index { base: inner, .. } => {
                self.record_given(m, inner)
            }
            ExprKind::Name(symbol) => {
                let value = self.peek(self.env.scope.lookup(name(symbol))?)?;
                let record = match &value {
                    Value::Record(record) => record,
                    Value::List(items) => match items.first()? {
                        Value::Record(record) => record,
                        _ => return None,
                    },
                    _ => return None,
                };
                let all = &self.env.scope.records;
                all.iter()
                    .find(|(of, _)| **self.modules.text(**of) == *record.of)
                    .map(|(_, at)| *at)
            }
            ExprKind::Member { base, name, .. } => {
                let at = self.record_given(m, base)?;
                let of = self.modules.get(at.module);
                let word = m.program.name(name);
                let member = members(of, at)
                    .into_iter()
                    .find(|x| of.program.name(x.item.name.symbol) == word)?;
                self.record_type(of, member.ty.0)
            }
            ExprKind::Call { callee, .. } => {
                let name = name(m.program.as_name(callee)?);
                match self.routine_named(name) {
                    Some(at) => {
                        let of = self.modules.get(at.module);
                        self.record_type(of, of.program[at.routine].result?.0)
                    }
                    None => self.env.scope.records.get(&name).copied(),
                }
            }
            _ => None,
        }
    }

    /// Rank of a function whose value is like its arguments, and of reductions.
    fn rank_of_call(&self, m: &Module, name: &str, args: &[ExprId]) -> Rank {
        let greatest = args.iter().map(|&e| self.rank(m, e)).max().unwrap_or(0);
        let reduces = matches!(name, "min" | "max" | "sum" | "mean" | "average");
        match args.len() {
            // With an axis one index is left.
            1 if reduces => 0,
            _ if reduces && greatest > 1 => greatest - 1,
            _ => greatest,
        }
    }

    fn rank_of_section(&self, m: &Module, base: ExprId, subs: NodeList<Subscript>) -> Rank {
        let subs = &m.program[subs];
        let of_base = self.rank(m, base);
        let kept = subs.iter().filter(|sub| match sub {
            Subscript::At(at) => self.gives_array(m, *at),
            _ => true,
        });
        let (kept, given) = (kept.count(), subs.len());
        // A single index of a block takes a layer, a mask of a grid a row.
        match (given, of_base) {
            (1, 3) if kept == 0 => 2,
            (1, _) if kept == 0 => of_base.saturating_sub(1).min(of_base),
            _ => kept,
        }
    }
}

fn rank_of<T: Scalar>(ty: Type, value: &Value<T>) -> Rank {
    match value {
        Value::Unset => rank_of_type(ty),
        value if !ops::is_array(value) => 0,
        Value::List(items) => 1 + items.iter().map(|v| rank_of(Type::Float, v)).max().unwrap_or(0),
        value => variables::extents(value).map_or(1, |extents| extents.len()),
    }
}

fn rank_of_type(ty: Type) -> Rank {
    match ty {
        Type::Farray | Type::Curve => 1,
        Type::Surface => 2,
        Type::Block => 3,
        Type::List(ItemType::String) => 1,
        Type::List(item) => 1 + rank_of_type(item.ty()),
        _ => 0,
    }
}
