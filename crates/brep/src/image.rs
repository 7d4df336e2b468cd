//! Mirror images of boundary representations in coordinate planes, sewn to their originals there.

use crate::{Brep, BrepEdge, BrepFace, ExactCurve, FacetedPart, SurfaceAxes, SurfaceShape};
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;

/// Coordinates, relative to the size, below which a point is in the plane.
const IN_PLANE: f64 = 1e-9;

fn mirrored(p: Vec3, axis: usize) -> Vec3 {
    let mut xyz = p.to_array();
    xyz[axis] = 0.0 - xyz[axis];
    xyz.into()
}

fn image<const D: usize>(shape: &Nurbs<D>, axis: usize) -> Nurbs<D> {
    let points = shape.points.iter().map(|&p| mirrored(p, axis)).collect();
    Nurbs { points, ..shape.clone() }
}

/// True for a face in the plane on which the coordinate `axis` is zero.
fn flat(face: &BrepFace, axis: usize, near: f64) -> bool {
    match &face.surface {
        SurfaceShape::Plane { origin, normal, .. } => {
            origin[axis].abs() <= near && (normal[axis].abs() - 1.0).abs() < 1e-12
        }
        SurfaceShape::Nurbs(n) => n.points.iter().all(|p| p[axis].abs() <= near),
        _ => false,
    }
}

impl FacetedPart {
    /// Adds the image: vertices in the plane are shared, triangles that close a half there are left out.
    fn add_image(&mut self, axis: usize) {
        let most = |p: &Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let near = IN_PLANE * self.positions.iter().map(most).fold(0.0, f64::max);
        let level: Vec<bool> = self.positions.iter().map(|p| p[axis].abs() <= near).collect();
        self.triangles.retain(|t| !t.iter().all(|v| level[*v as usize]));
        let twin: Vec<u32> = (0..level.len())
            .map(|v| {
                if level[v] {
                    return v as u32;
                }
                self.positions.push(mirrored(self.positions[v], axis));
                self.positions.len() as u32 - 1
            })
            .collect();
        let images = self.triangles.iter().map(|&[a, b, c]| [c, b, a].map(|v| twin[v as usize]));
        let images: Vec<[u32; 3]> = images.collect();
        self.triangles.extend(images);
    }
}

impl Brep {
    /// The faces and their images in the plane on which the coordinate `axis` is zero: vertices and edges in that
    /// plane are shared. Shells and parts are not made; see [`Brep::shells`].
    pub fn with_image(mut self, axis: usize) -> Self {
        let most = |p: &Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let size = self.vertices.iter().map(most).fold(0.0, f64::max);
        let near = IN_PLANE * size;
        // Faces in the plane that close a half are inside the whole.
        let mut closing = vec![false; self.faces.len()];
        for shell in self.shells().iter().filter(|s| s.closed) {
            for &f in &shell.faces {
                closing[f] = flat(&self.faces[f], axis, near);
            }
        }
        let mut closing = closing.into_iter();
        self.faces.retain(|_| closing.next() != Some(true));
        let count = self.vertices.len();
        let mut twin: Vec<usize> = (0..count).collect();
        for v in 0..count {
            let p = &mut self.vertices[v];
            if p[axis].abs() <= near {
                let mut xyz = p.to_array();
                xyz[axis] = 0.0;
                *p = xyz.into();
            } else {
                let p = mirrored(*p, axis);
                twin[v] = self.vertices.len();
                self.vertices.push(p);
            }
        }
        let edges = self.edges.len();
        let mut other: Vec<usize> = (0..edges).collect();
        for e in 0..edges {
            let edge = &self.edges[e];
            if edge.curve.points.iter().all(|p| p[axis].abs() <= near) {
                continue;
            }
            let ends = edge.ends.map(|v| twin[v]);
            let curve = image(&edge.curve, axis);
            other[e] = self.edges.len();
            let ellipse = edge.ellipse.map(|curve| match curve {
                ExactCurve::Ellipse { centre, x, y } => ExactCurve::Ellipse {
                    centre: mirrored(centre, axis),
                    x: mirrored(x, axis),
                    y: mirrored(y, axis),
                },
                other => other,
            });
            self.edges.push(BrepEdge { ends, curve, ellipse });
        }
        for f in 0..self.faces.len() {
            let mut face = self.faces[f].clone();
            if flat(&face, axis, near) {
                // It is its own image.
                continue;
            }
            face.surface = match face.surface {
                SurfaceShape::Plane { origin, normal, axis: along } => SurfaceShape::Plane {
                    origin: mirrored(origin, axis),
                    normal: mirrored(normal, axis),
                    axis: mirrored(along, axis),
                },
                SurfaceShape::Nurbs(n) => {
                    // The image's S_u x S_v is opposite to the image of the normal.
                    face.reversed = !face.reversed;
                    SurfaceShape::Nurbs(Box::new(image(&n, axis)))
                }
                SurfaceShape::Image(image) => {
                    SurfaceShape::Image(Box::new(image.mirrored(|p| mirrored(p, axis))))
                }
                SurfaceShape::Extruded(shape) => {
                    SurfaceShape::Extruded(Box::new(shape.mirrored(|p| mirrored(p, axis))))
                }
                // Their normals follow from their axes, as those of images do.
                round => {
                    let made = round.axes().map(|a| {
                        round.with_axes(SurfaceAxes {
                            origin: mirrored(a.origin, axis),
                            z: mirrored(a.z, axis),
                            x: mirrored(a.x, axis),
                        })
                    });
                    made.unwrap_or(round)
                }
            };
            if let Some(([low, high], _)) = &mut face.extent {
                (low[axis], high[axis]) = (-high[axis], -low[axis]);
            }
            for cycle in &mut face.loops {
                for side in cycle.iter_mut() {
                    side.edge = other[side.edge];
                    side.forward = !side.forward;
                }
                cycle.reverse();
            }
            self.faces.push(face);
        }
        for part in &mut self.faceted {
            part.add_image(axis);
        }
        self
    }
}
