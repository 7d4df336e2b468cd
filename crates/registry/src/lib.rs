//! The one registry: everything that can be called is a row of pure functions
//! `arguments -> Value`.
//!
//! An entity kind, an array intrinsic, an implicit primitive, a user's Python function: each is a
//! [`Row`] with a name, documented [`FieldSpec`]s and a body. `Kind name(...)` in the language calls a
//! row and keeps the result under a name; `f(...)` calls one and does not.
//!
//! `struct + #[derive(Kind)] -> Row -> { language, model files, Python, reference page }`
//!
//! Invariant: this crate knows no particular kind, no graph and no file; it builds without them.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod args;
mod attributes;
mod call_error;
mod class;
mod division_density;
mod kept;
mod periodic;
mod read;
mod refs;
mod relabelled;
mod row;
mod search_report;
mod sweep;
mod taped;
mod triangle_body;
mod value;

pub use args::{Given, argument_count, bind_arguments, check_evaluated};
pub use attributes::{ATTRIBUTES, Attributes, PanelAttributes, Spacing};
pub use call_error::{Argument, ArgumentPlace, CallError, FieldId};
pub use class::Class;
pub use division_density::DivisionDensity;
pub use kept::Kept;
pub use moldloft_registry_derive::Kind;
pub use read::{FromValue, MirrorArgument, many};
pub use refs::{
    CurveRef, DeclaredJoin, FieldRef, Figures, ImplicitFunction, Point, ReparametrizationRef,
    SetRef, SolidRef, SurfacePart, SurfaceRef,
};
pub use relabelled::relabelled;
pub use row::{
    Build, CallRemark, Context, DefaultValue, FieldSpec, Foreign, Implementation, Registry, Role,
    Row, Scalar, Unit,
};
pub use search_report::{Remark, SearchReport, SearchStatus};
pub use sweep::{LocusRef, MovingCurve, MovingPoint, Sweep};
pub use triangle_body::{
    Border, BorderCurve, Flaw, Group, SheetMeasures, TriangleBody, TriangulatedBorder,
};
pub use value::{Array, ArrayShape, Contours, Family, OBLIQUE, Record, Value, Vectors};

/// Definitions used by the output of the derive macro.
#[doc(hidden)]
pub mod export {
    pub use crate::relabelled::RELABEL_FIELD;
    pub use crate::row::StaticRow;
    /// The field at a position.
    pub const fn field_id(position: usize) -> crate::FieldId {
        crate::FieldId::at(position)
    }
    pub use moldloft_num::{Dual4, Real, Rev};
}
