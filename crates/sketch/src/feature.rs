//! Definition of a feature: operands and operation. Its body is computed by [`crate::body`].

use crate::identifier::identifier;
use crate::object::SketchObject;
use crate::solid::operation::Operation;
use crate::{CoordinateAxis, DimensionExpr, LineId, PointId};
use moldloft_font::{OutlineLoop, TextLayout};
use std::sync::Arc;

/// A placement of an object.
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

/// Selection of faces that is stable under a change of dimensions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaceChoice {
    /// Faces of a name.
    Named(String),
    /// The plane faces perpendicular to an axis with the largest or smallest coordinate.
    Extreme {
        /// The axis.
        axis: CoordinateAxis,
        /// True for the largest.
        top: bool,
    },
}

impl std::fmt::Display for FaceChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FaceChoice::Named(name) => f.write_str(name),
            FaceChoice::Extreme { axis, top: true } => write!(f, "TOP {axis}"),
            FaceChoice::Extreme { axis, top: false } => write!(f, "BOTTOM {axis}"),
        }
    }
}

/// Plane face of a body on which a section is drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SectionPlace {
    /// Name of the body.
    pub body: String,
    /// The face.
    pub face: FaceChoice,
}

/// Selection of edges that is stable under a change of dimensions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EdgeChoice {
    /// All except smooth edges.
    All,
    /// Edge of a line of the drawing.
    Line(LineId),
    /// The straight edges parallel to an axis.
    Along(CoordinateAxis),
    /// Edges of faces.
    Of(FaceChoice),
    /// Edges between two faces.
    Between(FaceChoice, FaceChoice),
}

impl std::fmt::Display for EdgeChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            EdgeChoice::All => f.write_str("ALL"),
            EdgeChoice::Line(l) => write!(f, "LINE {l}"),
            EdgeChoice::Along(axis) => write!(f, "ALONG {axis}"),
            EdgeChoice::Of(face) => write!(f, "OF {face}"),
            EdgeChoice::Between(a, b) => write!(f, "BETWEEN {a} {b}"),
        }
    }
}

/// Treatment of edges.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeBlend {
    /// A plane or cone through lines at these distances from the edge, on its first and its second
    /// face.
    Chamfer([DimensionExpr; 2]),
    /// A part of a ball of this radius that rolls along the edge.
    Fillet(DimensionExpr),
}

/// The wider part of a hole at its mouth.
#[derive(Clone, Debug, PartialEq)]
pub enum HoleHead {
    /// A cylinder for a screw's head.
    Counterbore {
        /// Its diameter.
        diameter: DimensionExpr,
        /// Its depth below the drilled face.
        depth: DimensionExpr,
    },
    /// A cone for a screw's head.
    Countersink {
        /// Its diameter in the drilled face.
        diameter: DimensionExpr,
        /// The angle of the cone in degrees.
        angle: DimensionExpr,
    },
}

/// A drilled hole, and its copies.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Its axis.
    pub axis: CoordinateAxis,
    /// True if it is drilled from the side of the larger coordinate.
    pub top: bool,
    /// The coordinates of its centre along the two other axes, in the order x, y, z.
    pub at: [DimensionExpr; 2],
    /// Its diameter.
    pub diameter: DimensionExpr,
    /// Its depth below the outermost plane face of that side; `None` for a through hole.
    pub depth: Option<DimensionExpr>,
    /// Its mouth.
    pub head: Option<HoleHead>,
    /// Steps and numbers of copies; two entries make a grid.
    pub copies: Vec<(Placement, DimensionExpr)>,
}

impl Hole {
    fn numbers_mut(&mut self) -> Vec<&mut DimensionExpr> {
        let mut all: Vec<&mut DimensionExpr> = self.at.iter_mut().collect();
        all.push(&mut self.diameter);
        all.extend(&mut self.depth);
        match &mut self.head {
            Some(HoleHead::Counterbore { diameter, depth: second })
            | Some(HoleHead::Countersink { diameter, angle: second }) => {
                all.extend([diameter, second]);
            }
            None => {}
        }
        for (step, count) in &mut self.copies {
            all.extend(step.numbers_mut());
            all.push(count);
        }
        all
    }
}

/// The letters of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionText {
    /// Its lines.
    pub lines: Vec<String>,
    /// The name of the font, as given.
    pub font: String,
    /// Position relative to the origin.
    pub layout: TextLayout,
    /// The loops around the letters, in heights of a capital letter.
    pub loops: Arc<Vec<OutlineLoop>>,
    /// The axis across the section.
    pub axis: CoordinateAxis,
    /// True if it is read from the other side of the section.
    pub mirrored: bool,
    /// Height of a capital letter.
    pub size: DimensionExpr,
    /// The coordinates of its origin along the two other axes, in the order x, y, z.
    pub at: [DimensionExpr; 2],
    /// Angle of its lines in degrees.
    pub angle: DimensionExpr,
}

/// What an offset has at corners where its sides separate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetCorner {
    /// An arc about the corner.
    Round,
    /// The straight continuation of both sides.
    Mitred,
}

/// Operation of a feature.
#[derive(Clone, Debug, PartialEq)]
pub enum FeatureKind {
    /// Two bodies combined.
    Boolean(Operation),
    /// A section of letters; it has no operands.
    Text(Box<SectionText>),
    /// A section with its outline moved.
    Offset {
        /// The distance, outwards.
        distance: DimensionExpr,
        /// Corners where its sides separate.
        corner: OffsetCorner,
    },
    /// A section moved along the axis across it.
    Extrude(DimensionExpr),
    /// The first operand, a section, moved along the second, a chain of lines and arcs.
    Sweep,
    /// The body between convex sections in parallel planes.
    Loft,
    /// A section turned about the line between two of its points, by an angle in degrees.
    Revolve {
        /// The points.
        line: [PointId; 2],
        /// The angle.
        angle: DimensionExpr,
    },
    /// A body at another position.
    Place(Placement),
    /// The first body, moved along an axis until its origin is on a plane face of the second,
    /// perpendicular to that axis; or with an axis of it turned to the normal of any plane face.
    OnFace {
        /// The face.
        face: FaceChoice,
        /// The axis of the first body that becomes the normal.
        along: Option<CoordinateAxis>,
    },
    /// The union of copies, each placed relative to the previous one.
    Pattern {
        /// Placement of a copy relative to the one before.
        step: Placement,
        /// Number of instances.
        count: DimensionExpr,
    },
    /// Edges bevelled or rounded.
    Blend {
        /// Treatment.
        blend: EdgeBlend,
        /// Treated edges.
        edges: Vec<EdgeChoice>,
    },
    /// A body hollowed out, leaving a wall.
    Shell {
        /// Thickness of the wall; negative for a wall outside the body's faces.
        thickness: DimensionExpr,
        /// The faces without a wall.
        open: Vec<FaceChoice>,
    },
    /// Drilled holes.
    Hole(Box<Hole>),
    /// Plane faces inclined about their intersection with a plane perpendicular to an axis.
    Draft {
        /// The angle in degrees; positive if the body narrows along the axis.
        angle: DimensionExpr,
        /// The axis.
        axis: CoordinateAxis,
        /// The coordinate of the plane that does not change.
        at: DimensionExpr,
        /// The faces; if empty, those parallel to the axis.
        faces: Vec<FaceChoice>,
    },
}

impl Placement {
    fn numbers_mut(&mut self) -> Vec<&mut DimensionExpr> {
        match self {
            Placement::Move(by) => by.iter_mut().collect(),
            Placement::Rotate { through, angle, .. } => through.iter_mut().chain([angle]).collect(),
            Placement::Mirror { at, .. } => vec![at],
            Placement::Scale(factor) => vec![factor],
        }
    }
}

impl FeatureKind {
    /// True if it makes a section of a section.
    pub fn makes_section(&self) -> bool {
        matches!(self, FeatureKind::Offset { .. } | FeatureKind::Text(_))
    }

    /// True if its first operand is a section.
    pub fn takes_section(&self) -> bool {
        let solid = matches!(
            self,
            FeatureKind::Revolve { .. }
                | FeatureKind::Extrude(_)
                | FeatureKind::Sweep
                | FeatureKind::Loft
        );
        solid || matches!(self, FeatureKind::Offset { .. })
    }

    /// The expressions of the feature, mutable.
    pub fn numbers_mut(&mut self) -> Vec<&mut DimensionExpr> {
        match self {
            FeatureKind::Boolean(_)
            | FeatureKind::OnFace { .. }
            | FeatureKind::Sweep
            | FeatureKind::Loft => vec![],
            FeatureKind::Text(text) => {
                let SectionText { size, at: [p, q], angle, .. } = &mut **text;
                vec![size, p, q, angle]
            }
            FeatureKind::Offset { distance, .. } | FeatureKind::Extrude(distance) => vec![distance],
            FeatureKind::Revolve { angle, .. } => vec![angle],
            FeatureKind::Place(place) => place.numbers_mut(),
            FeatureKind::Pattern { step, count } => {
                let mut all = step.numbers_mut();
                all.push(count);
                all
            }
            FeatureKind::Blend { blend: EdgeBlend::Chamfer(sizes), .. } => {
                sizes.iter_mut().collect()
            }
            FeatureKind::Blend { blend: EdgeBlend::Fillet(radius), .. } => vec![radius],
            FeatureKind::Shell { thickness, .. } => vec![thickness],
            FeatureKind::Hole(hole) => hole.numbers_mut(),
            FeatureKind::Draft { angle, at, .. } => vec![angle, at],
        }
    }

    /// The expressions of the feature.
    pub fn numbers(&self) -> Vec<DimensionExpr> {
        self.clone().numbers_mut().into_iter().map(|e| e.clone()).collect()
    }
}

/// An operand of a feature.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureOperand {
    /// The object.
    pub object: Arc<SketchObject>,
    /// Prefix of its names in the feature.
    pub prefix: String,
    /// True for another object of the session, whose changes affect the feature; false for a part
    /// that belongs to the feature alone.
    pub follows: bool,
}

impl FeatureOperand {
    /// A part that belongs to a feature alone, with its original names.
    pub fn part(object: impl Into<Arc<SketchObject>>) -> FeatureOperand {
        FeatureOperand { object: object.into(), prefix: String::new(), follows: false }
    }

    /// The name of the object, if it is another object of the session.
    pub fn followed(&self) -> Option<&str> {
        self.follows.then_some(self.object.name.as_str())
    }

    /// Prefix of the names of its numbers, in lower case: for another object of the session its
    /// name, as in expressions.
    pub fn path(&self) -> String {
        match self.follows {
            true => format!("{}.", identifier(&self.object.name).to_ascii_lowercase()),
            false => self.prefix.to_ascii_lowercase(),
        }
    }
}

/// An object made of others.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Operation.
    pub kind: FeatureKind,
    /// Operands.
    pub operands: Vec<FeatureOperand>,
}
