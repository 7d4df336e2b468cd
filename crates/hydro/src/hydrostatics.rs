//! What a body displaces and how stiffly it floats: the figures, by name.

use moldloft_num::{Real, Vec3};

/// How much of a body its skin shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// All of it.
    #[default]
    None,
    /// One side of the plane y = 0; the figures are those of both sides.
    MirroredTwice,
    /// One side of the plane y = 0; the figures are those of this side alone.
    MirroredOnce,
}

/// The displaced volume by the divergence theorem with three fields. They agree for a surface that
/// is closed but for its top in the water plane and its side in the symmetry plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeForms<T> {
    /// Integral of (x - x0) n_x, x0 in the middle of the body.
    pub x: T,
    /// Integral of (y - y0) n_y, y0 = 0 for a mirrored body, else in its middle.
    pub y: T,
    /// Integral of (z - level) n_z: the one used, blind to the open top and side.
    pub z: T,
}

/// Where the water cuts the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waterplane<T> {
    /// Area.
    pub area: T,
    /// Centre of the area, at the level of the water.
    pub centre: Vec3<T>,
    /// Second moment about the longitudinal axis through the centre: the integral of (y - yc)^2.
    pub transverse_moment: T,
    /// Second moment about the transverse axis through the centre: the integral of (x - xc)^2.
    pub longitudinal_moment: T,
    /// The ends of the waterline, its lowest and highest x.
    pub ends: [T; 2],
    /// Extent in x.
    pub length: T,
    /// Extent in y.
    pub beam: T,
    /// Immersed area of the section half-way between the ends.
    pub midship_area: T,
}

/// Ratios of the immersed body to its bounding shapes (Lewis 1988, Principles of Naval
/// Architecture I, 2.3); the length and beam are those of the waterline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormCoefficients<T> {
    /// Volume / (length beam draft).
    pub block: T,
    /// Volume / (midship area length).
    pub prismatic: T,
    /// Midship area / (beam draft).
    pub midship: T,
    /// Waterplane area / (length beam).
    pub waterplane: T,
}

/// What a body displaces and how stiffly it floats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydrostatics<T> {
    /// Height z of the water.
    pub level: T,
    /// Displaced volume.
    pub volume: T,
    /// Density times volume.
    pub displacement: T,
    /// Centre of buoyancy; `None` when nothing is displaced.
    pub buoyancy_centre: Option<Vec3<T>>,
    /// Area of the skin below the water.
    pub wetted_area: T,
    /// Depth of the lowest point below the water; zero when all is above.
    pub draft: T,
    /// The cut with the water; `None` when the water does not cut the body.
    pub waterplane: Option<Waterplane<T>>,
    /// Form coefficients; `None` without waterplane.
    pub coefficients: Option<FormCoefficients<T>>,
    /// The volume by three fields, for the asked number of sides.
    pub forms: VolumeForms<T>,
    /// Largest difference between the forms over the volume. Rounding when closed.
    pub closure_error: f64,
    /// Difference between the waterplane area from the skin and from the waterline, over the area.
    pub waterplane_error: f64,
    /// Open edges below the water, not in the symmetry plane: 0 when the skin holds water.
    pub open_edges: usize,
    /// True when the normals of the skin point out of the body. When false all figures are those of
    /// the turned skin.
    pub outward: bool,
}

impl<T: Real> Hydrostatics<T> {
    /// Height of the centre of buoyancy above the lowest point.
    pub fn kb(&self) -> Option<T> {
        Some(self.draft + self.buoyancy_centre?.z - self.level)
    }

    /// Transverse metacentric radius: second moment of the waterplane / volume.
    pub fn bm_transverse(&self) -> Option<T> {
        self.waterplane.map(|w| w.transverse_moment / self.volume)
    }

    /// Longitudinal metacentric radius.
    pub fn bm_longitudinal(&self) -> Option<T> {
        self.waterplane.map(|w| w.longitudinal_moment / self.volume)
    }

    /// Height of the transverse metacentre above the lowest point.
    pub fn km_transverse(&self) -> Option<T> {
        Some(self.kb()? + self.bm_transverse()?)
    }

    /// Height of the longitudinal metacentre above the lowest point.
    pub fn km_longitudinal(&self) -> Option<T> {
        Some(self.kb()? + self.bm_longitudinal()?)
    }

    /// Every figure under the name that tables, JSON and derivatives use, in a fixed order; figures
    /// without meaning (no waterplane) are left out.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let mut rows = vec![
            ("volume", self.volume),
            ("displacement", self.displacement),
            ("wetted_area", self.wetted_area),
            ("draft", self.draft),
        ];
        if let Some(c) = self.buoyancy_centre {
            rows.extend([("lcb", c.x), ("tcb", c.y), ("vcb", c.z)]);
        }
        if let Some(w) = self.waterplane {
            rows.extend([
                ("waterplane_area", w.area),
                ("lcf", w.centre.x),
                ("tcf", w.centre.y),
                ("waterplane_it", w.transverse_moment),
                ("waterplane_il", w.longitudinal_moment),
                ("waterline_low_x", w.ends[0]),
                ("waterline_high_x", w.ends[1]),
                ("waterline_length", w.length),
                ("waterline_beam", w.beam),
                ("midship_area", w.midship_area),
            ]);
        }
        if let Some(c) = self.coefficients {
            rows.extend([
                ("cb", c.block),
                ("cp", c.prismatic),
                ("cm", c.midship),
                ("cwp", c.waterplane),
            ]);
        }
        let heights = [
            ("kb", self.kb()),
            ("bmt", self.bm_transverse()),
            ("bml", self.bm_longitudinal()),
            ("kmt", self.km_transverse()),
            ("kml", self.km_longitudinal()),
        ];
        rows.extend(heights.into_iter().filter_map(|(name, value)| Some((name, value?))));
        rows
    }
}
