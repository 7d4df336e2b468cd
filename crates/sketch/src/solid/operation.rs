//! Operations on two bodies.

/// Boolean operation on two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// In one of them.
    Union,
    /// The first without the second.
    Cut,
    /// In both.
    Common,
}

impl Operation {
    /// The command word.
    pub fn word(self) -> &'static str {
        match self {
            Operation::Union => "UNION",
            Operation::Cut => "CUT",
            Operation::Common => "COMMON",
        }
    }

    pub(crate) fn holds(self, a: bool, b: bool) -> bool {
        match self {
            Operation::Union => a || b,
            Operation::Cut => a && !b,
            Operation::Common => a && b,
        }
    }
}
