//! The figures of a body must be those of a closed surface.
//!
//! Over a closed surface the vector areas add up to nothing, and the volumes along x, y and z are one (the divergence
//! theorem). An edge that is not the same to the two faces beside it shows in both.

use super::SketchSolid;
use super::combine::CombineError;
use super::mass::MassIntegrals;
use moldloft_num::{Real, Vec3};

/// Tolerance of the sums over a closed surface, relative to the area and to the area times the
/// extent. Edges without a closed form are integrated to 1e-12 of their chords.
const CLOSED: f64 = 1e-11;

impl<T: Real> SketchSolid<T> {
    /// The body, if its figures are those of a closed surface. Plane faces close where their edges are shared.
    ///
    /// # Errors
    /// The face that closes worst.
    pub(super) fn balanced(self) -> Result<SketchSolid<T>, CombineError> {
        let round = self.faces.iter().any(|f| f.ruled || f.trim.is_some());
        if round && !self.flat && T::PARTS == 1 {
            self.closes(&self.integrals())?;
        }
        Ok(self)
    }

    /// Compares the integrals of the body with those of a closed surface, unless it is flat or has derivatives.
    ///
    /// # Errors
    /// The face that closes worst.
    pub(super) fn closes(&self, integrals: &MassIntegrals<T>) -> Result<(), CombineError> {
        if self.flat || T::PARTS > 1 {
            return Ok(());
        }
        let middle = self.middle();
        let extent = self.vertices.iter().map(|v| v.at.re().distance(middle)).fold(0.0, f64::max);
        let closed = integrals.gap(extent) <= CLOSED;
        if closed { Ok(()) } else { Err(CombineError::Unbalanced(self.worst_face())) }
    }

    /// A vertex of the trimmed face whose border, in its own parameters, is farthest from closed.
    fn worst_face(&self) -> Vec3 {
        let open = |f: usize| {
            let Some(surface) = self.surface(f) else { return 0.0 };
            let cycles = self.faces[f].loops.iter();
            let off = |c: &Vec<(usize, bool)>| -> f64 {
                self.cycle_places(f, &surface, c)
                    .iter()
                    .map(|place| place[2].re())
                    .sum::<f64>()
                    .abs()
            };
            cycles.map(off).fold(0.0, f64::max)
        };
        let worst = (0..self.faces.len()).max_by(|&f, &g| open(f).total_cmp(&open(g)));
        let edge = worst.and_then(|f| self.faces[f].loops.first()?.first().copied());
        edge.map_or(self.middle(), |h| self.vertices[self.edges[h.0].ends[0]].at.re())
    }
}
