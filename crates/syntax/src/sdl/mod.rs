//! SDL: text to syntax tree, and canonical text.
//!
//! ```
//! use moldloft_diag::FileId;
//! use moldloft_syntax::sdl::{self, StmtKind};
//!
//! let (program, diagnostics) = sdl::parse("AbsPoint P(15, 4.8, -2.5);", FileId(0));
//! assert!(diagnostics.is_empty());
//! let StmtKind::Object { kind, name, args } = program[program[program.body()][0]].kind else { panic!() };
//! assert_eq!((program.name(kind.symbol), program.name(name.symbol)), ("AbsPoint", "P"));
//!
//! // A number can be changed without parsing again.
//! let z = program.as_literal(program[args][2].value).unwrap();
//! let mut program = program;
//! program.set_literal(z, 3.0).unwrap();
//! assert_eq!(program.text_with_edits(), "AbsPoint P(15, 4.8, 3.0);");
//! ```

mod ast;
mod dump;
mod format;
mod grouping;
mod interner;
mod lexer;
mod outline;
mod parser;
mod program;
mod token;

pub use ast::*;
pub use format::format;
pub use grouping::{Grouping, Step};
pub use interner::Symbol;
pub use outline::{Fold, OpenCall, call_around, folds, text_around};
pub use parser::{MAX_DIAGNOSTICS, MAX_HEIGHT, MAX_NESTING, foreign_word, parse, parse_expr};
pub use program::Program;
pub use token::{declaring_words, is_contextual, keywords};
