//! Bodies by their faces as sets.

use super::read::{fault, set};
use crate::shapes::Inside;
use crate::{FieldError, Primitive, Round, RoundProfile, Set, Sides, faced};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, TriangleBody, Value};
use std::sync::Arc;

/// The set of a closed body of plane faces: exact half-spaces, one per plane.
///
/// Coplanar triangles form a face. For bodies with thousands of faces, such as a triangulated ball,
/// use `set(inside(body))`. Coplanar faces share a half-space, even if a change of a parameter
/// would separate them.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "polyhedron",
    example = "MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); set s = polyhedron(b); assert abs(volume(s) - 1/6) < 1e-6;"
)]
pub struct Polyhedron<T: Real> {
    /// The body.
    body: Arc<TriangleBody<T>>,
}

impl<T: Real> Build<T> for Polyhedron<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (points, triangles) = (&self.body.points[..], &self.body.triangles[..]);
        set(faced(&Sides { points, triangles, sides: None, rounds: &[] }))
            .map_err(|f| f.in_field(Self::BODY))
    }
}

/// A closed body of plane and round faces as a set: half-spaces, cylinders and cones, all exact. The
/// `body` of a sketch is one.
///
/// A round face is ruled between an arc and a translated and scaled copy of it. Its five vectors
/// are, for an arc of an ellipse: centre; half-diameter to the start; conjugate half-diameter;
/// translation of the centre; {angle, scale, number of the face}. For a parabola: start;
/// intersection of the end tangents; end; translation; {0, scale, number of the face}. The scale is
/// 1 for cylinders and 0 for a cone whose apex is the translated centre. Velocity x translation
/// points outward.
///
/// With more than 200 faces, with too many intersections for a list of half-spaces, or with round
/// faces in contact, the set is defined by distances from the triangles.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    example = "MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); FaceSet s(b, {1, 2, 3, 4});"
)]
pub struct FaceSet<T: Real> {
    /// The body; the triangles of round faces are inscribed.
    body: Arc<TriangleBody<T>>,
    /// Face number of each triangle; by default the triangles of one plane are a face.
    #[field(default)]
    faces: Option<Vec<u32>>,
    /// The round faces, as five vectors each.
    #[field(default)]
    rounds: Option<Vec<Vec3<T>>>,
}

/// The most faces that a `FaceSet` divides space by: of more, a change would take longer than a moment.
const MOST: usize = 200;

impl<T: Real> Build<T> for FaceSet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (points, triangles) = (&self.body.points[..], &self.body.triangles[..]);
        if let Some(faces) = &self.faces
            && faces.len() != triangles.len()
        {
            let (n, m) = (faces.len(), triangles.len());
            return Err(CallError::new(
                "wrong-count",
                format!("{n} numbers of faces for {m} triangles"),
            )
            .expected(format!("{m} numbers, one for each triangle"))
            .found(n.to_string())
            .in_field(Self::FACES));
        }
        let vectors = self.rounds.unwrap_or_default();
        if !vectors.len().is_multiple_of(5) {
            let n = vectors.len();
            return Err(CallError::new(
                "wrong-count",
                format!("{n} vectors do not define round faces"),
            )
            .expected("five vectors for each")
            .found(n.to_string())
            .in_field(Self::ROUNDS));
        }
        let round = |(k, v): (usize, &[Vec3<T>])| {
            let (sweep, scale, side) = (v[4].x, v[4].y, v[4].z.re());
            let known = self.faces.as_ref().is_some_and(|f| f.contains(&(side as u32)));
            if side < 0.0 || side.fract() != 0.0 || !known {
                let text = format!("there is no face {side}");
                return Err(CallError::new("out-of-range", text)
                    .expected("the number of a face")
                    .found(side.to_string())
                    .in_field(Self::ROUNDS)
                    .in_item(5 * k + 4));
            }
            let profile = if sweep.re() == 0.0 {
                RoundProfile::Parabola([v[0], v[1], v[2]])
            } else {
                RoundProfile::Conic { centre: v[0], a: v[1], b: v[2], sweep }
            };
            Ok(Round { side: side as u32, profile, shift: v[3], scale })
        };
        let rounds: Vec<Round<T>> =
            vectors.chunks(5).enumerate().map(round).collect::<Result<_, _>>()?;
        let body = Sides { points, triangles, sides: self.faces.as_deref(), rounds: &rounds };
        let count = self.faces.as_ref().map_or(triangles.len(), |f| {
            let mut all = f.clone();
            all.sort_unstable();
            all.dedup();
            all.len()
        });
        let divided =
            if count > MOST { Err(FieldError::ManyFaces { most: MOST }) } else { faced(&body) };
        let made = match divided {
            Err(FieldError::ManyFaces { .. } | FieldError::RoundSides) => {
                let closed = Inside::new(self.body.clone());
                let closed = closed.map_err(|open| FieldError::NotClosed { edges: open.edges });
                closed.map(|inside| Set::new(&Primitive::user(Arc::new(inside))))
            }
            made => made,
        };
        let set = made.map_err(|e| fault(&e).in_field(Self::BODY))?;
        // Those of the triangles are too small where faces are round.
        let own = self.body.of_triangles;
        let cut = TriangleBody::new(points.to_vec(), triangles.to_vec()).of_triangles;
        let better = own.volume.re() != cut.volume.re() && own.area.re() != cut.area.re();
        Ok(crate::set_value(match better || rounds.is_empty() {
            true => set.measured(own.volume, own.area),
            false => set,
        }))
    }
}
