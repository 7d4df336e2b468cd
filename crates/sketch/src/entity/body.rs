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
    forward,
    class = Mesh,
    example = "MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); \
               MeshBody plate({{0,0,0}, {1,0,0}, {1,1,0}, {0,1,0}}, quads = {1,2,3,4});"
)]
pub struct MeshBody<T: Real> {
    /// The vertices.
    #[field(min_items = 3)]
    points: Vec<Vec3<T>>,
    /// Corners of the triangles as numbers of vertices from 1, counter-clockwise from outside.
    #[field(default)]
    triangles: Option<Vec<u32>>,
    /// Exact volume, if known.
    #[field(default)]
    volume: Option<T>,
    /// Exact area, if known.
    #[field(default)]
    area: Option<T>,
    /// Exact centroid, if known.
    #[field(default)]
    centroid: Option<Vec3<T>>,
    /// Corners of quadrilateral panels, numbered as for the triangles.
    #[field(default)]
    quads: Option<Vec<u32>>,
}

impl<T: Real> Build<T> for MeshBody<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let n = self.points.len();
        let (threes, fours) = (self.triangles.unwrap_or_default(), self.quads.unwrap_or_default());
        if threes.is_empty() && fours.is_empty() {
            return Err(CallError::new("wrong-count", "a body needs triangles or quads")
                .expected("three corners or more")
                .found("none")
                .in_field(Self::TRIANGLES));
        }
        let lists = [(&threes, 3, Self::TRIANGLES), (&fours, 4, Self::QUADS)];
        for (corners, each, field) in lists {
            if corners.len() % each != 0 {
                let what = if each == 3 { "triangles" } else { "quads" };
                let message = format!("{} corners make no {what}", corners.len());
                return Err(CallError::new("wrong-count", message)
                    .expected(format!("{each} corners for each"))
                    .found(format!("{} corners", corners.len()))
                    .in_field(field));
            }
            if let Some(at) = corners.iter().position(|v| *v == 0 || *v as usize > n) {
                let v = corners[at];
                return Err(CallError::new("out-of-range", format!("there is no vertex {v}"))
                    .expected(format!("a whole number from 1 to {n}"))
                    .found(v.to_string())
                    .in_field(field)
                    .in_item(at));
            }
        }
        let halves = |q: &[u32]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]].map(|t| t.map(|v| v - 1));
        let mut triangles: Vec<[u32; 3]> = fours.chunks(4).flat_map(halves).collect();
        triangles.extend(threes.chunks(3).map(|t| [t[0] - 1, t[1] - 1, t[2] - 1]));
        let mut body = TriangleBody::new(self.points, triangles);
        body.quads = fours.len() / 4;
        let own = &mut body.of_triangles;
        own.volume = self.volume.unwrap_or(own.volume);
        own.area = self.area.unwrap_or(own.area);
        own.centroid = self.centroid.unwrap_or(own.centroid);
        Ok(Value::Body(Arc::new(body)))
    }
}
