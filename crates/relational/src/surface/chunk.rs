//! The inner loops of loft grids: a few rows of plain arrays that the compiler vectorises.

use moldloft_num::{Real, Vec3};

/// How many parameters v are evaluated together: small enough for the fastest cache.
pub const LANES: usize = 32;

/// Positions and derivatives at up to [`LANES`] parameters, as separate planes x, y, z.
pub struct Chunk<T> {
    /// Positions.
    pub p: [[T; LANES]; 3],
    /// Derivatives by u.
    pub u: [[T; LANES]; 3],
    /// Derivatives by v.
    pub v: [[T; LANES]; 3],
}

impl<T: Real> Chunk<T> {
    pub fn zero() -> Self {
        let zero = [[T::zero(); LANES]; 3];
        Self { p: zero, u: zero, v: zero }
    }

    /// Writes the positions.
    pub fn write_points(&self, out: &mut [Vec3<T>]) {
        let [x, y, z] = &self.p;
        for (j, p) in out.iter_mut().enumerate() {
            *p = Vec3 { x: x[j], y: y[j], z: z[j] };
        }
    }

    /// Writes the unit normals along S_u x S_v, zero where that vanishes.
    pub fn write_normals(&mut self, out: &mut [Vec3<T>]) {
        let n = out.len();
        let ([ux, uy, uz], [vx, vy, vz]) = (&self.u, &self.v);
        let [x, y, z] = &mut self.p;
        for j in 0..n {
            let nx = uy[j] * vz[j] - uz[j] * vy[j];
            let ny = uz[j] * vx[j] - ux[j] * vz[j];
            let nz = ux[j] * vy[j] - uy[j] * vx[j];
            let square = nx * nx + ny * ny + nz * nz;
            let length = square.sqrt();
            let inverse = if length.re() > 0.0 { T::one() / length } else { T::zero() };
            (x[j], y[j], z[j]) = (nx * inverse, ny * inverse, nz * inverse);
        }
        self.write_points(out);
    }
}
