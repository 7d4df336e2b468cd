//! A finished body as a boundary representation: its faces on the planes, cylinders, cones, spheres, tori and
//! extruded curves that they are parts of.

use super::SketchSolid;
use super::curve::SmoothPiece;
use super::edges::FaceForm;
use super::surface::FaceSurface;
use moldloft_brep::{
    Brep, ExtrudedCubic, FacetFault, FacetFaultKind, LabelledFacets, SurfaceAxes, SurfaceImage,
    SurfaceShape,
};
use moldloft_num::{Axis as Line, Vec3};

/// Reason why a body has no exact boundary representation.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeFault {
    /// A face is not a plane, cylinder, cone, sphere, torus or extruded curve: its name and a point on it.
    Surface(String, Vec3),
    /// An edge or corner is not found.
    Facets(FacetFault),
}

impl std::fmt::Display for ShapeFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (text, at) = match self {
            ShapeFault::Surface(name, at) => (
                format!("{name} is not a plane, cylinder, cone, sphere, torus or extruded curve"),
                at,
            ),
            ShapeFault::Facets(fault) => {
                let what = match fault.kind {
                    FacetFaultKind::NotClosed => "the faces round an edge are not in pairs",
                    FacetFaultKind::Seam => {
                        "a face closes around its axis, and no seam avoids its vertices"
                    }
                    FacetFaultKind::Edge => {
                        "faces meet or touch along an edge that could not be computed"
                    }
                    FacetFaultKind::Vertex => "faces meet in a corner that could not be computed",
                    FacetFaultKind::Surface => "a face is on no surface that such files hold",
                    FacetFaultKind::Patch => "no patch comes near enough to a face",
                    FacetFaultKind::Many => "a face takes too many patches",
                };
                let names = fault.surfaces.join(", ");
                let named = if names.is_empty() { String::new() } else { format!(" ({names})") };
                (format!("{what}{named}"), &fault.place)
            }
        };
        write!(f, "{text}, near {:.6} {:.6} {:.6}", at.x, at.y, at.z)
    }
}

impl SketchSolid<f64> {
    /// The surface of a face, if it is a plane, cylinder, cone, sphere, torus or extruded curve.
    pub fn face_shape(&self, face: usize) -> Option<SurfaceShape> {
        match (self.form(face), self.surface(face)) {
            (FaceForm::Plane { at, normal }, _) => {
                Some(SurfaceShape::Plane { origin: at, normal, axis: normal.perpendicular() })
            }
            (FaceForm::Straight(axis), Some(surface)) => straight_shape(&axis, &surface),
            (_, Some(FaceSurface::Turned { centre, axis, profile, .. })) => {
                turned_shape(&Line { point: centre, direction: axis }, &profile)
            }
            (_, Some(FaceSurface::Ruled { near, far })) => extruded_shape(&near, &far),
            _ => None,
        }
    }

    /// The body as faces of exact surfaces, each named by `name` and its own name.
    ///
    /// # Errors
    /// Faces of other surfaces; edges that are not found within `accuracy`.
    pub fn brep(
        &self,
        name: &str,
        colour: Option<[u8; 3]>,
        layers: &[String],
        accuracy: f64,
    ) -> Result<Brep, ShapeFault> {
        let mesh = self.faceted();
        let count = self.faces.len();
        let mut facets = LabelledFacets {
            positions: mesh.positions().to_vec(),
            triangles: Vec::new(),
            labels: Vec::new(),
            surfaces: Vec::with_capacity(count),
            names: Vec::with_capacity(count),
            colours: vec![colour; count],
            layers: vec![layers.to_vec(); count],
            step: 0.0,
            certain: true,
        };
        for f in 0..count {
            let own = match (self.faces[f].names.first(), self.faces[f].id) {
                (_, Some(id)) => format!("face {id}"),
                (Some(name), None) => format!("face {name}"),
                (None, None) => format!("patch {}", f + 1),
            };
            let at = self.faces[f].loops[0].first().map_or(Vec3::zero(), |&h| self.run(h)[0]);
            let shape = self.face_shape(f).ok_or_else(|| ShapeFault::Surface(own.clone(), at))?;
            facets.surfaces.push(Some(shape));
            facets.names.push(format!("{name}.{own}"));
        }
        let mut longest = 0.0f64;
        for (f, patch) in mesh.patches().iter().enumerate() {
            for &[a, b, c, d] in &mesh.faces()[patch.faces.clone()] {
                let halves = [Some([a, b, c]), (c != d).then_some([a, c, d])];
                facets.triangles.extend(halves.into_iter().flatten());
                facets.labels.extend(halves.into_iter().flatten().map(|_| f as u32));
            }
        }
        for edge in 0..self.edges.len() {
            if self.is_straight(edge) {
                continue;
            }
            let way = self.polyline(edge, 18);
            longest = way.windows(2).map(|w| w[0].distance(w[1])).fold(longest, f64::max);
        }
        let bounds = mesh.bounds();
        let size = bounds.diagonal();
        facets.step = if longest > 0.0 { longest } else { 0.05 * size };
        let mut brep = Brep::default();
        brep.add_facets(facets, accuracy, size).map_err(ShapeFault::Facets)?;
        Ok(brep)
    }
}

/// An elliptic cylinder, or one over a cubic.
fn extruded_shape(near: &SmoothPiece<f64>, far: &SmoothPiece<f64>) -> Option<SurfaceShape> {
    const SAME: f64 = 1e-12;
    match (near, far) {
        (SmoothPiece::Cubic(p), SmoothPiece::Cubic(q)) => {
            let along = q[0] - p[0];
            let size = along.norm() + p[0].distance(p[3]);
            let moved = |k: usize| (q[k] - p[k]).distance(along) <= SAME * size;
            let cubic = ExtrudedCubic::new(*p, along).filter(|_| (0..4).all(moved));
            cubic.map(|shape| SurfaceShape::Extruded(Box::new(shape)))
        }
        (
            SmoothPiece::Conic { centre, a, b, .. },
            SmoothPiece::Conic { centre: other, a: c, b: d, .. },
        ) => {
            let size = a.norm() + b.norm();
            let moved = a.distance(*c).max(b.distance(*d)) <= SAME * size;
            let z = Vec3::of(0.0, 0.0, 1.0);
            let axes = SurfaceAxes { origin: Vec3::zero(), z, x: Vec3::of(1.0, 0.0, 0.0) };
            let of = SurfaceShape::Cylinder { axes, radius: 1.0 };
            let image = SurfaceImage::new(of, *centre, [*a, *b, *other - *centre])?;
            moved.then(|| SurfaceShape::Image(Box::new(image)))
        }
        _ => None,
    }
}

/// A cylinder or cone.
fn straight_shape(axis: &Line<f64>, surface: &FaceSurface<f64>) -> Option<SurfaceShape> {
    let place = |v: f64| {
        let p = surface.jet(0.0, v)[0];
        let h = axis.direction.dot(p - axis.point);
        (h, p.distance(axis.foot(p)))
    };
    let ((h, r), (k, s)) = (place(0.0), place(1.0));
    if (r - s).abs() <= 1e-12 * (r + s) {
        let axes = SurfaceAxes::about(axis.point, axis.direction);
        return Some(SurfaceShape::Cylinder { axes, radius: 0.5 * (r + s) });
    }
    let slope = (s - r) / (k - h);
    let apex = axis.point + axis.direction * (h - r / slope);
    let wider = if slope > 0.0 { axis.direction } else { -axis.direction };
    let half_angle = libm::atan(slope.abs());
    Some(SurfaceShape::Cone { axes: SurfaceAxes::about(apex, wider), radius: 0.0, half_angle })
}

/// A sphere or torus.
fn turned_shape(axis: &Line<f64>, profile: &SmoothPiece<f64>) -> Option<SurfaceShape> {
    let SmoothPiece::Conic { centre, a, b, .. } = *profile else { return None };
    let minor = a.norm();
    let round =
        (minor - b.norm()).abs() <= 1e-10 * minor && a.dot(b).abs() <= 1e-10 * minor * minor;
    let foot = axis.foot(centre);
    let arm = centre - foot;
    let major = arm.norm();
    let normal = a.cross(b).normalized()?;
    // The circle is in a plane through the axis.
    let upright = normal.dot(axis.direction).abs() <= 1e-10
        && normal.dot(arm).abs() <= 1e-10 * (major + minor);
    if !round || !upright {
        return None;
    }
    let axes = SurfaceAxes::about(foot, axis.direction);
    if major <= 1e-10 * minor {
        return Some(SurfaceShape::Sphere { axes, radius: minor });
    }
    (minor < major).then_some(SurfaceShape::Torus { axes, major, minor })
}
