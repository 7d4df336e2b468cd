//! Boundary representations: vertices, edges with their curves, faces with their surfaces and
//! loops, shells and named parts. Two faces share an edge by its number.
//!
//! `faces of a model -> Brep -> encoders of CAD formats`
//!
//! A face's normal is that of its surface (S_u x S_v), or the opposite where the face is reversed, and points out of
//! the material; its outer loop runs counter-clockwise seen against it, its other loops clockwise.
//!
//! Invariant: this crate knows no entity, no file and no format.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod analytic;
mod check;
mod contacts;
mod crossing;
mod extruded;
mod foot;
mod image;
pub mod imported;
mod labelled;
mod meet;
mod patch;
mod patches;
mod seams;
mod surface_image;
mod untangle;
mod volume;
mod whole;

pub use analytic::SurfaceAxes;
pub use check::{Fault, ShellFacts};
pub use extruded::ExtrudedCubic;
pub use foot::foot;
pub use labelled::{FacetFault, FacetFaultKind, LabelledFacets};
pub use meet::{ExactCurve, meet};
pub use patch::SurfaceField;
pub use surface_image::SurfaceImage;
pub use volume::BrepVolume;

use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;

/// Vertices, edges, faces, and the parts made of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Brep {
    /// Positions of the vertices.
    pub vertices: Vec<Vec3>,
    /// The edges.
    pub edges: Vec<BrepEdge>,
    /// The faces.
    pub faces: Vec<BrepFace>,
    /// The parts.
    pub parts: Vec<Part>,
    /// Bound on the distance between edges, vertices and their surfaces.
    pub gap: f64,
    /// Bodies without faces on surfaces, as triangles.
    pub faceted: Vec<FacetedPart>,
}

/// An edge from a vertex to a vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepEdge {
    /// The vertices at its ends; one vertex twice for a closed edge.
    pub ends: [usize; 2],
    /// Its curve, from the first vertex at 0 to the second at 1.
    pub curve: Nurbs<1>,
    /// The ellipse that contains the curve, traversed by increasing angle, if there is one.
    pub ellipse: Option<ExactCurve>,
}

/// A part of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepFace {
    /// Its name.
    pub name: String,
    /// Its colour, sRGB.
    pub colour: Option<[u8; 3]>,
    /// The layers of the face.
    pub layers: Vec<String>,
    /// Its surface.
    pub surface: SurfaceShape,
    /// True when its normal is opposite to that of the surface.
    pub reversed: bool,
    /// Its loops, the outer one first.
    pub loops: Vec<Vec<Coedge>>,
    /// Bound on the distance between this surface and that of the model.
    pub error: f64,
    /// True when the surface is that of the model up to rounding.
    pub exact: bool,
    /// The box round a face of a set's body; the second value is true if the face bounds a cavity.
    pub extent: Option<([[f64; 3]; 2], bool)>,
}

/// A side of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Coedge {
    /// The edge.
    pub edge: usize,
    /// True when the loop runs from the edge's first vertex to its second.
    pub forward: bool,
    /// The same curve in the parameters (u, v, 0) of the surface, if known; planes have none.
    pub trace: Option<Nurbs<1>>,
    /// True when trace and edge agree at equal parameters.
    pub alike: bool,
}

/// The surface of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceShape {
    /// A plane.
    Plane {
        /// A point of it.
        origin: Vec3,
        /// Its unit normal.
        normal: Vec3,
        /// A unit vector in the plane.
        axis: Vec3,
    },
    /// A cylinder.
    Cylinder {
        /// Its axes.
        axes: SurfaceAxes,
        /// Its radius.
        radius: f64,
    },
    /// A cone.
    Cone {
        /// Its axes; the radius increases along z.
        axes: SurfaceAxes,
        /// Its radius at their origin.
        radius: f64,
        /// The angle between the axis and the cone.
        half_angle: f64,
    },
    /// A sphere.
    Sphere {
        /// Its axes, with the origin at its centre.
        axes: SurfaceAxes,
        /// Its radius.
        radius: f64,
    },
    /// A torus.
    Torus {
        /// Its axes, at its centre.
        axes: SurfaceAxes,
        /// The radius of the circle of centres.
        major: f64,
        /// The radius of the tube.
        minor: f64,
    },
    /// The affine image of one of these: an ellipsoid, an elliptic cylinder or a cone.
    Image(Box<SurfaceImage>),
    /// A cylinder over a plane cubic.
    Extruded(Box<ExtrudedCubic>),
    /// A NURBS.
    Nurbs(Box<Nurbs<2>>),
}

/// A body of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacetedPart {
    /// Its name.
    pub name: String,
    /// Its colour, sRGB.
    pub colour: Option<[u8; 3]>,
    /// The layers that it is on.
    pub layers: Vec<String>,
    /// Positions of the vertices.
    pub positions: Vec<Vec3>,
    /// The triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Distance of the centres of triangles from the surface, if known.
    pub error: Option<f64>,
}

/// A named thing: shells, or curves and points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Its shells.
    pub shells: Vec<Shell>,
    /// Curves that bound no face.
    pub wires: Vec<Wire>,
    /// Isolated points.
    pub points: Vec<PartPoint>,
}

/// A separate point.
#[derive(Clone, Debug, PartialEq)]
pub struct PartPoint {
    /// Its name.
    pub name: String,
    /// Its colour, sRGB.
    pub colour: Option<[u8; 3]>,
    /// Position.
    pub place: Vec3,
}

/// Connected faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shell {
    /// The faces.
    pub faces: Vec<usize>,
    /// True when each edge has two sides, of opposite senses: the shell bounds a solid.
    pub closed: bool,
    /// True for the border of a cavity in the solid of its part's closed shell before it.
    pub cavity: bool,
}

/// A curve that bounds no face.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// Its name.
    pub name: String,
    /// Its colour, sRGB.
    pub colour: Option<[u8; 3]>,
    /// The layers that it is on.
    pub layers: Vec<String>,
    /// The curve.
    pub curve: Nurbs<1>,
}

impl FacetedPart {
    /// True when each side belongs to two triangles that traverse it in opposite senses.
    pub fn closed(&self) -> bool {
        let mut sides = std::collections::HashSet::new();
        let all = self.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let once = all.into_iter().all(|side| sides.insert(side));
        once && sides.iter().all(|&(a, b)| sides.contains(&(b, a)))
    }
}

impl BrepEdge {
    /// A straight edge as a curve with constant speed.
    pub fn segment(a: Vec3, b: Vec3) -> Nurbs<1> {
        Nurbs {
            degrees: [1],
            knots: [vec![0.0, 0.0, 1.0, 1.0]],
            points: vec![a, b],
            weights: None,
            error: 0.0,
            exact: true,
            paces: [Pace::Even],
        }
    }
}

impl Brep {
    /// The largest error of its faces and wires.
    pub fn error(&self) -> f64 {
        let lines = self.parts.iter().flat_map(|part| &part.wires).map(|w| w.curve.error);
        self.faces.iter().map(|f| f.error).chain(lines).fold(0.0, f64::max)
    }

    /// The surface of a face as a NURBS; `None` for a plane.
    pub fn nurbs(&self, face: &BrepFace) -> Option<Nurbs<2>> {
        if let SurfaceShape::Nurbs(surface) = &face.surface {
            return Some((**surface).clone());
        }
        face.surface.nurbs(self.heights(face)?)
    }

    /// Least and greatest height of a face's edges along its axis, of an image in its coordinates.
    pub(crate) fn heights(&self, face: &BrepFace) -> Option<[f64; 2]> {
        let height: Box<dyn Fn(Vec3) -> f64> = match &face.surface {
            SurfaceShape::Image(image) => Box::new(|p| image.height(p)),
            SurfaceShape::Extruded(shape) => Box::new(|p| shape.height(p)),
            other => {
                let axes = *other.axes()?;
                Box::new(move |p| axes.local(p)[2])
            }
        };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for side in face.loops.iter().flatten() {
            for p in &self.edges[side.edge].curve.points {
                let h = height(*p);
                (low, high) = (low.min(h), high.max(h));
            }
        }
        Some([low, high])
    }

    /// Adds the vertices, edges and faces of another.
    pub fn append(&mut self, other: Self) {
        let (vertices, edges) = (self.vertices.len(), self.edges.len());
        self.vertices.extend(other.vertices);
        self.edges.extend(other.edges.into_iter().map(|mut edge| {
            edge.ends.iter_mut().for_each(|v| *v += vertices);
            edge
        }));
        self.faces.extend(other.faces.into_iter().map(|mut face| {
            face.loops.iter_mut().flatten().for_each(|side| side.edge += edges);
            face
        }));
        self.gap = self.gap.max(other.gap);
        self.faceted.extend(other.faceted);
    }

    /// The same shape without reversed faces, for formats whose faces have no sense: the surfaces
    /// of reversed faces are traversed backwards along u, as NURBS unless they are planes.
    pub fn facing(mut self) -> Self {
        for k in 0..self.faces.len() {
            if !self.faces[k].reversed {
                continue;
            }
            let made = self.nurbs(&self.faces[k]);
            let face = &mut self.faces[k];
            let known = matches!(face.surface, SurfaceShape::Nurbs(_));
            match (&mut face.surface, made) {
                (SurfaceShape::Plane { normal, .. }, _) => *normal = -*normal,
                (surface, Some(made)) => *surface = SurfaceShape::Nurbs(Box::new(backwards(made))),
                (_, None) => continue,
            }
            face.reversed = false;
            for side in face.loops.iter_mut().flatten() {
                // The parameters of other surfaces are not those of the NURBS.
                side.trace = side.trace.take().filter(|_| known);
                for p in side.trace.iter_mut().flat_map(|trace| &mut trace.points) {
                    p.x = 1.0 - p.x;
                }
            }
        }
        self
    }

    /// True when all faces are exact up to rounding.
    pub fn exact(&self) -> bool {
        self.faces.iter().all(|f| f.exact)
    }
}

/// A surface run backwards along u.
fn backwards(mut surface: Nurbs<2>) -> Nurbs<2> {
    let [nu, nv] = surface.counts();
    let order: Vec<usize> = (0..nu).rev().flat_map(|i| (0..nv).map(move |j| i * nv + j)).collect();
    surface.points = order.iter().map(|&k| surface.points[k]).collect();
    if let Some(weights) = &mut surface.weights {
        *weights = order.iter().map(|&k| weights[k]).collect();
    }
    surface.knots[0] = surface.knots[0].iter().rev().map(|k| 1.0 - k).collect();
    surface
}
