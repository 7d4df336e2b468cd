//! The one registry: everything that can be called is a row of pure functions
//! `arguments -> Value`.
//!
//! An entity kind, an array intrinsic, an implicit primitive, a user's Python function: each is a
//! [`Row`] with a name, documented [`Field`]s and a body. `Kind name(...)` in the language calls a
//! row and keeps the result under a name; `f(...)` calls one and does not.
//!
//! `struct + #[derive(Kind)] -> Row -> { language, model files, Python, reference page }`
//!
//! Invariant: this crate knows no particular kind, no graph and no file; it builds without them.

mod args;
mod class;
mod facets;
mod fault;
mod found;
mod head;
mod kept;
mod read;
mod refs;
mod relabelled;
mod row;
mod sweep;
mod value;

pub use args::{Given, arrange, check_evaluated};
pub use class::Class;
pub use facets::{Border, Facets, Flaw, Group, Hem, Hemmed};
pub use fault::{Argument, Fault, FieldId, Place};
pub use found::{Found, FoundStatus, Remark};
pub use head::{HEAD, Head, Panels, Spacing};
pub use kept::Kept;
pub use moldloft_registry_derive::Kind;
pub use read::{FromValue, Mirror, many};
pub use refs::{CurveRef, FieldRef, Implicit, Point, RelabelRef, SetRef, SolidRef, SurfaceRef};
pub use relabelled::relabelled;
pub use row::{Body, Build, Context, DefaultValue, Field, Foreign, Registry, Row, Scalar, Unit};
pub use sweep::{LocusRef, MovingCurve, MovingPoint, Sweep};
pub use value::{Array, ArrayShape, Contours, Family, OBLIQUE, Value, Vectors};

/// What the derive macro's output refers to.
#[doc(hidden)]
pub mod export {
    pub use crate::relabelled::RELABEL_FIELD;
    pub use crate::row::StaticRow;
    /// The field at a position.
    pub const fn field_id(position: usize) -> crate::FieldId {
        crate::FieldId::at(position)
    }
    pub use moldloft_num::{Dual4, Real};
}
