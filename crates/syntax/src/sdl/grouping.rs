//! In which order the operators of a flat chain are applied.

use super::ast::*;
use super::program::Program;
use moldloft_diag::Span;

/// Grouping of a chain of operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grouping {
    /// Numbers and vectors, as in FORTRAN: `^` first and right-associative, then signs, `* /`, `+
    /// -`.
    Numbers,
    /// With a set among the operands, as in C: signs first, then `* /`, `+ -`, `&`, `^`, `|`, all
    /// left-associative.
    Sets,
}

/// One step of a chain in postfix order, for a stack machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Push the operand.
    Push(ExprId),
    /// Apply a sign to the topmost value.
    Unary(UnaryOp, Span),
    /// Combine the two topmost values, the upper one being the right operand.
    Binary(BinaryOp, Span),
}

impl Grouping {
    fn infix(self, op: BinaryOp) -> (u8, bool) {
        // Strength and whether operators of equal strength group from the right.
        match (self, op) {
            (Grouping::Numbers, BinaryOp::Caret) => (9, true),
            (Grouping::Sets, BinaryOp::Caret) => (3, false),
            (_, BinaryOp::Mul | BinaryOp::Div) => (6, false),
            (_, BinaryOp::Add | BinaryOp::Sub) => (5, false),
            (_, BinaryOp::Intersection) => (4, false),
            _ => (2, false),
        }
    }

    const PREFIX: u8 = 7;

    /// Hands the steps of a chain to `step`, in order. `waiting` is scratch space.
    pub(crate) fn walk(
        self,
        items: &[ChainItem],
        waiting: &mut Vec<ChainItem>,
        mut step: impl FnMut(Step),
    ) {
        waiting.clear();
        let strength = |item: &ChainItem| match item {
            ChainItem::Infix(op, _) => self.infix(*op).0,
            _ => Self::PREFIX,
        };
        let apply = |item: ChainItem| match item {
            ChainItem::Operand(operand) => Step::Push(operand),
            ChainItem::Prefix(op, span) => Step::Unary(op, span),
            ChainItem::Infix(op, span) => Step::Binary(op, span),
        };
        for item in items {
            match item {
                ChainItem::Operand(operand) => step(Step::Push(*operand)),
                ChainItem::Prefix(..) => waiting.push(*item),
                ChainItem::Infix(op, _) => {
                    let (own, from_right) = self.infix(*op);
                    while let Some(top) = waiting.last().copied() {
                        let other = strength(&top);
                        if other < own || (other == own && from_right) {
                            break;
                        }
                        step(apply(top));
                        waiting.pop();
                    }
                    waiting.push(*item);
                }
            }
        }
        while let Some(top) = waiting.pop() {
            step(apply(top));
        }
    }
}

impl Program {
    /// The steps of an [`ExprKind::Chain`] in postfix order for either grouping.
    pub fn grouped(&self, chain: NodeList<ChainItem>, grouping: Grouping) -> Vec<Step> {
        let items = &self[chain];
        let mut steps = Vec::with_capacity(items.len());
        grouping.walk(items, &mut Vec::new(), |step| steps.push(step));
        steps
    }
}
