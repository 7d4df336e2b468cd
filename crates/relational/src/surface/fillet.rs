//! Fillets between snakes, tangent to their surfaces.

use super::column::{Column, ColumnBezier, Columns};
use super::masters::{Points, along};
use super::ribbon::{SnakePoint, ribbon, unit};
use crate::arguments::Snake;
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Jet, Real, Vec3};
use moldloft_registry::{Build, CallError, Class, Context, FromValue, Kind, SurfaceRef, Value};
use std::sync::Arc;

/// A fillet between two snakes, tangent to their surfaces: for each u a cubic from the first snake
/// at v = 0 to the second at v = 1, with end tangents in the two tangent planes.
///
/// The tangents are perpendicular to the snakes ("perpendicular"), along the chord between the two
/// snakes projected to the tangent plane ("chord"), or along a parameter line of the surface ("u",
/// "v"). Their lengths are `m1` and `m2` chords; 1.17 is closest to a circular quarter. With
/// `continuity = 2` it is a quintic that also has the curvature of both surfaces across the edges.
/// For closed snakes `closed = 1` declares the edges u = 0 and u = 1 as one line.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "snake1 snake2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.5); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); \
               AbsPoint E(0, 4, 1); AbsPoint F(4, 4.5, 1); AbsPoint G(0, 4, 4); AbsPoint H(4, 4.2, 4); \
               AbsPoint I(2, 1, 0.6); BCurve a({A, I, B}, 2); Line b(C, D); RuledSurf floor(a, b); \
               Line c(E, F); Line d(G, H); RuledSurf wall(c, d); UVSnake low(floor, \"v\", 0.7); \
               UVSnake high(wall, \"v\", 0.2); FilletSurf S(low, high); \
               FilletSurf G2(low, high, 1.2, 0.9, continuity = 2, direction2 = \"chord\"); \
               FilletSurf across(low, high, direction1 = \"v\");"
)]
pub struct FilletSurf<T: Real> {
    /// Edge v = 0.
    snake1: Snake<T>,
    /// Edge v = 1.
    snake2: Snake<T>,
    /// Length of the tangent at v = 0, relative to the chord between the snakes.
    #[field(default = 1, min = 0)]
    m1: T,
    /// Length of the tangent at v = 1, relative to the chord between the snakes.
    #[field(default = 1, min = 0)]
    m2: T,
    /// 1: common tangent planes; 2: also common curvature across the edges.
    #[field(default = 1, min = 1, max = 2)]
    continuity: usize,
    /// Direction at the first surface: "perpendicular", "chord", "u" or "v".
    #[field(default = "perpendicular")]
    direction1: Direction,
    /// Direction at the second surface: "perpendicular", "chord", "u" or "v".
    #[field(default = "perpendicular")]
    direction2: Direction,
    /// 1 when the edges u = 0 and u = 1 coincide.
    #[field(default = 0, min = 0, max = 1)]
    closed: usize,
}

/// The direction of a fillet's end tangent in the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// Perpendicular to the snake.
    Perpendicular,
    /// Along the chord to the other snake.
    Chord,
    /// Along S_u (0) or S_v (1).
    Line(usize),
}

impl<T: Real> FromValue<T> for Direction {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let text = Arc::<str>::from_value(value)?;
        Ok(match &*text {
            "perpendicular" => Direction::Perpendicular,
            "chord" => Direction::Chord,
            "u" => Direction::Line(0),
            "v" => Direction::Line(1),
            _ => {
                let message = format!("unknown direction \"{text}\"");
                return Err(CallError::new("unknown-direction", message)
                    .expected("\"perpendicular\", \"chord\", \"u\" or \"v\"")
                    .found(format!("\"{text}\"")));
            }
        })
    }
}

/// The parameters at which a new fillet is tried.
const TRIALS: usize = 16;

impl<T: Real> Build<T> for FilletSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { snake1, snake2, m1, m2, continuity, direction1, direction2, closed } = self;
        let contacts = [snake1.curve.clone(), snake2.curve.clone()];
        let side = |snake, length, direction| FilletSide { snake, length, direction, sign: 1.0 };
        let mut fillet = Fillet {
            sides: [side(snake1, m1, direction1), side(snake2, m2, direction2)],
            curved: continuity == 2,
            closed: closed == 1,
        };
        fillet.settle()?;
        fillet.check()?;
        let surface = SurfaceRef::new(Columns(fillet), context.nesting);
        Ok(Value::Surface(surface.with_contacts(contacts)))
    }
}

struct FilletSide<T: Real> {
    snake: Snake<T>,
    length: T,
    direction: Direction,
    /// Sign of the end tangent along its direction.
    sign: f64,
}

struct Fillet<T: Real> {
    /// At v = 0 and v = 1.
    sides: [FilletSide<T>; 2],
    curved: bool,
    closed: bool,
}

impl<T: Real> FilletSide<T> {
    /// The unit direction of increasing v, or zero if undefined.
    fn direction<J: Jet<T>>(&self, at: &SnakePoint<J>, chord: Vec3<J>) -> Vec3<J> {
        let raw = match self.direction {
            Direction::Perpendicular => at.normal.cross(at.along),
            Direction::Chord => chord - at.normal * at.normal.dot(chord),
            Direction::Line(k) => at.tangents[k],
        };
        unit(raw) * J::from(self.sign)
    }
}

impl<T: Real> Fillet<T> {
    fn trials() -> impl Iterator<Item = f64> {
        (0..=TRIALS).map(|k| k as f64 / TRIALS as f64)
    }

    /// The points, chord and directions at a plain parameter.
    fn plain(&self, u: f64) -> ([SnakePoint<T>; 2], Vec3<f64>, [Vec3<f64>; 2]) {
        let ends = [0, 1].map(|k| ribbon(&self.sides[k].snake, T::from(u)));
        let chord = ends[1].p - ends[0].p;
        let directions = [0, 1].map(|k| self.sides[k].direction(&ends[k], chord).re());
        (ends, chord.re(), directions)
    }

    /// Chooses the signs so that the fillet sets out toward the other snake, on the whole.
    fn settle(&mut self) -> Result<(), CallError> {
        let mut sums = [0.0; 2];
        for u in Self::trials() {
            let (ends, chord, directions) = self.plain(u);
            for k in 0..2 {
                if chord.norm() > 0.0 && directions[k].norm() == 0.0 {
                    let at = ends[k].p.re();
                    let (what, help) = if ends[k].normal.re().norm() == 0.0 {
                        ("the surface has no tangent plane", "move the snake off its pole")
                    } else {
                        ("no such direction", "choose another direction")
                    };
                    let message = format!("{what} at u = {u} of snake {}", k + 1);
                    return Err(CallError::new("no-tangent", message)
                        .expected("a tangent along which the fillet may leave")
                        .found(format!("none at ({}, {}, {})", at.x, at.y, at.z))
                        .help(help)
                        .in_field([FilletSurf::<T>::SNAKE1, FilletSurf::<T>::SNAKE2][k]));
                }
                sums[k] += directions[k].dot(chord);
            }
        }
        for k in 0..2 {
            if sums[k] < 0.0 {
                self.sides[k].sign = -1.0;
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), CallError> {
        let mut widest = 0.0_f64;
        for u in Self::trials() {
            let (_, chord, directions) = self.plain(u);
            let length = chord.norm();
            widest = widest.max(length);
            if length == 0.0 {
                continue;
            }
            for k in 0..2 {
                let cosine = directions[k].dot(chord) / length;
                if cosine < -1e-9 {
                    let angle = Real::acos(cosine.max(-1.0)).to_degrees();
                    let message = format!("the fillet turns back at snake {}, u = {u}", k + 1);
                    return Err(CallError::new("fillet-turns-back", message)
                        .expected("a tangent within 90 degrees of the direction to the other snake")
                        .found(format!("{angle:.1} degrees"))
                        .help("move the snakes apart, run both in the same direction, or choose another direction")
                        .in_field([FilletSurf::<T>::SNAKE1, FilletSurf::<T>::SNAKE2][k]));
                }
            }
            let points: Vec<Vec3<f64>> =
                self.column(T::from(u)).iter().map(|p: &Vec3<T>| p.re()).collect();
            if !points.iter().all(|p| p.is_finite()) {
                // Only the quintic takes curvatures.
                let k = usize::from(points[..3].iter().all(|p| p.is_finite()));
                let message = format!("no curvature at u = {u} of snake {}", k + 1);
                return Err(CallError::new("no-curvature", message)
                    .expected("surfaces with a curvature along both snakes")
                    .found("a pole, or a line of no length, there")
                    .help("use `continuity = 1`, or move the snake off the pole")
                    .in_field([FilletSurf::<T>::SNAKE1, FilletSurf::<T>::SNAKE2][k]));
            }
            // The curve itself must not reverse either: its control polygon is short enough.
            for j in 0..=8 {
                let v = f64::from(j) / 8.0;
                let speed = slope(&points, v).dot(chord) / length;
                if speed < -1e-9 * length {
                    let message = format!("the fillet turns back at u = {u}, v = {v}");
                    return Err(CallError::new("fillet-turns-back", message)
                        .expected("a fillet that goes from snake 1 to snake 2")
                        .found(format!("a speed of {speed:.3e} along the chord of {length:.3e}"))
                        .help("lower m1 or m2")
                        .in_field(FilletSurf::<T>::M1));
                }
            }
        }
        if widest == 0.0 {
            return Err(CallError::new(
                "coincident-points",
                "both snakes of the fillet are one line",
            )
            .expected("two snakes with a path from one to the other")
            .found("no distance between them")
            .help("choose another snake for one of the two")
            .in_field(FilletSurf::<T>::SNAKE2));
        }
        if !self.closed {
            return Ok(());
        }
        let [first, last] = [0.0, 1.0].map(|u| self.column(T::from(u)));
        let size = first[0].re().distance(first[first.len() - 1].re());
        let gap =
            first.iter().zip(&last).map(|(p, q): (&Vec3<T>, &Vec3<T>)| p.re().distance(q.re()));
        let gap = gap.fold(0.0, f64::max);
        if gap > 1e-9 * size.max(first[0].re().norm()) {
            return Err(CallError::new("not-closed", "the edges u = 0 and u = 1 are not one line")
                .expected("equal ends and tangents at both ends of the snakes")
                .found(format!("control points {gap:.3e} apart"))
                .help("choose directions that do not depend on the snakes' own tangents: \"u\", \"v\" or \"chord\"")
                .in_field(FilletSurf::<T>::CLOSED));
        }
        Ok(())
    }
}

/// The derivative of a Bézier curve.
fn slope(points: &[Vec3<f64>], v: f64) -> Vec3<f64> {
    let n = points.len() - 1;
    let mut row: Vec<Vec3<f64>> = points.windows(2).map(|p| (p[1] - p[0]) * n as f64).collect();
    while row.len() > 1 {
        row = row.windows(2).map(|p| p[0].lerp(p[1], v)).collect();
    }
    row[0]
}

impl<T: Real> Fillet<T> {
    /// The Bézier points: cubic P, P + m/3; quintic P, P + m/5, P + 2m/5 + k/20, with m the end
    /// tangent and k the second derivative there, kappa |m|^2 n (Farin 2002, section 7.6).
    fn column<J: Jet<T>>(&self, u: J) -> Points<J> {
        let ends = [0, 1].map(|k| ribbon(&self.sides[k].snake, u));
        let chord = ends[1].p - ends[0].p;
        let square = chord.norm_sq();
        let length = if square.re() > 0.0 { square.sqrt() } else { J::zero() };
        let m = [0, 1].map(|k| {
            let side = &self.sides[k];
            side.direction(&ends[k], chord) * length.scaled(side.length)
        });
        let [p, q] = [ends[0].p, ends[1].p];
        if !self.curved {
            let third = J::from(1.0 / 3.0);
            return Points::from_slice(&[p, p + m[0] * third, q - m[1] * third, q]);
        }
        let k = [0, 1].map(|k| {
            if m[k].re().norm() == 0.0 {
                return Vec3::zero();
            }
            ends[k].normal * ends[k].bend(&self.sides[k].snake, m[k])
        });
        let of = |x: f64| J::from(x);
        Points::from_slice(&[
            p,
            p + m[0] * of(0.2),
            p + m[0] * of(0.4) + k[0] * of(0.05),
            q - m[1] * of(0.4) + k[1] * of(0.05),
            q - m[1] * of(0.2),
            q,
        ])
    }
}

impl<T: Real> Column for Fillet<T> {
    type Scalar = T;
    type Across<S: Real> = ColumnBezier<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<ColumnBezier<J>> {
        Some(ColumnBezier(self.column(u)))
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        let mut all: Vec<f64> = self.sides.iter().flat_map(|s| s.snake.curve.breaks()).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        [all, Vec::new()]
    }

    fn edges(&self) -> Edges<T> {
        let [first, second] = [0, 1].map(|k| &self.sides[k].snake.curve);
        let ([a, b], [d, c]) = (first.end_points(), second.end_points());
        let across = |p: Option<Key>, q: Option<Key>| {
            if p.is_some() && p == q { Edge::Pole(p) } else { Edge::Own }
        };
        let east = if self.closed { Edge::SameAs(3) } else { across(b, c) };
        Edges { edges: [along(first), east, along(second), across(a, d)], corners: [a, b, c, d] }
    }
}
