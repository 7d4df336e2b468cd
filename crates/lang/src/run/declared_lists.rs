//! Declarators of lists.

use crate::source::module::Module;
use moldloft_syntax::sdl::{Declarator, ExprId, ListLength, NodeList, Type};

/// The length of the list that a declarator names, and the dimensions of its items; `None` of a single value.
///
/// A surface has two dimensions and a block three, so that one alone is the length of a list.
pub(super) fn declared_list(
    m: &Module,
    ty: Type,
    item: &Declarator,
) -> Option<(ListLength, NodeList<ExprId>)> {
    if let Some(length) = item.list {
        return Some((length, item.dims));
    }
    let of_list = matches!(
        ty,
        Type::Surface
            | Type::Block
            | Type::Pcurve
            | Type::Psurface
            | Type::Field
            | Type::Set
            | Type::Other(_)
    );
    match m.program[item.dims] {
        [length] if of_list => Some((ListLength::Of(length), m.program.no_expressions())),
        _ => None,
    }
}
