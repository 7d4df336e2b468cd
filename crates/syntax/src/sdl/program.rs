//! A parsed program.

use super::ast::*;
use super::interner::{Interner, Symbol};
use crate::number;
use moldloft_diag::{Diagnostic, FileId, Span};
use std::ops::Index;
use std::sync::Arc;

/// A parsed program: its text, its tables of nodes, and its numbers.
///
/// It is complete even if the text has errors, which are `Error` nodes.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) text: Arc<str>,
    pub(crate) file: FileId,
    pub(crate) interner: Interner,
    pub(crate) literals: Vec<Literal>,
    pub(crate) texts: Vec<Box<str>>,
    pub(crate) exprs: Vec<Expr>,
    pub(crate) stmts: Vec<Stmt>,
    pub(crate) routines: Vec<Routine>,
    pub(crate) expr_lists: Vec<ExprId>,
    pub(crate) stmt_lists: Vec<StmtId>,
    pub(crate) arg_lists: Vec<Arg>,
    pub(crate) sub_lists: Vec<Subscript>,
    pub(crate) chain_lists: Vec<ChainItem>,
    pub(crate) declarator_lists: Vec<Declarator>,
    pub(crate) formal_lists: Vec<Formal>,
    pub(crate) body: NodeList<StmtId>,
    /// Literals whose value was set, each once.
    pub(crate) edited: Vec<LiteralId>,
}

impl Program {
    /// The text that was parsed.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The file that the spans name.
    pub fn file(&self) -> FileId {
        self.file
    }

    /// The statements of the file, including loads and routines.
    pub fn body(&self) -> NodeList<StmtId> {
        self.body
    }

    /// All routines in the order of the text.
    pub fn routines(&self) -> &[Routine] {
        &self.routines
    }

    /// All numbers in the order of the text.
    pub fn literals(&self) -> &[Literal] {
        &self.literals
    }

    /// The name of a symbol.
    pub fn name(&self, symbol: Symbol) -> &str {
        self.interner.name(symbol)
    }

    /// The symbol of a name, if it is reserved or occurs in the text.
    pub fn symbol(&self, name: &str) -> Option<Symbol> {
        self.interner.find(name)
    }

    /// Number of symbols; they are `0..symbol_count`.
    pub fn symbol_count(&self) -> usize {
        self.interner.len()
    }

    /// Number of statements; their ids are `0..stmt_count`.
    pub fn stmt_count(&self) -> usize {
        self.stmts.len()
    }

    /// Number of expressions; their ids are `0..expr_count`.
    pub fn expr_count(&self) -> usize {
        self.exprs.len()
    }

    /// The empty list of expressions.
    pub fn no_expressions(&self) -> NodeList<ExprId> {
        NodeList::new(0, 0)
    }

    /// The text a span covers.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or("")
    }

    /// The expression without enclosing parentheses.
    pub fn bare(&self, mut expr: ExprId) -> ExprId {
        while let ExprKind::Paren(inner) = self[expr].kind {
            expr = inner;
        }
        expr
    }

    /// Position of a member's name (the last part of an [`ExprKind::Member`]).
    pub fn member_span(&self, member: ExprId) -> Span {
        let expr = &self[member];
        match expr.kind {
            ExprKind::Member { name, .. } => {
                let length = self.name(name).len() as u32;
                Span { start: expr.span.end.saturating_sub(length), ..expr.span }
            }
            _ => expr.span,
        }
    }

    /// The name, if the expression is only a name.
    pub fn as_name(&self, expr: ExprId) -> Option<Symbol> {
        match self[self.bare(expr)].kind {
            ExprKind::Name(symbol) => Some(symbol),
            _ => None,
        }
    }

    /// The number, if the expression is only a number, which a direct edit can change.
    pub fn as_literal(&self, expr: ExprId) -> Option<LiteralId> {
        match self[self.bare(expr)].kind {
            ExprKind::Number(literal) => Some(literal),
            _ => None,
        }
    }

    /// Changes a number of the text, without parsing again. An integer set to a fraction becomes a
    /// float, as if typed; a float remains one.
    ///
    /// # Errors
    /// `not-finite` for infinities and NaN; `unknown-literal` for an id of another program.
    pub fn set_literal(&mut self, id: LiteralId, value: f64) -> Result<(), Diagnostic> {
        let Some(literal) = self.literals.get_mut(id.0 as usize) else {
            return Err(Diagnostic::error(
                "unknown-literal",
                "this number does not belong to the program",
            ));
        };
        if !value.is_finite() {
            let diagnostic =
                Diagnostic::error("not-finite", "a number in a program must be finite");
            return Err(diagnostic
                .at(literal.span)
                .expected("a finite number")
                .found(value.to_string()));
        }
        literal.value = if value == 0.0 { 0.0 } else { value };
        literal.is_int &= number::is_whole(value);
        if !literal.edited {
            literal.edited = true;
            self.edited.push(id);
        }
        Ok(())
    }

    /// True if a number was changed since the text was parsed.
    pub fn is_edited(&self) -> bool {
        !self.edited.is_empty()
    }

    /// Replacements in [`Program::text`] for the changed numbers, in the order of the text.
    pub fn edits(&self) -> Vec<(Span, String)> {
        let mut ids = self.edited.clone();
        ids.sort_unstable();
        ids.into_iter()
            .map(|id| self.literals[id.0 as usize])
            .map(|l| (l.span, spelling(&l)))
            .collect()
    }

    /// The text with the changed numbers, everything else byte for byte as it was.
    pub fn text_with_edits(&self) -> String {
        crate::splice(&self.text, &self.edits())
    }
}

fn spelling(literal: &Literal) -> String {
    let text =
        if literal.is_int { number::plain(literal.value) } else { number::float(literal.value) };
    if literal.wrap_negative && literal.value < 0.0 { format!("({text})") } else { text }
}

macro_rules! tables {
    ($($id:ty => $table:ident: $node:ty;)*) => {$(
        impl Index<$id> for Program {
            type Output = $node;
            fn index(&self, id: $id) -> &$node {
                &self.$table[id.0 as usize]
            }
        }
    )*};
}

tables! {
    LiteralId => literals: Literal;
    ExprId => exprs: Expr;
    StmtId => stmts: Stmt;
    RoutineId => routines: Routine;
}

impl Index<TextId> for Program {
    type Output = str;
    fn index(&self, id: TextId) -> &str {
        &self.texts[id.0 as usize]
    }
}

macro_rules! lists {
    ($($node:ty => $table:ident;)*) => {$(
        impl Index<NodeList<$node>> for Program {
            type Output = [$node];
            fn index(&self, list: NodeList<$node>) -> &[$node] {
                &self.$table[list.start as usize..(list.start + list.count) as usize]
            }
        }
    )*};
}

lists! {
    ExprId => expr_lists;
    StmtId => stmt_lists;
    Arg => arg_lists;
    Subscript => sub_lists;
    ChainItem => chain_lists;
    Declarator => declarator_lists;
    Formal => formal_lists;
}
