//! Developable surfaces between two curves, by rulings of equal tangent planes.

use super::column::{Column, Columns};
use super::masters::Masters;
use super::rulings::{Pairing, pair};
use crate::arguments::NamedOption;
use crate::curve::Segment;
use crate::third_derivatives::tangent;
use moldloft_locate::implicit::{Implicit, jets};
use moldloft_num::trace::{Edge, Edges};
use moldloft_num::{Jet, Order, Real, Vec3, find_root, lift_reparametrization};
use moldloft_registry::{Build, CallError, Context, CurveRef, Kind, SurfaceRef, Value};

/// A developable surface between two curves, a plate bent without stretching: straight rulings from
/// C1(s) to C2(t) with a constant tangent plane, det[C1'(s), C2'(t), C2(t) - C1(s)] = 0; S(u, v) =
/// (1 - v) C1(s(u)) + v C2(t(u)).
///
/// The rulings extend from the ruling of both starts to that of both ends; cones about an end of a
/// curve (fans) complete the surface if those two are not rulings. By default u = (s + t) / 2 and
/// no edge has the divisions of its curve: build neighbours on an EdgeSnake of this surface. With
/// `along` = "c1" (or "c2") u is the parameter of that curve and meshes join along it; a fan about
/// one of its ends is then an error. Errors: no pair of points has a common tangent plane; rulings
/// cross between the curves.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "c1 c2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0.75, 0); AbsPoint C(4, 0, 0); AbsPoint D(0.5, 0, 2); \
               AbsPoint E(2, 1.5, 2.25); AbsPoint F(4.5, 0.25, 2); BCurve l({A, B, C}); BCurve m({D, E, F}); \
               DevSurf plate(l, m); AbsPoint G(0.5, -1, 3); CopyCurve k(l, A, G, 0.5, 0.5, 0.5); \
               DevSurf cone(l, k, \"c1\");"
)]
pub struct DevSurf<T: Real> {
    /// Edge v = 0.
    c1: CurveRef<T>,
    /// Edge v = 1.
    c2: CurveRef<T>,
    /// Curve or curves whose parameter is u: "both", "c1" or "c2".
    #[field(default = "both")]
    along: NamedOption,
}

impl<T: Real> Build<T> for DevSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { c1, c2, along } = self;
        let (a, b) = match along.among(&["both", "c1", "c2"], Self::ALONG)? {
            "both" => (1.0, 1.0),
            "c1" => (0.0, 1.0),
            _ => (1.0, 0.0),
        };
        let pairing = pair([&c1, &c2]).map_err(|fault| fault.in_field(Self::C2))?;
        let masters = Masters::new(vec![c1, c2], Self::C1)?;
        let plate = DevelopableSurface::new(masters, pairing, a, b)?;
        Ok(Value::Surface(SurfaceRef::new(Columns(plate), context.nesting)))
    }
}

/// Rule between two stations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Rulings with one tangent plane.
    Rulings,
    /// A fan: one of s and t stays at 0 or 1.
    Fan {
        /// True if s is constant.
        first: bool,
        end: f64,
    },
    /// The curves are coplanar: any pairing is developable, so equal parameters are paired.
    Flat,
}

/// The plate, with s = u + a w, t = u - b w for an unknown w.
struct DevelopableSurface<T: Real> {
    masters: Masters<T>,
    a: f64,
    b: f64,
    /// The parameter u at which a phase begins, and the phase.
    phases: Vec<(f64, Phase)>,
    /// (u, w) of rulings to begin iterations with.
    stations: Vec<(f64, f64)>,
    breaks: Vec<f64>,
}

impl<T: Real> DevelopableSurface<T> {
    fn new(masters: Masters<T>, pairing: Pairing, a: f64, b: f64) -> Result<Self, CallError> {
        // u and w of a pair (s, t): s - t = (a + b) w.
        let of = |[s, t]: [f64; 2]| {
            let w = (s - t) / (a + b);
            (
                if a == 0.0 {
                    s
                } else if b == 0.0 {
                    t
                } else {
                    s - a * w
                },
                w,
            )
        };
        let stays = |phase: &Phase| match phase {
            Phase::Fan { first, end } if (a == 0.0 && *first) || (b == 0.0 && !*first) => {
                Some(*end)
            }
            _ => None,
        };
        if let Some((at, _)) = pairing.phases.iter().find(|(_, phase)| stays(phase).is_some()) {
            let (curve, end) = if a == 0.0 { (1, at[0]) } else { (2, at[1]) };
            let which = if end < 0.5 { "start" } else { "end" };
            return Err(CallError::new("fan-needed", format!("the plate has a fan about the {which} of curve {curve}"))
                .expected("rulings that move along that curve from end to end")
                .found(format!("a cone about its {which}, where u would be degenerate"))
                .help("leave `along` out, and build the neighbour on an EdgeSnake of this surface; or move the ends of the curves")
                .related(masters.curves()[curve - 1].key, "has the fan at its end")
                .in_field(DevSurf::<T>::ALONG));
        }
        let phases: Vec<_> = pairing.phases.iter().map(|(at, phase)| (of(*at).0, *phase)).collect();
        let stations: Vec<_> = pairing.stations.iter().map(|at| of(*at)).collect();
        let mut plate = Self { masters, a, b, phases, stations, breaks: Vec::new() };
        plate.breaks = plate.find_breaks();
        Ok(plate)
    }

    /// Breaks: ends of phases, and rulings at breaks of the curves.
    fn find_breaks(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.phases[1..].iter().map(|(u, _)| *u).collect();
        let mut ends = vec![0.0];
        ends.extend(self.stations.iter().map(|(u, _)| *u));
        ends.extend(&all);
        ends.push(1.0);
        ends.sort_by(f64::total_cmp);
        for (k, curve) in self.masters.curves().iter().enumerate() {
            for b in curve.breaks() {
                let past = |u: f64| self.pair(T::from(u))[k].re() - b;
                let found = ends.windows(2).find_map(|w| find_root(past, w[0], w[1]).ok());
                all.extend(found);
            }
        }
        all.retain(|u| *u > 0.0 && *u < 1.0);
        all.sort_by(f64::total_cmp);
        all.dedup_by(|b, a| *b - *a < 1e-12);
        all
    }

    fn phase(&self, u: f64) -> Phase {
        let k = self.phases[1..].partition_point(|(begin, _)| *begin <= u);
        self.phases[k].1
    }

    /// The parameters s and t at `u`.
    fn pair<J: Jet<T>>(&self, u: J) -> [J; 2] {
        match self.phase(u.re()) {
            Phase::Flat => [u, u],
            // s = e: t = u - b w with w = (e - u) / a; as above with the letters changed.
            Phase::Fan { first: true, end } => {
                let end = J::from(end);
                [end, u - (end - u) * (self.b / self.a)]
            }
            Phase::Fan { first: false, end } => {
                let end = J::from(end);
                [u + (u - end) * (self.a / self.b), end]
            }
            Phase::Rulings => {
                let equation = Tangency { curves: self.masters.curves(), a: self.a, b: self.b };
                let plain = self.solve(&equation, u.re());
                let w = match jets(&equation, [plain], u.value(), J::ORDER) {
                    Some(jet) => lift_reparametrization(&jet.map(|[w]| w), u),
                    None => J::from(plain),
                };
                [u + w * self.a, u - w * self.b]
            }
        }
    }

    /// The unknown at `u`, from between the stations.
    fn solve(&self, equation: &Tangency<T>, u: f64) -> f64 {
        let at = self.stations.partition_point(|(x, _)| *x <= u).clamp(1, self.stations.len() - 1);
        let [(u0, w0), (u1, w1)] = [self.stations[at - 1], self.stations[at]];
        let share = if u1 > u0 { (u - u0) / (u1 - u0) } else { 0.0 };
        let guess = w0 + (w1 - w0) * share;
        let mut w = guess;
        // Newton's iteration; it may not leave the neighbourhood of the stations.
        let reach = (w1 - w0).abs() + (u1 - u0).abs();
        for _ in 0..30 {
            let [value] = equation.at([T::from(w)], T::from(u)).map(Real::re);
            let [[slope]] = equation.jacobian([T::from(w)], T::from(u));
            let step = value / slope.re();
            if !step.is_finite() || (w - step - guess).abs() > reach {
                return guess;
            }
            w -= step;
            if step.abs() <= 4.0 * f64::EPSILON {
                break;
            }
        }
        w
    }
}

/// det[C1'(s), C2'(t), C2(t) - C1(s)] = 0 at s = u + a w, t = u - b w.
struct Tangency<'c, T: Real> {
    curves: &'c [CurveRef<T>],
    a: f64,
    b: f64,
}

impl<T: Real> Implicit<T, 1> for Tangency<'_, T> {
    fn at<J: Jet<T>>(&self, [w]: [J; 1], u: J) -> [J; 1] {
        let [c, d] = [&self.curves[0], &self.curves[1]];
        let (s, t) = (u + w * self.a, u - w * self.b);
        let along = |curve: &CurveRef<T>, t: J| -> Vec3<J> {
            tangent(|t, order| curve.jet(t, order), || curve.breaks(), t)
        };
        [along(c, s).cross(along(d, t)).dot(d.at(t) - c.at(s))]
    }

    fn jacobian(&self, [w]: [T; 1], u: T) -> [[T; 1]; 1] {
        let [c, c1, c2] = self.curves[0].jet(u + w * self.a, Order::Second);
        let [d, d1, d2] = self.curves[1].jet(u - w * self.b, Order::Second);
        let ruling = d - c;
        // The change of the ruling is in the plane of both tangents.
        let by_s = c2.cross(d1).dot(ruling);
        let by_t = c1.cross(d2).dot(ruling);
        [[by_s * self.a - by_t * self.b]]
    }
}

impl<T: Real> Column for DevelopableSurface<T> {
    type Scalar = T;
    type Across<S: Real> = Segment<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<Segment<J>> {
        let [s, t] = self.pair(u);
        let [c, d] = [&self.masters.curves()[0], &self.masters.curves()[1]];
        Some(Segment { from: c.at(s), to: d.at(t) })
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.breaks.clone(), Vec::new()]
    }

    fn edge_made_of(&self, k: usize) -> Vec<moldloft_num::trace::Key> {
        // Along its curves the rulings set the pace.
        match k % 2 {
            0 => Vec::new(),
            _ => self.masters.edge_made_of(k),
        }
    }

    /// An edge follows its curve if u is that curve's parameter; the ends are rulings.
    fn edges(&self) -> Edges<T> {
        let mut edges = self.masters.straight_edges();
        if self.a != 0.0 {
            edges.edges[0] = Edge::Own;
        }
        if self.b != 0.0 {
            edges.edges[2] = Edge::Own;
        }
        edges
    }
}
