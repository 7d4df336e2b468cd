//! Developable surfaces laid flat, lengths and angles kept.

use super::column::{Column, Columns};
use super::inherited;
use crate::curve::Segment;
use crate::third_derivatives::{bends, tangents};
use moldloft_num::trace::Edges;
use moldloft_num::{Frame, Jet, Order, Real, Vec3, gauss_points};
use moldloft_registry::{Build, CallError, Context, Kind, SurfaceRef, Value};

/// A developable surface unrolled: the plate before bending, which preserves lengths and angles, at
/// equal parameters.
///
/// Its lines u = const must be straight with one tangent plane along each, like those of DevSurf,
/// cones and cylinders. The plate is in the xy plane of `frame` (default: world), its normal along
/// z, its first ruling along y with the middle at the origin. From ruling to ruling the direction
/// turns as in the tangent plane under parallel transport (do Carmo 1976, section 4-4). The image
/// of a snake is its CopySnake on the plate.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "surface frame",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0.75, 0.25); AbsPoint C(4, 0, 0); AbsPoint D(0.5, 0.25, 2); \
               BCurve l({A, B, C}); Line up(A, D); TranSurf hull(l, up); ExpandedSurf plate(hull); \
               AbsPoint O(0, 0, 5); RPYFrame table(O, 0.2, 0, 0.5); ExpandedSurf there(hull, table);"
)]
pub struct ExpandedSurf<T: Real> {
    /// The surface to unroll.
    surface: SurfaceRef<T>,
    /// Frame whose xy plane contains the plate; default: world axes.
    frame: Option<Frame<T>>,
}

/// Parts of each smooth piece along u, for integration.
const PARTS: usize = 12;

/// The sine of the angle by which a tangent plane may turn along a ruling, and by which a ruling may be
/// bent.
const FLAT: f64 = 1e-4;

impl<T: Real> Build<T> for ExpandedSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surface, frame } = self;
        let frame = frame.unwrap_or_else(Frame::world);
        let mut places = vec![0.0];
        let mut ends = surface.breaks()[0].clone();
        ends.push(1.0);
        for end in ends {
            let begin = places[places.len() - 1];
            places.extend((1..PARTS).map(|k| begin + (end - begin) * k as f64 / PARTS as f64));
            // Exactly, so that breaks are recognized.
            places.push(end);
        }
        check(&surface, &places)?;
        let mut plate = Plate { surface, frame, stations: Vec::new(), edges: Edges::own() };
        let mut at = RulingStation { u: 0.0, angle: T::zero(), place: [T::zero(); 2] };
        plate.stations.push(at);
        let breaks = plate.surface.breaks()[0].clone();
        for &u in &places[1..] {
            at = plate.carried(&at, u);
            if breaks.contains(&u) {
                at = plate.past_break(at);
            }
            plate.stations.push(at);
        }
        plate.check_stations()?;
        let surface = plate.surface.clone();
        let shape = Columns(plate);
        let edges = inherited::edges(&*surface, &shape);
        let Columns(plate) = shape;
        let plate = Plate { edges, ..plate };
        Ok(Value::Surface(SurfaceRef::new(Columns(plate), context.nesting)))
    }
}

/// Refuses a surface that cannot be laid flat.
fn check<T: Real>(surface: &SurfaceRef<T>, places: &[f64]) -> Result<(), CallError> {
    let fault = |message: String, found: String| {
        Err(CallError::new("not-developable", message)
            .expected("straight lines u = const with one tangent plane along each")
            .found(found)
            .help("make the plate by DevSurf, or expand a narrower part of the surface")
            .related(surface.key, "is curved both ways")
            .in_field(ExpandedSurf::<T>::SURFACE))
    };
    for u in places.windows(2).map(|w| 0.5 * (w[0] + w[1])) {
        let jets = [0.02, 0.5, 0.98].map(|v| surface.jet(T::from(u), T::from(v), Order::Second));
        let ruling = jets[1].v.re();
        let sine = |a: Vec3<f64>, b: Vec3<f64>| {
            let size = a.norm() * b.norm();
            if size > 0.0 { a.cross(b).norm() / size } else { 0.0 }
        };
        let normals = jets.map(|jet| jet.u.re().cross(jet.v.re()));
        for k in [0, 2] {
            let bend = sine(jets[k].v.re(), ruling);
            if bend > FLAT {
                let angle = Real::asin(bend.min(1.0)).to_degrees();
                return fault(
                    format!("the line u = {u} is not straight"),
                    format!("a turn by {angle:.4} degrees along it"),
                );
            }
            let twist = sine(normals[k], normals[1]);
            // Written so that NaN is refused.
            if twist.is_nan() || twist > FLAT {
                let angle = Real::asin(twist.min(1.0)).to_degrees();
                return fault(
                    format!("the tangent plane turns along the line u = {u}"),
                    format!("a turn by {angle:.4} degrees from its middle to its end"),
                );
            }
        }
    }
    Ok(())
}

/// Position of the middle of a ruling on the plate, and angle of the ruling from the y axis.
#[derive(Clone, Copy)]
struct RulingStation<T> {
    u: f64,
    angle: T,
    place: [T; 2],
}

struct Plate<T: Real> {
    surface: SurfaceRef<T>,
    frame: Frame<T>,
    stations: Vec<RulingStation<T>>,
    edges: Edges<T>,
}

impl<T: Real> Plate<T> {
    /// Error for a surface with a ruling of zero length or without a tangent plane.
    fn check_stations(&self) -> Result<(), CallError> {
        let laid = |at: &&RulingStation<T>| {
            let numbers = [at.angle, at.place[0], at.place[1], self.turning(T::from(at.u))];
            numbers.iter().all(|x| x.re().is_finite())
        };
        let Some(at) = self.stations.iter().find(|at| !laid(at)) else { return Ok(()) };
        let message = format!("the surface has no tangent plane along the line u = {}", at.u);
        Err(CallError::new("no-normal", message)
            .expected("lines u = const with a length and one tangent plane along each")
            .found("a line of length zero, or along which the surface is singular")
            .help("expand a part of the surface that leaves this line out")
            .related(self.surface.key, "is singular there")
            .in_field(ExpandedSurf::<T>::SURFACE))
    }

    /// S_u and S_v in the middle of the ruling at `u`.
    fn middle<J: Jet<T>>(&self, u: J) -> [Vec3<J>; 2] {
        tangents(&*self.surface, u, J::from(0.5))
    }

    /// Rate of rotation of the ruling in the tangent plane.
    fn turning<J: Jet<T>>(&self, u: J) -> J {
        let [along, across] = self.middle(u);
        let [_, twist, _] = bends(&*self.surface, u, J::from(0.5));
        let normal = along.cross(across);
        normal.dot(across.cross(twist)) / (normal.norm() * across.norm_sq())
    }

    /// The step of the middle line, perpendicular to the ruling and along it.
    fn step<J: Jet<T>>(&self, u: J) -> [J; 2] {
        let [along, across] = self.middle(u);
        let length = across.norm();
        [along.cross(across).norm() / length, along.dot(across) / length]
    }

    /// That step in the plane, with the ruling at `angle` from the y axis.
    fn laid<J: Jet<T>>([across, along]: [J; 2], angle: J) -> [J; 2] {
        let (c, s) = (angle.cos(), angle.sin());
        [across * c - along * s, across * s + along * c]
    }

    /// The station at a break of the surface, whose parameter depends on the model's variables. Its
    /// derivative follows from the surface on both sides, which are continuous there; the adjacent
    /// pieces change by the area between.
    fn past_break(&self, at: RulingStation<T>) -> RulingStation<T> {
        let [before, after] = [at.u.next_down(), at.u.next_up()].map(T::from);
        let half = T::from(0.5);
        let jets = [before, after].map(|u| self.surface.jet(u, half, Order::First));
        let kink = jets[1].u - jets[0].u;
        let size = kink.re().norm_sq();
        if size <= 1e-16 * jets[0].u.re().norm_sq() {
            return at;
        }
        let shift = (jets[1].p - jets[0].p).dot(kink) / size;
        let shift = -(shift - shift.re());
        let turn = self.turning(before) - self.turning(after);
        let steps = [before, after].map(|u| Self::laid(self.step(u), at.angle));
        let place = [0, 1].map(|k| at.place[k] + (steps[0][k] - steps[1][k]) * shift);
        RulingStation { angle: at.angle + turn * shift, place, ..at }
    }

    /// The angle at `u` from that at a station before it.
    fn angle(&self, from: &RulingStation<T>, u: f64) -> T {
        let parts = gauss_points(from.u, u);
        parts.into_iter().fold(from.angle, |sum, (u, w)| sum + self.turning(T::from(u)) * w)
    }

    /// The station at `u`, from one before it.
    fn carried(&self, from: &RulingStation<T>, u: f64) -> RulingStation<T> {
        let mut place = from.place;
        for (at, weight) in gauss_points(from.u, u) {
            let step = Self::laid(self.step(T::from(at)), self.angle(from, at));
            place = [0, 1].map(|k| place[k] + step[k] * weight);
        }
        RulingStation { u, angle: self.angle(from, u), place }
    }
}

impl<T: Real> Column for Plate<T> {
    type Scalar = T;
    type Across<S: Real> = Segment<S>;

    fn across<J: Jet<T>>(&self, u: J) -> Option<Segment<J>> {
        let plain = u.re();
        let k = self.stations.partition_point(|s| s.u <= plain).clamp(1, self.stations.len() - 1);
        let at = self.carried(&self.stations[k - 1], plain);
        // The non-constant part of u is small: the midpoint rule is exact to its square.
        let du = u - plain;
        let angle_at =
            |share: f64| J::fixed(at.angle) + du * share * self.turning(du * (0.5 * share) + plain);
        let step = Self::laid(self.step(du * 0.5 + plain), angle_at(0.5));
        let [x, y] = [0, 1].map(|k| J::fixed(at.place[k]) + du * step[k]);
        let angle = angle_at(1.0);
        let length = self.middle(u)[1].norm();
        let (dx, dy) = (-(length * angle.sin()), length * angle.cos());
        let [ex, ey, _] = self.frame.axes.map(|e| e.map(J::fixed));
        let origin = self.frame.origin.map(J::fixed);
        let middle = origin + ex * x + ey * y;
        let ruling = (ex * dx + ey * dy) * J::from(0.5);
        Some(Segment { from: middle - ruling, to: middle + ruling })
    }

    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.surface.breaks()[0].clone(), Vec::new()]
    }

    fn edges(&self) -> Edges<T> {
        self.edges.clone()
    }
}
