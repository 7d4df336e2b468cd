//! Images of planes, cylinders, cones, spheres and tori under affine maps: ellipsoids, elliptic cylinders and cones.
//!
//! `point -> coordinates in which the surface is a round one -> distance, normal, control points -> back`

use crate::SurfaceShape;
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;

/// The image of a surface: the point with coordinates (x, y, z) is mapped to `centre` + x X + y Y +
/// z Z.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceImage {
    of: SurfaceShape,
    /// The image of the origin.
    centre: Vec3,
    /// X, Y and Z, right-handed.
    columns: [Vec3; 3],
    /// The rows of the inverse matrix.
    rows: [Vec3; 3],
}

impl SurfaceImage {
    /// The image; `None` if X, Y and Z are dependent, left-handed or not finite.
    pub fn new(of: SurfaceShape, centre: Vec3, columns: [Vec3; 3]) -> Option<Self> {
        let [x, y, z] = columns;
        let det = x.dot(y.cross(z));
        let least = 1e-12 * x.norm() * y.norm() * z.norm();
        if !(det > least && det.is_finite() && centre.is_finite()) {
            return None;
        }
        let rows = [y.cross(z), z.cross(x), x.cross(y)].map(|row| row / det);
        Some(Self { of, centre, columns, rows })
    }

    /// The surface of which this is the image.
    pub fn of(&self) -> &SurfaceShape {
        &self.of
    }

    /// Factor of volumes.
    pub fn volume_scale(&self) -> f64 {
        self.columns[0].dot(self.columns[1].cross(self.columns[2]))
    }

    /// Mean factor of lengths.
    pub fn scale(&self) -> f64 {
        libm::cbrt(self.volume_scale())
    }

    /// The image of another surface under the same map.
    pub fn with(&self, of: SurfaceShape) -> Self {
        Self { of, ..self.clone() }
    }

    /// The coordinates of a point.
    pub fn local(&self, p: Vec3) -> Vec3 {
        let d = p - self.centre;
        Vec3::from(self.rows.map(|row| row.dot(d)))
    }

    /// The point of coordinates.
    pub fn world(&self, q: Vec3) -> Vec3 {
        self.centre + self.linear(q)
    }

    /// The image of a vector.
    pub fn linear(&self, v: Vec3) -> Vec3 {
        self.columns[0] * v.x + self.columns[1] * v.y + self.columns[2] * v.z
    }

    /// The vector with this image.
    pub fn linear_back(&self, v: Vec3) -> Vec3 {
        Vec3::from(self.rows.map(|row| row.dot(v)))
    }

    /// The gradient of a function in space, from its gradient in the surface's coordinates.
    pub fn gradient(&self, g: Vec3) -> Vec3 {
        self.rows[0] * g.x + self.rows[1] * g.y + self.rows[2] * g.z
    }

    /// The unit normal of a plane in the surface's coordinates, from its normal in space.
    pub fn normal_back(&self, n: Vec3) -> Option<Vec3> {
        Vec3::from(self.columns.map(|column| column.dot(n))).normalized()
    }

    /// The distance from the surface, to first order.
    pub fn distance(&self, p: Vec3) -> Option<f64> {
        let q = self.local(p);
        let steep = self.gradient(self.of.normal(q)).norm();
        self.of.distance(q).map(|d| d / steep)
    }

    /// The unit normal at points of the surface.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let g = self.gradient(self.of.normal(self.local(p)));
        g.normalized().unwrap_or(self.columns[2])
    }

    /// The image of the apex of a cone.
    pub fn apex(&self) -> Option<Vec3> {
        self.of.apex().map(|q| self.world(q))
    }

    /// The control points of the part between two heights along the axis of the surface.
    pub fn nurbs(&self, heights: [f64; 2]) -> Option<Nurbs<2>> {
        let mut made = self.of.nurbs(heights)?;
        made.points.iter_mut().for_each(|q| *q = self.world(*q));
        Some(made)
    }

    /// The same ellipsoid as the image of a sphere with its axis along another coordinate; `None`
    /// for other surfaces.
    pub fn about(&self, z: Vec3) -> Option<SurfaceShape> {
        let SurfaceShape::Sphere { axes, radius } = &self.of else { return None };
        let axes = crate::SurfaceAxes::about(axes.origin, z);
        let of = SurfaceShape::Sphere { axes, radius: *radius };
        Some(SurfaceShape::Image(Box::new(self.with(of))))
    }

    /// The height of a point along the axis of the surface.
    pub fn height(&self, p: Vec3) -> f64 {
        let q = self.local(p);
        self.of.axes().map_or(q.z, |axes| axes.local(q)[2])
    }

    /// The image in the plane on which a coordinate is zero.
    pub fn mirrored(&self, flip: impl Fn(Vec3) -> Vec3) -> Self {
        // Keeps the axes right-handed: the second axis is reversed, that of the surface too.
        let back = |q: Vec3| Vec3::of(q.x, -q.y, q.z);
        let of = self.of.axes().map_or_else(
            || self.of.clone(),
            |a| {
                self.of.with_axes(crate::SurfaceAxes {
                    origin: back(a.origin),
                    z: back(a.z),
                    x: back(a.x),
                })
            },
        );
        let [x, y, z] = self.columns.map(&flip);
        let [r, s, t] = self.rows.map(&flip);
        Self { of, centre: flip(self.centre), columns: [x, -y, z], rows: [r, -s, t] }
    }

    /// True for the same set of points: the points that distinguish two quadrics are on both.
    pub fn is_same(&self, o: &Self, tolerance: f64) -> bool {
        let on = |a: &Self, b: &Self| {
            a.samples().is_some_and(|all| {
                all.iter().all(|p| b.distance(*p).is_some_and(|d| d.abs() <= tolerance))
            })
        };
        std::mem::discriminant(&self.of) == std::mem::discriminant(&o.of)
            && on(self, o)
            && on(o, self)
    }

    fn samples(&self) -> Option<Vec<Vec3>> {
        let surface = self.of.nurbs([0.25, 1.0])?;
        let ts: Vec<f64> = (0..7).map(|k| 0.03 + 0.15 * f64::from(k)).collect();
        Some(surface.grid(&[ts.clone(), ts]).into_iter().map(|q| self.world(q)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Brep, LabelledFacets, SurfaceAxes};
    use std::f64::consts::{FRAC_PI_4, PI, TAU};

    fn unit() -> SurfaceAxes {
        SurfaceAxes { origin: Vec3::zero(), z: Vec3::of(0.0, 0.0, 1.0), x: Vec3::of(1.0, 0.0, 0.0) }
    }

    /// An affine map with lengths 2, 0.7 and 1.3 along turned axes.
    fn map(of: SurfaceShape) -> SurfaceImage {
        let x = Vec3::of(0.36, 0.48, 0.8);
        let y = Vec3::of(-0.8, 0.6, 0.0);
        let columns = [x * 2.0, y * 0.7, x.cross(y) * 1.3];
        SurfaceImage::new(of, Vec3::of(5.0, -3.0, 2.0), columns).unwrap()
    }

    /// Triangles of a profile (radius, height) about z, from axis to axis, with the label of each of its sides; mapped.
    fn facets(
        profile: &[[f64; 2]],
        labels: &[u32],
        surfaces: Vec<SurfaceShape>,
        image: &SurfaceImage,
    ) -> LabelledFacets {
        const ROUND: usize = 40;
        let (mut positions, mut rings) = (Vec::new(), Vec::new());
        for [r, h] in profile {
            let mut ring = Vec::new();
            for k in 0..ROUND {
                if k == 0 || *r > 0.0 {
                    let (s, c) = libm::sincos(TAU * (k as f64 + 0.37) / ROUND as f64);
                    positions.push(image.world(Vec3::of(r * c, r * s, *h)));
                }
                ring.push(positions.len() as u32 - 1);
            }
            rings.push(ring);
        }
        let (mut triangles, mut of) = (Vec::new(), Vec::new());
        for i in 0..profile.len() - 1 {
            for k in 0..ROUND {
                let j = (k + 1) % ROUND;
                let [a, b, c, d] = [rings[i][k], rings[i][j], rings[i + 1][j], rings[i + 1][k]];
                for t in [[a, b, c], [a, c, d]] {
                    if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                        triangles.push(t);
                        of.push(labels[i]);
                    }
                }
            }
        }
        let n = surfaces.len();
        LabelledFacets {
            positions,
            triangles,
            labels: of,
            surfaces: surfaces.into_iter().map(Some).collect(),
            names: (0..n).map(|k| format!("face {k}")).collect(),
            colours: vec![None; n],
            layers: vec![Vec::new(); n],
            step: 0.3,
            certain: true,
        }
    }

    fn plane(image: &SurfaceImage, height: f64) -> SurfaceShape {
        let normal = image.gradient(Vec3::of(0.0, 0.0, 1.0)).normalized().unwrap();
        let origin = image.world(Vec3::of(0.1, 0.2, height));
        SurfaceShape::Plane { origin, normal, axis: normal.perpendicular() }
    }

    fn made(facets: LabelledFacets) -> Brep {
        let mut brep = Brep::default();
        brep.add_facets(facets, 1e-6, 5.0).unwrap();
        brep
    }

    /// All corners of edges and points of surfaces are on the images.
    fn check(brep: &Brep, volume: f64, faces: usize) {
        assert_eq!(brep.faces.len(), faces);
        let found = brep.volume().unwrap();
        assert!((found.volume - volume).abs() < 1e-7 * volume, "{} {volume}", found.volume);
        for face in &brep.faces {
            for side in face.loops.iter().flatten() {
                let ts: Vec<f64> = (0..=10).map(|k| f64::from(k) / 10.0).collect();
                for p in brep.edges[side.edge].curve.grid(&[ts]) {
                    assert!(face.surface.distance(p).unwrap().abs() < 1e-6);
                }
            }
            if let (SurfaceShape::Image(image), Some(n)) = (&face.surface, brep.nurbs(face)) {
                let ts: Vec<f64> = (0..=8).map(|k| f64::from(k) / 8.0).collect();
                for p in n.grid(&[ts.clone(), ts]) {
                    assert!(image.distance(p).unwrap().abs() < 1e-12);
                }
            }
        }
    }

    fn arc(from: f64, to: f64) -> Vec<[f64; 2]> {
        let at = |k: i32| from + (to - from) * f64::from(k) / 20.0;
        (0..=20).map(|k| [libm::cos(at(k)).max(0.0), libm::sin(at(k))]).collect()
    }

    #[test]
    fn a_whole_ellipsoid_is_a_face_with_a_seam() {
        let image = map(SurfaceShape::Sphere { axes: unit(), radius: 1.0 });
        let mut profile = arc(-0.5 * PI, 0.5 * PI);
        (profile[0][0], profile[20][0]) = (0.0, 0.0);
        let surface = SurfaceShape::Image(Box::new(image.clone()));
        let brep = made(facets(&profile, &[0; 20], vec![surface], &image));
        check(&brep, 4.0 / 3.0 * PI * image.volume_scale(), 1);
        let both = brep.with_image(1);
        assert_eq!(both.faces.len(), 2);
        let sum = both.volume().unwrap().volume;
        assert!((sum - 8.0 / 3.0 * PI * image.volume_scale()).abs() < 1e-6);
    }

    #[test]
    fn parts_of_images_end_in_ellipses() {
        let sphere = map(SurfaceShape::Sphere { axes: unit(), radius: 1.0 });
        let top = 0.3f64;
        let mut profile = arc(-0.5 * PI, libm::asin(top));
        profile[0][0] = 0.0;
        profile.push([0.0, top]);
        let mut labels = vec![0; 20];
        labels.push(1);
        let surfaces = vec![SurfaceShape::Image(Box::new(sphere.clone())), plane(&sphere, top)];
        let brep = made(facets(&profile, &labels, surfaces, &sphere));
        let segment = PI * (1.0 + top) * (1.0 + top) * (2.0 - top) / 3.0;
        check(&brep, segment * sphere.volume_scale(), 2);
        assert!(brep.edges.iter().any(|e| e.ellipse.is_some()));

        let round = map(SurfaceShape::Cylinder { axes: unit(), radius: 1.0 });
        let profile = [[0.0, -0.5], [1.0, -0.5], [1.0, -0.1], [1.0, 0.4], [1.0, 0.9], [0.0, 0.9]];
        let surfaces = vec![
            plane(&round, -0.5),
            SurfaceShape::Image(Box::new(round.clone())),
            plane(&round, 0.9),
        ];
        let brep = made(facets(&profile, &[0, 1, 1, 1, 2], surfaces, &round));
        check(&brep, 1.4 * PI * round.volume_scale(), 3);

        let cone = map(SurfaceShape::Cone { axes: unit(), radius: 0.0, half_angle: FRAC_PI_4 });
        for down in [1.0, -1.0] {
            let mut profile = vec![[0.0, 0.0], [0.4, 0.4], [0.8, 0.8], [0.0, 0.8]];
            let mut labels = vec![0, 0, 1];
            profile.iter_mut().for_each(|p| p[1] *= down);
            if down < 0.0 {
                profile.reverse();
                labels.reverse();
            }
            let surfaces =
                vec![SurfaceShape::Image(Box::new(cone.clone())), plane(&cone, 0.8 * down)];
            let brep = made(facets(&profile, &labels, surfaces, &cone));
            check(&brep, PI * 0.8f64.powi(3) / 3.0 * cone.volume_scale(), 2);
        }
    }

    #[test]
    fn spheroids_touch_cylinders_in_circles() {
        let along = Vec3::of(0.6, 0.0, 0.8);
        let side = along.perpendicular();
        let at = Vec3::of(1.0, 2.0, 3.0);
        let spheroid = |long: f64, at: Vec3| {
            let of = SurfaceShape::Sphere { axes: unit(), radius: 1.0 };
            let columns = [along * long, side * 1.5, along.cross(side) * 1.5];
            SurfaceShape::Image(Box::new(SurfaceImage::new(of, at, columns).unwrap()))
        };
        let cylinder = SurfaceShape::Cylinder { axes: SurfaceAxes::about(at, along), radius: 1.5 };
        let touches = |found: Vec<crate::ExactCurve>, centre: Vec3| {
            assert_eq!(found.len(), 1);
            let crate::ExactCurve::Ellipse { centre: c, x, y } = found[0] else { panic!() };
            assert!(c.distance(centre) < 1e-7);
            assert!((x.norm() - 1.5).abs() + (y.norm() - 1.5).abs() + x.dot(along).abs() < 1e-7);
        };
        touches(crate::meet(&spheroid(4.0, at), &cylinder, 1e-9, 10.0), at);
        touches(crate::meet(&cylinder, &spheroid(0.7, at + along), 1e-9, 10.0), at + along);
        touches(crate::meet(&spheroid(4.0, at), &spheroid(2.0, at), 1e-9, 10.0), at);
        // They cross in two circles, or not at all.
        let smaller = SurfaceShape::Cylinder { axes: SurfaceAxes::about(at, along), radius: 1.2 };
        assert_eq!(crate::meet(&spheroid(4.0, at), &smaller, 1e-9, 10.0).len(), 2);
        let wider = SurfaceShape::Cylinder { axes: SurfaceAxes::about(at, along), radius: 1.6 };
        assert!(crate::meet(&spheroid(4.0, at), &wider, 1e-9, 10.0).is_empty());
    }
}
