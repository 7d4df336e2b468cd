//! Shapes that no curve within the tolerances has, whatever its knots.
//!
//! Of a curve that turns left by less than half a turn, each point is to the right of the chord between an
//! earlier and a later one. Three data whose tolerances leave none of their positions so refute the shape.

use crate::curve::shape_condition::ShapeCondition;
use crate::curve::shaping::CurvePlane;
use crate::{Data, FairError, Motion};

type P = [f64; 2];

/// Turn of the polyline between the outer two of three points up to which they are compared: a
/// quarter of a turn.
const MAX_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// Maximum number of points between the outer two of three.
const MAX_POINTS_BETWEEN: usize = 200;

/// Amount, relative to the tolerances, by which three points refute a shape: above rounding.
const LEAST_MISS: f64 = 1e-6;

/// Three points that refute a sign, and by which distance.
struct Refutation {
    points: [usize; 3],
    miss: f64,
}

impl Data {
    /// The first of the conditions that no curve within the tolerances has, with its reason.
    pub(super) fn refuted(
        &self,
        plane: Option<CurvePlane>,
        wanted: &[ShapeCondition],
    ) -> Option<FairError> {
        let plane = plane?;
        let flat: Vec<P> = self.points.iter().map(|&p| plane.down(p)).collect();
        let way = self.way(&plane);
        let refuted = |left: bool, between: [usize; 2]| {
            self.against(&flat, way, between, if left { 1.0 } else { -1.0 })
        };
        wanted.iter().enumerate().find_map(|(shape, condition)| {
            let found = match condition {
                ShapeCondition::Turn { between, left } => refuted(*left, *between),
                // Both directions are refuted.
                ShapeCondition::OneWay { between } => refuted(true, *between)
                    .zip(refuted(false, *between))
                    .map(|(a, b)| if a.miss < b.miss { a } else { b }),
                _ => None,
            };
            found.map(|found| {
                let [i, j, k] = found.points.map(|k| k + 1);
                let why = format!(
                    "no curve with this shape is within the tolerance: point {j} is on the wrong side of the \
                     chord between points {i} and {k}, by {:.3e} more than their tolerances allow",
                    found.miss
                );
                FairError::Shapeless { shape, why }
            })
        })
    }

    /// The direction in the plane in which data move alone; `None` if they move in all.
    fn way(&self, plane: &CurvePlane) -> Option<P> {
        let Motion::Along(d) = self.limit.motion else { return None };
        Some(plane.axes.map(|a| a.dot(d)))
    }

    /// The three data between two that are the most against a turn (1 to the left, -1 to the right).
    fn against(
        &self,
        flat: &[P],
        way: Option<P>,
        [from, to]: [usize; 2],
        side: f64,
    ) -> Option<Refutation> {
        let (last, radii) = (to.min(flat.len() - 1), &self.limit.radii);
        let mut worst: Option<Refutation> = None;
        for i in from..last {
            let mut turn = 0.0;
            for k in i + 2..=last.min(i + MAX_POINTS_BETWEEN) {
                turn += angle(flat[k - 2], flat[k - 1], flat[k]).abs();
                if turn > MAX_TURN {
                    break;
                }
                for j in i + 1..k {
                    let three = [i, j, k];
                    let (points, radii) = (three.map(|k| flat[k]), three.map(|k| radii[k]));
                    let miss = match way {
                        Some(d) => beyond_along(points, radii, d, side),
                        // In a box a point is within its circle.
                        None => {
                            let corner =
                                if self.limit.motion == Motion::Ball { 1.0 } else { 2f64.sqrt() };
                            beyond(points, radii.map(|r| r * corner), side)
                        }
                    };
                    let certain = LEAST_MISS * radii.iter().sum::<f64>();
                    if miss > certain && worst.as_ref().is_none_or(|w| miss > w.miss) {
                        worst = Some(Refutation { points: three, miss });
                    }
                }
            }
        }
        worst
    }
}

/// The turn at the second of three points.
fn angle(a: P, b: P, c: P) -> f64 {
    let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    libm::atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1])
}

/// The distance of the second of three circles from the outer tangent of the other two, on its side.
fn beyond([a, b, c]: [P; 3], [ra, rb, rc]: [f64; 3], side: f64) -> f64 {
    let chord = [c[0] - a[0], c[1] - a[1]];
    let length = libm::hypot(chord[0], chord[1]);
    // The normal to the side of the chord, turned to the tangent: n . chord = ra - rc.
    let sine = (ra - rc) / length;
    if sine.is_nan() || sine.abs() >= 1.0 {
        return f64::NEG_INFINITY;
    }
    let cosine = (1.0 - sine * sine).sqrt();
    let along = chord.map(|x| x / length);
    let across = [-along[1] * side, along[0] * side];
    let n = [across[0] * cosine + along[0] * sine, across[1] * cosine + along[1] * sine];
    n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]) - ra - rb
}

/// The same for points that move along a direction: the least distance of the second from the chord, which is at
/// ends of their moves.
fn beyond_along(points: [P; 3], radii: [f64; 3], d: P, side: f64) -> f64 {
    let corners = (0..8).map(|bits: u32| {
        let at = |k: usize| {
            let by = if (bits >> k) & 1 == 1 { radii[k] } else { -radii[k] };
            [points[k][0] + by * d[0], points[k][1] + by * d[1]]
        };
        let [a, b, c] = [0, 1, 2].map(at);
        let (u, v) = ([c[0] - a[0], c[1] - a[1]], [b[0] - a[0], b[1] - a[1]]);
        side * (u[0] * v[1] - u[1] * v[0]) / libm::hypot(u[0], u[1])
    });
    corners.fold(f64::INFINITY, f64::min)
}
