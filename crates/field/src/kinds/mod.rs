//! Primitives, sets, blends and their measures, as rows of the registry.

mod blends;
pub mod body;
mod design;
mod faced;
mod flaws;
mod measures;
mod primitives;
mod profiles;
pub mod read;
pub mod region;
mod sets;
mod shapes;
mod smooth;
mod transforms;

use moldloft_registry::Row;
use moldloft_registry::export::StaticRow;

/// All rows, in the order of the reference.
pub fn rows() -> Vec<Row> {
    macro_rules! rows {
        ($($module:ident::$kind:ident,)*) => {
            vec![$($module::$kind::<f64>::row()),*]
        };
    }
    rows![
        primitives::HalfSpace,
        primitives::BehindPlane,
        primitives::Sphere,
        primitives::Cylinder,
        primitives::Cone,
        primitives::Torus,
        primitives::Cyclide,
        shapes::TubeOf,
        shapes::PlateOf,
        shapes::SideOf,
        shapes::InsideOf,
        profiles::ProfileOf,
        profiles::Extruded,
        profiles::ExtrudedRegion,
        profiles::ProfileRevolved,
        sets::SetOf,
        sets::Cuboid,
        sets::Tetrahedron,
        sets::Thin,
        sets::Everything,
        sets::Nothing,
        sets::Attributed,
        sets::Regularized,
        faced::Polyhedron,
        transforms::Translated,
        transforms::Turned,
        transforms::Mirrored,
        transforms::Scaled,
        transforms::Stretched,
        blends::Liming,
        blends::Zhang,
        blends::Setback,
        blends::Fillet,
        blends::Rounded,
        blends::Transition,
        smooth::SmoothUnion,
        smooth::SmoothIntersection,
        smooth::SmoothDifference,
        design::Remapped,
        design::Twisted,
        design::Remainder,
        design::Repeated,
        smooth::CircularArray,
        design::UnionOf,
        design::IntersectionOf,
        design::SetOffset,
        design::SetShell,
        design::ConvexHull,
        design::MinkowskiSum,
        design::FilletSets,
        design::RoundEdges,
        design::ChamferEdges,
        measures::Volume,
        measures::Area,
        measures::WireLength,
        measures::Centroid,
        measures::Inertia,
        measures::VolumeBracket,
        measures::Member,
        measures::Winner,
        measures::Gradient,
        measures::Range,
        measures::Degree,
        measures::NearestPoint,
        measures::FirstHit,
        measures::Distance,
        measures::Components,
        measures::Bounds,
        primitives::FieldObject,
        sets::SetObject,
        faced::FaceSet,
        body::SetBody,
    ]
}
