//! Round sides: parts of cylinders and cones over arcs of circles, ellipses and parabolas.

use super::polytope::{HessePlane, Polytope};
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The plane curve at the start of a round side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RoundProfile<T> {
    /// `centre + a cos(s sweep) + b sin(s sweep)` for s in [0, 1]: part of an ellipse of conjugate
    /// half-diameters a and b.
    Conic {
        /// Centre.
        centre: Vec3<T>,
        /// Vector from the centre to the start.
        a: Vec3<T>,
        /// Conjugate to `a`.
        b: Vec3<T>,
        /// Angle in radians, up to a full turn.
        sweep: T,
    },
    /// The parabola from the first point to the last, with tangents towards the middle point.
    Parabola([Vec3<T>; 3]),
}

/// A round side: ruled between a profile and a shifted, scaled copy of it.
///
/// The profile runs so that its velocity x `shift` points out of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round<T> {
    /// Number of the side.
    pub side: u32,
    /// The near end.
    pub profile: RoundProfile<T>,
    /// Vector from the near end to the far one: between centres, or between the starts of
    /// parabolas.
    pub shift: Vec3<T>,
    /// Relative size of the far end: 1 for cylinders, 0 for a cone with its apex there.
    pub scale: T,
}

impl<T: Real> Round<T> {
    /// The point that shift and scale refer to.
    fn origin(&self) -> Vec3<T> {
        match self.profile {
            RoundProfile::Conic { centre, .. } => centre,
            RoundProfile::Parabola([start, ..]) => start,
        }
    }

    fn at(&self, s: f64) -> Vec3 {
        match self.profile {
            RoundProfile::Conic { centre, a, b, sweep } => {
                let (sine, cosine) = libm::sincos(s * sweep.re());
                centre.re() + a.re() * cosine + b.re() * sine
            }
            RoundProfile::Parabola([start, corner, end]) => {
                let two = start.re().lerp(corner.re(), s);
                two.lerp(corner.re().lerp(end.re(), s), s)
            }
        }
    }

    fn velocity(&self, s: f64) -> Vec3 {
        match self.profile {
            RoundProfile::Conic { a, b, sweep, .. } => {
                let (sine, cosine) = libm::sincos(s * sweep.re());
                b.re() * cosine - a.re() * sine
            }
            RoundProfile::Parabola([start, corner, end]) => {
                (corner - start).re().lerp((end - corner).re(), s)
            }
        }
    }

    /// The point at the far end opposite to `p` at the near one.
    fn far(&self, p: Vec3) -> Vec3 {
        let origin = self.origin().re();
        origin + self.shift.re() + (p - origin) * self.scale.re()
    }

    /// The parts of the profile that turn by a right angle at most, as triangles: start, where the
    /// tangents meet, end.
    fn triangles(&self) -> Vec<[Vec3; 3]> {
        match self.profile {
            RoundProfile::Conic { centre, a, b, sweep } => {
                let turn = sweep.re().abs();
                let n = (turn / FRAC_PI_2 - 1e-9).ceil().max(1.0);
                let part = |k: f64| {
                    let (low, high) = (k / n, (k + 1.0) / n);
                    let middle = (low + high) * 0.5 * sweep.re();
                    let (sine, cosine) = libm::sincos(middle);
                    // On the middle ray, where the tangents of both ends meet.
                    let reach = 1.0 / libm::cos(0.5 * turn / n);
                    let meet = (a.re() * cosine + b.re() * sine) * reach;
                    [self.at(low), centre.re() + meet, self.at(high)]
                };
                (0..n as usize).map(|k| part(k as f64)).collect()
            }
            RoundProfile::Parabola(p) => vec![p.map(|p| p.re())],
        }
    }

    /// The convex inside of the cylinder, cone or parabolic cylinder, a function about as steep as a
    /// distance; with it, for cones, the half-space of the nappe that is meant.
    fn inside(&self) -> Result<(Primitive<T>, Option<Primitive<T>>), FieldError> {
        let origin = self.origin();
        let [u, v, w] = match self.profile {
            RoundProfile::Conic { a, b, .. } => [a, b, self.shift],
            RoundProfile::Parabola([start, corner, end]) => {
                [corner - start, end - start, self.shift]
            }
        };
        let volume = u.cross(v).dot(w);
        let size = u.re().norm() * v.re().norm() * w.re().norm();
        if volume.re().abs() <= 1e-12 * size || !volume.is_finite() {
            return Err(FieldError::Degenerate { what: "round side" });
        }
        // Coordinates along u, v, w as linear functions: rows of the inverse of [u v w].
        let coordinate = |n: Vec3<T>| Primitive::linear(n / volume, -(n.dot(origin) / volume));
        let [x, y, h] = [v.cross(w), w.cross(u), u.cross(v)].map(coordinate);
        let one = Primitive::real(T::one());
        let scale = h * (self.scale - T::one()) + one;
        let steep = u.norm() * v.norm();
        let (f, measure) = match self.profile {
            // On the surface |gradient| of x² + y² - 1 is 2 / radius.
            RoundProfile::Conic { .. } => {
                (x.power(2) + y.power(2) - scale.power(2), steep.sqrt() * 0.5)
            }
            RoundProfile::Parabola(_) => {
                let start = &(&scale - &x) - &y;
                (x.power(2) - start * y * T::from(4.0), steep.sqrt() * 0.25)
            }
        };
        let nappe = (self.scale.re() != 1.0).then(|| -scale);
        Ok((f * measure, nappe))
    }
}

/// A round side, or several that make a full turn, among numbers without derivatives.
pub(super) struct Rounded {
    /// Numbers of the sides in the list.
    parts: Vec<usize>,
    plain: Vec<Round<f64>>,
    /// True if the solid is inside.
    convex: bool,
    full: bool,
}

impl Rounded {
    /// All of them; those of one surface with a full turn in total are merged.
    ///
    /// # Errors
    /// Degenerate ones.
    pub fn all<T: Real>(rounds: &[Round<T>], epsilon: f64) -> Result<Vec<Rounded>, FieldError> {
        let mut out: Vec<Rounded> = Vec::new();
        let mut surfaces: Vec<Primitive> = Vec::new();
        for (k, round) in rounds.iter().enumerate() {
            let plain = plain(round);
            let (surface, nappe) = plain.inside()?;
            let mut middle = plain.at(0.5);
            // Halfway to the far end.
            middle += (plain.far(middle) - middle) * 0.5;
            let outward = plain.velocity(0.5).cross(plain.shift);
            let convex = surface.gradient(middle).slope.dot(outward) * turn_sign(&plain) > 0.0;
            let same = |r: &Rounded, s: &Primitive| {
                let on = |p: Vec3| s.value(p).abs() <= 10.0 * epsilon;
                let first = &r.plain[0];
                let ends = [0.0, 0.3, 1.0].map(|s| plain.at(s));
                nappe.is_none()
                    && r.convex == convex
                    && first.scale == plain.scale
                    && (first.shift - plain.shift).norm() <= 10.0 * epsilon
                    && ends.iter().all(|p| on(*p) && on(plain.far(*p)))
            };
            let found = out.iter().zip(&surfaces).position(|(r, s)| same(r, s));
            match found {
                Some(n) => {
                    out[n].parts.push(k);
                    out[n].plain.push(plain);
                }
                None => {
                    let full = turn(&plain) >= TAU - 1e-9;
                    out.push(Rounded { parts: vec![k], plain: vec![plain], convex, full });
                    surfaces.push(surface);
                }
            }
        }
        // Those that do not close stay apart.
        let mut apart = Vec::new();
        for mut r in out {
            r.full |= r.plain.iter().map(turn).sum::<f64>() >= TAU - 1e-9;
            if r.full || r.parts.len() == 1 {
                apart.push(r);
                continue;
            }
            for (k, plain) in r.parts.into_iter().zip(r.plain) {
                let (parts, plain) = (vec![k], vec![plain]);
                apart.push(Rounded { parts, plain, convex: r.convex, full: false });
            }
        }
        Ok(apart)
    }

    /// The triangles at both ends, beside which faces may end.
    pub fn ends(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.plain.iter().flat_map(|round| {
            round.triangles().into_iter().flat_map(|near| [near, near.map(|p| round.far(p))])
        })
    }

    /// Convex bodies around the parts of the side.
    pub fn wedges(&self) -> impl Iterator<Item = Polytope> + '_ {
        self.plain.iter().flat_map(|round| {
            let wedge = |near: [Vec3; 3]| Polytope::wedge(near, near.map(|p| round.far(p)));
            round.triangles().into_iter().map(wedge)
        })
    }

    /// Planes that may part it from other round sides.
    pub fn beside(&self) -> Vec<HessePlane> {
        let mut out = Vec::new();
        for round in &self.plain {
            let origin = round.origin();
            for near in round.triangles() {
                let [p, m, q] = near;
                out.push(HessePlane::through((m - p).cross(q - p), p));
                let [a, b, c] = near.map(|x| round.far(x));
                out.push(HessePlane::through((b - a).cross(c - a), a));
                for [x, y] in [[p, q], [p, m], [m, q], [origin, p], [origin, q]] {
                    let along = if (round.far(x) - x).norm() > 0.0 { x } else { y };
                    out.push(HessePlane::through((y - x).cross(round.far(along) - along), x));
                }
            }
        }
        out.into_iter().flatten().collect()
    }

    /// The set that it bounds near itself.
    pub fn set<T: Real>(&self, rounds: &[Round<T>]) -> Result<Set<T>, FieldError> {
        let round = &rounds[self.parts[0]];
        let (inside, nappe) = round.inside()?;
        let mut set = Set::new(&inside);
        if let Some(nappe) = nappe {
            set = set & Set::new(&nappe);
        }
        if !self.full {
            // Beyond the chord, away from the arc, the solid continues.
            let plain = &self.plain[0];
            let (start, end) = (plain.at(0.0), plain.at(1.0));
            let far = |p: Vec3| plain.far(p) - p;
            let ruling = if far(start).norm() > 0.0 { far(start) } else { far(end) };
            let level = HessePlane::through((end - start).cross(ruling), start)
                .ok_or(FieldError::Degenerate { what: "round side" })?;
            let level = if level.at(plain.at(0.5)) > 0.0 { level } else { level.turned() };
            let chord = Primitive::linear(Vec3::lifted(level.normal), T::from(level.offset));
            set = set | Set::new(&chord);
        }
        Ok(if self.convex { set } else { -set })
    }
}

/// The sign of a sweep: the velocity is given without it.
fn turn_sign(round: &Round<f64>) -> f64 {
    match round.profile {
        RoundProfile::Conic { sweep, .. } if sweep < 0.0 => -1.0,
        _ => 1.0,
    }
}

fn turn(round: &Round<f64>) -> f64 {
    match round.profile {
        RoundProfile::Conic { sweep, .. } => sweep.abs(),
        RoundProfile::Parabola(_) => 0.0,
    }
}

fn plain<T: Real>(round: &Round<T>) -> Round<f64> {
    let profile = match round.profile {
        RoundProfile::Conic { centre, a, b, sweep } => {
            RoundProfile::Conic { centre: centre.re(), a: a.re(), b: b.re(), sweep: sweep.re() }
        }
        RoundProfile::Parabola(p) => RoundProfile::Parabola(p.map(|p| p.re())),
    };
    Round { side: round.side, profile, shift: round.shift.re(), scale: round.scale.re() }
}
