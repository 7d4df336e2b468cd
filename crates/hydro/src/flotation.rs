//! A body in still water at any draft, trim and heel.

use crate::body::Body;
use crate::figures::{Floating, floating};
use crate::hydrostatics::{Hydrostatics, Symmetry, Waterplane};
use moldloft_num::{Real, Vec3};

/// Within this heel, in radians, a body is upright: rounding leaves less, and no table shows it.
const UPRIGHT: f64 = 1e-6;

/// A body whose vertical has a smaller share, its cosine, of that of the water lies on its side.
const ON_ITS_SIDE: f64 = 1e-6;

/// How a body lies in the water: first heeled about its own x axis, then trimmed about the level
/// axis across it, both through its origin; then the water stands at `level` above the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude<T> {
    /// Height of the water over the body's origin.
    pub level: T,
    /// Radians; positive sinks what has large x.
    pub trim: T,
    /// Radians; positive sinks what has large y.
    pub heel: T,
}

impl<T: Real> Attitude<T> {
    /// Upright, the water at `level`.
    pub fn upright(level: T) -> Self {
        Self { level, trim: T::zero(), heel: T::zero() }
    }

    /// The three numbers: level, trim, heel.
    pub fn to_array(self) -> [T; 3] {
        [self.level, self.trim, self.heel]
    }

    /// The attitude of three numbers.
    pub fn of([level, trim, heel]: [T; 3]) -> Self {
        Self { level, trim, heel }
    }

    /// A point of the body seen from the water: x level along the body, z up.
    pub fn earth_from(&self, p: Vec3<T>) -> Vec3<T> {
        let (st, ct, sh, ch) = self.turns();
        let (y, z) = (p.y * ch + p.z * sh, p.z * ch - p.y * sh);
        Vec3::new(p.x * ct + z * st, y, z * ct - p.x * st)
    }

    /// The reverse of [`Attitude::earth_from`].
    pub fn body_from(&self, p: Vec3<T>) -> Vec3<T> {
        let (st, ct, sh, ch) = self.turns();
        let (x, z) = (p.x * ct - p.z * st, p.z * ct + p.x * st);
        Vec3::new(x, p.y * ch - z * sh, z * ch + p.y * sh)
    }

    /// The height z of the water in the body's axes, over (x, y) = (`x`, 0).
    pub fn water_over(&self, x: T) -> T {
        let (st, ct, _, ch) = self.turns();
        (self.level + x * st) / (ct * ch)
    }

    /// The level at which the water stands at height `z` of the body over (`x`, 0).
    pub fn level_at(trim: T, heel: T, x: T, z: T) -> T {
        let (st, ct, _, ch) = Self { level: T::zero(), trim, heel }.turns();
        z * ct * ch - x * st
    }

    /// The body as the water sees it.
    pub fn turned(&self, body: &Body<T>) -> Body<T> {
        let still = |a: T| a.re() == 0.0 && a.is_constant();
        if still(self.trim) && still(self.heel) {
            return body.clone();
        }
        let (st, ct, sh, ch) = self.turns();
        let place = |p: Vec3<T>| {
            let (y, z) = (p.y * ch + p.z * sh, p.z * ch - p.y * sh);
            Vec3::new(p.x * ct + z * st, y, z * ct - p.x * st)
        };
        body.mapped(place, false)
    }

    fn turns(&self) -> (T, T, T, T) {
        (self.trim.sin(), self.trim.cos(), self.heel.sin(), self.heel.cos())
    }
}

/// The water, and what the skin shows of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Water {
    /// Mass per volume.
    pub density: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
    /// What the skin shows; a heeled body must be shown whole.
    pub symmetry: Symmetry,
    /// A centimetre in the model's unit of length: 0.01 for metres.
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
    /// How it lies.
    pub attitude: Attitude<T>,
    /// The figures of the turned body, in axes that are level; x is level along the body, y across.
    pub earth: Hydrostatics<T>,
    /// Centre of buoyancy in the body's axes.
    pub buoyancy_centre: Option<Vec3<T>>,
    /// Centre of the waterplane in the body's axes.
    pub flotation_centre: Option<Vec3<T>>,
    /// Depth of the lowest point of the upright body below the water, on the centre line at the
    /// lowest x, in the middle, at the highest x.
    pub drafts: [T; 3],
    /// Height of the lowest open edge (the sheer of a hull without deck) over the water; negative
    /// where it is under: then the figures are those of a body that no longer holds water. `None`
    /// without open edges.
    pub freeboard: Option<T>,
    /// Displaced mass times gravity.
    pub weight: T,
    /// Mass that sinks the body by a centimetre.
    pub tpc: Option<T>,
    /// Moment (mass times length) that trims the body by a centimetre between the ends of the
    /// waterline; from GM where a centre of gravity is given, else from BM.
    pub mtc: Option<T>,
    /// Transverse and longitudinal metacentric height at this attitude, when a centre of gravity is
    /// given: the slope of the righting arm for small turns of the floating body.
    pub gm: Option<[T; 2]>,
    /// Righting arm: how far buoyancy acts to the sunken side of gravity, level across the body.
    pub gz: Option<T>,
    /// The same along the body: zero in trim.
    pub trim_arm: Option<T>,
    /// Area moment of the waterplane about level axes through its centre, the integral of x y.
    pub product_moment: T,
    /// Estimates of the errors of volume, its first moments, wetted area, and of the waterplane's area, first and
    /// second moments.
    pub errors: [f64; 6],
    /// True when all small turns are righted; `None` without a centre of gravity.
    pub stable: Option<bool>,
}

impl<T: Real> Flotation<T> {
    /// Every figure by the name that tables, JSON and derivatives use, in a fixed order; those
    /// without meaning are left out. Centres are in the body's axes, extents of the waterplane in
    /// level ones.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let Attitude { level, trim, heel } = self.attitude;
        let mut rows = vec![("level", level), ("trim", trim), ("heel", heel)];
        let names = ["draft_low_x", "draft_mid", "draft_high_x"];
        // Draughts are measured along the body's own vertical: on its side it has none.
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

/// The bounds of the main figures by name: estimates of the errors of quadrature and interpolation, carried to the
/// figures at first order.
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

/// The figures of the body at an attitude; `gravity_centre` is in the body's axes.
///
/// With a skin of one side ([`Symmetry`]) the heel must be zero.
pub fn flotation<T: Real>(
    body: &Body<T>,
    water: Water,
    attitude: Attitude<T>,
    gravity_centre: Option<Vec3<T>>,
) -> Flotation<T> {
    let turned = attitude.turned(body);
    let Water { density, gravity, symmetry, centimetre } = water;
    let Floating { figures: mut earth, product_moment, errors } =
        floating(&turned, attitude.level, symmetry, density);
    if attitude.heel.re().abs() > UPRIGHT {
        // The box of a heeled waterline says nothing of the form: where a corner of the deck dips in, it is a sliver.
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
            // Wholly under water the metacentres are the centre of buoyancy.
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
        freeboard: turned.lowest_rim().map(|z| z - attitude.level),
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

/// The middle of the skin's length and its lowest z: where drafts are measured.
pub fn bottom<T: Real>(body: &Body<T>) -> [T; 2] {
    let Extents { low_x, high_x, low_z } = extents(body);
    [(low_x + high_x) * 0.5, low_z]
}

/// Extents of the skin, with the derivatives of the places they are reached at.
struct Extents<T> {
    low_x: T,
    high_x: T,
    low_z: T,
}

fn extents<T: Real>(body: &Body<T>) -> Extents<T> {
    let along = |x: f64, z: f64| body.lowest(Vec3::of(x, 0.0, z)).unwrap_or(T::zero());
    Extents { low_x: along(1.0, 0.0), high_x: -along(-1.0, 0.0), low_z: along(0.0, 1.0) }
}
