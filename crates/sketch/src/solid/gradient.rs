//! Derivatives of a finished object by its dimensions and variables.

use crate::solid::Vertex;
use crate::solid::coincidence::Kink;
use crate::{Estimate, Planes, SketchObject, solid, solve};
use moldloft_num::{Dual, Real, Vec3};
use std::collections::BTreeMap;

/// Directions of one pass.
const WIDTH: usize = 4;

/// Exact derivatives with respect to one number each, in the given order; NaN if undefined, and at
/// a vertex that splits into several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidGradient {
    /// Derivatives of the volume; zero for a flat figure.
    pub volume: Vec<f64>,
    /// Derivatives of the area.
    pub area: Vec<f64>,
    /// Derivatives of the centroid.
    pub centroid: Vec<Vec3>,
    /// Derivatives of the vertices of [`crate::SketchSolid`], in their order.
    pub points: Vec<Vec<Vec3>>,
    /// Two one-sided derivatives of a measure.
    pub kinks: Vec<Option<Kink>>,
}

/// Derivatives with respect to dimensions and variables (any case). A number computed by an
/// expression is varied as an independent value. `others` replaces numbers of other objects that
/// this one reads, named `object.number`.
///
/// # Errors
/// The first name that is not a dimension or variable with a value; an empty one when there is no solid.
pub fn gradient(
    object: &SketchObject,
    planes: &Planes,
    by: &[String],
    others: &dyn Fn(&BTreeMap<String, Dual<WIDTH>>) -> BTreeMap<String, Dual<WIDTH>>,
) -> Result<SolidGradient, String> {
    let estimate = || Estimate::of(&object.drawing, planes, object.reference()?.point);
    let present: BTreeMap<String, f64> =
        others(&BTreeMap::new()).into_iter().map(|(name, x)| (name, x.re())).collect();
    let plain = solve(object, planes, &present, &estimate);
    let followed: BTreeMap<String, bool> = (object.followed_numbers().into_iter())
        .map(|(name, value, _)| (name.to_ascii_lowercase(), value.literal().is_some()))
        .collect();
    let keys: Vec<String> = by.iter().map(|name| object.source(name)).collect();
    if let Some(k) = keys.iter().position(|k| !plain.values.contains_key(k)) {
        return Err(by[k].clone());
    }
    // A computed number is seeded separately, since otherwise its dependence on the others would be
    // lost.
    let plain_number = |key: &String| {
        let dimension = object.dimensions.get(key).and_then(|d| d.value.as_ref());
        match dimension.or(object.variables.get(key).map(|v| &v.value)) {
            Some(own) => own.literal().is_some(),
            None => followed.get(key).copied().unwrap_or(false),
        }
    };
    let (given, computed): (Vec<usize>, Vec<usize>) =
        (0..keys.len()).partition(|&k| plain_number(&keys[k]));
    let passes = given.chunks(WIDTH).chain(computed.chunks(1));
    let n = keys.len();
    let mut out = SolidGradient {
        volume: vec![0.0; n],
        area: vec![0.0; n],
        centroid: vec![Vec3::zero(); n],
        points: vec![Vec::new(); n],
        kinks: vec![None; n],
    };
    for pass in passes {
        let own: BTreeMap<String, Dual<WIDTH>> = (pass.iter().enumerate())
            .map(|(d, &k)| (keys[k].clone(), Dual::seeded(plain.values[&keys[k]], d)))
            .collect();
        let mut seeded = others(&own);
        seeded.extend(own);
        let layout = solve(object, planes, &seeded, &estimate);
        let body = solid(object, planes, &layout).ok_or_else(String::new)?;
        let mass = body.mass();
        for (d, &k) in pass.iter().enumerate() {
            let part = |v: Vec3<Dual<WIDTH>>| v.map(|x| x.eps[d]);
            out.volume[k] = mass.volume.eps[d];
            out.area[k] = mass.area.eps[d];
            out.centroid[k] = part(mass.centroid);
            // A kink of the volume is reported first.
            let own = body.kinks.iter().filter(|kink| kink.part == d + 1);
            out.kinks[k] = own.max_by_key(|kink| kink.volume).copied();
            let at = |v: &Vertex<Dual<WIDTH>>| part(v.at);
            out.points[k] = body.vertices.iter().map(at).collect();
        }
    }
    Ok(out)
}

/// Results for a value of a swept number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// Its value.
    pub value: f64,
    /// Volume, area and centroid; `None` where there is no body.
    pub mass: Option<crate::Mass<f64>>,
}
