//! Execution of records, lists of values of one type, and their parts.

use crate::run::declared_lists::declared_list;
use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::source::scope::{Binding, CallFrame, RecordAt};
use crate::value::initialised::Known;
use crate::value::subarray::{PathStep, Place, ValuePath};
use crate::value::variables::{self, Called as _, Taken};
use moldloft_diag::{Diagnostic, Span};
use moldloft_registry::{Record, Scalar, Value};
use moldloft_syntax::sdl::{
    Arg, Declarator, ExprId, ExprKind, ItemType, ListLength, NodeList, StmtId, StmtKind, Symbol,
    Type,
};
use std::sync::Arc;

pub(super) struct DeclaredMember {
    stmt: StmtId,
    pub ty: (Type, Span),
    pub item: Declarator,
}

/// The members of a record, in order.
pub(super) fn members(of: &Module, at: RecordAt) -> Vec<DeclaredMember> {
    let StmtKind::Record { members, .. } = of.program[at.stmt].kind else { return Vec::new() };
    let mut all = Vec::new();
    for &stmt in &of.program[members] {
        if let StmtKind::Declare { ty, items, .. } = of.program[stmt].kind {
            let items = of.program[items].iter();
            all.extend(items.map(|&item| DeclaredMember { stmt, ty, item }));
        }
    }
    all
}

/// A given member of a new record: its index, value and position.
type GivenMember<T> = (usize, Value<T>, Span);

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Makes the records of a module known.
    pub(super) fn declare_records(&mut self, module: &Module, at: usize) {
        for &stmt in &module.program[module.program.body()] {
            let StmtKind::Record { name, .. } = module.program[stmt].kind else { continue };
            let key = module.names[name.symbol.0 as usize];
            let known = self.env.scope.records.insert(key, RecordAt { module: at, stmt });
            let first = known.filter(|known| known.module == at).map(|known| known.stmt);
            if first.is_some() || self.env.scope.routines.contains_key(&key) {
                let text = module.program.name(name.symbol);
                let diagnostic =
                    Diagnostic::error("duplicate-name", format!("`{text}` is defined twice"))
                        .at(name.span)
                        .help("give one of them another name");
                self.report(diagnostic);
            }
        }
    }

    /// The declaration of the record that a type names.
    pub(super) fn record_type(&self, m: &Module, ty: Type) -> Option<RecordAt> {
        let (Type::Other(symbol) | Type::List(ItemType::Other(symbol))) = ty else { return None };
        self.env.scope.records.get(&m.names[symbol.0 as usize]).copied()
    }

    /// The type of a variable that a word of a module declares: records know theirs by their values.
    pub(super) fn variable_type(&self, m: &Module, ty: Type) -> Type {
        match (ty, self.record_type(m, ty)) {
            (Type::Other(_), Some(_)) => Type::Record,
            (Type::List(_), Some(_)) => Type::List(ItemType::Record),
            (ty, _) => ty,
        }
    }

    /// The value, if it is the record, or list of records, of a type.
    ///
    /// # Errors
    /// For another value than the record.
    pub(super) fn record_checked(
        &self,
        m: &Module,
        ty: Type,
        value: Value<T>,
    ) -> Result<Value<T>, Diagnostic> {
        let (Some(_), Type::Other(symbol) | Type::List(ItemType::Other(symbol))) =
            (self.record_type(m, ty), ty)
        else {
            return Ok(value);
        };
        let wanted = m.program.name(symbol);
        let check = |value: &Value<T>| {
            let found = match value {
                Value::Record(record) if *record.of == *wanted => return Ok(()),
                Value::Record(record) => format!("a {}", record.of),
                other => other.called().to_string(),
            };
            let message = format!("expected a {wanted}, found {found}");
            Err(Diagnostic::error("wrong-type", message)
                .expected(format!("a record `{wanted}`"))
                .found(found))
        };
        match (&value, ty) {
            (Value::List(items), Type::List(_)) => items.iter().try_for_each(check)?,
            (_, Type::List(_)) => {}
            (single, _) => check(single)?,
        }
        Ok(value)
    }

    /// The value of an expression in a list context: braces contain its items, of any class.
    pub(super) fn list_operand(
        &mut self,
        m: &Module,
        expr: ExprId,
    ) -> Result<Value<T>, Diagnostic> {
        let ExprKind::List(items) = m.program[m.program.bare(expr)].kind else {
            return self.operand(m, expr);
        };
        let items = m.program[items].to_vec();
        let mut values = Vec::with_capacity(items.len());
        for item in items {
            match self.multiple(m, item) {
                Some(passed) => {
                    for one in passed {
                        values.push(self.passed(&one)?);
                    }
                }
                None => values.push(self.operand(m, item)?),
            }
        }
        Ok(Value::list(values))
    }

    /// True of a variable that is a declared list.
    pub(super) fn names_list(&self, m: &Module, target: ExprId) -> bool {
        let Some(symbol) = m.program.as_name(target) else { return false };
        let Some(place) = self.env.scope.place_of(m.names[symbol.0 as usize]) else { return false };
        self.type_inside(&place).is_some_and(|(ty, _)| matches!(ty, Type::List(_)))
            && place.section.is_none()
    }

    /// Declares a list of values of one type.
    pub(super) fn declare_list(
        &mut self,
        m: &Module,
        global: bool,
        (ty, (length, dims)): (Type, (ListLength, NodeList<ExprId>)),
        item: &Declarator,
    ) -> Result<(), Diagnostic> {
        let record = self.record_type(m, ty);
        let Some(list @ Type::List(of)) = self.variable_type(m, ty).list() else {
            return Err(Diagnostic::error("wrong-type", "there are no lists of this type")
                .help("a row of numbers is an `farray`, a row of vectors a `curve`"));
        };
        let dims = self.extents(m, dims)?;
        let length = match length {
            ListLength::Open => None,
            ListLength::Of(expr) => {
                let n = self.number(m, expr)?.re();
                Some(variables::extent(n).map_err(|d| d.or_at(m.program[expr].span))?)
            }
        };
        let count = dims.iter().map(|&n| n as f64).product::<f64>() * length.unwrap_or(1) as f64;
        self.usage.steps += variables::has_room::<T>(of.ty(), count, self.inputs.budget)?;
        let mut items = Vec::new();
        match item.value {
            Some(expr) => {
                let span = m.program[expr].span;
                let value = self.list_operand(m, expr)?;
                let value = self
                    .record_checked(m, ty.list().unwrap_or(ty), value)
                    .and_then(|value| variables::converted(list, value))
                    .map_err(|d| d.or_at(span))?;
                let Value::List(given) = value else { return Err(silent()) };
                if let Some(n) = length.filter(|n| *n != given.len()) {
                    let message = format!("shapes differ: [{n}] = [{}]", given.len());
                    return Err(Diagnostic::error("shapes-differ", message)
                        .at(span)
                        .expected(format!("{n} values"))
                        .found(format!("{} values", given.len())));
                }
                for value in given.iter() {
                    let value = variables::initial(of.ty(), &dims, Some(value.clone()));
                    items.push(value.map_err(|d| d.or_at(span))?);
                }
            }
            None => {
                for _ in 0..length.unwrap_or(0) {
                    items.push(match record {
                        Some(at) => self.record_of(at, Vec::new(), item.name.span)?,
                        None => variables::initial(of.ty(), &dims, None)?,
                    });
                }
            }
        }
        let ty = if of == ItemType::String { Type::String } else { list };
        let fixed = !dims.is_empty();
        let what =
            Binding::Variable { ty, value: Value::list(items), fixed, known: Known::default() };
        self.bind_variable(m, global, item.name, what)
    }

    pub(super) fn declare_record(
        &mut self,
        m: &Module,
        global: bool,
        (ty, at): (Type, RecordAt),
        item: &Declarator,
    ) -> Result<(), Diagnostic> {
        if let Some(&second) = m.program[item.dims].get(1) {
            return Err(Diagnostic::error("wrong-dimension", "a list has one length")
                .at(m.program[second].span));
        }
        let value = match item.value {
            Some(expr) => {
                let value = self.operand(m, expr)?;
                self.record_checked(m, ty, value).map_err(|d| d.or_at(m.program[expr].span))?
            }
            None => self.record_of(at, Vec::new(), item.name.span)?,
        };
        self.bind_variable(m, global, item.name, Binding::variable(Type::Record, value))
    }

    /// `name(member, member = value)`: a record with these members, the others as they are declared.
    pub(super) fn new_record(
        &mut self,
        m: &Module,
        at: RecordAt,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<Value<T>, Diagnostic> {
        let of = self.modules.get(at.module).clone();
        let members = members(&of, at);
        let spelled: Vec<&str> =
            members.iter().map(|member| of.program.name(member.item.name.symbol)).collect();
        let StmtKind::Record { name, .. } = of.program[at.stmt].kind else { return Err(silent()) };
        let name = of.program.name(name.symbol);
        let signature = format!("{name}({})", spelled.join(", "));
        let mut given: Vec<GivenMember<T>> = Vec::new();
        let written = m.program[args].to_vec();
        for (k, arg) in written.into_iter().enumerate() {
            let place = m.program[arg.value].span;
            let k = match arg.name {
                None if k < members.len() => k,
                None => {
                    let message = format!("{name} has {} members", members.len());
                    return Err(Diagnostic::error("too-many-arguments", message)
                        .at(place)
                        .expected(signature));
                }
                Some(ident) => {
                    let word = m.program.name(ident.symbol);
                    spelled.iter().position(|own| *own == word).ok_or_else(|| {
                        let message = format!("{name} has no member `{word}`");
                        Diagnostic::error("unknown-argument", message)
                            .at(ident.span)
                            .expected(&signature)
                            .suggest(word, spelled.iter().copied())
                    })?
                }
            };
            if given.iter().any(|(other, ..)| *other == k) {
                let message = format!("`{}` of {name} is given twice", spelled[k]);
                return Err(Diagnostic::error("argument-twice", message).at(place));
            }
            let list = declared_list(&of, members[k].ty.0, &members[k].item).is_some();
            let value = match list {
                true => self.list_operand(m, arg.value)?,
                false => self.operand(m, arg.value)?,
            };
            given.push((k, value, place));
        }
        self.record_of(at, given, span)
    }

    /// A record whose members are declared one after the other, in a scope of their own.
    fn record_of(
        &mut self,
        at: RecordAt,
        given: Vec<GivenMember<T>>,
        span: Span,
    ) -> Result<Value<T>, Diagnostic> {
        let of = self.modules.get(at.module).clone();
        let StmtKind::Record { name, .. } = of.program[at.stmt].kind else { return Err(silent()) };
        let prefix = self.env.scope.frame().prefix.clone();
        let mut frame = CallFrame::new(false, prefix);
        frame.called = Some((span, self.current as u32));
        if !self.deeper(span) {
            return Err(silent());
        }
        self.env.scope.frames.push(frame);
        let outer = std::mem::replace(&mut self.current, at.module);
        let values = self.member_values(&of, at, given);
        self.current = outer;
        self.env.scope.frames.pop();
        self.usage.depth -= 1;
        let (names, values) = values?.into_iter().unzip::<_, _, Vec<Arc<str>>, Vec<Value<T>>>();
        let record =
            Record { of: of.program.name(name.symbol).into(), names: names.into(), values };
        Ok(Value::Record(Arc::new(record)))
    }

    fn member_values(
        &mut self,
        of: &Module,
        at: RecordAt,
        given: Vec<GivenMember<T>>,
    ) -> Result<Vec<(Arc<str>, Value<T>)>, Diagnostic> {
        let mut values = Vec::new();
        for (k, DeclaredMember { stmt, ty, item }) in members(of, at).into_iter().enumerate() {
            let name = of.names[item.name.symbol.0 as usize];
            let given = given.iter().find(|(own, ..)| *own == k);
            let declared = Declarator { value: item.value.filter(|_| given.is_none()), ..item };
            self.declare(of, stmt, false, ty, &declared)?;
            if let Some((_, value, place)) = given {
                let frame = self.env.scope.frames.len() - 1;
                let whole = Place::whole(Some(frame as u32), name);
                self.record_checked(of, ty.0, value.clone())
                    .and_then(|value| self.store(whole, value))
                    .map_err(|d| d.or_at(*place).note_at(item.name.span, "declared here"))?;
            }
            let value = match self.env.scope.own(name).map(|bound| &bound.what) {
                Some(Binding::Variable { value, .. }) => value.clone(),
                _ => return Err(silent()),
            };
            values.push((Arc::from(of.program.name(item.name.symbol)), value));
        }
        Ok(values)
    }

    /// The place of a member of a record; `None` for other places.
    pub(super) fn member_place(
        &self,
        m: &Module,
        id: ExprId,
        name: Symbol,
        place: Place,
    ) -> Result<Option<Place>, Diagnostic> {
        if place.section.is_some() || place.component.is_some() {
            return Ok(None);
        }
        let Some(Binding::Variable { value, .. }) = self.env.scope.root(&place).map(|b| &b.what)
        else {
            return Ok(None);
        };
        let Some(Value::Record(record)) = variables::inside(value, &place.path) else {
            return Ok(None);
        };
        let word = m.program.name(name);
        match record.position(word) {
            Some(k) => place.at(PathStep::Member(k as u32)).map(Some),
            None => {
                let message = format!("{} has no `{word}`", record.of);
                Err(Diagnostic::error("unknown-member", message)
                    .at(m.program.member_span(id))
                    .expected(record.names.join(", "))
                    .suggest(word, record.names.iter().map(|name| &**name)))
            }
        }
    }

    /// The type of the value at a path, and whether its dimensions were declared.
    fn type_inside(&self, place: &Place) -> Option<(Type, bool)> {
        let Binding::Variable { ty, value, fixed, .. } = &self.env.scope.root(place)?.what else {
            return None;
        };
        let (mut ty, mut fixed, mut value) = (*ty, *fixed, value);
        for step in place.path.steps() {
            match (step, value) {
                (PathStep::Item(k), Value::List(items)) => {
                    value = items.get(*k as usize)?;
                    ty = match ty {
                        Type::List(item) => item.ty(),
                        Type::String => Type::String,
                        _ => variables::type_of(value),
                    };
                }
                (PathStep::Member(k), Value::Record(record)) => {
                    let named = |name| **self.modules.text(name) == *record.of;
                    let mut all = self.env.scope.records.iter();
                    let (_, &at) = all.find(|(name, _)| named(**name))?;
                    let of = self.modules.get(at.module);
                    let member = members(of, at).into_iter().nth(*k as usize)?;
                    let own = self.variable_type(of, member.ty.0);
                    (ty, fixed) = match declared_list(of, member.ty.0, &member.item) {
                        Some((_, dims)) => (own.list()?, !dims.is_empty()),
                        None => (own, !member.item.dims.is_empty()),
                    };
                    value = record.values.get(*k as usize)?;
                }
                _ => return None,
            }
        }
        Some((ty, fixed))
    }

    /// Stores a value into a part of a list or record.
    pub(super) fn store_inside(&mut self, place: Place, value: Value<T>) -> Result<(), Diagnostic> {
        let text = self.modules.text(place.name).clone();
        let (ty, fixed) = self.type_inside(&place).ok_or_else(silent)?;
        let Some(bound) = self.env.scope.root_mut(&place) else { return Err(silent()) };
        let Binding::Variable { value: root, .. } = &mut bound.what else { return Err(silent()) };
        let Some(old) = variables::inside_mut(root, &place.path) else { return Err(silent()) };
        let taken = Taken { ty, fixed, name: &text };
        let within = Place { path: ValuePath::default(), ..place };
        variables::store(taken, old, &within, value).map(drop)
    }
}
