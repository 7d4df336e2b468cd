//! Rolling-ball fillets between two surfaces: a spine, and arcs about it.

use super::column::{Column, Columns};
use super::law::law;
use super::offset::{beside, curvatures, parallel};
use crate::search::{IntSnake, Onto};
use crate::snake::OnSurface;
use crate::third_derivatives::tangent;
use moldloft_locate::implicit::{Implicit, jets, solve};
use moldloft_locate::{PlainSurface, nearest_on_surface};
use moldloft_num::period::within;
use moldloft_num::trace::{Edge, Edges, Trace};
use moldloft_num::{
    Bi1, CurveFormula, Jet, Order, Real, Surface, SurfaceFormula, Vec3, lift_reparametrization,
};
use moldloft_registry::export::StaticRow;
use moldloft_registry::{
    Build, CallError, Context, CurveRef, Kind, Point, Scalar, SurfaceRef, Value,
};
use moldloft_spline::{BSplineCurve, CircularArc};
use std::sync;

/// The fillet of a ball rolling along two surfaces: circular arcs from the contact line on the
/// first, at v = 0, to that on the second, at v = 1; tangent to both.
///
/// The centre of the ball is on the intersection of both surfaces offset by `radius`, which extends
/// from edge to edge or is closed; u is the fraction of its length. The direction and the selection
/// among several paths follow IntSnake: a magnet selects the ball with the nearest contact. With
/// `radii` the radius is a function of u: the centre is in the normal plane of the path for the
/// constant `radius`, and the arcs pass through both contacts, tangent to both surfaces. A radius
/// larger than a radius of curvature of either surface on its side is an error.
///
/// `ContactSnake` gives the lines of contact on both surfaces, which are the edges v = 0 and v = 1.
/// Parts of the surfaces bounded by them (`SubSurf`, `TrimSurf`) join the fillet exactly.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface1 surface2 radius",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); \
               AbsPoint E(0, 2.5, -1); AbsPoint F(4, 2, -1); AbsPoint G(0, 2.5, 3); AbsPoint H(4, 2.25, 3); \
               Line a(A, B); Line b(C, D); RuledSurf floor(a, b); Line c(E, F); Line d(G, H); \
               RuledSurf wall(c, d); RollFillet S(floor, wall, 0.8); \
               RollFillet more(floor, wall, 0.5, radii = {0.25, 0.5, 0.75}, visible = 0);"
)]
pub struct RollFillet<T: Real> {
    /// The first surface, or a magnet on it near the intended contact.
    surface1: Onto<T>,
    /// The second surface, or a magnet on it near the intended contact.
    surface2: Onto<T>,
    /// Radius of the ball, greater than 0.
    #[field(min = 0)]
    radius: T,
    /// Side of the ball: 1 on the side of the natural normal of the first surface, -1 on the other.
    #[field(default = 1, min = -1, max = 1)]
    side1: i32,
    /// Side of the ball for the second surface; see `side1`.
    #[field(default = 1, min = -1, max = 1)]
    side2: i32,
    /// Radii along u, greater than 0: coefficients of a clamped uniform B-spline of degree 3 (for n
    /// < 4 coefficients: n - 1). Default: constant `radius`.
    radii: Option<Vec<T>>,
}

/// Stations along the fillet at which iterations begin, and at which a new one is tried.
const STATIONS: usize = 48;

/// Maximum distance beyond an edge, in u or v, of a contact of a ball of variable radius: that ball
/// differs from the one whose path ends at the edge.
const BEYOND: f64 = 0.05;

impl<T: Scalar> Build<T> for RollFillet<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface1, surface2, radius, side1, side2, radii } = self;
        for (field, side) in [(Self::SIDE1, side1), (Self::SIDE2, side2)] {
            if side == 0 {
                return Err(CallError::new("out-of-range", "a ball is on one side or the other")
                    .expected("1 or -1")
                    .found("0")
                    .in_field(field));
            }
        }
        let least = radii.iter().flatten().map(|r| r.re()).fold(f64::INFINITY, f64::min);
        let too_small = match radius.re() {
            r if r <= 0.0 => Some((r, Self::RADIUS)),
            _ => (least <= 0.0).then_some((least, Self::RADII)),
        };
        if let Some((found, field)) = too_small {
            return Err(CallError::new("out-of-range", format!("a ball of radius {found}"))
                .expected("a radius greater than 0")
                .found(found.to_string())
                .in_field(field));
        }
        let radii = law(radii, Self::RADII)?;
        let sides = [f64::from(side1), f64::from(side2)];
        let spine = spine([&surface1, &surface2], sides.map(|s| radius * s), context)?;
        let found = spine.found.clone();
        let nesting = context.nesting.max(spine.depth);
        let surfaces = [surface1.surface, surface2.surface];
        let round = [surfaces[0].closed(), surfaces[1].closed()];
        let ball = Ball { surfaces, round, sides, spine, radius, radii };
        let mut fillet = Rolled { stations: ball.stations(), ball, closed: false };
        fillet.check()?;
        fillet.closed = fillet.closes();
        let fillet = sync::Arc::new(fillet);
        let contact = |k: usize| {
            let surface = fillet.ball.surfaces[k].clone();
            let path = Contact { fillet: fillet.clone(), k };
            let shape = OnSurface { surface: surface.clone(), path, trace: Trace::own() };
            CurveRef::snake(shape, surface, nesting)
        };
        let contacts = [contact(0), contact(1)];
        let mut surface = SurfaceRef::new(Columns(Rolling(fillet)), nesting);
        surface.found = found;
        Ok(Value::Surface(surface.with_contacts(contacts)))
    }
}

/// Path of the centre of a ball of constant radius: the intersection of the offset surfaces.
fn spine<T: Scalar>(
    onto: [&Onto<T>; 2],
    distances: [T; 2],
    context: &Context,
) -> Result<CurveRef<T>, CallError> {
    let row = <IntSnake<f64> as StaticRow>::row();
    let mut args = vec![Value::Unset; row.fields.len()];
    for (k, shape) in IntSnake::<T>::SHAPES.into_iter().enumerate() {
        let beside = parallel(onto[k].surface.clone(), distances[k], context);
        args[shape.position()] = match onto[k].start {
            Some([u, v]) => Value::Point(Box::new(Point::on_surface(beside, u, v))),
            None => Value::Surface(beside),
        };
    }
    let met = T::call(&row, &args, context).map_err(|fault| {
        let radius = distances[0].re().abs();
        let message = format!("no ball of radius {radius} rolls along both surfaces");
        let found = fault.found.clone().unwrap_or_else(|| fault.message.clone());
        if fault.id == "tangent-contact" {
            // Offsets that are folded touch one another where they turn.
            return CallError::new("fillet-turns-back", "the path of the ball's centre reverses")
                .expected("a radius less than the radius of curvature of both surfaces where it rolls")
                .found(format!("{radius}, and {found}"))
                .help("choose a smaller radius, or give magnets where the ball is meant to roll")
                .related(onto[0].surface.key, "is the first surface")
                .related(onto[1].surface.key, "is the second surface")
                .in_field(RollFillet::<T>::RADIUS);
        }
        CallError::new("no-ball", message)
            .expected("surfaces that a ball of that radius touches both, on the intended sides")
            .found(found)
            .help("choose the sides (side1, side2), give magnets near the points of contact, or another radius")
            .related(onto[0].surface.key, "is the first surface")
            .related(onto[1].surface.key, "is the second surface")
            .in_field(RollFillet::<T>::RADIUS)
    })?;
    match met {
        Value::Curve(curve) => Ok(curve),
        other => Err(CallError::wrong_class(moldloft_registry::Class::Curve, other.class())),
    }
}

/// A ball that touches two surfaces.
struct Ball<T: Real> {
    surfaces: [SurfaceRef<T>; 2],
    /// For both surfaces, true if u or v is closed.
    round: [[bool; 2]; 2],
    sides: [f64; 2],
    /// Path of the centre of a ball of `radius`.
    spine: CurveRef<T>,
    radius: T,
    radii: Option<BSplineCurve<T>>,
}

impl<T: Real> Ball<T> {
    fn radius<J: Jet<T>>(&self, t: J) -> J {
        match &self.radii {
            None => J::fixed(self.radius),
            Some(law) => {
                let law: &dyn moldloft_num::Curve<T> = law;
                law.at(t).x
            }
        }
    }

    /// The centre from the contact on surface `k`, whose parameters may be beyond a seam.
    fn centre<J: Jet<T>>(&self, k: usize, radius: J, w: [J; 2]) -> Vec3<J> {
        let [u, v] = within(self.round[k], w);
        beside(&*self.surfaces[k], radius * self.sides[k], u, v)
    }

    /// Contacts of the ball of `radius` at stations along its path, continuous at seams: parameters
    /// beyond one exceed [0, 1].
    fn stations(&self) -> Vec<[f64; 4]> {
        let second = BallCentreSurface { ball: self, k: 1 };
        let second: &dyn Surface<T> = &second;
        let second = PlainSurface(second);
        let mut last: Option<[f64; 2]> = None;
        let mut all: Vec<[f64; 4]> = (0..=STATIONS)
            .map(|i| {
                let t = T::from(i as f64 / STATIONS as f64);
                let w = self.spine.on_surface(t, Order::Zero).unwrap_or_default()[0].re();
                let centre = self.spine.jet(t, Order::Zero)[0].re();
                // A search from the last station does not cross a seam.
                let near = nearest_on_surface(&second, centre, last);
                let place = second.jet(near.at[0], near.at[1], Order::Zero).p;
                let found = if place.distance(centre) > 1e-3 * self.radius.re() {
                    nearest_on_surface(&second, centre, None)
                } else {
                    near
                };
                let [p, q] = found.at;
                last = Some([p, q]);
                [w.x, w.y, p, q]
            })
            .collect();
        for k in (0..4).filter(|&k| self.round[k / 2][k % 2]) {
            for i in 1..all.len() {
                all[i][k] -= (all[i][k] - all[i - 1][k]).round();
            }
            let turns = all[STATIONS / 2][k].floor();
            all.iter_mut().for_each(|q| q[k] -= turns);
        }
        all
    }
}

/// Surface of the centres of balls of `radius` in contact with surface `k`.
struct BallCentreSurface<'b, T: Real> {
    ball: &'b Ball<T>,
    k: usize,
}

impl<T: Real> SurfaceFormula for BallCentreSurface<'_, T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        self.ball.centre(self.k, J::fixed(self.ball.radius), [u, v])
    }
    fn breaks(&self) -> [Vec<f64>; 2] {
        self.ball.surfaces[self.k].breaks()
    }

    moldloft_num::surface_facts!(broken, open, not_rational);
}

/// Both centres are one, in the plane across the spine.
impl<T: Real> Implicit<T, 4> for Ball<T> {
    fn at<J: Jet<T>>(&self, [u, v, p, q]: [J; 4], t: J) -> [J; 4] {
        let radius = self.radius(t);
        let [first, second] = [self.centre(0, radius, [u, v]), self.centre(1, radius, [p, q])];
        let gap = first - second;
        let along = tangent(|t, order| self.spine.jet(t, order), || self.spine.breaks(), t);
        [gap.x, gap.y, gap.z, along.dot(first - self.spine.at(t))]
    }

    fn jacobian(&self, q: [T; 4], t: T) -> [[T; 4]; 4] {
        let radius = self.radius(t);
        let by = |k: usize, [u, v]: [T; 2]| {
            let (u, v) = Bi1::parameters(u, v);
            let p = self.centre(k, Bi1::fixed(radius), [u, v]);
            [p.map(|x| x.u), p.map(|x| x.v)]
        };
        let ([a, b], [c, d]) = (by(0, [q[0], q[1]]), by(1, [q[2], q[3]]));
        let along = self.spine.jet(t, Order::First)[1];
        let row = |k: usize| [a[k], b[k], -c[k], -d[k]];
        [row(0), row(1), row(2), [along.dot(a), along.dot(b), T::zero(), T::zero()]]
    }
}

struct Rolled<T: Real> {
    ball: Ball<T>,
    /// Contacts from which iterations start.
    stations: Vec<[f64; 4]>,
    closed: bool,
}

impl<T: Real> Rolled<T> {
    /// Parameters of contact for a plain parameter; `None` if the iteration does not converge.
    fn contact(&self, t: f64) -> Option<[f64; 4]> {
        let at = (t * STATIONS as f64).floor().clamp(0.0, (STATIONS - 1) as f64);
        let share = t * STATIONS as f64 - at;
        let (a, b) = (self.stations[at as usize], self.stations[at as usize + 1]);
        let mut q: [f64; 4] = std::array::from_fn(|k| a[k] + share * (b[k] - a[k]));
        for _ in 0..40 {
            let lifted = q.map(T::from);
            let rest = self.ball.at::<T>(lifted, T::from(t)).map(Real::re);
            let jacobian = self.ball.jacobian(lifted, T::from(t)).map(|row| row.map(Real::re));
            let step = solve(&jacobian, rest)?;
            let size = step.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            if !size.is_finite() {
                return None;
            }
            let damped = (0.2 / size).min(1.0);
            for k in 0..4 {
                q[k] -= damped * step[k];
            }
            if size <= 1e-15 {
                break;
            }
            if size <= 1e-9 {
                // Once more, to rounding.
                let lifted = q.map(T::from);
                let rest = self.ball.at::<T>(lifted, T::from(t)).map(Real::re);
                if let Some(step) = solve(&jacobian, rest) {
                    q = std::array::from_fn(|k| q[k] - step[k]);
                }
                return Some(q);
            }
        }
        Some(q)
    }

    fn check(&self) -> Result<(), CallError> {
        let outside = |k: usize, q: f64| {
            !self.ball.round[k / 2][k % 2] && !(-BEYOND..=1.0 + BEYOND).contains(&q)
        };
        for i in 0..=STATIONS {
            let t = i as f64 / STATIONS as f64;
            let radius = self.ball.radius(T::from(t)).re();
            let varies = self.ball.radii.is_some();
            let field = if varies { RollFillet::<T>::RADII } else { RollFillet::<T>::RADIUS };
            let Some(q) = self.contact(t) else {
                return Err(CallError::new(
                    "no-ball",
                    format!("no ball touches both surfaces at u = {t}"),
                )
                .expected("radii that let the ball touch both surfaces all along")
                .found(format!("none for the radius {radius}"))
                .help("let the radii change less")
                .in_field(field));
            };
            if self.ball.radii.is_some()
                && let Some(k) = (0..4).find(|&k| outside(k, q[k]))
            {
                let which = k / 2;
                return Err(CallError::new(
                    "no-ball",
                    format!("the ball leaves surface {} at u = {t}", which + 1),
                )
                .expected("radii that let the ball touch both surfaces all along")
                .found(format!("a contact at (u, v) = ({}, {})", q[2 * which], q[2 * which + 1]))
                .help("choose radii nearer to `radius`, or enlarge the surface")
                .related(self.ball.surfaces[which].key, "is too small there")
                .in_field(RollFillet::<T>::RADII));
            }
            for k in 0..2 {
                let surface = &self.ball.surfaces[k];
                let [u, v] = within(self.ball.round[k], [q[2 * k], q[2 * k + 1]]);
                let bends = curvatures(surface, u, v);
                let share = |bend: f64| 1.0 - self.ball.sides[k] * radius * bend;
                let least = bends.into_iter().flatten().map(share).fold(f64::INFINITY, f64::min);
                if least <= 0.0 {
                    let most = radius / (1.0 - least);
                    return Err(CallError::new(
                        "fillet-turns-back",
                        format!("the fillet turns back at u = {t}"),
                    )
                    .expected(format!(
                        "a radius less than {}, the radius of curvature there",
                        crate::faults::digits(most)
                    ))
                    .found(radius.to_string())
                    .help("choose a smaller radius, or the other side")
                    .related(surface.key, "is bent more than the ball")
                    .in_field(field));
                }
            }
        }
        Ok(())
    }

    /// True when the ball comes back to where it began.
    fn closes(&self) -> bool {
        let [first, last] = [0.0, 1.0].map(|u| self.across(T::from(u)));
        let (Some(first), Some(last)) = (first, last) else { return false };
        let along = |u: f64| self.ball.spine.jet(T::from(u), Order::First)[1].re();
        let place = |arc: &CircularArc<T>, v: f64| arc.at(T::from(v)).re();
        let size = self.ball.radius.re() + place(&first, 0.0).norm();
        let meets = |v: f64| place(&first, v).distance(place(&last, v)) <= 1e-9 * size;
        [0.0, 0.5, 1.0].into_iter().all(meets) && along(0.0).dot(along(1.0)) > 0.0
    }
}

impl<T: Real> Rolled<T> {
    /// Parameters of contact for a parameter that is a jet.
    fn places<J: Jet<T>>(&self, u: J) -> Option<[[J; 2]; 2]> {
        let plain = self.contact(u.re())?;
        let jet = jets(&self.ball, plain, u.value(), J::ORDER)?;
        let [a, b, c, d] = std::array::from_fn(|k| lift_reparametrization(&jet.map(|q| q[k]), u));
        let round = self.ball.round;
        Some([within(round[0], [a, b]), within(round[1], [c, d])])
    }

    fn across<J: Jet<T>>(&self, u: J) -> Option<CircularArc<J>> {
        let places = self.places(u)?;
        let centre = self.ball.centre(0, self.ball.radius(u), places[0]);
        let [first, second] = [0, 1].map(|k| self.ball.surfaces[k].at(places[k][0], places[k][1]));
        CircularArc::about(first, centre, second).ok()
    }

    fn breaks(&self) -> Vec<f64> {
        let mut all = self.ball.spine.breaks();
        if let Some(law) = &self.ball.radii {
            all.extend(moldloft_num::Curve::breaks(law));
            all.sort_by(f64::total_cmp);
            all.dedup_by(|b, a| *b - *a < 1e-12);
        }
        all
    }
}

/// The fillet as a surface.
struct Rolling<T: Real>(sync::Arc<Rolled<T>>);

impl<T: Real> Column for Rolling<T> {
    type Scalar = T;
    type Across<S: Real> = CircularArc<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<CircularArc<J>> {
        self.0.across(u)
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.0.breaks(), Vec::new()]
    }

    fn edges(&self) -> Edges<T> {
        let edges = Edges::own();
        if self.0.closed { edges.with(1, Edge::SameAs(3)) } else { edges }
    }
}

/// Path of the contact on surface `k` in its parameter plane.
struct Contact<T: Real> {
    fillet: sync::Arc<Rolled<T>>,
    k: usize,
}

/// Distance from an edge below which a contact is on it: the path ends at the first of the two
/// contacts to reach an edge.
const ON_EDGE: f64 = 1e-11;

impl<T: Real> CurveFormula for Contact<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let Some(places) = self.fillet.places(t) else {
            return Vec3::of(f64::NAN, f64::NAN, f64::NAN);
        };
        let at_edge = |x: J| match x.re() {
            re if re.abs() <= ON_EDGE => x - re,
            re if (re - 1.0).abs() <= ON_EDGE => x - (re - 1.0),
            _ => x,
        };
        let [u, v] = places[self.k].map(at_edge);
        Vec3::new(u, v, J::zero())
    }

    fn breaks(&self) -> Vec<f64> {
        self.fillet.breaks()
    }

    moldloft_num::curve_facts!(broken, open, not_rational);
}
