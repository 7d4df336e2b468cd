//! The inner loops of loft grids, on planes of plain numbers that the compiler vectorises.

use moldloft_num::{Real, Vec3};
use std::marker::PhantomData;

/// Number of parameters v that are evaluated together; the data fit in the first-level cache.
pub const LANES: usize = 64;

/// One plain number at each of the parameters.
pub type Plane = [f64; LANES];

/// Runs loops with the widest registers of the processor. Operations and their order are those of
/// narrow registers, without fused operations: the bits are the same.
pub fn widest<R>(loops: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(loops)
}

/// Contents of a chunk.
#[derive(Clone, Copy)]
pub enum ChunkQuantity {
    /// Positions.
    Point,
    /// Derivatives by u.
    ByU,
    /// Derivatives by v.
    ByV,
}

/// Positions and derivatives at up to [`LANES`] parameters. Each coordinate of each of them is a
/// plane of real parts, followed by one of each derivative part of the scalar.
pub struct Chunk<T> {
    planes: Vec<Plane>,
    normals: Vec<Plane>,
    inverse: Plane,
    scalar: PhantomData<T>,
}

impl<T: Real> Chunk<T> {
    pub fn new() -> Self {
        Self {
            planes: vec![[0.0; LANES]; 9 * T::PARTS],
            normals: vec![[0.0; LANES]; 3 * T::PARTS],
            inverse: [0.0; LANES],
            scalar: PhantomData,
        }
    }

    /// The plane of part `k` of a coordinate.
    #[inline(always)]
    pub fn plane(&mut self, part: ChunkQuantity, axis: usize, k: usize) -> &mut Plane {
        &mut self.planes[(3 * part as usize + axis) * T::PARTS + k]
    }

    /// Writes the positions.
    #[inline(always)]
    pub fn write_points(&self, out: &mut [Vec3<T>]) {
        write(&self.planes[..3 * T::PARTS], out);
    }

    /// Writes the unit normals along S_u x S_v, zero where that vanishes.
    #[inline(always)]
    pub fn write_normals(&mut self, out: &mut [Vec3<T>]) {
        if !T::FIRST_ORDER {
            return self.write_normals_by_numbers(out);
        }
        let (n, parts) = (out.len().min(LANES), T::PARTS);
        let tangents = &self.planes[3 * parts..9 * parts];
        let tangent = |axis: usize, k: usize| &tangents[axis * parts + k];
        let [ux, uy, uz, vx, vy, vz] = std::array::from_fn(|axis| tangent(axis, 0));
        let (first, rest) = self.normals.split_at_mut(3);
        let [nx, ny, nz] = first else { unreachable!("three coordinates") };
        for j in 0..n {
            let x = uy[j] * vz[j] - uz[j] * vy[j];
            let y = uz[j] * vx[j] - ux[j] * vz[j];
            let z = ux[j] * vy[j] - uy[j] * vx[j];
            let length = (x * x + y * y + z * z).sqrt();
            let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
            (nx[j], ny[j], nz[j], self.inverse[j]) =
                (x * inverse, y * inverse, z * inverse, inverse);
        }
        // With m = S_u x S_v, dn = (dm - n (n . dm)) / |m|.
        for (k, derivative) in (1..parts).zip(rest.chunks_exact_mut(3)) {
            let [ax, ay, az, bx, by, bz] = std::array::from_fn(|axis| tangent(axis, k));
            let [dx, dy, dz] = derivative else { unreachable!("three coordinates") };
            for j in 0..n {
                let x = ay[j] * vz[j] - az[j] * vy[j] + (uy[j] * bz[j] - uz[j] * by[j]);
                let y = az[j] * vx[j] - ax[j] * vz[j] + (uz[j] * bx[j] - ux[j] * bz[j]);
                let z = ax[j] * vy[j] - ay[j] * vx[j] + (ux[j] * by[j] - uy[j] * bx[j]);
                let along = nx[j] * x + ny[j] * y + nz[j] * z;
                dx[j] = (x - nx[j] * along) * self.inverse[j];
                dy[j] = (y - ny[j] * along) * self.inverse[j];
                dz[j] = (z - nz[j] * along) * self.inverse[j];
            }
        }
        // Here the three coordinates of a part are adjacent.
        for (j, normal) in out.iter_mut().enumerate().take(n) {
            let of = |axis: usize| T::from_parts(|k| self.normals[3 * k + axis][j]);
            *normal = Vec3 { x: of(0), y: of(1), z: of(2) };
        }
    }

    fn write_normals_by_numbers(&self, out: &mut [Vec3<T>]) {
        for (j, normal) in out.iter_mut().enumerate() {
            let of = |at: usize| T::from_parts(|k| self.planes[at * T::PARTS + k][j]);
            let vector = |at: usize| Vec3 { x: of(at), y: of(at + 1), z: of(at + 2) };
            *normal = vector(3).cross(vector(6)).normalized().unwrap_or_default();
        }
    }
}

#[inline(always)]
fn write<T: Real>(planes: &[Plane], out: &mut [Vec3<T>]) {
    let (x, rest) = planes.split_at(T::PARTS);
    let (y, z) = rest.split_at(T::PARTS);
    for (j, p) in out.iter_mut().enumerate().take(LANES) {
        let of = |planes: &[Plane]| T::from_parts(|k| planes[k][j]);
        *p = Vec3 { x: of(x), y: of(y), z: of(z) };
    }
}
