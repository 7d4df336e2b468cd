//! Implicit fields and sets: classes over `moldloft::field`, no logic.

mod arguments;
mod call;
mod facets;
mod field;
mod oracle;
mod set;

pub use call::call_row;
pub use facets::PyFacets;
pub use field::PyField;
pub use set::PySet;
