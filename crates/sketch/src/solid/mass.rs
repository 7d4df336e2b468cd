//! Area, volume, centroid and inertia, by exact formulas for triangles and Gauss's rule for curves.

use crate::solid::curve::SmoothPiece;
use moldloft_num::GAUSS_8_UNIT;
use moldloft_num::{Real, Vec3};

/// Properties of a solid of unit density, or of a flat figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass<T> {
    /// Area of all faces.
    pub area: T,
    /// Enclosed volume; zero for a flat figure.
    pub volume: T,
    /// Centre of the volume, or of the area of a flat figure.
    pub centroid: Vec3<T>,
    /// Moments of inertia about the centroid: Ixx, Iyy, Izz, and the products of inertia
    /// ∫yz, ∫zx, ∫xy. Zero for a flat figure.
    pub inertia: [T; 6],
}

/// A directed edge of a plane face, between its ends.
pub(crate) enum DirectedEdge<T> {
    Straight,
    Piece(SmoothPiece<T>),
    /// Points along it with the weighted displacement along it.
    Nodes(Vec<(Vec3<T>, Vec3<T>)>),
}

/// Surface integrals, taken from an origin near the body.
#[derive(Clone, Debug)]
pub(crate) struct MassIntegrals<T> {
    origin: Vec3<T>,
    pub area: T,
    area_moment: Vec3<T>,
    volume: T,
    moment: Vec3<T>,
    /// ∫ xx, yy, zz, yz, zx, xy dV.
    second: [T; 6],
    /// Sums of a closed surface: ∫ dA, zero, and ∫ x dA_x, ∫ y dA_y, ∫ z dA_z, each equal to the
    /// volume.
    closure: [Vec3; 2],
    /// Area and moment of the current patch, with the sign of its border's direction.
    patch: (T, Vec3<T>),
}

impl<T: Real> MassIntegrals<T> {
    pub fn new(origin: Vec3<T>) -> MassIntegrals<T> {
        let (t, v) = (T::zero(), Vec3::zero());
        MassIntegrals {
            origin,
            area: t,
            area_moment: v,
            volume: t,
            moment: v,
            second: [t; 6],
            closure: [Vec3::zero(); 2],
            patch: (t, v),
        }
    }

    fn products(p: Vec3<T>) -> [T; 6] {
        [p.x * p.x, p.y * p.y, p.z * p.z, p.y * p.z, p.z * p.x, p.x * p.y]
    }

    /// Adds a surface element at `p` of vector area `da`: the divergence theorem with the fields
    /// p, x p, x y p of divergence 3, 4 x, 5 x y.
    fn element(&mut self, p: Vec3<T>, da: Vec3<T>) {
        let flux = p.dot(da);
        self.close(p, da);
        self.volume += flux / 3.0;
        self.moment += p * (flux / 4.0);
        for (sum, x) in self.second.iter_mut().zip(Self::products(p)) {
            *sum += x * (flux / 5.0);
        }
    }

    /// Counts an element of a plane through `p`, its centre, with the vector area.
    fn close(&mut self, p: Vec3<T>, da: Vec3<T>) {
        let (p, da) = (p.re(), da.re());
        self.closure[0] += da;
        self.closure[1] += Vec3::new(p.x * da.x, p.y * da.y, p.z * da.z);
    }

    /// Closure error of the surface, relative to its area, or the spread of the volumes along x, y
    /// and z, relative to the area times `extent`, if larger.
    pub fn gap(&self, extent: f64) -> f64 {
        let [vector, volumes] = self.closure;
        let [x, y, z] = volumes.to_array();
        let spread = x.max(y).max(z) - x.min(y).min(z);
        let area = self.area.re().max(f64::MIN_POSITIVE);
        (vector.norm() / area).max(spread / (area * extent.max(f64::MIN_POSITIVE)))
    }

    /// Adds the tetrahedron from the origin over a straight triangle.
    fn triangle(&mut self, a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) {
        let (a, b, c) = (a - self.origin, b - self.origin, c - self.origin);
        let volume = a.dot(b.cross(c)) / 6.0;
        let sum = a + b + c;
        self.close(sum / T::from(3.0), (b - a).cross(c - a) * T::from(0.5));
        self.volume += volume;
        self.moment += sum * (volume / 4.0);
        // ∫ x y over a tetrahedron with a corner at the origin: V/20 (Σ Σ + Σ x_i y_i).
        let (s, pa, pb, pc) =
            (Self::products(sum), Self::products(a), Self::products(b), Self::products(c));
        for k in 0..6 {
            self.second[k] += (s[k] + pa[k] + pb[k] + pc[k]) * (volume / 20.0);
        }
    }

    /// Adds a plane face. `edges` are its directed edges; straight ones have no piece.
    pub fn plane(&mut self, edges: &[(Vec3<T>, Vec3<T>, DirectedEdge<T>)]) {
        let Some(&(apex, ..)) = edges.first() else { return };
        let mut vector = Vec3::zero();
        let mut moments: Vec<(Vec3<T>, Vec3<T>)> = Vec::new();
        for (p, q, side) in edges {
            let (p, q) = (*p, *q);
            let nodes = match side {
                DirectedEdge::Straight => {
                    self.triangle(apex, p, q);
                    let da = (p - apex).cross(q - apex) * T::from(0.5);
                    vector += da;
                    moments.push(((apex + p + q) / T::from(3.0) - self.origin, da));
                    continue;
                }
                DirectedEdge::Piece(piece) => along()
                    .map(|(s, w)| (piece.at(T::from(s)), piece.velocity(T::from(s)) * T::from(w)))
                    .collect(),
                DirectedEdge::Nodes(nodes) => nodes.clone(),
            };
            // The sector from the apex to the curve: apex + r (c(s) - apex).
            for (at, by) in nodes {
                let arm = at - apex;
                let normal = arm.cross(by);
                for (r, wr) in GAUSS_8_UNIT {
                    let p = apex + arm * T::from(r) - self.origin;
                    let da = normal * T::from(r * wr);
                    self.element(p, da);
                    vector += da;
                    moments.push((p, da));
                }
            }
        }
        let area = vector.norm();
        self.area += area;
        if let Some(n) = vector.normalized() {
            for (p, da) in moments {
                self.area_moment += p * da.dot(n);
            }
        }
    }

    /// A patch of elements whose areas may all have the wrong sign.
    pub fn begin_patch(&mut self) {
        self.patch = (T::zero(), Vec3::zero());
    }

    /// An element of it, with its area and the sign of that.
    pub fn patch_element(&mut self, p: Vec3<T>, da: Vec3<T>, area: T) {
        let p = p - self.origin;
        self.element(p, da);
        self.patch.0 += area;
        self.patch.1 += p * area;
    }

    /// Its end.
    pub fn end_patch(&mut self) {
        let (area, moment) = self.patch;
        let turn = T::from(if area.re() < 0.0 { -1.0 } else { 1.0 });
        self.area += area * turn;
        self.area_moment += moment * turn;
    }

    /// Adds a ruled patch: straight lines from `near(s)` to `far(s)`; its outward side is that of
    /// (∂/∂s) × (∂ from near to far).
    pub fn ruled(&mut self, near: &SmoothPiece<T>, far: &dyn Fn(T) -> (Vec3<T>, Vec3<T>)) {
        for (s, w) in along() {
            let s = T::from(s);
            let (a, da) = (near.at(s), near.velocity(s));
            let (b, db) = far(s);
            for (t, wt) in GAUSS_8_UNIT {
                let t = T::from(t);
                let element = da.lerp(db, t).cross(b - a) * T::from(w * wt);
                let p = a.lerp(b, t) - self.origin;
                self.element(p, element);
                let area = element.norm();
                self.area += area;
                self.area_moment += p * area;
            }
        }
    }

    /// The rates by which a triangle of a plane face is ahead of its plane, by the corner.
    pub fn moved(&mut self, corners: [Vec3; 3], ahead: [T; 3]) {
        let [a, b, c] = corners;
        let twice = (b - a).cross(c - a).norm();
        for (r, wr) in GAUSS_8_UNIT {
            for (s, ws) in GAUSS_8_UNIT {
                let part = [1.0 - r, r * (1.0 - s), r * s];
                let p = Vec3::lifted(a * part[0] + b * part[1] + c * part[2]) - self.origin;
                let by = (0..3).fold(T::zero(), |sum, k| sum + ahead[k] * part[k]);
                let volume = by * (twice * r * wr * ws);
                self.volume += volume;
                self.moment += p * volume;
                for (sum, x) in self.second.iter_mut().zip(Self::products(p)) {
                    *sum += x * volume;
                }
            }
        }
    }

    /// The properties of the body so enclosed.
    pub fn finish(self, flat: bool) -> Mass<T> {
        let zero = T::zero();
        if flat || self.volume.re() == 0.0 {
            let centre =
                if self.area.re() > 0.0 { self.area_moment / self.area } else { Vec3::zero() };
            let centroid = self.origin + centre;
            return Mass { area: self.area, volume: zero, centroid, inertia: [zero; 6] };
        }
        let c = self.moment / self.volume;
        let own = Self::products(c);
        let about: [T; 6] = std::array::from_fn(|k| self.second[k] - own[k] * self.volume);
        let [xx, yy, zz, yz, zx, xy] = about;
        Mass {
            area: self.area,
            volume: self.volume,
            centroid: self.origin + c,
            inertia: [yy + zz, zz + xx, xx + yy, yz, zx, xy],
        }
    }
}

/// Gauss's nodes on four parts of [0, 1]: arcs up to a half turn come out to rounding.
pub(crate) fn along() -> impl Iterator<Item = (f64, f64)> {
    (0..4).flat_map(|k| GAUSS_8_UNIT.map(|(x, w)| ((f64::from(k) + x) / 4.0, w / 4.0)))
}
