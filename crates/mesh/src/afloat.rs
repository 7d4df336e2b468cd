//! A body in still water at any draft, trim and heel.

use crate::half_edge::{edges, half_edges};
use crate::hydrostatics::skin_of;
use crate::{FloatOptions, Hydrostatics, Mesh, Symmetry, hydrostatics};
use moldloft_num::{Real, Vec3};

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

    /// The mesh as the water sees it.
    pub fn turned(&self, mesh: &Mesh<T>) -> Mesh<T> {
        let still = |a: T| a.re() == 0.0 && a.is_constant();
        if still(self.trim) && still(self.heel) {
            return mesh.clone();
        }
        let (st, ct, sh, ch) = self.turns();
        let place = |p: &Vec3<T>| {
            let (y, z) = (p.y * ch + p.z * sh, p.z * ch - p.y * sh);
            Vec3::new(p.x * ct + z * st, y, z * ct - p.x * st)
        };
        let positions = mesh.positions().iter().map(place).collect();
        Mesh::new(mesh.topology().clone(), positions).expect("as many positions as before")
    }

    fn turns(&self) -> (T, T, T, T) {
        (self.trim.sin(), self.trim.cos(), self.heel.sin(), self.heel.cos())
    }
}

/// The water, and what the mesh shows of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Water {
    /// Mass per volume.
    pub density: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
    /// What the mesh shows; a heeled body must be shown whole.
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
pub struct Afloat<T> {
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
}

impl<T: Real> Afloat<T> {
    /// Every figure by the name that tables, JSON and derivatives use, in a fixed order; those
    /// without meaning are left out. Centres are in the body's axes, extents of the waterplane in
    /// level ones.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let Attitude { level, trim, heel } = self.attitude;
        let mut rows = vec![("level", level), ("trim", trim), ("heel", heel)];
        let names = ["draft_low_x", "draft_mid", "draft_high_x"];
        rows.extend(names.into_iter().zip(self.drafts));
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

/// The figures of the body at an attitude; `gravity_centre` is in the body's axes.
///
/// With a mesh of one side ([`Symmetry`]) the heel must be zero.
pub fn afloat<T: Real>(
    mesh: &Mesh<T>,
    water: Water,
    attitude: Attitude<T>,
    gravity_centre: Option<Vec3<T>>,
) -> Afloat<T> {
    let turned = attitude.turned(mesh);
    let Water { density, gravity, symmetry, centimetre } = water;
    let earth = hydrostatics(&turned, FloatOptions { level: attitude.level, symmetry, density });
    let around = extents(mesh);
    let draft = |x: T| attitude.water_over(x) - around.low_z;
    let drafts = [around.low_x, (around.low_x + around.high_x) * 0.5, around.high_x].map(draft);
    let gravity_earth = gravity_centre.map(|g| attitude.earth_from(g));
    let gm = || {
        let (b, g) = (earth.buoyancy_centre?, gravity_earth?);
        let height = b.z - g.z;
        Some([earth.bm_transverse()? + height, earth.bm_longitudinal()? + height])
    };
    let arms = || Some(earth.buoyancy_centre? - gravity_earth?);
    let (gm, arms) = (gm(), arms());
    let plane = earth.waterplane;
    let stiff = gm.map(|g| g[1]).or(earth.bm_longitudinal());
    let trimming = |p: crate::Waterplane<T>| {
        (p.length.re() > 0.0)
            .then_some(stiff)
            .flatten()
            .map(|gm| earth.displacement * gm * centimetre / p.length)
    };
    Afloat {
        attitude,
        buoyancy_centre: earth.buoyancy_centre.map(|c| attitude.body_from(c)),
        flotation_centre: plane.map(|p| attitude.body_from(p.centre)),
        drafts,
        freeboard: rim(&turned, symmetry).map(|z| z - attitude.level),
        weight: earth.displacement * gravity,
        tpc: plane.map(|p| p.area * density * centimetre),
        mtc: plane.and_then(trimming),
        gm,
        gz: arms.map(|a| a.y),
        trim_arm: arms.map(|a| a.x),
        earth,
    }
}

/// The middle of the skin's length and its lowest z: where drafts are measured.
pub fn bottom<T: Real>(mesh: &Mesh<T>) -> [T; 2] {
    let Extents { low_x, high_x, low_z } = extents(mesh);
    [(low_x + high_x) * 0.5, low_z]
}

/// Extents of the skin, with the derivatives of the corners they are reached at.
#[derive(Clone, Copy)]
pub(crate) struct Extents<T> {
    pub low_x: T,
    pub high_x: T,
    pub low_z: T,
}

pub(crate) fn extents<T: Real>(mesh: &Mesh<T>) -> Extents<T> {
    let skin = skin_of(mesh);
    let mut corners = skin.iter().flat_map(|&f| mesh.faces()[f]).map(|v| v as usize);
    let Some(first) = corners.next() else {
        return Extents { low_x: T::zero(), high_x: T::zero(), low_z: T::zero() };
    };
    let p = mesh.positions()[first];
    let start = Extents { low_x: p.x, high_x: p.x, low_z: p.z };
    corners.fold(start, |e, v| {
        let p = mesh.positions()[v];
        Extents { low_x: e.low_x.min(p.x), high_x: e.high_x.max(p.x), low_z: e.low_z.min(p.z) }
    })
}

/// The lowest point of the open edges that do not lie in the symmetry plane.
pub(crate) fn rim<T: Real>(mesh: &Mesh<T>, symmetry: Symmetry) -> Option<T> {
    let epsilon = 1e-9 * mesh.bounds().diagonal();
    let position = |v: u32| mesh.positions()[v as usize];
    let sides = half_edges(mesh.topology());
    let skin = |face: usize| mesh.patches()[mesh.topology().patch_of(face)].info.tag.is_skin();
    let open = edges(&sides).filter(|e| e.len() == 1 && skin(e[0].face()));
    let ends = open.map(|e| [position(e[0].from), position(e[0].to)]);
    let inner = |p: &[Vec3<T>; 2]| p.iter().all(|p| p.y.re().abs() <= epsilon);
    let outer = ends.filter(|p| symmetry == Symmetry::None || !inner(p));
    outer.flatten().map(|p| p.z).reduce(|a, b| a.min(b))
}
