//! Cylinder coordinates about a line: (r, theta, s), in which the sections of a blade are lofted.

use moldloft_num::{Axis, CurveJet, Jet, Real, Vec3};
use std::f64::consts::TAU;

/// The coordinates about a line: distance from it, angle about it, length along it.
pub struct About<T: Real> {
    point: Vec3<T>,
    along: Vec3<T>,
    across: [Vec3<T>; 2],
}

impl<T: Real> About<T> {
    pub fn new(line: &Axis<T>) -> Self {
        let along = line.direction;
        let first = along.perpendicular();
        Self { point: line.point, along, across: [first, along.cross(first)] }
    }

    /// Converts points to coordinates; each angle is within half a turn of the one before.
    pub fn coordinates<S: Jet<T>>(&self, points: &mut [Vec3<S>]) {
        let fixed = |v: Vec3<T>| v.map(S::fixed);
        let [e1, e2] = self.across.map(fixed);
        let mut before = 0.0;
        for p in points {
            let d = *p - fixed(self.point);
            let (x, y) = (d.dot(e1), d.dot(e2));
            let angle = y.atan2(x);
            let turns = ((angle.re() - before) / TAU).round();
            let angle = angle - turns * TAU;
            before = angle.re();
            *p = Vec3::new((x * x + y * y).sqrt(), angle, d.dot(fixed(self.along)));
        }
    }

    /// The point with its derivatives, from coordinates with theirs.
    pub fn places<S: Jet<T>>(&self, [q, d, dd]: CurveJet<S>) -> CurveJet<S> {
        let fixed = |v: Vec3<T>| v.map(S::fixed);
        let [e1, e2] = self.across.map(fixed);
        let (c, s) = (q.y.cos(), q.y.sin());
        // Outward and onward about the line: they turn into each other.
        let (out, on) = (e1 * c + e2 * s, e2 * c - e1 * s);
        let along = fixed(self.along);
        [
            fixed(self.point) + along * q.z + out * q.x,
            along * d.z + out * d.x + on * (q.x * d.y),
            along * dd.z + out * (dd.x - q.x * d.y * d.y) + on * (d.x * d.y * 2.0 + q.x * dd.y),
        ]
    }
}

/// The length of a step in these coordinates along the helix between its ends.
pub fn step<S: Real>(a: Vec3<S>, b: Vec3<S>) -> S {
    let d = b - a;
    let turned = (a.x + b.x) * d.y * 0.5;
    (d.x * d.x + turned * turned + d.z * d.z).sqrt()
}
