//! The groups of numbers of a whole model.

/// Their names: measures of the panels, qualities of the worst panels, hydrostatics.
pub const WHOLE_GROUPS: [&str; 3] = ["mesh", "mesh_quality", "hydrostatics"];
