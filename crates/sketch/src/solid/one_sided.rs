//! Derivatives of measures on both sides of a position at which faces, edges or corners meet by
//! chance.
//!
//! The motion of faces there shows that a measure may have two derivatives, not that it does: an
//! edge that leaves a face can change the area equally on both sides. So the body is rebuilt with
//! slightly smaller and larger values of the number, and the measures are differentiated on each
//! side by the one-sided formula of fourth order. If both sides agree there is one derivative.

use super::SketchSolid;
use super::coincidence::without;
use super::mass::Mass;
use crate::DimensionLayout;
use moldloft_num::{Real, Vec3};
use std::collections::BTreeSet;

/// Derivatives of measures by one part of the scalar, in place of those of the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassRate {
    part: usize,
    area: Option<f64>,
    /// Derivatives of volume, centroid and inertia.
    solid: Option<Mass<f64>>,
}

/// Steps relative to the body. Near another such point, or where edges nearly intersect, a smaller
/// one is needed; if a measure changes as a root of the step no step is small enough.
const STEPS: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// Weights of the values at 0 to 4 steps, for twelve times the step.
const FORWARD: [f64; 5] = [-25.0, 48.0, -36.0, 16.0, -3.0];

/// Relative difference within which derivatives are equal.
const ALIKE: f64 = 1e-6;

/// The measures of the body of other numbers, if there is one.
type MadeAt<'a> = dyn Fn(&DimensionLayout<f64>) -> Option<Mass<f64>> + 'a;

/// Takes back the kinks of a body where both sides have the same derivative.
pub(super) fn confirm<T: Real>(
    found: &mut SketchSolid<T>,
    layout: &DimensionLayout<T>,
    made: &MadeAt<'_>,
) {
    if !T::FIRST_ORDER || found.kinks.is_empty() {
        return;
    }
    let kinks = std::mem::take(&mut found.kinks);
    let mass = found.mass();
    let size = size_of(found);
    let parts: BTreeSet<usize> = kinks.iter().map(|kink| kink.part).collect();
    let mut rates = Vec::new();
    for part in parts {
        let most = rate(layout, part);
        if most == 0.0 {
            rates.push(MassRate { part, area: Some(0.0), solid: Some(differential(&[])) });
            continue;
        }
        let mut best = MassRate { part, area: None, solid: None };
        for share in STEPS {
            let step = share * size / most;
            let own = part_of(&mass, part);
            let one = sides(layout, made, part, step)
                .map(|sides| agreed(part, &own, sides, &mass, size, most));
            let Some(one) = one else { continue };
            best.area = best.area.or(one.area);
            best.solid = best.solid.or(one.solid);
            if best.area.is_some() && best.solid.is_some() {
                break;
            }
        }
        rates.push(best);
    }
    let rate_of = |k: usize| rates.iter().find(|r| r.part == k);
    found.kinks = (kinks.into_iter())
        .filter_map(|mut kink| {
            let rate = rate_of(kink.part)?;
            kink.volume &= rate.solid.is_none();
            (kink.volume || rate.area.is_none()).then_some(kink)
        })
        .collect();
    found.rates = rates;
}

/// The measures with the derivatives that both sides have, and none at kinks.
pub(super) fn settled<T: Real>(mut mass: Mass<T>, body: &SketchSolid<T>) -> Mass<T> {
    for rate in &body.rates {
        let with = |x: T, by: f64| T::from_parts(|k| if k == rate.part { by } else { x.part(k) });
        if let Some(area) = rate.area {
            mass.area = with(mass.area, area);
        }
        if let Some(solid) = rate.solid {
            mass.volume = with(mass.volume, solid.volume);
            let [x, y, z] = solid.centroid.to_array();
            let c = mass.centroid;
            mass.centroid = Vec3::new(with(c.x, x), with(c.y, y), with(c.z, z));
            for (own, by) in mass.inertia.iter_mut().zip(solid.inertia) {
                *own = with(*own, by);
            }
        }
    }
    without(mass, &body.kinks)
}

/// The greatest distance between vertices of a body and the first.
fn size_of<T: Real>(body: &SketchSolid<T>) -> f64 {
    let all = || body.vertices.iter().map(|v| v.at.re());
    let first = all().next().unwrap_or_default();
    all().map(|p| p.distance(first)).fold(f64::MIN_POSITIVE, f64::max)
}

/// Maximum rate of change of numbers and coordinates.
fn rate<T: Real>(layout: &DimensionLayout<T>, part: usize) -> f64 {
    let coordinates = layout.coordinates.iter().flatten().flatten();
    layout.values.values().chain(coordinates).map(|x| x.part(part).abs()).fold(0.0, f64::max)
}

/// The numbers of an object displaced along one part.
fn shifted<T: Real>(layout: &DimensionLayout<T>, part: usize, by: f64) -> DimensionLayout<f64> {
    let at = |x: &T| x.re() + by * x.part(part);
    DimensionLayout {
        coordinates: layout
            .coordinates
            .clone()
            .map(|all| all.iter().map(|x| x.as_ref().map(at)).collect()),
        counts: layout.counts,
        loose: layout.loose.clone(),
        faults: layout.faults.clone(),
        values: layout.values.iter().map(|(name, x)| (name.clone(), at(x))).collect(),
    }
}

/// The derivatives for less and for more of a number; `None` where there is no body beside.
fn sides<T: Real>(
    layout: &DimensionLayout<T>,
    made: &MadeAt<'_>,
    part: usize,
    step: f64,
) -> Option<[Mass<f64>; 2]> {
    let at = |by: f64| made(&shifted(layout, part, by));
    let here = at(0.0)?;
    let side = |step: f64| {
        let mut all = vec![(here, FORWARD[0] / (12.0 * step))];
        for (k, weight) in FORWARD.iter().enumerate().skip(1) {
            all.push((at(step * k as f64)?, weight / (12.0 * step)));
        }
        Some(differential(&all))
    };
    Some([side(-step)?, side(step)?])
}

/// The sum of measures with weights.
fn differential(all: &[(Mass<f64>, f64)]) -> Mass<f64> {
    let sum = |of: &dyn Fn(&Mass<f64>) -> f64| all.iter().map(|(m, w)| of(m) * w).sum();
    Mass {
        area: sum(&|m| m.area),
        volume: sum(&|m| m.volume),
        centroid: all.iter().fold(Vec3::zero(), |s, (m, w)| s + m.centroid * *w),
        inertia: std::array::from_fn(|k| sum(&|m| m.inertia[k])),
    }
}

fn part_of<T: Real>(mass: &Mass<T>, part: usize) -> Mass<f64> {
    Mass {
        area: mass.area.part(part),
        volume: mass.volume.part(part),
        centroid: mass.centroid.map(|x| x.part(part)),
        inertia: mass.inertia.map(|x| x.part(part)),
    }
}

/// The common value of both sides: the derivative from the faces if it agrees, otherwise the mean.
fn agreed<T: Real>(
    part: usize,
    own: &Mass<f64>,
    [below, above]: [Mass<f64>; 2],
    mass: &Mass<T>,
    size: f64,
    most: f64,
) -> MassRate {
    let one = |own: f64, below: f64, above: f64, scale: f64| {
        let scale = (scale.abs() * most / size).max(below.abs()).max(above.abs());
        let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * scale;
        let middle = (below + above) / 2.0;
        near(below, above).then_some(if near(own, middle) { own } else { middle })
    };
    let area = one(own.area, below.area, above.area, mass.area.re());
    let solid = || {
        let volume = one(own.volume, below.volume, above.volume, mass.volume.re())?;
        let place = |of: &dyn Fn(&Mass<f64>) -> f64| one(of(own), of(&below), of(&above), size);
        let centroid = Vec3::new(
            place(&|m| m.centroid.x)?,
            place(&|m| m.centroid.y)?,
            place(&|m| m.centroid.z)?,
        );
        let scale = mass.volume.re() * size * size;
        let mut inertia = [0.0; 6];
        for (k, x) in inertia.iter_mut().enumerate() {
            *x = one(own.inertia[k], below.inertia[k], above.inertia[k], scale)?;
        }
        Some(Mass { area: 0.0, volume, centroid, inertia })
    };
    MassRate { part, area, solid: solid() }
}
