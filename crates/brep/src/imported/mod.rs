//! Faces of boundaries of other programs: NURBS with loops of paths in their parameters. Sides along an edge that is one
//! by its number get one parametrisation ([`align`]) and are compared ([`EdgeContact`]).

mod align;
mod contact;
mod faces;
mod fitting;
mod points;

pub use align::align;
pub use contact::{EdgeContact, SideName, contacts, poles};
pub use faces::{ImportedFace, ImportedSide, border, is_whole, on_border};
pub use points::NurbsPoints;
