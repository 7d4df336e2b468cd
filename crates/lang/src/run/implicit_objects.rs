//! Runs a program: fields and sets that become objects.

use crate::run::interpreter::{Interpreter, silent};
use crate::source::env::DeclarationOrigin;
use crate::source::module::Module;
use crate::source::scope::Binding;
use moldloft_diag::Diagnostic;
use moldloft_model::{Declaration, Extent, Failure};
use moldloft_num::trace::Key;
use moldloft_registry::{Attributes, Scalar, Value};
use moldloft_syntax::sdl::{Declarator, StmtId, StmtKind, Symbol, Type};

/// The class of objects that a declaration of this type makes.
fn row_of(ty: Type) -> Option<&'static str> {
    match ty {
        Type::Field => Some("Field"),
        Type::Set => Some("Set"),
        _ => None,
    }
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The names that statements of the current module assign to: they are variables.
    fn is_assigned(&mut self, m: &Module, symbol: Symbol) -> bool {
        let names = self.assigned.entry(self.current).or_insert_with(|| {
            let target = |k: u32| match m.program[StmtId(k)].kind {
                StmtKind::Assign { target, .. } => m.program.as_name(target),
                _ => None,
            };
            (0..m.program.stmt_count() as u32).filter_map(target).collect()
        });
        names.contains(&symbol)
    }

    /// Runs `work`, with a log of the objects it reads if `asked`.
    pub fn noting<R>(&mut self, asked: bool, work: impl FnOnce(&mut Self) -> R) -> R {
        self.reads.begin(asked);
        let result = work(self);
        self.reads.end();
        result
    }

    /// True when a declaration names an object: of a field or set at file level, once and for all.
    pub fn makes_object(&mut self, m: &Module, ty: Type, item: &Declarator) -> bool {
        let single = item.list.is_none() && item.dims.is_empty();
        if row_of(ty).is_none()
            || item.value.is_none()
            || !single
            || self.is_assigned(m, item.name.symbol)
        {
            return false;
        }
        let frame = self.env.scope.frame();
        frame.global
            && frame.loops.is_empty()
            && frame.prefix.is_empty()
            && self.components.is_empty()
            && self.run.extent() == Extent::Whole
    }

    /// Declares the object of `field f = ...;` or `set s = ...;`. The objects that the expression
    /// reads become its parents.
    pub fn implicit_object(
        &mut self,
        m: &Module,
        id: StmtId,
        ty: Type,
        item: &Declarator,
        value: Value<T>,
    ) -> Result<(), Diagnostic> {
        let row = row_of(ty).and_then(|name| self.loader.registry.get(name)).ok_or_else(silent)?;
        let name = m.names[item.name.symbol.0 as usize];
        self.check_free(name, item.name.span, false)?;
        let parents = self.reads.taken();
        let parents = match parents.is_empty() {
            true => Value::Unset,
            false => Value::list(parents.into_iter().map(Value::Object)),
        };
        let text = m.program.name(item.name.symbol);
        let origin = self.env.origins.len() as u32;
        let (args, head) = (vec![value, parents], Attributes::of(row.class));
        let declaration = Declaration { name: text, row, args, head, origin };
        let key = self
            .run
            .declare(declaration)
            .map_err(|fault| crate::source::fault_location::unplaced(&fault).at(item.name.span))?;
        let module = self.current as u32;
        self.env.origins.push(DeclarationOrigin { module, stmt: id, repeated: false });
        self.env.scope.bind(name, item.name.span, Binding::Object(key));
        Ok(())
    }

    /// The value of an object, noted as read.
    pub fn forced(&mut self, key: Key) -> Result<Value<T>, Failure> {
        self.reads.note(key);
        self.run.force(key)
    }
}
