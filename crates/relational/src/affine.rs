//! Affine maps for copies and rotations of curves and points.

use moldloft_num::{Axis, Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::CurveRef;

/// The map p -> to + M (p - from).
#[derive(Clone, Copy, Debug)]
pub struct PivotTransform<T> {
    from: Vec3<T>,
    to: Vec3<T>,
    columns: [Vec3<T>; 3],
}

impl<T: Real> PivotTransform<T> {
    /// Scaled along the axes by `scale`, with `from` going to `to`.
    pub fn scaled(from: Vec3<T>, to: Vec3<T>, scale: [T; 3]) -> Self {
        let o = T::zero();
        let [x, y, z] = scale;
        let columns = [Vec3::new(x, o, o), Vec3::new(o, y, o), Vec3::new(o, o, z)];
        Self { from, to, columns }
    }

    /// Rotation about an axis by `angle` radians, right-handed.
    pub fn turned(axis: Axis<T>, angle: T) -> Self {
        let about = Axis { point: Vec3::zero(), direction: axis.direction };
        let (c, s) = (angle.cos(), angle.sin());
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|[x, y, z]| about.turned(Vec3::of(x, y, z), c, s));
        Self { from: axis.point, to: axis.point, columns }
    }

    /// The image of a point.
    pub fn point(&self, p: Vec3<T>) -> Vec3<T> {
        self.to + self.direction(p - self.from)
    }

    /// The image of a free vector.
    pub fn direction(&self, d: Vec3<T>) -> Vec3<T> {
        let [x, y, z] = self.columns;
        x * d.x + y * d.y + z * d.z
    }
}

/// The image of a curve under a map, point by point.
pub struct Mapped<T: Real> {
    /// The curve.
    pub curve: CurveRef<T>,
    /// The map.
    pub map: PivotTransform<T>,
}

impl<T: Real> Curve<T> for Mapped<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [p, d, dd] = self.curve.jet(t, order);
        [self.map.point(p), self.map.direction(d), self.map.direction(dd)]
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
        for p in out {
            *p = self.map.point(*p);
        }
    }
    fn image_of(&self) -> Option<moldloft_num::trace::Key> {
        self.curve.key
    }
    moldloft_num::curve_facts!(breaks of [self.curve], closed of [self.curve], rational of [self.curve]);
}
