//! Triangles between points, and their subdivision surfaces.

use indexmap::IndexMap;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Point, TriangleBody, Value};
use std::sync::Arc;

/// Triangles between points of the model: a body if they close, otherwise an open sheet.
///
/// `levels` times, each triangle is divided into four and the vertices move as in Loop's
/// subdivision surfaces (Loop 1987): smooth inside, cubic B-splines along open edges. The vertices
/// keep points of the model as parents: a moved point moves the sheet, with derivatives.
#[derive(Kind)]
#[kind(
    class = Mesh,
    columns = "points triangles levels",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(0, 0, 1); \
               TriMesh t({A, B, C, D}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); \
               TriMesh egg({A, B, C, D}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}, levels = 2);"
)]
pub struct TriMesh<T: Real> {
    /// The vertices.
    #[field(min_items = 3)]
    points: Vec<Point<T>>,
    /// Corners of the triangles as vertex numbers from 1, counter-clockwise from outside.
    #[field(min_items = 3)]
    triangles: Vec<u32>,
    /// Number of subdivisions.
    #[field(default = 0, max = 8)]
    levels: usize,
}

/// More triangles than this are refused.
const MOST_TRIANGLES: usize = 4_000_000;

/// Corners, from 0.
type Triangle = [u32; 3];

impl<T: Real> Build<T> for TriMesh<T> {
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
        if let Some(at) = self.triangles.iter().position(|v| *v == 0 || *v as usize > n) {
            let v = self.triangles[at];
            return Err(CallError::new("out-of-range", format!("there is no vertex {v}"))
                .expected(format!("a whole number from 1 to {n}"))
                .found(v.to_string())
                .in_field(Self::TRIANGLES)
                .in_item(at));
        }
        let mut triangles: Vec<Triangle> =
            self.triangles.chunks(3).map(|t| [t[0] - 1, t[1] - 1, t[2] - 1]).collect();
        let grown = triangles.len().checked_shl(2 * self.levels as u32);
        if grown.is_none_or(|grown| grown > MOST_TRIANGLES) {
            return Err(CallError::new("too-many-triangles", "there are too many triangles")
                .expected(format!("at most {MOST_TRIANGLES} after the last level"))
                .help("divide less often")
                .in_field(Self::LEVELS));
        }
        check(&triangles).map_err(|fault| fault.in_field(Self::TRIANGLES))?;
        let mut points: Vec<Vec3<T>> = self.points.iter().map(|p| p.xyz).collect();
        for _ in 0..self.levels {
            (points, triangles) = divided(&points, &triangles);
        }
        Ok(Value::Body(Arc::new(TriangleBody::new(points, triangles))))
    }
}

/// Refuses triangles without area and edges that are not between two alike triangles, or at the border of one.
fn check(triangles: &[Triangle]) -> Result<(), CallError> {
    let mut used: IndexMap<(u32, u32), usize> = IndexMap::with_capacity(3 * triangles.len());
    for (k, t) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            if a == b {
                return Err(CallError::new(
                    "repeated-corner",
                    format!("triangle {} has a corner twice", k + 1),
                )
                .expected("three different vertices")
                .found(format!("vertex {}", a + 1))
                .in_item(3 * k + i));
            }
            if let Some(first) = used.insert((a, b), k) {
                return Err(CallError::new(
                    "edge-used-twice",
                    format!(
                        "triangles {} and {} run along the edge {}, {} in the same direction",
                        first + 1,
                        k + 1,
                        a + 1,
                        b + 1
                    ),
                )
                .expected("at most two triangles at an edge, all counter-clockwise from one side")
                .help("turn one of them round: exchange two of its corners")
                .in_item(3 * k + i));
            }
        }
    }
    Ok(())
}

/// One step of Loop's scheme.
fn divided<T: Real>(points: &[Vec3<T>], triangles: &[Triangle]) -> (Vec<Vec3<T>>, Vec<Triangle>) {
    // Each edge by its ends, with the corners opposite to it.
    let mut edges: IndexMap<(u32, u32), Vec<u32>> = IndexMap::with_capacity(2 * triangles.len());
    for t in triangles {
        for i in 0..3 {
            let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push(c);
        }
    }
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    let mut border: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    for (&(a, b), opposite) in &edges {
        for (from, to) in [(a, b), (b, a)] {
            neighbours[from as usize].push(to);
            if opposite.len() == 1 {
                border[from as usize].push(to);
            }
        }
    }
    let at = |v: u32| points[v as usize];
    let sum = |all: &[u32]| all.iter().fold(Vec3::<T>::zero(), |sum, v| sum + at(*v));
    let mut moved: Vec<Vec3<T>> = (0..points.len())
        .map(|v| {
            let (p, n) = (points[v], neighbours[v].len());
            match border[v].len() {
                0 if n > 0 => {
                    let lean = 0.375 + 0.25 * Real::cos(2.0 * std::f64::consts::PI / n as f64);
                    let share = (0.625 - lean * lean) / n as f64;
                    p * T::from(1.0 - n as f64 * share) + sum(&neighbours[v]) * T::from(share)
                }
                2 => p * T::from(0.75) + sum(&border[v]) * T::from(0.125),
                // A vertex without triangles, or where several borders meet.
                _ => p,
            }
        })
        .collect();
    let first = points.len() as u32;
    for (&(a, b), opposite) in &edges {
        moved.push(match opposite[..] {
            [c, d] => (at(a) + at(b)) * T::from(0.375) + (at(c) + at(d)) * T::from(0.125),
            _ => (at(a) + at(b)) * T::from(0.5),
        });
    }
    let middle = |a: u32, b: u32| {
        first + edges.get_index_of(&(a.min(b), a.max(b))).expect("an edge of a triangle") as u32
    };
    let finer = triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        })
        .collect();
    (moved, finer)
}
