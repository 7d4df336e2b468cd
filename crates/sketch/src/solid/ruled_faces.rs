//! The round faces of a solid, as an implicit set of it needs them.

use crate::SketchSolid;
use crate::solid::curve::SmoothPiece;
use moldloft_num::{Real, Vec3};

/// A ruled face between an arc and a shifted, scaled copy of it: part of a cylinder, a cone or a
/// parabolic cylinder. Velocity x shift points out of the solid.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundFace<T> {
    /// The index of the face.
    pub face: usize,
    /// For an ellipse: centre, half-diameter to the start, and the conjugate one. For a parabola:
    /// start, intersection of the end tangents, end.
    pub profile: [Vec3<T>; 3],
    /// The angle of the arc in radians; 0 for a parabola.
    pub sweep: T,
    /// Displacement from the arc's centre or start to that of its copy.
    pub shift: Vec3<T>,
    /// Relative size of the copy: 1 for a cylinder, 0 for a cone that ends at its apex.
    pub scale: T,
}

/// Parts of a size below which two points are one.
const SAME: f64 = 1e-9;

impl<T: Real> SketchSolid<T> {
    /// The faces that are parts of cylinders and cones, without other ruled faces such as those
    /// between two cubics.
    pub fn rounds(&self) -> Vec<RoundFace<T>> {
        let ruled = self.faces.iter().enumerate().filter(|(_, f)| f.ruled);
        ruled.filter_map(|(k, f)| self.round(k, &f.loops[0])).collect()
    }

    fn round(&self, face: usize, cycle: &[(usize, bool)]) -> Option<RoundFace<T>> {
        let (profile, sweep) = profile(&self.piece(*cycle.first()?))?;
        let (shift, scale) = match *cycle {
            // Run against its direction in the cycle, it starts where the first edge starts.
            [_, _, far, _] => copy(&profile, sweep, &self.piece(far).reversed())?,
            [_, out, _] => {
                let apex = self.vertices[self.edges[out.0].ends[usize::from(out.1)]].at;
                (apex - profile[0], T::zero())
            }
            _ => return None,
        };
        Some(RoundFace { face, profile, sweep, shift, scale })
    }
}

/// A piece as part of an ellipse or a parabola.
fn profile<T: Real>(piece: &SmoothPiece<T>) -> Option<([Vec3<T>; 3], T)> {
    match *piece {
        SmoothPiece::Conic { centre, a, b, sweep } => Some(([centre, a, b], sweep)),
        SmoothPiece::Cubic([p, q, r, e]) => {
            // A quadratic, raised to a cubic, has its middle point on both end tangents.
            let (m, n) =
                ((q * T::from(3.0) - p) * T::from(0.5), (r * T::from(3.0) - e) * T::from(0.5));
            let size = p.re().distance(m.re()) + e.re().distance(m.re());
            let bent = (m - p).re().cross((e - p).re()).norm() > SAME * size * size;
            (m.re().distance(n.re()) <= SAME * size && bent).then(|| ([p, m, e], T::zero()))
        }
    }
}

/// Shift and scale of a copy.
fn copy<T: Real>([p, q, r]: &[Vec3<T>; 3], sweep: T, far: &SmoothPiece<T>) -> Option<(Vec3<T>, T)> {
    let ([u, v, w], other) = profile(far)?;
    if (sweep - other).re().abs() > SAME {
        return None;
    }
    // The scaled vectors: half-diameters, or displacements from the start.
    let parabola = sweep.re() == 0.0;
    let from = |x: Vec3<T>, o: Vec3<T>| if parabola { x - o } else { x };
    let ([a, b], [c, d]) = ([from(*q, *p), from(*r, *p)], [from(v, u), from(w, u)]);
    let scale = c.dot(a) / a.norm_sq();
    let size = a.re().norm() + b.re().norm();
    let fits = |x: Vec3<T>, y: Vec3<T>| x.re().distance((y * scale).re()) <= SAME * size;
    (fits(c, a) && fits(d, b) && scale.re() > 0.0).then(|| (u - *p, scale))
}
