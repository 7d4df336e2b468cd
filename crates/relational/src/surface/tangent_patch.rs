//! Patches between four curves that are tangent to the surfaces of their neighbours.

use super::coons::CoonsBoundary;
use super::ribbon::{SnakePoint, ribbon, unit};
use crate::arguments::Snake;
use moldloft_num::trace::Edges;
use moldloft_num::{Jet, Real, SurfaceFormula, Uni1, Vec3};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};

/// A patch between four curves, its edges v = 0, u = 1, v = 1 and u = 0, each in increasing
/// parameter, tangent to the surfaces of the curves that are snakes, except those listed as `free`.
///
/// It is the bicubically blended Coons patch (Coons 1967) of the curves and of slopes across them,
/// with the twists of Gregory (1974), which need not agree at the corners. The slope across a snake
/// is in the tangent plane of its surface; its components along the snake and perpendicular to it
/// vary linearly between those of the two neighbouring edges. Across a free edge it is the slope of
/// the bilinear patch. A neighbour must leave a tangent edge in the tangent plane there, as snakes
/// of the same surface do: otherwise no patch is tangent at that corner. With three curves the edge
/// u = 0 is the point at which the first and the third begin.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "sides",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.5); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); \
               AbsPoint G(2, 1, 0.6); BCurve a({A, G, B}, 2); Line b(C, D); RuledSurf floor(a, b); \
               EdgeSnake low(3, floor); BlendPoint I({C, A}, {1.5, -0.5}); BlendPoint J({D, B}, {1.5, -0.5}); \
               AbsPoint E(0, 6, 2); AbsPoint F(4, 6, 1.5); BCurve west({C, I, E}, 2); \
               BCurve east({D, J, F}, 2); Line high(E, F); TanBoundary S({low, east, high, west}); \
               TanBoundary plain({low, east, high, west}, free = {1});"
)]
pub struct TanBoundary<T: Real> {
    /// The four (or three) boundary curves; snakes for the edges that are tangent to a surface.
    #[field(min_items = 3)]
    sides: Vec<CurveRef<T>>,
    /// The numbers (from 1) of sides without tangency although they are snakes.
    free: Option<Vec<usize>>,
}

/// The sine of the angle by which a neighbour may leave a tangent plane.
const IN_PLANE: f64 = 1e-6;

/// The parameters at which a tangent edge is tried.
const TRIALS: usize = 16;

impl<T: Real> Build<T> for TanBoundary<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { sides, free } = self;
        let free = free.unwrap_or_default();
        if let Some(k) = free.iter().position(|side| !(1..=sides.len()).contains(side)) {
            return Err(CallError::new("out-of-range", format!("no side {}", free[k]))
                .expected(format!("a number from 1 to {}", sides.len()))
                .found(free[k].to_string())
                .in_item(k)
                .in_field(Self::FREE));
        }
        let snake = |k: usize, curve: &CurveRef<T>| {
            let surface = curve.surface.as_deref().filter(|_| !free.contains(&(k + 1)))?.clone();
            Some(Snake { curve: curve.clone(), surface })
        };
        let snakes: Vec<_> = sides.iter().enumerate().map(|(k, c)| snake(k, c)).collect();
        let boundary = CoonsBoundary::new(sides, Self::SIDES)?;
        let patch = TangentPatch::new(boundary, snakes)?;
        Ok(Value::Surface(SurfaceRef::new(patch, context.nesting)))
    }
}

/// The slope across an edge.
enum CrossDerivative<T: Real> {
    /// The slope of the bilinear patch.
    Free,
    /// In the tangent plane of the snake's surface: components along the snake and perpendicular to
    /// it at its ends.
    Tangent(Snake<T>, [[T; 2]; 2]),
}

struct TangentPatch<T: Real> {
    boundary: CoonsBoundary<T>,
    /// Slopes across the edges v = 0, u = 1, v = 1, u = 0.
    across: [CrossDerivative<T>; 4],
    /// The derivatives of the sides at their ends.
    leaving: [[Vec3<T>; 2]; 4],
    /// By v along edge u = const, and by u along edge v = const, at the corners (0, 0), (1, 0), (1, 1)
    /// and (0, 1): d/dv of S_u and d/du of S_v.
    twists: [[Vec3<T>; 2]; 4],
}

/// Unit vectors along a snake and perpendicular to it in the tangent plane.
fn basis<J: Real>(at: &SnakePoint<J>) -> [Vec3<J>; 2] {
    let along = unit(at.along);
    [along, at.normal.cross(along)]
}

/// The edges adjacent to edge k at its start and end, and true if they meet it with their start.
const NEIGHBOURS: [([usize; 2], bool); 4] =
    [([3, 1], true), ([0, 2], false), ([3, 1], false), ([0, 2], true)];

impl<T: Real> TangentPatch<T> {
    fn new(boundary: CoonsBoundary<T>, snakes: Vec<Option<Snake<T>>>) -> Result<Self, CallError> {
        let zero = Vec3::zero();
        let free = || CrossDerivative::Free;
        let leaving = [0, 1, 2, 3].map(|k| {
            let at = |end: f64| boundary.side(k, Uni1::parameter(T::from(end)));
            [at(0.0), at(1.0)].map(|p: Vec3<Uni1<T>>| p.map(|x| x.t))
        });
        let across = [free(), free(), free(), free()];
        let mut patch = TangentPatch { boundary, across, leaving, twists: [[zero; 2]; 4] };
        for (k, snake) in snakes.into_iter().enumerate() {
            if let Some(snake) = snake {
                let ends = patch.components(k, &snake)?;
                patch.across[k] = CrossDerivative::Tangent(snake, ends);
            }
        }
        let slope =
            |k: usize, t: f64| patch.slope(k, Uni1::parameter(T::from(t))).map(|x: Uni1<T>| x.t);
        patch.twists = [
            [slope(3, 0.0), slope(0, 0.0)],
            [slope(1, 0.0), slope(0, 1.0)],
            [slope(1, 1.0), slope(2, 1.0)],
            [slope(3, 1.0), slope(2, 0.0)],
        ];
        Ok(patch)
    }

    /// The components of both neighbours' slopes where they leave edge `k`.
    fn components(&self, k: usize, snake: &Snake<T>) -> Result<[[T; 2]; 2], CallError> {
        for i in 0..=TRIALS {
            let t = i as f64 / TRIALS as f64;
            let at = ribbon(snake, T::from(t));
            let still = at.along.re().norm() == 0.0;
            if still || at.normal.re().norm() == 0.0 {
                let what = if still {
                    "zero tangent of the snake"
                } else {
                    "its surface has no tangent plane"
                };
                return Err(CallError::new(
                    "no-tangent",
                    format!("{what} at t = {t} of side {}", k + 1),
                )
                .expected("a snake with a tangent plane all along")
                .found("none there")
                .help("leave the side free, or move the snake off the pole of its surface")
                .related(snake.curve.key, "is the side")
                .in_item(k)
                .in_field(TanBoundary::<T>::SIDES));
            }
        }
        let (neighbours, at_begin) = NEIGHBOURS[k];
        let mut both = [[T::zero(); 2]; 2];
        for (end, component) in both.iter_mut().enumerate() {
            let other = neighbours[end];
            let d = self.leaving[other][usize::from(!at_begin)];
            let at = ribbon(snake, T::from(end as f64));
            let out = at.normal.re().dot(d.re());
            if out.abs() > IN_PLANE * d.re().norm() {
                let angle = Real::asin((out.abs() / d.re().norm()).min(1.0)).to_degrees();
                let message = format!(
                    "side {} does not leave side {} in the tangent plane of its surface",
                    other + 1,
                    k + 1
                );
                let key = self.boundary.curves.get(other).and_then(|c| c.key);
                return Err(CallError::new("not-tangent", message)
                    .expected("a side that leaves in the tangent plane there")
                    .found(format!("an angle of {angle:.3} degrees with it"))
                    .help(format!("begin side {} with a tangent to the surface (TanPoint), make it a snake of the same surface, or list side {} as free", other + 1, k + 1))
                    .related(key, "leaves the tangent plane")
                    .in_item(k)
                    .in_field(TanBoundary::<T>::SIDES));
            }
            *component = basis(&at).map(|e| e.dot(d));
        }
        Ok(both)
    }

    /// The slope across edge `k` at `t`: S_v on edges 0 and 2, S_u on 1 and 3.
    fn slope<J: Jet<T>>(&self, k: usize, t: J) -> Vec3<J> {
        match &self.across[k] {
            CrossDerivative::Tangent(snake, [from, to]) => {
                let [e, f] = basis(&ribbon(snake, t));
                let rest = -t + 1.0;
                let part = |c: usize| rest.scaled(from[c]) + t.scaled(to[c]);
                e * part(0) + f * part(1)
            }
            CrossDerivative::Free => {
                let (neighbours, at_begin) = NEIGHBOURS[k];
                let end = usize::from(!at_begin);
                let [a, b] = neighbours.map(|n| self.leaving[n][end].map(J::fixed));
                // Towards the opposite edge, less the excess of the corners' chords.
                let [low, high] = if k == 0 || k == 2 { [0, 2] } else { [3, 1] };
                let chord = self.boundary.side(high, t) - self.boundary.side(low, t);
                let ends = [0.0, 1.0].map(|t| {
                    let t = T::from(t);
                    let p: Vec3<T> = self.boundary.side(high, t) - self.boundary.side(low, t);
                    p.map(J::fixed)
                });
                let rest = -t + 1.0;
                chord + (a - ends[0]) * rest + (b - ends[1]) * t
            }
        }
    }
}

/// Cubic Hermite functions: of the value at 0 and 1, of the slope at 0 and 1.
fn hermite<J: Real>(t: J) -> [J; 4] {
    let s = -t + 1.0;
    [s * s * (t * 2.0 + 1.0), t * t * (s * 2.0 + 1.0), t * s * s, -(t * t * s)]
}

impl<T: Real> SurfaceFormula for TangentPatch<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let (hu, hv) = (hermite(u), hermite(v));
        let side = |k: usize, t: J| self.boundary.side(k, t);
        let across = side(0, u) * hv[0] + side(2, u) * hv[1];
        let across = across + self.slope(0, u) * hv[2] + self.slope(2, u) * hv[3];
        let along = side(3, v) * hu[0] + side(1, v) * hu[1];
        let along = along + self.slope(3, v) * hu[2] + self.slope(1, v) * hu[3];
        // The corners: position, slopes by u and v, twist. At a corner the slopes by u and by v are
        // those of the edges that meet there.
        let fixed = |p: Vec3<T>| p.map(J::fixed);
        let (su, sv) = (-u + 1.0, -v + 1.0);
        let mut shared = Vec3::zero();
        let corners = [(0, 0, 0), (1, 1, 0), (2, 1, 1), (3, 0, 1)];
        for (c, i, j) in corners {
            // By u along edges 0 and 2, by v along edges 3 and 1.
            let by_u = fixed(self.leaving[[0, 2][j]][i]);
            let by_v = fixed(self.leaving[[3, 1][i]][j]);
            // The distances from the corner's edges u = i and v = j.
            let (a, b) = (if i == 0 { u } else { su }, if j == 0 { v } else { sv });
            let [p, q] = self.twists[c].map(fixed);
            // On edge v = j only the slope across u = i counts, and conversely. With squares their
            // sum does not vanish outside the patch.
            let (a, b) = (a * a, b * b);
            let sum = a + b;
            let twist =
                if sum.re() == 0.0 { (p + q) * J::from(0.5) } else { (p * a + q * b) / sum };
            shared += fixed(self.boundary.corners[c]) * (hu[i] * hv[j])
                + by_u * (hu[2 + i] * hv[j])
                + by_v * (hu[i] * hv[2 + j])
                + twist * (hu[2 + i] * hv[2 + j]);
        }
        across + along - shared
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        self.boundary.breaks()
    }

    fn edges(&self) -> Edges<T> {
        self.boundary.edges()
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
}
