//! Typed rough sketches that become exact parametric solids by a few dimensions.
//!
//! An object is drawn roughly, once, as a flat picture. Not its accuracy but its topology and the
//! *types* of its lines carry the meaning: a type says which of x, y, z change along a line, so every
//! line makes its ends share one or two planes perpendicular to axes. N planes on an axis need N - 1
//! dimensions. When all are given the sketch is exact in space; faces, volume and curves follow.
//!
//! `picture -> types -> planes -> dimensions -> coordinates -> faces -> solid`
//!
//! Source: R. E. Brewer, J. A. Jortner, W. N. Waggenspack, *Reference Manual: Computer Graphics
//! Program for Generation of Engineering Geometry (SKETCH)*, WES Technical Report K-83-3, 1983.
//!
//! # For hosts
//!
//! [`SketchSession`] is the whole command language. A host gives it lines and shows the replies:
//!
//! - `SketchSession::with_files(files)`: `files` answers INPUT and RUN with texts ([`Files`]).
//! - [`SketchSession::run_line`] gives a list of [`CommandReply`]: severity, the code of 1983 if there is one, the
//!   text, the next step, and for SAVE and EXPORT a file (name and bytes) that the host writes, whole
//!   or not at all. A refused command has changed nothing.
//! - [`SketchSession::journal`] is the list of commands that made the present state. The host appends its
//!   new items to a journal file after each line; running them again restores the session.
//! - [`SketchSession::objects`] (data) and [`SketchSession::objects_json`] (`{"objects": [...]}`,
//!   each with name, state, points, lines, faces, volume, area, centroid, inertia, missing and
//!   loose dimensions) give the results; each solid gives a mesh by [`SketchSolid::mesh`].
//! - [`SketchSession::complete`] completes words for a prompt; [`SketchSession::over`] reports that QUIT was given.
//!
//! For derivatives, [`solve`] and [`solid()`] take any scalar: seed the values of dimensions by name.
//!
//! ```
//! use moldloft_num::{Dual, Real};
//! use moldloft_sketch::{Planes, SketchSession, solid, solve};
//!
//! let mut session = SketchSession::new();
//! for reply in session.run_text(
//!     "SKETCH SLAB 2D XZ
//!      POINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
//!      POLYLINE 1 2 3 4 CLOSE
//!      DIMENSION W X 1 2 = 8; DIMENSION H Z 1 4 = 2; EXTRUDE 5",
//! ) {
//!     assert!(!reply.is_error(), "{}", reply.text);
//! }
//! assert_eq!(session.objects()[0].volume, Some(80.0));
//!
//! let object = session.object("slab").unwrap();
//! let planes = Planes::of(&object.drawing);
//! let seeded = [("h".to_owned(), Dual::<1>::seeded(2.0, 0))].into_iter().collect();
//! let layout = solve(object, &planes, &seeded, &|| None);
//! let volume = solid(object, &planes, &layout).unwrap().mass().volume;
//! assert!((volume.re() - 80.0).abs() < 1e-12 && (volume.eps[0] - 40.0).abs() < 1e-12);
//! ```
//!
//! # What 1983 had and this has not
//!
//! The data manager of the manual's appendix C (routines NADD, NFIND, NDELET, …) and the scroll,
//! menu and screen routines have no successor, nor have the errors that only they raised: 103, 104,
//! 106, 111, 121, 122, 131, 132, 201-204, 395, 397, 399 for point records, 403, 407-410, 500-502,
//! 999. Those of them that a user could cause are caught at their origin (404, 396, 701).
//!
//! Invariant: this crate reads no file and no clock, and no line given to it makes it panic.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod command;
mod dimension;
mod drawing;
pub mod entity;
mod feature;
mod format;
mod identifier;
mod object;
pub mod solid;

pub use command::{
    CommandError, CommandReply, CommandReport, Files, NullFiles, ObjectChange, OutFile,
    ReplySubject, SectionFrame, SketchCommand, SketchSession, Suggestion, drawable_faces,
};
pub use dimension::expr::{DimensionExpr, FUNCTIONS, NoValue};
pub use dimension::layout::{
    Count, DimensionFault, DimensionLayout, Loose, agree, chain, chain_text, numbers, solve,
};
pub use dimension::solver::scale;
pub use dimension::{Dimension, DimensionRole, MeasuredQuantity, Variable};
pub use drawing::axis::{CoordinateAxis, Free, Letters, Naming};
pub use drawing::estimate::{Estimate, FreeDepth, MAX_PLANES};
pub use drawing::line_types::{DOUBTFUL, NAMING_TOLERANCE};
pub use drawing::planes::{Planes, Reason, TypeFault, why};
pub use drawing::projection::Projection;
pub use drawing::proposals::TypeProposal;
pub use drawing::snaps::{Snap, SnapDirection, SnapKind};
pub use drawing::stroke::{
    PenSample, StrokeFault, StrokeFit, StrokeKind, StrokePiece, fit_stroke, pen_positions,
};
pub use drawing::{
    Align, Drawing, DrawingHit, DrawnLine, DrawnPoint, FaceId, LineId, LineTypeSource, PointId,
};
pub use feature::{
    EdgeBlend, EdgeChoice, FaceChoice, Feature, FeatureKind, FeatureOperand, Hole, HoleHead,
    Placement, SectionPlace, SectionText,
};
pub use format::dimension_marks::DimensionMark;
pub use format::script::{script, scripts};
pub use format::{dxf, export, json, json_format, page_curve, page_shapes, page_spline};
pub use identifier::identifier;
pub use moldloft_mesh::triangulate;
pub use object::{Reference, SketchFace, SketchObject, results};
pub use solid::body_tree::{BodyTree, body_tree};
pub use solid::coincidence::Kink;
pub use solid::feature::{NoBody, TreatmentFault, body};
pub use solid::gradient::{SolidGradient, Swept, gradient};
pub use solid::mass::Mass;
pub use solid::operation::Operation;
pub use solid::ruled_faces::RoundFace;
pub use solid::{SketchSolid, curve, faces, merge, solid};

/// Inner parts, for the tests of this crate: unit tests would compile all of it once more.
#[doc(hidden)]
pub mod parts {
    pub use crate::format::page_shapes::PageShapes;
    pub use crate::format::svg::apart;
    pub use crate::format::svg_shapes::svg_shapes;
    pub use crate::format::svg_transform::SvgTransform;
}
