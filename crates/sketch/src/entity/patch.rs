//! Faces as surfaces.

use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Jet, Real, SurfaceFormula, Vec3};
use moldloft_registry::{Build, CallError, Context, Kind, Point, SurfaceRef, Value};

/// A face given by its corners, as a surface for magnets, snakes and projections.
///
/// Four corners P1 to P4 make the bilinear patch with P1 at (0, 0), P2 at (1, 0), P3 at (1, 1) and P4
/// at (0, 1); with three, P3 is the whole side v = 1. More corners make the rectangle around them in
/// the plane of Newell's normal, u along the line from P1 to P2. The natural normal is that of corners
/// that run counter-clockwise.
#[derive(Kind)]
#[kind(
    forward,
    class = Surface,
    example = "FacePatch f({{0,0,0}, {4,0,0}, {4,3,0}, {0,3,1}});"
)]
pub struct FacePatch<T: Real> {
    /// The corners in order.
    #[field(min_items = 3)]
    corners: Vec<Point<T>>,
}

impl<T: Real> Build<T> for FacePatch<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let at: Vec<Vec3<T>> = self.corners.iter().map(|p| p.xyz).collect();
        let keys: Vec<Option<Key>> = self.corners.iter().map(|p| p.key).collect();
        let (corners, names) = match at[..] {
            [a, b, c] => ([a, b, c, c], [keys[0], keys[1], keys[2], keys[2]]),
            [a, b, c, d] => ([a, b, c, d], [keys[0], keys[1], keys[2], keys[3]]),
            _ => (around(&at)?, [None; 4]),
        };
        let pole = at.len() == 3;
        Ok(Value::Surface(SurfaceRef::new(Bilinear { corners, names, pole }, 0)))
    }
}

/// The rectangle around a polygon in its plane.
fn around<T: Real>(at: &[Vec3<T>]) -> Result<[Vec3<T>; 4], CallError> {
    let flat = || {
        CallError::new("no-plane", "the corners span no plane")
            .expected("corners of a plane polygon, the first two of them apart")
            .help("give corners that are not collinear")
            .in_field(FacePatch::<T>::CORNERS)
    };
    let n = at.len();
    let newell =
        (1..n - 1).fold(Vec3::zero(), |s: Vec3<T>, k| s + (at[k] - at[0]).cross(at[k + 1] - at[0]));
    let normal = newell.normalized().ok_or_else(flat)?;
    let along = at[1] - at[0];
    let x = (along - normal * along.dot(normal)).normalized().ok_or_else(flat)?;
    let y = normal.cross(x);
    let range = |d: Vec3<T>| {
        let places = at.iter().map(|p| (*p - at[0]).dot(d));
        let pick = |a: T, b: T, more: bool| if (b.re() > a.re()) == more { b } else { a };
        places.fold([T::zero(); 2], |[low, high], s| [pick(low, s, false), pick(high, s, true)])
    };
    let ([u0, u1], [v0, v1]) = (range(x), range(y));
    let corner = |u: T, v: T| at[0] + x * u + y * v;
    Ok([corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)])
}

struct Bilinear<T> {
    corners: [Vec3<T>; 4],
    names: [Option<Key>; 4],
    pole: bool,
}

impl<T: Real> SurfaceFormula for Bilinear<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let [a, b, c, d] = self.corners;
        let (r, s) = (-u + 1.0, -v + 1.0);
        let weighted = |p: Vec3<T>, w: J| p.map(|x| w.scaled(x));
        weighted(a, r * s) + weighted(b, u * s) + weighted(c, u * v) + weighted(d, r * v)
    }

    fn edges(&self) -> Edges<T> {
        let mut edges = Edges { corners: self.names, ..Edges::own() };
        if self.pole {
            edges.edges[2] = Edge::Pole(self.names[2]);
        }
        edges
    }

    moldloft_num::surface_facts!(smooth, open, not_rational);
}
