//! Bounds of the signed side of a surface, piece by piece.
//!
//! The value at p is (p - q) . n, with the nearest point q of the surface and the normal n there.
//! Over a box, q is in one of the pieces that can be nearest; each piece has a central normal and a
//! bound of the deviation of its normals, so each gives a range, and their hull bounds the value.
//! This also holds beyond the edges, where the nearest point may jump. The bounds are as good as
//! those of [`moldloft_locate::pieces`]: exact for B-splines up to degree three, measured for
//! others.

use crate::expr::interval::Interval;
use moldloft_locate::Boxes;
use moldloft_locate::pieces::{BezierPatch, distance_sq, patches, widened};
use moldloft_num::{Box3, Surface, Vec3};

/// Pieces are halved until their normals differ by this from that in the middle, …
const TURN: f64 = 0.06;
/// … but into no more than this many, each and altogether.
const MOST_HALVINGS: u32 = 8;
const MOST: usize = 1 << 13;
/// Pieces that a box of the tree holds.
const LEAF: usize = 4;

struct SurfacePiece {
    middle: Vec3,
    /// Maximum distance of its points from the centre, …
    reach: f64,
    /// … and along the normal.
    thickness: f64,
    /// The unit normal in the middle, …
    normal: Vec3,
    /// … and maximum distance of normals from it; 2 if unknown.
    turn: f64,
}

/// The pieces of a surface.
pub(crate) struct SignedSide {
    pieces: Vec<SurfacePiece>,
    boxes: Boxes,
}

/// Mean of some vectors, and their maximum distance from it.
fn ball(all: &[Vec3]) -> (Vec3, f64) {
    let mut mean = Vec3::zero();
    all.iter().for_each(|v| mean += *v);
    mean = mean / all.len() as f64;
    (mean, all.iter().map(|v| v.distance(mean)).fold(0.0, f64::max))
}

impl SurfacePiece {
    fn of(patch: &BezierPatch) -> Self {
        let n = &patch.net;
        let (mut du, mut dv) = ([Vec3::zero(); 12], [Vec3::zero(); 12]);
        for i in 0..3 {
            for j in 0..4 {
                du[i * 4 + j] = (n[(i + 1) * 4 + j] - n[i * 4 + j]) * 3.0;
                dv[i * 4 + j] = (n[j * 4 + i + 1] - n[j * 4 + i]) * 3.0;
            }
        }
        // An error between nodes of size s has slopes of some 10 s.
        let slack = patch.slack;
        let (a, r) = ball(&du);
        let (b, s) = ball(&dv);
        let (r, s) = (r + 10.0 * slack * patch.share[0], s + 10.0 * slack * patch.share[1]);
        let across = a.cross(b);
        let (size, error) = (across.norm(), a.norm() * s + b.norm() * r + r * s);
        let (middle, reach) = ball(n);
        let reach = reach + slack;
        // The sine of the angle between a vector and one at most `error` from it; the chord of that angle
        // is at most sqrt(2) sines while it is not a right angle.
        let known = error < size;
        let (normal, turn) = if known {
            (across / size, std::f64::consts::SQRT_2 * (error / size) * (1.0 + 1e-12))
        } else {
            (Vec3::zero(), 2.0)
        };
        let away = n.iter().map(|p| (*p - middle).dot(normal).abs()).fold(0.0, f64::max);
        let thickness = if known { away + slack } else { reach };
        Self { middle, reach, thickness, normal, turn }
    }

    /// The range of (p - q) . n over the ball of radius `r` about `c`.
    fn range(&self, c: Vec3, r: f64) -> Option<Interval> {
        if self.turn >= 2.0 {
            return None;
        }
        let away = c - self.middle;
        let value = away.dot(self.normal);
        let free = r + self.thickness + (away.norm() + self.reach) * self.turn;
        Some(Interval { low: value - free, high: value + free })
    }
}

impl SignedSide {
    pub(crate) fn new(surface: &dyn Surface<f64>) -> Self {
        let mut pieces = Vec::new();
        let mut bounds = Vec::new();
        let mut pending: Vec<(BezierPatch, u32)> =
            patches(surface).into_iter().rev().map(|p| (p, 0)).collect();
        while let Some((patch, halvings)) = pending.pop() {
            let piece = SurfacePiece::of(&patch);
            let full = pieces.len() + pending.len() >= MOST;
            if piece.turn <= TURN || halvings == MOST_HALVINGS || full {
                bounds.push(patch.bounds());
                pieces.push(piece);
                continue;
            }
            let [u, v] = patch.lengths();
            let [first, second] = patch.halves(usize::from(v > u));
            pending.extend([(second, halvings + 1), (first, halvings + 1)]);
        }
        Self { boxes: Boxes::new(&bounds, LEAF), pieces }
    }

    /// The range over a box, whose centre is `far` from the surface.
    pub(crate) fn range(&self, over: &Box3, far: f64) -> Interval {
        let (c, r) = (over.centre(), 0.5 * over.diagonal() * (1.0 + 1e-9));
        // Rounding, and the accuracy of the nearest point.
        let most = far + r + 1e-9 * (over.diagonal() + far);
        let all = Interval { low: -most, high: most };
        // The nearest point of any point of the box is at most this far from the centre.
        let limit = most + r;
        let mut hull: Option<Interval> = None;
        let near = widened(Box3 { low: c, high: c }, limit);
        self.boxes.visit(
            |b| moldloft_locate::pieces::meet(b, &near) && distance_sq(b, c) <= limit * limit,
            |k| {
                let own = self.pieces[k as usize].range(c, r).unwrap_or(all);
                hull = Some(hull.map_or(own, |h| Interval {
                    low: h.low.min(own.low),
                    high: h.high.max(own.high),
                }));
            },
        );
        let hull = hull.unwrap_or(all);
        Interval { low: hull.low.max(-most), high: hull.high.min(most) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_num::{Order, SurfJet};

    /// A quarter of a saddle with edges that bend.
    struct Saddle;

    impl Surface<f64> for Saddle {
        fn jet(&self, u: f64, v: f64, _: Order) -> SurfJet<f64> {
            let (x, y) = (3.0 * u - 1.5, 2.0 * v - 1.0);
            let z = 0.2 * x * x - 0.4 * y * y + 0.1 * x * y;
            SurfJet {
                p: Vec3::of(x, y, z),
                u: Vec3::of(1.0, 0.0, 0.4 * x + 0.1 * y) * 3.0,
                v: Vec3::of(0.0, 1.0, -0.8 * y + 0.1 * x) * 2.0,
                uu: Vec3::of(0.0, 0.0, 0.4 * 9.0),
                uv: Vec3::of(0.0, 0.0, 0.1 * 6.0),
                vv: Vec3::of(0.0, 0.0, -0.8 * 4.0),
            }
        }

        moldloft_num::surface_facts!(smooth, open, not_rational);
        moldloft_num::surface_one_by_one!(f64: grid, line, scattered);
    }

    #[test]
    fn ranges_hold_beside_the_surface_and_beyond_its_edges() {
        let facing = SignedSide::new(&Saddle);
        let nearest = moldloft_locate::NearestSurface::new(&Saddle);
        let value = |p: Vec3| {
            let [u, v] = nearest.nearest(&Saddle, p).at;
            let j = Saddle.jet(u, v, Order::First);
            (p - j.p).dot(j.normal())
        };
        let mut random = moldloft_testing::Random::new(5);
        let mut unknown = 0;
        for _ in 0..400 {
            let c = Vec3::of(
                random.between(-4.0, 4.0),
                random.between(-4.0, 4.0),
                random.between(-3.0, 3.0),
            );
            let half = Vec3::of(1.0, 0.7, 0.4) * random.between(0.01, 0.5);
            let over = Box3 { low: c - half, high: c + half };
            let far = nearest.nearest(&Saddle, c).distance;
            let range = facing.range(&over, far);
            unknown += usize::from(range.low <= 0.0 && range.high >= 0.0);
            for _ in 0..40 {
                let p = c + Vec3::of(
                    random.between(-half.x, half.x),
                    random.between(-half.y, half.y),
                    random.between(-half.z, half.z),
                );
                let f = value(p);
                assert!(range.low <= f && f <= range.high, "{p:?}: {f} in {range:?}");
            }
        }
        // Half of these boxes reach beyond the edges; most are on a known side.
        assert!(unknown < 280, "{unknown}");
    }
}
