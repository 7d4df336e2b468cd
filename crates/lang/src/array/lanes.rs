//! Rows and grids that a tape computes.

use moldloft_diag::{Diagnostic, Span};
use moldloft_elementwise::Src;
use moldloft_num::Real;
use moldloft_registry::{Array, ArrayShape, Value, Vectors};
use smallvec::SmallVec;
use std::sync::Arc;

/// A row or grid that a tape computes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TapeArray {
    pub shape: ArrayShape,
    pub what: What,
}

impl TapeArray {
    /// The results of a tape that make up its elements.
    pub fn roots(&self) -> SmallVec<[Src; 3]> {
        match self.what {
            What::Number(a) => SmallVec::from_slice(&[a]),
            What::Vector(v) => SmallVec::from_slice(&v),
        }
    }

    /// The array of the rows of its roots.
    pub fn value<T: Real>(&self, rows: SmallVec<[Vec<T>; 3]>) -> Value<T> {
        let shape = self.shape;
        let mut rows = rows.into_iter();
        let mut next = || rows.next().expect("a row for each root");
        match self.what {
            What::Number(_) => Value::Numbers(Arc::new(Array { shape, items: next() })),
            What::Vector(_) => {
                Value::Vectors(Arc::new(Vectors { shape, planes: [next(), next(), next()] }))
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum What {
    Number(Src),
    Vector([Src; 3]),
}

/// The functions whose results a tape checks, by the number of the check.
pub(crate) type Calls = Vec<(Span, &'static str)>;

pub(crate) fn not_finite(name: &str) -> Diagnostic {
    let (message, expected) = match name {
        "/" => ("the quotient is not a finite number".into(), "a divisor other than 0"),
        "^" => ("the power is not a finite number".into(), "a power of real numbers"),
        "+" | "-" | "*" | "." | ".*" => {
            ("the result is not a finite number".into(), "finite numbers below 1.8e308")
        }
        "||" => ("the magnitude is not a finite number".into(), "components below 1e154"),
        name => (
            format!("the result of {name} is not a finite number"),
            "arguments inside the function's domain",
        ),
    };
    Diagnostic::error("not-finite", message)
        .expected(expected)
        .help("`ieee();` before it lets infinite results and NaN pass")
}
