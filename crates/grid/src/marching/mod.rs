//! Hyperbolic marching: volume grids off surfaces, plane grids off curves, collars on surfaces.
//!
//! The first layer is placed on the bisecting normals, so that it has the given height at corners
//! too; each further layer is made by implicit steps (Steger and Chaussee 1980; Chan and Steger
//! 1992) whose volumes smooth themselves over a length of the height reached. Invariants: every
//! cell of a returned grid has positive Jacobians at all its corners, and the grid does not overlap
//! itself; control flow depends on real
//! parts only, so derivatives are those of the steps.
//!
//! `heights, wall -> first layer -> steps, each tested -> layers, report`

mod crossing;
mod curve;
mod fault;
mod front;
mod joined;
mod line;
mod marched;
pub(crate) mod outcome;
mod report;
mod settings;
mod surface;
mod surface_front;
mod topology;

pub use curve::{Support, hyperbolic_curve, hyperbolic_curve_until};
pub use fault::JoinFault;
pub use joined::{OpenFrontEdges, hyperbolic_surfaces, hyperbolic_surfaces_until};
pub use marched::{Marched, MarchedBlocks};
pub use outcome::{FailureCause, MarchFailure, MarchPlace, MarchReport, StopReason};
pub(crate) use report::hexahedron;
pub use settings::{Hyperbolic, MarchBoundary, Stop};
pub use surface::{hyperbolic, hyperbolic_until};
