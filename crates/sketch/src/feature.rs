//! What a feature is made of: other objects, and how. Its body is computed by [`crate::body`].

use crate::object::SketchObject;
use crate::solid::operation::Operation;
use crate::{CoordinateAxis, DimensionExpr, PointId};
use std::sync::Arc;

/// A change of place.
#[derive(Clone, Debug, PartialEq)]
pub enum Placement {
    /// By a vector.
    Move([DimensionExpr; 3]),
    /// About an axis through a point, right-handed, in degrees.
    Rotate {
        /// Direction of the axis.
        axis: CoordinateAxis,
        /// A point of it.
        through: [DimensionExpr; 3],
        /// The angle.
        angle: DimensionExpr,
    },
    /// In a plane perpendicular to an axis.
    Mirror {
        /// The axis.
        axis: CoordinateAxis,
        /// The coordinate of the plane.
        at: DimensionExpr,
    },
    /// About the origin.
    Scale(DimensionExpr),
}

/// How a feature is made of its operands.
#[derive(Clone, Debug, PartialEq)]
pub enum FeatureKind {
    /// Two bodies combined.
    Boolean(Operation),
    /// A section turned about the line between two of its points, by an angle in degrees.
    Revolve {
        /// The points.
        line: [PointId; 2],
        /// The angle.
        angle: DimensionExpr,
    },
    /// One body in another place.
    Place(Placement),
    /// Copies, each placed as the next from the last, united.
    Pattern {
        /// From one copy to the next.
        step: Placement,
        /// How many there are.
        count: u32,
    },
}

/// An object that a feature is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureOperand {
    /// The object.
    pub object: Arc<SketchObject>,
    /// What its names begin with in the feature.
    pub prefix: String,
}

/// An object made of others.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// How.
    pub kind: FeatureKind,
    /// Of what.
    pub operands: Vec<FeatureOperand>,
}
