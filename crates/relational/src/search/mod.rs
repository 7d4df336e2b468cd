//! Projections, intersections and nearest points. The searches of `moldloft_locate` use real parts;
//! derivatives of the results follow by the implicit function theorem. A report is attached to the
//! value.

mod arguments;
mod beads;
mod branch_ends;
mod branch_order;
mod cut;
mod distances;
mod equations;
mod geodesic;
mod int_point;
mod intersect_bodies;
mod intersect_snake;
mod magnets;
mod on_surface;
mod outcome;
mod pieces;
mod points;
mod project_snake;
mod table;

pub use arguments::Onto;
pub use beads::{IntBead, IntRing, ProjBead, ProjRing, ProxBead, ProxRing, XYZBead, XYZRing};
pub use distances::{distance_from_curve, distance_from_surface, separation};
pub use geodesic::GeoSnake;
pub use int_point::IntPoint;
pub use intersect_bodies::BodyIntersection;
pub use intersect_snake::{IntSnake, Intersection};
pub use magnets::{IntMagnet, ProjMagnet, ProxMagnet, TanMagnet, XYZMagnet};
pub use points::ProjPoint;
pub use project_snake::{ProjCurve, ProjSnake};
pub use table::Table;
