//! Bodies bounded by triangles and open sheets of them, with borders that can be divided again, and
//! their measures.

use crate::{CallError, CurveRef, DivisionDensity, SurfaceRef};
use moldloft_num::{Fineness, Real, Vec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Volume, relative to the area to the power 3/2, below which it is zero: the centroid is that of
/// the area.
const NO_VOLUME: f64 = 1e-12;

/// Positions at which a body violates its specification.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// Its kind, such as "blunt", which is the member of the body that returns the positions.
    pub name: &'static str,
    /// The warning about it.
    pub remark: crate::Remark,
    /// Positions; not empty.
    pub places: Vec<Vec3>,
}

/// Triangles of a body with a common origin, such as those of one implicit surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name, appended to that of the body in meshes.
    pub name: String,
    /// Kind of its surface, such as "cylinder".
    pub kind: String,
    /// Palette index of its colour, 0 to 15, if it has one.
    pub colour: Option<u8>,
    /// Further names, such as its material.
    pub tags: Vec<String>,
    /// Its tolerance, below which two points count as one, if it has one.
    pub tolerance: Option<f64>,
    /// Its triangles.
    pub triangles: Range<usize>,
}

/// A curve along the border of a sheet, from its beginning to its end.
#[derive(Clone, Debug)]
pub struct BorderCurve<T: Real> {
    /// The curve.
    pub curve: CurveRef<T>,
    /// Its divisions, if stated.
    pub stated: Option<u32>,
    /// Its default divisions.
    pub usual: u32,
    /// Spacing of divisions along it; `None` for equal steps of its parameter.
    pub density: Option<Arc<DivisionDensity>>,
}

impl<T: Real> BorderCurve<T> {
    /// The parameters of its default divisions, from 0 to 1.
    pub fn divisions(&self) -> Vec<f64> {
        let even = || (0..=self.usual).map(|k| f64::from(k) / f64::from(self.usual)).collect();
        self.density.as_ref().map_or_else(even, |density| {
            let shares = density.shares(0.0, 1.0, self.usual);
            std::iter::once(0.0).chain(shares).chain([1.0]).collect()
        })
    }
}

/// A sheet of triangles bounded by curves, which can be triangulated again with its neighbours'
/// divisions.
pub trait TriangulatedBorder<T: Real>: Send + Sync {
    /// The surface that it is a part of.
    fn surface(&self) -> &SurfaceRef<T>;

    /// The curves of the border.
    fn curves(&self) -> &[BorderCurve<T>];

    /// The curves of each loop in order, the outer loop first, each with true when the loop
    /// traverses it backwards.
    fn cycles(&self) -> &[Vec<(usize, bool)>];

    /// The sheet whose border has vertices at these parameters of each curve, ascending from 0 to 1,
    /// and for each curve which of its vertices these are; `None` when such a border crosses itself.
    fn divided(&self, at: &[Vec<T>]) -> Option<(TriangleBody<T>, Vec<Vec<u32>>)>;

    /// The measures of the part of the surface itself, which its triangles only come near.
    fn measures(&self) -> Option<SheetMeasures<T>>;

    /// Maximum relative difference of area between the triangles and the part of the surface, where divisions
    /// are not stated; `None` where they are.
    fn promised(&self) -> Option<f64>;

    /// The border with triangles as near to the surface as this, in place of stated divisions.
    ///
    /// # Errors
    /// When that takes too many triangles.
    fn within(&self, fineness: &Fineness) -> Result<Border<T>, CallError>;
}

/// Measures of a body, or of a part of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetMeasures<T: Real> {
    /// Its area.
    pub area: T,
    /// Centroid of the volume, or of the area if no volume is enclosed.
    pub centroid: Vec3<T>,
    /// The enclosed volume; for a part of a surface, the volume of the cone from the origin to it.
    pub volume: T,
}

/// Access to a sheet's triangulation.
#[derive(Clone)]
pub struct Border<T: Real>(pub Arc<dyn TriangulatedBorder<T>>);

impl<T: Real> PartialEq for Border<T> {
    fn eq(&self, o: &Self) -> bool {
        Arc::ptr_eq(&self.0, &o.0)
    }
}

impl<T: Real> std::fmt::Debug for Border<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_list().entries(self.0.curves()).finish()
    }
}

/// A body bounded by triangles, or an open sheet of them, with its measures.
///
/// For implicit modelling it is the closed mesh from which a set can be made.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleBody<T: Real> {
    /// The vertices.
    pub points: Vec<Vec3<T>>,
    /// Corners of the triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Number of quadrilateral panels: their halves a b c and a c d are the first triangles.
    pub quads: usize,
    /// The triangles grouped by surface, in order and without gaps; empty if the body is one
    /// surface.
    pub groups: Vec<Group>,
    /// Polylines of the body that are not part of its surface.
    pub wires: Vec<Vec<Vec3<T>>>,
    /// Points of the body that are on neither surface nor line.
    pub dots: Vec<Vec3<T>>,
    /// Measures of the triangles, or more accurate ones given by the maker of the body; use
    /// [`Self::measures`].
    pub of_triangles: SheetMeasures<T>,
    /// For a sheet that is joined to its neighbours.
    pub border: Option<Border<T>>,
    /// Deviations from the specification.
    pub flaws: Vec<Flaw>,
}

impl<T: Real> TriangleBody<T> {
    /// The body with the measures of its triangles (divergence theorem, relative to the mean of the
    /// vertices, so that distant bodies lose no digits).
    ///
    /// # Panics
    /// When a corner is not a vertex.
    pub fn new(points: Vec<Vec3<T>>, triangles: Vec<[u32; 3]>) -> Self {
        let n = points.len().max(1) as f64;
        let middle = points.iter().fold(Vec3::<f64>::zero(), |s, p| s + p.re()) / n;
        let middle = middle.map(T::from);
        let (mut volume, mut area) = (T::zero(), T::zero());
        let (mut moment, mut sheet) = (Vec3::zero(), Vec3::zero());
        for t in &triangles {
            let [a, b, c] = t.map(|v| points[v as usize] - middle);
            let normal = (b - a).cross(c - a) * T::from(0.5);
            let part = a.dot(normal) / 3.0;
            volume += part;
            moment += (a + b + c) * (part * 0.25);
            let size = normal.norm();
            area += size;
            sheet += (a + b + c) * (size / 3.0);
        }
        let size = area.re() * area.re().abs().sqrt();
        let centroid = if volume.re().abs() > NO_VOLUME * size {
            middle + moment / volume
        } else if area.re() > 0.0 {
            middle + sheet / area
        } else {
            middle
        };
        let (groups, wires, dots) = Default::default();
        let (border, flaws) = (None, Vec::new());
        let of_triangles = SheetMeasures { area, centroid, volume };
        let quads = 0;
        Self { points, triangles, quads, groups, wires, dots, of_triangles, border, flaws }
    }

    /// Area, centroid and volume: of the part of a surface that a sheet with a border represents,
    /// otherwise of the body. `None` if some position on the surface is not finite.
    pub fn measures(&self) -> Option<SheetMeasures<T>> {
        match &self.border {
            Some(border) => border.0.measures(),
            None => Some(self.of_triangles),
        }
    }

    /// True when every edge is used equally often in both directions, so that a volume is enclosed.
    pub fn is_closed(&self) -> bool {
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        for t in &self.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        !edges.is_empty() && edges.values().all(|n| *n == 0)
    }

    /// True when the triangles are the same, and vertices and measures are equal to the bit.
    pub fn same(&self, o: &Self) -> bool {
        let all = |a: &[Vec3<T>], b: &[Vec3<T>]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.bits_eq(*b))
        };
        self.triangles == o.triangles
            && self.quads == o.quads
            && self.groups == o.groups
            && self.flaws == o.flaws
            && all(&self.dots, &o.dots)
            && self.wires.len() == o.wires.len()
            && self.wires.iter().zip(&o.wires).all(|(a, b)| all(a, b))
            && self.points.len() == o.points.len()
            && self.points.iter().zip(&o.points).all(|(a, b)| a.bits_eq(*b))
            && self.of_triangles.volume.bits_eq(o.of_triangles.volume)
            && self.of_triangles.area.bits_eq(o.of_triangles.area)
            && self.of_triangles.centroid.bits_eq(o.of_triangles.centroid)
            && self.border == o.border
    }

    /// True when every number in it is finite.
    pub fn is_finite(&self) -> bool {
        self.points.iter().all(|p| p.is_finite()) && self.of_triangles.volume.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distant_tetrahedron() {
        let far = Vec3::of(1e6, -2e6, 3e6);
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let points: Vec<Vec3> = points.iter().map(|&p| Vec3::from(p) + far).collect();
        let body = TriangleBody::new(points, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert!(body.is_closed());
        let m = body.measures().unwrap();
        assert!((m.volume - 1.0 / 6.0).abs() < 1e-9);
        assert!((m.area - (1.5 + 0.75f64.sqrt())).abs() < 1e-9);
        assert!((m.centroid - far).distance(Vec3::of(0.25, 0.25, 0.25)) < 1e-6);
        let sheet = TriangleBody::new(body.points[..3].to_vec(), vec![[0, 1, 2]]);
        assert!(!sheet.is_closed());
        assert!(
            (sheet.of_triangles.centroid - far).distance(Vec3::of(1.0 / 3.0, 1.0 / 3.0, 0.0))
                < 1e-6
        );
    }
}
