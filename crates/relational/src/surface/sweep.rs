//! Curves swept along paths by a moving frame.

use super::law::law;
use super::masters::{along, is_closed};
use crate::third_derivatives::tangent;
use moldloft_num::trace::{Edge, Edges, Key};
use moldloft_num::{Jet, Order, Real, SurfJet, Surface, Uni1, Uni2, Vec3, surface_jet_of};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Scalar, SurfaceRef, Value,
};
use moldloft_spline::{BSplineCurve, KnotVector};

/// A curve swept along a path by a moving frame: S(u, v) = path(v) + F(v) (profile(u) - path(0)),
/// with F(0) = 1, so that edge v = 0 is the profile.
///
/// Frames: "minimal" does not rotate about the tangent of the path (rotation-minimising; Wang,
/// Juettler, Zheng and Liu 2008); "up" keeps one axis as upright as the tangent allows; "fixed"
/// only translates the profile, along a path that may have corners. `twist` and `scale` are
/// functions of v: coefficients of a clamped uniform B-spline of degree at most 3, so {a, b} is
/// linear from a to b. The twist is right-handed about the tangent ("fixed": about the tangent at v
/// = 0).
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "profile path frame",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(3, 2, 0.5); AbsPoint D(3, 3, 3); \
               BCurve path({A, B, C, D}); AbsPoint P(0, 0.5, 0); AbsPoint Q(0.1, 0.3, 0.6); \
               AbsPoint R(0, -0.5, 0.2); BCurve profile({P, Q, R}); SweepSurf S(profile, path); \
               SweepSurf upright(profile, path, \"up\", up = {0, 0.1, 1}); \
               SweepSurf screw(profile, path, twist = {0, 0, 1.5}, scale = {1, 0.5}); \
               SweepSurf moved(profile, path, \"fixed\", scale = {1, 0.5});"
)]
pub struct SweepSurf<T: Real> {
    /// The curve to sweep: edge v = 0.
    profile: CurveRef<T>,
    /// Path of the profile.
    path: CurveRef<T>,
    /// Motion of the frame: "minimal", "up" or "fixed".
    #[field(default = "minimal")]
    frame: std::sync::Arc<str>,
    /// Upright direction of frame = "up"; default: z.
    up: Option<Vec3<T>>,
    /// Angles of rotation about the tangent along v, in radians.
    #[field(angle)]
    twist: Option<Vec<T>>,
    /// Scale factors of the profile along v.
    scale: Option<Vec<T>>,
}

impl<T: Scalar> Build<T> for SweepSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { profile, path, frame, up, twist, scale } = self;
        let mode = FrameMode::of(&frame, up, [Self::FRAME, Self::UP])?;
        let moving = MovingFrame::new(path, mode, Self::PATH)?;
        let shape = SweptSurface {
            profile,
            moving,
            twist: law(twist, Self::TWIST)?,
            scale: law(scale, Self::SCALE)?,
        };
        Ok(Value::Surface(SurfaceRef::new(shape, context.nesting)))
    }
}

/// Motion of a frame along a path.
#[derive(Clone, Copy)]
pub enum FrameMode<T> {
    /// Without turning about the tangent.
    Minimal,
    /// With an axis as near as may be to this direction.
    Up(Vec3<T>),
    /// Not at all.
    Fixed,
}

impl<T: Real> FrameMode<T> {
    /// The mode of a word, with the upright direction where one was given; `fields` are theirs.
    ///
    /// # Errors
    /// `unknown-frame` and `unused-argument`.
    pub fn of(frame: &str, up: Option<Vec3<T>>, fields: [FieldId; 2]) -> Result<Self, CallError> {
        match frame {
            "minimal" if up.is_none() => Ok(FrameMode::Minimal),
            "fixed" if up.is_none() => Ok(FrameMode::Fixed),
            "minimal" | "fixed" => {
                Err(CallError::new("unused-argument", "`up` is for frame = \"up\" only")
                    .help("add frame = \"up\", or leave `up` out")
                    .in_field(fields[1]))
            }
            "up" => Ok(FrameMode::Up(up.unwrap_or(Vec3::of(0.0, 0.0, 1.0)))),
            other => Err(CallError::new("unknown-frame", format!("unknown frame \"{other}\""))
                .expected("\"minimal\", \"up\" or \"fixed\"")
                .found(format!("\"{other}\""))
                .in_field(fields[0])),
        }
    }
}

/// A path with a frame (tangent, r, tangent x r) that moves along it.
pub struct MovingFrame<T: Real> {
    pub path: CurveRef<T>,
    mode: FrameMode<T>,
    /// For the minimal frame: its reference vector r at parameters of the path.
    nodes: Vec<(f64, Vec3<T>)>,
    /// The frame at v = 0.
    pub first: [Vec3<T>; 3],
}

/// Steps of the minimal frame between breaks of the path. One step of double reflection is exact to
/// fourth order of its length, their chain to the same (Wang et al., section 4).
const STEPS: usize = 128;

/// Tangents on both sides of a point of the path that differ by more than this make a corner.
const CORNER: f64 = 1e-4;

impl<T: Real> MovingFrame<T> {
    /// # Errors
    /// `zero-tangent`, `corner-in-path` and `no-frame`, in field `field`.
    pub fn new(path: CurveRef<T>, mode: FrameMode<T>, field: FieldId) -> Result<Self, CallError> {
        let zero = Vec3::zero();
        let mut moving = Self { path, mode, nodes: Vec::new(), first: [zero; 3] };
        moving.check().map_err(|fault| fault.in_field(field))?;
        let t = moving.tangent(T::zero());
        let r = match mode {
            FrameMode::Minimal | FrameMode::Fixed => t.perpendicular(),
            FrameMode::Up(up) => upright(up, t),
        };
        moving.first = [t, r, t.cross(r)];
        if matches!(mode, FrameMode::Minimal) {
            moving.place_nodes(r);
        }
        Ok(moving)
    }

    fn check(&self) -> Result<(), CallError> {
        let unit = |v: f64| {
            let d = self.path.jet(T::from(v), Order::First)[1].re();
            d.normalized().filter(|t| t.is_finite()).ok_or_else(|| {
                CallError::new("zero-tangent", format!("the path has no tangent at v = {v}"))
                    .expected("a path with a non-zero tangent everywhere")
                    .found("a derivative of zero")
                    .help("separate the coincident points of the path")
            })
        };
        for k in 0..=32 {
            let v = f64::from(k) / 32.0;
            let t = unit(v)?;
            if let FrameMode::Up(up) = self.mode
                && up.re().cross(t).norm() <= 1e-6 * up.re().norm()
            {
                let message = format!("the path runs along the upright direction at v = {v}");
                return Err(CallError::new("no-frame", message)
                    .expected("a tangent that is not parallel to `up`")
                    .found(format!("the tangent ({}, {}, {})", t.x, t.y, t.z))
                    .help("take another `up`, or frame = \"minimal\""));
            }
        }
        let turning =
            if matches!(self.mode, FrameMode::Fixed) { vec![] } else { self.path.breaks() };
        for v in turning {
            let (before, after) = (unit(v - 1e-7)?, unit(v + 1e-7)?);
            if before.distance(after) > CORNER {
                let angle = Real::acos(before.dot(after).clamp(-1.0, 1.0)).to_degrees();
                return Err(CallError::new(
                    "corner-in-path",
                    format!("the path has a corner at v = {v}"),
                )
                .expected("a path with a continuous tangent")
                .found(format!("a turn by {angle:.1} degrees"))
                .help("round the corner off, or sweep its parts one by one"));
            }
        }
        Ok(())
    }

    /// Number of the mode: 1 minimal, 2 up, 3 fixed.
    pub fn number(&self) -> u8 {
        match self.mode {
            FrameMode::Minimal => 1,
            FrameMode::Up(_) => 2,
            FrameMode::Fixed => 3,
        }
    }

    /// The unit tangent.
    fn tangent<J: Jet<T>>(&self, v: J) -> Vec3<J> {
        let jet = |t: T, order| self.path.jet(t, order);
        let d = tangent(jet, || self.path.breaks(), v);
        d / d.norm()
    }

    fn place_nodes(&mut self, r: Vec3<T>) {
        let mut stops = self.path.breaks();
        stops.push(1.0);
        let mut begin = 0.0;
        self.nodes.push((begin, r));
        for end in stops {
            for k in 1..=STEPS {
                let v = begin + (end - begin) * (k as f64 / STEPS as f64);
                let next = self.reflected(self.nodes[self.nodes.len() - 1], T::from(v));
                self.nodes.push((v, next));
            }
            begin = end;
        }
    }

    /// One step of double reflection, from a node to `v`. Wang et al., table I.
    fn reflected(&self, (node, r): (f64, Vec3<T>), v: T) -> Vec3<T> {
        let [x0, d0, _] = self.path.jet(T::from(node), Order::First);
        let [x1, d1, _] = self.path.jet(v, Order::First);
        let (t0, t1) = (d0 / d0.norm(), d1 / d1.norm());
        let mirrored = |x: Vec3<T>, n: Vec3<T>| {
            let square = n.norm_sq();
            if square.re() == 0.0 { x } else { x - n * (n.dot(x) * 2.0 / square) }
        };
        let across = x1 - x0;
        let (left, t) = (mirrored(r, across), mirrored(t0, across));
        mirrored(left, t1 - t)
    }

    /// The vector r of the minimal frame.
    fn minimal(&self, v: T) -> Vec3<T> {
        let at = v.re();
        let after = self.nodes.partition_point(|(node, _)| *node <= at);
        // At least half a step away, for well-conditioned reflections, and never across a break,
        // since each break is a node.
        let last = self.nodes.len() - 1;
        let (low, high) = (after.saturating_sub(1).min(last), after.min(last));
        let far = |k: usize| (self.nodes[k].0 - at).abs();
        let node = if far(low) >= far(high) { low } else { high };
        if far(node) == 0.0 { self.nodes[node].1 } else { self.reflected(self.nodes[node], v) }
    }

    /// The frame at `v`: unit tangent, r, and their product.
    pub fn frame<J: Jet<T>>(&self, v: J) -> [Vec3<J>; 3] {
        let t = match self.mode {
            FrameMode::Fixed => return self.first.map(|axis| axis.map(J::fixed)),
            _ => self.tangent(v),
        };
        let r = match self.mode {
            FrameMode::Up(up) => upright(up.map(J::fixed), t),
            _ => self.lifted(v),
        };
        [t, r, t.cross(r)]
    }

    /// r as a jet: r' = w x r with w = t x t', the turn that carries the tangent along.
    fn lifted<J: Jet<T>>(&self, v: J) -> Vec3<J> {
        let at = v.value();
        let r = self.minimal(at);
        let mut x = r.map(J::fixed);
        if J::ORDER == Order::Zero {
            return x;
        }
        let dv = v - J::fixed(at);
        if J::ORDER == Order::First {
            let t = self.tangent(Uni1::parameter(at));
            let (t, d) = (t.map(|a| a.f), t.map(|a| a.t));
            return x + t.cross(d).cross(r).map(|a| dv.scaled(a));
        }
        let t = self.tangent(Uni2::parameter(at));
        let (t, d, dd) = (t.map(|a| a.f), t.map(|a| a.t), t.map(|a| a.tt));
        let (w, turning) = (t.cross(d), t.cross(dd));
        let first = w.cross(r);
        let second = turning.cross(r) + w.cross(first);
        let half = dv * dv * 0.5;
        x += first.map(|a| dv.scaled(a));
        x + second.map(|a| half.scaled(a))
    }
}

/// The unit vector nearest to `up` perpendicular to the unit vector `t`.
fn upright<J: Real>(up: Vec3<J>, t: Vec3<J>) -> Vec3<J> {
    let r = up - t * up.dot(t);
    r / r.norm()
}

struct SweptSurface<T: Real> {
    profile: CurveRef<T>,
    moving: MovingFrame<T>,
    twist: Option<BSplineCurve<T>>,
    scale: Option<BSplineCurve<T>>,
}

impl<T: Real> SweptSurface<T> {
    /// Position on the path, and images of the tangent, r and t x r of the frame at 0.
    fn station<J: Jet<T>>(&self, v: J) -> (Vec3<J>, [Vec3<J>; 3]) {
        let [t, r, s] = self.moving.frame(v);
        let value = |law: &BSplineCurve<T>| {
            let law: &dyn moldloft_num::Curve<T> = law;
            law.at(v).x
        };
        let (r, s) = match &self.twist {
            None => (r, s),
            Some(law) => {
                let angle = value(law);
                let (sin, cos) = (angle.sin(), angle.cos());
                (r * cos + s * sin, s * cos - r * sin)
            }
        };
        let axes = match &self.scale {
            None => [t, r, s],
            Some(law) => {
                let factor = value(law);
                [t * factor, r * factor, s * factor]
            }
        };
        (self.moving.path.at(v), axes)
    }

    /// The profile in the frame at 0.
    fn local<J: Jet<T>>(&self, u: J) -> Vec3<J> {
        let d = self.profile.at(u) - self.moving.path.end(0.0).map(J::fixed);
        let [t, r, s] = self.moving.first.map(|a| a.map(J::fixed));
        Vec3::new(d.dot(t), d.dot(r), d.dot(s))
    }

    fn placed<J: Real>((path, [t, r, s]): (Vec3<J>, [Vec3<J>; 3]), local: Vec3<J>) -> Vec3<J> {
        path + t * local.x + r * local.y + s * local.z
    }

    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        Self::placed(self.station(v), self.local(u))
    }
}

impl<T: Real> Surface<T> for SweptSurface<T> {
    fn jet(&self, u: T, v: T, order: Order) -> SurfJet<T> {
        surface_jet_of!(self, Self::at, u, v, order)
    }

    fn grid(
        &self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Vec3<T>],
        normals: Option<&mut [Vec3<T>]>,
    ) {
        let Some(normals) = normals else {
            let stations: Vec<_> = vs.iter().map(|&v| self.station(T::from(v))).collect();
            for (row, &u) in points.chunks_mut(vs.len().max(1)).zip(us) {
                let local = self.local(T::from(u));
                for (x, station) in row.iter_mut().zip(&stations) {
                    *x = Self::placed(*station, local);
                }
            }
            return;
        };
        let stations: Vec<_> =
            vs.iter().map(|&v| self.station(Uni1::parameter(T::from(v)))).collect();
        let rows = points.chunks_mut(vs.len().max(1)).zip(normals.chunks_mut(vs.len().max(1)));
        for ((row, normals), &u) in rows.zip(us) {
            let d = self.profile.jet(T::from(u), Order::First)[1];
            let by_u = {
                let [t, r, s] = self.moving.first;
                Vec3::new(d.dot(t), d.dot(r), d.dot(s))
            };
            let local = self.local(T::from(u));
            let fixed = local.map(Uni1::fixed);
            for ((x, normal), station) in row.iter_mut().zip(normals).zip(&stations) {
                let moved = Self::placed(*station, fixed);
                *x = moved.map(|a| a.f);
                let (_, axes) = *station;
                let [t, r, s] = axes.map(|a| a.map(|a| a.f));
                let along = t * by_u.x + r * by_u.y + s * by_u.z;
                *normal = along.cross(moved.map(|a| a.t)).normalized().unwrap_or_default();
            }
        }
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        let laws = [&self.twist, &self.scale].into_iter().flatten();
        let knots = laws.flat_map(|law| KnotVector::breaks(law.knots()));
        let mut v: Vec<f64> = self.moving.path.breaks().into_iter().chain(knots).collect();
        v.sort_by(f64::total_cmp);
        v.dedup();
        [self.profile.breaks(), v]
    }

    /// The profile under the motion, or the path of one of its ends.
    fn edge_made_of(&self, k: usize) -> Vec<Key> {
        if k.is_multiple_of(2) {
            return self.profile.made_of();
        }
        let mut made = self.moving.path.made_of();
        made.extend(self.profile.end_points()[usize::from(k == 1)]);
        made
    }

    /// Edge v = 0 follows the profile unless it is rotated or scaled there; an edge u = const
    /// follows the path if the profile ends at the path's first point object.
    fn edges(&self) -> Edges<T> {
        let (ends, path) = (self.profile.end_points(), self.moving.path.end_points());
        let value = |law: &Option<BSplineCurve<T>>, k: usize, usual: f64| match law {
            Some(law) => {
                law.control_points()[if k == 0 { 0 } else { law.control_points().len() - 1 }].x.re()
            }
            None => usual,
        };
        let mut edges = Edges::own();
        if value(&self.twist, 0, 0.0) == 0.0 && value(&self.scale, 0, 1.0) == 1.0 {
            edges = edges.with(0, along(&self.profile));
            edges.corners[..2].copy_from_slice(&ends);
        }
        for (k, edge) in [(0, 0), (1, 2)] {
            if value(&self.scale, k, 1.0) == 0.0 {
                edges = edges.with(edge, Edge::Pole(path[k]));
            }
        }
        if is_closed(ends) {
            edges = edges.with(1, Edge::SameAs(3));
        }
        for (end, edge, last) in [(0, 3, 3), (1, 1, 2)] {
            let begins = ends[end].is_some() && ends[end] == path[0];
            if begins && let run @ Edge::Pieces(_) = along(&self.moving.path) {
                edges = edges.with(edge, run);
                edges.corners[last] = path[1];
            }
        }
        edges
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
    moldloft_num::surface_one_by_one!(T: line, scattered);
}
