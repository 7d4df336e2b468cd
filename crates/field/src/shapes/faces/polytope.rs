//! Convex bodies as their faces, cut by planes.

use moldloft_num::Vec3;

/// A plane n.X + d = 0 with |n| = 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct HessePlane {
    pub normal: Vec3,
    pub offset: f64,
}

impl HessePlane {
    /// The plane through `point`.
    pub fn through(normal: Vec3, point: Vec3) -> Option<Self> {
        let normal = normal.normalized()?;
        Some(Self { normal, offset: -normal.dot(point) })
    }

    /// The distance of a point, positive in front.
    pub fn at(&self, p: Vec3) -> f64 {
        self.normal.dot(p) + self.offset
    }

    /// The same plane seen from behind.
    pub fn turned(&self) -> Self {
        Self { normal: -self.normal, offset: -self.offset }
    }

    /// Least and greatest distance of points.
    pub fn range<'a>(&self, points: impl Iterator<Item = &'a Vec3>) -> [f64; 2] {
        points.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            let d = self.at(*p);
            [low.min(d), high.max(d)]
        })
    }
}

/// A convex polygon (one face) or a convex body (all its faces).
#[derive(Clone, Debug)]
pub(super) struct Polytope {
    pub faces: Vec<Vec<Vec3>>,
    /// True for a body, whose cuts are closed by a face; false for a polygon.
    pub body: bool,
}

impl Polytope {
    /// The polygon of corners in order.
    pub fn polygon(corners: Vec<Vec3>) -> Self {
        Self { faces: vec![corners], body: false }
    }

    /// The cube around a point.
    pub fn cube(centre: Vec3, half: f64) -> Self {
        let corner = |k: usize| {
            let side = |bit: usize| if k >> bit & 1 == 1 { half } else { -half };
            centre + Vec3::of(side(0), side(1), side(2))
        };
        let faces =
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        Self { faces: faces.iter().map(|f| f.map(corner).to_vec()).collect(), body: true }
    }

    /// The prism or wedge between two triangles.
    pub fn wedge(near: [Vec3; 3], far: [Vec3; 3]) -> Self {
        let mut faces = vec![near.to_vec(), far.to_vec()];
        for k in 0..3 {
            let next = (k + 1) % 3;
            faces.push(vec![near[k], near[next], far[next], far[k]]);
        }
        Self { faces, body: true }
    }

    /// All corners, each as often as it has faces.
    pub fn points(&self) -> impl Iterator<Item = &Vec3> {
        self.faces.iter().flatten()
    }

    /// The mean of the corners: a point inside.
    pub fn middle(&self) -> Vec3 {
        let n = self.points().count().max(1) as f64;
        self.points().fold(Vec3::zero(), |s: Vec3, p| s + *p) / n
    }

    /// The part in front of a plane by more than `epsilon`; `None` if no corner is.
    pub fn cut(&self, level: &HessePlane, epsilon: f64) -> Option<Self> {
        let [low, high] = level.range(self.points());
        if high <= epsilon {
            return None;
        }
        if low >= -epsilon {
            return Some(self.clone());
        }
        let mut faces = Vec::with_capacity(self.faces.len() + 1);
        let mut rim: Vec<Vec3> = Vec::new();
        for face in &self.faces {
            let mut kept = Vec::with_capacity(face.len() + 1);
            for (k, p) in face.iter().enumerate() {
                let q = face[(k + 1) % face.len()];
                let (d, e) = (level.at(*p), level.at(q));
                if d >= -epsilon {
                    kept.push(*p);
                    if d <= epsilon {
                        rim.push(*p);
                    }
                }
                if (d > epsilon && e < -epsilon) || (d < -epsilon && e > epsilon) {
                    let x = p.lerp(q, d / (d - e));
                    kept.push(x);
                    rim.push(x);
                }
            }
            if kept.len() >= 3 && kept.iter().any(|p| level.at(*p) > epsilon) {
                faces.push(kept);
            }
        }
        if self.body {
            let lid = around(rim, level.normal, epsilon);
            if lid.len() >= 3 {
                faces.push(lid);
            }
        }
        Some(Self { faces, body: self.body })
    }
}

/// Points of a convex polygon in order round it, each once.
fn around(points: Vec<Vec3>, normal: Vec3, epsilon: f64) -> Vec<Vec3> {
    let mut distinct: Vec<Vec3> = Vec::new();
    for p in points {
        if distinct.iter().all(|q| q.distance(p) > epsilon) {
            distinct.push(p);
        }
    }
    let n = distinct.len().max(1) as f64;
    let middle = distinct.iter().fold(Vec3::zero(), |s: Vec3, p| s + *p) / n;
    let x = normal.perpendicular();
    let y = normal.cross(x);
    let angle = |p: &Vec3| libm::atan2((*p - middle).dot(y), (*p - middle).dot(x));
    distinct.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    distinct
}
