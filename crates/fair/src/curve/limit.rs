//! Limits on the moves of control points.

use crate::FairError;
use moldloft_num::{Real, Vec3};

/// Directions in which control points may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Any direction: the distance from the original is limited.
    Ball,
    /// Any direction: the change of each coordinate is limited.
    Box,
    /// Along this unit direction only: offsets at fixed stations.
    Along(Vec3<f64>),
    /// Across this unit direction only: points of a station move within its plane.
    Across(Vec3<f64>),
}

/// Limits on the moves of control points from their original positions.
///
/// A radius of 0 freezes a point; an infinite one ("tolerance none") leaves it free.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// In which directions.
    pub motion: Motion,
    /// Maximum move of each control point; `f64::INFINITY` for no limit.
    pub radii: Vec<f64>,
}

impl Limit {
    /// The same radius for `count` points.
    ///
    /// # Errors
    /// [`FairError::Tolerance`] when it is negative or NaN.
    pub fn ball(count: usize, radius: f64) -> Result<Self, FairError> {
        Self::new(Motion::Ball, vec![radius; count])
    }

    /// Individual radii for all points. Directions are normalised.
    ///
    /// # Errors
    /// [`FairError::Tolerance`] when one is negative or NaN, or a direction has no length.
    pub fn new(motion: Motion, radii: Vec<f64>) -> Result<Self, FairError> {
        if let Some(&value) = radii.iter().find(|r| r.is_nan() || **r < 0.0) {
            return Err(FairError::Tolerance { value });
        }
        let unit = |d: Vec3<f64>| {
            let unit = d.normalized().filter(|u| u.is_finite());
            unit.ok_or(FairError::Tolerance { value: d.norm() })
        };
        let motion = match motion {
            Motion::Along(d) => Motion::Along(unit(d)?),
            Motion::Across(d) => Motion::Across(unit(d)?),
            other => other,
        };
        Ok(Self { motion, radii })
    }

    /// The position nearest to `wanted` that point `i`, now at `here` and originally at `original`,
    /// may take. If the measure is isotropic in one point and `wanted` is the unconstrained
    /// minimiser, this is the exact constrained one.
    #[inline]
    pub fn nearest(
        &self,
        i: usize,
        original: Vec3<f64>,
        here: Vec3<f64>,
        wanted: Vec3<f64>,
    ) -> Vec3<f64> {
        let radius = self.radii[i];
        if radius == 0.0 {
            return original;
        }
        match self.motion {
            Motion::Ball => {
                let away = wanted - original;
                // The projection rounds inwards, so the bound holds to the last bit.
                let reach = radius * (1.0 - 2.0 * f64::EPSILON);
                let square = away.norm_sq();
                if square <= reach * reach {
                    wanted
                } else {
                    inside(original, away * (reach / square.sqrt()), radius)
                }
            }
            Motion::Box => {
                let clamp = |o: f64, w: f64| {
                    let x = w.clamp(o - radius, o + radius);
                    match x - o {
                        off if off > radius => x.next_down(),
                        off if off < -radius => x.next_up(),
                        _ => x,
                    }
                };
                Vec3::of(
                    clamp(original.x, wanted.x),
                    clamp(original.y, wanted.y),
                    clamp(original.z, wanted.z),
                )
            }
            Motion::Along(d) => {
                let way = (wanted - original).dot(d).clamp(-radius, radius);
                inside(original, d * way, radius)
            }
            Motion::Across(d) => {
                let away = wanted - original;
                let away = away - d * away.dot(d);
                let square = away.norm_sq();
                let reach = radius * (1.0 - 2.0 * f64::EPSILON);
                if square <= reach * reach {
                    original + away
                } else {
                    inside(original, away * (reach / square.sqrt()), radius)
                }
            }
        }
        .pick(here)
    }
}

impl Motion {
    /// The part of a displacement that the motion allows within a radius, for numbers that carry
    /// derivatives.
    pub(crate) fn allowed<T: Real>(&self, away: Vec3<T>, radius: T) -> Vec3<T> {
        let within = |way: Vec3<T>| {
            if way.norm_sq().re() > radius.re() * radius.re() {
                way * (radius / way.norm())
            } else {
                way
            }
        };
        let clamped = |x: T| {
            if x.re() > radius.re() {
                radius
            } else if x.re() < -radius.re() {
                -radius
            } else {
                x
            }
        };
        let along = |d: Vec3<f64>| away.x * d.x + away.y * d.y + away.z * d.z;
        let times = |d: Vec3<f64>, way: T| Vec3::new(way * d.x, way * d.y, way * d.z);
        match *self {
            Motion::Ball => within(away),
            Motion::Box => away.map(clamped),
            Motion::Along(d) => times(d, clamped(along(d))),
            Motion::Across(d) => within(away - times(d, along(d))),
        }
    }
}

/// `original + away`, pulled in until its rounded distance is within the radius. The sum rounds to
/// the spacing of the coordinates, which may be coarse beside the radius, so that is the step.
fn inside(original: Vec3<f64>, away: Vec3<f64>, radius: f64) -> Vec3<f64> {
    let reach = away.norm();
    let size = original.x.abs().max(original.y.abs()).max(original.z.abs()) + radius;
    let mut less = 0.0;
    for _ in 0..8 {
        let p = original + away * (1.0 - less / reach).max(0.0);
        if (p - original).norm_sq() <= radius * radius {
            return p;
        }
        less = if less == 0.0 { f64::EPSILON * size } else { 2.0 * less };
    }
    original
}

/// A finite position, or the one before.
trait Pick {
    fn pick(self, here: Self) -> Self;
}

impl Pick for Vec3<f64> {
    #[inline(always)]
    fn pick(self, here: Self) -> Self {
        if self.is_finite() { self } else { here }
    }
}
