//! A body in still water at any draft, trim and heel.

use crate::attitude::Attitude;
use crate::body::Body;
use crate::figures::{Floating, floating};
use crate::hydrostatics::{Hydrostatics, Symmetry, Waterplane};
use moldloft_num::{Real, Vec3};

/// Maximum heel of an upright body, in radians: above rounding, below the resolution of tables.
const UPRIGHT: f64 = 1e-6;

/// Cosine of the angle between the vertical of the body and that of the water below which the body
/// is on its side.
const ON_ITS_SIDE: f64 = 1e-6;

/// Properties of the water, and symmetry of the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Water {
    /// Mass per volume.
    pub density: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
    /// Symmetry of the skin; a heeled body needs a whole skin.
    pub symmetry: Symmetry,
    /// One centimetre in the unit of length of the model: 0.01 for metres.
    pub centimetre: f64,
}

impl Default for Water {
    /// Density 1, gravity 9.80665 (ISO 80000-3), the whole body, metres.
    fn default() -> Self {
        Self { density: 1.0, gravity: 9.80665, symmetry: Symmetry::None, centimetre: 0.01 }
    }
}

/// The figures of a body at an attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flotation<T> {
    /// The attitude.
    pub attitude: Attitude<T>,
    /// Figures in earth axes: x horizontal along the body, y across, z up.
    pub earth: Hydrostatics<T>,
    /// Centre of buoyancy in body axes.
    pub buoyancy_centre: Option<Vec3<T>>,
    /// Centre of flotation in body axes.
    pub flotation_centre: Option<Vec3<T>>,
    /// Drafts to the lowest point of the upright body, on the centre line at the lowest x, in the
    /// middle, and at the highest x.
    pub drafts: [T; 3],
    /// Height of the lowest open edge (the sheer of a hull without deck) above the water. Negative
    /// for an immersed edge: the figures are then those of a flooding body. `None` without open
    /// edges.
    pub freeboard: Option<T>,
    /// Displaced mass times gravity.
    pub weight: T,
    /// Mass that immerses the body by one centimetre.
    pub tpc: Option<T>,
    /// Moment (mass times length) that changes the trim by one centimetre over the length of the
    /// waterline; from GM with a centre of gravity, otherwise from BM.
    pub mtc: Option<T>,
    /// Transverse and longitudinal metacentric height at this attitude, the derivatives of the
    /// righting arms of the floating body; `None` without a centre of gravity.
    pub gm: Option<[T; 2]>,
    /// Righting arm: horizontal distance across the body from the line of gravity to that of
    /// buoyancy, positive to the immersed side.
    pub gz: Option<T>,
    /// Horizontal distance along the body from the line of gravity to that of buoyancy: zero in
    /// longitudinal equilibrium.
    pub trim_arm: Option<T>,
    /// Product moment of the waterplane about horizontal axes through its centre: the integral of x
    /// y.
    pub product_moment: T,
    /// Estimates of the errors of volume, its first moments, wetted area, and of the waterplane's area, first and
    /// second moments.
    pub errors: [f64; 6],
    /// True for positive stiffness in heel and trim; `None` without a centre of gravity.
    pub stable: Option<bool>,
}

impl<T: Real> Flotation<T> {
    /// Every figure by its name in tables, JSON and derivatives, in a fixed order; undefined ones
    /// are omitted. Centres are in body axes, extents of the waterplane in earth axes.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let Attitude { level, trim, heel } = self.attitude;
        let mut rows = vec![("level", level), ("trim", trim), ("heel", heel)];
        let names = ["draft_low_x", "draft_mid", "draft_high_x"];
        // Drafts are measured along the vertical of the body; on its side it has none.
        if (heel.cos() * trim.cos()).re().abs() > ON_ITS_SIDE {
            rows.extend(names.into_iter().zip(self.drafts));
        }
        rows.extend(self.freeboard.map(|x| ("freeboard", x)));
        let centres = [
            ("lcb", self.buoyancy_centre.map(|c| c.x)),
            ("tcb", self.buoyancy_centre.map(|c| c.y)),
            ("vcb", self.buoyancy_centre.map(|c| c.z)),
            ("lcf", self.flotation_centre.map(|c| c.x)),
            ("tcf", self.flotation_centre.map(|c| c.y)),
        ];
        for (name, value) in self.earth.figures() {
            let own = centres.iter().find(|(centre, _)| *centre == name);
            rows.push((name, own.and_then(|c| c.1).unwrap_or(value)));
        }
        if self.earth.waterplane.is_some() {
            rows.push(("waterplane_product", self.product_moment));
        }
        rows.push(("weight", self.weight));
        let more = [
            ("tpc", self.tpc),
            ("mtc", self.mtc),
            ("gmt", self.gm.map(|g| g[0])),
            ("gml", self.gm.map(|g| g[1])),
            ("gz", self.gz),
            ("trim_arm", self.trim_arm),
            ("righting_moment", self.gz.map(|gz| gz * self.weight)),
        ];
        rows.extend(more.into_iter().filter_map(|(name, value)| Some((name, value?))));
        rows
    }
}

/// Error bounds of the main figures by name: estimates for quadrature and interpolation, propagated
/// to first order.
pub fn bounds<T: Real>(flotation: &Flotation<T>) -> Vec<(&'static str, f64)> {
    let [volume, moment, wetted, area, first, second] = flotation.errors;
    let h = &flotation.earth;
    let v = h.volume.re().abs().max(f64::MIN_POSITIVE);
    let density = (h.displacement.re() / h.volume.re()).abs();
    let mut rows = vec![("volume", volume)];
    if density.is_finite() {
        rows.push(("displacement", volume * density));
    }
    rows.push(("wetted_area", wetted));
    // Moments are about the middle of the body.
    let centre = moment / v;
    if h.buoyancy_centre.is_some() {
        rows.extend([("lcb", centre), ("tcb", centre), ("vcb", centre), ("kb", centre)]);
    }
    if let Some(w) = h.waterplane {
        let a = w.area.re().abs().max(f64::MIN_POSITIVE);
        rows.extend([("waterplane_area", area), ("lcf", first / a), ("tcf", first / a)]);
        rows.extend([("waterplane_it", second), ("waterplane_il", second)]);
        let radius = |i: T| second / v + i.re().abs() / v * (volume / v);
        let (t, l) = (radius(w.transverse_moment), radius(w.longitudinal_moment));
        rows.extend([("bmt", t), ("bml", l), ("kmt", t + centre), ("kml", l + centre)]);
        if flotation.gm.is_some() {
            rows.extend([("gmt", t + centre), ("gml", l + centre)]);
        }
    }
    if h.waterplane.is_none() && flotation.gm.is_some() {
        rows.extend([("gmt", centre), ("gml", centre)]);
    }
    if flotation.gz.is_some() {
        rows.extend([("gz", centre), ("trim_arm", centre)]);
    }
    rows
}

/// The figures of the body at an attitude; `gravity_centre` is in body axes.
/// For a half body ([`Symmetry`]) the heel must be zero.
pub fn flotation<T: Real>(
    body: &Body<T>,
    water: Water,
    attitude: Attitude<T>,
    gravity_centre: Option<Vec3<T>>,
) -> Flotation<T> {
    let Water { density, gravity, symmetry, centimetre } = water;
    let Floating { figures: mut earth, product_moment, errors } =
        floating(body, attitude, symmetry, density);
    if attitude.heel.re().abs() > UPRIGHT {
        // Form coefficients relative to the box of a heeled waterline are meaningless: an immersed
        // deck corner is a sliver.
        earth.coefficients = None;
    }
    let around = extents(body);
    let draft = |x: T| attitude.water_over(x) - around.low_z;
    let drafts = [around.low_x, (around.low_x + around.high_x) * 0.5, around.high_x].map(draft);
    let gravity_earth = gravity_centre.map(|g| attitude.earth_from(g));
    let gm = || {
        let (b, g) = (earth.buoyancy_centre?, gravity_earth?);
        let height = b.z - g.z;
        if earth.waterplane.is_none() {
            // Of a submerged body the metacentres are the centre of buoyancy.
            return Some([height; 2]);
        }
        Some([earth.bm_transverse()? + height, earth.bm_longitudinal()? + height])
    };
    let arms = || Some(earth.buoyancy_centre? - gravity_earth?);
    let (gm, arms) = (gm(), arms());
    let plane = earth.waterplane;
    let stiff = gm.map(|g| g[1]).or(earth.bm_longitudinal());
    let trimming = |p: Waterplane<T>| {
        (p.length.re() > 0.0)
            .then_some(stiff)
            .flatten()
            .map(|gm| earth.displacement * gm * centimetre / p.length)
    };
    let stable = gm.map(|[t, l]| {
        let off = product_moment.re() / earth.volume.re();
        t.re() > 0.0 && l.re() > 0.0 && t.re() * l.re() > off * off
    });
    Flotation {
        attitude,
        buoyancy_centre: earth.buoyancy_centre.map(|c| attitude.body_from(c)),
        flotation_centre: plane.map(|p| attitude.body_from(p.centre)),
        drafts,
        freeboard: body
            .rims_alone()
            .turned(attitude)
            .freeboard(attitude.level, symmetry != Symmetry::None),
        weight: earth.displacement * gravity,
        tpc: plane.map(|p| p.area * density * centimetre),
        mtc: plane.and_then(trimming),
        gm,
        gz: arms.map(|a| a.y),
        trim_arm: arms.map(|a| a.x),
        product_moment,
        errors,
        stable,
        earth,
    }
}

/// Middle of the length of the skin, and its lowest z: the reference point of drafts.
pub fn bottom<T: Real>(body: &Body<T>) -> [T; 2] {
    let Extents { low_x, high_x, low_z } = extents(body);
    [(low_x + high_x) * 0.5, low_z]
}

/// Extents of the skin, with the derivatives of the extreme points.
struct Extents<T> {
    low_x: T,
    high_x: T,
    low_z: T,
}

fn extents<T: Real>(body: &Body<T>) -> Extents<T> {
    let along = |x: f64, z: f64| body.lowest(Vec3::of(x, 0.0, z)).unwrap_or(T::zero());
    Extents { low_x: along(1.0, 0.0), high_x: -along(-1.0, 0.0), low_z: along(0.0, 1.0) }
}
