//! Curves projected onto surfaces, point by point.

use super::arguments::Onto;
use super::equations::{FootOnSurface, Moving, OnRay, Rays};
use super::magnets::{foot, on_ray, rays};
use super::points::MirrorOrSurface;
use super::table::Table;
use crate::arguments::Magnet;
use moldloft_locate::implicit::{jets, solve};
use moldloft_locate::{OUTSIDE, PlainSurface, UnknownBounds, newton};
use moldloft_num::period::within;
use moldloft_num::trace::{Key, Trace};
use moldloft_num::{Curve, CurveJet, Order, Real, SurfJet, Surface, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, FieldRef, Kind, MirrorArgument, SearchReport,
    SearchStatus, SurfaceRef, Value,
};
use std::sync::OnceLock;

/// The first step along the curve, and the least.
const STEP: f64 = 1.0 / 64.0;
const LEAST_STEP: f64 = 1e-9;

/// A foot may not move farther than this in u or v during a step: then it has jumped.
const LONGEST_MOVE: f64 = 0.15;

/// Length of a Newton step, relative to the size, after which the error (its square) is below
/// rounding.
const CLOSE: f64 = 1e-8;

/// Step along the curve of the differences that give second derivatives of a path of feet, for which third ones of the
/// surface would be needed: with five points some ten digits remain.
const FOOT_STEP: f64 = 1.0 / 1024.0;

/// Distance from a break at which both sides of a path are compared, and the distance of feet, relative to the size, from
/// which it jumps.
const BESIDE: f64 = 1e-9;
const JUMP: f64 = 1e-6;

/// Distance of these points from the breaks of the path, which are known to rounding only.
const ASIDE: f64 = 1e-7;

/// Maximum error of positions from a table, relative to the size.
const TABLE_ACCURACY: f64 = 1e-13;

/// The projection of a curve onto a surface, point by point, as a snake: along the surface's
/// normals, along a direction, or away from a point.
///
/// The foot of the start of the curve is found first, near the magnet if one is given; the
/// projection follows the curve from there continuously. Each of its points is on the surface and
/// is the projection to rounding. A projection that leaves the surface or is tangent to it is an
/// error.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel curve surface mirror",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 1, 2); AbsPoint Q(3, 1, 2); \
               AbsPoint R(2, 1.2, 2.5); BCurve c({P, R, Q}); ProjSnake s(c, S); ProjSnake t(c, S, \"z=0\"); \
               AbsPoint eye(2, 1.5, 8); ProjSnake u(c, S, eye);"
)]
pub struct ProjSnake<T: Real> {
    /// The curve to project.
    curve: CurveRef<T>,
    /// The surface, or a magnet on it near the projection of the start of the curve.
    surface: Onto<T>,
    /// Direction of projection: a plane's normal, a line's direction, or rays from a point.
    /// Default: the surface's own normals.
    mirror: Option<MirrorArgument<T>>,
    /// Magnets at the two ends, shared with other snakes so that patches join there.
    #[field(default)]
    ends: Option<Vec<Magnet<T>>>,
}

impl<T: Real> Build<T> for ProjSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { curve, surface, mirror, ends } = self;
        let rays = mirror.as_ref().map(rays);
        let (path, found) = projected(curve, surface, rays, [Self::CURVE, Self::SURFACE])?;
        let keys = match ends {
            None => [None, None],
            Some(magnets) => end_keys(&path, &magnets, context.tolerance, Self::ENDS)?,
        };
        let surface = path.surface.clone();
        let shape = Projected { trace: Trace::Own(keys), path };
        Ok(Value::Curve(CurveRef::snake(shape, surface, context.nesting).with_found(found)))
    }
}

/// The projection of a curve onto a plane, line, point, surface or the zero set of a field, point by point, as a curve in
/// space.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel curve mirror",
    example = "AbsPoint A(0, 1, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); \
               BCurve c({A, B, C}); ProjCurve flat(c, \"z=0\");"
)]
pub struct ProjCurve<T: Real> {
    /// The curve to project.
    curve: CurveRef<T>,
    /// The target of the projection.
    mirror: MirrorOrSurface<T>,
}

impl<T: Real> Build<T> for ProjCurve<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        match self.mirror {
            MirrorOrSurface::MirrorArgument(mirror) => {
                let shape = OntoMirror { curve: self.curve, mirror };
                Ok(Value::Curve(CurveRef::new(shape, context.nesting)))
            }
            MirrorOrSurface::Surface(onto) => {
                let (path, found) = projected(self.curve, onto, None, [Self::CURVE, Self::MIRROR])?;
                let shape = Projected { trace: Trace::own(), path };
                Ok(Value::Curve(CurveRef::new(shape, context.nesting).with_found(found)))
            }
            MirrorOrSurface::Field(field) => {
                for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                    let p = self.curve.jet(T::from(t), Order::Zero)[0];
                    super::points::foot_on_level(&field, p)
                        .map_err(|f| f.in_field(Self::MIRROR))?;
                }
                let shape = OntoField { curve: self.curve, field };
                Ok(Value::Curve(CurveRef::new(shape, context.nesting)))
            }
        }
    }
}

/// The feet of a curve's points on the zero set of a field.
struct OntoField<T: Real> {
    curve: CurveRef<T>,
    field: FieldRef<T>,
}

impl<T: Real> OntoField<T> {
    fn first(&self, t: T) -> [Vec3<T>; 2] {
        let [p, d, _] = self.curve.jet(t, Order::First);
        let nan = Vec3::lifted(Vec3::of(f64::NAN, f64::NAN, f64::NAN));
        super::points::foot_rate(&self.field, p, d).unwrap_or([nan; 2])
    }
}

/// Step of the differences that give second derivatives, for which third ones of the field would be
/// needed: with the five-point formula some nine digits remain.
const BEND_STEP: f64 = 1.0 / 1024.0;

impl<T: Real> Curve<T> for OntoField<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [x, d] = self.first(t);
        if order != Order::Second {
            return [x, d, Vec3::zero()];
        }
        let at = |k: f64| self.first(t + k * BEND_STEP)[1];
        let near = (at(1.0) - at(-1.0)) * T::from(8.0);
        [x, d, (near - (at(2.0) - at(-2.0))) / T::from(12.0 * BEND_STEP)]
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}

struct OntoMirror<T: Real> {
    curve: CurveRef<T>,
    mirror: MirrorArgument<T>,
}

impl<T: Real> Curve<T> for OntoMirror<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        let [p, d, dd] = self.curve.jet(t, order);
        let turned = |v| self.mirror.direction(v, true);
        [self.mirror.foot(p), turned(d), turned(dd)]
    }
    fn image_of(&self) -> Option<moldloft_num::trace::Key> {
        self.curve.key
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.curve.grid(ts, out);
        for p in out {
            *p = self.mirror.foot(*p);
        }
    }

    moldloft_num::curve_facts!(breaks of [self.curve], closed of [self.curve], rational of [self.curve]);
}

/// Keys of magnets at the ends of a path.
fn end_keys<T: Real>(
    path: &ProjectedPath<T>,
    magnets: &[Magnet<T>],
    tolerance: f64,
    field: FieldId,
) -> Result<[Option<Key>; 2], CallError> {
    let [first, last] = magnets else {
        return Err(CallError::new("wrong-length", "a snake has two ends")
            .expected("two magnets")
            .found(magnets.len().to_string())
            .in_field(field));
    };
    for (k, magnet) in [first, last].into_iter().enumerate() {
        let w = path.place(T::from(k as f64), Order::Zero)[0];
        let x = path.surface.jet(w.x, w.y, Order::Zero).p.re();
        let m = magnet.surface.jet(magnet.uv[0], magnet.uv[1], Order::Zero).p.re();
        let gap = x.distance(m);
        if gap > tolerance {
            let which = ["beginning", "end"][k];
            return Err(CallError::new(
                "open-end",
                format!("the magnet is not at the {which} of the snake"),
            )
            .expected(format!("a magnet within {tolerance:e} of it"))
            .found(format!("a distance of {gap:.6e}"))
            .help("make it by ProjMagnet from the same end of the curve")
            .related(magnet.key, "is the magnet")
            .in_item(k)
            .in_field(field));
        }
    }
    Ok([first.key, last.key])
}

/// A solution at a parameter of the curve.
#[derive(Clone, Copy, Debug)]
struct ProjectionSample {
    t: f64,
    q: [f64; 3],
    rate: [f64; 3],
}

/// The path of the projection in the parameter plane of the surface.
struct ProjectedPath<T: Real> {
    surface: SurfaceRef<T>,
    point: Moving<T>,
    rays: Option<Rays<T>>,
    size: f64,
    nodes: Vec<ProjectionSample>,
    /// Computed on first use, as the breaks are.
    table: OnceLock<Table<3>>,
    breaks: OnceLock<Vec<f64>>,
}

/// Follows the projection of the curve from its start to its end.
fn projected<T: Real>(
    curve: CurveRef<T>,
    onto: Onto<T>,
    rays: Option<Rays<T>>,
    [of, on]: [FieldId; 2],
) -> Result<(ProjectedPath<T>, SearchReport), CallError> {
    let begin = curve.end(0.0);
    let (uv, mut found) = match rays {
        None => foot(&onto, begin, false),
        Some(rays) => on_ray(&onto, begin, rays),
    }
    .map_err(|fault| fault.in_field(on))?;
    if found.status == SearchStatus::EdgeClamped {
        return Err(leaves(0.0, of));
    }
    let corners = [0.0, 0.5, 1.0].map(|t| curve.end(t).re());
    let size = moldloft_locate::pieces::size_of(&moldloft_num::Box3::around(corners));
    let point = Moving::Curve(curve);
    let mut path = ProjectedPath {
        surface: onto.surface,
        point,
        rays,
        size,
        nodes: Vec::new(),
        table: OnceLock::new(),
        breaks: OnceLock::new(),
    };
    let closed = path.surface.closed();
    let uv = uv.map(|x| x.re());
    let s = path.ray_length(uv);
    let node = path.solved(0.0, [uv[0], uv[1], s]).ok_or_else(|| grazes(0.0, on))?;
    path.nodes.push(node);
    let mut step = STEP;
    while let Some(&last) = path.nodes.last().filter(|node| node.t < 1.0) {
        let t = if last.t + 1.5 * step >= 1.0 { 1.0 } else { last.t + step };
        let dt = t - last.t;
        let guess = std::array::from_fn(|k| last.q[k] + last.rate[k] * dt);
        let inside =
            |q: [f64; 3]| (0..2).all(|k| closed[k] || q[k] >= -OUTSIDE && q[k] <= 1.0 + OUTSIDE);
        let next = path.solved(t, guess).filter(|node| {
            inside(node.q)
                && (0..2).all(|k| {
                    (node.q[k] - guess[k]).abs() <= 0.25 * LONGEST_MOVE
                        && (node.q[k] - last.q[k]).abs() <= LONGEST_MOVE
                })
        });
        match next {
            Some(node) => {
                path.nodes.push(node);
                step = (2.0 * step).min(STEP);
            }
            None if step > LEAST_STEP => step *= 0.5,
            None => {
                let near_end = |x: f64| !(1e-4..=1.0 - 1e-4).contains(&x);
                let at_edge = (0..2).any(|k| !closed[k] && near_end(last.q[k]));
                return Err(if at_edge { leaves(last.t, of) } else { grazes(last.t, on) });
            }
        }
    }
    if let Some(t) = path.jump() {
        return Err(jumps(t, on));
    }
    found.advice = "to choose another one, give a magnet near the start of the snake";
    Ok((path, found))
}

fn leaves(t: f64, field: FieldId) -> CallError {
    CallError::new("leaves-surface", "the projection of the curve leaves the surface")
        .expected("a curve whose projection lies on the surface from end to end")
        .found(format!("the edge of the surface at t = {t:.6} of the curve"))
        .help("use a part of the curve (SubCurve), or a larger surface")
        .in_field(field)
}

fn grazes(t: f64, field: FieldId) -> CallError {
    CallError::new("grazing-projection", "the projection grazes the surface")
        .expected("lines of projection that cross the surface at an angle")
        .found(format!("a line tangent to it at t = {t:.6} of the curve"))
        .help("project away from a point, along another direction, or from nearer to the surface")
        .in_field(field)
}

fn jumps(t: f64, field: FieldId) -> CallError {
    CallError::new(
        "grazing-projection",
        "the projection jumps from one part of the surface to another",
    )
    .expected("a curve whose feet on the surface move continuously")
    .found(format!(
        "two feet at t = {t:.6} of the curve, beside a line where derivatives of the surface jump"
    ))
    .help("project along a direction or away from a point, or from nearer to the surface")
    .in_field(field)
}

impl<T: Real> ProjectedPath<T> {
    fn ray_length(&self, [u, v]: [f64; 2]) -> f64 {
        let Some(rays) = self.rays else { return 0.0 };
        let system = OnRay { surface: &self.surface, point: &self.point, rays };
        let [p, d] = system.ray::<T>(T::zero()).map(Vec3::re);
        let x = self.surface.jet(T::from(u), T::from(v), Order::Zero).p.re();
        (x - p).dot(d) / d.norm_sq()
    }

    /// The solution at plain `t` near `guess`, and its rate.
    fn solved(&self, t: f64, guess: [f64; 3]) -> Option<ProjectionSample> {
        let q = self.root(t, guess)?;
        let [_, rate, _] = self.derived(q, T::from(t), Order::First)?;
        let node = ProjectionSample { t, q, rate: rate.map(|x| x.re()) };
        node.rate.iter().all(|x| x.is_finite()).then_some(node)
    }

    /// The unknowns at plain `t`. From a guess that is good to half the digits one Newton step is
    /// enough; else the iteration is damped.
    fn root(&self, t: f64, guess: [f64; 3]) -> Option<[f64; 3]> {
        let plain = PlainSurface(&*self.surface);
        // A closed surface may be gone round many times.
        let wide = self.surface.closed().map(|round| {
            let beyond = if round { 1e4 } else { 0.5 };
            UnknownBounds { low: -beyond, high: 1.0 + beyond, step: 0.2 }
        });
        let close = CLOSE * self.size;
        match self.rays {
            None => {
                let p = self.point.at::<T>(T::from(t)).re();
                // Slopes over lengths are lengths.
                let equations = |j: &SurfJet<f64>| {
                    let r = j.p - p;
                    let (a, b) = (j.u.norm().max(1e-300), j.v.norm().max(1e-300));
                    let cross = j.u.dot(j.v) + j.uv.dot(r);
                    (
                        [j.u.dot(r) / a, j.v.dot(r) / b],
                        [
                            [(j.u.norm_sq() + j.uu.dot(r)) / a, cross / a],
                            [cross / b, (j.v.norm_sq() + j.vv.dot(r)) / b],
                        ],
                    )
                };
                let j = plain.jet(guess[0], guess[1], Order::Second);
                let (rest, matrix) = equations(&j);
                if let Some([u, v]) = solve(&matrix, rest)
                    && (j.u * u + j.v * v).norm() <= close
                {
                    return Some([guess[0] - u, guess[1] - v, 0.0]);
                }
                let walk = newton([guess[0], guess[1]], &wide, self.size, |[u, v]| {
                    equations(&plain.jet(u, v, Order::Second))
                });
                walk.found.then_some([walk.at[0], walk.at[1], 0.0])
            }
            Some(rays) => {
                let system = OnRay { surface: &self.surface, point: &self.point, rays };
                let [p, d] = system.ray::<T>(T::from(t)).map(Vec3::re);
                let steep = |j: &SurfJet<f64>| j.normal().dot(d).abs() > 1e-5 * d.norm();
                let equations = |j: &SurfJet<f64>, s: f64| {
                    let all = [j.u.to_array(), j.v.to_array(), (-d).to_array()];
                    let matrix: [[f64; 3]; 3] =
                        std::array::from_fn(|r| std::array::from_fn(|c| all[c][r]));
                    ((j.p - p - d * s).to_array(), matrix)
                };
                let j = plain.jet(guess[0], guess[1], Order::First);
                let (rest, matrix) = equations(&j, guess[2]);
                if let Some(step) = solve(&matrix, rest)
                    && (j.u * step[0] + j.v * step[1]).norm() <= close
                    && steep(&j)
                {
                    return Some(std::array::from_fn(|k| guess[k] - step[k]));
                }
                let ranges = [wide[0], wide[1], UnknownBounds::FREE];
                let walk = newton(guess, &ranges, self.size, |[u, v, s]| {
                    equations(&plain.jet(u, v, Order::First), s)
                });
                let last = plain.jet(walk.at[0], walk.at[1], Order::First);
                (walk.found && steep(&last)).then_some(walk.at)
            }
        }
    }

    /// The unknowns as functions of t.
    fn derived(&self, q: [f64; 3], t: T, order: Order) -> Option<[[T; 3]; 3]> {
        match self.rays {
            None => {
                let mut all = self.foot(q, t)?;
                if order == Order::Second {
                    all[2] = self.foot_bend(t)?;
                }
                Some(all)
            }
            Some(rays) => {
                let system = OnRay { surface: &self.surface, point: &self.point, rays };
                jets(&system, q, t, order)
            }
        }
    }

    /// The foot and its rate.
    fn foot(&self, [u, v, _]: [f64; 3], t: T) -> Option<[[T; 3]; 3]> {
        let system = FootOnSurface { surface: &self.surface, point: &self.point, held: [None; 2] };
        let all: [[T; 2]; 3] = jets(&system, [u, v], t, Order::First)?;
        Some(all.map(|[u, v]| [u, v, T::zero()]))
    }

    /// The second derivative of the foot: that of the polynomial through the rates at five points on the smooth stretch
    /// of the path.
    fn foot_bend(&self, t: T) -> Option<[T; 3]> {
        let breaks = self.breaks();
        let next = breaks.partition_point(|b| *b <= t.re());
        let from = if next == 0 { 0.0 } else { breaks[next - 1] };
        let until = breaks.get(next).copied().unwrap_or(1.0);
        let aside = ASIDE.min(1e-3 * (until - from));
        let (low, high) = (from + aside, until - aside);
        let step = FOOT_STEP.min((high - low) / 4.0);
        let middle = t.re().clamp(low + 2.0 * step, high - 2.0 * step);
        let weights = slope_weights((t.re() - middle) / step);
        let mut bend = [T::zero(); 3];
        for (k, weight) in weights.into_iter().enumerate() {
            let at = t + (middle + (k as f64 - 2.0) * step - t.re());
            let [_, rate, _] = self.foot(self.unknowns(at.re()), at)?;
            for (sum, x) in bend.iter_mut().zip(rate) {
                *sum += x * (weight / step);
            }
        }
        Some(bend)
    }

    /// The parameters at which a derivative of the path up to the second may jump: breaks of the curve, and crossings with
    /// lines of the surface. A foot is given by first derivatives of the surface, so that third ones count.
    fn breaks(&self) -> &[f64] {
        self.breaks.get_or_init(|| {
            let own = match &self.point {
                Moving::Curve(curve) => curve.breaks(),
                Moving::Fixed(_) => Vec::new(),
            };
            let surface = &self.surface;
            let lines = if self.rays.is_none() { surface.joints() } else { surface.breaks() };
            let at = |t: f64| {
                let ([u, v, _], _) = self.sought(t);
                [u, v]
            };
            let closed = surface.closed();
            let nodes: Vec<(f64, [f64; 2])> =
                self.nodes.iter().map(|n| (n.t, [n.q[0], n.q[1]])).collect();
            let mut all = super::on_surface::crossings(&lines, closed, &nodes, at);
            for plane in surface.inner_planes() {
                let inside = |w: [f64; 2]| (plane.place)(within(closed, w));
                let nodes: Vec<_> = nodes.iter().map(|&(t, w)| (t, inside(w))).collect();
                let at = |t: f64| inside(at(t));
                all.extend(super::on_surface::crossings(&plane.joints, plane.closed, &nodes, at));
            }
            all.extend(own);
            all.retain(|t| *t > BESIDE && *t < 1.0 - BESIDE);
            all.sort_by(f64::total_cmp);
            all.dedup_by(|next, kept| *next - *kept <= BESIDE);
            all
        })
    }

    /// A parameter at which the path of feet is not continuous: at a line of the surface the foot may end.
    fn jump(&self) -> Option<f64> {
        if self.rays.is_some() {
            return None;
        }
        self.breaks().iter().copied().find(|t| {
            let [a, b] = [-1.0, 1.0].map(|side| {
                let ([u, v, _], _) = self.sought(t + side * BESIDE);
                self.surface.jet(T::from(u), T::from(v), Order::Zero).p.re()
            });
            a.distance(b) > JUMP * self.size
        })
    }

    /// The unknowns at plain `t` by the iteration, from the cubic of the nodes on both sides, which is
    /// so near that one step does.
    fn sought(&self, t: f64) -> ([f64; 3], bool) {
        let after = self.nodes.partition_point(|node| node.t < t).min(self.nodes.len() - 1);
        let node = &self.nodes[after];
        let before = &self.nodes[after.saturating_sub(1)];
        let span = node.t - before.t;
        let guess = if span > 0.0 {
            let x = (t - before.t) / span;
            let y = 1.0 - x;
            std::array::from_fn(|k| {
                before.q[k] * (y * y * (1.0 + 2.0 * x))
                    + before.rate[k] * (span * y * y * x)
                    + node.q[k] * (x * x * (3.0 - 2.0 * x))
                    - node.rate[k] * (span * x * x * y)
            })
        } else {
            std::array::from_fn(|k| node.q[k] + node.rate[k] * (t - node.t))
        };
        match self.root(t, guess) {
            Some(q) => (q, true),
            None => (guess, false),
        }
    }

    fn unknowns(&self, t: f64) -> [f64; 3] {
        let table = self.table.get_or_init(|| {
            let mut ends = vec![0.0, 1.0];
            if let Moving::Curve(curve) = &self.point {
                ends.extend(curve.joints().into_iter().filter(|t| *t > 0.0 && *t < 1.0));
            }
            ends.extend(self.breaks());
            ends.sort_by(f64::total_cmp);
            ends.dedup();
            let plain = PlainSurface(&*self.surface);
            Table::new(
                &ends,
                |t| Some(self.sought(t)).filter(|(_, found)| *found).map(|(q, _)| q),
                |a, b| {
                    let j = plain.jet(a[0], a[1], Order::First);
                    let off = (j.u * (b[0] - a[0]) + j.v * (b[1] - a[1])).norm();
                    off <= TABLE_ACCURACY * self.size
                },
            )
        });
        table.at(t).unwrap_or_else(|| self.sought(t).0)
    }

    /// (u, v, 0) at `t` with derivatives; at a seam it jumps between 1 and 0.
    fn place(&self, t: T, order: Order) -> CurveJet<T> {
        let mut jet = self.run_on(t, order);
        let [u, v] = within(self.surface.closed(), [jet[0].x, jet[0].y]);
        jet[0] = Vec3::new(u, v, T::zero());
        jet
    }

    /// The parameters (u, v, 0) at `t` with derivatives, continued over a seam without a step.
    fn run_on(&self, t: T, order: Order) -> CurveJet<T> {
        let q = self.unknowns(t.re());
        let plain = || Vec3::new(T::from(q[0]), T::from(q[1]), T::zero());
        if T::PARTS == 1 && order == Order::Zero {
            return [plain(), Vec3::zero(), Vec3::zero()];
        }
        let Some(all) = self.derived(q, t, order) else {
            return [plain(), Vec3::zero(), Vec3::zero()];
        };
        all.map(|[u, v, _]| Vec3::new(u, v, T::zero()))
    }
}

/// The weights of values at -2, -1, 0, 1 and 2 in the derivative at `x` of the polynomial through them.
fn slope_weights(x: f64) -> [f64; 5] {
    let node = |k: usize| k as f64 - 2.0;
    std::array::from_fn(|k| {
        let others = || (0..5).filter(move |&m| m != k);
        let without = |m: usize| {
            let rest = others().filter(move |&n| n != m);
            rest.map(|n| (x - node(n)) / (node(k) - node(n))).product::<f64>()
        };
        others().map(|m| without(m) / (node(k) - node(m))).sum()
    })
}

/// X(t) = S(w(t)).
struct Projected<T: Real> {
    trace: Trace<T>,
    path: ProjectedPath<T>,
}

impl<T: Real> Curve<T> for Projected<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        super::on_surface::on_surface_jet(&self.path.surface, self.path.place(t, order), order)
    }

    /// Each evaluated separately; they are independent of each other.
    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        for (out, &t) in out.iter_mut().zip(ts) {
            let [w, ..] = self.path.place(T::from(t), Order::Zero);
            *out = self.path.surface.jet(w.x, w.y, Order::Zero).p;
        }
    }

    fn breaks(&self) -> Vec<f64> {
        self.path.breaks().to_vec()
    }

    fn trace(&self) -> Trace<T> {
        self.trace.clone()
    }

    fn on_surface(&self, t: T, order: Order) -> Option<CurveJet<T>> {
        Some(self.path.place(t, order))
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}
