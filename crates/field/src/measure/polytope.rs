//! Convex pieces of a cell, cut by planes, and their integrals.
//!
//! A cell of the division is parted by the planes of its leaves' Taylor forms; of the parts those in which the set
//! is solid are integrated exactly. Numbers may carry derivatives: decisions are made by real parts.

use moldloft_num::{Real, Vec3};
use smallvec::SmallVec;

/// The plane `normal . x + offset <= 0` is the inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct CuttingPlane<T: Real> {
    pub normal: Vec3<T>,
    pub offset: T,
}

impl<T: Real> CuttingPlane<T> {
    fn at(&self, p: Vec3<T>) -> T {
        self.normal.dot(p) + self.offset
    }
}

/// A face of the cell itself.
pub(super) const WALL: i8 = i8::MIN;

/// A face: its corners, counter-clockwise from outside, and whose it is: leaf k as k + 1 where the piece is
/// inside of its plane, as -k - 1 where it is outside.
#[derive(Clone, Debug)]
pub(super) struct PolytopeFace<T: Real> {
    pub corners: SmallVec<[Vec3<T>; 8]>,
    pub owner: i8,
}

/// A convex piece.
#[derive(Clone, Debug)]
pub(super) struct CellPolytope<T: Real> {
    pub faces: SmallVec<[PolytopeFace<T>; 8]>,
}

impl<T: Real> CellPolytope<T> {
    /// The box about the origin with these half sides.
    pub fn of_box(half: Vec3) -> Self {
        let mut faces = SmallVec::new();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for side in [-1.0, 1.0] {
                let turns: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let mut corners: SmallVec<[Vec3<T>; 8]> = turns
                    .iter()
                    .map(|[u, v]| {
                        let mut p = [0.0; 3];
                        (p[axis], p[b], p[c]) = (side * half[axis], u * half[b], v * half[c]);
                        Vec3::lifted(Vec3::from(p))
                    })
                    .collect();
                if side < 0.0 {
                    corners.reverse();
                }
                faces.push(PolytopeFace { corners, owner: WALL });
            }
        }
        Self { faces }
    }

    /// On which sides of a plane its corners are: -1 all inside or on it, 1 all outside or on it, 0 both.
    fn side(&self, cut: &CuttingPlane<T>) -> i8 {
        let (mut inside, mut outside) = (false, false);
        for p in self.faces.iter().flat_map(|f| &f.corners) {
            let d = cut.at(*p).re();
            inside |= d < 0.0;
            outside |= d > 0.0;
        }
        match (inside, outside) {
            (true, true) => 0,
            (_, false) => -1,
            (false, true) => 1,
        }
    }

    /// The parts inside and outside of a plane that belongs to `leaf`.
    pub fn split(&self, cut: &CuttingPlane<T>, leaf: usize) -> [Option<Self>; 2] {
        match self.side(cut) {
            -1 => [Some(self.clone()), None],
            1 => [None, Some(self.clone())],
            _ => [self.clipped(cut, leaf, false), self.clipped(cut, leaf, true)],
        }
    }

    fn clipped(&self, cut: &CuttingPlane<T>, leaf: usize, outside: bool) -> Option<Self> {
        let sign = if outside { -1.0 } else { 1.0 };
        let owner = if outside { -(leaf as i8) - 1 } else { leaf as i8 + 1 };
        let mut faces: SmallVec<[PolytopeFace<T>; 8]> = SmallVec::new();
        let mut rim: SmallVec<[Vec3<T>; 12]> = SmallVec::new();
        for face in &self.faces {
            let n = face.corners.len();
            let mut corners: SmallVec<[Vec3<T>; 8]> = SmallVec::new();
            for k in 0..n {
                let (p, q) = (face.corners[k], face.corners[(k + 1) % n]);
                let (d, e) = (cut.at(p) * sign, cut.at(q) * sign);
                if d.re() <= 0.0 {
                    corners.push(p);
                    if d.re() == 0.0 {
                        rim.push(p);
                    }
                }
                if (d.re() < 0.0 && e.re() > 0.0) || (d.re() > 0.0 && e.re() < 0.0) {
                    let x = p + (q - p) * (d / (d - e));
                    corners.push(x);
                    rim.push(x);
                }
            }
            if corners.len() >= 3 {
                faces.push(PolytopeFace { corners, owner: face.owner });
            }
        }
        if faces.is_empty() {
            return None;
        }
        // The new face: its corners round their middle, each found by both faces beside it.
        let normal = cut.normal.re() * sign;
        let mut middle = Vec3::zero();
        rim.iter().for_each(|p| middle += p.re());
        middle = middle / rim.len().max(1) as f64;
        let across = normal.perpendicular();
        let along = normal.cross(across);
        let scale = (along.norm() / across.norm().max(f64::MIN_POSITIVE)).max(f64::MIN_POSITIVE);
        let angle = |p: &Vec3<T>| {
            let d = p.re() - middle;
            // Monotone in the angle, without the angle: the quadrant and the tangent in it.
            let (x, y) = (d.dot(across) * scale, d.dot(along));
            let size = x.abs() + y.abs();
            let t = if size > 0.0 { y / size } else { 0.0 };
            if x >= 0.0 { t } else { 2.0 - t }
        };
        let mut order: SmallVec<[(f64, usize); 12]> =
            rim.iter().enumerate().map(|(k, p)| (angle(p), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let corners: SmallVec<[Vec3<T>; 8]> = order.iter().map(|o| rim[o.1]).collect();
        if corners.len() >= 3 {
            faces.push(PolytopeFace { corners, owner });
        }
        Some(Self { faces })
    }

    /// Its integrals of 1; x, y, z; xx, yy, zz; xy, yz, zx.
    pub fn moments(&self) -> [T; 10] {
        let mut out = [T::zero(); 10];
        let Some(apex) = self.faces.first().and_then(|f| f.corners.first()).copied() else {
            return out;
        };
        for face in &self.faces {
            for k in 1..face.corners.len().saturating_sub(1) {
                let [a, b, c] = [face.corners[0], face.corners[k], face.corners[k + 1]];
                let (u, v, w) = (a - apex, b - apex, c - apex);
                let volume = u.dot(v.cross(w)) / 6.0;
                if volume.re() == 0.0 && volume.is_constant() {
                    continue;
                }
                let sum = apex + a + b + c;
                out[0] += volume;
                for i in 0..3 {
                    out[1 + i] += volume * sum[i] * 0.25;
                }
                for (m, [i, j]) in SECOND.into_iter().enumerate() {
                    let products = apex[i] * apex[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j];
                    out[4 + m] += volume * (products + sum[i] * sum[j]) * 0.05;
                }
            }
        }
        out
    }

    /// Its volume.
    pub fn volume(&self) -> T {
        let mut out = T::zero();
        let Some(apex) = self.faces.first().and_then(|f| f.corners.first()).copied() else {
            return out;
        };
        for face in &self.faces {
            let first = face.corners[0] - apex;
            for k in 1..face.corners.len().saturating_sub(1) {
                let (b, c) = (face.corners[k] - apex, face.corners[k + 1] - apex);
                out += first.dot(b.cross(c));
            }
        }
        out / 6.0
    }
}

/// The axes of the moments of degree two.
pub(super) const SECOND: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_box_have_its_moments() {
        let half = Vec3::of(0.5, 0.7, 0.9);
        let whole = CellPolytope::<f64>::of_box(half);
        let m = whole.moments();
        assert!((m[0] - 8.0 * 0.5 * 0.7 * 0.9).abs() < 1e-15);
        assert!((m[4] - m[0] * 0.25 / 3.0).abs() < 1e-15 && m[7].abs() < 1e-15);
        let cuts = [
            CuttingPlane { normal: Vec3::of(1.0, 2.0, -0.5), offset: 0.1 },
            CuttingPlane { normal: Vec3::of(-0.3, 0.4, 1.0), offset: -0.2 },
            CuttingPlane { normal: Vec3::of(0.0, 1.0, 0.0), offset: 0.0 },
            CuttingPlane { normal: Vec3::of(1.0, 1.0, 1.0), offset: -2.1 },
        ];
        let mut parts = vec![whole];
        for (k, cut) in cuts.iter().enumerate() {
            parts = parts.iter().flat_map(|p| p.split(cut, k)).flatten().collect();
        }
        assert!(parts.len() >= 8);
        let mut sum = [0.0; 10];
        for part in &parts {
            assert!(part.moments()[0] > 0.0);
            sum.iter_mut().zip(part.moments()).for_each(|(s, x)| *s += x);
        }
        for k in 0..10 {
            assert!((sum[k] - m[k]).abs() < 1e-14, "{k}: {} {}", sum[k], m[k]);
        }
    }
}
