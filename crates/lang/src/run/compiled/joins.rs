//! Operations that do the work of several, where these follow each other.
//!
//! Those that they stand for stay behind them: for jumps to them, for their faults, and for a look
//! at the limits between two steps.

use super::code::{NO_LABEL, ScalarOp};

/// Joins the operations of a unit.
pub(super) fn join(code: &mut [ScalarOp]) {
    use ScalarOp::*;
    for k in 1..code.len() {
        let joined = match (code[k - 1], code[k], code.get(k + 1)) {
            (Step(a), Step(b), _) if b == a + 1 => Steps(a),
            (Step(statement), JumpIfNot { relation, a, b, to }, Some(Step(then)))
                if *then == statement + 1 =>
            {
                Branch { statement, relation, a, b, to }
            }
            (Mul { to, a, b }, Add { to: sum, a: x, b: y }, _) if (x == to) != (y == to) => {
                let c = if x == to { y } else { x };
                MulThenAdd { to, a, b, sum, c }
            }
            (Add { to, a, b }, Whole { to: whole, a: sum }, _) if sum == to => {
                AddThenWhole { to, a, b, whole }
            }
            (JumpIfNot { relation, a, b, to: exit }, Turn { at: NO_LABEL, label: NO_LABEL }, _) => {
                WhileTest { relation, a, b, exit }
            }
            _ => continue,
        };
        code[k - 1] = joined;
    }
    for k in 0..code.len() {
        if let Jump { to } = code[k]
            && let WhileTest { .. } = code[to as usize]
        {
            code[k] = WhileNext { test: to };
        }
    }
}
