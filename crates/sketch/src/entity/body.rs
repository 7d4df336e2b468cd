//! Bodies bounded by triangles.

use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, TriangleBody, Value};
use std::sync::Arc;

/// A body bounded by triangles. The solid of a sketch is one.
///
/// Its members are `volume`, `area` and `centroid`: those of the triangles unless better ones are
/// given, as sketches do for bodies with curves.
#[derive(Kind)]
#[kind(
    class = Mesh,
    example = "MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4});"
)]
pub struct MeshBody<T: Real> {
    /// The vertices.
    #[field(min_items = 3)]
    points: Vec<Vec3<T>>,
    /// Corners of the triangles as numbers of vertices from 1, counter-clockwise from outside.
    #[field(min_items = 3)]
    triangles: Vec<u32>,
    /// The exact volume, where it is known.
    #[field(default)]
    volume: Option<T>,
    /// The exact area, where it is known.
    #[field(default)]
    area: Option<T>,
    /// The exact centroid, where it is known.
    #[field(default)]
    centroid: Option<Vec3<T>>,
}

impl<T: Real> Build<T> for MeshBody<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (n, count) = (self.points.len(), self.triangles.len());
        if count % 3 != 0 {
            return Err(CallError::new(
                "wrong-count",
                format!("{count} corners make no triangles"),
            )
            .expected("three corners for each triangle")
            .found(format!("{count} corners"))
            .in_field(Self::TRIANGLES));
        }
        let wrong = |v: &u32| *v == 0 || *v as usize > n;
        if let Some(at) = self.triangles.iter().position(wrong) {
            let v = self.triangles[at];
            return Err(CallError::new("out-of-range", format!("there is no vertex {v}"))
                .expected(format!("a whole number from 1 to {n}"))
                .found(v.to_string())
                .in_field(Self::TRIANGLES)
                .in_item(at));
        }
        let triangles: Vec<[u32; 3]> =
            self.triangles.chunks(3).map(|t| [t[0] - 1, t[1] - 1, t[2] - 1]).collect();
        let mut body = TriangleBody::new(self.points, triangles);
        let own = &mut body.of_triangles;
        own.volume = self.volume.unwrap_or(own.volume);
        own.area = self.area.unwrap_or(own.area);
        own.centroid = self.centroid.unwrap_or(own.centroid);
        Ok(Value::Body(Arc::new(body)))
    }
}
