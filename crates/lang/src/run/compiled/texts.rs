//! Texts in code: constants, variables, joined texts, comparisons and `format`.

use super::code::{
    CodeArgument, CodeArray, CodeFormat, CodeNote, OF_FILE, Poisonable, Relation, ScalarOp,
};
use super::compile::{RegionCompiler, Unfit};
use super::names::Meaning;
use super::registers::{ArrayItems, ArrayRegister};
use crate::functions::format::{FormatArgument, FormatPattern};
use crate::value::ops;
use moldloft_num::Real;
use moldloft_registry::Scalar;
use moldloft_syntax::sdl::{
    Arg, AssignOp, BinaryOp, ExprId, ExprKind, NodeList, StmtId, Symbol, Type,
};
use smallvec::SmallVec;
use std::sync::Arc;

impl<T: Scalar> RegionCompiler<'_, T> {
    /// True for an expression whose value is a text.
    pub fn is_text(&mut self, id: ExprId) -> bool {
        let m = self.units[self.unit].m.clone();
        match m.program[id].kind {
            ExprKind::Text(_) => true,
            ExprKind::Name(symbol) => self.text_variable(symbol).is_some(),
            ExprKind::Paren(inner) => self.is_text(inner),
            ExprKind::Binary { op: BinaryOp::Add, left, right } => {
                self.is_text(left) && self.is_text(right)
            }
            ExprKind::Call { callee, .. } => self.is_format(callee),
            _ => false,
        }
    }

    /// The text that a name means, and its register.
    fn text_variable(&mut self, symbol: Symbol) -> Option<(Meaning, u16)> {
        let what = self.meaning(symbol).ok()?;
        let (array, register) = match what {
            Meaning::Own(Poisonable::Array(k)) => (&self.units[self.unit].arrays[k as usize], k),
            Meaning::OfFile(Poisonable::Array(k)) => {
                (&self.units[0].arrays[k as usize], k | OF_FILE)
            }
            _ => return None,
        };
        (array.ty == Type::String).then_some((what, register))
    }

    fn is_format(&mut self, callee: ExprId) -> bool {
        let m = self.units[self.unit].m.clone();
        let Some(symbol) = m.program.as_name(callee) else { return false };
        let is_row = m.rows[symbol.0 as usize].as_ref().is_some_and(|row| row.name == "format");
        let name = m.names[symbol.0 as usize];
        is_row && !self.scope.routines.contains_key(&name) && self.is_free(symbol)
    }

    /// The register of a text: that of a variable, `want` if given, or its own.
    pub fn text(&mut self, stmt: StmtId, id: ExprId, want: Option<u16>) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let expr = m.program[id];
        match expr.kind {
            ExprKind::Text(text) => self.constant_text(&m.program[text], want),
            ExprKind::Name(symbol) => {
                let (what, register) = self.text_variable(symbol).ok_or(Unfit::Statement)?;
                self.live(what, CodeNote::Name(symbol, expr.span))?;
                Ok(register)
            }
            ExprKind::Paren(inner) => self.text(stmt, inner, want),
            // A fault is found by a second evaluation.
            _ if self.calls(id) => Err(Unfit::Statement),
            ExprKind::Binary { op: BinaryOp::Add, left, right } => {
                let (a, b) = (self.text(stmt, left, None)?, self.text(stmt, right, None)?);
                let to = self.text_result(want);
                self.noted(ScalarOp::JoinTexts { to, a, b }, CodeNote::Expression(id))?;
                Ok(to)
            }
            ExprKind::Call { callee, args } if self.is_format(callee) => {
                self.formatted(stmt, id, args, want)
            }
            _ => Err(Unfit::Statement),
        }
    }

    pub fn constant_text(&mut self, text: &str, want: Option<u16>) -> Result<u16, Unfit> {
        // They are among the texts of the file, which stay.
        let all = &mut self.units[0].arrays;
        let at = all.iter().position(|a| a.text.as_deref() == Some(text)).unwrap_or_else(|| {
            all.push(CodeArray {
                name: None,
                ty: Type::String,
                captured: false,
                declared: true,
                text: Some(Arc::from(text)),
            });
            all.len() - 1
        });
        self.set_known_in(0, Poisonable::Array(at as u16), true, true);
        let a = at as u16 | if self.unit == 0 { 0 } else { OF_FILE };
        if let Some(to) = want {
            self.emit(ScalarOp::CopyText { to, a })?;
        }
        Ok(want.unwrap_or(a))
    }

    /// Puts a text that was computed to its target.
    fn text_to(&mut self, to: u16, a: u16) -> Result<(), Unfit> {
        let op = match () {
            () if a == to => return Ok(()),
            () if self.progress[self.unit].taken_texts.contains(&a) => ScalarOp::MoveText { to, a },
            () => ScalarOp::CopyText { to, a },
        };
        self.emit(op).map(drop)
    }

    fn text_result(&mut self, want: Option<u16>) -> u16 {
        want.unwrap_or_else(|| self.scratch_text())
    }

    /// `format(pattern, ...)` of numbers, vectors and texts.
    fn formatted(
        &mut self,
        stmt: StmtId,
        id: ExprId,
        args: NodeList<Arg>,
        want: Option<u16>,
    ) -> Result<u16, Unfit> {
        let m = self.units[self.unit].m.clone();
        let [pattern, values @ ..] = &m.program[args] else { return Err(Unfit::Statement) };
        if m.program[args].iter().any(|arg| arg.name.is_some()) || !self.is_text(pattern.value) {
            return Err(Unfit::Statement);
        }
        let literal = match m.program[m.program.bare(pattern.value)].kind {
            ExprKind::Text(text) => {
                Some(FormatPattern::of(&m.program[text]).map_err(|_| Unfit::Statement)?)
            }
            _ => None,
        };
        let pattern = match literal {
            Some(_) => 0,
            None => self.text(stmt, pattern.value, None)?,
        };
        let mut all = Vec::with_capacity(values.len());
        for arg in values {
            all.push(match () {
                () if self.is_text(arg.value) => {
                    CodeArgument::Array { from: self.text(stmt, arg.value, None)? }
                }
                () if self.is_vector(arg.value) => {
                    CodeArgument::Vector { from: self.vector(stmt, arg.value)? }
                }
                () => CodeArgument::Number { from: self.value(stmt, arg.value, None)? },
            });
        }
        let formats = &mut self.units[self.unit].formats;
        formats.push(CodeFormat { literal, pattern, args: all.into() });
        let format = u16::try_from(formats.len() - 1).map_err(|_| Unfit::Unit)?;
        let to = self.text_result(want);
        self.noted(ScalarOp::FormatText { to, format }, CodeNote::Expression(id))?;
        Ok(to)
    }

    /// The comparison of two texts, as a number in `to`.
    pub fn compared_texts(
        &mut self,
        stmt: StmtId,
        relation: Relation,
        left: ExprId,
        right: ExprId,
        to: u16,
    ) -> Result<(), Unfit> {
        if !self.is_text(left) || !self.is_text(right) || self.calls(left) || self.calls(right) {
            return Err(Unfit::Statement);
        }
        let (a, b) = (self.text(stmt, left, None)?, self.text(stmt, right, None)?);
        self.emit(ScalarOp::CompareTexts { relation, to, a, b }).map(drop)
    }

    /// The code of an assignment to a text; false for another target.
    pub(super) fn assigned_text(
        &mut self,
        id: StmtId,
        target: ExprId,
        op: AssignOp,
        value: ExprId,
    ) -> Result<bool, Unfit> {
        let m = self.units[self.unit].m.clone();
        let ExprKind::Name(symbol) = m.program[target].kind else { return Ok(false) };
        let Some((what, to)) = self.text_variable(symbol) else { return Ok(false) };
        let note = CodeNote::Name(symbol, m.program[target].span);
        match op {
            AssignOp::Set => {
                let want = Some(to).filter(|_| self.is_live(what));
                let a = self.text(id, value, want)?;
                self.live(what, note)?;
                self.text_to(to, a)?;
            }
            AssignOp::With(BinaryOp::Add) if !self.calls(value) => {
                self.live(what, note)?;
                let b = self.text(id, value, None)?;
                let op = ScalarOp::JoinTexts { to, a: to, b };
                self.noted(op, CodeNote::Assignment(id))?;
            }
            AssignOp::With(_) => return Err(Unfit::Statement),
        }
        Ok(true)
    }

    /// `string t = value;`, where `origin` is its declaration; true when it cannot fail.
    pub(super) fn declared_text(
        &mut self,
        stmt: StmtId,
        (array, origin): (u16, u16),
        value: Option<ExprId>,
    ) -> Result<bool, Unfit> {
        let m = self.units[self.unit].m.clone();
        let constant = match value.map(|value| m.program[value].kind) {
            None => Some(""),
            Some(ExprKind::Text(text)) => Some(&m.program[text]),
            Some(_) => None,
        };
        match (constant, value) {
            (Some(text), _) => drop(self.constant_text(text, Some(array))?),
            (None, Some(value)) => {
                let a = self.text(stmt, value, None)?;
                self.text_to(array, a)?;
            }
            (None, None) => {}
        }
        self.emit(ScalarOp::DeclareText { array, origin })?;
        self.units[self.unit].unfixed.push(origin);
        Ok(constant.is_some())
    }
}

/// The arrays of a call and of the file, by number.
pub(super) struct ArraysByNumber<'a, T> {
    pub own: &'a mut [ArrayRegister<T>],
    pub of_file: &'a mut [ArrayRegister<T>],
}

impl<T: Real> ArraysByNumber<'_, T> {
    fn text(&self, a: u16) -> &str {
        match a & OF_FILE {
            0 => self.own[a as usize].text(),
            _ => self.of_file[(a & !OF_FILE) as usize].text(),
        }
    }

    fn at(&mut self, a: u16) -> &mut ArrayRegister<T> {
        match a & OF_FILE {
            0 => &mut self.own[a as usize],
            _ => &mut self.of_file[(a & !OF_FILE) as usize],
        }
    }

    /// Joins two texts, in the room of the target; `None` if the result is too long.
    #[inline(never)]
    pub fn join(&mut self, to: u16, a: u16, b: u16) -> Option<()> {
        let length = self.text(a).len() + self.text(b).len();
        if length > ops::LONGEST_TEXT {
            return None;
        }
        let mut joined = match to == b {
            true => String::with_capacity(length),
            false => self.at(to).text_room(to == a),
        };
        if to != a || to == b {
            joined.push_str(self.text(a));
        }
        joined.push_str(self.text(b));
        self.at(to).items = ArrayItems::OwnedText(joined);
        Some(())
    }

    /// Two texts change places.
    pub fn exchange(&mut self, to: u16, a: u16) {
        let moved = std::mem::replace(&mut self.at(a).items, ArrayItems::Nothing);
        let before = std::mem::replace(&mut self.at(to).items, moved);
        self.at(a).items = before;
    }
}

/// The text of `format(...)`; `None` for a fault.
#[inline(never)]
pub(super) fn formatted<T: Real>(
    format: &CodeFormat,
    registers: &[T],
    arrays: &ArraysByNumber<'_, T>,
) -> Option<String> {
    let text = |a: u16| arrays.text(a);
    let number = |at: usize| FormatArgument::Number(registers[at].re() + 0.0);
    let mut items: SmallVec<[FormatArgument; 4]> = SmallVec::new();
    for argument in &format.args {
        match *argument {
            CodeArgument::Number { from } => items.push(number(from as usize)),
            CodeArgument::Vector { from } => {
                items.extend((0..3).map(|c| number(from as usize + c)))
            }
            CodeArgument::Array { from } => items.push(FormatArgument::Text(text(from).into())),
            CodeArgument::OfFile => return None,
        }
    }
    let spelled = match &format.literal {
        Some(pattern) => pattern.spelled(&items),
        None => FormatPattern::of(text(format.pattern)).and_then(|pattern| pattern.spelled(&items)),
    };
    spelled.ok()
}
