//! The relational kinds: points, curves, snakes, surfaces, solids, planes and contours that are made from
//! one another.
//!
//! Each kind is a documented struct whose fields are its arguments; the derive macro generates its
//! row of the registry. A new kind needs one file and one line in [`rows`].
//!
//! `arguments (numbers, points, shapes) -> kind -> shape that evaluates itself`
//!
//! Shapes made of points hold positions, not their points; shapes made of shapes hold those. The
//! kinds state the trace of a curve or an edge ([`moldloft_num::trace`]), so that meshes join by
//! identity.
//!
//! Invariant: no dependency on graph, language or files.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod affine;
mod alias;
mod arguments;
mod chebyshev;
mod contours;
mod curve;
mod faults;
mod foil;
mod frame;
mod lists;
mod mesh;
mod normal;
mod plane;
mod point;
mod relabel;
mod seam;
mod search;
mod snake;
mod solid;
mod surface;
mod table;
mod third_derivatives;

pub use search::{distance_from_curve, distance_from_surface, separation};
pub use snake::edge;

/// Inner parts, for the tests of this crate: unit tests would compile all of it once more.
#[doc(hidden)]
pub mod parts {
    pub use crate::chebyshev::{ChebyshevPiece, PiecewiseChebyshev, nodes};
    pub use crate::search::Table;
    pub use crate::third_derivatives::{slope, tangent};
}

use moldloft_registry::Row;
use moldloft_registry::export::StaticRow;

macro_rules! rows {
    ($($kind:path),* $(,)?) => {
        vec![$({
            use $kind as Kind;
            <Kind<f64> as StaticRow>::row()
        }),*]
    };
}

/// All kinds and functions of this crate, in the order of the reference.
///
/// # Example
/// ```
/// let rows = moldloft_relational::rows();
/// let line = rows.iter().find(|row| row.name == "Line").unwrap();
/// assert_eq!(line.fields.len(), 3);
/// ```
pub fn rows() -> Vec<Row> {
    rows![
        point::AbsPoint,
        point::RelPoint,
        point::MirrPoint,
        point::FramePoint,
        point::PolarPoint,
        point::OffsetPoint,
        point::TanPoint,
        point::RotatPoint,
        point::CopyPoint,
        point::BlendPoint,
        point::CentroidPoint,
        table::TabPoint,
        search::ProjPoint,
        search::IntPoint,
        point::AbsBead,
        point::RelBead,
        point::ArcLenBead,
        point::CopyBead,
        point::AbsMagnet,
        point::RelMagnet,
        point::CopyMagnet,
        point::AbsRing,
        point::RelRing,
        point::ArcLenRing,
        point::CopyRing,
        search::IntBead,
        search::XYZBead,
        search::ProjBead,
        search::ProxBead,
        search::ProjMagnet,
        search::ProxMagnet,
        search::IntMagnet,
        search::XYZMagnet,
        search::TanMagnet,
        point::BoxMagnet,
        search::IntRing,
        search::XYZRing,
        search::ProjRing,
        search::ProxRing,
        point::BoxRing,
        curve::Line,
        curve::Arc,
        curve::BCurve,
        curve::CCurve,
        curve::XCurve,
        curve::NURBCurve,
        curve::Conic,
        curve::FoilCurve,
        curve::Helix,
        curve::PolyCurve,
        curve::Join,
        curve::SubCurve,
        curve::BSubCurve,
        curve::RelCurve,
        curve::CopyCurve,
        curve::RotatCurve,
        curve::OffsetCurve,
        curve::BFitCurve,
        curve::NUBFitCurve,
        table::TabCurve,
        curve::ProcCurve,
        curve::TanCurve,
        curve::MirrCurve,
        search::ProjCurve,
        search::Intersection,
        search::BodyIntersection,
        snake::LineSnake,
        snake::BSnake,
        snake::EdgeSnake,
        snake::ContactSnake,
        snake::UVSnake,
        snake::ArcSnake,
        snake::CSnake,
        snake::NURBSnake,
        snake::ConicSnake,
        snake::FoilSnake,
        snake::RelSnake,
        snake::CopySnake,
        curve::PolySnake,
        search::ProjSnake,
        search::IntSnake,
        search::GeoSnake,
        curve::SubSnake,
        curve::BSubSnake,
        surface::RuledSurf,
        surface::BLoftSurf,
        surface::CLoftSurf,
        surface::XLoftSurf,
        surface::ArcLoftSurf,
        surface::BSurf,
        surface::NURBSurf,
        surface::FoilLoftSurf,
        surface::RevSurf,
        surface::TranSurf,
        surface::SweepSurf,
        surface::BlendSurf,
        surface::BlendCenter,
        surface::TanBoundary,
        surface::DevSurf,
        surface::ExpandedSurf,
        surface::FilletSurf,
        surface::RollFillet,
        surface::SubSurf,
        surface::TrimSurf,
        mesh::TriMesh,
        surface::Blister,
        surface::MirrSurf,
        surface::RotatSurf,
        surface::CopySurf,
        surface::ProjSurf,
        surface::RelSurf,
        surface::OffsetSurf,
        surface::PolySurf,
        surface::BFitSurf,
        surface::NUBFitSurf,
        table::TabSurf,
        surface::ProcSurf,
        solid::FaceSurf,
        solid::RuledSolid,
        solid::BLoftSolid,
        solid::CLoftSolid,
        solid::BSolid,
        solid::BlendSolid,
        solid::TranSolid,
        solid::SweepSolid,
        relabel::Relabel,
        relabel::CosRelabel,
        relabel::GeoRelabel,
        relabel::TanhRelabel,
        relabel::TableRelabel,
        relabel::ArcLenRelabel,
        relabel::CopyRelabel,
        relabel::InvRelabel,
        relabel::ComposeRelabel,
        plane::XPlane,
        plane::YPlane,
        plane::ZPlane,
        plane::OffsetPlane,
        plane::ThreePointPlane,
        plane::TwoPointPlane,
        plane::PlaneThroughPoint,
        plane::TanPlane,
        plane::NormalPlane,
        frame::ThreePointFrame,
        frame::RPYFrame,
        contours::XContours,
        contours::YContours,
        contours::ZContours,
        contours::PlaneContours,
        contours::CylinderContours,
        contours::AngleContours,
        lists::RealList,
        lists::KnotList,
        lists::EntityList,
    ]
}
