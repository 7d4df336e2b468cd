//! Parallel surfaces. A distance beyond a radius of curvature is refused.

use super::inherited;
use super::ribbon::unit;
use crate::faults::{digits, parameter};
use crate::third_derivatives::{bends, tangents};
use moldloft_num::trace::Edges;
use moldloft_num::{Jet, Order, Real, Surface, SurfaceFormula, Vec3, line_crossings};
use moldloft_registry::{Build, CallError, Context, Kind, SurfaceRef, Value};

/// A surface at a distance from another along its natural normal: S(u, v) + d n(u, v), with n = S_u
/// x S_v / |S_u x S_v|; a negative distance is on the other side.
///
/// At a pole the normal is the limit along the parameter line that ends there. Errors: a distance
/// beyond a radius of curvature on that side, which would fold the offset; a surface without a
/// normal.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface distance",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 0.5, 2); \
               AbsPoint E(2, 2, 2); AbsPoint F(4, 1, 3); BCurve l({A, B, C}); BCurve m({D, E, F}); \
               RuledSurf S(l, m); OffsetSurf plate(S, 0.25); OffsetSurf inside(S, -0.5);"
)]
pub struct OffsetSurf<T: Real> {
    /// The surface that is offset.
    surface: SurfaceRef<T>,
    /// The distance, on the side of the natural normal if positive.
    distance: T,
}

impl<T: Real> Build<T> for OffsetSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, distance } = self;
        check(&surface, distance.re())?;
        Ok(Value::Surface(parallel(surface, distance, context)))
    }
}

/// The parallel surface, unchecked.
pub fn parallel<T: Real>(surface: SurfaceRef<T>, distance: T, context: &Context) -> SurfaceRef<T> {
    let edges = inherited::edges(
        &*surface,
        &ParallelSurface { surface: surface.clone(), distance, edges: Edges::own() },
    );
    let nesting = context.nesting.max(surface.depth);
    SurfaceRef::new(ParallelSurface { surface, distance, edges }, nesting)
}

/// Number of points tested per direction of the surface.
const TRIALS: usize = 24;

/// The tested parameters of a direction: some in each span, and its ends from inside.
fn trials(breaks: &[f64]) -> Vec<f64> {
    let mut ends = vec![0.0];
    ends.extend_from_slice(breaks);
    ends.push(1.0);
    let each = (TRIALS / (ends.len() - 1)).max(4);
    let spans = ends.windows(2);
    spans
        .flat_map(|span| {
            let at = move |k: usize| span[0] + (span[1] - span[0]) * k as f64 / each as f64;
            (0..=each).map(move |k| at(k).clamp(span[0].next_up(), span[1].next_down()))
        })
        .collect()
}

/// Error for a distance beyond a radius of curvature, and for points without a normal.
fn check<T: Real>(surface: &SurfaceRef<T>, distance: f64) -> Result<(), CallError> {
    let [us, vs] = surface.breaks().map(|b| trials(&b));
    let mut worst: Option<(f64, f64, f64)> = None;
    for (u, v) in us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v))) {
        let normal: Vec3<T> = normal(&**surface, T::from(u), T::from(v));
        if normal.re().norm() == 0.0 {
            let at = surface.jet(T::from(u), T::from(v), Order::Zero).p.re();
            return Err(CallError::new(
                "no-normal",
                format!("the surface has no normal at ({}, {})", parameter(u), parameter(v)),
            )
            .expected("a surface with a tangent plane everywhere")
            .found(format!("none at ({}, {}, {})", at.x, at.y, at.z))
            .help("offset a part of the surface without this point")
            .related(surface.key, "is singular there")
            .in_field(OffsetSurf::<T>::SURFACE));
        }
        let Some(bends) = curvatures(surface, u, v) else { continue };
        // Speed of the offset relative to that of the surface: at most 0 at a fold.
        let share = bends.into_iter().map(|k| 1.0 - distance * k).fold(f64::INFINITY, f64::min);
        if worst.is_none_or(|(least, ..)| share < least) {
            worst = Some((share, u, v));
        }
    }
    match worst {
        Some((share, u, v)) if share <= 0.0 => {
            let radius = distance.abs() / (1.0 - share);
            Err(CallError::new("cusp", "the offset exceeds the radius of curvature")
                .expected(format!("a distance less than {} on that side", digits(radius)))
                .found(format!(
                    "{} where (u, v) = ({}, {})",
                    distance.abs(),
                    parameter(u),
                    parameter(v)
                ))
                .help("offset by less, or to the other side, or only a part of the surface")
                .related(surface.key, "has too large a curvature there")
                .in_field(OffsetSurf::<T>::DISTANCE))
        }
        _ => Ok(()),
    }
}

/// The principal curvatures, positive where the surface bends towards its normal; `None` at a
/// singular point.
pub fn curvatures<T: Real>(surface: &SurfaceRef<T>, u: f64, v: f64) -> Option<[f64; 2]> {
    let jet = surface.jet(T::from(u), T::from(v), Order::Second);
    let (su, sv) = (jet.u.re(), jet.v.re());
    let (e, f, g) = (su.dot(su), su.dot(sv), sv.dot(sv));
    let area = e * g - f * f;
    if area <= 1e-12 * e * g || !area.is_finite() {
        return None;
    }
    let n = su.cross(sv) / area.sqrt();
    let (l, m, k) = (jet.uu.re().dot(n), jet.uv.re().dot(n), jet.vv.re().dot(n));
    let mean = (e * k - 2.0 * f * m + g * l) / (2.0 * area);
    let spread = (mean * mean - (l * k - m * m) / area).max(0.0).sqrt();
    Some([mean - spread, mean + spread])
}

/// The surface beside another one.
struct ParallelSurface<T: Real> {
    surface: SurfaceRef<T>,
    distance: T,
    edges: Edges<T>,
}

impl<T: Real> ParallelSurface<T> {
    /// The first surface of a chain of parallels, and the distance from it.
    fn base(&self) -> (&dyn Surface<T>, T) {
        match self.surface.parallel_to() {
            Some((base, distance)) => (base, distance + self.distance),
            None => (&*self.surface, self.distance),
        }
    }
}

impl<T: Real> SurfaceFormula for ParallelSurface<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        let (surface, distance) = self.base();
        beside(surface, J::fixed(distance), u, v)
    }

    fn parallel_to(&self) -> Option<(&dyn Surface<T>, T)> {
        Some(self.base())
    }

    fn inner_planes(&self) -> Vec<moldloft_num::InnerPlane<'_>> {
        self.surface.inner_planes()
    }

    fn edges(&self) -> Edges<T> {
        self.edges.clone()
    }

    /// The identity of the surface's edge under the map.
    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        self.surface.key.and_then(|s| s.edge(k)).into_iter().collect()
    }

    /// Its derivatives take one of the surface more.
    fn breaks(&self) -> [Vec<f64>; 2] {
        self.surface.joints()
    }

    fn joints(&self) -> [Vec<f64>; 2] {
        self.surface.joints()
    }

    fn kinks(&self) -> [Vec<f64>; 2] {
        self.surface.breaks()
    }

    fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
        let mut all = line_crossings(&self.surface.joints(), path, spans);
        all.extend(self.surface.crossings(path, spans));
        all
    }

    moldloft_num::surface_facts!(open, not_rational);
}

/// S + d n at parameters and a distance that may be jets.
pub fn beside<T: Real, J: Jet<T>>(surface: &dyn Surface<T>, distance: J, u: J, v: J) -> Vec3<J> {
    surface.at(u, v) + normal(surface, u, v) * distance
}

/// Below this the ratio of the lengths of S_u and S_v, or the sine of the angle between them, is
/// rounding.
const SINGULAR: f64 = 1e-10;

/// The unit normal at parameters that may be jets; its limit at a pole; zero if undefined.
pub fn normal<T: Real, J: Jet<T>>(surface: &dyn Surface<T>, u: J, v: J) -> Vec3<J> {
    let [su, sv] = tangents(surface, u, v);
    let (along, across) = (su.re().norm(), sv.re().norm());
    // S_u = (v - v0) times the mean of S_uv between v0 and v, which Simpson's rule gives exactly to
    // the order of jets. Inside is at smaller parameters when the pole is at the far edge.
    let mean = |by_v: bool| {
        let at = if by_v { v } else { u };
        let start = at.re();
        let place = |share: f64| (at - start) * share + start;
        let twist = |share: f64| {
            let [_, twist, _] = match by_v {
                true => bends(surface, u, place(share)),
                false => bends(surface, place(share), v),
            };
            twist
        };
        let mean = (twist(0.0) + twist(0.5) * J::from(4.0) + twist(1.0)) / J::from(6.0);
        if start > 0.5 { -mean } else { mean }
    };
    let (a, b) = if along <= SINGULAR * across {
        (mean(true), sv)
    } else if across <= SINGULAR * along {
        (su, mean(false))
    } else {
        (su, sv)
    };
    let n = a.cross(b);
    let size = a.re().norm() * b.re().norm();
    if n.re().norm() > SINGULAR * size { unit(n) } else { Vec3::zero() }
}
